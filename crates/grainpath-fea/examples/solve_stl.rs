//! Meshes and solves a binary STL: one end held, the other pulled down. `cargo xtask bench fea` runs it.
//!
//! `solve_stl FILE.stl SCALE SIZE_MM`: the scale brings the file's unit to mm.

use std::time::Instant;

use grainpath_core::mesh::VertexWelder;
use grainpath_core::selection::Selection;
use grainpath_core::{DVec3, TriMesh};
use grainpath_fea::material::Orthotropic;
use grainpath_fea::solid::{MeshSettings, Model, SolveSettings, Supports, mesh, nodal_forces, solve};

fn read(path: &str, scale: f64) -> Option<TriMesh> {
    let bytes = std::fs::read(path).ok()?;
    let mut welder = VertexWelder::with_capacity(bytes.len() / 100);
    let mut triangles = Vec::new();
    for facet in bytes.get(84..)?.chunks_exact(50) {
        let number = |i: usize| f32::from_le_bytes(facet[i..i + 4].try_into().expect("four bytes"));
        let corner =
            |i: usize| DVec3::from_array([0, 4, 8].map(|k| f64::from(number(12 + 12 * i + k)))) * scale;
        triangles.push([welder.index(corner(0))?, welder.index(corner(1))?, welder.index(corner(2))?]);
    }
    Some(TriMesh { vertices: welder.into_vertices(), triangles })
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let number = |i: usize| args.get(i).and_then(|a| a.parse::<f64>().ok());
    let (Some(path), Some(scale), Some(size_mm)) = (args.get(1), number(2), number(3)) else {
        eprintln!("usage: solve_stl FILE.stl SCALE SIZE_MM");
        std::process::exit(2);
    };
    let Some(surface) = read(path, scale) else {
        eprintln!("{path}: not a binary STL file");
        std::process::exit(3);
    };
    let start = Instant::now();
    let settings = MeshSettings { size_mm: Some(size_mm), ..MeshSettings::default() };
    let meshed = match mesh(&surface, &settings) {
        Ok(meshed) => meshed,
        Err(e) => {
            eprintln!("{path}: {e}");
            std::process::exit(4);
        }
    };
    println!(
        "{} facets, size {size_mm} mm, walls {:.2} mm: {} elements, {} dofs, volume {:+.3} %, {} pieces, {} crumbs, \
         walls lost {:.2} %, {:.2} s",
        surface.triangles.len(),
        meshed.wall_mm,
        meshed.mesh.tets.len(),
        meshed.mesh.n_dofs(),
        100.0 * (meshed.volume_mm3 / meshed.surface_mm3 - 1.0),
        meshed.pieces.len(),
        meshed.n_crumbs,
        100.0 * meshed.lost_share,
        start.elapsed().as_secs_f64()
    );
    println!("{:?}", meshed.quality);

    let start = Instant::now();
    let (lo, hi) = surface.bounds().expect("meshed");
    let mesh = &meshed.mesh;
    let stiffness = Orthotropic::isotropic(210_000.0, 0.3).stiffness().expect("stable");
    let model = Model::uniform(mesh, stiffness);
    let at = |x: f64| {
        let point = DVec3::new(x, 0.0, 0.0);
        mesh.faces_in(&Selection::Plane { point, normal: DVec3::X, tolerance_mm: 1e-3 })
    };
    let mut supports = Supports::new(mesh.nodes.len());
    for face in at(lo.x) {
        for n in mesh.faces[face].nodes {
            supports.fix(mesh, n).expect("fixed twice is fixed");
        }
    }
    let mut load = vec![DVec3::ZERO; mesh.nodes.len()];
    nodal_forces::add_force(&mut load, mesh, &at(hi.x), DVec3::new(0.0, 0.0, -500.0));
    match solve(&model, &supports, &[load], &SolveSettings::default()) {
        Ok((solutions, info)) => {
            let reaction: DVec3 = solutions[0].reaction.iter().sum();
            println!(
                "held on {:.1} mm2, pulled on {:.1} mm2, reaction {reaction:.3} N",
                nodal_forces::area_mm2(mesh, &at(lo.x)),
                nodal_forces::area_mm2(mesh, &at(hi.x))
            );
            let top = solutions[0].displacement.iter().map(|u| u.length()).fold(0.0, f64::max);
            println!(
                "{} unknowns, levels {:?}, {:.0} MiB, {} iterations, residual {:.1e}, largest displacement {top:.6} mm, \
                 {:.2} s",
                info.n_free,
                info.levels,
                info.mib,
                solutions[0].iterations,
                solutions[0].residual,
                start.elapsed().as_secs_f64()
            );
        }
        Err(e) => {
            eprintln!("{path}: {e}");
            std::process::exit(4);
        }
    }
}
