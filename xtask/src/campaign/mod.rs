//! `cargo xtask campaign [MINUTES]`: damaged files, killed runs and full disks, against the program as users run it.
//!
//! Method: each seed of `xtask/seeds` is mutated ([`mutate`], [`packing`]) and given to the program in a process of its own
//! with limits of memory and time. A mutant may be read or refused; it must not panic, be killed by a signal, run over
//! its time, print more than one line of error, or leave a file half-written. Fuzz targets (`cargo xtask fuzz`) find more
//! mutants a second, but see neither the command line nor the files that it writes.
//!
//! Units: minutes for the length, MiB of address space and seconds for the limits.
//! Limits: mutants are drawn without knowing what code they reach; that is the fuzz targets' work.

mod mutate;
mod packing;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use mutate::{Draw, change};
use packing::{Packing, repacked};

/// The memory of one run, MiB of address space. Measured: the largest seed takes 0.4 GiB of address space, most of it
/// stacks of threads that are never touched; four times that leaves room for what a damaged header may ask for.
const MEMORY_MIB: u64 = 1600;
/// The time of one run, s. Measured: every seed takes less than 0.1 s; a hundred times that on a busy machine.
const TIME_S: u64 = 10;
/// Minutes without a number on the command line: long enough for a thousand mutants of each format on two cores.
const MINUTES: f64 = 10.0;

/// A format: seeds, how they are packed, and the bytes in front of their content that three of four mutants keep.
struct Seed {
    file: &'static str,
    packing: Packing,
    header: usize,
}

const fn seed(file: &'static str, packing: Packing, header: usize) -> Seed {
    Seed { file, packing, header }
}

/// Every seed. Text formats have short headers: what tells the format and its version.
const SEEDS: [Seed; 47] = [
    seed("mesh.stl", Packing::Plain, 84),
    seed("ascii.stl", Packing::Plain, 6),
    seed("mesh.obj", Packing::Plain, 2),
    seed("ascii.ply", Packing::Plain, 200),
    seed("binary.ply", Packing::Plain, 200),
    seed("mesh.off", Packing::Plain, 4),
    seed("mesh.3mf", Packing::Zip, 0),
    seed("outline.svg", Packing::Plain, 80),
    seed("outline.dxf", Packing::Plain, 50),
    seed("ascii.vtu", Packing::Plain, 100),
    seed("zlib.vtu", Packing::VtuZlib, 130),
    seed("lzma.vtu", Packing::Plain, 130),
    seed("legacy.vtk", Packing::Plain, 90),
    seed("ascii.vtk", Packing::Plain, 90),
    seed("vtk51.vtk", Packing::Plain, 90),
    seed("gmsh22.msh", Packing::Plain, 50),
    seed("gmsh41.msh", Packing::Plain, 50),
    seed("medit.mesh", Packing::Plain, 24),
    seed("deck.inp", Packing::Plain, 5),
    seed("result.frd", Packing::Plain, 7),
    seed("stress.csv", Packing::Plain, 34),
    seed("directions.csv", Packing::Plain, 20),
    seed("directions.npy", Packing::Plain, 128),
    seed("directions.npz", Packing::Zip, 0),
    seed("colour.png", Packing::Png, 33),
    seed("grey16.png", Packing::Png, 33),
    seed("palette.png", Packing::Png, 33),
    seed("photo.jpg", Packing::Plain, 170),
    seed("progressive.jpg", Packing::Plain, 170),
    seed("picture.bmp", Packing::Plain, 14),
    seed("deflate.tif", Packing::Plain, 8),
    seed("float.tif", Packing::Plain, 8),
    seed("stack.tif", Packing::Plain, 8),
    seed("raw.nrrd", Packing::Plain, 9),
    seed("gzip.nrrd", Packing::NrrdGzip, 9),
    seed("scan.nii", Packing::Plain, 4),
    seed("scan.nii.gz", Packing::Gzip, 0),
    seed("raw.mha", Packing::Plain, 40),
    seed("zlib.mha", Packing::MetaZlib, 40),
    seed("explicit.dcm", Packing::Plain, 132),
    seed("implicit.dcm", Packing::Plain, 132),
    // Behind 560 bytes are the pixels.
    seed("lossless.dcm", Packing::Plain, 560),
    seed("cosines.dcm", Packing::Plain, 560),
    seed("jpeg-ls.dcm", Packing::Plain, 560),
    seed("jpeg-2000.dcm", Packing::Plain, 560),
    seed("program.gcode", Packing::Plain, 0),
    seed("job.toml", Packing::Plain, 0),
];

