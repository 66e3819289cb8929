//! Graded density: how much material each place of the part gets.
//!
//! With `by = "stress"` the part is *fully stressed*: within a range the density is proportional to the
//! share of the material's strength that the stress takes, so every place has the same reserve. This share
//! is the larger of two failure indices: that of beads along the larger principal stress
//! ([`StrengthCard::index`]), and that between layers. The largest of all load cases counts. Places where
//! fixtures and loads act are left out when the stress that gets the greatest density is determined. With
//! `by = "file"` the densities come from another program.
//!
//! Densities are stored on a grid of nodes and interpolated linearly. The distance between lines, spacing
//! over density, grows by at most `STEEPEST` for each millimetre, so that the patterns can follow; where it
//! would grow faster, the surroundings get more material. A job that asks for a mass scales the densities
//! before both limits are applied.
//!
//! Units: mm and MPa. Cost: linear in the nodes, at most about `MOST_NODES`, times the number of masses tried.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use grainpath_core::isolines::isolines;
use grainpath_core::mask::{Mask, MaskGrid};
use grainpath_core::poly::{FillRule, Join};
use grainpath_core::{Bounds2, DMat3, DVec2, DVec3, Diagnostics, LayerStack, Region, WarningId, math};
use grainpath_fea::principal::plane_principal;
use grainpath_fea::strength::card::StrengthCard;
use grainpath_io::directions::DensitySamples;
use grainpath_job::choices::DensityBy;
use rayon::prelude::*;

use super::Guide;
use super::given_field::{FieldSettings, to_file};

/// The distance between lines grows by at most this much for each mm. Source: derived. Over one distance it
/// then grows by half, so two sparse lines face three dense ones. With faster growth, lines end before they
/// have a neighbour of their own density.
const STEEPEST: f64 = 0.5;
/// Distance between the nodes, mm; in large parts it is larger. Source: derived: a fifth of the cells of 5
/// mm over which densities are measured.
const NODES_MM: f64 = 1.0;
/// Approximate upper limit of the number of nodes. Source: derived: a density for a given mass takes some
/// 20 passes over all nodes with 26 neighbours each; with this number of nodes that takes about 2 s.
const MOST_NODES: f64 = 300_000.0;
/// The greatest density belongs to a stress that this share of the part does not exceed. Source: derived.
/// Stress peaks at corners and contacts grow with a finer mesh, and 2 % of the part contain them.
const FULL_SHARE: f64 = 0.98;
/// A part may reach this many mean distances of samples beyond them without a warning. Source: derived: samples in the
/// middle of cells leave half a cell at the border, and half as much again for samples that are not even.
const UNCOVERED_CELLS: f64 = 0.75;
/// And at most this share of its longest extent. Source: chosen; that is half a cell of a grid of ten.
const UNCOVERED_REACH: f64 = 0.05;
/// Share of the part that may lie further beyond the samples without a warning. Source: chosen; a rim of 1 % changes the
/// mass by less than the error of a graded density.
const UNCOVERED_SHARE: f64 = 0.01;
/// Distance from the part, in cells of the nodes, up to which stress is evaluated. Source: derived: a point of the part lies
/// within the diagonal of a cell, 1.41, of the nodes that it is interpolated from.
const CELL_DIAGONAL: f64 = 1.5;
/// Reach of the mean that smooths the stress, in nodes. Source: derived: about two beads to either
/// side, with nodes of 1 mm.
const SMOOTHED: usize = 1;

/// Why a graded density cannot be laid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum DensityError {
    #[error(
        "the densities lie from ({:.2}, {:.2}, {:.2}) to ({:.2}, {:.2}, {:.2}) mm and the part from ({:.2}, {:.2}, {:.2}) to \
         ({:.2}, {:.2}, {:.2}); they should be in the coordinates of the part's file, in mm",
        file[0].x, file[0].y, file[0].z, file[1].x, file[1].y, file[1].z, part[0].x, part[0].y, part[0].z, part[1].x, part[1].y,
        part[1].z
    )]
    Elsewhere { file: [DVec3; 2], part: [DVec3; 2] },
    #[error(
        "the densities of the file cover no place of the part: they lie {}; give densities for the whole part, or one number as \
         fill.density",
        extent_text(file)
    )]
    Nowhere { file: [DVec3; 2] },
    #[error("fill.density by = \"file\" is for parts from meshes and outlines")]
    NoFile,
    #[error("by = \"stress\": the stress is zero everywhere")]
    NoStress,
}

