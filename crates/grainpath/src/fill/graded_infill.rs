//! Infill whose density differs from place to place.
//!
//! Each pattern is laid close to the wanted density, and the widths of the beads are then adjusted to match it:
//!
//! - straight lines (`rectilinear`, `aligned`, `grid`, `triangles`) lie on rasters whose distances double
//!   from level to level. The coarsest raster covers the whole region. Where the density is above a level,
//!   lines of the next finer level are added halfway between. So no line is shifted where levels meet. Lines
//!   of one direction lie above each other. Crossing lines lean, as in the pattern that slicers call cubic, so
//!   that a cell narrower than the distance of two lines holds its share of them over the layers;
//! - `gyroid` is traced as the zero line of one function, which changes from a period to half of it where
//!   levels meet, so that the walls continue;
//! - `honeycomb` is laid level by level, cut where levels meet, and leans too;
//! - `stripes` and `streamlines` are evenly spaced streamlines, whose distance follows the local density, and
//!   stripes where the density is high;
//! - `continuous` has a band for each level, filled with strips at its distance, and rings of neighbouring bands are
//!   joined to one path.
//!
//! ```text
//!    -------------------------   level 2, everywhere
//!                  -----------   level 0, where it is densest
//!          -------------------   level 1
//!                  -----------   level 0
//!    -------------------------   level 2
//! ```
//!
//! Where the density is above `DENSE_FROM`, straight parallel lines are laid instead of crossing ones. At
//! last the widths are fitted: windows with a side of `WINDOW_MM` lie all over the area, and each bead gets the mean of what
//! the windows around it ask for over what they hold, within the widths that a nozzle can lay. A single window around the bead
//! itself would hold one line always where lines are farther apart than half its side, and lay up to twice too much.
//!
//! Lengths are in mm. Cost: linear in the length of the beads and in the area; for crossing lines also the pieces of a
//! level times the lines of coarser ones.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, SQRT_2};

use grainpath_core::mask::{Mask, MaskGrid};
use grainpath_core::math::{direction, rotated};
use grainpath_core::poly::{Join, LineClipper, stretched_to};
use grainpath_core::units::{bead_spacing_mm, bead_width_mm};
use grainpath_core::{
    BeadWidth, Bounds2, DVec2, DVec3, Density, DirectionField, DirectionSample, Polygon, Region, Toolpath,
};
use grainpath_job::choices::Pattern;

use super::continuous::necks;
use super::field::streamlines;
use super::field::stripes::{self, NARROWEST, WIDEST, simplified};
use super::hatch::{Hatch, Joints, Lines};
use super::rectilinear::sparse;
use super::{Continuous, FillContext, Honeycomb, Infill, Note, Solid, gyroid};
use crate::guide::graded_density::DensityMap;

/// From this density on lines lie side by side in one direction. Source: derived. Crossing lines at a
/// density of 0.8 would overlap over 0.16 of the area and more.
const DENSE_FROM: f64 = 0.8;
/// Density of the finest level of crossing lines. Its beads are wider by the root of 2 where it meets dense lines.
const FINEST: f64 = DENSE_FROM / SQRT_2;
/// Side of the window in which volume is fitted, mm; also that of the cells over which densities are measured
/// ([`laid_density`](crate::measure::laid_density)). Source: chosen; a requirement of the project.
pub(crate) const WINDOW_MM: f64 = 5.0;
/// Distance between points at which a bead may change its width, mm. Source: derived: a quarter of the window.
const VERTICES_MM: f64 = 1.25;
/// Rounds of fitting. Measured: in `every_pattern_lays_the_density_of_each_cell` the worst cell of `grid` is off by 11 % of
/// full with 3 rounds, by 7 with 6 and by 6 with 8.
const ROUNDS: usize = 8;
/// Lines shorter than this, in beads, are left out. Source: derived. Twice the shortest piece of `stripes`:
/// lines of sparse infill have no support between their ends.
const SHORTEST: f64 = 4.0;

/// Pieces of honeycomb shorter than this, in beads, are left out. Source: derived. The shortest piece that `stripes` lay;
/// longer ones hold their neighbours.
const SHORTEST_PIECE: f64 = 0.5 * SHORTEST;

