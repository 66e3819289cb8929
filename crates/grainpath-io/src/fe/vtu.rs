//! VTU: VTK's XML file of an unstructured grid.
//!
//! Source: Kitware, *VTK File Formats*, "XML File Formats". Every way to write its arrays is read: ASCII, base64, appended
//! raw or as base64, compressed by zlib, LZMA or LZ4 or not at all, headers of 32 or 64 bits, either byte order, one piece
//! or several. Node numbering is VTK's, which is also grainpath's.
//!
//! Compressed arrays begin with the number of blocks, the size of a full block, the size of the last one and the compressed
//! size of each. Limits: 16 numbers in all arrays for every byte of the file (8 million are always allowed), 2000 arrays,
//! 100 000 pieces, 80 MiB of memory for the LZMA decoder.

use grainpath_core::{Warning, WarningId};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::bytes::{Compression, Raw, Scalar, base64, decompress};
use super::model::{FeArray, FeError, FeFile, FeFormat, MAX_COUNT, On, invalid, position};
use super::problem::FeProblem;
use super::vtk::{VtkCells, add_cells};
use crate::text::skip_space;
use grainpath_core::number::number;

/// Numbers that all arrays together may hold whatever the file's size. The bound stops small files that inflate enormously.
/// Source: derived. A mesh of 100 000 nodes with 80 components fits.
const NUMBERS_ALWAYS: usize = 8 << 20;
// More numbers for every byte of the file. Source: derived. A number takes 4 or 8 bytes unpacked, so the file may inflate
// 64-fold or 128-fold.
const NUMBERS_A_BYTE: usize = 16;
/// Limits on pieces and on arrays in a piece; parallel solvers write a piece for each process.
/// Source: chosen; files of real programs stay far below it.
const MAX_PIECES: usize = 100_000;
/// Source: chosen; files of real programs stay far below it.
const MAX_ARRAYS: usize = 2000;

/// Encoding of the arrays of a file.
#[derive(Clone, Copy, Default)]
struct Style {
    big: bool,
    wide_header: bool,
    compression: Option<Compression>,
}

/// The part of a piece in which an array stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ArrayPlace {
    Other,
    PointData,
    CellData,
    Points,
    Cells,
}

/// An array's attributes.
struct Head {
    name: String,
    scalar: Option<Scalar>,
    components: usize,
    component_names: Vec<String>,
    format: String,
    offset: Option<usize>,
}

struct Array {
    section: ArrayPlace,
    name: String,
    components: usize,
    component_names: Vec<String>,
    values: Vec<f64>,
}

/// The appended data: everything after its underscore.
struct Appended<'a> {
    raw: bool,
    bytes: &'a [u8],
}

struct Vtu<'a> {
    style: Style,
    appended: Option<Appended<'a>>,
    /// Numbers that further arrays may hold.
    numbers_left: usize,
    numbers_most: usize,
    file: FeFile,
    /// Arrays of the current piece.
    piece: Vec<Array>,
    n_points: u64,
    n_cells: u64,
    pieces: usize,
}

pub(crate) fn read(bytes: &[u8]) -> Result<FeFile, FeError> {
    let bytes = skip_space(bytes);
    let (head, appended) = split(bytes)?;
    let numbers_most = NUMBERS_ALWAYS.saturating_add(bytes.len().saturating_mul(NUMBERS_A_BYTE));
    let mut vtu = Vtu {
        style: Style::default(),
        appended,
        numbers_most,
        numbers_left: numbers_most,
        file: FeFile::empty(FeFormat::Vtu),
        piece: Vec::new(),
        n_points: 0,
        n_cells: 0,
        pieces: 0,
    };
    vtu.walk(head)?;
    if vtu.pieces == 0 {
        return Err(invalid("VTU", FeProblem::NoPiece));
    }
    Ok(vtu.file)
}

/// Separates the XML from the appended data, which is not XML.
fn split(bytes: &[u8]) -> Result<(&[u8], Option<Appended<'_>>), FeError> {
    let word = b"<AppendedData";
    // The appended section may be gigabytes of raw bytes, which an XML parser would reject or scan in
    // vain.
    let Some(at) = bytes.windows(word.len()).position(|w| w == word) else { return Ok((bytes, None)) };
    let rest = &bytes[at..];
    let broken = || invalid("AppendedData", FeProblem::NoUnderscore);
    let end = rest.iter().position(|&b| b == b'>').ok_or_else(broken)?;
    // The attribute `encoding` is raw unless it says base64.
    let raw = !rest[..end].windows(6).any(|w| w == b"base64");
    let start = rest[end..].iter().position(|&b| b == b'_').ok_or_else(broken)? + end + 1;
    Ok((&bytes[..at], Some(Appended { raw, bytes: &rest[start..] })))
}

