//! Interpolates the stress of a result at any point.
//!
//! Inside the mesh, the shape functions of the element that holds the point weight the stresses of its nodes. Elements are
//! found by a grid of buckets. A matrix inverse gives the natural coordinates in straight simplices; Newton steps give them
//! in all other elements. Outside the mesh, the stress is that of the nearest point of the free surface, which a tree of
//! boxes finds; so stress is extrapolated as a constant. A table without elements gives the mean of the eight nearest
//! points, weighted by the inverse square of their distance.
//!
//! Cost: O(1) inside on average, O(log n) outside. The answer depends on the point alone, so any number of threads gets the
//! same bits. Degenerate cases: an element without volume is never inside; a mesh in a plane of constant z ignores z.

use grainpath_core::{Bvh, DVec3, TriMesh, math};

use super::element::ElementKind;
use super::model::Element;
use super::result::FeResult;
use super::result::free_faces;

/// Tolerance of the inside test, in natural coordinates (whose range is 1 or 2 long). Source: derived. Newton's
/// iteration ends with errors of 1e-12 or less, and 1e-9 of an element of 10 mm is a hundredth of a nanometre. A larger
/// value extrapolates elements to points outside them; with 0, rounding puts points on shared faces outside both
/// elements.
const INSIDE: f64 = 1e-9;
/// Tolerance for gaps between elements, in natural coordinates. Gaps come from curved sides taken as
/// straight and from rounding when a file was written. A point that is outside by less is moved into the
/// nearest element.
const BETWEEN: f64 = 1e-3;
/// Number of neighbours that are averaged where a result has points and no mesh. More neighbours smooth
/// peaks of stress; fewer let the spacing of the points show.
const NEIGHBOURS: usize = 8;

/// Position of a point in the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Location {
    /// Index into [`FeResult::elements`].
    pub element: u32,
    /// Natural coordinates in that element.
    pub natural: DVec3,
    /// Distance of the point outside the mesh, mm; 0 inside.
    pub distance_mm: f64,
}

/// A stress field that can be evaluated at any point. The answer depends on the point alone, so any
/// number of threads gets the same bits.
#[derive(Debug, Clone)]
pub struct StressField {
    result: FeResult,
    maps: Vec<Map>,
    elements: BoxGrid,
    /// Free faces cut into triangles. A free edge of a plane mesh is a triangle whose last two corners coincide.
    rim: Bvh,
    /// The element of each of these triangles.
    rim_elements: Vec<u32>,
    /// Nodes with a stress, for results without elements.
    points: Vec<u32>,
    point_tree: Tree,
}

/// How positions are mapped to natural coordinates of an element.
#[derive(Debug, Clone, Copy)]
enum Map {
    /// A simplex with straight sides: its first corner and the rows of the inverse.
    Straight(DVec3, [DVec3; 3]),
    /// Found by Newton steps. No point outside this box is in the element.
    Curved(DVec3, DVec3),
}

impl StressField {
    /// Builds the search structures of a result.
    pub fn new(result: FeResult) -> Self {
        let node_box = |e: &Element| box_of(e.nodes().iter().map(|&i| result.nodes[i as usize]));
        let map = |e: &Element| {
            straight(e, &result).unwrap_or_else(|| {
                let (lo, hi) = node_box(e);
                // Curved sides bulge beyond the box of their nodes. A parabola does so by at most an eighth, when its middle
                // node is at one end. In usable elements it is less than a tenth.
                let margin = DVec3::splat((0.1 * (hi - lo)).max_element());
                Map::Curved(lo - margin, hi + margin)
            })
        };
        let maps: Vec<Map> = result.elements.iter().map(map).collect();
        let boxes = result.elements.iter().zip(&maps).map(|(e, map)| match *map {
            Map::Straight(..) => node_box(e),
            Map::Curved(lo, hi) => (lo, hi),
        });
        let elements = BoxGrid::new(&boxes.collect::<Vec<_>>());
        let (triangles, rim_elements) = rim(&result).into_iter().unzip();
        let rim = Bvh::new(&TriMesh { vertices: result.nodes.clone(), triangles });
        let mut points = Vec::new();
        // The tree of points is needed only for a table without a mesh; it would double the memory of a
        // large mesh.
        if result.elements.is_empty() {
            let known = |i: &u32| result.stress[*i as usize].iter().all(|v| v.is_finite());
            points = (0..result.nodes.len() as u32).filter(known).collect();
        }
        let point_tree = Tree::new(&points.iter().map(|&i| result.nodes[i as usize]).collect::<Vec<_>>());
        Self { result, maps, elements, rim, rim_elements, points, point_tree }
    }

