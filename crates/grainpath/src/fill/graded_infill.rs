//! Infill whose density differs from place to place.
//!
//! Each pattern is laid close to the wanted density, and the widths of the beads are then adjusted to match it:
//!
//! - straight lines (`rectilinear`, `aligned`, `grid`, `triangles`) lie on rasters whose distances double
//!   from level to level. The coarsest raster covers the whole region. Where the density is above a level,
//!   lines of the next finer level are added halfway between. So no line is shifted where levels meet. Lines
//!   of one direction lie above each other. Crossing lines lean as a whole, so that a cell narrower than the distance of two
//!   lines holds its share of them over the layers. Their ends are not joined along the border: such joints would lay a bead
//!   more along every wall, which is as much as sparse cells there ask for;
//! - `gyroid` is traced as the zero line of one function, which changes from a period to half of it where
//!   levels meet, so that the walls continue;
//! - `honeycomb` is laid level by level, cut where levels meet, and leans too. Its levels lie closer to each other;
//! - `stripes` and `streamlines` are evenly spaced streamlines, whose distance follows the local density, and
//!   stripes where the density is high, and single lines where these leave a place empty (`gap_lines`);
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
//! the windows around it ask for over what they hold, weighted by the root of what they hold, within the widths that a
//! nozzle can lay. A single window around the bead itself would hold one line always where lines are farther apart than half
//! its side, and lay up to twice too much. Windows of patterns that lean are cubes, and the beads of all layers are fitted
//! together (`fit_layers`): a window in one layer may hold no line at all where the layers above and below hold their share.
//!
//! Lengths are in mm. Cost: linear in the length of the beads and in the area; for crossing lines also the pieces of a
//! level times the lines of coarser ones.

use std::cell::LazyCell;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, SQRT_2};

use grainpath_core::mask::{Mask, MaskGrid};
use grainpath_core::math::{direction, rotated};
use grainpath_core::poly::{Join, LineClipper, stretched_to};
use grainpath_core::units::{bead_spacing_mm, bead_width_mm};
use grainpath_core::{
    BeadWidth, Bounds2, DVec2, DVec3, Density, DirectionField, DirectionSample, Polygon, Region, Toolpath,
};
use grainpath_job::choices::Pattern;
use rayon::prelude::*;

use super::continuous::necks;
use super::density_windows::{self, Sums, WINDOW_MM, Windows};
use super::field::streamlines;
use super::field::stripes::{self, NARROWEST, WIDEST, simplified};
use super::gap_lines::{SHORTEST, lines_in_gaps};
use super::hatch::{Hatch, Joints, Lines};
use super::rectilinear::sparse;
use super::{Continuous, FillContext, Honeycomb, Infill, Note, Solid, gyroid};
use crate::guide::graded_density::{DensityMap, PlanDensity};

/// From this density on lines lie side by side in one direction. Source: derived. Crossing lines at a
/// density of 0.8 would overlap over 0.16 of the area and more.
const DENSE_FROM: f64 = 0.8;
/// Density of the finest level of crossing lines. Its beads are wider by the root of 2 where it meets dense lines.
const FINEST: f64 = DENSE_FROM / SQRT_2;
/// Share of a level's density from which on its lines are laid, for patterns whose lines lie far apart: beads are then narrowed
/// to 0.6 and widened to 1.2 of their level. Source: derived; the narrowest bead that a nozzle lays well holds 0.53 to 0.58 of a
/// usual one in layers of 0.3 to 0.1 mm. Measured: with the root of a half, as for other patterns, cells of `triangles` at 0.19 were off
/// by 12.8 % of full at worst and 4.0 % in the mean, of `rectilinear` at 0.17 by 3.3 % in the mean; with 0.6 by 8.9, 2.6 and 2.5 %.
const EARLY: f64 = 0.6;
/// Distance between points at which a bead may change its width, mm. Source: derived: a quarter of the window.
const VERTICES_MM: f64 = 1.25;
/// Rounds of fitting. Measured: in a block of 40 x 30 x 20 mm, nine densities, the worst cell of `grid` is off by 6.4 % of full
/// with 5 rounds, by 6.1 with 8 and by 5.9 with 16.
const ROUNDS: usize = 8;
/// Number of cells of [`fit_layers`] across a window, where the part has at most [`MOST_CELLS`] of them. Odd, so that windows
/// have a cell in their middle. Source: derived: cells of 1 mm are narrower than the shortest distance at which levels change.
const CELLS_ACROSS: usize = 5;
/// Largest number of cells of [`fit_layers`]; they are larger in larger parts. Source: derived: the six numbers of four bytes
/// that are held for each of them are 48 MB.
const MOST_CELLS: f64 = 2e6;

/// Pieces of honeycomb shorter than this, in beads, are left out. Source: derived. The shortest piece that `stripes` lay;
/// longer ones hold their neighbours.
const SHORTEST_PIECE: f64 = 0.5 * SHORTEST;

