//! The gallery: parts of our own as pictures, each with the job that made it.
//!
//! [`run`] plans every part of [`PARTS`] with the built program, checks the picture of the part for pinholes, copies the
//! job of a preset to where the page links to it, and lays part, stress, a layer and damage side by side. A browser sets
//! the sheet, so that captions have real type; where there is none, that is said. With the word `check` nothing is
//! drawn or written: pictures of parts, jobs and page are held against what is committed. Inputs are drawings and
//! presets of ours, under the licences of grainpath.
//!
//! A pinhole is a hole of the picture that the part does not have: a spot of ground of few pixels inside the part, which
//! is gone when the same part is drawn four times larger. Between thin branches the ground is seen at any size.
//!
//! Limits: no sheet without Chromium and npm; a part takes from a second to a minute.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A part of the gallery.
struct Part {
    name: &'static str,
    /// What it shows.
    about: &'static str,
    /// The preset that `grainpath new` writes it from; empty for a job in `docs/gallery`.
    preset: &'static str,
    /// The job file.
    job: &'static str,
    /// Whether the part of a preset is drawn until it breaks too.
    breaks: bool,
    /// Which panel of the sheet, from 0, stands for the part on the sheet of all parts.
    hero: usize,
}

impl Part {
    /// The job that the page links to, in the folder of the gallery.
    fn committed_job(&self) -> String {
        if self.preset.is_empty() { self.job.to_owned() } else { format!("jobs/{}.toml", self.name) }
    }
}

const fn own(name: &'static str, job: &'static str, about: &'static str) -> Part {
    Part { name, about, preset: "", job, breaks: false, hero: 2 }
}

const fn of_preset(name: &'static str, preset: &'static str, job: &'static str, about: &'static str) -> Part {
    Part { name, about, preset, job, breaks: false, hero: 1 }
}

/// A part of a preset with loads: its stress, and where it breaks.
const fn loaded(
    name: &'static str,
    preset: &'static str,
    job: &'static str,
    about: &'static str,
    hero: usize,
) -> Part {
    Part { name, about, preset, job, breaks: true, hero }
}

/// A part of a preset that is best shown as a whole.
const fn whole(name: &'static str, preset: &'static str, job: &'static str, about: &'static str) -> Part {
    Part { name, about, preset, job, breaks: false, hero: 0 }
}

/// All parts, in the order of the page.
const PARTS: [Part; 24] = [
    own("bracket", "bracket.toml", "a flat bracket: beads from the bolts to the load"),
    own("hook", "hook.toml", "a hook: beads follow the curve that carries"),
    own("lever", "lever.toml", "a lever on a pivot"),
    own("link", "link.toml", "a link with two eyes in tension"),
    own("clamp", "clamp.toml", "the frame of a clamp, spread open"),
    own("gusset", "gusset.toml", "a gusset in shear"),
    own("ring", "ring.toml", "a ring squeezed between two plates"),
    own("weave", "weave.toml", "both families of stress lines, layer by layer: a weave"),
    loaded("tension", "stress-lines", "tension.toml", "a tensile bar with a hole", 1),
    loaded("bending", "stress-lines", "bending.toml", "a bar in three-point bending", 1),
    loaded("shelf", "stress-lines", "bracket.toml", "a shelf bracket, solved in three dimensions", 0),
    whole("plate", "plate", "job.toml", "a mounting plate with a rib too thin for two walls"),
    of_preset("flow", "field", "job.toml", "directions from a table, around a hole"),
    of_preset("knot", "woodgrain", "job.toml", "a board from its photograph, the grain around a knot"),
    of_preset("board", "woodgrain", "dense.toml", "the same board, its beads touching"),
    of_preset("board-grid", "woodgrain", "grid.toml", "the same mass as a grid"),
    of_preset("board-triangles", "woodgrain", "triangles.toml", "the same mass as triangles"),
    of_preset("board-straight", "woodgrain", "rectilinear.toml", "the same mass as straight lines"),
    loaded("open-hole", "continuous", "plate.toml", "a fibre plate with an open hole, one path a layer", 2),
    loaded("fibre-hook", "continuous", "hook.toml", "a hook in continuous fibre", 2),
    loaded("fibre-stripes", "continuous", "plate-stripes.toml", "the plate in stripes of fibre", 2),
    whole("ball", "tree-support", "ball.toml", "a hanging ball on trees"),
    whole("tray", "tree-support", "tray.toml", "a dental tray on trees"),
    whole("hub", "ct", "job.toml", "a wheel hub from its scan, without a mesh"),
];

