//! The element at a point.
//!
//! A grid of cells lists the elements whose bounds reach into each cell. `grainpath_core::buckets` has items
//! that reach into several cells in the plane, and in space only points. Lengths are in mm. Cost: a query
//! visits one cell, or 27 for points outside.

use grainpath_core::{DMat3, DVec3, IVec3};

use super::quadratic_tet as element;
use super::tet_mesh::TetMesh;

/// Largest number of cells. Source: derived: offsets of 4 bytes make 16 MB.
const MOST_CELLS: f64 = 4e6;

/// A grid of cells over a mesh, each with the elements that reach into it.
#[derive(Debug, Clone)]
pub struct Sampler<'m> {
    mesh: &'m TetMesh,
    origin: DVec3,
    width: f64,
    n: IVec3,
    start: Vec<u32>,
    tets: Vec<u32>,
}

/// A point within an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// The element.
    pub tet: usize,
    /// Weights of its ten nodes.
    pub weights: [f64; 10],
    /// Smallest barycentric coordinate: a distance as a share of the element's height, negative for a point outside.
    pub depth: f64,
}

impl<'m> Sampler<'m> {
    /// Prepares a mesh; `None` for an empty one.
    pub fn new(mesh: &'m TetMesh) -> Option<Self> {
        let first = *mesh.nodes.first().filter(|_| !mesh.tets.is_empty())?;
        let (lo, hi) = mesh.nodes.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let mean = (mesh.volume_mm3().abs() / mesh.tets.len() as f64).cbrt();
        let box_volume = (hi - lo).max(DVec3::splat(mean)).element_product();
        // Cells one and a half elements wide hold a few elements each; the second bound is for
        // sparse parts in large boxes.
        let width = (1.5 * mean).max((box_volume / MOST_CELLS).cbrt());
        let n = ((hi - lo) / width).as_ivec3() + 1;
        let mut sampler = Self { mesh, origin: lo, width, n, start: Vec::new(), tets: Vec::new() };
        let mut all: Vec<(u32, u32)> = Vec::new();
        for t in 0..mesh.tets.len() {
            let x = mesh.places(t);
            let (lo, hi) = x.iter().fold((x[0], x[0]), |(lo, hi), &p| (lo.min(p), hi.max(p)));
            let (from, to) = (sampler.cell(lo), sampler.cell(hi));
            for z in from.z..=to.z {
                for y in from.y..=to.y {
                    for x in from.x..=to.x {
                        all.push((sampler.index(IVec3::new(x, y, z)) as u32, t as u32));
                    }
                }
            }
        }
        all.sort_unstable();
        sampler.start = vec![0; n.element_product() as usize + 1];
        for &(cell, _) in &all {
            sampler.start[cell as usize + 1] += 1;
        }
        for c in 1..sampler.start.len() {
            sampler.start[c] += sampler.start[c - 1];
        }
        sampler.tets = all.into_iter().map(|(_, t)| t).collect();
        Some(sampler)
    }

    fn cell(&self, p: DVec3) -> IVec3 {
        ((p - self.origin) / self.width).floor().as_ivec3().clamp(IVec3::ZERO, self.n - 1)
    }

    fn index(&self, c: IVec3) -> usize {
        (c.z as usize * self.n.y as usize + c.y as usize) * self.n.x as usize + c.x as usize
    }

    /// The element at a point. For a point outside, within about one cell, it is the element with
    /// the largest [`Spot::depth`]; the position is then moved onto the element's border.
    pub fn at(&self, p: DVec3) -> Option<Spot> {
        let middle = self.cell(p);
        let best = |cells: &mut dyn Iterator<Item = IVec3>| {
            let mut best: Option<(f64, u32, [f64; 4])> = None;
            for c in cells {
                let i = self.index(c);
                for &t in &self.tets[self.start[i] as usize..self.start[i + 1] as usize] {
                    let x = self.mesh.corners(t as usize);
                    let map = DMat3::from_cols(x[1] - x[0], x[2] - x[0], x[3] - x[0]).inverse();
                    let l = map * (p - x[0]);
                    let l = [1.0 - l.x - l.y - l.z, l.x, l.y, l.z];
                    let depth = l.iter().copied().fold(f64::INFINITY, f64::min);
                    // The tiny margin makes the lower number win between elements that share a
                    // face.
                    if best.is_none_or(|b| depth > b.0 + 1e-12) {
                        best = Some((depth, t, l));
                    }
                }
            }
            best
        };
        let own = best(&mut std::iter::once(middle));
        // Only a point outside needs the neighbouring cells.
        let found = own.filter(|b| b.0 > -1e-9).or_else(|| {
            let around = (0..27).map(|i| middle + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1);
            best(&mut around.filter(|c| c.cmpge(IVec3::ZERO).all() && c.cmplt(self.n).all()))
        });
        let (depth, tet, l) = found.filter(|b| b.0 > -1.0)?;
        let l = l.map(|v| v.max(0.0));
        let sum: f64 = l.iter().sum();
        Some(Spot { tet: tet as usize, weights: element::shapes(&l.map(|v| v / sum)), depth })
    }

    /// Value of a nodal field of six components at a point; `None` far outside.
    pub fn value(&self, field: &[[f64; 6]], p: DVec3) -> Option<[f64; 6]> {
        let spot = self.at(p)?;
        let mut sum = [0.0; 6];
        for (&i, w) in self.mesh.tets[spot.tet].iter().zip(spot.weights) {
            for (s, v) in sum.iter_mut().zip(field[i as usize]) {
                *s += w * v;
            }
        }
        Some(sum)
    }
}
