//! Plans a job whose files the page has handed over by name.

use std::collections::BTreeMap;

use grainpath::measure::report::{Report, measure, measure_fibre};
use grainpath::run::config;
use grainpath::{Error, Planned, Settings};
use grainpath_core::Diagnostics;
use grainpath_core::diagnostics::Stage;
use grainpath_gcode::{Program, Written, simulate, write_gcode};
use grainpath_imaging::photo::Photo;
use grainpath_io::directions::{DensitySamples, DirectionSamples, parse_densities};
use grainpath_io::fe::{DeckConditions, FeError, StressField, parse_fe};
use grainpath_io::image::decode_luma;
use grainpath_io::{MeshFile, parse_mesh, parse_outline};
use grainpath_job::choices::GuideKind;
use grainpath_job::parse_job;
use grainpath_job::regions::RegionPlace;

/// The name of the job in messages.
const JOB: &str = "job.toml";

/// Files by the names that the job uses for them, and settings that override those of the job.
pub(crate) struct Inputs {
    files: BTreeMap<String, Vec<u8>>,
    sets: Vec<String>,
}

/// The result of planning a job.
#[derive(Debug)]
pub(crate) struct Answer {
    /// The program.
    pub(crate) gcode: Vec<u8>,
    /// JSON with `summary`, as the command line prints it, and `report`.
    pub(crate) report: String,
}

impl Inputs {
    pub(crate) const fn new() -> Self {
        Self { files: BTreeMap::new(), sets: Vec::new() }
    }

    pub(crate) fn add_file(&mut self, name: String, content: Vec<u8>) {
        self.files.insert(plain(&name).to_owned(), content);
    }

    pub(crate) fn add_setting(&mut self, set: String) {
        self.sets.push(set);
    }

    /// Plans a job and writes its program, as `grainpath run` does. The error is one line for the user.
    pub(crate) fn plan(&self, text: &str, diagnostics: &Diagnostics) -> Result<Answer, String> {
        let load = |name: &str| {
            let bytes = self.file(name)?;
            String::from_utf8(bytes.to_vec()).map_err(|_| format!("{name}: not UTF-8 text"))
        };
        let settings = parse_job(text, JOB, &self.sets, &load).map_err(|e| e.to_string())?;
        let read_from_s = diagnostics.now_s();
        diagnostics.begin(Stage::Read, 0);
        let shape = self.shape(&settings)?;
        let photos = self.photos(&settings)?;
        let directions = self.directions(&settings)?;
        let read_s = diagnostics.now_s() - read_from_s;
        let planned = match shape {
            None => grainpath::plan_photo(&settings, &photos, directions, diagnostics),
            Some((path, mesh)) => {
                let stress = self.stress(&settings)?;
                let deck = self.deck(&settings)?;
                let regions = self.regions(&settings)?;
                let densities = self.densities(&settings)?;
                let inputs = grainpath::Inputs {
                    mesh,
                    path,
                    stress,
                    deck,
                    directions,
                    densities,
                    photos,
                    texture: None,
                    regions,
                    known: None,
                };
                grainpath::plan_job(&settings, inputs, diagnostics)
            }
        };
        write(&settings, &planned.map_err(|e| e.to_string())?, read_s, diagnostics)
    }

    fn file(&self, name: &str) -> Result<&[u8], String> {
        self.files.get(plain(name)).map(Vec::as_slice).ok_or_else(|| {
            let there: Vec<&str> = self.files.keys().map(String::as_str).collect();
            match there.as_slice() {
                [] => format!("{name}: no such file was given; no files were given at all"),
                _ => format!("{name}: no such file was given; there are {}", there.join(", ")),
            }
        })
    }

