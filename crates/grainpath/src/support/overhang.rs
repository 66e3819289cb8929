//! Finds overhangs and places the contacts that hold them, after `Shen2016`.
//!
//! Three things need support:
//!
//! 1. facets that lean from the vertical by more than the critical angle;
//! 2. edges that lean by more than the critical angle, between two facets that do not;
//! 3. pieces of a layer with nothing below them.
//!
//! Connected facets form a region. Regions smaller than a bead or two are left out. The others are sampled on a grid, and
//! contacts are placed so that no sample is farther than L/2 from a contact, where L is the longest stretch that the
//! material prints over air. Enforcers and blockers of the job, and those painted on the mesh, override the angles.
//!
//! Contacts depend on the surface, not on how it is divided into triangles: a sample on the edge of two facets is taken
//! once, and samples and groups are sorted by position.
//!
//! Lengths are in mm, areas in plan in mm2. Cost: n log n for n facets and samples. Samples
//! that lie inside another body of the mesh, or stand on one, are left out.

use std::collections::{BTreeMap, BTreeSet};

use grainpath_core::DisjointSets;
use grainpath_core::buckets::PointGrid3;
use grainpath_core::bvh::Bvh;
use grainpath_core::math::sin;
use grainpath_core::mesh::EdgeUses;
use grainpath_core::poly::{LineClipper, edges};
use grainpath_core::tuned::Tuned;
use grainpath_core::{DVec2, DVec3, LayerStack, Polygon, Region, TriMesh};
use grainpath_io::PaintedSupports;
use rayon::prelude::*;

use super::contact::{Contact, ContactGrid, Reason, Sample};
use super::{SupportSettings, interface};

/// A facet counts as upright if the sine of its lean is less than this. Source: derived. In a layer of 0.2 mm its wall
/// then steps outwards by 0.004 mm, a hundredth of a bead.
const UPRIGHT_SINE: f64 = 0.02;
/// An edge is a keel if the cosine of the angle between the normals of its facets is less than this. The facets of a
/// round surface fold less. Measured: row `support.overhang.KEEL_COS` of `cargo xtask bench constants`.
static KEEL_COS: Tuned<f64> = Tuned::new("support.overhang.KEEL_COS", 0.9);
/// A contact is dropped for others that hold its samples only if it holds fewer samples than this. Measured: row
/// `support.overhang.FEW_SAMPLES` of `cargo xtask bench constants`.
static FEW_SAMPLES: Tuned<usize> = Tuned::new("support.overhang.FEW_SAMPLES", 40);
/// A sample becomes a contact where none is nearer than this share of L. Measured: row `support.overhang.REACH_SHARE`
/// of `cargo xtask bench constants`.
static REACH_SHARE: Tuned<f64> = Tuned::new("support.overhang.REACH_SHARE", 0.49);
/// A region is narrow if its mean width is less than this many steps of the grid of samples. Source: derived. A strip wider
/// than the diagonal of a cell, the square root of 2, holds a point of the grid wherever it lies.
const NARROW: f64 = std::f64::consts::SQRT_2;
/// A contact counts for a piece in mid-air if it lies within this many layers of its underside. Source: derived.
/// Contacts lie on facets that cut a layer anywhere in its height, and its neighbours above and below.
const AROUND_LAYERS: f64 = 1.5;
/// Contacts of a piece in mid-air are at least this far apart, in spacings of contacts. Measured: row
/// `support.overhang.MID_AIR_APART` of `cargo xtask bench constants`.
static MID_AIR_APART: Tuned<f64> = Tuned::new("support.overhang.MID_AIR_APART", 0.9);
/// Places for more contacts of a piece in mid-air are tried this far apart, in spacings of contacts. Measured: row
/// `support.overhang.MID_AIR_STEP` of `cargo xtask bench constants`.
static MID_AIR_STEP: Tuned<f64> = Tuned::new("support.overhang.MID_AIR_STEP", 0.5);

/// A piece of a layer with nothing below it.
#[derive(Debug, Clone, PartialEq)]
pub struct MidAir {
    /// Index of the layer.
    pub layer_idx: usize,
    /// Outline of the piece in that layer.
    pub polygon: Polygon,
}

