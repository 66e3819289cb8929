//! The surface of a stack of layers, closed and manifold wherever the shape branches, joins or
//! ends.
//!
//! Between the middles of neighbouring layers the signed distances of both sections are
//! interpolated linearly, on cells of about `cell_mm`. Each cell is cut into six tetrahedra along
//! its diagonal (Kuhn's cut), and the zero level is traced in each (marching tetrahedra,
//! `Doi1991`). Tetrahedra have no ambiguous case, so the surface is closed and manifold by
//! construction. The ends are flat. Values very close to zero are moved away from it, so that no
//! two vertices coincide.
//!
//! Solvers and supports use this surface where the shape is a scan or a photograph. Sharp edges in
//! plan are rounded over about one cell. Cost: computing signed distances visits all cells of a
//! layer; tracing visits only the cells on the border.

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::{Bounds2, DVec3, Diagnostics, LayerStack, Region, TriMesh};
use rayon::prelude::*;

use crate::distance::{Raster, signed_distance};

/// Largest number of triangles of a surface. Source: derived: the corners of the triangles take
/// 720 MB. There are half as many vertices, which take another 720 MB.
const MAX_TRIANGLES: usize = 60_000_000;
/// Height over which the ends are closed, mm. The vertices are then moved back onto the end planes.
/// Source: derived: any height serves, because no vertex keeps it; a micrometre is far above
/// rounding.
const END_MM: f64 = 1e-3;
/// Smallest distance from zero, in cells; values closer to zero are set to it, so that no two
/// vertices coincide.
const LEAST: f32 = 0.02;

/// Why layers get no surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)]
pub enum LoftError {
    #[error("no layer of the part has any area")]
    NoArea,
    #[error("the surface has more than {limit} triangles; wider cells make fewer")]
    TooLarge { limit: usize },
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// Lofts the sections of a stack: signed distances are interpolated between their middles on cells
/// of about `cell_mm`. The result is closed and manifold by construction, with flat ends.
///
/// # Errors
/// [`LoftError`]: no area, too many triangles, interrupted.
pub fn loft(stack: &LayerStack, cell_mm: f64, diagnostics: &Diagnostics) -> Result<TriMesh, LoftError> {
    let layers = stack.layers();
    let bounds = layers.iter().filter_map(|l| l.region().bounds()).reduce(Bounds2::union);
    let (Some(bounds), Some(last)) = (bounds, layers.last()) else { return Err(LoftError::NoArea) };
    let top = last.z_top_mm();
    let raster = Raster::over(bounds, glam(cell_mm));
    let mut surface = Loft::new(raster, top);
    let n = raster.nx * raster.ny;
    // Values on the planes that close the lower and the upper end. Simply negated values would not do:
    // slanted edges would be crossed straight above level ones, and vertices would coincide.
    let outside = |inside: &[f32]| inside.iter().map(|v| -v.abs() - 0.7).collect::<Vec<f32>>();
    let mut before: Option<(Vec<f32>, f64)> = None;
    // Distances of a batch of layers are computed in parallel. A batch has two layers for each thread,
    // so that the memory is bounded whatever the number of layers.
    for batch in layers.chunks(2 * rayon::current_num_threads()) {
        diagnostics.check()?;
        let fields: Vec<Vec<f32>> = batch.par_iter().map(|l| field(l.region(), &raster)).collect();
        for (layer, field) in batch.iter().zip(fields) {
            debug_assert_eq!(field.len(), n);
            let z = layer.z_top_mm() - 0.5 * layer.height_mm();
            match before.take() {
                None => {
                    surface.slab(&outside(&field), -END_MM, &field, 0.0)?;
                    surface.slab(&field, 0.0, &field, z)?;
                }
                Some((lower, z_lower)) => surface.slab(&lower, z_lower, &field, z)?,
            }
            before = Some((field, z));
        }
    }
    if let Some((lower, z)) = before {
        surface.slab(&lower, z, &lower, top)?;
        surface.slab(&lower, top, &outside(&lower), top + END_MM)?;
    }
    Ok(surface.mesh)
}

fn glam(cell_mm: f64) -> grainpath_core::DVec2 {
    grainpath_core::DVec2::splat(cell_mm)
}

/// Signed distance in cells, nowhere closer to zero than `LEAST`.
fn field(region: &Region, raster: &Raster) -> Vec<f32> {
    if region.is_empty() {
        return vec![-1.0; raster.nx * raster.ny];
    }
    let scale = 1.0 / raster.pixel_mm.x as f32;
    let mut values = signed_distance(region, raster);
    for v in &mut values {
        let d = *v * scale;
        *v = if d.abs() < LEAST { LEAST.copysign(d) } else { d };
    }
    values
}

/// Number of codes for the direction of a tetrahedron's edge. Bits of a code: 1 is x, 2 is y, 4 is z.
/// Source: derived: one bit for each of three axes.
const DIRECTIONS: usize = 8;
const NONE: u32 = u32::MAX;

struct Loft {
    raster: Raster,
    top: f64,
    mesh: TriMesh,
    /// Vertices on the edges that begin at a point of the lower plane, by point and direction.
    lower: Vec<u32>,
    /// Vertices on the edges within the upper plane.
    upper: Vec<u32>,
}

impl Loft {
    fn new(raster: Raster, top: f64) -> Self {
        let n = raster.nx * raster.ny * DIRECTIONS;
        Self { raster, top, mesh: TriMesh::default(), lower: vec![NONE; n], upper: vec![NONE; n] }
    }

