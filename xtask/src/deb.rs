//! A Debian package: the program, its manual pages and completions, the licences of all that is in it, and its bill of materials.
//!
//! [`run`] lays out the tree below `target/deb`, asks the program itself for its pages, completions and licences, has
//! `dpkg-deb` pack it, and holds the package against `lintian`; with `--root` it is unpacked into a bare Debian root
//! that `debootstrap` makes, where the program is run. Times of all files are that of the last commit and owners are
//! root, so that two builds of one commit have the same bytes where their programs have.
//!
//! It needs dpkg-deb, strip and objdump; lintian and debootstrap are used where they are installed, and a message names the
//! missing one and the line that installs it.

use std::fmt::Write;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::setup::{is_installed, quiet};

/// Builds the package and checks it.
pub fn run(words: &[&str]) -> Result<(), String> {
    let (program, in_root) = match words {
        [] => (crate::target().join("dist/grainpath"), false),
        ["--root"] => (crate::target().join("dist/grainpath"), true),
        [path] => (PathBuf::from(path), false),
        [path, "--root"] => (PathBuf::from(path), true),
        _ => return Err("usage: cargo xtask deb [PROGRAM] [--root]".to_owned()),
    };
    let program = std::path::absolute(program).map_err(|e| e.to_string())?;
    if !program.exists() {
        let hint = "cargo build --profile dist -p grainpath-cli --features all-formats builds it";
        return Err(format!("{} is not there; {hint}", program.display()));
    }
    let package = pack(&program)?;
    if is_installed("lintian") {
        // Warnings count as errors.
        let told = crate::output(Command::new("lintian").args(["--fail-on", "error,warning"]).arg(&package));
        told.map_err(|e| format!("lintian: {e}"))?;
        println!("lintian has neither errors nor warnings");
    } else {
        println!("NOT RUN: lintian is not there; apt-get install lintian brings it");
    }
    match (in_root, is_installed("debootstrap")) {
        (false, _) => Ok(()),
        (true, true) => try_in_bare_root(&package),
        (true, false) => Err("debootstrap is not there; apt-get install debootstrap brings it".to_owned()),
    }
}

/// Packs the tree and gives the package.
fn pack(program: &Path) -> Result<PathBuf, String> {
    let (version, arch) = (version()?, crate::output(Command::new("dpkg").arg("--print-architecture"))?);
    let (arch, folder) = (arch.trim(), crate::target().join("deb"));
    let tree = folder.join("tree");
    let _ = fs::remove_dir_all(&tree);
    let at = |path: &str| tree.join(path);
    let bin = at("usr/bin/grainpath");
    put(&bin, &fs::read(program).map_err(|e| format!("{}: {e}", program.display()))?)?;
    crate::output(Command::new("chmod").arg("755").arg(&bin))?;
    if !quiet(Command::new("strip").args(["--strip-unneeded", "--remove-section=.comment"]).arg(&bin)) {
        return Err("strip failed; apt-get install binutils brings it".to_owned());
    }
    let told = |words: &[&str]| crate::output(Command::new(program).args(words));
    // Messages of other builds send people to the packages for it.
    if !told(&["doctor", "--json"])?.contains("\"formats_left_out\":[]") {
        return Err(format!("{} was built without --features all-formats", program.display()));
    }
    for (shell, path) in [
        ("bash", "usr/share/bash-completion/completions/grainpath"),
        ("zsh", "usr/share/zsh/vendor-completions/_grainpath"),
        ("fish", "usr/share/fish/vendor_completions.d/grainpath.fish"),
    ] {
        put(&at(path), told(&["completions", shell])?.as_bytes())?;
    }
    let pages = folder.join("man");
    let _ = fs::remove_dir_all(&pages);
    crate::output(Command::new(program).arg("man").arg(&pages))?;
    for entry in fs::read_dir(&pages).map_err(|e| e.to_string())?.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let page = fs::read(entry.path()).map_err(|e| e.to_string())?;
        put(&at(&format!("usr/share/man/man1/{name}.gz")), &gzip(&page)?)?;
    }
    // Messages name pages of the documentation, and pages link to those at the top.
    let documents = crate::output(
        Command::new("git")
            .args([
                "ls-files",
                "README.md",
                "ARCHITECTURE.md",
                "CONTRIBUTING.md",
                "CHANGELOG.md",
                "docs/*.md",
            ])
            .args(["docs/gallery", "docs/pictures"])
            .current_dir(crate::root()),
    )?;
    for name in documents.lines() {
        let page = fs::read(crate::root().join(name)).map_err(|e| format!("{name}: {e}"))?;
        put(&at(&format!("usr/share/doc/grainpath/{name}")), &page)?;
    }
    // The texts of all licences, those of the libraries among them.
    put(&at("usr/share/doc/grainpath/copyright"), copyright()?.as_bytes())?;
    put(&at("usr/share/doc/grainpath/licences-of-libraries.gz"), &gzip(told(&["licences"])?.as_bytes())?)?;
    put(
        &at("usr/share/doc/grainpath/grainpath.cdx.json.gz"),
        &gzip(crate::sbom::text(&crate::sbom::list()?)?.as_bytes())?,
    )?;
    put(&at("usr/share/lintian/overrides/grainpath"), OVERRIDES.as_bytes())?;
    let date =
        crate::output(Command::new("git").args(["log", "-1", "--format=%cD"]).current_dir(crate::root()))?;
    let changes = format!(
        "grainpath ({version}) unstable; urgency=medium\n\n  * Release {version}; CHANGELOG.md of the sources tells what is new.\n\n \
         -- {MAINTAINER}  {}\n",
        date.trim()
    );
    put(&at("usr/share/doc/grainpath/changelog.gz"), &gzip(changes.as_bytes())?)?;
    let size: u64 = crate::book::files(&tree)?
        .iter()
        .filter_map(|p| p.metadata().ok())
        .map(|m| m.len().div_ceil(1024))
        .sum();
    put(&at("DEBIAN/control"), control(&version, arch, size, program)?.as_bytes())?;
    let mut sums = String::new();
    for file in crate::book::files(&tree)?.iter().filter(|f| !f.starts_with(at("DEBIAN"))) {
        let sum = crate::output(Command::new("md5sum").arg(file))?;
        let name = file.strip_prefix(&tree).map_err(|e| e.to_string())?.display();
        let _ = writeln!(sums, "{}  {name}", sum.split_whitespace().next().unwrap_or_default());
    }
    put(&at("DEBIAN/md5sums"), sums.as_bytes())?;
    let package = folder.join(format!("grainpath_{version}_{arch}.deb"));
    let time =
        crate::output(Command::new("git").args(["log", "-1", "--format=%ct"]).current_dir(crate::root()))?;
    crate::output(
        Command::new("dpkg-deb")
            .args(["--build", "--root-owner-group", "-Zxz"])
            .arg(&tree)
            .arg(&package)
            .env("SOURCE_DATE_EPOCH", time.trim()),
    )?;
    let size = package.metadata().map_err(|e| e.to_string())?.len();
    println!("{}: {:.1} MB", package.display(), size as f64 * 1e-6);
    Ok(package)
}

