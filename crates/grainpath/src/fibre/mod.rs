//! Continuous fibre: chooses the fill paths that are laid with fibre, treats turns below the least
//! radius, and reports how much became fibre.
//!
//! The paths come from a fill pattern. Paths that are long enough become fibre of one width; the others stay matrix.
//! Turns of fibre are rounded to the least radius where there is space, else to the largest radius that fits, or the fibre
//! is cut there, and lines return where the least radius fits ([`grainpath_core::wide_turns`]). Lengths are in mm. Layers count from 1 in
//! settings and from 0 in the code.

use grainpath_core::poly::{Join, LineClipper};
use grainpath_core::polyline;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::wide_turns::{Place, any_cross, joined, uncrossed};
use grainpath_core::{
    BeadWidth, Bounds2, DVec2, DVec3, Diagnostics, LayerStack, Polygon, Region, Role, Toolpath, WarningId,
};

pub use grainpath_core::turns::{SMALLEST_MM, Turn, rounded, sharp_bends, sharp_turns, turns};
pub use grainpath_job::choices::{FibreStart, FibreTurns};

/// Settings of continuous fibre.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreSettings {
    /// First and last layer with fibre, counted from 1; empty for all layers.
    pub layers: Vec<[usize; 2]>,
    /// Number of layers at the bottom and at the top that have no fibre.
    pub matrix_layers: [usize; 2],
    /// Number of layers of the part.
    pub n_layers: usize,
    /// Vector from part coordinates to those of the G-code, mm. Turns are measured as they are written, and coordinates halfway
    /// between two micrometres are rounded away from zero.
    pub plate_from_part_mm: DVec2,
    /// Period in layers: 2 lays fibre in every other one of the chosen layers.
    pub every: usize,
    /// Boxes in which fill is laid with fibre, in part coordinates on the plate, mm; empty for the
    /// whole part.
    pub boxes: Vec<[DVec3; 2]>,
    /// Number of rings along outlines and around holes, laid before the pattern.
    pub rings: usize,
    /// Width of a bead with fibre, mm.
    pub bead_width_mm: f64,
    /// Least radius of a turn, mm.
    pub min_radius_mm: f64,
    /// Treatment of turns sharper than `min_radius_mm`.
    pub turns: FibreTurns,
    /// Least length of a fibre path, mm; shorter paths are laid as matrix.
    pub min_length_mm: f64,
    /// Rule for the start of closed paths.
    pub start: FibreStart,
}

/// Why fibre cannot be laid as the settings ask.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum FibreError {
    #[error(
        "fibre.min_radius_mm = {radius_mm}: a turn of that radius is {:.1} mm wide and the part {size_mm:.1} mm",
        2.0 * radius_mm
    )]
    Radius { radius_mm: f64, size_mm: f64 },
    #[error("fibre.layers = [{first}, {last}]: the part has {n_layers} layers")]
    Layers { first: usize, last: usize, n_layers: usize },
    #[error(
        "fibre.matrix_layers = [{below}, {above}]: the part has {n_layers} layers, which leaves none for fibre"
    )]
    MatrixLayers { below: usize, above: usize, n_layers: usize },
    #[error(
        "fibre.boxes_mm: box {number} misses the part, which lies from ({:.2}, {:.2}, 0) to ({:.2}, {:.2}, {top_mm:.2}) mm",
        part.min.x, part.min.y, part.max.x, part.max.y
    )]
    Box { number: usize, part: Bounds2, top_mm: f64 },
    #[error(
        "no fibre was laid: the longest path is {longest_mm:.1} mm and {needed_mm:.1} mm are needed (fibre.min_length_mm, or printer.fibre_cutter_mm and fibre.anchor_mm)"
    )]
    TooShort { longest_mm: f64, needed_mm: f64 },
    #[error("no fibre was laid: the layers chosen have no fill")]
    NoFill,
}

