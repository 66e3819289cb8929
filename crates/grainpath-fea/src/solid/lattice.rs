//! The body-centred cubic lattice over a part: which of its points are inside, and where its edges cut the surface.

use grainpath_core::{Bvh, DVec3, IVec3, TriMesh, mesh};
use rayon::prelude::*;

use super::SolidError;

/// Cells of a block along each axis; blocks are worked on in parallel.
const BLOCK: i32 = 8;
/// Lattice points at most: 9 bytes each.
const MOST_POINTS: f64 = 4e8;

/// The seven directions in which a point owns the edge, in half cells: three long ones, then four short ones.
pub(super) const FORWARD: [IVec3; 7] = [
    IVec3::new(2, 0, 0),
    IVec3::new(0, 2, 0),
    IVec3::new(0, 0, 2),
    IVec3::new(-1, -1, 1),
    IVec3::new(1, -1, 1),
    IVec3::new(-1, 1, 1),
    IVec3::new(1, 1, 1),
];

/// Corners and centres of the cells of a regular grid. Points are named by their coordinates in half cells: all even
/// for a corner, all odd for a centre.
pub(super) struct Lattice {
    origin: DVec3,
    /// Half a cell, mm.
    half: DVec3,
    /// Cells along each axis.
    n: IVec3,
    /// 1 inside, -1 outside.
    pub(super) sign: Vec<i8>,
}

/// Where an edge of the lattice meets the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    /// Index of the owner times 8, plus the direction; cuts are sorted by it.
    pub(super) key: u64,
    pub(super) at: DVec3,
}

impl Lattice {
    /// Lays cells of about `size_mm` over the mesh so that the faces of its box lie on lattice planes.
    pub(super) fn over(mesh: &TriMesh, size_mm: f64) -> Result<Self, SolidError> {
        let (lo, hi) = mesh.bounds().ok_or(SolidError::NothingInside)?;
        let cells = ((hi - lo) / size_mm).round().max(DVec3::ONE);
        let points = 2.0 * (cells + 2.0).element_product();
        if points.is_nan() || points > MOST_POINTS {
            let size_mm = size_mm * (points / MOST_POINTS).cbrt();
            return Err(SolidError::TooFine { points, least_mm: size_mm });
        }
        // A part thinner than a cell across keeps cubes: flat ones would be bad tetrahedra.
        let step = ((hi - lo) / cells).max(DVec3::splat(0.6 * size_mm));
        let spare = step * cells - (hi - lo);
        let n = cells.as_ivec3() + 2;
        let origin = lo - step - spare / 2.0;
        let points = corner_count(n) + corner_count(n - 1);
        Ok(Self { origin, half: step / 2.0, n, sign: vec![-1; points] })
    }

    /// Number of points along x, y and z of the corners.
    fn corners(&self) -> IVec3 {
        self.n + 1
    }

    pub(super) fn cells(&self) -> IVec3 {
        self.n
    }

    pub(super) fn has(&self, p: IVec3) -> bool {
        let last = if p.x & 1 == 0 { self.n * 2 } else { self.n * 2 - 1 };
        p.cmpge(IVec3::ZERO).all() && p.cmple(last).all()
    }

    pub(super) fn index(&self, p: IVec3) -> usize {
        let (q, m, start) =
            if p.x & 1 == 0 { (p / 2, self.corners(), 0) } else { (p / 2, self.n, corner_count(self.n)) };
        start + (q.z as usize * m.y as usize + q.y as usize) * m.x as usize + q.x as usize
    }

    pub(super) fn position(&self, p: IVec3) -> DVec3 {
        self.origin + self.half * p.as_dvec3()
    }

    pub(super) fn sign(&self, p: IVec3) -> i8 {
        if self.has(p) { self.sign[self.index(p)] } else { -1 }
    }

    /// The key of the edge between two neighbours.
    pub(super) fn edge_key(&self, p: IVec3, q: IVec3) -> u64 {
        let forward = |from: IVec3, to: IVec3| {
            let direction = FORWARD.iter().position(|&d| d == to - from)?;
            Some(8 * self.index(from) as u64 + direction as u64)
        };
        forward(p, q).or_else(|| forward(q, p)).expect("neighbours in the lattice")
    }

