//! The report page: one file that needs no network.

use std::fmt::Write;

use base64::Engine;

use grainpath::measure::report::{Report, hours};

/// A picture on the page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// What the picture shows.
    pub title: String,
    /// The PNG file.
    pub png: Vec<u8>,
    /// Whether the picture belongs to the strength test and is shown with its results; otherwise it
    /// stands among the layers.
    pub of_test: bool,
}

// Fonts and colours come from the reader's system, light or dark, so that the page stays one file of a
// few kilobytes besides its pictures.
const STYLE: &str = "
:root{color-scheme:light dark;--fg:#1d2025;--bg:#fff;--line:#d9dce1;--soft:#f4f5f7;--warn:#8a4b00}
@media(prefers-color-scheme:dark){:root{--fg:#e7e9ec;--bg:#16181c;--line:#33373e;--soft:#20242a;--warn:#ffb866}}
body{font:16px/1.5 system-ui,sans-serif;color:var(--fg);background:var(--bg);margin:0 auto;padding:1.5rem;max-width:70rem}
h1{font-size:1.5rem;margin:0 0 1rem}h2{font-size:1.15rem;margin:2rem 0 .6rem}
.top{display:flex;flex-wrap:wrap;gap:1.5rem;align-items:center}
.top img{max-width:min(26rem,100%)}
.numbers{display:grid;grid-template-columns:repeat(auto-fit,minmax(9rem,1fr));gap:.7rem;flex:1;min-width:16rem}
.numbers div{background:var(--soft);padding:.6rem .8rem;border-radius:.4rem}
.numbers b{display:block;font-size:1.2rem}
.numbers span{font-size:.85rem;opacity:.75}
table{border-collapse:collapse;width:100%;font-size:.92rem}
td,th{padding:.25rem .6rem;border-bottom:1px solid var(--line);text-align:left;vertical-align:top;overflow-wrap:anywhere}
th{overflow-wrap:break-word}
ul.warnings{color:var(--warn);padding-left:1.2rem}
.layers{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(24rem,100%),1fr));gap:1rem}
figure{margin:0}figure img{width:100%;border-radius:.4rem}figcaption{font-size:.85rem;opacity:.8}
.key{display:flex;flex-wrap:wrap;gap:.4rem 1rem;font-size:.85rem;margin:.5rem 0 1rem}
.key i{display:inline-block;width:.9em;height:.9em;border-radius:.2em;margin-right:.35em;vertical-align:-.1em}
";

fn escaped(text: &str) -> String {
    // Names of dimensions, settings and warnings hold text of the user's; all five characters are
    // replaced, because the text also stands in attributes.
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

/// The page in its order: the first picture and the numbers, warnings, results of tests, the other
/// pictures, dimensions, stages and settings.
pub fn report_html(report: &Report, settings: &[(String, String)], pictures: &[Picture]) -> String {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\
         <title>grainpath report</title><style>{STYLE}</style></head><body>\n<h1>grainpath report</h1>\n<div class=\"top\">\n"
    );
    let mut put = |text: String| out.push_str(&text);
    // The first picture is the part itself, by the caller's order; all others belong to a section.
    if let Some(part) = pictures.first() {
        put(image(part));
    }
    put("<div class=\"numbers\">".into());
    for (value, what) in numbers(report) {
        put(format!("<div><b>{}</b><span>{}</span></div>", escaped(&value), escaped(what)));
    }
    put("</div></div>\n".into());
    // Warnings stand before the results of tests, so that no result is read without them.
    if !report.warnings.is_empty() {
        put("<h2>Warnings</h2>\n<ul class=\"warnings\">".into());
        report.warnings.iter().for_each(|w| put(format!("<li>{}</li>", escaped(&w.to_string()))));
        put("</ul>\n".into());
    }
    if let Some(s) = &report.stress {
        put("<h2>Stress</h2>\n<table>".into());
        for (what, value) in s.rows() {
            put(format!("<tr><th>{}</th><td>{}</td></tr>", escaped(&what), escaped(&value)));
        }
        put("</table>\n".into());
    }
    if let Some(s) = &report.strength {
        put("<h2>Strength</h2>\n<div class=\"layers\"><div><table>".into());
        for (what, value) in strength_rows(s) {
            put(format!("<tr><th>{}</th><td>{}</td></tr>", escaped(what), escaped(&value)));
        }
        put(format!("</table></div><figure>{}</figure>\n", crate::strength::chart_svg(s)));
        pictures.iter().filter(|p| p.of_test).for_each(|p| put(figure(p)));
        put("</div>\n".into());
    }
    if let Some(f) = &report.fibre {
        put(format!("<h2>Fibre</h2>\n<p>{}</p>\n{}", escaped(&f.summary()), fibre_table(f)));
    }
    if pictures.len() > 1 {
        put(format!("<h2>Layers</h2>\n{}<div class=\"layers\">\n", key()));
        pictures[1..].iter().filter(|p| !p.of_test).for_each(|p| put(figure(p)));
        put("</div>\n".into());
    }
    if let Some(d) = &report.dimensions {
        put(format!("<h2>Dimensions</h2>\n<p>Mean error {:.3} %.</p>\n<table>", d.mean_error_percent));
        put("<tr><th></th><th>true mm</th><th>printed mm</th><th>error %</th></tr>".into());
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
    put("<h2>Time taken</h2>\n<table>".into());
    report.stages_s.iter().for_each(|(stage, s)| put(format!("<tr><th>{stage}</th><td>{s:.3} s</td></tr>")));
    put(format!("<tr><th>peak memory</th><td>{:.0} MiB</td></tr></table>\n", report.peak_rss_mb));
    put("<h2>Settings</h2>\n<table>".into());
    for (k, v) in settings {
        put(format!("<tr><th>{}</th><td>{}</td></tr>", escaped(k), escaped(v)));
    }
    put(format!("</table>\n<p>grainpath {}</p>\n</body></html>\n", report.version));
    out
}

fn fibre_table(f: &grainpath::measure::fibre::FibreReport) -> String {
    // One row for each layer: the totals hide a layer whose paths are too short or too sharp.
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
    let corners: Vec<String> = s.corners.iter().map(|(c, n)| format!("{c} {n:.0} N")).collect();
    vec![
        ("breaks at", format!("{:.0} N ({})", s.peak_load_n, s.over())),
        ("weakest", s.weakest.words.clone()),
        ("first ply", format!("{:.0} N", s.first_n)),
        ("stiffness", format!("{:.0} N/mm", s.stiffness_n_per_mm)),
        ("load per gram", format!("{:.0} N/g", s.load_per_gram_n_g)),
        ("modes, by energy", modes.join(", ")),
        ("corners of the card", corners.join(", ")),
        (
            // Without a second run on larger cells nothing is said about the influence of the mesh.
            "cells",
            s.mesh_change.map_or(format!("{}, {} mm", s.fidelity, s.cell_mm), |c| {
                let moved = 100.0 * c;
                format!(
                    "{}, {} mm; the answer moved by {moved:.1} % when they were halved",
                    s.fidelity, s.cell_mm
                )
            }),
        ),
        ("card", format!("{}: {}", s.card_tier, s.card_source)),
    ]
}

fn numbers(r: &Report) -> Vec<(String, &'static str)> {
    let mut all = vec![
        (hours(r.time_s), "estimated time"),
        (format!("{:.2} g", r.mass_g), "material"),
        (format!("{:.2} m", r.filament_mm * 1e-3), "filament"),
        (format!("{} to {} mm", r.layers, r.z_max_mm), "layers"),
        (format!("{:.1} m", r.printed_mm * 1e-3), "printed"),
        (format!("{:.1} m", r.travel_mm * 1e-3), "travel"),
        (format!("{:.1} %", 100.0 * r.density), "fill density"),
    ];
    if let Some(q) = &r.quality {
        if r.is_dense {
            all.push((format!("{:.2} %", 100.0 * q.gap), "of the part not covered"));
            all.push((format!("{:.2} %", 100.0 * q.overlap), "laid twice"));
        }
        all.push((format!("{:.2} %", 100.0 * q.spill), "outside the part"));
        let [low, middle, high] = q.bead_width_mm;
        all.push((format!("{low:.2} / {middle:.2} / {high:.2} mm"), "bead width at 1, 50, 99 %"));
        all.push((q.paths_per_layer_max.to_string(), "most paths in a layer"));
    }
    if let Some(u) = &r.support {
        if let Some(g) = u.mass_g {
            all.push((format!("{g:.2} g"), "of it support, as printed"));
        }
        all.push((format!("{:.2} g", u.solid_mass_g), "support if it were solid"));
        all.push((format!("{} at {}", u.trees, u.contacts), "trees, at contacts"));
        all.push((u.unreached.len().to_string(), "overhangs not reached"));
        if u.near_plate > 0 {
            all.push((u.near_plate.to_string(), "contacts so near the plate that nothing fits below"));
        }
    }
    all
}

/// The legend of the colours of roles.
fn key() -> String {
    let mut out = String::from("<div class=\"key\">");
    // Roles outside the part are left out, except support.
    for role in
        grainpath_core::Role::ALL.into_iter().filter(|r| r.is_part() || *r == grainpath_core::Role::Support)
    {
        let [r, g, b] = crate::layer::role_colour(role);
        let _ = write!(
            out,
            "<span><i style=\"background:#{r:02x}{g:02x}{b:02x}\"></i>{}</span>",
            role.gcode_name()
        );
    }
    out + "</div>"
}

fn figure(p: &Picture) -> String {
    format!("<figure>{}<figcaption>{}</figcaption></figure>\n", image(p), escaped(&p.title))
}

fn image(p: &Picture) -> String {
    // Pictures are embedded as base64, so that the file can be sent by itself.
    let data = base64::engine::general_purpose::STANDARD.encode(&p.png);
    format!("<img alt=\"{}\" src=\"data:image/png;base64,{data}\"/>", escaped(&p.title))
}
