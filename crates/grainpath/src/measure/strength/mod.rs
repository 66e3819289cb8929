//! Runs the virtual strength test of a plan, or of any other G-code.
//!
//! The beads of a program become plies of a plate or bricks of a solid (`grainpath_fea::strength`).
//! Fixtures and loads are those of the job. The result is the peak load, its interval over the bounds
//! of the material's strengths, and its change when the cells are halved.

mod brick_setup;
mod printed;
mod reserve;
mod setup;

use std::collections::BTreeMap;
use std::sync::Arc;

use grainpath_core::diagnostics::CancelFlag;
use grainpath_core::hash::splitmix64;
use grainpath_core::{DVec2, DVec3, Diagnostics, Warning, WarningId};
use grainpath_fea::load_case::CatchesNothing;
use grainpath_fea::material::Orthotropic;
use grainpath_fea::strength::bricks::{Bricks, MAX_BRICKS};
use grainpath_fea::strength::card::{FailureMode, StrengthCard};
use grainpath_fea::strength::first_failure::{IndexScale, Judged};
use grainpath_fea::strength::grid_turn::Frame;
use grainpath_fea::strength::laminate::{BeadPiece, BeadSheet, CellError, Laminate};
use grainpath_fea::strength::plate_strength::{PlateModel, PlateTest};
use grainpath_fea::strength::reserve_map::ReserveMap;
use grainpath_fea::strength::{BROKEN_SHARE, CELLS_ACROSS, Outcome, TestError, UnresolvedBending};
use grainpath_gcode::Program;
use rayon::prelude::*;
use serde::Serialize;

use crate::error_kind::ErrorKind;
use crate::guide::{GuideError, NotPlate};
use brick_setup::PreparedSolid;
use grainpath_job::MaterialSection;
use grainpath_job::choices::{self, Choice};
pub use printed::PrintedPart;
pub(crate) use reserve::interval;
pub use reserve::{CaseReserve, ReserveReport, StressedPart, reserve};
pub use setup::TestSetup;
use setup::{Fidelity, Prepared};

/// Why a part cannot be tested.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum StrengthError {
    #[error("needs {0}; fixtures and loads are set in [guide]")]
    Missing(&'static str),
    #[error(
        "the material has no strengths: set {0} as [low, nominal, high] in [material], or take another profile"
    )]
    NoCard(String),
    #[error("strength.fidelity = \"plane\" does not fit: {0}; use \"voxels\"")]
    NotFlat(NotPlate),
    #[error(
        "the part is tested as a solid, which has no plate to write; a part of one section under loads in its plane and on its whole height has"
    )]
    NoPlate,
    #[error(
        "a part with fibre is tested as a plate: loads in the layers' plane, fixtures and loads on the whole height, strength.fidelity = \"plane\""
    )]
    FibreInSpace,
    #[error("{0} prescribes a displacement, but the strength test needs forces")]
    Moved(String),
    #[error("{what}: fix = \"normal\" needs a plane or a cylinder here, not a {shape}")]
    NoNormal { what: String, shape: &'static str },
    #[error(
        "{what}: the strength test has no load {key}; use force_n, pressure_mpa, moment_nmm or acceleration_mm_s2"
    )]
    LoadOfSolids { what: String, key: &'static str },
    #[error(transparent)]
    CatchesNothing(#[from] CatchesNothing),
    #[error("nothing of a part is printed in the program")]
    NothingPrinted,
    #[error(
        "{0} needs the surface of the part, which a program does not have: state [shape], or use a box, a plane, a cylinder or a sphere with a force"
    )]
    NeedsSurface(String),
    #[error(
        "the program prints {:.1} x {:.1} x {:.1} mm, the job's part is {:.1} x {:.1} x {:.1} mm: not the same part",
        printed.x, printed.y, printed.z, part.x, part.y, part.z
    )]
    WrongPart { printed: DVec3, part: DVec3 },
    #[error(
        "{percent:.0} % of what the program prints lies outside the job's part: not the same part, or turned"
    )]
    Outside { percent: f64 },
    #[error(
        "the program extrudes {laid_mm3:.0} mm3, but the job's part has {part_mm3:.0} mm3: E should be in mm of filament with the diameter printer.filament_mm = {filament_mm}, or M200 should state that E is in mm3"
    )]
    TooMuch { laid_mm3: f64, part_mm3: f64, filament_mm: f64 },
    #[error("what is printed around ({x:.2}, {y:.2}) mm is free to {how}; hold it with another fixture")]
    Free { x: f64, y: f64, how: &'static str },
    #[error(
        "walls {wall_mm:.2} mm thick bend out of their plane and cells of {cell_mm:.3} mm cannot tell how much they carry: {}",
        if *fit { format!("set strength.cell_mm = {needed_mm:.3} or leave it out") } else {
            format!("cells of {needed_mm:.3} mm would be too many for the whole part; test a smaller piece of it, or set strength.cell_mm = {needed_mm:.3} and raise guide.memory_mib")
        }
    )]
    ThinWalls { wall_mm: f64, cell_mm: f64, needed_mm: f64, fit: bool },
    #[error("{0}")]
    Cells(#[from] CellError),
    #[error("{0}")]
    Test(#[from] TestError),
    #[error("{0}")]
    Place(#[from] GuideError),
}

impl StrengthError {
    /// The kind of the error, which tells the user what has to be changed.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::NothingPrinted
            | Self::WrongPart { .. }
            | Self::Outside { .. }
            | Self::TooMuch { .. }
            | Self::Cells(CellError::NoBeads) => ErrorKind::Input,
            Self::Test(TestError::Interrupted(_)) => ErrorKind::Interrupted,
            Self::Free { .. } | Self::ThinWalls { .. } | Self::Test(_) => ErrorKind::Physics,
            _ => ErrorKind::Job,
        }
    }
}

