//! Example `stress-lines`: the two specimens of the paper `PrincipalStressLines`, and a bracket.

use std::fmt::Write;

use grainpath_core::{DVec2, DVec3, TriMesh};

use super::{ExampleFile, stl};
use crate::shapes::{arc, prism};
use crate::test_pieces::TestPiece;

/// GB/T 1040 (ISO 527) type 1A bar with a central hole of 3 mm: the test piece `s2-tension`.
fn tension_bar() -> TriMesh {
    TestPiece::named("s2-tension").map(TestPiece::mesh).unwrap_or_default()
}

/// Bending bar after GB/T 9341 (ISO 178) for a span of 160 mm: 200 x 10 x 10 mm, printed on its side.
fn bending_bar() -> TriMesh {
    let outline = [(0.0, 0.0), (200.0, 0.0), (200.0, 10.0), (0.0, 10.0)].map(DVec2::from);
    let mut mesh = TriMesh::default();
    prism(&outline, &[], 0.0, 10.0, &mut mesh);
    mesh
}

/// A shelf bracket: a wall plate, a shelf with a bolt hole, and a rib between them.
fn bracket() -> TriMesh {
    let mut mesh = TriMesh::default();
    let shelf = [(0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 40.0)].map(DVec2::from);
    prism(&shelf, &[arc(DVec2::new(42.0, 20.0), 5.0, 0, 4, 12)], 0.0, 8.0, &mut mesh);
    let wall = [(0.0, 0.0), (8.0, 0.0), (8.0, 40.0), (0.0, 40.0)].map(DVec2::from);
    prism(&wall, &[], 0.0, 45.0, &mut mesh);
    // The rib is drawn in x and z and extruded along y; `prism` extrudes along z, so the axes are
    // exchanged below.
    let rib = [(4.0, 4.0), (32.0, 4.0), (32.0, 8.0), (8.0, 40.0), (4.0, 40.0)].map(DVec2::from);
    let mut standing = TriMesh::default();
    prism(&rib, &[], -23.0, -17.0, &mut standing);
    let first = mesh.vertices.len() as u32;
    // (x, y, z) to (x, -z, y) is a rotation, so normals still point outwards.
    mesh.vertices.extend(standing.vertices.iter().map(|v| DVec3::new(v.x, -v.z, v.y)));
    mesh.triangles.extend(standing.triangles.iter().map(|t| t.map(|i| i + first)));
    mesh
}

// Grips 115 mm apart, as ISO 527-2, Table 1, sets them for type 1A.
const TENSION: &str = "
[[guide.fixture]]             # the left grip
on = { box_mm = [[0, -10, 0], [27.5, 10, 4]] }
fix = \"xyz\"

[[guide.load]]                # the right grip pulls
on = { box_mm = [[142.5, -10, 0], [170, 10, 4]] }
force_n = [500, 0, 0]
";

// Real rollers have a radius of 5 mm. In the model each roller is a line on the edge of the bar, the axis of a cylinder.
const BENDING: &str = "
[[guide.fixture]]             # the left roller, 5 mm in radius
on = { cylinder = { point_mm = [20, 0, 0], axis = [0, 0, 1], radius_mm = 0.8 } }
fix = \"xyz\"

[[guide.fixture]]             # the right roller, 160 mm on
on = { cylinder = { point_mm = [180, 0, 0], axis = [0, 0, 1], radius_mm = 0.8 } }
fix = \"yz\"

[[guide.load]]                # the nose presses on the middle
on = { cylinder = { point_mm = [100, 10, 0], axis = [0, 0, 1], radius_mm = 0.8 } }
force_n = [0, -300, 0]
";

const BRACKET: &str = "
[[guide.fixture]]             # screwed to a wall
on = { plane = { point_mm = [0, 0, 0], normal = [1, 0, 0], tolerance_mm = 0.01 } }
fix = \"xyz\"

[[guide.load]]                # the bolt in the shelf's hole pulls down and outwards
on = { cylinder = { point_mm = [42, 20, 4], axis = [0, 0, 1], radius_mm = 5.05, length_mm = 8 } }
force_n = [100, 0, -300]
";

