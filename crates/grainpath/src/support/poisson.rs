//! The surface of the support by Poisson reconstruction, as published (`Shen2016`), for comparison with the signed
//! distance.
//!
//! Points with outward normals are sampled on the walls and the steps of all layers. The function is found whose gradient
//! fits these normals best. The surface is where the function equals its mean value at the points. It is computed on a
//! uniform grid by multigrid. Smoothing is of the Jacobi kind: every new value depends on old values alone, so the number
//! of threads does not change the result.
//!
//! Lengths are in mm. Cost: linear in the cells, at most 12 million. It is slower than the signed distance of
//! [`solid`](super::closed_surface), and it rounds off tips thinner than two cells.

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::tuned::Tuned;
use grainpath_core::{Bounds2, DVec2, DVec3, Diagnostics, LayerStack, Region, TriMesh};
use rayon::prelude::*;

use super::closed_surface::{Mesher, Plane, PlaneGrid};
use super::cut::SupportLayer;

/// Largest number of cells; where there would be more, cells are made larger. Source: derived. Four arrays of four bytes,
/// and a seventh more for the coarser grids, make 220 MB.
const MAX_CELLS: f64 = 1.2e7;
/// Number of empty cells around the support, in which the function fades to zero. Measured: row `support.poisson.MARGIN` of
/// `cargo xtask bench constants`.
static MARGIN: Tuned<usize> = Tuned::new("support.poisson.MARGIN", 6);
/// The number of cells along each axis is a multiple of this. Source: derived. Each of three coarser grids halves it.
const MULTIPLE: usize = 8;
/// Rounds of smoothing before and after each coarser grid. Measured: row `support.poisson.SWEEPS` of `cargo xtask bench
/// constants`.
static SWEEPS: Tuned<usize> = Tuned::new("support.poisson.SWEEPS", 3);
/// Largest number of V-cycles, so that a solution that does not converge ends. Source: chosen. The supports of both
/// specimens reach [`RESIDUAL`] within 3 cycles.
const CYCLES: usize = 25;
/// V-cycles end at this residual, as a share of the largest entry of the right side. Measured: row
/// `support.poisson.RESIDUAL` of `cargo xtask bench constants`.
static RESIDUAL: Tuned<f64> = Tuned::new("support.poisson.RESIDUAL", 2e-3);

/// Points on the walls of layers are this far apart, in cells. Measured: row `support.poisson.POINT_STEP` of `cargo
/// xtask bench constants`.
static POINT_STEP: Tuned<f64> = Tuned::new("support.poisson.POINT_STEP", 0.7);
/// Rounds of smoothing on the coarsest grid. Measured: row `support.poisson.COARSEST_SWEEPS` of `cargo xtask bench
/// constants`.
static COARSEST_SWEEPS: Tuned<usize> = Tuned::new("support.poisson.COARSEST_SWEEPS", 40);

