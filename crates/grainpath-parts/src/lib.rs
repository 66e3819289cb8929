//! Parts that our own code makes: presets with their jobs, specimens, test pieces of standards, and
//! synthetic boards.

pub mod board;
pub mod presets;
mod shapes;
pub mod specimen;
pub mod test_pieces;

use grainpath_core::{DVec2, Layer, LayerStack, Region};

/// A box of 20 x 10 mm in layers of 0.2 mm, for examples in documentation.
pub fn layers_of_a_box(n_layers: usize) -> LayerStack {
    let section = || Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 10.0));
    // The sum of many heights of 0.2 would carry their rounding along, so each top is a product.
    let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section()).expect("a sound layer");
    LayerStack::new((0..n_layers).map(layer).collect()).expect("heights rise")
}

/// A mesh file with a box of 20 x 10 x 2 mm, for examples in documentation.
pub fn file_of_a_box() -> grainpath_io::MeshFile {
    let region = Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 10.0));
    // An extruded drawing is a closed mesh with outward normals, as files of CAD programs have it.
    let outline = grainpath_io::Outline { region, warnings: Vec::new() };
    grainpath::shape::extruded(outline, 2.0).expect("a plain rectangle")
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