/// What one run of the program came to.
#[derive(Debug, PartialEq, Eq)]
enum Ending {
    /// Exit code 0.
    Read,
    /// A documented exit code and one line of error.
    Refused,
    /// Anything else; says what.
    Wrong(String),
}

/// Counts of one seed.
#[derive(Default)]
struct Tally {
    runs: usize,
    past_header: usize,
    read: usize,
    slowest_s: f64,
    wrong: Vec<String>,
}

/// Runs the campaign. `words` holds the minutes, or nothing.
pub fn run(words: &[&str]) -> Result<(), String> {
    let minutes = match words {
        [] => MINUTES,
        [word] => {
            word.parse().ok().filter(|m| *m > 0.0).ok_or_else(|| format!("{word} is no number of minutes"))?
        }
        _ => return Err("usage: cargo xtask campaign [MINUTES]".to_owned()),
    };
    crate::cargo(&["build", "--profile", "ci", "-p", "grainpath-cli", "--features", "all-formats"])?;
    let program = crate::ci_program();
    let folder = crate::target().join("campaign");
    let _ = fs::remove_dir_all(&folder);
    make(&folder)?;
    let tallies = mutants(&program, &folder, Duration::from_secs_f64(60.0 * minutes))?;
    let mut wrong: Vec<String> = tallies.values().flat_map(|t| t.wrong.clone()).collect();
    report(&tallies);
    wrong.extend(kills(&program, &folder.join("kills"))?);
    match full_disk(&program, &folder.join("disk"))? {
        Some(problems) => wrong.extend(problems),
        None => println!("NOT RUN: full disk: a small file system can be mounted only as root"),
    }
    if wrong.is_empty() {
        return Ok(());
    }
    Err(format!(
        "{} findings; the files are kept in {}\n  {}",
        wrong.len(),
        folder.display(),
        wrong.join("\n  ")
    ))
}

/// Mutates every seed in turn until the time is over, on one thread for each core.
fn mutants(program: &Path, folder: &Path, time: Duration) -> Result<BTreeMap<&'static str, Tally>, String> {
    let seeds = crate::root().join("xtask/seeds");
    let bytes: Vec<Vec<u8>> = SEEDS
        .iter()
        .map(|s| fs::read(seeds.join(s.file)).map_err(|e| format!("xtask/seeds/{}: {e}", s.file)))
        .collect::<Result<_, _>>()?;
    let threads = crate::cores();
    let end = Instant::now() + time;
    let parts = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|worker| {
                let (bytes, folder) = (&bytes, folder.join(format!("worker-{worker}")));
                scope.spawn(move || work(program, &folder, bytes, worker, threads, end))
            })
            .collect();
        workers.into_iter().map(|w| w.join().expect("a worker")).collect::<Result<Vec<_>, _>>()
    })?;
    let mut all: BTreeMap<&'static str, Tally> = BTreeMap::new();
    for (name, tally) in parts.into_iter().flatten() {
        let sum = all.entry(name).or_default();
        sum.runs += tally.runs;
        sum.past_header += tally.past_header;
        sum.read += tally.read;
        sum.slowest_s = sum.slowest_s.max(tally.slowest_s);
        sum.wrong.extend(tally.wrong);
    }
    Ok(all)
}

