//! Settings that are chosen from a list of words: one enum for each list.
//!
//! Each word is written once, in the table below, with the sentence that explains it. The parser, the JSON Schema and the
//! reference page are made from that table. The planner's stages match on the enums, so the compiler finds every place where
//! a new word must be handled.
//!
//! ```
//! use grainpath_job::choices::{Choice, Pattern};
//!
//! assert_eq!(Pattern::from_word("seed-lines"), Some(Pattern::SeedLines));
//! assert_eq!(Pattern::Gyroid.name(), "gyroid");
//! assert!(Pattern::Stripes.follows_field() && !Pattern::Grid.follows_field());
//! assert_eq!(Pattern::ALL.len(), Pattern::WORDS.len());
//! ```

use grainpath_core::slices::SampleType;
use grainpath_core::units::LengthUnit;

/// A word of a choice, and its meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    /// The word in a job file.
    pub name: &'static str,
    /// Meaning, written as the end of a sentence; empty if the word explains itself.
    pub help: &'static str,
}

/// A setting with a fixed list of words.
pub trait Choice: Copy + PartialEq + 'static {
    /// The words, in the order of [`Choice::ALL`].
    const WORDS: &'static [Word];
    /// Every value, in the order of the documentation.
    const ALL: &'static [Self];

    /// The value of a word.
    // Words are few, so a search through the list is as fast as a map and needs no second table.
    fn from_word(word: &str) -> Option<Self> {
        let i = Self::WORDS.iter().position(|w| w.name == word)?;
        Self::ALL.get(i).copied()
    }

    /// The word of this value.
    fn name(self) -> &'static str {
        let i = Self::ALL.iter().position(|v| *v == self);
        i.and_then(|i| Self::WORDS.get(i)).map_or("", |w| w.name)
    }
}

