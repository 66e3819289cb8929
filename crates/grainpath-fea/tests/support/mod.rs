//! Meshes and materials for tests.
#![allow(dead_code, reason = "each test binary takes what it needs")]

use grainpath_core::{DMat3, DVec3};
use grainpath_fea::material::{Orthotropic, Stiffness};
use grainpath_fea::solid::TetMesh;

/// A block of cells, each of six tetrahedra, mapped to a shape. All ten nodes of an element lie on the
/// map.
pub(crate) struct Brick {
    n: [usize; 3],
    map: Box<dyn Fn(DVec3) -> DVec3>,
}

impl Brick {
    /// Numbers of cells along the sides of the unit cube.
    pub(crate) fn new(n: [usize; 3], map: impl Fn(DVec3) -> DVec3 + 'static) -> Self {
        Self { n, map: Box::new(map) }
    }

    /// The mesh.
    pub(crate) fn mesh(&self) -> TetMesh {
        let [nx, ny, nz] = self.n;
        let id = |x: usize, y: usize, z: usize| ((z * (ny + 1) + y) * (nx + 1) + x) as u32;
        let (mut unit, mut tets) = (Vec::new(), Vec::new());
        for z in 0..=nz {
            for y in 0..=ny {
                for x in 0..=nx {
                    let share = |i: usize, n: usize| i as f64 / n as f64;
                    unit.push(DVec3::new(share(x, nx), share(y, ny), share(z, nz)));
                    if x == nx || y == ny || z == nz {
                        continue;
                    }
                    for p in [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]] {
                        let v = |b: usize| id(x + (b & 1), y + (b >> 1 & 1), z + (b >> 2));
                        tets.push([v(0), v(p[0]), v(p[1]), v(7)]);
                    }
                }
            }
        }
        let mut mesh = TetMesh::straight(&unit, &tets);
        for p in &mut mesh.nodes {
            *p = (self.map)(*p);
        }
        // A map that mirrors reverses all elements.
        if mesh.volume_mm3() < 0.0 {
            for t in &mut mesh.tets {
                *t = [t[0], t[2], t[1], t[3], t[6], t[5], t[4], t[7], t[9], t[8]];
            }
            mesh.find_faces();
        }
        mesh
    }
}

/// An isotropic stiffness.
pub(crate) fn isotropic(e_mpa: f64, nu: f64) -> Stiffness {
    Orthotropic::isotropic(e_mpa, nu).stiffness().expect("stable")
}

/// A stiffness rotated by a vector: its direction is the axis, its length the angle in radians.
pub(crate) fn rotated(c: &Stiffness, axis: DVec3) -> Stiffness {
    let q = DMat3::from_axis_angle(axis.normalize(), axis.length());
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
    const AT: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];
    let mut out = [[0.0; 6]; 6];
    for (a, &(i, j)) in PAIRS.iter().enumerate() {
        for (b, &(k, l)) in PAIRS.iter().enumerate() {
            for m in 0..81 {
                let (p, r, s, t) = (m % 3, m / 3 % 3, m / 9 % 3, m / 27);
                let turn = q.col(p)[i] * q.col(r)[j] * q.col(s)[k] * q.col(t)[l];
                out[a][b] += turn * c[AT[p][r]][AT[s][t]];
            }
        }
    }
    out
}
