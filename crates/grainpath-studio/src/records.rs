//! Toolpaths as the page draws them: eight bytes a segment, one chunk a layer.
//!
//! A layer is a sequence of records. Each record is a point and describes the move from the previous point to it:
//!
//! | bytes | content |
//! |---|---|
//! | 0, 1 | x of the point, in steps from the origin of the program |
//! | 2, 3 | y |
//! | 4, 5 | width of the bead, um |
//! | 6 | role of the bead in the order of [`Role::ALL`], or [`TRAVEL`], [`START`], [`RETRACTION`] or [`PUSH`]; [`SEAM`] is added where a closed wall begins |
//! | 7 | speed, as its index in the program's table of speeds |
//!
//! Numbers are little-endian. The first record of a layer is a [`START`], which draws nothing. [`RETRACTION`] and [`PUSH`] lie
//! at the point before them: filament is pulled back and pushed again there, and the nozzle stays. The page hands the bytes
//! to the graphics card as they are: record k and record k + 1 are the two ends of a segment.
//!
//! A step is the longer side of the box round all moves, divided by 65535: 5 um for 300 mm, which is finer than the 10 um
//! that a printer's motors resolve. Cost: linear in beads. Limits: widths above 65.5 mm are stored as 65.5 mm; speeds are
//! rounded to 0.1 mm/s, and a program with more than 256 speeds has them rounded down to 256 values.
//!
//! The first layers of a plan are sent before the others are planned. The box is then that of the bed, and later speeds come
//! behind the earlier ones in the table, so that the bytes of a layer stay the same. If the bed is too large for a fine
//! step, if a move leaves it, or if there are too many speeds, the finished program gets a box and a table of its own; the
//! page sees this by their numbers in the index and asks for all layers again.

use std::collections::{BTreeMap, BTreeSet};

use grainpath_core::math::ln;
use grainpath_core::{Bounds2, DVec2, Role};
use grainpath_gcode::{Bead, BeadLayer, Program, Pull};
use serde::Serialize;

/// Class of a move that prints nothing. Source: one more than the last role.
pub const TRAVEL: u8 = Role::ALL.len() as u8;
/// Class of the first record of a layer. Source: one more than travels.
pub const START: u8 = TRAVEL + 1;
/// Class of a place where filament is pulled back. Source: one more than starts.
pub const RETRACTION: u8 = START + 1;
/// Class of a place where filament is pushed again. Source: one more than retractions.
pub const PUSH: u8 = RETRACTION + 1;
/// Added to the role of the first bead of a closed wall. Source: the top bit; roles need the lower ones.
pub const SEAM: u8 = 128;
/// Byte of a record without an angle or a reserve: travels, starts, and beads where the guide asks for nothing or nothing can
/// fail.
pub const NO_VALUE: u8 = u8::MAX;
/// The byte of a reserve of 1: a bead that fails at the loads as they are. Source: chosen; the scale then begins at a
/// sixteenth of the loads, and a run whose peak is above five times the strength tells no reserve.
const RESERVE_OF_1: f64 = 80.0;
/// Steps of the byte of a reserve while it doubles. Source: chosen; a step is 3.5 %, less than the reserve is known, and the
/// scale ends above 400 times the loads.
const RESERVE_STEPS: f64 = 20.0;
/// Bytes of a record. Source: the table above.
pub const RECORD_BYTES: usize = 8;
/// The greatest number of different speeds. Source: the values of one byte.
const SPEEDS: usize = 256;
/// Distance below which two ends count as the same point, mm. Source: programs state coordinates to 0.001 mm.
const SAME_MM: f32 = 2e-3;

/// Longest step of a box that is larger than the program needs, mm. Source: what a printer's motors resolve.
const COARSE_MM: f64 = 0.01;

/// The numbers that points and speeds of records refer to.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Origin, mm.
    origin_mm: [f64; 2],
    /// Length of a step, mm.
    step_mm: f64,
    /// Speeds in tenths of mm/s, in the order of their numbers.
    speeds: Vec<u32>,
}

