//! Standard test pieces: the shape of each, its grips or rollers, a ready job, and a drawing.

use std::fmt::Write;

use grainpath_core::math::{asin, direction};
use grainpath_core::{DVec2, TriMesh};

use crate::shapes::{arc, prism};

/// How a piece is held and loaded.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Loading {
    /// Grips hold the length `grip_mm`, mm, at each end and pull.
    Tension { grip_mm: f64 },
    /// Two rollers, `span_mm` apart, mm, carry the bar; a nose presses on its middle.
    Bending { span_mm: f64 },
}

/// A test piece.
pub struct TestPiece {
    /// Name of the piece, as `grainpath specimen` takes it.
    pub name: &'static str,
    /// One line that says what the piece is.
    pub about: &'static str,
    shape: fn() -> Flat,
    loading: Loading,
    /// Dimensions for the drawing, with the letters of the standard.
    sizes: &'static [&'static str],
}

/// An outline with holes, extruded along z; the holes may lean along x.
struct Flat {
    outline: Vec<DVec2>,
    holes: Vec<Vec<DVec2>>,
    thickness_mm: f64,
    /// Shift of the holes along x for each mm of height: the tangent of the lean.
    lean: f64,
}

/// Every test piece.
pub static TEST_PIECES: [TestPiece; 8] = [
    // Source: ISO 527-2:2012, Table 1, type 1A. The standard sets the grips 115 mm apart, so each grip
    // holds (170 - 115) / 2 mm.
    TestPiece {
        name: "iso527-1a",
        about: "ISO 527-2 type 1A tensile bar (GB/T 1040), 170 x 20 x 4 mm",
        shape: || waisted(170.0, 80.0, 10.0, 20.0, 24.0, 4.0),
        loading: Loading::Tension { grip_mm: 27.5 },
        sizes: &["l3 170", "l1 80", "b1 10", "b2 20", "r 24", "h 4", "grips 115 apart"],
    },
    // Source: ISO 527-2:2012, Table 1, type 1B, which is for machined pieces.
    TestPiece {
        name: "iso527-1b",
        about: "ISO 527-2 type 1B tensile bar, 150 x 20 x 4 mm",
        shape: || waisted(150.0, 60.0, 10.0, 20.0, 60.0, 4.0),
        loading: Loading::Tension { grip_mm: 17.5 },
        sizes: &["l3 150", "l1 60", "b1 10", "b2 20", "r 60", "h 4", "grips 115 apart"],
    },
    // Source: ISO 178, preferred specimen 80 x 10 x 4 mm and a span of 16 thicknesses. The bar lies on
    // its 4 mm side, so that the load presses within the plane of the layers, where beads can follow the
    // stress.
    TestPiece {
        name: "iso178",
        about: "ISO 178 bending bar (GB/T 9341), 80 x 4 mm, printed on its side, 10 mm tall; span 64 mm",
        shape: || plain(80.0, 4.0, 10.0, None, 0.0),
        loading: Loading::Bending { span_mm: 64.0 },
        sizes: &[
            "l 80",
            "h 4 (across the layers' plane)",
            "b 10 (layers)",
            "span 64",
            "rollers R5, here as lines",
        ],
    },
    // Source: ASTM D638, Figure 1, type I.
    TestPiece {
        name: "d638-i",
        about: "ASTM D638 type I tensile bar, 165 x 19 x 3.2 mm",
        shape: || waisted(165.0, 57.0, 13.0, 19.0, 76.0, 3.2),
        loading: Loading::Tension { grip_mm: 25.0 },
        sizes: &["LO 165", "L 57", "W 13", "WO 19", "R 76", "T 3.2", "grips 115 apart"],
    },
    // Source: ASTM D5766, whose width is six hole diameters. The standard divides the load by the gross
    // section; a strength on the net section must not be compared with it.
    TestPiece {
        name: "d5766",
        about: "ASTM D5766 open-hole tension, 200 x 36 x 2.5 mm, hole 6 mm",
        shape: || plain(200.0, 36.0, 2.5, Some(3.0), 0.0),
        loading: Loading::Tension { grip_mm: 50.0 },
        sizes: &[
            "length 200",
            "w 36",
            "d 6",
            "thickness 2.5",
            "grips 100 apart",
            "strength on the gross section",
        ],
    },
    // A case of our own: the hole has the same diameter in every layer, and its centre moves with the height.
    // The last argument is the tangent of 20 degrees.
    TestPiece {
        name: "s1-box",
        about: "box with an oblique hole like that of a knot, 100 x 30 x 10 mm, hole 8 mm leaning by 20 degrees",
        shape: || plain(100.0, 30.0, 10.0, Some(4.0), 0.363_970_234_266_202_4),
        loading: Loading::Tension { grip_mm: 20.0 },
        sizes: &[
            "length 100",
            "width 30",
            "height 10",
            "hole 8 in every layer",
            "leans 20 deg along x",
            "grips 60 apart",
        ],
    },
    // Source: `PrincipalStressLines`, the tensile bar; without its hole it is type 1A above.
    TestPiece {
        name: "s2-tension",
        about: "GB/T 1040 tensile bar with a central hole of 3 mm, 170 x 20 x 4 mm",
        shape: || Flat {
            holes: vec![arc(DVec2::new(85.0, 0.0), 1.5, 0, 4, 16)],
            ..waisted(170.0, 80.0, 10.0, 20.0, 24.0, 4.0)
        },
        loading: Loading::Tension { grip_mm: 27.5 },
        sizes: &["l3 170", "l1 80", "b1 10", "b2 20", "r 24", "h 4", "hole 3", "grips 115 apart"],
    },
    // Source: `PrincipalStressLines`, the bending bar.
    TestPiece {
        name: "s2-bending",
        about: "three-point bending over a span of 160 mm, 200 x 10 x 10 mm, printed on its side",
        shape: || plain(200.0, 10.0, 10.0, None, 0.0),
        loading: Loading::Bending { span_mm: 160.0 },
        sizes: &["l 200", "h 10", "b 10 (layers)", "span 160", "rollers R5, here as lines"],
    },
];

