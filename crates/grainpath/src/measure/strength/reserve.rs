//! Computes the reserve, the factor on the loads of a case at which the printed part begins to fail, without the virtual
//! test.
//!
//! Method: the beads become the cells of the virtual test ([`Laminate`] for plates, [`Bricks`] for solids). The ply that
//! fails first is found in one of two ways:
//!
//! - The cells of a plate, and those of a solid with sparse infill or without walls, are solved once for each case, as the virtual
//!   test solves them before anything fails: there load moves from infill to walls and skins and to the few places where beads
//!   touch, which the stress of a solid part does not show. Cells smaller than `LEAST_CELL_BEADS` are not needed where the
//!   first failure is told over a length (`strain_fit` of `grainpath-fea`).
//! - In a dense solid with walls, the guide's stress, which was solved for a solid part, acts on the written beads. The
//!   stress of a cell is the stress at its centre, divided by the contact with the layer below around it
//!   ([`first_failure`](grainpath_fea::strength::first_failure)). Cells near fixtures and loads (closer than 1.5 mm plus
//!   1.75 cells) do not count, because the test does not let them fail. Dense plates whose loads the test does not have are
//!   judged in the same way.
//!
//! Parts of more than `MOST_CELLS` cells get larger ones. Their indices are scaled to the cells of the test.
//!
//! The report states three factors, for the low, nominal and high strengths of the material's card. The low and the high
//! factor are moved apart by `METHOD`, and by the mesh error of the stress or the size of the cells.
//!
//! `crates/grainpath-cli/tests/reserve.rs` compares the reserve with the first failure in the test; `docs/validation.md`
//! has the table. Cost: linear in cells and beads in dense solids; one solution of the virtual test, which takes hundreds,
//! in others. Limits: in a dense solid, notches of the infill at a curved border are not resolved; no reserve is stated if
//! the peak of the stress cannot be trusted, or if the cells of an uneven part cannot have its loads.

use grainpath_core::selection::Selection;
use grainpath_core::{DVec2, DVec3, Diagnostics, LayerStack, math};
use grainpath_fea::strength::bricks::Bricks;
use grainpath_fea::strength::card::StrengthCard;
use grainpath_fea::strength::first_failure::{
    FirstFailure, IndexScale, first_failure_of_bricks, first_failure_of_plate,
};
use grainpath_fea::strength::grid_turn::Frame;
use grainpath_fea::strength::laminate::{BeadSheet, Laminate};
use grainpath_fea::strength::reserve_map::ReserveMap;
use grainpath_gcode::Program;
use serde::Serialize;

use super::setup::{Fidelity, is_staggered, layers_of_part, sheets_of};
use super::{
    BeadCells, CORNERS, Corner, Limits, LoadedPart, PlacedCells, StrengthError, StrengthSettings, TestSetup,
    cell_sizes_mm, digits,
};
use crate::guide::{CaseStress, Guide};

/// The corners of the card for which the reserve is stated: all strengths low, nominal, high.
const TOLD: [Corner; 3] = [CORNERS[1], CORNERS[0], CORNERS[2]];
/// Shares by which the interval is widened downwards and upwards, besides card and mesh error. Measured: with cells of a
/// bead width, six test parts lie within 15 % of the first failure in the virtual test; with cells of half a bead width, the
/// test resolves notches of curved borders, and a corner with a fillet fails 29 % below its reserve (docs/validation.md).
const METHOD: [f64; 2] = [0.3, 0.15];
/// Largest number of cells of a part, in a plate and in a solid, as the filled section or volume over that of a cell. Larger parts
/// get larger cells than those of the virtual test. Measured: a block of 24 000 mm3 with sparse `grid` takes 15 % of the time of
/// its guide with 60 000 cells and 35 % with 100 000, a dense bracket of 33 000 mm3 takes 23 % with cells of 0.82 mm and 79 %
/// with 360 000 cells of 0.45 mm.
const MOST_CELLS: [f64; 2] = [40_000.0, 60_000.0];
/// What larger cells than those of the test tell, as powers of their size over that of the test's cells.
struct LargerCells {
    /// The first failure is higher by this power.
    exponent: IndexScale,
    /// The interval is wider by this power.
    spread: f64,
}

