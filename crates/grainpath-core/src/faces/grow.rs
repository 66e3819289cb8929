//! Finds curved faces: a model is fitted to a small patch and the patch grown while all vertices lie on the model.

use glam::DVec3;

use super::face_kind::Surface;
use super::fit::{Model, Shape};
use super::graph::{Graph, NONE};
use super::planes::Pieces;
use crate::DisjointSets;

/// The kind of a face, before the face is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A plane.
    Plane,
    /// A curved model, and whether the material lies on its outer side, as around a hole.
    Curved(Model, bool),
    /// A free surface, which fits no model.
    Free,
}

impl Kind {
    /// The public description of the surface, for a face with this centroid and mean normal.
    pub(super) fn surface(&self, centroid: DVec3, normal: DVec3) -> Surface {
        let (model, hollow) = match *self {
            Self::Plane => return Surface::Plane { normal },
            Self::Free => return Surface::Free,
            Self::Curved(model, hollow) => (model, hollow),
        };
        match model {
            Model::Sphere(centre, radius_mm) => Surface::Sphere { centre, radius_mm, hollow },
            Model::Turned { point, axis, slope, .. } => {
                let point = point + (centroid - point).dot(axis) * axis;
                let radius_mm = model.radius_at(point);
                if slope == 0.0 {
                    let largest = DVec3::AXES.into_iter().map(|a| axis.dot(a));
                    let sign = largest.fold(0.0, |l: f64, c| if c.abs() > l.abs() + 1e-9 { c } else { l });
                    Surface::Cylinder { point, axis: axis * sign.signum(), radius_mm, hollow }
                } else {
                    let half_angle_rad = model.half_angle().abs();
                    Surface::Cone { point, axis: axis * slope.signum(), radius_mm, half_angle_rad, hollow }
                }
            }
        }
    }
}

/// Cosine of the angle above which an edge is sharp: 40 degrees. Exporters let neighbouring facets of a
/// curved face differ by at most 30 degrees; a hexagon and an octagon have edges of 60 and 45 degrees.
/// Source: derived from these, midway.
pub(super) const SHARP: f64 = 0.766;

/// Numbers of pieces in the patches that are tried after strips. Source: derived: 6, 16 and 40 are one, two and three
/// rings of triangles.
const PATCHES: [usize; 3] = [6, 16, 40];
/// Greatest number of neighbours of a piece from which strips are formed. Source: derived: a facet has four sides.
const MAX_SIDES: usize = 4;
/// Greatest ratio of the squared bends at both sides of a strip that counts as equal. Source: derived: the
/// bends may differ by 25 %; the bend from a facet to a tangent plane is half of that between facets.
const ALIKE: f64 = 1.6;
/// A piece with more triangles than this counts as a plane and starts no patch. Source: derived: a strip
/// of a curved surface has two triangles, or a few hundred if the surface was remeshed.
const MAX_OF_PIECE: usize = 256;
/// The search ends after this many points in the fits of failed seeds. Source: derived: a step of a fit
/// takes about 0.1 microseconds per point and a fit has 12 steps, so that this is half a second; for a
/// million triangles two seconds are allowed.
const MAX_IN_VAIN: usize = 400_000;
/// Greatest number of vertices that a fit uses. Source: derived: with 400 points the error of a fit is a
/// twentieth of the rounding of one vertex.
const FIT_POINTS: usize = 400;
/// Vertices may lie off the model by this many times the rounding. Source: derived: for evenly distributed
/// rounding this is more than three standard deviations.
const OFF: f64 = 3.0;
/// Vertices may lie off the model by at most this share of the face's sagitta; otherwise a small patch of
/// any smooth surface would fit some cylinder. Source: derived: 1 % of the radius.
const OFF_OF_SAGITTA: f64 = 0.01;
/// Least cosine of the angle between a triangle and the model at its centroid. Source: derived: 35 degrees;
/// with edges of up to 40 degrees a triangle deviates by half of that, a slender one somewhat more.
const ALONG: f64 = 0.82;
/// The centre of a facet may lie off the model by this many times the median in the patch, since facets of
/// one surface have about the same width. Source: derived: 3 allows 1.7 times the width.
const WIDER: f64 = 3.0;
/// Cosine of the angle by which normals must turn over a face for it to count as curved: 15 degrees.
/// Source: derived: half of the widest angle between facets of an exporter.
const TURNED: f64 = 0.966;