/// The overhangs of a part and the contacts that hold them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overhangs {
    /// Facets that lean by more than the critical angle, by index into the mended mesh.
    pub facets: Vec<u32>,
    /// Number of connected groups of these facets that are held.
    pub regions: usize,
    /// Number of groups that are left out because they are smaller than a bead or two.
    pub small: usize,
    /// Sample points of all overhangs that need support.
    pub samples: Vec<Sample>,
    /// Pieces of layers with nothing below them.
    pub mid_air: Vec<MidAir>,
    /// The contacts.
    pub contacts: Vec<Contact>,
    /// Lines on the surface of flat overhangs, below which interface beads are laid.
    pub lines: Vec<Vec<DVec3>>,
}

/// Finds overhangs and places contacts.
pub fn find(mesh: &TriMesh, stack: &LayerStack, settings: &SupportSettings) -> Overhangs {
    let mut out = Overhangs::default();
    let plate_mm = stack.layers().first().map_or(0.0, |l| l.z_top_mm()) + 1e-6;
    let normals: Vec<DVec3> = mesh.triangles.iter().map(|&t| mesh.normal(t)).collect();
    let steep = sin(settings.critical_angle_rad);
    let mut listed: Vec<Option<bool>> = vec![None; mesh.triangles.len()];
    for (facets, held) in [(&settings.enforce_facets, true), (&settings.block_facets, false)] {
        for &t in facets {
            if let Some(slot) = listed.get_mut(t as usize) {
                *slot = Some(held);
            }
        }
    }
    let painted = Painted::new(mesh, &settings.painted);
    let beyond = |t: usize| -> bool {
        let middle = middle(mesh, t as u32);
        let beyond = -normals[t].z > steep || (-normals[t].z > UPRIGHT_SINE && settings.enforced(middle));
        listed[t].unwrap_or(beyond && !settings.blocked(middle))
    };
    let hangs = |t: usize| {
        let high = mesh.triangles[t].iter().map(|&i| mesh.vertices[i as usize].z).fold(0.0, f64::max);
        let wanted = beyond(t) || painted.on.contains_key(&(t as u32));
        high > plate_mm && wanted && normals[t].z < -UPRIGHT_SINE
    };
    let hanging: Vec<bool> = (0..mesh.triangles.len()).into_par_iter().map(hangs).collect();
    // At each point, paint overrides the angle of the facet.
    let held_at = |t: u32, p: DVec3| {
        Painted::covers(&painted.enforcers, p)
            || (beyond(t as usize) && !Painted::covers(&painted.blockers, p))
    };
    let edges = EdgeUses::count(mesh);
    let region = regions(mesh, &edges, &hanging);
    out.facets = (0..mesh.triangles.len() as u32).filter(|&t| hanging[t as usize]).collect();
    let pitch = settings.sample_mm();
    let mut groups: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &t in &out.facets {
        groups.entry(region[t as usize]).or_default().push(t);
    }
    let groups: Vec<Vec<u32>> = groups.into_values().collect();
    let sampled: Vec<Option<Vec<Sample>>> = groups
        .par_iter()
        .map(|g| sample_region(mesh, &normals, g, pitch, settings, &held_at, &painted))
        .collect();
    // Each sample keeps the number of its group, so that contacts never hold samples of another group.
    let mut samples: Vec<(u32, Reason, Sample)> = Vec::new();
    for (i, group) in sampled.into_iter().enumerate() {
        match group {
            Some(group) => samples.extend(group.into_iter().map(|s| (i as u32, Reason::Facets, s))),
            None => out.small += 1,
        }
    }
    let edge_samples = leaning_edges(mesh, &edges, &normals, &hanging, plate_mm, pitch, settings);
    samples.extend(edge_samples.into_iter().map(|s| (u32::MAX, Reason::Edge, s)));
    let held = outside_only(&samples, stack);
    let samples: Vec<_> = samples.into_iter().zip(held).filter_map(|(s, keep)| keep.then_some(s)).collect();
    let samples = by_place(samples);
    let mut kept: Vec<u32> = samples.iter().filter(|s| s.1 == Reason::Facets).map(|s| s.0).collect();
    kept.dedup();
    out.regions = kept.len();
    let grids = grids(&samples, stack, settings);
    out.contacts = place(&samples, &grids, settings);
    if settings.interface_lines {
        let facets = samples.iter().filter(|(_, reason, _)| *reason == Reason::Facets);
        let facets: Vec<interface::Point> = facets
            .map(|(group, _, s)| interface::Point {
                group: *group,
                at: s.at,
                is_flat: interface::is_flat(s, stack, settings),
            })
            .collect();
        out.lines = interface::lines(&facets, &grids, settings);
    }
    out.samples = samples.into_iter().map(|s| s.2).collect();
    out
}