/// Fills a region at the densities of a map. Beads that lean (`leans`) keep the width of a usual bead until `fit_layers` fits
/// those of all layers.
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
    let densities = LazyCell::new(|| map.in_plan(bounds, context.z_mid_mm));
    let one_direction = matches!(pattern, Pattern::Rectilinear | Pattern::Aligned);
    let dense = if range[1] < DENSE_FROM || one_direction {
        Region::default()
    } else {
        // Islands and bays narrower than two beads are removed.
        let there = densities.at_least(DENSE_FROM).intersection(&whole);
        there.opened(s).closed(s).intersection(&whole)
    };
    let rest = if dense.is_empty() { whole } else { whole.difference(&dense) };
    let levels = Levels::of(pattern, context);
    match pattern {
        Pattern::Stripes | Pattern::Streamlines => along_field(context, map, &rest, &dense, range, out),
        Pattern::Rectilinear | Pattern::Aligned => {
            straight(context, &densities, &rest, 1, levels, range, out)
        }
        Pattern::Triangles => straight(context, &densities, &rest, 3, levels, range, out),
        Pattern::Gyroid => {
            let densities: Vec<f64> = (0..=levels.coarsest(range[0])).map(|k| levels.at(k).0).collect();
            for polygon in &rest.polygons {
                gyroid::graded(context, map, polygon, &densities, out);
            }
        }
        Pattern::Honeycomb => bands(context, &densities, &rest, levels, range, out),
        // The job's reader refuses a graded density for `concentric` and `seed-lines`; `continuous` is laid by `one_path`.
        Pattern::Grid | Pattern::Concentric | Pattern::SeedLines | Pattern::Continuous => {
            straight(context, &densities, &rest, 2, levels, range, out)
        }
    }
    if !pattern.follows_field() {
        let turned = is_turned(context.z_mid_mm, context.height_mm);
        let angle_rad = context.angle_rad + if turned { FRAC_PI_2 } else { 0.0 };
        let context = FillContext { density: Density::Dense, angle_rad, ..*context };
        dense.polygons.iter().for_each(|polygon| Solid.fill(&context, polygon, out));
    }
    if let Some(windows) = (!leans(pattern)).then(|| Windows::of(context, map, infill_region)).flatten() {
        if pattern.follows_field() {
            lines_in_gaps(context, &windows, infill_region, first, out);
        }
        fit(&mut out[first..], context, &windows);
    }
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
        if let Some(windows) = Windows::of(context, map, infill_region) {
            fit(&mut out[first..], context, &windows);
        }
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
    let levels = Levels::of(Pattern::Continuous, context);
    let last = levels.coarsest(least);
    let densities = map.in_plan(bounds, context.z_mid_mm);
    for k in 0..last {
        let (density, from) = levels.at(k);
        let spacing_mm = context.spacing_mm() / density;
        // A band is at least one strip wide. Places too narrow for two beads of the next band belong to it too.
        let there = densities.at_least(from).opened(spacing_mm);
        let narrowest_mm = 2.0 * spacing_mm + context.bead_width_mm;
        let left = rest.difference(&there).opened(0.5 * narrowest_mm);
        bands.push((Density::new(density), rest.difference(&left)));
        rest = left;
    }
    bands.push((Density::new(levels.at(last).0), rest));
    bands.retain(|(_, band)| !band.is_empty());
    bands
}

/// Whether the parallel lines of a layer are turned by 90 degrees: in every other layer, as in skins.
pub(crate) fn is_turned(z_mid_mm: f64, height_mm: f64) -> bool {
    (z_mid_mm / height_mm).floor().rem_euclid(2.0) >= 1.0
}

/// Densities at which a pattern is laid before its beads become wider or narrower, from the finest to the coarsest.
#[derive(Clone, Copy)]
struct Levels {
    finest: f64,
    /// Density of a level over that of the next coarser one.
    ratio: f64,
    /// Least density at which a level is laid, as a share of its own.
    from: f64,
}

impl Levels {
    /// The levels of a pattern, none of which asks for beads narrower than the job allows.
    fn of(pattern: Pattern, context: &FillContext<'_>) -> Self {
        let (finest, ratio, from) = match pattern {
            Pattern::Grid | Pattern::Gyroid => (FINEST, 2.0, FRAC_1_SQRT_2),
            Pattern::Triangles => (FINEST, 2.0, EARLY),
            Pattern::Honeycomb => (FINEST, SQRT_2, FRAC_1_SQRT_2),
            Pattern::Rectilinear
            | Pattern::Aligned
            | Pattern::Continuous
            | Pattern::Stripes
            | Pattern::Streamlines
            | Pattern::Concentric
            | Pattern::SeedLines => (1.0, 2.0, EARLY),
        };
        let narrowest_mm = narrowest_mm(context.bead_width_mm, context.min_bead_width_mm);
        let least = bead_spacing_mm(narrowest_mm, context.height_mm) / context.spacing_mm();
        Self { finest, ratio, from: from.max(least) }
    }

    /// The density of a level, and the least density at which its lines are laid.
    fn at(self, k: i32) -> (f64, f64) {
        let density = (0..k).fold(self.finest, |density, _| density / self.ratio);
        (density, density * self.from)
    }

