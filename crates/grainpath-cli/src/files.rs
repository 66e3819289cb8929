//! Reading whole files up to a size limit, and writing files under a temporary name that is then renamed.
//!
//! A file is written under a temporary name in its folder and renamed when it is complete, so that a
//! reader never sees half of it. Links are followed, and a file that is replaced keeps its mode. Devices
//! and pipes are written directly: renaming would replace the device itself.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use crate::{ExitCode, Failure, interrupt};

/// The ending of a file's name without the dot; empty if the name has none.
pub(crate) fn ending(path: &Path) -> &str {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default()
}

/// Size limit of a file that is read whole. Source: derived. A mesh needs about twice the memory of its file in addition
/// to the file, 24 GiB in all here. With a larger limit the system may end the process without a message.
pub(crate) const MAX_BYTES: u64 = 8 << 30;
/// Size limit of a pipe or a device, whose size is not known beforehand: `/dev/zero`, for example, would
/// fill the memory. Source: chosen; a binary STL of 20 million triangles has this size.
const MAX_STREAM_BYTES: u64 = 1 << 30;

/// Reads a file; `-` is standard input.
///
/// # Errors
/// Exit code 3 when it is not there, is a folder, is too large or cannot be read.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let wrong = |what: String| Failure::of_file(path, what);
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
        return Err(wrong(format!("has {} bytes; the limit is {MAX_BYTES}", metadata.len())));
    }
    fs::read(path).map_err(|e| wrong(plain(&e)))
}

/// Reads a pipe or a device to its end, up to a limit.
fn read_stream(stream: &mut dyn Read) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    // One byte beyond the limit is read, to see whether the stream ends at the limit or goes on.
    stream.take(MAX_STREAM_BYTES + 1).read_to_end(&mut bytes).map_err(|e| plain(&e))?;
    if bytes.len() as u64 > MAX_STREAM_BYTES {
        return Err(format!(
            "gives more than {} MiB, the limit for a pipe or a device; give a file instead",
            MAX_STREAM_BYTES >> 20
        ));
    }
    Ok(bytes)
}

/// Reads a text file.
///
/// # Errors
/// As `read`, but with exit code 2, since text files are jobs and profiles.
pub(crate) fn read_text(path: &Path) -> Result<String, Failure> {
    let usage = |f: Failure| Failure { code: ExitCode::Usage, ..f };
    let bytes = read(path).map_err(usage)?;
    String::from_utf8(bytes).map_err(|_| Failure::usage(format!("{}: is not UTF-8 text", path.display())))
}

/// The system's message without its error number.
pub(crate) fn plain(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

/// Lets `fill` write a temporary file in the same folder and renames it to `path` if all went well.
/// On an error the temporary file is removed. Links are followed; devices and pipes are written directly.
///
/// # Errors
/// Errors of `fill`, or exit code 2 if the file cannot be created or written.
pub(crate) fn write_atomically<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let wrong = |e: &io::Error| Failure::usage(format!("cannot write {}: {}", path.display(), plain(e)));
    let there = fs::metadata(path).ok();
    if there.as_ref().is_some_and(fs::Metadata::is_dir) {
        return Err(Failure::usage(format!("cannot write {}: it is a folder", path.display())));
    }
    // These folders hold file descriptors. `/dev/stdout` may lead to a regular file, but a rename must
    // not replace it.
    let is_descriptor = ["/dev", "/proc"].iter().any(|folder| path.starts_with(folder));
    if there.as_ref().is_some_and(|m| is_descriptor || !m.is_file()) {
        let stream = OpenOptions::new().write(true).open(path).map_err(|e| wrong(&e))?;
        let stream = Stream { to: Some(stream), may_close: is_standard_output(path) };
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
    if let Some(file) = folder.ancestors().find(|a| a.is_file()) {
        let what = format!("{} is a file, not a folder", file.display());
        return Err(Failure::usage(format!("cannot write {}: {what}", path.display())));
    }
    fs::create_dir_all(&folder).map_err(|e| wrong(&e))?;
    remove_leftovers(&folder);
    // From the process number in the name, a later run can find out whether the writer still runs.
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
        // At creation the process's umask removed bits of the mode, so it is set again.
        temporary.as_file().set_permissions(m.permissions()).map_err(|e| wrong(&e))?;
    }
    watched.finish(|| temporary.persist(&target).map_err(|e| wrong(&e.error)))?;
    Ok(result)
}

/// Whether a path is the standard output of the process.
pub(crate) fn is_standard_output(path: &Path) -> bool {
    ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path == Path::new(name))
}

/// A device or a pipe that is written.
struct Stream {
    /// `None` once its reader closed it.
    to: Option<fs::File>,
    /// Whether its reader may close it: in `grainpath ... -o /dev/stdout | head`, `head` does so on purpose.
    may_close: bool,
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.to.as_mut().map_or(Ok(bytes.len()), |to| to.write(bytes)) {
            Err(e) if self.may_close && e.kind() == io::ErrorKind::BrokenPipe => {
                self.to = None;
                Ok(bytes.len())
            }
            written => written,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.as_mut().map_or(Ok(()), Write::flush)
    }
}

/// Prefix of the names of temporary files; the number of the process follows.
const TEMPORARY: &str = ".grainpath-";
/// Limit on links that are followed. Source: Linux follows 40 (`path_resolution(7)`).
const MAX_LINKS: usize = 40;
/// Age above which a temporary file counts as left over on systems without a readable list of processes. No
/// write takes a day; with a shorter time, the file of a running process could be removed.
/// Source: chosen; no run that was measured writes for as long as an hour.
const LEFTOVER_AGE: Duration = Duration::from_secs(24 * 3600);

/// The path to which a chain of symbolic links leads; no file need exist there.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(to) = fs::read_link(&path) else { return Ok(path) };
        path = path.parent().map_or_else(|| to.clone(), |p| p.join(&to));
    }
    Err(io::Error::other("too many links"))
}

/// Removes the temporary files that killed runs left in a folder; done once per folder in each run.
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
            // Errors are ignored: another run may have removed the file already, or the permissions forbid
            // it.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether the process that made a temporary file has ended.
fn has_ended(process: u32, entry: &fs::DirEntry) -> bool {
    // The number may have been given to a new process; the file then stays until that process ends.
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

/// Prints to standard output. A closed pipe is not an error; any other error is stored, and the command ends
/// with [`lost_output`].
pub(crate) fn print(text: &str) {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // In `grainpath ... | head`, `head` closes the pipe on purpose.
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
