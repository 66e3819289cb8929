//! Loads in three dimensions.

use grainpath_core::selection::Selection;
use grainpath_core::{DVec3, Diagnostics};
use grainpath_fea::material::Stiffness;
use grainpath_fea::principal::PlaneTensor;
use grainpath_fea::solid::{
    MeshSettings, Meshed, Model, SolveSettings, Supports, TetMesh, mesh, nodal_forces, recover,
    solve as solve_solid,
};
use grainpath_io::fe::{Element, ElementKind, FeFormat, FeResult, StressField};

use super::{
    CaseStress, GuideError, GuidedPart, InPlaneStress, ResultMesh, Solved, StressSummary, material, resolved,
};
use grainpath_job::Settings;
use grainpath_job::loads::{Case, Load, Push};

struct Solid(StressField);

impl InPlaneStress for Solid {
    fn at(&self, p: DVec3) -> PlaneTensor {
        let [xx, yy, _, xy, ..] = self.0.sample(p);
        [xx, yy, xy]
    }
}

pub(super) fn solve(
    settings: &Settings,
    part: &GuidedPart<'_>,
    cases: &[Case],
    diagnostics: &Diagnostics,
) -> Result<Solved, GuideError> {
    let mesh_settings = MeshSettings { size_mm: settings.guide.element_mm, ..MeshSettings::default() };
    let meshed = mesh(part.mesh, &mesh_settings)?;
    diagnostics.check()?;
    let tets = &meshed.mesh;
    let bounds = part.mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let supports = supports(settings, part, tets, bounds)?;
    let model = Model::uniform(tets, stiffness(settings)?);
    let mut forces = Vec::new();
    let mut load_number = 0;
    for case in cases {
        let mut sum = vec![DVec3::ZERO; tets.nodes.len()];
        for load in &case.loads {
            load_number += 1;
            add_load(&mut sum, load, settings, part, tets, bounds, &format!("load {load_number}"))?;
        }
        forces.push(sum);
    }
    let solve_settings =
        SolveSettings { most_mib: settings.guide.memory_mb as f64, ..SolveSettings::default() };
    let (solutions, info) = solve_solid(&model, &supports, &forces, &solve_settings)?;
    diagnostics.check()?;
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
    for (case, solution) in cases.iter().zip(solutions) {
        diagnostics.check()?;
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
        let s = &mut solved.summary;
        s.residual = s.residual.max(solution.residual);
        s.error_estimate = s.error_estimate.max(recovered.relative_error);
        s.max_von_mises_mpa = s.max_von_mises_mpa.max(result.max_von_mises_mpa());
        let moved = result.displacement.iter().flatten().map(|u| u.length()).fold(0.0, f64::max);
        s.max_displacement_mm = s.max_displacement_mm.max(moved);
        solved.results.push(ResultMesh {
            name: case.name.clone(),
            nodes: result.nodes.clone(),
            elements: result.elements.clone(),
            stress: result.stress.clone(),
            displacement: result.displacement.clone(),
        });
        let stress = Box::new(Solid(StressField::new(result)));
        solved.cases.push(CaseStress { name: case.name.clone(), weight: case.weight, stress });
    }
    Ok(solved)
}

/// The mesh in words, for the report.
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

/// Stiffness in part coordinates: beads lie in layers, turned about z.
fn stiffness(settings: &Settings) -> Result<Stiffness, GuideError> {
    let material = material(settings);
    let c = material.stiffness()?;
    let angle = settings.guide.elasticity_deg.to_radians();
    Ok(if settings.guide.elasticity == "orthotropic" && angle != 0.0 {
        grainpath_fea::material::rotated_about_z(&c, angle)
    } else {
        c
    })
}

/// Cosine of the angle that an element's face on a smooth side of the part stays within.
const NOT_SLANTED: f64 = 0.94;

fn nothing(what: &str, on: &Selection, (low, high): (DVec3, DVec3)) -> GuideError {
    GuideError::CatchesNothing { what: what.to_owned(), shape: on.name(), low, high }
}

fn supports(
    settings: &Settings,
    part: &GuidedPart<'_>,
    tets: &TetMesh,
    bounds: (DVec3, DVec3),
) -> Result<Supports, GuideError> {
    let mut supports = Supports::new(tets.nodes.len());
    for (k, fixture) in settings.guide.fixture.iter().enumerate() {
        let what = format!("fixture {}", k + 1);
        let on = resolved(&fixture.on, part.mesh, &what)?;
        let faces = tets.faces_in(&on);
        if faces.is_empty() {
            return Err(nothing(&what, &on, bounds));
        }
        let value = fixture.displacement_mm;
        if fixture.normal {
            let mut normals = std::collections::BTreeMap::new();
            for &f in &faces {
                let [a, b, c] = [0, 1, 2].map(|i| tets.nodes[tets.faces[f].nodes[i] as usize]);
                let normal = (b - a).cross(c - a);
                // What stands on a slant over a rounded edge would hold the part askew.
                let [p, q, r] =
                    part.mesh.triangles[tets.faces[f].facet as usize].map(|i| part.mesh.vertices[i as usize]);
                let facet = (q - p).cross(r - p).normalize_or_zero();
                if normal.normalize_or_zero().dot(facet).abs() < NOT_SLANTED {
                    continue;
                }
                tets.faces[f].nodes.iter().for_each(|n| *normals.entry(*n).or_insert(DVec3::ZERO) += normal);
            }
            for (node, normal) in normals {
                let normal = normal.normalize_or_zero();
                supports.prescribe(tets, node, normal, value.dot(normal))?;
            }
            continue;
        }
        for node in tets.nodes_of(&faces) {
            for axis in (0..3).filter(|&a| fixture.fixed[a]) {
                supports.prescribe(tets, node, DVec3::AXES[axis], value[axis])?;
            }
        }
    }
    Ok(supports)
}

fn add_load(
    forces: &mut [DVec3],
    load: &Load,
    settings: &Settings,
    part: &GuidedPart<'_>,
    tets: &TetMesh,
    bounds: (DVec3, DVec3),
    what: &str,
) -> Result<(), GuideError> {
    let Some(on) = &load.on else {
        if let Push::Acceleration(a) = load.push {
            // g/cm3 and mm/s2 to N/mm3.
            let density = settings.material.density_g_cm3 * 1e-9;
            nodal_forces::add_body_force(forces, tets, |_| density * a);
        }
        return Ok(());
    };
    let on = resolved(on, part.mesh, what)?;
    let faces = tets.faces_in(&on);
    if faces.is_empty() {
        return Err(nothing(what, &on, bounds));
    }
    match load.push {
        Push::Force(f) => nodal_forces::add_force(forces, tets, &faces, f),
        Push::Pressure(p) => nodal_forces::add_pressure(forces, tets, &faces, p),
        Push::Moment(m) => nodal_forces::add_moment(forces, tets, &faces, m),
        Push::Acceleration(_) => {}
    }
    Ok(())
}
