//! What a new user meets first: help with examples, completions, manual pages, the state of the machine.

mod support;

use std::path::Path;
use std::process::{Command, Stdio};

use support::{folder, grainpath, json};

/// The commands that `grainpath --help` lists.
fn commands(dir: &Path) -> Vec<String> {
    let help = grainpath(dir, &["--help"]);
    let text = String::from_utf8_lossy(&help.stdout).into_owned();
    let listed = text.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    let names: Vec<String> = listed.filter_map(|l| l.split_whitespace().next().map(str::to_owned)).collect();
    assert!(names.len() > 12, "{text}");
    names
}

#[test]
fn every_command_shows_two_examples_of_itself() {
    let dir = folder("doors-examples");
    for name in commands(&dir) {
        let help = grainpath(&dir, &[&name, "--help"]);
        let text = String::from_utf8_lossy(&help.stdout).into_owned();
        let examples = text.lines().skip_while(|l| *l != "Examples:").skip(1);
        let own = examples.filter(|l| l.starts_with(&format!("  grainpath {name}"))).count();
        assert!(own >= 2, "{name}: {text}");
    }
}

#[test]
fn completions_know_every_command_and_bash_accepts_them() {
    let dir = folder("doors-completions");
    for shell in ["bash", "zsh", "fish"] {
        let script = grainpath(&dir, &["completions", shell]);
        assert!(script.status.success());
        let text = String::from_utf8_lossy(&script.stdout).into_owned();
        let options = ["prusa-mk3s", "petg"];
        // clap_complete writes no values of arguments without a dash for fish.
        let words = ["tree-support", "s2-tension", "critical-angle"].into_iter().filter(|_| shell != "fish");
        for name in commands(&dir).into_iter().chain(options.into_iter().chain(words).map(str::to_owned)) {
            assert!(text.contains(&name), "{shell} does not complete {name}");
        }
        if shell == "bash" {
            let path = dir.join("completions.bash");
            std::fs::write(&path, text).expect("written");
            let checked = Command::new("bash").arg("-n").arg(&path).status();
            assert!(checked.map_or(true, |s| s.success()), "bash refuses its completions");
        }
    }
}

