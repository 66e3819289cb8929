//! The steps from sections to the paths of each layer: walls, skins, infill, supports, skirt and brim.
//!
//! Each step is a function over a window of layers, which is a range of layer indices. It returns
//! one result for each layer of the window, in order. A caller can plan a part of any height with
//! the paths of a few layers in memory, spread windows over several machines, or plan again only
//! the layers that a changed setting concerns.
//!
//! | step | needs of other layers |
//! |---|---|
//! | sections ([`crate::shape::Slicer::sections`]) | nothing |
//! | walls ([`Steps::walls`]) | nothing |
//! | skins ([`Steps::skins`]) | the sections of `top_layers` layers above and `bottom_layers` below |
//! | infill ([`Steps::infill`]) | the section below, for bridges |
//! | order ([`crate::order::order_window`]) | the nozzle and the seams of the layer below, in an `OrderState` |
//!
//! Sections are compact and are kept for the whole part. Two things are computed for the whole part
//! before the first window: the guide, and the density of a job that asks for a mass.
//!
//! Cost: each step is linear in the number of layers, except that each window rebuilds the masks of
//! the sections next to it. Layers run in parallel within a window, so very small windows use fewer
//! threads.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Mutex;

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::mask::Mask;
use grainpath_core::{
    Bounds2, Density, Diagnostics, DirectionField, Layer, LayerPlan, LayerStack, Region, Role, SpeedClass,
    Toolpath, UniformField, Warning,
};
use grainpath_job::choices::{BeadEnds, BeadWidths, Pattern};
use rayon::prelude::*;

use crate::fibre::{FibreSettings, Tally};
use crate::fill::shift::{Ends, TURNS};
use crate::fill::{
    Continuous, FillContext, LinesBelow, Note, Shift, SideBySide, graded_infill, is_streamlines,
};
use crate::guide::Guide;
use crate::guide::given_field::FieldGuide;
use crate::guide::graded_density::{DensityMap, GradedDensity};
use crate::guide::grain::{GrainGuide, Mode};
use crate::order::{Island, LayerPaths, OrderSettings, OrderState, order_window};
use crate::region::RegionAreas;
use crate::run::short_fill::ShortFill;
use crate::support::beads::BeadSettings;
use crate::support::{self, Support};
use crate::wall::adhesion::{AdhesionSettings, brim, skirt};
use crate::wall::divided::{Share, lay_divided};
use crate::wall::graded_walls::lay_graded;
use crate::wall::skin::{IslandPolygon, SkinSettings, SkinSplit, split_window};
use crate::wall::stagger::stagger;
use crate::wall::{Wall, WallSettings};

/// Closed walls shorter than this are printed at the speed of small walls, mm.
const SMALL_WALL_MM: f64 = 30.0;
/// Walls with more than this fraction of their length over air are printed at the speed of overhangs.
const OVERHANG_SHARE: f64 = 0.25;

/// Number of layers at the end of a window over that at its beginning, where layers are wanted early. Source: chosen; the
/// programs of all windows but the last then have at most a third more layers than the largest of them.
const GROWTH: usize = 4;

/// Infill of one layer, each path with the number of its island.
pub(super) type IslandPaths = Vec<(usize, Toolpath)>;

/// The walls of one layer, and the area for its infill.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LayerWalls {
    /// The islands of the layer, in the order of its section's polygons.
    pub islands: Vec<Island>,
    /// Areas for the centrelines of infill outside all regions.
    pub fill: Vec<IslandPolygon>,
    /// Areas for the centrelines of infill in each region; empty where none meets the layer.
    pub regions: Vec<Vec<IslandPolygon>>,
}

/// Settings of the steps from sections to paths.
#[derive(Debug, Clone, PartialEq)]
pub struct StepSettings {
    /// Walls; the height is replaced by that of each layer.
    pub walls: WallSettings,
    /// Number of walls where the stress is highest; equal to the number in `walls` if it is the same everywhere.
    pub most_walls: usize,
    /// Whether every other wall stands half a layer higher.
    pub stagger_walls: bool,
    /// Skins.
    pub skins: SkinSettings,
    /// Infill.
    pub infill: InfillSettings,
    /// Beads of supports.
    pub supports: BeadSettings,
    /// Skirt and brim; the height is replaced by that of the first layer.
    pub adhesion: AdhesionSettings,
    /// Number of layers with a skirt.
    pub skirt_layers: usize,
    /// Regions with settings of their own.
    pub regions: Vec<RegionSettings>,
}

/// The settings that hold in a region.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionSettings {
    /// Settings of the steps in the region.
    pub steps: StepSettings,
    /// Whether infill follows the guide.
    pub guided: bool,
}

/// Settings of infill.
#[derive(Debug, Clone, PartialEq)]
pub struct InfillSettings {
    /// The pattern.
    pub pattern: Pattern,
    /// Density of the job; replaced where the job asks for a mass, and where the density is graded.
    pub density: Density,
    /// Whether the density is graded.
    pub graded: bool,
    /// Required mass of the part, g.
    pub mass_g: Option<f64>,
    /// Properties of the extruded material.
    pub material: ExtrudedMass,
    /// Properties of beads with fibre.
    pub fibre_material: ExtrudedMass,
    /// Raster angles.
    pub angles: RasterAngles,
    /// Raster angles of skins over sparse infill, which are then laid as straight lines. With `None`, skins are laid
    /// like dense infill.
    pub skin_angles: Option<RasterAngles>,
    /// Sparse lines made of several beads side by side; `None` for lines of one bead.
    pub several: Option<SideBySide>,
    /// The direction of all infill, where the guide is one angle.
    pub guide_angle_rad: Option<f64>,
    /// Direction for patterns that follow a field, where no guide gives one.
    pub field_axis_rad: f64,
    /// Factor on the extrusion of bridges.
    pub bridge_flow: f64,
    /// The longest span that the printer bridges, mm.
    pub max_unsupported_mm: f64,
    /// Whether fibre begins at the point where it ended in the layer below.
    pub chain: bool,
    /// Pattern of infill without fibre, in layers and places with fibre.
    pub matrix_pattern: Pattern,
    /// Density of the infill without fibre.
    pub matrix_density: Density,
    /// Ends of beads along a guide.
    pub ends: BeadEnds,
    /// Widths of beads along a guide.
    pub widths: BeadWidths,
    /// Which ends of beads differ from layer to layer.
    pub layer_shift: Option<Ends>,
    /// Whether closed rings are opened and joined, each to the next.
    pub spiral: bool,
    /// Cells and widths of the pattern `continuous`.
    pub continuous: Continuous,
}

impl InfillSettings {
    /// Whether sparse lines of this density follow a field from layer to layer.
    pub(super) fn lines_go_on(&self, density: Density) -> bool {
        matches!(self.pattern, Pattern::Stripes | Pattern::Streamlines)
            && self.several.is_none()
            && (self.graded || is_streamlines(density))
    }
}