    /// The result that the field evaluates.
    pub fn result(&self) -> &FeResult {
        &self.result
    }

    /// The element that holds `p` (mm), or the nearest point of the mesh. `None` when there are no elements.
    pub fn locate(&self, p: DVec3) -> Option<Location> {
        let p = self.in_plane(p);
        // A shell in space has no inside. Every point goes to the nearest element instead.
        let shell = !self.result.plane && self.result.elements.first()?.kind.dimension() == 2;
        if !shell {
            let mut best: Option<(f64, Location)> = None;
            for &element in self.elements.at(p) {
                if let Map::Curved(lo, hi) = self.maps[element as usize]
                    && (p.cmplt(lo).any() || p.cmpgt(hi).any())
                {
                    continue;
                }
                let Some(natural) = self.natural(element, p) else { continue };
                let kind = self.result.elements[element as usize].kind;
                let outside = kind.outside(natural);
                // Buckets list elements in ascending order, so a point on a shared face always belongs to
                // the element with the lowest index, on every run.
                if outside <= INSIDE {
                    return Some(Location { element, natural, distance_mm: 0.0 });
                }
                // The point may lie in a gap between elements: the nearest element is remembered.
                if outside <= BETWEEN && best.as_ref().is_none_or(|b| outside < b.0) {
                    best = Some((
                        outside,
                        Location { element, natural: kind.clamped(natural), distance_mm: 0.0 },
                    ));
                }
            }
            if let Some((_, at)) = best {
                return Some(at);
            }
        }
        let nearest = self.rim.closest_point(p, f64::INFINITY)?;
        let element = self.rim_elements[nearest.triangle as usize];
        let kind = self.result.elements[element as usize].kind;
        // Free faces are cut into flat triangles, while the element's face may be curved. Two natural
        // positions are tried, from the foot point on the triangle and from the point itself; the nearer
        // one counts.
        let place = |q: DVec3| {
            let natural = kind.clamped(self.natural(element, q).unwrap_or(kind.centre()));
            Location { element, natural, distance_mm: p.distance(self.position(element, natural)) }
        };
        let (a, b) = (place(nearest.point), place(p));
        Some(if b.distance_mm < a.distance_mm { b } else { a })
    }

    /// Stress at `p` (mm) in MPa, components xx, yy, zz, xy, yz, zx. A point outside the mesh gets the
    /// stress of the nearest point of the mesh.
    pub fn sample(&self, p: DVec3) -> [f64; 6] {
        match self.locate(p) {
            Some(at) => self.stress_at(&at),
            None => self.between_points(self.in_plane(p)),
        }
    }

    /// Stress at a place in the mesh, MPa.
    pub fn stress_at(&self, at: &Location) -> [f64; 6] {
        let e = &self.result.elements[at.element as usize];
        let weights = e.kind.weights(at.natural);
        let mut s = [0.0; 6];
        for (&i, w) in e.nodes().iter().zip(weights) {
            for (to, v) in s.iter_mut().zip(self.result.stress[i as usize]) {
                *to += w * v;
            }
        }
        s
    }

    /// Displacement at `p` (mm) in mm; `None` where the result has none or no elements.
    pub fn displacement(&self, p: DVec3) -> Option<DVec3> {
        let u = self.result.displacement.as_ref()?;
        let at = self.locate(p)?;
        let e = &self.result.elements[at.element as usize];
        Some(e.nodes().iter().zip(e.kind.weights(at.natural)).map(|(&i, w)| w * u[i as usize]).sum())
    }

    // Projects a point onto the plane of a plane mesh, whose stress is the same through the thickness.
    fn in_plane(&self, p: DVec3) -> DVec3 {
        match self.result.nodes.first() {
            Some(n) if self.result.plane => p.with_z(n.z),
            _ => p,
        }
    }

    fn position(&self, element: u32, natural: DVec3) -> DVec3 {
        let e = &self.result.elements[element as usize];
        e.nodes().iter().zip(e.kind.weights(natural)).map(|(&i, w)| w * self.result.nodes[i as usize]).sum()
    }

