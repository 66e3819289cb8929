//! Makes the settings of each stage from the settings of a job.
//!
//! Stages read their own settings alone. Besides this module, the run reads the job to decide which stages there are
//! (`run/mod.rs`), and `region.rs` reads the job's regions. Every choice is matched exhaustively,
//! so that the code does not compile until a new word in `grainpath_job::choices` is handled here.
//! Units are converted here too: degrees become radians.

use grainpath_core::math::{direction, rotated};
use grainpath_core::units::{LengthUnit, bead_spacing_mm};
use grainpath_core::{Bounds2, DVec2, DVec3, Density, Diagnostics, WarningId};
use grainpath_fea::material::Orthotropic;
use grainpath_fea::strength::card::StrengthCard;
use grainpath_gcode::{
    Cooling, Corner, FibreTool, Flavour, KLIPPER_ARC_SEGMENT_MM, KLIPPER_MIN_CRUISE_RATIO, Limits, Machine,
    Material, Retraction, Speeds, WriteConfig,
};
use grainpath_io::directions::{AngleUnit, DirectionOptions, GridAxes};
use grainpath_io::fe::{DeckConditions, FeError, FeFile, FeOptions, Order, StressUnit};
use grainpath_io::volume::RawHeader;
use grainpath_io::{OutlineOptions, PaintedSupports};

use crate::fibre::FibreSettings;
use crate::fill::shift::{self, Ends};
use crate::fill::{Continuous, LineFit, SideBySide, TreeKind};
use crate::guide::given_field::FieldSettings;
use crate::guide::graded_density::DensitySettings;
use crate::guide::grain::GrainSettings;
use crate::guide::grain::{Corners, Mode};
use crate::guide::{StressSettings, TypedLoads};
use crate::measure::strength::{CORNERS, StrengthSettings};
use crate::order::{CombSettings, OrderSettings};
use crate::run::placing::PlaceSettings;
use crate::run::steps::{ExtrudedMass, InfillSettings, RasterAngles, RegionSettings, StepSettings};
use crate::shape::{Adaptive, Hole, PhotoBoard, Placement, SliceSettings, Standing};
use crate::support::beads::BeadSettings;
use crate::support::{Style, SupportSettings};
use crate::wall::WallSettings;
use crate::wall::adhesion::AdhesionSettings;
use crate::wall::skin::SkinSettings;
use grainpath_imaging::canny::CannySettings;
use grainpath_imaging::photo::edge_curves::{CurveSettings, Join};
use grainpath_imaging::scan::texture::TextureSettings;
use grainpath_imaging::scan::{CtReport, CtSettings, Denoise, Interpolation, Threshold, Tracing};
use grainpath_imaging::structure_tensor::Tangent;
use grainpath_job::choices::{
    self, BeadWidths, BedOrigin, Bend, BoardCorners, ByteOrder, CaseMix, CellTree, Choice, ComponentOrder,
    Contours, CurveJoin, Elasticity, FibreToolKind, FieldAngleUnit, FieldAxes, FileUnit, GrainMode,
    GuideKind, Interpolate, LayerShift, OutlineRule, SupportStyle,
};
use grainpath_job::{AngleRange, JobRegion, LayerAngles, MaterialSection, Settings};

/// Settings for reading the drawing of `shape.outline`, its unit included.
pub fn outline(s: &Settings) -> OutlineOptions {
    OutlineOptions {
        unit: s.shape.unit.0,
        // The tolerance applies to the scaled part, but the drawing is flattened before scaling, so the
        // tolerance is divided by the scale.
        tolerance_mm: OUTLINE_TOLERANCE_MM / s.shape.scale,
        even_odd: s.shape.outline_rule == OutlineRule::EvenOdd,
    }
}

/// Height of the body made from a drawing, mm: `shape.thickness_mm` before `shape.scale` is applied.
pub fn outline_thickness_mm(s: &Settings) -> f64 {
    s.shape.thickness_mm / s.shape.scale
}

/// Largest distance between a curve of a drawing and the line segments that replace it, mm. Source: derived.
/// Half a microstep of common printers, as for arcs in `poly` of core.
const OUTLINE_TOLERANCE_MM: f64 = 0.005;

fn placement(s: &Settings) -> Placement {
    // A drawing was already converted to mm when it was read, so the unit must not be applied again.
    let unit = s.shape.unit.0.filter(|_| s.shape.outline.is_empty());
    Placement {
        unit: unit.unwrap_or(LengthUnit::Millimetre),
        scale: s.shape.scale,
        rotate_rad: s.shape.rotate_deg.map(f64::to_radians),
    }
}

/// Settings for placing, repairing and slicing a mesh.
pub fn placing(s: &Settings) -> PlaceSettings {
    PlaceSettings {
        placement: placement(s),
        unit_of_file: s.shape.unit == FileUnit(None),
        // Supports need height below the part; without supports a lifted part would hang in the
        // air.
        lift_mm: match s.support.style {
            SupportStyle::None => 0.0,
            SupportStyle::Tree | SupportStyle::Columns | SupportStyle::Box => s.support.lift_mm,
        },
        repair: s.shape.repair,
        slicing: slicing(s),
    }
}