/// Raster angles for ranges of layers. Within a range the angles are used in turn, layer by layer.
#[derive(Debug, Clone, PartialEq)]
pub struct RasterAngles {
    /// For each range of layers, from the bed upwards: its first layer, counted from 0, and its angles in radians. The
    /// angle is 0 in a layer below all ranges and in a range without angles.
    pub ranges: Vec<(usize, Vec<f64>)>,
}

impl RasterAngles {
    /// The angle of a layer; `layer_idx` counts from 0. If the pattern does not `turn`, it is the first angle of the range.
    ///
    /// ```
    /// use grainpath::run::RasterAngles;
    /// use std::f64::consts::FRAC_PI_4;
    /// // 45 and 135 degrees in turn, and from the fifth layer on 0.
    /// let angles = RasterAngles { ranges: vec![(0, vec![FRAC_PI_4, 3.0 * FRAC_PI_4]), (4, vec![0.0])] };
    /// assert_eq!(angles.of_layer(1, true), 3.0 * FRAC_PI_4);
    /// assert_eq!(angles.of_layer(1, false), FRAC_PI_4);
    /// assert_eq!(angles.of_layer(7, true), 0.0);
    /// ```
    pub fn of_layer(&self, layer_idx: usize, turn: bool) -> f64 {
        let Some((first, angles)) = self.ranges.iter().rev().find(|r| r.0 <= layer_idx) else { return 0.0 };
        let turns = if turn { layer_idx - first } else { 0 };
        turns.checked_rem(angles.len()).map_or(0.0, |k| angles[k])
    }
}

/// Density and flow, which turn the volume of a path into its mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtrudedMass {
    /// Mass density, g/cm3.
    pub density_g_cm3: f64,
    /// Factor on all extrusion.
    pub flow: f64,
}

/// A part on its way from sections to paths. Each step is a method over a window of layers.
///
/// ```
/// use grainpath::order::{OrderState, order_window};
/// use grainpath::run::{Steps, config};
/// use grainpath_core::{DVec2, Density, Diagnostics, Layer, LayerStack, Region};
/// use grainpath_job::Settings;
///
/// let section = || Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 10.0));
/// let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section()).unwrap();
/// let stack = LayerStack::new((0..9).map(layer).collect()).unwrap();
///
/// let settings = Settings::default();
/// let (step_settings, order) = (config::steps(&settings), config::order(&settings));
/// let steps = Steps::new(&step_settings, &stack);
/// let (diagnostics, window) = (Diagnostics::default(), 3..6);
/// let mut walls = steps.walls(window.clone(), &diagnostics).unwrap();
/// let skins = steps.skins(window.clone(), &mut walls, &diagnostics).unwrap();
/// let filled = steps.infill(window.clone(), walls, skins, Density::new(0.2), &diagnostics).unwrap();
/// assert!(!filled.layers[1].islands[0].fills.is_empty());
/// let mut state = OrderState::new(&order);
/// let plans = order_window(stack.layers(), window, filled.layers, &order, &mut state, &diagnostics).unwrap();
/// assert_eq!(plans.len(), 3);
/// ```
pub struct Steps<'a> {
    pub(super) settings: &'a StepSettings,
    pub(super) stack: &'a LayerStack,
    pub(super) part: Bounds2,
    support: Option<&'a Support>,
    pub(super) guide: Option<&'a Guide>,
    pub(super) grain: Option<&'a GrainGuide>,
    field: Option<&'a FieldGuide>,
    /// The density, where it is graded.
    pub(super) graded: Option<&'a GradedDensity>,
    /// Stress as a share of the material's strength, for jobs in which the number of walls depends on it.
    stress_share: Option<&'a DensityMap>,
    /// Settings of fibre, for jobs with fibre.
    pub(super) fibre: Option<&'a FibreSettings>,
    /// Constant field for patterns that follow directions, where no guide gives one.
    uniform: UniformField,
    /// The areas of the regions in each layer.
    pub(super) areas: Option<&'a RegionAreas>,
    /// The steps of each region, for their infill.
    pub(super) regions: Vec<Steps<'a>>,
    /// Reasons why islands could not be laid as one path, by layer and role.
    notes: Mutex<BTreeMap<(usize, Role), Vec<Note>>>,
    /// Lines of several beads, fitted to the volume of a density (the bits of the number).
    pub(super) fitted: Mutex<BTreeMap<u64, SideBySide>>,
    /// Material of infill regions beside what their density asks for.
    pub(super) short_fill: ShortFill,
}

/// The paths of a window of layers.
#[derive(Debug, Default)]
pub struct FilledLayers {
    /// The paths of each layer, not yet in order.
    pub layers: Vec<LayerPaths>,
    /// Outcome for the paths that were to carry fibre.
    pub fibre: Tally,
    /// Area of the sparse infill outside regions in layers in which skins grew over some of it, by the index of the layer; known
    /// for a graded density.
    pub sparse_areas: BTreeMap<usize, Region>,
}

/// Layers whose infill is a copy of that of an earlier layer, and the infill that later windows copy.
struct Copies {
    /// Layer of the first entry of `of`.
    first: usize,
    /// For each layer the layer that it copies, counted from `first`; itself where it is laid.
    of: Vec<usize>,
    /// Infill of earlier windows that layers still to come copy, with its fibre.
    laid: BTreeMap<usize, (IslandPaths, Tally)>,
}

/// Sparse lines along a field in the highest layer of each turn of directions ([`Guide::turn_of`]).
type BelowByTurn = BTreeMap<usize, LinesBelow>;

impl Copies {
    /// The layer that a layer copies.
    fn original(&self, layer_idx: usize) -> usize {
        self.first + self.of[layer_idx - self.first]
    }

    /// The layers that are copied by others from this one on.
    fn needed_from(&self, layer_idx: usize) -> BTreeSet<usize> {
        (layer_idx..self.first + self.of.len()).map(|k| self.original(k)).filter(|k| *k < layer_idx).collect()
    }
}

impl<'a> Steps<'a> {
    /// The steps of a part without supports, fibre and guide.
    pub fn new(settings: &'a StepSettings, stack: &'a LayerStack) -> Self {
        Self {
            settings,
            stack,
            part: super::placing::part_bounds(stack),
            support: None,
            guide: None,
            grain: None,
            field: None,
            graded: None,
            stress_share: None,
            fibre: None,
            uniform: UniformField { axis_rad: settings.infill.field_axis_rad },
            areas: None,
            regions: Vec::new(),
            notes: Mutex::default(),
            fitted: Mutex::default(),
            short_fill: ShortFill::default(),
        }
    }

