//! Stress that another program solved for, as the only load case of the part.
//!
//! Method: the result is scaled, turned and lowered with the part as the part's own mesh is. Stress keeps its
//! magnitude, as under the same pressures on a part of another size; its tensor is turned. Displacements are
//! turned and scaled with the part. Between nodes the stress is interpolated inside the element that holds
//! the point; outside the mesh that of the nearest point counts. Beads of a layer follow its components in
//! the plane.
//!
//! Lengths are in mm, stresses in MPa in the order xx, yy, zz, xy, yz, zx. The coordinates of the file have
//! to be those of the part's mesh. Cost: linear in the nodes to move a result; a query takes constant time
//! inside the mesh on average.
//!
//! Limits: a result whose bounding box differs from the part's by more than 5 % of the part's size is
//! refused, and so is one without nodes. A plane result has no height, so only x and y are compared, and it
//! can be turned about z alone. Loads and reactions are unknown, so their balance is not tested.

use std::sync::Arc;

use grainpath_core::{DMat3, DVec3};
use grainpath_fea::principal::PlaneTensor;
use grainpath_io::fe::{FeResult, StressField};

use crate::shape::Standing;

use super::{CaseStress, GuideError, GuidedPart, InPlaneStress, ResultMesh, Solved, StressSummary};

/// An imported result at the position of the part.
struct Imported {
    field: Arc<StressField>,
    /// Vector from part coordinates to those of the file, mm.
    shift: DVec3,
}

impl InPlaneStress for Imported {
    fn at(&self, p: DVec3) -> PlaneTensor {
        let [xx, yy, _, xy, ..] = self.field.sample(p + self.shift);
        [xx, yy, xy]
    }

    fn whole(&self, p: DVec3) -> [f64; 6] {
        self.field.sample(p + self.shift)
    }
}

/// Largest offset between an imported result and the part, as a share of the part's size. A larger one is an error.
const SAME_PLACE: f64 = 0.05;

/// Scales and turns a result with its part. The magnitude of the stress is kept, as for a part of another size under
/// the same pressures. Displacements are scaled with the part.
fn moved(result: &FeResult, standing: &Standing) -> Result<FeResult, GuideError> {
    let (r, scale) = (standing.rotation, standing.scale);
    // A plane result does not contain the stress out of its plane, so it can turn about z only.
    if result.plane && (r.z_axis - DVec3::Z).length() > 1e-9 {
        return Err(GuideError::ImportTurned);
    }
    let turned = |s: &[f64; 6]| {
        let [xx, yy, zz, xy, yz, zx] = *s;
        let tensor = DMat3::from_cols_array_2d(&[[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]);
        let t = r * tensor * r.transpose();
        [t.x_axis.x, t.y_axis.y, t.z_axis.z, t.x_axis.y, t.y_axis.z, t.x_axis.z]
    };
    let vectors = |all: &Vec<DVec3>| all.iter().map(|u| r * (scale * *u)).collect();
    Ok(FeResult {
        nodes: vectors(&result.nodes),
        stress: result.stress.iter().map(turned).collect(),
        displacement: result.displacement.as_ref().map(vectors),
        ..result.clone()
    })
}

/// Takes the stress of a file as the only load case. The file has the coordinates of the mesh, in mm; the
/// result is scaled, turned and lowered with the part.
pub(super) fn solved(field: StressField, part: &GuidedPart<'_>) -> Result<Solved, GuideError> {
    let lowered_mm = part.standing.lowered_mm;
    let field = Arc::new(match part.standing.is_as_in_file() {
        true => field,
        false => StressField::new(moved(field.result(), &part.standing)?),
    });
    let result = field.result();
    let bounds = result.bounds();
    let shift = DVec3::new(0.0, 0.0, lowered_mm);
    let (part_low, part_high) = part.mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let size = (part_high - part_low).max_element();
    let elsewhere =
        |result| GuideError::ImportElsewhere { result, part: [part_low + shift, part_high + shift] };
    let (low, high) = bounds.ok_or_else(|| elsewhere([DVec3::ZERO; 2]))?;
    // A plane result has no height, so only x and y are compared.
    let axes = if result.plane { 2 } else { 3 };
    let off = |k: usize| {
        (low[k] - (part_low + shift)[k]).abs().max((high[k] - (part_high + shift)[k]).abs())
            > SAME_PLACE * size
    };
    if (0..axes).any(off) {
        return Err(elsewhere([low, high]));
    }
    let lengths = result.displacement.iter().flatten().map(|u| u.length());
    let summary = StressSummary {
        solver: format!("imported, {} {}", result.format.name(), result.stress_array),
        elements: result.elements.len(),
        max_von_mises_mpa: result.max_von_mises_mpa(),
        max_displacement_mm: lengths.fold(0.0, f64::max),
        ..StressSummary::default()
    };
    let results = vec![ResultMesh {
        name: "imported".into(),
        nodes: result.nodes.iter().map(|p| *p - shift).collect(),
        elements: result.elements.clone(),
        stress: result.stress.clone(),
        displacement: result.displacement.clone(),
        sets: Vec::new(),
    }];
    let constant = result.plane;
    let stress = Arc::new(Imported { field, shift });
    Ok(Solved {
        cases: vec![CaseStress { name: "imported".into(), weight: 1.0, stress }],
        results,
        summary,
        constant,
    })
}