/// A corner of a material's card: one choice of low, nominal or high for the strengths along the beads,
/// and one for all other strengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Corner {
    /// Name in reports.
    pub name: &'static str,
    along: usize,
    rest: usize,
}

/// The corners that are tested, the nominal one first.
pub const CORNERS: [Corner; 5] = [
    Corner { name: "nominal", along: 1, rest: 1 },
    Corner { name: "low", along: 0, rest: 0 },
    Corner { name: "high", along: 2, rest: 2 },
    Corner { name: "strong along, weak across", along: 2, rest: 0 },
    Corner { name: "weak along, strong across", along: 0, rest: 2 },
];

/// Settings of a strength test, apart from part, fixtures and loads. Made by
/// [`crate::run::config::strength`].
#[derive(Debug, Clone, PartialEq)]
pub struct StrengthSettings {
    /// Model of the part: a plate, a solid, or chosen by the part.
    pub fidelity: choices::Fidelity,
    /// Size of the cells, mm; `None` chooses it from the part and its beads.
    pub cell_mm: Option<f64>,
    /// Whether the peak load is compared with the peak load on larger cells.
    pub check: bool,
    /// Whether the test is repeated at every corner of the card: with low and high strengths beside the nominal ones,
    /// as `CORNERS` lists them.
    pub corners: bool,
    /// Memory limit of the solver, MiB.
    pub max_mib: f64,
    /// Nominal width of a bead, mm.
    pub bead_mm: f64,
    /// Diameter of the filament, mm.
    pub filament_mm: f64,
    /// The card of the part's material.
    pub material: MaterialSection,
    /// The card of the fibre, if the job lays fibre.
    pub fibre: Option<MaterialSection>,
    /// Whether the result holds the model of a plate ([`Tested::model`]).
    pub keep_model: bool,
}

impl StrengthSettings {
    /// The strength cards at a corner: first that of the part's material, then that of the fibre, if any.
    ///
    /// # Errors
    /// [`StrengthError::NoCard`] naming every strength that is missing.
    pub fn cards(&self, corner: Corner) -> Result<Vec<StrengthCard>, StrengthError> {
        std::iter::once(&self.material).chain(&self.fibre).map(|m| card(m, corner)).collect()
    }

    /// The cards of the part's material at its low, nominal and high strengths, in this order.
    ///
    /// # Errors
    /// [`StrengthError::NoCard`] naming every strength that is missing.
    pub(crate) fn bounding_cards(&self) -> Result<[StrengthCard; 3], StrengthError> {
        Ok([
            card(&self.material, CORNERS[1])?,
            card(&self.material, CORNERS[0])?,
            card(&self.material, CORNERS[2])?,
        ])
    }

    /// Name of the material with a hash of its strengths and elastic constants, for the report: cards that differ in one of
    /// them have another text.
    fn card(&self) -> String {
        let cards: Vec<&MaterialSection> = std::iter::once(&self.material).chain(&self.fibre).collect();
        let names: Vec<&str> = cards.iter().map(|m| m.name.as_str()).collect();
        let values = cards.iter().flat_map(|m| {
            let strengths = strengths(m).into_iter().map(|(_, bounds)| bounds.unwrap_or_default());
            strengths.chain([m.e_mpa, m.nu, m.g_mpa]).flatten()
        });
        let hash = values.fold(0, |h, v| splitmix64(h ^ v.to_bits()));
        format!("{} {:08x}", names.join(" + "), hash >> 32)
    }

    /// Origin of the strengths, for the report.
    fn source(&self) -> String {
        let matrix = &self.material.strength_source;
        match &self.fibre {
            Some(fibre) => format!("fibre: {}; matrix: {matrix}", fibre.strength_source),
            None => matrix.clone(),
        }
    }
}

/// The strengths of a material by their keys. The first three act along the beads.
fn strengths(m: &MaterialSection) -> [(&'static str, Option<[f64; 3]>); 9] {
    [
        ("xt_mpa", m.xt_mpa),
        ("xc_mpa", m.xc_mpa),
        ("g_along_n_mm", m.g_along_n_mm),
        ("yt_mpa", m.yt_mpa),
        ("s12_mpa", m.s12_mpa),
        ("yc_mpa", m.yc_mpa),
        ("g_across_n_mm", m.g_across_n_mm),
        ("zt_mpa", m.zt_mpa),
        ("s_il_mpa", m.s_il_mpa),
    ]
}

fn card(m: &MaterialSection, corner: Corner) -> Result<StrengthCard, StrengthError> {
    let given = strengths(m);
    // All missing strengths are named in one message, so that one edit of the job suffices.
    let missing: Vec<&str> = given.iter().filter(|g| g.1.is_none()).map(|g| g.0).collect();
    if !missing.is_empty() {
        return Err(StrengthError::NoCard(missing.join(", ")));
    }
    let value = |k: usize| {
        // The first three act along the beads, all others across them or between layers.
        let at = if k < 3 { corner.along } else { corner.rest };
        given[k].1.map_or(0.0, |bounds| bounds[at])
    };
    Ok(StrengthCard {
        elastic: Orthotropic { e_mpa: m.e_mpa, nu: m.nu, g_mpa: m.g_mpa },
        xt_mpa: value(0),
        xc_mpa: value(1),
        g_along_n_mm: value(2),
        yt_mpa: value(3),
        s12_mpa: value(4),
        yc_mpa: value(5),
        g_across_n_mm: value(6),
        zt_mpa: value(7),
        s_il_mpa: value(8),
    })
}

/// Result of a test; the documented keys come first.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct StrengthReport {
    pub peak_load_n: f64,
    pub low_n: f64,
    pub high_n: f64,
    pub stiffness_n_per_mm: f64,
    /// Load at which the first ply begins to fail. It is the value of a single cell, and uncertain in thin and leaning walls
    /// (see `docs/strength.md`).
    pub first_n: f64,
    pub peak_displacement_mm: f64,
    /// The load in the job; the test scales it up to the peak.
    pub job_load_n: f64,
    pub case: String,
    pub mode: &'static str,
    /// Share of the dissipated energy in each failure mode.
    pub modes: BTreeMap<&'static str, f64>,
    pub weakest: Weakest,
    /// Peak load at each corner of the card, N. A corner is one choice of low, nominal or high strengths: see
    /// [`Corner`].
    pub corners: BTreeMap<&'static str, f64>,
    pub mass_g: f64,
    pub load_per_gram_n_g: f64,
    pub fidelity: &'static str,
    pub cell_mm: f64,
    /// Thickness of the walls that bend most, mm, where they are fewer than [`CELLS_ACROSS`] cells thick.
    #[serde(skip)]
    pub thin_wall_mm: Option<f64>,
    /// Relative change of the peak load when the cells were halved to this size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_change: Option<f64>,
    /// Share by which the peak depends on the cells' size and position. The interval is wider by this share on both sides.
    pub grid_share: f64,
    /// Every load case, if there are several. The other fields are those of the case with the smallest factor.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cases: Vec<CasePeak>,
    /// Relative difference between the cells' volume and the extruded volume.
    pub volume_error: f64,
    pub dofs: usize,
    pub solutions: usize,
    pub seconds: f64,
    /// Name of the material and a hash of its card: two reports with the same text rest on the same numbers.
    pub card: String,
    pub card_source: String,
    pub card_tier: &'static str,
    /// Points of the load curve: displacement in mm and load in N.
    pub curve: Vec<[f64; 2]>,
}

