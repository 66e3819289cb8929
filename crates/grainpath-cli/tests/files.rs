//! Files that a command reads and writes: links, modes, pipes, devices, one file under two names,
//! leftovers of killed runs.
#![cfg(unix)]

mod support;

use std::fs::{self, OpenOptions};
use std::io::{Read, Write};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use support::{box_stl, folder, grainpath};

fn part(name: &str) -> std::path::PathBuf {
    let dir = folder(name);
    fs::write(dir.join("part.stl"), box_stl([8.0, 8.0, 2.0])).expect("a file");
    dir
}

fn fails(dir: &Path, args: &[&str], says: &str) {
    let out = grainpath(dir, args);
    let stderr = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{args:?}: {stderr}");
    assert!(stderr.contains(says), "{args:?}: {stderr:?} should say {says:?}");
}

fn works(out: &Output) {
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}

#[test]
fn links_are_followed_and_modes_stay() {
    let dir = part("files-links");
    fs::create_dir(dir.join("elsewhere")).expect("a folder");
    fs::write(dir.join("elsewhere/real.gcode"), "old").expect("a file");
    fs::set_permissions(dir.join("elsewhere/real.gcode"), fs::Permissions::from_mode(0o600)).expect("a mode");
    symlink("elsewhere/real.gcode", dir.join("part.gcode")).expect("a link");
    symlink("elsewhere/new.gcode", dir.join("new.gcode")).expect("a link to nothing yet");
    for name in ["part.gcode", "new.gcode"] {
        works(&grainpath(&dir, &["slice", "part.stl", "-o", name]));
        assert!(fs::symlink_metadata(dir.join(name)).expect("there").is_symlink(), "{name} stays a link");
    }
    let real = fs::read_to_string(dir.join("elsewhere/real.gcode")).expect("a text");
    assert!(real.len() > 1000 && real.is_ascii(), "the target of the link has the program");
    assert!(dir.join("elsewhere/new.gcode").is_file());
    let mode = fs::metadata(dir.join("elsewhere/real.gcode")).expect("there").permissions().mode() & 0o777;
    assert_eq!(mode, 0o600);
}

#[test]
fn pipes_and_devices_are_written_through() {
    let dir = part("files-pipes");
    let made = Command::new("mkfifo").arg(dir.join("pipe")).status().expect("mkfifo");
    assert!(made.success());
    // Opening a pipe for writing waits for a reader.
    let reader = {
        let path = dir.join("pipe");
        std::thread::spawn(move || fs::read(path).expect("what was written"))
    };
    works(&grainpath(&dir, &["slice", "part.stl", "-o", "pipe"]));
    works(&grainpath(&dir, &["slice", "part.stl", "-o", "file.gcode"]));
    let through = reader.join().expect("read");
    assert!(through == fs::read(dir.join("file.gcode")).expect("a program"), "the same program");
    works(&grainpath(&dir, &["slice", "part.stl", "-o", "/dev/null"]));
    use std::os::unix::fs::FileTypeExt;
    assert!(fs::metadata("/dev/null").expect("there").file_type().is_char_device());
    let out = grainpath(&dir, &["slice", "part.stl", "-o", "/dev/stdout"]);
    works(&out);
    assert!(out.stdout == through, "standard output has the program and nothing else");
}

#[test]
fn standard_input_is_a_file_named_with_a_dash() {
    let dir = part("files-stdin");
    let run = |args: &[&str]| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_grainpath"))
            .args(args)
            .current_dir(&dir)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("started");
        let bytes = fs::read(dir.join("part.stl")).expect("a mesh");
        // A command that refuses its arguments does not read, and the write then fails.
        let _ = child.stdin.take().expect("a pipe").write_all(&bytes);
        child.wait_with_output().expect("ended")
    };
    works(&run(&["slice", "-", "-o", "from-stdin.gcode"]));
    works(&grainpath(&dir, &["slice", "part.stl", "-o", "from-file.gcode"]));
    let read = |name: &str| fs::read(dir.join(name)).expect("a program");
    assert!(read("from-stdin.gcode") == read("from-file.gcode"));
    let out = run(&["slice", "-"]);
    assert_eq!(out.status.code(), Some(2), "without a name for the program");
}

#[test]
fn an_endless_device_is_refused() {
    let dir = part("files-endless");
    symlink("/dev/zero", dir.join("zero.stl")).expect("a link");
    let out = grainpath(&dir, &["inspect", "zero.stl"]);
    assert_eq!(out.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&out.stderr).contains("more than 1024 MiB"));
}