/// Where single cells are judged, as in fibre, larger ones show less of the notches where beads meet. Measured: with
/// cells of 0.45 and 0.9 mm, first failure in the plane of ten bars and blocks of sparse grid, gyroid and stripes rises 1.05 to
/// 1.8 times (1.27 in the mean), that between layers of ten 1.06 to 3.0 times (1.77); four plates judged so with cells of 0.225
/// and 0.45 mm have 1.10 to 1.53 (1.26). The interval holds the smallest and the largest of these.
const OF_SINGLE_CELLS: LargerCells =
    LargerCells { exponent: IndexScale { in_plane: 0.34, between_layers: 0.82 }, spread: 0.75 };
/// Plates that are judged over a length hardly depend on their cells. Measured: with cells of 0.225 and 0.45 mm, first failure
/// of eight plates of the gallery differs by -4 to 12 % (2 in the mean), and by -7 to 13 % with sparse and graded fills.
const OF_PLATES: LargerCells =
    LargerCells { exponent: IndexScale { in_plane: 0.0, between_layers: 0.0 }, spread: 0.15 };
/// Solids that are judged over a length. Measured: on nine sparse bars and blocks first failure rises 1.00 to 1.26 times (1.08 in
/// the mean) from cells of 0.45 to 0.6 mm, and 1.04 to 1.49 times (1.24) to 0.9 mm (docs/validation.md).
const OF_SOLIDS: LargerCells =
    LargerCells { exponent: IndexScale { in_plane: 0.25, between_layers: 0.25 }, spread: 0.5 };
/// The least size of the cells on which a plate and a solid that are judged over a length are solved, in widths of a bead. Measured:
/// with these sizes eight plates and nine sparse solids tell 0.93 to 1.17 times the first failure of the test on its smaller cells.
const LEAST_CELL_BEADS: [f64; 2] = [1.0, 4.0 / 3.0];

/// The factor on the job's loads at first failure, for the case with the least factor.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct ReserveReport {
    #[serde(flatten)]
    pub least: Option<CaseReserve>,
    /// Every load case, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cases: Vec<CaseReserve>,
    /// The reason, if no reserve is stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub untold: Option<String>,
    pub seconds: f64,
    /// The reserve of every bead, least over the load cases.
    #[serde(skip)]
    pub map: Option<ReserveMap>,
}

/// The reserve of one load case.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct CaseReserve {
    /// The factors on the case's loads at first failure with the low, nominal and high strengths of the material.
    pub first_failure: [f64; 3],
    pub case: String,
    pub mode: &'static str,
    /// Position of the first failure, part coordinates.
    pub at_mm: [f64; 3],
    /// Number of the layer of the first failure, from 1. In a plate, the lowest layer with beads in the failing direction.
    pub layer: usize,
}

impl ReserveReport {
    fn untold(why: String) -> Self {
        Self { least: None, cases: Vec::new(), untold: Some(why), seconds: 0.0, map: None }
    }

    /// Names and values for the terminal and the report page.
    pub fn rows(&self) -> Vec<(String, String)> {
        let Some(least) = &self.least else {
            let why = self.untold.as_deref().unwrap_or_default();
            return vec![("first failure".into(), format!("none told: {why}"))];
        };
        let all = if self.cases.is_empty() { std::slice::from_ref(least) } else { &self.cases };
        let row = |c: &CaseReserve| {
            let ([low, nominal, high], [x, y, z]) = (c.first_failure, c.at_mm);
            let below = if nominal < 1.0 { "; the part begins to fail below its load" } else { "" };
            let what = match all.len() {
                1 => "first failure".into(),
                _ => format!("first failure, case {}", c.case),
            };
            let value = format!(
                "at {nominal:.2} times the load ({low:.2} to {high:.2}), {} at ({x:.1}, {y:.1}, {z:.1}) mm, layer {}{below}",
                c.mode, c.layer
            );
            (what, value)
        };
        all.iter().map(row).collect()
    }
}

/// The factors for the low, nominal and high strengths of a card, with the interval widened by mesh error and method.
pub(crate) fn interval(guide: &Guide, first_failure: [f64; 3]) -> [f64; 3] {
    widened(first_failure, guide.summary.error_estimate.min(1.0))
}

