//! Solves loads in three dimensions: the part is meshed with tetrahedra and solved as a solid.
//!
//! Method: the mesh comes from isosurface stuffing (`labelle2007`), with ten nodes an element. The loads of a
//! case are added up as nodal forces. All cases are solved with one preparation, by conjugate gradients with
//! multigrid or, for small parts with many cases, by a factorization. Stresses at the nodes come from patch
//! recovery (`zienkiewicz1992`), and with them the estimate of the mesh's error. Beads of a layer follow the
//! stress in its plane.
//!
//! Lengths are in mm, forces in N, stresses in MPa in the order xx, yy, zz, xy, yz, zx. The stiffness is the
//! same in the whole part; an orthotropic one is turned about z to the axis of the beads. Without a given
//! size, elements follow the thinnest walls and the size of the part. Cost: linear in the elements; memory is
//! estimated and refused above the limit before it is taken. A stop that was asked for ends the work between
//! two steps.
//!
//! Limits: walls thinner than the elements can resolve, a piece that can move freely, and a fixture or load
//! that selects nothing are errors. Shells without volume are left out with a warning. A fixture or load of a
//! deck whose area differs by more than 5 % from that on the part gives a warning, and so does a pressure that
//! catches clearly more or less than lies in its place.

use std::sync::Arc;

use grainpath_core::diagnostics::Stage;
use grainpath_core::{DVec3, Diagnostics, WarningId};
use grainpath_fea::load_case::BoundaryConditions;
use grainpath_fea::material::Stiffness;
use grainpath_fea::principal::PlaneTensor;
use grainpath_fea::resultant::CaseBalance;
use grainpath_fea::solid::{
    LoadedSolid, MeshSettings, Meshed, Model, SolveSettings, mesh, recover, solve as solve_solid,
};
use grainpath_io::fe::{Element, ElementKind, FeFormat, FeResult, StressField};
use grainpath_job::choices::Elasticity;

use super::{
    CaseStress, GuideError, GuidedPart, InPlaneStress, ResultMesh, Solved, StressSettings, StressSummary,
};

struct Solid(StressField);

impl InPlaneStress for Solid {
    fn at(&self, p: DVec3) -> PlaneTensor {
        let [xx, yy, _, xy, ..] = self.0.sample(p);
        [xx, yy, xy]
    }

    fn whole(&self, p: DVec3) -> [f64; 6] {
        self.0.sample(p)
    }
}

pub(super) fn solve(
    settings: &StressSettings,
    part: &GuidedPart<'_>,
    conditions: &BoundaryConditions,
    diagnostics: &Diagnostics,
) -> Result<Solved, GuideError> {
    let mesh_settings = MeshSettings {
        size_mm: settings.element_mm,
        max_mib: settings.max_mib,
        cancel: diagnostics.cancel_flag(),
        ..MeshSettings::default()
    };
    // The mesh and the solution.
    diagnostics.begin(Stage::Guide, 2);
    let meshed = mesh(part.mesh, &mesh_settings)?;
    diagnostics.advance(1);
    // A shell without volume, for example a facet and its mirror image, has no inside to mesh.
    if meshed.n_flat_shells > 0 {
        let n = meshed.n_flat_shells;
        let text =
            format!("{n} shells of the mesh enclose no volume and were left out of the stress analysis");
        diagnostics.warn(WarningId::MeshRepaired, text);
    }
    let tets = &meshed.mesh;
    let loaded = LoadedSolid::new(tets, part.mesh, conditions);
    warn_of_uncovered(&loaded, conditions, diagnostics);
    warn_of_badly_caught(&loaded, conditions, diagnostics)?;
    let supports = loaded.supports()?;
    let model = Model::uniform(tets, stiffness(settings)?);
    let mut forces = Vec::new();
    for case in &conditions.cases {
        // Loads of a case act together, and their nodal forces add up.
        let mut sum = vec![DVec3::ZERO; tets.nodes.len()];
        for load in &case.loads {
            loaded.add_load(&mut sum, load)?;
        }
        forces.push(sum);
    }
    let solve_settings = SolveSettings {
        max_mib: settings.max_mib,
        cancel: diagnostics.cancel_flag(),
        ..SolveSettings::default()
    };
    // The solver is prepared once for all cases.
    let (solutions, info) = solve_solid(&model, &supports, &forces, &solve_settings)?;
    let mut solved = Solved {
        cases: Vec::new(),
        results: Vec::new(),
        summary: StressSummary {
            dofs: info.n_free,
            solver: info.solver.into(),
            elements: tets.tets.len(),
            mesh: Some(words_on(&meshed)),
            ..StressSummary::default()
        },
        constant: false,
    };
    let elements: Vec<Element> =
        tets.tets.iter().filter_map(|t| Element::new(ElementKind::Tet10, t)).collect();
    for (case, solution) in conditions.cases.iter().zip(solutions) {
        diagnostics.check()?;
        solved.summary.balance.push(CaseBalance {
            case: case.name.clone(),
            loads: case.loads.iter().map(|load| loaded.resultant(load)).collect::<Result<_, _>>()?,
            reactions: loaded.reactions(&solution.reaction)?,
        });
        // Patch recovery gives one stress for each node; stresses of elements jump between
        // neighbours.
        let recovered = recover(&model, &solution.displacement, None)?;
        let result = FeResult {
            format: FeFormat::Vtu,
            nodes: tets.nodes.clone(),
            elements: elements.clone(),
            stress: recovered.stress_mpa,
            displacement: Some(solution.displacement),
            plane: false,
            stress_array: String::new(),
            warnings: Vec::new(),
        };
        // The summary covers all cases, so each entry is the value of the worst case.
        let s = &mut solved.summary;
        s.residual = s.residual.max(solution.residual);
        s.error_estimate = s.error_estimate.max(recovered.relative_error);
        s.max_von_mises_mpa = s.max_von_mises_mpa.max(result.max_von_mises_mpa());
        let shown = ResultMesh {
            name: case.name.clone(),
            nodes: result.nodes.clone(),
            elements: result.elements.clone(),
            stress: result.stress.clone(),
            displacement: result.displacement.clone(),
            sets: conditions
                .named_places(case)
                .map(|(name, on)| (name.to_owned(), loaded.nodes_on(on)))
                .collect(),
        };
        s.max_displacement_mm = s.max_displacement_mm.max(shown.max_displacement_mm().unwrap_or(0.0));
        solved.results.push(shown);
        let stress = Arc::new(Solid(StressField::new(result)));
        solved.cases.push(CaseStress { name: case.name.clone(), weight: case.weight, stress });
    }
    Ok(solved)
}

