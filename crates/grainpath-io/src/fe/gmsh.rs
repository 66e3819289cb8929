//! Gmsh MSH 2.2 and 4.1, ASCII and binary, with results on nodes, elements and nodes of elements.
//!
//! Source: *Gmsh Reference Manual*, "MSH file format" and "MSH file format version 2 (Legacy)". Second-order nodes are
//! renumbered from Gmsh's order to VTK's. Physical groups become named groups of nodes. Elements of higher order and points
//! and lines are counted and left out. A result on nodes of elements is averaged at each node.

use std::collections::BTreeMap;

use super::bytes::{Numbers, Scalar};
use super::element::ElementKind;
use super::model::{
    FeArray, FeError, FeFile, FeFormat, Group, MAX_COUNT, On, array_capacity, invalid, position,
};
use super::problem::FeProblem;
use crate::text::Words;
use grainpath_core::number::whole;

/// Limit on the sections of results. Each takes memory for the whole mesh, and a file with more is
/// damaged or malicious. Source: chosen; files of real programs stay far below it.
const MAX_SECTIONS: usize = 100_000;

/// A kind of element as Gmsh numbers it.
struct Kind {
    n_nodes: usize,
    dimension: u8,
    kind: Result<ElementKind, &'static str>,
    /// For each node in VTK's order its position in Gmsh's order; empty where both orders agree.
    order: &'static [usize],
}

// Source: *Gmsh Reference Manual*, "Node ordering", against VTK's order of quadratic cells. Gmsh orders
// the edges by their lower corner, VTK by lower face, upper face and uprights.
const HEX20: [usize; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15];
// Source: *Gmsh Reference Manual*, "Node ordering", Prism15.
const WEDGE15: [usize; 15] = [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11];
// Source: *Gmsh Reference Manual*, "Node ordering", Tetrahedron10: the last two edges are swapped.
const TET10: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];

fn kind(number: i64) -> Option<Kind> {
    use ElementKind::{Hex8, Hex20, Pyramid5, Quad4, Quad8, Quad9, Tet4, Tet10, Tri3, Tri6, Wedge6, Wedge15};
    const NONE: &[usize] = &[];
    // Numbers of "MSH file format", elm-type.
    let (n_nodes, dimension, kind, order) = match number {
        15 => (1, 0, Err("points"), NONE),
        1 => (2, 1, Err("lines"), NONE),
        8 => (3, 1, Err("lines"), NONE),
        26 => (4, 1, Err("lines"), NONE),
        2 => (3, 2, Ok(Tri3), NONE),
        9 => (6, 2, Ok(Tri6), NONE),
        21 => (10, 2, Err("of higher order"), NONE),
        3 => (4, 2, Ok(Quad4), NONE),
        16 => (8, 2, Ok(Quad8), NONE),
        10 => (9, 2, Ok(Quad9), NONE),
        4 => (4, 3, Ok(Tet4), NONE),
        11 => (10, 3, Ok(Tet10), &TET10[..]),
        29 => (20, 3, Err("of higher order"), NONE),
        5 => (8, 3, Ok(Hex8), NONE),
        17 => (20, 3, Ok(Hex20), &HEX20[..]),
        // Nodes in the middle of faces and of the volume are dropped; the 20-node element interpolates
        // closely without them.
        12 => (27, 3, Ok(Hex20), &HEX20[..]),
        6 => (6, 3, Ok(Wedge6), NONE),
        18 => (15, 3, Ok(Wedge15), &WEDGE15[..]),
        13 => (18, 3, Ok(Wedge15), &WEDGE15[..]),
        7 => (5, 3, Ok(Pyramid5), NONE),
        19 => (13, 3, Ok(Pyramid5), NONE),
        14 => (14, 3, Ok(Pyramid5), NONE),
        _ => return None,
    };
    Some(Kind { n_nodes, dimension, kind, order })
}

