//! What density and direction by the stress save: the mass of parts that carry the same peak load of the virtual test.
//!
//! The load asked for is what the part carries with stripes along the stress at a density of 0.3. Every other plan is
//! made lighter and heavier by false position between the least and the greatest density, until its peak lies within
//! [`NEAR`] of that load; the mass at exactly that load lies between the two plans on either side of it, on a power law.
//! Even fills are found by their density, graded ones by `fill.mass_g`, which scales a density that follows the stress.
//! The baseline of others is a density in four steps of von Mises stress without direction.
//!
//! Intervals are those of the corners of the material's card: at each corner a plan is held against the same corner of
//! the plan with the asked load. Cost: 5 to 10 minutes a part on two cores.

#![allow(clippy::disallowed_methods, reason = "masses and loads of a bench, told with three digits")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::bench::timed_output;
use crate::measured::Table;

mod steps;

/// Where the shape of a part comes from.
enum Shape {
    /// An outline of the gallery, 8 mm thick.
    Gallery(&'static str),
    /// An outline of our own, 8 mm thick.
    Drawn(&'static str),
    /// A mesh of the data folder.
    Mesh(&'static str),
}

/// A part with its fixtures and loads.
struct Part {
    name: &'static str,
    shape: Shape,
    conditions: &'static str,
}

const PARTS: [Part; 5] = [
    Part {
        name: "bracket",
        shape: Shape::Gallery("bracket.svg"),
        conditions: "[[guide.fixture]]
on = { cylinder = { point_mm = [7, 61, 4], axis = [0, 0, 1], radius_mm = 3.05, length_mm = 10 } }
fix = \"xyz\"
[[guide.fixture]]
on = { cylinder = { point_mm = [7, 9, 4], axis = [0, 0, 1], radius_mm = 3.05, length_mm = 10 } }
fix = \"xyz\"
[[guide.load]]
on = { cylinder = { point_mm = [70, 61, 4], axis = [0, 0, 1], radius_mm = 4.05, length_mm = 10 } }
force_n = [0, -300, 0]
",
    },
    Part {
        name: "hook",
        shape: Shape::Gallery("hook.svg"),
        conditions: "[[guide.fixture]]
on = { cylinder = { point_mm = [30, 70, 4], axis = [0, 0, 1], radius_mm = 4.05, length_mm = 10 } }
fix = \"xyz\"
[[guide.load]]
on = { box_mm = [[12, 18, 0], [28, 22, 8]] }
force_n = [0, -200, 0]
",
    },
    Part {
        name: "lever",
        shape: Shape::Gallery("lever.svg"),
        conditions: "[[guide.fixture]]
on = { cylinder = { point_mm = [40, 15, 4], axis = [0, 0, 1], radius_mm = 5.05, length_mm = 10 } }
fix = \"xyz\"
[[guide.fixture]]
on = { cylinder = { point_mm = [12, 15, 4], axis = [0, 0, 1], radius_mm = 4.05, length_mm = 10 } }
fix = \"y\"
[[guide.load]]
on = { cylinder = { point_mm = [93, 15, 4], axis = [0, 0, 1], radius_mm = 2.55, length_mm = 10 } }
force_n = [0, -80, 0]
",
    },
    // Pulled aslant by two pins.
    Part {
        name: "two-holes",
        shape: Shape::Drawn(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"90mm\" height=\"40mm\" viewBox=\"0 0 90 40\">\
             <path fill-rule=\"evenodd\" d=\"M0 0 H90 V40 H0 Z M20 12 A5 5 0 1 0 10 12 A5 5 0 1 0 20 12 Z \
             M80 28 A5 5 0 1 0 70 28 A5 5 0 1 0 80 28 Z\"/></svg>\n",
        ),
        conditions: "[[guide.fixture]]
on = { cylinder = { point_mm = [15, 28, 4], axis = [0, 0, 1], radius_mm = 5.05, length_mm = 10 } }
fix = \"xyz\"
[[guide.load]]
on = { cylinder = { point_mm = [75, 12, 4], axis = [0, 0, 1], radius_mm = 5.05, length_mm = 10 } }
force_n = [400, -107, 0]
",
    },
    // Screwed down by its three holes and pulled by its pin.
    Part {
        name: "hinge",
        shape: Shape::Mesh("hinge_ascii.stl"),
        conditions: "[[guide.fixture]]
on = { cylinder = { point_mm = [7.82, 17.06, 1], axis = [0, 0, 1], radius_mm = 2.6, length_mm = 10 } }
fix = \"xyz\"
[[guide.fixture]]
on = { cylinder = { point_mm = [41.82, 17.06, 1], axis = [0, 0, 1], radius_mm = 2.6, length_mm = 10 } }
fix = \"xyz\"
[[guide.fixture]]
on = { cylinder = { point_mm = [24.82, 13.06, 1], axis = [0, 0, 1], radius_mm = 2.6, length_mm = 10 } }
fix = \"xyz\"
[[guide.load]]
on = { box_mm = [[-1, -6, -1], [51, 0, 11]] }
force_n = [200, -400, 0]
",
    },
];

/// What all parts share: two walls, two skins on either side, cells of a bead.
const COMMON: &str = "[printer]
profile = \"generic-0.4\"
[material]
profile = \"pla\"
[process]
profile = \"standard\"
layer_height_mm = 0.3
walls = 2
top_layers = 2
bottom_layers = 2
skirt_loops = 0
[strength]
cell_mm = 0.45
fidelity = \"plane\"
check = false
[guide]
kind = \"stress\"
";

/// Patterns of fills without direction and of one density everywhere.
const PLAIN: [&str; 3] = ["grid", "gyroid", "rectilinear"];
/// Patterns of the baseline: four steps of density.
const STEPPED: [&str; 2] = ["grid", "gyroid"];
/// Patterns whose density follows the stress: without direction, and with it.
const GRADED: [&str; 2] = ["grid", "stripes"];
/// The greatest share by which the load of the last plan may lie off the asked load. Source: derived; the mass between two
/// plans is then off by a share of this alone, while loads of the test scatter by 2 % when a part is turned.
const NEAR: f64 = 0.02;
/// Most plans between the lightest and the heaviest. Source: chosen; four halvings would leave a sixteenth of the range.
const TRIES: usize = 4;
/// Density of the stripes along the stress whose peak load all plans are to carry. Source: chosen so that plans of every
/// pattern carry less at the least density and more at the greatest. What a grid of 0.4 carries, stripes carry on the
/// bracket at the least density.
const ASKED_DENSITY: f64 = 0.3;
/// Least and greatest density of a plan.
const DENSITIES: [f64; 2] = [0.1, 1.0];

/// A plan: its pattern and the settings beside it.
#[derive(Clone)]
struct Wanted {
    pattern: &'static str,
    sets: Vec<String>,
}

impl Wanted {
    fn even(pattern: &'static str, density: f64) -> Self {
        Self { pattern, sets: vec![format!("fill.density={density}")] }
    }

    fn graded(pattern: &'static str, by: &str, mass_g: f64) -> Self {
        let [min, max] = DENSITIES;
        let density = format!("fill.density={{ min = {min}, max = {max}, {by} }}");
        Self { pattern, sets: vec![density, format!("fill.mass_g={mass_g}")] }
    }
}

/// A plan that was tested; `at` is the density or the mass by which it was found.
#[derive(Clone)]
struct Tested {
    wanted: Wanted,
    at: f64,
    mass_g: f64,
    peak_n: f64,
}

/// The mass at the load asked for: nominal, and at each corner of the card.
struct Found {
    what: String,
    /// `at` where the mass was found; `below` where the lightest plan carries more, `above` where the heaviest carries less.
    is: &'static str,
    mass_g: f64,
    corners_g: Vec<f64>,
    nearest: Wanted,
}

/// The load asked for: nominal, and at each corner of the card.
struct Asked {
    nominal_n: f64,
    corners: Vec<(String, f64)>,
}

/// The named parts, or all.
pub fn run(wanted: &[&str]) -> Result<(), String> {
    if let Some(unknown) = wanted.iter().find(|w| PARTS.iter().all(|p| p.name != **w)) {
        let names = PARTS.map(|p| p.name).join(", ");
        return Err(format!("bench density knows {names}, not {unknown}"));
    }
    crate::cargo(&["build", "--profile", "ci", "-p", "grainpath-cli"])?;
    let folder = crate::target().join("bench/density");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    println!(
        "\nLayers of 0.3 mm, 2 walls, 2 skins, PLA, cells of 0.45 mm. Mass at the peak load of even stripes at a density of \
         {ASKED_DENSITY}; in low and high that of the corners of the card."
    );
    let header = ["part", "plan", "load N", "is", "mass g", "low g", "high g"];
    let masses = Table::new("density", &header, 2);
    let mut all = Vec::new();
    for part in PARTS.iter().filter(|p| wanted.is_empty() || wanted.contains(&p.name)) {
        let bench = Bench::new(part, &folder)?;
        let (asked, found) = bench.masses()?;
        for f in &found {
            let [low, high] = range(&f.corners_g).map(|g| format!("{g:.2}"));
            masses.row(&[
                part.name.to_owned(),
                f.what.clone(),
                format!("{:.0}", asked.nominal_n),
                f.is.to_owned(),
                format!("{:.2}", f.mass_g),
                low,
                high,
            ]);
        }
        all.push((bench, found));
    }
    println!(
        "\nStripes along the stress, graded: how much lighter than others, %; low and high over the corners."
    );
    let header = ["part", "than", "lighter %", "low %", "high %"];
    let lighter = Table::new("density-lighter", &header, 2);
    for (bench, found) in &all {
        bench.lighter(found, &lighter);
    }
    println!(
        "\nProcessor time of planning, graded over even, by densities and by mass; least of three runs each."
    );
    let times = Table::new("density-time", &["part", "plan", "even s", "graded s", "ratio"], 2);
    all.iter().try_for_each(|(bench, found)| bench.times(found, &times))
}

/// The least and the greatest of numbers.
fn range(all: &[f64]) -> [f64; 2] {
    all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &v| [low.min(v), high.max(v)])
}

/// A part with the program that plans it.
struct Bench<'a> {
    part: &'a Part,
    program: PathBuf,
    folder: PathBuf,
    job: PathBuf,
}

impl<'a> Bench<'a> {
    /// Writes the job of a part.
    fn new(part: &'a Part, folder: &Path) -> Result<Self, String> {
        let flat = |path: &Path| format!("outline = {:?}\nthickness_mm = 8", path.display().to_string());
        let shape = match part.shape {
            Shape::Gallery(file) => flat(&crate::root().join("docs/gallery").join(file)),
            Shape::Drawn(svg) => {
                let path = folder.join(part.name).with_extension("svg");
                fs::write(&path, svg).map_err(|e| format!("{}: {e}", path.display()))?;
                flat(&path)
            }
            Shape::Mesh(file) => {
                let path = crate::setup::data()?.join("meshes").join(file);
                format!("mesh = {:?}", path.display().to_string())
            }
        };
        let job = folder.join(part.name).with_extension("toml");
        let text = format!(
            "[shape]\n{shape}\n{COMMON}{}[output]\ngcode = \"{}.gcode\"\n",
            part.conditions, part.name
        );
        fs::write(&job, text).map_err(|e| format!("{}: {e}", job.display()))?;
        Ok(Self { part, program: crate::ci_program(), folder: folder.to_owned(), job })
    }

