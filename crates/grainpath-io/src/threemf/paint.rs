//! Support enforcers and blockers that users paint on facets, as the project files of slicers keep them.
//!
//! The attribute of a triangle is a row of hexadecimal digits that is read from its end. It describes how the triangle is
//! divided and how its pieces are painted. The two low bits of a digit are the number of sides that are halved. If no side
//! is halved, the two high bits are the paint (1 enforcer, 2 blocker). Otherwise they are the side at which the division
//! begins, and the digits of the pieces follow, last piece first.

use grainpath_core::DVec3;

use crate::mesh::model::PaintedSupports;

/// Names that slicers give to the attribute, with and without a prefix.
pub(super) const ATTRIBUTES: [&str; 3] = ["slic3rpe:custom_supports", "paint_supports", "custom_supports"];

/// Adds the painted facets of a triangle to `painted`. Returns `None` where the digits end early or go on
/// too long.
pub(super) fn decode(digits: &[u8], corners: [DVec3; 3], painted: &mut PaintedSupports) -> Option<()> {
    let mut digits = digits.iter().rev().map(|&d| char::from(d).to_digit(16));
    // The pieces are kept on a stack, so the last piece is read first, which is the order of the encoding.
    let mut left = vec![corners];
    while let Some(triangle) = left.pop() {
        let digit = digits.next()??;
        let (halved, high) = (digit & 3, digit >> 2);
        if halved == 0 {
            // 3 is an escape: the paint is then the next digit plus 3. Such values are colours and are skipped.
            let mark = if high == 3 { digits.next()?? + 3 } else { high };
            let to = match mark {
                1 => &mut painted.enforcers,
                2 => &mut painted.blockers,
                _ => continue,
            };
            let first = to.vertices.len() as u32;
            to.vertices.extend(triangle);
            to.triangles.push([first, first + 1, first + 2]);
            continue;
        }
        // The corners are rotated so that the division begins at the first side.
        let [a, b, c] = [0, 1, 2].map(|k| triangle[(high as usize + k) % 3]);
        let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
        // One, two or three sides are halved; the triangle falls into two, three or four pieces.
        match halved {
            1 => left.extend([[a, b, bc], [bc, c, a]]),
            2 => left.extend([[a, ab, ca], [ab, b, ca], [b, c, ca]]),
            _ => left.extend([[a, ab, ca], [ab, b, bc], [bc, c, ca], [ab, bc, ca]]),
        }
    }
    // If digits are left over, the division was misread.
    digits.next().is_none().then_some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec3; 3] = [DVec3::ZERO, DVec3::new(8.0, 0.0, 0.0), DVec3::new(0.0, 8.0, 0.0)];

    fn painted(digits: &str) -> Option<(f64, f64)> {
        let mut painted = PaintedSupports::default();
        decode(digits.as_bytes(), CORNERS, &mut painted)?;
        let area = |m: &grainpath_core::TriMesh| {
            let triangle_area = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|i| m.vertices[i as usize]);
                0.5 * (b - a).cross(c - a).length()
            };
            m.triangles.iter().map(triangle_area).sum()
        };
        Some((area(&painted.enforcers), area(&painted.blockers)))
    }

    #[test]
    fn marks_cover_what_was_painted() {
        assert_eq!(painted("4"), Some((32.0, 0.0)));
        assert_eq!(painted("8"), Some((0.0, 32.0)));
        assert_eq!(painted("0"), Some((0.0, 0.0)));
        // Four quarters: the middle is read first.
        assert_eq!(painted("00043"), Some((8.0, 0.0)));
        assert_eq!(painted("84443"), Some((24.0, 8.0)));
        // One side halved twice over: a half, and half of the other half.
        assert_eq!(painted("80411"), Some((8.0, 16.0)));
        // A third kind of mark takes two digits.
        assert_eq!(painted("0C"), Some((0.0, 0.0)));
    }

    #[test]
    fn what_is_cut_short_or_too_long_is_refused() {
        for digits in ["", "3", "443", "44", "G", "C", "4444443"] {
            assert_eq!(painted(digits), None, "{digits}");
        }
    }
}
