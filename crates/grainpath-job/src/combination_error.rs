//! Settings that are each valid and do not fit together.

use thiserror::Error;

use crate::choices::{Choice, LayerShift, Pattern};

/// Error text for a setting that follows the stress while the job has none.
const NEEDS_STRESS: &str =
    "by = \"stress\" needs a stress: [guide] kind = \"stress\" with fixtures and loads, or with guide.import";

/// Settings that do not fit together. The text names them and says what would fit.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs)]
pub enum Combination {
    // Beads and layers.
    #[error("process.bead_width_mm ({width_mm}) should not be less than the layer height ({height_mm})")]
    BeadWidth { width_mm: f64, height_mm: f64 },
    #[error("process.min_bead_width_mm ({least_mm}) should not be more than bead_width_mm ({width_mm})")]
    LeastBeadWidth { least_mm: f64, width_mm: f64 },
    #[error("process.adaptive_min_mm should not be more than adaptive_max_mm")]
    AdaptiveHeights,
    #[error("material.{key} should rise: low, nominal, high; is [{}, {}, {}]", .values[0], .values[1], .values[2])]
    Strengths { key: &'static str, values: [f64; 3] },
    // Shapes.
    #[error("{first} and {second}: exactly one shape is printed")]
    TwoShapes { first: &'static str, second: &'static str },
    #[error("process.adaptive_layers = true is for meshes, not for {shape}")]
    AdaptiveLayers { shape: &'static str },
    #[error("support.lift_mm is for meshes, not for shape.ct")]
    LiftOfScan,
    #[error("shape.outline needs shape.thickness_mm")]
    OutlineThickness,
    #[error(
        "a photograph needs the size of its board in mm: shape.photo.size_mm=[WIDTH,HEIGHT] and shape.photo.thickness_mm=N"
    )]
    PhotoSize,
    // The guide.
    #[error("fill.pattern = {:?} needs a guide: [guide] kind = \"stress\", \"field\" or \"angle\"", .0.name())]
    PatternWithoutGuide(Pattern),
    #[error("guide.kind = \"field\" needs a file of directions: guide.field = \"FILE\"")]
    FieldWithoutFile,
    #[error("{key} needs a deck: guide.deck = \"FILE.inp\"")]
    NoDeck { key: &'static str },
    #[error(
        "guide.deck and guide.import: stress is either solved from the loads of a deck or taken as it is"
    )]
    DeckAndImport,
    #[error("guide.deck is for parts from meshes and outlines")]
    DeckOfOther,
    #[error("guide.image and guide.volume: exactly one gives the grain")]
    ImageAndVolume,
    #[error(
        "guide.kind = \"grain\" needs photographs or a scan: guide.image = {{ files = [\"FILE\"] }} or guide.volume = {{ path = \
         \"SCAN\" }}"
    )]
    NoGrain,
    #[error("guide.mode = \"edges\" is for photographs; a scan's texture gives directions")]
    EdgesOfScan,
    #[error("guide.volume is for meshes and scans; shape.photo has its own grain")]
    PhotoAndVolume,
    #[error(
        "{section}.corners_px should have 4 corners, or 4 for each of the {files} files; it has {corners}"
    )]
    Corners { section: &'static str, files: usize, corners: usize },
    #[error("{section}.heights_mm should have a height for each of the {files} files; it has {heights}")]
    Heights { section: &'static str, files: usize, heights: usize },
    #[error("{section}.heights_mm should rise from file to file")]
    HeightsFall { section: &'static str },
    // Infill and walls.
    #[error("fill.{key} should have at least one angle")]
    NoAngle { key: &'static str },
    #[error("fill.skin_angles_deg is for skins over sparse infill; with fill.density = 1 there is none")]
    SkinsOfDense,
    #[error("fill.lines = {lines} {problem}")]
    Lines { lines: usize, problem: LinesProblem },
    #[error("fill.layer_shift = {:?} {problem}", .shift.name())]
    LayerShift { shift: LayerShift, problem: LayerShiftProblem },
    #[error("fill.density {0}")]
    Graded(GradedProblem),
    #[error("process.walls {0}")]
    Walls(WallsProblem),
    #[error("process.stagger_walls {0}")]
    Staggered(StaggerProblem),
    // Regions, whose numbers count from 1.
    #[error(
        "[[region]] is not for fibre.enabled = true; fibre.boxes_mm and fibre.layers say where fibre lies"
    )]
    RegionsWithFibre,
    #[error("region[{0}].on: mesh and face are for parts from meshes and outlines")]
    RegionPlace(usize),
    #[error("in region[{number}]: {problem}")]
    InRegion { number: usize, problem: Box<Combination> },
    // Continuous fibre.
    #[error(
        "fibre.enabled = true needs a printer with a fibre tool: printer.fibre_tool = \"coextruded\" or \"separate\", or a \
         profile such as fibre-coextruded"
    )]
    NoFibreTool,
    #[error("fibre.enabled = true needs printer.fibre_cut_gcode, the program that cuts the fibre")]
    NoFibreCut,
    #[error("printer.fibre_tool_number should not be 0, which is the matrix's")]
    FibreToolNumber,
    #[error("printer.fibre_tool = \"separate\" needs printer.tool_change_gcode")]
    NoToolChange,
    #[error("fibre.layers should be [first, last] from 1, is [{}, {}]", .0[0], .0[1])]
    FibreLayers([usize; 2]),
    #[error("fibre.boxes_mm should be [lowest corner, highest corner], has {0:?}")]
    FibreBox([[f64; 3]; 2]),
    #[error("fibre.bead_width_mm ({0}) should not be less than the layer height")]
    FibreWidth(f64),
    #[error("fibre.start = \"calm\" needs [guide] kind = \"stress\"")]
    FibreStart,
    #[error("fibre.enabled = true needs fill.density above 0")]
    FibreWithoutInfill,
    #[error("fibre.matrix_pattern = {:?} needs a guide", .0.name())]
    MatrixPattern(Pattern),
}

