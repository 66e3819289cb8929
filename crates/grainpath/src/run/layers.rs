//! From sections to the paths of every layer: walls, skins, fill, supports, skirt and brim.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{
    BeadWidth, Bounds2, Density, Diagnostics, Layer, LayerStack, Role, SpeedClass, Toolpath, UniformField,
    Warning,
};
use rayon::prelude::*;

use crate::error::Error;
use crate::fibre::{FibreSettings, Tally};
use crate::fill::{Continuous, FillContext, Note};
use crate::guide::Guide;
use crate::guide::grain::GrainGuide;
use crate::order::{Island, LayerPaths};
use crate::support::beads::BeadSettings;
use crate::support::{self, Support};
use crate::wall::adhesion::{AdhesionSettings, brim, skirt};
use crate::wall::skin::{IslandPolygon, SkinInput, SkinSettings, SkinSplit, split_stack};
use crate::wall::{WallSettings, lay_walls};
use grainpath_core::mask::Mask;
use grainpath_job::Settings;
use grainpath_job::choices::{Pattern, SupportStyle};

/// Shorter closed walls are small, mm.
const SMALL_WALL_MM: f64 = 30.0;
/// Walls with more than this share of their length over air are overhangs.
const OVERHANG_SHARE: f64 = 0.25;

/// Columns and boxes are never hollow: their walls alone would not carry the layers of the part above.
const BASELINE_MIN_DENSITY: f64 = 0.15;

/// Fill, and the island each path lies in.
type IslandPaths = Vec<(usize, Toolpath)>;

/// The islands of a layer with their walls, and where its fill may lie.
type LayerWalls = (Vec<Island>, Vec<IslandPolygon>);

/// A job on its way from sections to paths.
pub(super) struct Job<'a> {
    pub settings: &'a Settings,
    pub stack: &'a LayerStack,
    pub part: Bounds2,
    pub support: Option<&'a Support>,
    pub guide: Option<&'a Guide>,
    pub grain: Option<&'a GrainGuide>,
    /// How fibre is laid, where any is.
    pub fibre: Option<&'a FibreSettings>,
    /// The field of `kind = "angle"`.
    pub uniform: UniformField,
    pub continuous: Continuous,
    /// What kept islands from being one path, by layer and role.
    pub notes: Mutex<BTreeMap<(usize, Role), Vec<Note>>>,
}

