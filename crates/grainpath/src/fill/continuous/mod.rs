//! One closed path through a whole infill region, along the field where it can.
//!
//! Method: spanning tree coverage (`Gabriely2001`) on cells that follow a field. The idea to join loops
//! along a tree weighted by stress is that of a patent application (`ContinuousPath`). A loop around the
//! cells of a tree is one closed path, because a tree has no cycles. The steps:
//!
//! 1. [`strips`] cuts the region along the field into strips two beads wide, one bead for each direction;
//! 2. [`cells`] cuts the strips across at even lengths;
//! 3. [`tree`] joins cells that share an edge, and prefers joints that turn beads little out of the field;
//! 4. [`rings`] makes the joints: two stretches that face each other are replaced by two connections
//!    between their ends, so two loops become one;
//! 5. [`finish`] moves the beads to the middle of the space they have and gives them their widths;
//! 6. [`verify`] looks for crossings, for rings that could not be joined, and for necks too narrow for two
//!    beads side by side.
//!
//! ```text
//!    +-----------+ +-----------+          +-----------+-+-----------+
//!    |  cell 1   | |  cell 2   |    ->    |             joint       |    one loop
//!    +-----------+ +-----------+          +-----------+ +-----------+
//! ```
//!
//! A closed path lays an even number of beads across any place, so a place three beads wide cannot be
//! filled at one width. [`Problem`] names what prevented a single path. Related work: controllable
//! space-filling curves (`Bedel2022`) improve a cycle by local moves; here the tree is chosen once, and
//! rings that remain apart are joined afterwards.
//!
//! Cost: near linear; 100 000 cells take about 1 s and 110 MB, a million 11 s and 1.07 GB (`cargo
//! xtask bench continuous`).
//!
#![doc = include_str!("figures/strips.svg")]

mod cells;
mod finish;
mod rings;
mod strips;
mod cell_tree;
mod verify;

use grainpath_core::math::direction;
use grainpath_core::poly::{Join, LineClipper, perimeter_mm};
use grainpath_core::tuned::Tuned;
use grainpath_core::{DVec2, Density, Polygon, Region, Toolpath};

use super::{FillContext, Infill};
pub use cell_tree::TreeKind;
use cells::{MARK, Taken};
use rings::Rings;
pub(super) use verify::necks;
pub use verify::{Note, Problem};

/// One closed path, along the field wherever it can.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Continuous {
    /// The tree that joins the cells.
    pub tree: TreeKind,
    /// Length of a cell divided by its width.
    pub aspect: f64,
    /// Whether beads widen and narrow to fill the space they have.
    pub variable: bool,
}

#[cfg(test)]
impl Continuous {
    /// Follows the field, with beads of varying width.
    pub(crate) const FOR_TESTS: Self = Self { tree: TreeKind::Directed, aspect: 2.5, variable: true };
}

/// Rings shorter than this are left out, in bead spacings, because starting takes longer than printing
/// them. Source: derived. Retracting 0.8 mm of filament at 35 mm/s and pushing it back, as the default
/// profile does, takes 46 ms, in which the head moves 2.7 mm at 60 mm/s: six beads of 0.45 mm.
const MIN_RING_BEADS: f64 = 6.0;
/// Least weight of the field, so that cells still follow it where the stress is nearly zero.
/// Measured: row `fill.continuous.MIN_WEIGHT` of `cargo xtask bench constants`.
static MIN_WEIGHT: Tuned<f64> = Tuned::new("fill.continuous.MIN_WEIGHT", 0.02);
/// Number of samples along the longer side of a region, by which the typical strength of the field is estimated.
/// Measured: row `fill.continuous.FIELD_SAMPLES` of `cargo xtask bench constants`.
static FIELD_SAMPLES: Tuned<f64> = Tuned::new("fill.continuous.FIELD_SAMPLES", 32.0);

impl Infill for Continuous {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        self.lay_island(context, &[infill_region], out, &mut Vec::new());
    }
}

