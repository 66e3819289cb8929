//! One section of a mesh: from crossed triangles to a region.
//!
//! Every triangle that crosses the plane gives one segment, from the side that goes down through
//! the plane to the one that goes up, so that the inside lies on its left. Each end of a segment is
//! identified by the mesh edge it lies on. Segments that share an edge are joined to closed contours
//! without comparing coordinates. A vertex on the plane counts as above it, so a plane never meets a
//! vertex, an edge or a face exactly.
//!
//! Damaged meshes leave open chains. They are joined end to start, nearest first. A chain is closed
//! on itself only when no other start is nearer than its own. Every gap that is closed is counted
//! ([`Mended`]) and reported in a warning.
//!
//! The point where an edge crosses the plane is computed from its lower vertex to its higher one,
//! so both its triangles get the same bits. Contours of all shells are united by winding number:
//! overlapping bodies do not cancel and cavities stay. Cost: linear in the crossed triangles, with
//! two exceptions. Joining open chains is quadratic in their number, and the union grows with the
//! crossings of its edges. In a mesh whose corners are mixed up, every edge of a section may cross
//! every other. A section with more crossings than [`crossing_limit`] allows is cut on a grid of
//! cells.

use grainpath_core::Bounds2;
use grainpath_core::mask::{Mask, MaskGrid};
use grainpath_core::poly::{FillRule, crosses_more_than, simplify_contour};
use grainpath_core::{Contour, DVec2, Diagnostics, Region, TriMesh, WarningId, segment};

use super::SliceSettings;

/// The triangles that each plane crosses.
pub(super) struct TrianglesByPlane {
    starts: Vec<usize>,
    triangles: Vec<u32>,
}

impl TrianglesByPlane {
    /// Sorts triangles by the planes they cross: 4 bytes for each crossing.
    pub(super) fn new(mesh: &TriMesh, planes: &[f64]) -> Self {
        // A plane is crossed when a vertex lies below it and another on or above it.
        let range = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.vertices[i as usize].z);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            (planes.partition_point(|&p| p <= low), planes.partition_point(|&p| p <= high))
        };
        // The first pass over the triangles counts and the second fills, so that no plane needs a
        // growing list.
        let mut counts = vec![0usize; planes.len() + 1];
        for t in &mesh.triangles {
            let (first, end) = range(t);
            for count in &mut counts[first..end] {
                *count += 1;
            }
        }
        let mut total = 0;
        for count in &mut counts {
            total += std::mem::replace(count, total);
        }
        let starts = counts.clone();
        let mut triangles = vec![0; total];
        for (i, t) in mesh.triangles.iter().enumerate() {
            let (first, end) = range(t);
            for next in &mut counts[first..end] {
                triangles[*next] = i as u32;
                *next += 1;
            }
        }
        Self { starts, triangles }
    }

    /// The triangles that plane `i` crosses, in the mesh's order.
    pub(super) fn triangles(&self, i: usize) -> &[u32] {
        &self.triangles[self.starts[i]..self.starts[i + 1]]
    }
}

/// Gaps that were closed in sections.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Mended {
    gaps: usize,
    layers: usize,
    widest_mm: f64,
    /// Open contours that were left out of sections with more than [`MAX_OPEN_CHAINS`].
    left_out: usize,
    /// Sections that were cut on a grid of cells.
    gridded: usize,
}

impl Mended {
    /// Adds the counts of another section.
    pub(super) fn add(&mut self, other: &Self) {
        self.gaps += other.gaps;
        self.layers += usize::from(other.gaps > 0);
        self.widest_mm = self.widest_mm.max(other.widest_mm);
        self.left_out += other.left_out;
        self.gridded += other.gridded;
    }

    /// Warns if any gap was closed, or any contour left out.
    pub(super) fn warn(&self, diagnostics: &Diagnostics) {
        if self.gaps > 0 {
            diagnostics.warn(
                WarningId::MeshOpen,
                format!(
                    "sections: closed {} gaps up to {:.2} mm in {} layers",
                    self.gaps, self.widest_mm, self.layers
                ),
            );
        }
        if self.left_out > 0 {
            let text = format!(
                "sections: left out {} open contours of layers with more than {MAX_OPEN_CHAINS} of them",
                self.left_out
            );
            diagnostics.warn(WarningId::MeshOpen, text);
        }
        if self.gridded > 0 {
            diagnostics.warn(
                WarningId::MeshTangled,
                format!(
                    "sections: the surface crosses itself so often in {} layers that they were cut on a grid of cells",
                    self.gridded
                ),
            );
        }
    }
}

