//! From a surface to ten-node tetrahedra with curved sides.
//!
//! Method: isosurface stuffing (`labelle2007`). Shells without volume are removed, walls are measured, and a
//! lattice of cells is laid over the part. Cells at thin walls and gaps are halved up to three times. The
//! lattice is cut along the surface, vertices near sharp edges move onto them, and middle nodes move onto the
//! surface where their element keeps at least a quarter of its Jacobian. A size that is not given is the
//! thickness of the thin walls or a fortieth of the diagonal, whichever is less. It is enlarged where the
//! unknowns would exceed their limit.
//!
//! Lengths are in mm. Each element has ten nodes in the order of `TetMesh`; each face of the boundary knows
//! the facet of the surface on which it lies. Cost: linear in the tetrahedra, with a query of the tree over
//! the facets for each point near the surface. The unknowns that halved cells are expected to add stay below
//! twice those of an even lattice, or below the limit for automatic sizes if that is more.
//!
//! Limits: walls thinner than 0.09 of the cell size are refused, with a size that would do. So is a mesh in
//! which the walls that are missing hold more than 3 % of the volume and of the surface; a smaller share is
//! reported. Pieces of less than a thousandth of the volume are left out and counted. Pieces that touch only
//! at a corner or an edge get vertices of their own. A surface without volume is an error.

use std::collections::BTreeMap;

use grainpath_core::diagnostics::CancelFlag;
use grainpath_core::{Bvh, DVec3, TriMesh};
use rayon::prelude::*;

use super::clean_surface;
use super::features::Features;
use super::lattice::{CELLS_PER_WALL, DEEPEST, Lattice, is_closed};
use super::snap::{self, Bound};
use super::stuffing::{self, Tets};
use super::thin_gaps;
use super::wall_thickness::{self, MeasuredWalls};
use crate::solid::model::adjacency::pieces_of;
use crate::solid::model::error::SolidError;
use crate::solid::model::memory::solving_mib;
use crate::solid::model::point_location::Sampler;
use crate::solid::model::tet_mesh::{Face, Piece, TetMesh};
use crate::solid::model::tet_shape::{self, MeshQuality};

/// Approximate number of unknowns for each tetrahedron; in the interior of a lattice there are 4.
const DOFS_PER_TET: f64 = 4.6;
/// Approximate number of unknowns that are added when a cell at the surface is divided. Source: derived. Half of its
/// eight parts are inside, each with 12 tetrahedra of 4.6 unknowns. Half of the 12 tetrahedra of the whole cell were
/// inside before; their unknowns are subtracted.
const DOFS_PER_SPLIT: f64 = 200.0;

/// Number of times that an automatically chosen size may be enlarged to bring the unknowns within
/// their limit.
const COARSENINGS: usize = 2;

/// Share of the volume that may be missing from the mesh in thin walls; more is refused. The mean
/// stiffness is then wrong by about as much, which is less than the moduli of printed plastics
/// vary.
const MAX_LOST_SHARE: f64 = 0.03;
/// Factor by which halved cells at thin walls may raise the number of unknowns over that of a uniform lattice.
const MAX_REFINEMENT: f64 = 2.0;
/// Factor between the sizes tried in the search for one that fits the memory limit.
/// Source: chosen; a step changes the number of elements by a fifth.
const SIZE_STEP: f64 = 1.06;
/// Number of sizes tried. Source: derived: 1.06^36 is 8.1, the range that three halvings of a cell
/// cover.
const SIZES_TRIED: usize = 36;

/// Fineness of a mesh.
#[derive(Debug, Clone)]
pub struct MeshSettings {
    /// Edge of a lattice cell, mm; cells at thin walls and gaps are up to eight times smaller.
    /// `None` chooses the size from the thinnest walls and the part's size.
    pub size_mm: Option<f64>,
    /// Limit on the unknowns for a size chosen automatically.
    pub max_dofs: usize,
    /// Memory limit of the later solution, MiB. A refusal names a size that fits it.
    pub max_mib: f64,
    /// Ends the meshing between two of its steps.
    pub cancel: CancelFlag,
}

impl Default for MeshSettings {
    /// A size chosen for at most 300 000 unknowns, without a limit on memory.
    fn default() -> Self {
        Self { size_mm: None, max_dofs: 300_000, max_mib: f64::INFINITY, cancel: CancelFlag::default() }
    }
}