/// Who answers for the package. Source: the authors of `CITATION.cff`; the address is of a domain that never exists.
const MAINTAINER: &str = "The grainpath authors <grainpath@example.org>";

fn control(version: &str, arch: &str, size_kib: u64, program: &Path) -> Result<String, String> {
    // The oldest C library that has every symbol the program asks for.
    let symbols = crate::output(Command::new("objdump").arg("-T").arg(program))?;
    let numbers = symbols.split("GLIBC_").skip(1).filter_map(|s| s.split([')', ' ', '\n']).next());
    let newest =
        numbers.max_by_key(|v| v.split('.').filter_map(|n| n.parse::<u32>().ok()).collect::<Vec<_>>());
    let libc = newest.map_or("libc6".to_owned(), |v| format!("libc6 (>= {v})"));
    Ok(format!(
        "Package: grainpath\nVersion: {version}\nSection: graphics\nPriority: optional\nArchitecture: {arch}\n\
         Maintainer: {MAINTAINER}\nInstalled-Size: {size_kib}\nDepends: {libc}, libgcc-s1\n\
         Description: toolpaths for 3D printing that follow the load\n \
         Plans the beads of fused-filament prints along principal stresses, the grain\n \
         of a photograph, the texture of a scan or given directions, and tests the\n \
         plan virtually until it breaks. Writes G-code for Marlin, Klipper and\n \
         RepRapFirmware, and reads that of other slicers.\n"
    ))
}

/// What lintian takes for a copy of Debian's zlib is a Rust crate, linked as all crates are.
const OVERRIDES: &str = "# zlib-rs is a Rust crate and no copy of the C library.\ngrainpath: embedded-library zlib [usr/bin/grainpath]\n";

/// The copyright file: our choice of licences, and where those of the libraries are.
fn copyright() -> Result<String, String> {
    let path = crate::root().join("LICENSE-MIT");
    let mit = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    // Debian has the text of the Apache licence for everybody, and asks that it be named and not copied.
    Ok(format!(
        "grainpath is free software under the MIT licence or the Apache License, Version 2.0,\nas you like.\n\n\
         On Debian systems the Apache License, Version 2.0, is in\n/usr/share/common-licenses/Apache-2.0.\n\n{mit}\n\n\
         The licences of all libraries in the program are in licences-of-libraries.gz beside\nthis file; `grainpath licences` prints them.\n"
    ))
}