/// An interval widened by `METHOD` and by a mesh error.
fn widened([low, nominal, high]: [f64; 3], missed: f64) -> [f64; 3] {
    [low * (1.0 - METHOD[0]) * (1.0 - missed), nominal, high * (1.0 + METHOD[1]) * (1.0 + missed)]
}

/// A planned part whose stress was solved.
#[derive(Clone, Copy)]
pub struct StressedPart<'a> {
    /// Its stress.
    pub guide: &'a Guide,
    /// Its layers with their sections.
    pub stack: &'a LayerStack,
    /// Vector from part coordinates to program coordinates, mm.
    pub plate_from_part_mm: DVec2,
    /// Fixtures and loads for a solution on the cells of its beads, for plates and for parts whose beads do not share the load
    /// evenly: with sparse infill, fibre, or without walls. `None` for other parts.
    pub on_cells: Option<&'a Result<TestSetup, StrengthError>>,
}

/// Computes the reserve of a part from its written program.
pub fn reserve(
    settings: &StrengthSettings,
    part: StressedPart<'_>,
    program: &Program,
    diagnostics: &Diagnostics,
) -> ReserveReport {
    let start_s = diagnostics.now_s();
    let told = LaidCells::new(settings, part, program).and_then(|cells| match part.on_cells {
        None => cells.reserve(part.guide),
        Some(Err(why)) => Err(Untold::Uneven(why.clone())),
        Some(Ok(setup)) => {
            let limits = Limits { max_mib: settings.max_mib, cancel: diagnostics.cancel_flag() };
            cells.reserve_on_cells(setup, &limits)
        }
    });
    let mut report = told.unwrap_or_else(|e| ReserveReport::untold(e.to_string()));
    report.seconds = digits(diagnostics.now_s() - start_s);
    report
}

/// Why no reserve is stated.
#[derive(Debug, thiserror::Error)]
enum Untold {
    #[error("the peak of the stress cannot be trusted")]
    Peak,
    #[error("the whole part lies near fixtures and loads, where failure is not evaluated")]
    Nothing,
    #[error(
        "sparse infill, fibre or open borders share the load unevenly, and the forces in the beads cannot be solved: {0}"
    )]
    Uneven(StrengthError),
    #[error(transparent)]
    Strength(#[from] StrengthError),
}

/// The report of the reserves of all cases.
fn least_of(found: Vec<CaseReserve>, map: Option<ReserveMap>) -> Result<ReserveReport, Untold> {
    let nominal = |c: &&CaseReserve| c.first_failure[1];
    let least = found.iter().min_by(|a, b| nominal(a).total_cmp(&nominal(b))).cloned();
    let least = Some(least.ok_or(Untold::Nothing)?);
    let cases = if found.len() > 1 { found } else { Vec::new() };
    Ok(ReserveReport { least, cases, untold: None, seconds: 0.0, map })
}

/// The beads of a part, with all that is needed to turn them into cells.
struct LaidCells<'a> {
    sheets: Vec<BeadSheet>,
    /// Sheets of each layer.
    sheets_a_layer: usize,
    frame: Frame,
    /// The cards with low, nominal and high strengths, each list in the numbering of the materials.
    cards: [Vec<StrengthCard>; 3],
    fidelity: Fidelity,
    cell_mm: f64,
    /// Size of the cells of the virtual test.
    test_mm: f64,
    /// Whether the first failure is told over a length and not by single cells.
    is_over_a_length: bool,
    floor_mm: f64,
    program_from_part_mm: DVec3,
    stack: &'a LayerStack,
    /// The regions near fixtures and loads, which are left out.
    grips: Vec<Selection>,
}

