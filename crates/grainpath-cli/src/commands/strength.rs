//! `grainpath strength`: computes the load that a part carries until it breaks.

use std::path::{Path, PathBuf};

use grainpath::guide::boundary_conditions;
use grainpath::measure::strength::{
    PrintedPart, StrengthError, StrengthSettings, TestSetup, Tested, test_noting,
};
use grainpath::run::config::strength as strength_settings;
use grainpath::run::{Sliced, mesh_and_layers};
use grainpath_core::{DVec2, Diagnostics, Warning};
use grainpath_gcode::{Program, simulate, write_gcode};
use grainpath_io::fe::{PlateDeck, write_plate_deck};
use grainpath_job::Settings;
use grainpath_view::strength::chart_svg;
use serde_json::{Value, json};

use crate::args::{Common, Strength};
use crate::claims::Claims;
use crate::inputs::{
    Given, Handed, claim_inputs, no_shape, plan_given, read_body, read_deck, read_settings, set_threads,
    shape_of,
};
use crate::{Failure, files, memory, outputs, progress};

/// The result of testing a job or a program.
pub struct Done {
    /// File name without its extension.
    pub name: String,
    /// The test.
    pub tested: Tested,
    /// The program that was tested.
    pub program: Program,
    /// All warnings.
    pub warnings: Vec<Warning>,
}

/// `grainpath strength`
pub(crate) fn strength(args: &Strength) -> Result<(), Failure> {
    set_threads(args.common.threads)?;
    let deck = args.deck.as_deref();
    if let Some(folder) = &args.preview {
        let mut claims = claims_of(&args.input, args.job.as_deref(), &args.common)?;
        deck.into_iter().for_each(|deck| claims.write("--deck", deck));
        claims.write_into("--preview", folder, |name| {
            name == outputs::STRENGTH_CURVE || outputs::STRENGTH_PICTURES.contains(&name)
        });
        claims.check()?;
    }
    let done = test_one(&args.input, args.job.as_deref(), &args.common, None, deck, &|_| {})?;
    args.common.refuse(&done.warnings, false)?;
    let mut written = Value::Null;
    if let Some(folder) = &args.preview {
        for (name, picture) in outputs::strength_pictures(&done.tested) {
            outputs::save(&folder.join(name), &picture.png)?;
        }
        outputs::save(&folder.join(outputs::STRENGTH_CURVE), chart_svg(&done.tested.report).as_bytes())?;
        written = json!({ "preview": folder.display().to_string() });
    }
    if let Some(path) = deck {
        write_deck(&done, path)?;
        written["deck"] = json!(path.display().to_string());
    }
    if args.common.json {
        let mut value = json!({
            "ok": true, "version": env!("CARGO_PKG_VERSION"), "layers": done.program.layers.len(),
            "mass_g": done.tested.report.mass_g, "time_s": (done.program.time_s * 10.0).round() / 10.0,
            "strength": done.tested.report, "peak_rss_mb": memory::peak_rss_mb(), "warnings": done.warnings,
        });
        if !written.is_null() {
            value["outputs"] = written;
        }
        files::print(&format!("{value}\n"));
    } else {
        let warnings: String = done.warnings.iter().map(|w| format!("\nwarning: {w}")).collect();
        let deck = deck.map_or_else(String::new, |path| format!("\ndeck: {}", path.display()));
        files::print(&format!("{}{warnings}{deck}\n", done.tested.report.summary()));
    }
    Ok(())
}

/// Writes the plate of a test as a deck.
fn write_deck(done: &Done, path: &Path) -> Result<(), Failure> {
    let model = done.tested.model.as_ref().ok_or_else(|| failed(StrengthError::NoPlate))?;
    let holds: Vec<(u32, DVec2)> = model.holds.iter().map(|h| (h.node, h.along)).collect();
    let mut bytes = Vec::new();
    let deck = PlateDeck {
        title: &format!("{}, load case {}: laid beads as a plate", done.name, done.tested.report.case),
        thickness_mm: done.tested.element_mm().z,
        nodes_mm: &model.nodes_mm,
        corners: &model.corners,
        membranes_n_mm: &model.membranes_n_mm,
        holds: &holds,
        forces_n: &model.forces_n,
    };
    write_plate_deck(&deck, &mut bytes).map_err(|e| Failure::usage(format!("--deck: {e}")))?;
    outputs::save(path, &bytes)
}