    /// The coarsest level that the least density needs.
    fn coarsest(self, least: f64) -> i32 {
        (0..32).find(|&k| self.at(k).1 <= least).unwrap_or(32)
    }
}

/// Width of the narrowest bead, mm: the narrowest bead of the job counts where it is wider than the narrowest that a nozzle lays
/// well.
fn narrowest_mm(bead_width_mm: f64, min_bead_width_mm: f64) -> f64 {
    (NARROWEST * bead_width_mm).max(min_bead_width_mm).min(bead_width_mm)
}

/// Whether the lines of a pattern lean, so that their widths are fitted over all layers ([`fit_layers`]).
pub(crate) fn leans(pattern: Pattern) -> bool {
    match pattern {
        Pattern::Grid | Pattern::Triangles | Pattern::Honeycomb => true,
        Pattern::Rectilinear
        | Pattern::Aligned
        | Pattern::Gyroid
        | Pattern::Concentric
        | Pattern::Stripes
        | Pattern::Streamlines
        | Pattern::SeedLines
        | Pattern::Continuous => false,
    }
}

/// Lays straight lines in this number of directions, at distances that double from level to level.
fn straight(
    context: &FillContext<'_>,
    densities: &PlanDensity,
    region: &Region,
    directions: usize,
    levels: Levels,
    [least, most]: [f64; 2],
    out: &mut Vec<Toolpath>,
) {
    if region.is_empty() {
        return;
    }
    let n = directions as f64;
    let last = levels.coarsest(least);
    let step_mm = |k: i32| n * context.spacing_mm() / levels.at(k).0;
    let angle = |d: usize| context.angle_rad + PI * d as f64 / n;
    // Square to the lines of a direction.
    let across = |d: usize| direction(angle(d) + FRAC_PI_2);
    // All directions move by this together, so that triangles stay triangles: between lines that move on their own they become
    // hexagons twice as wide at some heights, with room for a cell that no line crosses. The lines of `triangles` so move by
    // 1/2, 1 and 1/2.
    let towards = match directions {
        1 => DVec2::ZERO,
        2 => across(0) + across(1),
        _ => across(1),
    };
    let context = &leaning(context, towards);
    let row_mm = |angle_rad: f64| rotated(context.part.centre(), direction(-angle_rad)).y;
    // Ends of crossing lines are not joined, and neither are those of finer levels, because a joint would cross a line of the
    // coarser level.
    let apart = Joints { longest_mm: 0.0, bulge_mm: 0.0, past_mm: 0.0 };
    let lines_in = |there: &Region, lines: Lines| -> Vec<[DVec2; 2]> {
        let paths = there.polygons.iter().flat_map(|p| Hatch::new(p, lines).paths(&apart));
        paths.flat_map(|p| p.windows(2).map(|w| [w[0], w[1]]).collect::<Vec<_>>()).collect()
    };
    let path =
        |l: &(usize, [DVec2; 2])| Toolpath::new(l.1.to_vec(), context.bead_width_mm, context.role, false);
    // Lines of the coarser levels, with the number of their direction. Where the density changes with the height, the layer
    // below has no line of the finer level, and an end between two coarser lines would hang in the air.
    let mut coarser: Vec<(usize, [DVec2; 2])> = Vec::new();
    if directions == 1 {
        region.polygons.iter().for_each(|polygon| sparse(context, polygon, angle(0), step_mm(last), 1, out));
    } else {
        for d in 0..directions {
            let lines = Lines { angle_rad: angle(d), first_mm: row_mm(angle(d)), step_mm: step_mm(last) };
            coarser.extend(lines_in(region, lines).into_iter().map(|piece| (d, piece)));
        }
        out.extend(coarser.iter().map(path));
    }
    let clipper = LineClipper::new(region);
    for k in (0..last).rev().filter(|&k| most >= levels.at(k).1) {
        let there = densities.at_least(levels.at(k).1).intersection(region);
        let mut laid = Vec::new();
        for d in 0..directions {
            // These lines lie halfway between those of the next coarser level.
            let (angle_rad, step_mm) = (angle(d), step_mm(k));
            let lines = Lines { angle_rad, first_mm: row_mm(angle_rad) + step_mm, step_mm: 2.0 * step_mm };
            let crossing: Vec<[DVec2; 2]> = coarser.iter().filter(|l| l.0 != d).map(|l| l.1).collect();
            let pieces = stretched_to(&lines_in(&there, lines), angle_rad, &crossing, &clipper);
            laid.extend(pieces.into_iter().map(|piece| (d, piece)));
        }
        laid.retain(|(_, [a, b])| a.distance(*b) > SHORTEST * context.bead_width_mm);
        out.extend(laid.iter().map(path));
        coarser.append(&mut laid);
    }
}

/// How far crossing lines and hexagons move for each mm of height. Source: derived; the faces of cubes that stand on a corner
/// lean so. In layers half as high as beads are wide, a bead moves by 0.35 of its width.
const LEAN: f64 = FRAC_1_SQRT_2;

