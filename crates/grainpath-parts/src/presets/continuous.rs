//! Example `continuous`: a plate with an open hole, and a hook. Each has one job with a single fibre path a
//! layer, and three jobs with other fills.

use grainpath_core::math::direction;
use grainpath_core::poly::Join;
use grainpath_core::{DVec2, Polygon, Region, TriMesh};

use super::{ExampleFile, stl};
use crate::shapes::{arc, prism};

/// Open-hole plate: 120 x 36 x 2 mm with a hole of 10 mm.
pub(super) fn plate() -> TriMesh {
    let outline = [(0.0, -18.0), (120.0, -18.0), (120.0, 18.0), (0.0, 18.0)].map(DVec2::from);
    let mut mesh = TriMesh::default();
    prism(&outline, &[arc(DVec2::new(60.0, 0.0), 5.0, 0, 4, 16)], 0.0, 2.0, &mut mesh);
    mesh
}

/// A hook, 4 mm thick and 107 mm tall: an eye of 14 mm diameter above, a bowl of 24 mm diameter below.
pub(super) fn hook() -> TriMesh {
    let disc = |x: f64, y: f64, r: f64| {
        Region::from(Polygon { outer: arc(DVec2::new(x, y), r, 0, 4, 24), holes: Vec::new() })
    };
    let bowl = DVec2::new(0.0, -20.0);
    // The mouth of the hook is a wedge cut out of the ring on its right. It starts at the bowl's centre and
    // spans the angles from -0.1 to 1.0 rad.
    let mouth = Polygon {
        outer: vec![
            bowl,
            bowl + direction(-0.1) * 60.0,
            bowl + direction(0.5) * 60.0,
            bowl + direction(1.0) * 60.0,
        ],
        holes: Vec::new(),
    };
    let ring = disc(0.0, -20.0, 27.0).difference(&disc(0.0, -20.0, 12.0)).difference(&Region::from(mouth));
    let shank = Region::rectangle(DVec2::new(-8.0, 2.0), DVec2::new(8.0, 44.0));
    let whole = ring.union(&shank).union(&disc(0.0, 44.0, 16.0));
    // Inner and outer corners are rounded, because a path of fibre cannot follow sharp corners.
    // The eye is cut last, so that its radius stays exact.
    let smooth = |r: Region, d: f64| r.offset(d, Join::Round).offset(-d, Join::Round);
    let whole = smooth(smooth(whole, 4.0), -3.0).difference(&disc(0.0, 44.0, 7.0)).simplified(0.01);
    let mut mesh = TriMesh::default();
    for p in &whole.polygons {
        let holes: Vec<Vec<DVec2>> = p.holes.iter().map(|h| h.iter().rev().copied().collect()).collect();
        prism(&p.outer, &holes, 0.0, 4.0, &mut mesh);
    }
    mesh
}

// Grips of 20 mm at each end, over the whole width.
const PLATE: &str = "
[[guide.fixture]]             # the left grip
on = { box_mm = [[0, -18, 0], [20, 18, 2]] }
fix = \"xyz\"

[[guide.load]]                # the right grip pulls
on = { box_mm = [[100, -18, 0], [120, 18, 2]] }
force_n = [1000, 0, 0]
";

// The cylinder's radius is 0.1 mm above that of the eye, so that it contains the nodes on the eye's
// polygonal edge.
const HOOK: &str = "
[[guide.fixture]]             # hangs by its eye
on = { cylinder = { point_mm = [0, 44, 2], axis = [0, 0, 1], radius_mm = 7.1, length_mm = 4 } }
fix = \"xyz\"

[[guide.load]]                # a rope in the bowl
on = { box_mm = [[-6, -33, 0], [6, -29.5, 4]] }
force_n = [0, -500, 0]
";

/// A way to fill a part.
struct Variant {
    /// Suffix after the part's name.
    name: &'static str,
    about: &'static str,
    fill: &'static str,
    turns: &'static str,
}

