//! The report page: one file that needs no network.
//!
//! Order: the part and its numbers, warnings, a slider of layers, stress, strength, fibre, steps towards the guide,
//! dimensions, and settings that differ from their profiles and defaults. The other settings and the time taken are folded away.
//! Pictures and layers stand in the page as base64, so that it is a single file. `layers.rs` packs the layers and
//! `page.js` draws them. Fonts and colours come from the reader's system, light or dark.
//!
//! Limits: very large prints show every second or third layer. Without scripts the page shows one layer as a
//! picture in place of the slider; everything else is the same.

mod packed_layers;

use std::fmt::Write;

use base64::Engine;
use grainpath_core::spelling::counted;
use grainpath_core::{DVec2, Role};

use crate::layer::{LayerPicture, Ramp, role_colour};
use grainpath::measure::report::{Report, StressReport, hours};
use grainpath::measure::strength::three_digits;

/// A picture on the page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// What the picture shows.
    pub title: String,
    /// The PNG file.
    pub png: Vec<u8>,
    /// The section that it belongs to.
    pub of: Of,
    /// The values of blue and red, if the colours stand for values.
    pub scale: Option<ColourScale>,
}

/// The section of the page to which a picture belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Of {
    /// The whole part, at the top of the page.
    Part,
    /// A layer, for readers whose browser runs no scripts.
    Layer,
    /// Graded density.
    Density,
    /// Stress, directions, loads.
    Stress,
    /// The strength test.
    Strength,
    /// A step of making supports, or of deriving directions from a photograph or a scan.
    #[default]
    Steps,
}

/// The range of a ramp of colours from blue to red.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourScale {
    /// The value that is blue.
    pub low: f64,
    /// The value that is red.
    pub high: f64,
    /// Name of the quantity that is shown, with its unit.
    pub what: &'static str,
}

/// A setting of the job.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Section and key.
    pub key: String,
    /// The value of this run.
    pub value: String,
    /// The value that it has without a word of the job: that of the section's profile, or the default.
    pub default: String,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
}

/// A place in a layer that a button of the page leads to.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Text of the button, which says what is at this place.
    pub what: String,
    /// Position in the plane of the layers, mm.
    pub at: DVec2,
    /// Its height, mm.
    pub z_mm: f64,
}

/// Contents of the page besides the report.
#[derive(Debug, Default)]
pub struct Contents<'a> {
    /// Settings of the run.
    pub settings: &'a [Setting],
    /// Pictures.
    pub pictures: &'a [Picture],
    /// Every layer, for the slider.
    pub layers: &'a [LayerPicture],
    /// Places to jump to with the slider.
    pub marks: &'a [Mark],
}

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

