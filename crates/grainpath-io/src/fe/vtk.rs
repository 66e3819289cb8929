//! Legacy VTK: unstructured grids, ASCII and binary.
//!
//! Source: Kitware, *VTK File Formats*, "Simple Legacy Formats", versions 2 to 5.1. Binary numbers are big endian. Cells are
//! one list of counts and nodes before version 5 and two arrays, offsets and connectivity, since then. Fields, scalars,
//! vectors and tensors on points and cells are read; structured grids and polygonal data are refused by name.

use super::bytes::Scalar;
use super::element::ElementKind;
use super::model::{FeArray, FeError, FeFile, FeFormat, MAX_COUNT, On, invalid, position};
use super::problem::FeProblem;
use crate::text::Words;
use grainpath_core::number::number;
use grainpath_core::{Warning, WarningId};

/// Cells as VTK lists them. Their nodes count from `first_node` of the file.
pub(crate) struct VtkCells<'a> {
    pub(crate) first_node: usize,
    pub(crate) n_nodes: usize,
    pub(crate) connectivity: &'a [f64],
    /// End of each cell's nodes in `connectivity`.
    pub(crate) ends: &'a [f64],
    pub(crate) types: &'a [f64],
}

/// Adds cells as elements. Returns the indices of the cells that were added.
pub(crate) fn add_cells(file: &mut FeFile, cells: VtkCells<'_>) -> Result<Vec<usize>, FeError> {
    let mut kept = Vec::with_capacity(cells.types.len());
    let mut start = 0usize;
    let mut nodes = Vec::new();
    for (i, (&end, &kind)) in cells.ends.iter().zip(cells.types).enumerate() {
        let element = || format!("{i} (from 0)");
        let all = cells.connectivity.get(start..end as usize).filter(|_| end >= 0.0);
        let all = all
            .ok_or_else(|| invalid(format!("cell {i}"), FeProblem::NotConnected { from: start, to: end }))?;
        start = end as usize;
        nodes.clear();
        for &n in all {
            // The comparison is written so that NaN fails it.
            if !(n >= 0.0 && n < cells.n_nodes as f64) {
                return Err(FeError::NoSuchNode { element: element(), node: n as i64 });
            }
            nodes.push((cells.first_node + n as usize) as u32);
        }
        let kind = kind_of(kind as u8, &mut nodes);
        if file.add(kind, &nodes) {
            kept.push(i);
        }
    }
    Ok(kept)
}

/// Kind of a VTK cell. Reorders `nodes` where VTK's order of that cell differs from ours.
fn kind_of(vtk: u8, nodes: &mut [u32]) -> Result<ElementKind, &'static str> {
    Ok(match vtk {
        5 => ElementKind::Tri3,
        // Biquadratic and quadratic-linear cells begin with the nodes of the quadratic cell. Their
        // further nodes lie inside and are dropped.
        22 | 34 => ElementKind::Tri6,
        // VTK_PIXEL: corners in the order of an image, so the last two are swapped.
        8 => {
            if let [_, _, c, d, ..] = nodes {
                std::mem::swap(c, d);
            }
            ElementKind::Quad4
        }
        9 => ElementKind::Quad4,
        23 => ElementKind::Quad8,
        28 => ElementKind::Quad9,
        10 => ElementKind::Tet4,
        24 => ElementKind::Tet10,
        // VTK_VOXEL: two pixels, one above the other.
        11 => {
            if let [_, _, c, d, _, _, g, h, ..] = nodes {
                std::mem::swap(c, d);
                std::mem::swap(g, h);
            }
            ElementKind::Hex8
        }
        12 => ElementKind::Hex8,
        // Types 29 and 33 are the triquadratic and biquadratic hexahedra; both begin with the 20 nodes of
        // type 25.
        25 | 29 | 33 => ElementKind::Hex20,
        13 => ElementKind::Wedge6,
        26 | 32 => ElementKind::Wedge15,
        14 | 27 | 37 => ElementKind::Pyramid5,
        1 | 2 => return Err("points"),
        3 | 4 | 21 | 35 | 68 | 75 => return Err("lines"),
        6 => return Err("triangle strips"),
        7 | 36 => return Err("polygons"),
        41 | 42 => return Err("polyhedra"),
        68..=81 => return Err("of higher order"),
        _ => return Err("of kinds grainpath does not read"),
    })
}