/// Hexagons lean in this direction from that of their flats, radians. Source: derived; 30 degrees from flats and from one pair
/// of ramps, square to the other pair. Along the flats themselves, double walls would stay above each other, and a cell beside
/// them would miss them in all layers.
const HONEYCOMB_LEANS_RAD: f64 = PI / 6.0;

/// A context whose raster has moved with the height.
fn leaning<'a>(context: &FillContext<'a>, towards: DVec2) -> FillContext<'a> {
    let by = LEAN * context.z_mid_mm * towards;
    let part = Bounds2 { min: context.part.min + by, max: context.part.max + by };
    FillContext { part, ..*context }
}

/// Lays hexagons whose sides grow from level to level.
fn bands(
    context: &FillContext<'_>,
    densities: &PlanDensity,
    region: &Region,
    levels: Levels,
    [least, most]: [f64; 2],
    out: &mut Vec<Toolpath>,
) {
    if region.is_empty() {
        return;
    }
    let mut rest = region.clone();
    for k in 0..=levels.coarsest(least) {
        let (density, from) = levels.at(k);
        if most < from {
            continue;
        }
        let here = if from <= least { rest.clone() } else { densities.at_least(from).intersection(&rest) };
        let context = FillContext {
            density: Density::Sparse(density),
            ..leaning(context, direction(context.angle_rad + HONEYCOMB_LEANS_RAD))
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

    fn rows(&self) -> DVec2 {
        self.field.rows()
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

/// Sets the widths of beads so that the volume in the windows around each of their points matches the density map, within the
/// printable widths. The correction of Richardson and Lucy: for lines at an even distance below the window's side it is exact.
fn fit(paths: &mut [Toolpath], context: &FillContext<'_>, all: &Windows<'_>) {
    let (h, nominal) = (context.height_mm, context.bead_width_mm);
    let narrowest_mm = narrowest_mm(nominal, context.min_bead_width_mm);
    // The windows, by the cell in their middle, where they lie and what each asks for. Every other cell suffices: they are
    // then 1 mm apart.
    let is_window = |&k: &usize| {
        let [i, j] = all.at(k);
        i.is_multiple_of(2) && j.is_multiple_of(2) && all.is_in_area(k)
    };
    let window = |k: usize| {
        let around = all.around(all.middle_mm(k));
        (k, around, all.asked.of(around))
    };
    let windows: Vec<(usize, [u32; 4], f64)> = (0..all.n_cells()).filter(is_window).map(window).collect();
    for path in &mut *paths {
        divide(path);
    }
    // Places do not change while widths are fitted, and neither do the windows around vertices.
    let places = Places::of(paths.iter(), 0.5 * all.grid.cell_mm(), &|p| all.cell_of(p));
    let vertices = paths.iter().flat_map(|path| &path.points);
    let of_vertices: Vec<[u32; 4]> = vertices.map(|p| all.around(*p)).collect();
    for _ in 0..ROUNDS {
        let mut laid = vec![0.0; all.n_cells()];
        places.each(paths.iter(), |width, piece_mm, cells| {
            let mm2 = bead_spacing_mm(width, h) * piece_mm;
            cells.iter().for_each(|cell| laid[*cell as usize] += mm2);
        });
        let laid = Sums::new(all.grid.size(), &laid);
        // The volume that each window asks for over the one that it holds, times its weight, and the weights. A window that
        // holds the tip of a line alone says little about it. Measured: over 120 plans of graded `stripes` (bracket, lever,
        // hook and plate with two holes of `cargo xtask bench density`, 30 masses each) the worst cell is off by 10.7, 9.2, 10.0
        // and 10.0 % of full with a weight of 1 and with the powers 0.5, 0.75 and 1 of what a window holds. The mean over all
        // cells is 1.2 % with each.
        let (mut short, mut weights) = (vec![0.0; all.n_cells()], vec![0.0; all.n_cells()]);
        for &(k, around, asked_mm2) in &windows {
            let laid_mm2 = laid.of(around);
            if laid_mm2 > 1e-9 {
                weights[k] = laid_mm2.sqrt();
                short[k] = weights[k] * asked_mm2 / laid_mm2;
            }
        }
        let [short, weights] = [short, weights].map(|values| Sums::new(all.grid.size(), &values));
        let mut around_vertices = of_vertices.iter();
        for path in &mut *paths {
            let own = around_vertices.by_ref().take(path.points.len());
            let BeadWidth::PerVertex(widths) = &mut path.width else { continue };
            for (around, width) in own.zip(widths) {
                let weight = weights.of(*around);
                let factor = if weight > 0.0 { short.of(*around) / weight } else { 1.0 };
                let strip = (factor * bead_spacing_mm(*width, h)).clamp(0.01, 10.0 * nominal);
                *width = bead_width_mm(strip, h).clamp(narrowest_mm, WIDEST * nominal);
            }
        }
    }
    paths.iter_mut().for_each(thinned);
}

/// A layer whose beads are fitted together with those of the layers around it.
pub(crate) struct FittedLayer<'a> {
    /// Height of the layer's middle, mm.
    pub z_mid_mm: f64,
    /// Thickness of the layer, mm.
    pub height_mm: f64,
    /// The area of its sparse infill, which is not empty.
    pub area: Region,
    /// The beads of that infill.
    pub paths: Vec<&'a mut Toolpath>,
}

impl FittedLayer<'_> {
    /// Heights of its lower and upper side, mm.
    fn sides_mm(&self) -> [f64; 2] {
        [self.z_mid_mm - 0.5 * self.height_mm, self.z_mid_mm + 0.5 * self.height_mm]
    }
}

/// Sets the widths of beads as [`fit`] does, in windows that are cubes: a cell holds its share of lines that lean over its
/// layers, not in each of them. `layers` rise from the bed. Usual beads are `nominal_mm` wide, and none may be narrower than
/// `min_bead_width_mm`.
pub(crate) fn fit_layers(
    layers: &mut [FittedLayer<'_>],
    map: &DensityMap,
    nominal_mm: f64,
    min_bead_width_mm: f64,
) {
    let bounds = layers.iter().filter_map(|l| l.area.bounds()).reduce(|a, b| a.union(b));
    let (Some(bounds), [first, .., last] | [first @ last]) = (bounds, &*layers) else { return };
    let [bottom, top] = [first.sides_mm()[0], last.z_mid_mm];
    let size = bounds.size().extend(top - bottom).to_array();
    let divided = |across: usize| {
        let cell_mm = WINDOW_MM / across as f64;
        (across / 2, cell_mm, size.map(|mm| (mm / cell_mm) as usize + 1))
    };
    let is_few =
        |(_, _, n): &(usize, f64, [usize; 3])| n.iter().map(|n| *n as f64).product::<f64>() <= MOST_CELLS;
    let (half, cell_mm, n) =
        [CELLS_ACROSS, 3].map(divided).into_iter().find(is_few).unwrap_or_else(|| divided(1));
    let in_slab = n[0] * n[1];
    let slab = |l: &FittedLayer<'_>| (((l.z_mid_mm - bottom) / cell_mm) as usize).min(n[2] - 1);
    let place = |p: DVec2| {
        let q = (p - bounds.min).max(DVec2::ZERO) / cell_mm;
        (q.y as usize).min(n[1] - 1) * n[0] + (q.x as usize).min(n[0] - 1)
    };
    let narrowest_mm = narrowest_mm(nominal_mm, min_bead_width_mm);
    layers.par_iter_mut().for_each(|l| l.paths.iter_mut().for_each(|path| divide(path)));
    // Sums a value of each layer over the cells of its slab. What is added is told the index of the slab's first layer.
    let summed = |layers: &[FittedLayer<'_>], add: &AddLayers<'_>| {
        let mut sums = vec![0.0f32; in_slab * n[2]];
        let mut slabs: Vec<Option<&mut [f32]>> = sums.chunks_mut(in_slab).map(Some).collect();
        let mut next = 0;
        let own = layers.chunk_by(|a, b| slab(a) == slab(b)).filter_map(|own| {
            let first = next;
            next += own.len();
            Some((own, first, slabs[slab(&own[0])].take()?))
        });
        own.collect::<Vec<_>>().into_par_iter().for_each(|(layers, first, sums)| add(layers, first, sums));
        sums
    };
    // The volume that each cell asks for.
    let asked = summed(layers, &|layers, _, asked| {
        for layer in layers {
            let Some(bounds) = layer.area.bounds() else { continue };
            let grid = MaskGrid::over(bounds, 0.5);
            let mask = Mask::from_region(grid, &layer.area);
            let ([nx, ny], square_mm) = (grid.size(), grid.cell_mm());
            let mm3 = (square_mm * square_mm * layer.height_mm) as f32;
            for (x, y) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))).filter(|&(x, y)| mask.get(x, y))
            {
                let p = grid.origin() + square_mm * DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                asked[place(p)] += mm3;
            }
        }
        let z_mm = 0.5 * (layers[0].sides_mm()[0] + layers[layers.len() - 1].sides_mm()[1]);
        for (k, asked) in asked.iter_mut().enumerate().filter(|(_, asked)| **asked > 0.0) {
            let middle = DVec2::new((k % n[0]) as f64 + 0.5, (k / n[0]) as f64 + 0.5);
            *asked *= map.at((bounds.min + cell_mm * middle).extend(z_mm)) as f32;
        }
    });
    let in_area: Vec<bool> = asked.iter().map(|asked| *asked > 0.0).collect();
    let asked = in_windows(asked, n, half);
    // Beads stay where they are while their widths are fitted.
    let places: Vec<Places> = layers
        .par_iter()
        .map(|l| Places::of(l.paths.iter().map(|path| &**path), 0.5 * cell_mm, &place))
        .collect();
    // The windows that hold any volume are the same in nearly all rounds.
    let (mut holds, mut counted) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let laid = summed(layers, &|layers, first, laid| {
            for (layer, places) in layers.iter().zip(&places[first..]) {
                let h = layer.height_mm;
                places.each(layer.paths.iter().map(|path| &**path), |width, piece_mm, cells| {
                    let mm3 = (bead_spacing_mm(width, h) * h * piece_mm) as f32;
                    cells.iter().for_each(|cell| laid[*cell as usize] += mm3);
                });
            }
        });
        let laid = in_windows(laid, n, half);
        // The volume that each window asks for over the one that it holds, where it holds any.
        let ratio = |k: usize| if in_area[k] && laid[k] > 1e-6 { asked[k] / laid[k] } else { 0.0 };
        let short: Vec<f32> = (0..laid.len()).map(ratio).collect();
        // A window that holds nothing has no ratio, and is left out of the means.
        let holds_any: Vec<bool> = short.iter().map(|ratio| *ratio > 0.0).collect();
        if holds != holds_any {
            counted =
                in_windows(holds_any.iter().map(|holds| if *holds { 1.0 } else { 0.0 }).collect(), n, half);
            holds = holds_any;
        }
        let short = in_windows(short, n, half);
        layers.par_iter_mut().zip(&places).for_each(|(layer, places)| {
            let (first, h) = (slab(layer) * in_slab, layer.height_mm);
            let strip_mm = bead_spacing_mm(nominal_mm, h);
            let mut vertices = &places.vertices[..];
            for path in &mut layer.paths {
                let own;
                (own, vertices) = vertices.split_at(path.points.len());
                let BeadWidth::PerVertex(widths) = &mut path.width else { continue };
                for (cell, width) in own.iter().zip(widths) {
                    let k = first + *cell as usize;
                    let factor = if counted[k] > 0.5 { f64::from(short[k] / counted[k]) } else { 1.0 };
                    let strip = (factor * bead_spacing_mm(*width, h)).clamp(0.01 * strip_mm, 10.0 * strip_mm);
                    *width = bead_width_mm(strip, h).clamp(narrowest_mm, WIDEST * nominal_mm);
                }
            }
        });
    }
    layers.par_iter_mut().for_each(|l| l.paths.iter_mut().for_each(|path| thinned(path)));
}

