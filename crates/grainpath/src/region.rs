//! Computes the area of each region of a job in each layer.
//!
//! The mid-height of a layer decides whether the layer belongs to a box or a range of layers. A mesh is placed like the
//! part and cut at the mid-height of each layer. A face and a depth give a closed body: one side is the face, moved
//! slightly outwards; the other is the face, moved inwards by the depth along normals that are averaged at each vertex.
//! This body is cut like a mesh. Where regions overlap, the later one counts, and the run gives a warning.
//!
//! Units: mm, part coordinates with the plate at z = 0. Cost: slicing the meshes, and a few booleans for each layer and
//! pair of regions. Limits: on a boss, a depth of more than its radius turns the body inside out, and the region is wrong
//! beyond the axis of the boss.

use std::collections::BTreeMap;

use grainpath_core::faces::FaceError;
use grainpath_core::units::LengthUnit;
use grainpath_core::{
    Bounds2, DVec2, DVec3, Diagnostics, Layer, LayerStack, Region, TriMesh, Warning, WarningId,
};
use grainpath_io::{MeshBody, MeshFile};
use grainpath_job::modifiers::region_of_modifier;
use grainpath_job::regions::RegionPlace;
use grainpath_job::{JobRegion, Settings};
use rayon::prelude::*;

use crate::guide::faces_as_in_file;
use crate::shape::{self, Repair, ShapeError, SliceSettings, Standing, sections_at};

/// Overlaps of regions of at most this area in a layer give no warning, mm2. Source: derived. A piece of a bead 0.45 mm
/// wide and as long covers the same area.
const TOLD_MM2: f64 = 0.2;
/// Distance by which the body of a face extends out of the part, mm, so that rounding leaves no gap between them. Source:
/// derived. Less than half the outermost bead, and a thousand times the grid of the boolean operations.
const OUTWARDS_MM: f64 = 0.1;
/// A vertex moves by the depth over the mean cosine between its normal and those of its triangles, which is taken as at
/// least this value. Source: derived. With 0.3, the tip of a needle moves by about three depths.
const LEAST_COSINE: f64 = 0.3;

/// Reasons why a region cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum RegionError {
    #[error("region[{number}] lies outside the part: no layer has any of it")]
    Outside { number: usize },
    #[error("region[{number}].on: {source}")]
    Face { number: usize, source: FaceError },
    #[error("region[{number}].on.face needs a part with a surface: a mesh, or an outline")]
    NoSurface { number: usize },
    #[error("region[{number}].on.mesh: {source}")]
    Mesh { number: usize, source: ShapeError },
}

/// The areas of all regions in each layer; areas of the same layer do not overlap.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RegionAreas {
    layers: Vec<Vec<Region>>,
}

/// The inputs from the part that its regions need.
pub struct RegionPart<'a> {
    /// Its layers.
    pub stack: &'a LayerStack,
    /// Surface of the part; empty if it has none.
    pub mesh: &'a TriMesh,
    /// Position and rotation of the part on the plate.
    pub standing: Standing,
    /// Factor from the unit of the part's file to mm.
    pub unit_mm: f64,
    /// Whether a unit stated in a region's file replaces `unit_mm`.
    pub unit_of_file: bool,
    /// Settings for slicing meshes.
    pub slicing: SliceSettings,
}

impl RegionAreas {
    /// The areas in a layer, in the order of the regions; `None` if no region has an area in the layer.
    pub fn of_layer(&self, layer_idx: usize) -> Option<&[Region]> {
        self.layers.get(layer_idx).map(Vec::as_slice).filter(|all| all.iter().any(|r| !r.is_empty()))
    }

