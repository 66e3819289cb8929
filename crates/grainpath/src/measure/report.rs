//! The report of a run: all measurements in one structure, for JSON, the report page and the
//! terminal.

use std::collections::BTreeMap;

use grainpath_core::math::{atan2, cross, direction};
use grainpath_core::spelling::counted;
use grainpath_core::stacked::{self, Stacked};
use grainpath_core::{DVec2, Region, Role, Warning, WarningId};
use grainpath_fea::resultant::{CaseBalance, Resultant};
use grainpath_gcode::{Program, Quality, Written, quality};
use serde::Serialize;
use serde_json::Value;

use crate::guide::given_field::FieldReport;
use crate::guide::grain::PhotoReport;
use crate::guide::{Degenerate, Guide, ResultMesh};
use crate::measure::laid_density::LaidDensity;
use crate::measure::laid_fibre::FibreReport;
use crate::measure::strength::{ReserveReport, StrengthReport, digits, three_digits};
use crate::measure::{DirectionError, Planned};
use crate::support::Support;
use grainpath_imaging::scan::texture::TextureReport;

/// The report of a run. Keys that do not apply are left out.
///
/// ```
/// use grainpath::measure::report::Report;
/// use grainpath::{Settings, plan_layers};
/// # let stack = grainpath_parts::layers_of_a_box(9);
/// # let (settings, diagnostics) = (Settings::default(), grainpath_core::Diagnostics::default());
/// // `stack` has nine layers of 20 x 10 mm.
/// let planned = plan_layers(&settings, stack, "box", None, None, &[], None, &diagnostics).unwrap();
/// let mut program = Vec::new();
/// let written = grainpath_gcode::write_gcode(&planned.plan, &planned.config, &[], &mut program).unwrap();
/// let report = Report::new(&planned, &written);
/// assert_eq!((report.layers, report.z_max_mm), (9, 1.8));
/// // All nine layers are skin, so that the beads fill 360 mm3; the skirt comes on top.
/// assert!((355.0..400.0).contains(&report.extruded_mm3), "{}", report.extruded_mm3);
/// let json = serde_json::to_value(&report).unwrap();
/// assert!(json["mass_g"].is_number() && json.get("stress").is_none());
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct Report {
    pub ok: bool,
    pub version: &'static str,
    pub layers: usize,
    pub z_max_mm: f64,
    pub toolpaths: usize,
    pub printed_mm: f64,
    pub travel_mm: f64,
    pub extruded_mm3: f64,
    pub filament_mm: f64,
    pub mass_g: f64,
    pub time_s: f64,
    pub density: f64,
    /// Whether the infill is solid. Gap and overlap are faults of the print only in solid infill, so the summary shows
    /// them only then; the JSON always holds them.
    #[serde(skip)]
    pub is_dense: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scan: Option<grainpath_imaging::scan::CtReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dimensions: Option<crate::measure::dimensions::Dimensions>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<QualityReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub support: Option<SupportReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stress: Option<StressReport>,
    /// Comparison of the density of the beads with the required density, for jobs with graded density.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub graded: Option<LaidDensity>,
    /// The factor on the loads at which the part first fails, for jobs whose stress was solved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reserve: Option<ReserveReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grain: Option<Vec<PhotoReport>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texture: Option<TextureReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<FieldReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength: Option<StrengthReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fibre: Option<FibreReport>,
    pub stages_s: BTreeMap<&'static str, f64>,
    pub peak_rss_mb: f64,
    pub warnings: Vec<Warning>,
    pub outputs: BTreeMap<&'static str, String>,
}

/// Size, solver and main results of a stress analysis. Imported stress has no unknowns, no residual and no mesh error; it
/// has a displacement only if its file holds one.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct StressReport {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dofs: Option<usize>,
    pub elements: usize,
    pub solver: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
    pub cases: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual: Option<f64>,
    pub max_von_mises_mpa: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_displacement_mm: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_estimate: Option<f64>,
    /// Tensile strength of the material along the beads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength_mpa: Option<f64>,
    /// `strength_mpa` over the peak stress; left out if the peak cannot be trusted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reserve: Option<f64>,
    /// Position of the peak of `max_von_mises_mpa`, part coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_at_mm: Option<[f64; 3]>,
    /// Peaks of each case; empty where there is only one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub peaks: Vec<CasePeak>,
    /// Resultant of each load of each case.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<ResultantReport>,
    /// Reaction of each fixture in each case.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub reactions: Vec<ResultantReport>,
    /// The layers that serve each load case; empty if every layer follows the weighted sum of all cases.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub served: Vec<ServedReport>,
    /// Largest relative imbalance between loads and reactions of any case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imbalance: Option<f64>,
    /// Number of degenerate points of each kind: counted once for a plate, summed over the layers for other parts.
    pub wedges: usize,
    pub trisectors: usize,
    pub border_points: usize,
}

