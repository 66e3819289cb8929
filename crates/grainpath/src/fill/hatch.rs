//! Cuts parallel lines by a polygon, and joins their ends along pieces of the border.
//!
//! Lines are rows at equal distances in a turned frame. Each edge of the polygon is cut by the rows that it
//! spans. The cuts of a row are sorted along it, and each pair of them holds the ends of a piece. Every end
//! is linked to its neighbours along the border. So a zigzag follows a piece to its end, then the border to
//! the next free end if that is near enough ([`Joints`]), and then the next piece back.
//!
//! ```text
//!    +--------+         A joint may not be longer than stated, nor bulge towards the
//!    |========|         next row by more than half a bead where it returns to its own row.
//!    |        |)  joint
//!    |========|
//! ```
//!
//! Where a joint turns at an acute corner, a notch stays open between its round corner, the next row and the border. The
//! corner goes a little past the end of its row, so that the bead's round side fills the notch:
//!
//! ```text
//!    ---------------------  border
//!     .  notch  *------.     the row that ends at * bends into the notch
//!      \         \      \
//! ```
//!
//! Where the border meets the rows at a small angle, a wedge stays open beside it between each two ends that no joint links;
//! [`Hatch::wedges`] finds these from the distance of the border to the next row inwards.
//!
//! Exact comparisons decide which row an edge spans, so that a row through a vertex is cut once.
//! Cost: linear in edges and ends, but for sorting the ends of each row.

use grainpath_core::math::{direction, rotated};
use grainpath_core::polyline::{length_mm, resampled};
use grainpath_core::{DVec2, Polygon};

/// Wedges are looked for beside borders that meet the rows at an angle with at most this sine. Source: derived. 0.6 is 37
/// degrees; at larger angles the wedge is shorter than a bead is wide.
const FLAT_SINE: f64 = 0.6;
/// Distance of the points along a wedge, in strips. Source: derived; its tip is then found an eighth of a strip too late on
/// average.
const WEDGE_STEP: f64 = 0.25;
/// The bead of a wedge ends this far before the end of the line that closes the wedge, in strips. Source: derived; round
/// ends of two beads then touch in the middle of the way.
const BEFORE_END: f64 = 0.5;
/// The bead of a wedge goes on, as narrow as beads may be, until the wedge has this share of that width. Source: derived;
/// there the bead lays as much twice as it closes.
const TIP_SHARE: f64 = 0.5;
/// A wedge gets a bead from this length on, where it is as wide as the narrowest bead, in strips. Source: chosen; the flow of
/// a bead that is shorter than wide has hardly begun. On a round hub of a scan half a strip would add 760 beads to 6640 paths.
const LEAST_WEDGE: f64 = 1.0;

/// A row that reaches into a notch bends one row before its end, or at this share of a shorter piece. Source: derived; both
/// ends of a piece may bend.
const BEND_SHARE: f64 = 0.4;

/// Lines at equal distances: line `i` lies at `first + i * step` along the normal of their direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lines {
    pub angle_rad: f64,
    pub first_mm: f64,
    pub step_mm: f64,
}

/// Rows that replace each line: they lie side by side, with the middle of the group on the line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Group {
    /// Number of rows in a group; 1 means the line alone.
    pub rows: usize,
    /// Distance between neighbouring rows, mm.
    pub apart_mm: f64,
}

impl Group {
    /// Number of the first row at `y` or above; rows are counted through all groups.
    fn first_row_from(&self, y: f64, lines: &Lines) -> f64 {
        let n = self.rows as f64;
        if self.rows == 1 {
            return ((y - lines.first_mm) / lines.step_mm).ceil();
        }
        // Height above the lowest row of line 0's group.
        let above = y - lines.first_mm + 0.5 * (n - 1.0) * self.apart_mm;
        let group = (above / lines.step_mm).floor();
        let within = ((above - group * lines.step_mm) / self.apart_mm).ceil();
        group * n + within.clamp(0.0, n)
    }

    fn y_mm(&self, row: f64, lines: &Lines) -> f64 {
        let n = self.rows as f64;
        if self.rows == 1 {
            return lines.first_mm + row * lines.step_mm;
        }
        let group = (row / n).floor();
        let within = row - group * n - 0.5 * (n - 1.0);
        lines.first_mm + group * lines.step_mm + within * self.apart_mm
    }
}

/// A point where a line meets the border.
#[derive(Debug, Clone, Copy)]
struct End {
    line: i32,
    x: f64,
    contour: u32,
    /// Place along the contour: the number of the edge plus the share of the edge before the end.
    at: f64,
    /// The neighbouring ends along the contour, backwards and forwards.
    along: [u32; 2],
}

