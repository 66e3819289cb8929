//! CalculiX results (.frd), ASCII and binary: the mesh, displacement, stress and any other result on nodes.
//!
//! Source: *CalculiX GraphiX User's Manual*, "Result Format (frd)". Lines have fixed columns: numbers of 12 characters stand
//! side by side without space. Binary files have the same records with little-endian numbers. Components of a stress are
//! xx, yy, zz, xy, yz, zx.

use super::bytes::{Numbers, Raw, Scalar};
use super::element::ElementKind;
use super::model::{FeArray, FeError, FeFile, FeFormat, MAX_COUNT, On, array_capacity, invalid, position};
use super::problem::FeProblem;
use grainpath_core::number::{number, whole};

/// Values in one line of a record. Source: *CalculiX GraphiX User's Manual*, "Nodal Results Block",
/// format `6E12.5`.
const PER_LINE: usize = 6;

struct Frd<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    file: FeFile,
    numbers: Numbers,
    array_capacity: usize,
    step: usize,
}

pub(crate) fn read(bytes: &[u8]) -> Result<FeFile, FeError> {
    let mut frd = Frd {
        bytes,
        at: 0,
        line: 0,
        file: FeFile::empty(FeFormat::Frd),
        numbers: Numbers::default(),
        array_capacity: array_capacity(bytes.len()),
        step: 1,
    };
    while let Some(line) = frd.next() {
        // The key of a record block fills the first six columns, for example `    2C` for the nodes.
        let key = field(line, 0, 6).trim_ascii();
        match key {
            b"2C" => frd.nodes(line)?,
            b"3C" => frd.elements(line)?,
            b"100CL" | b"100C" => frd.results(line)?,
            b"1P" if field(line, 6, 4) == b"STEP" => {
                // `1PSTEP` with the number of the data set, the increment and the step.
                let step = line.get(48..).map(<[u8]>::trim_ascii).and_then(whole);
                frd.step = step.and_then(|s| usize::try_from(s).ok()).unwrap_or(1).max(1);
            }
            // `9999` is the end record; anything after it is no part of the model.
            b"9999" => break,
            _ => {}
        }
    }
    frd.merge_steps();
    Ok(frd.file)
}

/// A fixed column of a line, as much of it as there is.
fn field(line: &[u8], from: usize, len: usize) -> &[u8] {
    let end = (from + len).min(line.len());
    line.get(from..end).unwrap_or_default()
}

