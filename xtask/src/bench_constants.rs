//! The effect of each constant that was chosen by measurement.
//!
//! Each `Tuned` number of the sources has a row here: five values or more, among them its own, and the
//! pieces that it acts on. A row may also name a setting (`fill.cell_aspect`), whose default is swept.
//! The bench builds the program with the feature `sweep`, runs the pieces with each value and prints one
//! line for each value. Tests compare the rows with the sources and with `docs/constants.md`, so that
//! each tuned number has a row and each row a table.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

/// A piece to run: the preset that makes its folder, the job in it, and settings that differ from the job's.
/// Among these, names with capitals are other tuned constants.
type Piece = (&'static str, &'static str, &'static [&'static str]);

/// A constant: its name, the values to try, the pieces that it acts on, and what is measured of them.
struct Row {
    name: &'static str,
    values: &'static [f64],
    pieces: &'static [Piece],
    measure: Measure,
}

/// What a table says about the pieces.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Measure {
    /// The quality of a fill.
    Fill,
    /// The result of the strength test.
    Strength,
    /// Ends that stand on each other from layer to layer, and the quality of the fill.
    Ends,
    /// The support of a specimen; `Piece` names the specimen and not a preset.
    Support,
}

const NO_FIBRE: &str = "fibre.enabled=false";
const NOZZLE: &str = "printer.profile=generic-0.4";

/// One path a layer along the stress: a bar in tension, a plate with a hole, and a hook.
const CONTINUOUS: &[Piece] = &[
    ("stress-lines", "tension", &["fill.pattern=continuous"]),
    ("continuous", "plate", &[NO_FIBRE, NOZZLE]),
    ("continuous", "hook", &[NO_FIBRE, NOZZLE]),
];

/// Few squares for the phase, as in a region of half a square metre: the bound on their size decides.
const FEW_NODES: &[Piece] = &[
    ("stress-lines", "tension", &["fill.pattern=continuous", "fill.continuous.strips.MANY_NODES=50"]),
    ("continuous", "plate", &[NO_FIBRE, NOZZLE, "fill.continuous.strips.MANY_NODES=50"]),
    ("continuous", "hook", &[NO_FIBRE, NOZZLE, "fill.continuous.strips.MANY_NODES=50"]),
];

/// Few places for joints, as in a large region.
const FEW_PLACES: &[Piece] = &[
    ("stress-lines", "tension", &["fill.pattern=continuous", "fill.continuous.cells.MANY_PLACES=50"]),
    ("continuous", "plate", &[NO_FIBRE, NOZZLE, "fill.continuous.cells.MANY_PLACES=50"]),
    ("continuous", "hook", &[NO_FIBRE, NOZZLE, "fill.continuous.cells.MANY_PLACES=50"]),
];

/// A ring two beads wide, teeth of one to seven beads, and a tapering star; all without walls.
const THIN_PARTS: &[Piece] = &[(OUTLINES, "ring", &[]), (OUTLINES, "teeth", &[]), (OUTLINES, "star", &[])];

/// Two discs that a bar of 1.3 beads joins, with beads at several angles: rings that nowhere run side by side.
const NECKS: &[Piece] = &[
    (OUTLINES, "neck", &["guide.angle_deg=0"]),
    (OUTLINES, "neck", &["guide.angle_deg=17.2"]),
    (OUTLINES, "neck", &["guide.angle_deg=40"]),
    (OUTLINES, "neck", &["guide.angle_deg=70"]),
    (OUTLINES, "neck", &["guide.angle_deg=110"]),
    (OUTLINES, "neck", &["guide.angle_deg=150"]),
];

/// The folder of drawings that the bench makes itself.
const OUTLINES: &str = "outlines";

/// Drawings in `OUTLINES`: name, width and height, mm, and the path.
#[allow(clippy::disallowed_methods, reason = "drawn with four digits, for a bench alone")]
fn drawings() -> [(&'static str, [f64; 2], String); 4] {
    let line = |points: &[[f64; 2]]| {
        let all: Vec<String> = points.iter().map(|[x, y]| format!("{x:.4} {y:.4}")).collect();
        format!("M{} Z ", all.join(" L"))
    };
    let around = |n: usize, radius: &dyn Fn(usize) -> f64, middle: f64| -> Vec<[f64; 2]> {
        let angle = |i: usize| std::f64::consts::TAU * i as f64 / n as f64;
        (0..n).map(|i| [middle + radius(i) * angle(i).cos(), middle + radius(i) * angle(i).sin()]).collect()
    };
    let ring = line(&around(128, &|_| 12.0, 12.0)) + &line(&around(128, &|_| 11.1, 12.0));
    let mut teeth = vec![[0.0, 16.0], [0.0, 12.0]];
    for (i, width) in [0.6, 0.8, 1.0, 1.2, 1.5, 1.8, 2.2, 2.6, 3.2].into_iter().enumerate() {
        let left = 1.0 + 4.0 * i as f64;
        teeth.extend([[left, 12.0], [left, 0.0], [left + width, 0.0], [left + width, 12.0]]);
    }
    teeth.extend([[40.0, 12.0], [40.0, 16.0]]);
    let star = around(16, &|i| if i % 2 == 0 { 14.0 } else { 5.0 }, 14.0);
    let disc = |middle_x: f64, first_rad: f64| {
        let half_neck_rad = (0.3 / 5.0_f64).asin();
        let step_rad = (std::f64::consts::TAU - 2.0 * half_neck_rad) / 60.0;
        (0..=60).map(move |i| {
            let angle = first_rad + half_neck_rad + step_rad * f64::from(i);
            [middle_x + 5.0 * angle.cos(), 5.0 + 5.0 * angle.sin()]
        })
    };
    let neck: Vec<[f64; 2]> = disc(5.0, 0.0).chain(disc(21.0, std::f64::consts::PI)).collect();
    [
        ("ring", [24.0; 2], ring),
        ("teeth", [40.0, 16.0], line(&teeth)),
        ("star", [28.0; 2], line(&star)),
        ("neck", [26.0, 10.0], line(&neck)),
    ]
}

/// Writes the drawings, each with a job of three layers that lays one path along 20 degrees.
fn write_outlines(folder: &Path) -> Result<(), String> {
    let folder = folder.join(OUTLINES);
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, [w, h], path) in drawings() {
        let drawing = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" \
             viewBox=\"0 0 {w} {h}\"><path fill-rule=\"evenodd\" d=\"{path}\"/></svg>"
        );
        let job = format!(
            "[shape]\noutline = \"{name}.svg\"\nthickness_mm = 0.6\n[process]\nwalls = 0\n[fill]\n\
             pattern = \"continuous\"\ndensity = 1.0\n[guide]\nkind = \"angle\"\nangle_deg = 20\n"
        );
        for (text, ending) in [(drawing, "svg"), (job, "toml")] {
            let at = folder.join(name).with_extension(ending);
            fs::write(&at, text).map_err(|e| format!("{}: {e}", at.display()))?;
        }
    }
    Ok(())
}

