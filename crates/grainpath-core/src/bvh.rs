//! A tree of bounding boxes around triangles, for the closest point, ray hits and winding number of a mesh.
//!
//! The tree depends only on the mesh (median splits, ties broken by triangle index), so every answer is
//! the same for any number of threads. Triangles without area are kept: they have closest points,
//! but no ray hits them and they add nothing to the winding number.
//!
//! Winding numbers follow `barill2018`: a group of triangles far away counts as a single dipole.
//! Lengths are in the unit of the mesh. Cost: n log n to build; a query visits a number of nodes
//! that grows with the logarithm of n, and with the number of hits.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{TriMesh, math};

/// Triangles in a leaf. Source: chosen; it changes speed alone, never the result.
const LEAF: usize = 4;
/// A group of triangles is replaced by one dipole if the query is farther from it than this many times
/// its radius. Measured: with this value the winding numbers of the unit tests are off by less than
/// 0.02.
const FAR: f64 = 2.3;
/// Subtrees with at most this many triangles are built on a single thread.
/// Source: chosen; it changes speed alone, never the result.
const SERIAL: usize = 4096;

/// A tree over the triangles of a mesh. Owns copies of their corners: about 130 bytes a triangle.
#[derive(Debug, Clone)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// Triangles in leaf order.
    corners: Vec<[DVec3; 3]>,
    /// Index in the mesh of each of these triangles.
    ids: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    lo: DVec3,
    hi: DVec3,
    /// Area-weighted centre, the sum of area normals, and the largest distance of a corner from the centre.
    centre: DVec3,
    dipole: DVec3,
    radius: f64,
    /// In a leaf, its first triangle and their number; in an inner node, the index of its right child and 0.
    /// The left child is the next node.
    first: u32,
    count: u32,
}

const UNBUILT: Node = Node {
    lo: DVec3::INFINITY,
    hi: DVec3::NEG_INFINITY,
    centre: DVec3::ZERO,
    dipole: DVec3::ZERO,
    radius: 0.0,
    first: 0,
    count: 0,
};

/// The point of a mesh nearest to a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// The point on the surface.
    pub point: DVec3,
    /// Distance from the query, in the mesh's unit.
    pub distance: f64,
    /// Index of the triangle that the point lies on; of several, the lowest.
    pub triangle: u32,
}

/// A point where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// Position along the ray, as a multiple of its direction vector.
    pub t: f64,
    /// Index of the triangle.
    pub triangle: u32,
    /// Whether the ray passes the triangle from back to front: it then leaves a mesh with outward normals.
    pub leaves: bool,
}

/// The numbers of tree nodes for `n` and for `n + 1` triangles. Halving gives only two sizes on each level.
// They are needed before the tree exists: both halves write their nodes in parallel into one array,
// so the size of the left half must be known.
fn tree_sizes(n: usize) -> (usize, usize) {
    if n < LEAF {
        return (1, 1);
    }
    let (half, more) = tree_sizes(n / 2);
    let other_half = if n.is_multiple_of(2) { half } else { more };
    (if n == LEAF { 1 } else { 1 + half + other_half }, 1 + other_half + more)
}

fn tree_size(n: usize) -> usize {
    tree_sizes(n).0
}

impl Bvh {
    /// Builds the tree. Triangles with a corner that is not finite are left out.
    pub fn new(mesh: &TriMesh) -> Self {
        let corner = |t: &[u32; 3]| t.map(|i| mesh.vertices[i as usize]);
        let finite = |t: &[u32; 3]| corner(t).iter().all(|p| p.is_finite());
        let mut items: Vec<(DVec3, u32)> = (0u32..)
            .zip(&mesh.triangles)
            .filter(|(_, t)| finite(t))
            .map(|(i, t)| (corner(t).iter().sum::<DVec3>() / 3.0, i))
            .collect();
        if items.is_empty() {
            return Self { nodes: Vec::new(), corners: Vec::new(), ids: Vec::new() };
        }
        let mut nodes = vec![UNBUILT; tree_size(items.len())];
        build(&mut items, &mut nodes, 0, 0, &|i| corner(&mesh.triangles[i as usize]));
        let corners = items.iter().map(|&(_, i)| corner(&mesh.triangles[i as usize])).collect();
        let ids = items.iter().map(|&(_, i)| i).collect();
        Self { nodes, corners, ids }
    }