/// The greatest stress and displacement of a load case.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct CasePeak {
    pub case: String,
    pub max_von_mises_mpa: f64,
    /// Position of the node with this stress, part coordinates.
    pub at_mm: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_displacement_mm: Option<f64>,
}

/// A load or a reaction of a case: the area it acts on, its force, and its moment about the
/// centroid of that area.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct ResultantReport {
    pub case: String,
    pub name: String,
    pub area_mm2: f64,
    pub at_mm: [f64; 3],
    pub force_n: [f64; 3],
    pub moment_nmm: [f64; 3],
}

impl ResultantReport {
    fn new(case: &str, found: &Resultant) -> Self {
        Self {
            case: case.to_owned(),
            name: found.name.clone(),
            area_mm2: found.area_mm2,
            at_mm: found.centroid_mm.to_array(),
            force_n: found.force_n.to_array(),
            moment_nmm: found.moment_nmm.to_array(),
        }
    }
}

/// The layers whose directions serve a load case.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct ServedReport {
    /// `None` for layers that serve all cases together.
    pub case: Option<String>,
    /// Numbers of the layers, from 1.
    pub layers: Vec<usize>,
}

impl From<&Guide> for StressReport {
    fn from(guide: &Guide) -> Self {
        let s = &guide.summary;
        let resultants = |which: &dyn Fn(&CaseBalance) -> &Vec<Resultant>| -> Vec<ResultantReport> {
            let of_case = |b| which(b).iter().map(|r| ResultantReport::new(&b.case, r)).collect::<Vec<_>>();
            s.balance.iter().flat_map(of_case).collect()
        };
        let peak = |r: &ResultMesh| {
            let (stress_mpa, place) = r.peak_stress()?;
            Some(CasePeak {
                case: r.name.clone(),
                max_von_mises_mpa: digits(stress_mpa),
                at_mm: place.to_array().map(digits),
                max_displacement_mm: r.max_displacement_mm().map(digits),
            })
        };
        let is_solved = s.dofs > 0;
        let has_displacement = guide.results.iter().any(|r| r.displacement.is_some());
        Self {
            dofs: is_solved.then_some(s.dofs),
            elements: s.elements,
            solver: s.solver.clone(),
            mesh: s.mesh.clone(),
            cases: guide.cases.len(),
            residual: is_solved.then(|| digits(s.residual)),
            max_von_mises_mpa: digits(s.max_von_mises_mpa),
            max_displacement_mm: has_displacement.then(|| digits(s.max_displacement_mm)),
            error_estimate: is_solved.then(|| digits(s.error_estimate)),
            strength_mpa: s.strength_mpa.map(digits),
            reserve: guide.reserve().map(digits),
            peak_at_mm: guide.peak_stress().map(|(_, place)| place.to_array().map(digits)),
            peaks: if guide.results.len() > 1 {
                guide.results.iter().filter_map(peak).collect()
            } else {
                Vec::new()
            },
            loads: resultants(&|b| &b.loads),
            reactions: resultants(&|b| &b.reactions),
            served: guide
                .served()
                .into_iter()
                .map(|s| ServedReport { case: s.case, layers: s.layers.iter().map(|i| i + 1).collect() })
                .collect(),
            imbalance: s.balance.iter().map(|b| digits(b.imbalance())).reduce(f64::max),
            wedges: guide.count_degenerate(Degenerate::Wedge),
            trisectors: guide.count_degenerate(Degenerate::Trisector),
            border_points: guide.count_degenerate(Degenerate::Border),
        }
    }
}

