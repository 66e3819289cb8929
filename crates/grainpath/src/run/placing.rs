//! Places a mesh on the bed, repairs and slices it, and checks that the part fits the bed.

use grainpath_core::units::LengthUnit;
use grainpath_core::{Bounds2, DVec2, DVec3, Diagnostics, Layer, LayerStack, TriMesh, Warning, WarningId};
use grainpath_gcode::{GcodeError, Machine};
use grainpath_io::{MeshFile, PaintedSupports};

use crate::error::Error;
use crate::shape::{self, Placement, Repair, SliceSettings};
use crate::wall::adhesion::AdhesionSettings;

/// A shape in layers, standing on the bed.
#[derive(Debug, Default)]
pub struct Sliced {
    /// Its sections.
    pub stack: LayerStack,
    /// Its surface; empty where no stage needs it.
    pub mesh: TriMesh,
    /// Distance by which it was lowered to stand on the plate, mm.
    pub lowered_mm: f64,
    /// Support enforcers and blockers painted on its surface.
    pub painted: PaintedSupports,
    /// The unit that was assumed for a mesh whose file states none.
    pub assumed_unit: Option<LengthUnit>,
    pub(super) scan: Option<grainpath_imaging::scan::CtReport>,
}

/// Settings for placing a mesh on the bed, repairing and slicing it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceSettings {
    /// Unit, scale and rotation.
    pub placement: Placement,
    /// Whether a unit that the file states replaces that of the placement.
    pub unit_of_file: bool,
    /// Height by which the part is lifted off the bed, mm.
    pub lift_mm: f64,
    /// Treatment of defects.
    pub repair: Repair,
    /// Layer heights and sections.
    pub slicing: SliceSettings,
}

/// A mesh standing on the bed, not yet cut into layers.
#[derive(Debug, Default)]
pub struct Placed {
    /// The surface, repaired.
    pub mesh: TriMesh,
    /// Distance by which it was lowered to stand on the plate, mm.
    pub lowered_mm: f64,
    /// Support enforcers and blockers painted on it.
    pub painted: PaintedSupports,
    /// The unit that was assumed, if the file states none and the settings leave it to the file.
    pub assumed_unit: Option<LengthUnit>,
}

/// Repairs the bodies of a mesh file and places them on the bed. Shells without volume are left out first,
/// so that they decide neither the unit nor where the part stands.
///
/// ```
/// use grainpath::run::{config, placed_mesh};
/// # let (settings, diagnostics) = (grainpath::Settings::default(), grainpath_core::Diagnostics::default());
/// // A box of 20 x 10 x 2 mm that floats 3 mm above its own origin.
/// let mut file = grainpath_parts::file_of_a_box();
/// file.bodies[0].mesh.vertices.iter_mut().for_each(|p| p.z += 3.0);
/// let placed = placed_mesh(&config::placing(&settings), file, &diagnostics).unwrap();
/// let (low, high) = placed.mesh.bounds().unwrap();
/// assert_eq!((low.z, high.z, placed.lowered_mm), (0.0, 2.0, 3.0));
/// ```
///
/// # Errors
/// As [`shape::mend`].
pub fn placed_mesh(
    settings: &PlaceSettings,
    file: MeshFile,
    diagnostics: &Diagnostics,
) -> Result<Placed, shape::ShapeError> {
    file.warnings.into_iter().for_each(|w| diagnostics.push(w));
    let mut painted = PaintedSupports::default();
    let mut bodies = Vec::with_capacity(file.bodies.len());
    for mut body in file.bodies {
        for (all, more) in painted.each_mut().into_iter().zip(body.painted_supports.each_mut()) {
            let first = all.vertices.len() as u32;
            all.vertices.append(&mut more.vertices);
            all.triangles.extend(more.triangles.iter().map(|t| t.map(|i| i + first)));
        }
        bodies.push(body.mesh);
    }
    let mesh = shape::mend(bodies, settings.repair, diagnostics)?;
    // Painted facets are placed together with the part, so that they stay on the surface.
    let mut all = [mesh, painted.enforcers, painted.blockers];
    let mut placement = settings.placement;
    let mut assumed_unit = None;
    if settings.unit_of_file {
        placement.unit = match file.unit {
            Some(stated) => stated,
            None => {
                let unit = assume_unit(&all[0], placement.scale, diagnostics)?;
                assumed_unit = Some(unit);
                unit
            }
        };
    }
    let mut lowered_mm = shape::place(&mut all, &placement)?;
    let [mut mesh, enforcers, blockers] = all;
    let mut painted = PaintedSupports { enforcers, blockers };
    if settings.lift_mm > 0.0 {
        let all = std::iter::once(&mut mesh).chain(painted.each_mut());
        all.flat_map(|b| &mut b.vertices).for_each(|p| p.z += settings.lift_mm);
        lowered_mm -= settings.lift_mm;
    }
    Ok(Placed { mesh, lowered_mm, painted, assumed_unit })
}