/// Generates an enum and its words from one list, so that they cannot differ.
macro_rules! choices {
    ($( $(#[$about:meta])* enum $name:ident { $( $variant:ident = $word:literal, $help:literal; )* } )*) => {
        $(
            $(#[$about])*
            #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
            pub enum $name {
                // The help sentence is also the documentation of the variant, so the two cannot differ. `a[y][x]` in it is
                // not a link.
                $( #[allow(rustdoc::broken_intra_doc_links)] #[doc = concat!("`", $word, "`: ", $help)] $variant, )*
            }

            impl Choice for $name {
                const WORDS: &'static [Word] = &[$( Word { name: $word, help: $help }, )*];
                const ALL: &'static [Self] = &[$( Self::$variant, )*];
            }
        )*
    };
}

choices! {
    /// Rule for the material in a drawing (`shape.outline_rule`).
    enum OutlineRule {
        File = "file", "filled shapes are material, and so is the inside of closed lines without fill.";
        EvenOdd = "even-odd", "every closed line counts; each line inside another one is a hole in it, and so on inwards.";
    }
    /// Treatment of defects of a mesh (`shape.repair`).
    enum Repair {
        Auto = "auto", "defects are repaired, and a warning counts them.";
        Strict = "strict", "a mesh with defects is refused.";
    }
    /// Method that finds the board in a photograph (`corners`).
    enum BoardCorners {
        Image = "image", "the board fills the whole image.";
        Outline = "outline", "the board is found by its outline on a plain background.";
        Markers = "markers", "the board lies on a sheet printed with `grainpath markers`.";
    }
    /// Axes along which a scan is mirrored (`flip`).
    enum Flip {
        // The empty word is the default and means no axis.
        None = "", "";
        X = "x", "";
        Y = "y", "";
        Z = "z", "";
        Xy = "xy", "";
        Xz = "xz", "";
        Yz = "yz", "";
        Xyz = "xyz", "";
    }
    /// Noise filter of a scan's slices (`shape.ct.smooth`).
    enum Denoise {
        None = "none", "no filter.";
        Gaussian = "gaussian", "Gaussian blur by `smooth_px`.";
        Median = "median", "median of 3 x 3 pixels.";
        Edges = "edges", "smooths surfaces and keeps edges sharp.";
    }
    /// Method that makes layers between the slices of a scan (`shape.ct.interpolate`).
    enum Interpolate {
        Auto = "auto", "`grey` where slices lie as close as pixels, else `matched`.";
        Grey = "grey", "grey values are interpolated.";
        Matched = "matched", "contours of neighbouring slices are matched and morphed.";
        Distance = "distance", "signed distances to the contours are interpolated.";
    }
    /// Method that finds the contours of a scan (`shape.ct.contours`).
    enum Contours {
        Iso = "iso", "where the grey value crosses the threshold, between pixels.";
        Canny = "canny", "Canny's edges with feature points, as published for CT-based printing.";
    }
    /// Order of the bytes of a raw scan (`shape.ct.byte_order`).
    enum ByteOrder {
        Little = "little", "least significant byte first.";
        Big = "big", "most significant byte first.";
    }
    /// Position of the machine's origin (`printer.origin`).
    enum BedOrigin {
        Corner = "corner", "x = y = 0 is the front left corner of the bed.";
        Centre = "centre", "x = y = 0 is the middle of the bed.";
    }
    /// G-code dialect (`printer.flavour`).
    enum Flavour {
        Marlin = "marlin", "Marlin and firmware that follows it.";
        Klipper = "klipper", "Klipper.";
        Rrf = "rrf", "RepRapFirmware (Duet).";
    }
    /// The printer's tool for continuous fibre (`printer.fibre_tool`).
    enum FibreToolKind {
        None = "none", "the printer lays no continuous fibre.";
        Coextruded = "coextruded", "one nozzle lays fibre and matrix together.";
        Separate = "separate", "the fibre has a nozzle of its own.";
    }
    /// Evidence for the strengths of a material (`material.strength_tier`).
    enum StrengthTier {
        T0 = "T0", "data sheets and literature.";
        T1 = "T1", "tests of coupons printed on this machine.";
        T2 = "T2", "T1, and confirmed by the test of a whole part.";
    }
    /// Order of the walls of a contour (`process.wall_order`).
    enum WallOrder {
        InnerFirst = "inner-first", "from the fill outwards: cleaner overhangs.";
        OuterFirst = "outer-first", "the outer wall first: more exact dimensions.";
    }
    /// Place where outer walls begin and end (`process.seam`).
    enum Seam {
        Nearest = "nearest", "at the point nearest to the nozzle: least travel.";
        Aligned = "aligned", "above the seam of the layer below; a new seam begins at the sharpest corner.";
        Rear = "rear", "at the largest y.";
        Random = "random", "anywhere on the wall; the same place in every run.";
    }
    /// Source of the infill's direction (`guide.kind`).
    enum GuideKind {
        None = "none", "the raster angles of `fill.angles_deg`.";
        Angle = "angle", "`guide.angle_deg`, for all infill.";
        Stress = "stress", "the principal stresses under the job's loads, or of `guide.import`.";
        Grain = "grain", "the grain of photographs, or the texture of a scan.";
        Field = "field", "your own directions, from the file of guide.field.";
    }
    /// Coordinates of fixtures and loads (`guide.frame`).
    enum LoadFrame {
        Placed = "placed", "those of the part as `[shape]` scales and turns it, standing on z = 0.";
        Part = "part", "those of the shape's file, in mm: places, forces, moments, accelerations and displacements turn with the part, and places grow with it.";
    }
    /// Coordinates of the positions in a file of directions (`guide.field.frame`).
    enum FieldFrame {
        Part = "part", "those of the shape's file, in mm; directions turn and grow with the part.";
        Plate = "plate", "those of the bed, as in the G-code.";
    }
    /// Unit of the angles in a file of directions (`guide.field.angle_unit`).
    enum FieldAngleUnit {
        Deg = "deg", "degrees.";
        Rad = "rad", "radians.";
    }
    /// Order of the indices of a grid of directions (`guide.field.axes`).
    enum FieldAxes {
        Yx = "yx", "a[y][x]: rows rise with y, columns with x, as from `numpy.meshgrid`.";
        Xy = "xy", "a[x][y]: rows rise with x, columns with y, as `vector_slicer` writes.";
        Image = "image", "rows from the top downwards, columns rise with x.";
    }
    /// Principal stress that beads follow (`guide.follow`).
    enum Follow {
        MaxAbs = "max-abs", "the one of larger magnitude.";
        Tension = "tension", "the largest tension.";
        Compression = "compression", "the largest compression.";
        Alternate = "alternate", "both, in turn from layer to layer.";
    }
    /// How layers serve several load cases (`guide.case_mix`).
    enum CaseMix {
        Reserve = "reserve", "layers follow the cases in turn, in the mix whose least reserve over all cases is largest; weights decide between equal mixes.";
        Weights = "weights", "all layers follow one sum of the cases, each times its weight.";
    }
    /// Model of the stress analysis (`guide.analysis`).
    enum Analysis {
        Auto = "auto", "`plane` where the part has one section and is held and loaded in its plane on its whole height, else `solid`.";
        Plane = "plane", "plane stress in the part's section.";
        Solid = "solid", "the part in three dimensions.";
    }
    /// Elastic model of the stress analysis (`guide.elasticity`).
    enum Elasticity {
        Isotropic = "isotropic", "the modulus along the bead in all directions.";
        Orthotropic = "orthotropic", "the material's nine constants, beads along `guide.elasticity_deg`.";
    }
    /// Order of the components of an imported stress (`guide.import_order`).
    enum ComponentOrder {
        Vtk = "vtk", "xx, yy, zz, xy, yz, zx.";
        Abaqus = "abaqus", "xx, yy, zz, xy, xz, yz.";
        Voigt = "voigt", "xx, yy, zz, yz, xz, xy.";
    }
    /// Unit of an imported stress (`guide.import_stress_unit`).
    enum StressUnit {
        MPa = "MPa", "";
        Pa = "Pa", "";
        KPa = "kPa", "";
        GPa = "GPa", "";
        Psi = "psi", "";
        Ksi = "ksi", "";
    }
    /// Property of the grain that infill follows (`guide.mode`).
    enum GrainMode {
        Field = "field", "lines along the grain's directions.";
        Edges = "edges", "the edges found in the picture, and more lines between them.";
    }
    /// Method that joins edge points to curves (`guide.join`).
    enum CurveJoin {
        Trace = "trace", "each edge is traced from pixel to pixel.";
        Nearest = "nearest", "each point is joined to its nearest one, as published.";
    }
    /// Borders of the part that bend the grain (`guide.bend`).
    enum Bend {
        None = "none", "no border.";
        Outline = "outline", "the outer border.";
        Holes = "holes", "the borders of holes.";
        Both = "both", "all borders.";
    }
    /// Infill pattern (`fill.pattern`, `fibre.matrix_pattern`).
    enum Pattern {
        Rectilinear = "rectilinear", "parallel lines, turned from layer to layer by `angles_deg`.";
        Grid = "grid", "two crossing families of lines in each layer.";
        Triangles = "triangles", "three crossing families of lines in each layer.";
        Gyroid = "gyroid", "sections of the gyroid surface.";
        Concentric = "concentric", "loops parallel to the walls.";
        Honeycomb = "honeycomb", "hexagons.";
        Aligned = "aligned", "parallel lines, the same direction in all layers.";
        Stripes = "stripes", "dense beads along the guide's directions, at even spacing.";
        Streamlines = "streamlines", "evenly spaced streamlines of the guide's directions.";
        SeedLines = "seed-lines", "seed lines along the guide and their offsets, all of one width, as published.";
        Continuous = "continuous", "one unbroken path for each island and layer.";
    }
    /// What a graded density follows (`fill.density.by`).
    enum DensityBy {
        Stress = "stress", "in proportion to what the stress of the guide takes of the material's strengths.";
        File = "file", "the densities of a file.";
    }
    /// What happens to beads along a guide where they meet the border (`fill.ends`).
    enum BeadEnds {
        Auto = "auto", "`open` for dense beads with `widths = \"constant\"` that are no fibre, else `joined`.";
        Joined = "joined", "ends that lie close together are joined along the border: few paths, with turns that lie off the guide.";
        Open = "open", "every bead runs up to the border and ends there: all of it lies along the guide, in more paths.";
    }
    /// Ends of beads from layer to layer (`fill.layer_shift`).
    enum LayerShift {
        Auto = "auto", "`inner` for dense `stripes` and `continuous` of fibre, else `none`.";
        None = "none", "equal layers are laid alike, and their ends stand on each other.";
        Inner = "inner", "places inside the infill differ in each of three layers in turn: where beads end, where strips are joined and where closed paths begin.";
        All = "all", "places at the border differ too: in two of three layers, lines that meet the border end 1 or 2 mm before it, at beads along it.";
    }
    /// Widths of the beads of patterns that follow a guide (`fill.widths`).
    enum BeadWidths {
        Variable = "variable", "the width follows the distance to the neighbouring beads.";
        Constant = "constant", "one width: lines end where there is no room for another, and begin where there is. Single beads of other widths fill what they leave open in `stripes` and `streamlines`, except with fibre or a `process.min_bead_width_mm` of the full width.";
    }
    /// Rule by which the pattern `continuous` joins its cells into one path (`fill.tree`).
    enum CellTree {
        Directed = "directed", "joins cells where beads turn least away from the guide.";
        Undirected = "undirected", "joins cells without regard to the guide, for comparison.";
    }
    /// Kind of support (`support.style`).
    enum SupportStyle {
        None = "none", "no support.";
        Tree = "tree", "branching supports.";
        Columns = "columns", "straight walls below every overhang, for comparison.";
        Box = "box", "a box around all overhangs, for comparison.";
    }
    /// Method that makes one surface of the branches (`support.solid`).
    enum SupportSurface {
        Distance = "distance", "the zero level of a signed distance.";
        Poisson = "poisson", "Poisson reconstruction as published: slower, and it rounds tips off.";
    }
    /// Treatment of turns that are too sharp for the fibre (`fibre.turns`).
    enum FibreTurns {
        Round = "round", "turns are rounded where there is room; the others are reported.";
        Report = "report", "turns are reported only.";
        Cut = "cut", "turns are rounded where there is room; at the others the fibre is cut.";
        Wide = "wide", "as `cut`; lines then return several beads away, where turns of that radius fit.";
    }
    /// Place where a closed fibre path begins and ends (`fibre.start`).
    enum FibreStart {
        Nearest = "nearest", "nearest to the end of the path before.";
        Straight = "straight", "in the middle of the longest straight piece.";
        Calm = "calm", "where the stress is least; needs `guide.kind = \"stress\"`.";
        Rear = "rear", "at the largest y.";
    }
    /// Model of the strength test (`strength.fidelity`).
    enum Fidelity {
        Auto = "auto", "`plane` for parts of one section held and loaded in its plane on their whole height, else `voxels`.";
        Plane = "plane", "a plate; its layers are plies of a laminate.";
        Voxels = "voxels", "a solid of box-shaped cells, whose layers can separate.";
    }
}

impl Pattern {
    /// Whether the pattern needs directions from a guide. `continuous` also works without a guide.
    pub const fn follows_field(self) -> bool {
        // All patterns are listed, so that the compiler reports this place when a pattern is added.
        match self {
            Self::Stripes | Self::Streamlines | Self::SeedLines | Self::Continuous => true,
            Self::Rectilinear
            | Self::Grid
            | Self::Triangles
            | Self::Gyroid
            | Self::Concentric
            | Self::Honeycomb
            | Self::Aligned => false,
        }
    }

    /// Whether the ends of this pattern's beads can differ from layer to layer (`fill.layer_shift`).
    pub(crate) const fn takes_layer_shift(self) -> bool {
        match self {
            Self::Stripes | Self::Continuous => true,
            // `streamlines` and `seed-lines` place their lines one by one; the others follow no field.
            Self::Rectilinear
            | Self::Grid
            | Self::Triangles
            | Self::Gyroid
            | Self::Concentric
            | Self::Honeycomb
            | Self::Aligned
            | Self::Streamlines
            | Self::SeedLines => false,
        }
    }

    /// Whether a line of this pattern's sparse infill may be several beads wide (`fill.lines`).
    pub const fn takes_several_beads(self) -> bool {
        match self {
            // `seed-lines` stays as published; `continuous` is one path that fills its region.
            Self::SeedLines | Self::Continuous => false,
            Self::Rectilinear
            | Self::Grid
            | Self::Triangles
            | Self::Gyroid
            | Self::Concentric
            | Self::Honeycomb
            | Self::Aligned
            | Self::Stripes
            | Self::Streamlines => true,
        }
    }
}

impl Flip {
    /// Whether x, y and z are mirrored.
    pub const fn axes(self) -> [bool; 3] {
        match self {
            Self::None => [false, false, false],
            Self::X => [true, false, false],
            Self::Y => [false, true, false],
            Self::Z => [false, false, true],
            Self::Xy => [true, true, false],
            Self::Xz => [true, false, true],
            Self::Yz => [false, true, true],
            Self::Xyz => [true, true, true],
        }
    }
}

// Names of units need no explanation.
const fn plain_word(name: &'static str) -> Word {
    Word { name, help: "" }
}

impl Choice for LengthUnit {
    const ALL: &'static [Self] =
        &[Self::Millimetre, Self::Centimetre, Self::Metre, Self::Inch, Self::Micron, Self::Foot];
    const WORDS: &'static [Word] = &[
        plain_word("mm"),
        plain_word("cm"),
        plain_word("m"),
        plain_word("inch"),
        plain_word("micron"),
        plain_word("foot"),
    ];
}

/// Unit of a mesh or drawing (`shape.unit`): `auto`, or a unit that replaces the file's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileUnit(
    /// The unit; `None` for `auto`, the unit of the file or else one that fits the size.
    pub Option<LengthUnit>,
);

// Written by hand, because the macro makes enums and these values wrap a type of another crate.
impl Choice for FileUnit {
    const ALL: &'static [Self] = &[
        Self(None),
        Self(Some(LengthUnit::Millimetre)),
        Self(Some(LengthUnit::Centimetre)),
        Self(Some(LengthUnit::Metre)),
        Self(Some(LengthUnit::Inch)),
        Self(Some(LengthUnit::Micron)),
        Self(Some(LengthUnit::Foot)),
    ];
    const WORDS: &'static [Word] = &[
        Word {
            name: "auto",
            help: "the unit stated in the file; where it states none, m for a part less than 0.6 long and else mm, with a warning if the size leaves a doubt.",
        },
        plain_word("mm"),
        plain_word("cm"),
        plain_word("m"),
        plain_word("inch"),
        plain_word("micron"),
        plain_word("foot"),
    ];
}