/// Dense beads along the stress in the same parts.
const STRIPES: &[Piece] = &[
    ("stress-lines", "tension", &["fill.pattern=stripes"]),
    ("continuous", "plate-stripes", &[NO_FIBRE, NOZZLE]),
    ("continuous", "hook-stripes", &[NO_FIBRE, NOZZLE]),
];

/// The same with ends, all of them, in other places from layer to layer.
const SHIFTED: &[Piece] = &[
    ("stress-lines", "tension", &["fill.pattern=stripes", ALL_ENDS]),
    ("continuous", "plate-stripes", &[NO_FIBRE, NOZZLE, ALL_ENDS]),
    ("continuous", "hook-stripes", &[NO_FIBRE, NOZZLE, ALL_ENDS]),
];
const ALL_ENDS: &str = "fill.layer_shift=all";

const SEED_LINES: &[Piece] = &[
    ("stress-lines", "tension-seed-lines", &[]),
    ("stress-lines", "bending", &["fill.pattern=seed-lines"]),
    ("continuous", "hook-stripes", &[NO_FIBRE, NOZZLE, "fill.pattern=seed-lines"]),
];

const STREAMLINES: &[Piece] = &[
    ("stress-lines", "tension", &["fill.pattern=streamlines", "fill.density=0.4"]),
    ("stress-lines", "bending", &["fill.pattern=streamlines", "fill.density=0.4"]),
    ("continuous", "hook-stripes", &[NO_FIBRE, NOZZLE, "fill.pattern=streamlines", "fill.density=0.4"]),
];

/// The strength test takes a second or two with these: the nominal card, and cells of two beads.
const PLATES: &[Piece] = &[
    ("stress-lines", "tension", &[NOMINAL, UNCHECKED, "strength.cell_mm=0.9"]),
    ("stress-lines", "bending", &[NOMINAL, UNCHECKED, "strength.cell_mm=0.9"]),
    ("stress-lines", "tension-90", &[NOMINAL, UNCHECKED, "strength.cell_mm=0.9"]),
];

/// Plates, and the bar in tension as a solid.
const PLATES_AND_SOLID: &[Piece] = &[
    PLATES[0],
    PLATES[1],
    PLATES[2],
    ("stress-lines", "tension", &[NOMINAL, UNCHECKED, "strength.cell_mm=1.33", "strength.fidelity=voxels"]),
];

/// Walls of one bead around open cells, which bend.
const THIN_WALLS: &[Piece] = &[
    ("stress-lines", "tension-0", &[NOMINAL, UNCHECKED, "strength.cell_mm=0.9", "fill.density=0.3", GRID]),
    ("stress-lines", "bending-0", &[NOMINAL, UNCHECKED, "strength.cell_mm=0.9", "fill.density=0.3", GRID]),
    ("stress-lines", "bending-0", &[NOMINAL, UNCHECKED, "strength.cell_mm=0.9", "fill.density=0.15", GRID]),
];

/// Trees below a ball far above the plate, and below a tray with many contacts.
const TREES: &[Piece] = &[("hanging-ball", "", &[]), ("dental-tray", "", &[])];
/// The same, and branches of a part that stand over its plate, so that supports pass close beside it.
const TREES_BESIDE: &[Piece] = &[TREES[0], TREES[1], ("critical-angle-short", "", &[])];
/// A ball far above the plate in thick layers: the first of them is a disc in mid-air that needs several contacts.
const MID_AIR: &[Piece] = &[("hanging-ball", "", &["process.layer_height_mm=0.4"])];
const TREES_BY_POISSON: &[Piece] =
    &[("hanging-ball", "", &["support.solid=poisson"]), ("dental-tray", "", &["support.solid=poisson"])];

const NOMINAL: &str = "strength.corners=false";
const UNCHECKED: &str = "strength.check=false";
const GRID: &str = "fill.pattern=grid";

const fn row(name: &'static str, values: &'static [f64], pieces: &'static [Piece]) -> Row {
    Row { name, values, pieces, measure: Measure::Fill }
}

const fn strength(name: &'static str, values: &'static [f64], pieces: &'static [Piece]) -> Row {
    Row { name, values, pieces, measure: Measure::Strength }
}

const fn ends(name: &'static str, values: &'static [f64]) -> Row {
    Row { name, values, pieces: SHIFTED, measure: Measure::Ends }
}

const fn support(name: &'static str, values: &'static [f64], pieces: &'static [Piece]) -> Row {
    Row { name, values, pieces, measure: Measure::Support }
}