impl Frame {
    /// The frame of programs whose moves lie in a box.
    pub fn of_box([low, high]: [[f64; 2]; 2]) -> Self {
        let longest_mm = (high[0] - low[0]).max(high[1] - low[1]);
        Self { origin_mm: low, step_mm: (longest_mm / f64::from(u16::MAX)).max(1e-6), speeds: Vec::new() }
    }

    /// This frame with the speeds of a program behind its own; `None` where the program does not fit into it.
    fn with(&self, program: &Program, all: Bounds2) -> Option<Self> {
        let reach_mm = self.step_mm * f64::from(u16::MAX);
        let is_inside = (0..2).all(|k| {
            all.min[k] >= self.origin_mm[k] - self.step_mm
                && all.max[k] <= self.origin_mm[k] + reach_mm + self.step_mm
        });
        let mut speeds = self.speeds.clone();
        let known: BTreeSet<u32> = speeds.iter().copied().collect();
        speeds.extend(different_speeds(program).difference(&known));
        (is_inside && self.step_mm <= COARSE_MM && speeds.len() <= SPEEDS)
            .then(|| Self { speeds, ..self.clone() })
    }
}

/// The entry of a layer in the index.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LayerEntry {
    /// Height of the nozzle, mm.
    pub z_mm: f64,
    /// Thickness, mm.
    pub height_mm: f64,
    /// Number of records of the layer.
    pub records: usize,
    /// Number of beads of the layer.
    pub beads: usize,
    /// Printed length, mm.
    pub printed_mm: f64,
    /// Volume, mm3.
    pub volume_mm3: f64,
    /// Estimated time, s.
    pub time_s: f64,
    /// Closed walls: each has a seam where it begins.
    pub seams: usize,
}

/// Data of a program that the page needs before it draws the first layer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Index {
    /// Origin of the records, mm.
    pub origin_mm: [f64; 2],
    /// Length of a step, mm.
    pub step_mm: f64,
    /// Names of the classes: roles as slicers write them, travels, starts, retractions, pushes.
    pub classes: Vec<&'static str>,
    /// Speeds, mm/s.
    pub speeds_mm_s: Vec<f64>,
    /// Lowest and highest corner of the part without skirt, brim, support and priming lines, mm.
    pub part_mm: [[f64; 3]; 2],
    /// Least and greatest width of the part's beads, mm, leaving out the narrowest and the widest hundredth.
    pub widths_mm: [f64; 2],
    /// Flow that 99 of 100 beads of the part stay below, mm3/s.
    pub flow_mm3_s: f64,
    /// Number of beads and printed length of each class, in the order of `classes`.
    pub shares: Vec<Share>,
    /// The layers.
    pub layers: Vec<LayerEntry>,
    /// Whether further layers are still planned.
    pub more: bool,
    /// Number of records of all layers.
    pub records: usize,
    /// Number of places where filament is pulled back, and where it is pushed again.
    pub pulls: [usize; 2],
    /// The software that wrote the G-code; `None` if the G-code does not say.
    pub generator: Option<String>,
    /// Estimated time, s.
    pub time_s: f64,
    /// Length of filament, mm.
    pub filament_mm: f64,
}

/// The beads of one class in a program.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Share {
    /// Number of beads.
    pub beads: usize,
    /// Length, mm.
    pub length_mm: f64,
}

fn class(role: Role) -> u8 {
    // `Role::ALL` has the order of declaration, which a test checks.
    role as u8
}

/// What a record of a layer stands for: the start of the layer, a travel, a pull or push of filament, or a bead.
enum Step<'a> {
    Start([f32; 2]),
    Travel([f32; 2]),
    Pull([f32; 2], bool),
    Bead(&'a Bead),
}

fn far(a: [f32; 2], b: [f32; 2]) -> bool {
    far_by(a, b, SAME_MM)
}

fn far_by(a: [f32; 2], b: [f32; 2], mm: f32) -> bool {
    (a[0] - b[0]).abs() > mm || (a[1] - b[1]).abs() > mm
}

