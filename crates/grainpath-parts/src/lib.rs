//! Parts that our own code makes: presets with their jobs, specimens, test pieces of standards, and
//! synthetic boards.

pub mod board;
pub mod presets;
mod shapes;
pub mod specimen;
pub mod test_pieces;
