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
        for k in 1.. {
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

/// Greatest length of a name, bytes. Source: file systems take 255, and a folder of a run is named after it with a word and a
/// number.
const MOST_NAME_BYTES: usize = 200;
/// Greatest length of the ending that a shortened name keeps, bytes. Source: chosen; the longest that is opened, `.nii.gz`,
/// has 7.
const MOST_ENDING_BYTES: usize = 16;

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
    // The ending says what kind of file it is; `.nii.gz` is one ending.
    let ending = kept.rfind('.').map_or("", |at| &kept[at..]);
    let stem = &kept[..kept.len() - ending.len()];
    let ending = if stem.ends_with(".nii") { &kept[stem.len() - 4..] } else { ending };
    let ending = if ending.len() <= MOST_ENDING_BYTES { ending } else { "" };
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
