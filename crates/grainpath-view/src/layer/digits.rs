//! Numbers in pictures. No font is used, since that would be a dependency of its own.

use super::colour::Rgb;

/// Characters of 3 by 5 pixels, rows from the top, three bits each; `x` is the sign of multiplication.
/// Source: drawn by hand.
const CHARACTERS: [(char, u16); 12] = [
    ('0', 0b111_101_101_101_111),
    ('1', 0b010_110_010_010_111),
    ('2', 0b111_001_111_100_111),
    ('3', 0b111_001_111_001_111),
    ('4', 0b101_101_111_001_001),
    ('5', 0b111_100_111_001_111),
    ('6', 0b111_100_111_101_111),
    ('7', 0b111_001_010_010_010),
    ('8', 0b111_101_111_101_111),
    ('9', 0b111_101_111_001_111),
    ('.', 0b000_000_000_000_010),
    ('x', 0b000_101_010_101_000),
];
/// Colour of the plate below a number. Source: chosen by eye; no part is as light.
pub(crate) const PLATE: Rgb = [245, 245, 240];
/// Colour of what is written on it. Source: chosen by eye for the greatest contrast.
const INK: Rgb = [10, 10, 10];

/// Width and height of a number, whose dots have `dot` pixels.
pub(crate) fn size(text: &str, dot: usize) -> (usize, usize) {
    ((4 * text.chars().count() + 1) * dot, 7 * dot)
}

/// Writes a number in dark characters on a light plate with this upper left pixel.
pub(crate) fn write(
    text: &str,
    (left, top): (usize, usize),
    dot: usize,
    mut paint: impl FnMut(usize, usize, Rgb),
) {
    let bits = |c: char| CHARACTERS.iter().find(|(of, _)| *of == c).map_or(0, |(_, bits)| *bits);
    let bits: Vec<u16> = text.chars().map(bits).collect();
    let (width, height) = size(text, dot);
    for j in 0..height {
        for i in 0..width {
            let (column, row) = (i / dot, j / dot);
            // A character takes three columns and five rows; one more lies before each, and at every edge of the plate.
            let inside = column % 4 > 0 && (1..6).contains(&row);
            let bit = || bits[column / 4] >> (14 - (3 * (row - 1) + column % 4 - 1)) & 1 == 1;
            paint(left + i, top + j, if inside && bit() { INK } else { PLATE });
        }
    }
}