impl<'a> LaidCells<'a> {
    fn new(settings: &StrengthSettings, part: StressedPart<'a>, program: &Program) -> Result<Self, Untold> {
        let StressedPart { guide, stack, plate_from_part_mm: shift, on_cells } = part;
        let [low, nominal, high] = TOLD;
        let cards = [settings.cards(low)?, settings.cards(nominal)?, settings.cards(high)?];
        if !guide.is_trusted() {
            return Err(Untold::Peak);
        }
        let fidelity = match on_cells {
            Some(Ok(setup)) => setup.fidelity,
            _ if guide.is_plate => Fidelity::Plane,
            _ => Fidelity::Voxels,
        };
        if fidelity == Fidelity::Voxels && settings.fibre.is_some() {
            return Err(StrengthError::FibreInSpace.into());
        }
        let (layers, heights, bottom_mm) = layers_of_part(program);
        let sheets = sheets_of(&layers, &heights, shift, settings.fibre.is_some(), &|_| true);
        let sheets_a_layer = 1 + usize::from(is_staggered(&layers));
        let frame = Frame::new(&sheets);
        let sheets = frame.beads(sheets);
        let of_stack = stack.layers();
        let middle = of_stack.get(of_stack.len() / 2).map_or(0.0, |l| l.region().area_mm2());
        let volume_mm3 = of_stack.iter().map(|l| l.region().area_mm2() * l.height_mm()).sum();
        let bounds = of_stack.iter().filter_map(|l| l.region().bounds()).reduce(|a, b| a.union(b));
        let tall: f64 = of_stack.iter().map(|l| l.height_mm()).sum();
        let size = bounds.map_or(DVec2::ZERO, |b| b.size()).extend(tall);
        let (usual_mm, smallest_mm) = cell_sizes_mm(fidelity, settings.bead_mm, middle, volume_mm3, size);
        let test_mm = settings.cell_mm.unwrap_or(usual_mm.max(smallest_mm));
        // All cells of a large part would take longer than everything else in the run. Those of a dense plate are few.
        let [of_plate, of_solid] = MOST_CELLS;
        // Where the first failure is that of single cells, it depends on their size, so cells of the test are not made larger
        // without need.
        let is_over_a_length = cards[1].iter().all(|card| {
            card.fails_over_a_length() && (fidelity == Fidelity::Plane || card.layers_part_over_a_length())
        });
        let least_mm =
            LEAST_CELL_BEADS.map(|beads| if is_over_a_length { beads * settings.bead_mm } else { 0.0 });
        let cell_mm = match (on_cells, fidelity) {
            (None, Fidelity::Plane) => test_mm,
            (None, Fidelity::Voxels) => test_mm.max((volume_mm3 / of_solid).cbrt()),
            (Some(_), Fidelity::Plane) => test_mm.max(least_mm[0]).max((middle / of_plate).sqrt()),
            (Some(_), Fidelity::Voxels) => test_mm.max(least_mm[1]).max((volume_mm3 / of_solid).cbrt()),
        };
        let grips = guide.grips(cell_mm);
        let floor_mm = of_stack.first().map_or(0.0, |l| l.z_top_mm() - l.height_mm());
        let program_from_part_mm = shift.extend(bottom_mm - floor_mm);
        Ok(Self {
            sheets,
            sheets_a_layer,
            frame,
            cards,
            fidelity,
            cell_mm,
            test_mm,
            is_over_a_length,
            floor_mm,
            program_from_part_mm,
            stack,
            grips,
        })
    }

    /// The reserve from the stress of the guide, for dense parts.
    fn reserve(&self, guide: &Guide) -> Result<ReserveReport, Untold> {
        let (found, map) = match self.fidelity {
            Fidelity::Plane => self.of_plate(guide)?,
            Fidelity::Voxels => self.of_solid(guide)?,
        };
        least_of(found, Some(map))
    }

    /// The reserve from a solution on the cells of the beads, for parts whose beads do not share the load evenly.
    fn reserve_on_cells(&self, setup: &TestSetup, limits: &Limits) -> Result<ReserveReport, Untold> {
        let cells = BeadCells::new(setup, &self.sheets, PlacedCells::unmoved(self.cell_mm))?;
        let (scale, spread) = self.for_larger_cells();
        let (mut found, mut map) = (Vec::new(), None);
        for case in setup.all_cases() {
            let loaded = LoadedPart::on(&case.in_frame(self.frame), &cells)?;
            let judged = loaded.first_failures(&self.cards, scale, limits)?;
            map.get_or_insert_with(|| {
                loaded.reserve_map(self.floor_mm, self.frame, self.program_from_part_mm)
            })
            .add_case(&judged.of_plies);
            let place = |first: &FirstFailure| {
                let at = loaded.centre(first.cell, 0.5 * (case.low.z + case.high.z));
                let layer = match self.fidelity {
                    Fidelity::Plane => self.layer_of_ply(at.truncate(), first.angle_rad),
                    Fidelity::Voxels => self.layer_at(at.z),
                };
                (self.frame.to_part_3d(at), layer)
            };
            let widen = |[low, nominal, high]: [f64; 3]| widened([low / spread, nominal, high * spread], 0.0);
            found.extend(self.told(&case.case().name, judged.first, &widen, &place));
        }
        least_of(found, map)
    }

