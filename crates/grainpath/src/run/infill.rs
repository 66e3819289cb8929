//! Lays the infill of one layer: dense or sparse, in straight lines, along a field or along the
//! grain, with or without fibre.
//!
//! Lengths are in mm. Skins over sparse infill are always straight lines without fibre. A part that
//! is dense throughout is filled with the pattern of the job.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::PoisonError;

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::math::direction;
use grainpath_core::poly::{Join, LineClipper, edges};
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{
    DVec2, Density, Diagnostics, DirectionField, Layer, Polygon, Region, Role, SpeedClass, Toolpath,
};
use grainpath_job::choices::{BeadWidths, Pattern};

use super::steps::{IslandPaths, Steps};
use crate::fibre::{FibrePlace, FibreSettings, Tally};
use crate::fill::curves::{Flow, lay_curves};
use crate::fill::graded_infill::{FittedLayer, fit_layers};
use crate::fill::{
    Concentric, FillContext, Infill, LinesBelow, SeedLines, SideBySide, Solid, Stripes, band,
    bridge_angle_rad, graded_infill, infill, join_rings,
};
use crate::guide::graded_density::DensityMap;
use crate::guide::grain::GrainGuide;
use crate::guide::grain::Mode;
use crate::region::on_border;
use crate::wall::skin::{IslandPolygon, SkinSplit};

/// Number of layers over which lines of several beads are fitted. Source: derived; enough for a gyroid of eight beads, whose
/// waves repeat after tens of mm, on parts up to a few of those high.
const FITTED_LAYERS: usize = 8;

/// A border gets a bead where the area for centrelines is at least this deep behind it, in beads. Source: derived. Where both
/// sides of a strip get one, two beads and a half leave room for a line between them; two leave none, and a gap instead.
const LEAST_DEPTH: f64 = 2.5;

/// How an infill region is filled.
struct RegionFill<'a> {
    density: Density,
    /// The density at every point, for graded density.
    graded: Option<&'a DensityMap>,
    role: Role,
    pattern: &'a dyn Infill,
    grain: Option<&'a GrainGuide>,
    /// Whether the regions of an island are filled with one path.
    one_path: bool,
    /// Lines of a layer below, from which those along a field go on.
    below: Option<&'a LinesBelow>,
    /// Direction of the lines, radians; `None` takes the direction of the layer's infill.
    angle_rad: Option<f64>,
}

/// Tells the region of a job at each place of a layer.
pub(super) struct Owners(Vec<LineClipper>);

impl Owners {
    /// The number of the region at a point, counted from 1; 0 outside all of them.
    pub(super) fn at(&self, p: DVec2) -> usize {
        self.0.iter().position(|area| area.contains(p)).map_or(0, |region| region + 1)
    }
}

