//! What the writer needs to know of printer, material and speeds. Plain numbers; where they come from is the
//! planner's business.

use grainpath_core::{Role, SpeedClass};

use crate::kinematics::Limits;

/// The dialect a firmware speaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Flavour {
    /// Marlin and most others.
    #[default]
    Marlin,
    /// Klipper.
    Klipper,
    /// RepRapFirmware.
    RepRapFirmware,
}

/// A printer.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// What its firmware understands.
    pub flavour: Flavour,
    /// Diameter of the nozzle, mm.
    pub nozzle_mm: f64,
    /// Diameter of the filament, mm.
    pub filament_mm: f64,
    /// Room for a print: x, y, z, mm.
    pub bed_mm: [f64; 3],
    /// Whether x = y = 0 is the middle of the bed; else its front left corner.
    pub origin_at_centre: bool,
    /// What the axes can do.
    pub limits: Limits,
    /// Whether E words are distances (M83); else positions (M82).
    pub relative_e: bool,
    /// Program before the print, with `{placeholders}`.
    pub start_gcode: String,
    /// Program after the print, with `{placeholders}`.
    pub end_gcode: String,
}

impl Machine {
    /// Lowest and highest corner a nozzle may reach, x and y.
    pub fn bed_bounds_mm(&self) -> ([f64; 2], [f64; 2]) {
        let [x, y, _] = self.bed_mm;
        if self.origin_at_centre { ([-0.5 * x, -0.5 * y], [0.5 * x, 0.5 * y]) } else { ([0.0; 2], [x, y]) }
    }
}

/// Speeds, mm/s.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub struct Speeds {
    pub outer_wall: f64,
    pub inner_wall: f64,
    pub small_wall: f64,
    pub overhang: f64,
    pub gap_fill: f64,
    pub solid: f64,
    pub top: f64,
    pub sparse: f64,
    pub bridge: f64,
    pub fibre: f64,
    pub support: f64,
    pub support_interface: f64,
    pub adhesion: f64,
    pub travel: f64,
    pub travel_z: f64,
    /// Everything printed in the first layer is no faster than this.
    pub first_layer: f64,
}

impl Speeds {
    /// The speed of a path.
    pub fn of(&self, role: Role, class: SpeedClass, first_layer: bool) -> f64 {
        let by_role = match role {
            Role::OuterWall => self.outer_wall,
            Role::InnerWall => self.inner_wall,
            Role::ThinWall => self.outer_wall,
            Role::GapFill => self.gap_fill,
            Role::SolidFill => self.solid,
            Role::TopSkin => self.top,
            Role::SparseFill => self.sparse,
            Role::Fibre => self.fibre,
            Role::Bridge => self.bridge,
            Role::Skirt | Role::Brim => self.adhesion,
            Role::Support => self.support,
            Role::SupportInterface => self.support_interface,
        };
        let speed = match class {
            SpeedClass::Normal => by_role,
            SpeedClass::SmallWall => by_role.min(self.small_wall),
            SpeedClass::Overhang => by_role.min(self.overhang),
            SpeedClass::Bridge => by_role.min(self.bridge),
        };
        if first_layer { speed.min(self.first_layer) } else { speed }
    }
}

/// Fan and layer time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cooling {
    /// Fan where a layer takes long, 0 to 1.
    pub fan_min: f64,
    /// Fan where it is short.
    pub fan_max: f64,
    /// Fan over air.
    pub fan_bridge: f64,
    /// Least fan while support is printed.
    pub fan_support: f64,
    /// Layers from the plate without fan.
    pub fan_off_layers: usize,
    /// Layers faster than this are slowed down, s.
    pub min_layer_time_s: f64,
    /// Layers faster than this get more than the least fan, s.
    pub fan_below_layer_time_s: f64,
    /// Slowing down ends here, mm/s.
    pub min_speed_mm_s: f64,
}

/// Drawing the filament back for travels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Retraction {
    /// How far, mm of filament; 0 for never.
    pub length_mm: f64,
    /// How fast back, mm/s.
    pub speed_mm_s: f64,
    /// How fast forward again, mm/s.
    pub unretract_speed_mm_s: f64,
    /// The nozzle is lifted by this for it, mm.
    pub z_hop_mm: f64,
}

/// What is printed with.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Its name, for the header.
    pub name: String,
    /// g/cm3.
    pub density_g_cm3: f64,
    /// Nozzle, degC.
    pub nozzle_temp_c: f64,
    /// Nozzle in the first layer, degC.
    pub first_layer_nozzle_temp_c: f64,
    /// Bed, degC.
    pub bed_temp_c: f64,
    /// Bed in the first layer, degC.
    pub first_layer_bed_temp_c: f64,
    /// Factor on all extrusion.
    pub flow: f64,
    /// Pressure or linear advance, in the firmware's unit.
    pub pressure_advance: Option<f64>,
    /// The most that melts, mm3/s.
    pub max_volumetric_mm3_s: f64,
}

/// A tool that lays continuous fibre, and what it lays.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreTool {
    /// The tool's number where fibre has a nozzle of its own; the other is 0. `None` where fibre joins the matrix in
    /// one nozzle.
    pub tool: Option<usize>,
    /// Program that changes to `{tool}`.
    pub tool_change_gcode: String,
    /// Program that brings the fibre from the cutter to the nozzle, where a path begins.
    pub feed_gcode: String,
    /// Program that cuts.
    pub cut_gcode: String,
    /// Length of fibre between cutter and nozzle, mm: it is cut so much before a path's end.
    pub cutter_mm: f64,
    /// The first of a path sticks to what is below while this much is laid, mm.
    pub anchor_mm: f64,
    /// Speed for that, mm/s.
    pub anchor_speed_mm_s: f64,
    /// Diameter of what the tool is fed with, mm.
    pub filament_mm: f64,
    /// What is laid.
    pub material: Material,
}
