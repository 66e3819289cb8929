//! The vocabulary of grainpath: what passes between its rooms, and the geometry they share.
//!
//! Nothing here opens a file, knows a printer or a material, or starts a solver. Lengths are in mm, angles in
//! radians (`_rad`) except where a name says `_deg`, stresses in MPa. Right-handed axes, Z up, the plate at Z = 0.

pub mod buckets;
pub mod bvh;
pub mod conjugate_gradients;
pub mod dense;
pub mod density;
pub mod diagnostics;
pub mod disjoint_sets;
pub mod failure_svg;
pub mod field;
pub mod field_mesh;
pub mod hash;
pub mod layer;
pub mod line_points;
pub mod mask;
pub mod math;
pub mod medial;
pub mod mesh;
pub mod poly;
pub mod polyline;
pub mod segment;
pub mod selection;
pub mod slices;
pub mod spelling;
pub mod streamlines;
pub mod tensor;
pub mod toolpath;
pub mod triangulation;
pub mod units;
pub mod warning;

pub use bvh::Bvh;
pub use density::Density;
pub use diagnostics::Diagnostics;
pub use disjoint_sets::DisjointSets;
pub use field::{DirectionField, DirectionSample, UniformField};
pub use glam::{DMat3, DVec2, DVec3, IVec3};
pub use layer::{Layer, LayerStack};
pub use mesh::TriMesh;
pub use poly::{Bounds2, Contour, Polygon, Region};
pub use slices::{SliceError, SliceSource, VolumeInfo};
pub use toolpath::{BeadWidth, LayerPlan, Plan, PlannedPath, Role, SpeedClass, Toolpath, Travel};
pub use warning::{Place, Warning, WarningId};