fn attribute(e: &BytesStart<'_>, name: &str) -> Option<String> {
    crate::xml::attribute(e, name)
}

impl<'a> Vtu<'a> {
    fn walk(&mut self, head: &'a [u8]) -> Result<(), FeError> {
        let mut xml = Reader::from_reader(head);
        // The XML ends before the appended data, so the closing tags are missing.
        xml.config_mut().check_end_names = false;
        let mut buffer = Vec::new();
        let mut section = ArrayPlace::Other;
        let mut open: Option<Head> = None;
        let mut text: Vec<u8> = Vec::new();
        loop {
            let at = xml.buffer_position();
            let event = xml
                .read_event_into(&mut buffer)
                .map_err(|e| invalid(format!("VTU, byte {at}"), FeProblem::Xml(e.to_string())))?;
            match event {
                Event::Eof => return Ok(()),
                Event::DocType(_) => {
                    // A document type could define entities that expand without bound.
                    return Err(invalid("VTU", FeProblem::DocumentType));
                }
                Event::Start(e) => {
                    self.start(&e, &mut section)?;
                    if e.local_name().as_ref() == "DataArray" {
                        open = Some(head_of(&e)?);
                        text.clear();
                    }
                }
                Event::Empty(e) => {
                    // An empty section, `<PointData/>`, has no end tag that would reset it.
                    let was = section;
                    self.start(&e, &mut section)?;
                    section = was;
                    if e.local_name().as_ref() == "DataArray" && section != ArrayPlace::Other {
                        self.array(section, head_of(&e)?, &[])?;
                    }
                    if e.local_name().as_ref() == "Piece" {
                        self.end_piece()?;
                    }
                }
                // A DataArray may hold InformationKey elements with text of their own. Data come in one
                // run before them.
                Event::Text(t)
                    if open.is_some() && section != ArrayPlace::Other && skip_space(&text).is_empty() =>
                {
                    text.extend_from_slice(t.as_ref().as_bytes());
                }
                Event::End(e) => match e.local_name().as_ref() {
                    "DataArray" => {
                        if let (Some(head), true) = (open.take(), section != ArrayPlace::Other) {
                            self.array(section, head, &text)?;
                        }
                        text.clear();
                    }
                    "PointData" | "CellData" | "Points" | "Cells" | "FieldData" => {
                        section = ArrayPlace::Other
                    }
                    "Piece" => self.end_piece()?,
                    _ => {}
                },
                _ => {}
            }
            buffer.clear();
        }
    }

    fn start(&mut self, e: &BytesStart<'_>, section: &mut ArrayPlace) -> Result<(), FeError> {
        match e.local_name().as_ref() {
            "VTKFile" => self.header(e)?,
            // Counts above the limit are refused before memory depends on them.
            "Piece" => {
                let count = |name: &str| {
                    let text = attribute(e, name).unwrap_or_default();
                    let n = text.trim().parse::<u64>().ok().filter(|&n| n <= MAX_COUNT);
                    n.ok_or_else(|| {
                        invalid(
                            "Piece",
                            FeProblem::NotACount { name: name.to_owned(), text: text.to_string() },
                        )
                    })
                };
                (self.n_points, self.n_cells) = (count("NumberOfPoints")?, count("NumberOfCells")?);
                self.pieces += 1;
                if self.pieces > MAX_PIECES {
                    return Err(FeError::TooMany { what: "pieces", limit: MAX_PIECES as u64 });
                }
                self.piece.clear();
            }
            "PointData" => *section = ArrayPlace::PointData,
            "CellData" => *section = ArrayPlace::CellData,
            "Points" => *section = ArrayPlace::Points,
            "Cells" => *section = ArrayPlace::Cells,
            "FieldData" => *section = ArrayPlace::Other,
            _ => {}
        }
        Ok(())
    }

