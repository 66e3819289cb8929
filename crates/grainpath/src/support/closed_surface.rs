//! The support as one closed surface.
//!
//! The surface is made from the layers and not from the branches, because the layers have been cut to keep clear of the
//! part. Each layer gives a signed distance in its plane, which is interpolated between planes and blended in creases.
//! The surface is its zero level. Every cube of the grid is divided into six tetrahedra; in a tetrahedron the function is
//! linear and its zero level a plane. So the surface is closed and each of its edges has two faces, whatever the layers
//! look like.
//!
//! Lengths are in mm. Cost: linear in the cells near the surface. Tips thinner than a cell may be lost.

use std::collections::HashMap;

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::segment;
use grainpath_core::tuned::Tuned;
use grainpath_core::{Bounds2, DVec2, DVec3, Diagnostics, LayerStack, Region, TriMesh};
use rayon::prelude::*;

use super::cut::SupportLayer;

/// Resolution of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidSettings {
    /// Width of a grid cell, mm. Cells are made wider where the surface would have more than `max_triangles`.
    pub cell_mm: f64,
    /// The approximate largest number of triangles.
    pub max_triangles: usize,
}

impl Default for SolidSettings {
    fn default() -> Self {
        Self { cell_mm: 0.25, max_triangles: 3_000_000 }
    }
}

/// Number of triangles on a piece of surface as large as one face of a cell. Measured: 6.3 for the support of the specimen
/// `hanging-ball` and 7.4 for that of `dental-tray`, with cells of 0.25 mm.
const TRIANGLES_PER_FACE: f64 = 7.4;
/// Number of planes computed in parallel. Source: chosen; it changes speed and memory alone.
const BATCH: usize = 16;
/// Vertices keep this share of a grid edge's length from its ends, so that every triangle has an area. Source: derived. On
/// the edge of a cell of 0.25 mm that is 0.01 mm. It moves the surface by less than a microstep of a motor of 200 steps,
/// divided by 16, on a belt of 40 mm a turn (0.0125 mm), and is 300 times what a coordinate of 500 mm is rounded to in STL.
const EDGE_SHARE: f64 = 0.04;
/// How often creases are blended. Measured: row `support.solid.BLENDS` of `cargo xtask bench constants`.
static BLENDS: Tuned<usize> = Tuned::new("support.solid.BLENDS", 2);
/// The lowest section is repeated this far above the plate, with nothing as far below it, so that the foot is flat at
/// the height 0. Source: derived. It is less than a microstep (see [`EDGE_SHARE`]).
const NEAR_PLATE_MM: f64 = 0.01;
/// Share of the sections of all layers that counts as surface where the number of triangles is estimated. Source:
/// derived. A branch that leans by 40 degrees moves by 0.17 mm in a layer of 0.2 mm; a tenth of a section 3 mm wide is
/// then open.
const CAP_SHARE: f64 = 0.1;

/// The closed surface of support layers; empty when there are none.
///
/// # Errors
/// [`Interrupted`] when a stop was asked for.
pub fn solid(
    layers: &[SupportLayer],
    stack: &LayerStack,
    settings: &SolidSettings,
    diagnostics: &Diagnostics,
) -> Result<TriMesh, Interrupted> {
    let regions: Vec<&Region> = layers.iter().map(|l| &l.region).collect();
    let Some(bounds) = regions.iter().filter_map(|r| r.bounds()).reduce(Bounds2::union) else {
        return Ok(TriMesh::default());
    };
    let surface: f64 = regions
        .iter()
        .zip(stack.layers())
        .map(|(r, l)| r.perimeter_mm() * l.height_mm() + CAP_SHARE * r.area_mm2())
        .sum();
    let affordable = (surface * TRIANGLES_PER_FACE / settings.max_triangles.max(1) as f64).sqrt();
    let planes = planes(stack, layers, settings.cell_mm.max(affordable));
    let grid = PlaneGrid::over(bounds, settings.cell_mm.max(affordable));
    let mut mesher = Mesher::new(grid);
    let mut below: Option<Plane> = None;
    for batch in planes.chunks(BATCH) {
        diagnostics.check()?;
        let fields: Vec<Plane> =
            batch.par_iter().map(|&(z, k)| grid.plane(z, k.map(|k| regions[k]))).collect();
        for plane in fields {
            if let Some(low) = &below {
                mesher.between(low, &plane);
            }
            below = Some(plane);
        }
    }
    Ok(mesher.mesh)
}

