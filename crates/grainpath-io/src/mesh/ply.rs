//! PLY: ASCII, binary little endian and binary big endian.
//!
//! Source: G. Turk, *The PLY Polygon File Format*, Stanford University, 1994. The header declares elements and the types of
//! their properties; the data follow in that order. Vertices need `x`, `y` and `z` of any type, faces a list named
//! `vertex_indices` or `vertex_index`; other elements and properties are skipped. Units: the format has none. An element
//! with rows and without properties is refused, since its count alone could keep the reader busy without end.

use grainpath_core::TriMesh;

use super::model::{MAX_ELEMENTS, MeshError, MeshFile, MeshProblem, merge, triangulate};
use crate::position::checked;
use crate::text::{TextError, Words};

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

/// A scalar type: size in bytes, whether it is a float, whether it is signed.
#[derive(Clone, Copy)]
struct Scalar {
    size: usize,
    float: bool,
    signed: bool,
}

struct Property {
    name: String,
    /// Type of the length of a list; `None` for a single value.
    list: Option<Scalar>,
    scalar: Scalar,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, MeshError> {
    let mut words = Words::new(bytes, None);
    // The first line is the magic word `ply`, which recognised the format.
    words.next_line();
    let (encoding, elements) = header(&mut words)?;
    let mut data = Data { encoding, words, bytes, at: 0, element: String::new(), row: 0 };
    data.at = data.words.offset();
    let mut mesh = TriMesh::default();
    let mut faces: Vec<u32> = Vec::new();
    let mut sizes: Vec<u32> = Vec::new();
    for element in &elements {
        data.element.clone_from(&element.name);
        for row in 0..element.count {
            data.row = row;
            match element.name.as_str() {
                "vertex" => {
                    // A missing coordinate stays NaN and is refused by `checked`.
                    let mut p = [f64::NAN; 3];
                    for property in &element.properties {
                        let value = data.value(property)?;
                        if let Some(axis) = ["x", "y", "z"].iter().position(|a| *a == property.name) {
                            p[axis] = value;
                        }
                    }
                    mesh.vertices.push(checked(p, || data.place())?);
                }
                "face" => {
                    for property in &element.properties {
                        // `vertex_indices` and `vertex_index` are both in use; Turk's text has the
                        // latter.
                        if property.list.is_some() && property.name.starts_with("vertex_ind") {
                            let before = faces.len();
                            data.face(property, &mut faces)?;
                            sizes.push((faces.len() - before) as u32);
                        } else {
                            data.value(property)?;
                        }
                    }
                }
                _ => {
                    for property in &element.properties {
                        data.value(property)?;
                    }
                }
            }
        }
    }
    let n_vertices = mesh.vertices.len();
    // Faces may come before vertices, so indices are checked when all elements have been read.
    if let Some(&bad) = faces.iter().find(|&&i| i as usize >= n_vertices) {
        return Err(MeshError::NoSuchVertex {
            place: "element face".into(),
            index: i64::from(bad),
            n_vertices,
        });
    }
    let mut rest = faces.as_slice();
    for n in sizes {
        let (face, after) = rest.split_at(n as usize);
        triangulate(face, |i| mesh.vertices[i as usize], |t| mesh.triangles.push(t));
        rest = after;
    }
    let body = merge(mesh)?;
    Ok(MeshFile { bodies: vec![body], unit: None, modifiers: Vec::new(), warnings: Vec::new() })
}

fn header(words: &mut Words<'_>) -> Result<(Encoding, Vec<Element>), MeshError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let keyword = words
            .word()
            .ok_or_else(|| TextError::UnexpectedEnd { place: words.place(), expected: "`end_header`" })?;
        match keyword {
            b"format" => {
                let word = words.word_on_line().unwrap_or_default();
                encoding = Some(match word {
                    b"ascii" => Encoding::Ascii,
                    b"binary_little_endian" => Encoding::Little,
                    b"binary_big_endian" => Encoding::Big,
                    _ => {
                        return Err(words
                            .wrong(word, "`ascii` or `binary_little_endian` or `binary_big_endian`")
                            .into());
                    }
                });
            }
            b"element" => {
                let name = String::from_utf8_lossy(words.word_on_line().unwrap_or_default()).into_owned();
                let count = words.count("the number of elements")?;
                // The count in the header may be wrong, so memory is taken only as rows arrive.
                if count > MAX_ELEMENTS {
                    return Err(MeshError::TooMany { what: "elements", limit: MAX_ELEMENTS });
                }
                elements.push(Element { name, count, properties: Vec::new() });
            }
            b"property" => {
                let mut word = words.word_on_line().unwrap_or_default();
                let mut list = None;
                if word == b"list" {
                    let length = words.word_on_line().unwrap_or_default();
                    list = Some(
                        scalar(length)
                            .filter(|s| !s.float)
                            .ok_or_else(|| words.wrong(length, "a whole number type"))?,
                    );
                    word = words.word_on_line().unwrap_or_default();
                }
                let scalar = scalar(word).ok_or_else(|| words.wrong(word, "a PLY type"))?;
                let name = String::from_utf8_lossy(words.word_on_line().unwrap_or_default()).into_owned();
                let place = words.place();
                let element = elements.last_mut().ok_or_else(|| MeshError::Invalid {
                    place,
                    problem: Box::new(MeshProblem::PropertyFirst),
                })?;
                element.properties.push(Property { name, list, scalar });
            }
            b"end_header" => break,
            b"comment" | b"obj_info" => {}
            _ => {
                return Err(words.wrong(keyword, "`element`, `property`, `comment` or `end_header`").into());
            }
        }
        words.next_line();
    }
    // Binary data begin right after the line break of `end_header`.
    words.next_line();
    let encoding = encoding.ok_or_else(|| MeshError::Invalid {
        place: "header".into(),
        problem: Box::new(MeshProblem::NoFormat),
    })?;
    // Rows without a property take no bytes, so a count alone could keep the reader busy without end.
    if let Some(e) = elements.iter().find(|e| e.properties.is_empty() && e.count > 0) {
        let problem = Box::new(MeshProblem::NoProperties { element: e.name.clone(), rows: e.count });
        return Err(MeshError::Invalid { place: "header".into(), problem });
    }
    Ok((encoding, elements))
}