pub(crate) fn slicing(s: &Settings) -> SliceSettings {
    let p = &s.process;
    SliceSettings {
        layer_height_mm: p.layer_height_mm,
        first_layer_height_mm: p.first_layer_height_mm,
        adaptive: p.adaptive_layers.then_some(Adaptive {
            min_height_mm: p.adaptive_min_mm,
            max_height_mm: p.adaptive_max_mm,
            max_cusp_mm: p.adaptive_cusp_mm,
        }),
        gap_closing_mm: s.shape.gap_closing_mm,
        simplify_mm: p.simplify_mm,
    }
}

/// The board of `shape.photo`.
pub(crate) fn photo_board(s: &Settings) -> PhotoBoard {
    let p = &s.photo;
    let hole = |&[x, y, radius_mm]: &[f64; 3]| Hole { centre_mm: DVec2::new(x, y), radius_mm };
    PhotoBoard {
        size_mm: p.size_mm.into(),
        thickness_mm: p.thickness_mm,
        // Entries with a radius of zero are no holes.
        holes: p.holes_mm.iter().filter(|h| h[2] > 0.0).map(hole).collect(),
        shift_mm_per_mm: p.shift_mm_per_mm.into(),
        shown_mm: p.heights_mm.first().copied().unwrap_or(0.0),
    }
}

/// Settings for reading the `n` photographs of a job, for a part with these bounds and this height.
/// The photographs are those of [`Settings::grain_photos`].
pub(crate) fn grain(s: &Settings, n: usize, part: Bounds2, height_mm: f64) -> GrainSettings {
    let (g, image, photo) = (&s.guide, &s.image, &s.photo);
    let own = s.guide_has_photos();
    let rotate_rad = if own { image.rotate_deg.to_radians() } else { 0.0 };
    let size_mm = match (own, image.size_mm) {
        (false, _) => DVec2::from(photo.size_mm),
        (true, Some(size)) => DVec2::from(size) * image.scale,
        (true, None) => part.size() * image.scale,
    };
    // Without an origin the picture is centred on the part.
    let middle = part.centre() - rotated(0.5 * size_mm, direction(rotate_rad));
    let origin_mm = if own { image.origin_mm.map_or(middle, DVec2::from) } else { DVec2::ZERO };
    let (found_by, given, heights, shift) = if own {
        (image.corners, &image.corners_px, &image.heights_mm, image.shift_mm_per_mm)
    } else {
        (photo.corners, &photo.corners_px, &photo.heights_mm, photo.shift_mm_per_mm)
    };
    let corners = if !given.is_empty() {
        Corners::Given(given.chunks_exact(4).map(|c| [c[0], c[1], c[2], c[3]].map(DVec2::from)).collect())
    } else {
        match found_by {
            BoardCorners::Image => Corners::Image,
            BoardCorners::Outline => Corners::Outline,
            BoardCorners::Markers => Corners::Markers,
        }
    };
    // If heights are missing, the photographs are distributed evenly over the height: each shows the
    // middle of an equal share of it.
    let heights_mm = match (heights.is_empty(), n) {
        (false, _) => heights.clone(),
        (true, 1) => vec![0.0],
        (true, _) => (0..n).map(|k| height_mm * (k as f64 + 0.5) / n as f64).collect(),
    };
    GrainSettings {
        corners,
        size_mm,
        origin_mm,
        rotate_rad,
        mirror: own && image.mirror,
        heights_mm,
        shift_mm_per_mm: shift.into(),
        mode: match g.mode {
            GrainMode::Field => Mode::Field,
            GrainMode::Edges => Mode::Edges,
        },
        pixel_mm: g.pixel_mm,
        blur_mm: g.blur_mm,
        median_px: g.median_px,
        canny: CannySettings { high: g.canny_high, low: g.canny_low },
        curves: CurveSettings {
            join: match g.join {
                CurveJoin::Trace => Join::Trace,
                CurveJoin::Nearest => Join::Nearest,
            },
            max_turn_rad: 1.0,
            bridge_mm: g.bridge_mm,
            min_length_mm: g.min_curve_mm,
        },
        integration_mm: g.integration_mm,
        smooth_mm: s.smoothing_mm(),
        tangent: match g.bend {
            Bend::None => Tangent::None,
            Bend::Outline => Tangent::Outline,
            Bend::Holes => Tangent::Holes,
            Bend::Both => Tangent::Both,
        },
        darkness: g.darkness,
        // Pictures hold whole images in memory, so they are kept only where a page shows them.
        pictures: !s.output.preview.is_empty() || !s.output.report.is_empty(),
    }
}