    /// Computes the areas of the regions of a job with these settings. `meshes` holds the mesh files of regions, by the index of
    /// the region.
    ///
    /// # Errors
    /// [`RegionError`] for a region outside the part, and for faces and meshes that do not exist.
    pub fn new(
        settings: &Settings,
        meshes: &BTreeMap<usize, MeshFile>,
        part: &RegionPart<'_>,
        diagnostics: &Diagnostics,
    ) -> Result<Self, RegionError> {
        let regions = &settings.regions;
        let layers = part.stack.layers();
        let planes: Vec<f64> = layers.iter().map(|l| l.z_top_mm() - 0.5 * l.height_mm()).collect();
        let all = layers.iter().filter_map(|l| l.region().bounds()).reduce(Bounds2::union);
        let all = all.map_or(Region::default(), |b| Region::rectangle(b.min - 1.0, b.max + 1.0));
        let areas_of = |(k, region): (usize, &JobRegion)| -> Result<Vec<Region>, RegionError> {
            let number = k + 1;
            let whole = |inside: bool, area: &Region| if inside { area.clone() } else { Region::default() };
            Ok(match &region.on {
                RegionPlace::Box { low, high } => {
                    let area = Region::rectangle(low.truncate(), high.truncate());
                    planes.iter().map(|z| whole((low.z..=high.z).contains(z), &area)).collect()
                }
                RegionPlace::Layers(ranges) => {
                    let inside = |i: usize| ranges.iter().any(|[a, b]| (*a..=*b).contains(&(i + 1)));
                    (0..layers.len()).map(|i| whole(inside(i), &all)).collect()
                }
                RegionPlace::Mesh(_) => {
                    let wrong = |source| RegionError::Mesh { number, source };
                    let file = meshes.get(&k).ok_or(wrong(ShapeError::Empty))?;
                    let mesh = mended(file, number, settings.shape.repair, diagnostics).map_err(wrong)?;
                    sections_at(&placed(mesh, file, part), &planes, &part.slicing)
                }
                RegionPlace::Face { face, depth_mm } => {
                    if part.mesh.triangles.is_empty() {
                        return Err(RegionError::NoSurface { number });
                    }
                    let faces = faces_as_in_file(part.mesh, &part.standing);
                    let found =
                        faces.find_name(face).map_err(|source| RegionError::Face { number, source })?;
                    let body = below_face(part.mesh, &faces.all()[found].triangles, *depth_mm);
                    sections_at(&body, &planes, &part.slicing)
                }
            })
        };
        let found: Vec<Vec<Region>> =
            regions.iter().enumerate().map(areas_of).collect::<Result<Vec<_>, _>>()?;
        let touches = |area: &Region, layer: &Layer| !area.intersection(layer.region()).is_empty();
        for (k, areas) in found.iter().enumerate() {
            if !areas.par_iter().zip(layers).any(|(area, layer)| touches(area, layer)) {
                return Err(RegionError::Outside { number: k + 1 });
            }
        }
        let cut: Vec<(Vec<Region>, Vec<[usize; 2]>)> =
            layers.par_iter().enumerate().map(|(i, layer)| last_wins(&found, i, layer)).collect();
        warn_of_overlaps(&cut, layers, diagnostics);
        Ok(Self { layers: cut.into_iter().map(|c| c.0).collect() })
    }
}

/// Cuts the areas of a layer so that later regions take precedence. Returns the areas and the pairs that overlap on the
/// part.
fn last_wins(found: &[Vec<Region>], layer_idx: usize, layer: &Layer) -> (Vec<Region>, Vec<[usize; 2]>) {
    let mut areas: Vec<Region> = found.iter().map(|areas| areas[layer_idx].clone()).collect();
    let mut pairs = Vec::new();
    for later in (1..areas.len()).rev() {
        for earlier in 0..later {
            let both = areas[earlier].intersection(&areas[later]);
            if both.is_empty() {
                continue;
            }
            if both.intersection(layer.region()).area_mm2() > TOLD_MM2 {
                pairs.push([earlier, later]);
            }
            areas[earlier] = areas[earlier].difference(&areas[later]);
        }
    }
    (areas, pairs)
}

/// Gives one warning for each pair of overlapping regions.
fn warn_of_overlaps(cut: &[(Vec<Region>, Vec<[usize; 2]>)], layers: &[Layer], diagnostics: &Diagnostics) {
    let mut of_pair: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    for (i, (_, pairs)) in cut.iter().enumerate() {
        pairs.iter().for_each(|&pair| of_pair.entry(pair).or_default().push(i));
    }
    for ([earlier, later], of_layers) in of_pair {
        let (first, n) = (of_layers[0], of_layers.len());
        let text = format!(
            "region[{}] and region[{}] overlap in {n} layers; there the later one, region[{}], counts",
            earlier + 1,
            later + 1,
            later + 1
        );
        let z_mm = layers[first].z_top_mm();
        diagnostics.push(Warning::new(WarningId::RegionsOverlap, text).in_layer(first, z_mm));
    }
}

/// Joins the bodies of a region's file into one mesh and mends it like the part. What was mended is told with the number of
/// the region.
fn mended(
    file: &MeshFile,
    number: usize,
    repair: Repair,
    diagnostics: &Diagnostics,
) -> Result<TriMesh, ShapeError> {
    let own = Diagnostics::default();
    let mesh = shape::mend(file.bodies.iter().map(|body| body.mesh.clone()).collect(), repair, &own)?;
    for warning in file.warnings.iter().cloned().chain(own.warnings()) {
        let text = format!("region[{number}].on.mesh: {}", warning.text.trim_start_matches("mesh: "));
        diagnostics.push(Warning { text, ..warning });
    }
    Ok(mesh)
}

/// Places the mesh of a region's file like the part.
fn placed(mut mesh: TriMesh, file: &MeshFile, part: &RegionPart<'_>) -> TriMesh {
    let s = part.standing;
    let unit_mm = file.unit.filter(|_| part.unit_of_file).map_or(part.unit_mm, LengthUnit::mm);
    mesh.vertices.iter_mut().for_each(|p| *p = s.rotation * (*p * (unit_mm * s.scale)) + s.shift());
    mesh
}

