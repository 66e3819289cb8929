//! Properties of printer and material and the speeds, as the writer needs them. They are plain numbers;
//! the planner decides where they come from.

use grainpath_core::{Role, SpeedClass};

use crate::kinematics::Limits;

/// The G-code dialect of a firmware.
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
    /// Dialect of the firmware.
    pub flavour: Flavour,
    /// Diameter of the nozzle, mm.
    pub nozzle_mm: f64,
    /// Diameter of the filament, mm.
    pub filament_mm: f64,
    /// Build volume: x, y, z, mm.
    pub bed_mm: [f64; 3],
    /// Whether x = y = 0 is the middle of the bed; else its front left corner.
    pub origin_at_centre: bool,
    /// Limits of the axes.
    pub limits: Limits,
    /// Whether E words are distances (M83); else positions (M82).
    pub relative_e: bool,
    /// Program before the print, with `{placeholders}`.
    pub start_gcode: String,
    /// Program after the print, with `{placeholders}`.
    pub end_gcode: String,
}

impl Machine {
    /// Lowest and highest point in x and y that a nozzle can reach.
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
    /// Highest speed of everything printed in the first layer.
    pub first_layer: f64,
}

impl Speeds {
    /// The speed of a path: that of its role, limited by its class and by the first layer.
    pub fn speed_mm_s(&self, role: Role, class: SpeedClass, first_layer: bool) -> f64 {
        let by_role = match role {
            Role::OuterWall => self.outer_wall,
            Role::InnerWall => self.inner_wall,
            Role::ThinWall => self.outer_wall,
            Role::GapFill => self.gap_fill,
            Role::SolidFill | Role::SeedLine => self.solid,
            Role::TopSkin => self.top,
            Role::SparseFill => self.sparse,
            Role::Fibre => self.fibre,
            Role::Bridge => self.bridge,
            Role::Skirt | Role::Brim => self.adhesion,
            Role::Support => self.support,
            Role::SupportInterface => self.support_interface,
        };
        // A class only slows down: a support over air must not become faster because bridges are fast.
        let speed = match class {
            SpeedClass::Normal => by_role,
            SpeedClass::SmallWall => by_role.min(self.small_wall),
            SpeedClass::Overhang => by_role.min(self.overhang),
            SpeedClass::Bridge => by_role.min(self.bridge),
        };
        if first_layer { speed.min(self.first_layer) } else { speed }
    }
}

/// Fan speeds and layer times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cooling {
    /// Fan speed in layers that take long, 0 to 1.
    pub fan_min: f64,
    /// Fan speed in layers that take a short time, 0 to 1.
    pub fan_max: f64,
    /// Fan speed while beads are laid over air, 0 to 1.
    pub fan_bridge: f64,
    /// Lowest fan speed while support is printed.
    pub fan_support: f64,
    /// Number of layers above the bed that are printed without fan.
    pub fan_off_layers: usize,
    /// Layers that take less time are slowed down, s.
    pub min_layer_time_s: f64,
    /// In layers that take less time than this, s, the fan runs faster than its lowest speed.
    pub fan_below_layer_time_s: f64,
    /// Layers are not slowed down below this speed, mm/s.
    pub min_speed_mm_s: f64,
}

/// Retraction of the filament for travel moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Retraction {
    /// Length of filament that is retracted, mm; 0 for no retraction.
    pub length_mm: f64,
    /// Speed of the retraction, mm/s.
    pub speed_mm_s: f64,
    /// Speed of the unretraction, mm/s.
    pub unretract_speed_mm_s: f64,
    /// Lift of the nozzle between retraction and unretraction, mm.
    pub z_hop_mm: f64,
}

/// Properties of a material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name, for the header of the program.
    pub name: String,
    /// g/cm3.
    pub density_g_cm3: f64,
    /// Nozzle temperature, degC.
    pub nozzle_temp_c: f64,
    /// Nozzle temperature in the first layer, degC.
    pub first_layer_nozzle_temp_c: f64,
    /// Bed temperature, degC.
    pub bed_temp_c: f64,
    /// Bed temperature in the first layer, degC.
    pub first_layer_bed_temp_c: f64,
    /// Factor on all extrusion.
    pub flow: f64,
    /// Pressure or linear advance, in the firmware's unit.
    pub pressure_advance: Option<f64>,
    /// Highest volume flow that the hot end can melt, mm3/s.
    pub max_volumetric_mm3_s: f64,
}

/// A tool for continuous fibre and its material.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreTool {
    /// Number of the tool where fibre has a nozzle of its own; the matrix is tool 0. `None` where fibre
    /// and matrix share one nozzle.
    pub tool: Option<usize>,
    /// G-code that changes to `{tool}`.
    pub tool_change_gcode: String,
    /// G-code that feeds fibre from the cutter to the nozzle at the beginning of a path.
    pub feed_gcode: String,
    /// G-code that cuts the fibre.
    pub cut_gcode: String,
    /// Length of fibre between cutter and nozzle, mm. The fibre is cut at this distance before the end of
    /// a path.
    pub cutter_mm: f64,
    /// Length at the beginning of a path that is laid slowly so that it sticks, mm.
    pub anchor_mm: f64,
    /// Speed over that length, mm/s.
    pub anchor_speed_mm_s: f64,
    /// Diameter of the filament that the tool is fed with, mm.
    pub filament_mm: f64,
    /// Material of the fibre.
    pub material: Material,
}
