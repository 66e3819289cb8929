//! Finds the poses in which a part can stand by itself on the plate, and rates how well each pose suits the loads.
//!
//! A pose is stable if the part rests on a flat whose convex hull contains the vertical projection of the centre of mass.
//! Candidates are the facets of the part's convex hull, with coplanar facets merged, and the six axes of its file. The
//! hull is built incrementally from the vertices that lie farthest in many directions: each added vertex replaces the
//! facets that it sees.
//!
//! The reserve of a pose is computed from one solved stress. At every node that does not lie at a fixture or load, the
//! stress is turned with the pose and applied to parallel beads in the layers of that pose. If the infill follows the
//! stress, these beads lie along the greater principal stress in the layer, otherwise at the raster angles.
//! [`first_failure`](grainpath_fea::strength::first_failure) gives the factor at failure. The reserve serves to compare
//! poses of a dense part; the reserve of the real beads is computed when the pose is planned.
//!
//! Units: mm, MPa, radians inside. Cost: [`DIRECTIONS`] times the vertices for the farthest ones, a hull quadratic in at
//! most that number of vertices, and a reserve linear in the nodes. Limits: a part that touches the plate only in points,
//! such as one on three spheres, has no flat.

use grainpath_core::math::{atan2, cross, direction, sin_cos};
use grainpath_core::{DMat3, DVec2, DVec3, TriMesh};
use grainpath_fea::principal::plane_principal;
use grainpath_fea::strength::bricks::{BrickPly, Bricks};
use grainpath_fea::strength::card::StrengthCard;
use grainpath_fea::strength::first_failure::{IndexScale, first_failure_of_bricks};
use grainpath_fea::strength::grid_turn::convex_hull;
use rayon::prelude::*;
use serde::Serialize;

use crate::guide::{Guide, ResultMesh};
use crate::measure::strength::{StrengthError, StrengthSettings, digits, interval};

/// Number of directions in which the farthest vertex is taken for the hull. Source: derived. Spread evenly over a sphere,
/// they are 3 degrees apart, which is less than the tilt of `LEAST_TILT_RAD` that a pose has to withstand.
pub const DIRECTIONS: usize = 4000;
/// Vertices rest on the plate if they are at most this far above the lowest vertex, as a share of the part's size. Source:
/// derived. For a part of 100 mm this is 0.02 mm, a tenth of a layer.
const RESTS: f64 = 2e-4;
/// Facets whose normals differ by less than this count as one flat, rad. Source: derived. Half a degree lifts the far end
/// of a flat of 20 mm by 0.2 mm, which is one layer.
const SAME_FLAT_RAD: f64 = 0.0087;
/// Smallest tilt that a pose must withstand, rad. Source: derived. A part that withstands a tilt of five degrees also
/// withstands a nozzle that drags over it, 10 mm above its centre of mass, with a tenth of its weight.
const LEAST_TILT_RAD: f64 = 0.0873;
/// Smallest distance of the projected centre of mass from the border of the flat, mm. Source: derived. Two beads.
const LEAST_REACH_MM: f64 = 1.0;
/// Reserves that differ by less than this share count as equal; the mass of supports then decides. Source: derived. A
/// tenth of the error of a reserve.
const SAME_RESERVE: f64 = 0.015;

/// Why a part has no pose.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum OrientError {
    #[error(
        "the part has no flat to stand on: no side of its convex hull extends {LEAST_REACH_MM} mm around the projected centre of mass; cut a flat, or print the part on supports as it lies"
    )]
    NoFlat,
    #[error("the part encloses no volume, so it has no centre of mass")]
    NoVolume,
}

/// An orientation in which a part stands by itself on the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Rotations about x, then y, then z that turn the part from its orientation in the file into the pose, degrees.
    pub rotate_deg: [f64; 3],
    /// The direction that points down in the pose, in the coordinates of the given mesh.
    pub down: DVec3,
    /// Area of the convex hull of all points that rest on the plate, mm2.
    pub flat_mm2: f64,
    /// Height of the part in the pose, mm.
    pub height_mm: f64,
    /// The tilt that the pose withstands, degrees.
    pub tilt_deg: f64,
}

