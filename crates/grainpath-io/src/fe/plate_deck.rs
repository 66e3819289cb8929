//! Writes a plate of square elements as a deck for CalculiX, with a stiffness of its own for each element.
//!
//! Source: CalculiX's manual, *ELASTIC, TYPE=ANISO, whose 21 constants stand in Abaqus' order. The membrane stiffness of an
//! element over the thickness of the plate is a plane stress stiffness. It is written as a material that couples nothing
//! to the thickness, so that plane stress leaves it as it is. Elements of equal stiffness share a material. Positions in
//! mm, forces in N, stresses in MPa. Cost: linear in the elements. The same input gives the same bytes.
//!
//! Elements are CPS4. They have no incompatible modes, so a wall of few cells across is stiffer in bending than ours.

use std::collections::BTreeMap;
use std::io::{self, Write};

use grainpath_core::DVec2;

/// A plate under plane stress.
#[derive(Debug, Clone, Copy)]
pub struct PlateDeck<'a> {
    /// What the deck is of; a line of its head.
    pub title: &'a str,
    /// Thickness of the plate, mm.
    pub thickness_mm: f64,
    /// Positions of the nodes, mm.
    pub nodes_mm: &'a [DVec2],
    /// Corners of each element, counter-clockwise.
    pub corners: &'a [[u32; 4]],
    /// Membrane stiffness of each element, in Voigt order x, y, shear angle, N/mm.
    pub membranes_n_mm: &'a [[[f64; 3]; 3]],
    /// Nodes that are held, each with the unit vector along which it is held.
    pub holds: &'a [(u32, DVec2)],
    /// Force at each node, N.
    pub forces_n: &'a [DVec2],
}

/// Items in a line of a set. Source: CalculiX's manual, *ELSET, which allows 16.
const IN_LINE: usize = 16;

