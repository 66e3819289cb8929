//! Lets the lowest lines of a skin over sparse infill end on what lies below them.
//!
//! Skins follow the surface, not the infill, so the border of a skin crosses the cells of the sparse infill below it. Lines
//! that turn there, beside the beads below, run on to the next turn over air, and a zigzag may hang in a cell for several
//! times the width of the cell. Skins are therefore laid first and then followed. Where a bead runs over air for more than
//! `LONGEST_SHARE` of the longest span that the printer bridges, its skin grows until it covers the cells that the bead
//! lies in, onto the beads around them, and the layer is filled anew. Lines then end on beads at both ends, and those that
//! turn do it on a bead.
//!
//! Method: our own. A cell is found on a mask of the place: it is what is filled in the layer, less the beads of the layer
//! below, from the bead on as far as it goes. Lengths are mm. Cost: a search for every quarter of a span along dense fill; a
//! mask and a second filling in the few layers with such a bead. Limits: a cell that reaches further than a span around the bead
//! is left alone, since lines across it would hang as well. Beads over the outside of the layer below are
//! left to the supports. The lines of a pattern that go on from layer to layer along a field are left alone: they begin where those
//! below lie, so every layer above would have to be laid anew.
//!
//! Regions: each skin grows in its own region. Sparse lines of two regions do not meet at the border between them, so cells end
//! there, and lines of a skin that turn at such a border still do so over air. Sparse infill of a graded density is laid anew
//! beside the skin that grew, and its widths are fitted after that.
//!
//! Jobs with fibre are left alone. A skin over sparse infill has no fibre, and grown over a cell it would cut the fibre there.
//! Fibre has a least length: what is cut shorter carries none at all, which costs more strength than lines that sag in a cell.

use std::collections::BTreeMap;

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::mask::{Mask, MaskGrid};
use grainpath_core::poly::{FillRule, Join, LineClipper};
use grainpath_core::polyline::resampled;
use grainpath_core::segments::Segments;
use grainpath_core::{Bounds2, DVec2, Density, Diagnostics, Region, Role, Toolpath};
use rayon::prelude::*;

use super::steps::{IslandPaths, Steps};
use crate::order::Island;
use crate::support::walls::{LONGEST_SHARE, STEP_MM};
use crate::wall::skin::{IslandPolygon, SkinSplit};

/// A bead is held where the middle of a bead below is at most this many of its widths away in plan. Source: the criterion by
/// which beads of the part over air are measured (`support/interface.rs`), less what points 0.15 mm apart miss.
const HELD_BEADS: f64 = 0.72;
/// Points in a run of the longest length that are looked at first. Source: derived; a run then holds at least two of them.
const COARSE: f64 = 3.0;
/// Cells of a mask in the width of a bead. Source: derived; a skin that grows by one cell ends at three tenths of a bead
/// from the middle of the bead below, and by a cell more or less it still lies on it.
const CELLS: f64 = 5.0;
/// How far a skin that grows reaches into the walls, in bead widths. Source: derived. Ends beside a wall lie on the wall below by
/// [`HELD_BEADS`] even where beads are a tenth narrower.
const INTO_WALLS: f64 = 0.12;

/// Largest number of times that a layer is filled anew. Source: chosen; a strip across many cells took three.
const ROUNDS: usize = 6;

/// A bead that runs too far over air: its island, its role, and points along the run.
struct FreeRun {
    island: usize,
    role: Role,
    points: Vec<DVec2>,
}

/// The skins of a layer and its infill.
type Filled = (SkinSplit, IslandPaths);