    fn command(&self, verb: &str, wanted: &Wanted, more: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command.args([verb, "--json", "--set", &format!("fill.pattern=\"{}\"", wanted.pattern)]);
        let sets = wanted.sets.iter().map(String::as_str).chain(more.iter().copied());
        sets.for_each(|set| {
            command.args(["--set", set]);
        });
        command.arg(&self.job);
        command
    }

    /// The report of the break test of a plan.
    fn report(&self, wanted: &Wanted, corners: bool) -> Result<Value, String> {
        let corners = format!("strength.corners={corners}");
        let text = crate::output(&mut self.command("strength", wanted, &[&corners]))?;
        let found: Value = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", self.part.name))?;
        Ok(found["strength"].clone())
    }

    fn test(&self, wanted: Wanted, at: f64) -> Result<Tested, String> {
        let found = self.report(&wanted, false)?;
        let number = |key: &str| found[key].as_f64().ok_or_else(|| format!("{}: no {key}", self.part.name));
        Ok(Tested { wanted, at, mass_g: number("mass_g")?, peak_n: number("peak_load_n")? })
    }

    /// Loads at the corners of the card, by name.
    fn corners(&self, wanted: &Wanted) -> Result<Vec<(String, f64)>, String> {
        let found = self.report(wanted, true)?;
        let corners = found["corners"].as_object().ok_or("a test without corners")?;
        Ok(corners.iter().map(|(name, n)| (name.clone(), n.as_f64().unwrap_or(f64::NAN))).collect())
    }