#[test]
fn there_is_a_manual_page_for_each_command_and_no_file_is_lost() {
    let dir = folder("doors-man");
    assert!(grainpath(&dir, &["man", "pages"]).status.success());
    for name in commands(&dir) {
        let page = std::fs::read_to_string(dir.join(format!("pages/grainpath-{name}.1"))).expect("a page");
        let version = env!("CARGO_PKG_VERSION");
        let title = format!(".TH grainpath-{name} 1 \"\" \"grainpath {version}\" \"\"\n");
        assert!(page.contains(&title) && page.contains(".SH EXAMPLES\n  grainpath"), "{name}: {page}");
    }
    assert!(dir.join("pages/grainpath.1").is_file());
    let again = grainpath(&dir, &["man", "pages"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("--force"));
    assert!(grainpath(&dir, &["man", "pages", "--force"]).status.success());
}

#[test]
fn the_doctor_names_the_machine_and_a_folder_that_cannot_be_written() {
    let dir = folder("doors-doctor");
    let value = json(&grainpath(&dir, &["doctor", "--json"]));
    assert_eq!(value["version"], env!("CARGO_PKG_VERSION"));
    assert!(value["threads"].as_u64().is_some_and(|n| n >= 1), "{value}");
    assert!(value["working_folder"]["problem"].is_null(), "{value}");
    let left_out = value["formats_left_out"].as_array().expect("a list").len();
    let built_in = [cfg!(feature = "jpeg2000"), cfg!(feature = "zarr")].into_iter().filter(|b| *b).count();
    assert_eq!(left_out + built_in, 2, "{value}");
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainpath"));
    let lost =
        command.args(["doctor", "--json"]).current_dir(&dir).env("TMPDIR", dir.join("absent")).output();
    let value = json(&lost.expect("the program starts"));
    assert!(value["temporary_folder"]["problem"].is_string(), "{value}");
}

#[test]
fn licences_name_the_libraries_and_their_owners() {
    let text = grainpath(&folder("doors-licences"), &["licences"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    for part in ["clap 4", "rayon 1", "Permission is hereby granted", "Copyright (c)"] {
        assert!(text.contains(part), "{part}");
    }
}

/// A block of bright voxels in noise-free air, as NRRD.
fn scan(dir: &Path) {
    let mut bytes = b"NRRD0005\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 30 24 20\n\
                      space directions: (0.5,0,0) (0,0.5,0) (0,0,0.5)\nencoding: raw\n\n"
        .to_vec();
    for (z, y, x) in (0..20).flat_map(|z| (0..24).flat_map(move |y| (0..30).map(move |x| (z, y, x)))) {
        let inside = (3..17).contains(&z) && (4..20).contains(&y) && (5..25).contains(&x);
        bytes.push(if inside { 200 } else { 10 });
    }
    std::fs::write(dir.join("block.nrrd"), bytes).expect("written");
}

#[test]
fn slice_takes_a_scan_and_says_so() {
    let dir = folder("doors-scan");
    scan(&dir);
    let told = grainpath(&dir, &["slice", "block.nrrd"]);
    let text = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.status.success() && text.contains("taken for a scan"), "{text}");
    let value = json(&grainpath(&dir, &["slice", "block.nrrd", "--json", "-o", "again.gcode"]));
    // 14 slices of 0.5 mm in layers of 0.2 mm.
    assert!((value["z_max_mm"].as_f64().expect("a height") - 7.0).abs() <= 0.2, "{value}");
    assert_eq!(
        std::fs::read(dir.join("block.gcode")).expect("written"),
        std::fs::read(dir.join("again.gcode")).expect("written")
    );
}

#[test]
fn slice_takes_raw_voxels_whose_size_is_set() {
    let dir = folder("doors-raw");
    scan(&dir);
    let all = std::fs::read(dir.join("block.nrrd")).expect("written");
    std::fs::write(dir.join("block.raw"), &all[all.len() - 30 * 24 * 20..]).expect("written");
    let refused = grainpath(&dir, &["slice", "block.raw"]);
    let text = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(text.contains("voxels without their header") && text.contains("shape.ct.size_px"), "{text}");
    let sets = ["shape.ct.size_px=[30,24,20]", "shape.ct.pixel_mm=0.5", "shape.ct.slice_mm=0.5"];
    let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", *set]).collect();
    let words = [&["slice", "block.raw", "--json", "-o", "raw.gcode"], &sets[..]].concat();
    let value = json(&grainpath(&dir, &words));
    assert!((value["z_max_mm"].as_f64().expect("a height") - 7.0).abs() <= 0.2, "{value}");
}

#[test]
fn inspect_tells_what_slice_refuses_a_scan_for() {
    let dir = folder("doors-implausible");
    let write = |name: &str, sample: &str, voxels: &dyn Fn(usize) -> Vec<u8>| {
        let head = format!("NRRD0005\ntype: {sample}\nsizes: 30 24 20\nspacings: 1 1 1\nendian: little\n");
        let mut bytes = format!("{head}encoding: raw\n\n").into_bytes();
        bytes.extend((0..30 * 24 * 20).flat_map(voxels));
        std::fs::write(dir.join(name), bytes).expect("written");
        json(&grainpath(&dir, &["inspect", name, "--json"]))
    };
    let told = |value: &serde_json::Value| {
        value["warnings"].as_array().is_some_and(|all| all.iter().any(|w| w["id"] == "scan-implausible"))
    };
    let nan = write("nan.nrrd", "float", &|_| f32::NAN.to_le_bytes().to_vec());
    assert!(told(&nan) && nan["otsu"].is_null() && nan["grey"].is_null(), "{nan}");
    // A smooth hill; its bytes are in the order that the header does not state.
    let hill = |i: usize| {
        let (x, y) = ((i % 30) as f64 - 15.0, (i / 30 % 24) as f64 - 12.0);
        (20_000.0 / (1.0 + (x * x + y * y) / 40.0)) as u16
    };
    let swapped = write("swapped.nrrd", "ushort", &|i| hill(i).to_be_bytes().to_vec());
    assert!(told(&swapped) && swapped["warnings"].to_string().contains("wrong order"), "{swapped}");
    let right = write("right.nrrd", "ushort", &|i| hill(i).to_le_bytes().to_vec());
    assert!(!told(&right) && right["otsu"].is_number(), "{right}");
}

#[test]
fn slice_says_which_profiles_it_assumed() {
    let dir = folder("doors-assumed");
    scan(&dir);
    let slice = |words: &[&str]| grainpath(&dir, &[&["slice", "block.nrrd"], words].concat());
    let told = |out: &std::process::Output| String::from_utf8_lossy(&out.stdout).into_owned();
    let text = told(&slice(&[]));
    assert!(text.contains("assumed printer generic-0.4, material pla, process standard;"), "{text}");
    assert!(text.contains("the part of the scan: ") && text.contains(" x "), "{text}");
    let text = told(&slice(&["--set", "material.profile=petg"]));
    assert!(text.contains("assumed printer generic-0.4, process standard;"), "{text}");
    let all = ["printer.profile=voron-2.4", "material.profile=petg", "process.profile=fine"];
    let text = told(&slice(&all.iter().flat_map(|set| ["--set", *set]).collect::<Vec<_>>()));
    assert!(text.contains("taken for a scan") && !text.contains("assumed printer"), "{text}");
    // The program alone stands on standard output.
    let out = slice(&["-o", "/dev/stdout"]);
    let file = std::fs::read(dir.join("block.gcode")).expect("written above");
    assert!(!file.is_empty() && slice(&[]).status.success());
    assert!(out.stdout == std::fs::read(dir.join("block.gcode")).expect("written"));
    assert!(String::from_utf8_lossy(&out.stderr).contains("assumed printer generic-0.4"));
    // A reader that takes the first bytes and closes the pipe got what it wanted.
    #[cfg(target_os = "linux")]
    {
        let mut command = Command::new(env!("CARGO_BIN_EXE_grainpath"));
        let pipes = command.args(["slice", "block.nrrd", "-o", "/dev/stdout"]).current_dir(&dir);
        let mut run =
            pipes.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        drop(run.stdout.take());
        let out = run.wait_with_output().expect("it ends");
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    }
}

#[test]
fn a_file_without_a_command_is_answered_with_the_commands_that_take_it() {
    let dir = folder("doors-no-command");
    for (name, command) in [("part.stl", "slice part.stl"), ("job.toml", "run"), ("p.gcode", "inspect")] {
        std::fs::write(dir.join(name), "x").expect("a file");
        let out = grainpath(&dir, &[name]);
        let text = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2));
        assert!(text.contains(&format!("`grainpath {command}`")) && text.lines().count() == 1, "{text}");
    }
    let out = grainpath(&dir, &["slcie", "part.stl"]);
    assert!(String::from_utf8_lossy(&out.stderr).contains("'slice'"), "a mistyped command is no file");
}