/// Whether each bead of a layer is the first of a closed wall. A wall is closed where its path ends within a bead's width of
/// where it began: slicers leave a gap of a part of a bead at the seam.
fn seams(layer: &BeadLayer) -> Vec<bool> {
    let is_wall = |b: &Bead| matches!(b.role, Role::OuterWall | Role::InnerWall);
    let mut seams = vec![false; layer.beads.len()];
    let mut first = 0;
    while first < layer.beads.len() {
        let begin = &layer.beads[first];
        let belongs = |b: &Bead| !b.starts && b.role == begin.role;
        let n = 1 + layer.beads[first + 1..].iter().take_while(|b| belongs(b)).count();
        let last = &layer.beads[first + n - 1];
        // Two beads forth and back enclose nothing.
        let is_closed = n > 2 && begin.start().distance(last.end()) <= begin.width_mm(layer.height_mm);
        seams[first] = begin.starts && is_wall(begin) && is_closed;
        first += n;
    }
    seams
}

/// Walks a layer: beads, and between them the travels that lead from one to the next, with pulls and pushes of filament.
fn walk<'a>(layer: &'a BeadLayer, mut step: impl FnMut(Step<'a>)) {
    let mut travels = layer.travels.iter().peekable();
    let mut pulls = layer.pulls.iter().peekable();
    let first = travels.peek().map(|t| t[0]).or(layer.beads.first().map(|b| b.a));
    let Some(mut at) = first else { return };
    step(Step::Start(at));
    for (bead, number) in layer.beads.iter().zip(0..) {
        let mut pull = |at: [f32; 2], reach_mm: f32, step: &mut dyn FnMut(Step<'a>)| {
            // Pulls come in the order of the program, so the first that lies elsewhere waits for a later move.
            let is_here = |p: &&Pull| p.bead <= number && !far_by(p.at, at, reach_mm);
            while let Some(pull) = pulls.next_if(is_here) {
                step(Step::Pull(at, pull.is_push));
            }
        };
        // Travels are in the order of the program. Those before this bead come first; each begins where the last move ended.
        pull(at, SAME_MM, &mut step);
        while far(at, bead.a) {
            let Some(travel) = travels.next_if(|t| !far(t[0], at)) else { break };
            at = travel[1];
            step(Step::Travel(at));
            pull(at, SAME_MM, &mut step);
        }
        if far(at, bead.a) {
            // No travel of the layer leads to the bead, so one is added: a layer may consist of several pieces.
            step(Step::Travel(bead.a));
        }
        // A record lies on the way of the nozzle, so a pull from a move that the layer does not have comes here.
        pull(bead.a, f32::INFINITY, &mut step);
        step(Step::Bead(bead));
        at = bead.b;
    }
}

/// The boxes round all beads and travels, and round the part alone.
fn extents(program: &Program) -> (Bounds2, Option<Bounds2>) {
    let mut all: Option<Bounds2> = None;
    let mut part: Option<Bounds2> = None;
    let to = |p: [f32; 2]| DVec2::new(f64::from(p[0]), f64::from(p[1]));
    let add = |bounds: &mut Option<Bounds2>, p: DVec2, r: f64| {
        let own = Bounds2 { min: p - r, max: p + r };
        *bounds = Some(bounds.map_or(own, |b| b.union(own)));
    };
    let n_part = program.layers.iter().filter(|l| l.beads.iter().any(|b| b.role.is_part())).count();
    // The first layer is left out, because priming lines lie in it and have the role of walls.
    let skipped = usize::from(n_part > 2);
    let mut part_layers = 0;
    for layer in &program.layers {
        let is_part = layer.beads.iter().any(|b| b.role.is_part());
        part_layers += usize::from(is_part);
        for bead in &layer.beads {
            for p in [to(bead.a), to(bead.b)] {
                add(&mut all, p, 0.0);
                if bead.role.is_part() && part_layers > skipped {
                    add(&mut part, p, 0.5 * bead.width_mm(layer.height_mm));
                }
            }
        }
        for p in layer.travels.iter().flatten() {
            add(&mut all, to(*p), 0.0);
        }
    }
    let empty = Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO };
    (all.unwrap_or(empty), part)
}

fn speed_key(speed_mm_s: f32) -> u32 {
    (speed_mm_s.clamp(0.0, 1e5) * 10.0).round() as u32
}

/// The different speeds of a program in tenths of mm/s.
fn different_speeds(program: &Program) -> BTreeSet<u32> {
    program.layers.iter().flat_map(|l| &l.beads).map(|b| speed_key(b.speed_mm_s)).collect()
}

