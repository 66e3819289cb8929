//! Converts meshes between arrays and the planner's types.

use std::path::PathBuf;

use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, TriMesh};
use grainpath_io::{MeshBody, MeshFile, ModifierVolume, PaintedSupports};
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

    /// All data, from which [`mesh_from_parts`] makes the mesh again.
    #[allow(clippy::type_complexity)]
    fn parts<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Option<f64>, Vec<Body<Surface<'py>>>, Vec<Modifier<Surface<'py>>>, String)> {
        let body = |b: &MeshBody| -> PyResult<Body<Surface<'py>>> {
            let paint = &b.painted_supports;
            let painted = (arrays(py, &paint.enforcers)?, arrays(py, &paint.blockers)?);
            Ok((b.name.clone(), arrays(py, &b.mesh)?, painted.0, painted.1))
        };
        let modifier = |m: &ModifierVolume| -> PyResult<Modifier<Surface<'py>>> {
            Ok((m.name.clone(), arrays(py, &m.mesh)?, m.settings.clone()))
        };
        let bodies = self.file.bodies.iter().map(body).collect::<PyResult<_>>()?;
        let modifiers = self.file.modifiers.iter().map(modifier).collect::<PyResult<_>>()?;
        Ok((self.unit_mm(), bodies, modifiers, self.warnings()))
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
        worker::run(py, &Caller::default(), move |diagnostics, _| {
            Ok(grainpath_cli::list_faces(file, diagnostics)?.to_string())
        })
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

/// A surface as arrays of the caller: vertices `(n, 3)` and triangles `(m, 3)`.
type Given<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, u32>);
/// A surface as arrays for the caller.
type Surface<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);
/// A body: its name, its surface, and the facets that were painted as enforcers and as blockers of supports.
type Body<S> = (Option<String>, S, S, S);
/// A modifier volume: its name, its surface and its settings.
type Modifier<S> = (Option<String>, S, Vec<(String, String)>);

/// A surface as arrays.
fn arrays<'py>(py: Python<'py>, mesh: &TriMesh) -> PyResult<Surface<'py>> {
    let points: Vec<f64> = mesh.vertices.iter().flat_map(|p| p.to_array()).collect();
    let corners: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
    let (n, m) = (mesh.vertices.len(), mesh.triangles.len());
    Ok((PyArray1::from_vec(py, points).reshape([n, 3])?, PyArray1::from_vec(py, corners).reshape([m, 3])?))
}

/// Makes a mesh of parts, as [`MeshData::parts`] gives them: unit in mm, bodies, modifier volumes and warnings as JSON. The
/// Python side has checked the shapes and types of the arrays.
#[pyfunction]
pub(crate) fn mesh_from_parts(
    py: Python<'_>,
    unit_mm: Option<f64>,
    bodies: Vec<Body<Given<'_>>>,
    modifiers: Vec<Modifier<Given<'_>>>,
    warnings: &str,
) -> PyResult<MeshData> {
    let wrong = |message: &str| errors::exception(py, Kind::Input, message, None, None);
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
    let surface = |(points, corners): &Given<'_>| -> PyResult<TriMesh> {
        let vertices: Vec<DVec3> = points.as_slice()?.chunks_exact(3).map(DVec3::from_slice).collect();
        let corners = corners.as_slice()?;
        if corners.iter().any(|i| *i as usize >= vertices.len()) {
            return Err(wrong("a face names a vertex that does not exist"));
        }
        let triangles = corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        Ok(TriMesh { vertices, triangles })
    };
    let body = |(name, mesh, enforcers, blockers): Body<Given<'_>>| -> PyResult<MeshBody> {
        let painted_supports =
            PaintedSupports { enforcers: surface(&enforcers)?, blockers: surface(&blockers)? };
        Ok(MeshBody { name, mesh: surface(&mesh)?, painted_supports })
    };
    let modifier = |(name, mesh, settings): Modifier<Given<'_>>| -> PyResult<ModifierVolume> {
        Ok(ModifierVolume { name, mesh: surface(&mesh)?, settings })
    };
    let file = MeshFile {
        bodies: bodies.into_iter().map(body).collect::<PyResult<_>>()?,
        unit,
        modifiers: modifiers.into_iter().map(modifier).collect::<PyResult<_>>()?,
        warnings: serde_json::from_str(warnings).map_err(|e| wrong(&format!("warnings of a mesh: {e}")))?,
    };
    Ok(MeshData { file })
}
