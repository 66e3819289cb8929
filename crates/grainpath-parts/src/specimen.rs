//! Pieces that are printed to find settings or to try supports: one row each in [`SPECIMENS`].

use grainpath_core::math::{direction, sin_cos};
use grainpath_core::{DVec2, DVec3, TriMesh};

/// A piece that `grainpath specimen` writes.
pub struct Specimen {
    /// Name of the piece.
    pub name: &'static str,
    /// One line that says what the piece is for.
    pub about: &'static str,
    /// Makes the piece, mm, standing on z = 0.
    pub mesh: fn() -> TriMesh,
}

/// Every specimen.
pub const SPECIMENS: [Specimen; 4] = [
    Specimen {
        name: "critical-angle",
        about: "numbered branches that lean by 0, 10, ... 90 and 30, 31, ... 49 degrees: shows which print without support",
        mesh: critical_angle,
    },
    Specimen {
        name: "critical-angle-short",
        about: "one row of short branches that lean by 25 to 70 degrees in steps of 5: a coarser and quicker `critical-angle`",
        mesh: critical_angle_short,
    },
    Specimen {
        name: "hanging-ball",
        about: "a ball 50 mm above the plate, for supports",
        mesh: hanging_ball,
    },
    Specimen {
        name: "dental-tray",
        about: "a horseshoe tray that leans by 30 degrees, for supports",
        mesh: dental_tray,
    },
];

/// Lean angles of the first row of the calibration piece. Source: Table 1 of `Shen2016` in `docs/references.bib`,
/// which prints 0 to 90 degrees in steps of 10, and 30 to 49 degrees in steps of 1.
const COARSE_DEG: [u32; 10] = [0, 10, 20, 30, 40, 50, 60, 70, 80, 90];
// Lean angles of the other rows. Source: the same table of `Shen2016`.
const FINE_DEG: std::ops::RangeInclusive<u32> = 30..=49;
/// Lean angles of the short piece: the range of [`FINE_DEG`], widened, in steps of 5 degrees. A material whose
/// critical angle lies outside needs the full piece. Source: derived from that range.
const SHORT_DEG: [u32; 10] = [25, 30, 35, 40, 45, 50, 55, 60, 65, 70];
/// Length of a branch of the full piece, mm. Source: chosen; the shape of an example of ours.
const LENGTH_MM: f64 = 15.0;
/// Length of a branch of the short piece, mm. Short branches sag less, so the short piece can show a critical
/// angle that is too high. Source: chosen; the shape of an example of ours.
const SHORT_LENGTH_MM: f64 = 8.0;
/// Radius of a branch, mm. A diameter of 3 mm takes about seven beads of 0.4 mm, so a branch has
/// walls and a middle as real overhangs do. Source: chosen; the shape of an example of ours.
const RADIUS_MM: f64 = 1.5;
/// Distance between neighbouring branches, mm; it must exceed the width of two digits.
/// Source: chosen; the shape of an example of ours.
const PITCH_MM: f64 = 9.0;
/// Height of the posts that lift the branches off the plate, mm. Branches at 90 degrees would lie on
/// the plate without them. Source: chosen; the shape of an example of ours.
const POST_MM: f64 = 6.0;

/// The calibration piece for the critical angle: a plate with one row of branches that lean by 0 to
/// 90 degrees from the vertical in steps of 10, and rows in steps of 1 from 30 to 49. Raised digits
/// before each branch give its angle. The piece stands on z = 0 and consists of overlapping bodies, which
/// slicing unites.
pub(crate) fn critical_angle() -> TriMesh {
    let fine: Vec<u32> = FINE_DEG.collect();
    let mut rows: Vec<&[u32]> = vec![&COARSE_DEG];
    rows.extend(fine.chunks(10));
    leaning_branches(&rows, LENGTH_MM)
}

/// The short calibration piece: one row of shorter branches that lean by 25 to 70 degrees in steps of 5.
pub(crate) fn critical_angle_short() -> TriMesh {
    leaning_branches(&[&SHORT_DEG], SHORT_LENGTH_MM)
}

/// Rows of at most ten branches on a plate. Each branch has its angle in degrees before it.
fn leaning_branches(rows: &[&[u32]], length_mm: f64) -> TriMesh {
    let mut mesh = TriMesh::default();
    // A row is as deep as a branch, a number and a gap together, so that a branch at 90 degrees ends before
    // the next row's number.
    let depth = length_mm + 14.0;
    let size = DVec2::new(10.0 * PITCH_MM + 4.0, rows.len() as f64 * depth);
    // The plate has six layers of 0.2 mm, so that it peels off in one piece and bends little.
    cuboid(&mut mesh, DVec3::ZERO, size.extend(1.2));
    for (j, row) in rows.iter().enumerate() {
        for (i, &angle) in row.iter().enumerate() {
            let x = 2.0 + PITCH_MM * (i as f64 + 0.5);
            let y = j as f64 * depth + 9.0;
            // Posts start inside the plate and end above the knee, from which the branch leans, so that the bodies
            // overlap. Bodies that only touch would slice into two contours.
            let post = DVec3::new(x, y, 0.6);
            let knee = DVec3::new(x, y, POST_MM);
            let (s, c) = sin_cos(f64::from(angle).to_radians());
            tube(&mut mesh, post, knee + DVec3::Z * 0.5);
            // Branches lean along +y, away from their numbers.
            tube(&mut mesh, knee, knee + DVec3::new(0.0, s, c) * length_mm);
            number(&mut mesh, angle, DVec3::new(x, y - 6.5, 0.8));
        }
    }
    mesh
}

