//! Files: read whole with a limit, written beside and renamed.

use std::fs;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::Failure;

/// Files larger than this are not read.
const MAX_BYTES: u64 = 8 << 30;

/// Reads a file.
///
/// # Errors
/// Exit code 3 when it is not there, is a folder, is too large or cannot be read.
pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let wrong = |what: String| Failure::input(format!("{}: {what}", path.display()));
    let metadata = fs::metadata(path).map_err(|e| wrong(plain(&e)))?;
    if metadata.is_dir() {
        return Err(wrong("is a folder; a file is needed".into()));
    }
    if metadata.len() > MAX_BYTES {
        return Err(wrong(format!("has {} bytes; more than {MAX_BYTES} are not read", metadata.len())));
    }
    fs::read(path).map_err(|e| wrong(plain(&e)))
}

/// Reads a text.
///
/// # Errors
/// As [`read`], but with exit code 2: texts are jobs and profiles.
pub fn read_text(path: &Path) -> Result<String, Failure> {
    let usage = |f: Failure| Failure::usage(f.message);
    let bytes = read(path).map_err(usage)?;
    String::from_utf8(bytes).map_err(|_| Failure::usage(format!("{}: is not UTF-8 text", path.display())))
}

/// The system's words without its numbers.
pub fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

/// Writes a file through `fill` into a temporary one beside it, which takes its name when all went well. On an error
/// nothing is left behind.
///
/// # Errors
/// What `fill` says, or exit code 2 when the place cannot be written.
pub fn write_atomically<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let wrong = |e: &std::io::Error| Failure::usage(format!("cannot write {}: {}", path.display(), plain(e)));
    if path.is_dir() {
        return Err(Failure::usage(format!("cannot write {}: it is a folder", path.display())));
    }
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_owned(),
        _ => PathBuf::from("."),
    };
    fs::create_dir_all(&folder).map_err(|e| wrong(&e))?;
    let mut temporary = tempfile::Builder::new()
        .prefix(".grainpath-")
        .permissions(permissions())
        .tempfile_in(&folder)
        .map_err(|e| wrong(&e))?;
    let mut writer = BufWriter::with_capacity(1 << 17, temporary.as_file_mut());
    let result = fill(&mut writer)?;
    writer.flush().map_err(|e| wrong(&e))?;
    drop(writer);
    temporary.persist(path).map_err(|e| wrong(&e.error))?;
    Ok(result)
}

/// What a new file usually gets; temporary ones are private by default.
#[cfg(unix)]
fn permissions() -> fs::Permissions {
    use std::os::unix::fs::PermissionsExt;
    fs::Permissions::from_mode(0o644)
}

#[cfg(not(unix))]
fn permissions() -> fs::Permissions {
    fs::metadata(".").map(|m| m.permissions()).expect("the current folder is there")
}

/// Prints to standard output; a reader that has gone is no error.
pub fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}
