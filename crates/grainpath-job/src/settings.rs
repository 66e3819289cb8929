//! Every setting, once.

use toml::Value;

use super::loads::{Case, Fixture, Load};
use super::value::{Check, Pair, Param, SettingValue, read};
use crate::choices::Threshold;
use Check::{Any, Range, Words};

/// Declares sections: structs with defaults, their rows, and how one key is set.
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
                /// Sets one key; `None` when there is no such key.
                pub(super) fn set(&mut self, key: &str, value: &Value) -> Option<Result<(), String>> {
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
                        help: $help,
                    }, )* ]
                }

                /// Keys and values as they are now, for reports.
                pub fn rows(&self) -> Vec<(String, String)> {
                    vec![ $( (format!("{}.{}", $name, stringify!($key)), self.$key.to_text()), )* ]
                }
            }
        )*
    };
}

const PATTERNS: &[&str] = &crate::choices::PATTERNS;
const CORNERS: &[&str] = &["image", "outline", "markers"];

sections! {
    /// What is printed.
    ShapeSection "shape" {
        mesh: String = String::new(), "", Any, "Mesh to print: STL, OBJ, PLY, OFF or 3MF.";
        outline: String = String::new(), "", Any, "Drawing of a flat part to print instead (SVG or ASCII DXF).";
        thickness_mm: f64 = 0.0, "mm", Range(0.0, 1e4), "How thick the part of an outline is.";
        outline_rule: String = "file".into(), "", Words(&["file", "even-odd"]), "What is material in a drawing: filled shapes, and between closed lines without fill; or between all closed lines, each other one inwards a hole.";
        unit: String = "auto".into(), "", Words(&["auto", "mm", "cm", "m", "inch", "micron", "foot"]), "Unit of the mesh or drawing; auto takes the file's own, else mm.";
        scale: f64 = 1.0, "", Range(1e-6, 1e6), "Factor on all lengths of the file.";
        rotate_deg: [f64; 3] = [0.0; 3], "deg", Range(-3600.0, 3600.0), "Turns about X, then Y, then Z.";
        position_mm: Option<[f64; 2]> = None, "mm", Range(-1e5, 1e5), "Where the middle of the part stands on the plate; left out, the middle of the bed.";
        repair: String = "auto".into(), "", Words(&["auto", "strict"]), "auto mends defects and counts them, strict refuses.";
        gap_closing_mm: f64 = 0.05, "mm", Range(0.0, 100.0), "Gaps in sections up to this are closed before anything else.";
    }
    /// A photograph, or several, whose board is printed.
    PhotoSection "shape.photo" {
        files: Vec<String> = Vec::new(), "", Any, "Photographs (PNG, JPEG, TIFF, BMP), lowest layer first. One is enough.";
        corners: String = "image".into(), "", Words(CORNERS), "Where the board is: the whole image, the board's outline on a plain ground, or the markers of a printed sheet.";
        corners_px: Vec<[f64; 2]> = Vec::new(), "px", Range(-1e6, 1e6), "Corners of the board: upper left, upper right, lower right, lower left, from the image's upper left corner; four for all files or four for each. Stronger than corners.";
        size_mm: [f64; 2] = [0.0; 2], "mm", Range(0.0, 1e4), "Width and height of the board between the corners.";
        thickness_mm: f64 = 0.0, "mm", Range(0.0, 1e4), "Thickness of the board.";
        heights_mm: Vec<f64> = Vec::new(), "mm", Range(0.0, 1e4), "The height each file shows, rising; left out, a single file shows the bottom and several are spread evenly over the thickness.";
        shift_mm_per_mm: [f64; 2] = [0.0; 2], "", Range(-20.0, 20.0), "How far grain and holes move in x and y for a millimetre upwards: the knot's inclination.";
        holes_mm: Vec<[f64; 3]> = Vec::new(), "mm", Range(-1e4, 1e4), "Round holes at the height of the first file: x, y and radius; inclined as the grain is.";
    }
    /// A CT scan to print.
    CtSection "shape.ct" {
        path: String = String::new(), "", Any, "Scan to print: a folder or ZIP of PNG, TIFF, BMP, JPEG or DICOM slices, a multipage TIFF, NRRD, MHD, NIfTI, or raw data.";
        pixel_mm: Option<Pair> = None, "mm", Range(1e-7, 1e4), "Size of a pixel, one number or [x, y]; left out, the file's.";
        slice_mm: Option<f64> = None, "mm", Range(1e-7, 1e4), "Distance of slices; left out, the file's.";
        window: Option<[usize; 2]> = None, "", Range(0.0, 1e6), "First and last slice that are taken, counted from 0.";
        crop_px: Option<[usize; 4]> = None, "px", Range(0.0, 1e6), "First column, first row, last column, last row that are taken, counted from 0.";
        flip: String = String::new(), "", Words(&["", "x", "y", "z", "xy", "xz", "yz", "xyz"]), "Axes to mirror.";
        threshold: Threshold = Threshold::Otsu, "", Any, "Where the part begins: otsu, iso50 (halfway between two materials), a grey value, or [low, high].";
        materials: Option<[f64; 2]> = None, "", Any, "Grey values of the two materials for iso50; left out, the commonest on either side of Otsu's threshold.";
        smooth: String = "none".into(), "", Words(&["none", "gaussian", "median", "edges"]), "Noise taken out of slices; edges keeps edges sharp.";
        smooth_px: f64 = 0.7, "px", Range(0.0, 20.0), "Standard deviation for smooth = \"gaussian\".";
        min_island_mm2: f64 = 0.2, "mm2", Range(0.0, 1e6), "Smaller islands of a section are dropped and counted.";
        min_pore_mm2: f64 = 0.1, "mm2", Range(0.0, 1e6), "Smaller holes of a section are filled and counted.";
        interpolate: String = "auto".into(), "", Words(&["auto", "grey", "matched", "distance"]), "What lies between slices: grey values mixed, contours matched and moved, or signed distances mixed; auto is grey where slices lie as close as pixels, else matched.";
        overlap: f64 = 0.2, "", Range(0.0, 1.0), "Share of an entity that its partner in the next slice must cover at least.";
        contours: String = "iso".into(), "", Words(&["iso", "canny"]), "How contours are found: between pixels where the threshold is crossed, or Canny's edges with feature points as published.";
        canny_low: f64 = 0.04, "", Range(0.0, 1.0), "Edges go on above this share of the step from air to material a pixel.";
        canny_high: f64 = 0.1, "", Range(0.0, 1.0), "Edges begin above this share.";
        canny_sigma_px: f64 = 1.0, "px", Range(0.0, 10.0), "Gaussian before Canny's gradients.";
        truth: String = String::new(), "", Any, "File of true dimensions (TOML) that the report compares with what is printed; none when left out.";
        size_px: Option<[usize; 3]> = None, "", Range(1.0, 1e6), "Columns, rows and slices of raw data.";
        sample: String = "u8".into(), "", Words(&grainpath_core::slices::SampleType::NAMES), "How raw data stores a voxel.";
        byte_order: String = "little".into(), "", Words(&["little", "big"]), "Which byte of raw data comes first.";
        offset_bytes: usize = 0, "", Range(0.0, 1e12), "Bytes of raw data before the first voxel.";
    }
    /// The printer.
    PrinterSection "printer" {
        nozzle_mm: f64 = 0.4, "mm", Range(0.05, 5.0), "Diameter of the nozzle.";
        bed_mm: [f64; 3] = [220.0, 220.0, 250.0], "mm", Range(1.0, 10000.0), "Room for a print in x, y and z.";
        origin: String = "corner".into(), "", Words(&["corner", "centre"]), "Where x = y = 0 is on the bed.";
        flavour: String = "marlin".into(), "", Words(&["marlin", "klipper", "rrf"]), "What the firmware understands.";
        filament_mm: f64 = 1.75, "mm", Range(0.5, 5.0), "Diameter of the filament.";
        max_speed_mm_s: [f64; 4] = [300.0, 300.0, 12.0, 60.0], "mm/s", Range(0.1, 5000.0), "Highest speed of x, y, z and filament.";
        acceleration_mm_s2: f64 = 1500.0, "mm/s2", Range(1.0, 100000.0), "Acceleration while printing.";
        travel_acceleration_mm_s2: f64 = 2000.0, "mm/s2", Range(1.0, 100000.0), "Acceleration of travels.";
        retract_acceleration_mm_s2: f64 = 2000.0, "mm/s2", Range(1.0, 100000.0), "Acceleration of the filament alone.";
        jerk_mm_s: [f64; 4] = [8.0, 8.0, 0.4, 4.0], "mm/s", Range(0.0, 100.0), "Jump in speed allowed at corners for x, y, z and filament.";
        square_corner_mm_s: Option<f64> = None, "mm/s", Range(0.0, 100.0), "Klipper's speed at a right angle; where given it takes the place of jerk.";
        junction_deviation_mm: Option<f64> = None, "mm", Range(0.0, 1.0), "Marlin's junction deviation; where given it takes the place of jerk.";
        relative_e: bool = true, "", Any, "Whether E words are distances (M83) or positions (M82).";
        retract_mm: f64 = 0.8, "mm", Range(0.0, 20.0), "Filament drawn back for a travel that leaves the part.";
        retract_speed_mm_s: f64 = 35.0, "mm/s", Range(0.1, 500.0), "How fast it is drawn back.";
        unretract_speed_mm_s: f64 = 35.0, "mm/s", Range(0.1, 500.0), "How fast it comes forward again.";
        z_hop_mm: f64 = 0.0, "mm", Range(0.0, 10.0), "The nozzle is lifted by this for such a travel.";
        fibre_tool: String = "none".into(), "", Words(&["none", "coextruded", "separate"]), "Whether it lays continuous fibre: with the matrix from one nozzle, or from a nozzle of its own.";
        fibre_tool_number: usize = 1, "", Range(0.0, 99.0), "Number of that tool for fibre_tool = \"separate\"; the matrix's is 0.";
        fibre_cutter_mm: f64 = 40.0, "mm", Range(0.0, 1000.0), "Length of fibre between cutter and nozzle: it is cut so long before a path ends.";
        fibre_filament_mm: Option<f64> = None, "mm", Range(0.05, 5.0), "Diameter of what the fibre's tool is fed with; left out, filament_mm.";
        fibre_feed_gcode: String = String::new(), "", Any, "Program that brings fibre from the cutter to the nozzle where a path begins; `{placeholders}` as in docs/gcode.md.";
        fibre_cut_gcode: String = String::new(), "", Any, "Program that cuts the fibre.";
        tool_change_gcode: String = "T{tool}".into(), "", Any, "Program that changes to `{tool}`, for fibre_tool = \"separate\".";
        thumbnails_px: Vec<[usize; 2]> = Vec::new(), "px", Range(8.0, 2000.0), "Sizes of pictures embedded in the G-code.";
        start_gcode: String = "M140 S{first_layer_bed_temp_c}\nM104 S{first_layer_nozzle_temp_c}\nG28\nM190 S{first_layer_bed_temp_c}\nM109 S{first_layer_nozzle_temp_c}".into(), "", Any, "Program before the print; `{placeholders}` as in docs/gcode.md.";
        end_gcode: String = "M104 S0\nM140 S0\nG1 Z{z_park_mm} F600\nG28 X\nM84".into(), "", Any, "Program after the print.";
    }
    /// The material.
    MaterialSection "material" {
        name: String = "PLA".into(), "", Any, "Its name.";
        density_g_cm3: f64 = 1.24, "g/cm3", Range(0.1, 25.0), "Density.";
        nozzle_temp_c: f64 = 205.0, "degC", Range(0.0, 600.0), "Nozzle.";
        first_layer_nozzle_temp_c: f64 = 210.0, "degC", Range(0.0, 600.0), "Nozzle in the first layer.";
        bed_temp_c: f64 = 55.0, "degC", Range(0.0, 300.0), "Bed.";
        first_layer_bed_temp_c: f64 = 60.0, "degC", Range(0.0, 300.0), "Bed in the first layer.";
        flow: f64 = 1.0, "", Range(0.1, 3.0), "Factor on all extrusion.";
        pressure_advance: Option<f64> = None, "", Range(0.0, 10.0), "Linear or pressure advance, in the firmware's unit.";
        max_volumetric_mm3_s: f64 = 15.0, "mm3/s", Range(0.1, 500.0), "The most that melts; faster paths are slowed down.";
        fan_min: f64 = 0.6, "", Range(0.0, 1.0), "Fan in layers that take long.";
        fan_max: f64 = 1.0, "", Range(0.0, 1.0), "Fan in short layers.";
        fan_bridge: f64 = 1.0, "", Range(0.0, 1.0), "Fan over air.";
        fan_off_layers: usize = 1, "", Range(0.0, 1e6), "Layers from the plate without fan.";
        min_layer_time_s: f64 = 8.0, "s", Range(0.0, 1000.0), "Shorter layers are slowed down.";
        fan_below_layer_time_s: f64 = 20.0, "s", Range(0.0, 1000.0), "Layers shorter than this get more than the least fan.";
        min_speed_mm_s: f64 = 10.0, "mm/s", Range(0.1, 1000.0), "Slowing down ends here.";
        e_mpa: [f64; 3] = [2669.0, 2583.0, 2208.0], "MPa", Range(1e-3, 1e7), "Young's moduli of printed material: along the bead, across it in the layer, from layer to layer.";
        nu: [f64; 3] = [0.43, 0.37, 0.37], "", Range(-1.0, 1.0), "Poisson's ratios 12, 23 and 13; 1 along the bead, 2 across it, 3 from layer to layer.";
        g_mpa: [f64; 3] = [919.0, 844.0, 844.0], "MPa", Range(1e-3, 1e7), "Shear moduli 12, 23 and 13.";
        elastic_source: String = "Li, Xu, Fang, Thin-Walled Structures 199:111800 (2024), PLA by FFF".into(), "", Any, "Where the elastic constants come from.";
        xt_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Tensile strength along the beads: low, nominal, high.";
        yt_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Tensile strength across the beads in their layer: low, nominal, high.";
        zt_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Tensile strength from layer to layer: low, nominal, high.";
        s12_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Shear strength in the layer: low, nominal, high.";
        s_il_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Shear strength between layers: low, nominal, high.";
        xc_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Compressive strength along the beads: low, nominal, high.";
        yc_mpa: Option<[f64; 3]> = None, "MPa", Range(1e-3, 1e6), "Compressive strength across the beads: low, nominal, high.";
        g_along_n_mm: Option<[f64; 3]> = None, "N/mm", Range(1e-4, 1e4), "Energy to tear through beads, per area: low, nominal, high.";
        g_across_n_mm: Option<[f64; 3]> = None, "N/mm", Range(1e-4, 1e4), "Energy to part beads from each other, per area: low, nominal, high.";
        strength_source: String = String::new(), "", Any, "Where the strengths come from.";
        strength_tier: String = "T0".into(), "", Words(&["T0", "T1", "T2"]), "How well they are known. T0: data sheets and literature; T1: coupons of one's own; T2: checked on a whole part.";
    }
    /// How it is printed.
    ProcessSection "process" {
        layer_height_mm: f64 = 0.2, "mm", Range(0.01, 5.0), "Thickness of a layer.";
        first_layer_height_mm: f64 = 0.2, "mm", Range(0.01, 5.0), "Thickness of the first layer.";
        adaptive_layers: bool = false, "", Any, "Layer heights that follow the slopes of the part.";
        adaptive_min_mm: f64 = 0.08, "mm", Range(0.01, 5.0), "The thinnest layer then.";
        adaptive_max_mm: f64 = 0.28, "mm", Range(0.01, 5.0), "The thickest layer then.";
        adaptive_cusp_mm: f64 = 0.1, "mm", Range(0.001, 1.0), "How far the stairs may stand off the slope.";
        bead_width_mm: f64 = 0.45, "mm", Range(0.05, 10.0), "Full width of a bead.";
        min_bead_width_mm: f64 = 0.2, "mm", Range(0.02, 5.0), "The narrowest single bead laid in thin places.";
        walls: usize = 2, "", Range(0.0, 1000.0), "Number of walls.";
        wall_order: String = "inner-first".into(), "", Words(&["inner-first", "outer-first"]), "Which wall of a contour comes first.";
        seam: String = "nearest".into(), "", Words(&["nearest", "aligned", "rear", "random"]), "Where outer walls begin.";
        thin_walls: bool = true, "", Any, "One bead of varying width where two walls do not fit.";
        gap_fill: bool = true, "", Any, "One bead of varying width in gaps between walls, and between walls and fill.";
        top_layers: usize = 5, "", Range(0.0, 10000.0), "Dense layers under top surfaces.";
        bottom_layers: usize = 4, "", Range(0.0, 10000.0), "Dense layers over bottom surfaces.";
        simplify_mm: f64 = 0.0125, "mm", Range(0.0, 1.0), "Contours are simplified to within this, and small ones to within a thousandth of their extent.";
        outer_wall_speed_mm_s: f64 = 40.0, "mm/s", Range(0.1, 2000.0), "Speed of outer walls.";
        inner_wall_speed_mm_s: f64 = 60.0, "mm/s", Range(0.1, 2000.0), "Speed of the walls behind them.";
        small_wall_speed_mm_s: f64 = 25.0, "mm/s", Range(0.1, 2000.0), "Speed of walls around small holes and islands.";
        overhang_speed_mm_s: f64 = 25.0, "mm/s", Range(0.1, 2000.0), "Speed of walls over air.";
        gap_fill_speed_mm_s: f64 = 30.0, "mm/s", Range(0.1, 2000.0), "Speed of gap fill.";
        solid_speed_mm_s: f64 = 60.0, "mm/s", Range(0.1, 2000.0), "Speed of dense fill.";
        top_speed_mm_s: f64 = 40.0, "mm/s", Range(0.1, 2000.0), "Speed of top skins.";
        sparse_speed_mm_s: f64 = 80.0, "mm/s", Range(0.1, 2000.0), "Speed of sparse fill.";
        bridge_speed_mm_s: f64 = 30.0, "mm/s", Range(0.1, 2000.0), "Speed of bridges.";
        bridge_flow: f64 = 1.0, "", Range(0.3, 2.0), "Factor on the extrusion of bridges.";
        travel_speed_mm_s: f64 = 150.0, "mm/s", Range(0.1, 2000.0), "Speed of travels.";
        travel_z_speed_mm_s: f64 = 10.0, "mm/s", Range(0.1, 500.0), "Speed of moves in z.";
        first_layer_speed_mm_s: f64 = 25.0, "mm/s", Range(0.1, 2000.0), "Nothing in the first layer is faster.";
        chain: bool = false, "", Any, "Lay walls and fill of an island as one path where they touch, and begin each layer where the one below ended.";
        comb: bool = true, "", Any, "Keep travels inside the part where that is possible.";
        retract_min_travel_mm: f64 = 1.5, "mm", Range(0.0, 1000.0), "Shorter travels never draw the filament back.";
        skirt_loops: usize = 1, "", Range(0.0, 1000.0), "Loops around the part that start the flow.";
        skirt_distance_mm: f64 = 3.0, "mm", Range(0.0, 1000.0), "Distance of the skirt from the part.";
        skirt_layers: usize = 1, "", Range(1.0, 10000.0), "Layers with a skirt.";
        brim_width_mm: f64 = 0.0, "mm", Range(0.0, 1000.0), "Loops around the first layer that hold it down.";
        arcs: bool = false, "", Any, "Write arcs as G2 and G3.";
        arc_tolerance_mm: f64 = 0.01, "mm", Range(0.001, 1.0), "How far an arc may lie off the path.";
    }
    /// What gives fill its direction.
    GuideSection "guide" {
        kind: String = "none".into(), "", Words(&["none", "angle", "stress", "grain"]), "none: the fill's angle list; angle: one direction for all fill, dense and sparse; stress: the principal stresses under the loads given; grain: the grain of photographs, or the texture of a scan.";
        angle_deg: f64 = 0.0, "deg", Range(-3600.0, 3600.0), "The direction for kind = \"angle\", from +X.";
        follow: String = "max-abs".into(), "", Words(&["max-abs", "tension", "compression", "alternate"]), "Which principal stress beads follow: the one greater in amount, the greatest tension, the greatest compression, or both families by turns from layer to layer.";
        analysis: String = "auto".into(), "", Words(&["auto", "plane", "solid"]), "plane: the section as a plate loaded in its plane; solid: the part in three dimensions; auto: plane for a part of constant section loaded in its plane.";
        element_mm: Option<f64> = None, "mm", Range(0.01, 1000.0), "Longest side of an element; left out, fine enough for the part's size.";
        elasticity: String = "isotropic".into(), "", Words(&["isotropic", "orthotropic"]), "isotropic: with the material's modulus along the bead; orthotropic: with its card, beads along elasticity_deg.";
        elasticity_deg: f64 = 0.0, "deg", Range(-3600.0, 3600.0), "Direction of the beads for elasticity = \"orthotropic\", from +X.";
        smoothing_mm: Option<f64> = None, "mm", Range(0.001, 100.0), "Directions are evened out over this length where the stress cares most, over more where it cares less; left out, 0.5, or 0.25 for one continuous path along the stress without fibre.";
        tangent: bool = true, "", Any, "Draw directions along free borders, which are principal directions themselves.";
        fixture: Vec<Fixture> = Vec::new(), "", Any, "[[guide.fixture]]: on = { box_mm | plane | cylinder | sphere | facets }, fix = \"xyz\" or some of it or \"normal\", displacement_mm.";
        load: Vec<Load> = Vec::new(), "", Any, "[[guide.load]]: on = { ... } with force_n (spread over the area), pressure_mpa or moment_nmm; or acceleration_mm_s2 for the whole part.";
        case: Vec<Case> = Vec::new(), "", Any, "[[guide.case]]: name, weight and its own [[guide.case.load]]; loads outside cases are a case of their own.";
        import: String = String::new(), "", Any, "Take the stress from this file instead of solving: VTU, VTK, MSH 2.2 or 4.1, FRD, CSV; in the mesh's coordinates.";
        import_array: Option<String> = None, "", Any, "Name of the stress array in it; left out, the usual names.";
        import_order: Option<String> = None, "", Words(&["vtk", "abaqus", "voigt"]), "Order of its components: vtk xx yy zz xy yz zx, abaqus xx yy zz xy xz yz, voigt xx yy zz yz xz xy; left out, by name, else vtk.";
        import_stress_unit: Option<String> = None, "", Words(&["MPa", "Pa", "kPa", "GPa", "psi", "ksi"]), "Its unit; left out, MPa.";
        import_length_unit: Option<String> = None, "", Words(&["mm", "cm", "m", "inch", "micron", "foot"]), "Unit of its positions; left out, mm.";
        memory_mb: usize = 4096, "MB", Range(16.0, 1e6), "The most the solver may take; it is told in advance.";
        mode: String = "field".into(), "", Words(&["field", "edges"]), "What follows the grain: lines along its directions, or the picture's edges themselves with more between them.";
        pixel_mm: Option<f64> = None, "mm", Range(1e-3, 10.0), "Pixel of the rectified picture; left out, the photograph's own.";
        blur_mm: Option<f64> = None, "mm", Range(0.0, 20.0), "Standard deviation of the Gaussian before edges are sought; left out, 0.12 and at least 1.3 pixels.";
        median_px: usize = 1, "px", Range(0.0, 7.0), "Radius of the median that removes specks.";
        canny_high: Option<f64> = None, "", Range(1e-3, 1.0), "Edges begin at this share of the steepest slopes; left out, by the picture.";
        canny_low: Option<f64> = None, "", Range(1e-3, 1.0), "Edges go on down to this share; left out, 0.4 of the high one.";
        join: String = "trace".into(), "", Words(&["trace", "nearest"]), "How edge points become curves: along the edges, or each to its nearest as published.";
        bridge_mm: f64 = 1.5, "mm", Range(0.0, 100.0), "Ends of curves that face each other over gaps up to this are joined.";
        min_curve_mm: f64 = 3.0, "mm", Range(0.0, 1000.0), "Shorter curves are dropped.";
        integration_mm: f64 = 0.6, "mm", Range(0.01, 100.0), "Neighbourhood over which the direction is averaged.";
        bend: String = "holes".into(), "", Words(&["none", "outline", "holes", "both"]), "Borders of the part along which the grain is bent.";
        darkness: f64 = 0.0, "", Range(0.0, 1.0), "How much closer lines lie where the picture is dark, or the scan dense, below full density: 1 is twice as close as on average.";
    }
    /// Photographs whose grain a part of another shape is filled with; left out, those of shape.photo.
    ImageSection "guide.image" {
        files: Vec<String> = Vec::new(), "", Any, "Photographs, lowest first.";
        corners: String = "image".into(), "", Words(CORNERS), "Where the board is, as in shape.photo.";
        corners_px: Vec<[f64; 2]> = Vec::new(), "px", Range(-1e6, 1e6), "Corners of the board, as in shape.photo.";
        size_mm: Option<[f64; 2]> = None, "mm", Range(1e-3, 1e4), "Width and height of the picture on the part; left out, those of the part.";
        origin_mm: Option<[f64; 2]> = None, "mm", Range(-1e5, 1e5), "Where the picture's lower left corner lies on the part; left out, its middle is on the part's.";
        rotate_deg: f64 = 0.0, "deg", Range(-3600.0, 3600.0), "Turned counter-clockwise.";
        scale: f64 = 1.0, "", Range(1e-3, 1e3), "Factor on its size.";
        mirror: bool = false, "", Any, "Left and right changed over.";
        heights_mm: Vec<f64> = Vec::new(), "mm", Range(0.0, 1e4), "The height each file shows, as in shape.photo.";
        shift_mm_per_mm: [f64; 2] = [0.0; 2], "", Range(-20.0, 20.0), "How far the grain moves for a millimetre upwards, as in shape.photo.";
    }
    /// A scan whose texture a part of another shape is filled along; left out, that of shape.ct.
    VolumeSection "guide.volume" {
        path: String = String::new(), "", Any, "The scan, as in shape.ct.";
        pixel_mm: Option<Pair> = None, "mm", Range(1e-7, 1e4), "Size of a pixel, one number or [x, y]; left out, the file's.";
        slice_mm: Option<f64> = None, "mm", Range(1e-7, 1e4), "Distance of slices; left out, the file's.";
        window: Option<[usize; 2]> = None, "", Range(0.0, 1e6), "First and last slice that are taken, counted from 0.";
        crop_px: Option<[usize; 4]> = None, "px", Range(0.0, 1e6), "First column, first row, last column, last row that are taken, counted from 0.";
        flip: String = String::new(), "", Words(&["", "x", "y", "z", "xy", "xz", "yz", "xyz"]), "Axes to mirror.";
        scale: f64 = 1.0, "", Range(1e-6, 1e6), "Factor on its size.";
        origin_mm: Option<[f64; 3]> = None, "mm", Range(-1e5, 1e5), "Where the lower left corner of its lowest slice lies on the part; left out, its middle is over the part's and its bottom on the plate.";
        rotate_deg: f64 = 0.0, "deg", Range(-3600.0, 3600.0), "Turned about that corner, counter-clockwise.";
    }
    /// What is laid inside the walls.
    FillSection "fill" {
        pattern: String = "grid".into(), "", Words(PATTERNS), "Pattern of the inside.";
        density: f64 = 0.2, "", Range(0.0, 1.0), "Volume of beads over volume of the inside; 1 is dense.";
        angles_deg: Vec<f64> = vec![45.0, -45.0], "deg", Range(-3600.0, 3600.0), "Directions of lines, layer by layer in turn; `aligned` and crossed patterns keep the first.";
        mass_g: Option<f64> = None, "g", Range(1e-6, 1e6), "Find the density that gives the part this mass, to within 1 %.";
        widths: String = "variable".into(), "", Words(&["variable", "constant"]), "Bead width of `continuous`: following the room between neighbours, or the same everywhere (fibre).";
        cell_aspect: f64 = 2.5, "", Range(1.0, 100.0), "Length of a cell of `continuous` along the field, in its widths of two beads.";
        tree: String = "directed".into(), "", Words(&["directed", "undirected"]), "How `continuous` joins its cells: by how little beads turn out of the field, or without looking at it, to compare with.";
        overlap: f64 = 0.22, "", Range(0.0, 0.5), "How far fill runs into the innermost wall, as a share of the bead's spacing.";
    }
    /// What holds up overhangs.
    SupportSection "support" {
        style: String = "none".into(), "", Words(&["none", "tree", "columns", "box"]), "tree: branching supports; columns (straight walls below every overhang) and box (the box around them) are baselines to compare with.";
        critical_angle_deg: f64 = 40.0, "deg", Range(0.0, 89.0), "Facets that lean more than this from the vertical are held up; read it off the print of `grainpath specimen critical-angle`.";
        branch_angle_deg: Option<f64> = None, "deg", Range(5.0, 80.0), "Branches lean at most by this from the vertical; left out, the critical angle.";
        max_unsupported_mm: f64 = 10.0, "mm", Range(0.5, 200.0), "The longest stretch that prints without anything below (L): contacts stand L/2 apart and none of an overhang is further than L/2 from one.";
        min_overhang_mm: f64 = 0.8, "mm", Range(0.0, 100.0), "Overhangs smaller than this in plan are left alone; what begins in mid-air never is.";
        contact_radius_mm: f64 = 0.3, "mm", Range(0.1, 10.0), "Radius of the end that touches the part: small ends break off cleanly.";
        tip_length_mm: f64 = 1.5, "mm", Range(0.2, 50.0), "Length of the end piece, which leaves the part along its normal.";
        branch_radius_mm: f64 = 0.6, "mm", Range(0.2, 20.0), "Radius of the thinnest branch; one closed bead needs about 1.3 bead widths across.";
        base_radius_mm: f64 = 4.0, "mm", Range(0.2, 50.0), "Radius of a foot on the plate, and of the thickest trunk.";
        base_height_mm: f64 = 1.0, "mm", Range(0.0, 100.0), "Height over which a trunk widens to its foot.";
        z_gap_mm: f64 = 0.2, "mm", Range(0.0, 5.0), "Free height between support and part, rounded up to whole layers: the larger, the easier it comes off and the rougher the face.";
        xy_gap_mm: f64 = 0.4, "mm", Range(0.0, 10.0), "Distance that branches keep from the part's walls.";
        interface_layers: usize = 0, "", Range(0.0, 100.0), "Dense layers below each contact, as a pad: a smoother face, harder to remove.";
        interface_radius_mm: f64 = 1.2, "mm", Range(0.1, 50.0), "Radius of such a pad.";
        load_per_contact_n: f64 = 1.0, "N", Range(0.0, 1000.0), "What one contact presses on its branch, safety included; branches are as thick as Euler's load asks.";
        stiffness_mpa: f64 = 2000.0, "MPa", Range(1.0, 1e6), "Young's modulus of a printed branch, for the same.";
        max_slenderness: f64 = 40.0, "", Range(2.0, 1000.0), "Length over diameter that no branch exceeds.";
        brace: bool = true, "", Any, "Tie slender trunks to a neighbour with struts.";
        brace_slenderness: f64 = 25.0, "", Range(2.0, 1000.0), "Trunks of more than this length over diameter are tied, at this distance.";
        max_reach_mm: f64 = 40.0, "mm", Range(1.0, 1000.0), "The furthest a branch goes sideways to meet another.";
        margin_mm: f64 = 12.0, "mm", Range(1.0, 1000.0), "How far branches may go beyond the part in plan to get past it.";
        from_plate_only: bool = false, "", Any, "Nothing stands on the part; overhangs that cannot be reached from the plate are listed instead.";
        lift_mm: f64 = 0.0, "mm", Range(0.0, 1000.0), "The part is lifted off the plate by this and stands on its supports.";
        enforce_mm: Vec<[[f64; 3]; 2]> = Vec::new(), "mm", Range(-1e5, 1e5), "Boxes (lowest and highest corner, part on the plate) in which everything that looks down is held.";
        block_mm: Vec<[[f64; 3]; 2]> = Vec::new(), "mm", Range(-1e5, 1e5), "Boxes in which nothing is held.";
        enforce_facets: Vec<usize> = Vec::new(), "", Any, "Facets that are held whatever their angle, counted from 0 in the order of the file.";
        block_facets: Vec<usize> = Vec::new(), "", Any, "Facets that are not held, likewise.";
        solid: String = "distance".into(), "", Words(&["distance", "poisson"]), "How the support becomes one surface: by signed distance, or by Poisson reconstruction as in the paper (slower, blurs tips).";
        walls: usize = 1, "", Range(1.0, 100.0), "Beads around each branch.";
        density: f64 = 0.0, "", Range(0.0, 1.0), "Fill inside the branches; columns and box lay at least 0.15.";
        dense_layers: usize = 2, "", Range(0.0, 1000.0), "Dense layers from the plate, so that feet stick.";
        speed_mm_s: f64 = 50.0, "mm/s", Range(0.1, 2000.0), "Speed of support.";
        interface_speed_mm_s: f64 = 30.0, "mm/s", Range(0.1, 2000.0), "Speed of the dense layers below contacts.";
        fan: f64 = 1.0, "", Range(0.0, 1.0), "Least fan while support is printed: thin branches need to set.";
    }
    /// Continuous fibre in the fill; the rest of the part is matrix.
    FibreSection "fibre" {
        enabled: bool = false, "", Any, "Lay fill.pattern with continuous fibre, by the printer's fibre tool.";
        material: String = "continuous-carbon".into(), "", Any, "What it is: a material profile, or a path ending in .toml; section material is the matrix.";
        layers: Vec<[usize; 2]> = Vec::new(), "", Range(1.0, 1e6), "First and last layer with fibre, counted from 1, or several such pairs; left out, all.";
        every: usize = 1, "", Range(1.0, 1e6), "Of these every second, third ... layer.";
        boxes_mm: Vec<[[f64; 3]; 2]> = Vec::new(), "mm", Range(-1e5, 1e5), "Boxes (lowest and highest corner, part on the plate) in which fill is fibre; left out, everywhere.";
        matrix_pattern: String = "rectilinear".into(), "", Words(PATTERNS), "Pattern of fill without fibre.";
        matrix_density: f64 = 1.0, "", Range(0.0, 1.0), "Its density.";
        bead_width_mm: Option<f64> = None, "mm", Range(0.05, 10.0), "Width of a bead with fibre, the same all along; left out, process.bead_width_mm.";
        min_radius_mm: f64 = 2.0, "mm", Range(0.0, 1000.0), "Least radius a path with fibre may turn by.";
        turns: String = "round".into(), "", Words(&["round", "report", "cut"]), "Sharper turns: rounded where there is room and reported where not; only reported; or rounded, and the fibre cut where there is no room.";
        min_length_mm: f64 = 50.0, "mm", Range(0.0, 1e5), "Shorter paths are laid without fibre.";
        anchor_mm: f64 = 5.0, "mm", Range(0.0, 1000.0), "Length at a path's beginning that is laid slowly, so that it holds.";
        anchor_speed_mm_s: f64 = 3.0, "mm/s", Range(0.1, 500.0), "Speed for that.";
        speed_mm_s: f64 = 10.0, "mm/s", Range(0.1, 500.0), "Speed of fibre.";
        start: String = "straight".into(), "", Words(&["nearest", "straight", "calm", "rear"]), "Where closed paths begin and end: nearest to the path before, in the middle of the longest straight piece, where the stress is least, or furthest back.";
    }
    /// The virtual strength test.
    StrengthSection "strength" {
        enabled: bool = false, "", Any, "Test every run: fixtures and loads are the tables guide.fixture and guide.load, whatever guide.kind is.";
        cell_mm: Option<f64> = None, "mm", Range(0.02, 50.0), "Side of a cell of the test; left out, half a bead for plates and a bead for solids, larger for large parts.";
        check: bool = true, "", Any, "Test once more with cells of twice the size and say how much the answer moved.";
        corners: bool = true, "", Any, "Test at the corners of the material's card too: low, nominal, high, and strong along but weak across and the reverse.";
        fidelity: String = "auto".into(), "", Words(&["auto", "plane", "voxels"]), "plane: a plate, its layers homogenised through the thickness; voxels: a solid of box-shaped cells, whose layers can part; auto: plane for parts of one section under loads in its plane, voxels for all others.";
    }
    /// What is written, relative to the job file or to --out.
    OutputSection "output" {
        gcode: String = String::new(), "", Any, "The machine program; left out, the mesh's name with .gcode.";
        report: String = String::new(), "", Any, "Report page (HTML); none when left out.";
        preview: String = String::new(), "", Any, "Folder for pictures of layers (PNG and SVG) and of the part; none when left out.";
        support: String = String::new(), "", Any, "The support as one closed surface (STL); none when left out.";
        stress: String = String::new(), "", Any, "Stress and principal directions as VTU; none when left out.";
        lines: String = String::new(), "", Any, "Evenly spaced principal stress lines of both families: .svg or .vtp; none when left out.";
        surface: String = String::new(), "", Any, "The part's surface as STL or 3MF, by its ending, lofted from its layers, closed and manifold; none when left out.";
        surface_cell_mm: f64 = 0.3, "mm", Range(0.01, 10.0), "Size of the cells that the surface is made of.";
        layers_cli: String = String::new(), "", Any, "The part's sections as a Common Layer Interface file; none when left out.";
        layers_svg: String = String::new(), "", Any, "The part's sections as SVG, a group a layer; none when left out.";
        plan: String = String::new(), "", Any, "The plan as JSON: every path with its widths; none when left out.";
    }
}