/// All pieces of lines inside a polygon.
pub(super) struct Hatch {
    axis: DVec2,
    lines: Lines,
    group: Group,
    contours: Vec<Vec<DVec2>>,
    /// The ends of piece k: 2k on the left, 2k + 1 on the right. Pieces are sorted by line, then by x.
    ends: Vec<End>,
}

/// A wedge between a line and the border: a line along its middle, and its width at the points of that line, mm.
#[derive(Default)]
pub(super) struct Wedge {
    pub points: Vec<DVec2>,
    pub widths_mm: Vec<f64>,
}

/// Which joints between lines are allowed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Joints {
    /// Longest piece of border that a joint may follow, mm.
    pub longest_mm: f64,
    /// A joint that returns to its own row may bulge this far towards the next row, mm.
    pub bulge_mm: f64,
    /// An acute corner of a joint reaches this far times the cosine of its angle into the notch beside it, mm; 0 where
    /// corners stay at the ends of their rows.
    pub past_mm: f64,
}

/// Whether an edge runs nearly along the rows.
fn is_flat(way: DVec2) -> bool {
    way.y.abs() <= FLAT_SINE * way.length()
}

impl Hatch {
    /// Cuts the lines by the polygon. Cost: linear in edges and ends, except for a sort.
    pub(super) fn new(polygon: &Polygon, lines: Lines) -> Self {
        Self::in_groups(polygon, lines, &Group { rows: 1, apart_mm: lines.step_mm })
    }

    /// Cuts the rows of groups by the polygon. A group is narrower than the step of the lines.
    pub(super) fn in_groups(polygon: &Polygon, lines: Lines, group: &Group) -> Self {
        let axis = direction(lines.angle_rad);
        let back = DVec2::new(axis.x, -axis.y);
        let contours: Vec<Vec<DVec2>> =
            polygon.contours().map(|c| c.iter().map(|&p| rotated(p, back)).collect()).collect();
        let mut ends = Vec::new();
        for (c, contour) in contours.iter().enumerate() {
            for (e, (a, b)) in grainpath_core::poly::edges(contour).enumerate() {
                // The interval is half-open: a vertex on a row belongs to the edge that leaves it upwards.
                let [low, high] = [a.y.min(b.y), a.y.max(b.y)].map(|y| group.first_row_from(y, &lines));
                let mut line = low;
                while line < high {
                    let y = group.y_mm(line, &lines);
                    // Rounding may put the share a little outside of the edge; the clamp keeps the
                    // end on the border.
                    let t = ((y - a.y) / (b.y - a.y)).clamp(0.0, 1.0);
                    let x = a.x + t * (b.x - a.x);
                    ends.push(End {
                        line: line as i32,
                        x,
                        contour: c as u32,
                        at: e as f64 + t,
                        along: [0; 2],
                    });
                    line += 1.0;
                }
            }
        }
        // After sorting, each two ends of a row from left to right form a piece. Ties are broken by contour
        // and place, so that the order is the same on every platform.
        ends.sort_by(|a, b| {
            let by_line = a.line.cmp(&b.line).then(a.x.total_cmp(&b.x));
            by_line.then(a.contour.cmp(&b.contour)).then(a.at.total_cmp(&b.at))
        });
        let mut hatch = Self { axis, lines, group: *group, contours, ends };
        hatch.link();
        hatch
    }

    /// Finds for each end its neighbours along the contour.
    fn link(&mut self) {
        let mut order: Vec<u32> = (0..self.ends.len() as u32).collect();
        order.sort_by(|&i, &j| {
            let (a, b) = (&self.ends[i as usize], &self.ends[j as usize]);
            a.contour.cmp(&b.contour).then(a.at.total_cmp(&b.at)).then(i.cmp(&j))
        });
        let mut start = 0;
        while start < order.len() {
            let contour = self.ends[order[start] as usize].contour;
            let n = order[start..].partition_point(|&i| self.ends[i as usize].contour == contour);
            for k in 0..n {
                self.ends[order[start + k] as usize].along =
                    [order[start + (k + n - 1) % n], order[start + (k + 1) % n]];
            }
            start += n;
        }
    }

    /// Number of straight pieces.
    fn n_pieces(&self) -> usize {
        self.ends.len() / 2
    }

    fn place(&self, end: &End) -> DVec2 {
        DVec2::new(end.x, self.group.y_mm(f64::from(end.line), &self.lines))
    }

    /// Paths that run along the lines back and forth, joined along the border where `joints` allow.
    pub(super) fn paths(&self, joints: &Joints) -> Vec<Vec<DVec2>> {
        self.joined_paths(joints).0
    }