/// The surface of support layers on cells of about `cell_mm`, or larger ones where there would be too many.
///
/// # Errors
/// [`Interrupted`] when a stop was asked for.
pub fn poisson(
    layers: &[SupportLayer],
    stack: &LayerStack,
    cell_mm: f64,
    diagnostics: &Diagnostics,
) -> Result<TriMesh, Interrupted> {
    let regions: Vec<&Region> = layers.iter().map(|l| &l.region).collect();
    let Some(bounds) = regions.iter().filter_map(|r| r.bounds()).reduce(Bounds2::union) else {
        return Ok(TriMesh::default());
    };
    let last = regions.iter().rposition(|r| !r.is_empty()).unwrap_or(0);
    let height = stack.layers()[last].z_top_mm();
    let size = bounds.size();
    let cell_mm = cell_mm.max((size.x * size.y * height / MAX_CELLS).cbrt());
    let count = |mm: f64| ((mm / cell_mm).ceil() as usize + 2 * MARGIN.value()).next_multiple_of(MULTIPLE);
    let n = [count(size.x), count(size.y), count(height)];
    let low = (bounds.min - MARGIN.value() as f64 * cell_mm).extend(-(MARGIN.value() as f64) * cell_mm);
    let grid = SolutionGrid { n, low, cell_mm };
    let points = points(&regions, stack, last, &grid);
    diagnostics.check()?;
    let mut right = vec![0f32; grid.len()];
    points.iter().for_each(|p| grid.spread(p, &mut right));
    let mut value = vec![0f32; grid.len()];
    let scale = right.iter().fold(0.0, |m: f64, &v| m.max(f64::from(v.abs()))).max(1e-30);
    for _ in 0..CYCLES {
        diagnostics.check()?;
        cycle(&mut value, &right, n);
        let worst = residual(&value, &right, n).into_iter().fold(0.0, |m: f64, r| m.max(f64::from(r.abs())));
        if worst < RESIDUAL.value() * scale {
            break;
        }
    }
    let level = points.iter().map(|p| grid.sample(p.at, &value)).sum::<f64>() / points.len().max(1) as f64;
    let plan = PlaneGrid::new(low.truncate(), cell_mm, n[0], n[1]);
    let mut mesher = Mesher::new(plan);
    let mut below: Option<Plane> = None;
    for k in 0..n[2] {
        let values = value[k * n[0] * n[1]..][..n[0] * n[1]].iter().map(|v| (f64::from(*v) - level) as f32);
        let plane = Plane::whole(low.z + k as f64 * cell_mm, values.collect(), n[0]);
        if let Some(low) = &below {
            mesher.between(low, &plane);
        }
        below = Some(plane);
    }
    Ok(mesher.mesh)
}

/// A sample point of the surface, with the area that it stands for.
struct Point {
    at: DVec3,
    /// Outward normal times area.
    area: DVec3,
}

/// Points on the walls and the steps of all layers.
fn points(regions: &[&Region], stack: &LayerStack, last: usize, grid: &SolutionGrid) -> Vec<Point> {
    let c = grid.cell_mm;
    let of_layer = |k: usize| {
        let layer = &stack.layers()[k];
        let z = layer.z_top_mm() - 0.5 * layer.height_mm();
        let mut out = Vec::new();
        for (a, b) in regions[k].contours().flat_map(|c| grainpath_core::poly::edges(c)) {
            let along = b - a;
            let n = (along.length() / (POINT_STEP.value() * c)).ceil().max(1.0);
            let outward = DVec2::new(along.y, -along.x).extend(0.0) * (layer.height_mm() / n);
            out.extend(
                (0..n as usize)
                    .map(|i| Point { at: (a + along * ((i as f64 + 0.5) / n)).extend(z), area: outward }),
            );
        }
        let below = if k == 0 { None } else { Some(regions[k - 1]) };
        steps(regions[k], below, layer.z_top_mm() - layer.height_mm(), -1.0, grid, &mut out);
        steps(regions[k], regions.get(k + 1).copied(), layer.z_top_mm(), 1.0, grid, &mut out);
        out
    };
    (0..=last).into_par_iter().map(of_layer).collect::<Vec<_>>().into_iter().flatten().collect()
}

/// The flat faces of a layer that its neighbour does not cover.
fn steps(
    region: &Region,
    other: Option<&Region>,
    z: f64,
    up: f64,
    grid: &SolutionGrid,
    out: &mut Vec<Point>,
) {
    let open = other.map_or_else(|| region.clone(), |o| region.difference(o));
    let c = 0.5 * grid.cell_mm;
    for polygon in &open.polygons {
        let Some(b) = polygon.bounds() else { continue };
        let n = (b.size() / c).ceil().max(DVec2::ONE);
        let mut hits = Vec::new();
        for j in 0..n.y as usize {
            for i in 0..n.x as usize {
                let p = b.min + b.size() * DVec2::new((i as f64 + 0.5) / n.x, (j as f64 + 0.5) / n.y);
                if polygon.contains(p) {
                    hits.push(p);
                }
            }
        }
        if hits.is_empty() {
            hits.push(super::overhang::inner_point(polygon));
        }
        let area = DVec3::Z * (up * polygon.area_mm2() / hits.len() as f64);
        out.extend(hits.into_iter().map(|p| Point { at: p.extend(z), area }));
    }
}

