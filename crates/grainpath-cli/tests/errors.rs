//! Bad input: one line that names the fault and its place, the right exit code, and no file left over.

mod support;

use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};

use support::{box_stl, folder, grainpath, json};

/// Runs a command and checks exit code and message, and that neither an output nor a temporary file
/// exists.
fn fails(name: &str, args: &[&str], code: i32, says: &str) {
    let dir = folder(name);
    fs::write(dir.join("box.stl"), box_stl([10.0, 10.0, 5.0])).expect("a file");
    fs::write(dir.join("empty.stl"), "").expect("a file");
    fs::write(dir.join("flat.stl"), box_stl([10.0, 10.0, 0.0])).expect("a file");
    fs::write(dir.join("big.stl"), box_stl([500.0, 10.0, 5.0])).expect("a file");
    fs::write(dir.join("tall.stl"), box_stl([10.0, 10.0, 300.0])).expect("a file");
    fs::write(dir.join("nan.stl"), box_stl([10.0, 10.0, 5.0]).replacen("vertex 0", "vertex nan", 1))
        .expect("a file");
    fs::write(dir.join("huge.stl"), box_stl([10.0, 10.0, 5.0]).replacen("vertex 10", "vertex 1e38", 1))
        .expect("a file");
    // A binary STL that promises 12 facets and ends within the eighth.
    let mut binary = vec![0u8; 80];
    binary.extend(12u32.to_le_bytes());
    binary.extend(vec![1u8; 50 * 7 + 20]);
    fs::write(dir.join("cut.stl"), binary).expect("a file");
    fs::write(dir.join("bomb.3mf"), bomb()).expect("a file");
    // Zero bytes tell voxels from text.
    for voxels in ["voxels.raw", "voxels.bin"] {
        fs::write(dir.join(voxels), [3u8, 200, 0, 71, 49, 10].repeat(64)).expect("a file");
    }
    fs::write(dir.join("typo.toml"), "[shape]\nmesh = \"box.stl\"\n[process]\nlayer_heigth_mm = 0.2\n")
        .expect("a file");
    fs::write(dir.join("negative.toml"), "[shape]\nmesh = \"box.stl\"\n\n[process]\nbead_width_mm = -0.4\n")
        .expect("a file");
    fs::write(dir.join("nomesh.toml"), "[fill]\ndensity = 0.2\n").expect("a file");
    fs::write(dir.join("missing.toml"), "[shape]\nmesh = \"nowhere.stl\"\n").expect("a file");
    let mut before: Vec<_> = list(&dir);
    let out = grainpath(&dir, args);
    let stderr = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(code), "{name}: {stderr}");
    assert!(stderr.contains(says), "{name}: {stderr:?} should say {says:?}");
    assert_eq!(stderr.lines().count(), 1, "{name}: one line: {stderr}");
    assert!(!stderr.contains("panicked"), "{name}: {stderr}");
    before.sort();
    assert_eq!(list(&dir), before, "{name}: nothing may be left behind");
}

fn list(dir: &std::path::Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(dir)
        .expect("the folder")
        .map(|f| f.expect("a file").file_name().to_string_lossy().into())
        .collect();
    names.sort();
    names
}

/// A 3MF whose model inflates to a thousand times its packed size.
fn bomb() -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    let rels = r#"<Relationships><Relationship Target="/m" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
    for (name, text) in
        [("_rels/.rels", rels.to_owned()), ("m", format!("<model><resources>{}", " ".repeat(100 << 20)))]
    {
        zip.start_file(name, options).expect("memory");
        zip.write_all(text.as_bytes()).expect("memory");
    }
    zip.finish().expect("memory").into_inner()
}

