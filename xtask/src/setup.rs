//! Programs and packages that tests and benches need besides Rust. Each is looked for, named with the
//! line that installs it, and installed where that needs no rights.
//!
//! Python packages go into a virtual environment below `target/venv`. System packages are installed by `apt-get`
//! only where this runs as root or was asked to by `--install`; elsewhere the line to run is printed.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Where the browser of the tests is looked for.
const BROWSERS: [&str; 4] = [
    "/usr/bin/chromium",
    "/usr/bin/chromium-browser",
    "/usr/bin/google-chrome",
    "/usr/bin/google-chrome-stable",
];

/// Python packages that scripts of tests and benches import; meshio opens the VTU files that we write.
const PYTHON: [&str; 8] = ["numpy", "scipy", "shapely>=2", "trimesh", "networkx", "rtree", "meshio", "lxml"];

/// Python packages that build and test the package `grainpath`.
const PYTHON_PACKAGE: [&str; 9] = [
    "numpy",
    "maturin>=1.16",
    "pytest>=8",
    "hypothesis>=6",
    "mypy>=1.11",
    "dask",
    "distributed",
    "zarr>=3",
    "anywidget>=0.9",
];

/// Needs of tests; a test names its own in `#[ignore = "needs ..."]`.
pub const NEEDS: [&str; 5] = ["GRAINPATH_DATA", "GRAINPATH_CHECK", "python", "vtk", "gmsh"];

/// The needs that are missing, and how to meet each.
pub struct Found {
    pub missing: Vec<(&'static str, String)>,
}

impl Found {
    /// The missing needs that `reason` names.
    pub fn missing_of(&self, reason: &str) -> Vec<&'static str> {
        self.missing.iter().map(|m| m.0).filter(|need| reason.contains(need)).collect()
    }
}

/// Looks for what tests need, prints what is missing and how to get it, and installs the Python packages.
pub fn tests(install: bool) -> Result<Found, String> {
    let mut missing = Vec::new();
    for (variable, what) in [
        ("GRAINPATH_DATA", "set GRAINPATH_DATA to a folder of real meshes, scans, photographs and results"),
        ("GRAINPATH_CHECK", "set GRAINPATH_CHECK to a folder with gcode_check.py"),
    ] {
        if let Err(problem) = folder(variable) {
            missing.push((variable, format!("{problem}; {what}")));
        }
    }
    if let Err(problem) = apt(&[("python3", "python3")], install).and_then(|()| environment(install, &PYTHON))
    {
        missing.push(("python", problem));
    }
    if let Err(problem) = environment(install, &["vtk"]) {
        missing.push(("vtk", format!("{problem} (100 MB, for one test)")));
    }
    if let Err(problem) = apt(&[("gmsh", "gmsh")], install) {
        missing.push(("gmsh", problem));
    }
    // A test runs lines of docs/studio.md, and fails where curl is missing.
    if let Err(problem) = apt(&[("curl", "curl")], install) {
        missing.push(("curl", problem));
    }
    for (need, how) in &missing {
        println!("missing: {need}: {how}");
    }
    Ok(Found { missing })
}

/// The folder of real files.
pub fn data() -> Result<PathBuf, String> {
    folder("GRAINPATH_DATA")
}

/// A script that measures G-code without our code.
pub fn check(script: &str) -> Result<PathBuf, String> {
    Ok(folder("GRAINPATH_CHECK")?.join(script))
}

fn folder(variable: &str) -> Result<PathBuf, String> {
    let path = std::env::var_os(variable).ok_or_else(|| format!("{variable} is not set"))?;
    let path = PathBuf::from(path);
    // Tests run in the folders of their crates, so a relative path would lead elsewhere.
    let whole = path.canonicalize().map_err(|e| format!("{variable}: {}: {e}", path.display()))?;
    if whole.is_dir() { Ok(whole) } else { Err(format!("{variable}: {} is no folder", whole.display())) }
}