/// A mesh and its properties.
#[derive(Debug, Clone)]
pub struct Meshed {
    /// The elements.
    pub mesh: TetMesh,
    /// Edge of a lattice cell, mm.
    pub size_mm: f64,
    /// Thickness that the walls of all but two percent of the volume exceed, mm.
    pub wall_mm: f64,
    /// Share of the volume in walls that are missing because the elements were too large for them;
    /// a warning is due.
    pub lost_share: f64,
    /// Number of shells without volume that were removed from the surface.
    pub n_flat_shells: usize,
    /// Shape of the elements.
    pub quality: MeshQuality,
    /// Volume of the elements with their curved sides, mm3.
    pub volume_mm3: f64,
    /// Volume within the surface, mm3; overlaps of bodies count twice.
    pub surface_mm3: f64,
    /// Pieces connected over faces.
    pub pieces: Vec<Piece>,
    /// Number of pieces left out because they hold less than a thousandth of the volume.
    pub n_crumbs: usize,
}

/// Expected number of unknowns: a lattice cell in the interior has 16 nodes, and each cell area of
/// the surface adds 8.
pub fn expected_dofs(volume_mm3: f64, area_mm2: f64, size_mm: f64) -> f64 {
    3.0 * (16.0 * volume_mm3 / size_mm.powi(3) + 8.0 * area_mm2 / size_mm.powi(2))
}

/// Meshes the volume that a surface encloses.
///
/// # Errors
/// Walls thinner than the elements, a lattice too fine for memory, no enclosed volume, or a stop by the
/// flag of the settings.
pub fn mesh(surface: &TriMesh, settings: &MeshSettings) -> Result<Meshed, SolidError> {
    let clean = clean_surface::without_flat_shells(surface);
    let surface: &TriMesh = &clean.mesh;
    let bvh = Bvh::new(surface);
    let walls = wall_thickness::walls(surface, &bvh);
    let wall_mm = walls.decisive_thickness_mm();
    let mut size_mm = choose_size(surface, &walls, settings)?;
    let mut tets = fill(surface, &bvh, size_mm, settings)?;
    for _ in 0..COARSENINGS {
        let over = DOFS_PER_TET * tets.tets.len() as f64 / settings.max_dofs.max(1) as f64;
        if settings.size_mm.is_some() || over < 1.1 {
            break;
        }
        // Finer cells at thin walls used up the unknowns, so all cells grow.
        size_mm *= over.cbrt();
        tets = fill(surface, &bvh, size_mm, settings)?;
    }
    let n_crumbs = separate(&mut tets);
    if tets.tets.is_empty() {
        let thin = thin_walls(surface, wall_mm, size_mm, settings);
        // No tetrahedron at all: either every wall was too thin, or the surface encloses no volume.
        return Err(if wall_mm < size_mm { thin } else { SolidError::NothingInside });
    }
    settings.cancel.check()?;
    let features = Features::find(surface);
    let bounds = snap::snap(&mut tets, &features, &bvh);
    settings.cancel.check()?;
    let mut mesh = quadratic(&tets, &bounds, &features, &bvh);
    let lost_share = lost_walls(&mesh, &walls, size_mm);
    if lost_share > MAX_LOST_SHARE {
        return Err(thin_walls(surface, wall_mm, size_mm, settings));
    }
    mesh.faces.iter_mut().for_each(|face| face.facet = clean.original_facet(face.facet));
    let quality = mesh.quality();
    let volume_mm3 = mesh.volume_mm3();
    let pieces = mesh.pieces();
    let surface_mm3 = surface.signed_volume().abs();
    Ok(Meshed {
        mesh,
        size_mm,
        wall_mm,
        lost_share,
        n_flat_shells: clean.n_removed,
        quality,
        volume_mm3,
        surface_mm3,
        pieces,
        n_crumbs,
    })
}

/// Cuts the inside of a surface into tetrahedra, finer where walls and gaps are thin. The
/// refinement is limited to twice the unknowns of an even lattice, or to the limit for automatic
/// sizes.
fn fill(surface: &TriMesh, bvh: &Bvh, size_mm: f64, settings: &MeshSettings) -> Result<Tets, SolidError> {
    let mut lattice = Lattice::over(surface, size_mm)?;
    let area = area_mm2(surface);
    let even = expected_dofs(surface.signed_volume().abs(), area, size_mm);
    let most = (2.0 * even).max(settings.max_dofs as f64);
    // Tries the deepest refinement first, then less, until the expected unknowns fit.
    for deepest in (0..=DEEPEST).rev() {
        settings.cancel.check()?;
        lattice.refine(surface, bvh, deepest);
        if DOFS_PER_SPLIT * lattice.n_split() as f64 <= most {
            break;
        }
    }
    settings.cancel.check()?;
    let closed = is_closed(surface);
    lattice.classify(bvh, closed);
    fits_memory(lattice.inside_mm3(), area, size_mm, settings.max_mib)?;
    settings.cancel.check()?;
    let mut background = lattice.background(surface, bvh, closed);
    // The lattice and the tetrahedra made from it are each among the largest objects; only one is
    // needed from here on.
    drop(lattice);
    settings.cancel.check()?;
    let stays = thin_gaps::centre(&mut background, surface, bvh);
    settings.cancel.check()?;
    Ok(stuffing::stuff(&background, &stays, |p| bvh.contains(p)))
}