    /// Masses of all plans at the load asked for.
    fn masses(&self) -> Result<(Asked, Vec<Found>), String> {
        let mark = self.test(Wanted::even("stripes", ASKED_DENSITY), ASKED_DENSITY)?;
        let asked = Asked { nominal_n: mark.peak_n, corners: self.corners(&mark.wanted)? };
        let mut found = Vec::new();
        let mut ends_of = Vec::new();
        let ends = |pattern: &'static str| -> Result<[Tested; 2], String> {
            let [least, most] = DENSITIES.map(|d| self.test(Wanted::even(pattern, d), d));
            Ok([least?, most?])
        };
        for pattern in PLAIN {
            let ends = ends(pattern)?;
            ends_of.push((pattern, ends.clone()));
            let test = |density: f64| self.test(Wanted::even(pattern, density), density);
            found.push(self.at_peak(format!("{pattern}, even"), &asked, ends, &test)?);
        }
        ends_of.push(("stripes", ends("stripes")?));
        found.push(Found {
            what: "stripes, even".into(),
            is: "at",
            mass_g: mark.mass_g,
            corners_g: vec![mark.mass_g],
            nearest: mark.wanted.clone(),
        });
        let steps = self.folder.join(format!("{}-steps.csv", self.part.name));
        self.write_steps(&mark.wanted, &steps)?;
        let stepped = format!("by = \"file\", file = {:?}", steps.display().to_string());
        let graded = STEPPED.map(|p| (p, "four steps of von Mises", stepped.as_str()));
        let by_stress = GRADED.map(|p| (p, "graded by the stress", "by = \"stress\""));
        for (pattern, how, by) in graded.into_iter().chain(by_stress) {
            // The lightest and the heaviest graded plan have one density everywhere.
            let ends = ends_of.iter().find(|(even, _)| *even == pattern).map(|(_, ends)| ends.clone());
            let mut ends = ends.ok_or_else(|| format!("{pattern} is not among the even plans"))?;
            ends.iter_mut().for_each(|end| end.at = end.mass_g);
            let test = |mass_g: f64| self.test(Wanted::graded(pattern, by, mass_g), mass_g);
            found.push(self.at_peak(format!("{pattern}, {how}"), &asked, ends, &test)?);
        }
        Ok((asked, found))
    }