    fn header(&mut self, e: &BytesStart<'_>) -> Result<(), FeError> {
        let kind = attribute(e, "type").unwrap_or_default();
        if kind != "UnstructuredGrid" {
            let what = format!("VTKFile of type {kind:?}");
            return Err(FeError::Unsupported { what, reads: "UnstructuredGrid (.vtu)" });
        }
        self.style.big = attribute(e, "byte_order").is_some_and(|o| o == "BigEndian");
        self.style.wide_header = attribute(e, "header_type").is_some_and(|t| t == "UInt64");
        match attribute(e, "compressor").as_deref() {
            None | Some("") => {}
            Some("vtkZLibDataCompressor") => self.style.compression = Some(Compression::Zlib),
            Some("vtkLZMADataCompressor") => self.style.compression = Some(Compression::Xz),
            Some("vtkLZ4DataCompressor") => self.style.compression = Some(Compression::Lz4),
            Some(other) => {
                let what = format!("arrays packed by {other}");
                return Err(FeError::Unsupported {
                    what,
                    reads: "vtkZLibDataCompressor, vtkLZMADataCompressor, vtkLZ4DataCompressor or none",
                });
            }
        }
        Ok(())
    }

    /// Decodes an array of the current piece.
    fn array(&mut self, section: ArrayPlace, head: Head, text: &[u8]) -> Result<(), FeError> {
        let place = || format!("array {:?}", head.name);
        // Arrays of strings hold no numbers and are skipped.
        let Some(scalar) = head.scalar else { return Ok(()) };
        let values = match head.format.as_str() {
            "ascii" => {
                let words = text.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
                let value = |w: &[u8]| {
                    number(w).ok_or_else(|| {
                        let shown = String::from_utf8_lossy(&w[..w.len().min(40)]).into_owned();
                        invalid(place(), FeProblem::not_a(shown, "a number"))
                    })
                };
                words.map(value).collect::<Result<Vec<f64>, _>>()?
            }
            "binary" => {
                let decoded = self.decode(&place(), scalar, Source::Base64(text))?;
                scalar.all(&decoded, self.style.big)
            }
            "appended" => {
                let offset = head.offset.ok_or_else(|| invalid(place(), FeProblem::NoOffset))?;
                let Some(appended) = &self.appended else {
                    return Err(invalid(place(), FeProblem::NoAppendedData));
                };
                let bytes: &'a [u8] = appended.bytes;
                let raw = appended.raw;
                // Offsets count from the byte after the underscore.
                let bytes =
                    bytes.get(offset..).ok_or_else(|| invalid(place(), FeProblem::BeginsBehind(offset)))?;
                let source = if raw { Source::Raw(bytes) } else { Source::Base64(skip_space(bytes)) };
                let decoded = self.decode(&place(), scalar, source)?;
                scalar.all(&decoded, self.style.big)
            }
            other => {
                return Err(invalid(place(), FeProblem::UnknownFormat(other.to_owned())));
            }
        };
        if self.piece.len() >= MAX_ARRAYS {
            return Err(FeError::TooMany { what: "arrays", limit: MAX_ARRAYS as u64 });
        }
        let Head { name, components, component_names, .. } = head;
        self.piece.push(Array { section, name, components, component_names, values });
        Ok(())
    }