/// Fills a region at the densities of a map.
pub fn fill(
    pattern: Pattern,
    context: &FillContext<'_>,
    map: &DensityMap,
    infill_region: &Polygon,
    out: &mut Vec<Toolpath>,
) {
    let Some(bounds) = infill_region.bounds() else { return };
    let range = map.range_in(bounds, context.z_mid_mm);
    let (first, s) = (out.len(), context.spacing_mm());
    let whole = Region::from(infill_region.clone());
    let one_direction = matches!(pattern, Pattern::Rectilinear | Pattern::Aligned);
    let dense = if range[1] < DENSE_FROM || one_direction {
        Region::default()
    } else {
        // Islands and bays narrower than two beads are removed.
        let there = map.at_least(DENSE_FROM, bounds, context.z_mid_mm).intersection(&whole);
        there.opened(s).closed(s).intersection(&whole)
    };
    let rest = if dense.is_empty() { whole } else { whole.difference(&dense) };
    match pattern {
        Pattern::Stripes | Pattern::Streamlines => along_field(context, map, &rest, &dense, range, out),
        Pattern::Rectilinear | Pattern::Aligned => levels(context, map, &rest, 1, 1.0, range, out),
        Pattern::Triangles => levels(context, map, &rest, 3, FINEST, range, out),
        Pattern::Gyroid => {
            let densities: Vec<f64> = (0..=coarsest(FINEST, range[0])).map(|k| level(FINEST, k).0).collect();
            for polygon in &rest.polygons {
                gyroid::graded(context, map, polygon, &densities, out);
            }
        }
        Pattern::Honeycomb => bands(context, map, &rest, range, out),
        // The job's reader refuses a graded density for `concentric` and `seed-lines`; `continuous` is laid by `one_path`.
        Pattern::Grid | Pattern::Concentric | Pattern::SeedLines | Pattern::Continuous => {
            levels(context, map, &rest, 2, FINEST, range, out)
        }
    }
    if !pattern.follows_field() {
        let turned = is_turned(context.z_mid_mm, context.height_mm);
        let angle_rad = context.angle_rad + if turned { FRAC_PI_2 } else { 0.0 };
        let context = FillContext { density: Density::Dense, angle_rad, ..*context };
        dense.polygons.iter().for_each(|polygon| Solid.fill(&context, polygon, out));
    }
    fit(&mut out[first..], context, map, infill_region);
}

/// Fills the infill regions of an island as one path for each, at the densities of a map.
pub fn one_path(
    continuous: &Continuous,
    context: &FillContext<'_>,
    map: &DensityMap,
    infill_regions: &[&Polygon],
    out: &mut Vec<Toolpath>,
    notes: &mut Vec<Note>,
) {
    let regions: Vec<Polygon> = infill_regions.iter().map(|&r| r.clone()).collect();
    necks(&regions, context.bead_width_mm, notes);
    for infill_region in &regions {
        let first = out.len();
        // Rings of different bands become one path before widths are fitted, so that joints get their share too.
        let bands = bands_of_strips(context, map, infill_region);
        continuous.lay_bands(context, infill_region, &bands, out, notes);
        fit(&mut out[first..], context, map, infill_region);
    }
}

/// Divides the area of an infill region into bands, from the densest to the sparsest; from band to band the density halves.
/// Beads are as wide as the density needs within a band, from half to one and a half of its strip.
fn bands_of_strips(
    context: &FillContext<'_>,
    map: &DensityMap,
    infill_region: &Polygon,
) -> Vec<(Density, Region)> {
    let mut rest = Region::from(infill_region.clone()).offset(context.border_mm, Join::Miter(2.0));
    let mut bands = Vec::new();
    let Some(bounds) = rest.bounds() else { return bands };
    let [least, _] = map.range_in(bounds, context.z_mid_mm);
    let last = coarsest(1.0, least);
    let densities = map.in_plan(bounds, context.z_mid_mm);
    for k in 0..last {
        let (density, from) = level(1.0, k);
        let spacing_mm = context.spacing_mm() / density;
        // A band is at least one strip wide. Places too narrow for two beads of the next band belong to it too.
        let there = densities.at_least(from).opened(spacing_mm);
        let narrowest_mm = 2.0 * spacing_mm + context.bead_width_mm;
        let left = rest.difference(&there).opened(0.5 * narrowest_mm);
        bands.push((Density::new(density), rest.difference(&left)));
        rest = left;
    }
    bands.push((Density::new(level(1.0, last).0), rest));
    bands.retain(|(_, band)| !band.is_empty());
    bands
}

/// Whether the parallel lines of a layer are turned by 90 degrees: in every other layer, as in skins.
pub(crate) fn is_turned(z_mid_mm: f64, height_mm: f64) -> bool {
    (z_mid_mm / height_mm).floor().rem_euclid(2.0) >= 1.0
}