/// JSON that the program printed or wrote is no shape; the error says what it is and what to open.
#[test]
fn saved_json_is_named_with_what_to_open() {
    let dir = folder("saved json");
    fs::write(dir.join("box.stl"), box_stl([10.0, 4.0, 0.4])).expect("a file");
    let job = "[shape]\nmesh = \"box.stl\"\n[fill]\ndensity = 1\n[strength]\ncheck = false\ncorners = false\n\
               [[guide.fixture]]\non = { box_mm = [[0, 0, 0], [1, 4, 1]] }\nfix = \"xyz\"\n\
               [[guide.load]]\non = { box_mm = [[9, 0, 0], [10, 4, 1]] }\nforce_n = [10, 0, 0]\n[output]\nplan = \"paths.json\"\n";
    fs::write(dir.join("pull.toml"), job).expect("a file");
    for (name, args) in [
        ("plan.json", &["run", "pull.toml", "--json"][..]),
        ("strength.json", &["strength", "pull.toml", "--json"]),
        ("failed.json", &["slice", "nowhere.stl", "--json"]),
    ] {
        let out = grainpath(&dir, args);
        fs::write(dir.join(name), &out.stdout).expect("a file");
    }
    fs::write(dir.join("list.json"), "[1, 2]").expect("a file");
    for (name, says) in [
        ("plan.json", "plan.json: the JSON report of a plan; open its G-code, box.gcode, or its job (.toml)"),
        (
            "strength.json",
            "the JSON report of a strength test; open the G-code or the job (.toml) that was tested",
        ),
        ("failed.json", "the JSON of a run that failed (nowhere.stl: no such file"),
        ("paths.json", "the paths of a plan as JSON; open the G-code or the job of that plan"),
        ("list.json", "a JSON file, which holds no shape"),
    ] {
        let out = grainpath(&dir, &["slice", name]);
        let error = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(out.status.code() == Some(3) && error.contains(says), "{name}: {error}");
    }
}

#[test]
fn input_files() {
    fails("empty", &["slice", "empty.stl"], 3, "empty.stl: the file is empty");
    fails("truncated", &["slice", "cut.stl"], 3, "promises 12 facets, the file holds 7");
    fails("nan", &["slice", "nan.stl"], 3, "is not a finite number");
    fails("huge", &["slice", "huge.stl"], 3, "below 1e9");
    fails("flat", &["slice", "flat.stl"], 3, "0 mm high");
    fails("missing", &["slice", "nowhere.stl"], 3, "nowhere.stl: no such file");
    fails("directory", &["slice", "."], 3, "no DICOM, PNG, TIFF, BMP or JPEG slices in it");
    fails("bomb", &["slice", "bomb.3mf"], 3, "zip bomb");
    fails("missing mesh of a job", &["run", "missing.toml"], 3, "nowhere.stl");
    fails("not a mesh", &["slice", "typo.toml"], 3, "not a mesh, but a job: `grainpath run` takes it");
    fails("a model for a job", &["run", "box.stl"], 2, "`grainpath slice box.stl` plans it");
    fails("no photograph", &["slice", "nowhere.heic"], 3, "nowhere.heic: no such file");
    fails("percent", &["slice", "box.stl", "--set", "fill.density=30"], 2, "should be from 0 to 1, is 30");
    fails("inspect empty", &["inspect", "empty.stl"], 3, "the file is empty");
    fails(
        "voxels",
        &["inspect", "voxels.raw"],
        3,
        "voxels without a header? give --size COLUMNS,ROWS,SLICES",
    );
    fails("voxels by any name", &["inspect", "voxels.bin"], 3, "--sample u8|i8|u16");
    fails("strict", &["slice", "flat.stl", "--set", "shape.repair=strict"], 3, "flat.stl");
}