impl Pose {
    /// The rotation that turns the given mesh into the pose.
    pub fn rotation(&self) -> DMat3 {
        turn_down(self.down).1
    }
}

/// The rotations about x and y, rad, that turn a direction down, and both as a matrix.
fn turn_down(d: DVec3) -> ([f64; 2], DMat3) {
    let rho = (d.y * d.y + d.z * d.z).sqrt();
    // A direction along x needs only a rotation about y.
    let about_x = if rho > 1e-12 { atan2(-d.y, -d.z) } else { 0.0 };
    let about_y = atan2(d.x, rho);
    let ((xs, xc), (ys, yc)) = (sin_cos(about_x), sin_cos(about_y));
    let first = DMat3::from_cols(DVec3::X, DVec3::new(0.0, xc, xs), DVec3::new(0.0, -xs, xc));
    let second = DMat3::from_cols(DVec3::new(yc, 0.0, -ys), DVec3::Y, DVec3::new(ys, 0.0, yc));
    ([about_x, about_y], second * first)
}

/// Returns at most `most` stable poses of a part, those with the largest flats first. `file_from_part` is the rotation from
/// the given mesh to the orientation of the part in its file.
///
/// # Errors
/// [`OrientError`] for parts without a stable pose, and for surfaces that enclose no volume.
pub fn poses(mesh: &TriMesh, file_from_part: DMat3, most: usize) -> Result<Vec<Pose>, OrientError> {
    let centre = centre_of_mass(mesh).ok_or(OrientError::NoVolume)?;
    let points = farthest(mesh);
    let size_mm = mesh.bounds().map_or(0.0, |(low, high)| (high - low).length());
    let mut downs: Vec<DVec3> = Vec::new();
    let axes = [DVec3::NEG_Z, DVec3::Z, DVec3::NEG_X, DVec3::X, DVec3::NEG_Y, DVec3::Y];
    let axes = axes.map(|axis| file_from_part.transpose() * axis);
    // Facets are sorted by falling area, so that a flat gets the normal of its largest facet.
    let mut facets: Vec<(f64, DVec3)> = hull(&points, 1e-9 * size_mm);
    facets.sort_by(|a, b| b.0.total_cmp(&a.0));
    for down in axes.into_iter().chain(facets.into_iter().map(|f| f.1)) {
        // The chord of a small angle is as long as its arc.
        if downs.iter().all(|other| other.distance(down) > SAME_FLAT_RAD) {
            downs.push(down);
        }
    }
    let stands = |down: &DVec3| {
        let (_, rotation) = turn_down(*down);
        let low = points.iter().map(|p| (rotation * *p).z).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| (rotation * *p).z).fold(f64::NEG_INFINITY, f64::max);
        let resting = mesh.vertices.iter().map(|p| rotation * *p).filter(|p| p.z <= low + RESTS * size_mm);
        let flat = convex_hull(resting.map(DVec3::truncate).collect());
        let foot = rotation * centre;
        let reach_mm = reach(&flat, foot.truncate());
        let tilt = atan2(reach_mm, foot.z - low);
        let ([x, y], _) = turn_down(file_from_part * *down);
        // Angles are rounded to 0.0001 degrees, which moves a part of 300 mm by half a micrometre.
        let degrees = |rad: f64| (rad.to_degrees() * 1e4).round() / 1e4 + 0.0;
        let n = flat.len();
        let area = |k: usize| 0.5 * cross(flat[k], flat[(k + 1) % n]);
        (reach_mm >= LEAST_REACH_MM && tilt >= LEAST_TILT_RAD).then(|| Pose {
            rotate_deg: [degrees(x), degrees(y), 0.0],
            down: *down,
            flat_mm2: (0..n).map(area).sum(),
            height_mm: high - low,
            tilt_deg: tilt.to_degrees(),
        })
    };
    let mut found: Vec<Pose> = downs.iter().filter_map(stands).collect();
    found.sort_by(|a, b| b.flat_mm2.total_cmp(&a.flat_mm2));
    found.truncate(most);
    if found.is_empty() { Err(OrientError::NoFlat) } else { Ok(found) }
}