/// Every mutant whose number leaves the remainder `worker`: one of each seed, then the next of each.
fn work(
    program: &Path,
    folder: &Path,
    bytes: &[Vec<u8>],
    worker: usize,
    threads: usize,
    end: Instant,
) -> Result<BTreeMap<&'static str, Tally>, String> {
    make(folder)?;
    // The job names this mesh.
    fs::copy(crate::root().join("xtask/seeds/ascii.stl"), folder.join("ascii.stl"))
        .map_err(|e| e.to_string())?;
    let mut tallies: BTreeMap<&'static str, Tally> = BTreeMap::new();
    let mut round = worker as u64;
    while Instant::now() < end {
        for (index, (seed, original)) in SEEDS.iter().zip(bytes).enumerate() {
            let mut draw = Draw::new(round << 8 | index as u64);
            let (mutant, past_header) = mutant(original, seed, &mut draw);
            // A mutant is named as its seed is, since the name decides where contents are alike.
            let (stem, extension) = seed.file.split_once('.').expect("a seed has an extension");
            let file = folder.join(format!("mutant-{stem}.{extension}"));
            fs::write(&file, mutant).map_err(|e| format!("{}: {e}", file.display()))?;
            let commands = commands(seed.file, &file, folder, round);
            for arguments in commands {
                let (ending, seconds) = limited(program, &arguments, folder)?;
                let tally = tallies.entry(seed.file).or_default();
                tally.runs += 1;
                tally.past_header += usize::from(past_header);
                tally.read += usize::from(ending == Ending::Read);
                tally.slowest_s = tally.slowest_s.max(seconds);
                if let Ending::Wrong(what) = ending {
                    let kept = folder.with_file_name(format!("{stem}-{round}.{extension}"));
                    fs::copy(&file, &kept).map_err(|e| e.to_string())?;
                    tally.wrong.push(format!("{}: {} {what}", kept.display(), arguments[0]));
                }
            }
        }
        round += threads as u64;
    }
    Ok(tallies)
}

/// A mutant, and whether the header and the packing in front of its content are whole.
fn mutant(original: &[u8], seed: &Seed, draw: &mut Draw) -> (Vec<u8>, bool) {
    if draw.below(4) > 0 {
        if let Some(mutant) = repacked(original, seed.packing, draw) {
            return (mutant, true);
        }
        let mut bytes = original.to_vec();
        change(&mut bytes, seed.header, draw);
        // Changes of packed bytes end at the checksum.
        return (bytes, seed.packing == Packing::Plain);
    }
    let mut bytes = original.to_vec();
    change(&mut bytes, 0, draw);
    let whole = seed.packing == Packing::Plain && bytes.get(..seed.header) == original.get(..seed.header);
    (bytes, whole)
}

/// The command lines that read this mutant. Every eighth is also planned, which shows what readers let through.
fn commands(seed: &str, file: &Path, folder: &Path, round: u64) -> Vec<Vec<String>> {
    let name = file.display().to_string();
    let words = |words: &[&str]| words.iter().map(|w| (*w).to_owned()).collect::<Vec<String>>();
    if seed == "job.toml" {
        return vec![words(&["run", &name, "--json"])];
    }
    let mut commands = vec![words(&["inspect", "--json", &name])];
    let planned =
        [".stl", ".obj", ".ply", ".off", ".3mf", ".svg", ".dxf"].iter().any(|end| seed.ends_with(end));
    if planned && round.is_multiple_of(8) {
        let out = folder.join("mutant.out.gcode").display().to_string();
        commands.push(words(&["slice", "--json", &name, "-o", &out]));
    }
    commands
}

/// Runs the program below its limits.
fn limited(program: &Path, arguments: &[String], folder: &Path) -> Result<(Ending, f64), String> {
    let start = Instant::now();
    let errors = folder.join("stderr.txt");
    let stderr = fs::File::create(&errors).map_err(|e| format!("{}: {e}", errors.display()))?;
    let mut child = Command::new("sh")
        .arg("-c")
        .arg(format!("ulimit -v {}; exec \"$0\" \"$@\"", MEMORY_MIB * 1024))
        .arg(program)
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(stderr)
        .spawn()
        .map_err(|e| format!("cannot start {}: {e}", program.display()))?;
    let mut pause = Duration::from_micros(500);
    let status = loop {
        if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
            break status;
        }
        if start.elapsed() > Duration::from_secs(TIME_S) {
            let _ = child.kill();
            let _ = child.wait();
            return Ok((
                Ending::Wrong(format!("runs for more than {TIME_S} s")),
                start.elapsed().as_secs_f64(),
            ));
        }
        std::thread::sleep(pause);
        pause = (pause * 3 / 2).min(Duration::from_millis(20));
    };
    let seconds = start.elapsed().as_secs_f64();
    let stderr = fs::read(&errors).unwrap_or_default();
    Ok((ending(status.code(), &String::from_utf8_lossy(&stderr)), seconds))
}

