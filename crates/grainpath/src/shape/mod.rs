//! Shapes: from meshes, drawings and photographs to the [`LayerStack`] on which every later step
//! works. The steps are `mend` (repair), `place` (unit, rotation, plate) and `slice` (sections).
//! Lengths are in mm, z = 0 is the plate.

mod heights;
mod mend;
mod outline;
mod photo;
mod place;
mod section;
#[cfg(test)]
mod shell_tests;

use std::ops::Range;

use grainpath_core::diagnostics::{Interrupted, Stage};
use grainpath_core::triangulation::TriangulationError;
use grainpath_core::{Diagnostics, Layer, LayerStack, Region, TriMesh};
use grainpath_imaging::loft::LoftError;
pub use grainpath_imaging::loft::loft;
use rayon::prelude::*;

pub use heights::{Adaptive, layer_heights};
pub use mend::{Mended, Repair, mend, mend_counting};
pub use outline::extruded;
pub use outline::prism;
pub use photo::{Hole, PhotoBoard};
pub use place::{Placement, Standing, assumed_unit, likely_unit, place};

/// Settings for cutting a mesh into layers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliceSettings {
    /// Thickness of every layer but the first, mm.
    pub layer_height_mm: f64,
    /// Thickness of the first layer, mm.
    pub first_layer_height_mm: f64,
    /// Layer heights that follow the slopes; `None` for uniform layers.
    pub adaptive: Option<Adaptive>,
    /// In badly damaged sections, open chains whose ends are no farther apart than this are closed on themselves, mm.
    pub gap_closing_mm: f64,
    /// Largest deviation of a simplified contour from the original, mm.
    pub simplify_mm: f64,
}

/// Why a shape cannot be made into layers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum ShapeError {
    #[error("the mesh has no triangles")]
    Empty,
    #[error(
        "the part is {height_mm:.3} mm high, less than half the first layer ({first_layer_mm} mm); check its unit"
    )]
    TooFlat { height_mm: f64, first_layer_mm: f64 },
    #[error(
        "the part measures {size_mm:.0} mm; more than {limit_mm:.0} mm is taken for damage or a wrong unit"
    )]
    TooLarge { size_mm: f64, limit_mm: f64 },
    #[error("no closed volume: {open_edges} of {n_edges} edges are open")]
    NoVolume { open_edges: usize, n_edges: usize },
    #[error("the mesh has {defects}; repair = \"strict\" refuses it, repair = \"auto\" mends it")]
    Defects { defects: String },
    #[error("{n} layers of {height_mm} mm; at most {limit} are possible")]
    TooManyLayers { n: usize, height_mm: f64, limit: usize },
    #[error("the surface has more than {limit} triangles; a larger output.surface_cell_mm makes fewer")]
    SurfaceTooLarge { limit: usize },
    #[error("the outline cannot be made a body: {0}")]
    Outline(#[from] TriangulationError),
    #[error("no layer of the part has any area")]
    NothingLeft,
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<LoftError> for ShapeError {
    fn from(error: LoftError) -> Self {
        match error {
            LoftError::NoArea => Self::NothingLeft,
            LoftError::TooLarge { limit } => Self::SurfaceTooLarge { limit },
            LoftError::Interrupted(interrupted) => Self::Interrupted(interrupted),
        }
    }
}

/// Cuts placed and mended meshes into layers. The section of a layer is taken at the middle of its
/// height. A vertex on the plane counts as above it, so every crossed edge gives exactly one point,
/// the same for both its triangles.
///
/// Contours of all meshes are united by winding number: bodies that overlap or touch do not cancel,
/// and cavities stay.
///
/// # Errors
/// [`ShapeError`]: too flat, too many layers, no layer with an area, interrupted.
pub fn slice(
    mesh: &TriMesh,
    settings: &SliceSettings,
    diagnostics: &Diagnostics,
) -> Result<LayerStack, ShapeError> {
    let slicer = Slicer::new(mesh, settings)?;
    diagnostics.begin(Stage::Slice, slicer.n_layers());
    let mut layers = slicer.sections(0..slicer.n_layers(), diagnostics)?;
    // Sections at the top may be empty, for instance where only specks were left. Empty layers
    // inside the part stay.
    while layers.last().is_some_and(|l| l.region().is_empty()) {
        layers.pop();
    }
    if layers.is_empty() {
        return Err(ShapeError::NothingLeft);
    }
    Ok(LayerStack::new(layers).expect("layer heights rise"))
}

/// The layer heights of a mesh, and its sections on request.
///
/// A section depends on the mesh alone, so any window of layers gives the layers that [`slice()`] gives.
///
/// ```
/// use grainpath::shape::{SliceSettings, Slicer};
/// use grainpath_core::{DVec3, Diagnostics, TriMesh};
///
/// let corner = |x, y, z| DVec3::new(x, y, z);
/// let mesh = TriMesh {
///     vertices: vec![corner(0.0, 0.0, 0.0), corner(9.0, 0.0, 0.0), corner(0.0, 9.0, 0.0), corner(0.0, 0.0, 9.0)],
///     triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
/// };
/// let settings = SliceSettings {
///     layer_height_mm: 0.3,
///     first_layer_height_mm: 0.3,
///     adaptive: None,
///     gap_closing_mm: 0.05,
///     simplify_mm: 0.01,
/// };
/// let slicer = Slicer::new(&mesh, &settings).unwrap();
/// assert_eq!(slicer.n_layers(), 30);
/// let window = slicer.sections(10..13, &Diagnostics::default()).unwrap();
/// assert_eq!(window.len(), 3);
/// assert!(window[0].region().area_mm2() > window[2].region().area_mm2());
/// ```
pub struct Slicer<'a> {
    mesh: &'a TriMesh,
    settings: SliceSettings,
    /// Top of each layer, mm.
    tops: Vec<f64>,
    /// Height of each section: the middle of its layer, mm.
    planes: Vec<f64>,
    buckets: section::TrianglesByPlane,
}