#[test]
fn a_full_standard_output_is_an_error() {
    let dir = part("files-full");
    let Ok(full) = OpenOptions::new().write(true).open("/dev/full") else {
        panic!("/dev/full is needed");
    };
    let out = Command::new(env!("CARGO_BIN_EXE_grainpath"))
        .args(["inspect", "part.stl", "--json"])
        .current_dir(&dir)
        .stdout(full)
        .output()
        .expect("started");
    assert_eq!(out.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&out.stderr).contains("cannot write standard output"));
}

#[test]
fn a_program_has_the_name_that_a_setting_gives_it() {
    let dir = part("files-set-name");
    works(&grainpath(&dir, &["slice", "part.stl", "--set", "output.gcode=mine.gcode"]));
    assert!(dir.join("mine.gcode").exists() && !dir.join("part.gcode").exists());
    works(&grainpath(&dir, &["slice", "part.stl", "-o", "mine.gcode", "--set", "output.gcode=mine.gcode"]));
    fails(
        &dir,
        &["slice", "part.stl", "-o", "a.gcode", "--set", "output.gcode=b.gcode"],
        "-o a.gcode and output.gcode = b.gcode: give one name of the program",
    );
    assert!(!dir.join("a.gcode").exists() && !dir.join("b.gcode").exists());
}

#[test]
fn an_output_replaces_neither_an_input_nor_another_output() {
    let dir = part("files-twice");
    fs::write(dir.join("other.stl"), box_stl([8.0, 8.0, 3.0])).expect("a file");
    symlink("part.stl", dir.join("link.stl")).expect("a link");
    let job = "[shape]\nmesh = \"part.stl\"\n[output]\ngcode = \"GCODE\"\nreport = \"report.html\"\nplan = \"PLAN\"\n";
    let jobs = [
        ("own.toml", "own.toml", "plan.json", "the job file"),
        ("mesh.toml", "a.gcode", "./part.stl", "[shape]"),
        ("link.toml", "a.gcode", "link.stl", "[shape]"),
        ("twice.toml", "a.gcode", "report.html", "output.report and output.plan name the same file"),
    ];
    for (name, gcode, plan, says) in jobs {
        fs::write(dir.join(name), job.replace("GCODE", gcode).replace("PLAN", plan)).expect("a file");
        fails(&dir, &["run", name], says);
        assert!(!dir.join("report.html").exists(), "{name}: nothing is written");
    }
    fails(&dir, &["slice", "part.stl", "-o", "part.stl"], "never replaces an input");
    fails(&dir, &["support", "other.stl", "-o", "other.stl"], "never replaces an input");
    fails(&dir, &["slice", "part.stl", "-o", "other.stl/deep/x.gcode"], "other.stl is a file, not a folder");
    works(&grainpath(&dir, &["slice", "part.stl"]));
    fails(&dir, &["render", "part.gcode", "-o", "part.gcode"], "never replaces an input");
    fails(&dir, &["inspect", "part.stl", "--sheet", "part.stl"], "never replaces an input");
}

#[test]
fn leftovers_of_killed_runs_go_with_the_next() {
    let dir = part("files-leftovers");
    // The number is above the largest that Linux gives to a process (2^22), so no process has it.
    let dead = dir.join(".grainpath-4194999-abc");
    let living = dir.join(format!(".grainpath-{}-abc", std::process::id()));
    for path in [&dead, &living] {
        fs::write(path, "half a program").expect("a file");
    }
    works(&grainpath(&dir, &["slice", "part.stl"]));
    assert!(!dead.exists(), "its run has ended");
    assert!(living.exists(), "its run goes on");
    let mut text = String::new();
    fs::File::open(dir.join("part.gcode")).and_then(|mut f| f.read_to_string(&mut text)).expect("a program");
    assert!(text.contains("G1"));
}

