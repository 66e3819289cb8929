//! A G-code interpreter: replays a program and collects beads, filament and time.
//!
//! The interpreter keeps the position, the feed and the modes (absolute or relative, mm or inch, linear or volumetric E)
//! of the machine and turns every move into beads or travels. Any bytes are accepted. A line that cannot be understood is
//! skipped as a whole, whatever words it has. Such lines are counted, and the first five cause a warning each. The same is
//! said of motion that is not read (splines, arcs out of the xy plane, arcs that no circle makes): it prints nothing, but
//! the machine goes on from its end, since absolute E would otherwise be extruded by the next move.
//!
//! *Layers.* Slicers mark where a layer begins: `;LAYER_CHANGE` (PrusaSlicer, SuperSlicer, OrcaSlicer), `; CHANGE_LAYER`
//! (Bambu Studio), `;LAYER:n` (Cura, ideaMaker), `; layer n` (Simplify3D), `; Layer #n` (CraftWare) and
//! `;; --- layer n` (Kiri:Moto). The first kind found counts. Beads are grouped by their height if there are no marks, or
//! if marked layers do not rise (objects printed one after the other); each turn of a spiral is a layer then.
//!
//! *Time.* Moves go through the [`TimeEstimator`], arcs in the pieces into which the firmware divides them.
//!
//! Units: mm, mm³, s, in machine coordinates. Memory: 32 bytes a bead. Limits: all tools except the fibre tool count as
//! one; conditions and macros of firmware (Klipper's templates, RepRapFirmware's meta G-code) are not run; the time for
//! heating is not counted.

use grainpath_core::math::{atan2, sin_cos};
use grainpath_core::{DVec2, Role, Warning, WarningId};

use crate::kinematics::{Limits, Move, TimeEstimator, arc_pieces};
use crate::layer_groups::{Bead, BeadLayer, LayerCollector, LayerMark, Pull};
use crate::read::{Line, Lines};

/// The result of replaying a program.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// Name of the program that wrote the G-code, where a comment states it.
    pub generator: Option<String>,
    /// Layers from the plate up.
    pub layers: Vec<BeadLayer>,
    /// Length of all beads, mm.
    pub printed_mm: f64,
    /// Length of all travels in plan, mm.
    pub travel_mm: f64,
    /// Volume of all beads, mm3.
    pub extruded_mm3: f64,
    /// Length of filament that was used, mm.
    pub filament_mm: f64,
    /// Number of retractions.
    pub retractions: usize,
    /// Estimated time, s.
    pub time_s: f64,
    /// Number of lines with a command.
    pub commands: usize,
    /// Number of arcs among them.
    pub arcs: usize,
    /// Highest nozzle temperature set, degC.
    pub nozzle_temp_c: f64,
    /// Highest bed temperature set, degC.
    pub bed_temp_c: f64,
    /// Sizes of the embedded thumbnails, pixels.
    pub thumbnails: Vec<[u32; 2]>,
    /// Warnings about lines that could not be read; the first few name their line.
    pub warnings: Vec<Warning>,
}

/// Range of possible filament diameters, mm. Numbers outside it come from damage or another unit. Source: derived.
/// Filament is sold with 1.75 and 2.85 mm; the limits of 0.01 and 10 mm differ from these by a factor of three and
/// more.
const FILAMENTS_MM: std::ops::RangeInclusive<f64> = 0.01..=10.0;

fn section_mm2(diameter_mm: f64) -> f64 {
    std::f64::consts::PI * diameter_mm * diameter_mm / 4.0
}

/// Reasons why a program cannot be replayed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)]
pub enum SimulateError {
    #[error("the file is empty")]
    Empty,
    #[error("binary G-code is not read; have it written as text")]
    Binary,
    #[error("not G-code: no line of {lines} has a command")]
    NoCommands { lines: usize },
}

/// Replays a program. `filament_mm` is the filament's diameter; `limits` are the printer's, for the time.
///
/// # Errors
/// [`SimulateError`] when there is nothing to replay. A program that prints nothing is valid; it has no layers.
///
/// ```
/// use grainpath_gcode::{Limits, simulate};
///
/// let text = ";LAYER_CHANGE\nG1 Z0.2 F600\nG1 X10 Y0 F1800\n;TYPE:Perimeter\nG1 X30 E0.75\n";
/// let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
/// assert_eq!((program.layers.len(), program.layers[0].beads.len()), (1, 1));
/// assert!((program.printed_mm - 20.0).abs() < 1e-9 && (program.travel_mm - 10.0).abs() < 1e-9);
/// assert!((program.filament_mm - 0.75).abs() < 1e-9);
/// ```
pub fn simulate(bytes: &[u8], filament_mm: f64, limits: &Limits) -> Result<Program, SimulateError> {
    let mut replay = Replay::new(filament_mm, limits);
    replay.push(bytes);
    replay.finish()
}

