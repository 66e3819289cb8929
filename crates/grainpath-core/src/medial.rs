//! The medial axis of thin places: where a single bead runs, and how wide it has to be.
//!
//! Method: the chordal axis (`prasad1997`). The border of each polygon is sampled, the samples are joined by
//! a constrained Delaunay triangulation, and the midpoints of the triangles' inner sides are joined. A
//! triangle with two inner sides continues the axis, one with a single inner side ends it, and one with three
//! makes a fork. In a strip of constant width this is the medial axis itself. The width is the part of an
//! inner side across the axis, smoothed over three nodes. Branches that only reach into a corner are shorter
//! than 0.9 of the thickness at their fork, or 0.6 where one is alone there, and are cut off. At a fork the two branches that continue most
//! nearly straight become one line; the third ends there. Elsewhere an open line is extended to 0.4 widths before the
//! border, because the round end of the bead fills the rest.
//!
//! Lengths are in mm. Samples are 0.06 to 0.4 mm apart, 0.6 of the mean thickness, but farther on long
//! borders: about 100 000 samples a polygon at most, and 5000 an edge. Cost: n log n for n samples. The width
//! that a test finds in a strip of 0.5 mm is right to 0.03 mm. The region should be thinner than the largest
//! width almost everywhere.
//!
//! Degenerate cases: an empty region gives no path, and neither do slivers below 1e-4 mm2 or with a mean
//! thickness below a fifth of the least width. A polygon that cannot be triangulated gives none. Places
//! thinner than the least width interrupt a path; greater widths are cut to the largest. A place so short
//! that it has a single chord gets a short bead at right angles to the chord.

use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::math::cross;
use crate::poly::{LineClipper, edges, perimeter_mm};
use crate::triangulation::inside_faces;
use crate::{Polygon, Region};

/// A line along the middle of a thin place.
#[derive(Debug, Clone, PartialEq)]
pub struct MedialPath {
    /// The line, mm.
    pub points: Vec<DVec2>,
    /// Thickness of the region at each point, mm, from the least to the greatest width asked for.
    pub widths_mm: Vec<f64>,
    /// Whether the last point joins the first.
    pub closed: bool,
}

/// The medial paths of a region that is almost everywhere thinner than `max_width_mm`; greater
/// widths are cut to that. Places thinner than `min_width_mm` get no path, and polygons that cannot
/// be triangulated get none either.
pub fn medial_axis(region: &Region, min_width_mm: f64, max_width_mm: f64) -> Vec<MedialPath> {
    let mut out = Vec::new();
    for polygon in &region.polygons {
        let area = polygon.area_mm2();
        let thickness = 2.0 * area / polygon.perimeter_mm();
        // Twice area over perimeter is the mean thickness of a strip. A sliver with a mean below a
        // fifth of the least width is nowhere as thick as that width.
        if area < 1e-4 || thickness < 0.2 * min_width_mm {
            continue;
        }
        if let Some(graph) = Graph::new(polygon, (0.6 * thickness).clamp(0.06, 0.4)) {
            let clipper = LineClipper::new(&Region::from(polygon.clone()));
            for path in graph.into_paths() {
                finish(path, &clipper, min_width_mm, max_width_mm, &mut out);
            }
        }
    }
    out
}

/// A point of the axis: the middle of a chord from border to border.
#[derive(Debug, Clone, Copy)]
struct Node {
    at: DVec2,
    /// The chord, mm; zero at the centre of a triangle in which branches meet.
    chord: DVec2,
    /// Indices of the neighbouring nodes, at most three; unused entries are `NONE`.
    next: [u32; 3],
    /// Whether the line ends here because another goes on through the fork.
    beside_fork: bool,
}

const NONE: u32 = u32::MAX;

/// A branch that ends within this share of the thickness at its fork only reaches into a corner, where another such branch
/// begins at the fork: both reach into the corners of one end. Source: derived. In a square end the corners are 0.71 of the
/// thickness away.
const CORNERS_REACH: f64 = 0.9;
/// The same share for a branch that is alone at its fork: up to the middle of the last chord, half a thickness in a square corner.
/// Measured: 0.45, 0.6, 0.75 and 0.9 leave 1.60, 1.65, 3.12 and 3.87 % of letters one bead wide open, whose short strokes end
/// beside a fork, and 1.09, 1.12, 1.15 and 1.20 % of a lattice with 0.26, 0.25, 0.24 and 0.24 % beside it (`embossed_text`,
/// `bone_lattice`; docs/quality.md).
const CORNER_REACH: f64 = 0.6;