/// Refuses elements whose solution would take more memory than allowed before they are made: the cells inside tell how many nodes
/// there will be at least. A block of 50 x 50 x 20 mm with elements of 0.4 mm is refused after 0.3 s with 17 MB; its mesh takes
/// 40 s and 3 GB.
fn fits_memory(inside_mm3: f64, area_mm2: f64, size_mm: f64, limit_mib: f64) -> Result<(), SolidError> {
    let mib = |area_mm2, size_mm| solving_mib(expected_dofs(inside_mm3, area_mm2, size_mm) / 3.0);
    // Nodes at the surface are expected, not counted, so they refuse nothing.
    if mib(0.0, size_mm) <= limit_mib {
        return Ok(());
    }
    let fitting_mm = least_size_mm(size_mm, |size| mib(area_mm2, size) <= limit_mib);
    // Rounded up, so that the size that is printed fits too.
    let fitting_mm = (100.0 * fitting_mm).ceil() / 100.0;
    Err(SolidError::Memory { what: "solving", need_mib: mib(area_mm2, size_mm), limit_mib, fitting_mm })
}

fn area_mm2(surface: &TriMesh) -> f64 {
    let v = |i: u32| surface.vertices[i as usize];
    surface.triangles.iter().map(|t| (v(t[1]) - v(t[0])).cross(v(t[2]) - v(t[0])).length() / 2.0).sum()
}

fn choose_size(surface: &TriMesh, walls: &MeasuredWalls, settings: &MeshSettings) -> Result<f64, SolidError> {
    let (lo, hi) = surface.bounds().ok_or(SolidError::NothingInside)?;
    let (area, volume) = (area_mm2(surface), surface.signed_volume().abs());
    let dofs = |size: f64| expected_dofs(volume, area, size);
    let size_mm = settings.size_mm.unwrap_or_else(|| {
        // A fortieth of the diagonal resolves bending of a plain part; thinner walls ask for more.
        let wanted = walls.thickness_mm().min((hi - lo).length() / 40.0);
        wanted.max(least_size_mm(wanted, |size| dofs(size) <= settings.max_dofs as f64))
    });
    // Cells are refined at thin walls, but only to a limit. Whether the walls are resolved is
    // tested on the finished mesh.
    let thickness_mm = walls.decisive_thickness_mm();
    if size_mm.is_nan() || size_mm > max_size_mm(thickness_mm) {
        return Err(thin_walls(surface, thickness_mm, size_mm, settings));
    }
    Ok(size_mm)
}

/// The least size that fits, within a factor of a million of this one, mm. Larger sizes have to fit wherever smaller ones do.
fn least_size_mm(about_mm: f64, fits: impl Fn(f64) -> bool) -> f64 {
    let (mut fine, mut coarse) = (1e-6 * about_mm, 1e6 * about_mm);
    // Bisection on a logarithmic scale.
    for _ in 0..60 {
        let middle = (fine * coarse).sqrt();
        if fits(middle) { coarse = middle } else { fine = middle }
    }
    coarse
}

/// The largest cell size, mm, at which the smallest divided cells still have lattice planes within
/// a wall of this thickness.
fn max_size_mm(wall_mm: f64) -> f64 {
    f64::from(1 << DEEPEST) * CELLS_PER_WALL * wall_mm
}

/// The error for walls that are too thin, with a size that would do. A size without halved cells is
/// certain to resolve the walls. If that does not fit the memory limit, the smallest size that fits
/// is named; it may do with halved cells.
fn thin_walls(surface: &TriMesh, thickness_mm: f64, size_mm: f64, settings: &MeshSettings) -> SolidError {
    let (area, volume) = (area_mm2(surface), surface.signed_volume().abs());
    let fits = |size: f64| {
        let n_nodes = MAX_REFINEMENT * expected_dofs(volume, area, size) / 3.0;
        solving_mib(n_nodes) <= settings.max_mib
    };
    let (sure_mm, max_mm) = (CELLS_PER_WALL * thickness_mm, max_size_mm(thickness_mm));
    let steps = std::iter::successors(Some(sure_mm), |size| Some(SIZE_STEP * size)).take(SIZES_TRIED);
    let fitting_mm =
        steps.take_while(|&size| size <= max_mm).find(|&s| s > 0.0 && s < 0.99 * size_mm && fits(s));
    SolidError::ThinWalls { thickness_mm, size_mm, fitting_mm, limit_mib: settings.max_mib }
}