/// Places the bodies of a mesh file on the bed, repairs them and cuts them into layers.
///
/// ```
/// use grainpath::run::{config, mesh_and_layers};
/// # let (settings, diagnostics) = (grainpath::Settings::default(), grainpath_core::Diagnostics::default());
/// // A box of 20 x 10 x 2 mm gives ten layers of 0.2 mm.
/// let file = grainpath_parts::file_of_a_box();
/// let sliced = mesh_and_layers(&config::placing(&settings), file, &diagnostics).unwrap();
/// assert_eq!(sliced.stack.layers().len(), 10);
/// assert!((sliced.stack.layers()[4].region().area_mm2() - 200.0).abs() < 0.01);
/// ```
///
/// # Errors
/// As [`shape::mend`] and [`shape::slice`].
pub fn mesh_and_layers(
    settings: &PlaceSettings,
    file: MeshFile,
    diagnostics: &Diagnostics,
) -> Result<Sliced, shape::ShapeError> {
    let Placed { mesh, lowered_mm, painted, assumed_unit } = placed_mesh(settings, file, diagnostics)?;
    let stack = shape::slice(&mesh, &settings.slicing, diagnostics)?;
    Ok(Sliced { stack, mesh, lowered_mm, painted, assumed_unit, scan: None })
}

/// The unit that is assumed for a mesh whose file states none. A warning says what was assumed, unless the
/// size leaves no doubt that it is mm.
fn assume_unit(
    mesh: &TriMesh,
    scale: f64,
    diagnostics: &Diagnostics,
) -> Result<LengthUnit, shape::ShapeError> {
    let (low, high) = mesh.bounds().ok_or(shape::ShapeError::Empty)?;
    // The longest extent in the file's own numbers tells a likely unit: a part 0.1 long, for
    // example, is unlikely to be meant in millimetres.
    let longest = (high - low).max_element() * scale;
    let (likely, unit) = (shape::likely_unit(longest), shape::assumed_unit(longest));
    if likely != LengthUnit::Millimetre {
        let text = format!(
            "the file states no unit and the mesh is {longest:.3} long; that is taken for {}, {:.3} mm",
            unit.name(),
            longest * unit.mm()
        );
        let other = if unit == likely { LengthUnit::Millimetre } else { likely };
        let remedy = format!("if it is in {0}, set shape.unit = \"{0}\"", other.name());
        diagnostics.push(Warning::new(WarningId::UnitAssumed, text).with_remedy(remedy));
    }
    Ok(unit)
}

pub(super) fn part_bounds(stack: &LayerStack) -> Bounds2 {
    let all = stack.layers().iter().filter_map(|l| l.region().bounds());
    all.reduce(Bounds2::union).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO })
}

/// Position of the part's origin on the bed. It puts the part's centre at `position_mm`, or at the
/// centre of the bed where no position is given.
pub(super) fn plate_from_part(machine: &Machine, position_mm: Option<[f64; 2]>, part: Bounds2) -> DVec3 {
    let (low, high) = machine.bed_bounds_mm();
    let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
    let target = position_mm.unwrap_or(middle);
    let centre = part.centre();
    // The position is rounded to whole micrometres, so that moving the part does not change how its
    // coordinates are rounded in the G-code.
    let whole = |mm: f64| (mm * 1e3).round() * 1e-3;
    DVec3::new(whole(target[0] - centre.x), whole(target[1] - centre.y), 0.0)
}

/// Refuses a part that does not fit the bed, before any time is spent on it. `adhesion` is laid around its first layer.
pub(super) fn check_bed(
    machine: &Machine,
    stack: &LayerStack,
    part: Bounds2,
    shift: DVec3,
    adhesion: &AdhesionSettings,
) -> Result<(), Error> {
    let (low, high) = machine.bed_bounds_mm();
    let top = stack.layers().last().map_or(0.0, Layer::z_top_mm);
    let mut reach = vec![
        ('X', part.min.x + shift.x, low[0], high[0]),
        ('X', part.max.x + shift.x, low[0], high[0]),
        ('Y', part.min.y + shift.y, low[1], high[1]),
        ('Y', part.max.y + shift.y, low[1], high[1]),
        ('Z', top, 0.0, machine.bed_mm[2]),
    ];
    // The number of loops is rounded, so one bead less than brim and skirt are wide is certain to be laid. What lies
    // between that and the bed's edge is found when the plan is complete.
    let certain_mm = adhesion.reach_mm() - adhesion.bead_width_mm;
    let first = stack.layers().first().and_then(|l| l.region().bounds());
    if let Some(first) = first.filter(|_| certain_mm > 0.0) {
        let (from, to) = (first.min + shift.truncate(), first.max + shift.truncate());
        reach.extend([
            ('X', from.x - certain_mm, low[0], high[0]),
            ('X', to.x + certain_mm, low[0], high[0]),
            ('Y', from.y - certain_mm, low[1], high[1]),
            ('Y', to.y + certain_mm, low[1], high[1]),
        ]);
    }
    let outside = |&&(_, at_mm, low_mm, high_mm): &&(char, f64, f64, f64)| {
        at_mm < low_mm - BED_TOLERANCE_MM || at_mm > high_mm + BED_TOLERANCE_MM
    };
    match reach.iter().find(outside) {
        None => Ok(()),
        Some(&(axis, at_mm, low_mm, high_mm)) => {
            let source = GcodeError::OutsideBed { axis, at_mm, low_mm, high_mm };
            Err(outside_bed(source, stack, part))
        }
    }
}