/// Where samples lie, for messages.
fn extent_text([low, high]: &[DVec3; 2]) -> String {
    let text = |p: &DVec3| format!("({:.2}, {:.2}, {:.2})", p.x, p.y, p.z);
    if low == high {
        format!("at {} mm alone", text(low))
    } else {
        format!("from {} to {} mm", text(low), text(high))
    }
}

/// Settings from which a graded density is made.
#[derive(Debug, Clone, PartialEq)]
pub struct DensitySettings {
    /// The least and the greatest density.
    pub range: [f64; 2],
    /// What the density follows: the stress or a file.
    pub by: DensityBy,
    /// Distance between the centrelines of beads that touch, mm.
    pub spacing_mm: f64,
    /// Strengths of the material. Without them the equivalent stress decides.
    pub card: Option<StrengthCard>,
    /// How the file's coordinates relate to the part.
    pub place: FieldSettings,
}

/// Densities at the nodes of a regular grid.
#[derive(Debug, Clone, PartialEq)]
pub struct DensityMap {
    low: DVec3,
    cell_mm: DVec3,
    n: [usize; 3],
    values: Vec<f32>,
    /// The values before the growth of the distance between lines was limited; empty where it was not.
    given: Vec<f32>,
    plans: Plans,
}

/// The last plans of a map that is the same at all heights: the layers of a plate ask for the same ones. A copy of a map
/// begins without plans, and maps with the same values are equal whatever plans they hold.
#[derive(Debug, Default)]
struct Plans(Mutex<VecDeque<(Bounds2, Arc<PlanDensity>)>>);

impl Clone for Plans {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for Plans {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Most plans that a map keeps. Source: chosen; a plan has at most 5 MB, and the layers of a plate ask for those of its islands.
const MOST_PLANS: usize = 4;

impl DensityMap {
    /// A map over a box; `at` gives the density of each node. A `flat` map has a single layer of nodes.
    pub fn new(low: DVec3, high: DVec3, cell_mm: f64, flat: bool, at: impl Fn(DVec3) -> f64) -> Self {
        let size = high - low;
        let count = |mm: f64| (mm / cell_mm).ceil().max(1.0) as usize + 1;
        let n = [count(size.x), count(size.y), if flat { 1 } else { count(size.z) }];
        let step = |k: usize| if n[k] > 1 { size[k].max(1e-6) / (n[k] - 1) as f64 } else { 1.0 };
        let mut map = Self {
            low,
            cell_mm: DVec3::new(step(0), step(1), step(2)),
            n,
            values: Vec::new(),
            given: Vec::new(),
            plans: Plans::default(),
        };
        map.values = (0..n[0] * n[1] * n[2]).map(|i| at(map.node(i)) as f32).collect();
        map
    }

    fn node(&self, i: usize) -> DVec3 {
        let [nx, ny, _] = self.n;
        let at = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / (nx * ny)) as f64);
        self.low + at * self.cell_mm
    }

    /// The density at a point. Outside the grid it is that of the nearest point of the grid.
    pub fn at(&self, p: DVec3) -> f64 {
        self.interpolated(&self.values, p)
    }

    /// The density at a point before the growth of the distance between lines was limited.
    pub(crate) fn given_at(&self, p: DVec3) -> f64 {
        self.interpolated(if self.given.is_empty() { &self.values } else { &self.given }, p)
    }

    fn interpolated(&self, values: &[f32], p: DVec3) -> f64 {
        let q = (p - self.low) / self.cell_mm;
        let axis = |k: usize| {
            let v = q[k].clamp(0.0, (self.n[k] - 1) as f64);
            let i = (v as usize).min(self.n[k].saturating_sub(2));
            (i, (i + 1).min(self.n[k] - 1), v - i as f64)
        };
        let ([x, y, z], [nx, ny, _]) = ([axis(0), axis(1), axis(2)], self.n);
        let between = |a: f64, b: f64, share: f64| a + share * (b - a);
        let row = |j: usize, k: usize| {
            let row = &values[(k * ny + j) * nx..];
            between(f64::from(row[x.0]), f64::from(row[x.1]), x.2)
        };
        let plane = |k: usize| between(row(y.0, k), row(y.1, k), y.2);
        // Most maps have one layer of nodes.
        if self.is_upright() { plane(0) } else { between(plane(z.0), plane(z.1), z.2) }
    }

    /// Whether the densities are the same at all heights.
    pub fn is_upright(&self) -> bool {
        self.n[2] == 1
    }

