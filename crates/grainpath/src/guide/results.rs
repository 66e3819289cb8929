//! Results of a stress guide besides directions: VTU files and principal stress lines.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_PI_2;

use grainpath_core::math::direction;
use grainpath_core::poly::LineClipper;
use grainpath_core::streamlines::{LineSettings, Seeding, TracedLine, evenly_spaced};
use grainpath_core::{DVec2, Region};
use grainpath_fea::principal::plane_principal;
use grainpath_io::fe::{Encoding, PointData, VtuMesh, stress_point_data, write_vtu};

use super::{Guide, ResultMesh};

/// Number of lines of each family across the longer side of the part. Only the picture
/// depends on it.
const LINES_ACROSS: f64 = 60.0;

/// Evenly spaced principal stress lines of a layer: the families of the greater and of the smaller
/// principal stress.
pub type Families = [Vec<TracedLine>; 2];

/// Faces of solid elements by the number of their corners, in the order of VTK; flat elements are a face of their own.
fn faces(n_corners: usize, is_solid: bool) -> &'static [&'static [usize]] {
    match (n_corners, is_solid) {
        (3, false) => &[&[0, 1, 2]],
        (4, false) => &[&[0, 1, 2, 3]],
        (4, true) => &[&[0, 1, 2], &[0, 1, 3], &[0, 2, 3], &[1, 2, 3]],
        (5, true) => &[&[0, 1, 2, 3], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        (6, true) => &[&[0, 1, 2], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
        (8, true) => {
            &[&[0, 1, 2, 3], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
        }
        _ => &[],
    }
}

impl ResultMesh {
    /// Edges on the surface of the mesh between corners of elements, each once, as pairs of nodes. A face that two
    /// elements share lies inside.
    pub fn surface_edges(&self) -> BTreeSet<[u32; 2]> {
        let mut outer: BTreeMap<Vec<u32>, Option<Vec<u32>>> = BTreeMap::new();
        for element in &self.elements {
            let corners = element.corners();
            for face in faces(corners.len(), element.kind.dimension() == 3) {
                let face: Vec<u32> = face.iter().map(|k| corners[*k]).collect();
                let mut key = face.clone();
                key.sort_unstable();
                outer.entry(key).and_modify(|other| *other = None).or_insert(Some(face));
            }
        }
        let sides = |face: Vec<u32>| {
            let next = |k: usize| face[(k + 1) % face.len()];
            (0..face.len()).map(|k| [face[k].min(next(k)), face[k].max(next(k))]).collect::<Vec<_>>()
        };
        outer.into_values().flatten().flat_map(sides).collect()
    }
}

impl Guide {
    /// Stress, displacement and principal vectors of every case, as VTU.
    ///
    /// # Errors
    /// None for writing into memory; otherwise those of the writer.
    pub fn vtu(&self) -> std::io::Result<Vec<u8>> {
        let mut out = Vec::new();
        let Some(first) = self.results.first() else { return Ok(out) };
        let mut data: Vec<PointData> = Vec::new();
        for result in &self.results {
            let mut arrays = stress_point_data(&result.stress, result.displacement.as_deref());
            // 1 on the nodes of a fixture or load, 0 elsewhere.
            arrays.extend(result.sets.iter().map(|(name, nodes)| {
                let mut values = vec![0.0; result.nodes.len()];
                nodes.iter().for_each(|n| values[*n as usize] = 1.0);
                PointData::scalars(&name.replace(' ', "_"), values)
            }));
            // Arrays of several cases need different names in one file.
            if self.results.len() > 1 {
                arrays.iter_mut().for_each(|a| a.name = format!("{} {}", result.name, a.name));
            }
            data.extend(arrays);
        }
        let mesh = VtuMesh { nodes: &first.nodes, elements: &first.elements };
        write_vtu(mesh, &data, Encoding::Zlib, &mut out)?;
        Ok(out)
    }

    /// Principal stress lines of a section at height `z_mm`, of the heaviest case.
    pub fn lines(&self, region: &Region, z_mm: f64) -> Families {
        let Some(bounds) = region.bounds() else { return Families::default() };
        let inside = LineClipper::new(region);
        let size = bounds.size();
        // At least six lines across the shorter side, so that a slender part shows its lines too.
        let separation = (size.max_element() / LINES_ACROSS).min(size.min_element() / 6.0).max(1e-3);
        let same = |_: DVec2| separation;
        let seeding =
            Seeding { separation_mm: &same, end_share: 0.5, shortest_mm: 2.0 * separation, whole: false };
        let settings = LineSettings {
            tolerance_mm: 1e-3 * separation,
            step_mm: 0.5 * separation,
            longest_mm: 10.0 * size.element_sum(),
        };
        let stress = self.main_case();
        [0.0, FRAC_PI_2].map(|turn| {
            let axis = |p: DVec2| {
                if !inside.contains(p) {
                    return None;
                }
                let principal = plane_principal(stress.at(p.extend(z_mm)));
                let apart = principal.values_mpa[0] - principal.values_mpa[1];
                // Where both stresses are equal there is no direction to follow.
                (apart > 1e-9).then(|| direction(principal.axis_rad + turn))
            };
            evenly_spaced(&[bounds.centre()], bounds, &axis, &seeding, &settings)
        })
    }
}