struct SolutionGrid {
    n: [usize; 3],
    low: DVec3,
    cell_mm: f64,
}

impl SolutionGrid {
    fn len(&self) -> usize {
        self.n[0] * self.n[1] * self.n[2]
    }

    /// The eight grid points around a place, each with its weight in linear interpolation.
    fn around(&self, p: DVec3) -> impl Iterator<Item = (usize, f64)> + '_ {
        let c = (p - self.low) / self.cell_mm;
        let base = c.floor();
        let f = c - base;
        (0..8).filter_map(move |k| {
            let d = [k & 1, k >> 1 & 1, k >> 2 & 1];
            let mut share = 1.0;
            let mut index = 0;
            for a in [2, 1, 0] {
                let i = base[a] as i64 + d[a];
                let i = usize::try_from(i).ok().filter(|&i| i < self.n[a])?;
                index = index * self.n[a] + i;
                share *= if d[a] == 1 { f[a] } else { 1.0 - f[a] };
            }
            Some((index, share))
        })
    }

    /// Adds a point's share to the divergence of the normals, by central differences in units of the cell. The sign is
    /// the one that `smooth` expects.
    fn spread(&self, p: &Point, right: &mut [f32]) {
        let scale = 0.5 / (self.cell_mm * self.cell_mm);
        for a in 0..3 {
            let mut shift = DVec3::ZERO;
            shift[a] = self.cell_mm;
            for (sign, at) in [(-1.0, p.at - shift), (1.0, p.at + shift)] {
                for (i, share) in self.around(at) {
                    right[i] += (sign * scale * p.area[a] * share) as f32;
                }
            }
        }
    }

    fn sample(&self, p: DVec3, value: &[f32]) -> f64 {
        self.around(p).map(|(i, share)| share * f64::from(value[i])).sum()
    }
}

/// Sum of the six neighbours; beyond the border everything is zero.
fn neighbours(value: &[f32], n: [usize; 3], x: usize, y: usize, z: usize) -> f32 {
    let (sy, sz) = (n[0], n[0] * n[1]);
    let i = z * sz + y * sy + x;
    let mut sum = 0.0;
    if x > 0 {
        sum += value[i - 1];
    }
    if x + 1 < n[0] {
        sum += value[i + 1];
    }
    if y > 0 {
        sum += value[i - sy];
    }
    if y + 1 < n[1] {
        sum += value[i + sy];
    }
    if z > 0 {
        sum += value[i - sz];
    }
    if z + 1 < n[2] {
        sum += value[i + sz];
    }
    sum
}

/// Evaluates `f` at every grid point from the value there, the sum of its neighbours and the right side.
fn each(value: &[f32], right: &[f32], n: [usize; 3], f: impl Fn(f32, f32, f32) -> f32 + Sync) -> Vec<f32> {
    let mut out = vec![0f32; value.len()];
    out.par_chunks_mut(n[0] * n[1]).enumerate().for_each(|(z, plane)| {
        for y in 0..n[1] {
            for x in 0..n[0] {
                let i = y * n[0] + x;
                let whole = z * n[0] * n[1] + i;
                plane[i] = f(value[whole], neighbours(value, n, x, y, z), right[whole]);
            }
        }
    });
    out
}

fn smooth(value: &mut Vec<f32>, right: &[f32], n: [usize; 3]) {
    // Source: derived. What a coarser grid cannot show has eigenvalues of the scaled operator between 1/3 and 2, and
    // steps of 2 / (1/3 + 2) damp both ends of that range equally.
    const DAMPING: f32 = 6.0 / 7.0;
    *value = each(value, right, n, |v, around, r| v + DAMPING * ((around + r) / 6.0 - v));
}

fn residual(value: &[f32], right: &[f32], n: [usize; 3]) -> Vec<f32> {
    each(value, right, n, |v, around, r| r + around - 6.0 * v)
}

