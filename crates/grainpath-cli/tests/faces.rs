//! Faces of a mesh on the command line: listed by `inspect`, named by a job.

mod support;

use serde_json::Value;
use support::{box_stl, folder, grainpath, json};

/// The names of the faces whose normal points along an axis: minus x, plus x and so on.
fn names(listed: &Value) -> Vec<String> {
    let normals = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];
    let rows = listed["faces"].as_array().expect("faces");
    let named = |n: &[i32; 3]| {
        let is = |row: &&Value| {
            (0..3).all(|k| (row["normal"][k].as_f64().expect("a number") - f64::from(n[k])).abs() < 1e-6)
        };
        rows.iter().find(is).expect("a face")["name"].as_str().expect("a name").to_owned()
    };
    normals.iter().map(named).collect()
}

#[test]
fn faces_are_listed_with_a_line_and_a_picture() {
    let dir = folder("faces-listed");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let seen = json(&grainpath(&dir, &["inspect", "bar.stl", "--faces", "--image", "bar.png", "--json"]));
    let rows = seen["faces"].as_array().expect("faces");
    assert_eq!((rows.len(), seen["faces_in_all"].as_u64()), (6, Some(6)), "{seen}");
    assert!(rows.iter().all(|r| r["kind"] == "plane" && r["doubtful"] == false), "{seen}");
    assert_eq!(rows[0]["area_mm2"].as_f64(), Some(320.0));
    let picture = std::fs::read(dir.join("bar.png")).expect("a picture");
    assert_eq!(&picture[1..4], b"PNG");
    let told = grainpath(&dir, &["inspect", "bar.stl", "--faces"]);
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    for row in rows {
        assert!(told.contains(row["line"].as_str().expect("a line")), "{told}");
    }
    // The same part in inches, in another place and order, keeps its names.
    let inches = box_stl([40.0 / 25.4, 8.0 / 25.4, 2.0 / 25.4]);
    let mut facets: Vec<&str> = inches.split_inclusive("endfacet\n").collect();
    let (first, end) = (facets.remove(0), facets.pop().expect("the end"));
    let turned = format!("solid box\n{}{}{end}", facets.concat(), first.trim_start_matches("solid box\n"));
    std::fs::write(dir.join("inches.stl"), turned).expect("a mesh");
    let again = json(&grainpath(&dir, &["inspect", "inches.stl", "--faces", "--json"]));
    assert_eq!(names(&seen), names(&again));
}

#[test]
fn loads_on_faces_turn_with_the_part() {
    let dir = folder("faces-job");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let listed = json(&grainpath(&dir, &["inspect", "bar.stl", "--faces", "--json"]));
    let names = names(&listed);
    let job = |place: &str, end: &str, shape: &str| {
        format!(
            "[shape]\nmesh = \"bar.stl\"\n{shape}\n[guide]\nkind = \"stress\"\nframe = \"part\"\nanalysis = \"solid\"\nelement_mm = 2\n\
             [fill]\npattern = \"stripes\"\ndensity = 1.0\n[output]\ngcode = \"bar.gcode\"\n\
             [[guide.fixture]]\non = {place}\nfix = \"xyz\"\n[[guide.load]]\non = {end}\nforce_n = [0, 0, -5]\n"
        )
    };
    let run = |place: &str, end: &str, shape: &str| {
        std::fs::write(dir.join("job.toml"), job(place, end, shape)).expect("a job");
        let seen = json(&grainpath(&dir, &["run", "job.toml", "--json"]));
        assert_eq!(seen["ok"].as_bool(), Some(true), "{seen}");
        seen["stress"].clone()
    };
    let face = |k: usize| format!("{{ face = {:?} }}", names[k]);
    let plane = |x: f64| format!("{{ plane = {{ point_mm = [{x}, 0, 0], normal = [1, 0, 0] }} }}");
    let by_plane = run(&plane(0.0), &plane(40.0), "");
    let by_face = run(&face(0), &face(1), "");
    assert_eq!(by_plane["loads"], by_face["loads"]);
    assert_eq!(by_plane["max_von_mises_mpa"], by_face["max_von_mises_mpa"]);
    // Set upright and twice as large: places and forces go with the part.
    let shape = "rotate_deg = [0, -90, 0]\nscale = 2.0";
    let (planes, faces) = (run(&plane(0.0), &plane(40.0), shape), run(&face(0), &face(1), shape));
    assert_eq!(planes["loads"], faces["loads"]);
    let load = &faces["loads"][0];
    // Elements round edges off a little.
    assert!((load["area_mm2"].as_f64().expect("an area") / 64.0 - 1.0).abs() < 0.06, "{faces}");
    let force: Vec<f64> = (0..3).map(|k| load["force_n"][k].as_f64().expect("a force")).collect();
    assert!((force[0] - 5.0).abs() < 1e-6 && force[1].abs() + force[2].abs() < 1e-6, "{faces}");
    // A turned box is the plain box that it encloses.
    let turned =
        "{ turned_box = { centre_mm = [40, 4, 1], size_mm = [8.1, 0.1, 2.1], rotate_deg = [0, 0, 90] } }";
    assert_eq!(run(&face(0), turned, "")["loads"], by_plane["loads"]);
}