/// Installs the package in a bare root and runs what a new user runs.
fn try_in_bare_root(package: &Path) -> Result<(), String> {
    let root = crate::target().join("deb/root");
    if !root.join("usr/bin/dpkg").exists() {
        println!("a bare Debian root: {}", root.display());
        crate::output(Command::new("debootstrap").args(["--variant=minbase", "bookworm"]).arg(&root))?;
    }
    fs::copy(package, root.join("tmp/grainpath.deb")).map_err(|e| e.to_string())?;
    let script = "set -e; export LC_ALL=C; dpkg -i /tmp/grainpath.deb; cd /tmp; rm -rf first; mkdir first; cd first; grainpath --version; \
                  grainpath doctor; grainpath new plate; grainpath run plate/job.toml; grainpath slice plate/plate.stl -o part.gcode; \
                  grainpath render part.gcode --layer 3 -o layer.png; grainpath licences | head -3; \
                  test -s plate/out/report.html; test -s part.gcode; test -s layer.png; \
                  test -s /usr/share/bash-completion/completions/grainpath; : > empty.stl; \
                  page=$(grainpath slice empty.stl 2>&1 | sed -n 's/.*(see \\(.*\\))$/\\1/p'); test -s \"$page\"; echo \"page of an error: $page\"; dpkg -V grainpath; dpkg -r grainpath; \
                  test ! -e /usr/bin/grainpath";
    let told = crate::output(Command::new("chroot").arg(&root).args(["/bin/sh", "-c", script]))?;
    println!("{told}installed, run and removed in a bare root");
    try_image(&root)
}

/// Runs the commands of the second stage of `packaging/Dockerfile` in the bare root, and then the program as its user.
/// The first stage compiles, and is that of the package.
fn try_image(root: &Path) -> Result<(), String> {
    let file = crate::root().join("packaging/Dockerfile");
    let text = fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    let commands = image_commands(&text);
    if commands.is_empty() {
        return Err(format!("{}: its second stage has no RUN", file.display()));
    }
    let program = crate::target().join("deb/tree/usr/bin/grainpath");
    fs::copy(program, root.join("usr/bin/grainpath")).map_err(|e| e.to_string())?;
    let inside =
        |script: &str| crate::output(Command::new("chroot").arg(root).args(["/bin/sh", "-c", script]));
    // A root that was used before has the user already.
    let _ = inside("userdel --remove grain 2>/dev/null");
    for command in &commands {
        inside(&format!("set -e; export LC_ALL=C; {command}")).map_err(|e| format!("RUN {command}: {e}"))?;
    }
    let as_user = "set -e; rm -rf /work; mkdir /work; chown grain /work; cd /work; \
                   su grain -c 'grainpath new plate && grainpath slice plate/plate.stl -o part.gcode' && test -s part.gcode; \
                   rm /usr/bin/grainpath";
    inside(as_user)?;
    println!(
        "{} commands of the Dockerfile's second stage ran in a bare root, and its user sliced a part",
        commands.len()
    );
    Ok(())
}

/// The `RUN` lines after the last `FROM`.
fn image_commands(dockerfile: &str) -> Vec<String> {
    let last = dockerfile.rsplit("\nFROM ").next().unwrap_or_default();
    last.lines().filter_map(|l| l.strip_prefix("RUN ")).map(str::to_owned).collect()
}

fn version() -> Result<String, String> {
    let manifest = fs::read_to_string(crate::root().join("Cargo.toml")).map_err(|e| e.to_string())?;
    let manifest: toml::Table = manifest.parse().map_err(|e| format!("Cargo.toml: {e}"))?;
    Ok(manifest["workspace"]["package"]["version"].as_str().unwrap_or_default().to_owned())
}

/// Writes a file that all may read, and its folders.
fn put(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let wrong = |e: std::io::Error| format!("{}: {e}", path.display());
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(wrong)?;
    }
    fs::write(path, bytes).map_err(wrong)?;
    crate::output(Command::new("chmod").arg("644").arg(path)).map(drop)
}

/// Packs without name and time, as Debian asks.
fn gzip(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    packed.write_all(bytes).and_then(|()| packed.finish()).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::image_commands;

    #[test]
    fn commands_of_the_last_stage_are_taken() {
        let file = "FROM a AS build\nRUN make\n\nFROM b\nCOPY --from=build /x /x\nRUN one && two\nUSER c\nRUN three\n";
        assert_eq!(image_commands(file), ["one && two", "three"]);
    }
}