impl Node {
    /// A point of the axis without neighbours.
    fn new(at: DVec2, chord: DVec2) -> Self {
        Self { at, chord, next: [NONE; 3], beside_fork: false }
    }
}

struct Graph {
    nodes: Vec<Node>,
}

/// Adds the vertices of a contour and points between them, at most `step_mm` apart.
fn sampled(contour: &[DVec2], step_mm: f64, out: &mut Vec<Point2<f64>>, sides: &mut Vec<[usize; 2]>) {
    let first = out.len();
    for (a, b) in edges(contour) {
        // The upper bound limits the memory that a single long edge takes.
        let n = (a.distance(b) / step_mm).ceil().clamp(1.0, 5000.0) as usize;
        out.extend((0..n).map(|i| a.lerp(b, i as f64 / n as f64)).map(|p| Point2::new(p.x, p.y)));
    }
    let n = out.len() - first;
    sides.extend((0..n).map(|i| [first + i, first + (i + 1) % n]));
}

impl Graph {
    fn new(polygon: &Polygon, step_mm: f64) -> Option<Self> {
        let (mut points, mut sides) = (Vec::new(), Vec::new());
        // The number of samples of a long border is bounded by a coarser step.
        let step_mm = step_mm.max(polygon.contours().map(|c| perimeter_mm(c)).sum::<f64>() / 100_000.0);
        for contour in polygon.contours() {
            sampled(contour, step_mm, &mut points, &mut sides);
        }
        let cdt =
            ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(points, sides, |_| {}).ok()?;
        let inside = inside_faces(&cdt);
        let mut graph = Self { nodes: Vec::new() };
        let mut node_of_edge = vec![NONE; cdt.num_undirected_edges()];
        for face in cdt.inner_faces() {
            let corners = face.positions().map(|p| DVec2::new(p.x, p.y));
            let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
            // The triangulation covers the convex hull; triangles in holes and notches are left
            // out.
            if !inside[face.fix().index()] {
                continue;
            }
            let inner: Vec<u32> = face
                .adjacent_edges()
                .iter()
                .filter(|e| !e.is_constraint_edge())
                .map(|e| {
                    let slot = &mut node_of_edge[e.as_undirected().fix().index()];
                    if *slot == NONE {
                        *slot = graph.nodes.len() as u32;
                        let [p, q] = e.positions().map(|p| DVec2::new(p.x, p.y));
                        graph.nodes.push(Node::new(0.5 * (p + q), q - p));
                    }
                    *slot
                })
                .collect();
            // A triangle with one inner side lies in a corner: the axis ends there. Two inner
            // sides: the axis passes through. Three: it forks.
            match *inner {
                [a, b] => graph.join(a, b),
                [a, b, c] => {
                    let middle = graph.nodes.len() as u32;
                    graph.nodes.push(Node::new(centre, DVec2::ZERO));
                    [a, b, c].into_iter().for_each(|n| graph.join(middle, n));
                }
                _ => {}
            }
        }
        graph.prune();
        Some(graph)
    }

    fn join(&mut self, a: u32, b: u32) {
        for (n, other) in [(a, b), (b, a)] {
            if let Some(slot) = self.nodes[n as usize].next.iter_mut().find(|s| **s == NONE) {
                *slot = other;
            }
        }
    }

    fn degree(&self, n: u32) -> usize {
        self.nodes[n as usize].next.iter().filter(|&&s| s != NONE).count()
    }

    /// The nodes from `n`, coming from `from`, up to the next end or fork.
    fn branch(&self, from: u32, n: u32) -> Vec<u32> {
        let (mut before, mut at, mut way) = (from, n, vec![n]);
        while self.degree(at) == 2 && at != from {
            let onward = self.nodes[at as usize].next.into_iter().find(|&s| s != NONE && s != before);
            let Some(next) = onward else { break };
            (before, at) = (at, next);
            way.push(at);
        }
        way
    }

