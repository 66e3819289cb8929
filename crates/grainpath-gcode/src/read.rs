//! Reads G-code as lines, each with a command, words and a comment. No state is kept between lines, and
//! any bytes are accepted.

use grainpath_core::number::{Exponent, leading_number};

/// Words that are kept of a line; a line with more is damaged. Real commands have at most about ten.
/// Source: chosen; files of real programs stay far below it.
const MAX_WORDS: usize = 16;

/// One line of a program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<'a> {
    /// Number of the line, from 1.
    pub number: usize,
    /// The command as a letter and ten times the number: `('G', 10)` for G1, `('G', 292)` for G29.2; `None` if there is
    /// none.
    pub command: Option<(u8, u32)>,
    words: [(u8, f64); MAX_WORDS],
    n_words: usize,
    /// The text after `;`, trimmed.
    pub comment: &'a [u8],
    /// The line without its comment, for commands that are not a letter with a number.
    pub text: &'a [u8],
    /// Whether a part of the line could not be read, or its words contradict each other.
    pub broken: bool,
}

impl Line<'_> {
    /// The number after a letter (upper case); `None` where the letter is missing.
    pub fn word(&self, letter: u8) -> Option<f64> {
        self.words[..self.n_words].iter().find(|w| w.0 == letter).map(|w| w.1)
    }

    /// Whether the line has one of X, Y, Z and E.
    pub(crate) fn has_axis(&self) -> bool {
        self.words().iter().any(|w| b"XYZE".contains(&w.0))
    }

    /// Whether words of a G command contradict each other: a second command in the line, an axis without a command (which
    /// CNC machines take for the last one), or a word of a move twice (as in `X1e4 E1`).
    fn contradicts(&self) -> bool {
        let twice = |letter: &u8| self.words().iter().filter(|w| w.0 == *letter).count() > 1;
        match self.command {
            None => self.has_axis(),
            Some((b'G', code)) => self.word(b'G').is_some() || (code <= 30 && b"XYZEFIJR".iter().any(twice)),
            Some(_) => false,
        }
    }

    /// Letters and numbers after the command, in order.
    pub fn words(&self) -> &[(u8, f64)] {
        &self.words[..self.n_words]
    }
}

/// The lines of a program; LF, CRLF and bare CR end them. A byte order mark before the first is passed over.
///
/// ```
/// use grainpath_gcode::Lines;
///
/// let line = Lines::new(b"G1 X1.5 E.02 ; outer wall").next().unwrap();
/// assert_eq!(line.command, Some((b'G', 10)));
/// assert_eq!((line.word(b'X'), line.word(b'E')), (Some(1.5), Some(0.02)));
/// assert_eq!(line.comment, b"outer wall");
/// ```
pub struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    /// The lines of these bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, number: 0 }
    }

    /// The lines of a later part of a program, after `before` lines.
    pub(crate) fn after(before: usize, bytes: &'a [u8]) -> Self {
        Self { rest: bytes, number: before }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.number == 0 {
            self.rest = self.rest.strip_prefix(b"\xef\xbb\xbf").unwrap_or(self.rest);
        }
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let text = &self.rest[..end];
        // CR and LF together end one line; bare CR comes from old Mac editors.
        let crlf = self.rest.get(end) == Some(&b'\r') && self.rest.get(end + 1) == Some(&b'\n');
        self.rest = &self.rest[(end + 1 + usize::from(crlf)).min(self.rest.len())..];
        Some(parse(text, self.number))
    }
}

fn parse(line: &[u8], number: usize) -> Line<'_> {
    let (text, comment) = match line.iter().position(|&b| b == b';') {
        // A semicolon inside quotes belongs to a text, such as the name of a file.
        Some(i) if line[..i].iter().filter(|&&b| b == b'"').count() % 2 == 0 => (&line[..i], &line[i + 1..]),
        _ => (line, &line[line.len()..]),
    };
    let text = text.trim_ascii();
    let mut out = Line {
        number,
        command: None,
        words: [(0, 0.0); MAX_WORDS],
        n_words: 0,
        comment: comment.trim_ascii(),
        text,
        broken: false,
    };
    // Klipper's extended commands begin with a word of two or more letters; the syntax of their
    // parameters differs from G-code.
    let extended = text.len() > 1 && text[..2].iter().all(|b| b.is_ascii_alphabetic() || *b == b'_');
    if !extended {
        words(text, &mut out);
        out.broken |= out.contradicts();
    }
    out
}

