//! Bytes to meshes, images and finite-element results, and back. Nothing here opens a file; every reader takes what is
//! in memory and survives any bytes.

pub mod fe;
pub mod image;
mod mesh;
mod obj;
mod off;
mod ply;
mod stl;
mod text;
mod threemf;

pub use image::{Image, ImageError, ImageFormat, Samples};
pub use mesh::{Body, MeshError, MeshFile, MeshFormat, parse_mesh, sniff_mesh};
pub use stl::write_stl;