/// Settings for reading the texture of a scan, for a part with these bounds and this height. The
/// scan is that of `guide.volume`, or that of `shape.ct` if `guide.volume` names none. `own` is the
/// report of the scan of `shape.ct`.
pub(crate) fn texture(
    s: &Settings,
    own: Option<&CtReport>,
    part: Bounds2,
    height_mm: f64,
) -> TextureSettings {
    let (g, v) = (&s.guide, &s.volume);
    let other = !v.path.is_empty();
    let mut scan = scan(s);
    // A scan that is not the shape has its own spacing and position; its rotation is applied to
    // directions, not to voxels.
    if other {
        let [x, y] = v.pixel_mm.map_or([None; 2], |p| p.0.map(Some));
        scan = CtSettings {
            section: "guide.volume",
            spacing_mm: [x, y, v.slice_mm],
            scale: v.scale,
            window: v.window,
            crop_px: v.crop_px,
            flip: v.flip.axes(),
            rotate_rad: [0.0; 3],
            ..scan
        };
    }
    TextureSettings {
        scan,
        name: if other { v.path.clone() } else { s.ct.path.clone() },
        // The scan of the shape was lowered to the plate, and its texture is lowered with it.
        origin_mm: match own {
            Some(own) if !other => Some(DVec3::new(0.0, 0.0, -own.bottom_mm)),
            _ => v.origin_mm.map(DVec3::from),
        },
        rotate_rad: if other { v.rotate_deg.to_radians() } else { 0.0 },
        integration_mm: g.integration_mm,
        smooth_mm: s.smoothing_mm(),
        darkness: g.darkness,
        pictures: !s.output.preview.is_empty() || !s.output.report.is_empty(),
        part: (part, height_mm),
    }
}

/// Settings of supports; `None` for jobs without support. `plate_from_part` is the position of the
/// part's origin on the bed, mm; without it, feet may stand anywhere. `painted` holds the enforcers and
/// blockers painted on the part.
pub fn support(
    s: &Settings,
    plate_from_part: Option<DVec2>,
    painted: PaintedSupports,
) -> Option<SupportSettings> {
    let u = &s.support;
    let style = match u.style {
        SupportStyle::None => return None,
        SupportStyle::Tree => Style::Tree,
        SupportStyle::Columns => Style::Columns,
        SupportStyle::Box => Style::Box,
    };
    let (low, high) = machine(s).bed_bounds_mm();
    // Support feet stay a base radius inside the bed; on a small bed no more than a quarter of its
    // shorter side.
    let margin_mm = u.base_radius_mm.min(0.25 * (high[0] - low[0]).min(high[1] - low[1]));
    let bed = plate_from_part.map(|plate_from_part| Bounds2 {
        min: DVec2::new(low[0], low[1]) - plate_from_part + margin_mm,
        max: DVec2::new(high[0], high[1]) - plate_from_part - margin_mm,
    });
    let facets = |all: &[usize]| all.iter().filter_map(|&t| u32::try_from(t).ok()).collect();
    let boxes = |all: &[[[f64; 3]; 2]]| all.iter().map(|b| b.map(DVec3::from)).collect();
    Some(SupportSettings {
        style,
        critical_angle_rad: u.critical_angle_deg.to_radians(),
        // A branch may lean as far as an overhang that prints without support. The bounds keep branches
        // from becoming horizontal or exactly vertical.
        branch_angle_rad: u.branch_angle_deg.unwrap_or(u.critical_angle_deg.clamp(5.0, 80.0)).to_radians(),
        max_unsupported_mm: u.max_unsupported_mm,
        min_overhang_mm: u.min_overhang_mm,
        contact_radius_mm: u.contact_radius_mm,
        tip_length_mm: u.tip_length_mm,
        branch_radius_mm: u.branch_radius_mm,
        base_radius_mm: u.base_radius_mm,
        base_height_mm: u.base_height_mm,
        z_gap_mm: u.z_gap_mm,
        xy_gap_mm: u.xy_gap_mm,
        interface_lines: u.interface_lines,
        interface_layers: u.interface_layers,
        interface_radius_mm: u.interface_radius_mm,
        load_per_contact_n: u.load_per_contact_n,
        side_load_n: u.side_load_n,
        stiffness_mpa: u.stiffness_mpa,
        max_slenderness: u.max_slenderness,
        max_reach_mm: u.max_reach_mm,
        margin_mm: u.margin_mm,
        from_plate_only: u.from_plate_only,
        enforce: boxes(&u.enforce_mm),
        block: boxes(&u.block_mm),
        enforce_facets: facets(&u.enforce_facets),
        block_facets: facets(&u.block_facets),
        walls: walls(s),
        beads: support_beads(s),
        first_layer_mm: s.process.first_layer_height_mm,
        painted,
        bed,
    })
}

/// Settings for walls, at the height of most layers.
fn walls(s: &Settings) -> WallSettings {
    let p = &s.process;
    WallSettings {
        n_walls: p.walls.least(),
        bead_width_mm: p.bead_width_mm,
        height_mm: p.layer_height_mm,
        thin_walls: p.thin_walls,
        gap_fill: p.gap_fill,
        min_bead_width_mm: p.min_bead_width_mm,
        fill_overlap: s.fill.overlap,
    }
}