/// Labels the triangles of curved faces in `label`. Returns the kind of the face for each label.
pub(super) fn curved(graph: &Graph, pieces: &Pieces, label: &mut [u32]) -> Vec<Kind> {
    let mut search = Search { graph, pieces, stamp: vec![0; graph.len()], now: 0, looked_at: 0 };
    let mut kinds = Vec::new();
    let mut in_vain = 0;
    for members in &pieces.members {
        if in_vain >= MAX_IN_VAIN {
            break;
        }
        let free = members.iter().all(|&t| label[t as usize] == NONE);
        if !free || members.len() > MAX_OF_PIECE || graph.area[members[0] as usize] <= 0.0 {
            continue;
        }
        let before = search.looked_at;
        match search.around_seed(members[0], label) {
            Some((kind, region)) => {
                region.iter().for_each(|&t| label[t as usize] = kinds.len() as u32);
                kinds.push(kind);
            }
            // The 1 makes seeds without neighbours count as well.
            None => in_vain += search.looked_at - before + 1,
        }
    }
    join_chains(graph, label, &mut kinds);
    kinds
}

/// Greatest ratio of bends, and of lengths, between rings of facets that form one curved profile. Source:
/// derived: as [`ALIKE`], 25 %.
const EVEN: f64 = 1.25;

/// A cone or cylinder with its extent, for [`join_chains`].
struct Ring {
    point: DVec3,
    axis: DVec3,
    /// Angle between the profile and the axis, and length of the profile.
    angle: f64,
    length: f64,
}

/// Joins rings of facets around a common axis if the bend from ring to ring is even. They form a torus or
/// another surface of revolution, of which each ring lies on a cone.
fn join_chains(graph: &Graph, label: &mut [u32], kinds: &mut [Kind]) {
    let mut range = vec![(f64::INFINITY, f64::NEG_INFINITY); kinds.len()];
    let axis_of = |kind: &Kind| match kind {
        Kind::Curved(Model::Turned { point, axis, .. }, _) => Some((*point, *axis)),
        Kind::Curved(Model::Sphere(..), _) | Kind::Plane | Kind::Free => None,
    };
    let mut pairs = Vec::new();
    for t in (0..graph.len()).filter(|&t| label[t] != NONE) {
        let own = label[t];
        let Some((point, axis)) = axis_of(&kinds[own as usize]) else { continue };
        for p in graph.points(t) {
            let along = (p - point).dot(axis);
            let r = &mut range[own as usize];
            *r = (r.0.min(along), r.1.max(along));
        }
        let beyond = graph.around(t).filter(|&n| label[n] != NONE && graph.cosine(t, n) > SHARP);
        pairs.extend(beyond.map(|n| (own.min(label[n]), own.max(label[n]))).filter(|(a, b)| a != b));
    }
    pairs.sort_unstable();
    pairs.dedup();
    let ring = |id: u32| {
        let (point, axis) = axis_of(&kinds[id as usize])?;
        let Kind::Curved(model, _) = kinds[id as usize] else { return None };
        let (low, high) = range[id as usize];
        let angle = model.half_angle();
        Some(Ring { point, axis, angle, length: (high - low) / crate::math::cos(angle) })
    };
    let bend = |a: &Ring, b: &Ring| {
        let way = a.axis.dot(b.axis);
        let off = (b.point - a.point) - (b.point - a.point).dot(a.axis) * a.axis;
        let slack = 1e-3 * a.length.max(b.length);
        let coaxial = way.abs() > 1.0 - 1e-5 && off.length() <= slack.max(OFF * graph.tolerance);
        let even = a.length <= EVEN * b.length && b.length <= EVEN * a.length;
        (coaxial && even).then(|| (a.angle - way.signum() * b.angle).abs())
    };
    let bends: Vec<(u32, u32, f64)> =
        pairs.into_iter().filter_map(|(a, b)| Some((a, b, bend(&ring(a)?, &ring(b)?)?))).collect();
    let mut sets = DisjointSets::new(kinds.len());
    for (i, &(a, b, x)) in bends.iter().enumerate() {
        for &(c, d, y) in &bends[i + 1..] {
            let touch = a == c || a == d || b == c || b == d;
            if touch && x <= EVEN * y && y <= EVEN * x {
                sets.union(a as usize, b as usize);
                sets.union(c as usize, d as usize);
            }
        }
    }
    let names = sets.names();
    for (id, &name) in names.iter().enumerate() {
        if name as usize != id {
            kinds[name as usize] = Kind::Free;
        }
    }
    label.iter_mut().filter(|l| **l != NONE).for_each(|l| *l = names[*l as usize]);
}