fn escaped(text: &str) -> String {
    // Dimensions, settings and warnings contain texts from the user. All five characters are
    // replaced, because these texts also stand in attributes.
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// The page as HTML.
pub fn report_html(report: &Report, contents: &Contents<'_>) -> String {
    let name = report.outputs.get("gcode").map_or("", String::as_str);
    let name = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let name = escaped(name.strip_suffix(".gcode").unwrap_or(name));
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\
         <title>{name}: grainpath report</title><style>{STYLE}</style></head><body><main>\n\
         <h1>{name}</h1>\n<p class=\"sub\">grainpath report, version {}</p>\n<div class=\"top\">\n",
        report.version
    );
    // Several layers of a plate may have the same picture of stress; it is shown once.
    let is_new = |i: usize, p: &Picture| contents.pictures[..i].iter().all(|q| q.png != p.png);
    let pictures = |of: Of| {
        let all = contents.pictures.iter().enumerate();
        all.filter(move |(i, p)| p.of == of && is_new(*i, p)).map(|(_, p)| p)
    };
    let mut put = |text: String| out.push_str(&text);
    pictures(Of::Part).for_each(|part| put(image(part)));
    put("<div class=\"numbers\">".into());
    for (value, what) in numbers(report) {
        put(format!("<div><b>{}</b><span>{}</span></div>", escaped(&value), escaped(what)));
    }
    put("</div></div>\n".into());
    // Warnings come before the results of tests, so that they are read first.
    if !report.warnings.is_empty() {
        put("<h2>Warnings</h2>\n<ul class=\"warnings\">".into());
        report.warnings.iter().for_each(|w| put(format!("<li>{}</li>", escaped(&w.to_string()))));
        put("</ul>\n".into());
    }
    if let Some(g) = &report.graded {
        put("<h2>Density</h2>\n".into());
        put(table(g.rows().iter().map(|(what, value)| (what.as_str(), value.clone()))));
        pictures(Of::Density).for_each(|p| put(figure(p)));
    }
    put(layers_section(contents));
    let of_stress: String = pictures(Of::Stress).map(figure).collect();
    if report.stress.is_some() || !of_stress.is_empty() {
        put("<h2>Stress</h2>\n".into());
        if let Some(s) = &report.stress {
            put(table(s.rows().iter().map(|(what, value)| (what.as_str(), value.clone()))));
        }
        if let Some(r) = &report.reserve {
            put(table(r.rows().iter().map(|(what, value)| (what.as_str(), value.clone()))));
        }
        put(format!("<div class=\"pictures\">{of_stress}</div>\n"));
    }
    if let Some(s) = &report.strength {
        put(format!(
            "<h2>Strength</h2>\n<div class=\"pictures\"><div>{}</div>",
            table(strength_rows(s).into_iter())
        ));
        put(format!(
            "<figure>{}<figcaption>Load over displacement. The dashed line is the peak, the band its interval.\
             </figcaption></figure>\n",
            crate::strength::chart_svg(s)
        ));
        pictures(Of::Strength).for_each(|p| put(figure(p)));
        put("</div>\n".into());
    }
    if let Some(f) = &report.fibre {
        put(format!(
            "<h2>Fibre</h2>\n<p>{}</p>\n<div class=\"wide\" tabindex=\"0\">{}</div>\n",
            escaped(&f.summary()),
            fibre_table(f)
        ));
    }
    let steps: String = pictures(Of::Steps).map(figure).collect();
    if !steps.is_empty() {
        put(format!("<h2>Steps</h2>\n<div class=\"pictures\">{steps}</div>\n"));
    }
    if let Some(d) = &report.dimensions {
        let mean = d.mean_error_percent.map(|mean| format!("Mean error {mean:.3} %."));
        let mean = mean.unwrap_or_else(|| "No dimension was found on the beads.".into());
        put(format!("<h2>Dimensions</h2>\n<p>{mean}</p>\n<table>"));
        put("<tr><th>dimension</th><th>true mm</th><th>printed mm</th><th>error %</th></tr>".into());
        let shown = |v: Option<f64>| v.map_or("-".into(), |v| format!("{v:.3}"));
        for m in &d.each {
            let (printed, error) = (shown(m.printed_mm), shown(m.error_percent));
            put(format!(
                "<tr><th>{}</th><td>{:.3}</td><td>{printed}</td><td>{error}</td></tr>",
                escaped(&m.name),
                m.true_mm
            ));
        }
        put("</table>\n".into());
    }
    put(settings_section(contents.settings));
    let mut taken: Vec<(&str, String)> =
        report.stages_s.iter().map(|(stage, s)| (*stage, format!("{s:.3} s"))).collect();
    taken.push(("peak memory", format!("{:.0} MiB", report.peak_rss_mb)));
    put(format!("<details><summary>Time taken</summary>{}</details>\n", table(taken.into_iter())));
    put(format!("</main><script>{SCRIPT}</script></body></html>\n"));
    out
}

/// A table of two columns, names and values.
fn table<'a>(rows: impl Iterator<Item = (&'a str, String)>) -> String {
    let rows: String = rows
        .map(|(what, value)| format!("<tr><th>{}</th><td>{}</td></tr>", escaped(what), escaped(&value)))
        .collect();
    format!("<table>{rows}</table>\n")
}

/// The settings of the run: first those that differ from their profiles and defaults, then the others, folded away.
fn settings_section(settings: &[Setting]) -> String {
    let (changed, usual): (Vec<&Setting>, Vec<&Setting>) =
        settings.iter().partition(|s| s.value != s.default);
    let with_unit = |value: &str, unit: &str| {
        if unit.is_empty() || value.is_empty() { value.to_owned() } else { format!("{value} {unit}") }
    };
    let mut out = String::from("<h2>Settings</h2>\n");
    if changed.is_empty() {
        out += "<p>All settings are those of the profiles, or have their defaults.</p>\n";
    } else {
        out += "<table id=\"changed\"><tr><th>setting</th><th>here</th><th>profile or default</th></tr>";
        for s in &changed {
            let _ = write!(
                out,
                "<tr><th>{}</th><td>{}</td><td>{}</td></tr>",
                escaped(&s.key),
                escaped(&with_unit(&s.value, s.unit)),
                escaped(&with_unit(&s.default, s.unit))
            );
        }
        out += "</table>\n";
    }
    let rows = usual.iter().map(|s| (s.key.as_str(), with_unit(&s.value, s.unit)));
    let _ = writeln!(
        out,
        "<details id=\"usual\"><summary>{} as in the profiles or by default</summary>{}</details>",
        counted(usual.len(), "setting"),
        table(rows)
    );
    out
}

