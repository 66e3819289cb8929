//! The interface between the studio and the command line, which does the work: placing the shape of a job, solving its
//! loads, planning it, and testing a job or a program.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use grainpath_core::{Diagnostics, Warning};
use grainpath_gcode::Program;
use serde_json::Value;

use crate::refusal::{Refusal, RefusalKind};
use crate::roots::Roots;

/// A job file: its text, its name in errors, and the folder to which its paths are relative.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JobText {
    /// TOML.
    pub text: String,
    /// Name in errors.
    pub name: String,
    /// Folder to which paths in the job are relative.
    pub folder: PathBuf,
}

/// A file that a run wrote.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    /// Its kind, as the key below `[output]`.
    pub kind: String,
    /// Its path.
    pub path: PathBuf,
}

/// The elements that broke in a strength test, and the share of its stiffness that each has lost.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Damage {
    /// Edges of an element, mm.
    pub cell_mm: [f64; 3],
    /// Angle of its first edge from the x axis, rad.
    pub angle_rad: f64,
    /// For each broken element its centre, mm, in the program's coordinates; the share of stiffness lost, 0 to 1; and the
    /// index of the first of `states` in which it is broken.
    pub cells: Vec<([f32; 3], f32, u32)>,
    /// Displacement in mm and load in N of every state that was solved, in order.
    pub states: Vec<[f64; 2]>,
}

/// The surface of a part as a job places it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// Vertices, mm, part coordinates.
    pub vertices: Vec<[f32; 3]>,
    /// Indices of the three vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Number of the face of each triangle; `u32::MAX` for triangles without one.
    pub face: Vec<u32>,
    /// Both ends of each edge that is open or has more than two triangles.
    pub faulty_edges: Vec<[[f32; 3]; 2]>,
    /// Both ends of each faulty edge of the file before it was mended, including edges between oppositely wound triangles.
    pub file_faults: Vec<[[f32; 3]; 2]>,
    /// Edges between two faces, as indices of vertices.
    pub borders: Vec<[u32; 2]>,
}

/// A branch of a support, from its upper end to its lower one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Branch {
    /// Its ends, mm, part coordinates, each with the radius there.
    pub ends: [[f32; 4]; 2],
    /// The load that it carries, N.
    pub load_n: f32,
    /// Whether its upper end is a contact with the part.
    pub is_contact: bool,
}

/// Stress and displacement of a part under its loads, on the surface of the mesh that was solved.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StressSurface {
    /// Points, mm, part coordinates.
    pub points: Vec<[f32; 3]>,
    /// Indices of points.
    pub triangles: Vec<[u32; 3]>,
    /// The values of each load case.
    pub cases: Vec<CaseValues>,
    /// The solid, for sections.
    pub volume: StressVolume,
}

/// The solid that was solved.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StressVolume {
    /// Points, mm, part coordinates.
    pub points: Vec<[f32; 3]>,
    /// Indices of points.
    pub tetrahedra: Vec<[u32; 4]>,
}

/// A principal stress line: each point, mm, part coordinates, with the stress along the line, MPa.
pub type StressLine = Vec<[f32; 4]>;

/// A load case of a [`StressSurface`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CaseValues {
    /// Name of the case.
    pub name: String,
    /// For each point of the surface stress xx, yy, zz, xy, yz, zx in MPa, then displacement x, y, z in mm.
    pub values: Vec<[f32; 9]>,
    /// The same nine values at each point of the [`StressVolume`].
    pub inside: Vec<[f32; 9]>,
    /// Lines along the greatest and the smallest principal stress.
    pub lines: Vec<StressLine>,
}

/// A file as it was when a run read it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadFile {
    path: PathBuf,
    bytes: u64,
    modified: Option<SystemTime>,
}

