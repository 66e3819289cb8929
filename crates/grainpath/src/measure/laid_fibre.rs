//! Measures the fibre of a program layer by layer on the program's G-code.
//!
//! Lengths are in mm, positions in part coordinates. Cost: linear in the beads with fibre.

use grainpath_core::{DVec2, Role, Warning, WarningId};
use grainpath_gcode::{Bead, BeadLayer, Program};
use serde::Serialize;

use crate::fibre::{sharp_bends, turns};
use crate::measure::DirectionError;

/// The fibre of one layer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FibreLayer {
    /// Number of the layer, from 1.
    pub layer: usize,
    /// Height of the nozzle while it prints the layer, mm.
    pub z_mm: f64,
    /// Length of fibre, mm.
    pub length_mm: f64,
    /// Number of paths without a travel between them.
    pub paths: usize,
    /// Length of the shortest path, mm.
    pub shortest_mm: f64,
    /// Number of cuts.
    pub cuts: usize,
    /// Smallest radius of a turn, mm; left out where all paths are straight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min_radius_mm: Option<f64>,
    /// Position of the turn with the smallest radius, in part coordinates, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sharpest_mm: Option<[f64; 2]>,
    /// Turns below the required radius: x and y in part coordinates and the radius, mm. A hairpin counts as
    /// one turn.
    pub sharp_turns: Vec<[f64; 3]>,
    /// Share of the length within 15 degrees of the guide's direction, weighted by the guide's
    /// strength.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub within_15_deg: Option<f64>,
}

/// The fibre of a program.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FibreReport {
    /// Length of fibre, mm.
    pub length_mm: f64,
    /// Mass of the beads with fibre, g.
    pub mass_g: f64,
    /// Number of pieces of fibre, from feed to cut; a piece may pass through several layers.
    pub pieces: usize,
    /// Number of cuts.
    pub cuts: usize,
    /// Required least radius, mm.
    pub asked_radius_mm: f64,
    /// Smallest radius of a turn, mm; left out where all paths are straight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min_radius_mm: Option<f64>,
    /// Number of turns below the required radius.
    pub sharp_turns: usize,
    /// Share of the length within 15 degrees of the guide's direction, weighted by the guide's
    /// strength.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub within_15_deg: Option<f64>,
    /// Layer by layer; layers without fibre are left out.
    pub layers: Vec<FibreLayer>,
}