#[test]
fn jobs_and_usage() {
    fails(
        "unknown key",
        &["run", "typo.toml"],
        2,
        "typo.toml:4: unknown key `layer_heigth_mm` in [process]; did you mean `layer_height_mm`?",
    );
    fails(
        "negative width",
        &["run", "negative.toml"],
        2,
        "negative.toml:5: process.bead_width_mm should be from 0.05 to 10, is -0.4",
    );
    fails("no mesh", &["run", "nomesh.toml"], 2, "[shape] needs mesh");
    fails("no job", &["run", "nowhere.toml"], 2, "nowhere.toml: no such file");
    fails("bad set", &["slice", "box.stl", "--set", "walls=2"], 2, "section.key=value");
    fails(
        "profile",
        &["slice", "box.stl", "--set", "printer.profile=generic-0.5"],
        2,
        "did you mean \"generic-0.4\"",
    );
    fails(
        "unwritable",
        &["slice", "box.stl", "-o", "/proc/nowhere/a.gcode"],
        2,
        "cannot write /proc/nowhere/a.gcode",
    );
    fails("over input", &["slice", "box.stl", "-o", "box.stl"], 2, "is the input");
    fails("threads", &["slice", "box.stl", "--threads", "0"], 2, "--threads 0");
    fails(
        "placeholder",
        &["slice", "box.stl", "--set", "printer.start_gcode=G1 {bed_temp}"],
        2,
        "did you mean {bed_temp_c}",
    );
    fails("preset", &["new", "plat"], 2, "did you mean \"plate\"");
    // No name is near, so none is proposed.
    fails("no near profile", &["profiles", "foo"], 2, "no profile \"foo\". `grainpath profiles` lists all");
    fails("no near preset", &["new", "vase"], 2, "no preset \"vase\". There are plate");
    fails("dash", &["slice", "box.stl", "-o", "-"], 2, "/dev/stdout is standard output");
}

#[test]
fn what_cannot_be() {
    fails(
        "bed",
        &["slice", "big.stl"],
        4,
        "the print reaches X = -140.00 mm; the bed allows 0.00 to 220.00 mm",
    );
    fails("tall", &["slice", "tall.stl"], 4, "Z = 300.00 mm");
    fails("skirt", &["slice", "box.stl", "--set", "process.skirt_distance_mm=200"], 4, "the bed allows");
    fails("mass", &["slice", "box.stl", "--set", "fill.mass_g=50"], 4, "when dense");
}

#[test]
fn json_is_one_object_also_when_it_fails() {
    let dir = folder("json fails");
    fs::write(dir.join("empty.stl"), "").expect("a file");
    let out = grainpath(&dir, &["slice", "empty.stl", "--json"]);
    let said = json(&out);
    assert_eq!((said["ok"].as_bool(), said["code"].as_i64()), (Some(false), Some(3)));
    assert!(said["error"].as_str().is_some_and(|e| e.contains("empty")));
}

#[test]
fn usage_errors_exit_2() {
    let dir = folder("usage");
    for args in [&["slice"][..], &["nonsense"], &["render", "a.gcode", "--color", "mauve"], &[]] {
        assert_eq!(grainpath(&dir, args).status.code(), Some(2), "{args:?}");
    }
    for (args, says) in [
        (&["slice"][..], "`grainpath slice --help`"),
        (&["nonsense"], "`grainpath --help`"),
        (&["run", "a.toml", "--jsn"], "'--json'"),
        (&["render", "a.gcode", "--color", "mauve"], "possible values: "),
        (&["help", "nonsense"], "nonsense"),
        (&["slice", "a.stl", "--threads", "x\ny"], "--threads"),
    ] {
        let out = grainpath(&dir, args);
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert_eq!((out.status.code(), stderr.lines().count()), (Some(2), 1), "{args:?}: {stderr}");
        assert!(stderr.starts_with("grainpath: ") && stderr.contains(says), "{args:?}: {stderr}");
    }
    let said = json(&grainpath(&dir, &["slice", "--json"]));
    assert_eq!((said["ok"].as_bool(), said["code"].as_i64()), (Some(false), Some(2)));
}

