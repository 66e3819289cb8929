//! Installs what tests and benches need, by name, from the system's and Python's package registries.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What `gcode_check.py` imports, and what opens the VTU that is written.
const PYTHON: [&str; 7] = ["numpy", "scipy", "shapely>=2", "trimesh", "networkx", "rtree", "meshio"];

/// For `cargo xtask test`: Python packages for the outside check, Chromium for the report page.
pub fn tests() -> Result<(), String> {
    apt(&[("python3", "python3"), ("pip3", "python3-pip"), ("chromium", "chromium")])?;
    python()
}

fn python() -> Result<(), String> {
    if quiet(
        Command::new("python3")
            .args(["-c", "import numpy, scipy, shapely, trimesh, networkx, rtree, meshio"]),
    ) {
        return Ok(());
    }
    println!("installing Python packages: {}", PYTHON.join(" "));
    let pip = |extra: &[&str]| {
        let args = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        crate::run(Command::new("python3").args(args).args(extra).args(PYTHON))
    };
    // Debian's own Python refuses to mix packages unless told to.
    pip(&[]).or_else(|_| pip(&["--break-system-packages"]))
}

/// For `cargo xtask bench`: the peers.
pub fn peers() -> Result<(), String> {
    apt(&[("prusa-slicer", "prusa-slicer"), ("CuraEngine", "cura-engine")])
}

/// For `cargo xtask bench fea`: an independent mesher and solver.
pub fn fea() -> Result<(), String> {
    apt(&[("gmsh", "gmsh"), ("ccx", "calculix-ccx"), ("time", "time")])
}

/// For every bench: what prepares parts and measures.
pub fn bench() -> Result<(), String> {
    apt(&[("python3", "python3"), ("pip3", "python3-pip"), ("time", "time")])?;
    python()
}

/// For `cargo xtask bench photo`.
pub fn opencv() -> Result<(), String> {
    apt(&[("python3", "python3"), ("pip3", "python3-pip")])?;
    if quiet(Command::new("python3").args(["-c", "import cv2, numpy"])) {
        return Ok(());
    }
    let pip = |extra: &[&str]| {
        let args = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        crate::run(Command::new("python3").args(args).args(extra).arg("opencv-python-headless"))
    };
    pip(&[]).or_else(|_| pip(&["--break-system-packages"]))
}

/// For `cargo xtask bench ct`: marching cubes and a slicer.
pub fn scans() -> Result<(), String> {
    bench()?;
    apt(&[("prusa-slicer", "prusa-slicer")])?;
    if quiet(Command::new("python3").args(["-c", "import skimage"])) {
        return Ok(());
    }
    let pip = |extra: &[&str]| {
        let args = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        crate::run(Command::new("python3").args(args).args(extra).arg("scikit-image"))
    };
    pip(&[]).or_else(|_| pip(&["--break-system-packages"]))
}

/// CuraEngine's definition files, unpacked from the package of its front end without installing that.
pub fn cura_definitions(folder: &Path) -> Option<PathBuf> {
    let definitions = folder.join("cura/usr/share/cura/resources/definitions");
    if !definitions.join("fdmprinter.def.json").exists() {
        let script = "apt-get download -qq cura && dpkg -x cura_*.deb cura";
        crate::setup::quiet(Command::new("sh").args(["-c", script]).current_dir(folder));
    }
    definitions.join("fdmprinter.def.json").exists().then_some(definitions)
}

/// Installs the packages whose program is missing.
fn apt(programs: &[(&str, &str)]) -> Result<(), String> {
    let there = |program: &str| quiet(Command::new("sh").args(["-c", &format!("command -v {program}")]));
    let missing: Vec<&str> =
        programs.iter().filter(|(program, _)| !there(program)).map(|(_, p)| *p).collect();
    if missing.is_empty() {
        return Ok(());
    }
    println!("installing {}", missing.join(" "));
    let root = if quiet(Command::new("sh").args(["-c", "test $(id -u) = 0"])) { "" } else { "sudo " };
    let script = format!(
        "{root}apt-get update -qq && {root}env DEBIAN_FRONTEND=noninteractive \
         apt-get install -y -qq --no-install-recommends {} >/dev/null",
        missing.join(" ")
    );
    crate::run(Command::new("sh").args(["-c", &script]))
}

/// Whether a command succeeds; what it prints is dropped.
pub fn quiet(command: &mut Command) -> bool {
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|s| s.success())
}