const ROWS: &[Row] = &[
    row("fill.cell_aspect", &[1.0, 1.5, 2.5, 4.0, 6.0], CONTINUOUS),
    row("fill.continuous.MIN_WEIGHT", &[0.002, 0.01, 0.02, 0.05, 0.2], CONTINUOUS),
    row("fill.continuous.FIELD_SAMPLES", &[8.0, 16.0, 32.0, 64.0, 128.0], CONTINUOUS),
    // Cuts across strips, and places beside them, where cells may be joined.
    row("fill.continuous.cells.ACROSS_MIN", &[0.3, 0.45, 0.55, 0.7, 0.85], CONTINUOUS),
    row("fill.continuous.cells.ACROSS_MAX", &[1.15, 1.3, 1.5, 1.8, 2.2], CONTINUOUS),
    row("fill.continuous.cells.BESIDE_MIN", &[0.2, 0.35, 0.5, 0.65, 0.8], CONTINUOUS),
    row("fill.continuous.cells.BESIDE_MAX", &[1.2, 1.4, 1.7, 2.0, 2.5], CONTINUOUS),
    row("fill.continuous.cells.PLACE_MIN", &[0.25, 0.5, 1.0, 2.0, 4.0], CONTINUOUS),
    row("fill.continuous.cells.PLACE_MAX", &[1.0, 2.0, 4.0, 8.0, 16.0], FEW_PLACES),
    row("fill.continuous.cells.MANY_PLACES", &[500.0, 2000.0, 20_000.0, 60_000.0, 200_000.0], CONTINUOUS),
    row("fill.continuous.cells.MARK", &[0.1, 0.15, 0.25, 0.4, 0.5], CONTINUOUS),
    row("fill.continuous.cells.TAKEN_HALF", &[0.5, 0.55, 0.6, 0.75, 1.0], CONTINUOUS),
    row("fill.continuous.cells.CUT_APART", &[0.5, 0.65, 0.8, 0.9, 1.0], CONTINUOUS),
    row("fill.continuous.cells.CUT_STEP", &[0.1, 0.25, 0.5, 1.0, 2.0], CONTINUOUS),
    // Where beads lie between their neighbours, and how wide they are.
    row("fill.continuous.finish.ROUNDS", &[0.0, 1.0, 2.0, 3.0, 5.0], CONTINUOUS),
    row("fill.continuous.finish.CORNER", &[0.3, 0.5, 0.64, 0.8, 0.9], CONTINUOUS),
    row("fill.continuous.finish.FAR", &[1.6, 2.0, 2.6, 3.5, 5.0], CONTINUOUS),
    row("fill.continuous.finish.GAP", &[1.05, 1.15, 1.3, 1.5, 1.8], CONTINUOUS),
    row("fill.continuous.finish.GAP_WIDTH", &[0.75, 1.0, 1.5, 2.0, 3.0], CONTINUOUS),
    row("fill.continuous.finish.AT_CORNERS", &[1.0, 2.5, 5.0, 7.5, 10.0], CONTINUOUS),
    row("fill.continuous.finish.UNEVEN", &[0.02, 0.04, 0.08, 0.15, 0.3], CONTINUOUS),
    row("fill.continuous.finish.AROUND_UNEVEN", &[0.0, 1.0, 3.0, 6.0, 12.0], CONTINUOUS),
    row("fill.continuous.finish.MOST_MOVE", &[0.1, 0.15, 0.25, 0.35, 0.5], CONTINUOUS),
    row("fill.continuous.finish.STRAIGHT_MOVE", &[0.1, 0.15, 0.25, 0.35, 0.5], CONTINUOUS),
    row("fill.continuous.finish.SMOOTHING", &[0.0, 0.15, 0.35, 0.5, 0.75], CONTINUOUS),
    row("fill.continuous.finish.CLOSEST", &[0.003, 0.007, 0.015, 0.03, 0.1], CONTINUOUS),
    // Stretches that face each other, and the joints between them.
    row("fill.continuous.rings.CLOSE", &[1.02, 1.05, 1.1, 1.2, 1.4], CONTINUOUS),
    row("fill.continuous.rings.AGAINST", &[0.3, 0.5, 0.7, 0.85, 0.95], CONTINUOUS),
    row("fill.continuous.rings.ALONGSIDE", &[0.3, 0.45, 0.6, 0.75, 0.9], CONTINUOUS),
    row("fill.continuous.rings.STRAIGHT", &[0.5, 0.65, 0.8, 0.9, 0.97], CONTINUOUS),
    row("fill.continuous.rings.SHORT_TURN", &[0.0, 0.25, 0.5, 1.0, 1.5], NECKS),
    row("fill.continuous.rings.SHORT_HALF", &[0.25, 0.5, 1.0, 1.25, 1.5], CONTINUOUS),
    // Strips along the field.
    row("fill.continuous.strips.MESH_MIN", &[0.5, 0.75, 1.0, 1.5, 2.0], CONTINUOUS),
    row("fill.continuous.strips.MESH_MAX", &[1.5, 3.0, 6.0, 9.0, 12.0], FEW_NODES),
    row("fill.continuous.strips.MANY_NODES", &[2000.0, 6000.0, 20_000.0, 60_000.0, 200_000.0], CONTINUOUS),
    // Necks and teeth: parts without them have no thin places.
    row("fill.continuous.strips.THIN_BEADS", &[0.75, 1.0, 1.5, 2.0, 3.0], THIN_PARTS),
    row("fill.continuous.strips.THIN_GROWN", &[0.02, 0.05, 0.1, 0.2, 0.4], THIN_PARTS),
    row("fill.continuous.strips.THIN_CRUMB", &[0.0, 0.03, 0.1, 0.3, 1.0], THIN_PARTS),
    row("fill.continuous.strips.STEP_BEADS", &[0.4, 0.7, 1.0, 1.5, 2.0], CONTINUOUS),
    row("fill.continuous.strips.LONGEST_STEPS", &[1.0, 2.0, 3.0, 5.0, 8.0], CONTINUOUS),
    row("fill.continuous.strips.STRAIGHT_BEADS", &[0.001, 0.002, 0.005, 0.01, 0.03], CONTINUOUS),
    row("fill.continuous.strips.LEAST_WEIGHT", &[0.01, 0.03, 0.1, 0.3, 1.0], CONTINUOUS),
    row("fill.continuous.strips.DIFFUSION_ROUNDS", &[1.0, 2.0, 3.0, 5.0, 8.0], CONTINUOUS),
    row("fill.continuous.strips.DIFFUSION_SCALE", &[0.25, 0.5, 1.0, 2.0, 4.0], CONTINUOUS),
    row("fill.continuous.strips.PHASE_TOLERANCE", &[0.001, 0.003, 0.01, 0.03, 0.1], CONTINUOUS),
    row("fill.continuous.strips.DRIFT_TOLERANCE", &[0.00001, 0.0001, 0.001, 0.01, 0.1], CONTINUOUS),
    // The search for last joints; few pieces need it.
    row("fill.continuous.tree.REST_MAX", &[0.7, 0.85, 1.0, 1.1, 1.25], CONTINUOUS),
    row("fill.continuous.tree.REST_STEP", &[0.25, 0.5, 1.0, 2.0, 4.0], CONTINUOUS),
    row("fill.continuous.tree.SHORT_FAR", &[1.5, 2.0, 2.5, 3.0, 4.0], CONTINUOUS),
    // Beads along a border that lines meet across.
    ends("fill.field.band.SHORTEST", &[2.0, 4.0, 6.0, 10.0, 20.0]),
    // The phase of dense beads along a field.
    row("core.phase.MAX_DRIFT", &[1.05, 1.12, 1.22, 1.35, 1.5], STRIPES),
    row("core.phase.DRIFT_MM", &[3.0, 6.0, 12.0, 24.0, 48.0], STRIPES),
    row("core.phase.ACROSS", &[0.001, 0.005, 0.02, 0.08, 0.3], STRIPES),
    row("core.phase.LEAST_SUM", &[1.5, 2.0, 2.4, 2.7, 2.9], STRIPES),
    row("core.phase.STEPS", &[15.0, 30.0, 60.0, 120.0, 240.0], STRIPES),
    // From level lines to beads.
    row("fill.field.stripes.SHORTEST", &[1.0, 1.5, 2.0, 3.0, 5.0], STRIPES),
    row("fill.field.stripes.LONGEST_JOINT", &[1.2, 1.6, 2.0, 2.5, 3.0], STRIPES),
    row("fill.field.stripes.MESH", &[0.7, 0.85, 1.0, 1.2, 1.5, 2.0], STRIPES),
    row("fill.field.stripes.DIFFUSION_ROUNDS", &[1.0, 2.0, 3.0, 6.0, 10.0], STRIPES),
    row("fill.field.stripes.DIFFUSION_SCALE", &[0.25, 0.5, 1.0, 2.0, 4.0], STRIPES),
    row("fill.field.stripes.PHASE_TOLERANCE", &[0.001, 0.01, 0.03, 0.1, 0.3], STRIPES),
    row("fill.field.stripes.DRIFT_TOLERANCE", &[0.00001, 0.0001, 0.001, 0.01, 0.1], STRIPES),
    row("fill.field.stripes.LEVEL_SMOOTHING", &[0.0, 1.0, 3.0, 5.0, 8.0], STRIPES),
    row("fill.field.stripes.SHIFT_SMOOTHING", &[0.0, 2.0, 4.0, 6.0, 10.0], STRIPES),
    row("fill.field.stripes.MOST_MOVE", &[0.1, 0.2, 0.4, 0.6, 1.0], STRIPES),
    row("fill.field.stripes.NEAR_BORDER", &[0.6, 0.9, 1.2, 1.4, 1.6], STRIPES),
    row("fill.field.stripes.PARALLEL_COS", &[0.8, 0.86, 0.92, 0.95, 0.98], STRIPES),
    row("fill.field.stripes.PARALLEL_RISE", &[0.01, 0.04, 0.08, 0.16, 0.3], STRIPES),
    row("fill.field.stripes.BORDER_WEIGHT", &[0.1, 0.25, 0.5, 1.0, 2.0], STRIPES),
    row("fill.field.line_ends.ACROSS_SINE", &[0.35, 0.5, 0.6, 0.65, 0.8], STRIPES),
    // Lines at distances of their own.
    row("fill.field.seed_lines.SEED_SPACING", &[3.0, 5.0, 8.0, 12.0, 20.0], SEED_LINES),
    row("fill.field.seed_lines.SHORTEST", &[1.0, 1.5, 2.0, 3.0, 5.0], SEED_LINES),
    row("fill.field.seed_lines.KEPT_FREE", &[0.7, 0.75, 0.8, 0.9, 0.98], SEED_LINES),
    row("fill.field.seed_lines.WIDEST_PLACE", &[0.01, 0.03, 0.1, 0.3, 1.0], SEED_LINES),
    row("fill.field.streamlines.END_SHARE", &[0.3, 0.45, 0.55, 0.7, 0.85], STREAMLINES),
    row("fill.field.streamlines.SHORTEST_SHARE", &[0.5, 1.0, 1.5, 2.5, 4.0], STREAMLINES),
    row("fill.field.streamlines.SEPARATION", &[0.85, 0.9, 0.94, 0.97, 1.0], STREAMLINES),
    row("fill.field.streamlines.STEP_SHARE", &[0.1, 0.25, 0.5, 0.75, 1.0], STREAMLINES),
    row("fill.field.streamlines.STEP_MM", &[0.25, 0.5, 1.0, 2.0, 4.0], STREAMLINES),
    // Space beside beads of every dense fill.
    row("fill.field.widths.STEP_BEADS", &[0.4, 0.55, 0.75, 1.0, 1.5], STRIPES),
    row("fill.field.widths.FAR_BEADS", &[1.4, 1.6, 1.8, 2.0, 2.2], STRIPES),
    // Ends from layer to layer.
    ends("fill.shift.BAND_MM", &[0.4, 0.7, 1.0, 1.5, 2.0]),
    ends("fill.shift.GRID_SHARE", &[0.0, 0.01, 0.02, 0.03, 0.06]),
    // Room around the part, contacts and pieces in mid-air.
    support("support.clearance.CELL_MM", &[0.2, 0.3, 0.4, 0.6, 1.0], TREES_BESIDE),
    support("support.clearance.SLAB_MM", &[0.2, 0.3, 0.4, 0.8, 1.6], TREES),
    support("support.clearance.MAX_DEBT", &[10.0, 20.0, 40.0, 64.0, 100.0], TREES_BESIDE),
    support("support.cut.TOUCH_MM", &[0.0, 0.02, 0.05, 0.1, 0.2], TREES_BESIDE),
    support("support.overhang.THIN_SHARE", &[0.0, 0.2, 0.4, 0.6, 1.0], TREES),
    support("support.beads.DAB_MM", &[0.02, 0.05, 0.08, 0.15, 0.3], TREES_BESIDE),
    // Which overhangs need contacts.
    support("support.overhang.KEEL_COS", &[0.7, 0.8, 0.9, 0.95, 0.99], TREES_BESIDE),
    support("support.overhang.FEW_SAMPLES", &[10.0, 20.0, 40.0, 80.0, 160.0], TREES_BESIDE),
    support("support.overhang.REACH_SHARE", &[0.4, 0.45, 0.49, 0.55, 0.6], TREES_BESIDE),
    support("support.overhang.MID_AIR_APART", &[0.5, 0.7, 0.9, 1.0, 1.2], MID_AIR),
    support("support.overhang.MID_AIR_STEP", &[0.1, 0.25, 0.5, 0.75, 1.0], MID_AIR),
    support("support.SAMPLE_SHARE", &[0.02, 0.04, 0.06, 0.08, 0.1], TREES_BESIDE),
    // Surfaces of supports.
    support("support.poisson.MARGIN", &[2.0, 4.0, 6.0, 10.0, 16.0], TREES_BY_POISSON),
    support("support.poisson.SWEEPS", &[1.0, 2.0, 3.0, 5.0, 8.0], TREES_BY_POISSON),
    support("support.poisson.RESIDUAL", &[0.0002, 0.0006, 0.002, 0.006, 0.02], TREES_BY_POISSON),
    support("support.poisson.POINT_STEP", &[0.3, 0.5, 0.7, 1.0, 1.5], TREES_BY_POISSON),
    support("support.poisson.COARSEST_SWEEPS", &[5.0, 20.0, 40.0, 80.0, 160.0], TREES_BY_POISSON),
    // The surface by signed distance.
    support("support.solid.BLENDS", &[0.0, 1.0, 2.0, 3.0, 5.0], TREES),
    // Where branches meet.
    support("support.tree.FOOT_MM", &[0.0, 4.0, 8.0, 16.0, 32.0], TREES),
    support("support.tree.STUMP_MM", &[0.25, 0.5, 1.0, 2.0, 4.0], TREES_BESIDE),
    support("support.tree.TIP_LENGTHS", &[0.5, 0.75, 1.0, 1.5, 2.0], TREES_BESIDE),
    // The strength test.
    strength("fea.strength.CRACK_NORMAL_COS", &[0.2, 0.4, 0.6, 0.8, 0.95], PLATES_AND_SOLID),
    strength("fea.strength.laminate.WIGGLE", &[0.0, 0.05, 0.1, 0.2, 0.4], PLATES),
    strength("fea.strength.laminate.PASSES", &[0.0, 3.0, 6.0, 12.0, 24.0], PLATES),
    strength("fea.strength.laminate.OVERFULL", &[1.0, 1.0001, 1.0005, 1.005, 1.02], PLATES),
    strength("fea.strength.load_stepping.STEP_REFINEMENT", &[2.0, 3.0, 4.0, 6.0, 10.0], PLATES_AND_SOLID),
    strength("fea.strength.plate_system.LEAST", &[1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4], PLATES),
    strength(
        "fea.strength.wall_bending.MOST_LOADED",
        &[0.0001, 0.0003, 0.001, 0.003, 0.01, 0.03],
        THIN_WALLS,
    ),
];

