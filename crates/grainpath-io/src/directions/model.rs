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
    #[error("{place}: {problem}")]
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
    #[error("{found} columns where the header has {wanted}")]
    Columns { found: usize, wanted: usize },
    #[error("{first} has {rows} rows and {name} has {found}")]
    Rows { first: String, rows: usize, name: String, found: usize },
    #[error("no rows")]
    NoRows,
    #[error("no columns x and y among {}", .0.join(", "))]
    NoPosition(Vec<String>),
    #[error("several directions ({}); name one with guide.field.array", .0.join("; "))]
    Several(Vec<String>),
    #[error("found {0:?} where a number of the matrix should be")]
    NotANumber(String),
    #[error("{found} numbers where the first line has {wanted}")]
    Numbers { found: usize, wanted: usize },
    #[error(
        "{rows} lines of {columns} numbers without a header; name the columns, as in x_mm,y_mm,angle_deg"
    )]
    NoHeader { rows: usize, columns: usize },
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
    #[error("the density should be from 0 to 1, is {0}")]
    Density(f64),
    // Arrays and pictures.
    #[error(
        "{name} has the shape {}; a grid of angles has two indices, one of vectors three with 2 or 3 components last, and a \
         table has named columns",
        joined(shape, " x ")
    )]
    Shape { name: String, shape: Vec<usize> },
    #[error("the arrays of a grid differ in shape from {}", joined(.0, " x "))]
    ShapesDiffer(Vec<usize>),
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
    #[error("no array {name:?} of 2 or 3 components; there are: {}", .names.join(", "))]
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
    shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(between)
}

pub(super) fn invalid(place: impl Into<String>, problem: DirectionProblem) -> DirectionError {
    DirectionError::Invalid { place: place.into(), problem: Box::new(problem) }
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

impl BlendedDirection {
    /// The direction, rotated by `turn` and projected onto the plane z = 0: the axis in `[0, pi)` and its strength, 0 to
    /// 1.
    ///
    /// Directions that disagree cancel, so the strength falls to 0 at a point around which the directions turn by a half or
    /// full turn.
    pub fn in_plane(&self, turn: &DMat3) -> (f64, f64) {
        let [xx, yy, zz, xy, yz, zx] = self.tensor;
        let tensor = DMat3::from_cols(DVec3::new(xx, xy, zx), DVec3::new(xy, yy, yz), DVec3::new(zx, yz, zz));
        let turned = *turn * tensor * turn.transpose();
        let double = DVec2::new(turned.x_axis.x - turned.y_axis.y, 2.0 * turned.x_axis.y);
        let axis_rad = 0.5 * grainpath_core::math::atan2(double.y, double.x);
        (axis_rad.rem_euclid(std::f64::consts::PI), double.length().min(1.0))
    }
}
