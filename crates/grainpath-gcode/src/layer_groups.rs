//! Groups beads into layers: by the layer marks that slicers write, or by height.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use grainpath_core::math::{atan2, cross};
use grainpath_core::units::bead_width_mm;
use grainpath_core::{DVec2, Role};

/// A straight piece of bead. It takes 32 bytes, since a program has millions of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bead {
    /// Start, mm, in the machine's coordinates.
    pub a: [f32; 2],
    /// End, mm.
    pub b: [f32; 2],
    /// Extruded volume, mm3.
    pub volume_mm3: f32,
    /// Requested speed, mm/s.
    pub speed_mm_s: f32,
    /// Role of the bead; outer wall if the program does not state a role.
    pub role: Role,
    /// Whether a path begins with this bead.
    pub starts: bool,
    /// How far its lower and its upper edge lie above those of its layer, mm. They differ from 0 only for
    /// staggered walls in our own programs.
    pub raise_mm: [f32; 2],
}

impl Bead {
    /// Start of the bead, mm.
    pub fn start(&self) -> DVec2 {
        DVec2::new(f64::from(self.a[0]), f64::from(self.a[1]))
    }

    /// End of the bead, mm.
    pub fn end(&self) -> DVec2 {
        DVec2::new(f64::from(self.b[0]), f64::from(self.b[1]))
    }

    /// The height of this bead in a layer of the given height, mm.
    pub fn height_mm(&self, layer_mm: f64) -> f64 {
        let [bottom, top] = self.raise_mm.map(f64::from);
        layer_mm + top - bottom
    }

    /// Full width of the bead's stadium-shaped section in a layer of the given height, mm.
    pub fn width_mm(&self, layer_mm: f64) -> f64 {
        let height_mm = self.height_mm(layer_mm).max(1e-3);
        let length = self.start().distance(self.end()).max(1e-9);
        bead_width_mm(f64::from(self.volume_mm3) / (length * height_mm), height_mm)
    }
}

/// A move of filament alone while the nozzle travels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull {
    /// Where the nozzle is, mm.
    pub at: [f32; 2],
    /// Number of the bead of the layer that follows.
    pub bead: u32,
    /// Whether filament that was pulled back is pushed again; otherwise it is pulled back.
    pub is_push: bool,
}

/// All that is printed in one layer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BeadLayer {
    /// Height of the nozzle in most of the layer, mm.
    pub z_mm: f64,
    /// Distance to the layer below, mm.
    pub height_mm: f64,
    /// Beads in printing order.
    pub beads: Vec<Bead>,
    /// Straight moves in plan that print nothing.
    pub travels: Vec<[[f32; 2]; 2]>,
    /// Where filament is pulled back and pushed again, in the order of the program. Those behind the last bead of a layer
    /// belong to the next one, as travels do.
    pub pulls: Vec<Pull>,
    /// Number of paths.
    pub paths: usize,
    /// Pieces of continuous fibre that begin here.
    pub fibre_starts: usize,
    /// Places where fibre is cut.
    pub cuts: Vec<[f32; 2]>,
    /// Estimated time with its travels and pauses, s; the layers together take as long as the program.
    pub time_s: f64,
}

/// A comment with which a slicer marks the beginning of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LayerMark {
    /// `;LAYER_CHANGE`: PrusaSlicer, SuperSlicer, OrcaSlicer, grainpath.
    LayerChange,
    /// `; CHANGE_LAYER`: Bambu Studio.
    ChangeLayer,
    /// `;LAYER:12`: Cura, ideaMaker.
    LayerNumber,
    /// `; layer 12, Z = 2.4`: Simplify3D. `; Layer #12`: CraftWare. `;; --- layer 12 (0.200 @ 2.400) ---`: Kiri:Moto.
    LayerText,
}