    fn cut(&mut self, a: u32, b: u32) {
        for (n, other) in [(a, b), (b, a)] {
            for slot in &mut self.nodes[n as usize].next {
                if *slot == other {
                    *slot = NONE;
                }
            }
        }
    }

    /// Cuts branches that only reach into a corner. Such a branch is shorter than the region's
    /// thickness at the fork where it begins.
    fn prune(&mut self) {
        // Twice, because cutting a branch may turn a fork next to it into the end of another short
        // branch.
        for _ in 0..2 {
            let forks: Vec<u32> = (0..self.nodes.len() as u32).filter(|&n| self.degree(n) == 3).collect();
            for fork in forks {
                let neighbours = self.nodes[fork as usize].next.into_iter().filter(|&s| s != NONE);
                let thick = neighbours.map(|s| self.nodes[s as usize].chord.length()).fold(0.0, f64::max);
                let mut short: Vec<(f64, u32)> = Vec::new();
                for first in self.nodes[fork as usize].next.into_iter().filter(|&s| s != NONE) {
                    let way = self.branch(fork, first);
                    let last = way[way.len() - 1];
                    if self.degree(last) != 1 {
                        continue;
                    }
                    let mut at = self.nodes[fork as usize].at;
                    let mut length = 0.0;
                    for &n in &way {
                        length += at.distance(self.nodes[n as usize].at);
                        at = self.nodes[n as usize].at;
                    }
                    if length < CORNERS_REACH * thick {
                        short.push((length, first));
                    }
                }
                if let [(length, _)] = short[..]
                    && length > CORNER_REACH * thick
                {
                    continue;
                }
                // The shortest first; a fork keeps at least one branch.
                short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                for (_, first) in short {
                    if self.degree(fork) > 1 {
                        let way = self.branch(fork, first);
                        self.cut(fork, first);
                        way.into_iter().for_each(|n| self.nodes[n as usize].next = [NONE; 3]);
                    }
                }
            }
        }
    }

    /// All branches as lines of nodes. At a fork the two branches that continue most nearly
    /// straight become one line.
    fn into_paths(mut self) -> Vec<(Vec<Node>, bool)> {
        self.split_forks();
        let mut used = vec![false; self.nodes.len()];
        let mut out = Vec::new();
        // Open lines are followed first, from their ends. The nodes that are left then lie on closed lines.
        let ends_first = (0..self.nodes.len() as u32).filter(|&n| self.degree(n) == 1);
        let starts: Vec<u32> = ends_first.chain(0..self.nodes.len() as u32).collect();
        for start in starts {
            if used[start as usize] || self.degree(start) == 0 {
                continue;
            }
            used[start as usize] = true;
            let mut way = vec![start];
            let mut at = start;
            while let Some(next) =
                self.nodes[at as usize].next.into_iter().find(|&s| s != NONE && !used[s as usize])
            {
                used[next as usize] = true;
                way.push(next);
                at = next;
            }
            let closed = way.len() > 3 && self.nodes[at as usize].next.contains(&start);
            out.push((way.into_iter().map(|n| self.nodes[n as usize]).collect(), closed));
        }
        out
    }

    /// Detaches the branch that turns most at each fork; it then ends there in a separate node.
    fn split_forks(&mut self) {
        for fork in 0..self.nodes.len() as u32 {
            if self.degree(fork) != 3 {
                continue;
            }
            let node = self.nodes[fork as usize];
            let toward = node.next.map(|n| {
                // The direction is taken over four nodes: over a single chord it would follow the
                // zigzag of the triangles.
                let way = self.branch(fork, n);
                (self.nodes[way[way.len().min(4) - 1] as usize].at - node.at).normalize_or_zero()
            });
            let straight = |i: usize, j: usize| -toward[i].dot(toward[j]);
            let pairs = [(straight(0, 1), 2), (straight(0, 2), 1), (straight(1, 2), 0)];
            let odd = pairs.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |p| p.1);
            self.cut(fork, node.next[odd]);
            self.nodes[node.next[odd] as usize].beside_fork = true;
        }
    }
}