/// Where paths are laid with fibre, and how.
#[derive(Clone, Copy)]
pub struct FibrePlace<'a> {
    /// The area for centrelines.
    pub region: &'a Region,
    /// Distance between beads side by side, mm.
    pub spacing_mm: f64,
    /// The load at a point, from which the start of a closed path may be chosen.
    pub load: &'a dyn Fn(DVec2) -> f64,
    /// The start of a closed path, and groups of wide turns, move on by this, mm.
    pub onward_mm: f64,
    /// Whether closed paths stay closed, so that the print order chooses their start.
    pub keep_closed: bool,
    /// Whether the paths are rings along the border, which do not return.
    pub rings: bool,
}

/// Counts of the paths that were meant to become fibre.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tally {
    /// Paths laid without fibre because they are short.
    pub short: usize,
    /// Total length of these short paths, mm.
    pub short_mm: f64,
    /// The longest path, mm, whether it became fibre or not.
    pub longest_mm: f64,
    /// Number of turns that were rounded.
    pub rounded: usize,
}

impl Tally {
    /// Both tallies together.
    pub fn and(self, other: Self) -> Self {
        Self {
            short: self.short + other.short,
            short_mm: self.short_mm + other.short_mm,
            longest_mm: self.longest_mm.max(other.longest_mm),
            rounded: self.rounded + other.rounded,
        }
    }
}

impl FibreSettings {
    /// Refuses settings that are impossible for this part.
    ///
    /// # Errors
    /// [`FibreError`] for a radius, layer or box outside the part.
    pub fn check(&self, stack: &LayerStack, part: Bounds2) -> Result<(), FibreError> {
        let size_mm = part.size().max_element();
        // A half turn is two radii wide. If this is more than the part's longer side, no path could make
        // such a turn.
        if 2.0 * self.min_radius_mm > size_mm {
            return Err(FibreError::Radius { radius_mm: self.min_radius_mm, size_mm });
        }
        let n_layers = stack.layers().len();
        if let Some(&[first, last]) = self.layers.iter().find(|l| l[1] > n_layers) {
            return Err(FibreError::Layers { first, last, n_layers });
        }
        let [below, above] = self.matrix_layers;
        if below.saturating_add(above) >= n_layers {
            return Err(FibreError::MatrixLayers { below, above, n_layers });
        }
        let top_mm = stack.layers().last().map_or(0.0, |l| l.z_top_mm());
        let misses = |[low, high]: &[DVec3; 2]| {
            low.z >= top_mm
                || high.z <= 0.0
                || !part.meets(Bounds2 { min: low.truncate(), max: high.truncate() })
        };
        match self.boxes.iter().position(misses) {
            Some(k) => Err(FibreError::Box { number: k + 1, part, top_mm }),
            None => Ok(()),
        }
    }

    /// Warns about paths that were too short for fibre.
    ///
    /// # Errors
    /// [`FibreError`] when no path became fibre.
    pub(crate) fn report_outcome(
        &self,
        all: &Tally,
        any: bool,
        diagnostics: &Diagnostics,
    ) -> Result<(), FibreError> {
        if !any {
            // The two causes need different remedies: either all paths are too short, or the layers have
            // no fill.
            return Err(if all.longest_mm > 0.0 {
                FibreError::TooShort { longest_mm: all.longest_mm, needed_mm: self.min_length_mm }
            } else {
                FibreError::NoFill
            });
        }
        if all.short > 0 {
            diagnostics.warn(
                WarningId::FibreTooShort,
                format!(
                    "fibre: {} paths shorter than {} mm, {:.0} mm in all, are laid without fibre",
                    all.short, self.min_length_mm, all.short_mm
                ),
            );
        }
        Ok(())
    }

    /// Whether a layer, counted from 0, has fibre.
    pub fn in_layer(&self, i: usize) -> bool {
        if i < self.matrix_layers[0] || i + self.matrix_layers[1] >= self.n_layers {
            return false;
        }
        let first = match self.layers.iter().find(|l| (l[0]..=l[1]).contains(&(i + 1))) {
            Some(l) => l[0] - 1,
            None if self.layers.is_empty() => 0,
            None => return false,
        };
        // The period is counted from the first layer of each range, so that every range begins with
        // fibre.
        (i - first).is_multiple_of(self.every.max(1))
    }