/// The mesh edge on which a triangle's side crosses the plane; both its triangles use the same key.
type EdgeKey = u64;

/// A piece of contour inside one triangle. It runs from the side that goes down through the plane
/// to the side that goes up, so that the inside lies on the left.
struct Segment {
    from: EdgeKey,
    to: EdgeKey,
    start: DVec2,
    end: DVec2,
}

/// The region a plane cuts from a mesh, given the triangles it crosses.
pub(super) fn section(
    mesh: &TriMesh,
    triangles: &[u32],
    z: f64,
    settings: &SliceSettings,
) -> (Region, Mended) {
    let segments: Vec<Segment> =
        triangles.iter().filter_map(|&t| segment(mesh, mesh.triangles[t as usize], z)).collect();
    let (mut closed, open) = chain(&segments);
    let mut mended = join(open, settings.gap_closing_mm, &mut closed);
    let contours: Vec<Contour> =
        closed.iter().map(|c| simplified(c, settings.simplify_mm)).filter(|c| c.len() > 2).collect();
    if contours.is_empty() {
        return (Region::default(), mended);
    }
    let limit = crossing_limit(contours.iter().map(Vec::len).sum());
    let mut region = if crosses_more_than(&contours, limit) {
        mended.gridded = 1;
        gridded(&contours)
    } else {
        Region::from_contours(&contours, FillRule::NonZero)
    };
    // Areas below a thousandth of a square millimetre cannot hold a bead and are mostly slivers
    // between bodies that touch.
    region.polygons.retain(|p| p.area_mm2() > 1e-3);
    (region, mended)
}

/// The most crossings that a section of so many edges may have to be united exactly.
///
/// Source: derived. Where bodies overlap, the outlines of two of them cross a few times. Twenty crossings for every edge
/// occur only where ten other bodies overlap the whole section. The constant lets small sections through, for which even
/// testing all pairs is little work.
pub(super) const fn crossing_limit(n_edges: usize) -> usize {
    20 * n_edges + 10_000
}

/// Side of the cells on which a tangled section is cut, mm. Source: derived. A quarter of the usual bead (0.4 mm), so that
/// the detail that is lost is too narrow to be printed.
const CELL_MM: f64 = 0.1;

/// The cells that closed lines wind around, as a region. The work is bounded, however often the lines cross.
fn gridded(contours: &[Contour]) -> Region {
    let Some(bounds) = Bounds2::around_points(contours.iter().flatten().copied()) else {
        return Region::default();
    };
    let mask = Mask::wound(MaskGrid::over(bounds, CELL_MM), contours);
    Region::from_contours(&mask.contours(), FillRule::NonZero)
}

/// Largest tolerance of simplification as a share of a contour's extent. Simplifying a round outline
/// always cuts it on the same side, so with a larger tolerance small holes and screws would lose size.
const MAX_SIMPLIFY_SHARE: f64 = 1e-3;

/// Distance from a straight line below which a vertex lies on it, mm. Source: derived; some hundred times the rounding of
/// coordinates of 1 m (2e-13 mm), and far less than the last digit of any mesh file.
const ON_LINE_MM: f64 = 1e-10;

fn simplified(contour: &[DVec2], tolerance_mm: f64) -> Contour {
    let extent_mm =
        Bounds2::around_points(contour.iter().copied()).map_or(0.0, |b| (b.max - b.min).max_element());
    simplify_contour(&straightened(contour), tolerance_mm.min(MAX_SIMPLIFY_SHARE * extent_mm))
}