/// Half of the top of a bar, cut across its two triangles: the area and its middle are those of the half, turned and scaled too.
#[test]
fn a_part_of_a_face_is_loaded_up_to_the_plane_that_cuts_it() {
    let dir = folder("faces-side");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let names = names(&json(&grainpath(&dir, &["inspect", "bar.stl", "--faces", "--json"])));
    let load = |side: &str, shape: &str, kind: &str| {
        let text = format!(
            "[shape]\nmesh = \"bar.stl\"\n{shape}\n[guide]\nkind = \"stress\"\nframe = \"part\"\nanalysis = \"solid\"\nelement_mm = 1\n\
             [[guide.fixture]]\non = {{ face = {:?} }}\nfix = \"xyz\"\n[[guide.load]]\non = {{ face = {:?}{side} }}\n{kind}\n",
            names[0], names[5]
        );
        std::fs::write(dir.join("job.toml"), text).expect("a job");
        let seen = json(&grainpath(&dir, &["run", "job.toml", "--check", "--json"]));
        assert_eq!(seen["ok"].as_bool(), Some(true), "{seen}");
        let load = seen["stress"]["loads"][0].clone();
        let number = |v: &Value| v.as_f64().expect("a number");
        (number(&load["area_mm2"]), [0, 1, 2].map(|k| number(&load["at_mm"][k])), load)
    };
    let (down, plain) = ("force_n = [0, 0, -5]", "");
    let (whole, ..) = load("", plain, down);
    let side = |x: f64, sign: i32| format!(", side = {{ point_mm = [{x}, 0, 0], normal = [{sign}, 0, 0] }}");
    let (far, at, seen) = load(&side(25.0, 1), plain, down);
    // Source: 15 of 40 mm; sides of elements of 1 mm are taken whole.
    assert!((far / 120.0 - 1.0).abs() < 0.05 && (at[0] - 32.5).abs() < 0.3, "{seen}");
    assert!((seen["force_n"][2].as_f64().expect("a force") + 5.0).abs() < 1e-9, "{seen}");
    let (near, ..) = load(&side(25.0, -1), plain, down);
    assert!((near + far - whole).abs() < 0.02 * whole, "{near} and {far} of {whole}");
    // Upright and twice as large, with a torque about the middle of the part.
    let upright = "rotate_deg = [0, -90, 0]\nscale = 2.0";
    let (large, _, seen) = load(&side(25.0, 1), upright, "torque_nmm = 100");
    assert!((large / 480.0 - 1.0).abs() < 0.05, "{seen}");
    // A plane beside the face leaves nothing, which is refused.
    let text =
        std::fs::read_to_string(dir.join("job.toml")).expect("a job").replace("[25, 0, 0]", "[50, 0, 0]");
    std::fs::write(dir.join("job.toml"), text).expect("a job");
    let refused = grainpath(&dir, &["run", "job.toml", "--check"]);
    let words = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(!refused.status.success() && words.contains("load 1"), "{words}");
}