/// Returns the settings of a job with the modifiers of its mesh appended as regions, and adds their surfaces to `meshes`.
/// A warning lists everything of a modifier that is not used.
pub(crate) fn with_modifiers(
    settings: &Settings,
    mesh: &mut MeshFile,
    meshes: &mut BTreeMap<usize, MeshFile>,
    diagnostics: &Diagnostics,
) -> Settings {
    let mut all = settings.clone();
    let parts: Vec<(DVec3, DVec3)> = mesh.bodies.iter().filter_map(|b| b.mesh.bounds()).collect();
    for modifier in std::mem::take(&mut mesh.modifiers) {
        let name = modifier.name.unwrap_or_else(|| "without a name".to_owned());
        let tell = |what: String| {
            let text = format!("modifier {name:?} {what}");
            diagnostics.push(Warning::new(WarningId::ThreemfVolumes, text));
        };
        let (region, unread) = region_of_modifier(&name, &modifier.settings);
        if !unread.is_empty() {
            tell(format!("has settings that no region has, which are not used: {}", unread.join(", ")));
        }
        // A region outside the part is an error, but a project may contain a modifier of a part that was removed.
        let meets = modifier
            .mesh
            .bounds()
            .is_some_and(|(low, high)| parts.iter().any(|(a, b)| low.max(*a).cmplt(high.min(*b)).all()));
        let Some(region) = region else {
            if unread.is_empty() {
                tell("changes no setting and is not used".to_owned());
            }
            continue;
        };
        if !meets {
            tell("lies outside the part and is not used".to_owned());
            continue;
        }
        // Modifiers are added one by one, so that an invalid one does not prevent the others.
        match all.with_region(region) {
            Ok(more) => {
                let body = MeshBody { mesh: modifier.mesh, ..MeshBody::default() };
                let file = MeshFile {
                    bodies: vec![body],
                    unit: mesh.unit,
                    modifiers: Vec::new(),
                    warnings: Vec::new(),
                };
                meshes.insert(more.regions.len() - 1, file);
                all = more;
            }
            Err(problem) => tell(format!("is not used: {problem}")),
        }
    }
    all
}

/// The closed body between some triangles of a mesh and the same triangles moved inwards.
fn below_face(mesh: &TriMesh, triangles: &[u32], depth_mm: f64) -> TriMesh {
    let corners = |t: &[u32; 3]| t.map(|v| mesh.vertices[v as usize]);
    let face: Vec<[u32; 3]> = triangles.iter().map(|&t| mesh.triangles[t as usize]).collect();
    let area_normal = |t: &[u32; 3]| {
        let [a, b, c] = corners(t);
        (b - a).cross(c - a)
    };
    // Vertices are merged by position, so that triangles without shared vertices also form one surface.
    let key = |v: u32| mesh.vertices[v as usize].to_array().map(f64::to_bits);
    let mut numbers: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut places: Vec<DVec3> = Vec::new();
    let mut normals: Vec<DVec3> = Vec::new();
    let mut welded: Vec<[u32; 3]> = Vec::with_capacity(face.len());
    for t in &face {
        let normal = area_normal(t);
        let t = t.map(|v| {
            *numbers.entry(key(v)).or_insert_with(|| {
                places.push(mesh.vertices[v as usize]);
                normals.push(DVec3::ZERO);
                places.len() as u32 - 1
            })
        });
        t.iter().for_each(|&v| normals[v as usize] += normal);
        welded.push(t);
    }
    let mut cosine = vec![(0.0, 0.0); places.len()];
    for (t, original) in welded.iter().zip(&face) {
        let normal = area_normal(original);
        for &v in t {
            let (sum, weight) = &mut cosine[v as usize];
            *sum += normal.dot(normals[v as usize].normalize_or_zero());
            *weight += normal.length();
        }
    }
    let moved = |by_mm: f64| {
        let one = |(v, p): (usize, &DVec3)| {
            let (sum, weight) = cosine[v];
            let cosine = if weight > 0.0 { (sum / weight).max(LEAST_COSINE) } else { 1.0 };
            *p + by_mm / cosine * normals[v].normalize_or_zero()
        };
        places.iter().enumerate().map(one).collect::<Vec<_>>()
    };
    let n = places.len() as u32;
    let mut body = TriMesh { vertices: moved(OUTWARDS_MM), triangles: Vec::new() };
    body.vertices.extend(moved(-depth_mm));
    let mut border: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for t in &welded {
        body.triangles.push(*t);
        body.triangles.push([t[2] + n, t[1] + n, t[0] + n]);
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            // An edge and its reverse cancel; the remaining edges form the border.
            if a < b {
                *border.entry([a, b]).or_default() += 1
            } else {
                *border.entry([b, a]).or_default() -= 1
            }
        }
    }
    for ([a, b], turns) in border {
        let (a, b) = if turns > 0 { (a, b) } else { (b, a) };
        for _ in 0..turns.abs() {
            body.triangles.push([b, a, a + n]);
            body.triangles.push([b, a + n, b + n]);
        }
    }
    body
}

/// Whether the middle of an edge lies on the border between two areas of a layer, within `off_mm` of it.
pub(crate) fn on_border(areas: &[Region], edge: (DVec2, DVec2), off_mm: f64) -> bool {
    let middle = 0.5 * (edge.0 + edge.1);
    let near = |(a, b): (DVec2, DVec2)| {
        grainpath_core::segment::distance_squared_mm2(middle, a, b) < off_mm * off_mm
    };
    areas.iter().flat_map(Region::contours).any(|c| grainpath_core::poly::edges(c).any(near))
}