/// The colour behind parts. Source: `PAPER` of the renderer, `crates/grainpath-view/src/layer/thumbnail.rs`.
const GROUND: [u8; 3] = [246, 244, 240];

/// Spots of ground inside a part that are smaller may be pinholes; holes of parts are larger. Measured: the smallest hole
/// that is seen through has 182 pixels (the pin of the lever).
const PINHOLE_PX: usize = 12;

/// How many times larger a part is drawn where its picture has such spots.
const LARGER: usize = 4;

/// The least share of a spot that is ground in the larger picture, if the part is open there. Measured: 0.86 to 1 for the
/// six spots between the branches of `ball` and `tray`.
const OPEN_SHARE: f64 = 0.5;

/// Most bytes that all pictures may take. Source: issue "Doors", 4.
const MOST_BYTES: u64 = 20_000_000;

/// Plans and draws the parts with these names, or all; or checks all.
pub fn run(words: &[&str]) -> Result<(), String> {
    if words == ["check"] {
        return check();
    }
    let program = crate::ci_program();
    if !program.exists() {
        return Err("build the program first: cargo build --profile ci -p grainpath-cli".to_owned());
    }
    if let Some(word) = words.iter().find(|w| PARTS.iter().all(|p| p.name != **w)) {
        let names: Vec<&str> = PARTS.iter().map(|p| p.name).collect();
        return Err(format!("{word} is no part of the gallery: {}", names.join(", ")));
    }
    let can_set = crate::setup::browser(false).is_ok() && crate::page::has_npm();
    if can_set {
        crate::page::install()?;
    } else {
        println!("NOT RUN: sheets need npm and Chromium; parts are planned and checked");
    }
    let gallery = crate::root().join("docs/gallery");
    let work = crate::target().join("gallery");
    let mut wrong = Vec::new();
    for part in PARTS.iter().filter(|p| words.is_empty() || words.contains(&p.name)) {
        let out = plan(&program, part, &gallery, &work)?;
        wrong.extend(pinholes(&program, part, &out)?);
        if !part.preset.is_empty() {
            let (job, copy) = (planned_job(part, &work), gallery.join(part.committed_job()));
            fs::create_dir_all(gallery.join("jobs")).map_err(|e| e.to_string())?;
            fs::copy(&job, &copy).map_err(|e| format!("{}: {e}", job.display()))?;
        }
        if can_set {
            let sheet = sheet(part, &out)?;
            set(&sheet, &gallery.join(format!("{}.jpg", part.name)), ".sheet")?;
            if part.name == "bracket" {
                set(&sheet, &crate::root().join("docs/pictures/bracket-sheet.png"), ".sheet")?;
            }
        }
        println!("{}: {}", part.name, part.about);
    }
    let there: Vec<&Part> =
        PARTS.iter().filter(|p| gallery.join(format!("{}.jpg", p.name)).exists()).collect();
    fs::write(gallery.with_extension("md"), page(&there)).map_err(|e| e.to_string())?;
    if can_set && there.len() == PARTS.len() {
        let sheet = all_parts(&work, &gallery)?;
        set(&sheet, &crate::root().join("docs/pictures/gallery.jpg"), ".all")?;
    }
    let mut bytes = 0;
    for file in crate::book::files(&gallery)? {
        bytes += fs::metadata(&file).map_err(|e| format!("{}: {e}", file.display()))?.len();
    }
    if bytes > MOST_BYTES {
        return Err(format!("docs/gallery has {bytes} bytes, more than {MOST_BYTES}"));
    }
    if !wrong.is_empty() {
        return Err(wrong.join("\n       "));
    }
    println!(
        "{} of {} parts are drawn; docs/gallery has {:.1} MB",
        there.len(),
        PARTS.len(),
        bytes as f64 * 1e-6
    );
    Ok(())
}