impl Job<'_> {
    fn wall_settings(&self, layer: &Layer) -> WallSettings {
        let p = &self.settings.process;
        WallSettings {
            n_walls: p.walls,
            bead_width_mm: p.bead_width_mm,
            height_mm: layer.height_mm(),
            thin_walls: p.thin_walls,
            gap_fill: p.gap_fill,
            min_bead_width_mm: p.min_bead_width_mm,
            fill_overlap: self.settings.fill.overlap,
        }
    }

    /// The walls of every layer, and where its fill may lie.
    pub(super) fn walls(&self, diagnostics: &Diagnostics) -> Result<Vec<LayerWalls>, Interrupted> {
        let of_layer = |layer: &Layer| {
            diagnostics.check()?;
            let settings = self.wall_settings(layer);
            let mut islands = Vec::with_capacity(layer.region().polygons.len());
            let mut fill = Vec::new();
            for (i, polygon) in layer.region().polygons.iter().enumerate() {
                let walls = lay_walls(polygon, &settings);
                fill.extend(walls.fill.polygons.into_iter().map(|p| (i, p)));
                islands.push(Island { walls: walls.loops, fills: walls.singles });
            }
            for wall in islands.iter_mut().flat_map(|i: &mut Island| &mut i.walls) {
                if wall.path.length_mm() < SMALL_WALL_MM {
                    wall.path.speed = SpeedClass::SmallWall;
                }
            }
            diagnostics.advance(1);
            Ok((islands, fill))
        };
        let all: Vec<Result<_, Interrupted>> =
            self.stack.layers().par_iter().with_min_len(2).map(of_layer).collect();
        all.into_iter().collect()
    }

    /// Divides the fill of every layer, and marks walls over air.
    pub(super) fn skins(
        &self,
        walls: &mut [Vec<Island>],
        fills: &[Vec<IslandPolygon>],
        diagnostics: &Diagnostics,
    ) -> Result<Vec<SkinSplit>, Interrupted> {
        let input: Vec<SkinInput<'_>> = self
            .stack
            .layers()
            .iter()
            .zip(fills)
            .map(|(layer, fill)| SkinInput { section: layer.region(), fill })
            .collect();
        let p = &self.settings.process;
        let settings = SkinSettings {
            top_layers: p.top_layers,
            bottom_layers: p.bottom_layers,
            spacing_mm: bead_spacing_mm(p.bead_width_mm, p.layer_height_mm),
            dense: self.settings.fill.density.is_dense() && self.settings.fill.mass_g.is_none(),
        };
        let walls: Vec<Mutex<&mut Vec<Island>>> = walls.iter_mut().map(Mutex::new).collect();
        // One path knows no skins: where all is dense it takes the whole room.
        let whole = self.settings.fill.pattern == Pattern::Continuous && settings.dense;
        split_stack(&input, self.part, &settings, diagnostics, |i, mut split| {
            if whole {
                split = SkinSplit { solid: fills[i].clone(), below: split.below, ..SkinSplit::default() };
            }
            if let Some(below) = split.below.take() {
                let mut islands = walls[i].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                islands
                    .iter_mut()
                    .flat_map(|i| &mut i.walls)
                    .for_each(|w| mark_overhang(&mut w.path, &below));
            }
            split
        })
    }

    /// Lays the fill of every layer.
    pub(super) fn fill(
        &self,
        walls: Vec<Vec<Island>>,
        skins: &[SkinSplit],
        density: Density,
        diagnostics: &Diagnostics,
    ) -> Result<Vec<LayerPaths>, Error> {
        let adhesion = self.adhesion();
        let like = self.alike(skins);
        // What was noted while a density was sought is of no matter.
        self.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clear();
        let lay = |i: usize| {
            diagnostics.check()?;
            let mut paths = Vec::new();
            let mut tally = Tally::default();
            if like[i] == i {
                let mut add = |island, path| paths.push((island, path));
                tally = self.dense_fill(i, &skins[i], &mut add);
                tally = tally.and(self.sparse_fill(i, &skins[i], density, &mut add));
            }
            diagnostics.advance(1);
            Ok((paths, tally))
        };
        let laid: Vec<Result<(IslandPaths, Tally), Interrupted>> = (0..walls.len())
            .into_par_iter()
            .with_min_len(if self.guide.is_some() { 1 } else { 2 })
            .map(lay)
            .collect();
        let (mut laid, tallies): (Vec<_>, Vec<_>) =
            laid.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        // Copies first: the layers they are copied from come later or are taken whole.
        for i in (0..laid.len()).rev().filter(|&i| like[i] != i) {
            laid[i] = laid[like[i]].clone();
        }
        if let Some(fibre) = self.fibre {
            let all = like.iter().map(|&i| tallies[i]).fold(Tally::default(), Tally::and);
            let any = laid.iter().flatten().any(|(_, p)| p.role == Role::Fibre);
            fibre.came_to(&all, any, diagnostics)?;
        }
        let mut supports: Vec<Vec<Island>> =
            (0..laid.len()).into_par_iter().map(|i| self.supports(i)).collect();
        let whole = |(i, (mut islands, paths)): (usize, (Vec<Island>, IslandPaths))| {
            paths.into_iter().for_each(|(island, path)| islands[island].fills.push(path));
            let adhesion = adhesion.get(i).cloned().unwrap_or_default();
            LayerPaths { adhesion, supports: std::mem::take(&mut supports[i]), islands }
        };
        Ok(walls.into_iter().zip(laid).enumerate().map(whole).collect())
    }

    /// For each layer the first one that has the same room and the same field, where the fill depends on nothing
    /// else.
    fn alike(&self, skins: &[SkinSplit]) -> Vec<usize> {
        let layers = self.stack.layers();
        let guided = self.grain.is_some() || self.settings.fill.pattern.follows_field();
        let mut like: Vec<usize> = (0..skins.len()).collect();
        if !guided {
            return like;
        }
        for i in 1..skins.len() {
            let same = |&j: &usize| {
                (layers[i].height_mm() - layers[j].height_mm()).abs() < 1e-9
                    && skins[i].bridge.is_empty()
                    && skins[i] == skins[j]
                    && self.guide.is_none_or(|g| g.same(i, j))
                    && self.grain.is_none_or(GrainGuide::is_upright)
                    && self.fibre.is_none_or(|f| f.same((i, self.z_mid_mm(i)), (j, self.z_mid_mm(j))))
            };
            if let Some(j) = (i.saturating_sub(2)..i).rev().find(same) {
                like[i] = like[j];
            }
        }
        like
    }

    pub(super) fn z_mid_mm(&self, layer_idx: usize) -> f64 {
        let layer = &self.stack.layers()[layer_idx];
        layer.z_top_mm() - 0.5 * layer.height_mm()
    }

    pub(super) fn context(&self, layer_idx: usize, density: Density, role: Role) -> FillContext<'_> {
        let layer = &self.stack.layers()[layer_idx];
        FillContext {
            z_mid_mm: self.z_mid_mm(layer_idx),
            height_mm: layer.height_mm(),
            bead_width_mm: self.settings.process.bead_width_mm,
            density,
            angle_rad: self.angle_rad(layer_idx, density),
            part: self.part,
            role,
            border_mm: self.border_mm(layer),
            field: Some(match (self.guide, self.grain) {
                (Some(guide), _) => guide.layer(layer_idx),
                (None, Some(grain)) => grain,
                (None, None) => &self.uniform,
            }),
        }
    }

    /// Warns of each kind of trouble once, at its first place, and says in how many layers more it is.
    pub(super) fn tell_notes(&self, diagnostics: &Diagnostics) {
        let all = self.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let mut told = Vec::new();
        for (&(layer_idx, _), note) in all.iter().flat_map(|(key, notes)| notes.iter().map(move |n| (key, n)))
        {
            let kind = std::mem::discriminant(&note.what);
            if told.contains(&kind) {
                continue;
            }
            told.push(kind);
            let same = |notes: &[Note]| notes.iter().any(|n| std::mem::discriminant(&n.what) == kind);
            let layers: BTreeSet<usize> =
                all.iter().filter(|(_, notes)| same(notes)).map(|(key, _)| key.0).collect();
            let more = match layers.len() - 1 {
                0 => String::new(),
                n => format!(" (and the like in {n} more)"),
            };
            let z_mm = self.stack.layers()[layer_idx].z_top_mm();
            let warning = note.warning().in_layer(layer_idx, z_mm);
            diagnostics.push(Warning { text: format!("{}{more}", warning.text), ..warning });
        }
    }

    /// The beads of the support in a layer.
    fn supports(&self, i: usize) -> Vec<Island> {
        let Some(layer) = self.support.map(|s| &s.cut.layers[i]) else { return Vec::new() };
        let s = &self.settings.support;
        let settings = BeadSettings {
            bead_width_mm: self.settings.process.bead_width_mm,
            min_bead_width_mm: self.settings.process.min_bead_width_mm,
            walls: s.walls,
            density: Density::new(match s.style {
                SupportStyle::None | SupportStyle::Tree => s.density,
                SupportStyle::Columns | SupportStyle::Box => s.density.max(BASELINE_MIN_DENSITY),
            }),
        };
        let context = self.context(i, Density::Dense, Role::Support);
        support::beads::lay(layer, &context, i < s.dense_layers, &settings)
    }

    /// Skirt and brim of the layers that have any.
    fn adhesion(&self) -> Vec<Vec<Toolpath>> {
        let p = &self.settings.process;
        let Some(first) = self.stack.layers().first() else { return Vec::new() };
        let settings = AdhesionSettings {
            brim_width_mm: p.brim_width_mm,
            skirt_loops: p.skirt_loops,
            skirt_distance_mm: p.skirt_distance_mm,
            bead_width_mm: p.bead_width_mm,
            height_mm: first.height_mm(),
        };
        let standing = match self.support {
            Some(s) => first.region().union(&s.cut.layers[0].region),
            None => first.region().clone(),
        };
        let skirts = if p.skirt_loops > 0 { skirt(&standing, &settings) } else { Vec::new() };
        let n = if p.skirt_loops > 0 { p.skirt_layers.min(self.stack.layers().len()) } else { 1 };
        let mut all = vec![skirts; n];
        if p.brim_width_mm > 0.0 {
            all[0].extend(brim(&standing, &settings));
        }
        all
    }
}

/// Marks a wall as overhanging when enough of it lies over air.
fn mark_overhang(path: &mut Toolpath, below: &Mask) {
    let (mut free, mut all) = (0.0, 0.0);
    for i in 0..path.n_segments() {
        let (a, b, _) = path.segment(i);
        let length = a.distance(b);
        all += length;
        if !below.contains(0.5 * (a + b)) {
            free += length;
        }
    }
    if free > OVERHANG_SHARE * all {
        path.speed = SpeedClass::Overhang;
    }
    debug_assert!(matches!(path.width, BeadWidth::Constant(_)));
}
