//! Types that all readers of directions share: limits, options, errors, and the direction at a point.

use grainpath_core::units::LengthUnit;
use grainpath_core::{DMat3, DVec2, DVec3};

use crate::fe::FeError;
use crate::image::ImageError;
use crate::position::BadCoordinate;

/// Grids have at most this many cells. Source: derived: 4096 x 4096 cells of 12 bytes are 200 MB.
pub const MAX_CELLS: usize = 1 << 24;
/// Tables have at most this many points. Source: derived: a point with its triangles takes about
/// 400 bytes, so that this many take 1.6 GB.
pub const MAX_POINTS: usize = 4_000_000;

/// Unit of angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum AngleUnit {
    Degree,
    Radian,
    Milliradian,
    Turn,
}

impl AngleUnit {
    /// This unit in radians.
    pub const fn rad(self) -> f64 {
        match self {
            Self::Degree => std::f64::consts::PI / 180.0,
            Self::Radian => 1.0,
            Self::Milliradian => 1e-3,
            Self::Turn => std::f64::consts::TAU,
        }
    }

    /// The name of several of them, for reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Degree => "degrees",
            Self::Radian => "radians",
            Self::Milliradian => "milliradians",
            Self::Turn => "turns",
        }
    }
}

/// What the two indices of a grid's array mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GridAxes {
    /// `a[y][x]`, both rising: numpy's `meshgrid` as it is.
    Yx,
    /// `a[x][y]`, both rising: `meshgrid` with `indexing="ij"`, and `vector_slicer`.
    Xy,
    /// `a[row][column]` with the first row at the top, as in a picture.
    Image,
}

impl GridAxes {
    /// The order of the indices in words, for reports.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Yx => "a[y][x]: rows rise with y, columns with x",
            Self::Xy => "a[x][y]: rows rise with x, columns with y",
            Self::Image => "rows from the top downwards, columns rise with x",
        }
    }
}

/// What the job states about a file of directions. `None` takes the statement of the file, or else the default given here.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DirectionOptions {
    /// Unit of positions; mm.
    pub length_unit: Option<LengthUnit>,
    /// Unit of angles; degrees where an angle exceeds one turn in radians, else radians.
    pub angle_unit: Option<AngleUnit>,
    /// Order of the indices of an array; [`GridAxes::Yx`], and [`GridAxes::Xy`] for a CSV matrix.
    pub axes: Option<GridAxes>,
    /// Name of the array or of the vector; the only one, or the one with a usual name.
    pub array: Option<String>,
    /// Size of a cell of a grid, mm. As `axes` does, it says that numbers without names are a grid, whatever their shape.
    pub cell_mm: Option<f64>,
}