/// Support enforcers and blockers painted on the part, indexed by position.
struct Painted<'a> {
    facets: &'a PaintedSupports,
    enforcers: Bvh,
    blockers: Bvh,
    /// Indices of the painted enforcers that lie on each facet of the part.
    on: BTreeMap<u32, Vec<u32>>,
}

impl<'a> Painted<'a> {
    /// Painted facets are at most this far from the surface, mm. Source: derived. Files keep six digits, so points of up to
    /// a metre are rounded by up to 0.0005 mm in each of three axes, once in the surface and once in the painted copy.
    const NEAR_MM: f64 = 2e-3;

    fn new(mesh: &TriMesh, facets: &'a PaintedSupports) -> Self {
        let mut on: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        if !facets.enforcers.triangles.is_empty() {
            let surface = Bvh::new(mesh);
            for enforcer in 0..facets.enforcers.triangles.len() as u32 {
                let under = surface.closest_point(middle(&facets.enforcers, enforcer), Self::NEAR_MM);
                if let Some(under) = under {
                    on.entry(under.triangle).or_default().push(enforcer);
                }
            }
        }
        Self { facets, enforcers: Bvh::new(&facets.enforcers), blockers: Bvh::new(&facets.blockers), on }
    }

    fn covers(facets: &Bvh, p: DVec3) -> bool {
        facets.closest_point(p, Self::NEAR_MM).is_some()
    }

    /// Adds a sample in the middle of each enforcer that the grid of samples missed, at most one to a cell.
    fn add_missed(&self, facets: &[u32], normals: &[DVec3], pitch_mm: f64, samples: &mut Vec<Sample>) {
        if self.on.is_empty() {
            return;
        }
        let cell = |p: DVec3| (p / pitch_mm).round().to_array().map(|v| v as i64);
        let mut seen: BTreeSet<[i64; 3]> = samples.iter().map(|s| cell(s.at)).collect();
        for t in facets {
            for &enforcer in self.on.get(t).into_iter().flatten() {
                let at = middle(&self.facets.enforcers, enforcer);
                if seen.insert(cell(at)) {
                    samples.push(Sample { at, normal: normals[*t as usize], area_mm2: pitch_mm * pitch_mm });
                }
            }
        }
    }
}

fn middle(mesh: &TriMesh, triangle: u32) -> DVec3 {
    mesh.triangles[triangle as usize].iter().map(|&i| mesh.vertices[i as usize]).sum::<DVec3>() / 3.0
}

/// Joins hanging facets that share an edge into groups. Each facet gets the lowest facet index of its group.
fn regions(mesh: &TriMesh, edges: &EdgeUses, hanging: &[bool]) -> Vec<u32> {
    let mut groups = DisjointSets::new(mesh.triangles.len());
    for edge in edges.edges() {
        let mut first = None;
        for (t, _) in edge.filter(|&(t, _)| hanging[t]) {
            groups.union(*first.get_or_insert(t), t);
        }
    }
    groups.names()
}

/// A contact is dropped if other contacts lie within this share of the longest unsupported length from everything that it
/// holds. Measured: row `support.overhang.THIN_SHARE` of `cargo xtask bench constants`.
static THIN_SHARE: Tuned<f64> = Tuned::new("support.overhang.THIN_SHARE", 0.4);
/// Samples are taken for the same point if they are nearer than this, mm. Source: derived. Rounding in the plane of a facet
/// moves a sample by less than 1e-10 mm; coordinates are written with four digits.
const SAME_MM: f64 = 1e-5;

/// Sorts the samples of each group by position, and the groups by their first sample. Each position is kept once, with the
/// normal that points down most.
fn by_place(mut samples: Vec<(u32, Reason, Sample)>) -> Vec<(u32, Reason, Sample)> {
    let place = |s: &Sample| (s.at / SAME_MM).round().to_array().map(|v| v as i64);
    let steepness = |s: &Sample| s.normal.to_array().map(|v| (v * 1e9).round() as i64);
    samples.iter_mut().for_each(|(_, _, s)| s.at.z = (s.at.z / SAME_MM).round() * SAME_MM);
    samples.sort_by_key(|(group, _, s)| (*group, place(s), steepness(s)[2], steepness(s)));
    samples.dedup_by(|a, b| a.0 == b.0 && place(&a.2) == place(&b.2));
    let mut groups: Vec<Vec<(u32, Reason, Sample)>> =
        samples.chunk_by(|a, b| a.0 == b.0).map(<[_]>::to_vec).collect();
    groups.sort_by_key(|g| (g[0].0 == u32::MAX, place(&g[0].2), g.len()));
    let named = groups.into_iter().enumerate().flat_map(|(name, group)| {
        group.into_iter().map(move |(g, reason, s)| (if g == u32::MAX { g } else { name as u32 }, reason, s))
    });
    named.collect()
}