    /// Natural coordinates of `p` in an element, also where it lies outside; `None` where the search fails.
    fn natural(&self, element: u32, p: DVec3) -> Option<DVec3> {
        if let Map::Straight(origin, rows) = &self.maps[element as usize] {
            let d = p - *origin;
            return Some(DVec3::new(rows[0].dot(d), rows[1].dot(d), rows[2].dot(d)));
        }
        // Newton's method on x(natural) = p. It converges quadratically for elements that are not folded;
        // 25 steps are far more than such an element needs, and an element that needs more is folded.
        let e = &self.result.elements[element as usize];
        let mut x = e.kind.centre();
        for _ in 0..25 {
            let shape = e.kind.shape(x);
            let mut q = DVec3::ZERO;
            let mut columns = [DVec3::ZERO; 3];
            for ((&i, w), d) in e.nodes().iter().zip(shape.n).zip(shape.d) {
                let node = self.result.nodes[i as usize];
                q += w * node;
                for k in 0..3 {
                    columns[k] += d[k] * node;
                }
            }
            let rows = inverse(columns, e.kind)?;
            let r = p - q;
            let mut step = DVec3::new(rows[0].dot(r), rows[1].dot(r), rows[2].dot(r));
            // The third column is the normal of a surface. A step along it would only measure the
            // distance from the surface.
            if e.kind.dimension() == 2 {
                step.z = 0.0;
            }
            let longest = step.abs().max_element();
            if !longest.is_finite() {
                return None;
            }
            // Far from the element the map may fold over. No step goes further than the element is wide,
            // which is 2 in natural coordinates.
            if longest > 2.0 {
                step *= 2.0 / longest;
            }
            x += step;
            if longest < 1e-12 {
                return Some(x);
            }
            // Ten half-widths from the element the point is certainly outside. Further steps could only find a second
            // solution where the map folds over.
            if x.abs().max_element() > 10.0 {
                return None;
            }
            // The Jacobian of a pyramid is singular at its apex (t = 1), so the iteration stays just
            // below it.
            if e.kind == ElementKind::Pyramid5 {
                x.z = x.z.min(1.0 - 1e-9);
            }
        }
        Some(x)
    }

    /// Mean of the nearest points, weighted by the inverse square of their distance.
    fn between_points(&self, p: DVec3) -> [f64; 6] {
        // Ties in distance are ordered by index, so the neighbours do not depend on the order of the
        // tree.
        let mut near: Vec<(f64, u32)> = Vec::with_capacity(NEIGHBOURS + 1);
        self.point_tree.around(p, |i| {
            let d = p.distance_squared(self.result.nodes[self.points[i as usize] as usize]);
            let at = near.partition_point(|n| *n < (d, i));
            if near.get(at) != Some(&(d, i)) && at < NEIGHBOURS {
                near.insert(at, (d, i));
                near.truncate(NEIGHBOURS);
            }
            // The search radius stays infinite until there are enough neighbours.
            if near.len() < NEIGHBOURS { f64::INFINITY } else { near[NEIGHBOURS - 1].0 }
        });
        let mut sum = [0.0; 6];
        let mut total = 0.0;
        let smallest = near.first().map_or(0.0, |n| n.0).max(1e-300);
        for (d, i) in near {
            // Weights are relative to the nearest point, so that the inverse of a tiny distance cannot
            // overflow.
            let w = smallest / d.max(smallest * 1e-12).max(1e-300);
            // A point on a sample takes the sample's stress alone; 1e24 outweighs all others within
            // double precision.
            let w = if d == 0.0 { 1e24 } else { w };
            total += w;
            for (to, v) in sum.iter_mut().zip(self.result.stress[self.points[i as usize] as usize]) {
                *to += w * v;
            }
        }
        sum.map(|v| if total > 0.0 { v / total } else { 0.0 })
    }
}

