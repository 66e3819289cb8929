//! Parts made by our own code: presets with their jobs, specimens, test pieces of standards, synthetic boards.

pub mod board;
pub mod presets;
mod shapes;
pub mod specimen;
pub mod test_pieces;
