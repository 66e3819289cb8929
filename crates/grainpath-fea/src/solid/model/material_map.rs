//! A mesh with its materials.

use super::error::SolidError;
use super::quadratic_tet::Law;
use super::tet_mesh::TetMesh;
use crate::material::Stiffness;

/// Elements and what they are made of.
#[derive(Debug, Clone)]
pub struct Model<'m> {
    /// The elements.
    pub mesh: &'m TetMesh,
    /// Stiffnesses in part coordinates.
    pub materials: Vec<Stiffness>,
    /// Index of each element's stiffness; empty if all have the first.
    pub material_of_tet: Vec<u32>,
}

impl<'m> Model<'m> {
    /// All elements of one material.
    pub fn uniform(mesh: &'m TetMesh, stiffness: Stiffness) -> Self {
        Self { mesh, materials: vec![stiffness], material_of_tet: Vec::new() }
    }

    /// Index of an element's material.
    pub fn material(&self, tet: usize) -> usize {
        self.material_of_tet.get(tet).map_or(0, |&m| m as usize)
    }

    pub(crate) fn laws(&self) -> Result<Vec<Law>, SolidError> {
        let law = |(material, d)| Law::new(d).ok_or(SolidError::Material { material });
        self.materials.iter().enumerate().map(law).collect()
    }
}