/// Sets the variables that helpers of tests read.
pub fn export(command: &mut Command) -> &mut Command {
    for variable in ["GRAINPATH_DATA", "GRAINPATH_CHECK"] {
        if let Ok(path) = folder(variable) {
            command.env(variable, path);
        }
    }
    command.env("GRAINPATH_PYTHON", interpreter())
}

/// The Python interpreter: that of the virtual environment, or else the system's.
pub fn interpreter() -> String {
    let own = venv().join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if own.exists() { own.display().to_string() } else { "python3".to_owned() }
}

/// A command of that interpreter.
pub fn python() -> Command {
    Command::new(interpreter())
}

/// The virtual environment.
pub fn venv() -> PathBuf {
    crate::target().join("venv")
}

/// Whether these Python packages can be imported; versions are not compared.
fn has(packages: &[&str]) -> bool {
    let names: Vec<&str> = packages.iter().map(|p| p.split(['>', '=']).next().unwrap_or(p)).collect();
    quiet(python().args(["-c", &format!("import {}", names.join(", "))]))
}

/// Makes the virtual environment and installs what it lacks.
fn environment(install: bool, packages: &[&str]) -> Result<(), String> {
    if has(packages) {
        return Ok(());
    }
    let folder = venv();
    if !folder.exists() && !quiet(Command::new("python3").args(["-m", "venv"]).arg(&folder)) {
        // Debian's Python comes without the module `venv`; the half-made folder must go before the next
        // attempt.
        let _ = std::fs::remove_dir_all(&folder);
        apt(&[("python3-venv-is-no-program", "python3-venv")], install)?;
        crate::run(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    }
    println!("installing into {}: {}", folder.display(), packages.join(" "));
    let args = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    crate::run(python().args(args).args(packages))
}

/// For tests of the studio's page: the browser.
pub fn browser(install: bool) -> Result<PathBuf, String> {
    let found = || BROWSERS.iter().map(PathBuf::from).find(|p| p.exists());
    if found().is_none() {
        apt(&[("chromium", "chromium")], install)?;
    }
    found().ok_or_else(|| "no Chromium was found after it was installed".to_owned())
}

/// For `cargo xtask python`: what builds and tests the package.
pub fn python_package(install: bool) -> Result<(), String> {
    apt(&[("python3", "python3")], install)?;
    environment(install, &PYTHON_PACKAGE)
}

/// For `cargo xtask python --release`: what a wheel is held against.
pub fn python_audit() -> Result<(), String> {
    environment(true, &["abi3audit", "auditwheel"])
}

/// For `cargo xtask python --release` on Linux: a linker that knows the C library of older systems.
pub fn zig() -> Result<(), String> {
    environment(true, &["ziglang"])
}

/// For `cargo xtask python --release`: what runs the notebooks.
pub fn python_notebooks() -> Result<(), String> {
    environment(true, &["nbclient", "nbformat", "ipykernel"])
}

/// For `cargo xtask setup`: the peers.
pub fn peers() -> Result<(), String> {
    apt(&[("prusa-slicer", "prusa-slicer"), ("CuraEngine", "cura-engine")], true)
}

/// For `cargo xtask deb --root`: what a package is held against, and what makes the root.
pub fn packaging() -> Result<(), String> {
    apt(&[("lintian", "lintian"), ("debootstrap", "debootstrap"), ("objdump", "binutils")], true)
}

/// For `cargo xtask bench fea`: an independent mesher and solver.
pub fn fea() -> Result<(), String> {
    apt(&[("gmsh", "gmsh"), ("ccx", "calculix-ccx"), ("time", "time")], true)
}

/// For every bench: what prepares parts and measures.
pub fn bench() -> Result<(), String> {
    apt(&[("python3", "python3"), ("time", "time")], true)?;
    environment(true, &PYTHON)
}

/// For the headers of scans in `cargo xtask nightly`.
pub fn simple_itk() -> Result<(), String> {
    environment(true, &["numpy", "SimpleITK"])
}

/// For `cargo xtask bench photo`.
pub fn opencv() -> Result<(), String> {
    if has(&["cv2", "numpy"]) {
        return Ok(());
    }
    bench()?;
    environment(true, &["opencv-python-headless"])
}

/// For `cargo xtask bench ct`: marching cubes and a slicer.
pub fn scans() -> Result<(), String> {
    bench()?;
    apt(&[("prusa-slicer", "prusa-slicer")], true)?;
    if has(&["skimage"]) { Ok(()) } else { environment(true, &["scikit-image"]) }
}

/// For `cargo xtask bench klipper`: a checkout of Klipper, and the packages that its host software imports. Klipper is under
/// the GPL; it is run, and nothing of it is part of grainpath.
pub fn klipper() -> Result<PathBuf, String> {
    let how = "git clone --depth 1 https://github.com/Klipper3d/klipper && cd klipper && \
               printf 'CONFIG_LOW_LEVEL_OPTIONS=y\\nCONFIG_MACH_LINUX=y\\n' > .config && make olddefconfig && make; \
               then set GRAINPATH_KLIPPER to that folder";
    let checkout = folder("GRAINPATH_KLIPPER").map_err(|problem| format!("{problem}; get Klipper: {how}"))?;
    // The dictionary of the controller is what `make` leaves.
    for part in ["klippy/klippy.py", "out/klipper.dict"] {
        if !checkout.join(part).is_file() {
            return Err(format!(
                "GRAINPATH_KLIPPER: {} has no {part}; get Klipper: {how}",
                checkout.display()
            ));
        }
    }
    // The package pyserial is imported by another name.
    if !has(&["cffi", "greenlet", "jinja2", "serial"]) {
        environment(true, &["cffi", "greenlet", "jinja2", "pyserial"])?;
    }
    Ok(checkout)
}

/// For `cargo xtask bench jobs fields`: what the outside measure of fields needs.
pub fn fields() -> Result<(), String> {
    bench()?;
    environment(true, &["manifold3d"])
}

/// CuraEngine's definition files. They are unpacked from the package of its front end, which itself is
/// not installed.
pub fn cura_definitions(folder: &Path) -> Option<PathBuf> {
    let definitions = folder.join("cura/usr/share/cura/resources/definitions");
    if !definitions.join("fdmprinter.def.json").exists() {
        let script = "apt-get download -qq cura && dpkg -x cura_*.deb cura";
        quiet(Command::new("sh").args(["-c", script]).current_dir(folder));
    }
    definitions.join("fdmprinter.def.json").exists().then_some(definitions)
}

/// Installs the packages whose programs are missing, where that is allowed; otherwise the error is the
/// line to run.
fn apt(programs: &[(&str, &str)], install: bool) -> Result<(), String> {
    let missing: Vec<&str> =
        programs.iter().filter(|(program, _)| !is_installed(program)).map(|(_, p)| *p).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let is_root = quiet(Command::new("sh").args(["-c", "test $(id -u) = 0"]));
    let sudo = if is_root { "" } else { "sudo " };
    let line = format!("{sudo}apt-get install -y --no-install-recommends {}", missing.join(" "));
    // Without root or the user's word nothing on the system is changed.
    if !is_root && !install {
        return Err(line);
    }
    println!("installing: {line}");
    let script = format!(
        "{sudo}apt-get update -qq && {sudo}env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq \
         --no-install-recommends {} >/dev/null",
        missing.join(" ")
    );
    crate::run(Command::new("sh").args(["-c", &script])).map_err(|_| line)
}

/// Whether a program is on the path.
pub fn is_installed(program: &str) -> bool {
    quiet(Command::new("sh").args(["-c", &format!("command -v {program}")]))
}

/// Whether a command succeeds; its output is discarded.
pub fn quiet(command: &mut Command) -> bool {
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|s| s.success())
}