    /// Indices of the boxes that contain a height.
    fn boxes_at(&self, z_mm: f64) -> impl Iterator<Item = usize> + '_ {
        (0..self.boxes.len()).filter(move |&k| (self.boxes[k][0].z..self.boxes[k][1].z).contains(&z_mm))
    }

    /// Whether two layers that have the same infill regions also have fibre in the same places. Each layer is
    /// given by its index and its height, mm.
    pub fn same(&self, a: (usize, f64), b: (usize, f64)) -> bool {
        self.in_layer(a.0) == self.in_layer(b.0) && self.boxes_at(a.1).eq(self.boxes_at(b.1))
    }

    /// Splits an infill region into the parts for centrelines of fibre and the parts for centrelines of matrix
    /// beads, which have the width `matrix_mm`.
    pub fn split(
        &self,
        layer: (usize, f64),
        height_mm: f64,
        infill_region: &Polygon,
        matrix_mm: f64,
    ) -> (Vec<Polygon>, Vec<Polygon>) {
        if !self.in_layer(layer.0) {
            return (Vec::new(), vec![infill_region.clone()]);
        }
        let infill_region = Region::from(infill_region.clone());
        // The region fits centrelines of matrix beads. It is offset for fibre beads, which have another width.
        let fits = |r: &Region| r.offset(0.5 * (matrix_mm - self.bead_width_mm), Join::Miter(3.0)).polygons;
        if self.boxes.is_empty() {
            return (fits(&infill_region), Vec::new());
        }
        let rectangle = |k: usize| {
            let [low, high] = self.boxes[k];
            Region::rectangle(low.truncate(), high.truncate())
        };
        let chosen = self.boxes_at(layer.1).map(rectangle).fold(Region::default(), |a, b| a.union(&b));
        // Fibre and matrix both keep half a bead's distance from the border of the box.
        let half = |w: f64| 0.5 * bead_spacing_mm(w, height_mm);
        let with = chosen.offset(-half(matrix_mm), Join::Miter(3.0)).intersection(&infill_region);
        let without = infill_region.difference(&chosen.offset(half(matrix_mm), Join::Miter(3.0)));
        (fits(&with), without.polygons)
    }

    /// Lays fibre rings along every contour of `regions`, in which centrelines may lie. Neighbouring rings are
    /// one bead spacing apart. Returns the regions that are left for the centrelines of the pattern.
    pub(crate) fn lay_rings(
        &self,
        regions: &[Polygon],
        height_mm: f64,
        role: Role,
        out: &mut Vec<Toolpath>,
    ) -> Vec<Polygon> {
        let s = bead_spacing_mm(self.bead_width_mm, height_mm);
        let mut rest = Region { polygons: regions.to_vec() };
        for _ in 0..self.rings {
            let paths = rest.contours().map(|c| Toolpath::new(c.clone(), self.bead_width_mm, role, true));
            // A shorter ring is not laid, since its bead would cover all that it encloses.
            out.extend(paths.filter(|p| p.length_mm() > std::f64::consts::PI * self.bead_width_mm));
            rest = rest.offset(-s, Join::Miter(3.0));
        }
        rest.polygons
    }

    /// Turns the paths laid in a place into fibre where they are long enough.
    pub fn lay(&self, mut paths: Vec<Toolpath>, place: &FibrePlace<'_>, out: &mut Vec<Toolpath>) -> Tally {
        let mut tally = Tally::default();
        // Lines of `grid` and `triangles` cross by design.
        let crosses_by_design = self.rounds() && any_cross(&paths, place.spacing_mm);
        // The region is grown by 2 um, because paths may lie exactly on its edge.
        let grown = place.region.offset(2e-3, Join::Miter(3.0));
        let clipper = LineClipper::new(&grown);
        let inside = |a: DVec2, b: DVec2| clipper.segment_inside(a, b);
        paths.iter_mut().for_each(|path| path.width = BeadWidth::Constant(self.bead_width_mm));
        if self.turns == FibreTurns::Wide && !place.rings && self.rounds() {
            let pieces = paths.into_iter().flat_map(|path| self.turned(path, &inside, &mut tally)).collect();
            let there = Place {
                region: &grown,
                clipper: &clipper,
                spacing_mm: place.spacing_mm,
                least_mm: self.min_radius_mm,
                onward_mm: place.onward_mm,
                needed_mm: self.min_length_mm,
            };
            paths = joined(pieces, &there);
        }
        let mut pieces = Vec::new();
        for path in paths {
            let length = path.length_mm();
            tally.longest_mm = tally.longest_mm.max(length);
            // Short paths keep their turns, since they are laid without fibre.
            if length < self.min_length_mm || path.points.len() < 2 {
                pieces.push(path);
            } else {
                pieces.extend(self.turned(path, &inside, &mut tally));
            }
        }
        // An arc in a corner can cross the end of a line inside the corner.
        if self.rounds() && !crosses_by_design {
            pieces = uncrossed(pieces, place.spacing_mm, self.min_length_mm);
        }
        if self.cuts() {
            // The new end of a path can show a turn as well.
            pieces = pieces.into_iter().flat_map(|piece| self.without_sharp_ends(piece)).collect();
        }
        for mut piece in pieces {
            let length = piece.length_mm();
            if length < self.min_length_mm || piece.points.len() < 2 {
                tally.short += 1;
                tally.short_mm += length;
            } else {
                piece.role = Role::Fibre;
                self.begin(&mut piece, place);
            }
            out.push(piece);
        }
        tally
    }

    /// Whether sharp turns become arcs.
    fn rounds(&self) -> bool {
        self.turns != FibreTurns::Report && self.min_radius_mm > 0.0
    }

    /// Whether fibre is cut at turns that no arc of the least radius fits.
    fn cuts(&self) -> bool {
        matches!(self.turns, FibreTurns::Cut | FibreTurns::Wide)
    }

    /// Rounds or cuts the sharp turns of a path, as the settings say. The result is one piece or several.
    fn turned(
        &self,
        mut path: Toolpath,
        inside: &dyn Fn(DVec2, DVec2) -> bool,
        tally: &mut Tally,
    ) -> Vec<Toolpath> {
        if path.closed {
            // The path is opened at the middle of its longest straight piece, because no rounded turn
            // reaches that point.
            begin_straight(&mut path);
            let first = path.points[0];
            path.points.push(first);
        }
        let was_closed = std::mem::take(&mut path.closed);
        if self.rounds() {
            // A turn that does not fit the least radius is cut later, so it gets no smaller arc.
            let smallest_mm = if self.cuts() { self.min_radius_mm } else { SMALLEST_MM };
            let (points, n_rounded) = rounded(&path.points, self.min_radius_mm, smallest_mm, inside);
            tally.rounded += n_rounded;
            path.points = points;
        }
        if self.cuts() && !self.sharp_where_cut(&path.points).is_empty() {
            return self.cut_at_sharp_turns(path);
        }
        if was_closed {
            path.points.pop();
            path.closed = true;
        }
        vec![path]
    }

    /// Sharp turns of an open path, as planned or as G-code has it in either direction: coordinates rounded to 0.001 mm tell the
    /// radius of short chords to 2 %, and the direction decides which vertices count as straight. The print order chooses it.
    fn sharp_where_cut(&self, points: &[DVec2]) -> Vec<Turn> {
        let planned = sharp_turns(points, false, self.min_radius_mm);
        if !planned.is_empty() {
            return planned;
        }
        let written = |p: &DVec2| (1e3 * (p + self.plate_from_part_mm)).round() * 1e-3;
        let mut written: Vec<DVec2> = points.iter().map(written).collect();
        let forwards = sharp_turns(&written, false, self.min_radius_mm);
        if !forwards.is_empty() {
            return forwards;
        }
        written.reverse();
        let backwards = sharp_turns(&written, false, self.min_radius_mm);
        let turned = |turn: Turn| Turn { vertex: points.len() - 1 - turn.vertex, ..turn };
        backwards.into_iter().rev().map(turned).collect()
    }

    /// Cuts an open path that is long enough for fibre as [`Self::cut_at_sharp_turns`].
    fn without_sharp_ends(&self, piece: Toolpath) -> Vec<Toolpath> {
        let is_fibre = !piece.closed && piece.length_mm() >= self.min_length_mm;
        if is_fibre { self.cut_at_sharp_turns(piece) } else { vec![piece] }
    }

    /// Cuts an open path until no piece has a sharp turn. The end of a piece can show a turn that was part of a longer one.
    fn cut_at_sharp_turns(&self, path: Toolpath) -> Vec<Toolpath> {
        let sharp = self.sharp_where_cut(&path.points);
        if sharp.is_empty() {
            return vec![path];
        }
        let pieces = cut(&path, &sharp, self.bead_width_mm);
        pieces.into_iter().flat_map(|piece| self.cut_at_sharp_turns(piece)).collect()
    }

    /// Moves the start of a closed path to where the settings say and on by what the place says, and opens the path
    /// there. With the setting `Nearest` the path stays closed.
    fn begin(&self, path: &mut Toolpath, place: &FibrePlace<'_>) {
        if !path.closed || place.keep_closed {
            return;
        }
        let least = |score: &dyn Fn(DVec2) -> f64| {
            let scored = path.points.iter().map(|p| score(*p)).enumerate();
            scored.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |s| s.0)
        };
        match self.start {
            FibreStart::Nearest => return,
            // The start is already the point at which the path was opened above.
            FibreStart::Straight => {}
            FibreStart::Calm => path.rotate_to(least(place.load)),
            FibreStart::Rear => path.rotate_to(least(&|p| -p.y)),
        }
        begin_onward(path, place.onward_mm);
        if self.cuts() {
            // A start within an arc divides one of its chords, and the radius measured beside it is down to half that of the
            // arc.
            let is_sharp = |path: &Toolpath| {
                let opened = [&path.points[..], &path.points[..1]].concat();
                !self.sharp_where_cut(&opened).is_empty()
            };
            for _ in 0..path.points.len() {
                if !is_sharp(path) {
                    break;
                }
                path.rotate_to(1);
            }
        }
        // The path is opened with both ends at its start, so that the print order does not move the start.
        path.points.push(path.points[0]);
        path.closed = false;
    }
}