/// The density of a level, and the least density at which its lines are laid.
fn level(finest: f64, k: i32) -> (f64, f64) {
    let density = finest / f64::from(1u32 << k);
    (density, density / SQRT_2)
}

/// The coarsest level that the least density needs.
fn coarsest(finest: f64, least: f64) -> i32 {
    (0..16).find(|&k| level(finest, k).1 <= least).unwrap_or(16)
}

/// Lays straight lines in this number of directions, at distances that double from level to level.
fn levels(
    context: &FillContext<'_>,
    map: &DensityMap,
    region: &Region,
    directions: usize,
    finest: f64,
    [least, most]: [f64; 2],
    out: &mut Vec<Toolpath>,
) {
    let Some(bounds) = region.bounds() else { return };
    let n = directions as f64;
    let last = coarsest(finest, least);
    let step_mm = |k: i32| n * context.spacing_mm() / level(finest, k).0;
    let angles = || (0..directions).map(|d| context.angle_rad + PI * d as f64 / n);
    let raster =
        |angle_rad: f64| if directions == 1 { *context } else { leaning(context, angle_rad + FRAC_PI_2) };
    let first = out.len();
    for angle in angles() {
        let context = raster(angle);
        region.polygons.iter().for_each(|polygon| sparse(&context, polygon, angle, step_mm(last), 1, out));
    }
    let clipper = LineClipper::new(region);
    // Lines of the coarser levels, with the number of their direction. Where the density changes with the height, the layer
    // below has no line of the finer level, and an end between two coarser lines would hang in the air.
    let mut coarser: Vec<(usize, [DVec2; 2])> = Vec::new();
    for (d, angle) in angles().enumerate().filter(|_| directions > 1 && last > 0) {
        // Joints along the border are left out; a turn rounds by far less than a nanometre.
        let along = |w: &[DVec2]| rotated(w[1] - w[0], direction(-angle)).y.abs() < 1e-6;
        let straight = out[first..].iter().flat_map(|p| p.points.windows(2)).filter(|w| along(w));
        coarser.extend(straight.map(|w| (d, [w[0], w[1]])));
    }
    let densities = map.in_plan(bounds, context.z_mid_mm);
    for k in (0..last).rev().filter(|&k| most >= level(finest, k).1) {
        let there = densities.at_least(level(finest, k).1).intersection(region);
        let mut laid = Vec::new();
        for (d, angle_rad) in angles().enumerate() {
            // These lines lie halfway between those of the next coarser level.
            let first_mm = rotated(raster(angle_rad).part.centre(), direction(-angle_rad)).y + step_mm(k);
            let lines = Lines { angle_rad, first_mm, step_mm: 2.0 * step_mm(k) };
            // Ends are not joined, because a joint would cross a line of the coarser level.
            let joints = Joints { longest_mm: 0.0, bulge_mm: 0.0, past_mm: 0.0 };
            let paths = there.polygons.iter().flat_map(|p| Hatch::new(p, lines).paths(&joints));
            let pieces: Vec<[DVec2; 2]> =
                paths.flat_map(|p| p.windows(2).map(|w| [w[0], w[1]]).collect::<Vec<_>>()).collect();
            let crossing: Vec<[DVec2; 2]> = coarser.iter().filter(|l| l.0 != d).map(|l| l.1).collect();
            laid.extend(
                stretched_to(&pieces, angle_rad, &crossing, &clipper).into_iter().map(|piece| (d, piece)),
            );
        }
        laid.retain(|(_, [a, b])| a.distance(*b) > SHORTEST * context.bead_width_mm);
        let path =
            |l: &(usize, [DVec2; 2])| Toolpath::new(l.1.to_vec(), context.bead_width_mm, context.role, false);
        out.extend(laid.iter().map(path));
        coarser.append(&mut laid);
    }
}

/// How far crossing lines and hexagons move for each mm of height. Source: derived; the faces of cubes that stand on a corner
/// lean so (the pattern that slicers call cubic). In layers half as high as beads are wide, a bead moves by 0.35 of its width.
const LEAN: f64 = FRAC_1_SQRT_2;

/// Hexagons lean in this direction from that of their flats, radians. Source: derived; 30 degrees from flats and from one pair
/// of ramps, square to the other pair. Along the flats themselves, double walls would stay above each other, and a cell beside
/// them would miss them in all layers.
const HONEYCOMB_LEANS_RAD: f64 = PI / 6.0;

/// A context whose raster has moved to one side with the height.
fn leaning<'a>(context: &FillContext<'a>, towards_rad: f64) -> FillContext<'a> {
    let by = LEAN * context.z_mid_mm * direction(towards_rad);
    let part = Bounds2 { min: context.part.min + by, max: context.part.max + by };
    FillContext { part, ..*context }
}

