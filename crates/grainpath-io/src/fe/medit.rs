//! Medit meshes (.mesh), ASCII: vertices, triangles, quads, tetrahedra, prisms, pyramids and hexahedra.
//!
//! Source: P. Frey, *MEDIT: An interactive mesh visualization software*, INRIA RT-0253, 2001. Each section is a keyword, a
//! count and that many rows; the last number of a row is a reference, which is skipped. The format holds no result.

use super::element::ElementKind;
use super::model::{FeError, FeFile, FeFormat, MAX_COUNT, invalid, position};
use super::problem::FeProblem;
use crate::text::Words;
use grainpath_core::number::{number, whole};

pub(crate) fn read(bytes: &[u8]) -> Result<FeFile, FeError> {
    let mut words = Words::new(bytes, Some(b'#'));
    words.word();
    words.count("a version")?;
    let mut file = FeFile::empty(FeFormat::Medit);
    let mut dimension = 3;
    while let Some(word) = words.word() {
        let (kind, n_nodes) = match word {
            b"Dimension" => {
                dimension = words.count("a dimension")?;
                if !(2..=3).contains(&dimension) {
                    return Err(invalid(words.place(), FeProblem::Dimension(dimension)));
                }
                continue;
            }
            b"Vertices" => {
                for _ in 0..count(&mut words)? {
                    let mut p = [0.0; 3];
                    for c in p.iter_mut().take(dimension as usize) {
                        *c = words.number("a coordinate")?;
                    }
                    words.number("a reference")?;
                    file.nodes.push(position(p, || words.place())?);
                }
                continue;
            }
            b"End" => break,
            // Edges and points carry no stress; they are counted and left out.
            b"Edges" => (Err("lines"), 2),
            b"Triangles" => (Ok(ElementKind::Tri3), 3),
            b"Quadrilaterals" => (Ok(ElementKind::Quad4), 4),
            b"Tetrahedra" => (Ok(ElementKind::Tet4), 4),
            b"Pyramids" => (Ok(ElementKind::Pyramid5), 5),
            b"Prisms" => (Ok(ElementKind::Wedge6), 6),
            // Many programs write the misspelled `Hexaedra`; both are in the wild.
            b"Hexahedra" | b"Hexaedra" => (Ok(ElementKind::Hex8), 8),
            other => {
                // Sections without elements (corners, ridges, normals) consist of words and numbers,
                // which are skipped one by one. Bytes beyond ASCII mean that the file is binary or
                // damaged.
                if whole(other).is_none() && number(other).is_none() && !other.is_ascii() {
                    return Err(words.wrong(other, "a section of a Medit mesh").into());
                }
                continue;
            }
        };
        for i in 0..count(&mut words)? {
            let mut nodes = [0u32; 8];
            for slot in &mut nodes[..n_nodes] {
                let node = words.count("a vertex number")? as i64;
                // Vertices count from 1, and the section of vertices must come before that of elements.
                let known = node >= 1 && node as usize <= file.nodes.len();
                if !known {
                    return Err(FeError::NoSuchNode {
                        element: format!("{} (line {})", i + 1, words.line()),
                        node,
                    });
                }
                *slot = (node - 1) as u32;
            }
            words.number("a reference")?;
            file.add(kind, &nodes[..n_nodes]);
        }
    }
    Ok(file)
}

fn count(words: &mut Words<'_>) -> Result<u64, FeError> {
    let n = words.count("a count")?;
    if n > MAX_COUNT {
        return Err(FeError::TooMany { what: "entries", limit: MAX_COUNT });
    }
    Ok(n)
}