/// The speeds of a program, at most [`SPEEDS`] of them.
fn speeds(program: &Program) -> Vec<u32> {
    let all: Vec<u32> = different_speeds(program).into_iter().collect();
    if all.len() <= SPEEDS {
        return all;
    }
    // Speeds are picked evenly from the sorted list, so that ranges with many speeds keep most of them.
    let at = |k: usize| all[k * (all.len() - 1) / (SPEEDS - 1)];
    (0..SPEEDS).map(at).collect()
}

/// A program as the page sees it: the index, and the records of any layer.
pub struct Records {
    index: Index,
    frame: Frame,
    /// Numbers of the speeds in the frame.
    speed_numbers: BTreeMap<u32, u8>,
}

impl Records {
    /// Measures a program. Cost: two passes over its beads.
    pub fn new(program: &Program) -> Self {
        Self::within(program, None)
    }

    /// Measures a program, and keeps the frame of its first layers where it fits.
    pub fn within(program: &Program, frame: Option<&Frame>) -> Self {
        let (all, part) = extents(program);
        let frame = frame.and_then(|f| f.with(program, all)).unwrap_or_else(|| Frame {
            speeds: speeds(program),
            ..Frame::of_box([all.min.to_array(), all.max.to_array()])
        });
        let classes = Role::ALL
            .iter()
            .map(|r| r.gcode_name())
            .chain(["Travel", "Start", "Retraction", "Push"])
            .collect();
        let mut shares = vec![Share::default(); usize::from(PUSH) + 1];
        let mut pulls = [0; 2];
        let (mut widths, mut flows): (Vec<f32>, Vec<f32>) = (Vec::new(), Vec::new());
        let mut layers = Vec::with_capacity(program.layers.len());
        for layer in &program.layers {
            let mut entry = LayerEntry {
                z_mm: layer.z_mm,
                height_mm: layer.height_mm,
                records: 0,
                beads: layer.beads.len(),
                printed_mm: 0.0,
                volume_mm3: 0.0,
                time_s: (layer.time_s * 1e3).round() / 1e3,
                seams: seams(layer).into_iter().filter(|is_seam| *is_seam).count(),
            };
            walk(layer, |step| {
                entry.records += 1;
                if let Step::Pull(_, is_push) = step {
                    pulls[usize::from(is_push)] += 1;
                }
                if let Step::Bead(bead) = step {
                    let length_mm = bead.start().distance(bead.end());
                    let share = &mut shares[usize::from(class(bead.role))];
                    share.beads += 1;
                    share.length_mm += length_mm;
                    entry.printed_mm += length_mm;
                    entry.volume_mm3 += f64::from(bead.volume_mm3);
                }
            });
            // Only a sample of the widths is taken, which is enough for a colour scale.
            let sampled =
                layer.beads.iter().filter(|b| b.role.is_part()).step_by(1 + layer.beads.len() / 200);
            for bead in sampled {
                let length_mm = bead.start().distance(bead.end()).max(1e-9);
                widths.push(bead.width_mm(layer.height_mm) as f32);
                flows.push(bead.volume_mm3 * bead.speed_mm_s / length_mm as f32);
            }
            layers.push(entry);
        }
        widths.sort_by(f32::total_cmp);
        flows.sort_by(f32::total_cmp);
        let share_of = |of: &[f32], q: f64| {
            let found = of.get(((of.len() as f64 - 1.0) * q).max(0.0) as usize);
            found.map_or(0.0, |v| (f64::from(*v) * 1e3).round() / 1e3)
        };
        let part = part.unwrap_or(all);
        let heights = program.layers.iter().filter(|l| l.beads.iter().any(|b| b.role.is_part()));
        let (mut low_mm, mut high_mm) = (f64::INFINITY, 0.0_f64);
        for layer in heights {
            low_mm = low_mm.min(layer.z_mm - layer.height_mm);
            high_mm = high_mm.max(layer.z_mm);
        }
        let round = |v: f64| (v * 1e3).round() / 1e3;
        let records = layers.iter().map(|l| l.records).sum();
        let index = Index {
            origin_mm: frame.origin_mm,
            step_mm: frame.step_mm,
            classes,
            speeds_mm_s: frame.speeds.iter().map(|k| f64::from(*k) / 10.0).collect(),
            part_mm: [
                [part.min.x, part.min.y, low_mm.min(high_mm)].map(round),
                [part.max.x, part.max.y, high_mm].map(round),
            ],
            widths_mm: [0.01, 0.99].map(|q| share_of(&widths, q)),
            flow_mm3_s: share_of(&flows, 0.99),
            shares,
            layers,
            more: false,
            records,
            pulls,
            generator: program.generator.clone(),
            time_s: program.time_s,
            filament_mm: program.filament_mm,
        };
        let speed_numbers =
            frame.speeds.iter().zip(0..=u8::MAX).map(|(key, number)| (*key, number)).collect();
        Self { index, frame, speed_numbers }
    }

