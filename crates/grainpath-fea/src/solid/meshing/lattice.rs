//! The body-centred cubic lattice over a part, finer where walls and gaps are thin: its tetrahedra, which of its points
//! are inside, and where its edges cut the surface.

use std::collections::BTreeSet;

use grainpath_core::{Bvh, DVec3, IVec3, TriMesh, mesh};
use rayon::prelude::*;

use super::wall_thickness;
use crate::solid::model::error::SolidError;
use crate::solid::model::tet_shape;

/// Cells of a block along each axis; blocks are worked on in parallel.
const BLOCK: i32 = 8;
/// Lattice points at most: 9 bytes each.
const MOST_POINTS: f64 = 4e8;
/// Cells along an axis at most: what the key of a point has room for.
const MOST_CELLS: f64 = 65_000.0;
/// A cell is halved so many times at most.
pub(super) const DEEPEST: u32 = 3;
/// Edge of a cell that was not halved, in the units in which points are named: the centres of the smallest are whole.
const CELL: i32 = 2 << DEEPEST;
/// Lattice planes are at most 0.71 cells apart, so a wall this much thinner than its cells still holds points.
pub(super) const CELLS_PER_WALL: f64 = 1.41;

/// A cube of the lattice: how many times it was halved, and its lowest corner.
type Octant = (u32, [i32; 3]);

/// Cells of a regular grid, and which of them are divided into eight, and those again.
pub(super) struct Lattice {
    origin: DVec3,
    /// Half a cell, mm.
    half: DVec3,
    /// Cells along each axis.
    n: IVec3,
    /// 1 inside, -1 outside, at the corners and centres of the cells of the grid.
    sign: Vec<i8>,
    /// What is divided.
    split: BTreeSet<Octant>,
}

/// The tetrahedra of a lattice that have a corner inside.
pub(super) struct Background {
    pub(super) points: Vec<DVec3>,
    /// 1 inside, -1 outside, for each point.
    pub(super) sign: Vec<i8>,
    /// Edge of the smallest cell at each point, mm.
    pub(super) size_mm: Vec<f64>,
    /// Points by which warps and cuts are told apart: corners, then centres of the grid, then what is finer.
    pub(super) tets: Vec<[u32; 4]>,
    /// Where the edges cut the surface, sorted by their ends.
    pub(super) cuts: Vec<Cut>,
}

/// Where an edge of the lattice meets the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    /// The points at the ends, the lower first.
    pub(super) ends: [u32; 2],
    pub(super) at: DVec3,
    /// The way out there: the normal of the surface, zero where the surface has a hole.
    pub(super) normal: DVec3,
    /// Whether the edge runs from the centre of a cell to a corner of it: the short ones.
    pub(super) short: bool,
}

impl Lattice {
    /// Lays cells of about `size_mm` over the mesh so that the faces of its box lie on lattice planes.
    pub(super) fn over(mesh: &TriMesh, size_mm: f64) -> Result<Self, SolidError> {
        let (lo, hi) = mesh.bounds().ok_or(SolidError::NothingInside)?;
        let cells = ((hi - lo) / size_mm).round().max(DVec3::ONE);
        let points = 2.0 * (cells + 2.0).element_product();
        let longest = cells.max_element() / MOST_CELLS;
        if points.is_nan() || points > MOST_POINTS || longest > 1.0 {
            let size_mm = size_mm * (points / MOST_POINTS).cbrt().max(longest);
            return Err(SolidError::TooFine { points, least_mm: size_mm });
        }
        // A part thinner than a cell across keeps cubes: flat ones would be bad tetrahedra.
        let step = ((hi - lo) / cells).max(DVec3::splat(0.6 * size_mm));
        let spare = step * cells - (hi - lo);
        let n = cells.as_ivec3() + 2;
        let origin = lo - step - spare / 2.0;
        let points = corner_count(n) + corner_count(n - 1);
        Ok(Self { origin, half: step / 2.0, n, sign: vec![-1; points], split: BTreeSet::new() })
    }

    fn has(&self, p: IVec3) -> bool {
        let last = if p.x & 1 == 0 { self.n * 2 } else { self.n * 2 - 1 };
        p.cmpge(IVec3::ZERO).all() && p.cmple(last).all()
    }