    /// The bytes of an array after its header.
    fn decode(&mut self, place: &str, scalar: Scalar, source: Source<'_>) -> Result<Vec<u8>, FeError> {
        let style = self.style;
        // All arrays draw on one budget, so that many arrays that inflate a little are refused like one that inflates
        // enormously.
        let limit = self.numbers_left.saturating_mul(scalar.bytes());
        let bomb = || invalid(place, FeProblem::Bomb("with it the arrays"));
        let word = if style.wide_header { Scalar::U64 } else { Scalar::U32 };
        let cut = || invalid(place, FeProblem::DataEnd);
        // A header is at least one number. In base64 the data may follow in the same group of four
        // characters, so more than the header may be decoded.
        let take = |source: Source<'_>, n: usize| match source {
            Source::Raw(bytes) => bytes[..n.min(bytes.len())].to_vec(),
            Source::Base64(text) => base64(text, n),
        };
        let Some(compression) = style.compression else {
            let header = take(source, word.bytes());
            let n = (Raw { bytes: &header, big: style.big })
                .number(word)
                .ok_or_else(|| if header.is_empty() { invalid(place, FeProblem::NoData) } else { cut() })?
                as usize;
            let held = match source {
                Source::Raw(bytes) => bytes.len(),
                Source::Base64(text) => text.len(),
            };
            // A length beyond the end of the file is damage; the test comes before memory is reserved.
            if n > held {
                return Err(cut());
            }
            if n > limit {
                return Err(bomb());
            }
            self.numbers_left -= n / scalar.bytes();
            let all = match source {
                // Reserves no more than the file can fill.
                Source::Raw(bytes) => bytes.get(word.bytes()..).map(|b| b[..n.min(b.len())].to_vec()),
                Source::Base64(text) => {
                    let mut all = base64(text, n.saturating_add(word.bytes()));
                    (all.len() >= word.bytes()).then(|| all.split_off(word.bytes()))
                }
            };
            let all = all.ok_or_else(cut)?;
            return if all.len() == n { Ok(all) } else { Err(cut()) };
        };
        // A compressed array begins with three numbers: blocks, size of a full block, size of the last
        // block (0 if it is full).
        let first = take(source, 3 * word.bytes());
        let mut header = Raw { bytes: &first, big: style.big };
        let mut next = || header.number(word).map(|v| v as usize).ok_or_else(cut);
        let n_blocks = next()?;
        if n_blocks == 0 {
            return Ok(Vec::new());
        }
        let (block, last) = (next()?, next()?);
        let header_bytes =
            n_blocks.checked_add(3).and_then(|n| n.checked_mul(word.bytes())).ok_or_else(cut)?;
        let whole: Vec<u8>;
        let all: &[u8] = match source {
            Source::Raw(bytes) => bytes,
            Source::Base64(text) => {
                // The sizes of the blocks are decoded first. Their sum says how much belongs to this
                // array; the text after it belongs to others.
                let header = base64(text, header_bytes);
                let sizes =
                    header.get(3 * word.bytes()..).map(|b| word.all(b, style.big)).unwrap_or_default();
                let packed = sizes.iter().sum::<f64>() as usize;
                whole = base64(text, header_bytes.saturating_add(packed));
                &whole
            }
        };
        let sizes = all.get(3 * word.bytes()..header_bytes).ok_or_else(cut)?;
        let sizes = word.all(sizes, style.big);
        let mut data = &all[header_bytes..];
        let mut out = Vec::new();
        for (i, size) in sizes.iter().enumerate() {
            let (packed, rest) = data.split_at_checked(*size as usize).ok_or_else(cut)?;
            data = rest;
            // A last size of 0 means that the last block is full too.
            let full = if i + 1 == n_blocks && last > 0 { last } else { block };
            if full > limit - out.len() {
                return Err(bomb());
            }
            decompress(packed, compression, full, &mut out).map_err(|problem| invalid(place, problem))?;
        }
        self.numbers_left -= out.len() / scalar.bytes();
        Ok(out)
    }

    /// Adds the piece to the file.
    fn end_piece(&mut self) -> Result<(), FeError> {
        let piece = std::mem::take(&mut self.piece);
        let first_node = self.file.nodes.len();
        let n = self.n_points as usize;
        let find = |section: ArrayPlace, name: &str| {
            piece
                .iter()
                .find(|a| a.section == section && (name.is_empty() || a.name.eq_ignore_ascii_case(name)))
        };
        if n > 0 {
            let points = find(ArrayPlace::Points, "").ok_or_else(|| invalid("Piece", FeProblem::NoPoints))?;
            if points.values.len() != 3 * n {
                let found = points.values.len();
                return Err(invalid("Points", FeProblem::Numbers { found, wanted: 3 * n }));
            }
            for (i, p) in points.values.chunks_exact(3).enumerate() {
                self.file.nodes.push(position([p[0], p[1], p[2]], || format!("point {i}"))?);
            }
        }
        // Pieces without cells may leave the section out.
        let cells = |name: &str| find(ArrayPlace::Cells, name).map_or(&[][..], |a| &a.values);
        let (connectivity, offsets, types) = (cells("connectivity"), cells("offsets"), cells("types"));
        if self.n_cells as usize != offsets.len() || offsets.len() != types.len() {
            return Err(invalid(
                "Cells",
                FeProblem::OffsetsAndTypes {
                    offsets: offsets.len(),
                    types: types.len(),
                    cells: self.n_cells,
                },
            ));
        }
        let first_element = self.file.elements.len();
        let kept = add_cells(
            &mut self.file,
            VtkCells { first_node, n_nodes: n, connectivity, ends: offsets, types },
        )?;
        let n_elements = self.file.elements.len();
        for array in piece {
            let (on, n_tuples) = match array.section {
                ArrayPlace::PointData => (On::Nodes, n),
                ArrayPlace::CellData => (On::Elements, self.n_cells as usize),
                _ => continue,
            };
            let c = array.components;
            // The values of an array of the wrong length would reach the wrong nodes. The array is dropped with a
            // warning.
            if array.values.len() != n_tuples.saturating_mul(c) {
                let text = format!(
                    "array {:?} has {} numbers where {} should be; left out",
                    array.name,
                    array.values.len(),
                    n_tuples.saturating_mul(c)
                );
                self.file.warnings.push(Warning::new(WarningId::FeLeftOut, text));
                continue;
            }
            // Cells that were not read take their values with them.
            let values = if on == On::Nodes || kept.len() == n_tuples {
                array.values
            } else {
                kept.iter().flat_map(|&i| array.values[i * c..(i + 1) * c].iter().copied()).collect()
            };
            let before = if on == On::Nodes { first_node } else { first_element };
            let new = FeArray {
                name: array.name,
                on,
                components: c,
                component_names: array.component_names,
                values,
                step: None,
            };
            join(&mut self.file.arrays, new, before);
        }
        // Pieces may have different arrays, and each array is filled up to the whole mesh. The bound
        // covers that growth.
        let tuples: usize = self.file.arrays.iter().map(|a| a.components).sum();
        let most = self.file.nodes.len().max(n_elements);
        if self.file.arrays.len() > MAX_ARRAYS || tuples.saturating_mul(most) > self.numbers_most {
            return Err(invalid("VTU", FeProblem::TooManyArrays));
        }
        // An array that this piece does not have is NaN on it.
        for a in &mut self.file.arrays {
            let n = if a.on == On::Nodes { self.file.nodes.len() } else { n_elements };
            a.values.resize(n * a.components, f64::NAN);
        }
        Ok(())
    }
}