/// Settings for the beads of supports.
fn support_beads(s: &Settings) -> BeadSettings {
    let (p, u) = (&s.process, &s.support);
    BeadSettings {
        bead_width_mm: p.bead_width_mm,
        min_bead_width_mm: p.min_bead_width_mm,
        walls: u.walls,
        density: Density::new(match u.style {
            SupportStyle::None | SupportStyle::Tree => u.density,
            SupportStyle::Columns | SupportStyle::Box => u.density.max(BASELINE_MIN_DENSITY),
        }),
        dense_layers: u.dense_layers,
    }
}

/// Settings for slicing a scan.
pub fn scan(s: &Settings) -> CtSettings {
    let (c, p) = (&s.ct, &s.process);
    let [x, y] = c.pixel_mm.map_or([None; 2], |p| p.0.map(Some));
    CtSettings {
        section: "shape.ct",
        spacing_mm: [x, y, c.slice_mm],
        scale: s.shape.scale,
        window: c.window,
        crop_px: c.crop_px,
        flip: c.flip.axes(),
        rotate_rad: s.shape.rotate_deg.map(f64::to_radians),
        threshold: match c.threshold {
            choices::Threshold::Otsu => Threshold::Otsu,
            choices::Threshold::Iso50(grey) => Threshold::Iso50(grey.or(c.materials)),
            choices::Threshold::Value(grey) => Threshold::Value(grey),
            choices::Threshold::Range(low, high) => Threshold::Range(low, high),
        },
        denoise: match c.smooth {
            choices::Denoise::None => Denoise::None,
            choices::Denoise::Gaussian => Denoise::Gaussian(c.smooth_px),
            choices::Denoise::Median => Denoise::Median,
            choices::Denoise::Edges => Denoise::Edges,
        },
        tracing: match c.contours {
            Contours::Iso => Tracing::Iso,
            Contours::Canny => Tracing::Canny,
        },
        canny: [c.canny_low, c.canny_high, c.canny_sigma_px],
        interpolation: match c.interpolate {
            Interpolate::Auto => Interpolation::Auto,
            Interpolate::Grey => Interpolation::Grey,
            Interpolate::Matched => Interpolation::Matched,
            Interpolate::Distance => Interpolation::Distance,
        },
        overlap: c.overlap,
        min_island_mm2: c.min_island_mm2,
        min_pore_mm2: c.min_pore_mm2,
        min_piece_mm3: c.min_piece_mm3,
        layer_height_mm: p.layer_height_mm,
        first_layer_height_mm: p.first_layer_height_mm,
        simplify_mm: p.simplify_mm,
    }
}

/// The header of raw scan data; `None` where the job does not state its size.
pub fn raw_header(s: &Settings) -> Option<RawHeader> {
    let c = &s.ct;
    Some(RawHeader {
        size: c.size_px?,
        sample: c.sample,
        big_endian: c.byte_order == ByteOrder::Big,
        offset_bytes: c.offset_bytes as u64,
    })
}

/// Settings of the guide by stress; `None` for other guides.
pub fn stress(s: &Settings, deck: Option<&DeckConditions>) -> Option<StressSettings> {
    let (g, m) = (&s.guide, &s.material);
    let own = || match g.elasticity {
        Elasticity::Orthotropic => Orthotropic { e_mpa: m.e_mpa, nu: m.nu, g_mpa: m.g_mpa },
        // The bounds keep the isotropic law stable for any material card.
        Elasticity::Isotropic => Orthotropic::isotropic(m.e_mpa[0], m.nu[0].clamp(-0.9, 0.49)),
    };
    let of_deck = deck.and_then(|deck| deck.material);
    (g.kind == GuideKind::Stress).then(|| StressSettings {
        analysis: g.analysis,
        element_mm: g.element_mm,
        material: of_deck.map_or_else(own, |m| Orthotropic::isotropic(m.young_mpa, m.poisson)),
        elasticity: g.elasticity,
        bead_axis_rad: g.elasticity_deg.to_radians(),
        max_mib: g.memory_mib as f64,
        strength_mpa: m.xt_mpa.map(|bounds| bounds[1]),
        follow: g.follow,
        smoothing_mm: s.smoothing_mm(),
        tangent: g.tangent,
        cell_mm: s.process.bead_width_mm,
        mix: mixes_cases(s, deck).then(|| card_of_infill(s)).flatten(),
    })
}

/// Whether the layers of a job serve its load cases alternately, those of its deck included.
fn mixes_cases(s: &Settings, deck: Option<&DeckConditions>) -> bool {
    let g = &s.guide;
    let of_deck = deck.map_or(0, |deck| deck.steps.len());
    let n_cases = g.case.len() + usize::from(!g.load.is_empty()) + of_deck;
    let follows = |pattern: choices::Pattern| pattern.follows_field();
    let patterns = std::iter::once(s.fill.pattern).chain(s.regions.iter().filter_map(|r| r.pattern));
    g.kind == GuideKind::Stress
        && g.import.is_empty()
        && n_cases > 1
        && g.case_mix == CaseMix::Reserve
        // If layers already alternate between tension and compression, they cannot alternate between cases.
        && g.follow != choices::Follow::Alternate
        && (patterns.into_iter().any(follows) || (s.fibre.enabled && follows(s.fibre.matrix_pattern)))
}