struct Vtk<'a> {
    words: Words<'a>,
    binary: bool,
    file: FeFile,
    connectivity: Vec<f64>,
    ends: Vec<f64>,
    types: Vec<f64>,
    /// Entities that the data sections belong to, and the number of tuples.
    on: Option<(On, usize)>,
}

pub(crate) fn read(bytes: &[u8]) -> Result<FeFile, FeError> {
    let mut words = Words::new(bytes, None);
    // Two lines of free text come first: the version and a title.
    words.next_line();
    words.next_line();
    let style = words.word().unwrap_or_default();
    let binary = style.eq_ignore_ascii_case(b"BINARY");
    if !binary && !style.eq_ignore_ascii_case(b"ASCII") {
        return Err(words.wrong(style, "ASCII or BINARY").into());
    }
    let mut vtk = Vtk {
        words,
        binary,
        file: FeFile::empty(FeFormat::Vtk),
        connectivity: Vec::new(),
        ends: Vec::new(),
        types: Vec::new(),
        on: None,
    };
    vtk.walk()?;
    vtk.finish()
}

impl Vtk<'_> {
    fn walk(&mut self) -> Result<(), FeError> {
        while let Some(word) = self.words.word() {
            match word.to_ascii_uppercase().as_slice() {
                b"DATASET" => {
                    let kind = self.words.word().unwrap_or_default().to_ascii_uppercase();
                    if kind != b"UNSTRUCTURED_GRID" {
                        let what = format!("DATASET {}", String::from_utf8_lossy(&kind));
                        return Err(FeError::Unsupported { what, reads: "UNSTRUCTURED_GRID" });
                    }
                }
                b"POINTS" => {
                    let n = self.count("the number of points")?;
                    let scalar = self.scalar()?;
                    let all = self.numbers(scalar, n * 3)?;
                    for (i, p) in all.chunks_exact(3).enumerate() {
                        self.file.nodes.push(position([p[0], p[1], p[2]], || format!("point {i}"))?);
                    }
                }
                b"CELLS" => self.cells()?,
                b"CELL_TYPES" => {
                    let n = self.count("the number of cells")?;
                    // Binary cell types are 32-bit integers in every version, even when connectivity is
                    // not.
                    self.types = self.numbers(Scalar::I32, n)?;
                }
                b"POINT_DATA" => self.on = Some((On::Nodes, self.count("the number of points")?)),
                b"CELL_DATA" => self.on = Some((On::Elements, self.count("the number of cells")?)),
                b"METADATA" => self.metadata(),
                other => self.data(other, word)?,
            }
        }
        Ok(())
    }

    fn finish(mut self) -> Result<FeFile, FeError> {
        // Sections may come in any order, so cells become elements at the end of the file.
        let n_cells = self.types.len();
        if self.ends.len() != n_cells {
            return Err(invalid(
                "CELLS",
                FeProblem::CellsAndTypes { cells: self.ends.len(), types: n_cells },
            ));
        }
        let cells = VtkCells {
            first_node: 0,
            n_nodes: self.file.nodes.len(),
            connectivity: &self.connectivity,
            ends: &self.ends,
            types: &self.types,
        };
        let kept = add_cells(&mut self.file, cells)?;
        let n_nodes = self.file.nodes.len();
        let mut warnings = Vec::new();
        self.file.arrays.retain_mut(|a| {
            let n = if a.on == On::Nodes { n_nodes } else { n_cells };
            if a.values.len() != n * a.components {
                let text = format!("array {:?} does not fit its mesh; left out", a.name);
                // The values of an array of the wrong length would reach the wrong nodes. The array is dropped; the rest of
                // the file stays usable.
                warnings.push(Warning::new(WarningId::FeLeftOut, text));
                return false;
            }
            if a.on == On::Elements && kept.len() != n_cells {
                let c = a.components;
                a.values = kept.iter().flat_map(|&i| a.values[i * c..(i + 1) * c].iter().copied()).collect();
            }
            true
        });
        self.file.warnings.extend(warnings);
        Ok(self.file)
    }

    fn count(&mut self, wanted: &'static str) -> Result<usize, FeError> {
        let n = self.words.count(wanted)?;
        if n > MAX_COUNT {
            return Err(FeError::TooMany { what: wanted, limit: MAX_COUNT });
        }
        Ok(n as usize)
    }

    fn scalar(&mut self) -> Result<Scalar, FeError> {
        let word = self.words.word().unwrap_or_default();
        Ok(match word.to_ascii_lowercase().as_slice() {
            b"float" => Scalar::F32,
            b"double" => Scalar::F64,
            b"int" => Scalar::I32,
            b"unsigned_int" => Scalar::U32,
            b"long" | b"vtkidtype" | b"vtktypeint64" => Scalar::I64,
            b"unsigned_long" | b"vtktypeuint64" => Scalar::U64,
            b"short" => Scalar::I16,
            b"unsigned_short" => Scalar::U16,
            b"char" | b"vtktypeint8" => Scalar::I8,
            b"unsigned_char" | b"vtktypeuint8" => Scalar::U8,
            b"vtktypeint32" => Scalar::I32,
            _ => return Err(self.words.wrong(word, "a type of number").into()),
        })
    }

    /// The next `n` numbers, as words or bytes.
    fn numbers(&mut self, scalar: Scalar, n: usize) -> Result<Vec<f64>, FeError> {
        if self.binary {
            // Binary data begin right after the line break of the keyword's line; skipping all space
            // would eat bytes of data.
            self.words.next_line();
            let raw = n.checked_mul(scalar.bytes()).and_then(|n| self.words.raw(n));
            let raw = raw.ok_or_else(|| invalid(self.words.place(), FeProblem::NumbersMissing(n)))?;
            // Legacy VTK is always big endian.
            return Ok(scalar.all(raw, true));
        }
        let mut all = Vec::new();
        for _ in 0..n {
            all.push(self.words.number("a number")?);
        }
        Ok(all)
    }

    fn cells(&mut self) -> Result<(), FeError> {
        let n = self.count("the number of cells")?;
        let size = self.count("the size of the list of cells")?;
        self.ends.clear();
        if self.word_after_is(b"OFFSETS") {
            // Since version 5.1 the first number is the count of offsets, one more than the count of
            // cells. The first offset is 0 and is dropped.
            self.words.word();
            let scalar = self.scalar()?;
            self.ends = self.numbers(scalar, n)?;
            if !self.ends.is_empty() {
                self.ends.remove(0);
            }
            let word = self.words.word().unwrap_or_default();
            if !word.eq_ignore_ascii_case(b"CONNECTIVITY") {
                return Err(self.words.wrong(word, "`CONNECTIVITY`").into());
            }
            let scalar = self.scalar()?;
            self.connectivity = self.numbers(scalar, size)?;
            return Ok(());
        }
        let all = self.numbers(Scalar::I32, size)?;
        // Before version 5.1 each cell is its number of nodes, followed by these nodes.
        let mut at = 0;
        for i in 0..n {
            let count = all.get(at).copied().unwrap_or(-1.0);
            let nodes =
                all.get(at + 1..).and_then(|rest| rest.get(..count as usize)).filter(|_| count >= 0.0);
            let nodes = nodes.ok_or_else(|| invalid(format!("cell {i}"), FeProblem::ListEnds))?;
            self.connectivity.extend_from_slice(nodes);
            self.ends.push(self.connectivity.len() as f64);
            at += 1 + nodes.len();
        }
        Ok(())
    }

    fn word_after_is(&mut self, wanted: &[u8]) -> bool {
        self.words.peek().is_some_and(|w| w.eq_ignore_ascii_case(wanted))
    }

    /// Skips the metadata that VTK 9 writes after arrays, up to an empty line.
    fn metadata(&mut self) {
        self.words.next_line();
        while !self.words.at_end() && !self.words.rest_of_line().is_empty() {
            self.words.next_line();
        }
    }

    /// An attribute of points or cells.
    fn data(&mut self, keyword: &[u8], word: &[u8]) -> Result<(), FeError> {
        let Some((on, n)) = self.on else {
            // A field before POINT_DATA or CELL_DATA belongs to the file as a whole, for example the
            // time.
            return if keyword == b"FIELD" {
                self.field(None)
            } else {
                Err(self.words.wrong(word, "a section of an unstructured grid").into())
            };
        };
        let components = match keyword {
            b"SCALARS" => 1,
            b"VECTORS" | b"NORMALS" => 3,
            b"TENSORS" => 9,
            b"TENSORS6" => 6,
            b"FIELD" => return self.field(Some((on, n))),
            // Colours are no result. They are read over, so that the sections after them are found.
            b"COLOR_SCALARS" => {
                self.words.word();
                let c = self.count("the number of colours")?;
                self.numbers(Scalar::U8, n.saturating_mul(c))?;
                return Ok(());
            }
            b"LOOKUP_TABLE" => {
                self.words.word();
                let n = self.count("the size of the table")?;
                self.numbers(Scalar::U8, n.saturating_mul(4))?;
                return Ok(());
            }
            b"GLOBAL_IDS" | b"PEDIGREE_IDS" => 1,
            b"TEXTURE_COORDINATES" => 0,
            _ => return Err(self.words.wrong(word, "a section of an unstructured grid").into()),
        };
        let name = self.name();
        let components = if components == 0 { self.count("a dimension")? } else { components };
        let scalar = self.scalar()?;
        let mut components = components;
        if keyword == b"SCALARS" {
            if let Some(word) = self.words.word_on_line() {
                // The number of components is optional and defaults to 1.
                components = number(word).filter(|c| (1.0..=4.0).contains(c)).unwrap_or(1.0) as usize;
            }
            // `LOOKUP_TABLE default` follows in most files, although the format calls it required.
            if self.word_after_is(b"LOOKUP_TABLE") {
                self.words.word();
                self.words.word();
            }
        }
        let values = self.numbers(scalar, n.saturating_mul(components))?;
        self.push(name, on, components, values);
        Ok(())
    }

    fn name(&mut self) -> String {
        // Spaces in names are written as %20.
        let word = self.words.word().unwrap_or_default();
        String::from_utf8_lossy(word).replace("%20", " ")
    }

    fn push(&mut self, name: String, on: On, components: usize, values: Vec<f64>) {
        let component_names = Vec::new();
        self.file.arrays.push(FeArray { name, on, components, component_names, values, step: None });
    }

    fn field(&mut self, on: Option<(On, usize)>) -> Result<(), FeError> {
        self.words.word();
        let n_arrays = self.count("the number of arrays")?;
        for _ in 0..n_arrays {
            if self.word_after_is(b"METADATA") {
                self.words.word();
                self.metadata();
            }
            let name = self.name();
            // A field array states its own size; it is kept only where the size fits the mesh.
            let components = self.count("the number of components")?;
            let tuples = self.count("the number of tuples")?;
            let string = self.word_after_is(b"string");
            if string {
                return Err(FeError::Unsupported { what: "a field of strings".into(), reads: "numbers" });
            }
            let scalar = self.scalar()?;
            let values = self.numbers(scalar, components.saturating_mul(tuples))?;
            if let Some((on, n)) = on
                && n == tuples
                && components > 0
            {
                self.push(name, on, components, values);
            }
        }
        Ok(())
    }
}
