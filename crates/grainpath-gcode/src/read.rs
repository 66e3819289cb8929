//! G-code as lines of a command, words and a comment. Nothing is kept between lines; any bytes are survived.

use grainpath_core::number::{Exponent, leading_number};

/// Words kept of one line; more are damage.
const MAX_WORDS: usize = 16;

/// One line of a program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<'a> {
    /// From 1.
    pub number: usize,
    /// Letter and number times ten of the command: `('G', 10)` for G1, `('G', 292)` for G29.2; `None` for a line without.
    pub command: Option<(u8, u32)>,
    words: [(u8, f64); MAX_WORDS],
    n_words: usize,
    /// What follows `;`, without the space around it.
    pub comment: &'a [u8],
    /// The line without comment, for commands that are not letters and numbers.
    pub text: &'a [u8],
    /// Whether something on the line could not be understood.
    pub broken: bool,
}

impl Line<'_> {
    /// The number after a letter (upper case); `None` where there is none.
    pub fn word(&self, letter: u8) -> Option<f64> {
        self.words[..self.n_words].iter().find(|w| w.0 == letter).map(|w| w.1)
    }

    /// Letters and numbers after the command, in order.
    pub fn words(&self) -> &[(u8, f64)] {
        &self.words[..self.n_words]
    }
}

/// The lines of a program; LF, CRLF and bare CR end them.
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
    /// Of these bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, number: 0 }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let text = &self.rest[..end];
        let crlf = self.rest.get(end) == Some(&b'\r') && self.rest.get(end + 1) == Some(&b'\n');
        self.rest = &self.rest[(end + 1 + usize::from(crlf)).min(self.rest.len())..];
        Some(parse(text, self.number))
    }
}

fn parse(line: &[u8], number: usize) -> Line<'_> {
    let (text, comment) = match line.iter().position(|&b| b == b';') {
        // A semicolon inside quotes is text, not a comment.
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
    // Klipper's extended commands: two letters or more, then anything.
    let extended = text.len() > 1 && text[..2].iter().all(|b| b.is_ascii_alphabetic() || *b == b'_');
    if !extended {
        words(text, &mut out);
    }
    out
}

fn words(mut rest: &[u8], out: &mut Line<'_>) {
    loop {
        rest = rest.trim_ascii_start();
        let Some((&first, after)) = rest.split_first() else { return };
        match first {
            b'(' => {
                // A comment in brackets; one that does not end takes the rest of the line.
                rest = after.iter().position(|&b| b == b')').map_or(&[], |end| &after[end + 1..]);
            }
            b'*' | b'%' => return,
            b'"' => {
                rest = after.iter().position(|&b| b == b'"').map_or(&[], |end| &after[end + 1..]);
            }
            letter if letter.is_ascii_alphabetic() => {
                let (value, used) = number(after);
                rest = &after[used..];
                let letter = letter.to_ascii_uppercase();
                let Some(value) = value else {
                    // A letter alone is a flag (G28 X); one before a text in quotes names it.
                    push(out, letter, 0.0);
                    continue;
                };
                match out.command {
                    _ if letter == b'N' && out.command.is_none() && out.n_words == 0 => {}
                    None if matches!(letter, b'G' | b'M' | b'T') => {
                        let code = (value * 10.0).round();
                        out.broken |= !(0.0..1e6).contains(&code);
                        out.command = Some((letter, code.clamp(0.0, 1e6) as u32));
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

/// The number after a letter, spaces before it included, and how many bytes both take.
fn number(bytes: &[u8]) -> (Option<f64>, usize) {
    /// A number with more digits before its point than this is no coordinate.
    const MAX_WHOLE_DIGITS: usize = 18;
    let space = bytes.iter().take_while(|&&b| b == b' ').count();
    let Some((value, n)) = leading_number(&bytes[space..], Exponent::NotAllowed) else { return (None, 0) };
    let n_whole =
        bytes[space..space + n].iter().skip_while(|b| !b.is_ascii_digit()).take_while(|b| b.is_ascii_digit());
    // Digits that are left over mark the line as damaged.
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