impl LayerMark {
    /// The layer mark that this comment is; `None` for any other comment.
    pub(crate) fn from_comment(comment: &str) -> Option<Self> {
        let number_after = |head: &str| {
            let rest = comment.get(..head.len()).filter(|h| h.eq_ignore_ascii_case(head));
            rest.is_some_and(|_| {
                let rest = comment[head.len()..].trim_start_matches('-');
                rest.starts_with(|c: char| c.is_ascii_digit())
            })
        };
        match comment {
            "LAYER_CHANGE" => Some(Self::LayerChange),
            "CHANGE_LAYER" => Some(Self::ChangeLayer),
            _ if number_after("LAYER:") => Some(Self::LayerNumber),
            _ if ["layer ", "layer #", "; --- layer "].into_iter().any(number_after) => Some(Self::LayerText),
            _ => None,
        }
    }
}

/// A height rounded to tenths of a micrometre, to serve as a key.
fn key(z_mm: f64) -> i64 {
    (z_mm * 1e4).round() as i64
}

/// Everything that is printed after one mark, grouped by height.
#[derive(Default)]
struct Marked {
    /// The parts of the layer, one for each height.
    parts: Vec<(i64, BeadLayer)>,
    /// Length printed at each height, mm.
    printed_mm: BTreeMap<i64, f64>,
}

impl Marked {
    /// The height with the greatest printed length; the highest one if no height has half of the whole length, as in a
    /// spiral.
    fn height(&self) -> Option<i64> {
        let whole: f64 = self.printed_mm.values().sum();
        let most = self.printed_mm.iter().max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(a.0)))?;
        if *most.1 >= 0.5 * whole { Some(*most.0) } else { self.printed_mm.keys().next_back().copied() }
    }
}

/// Largest slope of a spiral, mm of height per mm of way. Source: derived. A layer of 0.3 mm over a turn of 3 mm, around a
/// pin of 1 mm. Beads that rise more steeply are not planar on purpose.
const SPIRAL_SLOPE: f64 = 0.1;

/// A turn of a spiral.
struct Turn {
    /// The direction of the last bead.
    along: DVec2,
    /// How far directions have turned since its beginning, rad; 2 pi either way for a closed curve of any shape that does
    /// not cross itself.
    turned_rad: f64,
}

/// Collects layers while a program is replayed.
#[derive(Default)]
pub(crate) struct LayerCollector {
    /// The kind of mark that counts: the first that was found.
    kind: Option<LayerMark>,
    /// The first entry is what is printed before the first mark, such as a priming line.
    marked: Vec<Marked>,
    /// Whether nothing was printed before the first mark.
    starts_marked: bool,
    /// Parts of layers so far.
    n_parts: usize,
    /// The turn of a spiral to which the last part belongs.
    turn: Option<Turn>,
}

impl LayerCollector {
    /// Begins a new layer at a mark, if it is of the kind that counts.
    pub(crate) fn mark(&mut self, kind: LayerMark) {
        self.starts_marked |= self.kind.is_none() && self.marked.is_empty();
        if *self.kind.get_or_insert(kind) == kind {
            self.end_part();
            self.end_turn();
            self.marked.push(Marked::default());
        }
    }

    /// Ends the turn of a spiral: the next bead begins a new one, or lies in a flat layer.
    pub(crate) fn end_turn(&mut self) {
        self.turn = None;
    }

    /// Follows a spiral. The next bead goes along `way` to the height `z_mm`, with this slope. A spiral begins with a bead
    /// that rises gently, and goes on until a bead falls or is steep, or the nozzle travels; level beads belong to it, since
    /// heights are rounded. Each turn is one part.
    pub(crate) fn turn(&mut self, z_mm: f64, slope: f64, way: DVec2) {
        // A level piece belongs to a spiral only within one: coordinates of few decimals do not rise with every move.
        if !(0.0..SPIRAL_SLOPE).contains(&slope) || (slope == 0.0 && self.turn.is_none()) {
            return self.end_turn();
        }
        if let Some(turn) = &mut self.turn {
            turn.turned_rad += atan2(cross(turn.along, way), turn.along.dot(way));
            turn.along = way;
            if turn.turned_rad.abs() < std::f64::consts::TAU {
                if let Some((at, _)) = self.current().parts.last_mut() {
                    *at = key(z_mm);
                }
                return;
            }
            // The rest is kept, so that turns do not drift by the rounding of coordinates.
            turn.turned_rad -= std::f64::consts::TAU * turn.turned_rad.signum();
        } else {
            self.turn = Some(Turn { along: way, turned_rad: 0.0 });
        }
        self.begin_part(z_mm);
    }

