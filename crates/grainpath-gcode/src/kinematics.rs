//! Estimates how long a program takes, from speed profiles with limits at corners, as firmware plans them.
//!
//! Every move is a trapezoid: it accelerates, cruises and brakes. Look-ahead joins the trapezoids at corner speeds
//! ([`Corner`]): a backward pass finds how fast each move may begin so that the moves after it can still brake, a forward
//! pass what can be reached. With a *minimum cruise ratio* (Klipper) a second pair of passes with a lower, virtual
//! acceleration finds the peak of every run of short moves, and the true profile stays below that peak.
//!
//! Source: Klipper's documentation, pages "Kinematics" and "Config reference" (`klipper-docs` in docs/references.bib);
//! for corners by deviation `jeon2011`; for jerk Marlin's documentation (`marlin-docs`). The formulation is our own.
//! Units: mm, s. Cost: linear in the moves. Limits: pressure advance, input shaping and resonance change no times here;
//! heating and the probing of start programs are not counted; accelerations that a program sets itself are not read.

use std::collections::VecDeque;

/// Model of the speed allowed at corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Corner {
    /// Jump in speed allowed for each axis x, y, z, e, mm/s (Marlin's classic jerk, RepRapFirmware's instantaneous
    /// speed change).
    Jerk([f64; 4]),
    /// Junction deviation, mm (Marlin 2).
    Deviation(f64),
    /// Square corner velocity: the speed allowed at a right angle, mm/s (Klipper).
    SquareCorner(f64),
}

/// Speed and acceleration limits of the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Highest speed of x, y, z, e, mm/s.
    pub max_speed_mm_s: [f64; 4],
    /// Acceleration while printing, mm/s2.
    pub acceleration_mm_s2: f64,
    /// Acceleration of travels, mm/s2.
    pub travel_acceleration_mm_s2: f64,
    /// Acceleration of moves that turn only the filament drive, mm/s2.
    pub retract_acceleration_mm_s2: f64,
    /// Limit at corners.
    pub corner: Corner,
    /// Least share of every run of moves that is driven at constant speed, from 0 (included) to 1 (excluded); 0 for
    /// firmware without such a rule. Klipper's `minimum_cruise_ratio`.
    pub min_cruise_ratio: f64,
    /// Length of the straight pieces into which firmware divides G2 and G3, mm.
    pub arc_segment_mm: f64,
}

/// Klipper's default `minimum_cruise_ratio`. Source: klipper-docs, "Config reference", section `[printer]`.
pub const KLIPPER_MIN_CRUISE_RATIO: f64 = 0.5;
/// Klipper's default `resolution` of arcs, mm. Source: klipper-docs, "Config reference", section `[gcode_arcs]`.
pub const KLIPPER_ARC_SEGMENT_MM: f64 = 1.0;
/// Klipper's default `instantaneous_corner_velocity` of the extruder, mm/s of filament. Source: klipper-docs, "Config
/// reference", section `[extruder]`.
const KLIPPER_FILAMENT_CORNER_MM_S: f64 = 1.0;

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_speed_mm_s: [200.0, 200.0, 12.0, 60.0],
            acceleration_mm_s2: 1000.0,
            travel_acceleration_mm_s2: 1000.0,
            retract_acceleration_mm_s2: 1500.0,
            corner: Corner::Jerk([8.0, 8.0, 0.4, 1.5]),
            min_cruise_ratio: 0.0,
            arc_segment_mm: 0.1,
        }
    }
}

/// A straight move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Distance in x, y, z and filament, mm.
    pub delta_mm: [f64; 4],
    /// Requested speed, mm/s.
    pub speed_mm_s: f64,
}

#[derive(Debug, Clone, Copy)]
struct Block {
    length: f64,
    speed: f64,
    acceleration: f64,
    /// Highest speed at the beginning of the move.
    entry_limit: f64,
    unit: [f64; 4],
    /// Virtual acceleration of the minimum cruise ratio.
    smooth_acceleration: f64,
    /// The span that its time counts for.
    span: usize,
}

impl Block {
    /// Whether the print head moves; false for moves of the filament alone.
    fn moves_head(&self) -> bool {
        self.unit[..3].iter().any(|u| u.abs() > 1e-9)
    }
}