    /// The mass at a peak load, between two plans on either side of it.
    fn at_peak(
        &self,
        what: String,
        asked: &Asked,
        [mut below, mut above]: [Tested; 2],
        test: &dyn Fn(f64) -> Result<Tested, String>,
    ) -> Result<Found, String> {
        // Loads grow about as a power of the mass.
        let power = (above.peak_n / below.peak_n).ln() / (above.mass_g / below.mass_g).ln();
        let is = match () {
            () if below.peak_n >= asked.nominal_n => "below",
            () if above.peak_n < asked.nominal_n => "above",
            () => "at",
        };
        if is != "at" {
            let end = if is == "below" { below } else { above };
            return Ok(Found {
                what,
                is,
                mass_g: end.mass_g,
                corners_g: vec![end.mass_g],
                nearest: end.wanted,
            });
        }
        let share = |a: &Tested, b: &Tested| (asked.nominal_n / a.peak_n).ln() / (b.peak_n / a.peak_n).ln();
        let between = |a: f64, b: f64, share: f64| a * (b / a).powf(share);
        for k in 0..TRIES {
            let near = [&below, &above].map(|t| (t.peak_n / asked.nominal_n - 1.0).abs());
            if near[0].min(near[1]) < NEAR {
                break;
            }
            // The third try halves the range: one end of false position alone may stay for long.
            let share = if k == 2 { 0.5 } else { share(&below, &above).clamp(0.05, 0.95) };
            let tested = test(between(below.at, above.at, share))?;
            if tested.peak_n >= asked.nominal_n { above = tested } else { below = tested }
        }
        let mass_g = between(below.mass_g, above.mass_g, share(&below, &above));
        let off = |t: &Tested| (t.peak_n / asked.nominal_n).ln().abs();
        let nearest = if off(&below) < off(&above) { below } else { above };
        let corners = self.corners(&nearest.wanted)?;
        let at_corner = |(name, n): &(String, f64)| {
            let own = asked.corners.iter().find(|(corner, _)| corner == name).map_or(f64::NAN, |(_, n)| *n);
            // How much more this plan carries for its nominal load at this corner than the asked one for its own.
            let gained = (n / nearest.peak_n) / (own / asked.nominal_n);
            mass_g * gained.powf(-1.0 / power)
        };
        let corners_g = corners.iter().map(at_corner).collect();
        Ok(Found { what, is, mass_g, corners_g, nearest: nearest.wanted })
    }

