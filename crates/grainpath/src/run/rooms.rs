//! The fill of the rooms inside the walls: dense and sparse, straight, along a field or the grain, with fibre.

use grainpath_core::math::direction;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{DVec2, DirectionField, Layer, Polygon, Region, Role, SpeedClass, Toolpath};
use grainpath_job::choices::GUIDED;

use super::layers::Job;
use crate::fibre::{FibreSettings, Tally};
use crate::fill::curves::{Flow, lay_curves};
use crate::fill::{FillContext, Infill, Solid, Stripes, bridge_angle_rad, pattern};
use crate::guide::grain::GrainGuide;
use crate::guide::grain::Mode;
use crate::wall::skin::{IslandPolygon, SkinSplit};

/// How a room is to be filled.
struct Wanted<'a> {
    density: f64,
    role: Role,
    pattern: Option<&'a dyn Infill>,
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
    pub(super) fn angle_rad(&self, layer_idx: usize, density: f64) -> f64 {
        let s = self.settings;
        let turns = density >= 0.999 || s.fill.pattern == "rectilinear";
        let turns = turns && s.fill.pattern != "aligned";
        let angles = &s.fill.angles_deg;
        let deg = if s.guide.kind == "angle" {
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
        let all_dense = fill.density >= 0.999;
        // Skins over sparse fill stay straight lines without fibre: they close the part.
        let grain = self.grain.filter(|_| all_dense);
        let fibre = self.fibre.filter(|_| all_dense);
        for (polygons, role) in [(&split.solid, Role::SolidFill), (&split.top, Role::TopSkin)] {
            let asked =
                Wanted { density: 1.0, role, pattern: Some(self.dense_pattern(&fill.pattern)), grain };
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
        density: f64,
        add: &mut dyn FnMut(usize, Toolpath),
    ) -> Tally {
        let mut tally = Tally::default();
        if density <= 0.0 {
            return tally;
        }
        let role = if density >= 0.999 { Role::SolidFill } else { Role::SparseFill };
        let pattern = self.pattern(&self.settings.fill.pattern);
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
        if density > 0.0 {
            let dense = density >= 0.999;
            let role = if dense { asked.role } else { Role::SparseFill };
            let name = f.matrix_pattern.as_str();
            let matrix = if dense { Some(self.dense_pattern(name)) } else { self.pattern(name) };
            if let Some(matrix) = matrix {
                let context = self.context(i, density, role);
                without.iter().for_each(|room| matrix.fill(&context, room, out));
            }
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
            match (asked.grain, asked.pattern) {
                (Some(grain), _) => self.along_grain(grain, context, room, out),
                (None, Some(pattern)) => pattern.fill(context, room, out),
                (None, None) => {}
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
        let name = self.settings.fill.pattern.as_str();
        match (grain.mode, self.pattern(name).filter(|_| GUIDED.contains(&name))) {
            (Mode::Edges, _) => lay_curves(context, room, &grain.curves(z_mm), &flow, out),
            (Mode::Field, Some(asked)) => asked.fill(context, room, out),
            (Mode::Field, None) if context.density >= 0.999 => Stripes.fill(context, room, out),
            (Mode::Field, None) => lay_curves(context, room, &[], &flow, out),
        }
    }

    fn bridge(&self, i: usize, polygon: &Polygon, out: &mut Vec<Toolpath>) {
        let mut context = self.context(i, 1.0, Role::Bridge);
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

    /// A pattern for the inside.
    fn pattern(&self, name: &str) -> Option<&dyn Infill> {
        match name {
            "continuous" => Some(&self.continuous),
            name => pattern(name).map(|p| p as &dyn Infill),
        }
    }

    /// Dense fill beside sparse one is plain; where all is dense it is the pattern asked for, and a part with a
    /// guide follows it in its skins too.
    fn dense_pattern(&self, name: &str) -> &dyn Infill {
        match name {
            "continuous" => &self.continuous,
            "concentric" if self.settings.fill.density >= 0.999 => &crate::fill::Concentric,
            "stripes" | "streamlines" => &Stripes,
            "seed-lines" => &crate::fill::SeedLines,
            _ => &Solid,
        }
    }

    /// Whether all fill of an island is to be one path.
    fn is_continuous(&self) -> bool {
        self.settings.fill.pattern == "continuous" && self.grain.is_none_or(|g| g.mode == Mode::Field)
    }
}