/// Makes a job; `guide` and `fill` are the lines of its sections `[guide]` and `[fill]`.
fn job(
    about: &str,
    name: &str,
    part: &str,
    guide: &str,
    fill: &str,
    walls: usize,
    loads: &str,
) -> ExampleFile {
    // With cells one bead wide and only the nominal material card, all three bars take less than a minute.
    let compare = if ["tension", "bending"].contains(&part) {
        format!(
            "\n#   grainpath compare {part}-0.toml {part}-90.toml {part}.toml --set strength.cell_mm=0.45 --set strength.corners=false"
        )
    } else {
        String::new()
    };
    let mut text = String::new();
    let _ = write!(
        text,
        "# {about}
#
#   grainpath run {name}.toml{compare}
#
# Every key may be left out; `docs/settings.md` lists them, `docs/stress.md` explains loads and fills.

format = 1

[shape]
mesh = \"{part}.stl\"

[printer]
profile = \"generic-0.4\"

[material]
profile = \"pla\"
nozzle_temp_c = 200
bed_temp_c = 60

[process]
profile = \"standard\"
walls = {walls}
solid_speed_mm_s = 60

[fill]
{fill}

[output]
gcode = \"out/{name}.gcode\"
report = \"out/{name}.html\"
preview = \"out/{name}\"
stress = \"out/{name}.vtu\"
lines = \"out/{name}-lines.svg\"

[guide]
{guide}
{loads}"
    );
    (format!("{name}.toml").into(), text.into_bytes())
}

/// Jobs and parts of the example; the first is the paper's tensile bar with stripes.
pub(super) fn files() -> Vec<ExampleFile> {
    let stress =
        "kind = \"stress\"\nfollow = \"max-abs\"         # max-abs | tension | compression | alternate";
    let first_principal =
        "kind = \"stress\"\nfollow = \"tension\"         # the paper's: the greatest principal stress";
    let plain = |deg: &str| {
        format!(
            "kind = \"stress\"               # solved for the report; the fill keeps its angle\n# angle {deg}"
        )
    };
    let stripes = "pattern = \"stripes\"           # even spacing, bead width follows it\ndensity = 1.0";
    let seeds = "pattern = \"seed-lines\"        # the paper's: seed lines and their offsets\ndensity = 1.0";
    let aligned = |deg: &str| format!("pattern = \"aligned\"\ndensity = 1.0\nangles_deg = [{deg}]");
    let mut files = Vec::new();
    // Lines fan out from the neutral axis of a beam. Smoothing over a few bead widths lets fewer lines
    // end at the edge in tension, where the stress is greatest.
    let even = format!("{stress}\nsmoothing_mm = 2           # fewer lines end in the border that is drawn");
    // Only the directions of the bending bar are smoothed.
    for (part, about, loads, guide) in [
        ("tension", "GB/T 1040 bar with a central hole in tension", TENSION, stress),
        ("bending", "Three-point bending over a span of 160 mm", BENDING, &even),
    ] {
        files.push(job(
            &format!("{about}: beads along the principal stress."),
            part,
            part,
            guide,
            stripes,
            1,
            loads,
        ));
        // The paper traces the lines of the greatest principal stress alone.
        files.push(job(
            &format!("{about}: the paper's fill."),
            &format!("{part}-seed-lines"),
            part,
            first_principal,
            seeds,
            1,
            loads,
        ));
        for deg in ["0", "90"] {
            let about = format!("{about}: straight beads at {deg} degrees, for comparison.");
            files.push(job(&about, &format!("{part}-{deg}"), part, &plain(deg), &aligned(deg), 1, loads));
        }
    }
    files.push(job(
        "A shelf bracket pulled by the bolt in its hole.",
        "bracket",
        "bracket",
        stress,
        stripes,
        2,
        BRACKET,
    ));
    files.push(("tension.stl".into(), stl(&tension_bar())));
    files.push(("bending.stl".into(), stl(&bending_bar())));
    files.push(("bracket.stl".into(), stl(&bracket())));
    files
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::mesh::diagnose;

    #[test]
    fn the_parts_are_closed_and_have_their_volumes() {
        for (mesh, shells, volume) in [
            // 170 x 20 less the waist's relief, less the hole.
            (tension_bar(), 1, 4.0 * (170.0 * 20.0 - 2.0 * (80.0 * 5.0 + 2.0 * 50.0) - 7.07)),
            (bending_bar(), 1, 20_000.0),
            (
                bracket(),
                3,
                60.0 * 40.0 * 8.0 - 628.0 + 8.0 * 40.0 * 45.0 + 6.0 * (28.0 * 4.0 + 4.0 * 32.0 + 12.0 * 32.0),
            ),
        ] {
            let health = diagnose(&mesh).expect("triangles");
            assert!(health.is_closed() && health.shells == shells, "{health:?}");
            let found = mesh.signed_volume();
            assert!((found / volume - 1.0).abs() < 0.01, "{found} {volume}");
        }
    }
}