/// The heights of the grid's planes and the layer that each takes its distances from. A plane without a layer at either
/// end closes the surface.
fn planes(stack: &LayerStack, layers: &[SupportLayer], step_mm: f64) -> Vec<(f64, Option<usize>)> {
    let middle = |k: usize| stack.layers()[k].z_top_mm() - 0.5 * stack.layers()[k].height_mm();
    let last = layers.iter().rposition(|l| !l.region.is_empty()).unwrap_or(0);
    // The lowest section is repeated just above the plate, with nothing below it, so that the foot is flat at z = 0.
    let mut out = vec![(-NEAR_PLATE_MM, None), (NEAR_PLATE_MM, Some(0))];
    let mut z = f64::NEG_INFINITY;
    for k in 0..=last {
        if middle(k) - z > 0.99 * step_mm || k == last {
            z = middle(k);
            out.push((z, Some(k)));
        }
    }
    out.push((z + stack.layers()[last].height_mm(), None));
    out
}

/// The grid in plan.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlaneGrid {
    origin: DVec2,
    cell_mm: f64,
    nx: usize,
    ny: usize,
}

/// The signed distance in one plane.
pub(super) struct Plane {
    z: f64,
    values: Vec<f32>,
    /// The first and the last column of each row that hold anything of the support.
    spans: Vec<Option<(u32, u32)>>,
}

impl Plane {
    /// A plane whose rows are all evaluated over their whole length.
    pub(super) fn whole(z: f64, values: Vec<f32>, nx: usize) -> Self {
        let spans = vec![Some((0, nx as u32 - 1)); values.len() / nx];
        Self { z, values, spans }
    }
}

impl PlaneGrid {
    pub(super) fn new(origin: DVec2, cell_mm: f64, nx: usize, ny: usize) -> Self {
        Self { origin, cell_mm, nx, ny }
    }

    fn over(bounds: Bounds2, cell_mm: f64) -> Self {
        let origin = bounds.min - 5.0 * cell_mm;
        let size = (bounds.size() / cell_mm).ceil();
        Self { origin, cell_mm, nx: size.x as usize + 11, ny: size.y as usize + 11 }
    }

    fn place(&self, x: usize, y: usize) -> DVec2 {
        self.origin + DVec2::new(x as f64, y as f64) * self.cell_mm
    }

    /// Signed distance from the region's border in a band of two cells, negative inside.
    fn plane(&self, z: f64, region: Option<&Region>) -> Plane {
        let far = 2.0 * self.cell_mm;
        let mut values = vec![far as f32; self.nx * self.ny];
        let mut spans = vec![None; self.ny];
        for polygon in region.into_iter().flat_map(|r| &r.polygons) {
            let Some(b) = polygon.bounds() else { continue };
            let lo = ((b.min - self.origin) / self.cell_mm - 3.0).floor();
            let hi = ((b.max - self.origin) / self.cell_mm + 3.0).ceil();
            let (x0, x1) = (lo.x.max(0.0) as usize, (hi.x as usize).min(self.nx - 1));
            let (y0, y1) = (lo.y.max(0.0) as usize, (hi.y as usize).min(self.ny - 1));
            let w = x1 - x0 + 1;
            let mut local = vec![far; w * (y1 - y0 + 1)];
            for (p, q) in polygon.contours().flat_map(|c| grainpath_core::poly::edges(c)) {
                let lo = ((p.min(q) - far - self.origin) / self.cell_mm).ceil();
                let hi = ((p.max(q) + far - self.origin) / self.cell_mm).floor();
                for y in (lo.y.max(0.0) as usize).max(y0)..=(hi.y as usize).min(y1) {
                    for x in (lo.x.max(0.0) as usize).max(x0)..=(hi.x as usize).min(x1) {
                        let d = segment::distance_squared_mm2(self.place(x, y), p, q).sqrt();
                        let slot = &mut local[(y - y0) * w + x - x0];
                        *slot = slot.min(d);
                    }
                }
            }
            for y in y0..=y1 {
                let mut crossings: Vec<f64> = Vec::new();
                let row = self.place(0, y).y;
                for (p, q) in polygon.contours().flat_map(|c| grainpath_core::poly::edges(c)) {
                    if (p.y > row) != (q.y > row) {
                        crossings.push(p.x + (row - p.y) / (q.y - p.y) * (q.x - p.x));
                    }
                }
                crossings.sort_by(f64::total_cmp);
                let mut next = 0;
                for x in x0..=x1 {
                    let at = self.place(x, y).x;
                    while next < crossings.len() && crossings[next] <= at {
                        next += 1;
                    }
                    let d = local[(y - y0) * w + x - x0];
                    let signed = if next % 2 == 1 { -d } else { d } as f32;
                    let value = &mut values[y * self.nx + x];
                    *value = value.min(signed);
                }
                let span = spans[y].get_or_insert((x0 as u32, x1 as u32));
                *span = (span.0.min(x0 as u32), span.1.max(x1 as u32));
            }
        }
        self.blend(&mut values, &spans);
        Plane { z, values, spans }
    }