    /// The name of the shape's file, and its mesh; `None` if the shape is the board in a photograph.
    fn shape(&self, settings: &Settings) -> Result<Option<(String, MeshFile)>, String> {
        let shape = &settings.shape;
        if !settings.ct.path.is_empty() {
            return Err(
                "shape.ct: scans are not planned in a page; `grainpath run` takes this job".to_owned()
            );
        }
        if !settings.photo.files.is_empty() {
            return Ok(None);
        }
        if !shape.outline.is_empty() {
            let path = shape.outline.clone();
            let outline = parse_outline(self.file(&path)?, &config::outline(settings))
                .map_err(|source| Error::Outline { path: path.clone(), source }.to_string())?;
            let body = grainpath::shape::extruded(outline, config::outline_thickness_mm(settings));
            let body = body.map_err(|source| Error::Shape { path: path.clone(), source }.to_string())?;
            return Ok(Some((path, body)));
        }
        if shape.mesh.is_empty() {
            return Err(format!(
                "{JOB}: [shape] needs mesh = \"FILE\", outline = \"FILE\" or photo = {{ files = [\"FILE\"], ... }}"
            ));
        }
        Ok(Some((shape.mesh.clone(), self.mesh(&shape.mesh)?)))
    }

    fn mesh(&self, path: &str) -> Result<MeshFile, String> {
        parse_mesh(self.file(path)?, Some(path))
            .map_err(|source| Error::Mesh { path: path.to_owned(), source }.to_string())
    }

    fn regions(&self, settings: &Settings) -> Result<BTreeMap<usize, MeshFile>, String> {
        let mut all = BTreeMap::new();
        for (k, region) in settings.regions.iter().enumerate() {
            if let RegionPlace::Mesh(file) = &region.on {
                all.insert(k, self.mesh(file)?);
            }
        }
        Ok(all)
    }

    fn photos(&self, settings: &Settings) -> Result<Vec<Photo>, String> {
        if settings.guide.kind == GuideKind::Grain && !settings.volume.path.is_empty() {
            return Err(
                "guide.volume: scans are not read in a page; `grainpath run` takes this job".to_owned()
            );
        }
        let read = |file: &String| {
            let image = decode_luma(self.file(file)?)
                .map_err(|source| Error::Image { path: file.clone(), source }.to_string())?;
            Ok(Photo::from_image(file.clone(), image))
        };
        settings.grain_photos().iter().map(read).collect()
    }

    fn directions(&self, settings: &Settings) -> Result<Option<DirectionSamples>, String> {
        if settings.guide.kind != GuideKind::Field {
            return Ok(None);
        }
        let path = &settings.field.path;
        let read = grainpath_io::directions::parse_directions(
            &[(path, self.file(path)?)],
            &config::directions(settings),
        );
        read.map(Some).map_err(|source| Error::Directions { path: path.clone(), source }.to_string())
    }

    fn densities(&self, settings: &Settings) -> Result<Option<DensitySamples>, String> {
        let Some((path, array)) = settings.fill.density.file() else { return Ok(None) };
        let read = parse_densities(self.file(path)?, path, array);
        read.map(Some).map_err(|source| Error::Densities { path: path.to_owned(), source }.to_string())
    }

    fn deck(&self, settings: &Settings) -> Result<Option<DeckConditions>, String> {
        let path = &settings.guide.deck;
        if path.is_empty() {
            return Ok(None);
        }
        let wrong = |e: FeError| format!("{path}: {e}");
        let file = parse_fe(self.file(path)?, Some(path)).map_err(wrong)?;
        config::deck(settings, &file).map(Some).map_err(wrong)
    }

    fn stress(&self, settings: &Settings) -> Result<Option<StressField>, String> {
        let path = &settings.guide.import;
        if path.is_empty() {
            return Ok(None);
        }
        let wrong = |e: FeError| format!("{path}: {e}");
        let file = parse_fe(self.file(path)?, Some(path)).map_err(wrong)?;
        Ok(Some(StressField::new(file.result(&config::import(settings)).map_err(wrong)?)))
    }
}

/// A name without a leading `./`.
fn plain(name: &str) -> &str {
    name.trim_start_matches("./")
}