struct Msh<'a> {
    words: Words<'a>,
    binary: bool,
    big: bool,
    version: u32,
    file: FeFile,
    node_numbers: Numbers,
    element_numbers: Numbers,
    /// Names of physical groups by dimension and number.
    names: BTreeMap<(u8, i64), String>,
    /// Physical groups of entities by dimension and number.
    entities: BTreeMap<(u8, i64), Vec<i64>>,
    /// Nodes of physical groups.
    physical: BTreeMap<(u8, i64), Vec<u32>>,
    array_capacity: usize,
    sections: usize,
}

pub(crate) fn read(bytes: &[u8]) -> Result<FeFile, FeError> {
    let mut msh = Msh {
        words: Words::new(bytes, None),
        binary: false,
        big: false,
        version: 0,
        file: FeFile::empty(FeFormat::Gmsh),
        node_numbers: Numbers::default(),
        element_numbers: Numbers::default(),
        names: BTreeMap::new(),
        entities: BTreeMap::new(),
        physical: BTreeMap::new(),
        array_capacity: array_capacity(bytes.len()),
        sections: 0,
    };
    msh.walk()?;
    msh.finish(array_capacity(bytes.len()))
}

impl<'a> Msh<'a> {
    fn walk(&mut self) -> Result<(), FeError> {
        while let Some(word) = self.words.word() {
            match word {
                b"$MeshFormat" => self.format()?,
                // Version 1 has no $MeshFormat and begins with $NOD.
                b"$NOD" => return Err(self.unsupported("1.0")),
                b"$PhysicalNames" => self.physical_names()?,
                b"$Entities" => self.entities()?,
                b"$Nodes" if self.version == 2 => self.nodes_2()?,
                b"$Nodes" if self.version == 4 => self.nodes_4()?,
                b"$Elements" if self.version == 2 => self.elements_2()?,
                b"$Elements" if self.version == 4 => self.elements_4()?,
                b"$Nodes" | b"$Elements" => {
                    return Err(invalid(self.words.place(), FeProblem::NoMeshFormat));
                }
                b"$NodeData" => self.data(On::Nodes, false)?,
                b"$ElementData" => self.data(On::Elements, false)?,
                b"$ElementNodeData" => self.data(On::Nodes, true)?,
                section => self.skip(section),
            }
        }
        Ok(())
    }

    fn unsupported(&self, version: &str) -> FeError {
        FeError::Unsupported { what: format!("Gmsh MSH {version}"), reads: "versions 2.2 and 4.1" }
    }

    fn format(&mut self) -> Result<(), FeError> {
        let version = self.words.word().unwrap_or_default();
        self.version = match version {
            b"2.2" | b"2.1" | b"2" | b"2.0" => 2,
            b"4.1" => 4,
            other => return Err(self.unsupported(&String::from_utf8_lossy(&other[..other.len().min(20)]))),
        };
        self.binary = self.words.count("0 or 1, ASCII or binary")? == 1;
        // The manual fixes data-size to sizeof(double) = 8; another value would shift every binary
        // record.
        if self.words.count("the size of a number")? != 8 {
            return Err(invalid(self.words.place(), FeProblem::NumberSize));
        }
        if self.binary {
            self.words.next_line();
            // A binary file stores the integer 1 to show its byte order.
            let one = self.words.raw(4).unwrap_or_default();
            self.big = match one {
                [1, 0, 0, 0] => false,
                [0, 0, 0, 1] => true,
                _ => return Err(invalid("$MeshFormat", FeProblem::NoBinaryOne)),
            };
        }
        Ok(())
    }

    /// Skips a section that is not used, up to its end mark.
    fn skip(&mut self, section: &[u8]) {
        if !section.starts_with(b"$") || section.starts_with(b"$End") {
            return;
        }
        let end = [b"$End", &section[1..]].concat();
        while let Some(word) = self.words.word() {
            if word == end {
                return;
            }
        }
    }