impl StressReport {
    /// Names and values for the terminal and the report page.
    pub fn rows(&self) -> Vec<(String, String)> {
        let mut rows: Vec<(String, String)> = Vec::new();
        let mut add = |what: &str, value: String| rows.push((what.to_owned(), value));
        let stress = |mpa: f64, place: Option<[f64; 3]>| {
            let at = place.map_or(String::new(), |[x, y, z]| format!(" at ({x:.2}, {y:.2}, {z:.2}) mm"));
            format!("{} MPa (von Mises){at}", three_digits(mpa))
        };
        add("peak stress", stress(self.max_von_mises_mpa, self.peak_at_mm));
        for peak in &self.peaks {
            add(
                &format!("peak stress of case {}", peak.case),
                stress(peak.max_von_mises_mpa, Some(peak.at_mm)),
            );
        }
        if let Some(strength) = self.strength_mpa {
            add(
                "strength over peak",
                match self.reserve {
                    Some(reserve) => {
                        format!("{reserve:.2}: {strength} MPa along the beads over the peak stress")
                    }
                    None if self.max_von_mises_mpa == 0.0 => {
                        "none stated: the part bears no stress".to_owned()
                    }
                    None => format!(
                        "none stated: the peak cannot be trusted against the strength of {strength} MPa"
                    ),
                },
            );
        }
        if let Some(moved) = self.max_displacement_mm {
            add("largest displacement", format!("{moved:.4} mm"));
        }
        if let Some(error) = self.error_estimate {
            add("mesh error", format!("the elements miss about {:.1} % of the stress", 100.0 * error));
        }
        let dofs = self.dofs.map_or(String::new(), |n| format!(", {n} unknowns"));
        add("stress from", format!("{}, {} elements{dofs}", self.solver, self.elements));
        let several = self.cases > 1;
        let resultant = |r: &ResultantReport| {
            let [x, y, z] = r.force_n;
            let [mx, my, mz] = r.moment_nmm;
            let case = if several { format!(", case {}", r.case) } else { String::new() };
            format!(
                "{}{case}: force ({x:.3}, {y:.3}, {z:.3}) N, moment ({mx:.2}, {my:.2}, {mz:.2}) N mm, on {:.2} mm2",
                r.name, r.area_mm2
            )
        };
        for served in &self.served {
            let case =
                served.case.as_ref().map_or("all cases together".to_owned(), |name| format!("case {name}"));
            add(&format!("directions of {case}"), in_words(&served.layers));
        }
        self.loads.iter().for_each(|r| add("load", resultant(r)));
        self.reactions.iter().for_each(|r| add("reaction", resultant(r)));
        if let Some(imbalance) = self.imbalance {
            add("balance", format!("loads and reactions cancel to {:.4} %", 100.0 * imbalance));
        }
        rows
    }
}

/// Describes a list of layers in words, as series with a constant step, for example "layers 1, 3, ... 39" or
/// "layers 1 to 12, 20, 22". A long list is cut off after the first few series.
fn in_words(layers: &[usize]) -> String {
    /// Largest number of listed series. Source: chosen: about as many fit into a line of a terminal; only the text depends
    /// on it.
    const MOST: usize = 6;
    let mut stretches: Vec<(usize, usize, usize)> = Vec::new();
    for &layer in layers {
        match stretches.last_mut() {
            // The first two layers of a series fix the step between its layers. A further layer joins the series if it keeps
            // that step, and otherwise begins a new one.
            Some((first, last, step)) if first == last || layer - *last == *step => {
                *step = layer - *last;
                *last = layer;
            }
            _ => stretches.push((layer, layer, 0)),
        }
    }
    let stretch = |&(first, last, step): &(usize, usize, usize)| match (step, (last - first) / step.max(1)) {
        (0, _) => format!("{first}"),
        (_, 1) => format!("{first}, {last}"),
        (1, _) => format!("{first} to {last}"),
        (_, 2) => format!("{first}, {}, {last}", first + step),
        _ => format!("{first}, {}, ... {last}", first + step),
    };
    let told: Vec<String> = stretches.iter().take(MOST).map(stretch).collect();
    let rest =
        if stretches.len() > MOST { format!(", and on: {} layers", layers.len()) } else { String::new() };
    let s = if layers.len() == 1 { "" } else { "s" };
    format!("layer{s} {}{rest}", told.join(", "))
}

