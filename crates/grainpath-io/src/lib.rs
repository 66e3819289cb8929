//! Bytes to meshes, images, CT volumes and finite-element results, and back. Nothing here opens a file; every reader
//! survives any bytes.

pub mod fe;
pub mod image;
mod layers;
mod mesh;
mod obj;
mod off;
mod ply;
mod stl;
mod text;
mod threemf;
pub mod volume;

pub use image::{Image, ImageError, ImageFormat, Samples};
pub use layers::{write_cli, write_svg_layers};
pub use mesh::{Body, Marks, MeshError, MeshFile, MeshFormat, parse_mesh, sniff_mesh};
pub use stl::write_stl;
pub use threemf::write_3mf;