#[test]
fn help_is_a_command_too() {
    let dir = folder("help");
    for (args, as_if) in [(&["help"][..], &["--help"][..]), (&["help", "slice"], &["slice", "--help"])] {
        let (out, same) = (grainpath(&dir, args), grainpath(&dir, as_if));
        assert!(out.status.success() && out.stderr.is_empty());
        assert!(!out.stdout.is_empty() && out.stdout == same.stdout);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_cannot_be_printed_is_an_error() {
    for args in [&["--help"][..], &["--version"], &["help"], &["slice", "--help"], &["profiles"]] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
        let program = env!("CARGO_BIN_EXE_grainpath");
        let out = Command::new(program).args(args).stdout(full).output().expect("the program");
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert_eq!((out.status.code(), stderr.lines().count()), (Some(2), 1), "{args:?}: {stderr}");
        assert!(stderr.contains("standard output"), "{stderr}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing_half_written() {
    let dir = folder("interrupt");
    // Twelve thousand thin layers are seconds of work, so the signal comes while the program is busy.
    fs::write(dir.join("box.stl"), box_stl([200.0, 200.0, 240.0])).expect("a file");
    let mut child = Command::new(env!("CARGO_BIN_EXE_grainpath"))
        .args([
            "slice",
            "box.stl",
            "--set",
            "process.layer_height_mm=0.02",
            "--set",
            "process.first_layer_height_mm=0.02",
            "--set",
            "fill.density=0.9",
        ])
        .current_dir(&dir)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // Long enough for the handler to be set, and short against the whole job.
    std::thread::sleep(std::time::Duration::from_millis(400));
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(killed.success());
    let status = child.wait().expect("the program ends");
    // 128 plus the number of SIGINT.
    assert_eq!(status.code(), Some(130));
    assert_eq!(list(&dir), ["box.stl"]);
}

#[test]
fn strict_refuses_what_would_only_be_warned_of() {
    let dir = folder("strict runs");
    // A missing triangle leaves a hole, which is closed with a warning.
    let mesh = box_stl([10.0, 10.0, 5.0]);
    let (first, rest) = mesh.split_at(mesh.find("facet").expect("a facet"));
    let rest = rest.split_once("endfacet\n").expect("a facet").1;
    fs::write(dir.join("open.stl"), format!("{first}{rest}")).expect("a file");
    fs::write(dir.join("box.stl"), mesh.clone()).expect("a file");
    let out = grainpath(&dir, &["slice", "open.stl", "--strict", "--json"]);
    assert_eq!(out.status.code(), Some(4), "{}", String::from_utf8_lossy(&out.stderr));
    let report = json(&out);
    assert_eq!(report["ok"], false);
    assert_eq!(report["warnings"][0]["id"], "mesh-open", "{report}");
    assert!(!dir.join("open.gcode").exists());
    let job = "format = 1\n[shape]\nmesh = \"open.stl\"\n[material]\nprofile = \"pla\"\n[guide]\nkind = \"stress\"\n\
               [[guide.fixture]]\non = { box_mm = [[-1, -1, -1], [1, 11, 6]] }\nfix = \"xyz\"\n\
               [[guide.load]]\non = { box_mm = [[9, -1, -1], [11, 11, 6]] }\nforce_n = [10, 0, 0]\n\
               [strength]\ncell_mm = 1.5\ncorners = false\ncheck = false\n";
    fs::write(dir.join("open.toml"), job).expect("a file");
    let before = list(&dir);
    for arguments in [
        &["run", "open.toml"][..],
        &["run", "open.toml", "--check"],
        &["support", "open.stl"],
        &["strength", "open.toml"],
        &["compare", "open.toml", "open.toml"],
        &["orient", "open.toml"],
    ] {
        let out = grainpath(&dir, &[arguments, &["--strict", "--json"]].concat());
        assert_eq!(out.status.code(), Some(4), "{arguments:?}: {}", String::from_utf8_lossy(&out.stderr));
        let refusal = json(&out);
        assert!(
            refusal["warnings"].as_array().is_some_and(|w| w.iter().any(|w| w["id"] == "mesh-open")),
            "{refusal}"
        );
        assert_eq!(list(&dir), before, "{arguments:?}");
    }
    for arguments in [&["slice", "open.stl"][..], &["slice", "box.stl", "--strict"]] {
        let out = grainpath(&dir, arguments);
        assert!(out.status.success(), "{:?}: {}", out.status, String::from_utf8_lossy(&out.stderr));
    }
}