/// Plans every part; pinholes in its picture, and a job or a page that is not the committed one, are failures.
fn check() -> Result<(), String> {
    let program = crate::ci_program();
    let gallery = crate::root().join("docs/gallery");
    let work = crate::target().join("gallery");
    let mut wrong = Vec::new();
    for part in &PARTS {
        let out = plan(&program, part, &gallery, &work)?;
        wrong.extend(pinholes(&program, part, &out)?);
        let committed = gallery.join(part.committed_job());
        if crate::book::read(&committed)? != crate::book::read(&planned_job(part, &work))? {
            wrong.push(format!("{} is not what `grainpath new {}` writes", committed.display(), part.preset));
        }
        println!("{}: {}", part.name, part.about);
    }
    if crate::book::read(&gallery.with_extension("md"))? != page(&PARTS.iter().collect::<Vec<_>>()) {
        wrong.push("docs/gallery.md is not that of the parts; `cargo xtask gallery` writes it".to_owned());
    }
    if wrong.is_empty() {
        println!("{} parts: no pinholes, and jobs and page are those that are committed", PARTS.len());
        return Ok(());
    }
    Err(wrong.join("\n       "))
}

/// The job of a part as it was planned below the work folder.
fn planned_job(part: &Part, work: &Path) -> PathBuf {
    let folder = work.join(part.name);
    if part.preset.is_empty() { folder.join(part.job) } else { folder.join("input").join(part.job) }
}