    /// Writes densities in four steps of the von Mises stress, for `fill.density` by file.
    fn write_steps(&self, wanted: &Wanted, out: &Path) -> Result<(), String> {
        let vtu = self.folder.join(format!("{}.vtu", self.part.name));
        let set = format!("output.stress={:?}", vtu.display().to_string());
        crate::output(&mut self.command("run", wanted, &[&set]))?;
        let bytes = fs::read(&vtu).map_err(|e| format!("{}: {e}", vtu.display()))?;
        let text = steps::csv(&bytes).map_err(|e| format!("{}: {e}", vtu.display()))?;
        fs::write(out, text).map_err(|e| format!("{}: {e}", out.display()))
    }

    /// How much lighter direction and density together are than each way alone.
    fn lighter(&self, found: &[Found], table: &Table) {
        let Some((both, others)) = found.split_last() else { return };
        let best = |what: &dyn Fn(&str) -> bool| {
            let all = others.iter().filter(|f| what(&f.what) && f.is != "above");
            all.min_by(|a, b| a.mass_g.total_cmp(&b.mass_g))
        };
        let plain = |what: &str| what.ends_with(", even") && !what.starts_with("stripes");
        for (than, other) in [
            ("best even fill", best(&plain)),
            ("four steps of von Mises", best(&|what| what.ends_with("von Mises"))),
            ("direction alone", best(&|what| what == "stripes, even")),
            ("density alone", best(&|what| what == "grid, graded by the stress")),
        ] {
            let Some(other) = other else { continue };
            // The first corner is the same for all; a plan that is the mark has one mass at every corner.
            let at = |all: &[f64], k: usize| all.get(k).or(all.first()).copied().unwrap_or(f64::NAN);
            let n = both.corners_g.len().max(other.corners_g.len());
            let saved = |a: f64, b: f64| 100.0 * (1.0 - a / b);
            let corners: Vec<f64> =
                (0..n).map(|k| saved(at(&both.corners_g, k), at(&other.corners_g, k))).collect();
            let [low, high] = range(&corners).map(|v| format!("{v:.1}"));
            let nominal = format!("{:.1}", saved(both.mass_g, other.mass_g));
            table.row(&[self.part.name.to_owned(), than.to_owned(), nominal, low, high]);
        }
    }

    /// Processor time of planning a graded plan and an even one of the same pattern.
    fn times(&self, found: &[Found], table: &Table) -> Result<(), String> {
        let seconds = |wanted: &Wanted| -> Result<f64, String> {
            let mut least = f64::INFINITY;
            for _ in 0..3 {
                let (cost, _) = timed_output(&mut self.command("run", wanted, &[]), &self.folder)?;
                least = least.min(cost.cpu_s);
            }
            Ok(least)
        };
        for pattern in GRADED {
            let of = |how: &str| found.iter().find(|f| f.what == format!("{pattern}, {how}"));
            let (Some(even), Some(graded)) = (of("even"), of("graded by the stress")) else { continue };
            let of = |found: &Found, sets: Vec<String>| Wanted { sets, ..found.nearest.clone() };
            // Graded plans name their range first and their mass after it.
            let range = graded.nearest.sets[..1].to_vec();
            let to_mass = |found: &Found| format!("fill.mass_g={:.3}", found.mass_g);
            let graded_to_mass = vec![range[0].clone(), to_mass(graded)];
            for (way, even, graded) in [
                ("density given", even.nearest.clone(), of(graded, range)),
                ("mass to find", of(even, vec![to_mass(even)]), of(graded, graded_to_mass)),
            ] {
                let (even_s, graded_s) = (seconds(&even)?, seconds(&graded)?);
                table.row(&[
                    self.part.name.to_owned(),
                    format!("{pattern}, {way}"),
                    format!("{even_s:.2}"),
                    format!("{graded_s:.2}"),
                    format!("{:.2}", graded_s / even_s),
                ]);
            }
        }
        Ok(())
    }
}