/// Gives a line of nodes its widths, extends it to the region's ends, and cuts it where it is too
/// thin.
fn finish(
    (nodes, closed): (Vec<Node>, bool),
    clipper: &LineClipper,
    min_mm: f64,
    max_mm: f64,
    out: &mut Vec<MedialPath>,
) {
    // Centres of triangles have no chord, so no width can be measured there; they are left out.
    let nodes: Vec<Node> = nodes.into_iter().filter(|n| n.chord != DVec2::ZERO).collect();
    let n = nodes.len();
    if n < 2 {
        return lone(&nodes, clipper, min_mm, max_mm, out);
    }
    let mut points: Vec<DVec2> = nodes.iter().map(|n| n.at).collect();
    let around = |i: usize, d: isize| -> usize {
        let j = i as isize + d;
        if closed { j.rem_euclid(n as isize) as usize } else { j.clamp(0, n as isize - 1) as usize }
    };
    let tangent = |i: usize| (points[around(i, 2)] - points[around(i, -2)]).normalize_or_zero();
    // A chord crosses the strip at a slant. Its component across the line is the thickness.
    let raw: Vec<f64> = (0..n).map(|i| cross(tangent(i), nodes[i].chord).abs()).collect();
    let mut widths: Vec<f64> =
        (0..n).map(|i| 0.25 * (raw[around(i, -1)] + 2.0 * raw[i] + raw[around(i, 1)])).collect();
    if !closed {
        let (first, last) = (-tangent(0), tangent(n - 1));
        let reach = |i: usize, d: DVec2| {
            let (p, w) = (points[i], widths[i]);
            // Beyond a fork lies the line that goes on through it, and further on another part of the region.
            if nodes[i].beside_fork {
                return p;
            }
            let far = 3.0 * max_mm;
            let free = clipper.crossings(p, p + d * far).first().map_or(0.0, |c| c.t * far);
            // The bead's round end reaches farther than its last point, so the line stops 0.4
            // widths before the border.
            p + d * (free - 0.4 * w).max(0.0)
        };
        let (a, b) = (reach(0, first), reach(n - 1, last));
        points.insert(0, a);
        widths.insert(0, widths[0]);
        points.push(b);
        widths.push(widths[n]);
    }
    for w in &mut widths {
        *w = w.min(max_mm);
    }
    emit(&points, &widths, closed, min_mm, out);
}

/// A bead for a place so short that its axis is the middle of a single chord. The bead runs at right angles to the chord.
fn lone(nodes: &[Node], clipper: &LineClipper, min_mm: f64, max_mm: f64, out: &mut Vec<MedialPath>) {
    let [node] = nodes else { return };
    if node.beside_fork {
        return;
    }
    let along = DVec2::new(-node.chord.y, node.chord.x).normalize_or_zero();
    let reach = 4.0 * max_mm;
    let free =
        |d: DVec2| clipper.crossings(node.at, node.at + d * reach).first().map_or(0.0, |c| c.t * reach);
    let width = node.chord.length().min(max_mm);
    let (a, b) = (free(along) - 0.4 * width, free(-along) - 0.4 * width);
    if a + b > 0.05 {
        emit(&[node.at + along * a.max(0.0), node.at - along * b.max(0.0)], &[width; 2], false, min_mm, out);
    }
}

/// Cuts a path where it is too thin, and leaves out points that change neither line nor width.
fn emit(points: &[DVec2], widths: &[f64], closed: bool, min_mm: f64, out: &mut Vec<MedialPath>) {
    let thin = widths.iter().position(|&w| w < min_mm);
    let first = match thin {
        None if closed => return out.push(thinned(points, widths, true)),
        // A closed line is read from a place that is too thin, so that its start cuts no bead in two.
        Some(thin) if closed => thin,
        _ => 0,
    };
    let turned = |i: usize| (i + first) % points.len();
    let (points, widths): (Vec<DVec2>, Vec<f64>) =
        (0..points.len()).map(turned).map(|i| (points[i], widths[i])).unzip();
    let wide: Vec<bool> = widths.iter().map(|&w| w >= min_mm).collect();
    let mut i = 0;
    while i < points.len() {
        let end = (i..points.len()).find(|&j| !wide[j]).unwrap_or(points.len());
        if end > i + 1 {
            let path = thinned(&points[i..end], &widths[i..end], false);
            let length: f64 = path.points.windows(2).map(|w| w[0].distance(w[1])).sum();
            if length > 0.5 * min_mm {
                out.push(path);
            }
        }
        i = end + 1;
    }
}

