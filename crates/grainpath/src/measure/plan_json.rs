//! Writes a plan as JSON, for programs that examine or change every path.

use std::fmt::Write;

use grainpath_core::{BeadRaise, BeadWidth, Plan};

/// Layers, paths, points and widths as JSON. Coordinates are those of the part, in mm, rounded to
/// the micrometre.
pub fn plan_json(plan: &Plan) -> String {
    let p = plan.plate_from_part_mm;
    // The text is written directly, because a JSON tree of every point would take many times the memory of the plan.
    let mut out = format!("{{\"plate_from_part_mm\":[{},{},{}],\"layers\":[", p.x, p.y, p.z);
    // Adding zero turns -0 into 0, so that no "-0" is written.
    let micro = |v: f64| (v * 1e3).round() * 1e-3 + 0.0;
    for (i, layer) in plan.layers.iter().enumerate() {
        let comma = if i > 0 { ",\n" } else { "\n" };
        let _ = write!(
            out,
            "{comma}{{\"z_top_mm\":{},\"height_mm\":{},\"paths\":[",
            micro(layer.z_top_mm),
            micro(layer.height_mm)
        );
        for (k, planned) in layer.paths.iter().enumerate() {
            let path = &planned.path;
            let comma = if k > 0 { "," } else { "" };
            let _ = write!(
                out,
                "{comma}{{\"role\":\"{}\",\"closed\":{},\"flow\":{},\"width_mm\":",
                path.role.gcode_name(),
                path.closed,
                path.flow
            );
            match &path.width {
                BeadWidth::Constant(w) => {
                    let _ = write!(out, "{}", micro(*w));
                }
                BeadWidth::PerVertex(w) => {
                    let all: Vec<String> = w.iter().map(|w| micro(*w).to_string()).collect();
                    let _ = write!(out, "[{}]", all.join(","));
                }
            }
            if path.raise != BeadRaise::default() {
                let BeadRaise { bottom_mm, top_mm } = path.raise;
                let _ = write!(out, ",\"raise_mm\":[{},{}]", micro(bottom_mm), micro(top_mm));
            }
            let points: Vec<String> =
                path.points.iter().map(|p| format!("[{},{}]", micro(p.x), micro(p.y))).collect();
            let _ = write!(out, ",\"points\":[{}]}}", points.join(","));
        }
        out.push_str("]}");
    }
    out.push_str("]}\n");
    out
}