/// The peak of one load case.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct CasePeak {
    pub case: String,
    pub peak_load_n: f64,
    pub low_n: f64,
    pub high_n: f64,
    /// Load of the job in this case.
    pub job_load_n: f64,
    /// Peak load over the load in the job.
    pub factor: f64,
}

/// The place where a part fails.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct Weakest {
    pub x_mm: f64,
    pub y_mm: f64,
    /// Left out for plates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z_mm: Option<f64>,
    pub words: String,
}

/// A finished test.
pub struct Tested {
    /// Result of the test.
    pub report: StrengthReport,
    /// History of every element.
    pub outcome: Outcome,
    /// Position of the elements.
    pub map: Map,
    /// The plate before anything breaks, if the settings ask for it; a solid has none.
    pub model: Option<PlateModel>,
    /// The orientation of the elements' grid.
    frame: Frame,
    /// Vector from part coordinates to program coordinates, mm.
    program_from_part_mm: DVec3,
    /// Lowest height of the part and its height, mm.
    heights_mm: [f64; 2],
}

/// An element that lost stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrokenElement {
    /// Centre of the element in the program's coordinates, mm.
    pub at_mm: DVec3,
    /// The lost share of the element's stiffness, 0 to 1.
    pub lost: f32,
    /// The first state of the test in which it is broken.
    pub state: u32,
}

impl Tested {
    /// The edge lengths of an element, mm. An element of a plate is as high as the plate.
    pub fn element_mm(&self) -> DVec3 {
        match &self.map {
            Map::Plane(e) => DVec3::new(e.grid.cell_mm, e.grid.cell_mm, self.heights_mm[1]),
            Map::Voxels { cell_mm, .. } => *cell_mm,
        }
    }

    /// The angle of the elements' first edge from the x axis, rad.
    pub fn element_angle_rad(&self) -> f64 {
        let x = self.frame.to_part(DVec2::X);
        grainpath_core::math::atan2(x.y, x.x)
    }

    /// The elements that lost at least [`BROKEN_SHARE`] of their stiffness.
    pub fn broken(&self) -> Vec<BrokenElement> {
        let size_mm = self.element_mm();
        let (n, low, cells) = match &self.map {
            Map::Plane(e) => ([e.grid.nx, e.grid.ny], e.grid.low.extend(self.heights_mm[0]), &e.cells),
            Map::Voxels { n, low, cells, .. } => ([n[0], n[1]], *low, cells),
        };
        let place = |cell: u32| {
            let (cell, [nx, ny]) = (cell as usize, n);
            let index = DVec3::new((cell % nx) as f64, (cell / nx % ny) as f64, (cell / (nx * ny)) as f64);
            self.frame.to_part_3d(low + (index + 0.5) * size_mm) + self.program_from_part_mm
        };
        let all = cells.iter().zip(&self.outcome.damage).zip(&self.outcome.broke_at);
        let broken = all.filter(|((_, lost), _)| **lost >= BROKEN_SHARE);
        let element = |((cell, lost), at): ((&u32, &f32), &Option<u32>)| BrokenElement {
            at_mm: place(*cell),
            lost: *lost,
            state: at.unwrap_or_default(),
        };
        broken.map(element).collect()
    }
}

/// Position of the elements of a test.
pub enum Map {
    /// Elements of a plate.
    Plane(grainpath_fea::strength::squares::PlateElements),
    /// Cells of a solid.
    Voxels {
        /// Cells along each axis.
        n: [usize; 3],
        /// Edges of a cell, mm.
        cell_mm: DVec3,
        /// Lowest corner, mm.
        low: DVec3,
        /// The cell of each element.
        cells: Vec<u32>,
    },
}

/// The memory that a test may use, and the flag that stops it.
struct Limits {
    max_mib: f64,
    cancel: CancelFlag,
}

/// The cells of a test: their size, and the shift of the grid along both axes as a share of that size.
#[derive(Debug, Clone, Copy)]
struct PlacedCells {
    size_mm: f64,
    moved: f64,
}

impl PlacedCells {
    fn unmoved(size_mm: f64) -> Self {
        Self { size_mm, moved: 0.0 }
    }
}