/// Moves the start of a closed path, which has one width, to the middle of its longest straight piece.
fn begin_straight(path: &mut Toolpath) {
    let length = |i: usize| {
        let (a, b, _) = path.segment(i);
        a.distance_squared(b)
    };
    let longest = (0..path.n_segments()).max_by(|&i, &j| length(i).total_cmp(&length(j)).then(j.cmp(&i)));
    let Some(i) = longest else { return };
    let (a, b, _) = path.segment(i);
    path.points.insert(i + 1, 0.5 * (a + b));
    path.rotate_to(i + 1);
}

/// Moves the beginning of a closed path of one width on along it, by less than its length.
fn begin_onward(path: &mut Toolpath, mut by_mm: f64) {
    if by_mm <= 0.0 {
        return;
    }
    for i in 0..path.n_segments() {
        let (a, b, _) = path.segment(i);
        let piece_mm = a.distance(b);
        if by_mm < piece_mm {
            path.points.insert(i + 1, a.lerp(b, by_mm / piece_mm));
            path.rotate_to(i + 1);
            return;
        }
        by_mm -= piece_mm;
    }
}

/// Cuts a path at its sharp turns. Pieces shorter than a bead's width are left out. Each piece begins half
/// a bead after the previous cut, so that it and the piece before are not taken for one path.
fn cut(path: &Toolpath, sharp: &[Turn], width_mm: f64) -> Vec<Toolpath> {
    let mut pieces = Vec::new();
    let mut from = 0;
    for to in sharp.iter().map(|t| t.vertex).chain([path.points.len() - 1]) {
        let mut piece = Toolpath { points: path.points[from..=to].to_vec(), ..path.clone() };
        piece.closed = false;
        if from > 0 {
            polyline::shorten_start(&mut piece.points, 0.5 * width_mm);
        }
        if to > from && piece.length_mm() > width_mm {
            pieces.push(piece);
        }
        from = to;
    }
    pieces
}

#[cfg(test)]
mod tests;
