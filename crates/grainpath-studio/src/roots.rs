//! The files that a page may read and write.
//!
//! Paths come from the page and from job files. All links of a path are followed first. The file that they lead to is
//! read only if it lies below a root, and written only below the working folder. A link made between check and use is
//! no danger: only the user can make one there.

use std::path::{Component, Path, PathBuf};
use std::{fs, io};

use crate::refusal::{Refusal, plain};

/// Folders that may be read, and the one that may be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Roots {
    work: PathBuf,
    readable: Vec<PathBuf>,
}

impl Roots {
    /// Files may be read below `work` and `readable`, and written below `work`, which is made if it is missing.
    ///
    /// # Errors
    /// [`Refusal`] for folders that are not there or cannot be made.
    pub fn new(work: &Path, readable: &[PathBuf]) -> Result<Self, Refusal> {
        let wrong = |path: &Path, e: &io::Error| Refusal::usage(format!("{}: {}", path.display(), plain(e)));
        fs::create_dir_all(work).map_err(|e| wrong(work, &e))?;
        let real = |path: &Path| fs::canonicalize(path).map_err(|e| wrong(path, &e));
        let work = real(work)?;
        let mut all = vec![];
        for folder in readable {
            let folder = real(folder)?;
            if !folder.is_dir() {
                return Err(Refusal::usage(format!("{}: is no folder", folder.display())));
            }
            if !all.contains(&folder) {
                all.push(folder);
            }
        }
        if !all.iter().any(|r| work.starts_with(r)) {
            all.push(work.clone());
        }
        Ok(Self { work, readable: all })
    }

    /// The folder that is written to.
    pub fn work(&self) -> &Path {
        &self.work
    }

    /// The folders that may be read. The working folder is among them only if no other folder contains it.
    pub fn readable_folders(&self) -> &[PathBuf] {
        &self.readable
    }

    /// The real path of a file or folder that may be read.
    ///
    /// # Errors
    /// [`Refusal`] for what is not there or lies outside the roots. Both have the same message, so that a page cannot
    /// ask what exists elsewhere.
    pub fn readable(&self, path: &Path) -> Result<PathBuf, Refusal> {
        let missing = || {
            let path = path.display();
            Refusal::input(format!("{path}: not found below the folders of the studio; --root DIR adds one"))
        };
        let real = fs::canonicalize(path).map_err(|_| missing())?;
        if self.readable.iter().any(|r| real.starts_with(r)) { Ok(real) } else { Err(missing()) }
    }

    /// The path of a file that may be written; it need not exist.
    ///
    /// # Errors
    /// [`Refusal`] outside the working folder.
    pub fn writable(&self, path: &Path) -> Result<PathBuf, Refusal> {
        let outside = || {
            let (path, work) = (path.display(), self.work.display());
            Refusal::usage(format!("{path}: the studio writes only below {work}"))
        };
        // The part of the path that exists is resolved; the rest must be plain names.
        let (mut real, mut rest) = (path.to_owned(), Vec::new());
        let real = loop {
            match fs::canonicalize(&real) {
                Ok(found) => break found,
                Err(_) => {
                    // A link whose target does not exist yet is refused, because writing would follow it.
                    if fs::symlink_metadata(&real).is_ok() {
                        return Err(outside());
                    }
                    rest.push(real.file_name().ok_or_else(outside)?.to_owned());
                    real = real.parent().ok_or_else(outside)?.to_owned();
                }
            }
        };
        let whole = rest.into_iter().rev().fold(real, |p, name| p.join(name));
        let is_plain = whole.components().all(|c| !matches!(c, Component::ParentDir));
        if is_plain && whole.starts_with(&self.work) { Ok(whole) } else { Err(outside()) }
    }