    /// Adds supports.
    ///
    /// ```
    /// use grainpath::support::Support;
    /// use grainpath::support::cut::{Layers, SupportLayer};
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{DVec2, Density, Diagnostics, Region};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let (settings, diagnostics) = (config::steps(&Default::default()), Diagnostics::default());
    /// // A square of support beside the part, in each layer.
    /// let beside = || Region::rectangle(DVec2::new(25.0, 0.0), DVec2::new(35.0, 10.0));
    /// let layers = (0..12).map(|_| SupportLayer { region: beside(), ..SupportLayer::default() }).collect();
    /// let support = Support { cut: Layers { layers, ..Layers::default() }, ..Support::default() };
    /// let steps = Steps::new(&settings, &stack).with_support(Some(&support));
    /// let mut walls = steps.walls(5..6, &diagnostics).unwrap();
    /// let skins = steps.skins(5..6, &mut walls, &diagnostics).unwrap();
    /// let filled = steps.infill(5..6, walls, skins, Density::new(0.2), &diagnostics).unwrap();
    /// assert!(!filled.layers[0].supports.is_empty());
    /// ```
    #[must_use]
    pub fn with_support(self, support: Option<&'a Support>) -> Self {
        Self { support, ..self }
    }

    /// Guides infill by stress or by grain. Where both are given, stress prevails.
    ///
    /// ```
    /// use grainpath::{Inputs, plan_job};
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{Density, Diagnostics};
    /// # let diagnostics = Diagnostics::default();
    /// // The guide of a box of 20 x 10 x 2 mm that is pulled along x.
    /// let job = r#"
    ///     fill.pattern = "streamlines"
    ///     guide.kind = "stress"
    ///     [[guide.fixture]]
    ///     on = { plane = { point_mm = [0, 0, 0], normal = [1, 0, 0] } }
    ///     fix = "xyz"
    ///     [[guide.load]]
    ///     on = { plane = { point_mm = [20, 0, 0], normal = [1, 0, 0] } }
    ///     force_n = [100, 0, 0]
    /// "#;
    /// let settings = grainpath_job::parse_job(job, "job.toml", &[], &|_| Err(String::new())).unwrap();
    /// # let inputs = Inputs {
    /// #     mesh: grainpath_parts::file_of_a_box(),
    /// #     path: "box.stl".into(),
    /// #     stress: None,
    /// #     deck: None,
    /// #     directions: None,
    /// #     densities: None,
    /// #     photos: Vec::new(),
    /// #     texture: None,
    /// #     regions: Default::default(),
    /// #     known: None,
    /// # };
    /// let planned = plan_job(&settings, inputs, &diagnostics).unwrap();
    /// // The same guide serves further plans of the part, here with denser infill.
    /// let steps = config::steps(&settings);
    /// let steps = Steps::new(&steps, &planned.stack).with_guide(planned.guide.as_ref(), None);
    /// let mut walls = steps.walls(5..6, &diagnostics).unwrap();
    /// let skins = steps.skins(5..6, &mut walls, &diagnostics).unwrap();
    /// let filled = steps.infill(5..6, walls, skins, Density::new(0.5), &diagnostics).unwrap();
    /// // The beads lie along the tension.
    /// let (mut along_x_mm, mut length_mm) = (0.0, 0.0);
    /// for bead in &filled.layers[0].islands[0].fills {
    ///     along_x_mm += (0..bead.n_segments()).map(|i| (bead.segment(i).1 - bead.segment(i).0).x.abs()).sum::<f64>();
    ///     length_mm += bead.length_mm();
    /// }
    /// assert!(length_mm > 0.0 && along_x_mm > 0.95 * length_mm, "{along_x_mm} of {length_mm} mm");
    /// ```
    #[must_use]
    pub fn with_guide(self, guide: Option<&'a Guide>, grain: Option<&'a GrainGuide>) -> Self {
        Self { guide, grain, ..self }
    }

    /// Guides infill by the user's own directions, where no other guide is given.
    ///
    /// ```
    /// use grainpath::guide::given_field::{FieldGuide, FieldSettings};
    /// use grainpath_io::directions::{DirectionOptions, parse_directions};
    /// use grainpath_job::choices::Pattern;
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{Density, Diagnostics};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let (mut settings, diagnostics) = (config::steps(&Default::default()), Diagnostics::default());
    /// let place = FieldSettings::AS_IN_FILE;
    /// // A table that asks for 30 degrees everywhere; `place` says that it has the coordinates of the part.
    /// let table = b"x,y,angle_deg\n0,0,30\n20,0,30\n0,10,30\n20,10,30\n";
    /// let samples = parse_directions(&[("axes.csv", table)], &DirectionOptions::default()).unwrap();
    /// let field = FieldGuide::new(samples, &place, &stack, &diagnostics).unwrap();
    /// settings.infill.pattern = Pattern::Streamlines;
    /// let steps = Steps::new(&settings, &stack).with_field(Some(&field));
    /// let mut walls = steps.walls(5..6, &diagnostics).unwrap();
    /// let skins = steps.skins(5..6, &mut walls, &diagnostics).unwrap();
    /// let filled = steps.infill(5..6, walls, skins, Density::new(0.2), &diagnostics).unwrap();
    /// let fills = &filled.layers[0].islands[0].fills;
    /// let slope = |bead: &grainpath_core::Toolpath| (bead.end().y - bead.start().y) / (bead.end().x - bead.start().x);
    /// assert!(!fills.is_empty() && fills.iter().all(|bead| (slope(bead) - 1.0 / 3f64.sqrt()).abs() < 0.01));
    /// ```
    #[must_use]
    pub fn with_field(self, field: Option<&'a FieldGuide>) -> Self {
        Self { field, ..self }
    }

    /// Lays sparse infill at the graded density `graded`, which differs from place to place.
    ///
    /// ```
    /// use grainpath::guide::given_field::FieldSettings;
    /// use grainpath::guide::graded_density::{DensitySettings, GradedDensity};
    /// use grainpath_io::directions::parse_densities;
    /// use grainpath_job::choices::{DensityBy, Pattern};
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{Density, Diagnostics};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let (mut settings, diagnostics) = (config::steps(&Default::default()), Diagnostics::default());
    /// let place = FieldSettings::AS_IN_FILE;
    /// // A table whose density rises from 0.1 at the left end of the box to 0.7 at its right end.
    /// let table = "x_mm,y_mm,density\n0,0,0.1\n20,0,0.7\n0,10,0.1\n20,10,0.7\n";
    /// let samples = parse_densities(table.as_bytes(), "densities.csv", None).unwrap();
    /// let wanted = DensitySettings { range: [0.1, 0.7], by: DensityBy::File, spacing_mm: 0.4, card: None, place };
    /// let graded = GradedDensity::new(&wanted, &stack, None, Some(samples), &diagnostics).unwrap();
    /// (settings.infill.pattern, settings.infill.graded) = (Pattern::Rectilinear, true);
    /// let steps = Steps::new(&settings, &stack).with_density(Some(&graded));
    /// let mut walls = steps.walls(5..6, &diagnostics).unwrap();
    /// let skins = steps.skins(5..6, &mut walls, &diagnostics).unwrap();
    /// let filled = steps.infill(5..6, walls, skins, Density::new(graded.mean), &diagnostics).unwrap();
    /// // More length of beads lies in the right half.
    /// let mut length_mm = [0.0; 2];
    /// for bead in &filled.layers[0].islands[0].fills {
    ///     for (a, b, _) in (0..bead.n_segments()).map(|i| bead.segment(i)) {
    ///         length_mm[usize::from(a.x + b.x > 20.0)] += a.distance(b);
    ///     }
    /// }
    /// assert!(length_mm[0] > 0.0 && length_mm[1] > 1.5 * length_mm[0], "{length_mm:?}");
    /// ```
    #[must_use]
    pub fn with_density(self, graded: Option<&'a GradedDensity>) -> Self {
        Self { graded, ..self }
    }