#[test]
fn slice_plans_a_part_along_the_load_on_its_faces_as_the_job_does() {
    let dir = folder("faces-sliced");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let names = names(&json(&grainpath(&dir, &["inspect", "bar.stl", "--faces", "--json"])));
    let load = format!("{}=0,-20,0", names[1]);
    let told = json(&grainpath(&dir, &["slice", "bar.stl", "--hold", &names[0], "--load", &load, "--json"]));
    let number = |v: &Value| v.as_f64().expect("a number");
    assert!((number(&told["stress"]["loads"][0]["force_n"][1]) + 20.0).abs() < 1e-6, "{told}");
    assert!(number(&told["reserve"]["first_failure"][1]) > 0.0, "{told}");
    let job = format!(
        "[shape]\nmesh = \"bar.stl\"\n[fill]\npattern = \"stripes\"\ndensity = 1\n[guide]\nkind = \"stress\"\n\
         [[guide.fixture]]\non = {{ face = {:?} }}\nfix = \"xyz\"\n[[guide.load]]\non = {{ face = {:?} }}\n\
         force_n = [0, -20, 0]\n[output]\ngcode = \"job.gcode\"\n",
        names[0], names[1]
    );
    std::fs::write(dir.join("job.toml"), job).expect("a job");
    assert!(grainpath(&dir, &["run", "job.toml"]).status.success());
    // The header names files; moves are the same.
    let moves = |file: &str| {
        let text = std::fs::read_to_string(dir.join(file)).expect("a program");
        text.lines().filter(|line| !line.starts_with(';')).map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(moves("bar.gcode").len() > 500 && moves("bar.gcode") == moves("job.gcode"));
    // Half of a load, a force of two numbers, a force that does nothing, a face that is not there.
    let [on_held, no_force] = [format!("{}=0,-20,0", names[0]), format!("{}=0,0,0", names[1])];
    for (options, words) in [
        (vec!["--hold", names[0].as_str()], "--load"),
        (vec!["--hold", &names[0], "--load", "f:12=1,2"], "--load f:12=0,0,-50"),
        (vec!["--hold", &names[0], "--load", &on_held], "this face is held"),
        (vec!["--hold", &names[0], "--load", &no_force], "a force of 0 N"),
        (vec!["--hold", "f:ffffff", "--load", &load], "f:ffffff"),
        (vec!["--hold", "left", "--load", &load], "--hold left: a face has a name such as f:9c1e"),
    ] {
        let refused =
            grainpath(&dir, &[&["slice", "bar.stl", "-o", "none.gcode"], options.as_slice()].concat());
        let told = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(!refused.status.success() && told.contains(words), "{told}");
        assert!(!dir.join("none.gcode").exists());
    }
}

#[test]
fn a_case_without_stress_is_told() {
    let dir = folder("faces-no-stress");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let names = names(&json(&grainpath(&dir, &["inspect", "bar.stl", "--faces", "--json"])));
    for analysis in ["plane", "solid"] {
        let warned = |on: &str, force: &str| {
            let job = format!(
                "[shape]\nmesh = \"bar.stl\"\n[guide]\nkind = \"stress\"\nanalysis = \"{analysis}\"\n\
                 [[guide.fixture]]\non = {{ face = {:?} }}\nfix = \"xyz\"\n\
                 [[guide.load]]\non = {{ face = {on:?} }}\nforce_n = [{force}]\n",
                names[0]
            );
            std::fs::write(dir.join("job.toml"), job).expect("a job");
            let told = json(&grainpath(&dir, &["run", "job.toml", "--json"]));
            let warnings = told["warnings"].as_array().expect("warnings").clone();
            let is_told = warnings.iter().any(|w| w["id"] == "stress-none");
            assert!(!is_told || told["stress"]["reserve"].is_null(), "{told}");
            is_told
        };
        // No force, one on the face that is held, and one that pulls.
        assert!(warned(&names[1], "0,0,0") && warned(&names[0], "0,-20,0"), "{analysis}");
        assert!(!warned(&names[1], "1e-3,0,0"), "{analysis}");
    }
}

#[test]
fn a_box_that_ends_on_the_faces_of_a_part_catches_them_however_it_is_turned() {
    let dir = folder("faces-turned-box");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    for (analysis, tolerance) in [("plane", 0.01), ("solid", 0.1)] {
        let mut unturned = None;
        for turn_deg in [0.0, 15.0, 37.0, 45.0, 90.0] {
            let job = format!(
                "[shape]\nmesh = \"bar.stl\"\nrotate_deg = [0, 0, {turn_deg}]\n\
                 [guide]\nkind = \"stress\"\nframe = \"part\"\nanalysis = \"{analysis}\"\nelement_mm = 1\n\
                 [[guide.fixture]]\non = {{ box_mm = [[0, 0, 0], [10, 8, 2]] }}\nfix = \"xyz\"\n\
                 [[guide.load]]\non = {{ box_mm = [[30, 0, 0], [40, 8, 2]] }}\nforce_n = [50, 0, 0]\n"
            );
            std::fs::write(dir.join("job.toml"), job).expect("a job");
            let seen = json(&grainpath(&dir, &["run", "job.toml", "--check", "--json"]));
            assert_eq!(seen["ok"].as_bool(), Some(true), "{analysis}, {turn_deg}: {seen}");
            let number = |v: &Value| v.as_f64().expect("a number");
            let found = [
                number(&seen["stress"]["loads"][0]["area_mm2"]),
                number(&seen["stress"]["max_displacement_mm"]),
            ];
            let elements = number(&seen["stress"]["elements"]);
            let (first, of_first) = *unturned.get_or_insert((found, elements));
            assert!(
                analysis == "solid" || elements == of_first,
                "{turn_deg}: {elements}, {of_first} triangles"
            );
            for (value, wanted) in found.iter().zip(first) {
                assert!(
                    (value / wanted - 1.0).abs() < tolerance,
                    "{analysis}, {turn_deg}: {found:?}, {first:?}"
                );
            }
        }
    }
}

/// Where the triangles of the stress, the nodes of its directions or those of the phase do not turn with a part, its lines are
/// others: the first failure of this bar then moved by a half with seed lines, and by 3 % with stripes.
#[test]
fn lines_along_the_stress_turn_with_the_part() {
    for (pattern, tolerance) in [("seed-lines", 0.03), ("stripes", 0.015)] {
        turned_alike(pattern, tolerance);
    }
}

fn turned_alike(pattern: &str, tolerance: f64) {
    let dir = folder(&format!("faces-{pattern}"));
    std::fs::write(dir.join("bar.stl"), box_stl([60.0, 12.0, 2.0])).expect("a mesh");
    let found = [0.0, 15.0, 37.0, 90.0].map(|turn_deg| {
        let job = format!(
            "[shape]\nmesh = \"bar.stl\"\nrotate_deg = [0, 0, {turn_deg}]\n[fill]\npattern = \"{pattern}\"\n\
             [process]\nlayer_height_mm = 0.4\nwalls = 1\n\
             [guide]\nkind = \"stress\"\nframe = \"part\"\nfollow = \"tension\"\n\
             [[guide.fixture]]\non = {{ box_mm = [[0, 0, 0], [2, 0, 2]] }}\nfix = \"xyz\"\n\
             [[guide.fixture]]\non = {{ box_mm = [[58, 0, 0], [60, 0, 2]] }}\nfix = \"yz\"\n\
             [[guide.load]]\non = {{ box_mm = [[28, 12, 0], [32, 12, 2]] }}\nforce_n = [0, -50, 0]\n\
             [output]\ngcode = \"bar.gcode\"\n"
        );
        std::fs::write(dir.join("job.toml"), job).expect("a job");
        let seen = json(&grainpath(&dir, &["run", "job.toml", "--json"]));
        let number = |v: &Value| v.as_f64().unwrap_or_else(|| panic!("{turn_deg}: {seen}"));
        [number(&seen["quality"]["gap"]), number(&seen["reserve"]["first_failure"][1])]
    });
    println!("{pattern}: {found:?}");
    for [gap, reserve] in &found {
        assert!((gap - found[0][0]).abs() < 0.003, "{found:?}");
        assert!((reserve / found[0][1] - 1.0).abs() < tolerance, "{pattern}: {found:?}");
    }
}

/// A bar on two supports, one of which lets it slide along itself: a plate turned on the bed, and a solid turned any way.
#[test]
fn fixtures_of_single_directions_turn_with_the_part() {
    let dir = folder("faces-sliding");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let run = |words: &str, analysis: &str, turn: &str| {
        let job = format!(
            "[shape]\nmesh = \"bar.stl\"\nrotate_deg = {turn}\n[process]\nlayer_height_mm = 0.4\n\
             [guide]\nkind = \"stress\"\nframe = \"part\"\nanalysis = \"{analysis}\"\nelement_mm = 1\n\
             [[guide.fixture]]\non = {{ box_mm = [[0, 0, 0], [2, 0, 2]] }}\nfix = \"xyz\"\n\
             [[guide.fixture]]\non = {{ box_mm = [[38, 0, 0], [40, 0, 2]] }}\nfix = \"yz\"\n\
             [[guide.load]]\non = {{ box_mm = [[18, 8, 0], [22, 8, 2]] }}\nforce_n = [0, -50, 0]\n\
             [strength]\ncorners = false\n"
        );
        std::fs::write(dir.join("job.toml"), job).expect("a job");
        let words: Vec<&str> = words.split(' ').chain(["job.toml", "--json"]).collect();
        json(&grainpath(&dir, &words))
    };
    for (analysis, turns, tolerance) in [
        ("plane", ["[0, 0, 0]", "[0, 0, 37]", "[0, 0, 90]"], 0.02),
        ("solid", ["[0, 0, 0]", "[0, 0, 37]", "[90, 20, 0]"], 0.1),
    ] {
        let bent = turns.map(|turn| {
            let seen = run("run --check", analysis, turn);
            seen["stress"]["max_displacement_mm"].as_f64().unwrap_or_else(|| panic!("{turn}: {seen}"))
        });
        println!("{analysis}: {bent:?}");
        assert!(bent.iter().all(|mm| (mm / bent[0] - 1.0).abs() < tolerance), "{analysis}: {bent:?}");
        assert!(bent[0] > 0.01, "{analysis}: {bent:?}");
    }
    // The same supports in the virtual test, on the bed.
    let peaks = ["[0, 0, 0]", "[0, 0, 37]"].map(|turn| {
        let told = run("strength", "plane", turn);
        told["strength"]["peak_load_n"].as_f64().unwrap_or_else(|| panic!("{turn}: {told}"))
    });
    assert!((peaks[1] / peaks[0] - 1.0).abs() < 0.05, "{peaks:?}");
}

/// The list and the errors tell a face at the same place, wherever the file lies and however the job turns it.
#[test]
fn errors_tell_the_places_that_the_list_tells() {
    let dir = folder("faces-places");
    // The file lies 10 mm above z = 0, on which a job's part stands.
    let mesh = box_stl([40.0, 8.0, 2.0]);
    let raised = mesh.lines().map(|line| match line.trim().strip_prefix("vertex ") {
        Some(at) => {
            let [x, y, z] = [0, 1, 2].map(|k| at.split_whitespace().nth(k).expect("three numbers"));
            format!("vertex {x} {y} {}", z.parse::<f64>().expect("a number") + 10.0)
        }
        None => line.to_owned(),
    });
    std::fs::write(dir.join("bar.stl"), raised.collect::<Vec<_>>().join("\n")).expect("a mesh");
    let listed = grainpath(&dir, &["inspect", "bar.stl", "--faces"]);
    let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
    assert!(
        listed.contains("in the coordinates of the file") && listed.contains("z = 0, which is z 10 here")
    );
    let rows = json(&grainpath(&dir, &["inspect", "bar.stl", "--faces", "--json"]));
    let places: Vec<String> = (rows["faces"].as_array().expect("faces").iter())
        .map(|row| {
            let at = [0, 1, 2].map(|k| row["centre_mm"][k].as_f64().expect("a number"));
            format!("{:.1} mm2 at {:.2}, {:.2}, {:.2} in the file", row["area_mm2"], at[0], at[1], at[2])
        })
        .collect();
    for set in ["shape.scale=1", "shape.scale=2", "shape.rotate_deg=[90, 0, 0]"] {
        let words = ["slice", "bar.stl", "--hold", "f:ffffff", "--load", "f:0000=1,0,0", "--set", set];
        let refused = grainpath(&dir, &words);
        let told = String::from_utf8_lossy(&refused.stderr).into_owned();
        let n = places.iter().filter(|place| told.contains(*place)).count();
        assert!(refused.status.code() == Some(2) && n == 3, "{set}: {told} {places:?}");
    }
}

/// A drawing has the faces of the part that it becomes.
#[test]
fn faces_of_a_drawing_are_listed_with_its_thickness() {
    let dir = folder("faces-drawing");
    let drawing = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40mm\" height=\"8mm\" viewBox=\"0 0 40 8\">\
                   <rect width=\"40\" height=\"8\"/></svg>";
    std::fs::write(dir.join("bar.svg"), drawing).expect("a drawing");
    let thick = ["--set", "shape.thickness_mm=2"];
    let listed = json(&grainpath(&dir, &[&["inspect", "bar.svg", "--faces", "--json"][..], &thick].concat()));
    let names = names(&listed);
    let load = format!("{}=0,-20,0", names[1]);
    let words = ["slice", "bar.svg", "--hold", &names[0], "--load", &load, "--json"];
    let told = json(&grainpath(&dir, &[&words[..], &thick].concat()));
    assert!(told["reserve"]["first_failure"][1].as_f64() > Some(0.0), "{told}");
    for (words, says) in [
        (vec!["inspect", "bar.svg", "--faces"], "add --set shape.thickness_mm=N"),
        (
            [&["slice", "bar.svg", "--hold", "left", "--load", &load][..], &thick].concat(),
            "`grainpath inspect bar.svg --faces --set shape.thickness_mm=2` lists them",
        ),
    ] {
        let refused = grainpath(&dir, &words);
        let told = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(2) && told.contains(says), "{told}");
    }
}