/// How well the beads fill the part, as defined in `docs/quality.md`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct QualityReport {
    pub gap: f64,
    pub overlap: f64,
    pub spill: f64,
    /// Mean angle between infill and the guide's direction, weighted by length and by the guide's
    /// strength.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alignment_mean_deg: Option<f64>,
    /// 95th percentile of the angle between infill and the guide's direction, with the same weights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alignment_p95_deg: Option<f64>,
    pub paths_per_layer_max: usize,
    pub bead_width_mm: [f64; 3],
    /// Ends of beads that stand on each other, of plans with a guide.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stacked: Option<Stacked>,
}

/// Largest unfilled share of the part's area for which a fibre job gives no warning.
const MUCH_OPEN: f64 = 0.08;

impl QualityReport {
    /// Warns if beads with fibre, whose width is constant, leave much of a dense part unfilled.
    pub fn fibre_warning(&self, width_mm: f64) -> Option<Warning> {
        (self.gap > MUCH_OPEN).then(|| {
            let text = format!(
                "fibre: {:.1} % of the part stays open, as beads {width_mm} mm wide do not fit into all of it",
                100.0 * self.gap
            );
            Warning::new(WarningId::FibreGaps, text)
        })
    }
}

/// Size and main results of the supports; see `docs/support.md`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct SupportReport {
    /// Volume of the printed beads. `None` for supports of columns or a box if only the solid was made.
    pub volume_mm3: Option<f64>,
    /// Mass of the printed beads.
    pub mass_g: Option<f64>,
    /// Volume enclosed by the surface of the support, as if another slicer filled it solidly.
    pub solid_volume_mm3: f64,
    /// Mass of the support as a solid.
    pub solid_mass_g: f64,
    pub contacts: usize,
    pub trees: usize,
    /// Number of printed beads with nothing below them; for columns or a box, the number of such pieces of layers.
    pub floating: usize,
    /// Length of the beads that has nothing below it.
    pub floating_mm: f64,
    /// Length of beads that were left out because nothing could be printed below them.
    pub left_out_mm: f64,
    pub regions: usize,
    /// Largest angle between a branch and the vertical.
    pub steepest_deg: f64,
    /// Largest distance of an overhang from its contact.
    pub farthest_mm: f64,
    /// Largest displacement of a branch tip under the drag of the nozzle.
    pub tip_moves_mm: f64,
    /// Number of contacts too near the plate for a support to fit below them.
    pub near_plate: usize,
    /// Overhangs that no branch could reach: x, y and z in mm, and the area projected onto the plate in mm2.
    pub unreached: Vec<[f64; 4]>,
}

impl SupportReport {
    /// The report of planned supports. `beads_mm3` is the volume of their beads, `solid_mm3` the volume of their solid.
    pub fn new(support: &Support, beads_mm3: Option<f64>, solid_mm3: f64, density_g_cm3: f64) -> Self {
        let round = |v: f64| (v * 1e3).round() / 1e3;
        // The sum of no volumes is -0; adding zero turns it into 0.
        let grams = |v: f64| (v * 1e-3 * density_g_cm3 * 1e4).round() / 1e4 + 0.0;
        Self {
            volume_mm3: beads_mm3.map(round),
            mass_g: beads_mm3.map(grams),
            solid_volume_mm3: round(solid_mm3),
            solid_mass_g: grams(solid_mm3),
            contacts: support.n_contacts(),
            trees: support.forest.n_trees(),
            floating: support.cut.floating,
            floating_mm: round(support.cut.floating_mm),
            left_out_mm: round(support.cut.left_out_mm),
            regions: support.overhangs.regions,
            steepest_deg: round(support.forest.steepest_rad().to_degrees()),
            farthest_mm: round(support.farthest_mm()),
            tip_moves_mm: round(support.bending.worst_mm),
            near_plate: support.near_plate,
            unreached: support
                .unreached
                .iter()
                .map(|u| [u.at.x, u.at.y, u.at.z, u.area_mm2].map(round))
                .collect(),
        }
    }