/// A contour without the vertices on straight lines between their neighbours, where an edge divides a flat face. They move
/// with the height of the plane, and simplification might keep one: all points of a side may be equally far from a chord
/// that is parallel to it. Layers of a prism would then differ, and none could be copied.
fn straightened(contour: &[DVec2]) -> Contour {
    let mut kept: Contour = Vec::with_capacity(contour.len());
    for (i, &p) in contour.iter().enumerate() {
        let (before, after) = (kept.last().or(contour.last()), contour[(i + 1) % contour.len()]);
        let on_line = |&a: &DVec2| segment::distance_squared_mm2(p, a, after) < ON_LINE_MM * ON_LINE_MM;
        if !before.is_some_and(on_line) {
            kept.push(p);
        }
    }
    kept
}

fn segment(mesh: &TriMesh, triangle: [u32; 3], z: f64) -> Option<Segment> {
    let above = triangle.map(|i| mesh.vertices[i as usize].z >= z);
    let (mut from, mut to) = (None, None);
    for k in 0..3 {
        let next = (k + 1) % 3;
        if above[k] != above[next] {
            let crossing = crossing(mesh, triangle[k], triangle[next], z);
            if above[k] { from = Some(crossing) } else { to = Some(crossing) }
        }
    }
    let ((from, start), (to, end)) = (from?, to?);
    Some(Segment { from, to, start, end })
}

/// The edge between two vertices and the point where it crosses the plane. The point is computed from
/// the vertex of the lower index, so that both triangles of the edge get the same bits.
fn crossing(mesh: &TriMesh, a: u32, b: u32, z: f64) -> (EdgeKey, DVec2) {
    let (low, high) = (a.min(b), a.max(b));
    let (p, q) = (mesh.vertices[low as usize], mesh.vertices[high as usize]);
    let t = (z - p.z) / (q.z - p.z);
    (u64::from(low) << 32 | u64::from(high), p.truncate().lerp(q.truncate(), t))
}

/// Follows segments from edge to edge. Returned are closed contours, and open chains where a
/// neighbour is missing.
fn chain(segments: &[Segment]) -> (Vec<Contour>, Vec<Contour>) {
    let starts = Starts::new(segments);
    let ends = |s: &Segment| starts.find(s.to, |_| true).is_some();
    let mut used = vec![false; segments.len()];
    let (mut closed, mut open) = (Vec::new(), Vec::new());
    // Open chains are followed before closed ones, each from its first segment. A walk that started
    // in the middle of an open chain would split it.
    let mut follow = |seed: usize, used: &mut Vec<bool>| {
        let mut line = vec![segments[seed].start];
        let mut at = seed;
        loop {
            used[at] = true;
            let s = &segments[at];
            if s.to == segments[seed].from {
                closed.push(line);
                return;
            }
            line.push(s.end);
            match starts.find(s.to, |i| !used[i]) {
                Some(next) => at = next,
                None => {
                    open.push(line);
                    return;
                }
            }
        }
    };
    if !segments.iter().all(ends) {
        let mut incoming: Vec<EdgeKey> = segments.iter().map(|s| s.to).collect();
        incoming.sort_unstable();
        for i in 0..segments.len() {
            if !used[i] && incoming.binary_search(&segments[i].from).is_err() {
                follow(i, &mut used);
            }
        }
    }
    for i in 0..segments.len() {
        if !used[i] {
            follow(i, &mut used);
        }
    }
    (closed, open)
}

/// A hash table of segments by the edge they start at. It uses open addressing, and several segments
/// may share a key.
struct Starts<'a> {
    segments: &'a [Segment],
    slots: Vec<u32>,
}

impl<'a> Starts<'a> {
    fn new(segments: &'a [Segment]) -> Self {
        let mut table = Self { segments, slots: vec![u32::MAX; (2 * segments.len()).next_power_of_two()] };
        for (i, s) in segments.iter().enumerate() {
            let mut slot = table.slot(s.from);
            while table.slots[slot] != u32::MAX {
                slot = (slot + 1) & (table.slots.len() - 1);
            }
            table.slots[slot] = i as u32;
        }
        table
    }

    fn slot(&self, key: EdgeKey) -> usize {
        // The odd constant of Fibonacci hashing spreads keys that differ in a few low bits.
        let h = key.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (h >> 32) as usize & (self.slots.len() - 1)
    }