    /// Lays more walls where the stress takes more of the material's strength.
    ///
    /// ```
    /// use grainpath::guide::graded_density::DensityMap;
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{DVec3, Diagnostics};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let (mut settings, diagnostics) = (config::steps(&Default::default()), Diagnostics::default());
    /// // The right half takes all of the strength, the left half none: there are 2 walls, and 5 on the right.
    /// settings.most_walls = 5;
    /// let (low, high) = (DVec3::ZERO, DVec3::new(20.0, 10.0, 2.4));
    /// let share = DensityMap::new(low, high, 0.5, true, |p| if p.x > 10.0 { 1.0 } else { 0.0 });
    /// let steps = Steps::new(&settings, &stack).with_stress_share(Some(&share));
    /// let island = &steps.walls(0..1, &diagnostics).unwrap()[0].islands[0];
    /// // Two closed walls, and three open ones in the right half.
    /// assert_eq!((island.walls.len(), island.fills.len()), (2, 3));
    /// assert!(island.fills.iter().all(|wall| !wall.closed));
    /// ```
    #[must_use]
    pub fn with_stress_share(self, stress_share: Option<&'a DensityMap>) -> Self {
        Self { stress_share, ..self }
    }

    /// Lays infill with continuous fibre.
    ///
    /// ```
    /// use grainpath::fibre::{FibreSettings, FibreStart, FibreTurns};
    /// use grainpath_core::{DVec2, Role};
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{Density, Diagnostics};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let (settings, diagnostics) = (config::steps(&Default::default()), Diagnostics::default());
    /// // Rings of fibre along the outline, in every other layer between four layers at the bottom and four at the top.
    /// let fibre = FibreSettings {
    ///     layers: Vec::new(),
    ///     matrix_layers: [4, 4],
    ///     n_layers: 12,
    ///     plate_from_part_mm: DVec2::ZERO,
    ///     every: 2,
    ///     boxes: Vec::new(),
    ///     rings: 1,
    ///     bead_width_mm: 0.5,
    ///     min_radius_mm: 1.0,
    ///     turns: FibreTurns::Round,
    ///     min_length_mm: 20.0,
    ///     start: FibreStart::Nearest,
    /// };
    /// let steps = Steps::new(&settings, &stack).with_fibre(Some(&fibre));
    /// let mut walls = steps.walls(0..12, &diagnostics).unwrap();
    /// let skins = steps.skins(0..12, &mut walls, &diagnostics).unwrap();
    /// let filled = steps.infill(0..12, walls, skins, Density::new(0.2), &diagnostics).unwrap();
    /// let has_fibre = |i: usize| filled.layers[i].islands[0].fills.iter().any(|bead| bead.role == Role::Fibre);
    /// assert_eq!((0..12).filter(|i| has_fibre(*i)).collect::<Vec<_>>(), [4, 6]);
    /// ```
    #[must_use]
    pub fn with_fibre(self, fibre: Option<&'a FibreSettings>) -> Self {
        Self { fibre, ..self }
    }