impl Steps<'_> {
    /// Fills layers anew in which beads of skins run too far over sparse infill. `islands` holds the walls of each layer of
    /// the window, `laid` its infill. Returns the skins that grew, by the number of their layer in the window.
    ///
    /// # Errors
    /// [`Interrupted`] when a stop was asked for.
    pub(super) fn hold_skins(
        &self,
        first: usize,
        islands: &[&[Island]],
        laid: &mut [IslandPaths],
        density: Density,
        diagnostics: &Diagnostics,
    ) -> Result<BTreeMap<usize, SkinSplit>, Interrupted> {
        let mut all = std::iter::once((self, density))
            .chain(self.regions.iter().map(|region| (region, self.density_in(region, density))));
        // A graded density is filled as sparse infill, however high it is.
        let is_dense = all.all(|(steps, density)| density.is_dense() && steps.graded.is_none());
        if is_dense || self.fibre.is_some() {
            return Ok(BTreeMap::new());
        }
        // The layer below the window is laid once more: windows of any size then give the same layers.
        let before = match first.checked_sub(1) {
            Some(k) => Some(self.laid_alone(k, density)?),
            None => None,
        };
        let mended = |k: usize| -> Result<Option<Filled>, Interrupted> {
            diagnostics.check()?;
            let (walls, fills) = match (k.checked_sub(1), &before) {
                (Some(below), _) => (islands[below], &laid[below]),
                (None, Some((walls, fills))) => (walls.as_slice(), fills),
                (None, None) => return Ok(None),
            };
            let is_sparse = |path: &(usize, Toolpath)| path.1.role == Role::SparseFill;
            if !fills.iter().any(is_sparse) {
                return Ok(None);
            }
            let below = walls.iter().flat_map(|island| island.walls.iter().map(|wall| &wall.path));
            let below: Vec<&Toolpath> = below.chain(fills.iter().map(|(_, path)| path)).collect();
            let runs = self.runs(first + k, &below, &laid[k]);
            if runs.is_empty() { Ok(None) } else { self.filled_anew(first + k, &below, runs, density) }
        };
        let all: Vec<Result<Option<Filled>, Interrupted>> =
            (0..laid.len()).into_par_iter().map(mended).collect();
        let mut grown = BTreeMap::new();
        for (k, mended) in all.into_iter().enumerate() {
            if let Some((split, paths)) = mended? {
                laid[k] = paths;
                grown.insert(k, split);
            }
        }
        Ok(grown)
    }

    /// The walls and the infill of a layer by itself.
    fn laid_alone(&self, k: usize, density: Density) -> Result<(Vec<Island>, IslandPaths), Interrupted> {
        // Its progress was counted before.
        let quiet = Diagnostics::default();
        let mut walls = self.walls(k..k + 1, &quiet)?;
        let mut skins = self.skins(k..k + 1, &mut walls, &quiet)?;
        let split = skins.pop().unwrap_or_default();
        Ok((walls.pop().unwrap_or_default().islands, self.filled(k, &split, density)))
    }

    fn filled(&self, k: usize, split: &SkinSplit, density: Density) -> IslandPaths {
        let mut paths = Vec::new();
        let split = self.line_seams(k, split, &mut paths);
        let mut add = |island, path| paths.push((island, path));
        self.dense_fill(k, &split, &mut add);
        self.sparse_fill(k, &split, density, None, &mut add);
        paths.iter_mut().for_each(|(_, path)| path.shrink_to_fit());
        paths
    }

    fn longest_mm(&self) -> f64 {
        LONGEST_SHARE * self.settings.infill.max_unsupported_mm
    }

    /// The runs of dense fill over the infill below that are too long.
    fn runs(&self, k: usize, below: &[&Toolpath], laid: &IslandPaths) -> Vec<FreeRun> {
        let longest_mm = self.longest_mm();
        let long = |path: &&(usize, Toolpath)| {
            matches!(path.1.role, Role::SolidFill | Role::TopSkin) && path.1.length_mm() > longest_mm
        };
        let mut out = Vec::new();
        let mut seen: Option<(Segments, LineClipper)> = None;
        for (island, path) in laid.iter().filter(long) {
            let (beads, section) = seen.get_or_insert_with(|| {
                let beads =
                    Segments::of_paths(below.iter().copied(), 2.0 * self.settings.walls.bead_width_mm);
                (beads, LineClipper::new(self.stack.layers()[k - 1].region()))
            });
            let reach_mm = HELD_BEADS * path.width_at(0);
            let is_free = |p: &DVec2| beads.within(*p, reach_mm).next().is_none() && section.contains(*p);
            let free = |step_mm: f64| -> (Vec<DVec2>, Vec<bool>) {
                let places = resampled(&path.points, path.closed, step_mm);
                let free = places.iter().map(is_free).collect();
                (places, free)
            };
            // Most beads lie on others, and few points tell so.
            let (_, coarse) = free(longest_mm / COARSE);
            if !coarse.windows(2).any(|pair| pair == [true, true]) {
                continue;
            }
            let (places, fine) = free(STEP_MM);
            let mut end = 0;
            for stretch in fine.chunk_by(|a, b| a == b) {
                end += stretch.len();
                if stretch[0] && stretch.len() as f64 * STEP_MM > longest_mm {
                    let points = places[end - stretch.len()..end].to_vec();
                    out.push(FreeRun { island: *island, role: path.role, points });
                }
            }
        }
        out
    }

    /// Skins that cover the cells below these runs, and the infill of their layer; `None` where that changes nothing.
    fn filled_anew(
        &self,
        k: usize,
        below: &[&Toolpath],
        mut runs: Vec<FreeRun>,
        density: Density,
    ) -> Result<Option<Filled>, Interrupted> {
        let quiet = Diagnostics::default();
        let mut skins = self.skins(k..k + 1, &mut self.walls(k..k + 1, &quiet)?, &quiet)?;
        let Some(mut split) = skins.pop() else { return Ok(None) };
        // A layer whose runs stay too long after all rounds keeps the last filling, which holds more of them than the first.
        let mut filled = None;
        for _ in 0..ROUNDS {
            if !self.grow_skins(k, below, &runs, &mut split) {
                break;
            }
            // A skin of another shape has its turns in other places, and other beads of it may run too far.
            let paths = self.filled(k, &split, density);
            runs = self.runs(k, below, &paths);
            filled = Some(paths);
            if runs.is_empty() {
                break;
            }
        }
        Ok(filled.map(|paths| (split, paths)))
    }

    /// Grows skins over the cells below these runs; whether any grew.
    fn grow_skins(&self, k: usize, below: &[&Toolpath], runs: &[FreeRun], split: &mut SkinSplit) -> bool {
        let mut grew = false;
        let owners = self.owners(k);
        for run in runs {
            let own = |polygons: &[IslandPolygon]| {
                let own = polygons.iter().filter(|(island, _)| *island == run.island);
                Region { polygons: own.map(|(_, polygon)| polygon.clone()).collect() }
            };
            let mine = owners.as_ref().map_or(0, |owners| owners.at(run.points[run.points.len() / 2]));
            let split = match mine.checked_sub(1).and_then(|region| split.regions.get_mut(region)) {
                Some(region) => region,
                None => &mut *split,
            };
            let sparse = own(&split.sparse);
            let dense = [&split.solid, &split.top].map(|polygons| own(polygons));
            let [skin, other] =
                if run.role == Role::TopSkin { [&dense[1], &dense[0]] } else { [&dense[0], &dense[1]] };
            let Some(cells) = self.cells_below(below, run, &[&sparse, skin, other]) else { continue };
            let more = cells.intersection(&sparse);
            if more.is_empty() {
                continue;
            }
            grew = true;
            let into_mm = INTO_WALLS * self.settings.walls.bead_width_mm;
            let within = sparse.union(skin).offset(into_mm, Join::Miter(2.0)).difference(&own(&split.bridge));
            let grown = skin.union(&cells.intersection(&within)).difference(other);
            let replace = |polygons: &mut Vec<IslandPolygon>, by: Region| {
                let at = polygons.partition_point(|(island, _)| *island < run.island);
                polygons.retain(|(island, _)| *island != run.island);
                polygons.splice(at..at, by.polygons.into_iter().map(|polygon| (run.island, polygon)));
            };
            // What the skin covers now is no sparse infill any more, so nothing is laid twice.
            let rest = sparse.difference(&cells);
            replace(&mut split.sparse, rest);
            replace(if run.role == Role::TopSkin { &mut split.top } else { &mut split.solid }, grown);
        }
        grew
    }

    /// The cells between beads of the layer below that a run lies in, grown onto these beads; `None` where they reach too far.
    fn cells_below(&self, below: &[&Toolpath], run: &FreeRun, filled: &[&Region]) -> Option<Region> {
        let w = self.settings.walls.bead_width_mm;
        let span_mm = self.settings.infill.max_unsupported_mm;
        let bounds = Bounds2::around_points(run.points.iter().copied())?;
        if bounds.size().max_element() > 3.0 * span_mm {
            return None;
        }
        let bounds = bounds.grown(span_mm);
        let grid = MaskGrid::over(bounds, w / CELLS);
        // Where a mask would be too large, its cells are wider than beads can be told by.
        if grid.cell_mm() > 1.5 * w / CELLS {
            return None;
        }
        let mut beads = Mask::empty(grid);
        for path in below {
            for (a, b, width_mm) in (0..path.n_segments()).map(|i| path.segment(i)) {
                if Bounds2::around_points([a, b]).is_some_and(|around| around.grown(w).meets(bounds)) {
                    let along = 0.5 * width_mm * (b - a).normalize_or_zero();
                    let across = along.perp();
                    beads.add_convex(&[
                        a - along - across,
                        b + along - across,
                        b + along + across,
                        a - along + across,
                    ]);
                }
            }
        }
        let filled = filled.iter().flat_map(|region| region.contours());
        let open = Mask::wound(grid, filled).and_not(&beads);
        let mut cells = Mask::empty(grid);
        for p in &run.points {
            let half = 0.5 * grid.cell_mm();
            cells.add_convex(&[
                *p - half,
                *p + DVec2::new(half, -half),
                *p + half,
                *p + DVec2::new(-half, half),
            ]);
        }
        // From the run the cell is flooded up to the beads around it.
        cells = cells.and(&open);
        // A cell is as far away as the mask is wide at most.
        let [nx, ny] = grid.size();
        let mut count = cells.count();
        for _ in 0..nx + ny {
            cells = cells.grown(1).and(&open);
            let more = cells.count();
            if more == count {
                break;
            }
            count = more;
        }
        let contours = cells.grown(1).contours();
        let inside = bounds.grown(-w);
        let stays = contours.iter().flatten().all(|p| p.cmpge(inside.min).all() && p.cmple(inside.max).all());
        (stays && !contours.is_empty()).then(|| Region::from_contours(&contours, FillRule::NonZero))
    }
}
