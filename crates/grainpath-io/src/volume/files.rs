//! The files of a volume and how they are opened.

use std::cmp::Ordering;
use std::io::{self, BufReader, Cursor, Read, Seek};
use std::sync::{Arc, Mutex};

use super::{VolumeError, VolumeProblem, damaged, error, io_error};

/// Source of a volume's bytes that supports reading and seeking.
pub trait ReadSeek: Read + Seek + Send {}
impl<T: Read + Seek + Send> ReadSeek for T {}

type LeadsOutside = dyn Fn(&str, &str) -> bool + Send + Sync;
type Open = dyn Fn(&str) -> io::Result<Box<dyn ReadSeek>> + Send + Sync;

/// Names of files and a function that opens them. A header file may name other files beside it.
#[derive(Clone)]
pub struct Files {
    place: String,
    names: Vec<String>,
    folder: bool,
    outside_allowed: bool,
    open: Arc<Open>,
    leads_outside: Arc<LeadsOutside>,
}

impl Files {
    /// A single file. `open` may be asked for other files that its header names, relative to it.
    pub fn single(
        name: impl Into<String>,
        open: impl Fn(&str) -> io::Result<Box<dyn ReadSeek>> + Send + Sync + 'static,
    ) -> Self {
        let name = name.into();
        Self {
            place: name.clone(),
            names: vec![name],
            folder: false,
            outside_allowed: false,
            open: Arc::new(open),
            leads_outside: Arc::new(|_, _| false),
        }
    }

    /// A folder with these files. They are put into natural order.
    pub fn folder(
        place: impl Into<String>,
        mut names: Vec<String>,
        open: impl Fn(&str) -> io::Result<Box<dyn ReadSeek>> + Send + Sync + 'static,
    ) -> Self {
        names.sort_by(|a, b| natural_order(a, b));
        Self { names, folder: true, ..Self::single(place, open) }
    }

    /// The name of the volume in messages.
    pub fn place(&self) -> &str {
        &self.place
    }

    /// The files' names.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    pub(crate) fn is_folder(&self) -> bool {
        self.folder
    }

    pub(crate) fn open(&self, name: &str) -> Result<BufReader<Box<dyn ReadSeek>>, VolumeError> {
        let reader = (self.open)(name).map_err(|e| io_error(name, &e))?;
        // Network and archive readers are slow for small reads, so 64 KiB are read at a time.
        Ok(BufReader::with_capacity(1 << 16, reader))
    }

    /// The first bytes of a file, as many as there are.
    pub(crate) fn head(&self, name: &str, n: u64) -> Result<Vec<u8>, VolumeError> {
        let mut head = Vec::new();
        self.open(name)?.take(n).read_to_end(&mut head).map_err(|e| io_error(name, &e))?;
        Ok(head)
    }

    /// A whole file, which may not be larger than `limit` bytes.
    pub(crate) fn whole(&self, name: &str, limit: u64) -> Result<Vec<u8>, VolumeError> {
        let missing = || io_error(name, &io::ErrorKind::NotFound.into());
        self.whole_or_none(name, limit)?.ok_or_else(missing)
    }

    /// Opens a file; `None` where there is none.
    pub(crate) fn open_or_none(
        &self,
        name: &str,
    ) -> Result<Option<BufReader<Box<dyn ReadSeek>>>, VolumeError> {
        match (self.open)(name) {
            Ok(reader) => Ok(Some(BufReader::with_capacity(1 << 16, reader))),
            Err(e) if matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Ok(None),
            Err(e) => Err(io_error(name, &e)),
        }
    }

    /// A whole file of at most `limit` bytes; `None` where there is none.
    pub(crate) fn whole_or_none(&self, name: &str, limit: u64) -> Result<Option<Vec<u8>>, VolumeError> {
        let Some(reader) = self.open_or_none(name)? else { return Ok(None) };
        let mut bytes = Vec::new();
        reader.take(limit + 1).read_to_end(&mut bytes).map_err(|e| io_error(name, &e))?;
        if bytes.len() as u64 > limit {
            return Err(error(name, VolumeProblem::FileTooLarge { limit }));
        }
        Ok(Some(bytes))
    }

    /// Refuses files beside a header that are links to places outside its folder. `leads_outside` is given the names of
    /// the header and of the other file; this crate knows no links.
    #[must_use]
    pub fn staying_within(
        mut self,
        leads_outside: impl Fn(&str, &str) -> bool + Send + Sync + 'static,
    ) -> Self {
        self.leads_outside = Arc::new(leads_outside);
        self
    }

    /// Allows headers to name files outside their own folder.
    #[must_use]
    pub fn allowing_outside(mut self, allowed: bool) -> Self {
        self.outside_allowed = allowed;
        self
    }

    /// The path of the file `other` that the header `name` refers to. It must lie in the header's folder or
    /// below.
    pub(crate) fn sibling(&self, name: &str, other: &str) -> Result<String, VolumeError> {
        let mut parts = other.split(['/', '\\']);
        // A volume from the internet must not be able to make the program read arbitrary files of the user. Drive letters
        // count as absolute.
        let absolute = other.starts_with(['/', '\\']) || other.get(1..2) == Some(":");
        if !self.outside_allowed && (absolute || parts.any(|part| part == "..")) {
            return Err(error(name, VolumeProblem::Outside { name: other.to_owned() }));
        }
        let path = match name.rsplit_once(['/', '\\']) {
            Some((folder, _)) if !absolute => format!("{folder}/{other}"),
            _ => other.to_owned(),
        };
        if !self.outside_allowed && (self.leads_outside)(name, &path) {
            let name_of_target = format!("the file that {other} links to");
            return Err(error(name, VolumeProblem::Outside { name: name_of_target }));
        }
        Ok(path)
    }
}