/// Adds what layers of one slab hold to its cells; the number is the index of the first of them.
type AddLayers<'a> = dyn Fn(&[FittedLayer<'_>], usize, &mut [f32]) + Sync + 'a;

/// The cells of a grid that beads lie in.
struct Places {
    /// Length of the pieces of each segment of each bead, mm, and the number of pieces.
    segments: Vec<(f64, u32)>,
    /// The cell of the middle of each piece.
    pieces: Vec<u32>,
    /// The cell of each vertex.
    vertices: Vec<u32>,
}

/// The segments of beads, one after the other.
fn segments_of<'a>(paths: impl Iterator<Item = &'a Toolpath>) -> impl Iterator<Item = (DVec2, DVec2, f64)> {
    paths.flat_map(|path| (0..path.n_segments()).map(|k| path.segment(k)))
}

impl Places {
    /// The cells of beads; a piece is at most `piece_mm` long, and `place` tells the cell of a point.
    fn of<'a>(
        paths: impl Iterator<Item = &'a Toolpath> + Clone,
        piece_mm: f64,
        place: &dyn Fn(DVec2) -> usize,
    ) -> Self {
        let (mut segments, mut pieces) = (Vec::new(), Vec::new());
        for (a, b, _) in segments_of(paths.clone()) {
            let (length_mm, middles) = density_windows::pieces(a, b, piece_mm);
            segments.push((length_mm, middles.len() as u32));
            pieces.extend(middles.map(|p| place(p) as u32));
        }
        let vertices = paths.flat_map(|path| &path.points).map(|p| place(*p) as u32).collect();
        Self { segments, pieces, vertices }
    }

    /// Calls `add` with the width of each segment of the same beads, the length of its pieces, mm, and their cells.
    fn each<'a>(&self, paths: impl Iterator<Item = &'a Toolpath>, mut add: impl FnMut(f64, f64, &[u32])) {
        let mut rest = &self.pieces[..];
        // Pieces stand in the order of the segments, each with the number that belongs to it.
        for ((.., width), (piece_mm, n)) in segments_of(paths).zip(&self.segments) {
            let (own, others) = rest.split_at(*n as usize);
            add(width, *piece_mm, own);
            rest = others;
        }
    }
}