    /// Decides for every point whether it is inside. Only blocks near the surface are looked into.
    pub(super) fn classify(&mut self, bvh: &Bvh, closed: bool) {
        let blocks = (self.n + 1 + BLOCK - 1) / BLOCK;
        let of = |b: i32| IVec3::new(b % blocks.x, b / blocks.x % blocks.y, b / (blocks.x * blocks.y));
        let found: Vec<Vec<i8>> = (0..blocks.element_product())
            .into_par_iter()
            .map(|b| {
                let lo = of(b) * BLOCK;
                let mut block = Block { lattice: self, bvh, closed, lo, signs: Vec::new(), last: None };
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

    /// All edges whose ends differ, with the place where the surface crosses them.
    pub(super) fn cuts(&self, bvh: &Bvh) -> Vec<Cut> {
        let layers: Vec<Vec<Cut>> = (0..2 * self.n.z + 1)
            .into_par_iter()
            .map(|z| {
                let odd = z & 1;
                let mut cuts = Vec::new();
                for y in (odd..=2 * self.n.y - odd).step_by(2) {
                    for x in (odd..=2 * self.n.x - odd).step_by(2) {
                        let p = IVec3::new(x, y, z);
                        let s = self.sign(p);
                        for (d, &step) in FORWARD.iter().enumerate() {
                            let q = p + step;
                            if self.has(q) && self.sign(q) != s {
                                let (inside, outside) = if s > 0 { (p, q) } else { (q, p) };
                                let at = crossing(bvh, self.position(inside), self.position(outside));
                                cuts.push(Cut { key: 8 * self.index(p) as u64 + d as u64, at });
                            }
                        }
                    }
                }
                cuts
            })
            .collect();
        let mut cuts = layers.concat();
        cuts.sort_unstable_by_key(|c| c.key);
        cuts
    }
}

fn corner_count(n: IVec3) -> usize {
    (n + 1).as_u64vec3().element_product() as usize
}

/// Whether every edge has two opposite uses, so that the inside changes only across a triangle.
pub(super) fn is_closed(mesh: &TriMesh) -> bool {
    mesh::diagnose(mesh).is_some_and(|h| h.is_closed())
}

/// Where the way out of the part leaves it.
fn crossing(bvh: &Bvh, inside: DVec3, outside: DVec3) -> DVec3 {
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
            at(0.5 * (near + far))
        }
        [only] => at(only.t),
        several => {
            let gaps = several.windows(2).filter(|w| w[1].t - w[0].t > 1e-9);
            let out = gaps.into_iter().find(|w| !bvh.contains(at(0.5 * (w[0].t + w[1].t))));
            at(out.map_or(several[several.len() - 1].t, |w| w[0].t))
        }
    }
}

struct Block<'a> {
    lattice: &'a Lattice,
    bvh: &'a Bvh,
    closed: bool,
    lo: IVec3,
    /// Sign of the corner and of the centre of each cell.
    signs: Vec<i8>,
    /// The point whose side was found last.
    last: Option<(DVec3, bool)>,
}

impl Block<'_> {
    fn fill(&mut self, lo: IVec3, size: i32) {
        let from = self.lattice.position(lo * 2);
        let to = self.lattice.position((lo + size) * 2 - 1);
        let middle = 0.5 * (from + to);
        if self.bvh.closest_point(middle, 1.001 * middle.distance(to)).is_none() {
            let inside = self.inside(middle);
            for i in 0..size.pow(3) {
                let cell = lo + IVec3::new(i % size, i / size % size, i / (size * size));
                self.set(cell, [inside; 2]);
            }
        } else if size > 1 {
            for i in 0..8 {
                self.fill(lo + IVec3::new(i & 1, i >> 1 & 1, i >> 2) * (size / 2), size / 2);
            }
        } else {
            let pair = [from, to].map(|p| self.inside(p));
            self.set(lo, pair);
        }
    }

    fn set(&mut self, cell: IVec3, inside: [bool; 2]) {
        let q = cell - self.lo;
        let at = 2 * ((q.z * BLOCK + q.y) * BLOCK + q.x) as usize;
        for (i, inside) in inside.into_iter().enumerate() {
            self.signs[at + i] = if inside { 1 } else { -1 };
        }
    }

    /// As the winding number says; where nothing lies between this point and the last, it is on the same side.
    fn inside(&mut self, p: DVec3) -> bool {
        let same = self
            .last
            .filter(|&(q, _)| self.closed && self.bvh.first_hit(q, p - q, (-1e-9, 1.0 + 1e-9)).is_none());
        let inside = same.map_or_else(|| self.bvh.contains(p), |(_, inside)| inside);
        self.last = Some((p, inside));
        inside
    }
}