fn write(
    settings: &Settings,
    planned: &Planned,
    read_s: f64,
    diagnostics: &Diagnostics,
) -> Result<Answer, String> {
    let from_s = diagnostics.now_s();
    diagnostics.begin(Stage::Write, planned.plan.layers.len());
    let (mut gcode, mut written) = program(planned, &[])?;
    let mut program_read = read_back(settings, &gcode)?;
    if !settings.printer.thumbnails_px.is_empty() {
        // Thumbnails show the beads of the program but stand at its top, so it is first written without them.
        let drawn = grainpath_view::layer::thumbnails(&program_read, &settings.printer.thumbnails_px);
        (gcode, written) = program(planned, &drawn)?;
        program_read = read_back(settings, &gcode)?;
    }
    let mut report = Report::new(planned, &written);
    report.stages_s.extend(planned.stages_s.iter().map(|(stage, s)| (stage.name(), *s)));
    report.stages_s.insert(Stage::Read.name(), read_s);
    report.quality = Some(measure(planned, &program_read));
    report.fibre = measure_fibre(settings.fibre.min_radius_mm, planned, &program_read);
    report.stages_s.insert(Stage::Write.name(), diagnostics.now_s() - from_s);
    report.warnings = diagnostics.warnings();
    let mut summary = report.summary();
    if planned.test.is_some() {
        summary.push_str("\nthe virtual strength test is not run in a page: `grainpath run` does it");
    }
    let report = serde_json::json!({ "summary": summary, "report": report.to_json() });
    Ok(Answer { gcode, report: report.to_string() })
}

fn program(planned: &Planned, drawn: &[grainpath_gcode::Thumbnail]) -> Result<(Vec<u8>, Written), String> {
    let mut gcode = Vec::new();
    let written = write_gcode(&planned.plan, &planned.config, drawn, &mut gcode);
    written.map(|written| (gcode, written)).map_err(|e| Error::from(e).to_string())
}

fn read_back(settings: &Settings, gcode: &[u8]) -> Result<Program, String> {
    simulate(gcode, settings.printer.filament_mm, &config::limits(settings)).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plate() -> (Inputs, String) {
        let mut inputs = Inputs::new();
        let mut job = String::new();
        for (name, bytes) in grainpath_parts::presets::preset("plate").expect("a preset") {
            match String::from_utf8(bytes) {
                Ok(text) if name == "job.toml" => job = text,
                Ok(text) => inputs.add_file(name.into_owned(), text.into_bytes()),
                Err(e) => inputs.add_file(name.into_owned(), e.into_bytes()),
            }
        }
        (inputs, job)
    }

    #[test]
    fn a_job_with_its_file_gives_a_program_and_a_report() {
        let (mut inputs, job) = plate();
        inputs.add_setting("process.layer_height_mm=0.4".to_owned());
        let answer = inputs.plan(&job, &Diagnostics::default()).expect("planned");
        assert!(answer.gcode.starts_with(b";"), "{:?}", &answer.gcode[..40]);
        let report: serde_json::Value = serde_json::from_str(&answer.report).expect("JSON");
        // 12 mm in a first layer of 0.2 mm and 29 of 0.4 mm; the middle of another one would lie on the top.
        assert_eq!(report["report"]["z_max_mm"].as_f64(), Some(11.8), "{report}");
        assert!(report["summary"].as_str().is_some_and(|s| s.contains("30 layers to 11.8 mm")), "{report}");
    }

    #[test]
    fn errors_name_the_file_and_what_would_be_right() {
        let (inputs, job) = plate();
        let told = |inputs: &Inputs, job: &str| {
            inputs.plan(job, &Diagnostics::default()).expect_err("refused").to_string()
        };
        let empty = Inputs::new();
        assert_eq!(told(&empty, &job), "plate.stl: no such file was given; no files were given at all");
        let renamed = job.replace("plate.stl", "plat.stl");
        assert_eq!(told(&inputs, &renamed), "plat.stl: no such file was given; there are plate.stl");
        assert!(told(&inputs, "[shape]\nct = \"a.tif\"\n").contains("`grainpath run` takes this job"));
        assert!(told(&inputs, "").contains("[shape] needs mesh"));
        assert!(told(&inputs, "[shape]\nmehs = 1\n").contains("mesh"));
        let mut broken = Inputs::new();
        broken.add_file("./plate.stl".to_owned(), b"solid nothing".to_vec());
        assert!(told(&broken, &job).starts_with("plate.stl: "));
    }
}