/// The cells of a part's beads, without supports and loads: the same for all load cases.
enum BeadCells {
    Plane(Arc<Laminate>),
    Voxels(Arc<Bricks>),
}

impl BeadCells {
    fn new(setup: &TestSetup, sheets: &[BeadSheet], cells: PlacedCells) -> Result<Self, StrengthError> {
        let PlacedCells { size_mm, moved } = cells;
        Ok(match setup.fidelity {
            Fidelity::Plane => Self::Plane(Arc::new(Laminate::moved(sheets, size_mm, moved)?)),
            Fidelity::Voxels => Self::Voxels(Arc::new(Bricks::moved(sheets, size_mm, moved, setup.low.z)?)),
        })
    }
}

/// A part with supports and loads.
enum LoadedPart {
    Plane(Prepared),
    Voxels(PreparedSolid),
}

impl LoadedPart {
    fn new(setup: &TestSetup, sheets: &[BeadSheet], cells: PlacedCells) -> Result<Self, StrengthError> {
        Self::on(setup, &BeadCells::new(setup, sheets, cells)?)
    }

    fn on(setup: &TestSetup, cells: &BeadCells) -> Result<Self, StrengthError> {
        Ok(match cells {
            BeadCells::Plane(laminate) => Self::Plane(setup.prepared(laminate.clone())?),
            BeadCells::Voxels(bricks) => Self::Voxels(setup.prepared_solid(bricks.clone())?),
        })
    }

    fn run(&self, cards: &[StrengthCard], limits: &Limits) -> Result<Outcome, StrengthError> {
        Ok(match self {
            Self::Plane(p) => run(p, cards, limits)?,
            Self::Voxels(p) => p.run(&cards[0], limits)?,
        })
    }

    fn unresolved_bending(
        &self,
        cards: &[StrengthCard],
        limits: &Limits,
    ) -> Result<UnresolvedBending, StrengthError> {
        Ok(match self {
            Self::Plane(p) => plate_test(p, cards, limits).unresolved_bending()?,
            Self::Voxels(p) => p.unresolved_bending(&cards[0], limits)?,
        })
    }

    /// The first failures under the load with each of several sets of cards, from one solution. Indices are multiplied by
    /// `scale`. The middle set, the nominal one, decides whether they are told over a length.
    fn first_failures<const N: usize>(
        &self,
        cards: &[Vec<StrengthCard>; N],
        scale: IndexScale,
        limits: &Limits,
    ) -> Result<Judged<N>, StrengthError> {
        Ok(match self {
            Self::Plane(p) => plate_test(p, &cards[N / 2], limits).first_failures(cards, scale)?,
            Self::Voxels(p) => {
                let of_part = std::array::from_fn(|k| cards[k][0]);
                p.test(&of_part[N / 2], limits).first_failures(&of_part, scale)?
            }
        })
    }

    /// The map of the reserve on these cells, without any load.
    fn reserve_map(&self, floor_mm: f64, frame: Frame, program_from_part_mm: DVec3) -> ReserveMap {
        match self {
            Self::Plane(p) => ReserveMap::of_plate(&p.laminate, floor_mm, frame, program_from_part_mm),
            Self::Voxels(p) => ReserveMap::of_bricks(&p.bricks, frame, program_from_part_mm),
        }
    }

    /// The centre of a cell in the directions of the grid, mm; in a plate at the given height.
    fn centre(&self, cell: usize, z_mm: f64) -> DVec3 {
        match self {
            Self::Plane(p) => p.laminate.grid.centre(cell).extend(z_mm),
            Self::Voxels(p) => p.bricks.centre(cell),
        }
    }

    fn load_n(&self) -> f64 {
        match self {
            Self::Plane(p) => p.load_n,
            Self::Voxels(p) => p.load_n,
        }
    }

    fn lost(&self) -> f64 {
        match self {
            Self::Plane(p) => p.lost,
            Self::Voxels(p) => p.lost,
        }
    }

    fn volume_error(&self) -> f64 {
        match self {
            Self::Plane(p) => p.laminate.volume_error(),
            Self::Voxels(p) => p.bricks.volume_error(),
        }
    }

    fn map(self) -> Map {
        match self {
            Self::Plane(p) => Map::Plane(p.elements),
            Self::Voxels(p) => Map::Voxels {
                n: p.bricks.n,
                cell_mm: p.bricks.cell_mm,
                low: p.bricks.origin,
                cells: (0..p.active.len()).filter(|c| p.active[*c]).map(|c| c as u32).collect(),
            },
        }
    }
}

/// Largest number of cells in a plate, if the job does not state their size.
const CELLS: f64 = 150_000.0;
/// Largest number of cells in a solid, if the job does not state their size.
const CELLS_SOLID: f64 = 500_000.0;
/// The usual and the smallest size of the cells of a test, mm. The usual size is a bead in a solid, and half a bead in a
/// plate, which resolves single beads. `area_mm2` is the area of the section, `size` the size of the part.
fn cell_sizes_mm(
    fidelity: Fidelity,
    bead_mm: f64,
    area_mm2: f64,
    volume_mm3: f64,
    size: DVec3,
) -> (f64, f64) {
    match fidelity {
        Fidelity::Plane => (0.5 * bead_mm, (area_mm2 / CELLS).sqrt()),
        Fidelity::Voxels => {
            // The grid also contains the empty cells of the part's bounding box, and two cells around it.
            let boxed = 1.1 * size.element_product() / MAX_BRICKS as f64;
            (bead_mm, (volume_mm3 / CELLS_SOLID).max(boxed).cbrt())
        }
    }
}

