//! Converts meshes between arrays and the planner's types.

use std::path::PathBuf;

use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, TriMesh};
use grainpath_io::{MeshBody, MeshFile};
use grainpath_job::Settings;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::errors::{self, Kind};
use crate::worker::{self, Caller};

/// A mesh as it was read from a file: bodies, unit and warnings.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub struct MeshData {
    /// The bodies.
    pub file: MeshFile,
}

impl MeshData {
    /// A mesh with a single body, in mm.
    pub fn from_mesh(mesh: TriMesh) -> Self {
        let bodies = vec![MeshBody { mesh, ..MeshBody::default() }];
        Self {
            file: MeshFile {
                bodies,
                unit: Some(LengthUnit::Millimetre),
                modifiers: Vec::new(),
                warnings: Vec::new(),
            },
        }
    }
}

#[pymethods]
impl MeshData {
    /// Vertices of all bodies, `(n, 3)`.
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let all: Vec<f64> =
            self.file.bodies.iter().flat_map(|b| &b.mesh.vertices).flat_map(|p| p.to_array()).collect();
        let n = all.len() / 3;
        PyArray1::from_vec(py, all).reshape([n, 3])
    }

    /// Indices of the vertices of each triangle, `(m, 3)`; vertices are counted over all bodies.
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let mut all = Vec::new();
        let mut first = 0u32;
        for body in &self.file.bodies {
            all.extend(body.mesh.triangles.iter().flatten().map(|i| i + first));
            first += body.mesh.vertices.len() as u32;
        }
        let n = all.len() / 3;
        PyArray1::from_vec(py, all).reshape([n, 3])
    }

    /// For each body its name and its numbers of vertices and triangles.
    fn bodies(&self) -> Vec<(Option<String>, usize, usize)> {
        let summary = |b: &MeshBody| (b.name.clone(), b.mesh.vertices.len(), b.mesh.triangles.len());
        self.file.bodies.iter().map(summary).collect()
    }

    /// Whether the file has painted supports.
    fn painted(&self) -> bool {
        let paints = self.file.bodies.iter().map(|b| &b.painted_supports);
        paints.flat_map(|p| [&p.enforcers, &p.blockers]).any(|m| !m.triangles.is_empty())
    }

    /// The file's unit in mm; `None` if the file states no unit.
    fn unit_mm(&self) -> Option<f64> {
        self.file.unit.map(LengthUnit::mm)
    }

    /// Warnings as JSON.
    fn warnings(&self) -> String {
        serde_json::json!(self.file.warnings).to_string()
    }

    /// Planes, cylinders, cones and spheres of the mended mesh, as JSON.
    fn named_faces(&self, py: Python<'_>) -> PyResult<String> {
        let file = self.file.clone();
        worker::run(py, &Caller::default(), move |_, _| Ok(grainpath_cli::list_faces(file)?.to_string()))
    }

    /// Signed volume of all bodies in the cube of the file's unit.
    fn volume(&self) -> f64 {
        self.file.bodies.iter().map(|b| b.mesh.signed_volume()).sum()
    }
}

/// The mesh of a file.
#[pyfunction]
pub(crate) fn mesh_from_file(py: Python<'_>, path: PathBuf) -> PyResult<MeshData> {
    worker::run(py, &Caller::default(), move |diagnostics, _| {
        // Default settings will do, because only drawings depend on settings.
        let file = grainpath_cli::read_body(&Settings::default(), &path, diagnostics)?.0;
        Ok(MeshData { file })
    })
}

/// Makes a mesh from vertices `(n, 3)` and triangles `(m, 3)`; the Python side has checked the shapes and types of both
/// arrays. `bodies` gives the name of each body and its numbers of vertices and triangles.
#[pyfunction]
pub(crate) fn mesh_from_arrays(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    faces: PyReadonlyArray2<'_, u32>,
    unit_mm: Option<f64>,
    bodies: Vec<(Option<String>, usize, usize)>,
) -> PyResult<MeshData> {
    let wrong = |message: &str| errors::exception(py, Kind::Input, message, None, None);
    let (points, corners) = (vertices.as_slice()?, faces.as_slice()?);
    let units = [
        LengthUnit::Micron,
        LengthUnit::Millimetre,
        LengthUnit::Centimetre,
        LengthUnit::Inch,
        LengthUnit::Foot,
        LengthUnit::Metre,
    ];
    let unit = match unit_mm {
        Some(mm) => Some(units.into_iter().find(|u| u.mm() == mm).ok_or_else(|| wrong("no such unit"))?),
        None => None,
    };
    let (mut points, mut corners) = (points.chunks_exact(3), corners.chunks_exact(3));
    let mut file = MeshFile { bodies: Vec::new(), unit, modifiers: Vec::new(), warnings: Vec::new() };
    let mut first = 0u32;
    for (name, n_vertices, n_triangles) in bodies {
        let vertices: Vec<DVec3> = points.by_ref().take(n_vertices).map(DVec3::from_slice).collect();
        let inside = |i: u32| i.checked_sub(first).filter(|i| (*i as usize) < vertices.len());
        let triangle = |t: &[u32]| Some([inside(t[0])?, inside(t[1])?, inside(t[2])?]);
        let triangles: Option<Vec<[u32; 3]>> = corners.by_ref().take(n_triangles).map(triangle).collect();
        let triangles = triangles.ok_or_else(|| wrong("a face names a vertex that does not exist"))?;
        first += n_vertices as u32;
        file.bodies.push(MeshBody { name, mesh: TriMesh { vertices, triangles }, ..MeshBody::default() });
    }
    Ok(MeshData { file })
}