/// Adds up the time of moves, looking ahead as firmware does.
///
/// ```
/// use grainpath_gcode::{Corner, Limits, Move, TimeEstimator};
///
/// let limits = Limits { corner: Corner::Deviation(0.0), ..Limits::default() };
/// let mut time = TimeEstimator::new(limits);
/// time.push(&Move { delta_mm: [100.0, 0.0, 0.0, 1.0], speed_mm_s: 50.0 });
/// // At 1000 mm/s2: 0.05 s and 1.25 mm to speed up, the same to brake, 97.5 mm between.
/// assert!((time.seconds() - (0.1 + 97.5 / 50.0)).abs() < 1e-9);
/// ```
#[derive(Debug, Clone)]
pub struct TimeEstimator {
    limits: Limits,
    queue: VecDeque<Block>,
    /// Speed at the beginning of the first block of the queue.
    entry: f64,
    /// The same speed in the profile with the virtual acceleration.
    smooth_entry: f64,
    done_s: f64,
    /// The same for each span; moves are in the last one.
    spans_s: Vec<f64>,
}

/// Moves that are planned together. With that many waiting, the times of the older half become final. Source: Marlin looks
/// ahead by 16 moves (`marlin-docs`, BLOCK_BUFFER_SIZE); with more moves the estimate changes only where a ramp spans all of
/// them.
const LOOK_AHEAD: usize = 256;

