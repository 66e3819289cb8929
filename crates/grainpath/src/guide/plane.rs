//! Loads in the plane of the layers: the section solved as a plate.

use std::sync::Arc;

use grainpath_core::math::cross;
use grainpath_core::selection::Selection;
use grainpath_core::{DVec2, DVec3, LayerStack, Region};
use grainpath_fea::plane::{
    Hold, PlaneMesh, PlaneProblem, PlaneStress, PlaneSystem, body_force_n, mesh_region, traction_n,
};

use super::{
    CaseStress, GuideError, GuidedPart, InPlaneStress, ResultMesh, Solved, StressSummary, degenerate_points,
    in_plane, material, resolved,
};
use grainpath_io::fe::{Element, ElementKind};

use grainpath_job::Settings;
use grainpath_job::loads::{Case, Load, Push};

/// Sections may differ by this share of their area and still count as the same.
const SAME_SECTION: f64 = 2e-3;
/// Sides of the section are simplified to within this before meshing, mm.
const SIMPLIFY_MM: f64 = 0.02;

/// What all loads of a plane problem share.
struct Plate<'a> {
    mesh: &'a PlaneMesh,
    z_mid_mm: f64,
    thickness_mm: f64,
    low: DVec3,
    high: DVec3,
    part: &'a GuidedPart<'a>,
}

impl InPlaneStress for Arc<PlaneStress> {
    fn at(&self, p: DVec3) -> grainpath_fea::principal::PlaneTensor {
        PlaneStress::at(self, p.truncate())
    }
}

/// The section that all layers have, if they do.
pub(crate) fn constant_section(stack: &LayerStack) -> Option<&Region> {
    let layers = stack.layers();
    let middle = layers.get(layers.len() / 2)?.region();
    let area = middle.area_mm2();
    let mut last: Option<&Region> = None;
    for layer in layers {
        let region = layer.region();
        if region == middle || last == Some(region) {
            continue;
        }
        let off = region.difference(middle).area_mm2() + middle.difference(region).area_mm2();
        if off > SAME_SECTION * area {
            return None;
        }
        last = Some(region);
    }
    Some(middle)
}

pub(super) fn solve(
    settings: &Settings,
    part: &GuidedPart<'_>,
    cases: &[Case],
) -> Result<Solved, GuideError> {
    let section = constant_section(part.stack)
        .ok_or(GuideError::NotPlane("the section is not the same at all heights"))?;
    if !cases.iter().flat_map(|c| &c.loads).all(|l| in_plane(&l.push)) {
        return Err(GuideError::NotPlane("a load has a part out of the layers' plane"));
    }
    let section = section.simplified(SIMPLIFY_MM);
    let longest = settings.guide.element_mm.unwrap_or_else(|| default_element_mm(&section));
    let mesh = mesh_region(&section, longest, 0.05 * longest)?;
    let (low, high) = part.mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let plate = Plate {
        mesh: &mesh,
        z_mid_mm: 0.5 * (low.z + high.z),
        thickness_mm: high.z - low.z,
        low,
        high,
        part,
    };
    let holds = plate.holds(settings)?;
    let c = material(settings).plane_stress(settings.guide.elasticity_deg.to_radians())?;
    let stiffness = move |_: DVec2| c;
    let problem = PlaneProblem {
        mesh: &mesh,
        thickness_mm: plate.thickness_mm,
        stiffness: &stiffness,
        holds: &holds,
        max_bytes: (settings.guide.memory_mb as u64) << 20,
    };
    let system = PlaneSystem::new(&problem)?;
    let mut summary = StressSummary {
        solver: "sparse Cholesky, quadratic triangles, plane stress".into(),
        elements: mesh.elements.len(),
        ..StressSummary::default()
    };
    let (mut stresses, mut results) = (Vec::new(), Vec::new());
    let triangle = |e: &[u32; 6]| Element::new(ElementKind::Tri6, e);
    let elements: Vec<Element> = mesh.elements.iter().filter_map(triangle).collect();
    let mut load_number = 0;
    for case in cases {
        let mut forces = vec![DVec2::ZERO; mesh.nodes.len()];
        for load in &case.loads {
            load_number += 1;
            let more = plate.forces(load, settings, &format!("load {load_number}"))?;
            forces.iter_mut().zip(more).for_each(|(f, m)| *f += m);
        }
        let solution = system.solve(&forces);
        let stress = Arc::new(system.stress(&solution));
        let moved = solution.displacement_mm.iter().map(|u| u.length()).fold(0.0, f64::max);
        summary.dofs = solution.dofs;
        summary.residual = summary.residual.max(solution.residual);
        summary.max_displacement_mm = summary.max_displacement_mm.max(moved);
        summary.max_von_mises_mpa = summary.max_von_mises_mpa.max(stress.max_von_mises_mpa());
        summary.error_estimate = summary.error_estimate.max(stress.error_estimate());
        if results.is_empty() {
            summary.degenerate = Some(degenerate_points(&stress));
        }
        results.push(ResultMesh {
            name: case.name.clone(),
            nodes: mesh.nodes.iter().map(|p| plate.at(*p)).collect(),
            elements: elements.clone(),
            stress: stress.nodal_mpa().iter().map(|[xx, yy, xy]| [*xx, *yy, 0.0, *xy, 0.0, 0.0]).collect(),
            displacement: Some(solution.displacement_mm.iter().map(|u| u.extend(0.0)).collect()),
        });
        stresses.push(CaseStress { name: case.name.clone(), weight: case.weight, stress: Box::new(stress) });
    }
    Ok(Solved { cases: stresses, results, summary, constant: true })
}