const FILL_HEADER: &str = "| value | gap % | overlap % | angle deg | 95 % deg | paths | printing s | planning s |\n|---|---|---|---|---|---|---|---|\n";
const ENDS_HEADER: &str = "| value | stacked inside % | stacked at border % | gap % | overlap % | angle deg | paths | planning s |\n|---|---|---|---|---|---|---|---|\n";
const SUPPORT_HEADER: &str = "| value | mm3 | contacts | trees | steepest deg | farthest mm | unreached | triangles | support and write s |\n|---|---|---|---|---|---|---|---|---|\n";
const STRENGTH_HEADER: &str = "| value | peak N | first failure N | bending missed % | solutions | planning and test s |\n|---|---|---|---|---|---|\n";

/// Sweeps the constants whose names hold one of the words, or all; `--write` puts the tables into
/// `docs/constants.md`, each as soon as it is measured.
pub fn run(words: &[&str]) -> Result<(), String> {
    let write = words.contains(&"--write");
    let names: Vec<&str> = words.iter().copied().filter(|w| *w != "--write").collect();
    let rows: Vec<&Row> =
        ROWS.iter().filter(|r| names.is_empty() || names.iter().any(|n| r.name.contains(n))).collect();
    if rows.is_empty() {
        return Err(format!("no constant is named like {}", names.join(" or ")));
    }
    // A target folder of its own keeps the ordinary program as it is built. What is measured is quality, so
    // the profile that builds fastest will do.
    let target = crate::target().join("sweep");
    let mut build = Command::new("cargo");
    build
        .args(["build", "--profile", "ci", "-p", "grainpath-cli", "--features", "sweep", "--target-dir"])
        .arg(&target);
    crate::run(&mut build)?;
    let grainpath = target.join("ci/grainpath");
    let folder = crate::target().join("bench/constants");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    write_outlines(&folder)?;
    for preset in ["stress-lines", "continuous"] {
        let made = folder.join(preset);
        crate::output(Command::new(&grainpath).args(["new", "--force", preset]).arg(&made))?;
    }
    let commit = crate::output(Command::new("git").args(["rev-parse", "--short", "HEAD"]))?;
    let date = crate::output(Command::new("date").arg("+%Y-%m-%d"))?;
    let mut owns = BTreeMap::new();
    for row in rows {
        let table = sweep(&grainpath, &folder, row, &mut owns)?;
        println!("{table}");
        if write {
            let measured = format!("{table}\nMeasured {} on commit `{}`.\n", date.trim(), commit.trim());
            put(row.name, &measured)?;
        }
    }
    Ok(())
}