/// The nominal strength card of the infill's material; `None` for a material without strengths.
fn card_of_infill(s: &Settings) -> Option<StrengthCard> {
    strength(s).cards(CORNERS[0]).ok().and_then(|cards| cards.last().copied())
}

/// Warns if layers should serve several load cases alternately, but the material's strengths are unknown.
pub(crate) fn warn_of_mix(s: &Settings, deck: Option<&DeckConditions>, diagnostics: &Diagnostics) {
    if mixes_cases(s, deck) && card_of_infill(s).is_none() {
        let text = "the material has no strengths, so load cases cannot be compared: all layers follow the weighted sum of the cases";
        diagnostics.warn(WarningId::CasesByWeight, text);
    }
}

/// Settings of the virtual strength test.
pub fn strength(s: &Settings) -> StrengthSettings {
    StrengthSettings {
        fidelity: s.strength.fidelity,
        cell_mm: s.strength.cell_mm,
        check: s.strength.check,
        corners: s.strength.corners,
        max_mib: s.guide.memory_mib as f64,
        bead_mm: s.process.bead_width_mm,
        filament_mm: s.printer.filament_mm,
        material: s.material.clone(),
        fibre: s.fibre.enabled.then(|| s.fibre_material.clone()),
        keep_model: false,
    }
}

/// The fixtures and loads of the job, and those of `guide.deck`.
pub fn loads<'a>(s: &'a Settings, deck: Option<&'a DeckConditions>) -> TypedLoads<'a> {
    let g = &s.guide;
    // 1 t/mm3 is 1e9 g/cm3.
    let of_deck = deck.and_then(|deck| deck.material?.density_t_mm3).map(|density| 1e9 * density);
    let density_g_cm3 = of_deck.unwrap_or(s.material.density_g_cm3);
    TypedLoads { fixtures: &g.fixture, loads: &g.load, cases: &g.case, density_g_cm3, frame: g.frame, deck }
}

/// The supports and loads in the file of `guide.deck`, with the deck's material only if the job asks for it.
///
/// # Errors
/// [`FeError`] as for [`FeFile::deck_conditions`], and if the job asks for the material of a deck that has no single
/// isotropic material.
pub fn deck(s: &Settings, file: &FeFile) -> Result<DeckConditions, FeError> {
    let options = FeOptions { step: s.guide.deck_step, ..import(s) };
    let mut found = file.deck_conditions(&options)?;
    found.material = s.guide.deck_material.then(|| found.needed_material()).transpose()?;
    Ok(found)
}

/// Position and rotation of a part that was lowered by `lowered_mm`. Parts from scans and photographs are neither
/// turned nor scaled again, because this is done when they are read.
pub fn standing(s: &Settings, lowered_mm: f64) -> Standing {
    let is_file = s.ct.path.is_empty() && s.photo.files.is_empty();
    let turn = if is_file { s.shape.rotate_deg.map(f64::to_radians) } else { [0.0; 3] };
    Standing::new(if is_file { s.shape.scale } else { 1.0 }, turn, lowered_mm)
}

/// Settings of the pattern `continuous`, which fills each infill region with one path.
pub(crate) fn continuous(s: &Settings) -> Continuous {
    let isotropic = s.guide.kind == GuideKind::None;
    Continuous {
        // Cells of length 1 are square.
        // Without a guide no direction is better than another, so cells are square and joined
        // without regard to direction.
        tree: match s.fill.tree {
            CellTree::Directed if !isotropic => TreeKind::Directed,
            CellTree::Directed | CellTree::Undirected => TreeKind::Undirected,
        },
        aspect: if isotropic { 1.0 } else { s.fill.cell_aspect },
        // A bead with fibre has a constant width.
        variable: s.fill.widths == BeadWidths::Variable && !s.fibre.enabled,
    }
}

/// Settings of the steps from sections to paths.
pub fn steps(s: &Settings) -> StepSettings {
    let (p, f) = (&s.process, &s.fill);
    // This height is a placeholder: each layer uses its own height.
    let height_mm = p.layer_height_mm;
    StepSettings {
        walls: walls(s),
        most_walls: p.walls.most(),
        stagger_walls: p.stagger_walls,
        skins: SkinSettings {
            top_layers: p.top_layers,
            bottom_layers: p.bottom_layers,
            spacing_mm: bead_spacing_mm(p.bead_width_mm, height_mm),
            // A required mass is reached with sparse infill, which needs skins.
            dense: f.density.is_dense() && f.mass_g.is_none(),
        },
        infill: infill(s),
        supports: support_beads(s),
        adhesion: AdhesionSettings {
            brim_width_mm: p.brim_width_mm,
            skirt_loops: p.skirt_loops,
            skirt_distance_mm: p.skirt_distance_mm,
            bead_width_mm: p.bead_width_mm,
            height_mm,
        },
        skirt_layers: p.skirt_layers,
        regions: s.regions.iter().map(|r| region(s, r)).collect(),
    }
}