const VARIANTS: [Variant; 5] = [
    Variant {
        name: "",
        about: "one path of continuous fibre a layer, along the stress",
        fill: "pattern = \"continuous\"        # one path for each island of a layer",
        turns: "round",
    },
    Variant {
        name: "-wide",
        about: "continuous fibre along the stress whose turns all keep the least radius",
        fill: "pattern = \"continuous\"        # paths for each island of a layer",
        turns: "wide",
    },
    Variant {
        name: "-stripes",
        about: "fibre as stripes along the stress, for comparison",
        fill: "pattern = \"stripes\"           # even spacing; fibre beads keep their width",
        turns: "round",
    },
    Variant {
        name: "-concentric",
        about: "fibre in rings along the border, for comparison",
        fill: "pattern = \"concentric\"        # rings, as composite printers lay them",
        turns: "round",
    },
    Variant {
        name: "-rectilinear",
        about: "fibre to and fro at 45 degrees, for comparison",
        fill: "pattern = \"rectilinear\"\nangles_deg = [45, -45]",
        turns: "round",
    },
];

fn job(part: &str, title: &str, variant: &Variant, loads: &str) -> ExampleFile {
    let (suffix, about, fill, turns) =
        (variant.name, variant.about, variant.fill, format!("\"{}\"", variant.turns));
    let text = format!(
        "# {title}: {about}.
#
#   grainpath run {part}{suffix}.toml
#
# Every key may be left out; `docs/settings.md` lists them, `docs/continuous.md` explains fibre.

format = 1

[shape]
mesh = \"{part}.stl\"

[printer]
profile = \"fibre-coextruded\"  # one nozzle for both; fibre-separate has two

[material]
profile = \"pa-cf\"             # the matrix: walls, and paths too short for fibre

[process]
layer_height_mm = 0.2
first_layer_height_mm = 0.2
bead_width_mm = 0.8
walls = 1

[fill]
{fill}
density = 1.0

[fibre]
enabled = true
material = \"continuous-carbon\"
min_radius_mm = 2.0           # sharper turns are rounded where there is room
turns = {turns:24}# round | report | cut | wide
min_length_mm = 50            # the cutter stands 40 mm before the nozzle, and 5 mm hold the beginning
start = \"straight\"

[output]
gcode = \"out/{part}{suffix}.gcode\"
report = \"out/{part}{suffix}.html\"
preview = \"out/{part}{suffix}\"

[guide]
kind = \"stress\"
follow = \"max-abs\"
{loads}"
    );
    (format!("{part}{suffix}.toml").into(), text.into_bytes())
}

const CHAINED: &str = "# A hook without a travel after the first layer: walls and fill are one path, and each layer begins where the one
# below ended.
#
#   grainpath run chained.toml
#
# See `docs/continuous.md`.

format = 1

[shape]
mesh = \"hook.stl\"

[material]
profile = \"pla\"

[process]
walls = 2
chain = true
gap_fill = false              # single beads between walls would lie apart

[fill]
pattern = \"continuous\"
density = 1.0

[guide]
kind = \"angle\"
angle_deg = 90

[output]
gcode = \"out/chained.gcode\"
preview = \"out/chained\"
";

/// Jobs and parts of the example; the first job is the plate with one path a layer.
pub(super) fn files() -> Vec<ExampleFile> {
    let mut files = Vec::new();
    for (part, title, loads) in
        [("plate", "Plate with an open hole in tension", PLATE), ("hook", "Hook that carries a rope", HOOK)]
    {
        files.extend(VARIANTS.iter().map(|v| job(part, title, v, loads)));
    }
    files.push(("chained.toml".into(), CHAINED.as_bytes().to_vec()));
    files.push(("plate.stl".into(), stl(&plate())));
    files.push(("hook.stl".into(), stl(&hook())));
    files
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::mesh::diagnose;

    #[test]
    fn the_parts_are_closed_and_one_piece() {
        for mesh in [plate(), hook()] {
            let health = diagnose(&mesh).expect("triangles");
            assert!(health.is_closed() && health.shells == 1, "{health:?}");
        }
        let (low, high) = hook().bounds().expect("a hook");
        assert!((low.y + 47.0).abs() < 0.1 && (high.y - 60.0).abs() < 0.1, "{low} {high}");
    }

    #[test]
    fn every_job_is_sound() {
        for (name, text) in files().iter().filter(|f| f.0.ends_with(".toml")) {
            let text = std::str::from_utf8(text).expect("text");
            grainpath_job::parse_job(text, name, &[], &|p| Err(p.to_owned()))
                .unwrap_or_else(|e| panic!("{e}"));
        }
    }
}
