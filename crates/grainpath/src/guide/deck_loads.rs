//! Turns the supports and loads of a finite-element deck into fixtures and load cases of the job's part.
//!
//! The deck has the coordinates of the part's file. Its positions and vectors are rotated,
//! scaled and lowered with the part, as in a job with `guide.frame = "part"`: forces, pressures
//! and displacements keep their size. Its faces become patches of the part's surface. A point
//! of the part belongs to the nearest triangle of the deck if it lies at most
//! [`patch_within_mm`] in front of or behind it, no farther beside it than facets reach, and
//! faces the same way.

use std::sync::Arc;

use grainpath_core::bvh::Bvh;
use grainpath_core::selection::{Facets, Selection, SurfacePatch};
use grainpath_core::{DVec3, TriMesh};
use grainpath_fea::load_case::{Action, Fixture, Held, Load, LoadCase, PatchTraction};
use grainpath_io::fe::{DeckConditions, DeckLoad, DeckPlace};

use crate::shape::Standing;

use super::GuideError;

/// If the bounding box in the deck differs from the part's by more than this share of the part's size, the
/// deck is refused. Source: chosen; the same limit as for imported results.
const SAME_PLACE: f64 = 0.05;

/// Greatest distance between the part's surface and a patch of the deck, as a share of the patch's longest
/// edge. Source: derived: the middle of a hexagon's side lies 0.134 of the side inside its circle, and
/// curved surfaces are meshed with more sides.
const OFF_BY_EDGE: f64 = 0.15;
/// The same distance as a share of the part's size, for fine decks on coarse meshes of the part. Source:
/// chosen: 0.1 mm of 100 mm, a usual chord error of exported meshes.
const OFF_BY_SIZE: f64 = 1e-3;
/// Lower limit of that distance, mm. Source: derived: that of listed facets, a tenth of a layer.
const LEAST_OFF_MM: f64 = 0.02;

/// Greatest distance between the part's surface and the triangles of a patch, mm.
fn patch_within_mm(triangles: &[[DVec3; 3]], size_mm: f64) -> f64 {
    let longest = |t: &[DVec3; 3]| (0..3).map(|k| t[k].distance(t[(k + 1) % 3])).fold(0.0, f64::max);
    let edge = triangles.iter().map(longest).fold(0.0, f64::max);
    (OFF_BY_EDGE * edge).max(OFF_BY_SIZE * size_mm).max(LEAST_OFF_MM)
}

/// The part on which the deck's positions and vectors are placed.
struct OnPart<'a> {
    standing: &'a Standing,
    surface: Bvh,
    size_mm: f64,
}

/// The fixtures and load cases of a deck on the part `mesh`. Fixtures are numbered from `first`.
///
/// # Errors
/// [`GuideError::DeckElsewhere`] if the deck is of another part or in another unit,
/// [`GuideError::DeckOffPart`] if nodes lie away from the part's surface.
pub(super) fn conditions(
    deck: &DeckConditions,
    mesh: &TriMesh,
    standing: &Standing,
    first: usize,
) -> Result<(Vec<Fixture>, Vec<LoadCase>), GuideError> {
    let (low, high) = mesh.bounds().unwrap_or_default();
    let size_mm = (high - low).max_element();
    let part = OnPart { standing, surface: Bvh::new(mesh), size_mm };
    part.check_place(deck, mesh)?;
    let mut fixtures = Vec::with_capacity(deck.supports.len());
    for (k, support) in deck.supports.iter().enumerate() {
        // Numbering continues after the job's own fixtures, so that a message names one fixture only.
        let name = format!("fixture {}", first + k);
        let on = match &support.on {
            DeckPlace::Faces(triangles) => Selection::Patch(part.patch(triangles)),
            DeckPlace::Points(points) => part.points(points.iter().copied(), &name)?,
        };
        let held = Held::turned(standing.rotation, support.held);
        fixtures.push(Fixture { name, on, held, displacement_mm: part.vector(support.displacement_mm) });
    }
    // A step of the deck contains all loads that act in it, including those that remain from earlier steps.
    let mut cases = Vec::with_capacity(deck.steps.len());
    for step in &deck.steps {
        let mut loads = Vec::with_capacity(step.loads.len());
        for (k, load) in step.loads.iter().enumerate() {
            let name = format!("load {} of {}", k + 1, step.name);
            let action = part.action(load, &name)?;
            loads.push(Load { name, action });
        }
        cases.push(LoadCase { name: step.name.clone(), weight: 1.0, loads });
    }
    Ok((fixtures, cases))
}