fn thinned(points: &[DVec2], widths: &[f64], closed: bool) -> MedialPath {
    let (mut kept, mut kept_widths) = (vec![points[0]], vec![widths[0]]);
    let n = points.len();
    for i in 1..n {
        let last = kept[kept.len() - 1];
        let next = points[(i + 1) % n];
        // A point is kept where the line bends by more than 5 um, where the width changes by more
        // than 20 um, or after half a millimetre.
        let off = cross(next - last, points[i] - last).abs() / next.distance(last).max(1e-9);
        let width_off = (widths[i] - kept_widths[kept.len() - 1]).abs();
        let far = last.distance(points[i]) > 0.5;
        let tells = i + 1 == n || off > 0.005 || width_off > 0.02 || far;
        if tells && last.distance_squared(points[i]) > 1e-8 {
            kept.push(points[i]);
            kept_widths.push(widths[i]);
        }
    }
    MedialPath { points: kept, widths_mm: kept_widths, closed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::direction;
    use crate::poly::Join;

    fn covered(paths: &[MedialPath]) -> f64 {
        let segment = |p: &MedialPath, i: usize| {
            let j = (i + 1) % p.points.len();
            p.points[i].distance(p.points[j]) * 0.5 * (p.widths_mm[i] + p.widths_mm[j])
        };
        let segments = |p: &MedialPath| p.points.len() - usize::from(!p.closed);
        paths.iter().map(|p| (0..segments(p)).map(|i| segment(p, i)).sum::<f64>()).sum()
    }

    /// A stroke that ends 0.7 of its thickness beside a fork, as the foot of a letter b. It was taken for a corner.
    #[test]
    fn a_short_stroke_beside_a_fork_gets_its_line() {
        for turn in [0.0, 0.3, 1.1, 2.0] {
            let by = direction(turn);
            let bowl = [(0.5, 0.35), (4.0, 1.15), (4.0, 1.65), (0.5, 0.85)];
            let corners = [&[(0.0, 0.0), (0.5, 0.0)], &bowl[..], &[(0.5, 4.0), (0.0, 4.0)]].concat();
            let outer = corners.iter().map(|(x, y)| crate::math::rotated(DVec2::new(*x, *y), by)).collect();
            let paths = medial_axis(&Region::from(Polygon { outer, holes: vec![] }), 0.1, 1.0);
            let foot = crate::math::rotated(DVec2::new(0.25, 0.2), by);
            let near = paths.iter().flat_map(|p| p.points.iter().map(|q| q.distance(foot)));
            let near = near.fold(f64::INFINITY, f64::min);
            assert!(near < 0.01, "{turn}: the nearest line ends {near} mm away");
            // A square end has two corners and no line into either.
            assert_eq!(paths.len(), 2, "{paths:?}");
        }
    }

    #[test]
    fn a_strip_has_one_line_of_its_width() {
        for turn in [0.0, 0.3, 1.1] {
            let by = direction(turn);
            let corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 0.5), (0.0, 0.5)];
            let outer = corners.map(|(x, y)| crate::math::rotated(DVec2::new(x, y), by)).to_vec();
            let paths = medial_axis(&Region::from(Polygon { outer, holes: vec![] }), 0.1, 1.0);
            assert_eq!(paths.len(), 1, "{paths:?}");
            assert!(paths[0].widths_mm.iter().all(|w| (w - 0.5).abs() < 0.03), "{:?}", paths[0].widths_mm);
            assert!((covered(&paths) - 10.0).abs() < 0.4, "{}", covered(&paths));
        }
    }

    #[test]
    fn a_branch_ends_at_the_line_that_goes_on_through_its_fork() {
        // Pockets between discs, joined by necks: branches that went on through their forks would cross pockets and necks.
        let square = Region::rectangle(DVec2::splat(-4.5), DVec2::splat(4.5));
        for (radius, shift) in [(1.25, 0.0), (1.25, 0.4), (1.35, 0.7), (1.4, 0.2)] {
            let disc = |k: i32| {
                let middle = DVec2::new(
                    3.0 * f64::from(k % 3 - 1) + shift * f64::from(k / 3 - 1),
                    3.0 * f64::from(k / 3 - 1),
                );
                let at = |i: u32| middle + radius * direction(f64::from(i) / 60.0 * std::f64::consts::TAU);
                Region::from(Polygon { outer: (0..60).map(at).collect(), holes: vec![] })
            };
            let left = (0..9).fold(square.clone(), |left, k| left.difference(&disc(k)));
            let share = covered(&medial_axis(&left, 0.2, 1.55)) / left.area_mm2();
            assert!(share > 0.8 && share < 1.1, "radius {radius}, shift {shift}: {share}");
        }
    }

    #[test]
    fn a_ring_has_a_closed_line() {
        let disc =
            |r: f64| (0..90).map(|i| direction(f64::from(i) / 90.0 * std::f64::consts::TAU) * r).collect();
        let outer = Region::from(Polygon { outer: disc(10.0), holes: vec![] });
        let ring = outer.difference(&Region::from(Polygon { outer: disc(9.4), holes: vec![] }));
        let paths = medial_axis(&ring, 0.1, 1.0);
        assert!(paths.len() == 1 && paths[0].closed, "{} paths", paths.len());
        assert!((covered(&paths) / ring.area_mm2() - 1.0).abs() < 0.03, "{}", covered(&paths));
    }

    #[test]
    fn a_ring_that_is_too_thin_on_one_side_has_one_line_around_the_rest() {
        for turn in 0..12 {
            // Wherever the line around the ring begins: the ring is 0.05 mm thick on one side and 0.85 mm on the other.
            let circle = |middle: DVec2, radius: f64| {
                let at = |i: i32| middle + radius * direction(f64::from(i) / 180.0 * std::f64::consts::TAU);
                Region::from(Polygon { outer: (0..180).map(at).collect(), holes: vec![] })
            };
            let aside = 0.4 * direction(f64::from(turn) * std::f64::consts::FRAC_PI_6);
            let ring = circle(DVec2::ZERO, 10.0).difference(&circle(aside, 9.55));
            let paths = medial_axis(&ring, 0.2, 1.0);
            assert!(paths.len() == 1 && !paths[0].closed, "turn {turn}: {} paths", paths.len());
            // The thickness is 0.45 - 0.4 cos(angle), and 0.2 or more in all but 103 degrees of the circle.
            let length: f64 = paths[0].points.windows(2).map(|w| w[0].distance(w[1])).sum();
            assert!((length - 9.77 * 257f64.to_radians()).abs() < 0.8, "turn {turn}: {length}");
        }
    }

    #[test]
    fn a_wedge_ends_where_it_is_too_thin_and_a_cross_has_all_its_arms() {
        let wedge = vec![DVec2::ZERO, DVec2::new(20.0, -0.5), DVec2::new(20.0, 0.5)];
        let paths = medial_axis(&Region::from(Polygon { outer: wedge, holes: vec![] }), 0.2, 1.0);
        assert_eq!(
            paths.len(),
            1,
            "{:?}",
            paths
                .iter()
                .map(|p| (p.points[0], p.points[p.points.len() - 1], p.widths_mm[0]))
                .collect::<Vec<_>>()
        );
        let low = paths[0].points.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
        assert!((low - 4.0).abs() < 0.7, "{low}");
        let bar = Region::rectangle(DVec2::new(-10.0, -0.3), DVec2::new(10.0, 0.3));
        let cross = bar.union(&Region::rectangle(DVec2::new(-0.3, -10.0), DVec2::new(0.3, 10.0)));
        let paths = medial_axis(&cross, 0.1, 1.0);
        assert!(
            (covered(&paths) / cross.area_mm2() - 1.0).abs() < 0.06,
            "{} {}",
            paths.len(),
            covered(&paths)
        );
    }

    #[test]
    fn a_comb_of_leftovers_is_survived() {
        let outer =
            (0..400).map(|i| direction(f64::from(i) * 0.0157) * (10.0 + 0.4 * f64::from(i % 7))).collect();
        let star = Region::from(Polygon { outer, holes: vec![] });
        let rest = star.difference(&star.offset(-0.4, Join::Miter(3.0)).offset(0.3, Join::Miter(3.0)));
        for path in medial_axis(&rest, 0.15, 0.8) {
            assert!(path.widths_mm.iter().all(|&w| (0.15..=0.8).contains(&w)));
            assert_eq!(path.points.len(), path.widths_mm.len());
        }
    }
}