/// The centre of mass of a closed surface; `None` if it encloses no volume.
fn centre_of_mass(mesh: &TriMesh) -> Option<DVec3> {
    let (low, high) = mesh.bounds()?;
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    for t in &mesh.triangles {
        // Coordinates are taken relative to the lowest corner of the part's box, so that a part far from the
        // origin keeps its precision.
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize] - low);
        let six = a.dot(b.cross(c));
        volume += six;
        moment += six * 0.25 * (a + b + c);
    }
    (volume.abs() > 1e-9 * (high - low).length().powi(3)).then(|| low + moment / volume)
}

/// The vertices that lie farthest in one of many directions, which are spread evenly over a sphere on a spiral.
fn farthest(mesh: &TriMesh) -> Vec<DVec3> {
    let golden = std::f64::consts::PI * (3.0 - 5.0f64.sqrt());
    let spread = (0..DIRECTIONS).map(|k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / DIRECTIONS as f64;
        let around = direction(golden * k as f64) * (1.0 - z * z).sqrt();
        around.extend(z)
    });
    let axes = DVec3::AXES.into_iter().flat_map(|a| [a, -a]);
    // Duplicate positions are removed, because a mesh may contain each vertex several times.
    let mut places: Vec<DVec3> = mesh.vertices.clone();
    places.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    places.dedup();
    let all: Vec<DVec3> = spread.chain(axes).collect();
    let farthest_along = |d: &DVec3| {
        let by_reach = |a: &u32, b: &u32| {
            let [a, b] = [a, b].map(|i| places[*i as usize].dot(*d));
            a.total_cmp(&b)
        };
        (0..places.len() as u32).max_by(by_reach)
    };
    let mut taken: Vec<u32> = all.par_iter().filter_map(farthest_along).collect();
    taken.sort_unstable();
    taken.dedup();
    taken.into_iter().map(|i| places[i as usize]).collect()
}

/// The area and outward normal of each facet of the convex hull of some points; empty if all points lie in a plane.
fn hull(points: &[DVec3], hair_mm: f64) -> Vec<(f64, DVec3)> {
    let Some(first) = first_tetrahedron(points, hair_mm) else { return Vec::new() };
    let normal = |t: &[usize; 3]| {
        let [a, b, c] = t.map(|i| points[i]);
        (b - a).cross(c - a)
    };
    let [a, b, c, d] = first;
    let middle = (points[a] + points[b] + points[c] + points[d]) * 0.25;
    let outwards = |t: [usize; 3]| {
        if normal(&t).dot(points[t[0]] - middle) < 0.0 { [t[0], t[2], t[1]] } else { t }
    };
    let mut facets: Vec<[usize; 3]> = [[a, b, c], [a, b, d], [a, c, d], [b, c, d]].map(outwards).to_vec();
    for p in (0..points.len()).filter(|p| !first.contains(p)) {
        let sees = |t: &[usize; 3]| {
            let n = normal(t);
            n.dot(points[p] - points[t[0]]) > hair_mm * n.length()
        };
        let (seen, mut kept): (Vec<[usize; 3]>, Vec<[usize; 3]>) = facets.iter().partition(|t| sees(t));
        // The rim of the visible facets consists of edges whose reverse belongs to no visible facet.
        let edges: Vec<[usize; 2]> =
            seen.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]).collect();
        let rim = edges.iter().filter(|[u, v]| !edges.contains(&[*v, *u]));
        kept.extend(rim.map(|[u, v]| [*u, *v, p]));
        facets = kept;
    }
    let of_facet = |t: &[usize; 3]| {
        let n = normal(t);
        Some((0.5 * n.length(), n.try_normalize()?))
    };
    facets.iter().filter_map(of_facet).collect()
}

