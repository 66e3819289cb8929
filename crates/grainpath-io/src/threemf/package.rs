//! The zip around the XML: parts, relationships, and limits against bombs.
//!
//! Source: 3MF Core Specification 1.4, chapter 2, and the Open Packaging Conventions. The relationships of the package name
//! the root model part. The relationships of a model part are stored in a separate file beside it. Part names are compared
//! without regard to case. A broken rule gives a warning with the section of the specification; a package without a model
//! part is refused.
//!
//! Parts are inflated as streams, so the longest XML element sets the memory that is needed. Bytes are counted while they
//! inflate, because the sizes in the directory of the archive may be wrong. The limits are 1 GiB for all parts together, and
//! 100 times the packed size for a part of more than 32 MiB. Document type definitions are refused, since entities could
//! expand without bound. External targets are never opened.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Cursor, Read};

use grainpath_core::{Warning, WarningId};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

use crate::mesh::model::{MeshError, MeshProblem};
use crate::xml::attribute;

/// Limit on the inflated size of all parts together. Source: derived. A mesh of 5 million triangles is about 400 MB of
/// XML.
const MAX_INFLATED: u64 = 1 << 30;
/// A part that inflates to more than `BOMB_SIZE` may be at most `BOMB_RATIO` times its packed size.
/// Source: derived. The Deflate format can reach a ratio of 1032; the XML of a mesh is mostly digits and stays far below
/// 100.
const BOMB_SIZE: u64 = 32 << 20;
/// See `BOMB_SIZE`. Source: derived there.
const BOMB_RATIO: u64 = 100;

const MODEL_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
const TICKET_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/printticket";
const THUMBNAIL_TYPE: &str =
    "http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail";
const MODEL_CONTENT_TYPE: &str = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml";
const ROOT_RELATIONSHIPS: &str = "/_rels/.rels";

/// Limit on the relationships of one part. A package with more is refused, since checking them would take too long.
/// Source: chosen; files of real programs stay far below it.
const MAX_RELATIONSHIPS: usize = 10_000;
/// Limit on the warnings about one relationships part. Source: chosen; nobody reads more.
const MAX_WARNINGS: usize = 50;

pub(crate) struct Package<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    inflated: u64,
}

pub(crate) fn invalid(place: &str, problem: MeshProblem) -> MeshError {
    MeshError::Invalid { place: place.to_owned(), problem: Box::new(problem) }
}

impl<'a> Package<'a> {
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Self, MeshError> {
        let zip = ZipArchive::new(Cursor::new(bytes))
            .map_err(|e| invalid("3MF archive", MeshProblem::Reader(e.to_string())))?;
        Ok(Self { zip, inflated: 0 })
    }