    /// A new folder below the working folder: `name`, or `name-2` and so on.
    ///
    /// # Errors
    /// [`Refusal`] where it cannot be made.
    pub fn new_folder(&self, name: &str) -> Result<PathBuf, Refusal> {
        let wrong = |e: io::Error| Refusal::usage(format!("{}: {}", self.work.display(), plain(&e)));
        // A folder under a name of the studio itself would be in the way of the file.
        let first = if OWN_NAMES.contains(&name) { 2 } else { 1 };
        for k in first.. {
            let folder = self.work.join(if k == 1 { name.to_owned() } else { format!("{name}-{k}") });
            match fs::create_dir(&folder) {
                Ok(()) => return Ok(folder),
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(wrong(e)),
            }
        }
        Err(Refusal::usage("no name is free"))
    }
}

/// Name of the folder of files that were dropped on the page.
pub(crate) const UPLOADS: &str = "uploads";
/// Name of the file of changes that were not saved.
pub(crate) const DRAFTS: &str = "drafts.json";
/// Name of the file that is locked while [`DRAFTS`] is read and written anew. It is empty and stays.
pub(crate) const DRAFTS_LOCK: &str = ".drafts.lock";
/// Name of the file of the history of runs.
pub(crate) const HISTORY: &str = "history.jsonl";
/// Names in the working folder that the studio uses itself.
const OWN_NAMES: [&str; 4] = [UPLOADS, DRAFTS, DRAFTS_LOCK, HISTORY];
/// The ending of packed scans, which is one ending for the user and two for the file system.
const PACKED_NIFTI: &str = ".nii.gz";

/// A temporary file in a folder, which gets its name when it is whole. Who may read it is what the system gives new files,
/// so that others can where the folder is shared; `tempfile` alone would keep it to the user.
pub(crate) fn temporary(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".studio-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Writes a file below the working folder. A disk that is full leaves no half of it.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Refusal> {
    let wrong = |e: io::Error| Refusal::usage(format!("cannot write {}: {}", path.display(), plain(&e)));
    let mut file = temporary(path.parent().unwrap_or(Path::new("."))).map_err(wrong)?;
    io::Write::write_all(&mut file, bytes).map_err(wrong)?;
    file.persist(path).map(drop).map_err(|e| wrong(e.error))
}

/// Greatest length of a name, bytes. Source: file systems take 255, and a folder of a run is named after it with a word and a
/// number.
const MOST_NAME_BYTES: usize = 200;
/// Greatest length of the ending that a shortened name keeps, bytes. Source: chosen; the longest that is opened, `.nii.gz`,
/// has 7.
const MOST_ENDING_BYTES: usize = 16;

/// A name before and from its ending, which says what kind of file it is. `.nii.gz` is one ending.
pub(crate) fn stem_and_ending(name: &str) -> (&str, &str) {
    let packed = name.strip_suffix(PACKED_NIFTI).map(str::len);
    name.split_at(packed.or(name.rfind('.')).unwrap_or(name.len()))
}