/// Distance by which rounding of coordinates may move the part beyond the bed, mm. Source: derived:
/// the part's position and the coordinates in the program are both rounded to micrometres, each
/// with an error of up to half a micrometre.
const BED_TOLERANCE_MM: f64 = 1e-3;

/// The error for a print that leaves the bed. It states the size of the part alone; skirt, brim and
/// supports may reach farther.
pub(super) fn outside_bed(source: GcodeError, stack: &LayerStack, part: Bounds2) -> Error {
    let height_mm = stack.layers().last().map_or(0.0, Layer::z_top_mm);
    let size = part.size();
    match source {
        GcodeError::OutsideBed { .. } => Error::OutsideBed { size_mm: [size.x, size.y, height_mm], source },
        other => other.into(),
    }
}

#[cfg(test)]
mod tests {
    use grainpath_core::Region;

    use super::*;
    use crate::Settings;

    #[test]
    fn a_skirt_beside_the_bed_is_refused_before_the_part_is_planned() {
        let square = Region::rectangle(DVec2::ZERO, DVec2::splat(20.0));
        let stack =
            Layer::new(0.2, 0.2, square).and_then(|layer| LayerStack::new(vec![layer])).expect("a layer");
        let part = part_bounds(&stack);
        let settings = super::super::config::steps(&Settings::default());
        let machine = super::super::config::writing(&Settings::default()).machine;
        let fits = |gap_mm: f64, skirt_loops: usize| {
            let low = machine.bed_bounds_mm().0;
            let shift = DVec3::new(low[0] + gap_mm, low[1] + 50.0, 0.0);
            let adhesion = AdhesionSettings { skirt_loops, ..settings.adhesion };
            check_bed(&machine, &stack, part, shift, &adhesion)
        };
        assert!(fits(1.0, 0).is_ok() && fits(4.0, 1).is_ok());
        let refused = fits(1.0, 1).expect_err("the skirt lies 3 mm from the part").to_string();
        assert!(refused.contains("20.00 x 20.00"), "{refused}");
    }

    #[test]
    fn a_unit_is_assumed_by_the_size_and_told() {
        let settings = super::super::config::placing(&Settings::default());
        for (longest, unit, told) in [
            (20.0, LengthUnit::Millimetre, None),
            (0.15, LengthUnit::Metre, Some("taken for m, 150.000 mm")),
            (0.599, LengthUnit::Metre, Some("taken for m,")),
            // Small parts in mm are as usual as parts in inches, so mm stays.
            (0.61, LengthUnit::Millimetre, Some("taken for mm")),
            (6.0, LengthUnit::Millimetre, Some("taken for mm")),
        ] {
            let mut file = grainpath_parts::file_of_a_box();
            file.unit = None;
            file.bodies[0].mesh.vertices.iter_mut().for_each(|p| *p *= longest / 20.0);
            // A stray facet far away changes neither the unit nor the place.
            let mesh = &mut file.bodies[0].mesh;
            let n = mesh.vertices.len() as u32;
            mesh.vertices
                .extend([[0.0, 0.0, -9.0], [1.0, 0.0, -9.0], [0.0, 1.0, -8.0]].map(DVec3::from_array));
            mesh.triangles.push([n, n + 1, n + 2]);
            let diagnostics = Diagnostics::default();
            let placed = placed_mesh(&settings, file, &diagnostics).expect("a box");
            let (low, high) = placed.mesh.bounds().expect("a box");
            assert_eq!(placed.assumed_unit, Some(unit));
            assert!(low.z == 0.0 && placed.lowered_mm == 0.0, "{low} {}", placed.lowered_mm);
            assert!((high.x - low.x - longest * unit.mm()).abs() < 1e-9, "{longest}: {low} {high}");
            let warnings = diagnostics.warnings();
            let found = warnings.iter().find(|w| w.id == WarningId::UnitAssumed);
            assert_eq!(found.is_some(), told.is_some(), "{longest}");
            assert!(told.is_none_or(|t| found.is_some_and(|w| w.text.contains(t))), "{found:?}");
            assert!(warnings.iter().any(|w| w.id == WarningId::MeshStray));
        }
    }
}