/// If thin walls bend, cells miss a share of the failure index. No warning is given up to this share. Measured: walls three
/// cells thick miss a third to a half and carry up to a fifth too much, walls four cells thick miss nothing; their peak is
/// within 15 % of beam theory (`tests/wall_bending.rs` of grainpath-fea).
const RESOLVED: f64 = 0.3;
/// A test is refused if the cells miss more than this share. Source: derived. Two cells across a wall, or one cell on the
/// border of two, miss as much bending as they represent, which is a share of 1.
const MAX_UNRESOLVED: f64 = 0.9;
/// How often cells are made smaller for walls that bend. Source: derived. The first round finds the wall's thickness to
/// within one of the larger cells, the second to within a quarter of the wall, and the third confirms it.
const MAX_ROUNDS: usize = 3;
/// Size of the cells of the comparison run over the size of the cells of the test.
const COARSE: f64 = 2.0;
/// The same ratio if walls are only four cells thick. Source: derived. The walls are then three cells thick in the
/// comparison run; two cells would be refused.
const COARSE_OF_WALLS: f64 = 4.0 / 3.0;

/// The chosen cells of a test, small enough for walls that bend.
struct ChosenCells {
    cell_mm: f64,
    part: LoadedPart,
    /// Size of the cells of the comparison run over `cell_mm`.
    coarse: f64,
    bending: UnresolvedBending,
}

impl ChosenCells {
    /// Takes cells of the given size. Without a given size, cells are as large as a bead in a solid and half a bead in a
    /// plate; half a bead would give too many cells in a solid. If thin walls bend and no size is given, the cells become a
    /// quarter of the thickness of such a wall.
    fn new(
        setup: &TestSetup,
        sheets: &[BeadSheet],
        bead_mm: f64,
        given_mm: Option<f64>,
        cards: &[StrengthCard],
        limits: &Limits,
    ) -> Result<Self, StrengthError> {
        let (area_mm2, size) = (setup.section.area_mm2(), setup.high - setup.low);
        let (usual_mm, smallest_mm) =
            cell_sizes_mm(setup.fidelity, bead_mm, area_mm2, setup.volume_mm3, size);
        let mut cell_mm = given_mm.unwrap_or(usual_mm.max(smallest_mm));
        let mut coarse = COARSE;
        // Smaller cells give the thickness of a wall more precisely, so the search is repeated.
        let mut round = 0;
        loop {
            limits.cancel.check().map_err(TestError::from)?;
            let part = LoadedPart::new(setup, sheets, PlacedCells::unmoved(cell_mm))?;
            let bending = part.unresolved_bending(cards, limits)?;
            let needed_mm = bending.wall_mm / CELLS_ACROSS;
            let is_free = given_mm.is_none()
                && needed_mm >= smallest_mm
                && needed_mm < 0.95 * cell_mm
                && round < MAX_ROUNDS;
            if bending.share > RESOLVED && is_free {
                (cell_mm, coarse) = (needed_mm, COARSE_OF_WALLS);
                round += 1;
                continue;
            }
            if bending.share > MAX_UNRESOLVED {
                let fit = needed_mm >= smallest_mm;
                return Err(StrengthError::ThinWalls { wall_mm: bending.wall_mm, cell_mm, needed_mm, fit });
            }
            return Ok(Self { cell_mm, part, coarse, bending });
        }
    }
}

/// Text of the warning about thin walls whose bending the cells cannot represent.
fn thin_walls(bending: &UnresolvedBending, cell_mm: f64) -> String {
    format!(
        "strength: walls {:.2} mm thick bend and are only {:.1} cells of {cell_mm:.3} mm across; the peak may be up to {:.0} % too high",
        bending.wall_mm,
        bending.wall_mm / cell_mm,
        100.0 * bending.share
    )
}

/// Largest plausible ratio of extruded volume to the part's volume. A larger ratio means that the program's
/// E words have another unit.
const MAX_VOLUME_RATIO: f64 = 1.6;
/// Ratio of extruded volume to the part's volume above which the test warns. Source: derived. Between the sections of a
/// part with facets and its beads lie up to 2 %; flow is tuned to within 3 %.
const OVERFILLED: f64 = 1.05;
/// If the cells are halved, no warning is given up to this relative change of the peak load.
const CONVERGED: f64 = 0.03;

/// Tests a program. `plate_from_part` is the position of the part in the program, if known.
///
/// # Errors
/// [`StrengthError`] for cards without strengths, programs of another part, loads that act on no
/// material, and parts that are not held.
pub fn test(
    settings: &StrengthSettings,
    setup: &TestSetup,
    program: &Program,
    plate_from_part: Option<DVec2>,
    diagnostics: &Diagnostics,
) -> Result<Tested, StrengthError> {
    test_noting(settings, setup, program, plate_from_part, diagnostics, &|_| {})
}

/// As [`test()`], but calls `note` with a message as soon as the first result, on larger cells, is known.
///
/// # Errors
/// As [`test()`].
pub fn test_noting(
    settings: &StrengthSettings,
    setup: &TestSetup,
    program: &Program,
    plate_from_part: Option<DVec2>,
    diagnostics: &Diagnostics,
    note: &(dyn Fn(&str) + Sync),
) -> Result<Tested, StrengthError> {
    let start_s = diagnostics.now_s();
    let mut governing: Option<Tested> = None;
    let mut cases = Vec::new();
    for case in setup.all_cases() {
        let tested = test_case(settings, case, program, plate_from_part, diagnostics, note)?;
        let report = &tested.report;
        cases.push(CasePeak {
            case: report.case.clone(),
            peak_load_n: report.peak_load_n,
            low_n: report.low_n,
            high_n: report.high_n,
            job_load_n: report.job_load_n,
            factor: digits(report.peak_load_n / report.job_load_n),
        });
        let factor = |t: &Tested| t.report.peak_load_n / t.report.job_load_n;
        if governing.as_ref().is_none_or(|g| factor(&tested) < factor(g)) {
            governing = Some(tested);
        }
    }
    let mut tested = governing.ok_or(StrengthError::Missing("a [[guide.load]]"))?;
    if cases.len() > 1 {
        tested.report.cases = cases;
    }
    tested.report.seconds = digits(diagnostics.now_s() - start_s);
    Ok(tested)
}