/// Writes a deck with one linear static step.
///
/// # Errors
/// Those of the output.
///
/// ```
/// use grainpath_core::DVec2;
/// use grainpath_io::fe::{PlateDeck, write_plate_deck};
/// let deck = PlateDeck {
///     title: "one cell",
///     thickness_mm: 2.0,
///     nodes_mm: &[DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y],
///     corners: &[[0, 1, 2, 3]],
///     membranes_n_mm: &[[[4000.0, 1000.0, 0.0], [1000.0, 4000.0, 0.0], [0.0, 0.0, 1500.0]]],
///     holds: &[(0, DVec2::X), (0, DVec2::Y), (3, DVec2::X)],
///     forces_n: &[DVec2::ZERO, DVec2::X, DVec2::X, DVec2::ZERO],
/// };
/// let mut bytes = Vec::new();
/// write_plate_deck(&deck, &mut bytes)?;
/// assert!(String::from_utf8_lossy(&bytes).contains("*ELEMENT, TYPE=CPS4"));
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_plate_deck(deck: &PlateDeck<'_>, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "*HEADING\n{}", deck.title.replace(['\n', '\r', '*'], " "))?;
    writeln!(out, "*NODE, NSET=ALL")?;
    for (i, p) in deck.nodes_mm.iter().enumerate() {
        writeln!(out, "{}, {}, {}, 0", i + 1, p.x, p.y)?;
    }
    writeln!(out, "*ELEMENT, TYPE=CPS4, ELSET=PLATE")?;
    for (e, corners) in deck.corners.iter().enumerate() {
        let [a, b, c, d] = corners.map(|i| i + 1);
        writeln!(out, "{}, {a}, {b}, {c}, {d}", e + 1)?;
    }
    let mut alike: BTreeMap<[[u64; 3]; 3], Vec<usize>> = BTreeMap::new();
    for (e, membrane) in deck.membranes_n_mm.iter().enumerate() {
        alike.entry(membrane.map(|row| row.map(f64::to_bits))).or_default().push(e + 1);
    }
    for (k, (bits, elements)) in alike.iter().enumerate() {
        let name = format!("M{}", k + 1);
        writeln!(out, "*ELSET, ELSET={name}")?;
        for line in elements.chunks(IN_LINE) {
            let numbers: Vec<String> = line.iter().map(usize::to_string).collect();
            writeln!(out, "{}", numbers.join(", "))?;
        }
        let [xx, yy, xy] = bits.map(|row| row.map(|bits| f64::from_bits(bits) / deck.thickness_mm));
        // Through the thickness any stable stiffness will do.
        let (zz, shear) = (xx[0].max(yy[1]), xy[2]);
        writeln!(out, "*MATERIAL, NAME={name}\n*ELASTIC, TYPE=ANISO")?;
        writeln!(out, "{}, {}, {}, 0, 0, {zz}, {}, {}", xx[0], xx[1], yy[1], xx[2], yy[2])?;
        writeln!(out, "0, {shear}, 0, 0, 0, 0, {shear}, 0")?;
        writeln!(out, "0, 0, 0, 0, {shear}")?;
        writeln!(out, "*SOLID SECTION, ELSET={name}, MATERIAL={name}\n{}", deck.thickness_mm)?;
    }
    let (straight, oblique): (Vec<_>, Vec<_>) =
        deck.holds.iter().partition(|(_, along)| along.x == 0.0 || along.y == 0.0);
    for (node, along) in oblique {
        // A node held along an oblique direction: the sum of its displacements times the direction is zero. The larger
        // term stands first, because CalculiX eliminates it.
        let mut terms = [(1, along.x), (2, along.y)];
        terms.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        let n = node + 1;
        let [(i, x), (j, y)] = terms;
        writeln!(out, "*EQUATION\n2\n{n}, {i}, {x}, {n}, {j}, {y}")?;
    }
    writeln!(out, "*STEP\n*STATIC\n*BOUNDARY")?;
    for (node, along) in straight {
        let axis = if along.y == 0.0 { 1 } else { 2 };
        writeln!(out, "{}, {axis}, {axis}", node + 1)?;
    }
    let loaded = || deck.forces_n.iter().enumerate().filter(|(_, f)| **f != DVec2::ZERO);
    writeln!(out, "*CLOAD")?;
    for (i, force) in loaded() {
        for (axis, component) in [(1, force.x), (2, force.y)].into_iter().filter(|(_, c)| *c != 0.0) {
            writeln!(out, "{}, {axis}, {component}", i + 1)?;
        }
    }
    writeln!(out, "*NODE PRINT, NSET=ALL\nU\n*NODE FILE\nU\n*EL FILE\nS\n*END STEP")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fe::parse_fe;

    #[test]
    fn equal_stiffnesses_share_a_material_and_oblique_holds_are_equations() {
        let nodes: Vec<DVec2> = (0..8).map(|i| DVec2::new(f64::from(i % 4), f64::from(i / 4))).collect();
        let soft = [[100.0, 30.0, 1.0], [30.0, 90.0, -2.0], [1.0, -2.0, 35.0]];
        let stiff = soft.map(|row| row.map(|v| 2.0 * v));
        let slope = DVec2::new(0.6, 0.8);
        let deck = PlateDeck {
            title: "three cells\n*STEP",
            thickness_mm: 2.0,
            nodes_mm: &nodes,
            corners: &[[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6]],
            membranes_n_mm: &[soft, stiff, soft],
            holds: &[(0, DVec2::X), (4, DVec2::NEG_X), (0, slope)],
            forces_n: &[
                DVec2::ZERO,
                DVec2::ZERO,
                DVec2::ZERO,
                DVec2::new(1.5, 0.0),
                DVec2::ZERO,
                DVec2::ZERO,
                DVec2::ZERO,
                DVec2::new(0.0, -2.0),
            ],
        };
        let mut bytes = Vec::new();
        write_plate_deck(&deck, &mut bytes).expect("memory");
        let text = String::from_utf8(bytes.clone()).expect("text");
        assert_eq!(text.matches("*MATERIAL").count(), 2);
        assert_eq!(text.matches("*STEP").count(), 1, "{text}");
        assert!(text.contains("50, 15, 45, 0, 0, 50, 0.5, -1\n0, 17.5,"), "{text}");
        assert!(text.contains("*EQUATION\n2\n1, 2, 0.8, 1, 1, 0.6\n"), "{text}");
        assert!(text.contains("*BOUNDARY\n1, 1, 1\n5, 1, 1\n*CLOAD\n4, 1, 1.5\n8, 2, -2\n"), "{text}");
        // Our own reader finds the mesh again.
        let file = parse_fe(&bytes, Some("inp")).expect("our own deck");
        assert_eq!((file.nodes.len(), file.elements.len()), (8, 3));
    }
}
