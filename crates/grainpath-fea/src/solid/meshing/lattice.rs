//! The body-centred cubic lattice over a part: its tetrahedra, the side of the surface on which its points
//! lie, and the points where its edges cut the surface.
//!
//! Method: the background grid of isosurface stuffing (`labelle2007`), graded by an octree. A cell at the
//! surface is halved, up to three times, while its edge is more than 1.41 times the thinnest wall or gap
//! measured in it; within that factor a wall still holds lattice points. Neighbouring cells then differ by
//! one level at most. A point is inside if its winding number says so (`barill2018`). Blocks of cells without
//! a facet near share one sign. In a closed surface a point also takes the sign of the point before it if no
//! facet lies between them.
//!
//! Lengths are in mm. Points are named by whole numbers in units of a sixteenth of a cell, so that equal
//! points are equal without tolerance. They are numbered by kind and position, so the mesh is the same for
//! any number of threads. Cost: linear in the cells near the surface; distant points are classified in
//! blocks. Memory: one byte for each lattice point, and the list of tetrahedra with a corner inside.
//!
//! Limits: a lattice of more than 4e8 points or 65 000 cells along an axis is refused with the smallest size
//! that fits, before memory is taken. A part thinner than a cell keeps nearly cubic cells. Where an edge
//! meets several facets, the cut is where it first leaves the part. Where it passes a hole of the surface,
//! the cut is where the winding number falls below one half, found by 16 bisections, and has no normal.

use std::collections::BTreeSet;

use grainpath_core::{Bvh, DVec3, IVec3, TriMesh, mesh};
use rayon::prelude::*;

use super::wall_thickness;
use crate::solid::model::error::SolidError;
use crate::solid::model::tet_shape;

/// Cells of a block along each axis. Blocks are processed in parallel.
/// Source: chosen; it changes speed alone, never the result.
const BLOCK: i32 = 8;
/// Largest number of lattice points. Source: derived. A byte for the sign of each makes 400 MB.
const MOST_POINTS: f64 = 4e8;
/// Largest number of cells along an axis. Source: derived: 65 000 cells of 16 units are 1.04e6,
/// less than the 2^20 values of the 20 bits that a point's key has for an axis.
const MOST_CELLS: f64 = 65_000.0;
/// Largest number of times that a cell is halved.
pub(super) const DEEPEST: u32 = 3;
/// Edge of an undivided cell, in the integer units that name points. With this value even the
/// centres of the smallest cells have whole coordinates.
const CELL: i32 = 2 << DEEPEST;
/// A wall still holds lattice points if it is up to this many times thinner than its cells. Source:
/// derived: the lattice planes that lie farthest apart, of type (110), are 1 / sqrt 2 = 0.71 cells apart.
pub(super) const CELLS_PER_WALL: f64 = 1.41;

/// A cube of the lattice: the number of halvings, and the lowest corner.
type Octant = (u32, [i32; 3]);

/// A regular grid of cells, some of which are divided into eight, over several levels.
pub(super) struct Lattice {
    origin: DVec3,
    /// Half a cell, mm.
    half: DVec3,
    /// Cells along each axis.
    n: IVec3,
    /// 1 inside, -1 outside, at the corners and centres of the cells of the grid.
    sign: Vec<i8>,
    /// The cubes that are divided.
    split: BTreeSet<Octant>,
}

/// The tetrahedra of a lattice that have a corner inside.
pub(super) struct Background {
    pub(super) points: Vec<DVec3>,
    /// 1 inside, -1 outside, for each point.
    pub(super) sign: Vec<i8>,
    /// Edge of the smallest cell around each point, mm.
    pub(super) size_mm: Vec<f64>,
    /// Corners of the tetrahedra. Corners of the grid have the lowest numbers, then its centres,
    /// then finer points; ties between moves or cuts are broken by this order.
    pub(super) tets: Vec<[u32; 4]>,
    /// Points where edges cut the surface, sorted by the ends of the edges.
    pub(super) cuts: Vec<Cut>,
}