/// Why directions cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum DirectionError {
    #[error("the file is empty")]
    Empty,
    #[error("no file of directions: neither CSV, .npy, .npz, a picture nor a finite-element file")]
    Unknown,
    #[error("{0}")]
    Mesh(#[from] FeError),
    #[error("{0}")]
    Picture(#[from] ImageError),
    /// `place` lies within the file; it is empty where the problem is that of the whole file.
    #[error("{}{problem}", if place.is_empty() { String::new() } else { format!("{place}: ") })]
    Invalid { place: String, problem: Box<DirectionProblem> },
    #[error("no directions: {0}")]
    Missing(Box<MissingDirections>),
    #[error("all {0} samples are without a direction (NaN, zero vectors or strength 0)")]
    NoDirection(usize),
    #[error("{found} {what}; grainpath reads at most {limit}")]
    TooMany { what: &'static str, found: u64, limit: usize },
}

/// What is wrong at the place that [`DirectionError::Invalid`] names, in a file of directions or densities.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum DirectionProblem {
    // Tables and matrices.
    #[error("{found} columns where the header has {wanted}{}", if found > wanted {
        "; numbers with decimal commas need semicolons between the columns"
    } else {
        ""
    })]
    Columns { found: usize, wanted: usize },
    #[error("no rows")]
    NoRows,
    #[error("no columns x and y among {}", .0.join(", "))]
    NoPosition(Vec<String>),
    #[error("several directions ({}); name one with guide.field.array", .0.join("; "))]
    Several(Vec<String>),
    #[error("found {0:?} where a number should be")]
    NotANumber(String),
    #[error("the columns {} both hold {coordinate} and differ; rename the one that is not meant", .names.join(" and "))]
    Coordinates { coordinate: &'static str, names: [String; 2] },
    #[error("{found} numbers where the first line has {wanted}")]
    Numbers { found: usize, wanted: usize },
    #[error(
        "{rows} lines of {columns} numbers without a header; name the columns, as in x_mm,y_mm,angle_deg"
    )]
    NoHeader { rows: usize, columns: usize },
    #[error(
        "{} numbers without a header or names are more likely a table than a grid; name the columns, as in x_mm,y_mm,angle_deg, or set \
         guide.field.axes where it is a grid",
        joined(shape, " x ")
    )]
    Nameless { shape: Vec<usize> },
    #[error("the unit {unit:?} of {name} is not known; {known} are")]
    Unit { name: String, unit: String, known: &'static str },
    #[error("{first} and {other} differ in unit; state one unit for all positions")]
    UnitsDiffer { first: String, other: String },
    // Values. Samples and cells are counted from 1.
    #[error("{0}")]
    Coordinate(BadCoordinate),
    #[error("the position is no number")]
    Position,
    #[error("the strength of sample {0} is negative")]
    NegativeStrength(usize),
    #[error("the spacing of sample {0} is not above 0")]
    SampleSpacing(usize),
    #[error("the spacing of cell {0} is not above 0")]
    CellSpacing(usize),
    #[error("the density should be from 0 to 1, is {0:?}")]
    Density(f64),
    // Arrays and pictures.
    #[error(
        "{name} has the shape {}; a grid of angles has two indices, one of vectors three with 2 or 3 components last, and a \
         table has named columns",
        joined(shape, " x ")
    )]
    Shape { name: String, shape: Vec<usize> },
    #[error("arrays differ in shape: {name} has {}, not {}", joined(found, " x "), joined(wanted, " x "))]
    ShapesDiffer { name: String, found: Vec<usize>, wanted: Vec<usize> },
    #[error(
        "x has {} and y has {} places, which are not the two indices of {name} ({}){}", places[0], places[1],
        joined(shape, " x "), if *stated { " in the order of guide.field.axes" } else { "" }
    )]
    Axes { name: String, shape: Vec<usize>, places: [usize; 2], stated: bool },
    #[error("{name} is on {on} and the directions are on {wanted}; give both on the same")]
    OtherPlace { name: String, on: &'static str, wanted: &'static str },
    #[error(
        "the grey {grey:?} in row {row}, column {column}; a picture of numbers beyond 16 bits holds shares from 0 to 1: angles in \
         degrees divided by 180, those in radians by pi"
    )]
    Grey { grey: f32, row: usize, column: usize },
    #[error("a grid of densities has two indices, a[y][x]")]
    NotTwoIndices,
    #[error("there are: {}; name one with fill.density.array", .0.join(", "))]
    NoDensity(Vec<String>),
    #[error("neither CSV, .npy, a picture nor a finite-element file")]
    NoDensityFile,
    /// A picture with colours, and the meaning of a grey one.
    #[error("the picture has colours; {0}")]
    Colours(&'static str),
    // Files of numpy.
    #[error("no numpy array (.npy)")]
    NotNumpy,
    #[error("the array ends within its header")]
    HeaderEnds,
    #[error("a header of {found} bytes; at most {limit} are read")]
    Header { found: usize, limit: usize },
    #[error("the numpy header does not state {0}")]
    NotStated(&'static str),
    #[error("the type {0:?} is not read; save booleans, integers or floats of 4 or 8 bytes")]
    Type(String),
    #[error("the field {0:?} is an array itself, which is not read")]
    FieldOfArrays(String),
    #[error("the shape ({}) needs {wanted} bytes; there are {found}", joined(shape, ", "))]
    Bytes { shape: Vec<usize>, wanted: usize, found: usize },
    /// In the words of the library `zip`, which unpacks the file.
    #[error("{0}")]
    Archive(String),
}

/// The directions that a file lacks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum MissingDirections {
    #[error("the archive holds no array (.npy)")]
    Array,
    #[error("none of the arrays {} is known; name one with guide.field.array", .0.join(", "))]
    KnownArray(Vec<String>),
    #[error("there is no {name:?} among {}", .names.join(", "))]
    NamedArray { name: String, names: Vec<String> },
    #[error("the file has no array of 2 or 3 components")]
    Vector,
    #[error("several vectors ({}); name one with guide.field.array", .0.join(", "))]
    OneVector(Vec<String>),
    #[error("{name} has the shape {}", joined(shape, " x "))]
    Cells { name: String, shape: Vec<usize> },
    #[error("a folder of vector_slicer has thetaField.csv, or xField.csv and yField.csv")]
    Matrices,
    #[error("no columns x and y among {}", .0.join(", "))]
    Position(Vec<String>),
    #[error("neither an angle (angle_deg, theta_rad) nor a vector (vx, vy) among {}", .0.join(", "))]
    Direction(Vec<String>),
    #[error("the table has no rows")]
    Rows,
}

