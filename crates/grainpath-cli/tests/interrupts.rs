//! Ctrl-C and SIGTERM at moments all over a run: exit code 130, files that are whole or not there, and a last line that
//! names as many files as there are.
#![cfg(unix)]

mod support;

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use support::{box_stl, folder};

/// A job that goes through every stage: reading, meshing, solving, slicing, fill, strength test, writing.
const JOB: &str = "
[shape]
mesh = \"block.stl\"

[process]
walls = 1

[fill]
pattern = \"gyroid\"
density = 0.4

[guide]
kind = \"stress\"
element_mm = 2

[[guide.fixture]]
on = { box_mm = [[0, 0, 0], [3, 10, 6]] }
fix = \"xyz\"

[[guide.load]]
on = { box_mm = [[21, 0, 0], [24, 10, 6]] }
force_n = [0, 0, -100]

[strength]
enabled = true
corners = false
cell_mm = 0.9

[output]
gcode = \"out/block.gcode\"
report = \"out/block.html\"
preview = \"out/pictures\"
";

/// Number of interruptions of each command, at even intervals over its run time.
const MOMENTS: u32 = 12;

fn started(dir: &Path, args: &[&str]) -> Child {
    fs::write(dir.join("block.stl"), box_stl([24.0, 10.0, 6.0])).expect("written");
    fs::write(dir.join("block.toml"), JOB).expect("written");
    Command::new(env!("CARGO_BIN_EXE_grainpath"))
        .args(args)
        .current_dir(dir)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("started")
}

/// Files below a folder but for the inputs, whole or temporary.
fn outputs(dir: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(dir).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files.extend(outputs(&path));
        } else if !["block.stl", "block.toml"].iter().any(|name| path.ends_with(name)) {
            files.push(path);
        }
    }
    files
}

#[test]
fn an_interrupted_run_leaves_whole_files_or_none_and_names_their_number() {
    for (k, args) in [&["run", "block.toml"][..], &["strength", "block.toml", "--preview", "pictures"]]
        .into_iter()
        .enumerate()
    {
        let dir = folder(&format!("interrupts whole {k}"));
        let start = Instant::now();
        let whole = started(&dir, args).wait_with_output().expect("ended");
        let all = start.elapsed();
        assert!(whole.status.success(), "{}", String::from_utf8_lossy(&whole.stderr));
        let n_all = outputs(&dir).len();
        assert!(n_all > 1);
        let mut n_interrupted = 0;
        for moment in 0..MOMENTS {
            let dir = folder(&format!("interrupts {k} {moment}"));
            let child = started(&dir, args);
            let wait = all * (2 * moment + 1) / (2 * MOMENTS);
            std::thread::sleep(wait.max(Duration::from_millis(1)));
            let signal = if moment % 2 == 0 { "-INT" } else { "-TERM" };
            // The run may be done.
            let _ = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
            let out = child.wait_with_output().expect("ended");
            let text = String::from_utf8_lossy(&out.stderr).into_owned();
            let there = outputs(&dir);
            let told = match text.lines().last().and_then(|l| l.strip_prefix("grainpath: interrupted; ")) {
                Some("nothing was written") => Some(0),
                Some("one file had been written") => Some(1),
                Some(line) => line.split(' ').next().and_then(|n| n.parse().ok()),
                None => None,
            };
            let about = format!("{args:?} after {wait:?}: {} {text} {there:?}", out.status);
            match out.status.code() {
                Some(0) => assert_eq!(there.len(), n_all, "{about}"),
                Some(130) => {
                    n_interrupted += 1;
                    assert_eq!(told, Some(there.len()), "{about}");
                }
                // A signal that arrives before the handler is installed ends the process, which has written nothing yet.
                None => {
                    let sent = if signal == "-INT" { 2 } else { 15 };
                    assert!(there.is_empty() && out.status.signal() == Some(sent), "{about}");
                }
                Some(_) => panic!("{about}"),
            }
            for file in there {
                let bytes = fs::read(&file).expect("a file");
                let kind = file.extension().and_then(|e| e.to_str()).map(|end| (end, &bytes[..]));
                let is_whole = match kind {
                    Some(("gcode", bytes)) => bytes.ends_with(b"\n"),
                    Some(("html", bytes)) => String::from_utf8_lossy(bytes).trim_end().ends_with("</html>"),
                    Some(("svg", bytes)) => String::from_utf8_lossy(bytes).trim_end().ends_with("</svg>"),
                    Some(("png", bytes)) => bytes.ends_with(b"IEND\xae\x42\x60\x82"),
                    _ => !bytes.is_empty(),
                };
                assert!(is_whole, "{about}: {}", file.display());
            }
        }
        assert!(n_interrupted > 0, "{args:?}: no run was interrupted");
    }
}

/// Commands that wait for a pipe nobody writes end with the same line and code.
#[test]
fn a_program_that_waits_for_a_pipe_can_be_stopped() {
    let dir = folder("interrupts pipe");
    assert!(Command::new("mkfifo").arg(dir.join("pipe.stl")).status().expect("mkfifo").success());
    let job = ["run", "block.toml", "--set", "shape.mesh=pipe.stl"];
    for (k, args) in [&["inspect", "pipe.stl"][..], &["orient", "pipe.stl"], &job].into_iter().enumerate() {
        let mut child = started(&dir, args);
        // Two seconds are long enough to begin on a busy machine too.
        let deadline = Instant::now() + Duration::from_secs(60);
        std::thread::sleep(Duration::from_secs(2));
        let signal = if k % 2 == 0 { "-TERM" } else { "-INT" };
        let _ = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
        while child.try_wait().expect("a child").is_none() {
            if Instant::now() > deadline {
                let _ = child.kill();
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        let out = child.wait_with_output().expect("ended");
        let text = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(130), "{args:?}: {} {text}", out.status);
        assert_eq!(
            text.lines().last(),
            Some("grainpath: interrupted; nothing was written"),
            "{args:?}: {text}"
        );
    }
}
