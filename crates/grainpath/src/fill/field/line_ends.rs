//! Where lines along a field begin and end: a line ends where it has no room and goes on where it has.
//!
//! The phase ([`phase`](grainpath_core::phase)) decides how many lines pass a place. Where that number changes, a line begins or ends,
//! but not at the place that suits beads. If it begins too late, a gap of up to a bead stays open before its end; if it
//! begins too early, beads lie on each other. Where the field diverges strongly, the phase even joins two lines by a turn
//! across the field. [`fitted`] takes these steps:
//!
//! 1. lines are cut where they deviate from the field by more than [`FARTHEST_RAD`];
//! 2. stretches of lines with less than the least room are removed;
//! 3. lines begin where there is room for one more beside a line;
//! 4. ends that face each other are joined;
//! 5. lines that end inside the region are extended as long as they have the least room, and into the tip beyond.
//!
//! ```text
//!    ------------------------------- bead
//!            ======================= new bead: it begins where there is room for it
//!    ------------------------------- bead
//! ```
//!
//! The room of a line is half of the distance between its neighbours, and the whole distance to a border. Beads of one
//! width need more of it than beads that may be narrowed ([`Room`]). A line that runs into the wedge between another line
//! and a border goes on in the middle of the wedge. The steps are this project's own; only the idea that lines a bead
//! apart end for lack of space is from `Jobard1997`.
//!
//! Lengths are in mm. Cost: linear in the length of all lines; each step of an extension looks at the neighbours in a few
//! cells. Limits: ends are extended one after the other in the order of the lines, so of two ends that want the same space
//! the first takes it. Tips are taken when all ends have their least room, so that no tip keeps a line out.

use std::ops::Range;

use grainpath_core::buckets::PointGrid2;
use grainpath_core::math::cross;
use grainpath_core::poly::LineClipper;
use grainpath_core::polyline::{length_mm, resampled, shorten_start};
use grainpath_core::tuned::Tuned;
use grainpath_core::{Bounds2, DVec2, Region};

use super::refit::{Beside, chains};
use super::widths::{
    CELL_BEADS, FAR_BEADS, Line, Neighbours, OWN_SEGMENTS, STEP_BEADS, Side, smooth, stretches_along, strips,
};

/// A line is cut where it deviates from the field by more than this. Source: measured on a radial disk with beads of one
/// width. With 45 degrees the round turns of lines that go back would stay: the mean deviation is 3.2 degrees instead of
/// 3.0, with the same gaps.
const FARTHEST_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// Length of a step by which an end is extended, in spacings. Source: derived. The end is then misplaced by
/// an eighth of a bead on average.
const STEP: f64 = 0.25;
/// An end is extended by at most this number of steps. Source: chosen; a hundred beads bound the time on a field that
/// leads around for ever.
const MAX_STEPS: usize = 400;
/// The last steps of an extension are no neighbours of its end. Source: derived; four of them are a bead long.
const OWN_STEPS: usize = 4;
/// An extension ends after this number of steps with less than the least room. Source: derived; six steps are one and a half
/// beads, about the length of a tip, and space that is as narrow for longer belongs to the lines beside it.
const TIP_STEPS: usize = 6;
/// Least distance of an extended line from another beside it, in spacings. Source: derived; closer lines would overlap by
/// more than half.
const LEAST_APART: f64 = 0.5;
/// Two ends are joined if the way between them deviates from both lines by less than 45 degrees. Source: derived; a
/// line that is extended turns by less than that in a step.
const FACING_COS: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Rounds of smoothing of a line that was joined. Source: derived; the joint is as long as four points of the line are
/// apart, so that three rounds reach across it.
const JOINT_SMOOTHING: usize = 3;
/// A line ends on a border that it meets at an angle with a larger sine than this; it goes on beside a border that it meets at
/// a smaller one. 0.6 is 37 degrees. Measured: row `fill.field.line_ends.ACROSS_SINE` of `cargo xtask bench constants`.
pub(super) static ACROSS_SINE: Tuned<f64> = Tuned::new("fill.field.line_ends.ACROSS_SINE", 0.6);
/// Ends that were extended before rest where they may go on by less than this, in spacings. Source: derived; half of
/// [`STEP`], so that no line ends in a piece that is far shorter than its bead is wide.
pub(super) const LEAST_EXTENSION: f64 = 0.5 * STEP;
/// No step of an extension is shorter than this, mm. Source: chosen; far below what a printer can show, above rounding.
const ROUNDING_MM: f64 = 1e-6;
/// The border is looked for so far ahead of an end, in spacings. Source: derived. A line that meets the border at
/// [`ACROSS_SINE`] and lies half a spacing from it has 0.83 spacings to go, and one that lies nine tenths from it 1.5.
const LOOK_AHEAD: f64 = 1.5;