    /// Reads one number, from a word in ASCII files and from bytes in binary ones.
    fn number(&mut self, scalar: Scalar, wanted: &'static str) -> Result<f64, FeError> {
        if self.binary {
            let raw = self.words.raw(scalar.bytes());
            let raw = raw.ok_or_else(|| invalid(self.words.place(), FeProblem::EndsBefore(wanted)))?;
            return Ok(scalar.all(raw, self.big)[0]);
        }
        Ok(self.words.number(wanted)?)
    }

    /// Reads a whole number that identifies something.
    fn tag(&mut self, scalar: Scalar, wanted: &'static str) -> Result<i64, FeError> {
        let value = self.number(scalar, wanted)?;
        // Numbers pass through f64, which is exact for integers below 2^53, about 9.007e15.
        if value.fract() == 0.0 && value.abs() < 9e15 {
            return Ok(value as i64);
        }
        Err(invalid(self.words.place(), FeProblem::Unexpected { found: value, wanted }))
    }

    fn count(&mut self, scalar: Scalar, wanted: &'static str) -> Result<usize, FeError> {
        let n = self.tag(scalar, wanted)?;
        if n < 0 {
            return Err(invalid(self.words.place(), FeProblem::Unexpected { found: n as f64, wanted }));
        }
        if n as u64 > MAX_COUNT {
            return Err(FeError::TooMany { what: wanted, limit: MAX_COUNT });
        }
        Ok(n as usize)
    }

    /// Before binary data: to the beginning of the next line.
    fn begin_data(&mut self) {
        if self.binary {
            self.words.next_line();
        }
    }

    fn physical_names(&mut self) -> Result<(), FeError> {
        let n = self.words.count("the number of names")?;
        // The loop ends with the file, so a false count costs no memory.
        for _ in 0..n.min(MAX_COUNT) {
            let dimension = self.words.count("a dimension")?;
            let tag = self.words.word().and_then(whole).unwrap_or(0);
            let name = String::from_utf8_lossy(self.words.rest_of_line()).trim_matches('"').to_owned();
            self.names.insert((dimension.min(9) as u8, tag), name);
        }
        Ok(())
    }

