//! The files that a command reads and writes, checked against each other before anything starts.
//!
//! An output never replaces an input, and no two outputs share a file. Paths are compared by the file
//! they lead to, so `part.stl`, `./part.stl`, a symbolic link and a hard link to it count as one. Devices
//! and pipes are not compared: several outputs may go to `/dev/null`.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::{env, fs};

use crate::Failure;

/// The identity of a file, or of the place where a file would be written.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Identity {
    /// A file that exists: its device and inode.
    #[cfg(unix)]
    File { device: u64, inode: u64 },
    /// A file that does not exist yet, or any file on systems without file numbers: the real path of its folder, and
    /// its name.
    Place(PathBuf, OsString),
}

/// The identity of a path; `None` for devices, pipes and sockets.
fn identity(path: &Path) -> Option<Identity> {
    // `metadata` follows links, so a link has the identity of its target.
    if let Ok(metadata) = fs::metadata(path) {
        if !metadata.is_file() && !metadata.is_dir() {
            return None;
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::MetadataExt;
            return Some(Identity::File { device: metadata.dev(), inode: metadata.ino() });
        }
    }
    // A link to a file that does not exist yet: writing follows it, so the target counts.
    let path =
        fs::read_link(path).map_or_else(|_| path.to_owned(), |to| path.parent().unwrap_or(path).join(to));
    let name = path.file_name()?.to_owned();
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_owned(),
        _ => PathBuf::from("."),
    };
    // The existing part of the folder's path is resolved; the rest is kept as written.
    let (mut real, mut rest) = (folder.clone(), Vec::new());
    while fs::canonicalize(&real).is_err() {
        rest.push(real.file_name().map(ToOwned::to_owned)?);
        real = real.parent().filter(|p| !p.as_os_str().is_empty()).map_or_else(|| ".".into(), Path::to_owned);
    }
    let real = fs::canonicalize(&real).or_else(|_| env::current_dir()).ok()?;
    Some(Identity::Place(rest.into_iter().rev().fold(real, |p, r| p.join(r)), name))
}

/// A file or folder that a command reads or writes.
struct Claim {
    /// The setting or argument that names the file.
    what: String,
    path: PathBuf,
    identity: Identity,
}

/// All files that a command reads and writes.
#[derive(Default)]
pub(crate) struct Claims {
    read: Vec<Claim>,
    written: Vec<Claim>,
    /// All given paths, including devices: first those read, then those written.
    paths: (Vec<PathBuf>, Vec<PathBuf>),
}

impl Claims {
    /// Adds a file that is read, or a folder whose files are read. An empty path is ignored.
    pub(crate) fn read(&mut self, what: impl Into<String>, path: &Path) {
        if !path.as_os_str().is_empty() {
            self.paths.0.push(path.to_owned());
            self.read.extend(claim(what, path));
        }
    }

    /// Adds a file that is written.
    pub(crate) fn write(&mut self, what: impl Into<String>, path: &Path) {
        self.paths.1.push(path.to_owned());
        self.written.extend(claim(what, path));
    }

    /// Adds a folder into which files are written whose names `is_written` knows. Which of them a run writes is not known
    /// before it is planned, so any of them counts: those that are in the folder already, which may be links to other
    /// files, and those with the names of other files that are read or written. It is added last for that reason.
    pub(crate) fn write_into(&mut self, what: &str, folder: &Path, is_written: impl Fn(&str) -> bool) {
        let named = self.read.iter().chain(&self.written).filter_map(|c| c.path.file_name());
        let mut names: BTreeSet<OsString> = named.map(ToOwned::to_owned).collect();
        // A folder that cannot be read holds no file that could be lost, or writing into it fails.
        names.extend(fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name()));
        self.write(what, folder);
        for name in names.iter().filter(|name| name.to_str().is_some_and(&is_written)) {
            self.written.extend(claim(what, &folder.join(name)));
        }
    }

    /// The paths that are read, and those that are written.
    pub(crate) fn paths(&self) -> (&[PathBuf], &[PathBuf]) {
        (&self.paths.0, &self.paths.1)
    }

    /// Compares each output with all inputs and all other outputs.
    ///
    /// # Errors
    /// Exit code 2 for an output that is also an input, that would replace a slice in the folder of a scan, or that
    /// shares its file with another output.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        for (k, out) in self.written.iter().enumerate() {
            // A path to a folder cannot replace a file; if a file is needed, the writing step reports the error.
            if out.path.is_dir() {
                continue;
            }
            let path = out.path.display();
            // Inputs first: losing an input is the greater damage, and its message is the one to show.
            if let Some(input) = self.read.iter().find(|r| r.identity == out.identity || holds(r, out)) {
                return Err(Failure::usage(format!(
                    "{}: {path} is the input {}; an output never replaces an input, so give it another name",
                    out.what, input.what
                )));
            }
            if let Some(other) = self.written[..k].iter().find(|w| w.identity == out.identity) {
                return Err(Failure::usage(format!(
                    "{} and {} name the same file {path}; give one of them another name",
                    other.what, out.what
                )));
            }
        }
        Ok(())
    }
}