// Names as in Rust and NumPy: kind of number and bits. A test compares them with the enum.
impl Choice for SampleType {
    const ALL: &'static [Self] =
        &[Self::U8, Self::I8, Self::U16, Self::I16, Self::U32, Self::I32, Self::F32, Self::F64];
    const WORDS: &'static [Word] = &[
        plain_word("u8"),
        plain_word("i8"),
        plain_word("u16"),
        plain_word("i16"),
        plain_word("u32"),
        plain_word("i32"),
        plain_word("f32"),
        plain_word("f64"),
    ];
}

/// Grey value at which the part begins in a scan (`shape.ct.threshold`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// The threshold is found from the histogram by Otsu's method (1979).
    Otsu,
    /// Halfway between the grey values of two materials; for `None` they are the two most frequent grey values.
    Iso50(Option<[f64; 2]>),
    /// The part is this grey value and everything brighter.
    Value(f64),
    /// The part is everything between these grey values.
    Range(f64, f64),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every_value_has_its_word<T: Choice + std::fmt::Debug>() {
        assert_eq!(T::ALL.len(), T::WORDS.len());
        for value in T::ALL {
            assert_eq!(T::from_word(value.name()), Some(*value));
        }
    }

    #[test]
    fn types_of_other_crates_have_a_word_for_each_value() {
        every_value_has_its_word::<LengthUnit>();
        every_value_has_its_word::<FileUnit>();
        every_value_has_its_word::<SampleType>();
        for unit in LengthUnit::ALL {
            assert_eq!(Choice::name(*unit), LengthUnit::name(*unit));
        }
        for sample in SampleType::ALL {
            assert_eq!(SampleType::from_name(Choice::name(*sample)), Some(*sample));
        }
        assert_eq!(SampleType::ALL.len(), SampleType::NAMES.len());
    }
}
