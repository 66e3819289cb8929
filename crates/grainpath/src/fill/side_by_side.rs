//! Several beads side by side in each line of a sparse pattern.
//!
//! The beads of a line weld to each other. Compared with as many single lines, the line bends `n^2` times
//! less within the layer, because its second moment of area grows with the cube of its width. Lines are `n`
//! times as far apart as single lines, so that the volume still matches the density.
//!
//! What joins the rows along the border, and whole groups that just fit into the region or just do not, take the volume away
//! from the density. So distance and place of the lines are fitted once for the part (`SideBySide::fitted`): lines lie alike
//! in all of its layers.
//!
//! Each straight line becomes `n` rows of one zigzag, one bead spacing `s` apart. Loops of `concentric` come
//! in groups of `n`. Lines of the other patterns are surrounded by nested loops:
//!
//! ```text
//!      ______________________      border of the region
//!     |  __  |      |  __  |       n = 4: the outer loop keeps 1.5 s from the line, the inner
//!     | |  | |      | |  | |       one 0.5 s; for an odd n the line itself is the middle bead
//! ```
//!
//! The loop at distance `r` from a line is the border of the area within `r` of any line, cut by the region
//! shrunk by `R - r`, where `R` is the distance of the outermost loop. So where lines meet, loops run
//! around both of them, no two loops cross, and their ends lie side by side along the border too. Units:
//! mm. Cost: `n / 2` unions of the bands around all lines, n log n in their vertices. Limits: where lines
//! come nearer to each other than their own width, as streamlines may, beads are left out, and the density
//! is too low.

use grainpath_core::math::{direction, rotated};
use grainpath_core::poly::{FillRule, Join, LineClipper};
use grainpath_core::{
    Bounds2, DVec2, DVec3, Density, DirectionField, DirectionSample, Polygon, Region, Toolpath,
};
use grainpath_job::choices::Pattern;
use rayon::prelude::*;

use super::field::stripes::fit_volume;
use super::{Continuous, FillContext, Infill, concentric, honeycomb, infill, rectilinear};

/// A pattern whose sparse lines are several beads wide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideBySide {
    /// The pattern of the lines.
    pub pattern: Pattern,
    /// Number of beads in a line.
    pub beads: usize,
    /// Settings of the pattern `continuous`.
    pub continuous: Continuous,
    /// Distance and place of the lines.
    pub fit: LineFit,
}

/// Distance and place of lines of several beads, fitted to the volume that the density asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineFit {
    /// Factor on the density at which lines are laid.
    pub density: f64,
    /// How far all lines are moved sideways, as a share of their distance.
    pub moved: f64,
}

impl LineFit {
    /// Lines at the distance that the density asks for. One goes through the middle of the part; loops begin half a distance
    /// from the wall.
    pub const NONE: Self = Self { density: 1.0, moved: 0.0 };
}

/// Shorter loops are left out, in bead widths. Source: derived. A loop around a line as short as a point
/// has a length of pi widths; a shorter loop encloses no free area.
const SHORTEST_LOOP: f64 = 3.0;

/// A volume this near to the one asked for is not fitted further, as a share. Source: chosen; less than half of the 5 % that
/// docs/walls-and-fill.md states for parts wider than a few distances of lines.
const NEAR: f64 = 0.02;
/// The places of lines that are tried, as shares of their distance. Source: derived; with one to three lines in a region, a
/// quarter of their distance decides how many there are.
const MOVED: [f64; 4] = [0.0, 0.25, 0.5, 0.75];
/// How many distances are tried for each place. Measured: with seven, lines of 2 to 8 beads of all patterns come within 2.7 % of
/// densities of 0.15 and 0.3 on the plate of `tests/fill_lines.rs`.
const DISTANCES: usize = 7;
/// The least and the greatest density at which lines are laid for the volume of another one. Source: derived; below the
/// least a line of eight beads needs a part of 160 mm, above the greatest lines leave no space between them.
const LAID_AT: [f64; 2] = [0.02, 0.95];