    /// As [`Self::paths`], and for each end the one to which a joint leads from it.
    pub(super) fn joined_paths(&self, joints: &Joints) -> (Vec<Vec<DVec2>>, Vec<Option<u32>>) {
        let mut joined = vec![None; self.ends.len()];
        let mut used = vec![false; self.n_pieces()];
        let mut out = Vec::new();
        for first in 0..self.n_pieces() {
            if used[first] {
                continue;
            }
            let mut path = Vec::new();
            // The first piece is followed to the right. After a joint the path enters the next piece at the
            // end that the joint reached.
            let mut enter = 2 * first;
            let mut arrived = None;
            loop {
                used[enter / 2] = true;
                // Ends of a piece are numbered 2k and 2k + 1, so the other end is the one with the
                // last bit flipped.
                let leave = enter ^ 1;
                // The joint that led here came along the border from the side to which it leads back.
                path.extend(self.corner(enter, arrived, joints));
                let next = self.onward(leave, &used, joints);
                let towards = next.as_ref().map(|(_, forwards, _)| *forwards);
                path.extend(self.corner(leave, towards, joints).into_iter().rev());
                let Some((next, forwards, between)) = next else { break };
                path.extend(between);
                (joined[leave], joined[next]) = (Some(next as u32), Some(leave as u32));
                (enter, arrived) = (next, Some(!forwards));
            }
            // A joint of no length, where two rows meet in a corner, would repeat a point.
            path.dedup_by(|a, b| a.distance_squared(*b) < 1e-12);
            if path.len() > 1 {
                out.push(path.into_iter().map(|p| rotated(p, self.axis)).collect());
            }
        }
        (out, joined)
    }

    /// The wedges that lines with strips of `strip_mm` leave open beside the border, whose walls begin `border_mm` beyond
    /// it, for beads with strips of at least `least_mm`. `joined` holds the end to which a joint leads from each end.
    pub(super) fn wedges(
        &self,
        joined: &[Option<u32>],
        strip_mm: f64,
        border_mm: f64,
        least_mm: f64,
    ) -> Vec<Wedge> {
        let mut out = Vec::new();
        for (from, end) in self.ends.iter().enumerate() {
            let to = end.along[1];
            if joined[from] != Some(to) {
                let to = &self.ends[to as usize];
                self.wedges_between(end, to, [strip_mm, border_mm, least_mm], &mut out);
            }
        }
        out
    }

    /// The wedges beside the border from one end to the next one along it. All of that border lies between two rows.
    fn wedges_between(
        &self,
        from: &End,
        to: &End,
        [strip_mm, border_mm, least_mm]: [f64; 3],
        out: &mut Vec<Wedge>,
    ) {
        let mut border = vec![self.place(from)];
        border.extend(self.between(from, to, true));
        border.push(self.place(to));
        if border.windows(2).all(|w| !is_flat(w[1] - w[0])) {
            return;
        }
        let mut wedge = Wedge::default();
        for pair in resampled(&border, false, WEDGE_STEP * strip_mm).windows(2) {
            let at = 0.5 * (pair[0] + pair[1]);
            match self.across(at, pair[1] - pair[0], [from, to], strip_mm, border_mm) {
                Some((middle, width_mm)) if width_mm >= TIP_SHARE * least_mm => {
                    wedge.points.push(middle);
                    wedge.widths_mm.push(width_mm.clamp(least_mm, strip_mm.max(least_mm)));
                }
                _ => self.finish(&mut wedge, [strip_mm, least_mm], out),
            }
        }
        self.finish(&mut wedge, [strip_mm, least_mm], out);
    }

    /// The space between the walls beside a place of the border and the next line inwards: its middle and its width, mm.
    /// `None` where the border does not run along the rows, where no line lies inwards, and near the ends of lines that
    /// close the space.
    fn across(
        &self,
        p: DVec2,
        way: DVec2,
        ends: [&End; 2],
        strip_mm: f64,
        border_mm: f64,
    ) -> Option<(DVec2, f64)> {
        if !is_flat(way) {
            return None;
        }
        // The region lies on the left of its contours.
        let inwards = way.try_normalize()?.perp();
        let up = inwards.y.signum();
        let rows = (p.y - self.lines.first_mm) / self.lines.step_mm;
        let row = if up > 0.0 { rows.ceil() } else { rows.floor() } as i32;
        let first = self.ends.partition_point(|e| e.line < row);
        let n = self.ends[first..].partition_point(|e| e.line == row);
        // Ends of a row are sorted along it, and a line begins with every second one.
        let is_below = self.ends[first..first + n].partition_point(|e| e.x < p.x) % 2 == 1;
        let is_closed = |e: &&End| e.line != row && self.place(e).distance(p) < BEFORE_END * strip_mm;
        if !is_below || ends.iter().any(is_closed) {
            return None;
        }
        let y_mm = self.group.y_mm(f64::from(row), &self.lines);
        // From the edge of the strips of the walls to that of the line.
        let (low, high) = (p - border_mm * inwards, DVec2::new(p.x, y_mm - 0.5 * up * strip_mm));
        let across = high - low;
        // Sides at an angle a are cos(a / 2) of that way apart, measured at a right angle to the middle between them.
        let half_angle_cos = (0.5 * (1.0 + inwards.y.abs())).sqrt();
        (across.dot(inwards) > 0.0).then(|| (0.5 * (low + high), across.length() * half_angle_cos))
    }