    fn entities(&mut self) -> Result<(), FeError> {
        if self.version != 4 {
            self.skip(b"$Entities");
            return Ok(());
        }
        self.begin_data();
        let mut counts = [0; 4];
        for c in &mut counts {
            // Points, curves, surfaces and volumes, in this order.
            *c = self.count(Scalar::U64, "the number of entities")?;
        }
        for (dimension, n) in counts.into_iter().enumerate() {
            for _ in 0..n {
                let tag = self.tag(Scalar::I32, "an entity")?;
                // A point has a position, every other entity a bounding box of two corners.
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    self.number(Scalar::F64, "a coordinate")?;
                }
                let mut groups = Vec::new();
                for _ in 0..self.count(Scalar::U64, "the number of groups")? {
                    groups.push(self.tag(Scalar::I32, "a group")?);
                }
                if dimension > 0 {
                    for _ in 0..self.count(Scalar::U64, "the number of bounding entities")? {
                        self.tag(Scalar::I32, "an entity")?;
                    }
                }
                if !groups.is_empty() {
                    self.entities.insert((dimension as u8, tag), groups);
                }
            }
        }
        Ok(())
    }

    fn node(&mut self, tag: i64) -> Result<(), FeError> {
        let mut p = [0.0; 3];
        for c in &mut p {
            *c = self.number(Scalar::F64, "a coordinate")?;
        }
        self.add_node(tag, p)
    }

    fn add_node(&mut self, tag: i64, p: [f64; 3]) -> Result<(), FeError> {
        let p = position(p, || format!("node {tag}"))?;
        // Gmsh repeats the mesh before each result it appends to a file, so the same node may come again.
        match self.node_numbers.get(tag) {
            Some(i) if self.file.nodes[i as usize] == p => return Ok(()),
            Some(_) => return Err(invalid(format!("node {tag}"), FeProblem::TwiceElsewhere)),
            None => {}
        }
        if self.node_numbers.insert(tag).is_none() {
            return Err(FeError::TooMany { what: "nodes", limit: u64::from(u32::MAX) });
        }
        self.file.nodes.push(p);
        Ok(())
    }

    fn nodes_2(&mut self) -> Result<(), FeError> {
        let n = self.words.count("the number of nodes")?;
        self.begin_data();
        for _ in 0..n {
            let tag = self.tag(Scalar::I32, "a node's number")?;
            self.node(tag)?;
        }
        Ok(())
    }

    fn nodes_4(&mut self) -> Result<(), FeError> {
        self.begin_data();
        let blocks = self.count(Scalar::U64, "the number of blocks")?;
        // Total count, lowest and highest tag. They only help to allocate and are not trusted.
        for _ in 0..3 {
            self.tag(Scalar::U64, "a count of nodes")?;
        }
        for _ in 0..blocks {
            let dimension = self.count(Scalar::I32, "a dimension")?;
            self.tag(Scalar::I32, "an entity")?;
            let parametric = self.tag(Scalar::I32, "0 or 1")? != 0;
            let n = self.count(Scalar::U64, "the number of nodes")?;
            let mut tags = Vec::new();
            for _ in 0..n {
                // Version 4.1 lists all tags of a block before its coordinates.
                tags.push(self.tag(Scalar::U64, "a node's number")?);
            }
            for tag in tags {
                self.node(tag)?;
                // Parametric coordinates on the entity follow the position; their number is the entity's
                // dimension.
                for _ in 0..if parametric { dimension.min(3) } else { 0 } {
                    self.number(Scalar::F64, "a parameter")?;
                }
            }
        }
        Ok(())
    }

    /// One element whose nodes follow. `groups` are the physical groups it is in.
    fn element(&mut self, tag: i64, kind: &Kind, scalar: Scalar, groups: &[i64]) -> Result<(), FeError> {
        let mut nodes = [0u32; 27];
        // The largest element that is read, Hexahedron27, has 27 nodes.
        for slot in &mut nodes[..kind.n_nodes] {
            let number = self.tag(scalar, "a node's number")?;
            let index = self.node_numbers.get(number);
            *slot = index.ok_or_else(|| FeError::NoSuchNode { element: tag.to_string(), node: number })?;
        }
        // Groups of elements become groups of nodes: supports and loads are stated on nodes.
        for &g in groups {
            self.physical.entry((kind.dimension, g)).or_default().extend(&nodes[..kind.n_nodes]);
        }
        let mut ours = nodes;
        for (to, &from) in ours.iter_mut().zip(kind.order) {
            *to = nodes[from];
        }
        let ours = &ours[..if kind.order.is_empty() { kind.n_nodes } else { kind.order.len() }];
        // The mesh may be repeated before each result; the same element is added once.
        let known = self.element_numbers.get(tag).and_then(|i| self.file.elements.get(i as usize));
        if known.is_some_and(|e| kind.kind == Ok(e.kind) && e.nodes() == &ours[..e.nodes().len()]) {
            return Ok(());
        }
        let taken = self.file.add(kind.kind, ours);
        // Two different elements may share a tag; results then go to the first one. The second gets a number far below any
        // real tag, so that element indices and numbers stay in step.
        if taken && self.element_numbers.insert(tag).is_none() {
            let free = -1 - self.file.elements.len() as i64 - (1 << 60);
            self.element_numbers.insert(free);
        }
        Ok(())
    }

    fn kind(&self, number: i64) -> Result<Kind, FeError> {
        kind(number).ok_or_else(|| {
            let what = format!("{}: element type {number}", self.words.place());
            FeError::Unsupported {
                what,
                reads: "triangles, quads, tets, pyramids, wedges and hexes to order 2",
            }
        })
    }

    fn elements_2(&mut self) -> Result<(), FeError> {
        let n = self.words.count("the number of elements")?;
        self.begin_data();
        let mut done = 0;
        let mut tags = Vec::new();
        while done < n {
            // In binary files a header of type, count and number of tags stands before each run of
            // elements; in ASCII files each line has its own.
            let (number, block, n_tags) = if self.binary {
                let number = self.tag(Scalar::I32, "an element type")?;
                let block = self.count(Scalar::I32, "a count of elements")?;
                (Some(number), block.max(1), self.count(Scalar::I32, "a count of tags")?)
            } else {
                (None, 1, 0)
            };
            for _ in 0..block {
                let tag = self.tag(Scalar::I32, "an element's number")?;
                let kind = match number {
                    Some(k) => self.kind(k)?,
                    None => {
                        let k = self.tag(Scalar::I32, "an element type")?;
                        self.kind(k)?
                    }
                };
                let n_tags = if self.binary { n_tags } else { self.count(Scalar::I32, "a count of tags")? };
                tags.clear();
                for _ in 0..n_tags {
                    tags.push(self.tag(Scalar::I32, "a tag")?);
                }
                // The first tag is the physical group, 0 for none.
                let group: Vec<i64> = tags.first().copied().filter(|&g| g != 0).into_iter().collect();
                self.element(tag, &kind, Scalar::I32, &group)?;
                done += 1;
            }
        }
        Ok(())
    }

    fn elements_4(&mut self) -> Result<(), FeError> {
        self.begin_data();
        let blocks = self.count(Scalar::U64, "the number of blocks")?;
        // Total count, lowest and highest tag, as for nodes.
        for _ in 0..3 {
            self.tag(Scalar::U64, "a count of elements")?;
        }
        for _ in 0..blocks {
            let dimension = self.count(Scalar::I32, "a dimension")?;
            let entity = self.tag(Scalar::I32, "an entity")?;
            let number = self.tag(Scalar::I32, "an element type")?;
            let kind = self.kind(number)?;
            // Version 4 puts groups on entities, not on elements.
            let groups = self.entities.get(&(dimension.min(9) as u8, entity)).cloned().unwrap_or_default();
            for _ in 0..self.count(Scalar::U64, "the number of elements")? {
                let tag = self.tag(Scalar::U64, "an element's number")?;
                self.element(tag, &kind, Scalar::U64, &groups)?;
            }
        }
        Ok(())
    }

    fn data(&mut self, on: On, of_elements: bool) -> Result<(), FeError> {
        self.sections += 1;
        if self.sections > MAX_SECTIONS {
            return Err(FeError::TooMany { what: "sections of results", limit: MAX_SECTIONS as u64 });
        }
        // The head of a result has three lists: texts (the first is the name), reals (time) and integers
        // (step, components, count).
        let mut name = String::new();
        for i in 0..self.words.count("the number of texts")?.min(MAX_COUNT) {
            self.words.next_line();
            if self.words.at_end() {
                return Err(invalid(self.words.place(), FeProblem::HeadEnds));
            }
            let text = self.words.rest_of_line();
            if i == 0 {
                name = String::from_utf8_lossy(text).trim_matches('"').to_owned();
            }
        }
        for _ in 0..self.words.count("the number of reals")?.min(MAX_COUNT) {
            self.words.number("a real")?;
        }
        let n_whole = self.words.count("the number of whole numbers")?;
        let (mut step, mut components, mut n) = (0, 0, 0);
        for i in 0..n_whole.min(MAX_COUNT) {
            let value = self.words.count("a whole number")?;
            match i {
                0 => step = value as usize,
                1 => components = value as usize,
                2 => n = value,
                _ => {}
            }
        }
        // Gmsh writes scalars (1), vectors (3) and tensors (9); more would be damage.
        if !(1..=9).contains(&components) || n > MAX_COUNT {
            let problem = FeProblem::Components { components, n };
            return Err(invalid(self.words.place(), problem));
        }
        self.begin_data();
        let tuples = if on == On::Nodes { self.file.nodes.len() } else { self.file.elements.len() };
        // The array is as long as the mesh however few tuples the section holds. Without this bound many
        // small sections would exhaust memory.
        let n_values = tuples * components;
        self.array_capacity = self
            .array_capacity
            .checked_sub(n_values)
            .ok_or_else(|| invalid(self.words.place(), FeProblem::Bomb("the results")))?;
        let mut values = vec![f64::NAN; n_values];
        if of_elements {
            self.element_nodes(&mut values, components, n)?;
        } else {
            for _ in 0..n {
                let tag = self.tag(Scalar::I32, "a number of a node or element")?;
                let index = match on {
                    On::Nodes => self.node_numbers.get(tag),
                    On::Elements => self.element_numbers.get(tag),
                };
                for k in 0..components {
                    let value = self.number(Scalar::F64, "a value")?;
                    if let Some(slot) = index.and_then(|i| values.get_mut(i as usize * components + k)) {
                        *slot = value;
                    }
                }
            }
        }
        let array =
            FeArray { name, on, components, component_names: Vec::new(), values, step: Some(step + 1) };
        self.file.arrays.push(array);
        Ok(())
    }

    /// Values at the nodes of each element, averaged at each node with the size of the elements as
    /// weight.
    fn element_nodes(&mut self, values: &mut [f64], components: usize, n: u64) -> Result<(), FeError> {
        let mut weights = vec![0.0; self.file.nodes.len()];
        for _ in 0..n {
            let tag = self.tag(Scalar::I32, "an element's number")?;
            let n_nodes = self.count(Scalar::I32, "a number of nodes")?;
            let element =
                self.element_numbers.get(tag).and_then(|i| self.file.elements.get(i as usize)).copied();
            // A flat element still counts, otherwise its nodes would divide zero by zero.
            let weight = element.map_or(0.0, |e| e.size(&self.file.nodes).max(f64::MIN_POSITIVE));
            // Values come in Gmsh's node order. Kinds whose middle nodes are renumbered keep only the
            // values at their corners, where both orders agree.
            let same = element.is_some_and(|e| {
                !matches!(e.kind, ElementKind::Tet10 | ElementKind::Wedge15 | ElementKind::Hex20)
            });
            for j in 0..n_nodes {
                let node = element
                    .and_then(|e| if same { e.nodes() } else { e.corners() }.get(j).copied())
                    .map(|i| i as usize);
                for k in 0..components {
                    let value = self.number(Scalar::F64, "a value")?;
                    let Some(node) = node else { continue };
                    let slot = &mut values[node * components + k];
                    *slot = if slot.is_nan() { 0.0 } else { *slot } + weight * value;
                }
                if let Some(node) = node {
                    weights[node] += weight;
                }
            }
        }
        for (tuple, w) in values.chunks_exact_mut(components).zip(weights) {
            for v in tuple {
                *v /= w;
            }
        }
        Ok(())
    }

    fn finish(mut self, capacity: usize) -> Result<FeFile, FeError> {
        for ((dimension, tag), mut nodes) in std::mem::take(&mut self.physical) {
            nodes.sort_unstable();
            nodes.dedup();
            let name = self.names.get(&(dimension, tag)).cloned();
            let name = name.unwrap_or_else(|| format!("group {tag} of dimension {dimension}"));
            self.file.groups.push(Group { name, nodes });
        }
        // A result may be followed by more mesh, so earlier arrays are lengthened here. The bound covers
        // that growth too.
        let (n_nodes, n_elements) = (self.file.nodes.len(), self.file.elements.len());
        let components: usize = self.file.arrays.iter().map(|a| a.components).sum();
        if components.saturating_mul(n_nodes.max(n_elements)) > capacity {
            return Err(invalid("MSH", FeProblem::Bomb("the results")));
        }
        for a in &mut self.file.arrays {
            let n = if a.on == On::Nodes { n_nodes } else { n_elements };
            a.values.resize(n * a.components, f64::NAN);
        }
        Ok(self.file)
    }
}
