//! Example `tree-support`: the first two cases of the paper `Shen2016` on parts of our own. Each part has a job with trees
//! and two jobs with simpler supports to compare.

use super::{ExampleFile, stl};
use crate::specimen::{dental_tray, hanging_ball};

/// Files of the example; the first is the job to try first.
pub(super) fn files() -> Vec<ExampleFile> {
    let mut files: Vec<ExampleFile> = Vec::new();
    let pieces = [
        ("ball", "A ball that hangs 50 mm above the plate", hanging_ball()),
        ("tray", "A horseshoe tray that leans by 30 degrees", dental_tray()),
    ];
    for (name, what, mesh) in pieces {
        // The tree job has no suffix, since it is the one to try first. The other jobs print the same part
        // on simpler supports.
        let styles = [
            Style { word: "tree", suffix: "", how: "on branching trees", is_tree: true },
            Style {
                word: "columns",
                suffix: "-columns",
                how: "on straight walls, to compare",
                is_tree: false,
            },
            Style {
                word: "box",
                suffix: "-box",
                how: "on the box around every overhang, to compare",
                is_tree: false,
            },
        ];
        for style in &styles {
            files.push((
                format!("{name}{}.toml", style.suffix).into(),
                job(name, &format!("{what}, {}.", style.how), style).into_bytes(),
            ));
        }
        files.push((format!("{name}.stl").into(), stl(&mesh)));
    }
    files
}

/// A style of support: its word in a job, the suffix of the job's file name, and the words of the job's title.
struct Style {
    word: &'static str,
    suffix: &'static str,
    how: &'static str,
    is_tree: bool,
}

fn job(name: &str, what: &str, style: &Style) -> String {
    let file = format!("{name}{}", style.suffix);
    let word = style.word;
    let mut text = format!(
        "# {what}
#
#   grainpath run {file}.toml
#   grainpath run {file}.toml --set support.critical_angle_deg=50
#
# The report draws what overhangs, the contacts and the branches; support.mass_g there is the support's own.

format = 1

[shape]
mesh = \"{name}.stl\"

[printer]
profile = \"generic-0.4\"

[material]
profile = \"pla\"

[fill]
density = 0.15

[support]
style = \"{word}\"
critical_angle_deg = 40       # what leans further from the vertical is held; `grainpath specimen critical-angle` finds yours
max_unsupported_mm = 10       # the longest stretch that prints over air
"
    );
    // Only trees have branches and a support mesh of their own.
    if style.is_tree {
        text += "branch_angle_deg = 40         # branches lean no further\n";
    }
    text += &format!(
        "
[output]
gcode = \"out/{file}.gcode\"
report = \"out/{file}.html\"
preview = \"out/{file}\"
"
    );
    if style.is_tree {
        text += &format!("support = \"out/{file}-support.stl\"\n");
    }
    text
}