    /// The least and the greatest density within a box of the plan, at height `z_mm`.
    pub(crate) fn range_in(&self, bounds: Bounds2, z_mm: f64) -> [f64; 2] {
        let step = self.cell_mm.x.min(self.cell_mm.y);
        let size = bounds.size();
        let [nx, ny] = [size.x, size.y].map(|mm| (mm / step).ceil().max(1.0) as usize);
        let mut range = [f64::INFINITY, 0.0f64];
        for j in 0..=ny {
            for i in 0..=nx {
                let share = DVec2::new(i as f64 / nx as f64, j as f64 / ny as f64);
                let density = self.at((bounds.min + share * size).extend(z_mm));
                range = [range[0].min(density), range[1].max(density)];
            }
        }
        range
    }

    /// The region in which the density is at least `density`, at height `z_mm` and within `bounds`.
    pub(crate) fn at_least(&self, density: f64, bounds: Bounds2, z_mm: f64) -> Region {
        self.in_plan(bounds, z_mm).at_least(density)
    }

    /// The densities at height `z_mm` within `bounds`, for the regions of several densities.
    pub(crate) fn in_plan(&self, bounds: Bounds2, z_mm: f64) -> Arc<PlanDensity> {
        if !self.is_upright() {
            return Arc::new(self.new_plan(bounds, z_mm));
        }
        let kept = || self.plans.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, plan)) = kept().iter().find(|(of, _)| *of == bounds) {
            return plan.clone();
        }
        // Layers that ask at the same time each make the plan; all are alike.
        let plan = Arc::new(self.new_plan(bounds, z_mm));
        let mut kept = kept();
        kept.push_back((bounds, plan.clone()));
        if kept.len() > MOST_PLANS {
            kept.pop_front();
        }
        plan
    }

    fn new_plan(&self, bounds: Bounds2, z_mm: f64) -> PlanDensity {
        // Around the bounds lies a margin of lower density, so that every contour is closed.
        let bounds = bounds.grown(2.0);
        let size = bounds.size();
        // Half a millimetre is finer than any distance between lines at which levels change.
        let cell_mm = 0.5f64.max((size.x * size.y / MOST_NODES).sqrt());
        let n = [size.x, size.y].map(|mm| (mm / cell_mm).ceil() as usize + 1);
        let [nx, ny] = n;
        let value = |k: usize| {
            let (i, j) = (k % nx, k / nx);
            let is_inner = i > 0 && j > 0 && i + 1 < nx && j + 1 < ny;
            let p = bounds.min + cell_mm * DVec2::new(i as f64, j as f64);
            is_inner.then(|| self.at(p.extend(z_mm)))
        };
        let values = (0..nx * ny).map(value).collect();
        PlanDensity { low: bounds.min, cell_mm, n, values, regions: Mutex::new(Vec::new()) }
    }

    /// Limits the growth of the distance between lines to `STEEPEST`, by raising the density where it is exceeded.
    pub(crate) fn limit(&mut self, spacing_mm: f64) {
        self.plans = Plans::default();
        self.given = self.values.clone();
        let [nx, ny, nz] = self.n;
        let mut far: Vec<f64> = self.values.iter().map(|v| spacing_mm / f64::from(*v)).collect();
        // The neighbours that come before a node in the grid's order, and the allowed growth to each of them.
        let mut before = Vec::new();
        for (dz, dy, dx) in
            (-1..=0).flat_map(|z| (-1..=1).flat_map(move |y| (-1..=1).map(move |x| (z, y, x))))
        {
            // A map that is the same at all heights has no nodes below.
            if (dz, dy, dx) < (0, 0, 0) && (dz == 0 || nz > 1) {
                let mm = (DVec3::new(f64::from(dx), f64::from(dy), f64::from(dz)) * self.cell_mm).length();
                before.push(([dx as isize, dy as isize, dz as isize], STEEPEST * mm));
            }
        }
        let mut pass = |forwards: bool| {
            let all = nx * ny * nz;
            for k in 0..all {
                let i = if forwards { k } else { all - 1 - k };
                let at = [i % nx, i / nx % ny, i / (nx * ny)].map(|v| v as isize);
                for (d, grown) in &before {
                    let sign = if forwards { 1 } else { -1 };
                    let to = [0, 1, 2].map(|k| at[k] + sign * d[k]);
                    if (0..3).all(|k| (0..self.n[k] as isize).contains(&to[k])) {
                        let j = (to[2] as usize * ny + to[1] as usize) * nx + to[0] as usize;
                        far[i] = far[i].min(far[j] + grown);
                    }
                }
            }
        };
        // The sweep goes there and back twice, because a value that has to go around a corner needs the second time.
        (0..4).for_each(|k| pass(k % 2 == 0));
        self.values.iter_mut().zip(far).for_each(|(v, far)| *v = (spacing_mm / far) as f32);
    }
}