/// A bar with a narrow middle whose shoulders are arcs: overall length, length of the narrow part,
/// narrow and full width, radius and thickness, mm. The bar lies along x from 0 and is centred on y = 0.
fn waisted(length: f64, narrow: f64, b1: f64, b2: f64, radius: f64, thickness_mm: f64) -> Flat {
    // An arc tangent to the narrow part rises by `rise` to the full width over `run`. Where it meets the
    // full width it has turned by `turn`, so the edge has a corner there, as the standards draw it.
    let rise = 0.5 * (b2 - b1);
    let run = (radius * radius - (radius - rise) * (radius - rise)).sqrt();
    let turn = asin(run / radius);
    let (from, to) = (0.5 * (length - narrow), 0.5 * (length + narrow));
    let half = std::f64::consts::FRAC_PI_2;
    // Twelve chords for each arc; the drawing, the mesh and the solver all see the same chords.
    let shoulder = |x: f64, y: f64, a: f64, b: f64| {
        (0..=12).map(move |k| DVec2::new(x, y) + direction(a + (b - a) * f64::from(k) / 12.0) * radius)
    };
    // Arcs are centred outside the bar, one radius from the narrow edge.
    let off = 0.5 * b1 + radius;
    let mut outline = vec![DVec2::new(0.0, -0.5 * b2)];
    outline.extend(shoulder(from, -off, half + turn, half));
    outline.extend(shoulder(to, -off, half, half - turn));
    outline.extend([DVec2::new(length, -0.5 * b2), DVec2::new(length, 0.5 * b2)]);
    outline.extend(shoulder(to, off, -half + turn, -half));
    outline.extend(shoulder(from, off, -half, -half - turn));
    outline.push(DVec2::new(0.0, 0.5 * b2));
    Flat { outline, holes: Vec::new(), thickness_mm, lean: 0.0 }
}