/// Runs the job of a part and gives the folder of its pictures.
fn plan(program: &Path, part: &Part, gallery: &Path, work: &Path) -> Result<PathBuf, String> {
    let folder = work.join(part.name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    if part.preset.is_empty() {
        for ending in ["toml", "svg"] {
            let name = Path::new(part.job).with_extension(ending);
            fs::copy(gallery.join(&name), folder.join(&name))
                .map_err(|e| format!("{}: {e}", name.display()))?;
        }
    } else {
        crate::output(Command::new(program).args(["new", part.preset]).arg(folder.join("input")))?;
    }
    let job = planned_job(part, work);
    let out = folder.join("pictures");
    let set = |key: &str, value: &str| ["--set".to_owned(), format!("{key}={value}")];
    let mut command = Command::new(program);
    command.arg("run").arg(&job).arg("--out").arg(&folder).args(set("output.preview", "\"pictures\""));
    command
        .args(set("output.report", "\"report.html\""))
        .args(set("output.gcode", "\"part.gcode\""))
        .arg("--json");
    if part.breaks {
        command.args(set("strength.enabled", "true")).args(set("strength.corners", "false"));
        command.args(set("strength.cell_mm", "0.9"));
    }
    let told = crate::output(&mut command)?;
    fs::write(folder.join("report.json"), told).map_err(|e| e.to_string())?;
    Ok(out)
}

/// What is wrong with the picture of a part: that it has pinholes.
fn pinholes(program: &Path, part: &Part, out: &Path) -> Result<Option<String>, String> {
    let picture = out.join("part.png");
    let (ground, w) = ground(&picture)?;
    let small: Vec<Vec<usize>> =
        spots(&ground, w).into_iter().filter(|spot| spot.len() < PINHOLE_PX).collect();
    if small.is_empty() {
        return Ok(None);
    }
    let larger = out.with_file_name("larger.png");
    let size = LARGER * w.max(ground.len() / w);
    let mut command = Command::new(program);
    command.arg("render").arg(out.with_file_name("part.gcode")).args(["--part", "--size", &size.to_string()]);
    crate::output(command.arg("-o").arg(&larger))?;
    let (large, large_w) = self::ground(&larger)?;
    if (large_w, large.len()) != (LARGER * w, LARGER * LARGER * ground.len()) {
        return Err(format!("{} is not {LARGER} times {}", larger.display(), picture.display()));
    }
    let n = small.iter().filter(|spot| !is_open(spot, w, &large)).count();
    Ok((n > 0).then(|| format!("{}: {n} pinholes in {}", part.name, picture.display())))
}

/// Whether a spot of a picture is ground in the larger picture too.
fn is_open(spot: &[usize], w: usize, large: &[bool]) -> bool {
    let pixels = spot.iter().flat_map(|i| {
        let (x, y) = (LARGER * (i % w), LARGER * (i / w));
        (0..LARGER * LARGER).map(move |k| (y + k / LARGER) * LARGER * w + x + k % LARGER)
    });
    let n_open = pixels.filter(|i| large[*i]).count();
    n_open as f64 >= OPEN_SHARE * (LARGER * LARGER * spot.len()) as f64
}

/// Which pixels of a picture are ground, row by row, and its width.
fn ground(path: &Path) -> Result<(Vec<bool>, usize), String> {
    let file = fs::File::open(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let wrong = |e: png::DecodingError| format!("{}: {e}", path.display());
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().map_err(wrong)?;
    let mut pixels = vec![0; reader.output_buffer_size().ok_or("a picture too large")?];
    let info = reader.next_frame(&mut pixels).map_err(wrong)?;
    let (w, h) = (info.width as usize, info.height as usize);
    let n = info.line_size / w;
    Ok((pixels.chunks_exact(n).take(w * h).map(|p| p[..3] == GROUND).collect(), w))
}

/// The connected regions of ground that do not reach the edge of the picture: the pixels of each.
fn spots(ground: &[bool], w: usize) -> Vec<Vec<usize>> {
    let h = ground.len() / w;
    let mut seen = vec![false; ground.len()];
    let mut found = Vec::new();
    for start in 0..ground.len() {
        if !ground[start] || seen[start] {
            continue;
        }
        let (mut open, mut spot, mut inside) = (vec![start], Vec::new(), true);
        seen[start] = true;
        while let Some(i) = open.pop() {
            let (x, y) = (i % w, i / w);
            spot.push(i);
            inside &= x > 0 && y > 0 && x + 1 < w && y + 1 < h;
            // Corners count: a hole of the part thins out to pixels that touch by corners alone.
            let near = (-1..=1).flat_map(|dy: isize| (-1..=1).map(move |dx: isize| (dx, dy))).filter_map(
                |(dx, dy)| {
                    let (u, v) = (x.checked_add_signed(dx)?, y.checked_add_signed(dy)?);
                    (u < w && v < h).then_some(v * w + u)
                },
            );
            for j in near.filter(|j| ground[*j]) {
                if !std::mem::replace(&mut seen[j], true) {
                    open.push(j);
                }
            }
        }
        if inside {
            found.push(spot);
        }
    }
    found
}

/// A page with the pictures of a part side by side.
fn sheet(part: &Part, out: &Path) -> Result<PathBuf, String> {
    let mut names: Vec<String> = fs::read_dir(out)
        .map_err(|e| e.to_string())?
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|n| n.ends_with(".png"))
        .collect();
    names.sort();
    let middle = |start: &str| {
        let all: Vec<&String> = names.iter().filter(|n| n.starts_with(start)).collect();
        all.get(all.len() / 2).map(|n| (*n).clone())
    };
    // Of the layers the one with most to see, for which the size of its picture stands.
    let busiest = || {
        let bytes = |n: &&String| fs::metadata(out.join(n)).map_or(0, |m| m.len());
        names.iter().filter(|n| n.starts_with("layer_")).max_by_key(bytes).cloned()
    };
    let report: serde_json::Value = fs::read_to_string(out.with_file_name("report.json"))
        .map_err(|e| e.to_string())
        .and_then(|t| serde_json::from_str(&t).map_err(|e| e.to_string()))?;
    let grams = report["mass_g"].as_f64().map_or(String::new(), |g| format!("{g:.1} g"));
    let peak =
        report["stress"]["max_von_mises_mpa"].as_f64().map_or(String::new(), |p| format!("peak {p:.1} MPa"));
    let off = report["quality"]["alignment_mean_deg"].as_f64();
    let off = off.map_or(String::new(), |d| format!("{d:.1} degrees off in the mean"));
    let breaks = report["strength"]["peak_load_n"].as_f64().map_or(String::new(), |f| format!("at {f:.0} N"));
    let panels = [
        (Some("part.png".to_owned()), "the part", grams),
        (middle("stress_"), "stress lines", peak),
        (busiest(), "a layer of beads", off),
        (middle("damage"), "where it breaks", breaks),
        (middle("grain_"), "from the photograph", String::new()),
        (middle("support_"), "supports", String::new()),
        (middle("field_"), "directions", String::new()),
    ];
    let mut html = String::from(
        "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>gallery</title><style>\
         body{margin:0;background:#fff;font:600 21px/1.25 \"DejaVu Sans\",sans-serif;color:#fff}\
         .sheet{display:inline-flex;gap:10px;padding:4px}\
         figure{margin:0;width:390px;background:#1c1e22;border-radius:8px;overflow:hidden}\
         img{display:block;width:390px;height:330px;object-fit:contain}\
         figcaption{padding:8px 14px 12px}small{display:block;font-weight:400;font-size:16px;color:#cfd3da;min-height:1.25em}\
         .part{background:#f6f4f0;color:#1d2025}.part small{color:#555}</style><div class=\"sheet\">",
    );
    let (drawing, force) = load_drawing(part)?;
    // A flat part shows its load in place of the picture of the whole, which is the drawing raised.
    if let Some(svg) = &drawing {
        let _ = write!(
            html,
            "<figure class=\"part\">{svg}<figcaption>the load<small>{force}</small></figcaption></figure>"
        );
    }
    let skip = usize::from(drawing.is_some());
    for (file, what, number) in
        panels.into_iter().filter_map(|(f, w, n)| f.map(|f| (f, w, n))).skip(skip).take(4 - skip)
    {
        let class = if file == "part.png" { " class=\"part\"" } else { "" };
        let _ = write!(
            html,
            "<figure{class}><img src=\"pictures/{file}\" alt=\"{what}\"><figcaption>{what}<small>{number}</small></figcaption></figure>"
        );
    }
    let path = out.with_file_name(format!("{}.html", part.name));
    fs::write(&path, html + "</div></html>").map_err(|e| e.to_string())?;
    Ok(path)
}

/// Width of a panel of a sheet with the space to the next, and height of its picture, pixels.
const PANEL_PX: (usize, usize) = (400, 330);

/// A page with one panel of every part, cut from the sheets.
fn all_parts(work: &Path, gallery: &Path) -> Result<PathBuf, String> {
    let mut html = String::from(
        "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>gallery</title><style>\
         body{margin:0;background:#fff;font:600 19px/1.3 \"DejaVu Sans\",sans-serif;color:#1d2025}\
         .all{display:grid;grid-template-columns:repeat(6,260px);gap:10px;padding:4px;width:1610px}\
         figure{margin:0}.tile{width:260px;height:220px;border-radius:8px;background-repeat:no-repeat}\
         figcaption{padding:2px 6px}</style><div class=\"all\">",
    );
    // A tile is two thirds of a panel; sheets begin 4 pixels from their corner.
    let scaled = |n: usize| n as f64 / 1.5;
    for part in &PARTS {
        let file = gallery.join(format!("{}.jpg", part.name));
        let _ = write!(
            html,
            "<figure><div class=\"tile\" style=\"background-image:url('file://{}');background-size:auto {}px;\
             background-position:{}px {}px\"></div><figcaption>{}</figcaption></figure>",
            file.display(),
            scaled(sheet_height(&file)?),
            -scaled(4 + PANEL_PX.0 * part.hero),
            -scaled(4),
            part.name
        );
    }
    let path = work.join("all.html");
    fs::write(&path, html + "</div></html>").map_err(|e| e.to_string())?;
    Ok(path)
}

/// Height of a JPEG picture, pixels: that of its frame header, the first `SOF` segment.
fn sheet_height(path: &Path) -> Result<usize, String> {
    let wrong = || format!("{}: no JPEG picture", path.display());
    let bytes = fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut at = 2;
    loop {
        let [0xff, kind, high, low, ..] = *bytes.get(at..).ok_or_else(wrong)? else { return Err(wrong()) };
        if matches!(kind, 0xc0..=0xc2) {
            let side = bytes.get(at + 5..at + 7).ok_or_else(wrong)?;
            return Ok(usize::from(side[0]) << 8 | usize::from(side[1]));
        }
        at += 2 + (usize::from(high) << 8 | usize::from(low));
    }
}

/// The drawing of a part of ours with what holds it (green) and its load (red arrow), and the force in words.
fn load_drawing(part: &Part) -> Result<(Option<String>, String), String> {
    if !part.preset.is_empty() {
        return Ok((None, String::new()));
    }
    let gallery = crate::root().join("docs/gallery");
    let read = |ending: &str| {
        let path = gallery.join(part.job).with_extension(ending);
        fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
    };
    let job: toml::Table = read("toml")?.parse().map_err(|e| format!("{}: {e}", part.job))?;
    let svg = read("svg")?;
    let lacks = || format!("{}: no viewBox or path", part.name);
    let size = svg.split("viewBox=\"0 0 ").nth(1).and_then(|t| t.split('"').next()).ok_or_else(lacks)?;
    let size: Vec<f64> = size.split(' ').filter_map(|n| n.parse().ok()).collect();
    let [w, h] = size[..] else { return Err(lacks()) };
    let outline = svg.split(" d=\"").nth(1).and_then(|t| t.split('"').next()).ok_or_else(lacks)?;
    let margin = 0.22 * w.max(h);
    let mut out = format!(
        "<svg viewBox=\"{} {} {} {}\" width=\"390\" height=\"330\"><path fill=\"#d98a46\" stroke=\"#8a5524\" \
         stroke-width=\"0.5\" fill-rule=\"evenodd\" d=\"{outline}\"/>",
        -margin,
        -margin,
        w + 2.0 * margin,
        h + 2.0 * margin
    );
    let rows = |key: &str| job["guide"].get(key).and_then(toml::Value::as_array).cloned().unwrap_or_default();
    // A drawing has y downwards, a part upwards.
    for fixture in rows("fixture") {
        let ([x, y], r) = place(&fixture["on"], h);
        let _ = write!(
            out,
            "<circle cx=\"{x}\" cy=\"{}\" r=\"{}\" fill=\"none\" stroke=\"#1a8f3c\" stroke-width=\"{}\"/>",
            h - y,
            r + 1.0,
            0.02 * w.max(h)
        );
    }
    let mut told = Vec::new();
    for load in rows("load") {
        let ([x, y], _) = place(&load["on"], h);
        let force = numbers(&load["force_n"]);
        let n = force.iter().map(|f| f * f).sum::<f64>().sqrt();
        told.push(format!("{n:.0} N"));
        let (ux, uy) = (force[0] / n, -force[1] / n);
        let (long, wide) = (0.2 * w.max(h), 0.03 * w.max(h));
        let tip = [x + long * ux, h - y + long * uy];
        let _ = write!(
            out,
            "<path d=\"M{x} {} L{} {}\" stroke=\"#d0202a\" stroke-width=\"{}\"/>\
             <path fill=\"#d0202a\" d=\"M{} {} L{} {} L{} {} Z\"/>",
            h - y,
            tip[0],
            tip[1],
            0.6 * wide,
            tip[0] + 2.0 * wide * ux,
            tip[1] + 2.0 * wide * uy,
            tip[0] - wide * uy,
            tip[1] + wide * ux,
            tip[0] + wide * uy,
            tip[1] - wide * ux
        );
    }
    Ok((Some(out + "</svg>"), told.join(", ")))
}

/// Middle and radius of the place of a fixture or a load, mm; a plane is taken at half the height of the drawing.
fn place(on: &toml::Value, height: f64) -> ([f64; 2], f64) {
    if let Some(cylinder) = on.get("cylinder") {
        let p = numbers(&cylinder["point_mm"]);
        return ([p[0], p[1]], numbers(&cylinder["radius_mm"])[0]);
    }
    if let Some(corners) = on.get("box_mm").and_then(toml::Value::as_array) {
        let (a, b) = (numbers(&corners[0]), numbers(&corners[1]));
        return ([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])], 0.5);
    }
    ([0.0, 0.5 * height], 0.5)
}

