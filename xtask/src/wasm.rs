//! The planner as a WebAssembly module, the page around it, and a comparison of its G-code with that of the program.
//!
//! Rust's own library is not there for WebAssembly on every machine, and rustup cannot always fetch it. Debian has a newer
//! compiler with the sources of the library (packages `rustc-web`, `cargo-web`, `rust-web-src`), which can build it:
//! [`toolchain`] lets `apt-get download` fetch the packages and unpacks them below `target/wasm/toolchain`; nothing is
//! installed. Where they are not to be had the command says what is missing and ends well: *NOT RUN*.
//!
//! The module is put into one HTML file with the examples (`web/try`), packed with gzip and written as text, so that the
//! page needs neither a server nor a network. [`compare`] then plans the jobs of `cargo xtask hashes` and those of the page
//! in Node with the module, and with the program; every byte has to be the same. Jobs that are left out are listed with
//! the reason. At last the page is used in a browser, where there is one.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use base64::Engine as _;
use serde_json::{Value, json};

use crate::setup::quiet;

/// The packages of the compiler and of what it is linked with. Source: the dependencies of `rustc-web` and `cargo-web`
/// 1.96.0 in Debian 12; what every system has is left out.
const PACKAGES: [&str; 13] = [
    "rustc-web",
    "libstd-rust-web-1.96",
    "libstd-rust-web-dev",
    "cargo-web",
    "rust-web-src",
    "rust-web-llvm",
    "libllvm22",
    "libgit2-1.5",
    "libhttp-parser2.9",
    "libmbedtls14",
    "libmbedcrypto7",
    "libmbedx509-1",
    "libssh2-1",
];

const TARGET: &str = "wasm32-unknown-unknown";

/// Most bytes of the module and of the page, packed with gzip. Source: what the project promises to who opens the page.
const MOST_PACKED: usize = 3_000_000;

/// The examples of the page: the title, the job below the folder of the first column, and the files that it names.
/// `new` stands for the folder where `grainpath new` wrote its examples.
const EXAMPLES: [(&str, &str, &str, &[&str]); 14] = [
    ("A flat bracket along its load", "docs/gallery", "bracket.toml", &["bracket.svg"]),
    ("A hook", "docs/gallery", "hook.toml", &["hook.svg"]),
    ("A lever on a pivot", "docs/gallery", "lever.toml", &["lever.svg"]),
    ("A link with two eyes in tension", "docs/gallery", "link.toml", &["link.svg"]),
    ("The frame of a clamp, spread open", "docs/gallery", "clamp.toml", &["clamp.svg"]),
    ("A gusset in shear", "docs/gallery", "gusset.toml", &["gusset.svg"]),
    ("A ring between two plates", "docs/gallery", "ring.toml", &["ring.svg"]),
    ("A weave of both families of stress lines", "docs/gallery", "weave.toml", &["weave.svg"]),
    ("A tensile bar with a hole", "new/stress-lines", "tension.toml", &["tension.stl"]),
    ("A bar in three-point bending", "new/stress-lines", "bending.toml", &["bending.stl"]),
    ("A mounting plate, as a slicer prints it", "new/plate", "job.toml", &["plate.stl"]),
    ("Directions from a table", "new/field", "job.toml", &["plate.stl", "theta.csv"]),
    ("A board along the grain of its photograph", "new/woodgrain", "job.toml", &["board.png"]),
    ("One continuous path a layer", "new/continuous", "hook.toml", &["hook.stl"]),
];

/// Examples that are planned in a browser too, and compared there.
const TRIED: [&str; 3] =
    ["A flat bracket along its load", "A mounting plate, as a slicer prints it", "Directions from a table"];

/// Jobs of `cargo xtask hashes` that the module does not take, and why.
const LEFT_OUT: [(&str, &str); 4] = [
    ("scan", SCANS),
    ("scan-canny", SCANS),
    ("scan-distance", SCANS),
    ("texture", "its grain is that of a scan, which a page does not read"),
];

const SCANS: &str = "scans are read by a second thread, which a page does not have";

