//! Readers and writers of meshes, outlines, images, CT volumes, directions and finite-element results.
//!
//! All functions work on bytes; none opens a file. Whatever the bytes, a reader returns a value with warnings or an error
//! that names the place. The size of the input bounds its time and memory.

pub mod directions;
pub mod fe;
pub mod image;
mod layer_files;
mod mesh;
mod mesh_formats;
mod outline;
mod position;
mod text;
mod threemf;
pub mod volume;
mod xml;

pub use image::{Image, ImageError, ImageFormat, Samples};
pub use layer_files::{write_cli, write_svg_layers};
pub use mesh::model::{
    MeshBody, MeshError, MeshFile, MeshFormat, MeshProblem, ModifierVolume, PaintedSupports,
};
pub use mesh::stl::write_stl;
pub use mesh_formats::{parse_mesh, read_binary_stl, sniff_exact_surfaces, sniff_mesh};
pub use outline::{Outline, OutlineError, OutlineOptions, OutlineProblem, parse_outline, sniff_outline};
pub use position::BadCoordinate;
pub use text::TextError;
pub use threemf::write_3mf;

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