fn words(mut rest: &[u8], out: &mut Line<'_>) {
    loop {
        rest = rest.trim_ascii_start();
        let Some((&first, after)) = rest.split_first() else { return };
        match first {
            b'(' => {
                // A comment in parentheses. If the closing one is missing, it takes the rest of the line.
                rest = after.iter().position(|&b| b == b')').map_or(&[], |end| &after[end + 1..]);
            }
            // `*` begins a checksum; `%` frames programs of CNC machines.
            b'*' | b'%' => return,
            b'"' => {
                rest = after.iter().position(|&b| b == b'"').map_or(&[], |end| &after[end + 1..]);
            }
            letter if letter.is_ascii_alphabetic() => {
                let (value, used) = number(after);
                rest = &after[used..];
                let letter = letter.to_ascii_uppercase();
                let Some(value) = value else {
                    // A letter without a number is a flag (`G28 X`). Before a quoted text it is the name of that text.
                    push(out, letter, 0.0);
                    continue;
                };
                match out.command {
                    // `N` with a number before the command is the line number of serial protocols.
                    _ if letter == b'N' && out.command.is_none() && out.n_words == 0 => {}
                    None if matches!(letter, b'G' | b'M' | b'T') => {
                        // Codes are stored times ten, so that G29.2 and G29 stay apart without floats.
                        let code = (value * 10.0).round();
                        out.broken |= !(0.0..1e6).contains(&code);
                        out.command = Some((letter, code.clamp(0.0, 1e6) as u32));
                        // M117, M118, M23, M28, M30 and M32 are followed by a message or a file name.
                        if letter == b'M'
                            && matches!(out.command, Some((_, 1170 | 1180 | 230 | 280 | 300 | 320)))
                        {
                            return; // What follows is a text or a file's name.
                        }
                    }
                    _ => push(out, letter, value),
                }
            }
            _ => {
                out.broken = true;
                rest = after;
            }
        }
    }
}

fn push(out: &mut Line<'_>, letter: u8, value: f64) {
    if out.n_words < MAX_WORDS {
        out.words[out.n_words] = (letter, value);
        out.n_words += 1;
    } else {
        out.broken = true;
    }
}

/// Reads the number after a letter. Returns it with the number of bytes read, leading spaces included.
fn number(bytes: &[u8]) -> (Option<f64>, usize) {
    /// Largest number of digits before the point of a coordinate. A number with more digits counts as damaged;
    /// as f64 it would lose digits. Source: derived. The largest whole number that fits 64 bits has 19.
    const MAX_WHOLE_DIGITS: usize = 18;
    let space = bytes.iter().take_while(|&&b| b == b' ').count();
    let Some((value, n)) = leading_number(&bytes[space..], Exponent::NotAllowed) else { return (None, 0) };
    let n_whole =
        bytes[space..space + n].iter().skip_while(|b| !b.is_ascii_digit()).take_while(|b| b.is_ascii_digit());
    // Only part of the digits is consumed, so the remaining ones mark the line as damaged.
    if n_whole.count() > MAX_WHOLE_DIGITS {
        (None, space + MAX_WHOLE_DIGITS)
    } else {
        (Some(value), space + n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn line(text: &str) -> Line<'_> {
        Lines::new(text.as_bytes()).next().expect("a line")
    }

    #[test]
    fn ways_to_write_a_move() {
        for text in [
            "G1 X10 Y-5.25 E.5",
            "g1x10y-5.25e0.5",
            "N12 G1 X10 Y-5.25 E0.5*71",
            "G01 (to) X 10 Y -5.25 E0.5 ; x",
        ] {
            let l = line(text);
            assert_eq!(l.command, Some((b'G', 10)), "{text}");
            assert_eq!(
                (l.word(b'X'), l.word(b'Y'), l.word(b'E')),
                (Some(10.0), Some(-5.25), Some(0.5)),
                "{text}"
            );
            assert!(!l.broken);
        }
        assert_eq!(line("G29.2").command, Some((b'G', 292)));
        assert_eq!(line("SET_PRESSURE_ADVANCE ADVANCE=0.05").command, None);
        assert_eq!(line("M117 Hello G1 X1").words(), []);
        assert_eq!(line(";TYPE:Perimeter").comment, b"TYPE:Perimeter");
        assert_eq!(line("G28 X Y").words().len(), 2);
        assert_eq!(Lines::new(b"G1\r\nG2\rG3\n").count(), 3);
        let marked = line("\u{feff}G1 X10");
        assert!(!marked.broken && marked.command == Some((b'G', 10)), "{marked:?}");
    }

    proptest! {
        #[test]
        fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            for l in Lines::new(&bytes) {
                prop_assert!(l.words().iter().all(|w| w.1.is_finite()));
            }
        }
    }
}