/// `cargo xtask wasm [--binary PATH]`: builds, packs, writes the page and compares.
pub fn run(words: &[&str]) -> Result<(), String> {
    let binary = match words {
        [] => None,
        ["--binary", path] => Some(std::path::absolute(path).map_err(|e| format!("{path}: {e}"))?),
        _ => return Err("usage: cargo xtask wasm [--binary PATH]".to_owned()),
    };
    let toolchain = match toolchain() {
        Ok(toolchain) => toolchain,
        Err(reason) => {
            println!("NOT RUN: the WebAssembly module: {reason}");
            return Ok(());
        }
    };
    let module = build(&toolchain)?;
    let bytes = fs::read(&module).map_err(|e| format!("{}: {e}", module.display()))?;
    let packed = gzip(&bytes)?;
    println!(
        "{}: {:.2} MB, {:.2} MB packed with gzip",
        module.display(),
        bytes.len() as f64 * 1e-6,
        packed.len() as f64 * 1e-6
    );
    let binary = match binary {
        Some(path) => path,
        None => {
            crate::cargo(&["build", "--quiet", "--profile", "ci", "--package", "grainpath-cli"])?;
            crate::ci_program()
        }
    };
    let page = page(&binary, &packed)?;
    let whole = gzip(&fs::read(&page).map_err(|e| e.to_string())?)?.len();
    println!("{}: {:.2} MB as servers send it", page.display(), whole as f64 * 1e-6);
    if packed.len().max(whole) > MOST_PACKED {
        return Err(format!("more than {:.1} MB packed", MOST_PACKED as f64 * 1e-6));
    }
    if !quiet(Command::new("node").arg("--version")) {
        println!("NOT RUN: the comparison of G-code needs Node.js; apt-get install nodejs brings it");
        return Ok(());
    }
    compare(&binary, &module)?;
    try_in_browser(&page)
}

/// Opens the page in a browser and uses it.
fn try_in_browser(page: &Path) -> Result<(), String> {
    let browser = match crate::setup::browser(false) {
        Ok(browser) if crate::page::has_npm() => browser,
        _ => {
            println!("NOT RUN: the page in a browser needs npm and Chromium");
            return Ok(());
        }
    };
    crate::page::install()?;
    let mut command = Command::new("node");
    command.arg(crate::root().join("web/try/browser.mjs")).arg(page);
    command.arg(folder().join("wanted.json")).arg(folder().join("page.png")).env("BROWSER", browser);
    crate::run(&mut command)
}

fn folder() -> PathBuf {
    crate::target().join("wasm")
}

/// The page, where it was built.
pub fn built_page() -> PathBuf {
    folder().join("page.html")
}

/// The folder of the compiler, fetched on the first call. The error says why it cannot be had.
fn toolchain() -> Result<PathBuf, String> {
    let (debs, root) = (folder().join("debs"), folder().join("toolchain"));
    linker()?;
    if compiler(&root, "rustc").is_ok() {
        return Ok(root);
    }
    for program in ["apt-get", "dpkg"] {
        if !quiet(Command::new(program).arg("--version")) {
            return Err(format!("{program} is not there; the compiler comes in packages of Debian"));
        }
    }
    fs::create_dir_all(&debs).map_err(|e| format!("{}: {e}", debs.display()))?;
    println!("fetching {} packages into {}", PACKAGES.len(), debs.display());
    let fetched = crate::output(Command::new("apt-get").arg("download").args(PACKAGES).current_dir(&debs));
    fetched.map_err(|e| {
        let why = e.lines().rfind(|l| l.starts_with("E:")).map_or(e.clone(), str::to_owned);
        format!("apt-get cannot download it ({why}); Debian 12 has it in bookworm-security")
    })?;
    for deb in fs::read_dir(&debs).map_err(|e| e.to_string())?.flatten() {
        crate::output(Command::new("dpkg").arg("-x").arg(deb.path()).arg(&root))?;
    }
    let version = compiler(&root, "rustc")?;
    println!("unpacked {}", version.trim());
    // The packages take 150 MB, and what was in them is unpacked.
    fs::remove_dir_all(&debs).map_err(|e| e.to_string())?;
    Ok(root)
}