/// The slider of layers with its data; empty where nothing was printed.
fn layers_section(contents: &Contents<'_>) -> String {
    let Some(packed) = packed_layers::pack(contents.layers) else { return String::new() };
    let (all, shown) = (contents.layers, &packed.shown);
    let roles: Vec<String> = Role::ALL
        .into_iter()
        .map(|role| {
            let [r, g, b] = role_colour(role);
            format!("[\"{}\",[{r},{g},{b}]]", role.gcode_name())
        })
        .collect();
    // A height lies in the first layer whose top is not below it.
    let layer_at = |z: f64| shown.iter().position(|k| all[*k].z_mm > z - 1e-6).unwrap_or(shown.len() - 1);
    let marks: Vec<String> = contents
        .marks
        .iter()
        .map(|m| format!("{{\"layer\":{},\"at\":[{:.4},{:.4}]}}", layer_at(m.z_mm), m.at.x, m.at.y))
        .collect();
    let (low, size) = (packed.beads.min, packed.beads.size().max(DVec2::splat(1e-3)));
    let mut out = String::from("<h2>Layers</h2>\n");
    if shown.len() < all.len() {
        let _ = writeln!(out, "<p>{} of {} layers are shown, evenly spaced.</p>", shown.len(), all.len());
    }
    let _ = write!(
        out,
        "<div id=\"layers\"><canvas data-is=\"canvas\" role=\"img\" aria-label=\"Beads of a layer\"></canvas>\
         <p data-is=\"told\">Layers are drawn by a script of this page.</p><div data-is=\"tools\" hidden=\"hidden\">\
         <label><span>layer</span><input data-is=\"layer\" type=\"range\" min=\"0\" max=\"0\" value=\"0\"/><span data-is=\"layer-told\"></span></label>\
         <label><span>beads</span><input data-is=\"beads\" type=\"range\" min=\"0\" max=\"1000\" value=\"1000\"/><span data-is=\"beads-told\"></span></label>\
         <div class=\"row\"><label><input data-is=\"travels\" type=\"checkbox\"/>travels</label>\
         <label><input data-is=\"below\" type=\"checkbox\"/>layer below</label>\
         <button type=\"button\" data-is=\"in\">closer</button><button type=\"button\" data-is=\"out\">farther</button>\
         <button type=\"button\" data-is=\"whole\">whole layer</button>"
    );
    for (i, mark) in contents.marks.iter().enumerate() {
        let _ = write!(out, "<button type=\"button\" data-mark=\"{i}\">{}</button>", escaped(&mark.what));
    }
    let _ = write!(
        out,
        "</div>{}</div></div>\n<script type=\"application/json\" id=\"layers-about\">{{\"total\":{},\"first\":{},\
         \"window\":[{:.4},{:.4},{:.4},{:.4}],\"width_step\":{},\"travel\":{},\"roles\":[{}],\"marks\":[{}]}}</script>\n\
         <script type=\"application/octet-stream\" id=\"layers-data\">{}</script>\n",
        key(all),
        all.len(),
        // The page opens at the middle layer, which shows the fill; the first and the last layer are mostly skins.
        shown.len() / 2,
        low.x,
        low.y,
        size.x,
        size.y,
        packed_layers::WIDTH_STEP_MM,
        packed_layers::TRAVEL,
        roles.join(","),
        marks.join(","),
        base64::engine::general_purpose::STANDARD.encode(&packed.bytes)
    );
    let still: String = contents.pictures.iter().filter(|p| p.of == Of::Layer).map(figure).collect();
    let _ = writeln!(out, "<noscript>{still}</noscript>");
    out
}

