//! Flat parts: an outline with holes, extruded to a thickness.
//!
//! Lengths are in mm. Cost: that of triangulating the region.

use std::collections::BTreeSet;

use grainpath_core::triangulation::{Triangulation, TriangulationError};
use grainpath_core::units::LengthUnit;
use grainpath_core::{Region, TriMesh};
use grainpath_io::{MeshBody, MeshFile, Outline};

use super::ShapeError;

/// Extrudes a drawing from z = 0 to `thickness_mm`.
///
/// # Errors
/// [`ShapeError::Outline`] for lines that cross each other after rounding to the grid of sections.
pub fn extruded(outline: Outline, thickness_mm: f64) -> Result<MeshFile, ShapeError> {
    let mut mesh = TriMesh::default();
    prism(&outline.region, 0.0, thickness_mm, &mut mesh)?;
    Ok(MeshFile {
        modifiers: Vec::new(),
        bodies: vec![MeshBody { mesh, ..MeshBody::default() }],
        unit: Some(LengthUnit::Millimetre),
        warnings: outline.warnings,
    })
}

/// Adds the prism over a region, between two heights, to a mesh. The prism is closed if the region's
/// contours do not touch each other.
///
/// # Errors
/// As [`Triangulation::plain`].
pub fn prism(
    region: &Region,
    low_mm: f64,
    high_mm: f64,
    mesh: &mut TriMesh,
) -> Result<(), TriangulationError> {
    let cap = Triangulation::plain(region)?;
    let (first, n) = (mesh.vertices.len() as u32, cap.points.len() as u32);
    for z in [low_mm, high_mm] {
        mesh.vertices.extend(cap.points.iter().map(|p| p.extend(z)));
    }
    // A triangle side that no other triangle has in reverse lies on the border of the region. The
    // prism has walls only there.
    let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
    let all: BTreeSet<(u32, u32)> = cap.triangles.iter().flat_map(sides).collect();
    for triangle in &cap.triangles {
        let [a, b, c] = triangle.map(|i| first + i);
        // The lower cap is turned over, so that its normal points down.
        mesh.triangles.extend([[a, c, b], [a + n, b + n, c + n]]);
        for (a, b) in sides(triangle).into_iter().filter(|&(a, b)| !all.contains(&(b, a))) {
            let (a, b) = (first + a, first + b);
            mesh.triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::DVec2;
    use grainpath_core::mesh::diagnose;

    #[test]
    fn a_plate_with_holes_and_an_island_is_a_closed_body_of_its_volume() {
        let square = |a: f64, b: f64| Region::rectangle(DVec2::splat(a), DVec2::splat(b));
        let region = square(0.0, 20.0).difference(&square(2.0, 18.0)).union(&square(4.0, 9.0));
        let file = extruded(Outline { region: region.clone(), warnings: Vec::new() }, 3.0).expect("a plate");
        let mesh = &file.bodies[0].mesh;
        let health = diagnose(mesh).expect("triangles");
        assert!(health.is_closed() && health.shells == 2, "{health:?}");
        assert!((mesh.signed_volume() - 3.0 * region.area_mm2()).abs() < 1e-9);
        assert!(matches!(
            extruded(Outline { region: Region::default(), warnings: Vec::new() }, 3.0),
            Err(ShapeError::Outline(_))
        ));
    }
}