/// Judges an exit code (`None` after a signal) and what was printed on standard error.
fn ending(code: Option<i32>, stderr: &str) -> Ending {
    let first = stderr.lines().find(|l| !l.is_empty()).unwrap_or_default();
    match code {
        None => Ending::Wrong(format!("was killed by a signal: {first}")),
        Some(0) => Ending::Read,
        Some(code @ (2..=4)) => {
            let lines = stderr.lines().filter(|l| l.starts_with("grainpath: ")).count();
            match lines {
                1 => Ending::Refused,
                _ => Ending::Wrong(format!("ends with code {code} and {lines} lines of error: {first}")),
            }
        }
        Some(code) => Ending::Wrong(format!("ends with code {code}: {first}")),
    }
}

fn report(tallies: &BTreeMap<&'static str, Tally>) {
    println!(
        "{:18} {:>7} {:>12} {:>6} {:>9} {:>6}",
        "seed", "runs", "past header", "read", "slowest s", "wrong"
    );
    for (name, t) in tallies {
        let share = 100.0 * t.past_header as f64 / t.runs.max(1) as f64;
        println!(
            "{name:18} {:7} {share:10.0} % {:6} {:9.2} {:6}",
            t.runs,
            t.read,
            t.slowest_s,
            t.wrong.len()
        );
    }
    let sum = |of: fn(&Tally) -> usize| tallies.values().map(of).sum::<usize>();
    let runs = sum(|t| t.runs);
    let share = 100.0 * sum(|t| t.past_header) as f64 / runs.max(1) as f64;
    println!(
        "{runs} runs of {} seeds, {share:.0} % past the header, {} wrong",
        tallies.len(),
        sum(|t| t.wrong.len())
    );
}

/// Kills of a slicing run. Few moments suffice: the output is renamed in one step.
const KILLS: u32 = 40;

/// Kills a run at moments spread over its time; its output must be whole or absent, and the next run must clear
/// what was left.
fn kills(program: &Path, folder: &Path) -> Result<Vec<String>, String> {
    make(folder)?;
    let mesh = crate::root().join("xtask/seeds/mesh.stl");
    let out = folder.join("part.gcode");
    let start = || {
        let mut command = Command::new(program);
        command.args(["slice", "--set", "process.layer_height_mm=0.1", "--set", "fill.density=0.8"]);
        command.arg(&mesh).arg("-o").arg(&out).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().map_err(|e| format!("cannot start {}: {e}", program.display()))
    };
    let begin = Instant::now();
    if !start()?.wait().map_err(|e| e.to_string())?.success() {
        return Err("the run that is to be killed does not end well by itself".to_owned());
    }
    let whole_time = begin.elapsed();
    let whole = fs::read(&out).map_err(|e| format!("{}: {e}", out.display()))?;
    let (mut wrong, mut unfinished) = (Vec::new(), 0);
    for kill in 0..KILLS {
        let _ = fs::remove_file(&out);
        let mut child = start()?;
        std::thread::sleep(whole_time * (kill + 1) / KILLS);
        let _ = child.kill();
        let _ = child.wait();
        match fs::read(&out) {
            Ok(bytes) if bytes == whole => {}
            Ok(bytes) => {
                wrong.push(format!("kill {kill}: {} of {} bytes were left", bytes.len(), whole.len()))
            }
            Err(_) => unfinished += 1,
        }
    }
    if unfinished == 0 {
        wrong.push("no kill hit a run".to_owned());
    }
    let last = start()?.wait();
    if !last.is_ok_and(|s| s.success()) || fs::read(&out).ok().as_deref() != Some(&whole[..]) {
        wrong.push("the run after the kills gave another output".to_owned());
    }
    let left = entries(folder).into_iter().filter(|p| *p != out).count();
    if left > 0 {
        wrong.push(format!("{left} temporary files are left after the run that follows the kills"));
    }
    println!("{KILLS} kills, {unfinished} before the output was there, {} wrong", wrong.len());
    Ok(wrong)
}