impl OnPart<'_> {
    fn vector(&self, v: DVec3) -> DVec3 {
        // For a part that is not rotated, vectors stay the same to the last bit.
        if self.standing.is_as_in_file() { v } else { self.standing.rotation * v }
    }

    fn point(&self, p: DVec3) -> DVec3 {
        self.vector(self.standing.scale * p) + self.standing.shift()
    }

    /// Refuses a deck whose part has another position or size. The bounding boxes are compared in the
    /// coordinates of the part's file, which are those of the deck.
    fn check_place(&self, deck: &DeckConditions, mesh: &TriMesh) -> Result<(), GuideError> {
        let (back, scale) = (self.standing.rotation.transpose(), self.standing.scale);
        let in_file = mesh.vertices.iter().map(|p| back * (*p - self.standing.shift()) / scale);
        let (low, high) = in_file
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi): (DVec3, DVec3), p| {
                (lo.min(p), hi.max(p))
            });
        let off = (deck.low - low).abs().max((deck.high - high).abs()).max_element();
        if off > SAME_PLACE * (high - low).max_element() {
            return Err(GuideError::DeckElsewhere { found: [deck.low, deck.high], part: [low, high] });
        }
        Ok(())
    }

    fn triangles(&self, triangles: &[[DVec3; 3]]) -> Vec<[DVec3; 3]> {
        triangles.iter().map(|t| t.map(|p| self.point(p))).collect()
    }

    fn patch(&self, triangles: &[[DVec3; 3]]) -> SurfacePatch {
        let triangles = self.triangles(triangles);
        let within_mm = patch_within_mm(&triangles, self.size_mm);
        SurfacePatch { triangles: Facets::new(triangles), within_mm }
    }

    /// Moves nodes of the deck to the part's surface.
    fn points(&self, points: impl Iterator<Item = DVec3>, name: &str) -> Result<Selection, GuideError> {
        let mut all = Vec::new();
        // The part's mesh may differ from the deck's by a chord error, so nodes are moved to its surface.
        for p in points.map(|p| self.point(p)) {
            let found = self.surface.closest_point(p, f64::INFINITY);
            let off_mm = found.map_or(f64::INFINITY, |f| f.distance);
            // Nodes have no edge by which the distance could be judged, so the part's size is used.
            if off_mm > SAME_PLACE * self.size_mm {
                return Err(GuideError::DeckOffPart { what: name.to_owned(), at_mm: p, off_mm });
            }
            all.push([found.map_or(p, |f| f.point); 3]);
        }
        Ok(Selection::Points(Facets::new(all)))
    }

    fn action(&self, load: &DeckLoad, name: &str) -> Result<Action, GuideError> {
        Ok(match load {
            DeckLoad::Traction { triangles, corners_mpa, is_pressure, force_n, moment_nmm } => {
                let patch = self.patch(triangles);
                let scale = self.standing.scale;
                // A pressure keeps its value, so its force grows with the area; other loads keep their force.
                let grown = if *is_pressure { scale * scale } else { 1.0 };
                let force_n = self.vector(grown * *force_n);
                let shift = self.standing.shift();
                let moment_nmm = self.vector(grown * scale * *moment_nmm) + shift.cross(force_n);
                let mpa = |t: &[DVec3; 3]| t.map(|t| self.vector(t * (grown / (scale * scale))));
                let corners_mpa = Arc::new(corners_mpa.iter().map(mpa).collect());
                let on = Selection::Patch(patch.clone());
                Action::Carried { on, traction: PatchTraction { patch, corners_mpa, force_n, moment_nmm } }
            }
            DeckLoad::Forces(forces) => {
                let on = self.points(forces.iter().map(|f| f.0), name)?;
                let moved = forces.iter().map(|&(p, f)| (self.point(p), self.vector(f)));
                Action::Points { on, forces: Arc::new(moved.collect()) }
            }
            DeckLoad::Acceleration(a) => Action::Acceleration { mm_s2: self.vector(*a) },
            DeckLoad::Centrifugal { point_mm, axis, rad_s } => {
                Action::Centrifugal { point: self.point(*point_mm), axis: self.vector(*axis), rad_s: *rad_s }
            }
        })
    }
}