/// Densities at one height of a map.
#[derive(Debug)]
pub(crate) struct PlanDensity {
    low: DVec2,
    cell_mm: f64,
    n: [usize; 2],
    /// Densities at the nodes; `None` at those of the border.
    values: Vec<Option<f64>>,
    /// The regions that were asked for, each with its least density.
    regions: Mutex<Vec<(f64, Region)>>,
}

impl PlanDensity {
    /// The region in which the density is at least `density`.
    pub(crate) fn at_least(&self, density: f64) -> Region {
        let kept = || self.regions.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, region)) = kept().iter().find(|(least, _)| *least == density) {
            return region.clone();
        }
        let region = self.new_region(density);
        kept().push((density, region.clone()));
        region
    }

    fn new_region(&self, density: f64) -> Region {
        let off = |value: &Option<f64>| value.map_or(-1.0, |value| (value - density) as f32);
        let values: Vec<f32> = self.values.iter().map(off).collect();
        let lines = isolines(self.n, self.low, self.cell_mm, &values);
        let lines: Vec<_> = lines.into_iter().map(|line| line.points).collect();
        Region::from_contours(&lines, FillRule::NonZero).simplified(0.02)
    }
}

/// The density of a part, which varies from place to place.
pub struct GradedDensity {
    /// The wanted densities before scaling and limits.
    wanted: DensityMap,
    /// Whether each node lies in the part.
    inside: Vec<bool>,
    range: [f64; 2],
    spacing_mm: f64,
    by: DensityBy,
    /// The mean density of the map without scaling, which holds if the job asks for no mass.
    pub mean: f64,
    /// The maps made so far, each with its mean density.
    made: Mutex<Vec<(f64, Arc<DensityMap>)>>,
}

impl GradedDensity {
    /// The density of a part, from the stress of its guide or from the samples of a file.
    ///
    /// # Errors
    /// [`DensityError`] if samples lie away from the part, or if the stress is zero.
    pub fn new(
        settings: &DensitySettings,
        stack: &LayerStack,
        guide: Option<&Guide>,
        samples: Option<DensitySamples>,
        diagnostics: &Diagnostics,
    ) -> Result<Self, DensityError> {
        let grid = Nodes::over(stack);
        let [min, max] = settings.range;
        let (mut wanted, inside) = match (settings.by, guide, samples) {
            (DensityBy::File, _, Some(mut samples)) => {
                let (_, to_file, shift) = to_file(&settings.place);
                let flat = samples.is_plane() && to_file.z_axis.truncate() == DVec2::ZERO;
                lay(&mut samples, to_file, shift, [grid.low, grid.high])?;
                samples.warnings().iter().for_each(|w| diagnostics.push(w.clone()));
                let map = grid.map(flat, &|p| samples.at(to_file * (p + shift)));
                let inside = inside(&map, stack, 0.0);
                let nodes = (0..inside.len()).filter(|&i| inside[i]).map(|i| to_file * (map.node(i) + shift));
                check_cover(&samples, nodes, (grid.high - grid.low).max_element(), diagnostics)?;
                (map, inside)
            }
            (DensityBy::Stress, Some(guide), _) => {
                let (mut map, inside) = share_taken(&grid, guide, settings.card.as_ref())?;
                map.values.iter_mut().for_each(|v| *v *= max as f32);
                (map, inside)
            }
            // The job's reader refuses a density by stress if there is no guide.
            (DensityBy::File, _, None) | (DensityBy::Stress, None, _) => return Err(DensityError::NoFile),
        };
        // A zero would stay zero at any scale, so values have a small lower limit.
        wanted.values.iter_mut().for_each(|v| *v = v.max(1e-6));
        let (range, spacing_mm, by) = (settings.range, settings.spacing_mm, settings.by);
        let mut graded =
            Self { wanted, inside, range, spacing_mm, by, mean: min, made: Mutex::new(Vec::new()) };
        let map = graded.scaled(1.0);
        graded.mean = graded.mean_of(&map);
        graded.made = Mutex::new(vec![(graded.mean, Arc::new(map))]);
        Ok(graded)
    }

    /// The least and the greatest density.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// What the density follows: the stress or a file.
    pub fn by(&self) -> DensityBy {
        self.by
    }

