//! Fixed-point numbers without trailing zeros and without "-0". Floats are not formatted in the inner
//! loop, because integers are faster and round the same way everywhere.

/// Appends `value * 10^-decimals`.
pub(super) fn push_fixed(out: &mut Vec<u8>, value: i64, decimals: u32) {
    let scale = 10u64.pow(decimals);
    // `unsigned_abs` also covers the lowest i64.
    let magnitude = value.unsigned_abs();
    if value < 0 {
        out.push(b'-');
    }
    push_whole(out, magnitude / scale);
    let mut rest = magnitude % scale;
    if rest > 0 {
        out.push(b'.');
        let mut place = scale / 10;
        while rest > 0 {
            out.push(b'0' + (rest / place) as u8);
            rest %= place;
            place /= 10;
        }
    }
}

fn push_whole(out: &mut Vec<u8>, value: u64) {
    // Twenty digits hold every u64; they are filled from the end.
    let mut digits = [0u8; 20];
    let mut i = digits.len();
    let mut rest = value;
    loop {
        i -= 1;
        digits[i] = b'0' + (rest % 10) as u8;
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    out.extend_from_slice(&digits[i..]);
}

#[cfg(test)]
mod tests {
    use super::push_fixed;

    #[test]
    fn as_people_write_them() {
        for (value, decimals, text) in [
            (0, 3, "0"),
            (-1, 3, "-0.001"),
            (12345, 3, "12.345"),
            (12300, 3, "12.3"),
            (-12000, 3, "-12"),
            (50, 5, "0.0005"),
        ] {
            let mut out = Vec::new();
            push_fixed(&mut out, value, decimals);
            assert_eq!(String::from_utf8(out).as_deref(), Ok(text));
        }
    }
}