/// Whether a path has the ending of a job file.
pub(crate) fn is_job(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// The job of an input: the input itself if it is a job, otherwise the job that the G-code is tested with.
pub(crate) fn job_of<'a>(input: &'a Path, job: Option<&'a Path>) -> Result<&'a Path, Failure> {
    let none = || {
        Failure::usage(format!(
            "{}: this is not a job (.toml); G-code needs --job JOB.toml for part, loads and material",
            input.display()
        ))
    };
    if is_job(input) { Ok(input) } else { job.ok_or_else(none) }
}

/// The files that a test reads.
pub(super) fn claims_of(input: &Path, job: Option<&Path>, common: &Common) -> Result<Claims, Failure> {
    let job = job_of(input, job)?;
    let (settings, folder) = read_settings(job, &common.sets)?;
    let mut claims = Claims::default();
    claims.read("job", job);
    claims.read("program", input);
    let shape = shape_of(&settings, &folder).unwrap_or_default();
    claim_inputs(&settings, &shape, &folder, &mut claims);
    Ok(claims)
}

/// Tests a job, or a program with the job it belongs to. `mass_g` is the mass to which the job's infill is adjusted, and
/// `deck` the file to which the caller will write the plate; `note` receives a first result early.
pub(crate) fn test_one(
    input: &Path,
    job: Option<&Path>,
    common: &Common,
    mass_g: Option<f64>,
    deck: Option<&Path>,
    note: &(dyn Fn(&str) + Sync),
) -> Result<Done, Failure> {
    let job = job_of(input, job)?;
    let (mut settings, folder) = read_settings(job, &common.sets)?;
    settings.fill.mass_g = mass_g.or(settings.fill.mass_g);
    if let Some(deck) = deck {
        let mut claims = claims_of(input, Some(job), common)?;
        claims.write("--deck", deck);
        claims.check()?;
    }
    let diagnostics = progress::diagnostics();
    let theirs = if is_job(input) { None } else { Some(files::read(input)?) };
    let (name, given, keep_model) = (job.display().to_string(), Given::default(), deck.is_some());
    let tested = TestedJob { settings, folder, name, given, keep_model };
    tested.test(input, theirs.as_deref(), &diagnostics, note)
}

/// A job whose part is tested.
pub struct TestedJob {
    /// Its settings.
    pub settings: Settings,
    /// The folder to which its paths are relative.
    pub folder: PathBuf,
    /// Its name in errors.
    pub name: String,
    /// Inputs that the caller passes in memory, so that their files are not read.
    pub given: Given,
    /// Whether the result holds the model of a plate.
    pub keep_model: bool,
}

impl TestedJob {
    /// Tests the part as the job prints it, or, with `theirs`, as this G-code prints it. `input` is the path of either.
    pub fn test(
        mut self,
        input: &Path,
        theirs: Option<&[u8]>,
        diagnostics: &Diagnostics,
        note: &(dyn Fn(&str) + Sync),
    ) -> Result<Done, Failure> {
        self.settings.strength.enabled = true;
        let given = std::mem::take(&mut self.given);
        let settings = &self.settings;
        let program = theirs.map(|bytes| read(settings, bytes, input)).transpose()?;
        // A shape passed in memory need not be named in the job.
        let named_shape = shape_of(settings, &self.folder);
        let shape = named_shape.or_else(|| given.shape.is_some().then(|| PathBuf::from(&self.name)));
        let tested = match (program, shape) {
            (Some(program), None) => {
                let tested = test_printed(settings, &self.wanted(), &program, diagnostics, note);
                tested.map(|t| (t, program)).map_err(|e| named(input, failed(e)))?
            }
            (Some(program), Some(shape)) => {
                let setup = self.setup_for_program(&shape, given, diagnostics)?;
                // Another slicer may have placed the part anywhere on the bed, so no shift is given: the test
                // then finds the part by itself.
                let wanted = self.wanted();
                let tested = test_noting(&wanted, &setup, &program, None, diagnostics, note);
                tested.map(|t| (t, program)).map_err(|e| named(input, failed(e)))?
            }
            (None, Some(shape)) => self.test_own(input, &shape, given, diagnostics, note)?,
            (None, None) => return Err(no_shape(&self.name)),
        };
        let (tested, program) = tested;
        let warnings = warnings(diagnostics, &program);
        let name = input.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Done { name, tested, warnings, program })
    }

    /// What is wanted of the test.
    fn wanted(&self) -> StrengthSettings {
        StrengthSettings { keep_model: self.keep_model, ..strength_settings(&self.settings) }
    }

    /// The test setup (mesh, layers, fixtures and loads of the part) for another slicer's program.
    fn setup_for_program(
        &self,
        shape: &Path,
        given: Given,
        diagnostics: &Diagnostics,
    ) -> Result<TestSetup, Failure> {
        let settings = &self.settings;
        // A photograph or a scan has its shape only after planning, so those jobs are planned even for a
        // program of another slicer.
        if settings.shape.mesh.is_empty() && settings.shape.outline.is_empty() {
            let (planned, _) = plan_given(settings, given, shape, &self.folder, diagnostics)?;
            return planned.test.ok_or_else(not_enabled);
        }
        // For meshes and outlines the fill need not be planned: sections, fixtures and loads are enough.
        let source = |source| grainpath::Error::Shape { path: shape.display().to_string(), source };
        let file = match given.shape {
            Some(Handed::Mesh(mesh)) => mesh,
            Some(Handed::Scan(_) | Handed::Layers(_)) | None => read_body(settings, shape, diagnostics)?.0,
        };
        let Sliced { mesh, stack, lowered_mm, .. } =
            mesh_and_layers(&grainpath::run::config::placing(settings), file, diagnostics).map_err(source)?;
        let standing = grainpath::run::config::standing(settings, lowered_mm);
        let deck = read_deck(settings, &self.folder)?;
        let loads = grainpath::run::config::loads(settings, deck.as_ref());
        let conditions = boundary_conditions(&loads, &mesh, &standing).map_err(|e| failed(e.into()))?;
        TestSetup::new(&strength_settings(settings), &mesh, &stack, conditions).map_err(failed)
    }

    /// Plans the job and tests the program that is written.
    fn test_own(
        &self,
        input: &Path,
        shape: &Path,
        given: Given,
        diagnostics: &Diagnostics,
        note: &(dyn Fn(&str) + Sync),
    ) -> Result<(Tested, Program), Failure> {
        let (mut planned, _) = plan_given(&self.settings, given, shape, &self.folder, diagnostics)?;
        let setup = planned.test.take().ok_or_else(not_enabled)?;
        let mut bytes = Vec::new();
        // The plan is written as G-code and read back, so that the test includes the rounding of the
        // program, as for any other slicer.
        write_gcode(&planned.plan, &planned.config, &[], &mut bytes)
            .map_err(|e| Failure::from(grainpath::Error::from(e)))?;
        let program = read(&self.settings, &bytes, input)?;
        let shift = planned.plan.plate_from_part_mm.truncate();
        // The test takes much memory itself, and needs neither the plan nor its text.
        drop((planned, bytes));
        let wanted = self.wanted();
        let tested = test_noting(&wanted, &setup, &program, Some(shift), diagnostics, note);
        Ok((tested.map_err(failed)?, program))
    }
}