/// A number, or the numbers of a list.
fn numbers(value: &toml::Value) -> Vec<f64> {
    let number = |v: &toml::Value| v.as_float().or_else(|| v.as_integer().map(|i| i as f64));
    match value.as_array() {
        Some(list) => list.iter().filter_map(number).collect(),
        None => number(value).into_iter().collect(),
    }
}

/// A picture of a part of a page.
fn set(page: &Path, picture: &Path, part: &str) -> Result<(), String> {
    let browser = crate::setup::browser(false)?;
    let mut command = Command::new("node");
    command.arg("look.mjs").arg(page).arg(picture).args(["1640", "460", "--part", part]);
    crate::output(command.current_dir(crate::root().join("web")).env("BROWSER", browser)).map(drop)
}

/// The page of the gallery.
fn page(parts: &[&Part]) -> String {
    let mut out = String::from(
        "# Gallery\n\nWritten by `cargo xtask gallery`, which runs every job and draws these pictures. Each picture below leads to the job of its part; flat parts among them can be tried [in a page](try.md).\n\n\
         ![24 parts: brackets, hooks, a weave, boards along their grain, fibre plates, figures on trees, a hub from its scan](pictures/gallery.jpg)\n",
    );
    for part in parts {
        let job = part.committed_job();
        let _ =
            write!(out, "\n## {0}\n\n[![{1}](gallery/{0}.jpg)](gallery/{job})\n\n", part.name, part.about);
        let made = if part.preset.is_empty() {
            format!("[The job](gallery/{job}): `grainpath run docs/gallery/{job}`")
        } else {
            format!(
                "[The job](gallery/{job}): `grainpath new {0}`, then `grainpath run {0}/{1}`",
                part.preset, part.job
            )
        };
        let tested = if part.breaks {
            " with `--set strength.enabled=true --set strength.corners=false --set strength.cell_mm=0.9`"
        } else {
            ""
        };
        let input = match part.preset {
            "" => "Drawn for grainpath",
            "woodgrain" => "The photograph is computed by grainpath",
            "ct" => "The scan is computed by grainpath",
            _ => "The part is computed by grainpath",
        };
        let mut about = part.about.to_owned();
        about[..1].make_ascii_uppercase();
        let _ = writeln!(out, "{about}. {made}{tested}. {input}: MIT or Apache-2.0.");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pinhole_is_told_from_a_hole_and_from_the_ground_around() {
        let picture = [
            "..........",
            ".########.",
            ".#.####.#.",
            ".####...#.",
            ".###.####.",
            ".########.",
            "..........",
        ];
        let ground: Vec<bool> = picture.iter().flat_map(|r| r.chars().map(|c| c == '.')).collect();
        let mut found: Vec<usize> = spots(&ground, 10).iter().map(Vec::len).collect();
        found.sort_unstable();
        // One pixel alone; one that touches three by a corner, and the one above those.
        assert_eq!(found, [1, 5]);
    }

    #[test]
    fn a_spot_that_is_ground_in_the_larger_picture_is_open() {
        // One row of three pixels; the middle one is ground. Larger, it is ground but for its first row, or not at all.
        let row: Vec<bool> = (0..3 * LARGER).map(|x| x / LARGER == 1).collect();
        let mut large = vec![false; row.len()];
        (1..LARGER).for_each(|_| large.extend(&row));
        assert!(is_open(&[1], 3, &large));
        assert!(!is_open(&[1], 3, &vec![false; large.len()]));
    }

    #[test]
    fn the_page_is_that_of_the_parts_and_every_job_is_there() {
        let docs = crate::root().join("docs");
        assert_eq!(crate::book::read(&docs.join("gallery.md")), Ok(page(&PARTS.iter().collect::<Vec<_>>())));
        for part in &PARTS {
            assert!(docs.join("gallery").join(part.committed_job()).exists(), "{}", part.name);
        }
    }

    #[test]
    fn the_height_of_a_sheet_is_that_of_its_frame() {
        let path = crate::root().join("xtask/seeds/photo.jpg");
        // `file` says 16x12.
        assert_eq!(sheet_height(&path).unwrap(), 12);
        assert!(sheet_height(&crate::root().join("xtask/seeds/palette.png")).is_err());
    }

    #[test]
    fn every_part_has_another_name() {
        let names: std::collections::BTreeSet<&str> = PARTS.iter().map(|p| p.name).collect();
        assert_eq!(names.len(), PARTS.len());
    }
}