#[test]
fn pictures_of_the_preview_replace_no_input_and_no_output() {
    let dir = part("files-preview");
    for name in ["layer_0001.png", "part.png"] {
        fs::write(dir.join(name), "a photograph").expect("a file");
        let size = "shape.photo.size_mm=[20,20]";
        let sets = ["--set", size, "--set", "shape.photo.thickness_mm=1", "--set", "output.preview=."];
        fails(&dir, &[&["slice", name][..], &sets].concat(), "an output never replaces an input");
        assert_eq!(fs::read_to_string(dir.join(name)).expect("there"), "a photograph");
    }
    fs::create_dir(dir.join("pictures")).expect("a folder");
    symlink("../part.stl", dir.join("pictures/layer_0003.svg")).expect("a link");
    let before = fs::read(dir.join("part.stl")).expect("there");
    let preview = ["slice", "part.stl", "--set", "output.preview=pictures"];
    fails(&dir, &preview, "an output never replaces an input");
    assert_eq!(fs::read(dir.join("part.stl")).expect("there"), before);
    fs::remove_file(dir.join("pictures/layer_0003.svg")).expect("removed");
    for (set, name) in [("output.plan", "part.png"), ("output.layers_svg", "layer_0002.svg")] {
        let set = format!("{set}=pictures/{name}");
        fails(&dir, &[&preview[..], &["--set", &set]].concat(), "name the same file");
    }
    fails(&dir, &[&preview[..], &["-o", "pictures/./layer_0001.png"]].concat(), "name the same file");
    works(&grainpath(&dir, &preview));
    // The pictures of the run before are written again.
    works(&grainpath(&dir, &preview));
    let fills = ["support", "part.stl", "--with-model", "-o", "trees_side.stl", "--preview", "."];
    fs::rename(dir.join("part.stl"), dir.join("overhangs.png")).expect("renamed");
    symlink("overhangs.png", dir.join("part.stl")).expect("a link");
    fails(&dir, &fills, "an output never replaces an input");
}

#[test]
fn names_that_are_no_text_keep_their_bytes() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let dir = part("files-names");
    let slice = |input: &[u8]| {
        let program = env!("CARGO_BIN_EXE_grainpath");
        let mut command = Command::new(program);
        command.current_dir(&dir).arg("slice").arg(OsStr::from_bytes(input)).output().expect("the program")
    };
    for input in [&b"br\xfccke.stl"[..], b"\xff\xfe.x.stl"] {
        fs::copy(dir.join("part.stl"), dir.join(OsStr::from_bytes(input))).expect("a copy");
        works(&slice(input));
        let program = [&input[..input.len() - 3], b"gcode"].concat();
        assert!(dir.join(OsStr::from_bytes(&program)).is_file(), "{}", input.escape_ascii());
    }
    let names = fs::read_dir(&dir).expect("a folder").map(|entry| entry.expect("a file").file_name());
    assert_eq!(names.filter(|name| name.to_string_lossy().ends_with(".gcode")).count(), 2);
    // A job names photographs and scans as text, so these are refused with what to do.
    for input in [&b"br\xfccke.nrrd"[..], b"br\xfccke.mhd"] {
        fs::write(dir.join(OsStr::from_bytes(input)), "NRRD0004\n").expect("a file");
        let out = slice(input);
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.code() == Some(3) && stderr.contains("UTF-8"), "{stderr}");
    }
}

#[test]
fn headers_of_scans_follow_no_link_out_of_their_folder() {
    let dir = folder("files-headers");
    for folder in ["scan/below", "elsewhere"] {
        fs::create_dir_all(dir.join(folder)).expect("a folder");
    }
    let voxels: Vec<u8> = (0..20 * 20 * 20).map(|i| if (i / 20) % 20 < 10 { 200 } else { 10 }).collect();
    for place in ["scan/below/own.raw", "elsewhere/secret.raw"] {
        fs::write(dir.join(place), &voxels).expect("voxels");
    }
    symlink("below/own.raw", dir.join("scan/inside.raw")).expect("a link");
    symlink("../elsewhere/secret.raw", dir.join("scan/outside.raw")).expect("a link");
    symlink("../elsewhere", dir.join("scan/folder")).expect("a link");
    for (data, is_inside) in
        [("inside.raw", true), ("below/own.raw", true), ("outside.raw", false), ("folder/secret.raw", false)]
    {
        let mhd = format!(
            "NDims = 3\nDimSize = 20 20 20\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = {data}\n"
        );
        let nhdr = format!(
            "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 20 20 20\nspacings: 1 1 1\nencoding: raw\ndata file: {data}\n"
        );
        for (name, text) in [("scan/a.mhd", mhd), ("scan/a.nhdr", nhdr)] {
            fs::write(dir.join(name), text).expect("a header");
            let out = grainpath(&dir, &["inspect", name]);
            let stderr = String::from_utf8_lossy(&out.stderr);
            assert_eq!(out.status.code(), Some(if is_inside { 0 } else { 3 }), "{name} {data}: {stderr}");
            assert!(is_inside || stderr.contains("outside_folder = true"), "{stderr}");
            let out =
                grainpath(&dir, &["slice", name, "--set", "shape.ct.outside_folder=true", "-o", "a.gcode"]);
            works(&out);
        }
    }
}