/// The settings inside a region of the job.
fn region(s: &Settings, region: &JobRegion) -> RegionSettings {
    RegionSettings { steps: steps(&s.in_region(region)), guided: region.guide }
}

/// Least density of columns and boxes: their walls alone would not carry the layers of the part
/// above.
const BASELINE_MIN_DENSITY: f64 = 0.15;

/// Placeholder for a graded density that is not known yet. Source: chosen; any number between hollow and dense gives the
/// same result.
const GRADED: f64 = 0.5;

/// The nominal strength card of the material, with which stress is compared; `None` for a material without strengths.
pub(crate) fn nominal_card(s: &Settings) -> Option<StrengthCard> {
    strength(s).bounding_cards().ok().map(|[_, nominal, _]| nominal)
}

/// Settings for a graded density; `None` for other densities.
pub(crate) fn graded_density(
    s: &Settings,
    lowered_mm: f64,
    plate_from_part_mm: DVec3,
) -> Option<DensitySettings> {
    let graded = s.fill.density.graded()?;
    let place = FieldSettings {
        frame: choices::FieldFrame::Part,
        cell_mm: None,
        origin_mm: None,
        ..field(s, lowered_mm, plate_from_part_mm)
    };
    Some(DensitySettings {
        range: [graded.min, graded.max],
        by: graded.by,
        spacing_mm: bead_spacing_mm(s.process.bead_width_mm, s.process.layer_height_mm),
        card: nominal_card(s),
        place,
    })
}

fn infill(s: &Settings) -> InfillSettings {
    let f = &s.fill;
    let mass = |m: &MaterialSection| ExtrudedMass { density_g_cm3: m.density_g_cm3, flow: m.flow };
    InfillSettings {
        pattern: f.pattern,
        // A graded density replaces this value once the part is known.
        density: f.density.even().unwrap_or(Density::Sparse(GRADED)),
        graded: f.density.graded().is_some(),
        mass_g: f.mass_g,
        material: mass(&s.material),
        fibre_material: mass(&s.fibre_material),
        angles: raster_angles(&f.angles_deg),
        skin_angles: f.skin_angles_deg.as_ref().map(raster_angles),
        several: (f.lines > 1).then_some(SideBySide {
            pattern: f.pattern,
            beads: f.lines,
            continuous: continuous(s),
            fit: LineFit::NONE,
        }),
        guide_angle_rad: match s.guide.kind {
            GuideKind::Angle => Some(s.guide.angle_deg.to_radians()),
            GuideKind::None | GuideKind::Stress | GuideKind::Grain | GuideKind::Field => None,
        },
        field_axis_rad: s.guide.angle_deg.to_radians(),
        bridge_flow: s.process.bridge_flow,
        max_unsupported_mm: s.support.max_unsupported_mm,
        chain: s.process.chain,
        matrix_pattern: s.fibre.matrix_pattern,
        matrix_density: s.fibre.matrix_density,
        ends: f.ends,
        layer_shift: layer_shift(s),
        widths: f.widths,
        spiral: f.spiral,
        continuous: continuous(s),
    }
}

fn raster_angles(angles: &LayerAngles) -> RasterAngles {
    let radians = |all: &[f64]| all.iter().map(|deg| deg.to_radians()).collect();
    let range = |r: &AngleRange| (r.first_layer - 1, radians(&r.angles_deg));
    RasterAngles { ranges: angles.ranges().iter().map(range).collect() }
}

/// Which ends of beads differ from layer to layer; `None` where all layers are laid alike.
fn layer_shift(s: &Settings) -> Option<Ends> {
    match s.fill.layer_shift {
        // Fibre parts carry 5 to 55 % more with it, others as much as without (docs/stress.md).
        LayerShift::Auto if s.fibre.enabled && s.allows_layer_shift() => Some(Ends::Inner),
        LayerShift::Auto | LayerShift::None => None,
        LayerShift::Inner => Some(Ends::Inner),
        LayerShift::All => Some(Ends::All),
    }
}

/// Settings of printing order, seams and travel.
pub fn order(s: &Settings) -> OrderSettings {
    let p = &s.process;
    OrderSettings {
        wall_order: p.wall_order,
        seam: p.seam,
        comb: CombSettings {
            comb: p.comb,
            retract_min_mm: p.retract_min_travel_mm,
            max_detour: 2.0,
            clearance_mm: p.bead_width_mm,
        },
        // With one tool, fibre is printed in the order of the shortest travel. With two tools, a
        // change of tool costs more than any travel, so fibre comes last.
        fibre_last: s.fibre.enabled && s.printer.fibre_tool == FibreToolKind::Separate,
        chain_mm: p.chain.then_some(2.0 * p.bead_width_mm),
        starts_apart_mm: if layer_shift(s).is_some() { shift::STEP_MM } else { 0.0 },
    }
}