/// Lays hexagons whose sides double from level to level.
fn bands(
    context: &FillContext<'_>,
    map: &DensityMap,
    region: &Region,
    [least, most]: [f64; 2],
    out: &mut Vec<Toolpath>,
) {
    let Some(bounds) = region.bounds() else { return };
    let mut rest = region.clone();
    let densities = map.in_plan(bounds, context.z_mid_mm);
    for k in 0..=coarsest(FINEST, least) {
        let (density, from) = level(FINEST, k);
        if most < from {
            continue;
        }
        let here = if from <= least { rest.clone() } else { densities.at_least(from).intersection(&rest) };
        let context = FillContext {
            density: Density::Sparse(density),
            ..leaning(context, context.angle_rad + HONEYCOMB_LEANS_RAD)
        };
        let mut lines = Vec::new();
        here.polygons.iter().for_each(|polygon| Honeycomb.fill(&context, polygon, &mut lines));
        out.extend(
            lines.into_iter().filter(|line| line.length_mm() > SHORTEST_PIECE * context.bead_width_mm),
        );
        rest = rest.difference(&here);
    }
}

/// A direction field with the line distances that a density map asks for.
struct Spaced<'a> {
    field: &'a dyn DirectionField,
    map: &'a DensityMap,
    spacing_mm: f64,
}

impl DirectionField for Spaced<'_> {
    fn sample(&self, p: DVec3) -> DirectionSample {
        self.field.sample(p)
    }

    fn spacing_mm(&self, p: DVec3) -> Option<f64> {
        Some(self.spacing_mm / self.map.at(p))
    }
}

/// Lays lines along the field: evenly spaced streamlines, and stripes where the density is high.
fn along_field(
    context: &FillContext<'_>,
    map: &DensityMap,
    rest: &Region,
    dense: &Region,
    [_, most]: [f64; 2],
    out: &mut Vec<Toolpath>,
) {
    let Some(field) = context.field else { return };
    let field = Spaced { field, map, spacing_mm: context.spacing_mm() };
    let sparse =
        FillContext { field: Some(&field), density: Density::Sparse(most.min(DENSE_FROM)), ..*context };
    let mut lines = Vec::new();
    rest.polygons.iter().for_each(|polygon| streamlines::graded(&sparse, polygon, &mut lines));
    out.extend(lines.into_iter().filter(|line| line.length_mm() > SHORTEST * context.bead_width_mm));
    for polygon in &dense.polygons {
        let Some(bounds) = polygon.bounds() else { continue };
        let [low, high] = map.range_in(bounds, context.z_mid_mm);
        let share = 0.5 * (low.max(DENSE_FROM) + high);
        // A nearly dense region is laid dense; the bead widths make up for the difference.
        let share = Density::new(if share > 0.95 { 1.0 } else { share }).fraction();
        stripes::spaced(context, polygon, share, out);
    }
}

/// Table from which the sum over any rectangle of a grid is read.
struct Sums(Vec<f64>);

impl Sums {
    fn new([nx, ny]: [usize; 2], values: &[f64]) -> Self {
        let mut sums = vec![0.0; (nx + 1) * (ny + 1)];
        for j in 0..ny {
            let mut row = 0.0;
            for i in 0..nx {
                row += values[j * nx + i];
                sums[(j + 1) * (nx + 1) + i + 1] = sums[j * (nx + 1) + i + 1] + row;
            }
        }
        Self(sums)
    }

    /// The places of the table from which the sum over a square is read that reaches `half` cells to each side of `p`,
    /// which is given in cells, in a grid of this size.
    fn around([nx, ny]: [usize; 2], p: DVec2, half: f64) -> [u32; 4] {
        let cut = |v: f64, n: usize| v.round().clamp(0.0, n as f64) as usize;
        let [x0, x1] = [p.x - half, p.x + half].map(|v| cut(v, nx));
        let [y0, y1] = [p.y - half, p.y + half].map(|v| cut(v, ny));
        [(x1, y1), (x0, y1), (x1, y0), (x0, y0)].map(|(x, y)| (y * (nx + 1) + x) as u32)
    }

    /// The sum over a square.
    fn of(&self, around: [u32; 4]) -> f64 {
        let [a, b, c, d] = around.map(|place| self.0[place as usize]);
        a - b - c + d
    }
}