    /// These records, of a program that further layers will follow.
    #[must_use]
    pub fn unfinished(mut self) -> Self {
        self.index.more = true;
        self
    }

    /// The frame of the records.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The index.
    pub fn index(&self) -> &Index {
        &self.index
    }

    /// The records of a layer.
    pub fn layer(&self, layer: &BeadLayer) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(RECORD_BYTES * (layer.beads.len() + layer.travels.len() + 1));
        let [x0, y0] = self.index.origin_mm;
        let steps = |v: f32, from: f64| {
            ((f64::from(v) - from) / self.index.step_mm).round().clamp(0.0, f64::from(u16::MAX)) as u16
        };
        let mut push = |p: [f32; 2], width_um: u16, class: u8, speed: u8| {
            bytes.extend_from_slice(&steps(p[0], x0).to_le_bytes());
            bytes.extend_from_slice(&steps(p[1], y0).to_le_bytes());
            bytes.extend_from_slice(&width_um.to_le_bytes());
            bytes.extend_from_slice(&[class, speed]);
        };
        let mut seams = seams(layer).into_iter();
        walk(layer, |step| match step {
            Step::Start(p) => push(p, 0, START, 0),
            Step::Travel(p) => push(p, 0, TRAVEL, 0),
            Step::Pull(p, is_push) => push(p, 0, if is_push { PUSH } else { RETRACTION }, 0),
            Step::Bead(bead) => {
                let width_um = (bead.width_mm(layer.height_mm) * 1e3).round().clamp(0.0, f64::from(u16::MAX));
                let key = speed_key(bead.speed_mm_s);
                // The largest speed of the table that is not above this one.
                let speed = self.speed_numbers.range(..=key).next_back().map_or(0, |(_, number)| *number);
                let seam = if seams.next() == Some(true) { SEAM } else { 0 };
                push(bead.b, width_um as u16, class(bead.role) | seam, speed);
            }
        });
        bytes
    }

    /// A byte for each record of a layer: that of its bead, or [`NO_VALUE`].
    pub fn of_beads(layer: &BeadLayer, of_beads: &[u8]) -> Vec<u8> {
        let mut of_beads = of_beads.iter();
        let mut bytes = Vec::with_capacity(layer.beads.len() + layer.travels.len() + 1);
        walk(layer, |step| {
            let own = if matches!(step, Step::Bead(_)) { of_beads.next() } else { None };
            bytes.push(own.copied().unwrap_or(NO_VALUE));
        });
        bytes
    }
}

