//! A user's own directions: tables, arrays, matrices, pictures and meshes to one interpolated
//! field; and densities in the same files ([`parse_densities`]).
//!
//! [`parse_directions`] reads any of these into [`DirectionSamples`], which answers at every point:
//!
//! | file | directions are |
//! |---|---|
//! | CSV with a header | an angle or a vector at each point x, y and perhaps z; the header names the columns |
//! | CSV of numbers alone | a matrix of angles, as `vector_slicer` writes `thetaField.csv`; or its folder |
//! | `.npy`, `.npz` | columns as in a CSV (structured or named arrays), or a grid of angles or vectors |
//! | PNG, TIFF, BMP, JPEG | grey 0 to maximum is 0 to 180 degrees counter-clockwise from x; alpha is the strength |
//! | VTU, VTK, MSH, FRD | the vectors of a node or element array |
//!
//! Method: a direction has no sign, so that neither angles nor vectors can be averaged. What is
//! interpolated is the tensor `strength * d d^T`, whose in-plane part is the vector of the doubled
//! angle. Grids are interpolated bilinearly between the centres of their cells; points of a plane
//! linearly in their Delaunay triangles; several planes of points linearly between two planes;
//! meshes by the shape functions of their elements; other points in space by the inverse square of
//! the distance to the nearest eight. Cells of a grid without a direction are filled from the cells
//! around by a pyramid of averages (`Gortler1996`, push-pull) and keep the strength 0. Outside, the
//! direction is that of the nearest place.
//!
//! Units: positions in mm after conversion, angles in radians, strength from 0 to 1. Cost: O(n log
//! n) for points, O(n) for grids; a sample costs O(1) on average. Degenerate cases: one sample
//! gives one direction everywhere, with a warning; samples without a direction (NaN, a vector of
//! length 0, strength 0, alpha 0) are counted and left out. Limits: [`MAX_CELLS`] cells of a grid
//! and [`MAX_POINTS`] points; archives are never inflated beyond the size that the header of an
//! array states.

mod cloud;
mod grid;
mod model;
mod npy;
mod read;
mod samples;
mod scalar;
mod table;

pub use model::{
    AngleUnit, BlendedDirection, DirectionError, DirectionOptions, DirectionProblem, DirectionSummary,
    GridAxes, MAX_CELLS, MAX_POINTS, MissingDirections,
};
pub use read::{parse_directions, sniff_directions};
pub use samples::DirectionSamples;
pub use scalar::{DensitySamples, parse_densities};