    fn begin_part(&mut self, z_mm: f64) {
        self.end_part();
        self.n_parts += 1;
        self.current().parts.push((key(z_mm), BeadLayer::default()));
    }

    fn current(&mut self) -> &mut Marked {
        if self.marked.is_empty() {
            self.marked.push(Marked::default());
        }
        let last = self.marked.len() - 1;
        &mut self.marked[last]
    }

    /// Counts a bead of this length at a height.
    pub(crate) fn count(&mut self, z_mm: f64, length_mm: f64) {
        *self.current().printed_mm.entry(key(z_mm)).or_default() += length_mm;
    }

    /// Gives back memory that the last part does not need: nothing is added to it any more.
    fn end_part(&mut self) {
        if let Some((_, part)) = self.marked.last_mut().and_then(|marked| marked.parts.last_mut()) {
            part.beads.shrink_to_fit();
            part.travels.shrink_to_fit();
            part.pulls.shrink_to_fit();
        }
    }

    /// Number of parts of layers that were begun so far.
    pub(crate) fn n_parts(&self) -> usize {
        self.n_parts
    }

    /// The part of the current layer at a height.
    pub(crate) fn layer_at(&mut self, z_mm: f64) -> &mut BeadLayer {
        // Only the last part is compared: heights change seldom, and a spiral never returns to an earlier one.
        if self.current().parts.last().is_none_or(|(k, _)| *k != key(z_mm)) {
            self.begin_part(z_mm);
        }
        let parts = &mut self.current().parts;
        let last = parts.len() - 1;
        &mut parts[last].1
    }

    /// Moves everything printed before the first mark into the first layer, whose height stays the same.
    fn join_priming(&mut self) {
        if self.starts_marked {
            return;
        }
        let priming = self.marked.remove(0);
        self.marked[0].parts.splice(..0, priming.parts);
    }

    /// The layers from the plate up, with their heights. `spans_s` is the time before the first part, and that of each part
    /// in the order in which they were begun.
    pub(crate) fn finish(mut self, spans_s: &[f64]) -> Vec<BeadLayer> {
        let (before, of_parts) = spans_s.split_first().map_or((0.0, spans_s), |(first, rest)| (*first, rest));
        let parts = self.marked.iter_mut().flat_map(|m| &mut m.parts);
        for (k, ((_, part), span)) in parts.zip(of_parts).enumerate() {
            part.time_s = if k == 0 { before + span } else { *span };
        }
        self.marked.retain(|m| !m.parts.is_empty());
        if self.kind.is_some() && self.marked.len() > 1 {
            self.join_priming();
        }
        let heights: Vec<i64> = self.marked.iter().filter_map(Marked::height).collect();
        let rising = heights.len() == self.marked.len() && heights.is_sorted_by(|a, b| a < b);
        let mut layers: BTreeMap<i64, BeadLayer> = BTreeMap::new();
        for marked in self.marked {
            let own = marked.height();
            for (at, part) in marked.parts {
                let height = own.filter(|_| self.kind.is_some() && rising).unwrap_or(at);
                match layers.entry(height) {
                    Entry::Vacant(new) => _ = new.insert(part),
                    Entry::Occupied(layer) => layer.into_mut().append(part),
                }
            }
        }
        let mut below_mm = 0.0;
        let finished = layers.into_iter().map(|(height, mut layer)| {
            layer.z_mm = height as f64 * 1e-4;
            layer.height_mm = layer.z_mm - below_mm;
            below_mm = layer.z_mm;
            layer
        });
        finished.collect()
    }
}