impl<'a> Frd<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..).filter(|r| !r.is_empty())?;
        let n = rest.iter().position(|&b| b == b'\n');
        self.at += n.map_or(rest.len(), |n| n + 1);
        self.line += 1;
        let line = &rest[..n.unwrap_or(rest.len())];
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    fn place(&self) -> String {
        format!("line {}", self.line)
    }

    fn wrong(&self, found: &[u8], wanted: &'static str) -> FeError {
        let shown = String::from_utf8_lossy(found.trim_ascii()).into_owned();
        invalid(self.place(), FeProblem::not_a(shown, wanted))
    }

    fn ends(&self) -> FeError {
        invalid(self.place(), FeProblem::BlockEnds)
    }

    /// Reads the number of records and the layout of a block from its first line.
    fn block(&self, line: &[u8], count_at: usize) -> Result<(usize, Layout), FeError> {
        let count = field(line, count_at, 12);
        // A count above the limit can only be damage and is refused. Memory is taken only as records arrive.
        let n = whole(count.trim_ascii()).and_then(|n| u64::try_from(n).ok()).filter(|&n| n <= MAX_COUNT);
        let n = n.ok_or_else(|| self.wrong(count, "a number of records"))?;
        // The format flag in columns 74 and 75: 0 short ASCII (node numbers in 5 columns), 1 long ASCII
        // (10 columns), 2 and 3 binary with 4 and 8 bytes. Old files leave it empty and are long.
        let layout = match field(line, 73, 2).trim_ascii() {
            b"0" => Layout::Short,
            b"1" | b"" => Layout::Long,
            b"2" => Layout::Single,
            b"3" => Layout::Double,
            other => return Err(self.wrong(other, "a format from 0 to 3")),
        };
        Ok((n as usize, layout))
    }

    fn take(&mut self, n: usize) -> Result<&'a [u8], FeError> {
        let raw = self.bytes.get(self.at..).and_then(|r| r.get(..n)).ok_or_else(|| self.ends())?;
        self.at += n;
        Ok(raw)
    }

    /// The node numbers and values of the records of a block, `n_values` each.
    fn records(
        &mut self,
        n: usize,
        layout: Layout,
        n_values: usize,
        mut each: impl FnMut(&mut Self, i64, &[f64]) -> Result<(), FeError>,
    ) -> Result<(), FeError> {
        let mut values = vec![0.0; n_values];
        // Binary records have no -1 and -3 marks, so only the count in the header says how many there are.
        if let Layout::Single | Layout::Double = layout {
            let scalar = if layout == Layout::Single { Scalar::F32 } else { Scalar::F64 };
            for _ in 0..n {
                let mut raw = Raw { bytes: self.take(4 + n_values * scalar.bytes())?, big: false };
                let node = raw.number(Scalar::I32).unwrap_or_default() as i64;
                for v in &mut values {
                    *v = raw.number(scalar).unwrap_or_default();
                }
                each(self, node, &values)?;
            }
            return Ok(());
        }
        let width = if layout == Layout::Short { 5 } else { 10 };
        // The count in the header is not always right: CalculiX expands plane elements to solids after it
        // has written the header. An ASCII block ends with -3.
        let mut line = self.next().ok_or_else(|| self.ends())?;
        loop {
            match field(line, 0, 3) {
                b" -3" => return Ok(()),
                b" -1" => {}
                other => return Err(self.wrong(other, "a record (-1) or the end of the block (-3)")),
            }
            let number_field = field(line, 3, width);
            let node = whole(number_field.trim_ascii());
            let node = node.ok_or_else(|| self.wrong(number_field, "a node's number"))?;
            let mut column = 3 + width;
            for (k, v) in values.iter_mut().enumerate() {
                // More than six values go on in lines that begin with -2.
                if k > 0 && k % PER_LINE == 0 {
                    line = self.next().ok_or_else(|| self.ends())?;
                    if field(line, 0, 3) != b" -2" {
                        return Err(self.wrong(field(line, 0, 3), "the rest of a record (-2)"));
                    }
                    column = 3 + width;
                }
                let text = field(line, column, 12);
                *v = number(text.trim_ascii()).ok_or_else(|| self.wrong(text, "a number"))?;
                column += 12;
            }
            each(self, node, &values)?;
            line = self.next().ok_or_else(|| self.ends())?;
        }
    }

    fn nodes(&mut self, line: &[u8]) -> Result<(), FeError> {
        let (n, layout) = self.block(line, 24)?;
        self.records(n, layout, 3, |frd, node, p| {
            let p = position([p[0], p[1], p[2]], || format!("node {node}"))?;
            // A second node of the same number would make every reference to it ambiguous.
            if frd.numbers.insert(node).is_none() {
                return Err(invalid(format!("node {node}"), FeProblem::Twice));
            }
            frd.file.nodes.push(p);
            Ok(())
        })
    }

    fn elements(&mut self, line: &[u8]) -> Result<(), FeError> {
        let (n, layout) = self.block(line, 24)?;
        if let Layout::Single | Layout::Double = layout {
            for _ in 0..n {
                // A binary element begins with four 32-bit integers: number, type, group and material.
                let mut raw = Raw { bytes: self.take(16)?, big: false };
                let element = raw.number(Scalar::I32).unwrap_or_default() as i64;
                let kind = raw.number(Scalar::I32).unwrap_or_default() as i64;
                let n_nodes = self.n_nodes(kind)?;
                let nodes = Scalar::I32.all(self.take(4 * n_nodes)?, false);
                let nodes: Vec<i64> = nodes.into_iter().map(|v| v as i64).collect();
                self.element(element, kind, &nodes)?;
            }
            return Ok(());
        }
        let width = if layout == Layout::Short { 5 } else { 10 };
        let mut line = self.next().ok_or_else(|| self.ends())?;
        let mut nodes = Vec::new();
        loop {
            match field(line, 0, 3) {
                b" -3" => return Ok(()),
                b" -1" => {}
                other => return Err(self.wrong(other, "an element (-1) or the end of the block (-3)")),
            }
            let at = |from: usize, len: usize| whole(field(line, from, len).trim_ascii());
            let element = at(3, width).ok_or_else(|| self.wrong(line, "an element's number"))?;
            let kind = at(3 + width, 5).ok_or_else(|| self.wrong(line, "an element's type"))?;
            let n_nodes = self.n_nodes(kind)?;
            nodes.clear();
            while nodes.len() < n_nodes {
                let rest = self.next().ok_or_else(|| self.ends())?;
                if field(rest, 0, 3) != b" -2" {
                    return Err(self.wrong(field(rest, 0, 3), "an element's nodes (-2)"));
                }
                let before = nodes.len();
                // Node numbers stand side by side in fixed columns without space, so words cannot be
                // split at blanks.
                for chunk in rest[3..].chunks(width) {
                    if let (Some(node), true) = (whole(chunk.trim_ascii()), nodes.len() < n_nodes) {
                        nodes.push(node);
                    }
                }
                if nodes.len() == before {
                    return Err(self.wrong(rest, "node numbers"));
                }
            }
            self.element(element, kind, &nodes)?;
            line = self.next().ok_or_else(|| self.ends())?;
        }
    }

    // Element types as the manual numbers them: he8, pe6, tet4, he20, pe15, tet10, tr3, tr6, qu4, qu8,
    // be2, be3.
    fn n_nodes(&self, kind: i64) -> Result<usize, FeError> {
        Ok(match kind {
            1 => 8,
            2 => 6,
            3 => 4,
            4 => 20,
            5 => 15,
            6 => 10,
            7 => 3,
            8 => 6,
            9 => 4,
            10 => 8,
            11 => 2,
            12 => 3,
            _ => return Err(invalid(self.place(), FeProblem::ElementType(kind))),
        })
    }

    fn element(&mut self, element: i64, kind: i64, numbers: &[i64]) -> Result<(), FeError> {
        let mut nodes = [0u32; 20];
        for (slot, &number) in nodes.iter_mut().zip(numbers) {
            let index = self.numbers.get(number);
            *slot =
                index.ok_or_else(|| FeError::NoSuchNode { element: element.to_string(), node: number })?;
        }
        let kind = match kind {
            1 => Ok(ElementKind::Hex8),
            2 => Ok(ElementKind::Wedge6),
            3 => Ok(ElementKind::Tet4),
            4 => {
                // FRD lists the upright edges before those of the upper face; VTK lists them after.
                nodes[12..20].rotate_left(4);
                Ok(ElementKind::Hex20)
            }
            5 => {
                nodes[9..15].rotate_left(3);
                Ok(ElementKind::Wedge15)
            }
            6 => Ok(ElementKind::Tet10),
            7 => Ok(ElementKind::Tri3),
            8 => Ok(ElementKind::Tri6),
            9 => Ok(ElementKind::Quad4),
            10 => Ok(ElementKind::Quad8),
            _ => Err("beams"),
        };
        self.file.add(kind, &nodes[..numbers.len().min(20)]);
        Ok(())
    }

    fn results(&mut self, line: &[u8]) -> Result<(), FeError> {
        let (n, layout) = self.block(line, 24)?;
        let head = self.next().ok_or_else(|| self.ends())?;
        if field(head, 0, 3) != b" -4" {
            return Err(self.wrong(head, "the name of a result (-4)"));
        }
        let name = String::from_utf8_lossy(field(head, 5, 8).trim_ascii()).into_owned();
        // The bound refuses a damaged count before `n_components` lines are read; CalculiX's results have far fewer than
        // 200.
        let n_components = whole(field(head, 13, 5).trim_ascii()).filter(|c| (1..=200).contains(c));
        let n_components = n_components.ok_or_else(|| self.wrong(head, "a number of components"))?;
        let mut component_names = Vec::new();
        for _ in 0..n_components {
            let line = self.next().ok_or_else(|| self.ends())?;
            if field(line, 0, 3) != b" -5" {
                return Err(self.wrong(line, "a component (-5)"));
            }
            // A 1 in the column IEXIST marks a component that the file does not hold, such as the sum `ALL`; readers compute
            // it.
            if field(line, 33, 5).trim_ascii() != b"1" {
                component_names.push(String::from_utf8_lossy(field(line, 5, 8).trim_ascii()).into_owned());
            }
        }
        let components = component_names.len();
        // An array is as long as the mesh even if it has few records, so a small file with many results
        // could claim much memory.
        let n_values = self.file.nodes.len() * components;
        self.array_capacity = self
            .array_capacity
            .checked_sub(n_values)
            .ok_or_else(|| invalid(self.place(), FeProblem::Bomb("the results")))?;
        let mut values = vec![f64::NAN; n_values];
        self.records(n, layout, components, |frd, node, tuple| {
            if let Some(i) = frd.numbers.get(node) {
                let i = i as usize * components;
                if let Some(slots) = values.get_mut(i..i + components) {
                    slots.copy_from_slice(tuple);
                }
            }
            Ok(())
        })?;
        let step = Some(self.step);
        if components > 0 {
            self.file.arrays.push(FeArray { name, on: On::Nodes, components, component_names, values, step });
        }
        Ok(())
    }

    /// Where the file has a single step, arrays carry no step, so that the user need not choose one.
    fn merge_steps(&mut self) {
        let several = self.file.arrays.iter().any(|a| a.step != Some(1));
        if !several {
            for a in &mut self.file.arrays {
                a.step = None;
            }
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Layout {
    Short,
    Long,
    Single,
    Double,
}