/// Tests one load case.
fn test_case(
    settings: &StrengthSettings,
    setup: &TestSetup,
    program: &Program,
    plate_from_part: Option<DVec2>,
    diagnostics: &Diagnostics,
    note: &(dyn Fn(&str) + Sync),
) -> Result<Tested, StrengthError> {
    let start_s = diagnostics.now_s();
    // The strengths are checked first, so that a missing one is not found only after minutes of work.
    let nominal = settings.cards(CORNERS[0])?;
    if settings.keep_model && setup.fidelity != Fidelity::Plane {
        return Err(StrengthError::NoPlate);
    }
    diagnostics.begin(grainpath_core::diagnostics::Stage::Strength, 0);
    let (sheets, program_from_part_mm) = setup.sheets(program, plate_from_part)?;
    let frame = Frame::new(&sheets);
    let (setup, sheets) = (&setup.in_frame(frame), frame.beads(sheets));
    let laid_mm3: f64 = sheets.iter().flat_map(|s| &s.beads).map(|b| b.volume_mm3).sum();
    // E words in mm3, read as mm of 1.75 mm filament, give 2.4 times the volume.
    if laid_mm3 > MAX_VOLUME_RATIO * setup.volume_mm3 {
        let (part_mm3, filament_mm) = (setup.volume_mm3, settings.filament_mm);
        return Err(StrengthError::TooMuch { laid_mm3, part_mm3, filament_mm });
    }
    let mass_g = part_g(&sheets, settings);
    let limits = &Limits { max_mib: settings.max_mib, cancel: diagnostics.cancel_flag() };
    let chosen = ChosenCells::new(setup, &sheets, settings.bead_mm, settings.cell_mm, &nominal, limits)?;
    let cell_mm = chosen.cell_mm;
    let prepared = chosen.part;
    let corners = if settings.corners { &CORNERS[..] } else { &CORNERS[..1] };
    let coarse_mm = if settings.check || settings.corners { chosen.coarse * cell_mm } else { 0.0 };
    let first = |peak_n: f64| {
        let case = &setup.case().name;
        note(&format!(
            "{case}: about {} N on cells of {coarse_mm:.3} mm; going on with {cell_mm:.3} mm",
            three_digits(peak_n)
        ));
    };
    // The run on larger cells serves two purposes: the comparison of cell sizes, and the corners of
    // the card.
    let (others, outcome) = rayon::join(
        || at_corners(settings, setup, sheets, coarse_mm, corners, limits, &first),
        || prepared.run(&nominal, limits),
    );
    let mut outcome = outcome?;
    outcome.weakest = frame.to_part_3d(outcome.weakest);
    let CoarsePeaks { corners: others, moved_n } = others?;
    // The peaks at the corners are computed on the larger cells; only their ratios to the nominal peak are used.
    let ratio = |k: usize| if others.len() > k { others[k] / others[0] } else { 1.0 };
    let peaks: BTreeMap<&'static str, f64> =
        corners.iter().enumerate().map(|(k, c)| (c.name, digits(outcome.peak_load_n * ratio(k)))).collect();
    let placing_change = moved_n.zip(others.first()).map_or(0.0, |(moved, here)| (moved / here - 1.0).abs());
    // The change is relative to the peak on the smaller cells, which is the reported one.
    let mesh_change =
        others.first().filter(|_| settings.check).map(|o| (o / outcome.peak_load_n - 1.0).abs());
    warn(&outcome, &prepared, mesh_change, cell_mm, diagnostics);
    if laid_mm3 > OVERFILLED * setup.volume_mm3 {
        let text = format!(
            "strength: the program extrudes {laid_mm3:.0} mm3, {:.2} times the part's {:.0} mm3; what does not fit into its cells carries nothing",
            laid_mm3 / setup.volume_mm3,
            setup.volume_mm3
        );
        diagnostics.warn(WarningId::StrengthOverfilled, text);
    }
    if chosen.bending.share > RESOLVED {
        diagnostics.warn(WarningId::StrengthThinWalls, thin_walls(&chosen.bending, cell_mm));
    }
    let unresolved = if chosen.bending.share > RESOLVED { chosen.bending.share } else { 0.0 };
    let grid_share = mesh_change.unwrap_or(0.0).max(placing_change).max(unresolved).min(0.99);
    let fold = |f: fn(f64, f64) -> f64, from: f64| peaks.values().copied().fold(from, f);
    // The displacement is taken at the highest point, because the curve continues after the peak.
    let at_peak =
        outcome.curve.iter().max_by(|a, b| a.load_n.total_cmp(&b.load_n)).map_or(0.0, |p| p.displacement_mm);
    let report = StrengthReport {
        peak_load_n: digits(outcome.peak_load_n),
        low_n: digits(fold(f64::min, f64::INFINITY) * (1.0 - grid_share)),
        high_n: digits(fold(f64::max, 0.0) * (1.0 + grid_share)),
        stiffness_n_per_mm: digits(outcome.stiffness_n_per_mm),
        first_n: digits(outcome.first_failure_n),
        peak_displacement_mm: digits(at_peak),
        job_load_n: digits(prepared.load_n()),
        case: setup.case().name.clone(),
        mode: outcome.mode().name(),
        modes: FailureMode::ALL
            .iter()
            .zip(outcome.mode_shares)
            .filter(|m| m.1 > 5e-4)
            // A share below 0.05 % comes from rounding.
            .map(|(m, s)| (m.name(), digits(s)))
            .collect(),
        weakest: weakest(setup, &outcome),
        corners: peaks,
        mass_g: digits(mass_g),
        load_per_gram_n_g: digits(outcome.peak_load_n / mass_g.max(1e-12)),
        fidelity: setup.fidelity.name(),
        cell_mm: digits(cell_mm),
        thin_wall_mm: Some(chosen.bending.wall_mm).filter(|mm| (1e-9..CELLS_ACROSS * cell_mm).contains(mm)),
        mesh_change: mesh_change.map(digits),
        grid_share: digits(grid_share),
        cases: Vec::new(),
        volume_error: digits(prepared.volume_error()),
        dofs: outcome.dofs,
        solutions: outcome.solutions,
        seconds: digits(diagnostics.now_s() - start_s),
        card: settings.card(),
        card_source: settings.source(),
        card_tier: settings.material.strength_tier.name(),
        curve: outcome.curve.iter().map(|p| [p.displacement_mm, p.load_n].map(digits)).collect(),
    };
    let heights_mm = [setup.low.z, setup.high.z - setup.low.z];
    let model = match &prepared {
        LoadedPart::Plane(p) if settings.keep_model => {
            Some(plate_test(p, &nominal, limits).model().map_err(TestError::from)?)
        }
        _ => None,
    };
    Ok(Tested { report, outcome, map: prepared.map(), model, frame, program_from_part_mm, heights_mm })
}