impl Steps<'_> {
    /// The regions of a layer; `None` where there are none.
    pub(super) fn owners(&self, layer_idx: usize) -> Option<Owners> {
        let areas = self.areas.and_then(|areas| areas.of_layer(layer_idx))?;
        Some(Owners(areas.iter().map(LineClipper::new).collect()))
    }

    /// Distance between the region of centrelines and the border of the area to be filled, mm. The
    /// area reaches to the strips of the walls and slightly beyond: the round edge of the outer wall leaves
    /// some area unfilled, and the infill makes up for it, so that the layer has the part's volume.
    pub(super) fn border_mm(&self, layer: &Layer) -> f64 {
        let walls = &self.settings.walls;
        let w = walls.bead_width_mm;
        let s = bead_spacing_mm(w, layer.height_mm());
        if walls.n_walls == 0 {
            return 0.5 * w;
        }
        // Half a strip minus the overlap, plus half the difference between the outer wall's full width
        // and its strip.
        (0.5 - walls.fill_overlap) * s + 0.5 * (w - s)
    }

    /// Distance of centrelines from the border between two regions, mm: half a strip.
    pub(super) fn inset_mm(&self, layer: &Layer) -> f64 {
        0.5 * bead_spacing_mm(self.settings.walls.bead_width_mm, layer.height_mm())
    }

    /// Distance of centrelines from the border of an area, mm. If the area borders on another region, the distance is the
    /// mean over its edges: `wall_mm` along walls ([`Self::border_mm`]) and [`Self::inset_mm`] along the other region.
    fn border_of(&self, layer_idx: usize, wall_mm: f64, infill_region: &Polygon) -> f64 {
        let Some(areas) = self.areas.and_then(|a| a.of_layer(layer_idx)) else { return wall_mm };
        let inset_mm = self.inset_mm(&self.stack.layers()[layer_idx]);
        let (mut sum, mut length) = (0.0, 0.0);
        for edge in infill_region.contours().flat_map(|c| edges(c)) {
            let mm = edge.0.distance(edge.1);
            // The tolerance is a tenth larger than the inset, because corners are rounded.
            let own = if on_border(areas, edge, 1.1 * inset_mm) { inset_mm } else { wall_mm };
            sum += mm * own;
            length += mm;
        }
        if length > 0.0 { sum / length } else { wall_mm }
    }

    /// The area of each layer that sparse infill fills outside regions, up to the strips of the walls.
    pub(super) fn sparse_areas(&self, skins: &[SkinSplit]) -> Vec<Region> {
        self.stack.layers().iter().zip(skins).map(|(layer, split)| self.sparse_area(layer, split)).collect()
    }

    pub(super) fn sparse_area(&self, layer: &Layer, split: &SkinSplit) -> Region {
        let polygons = split.sparse.iter().map(|p| p.1.clone()).collect();
        Region { polygons }.offset(self.border_mm(layer), Join::Miter(2.0))
    }

    /// Whether beads of a graded density lean and are fitted over the layers of the whole part, here or in a region.
    pub(super) fn leans(&self) -> bool {
        self.own_leans() || self.regions.iter().any(Self::own_leans)
    }

    fn own_leans(&self) -> bool {
        self.graded.is_some() && graded_infill::leans(self.settings.infill.pattern)
    }

    /// The areas of a layer whose beads are fitted by [`Self::fit_leaning`]: that outside all regions first, then those of the
    /// regions. Empty where no beads lean.
    pub(super) fn leaning_areas(&self, i: usize, split: &SkinSplit) -> Vec<Region> {
        let all = std::iter::once((self, split)).chain(self.regions(split));
        let area = |(steps, split): (&Self, &SkinSplit)| {
            if steps.own_leans() {
                steps.sparse_area(&self.stack.layers()[i], split)
            } else {
                Region::default()
            }
        };
        if self.leans() { all.map(area).collect() } else { Vec::new() }
    }

    /// Sets the widths of beads of a graded density that lean, in layers from the bed upwards, each with its index and its
    /// [`Self::leaning_areas`].
    pub(super) fn fit_leaning(&self, density: Density, layers: &mut [(usize, &[Region], &mut IslandPaths)]) {
        let regions = self.regions.iter().map(|r| (r, self.density_in(r, density)));
        for (k, (steps, density)) in std::iter::once((self, density)).chain(regions).enumerate() {
            let Some(graded) = steps.graded else { continue };
            let mut fitted = Vec::new();
            for (i, areas, paths) in layers.iter_mut() {
                let Some(area) = areas.get(k).filter(|area| !area.is_empty()) else { continue };
                // Beads of the job and of its regions lie in areas of their own.
                let own = (areas.len() > 1).then(|| LineClipper::new(area));
                let is_own = |path: &Toolpath| {
                    path.role == Role::SparseFill
                        && own.as_ref().is_none_or(|own| own.contains(path.points[path.points.len() / 2]))
                };
                fitted.push(FittedLayer {
                    z_mid_mm: self.z_mid_mm(*i),
                    height_mm: self.stack.layers()[*i].height_mm(),
                    area: area.clone(),
                    paths: paths.iter_mut().map(|(_, path)| path).filter(|path| is_own(path)).collect(),
                });
            }
            let walls = &steps.settings.walls;
            let map = graded.of_mean(density.fraction());
            fit_layers(&mut fitted, &map, walls.bead_width_mm, walls.min_bead_width_mm);
        }
    }

    /// The direction of a layer's lines. Patterns that cross within a layer, and `aligned`, use the
    /// first raster angle.
    pub(super) fn angle_rad(&self, layer_idx: usize, density: Density) -> f64 {
        let infill = &self.settings.infill;
        if let Some(angle_rad) = infill.guide_angle_rad {
            return angle_rad;
        }
        let turns = match infill.pattern {
            Pattern::Aligned => false,
            Pattern::Rectilinear => true,
            Pattern::Grid
            | Pattern::Triangles
            | Pattern::Gyroid
            | Pattern::Concentric
            | Pattern::Honeycomb
            | Pattern::Stripes
            | Pattern::Streamlines
            | Pattern::SeedLines
            | Pattern::Continuous => density.is_dense(),
        };
        // Patterns that do not turn keep the first angle, so that their cells lie above each other.
        infill.angles.of_layer(layer_idx, turns)
    }

    /// Lays skins and bridges, and all infill where the whole part is dense.
    pub(super) fn dense_fill(
        &self,
        i: usize,
        split: &SkinSplit,
        add: &mut dyn FnMut(usize, Toolpath),
    ) -> Tally {
        let mut paths = Vec::new();
        let mut tally = Tally::default();
        let infill = &self.settings.infill;
        let all_dense = infill.density.is_dense();
        // Skins over sparse infill close the part: they are straight lines without fibre, whatever
        // the pattern.
        let grain = self.grain.filter(|_| all_dense);
        let fibre = self.fibre.filter(|_| all_dense);
        let skin = infill.skin_angles.as_ref().filter(|_| !all_dense);
        let angle_rad = skin.map(|angles| angles.of_layer(i, true));
        for (polygons, role) in [(&split.solid, Role::SolidFill), (&split.top, Role::TopSkin)] {
            let pattern = if angle_rad.is_some() { &Solid } else { self.dense_pattern(infill.pattern) };
            let one_path = self.is_continuous() && angle_rad.is_none();
            let asked = RegionFill {
                density: Density::Dense,
                graded: None,
                role,
                pattern,
                grain,
                one_path,
                angle_rad,
                below: None,
            };
            // All regions of an island are filled together: the continuous pattern reports the
            // necks between them.
            for regions in polygons.chunk_by(|a, b| a.0 == b.0) {
                tally = tally.and(self.fill_island(i, regions, &asked, fibre, &mut paths));
                paths.drain(..).for_each(|p| add(regions[0].0, p));
            }
        }
        for (island, polygon) in &split.bridge {
            self.bridge(i, polygon, angle_rad, &mut paths);
            paths.drain(..).for_each(|p| add(*island, p));
        }
        for (region, split) in self.regions(split) {
            tally = tally.and(region.dense_fill(i, split, add));
        }
        tally
    }

    /// Lays a bead along each side of every border between regions that are dense on both sides, and takes its strip from
    /// their dense areas: the ends of lines that run into a border would leave notches between both sides.
    pub(super) fn line_seams<'s>(
        &self,
        i: usize,
        split: &'s SkinSplit,
        paths: &mut Vec<(usize, Toolpath)>,
    ) -> Cow<'s, SkinSplit> {
        let Some(owners) = self.owners(i) else { return Cow::Borrowed(split) };
        let layer = &self.stack.layers()[i];
        let section = LineClipper::new(layer.region());
        let open = |(own, steps): (&SkinSplit, &Self)| {
            let polygons = own.sparse.iter().chain(&own.bridge).map(|p| p.1.clone()).collect();
            LineClipper::new(&Region { polygons }.offset(steps.inset_mm(layer), Join::Miter(2.0)))
        };
        let steps = || std::iter::once(self).chain(&self.regions);
        let open: Vec<LineClipper> =
            std::iter::once(split).chain(&split.regions).zip(steps()).map(open).collect();
        let mut lined = split.clone();
        for (k, steps) in steps().enumerate() {
            let meets = |p: DVec2| {
                section.contains(p) && owners.at(p) != k && !open.iter().any(|area| area.contains(p))
            };
            let own = match k.checked_sub(1) {
                None => &mut lined,
                Some(region) => &mut lined.regions[region],
            };
            for (polygons, role) in [(&mut own.solid, Role::SolidFill), (&mut own.top, Role::TopSkin)] {
                *polygons = steps.beside(i, polygons, &meets, role, paths);
            }
        }
        Cow::Owned(lined)
    }

    /// Lays beads along the borders of dense polygons where what lies beyond `meets` them, and returns what is left of the
    /// polygons.
    fn beside(
        &self,
        i: usize,
        polygons: &[IslandPolygon],
        meets: &dyn Fn(DVec2) -> bool,
        role: Role,
        paths: &mut Vec<(usize, Toolpath)>,
    ) -> Vec<IslandPolygon> {
        let context = self.context(i, Density::Dense, role);
        let (s, inset_mm) = (context.spacing_mm(), self.inset_mm(&self.stack.layers()[i]));
        // Lines keep the same distance from these beads as from walls.
        let border_mm = (0.5 - self.settings.walls.fill_overlap) * s;
        let context = FillContext { border_mm, ..context };
        let mut left = Vec::new();
        for (island, polygon) in polygons {
            let whole = Region::from(polygon.clone());
            let inside = LineClipper::new(&whole);
            let is_beside = |[a, b]: [DVec2; 2]| {
                let (middle, inward) = (0.5 * (a + b), (b - a).normalize_or_zero().perp());
                meets(middle - (inset_mm + 0.5 * s) * inward)
                    && inside.contains(middle + LEAST_DEPTH * s * inward)
            };
            let mut beads = Vec::new();
            let rest = band::laid(&whole, &is_beside, 1, s, &context, &mut beads);
            paths.extend(beads.into_iter().map(|bead| (*island, bead)));
            left.extend(rest.polygons.into_iter().map(|polygon| (*island, polygon)));
        }
        left
    }

    /// Lays sparse infill. Lines along a field go on from `below`.
    pub(super) fn sparse_fill(
        &self,
        i: usize,
        split: &SkinSplit,
        density: Density,
        below: Option<&LinesBelow>,
        add: &mut dyn FnMut(usize, Toolpath),
    ) -> Tally {
        let mut tally = Tally::default();
        for (region, split) in self.regions(split) {
            let density = self.density_in(region, density);
            tally = tally.and(region.sparse_fill(i, split, density, below, add));
        }
        // The map of densities is scaled to this mean. All of its points are filled as sparse infill, even dense ones.
        let map = self.graded.map(|graded| graded.of_mean(density.fraction()));
        let density = map.as_ref().map_or(density, |_| Density::Sparse(density.fraction()));
        // A density of zero is a hollow part.
        if density.fraction() <= 0.0 {
            return tally;
        }
        let role = if density.is_dense() { Role::SolidFill } else { Role::SparseFill };
        let several = self.several(density);
        let pattern = match &several {
            Some(several) => several,
            None => self.pattern(self.settings.infill.pattern),
        };
        let one_path = self.is_continuous();
        let graded = map.as_deref();
        let asked = RegionFill {
            density,
            graded,
            role,
            pattern,
            grain: self.grain,
            one_path,
            angle_rad: None,
            below,
        };
        let mut paths = Vec::new();
        for regions in split.sparse.chunk_by(|a, b| a.0 == b.0) {
            tally = tally.and(self.fill_island(i, regions, &asked, self.fibre, &mut paths));
            paths.drain(..).for_each(|p| add(regions[0].0, p));
        }
        tally
    }

    /// Lines of several beads at this density.
    fn several(&self, density: Density) -> Option<SideBySide> {
        let fitted = self.fitted.lock().unwrap_or_else(PoisonError::into_inner);
        fitted.get(&density.fraction().to_bits()).copied().or(self.settings.infill.several)
    }

    /// Fits the distance and the place of lines of several beads to the density, over layers that are spread over the height of the
    /// part. They depend on the part alone, so lines of all windows lie on each other. Where the job asks for a mass, the
    /// density has been fitted to it.
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub(super) fn fit_lines(&self, density: Density) -> Result<(), Interrupted> {
        let all = || {
            std::iter::once((self, density))
                .chain(self.regions.iter().map(move |r| (r, self.density_in(r, density))))
        };
        let wanted = |(steps, density): &(&Self, Density)| {
            let infill = &steps.settings.infill;
            let fitted = steps.fitted.lock().unwrap_or_else(PoisonError::into_inner);
            infill.several.is_some_and(|several| !several.pattern.follows_field())
                && steps.grain.is_none()
                && steps.fibre.is_none()
                && matches!(density, Density::Sparse(share) if *share > 0.0)
                && !fitted.contains_key(&density.fraction().to_bits())
        };
        if self.settings.infill.mass_g.is_some() || !all().any(|one| wanted(&one)) {
            return Ok(());
        }
        // Walls and skins of these layers are found once more, and their progress was counted before.
        let quiet = Diagnostics::default();
        let last = self.stack.layers().len().saturating_sub(1);
        let layers: BTreeSet<usize> = (0..FITTED_LAYERS).map(|k| k * last / (FITTED_LAYERS - 1)).collect();
        let mut splits = Vec::new();
        for &i in &layers {
            let mut walls = self.walls(i..i + 1, &quiet)?;
            splits.extend(self.skins(i..i + 1, &mut walls, &quiet)?.into_iter().map(|split| (i, split)));
        }
        for (k, (steps, density)) in all().enumerate().filter(|(_, one)| wanted(one)) {
            let own = |split: &SkinSplit| -> Vec<IslandPolygon> {
                let own = match k.checked_sub(1) {
                    None => Some(split),
                    Some(region) => split.regions.get(region),
                };
                own.map_or_else(Vec::new, |own| own.sparse.clone())
            };
            let areas: Vec<(usize, Vec<IslandPolygon>)> =
                splits.iter().map(|(i, split)| (*i, own(split))).collect();
            let mut regions: Vec<(FillContext<'_>, &Polygon)> = Vec::new();
            for (i, region) in areas.iter().flat_map(|(i, areas)| areas.iter().map(move |area| (*i, &area.1)))
            {
                let context = steps.context(i, density, Role::SparseFill);
                let border_mm = steps.border_of(i, context.border_mm, region);
                regions.push((FillContext { border_mm, ..context }, region));
            }
            if let Some(several) = steps.settings.infill.several {
                let fitted = several.fitted(&regions);
                let mut all = steps.fitted.lock().unwrap_or_else(PoisonError::into_inner);
                all.insert(density.fraction().to_bits(), fitted);
            }
        }
        Ok(())
    }

    /// Fills the infill regions of an island: with fibre where the job asks for fibre, and with matrix
    /// elsewhere.
    fn fill_island(
        &self,
        i: usize,
        regions: &[IslandPolygon],
        asked: &RegionFill<'_>,
        fibre: Option<&FibreSettings>,
        out: &mut Vec<Toolpath>,
    ) -> Tally {
        let mut context = self.context(i, asked.density, asked.role);
        context.angle_rad = asked.angle_rad.unwrap_or(context.angle_rad);
        context.below = asked.below;
        let Some(fibre) = fibre else {
            let regions: Vec<&Polygon> = regions.iter().map(|r| &r.1).collect();
            self.fill_regions(i, &context, &regions, asked, out);
            return Tally::default();
        };
        let z_mm = self.z_mid_mm(i);
        let matrix_mm = self.settings.walls.bead_width_mm;
        let (mut with, mut without) = (Vec::new(), Vec::new());
        for (_, region) in regions {
            let (a, b) = fibre.split((i, z_mm), context.height_mm, region, matrix_mm);
            with.extend(a);
            without.extend(b);
        }
        let f = &self.settings.infill;
        let density = f.matrix_density;
        // A matrix density of zero leaves the places without fibre empty.
        if density.fraction() > 0.0 {
            let (matrix, role) = match density {
                Density::Dense => (self.dense_pattern(f.matrix_pattern), asked.role),
                Density::Sparse(_) => (self.pattern(f.matrix_pattern), Role::SparseFill),
            };
            let context = self.context(i, density, role);
            without.iter().for_each(|region| matrix.fill(&context, region, out));
        }
        context.bead_width_mm = fibre.bead_width_mm;
        // Fibre has one width, so it cannot taper into a wedge, and lines along a field end where they have no room for it.
        context.fills_wedges = false;
        context.widths = BeadWidths::Constant;
        context.min_bead_width_mm = fibre.bead_width_mm;
        // Fibre beads and matrix beads have different widths, so their centrelines keep different
        // distances from the border of the area.
        context.border_mm += 0.5 * (fibre.bead_width_mm - matrix_mm);
        // The load at a point, for choosing the start of closed paths; without a guide it is 0 everywhere.
        let load = |p: DVec2| self.guide.map_or(0.0, |guide| guide.asked(i, p.extend(z_mm)).1);
        let mut rings = Vec::new();
        let rest = fibre.lay_rings(&with, context.height_mm, context.role, &mut rings);
        if fibre.rings > 0 {
            // Inside the rings, centrelines begin half a strip from the strips of the rings.
            context.border_mm = 0.5 * context.spacing_mm();
        }
        let mut lines = Vec::new();
        self.fill_regions(i, &context, &rest.iter().collect::<Vec<_>>(), asked, &mut lines);
        if !rings.is_empty() {
            lines.iter_mut().for_each(|p| p.rank += 1);
        }
        let place = FibrePlace {
            region: &Region { polygons: with },
            spacing_mm: context.spacing_mm(),
            load: &load,
            onward_mm: context.shift.onward_mm(),
            keep_closed: self.settings.infill.chain,
            rings: true,
        };
        let tally = fibre.lay(rings, &place, out);
        let rest = Region { polygons: rest };
        tally.and(fibre.lay(lines, &FibrePlace { region: &rest, rings: false, ..place }, out))
    }

    /// Fills infill regions with one material; as one path for the pattern `continuous`.
    fn fill_regions(
        &self,
        i: usize,
        context: &FillContext<'_>,
        regions: &[&Polygon],
        asked: &RegionFill<'_>,
        out: &mut Vec<Toolpath>,
    ) {
        if asked.one_path {
            let mut notes = Vec::new();
            let continuous = &self.settings.infill.continuous;
            match asked.graded {
                Some(map) => graded_infill::one_path(continuous, context, map, regions, out, &mut notes),
                None => {
                    let first = out.len();
                    continuous.lay_island(context, regions, out, &mut notes);
                    self.count(i, context, regions, &out[first..]);
                }
            }
            self.note(i, context.role, notes);
            return;
        }
        for region in regions {
            let first = out.len();
            let context =
                &FillContext { border_mm: self.border_of(i, context.border_mm, region), ..*context };
            match (asked.grain, asked.graded) {
                (_, Some(map)) => {
                    graded_infill::fill(self.settings.infill.pattern, context, map, region, out)
                }
                (Some(grain), None) => self.along_grain(grain, context, region, out),
                (None, None) => asked.pattern.fill(context, region, out),
            }
            if asked.graded.is_none() {
                self.count(i, context, &[region], &out[first..]);
            }
            // Rings are joined across one fixed distance; with graded density the distances differ.
            if self.settings.infill.spiral && asked.graded.is_none() {
                let mut rings = out.split_off(first);
                join_rings(&mut rings, context.spacing_mm() / context.density.fraction());
                out.append(&mut rings);
            }
        }
    }

    /// Counts the material of infill regions. Fibre tells its gaps apart, and lines along the grain and in fields that ask
    /// for distances do not keep to the density of the job.
    fn count(&self, i: usize, context: &FillContext<'_>, regions: &[&Polygon], laid: &[Toolpath]) {
        let asks = regions.first().is_some_and(|region| context.field_asks(region));
        // Patterns without a guide vary from part to part: a small part may hold one cell of a grid, or none.
        let is_told = self.settings.infill.pattern.follows_field() && self.fibre.is_none();
        if is_told && self.grain.is_none() && !asks {
            self.short_fill.add(i, context, regions, laid);
        }
    }

    /// Fills a region along the grain: along the edges of the picture, or with the job's pattern if
    /// that follows a field. For other patterns, dense infill is filled with stripes and sparse infill
    /// with evenly spaced lines.
    fn along_grain(
        &self,
        grain: &GrainGuide,
        context: &FillContext<'_>,
        region: &Polygon,
        out: &mut Vec<Toolpath>,
    ) {
        let z_mm = context.z_mid_mm;
        let axis = |p: DVec2| direction(grain.sample(p.extend(z_mm)).axis_rad);
        let sparseness = |p: DVec2| grain.sparseness(p.extend(z_mm));
        let flow = Flow { axis: &axis, sparseness: grain.has_darkness().then_some(&sparseness) };
        let pattern = self.settings.infill.pattern;
        match grain.mode {
            Mode::Edges => lay_curves(context, region, &grain.curves(z_mm), &flow, out),
            Mode::Field if pattern.follows_field() => self.pattern(pattern).fill(context, region, out),
            Mode::Field if context.density.is_dense() => Stripes.fill(context, region, out),
            Mode::Field => lay_curves(context, region, &[], &flow, out),
        }
    }

    /// Fills a bridge. If there is no direction in which both ends of the lines are held, they get that of skins.
    fn bridge(&self, i: usize, polygon: &Polygon, skin_rad: Option<f64>, out: &mut Vec<Toolpath>) {
        let mut context = self.context(i, Density::Dense, Role::Bridge);
        // The first layer has no bridges, so a layer below always exists.
        let below = self.stack.layers()[i - 1].region();
        let held = bridge_angle_rad(polygon, below, context.spacing_mm());
        context.angle_rad = held.or(skin_rad).unwrap_or(context.angle_rad);
        context.border_mm = self.border_of(i, context.border_mm, polygon);
        let first = out.len();
        Solid.fill(&context, polygon, out);
        for path in &mut out[first..] {
            path.flow = self.settings.infill.bridge_flow;
            path.speed = SpeedClass::Bridge;
        }
    }

    /// The implementation of this pattern for sparse infill.
    fn pattern(&self, pattern: Pattern) -> &dyn Infill {
        infill(pattern, &self.settings.infill.continuous)
    }

    /// The implementation of this pattern for dense regions. Straight lines fill skins over sparse
    /// infill. A part that is dense throughout, or has a guide, is filled by its own pattern.
    fn dense_pattern(&self, pattern: Pattern) -> &dyn Infill {
        match pattern {
            Pattern::Continuous => &self.settings.infill.continuous,
            Pattern::Concentric if self.settings.infill.density.is_dense() => &Concentric,
            Pattern::Stripes | Pattern::Streamlines => &Stripes,
            Pattern::SeedLines => &SeedLines,
            Pattern::Rectilinear
            | Pattern::Grid
            | Pattern::Triangles
            | Pattern::Gyroid
            | Pattern::Concentric
            | Pattern::Honeycomb
            | Pattern::Aligned => &Solid,
        }
    }

    /// Whether the infill of each island is one continuous path.
    fn is_continuous(&self) -> bool {
        self.settings.infill.pattern == Pattern::Continuous
            && self.grain.is_none_or(|g| g.mode == Mode::Field)
    }
}