impl TimeEstimator {
    /// Begins at rest.
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            queue: VecDeque::with_capacity(LOOK_AHEAD),
            entry: 0.0,
            smooth_entry: 0.0,
            done_s: 0.0,
            spans_s: vec![0.0],
        }
    }

    /// Counts the moves from here on for a span of their own. The first span begins with the first move.
    pub(crate) fn begin_span(&mut self) {
        self.spans_s.push(0.0);
    }

    /// Number of spans.
    pub(crate) fn n_spans(&self) -> usize {
        self.spans_s.len()
    }

    /// Time of each span so far, s. The last move ends at rest.
    pub(crate) fn spans_s(&self) -> Vec<f64> {
        let mut rest = self.clone();
        rest.settle(usize::MAX);
        rest.spans_s
    }

    /// The limits it was made with.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Adds a move. A move without length takes no time.
    pub fn push(&mut self, m: &Move) {
        let [x, y, z, e] = m.delta_mm;
        let travel = (x * x + y * y + z * z).sqrt();
        // As in firmware, the speed of a move with travel is that of the nozzle, and the filament
        // follows; a move of E alone uses the speed for E.
        let length = if travel > 1e-9 { travel } else { e.abs() };
        if !(length > 1e-9 && length.is_finite() && m.speed_mm_s > 0.0) {
            return;
        }
        let unit = m.delta_mm.map(|d| d / length);
        let mut speed = m.speed_mm_s;
        // Each axis moves with its component of the speed, which must not exceed the limit of the axis.
        for (u, max) in unit.iter().zip(self.limits.max_speed_mm_s) {
            if u.abs() > 1e-9 {
                speed = speed.min(max / u.abs());
            }
        }
        let acceleration = if travel <= 1e-9 {
            self.limits.retract_acceleration_mm_s2
        } else if e > 0.0 {
            self.limits.acceleration_mm_s2
        } else {
            self.limits.travel_acceleration_mm_s2
        };
        // The first move has no corner before it and begins at rest.
        let entry_limit = match self.queue.back() {
            Some(before) => self.corner_speed(before, &unit, speed, length, acceleration),
            None => speed.min(self.rest_speed(&unit)),
        };
        let cruise_share = 1.0 - self.limits.min_cruise_ratio;
        let smooth_acceleration = if travel <= 1e-9 {
            acceleration.min(self.limits.acceleration_mm_s2 * cruise_share)
        } else {
            acceleration * cruise_share
        };
        let span = self.spans_s.len() - 1;
        self.queue.push_back(Block {
            length,
            speed,
            acceleration,
            entry_limit,
            unit,
            smooth_acceleration,
            span,
        });
        if self.queue.len() >= LOOK_AHEAD {
            self.settle(LOOK_AHEAD / 2);
        }
    }

    /// Adds a stop of this many seconds.
    pub(crate) fn dwell(&mut self, seconds: f64) {
        // Motion ends at rest before a pause.
        self.settle(usize::MAX);
        let seconds = seconds.max(0.0);
        self.done_s += seconds;
        if let Some(span) = self.spans_s.last_mut() {
            *span += seconds;
        }
    }

    /// Highest speed at which a move may begin from rest or end at rest.
    fn rest_speed(&self, unit: &[f64; 4]) -> f64 {
        match self.limits.corner {
            // From rest, Marlin allows half the jerk: the axis changes from 0 to its speed instead
            // of between two opposite speeds.
            Corner::Jerk(jerk) => within(unit, &jerk, 0.5),
            Corner::Deviation(_) | Corner::SquareCorner(_) => 0.0,
        }
    }

    fn corner_speed(
        &self,
        before: &Block,
        unit: &[f64; 4],
        speed: f64,
        length: f64,
        acceleration: f64,
    ) -> f64 {
        let top = before.speed.min(speed);
        let turn = std::array::from_fn(|k| unit[k] - before.unit[k]);
        match self.limits.corner {
            Corner::Jerk(jerk) => top.min(within(&turn, &jerk, 1.0)),
            Corner::Deviation(d) => top.min(deviation_speed(before, unit, acceleration, d)),
            Corner::SquareCorner(v) => {
                let head_stops = !before.moves_head() || unit[..3].iter().all(|u| u.abs() <= 1e-9);
                if head_stops {
                    return 0.0;
                }
                // Klipper converts its square corner velocity to a junction deviation with this formula;
                // at a right angle both give the same speed.
                let d = v * v * (std::f64::consts::SQRT_2 - 1.0) / acceleration;
                let filament = KLIPPER_FILAMENT_CORNER_MM_S / turn[3].abs().max(1e-12);
                let reach = (length * acceleration).min(before.length * before.acceleration);
                top.min(deviation_speed(before, unit, acceleration, d))
                    .min(filament)
                    .min(half_move_speed(before, unit, reach))
            }
        }
    }

    /// Plans the whole queue and adds the time of its first `n` moves.
    fn settle(&mut self, n: usize) {
        if self.limits.min_cruise_ratio > 0.0 {
            self.limit_peaks(n);
        }
        // Backward pass: each move must begin slowly enough to reach the entry speed of the next one.
        let mut entries = vec![0.0; self.queue.len() + 1];
        if let Some(last) = self.queue.back() {
            entries[self.queue.len()] = self.rest_speed(&last.unit).min(last.speed);
        }
        for (i, b) in self.queue.iter().enumerate().rev() {
            let reachable = (entries[i + 1] * entries[i + 1] + 2.0 * b.acceleration * b.length).sqrt();
            let peak = if i > 0 { b.speed.min(self.queue[i - 1].speed) } else { b.speed };
            entries[i] = reachable.min(b.entry_limit).min(peak);
        }
        entries[0] = if entries.len() > 1 { self.entry.min(entries[0]) } else { 0.0 };
        for i in 0..n.min(self.queue.len()) {
            let Some(b) = self.queue.pop_front() else { break };
            let (v0, a) = (entries[i], b.acceleration);
            // Forward pass: no move ends faster than it can accelerate from its beginning.
            let v1 = entries[i + 1].min((v0 * v0 + 2.0 * a * b.length).sqrt());
            entries[i + 1] = v1;
            // The peak speed of the triangle profile without a speed limit.
            let peak = (0.5 * (v0 * v0 + v1 * v1) + a * b.length).sqrt();
            let top = peak.min(b.speed).max(v0.max(v1));
            // Length of both ramps together; the rest of the length is driven at the top speed.
            let ramps = (top * top - v0 * v0 + top * top - v1 * v1) / (2.0 * a);
            let seconds = (2.0 * top - v0 - v1) / a + (b.length - ramps).max(0.0) / top;
            self.done_s += seconds;
            self.spans_s[b.span] += seconds;
            self.entry = v1;
        }
        if self.queue.is_empty() {
            (self.entry, self.smooth_entry) = (0.0, 0.0);
        }
    }

    /// Lowers the speed of every move to the peak speed that its run reaches with the virtual acceleration. The
    /// first `n` moves are about to become final.
    ///
    /// ```text
    /// speed   ____            ____     asked for
    ///        /    \   .--.   /    \
    ///       / .--. \ /    \ / .--. \   peak with the virtual acceleration (lower slopes):
    ///      /.'    '.X      X.'    '.\  the true profile is cut off there
    /// ```
    fn limit_peaks(&mut self, n: usize) {
        let k = self.queue.len();
        // Squared speeds at the corners, with the virtual acceleration.
        let mut corner = vec![0.0; k + 1];
        for (i, b) in self.queue.iter().enumerate().rev() {
            corner[i] = (corner[i + 1] + 2.0 * b.smooth_acceleration * b.length).min(b.entry_limit.powi(2));
        }
        corner[0] = if k > 0 { self.smooth_entry.powi(2).min(corner[0]) } else { 0.0 };
        let mut peaks = Vec::with_capacity(k);
        for (i, b) in self.queue.iter().enumerate() {
            let gain = 2.0 * b.smooth_acceleration * b.length;
            corner[i + 1] = corner[i + 1].min(corner[i] + gain);
            peaks.push((0.5 * (corner[i] + corner[i + 1] + gain)).min(b.speed * b.speed));
        }
        // A move that accelerates over its whole length belongs to the run whose peak follows it; one that brakes over
        // its whole length belongs to the run whose peak precedes it.
        let steps = |i: usize| 2.0 * self.queue[i].smooth_acceleration * self.queue[i].length * (1.0 - 1e-9);
        for i in (0..k.saturating_sub(1)).rev() {
            if corner[i + 1] - corner[i] >= steps(i) {
                peaks[i] = f64::max(peaks[i], peaks[i + 1]);
            }
        }
        for i in 1..k {
            if corner[i] - corner[i + 1] >= steps(i) {
                peaks[i] = f64::max(peaks[i], peaks[i - 1]);
            }
        }
        self.smooth_entry = corner[n.min(k)].sqrt();
        for (b, peak) in self.queue.iter_mut().zip(peaks).take(n) {
            b.speed = b.speed.min(peak.sqrt());
        }
    }

    /// Time of all moves so far, s. The last move ends at rest.
    pub fn seconds(&self) -> f64 {
        let mut rest = self.clone();
        rest.settle(usize::MAX);
        rest.done_s
    }
}