    /// Of a corner or centre of the grid, in half cells: all even or all odd.
    fn index(&self, p: IVec3) -> usize {
        let (q, m, start) =
            if p.x & 1 == 0 { (p / 2, self.n + 1, 0) } else { (p / 2, self.n, corner_count(self.n)) };
        start + (q.z as usize * m.y as usize + q.y as usize) * m.x as usize + q.x as usize
    }

    fn position(&self, p: IVec3) -> DVec3 {
        self.origin + self.half * p.as_dvec3()
    }

    /// The place of a point in the finest units.
    fn fine_position(&self, p: IVec3) -> DVec3 {
        self.origin + self.half * p.as_dvec3() * (2.0 / f64::from(CELL))
    }

    /// Decides for every point whether it is inside. Only blocks near the surface are looked into.
    pub(super) fn classify(&mut self, bvh: &Bvh, closed: bool) {
        let blocks = (self.n + 1 + BLOCK - 1) / BLOCK;
        let of = |b: i32| IVec3::new(b % blocks.x, b / blocks.x % blocks.y, b / (blocks.x * blocks.y));
        let found: Vec<Vec<i8>> = (0..blocks.element_product())
            .into_par_iter()
            .map(|b| {
                let lo = of(b) * BLOCK;
                let side = Side { bvh, closed, last: None };
                let mut block = Block { lattice: self, lo, signs: Vec::new(), side };
                block.signs.resize(2 * BLOCK.pow(3) as usize, -1);
                block.fill(lo, BLOCK);
                block.signs
            })
            .collect();
        for (b, signs) in (0..).zip(found) {
            for (i, pair) in (0..).zip(signs.chunks_exact(2)) {
                let cell = of(b) * BLOCK + IVec3::new(i % BLOCK, i / BLOCK % BLOCK, i / (BLOCK * BLOCK));
                for (p, &sign) in [cell * 2, cell * 2 + 1].into_iter().zip(pair) {
                    if self.has(p) {
                        let index = self.index(p);
                        self.sign[index] = sign;
                    }
                }
            }
        }
    }

    /// Divides the cells at the surface whose walls or gaps are thin against them, and what must follow so that
    /// neighbours over faces and edges differ by one division at most.
    pub(super) fn refine(&mut self, surface: &TriMesh, bvh: &Bvh, deepest: u32) {
        let found: Vec<Vec<Octant>> = (0..self.n.z)
            .into_par_iter()
            .map(|z| {
                let mut out = Vec::new();
                for y in 0..self.n.y {
                    for x in 0..self.n.x {
                        let lo = IVec3::new(x, y, z) * CELL;
                        self.divide(surface, bvh, (0, lo.to_array()), deepest, &mut out);
                    }
                }
                out
            })
            .collect();
        self.split = found.into_iter().flatten().collect();
        for level in (1..deepest).rev() {
            let here: Vec<Octant> =
                self.split.range((level, [i32::MIN; 3])..(level + 1, [i32::MIN; 3])).copied().collect();
            for (_, lo) in here {
                for i in 0..27 {
                    let step = IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
                    let near = IVec3::from_array(lo) + step * (CELL >> level);
                    if step.abs().element_sum() < 3 && self.covers(near) {
                        self.split.insert(parent(level, near));
                    }
                }
            }
        }
    }

    /// Lists a cell, and what it is divided into, as long as a wall or gap asks for it.
    fn divide(&self, surface: &TriMesh, bvh: &Bvh, cell: Octant, deepest: u32, out: &mut Vec<Octant>) {
        let (level, lo) = cell;
        if level == deepest {
            return;
        }
        let edge = CELL >> level;
        let (lo, edge_mm) = (IVec3::from_array(lo), self.edge_mm(level));
        // The whole cell first: most are far from the surface.
        let middle = self.fine_position(lo + edge / 2);
        if bvh.closest_point(middle, 0.9 * edge_mm).is_none() {
            return;
        }
        let parts = (0..8).map(|i| lo + IVec3::new(i & 1, i >> 1 & 1, i >> 2) * (edge / 2));
        let thin = |p: IVec3| {
            let near = bvh.closest_point(self.fine_position(p + edge / 4), 0.45 * edge_mm)?;
            wall_thickness::least_at(surface, bvh, near.point, near.triangle)
        };
        let least = parts.clone().filter_map(thin).fold(f64::INFINITY, f64::min);
        if edge_mm > CELLS_PER_WALL * least {
            out.push(cell);
            for part in parts {
                self.divide(surface, bvh, (level + 1, part.to_array()), deepest, out);
            }
        }
    }