/// A region, and the field along which it is filled.
pub(super) struct Place<'a> {
    /// The edge where the strips of the surrounding beads begin.
    pub border: &'a Region,
    /// What lies beside the lines that are fitted.
    pub beside: &'a Beside,
    /// The same edge, searchable.
    pub edge: &'a Neighbours,
    /// Lines that meet the border across end this far from it, mm.
    pub border_mm: f64,
    /// The area in which lines lie. Beads that may be narrowed come nearer to the border beside it.
    pub area: &'a LineClipper,
    /// Unit vector along the field at a point; its sign has no meaning.
    pub axis: &'a dyn Fn(DVec2) -> DVec2,
    /// Cosine of the angle between the axis at a point and a unit vector; where it is large it may be the least one around.
    pub cosine: &'a dyn Fn(DVec2, DVec2) -> f64,
    /// Distance between lines, mm.
    pub spacing_mm: f64,
    /// Shorter lines are dropped, mm.
    pub shortest_mm: f64,
    /// Ends that are farther apart are not joined, mm.
    pub longest_joint_mm: f64,
}

/// How much room a line needs.
#[derive(Clone, Copy)]
pub(super) struct Room {
    /// Least room, in spacings.
    pub least: f64,
    /// Room down to which the last bit of an extension may go, in spacings: into the tip that narrows before two others.
    pub tip: f64,
    /// Room from which one more line begins, in spacings.
    pub begins: f64,
    /// Whether extensions keep to the middle of their room. Otherwise they keep to the field.
    pub middle: bool,
    /// An end that may go on by less than this before a border rests where it is, in spacings.
    pub rests: f64,
}

/// The stretches of lines that lie along the guide, extended where they have room.
pub(super) fn extended_along_guide(lines: Vec<Line>, place: &Place<'_>, room: Room) -> Vec<Line> {
    let mut lines = along_guide(lines, place);
    let neighbours = place.neighbours(&lines);
    extend(&mut lines, &neighbours, place, room);
    lines
}

/// The stretches of lines that lie along the guide.
fn along_guide(lines: Vec<Line>, place: &Place<'_>) -> Vec<Line> {
    let along = |line| stretches_along(line, place.cosine, FARTHEST_RAD, place.shortest_mm);
    lines.into_iter().flat_map(along).collect()
}

/// Lets lines begin and end where there is room for them.
pub(super) fn fitted(lines: Vec<Line>, place: &Place<'_>, room: Room) -> Vec<Line> {
    let lines = along_guide(lines, place);
    // Searches are built anew only where lines have changed, since that costs as much as the steps themselves.
    let mut neighbours = place.neighbours(&lines);
    let (mut lines, rooms) = without_crowded(lines, &mut neighbours, place, room);
    let more = begun(&lines, &rooms, &neighbours, place, room);
    // Lines are joined where none lies between them. The few that begin are looked up by themselves: all lines are indexed anew
    // only once, for the ends that are extended.
    let of_more = Neighbours::new(&more, &Region::default(), CELL_BEADS * place.spacing_mm);
    let n_before = lines.len();
    lines.extend(more);
    let n = lines.len();
    let mut lines = facing_joined(lines, [&neighbours, &of_more], place);
    if [n_before, lines.len()] != [n; 2] {
        neighbours = place.neighbours(&lines);
    }
    extend(&mut lines, &neighbours, place, room);
    lines
}

impl<'a> Place<'a> {
    /// The same place with these lines beside those that are fitted.
    pub(super) fn beside<'b>(&self, beside: &'b Beside) -> Place<'b>
    where
        'a: 'b,
    {
        Place { beside, ..*self }
    }

    fn neighbours(&self, lines: &[Line]) -> Neighbours {
        Neighbours::beside(lines, &self.beside.lines, self.border, CELL_BEADS * self.spacing_mm)
    }

    /// If a line that goes on from `at` along a unit vector meets the border soon and across: how much longer it may
    /// become before its end is [`Place::border_mm`] from the border, mm. Negative if it is nearer already.
    fn free_ahead_mm(&self, at: DVec2, along: DVec2) -> Option<f64> {
        let hit = self.edge.hit(at, along, LOOK_AHEAD * self.spacing_mm, |_, _| false)?;
        let sine = cross(along, hit.along).abs();
        (sine > ACROSS_SINE.value()).then(|| hit.distance_mm - self.border_mm / sine)
    }
}

