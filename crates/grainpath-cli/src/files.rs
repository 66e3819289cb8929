//! Files: read whole with a limit, written under a temporary name in their folder and renamed.
//!
//! A file is written under a temporary name in its folder and renamed when it is complete, so that a
//! reader never sees half of it. Links are followed, and a file that is replaced keeps its mode. Devices
//! and pipes are written directly: renaming would replace the device itself.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use crate::{Failure, interrupt};

/// The ending of a file's name, without the dot; empty without one.
pub(crate) fn ending(path: &Path) -> &str {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default()
}

/// Size limit of a file that is read whole. Source: derived. A mesh takes about twice its file besides it, which
/// fills a machine with 24 GiB. A larger limit risks that the system ends the process without a message.
const MAX_BYTES: u64 = 8 << 30;
/// Size limit of a pipe or a device, whose size is not known beforehand. `/dev/zero` has no end, and
/// without a limit would fill the memory. Source: chosen; a binary STL of 20 million triangles is as large.
const MAX_STREAM_BYTES: u64 = 1 << 30;

/// Reads a file; `-` is standard input.
///
/// # Errors
/// Exit code 3 when it is not there, is a folder, is too large or cannot be read.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let wrong = |what: String| Failure::input(format!("{}: {what}", path.display()));
    if path == Path::new("-") {
        return read_stream(&mut io::stdin().lock()).map_err(wrong);
    }
    let metadata = fs::metadata(path).map_err(|e| wrong(plain(&e)))?;
    if metadata.is_dir() {
        return Err(wrong("is a folder; a file is needed".into()));
    }
    if !metadata.is_file() {
        let mut stream = fs::File::open(path).map_err(|e| wrong(plain(&e)))?;
        return read_stream(&mut stream).map_err(wrong);
    }
    if metadata.len() > MAX_BYTES {
        return Err(wrong(format!("has {} bytes; more than {MAX_BYTES} are not read", metadata.len())));
    }
    fs::read(path).map_err(|e| wrong(plain(&e)))
}

/// Reads a pipe or a device to its end, up to a limit.
fn read_stream(stream: &mut dyn Read) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    // One byte more than the limit tells a stream that ends there from one that goes on.
    stream.take(MAX_STREAM_BYTES + 1).read_to_end(&mut bytes).map_err(|e| plain(&e))?;
    if bytes.len() as u64 > MAX_STREAM_BYTES {
        return Err(format!(
            "gives more than {} MiB; from a pipe or a device no more are read, so give a file",
            MAX_STREAM_BYTES >> 20
        ));
    }
    Ok(bytes)
}

/// Reads a text file.
///
/// # Errors
/// As `read`, but with exit code 2: texts are jobs and profiles.
pub(crate) fn read_text(path: &Path) -> Result<String, Failure> {
    let usage = |f: Failure| Failure::usage(f.message);
    let bytes = read(path).map_err(usage)?;
    String::from_utf8(bytes).map_err(|_| Failure::usage(format!("{}: is not UTF-8 text", path.display())))
}

/// The system's message without its error number.
pub(crate) fn plain(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

/// Writes a file through `fill` into a temporary file beside it, which takes its name when all went well.
/// On an error the temporary file is removed. Links are followed; devices and pipes are written directly.
///
/// # Errors
/// Errors of `fill`, or exit code 2 when the place cannot be written.
pub(crate) fn write_atomically<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let wrong = |e: &io::Error| Failure::usage(format!("cannot write {}: {}", path.display(), plain(e)));
    let there = fs::metadata(path).ok();
    if there.as_ref().is_some_and(fs::Metadata::is_dir) {
        return Err(Failure::usage(format!("cannot write {}: it is a folder", path.display())));
    }
    // Descriptors lie below these folders: `/dev/stdout` may be a regular file and still must not be
    // replaced by a rename.
    let is_descriptor = ["/dev", "/proc"].iter().any(|folder| path.starts_with(folder));
    if there.as_ref().is_some_and(|m| is_descriptor || !m.is_file()) {
        let stream = OpenOptions::new().write(true).open(path).map_err(|e| wrong(&e))?;
        let mut writer = BufWriter::with_capacity(1 << 17, stream);
        let result = fill(&mut writer)?;
        writer.flush().map_err(|e| wrong(&e))?;
        return Ok(result);
    }
    // Renaming onto a link would replace the link, so its target is resolved first.
    let target = followed(path).map_err(|e| wrong(&e))?;
    let folder = match target.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_owned(),
        _ => PathBuf::from("."),
    };
    fs::create_dir_all(&folder).map_err(|e| wrong(&e))?;
    remove_leftovers(&folder);
    // The number of the process in the name tells a later run whether the writer still lives.
    let prefix = format!("{TEMPORARY}{}-", std::process::id());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix);
    if let Some(permissions) = permissions(there.as_ref()) {
        builder.permissions(permissions);
    }
    let created = interrupt::Temporary::create(|| builder.tempfile_in(&folder));
    let (mut temporary, watched) = created.map_err(|e| wrong(&e))?;
    // The file must be complete before the rename, so the buffer is flushed and dropped first.
    let mut writer = BufWriter::with_capacity(1 << 17, temporary.as_file_mut());
    let result = fill(&mut writer)?;
    writer.flush().map_err(|e| wrong(&e))?;
    drop(writer);
    if let Some(m) = &there {
        // The mode given at creation was cut down by the process's mask.
        temporary.as_file().set_permissions(m.permissions()).map_err(|e| wrong(&e))?;
    }
    watched.finish(|| temporary.persist(&target).map_err(|e| wrong(&e.error)))?;
    Ok(result)
}