/// The side of the line from `u` to `v` on which `p` lies, as a sign. Swapping `u` and `v` changes nothing but the sign,
/// so that no point on the edge between two facets is missed.
fn side(u: DVec2, v: DVec2, p: DVec2) -> f64 {
    let forwards = (u.x, u.y) <= (v.x, v.y);
    let (a, b) = if forwards { (u, v) } else { (v, u) };
    let twice_area = (b - a).perp_dot(p - a);
    if forwards { twice_area } else { -twice_area }
}

/// Samples of a region at every crossing of a grid in plan, and along its middle where it is narrower than the grid; `None`
/// for a region too small to need support.
fn sample_region(
    mesh: &TriMesh,
    normals: &[DVec3],
    facets: &[u32],
    pitch_mm: f64,
    settings: &SupportSettings,
    held_at: &(impl Fn(u32, DVec3) -> bool + Sync),
    painted: &Painted<'_>,
) -> Option<Vec<Sample>> {
    let corner = |i: u32| mesh.vertices[i as usize];
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let mut total = 0.0;
    let mut samples = Vec::new();
    let mut largest = (0.0, 0u32);
    for &t in facets {
        let [a, b, c] = mesh.triangles[t as usize].map(corner);
        let n = normals[t as usize];
        let (lo, hi) = (a.min(b).min(c).truncate(), a.max(b).max(c).truncate());
        (low, high) = (low.min(lo), high.max(hi));
        let area = 0.5 * (b - a).truncate().perp_dot((c - a).truncate()).abs();
        total += area;
        if area > largest.0 {
            largest = (area, t);
        }
        let (i0, i1) = ((lo.x / pitch_mm).ceil() as i64, (hi.x / pitch_mm).floor() as i64);
        let (j0, j1) = ((lo.y / pitch_mm).ceil() as i64, (hi.y / pitch_mm).floor() as i64);
        for j in j0..=j1 {
            for i in i0..=i1 {
                let p = DVec2::new(i as f64, j as f64) * pitch_mm;
                let inside = [(a, b), (b, c), (c, a)].into_iter().all(|(u, v)| {
                    // Seen from above, a facet that looks down runs clockwise.
                    side(u.truncate(), v.truncate(), p) <= 0.0
                });
                if inside && n.z < -1e-6 {
                    let z = a.z - (n.x * (p.x - a.x) + n.y * (p.y - a.y)) / n.z;
                    let z = z.clamp(a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
                    let at = p.extend(z);
                    if held_at(t, at) {
                        samples.push(Sample { at, normal: n, area_mm2: pitch_mm * pitch_mm });
                    }
                }
            }
        }
    }
    painted.add_missed(facets, normals, pitch_mm, &mut samples);
    let rim = rim(mesh, facets);
    let rim_mm: f64 = rim.iter().map(|(_, [a, b])| a.truncate().distance(b.truncate())).sum();
    // A strip of width w and length l has the area w l and a rim of about 2 l.
    if 2.0 * total < NARROW * pitch_mm * rim_mm {
        let along_middle = along_middle(mesh, normals, &rim, pitch_mm);
        samples.extend(along_middle.filter(|(t, s)| held_at(*t, s.at)).map(|(_, sample)| sample));
        let n = samples.len() as f64;
        samples.iter_mut().for_each(|s| s.area_mm2 = total / n);
    }
    if samples.is_empty() {
        let t = mesh.triangles[largest.1 as usize];
        let at = t.map(corner).into_iter().sum::<DVec3>() / 3.0;
        if held_at(largest.1, at) {
            samples.push(Sample { at, normal: normals[largest.1 as usize], area_mm2: total });
        }
    }
    let small = (high - low).max_element() < settings.min_overhang_mm;
    if small && !samples.iter().any(|s| Painted::covers(&painted.enforcers, s.at)) {
        return None;
    }
    samples.retain(|s| !settings.blocked(s.at) || Painted::covers(&painted.enforcers, s.at));
    Some(samples)
}

/// The edges of a group of facets that only one of them has, each with that facet.
fn rim(mesh: &TriMesh, facets: &[u32]) -> Vec<(u32, [DVec3; 2])> {
    let sides = |&t: &u32| {
        let [a, b, c] = mesh.triangles[t as usize];
        [[a, b], [b, c], [c, a]].map(|[u, v]| ([u.min(v), u.max(v)], t))
    };
    let mut sides: Vec<([u32; 2], u32)> = facets.iter().flat_map(sides).collect();
    sides.sort_unstable();
    let single = sides.chunk_by(|a, b| a.0 == b.0).filter(|uses| uses.len() == 1);
    single.map(|uses| (uses[0].1, uses[0].0.map(|i| mesh.vertices[i as usize]))).collect()
}

/// Samples half-way from the `rim` of a narrow group of facets to the opposite corners of its facets, which is the middle
/// of a strip, a grid step apart. Each comes with its facet; its area is left to the caller.
fn along_middle(
    mesh: &TriMesh,
    normals: &[DVec3],
    rim: &[(u32, [DVec3; 2])],
    pitch_mm: f64,
) -> impl Iterator<Item = (u32, Sample)> {
    rim.iter().flat_map(move |&(t, [a, b])| {
        let corners = mesh.triangles[t as usize].map(|i| mesh.vertices[i as usize]);
        let opposite = corners.into_iter().find(|c| *c != a && *c != b).unwrap_or(a);
        // Half-way to a corner, distances are half of those along the rim.
        let length_mm = 0.5 * a.truncate().distance(b.truncate());
        let n = ((length_mm / pitch_mm).ceil() as usize).clamp(1, 100_000);
        (0..n).map(move |i| {
            let at = a.lerp(b, (i as f64 + 0.5) / n as f64).midpoint(opposite);
            (t, Sample { at, normal: normals[t as usize], area_mm2: 0.0 })
        })
    })
}

/// Samples on keels: edges that lean beyond the critical angle, between two downward-facing facets that do not.
fn leaning_edges(
    mesh: &TriMesh,
    edges: &EdgeUses,
    normals: &[DVec3],
    hanging: &[bool],
    plate_mm: f64,
    pitch_mm: f64,
    settings: &SupportSettings,
) -> Vec<Sample> {
    let upright = grainpath_core::math::cos(settings.critical_angle_rad);
    let mut out = Vec::new();
    for edge in edges.edges() {
        let uses: Vec<(usize, bool)> = edge.collect();
        let [(s, down), (t, _)] = uses[..] else { continue };
        if hanging[s] || hanging[t] || normals[s].z > -UPRIGHT_SINE || normals[t].z > -UPRIGHT_SINE {
            continue;
        }
        let [mut a, mut b] = shared(mesh.triangles[s], mesh.triangles[t]).map(|i| mesh.vertices[i as usize]);
        if down {
            std::mem::swap(&mut a, &mut b);
        }
        let along = b - a;
        // A keel folds outwards, and more sharply than the facets of a round surface.
        let folds = normals[s].dot(normals[t]) < KEEL_COS.value();
        let third = mesh.triangles[t].iter().map(|&i| mesh.vertices[i as usize]);
        let outwards = third
            .map(|p| (p - a).dot(normals[s]))
            .fold(0.0, |x: f64, y| if y.abs() > x.abs() { y } else { x })
            < 0.0;
        let high = a.z.max(b.z) > plate_mm;
        if !folds || !outwards || !high || along.z.abs() > upright * along.length() || along.length() < 1e-9 {
            continue;
        }
        let n = ((along.length() / pitch_mm).ceil() as usize).min(100_000);
        let look = (normals[s] + normals[t]).normalize_or(-DVec3::Z);
        for i in 0..=n {
            let at = a + along * (i as f64 / n as f64);
            if at.z > plate_mm && !settings.blocked(at) {
                out.push(Sample { at, normal: look, area_mm2: 0.0 });
            }
        }
    }
    out
}

fn shared(s: [u32; 3], t: [u32; 3]) -> [u32; 2] {
    let mut both = s.into_iter().filter(|i| t.contains(i));
    let first = both.next().unwrap_or(s[0]);
    [first, both.next().unwrap_or(first)]
}

/// Marks the samples that have the part just above them and air just below. The others lie inside another body, stand on
/// one, or belong to facets wound the wrong way.
fn outside_only(samples: &[(u32, Reason, Sample)], stack: &LayerStack) -> Vec<bool> {
    let layers = stack.layers();
    let middles: Vec<f64> = layers.iter().map(|l| l.z_top_mm() - 0.5 * l.height_mm()).collect();
    let mut queries: Vec<(usize, usize, bool)> = Vec::with_capacity(2 * samples.len());
    for (i, (_, _, s)) in samples.iter().enumerate() {
        let above = middles.partition_point(|&m| m < s.at.z);
        let margin = 0.25 * layers[above.min(layers.len() - 1)].height_mm();
        let above = middles.partition_point(|&m| m < s.at.z + margin);
        let below = middles.partition_point(|&m| m < s.at.z - margin);
        if above < layers.len() {
            queries.push((above, i, true));
        }
        if below > 0 {
            queries.push((below - 1, i, false));
        }
    }
    queries.sort_unstable();
    let by_layer: Vec<&[(usize, usize, bool)]> = queries.chunk_by(|a, b| a.0 == b.0).collect();
    let wrong: Vec<Vec<usize>> = by_layer
        .par_iter()
        .map(|queries| {
            let clipper = LineClipper::new(layers[queries[0].0].region());
            let out_of_place = |&&(_, i, wanted): &&(usize, usize, bool)| {
                let s = &samples[i].2;
                // The point is moved a little inwards, since a sample may lie on the edge of a wall.
                let p = s.at.truncate() - if wanted { 1e-3 * s.normal.truncate() } else { DVec2::ZERO };
                clipper.contains(p) != wanted
            };
            queries.iter().filter(out_of_place).map(|q| q.1).collect()
        })
        .collect();
    let mut keep = vec![true; samples.len()];
    wrong.into_iter().flatten().for_each(|i| keep[i] = false);
    keep
}

/// The grid of each connected overhang. Its cells are L/2 wide, and wider where interface lines run below most of it.
fn grids(
    samples: &[(u32, Reason, Sample)],
    stack: &LayerStack,
    settings: &SupportSettings,
) -> BTreeMap<u32, ContactGrid> {
    let mut groups: BTreeMap<u32, (DVec3, usize, usize)> = BTreeMap::new();
    for (g, reason, s) in samples {
        let (low, all, flat) = groups.entry(*g).or_insert((s.at, 0, 0));
        *low = low.min(s.at);
        *all += 1;
        *flat += usize::from(*reason == Reason::Facets && interface::is_flat(s, stack, settings));
    }
    let grid = |(low, all, flat): (DVec3, usize, usize)| {
        let has_lines = settings.interface_lines && 2 * flat > all;
        let cell_mm = if has_lines { interface::spacing_mm(settings) } else { settings.spacing_mm() };
        ContactGrid { low, cell_mm }
    };
    groups.into_iter().map(|(g, group)| (g, grid(group))).collect()
}

/// Chooses contacts: in each grid cell of each region, the sample nearest to the middle. A contact is dropped if others hold
/// all its samples too. Then every sample still too far from any contact becomes a contact itself.
fn place(
    samples: &[(u32, Reason, Sample)],
    grids: &BTreeMap<u32, ContactGrid>,
    settings: &SupportSettings,
) -> Vec<Contact> {
    let d = settings.spacing_mm();
    let mut cells: BTreeMap<(u32, i64, i64, i64), Vec<usize>> = BTreeMap::new();
    for (i, (g, _, s)) in samples.iter().enumerate() {
        let c = ((s.at - grids[g].low) / grids[g].cell_mm + 1e-9).floor();
        cells.entry((*g, c.x as i64, c.y as i64, c.z as i64 / 2)).or_default().push(i);
    }
    let chosen = cells.into_values().map(|members| {
        let middle = members.iter().map(|&i| samples[i].2.at).sum::<DVec3>() / members.len() as f64;
        let near = members.iter().map(|&i| (samples[i].2.at.distance_squared(middle), i));
        let best = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map_or(0, |b| b.1);
        (best, members)
    });
    // Cells with few samples come first: they lie at the rim of a region, and other contacts can replace theirs.
    let mut chosen: Vec<(usize, Vec<usize>)> = chosen.collect();
    chosen.sort_by_key(|(best, members)| (members.len(), *best));
    let mut index = PointGrid3::new(d);
    chosen.iter().for_each(|(best, _)| index.insert(samples[*best].2.at, *best));
    let near_mm = THIN_SHARE.value() * settings.max_unsupported_mm;
    let mut kept = Vec::new();
    for (best, members) in chosen {
        let others = |i: usize| {
            let p = samples[i].2.at;
            index.within(p, near_mm).any(|(_, j)| j != best && samples[j].0 == samples[i].0)
        };
        if members.len() < FEW_SAMPLES.value() && members.iter().all(|&i| others(i)) {
            index.remove(samples[best].2.at, best);
        } else {
            kept.push(best);
        }
    }
    let reach = REACH_SHARE.value() * settings.max_unsupported_mm;
    for (i, (_, _, s)) in samples.iter().enumerate() {
        if index.within(s.at, reach).next().is_none() {
            index.insert(s.at, i);
            kept.push(i);
        }
    }
    kept.sort_unstable();
    let contact = |i: usize| {
        let (_, reason, s) = samples[i];
        Contact { at: s.at, normal: s.normal, area_mm2: 0.0, reason, tip_mm: 0.0 }
    };
    let mut contacts: Vec<Contact> = kept.iter().map(|&i| contact(i)).collect();
    let mut index = PointGrid3::new(d);
    contacts.iter().enumerate().for_each(|(k, c)| index.insert(c.at, k));
    for (_, _, s) in samples {
        if let Some(k) = index.nearest_within(s.at, 0.5 * settings.max_unsupported_mm) {
            contacts[k].area_mm2 += s.area_mm2;
        }
    }
    contacts
}

/// Pieces of layers that begin in mid-air, except those at places for which `left_alone` is true.
pub(crate) fn mid_air(stack: &LayerStack, left_alone: impl Fn(DVec3) -> bool + Sync) -> Vec<MidAir> {
    let layers = stack.layers();
    let first = layers.iter().position(|l| !l.region().is_empty()).unwrap_or(0).max(1);
    let of_layer = |k: usize| -> Vec<MidAir> {
        let below = layers[k - 1].region();
        let clipper = LineClipper::new(below);
        let z = layers[k].z_top_mm() - layers[k].height_mm();
        let floats = |p: &&Polygon| {
            if p.outer.iter().any(|&v| clipper.contains(v)) {
                return false;
            }
            let inner = inner_point(p);
            if left_alone(inner.extend(z)) {
                return false;
            }
            // If no edge crosses the layer below, that layer holds the whole piece, lies within it or is apart from it. Most
            // pieces in mid-air are apart, and need no intersection with the whole layer below: on a skull in layers of
            // 0.2 mm these took 2 % of slicing.
            let crosses = edges(&p.outer).any(|(a, b)| clipper.meets(a, b));
            let bounds = p.bounds();
            let within = |q: &Polygon| q.bounds().zip(bounds).is_some_and(|(own, all)| all.union(own) == all);
            let may_overlap = crosses || clipper.contains(inner) || below.polygons.iter().any(within);
            !may_overlap || Region::from((*p).clone()).intersection(below).area_mm2() < 1e-4
        };
        let found = layers[k].region().polygons.iter().filter(floats);
        found.map(|p| MidAir { layer_idx: k, polygon: p.clone() }).collect()
    };
    let all: Vec<Vec<MidAir>> = (first..layers.len()).into_par_iter().map(of_layer).collect();
    all.into_iter().flatten().collect()
}

/// A point inside a polygon, near its middle.
pub(crate) fn inner_point(polygon: &Polygon) -> DVec2 {
    let middle = polygon.bounds().map_or(DVec2::ZERO, |b| b.centre());
    if polygon.contains(middle) {
        return middle;
    }
    // Takes the middle of the widest interval inside the polygon on the horizontal line through `middle`.
    let mut xs: Vec<f64> = Vec::new();
    for (a, b) in polygon.contours().flat_map(|c| edges(c)) {
        if (a.y > middle.y) != (b.y > middle.y) {
            xs.push(a.x + (middle.y - a.y) / (b.y - a.y) * (b.x - a.x));
        }
    }
    xs.sort_by(f64::total_cmp);
    let widest = xs.chunks_exact(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    widest.map_or(polygon.outer.first().copied().unwrap_or(middle), |w| {
        DVec2::new(0.5 * (w[0] + w[1]), middle.y)
    })
}

/// Finds the pieces that begin in mid-air and gives every one a contact at its underside, and long pieces several.
pub(super) fn hold_mid_air(out: &mut Overhangs, stack: &LayerStack, settings: &SupportSettings) {
    out.mid_air = mid_air(stack, |p| settings.blocked(p));
    let d = settings.spacing_mm();
    let mut by_height: Vec<(f64, DVec2)> = out.contacts.iter().map(|c| (c.at.z, c.at.truncate())).collect();
    by_height.sort_by(|a, b| a.0.total_cmp(&b.0));
    for piece in &out.mid_air {
        let layer = &stack.layers()[piece.layer_idx];
        let (z, h) = (layer.z_top_mm() - layer.height_mm(), layer.height_mm());
        let polygon = &piece.polygon;
        let reach = settings.contact_radius_mm;
        let first = by_height.partition_point(|c| c.0 <= z - AROUND_LAYERS * h);
        let mut points: Vec<DVec2> = by_height[first..]
            .iter()
            .take_while(|c| c.0 < z + AROUND_LAYERS * h)
            .map(|c| c.1)
            .filter(|&p| polygon.contains(p) || polygon.outer.iter().any(|v| v.distance(p) < reach))
            .collect();
        if points.is_empty() {
            let p = inner_point(polygon);
            points.push(p);
            out.contacts.push(mid_air_contact(p.extend(z), polygon.area_mm2()));
        }
        let Some(bounds) = polygon.bounds() else { continue };
        let n = (bounds.size() / (MID_AIR_STEP.value() * d)).ceil();
        for j in 0..=n.y as i64 {
            for i in 0..=n.x as i64 {
                let p = bounds.min + DVec2::new(i as f64, j as f64) * MID_AIR_STEP.value() * d;
                let far = |points: &[DVec2]| points.iter().all(|q| q.distance(p) > MID_AIR_APART.value() * d);
                if far(&points) && polygon.contains(p) {
                    points.push(p);
                    out.contacts.push(mid_air_contact(p.extend(z), 0.0));
                }
            }
        }
        // Corners are tried as well, because a sliver may contain no point of the grid.
        for &p in &polygon.outer {
            if points.iter().all(|q| q.distance(p) > MID_AIR_APART.value() * d) {
                points.push(p);
                out.contacts.push(mid_air_contact(p.extend(z), 0.0));
            }
        }
    }
}

fn mid_air_contact(at: DVec3, area_mm2: f64) -> Contact {
    Contact { at, normal: -DVec3::Z, area_mm2, reason: Reason::Lowest, tip_mm: 0.0 }
}

#[cfg(test)]
mod tests {
    use grainpath_core::Layer;

    use super::*;

    #[test]
    fn pieces_over_air_are_told_from_those_that_lie_on_the_layer_below() {
        let square = |x: f64, side: f64| {
            Region::rectangle(DVec2::new(x, -0.5 * side), DVec2::new(x + side, 0.5 * side))
        };
        let bar = Region::rectangle(DVec2::new(9.0, -0.5), DVec2::new(21.0, 0.5));
        let column = Region::rectangle(DVec2::new(14.0, -5.0), DVec2::new(15.0, 5.0));
        let ring = square(10.0, 10.0).difference(&square(11.0, 8.0));
        for (what, below, above, floats) in [
            ("apart", square(0.0, 5.0), square(10.0, 10.0), true),
            ("equal", square(10.0, 10.0), square(10.0, 10.0), false),
            ("smaller than what is below", square(10.0, 10.0), square(12.0, 2.0), false),
            ("larger than what is below", square(12.0, 2.0), square(10.0, 10.0), false),
            ("crossed by what is below, no vertex in the other", bar, column, false),
            ("around what is below, without touching it", square(14.0, 2.0), ring.clone(), true),
            ("in a hole of what is below", ring, square(14.0, 2.0), true),
            ("a hundredth beside what is below", square(0.0, 9.99), square(10.0, 10.0), true),
        ] {
            let layer = |(k, region)| Layer::new(0.2 * (k + 1) as f64, 0.2, region).expect("a sound layer");
            let layers = [below, above].into_iter().enumerate().map(layer).collect();
            let stack = LayerStack::new(layers).expect("heights rise");
            assert_eq!(mid_air(&stack, |_| false).len(), usize::from(floats), "{what}");
        }
    }
}