    /// A summary of the supports in one line, for the terminal.
    pub fn summary(&self) -> String {
        let printed = self.mass_g.map_or_else(String::new, |g| format!("{g:.2} g printed, "));
        let near = match self.near_plate {
            0 => String::new(),
            n => format!("; {n} more so near the plate that nothing fits below"),
        };
        format!(
            "support: {printed}{:.2} g as a solid, in {} at {}{near}, {} not reached",
            self.solid_mass_g,
            counted(self.trees, "tree"),
            counted(self.contacts, "contact"),
            counted(self.unreached.len(), "overhang")
        )
    }
}

impl From<Quality> for QualityReport {
    fn from(q: Quality) -> Self {
        let share = |v: f64| (v * 1e5).round() / 1e5;
        Self {
            gap: share(q.gap),
            overlap: share(q.overlap),
            spill: share(q.spill),
            alignment_mean_deg: None,
            alignment_p95_deg: None,
            paths_per_layer_max: q.paths_per_layer_max,
            bead_width_mm: q.bead_width_mm.map(|w| (w * 1e4).round() / 1e4),
            stacked: None,
        }
    }
}

impl Report {
    /// The report of a planned and written job.
    pub fn new(planned: &Planned, written: &Written) -> Self {
        let round = |v: f64, digits: i32| {
            let scale = 10f64.powi(digits);
            (v * scale).round() / scale
        };
        Self {
            ok: true,
            version: env!("CARGO_PKG_VERSION"),
            layers: planned.plan.layers.len(),
            z_max_mm: round(planned.plan.layers.last().map_or(0.0, |l| l.z_top_mm), 4),
            toolpaths: written.toolpaths,
            printed_mm: round(written.printed_mm, 2),
            travel_mm: round(written.travel_mm, 2),
            extruded_mm3: round(written.extruded_mm3, 3),
            filament_mm: round(written.filament_mm, 2),
            mass_g: round(written.mass_g, 4),
            time_s: round(written.time_s, 1),
            density: round(planned.density.fraction(), 5),
            is_dense: planned.density.is_dense(),
            graded: planned.laid.clone(),
            scan: planned.scan.clone(),
            dimensions: None,
            quality: None,
            // A scan is reported under `texture`, because it has no photographs.
            grain: planned.grain.as_ref().filter(|g| g.texture.is_none()).map(|g| g.photos.clone()),
            texture: planned.grain.as_ref().and_then(|g| g.texture.clone()),
            field: planned.field.as_ref().map(|f| f.report.clone()),
            support: planned.support.as_ref().map(|support| {
                // The volume is computed from the plan, whose roles distinguish supports from the part.
                let of_layer = |l: &grainpath_core::LayerPlan| -> f64 {
                    let paths = l.paths.iter().map(|p| &p.path);
                    paths
                        .filter(|p| matches!(p.role, Role::Support | Role::SupportInterface))
                        .map(|p| p.volume_mm3(l.height_mm))
                        .sum()
                };
                let volume = planned.plan.layers.iter().map(of_layer).sum::<f64>();
                // Paths have nominal volumes; the extruded volume is scaled by the flow.
                let material = &planned.config.material;
                let solid = support.volume_mm3(&planned.stack);
                SupportReport::new(support, Some(volume * material.flow), solid, material.density_g_cm3)
            }),
            stress: planned.guide.as_ref().map(StressReport::from),
            reserve: None,
            strength: None,
            fibre: None,
            stages_s: BTreeMap::new(),
            peak_rss_mb: 0.0,
            warnings: Vec::new(),
            outputs: BTreeMap::new(),
        }
    }

    /// The report as JSON.
    pub fn to_json(&self) -> Value {
        serde_json::to_value(self).unwrap_or(Value::Null)
    }