#[test]
fn new_asks_nothing_in_a_pipe_and_takes_printer_and_material() {
    let dir = folder("doors-new");
    let out = grainpath(&dir, &["new", "plate", "own"]);
    assert!(out.status.success() && out.stderr.is_empty(), "{}", String::from_utf8_lossy(&out.stderr));
    let out =
        grainpath(&dir, &["new", "stress-lines", "other", "--printer", "prusa-mk3s", "--material", "petg"]);
    assert!(out.status.success() && out.stderr.is_empty(), "{}", String::from_utf8_lossy(&out.stderr));
    let job = |name: &str| std::fs::read_to_string(dir.join(name)).expect("a job");
    assert!(job("own/job.toml").contains("profile = \"generic-0.4\""));
    for name in ["other/tension.toml", "other/bending-90.toml"] {
        let text = job(name);
        assert!(text.contains("[printer]\nprofile = \"prusa-mk3s\"\n"), "{name}: {text}");
        // The temperatures of the example are those of its own material.
        assert!(
            text.contains("[material]\nprofile = \"petg\"\n") && !text.contains("_temp_c"),
            "{name}: {text}"
        );
    }
    let out = grainpath(&dir, &["new", "field", "--printer", "prusa-mk3"]);
    let text = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && text.contains("did you mean \"prusa-mk3s\"?"), "{text}");
    assert!(!dir.join("field").exists(), "a refusal writes nothing");
    // Fibre needs a printer that lays it.
    let out = grainpath(&dir, &["new", "continuous", "--printer", "voron-2.4", "--material", "petg"]);
    let text = String::from_utf8_lossy(&out.stderr).into_owned();
    let fitting = "these do: fibre-coextruded, fibre-separate\n";
    assert!(out.status.code() == Some(2) && text.ends_with(fitting), "{text}");
    assert!(!dir.join("continuous").exists(), "a refusal writes nothing");
    let out = grainpath(&dir, &["new", "continuous", "--printer", "fibre-separate", "--material", "petg"]);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}

#[test]
fn errors_name_pages_that_are_there() {
    let dir = folder("doors-pages");
    std::fs::write(dir.join("empty.stl"), "").expect("a file");
    std::fs::write(dir.join("typo.toml"), "[shape]\nmehs = \"a.stl\"\n").expect("a file");
    std::fs::write(dir.join("box.stl"), support::box_stl([20.0, 20.0, 2.0])).expect("a file");
    std::fs::write(dir.join("flat.stl"), support::box_stl([20.0, 20.0, 0.0])).expect("a file");
    std::fs::write(dir.join("tab.svg"), "<svg/>").expect("a file");
    std::fs::write(dir.join("board.png"), "x").expect("a file");
    std::fs::write(dir.join("heavy.toml"), "[shape]\nmesh = \"box.stl\"\n[fill]\nmass_g = 500\n")
        .expect("a file");
    for (words, page) in [
        (["slice", "empty.stl"], "docs/formats.md"),
        (["slice", "flat.stl"], "docs/formats.md"),
        (["slice", "tab.svg"], "docs/formats.md"),
        (["slice", "board.png"], "docs/tutorials/photograph.md"),
        (["run", "heavy.toml"], "docs/how-to/density.md"),
        (["run", "typo.toml"], "docs/settings.md"),
    ] {
        let out = grainpath(&dir, &[words[0], words[1], "--json"]);
        assert_eq!(json(&out)["page"], page);
        let text = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(text.trim_end().ends_with(&format!("(see {page})")) && text.lines().count() == 1, "{text}");
    }
    let source = include_str!("../../grainpath/src/error.rs");
    let pages: Vec<&str> = source.split('"').filter(|text| text.starts_with("docs/")).collect();
    assert!(pages.len() >= 10, "{pages:?}");
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for page in pages {
        assert!(top.join(page).is_file(), "{page} is not there");
    }
}