fn fibre_table(f: &grainpath::measure::laid_fibre::FibreReport) -> String {
    // Each layer has a row, because totals would hide a layer whose paths are too short or turn too sharply.
    let mut out = String::from(
        "<table><tr><th>layer</th><th>z mm</th><th>length mm</th><th>paths</th><th>shortest mm</th><th>cuts</th>\
         <th>smallest radius mm</th><th>sharper turns</th><th>within 15 degrees</th></tr>",
    );
    for l in &f.layers {
        let radius = l.min_radius_mm.map_or("-".to_owned(), |r| format!("{r:.2}"));
        let along = l.within_15_deg.map_or("-".to_owned(), |s| format!("{:.1} %", 100.0 * s));
        out += &format!(
            "<tr><td>{}</td><td>{}</td><td>{:.1}</td><td>{}</td><td>{:.1}</td><td>{}</td><td>{radius}</td><td>{}</td><td>{along}</td></tr>",
            l.layer,
            l.z_mm,
            l.length_mm,
            l.paths,
            l.shortest_mm,
            l.cuts,
            l.sharp_turns.len()
        );
    }
    out + "</table>\n"
}

fn strength_rows(s: &grainpath::measure::strength::StrengthReport) -> Vec<(&'static str, String)> {
    let modes: Vec<String> = s.modes.iter().map(|(m, share)| format!("{m} {:.0} %", 100.0 * share)).collect();
    let corners: Vec<String> = s.corners.iter().map(|(c, n)| format!("{c} {} N", three_digits(*n))).collect();
    vec![
        ("breaks at", format!("{} N ({})", three_digits(s.peak_load_n), s.over())),
        ("weakest", s.weakest.words.clone()),
        ("first ply", format!("{} N", three_digits(s.first_n))),
        ("stiffness", format!("{} N/mm", three_digits(s.stiffness_n_per_mm))),
        ("load per gram", format!("{} N/g", three_digits(s.load_per_gram_n_g))),
        ("modes, by energy", modes.join(", ")),
        ("corners of the card", corners.join(", ")),
        (
            // The influence of the cell size is stated only if a second run with larger cells was made.
            "cells",
            s.mesh_change.map_or(format!("{}, {} mm", s.fidelity, s.cell_mm), |c| {
                let moved = 100.0 * c;
                format!(
                    "{}, {} mm; the breaking load changed by {moved:.1} % when the cells were halved",
                    s.fidelity, s.cell_mm
                )
            }),
        ),
        ("card", format!("{}: {}", s.card_tier, s.card_source)),
    ]
}

fn numbers(r: &Report) -> Vec<(String, &'static str)> {
    let mut all = Vec::new();
    // The breaking load comes first, because most readers look for it.
    if let Some(s) = &r.strength {
        all.push((format!("{} N", three_digits(s.peak_load_n)), "breaks at"));
        if s.low_n < s.high_n {
            let interval = format!("{} to {} N", three_digits(s.low_n), three_digits(s.high_n));
            all.push((interval, s.over_what()));
        }
    }
    if let Some(least) = r.reserve.as_ref().and_then(|r| r.least.as_ref()) {
        let [_, nominal, _] = least.first_failure;
        all.push((format!("{nominal:.2} times the load"), "first failure"));
    }
    if let Some(StressReport { max_von_mises_mpa, .. }) = &r.stress {
        all.push((format!("{max_von_mises_mpa:.2} MPa"), "peak stress (von Mises)"));
    }
    all.extend([
        (hours(r.time_s), "estimated time"),
        (format!("{:.2} g", r.mass_g), "material"),
        (format!("{:.2} m", r.filament_mm * 1e-3), "filament"),
        (format!("{} to {} mm", r.layers, r.z_max_mm), "layers"),
        (format!("{:.1} m", r.printed_mm * 1e-3), "printed"),
        (format!("{:.1} m", r.travel_mm * 1e-3), "travel"),
        (format!("{:.1} %", 100.0 * r.density), "fill density"),
    ]);
    if let Some(q) = &r.quality {
        if r.is_dense {
            all.push((format!("{:.2} %", 100.0 * q.gap), "of the part not covered"));
            all.push((format!("{:.2} %", 100.0 * q.overlap), "laid twice"));
        }
        all.push((format!("{:.2} %", 100.0 * q.spill), "outside the part"));
        if let Some(mean) = q.alignment_mean_deg {
            all.push((format!("{mean:.1} degrees"), "between the fill and its directions, in the mean"));
        }
        let [low, middle, high] = q.bead_width_mm;
        all.push((format!("{low:.2} / {middle:.2} / {high:.2} mm"), "bead width at 1, 50, 99 %"));
        all.push((q.paths_per_layer_max.to_string(), "most paths in a layer"));
    }
    if let Some(u) = &r.support {
        if let Some(g) = u.mass_g {
            all.push((format!("{g:.2} g"), "mass of supports, as printed"));
        }
        all.push((format!("{:.2} g", u.solid_mass_g), "mass of supports if solid"));
        all.push((format!("{} at {}", u.trees, u.contacts), "trees, at contacts"));
        all.push((u.unreached.len().to_string(), "overhangs not reached"));
        if u.near_plate > 0 {
            all.push((u.near_plate.to_string(), "contacts too near the plate for a support"));
        }
    }
    all
}