    fn edge_mm(&self, level: u32) -> f64 {
        2.0 * self.half.max_element() / f64::from(1 << level)
    }

    fn covers(&self, p: IVec3) -> bool {
        p.cmpge(IVec3::ZERO).all() && p.cmplt(self.n * CELL).all()
    }

    /// How many cells are divided.
    pub(super) fn n_split(&self) -> usize {
        self.split.len()
    }

    fn is_split(&self, level: u32, lo: IVec3) -> bool {
        self.split.contains(&(level, lo.to_array()))
    }

    /// The tetrahedra with a corner inside. Between cells of one size they stand around the line of both centres, one
    /// on each edge of the face, halved where the edge is divided; between unlike ones on the eight or two triangles
    /// of the face (Labelle and Shewchuk 2007, graded by an octree).
    pub(super) fn background(&self, surface: &TriMesh, bvh: &Bvh, closed: bool) -> Background {
        let slabs: Vec<Vec<(i32, [IVec3; 4])>> = (0..self.n.z)
            .into_par_iter()
            .map(|z| {
                let mut out = Vec::new();
                for y in 0..self.n.y {
                    for x in 0..self.n.x {
                        self.leaves(0, IVec3::new(x, y, z) * CELL, &mut out);
                    }
                }
                out
            })
            .collect();
        let tets = slabs.concat();
        let mut keys: Vec<u64> = tets.iter().flat_map(|t| t.1).map(key).collect();
        keys.par_sort_unstable();
        keys.dedup();
        let sign: Vec<i8> = keys
            .par_chunks(512)
            .flat_map_iter(|part| {
                let mut side = Side { bvh, closed, last: None };
                part.iter().map(move |&k| self.sign_at(unpack(k), &mut side)).collect::<Vec<_>>()
            })
            .collect();
        let id = |p: IVec3| keys.binary_search(&key(p)).expect("every point is in the list") as u32;
        let mut size = vec![f64::INFINITY; keys.len()];
        let mut kept = Vec::new();
        for (edge, corners) in &tets {
            let t = corners.map(id);
            if t.iter().any(|&i| sign[i as usize] > 0) {
                for i in t {
                    let s = &mut size[i as usize];
                    *s = s.min(self.edge_mm(0) * f64::from(*edge) / f64::from(CELL));
                }
                kept.push(t);
            }
        }
        let mut crossed: Vec<[u32; 2]> = kept
            .iter()
            .flat_map(|t| tet_shape::EDGES.map(|(i, j)| [t[i].min(t[j]), t[i].max(t[j])]))
            .filter(|&[a, b]| sign[a as usize] != sign[b as usize])
            .collect();
        crossed.par_sort_unstable();
        crossed.dedup();
        let points: Vec<DVec3> = keys.iter().map(|&k| self.fine_position(unpack(k))).collect();
        let cut = |&ends: &[u32; 2]| {
            let along = unpack(keys[ends[0] as usize]) - unpack(keys[ends[1] as usize]);
            let short = along.cmpne(IVec3::ZERO).all();
            Cut { ends, at: DVec3::ZERO, normal: DVec3::ZERO, short }
        };
        let cuts = crossed.iter().map(cut).collect();
        let n = points.len();
        let mut background = Background { points, sign, size_mm: size, tets: kept, cuts };
        background.cut_again(surface, bvh, &vec![true; n]);
        background
    }

    fn sign_at(&self, p: IVec3, side: &mut Side<'_>) -> i8 {
        let half = CELL / 2;
        if key(p) >> 60 < 2 { self.sign[self.index(p / half)] } else { side.sign(self.fine_position(p)) }
    }