    /// Blends creases: each value is lowered to the mean of its neighbours where that is less, and never raised.
    fn blend(&self, values: &mut [f32], spans: &[Option<(u32, u32)>]) {
        for _ in 0..BLENDS.value() {
            let old = values.to_vec();
            for (y, span) in spans.iter().enumerate() {
                let Some((x0, x1)) = *span else { continue };
                if y == 0 || y + 1 == self.ny {
                    continue;
                }
                for x in (x0 as usize).max(1)..=(x1 as usize).min(self.nx - 2) {
                    let i = y * self.nx + x;
                    let mean = 0.25 * (old[i - 1] + old[i + 1] + old[i - self.nx] + old[i + self.nx]);
                    values[i] = values[i].min(mean);
                }
            }
        }
    }
}

/// The tetrahedra of a cube. Each is given by a path from corner 0 to corner 7 along the cube's edges. Source: derived. A
/// path goes along the three axes in one of six orders, and the six tetrahedra share faces with those of the next cube.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]];

/// Offset of a cube's corner.
fn corner(c: usize) -> [usize; 3] {
    [c & 1, c >> 1 & 1, c >> 2 & 1]
}

/// Builds the surface plane by plane.
pub(super) struct Mesher {
    grid: PlaneGrid,
    pub(super) mesh: TriMesh,
    /// The vertex on each crossed grid edge within or between the two current planes. The key combines the numbers of the
    /// edge's two grid points. Vertices in the upper plane are kept for the next pair of planes.
    on_edges: HashMap<u64, u32>,
}

/// A corner of a tetrahedron: its number within the two planes, its position and its value.
#[derive(Clone, Copy)]
struct Corner {
    name: u64,
    at: DVec3,
    value: f64,
}

impl Mesher {
    pub(super) fn new(grid: PlaneGrid) -> Self {
        Self { grid, mesh: TriMesh::default(), on_edges: HashMap::new() }
    }

    /// Adds the surface between two planes.
    pub(super) fn between(&mut self, low: &Plane, high: &Plane) {
        let (nx, ny) = (self.grid.nx, self.grid.ny);
        for y in 0..ny - 1 {
            let spans = [low.spans[y], low.spans[y + 1], high.spans[y], high.spans[y + 1]];
            let Some((x0, x1)) = spans.into_iter().flatten().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            else {
                continue;
            };
            for x in (x0 as usize).saturating_sub(1)..=(x1 as usize).min(nx - 2) {
                self.cube(x, y, low, high);
            }
        }
        // The upper plane is the lower one of the next pair, so the vertices on its edges are kept.
        let n = (nx * ny) as u64;
        let carried = std::mem::take(&mut self.on_edges).into_iter().filter_map(|(key, vertex)| {
            let (a, b) = (key >> 32, key & 0xffff_ffff);
            (a >= n && b >= n).then(|| ((a - n) << 32 | (b - n), vertex))
        });
        self.on_edges = carried.collect();
    }

    fn cube(&mut self, x: usize, y: usize, low: &Plane, high: &Plane) {
        let (nx, ny) = (self.grid.nx, self.grid.ny);
        let mut corners = [Corner { name: 0, at: DVec3::ZERO, value: 0.0 }; 8];
        let mut inside = 0;
        for (c, slot) in corners.iter_mut().enumerate() {
            let [dx, dy, dz] = corner(c);
            let plane = if dz == 0 { low } else { high };
            let i = (y + dy) * nx + x + dx;
            let value = f64::from(plane.values[i]);
            inside += usize::from(value < 0.0);
            let at = self.grid.place(x + dx, y + dy).extend(plane.z);
            *slot = Corner { name: (i + dz * nx * ny) as u64, at, value };
        }
        if inside == 0 || inside == 8 {
            return;
        }
        for tetrahedron in TETRAHEDRA {
            self.tetrahedron(tetrahedron.map(|c| corners[c]));
        }
    }