    /// The distance over which the density can fall from its greatest to its least value, mm: over less, the places around
    /// dense ones get more material than they ask for.
    pub fn fall_mm(&self) -> f64 {
        self.spacing_mm * (1.0 / self.range[0] - 1.0 / self.range[1]) / STEEPEST
    }

    /// Whether the density is the same at all heights.
    pub fn is_upright(&self) -> bool {
        self.wanted.is_upright()
    }

    /// The densities with this mean over the part, or with the nearest mean that the range allows.
    pub(crate) fn of_mean(&self, mean: f64) -> Arc<DensityMap> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, map)) = made.iter().find(|m| m.0 == mean) {
            return map.clone();
        }
        // The mean grows with the scale. At the lower end of the bisection all nodes have the least density,
        // at the upper end the greatest.
        let within = || self.wanted.values.iter().zip(&self.inside).filter(|v| *v.1).map(|v| *v.0);
        let least = within().fold(f32::INFINITY, f32::min);
        let most = within().fold(0.0, f32::max);
        if most <= 0.0 {
            // No node lies in a part that is thinner than a cell.
            return Arc::new(self.scaled(1.0));
        }
        let (mut low, mut high) =
            (0.5 * self.range[0] / f64::from(most), 2.0 * self.range[1] / f64::from(least).max(1e-4));
        let mut map = self.scaled((low * high).sqrt());
        for _ in 0..24 {
            let middle = (low * high).sqrt();
            map = self.scaled(middle);
            let found = self.mean_of(&map);
            if (found - mean).abs() < 2e-4 {
                break;
            }
            if found < mean { low = middle } else { high = middle }
        }
        let map = Arc::new(map);
        made.push((mean, map.clone()));
        map
    }

    fn scaled(&self, scale: f64) -> DensityMap {
        let [min, max] = self.range;
        let mut map = self.wanted.clone();
        map.values.iter_mut().for_each(|v| *v = (scale * f64::from(*v)).clamp(min, max) as f32);
        map.limit(self.spacing_mm);
        map
    }

    /// The mean density over the part.
    pub(crate) fn mean_of(&self, map: &DensityMap) -> f64 {
        let all = map.values.iter().zip(&self.inside).filter(|v| *v.1);
        let (sum, n) = all.fold((0.0, 0.0), |(sum, n), (v, _)| (sum + f64::from(*v), n + 1.0));
        if n > 0.0 { sum / n } else { self.range[0] }
    }
}

/// The grid of nodes over a part.
struct Nodes<'a> {
    stack: &'a LayerStack,
    low: DVec3,
    high: DVec3,
    cell_mm: f64,
}

impl<'a> Nodes<'a> {
    fn over(stack: &'a LayerStack) -> Self {
        let layers = stack.layers();
        let bounds = layers.iter().filter_map(|l| l.region().bounds()).reduce(|a, b| a.union(b));
        let plan = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE });
        let bottom = layers.first().map_or(0.0, |l| l.z_top_mm() - l.height_mm());
        let top = layers.last().map_or(0.0, |l| l.z_top_mm());
        let (low, high) = (plan.min.extend(bottom), plan.max.extend(top));
        let size = high - low;
        let mut cell_mm = NODES_MM;
        while (0..3).map(|k| 1.0 + size[k] / cell_mm).product::<f64>() > MOST_NODES {
            cell_mm *= 1.1;
        }
        Self { stack, low, high, cell_mm }
    }

    fn map(&self, flat: bool, at: &dyn Fn(DVec3) -> f64) -> DensityMap {
        DensityMap::new(self.low, self.high, self.cell_mm, flat, at)
    }
}

/// The share of the material's strength that the stress takes at each place of a part, smoothed. A value of
/// 1 is the share that only the most stressed 2 % of the part exceed.
///
/// # Errors
/// [`DensityError::NoStress`] if the stress is zero everywhere.
pub(crate) fn stress_share(
    stack: &LayerStack,
    guide: &Guide,
    card: Option<&StrengthCard>,
) -> Result<DensityMap, DensityError> {
    share_taken(&Nodes::over(stack), guide, card).map(|(map, _)| map)
}