/// Sets the widths of beads so that the volume in the windows around each of their points matches the density map, within the
/// printable widths. The correction of Richardson and Lucy: for lines at an even distance below the window's side it is exact.
fn fit(paths: &mut [Toolpath], context: &FillContext<'_>, map: &DensityMap, infill_region: &Polygon) {
    let area = Region::from(infill_region.clone()).offset(context.border_mm, Join::Miter(2.0));
    let Some(bounds) = area.bounds() else { return };
    let (h, nominal) = (context.height_mm, context.bead_width_mm);
    // The narrowest bead of the job counts where it is wider than the narrowest that a nozzle lays well.
    let narrowest_mm = (NARROWEST * nominal).max(context.min_bead_width_mm).min(nominal);
    let mask = Mask::from_region(MaskGrid::over(bounds, 0.5), &area);
    let grid = MaskGrid::over(bounds, 0.5);
    let ([nx, ny], cell_mm, origin) = (grid.size(), grid.cell_mm(), grid.origin());
    let at = |p: DVec2| map.at(p.extend(context.z_mid_mm));
    let asked = |k: usize| {
        let (i, j) = (k % nx, k / nx);
        if !mask.get(i, j) {
            return 0.0;
        }
        at(origin + cell_mm * DVec2::new(i as f64 + 0.5, j as f64 + 0.5)) * cell_mm * cell_mm
    };
    let asked = Sums::new([nx, ny], &(0..nx * ny).map(asked).collect::<Vec<f64>>());
    let half = 0.5 * WINDOW_MM / cell_mm;
    let middle = |k: usize| DVec2::new((k % nx) as f64 + 0.5, (k / nx) as f64 + 0.5);
    // The windows, by the cell in their middle, where they lie and what each asks for. Every other cell suffices: they are
    // then 1 mm apart.
    let in_area =
        |&k: &usize| (k % nx).is_multiple_of(2) && (k / nx).is_multiple_of(2) && mask.get(k % nx, k / nx);
    let window = |k: usize| {
        let around = Sums::around([nx, ny], middle(k), half);
        (k, around, asked.of(around))
    };
    let windows: Vec<(usize, [u32; 4], f64)> = (0..nx * ny).filter(in_area).map(window).collect();
    for path in &mut *paths {
        divide(path);
    }
    // The number of short pieces of each segment, and the cell and length of each piece. Places do not change while widths are
    // fitted, and neither do the windows around vertices.
    let (mut n_pieces, mut pieces): (Vec<usize>, Vec<(usize, f64)>) = (Vec::new(), Vec::new());
    for path in &*paths {
        for k in 0..path.n_segments() {
            let (a, b, _) = path.segment(k);
            let n = (a.distance(b) / (0.5 * cell_mm)).ceil().max(1.0);
            for i in 0..n as usize {
                let q = (a.lerp(b, (i as f64 + 0.5) / n) - origin) / cell_mm;
                let (x, y) = (q.x.max(0.0) as usize, q.y.max(0.0) as usize);
                pieces.push((y.min(ny - 1) * nx + x.min(nx - 1), a.distance(b) / n));
            }
            n_pieces.push(n as usize);
        }
    }
    let vertices = paths.iter().flat_map(|path| &path.points);
    let of_vertices: Vec<[u32; 4]> =
        vertices.map(|p| Sums::around([nx, ny], (*p - origin) / cell_mm, half)).collect();
    // The windows that hold any volume are the same in nearly all rounds.
    let mut counted = (vec![0.0; nx * ny], None);
    for _ in 0..ROUNDS {
        let mut laid = vec![0.0; nx * ny];
        let mut rest = &pieces[..];
        let segments = paths.iter().flat_map(|path| (0..path.n_segments()).map(|k| path.segment(k).2));
        for (width, n) in segments.zip(&n_pieces) {
            let (own, others) = rest.split_at(*n);
            let strip_mm = bead_spacing_mm(width, h);
            own.iter().for_each(|&(cell, mm)| laid[cell] += strip_mm * mm);
            rest = others;
        }
        let laid = Sums::new([nx, ny], &laid);
        // The volume that each window asks for over the one that it holds, where it holds any.
        let mut short = vec![0.0; nx * ny];
        for &(k, around, asked_mm2) in &windows {
            let laid_mm2 = laid.of(around);
            let (ratio, counts) = if laid_mm2 > 1e-9 { (asked_mm2 / laid_mm2, 1.0) } else { (0.0, 0.0) };
            short[k] = ratio;
            if counted.0[k] != counts {
                (counted.0[k], counted.1) = (counts, None);
            }
        }
        let short = Sums::new([nx, ny], &short);
        let counted = &*counted.1.get_or_insert_with(|| Sums::new([nx, ny], &counted.0));
        let mut places = of_vertices.iter();
        for path in &mut *paths {
            let own = places.by_ref().take(path.points.len());
            let BeadWidth::PerVertex(widths) = &mut path.width else { continue };
            for (around, width) in own.zip(widths) {
                let n = counted.of(*around);
                let factor = if n > 0.0 { short.of(*around) / n } else { 1.0 };
                let strip = (factor * bead_spacing_mm(*width, h)).clamp(0.01, 10.0 * nominal);
                *width = bead_width_mm(strip, h).clamp(narrowest_mm, WIDEST * nominal);
            }
        }
    }
    for path in paths {
        if let BeadWidth::PerVertex(widths) = &path.width {
            let (points, widths) = simplified(&path.points, widths, path.closed);
            (path.points, path.width) = (points, BeadWidth::PerVertex(widths));
        }
    }
}