/// Why infill cannot have lines of several beads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[allow(missing_docs)]
pub enum LinesProblem {
    #[error("needs fill.density below 1: the lines of dense infill leave no room between them")]
    Dense,
    #[error("is for patterns of separate lines, not for fill.pattern = \"seed-lines\" or \"continuous\"")]
    Pattern,
    #[error("is not for guide.kind = \"grain\", whose lines are those of the picture")]
    Grain,
    #[error("is not for fibre.enabled = true")]
    Fibre,
}

/// Why the ends of beads cannot be moved from layer to layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[allow(missing_docs)]
pub enum LayerShiftProblem {
    #[error("is for fill.pattern = \"stripes\" or \"continuous\", not for {:?}", .0.name())]
    Pattern(Pattern),
    #[error("needs fill.density = 1: it moves the ends of beads that lie side by side")]
    Sparse,
    #[error("is not for guide.mode = \"edges\", whose lines are those of the picture")]
    Edges,
}

/// Why the density cannot be graded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[allow(missing_docs)]
pub enum GradedProblem {
    #[error(
        "as a table is not for fill.pattern = {:?}, whose lines cannot end or begin along the way; use \"stripes\", \
         \"streamlines\" or \"continuous\" along a guide, or \"rectilinear\", \"grid\", \"triangles\", \"gyroid\" or \
         \"honeycomb\"",
        .0.name()
    )]
    Pattern(Pattern),
    #[error("{NEEDS_STRESS}")]
    NoStress,
    #[error("by = \"file\" is for parts from meshes and outlines")]
    FileOfOther,
    #[error("as a table is not for fill.lines above 1")]
    Lines,
    #[error("as a table is not for fibre.enabled = true")]
    Fibre,
    #[error("as a table is not for guide.kind = \"grain\"")]
    Grain,
}

/// Why the number of walls cannot follow the stress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[allow(missing_docs)]
pub enum WallsProblem {
    #[error("{NEEDS_STRESS}")]
    NoStress,
    #[error("as a table is not for jobs with [[region]]; give the regions numbers of walls of their own")]
    Regions,
}

/// Why walls cannot be raised by half a layer.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[allow(missing_docs)]
pub enum StaggerProblem {
    #[error("is not for fibre.enabled = true, whose fibre lies level")]
    Fibre,
    #[error("is not for process.chain = true, whose path joins walls and infill at one height")]
    Chain,
    #[error("needs two walls at least, since the outermost stays level; process.walls is {0}")]
    OneWall(usize),
    #[error(
        "begins with beads of {} mm, 1.5 layers, which a bead of {width_mm} mm cannot be high; make layers thinner or beads wider",
        (highest_mm * 1e3).round() * 1e-3
    )]
    TooHigh { highest_mm: f64, width_mm: f64 },
}