    /// Gives regions their own walls, skins and infill. Call it after the guides are set, since regions use them too.
    ///
    /// ```
    /// use grainpath::region::{RegionAreas, RegionPart};
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{Diagnostics, TriMesh};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let diagnostics = Diagnostics::default();
    /// // The first three of twelve layers have four walls, the others two.
    /// let job = "[[region]]\non = { layers = [[1, 3]] }\nprocess = { walls = 4 }\n";
    /// let settings = grainpath_job::parse_job(job, "job.toml", &[], &|_| Err(String::new())).unwrap();
    /// # let part = RegionPart {
    /// #     stack: &stack,
    /// #     mesh: &TriMesh::default(),
    /// #     standing: config::standing(&settings, 0.0),
    /// #     unit_mm: 1.0,
    /// #     unit_of_file: true,
    /// #     slicing: config::placing(&settings).slicing,
    /// # };
    /// let areas = RegionAreas::new(&settings, &Default::default(), &part, &diagnostics).unwrap();
    /// let steps = config::steps(&settings);
    /// let steps = Steps::new(&steps, &stack).with_regions(Some(&areas));
    /// let walls = steps.walls(0..12, &diagnostics).unwrap();
    /// let n_walls = |i: usize| walls[i].islands[0].walls.len();
    /// assert_eq!((n_walls(2), n_walls(3)), (4, 2));
    /// ```
    #[must_use]
    pub fn with_regions(self, areas: Option<&'a RegionAreas>) -> Self {
        if areas.is_none() {
            return self;
        }
        let region = |r: &'a RegionSettings| Self {
            guide: self.guide.filter(|_| r.guided),
            grain: self.grain.filter(|_| r.guided),
            field: self.field.filter(|_| r.guided),
            graded: self.graded.filter(|_| r.steps.infill.graded),
            areas,
            ..Self::new(&r.steps, self.stack)
        };
        let regions = self.settings.regions.iter().map(region).collect();
        Self { areas, regions, ..self }
    }

    /// Pairs the steps of each region with the region's part of a layer.
    pub(super) fn regions<'s>(
        &'s self,
        split: &'s SkinSplit,
    ) -> impl Iterator<Item = (&'s Steps<'a>, &'s SkinSplit)> {
        self.regions.iter().zip(&split.regions)
    }

    /// The density of sparse infill in a region. It is `rest`, the density outside all regions, if the region has the
    /// same density settings as the job.
    pub(super) fn density_in(&self, region: &Steps<'_>, rest: Density) -> Density {
        let (own, job) = (&region.settings.infill, &self.settings.infill);
        let same = own.density == job.density && own.graded == job.graded && own.mass_g == job.mass_g;
        if same { rest } else { own.density }
    }

    /// The walls of a window of layers, and the areas for their infill.
    ///
    /// ```
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{Density, Diagnostics};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let (settings, diagnostics) = (config::steps(&Default::default()), Diagnostics::default());
    /// // `stack` has twelve layers of 20 x 10 mm. The outer of two walls lies half a bead inside the part.
    /// let walls = Steps::new(&settings, &stack).walls(3..6, &diagnostics).unwrap();
    /// assert_eq!(walls.len(), 3);
    /// let island = &walls[0].islands[0];
    /// assert_eq!(island.walls.len(), 2);
    /// assert!((island.walls[0].path.length_mm() - (60.0 - 8.0 * 0.225)).abs() < 0.01);
    /// ```
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub fn walls(
        &self,
        window: Range<usize>,
        diagnostics: &Diagnostics,
    ) -> Result<Vec<LayerWalls>, Interrupted> {
        // Whether a wall is staggered depends on the walls below and above, so one more layer is laid on each side.
        let laid = if self.settings.stagger_walls {
            window.start.saturating_sub(1)..(window.end + 1).min(self.stack.layers().len())
        } else {
            window.clone()
        };
        let first = laid.start;
        let lay = |(k, layer): (usize, &Layer)| {
            diagnostics.check()?;
            let settings = WallSettings { height_mm: layer.height_mm(), ..self.settings.walls };
            let mut islands = Vec::with_capacity(layer.region().polygons.len());
            let mut fill = Vec::new();
            let shares = self.shares(first + k);
            let more = self.more_walls(first + k);
            let mut regions = vec![Vec::new(); shares.len().saturating_sub(1)];
            for (i, polygon) in layer.region().polygons.iter().enumerate() {
                let walls = match shares.split_first() {
                    None => lay_graded(polygon, &settings, &more),
                    Some((&rest, shares)) => {
                        let divided = lay_divided(polygon, &settings, rest, shares);
                        for (all, own) in regions.iter_mut().zip(divided.regions) {
                            all.extend(own.polygons.into_iter().map(|p| (i, p)));
                        }
                        divided.rest
                    }
                };
                fill.extend(walls.fill.polygons.into_iter().map(|p| (i, p)));
                islands.push(Island { walls: walls.loops, fills: walls.singles });
            }
            // Small loops cool badly, and at high speed they make the printer vibrate.
            for wall in islands.iter_mut().flat_map(|i: &mut Island| &mut i.walls) {
                if wall.path.length_mm() < SMALL_WALL_MM {
                    wall.path.speed = SpeedClass::SmallWall;
                }
            }
            for island in &mut islands {
                island
                    .walls
                    .iter_mut()
                    .map(|w| &mut w.path)
                    .chain(&mut island.fills)
                    .for_each(Toolpath::shrink_to_fit);
                island.walls.shrink_to_fit();
            }
            fill.shrink_to_fit();
            if window.contains(&(first + k)) {
                diagnostics.advance(1);
            }
            Ok(LayerWalls { islands, fill, regions })
        };
        // At least two layers a task: walls of one layer take too little time to be worth a task.
        let all: Vec<Result<_, Interrupted>> =
            self.stack.layers()[laid.clone()].par_iter().enumerate().with_min_len(2).map(lay).collect();
        let mut all: Vec<LayerWalls> = all.into_iter().collect::<Result<_, _>>()?;
        if self.settings.stagger_walls {
            let mut walls: Vec<Vec<&mut [Wall]>> = Vec::with_capacity(all.len());
            for layer in &mut all {
                walls.push(layer.islands.iter_mut().map(|i| i.walls.as_mut_slice()).collect());
            }
            let sections = self.stack.layers();
            let below = laid.start.checked_sub(1).map(|k| &sections[k]);
            stagger(&mut walls, &sections[laid], below, self.settings.walls.bead_width_mm);
            all.drain(..window.start - first);
            all.truncate(window.len());
        }
        Ok(all)
    }

    /// The areas of a layer with extra walls. The first area gets one wall more than the least number, the second two
    /// more and so on. Each area lies in the one before.
    fn more_walls(&self, layer_idx: usize) -> Vec<Region> {
        let (least, most) = (self.settings.walls.n_walls, self.settings.most_walls);
        let Some(share) = self.stress_share.filter(|_| most > least) else { return Vec::new() };
        let Some(bounds) = self.stack.layers()[layer_idx].region().bounds() else { return Vec::new() };
        let n = (most - least) as f64;
        // Areas narrower than two beads are removed: an extra wall there would be too short to be worth starting.
        let narrowest = self.settings.walls.bead_width_mm;
        let area = |k: usize| {
            let there = share.at_least((k as f64 + 0.5) / n, bounds, self.z_mid_mm(layer_idx));
            there.opened(narrowest).closed(narrowest)
        };
        let mut all: Vec<Region> = Vec::new();
        for k in 0..most - least {
            let here = area(k);
            if here.is_empty() {
                break;
            }
            all.push(all.last().map_or_else(|| here.clone(), |outer| outer.intersection(&here)));
        }
        all
    }

    /// Area, number of walls and inset of each region in a layer, after those of the rest of the part; empty where no
    /// region meets the layer.
    fn shares(&self, layer_idx: usize) -> Vec<Share<'_>> {
        let Some(areas) = self.areas.and_then(|a| a.of_layer(layer_idx)) else { return Vec::new() };
        let layer = &self.stack.layers()[layer_idx];
        let share = |steps: &Self, area| {
            let (n_walls, inset_mm) = (steps.settings.walls.n_walls, steps.inset_mm(layer));
            Share { area, n_walls, inset_mm }
        };
        let regions = self.regions.iter().zip(areas).map(|(steps, area)| share(steps, area));
        // The first share is that of the rest of the part. Its area is not used, so any area will do.
        std::iter::once(share(self, &areas[0])).chain(regions).collect()
    }

    /// Divides the infill regions of a window of layers into skins, bridges and sparse infill, and
    /// marks walls over air. `walls` are those of the window; each [`LayerWalls::fill`] is emptied.
    ///
    /// ```
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{Density, Diagnostics};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let (settings, diagnostics) = (config::steps(&Default::default()), Diagnostics::default());
    /// // The lowest four and the topmost five of twelve layers are dense.
    /// let steps = Steps::new(&settings, &stack);
    /// let mut walls = steps.walls(0..12, &diagnostics).unwrap();
    /// let skins = steps.skins(0..12, &mut walls, &diagnostics).unwrap();
    /// let sparse: Vec<usize> = (0..12).filter(|i| !skins[*i].sparse.is_empty()).collect();
    /// assert_eq!(sparse, [4, 5, 6]);
    /// assert!(walls[0].fill.is_empty());
    /// ```
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub fn skins(
        &self,
        window: Range<usize>,
        walls: &mut [LayerWalls],
        diagnostics: &Diagnostics,
    ) -> Result<Vec<SkinSplit>, Interrupted> {
        let all = || std::iter::once(self).chain(&self.regions);
        let settings: Vec<SkinSettings> = all().map(|steps| steps.settings.skins).collect();
        // The pattern `continuous` is one path that skins do not divide: in a dense part it fills the whole region.
        let whole = |s: &Self| s.settings.infill.pattern == Pattern::Continuous && s.settings.skins.dense;
        let whole: Vec<bool> = all().map(whole).collect();
        let parts = |w: &mut LayerWalls| {
            let rest = std::mem::take(&mut w.fill);
            std::iter::once(rest).chain(std::mem::take(&mut w.regions)).collect::<Vec<_>>()
        };
        let (fills, islands): (Vec<_>, Vec<_>) =
            walls.iter_mut().map(|w| (parts(w), Mutex::new(&mut w.islands))).unzip();
        let sections = self.stack.layers();
        split_window(sections, window, &fills, self.part, &settings, diagnostics, |k, mut split| {
            if whole[0] {
                let solid = fills[k][0].clone();
                split =
                    SkinSplit { solid, below: split.below, regions: split.regions, ..SkinSplit::default() };
            }
            for (r, region) in split.regions.iter_mut().enumerate().filter(|(r, _)| whole[r + 1]) {
                *region = SkinSplit { solid: fills[k][r + 1].clone(), ..SkinSplit::default() };
            }
            // The mask of the section below is needed for overhangs only and is dropped afterwards: kept
            // for all layers, these masks would take much memory.
            if let Some(below) = split.below.take() {
                // The lock is never contended; it lets parallel layers write to their own walls.
                let mut islands = islands[k].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                let walls = islands.iter_mut().flat_map(|i| &mut i.walls);
                walls.for_each(|w| mark_overhang(&mut w.path, &below));
            }
            split
        })
    }

    /// Lays the infill, the supports, skirt and brim of a window of layers. `walls` and `skins` are
    /// those of the window. The infill regions of a layer are freed as soon as it is filled, so that they do not lie
    /// beside the paths of the whole window. Widths of a graded density whose lines lean are fitted over the window.
    ///
    /// ```
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{Density, Diagnostics};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let (settings, diagnostics) = (config::steps(&Default::default()), Diagnostics::default());
    /// let steps = Steps::new(&settings, &stack);
    /// let mut walls = steps.walls(0..12, &diagnostics).unwrap();
    /// let skins = steps.skins(0..12, &mut walls, &diagnostics).unwrap();
    /// let filled = steps.infill(0..12, walls, skins, Density::new(0.2), &diagnostics).unwrap();
    /// // Volume of the infill of a layer, mm3.
    /// let laid = |i: usize| filled.layers[i].islands[0].fills.iter().map(|p| p.volume_mm3(0.2)).sum::<f64>();
    /// assert!((0.15..0.35).contains(&(laid(5) / laid(0))), "sparse over dense: {}", laid(5) / laid(0));
    /// ```
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub fn infill(
        &self,
        window: Range<usize>,
        walls: Vec<LayerWalls>,
        skins: Vec<SkinSplit>,
        density: Density,
        diagnostics: &Diagnostics,
    ) -> Result<FilledLayers, Interrupted> {
        let mut copies =
            Copies { first: window.start, of: self.duplicates(window.start, &skins), laid: BTreeMap::new() };
        self.infill_beside(window, walls, skins, density, &mut copies, &mut BelowByTurn::new(), diagnostics)
    }

    /// Whether sparse lines go on from layer to layer: those along a field have to, since it may turn and spread with the
    /// height. Straight lines and cells lie on each other wherever the layer below is laid.
    pub(super) fn goes_on(&self, density: Density) -> bool {
        let along = |steps: &Self, density: Density| {
            steps.settings.infill.lines_go_on(density)
                && steps.grain.is_none_or(|grain| grain.mode == Mode::Field)
        };
        along(self, density) || self.regions.iter().any(|r| along(r, self.density_in(r, density)))
    }

    /// As [`Steps::infill`], for a window whose layers may be copies of layers in earlier windows, and whose lines go on from
    /// those below.
    fn infill_beside(
        &self,
        window: Range<usize>,
        walls: Vec<LayerWalls>,
        skins: Vec<SkinSplit>,
        density: Density,
        copies: &mut Copies,
        below: &mut BelowByTurn,
        diagnostics: &Diagnostics,
    ) -> Result<FilledLayers, Interrupted> {
        self.fit_lines(density)?;
        let first = window.start;
        let goes_on = self.goes_on(density);
        let mut leaning: Vec<Vec<Region>> =
            skins.par_iter().enumerate().map(|(k, split)| self.leaning_areas(first + k, split)).collect();
        let lay = |(k, split): (usize, SkinSplit)| {
            diagnostics.check()?;
            let mut paths = Vec::new();
            let mut tally = Tally::default();
            // A layer with the same region and field as an earlier one is not laid: it becomes a copy
            // of that layer after all others are laid.
            if copies.original(first + k) == first + k {
                let split = self.line_seams(first + k, &split, &mut paths);
                let mut add = |island, path| paths.push((island, path));
                tally = self.dense_fill(first + k, &split, &mut add);
                if !goes_on {
                    tally = tally.and(self.sparse_fill(first + k, &split, density, None, &mut add));
                }
            }
            paths.iter_mut().for_each(|(_, path)| path.shrink_to_fit());
            paths.shrink_to_fit();
            if !goes_on {
                diagnostics.advance(1);
            }
            Ok(((paths, tally), goes_on.then_some(split)))
        };
        let laid: Vec<Result<_, Interrupted>> = skins
            .into_par_iter()
            .enumerate()
            // A guide makes layers costly, so each layer is then a task of its own.
            .with_min_len(if self.guide.is_some() { 1 } else { 2 })
            .map(lay)
            .collect();
        let laid: Vec<((IslandPaths, Tally), Option<SkinSplit>)> =
            laid.into_iter().collect::<Result<_, _>>()?;
        let ((mut laid, mut tallies), splits): ((Vec<_>, Vec<_>), Vec<_>) = laid.into_iter().unzip();
        // Lines that go on from layer to layer are laid from the bed upwards.
        for (k, split) in splits.into_iter().enumerate().filter_map(|(k, split)| Some((k, split?))) {
            diagnostics.check()?;
            let turn = self.guide.map_or(0, |guide| guide.turn_of(first + k));
            let original = copies.original(first + k);
            if original == first + k {
                let lines = below.get(&turn);
                let mut add = |island, mut path: Toolpath| {
                    path.shrink_to_fit();
                    laid[k].push((island, path));
                };
                tallies[k] = tallies[k].and(self.sparse_fill(first + k, &split, density, lines, &mut add));
            }
            let paths =
                original.checked_sub(first).map_or_else(|| &copies.laid[&original].0, |own| &laid[own]);
            let sparse = paths.iter().filter(|(_, path)| path.role == Role::SparseFill);
            let walls = walls[k].islands.iter().flat_map(|island| island.walls.iter().map(|wall| &wall.path));
            let all = walls.chain(paths.iter().map(|(_, path)| path));
            let lines = LinesBelow::new(sparse.map(|(_, path)| path), all, self.settings.walls.bead_width_mm);
            below.values_mut().for_each(LinesBelow::cover);
            below.insert(turn, lines);
            diagnostics.advance(1);
        }
        let islands: Vec<&[Island]> = walls.iter().map(|walls| walls.islands.as_slice()).collect();
        let mut grown = BTreeMap::new();
        if self.leans() {
            diagnostics.check()?;
            // Widths are fitted to the sparse infill that skins leave.
            if !goes_on {
                grown = self.hold_skins(first, &islands, &mut laid, density, diagnostics)?;
            }
            grown.iter().for_each(|(k, split)| leaning[*k] = self.leaning_areas(first + k, split));
            let own = laid.iter_mut().zip(&leaning).enumerate();
            self.fit_leaning(
                density,
                &mut own.map(|(k, (paths, areas))| (first + k, areas.as_slice(), paths)).collect::<Vec<_>>(),
            );
        }
        // The index of a duplicate refers to a layer that was laid, never to another copy.
        let mut fibre = Tally::default();
        for k in 0..laid.len() {
            let original = copies.original(first + k);
            let tally = match original.checked_sub(first) {
                Some(own) if own == k => tallies[k],
                Some(own) => {
                    laid[k] = laid[own].clone();
                    tallies[own]
                }
                None => {
                    let (paths, tally) = &copies.laid[&original];
                    laid[k] = paths.clone();
                    *tally
                }
            };
            fibre = fibre.and(tally);
        }
        let needed = copies.needed_from(window.end);
        copies.laid.retain(|original, _| needed.contains(original));
        for original in needed.range(window.clone()) {
            let own = (laid[original - first].clone(), tallies[original - first]);
            copies.laid.insert(*original, own);
        }
        // Of copies, each lies on a layer of its own.
        if !goes_on && !self.leans() {
            grown = self.hold_skins(first, &islands, &mut laid, density, diagnostics)?;
        }
        let grown = grown.into_iter().filter(|_| self.graded.is_some());
        let sparse_areas = grown
            .map(|(k, split)| (first + k, self.sparse_area(&self.stack.layers()[first + k], &split)))
            .collect();
        let adhesion = self.adhesion(&window);
        let mut supports: Vec<Vec<Island>> = window.into_par_iter().map(|i| self.supports(i)).collect();
        let whole = |(k, (walls, paths)): (usize, (LayerWalls, IslandPaths))| {
            let mut islands = walls.islands;
            let mut n_fills = vec![0; islands.len()];
            paths.iter().for_each(|(island, _)| n_fills[*island] += 1);
            islands.iter_mut().zip(n_fills).for_each(|(island, n)| island.fills.reserve_exact(n));
            paths.into_iter().for_each(|(island, path)| islands[island].fills.push(path));
            let adhesion = adhesion.get(k).cloned().unwrap_or_default();
            LayerPaths { adhesion, supports: std::mem::take(&mut supports[k]), islands }
        };
        let layers = walls.into_iter().zip(laid).enumerate().map(whole).collect();
        Ok(FilledLayers { layers, fibre, sparse_areas })
    }

    /// Plans the whole part in windows of `n_layers` layers, from the bed upwards, and passes each
    /// layer to `each` as soon as it is planned. The layers are the same for every window size, up to
    /// rounding of layer heights in the last bits.
    ///
    /// ```
    /// # use grainpath::run::{Steps, config};
    /// # use grainpath_core::{Density, Diagnostics};
    /// # let stack = grainpath_parts::layers_of_a_box(12);
    /// # let (settings, diagnostics) = (config::steps(&Default::default()), Diagnostics::default());
    /// let order = config::order(&grainpath::Settings::default());
    /// let mut heights_mm = Vec::new();
    /// Steps::new(&settings, &stack).in_windows(5, Density::new(0.2), &order, &diagnostics, |layer| {
    ///     assert!(!layer.paths.is_empty());
    ///     heights_mm.push(layer.z_top_mm);
    /// }).unwrap();
    /// assert_eq!(heights_mm.len(), 12);
    /// assert!(heights_mm.is_sorted());
    /// ```
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub fn in_windows(
        &self,
        n_layers: usize,
        density: Density,
        order: &OrderSettings,
        diagnostics: &Diagnostics,
        mut each: impl FnMut(LayerPlan),
    ) -> Result<Tally, Interrupted> {
        let mut state = OrderState::new(order);
        let mut fibre = Tally::default();
        let end = self.stack.layers().len();
        // Lines that go on from layer to layer, copies of such layers and widths of beads that lean are found for the whole part.
        let n_layers = if self.goes_on(density) || self.leans() { end } else { n_layers }.max(1);
        for first in (0..end).step_by(n_layers) {
            let window = first..(first + n_layers).min(end);
            let mut walls = self.walls(window.clone(), diagnostics)?;
            let skins = self.skins(window.clone(), &mut walls, diagnostics)?;
            let filled = self.infill(window.clone(), walls, skins, density, diagnostics)?;
            fibre = fibre.and(filled.fibre);
            let sections = self.stack.layers();
            let plans = order_window(sections, window, filled.layers, order, &mut state, diagnostics)?;
            plans.into_iter().for_each(&mut each);
        }
        Ok(fibre)
    }

    /// Lays the infill of the whole part and orders its layers, in windows that begin with one layer and grow. `each` gets
    /// the layers of every window. They are the same as those of a single window, to the bit: copies are found once, for
    /// the whole part.
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub(super) fn in_growing_windows(
        &self,
        mut walls: Vec<LayerWalls>,
        mut skins: Vec<SkinSplit>,
        density: Density,
        order: &OrderSettings,
        diagnostics: &Diagnostics,
        mut each: impl FnMut(Vec<LayerPlan>),
    ) -> Result<(), Interrupted> {
        let mut state = OrderState::new(order);
        let mut copies = Copies { first: 0, of: self.duplicates(0, &skins), laid: BTreeMap::new() };
        let sections = self.stack.layers();
        let (mut first, mut below) = (0, BelowByTurn::new());
        while first < sections.len() {
            let window = first..(GROWTH * first).clamp(first + 1, sections.len());
            let of_window = walls.drain(..window.len()).collect();
            let own = skins.drain(..window.len()).collect();
            let filled = self.infill_beside(
                window.clone(),
                of_window,
                own,
                density,
                &mut copies,
                &mut below,
                diagnostics,
            )?;
            first = window.end;
            each(order_window(sections, window, filled.layers, order, &mut state, diagnostics)?);
        }
        Ok(())
    }

    /// For each layer of a window, the index of the earlier layer whose infill it can copy, or its own
    /// index where there is none. The two layers have the same infill region and the same field. Their infill
    /// depends on nothing else, except that sparse lines along a field go on from the layer below, which a copy
    /// does too. Only patterns that follow a field and parallel lines of graded density are compared: others are
    /// cheap, or differ in every layer.
    pub(super) fn duplicates(&self, first: usize, skins: &[SkinSplit]) -> Vec<usize> {
        let layers = self.stack.layers();
        let pattern = self.settings.infill.pattern;
        let guided = self.grain.is_some() || pattern.follows_field();
        let parallel = matches!(pattern, Pattern::Rectilinear | Pattern::Aligned);
        let mut duplicate_of: Vec<usize> = (0..skins.len()).collect();
        if !(guided || parallel && self.graded.is_some()) {
            return duplicate_of;
        }
        // Angle of sparse lines, angle of dense ones, and whether graded density turns these.
        let raster = |i: usize| {
            let angle_rad = |density| self.angle_rad(i, density);
            let turned = graded_infill::is_turned(self.z_mid_mm(i), layers[i].height_mm());
            (angle_rad(Density::Sparse(0.5)), angle_rad(Density::Dense), turned)
        };
        for k in 1..skins.len() {
            let i = first + k;
            let same = |&other: &usize| {
                let j = first + other;
                (layers[i].height_mm() - layers[j].height_mm()).abs() < 1e-9
                    // A bridge depends on the layer below as well.
                    && skins[k].bridge.is_empty()
                    // Regions may have patterns that turn from layer to layer.
                    && skins[k].regions.is_empty()
                    // Skins with angles of their own turn from layer to layer.
                    && (self.settings.infill.skin_angles.is_none()
                        || (skins[k].top.is_empty() && skins[k].solid.is_empty()))
                    && skins[k] == skins[other]
                    && (guided || raster(i) == raster(j))
                    && self.shift(i) == self.shift(j)
                    && self.guide.is_none_or(|g| g.same(i, j))
                    && self.grain.is_none_or(GrainGuide::is_upright)
                    && self.field.is_none_or(FieldGuide::is_upright)
                    && self.graded.is_none_or(GradedDensity::is_upright)
                    && self.fibre.is_none_or(|f| f.same((i, self.z_mid_mm(i)), (j, self.z_mid_mm(j))))
            };
            // Compares the layer below first, then lower ones, as many as directions and ends take in turn.
            let turns = self.guide.map_or(2, Guide::turns) * TURNS;
            if let Some(other) = (k.saturating_sub(turns)..k).rev().find(same) {
                duplicate_of[k] = duplicate_of[other];
            }
        }
        duplicate_of
    }

    pub(super) fn z_mid_mm(&self, layer_idx: usize) -> f64 {
        let layer = &self.stack.layers()[layer_idx];
        layer.z_top_mm() - 0.5 * layer.height_mm()
    }

    /// Where beads of a layer end.
    fn shift(&self, layer_idx: usize) -> Shift {
        Shift::of_layer(self.settings.infill.layer_shift, layer_idx)
    }

    pub(super) fn context(&self, layer_idx: usize, density: Density, role: Role) -> FillContext<'_> {
        let layer = &self.stack.layers()[layer_idx];
        FillContext {
            z_mid_mm: self.z_mid_mm(layer_idx),
            height_mm: layer.height_mm(),
            bead_width_mm: self.settings.walls.bead_width_mm,
            min_bead_width_mm: self.settings.walls.min_bead_width_mm,
            density,
            angle_rad: self.angle_rad(layer_idx, density),
            part: self.part,
            role,
            border_mm: self.border_mm(layer),
            ends: self.settings.infill.ends,
            widths: self.settings.infill.widths,
            shift: self.shift(layer_idx),
            below: None,
            // Nothing would hold the short beads of a bridge.
            fills_wedges: role != Role::Bridge,
            field: Some(match (self.guide, self.grain) {
                (Some(guide), _) => guide.layer(layer_idx),
                (None, Some(grain)) => grain,
                (None, None) => self.field.map_or(&self.uniform as &dyn DirectionField, |field| field),
            }),
        }
    }

    /// Keeps the notes about an island of a layer.
    pub(super) fn note(&self, layer_idx: usize, role: Role, notes: Vec<Note>) {
        if !notes.is_empty() {
            let mut all = self.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            all.entry((layer_idx, role)).or_default().extend(notes);
        }
    }

    /// Discards the notes that were kept while trial densities were laid.
    pub(super) fn discard_notes(&self) {
        self.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clear();
        self.short_fill.clear();
        self.regions.iter().for_each(Self::discard_notes);
    }

    /// Warns once for each kind of note. The warning states where the note first occurred and in how
    /// many further layers.
    pub(super) fn report_notes(&self, diagnostics: &Diagnostics) {
        let mut all = self.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone();
        for region in &self.regions {
            let own = region.notes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            own.iter().for_each(|(key, notes)| all.entry(*key).or_default().extend(notes.iter().cloned()));
        }
        let mut reported = Vec::new();
        for (&(layer_idx, _), note) in all.iter().flat_map(|(key, notes)| notes.iter().map(move |n| (key, n)))
        {
            let kind = std::mem::discriminant(&note.what);
            if reported.contains(&kind) {
                continue;
            }
            reported.push(kind);
            let same = |notes: &[Note]| notes.iter().any(|n| std::mem::discriminant(&n.what) == kind);
            let layers: BTreeSet<usize> =
                all.iter().filter(|(_, notes)| same(notes)).map(|(key, _)| key.0).collect();
            let more = match layers.len() - 1 {
                0 => String::new(),
                n => format!(" (further layers with the same: {n})"),
            };
            let z_mm = self.stack.layers()[layer_idx].z_top_mm();
            let warning = note.warning().in_layer(layer_idx, z_mm);
            diagnostics.push(Warning { text: format!("{}{more}", warning.text), ..warning });
        }
        std::iter::once(self)
            .chain(&self.regions)
            .for_each(|steps| steps.short_fill.report(self.stack, diagnostics));
    }

    /// The beads of the support in a layer.
    fn supports(&self, layer_idx: usize) -> Vec<Island> {
        let Some(layer) = self.support.map(|s| &s.cut.layers[layer_idx]) else { return Vec::new() };
        let settings = &self.settings.supports;
        let context = self.context(layer_idx, Density::Dense, Role::Support);
        let dense = layer_idx < settings.dense_layers;
        let Some(mut islands) = layer.islands.clone() else {
            return support::beads::lay(layer, &context, dense, settings);
        };
        // The beads of trees were laid when the trees were planned. Only sparse lines in their hollows are missing.
        if !dense && settings.density.fraction() > 0.0 {
            islands.extend(support::beads::sparse(layer, &context, settings));
        }
        islands
    }

    /// Skirt and brim layer by layer, from the first layer of a window to the last layer that has any.
    fn adhesion(&self, window: &Range<usize>) -> Vec<Vec<Toolpath>> {
        let settings = &self.settings.adhesion;
        let n_layers = self.stack.layers().len();
        // The brim lies in the first layer alone; the skirt may be several layers high.
        let n = if settings.skirt_loops > 0 { self.settings.skirt_layers.min(n_layers) } else { 1 };
        let Some(first) = self.stack.layers().first() else { return Vec::new() };
        if window.start >= n {
            return Vec::new();
        }
        let settings = AdhesionSettings { height_mm: first.height_mm(), ..*settings };
        // Supports stand on the plate too, so the skirt runs around them.
        let standing = match self.support {
            Some(s) => first.region().union(&s.cut.layers[0].region),
            None => first.region().clone(),
        };
        let skirts = if settings.skirt_loops > 0 { skirt(&standing, &settings) } else { Vec::new() };
        let mut all = vec![skirts; n];
        if settings.brim_width_mm > 0.0 {
            all[0].extend(brim(&standing, &settings));
        }
        all.split_off(window.start)
    }
}

/// Sets the overhang speed for a wall if too much of its length lies over air.
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
}