/// The highest speed at which no axis changes its speed by more than `share` of its jerk.
fn within(change: &[f64; 4], jerk: &[f64; 4], share: f64) -> f64 {
    let allowed = change.iter().zip(jerk).filter(|(c, _)| c.abs() > 1e-9).map(|(c, j)| share * j / c.abs());
    allowed.fold(f64::INFINITY, f64::min)
}

/// The speed on the circle that rounds a corner and stays within `d` of it. Source: the junction
/// deviation of Grbl and Marlin.
fn deviation_speed(before: &Block, unit: &[f64; 4], acceleration: f64, d: f64) -> f64 {
    let cos = -(0..3).map(|k| before.unit[k] * unit[k]).sum::<f64>();
    // A straight continuation has no corner; the formula would divide by zero.
    if cos < -0.999_999 {
        return f64::INFINITY;
    }
    // Half-angle identity: sin(theta/2), where theta is the angle between the two moves.
    let sin_half = (0.5 * (1.0 - cos.min(0.999_999))).sqrt();
    (acceleration * d * sin_half / (1.0 - sin_half)).sqrt()
}

/// The speed on the circle that rounds a corner and touches both moves at their middles or nearer to the corner.
/// `reach` is the smaller of length times acceleration of the two moves, mm²/s².
///
/// A circle of radius R touches two moves with the angle t between them at R / tan(t / 2) from the corner.
fn half_move_speed(before: &Block, unit: &[f64; 4], reach: f64) -> f64 {
    let cos = -(0..3).map(|k| before.unit[k] * unit[k]).sum::<f64>();
    let (sin_half, cos_half) = ((0.5 * (1.0 - cos)).max(0.0).sqrt(), (0.5 * (1.0 + cos)).max(0.0).sqrt());
    if cos_half <= 1e-9 {
        return f64::INFINITY;
    }
    (0.5 * reach * sin_half / cos_half).sqrt()
}