/// The byte of a bead's reserve, the factor on the loads at which it fails: 20 steps while it doubles, 80 for 1.
///
/// ```
/// use grainpath_studio::records::{NO_VALUE, reserve_byte};
///
/// assert_eq!([0.5, 1.0, 8.0].map(reserve_byte), [60, 80, 140]);
/// assert_eq!([0.01, 1e4, f32::INFINITY].map(reserve_byte), [0, 254, NO_VALUE]);
/// ```
pub fn reserve_byte(factor: f32) -> u8 {
    if !factor.is_finite() {
        return NO_VALUE;
    }
    // Equal steps are equal ratios: what carries twice as much is as far away at any load.
    let doubled = ln(f64::from(factor.max(f32::MIN_POSITIVE))) / std::f64::consts::LN_2;
    (RESERVE_OF_1 + RESERVE_STEPS * doubled).round().clamp(0.0, f64::from(NO_VALUE - 1)) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_gcode::{Limits, simulate};

    const TEXT: &str = ";LAYER_CHANGE\nM83\nG1 Z0.2 F600\nG1 X10 Y0 F6000\n;TYPE:External perimeter\nG1 X30 E0.75 F1800\n\
                        G1 Y20 E0.75\nG1 X0 Y5 F6000\nG1 X5 Y5\n;TYPE:Internal infill\nG1 X25 E0.9 F3000\n;LAYER_CHANGE\nG1 Z0.4\n\
                        G1 X10 Y0\n;TYPE:External perimeter\nG1 X30 E0.75 F1800\n";

    fn number(record: &[u8], at: usize) -> f64 {
        f64::from(u16::from_le_bytes([record[at], record[at + 1]]))
    }

    #[test]
    fn classes_are_the_places_of_roles() {
        for (k, role) in Role::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(class(role)), k, "{role:?}");
        }
    }

    /// The page's list of colours is in the order of the roles, with travels last.
    #[test]
    fn the_page_has_a_colour_for_every_class() {
        let text = include_str!("../../../web/src/colours.ts");
        let list = text.split("CLASS_COLOURS: Rgb[] = [").nth(1).and_then(|t| t.split("];").next());
        let colours = list.expect("the list").lines().filter(|l| l.trim_start().starts_with('['));
        assert_eq!(colours.count(), usize::from(TRAVEL) + 1);
    }

    /// Points, widths, roles and speeds come back from the bytes.
    #[test]
    fn records_hold_the_beads_and_the_travels_between_them() {
        let program = simulate(TEXT.as_bytes(), 1.75, &Limits::default()).expect("G-code");
        let records = Records::new(&program);
        let index = records.index();
        let bytes = records.layer(&program.layers[0]);
        assert_eq!(bytes.len(), RECORD_BYTES * index.layers[0].records);
        let rows: Vec<&[u8]> = bytes.chunks(RECORD_BYTES).collect();
        let classes: Vec<u8> = rows.iter().map(|r| r[6]).collect();
        let (wall, fill) = (class(Role::OuterWall), class(Role::SparseFill));
        assert_eq!(classes, [START, TRAVEL, wall, wall, TRAVEL, TRAVEL, fill]);
        let points: Vec<[f64; 2]> = rows
            .iter()
            .map(|r| [0, 1].map(|k| index.origin_mm[k] + number(r, 2 * k) * index.step_mm))
            .collect();
        let expected =
            [[0.0, 0.0], [10.0, 0.0], [30.0, 0.0], [30.0, 20.0], [0.0, 5.0], [5.0, 5.0], [25.0, 5.0]];
        for (point, expected) in points.iter().zip(expected) {
            assert!((point[0] - expected[0]).abs() <= index.step_mm, "{point:?} {expected:?}");
            assert!((point[1] - expected[1]).abs() <= index.step_mm, "{point:?} {expected:?}");
        }
        let bead = &program.layers[0].beads[0];
        assert!((number(rows[2], 4) * 1e-3 - bead.width_mm(0.2)).abs() < 1e-3);
        assert_eq!(index.speeds_mm_s[usize::from(rows[2][7])], 30.0);
        assert_eq!(index.speeds_mm_s[usize::from(rows[6][7])], 50.0);
        assert_eq!(index.shares[usize::from(wall)].beads, 3);
        assert!((index.shares[usize::from(wall)].length_mm - 60.0).abs() < 1e-4);
    }

    /// Filament is pulled back where a bead ends and pushed where the next one begins: by E alone, by a wipe, and by the
    /// firmware. What primes the nozzle before the first bead is no push, and a change of the tool's offset no retraction.
    #[test]
    fn pulls_of_filament_lie_on_the_way_of_the_nozzle() {
        let text = "M83\nG1 X1 Y1 F6000\nG1 E5 F300\nG10 P0 S200\n;LAYER_CHANGE\nG1 Z0.2\n;TYPE:Internal infill\nG1 X10 Y0 F6000\n\
                    G1 X20 E0.4 F1200\nG1 E-0.8 F2400\nG1 X20 Y5 F6000\nG1 E0.8 F2400\nG1 X10 E0.4 F1200\nG1 X12 E-0.3\nG1 X14 E-0.3\n\
                    G1 X20 Y10\nG1 E0.6\nG1 X10 E0.4\nG10\n;LAYER_CHANGE\nG1 Z0.4\nG1 X30 Y10\nG11\nG1 X40 E0.4\nG1 E-0.8\n";
        let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
        let records = Records::new(&program);
        let index = records.index();
        let rows = |layer: usize| -> Vec<(u8, [f64; 2])> {
            let bytes = records.layer(&program.layers[layer]);
            assert_eq!(bytes.len(), RECORD_BYTES * index.layers[layer].records);
            let point = |r: &[u8]| [0, 1].map(|k| index.origin_mm[k] + number(r, 2 * k) * index.step_mm);
            bytes.chunks(RECORD_BYTES).map(|r| (r[6], point(r).map(f64::round))).collect()
        };
        let fill = class(Role::SparseFill);
        let first = [
            (START, [0.0, 0.0]),
            (TRAVEL, [1.0, 1.0]),
            (TRAVEL, [10.0, 0.0]),
            (fill, [20.0, 0.0]),
            (RETRACTION, [20.0, 0.0]),
            (TRAVEL, [20.0, 5.0]),
            (PUSH, [20.0, 5.0]),
            (fill, [10.0, 5.0]),
            (RETRACTION, [10.0, 5.0]),
            (TRAVEL, [12.0, 5.0]),
            (TRAVEL, [14.0, 5.0]),
            (TRAVEL, [20.0, 10.0]),
            (PUSH, [20.0, 10.0]),
            (fill, [10.0, 10.0]),
        ];
        assert_eq!(rows(0), first);
        // The firmware's retraction behind the last bead of a layer comes with the travel to the next layer.
        let at = [10.0, 10.0];
        let second = [
            (START, at),
            (RETRACTION, at),
            (TRAVEL, [30.0, 10.0]),
            (PUSH, [30.0, 10.0]),
            (fill, [40.0, 10.0]),
        ];
        assert_eq!(rows(1), second);
        assert_eq!(index.pulls, [3, 3]);
        assert_eq!(index.shares.iter().map(|s| s.beads).sum::<usize>(), 4);
    }

    /// Closed walls begin with a seam; open ones, fill and what only turns back do not.
    #[test]
    fn closed_walls_have_one_seam_each() {
        let square = |x: f64, gap: f64| {
            format!(
                "G1 X{x} Y0 F6000\nG1 X{} E0.3 F1200\nG1 Y10 E0.3\nG1 X{x} E0.3\nG1 Y{gap} E0.3\n",
                x + 10.0
            )
        };
        let text = format!(
            "M83\n;LAYER_CHANGE\nG1 Z0.2\n;TYPE:External perimeter\n{}{}{};TYPE:Perimeter\n{};TYPE:Internal infill\n{}\
             ;TYPE:External perimeter\nG1 X90 Y0 F6000\nG1 X99 E0.3 F1200\nG1 X90 E0.3\n",
            square(0.0, 0.0),
            square(20.0, 0.2),
            square(40.0, 3.0),
            square(60.0, 0.0),
            square(80.0, 0.0)
        );
        let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
        let records = Records::new(&program);
        let bytes = records.layer(&program.layers[0]);
        let beads: Vec<u8> =
            bytes.chunks(RECORD_BYTES).map(|r| r[6]).filter(|k| k & !SEAM < TRAVEL).collect();
        let found: Vec<usize> = (0..beads.len()).filter(|k| beads[*k] >= SEAM).collect();
        // Closed, closed but for half a bead, open by 3 mm, the inner wall.
        assert_eq!(found, [0, 4, 12], "{beads:?}");
        assert_eq!(records.index().layers[0].seams, 3);
        assert!((records.index().layers[0].time_s - program.time_s).abs() < 1e-3);
    }

    /// The end of the scale of flow is a flow that the program has, however slow its widest beads are.
    #[test]
    fn the_flow_is_that_of_beads() {
        use std::fmt::Write;
        // Wide and slow, narrow and fast: 0.2 mm3/mm at 20 mm/s, 0.06 mm3/mm at 100 mm/s, for 50 beads each.
        let mut text = String::from("M83\n;LAYER_CHANGE\nG1 Z0.2\n;TYPE:Internal infill\n");
        let section = std::f64::consts::PI * 1.75 * 1.75 / 4.0;
        for k in 0..100 {
            let (area, speed) = if k % 2 == 0 { (0.2, 1200) } else { (0.06, 6000) };
            let _ = writeln!(text, "G1 X{} E{:.6} F{speed}", 10 * ((k + 1) % 2), 10.0 * area / section);
        }
        let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
        let index = Records::new(&program);
        assert!((index.index().flow_mm3_s - 6.0).abs() < 0.01, "{}", index.index().flow_mm3_s);
        assert!((index.index().widths_mm[1] - 1.04).abs() < 0.02, "{:?}", index.index().widths_mm);
    }

    /// Angles and reserves of beads lie at the records of these beads.
    #[test]
    fn bytes_are_those_of_the_beads() {
        let program = simulate(TEXT.as_bytes(), 1.75, &Limits::default()).expect("G-code");
        let none = NO_VALUE;
        assert_eq!(
            Records::of_beads(&program.layers[0], &[0, 180, 90]),
            [none, none, 0, 180, none, none, 90]
        );
        assert_eq!(Records::of_beads(&program.layers[0], &[]), [none; 7]);
    }

    /// A program of many speeds keeps 256 of them, and no bead is put far from its own.
    #[test]
    fn many_speeds_share_a_table() {
        use std::fmt::Write;
        let mut text = String::from("M83\nG1 Z0.2\n");
        for k in 0..1000 {
            let _ = writeln!(text, "G1 X{} E0.05 F{}", k % 7, 600 + 6 * k);
        }
        let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
        let records = Records::new(&program);
        assert_eq!(records.index().speeds_mm_s.len(), 256);
        let bytes = records.layer(&program.layers[0]);
        let beads = bytes.chunks(RECORD_BYTES).filter(|r| r[6] < TRAVEL);
        let mut compared = 0;
        for (record, bead) in beads.zip(&program.layers[0].beads) {
            let stated = records.index().speeds_mm_s[usize::from(record[7])];
            assert!((stated - f64::from(bead.speed_mm_s)).abs() < 0.6, "{stated} {}", bead.speed_mm_s);
            compared += 1;
        }
        assert_eq!(compared, program.layers[0].beads.len());
    }

    /// The first layers of a program have the bytes that they have in the whole, also where later layers have other speeds
    /// and reach further; a program that leaves the box has a frame of its own.
    #[test]
    fn the_bytes_of_early_layers_stay_the_same() {
        let read = |text: &str| simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
        let bed = Frame::of_box([[0.0, 0.0], [220.0, 200.0]]);
        let (early, whole) = (read(TEXT), read(&format!("{TEXT};LAYER_CHANGE\nG1 Z0.6\nG1 X200 E3 F900\n")));
        let first = Records::within(&early, Some(&bed));
        let then = Records::within(&whole, Some(first.frame()));
        assert_eq!(first.index().speeds_mm_s, [30.0, 50.0]);
        assert_eq!(then.index().speeds_mm_s, [30.0, 50.0, 15.0]);
        for k in 0..2 {
            assert_eq!(first.layer(&early.layers[k]), then.layer(&whole.layers[k]), "layer {k}");
        }
        let last = then.layer(&whole.layers[2]);
        assert_eq!(then.index().speeds_mm_s[usize::from(last[last.len() - 1])], 15.0);
        assert_eq!(then.index().origin_mm, [0.0, 0.0]);
        let outside = read(&TEXT.replace("X0 Y5", "X-3 Y5"));
        assert_eq!(Records::within(&outside, Some(first.frame())).index(), Records::new(&outside).index());
        let coarse = Frame::of_box([[0.0, 0.0], [900.0, 900.0]]);
        assert_eq!(Records::within(&early, Some(&coarse)).index(), Records::new(&early).index());
    }

    /// A program that prints nothing has an index without layers.
    #[test]
    fn empty_programs_have_no_layers() {
        let program = simulate(b"G28\nM104 S0\n", 1.75, &Limits::default()).expect("G-code");
        let records = Records::new(&program);
        assert_eq!((records.index().layers.len(), records.index().records), (0, 0));
    }
}