struct Search<'a> {
    graph: &'a Graph<'a>,
    pieces: &'a Pieces,
    /// The number of the growth (`now`) that last visited each triangle.
    stamp: Vec<u32>,
    now: u32,
    /// Number of points in all fits so far.
    looked_at: usize,
}

/// A grown region.
struct Grown {
    model: Model,
    hollow: bool,
    region: Vec<u32>,
    area: f64,
    /// Mean distance of the facet centres from the model, weighted by area.
    chord: f64,
}

impl Search<'_> {
    /// The best curved face that contains the piece of this triangle.
    fn around_seed(&mut self, seed: u32, label: &[u32]) -> Option<(Kind, Vec<u32>)> {
        for patch in self.strips(seed, label) {
            if let (_, Some(found)) = self.best(&patch, label) {
                return Some(found);
            }
        }
        for n_pieces in PATCHES {
            let patch = self.patch(seed, n_pieces, label)?;
            match self.best(&patch, label) {
                (_, Some(found)) => return Some(found),
                // If no model fits this patch, none fits a larger one either, since each larger patch contains this one.
                (false, None) => return None,
                (true, None) => {}
            }
        }
        None
    }

    /// Whether a model fits a patch, and the best face grown from it.
    fn best(&mut self, patch: &[u32], label: &[u32]) -> (bool, Option<(Kind, Vec<u32>)>) {
        let mut best: Option<Grown> = None;
        let mut fits = false;
        for shape in [Shape::Sphere, Shape::Cylinder, Shape::Cone] {
            let Some(model) = self.fit(shape, patch) else { continue };
            fits = true;
            let Some(grown) = self.grown(shape, model, patch, label) else { continue };
            // Of regions of equal size, the model nearer to its facets is taken: the vertices of a ring of
            // facets lie on a cylinder and also on a sphere through both circles.
            let better = best.as_ref().is_none_or(|b| {
                grown.area > 1.02 * b.area || (grown.area > 0.98 * b.area && grown.chord < 0.9 * b.chord)
            });
            if better {
                best = Some(grown);
            }
        }
        (fits, best.map(|g| (Kind::Curved(g.model, g.hollow), g.region)))
    }

    /// The unlabelled neighbours of a piece across smooth edges, with the cosines of the bends.
    fn smooth_neighbours(&self, id: u32, label: &[u32]) -> Vec<(u32, f64)> {
        let mut found: Vec<(u32, f64)> = Vec::new();
        for &t in self.pieces.members[id as usize].iter().take(MAX_OF_PIECE) {
            for n in self.graph.around(t as usize) {
                let (other, cosine) = (self.pieces.piece_of[n], self.graph.cosine(t as usize, n));
                let is_new = other != id && found.iter().all(|f| f.0 != other);
                if is_new && cosine > SHARP && label[n] == NONE {
                    found.push((other, cosine));
                }
            }
        }
        found
    }

    /// Patches of three pieces that bend equally on both sides of the middle one, the seed's: strips of a
    /// cylinder or a cone, facets of a sphere. If the bends differ, another face begins there.
    fn strips(&self, seed: u32, label: &[u32]) -> Vec<Vec<u32>> {
        let id = self.pieces.piece_of[seed as usize];
        let around = self.smooth_neighbours(id, label);
        let members = |id: u32| self.pieces.members[id as usize].iter().take(MAX_OF_PIECE).copied();
        let mut patches = Vec::new();
        for (i, a) in around.iter().enumerate().take(MAX_SIDES) {
            for b in around[i + 1..].iter().take(MAX_SIDES) {
                // 1 - cosine is half the squared bend.
                let (x, y) = (1.0 - a.1, 1.0 - b.1);
                if x <= ALIKE * y && y <= ALIKE * x {
                    patches.push(members(id).chain(members(a.0)).chain(members(b.0)).collect());
                }
            }
        }
        patches
    }

    /// The triangles of the nearest `n_pieces` pieces around a triangle, reached across smooth edges. `None`
    /// if there are fewer than three pieces.
    fn patch(&self, seed: u32, n_pieces: usize, label: &[u32]) -> Option<Vec<u32>> {
        let mut ids = vec![self.pieces.piece_of[seed as usize]];
        let mut patch = Vec::new();
        let mut at = 0;
        while let Some(&id) = ids.get(at) {
            at += 1;
            patch.extend(self.pieces.members[id as usize].iter().take(MAX_OF_PIECE));
            if ids.len() < n_pieces {
                for (other, _) in self.smooth_neighbours(id, label) {
                    if ids.len() < n_pieces && !ids.contains(&other) {
                        ids.push(other);
                    }
                }
            }
        }
        (ids.len() >= 3).then_some(patch)
    }

    /// Fits a model of this kind to triangles; `None` unless all their vertices lie on it.
    fn fit(&mut self, shape: Shape, triangles: &[u32]) -> Option<Model> {
        let (points, normals) = self.samples(triangles);
        self.looked_at += points.len();
        let unknowns = match shape {
            Shape::Sphere => 4,
            Shape::Cylinder => 5,
            Shape::Cone => 6,
        };
        if points.len() < unknowns {
            return None;
        }
        let model = Model::fitted(shape, &points, &normals)?;
        (model.worst(&points) <= OFF * self.graph.tolerance).then_some(model)
    }

    /// Vertices of the triangles, without duplicates, and normals with areas; both thinned evenly to [`FIT_POINTS`].
    fn samples(&self, triangles: &[u32]) -> (Vec<DVec3>, Vec<(DVec3, f64)>) {
        let step = triangles.len().div_ceil(FIT_POINTS).max(1);
        let taken = || triangles.iter().step_by(step).map(|&t| t as usize);
        let mut vertices: Vec<u32> = taken().flat_map(|t| self.graph.corners[t]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let thin = vertices.len().div_ceil(FIT_POINTS).max(1);
        let points = vertices.into_iter().step_by(thin).map(|v| self.graph.vertex(v)).collect();
        (points, taken().map(|t| (self.graph.normal[t], self.graph.area[t])).collect())
    }

    /// Grows a region from a patch and refits the model whenever the region is four times as large.
    fn grown(&mut self, shape: Shape, first: Model, patch: &[u32], label: &[u32]) -> Option<Grown> {
        let sign = |model: &Model| {
            let along = |t: &u32| {
                let t = *t as usize;
                self.graph.area[t] * model.normal(self.graph.centroid(t)).dot(self.graph.normal[t])
            };
            if patch.iter().map(along).sum::<f64>() < 0.0 { -1.0 } else { 1.0 }
        };
        let side = sign(&first);
        let widest = |model: &Model| {
            let mut all: Vec<f64> =
                patch.iter().map(|&t| model.distance(self.graph.centroid(t as usize)).abs()).collect();
            all.sort_unstable_by(f64::total_cmp);
            // The median is used, since the widest facet of a patch may belong to a plane that runs into the face.
            WIDER * all[all.len() / 2] + self.graph.tolerance
        };
        let mut chord = widest(&first);
        let mut model = first;
        let mut limit = 4 * patch.len().max(4);
        let (mut region, mut rounds) = (Vec::new(), 0);
        loop {
            let before = region.len();
            region = self.reach(&model, side, chord, patch, label, limit)?;
            let complete = region.len() < limit;
            let refit = self.fit(shape, &region)?;
            (model, chord) = (refit, widest(&refit));
            if complete {
                rounds += 1;
                // The better fit may reach further. Three rounds find all facets, except perhaps the last one.
                if region.len() == before || rounds > 3 {
                    break;
                }
            } else {
                limit = region.len() * 4;
            }
        }
        self.judged(shape, model, side, region)
    }

    /// The connected triangles around a patch whose vertices lie on a model, up to about `limit` of them.
    /// `None` if the patch itself does not lie on it.
    fn reach(
        &mut self,
        model: &Model,
        side: f64,
        chord: f64,
        patch: &[u32],
        label: &[u32],
        limit: usize,
    ) -> Option<Vec<u32>> {
        self.now += 1;
        let graph = self.graph;
        let off = OFF * graph.tolerance;
        let belongs = |t: usize| {
            let middle = graph.centroid(t);
            let along = side * model.normal(middle).dot(graph.normal[t]);
            let smooth = graph.normal[t] == DVec3::ZERO || along > ALONG;
            smooth
                && model.distance(middle).abs() <= chord
                && graph.points(t).iter().all(|p| model.distance(*p).abs() <= off)
        };
        if !patch.iter().all(|&t| belongs(t as usize)) {
            return None;
        }
        let mut region = patch.to_vec();
        patch.iter().for_each(|&t| self.stamp[t as usize] = self.now);
        let mut at = 0;
        while at < region.len() && region.len() < limit {
            let t = region[at] as usize;
            at += 1;
            for n in graph.around(t) {
                if self.stamp[n] == self.now || label[n] != NONE {
                    continue;
                }
                if graph.cosine(t, n) > SHARP && belongs(n) {
                    self.stamp[n] = self.now;
                    region.push(n as u32);
                }
            }
        }
        Some(region)
    }

    /// The finished region if it counts as a curved face, otherwise `None`.
    fn judged(&self, shape: Shape, model: Model, side: f64, mut region: Vec<u32>) -> Option<Grown> {
        let graph = self.graph;
        region.sort_unstable();
        let mut ids: Vec<u32> = region.iter().map(|&t| self.pieces.piece_of[t as usize]).collect();
        ids.sort_unstable();
        ids.dedup();
        let (points, normals) = self.samples(&region);
        // Least numbers of pieces and vertices. With more vertices than unknowns, a close fit is no coincidence.
        let needed = match shape {
            Shape::Cylinder => (3, 8),
            Shape::Sphere => (6, 8),
            Shape::Cone => (4, 9),
        };
        if ids.len() < needed.0 || points.len() < needed.1 {
            return None;
        }
        let start = normals.first()?.0;
        let turn = normals.iter().map(|(n, _)| n.dot(start)).fold(1.0, f64::min);
        let extent = points.iter().map(|p| p.distance(points[0])).fold(0.0, f64::max);
        let mean_normal = normals.iter().map(|(n, w)| *n * *w).sum::<DVec3>().normalize_or_zero();
        let heights = points.iter().map(|p| (*p - points[0]).dot(mean_normal));
        let (low, high) = heights.fold((0.0f64, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
        // The normals of a closed ring cancel; its size is taken for the sagitta.
        let sagitta = if mean_normal == DVec3::ZERO { extent } else { high - low };
        let worst = model.worst(&points);
        // A face of many facets that turns by less is curved too if its sagitta is far above the tolerance.
        let bent = turn < TURNED || (ids.len() >= 12 && sagitta > 20.0 * OFF * graph.tolerance);
        if !bent || worst > OFF_OF_SAGITTA * sagitta {
            return None;
        }
        let (mut area, mut chord) = (0.0, 0.0);
        for &t in &region {
            let t = t as usize;
            area += graph.area[t];
            chord += graph.area[t] * model.distance(graph.centroid(t)).abs();
        }
        // A cone whose radius changes by little more than the rounding is a cylinder.
        if shape == Shape::Cone && model.half_angle().abs() * extent < 10.0 * OFF * graph.tolerance {
            return None;
        }
        Some(Grown { model, hollow: side < 0.0, region, area, chord: chord / area })
    }
}