/// About ten thousand triangles for a plain section.
fn default_element_mm(section: &Region) -> f64 {
    (section.area_mm2() / 4000.0).sqrt().max(0.02)
}

impl Plate<'_> {
    fn at(&self, p: DVec2) -> DVec3 {
        p.extend(self.z_mid_mm)
    }

    fn nothing(&self, what: &str, on: &Selection) -> GuideError {
        let (low, high) = (self.low, self.high);
        GuideError::CatchesNothing { what: what.to_owned(), shape: on.name(), low, high }
    }

    fn holds(&self, settings: &Settings) -> Result<Vec<Hold>, GuideError> {
        let mut holds = Vec::new();
        for (k, fixture) in settings.guide.fixture.iter().enumerate() {
            let what = format!("fixture {}", k + 1);
            let on = resolved(&fixture.on, self.part.mesh, &what)?;
            let chosen: Vec<u32> = (0..self.mesh.nodes.len() as u32)
                .filter(|&i| on.contains(self.at(self.mesh.nodes[i as usize])))
                .collect();
            if chosen.is_empty() {
                return Err(self.nothing(&what, &on));
            }
            if fixture.normal {
                let normals = self.normals(&on);
                if normals.is_empty() {
                    return Err(self.nothing(&what, &on));
                }
                holds.extend(normals.into_iter().map(|(node, along)| {
                    let displacement_mm = fixture.displacement_mm.truncate().dot(along);
                    Hold { node, along, displacement_mm }
                }));
                continue;
            }
            for (axis, along) in [DVec2::X, DVec2::Y].into_iter().enumerate() {
                if fixture.fixed[axis] {
                    let displacement_mm = fixture.displacement_mm[axis];
                    holds.extend(chosen.iter().map(|&node| Hold { node, along, displacement_mm }));
                }
            }
        }
        Ok(holds)
    }

    /// Sides of the border whose middle is selected.
    fn sides(&self, on: &Selection) -> Vec<[u32; 3]> {
        let middle = |s: &&[u32; 3]| on.contains(self.at(self.mesh.nodes[s[2] as usize]));
        self.mesh.border.iter().filter(middle).copied().collect()
    }

    /// Nodes of selected sides with their outward normals.
    fn normals(&self, on: &Selection) -> Vec<(u32, DVec2)> {
        let mut sums = std::collections::BTreeMap::new();
        for side in self.sides(on) {
            let along = self.mesh.nodes[side[1] as usize] - self.mesh.nodes[side[0] as usize];
            let normal = DVec2::new(along.y, -along.x);
            for node in side {
                *sums.entry(node).or_insert(DVec2::ZERO) += normal;
            }
        }
        sums.into_iter().map(|(node, n)| (node, n.normalize_or(DVec2::X))).collect()
    }

    fn forces(&self, load: &Load, settings: &Settings, what: &str) -> Result<Vec<DVec2>, GuideError> {
        let t = self.thickness_mm;
        let Some(on) = &load.on else {
            let Push::Acceleration(a) = load.push else { return Ok(Vec::new()) };
            // g/cm3 and mm/s2 to N/mm3.
            let density = settings.material.density_g_cm3 * 1e-9;
            return Ok(body_force_n(self.mesh, t, density * a.truncate()));
        };
        let on = resolved(on, self.part.mesh, what)?;
        let sides = self.sides(&on);
        if sides.is_empty() {
            return Err(self.nothing(what, &on));
        }
        let area = self.mesh.border_length_mm(&sides) * t;
        Ok(match load.push {
            Push::Force(f) => traction_n(self.mesh, &sides, t, &|_, _| f.truncate() / area),
            Push::Pressure(p) => traction_n(self.mesh, &sides, t, &|_, n| -p * n),
            Push::Moment(m) => {
                let ends = || {
                    sides.iter().map(|s| {
                        let [a, b] = [s[0], s[1]].map(|i| self.mesh.nodes[i as usize]);
                        (0.5 * (a + b), a.distance(b))
                    })
                };
                let length: f64 = ends().map(|e| e.1).sum();
                let centre = ends().map(|(p, l)| p * l).sum::<DVec2>() / length;
                let turned = |p: DVec2| DVec2::new(-(p - centre).y, (p - centre).x);
                let unit = traction_n(self.mesh, &sides, t, &|p, _| turned(p));
                let sum: f64 = unit.iter().zip(&self.mesh.nodes).map(|(f, p)| cross(*p - centre, *f)).sum();
                unit.into_iter().map(|f| f * (m.z / sum)).collect()
            }
            Push::Acceleration(_) => Vec::new(),
        })
    }
}