    /// What larger cells than those of the test ask for: a factor on indices, which are raised by what larger cells miss in the
    /// mean of many parts, and one on the interval, for how far single parts are from that.
    fn for_larger_cells(&self) -> (IndexScale, f64) {
        let larger = self.cell_mm / self.test_mm;
        let LargerCells { exponent, spread } = match (self.is_over_a_length, self.fidelity) {
            (false, Fidelity::Plane | Fidelity::Voxels) => OF_SINGLE_CELLS,
            (true, Fidelity::Plane) => OF_PLATES,
            (true, Fidelity::Voxels) => OF_SOLIDS,
        };
        let scale = IndexScale {
            in_plane: math::pow(larger, exponent.in_plane),
            between_layers: math::pow(larger, exponent.between_layers),
        };
        (scale, math::pow(larger, spread))
    }

    fn of_plate(&self, guide: &Guide) -> Result<(Vec<CaseReserve>, ReserveMap), Untold> {
        let laminate = Laminate::from_layers(&self.sheets, self.cell_mm).map_err(StrengthError::from)?;
        let grid = laminate.grid;
        let layers = self.stack.layers();
        let middle_mm =
            layers.get(layers.len() / 2).map_or(self.floor_mm, |l| l.z_top_mm() - 0.5 * l.height_mm());
        let at: Vec<DVec3> = (0..grid.nx * grid.ny)
            .map(|cell| self.frame.to_part(grid.centre(cell)).extend(middle_mm))
            .collect();
        let held: Vec<bool> = at.iter().map(|p| self.is_held(*p)).collect();
        let mut map = ReserveMap::of_plate(&laminate, self.floor_mm, self.frame, self.program_from_part_mm);
        let mut found = Vec::new();
        for case in &guide.cases {
            let stress = |cell: usize| {
                let [xx, yy, _, xy, ..] = self.stress(case, at[cell])?;
                (!held[cell]).then_some([xx, yy, xy])
            };
            let judged = first_failure_of_plate(&laminate, &self.cards, &stress)
                .map_err(|e| StrengthError::Test(e.into()))?;
            map.add_case(&judged.of_plies);
            let layer = |first: &FirstFailure| self.layer_of_ply(grid.centre(first.cell), first.angle_rad);
            let widen = |first_failure| interval(guide, first_failure);
            let place = |first: &FirstFailure| (at[first.cell], layer(first));
            found.extend(self.told(&case.name, judged.first, &widen, &place));
        }
        Ok((found, map))
    }

    fn of_solid(&self, guide: &Guide) -> Result<(Vec<CaseReserve>, ReserveMap), Untold> {
        let bricks =
            Bricks::from_layers(&self.sheets, self.cell_mm, self.floor_mm).map_err(StrengthError::from)?;
        let at = |cell: usize| self.frame.to_part_3d(bricks.centre(cell));
        let cards: [StrengthCard; 3] = std::array::from_fn(|k| self.cards[k][0]);
        let mut map = ReserveMap::of_bricks(&bricks, self.frame, self.program_from_part_mm);
        let (scale, spread) = self.for_larger_cells();
        let mut found = Vec::new();
        for case in &guide.cases {
            let stress = |cell: usize| {
                let p = at(cell);
                if bricks.filled[cell] <= LEAST_FILLED || self.is_held(p) {
                    return None;
                }
                self.stress(case, p)
            };
            let judged = first_failure_of_bricks(&bricks, &cards, scale, &stress)
                .map_err(|e| StrengthError::Test(e.into()))?;
            map.add_case(&judged.of_plies);
            let place = |first: &FirstFailure| {
                let p = at(first.cell);
                (p, self.layer_at(p.z))
            };
            let widen =
                |[low, nominal, high]: [f64; 3]| interval(guide, [low / spread, nominal, high * spread]);
            found.extend(self.told(&case.name, judged.first, &widen, &place));
        }
        Ok((found, map))
    }