fn claim(what: impl Into<String>, path: &Path) -> Option<Claim> {
    identity(path).map(|identity| Claim { what: what.into(), path: path.to_owned(), identity })
}

/// Whether an output would replace a file inside a folder that is read: the slices of a scan are inputs,
/// although only their folder is named.
fn holds(input: &Claim, output: &Claim) -> bool {
    if !input.path.is_dir() || !output.path.exists() {
        return false;
    }
    let folder = output.path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    identity(folder).is_some_and(|found| found == input.identity)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ExitCode;

    #[test]
    fn one_file_has_one_identity_under_all_its_names() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        fs::write(at("part.stl"), "solid").expect("a file");
        let mut names = vec![at("part.stl"), at("./part.stl"), at("new/../part.stl")];
        fs::create_dir(at("new")).expect("a folder");
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("part.stl"), at("link.stl")).expect("a link");
            fs::hard_link(at("part.stl"), at("second.stl")).expect("a second name");
            names.extend([at("link.stl"), at("second.stl")]);
        }
        for name in &names {
            let mut claims = Claims::default();
            claims.read("shape.mesh", &at("part.stl"));
            claims.write("output.gcode", name);
            let error = claims.check().expect_err(&name.display().to_string());
            assert!(
                error.message.contains("shape.mesh") && error.code == ExitCode::Usage,
                "{}",
                error.message
            );
        }
        let mut claims = Claims::default();
        claims.read("shape.mesh", &at("part.stl"));
        claims.write("output.gcode", &at("later/part.gcode"));
        claims.write("output.report", &at("later/part.html"));
        claims.check().expect("three files");
        claims.write("output.plan", &at("later/./part.html"));
        let error = claims.check().expect_err("one file twice");
        assert!(error.message.contains("output.report and output.plan"), "{}", error.message);
    }

    #[test]
    fn files_written_into_a_folder_replace_no_input_and_no_other_output() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        let is_written = |name: &str| name.starts_with("layer_");
        fs::create_dir(at("pictures")).expect("a folder");
        fs::write(at("layer_1.png"), "a photograph").expect("a file");
        fs::write(at("pictures/layer_1.png"), "of an earlier run").expect("a file");
        fs::write(at("pictures/other.stl"), "no picture").expect("a file");
        let claims = |input: &str, output: &str, folder: &str| {
            let mut claims = Claims::default();
            claims.read("of [shape]", &at(input));
            claims.write("output.plan", &at(output));
            claims.write_into("output.preview", &at(folder), is_written);
            claims.check().map_err(|failure| failure.message)
        };
        for (input, output, folder) in [
            ("layer_1.png", "plan.json", "pictures"),
            ("pictures/other.stl", "pictures/plan.json", "pictures"),
            ("layer_1.png", "plan.json", "not/yet"),
        ] {
            claims(input, output, folder).expect("files of their own");
        }
        for (input, output, folder, says) in [
            ("layer_1.png", "plan.json", ".", "of [shape]"),
            ("layer_1.png", "plan.json", "pictures/..", "of [shape]"),
            ("a.stl", "layer_7.svg", "", "output.plan"),
            ("a.stl", "not/yet/layer_7.svg", "not/yet", "output.plan"),
            ("a.stl", "pictures/layer_1.png", "./pictures", "output.plan"),
        ] {
            let message = claims(input, output, folder).expect_err(folder);
            assert!(message.contains("output.preview") && message.contains(says), "{message}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("pictures/other.stl"), at("pictures/layer_9.png")).expect("a link");
            claims("pictures/other.stl", "plan.json", "pictures").expect_err("a link to the input");
        }
    }

    #[test]
    fn slices_of_a_scan_are_inputs_and_devices_are_none() {
        let dir = tempfile::tempdir().expect("a folder");
        fs::write(dir.path().join("s1.png"), "slice").expect("a file");
        let mut claims = Claims::default();
        claims.read("shape.ct", dir.path());
        claims.write("output.report", &dir.path().join("report.html"));
        claims.check().expect("a new file among the slices");
        claims.write("output.plan", &dir.path().join("s1.png"));
        assert!(claims.check().is_err());
        let mut claims = Claims::default();
        for what in ["output.gcode", "output.plan"] {
            claims.write(what, Path::new("/dev/null"));
        }
        assert!(cfg!(not(unix)) || claims.check().is_ok());
    }
}