/// How often lines along a field are laid, to come nearer to the density each time.
const ROUNDS: usize = 3;
/// What lines that come and go as a whole leave between the volume and the one asked for goes into the widths, up to this
/// share. Source: derived; beads that are narrower by a hundredth part by 4 um, a third of a step of a usual motor.
const WIDTH_SHARE: f64 = 0.01;

impl Infill for SideBySide {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        let n = self.beads;
        if context.density.is_dense() {
            return infill(self.pattern, &self.continuous).fill(context, infill_region, out);
        }
        let context = &self.placed(context);
        match self.pattern {
            Pattern::Rectilinear | Pattern::Aligned => {
                rectilinear::crossed(context, infill_region, 1, n, out)
            }
            Pattern::Grid => rectilinear::crossed(context, infill_region, 2, n, out),
            Pattern::Triangles => rectilinear::crossed(context, infill_region, 3, n, out),
            Pattern::Concentric => concentric::loops(context, infill_region, n, self.fit.moved, out),
            Pattern::Honeycomb => {
                let grown = self.beyond(context, infill_region);
                let mut lines = Vec::new();
                // If the sides of the hexagons are shorter than the width of a line, straight lines are laid instead.
                if grown.iter().all(|p| honeycomb::waves(context, p, n, &mut lines)) {
                    self.loops(context, infill_region, &lines, out);
                } else {
                    rectilinear::crossed(context, infill_region, 1, n, out);
                }
            }
            Pattern::Gyroid => {
                let wider = FillContext { density: self.share(context), ..*context };
                let mut lines = Vec::new();
                for grown in self.beyond(context, infill_region) {
                    infill(self.pattern, &self.continuous).fill(&wider, &grown, &mut lines);
                }
                self.loops(context, infill_region, &lines, out);
            }
            Pattern::Stripes | Pattern::Streamlines => self.along_field(context, infill_region, out),
            // The job's reader refuses several beads for these patterns.
            Pattern::SeedLines | Pattern::Continuous => {
                infill(self.pattern, &self.continuous).fill(context, infill_region, out);
            }
        }
    }
}