/// The last part of a name from the page, without characters that a path or a shell could misread.
pub fn safe_name(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let kept: String =
        last.chars().map(|c| if c.is_alphanumeric() || " .-_()+".contains(c) { c } else { '_' }).collect();
    let kept = kept.trim_start_matches(['.', ' ', '-']).trim_end();
    if kept.is_empty() {
        return "upload".to_owned();
    }
    if kept.len() <= MOST_NAME_BYTES {
        return kept.to_owned();
    }
    let ending = Some(stem_and_ending(kept).1).filter(|e| e.len() <= MOST_ENDING_BYTES).unwrap_or_default();
    let mut end = MOST_NAME_BYTES - ending.len();
    while !kept.is_char_boundary(end) {
        end -= 1;
    }
    format!("{}{ending}", kept[..end].trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roots() -> (tempfile::TempDir, Roots) {
        let dir = tempfile::tempdir().expect("a folder");
        fs::create_dir_all(dir.path().join("in/deep")).expect("a folder");
        fs::create_dir_all(dir.path().join("secret")).expect("a folder");
        fs::write(dir.path().join("in/part.stl"), "solid").expect("a file");
        fs::write(dir.path().join("secret/key"), "key").expect("a file");
        let roots =
            Roots::new(&dir.path().join("in/studio"), &[dir.path().join("in")]).expect("they are there");
        (dir, roots)
    }

    #[test]
    fn files_are_read_below_the_roots_alone() {
        let (dir, roots) = roots();
        let at = |name: &str| dir.path().join(name);
        assert!(roots.readable(&at("in/part.stl")).is_ok());
        assert!(roots.readable(&at("in/deep/../part.stl")).is_ok());
        for name in ["secret/key", "in/../secret/key", "in/nothing", "secret/nothing"] {
            let error = roots.readable(&at(name)).expect_err(name);
            assert!(error.message.contains("not found below the folders"), "{}", error.message);
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("secret"), at("in/link")).expect("a link");
            assert!(roots.readable(&at("in/link/key")).is_err());
        }
    }

    #[test]
    fn files_are_written_below_the_working_folder_alone() {
        let (dir, roots) = roots();
        let at = |name: &str| dir.path().join(name);
        assert!(roots.writable(&at("in/studio/a.gcode")).is_ok());
        assert!(roots.writable(&at("in/studio/new/deep/a.gcode")).is_ok());
        for name in [
            "in/a.gcode",
            "in/studio/../a.gcode",
            "in/studio/new/../../../secret/a",
            "secret/a",
            "in/studio2/a",
        ] {
            assert!(roots.writable(&at(name)).is_err(), "{name}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("secret"), at("in/studio/link")).expect("a link");
            std::os::unix::fs::symlink(at("secret/later"), at("in/studio/later")).expect("a link");
            assert!(roots.writable(&at("in/studio/link/a")).is_err());
            assert!(roots.writable(&at("in/studio/later")).is_err());
        }
    }

    #[test]
    fn a_run_takes_no_name_of_the_studio() {
        let (_dir, roots) = roots();
        for name in OWN_NAMES {
            let folder = roots.new_folder(name).expect("a folder");
            assert_eq!(folder.file_name().and_then(|n| n.to_str()), Some(format!("{name}-2").as_str()));
        }
    }

    #[cfg(unix)]
    #[test]
    fn files_are_as_readable_as_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let (dir, _) = roots();
        let (plain, whole) = (dir.path().join("plain"), dir.path().join("whole"));
        fs::write(&plain, "a").expect("a file");
        write_whole(&whole, b"a").expect("a file");
        let mode = |path: &Path| fs::metadata(path).expect("it is there").permissions().mode();
        assert_eq!(mode(&whole), mode(&plain));
    }

    #[test]
    fn endings_are_those_of_kinds_of_files() {
        for (name, parts) in [
            ("vol.nii.gz", ("vol", ".nii.gz")),
            ("a.b.stl", ("a.b", ".stl")),
            ("part", ("part", "")),
            ("vol.nii", ("vol", ".nii")),
            ("page.html.gz", ("page.html", ".gz")),
        ] {
            assert_eq!(stem_and_ending(name), parts);
        }
    }

    #[test]
    fn names_of_uploads_are_plain() {
        for (given, kept) in [
            ("part.stl", "part.stl"),
            ("../../etc/passwd", "passwd"),
            ("C:\\parts\\a b.3mf", "a b.3mf"),
            ("..", "upload"),
            (".hidden", "hidden"),
            ("-rf.stl", "rf.stl"),
            ("a\u{0}\n<b>.stl", "a___b_.stl"),
            ("", "upload"),
        ] {
            assert_eq!(safe_name(given), kept, "{given:?}");
        }
        // A long name keeps its ending, by which it is told what it is.
        for letter in ["a", "é", "部"] {
            for ending in [".stl", ".nii.gz", ".3mf"] {
                let name = safe_name(&format!("{}{ending}", letter.repeat(300)));
                assert!(name.len() <= MOST_NAME_BYTES && name.len() > 190, "{name}");
                assert!(name.starts_with(letter) && name.ends_with(&format!("{letter}{ending}")), "{name}");
            }
        }
        assert_eq!(safe_name(&"b".repeat(300)).len(), MOST_NAME_BYTES);
        assert_eq!(safe_name(&format!("a.{}", "b".repeat(300))).len(), MOST_NAME_BYTES);
        let kept = format!("{}.gcode", "a".repeat(100));
        assert_eq!(safe_name(&kept), kept);
    }
}