fn box_of(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    let none = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
    points.fold(none, |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// Rows of the inverse of the matrix with these columns. Surfaces get their normal as the third column.
fn inverse(columns: [DVec3; 3], kind: ElementKind) -> Option<[DVec3; 3]> {
    let [a, b, mut c] = columns;
    // With the unit normal as third column the matrix is square, and the first two rows are the inverse
    // within the surface.
    if kind.dimension() == 2 {
        c = a.cross(b).normalize_or_zero();
    }
    let det = a.dot(b.cross(c));
    let rows = [b.cross(c) / det, c.cross(a) / det, a.cross(b) / det];
    (det != 0.0 && rows.iter().all(|r| r.is_finite())).then_some(rows)
}

/// The inverse map of a simplex whose nodes on edges lie in their middles.
fn straight(e: &Element, result: &FeResult) -> Option<Map> {
    let simplex =
        matches!(e.kind, ElementKind::Tri3 | ElementKind::Tri6 | ElementKind::Tet4 | ElementKind::Tet10);
    if !simplex {
        return None;
    }
    let p = |i: usize| result.nodes[e.nodes()[i] as usize];
    let (lo, hi) = box_of(e.corners().iter().map(|&i| result.nodes[i as usize]));
    // Single precision rounds the middle nodes by about a millionth of the part, so exact equality would
    // call every such element curved and slow.
    let tolerance = 1e-5 * (hi - lo).max_element();
    let n = e.kind.n_corners();
    let even = e
        .kind
        .edges()
        .iter()
        .enumerate()
        .all(|(k, &[i, j])| (0.5 * (p(i) + p(j)) - p(n + k)).length() <= tolerance);
    if !even {
        return None;
    }
    let third = if n == 4 { p(3) - p(0) } else { DVec3::ZERO };
    inverse([p(1) - p(0), p(2) - p(0), third], e.kind).map(|rows| Map::Straight(p(0), rows))
}

/// Faces that belong to one element only, as triangles. Of shells in space, every element itself.
fn rim(result: &FeResult) -> Vec<([u32; 3], u32)> {
    let mut out = Vec::new();
    let mut fan = |corners: &[u32], e: u32| match *corners {
        [a, b] => out.push(([a, b, b], e)),
        [a, b, c] => out.push(([a, b, c], e)),
        [a, b, c, d] => out.extend([([a, b, c], e), ([a, c, d], e)]),
        _ => {}
    };
    let shells = !result.plane && result.elements.first().is_some_and(|e| e.kind.dimension() == 2);
    if shells {
        for (i, e) in result.elements.iter().enumerate() {
            fan(e.corners(), i as u32);
        }
        return out;
    }
    for (e, face) in free_faces(&result.elements) {
        let element = &result.elements[e as usize];
        let corners = element.kind.faces()[face as usize].iter().map(|&c| element.nodes()[c]);
        fan(&corners.collect::<Vec<u32>>(), e);
    }
    out
}

/// Boxes sorted into the cells of a regular grid. A grid answers which boxes hold a point faster than a
/// tree does. `grainpath_core::buckets` holds points, each in one cell; a box lies in many.
#[derive(Debug, Clone)]
struct BoxGrid {
    lo: DVec3,
    /// Cells per mm along each axis.
    scale: DVec3,
    dims: [usize; 3],
    /// First index into `items` of each cell.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl BoxGrid {
    fn new(boxes: &[(DVec3, DVec3)]) -> Self {
        let mut grid =
            Self { lo: DVec3::ZERO, scale: DVec3::ONE, dims: [1; 3], starts: vec![0, 0], items: Vec::new() };
        let Some((lo, hi)) = boxes.iter().copied().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else {
            return grid;
        };
        grid.lo = lo;
        // Four cells for each box keep about one box in a cell; 5e7 cells (200 MB of starts) are the
        // limit of memory.
        let mut wanted = (4.0 * boxes.len() as f64).clamp(1.0, 5e7);
        loop {
            grid.divide(hi - lo, wanted);
            let cells = |b: &(DVec3, DVec3)| grid.range(b).iter().map(|r| r.1 - r.0 + 1).product::<usize>();
            // Long thin boxes that run across many cells would each be listed in all of them. Fewer,
            // larger cells bound the list at 64 entries for each box.
            if boxes.iter().map(cells).sum::<usize>() <= 64 * boxes.len() || wanted <= 1.0 {
                break;
            }
            wanted /= 2.0;
        }
        let n_cells = grid.dims.iter().product::<usize>();
        let mut starts = vec![0u32; n_cells + 1];
        // Counting sort: count the boxes of each cell, sum to starts, then fill. Boxes stay in ascending
        // order within a cell.
        for b in boxes {
            grid.each(b, |cell| starts[cell + 1] += 1);
        }
        for i in 0..n_cells {
            starts[i + 1] += starts[i];
        }
        let mut items = vec![0; starts[n_cells] as usize];
        let mut next = starts.clone();
        for (i, b) in boxes.iter().enumerate() {
            grid.each(b, |cell| {
                items[next[cell] as usize] = i as u32;
                next[cell] += 1;
            });
        }
        Self { starts, items, ..grid }
    }

    /// Cuts a box of this size into about `wanted` cells that are nearly cubes.
    fn divide(&mut self, size: DVec3, wanted: f64) {
        // A plane mesh has no extent in z. Such an axis gets one cell and does not count for the side
        // length.
        let flat = 1e-9 * size.max_element();
        let wide: Vec<f64> = size.to_array().into_iter().filter(|&s| s > flat).collect();
        let side = math::pow(wide.iter().product::<f64>() / wanted, 1.0 / wide.len().max(1) as f64);
        for k in 0..3 {
            let n = if size[k] > flat { (size[k] / side).ceil().clamp(1.0, 1e6) } else { 1.0 };
            self.dims[k] = n as usize;
            self.scale[k] = if size[k] > flat { n / size[k] } else { 0.0 };
        }
    }

    /// The cell along an axis, clamped to the grid.
    fn index(&self, k: usize, x: f64) -> usize {
        (((x - self.lo[k]) * self.scale[k]).max(0.0) as usize).min(self.dims[k] - 1)
    }

    fn range(&self, b: &(DVec3, DVec3)) -> [(usize, usize); 3] {
        std::array::from_fn(|k| (self.index(k, b.0[k]), self.index(k, b.1[k])))
    }

    fn number(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.dims[1] + j) * self.dims[0] + i
    }

    fn each(&self, b: &(DVec3, DVec3), mut f: impl FnMut(usize)) {
        let [x, y, z] = self.range(b);
        for k in z.0..=z.1 {
            for j in y.0..=y.1 {
                for i in x.0..=x.1 {
                    f(self.number([i, j, k]));
                }
            }
        }
    }

    /// Boxes that may hold `p`, ascending by index.
    fn at(&self, p: DVec3) -> &[u32] {
        let c = self.number([0, 1, 2].map(|k| self.index(k, p[k])));
        &self.items[self.starts[c] as usize..self.starts[c + 1] as usize]
    }
}

/// A binary tree of points that lists several neighbours; `Bvh` gives the nearest alone. The order of construction and search is fixed,
/// so ties are decided alike on every run.
#[derive(Debug, Clone, Default)]
struct Tree {
    nodes: Vec<TreeNode>,
    items: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct TreeNode {
    lo: DVec3,
    hi: DVec3,
    /// In a leaf, the index of its first item; otherwise the second child. The first child follows its
    /// parent directly.
    link: u32,
    /// Number of items in a leaf; 0 for an inner node.
    n_items: u32,
}

impl TreeNode {
    fn distance_squared(&self, p: DVec3) -> f64 {
        p.distance_squared(p.clamp(self.lo, self.hi))
    }
}

/// Largest number of points in a leaf of the tree.
/// Source: chosen; it changes speed alone, never the result.
const LEAF: usize = 4;

impl Tree {
    fn new(points: &[DVec3]) -> Self {
        let mut tree = Self { nodes: Vec::new(), items: (0..points.len() as u32).collect() };
        if !points.is_empty() {
            tree.build(points, 0, points.len());
        }
        tree
    }

    fn build(&mut self, points: &[DVec3], start: usize, end: usize) {
        let items = &mut self.items[start..end];
        let (lo, hi) = box_of(items.iter().map(|&i| points[i as usize]));
        let node = self.nodes.len();
        let n_items = items.len();
        self.nodes.push(TreeNode { lo, hi, link: start as u32, n_items: n_items as u32 });
        if n_items <= LEAF {
            return;
        }
        let axis = (hi - lo).max_position();
        let half = n_items / 2;
        // The index breaks ties, so that equal coordinates are split the same way everywhere. A split at the
        // median keeps the depth at log2(n), which the stack of `around` relies on.
        items.select_nth_unstable_by(half, |&a, &b| {
            points[a as usize][axis].total_cmp(&points[b as usize][axis]).then(a.cmp(&b))
        });
        self.build(points, start, start + half);
        self.nodes[node].link = self.nodes.len() as u32;
        self.nodes[node].n_items = 0;
        self.build(points, start + half, end);
    }

    /// Visits items from near to far. Stops when every remaining box is farther than the squared distance
    /// that `f` returned last.
    fn around(&self, p: DVec3, mut f: impl FnMut(u32) -> f64) {
        let mut limit = f64::INFINITY;
        // Each level leaves one sibling on the stack and the depth is at most 32 for u32 indices, so 64
        // entries suffice.
        let mut stack = [(0.0f64, 0u32); 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let (distance, at) = stack[depth];
            if distance > limit {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.n_items > 0 {
                for &i in &self.items[node.link as usize..(node.link + node.n_items) as usize] {
                    limit = f(i);
                }
                continue;
            }
            let child = |i: u32| (self.nodes[i as usize].distance_squared(p), i);
            let (a, b) = (child(at + 1), child(node.link));
            let (near, far) = if a.0 <= b.0 { (a, b) } else { (b, a) };
            // The nearer child goes on top: its items shrink the limit before the farther child is looked
            // at.
            stack[depth] = far;
            stack[depth + 1] = near;
            depth += 2;
        }
    }
}
