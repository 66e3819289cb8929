//! `grainpath studio`: serves the web application on this computer.
//!
//! The crate `grainpath-studio` is the server; this file runs its jobs with the code of `run` and `strength`, so that the
//! page and the command line give the same bytes. Every file that a job names is checked against the studio's folders first.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;

use grainpath::guide::KnownStress;
use grainpath::measure::Planned;
use grainpath_core::tensor::von_mises;
use grainpath_core::{DVec3, Diagnostics, TriMesh};
use grainpath_gcode::Program;
use grainpath_job::{Settings, parse_job};
use grainpath_parts::presets;
use grainpath_studio::records::{NO_VALUE, reserve_byte};
use grainpath_studio::roots::Roots;
use grainpath_studio::{
    Damage, Engine, Example, ExampleFile, Finished, JobText, Options, Output, Pictured, ReadFile, Refusal,
    RefusalKind, serve,
};
use grainpath_view::faces::{numbered_png, values_png};
use grainpath_view::layer::{Ground, LayerPicture, PictureOptions, layer_png, thumbnail_png};
use serde_json::json;

use super::render::angles_to_guide;
use super::slice;
use super::strength::TestedJob;
use super::studio_part;
use crate::args::Studio;
use crate::claims::Claims;
use crate::inputs::{Given, claim_inputs, no_shape, plan_given, shape_of};
use crate::{ExitCode, Failure, files, interrupt, memory, outputs};

/// Width and height of pictures of the part for browsers without WebGL 2, pixels. Source: chosen: the page's view on a screen of
/// 1280 pixels has 900.
const PICTURE_PX: (u32, u32) = (1000, 750);

/// Name of the folder inside the current folder to which the studio writes.
const WORK: &str = "grainpath-studio";

/// `grainpath studio`
pub(crate) fn studio(args: &Studio) -> Result<(), Failure> {
    let here = PathBuf::from(".");
    let options = Options {
        work: here.join(WORK),
        roots: std::iter::once(here).chain(args.roots.iter().cloned()).collect(),
        file: args.file.clone(),
        hosts: args.hosts.clone(),
        base: args.base.clone(),
        max_upload: args.max_upload,
    };
    let ready = |address: &str| {
        files::print(&format!("{address}\n"));
        eprintln!(
            "grainpath: the studio is at this address until Ctrl-C; it can be opened only from this computer"
        );
        if !args.no_open {
            open(address);
        }
    };
    let served = serve(&options, Arc::new(Commands::default()), ready);
    interrupt::remove_temporary();
    served.map_err(|r| Failure {
        message: r.message,
        code: ExitCode::from(r.kind),
        warnings: Vec::new(),
        page: None,
        file: None,
    })
}

/// Opens an address in the user's browser.
fn open(address: &str) {
    let (program, before): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    command.args(before).arg(address);
    let started = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    if started.is_err() {
        eprintln!("grainpath: no browser could be opened; open the address yourself");
    }
}

/// The engine of the studio: it runs the commands of this program.
#[derive(Default)]
struct Commands {
    /// The stress solved last: it is reused if only settings change that do not affect it.
    known: Arc<KnownStress>,
}

impl Commands {
    fn given(&self) -> Given {
        Given { known: Some(Arc::clone(&self.known)), ..Given::default() }
    }
}

impl From<RefusalKind> for ExitCode {
    fn from(kind: RefusalKind) -> Self {
        match kind {
            RefusalKind::Fault => Self::Fault,
            RefusalKind::Usage => Self::Usage,
            RefusalKind::Input => Self::Input,
            RefusalKind::Physics => Self::Physics,
            RefusalKind::Interrupted => Self::Interrupted,
        }
    }
}

fn refusal(failure: Failure) -> Refusal {
    let kind = match failure.code {
        ExitCode::Fault => RefusalKind::Fault,
        ExitCode::Usage => RefusalKind::Usage,
        ExitCode::Input => RefusalKind::Input,
        ExitCode::Physics => RefusalKind::Physics,
        ExitCode::Interrupted => RefusalKind::Interrupted,
    };
    Refusal { message: failure.message.replace('\n', " "), kind }
}