/// The room of a line at one of its points.
#[derive(Clone, Copy)]
struct RoomAt {
    mm: f64,
    /// Whether another line or the border leaves no room for one more line on the left and on the right.
    full: [bool; 2],
}

/// Keeps the stretches of lines that have the least room, each with its room at its points. `neighbours` holds the lines, and
/// afterwards what is kept of them.
fn without_crowded(
    mut lines: Vec<Line>,
    neighbours: &mut Neighbours,
    place: &Place<'_>,
    room: Room,
) -> (Vec<Line>, Vec<Vec<RoomAt>>) {
    let spacing_mm = place.spacing_mm;
    let sides = neighbours.sides(&lines, FAR_BEADS.value() * spacing_mm);
    let widths: Vec<Vec<f64>> =
        lines.iter().zip(&sides).map(|(line, sides)| strips(sides, line.closed, spacing_mm)).collect();
    let is_crowded = |mm: &f64| *mm < room.least * spacing_mm;
    // The line that each stretch is a part of, its points, and whether it is the whole line.
    let mut stretches: Vec<(usize, Range<usize>, bool)> = Vec::with_capacity(lines.len());
    // All crowded stretches are removed at once, even if two of them lie side by side. The ends that remain
    // are then extended into the free space.
    for (l, (line, widths)) in lines.iter().zip(&widths).enumerate() {
        // A line that is crowded somewhere is cut there, all others stay whole.
        if !widths.iter().any(is_crowded) {
            stretches.push((l, 0..line.points.len(), true));
            continue;
        }
        let mut from = 0;
        for stretch in widths.split_inclusive(is_crowded) {
            // The last point of a stretch is crowded, except at the end of the line.
            let n = stretch.len() - usize::from(stretch.last().is_some_and(is_crowded));
            if length_mm(&line.points[from..from + n], false) > place.shortest_mm {
                stretches.push((l, from..from + n, false));
            }
            from += stretch.len();
        }
    }
    let segments = |(l, points, whole): &(usize, Range<usize>, bool)| {
        (*l, points.start..if *whole { lines[*l].n_segments() } else { points.end - 1 })
    };
    // What is removed leaves the index in place, which is faster than building it anew.
    neighbours.keep(lines.len(), &stretches.iter().map(segments).collect::<Vec<_>>());
    let is_full = |side: &Side| match *side {
        // A line whose near part is gone leaves its room to others.
        Side::Line { distance_mm, piece } => {
            !neighbours.is_gone(piece) && !has_room_beside(distance_mm, true, place, room)
        }
        Side::Border(mm) | Side::Ahead(mm) => !has_room_beside(mm, false, place, room),
        Side::Open => false,
    };
    let kept = |(l, points, whole): (usize, Range<usize>, bool)| {
        let at = |(mm, sides): (&f64, &[Side; 2])| RoomAt {
            mm: *mm,
            full: [is_full(&sides[0]), is_full(&sides[1])],
        };
        let rooms = widths[l][points.clone()].iter().zip(&sides[l][points.clone()]).map(at).collect();
        let line = &mut lines[l];
        let points = if whole { std::mem::take(&mut line.points) } else { line.points[points].to_vec() };
        (Line { points, closed: whole && line.closed }, rooms)
    };
    stretches.into_iter().map(kept).unzip()
}

/// The share of the distance to a line or to the border at which one more line would lie. Beside a border the new line takes
/// two thirds, and the line that was there one.
fn share_beside(is_line: bool) -> f64 {
    if is_line { 0.5 } else { 2.0 / 3.0 }
}

/// Whether one more line has room before another line or the border.
fn has_room_beside(distance_mm: f64, is_line: bool, place: &Place<'_>, room: Room) -> bool {
    share_beside(is_line) * distance_mm >= room.begins * place.spacing_mm
}