    /// The main results in a few lines, for the terminal.
    pub fn summary(&self) -> String {
        let mut lines = vec![format!(
            "{} layers to {} mm, {:.2} g, {:.1} m of filament, about {}",
            self.layers,
            self.z_max_mm,
            self.mass_g,
            self.filament_mm * 1e-3,
            hours(self.time_s)
        )];
        if let Some(q) = &self.quality {
            let percent = |v: f64| format!("{:.2} %", 100.0 * v);
            let spill = format!("spill {}", percent(q.spill));
            lines.push(if self.is_dense {
                format!("gap {}, overlap {}, {spill}", percent(q.gap), percent(q.overlap))
            } else {
                spill
            });
            if let (Some(mean), Some(p95)) = (q.alignment_mean_deg, q.alignment_p95_deg) {
                lines.push(format!(
                    "fill along the {}: {mean:.1} degrees off in the mean, {p95:.1} for 95 %",
                    if self.field.is_some() {
                        "given directions"
                    } else if self.grain.is_some() || self.texture.is_some() {
                        "grain"
                    } else {
                        "stress"
                    }
                ));
            }
        }
        if let Some(scan) = &self.scan {
            let [x, y, z] = scan.size_mm;
            lines.push(format!("the part of the scan: {x:.2} x {y:.2} x {z:.2} mm"));
        }
        if let Some(t) = &self.texture {
            lines.push(format!(
                "texture of {}: coherence {:.2} in the layers, clear in {:.0} %, leaning {:.0} degrees out of the layers in the mean",
                t.file, t.coherence, 100.0 * t.clear_share, t.lean_deg
            ));
        }
        if let Some(f) = &self.field {
            lines.push(format!(
                "directions: {} of {}, {}, in the frame of the {}",
                f.layout, f.format, f.directions, f.frame
            ));
        }
        lines.extend(
            self.stress.iter().flat_map(StressReport::rows).map(|(what, value)| format!("{what}: {value}")),
        );
        lines.extend(
            self.graded.iter().flat_map(LaidDensity::rows).map(|(what, value)| format!("{what}: {value}")),
        );
        lines.extend(
            self.reserve.iter().flat_map(ReserveReport::rows).map(|(what, value)| format!("{what}: {value}")),
        );
        lines.extend(self.fibre.as_ref().map(FibreReport::summary));
        lines.extend(self.strength.as_ref().map(StrengthReport::summary));
        if self.strength.is_some() && self.reserve.as_ref().is_some_and(|r| r.least.is_some()) {
            lines.push(
                "damage begins at the first failure; the load at which it breaks is the most that the part carries"
                    .to_owned(),
            );
        }
        lines.extend(self.support.iter().map(SupportReport::summary));
        if let Some(d) = &self.dimensions {
            lines.push(match d.mean_error_percent {
                Some(mean) => format!("{} dimensions, mean error {mean:.3} %", d.each.len()),
                None => format!("{} dimensions, none of them found on the beads", d.each.len()),
            });
        }
        lines.extend(self.warnings.iter().map(|w| format!("warning: {w}")));
        lines.extend(self.outputs.iter().map(|(what, path)| format!("{what}: {path}")));
        lines.join("\n")
    }
}

/// A duration in hours and minutes, or in minutes and seconds.
pub fn hours(seconds: f64) -> String {
    let s = seconds.round() as u64;
    if s >= 3600 {
        format!("{} h {} min", s / 3600, s / 60 % 60)
    } else {
        format!("{} min {} s", s / 60, s % 60)
    }
}

/// Compares the written G-code with the sections of the part from which it was planned.
pub fn measure(planned: &Planned, program: &Program) -> QualityReport {
    let shift = planned.plan.plate_from_part_mm.truncate();
    let layers = planned.stack.layers();
    let section = |z_mid: f64| {
        // A height on the border of two layers belongs to the lower one.
        let i = layers.partition_point(|l| l.z_top_mm() < z_mid);
        let layer = layers.get(i)?;
        let mut region: Region = layer.region().clone();
        for p in region
            .polygons
            .iter_mut()
            .flat_map(|p| std::iter::once(&mut p.outer).chain(&mut p.holes))
            .flatten()
        {
            // The program is in plate coordinates, the sections are in part coordinates.
            *p += shift;
        }
        Some(region)
    };
    // The cost is linear in the number of measured layers, so at most twelve are measured.
    let mut measured = quality(program, section, 12);
    // Layers without a bead are not in the program: all of their section is open.
    let empty = planned.empty_mm3() / planned.stack.volume_mm3().max(f64::MIN_POSITIVE);
    measured.gap += (1.0 - measured.gap) * empty;
    let mut report = QualityReport::from(measured);
    if let Some(off) = direction_error(planned) {
        // The angles are rounded to 0.01 degrees, the width of a bin in the histogram.
        let round = |deg: f64| (deg * 100.0).round() / 100.0;
        if let Some((mean, p95)) = alignment(&*off, program, shift) {
            (report.alignment_mean_deg, report.alignment_p95_deg) = (Some(round(mean)), Some(round(p95)));
        }
        report.stacked = stacked::count(&planned.plan.layers, &planned.stack);
    }
    report
}