    /// Whether the tree holds no triangle.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// The nearest point of the mesh within the distance `reach` (infinity for no limit); `None` if there is none.
    pub fn closest_point(&self, q: DVec3, reach: f64) -> Option<ClosestPoint> {
        if self.is_empty() {
            return None;
        }
        // During the search `distance` holds the squared distance; its root is taken at the end.
        let mut best = ClosestPoint { point: q, distance: reach * reach, triangle: u32::MAX };
        let mut stack = Stack::new();
        stack.push((0, self.nodes[0].distance_squared(q)));
        while let Some((at, d)) = stack.pop() {
            // A nearer point may have been found since this node was pushed.
            if d > best.distance {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.count > 0 {
                for i in node.range() {
                    let p = closest_on_triangle(q, &self.corners[i]);
                    let d = p.distance_squared(q);
                    if d < best.distance || (d == best.distance && self.ids[i] < best.triangle) {
                        best = ClosestPoint { point: p, distance: d, triangle: self.ids[i] };
                    }
                }
                continue;
            }
            let (l, r) = (at + 1, node.first);
            let (dl, dr) =
                (self.nodes[l as usize].distance_squared(q), self.nodes[r as usize].distance_squared(q));
            // The nearer child is pushed last and so visited first: its best point lets most of the
            // other one be skipped.
            if dl <= dr {
                stack.push((r, dr));
                stack.push((l, dl));
            } else {
                stack.push((l, dl));
                stack.push((r, dr));
            }
        }
        best.distance = best.distance.sqrt();
        (best.triangle != u32::MAX).then_some(best)
    }

    /// The first hit of the ray `from + t * along` with `t` in `range`. If several triangles are hit at
    /// the same `t`, the one with the lowest index is taken.
    pub fn first_hit(&self, from: DVec3, along: DVec3, range: (f64, f64)) -> Option<RayHit> {
        let mut best: Option<RayHit> = None;
        self.for_hits(from, along, range, |hit, end| {
            // The ray is shortened to each hit, so that boxes behind it are skipped.
            if best.is_none_or(|b| (hit.t, hit.triangle) < (b.t, b.triangle)) {
                best = Some(hit);
                *end = hit.t;
            }
        });
        best
    }

    /// All hits of the ray `from + t * along` with `t` in `range`, sorted by `t`, then by triangle.
    /// A ray through an edge or a corner may hit several triangles there.
    pub fn hits(&self, from: DVec3, along: DVec3, range: (f64, f64)) -> Vec<RayHit> {
        let mut hits = Vec::new();
        self.for_hits(from, along, range, |hit, _| hits.push(hit));
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        hits
    }

    fn for_hits(
        &self,
        from: DVec3,
        along: DVec3,
        range: (f64, f64),
        mut found: impl FnMut(RayHit, &mut f64),
    ) {
        if self.is_empty() {
            return;
        }
        let inverse = along.recip();
        let mut end = range.1;
        let mut stack = Stack::new();
        stack.push((0, 0.0));
        while let Some((at, _)) = stack.pop() {
            let node = &self.nodes[at as usize];
            if !node.meets_ray(from, inverse, (range.0, end)) {
                continue;
            }
            if node.count == 0 {
                stack.push((node.first, 0.0));
                stack.push((at + 1, 0.0));
                continue;
            }
            for i in node.range() {
                if let Some((t, leaves)) = ray_triangle(from, along, &self.corners[i])
                    && t >= range.0
                    && t <= end
                {
                    found(RayHit { t, triangle: self.ids[i], leaves }, &mut end);
                }
            }
        }
    }

    /// Winding number of the mesh around a point: 1 inside and 0 outside a closed mesh, between 0 and 1
    /// near holes, and 2 where two bodies overlap. Groups far away count as dipoles (`barill2018`); the
    /// error stays under about 0.02.
    pub fn winding_number(&self, q: DVec3) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let (mut dipoles, mut angles) = (0.0, 0.0);
        let mut stack = Stack::new();
        stack.push((0, 0.0));
        while let Some((at, _)) = stack.pop() {
            let node = &self.nodes[at as usize];
            let away = node.centre - q;
            let d2 = away.length_squared();
            // A dipole is the first term of the far-field expansion. In near groups the children are
            // visited; leaves are summed exactly.
            if d2 > (FAR * node.radius).powi(2) {
                dipoles += away.dot(node.dipole) / (d2 * d2.sqrt());
            } else if node.count > 0 {
                angles += node.range().map(|i| half_solid_angle(q, &self.corners[i])).sum::<f64>();
            } else {
                stack.push((node.first, 0.0));
                stack.push((at + 1, 0.0));
            }
        }
        (dipoles + 2.0 * angles) / (4.0 * PI)
    }