/// Measures the fibre of a program. `shift` is the position of the part on the plate.
pub fn measure(
    program: &Program,
    shift: DVec2,
    asked_radius_mm: f64,
    density_g_cm3: f64,
    off: Option<&DirectionError<'_>>,
) -> FibreReport {
    let mut report = FibreReport {
        length_mm: 0.0,
        mass_g: 0.0,
        pieces: program.layers.iter().map(|l| l.fibre_starts).sum(),
        cuts: program.layers.iter().map(|l| l.cuts.len()).sum(),
        asked_radius_mm,
        min_radius_mm: None,
        sharp_turns: 0,
        within_15_deg: None,
        layers: Vec::new(),
    };
    let (mut within, mut weights) = (0.0, 0.0);
    for (i, layer) in program.layers.iter().enumerate() {
        let paths = fibre_paths(layer, shift);
        if paths.is_empty() {
            continue;
        }
        let length = |p: &Vec<DVec2>| p.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
        let lengths: Vec<f64> = paths.iter().map(length).collect();
        let mut sharpest: Option<(f64, DVec2)> = None;
        let mut sharp_turns = Vec::new();
        for path in &paths {
            // Coordinates of a program are rounded to micrometres, so the ends of a closed path may lie up to
            // two micrometres apart.
            let closed = path.len() > 3 && path[0].distance(path[path.len() - 1]) < 2e-3;
            let points = if closed { &path[..path.len() - 1] } else { &path[..] };
            for t in sharp_bends(points, closed, asked_radius_mm) {
                sharp_turns.push([round(t.at.x, 2), round(t.at.y, 2), round(t.radius_mm, 3)]);
            }
            for t in turns(points, closed) {
                if t.radius_mm.is_finite() && sharpest.is_none_or(|(r, _)| t.radius_mm < r) {
                    sharpest = Some((t.radius_mm, t.at));
                }
            }
        }
        let z_mid = layer.z_mm - 0.5 * layer.height_mm;
        let (mut near, mut all) = (0.0, 0.0);
        if let Some(off) = off {
            // The direction of each piece is compared with the guide at its middle.
            for w in paths.iter().flat_map(|p| p.windows(2)) {
                let Some((deg, weight)) = off(z_mid, [w[0], w[1]]) else { continue };
                let length = weight * w[0].distance(w[1]);
                all += length;
                near += if deg <= 15.0 { length } else { 0.0 };
            }
        }
        within += near;
        weights += all;
        let volume: f64 = fibre(layer).map(|b| f64::from(b.volume_mm3)).sum();
        report.length_mm += lengths.iter().sum::<f64>();
        report.mass_g += volume * 1e-3 * density_g_cm3;
        report.sharp_turns += sharp_turns.len();
        let radius = sharpest.map(|s| round(s.0, 3));
        report.min_radius_mm = match (report.min_radius_mm, radius) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        report.layers.push(FibreLayer {
            layer: i + 1,
            z_mm: round(layer.z_mm, 4),
            length_mm: round(lengths.iter().sum(), 2),
            paths: paths.len(),
            shortest_mm: round(lengths.iter().copied().fold(f64::INFINITY, f64::min), 2),
            cuts: layer.cuts.len(),
            min_radius_mm: radius,
            sharpest_mm: sharpest.map(|s| [round(s.1.x, 2), round(s.1.y, 2)]),
            sharp_turns,
            within_15_deg: (all > 0.0).then(|| round(near / all, 4)),
        });
    }
    report.length_mm = round(report.length_mm, 2);
    report.mass_g = round(report.mass_g, 4);
    report.within_15_deg = (weights > 0.0).then(|| round(within / weights, 4));
    report
}

fn round(v: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    (v * scale).round() / scale
}

fn fibre(layer: &BeadLayer) -> impl Iterator<Item = &Bead> {
    layer.beads.iter().filter(|b| b.role == Role::Fibre)
}

/// Polylines of fibre in part coordinates. A new one begins where the program starts a bead, or where
/// a bead does not begin at the end of the previous one.
fn fibre_paths(layer: &BeadLayer, shift: DVec2) -> Vec<Vec<DVec2>> {
    let mut paths: Vec<Vec<DVec2>> = Vec::new();
    for bead in fibre(layer) {
        let (a, b) = (bead.start() - shift, bead.end() - shift);
        match paths.last_mut() {
            Some(path) if !bead.starts && path[path.len() - 1].distance_squared(a) < 1e-8 => path.push(b),
            _ => paths.push(vec![a, b]),
        }
    }
    paths
}

impl FibreReport {
    /// A summary of the fibre in one line, for the terminal.
    pub fn summary(&self) -> String {
        let radius =
            self.min_radius_mm.map_or("straight".to_owned(), |r| format!("smallest radius {r:.2} mm"));
        let along = self.within_15_deg.map_or(String::new(), |s| {
            format!(", {:.1} % within 15 degrees of what the guide asks for", 100.0 * s)
        });
        format!(
            "fibre: {:.2} m in {} pieces, {:.2} g, {} cuts, {radius}{along}",
            self.length_mm * 1e-3,
            self.pieces,
            self.mass_g,
            self.cuts
        )
    }

    /// A warning about turns that are too sharp, if there are any.
    pub fn warning(&self) -> Option<Warning> {
        let sharpest = self.layers.iter().filter(|l| !l.sharp_turns.is_empty());
        let worst = sharpest
            .min_by(|a, b| a.min_radius_mm.unwrap_or(0.0).total_cmp(&b.min_radius_mm.unwrap_or(0.0)))?;
        let [x, y] = worst.sharpest_mm?;
        let text = format!(
            "fibre: {} turns are sharper than {} mm; the sharpest, {:.2} mm, is in layer {}",
            self.sharp_turns, self.asked_radius_mm, worst.min_radius_mm?, worst.layer
        );
        Some(Warning::new(WarningId::FibreSharpTurn, text).at_mm(x, y))
    }
}