/// What a program of the toolchain says of its version.
fn compiler(root: &Path, name: &str) -> Result<String, String> {
    let mut command = Command::new(root.join("usr/bin").join(name));
    crate::output(command.arg("--version").env("LD_LIBRARY_PATH", libraries(root)))
}

fn libraries(root: &Path) -> PathBuf {
    root.join("usr/lib/x86_64-linux-gnu")
}

/// The folder with `wasm-ld`: that of the compiler that builds everything else.
fn linker() -> Result<PathBuf, String> {
    let sysroot =
        crate::output(Command::new("rustc").args(["--print", "sysroot"]).current_dir(crate::root()))?;
    let own = Path::new(sysroot.trim()).join("lib/rustlib/x86_64-unknown-linux-gnu/bin/gcc-ld");
    if own.join("wasm-ld").exists() {
        return Ok(own);
    }
    Err(format!("no linker: {} has no wasm-ld, which toolchains of rustup bring", own.display()))
}

fn build(toolchain: &Path) -> Result<PathBuf, String> {
    let from = Instant::now();
    let (bin, into) = (toolchain.join("usr/bin"), folder().join("build"));
    let path = std::env::var_os("PATH").unwrap_or_default();
    // `wasm-ld` starts the `rust-lld` of the folder above its own.
    let linker = linker()?;
    let above = linker.parent().map(Path::to_path_buf).unwrap_or_default();
    let folders = [bin.clone(), linker, above].into_iter().chain(std::env::split_paths(&path));
    let mut command = Command::new(bin.join("cargo"));
    command.args(["rustc", "--profile", "wasm", "--package", "grainpath-wasm", "--lib", "--locked"]);
    command.args(["--crate-type", "cdylib", "-Zbuild-std=std,panic_abort", "--target", TARGET]);
    command
        .env("PATH", std::env::join_paths(folders).map_err(|e| e.to_string())?)
        .env("LD_LIBRARY_PATH", libraries(toolchain))
        .env("RUSTC", bin.join("rustc"))
        // The library is built with features that only a nightly compiler has.
        .env("RUSTC_BOOTSTRAP", "1")
        .env("CARGO_TARGET_DIR", &into)
        // What cargo set for this program is not meant for that one.
        .env_remove("CARGO")
        .env_remove("RUSTUP_TOOLCHAIN")
        .env_remove("CARGO_INCREMENTAL");
    crate::run(&mut command)?;
    println!("built in {:.0} s", from.elapsed().as_secs_f64());
    Ok(into.join(TARGET).join("wasm/grainpath_wasm.wasm"))
}

fn gzip(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    packer.write_all(bytes).and_then(|()| packer.finish()).map_err(|e| e.to_string())
}