/// Speeds and accelerations of the printer, for the time estimate.
pub fn limits(s: &Settings) -> Limits {
    let p = &s.printer;
    // No setting states the cruise ratio or the division of arcs, so the firmware's defaults are used.
    let (min_cruise_ratio, arc_segment_mm) = match flavour(s) {
        Flavour::Klipper => (KLIPPER_MIN_CRUISE_RATIO, KLIPPER_ARC_SEGMENT_MM),
        Flavour::Marlin | Flavour::RepRapFirmware => (0.0, Limits::default().arc_segment_mm),
    };
    Limits {
        min_cruise_ratio,
        arc_segment_mm,
        max_speed_mm_s: p.max_speed_mm_s,
        acceleration_mm_s2: p.acceleration_mm_s2,
        travel_acceleration_mm_s2: p.travel_acceleration_mm_s2,
        retract_acceleration_mm_s2: p.retract_acceleration_mm_s2,
        // Firmware has three conventions for the speed at corners. The job may state any of them; the
        // first stated one in this order is used.
        corner: match (p.square_corner_mm_s, p.junction_deviation_mm) {
            (Some(v), _) => Corner::SquareCorner(v),
            (None, Some(d)) => Corner::Deviation(d),
            (None, None) => Corner::Jerk(p.jerk_mm_s),
        },
    }
}

fn flavour(s: &Settings) -> Flavour {
    match s.printer.flavour {
        choices::Flavour::Marlin => Flavour::Marlin,
        choices::Flavour::Klipper => Flavour::Klipper,
        choices::Flavour::Rrf => Flavour::RepRapFirmware,
    }
}

pub(crate) fn machine(s: &Settings) -> Machine {
    let p = &s.printer;
    Machine {
        flavour: flavour(s),
        nozzle_mm: p.nozzle_mm,
        filament_mm: p.filament_mm,
        bed_mm: p.bed_mm,
        origin_at_centre: p.origin == BedOrigin::Centre,
        limits: limits(s),
        relative_e: p.relative_e,
        start_gcode: p.start_gcode.clone(),
        end_gcode: p.end_gcode.clone(),
    }
}

fn material(m: &MaterialSection) -> Material {
    Material {
        name: m.name.clone(),
        density_g_cm3: m.density_g_cm3,
        nozzle_temp_c: m.nozzle_temp_c,
        first_layer_nozzle_temp_c: m.first_layer_nozzle_temp_c,
        bed_temp_c: m.bed_temp_c,
        first_layer_bed_temp_c: m.first_layer_bed_temp_c,
        flow: m.flow,
        pressure_advance: m.pressure_advance,
        max_volumetric_mm3_s: m.max_volumetric_mm3_s,
    }
}

/// Settings of continuous fibre; `None` for jobs without fibre.
pub(crate) fn fibre(s: &Settings, n_layers: usize, plate_from_part_mm: DVec3) -> Option<FibreSettings> {
    let f = &s.fibre;
    f.enabled.then(|| FibreSettings {
        layers: f.layers.clone(),
        matrix_layers: f.matrix_layers,
        n_layers,
        plate_from_part_mm: plate_from_part_mm.truncate(),
        rings: f.rings,
        every: f.every,
        boxes: f.boxes_mm.iter().map(|b| b.map(DVec3::from)).collect(),
        bead_width_mm: f.bead_width_mm.unwrap_or(s.process.bead_width_mm),
        min_radius_mm: f.min_radius_mm,
        turns: f.turns,
        // The fibre is cut one cutter distance before the end of a path, and must adhere by then.
        min_length_mm: f.min_length_mm.max(s.printer.fibre_cutter_mm + f.anchor_mm),
        start: f.start,
    })
}

/// Whether beads may not share the load evenly anywhere: infill may be sparse there, ends of beads lie open at the border
/// because no wall closes it, or fibre lies beside a matrix that is 10 to 20 times softer.
pub(crate) fn loads_beads_unevenly(s: &Settings) -> bool {
    let is_open =
        |s: &Settings| !s.fill.density.is_dense() || s.fill.mass_g.is_some() || s.process.walls.least() == 0;
    is_open(s) || s.regions.iter().any(|r| is_open(&s.in_region(r))) || s.fibre.enabled
}

/// Width of beads with fibre, mm, if the whole part is dense. In a dense part the width decides how much
/// stays unfilled.
pub fn dense_fibre_width_mm(s: &Settings) -> Option<f64> {
    let f = &s.fibre;
    // If only some layers or places have fibre, the part is dense only if the matrix is dense
    // too.
    let everywhere =
        f.layers.is_empty() && f.boxes_mm.is_empty() && f.every == 1 && f.matrix_layers == [0, 0];
    let dense = s.fill.density.is_dense() && (everywhere || f.matrix_density.is_dense());
    (f.enabled && dense).then(|| f.bead_width_mm.unwrap_or(s.process.bead_width_mm))
}