/// Lines where there is room for one more, in the middle between two lines or at a third of the distance from the border.
///
/// `rooms` holds the room of the lines at their points.
fn begun(
    lines: &[Line],
    rooms: &[Vec<RoomAt>],
    neighbours: &Neighbours,
    place: &Place<'_>,
    room: Room,
) -> Vec<Line> {
    let spacing_mm = place.spacing_mm;
    let Some(bounds) = bounds_of(lines) else { return Vec::new() };
    let mut begun = PointGrid2::new(bounds, spacing_mm);
    let mut out = Vec::new();
    for (l, (line, rooms)) in lines.iter().zip(rooms).enumerate() {
        for (k, side) in [1.0, -1.0].into_iter().enumerate() {
            let place_at = |v: usize| {
                // A line that gets a new one beside it has that much room on one side alone.
                if rooms[v].full[k] || rooms[v].mm < room.begins * spacing_mm {
                    return None;
                }
                let along = line.tangent(v);
                let way = side * along.perp();
                let own = |other: usize, s: usize| other == l && s.abs_diff(v) <= OWN_SEGMENTS;
                let far_mm = 2.0 * FAR_BEADS.value() * spacing_mm;
                let hit = neighbours.hit(line.points[v], way, far_mm, own)?;
                // A border ahead is no border to run beside.
                let beside = hit.line.is_some() || cross(along, hit.along).abs() <= ACROSS_SINE.value();
                let roomy = has_room_beside(hit.distance_mm, hit.line.is_some(), place, room);
                let share = share_beside(hit.line.is_some());
                (beside && roomy).then(|| line.points[v] + share * hit.distance_mm * way)
            };
            let places: Vec<Option<DVec2>> = (0..line.points.len()).map(place_at).collect();
            for run in places.split(Option::is_none) {
                let points: Vec<DVec2> = run.iter().flatten().copied().collect();
                let apart_mm = room.least * spacing_mm;
                if points.len() > 1
                    && length_mm(&points, false) > place.shortest_mm
                    && points.iter().all(|&p| begun.within(p, apart_mm).next().is_none())
                {
                    points.iter().for_each(|&p| begun.insert(p, ()));
                    out.push(Line { points, closed: false });
                }
            }
        }
    }
    out
}