/// The numbers of a shape.
fn joined(shape: &[usize], between: &str) -> String {
    if shape.is_empty() {
        return "no index".to_owned();
    }
    shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(between)
}

pub(super) fn invalid(place: impl Into<String>, problem: DirectionProblem) -> DirectionError {
    DirectionError::Invalid { place: place.into(), problem: Box::new(problem) }
}

/// A place within one of several files, or within the only one, whose name is empty.
pub(super) fn within(file: &str, place: String) -> String {
    if file.is_empty() { place } else { format!("{file}, {place}") }
}

pub(super) fn missing(what: MissingDirections) -> DirectionError {
    DirectionError::Missing(Box::new(what))
}

/// How directions were read, for `inspect` and the report.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct DirectionSummary {
    /// The format of the file.
    pub format: &'static str,
    /// How the samples lie: a grid, points in the plane, a mesh.
    pub layout: String,
    /// Samples with a direction.
    pub samples: usize,
    /// Samples without one, which were left out.
    pub without_direction: usize,
    /// The column, array or picture that gave the directions, and their unit.
    pub directions: String,
    /// Unit of positions and who states it; empty for grids without positions.
    pub length_unit: String,
    /// Order of the indices of a grid; empty for the others.
    pub axis_order: String,
    /// Whether samples have strengths of their own.
    pub has_strength: bool,
    /// Whether samples have spacings of their own.
    pub has_spacing: bool,
}

/// The direction at a point, interpolated between the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlendedDirection {
    /// `strength * d d^T` of the unit vector d, components xx, yy, zz, xy, yz, zx.
    pub tensor: [f64; 6],
    /// Distance of beads, mm, where the samples state one.
    pub spacing_mm: Option<f64>,
}

/// Where the part in the plane is below this share of the whole strength, there is no direction: what is left is rounding.
/// Source: derived. It is the square of the sine of 0.57 degrees, by which a direction leans from upright; grids of single
/// precision are rounded by 1e-7 and unit vectors of three decimals by 1e-6.
pub(super) const MIN_IN_PLANE: f64 = 1e-4;

impl BlendedDirection {
    /// The direction, rotated by `turn` and projected onto the plane z = 0: the axis in `[0, pi)` and its strength, 0 to
    /// 1.
    ///
    /// Directions that disagree cancel, so the strength falls to 0 at a point around which the directions turn by a half or
    /// full turn. Where they cancel or stand upright there is no direction: the strength is 0, and the axis that of x.
    pub fn in_plane(&self, turn: &DMat3) -> (f64, f64) {
        let [xx, yy, zz, xy, yz, zx] = self.tensor;
        let tensor = DMat3::from_cols(DVec3::new(xx, xy, zx), DVec3::new(xy, yy, yz), DVec3::new(zx, yz, zz));
        let turned = *turn * tensor * turn.transpose();
        let double = DVec2::new(turned.x_axis.x - turned.y_axis.y, 2.0 * turned.x_axis.y);
        let trace = xx + yy + zz;
        if double.length() <= MIN_IN_PLANE * trace {
            return (0.0, 0.0);
        }
        let axis_rad = 0.5 * grainpath_core::math::atan2(double.y, double.x);
        (axis_rad.rem_euclid(std::f64::consts::PI), double.length().min(1.0))
    }
}