/// As [`stress_share`], and for each node whether it lies in the part.
fn share_taken(
    nodes: &Nodes<'_>,
    guide: &Guide,
    card: Option<&StrengthCard>,
) -> Result<(DensityMap, Vec<bool>), DensityError> {
    let mut map = nodes.map(guide.is_plate, &|_| 0.0);
    let in_part = inside(&map, nodes.stack, 0.0);
    // The search for the element nearest to a point takes long for points far outside of a plate, whose stress counts
    // nowhere: no point of the part lies further from its nodes than the diagonal of a cell.
    let counted = if map.is_upright() {
        inside(&map, nodes.stack, CELL_DIAGONAL * nodes.cell_mm)
    } else {
        vec![true; map.values.len()]
    };
    let value = |i: usize| if counted[i] { taken(guide, card, map.node(i)) as f32 } else { 0.0 };
    map.values = (0..map.values.len()).into_par_iter().map(value).collect();
    smooth(&mut map, &in_part);
    let grips = guide.grips(nodes.cell_mm);
    let counts = |i: usize| in_part[i] && !grips.iter().any(|on| on.contains(map.node(i)));
    let mut all: Vec<f32> = (0..map.values.len()).filter(|&i| counts(i)).map(|i| map.values[i]).collect();
    if all.is_empty() {
        all = map.values.clone();
    }
    all.sort_by(f32::total_cmp);
    let full = f64::from(all[((all.len() - 1) as f64 * FULL_SHARE) as usize]);
    if full <= 0.0 {
        return Err(DensityError::NoStress);
    }
    map.values.iter_mut().for_each(|v| *v = (f64::from(*v) / full) as f32);
    Ok((map, in_part))
}

