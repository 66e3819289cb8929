//! Plans travels: inside the part where possible, otherwise with retraction.
//!
//! What oozes during a straight travel inside the island is covered later. If the straight line
//! crosses the border, the travel follows the crossed contour on its shorter side at a given
//! clearance. The travel is then shortened: points are removed as long as it stays inside. If the
//! detour is longer than a given multiple of the straight line, the nozzle travels straight with
//! the filament retracted and, if the job says so, with a lift.
//!
//! Cost: linear in the vertices of the contour for a travel that crosses the border, constant for
//! one that does not.

use grainpath_core::poly::LineClipper;
use grainpath_core::{DVec2, PlannedPath, Polygon, Region, Toolpath, Travel};

/// Settings of travels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CombSettings {
    /// Whether travels are kept inside the part.
    pub comb: bool,
    /// Shorter travels never retract, mm.
    pub retract_min_mm: f64,
    /// Longest detour, as a multiple of the straight distance; 5 mm more are always
    /// allowed.
    pub max_detour: f64,
    /// Distance of a detour from the border, mm.
    pub clearance_mm: f64,
}

/// Plans the travel to each path of an island. `from` holds the nozzle's position and is updated.
pub(super) fn plan_travels(
    outline: Option<&Polygon>,
    paths: Vec<Toolpath>,
    settings: &CombSettings,
    from: &mut DVec2,
    out: &mut Vec<PlannedPath>,
) {
    let mut inside: Option<Inside<'_>> = None;
    for (i, path) in paths.into_iter().enumerate() {
        let to = path.start();
        let length = from.distance(to);
        let mut travel = Travel { via: Vec::new(), retract: length > settings.retract_min_mm };
        // The first travel comes from another island, so it crosses the border in any case.
        if let (true, Some(outline), true) = (travel.retract && i > 0, outline, settings.comb) {
            let inside = inside.get_or_insert_with(|| Inside::new(outline, settings.clearance_mm));
            if let Some(via) = inside.way(*from, to, settings.max_detour) {
                travel = Travel { via, retract: false };
            }
        }
        *from = path.end();
        out.push(PlannedPath { travel, path });
    }
}

struct Inside<'a> {
    outline: &'a Polygon,
    clipper: LineClipper,
    clearance_mm: f64,
}

impl<'a> Inside<'a> {
    fn new(outline: &'a Polygon, clearance_mm: f64) -> Self {
        Self { outline, clipper: LineClipper::new(&Region::from(outline.clone())), clearance_mm }
    }

    fn contour(&self, i: usize) -> &[DVec2] {
        if i == 0 { &self.outline.outer } else { &self.outline.holes[i - 1] }
    }

    /// The intermediate points of a travel from `a` to `b` that does not cross the border; `None` if no
    /// such travel is short enough.
    fn way(&self, a: DVec2, b: DVec2, max_detour: f64) -> Option<Vec<DVec2>> {
        let crossings = self.clipper.crossings(a, b);
        if crossings.is_empty() {
            return Some(Vec::new());
        }
        // Crossings come in pairs: the line leaves the island and enters it again. An odd number means that
        // an end lies outside the island. The limit of 24 bounds the time for comb-shaped parts.
        if crossings.len() > 24 || crossings.len() % 2 == 1 {
            return None;
        }
        let mut way = vec![a];
        for pair in crossings.chunks_exact(2) {
            // If the line leaves through one contour and returns through another, a path search would be
            // needed, which is too costly for a travel.
            if pair[0].contour != pair[1].contour {
                return None;
            }
            self.along(
                pair[0].contour,
                (pair[0].edge, a.lerp(b, pair[0].t)),
                (pair[1].edge, a.lerp(b, pair[1].t)),
                &mut way,
            );
        }
        way.push(b);
        self.pull_tight(&mut way);
        let length: f64 = way.windows(2).map(|w| w[0].distance(w[1])).sum();
        let inside = way.windows(2).all(|w| self.clipper.crossings(w[0], w[1]).is_empty());
        // A detour of 5 mm is always allowed: for a short travel, a retraction takes longer than a
        // detour of that length.
        (inside && length <= max_detour * a.distance(b) + 5.0).then(|| way[1..way.len() - 1].to_vec())
    }

    /// Adds the shorter way along a contour between two of its edges to `way`, at the clearance inside
    /// the border.
    fn along(&self, contour: usize, from: (usize, DVec2), to: (usize, DVec2), way: &mut Vec<DVec2>) {
        let points = self.contour(contour);
        let n = points.len();
        let forward: Vec<usize> = (0..(to.0 + n - from.0) % n).map(|k| (from.0 + 1 + k) % n).collect();
        let backward: Vec<usize> = (0..(from.0 + n - to.0) % n).map(|k| (from.0 + n - k) % n).collect();
        let length = |way: &[usize]| {
            let mut at = from.1;
            let sum: f64 =
                way.iter().map(|&i| std::mem::replace(&mut at, points[i]).distance(points[i])).sum();
            sum + at.distance(to.1)
        };
        let chosen = if length(&forward) <= length(&backward) { forward } else { backward };
        way.extend(chosen.into_iter().map(|i| {
            let (before, here, after) = (points[(i + n - 1) % n], points[i], points[(i + 1) % n]);
            let (u, v) = ((here - before).normalize_or_zero(), (after - here).normalize_or_zero());
            // The inside is on the left of every contour.
            let normal = DVec2::new(-u.y - v.y, u.x + v.x);
            // The normal of a corner is the sum of two unit normals; its length is 2 cos(turn / 2).
            // Dividing by half the squared length gives the mitred offset. At a sharp corner the offset
            // would be very long, so the corner itself is used.
            let reach = normal.length_squared() / 2.0;
            here + if reach > 0.2 { normal * (self.clearance_mm / reach) } else { DVec2::ZERO }
        }));
    }

    /// Removes points of the way as long as it stays inside.
    fn pull_tight(&self, way: &mut Vec<DVec2>) {
        let mut kept = vec![way[0]];
        let mut i = 0;
        while i + 1 < way.len() {
            // The search for the farthest visible point starts at the end of the way. Long jumps are shortened by a quarter
            // in each step: a way along a round hole has many points, and steps of one point would take too long.
            let mut jump = way.len() - 1 - i;
            while jump > 1 && !self.clipper.crossings(way[i], way[i + jump]).is_empty() {
                jump = if jump > 8 { jump * 3 / 4 } else { jump - 1 };
            }
            i += jump;
            kept.push(way[i]);
        }
        *way = kept;
    }
}