/// Joins ends inside the region that face each other, the nearest first. The neighbours together hold all lines.
fn facing_joined(lines: Vec<Line>, neighbours: [&Neighbours; 2], place: &Place<'_>) -> Vec<Line> {
    let Some(bounds) = bounds_of(&lines) else { return lines };
    let within_border = LineClipper::new(place.border);
    // End `2 l` is the first point of line `l`, end `2 l + 1` its last. Each has the direction in which its line would go on.
    let end = |e: usize| {
        let points = &lines[e / 2].points;
        let n = points.len();
        let (at, before) =
            if e.is_multiple_of(2) { (points[0], points[1]) } else { (points[n - 1], points[n - 2]) };
        (at, (at - before).normalize_or_zero())
    };
    let mut grid = PointGrid2::new(bounds, place.longest_joint_mm);
    let is_open = |e: &usize| {
        let line = &lines[e / 2];
        !line.closed && line.points.len() > 1 && !place.beside.cuts.contains(end(*e).0)
    };
    let open: Vec<usize> = (0..2 * lines.len()).filter(is_open).collect();
    open.iter().for_each(|&e| grid.insert(end(e).0, e));
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for &e in &open {
        let (p, onward) = end(e);
        for (q, f) in grid.within(p, place.longest_joint_mm).filter(|(_, f)| *f > e && f / 2 != e / 2) {
            let way = (q - p).normalize_or(onward);
            if onward.dot(way).min(-end(f).1.dot(way)) >= FACING_COS {
                pairs.push((p.distance(q), e, f));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| (a.1, a.2).cmp(&(b.1, b.2))));
    let mut joined_to = vec![None; 2 * lines.len()];
    for (_, e, f) in pairs {
        let (p, q) = (end(e).0, end(f).0);
        let free = joined_to[e].is_none() && joined_to[f].is_none();
        let is_between = |n: &&Neighbours| n.between(p, q, [p, q]);
        if free && !neighbours.iter().any(is_between) && within_border.segment_inside(p, q) {
            (joined_to[e], joined_to[f]) = (Some(f), Some(e));
        }
    }
    chained(&lines, &joined_to, STEP_BEADS.value() * place.spacing_mm)
}

/// Puts lines together whose ends are joined. A line is entered at one end and left at the other.
fn chained(lines: &[Line], joined_to: &[Option<usize>], step_mm: f64) -> Vec<Line> {
    let joined = |chain: Vec<(usize, bool)>| {
        if let [(l, false)] = chain[..] {
            return lines[l].clone();
        }
        let mut points: Vec<DVec2> = Vec::new();
        for (l, reversed) in chain {
            let line = &lines[l].points;
            if reversed { points.extend(line.iter().rev()) } else { points.extend(line) }
        }
        let mut points = resampled(&points, false, step_mm);
        smooth(&mut points, false, JOINT_SMOOTHING);
        Line { points, closed: false }
    };
    chains(lines.len(), joined_to).into_iter().map(joined).collect()
}

fn bounds_of(lines: &[Line]) -> Option<Bounds2> {
    Bounds2::around_points(lines.iter().flat_map(|l| l.points.iter().copied()))
}

/// Shortens lines that meet the border across, so that they end [`Place::border_mm`] from it. Lines that run beside it
/// stay as they are.
pub(super) fn trimmed(lines: Vec<Line>, place: &Place<'_>) -> Vec<Line> {
    let mut out = Vec::with_capacity(lines.len());
    for mut line in lines {
        for _ in 0..2 {
            if let [end, before, ..] = line.points[..]
                && !line.closed
                && !place.beside.cuts.contains(end)
                && let Some(free_mm) = place.free_ahead_mm(end, (end - before).normalize_or_zero())
                && free_mm < 0.0
            {
                shorten_start(&mut line.points, -free_mm);
            }
            line.points.reverse();
        }
        if line.closed || length_mm(&line.points, false) > place.shortest_mm {
            out.push(line);
        }
    }
    out
}

/// Extends the ends of lines as long as they have the least room and stay inside the region. `neighbours` holds the lines
/// and the border.
fn extend(lines: &mut [Line], neighbours: &Neighbours, place: &Place<'_>, room: Room) {
    let Some(bounds) = bounds_of(lines) else { return };
    // Ends of lines and the points added to them, which `neighbours` does not contain: for each point its
    // line, and whether it is an original end.
    let mut added = PointGrid2::new(bounds, place.spacing_mm);
    for (l, line) in lines.iter().chain(&place.beside.lines).enumerate().filter(|l| !l.1.closed) {
        let ends = line.points.first().into_iter().chain(line.points.last());
        ends.for_each(|&p| added.insert(p, (l, true)));
    }
    let open: Vec<usize> =
        (0..lines.len()).filter(|&l| !lines[l].closed && lines[l].points.len() > 1).collect();
    // The points added to both ends of each line, and whether the end may still go on.
    let goes_on = |end: DVec2| (Vec::new(), !place.beside.cuts.contains(end));
    let mut extensions: Vec<[(Vec<DVec2>, bool); 2]> = open
        .iter()
        .map(|&l| [lines[l].points[0], lines[l].points[lines[l].points.len() - 1]].map(goes_on))
        .collect();
    // Ends are extended one by one in the order of the lines, so the result does not depend on threads. All go as far as
    // there is the least room before the first goes into a tip: where many lines meet, tips would keep others out.
    for tip in [room.least, room.tip] {
        for (&l, extensions) in open.iter().zip(&mut extensions) {
            for (at_start, (extension, goes_on)) in [true, false].into_iter().zip(extensions) {
                let n = extension.len();
                let end = End { lines, line: l, at_start, neighbours, place, room: Room { tip, ..room } };
                *goes_on = *goes_on && end.extend(extension, &added);
                extension[n..].iter().for_each(|&p| added.insert(p, (l, false)));
            }
        }
    }
    for (l, [at_start, at_end]) in open.into_iter().zip(extensions) {
        lines[l].points.splice(0..0, at_start.0.into_iter().rev());
        lines[l].points.extend(at_end.0);
    }
}

/// One end of an open line.
struct End<'a> {
    lines: &'a [Line],
    line: usize,
    at_start: bool,
    neighbours: &'a Neighbours,
    place: &'a Place<'a>,
    room: Room,
}