/// Gives the field's axis and its weight at a point. Weight 1 is that of places where the direction matters
/// much in this region.
struct Pull<'a> {
    context: &'a FillContext<'a>,
    /// The strength of the field that counts as weight 1.
    much: f64,
}

impl<'a> Pull<'a> {
    fn new(context: &'a FillContext<'a>, infill_region: &Polygon) -> Self {
        let mut pull = Self { context, much: 1.0 };
        let region = Region::from(infill_region.clone());
        let Some(bounds) = region.bounds() else { return pull };
        let inside = LineClipper::new(&region);
        let size = bounds.size();
        let step = size.max_element() / FIELD_SAMPLES.value();
        let [nx, ny] = [size.x, size.y].map(|mm| (mm / step).ceil().max(1.0) as usize);
        let place = |i: usize, j: usize| bounds.min + step * DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
        let places = (0..ny).flat_map(|j| (0..nx).map(move |i| place(i, j)));
        let mut all: Vec<f64> = places.filter(|&p| inside.contains(p)).map(|p| pull.at(p).1).collect();
        // The ninth decile is used, because a scale set by stress peaks at corners would give the rest of
        // the region the smallest weight. With hardly a sample inside the region the scale stays 1.
        let at = all.len() * 9 / 10;
        if at > 0 {
            pull.much = all.select_nth_unstable_by(at, f64::total_cmp).1.max(f64::MIN_POSITIVE);
        }
        pull
    }

    fn at(&self, p: DVec2) -> (DVec2, f64) {
        let Some(field) = self.context.field else { return (DVec2::X, 1.0) };
        let there = field.sample(p.extend(self.context.z_mid_mm));
        // The difference of the principal stresses is what is lost by a bead across the axis instead of
        // along it. Fields without stresses give their own strength.
        let matters = there.principal_mpa.map_or(there.strength, |[along, across]| (along - across).abs());
        (direction(there.axis_rad), (matters / self.much).max(MIN_WEIGHT.value()))
    }
}

impl Continuous {
    /// Fills the infill regions of one island, and notes what prevented a single path.
    pub(crate) fn lay_island(
        &self,
        context: &FillContext<'_>,
        infill_regions: &[&Polygon],
        out: &mut Vec<Toolpath>,
        notes: &mut Vec<Note>,
    ) {
        // Below full density the outermost bead keeps half of the wider spacing from the wall.
        let keep_mm = match context.density {
            Density::Dense => 0.0,
            Density::Sparse(fraction) => 0.5 * context.spacing_mm() / fraction,
        };
        let whole = Region { polygons: infill_regions.iter().map(|&r| r.clone()).collect() };
        // Insetting by this distance may split a region; each part becomes a path of its own.
        let infill_regions = whole.offset(-keep_mm, Join::Miter(3.0)).polygons;
        necks(&infill_regions, context.bead_width_mm, notes);
        infill_regions.iter().for_each(|infill_region| self.lay(context, infill_region, out, notes));
    }

    /// Lays one infill region.
    fn lay(
        &self,
        context: &FillContext<'_>,
        infill_region: &Polygon,
        out: &mut Vec<Toolpath>,
        notes: &mut Vec<Note>,
    ) {
        let rings = self.joined(context, infill_region, context.spacing_mm() / context.density.fraction());
        self.lay_rings(rings, context, infill_region, out, notes);
    }

    /// Lays one infill region whose density differs from band to band as one path. Each of the `bands`, from the densest to
    /// the sparsest, has its density and its region, which reaches to the walls.
    pub(super) fn lay_bands(
        &self,
        context: &FillContext<'_>,
        infill_region: &Polygon,
        bands: &[(Density, Region)],
        out: &mut Vec<Toolpath>,
        notes: &mut Vec<Note>,
    ) {
        let spacing = |density: Density| context.spacing_mm() / density.fraction();
        let mut rings = Vec::new();
        for &(density, ref band) in bands {
            let context = FillContext { density, ..*context };
            // Beads at the border of a band keep half of its spacing, so that the two bands share the space between them.
            for polygon in band.offset(-0.5 * spacing(density), Join::Miter(3.0)).polygons {
                rings.extend(self.joined(&context, &polygon, spacing(density)));
            }
        }
        // Rings of two bands lie half of both spacings apart.
        for &(density, _) in bands {
            rings = rejoined(rings, infill_region, spacing(density));
        }
        // Beads are centred and short rings left out by the spacing of the densest band: wider gaps are no gaps to fill.
        let density = bands.first().map_or(context.density, |band| band.0);
        self.lay_rings(rings, &FillContext { density, ..*context }, infill_region, out, notes);
    }