/// The straight pieces into which firmware divides an arc of this length; at least one.
pub(crate) fn arc_pieces(length_mm: f64, arc_segment_mm: f64) -> usize {
    // Largest number of pieces of an arc. It bounds the work on hostile programs. Source: derived.
    // A full circle of 1 m radius in pieces of 0.3 mm has about as many.
    const MAX_PIECES: f64 = 20_000.0;
    (length_mm / arc_segment_mm.max(1e-3)).clamp(1.0, MAX_PIECES) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimator(corner: Corner) -> TimeEstimator {
        let limits = Limits { max_speed_mm_s: [500.0; 4], corner, ..Limits::default() };
        TimeEstimator::new(limits)
    }

    fn x(mm: f64, speed_mm_s: f64) -> Move {
        Move { delta_mm: [mm, 0.0, 0.0, 1.0], speed_mm_s }
    }

    #[test]
    fn one_move_is_a_trapezoid_or_a_triangle() {
        let mut long = estimator(Corner::Deviation(0.0));
        long.push(&x(100.0, 50.0));
        // 0.05 s up, 0.05 s down, 1.25 mm each; 97.5 mm at 50 mm/s.
        assert!((long.seconds() - (0.1 + 97.5 / 50.0)).abs() < 1e-9, "{}", long.seconds());
        let mut short = estimator(Corner::Deviation(0.0));
        short.push(&x(1.0, 50.0));
        assert!((short.seconds() - 2.0 * (1.0f64 / 1000.0).sqrt()).abs() < 1e-9, "{}", short.seconds());
    }

    #[test]
    fn a_straight_line_in_pieces_takes_as_long_as_whole() {
        for corner in [Corner::Deviation(0.02), Corner::Jerk([8.0; 4]), Corner::SquareCorner(5.0)] {
            let (mut whole, mut pieces) = (estimator(corner), estimator(corner));
            whole.push(&x(300.0, 80.0));
            (0..600).for_each(|_| {
                pieces.push(&Move { delta_mm: [0.5, 0.0, 0.0, 1.0 / 600.0], speed_mm_s: 80.0 })
            });
            assert!(
                (whole.seconds() - pieces.seconds()).abs() < 0.02,
                "{} {}",
                whole.seconds(),
                pieces.seconds()
            );
        }
    }

    #[test]
    fn a_right_angle_is_taken_at_its_speed() {
        let mut e = estimator(Corner::SquareCorner(5.0));
        e.push(&Move { delta_mm: [50.0, 0.0, 0.0, 1.0], speed_mm_s: 50.0 });
        e.push(&Move { delta_mm: [0.0, 50.0, 0.0, 1.0], speed_mm_s: 50.0 });
        // Each: 50 mm/s up from 0 and down to 5, or the other way round.
        let ramps = (2500.0 + 2500.0 - 25.0) / 2000.0;
        let each = (100.0 - 5.0) / 1000.0 + (50.0 - ramps) / 50.0;
        assert!((e.seconds() - 2.0 * each).abs() < 1e-6, "{} {}", e.seconds(), 2.0 * each);
    }

    fn klipper(min_cruise_ratio: f64) -> TimeEstimator {
        TimeEstimator::new(Limits {
            max_speed_mm_s: [500.0; 4],
            acceleration_mm_s2: 3000.0,
            corner: Corner::SquareCorner(5.0),
            min_cruise_ratio,
            ..Limits::default()
        })
    }

    /// "A minimum_cruise_ratio of 0.5 would ensure that a standalone 1.5mm move would have a minimum cruising distance of
    /// 0.75mm" (klipper-docs).
    #[test]
    fn half_of_a_short_move_is_cruised() {
        let mut e = klipper(0.5);
        e.push(&x(1.5, 500.0));
        // 0.375 mm up, 0.75 mm at the peak, 0.375 mm down.
        let peak = (2.0f64 * 3000.0 * 0.375).sqrt();
        let wanted = 2.0 * peak / 3000.0 + 0.75 / peak;
        assert!((e.seconds() - wanted).abs() < 1e-9, "{} {wanted}", e.seconds());
        // The same in ten pieces along a line is one run.
        let mut pieces = klipper(0.5);
        (0..10).for_each(|_| pieces.push(&x(0.15, 500.0)));
        assert!((pieces.seconds() - wanted).abs() < 1e-6, "{} {wanted}", pieces.seconds());
        let mut free = klipper(0.0);
        free.push(&x(1.5, 500.0));
        assert!((free.seconds() - 2.0 * (1.5f64 / 3000.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn a_long_move_is_as_fast_with_a_cruise_ratio() {
        let time = |ratio| {
            let mut e = klipper(ratio);
            (0..600).for_each(|_| e.push(&Move { delta_mm: [0.5, 0.0, 0.0, 0.02], speed_mm_s: 100.0 }));
            e.seconds()
        };
        assert!((time(0.5) - time(0.0)).abs() < 1e-6, "{} {}", time(0.5), time(0.0));
    }

    #[test]
    fn the_head_stops_for_filament_alone() {
        let mut e = klipper(0.0);
        e.push(&x(50.0, 100.0));
        e.push(&Move { delta_mm: [0.0, 0.0, 0.0, -1.0], speed_mm_s: 30.0 });
        let head = 100.0 / 3000.0 + 50.0 / 100.0;
        let filament = 30.0 / 1500.0 + 1.0 / 30.0;
        assert!((e.seconds() - head - filament).abs() < 1e-9, "{} {}", e.seconds(), head + filament);
    }

    #[test]
    fn an_axis_that_is_slow_slows_the_move() {
        let limits = Limits { max_speed_mm_s: [500.0, 500.0, 5.0, 500.0], ..Limits::default() };
        let mut e = TimeEstimator::new(limits);
        e.push(&Move { delta_mm: [0.0, 0.0, 10.0, 0.0], speed_mm_s: 100.0 });
        assert!(e.seconds() > 2.0);
    }
}