    /// Tetrahedra of a cell that is not divided, or of its parts, with the edge of the smaller cell they are of.
    fn leaves(&self, level: u32, lo: IVec3, out: &mut Vec<(i32, [IVec3; 4])>) {
        let edge = CELL >> level;
        if self.is_split(level, lo) {
            for i in 0..8 {
                self.leaves(level + 1, lo + IVec3::new(i & 1, i >> 1 & 1, i >> 2) * (edge / 2), out);
            }
            return;
        }
        if level == 0 && self.is_outside(lo) {
            return;
        }
        let centre = lo + edge / 2;
        for axis in 0..3 {
            let (u, v) = (IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]);
            let (u, v) = (u * (edge / 2), v * (edge / 2));
            for e in [IVec3::AXES[axis] * edge, -IVec3::AXES[axis] * edge] {
                let next = lo + e;
                if !self.covers(next) {
                    continue;
                }
                let face = centre + e / 2;
                let ring = [u + v, v - u, -u - v, u - v];
                if self.is_split(level, next) {
                    let middles = [v, -u, -v, u];
                    for i in 0..4 {
                        let (corner, a, b) = (face + ring[i], face + middles[(i + 3) % 4], face + middles[i]);
                        out.push((edge / 2, [centre, face, corner, a]));
                        out.push((edge / 2, [centre, face, corner, b]));
                    }
                } else if level > 0 && !self.split.contains(&parent(level, next)) {
                    let (_, whole) = parent(level, lo);
                    let middle = IVec3::from_array(whole) + edge;
                    let inner = ring.iter().position(|&r| {
                        let p = face + r;
                        (0..3).all(|k| k == axis || p[k] == middle[k])
                    });
                    let Some(inner) = inner else { continue };
                    let at = |i: usize| face + ring[(inner + i) % 4];
                    out.push((edge, [centre, at(0), at(1), at(2)]));
                    out.push((edge, [centre, at(0), at(2), at(3)]));
                } else if e[axis] > 0 {
                    for i in 0..4 {
                        let (a, b) = (face + ring[i], face + ring[(i + 1) % 4]);
                        // Two more cells share this edge.
                        let beyond = ring[i] + ring[(i + 1) % 4];
                        let divided =
                            self.is_split(level, lo + beyond) || self.is_split(level, next + beyond);
                        if divided {
                            let middle = (a + b) / 2;
                            out.push((edge / 2, [centre, centre + e, a, middle]));
                            out.push((edge / 2, [centre, centre + e, middle, b]));
                        } else {
                            out.push((edge, [centre, centre + e, a, b]));
                        }
                    }
                }
            }
        }
    }

    /// Whether nothing of a whole cell and its neighbours over faces is inside; never true beside a divided one.
    fn is_outside(&self, lo: IVec3) -> bool {
        let centre = lo / (CELL / 2) + 1;
        let inside = |p: IVec3| self.has(p) && self.sign[self.index(p)] > 0;
        let near = |i: i32| IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
        let corners = (0..8).map(|i| IVec3::new(i & 1, i >> 1 & 1, i >> 2) * 2 - 1);
        !inside(centre)
            && !corners.clone().any(|c| inside(centre + c))
            && !IVec3::AXES.iter().any(|&e| inside(centre + e * 2) || inside(centre - e * 2))
            && !(0..27).any(|i| self.is_split(0, lo + near(i) * CELL))
    }
}

impl Background {
    /// Finds where edges cut the surface whose ends were moved.
    pub(super) fn cut_again(&mut self, surface: &TriMesh, bvh: &Bvh, moved: &[bool]) {
        let Self { points, sign, cuts, .. } = self;
        cuts.par_iter_mut().filter(|c| c.ends.iter().any(|&i| moved[i as usize])).for_each(|cut| {
            let [a, b] = cut.ends.map(|i| points[i as usize]);
            let (inside, outside) = if sign[cut.ends[0] as usize] > 0 { (a, b) } else { (b, a) };
            let (at, facet) = crossing(bvh, inside, outside);
            let out = facet.map_or(DVec3::ZERO, |t| wall_thickness::normal(surface, t));
            // Where facets overlap or are wound the wrong way, the edge knows better.
            let normal = if out.dot(outside - inside) < 0.0 { -out } else { out };
            (cut.at, cut.normal) = (at, normal);
        });
    }

    /// How far along its edge a cut is, from the lower end.
    pub(super) fn share(&self, cut: &Cut) -> f64 {
        let [a, b] = cut.ends.map(|i| self.points[i as usize]);
        a.distance(cut.at) / a.distance(b)
    }
}

/// What a cell is a part of.
fn parent(level: u32, lo: IVec3) -> Octant {
    let whole = CELL >> (level - 1);
    (level - 1, (lo / whole * whole).to_array())
}