/// One V-cycle.
fn cycle(value: &mut Vec<f32>, right: &[f32], n: [usize; 3]) {
    let coarse = n.map(|k| k / 2);
    if n.iter().any(|k| k % 2 == 1) || coarse.iter().any(|&k| k < 4) {
        (0..COARSEST_SWEEPS.value()).for_each(|_| smooth(value, right, n));
        return;
    }
    (0..SWEEPS.value()).for_each(|_| smooth(value, right, n));
    let left = residual(value, right, n);
    let mut down = vec![0f32; coarse[0] * coarse[1] * coarse[2]];
    down.par_chunks_mut(coarse[0] * coarse[1]).enumerate().for_each(|(z, plane)| {
        for y in 0..coarse[1] {
            for x in 0..coarse[0] {
                let mut sum = 0.0;
                for k in 0..8 {
                    let (i, j, l) = (2 * x + (k & 1), 2 * y + (k >> 1 & 1), 2 * z + (k >> 2 & 1));
                    sum += left[(l * n[1] + j) * n[0] + i];
                }
                // The mean of eight cells, times four because the coarse cells are twice as wide.
                plane[y * coarse[0] + x] = sum * 0.5;
            }
        }
    });
    let mut correction = vec![0f32; down.len()];
    cycle(&mut correction, &down, coarse);
    value.par_chunks_mut(n[0] * n[1]).enumerate().for_each(|(z, plane)| {
        for y in 0..n[1] {
            for x in 0..n[0] {
                plane[y * n[0] + x] += between(&correction, coarse, [x, y, z]);
            }
        }
    });
    (0..SWEEPS.value()).for_each(|_| smooth(value, right, n));
}

/// Interpolates the values of a coarse grid at a fine cell. Along each axis the coarse cell that it lies in counts three
/// quarters, and the next one a quarter.
fn between(coarse: &[f32], n: [usize; 3], fine: [usize; 3]) -> f32 {
    let mut sum = 0.0;
    for k in 0..8usize {
        let mut share = 1.0;
        let mut index = 0;
        let mut inside = true;
        for a in [2, 1, 0] {
            let own = fine[a] / 2;
            let next = if fine[a] % 2 == 1 { own + 1 } else { own.wrapping_sub(1) };
            let far = k >> a & 1 == 1;
            let i = if far { next } else { own };
            share *= if far { 0.25 } else { 0.75 };
            inside &= i < n[a];
            index = index * n[a] + i.min(n[a] - 1);
        }
        if inside {
            sum += share * coarse[index];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::Layer;
    use grainpath_core::math::direction;
    use grainpath_core::mesh::diagnose;
    use grainpath_core::poly::FillRule;

    #[test]
    fn a_leaning_branch_comes_back_closed_and_of_its_size() {
        let disc = |at: DVec2, r: f64| -> Vec<DVec2> {
            (0..40).map(|i| at + direction(f64::from(i) / 40.0 * std::f64::consts::TAU) * r).collect()
        };
        let layers: Vec<SupportLayer> = (0..60)
            .map(|k| {
                let shape = disc(DVec2::new(0.12 * f64::from(k), 0.0), 2.0);
                SupportLayer {
                    region: Region::from_contours(&[shape], FillRule::NonZero),
                    ..SupportLayer::default()
                }
            })
            .collect();
        let empty = |k: usize| Layer::new(0.2 * (k + 1) as f64, 0.2, Region::default()).expect("sound");
        let stack = LayerStack::new((0..60).map(empty).collect()).expect("heights rise");
        let mesh = poisson(&layers, &stack, 0.3, &Diagnostics::default()).expect("not stopped");
        let health = diagnose(&mesh).expect("a surface");
        assert!(health.is_closed() && health.shells == 1, "{health:?}");
        let volume: f64 = layers.iter().map(|l| l.region.area_mm2() * 0.2).sum();
        assert!((mesh.signed_volume() / volume - 1.0).abs() < 0.08, "{} for {volume}", mesh.signed_volume());
    }
}