/// Writes onto a file system of 4 KiB, one page, which is too small for any output; `None` where none can be mounted.
fn full_disk(program: &Path, folder: &Path) -> Result<Option<Vec<String>>, String> {
    make(folder)?;
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=4k", "tmpfs"])
        .arg(folder)
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|s| s.success());
    if !mounted {
        return Ok(None);
    }
    let mesh = crate::root().join("xtask/seeds/mesh.stl");
    let outputs = ["gcode", "report", "surface", "plan", "layers_cli"];
    let mut wrong = Vec::new();
    for output in outputs {
        let name = if output == "surface" { "surface.stl" } else { output };
        let elsewhere = if output == "gcode" { "" } else { "gcode = '/dev/null'\n" };
        let job = format!(
            "format = 1\n[shape]\nmesh = '{}'\n[process]\nlayer_height_mm = 0.05\nfirst_layer_height_mm = 0.1\n\
             [fill]\ndensity = 1.0\n[output]\n{elsewhere}{output} = '{}'\nsurface_cell_mm = 0.1\n",
            mesh.display(),
            folder.join(name).display()
        );
        let path = crate::target().join("campaign/full-disk.toml");
        fs::write(&path, job).map_err(|e| format!("{}: {e}", path.display()))?;
        let arguments = ["run".to_owned(), path.display().to_string(), "--json".to_owned()];
        let (ending, _) = limited(program, &arguments, &crate::target().join("campaign"))?;
        if ending != Ending::Refused {
            wrong.push(format!("full disk, {output}: {ending:?}"));
        }
        let left = entries(folder);
        if !left.is_empty() {
            wrong.push(format!("full disk, {output}: left {left:?}"));
        }
        for path in left {
            let _ = fs::remove_file(path);
        }
    }
    let unmounted = Command::new("umount").arg(folder).status().is_ok_and(|s| s.success());
    if !unmounted {
        return Err(format!("{} cannot be unmounted", folder.display()));
    }
    println!("{} outputs on a full disk, {} wrong", outputs.len(), wrong.len());
    Ok(Some(wrong))
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect()
}

fn make(folder: &Path) -> Result<(), String> {
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_seed_is_listed_and_most_mutants_pass_the_header() {
        let mut files: Vec<String> = entries(&crate::root().join("xtask/seeds"))
            .iter()
            .map(|p| p.file_name().expect("a name").to_string_lossy().into_owned())
            .filter(|name| name != "README.md")
            .collect();
        files.sort();
        let mut listed: Vec<&str> = SEEDS.iter().map(|s| s.file).collect();
        listed.sort_unstable();
        assert_eq!(files, listed);
        for seed in &SEEDS {
            let bytes = fs::read(crate::root().join("xtask/seeds").join(seed.file)).expect("a seed");
            let past = (0..100).filter(|k| mutant(&bytes, seed, &mut Draw::new(*k)).1).count();
            assert!(past > 50, "{}: {past} of 100 mutants", seed.file);
        }
    }

    #[test]
    fn panics_signals_and_silence_are_findings() {
        assert_eq!(ending(Some(0), "grainpath: warning: open edges\n"), Ending::Read);
        assert_eq!(ending(Some(3), "grainpath: a.stl: cut short\n"), Ending::Refused);
        for (code, stderr) in [
            (None, ""),
            (Some(101), "thread panicked"),
            (Some(3), ""),
            (Some(3), "grainpath: a\ngrainpath: b\n"),
        ] {
            assert!(matches!(ending(code, stderr), Ending::Wrong(_)), "{code:?} {stderr}");
        }
    }
}