/// A checked job.
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
    pub fill: FillSection,
    pub fibre: FibreSection,
    /// The profile that `fibre.material` names.
    pub fibre_material: MaterialSection,
    pub support: SupportSection,
    pub strength: StrengthSection,
    pub output: OutputSection,
}

impl Settings {
    /// Length over which directions are evened out, mm. One path cannot end where directions part, so it keeps nearer
    /// to them from the start; but fibre pays for every turn.
    pub fn smoothing_mm(&self) -> f64 {
        let one_path =
            self.guide.kind == "stress" && self.fill.pattern == "continuous" && !self.fibre.enabled;
        self.guide.smoothing_mm.unwrap_or(if one_path { 0.25 } else { 0.5 })
    }

    /// Names of the sections, in the order they are shown.
    pub const SECTIONS: [&'static str; 14] = [
        "shape",
        "shape.photo",
        "shape.ct",
        "printer",
        "material",
        "process",
        "guide",
        "guide.image",
        "guide.volume",
        "fill",
        "fibre",
        "support",
        "strength",
        "output",
    ];

    /// Sets one key; `None` when there is no such section or key.
    pub(super) fn set(&mut self, section: &str, key: &str, value: &Value) -> Option<Result<(), String>> {
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
            "fill" => self.fill.set(key, value),
            "fibre" => self.fibre.set(key, value),
            "support" => self.support.set(key, value),
            "strength" => self.strength.set(key, value),
            "output" => self.output.set(key, value),
            _ => None,
        }
    }

    /// Every setting.
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
            FillSection::params(),
            FibreSection::params(),
            SupportSection::params(),
            StrengthSection::params(),
            OutputSection::params(),
        ];
        all.into_iter().flatten().collect()
    }

    /// All keys and values as they are now.
    pub fn rows(&self) -> Vec<(String, String)> {
        let all = [
            self.shape.rows(),
            if self.photo.files.is_empty() { Vec::new() } else { self.photo.rows() },
            if self.ct.path.is_empty() { Vec::new() } else { self.ct.rows() },
            self.printer.rows(),
            self.material.rows(),
            self.process.rows(),
            self.guide.rows(),
            if self.image.files.is_empty() { Vec::new() } else { self.image.rows() },
            if self.volume.path.is_empty() { Vec::new() } else { self.volume.rows() },
            self.fill.rows(),
            if self.fibre.enabled { self.fibre.rows() } else { Vec::new() },
            self.support.rows(),
            self.strength.rows(),
            self.output.rows(),
        ];
        all.into_iter().flatten().collect()
    }
}