/// Share by which the area of a fixture or load on the part may differ from its area in the deck without a warning.
/// Source: derived: a polygon of 16 sides is 0.6 % shorter than its circle, one of 6 sides 4.5 %.
const SAME_AREA: f64 = 0.05;

/// Warns of fixtures and loads of a deck whose area on the part is smaller or greater than in the deck.
fn warn_of_uncovered(loaded: &LoadedSolid<'_>, conditions: &BoundaryConditions, diagnostics: &Diagnostics) {
    let fixtures = conditions.fixtures.iter().map(|f| (&f.name, Some(&f.on)));
    let loads = conditions.cases.iter().flat_map(|c| &c.loads).map(|l| (&l.name, l.action.on()));
    for (name, on) in fixtures.chain(loads) {
        let share = on.and_then(|on| loaded.covered_share(on)).unwrap_or(1.0);
        if (share - 1.0).abs() > SAME_AREA {
            let text = format!("{name} of the deck covers {:.1} % of its area on the part", 100.0 * share);
            diagnostics.warn(WarningId::DeckCovers, text);
        }
    }
}

/// Share by which the area that a pressure catches may differ from the surface in its place without a warning. Source: chosen;
/// the share of the stress that a mesh may miss without one.
const CAUGHT_AREA: f64 = super::trust::MAX_MESH_ERROR;

/// Warns of pressures on places that are small for the elements. A place catches whole sides of elements.
fn warn_of_badly_caught(
    loaded: &LoadedSolid<'_>,
    conditions: &BoundaryConditions,
    diagnostics: &Diagnostics,
) -> Result<(), GuideError> {
    for load in conditions.cases.iter().flat_map(|c| &c.loads) {
        if let Some((caught, place)) = loaded.badly_caught(load, CAUGHT_AREA)? {
            let (percent, way) =
                (100.0 * (caught / place - 1.0), if caught > place { "more" } else { "less" });
            let text = format!(
                "{} catches {caught:.2} mm2, {:.0} % {way} than the {place:.2} mm2 of surface in its place, as it takes whole \
                 sides of elements; its force is off by as much",
                load.name,
                percent.abs()
            );
            diagnostics.warn(WarningId::StressMeshError, text);
        }
    }
    Ok(())
}

/// Description of the mesh for the report.
fn words_on(meshed: &Meshed) -> String {
    let q = &meshed.quality;
    format!(
        "{} tetrahedra of about {:.2} mm, dihedral angles {:.1} to {:.1} degrees, walls from {:.2} mm",
        meshed.mesh.tets.len(),
        meshed.size_mm,
        q.dihedral_min_deg,
        q.dihedral_max_deg,
        meshed.wall_mm
    )
}

/// Stiffness in part coordinates; beads lie in the layers, so the material is rotated about z.
fn stiffness(settings: &StressSettings) -> Result<Stiffness, GuideError> {
    let c = settings.material.stiffness()?;
    let angle = settings.bead_axis_rad;
    Ok(match settings.elasticity {
        Elasticity::Orthotropic if angle != 0.0 => grainpath_fea::material::rotated_about_z(&c, angle),
        Elasticity::Isotropic | Elasticity::Orthotropic => c,
    })
}