/// How binary G-code begins. Source: libbgcode's specification of the format, section "File header".
const BINARY_MARK: &[u8] = b"GCDE";

/// Replays a program that comes in pieces, as from a writer, so that its text is never in memory as a whole. The result is
/// that of [`simulate`] for all pieces in a row.
///
/// ```
/// use grainpath_gcode::{Limits, Replay, simulate};
///
/// let text = b"G1 Z0.2 F600\nG1 X10 Y0 F1800\nG1 X30 E0.75\n";
/// let mut replay = Replay::new(1.75, &Limits::default());
/// text.chunks(7).for_each(|piece| replay.push(piece));
/// assert_eq!(replay.finish(), simulate(text, 1.75, &Limits::default()));
/// ```
pub struct Replay {
    machine: Machine,
    n_lines: usize,
    /// The beginning of a line whose end has not come yet.
    rest: Vec<u8>,
    /// The first bytes, by which binary G-code is known.
    head: Vec<u8>,
}

impl Replay {
    /// A replay with the filament's diameter, mm, and the printer's limits.
    pub fn new(filament_mm: f64, limits: &Limits) -> Self {
        Self { machine: Machine::new(filament_mm, *limits), n_lines: 0, rest: Vec::new(), head: Vec::new() }
    }

    /// Replays the next piece; it may end within a line.
    pub fn push(&mut self, piece: &[u8]) {
        let missing = BINARY_MARK.len() - self.head.len();
        self.head.extend(piece.iter().take(missing));
        if self.head == BINARY_MARK {
            return;
        }
        // Only LF surely ends a line: an LF that follows a CR may come with the next piece.
        let Some(last) = piece.iter().rposition(|&b| b == b'\n') else {
            self.rest.extend_from_slice(piece);
            return;
        };
        let (whole, rest) = piece.split_at(last + 1);
        if self.rest.is_empty() {
            self.lines(whole);
        } else {
            self.rest.extend_from_slice(whole);
            self.last_lines();
        }
        self.rest.extend_from_slice(rest);
    }

    fn lines(&mut self, bytes: &[u8]) {
        for line in Lines::after(self.n_lines, bytes) {
            self.n_lines = line.number;
            self.machine.line(&line);
        }
    }

    /// Replays the lines that are kept until their end has come.
    fn last_lines(&mut self) {
        let mut bytes = std::mem::take(&mut self.rest);
        self.lines(&bytes);
        bytes.clear();
        self.rest = bytes;
    }

    /// The whole program.
    ///
    /// # Errors
    /// As for [`simulate`].
    pub fn finish(mut self) -> Result<Program, SimulateError> {
        if self.head.is_empty() {
            return Err(SimulateError::Empty);
        }
        if self.head == BINARY_MARK {
            return Err(SimulateError::Binary);
        }
        self.last_lines();
        if self.machine.program.commands == 0 {
            return Err(SimulateError::NoCommands { lines: self.n_lines });
        }
        Ok(self.machine.finish())
    }
}