impl ReadFile {
    /// A file as it is now; `None` where it cannot be looked at. Of a folder it is the list of its files that counts.
    pub fn now(path: &Path) -> Option<Self> {
        let found = std::fs::metadata(path).ok()?;
        Some(Self { path: path.to_owned(), bytes: found.len(), modified: found.modified().ok() })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it has another size or time of change now, or is gone.
    pub fn has_changed(&self) -> bool {
        Self::now(&self.path).as_ref() != Some(self)
    }
}

/// The result of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Finished {
    /// The report that the command prints with `--json`.
    pub report: Value,
    /// The program that was written or tested.
    pub program: Arc<Program>,
    /// Angle of each bead of each layer of the program to the direction that its guide asks for, in halves of a degree, or
    /// [`NO_VALUE`](crate::records::NO_VALUE); `None` without a guide.
    pub angles: Option<Vec<Vec<u8>>>,
    /// Reserve of each bead of each layer, as [`reserve_byte`](crate::records::reserve_byte) gives it; `None` where none is
    /// told.
    pub reserve: Option<Vec<Vec<u8>>>,
    /// The elements that broke in a strength test.
    pub damage: Option<Damage>,
    /// The part as it is placed.
    pub surface: Option<Surface>,
    /// The file that the part was read from, before it was read.
    pub part_file: Option<ReadFile>,
    /// Stress and displacement of the part under its loads.
    pub stress: Option<StressSurface>,
    /// The branches of its supports.
    pub branches: Option<Vec<Branch>>,
    /// Files that were written.
    pub outputs: Vec<Output>,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// A ready example: its name and what it shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Example {
    /// Name, as `grainpath new` takes it.
    pub name: &'static str,
    /// What it shows, in words.
    pub about: &'static str,
}

/// A file of an example: name and content.
pub type ExampleFile = (String, Vec<u8>);

/// What a picture shows that the server draws, for browsers that draw nothing in three dimensions.
#[derive(Debug, Clone, Copy)]
pub enum Pictured<'a> {
    /// All layers of a program.
    Part(&'a Program),
    /// A layer of a program, counted from 0.
    Layer(&'a Program, usize),
    /// The numbered faces of a part.
    Shape(&'a Surface),
    /// The von Mises stress of a load case.
    Stress(&'a StressSurface, &'a CaseValues),
}

/// Does the work of runs. The implementation checks every file with [`Roots`] before it is read or written.
pub trait Engine: Send + Sync {
    /// The exit code of the command line for this kind of failure.
    fn exit_code(&self, kind: RefusalKind) -> i32;

    /// The text of a job that plans a mesh, a drawing, a photograph or a scan with defaults.
    ///
    /// # Errors
    /// [`Refusal`] for a file of another kind.
    fn job_for(&self, file: &Path) -> Result<String, Refusal>;

    /// Reads a job without doing anything.
    ///
    /// # Errors
    /// [`Refusal`] with the sentence that a run of it would begin with.
    fn check(&self, job: &JobText, roots: &Roots) -> Result<(), Refusal>;

    /// A picture as PNG.
    fn picture(&self, of: Pictured<'_>) -> Vec<u8>;

    /// The examples.
    fn examples(&self) -> Vec<Example>;

    /// The files of an example, its job first; `None` for an unknown name.
    fn example(&self, name: &str) -> Option<Vec<ExampleFile>>;

    /// Places the shape of a job and finds its faces; nothing is written.
    ///
    /// # Errors
    /// As [`Engine::plan`].
    fn shape(&self, job: &JobText, roots: &Roots, diagnostics: &Diagnostics) -> Result<Finished, Refusal>;

    /// Solves the loads of a job; nothing is written.
    ///
    /// # Errors
    /// As [`Engine::plan`].
    fn stress(&self, job: &JobText, roots: &Roots, diagnostics: &Diagnostics) -> Result<Finished, Refusal>;

    /// Ranks the poses in which the part of a job stands stably; nothing is written.
    ///
    /// # Errors
    /// As [`Engine::plan`].
    fn orient(&self, job: &JobText, roots: &Roots, diagnostics: &Diagnostics) -> Result<Finished, Refusal>;

    /// Grows the supports of a job; nothing is written.
    ///
    /// # Errors
    /// As [`Engine::plan`].
    fn supports(&self, job: &JobText, roots: &Roots, diagnostics: &Diagnostics) -> Result<Finished, Refusal>;

    /// Plans a job and writes its outputs below `out`. `ready` is called with the program before it is measured and drawn.
    ///
    /// # Errors
    /// [`Refusal`] with the sentence that the command line prints.
    fn plan(
        &self,
        job: &JobText,
        out: &Path,
        roots: &Roots,
        diagnostics: &Diagnostics,
        ready: &dyn Fn(&Arc<Program>),
    ) -> Result<Finished, Refusal>;

    /// Tests how much load a part carries: the part of a job, or of a program under the loads of a job.
    ///
    /// # Errors
    /// As [`Engine::plan`].
    fn strength(
        &self,
        job: &JobText,
        program: Option<&Path>,
        roots: &Roots,
        diagnostics: &Diagnostics,
    ) -> Result<Finished, Refusal>;
}