/// Tests a program without a model: the part is what the program prints, in the program's coordinates.
fn test_printed(
    settings: &Settings,
    wanted: &StrengthSettings,
    program: &Program,
    diagnostics: &Diagnostics,
    note: &(dyn Fn(&str) + Sync),
) -> Result<Tested, StrengthError> {
    if !settings.guide.deck.is_empty() {
        return Err(StrengthError::NeedsSurface("guide.deck".into()));
    }
    let part = PrintedPart::new(program)?;
    let conditions = part.conditions(&grainpath::run::config::loads(settings, None))?;
    let setup = TestSetup::new(wanted, &part.mesh, &part.stack, conditions)?;
    test_noting(wanted, &setup, program, Some(DVec2::ZERO), diagnostics, note)
}

fn failed(error: StrengthError) -> Failure {
    Failure::from(grainpath::Error::from(error))
}

fn not_enabled() -> Failure {
    Failure::usage("strength.enabled should be true")
}

fn named(input: &Path, f: Failure) -> Failure {
    Failure { message: format!("{}: {}", input.display(), f.message), ..f }
}

fn read(settings: &Settings, bytes: &[u8], path: &Path) -> Result<Program, Failure> {
    let limits = grainpath::run::config::limits(settings);
    simulate(bytes, settings.printer.filament_mm, &limits).map_err(|e| Failure::of_file(path, e))
}

fn warnings(diagnostics: &Diagnostics, program: &Program) -> Vec<Warning> {
    let mut all = diagnostics.warnings();
    all.extend(program.warnings.iter().cloned());
    all
}