/// Mass of the beads that are tested, g: without skirt, brim and support, also where a program does not say which beads
/// these are.
fn part_g(sheets: &[BeadSheet], settings: &StrengthSettings) -> f64 {
    let density = |b: &BeadPiece| match (b.material, &settings.fibre) {
        (1.., Some(fibre)) => fibre.density_g_cm3,
        _ => settings.material.density_g_cm3,
    };
    sheets.iter().flat_map(|s| &s.beads).map(|b| b.volume_mm3 * 1e-3 * density(b)).sum()
}

fn run(prepared: &Prepared, cards: &[StrengthCard], limits: &Limits) -> Result<Outcome, TestError> {
    plate_test(prepared, cards, limits).run()
}

fn plate_test<'a>(prepared: &'a Prepared, cards: &'a [StrengthCard], limits: &Limits) -> PlateTest<'a> {
    PlateTest {
        laminate: &prepared.laminate,
        elements: &prepared.elements,
        holds: &prepared.holds,
        forces_n: &prepared.forces_n,
        load_n: prepared.load_n,
        unbreakable: &prepared.unbreakable,
        cards,
        max_mib: limits.max_mib,
        cancel: limits.cancel.clone(),
    }
}

/// Peak loads at the corners of the card ([`Corner`]), nominal first. The result is empty for a cell size of zero. The
/// beads are freed as soon as no cells are made of them any more, since the other run goes on beside this one.
fn at_corners(
    settings: &StrengthSettings,
    setup: &TestSetup,
    sheets: Vec<BeadSheet>,
    cell_mm: f64,
    corners: &[Corner],
    limits: &Limits,
    first: &(dyn Fn(f64) + Sync),
) -> Result<CoarsePeaks, StrengthError> {
    if cell_mm <= 0.0 {
        return Ok(CoarsePeaks::default());
    }
    // Geometry and loads do not depend on the strengths, so the same loaded part is used for all corners.
    let prepared = LoadedPart::new(setup, &sheets, PlacedCells::unmoved(cell_mm))?;
    limits.cancel.check().map_err(TestError::from)?;
    let peak = |corner: &Corner| Ok(prepared.run(&settings.cards(*corner)?, limits)?.peak_load_n);
    let nominal = peak(&corners[0])?;
    first(nominal);
    let (rest, moved_n) = rayon::join(
        || corners[1..].par_iter().map(peak).collect::<Vec<Result<f64, StrengthError>>>(),
        || {
            let moved = LoadedPart::new(setup, &sheets, PlacedCells { size_mm: cell_mm, moved: 0.5 })?;
            drop(sheets);
            Ok::<f64, StrengthError>(moved.run(&settings.cards(corners[0])?, limits)?.peak_load_n)
        },
    );
    let corners = std::iter::once(Ok(nominal)).chain(rest).collect::<Result<_, _>>()?;
    Ok(CoarsePeaks { corners, moved_n: Some(moved_n?) })
}

/// Peak loads on larger cells, N.
#[derive(Default)]
struct CoarsePeaks {
    /// Peak loads at the corners of the card, nominal first.
    corners: Vec<f64>,
    /// The nominal peak load with the grid shifted by half a cell.
    moved_n: Option<f64>,
}

fn warn(
    outcome: &Outcome,
    prepared: &LoadedPart,
    mesh_change: Option<f64>,
    cell_mm: f64,
    diagnostics: &Diagnostics,
) {
    if let Some(change) = mesh_change.filter(|c| *c > CONVERGED) {
        let text = format!(
            "strength: the peak load moved by {:.1} % when cells were halved to {cell_mm} mm",
            100.0 * change
        );
        let remedy = format!("set strength.cell_mm = {:.3}", 0.5 * cell_mm);
        diagnostics.push(Warning::new(WarningId::StrengthNotConverged, text).with_remedy(remedy));
    }
    // Up to one percent of loose material gives no warning: a few detached beads are normal and carry no load.
    if prepared.lost() > 0.01 {
        diagnostics.warn(
            WarningId::StrengthLooseMaterial,
            format!(
                "strength: {:.1} % of the material is not connected to any fixture and is left out",
                100.0 * prepared.lost()
            ),
        );
    }
    if !outcome.past_peak {
        diagnostics.warn(
            WarningId::StrengthUnfinished,
            "strength: the load was still rising when the test was stopped; the peak is a lower bound",
        );
    }
}