/// Puts vertices into the long segments of a path, so that its width can change there.
fn divide(path: &mut Toolpath) {
    let n = path.points.len();
    let (mut points, mut widths) = (Vec::with_capacity(2 * n), Vec::with_capacity(2 * n));
    for k in 0..n {
        let (p, w) = (path.points[k], path.width_at(k));
        points.push(p);
        widths.push(w);
        if k + 1 == n && !path.closed {
            break;
        }
        let (q, v) = (path.points[(k + 1) % n], path.width_at((k + 1) % n));
        let pieces = (p.distance(q) / VERTICES_MM).ceil().max(1.0);
        for i in 1..pieces as usize {
            let t = i as f64 / pieces;
            points.push(p.lerp(q, t));
            widths.push(w + t * (v - w));
        }
    }
    (path.points, path.width) = (points, BeadWidth::PerVertex(widths));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::laid_density::{AskedDensity, LaidDensity};
    use crate::order::{Island, LayerPaths};
    use grainpath_core::{Layer, LayerStack, Role, UniformField};
    use grainpath_job::choices::{BeadEnds, BeadWidths, Choice, DensityBy};
    use rayon::prelude::*;

    static FIELD: UniformField = UniformField { axis_rad: 0.3 };

    /// Densities from 0.1 to 0.9 along x.
    fn ramp() -> DensityMap {
        DensityMap::new(DVec3::ZERO, DVec3::new(80.0, 50.0, 10.0), 1.0, true, |p| {
            (0.1 + 0.8 * (p.x - 10.0) / 60.0).clamp(0.1, 0.9)
        })
    }

    fn context(z_mid_mm: f64) -> FillContext<'static> {
        FillContext {
            z_mid_mm,
            height_mm: 0.2,
            bead_width_mm: 0.45,
            min_bead_width_mm: 0.2,
            density: Density::Sparse(0.5),
            angle_rad: std::f64::consts::FRAC_PI_4,
            part: Bounds2 { min: DVec2::ZERO, max: DVec2::new(80.0, 50.0) },
            role: Role::SparseFill,
            border_mm: 0.5 * bead_spacing_mm(0.45, 0.2),
            ends: BeadEnds::Joined,
            shift: crate::fill::Shift::NONE,
            below: &[],
            fills_wedges: true,
            widths: BeadWidths::Variable,
            field: Some(&FIELD),
        }
    }

    /// Patterns whose density is held cell by cell.
    const PATTERNS: [Pattern; 6] = [
        Pattern::Rectilinear,
        Pattern::Grid,
        Pattern::Triangles,
        Pattern::Gyroid,
        Pattern::Honeycomb,
        Pattern::Streamlines,
    ];

    #[test]
    fn every_pattern_follows_a_ramp_of_density() {
        let map = ramp();
        let region = &Region::rectangle(DVec2::ZERO, DVec2::new(80.0, 50.0)).polygons[0];
        let mut wrong = Vec::new();
        for pattern in PATTERNS.into_iter().chain([Pattern::Continuous]) {
            // Volume in columns of 5 mm over the height of the part, in 25 layers.
            let mut laid = [0.0f64; 16];
            let layers = if pattern.follows_field() { 1 } else { 24 };
            for layer in 0..layers {
                let mut paths = Vec::new();
                let mut context = context(0.2 * f64::from(layer) + 0.1);
                if pattern == Pattern::Rectilinear && layer % 2 == 1 {
                    context.angle_rad = -context.angle_rad;
                }
                if pattern == Pattern::Continuous {
                    let mut notes = Vec::new();
                    one_path(&Continuous::FOR_TESTS, &context, &map, &[region], &mut paths, &mut notes);
                    assert!(paths.len() == 1 && paths[0].closed && notes.is_empty(), "{notes:?}");
                } else {
                    fill(pattern, &context, &map, region, &mut paths);
                }
                for (path, k) in paths.iter().flat_map(|p| (0..p.n_segments()).map(move |k| (p, k))) {
                    let (a, b, width) = path.segment(k);
                    assert!((0.6 * 0.45 - 1e-9..=1.6 * 0.45 + 1e-9).contains(&width), "{width}");
                    let n = (a.distance(b) / 0.1).ceil().max(1.0);
                    for i in 0..n as usize {
                        let x = a.lerp(b, (i as f64 + 0.5) / n).x;
                        laid[((x / 5.0).max(0.0) as usize).min(15)] +=
                            bead_spacing_mm(width, 0.2) * a.distance(b) / n;
                    }
                }
            }
            let error = |k: usize| {
                let asked = map.at(DVec3::new(5.0 * k as f64 + 2.5, 25.0, 1.0));
                (laid[k] / (5.0 * 50.0 * f64::from(layers)) - asked).abs()
            };
            // The beads of the first and the last column fill the strip beyond the region too.
            let mean = (1..15).map(error).sum::<f64>() / 14.0;
            let worst = (1..15).map(error).fold(0.0, f64::max);
            println!("{}: mean {mean:.4}, worst {worst:.4}", pattern.name());
            if mean > 0.03 || worst > 0.1 {
                wrong.push(format!("{}: mean {mean:.4}, worst {worst:.4}", pattern.name()));
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    /// Maps of density over a part of 60 x 40 mm, after the limit of their slope.
    fn fields() -> Vec<(&'static str, DensityMap)> {
        let of = |at: &dyn Fn(DVec3) -> f64| {
            let mut map = DensityMap::new(DVec3::ZERO, DVec3::new(60.0, 40.0, 5.0), 1.0, false, at);
            map.limit(bead_spacing_mm(0.45, 0.2));
            map
        };
        let squares = |side: f64, p: DVec3| ((p.x / side).floor() + (p.y / side).floor()) % 2.0 == 0.0;
        vec![
            ("even 0.15", of(&|_| 0.15)),
            ("ramp along x", of(&|p| (0.1 + 0.8 * p.x / 60.0).clamp(0.1, 0.9))),
            ("step", of(&|p| if p.x < 28.0 { 0.15 } else { 0.7 })),
            ("squares of 5 mm", of(&|p| if squares(5.0, p) { 0.9 } else { 0.1 })),
            ("squares of 10 mm", of(&|p| if squares(10.0, p) { 0.9 } else { 0.1 })),
        ]
    }

    #[test]
    fn every_pattern_lays_the_density_of_each_cell() {
        let infill_region = Region::rectangle(DVec2::ZERO, DVec2::new(60.0, 40.0));
        let border_mm = 0.5 * bead_spacing_mm(0.45, 0.2);
        let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, infill_region.clone()).expect("a layer");
        let stack = LayerStack::new((0..25).map(layer).collect()).expect("heights rise");
        let areas = vec![infill_region.offset(border_mm, Join::Miter(2.0)); 25];
        let mut wrong = Vec::new();
        for pattern in PATTERNS {
            // Parallel lines are farthest off where they run along the cells; gyroids and lines along a field have no angle.
            let crosses = matches!(pattern, Pattern::Grid | Pattern::Triangles | Pattern::Honeycomb);
            let angles: &[f64] = if crosses { &[0.0, 0.5 * FRAC_PI_2] } else { &[0.0] };
            for (name, map) in fields() {
                for &angle_rad in angles {
                    let paths = |k: u32| {
                        let turned = pattern == Pattern::Rectilinear && k % 2 == 1;
                        let angle_rad = angle_rad + if turned { FRAC_PI_2 } else { 0.0 };
                        let part = Bounds2 { min: DVec2::ZERO, max: DVec2::new(60.0, 40.0) };
                        let context = FillContext { angle_rad, part, ..context(0.2 * f64::from(k) + 0.1) };
                        let mut fills = Vec::new();
                        fill(pattern, &context, &map, &infill_region.polygons[0], &mut fills);
                        LayerPaths {
                            islands: vec![Island { walls: Vec::new(), fills }],
                            ..LayerPaths::default()
                        }
                    };
                    let layers: Vec<LayerPaths> = (0..25).into_par_iter().map(paths).collect();
                    let asked = AskedDensity {
                        map: &map,
                        range: [0.1, 0.9],
                        by: DensityBy::Stress,
                        fall_mm: 0.0,
                        areas: &areas,
                    };
                    let found = LaidDensity::measure(&asked, &stack, &layers);
                    let row = format!(
                        "{} {name} at {angle_rad:.1}: mean {:.4}, worst {:.4}",
                        pattern.name(),
                        found.mean_error,
                        found.worst_error
                    );
                    println!("{row}");
                    // Squares of 5 mm are as small as the windows, and `triangles` of 0.15 have cells of 7 mm.
                    if found.mean_error > 0.035 || found.worst_error > 0.1 {
                        wrong.push(row);
                    }
                }
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    #[test]
    fn no_bead_is_narrower_than_the_job_allows() {
        let map = ramp();
        let region = &Region::rectangle(DVec2::ZERO, DVec2::new(80.0, 50.0)).polygons[0];
        // The widest of these is that of a usual bead, and the narrowest has no effect.
        for (allowed_mm, narrowest_mm) in [(0.1, 0.6 * 0.45), (0.36, 0.36), (0.45, 0.45)] {
            for pattern in [
                Pattern::Rectilinear,
                Pattern::Grid,
                Pattern::Gyroid,
                Pattern::Streamlines,
                Pattern::Continuous,
            ] {
                let context = FillContext { min_bead_width_mm: allowed_mm, ..context(0.1) };
                let mut paths = Vec::new();
                if pattern == Pattern::Continuous {
                    one_path(&Continuous::FOR_TESTS, &context, &map, &[region], &mut paths, &mut Vec::new());
                } else {
                    fill(pattern, &context, &map, region, &mut paths);
                }
                let widths = paths.iter().flat_map(|p| (0..p.points.len()).map(move |k| p.width_at(k)));
                let found_mm = widths.fold(f64::INFINITY, f64::min);
                let name = pattern.name();
                assert!(
                    found_mm >= narrowest_mm - 1e-9,
                    "{name}: {found_mm} mm where {narrowest_mm} is allowed"
                );
            }
        }
    }

    #[test]
    fn lines_of_every_level_end_on_a_crossing_line_or_at_the_border() {
        // The densest place is an island in the middle of the region.
        let map = DensityMap::new(DVec3::ZERO, DVec3::new(80.0, 50.0, 10.0), 1.0, true, |p| {
            (0.9 - 0.03 * p.truncate().distance(DVec2::new(41.0, 26.0))).clamp(0.1, 0.7)
        });
        let region = &Region::rectangle(DVec2::ZERO, DVec2::new(80.0, 50.0)).polygons[0];
        for pattern in [Pattern::Grid, Pattern::Triangles] {
            let mut paths = Vec::new();
            fill(pattern, &context(2.1), &map, region, &mut paths);
            let segments =
                |p: &Toolpath| (0..p.n_segments()).map(|k| [p.segment(k).0, p.segment(k).1]).collect();
            let lines: Vec<Vec<[DVec2; 2]>> = paths.iter().map(segments).collect();
            let mut inside = 0;
            for (n, path) in paths.iter().enumerate() {
                for end in [path.start(), path.points[path.points.len() - 1]] {
                    if end.min(DVec2::new(80.0, 50.0) - end).min_element() < 0.01 {
                        continue;
                    }
                    inside += 1;
                    let held = lines.iter().enumerate().any(|(other, line)| {
                        other != n
                            && line.iter().any(|[a, b]| {
                                grainpath_core::segment::distance_squared_mm2(end, *a, *b) < 1e-6
                            })
                    });
                    assert!(held, "{}: an end hangs at {end}", pattern.name());
                }
            }
            assert!(inside > 40, "{}: {inside} ends inside", pattern.name());
        }
    }

    #[test]
    fn lines_of_a_level_lie_halfway_between_those_of_the_level_before() {
        let map = ramp();
        let region = &Region::rectangle(DVec2::ZERO, DVec2::new(80.0, 50.0)).polygons[0];
        let mut paths = Vec::new();
        let context = FillContext { angle_rad: 0.0, ..context(0.1) };
        fill(Pattern::Rectilinear, &context, &map, region, &mut paths);
        // All lines lie on the raster of the finest level.
        let s = context.spacing_mm();
        for w in paths.iter().flat_map(|p| p.points.windows(2)).filter(|w| (w[0].y - w[1].y).abs() < 1e-9) {
            let row = (w[0].y - 25.0) / s;
            // Joints follow the border.
            if w[0].y > 0.1 && w[0].y < 49.9 {
                assert!((row - row.round()).abs() < 1e-6, "{row}");
            }
        }
        assert_eq!(coarsest(1.0, 0.1), 3);
    }
}