/// A round bar from `a` to `b`.
fn tube(mesh: &mut TriMesh, a: DVec3, b: DVec3) {
    // Source: derived. A polygon of 24 sides departs from the circle by 0.9 per cent of the radius, 0.013 mm here: a small
    // part of a layer's height.
    const SIDES: u32 = 24;
    let along = (b - a).normalize_or(DVec3::Z);
    // Any axis that is not nearly parallel to the bar gives a well-conditioned cross product.
    let u = if along.x.abs() > 0.9 { DVec3::Y } else { DVec3::X };
    let v = along.cross(u).normalize();
    let u = v.cross(along);
    let first = mesh.vertices.len() as u32;
    for end in [a, b] {
        for i in 0..SIDES {
            let d = direction(f64::from(i) / f64::from(SIDES) * std::f64::consts::TAU) * RADIUS_MM;
            mesh.vertices.push(end + u * d.x + v * d.y);
        }
    }
    // The caps are fans about their centres, wound so that every normal points outwards.
    let (centre_a, centre_b) = (first + 2 * SIDES, first + 2 * SIDES + 1);
    mesh.vertices.extend([a, b]);
    for i in 0..SIDES {
        let j = (i + 1) % SIDES;
        let [p, q, r, s] = [first + i, first + j, first + SIDES + j, first + SIDES + i];
        mesh.triangles.extend([[p, q, r], [p, r, s], [centre_a, q, p], [centre_b, s, r]]);
    }
}