    /// Runs `f` over the inflating bytes of a part. OPC compares part names without regard to case.
    pub(crate) fn read<T>(
        &mut self,
        path: &str,
        f: impl FnOnce(Box<dyn BufRead + '_>) -> Result<T, MeshError>,
    ) -> Result<T, MeshError> {
        let name = path.trim_start_matches('/');
        let exact = self.zip.file_names().filter_map(Result::ok).find(|n| n.eq_ignore_ascii_case(name));
        let exact = exact.map(|n| n.into_owned());
        let exact = exact.ok_or_else(|| invalid(path, MeshProblem::NoPart))?;
        let file = self.zip.by_name(&exact).map_err(|e| invalid(path, MeshProblem::Reader(e.to_string())))?;
        let ratio_limit = (file.compressed_size().saturating_mul(BOMB_RATIO)).max(BOMB_SIZE);
        let limit = ratio_limit.min(MAX_INFLATED.saturating_sub(self.inflated));
        // Bytes are counted while they inflate: the sizes in the ZIP directory may lie.
        let mut counted = Counted { inner: file, left: limit, read: 0 };
        let result = f(Box::new(BufReader::with_capacity(1 << 16, &mut counted)));
        let (read, left) = (counted.read, counted.left);
        self.inflated += read;
        // The size limit is checked first, because the XML reader would only report that the XML ends early.
        if left == 0 {
            return Err(invalid(path, MeshProblem::Bomb { limit }));
        }
        result
    }

    /// The path of the root model part, as the package's relationships name it.
    pub(crate) fn root_model(&mut self, warnings: &mut Vec<Warning>) -> Result<String, MeshError> {
        let relationships = self.relationships(ROOT_RELATIONSHIPS)?;
        let mut models = relationships.iter().filter(|r| r.kind == MODEL_TYPE);
        let model = models.next().ok_or_else(|| invalid(ROOT_RELATIONSHIPS, MeshProblem::NoModelPart))?;
        if models.next().is_some() {
            return Err(invalid(ROOT_RELATIONSHIPS, MeshProblem::ModelParts));
        }
        let path = model.target.clone();
        self.check_relationships(ROOT_RELATIONSHIPS, "/", &relationships, warnings);
        self.check_content_types(&path, warnings);
        // OPC puts the relationships of `/3D/a.model` into `/3D/_rels/a.model.rels`.
        let (folder, name) = path.rsplit_once('/').unwrap_or(("", &path));
        let of_model = format!("{folder}/_rels/{name}.rels");
        // A model part without relationships has no such file.
        if self.has(&of_model) {
            match self.relationships(&of_model) {
                Ok(found) => self.check_relationships(&of_model, folder, &found, warnings),
                Err(e) => {
                    warnings.push(Warning::new(WarningId::ThreemfRule, format!("{e} (3MF core 2.1, OPC)")))
                }
            }
        }
        Ok(path)
    }

    /// Whether the archive holds a part of this name.
    pub(crate) fn has(&self, path: &str) -> bool {
        let name = path.trim_start_matches('/');
        self.zip.file_names().filter_map(Result::ok).any(|n| n.eq_ignore_ascii_case(name))
    }

    /// Reads a relationships part.
    fn relationships(&mut self, path: &str) -> Result<Vec<Relationship>, MeshError> {
        let mut all = Vec::new();
        self.read(path, |r| {
            elements(r, path, |e| {
                if e.local_name().as_ref() == "Relationship" {
                    if all.len() == MAX_RELATIONSHIPS {
                        return Err(invalid(path, MeshProblem::Relationships(MAX_RELATIONSHIPS)));
                    }
                    let text = |key: &str| attribute(e, key).unwrap_or_default();
                    all.push(Relationship {
                        id: text("Id"),
                        kind: text("Type"),
                        target: text("Target"),
                        is_external: text("TargetMode").eq_ignore_ascii_case("external"),
                    });
                }
                Ok(())
            })
        })?;
        Ok(all)
    }

    /// Warns of relationships that break a rule. Targets without a leading slash are relative to `folder`.
    fn check_relationships(
        &self,
        path: &str,
        folder: &str,
        all: &[Relationship],
        warnings: &mut Vec<Warning>,
    ) {
        let mut complain = |section: &str, text: String| {
            let text = format!("{text} (3MF {section})");
            let warning = Warning::new(WarningId::ThreemfRule, text).in_file(path.to_owned());
            if !warnings.contains(&warning) && warnings.len() < MAX_WARNINGS {
                warnings.push(warning);
            }
        };
        let (mut ids, mut pairs) = (BTreeSet::new(), BTreeSet::new());
        for r in all {
            if !ids.insert(&r.id) {
                complain("core 2.1, OPC", format!("the relationship id {:?} is given twice", r.id));
            }
            if !pairs.insert((&r.kind, &r.target)) {
                complain("core 2.1.1", format!("two relationships of one type name the part {:?}", r.target));
            }
            // An external target is never opened.
            if r.is_external {
                complain("core 2.1.1", format!("the part {:?} lies outside the package", r.target));
                continue;
            }
            // Other relationships belong to extensions; if their parts are missing, the shape is still
            // complete.
            let needed = [MODEL_TYPE, TICKET_TYPE, THUMBNAIL_TYPE].contains(&r.kind.as_str());
            let target = if r.target.starts_with('/') {
                r.target.clone()
            } else {
                format!("{}/{}", folder.trim_end_matches('/'), r.target)
            };
            if needed && !self.has(&target) {
                complain(
                    "core 2.1.1",
                    format!("the archive has no part {:?}, which a relationship names", r.target),
                );
            }
        }
        if all.iter().filter(|r| r.kind == TICKET_TYPE).count() > 1 {
            complain("core 2.1.4", "more than one print ticket is named".into());
        }
    }

    /// Warns where the package does not state the content type of the model part.
    fn check_content_types(&mut self, model: &str, warnings: &mut Vec<Warning>) {
        const PART: &str = "/[Content_Types].xml";
        let extension = model.rsplit_once('.').map_or("", |(_, e)| e).to_owned();
        let mut content_type = None;
        let read = self.read(PART, |r| {
            elements(r, PART, |e| {
                let names = |key: &str, wanted: &str| {
                    attribute(e, key).is_some_and(|v| v.eq_ignore_ascii_case(wanted))
                };
                match e.local_name().as_ref() {
                    // OPC: an Override for the part's name wins over the Default of its extension, in any
                    // order.
                    "Override" if names("PartName", model) => content_type = attribute(e, "ContentType"),
                    "Default" if content_type.is_none() && names("Extension", &extension) => {
                        content_type = attribute(e, "ContentType");
                    }
                    _ => {}
                }
                Ok(())
            })
        });
        let text = match (read, content_type) {
            (Ok(()), Some(t)) if t == MODEL_CONTENT_TYPE => return,
            (Err(e), _) => format!("{e} (3MF core 2.1, OPC)"),
            (Ok(()), found) => {
                let found = found.map_or("none".to_owned(), |t| format!("{t:?}"));
                format!(
                    "{PART}: the content type of {model} is {found}, not {MODEL_CONTENT_TYPE:?} (3MF core 2.1)"
                )
            }
        };
        warnings.push(Warning::new(WarningId::ThreemfRule, text));
    }
}

/// A link from the package or from a part to another part.
struct Relationship {
    id: String,
    kind: String,
    target: String,
    is_external: bool,
}

/// A reader that stops after `left` bytes.
struct Counted<R> {
    inner: R,
    left: u64,
    read: u64,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        // The limit gives an error, because the XML parser would take an end of file for the end of a short, complete part.
        if self.left == 0 {
            return Err(std::io::Error::other("too long"));
        }
        let n = buffer.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let n = self.inner.read(&mut buffer[..n])?;
        self.left -= n as u64;
        self.read += n as u64;
        Ok(n)
    }
}