#[test]
fn names_that_mean_nothing_are_refused() {
    let dir = folder("faces-refused");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let run = |face: &str, fix: &str| {
        let job = format!(
            "[shape]\nmesh = \"bar.stl\"\n[guide]\nkind = \"stress\"\nframe = \"part\"\n\
             [[guide.fixture]]\non = {{ face = {face:?} }}\nfix = {fix:?}\n\
             [[guide.load]]\non = {{ face = {face:?} }}\nforce_n = [1, 0, 0]\n"
        );
        std::fs::write(dir.join("job.toml"), job).expect("a job");
        let output = grainpath(&dir, &["run", "job.toml"]);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, told) = run("f:0000000", "xyz");
    assert!(
        code == Some(2) && told.contains("fixture 1: f:0000000 is no face") && told.contains("mm2 at"),
        "{told}"
    );
    let (code, told) = run("top", "xyz");
    assert!(
        code == Some(2) && told.contains("guide.fixture[1].on.face") && told.contains("--faces"),
        "{told}"
    );
}

#[test]
fn a_check_tells_what_the_loads_caught_and_writes_no_program() {
    let dir = folder("faces-check");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let job = |end: &str| {
        format!(
            "[shape]\nmesh = \"bar.stl\"\n[guide]\nanalysis = \"solid\"\nelement_mm = 2\n\
             [output]\ngcode = \"bar.gcode\"\npreview = \"pictures\"\nstress = \"bar.vtu\"\n\
             [[guide.fixture]]\non = {{ plane = {{ point_mm = [0, 0, 0], normal = [1, 0, 0] }} }}\nfix = \"xyz\"\n\
             [[guide.load]]\non = {end}\nforce_n = [3, 0, -4]\n\
             [[guide.load]]\non = {end}\nmoment_nmm = [0, 0, 7]\n"
        )
    };
    std::fs::write(dir.join("job.toml"), job("{ plane = { point_mm = [40, 0, 0], normal = [1, 0, 0] } }"))
        .expect("a job");
    let seen = json(&grainpath(&dir, &["run", "job.toml", "--check", "--json"]));
    let stress = &seen["stress"];
    let vector = |v: &Value| [0, 1, 2].map(|k| v[k].as_f64().expect("a number"));
    let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-6);
    let (load, moment, held) = (&stress["loads"][0], &stress["loads"][1], &stress["reactions"][0]);
    // Elements round edges off a little.
    assert!((load["area_mm2"].as_f64().expect("an area") / 16.0 - 1.0).abs() < 0.06, "{stress}");
    assert!(near(vector(&load["force_n"]), [3.0, 0.0, -4.0]), "{stress}");
    let at = vector(&load["at_mm"]);
    assert!((0..3).all(|k| (at[k] - [40.0, 4.0, 1.0][k]).abs() < 0.1), "{stress}");
    assert!(
        near(vector(&moment["force_n"]), [0.0; 3]) && near(vector(&moment["moment_nmm"]), [0.0, 0.0, 7.0])
    );
    let reaction = vector(&held["force_n"]);
    assert!((0..3).all(|k| (reaction[k] + [3.0, 0.0, -4.0][k]).abs() < 1e-3), "{stress}");
    assert!(stress["imbalance"].as_f64().expect("a balance") < 1e-5, "{stress}");
    assert!(!dir.join("bar.gcode").exists());
    assert_eq!(&std::fs::read(dir.join("pictures/loads.png")).expect("arrows")[1..4], b"PNG");
    let arrays = json(&grainpath(&dir, &["inspect", "bar.vtu", "--json"]))["arrays"].to_string();
    assert!(["fixture_1", "load_1", "load_2"].iter().all(|set| arrays.contains(set)), "{arrays}");
    let told = grainpath(&dir, &["run", "job.toml", "--check"]);
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(
        told.contains("load: load 1: force (3.000, 0.000, -4.000) N") && told.contains("balance: "),
        "{told}"
    );
    // A place beside the part stops the check as it stops a run.
    std::fs::write(dir.join("job.toml"), job("{ plane = { point_mm = [41, 0, 0], normal = [1, 0, 0] } }"))
        .expect("a job");
    let refused = grainpath(&dir, &["run", "job.toml", "--check"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(String::from_utf8_lossy(&refused.stderr).contains("load 1"));
}

/// A plate has its degenerate points once and not layer by layer, and a check plans no layers.
#[test]
fn a_check_of_a_plate_tells_its_peak_and_its_balance() {
    let dir = folder("faces-check-plate");
    std::fs::write(dir.join("bar.stl"), box_stl([40.0, 8.0, 2.0])).expect("a mesh");
    let at = |x: f64| format!("{{ plane = {{ point_mm = [{x}, 0, 0], normal = [1, 0, 0] }} }}");
    let job = format!(
        "[shape]\nmesh = \"bar.stl\"\n[guide]\nanalysis = \"plane\"\n[[guide.fixture]]\non = {}\nfix = \"xyz\"\n\
         [[guide.load]]\non = {}\nforce_n = [160, 0, 0]\n",
        at(0.0),
        at(40.0)
    );
    std::fs::write(dir.join("job.toml"), job).expect("a job");
    let stress = json(&grainpath(&dir, &["run", "job.toml", "--check", "--json"]))["stress"].clone();
    // 160 N on 8 x 2 mm are 10 MPa, more in the corners that are held.
    let peak = stress["max_von_mises_mpa"].as_f64().expect("a peak");
    assert!(peak > 9.9 && peak < 25.0, "{stress}");
    let held = stress["reactions"][0]["force_n"][0].as_f64().expect("a force");
    assert!((held + 160.0).abs() < 1e-3, "{stress}");
}
