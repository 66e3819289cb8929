//! Tree supports: overhangs and contacts ([`overhang`]), free space around the part ([`clearance`]), branches that join
//! ([`tree`]), their thickness ([`bending`]), their layers ([`cut`]), their beads ([`beads`]), interface lines below flat
//! overhangs ([`interface`]), contacts and lines below walls that these miss (`walls`), beads added to hold up others ([`held`]), and the supports as one closed surface ([`closed_surface`],
//! [`poisson`]).

pub mod bending;
pub mod baseline;
pub mod beads;
pub mod clearance;
pub mod contact;
pub mod cut;
pub mod held;
pub mod interface;
pub mod overhang;
pub mod poisson;
pub mod closed_surface;
mod spread;
pub mod tree;
pub(crate) mod walls;

use grainpath_core::buckets::PointGrid3;
use grainpath_core::diagnostics::{Interrupted, Stage};
use grainpath_core::spelling::counted;
use grainpath_core::tuned::Tuned;
use grainpath_core::{Bounds2, DVec3, Diagnostics, LayerStack, TriMesh, Warning, WarningId};
use grainpath_io::PaintedSupports;
use grainpath_job::choices::SupportSurface;

use beads::BeadSettings;
use bending::Bending;
use clearance::Clearance;
use contact::Contact;
use cut::{Layers, SupportLayer};
use overhang::{MidAir, Overhangs};
use tree::Forest;

use crate::wall::WallSettings;

/// Spacing of the sample points of an overhang, as a share of L. Measured: row `support.SAMPLE_SHARE` of `cargo xtask
/// bench constants`.
static SAMPLE_SHARE: Tuned<f64> = Tuned::new("support.SAMPLE_SHARE", 0.1);
/// The least and the greatest spacing of sample points, mm. Source: derived. At 0.2 mm two samples lie in a bead, and
/// more tell nothing new; at 1 mm the least overhang that is held by default, 0.8 mm wide, is missed by the grid at
/// times, and then gets a sample in its middle.
const SAMPLE_MM: [f64; 2] = [0.2, 1.0];

/// A box, lowest and highest corner, mm.
pub type Box3 = [DVec3; 2];

/// The kind of support under the overhangs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Branching trees.
    Tree,
    /// Straight walls under the overhangs, as a baseline.
    Columns,
    /// The box around every overhang, down to the plate, as a baseline.
    Box,
}

/// How supports are made; lengths in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct SupportSettings {
    /// The kind of support that is made.
    pub style: Style,
    /// Facets that lean more than this from the vertical need holding, radians.
    pub critical_angle_rad: f64,
    /// Branches lean at most by this from the vertical, radians.
    pub branch_angle_rad: f64,
    /// The longest stretch that prints without anything below (L): no overhang is further than half of it from a
    /// contact.
    pub max_unsupported_mm: f64,
    /// Groups of facets smaller than this in plan are left alone.
    pub min_overhang_mm: f64,
    /// Radius of a branch at its contact with the part.
    pub contact_radius_mm: f64,
    /// Length of the end piece that leaves the part along its normal.
    pub tip_length_mm: f64,
    /// Radius of the thinnest branch.
    pub branch_radius_mm: f64,
    /// Radius of a foot, and the thickest branch.
    pub base_radius_mm: f64,
    /// Height over which a trunk widens to its foot.
    pub base_height_mm: f64,
    /// Free height between support and part.
    pub z_gap_mm: f64,
    /// Free distance in plan between branches and part.
    pub xy_gap_mm: f64,
    /// Whether interface beads run from contact to contact below flat overhangs.
    pub interface_lines: bool,
    /// Number of dense layers below a contact.
    pub interface_layers: usize,
    /// Radius of these dense layers.
    pub interface_radius_mm: f64,
    /// Load that one contact puts on its branch, safety included, N.
    pub load_per_contact_n: f64,
    /// Drag of the nozzle on the tip of a branch, N.
    pub side_load_n: f64,
    /// Stiffness of the printed branch, MPa.
    pub stiffness_mpa: f64,
    /// Largest ratio of a branch's length to its diameter.
    pub max_slenderness: f64,
    /// The furthest a branch goes sideways to meet another.
    pub max_reach_mm: f64,
    /// How far branches may go beyond the part in plan.
    pub margin_mm: f64,
    /// Whether supports may stand on the plate only, not on the part.
    pub from_plate_only: bool,
    /// Boxes in which every downward-facing surface is supported.
    pub enforce: Vec<Box3>,
    /// Boxes in which nothing is supported, except where an enforcing box overlaps.
    pub block: Vec<Box3>,
    /// Facets of the mesh, as indices, that are supported whatever their angle.
    pub enforce_facets: Vec<u32>,
    /// Facets of the mesh, as indices, that are not supported.
    pub block_facets: Vec<u32>,
    /// Support enforcers and blockers painted on the part, in part coordinates.
    pub painted: PaintedSupports,
    /// Walls of the part, whose stretches over air are divided below flat overhangs and on which supports stand; the height is
    /// replaced by that of each layer.
    pub walls: WallSettings,
    /// How support is laid.
    pub beads: BeadSettings,
    /// Thickness of the first layer.
    pub first_layer_mm: f64,
    /// Where feet may stand, part coordinates; `None` for no limit.
    pub bed: Option<Bounds2>,
}