/// The units of UTF-16 text. Bytes that cannot be read end the text, which then ends in the middle.
struct Units<R> {
    inner: R,
    unit: fn([u8; 2]) -> u16,
}

impl<R: BufRead> Iterator for Units<R> {
    type Item = u16;

    fn next(&mut self) -> Option<u16> {
        let mut bytes = [0; 2];
        self.inner.read_exact(&mut bytes).ok().map(|()| (self.unit)(bytes))
    }
}

/// UTF-16 text as UTF-8.
struct Utf8<R: BufRead> {
    characters: std::char::DecodeUtf16<Units<R>>,
    /// The rest of a character that did not fit into the last buffer.
    rest: Vec<u8>,
}

impl<R: BufRead> Read for Utf8<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        while self.rest.len() < buffer.len() {
            let Some(c) = self.characters.next() else { break };
            let c = c.unwrap_or(char::REPLACEMENT_CHARACTER);
            self.rest.extend_from_slice(c.encode_utf8(&mut [0; 4]).as_bytes());
        }
        let n = self.rest.len().min(buffer.len());
        buffer[..n].copy_from_slice(&self.rest[..n]);
        self.rest.drain(..n);
        Ok(n)
    }
}

/// XML as UTF-8. UTF-16, which 3MF core 2.3.2 allows too, is known by its byte order mark or by the `<` at its beginning.
fn as_utf8<'r>(mut reader: impl BufRead + 'r) -> std::io::Result<Box<dyn BufRead + 'r>> {
    let (unit, mark): (fn([u8; 2]) -> u16, usize) = match reader.fill_buf()? {
        [0xff, 0xfe, ..] => (u16::from_le_bytes, 2),
        [0xfe, 0xff, ..] => (u16::from_be_bytes, 2),
        [b'<', 0, ..] => (u16::from_le_bytes, 0),
        [0, b'<', ..] => (u16::from_be_bytes, 0),
        _ => return Ok(Box::new(reader)),
    };
    reader.consume(mark);
    let characters = char::decode_utf16(Units { inner: reader, unit });
    Ok(Box::new(BufReader::new(Utf8 { characters, rest: Vec::new() })))
}

/// Reads the events of an XML part, one at a time. Memory stays bounded by the longest element.
pub(crate) fn events(
    reader: impl BufRead,
    path: &str,
    mut each: impl FnMut(&Event<'_>) -> Result<(), MeshError>,
) -> Result<(), MeshError> {
    let reader = as_utf8(reader).map_err(|e| invalid(path, MeshProblem::Reader(e.to_string())))?;
    let mut xml = Reader::from_reader(reader);
    xml.config_mut().check_end_names = true;
    let mut buffer = Vec::new();
    let mut depth = 0i64;
    loop {
        let at = xml.buffer_position();
        let event = xml
            .read_event_into(&mut buffer)
            .map_err(|e| invalid(&format!("{path}, byte {at}"), MeshProblem::Reader(e.to_string())))?;
        match &event {
            Event::Start(_) => depth += 1,
            Event::End(_) => depth -= 1,
            // Document types could define entities that expand without bound.
            Event::DocType(_) => {
                return Err(invalid(path, MeshProblem::DocumentType));
            }
            Event::Eof if depth > 0 => return Err(invalid(path, MeshProblem::Ends)),
            Event::Eof => return Ok(()),
            _ => {}
        }
        // Errors from called functions carry no position, so the byte at which the event begins is reported.
        each(&event).map_err(|e| match e {
            MeshError::Invalid { place, problem } if place.is_empty() => {
                invalid(&format!("{path}, byte {at}"), *problem)
            }
            other => other,
        })?;
        buffer.clear();
    }
}

fn elements(
    reader: impl BufRead,
    path: &str,
    mut each: impl FnMut(&BytesStart<'_>) -> Result<(), MeshError>,
) -> Result<(), MeshError> {
    events(reader, path, |event| match event {
        Event::Start(e) | Event::Empty(e) => each(e),
        _ => Ok(()),
    })
}