impl std::io::Write for Replay {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.push(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

struct Machine {
    at: [f64; 3],
    e: f64,
    feed: f64,
    absolute: bool,
    absolute_e: bool,
    /// Whether I and J are the centre itself (G90.1) instead of its distance from the start.
    absolute_centres: bool,
    /// Whether arcs lie in the xy plane (G17).
    plane_is_xy: bool,
    scale: f64,
    role: Role,
    filament_mm2: f64,
    /// Whether E is in mm3 instead of mm of filament (M200).
    volumetric: bool,
    volumetric_mm2: f64,
    /// Cross-section of the fibre tool's filament, where the program states it.
    fibre_mm2: Option<f64>,
    path_open: bool,
    layers: LayerCollector,
    travels: Vec<[[f32; 2]; 2]>,
    /// Pulls and pushes of filament that no bead has followed yet.
    pulls: Vec<Pull>,
    /// Whether filament is pulled back.
    is_pulled: bool,
    /// Pieces of fibre that began since the last bead.
    fibre_starts: usize,
    /// How far the lower and the upper edges of beads are raised above those of their layer, mm.
    raise_mm: [f32; 2],
    time: TimeEstimator,
    program: Program,
    n_broken: usize,
}

impl Machine {
    fn new(filament_mm: f64, limits: Limits) -> Self {
        let filament_mm2 = section_mm2(filament_mm);
        Self {
            at: [0.0; 3],
            e: 0.0,
            // Firmware starts with a default feed rate too; programs state their own before the first
            // move.
            feed: 25.0,
            absolute: true,
            absolute_e: true,
            absolute_centres: false,
            plane_is_xy: true,
            scale: 1.0,
            role: Role::OuterWall,
            filament_mm2,
            volumetric: false,
            volumetric_mm2: filament_mm2,
            fibre_mm2: None,
            path_open: false,
            layers: LayerCollector::default(),
            travels: Vec::new(),
            pulls: Vec::new(),
            is_pulled: false,
            fibre_starts: 0,
            raise_mm: [0.0; 2],
            time: TimeEstimator::new(limits),
            program: Program::default(),
            n_broken: 0,
        }
    }

    fn line(&mut self, line: &Line<'_>) {
        if !line.comment.is_empty() {
            self.comment(line.comment);
        }
        if line.broken {
            return self.not_read(line, "");
        }
        let Some((letter, code)) = line.command else { return };
        self.program.commands += 1;
        match (letter, code) {
            (b'G', 0 | 10 | 20 | 30) => self.motion(line, code / 10),
            // G5 and G5.1: splines. The next move begins at their end, so that they are not skipped as a line is.
            (b'G', 50 | 51) => {
                let (to, _) = self.target(line);
                self.unread_motion(line, to, ": splines are not read");
            }
            // G4: S is in seconds, P in milliseconds. A pause of more than an hour means that the printer
            // waits for its user.
            (b'G', 40) => {
                let s = line.word(b'S').unwrap_or(0.0) + line.word(b'P').unwrap_or(0.0) * 1e-3;
                self.time.dwell(s.min(3600.0));
            }
            // Retraction by the firmware. With P or L, G10 sets temperatures and offsets of a tool instead.
            (b'G', 100) if line.word(b'P').or(line.word(b'L')).is_none() => self.pull(-1.0),
            (b'G', 110) => self.pull(1.0),
            (b'G', 170) => self.plane_is_xy = true,
            (b'G', 180 | 190) => self.plane_is_xy = false,
            // G20 and G21: inches and millimetres.
            (b'G', 200) => self.scale = 25.4,
            (b'G', 210) => self.scale = 1.0,
            // G28 homes all axes or some; positions afterwards are those of the end stops, here 0.
            (b'G', 280) => self.at = [0.0; 3],
            // G90 and G91 set E as well; M82 and M83 set E alone.
            (b'G', 900) => (self.absolute, self.absolute_e) = (true, true),
            (b'G', 910) => (self.absolute, self.absolute_e) = (false, false),
            (b'G', 901) => self.absolute_centres = true,
            (b'G', 911) => self.absolute_centres = false,
            (b'M', 820) => self.absolute_e = true,
            (b'M', 830) => self.absolute_e = false,
            // G92 sets positions without motion; without words it sets all to 0.
            (b'G', 920) => {
                let all = line.words().is_empty();
                for (k, axis) in [b'X', b'Y', b'Z'].into_iter().enumerate() {
                    self.at[k] =
                        line.word(axis).map_or(if all { 0.0 } else { self.at[k] }, |v| v * self.scale);
                }
                let e = line.word(b'E').map(|v| v * self.e_scale());
                self.e = e.unwrap_or(if all { 0.0 } else { self.e });
            }
            (b'M', 2000) => self.volume(line),
            // M104, M109, M140, M190. The highest value counts, since programs cool down at their end.
            (b'M', 1040 | 1090) => {
                self.program.nozzle_temp_c = self.program.nozzle_temp_c.max(line.word(b'S').unwrap_or(0.0));
            }
            (b'M', 1400 | 1900) => {
                self.program.bed_temp_c = self.program.bed_temp_c.max(line.word(b'S').unwrap_or(0.0));
            }
            (b'G', _) if !PRINTS_NOTHING.contains(&(code / 10)) && line.has_axis() => {
                self.not_read(line, "");
            }
            _ => {}
        }
    }

    fn not_read(&mut self, line: &Line<'_>, why: &str) {
        self.n_broken += 1;
        // Five examples show the kind of damage; a binary file would give thousands.
        if self.n_broken <= 5 {
            let text = String::from_utf8_lossy(&line.text[..line.text.len().min(60)]).into_owned();
            let text = format!("cannot understand {text:?}{why}");
            let warning = Warning::new(WarningId::GcodeNotRead, text).in_line(line.number);
            self.program.warnings.push(warning);
        }
    }

    /// M200 as Marlin reads it: with a diameter, E is in mm3; D0 or S0 ends that. Which tool is
    /// meant makes no difference to volumes.
    fn volume(&mut self, line: &Line<'_>) {
        let asked = line.word(b'S').map(|s| s != 0.0);
        self.volumetric = match line.word(b'D').map(|d| d * self.scale) {
            Some(0.0) => false,
            Some(d) if FILAMENTS_MM.contains(&d) => {
                self.volumetric_mm2 = section_mm2(d);
                asked.unwrap_or(true)
            }
            Some(_) => return self.not_read(line, ""),
            None => asked.unwrap_or(self.volumetric),
        };
    }

    /// Factor on E values. In inch mode E is in inches or cubic inches.
    fn e_scale(&self) -> f64 {
        if self.volumetric { self.scale.powi(3) } else { self.scale }
    }

    fn comment(&mut self, comment: &[u8]) {
        // Names of files in comments may be in any encoding.
        let text = String::from_utf8_lossy(comment);
        let text = text.as_ref();
        if let Some(kind) = LayerMark::from_comment(text) {
            self.layers.mark(kind);
            self.path_open = false;
            self.raise_mm = [0.0; 2];
            return;
        }
        let after = |key: &str| {
            // `get` instead of slicing, because a comment may end within a multi-byte character.
            let head = text.get(..key.len())?;
            head.eq_ignore_ascii_case(key).then(|| text[key.len()..].trim())
        };
        // PrusaSlicer and OrcaSlicer write TYPE, Bambu Studio FEATURE, Simplify3D feature.
        if let Some(name) = after("TYPE:").or(after("FEATURE:")).or(after("feature ")) {
            self.role = role_named(name);
        } else if let Some(name) = plain_role(text) {
            self.role = name;
        // Only the first such comment is from the program itself; later ones may be quoted settings.
        } else if self.program.generator.is_none() {
            let said = after("generated by ").or(after("generated with ")).or(after("Generated with "));
            let said = said.or_else(|| text.starts_with("G-Code generated by ").then(|| &text[20..]));
            self.program.generator = said.map(|s| s.chars().take(80).collect());
        }
        match text {
            // Marks of our own writer; no firmware reads them.
            "FIBRE_START" => self.fibre_starts += 1,
            "FIBRE_CUT" => {
                let [x, y, z] = self.at;
                self.layers.layer_at(z).cuts.push([x as f32, y as f32]);
            }
            _ => {}
        }
        // Another mark of our own writer: beads that are raised above their layer.
        if let Some((bottom, top)) = after("RAISED:").and_then(|mm| mm.split_once(' ')) {
            // A hostile program may state any number, but a bead cannot be raised by more than a few layers.
            let raise = |mm: &str| mm.trim().parse().ok().filter(|mm: &f32| mm.abs() < 100.0).unwrap_or(0.0);
            self.raise_mm = [raise(bottom), raise(top)];
        }
        // The filament of the fibre tool may be thinner than that of the matrix, and volumes depend on the diameter.
        if let Some(d) = after("fibre_filament_mm =").and_then(|d| d.parse::<f64>().ok())
            && FILAMENTS_MM.contains(&d)
        {
            self.fibre_mm2 = Some(section_mm2(d));
        }
        if let Some(size) =
            after("thumbnail begin ").or(after("thumbnail_QOI begin ")).or(after("thumbnail_JPG begin "))
        {
            let mut numbers = size.split([' ', 'x']).filter_map(|w| w.parse().ok());
            if let (Some(w), Some(h)) = (numbers.next(), numbers.next()) {
                self.program.thumbnails.push([w, h]);
            }
        }
    }

    /// Where a move ends, and how much E it extrudes. Feed and E are taken over.
    fn target(&mut self, line: &Line<'_>) -> ([f64; 3], f64) {
        let from = self.at;
        let mut to = from;
        for (k, axis) in [b'X', b'Y', b'Z'].into_iter().enumerate() {
            if let Some(v) = line.word(axis) {
                to[k] = v * self.scale + if self.absolute { 0.0 } else { from[k] };
            }
        }
        if let Some(f) = line.word(b'F').filter(|f| *f > 0.0) {
            self.feed = f * self.scale / 60.0;
        }
        let mut de = 0.0;
        if let Some(v) = line.word(b'E') {
            let value = v * self.e_scale();
            de = if self.absolute_e { value - self.e } else { value };
            self.e = if self.absolute_e { value } else { self.e + value };
        }
        (to, de)
    }

    /// Motion that prints nothing here, though the machine may move.
    fn unread_motion(&mut self, line: &Line<'_>, to: [f64; 3], why: &str) {
        self.not_read(line, why);
        self.at = to;
        self.path_open = false;
        self.layers.end_turn();
    }

    fn motion(&mut self, line: &Line<'_>, code: u32) {
        let from = self.at;
        let (to, de) = self.target(line);
        let end = DVec2::new(to[0], to[1]);
        let start = DVec2::new(from[0], from[1]);
        let (mut points, mut timed) = (vec![end], vec![end]);
        if code >= 2 {
            if !self.plane_is_xy {
                return self.unread_motion(line, to, ": arcs are read in the xy plane (G17) alone");
            }
            let Some(arc) = Arc::new(start, end, line, self.scale, code == 2, self.absolute_centres) else {
                return self.unread_motion(line, to, ": no circle goes through its start and its end");
            };
            self.program.arcs += 1;
            points = arc.points(((arc.length_mm() / ARC_CHORD_MM) as usize).clamp(2, 20_000));
            timed = arc.points(arc_pieces(arc.length_mm(), self.time.limits().arc_segment_mm));
        }
        let mut length = 0.0;
        let mut p = start;
        for q in &points {
            length += p.distance(*q);
            p = *q;
        }
        self.advance(start, &points, length, to[2], to[2] - from[2], de);
        self.spend(start, &timed, to[2] - from[2], de);
        self.at = to;
    }

    fn advance(&mut self, start: DVec2, points: &[DVec2], length: f64, z: f64, dz: f64, de: f64) {
        // A retraction during a travel (wipe) has a negative E, so it prints nothing.
        let prints = de > 0.0 && length > 0.0;
        let single = |p: DVec2| [p.x as f32, p.y as f32];
        // Filament length (mm) and volume (mm3) per unit of E.
        let (mm, mm3) = if self.volumetric {
            (1.0 / self.volumetric_mm2, 1.0)
        } else {
            let fibre = self.fibre_mm2.filter(|_| self.role == Role::Fibre);
            (1.0, fibre.unwrap_or(self.filament_mm2))
        };
        if !prints {
            self.pull(de);
        }
        if !prints && (length > 0.0 || dz != 0.0) {
            self.program.travel_mm += length;
            self.path_open = false;
            self.layers.end_turn();
        }
        let mut p = start;
        for &q in points {
            // Along an arc, E and z grow in proportion to the length.
            let share = if length > 0.0 { p.distance(q) / length } else { 1.0 };
            if prints && q != p {
                let volume = de * share * mm3;
                self.program.filament_mm += de * share * mm;
                self.program.extruded_mm3 += volume;
                self.program.printed_mm += p.distance(q);
                self.layers.turn(z, dz / length, q - p);
                // Beads with a raised upper edge do not count for the height of their layer.
                if self.raise_mm[1] == 0.0 {
                    self.layers.count(z, p.distance(q));
                }
                let layer = self.layers.layer_at(z);
                layer.fibre_starts += std::mem::take(&mut self.fibre_starts);
                layer.paths += usize::from(!self.path_open);
                // Travels belong to the layer of the bead that follows them.
                layer.travels.append(&mut self.travels);
                let bead = layer.beads.len() as u32;
                layer.pulls.extend(self.pulls.drain(..).map(|pull| Pull { bead, ..pull }));
                // Filament that is pushed while the nozzle prints is not pulled back any more.
                self.is_pulled = false;
                layer.beads.push(Bead {
                    a: single(p),
                    b: single(q),
                    volume_mm3: volume as f32,
                    speed_mm_s: self.feed as f32,
                    role: self.role,
                    starts: !self.path_open,
                    raise_mm: self.raise_mm,
                });
                self.path_open = true;
            } else if !prints && q != p {
                self.travels.push([single(p), single(q)]);
            }
            p = q;
        }
    }

    /// Keeps where filament is pulled back (`de` below 0) or pushed again, by a move of E alone, while the nozzle travels
    /// (a wipe), or by the firmware. The first pull of several counts.
    fn pull(&mut self, de: f64) {
        // A second pull in a row and a push without one change nothing: wipes pull in several moves, and programs prime
        // the nozzle before they begin.
        let is_push = de > 0.0;
        if de != 0.0 && self.is_pulled == is_push {
            self.is_pulled = !is_push;
            self.program.retractions += usize::from(!is_push);
            let at = [self.at[0] as f32, self.at[1] as f32];
            self.pulls.push(Pull { at, bead: 0, is_push });
        }
    }

    /// Counts the time of a move, divided into the same pieces as in the firmware.
    fn spend(&mut self, start: DVec2, points: &[DVec2], dz: f64, de: f64) {
        self.begin_spans();
        let de = if self.volumetric { de / self.volumetric_mm2 } else { de };
        let share = 1.0 / points.len() as f64;
        let mut p = start;
        for &q in points {
            let delta_mm = [q.x - p.x, q.y - p.y, dz * share, de * share];
            self.time.push(&Move { delta_mm, speed_mm_s: self.feed });
            p = q;
        }
    }

    /// Each part of a layer has a span of its own from its first bead to that of the next part.
    fn begin_spans(&mut self) {
        while self.time.n_spans() <= self.layers.n_parts() {
            self.time.begin_span();
        }
    }

    fn finish(mut self) -> Program {
        self.begin_spans();
        self.program.layers = std::mem::take(&mut self.layers).finish(&self.time.spans_s());
        if self.n_broken > 5 {
            let text = format!("{} lines cannot be understood", self.n_broken);
            self.program.warnings.push(Warning::new(WarningId::GcodeNotRead, text));
        }
        self.program.time_s = self.time.seconds();
        self.program
    }
}

/// Chords into which the beads of an arc are divided, mm. Source: derived. A chord c is off its circle
/// of radius r by c^2 / (8 r): 0.25 um for 5 mm, a quarter of what G-code rounds.
const ARC_CHORD_MM: f64 = 0.1;

/// Distance by which the end of an arc may miss its circle, mm. Source: derived. Coordinates of two decimals round start,
/// end and centre by up to 0.007 mm each, which moves the radii by 0.03 mm together.
const OFF_CIRCLE_MM: f64 = 0.03;
/// The same as a share of the radius, added to it. Source: LinuxCNC's documentation, G2 and G3: 0.1 % of the radius.
const OFF_CIRCLE_SHARE: f64 = 1e-3;
/// Most turns of an arc (P). Source: Marlin, `G2_G3.cpp`.
const MAX_TURNS: f64 = 100.0;

/// Groups of G codes whose words X, Y, Z and E are no motion that prints: offsets of tools (10), cleaning (12), parking
/// (27), homing, levelling, calibration and probing (28 to 30, 32 to 35, 38, 80, 425), positions (92). Source: the
/// references of Marlin, RepRapFirmware and Prusa.
const PRINTS_NOTHING: [u32; 14] = [10, 12, 27, 28, 29, 30, 32, 33, 34, 35, 38, 80, 92, 425];

/// An arc of G2 or G3.
struct Arc {
    centre: DVec2,
    radius_mm: f64,
    /// Angle at which it begins, and how far it turns: positive counter-clockwise.
    start_rad: f64,
    sweep_rad: f64,
    end: DVec2,
}

impl Arc {
    /// `None` if no arc has this start, end and centre or radius.
    fn new(
        from: DVec2,
        to: DVec2,
        line: &Line<'_>,
        scale: f64,
        clockwise: bool,
        absolute_centre: bool,
    ) -> Option<Self> {
        let centre = match (line.word(b'R'), line.word(b'I'), line.word(b'J')) {
            // The R form: the centre lies on the perpendicular bisector. A negative R means the longer arc.
            (Some(r), ..) => {
                let (r, d) = (r * scale, to - from);
                let length = d.length().max(1e-12);
                // No circle of this radius reaches from one end of the chord to the other.
                if 0.5 * length > r.abs() + OFF_CIRCLE_MM {
                    return None;
                }
                let h = (r * r - 0.25 * length * length).max(0.0).sqrt();
                let side = if clockwise == (r > 0.0) { -1.0 } else { 1.0 };
                from + 0.5 * d + DVec2::new(-d.y, d.x) * (side * h / length)
            }
            (None, Some(i), Some(j)) if absolute_centre => DVec2::new(i, j) * scale,
            (None, ..) if absolute_centre => return None,
            (None, i, j) => from + DVec2::new(i.unwrap_or(0.0), j.unwrap_or(0.0)) * scale,
        };
        let (u, v) = (from - centre, to - centre);
        let radius_mm = u.length();
        let off_mm = (v.length() - radius_mm).abs();
        let turns = line.word(b'P').unwrap_or(0.0).round();
        if radius_mm < 1e-9
            || off_mm > OFF_CIRCLE_MM + OFF_CIRCLE_SHARE * radius_mm
            || !(0.0..=MAX_TURNS).contains(&turns)
        {
            return None;
        }
        let start_rad = atan2(u.y, u.x);
        let mut sweep_rad = atan2(v.y, v.x) - start_rad;
        let turn = std::f64::consts::TAU;
        if clockwise && sweep_rad >= -1e-12 {
            sweep_rad -= turn;
        }
        // If start and end are equal, the arc is a full circle instead of an empty arc (NIST RS274/NGC, section 3.5.3).
        if !clockwise && sweep_rad <= 1e-12 {
            sweep_rad += turn;
        }
        // P is the number of full circles before the arc (Marlin), but `P1` of a circle is that circle (OrcaSlicer's lifts).
        let more = if from.distance(to) < 1e-9 { (turns - 1.0).max(0.0) } else { turns };
        sweep_rad += sweep_rad.signum() * turn * more;
        Some(Self { centre, radius_mm, start_rad, sweep_rad, end: to })
    }

    fn length_mm(&self) -> f64 {
        self.sweep_rad.abs() * self.radius_mm
    }

    /// The end points of `n` equal pieces; the last one is the given end of the arc.
    fn points(&self, n: usize) -> Vec<DVec2> {
        let point = |i: usize| {
            let (s, c) = sin_cos(self.start_rad + self.sweep_rad * i as f64 / n as f64);
            self.centre + DVec2::new(c, s) * self.radius_mm
        };
        (1..n).map(point).chain([self.end]).collect()
    }
}

/// The role that PrusaSlicer, its relatives or Cura call by this name.
fn role_named(name: &str) -> Role {
    if let Some(role) = Role::ALL.into_iter().find(|r| r.gcode_name() == name) {
        return role;
    }
    let lower = name.to_ascii_lowercase();
    let has = |word: &str| lower.contains(word);
    // The order matters: "support interface" contains "support", and "solid infill" contains "fill".
    if has("support") {
        if has("interface") { Role::SupportInterface } else { Role::Support }
    } else if has("skirt") || has("prime") || has("custom") || has("wipe") || has("raft") {
        Role::Skirt
    } else if has("brim") {
        Role::Brim
    // Internal bridges are solid infill inside the part.
    } else if has("bridge") && !has("internal") {
        Role::Bridge
    } else if has("gap") {
        Role::GapFill
    } else if has("thin") {
        Role::ThinWall
    } else if has("outer") || has("external") || has("overhang") {
        Role::OuterWall
    } else if has("inner") || has("perimeter") || has("wall") {
        Role::InnerWall
    } else if has("seed") {
        Role::SeedLine
    } else if has("top") {
        Role::TopSkin
    } else if has("solid") || has("skin") || has("bottom") {
        Role::SolidFill
    } else if has("fibre") || has("fiber") {
        Role::Fibre
    } else if has("fill") {
        Role::SparseFill
    } else {
        Role::OuterWall
    }
}

/// Role of a plain comment, as Simplify3D and old versions of PrusaSlicer write it.
fn plain_role(text: &str) -> Option<Role> {
    Some(match text {
        "outer perimeter" => Role::OuterWall,
        "inner perimeter" | "perimeter" => Role::InnerWall,
        "infill" => Role::SparseFill,
        "solid layer" | "internal single extrusion" | "external single extrusion" => Role::SolidFill,
        "gap fill" => Role::GapFill,
        "bridge" => Role::Bridge,
        "skirt" | "ooze shield" | "prime pillar" => Role::Skirt,
        "support" | "support material" => Role::Support,
        "brim" => Role::Brim,
        "dense support" => Role::SupportInterface,
        _ => return None,
    })
}