impl End<'_> {
    /// Adds points to an extension of the end. True if only lack of room ended it, so that it may go on into a tip.
    fn extend(&self, out: &mut Vec<DVec2>, added: &PointGrid2<(usize, bool)>) -> bool {
        let points = &self.lines[self.line].points;
        let n = points.len();
        let (end, inside) =
            if self.at_start { (points[0], points[1]) } else { (points[n - 1], points[n - 2]) };
        let (mut at, before) = match out[..] {
            [] => (end, inside),
            [at] => (at, end),
            [.., before, at] => (at, before),
        };
        let mut heading = (at - before).normalize_or(DVec2::X);
        let spacing_mm = self.place.spacing_mm;
        let step = STEP * spacing_mm;
        let mut n_narrow = 0;
        for _ in 0..MAX_STEPS {
            let axis = (self.place.axis)(at);
            let along = if axis.dot(heading) < 0.0 { -axis } else { axis };
            let ahead_mm = self.place.free_ahead_mm(at, along);
            let rests_mm = if out.is_empty() { self.room.rests * spacing_mm } else { 0.0 };
            if ahead_mm.is_some_and(|mm| mm <= rests_mm.max(ROUNDING_MM)) {
                return false;
            }
            let mut next = at + ahead_mm.map_or(step, |mm| mm.min(step)) * along;
            if self.room.middle && ahead_mm.is_none() {
                let [left_mm, right_mm] = self.sides(next, along);
                // A turn by 27 degrees in a step at most, as little as an extension along the field makes.
                let most = 0.5 * step;
                next += (0.5 * (left_mm - right_mm)).clamp(-most, most) * along.perp();
            }
            // Around a singular point the field turns faster than a bead can follow.
            let turns = along.dot(heading) < std::f64::consts::FRAC_1_SQRT_2;
            if turns
                || self.meets_line(at, along, step)
                || self.crowds(next, added)
                || self.returns(next, out)
            {
                return false;
            }
            if let Some(border) = self.place.area.crossings(at, next).first() {
                out.push(at.lerp(next, border.t));
                return false;
            }
            let [left_mm, right_mm] = self.sides(next, along);
            // Where extensions do not keep to the middle, one side may have all the room and the other none.
            if !self.room.middle && left_mm.min(right_mm) < 0.5 * LEAST_APART * spacing_mm {
                return false;
            }
            let room = (left_mm + right_mm) / spacing_mm;
            n_narrow = if room < self.room.least { n_narrow + 1 } else { 0 };
            if !self.place.area.contains(next) {
                return false;
            }
            if room < self.room.tip || n_narrow > TIP_STEPS {
                return self.room.tip >= self.room.least;
            }
            out.push(next);
            (at, heading) = (next, along);
        }
        false
    }

    /// Whether another line lies across the way directly ahead.
    fn meets_line(&self, at: DVec2, along: DVec2, step_mm: f64) -> bool {
        let reach_mm = step_mm + 0.5 * self.place.spacing_mm;
        self.neighbours
            .hit(at, along, reach_mm, |l, s| self.is_own(l, s))
            .is_some_and(|hit| hit.line.is_some())
    }

    /// Whether a point is too near to the end of another line, or to an extension of one.
    fn crowds(&self, p: DVec2, added: &PointGrid2<(usize, bool)>) -> bool {
        let spacing_mm = self.place.spacing_mm;
        added.within(p, LEAST_APART * spacing_mm).any(|(q, (line, is_end))| {
            // Two lines whose ends face each other may come as near as a step.
            line != self.line && (!is_end || q.distance(p) < STEP * spacing_mm)
        })
    }

    /// Whether a point is too near to an earlier part of the same extension.
    fn returns(&self, p: DVec2, extension: &[DVec2]) -> bool {
        let apart_mm = self.room.least * self.place.spacing_mm;
        let earlier = extension.len().saturating_sub(OWN_STEPS);
        extension[..earlier].iter().any(|q| q.distance_squared(p) < apart_mm * apart_mm)
    }

    /// The space to the left and to the right of a point, mm: half of the distance to a line, or the whole distance to
    /// the border, or half a spacing where nothing is near.
    fn sides(&self, p: DVec2, along: DVec2) -> [f64; 2] {
        let spacing_mm = self.place.spacing_mm;
        [along.perp(), -along.perp()].map(|way| {
            let hit = self.neighbours.hit(p, way, FAR_BEADS.value() * spacing_mm, |l, s| self.is_own(l, s));
            hit.map_or(0.5 * spacing_mm, |hit| {
                if hit.line.is_some() { 0.5 * hit.distance_mm } else { hit.distance_mm }
            })
        })
    }

    /// Whether a segment is one of the last [`OWN_SEGMENTS`] before this end.
    fn is_own(&self, line: usize, segment: usize) -> bool {
        line == self.line
            && if self.at_start {
                segment < OWN_SEGMENTS
            } else {
                segment + OWN_SEGMENTS >= self.lines[line].n_segments()
            }
    }
}