pub(crate) fn writing(s: &Settings) -> WriteConfig {
    let (p, m, pr) = (&s.process, &s.material, &s.printer);
    let header = [("material", m.name.as_str()), ("fill", s.fill.pattern.name())];
    WriteConfig {
        machine: machine(s),
        material: material(m),
        speeds: Speeds {
            outer_wall: p.outer_wall_speed_mm_s,
            inner_wall: p.inner_wall_speed_mm_s,
            small_wall: p.small_wall_speed_mm_s,
            overhang: p.overhang_speed_mm_s,
            gap_fill: p.gap_fill_speed_mm_s,
            solid: p.solid_speed_mm_s,
            top: p.top_speed_mm_s,
            sparse: p.sparse_speed_mm_s,
            bridge: p.bridge_speed_mm_s,
            fibre: s.fibre.speed_mm_s,
            support: s.support.speed_mm_s,
            support_interface: s.support.interface_speed_mm_s,
            adhesion: p.first_layer_speed_mm_s,
            travel: p.travel_speed_mm_s,
            travel_z: p.travel_z_speed_mm_s,
            first_layer: p.first_layer_speed_mm_s,
        },
        cooling: Cooling {
            fan_min: m.fan_min,
            fan_max: m.fan_max,
            fan_bridge: m.fan_bridge,
            fan_support: s.support.fan,
            fan_off_layers: m.fan_off_layers,
            min_layer_time_s: m.min_layer_time_s,
            fan_below_layer_time_s: m.fan_below_layer_time_s,
            min_speed_mm_s: m.min_speed_mm_s,
        },
        retraction: Retraction {
            length_mm: pr.retract_mm,
            speed_mm_s: pr.retract_speed_mm_s,
            unretract_speed_mm_s: pr.unretract_speed_mm_s,
            z_hop_mm: pr.z_hop_mm,
        },
        fibre: s.fibre.enabled.then(|| FibreTool {
            tool: (pr.fibre_tool == FibreToolKind::Separate).then_some(pr.fibre_tool_number),
            tool_change_gcode: pr.tool_change_gcode.clone(),
            feed_gcode: pr.fibre_feed_gcode.clone(),
            cut_gcode: pr.fibre_cut_gcode.clone(),
            cutter_mm: pr.fibre_cutter_mm,
            anchor_mm: s.fibre.anchor_mm,
            anchor_speed_mm_s: s.fibre.anchor_speed_mm_s,
            filament_mm: pr.fibre_filament_mm.unwrap_or(pr.filament_mm),
            material: material(&s.fibre_material),
        }),
        arc_tolerance_mm: p.arcs.then_some(p.arc_tolerance_mm),
        header: header.iter().map(|(key, value)| format!("{key} = {value}")).collect(),
    }
}

/// Settings for reading the file of `guide.field`.
pub fn directions(s: &Settings) -> DirectionOptions {
    let f = &s.field;
    DirectionOptions {
        length_unit: f.length_unit,
        angle_unit: f.angle_unit.map(|unit| match unit {
            FieldAngleUnit::Deg => AngleUnit::Degree,
            FieldAngleUnit::Rad => AngleUnit::Radian,
        }),
        axes: f.axes.map(|axes| match axes {
            FieldAxes::Yx => GridAxes::Yx,
            FieldAxes::Xy => GridAxes::Xy,
            FieldAxes::Image => GridAxes::Image,
        }),
        array: f.array.clone(),
        cell_mm: f.cell_mm,
    }
}

/// Settings that place the directions of `guide.field` on the part. Scans and photographs are turned and scaled when they
/// are read.
pub(crate) fn field(s: &Settings, lowered_mm: f64, plate_from_part_mm: DVec3) -> FieldSettings {
    let (f, shape) = (&s.field, &s.shape);
    let is_file = s.ct.path.is_empty() && s.photo.files.is_empty();
    FieldSettings {
        frame: f.frame,
        cell_mm: f.cell_mm,
        origin_mm: f.origin_mm.map(DVec2::from),
        scale: if is_file { shape.scale } else { 1.0 },
        rotate_rad: if is_file { shape.rotate_deg.map(f64::to_radians) } else { [0.0; 3] },
        lowered_mm,
        plate_from_part_mm,
    }
}

/// Units and component order of the stress result named by `guide.import`; the units are also used for `guide.deck`.
pub fn import(s: &Settings) -> FeOptions {
    let g = &s.guide;
    FeOptions {
        length_unit: g.import_length_unit,
        stress_unit: g.import_stress_unit.map(|unit| match unit {
            choices::StressUnit::MPa => StressUnit::Megapascal,
            choices::StressUnit::Pa => StressUnit::Pascal,
            choices::StressUnit::KPa => StressUnit::Kilopascal,
            choices::StressUnit::GPa => StressUnit::Gigapascal,
            choices::StressUnit::Psi => StressUnit::Psi,
            choices::StressUnit::Ksi => StressUnit::Ksi,
        }),
        stress_array: g.import_array.clone(),
        order: g.import_order.map(|order| match order {
            ComponentOrder::Vtk => Order::Vtk,
            ComponentOrder::Abaqus => Order::Abaqus,
            ComponentOrder::Voigt => Order::Voigt,
        }),
        step: None,
    }
}