    /// Adds the surface between two planes. Slabs have to come from the plate upwards.
    fn slab(&mut self, low: &[f32], z_low: f64, high: &[f32], z_high: f64) -> Result<(), LoftError> {
        let (nx, ny) = (self.raster.nx, self.raster.ny);
        // The upper plane of the last slab is the lower plane of this one; its vertices are reused,
        // which is what closes the surface.
        std::mem::swap(&mut self.lower, &mut self.upper);
        self.upper.fill(NONE);
        for j in 0..ny - 1 {
            for i in 0..nx - 1 {
                let p = j * nx + i;
                let corner = |c: usize| {
                    let q = p + (c & 1) + (c >> 1 & 1) * nx;
                    if c & 4 == 0 { low[q] } else { high[q] }
                };
                let inside = (0..8).filter(|&c| corner(c) > 0.0).count();
                if inside == 0 || inside == 8 {
                    continue;
                }
                let v: [f32; 8] = std::array::from_fn(corner);
                // Kuhn's cut: one tetrahedron for every order of the three axes on the way from
                // corner 0 to corner 7.
                for [a, b] in [[1, 3], [1, 5], [2, 3], [2, 6], [4, 5], [4, 6]] {
                    self.tetrahedron([0, a, b, 7], &v, [i, j], [z_low, z_high]);
                }
            }
        }
        if self.mesh.triangles.len() > MAX_TRIANGLES {
            return Err(LoftError::TooLarge { limit: MAX_TRIANGLES });
        }
        Ok(())
    }

    fn tetrahedron(&mut self, corners: [usize; 4], v: &[f32; 8], at: [usize; 2], z: [f64; 2]) {
        let mut within: Vec<usize> = Vec::with_capacity(4);
        let mut without: Vec<usize> = Vec::with_capacity(4);
        for c in corners {
            if v[c] > 0.0 { within.push(c) } else { without.push(c) }
        }
        let edges: Vec<[(usize, usize); 3]> = match (within.as_slice(), without.as_slice()) {
            (&[a], &[p, q, r]) | (&[p, q, r], &[a]) => vec![[(a, p), (a, q), (a, r)]],
            (&[a, b], &[p, q]) => vec![[(a, p), (a, q), (b, q)], [(a, p), (b, q), (b, p)]],
            _ => return,
        };
        // The orientation of a triangle does not depend on the positions of its vertices along
        // their edges, so it is found from the edges' middles.
        let place = |c: usize| DVec3::new((c & 1) as f64, (c >> 1 & 1) as f64, (c >> 2) as f64);
        let sum = |cs: &[usize]| cs.iter().map(|&c| place(c)).sum::<DVec3>() / cs.len() as f64;
        let out = sum(&without) - sum(&within);
        for edges in edges {
            let [p, q, r] = edges.map(|(a, b)| place(a) + place(b));
            let turned = (q - p).cross(r - p).dot(out) < 0.0;
            let [a, b, c] = edges.map(|(a, b)| self.vertex(a.min(b), a.max(b), v, at, z));
            self.mesh.triangles.push(if turned { [a, c, b] } else { [a, b, c] });
        }
    }

    /// The vertex on the edge from corner `a` to corner `b` of a cell.
    fn vertex(&mut self, a: usize, b: usize, v: &[f32; 8], at: [usize; 2], z: [f64; 2]) -> u32 {
        let (nx, direction) = (self.raster.nx, a ^ b);
        let point = (at[1] + (a >> 1 & 1)) * nx + at[0] + (a & 1);
        let table = if a & 4 == 0 { &mut self.lower } else { &mut self.upper };
        let slot = &mut table[point * DIRECTIONS + direction];
        if *slot != NONE {
            return *slot;
        }
        let t = f64::from(v[a] / (v[a] - v[b]));
        let place = |c: usize| {
            let p = self.raster.origin
                + grainpath_core::DVec2::new((at[0] + (c & 1)) as f64, (at[1] + (c >> 1 & 1)) as f64)
                    * self.raster.pixel_mm;
            p.extend(z[c >> 2])
        };
        let p = place(a).lerp(place(b), t);
        *slot = self.mesh.vertices.len() as u32;
        // The end slabs reach `END_MM` beyond the part; the clamp makes the ends flat.
        self.mesh.vertices.push(DVec3::new(p.x, p.y, p.z.clamp(0.0, self.top)));
        *slot
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::mesh::diagnose;
    use grainpath_core::{DVec2, Layer};

    #[test]
    fn a_branching_part_with_a_hole_that_closes_has_a_closed_surface_of_its_volume() {
        let rectangle = |x0: f64, x1: f64| Region::rectangle(DVec2::new(x0, 0.0), DVec2::new(x1, 8.0));
        let whole = rectangle(0.0, 20.0);
        let hollow = whole.difference(&Region::rectangle(DVec2::new(7.0, 2.0), DVec2::new(13.0, 6.0)));
        let two = rectangle(0.0, 7.0).union(&rectangle(13.0, 20.0));
        let sections = [&whole, &whole, &hollow, &hollow, &hollow, &two, &two, &two, &whole, &whole];
        let layers = sections
            .iter()
            .enumerate()
            .filter_map(|(i, r)| Layer::new(0.4 * (i + 1) as f64, 0.4, (*r).clone()))
            .collect();
        let stack = LayerStack::new(layers).expect("rising");
        let mesh = loft(&stack, 0.3, &Diagnostics::default()).expect("a surface");
        let health = diagnose(&mesh).expect("triangles");
        assert!(health.open_edges == 0 && health.nonmanifold_edges == 0, "{health:?}");
        assert_eq!(health.badly_wound_edges, 0, "{health:?}");
        let ratio = mesh.signed_volume() / stack.volume_mm3();
        assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
        let (low, high) = mesh.bounds().expect("vertices");
        assert!(low.z == 0.0 && (high.z - 4.0).abs() < 1e-12);
    }
}