/// Four points that are not in a plane.
fn first_tetrahedron(points: &[DVec3], hair_mm: f64) -> Option<[usize; 4]> {
    let best = |value: &dyn Fn(DVec3) -> f64| {
        (0..points.len()).max_by(|i, j| value(points[*i]).total_cmp(&value(points[*j])))
    };
    let a = best(&|p| -p.x)?;
    let b = best(&|p| p.distance_squared(points[a]))?;
    let along = (points[b] - points[a]).try_normalize()?;
    let c = best(&|p| (p - points[a]).reject_from_normalized(along).length_squared())?;
    let up = along.cross(points[c] - points[a]).try_normalize()?;
    let d = best(&|p| (p - points[a]).dot(up).abs())?;
    ((points[d] - points[a]).dot(up).abs() > hair_mm.max(1e-12)).then_some([a, b, c, d])
}

/// The least distance from a point inside a convex polygon to the polygon's sides; 0 for points outside.
fn reach(corners: &[DVec2], p: DVec2) -> f64 {
    let n = corners.len();
    if n < 3 {
        return 0.0;
    }
    let inwards = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % n]);
        cross(b - a, p - a) / (b - a).length().max(1e-12)
    };
    (0..n).map(inwards).fold(f64::INFINITY, f64::min).max(0.0)
}

/// The reserve of a pose, which is the least one of all load cases.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct PoseReserve {
    /// The factors on the loads at first failure with the low, nominal and high strengths of the material; the interval
    /// also holds what mesh and method may miss, as that of a planned part.
    pub first_failure: [f64; 3],
    pub case: String,
    pub mode: &'static str,
    /// Position of the first failure, in the coordinates in which the stress was solved.
    pub at_mm: [f64; 3],
    /// The tension across layers that 99.5 % of the nodes stay below in the worst load case, MPa; 0 if it is compression.
    pub across_layers_mpa: f64,
}

/// Share of the nodes that stay below the reported tension across layers. Source: the scale of stress pictures; the peak
/// at a re-entrant corner grows without limit as the mesh becomes finer.
const COVERED: f64 = 0.995;

/// The directions of beads in the layers of a pose.
#[derive(Debug, Clone, PartialEq)]
pub enum BeadDirections {
    /// Along the greater principal stress in the layer.
    AlongStress,
    /// At one or two raster angles, rad.
    Raster(Vec<f64>),
}

/// Computes the reserve of a pose under a solved stress; `None` if the peak of the stress cannot be trusted or all nodes
/// lie at fixtures and loads.
///
/// # Errors
/// [`StrengthError::NoCard`] for a material without strengths.
pub fn reserve(
    guide: &Guide,
    rotation: DMat3,
    beads: &BeadDirections,
    settings: &StrengthSettings,
) -> Result<Option<PoseReserve>, StrengthError> {
    let cards = settings.bounding_cards()?;
    if !guide.is_trusted() {
        return Ok(None);
    }
    let grips = guide.grips(settings.bead_mm);
    let mut least: Option<PoseReserve> = None;
    let mut across_mpa = 0.0f64;
    for result in &guide.results {
        let free: Vec<usize> =
            (0..result.nodes.len()).filter(|&i| !grips.iter().any(|g| g.contains(result.nodes[i]))).collect();
        let Some(found) = of_case(result, &free, rotation, beads, &cards)? else { continue };
        across_mpa = across_mpa.max(found.across_layers_mpa);
        if least.as_ref().is_none_or(|l| found.first_failure[1] < l.first_failure[1]) {
            least = Some(found);
        }
    }
    Ok(least.map(|least| {
        let first_failure = interval(guide, least.first_failure).map(digits);
        PoseReserve { first_failure, across_layers_mpa: across_mpa, ..least }
    }))
}