    /// Makes beads of the rings of a region.
    fn lay_rings(
        &self,
        mut rings: Vec<Vec<DVec2>>,
        context: &FillContext<'_>,
        infill_region: &Polygon,
        out: &mut Vec<Toolpath>,
        notes: &mut Vec<Note>,
    ) {
        let spacing = context.spacing_mm() / context.density.fraction();
        // The longest ring is the path. Rings that could not be joined to it follow, unless they
        // are too short to print.
        rings.sort_by(|a, b| perimeter_mm(b).total_cmp(&perimeter_mm(a)));
        let kept = rings.iter().skip(1).take_while(|p| perimeter_mm(p) > MIN_RING_BEADS * spacing).count();
        rings.truncate(1 + kept);
        let border = Region::from(infill_region.clone()).offset(context.border_mm, Join::Miter(3.0));
        let beads = finish::lay(rings, infill_region, &border, self.variable, context);
        let checked = |thinned: bool| {
            let paths: Vec<Toolpath> = beads.iter().filter_map(|b| b.path(thinned, context)).collect();
            let found = verify::check(&paths, infill_region, spacing);
            (paths, found)
        };
        let (mut paths, mut found) = checked(true);
        if found.iter().any(|n| matches!(n.what, Problem::Crossing | Problem::Outside)) {
            // Beads that nearly touch may cross after points have been left out. In that case all points
            // are kept.
            (paths, found) = checked(false);
        }
        notes.extend(found);
        out.extend(paths);
    }

    /// The loops around all cells of a region, joined to a single ring where possible.
    fn joined(&self, context: &FillContext<'_>, infill_region: &Polygon, spacing: f64) -> Vec<Vec<DVec2>> {
        let pull = Pull::new(context, infill_region);
        let axis = |p: DVec2| pull.at(p);
        let mut rings =
            Rings::new(strips::with_border(context, infill_region, &pull, spacing), infill_region, spacing);
        // Outlines that cross cannot be joined: the joint would make a knot. So squares are cut out at the
        // crossings, which separates the outlines.
        let touching = rings.crossings();
        if !touching.is_empty() {
            let loops: Vec<Vec<DVec2>> = rings.lines.into_iter().map(|l| l.points).collect();
            rings = Rings::new(strips::parted(&loops, &touching, spacing), infill_region, spacing);
        }
        let mut taken = Taken::new(&rings, MARK.value() * spacing);
        let cells = cells::cut(&rings, 2.0 * self.aspect * spacing, spacing, context.shift, &mut taken);
        let exchanges = cell_tree::join(&rings, &cells, self.tree, spacing, context.shift, &axis, &mut taken);
        rejoined(rings.exchanged(&exchanges), infill_region, spacing)
    }
}

/// Joins rings that are still apart, as far as they face each other.
fn rejoined(mut joined: Vec<Vec<DVec2>>, infill_region: &Polygon, spacing: f64) -> Vec<Vec<DVec2>> {
    // A small ring has little space for joints. Once it is part of a large ring, the stretches
    // it took up are free again, so the search is repeated until nothing more is joined.
    let mut apart = joined.len();
    while apart > 1 {
        let rings = Rings::around_short(joined, infill_region, spacing);
        let rest = cell_tree::join_rest(&rings, spacing);
        joined = rings.exchanged(&rest);
        // Rings too short to print are dropped later and need no joint.
        let left = joined.iter().filter(|r| perimeter_mm(r) > MIN_RING_BEADS * spacing).count();
        apart = if rest.is_empty() { 0 } else { left };
    }
    joined
}

#[cfg(test)]
mod figures;
#[cfg(test)]
mod tests;
