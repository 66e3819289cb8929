//! What density and direction by the stress save: the mass of plates that carry the same peak load of the virtual test.
//!
//! The load asked for is what the part carries with stripes along the stress at a density of 0.3. Every other plan is
//! made lighter and heavier by bisection until its peak lies around that load; the mass at exactly that load lies on the
//! line between the two plans on either side of it. Even fills are found by their density, graded ones by `fill.mass_g`, which scales a
//! density that follows the stress. One run of each test, nominal card: the interval of the card is left out, for it
//! moves all plans of a part alike. Cost: about 4 minutes a part on two cores.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

/// A part of the gallery with its fixtures and loads.
struct Part {
    name: &'static str,
    conditions: &'static str,
}

const PARTS: [Part; 3] = [
    Part {
        name: "bracket",
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
];

/// What all plates share: two walls, two skins on either side, cells of a bead.
const COMMON: &str = "thickness_mm = 8
[printer]
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
corners = false
check = false
[guide]
kind = \"stress\"
";

/// Plans of one density everywhere: what they are called, and their pattern.
const EVEN: [(&str, &str); 4] = [
    ("grid, even", "grid"),
    ("gyroid, even", "gyroid"),
    ("rectilinear, even", "rectilinear"),
    ("stripes along the stress, even", "stripes"),
];
/// Plans whose density follows the stress.
const GRADED: [(&str, &str); 2] =
    [("grid, graded by the stress", "grid"), ("stripes along the stress, graded", "stripes")];
/// The fills without direction and without grading, which come first in [`EVEN`].
const PLAIN: usize = 3;
/// Steps of the bisection. Source: derived; 4 halvings and a line between the last two plans leave less than 1 % of the
/// mass, while loads of the test scatter by 2 % when a part is turned.
const STEPS: usize = 4;
/// Density of the stripes along the stress whose peak load all plans are to carry. Source: chosen so that plans of every
/// pattern carry less at the least density and more at the greatest. What a grid of 0.4 carries, stripes carry on the
/// bracket at the least density.
const ASKED_DENSITY: f64 = 0.3;
/// Least and greatest density of a plan.
const DENSITIES: [f64; 2] = [0.1, 1.0];
/// How far the masses that are looked at stay from those at the least and the greatest density, as a share: a graded
/// plan of such a mass would have no room to be graded.
const MARGIN: f64 = 0.02;

/// A plan that was tested.
#[derive(Clone, Copy)]
struct Tested {
    mass_g: f64,
    peak_n: f64,
    plan_s: f64,
}

/// What was found for a kind of plan.
enum Found {
    /// Mass at the load asked for, and the seconds that planning the heavier neighbour took.
    At { mass_g: f64, plan_s: f64 },
    /// The lightest plan carries more than asked.
    Lightest(Tested),
    /// The heaviest plan carries less than asked.
    TooWeak(Tested),
}

/// The named parts, or all.
pub fn run(binary: &Path, wanted: &[&str]) -> Result<(), String> {
    if let Some(unknown) = wanted.iter().find(|w| PARTS.iter().all(|p| p.name != **w)) {
        return Err(format!("bench density knows bracket, hook and lever, not {unknown}"));
    }
    let folder = crate::target().join("bench/density");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    println!(
        "\nPlates of 8 mm, layers of 0.3 mm, 2 walls, 2 skins, PLA, nominal card, cells of 0.45 mm, one run each."
    );
    println!(
        "Mass at the peak load of even stripes at a density of {ASKED_DENSITY}; planning time over that of those stripes.\n"
    );
    println!("| part, load asked | plan | mass g | lighter than the best plain even fill | planning time |");
    println!("|---|---|---|---|---|");
    PARTS
        .iter()
        .filter(|p| wanted.is_empty() || wanted.contains(&p.name))
        .try_for_each(|p| p.rows(binary, &folder))
}

impl Part {
    /// The rows of one part.
    fn rows(&self, binary: &Path, folder: &Path) -> Result<(), String> {
        let drawing = crate::root().join("docs/gallery").join(self.name).with_extension("svg");
        let job = folder.join(self.name).with_extension("toml");
        let text = format!(
            "[shape]\noutline = {:?}\n{COMMON}{}[output]\ngcode = \"{}.gcode\"\n",
            drawing.display().to_string(),
            self.conditions,
            self.name
        );
        fs::write(&job, text).map_err(|e| format!("{}: {e}", job.display()))?;
        let test = |pattern: &str, sets: &[String]| -> Result<Tested, String> {
            let mut command = Command::new(binary);
            command.args(["strength", "--json", "--set", &format!("fill.pattern=\"{pattern}\"")]);
            sets.iter().for_each(|set| {
                command.args(["--set", set]);
            });
            let start = Instant::now();
            let text = crate::output(command.arg(&job))?;
            let all_s = start.elapsed().as_secs_f64();
            let found: Value = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", self.name))?;
            let number =
                |key: &str| found["strength"][key].as_f64().ok_or_else(|| format!("{}: no {key}", self.name));
            let plan_s = all_s - number("seconds")?;
            Ok(Tested { mass_g: number("mass_g")?, peak_n: number("peak_load_n")?, plan_s })
        };
        let even = |pattern: &str, density: f64| test(pattern, &[format!("fill.density={density}")]);
        let graded = |pattern: &str, mass_g: f64| {
            let [min, max] = DENSITIES;
            let density = format!("fill.density={{ min = {min}, max = {max}, by = \"stress\" }}");
            test(pattern, &[density, format!("fill.mass_g={mass_g}")])
        };
        let mark = even("stripes", ASKED_DENSITY)?;
        let evens = EVEN
            .iter()
            .map(|(what, pattern)| {
                Ok((*what, *pattern, at_peak(mark.peak_n, DENSITIES, &|density| even(pattern, density))?))
            })
            .collect::<Result<Vec<_>, String>>()?;
        let plain = evens[..PLAIN].iter().filter_map(|(_, _, (found, _))| match found {
            Found::At { mass_g, .. } => Some(*mass_g),
            Found::Lightest(_) | Found::TooWeak(_) => None,
        });
        let best_g = plain.fold(f64::INFINITY, f64::min);
        for (what, _, (found, _)) in &evens {
            self.print(what, &mark, found, best_g);
        }
        for (what, pattern) in GRADED {
            let ends = evens.iter().find(|(_, even, _)| *even == pattern).map(|(_, _, (_, ends))| *ends);
            let [light_g, heavy_g] = ends.ok_or_else(|| format!("{pattern} is not among the even plans"))?;
            let margin_g = MARGIN * (heavy_g - light_g);
            let range = [light_g + margin_g, heavy_g - margin_g];
            let (found, _) = at_peak(mark.peak_n, range, &|mass_g| graded(pattern, mass_g))?;
            self.print(what, &mark, &found, best_g);
        }
        Ok(())
    }

    fn print(&self, what: &str, mark: &Tested, found: &Found, best_g: f64) {
        let part = format!("{}, {:.0} N", self.name, mark.peak_n);
        // No plain even fill may carry the load; then there is nothing to be lighter than.
        let lighter = |mass_g: f64| match best_g.is_finite() {
            true => format!("{:.1} %", 100.0 * (1.0 - mass_g / best_g)),
            false => "-".to_owned(),
        };
        match found {
            Found::At { mass_g, plan_s } => println!(
                "| {part} | {what} | {mass_g:.2} | {} | {:.2} |",
                lighter(*mass_g),
                plan_s / mark.plan_s
            ),
            Found::Lightest(t) => println!(
                "| {part} | {what} | below {:.2}, which carries {:.0} N | more than {} | {:.2} |",
                t.mass_g,
                t.peak_n,
                lighter(t.mass_g),
                t.plan_s / mark.plan_s
            ),
            Found::TooWeak(t) => {
                println!(
                    "| {part} | {what} | above {:.2}, which carries {:.0} N | - | - |",
                    t.mass_g, t.peak_n
                );
            }
        }
    }
}

/// The mass at a peak load, by bisection over what `test` takes and a line between the two plans around the load; and the
/// masses at both ends, g.
fn at_peak(
    asked_n: f64,
    [mut low, mut high]: [f64; 2],
    test: &dyn Fn(f64) -> Result<Tested, String>,
) -> Result<(Found, [f64; 2]), String> {
    let (mut below, mut above) = (test(low)?, test(high)?);
    let ends = [below.mass_g, above.mass_g];
    // The peak is taken to rise with the mass from one end to the other; where it does not, the plans that are found still
    // lie on either side of the load.
    if below.peak_n >= asked_n {
        return Ok((Found::Lightest(below), ends));
    }
    if above.peak_n < asked_n {
        return Ok((Found::TooWeak(above), ends));
    }
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        let tested = test(middle)?;
        if tested.peak_n >= asked_n {
            (high, above) = (middle, tested);
        } else {
            (low, below) = (middle, tested);
        }
    }
    let share = (asked_n - below.peak_n) / (above.peak_n - below.peak_n);
    let mass_g = below.mass_g + share * (above.mass_g - below.mass_g);
    Ok((Found::At { mass_g, plan_s: above.plan_s }, ends))
}