/// Sections of a closed mesh at given heights, with all its bodies united.
pub(crate) fn sections_at(mesh: &TriMesh, planes_mm: &[f64], settings: &SliceSettings) -> Vec<Region> {
    let triangles = section::TrianglesByPlane::new(mesh, planes_mm);
    let cut = |(i, z): (usize, &f64)| section::section(mesh, triangles.triangles(i), *z, settings).0;
    planes_mm.par_iter().enumerate().map(cut).collect()
}

/// Volume of the union of all bodies of a closed, mended mesh, in the cube of the vertices' unit; places that
/// two bodies fill count once. It is the sum of sections, and exact to 0.5 % where the part's faces
/// are level, better elsewhere.
///
/// ```
/// # let mut mesh = grainpath_parts::file_of_a_box().bodies.remove(0).mesh;
/// // The same box twice is the box.
/// let box_mm3 = mesh.signed_volume();
/// mesh.triangles.extend(mesh.triangles.clone());
/// let united_mm3 = grainpath::shape::united_volume(&mesh);
/// assert!((mesh.signed_volume() / box_mm3 - 2.0).abs() < 1e-9);
/// assert!((united_mm3 / box_mm3 - 1.0).abs() < 0.005);
/// ```
pub fn united_volume(mesh: &TriMesh) -> f64 {
    /// Number of sections. Source: derived; a level face lies at most half a section off the border between
    /// two, so that its area counts for at most 1/800 of the height too much or too little.
    const N_SECTIONS: u32 = 400;
    /// Height that the mesh is scaled to, mm. Source: chosen; sections are rounded to a grid made for parts
    /// of this size.
    const HEIGHT_MM: f64 = 100.0;
    let Some((low, high)) = mesh.bounds() else { return 0.0 };
    let extent = (high - low).max_element();
    if extent <= 0.0 || high.z <= low.z {
        return 0.0;
    }
    let factor = HEIGHT_MM / extent;
    let vertices = mesh.vertices.iter().map(|p| (*p - low) * factor).collect();
    let scaled = TriMesh { vertices, triangles: mesh.triangles.clone() };
    let step_mm = (high.z - low.z) * factor / f64::from(N_SECTIONS);
    let planes_mm: Vec<f64> = (0..N_SECTIONS).map(|i| (f64::from(i) + 0.5) * step_mm).collect();
    let settings = SliceSettings {
        layer_height_mm: step_mm,
        first_layer_height_mm: step_mm,
        adaptive: None,
        gap_closing_mm: 0.0,
        simplify_mm: 0.0,
    };
    let area_mm2: f64 = sections_at(&scaled, &planes_mm, &settings).iter().map(Region::area_mm2).sum();
    area_mm2 * step_mm / factor.powi(3)
}