/// Sorts corners of the grid first, then its centres, then what is finer; each by place.
fn key(p: IVec3) -> u64 {
    let of = |m: i32| (p % CELL).cmpeq(IVec3::splat(m)).all();
    let class = if of(0) {
        0
    } else if of(CELL / 2) {
        1
    } else {
        2
    };
    class << 60 | (p.z as u64) << 40 | (p.y as u64) << 20 | p.x as u64
}

fn unpack(key: u64) -> IVec3 {
    let part = |shift: u32| (key >> shift & 0xf_ffff) as i32;
    IVec3::new(part(0), part(20), part(40))
}

fn corner_count(n: IVec3) -> usize {
    (n + 1).as_u64vec3().element_product() as usize
}

/// Whether every edge has two opposite uses, so that the inside changes only across a triangle.
pub(super) fn is_closed(mesh: &TriMesh) -> bool {
    mesh::diagnose(mesh).is_some_and(|h| h.is_closed())
}

/// Where the way out of the part leaves it, and through which facet.
fn crossing(bvh: &Bvh, inside: DVec3, outside: DVec3) -> (DVec3, Option<u32>) {
    let along = outside - inside;
    let hits = bvh.hits(inside, along, (-1e-9, 1.0 + 1e-9));
    let at = |t: f64| inside + along * t.clamp(0.0, 1.0);
    match hits.as_slice() {
        [] => {
            // A hole in the mesh: find where the winding number falls below one half.
            let (mut near, mut far) = (0.0, 1.0);
            for _ in 0..16 {
                let middle = 0.5 * (near + far);
                if bvh.contains(at(middle)) { near = middle } else { far = middle }
            }
            (at(0.5 * (near + far)), None)
        }
        [only] => (at(only.t), Some(only.triangle)),
        several => {
            let gaps = several.windows(2).filter(|w| w[1].t - w[0].t > 1e-9);
            let out = gaps.into_iter().find(|w| !bvh.contains(at(0.5 * (w[0].t + w[1].t))));
            let hit = out.map_or(several[several.len() - 1], |w| w[0]);
            (at(hit.t), Some(hit.triangle))
        }
    }
}

struct Block<'a> {
    lattice: &'a Lattice,
    lo: IVec3,
    /// Sign of the corner and of the centre of each cell.
    signs: Vec<i8>,
    side: Side<'a>,
}

/// On which side of the surface points are.
struct Side<'a> {
    bvh: &'a Bvh,
    closed: bool,
    /// The point whose side was found last.
    last: Option<(DVec3, i8)>,
}

impl Block<'_> {
    fn fill(&mut self, lo: IVec3, size: i32) {
        let from = self.lattice.position(lo * 2);
        let to = self.lattice.position((lo + size) * 2 - 1);
        let middle = 0.5 * (from + to);
        if self.side.bvh.closest_point(middle, 1.001 * middle.distance(to)).is_none() {
            let sign = self.side.sign(middle);
            for i in 0..size.pow(3) {
                let cell = lo + IVec3::new(i % size, i / size % size, i / (size * size));
                self.set(cell, [sign; 2]);
            }
        } else if size > 1 {
            for i in 0..8 {
                self.fill(lo + IVec3::new(i & 1, i >> 1 & 1, i >> 2) * (size / 2), size / 2);
            }
        } else {
            let pair = [from, to].map(|p| self.side.sign(p));
            self.set(lo, pair);
        }
    }

    fn set(&mut self, cell: IVec3, signs: [i8; 2]) {
        let q = cell - self.lo;
        let at = 2 * ((q.z * BLOCK + q.y) * BLOCK + q.x) as usize;
        self.signs[at..at + 2].copy_from_slice(&signs);
    }
}

impl Side<'_> {
    /// 1 inside and -1 outside, as the winding number says; where nothing lies between this point and the last, it is
    /// on the same side.
    fn sign(&mut self, p: DVec3) -> i8 {
        let same = self
            .last
            .filter(|&(q, _)| self.closed && self.bvh.first_hit(q, p - q, (-1e-9, 1.0 + 1e-9)).is_none());
        let sign = same.map_or_else(|| if self.bvh.contains(p) { 1 } else { -1 }, |(_, sign)| sign);
        self.last = Some((p, sign));
        sign
    }
}