/// For each cell of a grid of `n` cells the sum over the cube that reaches `half` cells to each side of it.
fn in_windows(mut values: Vec<f32>, n: [usize; 3], half: usize) -> Vec<f32> {
    let in_slab = n[0] * n[1];
    // The sums along a line of `n` cells that are `step` apart.
    let along = |from: &[f32], to: &mut [f32], first: usize, step: usize, n: usize| {
        let mut sum = 0.0;
        for i in 0..n + half {
            if i < n {
                sum += f64::from(from[first + i * step]);
            }
            if let Some(left) = i.checked_sub(2 * half + 1) {
                sum -= f64::from(from[first + left * step]);
            }
            if let Some(middle) = i.checked_sub(half) {
                to[first + middle * step] = sum as f32;
            }
        }
    };
    values.par_chunks_mut(in_slab).for_each(|own| {
        let mut rows = vec![0.0; in_slab];
        (0..n[1]).for_each(|y| along(own, &mut rows, y * n[0], 1, n[0]));
        (0..n[0]).for_each(|x| along(&rows, own, x, n[0], n[1]));
    });
    let mut sums = vec![0.0; values.len()];
    sums.par_chunks_mut(in_slab).enumerate().for_each(|(k, sums)| {
        for own in (k.saturating_sub(half)..(k + half + 1).min(n[2])).map(|k| &values[k * in_slab..]) {
            sums.iter_mut().zip(own).for_each(|(sum, value)| *sum += value);
        }
    });
    sums
}