fn base64(bytes: &[u8]) -> String {
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// The folder that an example of the page is read from.
fn folder_of(example: &str) -> PathBuf {
    match example.strip_prefix("new/") {
        Some(preset) => folder().join("new").join(preset),
        None => crate::root().join(example),
    }
}

/// Writes the page: one file with the module, the examples and all scripts.
fn page(binary: &Path, packed: &[u8]) -> Result<PathBuf, String> {
    let made = folder().join("new");
    let _ = fs::remove_dir_all(&made);
    fs::create_dir_all(&made).map_err(|e| e.to_string())?;
    for (_, place, ..) in EXAMPLES {
        if let Some(preset) = place.strip_prefix("new/")
            && !made.join(preset).exists()
        {
            crate::output(Command::new(binary).args(["new", preset]).current_dir(&made))?;
        }
    }
    let mut examples = Vec::new();
    for (title, place, job, names) in EXAMPLES {
        let place = folder_of(place);
        let mut files = serde_json::Map::new();
        for name in names {
            let bytes = fs::read(place.join(name)).map_err(|e| format!("{name}: {e}"))?;
            files.insert((*name).to_owned(), base64(&bytes).into());
        }
        examples.push(json!({ "title": title, "job": read(&place.join(job))?, "files": files }));
    }
    let source = |name: &str| read(&crate::root().join("web/try").join(name));
    // A script inside a page ends at the first `</`, and a worker from text is no module that could export.
    let examples = Value::from(examples).to_string().replace('<', "\\u003c");
    let worker = format!("{}{}", source("module.js")?.replace("export async", "async"), source("worker.js")?);
    let text = source("page.html")?
        .replace("{{EXAMPLES}}", &examples)
        .replace("{{WORKER}}", &worker)
        .replace("{{PAGE}}", &source("page.js")?)
        .replace("{{MODULE}}", &base64(packed));
    let path = built_page();
    fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(path)
}

/// Plans all jobs with the module and with the program, and compares the SHA-256 of what they write.
fn compare(binary: &Path, module: &Path) -> Result<(), String> {
    let from = Instant::now();
    for (name, why) in LEFT_OUT {
        println!("left out: {name}: {why}");
    }
    let mut jobs = crate::hashes::programs(binary, &LEFT_OUT.map(|l| l.0))?;
    for (title, place, job, _) in EXAMPLES {
        let job = folder_of(place).join(job);
        let out = folder().join("native").join(title.replace(' ', "-"));
        let mut command = Command::new(binary);
        command.arg("run").arg(&job).arg("--out").arg(&out).args(["--set", "output.gcode=job.gcode"]);
        for set in crate::hashes::QUIET.iter().chain(&["strength.enabled=false"]) {
            command.args(["--set", set]);
        }
        crate::output(&mut command)?;
        let sets = vec!["strength.enabled=false".to_owned()];
        jobs.push(crate::hashes::Made { name: title.to_owned(), job, sets, gcode: out.join("job.gcode") });
    }
    println!("{} jobs planned by the program in {:.0} s", jobs.len(), from.elapsed().as_secs_f64());
    let mut wanted = BTreeMap::new();
    for made in &jobs {
        let bytes = fs::read(&made.gcode).map_err(|e| format!("{}: {e}", made.gcode.display()))?;
        wanted.insert(made.name.as_str(), crate::hashes::sha256(&bytes));
    }
    let list = folder().join("jobs.json");
    let rows: Vec<Value> =
        jobs.iter().map(|m| json!({ "name": m.name, "job": m.job, "sets": m.sets })).collect();
    fs::write(&list, Value::from(rows).to_string()).map_err(|e| e.to_string())?;
    let script = crate::root().join("web/try/compare.mjs");
    let told = crate::output(Command::new("node").arg(script).arg(module).arg(&list))?;
    let (mut equal, mut different, mut seconds) = (0, String::new(), 0.0);
    for line in told.lines() {
        let row: Value = serde_json::from_str(line).map_err(|e| format!("{line}: {e}"))?;
        let name = row["name"].as_str().unwrap_or_default();
        let took = row["seconds"].as_f64().unwrap_or_default();
        seconds += took;
        match (row["sha256"].as_str(), wanted.get(name)) {
            (Some(got), Some(want)) if got == want => {
                equal += 1;
                println!("{got}  {name} ({took:.1} s)");
            }
            (Some(_), _) => {
                let _ = write!(different, "\n       {name}: other bytes than the program's");
            }
            (None, _) => {
                let _ = write!(different, "\n       {name}: {}", row["problem"].as_str().unwrap_or(line));
            }
        }
    }
    let tried: BTreeMap<&str, &String> =
        TRIED.iter().filter_map(|title| Some((*title, wanted.get(title)?))).collect();
    fs::write(folder().join("wanted.json"), json!(tried).to_string()).map_err(|e| e.to_string())?;
    println!(
        "{equal} of {} jobs: equal SHA-256 in Node and from the program; {seconds:.0} s in Node",
        jobs.len()
    );
    if equal == jobs.len() { Ok(()) } else { Err(format!("jobs of the module differ:{different}")) }
}
