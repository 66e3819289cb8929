//! The zip around the XML: parts, relationships, and limits against bombs.

use grainpath_core::{Warning, WarningId};
use std::io::{BufRead, BufReader, Cursor, Read};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

use crate::mesh::model::MeshError;
use crate::xml::attribute;

/// All parts together may inflate to this.
const MAX_INFLATED: u64 = 1 << 30;
/// A part that inflates to more than this must not be more than this many times its packed size.
const BOMB_SIZE: u64 = 32 << 20;
const BOMB_RATIO: u64 = 100;

const MODEL_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
const TICKET_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/printticket";

pub(crate) struct Package<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    inflated: u64,
}

pub(crate) fn invalid(place: &str, problem: impl Into<String>) -> MeshError {
    MeshError::Invalid { place: place.to_owned(), problem: problem.into() }
}

impl<'a> Package<'a> {
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Self, MeshError> {
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(|e| invalid("3MF archive", e.to_string()))?;
        Ok(Self { zip, inflated: 0 })
    }

    /// Runs `f` over the inflating bytes of a part; names are compared without regard to case.
    pub(crate) fn read<T>(
        &mut self,
        path: &str,
        f: impl FnOnce(Box<dyn BufRead + '_>) -> Result<T, MeshError>,
    ) -> Result<T, MeshError> {
        let name = path.trim_start_matches('/');
        let exact = self.zip.file_names().filter_map(Result::ok).find(|n| n.eq_ignore_ascii_case(name));
        let exact = exact.map(|n| n.into_owned());
        let exact = exact.ok_or_else(|| invalid(path, "the archive has no such part"))?;
        let file = self.zip.by_name(&exact).map_err(|e| invalid(path, e.to_string()))?;
        let ratio_limit = (file.compressed_size().saturating_mul(BOMB_RATIO)).max(BOMB_SIZE);
        let limit = ratio_limit.min(MAX_INFLATED.saturating_sub(self.inflated));
        let mut counted = Counted { inner: file, left: limit, read: 0 };
        let result = f(Box::new(BufReader::with_capacity(1 << 16, &mut counted)));
        let (read, left) = (counted.read, counted.left);
        self.inflated += read;
        if left == 0 {
            return Err(invalid(path, format!("inflates to more than {limit} bytes; refused as a zip bomb")));
        }
        result
    }

    /// The path of the root model part by the package's relationships.
    pub(crate) fn root_model(&mut self, warnings: &mut Vec<Warning>) -> Result<String, MeshError> {
        let mut models = Vec::new();
        let mut tickets = 0;
        let relationships = "/_rels/.rels";
        self.read(relationships, |r| {
            elements(r, relationships, |e| {
                if e.local_name().as_ref() == "Relationship" {
                    let kind = attribute(e, "Type").unwrap_or_default();
                    if kind == MODEL_TYPE {
                        models.push(attribute(e, "Target").unwrap_or_default());
                    }
                    tickets += usize::from(kind == TICKET_TYPE);
                }
                Ok(())
            })
        })?;
        let model =
            models.first().cloned().ok_or_else(|| invalid(relationships, "no 3D model part is named"))?;
        if models.len() > 1 {
            return Err(invalid(relationships, "more than one 3D model part is named"));
        }
        if tickets > 1 {
            let text = "more than one print ticket is named for the package";
            warnings.push(Warning::new(WarningId::ThreemfRule, text));
        }
        self.part_tickets(&model, warnings);
        Ok(model)
    }

    /// A model part has one print ticket at the most.
    fn part_tickets(&mut self, model: &str, warnings: &mut Vec<Warning>) {
        let (folder, name) = model.rsplit_once('/').unwrap_or(("", model));
        let path = format!("{folder}/_rels/{name}.rels");
        let mut tickets = 0;
        let read = self.read(&path, |r| {
            elements(r, &path, |e| {
                tickets += usize::from(attribute(e, "Type").is_some_and(|t| t == TICKET_TYPE));
                Ok(())
            })
        });
        if read.is_ok() && tickets > 1 {
            let text = "more than one print ticket is named for the model";
            warnings.push(Warning::new(WarningId::ThreemfRule, text).in_file(path));
        }
    }
}

/// Stops reading after `left` bytes.
struct Counted<R> {
    inner: R,
    left: u64,
    read: u64,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
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

/// What an XML part tells, one element at a time.
pub(crate) fn events(
    reader: impl BufRead,
    path: &str,
    mut each: impl FnMut(&Event<'_>) -> Result<(), MeshError>,
) -> Result<(), MeshError> {
    let mut xml = Reader::from_reader(reader);
    xml.config_mut().check_end_names = true;
    let mut buffer = Vec::new();
    let mut depth = 0i64;
    loop {
        let at = xml.buffer_position();
        let event = xml
            .read_event_into(&mut buffer)
            .map_err(|e| invalid(&format!("{path}, byte {at}"), e.to_string()))?;
        match &event {
            Event::Start(_) => depth += 1,
            Event::End(_) => depth -= 1,
            Event::DocType(_) => return Err(invalid(path, "a document type definition, which 3MF forbids")),
            Event::Eof if depth > 0 => return Err(invalid(path, "the XML ends in the middle")),
            Event::Eof => return Ok(()),
            _ => {}
        }
        each(&event).map_err(|e| match e {
            MeshError::Invalid { place, problem } if place.is_empty() => {
                invalid(&format!("{path}, byte {at}"), problem)
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