    /// Whether a point is inside: winding number over one half.
    pub fn contains(&self, q: DVec3) -> bool {
        // A point outside the bounding box is outside the mesh, so the winding number need not be summed.
        let inside_box = self.nodes.first().is_some_and(|n| q.cmpge(n.lo).all() && q.cmple(n.hi).all());
        inside_box && self.winding_number(q) > 0.5
    }
}

/// A stack without allocation. Every split halves, so a tree of 2^32 triangles has at most 33 levels, and
/// each level leaves one node on the stack.
struct Stack {
    items: [(u32, f64); 72],
    len: usize,
}

impl Stack {
    fn new() -> Self {
        Self { items: [(0, 0.0); 72], len: 0 }
    }

    fn push(&mut self, item: (u32, f64)) {
        self.items[self.len] = item;
        self.len += 1;
    }

    fn pop(&mut self) -> Option<(u32, f64)> {
        self.len = self.len.checked_sub(1)?;
        Some(self.items[self.len])
    }
}

impl Node {
    fn range(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }

    fn distance_squared(&self, q: DVec3) -> f64 {
        (self.lo - q).max(q - self.hi).max(DVec3::ZERO).length_squared()
    }

    fn meets_ray(&self, from: DVec3, inverse: DVec3, range: (f64, f64)) -> bool {
        let (mut near, mut far) = range;
        for axis in 0..3 {
            // The ray is parallel to these two faces: `a` and `b` would be infinite or, on a face, NaN.
            if inverse[axis].is_infinite() {
                if from[axis] < self.lo[axis] || from[axis] > self.hi[axis] {
                    return false;
                }
                continue;
            }
            let a = (self.lo[axis] - from[axis]) * inverse[axis];
            let b = (self.hi[axis] - from[axis]) * inverse[axis];
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        // The slack of 1e-12 allows for rounding: without it, a flat box could be missed.
        near - 1e-12 * near.abs() <= far + 1e-12 * far.abs()
    }
}

fn build(
    items: &mut [(DVec3, u32)],
    nodes: &mut [Node],
    node_start: u32,
    item_start: u32,
    corners: &(impl Fn(u32) -> [DVec3; 3] + Sync),
) {
    let n = items.len();
    if n <= LEAF {
        // In a leaf, triangles are sorted by index, so that a mesh with few triangles keeps its order.
        items.sort_unstable_by_key(|&(_, i)| i);
        nodes[0] = leaf(items, item_start, corners);
        return;
    }
    let (lo, hi) =
        items.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &(c, _)| (lo.min(c), hi.max(c)));
    let extent = hi - lo;
    // The split is across the longest side of the box of the centres, which keeps the boxes compact.
    let axis = (0..3).fold(0, |best, a| if extent[a] > extent[best] { a } else { best });
    let half = n / 2;
    items.select_nth_unstable_by(half, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    let (left, right) = items.split_at_mut(half);
    let (own, below) = nodes.split_first_mut().expect("an inner node has children");
    let (below_left, below_right) = below.split_at_mut(tree_size(half));
    let right_start = node_start + 1 + below_left.len() as u32;
    let mut go_left = || build(left, below_left, node_start + 1, item_start, corners);
    let mut go_right = || build(right, below_right, right_start, item_start + half as u32, corners);
    if n > SERIAL {
        rayon::join(go_left, go_right);
    } else {
        go_left();
        go_right();
    }
    *own = joined(&below_left[0], &below_right[0]);
    own.first = right_start;
}

fn leaf(items: &[(DVec3, u32)], first: u32, corners: &impl Fn(u32) -> [DVec3; 3]) -> Node {
    let mut node = Node { first, count: items.len() as u32, ..UNBUILT };
    let mut weight = 0.0;
    let mut middle = DVec3::ZERO;
    for &(c, i) in items {
        let [p, q, r] = corners(i);
        let normal = (q - p).cross(r - p) * 0.5;
        node.lo = node.lo.min(p.min(q).min(r));
        node.hi = node.hi.max(p.max(q).max(r));
        node.dipole += normal;
        node.centre += c * normal.length();
        weight += normal.length();
        middle += c;
    }
    // A leaf may hold only degenerate triangles without area; their mean centre keeps the radius finite.
    node.centre = if weight > 0.0 { node.centre / weight } else { middle / items.len() as f64 };
    let far = items.iter().flat_map(|&(_, i)| corners(i)).map(|p| p.distance(node.centre));
    node.radius = far.fold(0.0, f64::max);
    node
}

fn joined(a: &Node, b: &Node) -> Node {
    let (lo, hi) = (a.lo.min(b.lo), a.hi.max(b.hi));
    // The weight of a child is half the surface area of its box. It approximates the area of the child's
    // triangles, and it is zero only for a point or a line along an axis.
    let weight = |n: &Node| {
        let e = n.hi - n.lo;
        e.x * e.y + e.y * e.z + e.z * e.x
    };
    let (wa, wb) = (weight(a), weight(b));
    let share = if wa + wb > 0.0 { wa / (wa + wb) } else { 0.5 };
    let centre = a.centre * share + b.centre * (1.0 - share);
    let box_radius = (centre - lo).max(hi - centre).length();
    // The radius has two upper bounds, one from the children and one from the box. The smaller one is
    // taken.
    let radius = (centre.distance(a.centre) + a.radius).max(centre.distance(b.centre) + b.radius);
    Node { lo, hi, centre, dipole: a.dipole + b.dipole, radius: radius.min(box_radius), first: 0, count: 0 }
}

/// The point of a triangle nearest to `q` (`ericson2005`, section 5.1.5). In a triangle without area, it
/// is the nearest point of its sides.
pub(crate) fn closest_on_triangle(q: DVec3, &[a, b, c]: &[DVec3; 3]) -> DVec3 {
    let (ab, ac, aq) = (b - a, c - a, q - a);
    let (d1, d2) = (ab.dot(aq), ac.dot(aq));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bq = q - b;
    let (d3, d4) = (ab.dot(bq), ac.dot(bq));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let cq = q - c;
    let (d5, d6) = (ab.dot(cq), ac.dot(cq));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    // Inside the triangle all three barycentric weights are positive. In slivers the weights are mere
    // rounding errors, so the threshold leaves them to the search on the sides below.
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    let total = va + vb + vc;
    if va > 0.0 && vb > 0.0 && vc > 0.0 && total > 1e-14 * ab.length_squared() * ac.length_squared() {
        return a + ab * (vb / total) + ac * (vc / total);
    }
    // The nearest point lies on a side. All three sides are tried, since with rounding the signs above
    // may name several sides or none.
    let on = |p: DVec3, along: DVec3| {
        let length2 = along.length_squared();
        let t = if length2 > 0.0 { (along.dot(q - p) / length2).clamp(0.0, 1.0) } else { 0.0 };
        p + along * t
    };
    [on(a, ab), on(b, c - b), on(c, a - c)]
        .into_iter()
        .min_by(|x, y| x.distance_squared(q).total_cmp(&y.distance_squared(q)))
        .expect("three sides")
}

fn ray_triangle(from: DVec3, along: DVec3, &[a, b, c]: &[DVec3; 3]) -> Option<(f64, bool)> {
    // If the ray passes inside, the volumes that it spans with the three sides have the same sign. Each
    // volume depends only on its side, with the corners sorted by position. Two triangles therefore get
    // the same number for their common side, and no ray slips between them.
    let (pa, pb, pc) = (a - from, b - from, c - from);
    let side = |p: DVec3, q: DVec3| {
        if (p.x, p.y, p.z) <= (q.x, q.y, q.z) { along.dot(p.cross(q)) } else { -along.dot(q.cross(p)) }
    };
    let (u, v, w) = (side(pb, pc), side(pc, pa), side(pa, pb));
    let one_sign = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let total = u + v + w;
    if !one_sign || total == 0.0 {
        return None;
    }
    let at = (pa * u + pb * v + pc * w) / total;
    Some((at.dot(along) / along.length_squared(), total > 0.0))
}

/// Half the signed solid angle of a triangle (`vanoosterom1983`).
fn half_solid_angle(q: DVec3, corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| p - q);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    let rest = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    // If the query lies in the plane of the triangle, the angle has opposite signs on both sides; their
    // mean is 0.
    if volume == 0.0 { 0.0 } else { math::atan2(volume, rest) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A ball of radius 1 from a subdivided octahedron, wound outwards.
    fn ball(levels: usize) -> TriMesh {
        let vertices = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        let mut mesh = TriMesh { vertices: vertices.to_vec(), triangles: Vec::new() };
        for i in 0..4u32 {
            mesh.triangles.push([i, (i + 1) % 4, 4]);
            mesh.triangles.push([(i + 1) % 4, i, 5]);
        }
        for _ in 0..levels {
            let mut finer = TriMesh::default();
            for &t in &mesh.triangles {
                let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
                let (d, e, f) = ((a + b).normalize(), (b + c).normalize(), (c + a).normalize());
                for corners in [[a, d, f], [d, b, e], [f, e, c], [d, e, f]] {
                    let n = finer.vertices.len() as u32;
                    finer.vertices.extend(corners);
                    finer.triangles.push([n, n + 1, n + 2]);
                }
            }
            mesh = finer;
        }
        mesh
    }

    #[test]
    fn sizes_of_trees_add_up() {
        for n in 1..300 {
            let whole = if n <= LEAF { 1 } else { 1 + tree_size(n / 2) + tree_size(n - n / 2) };
            assert_eq!(tree_size(n), whole, "{n}");
        }
    }

    #[test]
    fn a_ball_winds_once() {
        let bvh = Bvh::new(&ball(5));
        assert_eq!(bvh.len(), 8192);
        for i in 0..2000 {
            let (s, c) = math::sin_cos(f64::from(i) * 2.4);
            let z = f64::from(i) / 1000.0 - 1.0;
            let out = DVec3::new(c * (1.0 - z * z).sqrt(), s * (1.0 - z * z).sqrt(), z);
            for (r, inside) in [(0.0, 1.0), (0.5, 1.0), (0.99, 1.0), (1.01, 0.0), (3.0, 0.0)] {
                let w = bvh.winding_number(out * r);
                assert!((w - inside).abs() < 0.02, "{w} at radius {r}");
            }
            let near = bvh.closest_point(out * 1.5, f64::INFINITY).expect("not empty");
            assert!((near.distance - 0.5).abs() < 2e-3);
            let hits = bvh.hits(out * 2.0, -out, (0.0, 10.0));
            let leaves: Vec<bool> = hits.iter().map(|h| h.leaves).collect();
            assert!(hits.len() >= 2 && !leaves[0] && leaves[leaves.len() - 1], "{hits:?}");
            assert_eq!(bvh.first_hit(out * 2.0, -out, (0.0, 10.0)), Some(hits[0]));
        }
        assert_eq!(bvh.closest_point(DVec3::splat(9.0), 1.0), None);
    }

    #[test]
    fn nothing_and_nonsense_are_survived() {
        let empty = Bvh::new(&TriMesh::default());
        assert!(empty.closest_point(DVec3::ZERO, f64::INFINITY).is_none());
        assert_eq!(empty.winding_number(DVec3::ZERO), 0.0);
        assert!(!empty.contains(DVec3::ZERO) && empty.hits(DVec3::ZERO, DVec3::X, (0.0, 1.0)).is_empty());
        let vertices = vec![DVec3::ZERO, DVec3::NAN, DVec3::X, DVec3::X * 2.0];
        let odd = Bvh::new(&TriMesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3], [2, 2, 2]] });
        assert_eq!(odd.len(), 2);
        let near = odd.closest_point(DVec3::new(1.5, 1.0, 0.0), f64::INFINITY).expect("two triangles");
        assert_eq!((near.distance, near.triangle), (1.0, 1));
        assert!(odd.winding_number(DVec3::Y).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn agrees_with_looking_at_every_triangle(
            points in prop::collection::vec(prop::array::uniform3(-4i32..5), 3..90),
            q in prop::array::uniform3(-5.0f64..5.0),
            along in prop::array::uniform3(-1.0f64..1.0),
        ) {
            let vertices: Vec<DVec3> =
                points.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
            let triangles: Vec<[u32; 3]> =
                (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let corners = |t: &[u32; 3]| t.map(|i| vertices[i as usize]);
            let mesh = TriMesh { vertices: vertices.clone(), triangles: triangles.clone() };
            let bvh = Bvh::new(&mesh);
            let (q, along) = (DVec3::from_array(q), DVec3::from_array(along));
            let slow = triangles.iter().map(|t| closest_on_triangle(q, &corners(t)).distance(q));
            let fast = bvh.closest_point(q, f64::INFINITY).expect("not empty");
            prop_assert!((fast.distance - slow.fold(f64::INFINITY, f64::min)).abs() < 1e-12);
            let count = triangles.iter().filter_map(|t| ray_triangle(q, along, &corners(t)));
            let count = count.filter(|&(t, _)| (0.0..=9.0).contains(&t)).count();
            prop_assert_eq!(bvh.hits(q, along, (0.0, 9.0)).len(), count);
        }
    }
}