impl SideBySide {
    /// The same lines at the distance and the place where their volume in some regions of the part comes nearest to the one that
    /// the density asks for; each region comes with what the pattern needs to know of its layer. Patterns along a field fit
    /// every region on its own. Cost: at most 28 fillings of the regions; one where the volume is right from the start.
    pub(crate) fn fitted(&self, regions: &[(FillContext<'_>, &Polygon)]) -> Self {
        let wanted_mm3: f64 = regions.iter().map(|(context, region)| context.wanted_mm3(region)).sum();
        let Some(density) = regions.first().map(|(context, _)| context.density.fraction()) else {
            return *self;
        };
        if self.pattern.follows_field() || wanted_mm3 <= 0.0 {
            return *self;
        }
        // Regions that are the same in several layers are filled once; a gyroid differs from height to height.
        let mut distinct: Vec<(&FillContext<'_>, &Polygon, f64)> = Vec::new();
        for (context, region) in regions {
            let key = |c: &FillContext<'_>| [c.angle_rad, c.height_mm, c.border_mm].map(f64::to_bits);
            let same = distinct.iter().position(|d| key(d.0) == key(context) && d.1 == *region);
            match same.filter(|_| self.pattern != Pattern::Gyroid) {
                Some(k) => distinct[k].2 += 1.0,
                None => distinct.push((context, *region, 1.0)),
            }
        }
        let volume_mm3 = |fit: LineFit| -> f64 {
            let one = |(context, region, n): &(&FillContext<'_>, &Polygon, f64)| -> f64 {
                let mut beads = Vec::new();
                Self { fit, ..*self }.fill(context, region, &mut beads);
                n * beads.iter().map(|bead| bead.volume_mm3(context.height_mm)).sum::<f64>()
            };
            // Summed in the order of the regions, so that the result does not depend on the number of threads.
            distinct.par_iter().map(one).collect::<Vec<f64>>().iter().sum()
        };
        let range = [LAID_AT[0].min(density), LAID_AT[1].max(density)].map(|laid_at| laid_at / density);
        let mut best = (f64::INFINITY, LineFit::NONE);
        // A gyroid has the same number of waves wherever it begins.
        let places = if self.pattern == Pattern::Gyroid { 1 } else { MOVED.len() };
        for &moved in &MOVED[..places] {
            // The factors that laid too little and too much.
            let (mut low, mut high) = (None, None);
            let mut factor = 1.0;
            for _ in 0..DISTANCES {
                let fit = LineFit { density: factor, moved };
                let ratio = volume_mm3(fit) / wanted_mm3;
                let off = (ratio - 1.0).abs();
                if off < best.0 {
                    best = (off, fit);
                }
                if off <= NEAR {
                    return Self { fit: best.1, ..*self };
                }
                if ratio < 1.0 {
                    low = Some(factor)
                } else {
                    high = Some(factor)
                }
                // The volume is nearly proportional to the density. Where one line more or less takes it to the other side,
                // the middle between both is tried.
                let next = match (low, high) {
                    (Some(low), Some(high)) => f64::sqrt(low * high),
                    _ => factor / ratio.clamp(0.5, 2.0),
                };
                let next = next.clamp(range[0], range[1]);
                if next == factor {
                    break;
                }
                factor = next;
            }
        }
        Self { fit: best.1, ..*self }
    }

    /// The context in which lines have the fitted distance and place. Rasters are anchored at the middle of the part, which
    /// moves across the lines of all directions.
    fn placed<'a>(&self, context: &FillContext<'a>) -> FillContext<'a> {
        if self.fit == LineFit::NONE {
            return *context;
        }
        let density = Density::new(context.density.fraction() * self.fit.density);
        // Lines that cross within a layer share its material.
        let directions = match self.pattern {
            Pattern::Grid => 2.0,
            Pattern::Triangles => 3.0,
            Pattern::Rectilinear
            | Pattern::Aligned
            | Pattern::Gyroid
            | Pattern::Honeycomb
            | Pattern::Concentric
            | Pattern::Stripes
            | Pattern::Streamlines
            | Pattern::SeedLines
            | Pattern::Continuous => 1.0,
        };
        let step_mm = self.beads as f64 * directions * context.spacing_mm() / density.fraction();
        let by = rotated(DVec2::splat(self.fit.moved * step_mm), direction(context.angle_rad));
        let part = Bounds2 { min: context.part.min + by, max: context.part.max + by };
        FillContext { density, part, ..*context }
    }

    /// The density that the lines would have if each were a single bead.
    fn share(&self, context: &FillContext<'_>) -> Density {
        Density::new(context.density.fraction() / self.beads as f64)
    }

    /// Lays lines along the field whose beads have the volume that the density asks for.
    ///
    /// Single lines along a field are narrower or wider than nominal, which makes up for distances that are
    /// not quite those asked for. Beads of one line would part, or press into each other, so their width
    /// stays within [`WIDTH_SHARE`] and the distance of the lines changes.
    fn along_field(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        let own =
            context.field.map(|field| Widened { field, beads: self.beads, least_mm: context.spacing_mm() });
        let field = own.as_ref().map(|own| own as &dyn DirectionField);
        let laid = |density: Density| {
            let wider = FillContext { density, field, ..*context };
            let (mut lines, mut beads) = (Vec::new(), Vec::new());
            // The field is known only inside the region, so lines end at its border.
            infill(self.pattern, &self.continuous).fill(&wider, infill_region, &mut lines);
            // As for single lines, no line from border to border is shorter than it is wide.
            lines.retain(|line| line.length_mm() >= self.beads as f64 * context.bead_width_mm);
            self.loops(context, infill_region, &lines, &mut beads);
            beads
        };
        // A field that asks for distances decides the density, so that there is nothing to correct.
        let wanted_mm3 = (!context.field_asks(infill_region)).then(|| context.wanted_mm3(infill_region));
        let mut density = self.share(context);
        let mut best = (f64::INFINITY, Vec::new());
        for _ in 0..ROUNDS {
            let beads = laid(density);
            let volume_mm3: f64 = beads.iter().map(|bead| bead.volume_mm3(context.height_mm)).sum();
            let off_mm3 = wanted_mm3.map_or(0.0, |wanted| (volume_mm3 - wanted).abs());
            if off_mm3 < best.0 {
                best = (off_mm3, beads);
            }
            let Some(wanted_mm3) = wanted_mm3.filter(|_| volume_mm3 > 0.0) else { break };
            // The volume grows almost in proportion to the density, so the ratio nearly meets it. The nearest
            // volume is kept: where few lines fit, one more or less can take it to the other side.
            density = Density::new(density.fraction() * wanted_mm3 / volume_mm3);
        }
        let (_, mut beads) = best;
        if let Some(wanted_mm3) = wanted_mm3 {
            let laid_mm3: f64 = beads.iter().map(|bead| bead.volume_mm3(context.height_mm)).sum();
            let [low, high] = [1.0 - WIDTH_SHARE, 1.0 + WIDTH_SHARE].map(|share| share * laid_mm3);
            fit_volume(&mut beads, wanted_mm3.clamp(low, high), context);
        }
        out.extend(beads);
    }

    /// The region, grown so far that the ends of lines that leave it lie outside and are cut off.
    fn beyond(&self, context: &FillContext<'_>, infill_region: &Polygon) -> Vec<Polygon> {
        let grown = Region::from(infill_region.clone());
        grown.offset((0.5 * self.beads as f64 + 1.0) * context.spacing_mm(), Join::Round).polygons
    }

    /// Lays the beads of lines, of which `lines` are the centrelines.
    fn loops(
        &self,
        context: &FillContext<'_>,
        infill_region: &Polygon,
        lines: &[Toolpath],
        out: &mut Vec<Toolpath>,
    ) {
        let s = context.spacing_mm();
        let outermost = 0.5 * (self.beads - 1) as f64 * s;
        let whole = Region::from(infill_region.clone());
        let grown = |r: f64| whole.offset(r - outermost, Join::Miter(3.0));
        if self.beads % 2 == 1 {
            let clipper = LineClipper::new(&grown(0.0));
            for line in lines {
                let mut points = line.points.clone();
                // A closed line is clipped as an open line that ends at its start.
                points.extend(line.closed.then(|| line.start()));
                let pieces = clipper.clip(&points);
                let uncut = line.closed && pieces.len() == 1 && pieces[0].points.len() == points.len();
                if uncut {
                    out.push(line.clone());
                    continue;
                }
                let piece = |points| Toolpath::new(points, context.bead_width_mm, context.role, false);
                let all = pieces.into_iter().map(|p| piece(p.points));
                out.extend(all.filter(|p| p.length_mm() > context.bead_width_mm));
            }
        }
        let mut r = outermost;
        while r > 0.25 * s {
            let bands: Vec<Region> =
                lines.iter().map(|l| Region::around_line(&l.points, l.closed, r)).collect();
            let all = bands.iter().flat_map(Region::contours);
            let band = Region::from_contours(all, FillRule::NonZero).intersection(&grown(r));
            for contour in band.contours() {
                let path = Toolpath::new(contour.clone(), context.bead_width_mm, context.role, true);
                if path.length_mm() > SHORTEST_LOOP * context.bead_width_mm {
                    out.push(path);
                }
            }
            r -= s;
        }
    }
}

/// A field with line spacings for single beads, which are widened here for lines of several beads.
struct Widened<'a> {
    field: &'a dyn DirectionField,
    beads: usize,
    least_mm: f64,
}

impl DirectionField for Widened<'_> {
    fn sample(&self, p: DVec3) -> DirectionSample {
        self.field.sample(p)
    }

    fn spacing_mm(&self, p: DVec3) -> Option<f64> {
        self.field.spacing_mm(p).map(|mm| mm.max(self.least_mm) * self.beads as f64)
    }

    fn rows(&self) -> DVec2 {
        self.field.rows()
    }
}