impl<'a> Slicer<'a> {
    /// Chooses the layer heights of a placed and mended mesh.
    ///
    /// # Errors
    /// [`ShapeError`]: empty, too flat, too many layers.
    pub fn new(mesh: &'a TriMesh, settings: &SliceSettings) -> Result<Self, ShapeError> {
        let (_, high) = mesh.bounds().ok_or(ShapeError::Empty)?;
        let tops = layer_heights(mesh, high.z, settings)?;
        let bottoms = std::iter::once(0.0).chain(tops.iter().copied());
        let planes: Vec<f64> = tops.iter().zip(bottoms).map(|(top, bottom)| 0.5 * (top + bottom)).collect();
        let buckets = section::TrianglesByPlane::new(mesh, &planes);
        Ok(Self { mesh, settings: *settings, tops, planes, buckets })
    }

    /// The number of layers; the topmost ones may turn out to be empty.
    pub fn n_layers(&self) -> usize {
        self.tops.len()
    }

    /// The layers of a window, lowest first. One warning states the gaps that were closed in them.
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub fn sections(
        &self,
        window: Range<usize>,
        diagnostics: &Diagnostics,
    ) -> Result<Vec<Layer>, Interrupted> {
        let cut = |i: usize| -> Result<(Layer, section::Mended), Interrupted> {
            diagnostics.check()?;
            let triangles = self.buckets.triangles(i);
            let (region, mended) = section::section(self.mesh, triangles, self.planes[i], &self.settings);
            diagnostics.advance(1);
            let height = self.tops[i] - if i > 0 { self.tops[i - 1] } else { 0.0 };
            let layer = Layer::new(self.tops[i], height, region);
            Ok((layer.expect("layer heights are positive and start at the plate"), mended))
        };
        let cuts: Vec<Result<_, Interrupted>> = window.into_par_iter().with_min_len(4).map(cut).collect();
        let mut layers = Vec::with_capacity(cuts.len());
        let mut mended = section::Mended::default();
        for result in cuts {
            let (layer, m) = result?;
            mended.add(&m);
            layers.push(layer);
        }
        mended.warn(diagnostics);
        Ok(layers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::DVec3;

    /// A box with its lowest corner at a place.
    pub(super) fn box_at(low: [f64; 3], size: [f64; 3]) -> TriMesh {
        let (low, size) = (DVec3::from_array(low), DVec3::from_array(size));
        TriMesh::cuboid(low, low + size)
    }

    /// A triangle, slanted in both directions.
    pub(super) fn facet(at: [f64; 3], size: f64) -> TriMesh {
        let at = DVec3::from_array(at);
        let corners = [DVec3::ZERO, DVec3::new(1.0, 0.2, 0.1), DVec3::new(0.1, 0.9, 0.4)];
        TriMesh { vertices: corners.map(|c| at + size * c).to_vec(), triangles: vec![[0, 1, 2]] }
    }

    /// A mesh with all facets turned.
    pub(super) fn turned(mesh: &TriMesh) -> TriMesh {
        let mut mesh = mesh.clone();
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        mesh
    }

    #[test]
    fn the_volume_of_a_union_counts_overlaps_once_in_any_unit() {
        for unit in [1e-3, 1.0, 25.4] {
            let side = |mm: f64| [mm * unit; 3];
            let mut mesh = box_at(side(0.0), side(10.0));
            let other = box_at(side(5.0), side(10.0));
            mesh.vertices.extend(other.vertices);
            mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + 8)));
            let ratio = united_volume(&mesh) / (unit.powi(3) * (2000.0 - 125.0));
            assert!((ratio - 1.0).abs() < 5e-3, "{ratio}");
        }
        assert_eq!(united_volume(&TriMesh::default()), 0.0);
        assert_eq!(united_volume(&facet([0.0; 3], 0.0)), 0.0);
    }
}