/// The point where an edge of the lattice meets the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    /// The points at the ends, the lower first.
    pub(super) ends: [u32; 2],
    pub(super) at: DVec3,
    /// Outward normal of the surface; zero in a hole of the surface.
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
        // Checked before memory is taken. The message names the smallest size that fits.
        if points.is_nan() || points > MOST_POINTS || longest > 1.0 {
            let size_mm = size_mm * (points / MOST_POINTS).cbrt().max(longest);
            return Err(SolidError::TooFine { points, least_mm: size_mm });
        }
        // A part thinner than a cell across keeps cubic cells: flat ones would give bad tetrahedra.
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

    /// Index of a corner or centre of the grid; `p` is in half cells, all even or all odd.
    fn index(&self, p: IVec3) -> usize {
        let (q, m, start) =
            if p.x & 1 == 0 { (p / 2, self.n + 1, 0) } else { (p / 2, self.n, corner_count(self.n)) };
        start + (q.z as usize * m.y as usize + q.y as usize) * m.x as usize + q.x as usize
    }

    fn position(&self, p: IVec3) -> DVec3 {
        self.origin + self.half * p.as_dvec3()
    }

    /// Position of a point given in the finest units, mm.
    fn fine_position(&self, p: IVec3) -> DVec3 {
        self.origin + self.half * p.as_dvec3() * (2.0 / f64::from(CELL))
    }

    /// Finds the sign of every point. Only blocks near the surface are examined point by point.
    pub(super) fn classify(&mut self, bvh: &Bvh, closed: bool) {
        let blocks = (self.n + 1 + BLOCK - 1) / BLOCK;
        let block_at = |b: i32| IVec3::new(b % blocks.x, b / blocks.x % blocks.y, b / (blocks.x * blocks.y));
        let found: Vec<Vec<i8>> = (0..blocks.element_product())
            .into_par_iter()
            .map(|b| {
                let lo = block_at(b) * BLOCK;
                let side = Side { bvh, closed, last: None };
                let mut block = Block { lattice: self, lo, signs: Vec::new(), side };
                block.signs.resize(2 * BLOCK.pow(3) as usize, -1);
                block.fill(lo, BLOCK);
                block.signs
            })
            .collect();
        for (b, signs) in (0..).zip(found) {
            for (i, pair) in (0..).zip(signs.chunks_exact(2)) {
                let cell =
                    block_at(b) * BLOCK + IVec3::new(i % BLOCK, i / BLOCK % BLOCK, i / (BLOCK * BLOCK));
                for (p, &sign) in [cell * 2, cell * 2 + 1].into_iter().zip(pair) {
                    if self.has(p) {
                        let index = self.index(p);
                        self.sign[index] = sign;
                    }
                }
            }
        }
    }

    /// Volume of the cells whose centre is inside, mm3.
    pub(super) fn inside_mm3(&self) -> f64 {
        let centres = &self.sign[corner_count(self.n)..];
        let n_inside = centres.iter().filter(|sign| **sign > 0).count();
        8.0 * self.half.element_product() * n_inside as f64
    }

    /// Divides the cells at the surface where walls or gaps are thin compared with them. Further
    /// cells are divided until neighbours over faces and edges differ by one level at most.
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
        // Cells are processed from fine to coarse, because a division made for balance may require
        // another one on the next coarser level.
        for level in (1..deepest).rev() {
            let here: Vec<Octant> =
                self.split.range((level, [i32::MIN; 3])..(level + 1, [i32::MIN; 3])).copied().collect();
            for (_, lo) in here {
                for i in 0..27 {
                    let step = IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
                    let near = IVec3::from_array(lo) + step * (CELL >> level);
                    // Only neighbours over faces and edges count, because tetrahedra do not connect
                    // cubes that share only a corner.
                    if step.abs().element_sum() < 3 && self.covers(near) {
                        self.split.insert(parent(level, near));
                    }
                }
            }
        }
    }

    /// Lists a cell, and then its eight parts in the same way, while a wall or gap is thin compared
    /// with the cell.
    fn divide(&self, surface: &TriMesh, bvh: &Bvh, cell: Octant, deepest: u32, out: &mut Vec<Octant>) {
        let (level, lo) = cell;
        if level == deepest {
            return;
        }
        let edge = CELL >> level;
        let (lo, edge_mm) = (IVec3::from_array(lo), self.edge_mm(level));
        // The whole cell is tested first, because most cells are far from the surface.
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

    /// Number of divided cells.
    pub(super) fn n_split(&self) -> usize {
        self.split.len()
    }

    fn is_split(&self, level: u32, lo: IVec3) -> bool {
        self.split.contains(&(level, lo.to_array()))
    }

    /// The tetrahedra with a corner inside. Between cells of one size they stand around the line
    /// between both centres, one on each edge of the face, halved where the edge is divided.
    /// Between cells of different size they stand on the eight or two triangles of the face
    /// (`labelle2007`).
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
        // Points are numbered by sorting their keys: no hash table, and the same numbers for any
        // number of threads.
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
            // Tetrahedra without a corner inside cannot contribute to the part.
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
            // An edge between a point inside and a point outside meets the surface. Each such edge
            // is kept once.
            .filter(|&[a, b]| sign[a as usize] != sign[b as usize])
            .collect();
        crossed.par_sort_unstable();
        crossed.dedup();
        let points: Vec<DVec3> = keys.iter().map(|&k| self.fine_position(unpack(k))).collect();
        let cut = |&ends: &[u32; 2]| {
            let along = unpack(keys[ends[0] as usize]) - unpack(keys[ends[1] as usize]);
            // Short edges run along the cube's diagonal, from a corner to a centre: they differ in
            // all three coordinates.
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

    /// Adds the tetrahedra of an undivided cell, or of the parts of a divided one, each with the
    /// edge of the smaller cell that it belongs to.
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
                // The neighbour is finer: two triangles on each quarter of the face.
                if self.is_split(level, next) {
                    let middles = [v, -u, -v, u];
                    for i in 0..4 {
                        let (corner, a, b) = (face + ring[i], face + middles[(i + 3) % 4], face + middles[i]);
                        out.push((edge / 2, [centre, face, corner, a]));
                        out.push((edge / 2, [centre, face, corner, b]));
                    }
                } else if level > 0 && !self.split.contains(&parent(level, next)) {
                    // The neighbour is coarser: two triangles on this quarter, split through the
                    // corner at the middle of the large face.
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
                    // Equal neighbours share their tetrahedra; the lower one makes them.
                    for i in 0..4 {
                        let (a, b) = (face + ring[i], face + ring[(i + 1) % 4]);
                        // Two more cells share this edge. If one of them is divided, the edge has a
                        // middle point.
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

    /// Whether a whole cell and its neighbours over faces have no point inside; never true beside a
    /// divided cell.
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
    /// Finds the cuts anew on edges of which an end was moved.
    pub(super) fn cut_again(&mut self, surface: &TriMesh, bvh: &Bvh, moved: &[bool]) {
        let Self { points, sign, cuts, .. } = self;
        cuts.par_iter_mut().filter(|c| c.ends.iter().any(|&i| moved[i as usize])).for_each(|cut| {
            let [a, b] = cut.ends.map(|i| points[i as usize]);
            let (inside, outside) = if sign[cut.ends[0] as usize] > 0 { (a, b) } else { (b, a) };
            let (at, facet) = crossing(bvh, inside, outside);
            let out = facet.map_or(DVec3::ZERO, |t| surface.normal(surface.triangles[t as usize]));
            // Facets may overlap or be wound the wrong way, so the normal is turned to point outwards along the edge.
            let normal = if out.dot(outside - inside) < 0.0 { -out } else { out };
            (cut.at, cut.normal) = (at, normal);
        });
    }

    /// Position of a cut along its edge, as a share from the lower end.
    pub(super) fn share(&self, cut: &Cut) -> f64 {
        let [a, b] = cut.ends.map(|i| self.points[i as usize]);
        a.distance(cut.at) / a.distance(b)
    }
}

/// The cube of which a cell is an eighth.
fn parent(level: u32, lo: IVec3) -> Octant {
    let whole = CELL >> (level - 1);
    (level - 1, (lo / whole * whole).to_array())
}

/// A number that sorts corners of the grid first, then its centres, then finer points; within each
/// class by position.
fn key(p: IVec3) -> u64 {
    let all_are = |m: i32| (p % CELL).cmpeq(IVec3::splat(m)).all();
    let class = if all_are(0) {
        0
    } else if all_are(CELL / 2) {
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

/// Whether exactly two triangles share each edge, in opposite directions, so that the mesh is closed.
pub(super) fn is_closed(mesh: &TriMesh) -> bool {
    mesh::diagnose(mesh).is_some_and(|h| h.is_closed())
}

/// The point where the way from `inside` to `outside` leaves the part, and the facet there.
fn crossing(bvh: &Bvh, inside: DVec3, outside: DVec3) -> (DVec3, Option<u32>) {
    let along = outside - inside;
    let hits = bvh.hits(inside, along, (-1e-9, 1.0 + 1e-9));
    let at = |t: f64| inside + along * t.clamp(0.0, 1.0);
    match hits.as_slice() {
        [] => {
            // A hole in the mesh: the point where the winding number falls below one half is taken
            // instead.
            let (mut near, mut far) = (0.0, 1.0);
            for _ in 0..16 {
                let middle = 0.5 * (near + far);
                if bvh.contains(at(middle)) { near = middle } else { far = middle }
            }
            (at(0.5 * (near + far)), None)
        }
        [only] => (at(only.t), Some(only.triangle)),
        several => {
            // Several hits: facets that overlap, or a thin gap on the way. The way leaves the part
            // at the first gap whose middle is outside.
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

/// Finds the side of the surface on which points lie.
struct Side<'a> {
    bvh: &'a Bvh,
    closed: bool,
    /// The last point and its sign.
    last: Option<(DVec3, i8)>,
}

impl Block<'_> {
    fn fill(&mut self, lo: IVec3, size: i32) {
        let from = self.lattice.position(lo * 2);
        let to = self.lattice.position((lo + size) * 2 - 1);
        let middle = 0.5 * (from + to);
        // There is no surface within the block, so one sign serves all its points.
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
    /// 1 inside and -1 outside, by the winding number. A point with no surface between itself and
    /// the last point is on the same side.
    fn sign(&mut self, p: DVec3) -> i8 {
        let same = self
            .last
            .filter(|&(q, _)| self.closed && self.bvh.first_hit(q, p - q, (-1e-9, 1.0 + 1e-9)).is_none());
        let sign = same.map_or_else(|| if self.bvh.contains(p) { 1 } else { -1 }, |(_, sign)| sign);
        self.last = Some((p, sign));
        sign
    }
}