fn scalar(name: &[u8]) -> Option<Scalar> {
    let (size, float, signed) = match name {
        b"char" | b"int8" => (1, false, true),
        b"uchar" | b"uint8" => (1, false, false),
        b"short" | b"int16" => (2, false, true),
        b"ushort" | b"uint16" => (2, false, false),
        b"int" | b"int32" => (4, false, true),
        b"uint" | b"uint32" => (4, false, false),
        b"float" | b"float32" => (4, true, true),
        b"double" | b"float64" => (8, true, true),
        _ => return None,
    };
    Some(Scalar { size, float, signed })
}

/// The values after the header, one after the other.
struct Data<'a> {
    encoding: Encoding,
    words: Words<'a>,
    bytes: &'a [u8],
    at: usize,
    element: String,
    row: u64,
}

impl Data<'_> {
    fn place(&self) -> String {
        if self.encoding == Encoding::Ascii {
            self.words.place()
        } else {
            format!("{} {}", self.element, self.row)
        }
    }

    fn scalar(&mut self, scalar: Scalar) -> Result<f64, MeshError> {
        if self.encoding == Encoding::Ascii {
            return Ok(self.words.number("a number")?);
        }
        let Some(raw) = self.bytes.get(self.at..self.at + scalar.size) else {
            return Err(TextError::UnexpectedEnd { place: self.place(), expected: "a number" }.into());
        };
        self.at += scalar.size;
        // All sizes are widened to eight little-endian bytes, so that one conversion serves every type.
        let mut wide = [0u8; 8];
        if self.encoding == Encoding::Little {
            wide[..scalar.size].copy_from_slice(raw);
        } else {
            for (to, from) in wide.iter_mut().zip(raw.iter().rev()) {
                *to = *from;
            }
        }
        let bits = u64::from_le_bytes(wide);
        Ok(match (scalar.float, scalar.size) {
            (true, 4) => f64::from(f32::from_bits(bits as u32)),
            (true, _) => f64::from_bits(bits),
            (false, size) if scalar.signed => {
                // Sign extension: shift the value to the top and back as a signed number.
                let unused = 64 - 8 * size as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
            _ => bits as f64,
        })
    }

    /// Reads the value of a property. A list is read and dropped.
    fn value(&mut self, property: &Property) -> Result<f64, MeshError> {
        let Some(length) = property.list else { return self.scalar(property.scalar) };
        let n = self.scalar(length)?;
        for _ in 0..n.max(0.0) as u64 {
            self.scalar(property.scalar)?;
        }
        Ok(f64::NAN)
    }

    fn face(&mut self, property: &Property, out: &mut Vec<u32>) -> Result<(), MeshError> {
        let length = property.list.unwrap_or(property.scalar);
        let n = self.scalar(length)?;
        // The comparison also refuses NaN; 65 535 corners bound the work of a damaged length.
        if !(3.0..=65535.0).contains(&n) {
            return Err(MeshError::BadFace { place: self.place(), n: n.max(0.0) as u64 });
        }
        for _ in 0..n as u64 {
            let index = self.scalar(property.scalar)?;
            // Indices are stored in 32 bits.
            if !(0.0..4e9).contains(&index) {
                return Err(MeshError::NoSuchVertex {
                    place: self.place(),
                    index: index as i64,
                    n_vertices: 0,
                });
            }
            out.push(index as u32);
        }
        Ok(())
    }
}
