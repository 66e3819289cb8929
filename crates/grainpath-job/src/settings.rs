//! Every setting, declared once as a row.
//!
//! A row holds key, type, default, unit, range and help text. The structs below, the parser, the JSON Schema and the
//! reference page are made from the rows. A row with a choice of words has an enum of [`crate::choices`] as its type.

use std::collections::BTreeMap;

use grainpath_core::slices::SampleType;
use grainpath_core::units::LengthUnit;
use grainpath_core::{Density, Warning};
use toml::Value;

use super::fill_density::FillDensity;
use super::layer_angles::LayerAngles;
use super::loads::{Case, Fixture, Load};
use super::profiles::KINDS;
use super::regions::JobRegion;
use super::value::{Check, Pair, Param, SettingValue, ValueError, read};
use super::wall_count::WallCount;
use crate::choices::{
    Analysis, BeadEnds, BeadWidths, BedOrigin, Bend, BoardCorners, ByteOrder, CaseMix, CellTree,
    ComponentOrder, Contours, CurveJoin, Denoise, Elasticity, FibreStart, FibreToolKind, FibreTurns,
    Fidelity, FieldAngleUnit, FieldAxes, FieldFrame, FileUnit, Flavour, Flip, Follow, GrainMode, GuideKind,
    Interpolate, LayerShift, LoadFrame, OutlineRule, Pattern, Repair, Seam, StrengthTier, StressUnit,
    SupportStyle, SupportSurface, Threshold, WallOrder,
};
use Check::{Any, Range};