/// The place where a part fails, in words.
fn weakest(setup: &TestSetup, outcome: &Outcome) -> Weakest {
    let p = outcome.weakest;
    let size = setup.high - setup.low;
    let share = |k: usize| 100.0 * (p[k] - setup.low[k]) / size[k].max(1e-9);
    let how = match outcome.mode() {
        FailureMode::Along => "as beads tear",
        FailureMode::Across => "as beads part from each other",
        FailureMode::Shear => "as beads slide along each other",
        FailureMode::Compression => "by crushing",
        FailureMode::Layers => "as layers part",
    };
    let round = |v: f64| (v * 100.0).round() * 0.01;
    let (x_mm, y_mm) = (round(p.x), round(p.y));
    if setup.fidelity == Fidelity::Voxels {
        // Layers are counted from 1 at the bottom.
        let layer = (0.01 * share(2) * setup.n_layers as f64).ceil().clamp(1.0, setup.n_layers as f64);
        let words = format!(
            "x {:.1}, y {:.1}, z {:.1} mm ({:.0} % of the length, {:.0} % of the width, layer {layer:.0} of {}); it \
             fails {how}",
            p.x,
            p.y,
            p.z,
            share(0),
            share(1),
            setup.n_layers,
        );
        return Weakest { x_mm, y_mm, z_mm: Some(round(p.z)), words };
    }
    let words = format!(
        "x {:.1}, y {:.1} mm ({:.0} % of the length, {:.0} % of the width), {}; it fails {how}",
        p.x,
        p.y,
        share(0),
        share(1),
        beside(setup, p.truncate()),
    );
    Weakest { x_mm, y_mm, z_mm: None, words }
}

/// Describes where a point of a plate lies: at a hole or at the border, and how far from it.
fn beside(setup: &TestSetup, p: DVec2) -> String {
    let mut near = (f64::INFINITY, false, DVec2::ZERO);
    for polygon in &setup.section.polygons {
        let contours =
            std::iter::once((&polygon.outer, false)).chain(polygon.holes.iter().map(|h| (h, true)));
        for (contour, is_hole) in contours {
            // The mean of the vertices only names the hole, so it need not be the centroid.
            let middle = contour.iter().copied().sum::<DVec2>() / contour.len().max(1) as f64;
            for (a, b) in grainpath_core::poly::edges(contour) {
                let distance = grainpath_core::segment::distance_squared_mm2(p, a, b).sqrt();
                if distance < near.0 {
                    near = (distance, is_hole, middle);
                }
            }
        }
    }
    let (off, is_hole, middle) = near;
    let whose = match is_hole {
        true => format!("the hole around ({:.1}, {:.1})", middle.x, middle.y),
        false => "the border".to_owned(),
    };
    if off < 1.0 { format!("at {whose}") } else { format!("{off:.1} mm from {whose}") }
}

/// Rounds to five significant digits, which is more precise than a test can be; more would differ between compilers.
pub(crate) fn digits(v: f64) -> f64 {
    format!("{v:.4e}").parse().unwrap_or(v)
}

/// A number for people, with three significant digits; digits before the point are never cut.
///
/// ```
/// use grainpath::measure::strength::three_digits;
///
/// let shown = [0.47424, 2.9966, 9.999, 66.02, 1066.4, 0.0].map(three_digits);
/// assert_eq!(shown, ["0.474", "3.00", "10.0", "66.0", "1066", "0"]);
/// ```
pub fn three_digits(v: f64) -> String {
    // The exponent of the rounded number: 9.999 is 10.0.
    let power = format!("{v:.2e}").split_once('e').and_then(|(_, power)| power.parse::<i32>().ok());
    let decimals = if v == 0.0 { 0 } else { (2 - power.unwrap_or(0)).clamp(0, 9) as usize };
    format!("{v:.decimals$}")
}

impl StrengthReport {
    /// The interval of the peak load, in words, which say what it is over.
    pub fn over(&self) -> String {
        if self.low_n == self.high_n {
            return "nominal card alone".to_owned();
        }
        format!("{} to {} N {}", three_digits(self.low_n), three_digits(self.high_n), self.over_what())
    }

    /// What the interval of the peak load is over. The nominal card alone says nothing about the scatter of the material.
    pub fn over_what(&self) -> &'static str {
        if self.corners.len() > 1 {
            "over the card of the material and the grid"
        } else {
            "over the grid alone, with the nominal card"
        }
    }

    /// The result in a few lines, for the terminal.
    pub fn summary(&self) -> String {
        let mesh =
            self.mesh_change.map_or(String::new(), |c| format!(", {:.1} % change when halved", 100.0 * c));
        let over = self.over();
        let walls = self.thin_wall_mm.map_or(String::new(), |wall_mm| {
            format!(
                "\nthe first failure, at {} N, is uncertain: walls {wall_mm:.2} mm thick bend and are fewer than four cells across",
                three_digits(self.first_n)
            )
        });
        let cases: String = (self.cases.iter())
            .map(|c| {
                format!(
                    "\nload case {:?}: {} N ({} to {} N), {} times the job's load",
                    c.case,
                    three_digits(c.peak_load_n),
                    three_digits(c.low_n),
                    three_digits(c.high_n),
                    three_digits(c.factor)
                )
            })
            .collect();
        format!(
            "breaks at {} N ({over}), stiffness {} N/mm, {} N per gram\n\
             fails mostly {}; weakest at {}\n\
             {} test, cells of {} mm{mesh}; {} unknowns, {} solutions, {:.1} s{walls}{cases}",
            three_digits(self.peak_load_n),
            three_digits(self.stiffness_n_per_mm),
            three_digits(self.load_per_gram_n_g),
            self.mode,
            self.weakest.words,
            self.fidelity,
            self.cell_mm,
            self.dofs,
            self.solutions,
            self.seconds,
        )
    }
}