    /// The reserve of a case from its first failures with low, nominal and high strengths.
    fn told(
        &self,
        case: &str,
        corners: [Option<FirstFailure>; 3],
        widen: &dyn Fn([f64; 3]) -> [f64; 3],
        place: &dyn Fn(&FirstFailure) -> (DVec3, usize),
    ) -> Option<CaseReserve> {
        let [low, nominal, high] = corners;
        let factor = |f: Option<FirstFailure>| f.filter(|f| f.index > 0.0).map(|f| 1.0 / f.index);
        let first = nominal?;
        let (at, layer) = place(&first);
        let first_failure = widen([factor(low)?, factor(nominal)?, factor(high)?]).map(digits);
        let round = |v: f64| (v * 100.0).round() / 100.0;
        Some(CaseReserve {
            first_failure,
            case: case.to_owned(),
            mode: first.mode.name(),
            at_mm: at.to_array().map(round),
            layer,
        })
    }

    fn is_held(&self, p: DVec3) -> bool {
        self.grips.iter().any(|on| on.contains(p))
    }

    /// The stress of a case at a point of the part, in grid coordinates.
    fn stress(&self, case: &CaseStress, p: DVec3) -> Option<[f64; 6]> {
        let [xx, yy, zz, xy, yz, zx] = case.stress.whole(p);
        let DVec2 { x: c, y: s } = self.frame.to_part(DVec2::X);
        let turned = [
            c * c * xx + s * s * yy + 2.0 * s * c * xy,
            s * s * xx + c * c * yy - 2.0 * s * c * xy,
            zz,
            s * c * (yy - xx) + (c * c - s * s) * xy,
            c * yz - s * zx,
            s * yz + c * zx,
        ];
        turned.iter().all(|s| s.is_finite()).then_some(turned)
    }

    /// Number of the layer at a height, from 1.
    fn layer_at(&self, z_mm: f64) -> usize {
        let layers = self.stack.layers();
        layers.partition_point(|l| l.z_top_mm() < z_mm).min(layers.len().saturating_sub(1)) + 1
    }

    /// Number of the lowest layer, from 1, that has a bead of about this direction at a point of the grid.
    fn layer_of_ply(&self, p: DVec2, angle_rad: f64) -> usize {
        let along = math::direction(angle_rad);
        let near = |s: &BeadSheet| {
            s.beads.iter().any(|b| {
                let (d, wide) = (b.b - b.a, b.volume_mm3 / (b.a.distance(b.b) * s.height_mm).max(1e-12));
                let off = grainpath_core::segment::distance_squared_mm2(p, b.a, b.b);
                // A ply averages beads within a fan of 22.5 degrees, so directions may differ by that much here.
                off <= (0.5 * wide + self.cell_mm).powi(2) && d.dot(along).abs() >= 0.92 * d.length()
            })
        };
        self.sheets.iter().position(near).map_or(1, |k| k / self.sheets_a_layer + 1)
    }
}

/// Smallest filled share of a cell that counts, as in the test of solids. Source: `LEAST_FILLED` of `brick_setup`.
const LEAST_FILLED: f32 = 0.06;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_tells_what_it_knows() {
        let case = |name: &str, nominal: f64| CaseReserve {
            first_failure: [0.8 * nominal, nominal, 1.2 * nominal],
            case: name.into(),
            mode: "along the beads",
            at_mm: [1.0, 2.0, 3.0],
            layer: 4,
        };
        let one = ReserveReport {
            least: Some(case("pull", 0.5)),
            untold: None,
            ..ReserveReport::untold("".into())
        };
        let [(what, value)] = &one.rows()[..] else { panic!("a row") };
        assert_eq!(what, "first failure");
        assert!(
            value.contains("0.50 times the load (0.40 to 0.60)") && value.ends_with("below its load"),
            "{value}"
        );
        let json = serde_json::to_value(&one).expect("JSON");
        assert_eq!(json["first_failure"][1], 0.5);
        assert_eq!(json["layer"], 4);
        let untold = ReserveReport::untold("no card".into());
        assert_eq!(untold.rows()[0].1, "none told: no card");
        assert!(serde_json::to_value(&untold).expect("JSON")["first_failure"].is_null());
    }
}