fn cuboid(mesh: &mut TriMesh, low: DVec3, high: DVec3) {
    let first = mesh.vertices.len() as u32;
    for i in 0..8 {
        let pick = |k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
        mesh.vertices.push(DVec3::new(pick(0), pick(1), pick(2)));
    }
    // Bits 0, 1 and 2 of a corner's number choose x, y and z; each face is wound counter-clockwise from
    // outside.
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for [a, b, c, d] in quads.map(|q: [u32; 4]| q.map(|i| i + first)) {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

/// Strokes of each digit on a seven-segment display, from the highest bit: top, upper left, upper
/// right, middle, lower left, lower right, bottom. Source: the common seven-segment shapes.
const DIGITS: [u8; 10] = [
    0b1110111, 0b0010010, 0b1011101, 0b1011011, 0b0111010, 0b1101011, 0b1101111, 0b1010010, 0b1111111,
    0b1111011,
];

/// A number in raised strokes, centred on `at`.
fn number(mesh: &mut TriMesh, value: u32, at: DVec3) {
    let text = value.to_string();
    // Strokes are 0.6 mm wide, more than one bead of a 0.4 mm nozzle; thinner strokes could be dropped.
    let (w, h, t, rise) = (2.0, 4.0, 0.6, 1.0);
    let step = w + 1.2;
    let left = at.x - 0.5 * (text.len() as f64 * step - 1.2);
    for (k, digit) in text.bytes().enumerate() {
        let (x, y) = (left + k as f64 * step, at.y - 0.5 * h);
        let half = 0.5 * h;
        let strokes = [
            (0.0, h, w, h),
            (0.0, half, 0.0, h),
            (w, half, w, h),
            (0.0, half, w, half),
            (0.0, 0.0, 0.0, half),
            (w, 0.0, w, half),
            (0.0, 0.0, w, 0.0),
        ];
        for (bit, (x0, y0, x1, y1)) in strokes.into_iter().enumerate() {
            if DIGITS[usize::from(digit - b'0')] >> (6 - bit) & 1 == 1 {
                // Each stroke starts a little lower than the one before. Strokes of one digit overlap;
                // if their faces lay in one plane, the union would depend on rounding.
                let low = DVec3::new(x + x0 - 0.5 * t, y + y0 - 0.5 * t, at.z - 0.02 * bit as f64);
                cuboid(mesh, low, DVec3::new(x + x1 + 0.5 * t, y + y1 + 0.5 * t, at.z + rise));
            }
        }
    }
}

/// A ball of radius 10 mm whose lowest point hangs 50 mm above a small plate: the first case of
/// `Shen2016`. The plate stands beside the ball and is the lowest point of the file. Without it the ball would be
/// set down on the bed.
pub fn hanging_ball() -> TriMesh {
    let mut mesh = TriMesh::default();
    cuboid(&mut mesh, DVec3::new(-30.0, -2.0, 0.0), DVec3::new(-26.0, 2.0, 0.6));
    sphere(&mut mesh, DVec3::new(0.0, 0.0, 60.0), 10.0);
    mesh
}

// Makes a sphere of `RINGS` rings from pole to pole, each of `SIDES` vertices. With 32 and 64 the chord
// error is 0.012 mm on a radius of 10 mm.
fn sphere(mesh: &mut TriMesh, centre: DVec3, radius: f64) {
    // Source: chosen; chords are off the surface by less than 0.1 mm.
    const RINGS: u32 = 32;
    // Source: chosen; chords are off the surface by less than 0.1 mm.
    const SIDES: u32 = 64;
    let first = mesh.vertices.len() as u32;
    mesh.vertices.push(centre - DVec3::Z * radius);
    for i in 1..RINGS {
        let (s, c) = sin_cos(f64::from(i) / f64::from(RINGS) * std::f64::consts::PI);
        for j in 0..SIDES {
            let d = direction(f64::from(j) / f64::from(SIDES) * std::f64::consts::TAU) * (s * radius);
            mesh.vertices.push(centre + d.extend(-c * radius));
        }
    }
    mesh.vertices.push(centre + DVec3::Z * radius);
    // The modulus closes each ring: its last quad ends at its first vertex.
    let at = |i: u32, j: u32| first + 1 + (i - 1) * SIDES + j % SIDES;
    let top = first + 1 + (RINGS - 1) * SIDES;
    for j in 0..SIDES {
        mesh.triangles.push([first, at(1, j + 1), at(1, j)]);
        mesh.triangles.push([top, at(RINGS - 1, j), at(RINGS - 1, j + 1)]);
        for i in 1..RINGS - 1 {
            mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
}

/// A horseshoe tray as dentists print them, the second case of `Shen2016`. The tray leans by 30
/// degrees and its lowest point hangs 4 mm above the plate, beside a small plate.
pub(crate) fn dental_tray() -> TriMesh {
    let mut mesh = TriMesh::default();
    // A channel, open above, swept along a parabola. The section is listed counter-clockwise.
    let section: [(f64, f64); 8] =
        [(-6.0, 0.0), (6.0, 0.0), (6.0, 9.0), (4.2, 9.0), (4.2, 1.8), (-4.2, 1.8), (-4.2, 9.0), (-6.0, 9.0)];
    // Source: derived. Sixty-four steps over an arch of about 90 mm: the chord error at the apex is 0.01 mm.
    const STEPS: u32 = 64;
    let arch = |t: f64| DVec2::new(26.0 * t, 34.0 * (1.0 - t * t));
    let (s, c) = sin_cos(30f64.to_radians());
    let lean = |p: DVec3| DVec3::new(p.x, p.y * c - p.z * s, p.y * s + p.z * c);
    let n = section.len() as u32;
    for i in 0..=STEPS {
        let t = 2.0 * f64::from(i) / f64::from(STEPS) - 1.0;
        // The section is perpendicular to the arch, because its walls would otherwise thin where the arch is steep.
        let along = (arch(t + 1e-3) - arch(t - 1e-3)).normalize();
        let across = DVec2::new(along.y, -along.x);
        for (x, z) in section {
            mesh.vertices.push(lean((arch(t) + across * x).extend(z)));
        }
    }
    for i in 0..STEPS {
        for k in 0..n {
            let j = (k + 1) % n;
            let [p, q, r, s] = [i * n + k, i * n + j, (i + 1) * n + j, (i + 1) * n + k];
            mesh.triangles.extend([[p, r, q], [p, s, r]]);
        }
    }
    // Both ends are closed by the three rectangles of the section; at the far end the winding is
    // reversed.
    for (base, flip) in [(0, false), (STEPS * n, true)] {
        for [a, b, c] in [[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4], [0, 5, 6], [0, 6, 7]] {
            let t = [a, b, c].map(|i| i + base);
            mesh.triangles.push(if flip { [t[0], t[2], t[1]] } else { t });
        }
    }
    let low = mesh.vertices.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    mesh.vertices.iter_mut().for_each(|p| p.z += 4.0 - low);
    cuboid(&mut mesh, DVec3::new(-40.0, -30.0, 0.0), DVec3::new(-36.0, -26.0, 0.6));
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::mesh::diagnose;

    #[test]
    fn pieces_are_closed_and_stand_on_the_plate() {
        for (name, mesh) in SPECIMENS.iter().map(|s| (s.name, (s.mesh)())) {
            let health = diagnose(&mesh).expect("a mesh");
            // Strokes and bars of the numbered piece overlap; they share no edge.
            assert!(health.is_closed() && health.volume > 0.0, "{name}: {health:?}");
            assert!(health.bounds.0.z.abs() < 1e-9, "{name}");
        }
        let ball = hanging_ball().signed_volume() - 4.0 * 4.0 * 0.6;
        assert!((ball / (4.0 / 3.0 * std::f64::consts::PI * 1000.0) - 1.0).abs() < 0.01, "{ball}");
        let (_, high) = critical_angle().bounds().expect("a mesh");
        assert!((high.z - (POST_MM + LENGTH_MM)).abs() < 0.2, "{high}");
    }
}