fn mesh_of(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> TriMesh {
    let vertices = points.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
    TriMesh { vertices, triangles: triangles.to_vec() }
}

/// The settings of a job. Profiles and other texts are read only from folders that the studio may read.
fn settings(job: &JobText, roots: &Roots) -> Result<Settings, Refusal> {
    let load = |path: &str| {
        let real = roots.readable(&job.folder.join(path)).map_err(|r| r.message)?;
        files::read_text(&real).map_err(|f| f.message)
    };
    let settings = parse_job(&job.text, &job.name, &[], &load).map_err(|e| Refusal::usage(e.to_string()))?;
    if settings.ct.outside_folder {
        return Err(Refusal::usage(format!(
            "{}: shape.ct.outside_folder lets a scan name files anywhere; the studio does not allow it",
            job.name
        )));
    }
    Ok(settings)
}

/// Checks that the studio may read all claimed inputs, and that all claimed outputs lie in the folder of the run. Elsewhere
/// below the working folder they could replace what another run wrote, or the history.
fn allowed(claims: &Claims, roots: &Roots, out: Option<&Path>) -> Result<(), Refusal> {
    let (read, written) = claims.paths();
    read.iter().try_for_each(|path| roots.readable(path).map(drop))?;
    for path in written {
        let real = roots.writable(path)?;
        if !out.is_some_and(|out| real.starts_with(out)) {
            let path = path.display();
            return Err(Refusal::usage(format!(
                "{path}: outputs of a run in the studio stay in its own folder; name them in [output] without \"..\""
            )));
        }
    }
    claims.check().map_err(refusal)
}

/// The settings and the shape file of a job that is shown without planning it. Scans have only a surface to look at.
fn looked_at(job: &JobText, roots: &Roots, with_scans: bool) -> Result<(Settings, PathBuf), Refusal> {
    let settings = settings(job, roots)?;
    if !settings.photo.files.is_empty() || !settings.ct.path.is_empty() && !with_scans {
        return Err(Refusal::usage(format!(
            "{}: only meshes and drawings are looked at in this way before they are planned; plan scans and photographs",
            job.name
        )));
    }
    let shape = shape_of(&settings, &job.folder).ok_or_else(|| refusal(no_shape(&job.name)))?;
    let mut claims = Claims::default();
    claim_inputs(&settings, &shape, &job.folder, &mut claims);
    allowed(&claims, roots, None)?;
    Ok((settings, shape))
}

impl Engine for Commands {
    fn exit_code(&self, kind: RefusalKind) -> i32 {
        ExitCode::from(kind).number().into()
    }

    fn job_for(&self, file: &Path) -> Result<String, Refusal> {
        slice::job_text(file).map_err(refusal)?.ok_or_else(|| {
            Refusal::usage(format!(
                "{}: the studio opens job files (.toml), meshes (STL, OBJ, PLY, OFF, 3MF), drawings (SVG, DXF), \
                 photographs (PNG, JPEG, BMP), scans (DICOM, NRRD, NIfTI, MetaImage, TIFF) and G-code",
                file.display()
            ))
        })
    }

    fn check(&self, job: &JobText, roots: &Roots) -> Result<(), Refusal> {
        settings(job, roots).map(drop)
    }

    fn picture(&self, of: Pictured<'_>) -> Vec<u8> {
        let (width, height) = PICTURE_PX;
        match of {
            Pictured::Part(program) => {
                let layers: Vec<_> = program.layers.iter().map(LayerPicture::from).collect();
                thumbnail_png(&layers, width, height, Ground::Paper)
            }
            Pictured::Layer(program, layer) => {
                let options = PictureOptions { size_px: width, ..PictureOptions::default() };
                layer_png(&LayerPicture::from(&program.layers[layer]), &options)
            }
            Pictured::Shape(surface) => {
                // Triangles of faces too small to be named have none; they are left out, as in `inspect --faces`.
                let face_of = |t: usize| Some(surface.face[t]).filter(|f| *f != u32::MAX).map(|f| f as usize);
                let n_faces = (0..surface.face.len()).filter_map(face_of).max().map_or(0, |last| last + 1);
                let mesh = mesh_of(&surface.vertices, &surface.triangles);
                numbered_png(&mesh, &face_of, n_faces, width)
            }
            Pictured::Stress(stress, case) => {
                // The first six of the nine values are the stress; the others are the displacement.
                let value = |v: &[f32; 9]| von_mises(&std::array::from_fn(|k| f64::from(v[k])));
                let values: Vec<f64> = case.values.iter().map(value).collect();
                values_png(&mesh_of(&stress.points, &stress.triangles), &values, width)
            }
        }
    }

    fn examples(&self) -> Vec<Example> {
        let row = |&name: &&'static str| Some(Example { name, about: presets::about(name)? });
        presets::PRESETS.iter().filter_map(row).collect()
    }

    fn example(&self, name: &str) -> Option<Vec<ExampleFile>> {
        Some(presets::preset(name)?.into_iter().map(|(name, bytes)| (name.into_owned(), bytes)).collect())
    }

    fn shape(&self, job: &JobText, roots: &Roots, diagnostics: &Diagnostics) -> Result<Finished, Refusal> {
        let (settings, shape) = looked_at(job, roots, true)?;
        let is_scan = !settings.ct.path.is_empty();
        let looked = if is_scan { studio_part::scan } else { studio_part::shape };
        let part_file = ReadFile::now(&shape);
        let finished = looked(&settings, &shape, diagnostics).map_err(refusal)?;
        Ok(Finished { part_file, ..finished })
    }

    fn stress(&self, job: &JobText, roots: &Roots, diagnostics: &Diagnostics) -> Result<Finished, Refusal> {
        let (settings, shape) = looked_at(job, roots, false)?;
        studio_part::stress(&settings, &shape, &job.folder, Arc::clone(&self.known), diagnostics)
            .map_err(refusal)
    }

    fn orient(&self, job: &JobText, roots: &Roots, diagnostics: &Diagnostics) -> Result<Finished, Refusal> {
        let (settings, shape) = looked_at(job, roots, false)?;
        studio_part::orient(&settings, &shape, &job.folder, Arc::clone(&self.known), diagnostics)
            .map_err(refusal)
    }

    fn supports(&self, job: &JobText, roots: &Roots, diagnostics: &Diagnostics) -> Result<Finished, Refusal> {
        let (settings, shape) = looked_at(job, roots, false)?;
        studio_part::supports(&settings, &shape, diagnostics).map_err(refusal)
    }

    fn plan(
        &self,
        job: &JobText,
        out: &Path,
        roots: &Roots,
        diagnostics: &Diagnostics,
        ready: &dyn Fn(&Arc<Program>),
    ) -> Result<Finished, Refusal> {
        let settings = settings(job, roots)?;
        let shape = shape_of(&settings, &job.folder).ok_or_else(|| refusal(no_shape(&job.name)))?;
        let paths = outputs::Paths::new(&settings, &shape, out).map_err(refusal)?;
        let mut claims = Claims::default();
        claims.read("the job file", Path::new(&job.name));
        claim_inputs(&settings, &shape, &job.folder, &mut claims);
        paths.claim(&mut claims);
        allowed(&claims, roots, Some(out))?;
        let (planned, read_s) =
            plan_given(&settings, self.given(), &shape, &job.folder, diagnostics).map_err(refusal)?;
        let truth = None;
        let (program, angles) = (OnceCell::new(), OnceCell::new());
        let ready = |read: &Arc<Program>, planned: &Planned| {
            ready(read);
            program.get_or_init(|| Arc::clone(read));
            // In halves of a degree.
            let told = |off: Option<f64>| off.map_or(NO_VALUE, |deg| (2.0 * deg).round() as u8);
            angles.get_or_init(|| angles_to_guide(read, planned, told));
        };
        let report = outputs::write(&settings, planned, &paths, read_s, true, truth, &ready, diagnostics);
        let (report, drawn) = report.map_err(refusal)?;
        // `outputs::write` was called with `measured`, so it has read the program back.
        let program = program.into_inner().unwrap_or_default();
        let reserves = drawn.or_else(|| outputs::bead_reserves(&report, &program));
        let bytes = |layer: &Vec<f32>| layer.iter().map(|factor| reserve_byte(*factor)).collect();
        let outputs = report.outputs.iter().map(|(kind, path)| (*kind, PathBuf::from(path)));
        let outputs = outputs.filter(|(_, path)| path.is_file());
        Ok(Finished {
            outputs: outputs.map(|(kind, path)| Output { kind: kind.to_owned(), path }).collect(),
            report: report.to_json(),
            program,
            angles: angles.into_inner().flatten(),
            reserve: reserves.map(|reserves| reserves.of_beads.iter().map(bytes).collect()),
            warnings: report.warnings,
            ..Finished::default()
        })
    }

    fn strength(
        &self,
        job: &JobText,
        program: Option<&Path>,
        roots: &Roots,
        diagnostics: &Diagnostics,
    ) -> Result<Finished, Refusal> {
        let settings = settings(job, roots)?;
        let mut claims = Claims::default();
        let shape = shape_of(&settings, &job.folder);
        claim_inputs(&settings, shape.as_deref().unwrap_or(Path::new("")), &job.folder, &mut claims);
        allowed(&claims, roots, None)?;
        let bytes = program.map(|p| files::read(&roots.readable(p)?).map_err(refusal)).transpose()?;
        let input = program.unwrap_or(Path::new(&job.name)).to_owned();
        let tested = TestedJob {
            settings,
            folder: job.folder.clone(),
            name: job.name.clone(),
            given: self.given(),
            keep_model: false,
        };
        let done = tested.test(&input, bytes.as_deref(), diagnostics, &|_| {}).map_err(refusal)?;
        let size_mm = done.tested.element_mm();
        let cells = done.tested.broken();
        Ok(Finished {
            report: json!({
                "ok": true, "version": env!("CARGO_PKG_VERSION"), "layers": done.program.layers.len(),
                "mass_g": done.tested.report.mass_g, "time_s": done.program.time_s,
                "strength": done.tested.report, "summary": done.tested.report.summary(),
                "peak_rss_mb": memory::peak_rss_mb(),
            }),
            damage: Some(Damage {
                cell_mm: size_mm.to_array(),
                angle_rad: done.tested.element_angle_rad(),
                cells: cells.iter().map(|c| (c.at_mm.as_vec3().to_array(), c.lost, c.state)).collect(),
                states: done.tested.outcome.states.iter().map(|p| [p.displacement_mm, p.load_n]).collect(),
            }),
            program: Arc::new(done.program),
            warnings: done.warnings,
            ..Finished::default()
        })
    }
}