/// The heading of the list of constants without a table.
const NOT_MEASURED: &str = "## Not measured yet";

/// The page of all tables.
fn page_path() -> PathBuf {
    crate::root().join("docs/constants.md")
}

/// Writes the page anew with one table in place of an older one. What was noted below a table in a
/// paragraph that begins with "Note:" stays.
fn put(name: &str, table: &str) -> Result<(), String> {
    let old = fs::read_to_string(page_path()).unwrap_or_default();
    let mut tables = tables(&old);
    let note = tables.get(name).and_then(|old| old.split_once("\nNote: ")).map(|(_, note)| note.to_owned());
    let note = note.map_or_else(String::new, |note| format!("\nNote: {note}\n"));
    tables.insert(name.to_owned(), format!("{table}{note}"));
    let mut text = PAGE.to_owned();
    for row in ROWS {
        if let Some(table) = tables.get(row.name) {
            write!(text, "\n{}\n", table.trim_end()).expect("text");
        }
    }
    let left: Vec<&str> = ROWS.iter().map(|r| r.name).filter(|name| !tables.contains_key(*name)).collect();
    if !left.is_empty() {
        write!(text, "\n{NOT_MEASURED}\n\n- `{}`\n", left.join("`\n- `")).expect("text");
    }
    fs::write(page_path(), text).map_err(|e| format!("{}: {e}", page_path().display()))
}