    fn tetrahedron(&mut self, t: [Corner; 4]) {
        let (mut inner, mut outer): (Vec<Corner>, Vec<Corner>) = (Vec::new(), Vec::new());
        t.into_iter().for_each(|c| if c.value < 0.0 { inner.push(c) } else { outer.push(c) });
        let [a, b, c, d] = match (inner.len(), outer.len()) {
            (1, 3) => [inner[0], outer[0], outer[1], outer[2]],
            (2, 2) => [inner[0], inner[1], outer[0], outer[1]],
            (3, 1) => [outer[0], inner[0], inner[1], inner[2]],
            _ => return,
        };
        let mut right_handed = (b.at - a.at).cross(c.at - a.at).dot(d.at - a.at) > 0.0;
        if inner.len() == 2 {
            let [p, q, r, s] = [self.vertex(a, c), self.vertex(a, d), self.vertex(b, d), self.vertex(b, c)];
            self.triangle([p, q, r], right_handed);
            self.triangle([p, r, s], right_handed);
        } else {
            right_handed ^= inner.len() == 3;
            let tri = [self.vertex(a, b), self.vertex(a, c), self.vertex(a, d)];
            self.triangle(tri, right_handed);
        }
    }

    fn triangle(&mut self, [a, b, c]: [u32; 3], as_is: bool) {
        self.mesh.triangles.push(if as_is { [a, b, c] } else { [a, c, b] });
    }

    /// The vertex on the edge between two grid points.
    fn vertex(&mut self, a: Corner, b: Corner) -> u32 {
        let (a, b) = if a.name < b.name { (a, b) } else { (b, a) };
        let key = a.name << 32 | b.name;
        let mesh = &mut self.mesh;
        *self.on_edges.entry(key).or_insert_with(|| {
            let t = (a.value / (a.value - b.value)).clamp(EDGE_SHARE, 1.0 - EDGE_SHARE);
            mesh.vertices.push(a.at.lerp(b.at, t));
            mesh.vertices.len() as u32 - 1
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::Layer;
    use grainpath_core::math::direction;
    use grainpath_core::mesh::diagnose;
    use grainpath_core::poly::FillRule;

    fn disc(at: DVec2, r: f64) -> Vec<DVec2> {
        (0..40).map(|i| at + direction(f64::from(i) / 40.0 * std::f64::consts::TAU) * r).collect()
    }

    #[test]
    fn a_fork_is_closed_and_has_the_volume_of_its_layers() {
        // Two branches that meet in a trunk, with a third beside them that touches one at a point.
        let layer = |k: usize| {
            let z = 0.2 * k as f64 + 0.1;
            let off = (0.8 * (z - 6.0)).max(0.0);
            let mut discs = vec![disc(DVec2::new(off, 0.0), 1.5), disc(DVec2::new(-off, 0.0), 1.0)];
            if k > 10 {
                discs.push(disc(DVec2::new(0.0, 7.0 - 0.1 * z), 2.0));
            }
            SupportLayer {
                region: Region::from_contours(&discs, FillRule::NonZero),
                ..SupportLayer::default()
            }
        };
        let layers: Vec<SupportLayer> = (0..60).map(layer).collect();
        let empty = |k: usize| Layer::new(0.2 * (k + 1) as f64, 0.2, Region::default()).expect("sound");
        let stack = LayerStack::new((0..60).map(empty).collect()).expect("heights rise");
        let mesh =
            solid(&layers, &stack, &SolidSettings::default(), &Diagnostics::default()).expect("not stopped");
        let health = diagnose(&mesh).expect("a surface");
        assert!(health.is_closed(), "{health:?}");
        assert_eq!(health.shells, 2);
        let volume: f64 = layers.iter().map(|l| l.region.area_mm2() * 0.2).sum();
        assert!((mesh.signed_volume() / volume - 1.0).abs() < 0.04, "{} for {volume}", mesh.signed_volume());
        let (low, high) = health.bounds;
        assert!(low.z.abs() < 0.011 && (high.z - 12.0).abs() < 0.11, "{low} {high}");
    }

    #[test]
    fn nothing_has_no_surface() {
        let layers = vec![SupportLayer::default(); 3];
        let empty = |k: usize| Layer::new(0.2 * (k + 1) as f64, 0.2, Region::default()).expect("sound");
        let stack = LayerStack::new((0..3).map(empty).collect()).expect("heights rise");
        let mesh =
            solid(&layers, &stack, &SolidSettings::default(), &Diagnostics::default()).expect("not stopped");
        assert!(mesh.triangles.is_empty());
    }
}