/// Appends an array to the one of the same name from earlier pieces, which hold `before` tuples.
fn join(arrays: &mut Vec<FeArray>, new: FeArray, before: usize) {
    let same = |a: &&mut FeArray| a.name == new.name && a.on == new.on && a.components == new.components;
    match arrays.iter_mut().find(same) {
        Some(a) if a.values.len() <= before * a.components => {
            a.values.resize(before * a.components, f64::NAN);
            a.values.extend(new.values);
        }
        // A second array of the same name in one piece is ignored: the two cannot be distinguished.
        Some(_) => {}
        None => {
            let mut values = vec![f64::NAN; before * new.components];
            values.extend(&new.values);
            arrays.push(FeArray { values, ..new });
        }
    }
}

#[derive(Clone, Copy)]
enum Source<'a> {
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

fn head_of(e: &BytesStart<'_>) -> Result<Head, FeError> {
    let name = attribute(e, "Name").unwrap_or_default();
    let kind = attribute(e, "type").unwrap_or_default();
    let scalar = match kind.as_str() {
        "Int8" => Some(Scalar::I8),
        "UInt8" => Some(Scalar::U8),
        "Int16" => Some(Scalar::I16),
        "UInt16" => Some(Scalar::U16),
        "Int32" => Some(Scalar::I32),
        "UInt32" => Some(Scalar::U32),
        "Int64" => Some(Scalar::I64),
        "UInt64" => Some(Scalar::U64),
        "Float32" => Some(Scalar::F32),
        "Float64" => Some(Scalar::F64),
        // No numbers, so no scalar type.
        "String" => None,
        other => {
            return Err(invalid(format!("array {name:?}"), FeProblem::UnknownType(other.to_owned())));
        }
    };
    let text = attribute(e, "NumberOfComponents").unwrap_or_else(|| "1".into());
    // 10 000 components bound what a damaged attribute can claim.
    let components = text.trim().parse::<usize>().ok().filter(|n| (1..=10_000).contains(n));
    let components = components
        .ok_or_else(|| invalid(format!("array {name:?}"), FeProblem::NumberOfComponents(text.to_string())))?;
    let named = |i: usize| attribute(e, &format!("ComponentName{i}"));
    // Names distinguish tensors of up to nine components only.
    let component_names: Vec<String> = (0..components.min(9)).map_while(named).collect();
    let offset = attribute(e, "offset").and_then(|o| o.trim().parse().ok());
    let format = attribute(e, "format").unwrap_or_else(|| "ascii".into());
    Ok(Head { name, scalar, components, component_names, format, offset })
}