/// Declares the sections: a struct with the defaults, the rows, and the function that sets a single key.
macro_rules! sections {
    ($( $(#[$about:meta])* $section:ident $name:literal {
        $( $key:ident : $type:ty = $default:expr, $unit:literal, $check:expr, $help:literal; )*
    } )*) => {
        $(
            $(#[$about])*
            #[derive(Debug, Clone, PartialEq)]
            pub struct $section {
                $( #[doc = $help] pub $key: $type, )*
            }

            impl Default for $section {
                fn default() -> Self {
                    Self { $( $key: $default, )* }
                }
            }

            impl $section {
                /// Sets one key. `None` if there is no such key.
                pub(super) fn set(&mut self, key: &str, value: &Value) -> Option<Result<(), ValueError>> {
                    match key {
                        $( stringify!($key) => Some(read::<$type>(value, $check).map(|v| self.$key = v)), )*
                        _ => None,
                    }
                }

                pub(super) fn params() -> Vec<Param> {
                    let defaults = Self::default();
                    vec![ $( Param {
                        section: $name,
                        key: stringify!($key),
                        unit: $unit,
                        kind: <$type as SettingValue>::KIND,
                        default: defaults.$key.to_text(),
                        check: $check,
                        words: <$type as SettingValue>::WORDS,
                        help: $help,
                        schema: <$type as SettingValue>::schema(),
                    }, )* ]
                }

                /// Keys and their present values, for reports.
                pub fn rows(&self) -> Vec<(String, String)> {
                    vec![ $( (format!("{}.{}", $name, stringify!($key)), self.$key.to_text()), )* ]
                }
            }
        )*
    };
}

sections! {
    /// The shape to print.
    ShapeSection "shape" {
        mesh: String = String::new(), "", Any, "Mesh to print: an STL, OBJ, PLY, OFF or 3MF file.";
        outline: String = String::new(), "", Any, "Drawing of a flat part, printed instead of a mesh: an SVG or ASCII DXF file.";
        // 0 means that no thickness is given. The module `combinations` refuses it where a thickness is needed.
        thickness_mm: f64 = 0.0, "mm", Range(0.0, 1e4), "Thickness of a part that is printed from an outline.";
        outline_rule: OutlineRule = OutlineRule::File, "", Any, "What counts as material in a drawing.";
        unit: FileUnit = FileUnit(None), "", Any, "Unit of the mesh or drawing.";
        scale: f64 = 1.0, "", Range(1e-6, 1e6), "Factor on all lengths of the file.";
        rotate_deg: [f64; 3] = [0.0; 3], "deg", Range(-3600.0, 3600.0), "Rotations about the X, Y and Z axis, made in this order.";
        position_mm: Option<[f64; 2]> = None, "mm", Range(-1e5, 1e5), "Position of the part's centre on the bed; unset: the centre of the bed.";
        repair: Repair = Repair::Auto, "", Any, "What happens to defects of the mesh.";
        // Wide enough for the cracks of meshes whose faces do not quite meet, and far below the gap
        // between two walls.
        gap_closing_mm: f64 = 0.05, "mm", Range(0.0, 100.0), "In sections with more than 200 open contours, a contour whose ends are at most this far apart is closed on itself. All other gaps are closed whatever their width, the nearest ends first, and their number and width are reported.";
    }
    /// A board to print from one or more photographs of it.
    PhotoSection "shape.photo" {
        files: Vec<String> = Vec::new(), "", Any, "Photographs of the board (PNG, JPEG, TIFF or BMP), lowest layer first. One is enough.";
        corners: BoardCorners = BoardCorners::Image, "", Any, "How the board is found in a photograph.";
        corners_px: Vec<[f64; 2]> = Vec::new(), "px", Range(-1e6, 1e6), "Corners of the board in the image: upper left, upper right, lower right, lower left, measured from the image's upper left corner. Give four points for all files together, or four for each file. Replaces `corners`.";
        size_mm: [f64; 2] = [0.0; 2], "mm", Range(0.0, 1e4), "Width and height of the board between its corners.";
        thickness_mm: f64 = 0.0, "mm", Range(0.0, 1e4), "Thickness of the board.";
        heights_mm: Vec<f64> = Vec::new(), "mm", Range(0.0, 1e4), "Height in the board that each file shows, in rising order. Unset: a single file shows the bottom, several files are spread evenly over the thickness.";
        shift_mm_per_mm: [f64; 2] = [0.0; 2], "", Range(-20.0, 20.0), "Shift of grain and holes in x and y for each millimetre of height: the inclination of a knot.";
        holes_mm: Vec<[f64; 3]> = Vec::new(), "mm", Range(-1e4, 1e4), "Round holes at the height of the first file, as x, y and radius. They are inclined like the grain.";
    }
    /// A CT scan to print.
    CtSection "shape.ct" {
        path: String = String::new(), "", Any, "Scan to print: a folder or ZIP of PNG, TIFF, BMP, JPEG or DICOM slices, a multi-page TIFF, a NRRD, MHD or NIfTI file, a Zarr or OME-Zarr folder (its finest level, or the one that the path names, as in scan.ome.zarr/1), or raw data.";
        pixel_mm: Option<Pair> = None, "mm", Range(1e-7, 1e4), "Size of a pixel, one number or [x, y]; unset: as the file states.";
        slice_mm: Option<f64> = None, "mm", Range(1e-7, 1e4), "Distance between slices; unset: as the file states.";
        window: Option<[usize; 2]> = None, "", Range(0.0, 1e6), "First and last slice to use, counted from 0; unset: all.";
        crop_px: Option<[usize; 4]> = None, "px", Range(0.0, 1e6), "First column, first row, last column and last row to use, counted from 0; unset: all.";
        flip: Flip = Flip::None, "", Any, "Axes along which the scan is mirrored; empty: none.";
        threshold: Threshold = Threshold::Otsu, "", Any, "Grey value at which the part begins: otsu (from the histogram), iso50 (halfway between two materials), a number, or [low, high].";
        materials: Option<[f64; 2]> = None, "", Any, "Grey values of the two materials for threshold = \"iso50\"; unset: the commonest value on either side of Otsu's threshold.";
        smooth: Denoise = Denoise::None, "", Any, "Noise filter of the slices.";
        smooth_px: f64 = 0.7, "px", Range(0.0, 20.0), "Standard deviation of the blur for smooth = \"gaussian\".";
        // About the area of a bead 0.45 mm wide and 0.45 mm long: smaller islands cannot be printed.
        min_island_mm2: f64 = 0.2, "mm2", Range(0.0, 1e6), "Islands of a section that are smaller than this are removed and counted.";
        min_piece_mm3: f64 = 0.0, "mm3", Range(0.0, 1e9), "Loose pieces of the part with less volume than this are removed and counted; 0 keeps all.";
        min_pore_mm2: f64 = 0.1, "mm2", Range(0.0, 1e6), "Holes of a section that are smaller than this are filled and counted.";
        interpolate: Interpolate = Interpolate::Auto, "", Any, "How the contours of layers between two slices are found.";
        overlap: f64 = 0.2, "", Range(0.0, 1.0), "Two contours of neighbouring slices are matched if they overlap by at least this fraction of their area.";
        contours: Contours = Contours::Iso, "", Any, "How contours are found in a slice.";
        // The thresholds are fractions of the step from air to material, so they suit scans of any grey scale.
        canny_low: f64 = 0.04, "", Range(0.0, 1.0), "Lower threshold of the Canny filter, as a fraction of the step from air to material: edges are followed down to this gradient per pixel.";
        canny_high: f64 = 0.1, "", Range(0.0, 1.0), "Upper threshold of the Canny filter, as a fraction of the same step: edges start above this gradient per pixel.";
        canny_sigma_px: f64 = 1.0, "px", Range(0.0, 10.0), "Standard deviation of the blur before the Canny filter.";
        truth: String = String::new(), "", Any, "File of known dimensions (TOML); the report compares them with the printed ones. Empty: no comparison.";
        size_px: Option<[usize; 3]> = None, "", Range(1.0, 1e6), "Number of columns, rows and slices of raw data.";
        sample: SampleType = SampleType::U8, "", Any, "Number type of a voxel in raw data.";
        byte_order: ByteOrder = ByteOrder::Little, "", Any, "Byte order of raw data.";
        offset_bytes: usize = 0, "", Range(0.0, 1e12), "Number of bytes before the first voxel in raw data.";
        outside_folder: bool = false, "", Any, "Whether the header of an NRRD or MHD file may name a data file outside its own folder, or a link that leads there.";
    }
    /// The printer.
    PrinterSection "printer" {
        nozzle_mm: f64 = 0.4, "mm", Range(0.05, 5.0), "Diameter of the nozzle's opening.";
        bed_mm: [f64; 3] = [220.0, 220.0, 250.0], "mm", Range(1.0, 10000.0), "Printable size in x, y and z.";
        origin: BedOrigin = BedOrigin::Corner, "", Any, "Position of the machine's origin.";
        flavour: Flavour = Flavour::Marlin, "", Any, "Firmware that the G-code is written for.";
        filament_mm: f64 = 1.75, "mm", Range(0.5, 5.0), "Diameter of the filament.";
        max_speed_mm_s: [f64; 4] = [300.0, 300.0, 12.0, 60.0], "mm/s", Range(0.1, 5000.0), "Highest speed of the axes x, y and z and of the extruder.";
        acceleration_mm_s2: f64 = 1500.0, "mm/s2", Range(1.0, 100000.0), "Acceleration while printing.";
        travel_acceleration_mm_s2: f64 = 2000.0, "mm/s2", Range(1.0, 100000.0), "Acceleration of travel moves.";
        retract_acceleration_mm_s2: f64 = 2000.0, "mm/s2", Range(1.0, 100000.0), "Acceleration of moves of the extruder alone.";
        // Firmware limits the speed at corners by one of three models: jerk, or one of the next two, which replace it
        // where they are set.
        jerk_mm_s: [f64; 4] = [8.0, 8.0, 0.4, 4.0], "mm/s", Range(0.0, 100.0), "Speed change allowed at corners without slowing down, for x, y, z and the extruder.";
        square_corner_mm_s: Option<f64> = None, "mm/s", Range(0.0, 100.0), "Klipper's square_corner_velocity: speed at a right angle. Replaces jerk where it is set.";
        junction_deviation_mm: Option<f64> = None, "mm", Range(0.0, 1.0), "Marlin's junction deviation. Replaces jerk where it is set.";
        // Relative E needs no resets, and lines of G-code can be moved. Some old firmware needs absolute E.
        relative_e: bool = true, "", Any, "true: E words are distances (M83); false: positions (M82).";
        retract_mm: f64 = 0.8, "mm", Range(0.0, 20.0), "Length of filament that is retracted before a travel move that leaves the part.";
        retract_speed_mm_s: f64 = 35.0, "mm/s", Range(0.1, 500.0), "Speed of retraction.";
        unretract_speed_mm_s: f64 = 35.0, "mm/s", Range(0.1, 500.0), "Speed at which retracted filament is pushed back.";
        z_hop_mm: f64 = 0.0, "mm", Range(0.0, 10.0), "Height by which the nozzle is lifted for a travel move with retraction.";
        fibre_tool: FibreToolKind = FibreToolKind::None, "", Any, "Tool for continuous fibre.";
        fibre_tool_number: usize = 1, "", Range(0.0, 99.0), "Number of the fibre's tool for fibre_tool = \"separate\"; the matrix is tool 0.";
        fibre_cutter_mm: f64 = 40.0, "mm", Range(0.0, 1000.0), "Length of fibre between cutter and nozzle. The fibre is cut this far before the end of a path.";
        fibre_filament_mm: Option<f64> = None, "mm", Range(0.05, 5.0), "Diameter of the filament fed to the fibre's tool; unset: filament_mm.";
        fibre_feed_gcode: String = String::new(), "", Any, "G-code that feeds fibre from the cutter to the nozzle at the beginning of a path, with `{placeholders}` as in docs/gcode.md.";
        fibre_cut_gcode: String = String::new(), "", Any, "G-code that cuts the fibre.";
        tool_change_gcode: String = "T{tool}".into(), "", Any, "G-code that changes to `{tool}`, for fibre_tool = \"separate\".";
        thumbnails_px: Vec<[usize; 2]> = Vec::new(), "px", Range(8.0, 2000.0), "Widths and heights of the thumbnails in the G-code.";
        // Bed first, since it takes longest; homing while it heats; then wait for both.
        start_gcode: String = "M140 S{first_layer_bed_temp_c}\nM104 S{first_layer_nozzle_temp_c}\nG28\nM190 S{first_layer_bed_temp_c}\nM109 S{first_layer_nozzle_temp_c}".into(), "", Any, "G-code before the print, with `{placeholders}` as in docs/gcode.md.";
        end_gcode: String = "M104 S0\nM140 S0\nG1 Z{z_park_mm} F600\nG28 X\nM84".into(), "", Any, "G-code after the print.";
    }
    /// The material.
    MaterialSection "material" {
        name: String = "PLA".into(), "", Any, "Name of the material in reports and in the G-code.";
        density_g_cm3: f64 = 1.24, "g/cm3", Range(0.1, 25.0), "Mass density.";
        nozzle_temp_c: f64 = 205.0, "degC", Range(0.0, 600.0), "Nozzle temperature.";
        first_layer_nozzle_temp_c: f64 = 210.0, "degC", Range(0.0, 600.0), "Nozzle temperature in the first layer.";
        bed_temp_c: f64 = 55.0, "degC", Range(0.0, 300.0), "Bed temperature.";
        first_layer_bed_temp_c: f64 = 60.0, "degC", Range(0.0, 300.0), "Bed temperature in the first layer.";
        flow: f64 = 1.0, "", Range(0.1, 3.0), "Factor on all extrusion.";
        pressure_advance: Option<f64> = None, "", Range(0.0, 10.0), "Linear advance or pressure advance, in the firmware's unit; unset: the firmware's own value.";
        max_volumetric_mm3_s: f64 = 15.0, "mm3/s", Range(0.1, 500.0), "Highest volume flow that the nozzle melts; faster moves are slowed down to it.";
        fan_min: f64 = 0.6, "", Range(0.0, 1.0), "Fan speed in layers that take longer than fan_below_layer_time_s.";
        fan_max: f64 = 1.0, "", Range(0.0, 1.0), "Fan speed in layers that take min_layer_time_s or less.";
        fan_bridge: f64 = 1.0, "", Range(0.0, 1.0), "Fan speed for bridges.";
        fan_off_layers: usize = 1, "", Range(0.0, 1e6), "Number of layers above the bed that are printed without fan.";
        min_layer_time_s: f64 = 8.0, "s", Range(0.0, 1000.0), "Layers that take less time than this are slowed down.";
        fan_below_layer_time_s: f64 = 20.0, "s", Range(0.0, 1000.0), "Below this layer time the fan speed rises from fan_min to fan_max.";
        min_speed_mm_s: f64 = 10.0, "mm/s", Range(0.1, 1000.0), "Layers are not slowed down below this speed.";
        // Source: the row `elastic_source`; the constants are those of printed PLA, not of the filament.
        e_mpa: [f64; 3] = [2669.0, 2583.0, 2208.0], "MPa", Range(1e-3, 1e7), "Young's moduli of printed material: along the bead, across it in the layer, and across layers.";
        nu: [f64; 3] = [0.43, 0.37, 0.37], "", Range(-1.0, 1.0), "Poisson's ratios 12, 23 and 13. Axis 1 is along the bead, 2 across it in the layer, 3 across layers.";
        g_mpa: [f64; 3] = [919.0, 844.0, 844.0], "MPa", Range(1e-3, 1e7), "Shear moduli 12, 23 and 13.";
        elastic_source: String = "Li, Xu, Fang, Thin-Walled Structures 199:111800 (2024), PLA by FFF".into(), "", Any, "Source of the elastic constants.";
        // Strengths have no default, because a wrong one would be taken for a measured value. The test
        // refuses materials without them.
        xt_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Tensile strength along the beads: low, nominal, high.";
        yt_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Tensile strength across the beads in the layer: low, nominal, high.";
        zt_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Tensile strength across layers: low, nominal, high.";
        s12_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Shear strength in the layer: low, nominal, high.";
        s_il_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Interlaminar shear strength: low, nominal, high.";
        xc_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Compressive strength along the beads: low, nominal, high.";
        yc_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Compressive strength across the beads: low, nominal, high.";
        g_along_n_mm: Option<[f64; 3]> = None, "N/mm", Range(1e-4, 1e4), "Fracture energy per area of a crack through beads: low, nominal, high.";
        g_across_n_mm: Option<[f64; 3]> = None, "N/mm", Range(1e-4, 1e4), "Fracture energy per area of a crack between beads: low, nominal, high.";
        strength_source: String = String::new(), "", Any, "Source of the strengths.";
        strength_tier: StrengthTier = StrengthTier::T0, "", Any, "How well the strengths are known.";
    }
    /// Layers, walls, speeds and travel.
    ProcessSection "process" {
        layer_height_mm: f64 = 0.2, "mm", Range(0.01, 5.0), "Layer height.";
        first_layer_height_mm: f64 = 0.2, "mm", Range(0.01, 5.0), "Height of the first layer.";
        adaptive_layers: bool = false, "", Any, "Choose the height of each layer from the slope of the surface.";
        adaptive_min_mm: f64 = 0.08, "mm", Range(0.01, 5.0), "Smallest adaptive layer height.";
        adaptive_max_mm: f64 = 0.28, "mm", Range(0.01, 5.0), "Largest adaptive layer height.";
        adaptive_cusp_mm: f64 = 0.1, "mm", Range(0.001, 1.0), "Largest distance between the stair steps of the layers and the surface (cusp height) for adaptive layers.";
        bead_width_mm: f64 = 0.45, "mm", Range(0.05, 10.0), "Full width of a bead.";
        min_bead_width_mm: f64 = 0.2, "mm", Range(0.02, 5.0), "Width of the narrowest bead that is laid in thin places and by a graded density.";
        walls: WallCount = WallCount::Even(2), "", Range(0.0, 1000.0), "Number of walls; or from `min` to as many as `max` where the stress is highest, as `{ min = 2, max = 6, by = \"stress\" }`.";
        stagger_walls: bool = false, "", Any, "Print every other wall half a layer higher than its neighbours, as bricks are laid: the second, fourth and so on from outside.";
        wall_order: WallOrder = WallOrder::InnerFirst, "", Any, "Order in which the walls of a contour are printed.";
        seam: Seam = Seam::Nearest, "", Any, "Where outer walls begin and end.";
        thin_walls: bool = true, "", Any, "Lay one bead of variable width where two walls do not fit.";
        gap_fill: bool = true, "", Any, "Lay one bead of variable width in gaps between walls, and between walls and infill.";
        top_layers: usize = 5, "", Range(0.0, 10000.0), "Number of dense layers below top surfaces.";
        bottom_layers: usize = 4, "", Range(0.0, 10000.0), "Number of dense layers above bottom surfaces.";
        // One microstep of common belt drives (80 steps per mm). Finer points take time to compute,
        // but cannot be printed.
        simplify_mm: f64 = 0.0125, "mm", Range(0.0, 1.0), "Contours are simplified within this distance; small contours within a thousandth of their size.";
        outer_wall_speed_mm_s: f64 = 40.0, "mm/s", Range(0.1, 2000.0), "Speed of outer walls.";
        inner_wall_speed_mm_s: f64 = 60.0, "mm/s", Range(0.1, 2000.0), "Speed of inner walls.";
        small_wall_speed_mm_s: f64 = 25.0, "mm/s", Range(0.1, 2000.0), "Speed of walls around small holes and islands.";
        overhang_speed_mm_s: f64 = 25.0, "mm/s", Range(0.1, 2000.0), "Speed of walls over air.";
        gap_fill_speed_mm_s: f64 = 30.0, "mm/s", Range(0.1, 2000.0), "Speed of gap fill.";
        solid_speed_mm_s: f64 = 60.0, "mm/s", Range(0.1, 2000.0), "Speed of dense infill.";
        top_speed_mm_s: f64 = 40.0, "mm/s", Range(0.1, 2000.0), "Speed of top skins.";
        sparse_speed_mm_s: f64 = 80.0, "mm/s", Range(0.1, 2000.0), "Speed of sparse infill.";
        bridge_speed_mm_s: f64 = 30.0, "mm/s", Range(0.1, 2000.0), "Speed of bridges.";
        bridge_flow: f64 = 1.0, "", Range(0.3, 2.0), "Factor on the extrusion of bridges.";
        travel_speed_mm_s: f64 = 150.0, "mm/s", Range(0.1, 2000.0), "Speed of travel moves.";
        travel_z_speed_mm_s: f64 = 10.0, "mm/s", Range(0.1, 500.0), "Speed of moves in z.";
        first_layer_speed_mm_s: f64 = 25.0, "mm/s", Range(0.1, 2000.0), "Highest printing speed in the first layer.";
        chain: bool = false, "", Any, "Join walls and infill of an island into one path where they touch, and begin each layer where the layer below ended.";
        comb: bool = true, "", Any, "Keep travel moves inside the part where possible.";
        retract_min_travel_mm: f64 = 1.5, "mm", Range(0.0, 1000.0), "Travel moves shorter than this are made without retraction.";
        skirt_loops: usize = 1, "", Range(0.0, 1000.0), "Number of loops around the part that prime the nozzle.";
        skirt_distance_mm: f64 = 3.0, "mm", Range(0.0, 1000.0), "Distance between skirt and part.";
        skirt_layers: usize = 1, "", Range(1.0, 10000.0), "Number of layers with a skirt.";
        brim_width_mm: f64 = 0.0, "mm", Range(0.0, 1000.0), "Width of the brim: loops around the first layer that keep it on the bed.";
        arcs: bool = false, "", Any, "Write circular arcs as G2 and G3.";
        arc_tolerance_mm: f64 = 0.01, "mm", Range(0.001, 1.0), "Largest distance between an arc and the path that it replaces.";
    }
    /// Source of the infill's direction.
    GuideSection "guide" {
        kind: GuideKind = GuideKind::None, "", Any, "What gives infill its direction.";
        angle_deg: f64 = 0.0, "deg", Range(-3600.0, 3600.0), "Direction of all infill for kind = \"angle\", counter-clockwise from +X.";
        follow: Follow = Follow::MaxAbs, "", Any, "The principal stress that the beads follow.";
        analysis: Analysis = Analysis::Auto, "", Any, "Model of the stress analysis.";
        element_mm: Option<f64> = None, "mm", Range(0.01, 1000.0), "Longest edge of a finite element; unset: chosen from the size of the part.";
        elasticity: Elasticity = Elasticity::Isotropic, "", Any, "Elastic model of the stress analysis.";
        elasticity_deg: f64 = 0.0, "deg", Range(-3600.0, 3600.0), "Direction of the beads for elasticity = \"orthotropic\", counter-clockwise from +X.";
        // The default is unset, because the right value depends on pattern and fibre.
        smoothing_mm: Option<f64> = None, "mm", Range(0.001, 100.0), "Length over which directions are smoothed where the principal stresses differ most; it is longer where they differ less. Unset: 0.25 for the pattern `continuous` along the stress without fibre, otherwise 0.5.";
        tangent: bool = true, "", Any, "Align directions with free borders of the part: one principal stress is always parallel to a free border.";
        frame: LoadFrame = LoadFrame::Placed, "", Any, "Coordinates in which fixtures and loads are given.";
        fixture: Vec<Fixture> = Vec::new(), "", Any, "[[guide.fixture]]: a place `on` = { face, face with side, box_mm, turned_box, plane, cylinder, sphere or facets }, the directions that it fixes, `fix` = \"xyz\" or some of these letters, or \"normal\"; and perhaps a prescribed displacement_mm.";
        load: Vec<Load> = Vec::new(), "", Any, "[[guide.load]]: a place `on` as for fixtures, with force_n (spread over the area; with at_mm, a force that acts at that point), pressure_mpa, moment_nmm, bearing_n (a pin in a hole), torque_nmm (about the axis of the place), or preload_n with a second place `to` (a bolt that clamps what lies between); or acceleration_mm_s2 or centrifugal = { point_mm, axis, speed_rpm } for the whole part.";
        case: Vec<Case> = Vec::new(), "", Any, "[[guide.case]]: loads that act together, with name, weight and [[guide.case.load]]. Loads outside cases form one more case.";
        case_mix: CaseMix = CaseMix::Reserve, "", Any, "How layers serve several load cases, for patterns that follow the guide.";
        deck: String = String::new(), "", Any, "Abaqus or CalculiX deck (INP) whose supports and loads act on the part, in the coordinates of the part's file. Each static step becomes a case, beside those of the job.";
        deck_step: Option<usize> = None, "", Range(1.0, 1e6), "The step of the deck whose supports and loads are taken, from 1; unset: all static steps.";
        deck_material: bool = false, "", Any, "Take modulus, Poisson's ratio and density for the stress analysis from the deck, in place of the job's material.";
        import: String = String::new(), "", Any, "File of a stress result to use instead of solving: VTU, VTK, MSH 2.2 or 4.1, FRD or CSV, in the coordinates of the mesh file.";
        import_array: Option<String> = None, "", Any, "Name of the stress array in the imported file; unset: found by the usual names.";
        import_order: Option<ComponentOrder> = None, "", Any, "Order of the stress components in the imported file; unset: by their names, else vtk.";
        import_stress_unit: Option<StressUnit> = None, "", Any, "Unit of the imported stress, or of the pressures and moduli of the deck; unset: MPa. Forces of the deck are in this unit times the square of its unit of length.";
        import_length_unit: Option<LengthUnit> = None, "", Any, "Unit of the imported positions, or of those of the deck; unset: mm.";
        // Half of the memory of a computer with 8 GiB. A job that needs more is refused, and the
        // error states how much.
        memory_mib: usize = 4096, "MiB", Range(16.0, 1e6), "Memory limit of the stress analysis and of the strength test. A job that would exceed it is refused before solving.";
        mode: GrainMode = GrainMode::Field, "", Any, "The feature of the grain that the infill follows.";
        pixel_mm: Option<f64> = None, "mm", Range(1e-3, 10.0), "Pixel size of the rectified photograph; unset: the photograph's own resolution.";
        blur_mm: Option<f64> = None, "mm", Range(0.0, 20.0), "Standard deviation of the blur before edges are detected; unset: 0.12 mm and at least 1.3 pixels.";
        median_px: usize = 1, "px", Range(0.0, 7.0), "Radius of the median filter that removes specks.";
        canny_high: Option<f64> = None, "", Range(1e-3, 1.0), "Upper threshold of the Canny filter, as a fraction of the steepest gradients: edges start above it. Unset: chosen from the image.";
        canny_low: Option<f64> = None, "", Range(1e-3, 1.0), "Lower threshold of the Canny filter, as a fraction of the steepest gradients: edges are followed down to it. Unset: 0.4 of the upper one.";
        join: CurveJoin = CurveJoin::Trace, "", Any, "How edge points become curves.";
        bridge_mm: f64 = 1.5, "mm", Range(0.0, 100.0), "Ends of curves that face each other across at most this gap are joined.";
        min_curve_mm: f64 = 3.0, "mm", Range(0.0, 1000.0), "Curves shorter than this are dropped.";
        integration_mm: f64 = 0.6, "mm", Range(0.01, 100.0), "Radius of the neighbourhood over which the grain's direction is averaged.";
        bend: Bend = Bend::Holes, "", Any, "Borders of the part that the grain bends around.";
        darkness: f64 = 0.0, "", Range(0.0, 1.0), "How strongly line spacing follows the darkness of the picture or the grey value of the scan, below full density. 0: even spacing; 1: up to twice as close as the mean.";
    }
    /// Photographs whose grain guides the infill of a part of another shape; unset: the photographs of shape.photo.
    ImageSection "guide.image" {
        files: Vec<String> = Vec::new(), "", Any, "Photographs, lowest first.";
        corners: BoardCorners = BoardCorners::Image, "", Any, "How the board is found in a photograph, as in shape.photo.";
        corners_px: Vec<[f64; 2]> = Vec::new(), "px", Range(-1e6, 1e6), "Corners of the board in the image, as in shape.photo.";
        size_mm: Option<[f64; 2]> = None, "mm", Range(1e-3, 1e4), "Width and height of the board on the part; unset: those of the part.";
        origin_mm: Option<[f64; 2]> = None, "mm", Range(-1e5, 1e5), "Position of the board's lower left corner on the part; unset: board and part have the same centre.";
        rotate_deg: f64 = 0.0, "deg", Range(-3600.0, 3600.0), "Rotation of the board, counter-clockwise.";
        scale: f64 = 1.0, "", Range(1e-3, 1e3), "Factor on the size of the board.";
        mirror: bool = false, "", Any, "Mirror the board left to right.";
        heights_mm: Vec<f64> = Vec::new(), "mm", Range(0.0, 1e4), "Height that each file shows, as in shape.photo.";
        shift_mm_per_mm: [f64; 2] = [0.0; 2], "", Range(-20.0, 20.0), "Shift of the grain for each millimetre of height, as in shape.photo.";
    }
    /// A scan whose texture guides the infill of a part of another shape; unset: the scan of shape.ct.
    VolumeSection "guide.volume" {
        path: String = String::new(), "", Any, "The scan, as in shape.ct.";
        pixel_mm: Option<Pair> = None, "mm", Range(1e-7, 1e4), "Size of a pixel, one number or [x, y]; unset: as the file states.";
        slice_mm: Option<f64> = None, "mm", Range(1e-7, 1e4), "Distance between slices; unset: as the file states.";
        window: Option<[usize; 2]> = None, "", Range(0.0, 1e6), "First and last slice to use, counted from 0; unset: all.";
        crop_px: Option<[usize; 4]> = None, "px", Range(0.0, 1e6), "First column, first row, last column and last row to use, counted from 0; unset: all.";
        flip: Flip = Flip::None, "", Any, "Axes along which the scan is mirrored; empty: none.";
        scale: f64 = 1.0, "", Range(1e-6, 1e6), "Factor on the size of the scan.";
        origin_mm: Option<[f64; 3]> = None, "mm", Range(-1e5, 1e5), "Position on the part of the lower left corner of the scan's lowest slice; unset: scan and part have the same centre, and the scan stands on the bed.";
        rotate_deg: f64 = 0.0, "deg", Range(-3600.0, 3600.0), "Rotation about the lower left corner of the scan, counter-clockwise.";
    }
    /// A file of directions for kind = "field"; a job may give its path alone in place of the section.
    FieldSection "guide.field" {
        path: String = String::new(), "", Any, "Your own directions: a CSV table with a header (x, y, perhaps z, and an angle or a vector), .npy, .npz, a picture whose grey from 0 to the maximum is 0 to 180 degrees, a finite-element file with vectors, or a folder or matrix of vector_slicer.";
        frame: FieldFrame = FieldFrame::Part, "", Any, "Coordinates of the positions.";
        length_unit: Option<LengthUnit> = None, "", Any, "Unit of the positions; unset: as the header states, else mm.";
        angle_unit: Option<FieldAngleUnit> = None, "", Any, "Unit of the angles; unset: as the header states, else assumed from their size, with a warning.";
        axes: Option<FieldAxes> = None, "", Any, "Order of the indices of a grid; unset: yx for arrays, with a warning, and xy for matrices. Pictures have their first row at the top.";
        array: Option<String> = None, "", Any, "Name of the array or of the vector with the directions; unset: found by the usual names.";
        cell_mm: Option<f64> = None, "mm", Range(1e-4, 1e4), "Size of a cell of a grid or a pixel; unset: the grid covers the part.";
        origin_mm: Option<[f64; 2]> = None, "mm", Range(-1e5, 1e5), "Lower left corner of the first cell of a grid; unset: grid and part have the same centre.";
    }
    /// Infill.
    FillSection "fill" {
        pattern: Pattern = Pattern::Grid, "", Any, "Infill pattern.";
        density: FillDensity = FillDensity::Even(Density::new(0.2)), "", Range(0.0, 1.0), "Volume of beads over volume of the infill region; 1 is dense. Graded density lies between two such numbers and is written as `{ min = 0.1, max = 1.0, by = \"stress\" }`, or `by = \"file\"` with `file` and perhaps `array`.";
        angles_deg: LayerAngles = LayerAngles::all(vec![45.0, -45.0]), "deg", Range(-3600.0, 3600.0), "Raster angles, used in turn from layer to layer; or lists for ranges of layers, counted from 1, as `{ layers = { \"1-10\" = [0], \"11-\" = [45, -45] } }`. `aligned` and patterns that cross within a layer use the first angle of a list only.";
        skin_angles_deg: Option<LayerAngles> = None, "deg", Range(-3600.0, 3600.0), "Raster angles of top and bottom skins over sparse infill, written as angles_deg; skins are then straight lines whatever infill follows. Unset: as angles_deg, or the guide.";
        lines: usize = 1, "", Range(1.0, 8.0), "Number of beads that lie side by side in each line of sparse infill. Lines are that many times as far apart, and their distance and place are fitted to the density.";
        mass_g: Option<f64> = None, "g", Range(0.0, 1e6), "Mass of the part, without skirt, brim and supports. The infill density is chosen so that the mass is right to within 0.5 %; a warning says if no density gives it. It replaces `density`. 0 or \"none\" unsets it.";
        widths: BeadWidths = BeadWidths::Variable, "", Any, "Widths of the beads of `stripes`, `streamlines` and `continuous`; with fibre, `continuous` always has constant width.";
        ends: BeadEnds = BeadEnds::Auto, "", Any, "How the beads of `stripes` and `seed-lines` end at the border.";
        layer_shift: LayerShift = LayerShift::Auto, "", Any, "Which ends of the beads of dense `stripes` and `continuous` lie in different places from layer to layer.";
        spiral: bool = false, "", Any, "Join closed rings of infill that lie inside one another, so that they are laid as one spiral.";
        cell_aspect: f64 = 2.5, "", Range(1.0, 100.0), "Aspect ratio of the cells of `continuous`: length along the guide over width. The width is that of two beads.";
        tree: CellTree = CellTree::Directed, "", Any, "How `continuous` joins its cells into one path.";
        overlap: f64 = 0.22, "", Range(0.0, 0.5), "How far infill reaches into the innermost wall, as a fraction of the bead spacing.";
    }
    /// Support of overhangs.
    SupportSection "support" {
        style: SupportStyle = SupportStyle::None, "", Any, "Kind of support.";
        // The limit depends on printer and material; the specimen measures it.
        critical_angle_deg: f64 = 40.0, "deg", Range(0.0, 89.0), "Facets that lean more than this from the vertical are supported. Measure it on a print of `grainpath specimen critical-angle`.";
        branch_angle_deg: Option<f64> = None, "deg", Range(5.0, 80.0), "Largest angle between a branch and the vertical; unset: the critical angle.";
        max_unsupported_mm: f64 = 10.0, "mm", Range(0.5, 200.0), "Longest span L that the printer bridges without support. Contacts stand L/2 apart, and every point of an overhang is within L/2 of one.";
        min_overhang_mm: f64 = 0.8, "mm", Range(0.0, 100.0), "Overhangs smaller than this in plan view get no support, except where the part begins in mid-air.";
        contact_radius_mm: f64 = 0.3, "mm", Range(0.1, 10.0), "Radius of a branch's tip where it touches the part. Small tips break off cleanly.";
        tip_length_mm: f64 = 1.5, "mm", Range(0.2, 50.0), "Length of a branch's tip, which leaves the part along the surface normal.";
        branch_radius_mm: f64 = 0.6, "mm", Range(0.2, 20.0), "Radius of the thinnest branch. One closed bead needs a diameter of about 1.3 bead widths.";
        base_radius_mm: f64 = 4.0, "mm", Range(0.2, 50.0), "Radius of a foot on the bed, and of the thickest trunk.";
        base_height_mm: f64 = 1.0, "mm", Range(0.0, 100.0), "Height over which a trunk widens to its foot.";
        z_gap_mm: f64 = 0.2, "mm", Range(0.0, 5.0), "Vertical gap between support and part, rounded up to whole layers. A larger gap makes support easier to remove and the surface rougher.";
        xy_gap_mm: f64 = 0.4, "mm", Range(0.0, 10.0), "Horizontal gap between branches and the part's walls.";
        interface_lines: bool = true, "", Any, "Lay single interface beads from contact to contact below flat and nearly flat overhangs, so that beads of the part run over air for at most max_unsupported_mm. Contacts there stand 0.6 times max_unsupported_mm apart.";
        interface_layers: usize = 0, "", Range(0.0, 100.0), "Number of dense layers below each contact. They make the surface smoother and the support harder to remove.";
        interface_radius_mm: f64 = 1.2, "mm", Range(0.1, 50.0), "Radius of the dense layers below a contact.";
        load_per_contact_n: f64 = 1.0, "N", Range(0.0, 1000.0), "Load of one contact on its branch, safety factor included. Branches are thick enough not to buckle under it (Euler).";
        stiffness_mpa: f64 = 2000.0, "MPa", Range(1.0, 1e6), "Young's modulus of a printed branch, for the checks with load_per_contact_n and side_load_n.";
        side_load_n: f64 = 0.1, "N", Range(0.0, 100.0), "Drag of the nozzle on a branch while its tip is printed. Branches are thick enough that no tip moves by more than half a bead's width under it, up to base_radius_mm. A warning states how many tips still move by more.";
        max_slenderness: f64 = 40.0, "", Range(2.0, 1000.0), "Largest length over diameter of a branch.";
        max_reach_mm: f64 = 40.0, "mm", Range(1.0, 1000.0), "Largest horizontal distance over which two branches are merged.";
        margin_mm: f64 = 12.0, "mm", Range(1.0, 1000.0), "How far branches may reach beyond the part in plan view to get around it.";
        from_plate_only: bool = false, "", Any, "Start support on the bed only, never on the part. Overhangs that cannot be reached are reported.";
        lift_mm: f64 = 0.0, "mm", Range(0.0, 1000.0), "Height by which the part is lifted off the bed, to stand on its support.";
        enforce_mm: Vec<[[f64; 3]; 2]> = Vec::new(), "mm", Range(-1e5, 1e5), "Support enforcers: boxes (lowest and highest corner, with the part on the bed) in which all surfaces that face down are supported.";
        block_mm: Vec<[[f64; 3]; 2]> = Vec::new(), "mm", Range(-1e5, 1e5), "Support blockers: boxes in which no surface is supported.";
        enforce_facets: Vec<usize> = Vec::new(), "", Any, "Facets that are always supported, counted from 0 in the order of the file.";
        block_facets: Vec<usize> = Vec::new(), "", Any, "Facets that are never supported, counted in the same way.";
        solid: SupportSurface = SupportSurface::Distance, "", Any, "How the branches are united into one surface.";
        walls: usize = 1, "", Range(1.0, 100.0), "Number of walls of a branch.";
        density: f64 = 0.0, "", Range(0.0, 1.0), "Density of infill in branches; columns and boxes have at least 0.15.";
        dense_layers: usize = 2, "", Range(0.0, 1000.0), "Number of dense layers above the bed, which make feet adhere.";
        speed_mm_s: f64 = 50.0, "mm/s", Range(0.1, 2000.0), "Speed of support.";
        interface_speed_mm_s: f64 = 30.0, "mm/s", Range(0.1, 2000.0), "Speed of the dense layers below contacts.";
        fan: f64 = 1.0, "", Range(0.0, 1.0), "Lowest fan speed while support is printed, so that thin branches solidify.";
    }
    /// Continuous fibre in the infill.
    FibreSection "fibre" {
        enabled: bool = false, "", Any, "Lay the pattern of section fill with continuous fibre; the rest of the part is matrix.";
        material: String = "continuous-carbon".into(), "", Any, "Material of beads with fibre: a material profile, or a path ending in .toml. Section material is the matrix.";
        layers: Vec<[usize; 2]> = Vec::new(), "", Range(1.0, 1e6), "First and last layer with fibre, counted from 1, or several such pairs; unset: all layers.";
        every: usize = 1, "", Range(1.0, 1e6), "Lay fibre in every n-th of the layers given by `layers`.";
        rings: usize = 0, "", Range(0.0, 1000.0), "Number of rings of fibre along outlines and around holes, laid before the pattern fills the rest.";
        matrix_layers: [usize; 2] = [0, 0], "", Range(0.0, 1e6), "Number of layers at the bottom and at the top of the part that have no fibre.";
        boxes_mm: Vec<[[f64; 3]; 2]> = Vec::new(), "mm", Range(-1e5, 1e5), "Boxes (lowest and highest corner, with the part on the bed) in which infill is fibre; unset: everywhere.";
        matrix_pattern: Pattern = Pattern::Rectilinear, "", Any, "Pattern of infill without fibre.";
        matrix_density: Density = Density::Dense, "", Range(0.0, 1.0), "Density of infill without fibre.";
        bead_width_mm: Option<f64> = None, "mm", Range(0.05, 10.0), "Width of a bead with fibre, constant along the path; unset: process.bead_width_mm.";
        min_radius_mm: f64 = 2.0, "mm", Range(0.0, 1000.0), "Smallest turning radius of a path with fibre.";
        turns: FibreTurns = FibreTurns::Round, "", Any, "What happens where a path turns more sharply than min_radius_mm.";
        min_length_mm: f64 = 50.0, "mm", Range(0.0, 1e5), "Paths shorter than this are laid without fibre.";
        anchor_mm: f64 = 5.0, "mm", Range(0.0, 1000.0), "Length at the beginning of a path that is laid slowly, so that the fibre adheres.";
        anchor_speed_mm_s: f64 = 3.0, "mm/s", Range(0.1, 500.0), "Speed over the length anchor_mm.";
        speed_mm_s: f64 = 10.0, "mm/s", Range(0.1, 500.0), "Speed of beads with fibre.";
        start: FibreStart = FibreStart::Straight, "", Any, "Where a closed path begins and ends.";
    }
    /// The virtual strength test.
    StrengthSection "strength" {
        enabled: bool = false, "", Any, "Run the strength test with every run, on guide.fixture and guide.load. It does not depend on guide.kind.";
        cell_mm: Option<f64> = None, "mm", Range(0.02, 50.0), "Size of a cell of the test; unset: half a bead width for plates and a bead width for solids, more for large parts.";
        check: bool = true, "", Any, "Repeat the test with cells of twice the size and report the change of the result.";
        corners: bool = true, "", Any, "Repeat the test with the low, nominal and high strengths of the material, and with strong beads and weak bonds, and the reverse.";
        fidelity: Fidelity = Fidelity::Auto, "", Any, "Model of the test.";
    }
    /// Output files, relative to the job file or to --out.
    OutputSection "output" {
        gcode: String = String::new(), "", Any, "G-code file; empty: the name of the shape's file with .gcode.";
        report: String = String::new(), "", Any, "Report page (HTML); empty: none.";
        preview: String = String::new(), "", Any, "Folder for pictures of the layers (PNG and SVG) and of the part; empty: none.";
        support: String = String::new(), "", Any, "Support as one closed surface (STL); empty: none.";
        stress: String = String::new(), "", Any, "Stress and principal directions (VTU); empty: none.";
        lines: String = String::new(), "", Any, "Evenly spaced principal stress lines of both families (.svg or .vtp); empty: none.";
        surface: String = String::new(), "", Any, "Surface of the part (.stl or .3mf), closed and manifold, lofted from its layers; empty: none.";
        surface_cell_mm: f64 = 0.3, "mm", Range(0.01, 10.0), "Cell size of the surface in `surface`.";
        layers_cli: String = String::new(), "", Any, "Sections of the part as a Common Layer Interface file; empty: none.";
        layers_svg: String = String::new(), "", Any, "Sections of the part as SVG, one group for each layer; empty: none.";
        plan: String = String::new(), "", Any, "All paths with their widths (JSON); empty: none.";
    }
}

/// The settings of a job, checked when the job is read; later stages rely on that check.
///
/// ```
/// use grainpath_core::Density;
/// use grainpath_job::choices::Pattern;
/// use grainpath_job::{Settings, parse_job};
///
/// let mut settings = Settings::default();
/// assert_eq!(settings.process.walls.least(), 2);
/// settings.fill.pattern = Pattern::Gyroid;
///
/// let no_files = |_: &str| Err("no profiles of its own".to_owned());
/// let parsed = parse_job("[fill]\ndensity = 1\n", "job.toml", &[], &no_files).unwrap();
/// assert_eq!(parsed.fill.density.even(), Some(Density::Dense));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs)]
pub struct Settings {
    pub shape: ShapeSection,
    pub photo: PhotoSection,
    pub ct: CtSection,
    pub printer: PrinterSection,
    pub material: MaterialSection,
    pub process: ProcessSection,
    pub guide: GuideSection,
    pub image: ImageSection,
    pub volume: VolumeSection,
    pub field: FieldSection,
    pub fill: FillSection,
    pub fibre: FibreSection,
    /// The material that `fibre.material` names.
    pub fibre_material: MaterialSection,
    pub support: SupportSection,
    pub strength: StrengthSection,
    pub output: OutputSection,
    /// Regions with settings of their own, in the order of the file.
    pub regions: Vec<JobRegion>,
    /// The names of the profiles, and the values of their sections before the job's own keys, as text by section and key.
    pub of_profiles: BTreeMap<String, String>,
    /// Warnings about assumed or overruled settings from reading the job. A run reports them together
    /// with its own warnings.
    pub warnings: Vec<Warning>,
}

impl Settings {
    /// Length over which directions are smoothed, mm. The default is 0.5. For one continuous path along the stress it
    /// is 0.25, because that path cannot end where directions diverge. With fibre it is 0.5 again, because fibre must
    /// not turn sharply. Measured: `cargo xtask bench continuous` compares the two lengths (docs/continuous.md).
    pub fn smoothing_mm(&self) -> f64 {
        let one_path = self.guide.kind == GuideKind::Stress
            && self.fill.pattern == Pattern::Continuous
            && !self.fibre.enabled;
        self.guide.smoothing_mm.unwrap_or(if one_path { 0.25 } else { 0.5 })
    }

    /// Whether the guide names photographs of its own.
    pub fn guide_has_photos(&self) -> bool {
        !self.image.files.is_empty()
    }

    /// The photographs whose grain the infill follows: those of the guide, or those of the shape where the guide names
    /// none. Empty where the guide is not grain.
    pub fn grain_photos(&self) -> &[String] {
        match (self.guide.kind == GuideKind::Grain, self.guide_has_photos()) {
            (false, _) => &[],
            (true, true) => &self.image.files,
            (true, false) => &self.photo.files,
        }
    }

    /// The settings of the job as they apply in a region. The list of regions in them is empty.
    #[must_use]
    pub fn in_region(&self, region: &JobRegion) -> Self {
        let mut s = Self { regions: Vec::new(), warnings: Vec::new(), ..self.clone() };
        let (fill, process) = (&mut s.fill, &mut s.process);
        fill.pattern = region.pattern.unwrap_or(fill.pattern);
        if let Some(density) = region.density {
            fill.density = density.into();
            // The rest of the part gets the density that gives the mass.
            fill.mass_g = None;
        }
        if let Some(angles) = &region.angles_deg {
            fill.angles_deg = angles.clone();
        }
        fill.lines = region.lines.unwrap_or(fill.lines);
        // Dense infill has one bead in a line and no separate skins, so the job's settings for these are
        // dropped. A region's own number of lines is kept.
        if fill.density.is_dense() && fill.mass_g.is_none() {
            fill.lines = region.lines.unwrap_or(1);
            fill.skin_angles_deg = None;
        }
        process.walls = region.walls.map_or(process.walls, WallCount::Even);
        process.top_layers = region.top_layers.unwrap_or(process.top_layers);
        process.bottom_layers = region.bottom_layers.unwrap_or(process.bottom_layers);
        if !region.guide {
            s.guide.kind = GuideKind::None;
        }
        // If the region's pattern or density allows no shift from layer to layer, the job's shift is dropped.
        if !s.allows_layer_shift() {
            s.fill.layer_shift = LayerShift::None;
        }
        s
    }

    /// Names of the sections, in the order in which they are shown.
    pub const SECTIONS: [&'static str; 15] = [
        "shape",
        "shape.photo",
        "shape.ct",
        "printer",
        "material",
        "process",
        "guide",
        "guide.image",
        "guide.volume",
        "guide.field",
        "fill",
        "fibre",
        "support",
        "strength",
        "output",
    ];

    /// Sets one key. `None` if there is no such section or key.
    pub(super) fn set(&mut self, section: &str, key: &str, value: &Value) -> Option<Result<(), ValueError>> {
        match section {
            "shape" => self.shape.set(key, value),
            "shape.photo" => self.photo.set(key, value),
            "shape.ct" => self.ct.set(key, value),
            "printer" => self.printer.set(key, value),
            "material" => self.material.set(key, value),
            "process" => self.process.set(key, value),
            "guide" => self.guide.set(key, value),
            "guide.image" => self.image.set(key, value),
            "guide.volume" => self.volume.set(key, value),
            "guide.field" => self.field.set(key, value),
            "fill" => self.fill.set(key, value),
            "fibre" => self.fibre.set(key, value),
            "support" => self.support.set(key, value),
            "strength" => self.strength.set(key, value),
            "output" => self.output.set(key, value),
            _ => None,
        }
    }

    /// Descriptions of all settings.
    pub fn params() -> Vec<Param> {
        let all = [
            ShapeSection::params(),
            PhotoSection::params(),
            CtSection::params(),
            PrinterSection::params(),
            MaterialSection::params(),
            ProcessSection::params(),
            GuideSection::params(),
            ImageSection::params(),
            VolumeSection::params(),
            FieldSection::params(),
            FillSection::params(),
            FibreSection::params(),
            SupportSection::params(),
            StrengthSection::params(),
            OutputSection::params(),
        ];
        all.into_iter().flatten().collect()
    }

    /// The profiles of the job, beside the default ones.
    pub fn profile_rows(&self) -> Vec<Row> {
        let row = |(kind, default): &(&str, &str)| {
            let key = format!("{kind}.profile");
            let value = self.of_profiles.get(&key)?.clone();
            Some(Row { key, value, default: format!("{default:?}"), unit: "" })
        };
        KINDS.iter().filter_map(row).collect()
    }

    /// The keys of the sections in use, with their present values and those that they have without a word of the job; then
    /// a row for each region.
    pub fn rows(&self) -> Vec<Row> {
        let all = [
            self.shape.rows(),
            // Sections that are not in use are left out to keep the report short.
            if self.photo.files.is_empty() { Vec::new() } else { self.photo.rows() },
            if self.ct.path.is_empty() { Vec::new() } else { self.ct.rows() },
            self.printer.rows(),
            self.material.rows(),
            self.process.rows(),
            self.guide.rows(),
            if self.image.files.is_empty() { Vec::new() } else { self.image.rows() },
            if self.volume.path.is_empty() { Vec::new() } else { self.volume.rows() },
            if self.field.path.is_empty() { Vec::new() } else { self.field.rows() },
            self.fill.rows(),
            if self.fibre.enabled { self.fibre.rows() } else { Vec::new() },
            self.support.rows(),
            self.strength.rows(),
            self.output.rows(),
        ];
        let mut usual: BTreeMap<String, Param> =
            Self::params().into_iter().map(|p| (format!("{}.{}", p.section, p.key), p)).collect();
        let row = |(key, value): (String, String)| {
            let of_profile = self.of_profiles.get(&key).cloned();
            let param = usual.remove(&key)?;
            Some(Row { key, value, default: of_profile.unwrap_or(param.default), unit: param.unit })
        };
        let region = |(k, r): (usize, &JobRegion)| Row {
            key: format!("region[{}]", k + 1),
            value: r.to_text(),
            default: String::new(),
            unit: "",
        };
        let regions = self.regions.iter().enumerate().map(region);
        all.into_iter().flatten().filter_map(row).chain(regions).collect()
    }
}

/// A setting of a job, for reports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Section and key.
    pub key: String,
    /// The value of this job, as TOML has it; empty where it is unset.
    pub value: String,
    /// The value for jobs that do not give one: that of the section's profile, or the default.
    pub default: String,
    /// Unit; empty for none.
    pub unit: &'static str,
}