/// Fits the samples of a file to the part, or returns an error if they lie elsewhere.
fn lay(
    samples: &mut DensitySamples,
    to_file: DMat3,
    shift: DVec3,
    part: [DVec3; 2],
) -> Result<(), DensityError> {
    let corner = |k: usize| DVec3::new(part[k & 1].x, part[k >> 1 & 1].y, part[k >> 2].z);
    let corners = (0..8).map(|k| to_file * (corner(k) + shift));
    let (low, high) = corners.fold((DVec3::MAX, DVec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
    samples.stretch_over(low.truncate(), high.truncate());
    let Some(file) = samples.bounds() else { return Ok(()) };
    let axes = if samples.is_plane() { 2 } else { 3 };
    if (0..axes).any(|k| file.0[k] > high[k] || file.1[k] < low[k]) {
        return Err(DensityError::Elsewhere { file: [file.0, file.1], part: [low, high] });
    }
    Ok(())
}

/// Warns of places of a part that lie beyond the samples of a file. `nodes` are places of the part in the file's
/// coordinates, mm, and `part_mm` is the part's longest extent.
///
/// # Errors
/// [`DensityError::Nowhere`] for a single place, and if no place of the part is covered.
fn check_cover(
    samples: &DensitySamples,
    nodes: impl Iterator<Item = DVec3>,
    part_mm: f64,
    diagnostics: &Diagnostics,
) -> Result<(), DensityError> {
    // A grid without a place of its own is laid over the whole part.
    let Some((low, high)) = samples.bounds() else { return Ok(()) };
    let axes = if samples.is_plane() { 2 } else { 3 };
    // Samples often lie in the middle of the cells of their grid, so the outermost cover half a cell more.
    let n = samples.summary().samples as f64;
    let size = high - low;
    let spread: Vec<f64> = (0..axes).map(|k| size[k]).filter(|mm| *mm > 0.0).collect();
    let root = |v: f64| math::pow(v, 1.0 / spread.len().max(1) as f64);
    let cell_mm = root(spread.iter().product()) / (root(n) - 1.0).max(1.0);
    let reach = if spread.is_empty() { 0.0 } else { UNCOVERED_CELLS * cell_mm };
    let reach = reach.min(UNCOVERED_REACH * part_mm);
    let beyond = |p: &DVec3| (0..axes).map(|k| (low[k] - p[k]).max(p[k] - high[k])).fold(0.0, f64::max);
    let (mut n_nodes, mut n_beyond, mut farthest_mm) = (0usize, 0usize, 0.0f64);
    for mm in nodes.map(|p| beyond(&p)) {
        n_nodes += 1;
        n_beyond += usize::from(mm > reach);
        farthest_mm = farthest_mm.max(mm);
    }
    if spread.is_empty() || n_nodes > 0 && n_beyond == n_nodes {
        return Err(DensityError::Nowhere { file: [low, high] });
    }
    let share = n_beyond as f64 / n_nodes.max(1) as f64;
    if share > UNCOVERED_SHARE {
        let text = format!(
            "{:.0} % of the part lies up to {farthest_mm:.1} mm beyond the densities of the file",
            (100.0 * share).ceil()
        );
        diagnostics.warn(WarningId::DensityTooSmall, text);
    }
    Ok(())
}

/// The share of a dense part's strength that the stress at a point takes, in the worst load case.
fn taken(guide: &Guide, card: Option<&StrengthCard>, p: DVec3) -> f64 {
    let of_case = |stress: [f64; 6]| {
        let [xx, yy, zz, xy, yz, zx] = stress;
        let Some(card) = card else { return grainpath_core::tensor::von_mises(&stress) };
        let [a, b] = plane_principal([xx, yy, xy]).values_mpa;
        let (along, across) = if a.abs() >= b.abs() { (a, b) } else { (b, a) };
        card.index([along, across, 0.0]).0.max(card.layer_index([zz, yz, zx]).0)
    };
    let all = guide.cases.iter().map(|case| of_case(case.stress.whole(p)));
    all.filter(|v| v.is_finite()).fold(0.0, f64::max)
}

/// For each node whether it lies in the part, grown by `margin_mm` in the plan. Maps with a single layer of nodes are tested
/// at half height.
fn inside(map: &DensityMap, stack: &LayerStack, margin_mm: f64) -> Vec<bool> {
    let layers = stack.layers();
    let [nx, ny, nz] = map.n;
    let mut out = vec![false; map.values.len()];
    for k in 0..nz {
        let z = if nz > 1 {
            map.node(k * nx * ny).z
        } else {
            layers.get(layers.len() / 2).map_or(0.0, |l| l.z_top_mm())
        };
        let above = layers.partition_point(|l| l.z_top_mm() < z - 1e-9).min(layers.len().saturating_sub(1));
        let Some(region) = layers.get(above).map(|l| l.region()) else { continue };
        let grown = (margin_mm > 0.0).then(|| region.offset(margin_mm, Join::Round));
        let region = grown.as_ref().unwrap_or(region);
        let Some(bounds) = region.bounds() else { continue };
        let mask = Mask::from_region(MaskGrid::over(bounds, 0.25 * map.cell_mm.x.min(map.cell_mm.y)), region);
        for i in 0..nx * ny {
            out[k * nx * ny + i] = mask.contains(map.node(k * nx * ny + i).truncate());
        }
    }
    out
}

/// Replaces each value by the mean over the surrounding nodes that lie in the part.
fn smooth(map: &mut DensityMap, inside: &[bool]) {
    let [nx, ny, nz] = map.n;
    let around = |i: usize, n: usize| i.saturating_sub(SMOOTHED)..(i + SMOOTHED + 1).min(n);
    let before = map.values.clone();
    for (i, value) in map.values.iter_mut().enumerate() {
        let (mut sum, mut n) = (0.0, 0.0f32);
        for z in around(i / (nx * ny), nz) {
            for y in around(i / nx % ny, ny) {
                for x in around(i % nx, nx) {
                    let j = (z * ny + y) * nx + x;
                    if inside[j] {
                        sum += before[j];
                        n += 1.0;
                    }
                }
            }
        }
        if n > 0.0 {
            *value = sum / n;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::{Layer, Warning};

    #[test]
    fn a_file_that_covers_a_part_of_the_piece_is_told() {
        // Samples in a grid over a part of the plate of 40 x 20 mm, at the corners of cells or in their middle.
        let grid = |n: [usize; 2], low: [f64; 2], high: [f64; 2], middle: bool| {
            let mut text = String::from("x,y,density\n");
            for i in 0..n[0] * n[1] {
                let at = [i % n[0], i / n[0]];
                let share = |k: usize| {
                    let (i, n) = (at[k] as f64, n[k] as f64);
                    if middle { (i + 0.5) / n } else { i / (n - 1.0) }
                };
                let p = [0, 1].map(|k| low[k] + share(k) * (high[k] - low[k]));
                text += &format!("{},{},0.4\n", p[0], p[1]);
            }
            let (_, warnings) = told(&text, [0.1, 0.9]).expect("a density");
            warnings.iter().map(|w| (w.id.name(), w.text.clone())).collect::<Vec<_>>()
        };
        for middle in [true, false] {
            for n in [[40, 20], [20, 10], [11, 11]] {
                assert_eq!(grid(n, [0.0; 2], [40.0, 20.0], middle), [], "{n:?}");
            }
        }
        assert_eq!(grid([2, 2], [0.0; 2], [40.0, 20.0], false), []);
        for (low, high) in
            [([0.0, 0.0], [20.0, 20.0]), ([0.0, 5.0], [40.0, 20.0]), ([-90.0, 0.0], [35.0, 20.0])]
        {
            for n in [[2, 2], [20, 10]] {
                let found = grid(n, low, high, false);
                assert_eq!(
                    found.iter().map(|w| w.0).collect::<Vec<_>>(),
                    ["density-too-small"],
                    "{low:?} {high:?}"
                );
            }
        }
        let half = grid([20, 10], [0.0; 2], [20.0, 20.0], false);
        assert!(half[0].1.ends_with("mm beyond the densities of the file"), "{}", half[0].1);
        // A grid without a place of its own lies over the whole part.
        assert!(told("0.2 0.4\n0.4 0.6\n", [0.1, 0.9]).expect("a density").1.is_empty());
    }

    fn plate() -> LayerStack {
        let section = || Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 20.0));
        let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section()).expect("a layer");
        LayerStack::new((0..10).map(layer).collect()).expect("a stack")
    }

    fn by_file(text: &str, range: [f64; 2]) -> Result<GradedDensity, DensityError> {
        told(text, range).map(|(graded, _)| graded)
    }

    /// A density by a file, and the names of its warnings.
    fn told(text: &str, range: [f64; 2]) -> Result<(GradedDensity, Vec<Warning>), DensityError> {
        let samples =
            grainpath_io::directions::parse_densities(text.as_bytes(), "rho.csv", None).expect("a file");
        let place = FieldSettings::AS_IN_FILE;
        let settings = DensitySettings { range, by: DensityBy::File, spacing_mm: 0.4, card: None, place };
        let diagnostics = Diagnostics::default();
        let graded = GradedDensity::new(&settings, &plate(), None, Some(samples), &diagnostics)?;
        Ok((graded, diagnostics.warnings()))
    }

    #[test]
    fn the_distance_between_lines_grows_no_faster_than_the_limit() {
        // A step from 1 to 0.1 at x = 20.
        let graded = by_file(
            "x,y,density\n0,0,1\n20,0,1\n20.1,0,0.1\n40,0,0.1\n0,20,1\n20,20,1\n20.1,20,0.1\n40,20,0.1\n",
            [0.1, 1.0],
        )
        .expect("on the part");
        let map = graded.of_mean(graded.mean);
        let far = |x: f64| 0.4 / map.at(DVec3::new(x, 10.0, 1.0));
        assert!((far(5.0) - 0.4).abs() < 1e-3 && (far(35.0) - 4.0).abs() < 1e-2);
        for k in 0..39 {
            let x = f64::from(k);
            assert!((far(x + 1.0) - far(x)).abs() < 1.05 * STEEPEST, "{x}: {} {}", far(x), far(x + 1.0));
        }
    }

    #[test]
    fn a_scale_meets_a_mean_within_the_range() {
        let graded = by_file("x,y,density\n0,0,0.2\n40,0,0.4\n0,20,0.2\n40,20,0.4\n", [0.1, 0.8])
            .expect("on the part");
        assert!((graded.mean - 0.3).abs() < 0.01, "{}", graded.mean);
        for mean in [0.12, 0.25, 0.5, 0.78] {
            let map = graded.of_mean(mean);
            assert!((graded.mean_of(&map) - mean).abs() < 1e-3, "{mean}");
            let [low, high] = map.range_in(Bounds2 { min: DVec2::ZERO, max: DVec2::new(40.0, 20.0) }, 1.0);
            assert!(low >= 0.1 - 1e-6 && high <= 0.8 + 1e-6);
        }
        assert!((graded.mean_of(&graded.of_mean(1.0)) - 0.8).abs() < 1e-3);
    }

    #[test]
    fn a_file_beside_the_part_is_refused() {
        let wrong = by_file("x,y,density\n100,0,1\n120,0,1\n100,20,0.5\n", [0.1, 1.0]).map(|_| ());
        assert!(matches!(wrong, Err(DensityError::Elsewhere { .. })), "{wrong:?}");
        // A single place, and a spot between two nodes of the part.
        for (text, place) in [
            ("x,y,density\n10,10,0.5\n", "they lie at (10.00, 10.00, 0.00) mm alone;"),
            ("x,y,density\n9.4,9.4,0.5\n9.6,9.6,0.5\n", "from (9.40, 9.40, 0.00) to (9.60, 9.60, 0.00) mm;"),
        ] {
            let told = by_file(text, [0.1, 0.9]).map(|_| ()).expect_err("nowhere").to_string();
            assert!(
                told.starts_with("the densities of the file cover no place of the part")
                    && told.contains(place),
                "{told}"
            );
        }
    }
}
