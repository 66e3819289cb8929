//! `cargo xtask release twice` and `cargo xtask release static`: what is checked of the program before it is published.
//!
//! [`twice`] builds the program from the last commit in two folders, each with a `CARGO_HOME`, a home and a user name of
//! its own, and compares the SHA-256 of both. Paths of the machine are replaced as in `.github/workflows/release.yml`,
//! so that the bytes depend on the commit and the toolchain alone. Each build links to the crates already downloaded and
//! compiles them anew. Cost: two release builds.
//!
//! [`static_program`] builds the program for musl, which links everything into one file. The check fails if that file
//! names a dynamic loader or plans a hashed job differently. `rustup` installs the target if it is missing.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::Outcome;

/// The target whose C library is linked into the program.
const STATIC: &str = "x86_64-unknown-linux-musl";

/// Runs the check that is named.
pub fn run(words: &[&str]) -> Outcome {
    match words {
        ["twice"] => twice(),
        ["static"] => static_program(),
        _ => Err("usage: cargo xtask release twice|static".to_owned()),
    }
}

/// Two builds of one commit, byte for byte.
fn twice() -> Outcome {
    // Read once, so that both builds use the same commit even if one is added meanwhile.
    let commit = crate::output(Command::new("git").args(["rev-parse", "HEAD"]).current_dir(crate::root()))?;
    let sums: Vec<String> = ["first", "second/deeper"]
        .iter()
        .map(|name| built_in(name, commit.trim()))
        .collect::<Result<_, _>>()?;
    if sums[0] != sums[1] {
        return Err(format!("two builds of one commit differ: SHA-256 {} and {}", sums[0], sums[1]));
    }
    println!("two builds in two folders under two names are the same bytes: SHA-256 {}", sums[0]);
    Ok(())
}

/// The program of the first of two builds.
pub fn first_of_two() -> PathBuf {
    program_of(&crate::target().join("twice/first"))
}

fn program_of(folder: &Path) -> PathBuf {
    folder.join("checkout/target/dist").join(format!("grainpath{}", std::env::consts::EXE_SUFFIX))
}

/// Checks a commit out below the target folder, builds the program there and gives its SHA-256.
fn built_in(name: &str, commit: &str) -> Result<String, String> {
    let folder = crate::target().join("twice").join(name);
    let _ = fs::remove_dir_all(&folder);
    let (checkout, home) = (folder.join("checkout"), folder.join("home"));
    let cargo_home = home.join("cargo");
    fs::create_dir_all(&cargo_home).map_err(|e| format!("{}: {e}", cargo_home.display()))?;
    crate::output(Command::new("git").args(["clone", "--quiet"]).arg(crate::root()).arg(&checkout))?;
    crate::output(Command::new("git").args(["checkout", "--quiet", commit]).current_dir(&checkout))?;
    for part in ["registry", "config.toml"] {
        let there = own_cargo_home()?.join(part);
        if there.exists() {
            link(&there, &cargo_home.join(part))?;
        }
    }
    // rustup finds its toolchains from HOME, unless it is told.
    let rustup = std::env::var_os("RUSTUP_HOME")
        .map_or_else(|| own_home().map(|h| h.join(".rustup")), |p| Ok(p.into()));
    let flags = format!(
        "--remap-path-prefix={}=/src --remap-path-prefix={}=/cargo",
        checkout.display(),
        cargo_home.display()
    );
    let user = name.replace('/', "-");
    println!("building in {}, some minutes", folder.display());
    let mut cargo = Command::new("cargo");
    cargo
        .args([
            "build",
            "--profile",
            "dist",
            "--locked",
            "--quiet",
            "-p",
            "grainpath-cli",
            "--features",
            "all-formats",
        ])
        .current_dir(&checkout);
    cargo.env("RUSTUP_HOME", rustup?).env("CARGO_HOME", &cargo_home).env("HOME", &home);
    cargo.env("USER", &user).env("LOGNAME", &user).env("RUSTFLAGS", flags);
    cargo.env_remove("CARGO_TARGET_DIR").env_remove("CARGO_BUILD_TARGET_DIR");
    crate::output(&mut cargo)?;
    let program = program_of(&folder);
    let bytes = fs::read(&program).map_err(|e| format!("{}: {e}", program.display()))?;
    // The registry is a link, which a tool may resolve to the folder of this machine's user.
    for path in [&checkout, &cargo_home, &own_cargo_home()?].map(|path| path.display().to_string()) {
        if bytes.windows(path.len()).any(|window| window == path.as_bytes()) {
            return Err(format!("the program holds a path of the machine that built it: {path}"));
        }
    }
    Ok(crate::hashes::sha256(&bytes))
}

/// A program with nothing to load at its start, which plans the same bytes.
fn static_program() -> Outcome {
    let there = crate::output(Command::new("rustup").args(["target", "add", STATIC]));
    if let Err(problem) = there {
        return Err(format!("NOT RUN: the target {STATIC} cannot be installed: {problem}"));
    }
    crate::cargo(&[
        "build",
        "--profile",
        "dist",
        "--locked",
        "-p",
        "grainpath-cli",
        "--features",
        "all-formats",
        "--target",
        STATIC,
    ])?;
    let program = crate::target().join(STATIC).join("dist/grainpath");
    let headers = crate::output(Command::new("readelf").args(["--program-headers", "--wide"]).arg(&program))?;
    if headers.lines().any(|line| line.trim_start().starts_with("INTERP")) {
        return Err(format!("{} needs an interpreter, so it is no static program", program.display()));
    }
    println!("{} is static", program.display());
    crate::hashes::run(&["--binary", &program.display().to_string()])
}

fn own_home() -> Result<PathBuf, String> {
    std::env::home_dir().ok_or_else(|| "this user has no home folder".to_owned())
}

fn own_cargo_home() -> Result<PathBuf, String> {
    match std::env::var_os("CARGO_HOME") {
        Some(path) => Ok(path.into()),
        None => Ok(own_home()?.join(".cargo")),
    }
}

#[cfg(unix)]
fn link(from: &Path, to: &Path) -> Outcome {
    std::os::unix::fs::symlink(from, to).map_err(|e| format!("{}: {e}", to.display()))
}

#[cfg(not(unix))]
fn link(from: &Path, _: &Path) -> Outcome {
    Err(format!("{} would be linked, which this check does on Unix alone", from.display()))
}