impl SupportSettings {
    /// Spacing of the grid on which contacts are placed: half the longest unsupported length.
    pub fn spacing_mm(&self) -> f64 {
        0.5 * self.max_unsupported_mm
    }

    /// Spacing of the sample points of an overhang.
    pub(crate) fn sample_mm(&self) -> f64 {
        (SAMPLE_SHARE.value() * self.max_unsupported_mm).clamp(SAMPLE_MM[0], SAMPLE_MM[1])
    }

    fn enforced(&self, p: DVec3) -> bool {
        self.enforce.iter().any(|b| holds(b, p))
    }

    fn blocked(&self, p: DVec3) -> bool {
        self.block.iter().any(|b| holds(b, p)) && !self.enforced(p)
    }
}

fn holds(b: &Box3, p: DVec3) -> bool {
    p.cmpge(b[0]).all() && p.cmple(b[1]).all()
}

/// An overhang that no support reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unreached {
    /// Position on the part, mm.
    pub at: DVec3,
    /// Its area in plan, mm2.
    pub area_mm2: f64,
}

/// The supports of a part.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Support {
    /// The overhangs, and the contacts that hold them.
    pub overhangs: Overhangs,
    /// The trees; none for the baselines.
    pub forest: Forest,
    /// The supports as layers.
    pub cut: Layers,
    /// Overhangs that no support reaches.
    pub unreached: Vec<Unreached>,
    /// How far tips move under the drag of the nozzle.
    pub bending: Bending,
    /// Number of contacts so near the plate that there is no room for support below them.
    pub near_plate: usize,
}

impl Support {
    /// Volume of all layers, mm3, as if they were dense.
    pub fn volume_mm3(&self, stack: &LayerStack) -> f64 {
        let layer_mm3 = |(s, l): (&SupportLayer, &grainpath_core::Layer)| s.region.area_mm2() * l.height_mm();
        // The sum of no layers is -0 in Rust.
        self.cut.layers.iter().zip(stack.layers()).map(layer_mm3).fold(0.0, |sum, v| sum + v)
    }

    /// Volume of the beads of trees, mm3; `None` for the baselines, whose beads are laid together with the part's.
    pub fn beads_mm3(&self, stack: &LayerStack) -> Option<f64> {
        let mut volume = 0.0;
        for (layer, part) in self.cut.layers.iter().zip(stack.layers()) {
            for island in layer.islands.as_ref()? {
                let paths = island.walls.iter().map(|w| &w.path).chain(&island.fills);
                volume += paths.map(|p| p.volume_mm3(part.height_mm())).sum::<f64>();
            }
        }
        Some(volume)
    }

    /// The largest distance of a sample of an overhang from its nearest contact, mm. Samples whose nearest contact is not
    /// held are left out.
    pub fn farthest_mm(&self) -> f64 {
        let mut index = PointGrid3::new(5.0);
        let key = |p: DVec3| p.to_array().map(f64::to_bits);
        let lost: std::collections::BTreeSet<[u64; 3]> = self.unreached.iter().map(|u| key(u.at)).collect();
        for (i, c) in self.overhangs.contacts.iter().enumerate() {
            index.insert(c.at, i);
        }
        let mut farthest: f64 = 0.0;
        for s in &self.overhangs.samples {
            // Nearly all samples have a contact near; only the others need a wide search.
            let near = [5.0, 20.0, 100.0].into_iter().find_map(|r| index.nearest_within(s.at, r));
            if let Some(i) = near {
                let c = self.overhangs.contacts[i].at;
                if !lost.contains(&key(c)) {
                    farthest = farthest.max(c.distance(s.at));
                }
            }
        }
        farthest
    }

    /// Number of contacts that are held.
    pub fn n_contacts(&self) -> usize {
        self.overhangs.contacts.len() - self.unreached.len() - self.near_plate
    }
}