/// The share of the volume that lies in walls missing from the mesh, or their share of the surface
/// if that is less.
fn lost_walls(mesh: &TetMesh, walls: &MeasuredWalls, size_mm: f64) -> f64 {
    // Walls of one and a half cells and more are resolved; only thinner ones are tested.
    let thin: Vec<(DVec3, f64)> = walls.middles_under(1.5 * size_mm).collect();
    let Some(sampler) = Sampler::new(mesh).filter(|_| !thin.is_empty()) else { return 0.0 };
    // A point slightly outside an element still counts as inside: the middle of a wall may lie just
    // beyond a flat face.
    let inside = |p: DVec3| sampler.at(p).is_some_and(|spot| spot.depth > -0.05);
    let lost: Vec<f64> = thin.par_iter().filter(|(p, _)| !inside(*p)).map(|(_, share)| *share).collect();
    walls.share_of_surface(lost.len()).min(lost.iter().sum())
}

/// Leaves out tiny pieces. Pieces that touch only at a corner or along an edge get separate
/// vertices, because such a hinge would have no stiffness. Returns the number of pieces left out.
fn separate(mesh: &mut Tets) -> usize {
    let piece = pieces_of(&mesh.tets);
    let mut volume: BTreeMap<u32, f64> = BTreeMap::new();
    for (t, &p) in mesh.tets.iter().zip(&piece) {
        let v = tet_shape::volume(&t.map(|i| mesh.vertices[i as usize]));
        *volume.entry(p).or_default() += v;
    }
    if volume.len() < 2 {
        return 0;
    }
    let least = 1e-3 * volume.values().sum::<f64>();
    let kept: Vec<(&[u32; 4], u32)> =
        mesh.tets.iter().zip(piece).filter(|(_, p)| volume[p] > least).collect();
    let mut own: Vec<(u32, u32)> = kept.iter().flat_map(|(t, p)| t.map(|v| (v, *p))).collect();
    own.sort_unstable();
    own.dedup();
    let id = |v: u32, p: u32| own.binary_search(&(v, p)).expect("listed above") as u32;
    mesh.tets = kept.iter().map(|(t, p)| t.map(|v| id(v, *p))).collect();
    mesh.vertices = own.iter().map(|&(v, _)| mesh.vertices[v as usize]).collect();
    mesh.size_mm = own.iter().map(|&(v, _)| mesh.size_mm[v as usize]).collect();
    volume.values().filter(|&&v| v <= least).count()
}

/// Adds the middle nodes: half way along straight sides, and on the surface for sides that lie on
/// it, unless that would distort an element.
fn quadratic(tets: &Tets, bounds: &[Bound], features: &Features, bvh: &Bvh) -> TetMesh {
    let mut mesh = TetMesh::straight(&tets.vertices, &tets.tets);
    let mut sides: Vec<[u32; 3]> = mesh
        .faces
        .iter()
        .flat_map(|f| {
            let [a, b, c, ab, bc, ca] = f.nodes;
            [[a, b, ab], [b, c, bc], [c, a, ca]].map(|[a, b, m]| [a.min(b), a.max(b), m])
        })
        .collect();
    sides.sort_unstable();
    sides.dedup();
    let curved = |&[a, b, m]: &[u32; 3]| {
        // A side lies on the surface if both its ends share a patch: one patch on a smooth surface,
        // two along a sharp edge.
        let shared = bounds[a as usize].patches().iter().filter(|p| bounds[b as usize].patches().contains(p));
        let shared: Vec<u32> = shared.copied().collect();
        let (p, q) = (mesh.nodes[a as usize], mesh.nodes[b as usize]);
        let (middle, reach) = (0.5 * (p + q), 0.25 * p.distance(q));
        let to = match shared.as_slice() {
            [] => None,
            [only] => bvh
                .closest_point(middle, reach)
                .filter(|c| features.patch[c.triangle as usize] == *only)
                .map(|c| c.point),
            several => features
                .nearest(middle, reach)
                .filter(|(_, e)| features.edges[*e].1.iter().all(|s| several.contains(s)))
                .map(|n| n.0),
        };
        to.filter(|to| to.distance(middle) > 1e-9 * reach).map(|to| (m, to))
    };
    let moves: Vec<(u32, DVec3)> = sides.par_iter().filter_map(curved).collect();
    mesh.curve(&moves);
    let label = |f: &Face| {
        let middle = f.nodes[3..].iter().map(|&m| mesh.nodes[m as usize]).sum::<DVec3>() / 3.0;
        bvh.closest_point(middle, f64::INFINITY)
    };
    let feet: Vec<_> = mesh.faces.par_iter().map(label).collect();
    for (face, foot) in mesh.faces.iter_mut().zip(feet) {
        (face.facet, face.foot) = (foot.map_or(0, |c| c.triangle), foot.map(|c| c.point));
    }
    // Numbering by position keeps the nodes of an element close in memory, which the solver needs.
    mesh.sort_in_space();
    mesh
}