fn of_case(
    result: &ResultMesh,
    free: &[usize],
    rotation: DMat3,
    beads: &BeadDirections,
    cards: &[StrengthCard; 3],
) -> Result<Option<PoseReserve>, StrengthError> {
    let stress: Vec<[f64; 6]> = free.iter().map(|&i| turned(&result.stress[i], rotation)).collect();
    // Every node becomes one brick, completely filled and bonded.
    let n = free.len();
    let mut bricks = Bricks {
        n: [n, 1, 1],
        origin: DVec3::ZERO,
        cell_mm: DVec3::ONE,
        filled: vec![1.0; n],
        bond: vec![1.0; n],
        starts: vec![0],
        plies: Vec::new(),
        volume_mm3: n as f64,
        laid_mm3: n as f64,
    };
    for [xx, yy, _, xy, ..] in &stress {
        match beads {
            BeadDirections::AlongStress => {
                let found = plane_principal([*xx, *yy, *xy]);
                let [a, b] = found.values_mpa;
                let across = if b.abs() > a.abs() { std::f64::consts::FRAC_PI_2 } else { 0.0 };
                bricks.plies.push(BrickPly { share: 1.0, angle_rad: found.axis_rad + across });
            }
            BeadDirections::Raster(angles) => {
                let taken = angles.len().clamp(1, 2);
                let share = 1.0 / taken as f64;
                bricks.plies.extend(angles[..taken].iter().map(|&angle_rad| BrickPly { share, angle_rad }));
            }
        }
        bricks.starts.push(bricks.plies.len() as u32);
    }
    let found = first_failure_of_bricks(&bricks, cards, IndexScale::ONE, &|cell| Some(stress[cell]))
        .map_err(|e| StrengthError::Test(e.into()))?;
    let [Some(low), Some(nominal), Some(high)] = found.first else { return Ok(None) };
    let mut across: Vec<f64> = stress.iter().map(|s| s[2]).collect();
    across.sort_by(f64::total_cmp);
    let covered = ((n as f64 - 1.0) * COVERED) as usize;
    Ok(Some(PoseReserve {
        first_failure: [low, nominal, high].map(|f| 1.0 / f.index.max(1e-12)),
        case: result.name.clone(),
        mode: nominal.mode.name(),
        at_mm: result.nodes[free[nominal.cell]].to_array().map(|v| (v * 100.0).round() / 100.0),
        across_layers_mpa: digits(across[covered].max(0.0)),
    }))
}

/// Rotates a stress with its part; the order is xx, yy, zz, xy, yz, zx.
fn turned([xx, yy, zz, xy, yz, zx]: &[f64; 6], rotation: DMat3) -> [f64; 6] {
    let columns = [[*xx, *xy, *zx], [*xy, *yy, *yz], [*zx, *yz, *zz]];
    let t = rotation * DMat3::from_cols_array_2d(&columns) * rotation.transpose();
    [t.x_axis.x, t.y_axis.y, t.z_axis.z, t.x_axis.y, t.y_axis.z, t.x_axis.z]
}