/// A plain bar; `hole_mm` is the radius of a hole in its middle.
fn plain(length: f64, width: f64, thickness_mm: f64, hole_mm: Option<f64>, lean: f64) -> Flat {
    let y = 0.5 * width;
    let outline = [(0.0, -y), (length, -y), (length, y), (0.0, y)].map(DVec2::from).to_vec();
    let holes = hole_mm.map(|r| arc(DVec2::new(0.5 * length, 0.0), r, 0, 4, 16)).into_iter().collect();
    Flat { outline, holes, thickness_mm, lean }
}

impl TestPiece {
    /// The test piece of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        TEST_PIECES.iter().find(|p| p.name == name)
    }

    /// Mesh of the piece, which stands on z = 0.
    pub fn mesh(&self) -> TriMesh {
        let flat = (self.shape)();
        let mut mesh = TriMesh::default();
        prism(&flat.outline, &flat.holes, 0.0, flat.thickness_mm, &mut mesh);
        // Only vertices on the rim of a hole are moved. They do not move at mid height, so the hole stays
        // centred in the bar. Comparison is exact because the prism copies the outline's coordinates.
        if flat.lean != 0.0 {
            for v in &mut mesh.vertices {
                if flat.holes.iter().flatten().any(|h| *h == v.truncate()) {
                    v.x += flat.lean * (v.z - 0.5 * flat.thickness_mm);
                }
            }
        }
        mesh
    }

    /// A job that prints and tests the piece; `file` is the name of its files without an extension.
    pub fn job(&self, file: &str) -> String {
        let flat = (self.shape)();
        let (low, high) = bounds(&flat.outline);
        let top = flat.thickness_mm;
        // The layers of a piece with a leaning hole differ, so `auto` would choose the solid model. This piece
        // is tested as a plate, and the job says so.
        let plane = if flat.lean == 0.0 {
            ""
        } else {
            "fidelity = \"plane\"           # layers differ: homogenised through the thickness\n"
        };
        // Values of the loads are nominal: the strength test scales them until the piece gives way.
        let loads = match self.loading {
            Loading::Tension { grip_mm } => format!(
                "[[guide.fixture]]             # the left grip
on = {{ box_mm = [[{}, {}, 0], [{}, {}, {top}]] }}
fix = \"xyz\"

[[guide.load]]                # the right grip pulls
on = {{ box_mm = [[{}, {}, 0], [{}, {}, {top}]] }}
force_n = [500, 0, 0]
",
                low.x,
                low.y,
                low.x + grip_mm,
                high.y,
                high.x - grip_mm,
                low.y,
                high.x,
                high.y
            ),
            // Each roller is a thin cylinder whose axis lies on the bar. One roller leaves x free: if both held
            // x, the bar would carry the load as an arch.
            Loading::Bending { span_mm } => {
                let middle = 0.5 * (low.x + high.x);
                format!(
                    "[[guide.fixture]]             # the left roller
on = {{ cylinder = {{ point_mm = [{}, {y}, 0], axis = [0, 0, 1], radius_mm = 0.8 }} }}
fix = \"xyz\"

[[guide.fixture]]             # the right roller
on = {{ cylinder = {{ point_mm = [{}, {y}, 0], axis = [0, 0, 1], radius_mm = 0.8 }} }}
fix = \"yz\"

[[guide.load]]                # the nose presses on the middle
on = {{ cylinder = {{ point_mm = [{middle}, {}, 0], axis = [0, 0, 1], radius_mm = 0.8 }} }}
force_n = [0, -100, 0]
",
                    middle - 0.5 * span_mm,
                    middle + 0.5 * span_mm,
                    high.y,
                    y = low.y
                )
            }
        };
        format!(
            "# {about}
#
#   grainpath strength {file}.toml
#   grainpath run {file}.toml

format = 1

[shape]
mesh = \"{file}.stl\"

[process]
walls = 1

[fill]
pattern = \"aligned\"           # stripes, with guide.kind = \"stress\", lays beads along the load
density = 1.0
angles_deg = [0]

[guide]
kind = \"none\"

{loads}
[strength]
enabled = true
{plane}
[output]
gcode = \"{file}.gcode\"
report = \"{file}.html\"
",
            about = self.about
        )
    }

    /// A drawing in mm as SVG: the outline, the places that are held and loaded, and the dimensions.
    pub fn drawing(&self) -> String {
        let flat = (self.shape)();
        let (low, high) = bounds(&flat.outline);
        let size = high - low;
        // A margin for the arrows above and beside the piece and for two lines of text below.
        let rim = (0.12 * size.x).max(12.0);
        let (w, h) = (size.x + 2.0 * rim, size.y + 3.0 * rim);
        // y points down in SVG and up in the part.
        let x = |p: f64| p - low.x + rim;
        let y = |p: f64| high.y - p + rim;
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w:.2}mm\" height=\"{h:.2}mm\" viewBox=\"0 0 {w:.3} {h:.3}\" font-family=\"sans-serif\" font-size=\"{:.2}\">\n",
            0.018 * w
        );
        let _ = writeln!(
            out,
            "<title>{}</title>\n<rect width=\"{w:.3}\" height=\"{h:.3}\" fill=\"#fff\"/>",
            self.about
        );
        let path = |ring: &[DVec2], shift: f64| {
            let points: Vec<String> =
                ring.iter().map(|p| format!("{:.3} {:.3}", x(p.x + shift), y(p.y))).collect();
            format!("M{}Z", points.join("L"))
        };
        let mut d = path(&flat.outline, 0.0);
        // Holes are drawn solid at the top face and dashed at the bottom face, as hidden edges are.
        flat.holes.iter().for_each(|r| d += &path(r, 0.5 * flat.lean * flat.thickness_mm));
        let _ = writeln!(
            out,
            "<path d=\"{d}\" fill=\"#e9edf2\" fill-rule=\"evenodd\" stroke=\"#222\" stroke-width=\"0.35\"/>"
        );
        if flat.lean != 0.0 {
            let hidden: String =
                flat.holes.iter().map(|r| path(r, -0.5 * flat.lean * flat.thickness_mm)).collect();
            let _ = writeln!(
                out,
                "<path d=\"{hidden}\" fill=\"none\" stroke=\"#222\" stroke-width=\"0.2\" stroke-dasharray=\"1.5 1\"/>"
            );
        }
        let arrow = |from: DVec2, to: DVec2, colour: &str| {
            let u = (to - from).normalize_or(DVec2::X) * 2.4;
            let v = DVec2::new(-u.y, u.x) * 0.35;
            format!(
                "<path d=\"M{:.2} {:.2}L{:.2} {:.2}M{:.2} {:.2}L{:.2} {:.2}L{:.2} {:.2}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"0.5\"/>\n",
                from.x,
                from.y,
                to.x,
                to.y,
                to.x - u.x + v.x,
                to.y - u.y + v.y,
                to.x,
                to.y,
                to.x - u.x - v.x,
                to.y - u.y - v.y
            )
        };
        match self.loading {
            Loading::Tension { grip_mm } => {
                for (from, colour) in [(low.x, "#2a6"), (high.x - grip_mm, "#c33")] {
                    let _ = writeln!(
                        out,
                        "<rect x=\"{:.3}\" y=\"{:.3}\" width=\"{grip_mm:.3}\" height=\"{:.3}\" fill=\"{colour}\" opacity=\"0.25\"/>",
                        x(from),
                        y(high.y),
                        size.y
                    );
                }
                let middle = y(0.5 * (low.y + high.y));
                out += &arrow(
                    DVec2::new(x(high.x) + 1.0, middle),
                    DVec2::new(x(high.x) + 0.7 * rim, middle),
                    "#c33",
                );
            }
            Loading::Bending { span_mm } => {
                let middle = 0.5 * (low.x + high.x);
                for p in [middle - 0.5 * span_mm, middle + 0.5 * span_mm] {
                    let _ = writeln!(
                        out,
                        "<circle cx=\"{:.3}\" cy=\"{:.3}\" r=\"2.5\" fill=\"#2a6\" opacity=\"0.6\"/>",
                        x(p),
                        y(low.y) + 2.5
                    );
                }
                out += &arrow(
                    DVec2::new(x(middle), y(high.y) - 0.7 * rim),
                    DVec2::new(x(middle), y(high.y) - 0.5),
                    "#c33",
                );
            }
        }
        // The dimension line of the overall length.
        let base = y(low.y) + 0.55 * rim;
        let _ = writeln!(
            out,
            "<path d=\"M{0:.3} {1:.3}V{2:.3}M{3:.3} {1:.3}V{2:.3}M{0:.3} {4:.3}H{3:.3}\" stroke=\"#555\" stroke-width=\"0.2\" fill=\"none\"/>\n<text x=\"{5:.3}\" y=\"{6:.3}\" text-anchor=\"middle\">{7}</text>",
            x(low.x),
            y(low.y) + 1.0,
            base + 1.0,
            x(high.x),
            base,
            x(0.5 * (low.x + high.x)),
            base - 1.0,
            size.x
        );
        let _ = writeln!(
            out,
            "<text x=\"{:.2}\" y=\"{:.3}\">{}: {} mm</text>\n<text x=\"{:.2}\" y=\"{:.3}\">green: held, red: loaded; length along x</text>\n</svg>",
            0.3 * rim,
            h - 0.6 * rim,
            self.name,
            self.sizes.join(", "),
            0.3 * rim,
            h - 0.2 * rim
        );
        out
    }
}