/// Takes out vertices at which neither the direction nor the width of a path changes.
fn thinned(path: &mut Toolpath) {
    if let BeadWidth::PerVertex(widths) = &path.width {
        let (points, widths) = simplified(&path.points, widths, path.closed);
        (path.points, path.width) = (points, BeadWidth::PerVertex(widths));
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

    use crate::fill::LinesBelow;

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
            below: None,
            fills_wedges: true,
            widths: BeadWidths::Variable,
            field: Some(&FIELD),
        }
    }

    const LAYER_MM: f64 = 0.3;

    /// The area of sparse infill of a part at a height, inside its walls: a block of 40 x 30 mm, the block turned, or a cone with
    /// a bore beside its axis.
    fn area_of(part: &str, z_mm: f64) -> Region {
        let middle = DVec2::new(20.0, 15.0);
        let circle = |at: DVec2, r: f64, n: usize| {
            let outer = (0..n).map(|i| at + r * direction(i as f64 / n as f64 * 2.0 * PI)).collect();
            Region::from(Polygon { outer, holes: Vec::new() })
        };
        let mut block = Region::rectangle(DVec2::splat(1.2), DVec2::new(38.8, 28.8));
        match part {
            "block" => block,
            "turned block" => {
                let turn = |p: &mut DVec2| *p = middle + rotated(*p - middle, direction(37f64.to_radians()));
                block.polygons[0].outer.iter_mut().for_each(turn);
                block
            }
            _ => {
                let bore = circle(middle + DVec2::new(4.0, 0.0), 5.0, 40);
                circle(middle, 19.0 - 0.35 * z_mm, 90).difference(&bore)
            }
        }
    }

    /// Maps of density over parts of this height, after the limit of their slope.
    fn maps(high_mm: f64) -> Vec<(&'static str, DensityMap)> {
        let of = |at: &dyn Fn(DVec3) -> f64| {
            let (low, high) = (DVec3::new(-5.0, -12.0, 0.0), DVec3::new(45.0, 42.0, high_mm));
            let mut map = DensityMap::new(low, high, 1.0, false, at);
            map.limit(bead_spacing_mm(0.45, LAYER_MM));
            map
        };
        let share = |v: f64, max: f64| 0.1 + (max - 0.1) * v.clamp(0.0, 1.0);
        let wave = |mm: f64| grainpath_core::math::sin(mm * 2.0 * PI / 20.0);
        let squares = |side: f64, p: DVec3| ((p.x / side).floor() + (p.y / side).floor()) % 2.0 == 0.0;
        vec![
            ("even 0.15", of(&|_| 0.15)),
            ("even 0.19", of(&|_| 0.19)),
            ("ramp along x", of(&|p| share(p.x / 40.0, 0.9))),
            ("ramp along y", of(&|p| share(p.y / 30.0, 0.7))),
            ("ramp upwards", of(&|p| share(p.z / high_mm, 0.6))),
            ("ramp downwards", of(&|p| share(1.0 - p.z / high_mm, 0.6))),
            ("radial", of(&|p| share(1.0 - p.truncate().distance(DVec2::new(20.0, 15.0)) / 20.0, 0.8))),
            ("bumps", of(&|p| share(0.5 + 0.5 * wave(p.x) * wave(p.y) * wave(p.z + 5.0), 0.5))),
            // The stress of a block that is held at x = 0 and bent at its other end.
            ("bent", of(&|p| share((1.0 - p.x / 40.0) * (2.0 * p.z / high_mm - 1.0).abs(), 0.8))),
            ("step", of(&|p| if p.x < 18.0 { 0.15 } else { 0.7 })),
            ("squares of 10 mm", of(&|p| if squares(10.0, p) { 0.9 } else { 0.1 })),
            ("squares of 5 mm", of(&|p| if squares(5.0, p) { 0.9 } else { 0.1 })),
        ]
    }

    /// Lays the layers of a part between skins of 0.9 mm, and measures its cells.
    fn laid(pattern: Pattern, map: &DensityMap, part: &str, angle_rad: f64, high_mm: f64) -> LaidDensity {
        let z_mm = |i: usize| LAYER_MM * (i + 1) as f64;
        let n = ((high_mm - 0.8) / LAYER_MM) as usize;
        let layer = |i: usize| Layer::new(z_mm(i), LAYER_MM, area_of(part, z_mm(i))).expect("a layer");
        let stack = LayerStack::new((0..n).map(layer).collect()).expect("heights rise");
        let areas: Vec<Region> = (0..n)
            .map(|i| if i < 3 { Region::default() } else { stack.layers()[i].region().clone() })
            .collect();
        let bounds = areas.iter().filter_map(|a| a.bounds()).reduce(|a, b| a.union(b)).expect("an area");
        let border_mm = 0.5 * bead_spacing_mm(0.45, LAYER_MM);
        let mut below: Option<LinesBelow> = None;
        let mut layers: Vec<LayerPaths> = Vec::new();
        for (i, area) in areas.iter().enumerate() {
            let mut fills = Vec::new();
            let turned = pattern == Pattern::Rectilinear && i % 2 == 1;
            let context = FillContext {
                height_mm: LAYER_MM,
                border_mm,
                angle_rad: angle_rad + if turned { FRAC_PI_2 } else { 0.0 },
                part: bounds,
                below: below.as_ref(),
                ..context(z_mm(i) - 0.5 * LAYER_MM)
            };
            for polygon in &area.offset(-border_mm, Join::Miter(2.0)).polygons {
                if pattern == Pattern::Continuous {
                    let (first, mut notes) = (fills.len(), Vec::new());
                    one_path(&Continuous::FOR_TESTS, &context, map, &[polygon], &mut fills, &mut notes);
                    assert!(fills.len() == first + 1 && fills[first].closed && notes.is_empty(), "{notes:?}");
                } else {
                    fill(pattern, &context, map, polygon, &mut fills);
                }
            }
            below = Some(LinesBelow::new(fills.iter(), fills.iter(), 0.45));
            let islands = vec![Island { walls: Vec::new(), fills }];
            layers.push(LayerPaths { islands, ..LayerPaths::default() });
        }
        if leans(pattern) {
            let mut all = Vec::new();
            for (i, paths) in layers.iter_mut().enumerate().filter(|(i, _)| !areas[*i].is_empty()) {
                all.push(FittedLayer {
                    z_mid_mm: z_mm(i) - 0.5 * LAYER_MM,
                    height_mm: LAYER_MM,
                    area: areas[i].clone(),
                    paths: paths.islands[0].fills.iter_mut().collect(),
                });
            }
            fit_layers(&mut all, map, 0.45, 0.2);
        }
        for path in layers.iter().flat_map(|l| &l.islands[0].fills) {
            let mut widths = (0..path.points.len()).map(|k| path.width_at(k));
            assert!(widths.all(|mm| (0.6 * 0.45 - 1e-9..=1.6 * 0.45 + 1e-9).contains(&mm)), "{path:?}");
        }
        let asked = AskedDensity {
            map,
            range: [0.1, 0.9],
            by: DensityBy::Stress,
            fall_mm: 0.0,
            areas: &areas,
            beside_others: false,
        };
        LaidDensity::measure(&asked, &stack, &layers)
    }

    #[test]
    fn every_pattern_lays_the_density_of_each_cell() {
        // Lines that do not lean lie alike at all heights, and a part half as high holds their cells too.
        let (high, low) = (maps(20.0), maps(10.0));
        let placed = [("block", 0.0), ("turned block", 0.0), ("cone", 0.0), ("block", 0.5 * FRAC_PI_2)];
        let mut cases = Vec::new();
        for m in 0..high.len() {
            for pattern in [Pattern::Grid, Pattern::Triangles, Pattern::Honeycomb, Pattern::Rectilinear] {
                let n = if leans(pattern) && m % 2 == 0 { 2 } else { 1 };
                cases.extend((0..n).map(|k| (pattern, m, placed[(m + k) % 4])));
            }
            // Both patterns along a field are laid by the same routine.
            let along = if m % 4 < 2 { Pattern::Stripes } else { Pattern::Streamlines };
            let slow = if m % 2 == 0 { [Pattern::Gyroid, along] } else { [Pattern::Continuous, along] };
            cases.extend(slow.map(|pattern| (pattern, m, placed[(m / 2) % 3])));
        }
        let measured = |&(pattern, m, (part, angle_rad)): &(Pattern, usize, (&'static str, f64))| {
            let (high_mm, (name, map)) = if leans(pattern) { (20.0, &high[m]) } else { (10.0, &low[m]) };
            let found = laid(pattern, map, part, angle_rad, high_mm);
            let row = format!(
                "{} {name}, {part} at {angle_rad:.1}: mean {:.4}, worst {:.4} of {} cells at {:?}",
                pattern.name(),
                found.mean_error,
                found.worst_error,
                found.cells,
                found.worst_at_mm
            );
            (row, found.mean_error > 0.03 || found.worst_error > 0.1)
        };
        let rows: Vec<(String, bool)> = cases.par_iter().map(measured).collect();
        rows.iter().for_each(|row| println!("{}", row.0));
        let wrong: Vec<&str> = rows.iter().filter(|row| row.1).map(|row| row.0.as_str()).collect();
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
                if leans(pattern) {
                    let area = Region::from(region.clone());
                    let paths = paths.iter_mut().collect();
                    let layer = FittedLayer { z_mid_mm: 0.1, height_mm: 0.2, area, paths };
                    fit_layers(&mut [layer], &map, 0.45, allowed_mm);
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
        assert_eq!(Levels::of(Pattern::Rectilinear, &context).coarsest(0.1), 3);
    }
}