    fn find(&self, key: EdgeKey, allowed: impl Fn(usize) -> bool) -> Option<usize> {
        let mut slot = self.slot(key);
        loop {
            match self.slots[slot] {
                u32::MAX => return None,
                i if self.segments[i as usize].from == key && allowed(i as usize) => return Some(i as usize),
                _ => slot = (slot + 1) & (self.slots.len() - 1),
            }
        }
    }
}

/// Largest number of open chains of a section; further ones are left out. Source: derived. All pairs of an end and a
/// start are sorted and take 16 bytes each, 16 MB in all.
const MAX_OPEN_CHAINS: usize = 1000;

/// Sections with more open chains than this count as heavily damaged. Source: derived. The pairs of 200 chains take 0.6 MB
/// and a few milliseconds to sort.
const CLOSED_WITHOUT_SEARCH: usize = 200;

/// Joins open chains end to start, nearest first, until all are closed. A chain is closed on itself only when no
/// other start is nearer than its own.
///
/// All pairs are sorted only once, because joining two chains does not move their free start and end.
fn join(mut open: Vec<Contour>, gap_closing_mm: f64, closed: &mut Vec<Contour>) -> Mended {
    let mut mended = Mended::default();
    open.retain(|c| c.len() > 1);
    // The search for pairs is quadratic. In heavily damaged sections a chain whose own ends are near each other is
    // closed on itself without that search, and the number of the others is bounded.
    if open.len() > CLOSED_WITHOUT_SEARCH {
        let width_mm = |c: &Contour| c[0].distance(c[c.len() - 1]);
        for chain in open.extract_if(.., |c| width_mm(c) <= gap_closing_mm) {
            mended.gaps += 1;
            mended.widest_mm = mended.widest_mm.max(width_mm(&chain));
            closed.push(chain);
        }
        mended.left_out += open.len().saturating_sub(MAX_OPEN_CHAINS);
        open.truncate(MAX_OPEN_CHAINS);
    }
    let mut pairs: Vec<(f64, u32, u32)> = Vec::with_capacity(open.len() * open.len());
    for (end, a) in (0u32..).zip(&open) {
        let last = a[a.len() - 1];
        pairs.extend((0u32..).zip(&open).map(|(start, b)| (last.distance_squared(b[0]), end, start)));
    }
    pairs.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    // A chain is identified by its start. `end_of` gives the end of a chain, `chain_of` the chain of an end.
    let mut end_of: Vec<usize> = (0..open.len()).collect();
    let mut chain_of: Vec<usize> = (0..open.len()).collect();
    let (mut end_taken, mut start_taken) = (vec![false; open.len()], vec![false; open.len()]);
    for (d2, end, start) in pairs {
        let (end, start) = (end as usize, start as usize);
        if end_taken[end] || start_taken[start] {
            continue;
        }
        (end_taken[end], start_taken[start]) = (true, true);
        mended.gaps += 1;
        mended.widest_mm = mended.widest_mm.max(d2.sqrt());
        let chain = chain_of[end];
        let tail = std::mem::take(&mut open[start]);
        if chain == start {
            closed.push(tail);
        } else {
            open[chain].extend(tail);
            end_of[chain] = end_of[start];
            chain_of[end_of[start]] = chain;
        }
    }
    mended
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use grainpath_core::DVec3;
    use grainpath_core::hash::splitmix64;
    use grainpath_core::math::sin_cos;

    use super::*;

    /// A torus of 3600 triangles.
    fn torus() -> TriMesh {
        let (n, m) = (60, 30);
        let mut mesh = TriMesh::default();
        for i in 0..n {
            for j in 0..m {
                let (s, c) = sin_cos(TAU * f64::from(i) / f64::from(n));
                let (t, u) = sin_cos(TAU * f64::from(j) / f64::from(m));
                let r = 15.0 + 6.0 * u;
                mesh.vertices.push(DVec3::new(r * c, r * s, 6.0 + 6.0 * t));
                let at = |i: i32, j: i32| ((i % n) * m + j % m) as u32;
                let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                mesh.triangles.push([quad[0], quad[1], quad[2]]);
                mesh.triangles.push([quad[0], quad[2], quad[3]]);
            }
        }
        mesh
    }

    #[test]
    fn sections_of_a_prism_are_equal_at_every_height() {
        // Two arcs joined by straight sides, as of a lever: the sides are parallel to the chord between the ends.
        let half = |sign: f64| (0..=40).map(move |k| (sign, 0.5 * TAU * f64::from(k) / 40.0));
        let points = |turn: f64| -> Vec<DVec2> {
            let at = |(sign, a): (f64, f64)| {
                let (s, c) = sin_cos(a);
                DVec2::from_angle(turn).rotate(DVec2::new(sign * (30.0 + 12.0 * s), -sign * 12.0 * c))
            };
            half(1.0).chain(half(-1.0)).map(at).collect()
        };
        let settings = SliceSettings {
            layer_height_mm: 0.3,
            first_layer_height_mm: 0.3,
            simplify_mm: 0.01,
            adaptive: None,
            gap_closing_mm: 0.1,
        };
        for degrees in [0.0, 37.0, 90.0] {
            let outer = points(f64::to_radians(degrees));
            let region = Region { polygons: vec![grainpath_core::Polygon { outer, holes: Vec::new() }] };
            let mut mesh = TriMesh::default();
            assert!(crate::shape::outline::prism(&region, 0.0, 8.0, &mut mesh).is_ok());
            let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
            let at = |z: f64| section(&mesh, &all, z, &settings).0;
            let first = at(0.15);
            assert!(first.area_mm2() > 1000.0, "{degrees}");
            for k in 1..26 {
                assert_eq!(at(0.15 + 0.3 * f64::from(k)), first, "{degrees} degrees, layer {k}");
            }
        }
    }

    /// A mesh as a damaged file gives it: corners shifted, shuffled or torn off, coordinates wrong, faces repeated.
    fn mutated(seed: u64) -> TriMesh {
        let mut mesh = torus();
        let mut draw = (0u64..).map(|k| splitmix64(seed.wrapping_mul(1_000_003).wrapping_add(k)));
        let mut below = |n: usize| (draw.next().unwrap_or(0) % n as u64) as usize;
        let (n, m) = (mesh.vertices.len(), mesh.triangles.len());
        let times = [3, 30, 300, 3000][below(4)];
        match seed % 6 {
            0 => {
                let (first, by) = (below(n), 1 + below(n - 1));
                let shift =
                    |v: &mut u32| *v = if *v as usize >= first { (*v + by as u32) % n as u32 } else { *v };
                mesh.triangles.iter_mut().flatten().for_each(shift);
            }
            1 => (0..times).for_each(|_| mesh.vertices.swap(below(n), below(n))),
            2 => (0..times).for_each(|_| mesh.triangles[below(m)][below(3)] = below(n) as u32),
            3 => (0..times).for_each(|_| mesh.vertices[below(n)][below(3)] *= [10.0, 0.1, -1.0][below(3)]),
            4 => {
                // Corners of their own: every triangle is torn from its neighbours.
                for _ in 0..times {
                    let (t, k) = (below(m), below(3));
                    let moved = mesh.vertices[mesh.triangles[t][k] as usize] + 0.1 * below(9) as f64;
                    mesh.triangles[t][k] = mesh.vertices.len() as u32;
                    mesh.vertices.push(moved);
                }
            }
            _ => (0..times).for_each(|_| {
                let mut t = mesh.triangles[below(m)];
                t.rotate_left(below(3));
                t.swap(0, below(2));
                mesh.triangles.push(t);
            }),
        }
        mesh
    }

    /// Sections of 1000 damaged meshes: what is united, or cut on the grid, makes no more points than its edges and the
    /// crossings allowed.
    #[test]
    fn the_work_of_a_section_of_a_damaged_mesh_is_bounded() {
        let settings = SliceSettings {
            layer_height_mm: 0.2,
            first_layer_height_mm: 0.2,
            adaptive: None,
            gap_closing_mm: 0.05,
            simplify_mm: 0.005,
        };
        let planes = [2.05, 5.9, 9.3];
        let mut tangled = 0;
        for seed in 0..1000 {
            let mesh = mutated(seed);
            let crossed = TrianglesByPlane::new(&mesh, &planes);
            for (i, &z) in planes.iter().enumerate() {
                let triangles = crossed.triangles(i);
                let (region, mended) = section(&mesh, triangles, z, &settings);
                let n: usize = region.contours().map(Vec::len).sum();
                let most = triangles.len() + 2 * crossing_limit(triangles.len());
                assert!(n <= most, "mesh {seed} at {z}: {n} points from {} triangles", triangles.len());
                tangled += mended.gridded;
            }
        }
        assert!((100..2500).contains(&tangled), "{tangled} of 3000 sections were tangled");
        let (_, mended) =
            section(&torus(), TrianglesByPlane::new(&torus(), &planes).triangles(1), planes[1], &settings);
        assert_eq!(mended, Mended::default());
    }

    /// A section on the grid differs from the exact one by less than a cell along its outline.
    #[test]
    fn the_grid_keeps_the_area() {
        let contours: Vec<Contour> = vec![
            vec![DVec2::ZERO, DVec2::new(30.0, 2.0), DVec2::new(25.0, 20.0), DVec2::new(-3.0, 15.0)],
            vec![DVec2::new(20.0, 5.0), DVec2::new(40.0, 5.0), DVec2::new(40.0, 9.0), DVec2::new(20.0, 9.0)],
            vec![DVec2::new(5.0, 5.0), DVec2::new(5.0, 9.0), DVec2::new(9.0, 9.0), DVec2::new(9.0, 5.0)],
        ];
        let exact = Region::from_contours(&contours, FillRule::NonZero);
        let found = gridded(&contours);
        let mut picture = grainpath_core::failure_svg::FailurePicture::new("section on the grid");
        picture.region("exact", &exact);
        picture.region("found", &found);
        let found = found.area_mm2();
        assert!((found - exact.area_mm2()).abs() < 0.01 * exact.area_mm2(), "{found} {}", exact.area_mm2());
    }

    /// Chains in pieces and any order give back the outline they were cut from.
    #[test]
    fn pieces_of_an_outline_are_joined_in_turn() {
        let corner = |k: usize| {
            let (s, c) = sin_cos(TAU * k as f64 / 100.0);
            DVec2::new(20.0 * c, 20.0 * s)
        };
        let mut pieces: Vec<Contour> = (0..20).map(|p| (5 * p..5 * p + 5).map(corner).collect()).collect();
        (0..20).for_each(|k| pieces.swap(k, splitmix64(k as u64) as usize % 20));
        let mut closed = Vec::new();
        let mended = join(pieces, 0.05, &mut closed);
        assert_eq!((closed.len(), mended.gaps), (1, 20));
        assert!((grainpath_core::poly::signed_area_mm2(&closed[0]) - 1255.8).abs() < 1.0);
    }

    /// A large outline with a tiny gap stays whole beside hundreds of scraps.
    #[test]
    fn an_outline_of_a_heavily_damaged_section_is_kept() {
        let point = |k: usize, n: usize, radius_mm: f64, middle: DVec2| {
            let (s, c) = sin_cos(TAU * k as f64 / n as f64);
            middle + radius_mm * DVec2::new(c, s)
        };
        let outline: Contour = (0..6000).map(|k| point(k, 6000, 20.0, DVec2::ZERO)).collect();
        let scraps = |n: usize| {
            (0..n).map(|i| {
                let middle = DVec2::new(100.0 + (i % 40) as f64, (i / 40) as f64);
                (0..6).map(|k| point(k, 12, 0.3, middle)).collect::<Contour>()
            })
        };
        for (n, left_out) in [(300, 0), (1200, 200)] {
            let open: Vec<Contour> = scraps(n).chain([outline.clone()]).collect();
            let mut closed = Vec::new();
            let mended = join(open, 0.05, &mut closed);
            let largest = closed.iter().map(|c| grainpath_core::poly::signed_area_mm2(c)).fold(0.0, f64::max);
            assert!((largest - 1256.6).abs() < 1.0, "{largest}");
            assert_eq!(mended.left_out, left_out);
        }
    }
}