fn bounds(ring: &[DVec2]) -> (DVec2, DVec2) {
    let low = ring.iter().copied().reduce(DVec2::min).unwrap_or_default();
    (low, ring.iter().copied().reduce(DVec2::max).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::mesh::diagnose;

    #[test]
    fn pieces_are_closed_and_of_their_sizes() {
        for piece in &TEST_PIECES {
            let mesh = piece.mesh();
            let health = diagnose(&mesh).expect("triangles");
            assert!(health.is_closed() && health.shells == 1, "{}: {health:?}", piece.name);
            let flat = (piece.shape)();
            let area = |r: &[DVec2]| {
                grainpath_core::poly::edges(r)
                    .map(|(a, b)| 0.5 * grainpath_core::math::cross(a, b))
                    .sum::<f64>()
            };
            let want =
                flat.thickness_mm * (area(&flat.outline) - flat.holes.iter().map(|h| area(h)).sum::<f64>());
            assert!(
                (mesh.signed_volume() / want - 1.0).abs() < 1e-3,
                "{}: {} {want}",
                piece.name,
                mesh.signed_volume()
            );
        }
        // Shoulders meet the standard's distance between broad parts: 109.3 +- 3.2 for 1A, 108 +- 1.6 for 1B.
        for (flat, l2) in [
            (waisted(170.0, 80.0, 10.0, 20.0, 24.0, 4.0), 109.3),
            (waisted(150.0, 60.0, 10.0, 20.0, 60.0, 4.0), 108.0),
        ] {
            let broad: Vec<f64> = flat.outline.iter().filter(|p| p.y.abs() > 9.999).map(|p| p.x).collect();
            let inner = broad.iter().copied().filter(|x| *x > 1.0 && *x < 75.0).fold(0.0, f64::max);
            let other = broad.iter().copied().filter(|x| *x > 75.0).fold(f64::INFINITY, f64::min);
            assert!((other - inner - l2).abs() < 1.0, "{}", other - inner);
        }
    }

    #[test]
    fn every_job_is_sound() {
        for piece in &TEST_PIECES {
            let none = |_: &str| Err("no file".to_owned());
            let job = grainpath_job::parse_job(&piece.job("a"), "a.toml", &[], &none);
            assert!(job.is_ok_and(|s| s.strength.enabled && !s.guide.fixture.is_empty()), "{}", piece.name);
            assert!(piece.drawing().starts_with("<svg") && piece.drawing().ends_with("</svg>\n"));
        }
    }
}
