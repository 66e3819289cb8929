//! Mutations of a file's bytes: the changes that real damage and hostile writers make.
//!
//! Method: each mutant takes one to four changes, drawn by a seeded generator, so that a mutant is known by the name of
//! its seed and one number. Source: the list of changes is that of libFuzzer's default mutators (`libfuzzer-docs`), with
//! numbers in text added, for a flipped bit in a decimal number hardly ever gives NaN or an overflow.

/// Draws numbers; the sequence depends on the seed alone. Method: `SplitMix64` (`steele2014`).
pub struct Draw(u64);

impl Draw {
    /// A generator for this seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number of 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below `end`; 0 where `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        if end == 0 { 0 } else { (self.bits() % end as u64) as usize }
    }

    fn one<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[self.below(choices.len())]
    }
}

/// Numbers that readers of text get wrong: signs, ends of integer types, infinities, long and short ones.
const NUMBERS: [&str; 18] = [
    "0",
    "-1",
    "1",
    "255",
    "65536",
    "2147483647",
    "-2147483648",
    "4294967295",
    "18446744073709551616",
    "1e308",
    "-1e308",
    "1e-320",
    "nan",
    "inf",
    "-inf",
    "0x10",
    "1.2.3",
    "99999999999999999999999999999999",
];

/// The same for numbers in binary: the ends of the integer types and the special values of floats.
const WORDS: [u32; 10] =
    [0, 1, 0x7F, 0xFFFF, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF, 0x7F80_0000, 0x7FC0_0000, 0x0080_0000];

/// Changes `bytes` in place from `start` on.
pub fn change(bytes: &mut Vec<u8>, start: usize, draw: &mut Draw) {
    for _ in 0..1 + draw.below(4) {
        let start = start.min(bytes.len());
        let text = bytes[start..].iter().take(512).all(|b| b.is_ascii() && *b != 0);
        if text && draw.below(3) > 0 {
            change_text(bytes, start, draw)
        } else {
            change_bytes(bytes, start, draw)
        }
    }
}

/// A range that begins at or behind `start`, at most `longest` bytes long.
fn range(bytes: &[u8], start: usize, longest: usize, draw: &mut Draw) -> std::ops::Range<usize> {
    let from = start + draw.below(bytes.len() - start);
    from..(from + 1 + draw.below(longest)).min(bytes.len())
}

fn change_bytes(bytes: &mut Vec<u8>, start: usize, draw: &mut Draw) {
    if bytes.len() <= start {
        bytes.push(draw.bits() as u8);
        return;
    }
    let at = start + draw.below(bytes.len() - start);
    match draw.below(8) {
        0 => bytes[at] ^= 1 << draw.below(8),
        1 => bytes[at] = draw.bits() as u8,
        2 => bytes[at] = *draw.one(&[0, 0xFF, 0x7F, 0x80, b'\n', b' ']),
        3 => {
            let word = *draw.one(&WORDS);
            let word = if draw.below(2) == 0 { word.to_le_bytes() } else { word.to_be_bytes() };
            for (byte, new) in bytes[at..].iter_mut().zip(word) {
                *byte = new;
            }
        }
        4 => bytes.truncate(at),
        5 => drop(bytes.drain(range(bytes, start, 64, draw))),
        6 => {
            let copied = bytes[range(bytes, start, 256, draw)].to_vec();
            bytes.splice(at..at, copied);
        }
        _ => {
            let noise: Vec<u8> = (0..1 + draw.below(32)).map(|_| draw.bits() as u8).collect();
            bytes.splice(at..at, noise);
        }
    }
}

fn change_text(bytes: &mut Vec<u8>, start: usize, draw: &mut Draw) {
    let is_number = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
    let starts_of = |bytes: &[u8], inside: &dyn Fn(&u8) -> bool| -> Vec<usize> {
        (start..bytes.len())
            .filter(|&i| inside(&bytes[i]) && (i == start || !inside(&bytes[i - 1])))
            .collect()
    };
    let end_of = |bytes: &[u8], from: usize, inside: &dyn Fn(&u8) -> bool| {
        (from..bytes.len()).find(|&i| !inside(&bytes[i])).unwrap_or(bytes.len())
    };
    let not_newline = |b: &u8| *b != b'\n';
    match draw.below(4) {
        0 | 1 => {
            let numbers = starts_of(bytes, &is_number);
            let Some(&from) = numbers.get(draw.below(numbers.len())) else { return };
            let end = end_of(bytes, from, &is_number);
            let number = draw.one(&NUMBERS).bytes();
            bytes.splice(from..end, number);
        }
        2 => {
            let lines = starts_of(bytes, &not_newline);
            let Some(&from) = lines.get(draw.below(lines.len())) else { return };
            let end = end_of(bytes, from, &not_newline);
            bytes.drain(from..end);
        }
        _ => {
            let lines = starts_of(bytes, &not_newline);
            let Some(&from) = lines.get(draw.below(lines.len())) else { return };
            let mut line = bytes[from..end_of(bytes, from, &not_newline)].to_vec();
            line.push(b'\n');
            let Some(&to) = lines.get(draw.below(lines.len())) else { return };
            bytes.splice(to..to, line.repeat(1 + draw.below(50)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mutant_is_known_by_its_number_and_keeps_its_header() {
        let seed = b"header\n1 2 3\n4 5 6\n".to_vec();
        let mut different = 0;
        for number in 0..200 {
            let [mut a, mut b] = [seed.clone(), seed.clone()];
            change(&mut a, 7, &mut Draw::new(number));
            change(&mut b, 7, &mut Draw::new(number));
            assert_eq!(a, b);
            assert_eq!(&a[..7], b"header\n");
            different += usize::from(a != seed);
        }
        assert!(different > 180, "{different} of 200 mutants differ from their seed");
    }
}
