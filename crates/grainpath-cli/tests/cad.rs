//! STEP and IGES through gmsh: what is asked of it, what becomes of its failures, and that a stopped run stops it too. A
//! script stands in for gmsh where only the way to it and back is tested.
#![cfg(unix)]

mod support;

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use support::{box_stl, folder, json};

const STEP: &str = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n";

/// A folder of programs that holds nothing but this script by the name of gmsh.
fn stand_in(dir: &Path, script: &str) {
    fs::create_dir_all(dir.join("bin")).expect("made");
    let program = dir.join("bin/gmsh");
    fs::write(&program, format!("#!/bin/sh\nPATH=/usr/bin:/bin\n{script}\n")).expect("written");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).expect("allowed");
}

/// A command whose programs and temporary files are those of the folder.
fn command(dir: &Path, args: &[&str]) -> Command {
    fs::create_dir_all(dir.join("tmp")).expect("made");
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainpath"));
    command.args(args).current_dir(dir).env("PATH", dir.join("bin")).env("TMPDIR", dir.join("tmp"));
    command
}

fn ran(dir: &Path, args: &[&str]) -> Output {
    let out = command(dir, args).output().expect("the program starts");
    assert_eq!(fs::read_dir(dir.join("tmp")).expect("a folder").count(), 0, "{args:?} left temporary files");
    out
}

/// The last argument of gmsh is the file to write.
const COPIES: &str = "test \"$1\" = --version && echo 4.99 && exit\nfor last in \"$@\"; do :; done\n\
                      test -e \"$HOME/part.step\" && cp \"$(dirname \"$0\")/../box.stl\" \"$last\"";

#[test]
fn exact_surfaces_are_triangulated_by_gmsh() {
    let dir = folder("cad-through");
    fs::write(dir.join("part.step"), STEP).expect("written");
    fs::write(dir.join("box.stl"), box_stl([24.0, 10.0, 6.0])).expect("written");
    stand_in(&dir, COPIES);
    let told = json(&ran(&dir, &["inspect", "part.step", "--json"]));
    assert_eq!(told["format"], "STEP, triangulated by gmsh 4.99");
    assert_eq!(told["triangles"], 12, "{told}");
    let faces = json(&ran(&dir, &["inspect", "part.step", "--faces", "--json"]));
    assert_eq!(faces["faces_in_all"], 6);
    assert_eq!(faces["unit_of_file"], "mm (the file says so)");
    // The same triangles give the same program, whatever file they came from.
    for model in ["part.step", "box.stl"] {
        let out = ran(&dir, &["slice", model, "-o", &format!("{model}.gcode")]);
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    }
    let [step, stl] =
        ["part.step.gcode", "box.stl.gcode"].map(|name| fs::read(dir.join(name)).expect("written"));
    assert!(step == stl && step.len() > 1000);
}

#[test]
fn without_gmsh_and_where_it_fails_the_reason_is_told() {
    let dir = folder("cad-refused");
    fs::write(dir.join("part.step"), STEP).expect("written");
    let cases = [
        ("", "install gmsh"),
        ("echo 'Error   : Could not read it'; exit 1", "found no part in it: Could not read it"),
        ("exit 0", "found no part in it"),
        ("for last in \"$@\"; do :; done; echo hello > \"$last\"", "not a mesh"),
    ];
    for (script, reason) in cases {
        if !script.is_empty() {
            stand_in(&dir, script);
        }
        for args in [&["inspect", "part.step"][..], &["slice", "part.step", "-o", "part.gcode"]] {
            let out = ran(&dir, args);
            let text = String::from_utf8_lossy(&out.stderr).into_owned();
            assert_eq!(out.status.code(), Some(3), "{script}: {text}");
            assert!(text.contains("part.step") && text.contains(reason), "{script}: {text}");
            assert!(!dir.join("part.gcode").exists());
        }
    }
}

#[test]
fn a_stopped_run_stops_gmsh() {
    let dir = folder("cad-stopped");
    fs::write(dir.join("part.step"), STEP).expect("written");
    stand_in(&dir, "echo $$ > \"$(dirname \"$0\")/../pid\"; exec sleep 60");
    let mut run = command(&dir, &["slice", "part.step", "-o", "part.gcode"])
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let start = Instant::now();
    let pid = loop {
        assert!(start.elapsed() < Duration::from_secs(30), "gmsh was not started");
        match fs::read_to_string(dir.join("pid")) {
            Ok(text) if text.ends_with('\n') => break text.trim().to_owned(),
            _ => std::thread::sleep(Duration::from_millis(5)),
        }
    };
    assert!(Command::new("kill").args(["-TERM", &run.id().to_string()]).status().expect("kill").success());
    assert_eq!(run.wait().expect("ended").code(), Some(130));
    let lives =
        || Command::new("kill").args(["-0", &pid]).stderr(Stdio::null()).status().expect("kill").success();
    let start = Instant::now();
    while lives() {
        assert!(start.elapsed() < Duration::from_secs(5), "gmsh goes on");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(!dir.join("part.gcode").exists());
}

/// The size is that of the drawing, and 190 457 mm3 the volume of a mesh of twice as many triangles.
#[test]
#[ignore = "needs GRAINPATH_DATA and gmsh"]
fn a_real_part_comes_closed_and_in_millimetres() {
    let dir = folder("cad-real");
    let file = support::data::data("fea/bracket.step");
    let inspect = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_grainpath"));
        json(
            &command
                .args(["inspect", "--json"])
                .arg(&file)
                .current_dir(&dir)
                .output()
                .expect("the program starts"),
        )
    };
    let told = inspect();
    assert_eq!(told["closed"], true, "{told}");
    let size: Vec<f64> = (0..3).filter_map(|k| told["extents"][k].as_f64()).collect();
    for (found, wanted) in size.iter().zip([127.0, 63.5, 34.925]) {
        assert!((found - wanted).abs() < 1e-3, "{told}");
    }
    let volume = told["volume"].as_f64().expect("a volume");
    assert!((volume / 190_457.0 - 1.0).abs() < 1e-3, "{volume}");
    assert_eq!(told, inspect(), "two runs gave different meshes");
}
