//! `grainpath doctor`: facts about the machine that belong in a problem report, and missing programs and formats.

use std::io::IsTerminal;
use std::path::Path;

use serde_json::{Value, json};

use crate::args::Doctor;
use crate::{Failure, cad, files, memory};

/// `grainpath doctor`
pub(crate) fn doctor(args: &Doctor) -> Result<(), Failure> {
    let value = survey();
    if args.json {
        files::print(&format!("{value}\n"));
        return Ok(());
    }
    let line = |name: &str, text: String| format!("{name:<22} {text}\n");
    let memory = |key: &str| match value[key].as_f64() {
        Some(mib) => format!("{:.1} GiB", mib / 1024.0),
        None => "not reported by this system".to_owned(),
    };
    let writable = |key: &str| match value[key]["problem"].as_str() {
        Some(problem) => {
            format!("{} cannot be written: {problem}", value[key]["path"].as_str().unwrap_or_default())
        }
        None => format!("{} can be written", value[key]["path"].as_str().unwrap_or_default()),
    };
    let mut text = line(
        "grainpath",
        format!("{} ({})", env!("CARGO_PKG_VERSION"), value["build"].as_str().unwrap_or_default()),
    );
    text += &line(
        "system",
        format!(
            "{} on {}",
            value["system"].as_str().unwrap_or_default(),
            value["processor"].as_str().unwrap_or_default()
        ),
    );
    text += &line("cores in use", format!("{} (--threads sets fewer)", value["threads"]));
    text += &line("memory", memory("memory_mib"));
    text += &line("memory free", memory("memory_free_mib"));
    text += &line(
        "memory limit",
        match value["memory_limit_mib"].as_f64() {
            Some(mib) => format!("{:.1} GiB, set by a container or a service", mib / 1024.0),
            None => "none".to_owned(),
        },
    );
    text += &line(
        "formats of scans",
        match left_out().join(" and ").as_str() {
            "" => "all".to_owned(),
            some => format!("all but {some}, which need a packaged build or one with --features all-formats"),
        },
    );
    text += &line("working folder", writable("working_folder"));
    text += &line("temporary folder", writable("temporary_folder"));
    text += &line(
        "gmsh",
        match value["gmsh"].as_str() {
            Some(version) => format!("{version}, through which STEP and IGES are read"),
            None => "not found; without it STEP and IGES are refused".to_owned(),
        },
    );
    text += &line(
        "colours",
        if value["colours"] == true { "on" } else { "off (NO_COLOR, or no terminal)" }.to_owned(),
    );
    files::print(&text);
    Ok(())
}

/// Formats of scans that this build does not read.
fn left_out() -> Vec<&'static str> {
    let optional = [("JPEG 2000", cfg!(feature = "jpeg2000")), ("Zarr", cfg!(feature = "zarr"))];
    optional.into_iter().filter(|(_, built_in)| !built_in).map(|(name, _)| name).collect()
}

fn survey() -> Value {
    let build = if cfg!(debug_assertions) { "with checks, slower than a release build" } else { "release" };
    let working = std::env::current_dir();
    json!({
        "ok": true,
        "version": env!("CARGO_PKG_VERSION"),
        "build": build,
        "system": std::env::consts::OS,
        "processor": std::env::consts::ARCH,
        "threads": rayon::current_num_threads(),
        "memory_mib": memory::of_machine("MemTotal"),
        "memory_free_mib": memory::of_machine("MemAvailable"),
        "memory_limit_mib": memory::limit_mib(),
        "gmsh": cad::gmsh_version(),
        "formats_left_out": left_out(),
        "working_folder": match &working {
            Ok(folder) => folder_json(folder),
            Err(e) => json!({ "path": "", "problem": e.to_string() }),
        },
        "temporary_folder": folder_json(&std::env::temp_dir()),
        // Source: no-color.org, the convention that the libraries in use follow.
        "colours": std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty()),
    })
}

/// A folder, and the reason if it cannot be written to. The test writes a file, since permissions alone do not reveal
/// full disks and file systems that are mounted read-only.
fn folder_json(folder: &Path) -> Value {
    let problem = tempfile::tempfile_in(folder).err().map(|e| e.to_string());
    json!({ "path": folder.display().to_string(), "problem": problem })
}
