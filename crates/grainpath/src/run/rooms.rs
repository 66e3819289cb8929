//! The fill of the rooms inside the walls: dense and sparse, straight, along a field or the grain, with fibre.

use grainpath_core::math::direction;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{DVec2, Density, DirectionField, Layer, Polygon, Region, Role, SpeedClass, Toolpath};
use grainpath_job::choices::{GuideKind, Pattern};

use super::layers::Job;
use crate::fibre::{FibreSettings, Tally};
use crate::fill::curves::{Flow, lay_curves};
use crate::fill::{Concentric, FillContext, Infill, SeedLines, Solid, Stripes, bridge_angle_rad, infill};
use crate::guide::grain::GrainGuide;
use crate::guide::grain::Mode;
use crate::wall::skin::{IslandPolygon, SkinSplit};

/// How a room is to be filled.
struct Wanted<'a> {
    density: Density,
    role: Role,
    pattern: &'a dyn Infill,
    grain: Option<&'a GrainGuide>,
}

impl Job<'_> {
    /// How far what fill is to fill reaches beyond the room of its centrelines: to the strips of the walls, and a
    /// little more for what the round edge of the outer wall leaves out, so that the layer has the part's volume.
    pub(super) fn border_mm(&self, layer: &Layer) -> f64 {
        let w = self.settings.process.bead_width_mm;
        let s = bead_spacing_mm(w, layer.height_mm());
        if self.settings.process.walls == 0 {
            return 0.5 * w;
        }
        (0.5 - self.settings.fill.overlap) * s + 0.5 * (w - s)
    }

    /// The direction of a layer's lines. Crossed patterns and `aligned` keep the first angle of the list.
    pub(super) fn angle_rad(&self, layer_idx: usize, density: Density) -> f64 {
        let s = self.settings;
        let turns = density.is_dense() || s.fill.pattern == Pattern::Rectilinear;
        let turns = turns && s.fill.pattern != Pattern::Aligned;
        let angles = &s.fill.angles_deg;
        let deg = if s.guide.kind == GuideKind::Angle {
            s.guide.angle_deg
        } else {
            angles[if turns { layer_idx % angles.len() } else { 0 }]
        };
        deg.to_radians()
    }

    /// Skins, bridges, and the inside where it is dense.
    pub(super) fn dense_fill(
        &self,
        i: usize,
        split: &SkinSplit,
        add: &mut dyn FnMut(usize, Toolpath),
    ) -> Tally {
        let mut paths = Vec::new();
        let mut tally = Tally::default();
        let fill = &self.settings.fill;
        let all_dense = fill.density.is_dense();
        // Skins over sparse fill stay straight lines without fibre: they close the part.
        let grain = self.grain.filter(|_| all_dense);
        let fibre = self.fibre.filter(|_| all_dense);
        for (polygons, role) in [(&split.solid, Role::SolidFill), (&split.top, Role::TopSkin)] {
            let pattern = self.dense_pattern(fill.pattern);
            let asked = Wanted { density: Density::Dense, role, pattern, grain };
            for rooms in polygons.chunk_by(|a, b| a.0 == b.0) {
                tally = tally.and(self.rooms(i, rooms, &asked, fibre, &mut paths));
                paths.drain(..).for_each(|p| add(rooms[0].0, p));
            }
        }
        for (island, polygon) in &split.bridge {
            self.bridge(i, polygon, &mut paths);
            paths.drain(..).for_each(|p| add(*island, p));
        }
        tally
    }

    pub(super) fn sparse_fill(
        &self,
        i: usize,
        split: &SkinSplit,
        density: Density,
        add: &mut dyn FnMut(usize, Toolpath),
    ) -> Tally {
        let mut tally = Tally::default();
        if density.fraction() <= 0.0 {
            return tally;
        }
        let role = if density.is_dense() { Role::SolidFill } else { Role::SparseFill };
        let pattern = self.pattern(self.settings.fill.pattern);
        let asked = Wanted { density, role, pattern, grain: self.grain };
        let mut paths = Vec::new();
        for rooms in split.sparse.chunk_by(|a, b| a.0 == b.0) {
            tally = tally.and(self.rooms(i, rooms, &asked, self.fibre, &mut paths));
            paths.drain(..).for_each(|p| add(rooms[0].0, p));
        }
        tally
    }

    /// Fills the rooms of an island, with fibre where that is asked for and the matrix around it.
    fn rooms(
        &self,
        i: usize,
        rooms: &[IslandPolygon],
        asked: &Wanted<'_>,
        fibre: Option<&FibreSettings>,
        out: &mut Vec<Toolpath>,
    ) -> Tally {
        let mut context = self.context(i, asked.density, asked.role);
        let Some(fibre) = fibre else {
            let rooms: Vec<&Polygon> = rooms.iter().map(|r| &r.1).collect();
            self.fill_rooms(i, &context, &rooms, asked, out);
            return Tally::default();
        };
        let z_mm = self.z_mid_mm(i);
        let matrix_mm = self.settings.process.bead_width_mm;
        let (mut with, mut without) = (Vec::new(), Vec::new());
        for (_, room) in rooms {
            let (a, b) = fibre.split((i, z_mm), context.height_mm, room, matrix_mm);
            with.extend(a);
            without.extend(b);
        }
        let f = &self.settings.fibre;
        let density = f.matrix_density;
        if density.fraction() > 0.0 {
            let (matrix, role) = match density {
                Density::Dense => (self.dense_pattern(f.matrix_pattern), asked.role),
                Density::Sparse(_) => (self.pattern(f.matrix_pattern), Role::SparseFill),
            };
            let context = self.context(i, density, role);
            without.iter().for_each(|room| matrix.fill(&context, room, out));
        }
        context.bead_width_mm = fibre.bead_width_mm;
        context.border_mm += 0.5 * (fibre.bead_width_mm - matrix_mm);
        let load = |p: DVec2| self.guide.map_or(0.0, |guide| guide.asked(i, p.extend(z_mm)).1);
        let mut paths = Vec::new();
        self.fill_rooms(i, &context, &with.iter().collect::<Vec<_>>(), asked, &mut paths);
        fibre.lay(paths, &Region { polygons: with }, &load, self.settings.process.chain, out)
    }

    /// Fills the rooms of an island; as one path where that is asked for and can be.
    fn fill_rooms(
        &self,
        i: usize,
        context: &FillContext<'_>,
        rooms: &[&Polygon],
        asked: &Wanted<'_>,
        out: &mut Vec<Toolpath>,
    ) {
        if self.is_continuous() {
            let mut notes = Vec::new();
            self.continuous.lay_island(context, rooms, out, &mut notes);
            if !notes.is_empty() {
                let mut all = self.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                all.entry((i, context.role)).or_default().extend(notes);
            }
            return;
        }
        for room in rooms {
            match asked.grain {
                Some(grain) => self.along_grain(grain, context, room, out),
                None => asked.pattern.fill(context, room, out),
            }
        }
    }

    /// Fills a room with the grain: the picture's edges, the guided pattern asked for, or else stripes where it is
    /// dense and lines at even distances where it is not.
    fn along_grain(
        &self,
        grain: &GrainGuide,
        context: &FillContext<'_>,
        room: &Polygon,
        out: &mut Vec<Toolpath>,
    ) {
        let z_mm = context.z_mid_mm;
        let axis = |p: DVec2| direction(grain.sample(p.extend(z_mm)).axis_rad);
        let sparseness = |p: DVec2| grain.sparseness(p.extend(z_mm));
        let flow = Flow { axis: &axis, sparseness: grain.has_darkness().then_some(&sparseness) };
        let pattern = self.settings.fill.pattern;
        match grain.mode {
            Mode::Edges => lay_curves(context, room, &grain.curves(z_mm), &flow, out),
            Mode::Field if pattern.follows_field() => self.pattern(pattern).fill(context, room, out),
            Mode::Field if context.density.is_dense() => Stripes.fill(context, room, out),
            Mode::Field => lay_curves(context, room, &[], &flow, out),
        }
    }

    fn bridge(&self, i: usize, polygon: &Polygon, out: &mut Vec<Toolpath>) {
        let mut context = self.context(i, Density::Dense, Role::Bridge);
        let below = self.stack.layers()[i - 1].region();
        if let Some(angle) = bridge_angle_rad(polygon, below, context.spacing_mm()) {
            context.angle_rad = angle;
        }
        let first = out.len();
        Solid.fill(&context, polygon, out);
        for path in &mut out[first..] {
            path.flow = self.settings.process.bridge_flow;
            path.speed = SpeedClass::Bridge;
        }
    }

    /// The code that lays sparse infill in this pattern.
    fn pattern(&self, pattern: Pattern) -> &dyn Infill {
        match pattern {
            Pattern::Continuous => &self.continuous,
            Pattern::Rectilinear
            | Pattern::Grid
            | Pattern::Triangles
            | Pattern::Gyroid
            | Pattern::Concentric
            | Pattern::Honeycomb
            | Pattern::Aligned
            | Pattern::Stripes
            | Pattern::Streamlines
            | Pattern::SeedLines => infill(pattern),
        }
    }

    /// The code that lays dense regions in this pattern. Straight lines fill skins over sparse infill; a part that is
    /// dense throughout, or has a guide, is filled by its own pattern.
    fn dense_pattern(&self, pattern: Pattern) -> &dyn Infill {
        match pattern {
            Pattern::Continuous => &self.continuous,
            Pattern::Concentric if self.settings.fill.density.is_dense() => &Concentric,
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

    /// Whether all fill of an island is to be one path.
    fn is_continuous(&self) -> bool {
        self.settings.fill.pattern == Pattern::Continuous && self.grain.is_none_or(|g| g.mode == Mode::Field)
    }
}
