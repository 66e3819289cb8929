//! Meshing of real and made parts.

use std::time::Instant;

use grainpath_core::{DVec3, TriMesh};
use grainpath_fea::solid::{MeshSettings, mesh};

fn boxed(size: DVec3, turn: f64) -> TriMesh {
    let (s, c) = grainpath_core::math::sin_cos(turn);
    let corner = |i: u32| {
        let p = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * size;
        let p = DVec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
        DVec3::new(p.x, c * p.y - s * p.z, s * p.y + c * p.z)
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    TriMesh { vertices: (0..8).map(corner).collect(), triangles }
}

#[test]
fn a_box_however_turned_keeps_its_edges() {
    for turn in [0.0, 0.3, 0.7] {
        for size in [2.0, 1.0] {
            let surface = boxed(DVec3::new(20.0, 14.0, 9.0), turn);
            let start = Instant::now();
            let found = mesh(&surface, &MeshSettings { size_mm: Some(size), most_dofs: 0 }).expect("a plain box");
            println!(
                "turn {turn} size {size}: {} tets, {} dofs, volume {:.3} %, {:?}, {:.2} s",
                found.mesh.tets.len(),
                found.mesh.n_dofs(),
                100.0 * (found.volume_mm3 / 2520.0 - 1.0),
                found.quality,
                start.elapsed().as_secs_f64()
            );
        }
    }
}