impl BeadLayer {
    fn append(&mut self, mut other: Self) {
        let n = self.beads.len() as u32;
        self.pulls.extend(other.pulls.into_iter().map(|pull| Pull { bead: n + pull.bead, ..pull }));
        self.beads.append(&mut other.beads);
        self.travels.append(&mut other.travels);
        self.cuts.append(&mut other.cuts);
        self.paths += other.paths;
        self.fibre_starts += other.fibre_starts;
        self.time_s += other.time_s;
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use crate::{Limits, simulate};

    /// Squares of 10 mm at these heights, each after its mark.
    fn squares(heights: &[f64], mark: impl Fn(usize) -> String) -> String {
        let mut text = String::from("G21\nG90\nM83\n");
        for (i, z) in heights.iter().enumerate() {
            let _ = write!(
                text,
                "{}\nG1 Z{z} F600\nG1 X0 Y0\nG1 X10 E0.4\nG1 Y10 E0.4\nG1 X0 E0.4\nG1 Y0 E0.4\n",
                mark(i)
            );
        }
        text
    }

    fn heights_of(text: &str) -> Vec<f64> {
        let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
        program.layers.iter().map(|l| (l.z_mm * 1e3).round() * 1e-3).collect()
    }

    #[test]
    fn marks_of_every_slicer_are_layers() {
        let marks: [fn(usize) -> String; 7] = [
            |_| ";LAYER_CHANGE\n;Z:0.2\n;HEIGHT:0.2".into(),
            |_| "; CHANGE_LAYER\n; Z_HEIGHT: 0.2".into(),
            |i| format!(";LAYER:{i}"),
            |i| format!("; layer {}, Z = 0.2", i + 1),
            |i| format!("; Layer #{}", i + 1),
            |i| format!(";; --- layer {i} (0.200 @ 0.200) ---"),
            |_| String::new(),
        ];
        for mark in marks {
            assert_eq!(heights_of(&squares(&[0.2, 0.4, 0.6], mark)), [0.2, 0.4, 0.6], "{:?}", mark(0));
        }
    }

    /// A spiral rises with every move; a short piece at another height is part of the layer around it.
    #[test]
    fn marks_keep_spirals_and_odd_heights_together() {
        let mut spiral = String::from("G90\nM83\n");
        for layer in 0..3 {
            let _ = writeln!(spiral, ";LAYER_CHANGE");
            for k in 1..=40 {
                let z = 0.2 * f64::from(layer) + 0.2 * f64::from(k) / 40.0;
                let _ = writeln!(spiral, "G1 X{} Y{} Z{z} E0.1 F1200", k % 7, k % 5);
            }
        }
        assert_eq!(heights_of(&spiral), [0.2, 0.4, 0.6]);
        let odd = squares(&[0.2, 0.4], |_| ";LAYER_CHANGE".into());
        let odd = format!("{odd}G1 Z0.45\nG1 X1 E0.04\n");
        assert_eq!(heights_of(&odd), [0.2, 0.4]);
    }

    /// Two level layers and a spiral of 0.2 mm a turn, around a circle, a square or a star, written with three decimals.
    fn vase(n: usize, radius_mm: impl Fn(usize) -> f64, turns: usize, mark: &str) -> String {
        let mut text = format!("M83\n{mark}G1 Z0.2 F600\nG1 X10 Y0\n");
        for k in 1..=(turns + 2) * n {
            let (level, turn) = (k.div_ceil(n), 2 * n);
            let z = if k <= turn { 0.2 * level as f64 } else { 0.4 + 0.2 * (k - turn) as f64 / n as f64 };
            if k > 1 && k % n == 1 {
                text.push_str(mark);
            }
            let (s, c) = grainpath_core::math::sin_cos(std::f64::consts::TAU * (k % n) as f64 / n as f64);
            let r = radius_mm(k % n);
            let _ = writeln!(text, "G1 X{:.3} Y{:.3} Z{z:.3} E0.1", r * c, r * s);
        }
        text
    }

    #[test]
    fn turns_of_unmarked_spirals_are_layers() {
        let expected: Vec<f64> = (1..=20).map(|k| 0.2 * f64::from(k)).collect();
        let star = |k: usize| if k.is_multiple_of(2) { 10.0 } else { 6.0 };
        // A circle of so many pieces that most of them do not rise by what is written.
        for (n, mark, heights) in [
            (4, "", vase(4, |_| 10.0, 18, "")),
            (60, "", vase(60, |_| 10.0, 18, "")),
            (700, "", vase(700, |_| 10.0, 18, "")),
            (16, "", vase(16, star, 18, "")),
            (60, ";LAYER_CHANGE\n", vase(60, |_| 10.0, 18, ";LAYER_CHANGE\n")),
        ]
        .map(|(n, mark, text)| (n, mark, heights_of(&text)))
        {
            assert_eq!(heights.len(), 20, "{n} {mark}: {heights:?}");
            // Where a turn ends, and with it the layer, is a piece of the turn.
            let off = heights.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 0.06, "{n} {mark}: {heights:?}");
        }
        // Two vases one after the other, with marks that do not rise.
        let one = vase(60, |_| 10.0, 18, ";LAYER_CHANGE\n");
        assert_eq!(heights_of(&format!("{one}G1 Z30\n{one}")).len(), 20);
    }