/// The numbers by which poses are ranked, in this order; smaller is better: reserve (rounded, so that nearly equal ones
/// count as equal), mass of supports, height, time. Poses without a reserve come last.
pub fn rank(reserve: Option<f64>, support_g: f64, height_mm: f64, time_s: f64) -> [f64; 4] {
    let steps = |r: f64| (-grainpath_core::math::ln(r.max(1e-9)) / SAME_RESERVE).round();
    [reserve.map_or(f64::INFINITY, steps), support_g, height_mm, time_s]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A prism over a regular polygon of `n` corners and radius `r`, `h` high; a box for four.
    fn prism(n: usize, r: f64, h: f64) -> TriMesh {
        let corner = |k: usize| direction(std::f64::consts::TAU * (k as f64 + 0.5) / n as f64) * r;
        let mut mesh = TriMesh::default();
        for z in [0.0, h] {
            mesh.vertices.extend((0..n).map(|k| corner(k).extend(z)));
        }
        for k in 0..n {
            let (a, b) = (k as u32, ((k + 1) % n) as u32);
            let m = n as u32;
            mesh.triangles.extend([[a, b, b + m], [a, b + m, a + m]]);
            if k > 0 && k + 1 < n {
                mesh.triangles.extend([[0, b, a], [m, a + m, b + m]]);
            }
        }
        mesh
    }

    #[test]
    fn a_direction_is_turned_down() {
        let all = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        let slant = [DVec3::new(0.3, -0.7, 0.2), DVec3::new(-0.5, 0.4, -0.9)].map(DVec3::normalize);
        for d in all.into_iter().chain(slant) {
            let ([x, y], rotation) = turn_down(d);
            assert!((rotation * d).distance(DVec3::NEG_Z) < 1e-12, "{d}");
            // The rotations of a job do the same.
            let standing = crate::shape::Standing::new(1.0, [x, y, 0.0], 0.0);
            assert!((standing.rotation * d).distance(DVec3::NEG_Z) < 1e-12, "{d}");
        }
        assert_eq!(turn_down(DVec3::NEG_Z).0, [0.0, 0.0]);
    }

    #[test]
    fn a_box_stands_on_six_sides_and_a_round_bar_on_two() {
        // A square of 10 mm, 30 mm high.
        let block = prism(4, 50.0f64.sqrt(), 30.0);
        let found = poses(&block, DMat3::IDENTITY, 12).expect("sides");
        assert_eq!(found.len(), 6);
        let flats: Vec<f64> = found.iter().map(|p| p.flat_mm2.round()).collect();
        assert_eq!(flats, [300.0, 300.0, 300.0, 300.0, 100.0, 100.0]);
        let tall = found.iter().find(|p| p.rotate_deg == [0.0; 3]).expect("as in the file");
        // The centre lies 15 mm up, its foot 5 mm from each side.
        assert!((tall.height_mm - 30.0).abs() < 1e-9 && (tall.tilt_deg - 18.435).abs() < 1e-3, "{tall:?}");
        // A round bar rolls on its side, whose facets are half a millimetre wide.
        let round = poses(&prism(60, 5.0, 20.0), DMat3::IDENTITY, 12).expect("ends");
        assert_eq!(round.iter().map(|p| p.height_mm.round()).collect::<Vec<_>>(), [20.0, 20.0]);
        // A tower that falls over at a touch stands on its sides alone.
        let tower = poses(&prism(4, 8.0f64.sqrt(), 60.0), DMat3::IDENTITY, 12).expect("sides");
        assert_eq!(tower.len(), 4);
        // A needle has no flat of two millimetres.
        assert_eq!(poses(&prism(12, 0.9, 60.0), DMat3::IDENTITY, 12), Err(OrientError::NoFlat));
    }

    #[test]
    fn poses_turn_with_the_part() {
        let mut block = prism(4, 50.0f64.sqrt(), 30.0);
        let standing = crate::shape::Standing::new(1.0, [0.4, -0.9, 1.3], 0.0);
        block.vertices.iter_mut().for_each(|p| *p = standing.rotation * *p);
        let found = poses(&block, standing.rotation.transpose(), 12).expect("sides");
        assert_eq!(found.len(), 6);
        for pose in &found {
            // From the file straight to the pose the part is as high.
            let turn = crate::shape::Standing::new(1.0, pose.rotate_deg.map(f64::to_radians), 0.0).rotation;
            let z = block.vertices.iter().map(|p| (turn * standing.rotation.transpose() * *p).z);
            let (low, high) = z.fold((f64::MAX, f64::MIN), |(a, b), z| (a.min(z), b.max(z)));
            assert!((high - low - pose.height_mm).abs() < 1e-3, "{pose:?}");
        }
    }

    #[test]
    fn what_lies_open_has_no_centre() {
        let flat = TriMesh { vertices: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]] };
        assert_eq!(poses(&flat, DMat3::IDENTITY, 12), Err(OrientError::NoVolume));
    }

    #[test]
    fn poses_of_nearly_equal_reserve_are_told_apart_by_support() {
        let mut ranks = [
            rank(Some(2.0), 5.0, 10.0, 1.0),
            rank(Some(2.005), 1.0, 10.0, 1.0),
            rank(Some(3.0), 9.0, 1.0, 1.0),
            rank(None, 0.0, 0.0, 0.0),
        ];
        ranks.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        assert_eq!(ranks.map(|r| r[1]), [9.0, 1.0, 5.0, 0.0]);
    }
}