/// The tables of a page by the names of their constants, headings included.
fn tables(page: &str) -> BTreeMap<String, String> {
    let parts = page.split("\n## ").skip(1);
    let named = |part: &str| {
        let name = part.lines().next().unwrap_or_default().to_owned();
        (name, format!("## {}\n", part.trim_end()))
    };
    parts.filter(|part| !NOT_MEASURED.ends_with(part.lines().next().unwrap_or_default())).map(named).collect()
}

const PAGE: &str = "# Constants chosen by measurement

Some constants of the fills, the supports and the strength test follow from no formula and stand in no paper. Each has
a table here: the same pieces run with five or more values of it. The value in the code is in bold. `cargo xtask bench
constants --write` makes this page, and `cargo xtask bench constants NAME` prints the tables of the constants whose name
holds that word. `xtask/src/bench_constants.rs` lists the pieces of each. Seconds were measured beside other work and tell
no more than the order of magnitude.

Fills: numbers are means over the pieces; paths and seconds are sums. A gap is the share of the area that should be
filled and is open; overlap is the share that is filled twice, negative where less was laid than there is room for. The
angle is between bead and stress, 0 where the part has no load, and 95 % of the length lies within the fifth column.

Ends from layer to layer: the shares of the ends inside the infill and at its border that stand on each other
([stacked](stress.md#fills)), with `fill.layer_shift = \"all\"`, beside the quality of the fill as above.

Strength: peak load and load of the first failure of each piece. *Bending missed* is the share by which the peak may be
too high because thin walls are too few cells across; *refused* where the test says that it cannot be done with these
cells. Solutions and seconds are sums.

Supports: volume, number of contacts and of trees, the largest lean of a branch from the vertical, the largest distance of
an overhang from its nearest contact, overhangs that no branch reaches, and triangles of the surface, each for every
specimen.
";

/// The table of one constant. `owns` keeps what the pieces gave with the values in the sources.
fn sweep(
    grainpath: &Path,
    folder: &Path,
    row: &Row,
    owns: &mut BTreeMap<(usize, usize), String>,
) -> Result<String, String> {
    let header = match row.measure {
        Measure::Fill => FILL_HEADER,
        Measure::Ends => ENDS_HEADER,
        Measure::Strength => STRENGTH_HEADER,
        Measure::Support => SUPPORT_HEADER,
    };
    let mut text = format!("## {}\n\n{header}", row.name);
    let own = value_in_sources(row.name, &tuned_in_sources()?)?;
    for &value in row.values {
        // With its own value a constant leaves the program as it is, so rows of the same pieces share the line.
        let kept = (row.pieces.as_ptr() as usize, row.measure as usize);
        if let Some(line) = owns.get(&kept).filter(|_| value == own) {
            writeln!(text, "| **{value}** | {line} |").expect("text");
            continue;
        }
        let start = Instant::now();
        let line = match row.measure {
            Measure::Fill => fill_line(grainpath, folder, row, value),
            Measure::Ends => ends_line(grainpath, folder, row, value),
            Measure::Strength => strength_line(grainpath, folder, row, value),
            Measure::Support => support_line(grainpath, folder, row, value),
        };
        let seconds = start.elapsed().as_secs_f64();
        let mark = if value == own { "**" } else { "" };
        match line {
            Ok(line) => {
                let line = format!("{line} | {seconds:.1}");
                writeln!(text, "| {mark}{value}{mark} | {line} |").expect("text");
                if value == own {
                    owns.insert(kept, line);
                }
            }
            // A value that fails is a result as well: the row says so, and the others go on.
            Err(problem) => {
                let line = problem.lines().last().unwrap_or_default();
                let empty = " |".repeat(header.lines().next().map_or(0, |l| l.matches('|').count() - 3));
                writeln!(text, "| {mark}{value}{mark} | fails: {line} |{empty}").expect("text");
            }
        }
    }
    Ok(text)
}

/// The report of one plan.
fn planned(grainpath: &Path, folder: &Path, row: &Row, piece: &Piece, value: f64) -> Result<Value, String> {
    let mut command = command(grainpath, "run", folder, piece, row.name, value);
    // Elements of 2 mm keep each plan short; all values see the same ones.
    command.args(["--set", "process.skirt_loops=0", "--set", "guide.element_mm=2"]);
    for quiet in ["output.report=", "output.preview=", "output.lines=", "output.stress="] {
        command.args(["--set", quiet]);
    }
    json(command.arg("--out").arg(folder.join("out")))
}

/// Shares of the ends inside and at the border that stand on each other, gap, overlap, mean angle and paths.
fn ends_line(grainpath: &Path, folder: &Path, row: &Row, value: f64) -> Result<String, String> {
    let mut sums = [0.0; 6];
    for piece in row.pieces {
        let report = planned(grainpath, folder, row, piece, value)?;
        let quality = &report["quality"];
        let share = |places: &Value| -> Result<f64, String> {
            Ok(number(&places["stacked"])? / number(&places["n"])?.max(1.0))
        };
        let found = [
            100.0 * share(&quality["stacked"]["inside"])?,
            100.0 * share(&quality["stacked"]["at_border"])?,
            100.0 * number(&quality["gap"])?,
            100.0 * number(&quality["overlap"])?,
            number(&quality["alignment_mean_deg"])?,
            number(&report["toolpaths"])?,
        ];
        sums.iter_mut().zip(found).for_each(|(sum, number)| *sum += number);
    }
    let [inside, at_border, gap, overlap, angle] = [0, 1, 2, 3, 4].map(|i| sums[i] / row.pieces.len() as f64);
    Ok(format!("{inside:.1} | {at_border:.1} | {gap:.2} | {overlap:.2} | {angle:.2} | {}", sums[5]))
}

/// Gap, overlap, mean angle, angle that 95 % of the length lie within, paths and printing time.
fn fill_line(grainpath: &Path, folder: &Path, row: &Row, value: f64) -> Result<String, String> {
    const NO_ANGLE: &Value = &Value::Null;
    let mut sums = [0.0; 6];
    for piece in row.pieces {
        let report = planned(grainpath, folder, row, piece, value)?;
        let quality = &report["quality"];
        let numbers = [
            &quality["gap"],
            &quality["overlap"],
            // Directions of the user's own have no stress to compare with.
            quality.get("alignment_mean_deg").unwrap_or(NO_ANGLE),
            quality.get("alignment_p95_deg").unwrap_or(NO_ANGLE),
            &report["toolpaths"],
            &report["time_s"],
        ];
        for (sum, found) in sums.iter_mut().zip(numbers) {
            *sum += if found.is_null() { 0.0 } else { number(found)? };
        }
    }
    let pieces = row.pieces.len() as f64;
    let [gap, overlap, mean, most] = [0, 1, 2, 3].map(|i| sums[i] / pieces);
    Ok(format!(
        "{:.2} | {:.2} | {mean:.2} | {most:.1} | {} | {:.0}",
        100.0 * gap,
        100.0 * overlap,
        sums[4],
        sums[5]
    ))
}

/// Peak load and first failure of each piece, bending that the cells miss, and solutions.
fn strength_line(grainpath: &Path, folder: &Path, row: &Row, value: f64) -> Result<String, String> {
    let (mut peaks, mut first, mut missed, mut solutions) = (Vec::new(), Vec::new(), Vec::new(), 0.0);
    for piece in row.pieces {
        let mut command = command(grainpath, "strength", folder, piece, row.name, value);
        command.args(["--set", "guide.element_mm=2"]);
        let report = match json(&mut command) {
            Ok(report) => report,
            Err(problem) if problem.contains("bend out of their plane") => {
                for column in [&mut peaks, &mut first, &mut missed] {
                    column.push("refused".to_owned());
                }
                continue;
            }
            Err(problem) => return Err(problem),
        };
        let found = &report["strength"];
        peaks.push(format!("{:.1}", number(&found["peak_load_n"])?));
        first.push(format!("{:.1}", number(&found["first_n"])?));
        solutions += number(&found["solutions"])?;
        let warnings = report["warnings"].as_array().into_iter().flatten();
        let thin = warnings.filter(|w| w["id"] == "strength-thin-walls").filter_map(|w| w["text"].as_str());
        let share = thin.filter_map(|text| text.split("up to ").nth(1)?.split(" %").next()).next();
        missed.push(share.unwrap_or("0").to_owned());
    }
    Ok(format!("{} | {} | {} | {solutions}", peaks.join(", "), first.join(", "), missed.join(", ")))
}

/// Volume, contacts, trees, lean and reach of each support, and the triangles of its surface.
fn support_line(grainpath: &Path, folder: &Path, row: &Row, value: f64) -> Result<String, String> {
    let mut columns: [Vec<String>; 7] = Default::default();
    for piece in row.pieces {
        let mesh = folder.join(piece.0).with_extension("stl");
        crate::output(Command::new(grainpath).args(["specimen", piece.0, "-o"]).arg(&mesh))?;
        let mut command = Command::new(grainpath);
        command.args(["support", "--json", "-o"]).arg(folder.join("support.stl")).arg(&mesh);
        for setting in piece.2 {
            command.args(["--set", setting]);
        }
        let report = json(command.env("GRAINPATH_SWEEP", format!("{}={value}", row.name)))?;
        let found = &report["support"];
        let unreached = found["unreached"].as_array().map_or(0, Vec::len);
        let numbers = [
            format!("{:.1}", number(&found["volume_mm3"])?),
            found["contacts"].to_string(),
            found["trees"].to_string(),
            format!("{:.2}", number(&found["steepest_deg"])?),
            format!("{:.2}", number(&found["farthest_mm"])?),
            unreached.to_string(),
            report["triangles"].to_string(),
        ];
        columns.iter_mut().zip(numbers).for_each(|(column, number)| column.push(number));
    }
    Ok(columns.map(|column| column.join(", ")).join(" | "))
}

/// A command of the program for a piece, with one value for the constant.
fn command(grainpath: &Path, verb: &str, folder: &Path, piece: &Piece, name: &str, value: f64) -> Command {
    let (preset, job, more) = *piece;
    let mut command = Command::new(grainpath);
    let path: PathBuf = folder.join(preset).join(job).with_extension("toml");
    command.args([verb, "--json"]).arg(path);
    // Names of settings are written small, those of constants are not.
    let own = format!("{name}={value}");
    let is_constant = |text: &&str| text.chars().any(|c| c.is_ascii_uppercase());
    let (constants, settings): (Vec<&str>, Vec<&str>) =
        more.iter().copied().chain([own.as_str()]).partition(is_constant);
    for setting in settings {
        command.args(["--set", setting]);
    }
    command.env("GRAINPATH_SWEEP", constants.join(","));
    command
}

/// What a command says in JSON.
fn json(command: &mut Command) -> Result<Value, String> {
    let text = crate::output(command)?;
    serde_json::from_str(&text).map_err(|e| format!("{command:?}: {e}"))
}

fn number(value: &Value) -> Result<f64, String> {
    value.as_f64().ok_or_else(|| format!("{value} should be a number"))
}

/// The value of a tuned number in the sources, of which `tuned` lists all, or the default of a setting.
fn value_in_sources(name: &str, tuned: &[(String, f64)]) -> Result<f64, String> {
    let found = tuned.iter().find(|(known, _)| known == name);
    let value = found.map(|(_, value)| *value).or_else(|| default_of(name));
    value.ok_or_else(|| format!("{name} is no tuned number of the sources and no setting with a number"))
}

/// The default of a setting, as its row has it: `cell_aspect: f64 = 2.5,`.
fn default_of(name: &str) -> Option<f64> {
    let key = name.split_once('.')?.1;
    let rows = fs::read_to_string(crate::root().join("crates/grainpath-job/src/settings.rs")).ok()?;
    let start = rows.lines().find_map(|line| line.trim().strip_prefix(&format!("{key}: f64 = ")))?;
    start.split(',').next()?.parse().ok()
}

/// Names and values of all tuned numbers, as `Tuned::new("name", value)` has them.
fn tuned_in_sources() -> Result<Vec<(String, f64)>, String> {
    let mut found = Vec::new();
    for source in crate::source::read(&crate::root())?.sources {
        // The module that defines the type shows an example.
        if source.path.ends_with("core/src/tuned.rs") {
            continue;
        }
        let text: String = source.text.join(" ");
        for rest in text.split("Tuned::new(").skip(1) {
            let inner = rest.split(')').next().unwrap_or_default();
            let (name, value) =
                inner.split_once(',').ok_or_else(|| format!("{}: Tuned::new({inner})", source.path))?;
            let value = value.trim().trim_end_matches(',').replace('_', "");
            let value = value.parse().map_err(|e| format!("{}: {value}: {e}", source.path))?;
            found.push((name.trim().trim_matches('"').to_owned(), value));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tuned_number_has_a_row_with_five_values_and_its_own() {
        let tuned = tuned_in_sources().expect("the sources can be read");
        assert!(!tuned.is_empty(), "no tuned number was found");
        for (name, value) in &tuned {
            let rows: Vec<&Row> = ROWS.iter().filter(|row| row.name == name).collect();
            assert_eq!(rows.len(), 1, "{name} needs one row in ROWS");
            assert!(rows[0].values.len() >= 5, "{name}: five values or more");
            assert!(rows[0].values.contains(value), "{name}: its own value {value} is missing in its row");
        }
        for row in ROWS {
            let known = tuned.iter().any(|(name, _)| name == row.name);
            assert!(known || default_of(row.name).is_some(), "{} is no tuned number", row.name);
        }
    }

    #[test]
    fn every_row_has_a_table_that_marks_the_value_in_the_sources_or_is_listed() {
        let page = fs::read_to_string(page_path()).expect("docs/constants.md");
        let tables = tables(&page);
        let listed = page.split_once(NOT_MEASURED).map_or("", |parts| parts.1);
        let tuned = tuned_in_sources().expect("sources");
        for row in ROWS {
            let Some(table) = tables.get(row.name) else {
                assert!(listed.contains(&format!("\n- `{}`", row.name)), "{} is not on the page", row.name);
                continue;
            };
            let own = value_in_sources(row.name, &tuned).expect("a value");
            assert!(table.contains(&format!("| **{own}** |")), "{}: its value is now {own}", row.name);
            for value in row.values {
                let line = [format!("\n| {value} |"), format!("\n| **{value}** |")];
                assert!(line.iter().any(|l| table.contains(l)), "{}: no line for {value}", row.name);
            }
        }
        for name in tables.keys() {
            assert!(ROWS.iter().any(|row| row.name == name), "{name} has a table and no row");
        }
    }
}