/// Returns the function that compares a bead's direction with the guide of a plan; `None` without a
/// guide.
pub fn direction_error(planned: &Planned) -> Option<Box<DirectionError<'_>>> {
    let layers = planned.stack.layers();
    let (stress, grain, field) = (planned.guide.as_ref(), planned.grain.as_ref(), planned.field.as_ref());
    if stress.is_none() && grain.is_none() && field.is_none() {
        return None;
    }
    Some(Box::new(move |z_mid_mm: f64, [a, b]: [DVec2; 2]| {
        // A height on the border of two layers belongs to the lower one, as in `measure`.
        let i = layers.partition_point(|l| l.z_top_mm() < z_mid_mm);
        let d = b - a;
        if d == DVec2::ZERO || i >= layers.len() {
            return None;
        }
        let at = (0.5 * (a + b)).extend(z_mid_mm);
        // The direction is taken from the stress itself, not from the smoothed field that the beads follow.
        let asked = stress.map(|g| g.asked(i, at)).or_else(|| grain.map(|g| g.asked(at)));
        let (axis, weight) = asked.or_else(|| field.map(|f| f.asked(at)))?;
        // Axes have no sign, so the angle is folded into 0 to 90 degrees.
        let u = direction(axis);
        Some((atan2(cross(u, d).abs(), u.dot(d).abs()).to_degrees(), weight))
    }))
}

/// Measures the fibre of written G-code against the least turning radius of the job; `None` for
/// jobs without fibre.
pub fn measure_fibre(min_radius_mm: f64, planned: &Planned, program: &Program) -> Option<FibreReport> {
    let tool = planned.config.fibre.as_ref()?;
    let shift = planned.plan.plate_from_part_mm.truncate();
    let off = direction_error(planned);
    let density = tool.material.density_g_cm3;
    Some(crate::measure::laid_fibre::measure(program, shift, min_radius_mm, density, off.as_deref()))
}

/// Mean and 95th percentile of the angle in degrees between infill and the guide's direction; `None` where the guide has no
/// direction at any bead.
fn alignment(off: &DirectionError<'_>, program: &Program, plate_from_part_mm: DVec2) -> Option<(f64, f64)> {
    // A histogram with bins of 0.01 degrees gives the percentile precisely enough and needs little
    // memory.
    let mut bins = vec![0.0; 9001];
    let mut sum = 0.0;
    for layer in &program.layers {
        // Guides are read at mid-height of the layer, where its section was cut.
        let z_mid = layer.z_mm - 0.5 * layer.height_mm;
        for bead in layer.beads.iter().filter(|b| b.role.is_fill()) {
            let (a, b) = (bead.start() - plate_from_part_mm, bead.end() - plate_from_part_mm);
            let Some((off, weight)) = off(z_mid, [a, b]) else { continue };
            let length = a.distance(b);
            bins[(off * 100.0) as usize] += weight * length;
            sum += weight * length * off;
        }
    }
    let all: f64 = bins.iter().sum();
    let mut seen = 0.0;
    let p95 = bins.iter().position(|w| {
        seen += w;
        seen >= 0.95 * all
    });
    (all > 0.0).then(|| (sum / all, p95.unwrap_or(0) as f64 * 0.01))
}

#[cfg(test)]
mod tests {
    use super::in_words;

    #[test]
    fn layers_are_told_by_their_steps() {
        assert_eq!(in_words(&[4]), "layer 4");
        assert_eq!(in_words(&[1, 3]), "layers 1, 3");
        assert_eq!(in_words(&(1..=40).collect::<Vec<_>>()), "layers 1 to 40");
        assert_eq!(in_words(&(2..=40).step_by(2).collect::<Vec<_>>()), "layers 2, 4, ... 40");
        assert_eq!(in_words(&[1, 2, 3, 10, 13, 16]), "layers 1 to 3, 10, 13, 16");
        let two_of_three: Vec<usize> = (1..=30).filter(|i| i % 3 != 0).collect();
        assert_eq!(
            in_words(&two_of_three),
            "layers 1, 2, 4, 5, 7, 8, 10, 11, 13, 14, 16, 17, and on: 20 layers"
        );
    }
}