/// Limit on a file that is read whole, such as a slice in an archive. Source: derived. This is four times the size of the
/// largest slice that is read, as floats.
pub(super) const MAX_FILE: u64 = 1 << 30;

/// The files in a ZIP archive.
pub(super) fn zip_files(files: &Files, name: &str) -> Result<Files, VolumeError> {
    let damaged = |e: zip::result::ZipError| damaged(name, "ZIP archive", e);
    let archive = zip::ZipArchive::new(files.open(name)?).map_err(damaged)?;
    // Messages put the archive's name before the names inside it, so that users recognise the
    // file.
    let inside: Vec<String> = archive
        .file_names()
        .filter_map(|n| n.ok().map(std::borrow::Cow::into_owned))
        .filter(|n| !n.ends_with('/'))
        .collect();
    let archive = Mutex::new(archive);
    let prefix = format!("{name}/");
    let shown: Vec<String> = inside.iter().map(|n| format!("{prefix}{n}")).collect();
    let open = move |path: &str| -> io::Result<Box<dyn ReadSeek>> {
        let entry = path.strip_prefix(&prefix).unwrap_or(path);
        // A ZIP reader has one position, so entries are inflated one at a time.
        let mut archive = archive.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let file = archive.by_name(entry).map_err(io::Error::other)?;
        let mut bytes = Vec::new();
        // The vector grows as data arrive: the size in the directory may be false.
        file.take(MAX_FILE).read_to_end(&mut bytes)?;
        Ok(Box::new(Cursor::new(bytes)))
    };
    Ok(Files::folder(name, shown, open))
}

/// Orders names with numbers compared by value, so that slice9 comes before slice10.
pub fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut x, mut y) = (a.as_bytes(), b.as_bytes());
    loop {
        match (x.first(), y.first()) {
            // Names that differ only in leading zeros still need a fixed order.
            (None, None) => return a.cmp(b),
            (None, _) => return Ordering::Less,
            (_, None) => return Ordering::Greater,
            (Some(p), Some(q)) if p.is_ascii_digit() && q.is_ascii_digit() => {
                let (m, n) = (digits(x), digits(y));
                let (u, v) = (without_zeros(&x[..m]), without_zeros(&y[..n]));
                // Without leading zeros the longer number is the greater one, so numbers of any length
                // compare without overflow.
                match u.len().cmp(&v.len()).then(u.cmp(v)) {
                    Ordering::Equal => (x, y) = (&x[m..], &y[n..]),
                    other => return other,
                }
            }
            (Some(p), Some(q)) => match p.cmp(q) {
                Ordering::Equal => (x, y) = (&x[1..], &y[1..]),
                other => return other,
            },
        }
    }
}

fn digits(s: &[u8]) -> usize {
    s.iter().take_while(|c| c.is_ascii_digit()).count()
}

fn without_zeros(s: &[u8]) -> &[u8] {
    &s[s.iter().take_while(|c| **c == b'0').count()..]
}