/// Prefix of the names of temporary files; the number of the process follows.
const TEMPORARY: &str = ".grainpath-";
/// Limit on links that are followed. Source: Linux follows 40 (`path_resolution(7)`).
const MAX_LINKS: usize = 40;
/// Age at which a temporary file counts as left over where no list of processes can be read. No write
/// takes a day; a shorter time could remove the file of a run in progress.
/// Source: chosen; no run that was measured writes for as long as an hour.
const LEFTOVER_AGE: Duration = Duration::from_secs(24 * 3600);

/// The file at the end of a chain of links; it need not exist.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(to) = fs::read_link(&path) else { return Ok(path) };
        path = path.parent().map_or_else(|| to.clone(), |p| p.join(&to));
    }
    Err(io::Error::other("too many links"))
}

/// Removes temporary files that killed runs have left in a folder; each run looks once at each folder.
fn remove_leftovers(folder: &Path) {
    static LOOKED_AT: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
    let mut looked_at = LOOKED_AT.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if looked_at.iter().any(|f| f == folder) {
        return;
    }
    looked_at.push(folder.to_owned());
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let process = name.to_str().and_then(|n| n.strip_prefix(TEMPORARY)).and_then(|n| n.split('-').next());
        let Some(process) = process.and_then(|p| p.parse::<u32>().ok()) else { continue };
        if process != std::process::id() && has_ended(process, &entry) {
            // Another run may have removed the file, or the permissions may forbid it; neither concerns
            // this run.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether the process that made a temporary file has ended.
fn has_ended(process: u32, entry: &fs::DirEntry) -> bool {
    // A number may belong to a new process by now; the file then stays until that one ends.
    let processes = Path::new("/proc");
    if processes.join("self").exists() {
        return !processes.join(process.to_string()).exists();
    }
    let written = entry.metadata().and_then(|m| m.modified());
    written.ok().and_then(|t| t.elapsed().ok()).is_some_and(|age| age > LEFTOVER_AGE)
}

/// The permissions of a new file: those of the file it replaces, else 0666 less the process's umask.
/// Temporary files are private by default, and a G-code file must be readable by the program that prints
/// it.
#[cfg(unix)]
fn permissions(replaced: Option<&fs::Metadata>) -> Option<fs::Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(replaced.map_or_else(|| fs::Permissions::from_mode(0o666), fs::Metadata::permissions))
}

#[cfg(not(unix))]
fn permissions(_replaced: Option<&fs::Metadata>) -> Option<fs::Permissions> {
    None
}

/// The first error in writing standard output.
static LOST_OUTPUT: Mutex<Option<String>> = Mutex::new(None);

/// Prints to standard output. A reader that has gone is no error; any other failure ends the command with
/// [`lost_output`].
pub(crate) fn print(text: &str) {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // `grainpath ... | head` closes the pipe on purpose.
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            let mut lost = LOST_OUTPUT.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            lost.get_or_insert(plain(&e));
        }
        _ => {}
    }
}

/// The failure of a command whose standard output could not be written.
pub(crate) fn lost_output() -> Option<Failure> {
    let lost = LOST_OUTPUT.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone();
    lost.map(|why| Failure::usage(format!("cannot write standard output: {why}")))
}
