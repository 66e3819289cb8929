//! Splits text into words and keeps the number of the line, for any line ends and any white space.

use grainpath_core::number::{number, whole};

/// Why a word of a text file cannot be read. `place` is the line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)]
pub enum TextError {
    #[error("{place}: found {found:?} where {expected} should be")]
    Syntax { place: String, found: String, expected: &'static str },
    #[error("{place}: the file ends where {expected} should be")]
    UnexpectedEnd { place: String, expected: &'static str },
}

/// The bytes from the first one that is not white space. A byte order mark counts as white space.
pub(crate) fn skip_space(bytes: &[u8]) -> &[u8] {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start = bytes.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(bytes.len());
    &bytes[start..]
}

/// Splits text into words and counts lines. CR, LF and CRLF all end a line.
pub(crate) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    /// The byte that begins a comment, which ends with its line.
    comment: Option<u8>,
}

impl<'a> Words<'a> {
    pub(crate) fn new(bytes: &'a [u8], comment: Option<u8>) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        Self { bytes, at: 0, line: 1, comment }
    }

    pub(crate) fn place(&self) -> String {
        format!("line {}", self.line)
    }

    /// The current line, counted from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// The current position, in bytes.
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    /// Skips white space and comments, within the line if asked. Returns whether a word follows.
    fn step_to_word(&mut self, same_line: bool) -> bool {
        while let Some(&b) = self.bytes.get(self.at) {
            match b {
                b'\n' | b'\r' => {
                    if same_line {
                        return false;
                    }
                    self.end_line();
                }
                b if b.is_ascii_whitespace() => self.at += 1,
                // A backslash at the end of a line continues it (OBJ).
                b'\\' if matches!(self.bytes.get(self.at + 1), Some(b'\n' | b'\r')) => {
                    self.at += 1;
                    self.end_line();
                }
                b if Some(b) == self.comment => self.skip_to_line_end(),
                _ => return true,
            }
        }
        false
    }

    fn end_line(&mut self) {
        // CR and LF together are one line end; otherwise line numbers of Windows files would double.
        let crlf = self.bytes[self.at] == b'\r' && self.bytes.get(self.at + 1) == Some(&b'\n');
        self.at += 1 + usize::from(crlf);
        self.line += 1;
    }

    fn skip_to_line_end(&mut self) {
        let rest = &self.bytes[self.at..];
        self.at += rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
    }

    /// Moves to the beginning of the next line.
    pub(crate) fn next_line(&mut self) {
        self.skip_to_line_end();
        if self.at < self.bytes.len() {
            self.end_line();
        }
    }

    fn take(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let n = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += n;
        &rest[..n]
    }

    /// The next word, on whatever line.
    pub(crate) fn word(&mut self) -> Option<&'a [u8]> {
        self.step_to_word(false).then(|| self.take())
    }

    /// The next word on this line.
    pub(crate) fn word_on_line(&mut self) -> Option<&'a [u8]> {
        self.step_to_word(true).then(|| self.take())
    }

    /// The rest of this line, trimmed.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        let start = self.at;
        self.skip_to_line_end();
        self.bytes[start..self.at].trim_ascii()
    }

    /// The next word; the position stays before it.
    pub(crate) fn peek(&mut self) -> Option<&'a [u8]> {
        let (at, line) = (self.at, self.line);
        let word = self.word();
        (self.at, self.line) = (at, line);
        word
    }

    /// The next `n` bytes as they are; `None` where there are fewer. Line ends in them are not counted.
    pub(crate) fn raw(&mut self, n: usize) -> Option<&'a [u8]> {
        let raw = self.bytes.get(self.at..)?.get(..n)?;
        self.at += n;
        Some(raw)
    }

    /// Whether all bytes have been read.
    pub(crate) fn at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }

    pub(crate) fn wrong(&self, found: &[u8], expected: &'static str) -> TextError {
        // Forty bytes are enough to find the place and keep a binary file out of the message.
        let found: String = String::from_utf8_lossy(&found[..found.len().min(40)]).into_owned();
        TextError::Syntax { place: self.place(), found, expected }
    }

    /// The next word as a number.
    pub(crate) fn number(&mut self, expected: &'static str) -> Result<f64, TextError> {
        let Some(word) = self.word() else {
            return Err(TextError::UnexpectedEnd { place: self.place(), expected });
        };
        number(word).ok_or_else(|| self.wrong(word, expected))
    }

    /// The next word as a count.
    pub(crate) fn count(&mut self, expected: &'static str) -> Result<u64, TextError> {
        let Some(word) = self.word() else {
            return Err(TextError::UnexpectedEnd { place: self.place(), expected });
        };
        whole(word).and_then(|n| u64::try_from(n).ok()).ok_or_else(|| self.wrong(word, expected))
    }

    /// Three numbers as a position.
    pub(crate) fn position(&mut self) -> Result<[f64; 3], TextError> {
        Ok([self.number("a coordinate")?, self.number("a coordinate")?, self.number("a coordinate")?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_with_any_ends() {
        let mut words = Words::new(b"a\rb\r\nc # d\n\n e", Some(b'#'));
        let mut seen = Vec::new();
        while let Some(w) = words.word() {
            seen.push((String::from_utf8_lossy(w).into_owned(), words.place()));
        }
        let expect =
            [("a", 1), ("b", 2), ("c", 3), ("e", 5)].map(|(w, l)| (w.to_owned(), format!("line {l}")));
        assert_eq!(seen, expect);
    }
}
