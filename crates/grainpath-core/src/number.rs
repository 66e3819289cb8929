//! Decimal numbers in text, for every reader of files.
//!
//! The standard library parses them: its result is the nearest `f64` for any number of digits
//! (Eisel-Lemire with a slow path, so at most about 800 digits are looked at). Readers differ only
//! in where a number ends, which [`leading_number`] finds.
//!
//! Measured: a parser of our own with one division for up to 15 digits took 14 to 16 ns for numbers
//! with 3 and 6 decimals, 21 ns for `%.9e` and 34 ns for shortest `f64`; the standard library took
//! 22, 25, 23 and 25 ns (user time of 10^7 numbers each). Nine nanoseconds are a tenth of a second
//! in an ASCII STL of 100 MB, so there is no second parser.

/// The value of a word that is a number, sign and exponent included; `None` for any other word.
///
/// `nan`, `inf` and `infinity` are numbers here. Readers refuse them where they must be finite.
///
/// ```
/// use grainpath_core::number::number;
/// assert_eq!(number(b"-2.5e-3"), Some(-0.0025));
/// assert_eq!(number(b"1,5"), None);
/// ```
pub fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The value of a word that is a whole number with an optional sign; `None` for any other word.
///
/// ```
/// use grainpath_core::number::whole;
/// assert_eq!((whole(b"+12"), whole(b"1.0")), (Some(12), None));
/// ```
pub fn whole(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Whether an `e` after the digits begins an exponent. In G-code it does not: there it begins the next word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Exponent {
    Allowed,
    NotAllowed,
}

/// The number at the beginning of `bytes` and its length in bytes; the rest is ignored.
///
/// For formats that write numbers without a separator, such as `X10Y-.5` in G-code and `M.5.5-1e1` in SVG.
///
/// ```
/// use grainpath_core::number::{Exponent, leading_number};
/// assert_eq!(leading_number(b"-.5.5", Exponent::Allowed), Some((-0.5, 3)));
/// assert_eq!(leading_number(b"2E3", Exponent::NotAllowed), Some((2.0, 1)));
/// assert_eq!(leading_number(b"e3", Exponent::Allowed), None);
/// ```
pub fn leading_number(bytes: &[u8], exponent: Exponent) -> Option<(f64, usize)> {
    let byte = |i: usize| bytes.get(i).copied().unwrap_or(0);
    let mut end = usize::from(matches!(byte(0), b'+' | b'-'));
    let (mut has_digits, mut has_point) = (false, false);
    loop {
        match byte(end) {
            b'0'..=b'9' => has_digits = true,
            b'.' if !has_point => has_point = true,
            _ => break,
        }
        end += 1;
    }
    if !has_digits {
        return None;
    }
    // An `e` without digits after it does not begin an exponent: in SVG and G-code it may begin the next command.
    if exponent == Exponent::Allowed && matches!(byte(end), b'e' | b'E') {
        let sign = usize::from(matches!(byte(end + 1), b'+' | b'-'));
        let first = end + 1 + sign;
        let n_digits = bytes.get(first..).map_or(0, |b| b.iter().take_while(|c| c.is_ascii_digit()).count());
        if n_digits > 0 {
            end = first + n_digits;
        }
    }
    Some((number(&bytes[..end])?, end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn odd_numbers() {
        for (text, value) in
            [("1", 1.0), ("-0.5", -0.5), (".5", 0.5), ("5.", 5.0), ("1e3", 1e3), ("+2.5E-02", 0.025)]
        {
            assert_eq!(number(text.as_bytes()), Some(value), "{text}");
            assert_eq!(
                leading_number(text.as_bytes(), Exponent::Allowed),
                Some((value, text.len())),
                "{text}"
            );
        }
        for text in ["", ".", "-", "1.2.3", "abc", "1e", "0x10", "1,5"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
        for text in ["", ".", "-", "e1", "+.e1", "nan"] {
            assert_eq!(leading_number(text.as_bytes(), Exponent::Allowed), None, "{text}");
        }
        assert!(number(b"nan").is_some_and(f64::is_nan));
    }

    proptest! {
        #[test]
        fn a_number_ends_where_the_next_begins(a in -1e6f64..1e6, b in 0.0f64..1.0) {
            let first = format!("{a:.4}");
            let second = format!("{b:.6}");
            let both = format!("{first}-{second}");
            let (value, n) = leading_number(both.as_bytes(), Exponent::Allowed).expect("a number");
            prop_assert_eq!((value, n), (first.parse().expect("digits"), first.len()));
            let (value, _) = leading_number(&both.as_bytes()[n..], Exponent::Allowed).expect("a number");
            prop_assert_eq!(value, -second.parse::<f64>().expect("digits"));
        }
    }
}