    /// Objects one after the other begin at the plate again: layers are by height.
    #[test]
    fn layers_that_do_not_rise_are_by_height() {
        let text = squares(&[0.2, 0.4, 0.2, 0.4, 0.6], |i| format!(";LAYER:{i}"));
        assert_eq!(heights_of(&text), [0.2, 0.4, 0.6]);
    }

    /// Each layer has its own time; all together they have that of the program.
    #[test]
    fn times_of_layers_sum_to_that_of_the_program() {
        // The second layer at half the speed, with a pause after it; objects one after the other share layers.
        let slow = "G1 Z0.4\nG1 X0 Y0 F600\nG1 X100 E4 F1200\nG4 S5\n";
        let plain = |z: f64| format!("G1 Z{z} F600\nG1 X0 Y0\nG1 X100 E4 F2400\n");
        let marked =
            format!("M83\n;LAYER_CHANGE\n{};LAYER_CHANGE\n{slow};LAYER_CHANGE\n{}", plain(0.2), plain(0.6));
        let unmarked = format!("M83\n{}{slow}{}{}{slow}{}", plain(0.2), plain(0.6), plain(0.2), plain(0.6));
        for (text, factor) in [(marked, 1.0), (unmarked, 2.0)] {
            let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
            let times: Vec<f64> = program.layers.iter().map(|l| l.time_s).collect();
            assert_eq!(times.len(), 3);
            assert!(
                (times.iter().sum::<f64>() - program.time_s).abs() < 1e-9,
                "{times:?} {}",
                program.time_s
            );
            // 100 mm at 40 mm/s, or at 20 mm/s and the pause; with the ways back, which take some seconds at 10 mm/s.
            assert!((times[1] - times[2]) / factor > 5.0 + 2.0, "{times:?}");
            assert!(times.iter().all(|t| *t / factor > 2.5), "{times:?}");
        }
    }

    #[test]
    fn priming_before_the_first_mark_is_part_of_the_first_layer() {
        let text = squares(&[0.2, 0.4], |i| format!(";LAYER:{i}"));
        let primed = format!("M83\nG1 Z0.28 F600\nG1 X100 E5\n{text}");
        assert_eq!(heights_of(&primed), [0.2, 0.4]);
    }
}