    /// Adds a wedge that is long enough for a bead, and begins another one.
    fn finish(&self, wedge: &mut Wedge, [strip_mm, least_mm]: [f64; 2], out: &mut Vec<Wedge>) {
        let mut wedge = std::mem::take(wedge);
        let all = wedge.points.iter().zip(&wedge.widths_mm);
        let wide: Vec<DVec2> = all.filter(|(_, mm)| **mm > least_mm).map(|(p, _)| *p).collect();
        if length_mm(&wide, false) > LEAST_WEDGE * strip_mm {
            wedge.points.iter_mut().for_each(|p| *p = rotated(*p, self.axis));
            out.push(wedge);
        }
    }

    /// The path at an end of a piece, from the border inwards, where a joint leads along the border in the stated direction
    /// or none does. At an acute corner it reaches beyond the end, into the notch between two rows and the border.
    fn corner(&self, of: usize, forwards: Option<bool>, joints: &Joints) -> Vec<DVec2> {
        let (end, other) = (&self.ends[of], &self.ends[of ^ 1]);
        let place = self.place(end);
        let past = || {
            let contour = &self.contours[end.contour as usize];
            // An end on the contour's last vertex belongs to the last edge.
            let edge = (end.at as usize).min(contour.len() - 1);
            let (a, b) = (contour[edge], contour[(edge + 1) % contour.len()]);
            let (behind, ahead) = if forwards? { (a, b) } else { (b, a) };
            let way = (ahead - behind).try_normalize()?;
            let inwards = DVec2::new((other.x - end.x).signum(), 0.0);
            // Beyond the end of its edge the border turns away.
            let past_mm = (joints.past_mm * way.dot(inwards)).min(place.distance(behind));
            let bend_mm = self.lines.step_mm.min(BEND_SHARE * (other.x - end.x).abs());
            (past_mm > 0.0).then(|| vec![place - past_mm * way, place + bend_mm * inwards])
        };
        past().unwrap_or_else(|| vec![place])
    }

    /// Finds the next unused end along the border from the end of a piece, whether it lies forwards, and the border's
    /// points between both.
    fn onward(&self, leave: usize, used: &[bool], joints: &Joints) -> Option<(usize, bool, Vec<DVec2>)> {
        let end = &self.ends[leave];
        let candidates = [1usize, 0].map(|forwards| {
            let next = end.along[forwards] as usize;
            // A neighbour two rows away means that the border skips a row, and the joint would cross the
            // bead of that row.
            if next == leave || used[next / 2] {
                return None;
            }
            let other = &self.ends[next];
            if (other.line - end.line).abs() > 1 {
                return None;
            }
            let between = self.between(end, other, forwards == 1);
            let mut length = 0.0;
            let (mut from, mut bulge) = (self.place(end), 0.0f64);
            for &p in between.iter().chain(&[self.place(other)]) {
                length += from.distance(p);
                bulge = bulge.max((p.y - self.place(end).y).abs());
                from = p;
            }
            let allowed = length <= joints.longest_mm && (other.line != end.line || bulge <= joints.bulge_mm);
            // A joint upwards is preferred, because the sweep begins at the lowest row. Of two joints in
            // the same direction the shorter one is taken.
            allowed.then_some((other.line <= end.line, length, (next, forwards == 1, between)))
        });
        let best = candidates.into_iter().flatten().min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))?;
        Some(best.2)
    }

    /// The border's vertices strictly between two neighbouring ends.
    fn between(&self, from: &End, to: &End, forwards: bool) -> Vec<DVec2> {
        let contour = &self.contours[from.contour as usize];
        let n = contour.len();
        // An end on the contour's last vertex belongs to the last edge.
        let edge = |end: &End| (end.at as usize).min(n - 1);
        let (a, b) = (edge(from), edge(to));
        let mut out = Vec::new();
        if forwards {
            let steps = if a == b && to.at >= from.at { 0 } else { (b + n - a - 1) % n + 1 };
            out.extend((1..=steps).map(|k| contour[(a + k) % n]));
        } else {
            let steps = if a == b && to.at <= from.at { 0 } else { (a + n - b - 1) % n + 1 };
            out.extend((0..steps).map(|k| contour[(a + n - k) % n]));
        }
        out
    }
}