/// Finds overhangs and grows supports under them.
///
/// # Errors
/// [`Interrupted`] when a stop was asked for.
pub fn plan(
    mesh: &TriMesh,
    stack: &LayerStack,
    settings: &SupportSettings,
    diagnostics: &Diagnostics,
) -> Result<Support, Interrupted> {
    diagnostics.begin(Stage::Support, 4);
    let mut overhangs = overhang::find(mesh, stack, settings);
    if settings.interface_lines {
        if settings.style == Style::Tree {
            walls::hold(&mut overhangs, mesh, stack, settings);
        }
        interface::lengthen_tips(&mut overhangs.contacts, &overhangs.lines, stack, settings);
    }
    overhang::hold_mid_air(&mut overhangs, stack, settings);
    diagnostics.check()?;
    diagnostics.advance(1);
    if overhangs.contacts.is_empty() {
        diagnostics
            .warn(WarningId::SupportNone, "support: no overhang exceeds the critical angle; none is made");
        let layers = vec![SupportLayer::default(); stack.layers().len()];
        return Ok(Support { overhangs, cut: Layers { layers, ..Layers::default() }, ..Support::default() });
    }
    if settings.style != Style::Tree {
        let cut = baseline::layers(&overhangs, stack, settings);
        return Ok(Support { overhangs, cut, ..Support::default() });
    }
    let bed = settings.bed.unwrap_or(Bounds2 {
        min: grainpath_core::DVec2::splat(-1e5),
        max: grainpath_core::DVec2::splat(1e5),
    });
    let keep = settings.branch_radius_mm + settings.xy_gap_mm;
    let clearance = Clearance::new(stack, bed, settings.margin_mm, keep, settings.branch_angle_rad);
    diagnostics.check()?;
    diagnostics.advance(1);
    let mut forest = tree::grow(&overhangs.contacts, &clearance, settings);
    bending::stiffen(&mut forest, &clearance, settings);
    diagnostics.check()?;
    diagnostics.advance(1);
    let mut cut = cut::cut(&forest, &overhangs.contacts, stack, &clearance, settings);
    held::stand(&mut cut, &forest, &overhangs, stack, settings);
    diagnostics.advance(1);
    let bending = bending::tip_bending(&forest, &clearance, settings);
    let mut support = Support { overhangs, forest, cut, bending, ..Support::default() };
    support.tell(stack, settings, diagnostics);
    Ok(support)
}

/// Warns of a part without support that begins in mid-air.
pub fn warn_of_mid_air(stack: &LayerStack, diagnostics: &Diagnostics) {
    let all = overhang::mid_air(stack, |_| false);
    let area = |m: &MidAir| m.polygon.area_mm2();
    let Some(largest) = all.iter().max_by(|a, b| area(a).total_cmp(&area(b))) else { return };
    let layer = &stack.layers()[largest.layer_idx];
    let z_mm = layer.z_top_mm() - layer.height_mm();
    let places = if all.len() == 1 { "1 place".into() } else { format!("{} places", all.len()) };
    let text = format!(
        "the part begins in mid-air in {places}, and there is no support; the largest piece has {:.2} mm2 at a height of \
         {z_mm:.2} mm",
        area(largest)
    );
    let at = overhang::inner_point(&largest.polygon).extend(z_mm);
    let warning = Warning::new(WarningId::PartInMidAir, text).in_layer(largest.layer_idx, layer.z_top_mm());
    diagnostics.push(warning.at_point_mm(at));
}

/// The surface of support layers, by the method of `support.solid`.
///
/// # Errors
/// [`Interrupted`] when a stop was asked for.
pub fn surface(
    layers: &[SupportLayer],
    stack: &LayerStack,
    method: SupportSurface,
    diagnostics: &Diagnostics,
) -> Result<TriMesh, Interrupted> {
    let settings = closed_surface::SolidSettings::default();
    match method {
        SupportSurface::Poisson => poisson::poisson(layers, stack, settings.cell_mm, diagnostics),
        SupportSurface::Distance => closed_surface::solid(layers, stack, &settings, diagnostics),
    }
}

impl Support {
    /// Finds the contacts that are not held, and warns of them and of tips that move too far.
    fn tell(&mut self, stack: &LayerStack, settings: &SupportSettings, diagnostics: &Diagnostics) {
        let heights = cut::Heights::new(stack);
        let mut missing: Vec<u32> = self.forest.unreached.iter().chain(&self.cut.lost).copied().collect();
        missing.sort_unstable();
        for i in missing {
            let c: &Contact = &self.overhangs.contacts[i as usize];
            if heights.end_below(c.at.z, settings.z_gap_mm) == 0 {
                self.near_plate += 1;
            } else {
                self.unreached.push(Unreached { at: c.at, area_mm2: c.area_mm2 });
            }
        }
        if self.bending.over > 0 {
            let Bending { worst_mm, at, over } = self.bending;
            let text = format!(
                "support: {} bent by more than {:.2} mm under a side load of {} N during the print, \
                 the furthest by {worst_mm:.2} mm",
                counted(over, "tip"),
                settings.tip_moves_at_most_mm(),
                settings.side_load_n,
            );
            diagnostics.push(Warning::new(WarningId::SupportBends, text).at_point_mm(at));
        }
        for u in self.unreached.iter().take(20) {
            let text = format!("support: no way to the overhang of about {:.1} mm2", u.area_mm2);
            diagnostics.push(Warning::new(WarningId::SupportUnreached, text).at_point_mm(u.at));
        }
        if self.unreached.len() > 20 {
            let more = self.unreached.len() - 20;
            let text = format!("support: no way to {more} more overhangs; the report lists all");
            diagnostics.warn(WarningId::SupportUnreached, text);
        }
    }
}
