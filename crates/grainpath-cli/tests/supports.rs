//! Supports from the command line.

mod support;

use support::{box_stl, folder, grainpath, json};

/// A leg with a top that projects beyond it.
fn write_table(at: &std::path::Path) {
    let out = grainpath(at, &["specimen", "dental-tray", "-o", "tray.stl"]);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}

#[test]
fn support_alone_is_a_closed_mesh_that_other_commands_read() {
    let at = folder("support_alone");
    write_table(&at);
    let report =
        json(&grainpath(&at, &["support", "tray.stl", "-o", "s.stl", "--preview", "steps", "--json"]));
    assert_eq!(report["ok"], true);
    assert_eq!(report["support"]["floating"], 0);
    assert!(report["support"]["contacts"].as_u64() > Some(10), "{report}");
    assert!(report["support"]["steepest_deg"].as_f64() <= Some(40.0));
    let found = json(&grainpath(&at, &["inspect", "s.stl", "--json"]));
    assert_eq!(found["closed"], true, "{found}");
    let printed = json(&grainpath(&at, &["slice", "s.stl", "--json"]));
    assert_eq!(printed["ok"], true);
    assert!(at.join("steps/overhangs.png").is_file() && at.join("steps/trees_front.png").is_file());
    let both = json(&grainpath(&at, &["support", "tray.stl", "-o", "both.3mf", "--with-model", "--json"]));
    assert_eq!(both["outputs"]["support"], "both.3mf");
    let found = json(&grainpath(&at, &["inspect", "both.3mf", "--json"]));
    assert_eq!((&found["bodies"], &found["closed"]), (&2.into(), &true.into()));
}

#[test]
fn a_job_prints_its_supports_the_same_on_any_number_of_threads() {
    let at = folder("support_job");
    write_table(&at);
    let job = "[shape]\nmesh = \"tray.stl\"\n[support]\nstyle = \"tree\"\ninterface_layers = 1\nlift_mm = 2\n\
               [output]\nreport = \"r.html\"\nsupport = \"s.stl\"\n";
    std::fs::write(at.join("job.toml"), job).expect("a job");
    let mut programs = Vec::new();
    for threads in ["1", "2", "8"] {
        let report = json(&grainpath(&at, &["run", "job.toml", "--threads", threads, "--json"]));
        let support = &report["support"];
        assert!(support["mass_g"].as_f64() > Some(0.2) && support["trees"].as_u64() > Some(2), "{report}");
        assert!(support["unreached"].as_array().is_some_and(Vec::is_empty), "{report}");
        assert!(report["stages_s"]["support"].as_f64() > Some(0.0));
        programs.push((
            std::fs::read(at.join("tray.gcode")).expect("G-code"),
            std::fs::read(at.join("s.stl")).expect("the support"),
        ));
    }
    assert!(programs.windows(2).all(|w| w[0] == w[1]));
    let text = String::from_utf8_lossy(&programs[0].0).into_owned();
    for kind in
        [";TYPE:Support material\n", ";TYPE:Support material interface\n", ";TYPE:External perimeter\n"]
    {
        assert!(text.contains(kind), "{kind}");
    }
    let page = std::fs::read_to_string(at.join("r.html")).expect("a report");
    assert!(page.contains("beyond the critical angle") && page.contains("trees, at contacts"));
}

#[test]
fn what_needs_none_gets_none_and_mistakes_are_told_in_a_line() {
    let at = folder("support_none");
    std::fs::write(at.join("box.stl"), box_stl([20.0, 20.0, 5.0])).expect("a mesh");
    let report = json(&grainpath(&at, &["slice", "box.stl", "--set", "support.style=tree", "--json"]));
    assert_eq!(report["support"]["contacts"], 0);
    let warning = &report["warnings"][0];
    assert_eq!(warning["id"], "support-none", "{report}");
    assert!(warning["text"].as_str().is_some_and(|w| w.contains("no overhang")), "{report}");
    assert!(warning["remedy"].as_str().is_some_and(|r| r.contains("critical_angle_deg")), "{report}");
    for (args, code, says) in [
        (vec!["support", "box.stl", "-o", "s.obj"], 2, ".stl or .3mf"),
        (vec!["support", "nothing.stl"], 3, "nothing.stl"),
        (vec!["support", "box.stl", "--set", "support.critical_angle_deg=120"], 2, "from 0 to 89"),
        (vec!["slice", "box.stl", "--set", "support.style=trees"], 2, "one of none, tree"),
        (
            vec!["slice", "box.stl", "--set", "support.style=tree", "--set", "output.support=s.gif"],
            2,
            ".stl or .3mf",
        ),
        (vec!["specimen", "critical-angel"], 2, "did you mean \"critical-angle\""),
    ] {
        let out = grainpath(&at, &args);
        let text = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(code), "{args:?}: {text}");
        assert!(text.contains(says) && text.trim().lines().count() == 1, "{args:?}: {text}");
    }
    let list = grainpath(&at, &["specimen"]);
    assert!(String::from_utf8_lossy(&list.stdout).contains("critical-angle"));
}

#[test]
fn trees_of_the_example_weigh_less_than_its_baselines() {
    let at = folder("support_example");
    assert!(grainpath(&at, &["new", "tree-support", "."]).status.success());
    let mass_g = |job: &str| {
        let report = json(&grainpath(&at, &["run", job, "--json"]));
        assert_eq!(report["support"]["floating"], 0, "{report}");
        report["support"]["mass_g"].as_f64().expect("a mass")
    };
    for piece in ["ball", "tray"] {
        let [trees, columns, boxes] =
            ["", "-columns", "-box"].map(|how| mass_g(&format!("{piece}{how}.toml")));
        assert!(trees < 0.6 * columns && columns < boxes, "{piece}: {trees} {columns} {boxes} g");
    }
}