/// The legend: the colour of each role that occurs in the print.
fn key(layers: &[LayerPicture]) -> String {
    let mut out = String::from("<div class=\"key\">");
    for role in Role::ALL.into_iter().filter(|r| layers.iter().any(|l| l.beads.iter().any(|b| b.role == *r)))
    {
        let [r, g, b] = role_colour(role);
        let _ = write!(
            out,
            "<span><i style=\"background:#{r:02x}{g:02x}{b:02x}\"></i>{}</span>",
            role.gcode_name()
        );
    }
    out + "</div>"
}

fn figure(p: &Picture) -> String {
    let scale = p.scale.as_ref().map(scale_bar).unwrap_or_default();
    format!("<figure>{}{scale}<figcaption>{}</figcaption></figure>\n", image(p), escaped(&p.title))
}

/// The colour ramp of a picture, with the values at its ends and the name of the quantity.
fn scale_bar(scale: &ColourScale) -> String {
    let ramp = Ramp { low: 0.0, high: 1.0 };
    // Eleven colour stops reproduce the ramp of the picture.
    let stops: Vec<String> = (0..=10)
        .map(|k| {
            let [r, g, b] = ramp.colour(f64::from(k) / 10.0);
            format!("#{r:02x}{g:02x}{b:02x}")
        })
        .collect();
    let value = |share: f64| {
        let v = scale.low + share * (scale.high - scale.low);
        // At most three decimals, and fewer for large values: a colour cannot be read more exactly.
        let digits = if v.abs() >= 100.0 || v == 0.0 {
            0
        } else if v.abs() >= 10.0 {
            1
        } else {
            3
        };
        format!("{v:.digits$}")
    };
    format!(
        "<div class=\"scale\"><span>{}</span><i style=\"background:linear-gradient(90deg,{})\"></i><span>{}</span><span>{}</span></div>",
        value(0.0),
        stops.join(","),
        value(1.0),
        escaped(scale.what)
    )
}

fn image(p: &Picture) -> String {
    let data = base64::engine::general_purpose::STANDARD.encode(&p.png);
    format!("<img alt=\"{}\" src=\"data:image/png;base64,{data}\"/>", escaped(&p.title))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_settings_come_first_and_the_rest_is_folded() {
        let setting = |key: &str, value: &str, default: &str| Setting {
            key: key.into(),
            value: value.into(),
            default: default.into(),
            unit: "mm",
        };
        let page = settings_section(&[
            setting("process.layer_height_mm", "0.2", "0.2"),
            setting("process.bead_width_mm", "0.6", "0.45"),
            setting("shape.mesh", "<part>", ""),
        ]);
        let (changed, usual) = page.split_once("<details").expect("folded settings");
        assert!(changed.contains("<th>process.bead_width_mm</th><td>0.6 mm</td><td>0.45 mm</td>"), "{page}");
        assert!(changed.contains("&lt;part&gt; mm</td><td></td>"), "what users wrote is escaped: {page}");
        assert!(!changed.contains("layer_height_mm") && usual.contains("layer_height_mm"), "{page}");
        assert!(usual.contains("1 setting as in the profiles or by default"), "{page}");
    }

    #[test]
    fn a_scale_has_its_ends_and_the_colours_of_the_ramp() {
        let bar = scale_bar(&ColourScale { low: 0.0, high: 12.345, what: "MPa" });
        assert!(bar.contains("<span>0</span>") && bar.contains("<span>12.3</span><span>MPa</span>"), "{bar}");
        let [r, g, b] = Ramp { low: 0.0, high: 1.0 }.colour(1.0);
        assert!(bar.contains(&format!("#{r:02x}{g:02x}{b:02x})")), "{bar}");
        assert_eq!(bar.matches('#').count(), 11);
    }
}
