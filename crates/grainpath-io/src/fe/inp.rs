//! Abaqus and CalculiX decks (.inp): the mesh, sets, surfaces, linear elastic material, supports and loads.
//!
//! Source: *CalculiX CrunchiX User's Manual*, "Input deck format"; *Abaqus Keywords Reference Guide*. A line with one asterisk
//! is a keyword with parameters, a line with two is a comment, and other lines are data. Names are compared in upper case.
//!
//! Keywords that do not change a linear analysis ([`HARMLESS`]) are skipped. Every other keyword that is not read is named in
//! a warning, since the result of the deck would differ. Units: a deck has none; the job states them.
//!
//! A load with an amplitude is read with the factor that its table has at the end of the step. A table in step time stays at
//! the end of the step that gave the load, and one in total time goes on, as in both manuals.

use std::collections::{BTreeMap, BTreeSet};

use super::bytes::Numbers;
use super::deck::{
    Behaviour, BodyForce, BodyLoad, Deck, Elastic, FaceLoad, Fixed, Material, PointLoad, Section, Step,
};
use super::element::ElementKind;
use super::model::{FeError, FeFile, FeFormat, Group, array_capacity, invalid, position};
use super::problem::FeProblem;
use grainpath_core::number::{number, whole};
use grainpath_core::{Warning, WarningId};

/// Keywords that do not change the linear problem, so that they need no warning.
const HARMLESS: [&str; 34] = [
    "NODEFILE",
    "ELFILE",
    "NODEPRINT",
    "ELPRINT",
    "NODEOUTPUT",
    "ELEMENTOUTPUT",
    "CONTACTFILE",
    "CONTACTPRINT",
    "SECTIONPRINT",
    "OUTPUT",
    "CONTACTOUTPUT",
    "ENERGYOUTPUT",
    "PREPRINT",
    "RESTART",
    "ENDSTEP",
    "ENDPART",
    "ENDINSTANCE",
    "ENDASSEMBLY",
    "END",
    "PART",
    "ASSEMBLY",
    "INSTANCE",
    "TIMEPOINTS",
    "CONTROLS",
    "SOLVERCONTROLS",
    "FILEFORMAT",
    "MONITOR",
    "PRINT",
    "SYSTEM",
    "DAMPING",
    "CONDUCTIVITY",
    "SPECIFICHEAT",
    "PHYSICALCONSTANTS",
    "USERMATERIAL",
];

/// A keyword, its parameters and its lines.
struct Block<'a> {
    keyword: String,
    parameters: Vec<(String, String)>,
    line: usize,
    data: Vec<(usize, &'a [u8])>,
}

impl Block<'_> {
    fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str())
    }

    fn has(&self, name: &str) -> bool {
        self.parameter(name).is_some()
    }

    /// A parameter that names something, in upper case.
    fn name(&self, parameter: &str) -> Option<String> {
        self.parameter(parameter).map(|v| v.trim_matches('"').to_ascii_uppercase()).filter(|v| !v.is_empty())
    }
}

/// Whether a load or a support removes those of its kind from earlier steps.
fn is_new(b: &Block<'_>) -> bool {
    b.parameter("OP").is_some_and(|op| op.trim().eq_ignore_ascii_case("NEW"))
}

fn place(line: usize) -> String {
    format!("line {line}")
}

fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(&bytes[..bytes.len().min(60)]).trim().to_owned()
}

/// Fields of a line. A comma at the end of the line opens no further field.
fn fields(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let trimmed = line.trim_ascii();
    let trimmed = trimmed.strip_suffix(b",").unwrap_or(trimmed);
    trimmed.split(|&b| b == b',').map(<[u8]>::trim_ascii)
}

/// A number as Fortran or C writes it. An empty field means 0, the default in both manuals.
fn value(line: usize, field: &[u8]) -> Result<f64, FeError> {
    if field.is_empty() {
        return Ok(0.0);
    }
    // Fortran writes double precision as `1.5D+03`.
    let fortran = || {
        let text: Vec<u8> = field.iter().map(|b| if matches!(b, b'd' | b'D') { b'e' } else { *b }).collect();
        number(&text)
    };
    let v = number(field).or_else(fortran).filter(|v| v.is_finite());
    v.ok_or_else(|| invalid(place(line), FeProblem::not_a(shown(field), "a number")))
}

fn integer(line: usize, field: &[u8]) -> Result<i64, FeError> {
    whole(field).ok_or_else(|| invalid(place(line), FeProblem::not_a(shown(field), "a whole number")))
}

/// Adds to a set and keeps it ascending. Blocks that follow each other are appended without sorting.
fn join(set: &mut Vec<u32>, more: Vec<u32>) {
    // Sets are searched by bisection in `section_of`, so they stay sorted and without duplicates.
    let follows = more.is_sorted_by(|a, b| a < b) && set.last() < more.first();
    set.extend(more);
    if !follows {
        set.sort_unstable();
        set.dedup();
    }
}

/// How many loads at the head of each list of a step were kept from earlier steps.
#[derive(Debug, Clone, Copy, Default)]
struct CarriedLoads {
    points: usize,
    faces: usize,
    bodies: usize,
}

/// Removes the entries among the first `n` for which `is_replaced` holds. Returns how many of the `n` remain.
fn retain_carried<T>(all: &mut Vec<T>, n: usize, is_replaced: impl Fn(&T) -> bool) -> usize {
    let (mut at, before) = (0, all.len());
    all.retain(|entry| {
        at += 1;
        at > n || !is_replaced(entry)
    });
    n - (before - all.len())
}

/// A tabular amplitude: factors over time.
struct Amplitude {
    in_total_time: bool,
    /// Times, ascending, with their factors.
    points: Vec<(f64, f64)>,
}

impl Amplitude {
    /// The factor at a time: linear between points, that of the nearest point before the first and behind the last, and the
    /// later one where two points have the same time.
    fn at(&self, time: f64) -> f64 {
        let after = self.points.partition_point(|p| p.0 <= time);
        match (self.points[..after].last(), self.points.get(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * ((time - a.0) / (b.0 - a.0)),
            (Some(end), None) | (None, Some(end)) => end.1,
            (None, None) => 1.0,
        }
    }
}

/// An amplitude as a load refers to it.
struct Ramp {
    /// Index into the amplitudes.
    amplitude: usize,
    /// Time by which the table is shifted.
    delay: f64,
    /// The step that gave the load.
    step: usize,
    /// Name for a warning: "CLOAD, AMPLITUDE=A".
    name: String,
}

/// A load or support with the index of its ramp; `None` for one at full size.
type Ramped<T> = (T, Option<u32>);

/// A step whose loads have not been multiplied by their amplitudes yet.
#[derive(Default)]
struct OpenStep {
    /// The step without its lists.
    step: Step,
    /// Its duration.
    period: f64,
    is_perturbation: bool,
    fixed: Vec<Ramped<Fixed>>,
    points: Vec<Ramped<PointLoad>>,
    faces: Vec<Ramped<FaceLoad>>,
    bodies: Vec<Ramped<BodyLoad>>,
}

/// State of the reader.
struct Inp {
    file: FeFile,
    deck: Deck,
    steps: Vec<OpenStep>,
    /// Index of each amplitude by its name; `None` for one that cannot be evaluated.
    amplitude_names: BTreeMap<String, Option<usize>>,
    amplitudes: Vec<Amplitude>,
    ramps: Vec<Ramp>,
    /// Whether the total time is known in all steps.
    has_clock: bool,
    nodes: Numbers,
    elements: Numbers,
    /// Number of entries that sets and loads may still add.
    capacity: usize,
    /// The material to which ELASTIC and DENSITY belong.
    material: Option<usize>,
    in_step: bool,
    /// Loads of the current step that were kept from earlier steps.
    carried: CarriedLoads,
    parts: usize,
}

pub(crate) fn read(bytes: &[u8]) -> Result<FeFile, FeError> {
    let mut inp = Inp {
        file: FeFile::empty(FeFormat::Inp),
        deck: Deck::default(),
        steps: Vec::new(),
        amplitude_names: BTreeMap::new(),
        amplitudes: Vec::new(),
        ramps: Vec::new(),
        has_clock: true,
        nodes: Numbers::default(),
        elements: Numbers::default(),
        capacity: array_capacity(bytes.len()),
        material: None,
        in_step: false,
        carried: CarriedLoads::default(),
        parts: 0,
    };
    let mut lines = bytes.split(|&b| b == b'\n').enumerate().map(|(i, l)| (i + 1, l.trim_ascii()));
    let mut block: Option<Block<'_>> = None;
    while let Some((n, line)) = lines.next() {
        // Empty lines and comments may stand anywhere, also inside data.
        if line.is_empty() || line.starts_with(b"**") {
            continue;
        }
        if line[0] != b'*' {
            if let Some(b) = &mut block {
                b.data.push((n, line));
            }
            continue;
        }
        if let Some(b) = block.take() {
            inp.block(&b)?;
        }
        let mut text = String::from_utf8_lossy(&line[1..]).into_owned();
        // A keyword line that ends in a comma goes on in the next line.
        while text.trim_end().ends_with(',') {
            match lines.next() {
                Some((_, more)) if !more.is_empty() && more[0] != b'*' => {
                    text += &String::from_utf8_lossy(more);
                }
                _ => break,
            }
        }
        block = Some(keyword(&text, n));
    }
    if let Some(b) = block.take() {
        inp.block(&b)?;
    }
    Ok(inp.finish())
}

fn keyword(text: &str, line: usize) -> Block<'static> {
    let mut parts = text.split(',');
    // Blanks and case do not count: `*Node File` and `*NODEFILE` are the same keyword.
    let squeeze = |s: &str| s.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    let keyword = squeeze(parts.next().unwrap_or_default());
    let parameter = |p: &str| {
        let (name, value) = p.split_once('=').unwrap_or((p, ""));
        (squeeze(name), value.trim().to_owned())
    };
    let parameters = parts.map(parameter).filter(|(n, _)| !n.is_empty()).collect();
    Block { keyword, parameters, line, data: Vec::new() }
}

impl Inp {
    fn block(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        match b.keyword.as_str() {
            "HEADING" => self.deck.heading = b.data.first().map(|(_, l)| shown(l)).unwrap_or_default(),
            "NODE" => self.node_block(b)?,
            "ELEMENT" => self.element_block(b)?,
            "NSET" => self.set(b, true)?,
            "ELSET" => self.set(b, false)?,
            "SURFACE" => self.surface(b)?,
            "MATERIAL" => {
                let name = b.name("NAME").unwrap_or_default();
                self.material = Some(self.deck.materials.len());
                // ELASTIC and DENSITY are keywords of their own; they belong to the last MATERIAL before
                // them.
                self.deck.materials.push(Material { name, elastic: None, density: None });
            }
            "ELASTIC" => self.elastic(b)?,
            "DENSITY" => {
                let rho = match b.data.first() {
                    Some((n, l)) => fields(l).next().map(|f| value(*n, f)).transpose()?,
                    None => None,
                };
                if let Some(m) = self.material.and_then(|i| self.deck.materials.get_mut(i)) {
                    m.density = rho;
                }
            }
            "SOLIDSECTION" | "SHELLSECTION" | "MEMBRANESECTION" => {
                let thickness = match b.data.first() {
                    Some((n, l)) => {
                        fields(l).next().filter(|f| !f.is_empty()).map(|f| value(*n, f)).transpose()?
                    }
                    None => None,
                };
                // For solids the first number is an attribute that is not a thickness; solids ignore it.
                self.deck.sections.push(Section {
                    elements: b.name("ELSET").unwrap_or_default(),
                    material: b.name("MATERIAL").unwrap_or_default(),
                    thickness,
                });
                if b.has("ORIENTATION") {
                    // Orthotropic constants would be used along the wrong axes, so the user is warned.
                    self.ignore("ORIENTATION");
                }
            }
            "STEP" => self.begin_step(b)?,
            "ENDSTEP" => self.in_step = false,
            "STATIC"
            | "FREQUENCY"
            | "BUCKLE"
            | "DYNAMIC"
            | "MODALDYNAMIC"
            | "STEADYSTATEDYNAMICS"
            | "HEATTRANSFER"
            | "VISCO"
            | "COUPLEDTEMPERATURE-DISPLACEMENT" => {
                self.procedure(b)?;
            }
            "AMPLITUDE" => self.amplitude(b)?,
            // A stress that is there before any load; values of other kinds say nothing to a static step.
            "INITIALCONDITIONS" => {
                let kind = b.name("TYPE").unwrap_or_default();
                self.ignore(&format!("INITIALCONDITIONS, TYPE={kind}"));
            }
            "BOUNDARY" => self.boundary(b)?,
            "CLOAD" => self.cload(b)?,
            "DLOAD" => self.dload(b)?,
            "DSLOAD" => self.dsload(b)?,
            "INCLUDE" => {
                let what = format!("{}: *INCLUDE", place(b.line));
                // A second file would have to be opened, and readers work on bytes alone.
                return Err(FeError::Unsupported { what, reads: "decks in one file" });
            }
            "PART" => {
                self.parts += 1;
                if self.parts > 1 {
                    // Each part numbers its nodes from 1, so two parts in one list would mix them up.
                    let what = format!("{}: a second *PART", place(b.line));
                    return Err(FeError::Unsupported { what, reads: "decks of one part" });
                }
            }
            // An instance with data lines is moved or rotated, and the mesh is read where its part
            // stands.
            "INSTANCE" if !b.data.is_empty() => self.ignore("INSTANCE (its place)"),
            k if HARMLESS.contains(&k) => {}
            other => self.ignore(other),
        }
        Ok(())
    }

    /// Opens a step. Loads stay from step to step until another value replaces them or `OP=NEW` removes them; a perturbation
    /// step has only its own loads.
    fn begin_step(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        let mut open = OpenStep {
            step: Step { nlgeom: b.has("NLGEOM"), ..Step::default() },
            is_perturbation: b.has("PERTURBATION"),
            // Source: the default of both manuals.
            period: 1.0,
            ..OpenStep::default()
        };
        // Loads of the step before act on until they are given anew.
        if let Some(before) = self.steps.last().filter(|_| !open.is_perturbation) {
            open.points.clone_from(&before.points);
            open.faces.clone_from(&before.faces);
            open.bodies.clone_from(&before.bodies);
        }
        let [points, faces, bodies] = [open.points.len(), open.faces.len(), open.bodies.len()];
        self.take_capacity(points + faces + bodies, b.line)?;
        self.carried = CarriedLoads { points, faces, bodies };
        self.steps.push(open);
        self.in_step = true;
        Ok(())
    }

    /// The procedure of a step. It is stored because only a linear static step can be compared; its second number is the
    /// duration, which amplitudes need.
    fn procedure(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        let period = match (b.keyword.as_str(), b.data.first()) {
            // These find eigenvalues or the like; no time passes.
            ("FREQUENCY" | "BUCKLE" | "STEADYSTATEDYNAMICS", _) => 0.0,
            (_, Some((n, line))) => match fields(line).nth(1) {
                Some(field) => Some(value(*n, field)?).filter(|t| *t > 0.0).unwrap_or(1.0),
                None => 1.0,
            },
            (_, None) => 1.0,
        };
        // These set the total time anew, or measure the step by another length.
        if ["TIMERESET", "TOTALTIMEATSTART", "RIKS"].iter().any(|p| b.has(p)) {
            self.has_clock = false;
        }
        if let Some(open) = self.steps.last_mut() {
            open.step.procedure = b.keyword.clone();
            open.period = period;
        }
        Ok(())
    }

    /// A tabular amplitude. One that is not a plain table of factors is kept by its name alone, so that loads that use it are
    /// named as not read.
    fn amplitude(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        let word =
            |v: &str| v.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
        let mut in_total_time = false;
        let mut is_table = true;
        for (name, v) in &b.parameters {
            match (name.as_str(), word(v).as_str()) {
                ("NAME", _) | ("TIME", "STEPTIME") | ("DEFINITION", "TABULAR") | ("VALUE", "RELATIVE") => {}
                ("TIME", "TOTALTIME") => in_total_time = true,
                _ => is_table = false,
            }
        }
        let mut points = Vec::new();
        let lines = if is_table { b.data.as_slice() } else { &[] };
        for &(n, line) in lines {
            let all: Vec<&[u8]> = fields(line).collect();
            // A line holds up to four pairs; blanks end it.
            for pair in all.chunks(2).take_while(|pair| pair.iter().any(|f| !f.is_empty())) {
                is_table &= pair.len() == 2;
                points.push((value(n, pair[0])?, value(n, pair.get(1).copied().unwrap_or_default())?));
            }
        }
        is_table &= !points.is_empty() && points.is_sorted_by(|a, b| a.0 <= b.0);
        // What is not read keeps its name, so that a load that uses it is refused by this name.
        let index = is_table.then_some(self.amplitudes.len());
        if is_table {
            self.amplitudes.push(Amplitude { in_total_time, points });
        }
        self.amplitude_names.insert(b.name("NAME").unwrap_or_default(), index);
        Ok(())
    }

    /// The ramp of a block of loads or supports; `None` without an amplitude. An amplitude that cannot be evaluated is named
    /// as not read.
    fn ramp(&mut self, b: &Block<'_>) -> Option<u32> {
        let amplitude = b.name("AMPLITUDE")?;
        let name = format!("{}, AMPLITUDE={amplitude}", b.keyword);
        let delay = b.parameter("TIMEDELAY").map_or(Some(0.0), |t| value(b.line, t.trim().as_bytes()).ok());
        let index = self.amplitude_names.get(&amplitude).copied().flatten();
        // No time passes in a perturbation, nor before the first step.
        let step =
            self.steps.len().checked_sub(1).filter(|&i| self.in_step && !self.steps[i].is_perturbation);
        let (Some(amplitude), Some(delay), Some(step)) = (index, delay, step) else {
            self.ignore(&name);
            return None;
        };
        self.ramps.push(Ramp { amplitude, delay, step, name });
        Some((self.ramps.len() - 1) as u32)
    }

    /// Lists, for a warning, the unread parameters of a load or a support that change its meaning.
    fn ignore_parameters(&mut self, b: &Block<'_>) {
        for (name, value) in &b.parameters {
            let is_read = match name.as_str() {
                // [`Self::ramp`] reads the latter two.
                "OP" | "AMPLITUDE" | "TIMEDELAY" => true,
                "TYPE" => b.keyword == "BOUNDARY" && value.trim().eq_ignore_ascii_case("DISPLACEMENT"),
                _ => false,
            };
            if !is_read {
                self.ignore(&format!("{}, {name}", b.keyword));
            }
        }
    }

    fn ignore(&mut self, keyword: &str) {
        // A hundred names are more than anyone reads; the bound limits the length of the warning.
        if !self.deck.ignored.iter().any(|k| k == keyword) && self.deck.ignored.len() < 100 {
            self.deck.ignored.push(keyword.chars().take(60).collect());
        }
    }

    /// Takes `n` entries of sets and loads from the budget.
    fn take_capacity(&mut self, n: usize, line: usize) -> Result<(), FeError> {
        self.capacity = self
            .capacity
            .checked_sub(n)
            .ok_or_else(|| invalid(place(line), FeProblem::Bomb("sets and loads")))?;
        Ok(())
    }

    fn node_block(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        let set = b.name("NSET");
        let mut added = Vec::new();
        for &(n, line) in &b.data {
            let mut all = fields(line);
            let node = integer(n, all.next().unwrap_or_default())?;
            let mut p = [0.0; 3];
            // Missing coordinates are 0; a plane deck may leave z out.
            for (c, f) in p.iter_mut().zip(all) {
                *c = value(n, f)?;
            }
            let p = position(p, || place(n))?;
            let index = match self.nodes.insert(node) {
                Some(index) => {
                    self.file.nodes.push(p);
                    self.deck.node_numbers.push(node);
                    index
                }
                // Both manuals let a node that is given again replace the first one.
                None => {
                    let index = self.nodes.get(node).ok_or(FeError::NoNodes)?;
                    self.file.nodes[index as usize] = p;
                    index
                }
            };
            added.push(index);
        }
        if let Some(name) = set {
            join(self.deck.node_sets.entry(name).or_default(), added);
        }
        Ok(())
    }

    fn element_block(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        let kind_name = b.name("TYPE").unwrap_or_default();
        let (kind, behaviour) = element_kind(&kind_name);
        let set = b.name("ELSET");
        let mut added = Vec::new();
        let mut lines = b.data.iter();
        let mut nodes = Vec::new();
        while let Some(&(n, line)) = lines.next() {
            let mut all = fields(line);
            let element = integer(n, all.next().unwrap_or_default())?;
            nodes.clear();
            let mut read = |n: usize, field: &[u8]| -> Result<(), FeError> {
                let node = integer(n, field)?;
                let index = self.nodes.get(node);
                nodes.push(index.ok_or_else(|| FeError::NoSuchNode { element: element.to_string(), node })?);
                Ok(())
            };
            for f in all {
                read(n, f)?;
            }
            // Elements with many nodes go on in further lines. For a kind that is not read the number of
            // nodes is unknown, so the comma at the end of the line decides.
            let mut goes_on = line.ends_with(b",");
            let wanted = kind.map(ElementKind::n_nodes).unwrap_or(0);
            while nodes.len() < wanted || (wanted == 0 && goes_on) {
                let Some(&(n, line)) = lines.next() else { break };
                let mut read = |field: &[u8]| -> Result<(), FeError> {
                    let node = integer(n, field)?;
                    let index = self.nodes.get(node);
                    nodes.push(
                        index.ok_or_else(|| FeError::NoSuchNode { element: element.to_string(), node })?,
                    );
                    Ok(())
                };
                for f in fields(line) {
                    read(f)?;
                }
                goes_on = line.ends_with(b",");
            }
            if nodes.len() < wanted {
                let (found, kind) = (nodes.len(), kind_name.to_string());
                let problem = FeProblem::ElementNodes { element, found, kind, wanted };
                return Err(invalid(place(n), problem));
            }
            // Elements that are not read get no index: loads and sets that name them skip them.
            if self.file.add(kind, &nodes) {
                let Some(index) = self.elements.insert(element) else {
                    return Err(invalid(place(n), FeProblem::ElementTwice(element)));
                };
                self.deck.element_numbers.push(element);
                self.deck.behaviours.push(behaviour);
                added.push(index);
            }
        }
        if let Some(name) = set {
            join(self.deck.element_sets.entry(name).or_default(), added);
        }
        Ok(())
    }

    fn set(&mut self, b: &Block<'_>, of_nodes: bool) -> Result<(), FeError> {
        let parameter = if of_nodes { "NSET" } else { "ELSET" };
        let Some(name) = b.name(parameter) else {
            return Err(invalid(place(b.line), FeProblem::NeedsName(parameter)));
        };
        let mut found = Vec::new();
        for &(n, line) in &b.data {
            let all: Vec<&[u8]> = fields(line).filter(|f| !f.is_empty()).collect();
            // GENERATE lists first, last and step of a range of numbers.
            if b.has("GENERATE") {
                let low = integer(n, all.first().copied().unwrap_or_default())?;
                let high = integer(n, all.get(1).copied().unwrap_or_default())?;
                let step = all.get(2).map_or(Ok(1), |f| integer(n, f))?.max(1);
                let (numbers, known) = if of_nodes {
                    (&self.deck.node_numbers, &self.nodes)
                } else {
                    (&self.deck.element_numbers, &self.elements)
                };
                let before = found.len();
                // A range may span far more numbers than exist (1 to 10^9), so the loop runs over the range or over the
                // file's numbers, whichever is shorter.
                if high.saturating_sub(low) / step <= numbers.len() as i64 {
                    let mut at = low;
                    while at <= high {
                        found.extend(known.get(at));
                        at += step;
                    }
                } else {
                    let inside = |&(_, v): &(usize, &i64)| (low..=high).contains(v) && (v - low) % step == 0;
                    found.extend(numbers.iter().enumerate().filter(inside).map(|(i, _)| i as u32));
                }
                self.take_capacity(found.len() - before + 1, n)?;
                continue;
            }
            for f in all {
                match whole(f) {
                    // Unknown numbers are skipped: a set may name nodes of no element and elements that
                    // were not read.
                    Some(v) => found.extend(if of_nodes { self.nodes.get(v) } else { self.elements.get(v) }),
                    None => {
                        let sets = if of_nodes { &self.deck.node_sets } else { &self.deck.element_sets };
                        // A set may hold other sets, which must come first.
                        let other = sets.get(&shown(f).to_ascii_uppercase());
                        let other =
                            other.ok_or_else(|| invalid(place(n), FeProblem::NoSetBefore(shown(f))))?;
                        // Sets of sets double with each line, so their size counts against the budget.
                        found.extend_from_slice(other);
                        let taken = other.len();
                        self.take_capacity(taken, n)?;
                    }
                }
            }
        }
        let sets = if of_nodes { &mut self.deck.node_sets } else { &mut self.deck.element_sets };
        join(sets.entry(name).or_default(), found);
        Ok(())
    }

    fn surface(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        let name = b.name("NAME").unwrap_or_default();
        // A surface of nodes is a node set: it has no faces that a pressure could act on.
        if b.name("TYPE").is_some_and(|t| t == "NODE") {
            let mut nodes = Vec::new();
            for &(n, line) in &b.data {
                nodes.extend(self.nodes_named(n, fields(line).next().unwrap_or_default())?);
            }
            join(self.deck.node_sets.entry(name).or_default(), nodes);
            return Ok(());
        }
        let mut faces = Vec::new();
        for &(n, line) in &b.data {
            let mut all = fields(line);
            let elements = self.elements_named(n, all.next().unwrap_or_default())?;
            // Without a label Abaqus takes all free faces; such surfaces are rare and not read.
            let Some(label) = all.next() else {
                self.ignore("SURFACE of all free faces");
                continue;
            };
            for e in elements {
                faces.push((e, self.face(n, e, label)?));
            }
        }
        self.deck.surfaces.entry(name).or_default().extend(faces);
        Ok(())
    }

    /// Index of the face that a label such as `S3` or `P3` names.
    fn face(&self, line: usize, element: u32, label: &[u8]) -> Result<u8, FeError> {
        let kind = self.file.elements[element as usize].kind;
        let n = label.get(1..).and_then(whole).filter(|&n| n >= 1 && n as usize <= kind.faces().len());
        let known = label.first().is_some_and(|c| matches!(c.to_ascii_uppercase(), b'S' | b'P'));
        match n {
            Some(n) if known => Ok((n - 1) as u8),
            _ => Err(invalid(place(line), FeProblem::NotAFace { found: shown(label), element: kind.name() })),
        }
    }

    fn nodes_named(&mut self, line: usize, field: &[u8]) -> Result<Vec<u32>, FeError> {
        let found = match whole(field) {
            Some(v) => vec![self.nodes.get(v).ok_or_else(|| invalid(place(line), FeProblem::NoNode(v)))?],
            None => {
                let set = self.deck.node_sets.get(&shown(field).to_ascii_uppercase());
                set.ok_or_else(|| invalid(place(line), FeProblem::no("node set", shown(field))))?.clone()
            }
        };
        self.take_capacity(found.len(), line)?;
        Ok(found)
    }

    fn elements_named(&mut self, line: usize, field: &[u8]) -> Result<Vec<u32>, FeError> {
        let found = match whole(field) {
            // Elements that were left out carry no loads.
            Some(v) => self.elements.get(v).into_iter().collect(),
            None => {
                let set = self.deck.element_sets.get(&shown(field).to_ascii_uppercase());
                set.ok_or_else(|| invalid(place(line), FeProblem::no("element set", shown(field))))?.clone()
            }
        };
        self.take_capacity(found.len(), line)?;
        Ok(found)
    }

    fn elastic(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        let kind = b.name("TYPE").unwrap_or_else(|| "ISO".into()).replace(' ', "");
        let mut all = Vec::new();
        // Engineering constants take two lines: eight values, then the ninth. Further lines are other
        // temperatures.
        for &(n, line) in b.data.iter().take(2) {
            for f in fields(line) {
                all.push(value(n, f)?);
            }
        }
        let elastic = match (kind.as_str(), all.as_slice()) {
            ("ISO" | "ISOTROPIC", [e, nu, ..]) => Some(Elastic::Isotropic { e: *e, nu: *nu }),
            ("ENGINEERINGCONSTANTS", [e1, e2, e3, n12, n13, n23, g12, g13, g23, ..]) => {
                Some(Elastic::Orthotropic {
                    e: [*e1, *e2, *e3],
                    nu: [*n12, *n13, *n23],
                    g: [*g12, *g13, *g23],
                })
            }
            _ => {
                self.ignore(&format!("ELASTIC, TYPE={kind}"));
                None
            }
        };
        if let Some(m) = self.material.and_then(|i| self.deck.materials.get_mut(i)) {
            m.elastic = elastic;
        }
        Ok(())
    }

    fn boundary(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        self.ignore_parameters(b);
        let ramp = self.ramp(b);
        let mut fixed = Vec::new();
        for &(n, line) in &b.data {
            let all: Vec<&[u8]> = fields(line).collect();
            let nodes = self.nodes_named(n, all[0])?;
            let word = all.get(1).copied().unwrap_or_default();
            // Named supports as the Abaqus manual defines them: XSYMM is symmetry about a plane of
            // constant x, so it holds x and the rotations about y and z.
            let (axes, v): (Vec<u8>, f64) = match word.to_ascii_uppercase().as_slice() {
                b"ENCASTRE" => ((0..6).collect(), 0.0),
                b"PINNED" => (vec![0, 1, 2], 0.0),
                b"XSYMM" => (vec![0, 4, 5], 0.0),
                b"YSYMM" => (vec![1, 3, 5], 0.0),
                b"ZSYMM" => (vec![2, 3, 4], 0.0),
                _ => {
                    let first = integer(n, word)?;
                    let last = match all.get(2) {
                        Some(f) if !f.is_empty() => integer(n, f)?,
                        _ => first,
                    };
                    let v = all.get(3).map_or(Ok(0.0), |f| value(n, f))?;
                    // Degrees of freedom above 6 are temperatures and other fields, which carry no force.
                    (((first.max(1))..=last.min(6)).map(|d| (d - 1) as u8).collect(), v)
                }
            };
            self.take_capacity(nodes.len() * axes.len(), n)?;
            fixed.extend(
                nodes.iter().flat_map(|&node| axes.iter().map(move |&axis| Fixed { node, axis, value: v })),
            );
        }
        // Supports before the first step hold in all steps.
        match self.steps.last_mut() {
            Some(open) if self.in_step => {
                // Only the first such block of a step removes what was before.
                if is_new(b) && open.fixed.is_empty() {
                    open.step.releases = true;
                }
                open.fixed.extend(fixed.into_iter().map(|f| (f, ramp)));
            }
            _ => self.deck.fixed.extend(fixed),
        }
        Ok(())
    }

    fn step(&mut self, b: &Block<'_>) -> Result<&mut OpenStep, FeError> {
        let line = b.line;
        let keyword = &b.keyword;
        self.steps.last_mut().ok_or_else(|| invalid(place(line), FeProblem::BeforeStep(keyword.clone())))
    }

    fn cload(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        self.ignore_parameters(b);
        let ramp = self.ramp(b);
        let mut loads = Vec::new();
        for &(n, line) in &b.data {
            let all: Vec<&[u8]> = fields(line).collect();
            let nodes = self.nodes_named(n, all[0])?;
            let axis = integer(n, all.get(1).copied().unwrap_or_default())?;
            // Other numbers are fluxes and temperatures.
            if !(1..=6).contains(&axis) {
                continue;
            }
            let value = value(n, all.get(2).copied().unwrap_or_default())?;
            let load = |node| (PointLoad { node, axis: (axis - 1) as u8, value }, ramp);
            loads.extend(nodes.into_iter().map(load));
        }
        let mut carried = self.carried.points;
        let all = &mut self.step(b)?.points;
        let given: BTreeSet<(u32, u8)> = loads.iter().map(|(l, _)| (l.node, l.axis)).collect();
        carried = retain_carried(all, carried, |(l, _)| is_new(b) || given.contains(&(l.node, l.axis)));
        all.extend(loads);
        self.carried.points = carried;
        Ok(())
    }

    fn dload(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        self.ignore_parameters(b);
        let ramp = self.ramp(b);
        let (mut faces, mut bodies) = (Vec::new(), Vec::new());
        for &(n, line) in &b.data {
            let all: Vec<&[u8]> = fields(line).collect();
            let elements = self.elements_named(n, all[0])?;
            let label = all.get(1).copied().unwrap_or_default().to_ascii_uppercase();
            let number_at = |i: usize| value(n, all.get(i).copied().unwrap_or_default());
            match label.as_slice() {
                // GRAV: magnitude, then a direction whose length counts.
                b"GRAV" => {
                    let g = number_at(2)?;
                    let direction = [number_at(3)?, number_at(4)?, number_at(5)?];
                    let acceleration = direction.map(|c| c * g);
                    let force = BodyForce::Gravity(acceleration);
                    bodies.extend(elements.into_iter().map(|element| (BodyLoad { element, force }, ramp)));
                }
                // CENTRIF: the square of the speed, a point of the axis, its direction.
                b"CENTRIF" => {
                    let mut at = [0.0; 7];
                    for (i, v) in at.iter_mut().enumerate() {
                        *v = number_at(2 + i)?;
                    }
                    let [speed_squared, point @ .., a, b, c] = at;
                    let force = BodyForce::Centrifugal { speed_squared, point, axis: [a, b, c] };
                    bodies.extend(elements.into_iter().map(|element| (BodyLoad { element, force }, ramp)));
                }
                // `P` and the number of a face. `PFILM` and the like are no pressures.
                [b'P', rest @ ..] if !rest.is_empty() && rest.iter().all(u8::is_ascii_digit) => {
                    let pressure = number_at(2)?;
                    for element in elements {
                        let face = self.face(n, element, &label)?;
                        faces.push((FaceLoad { element, face, pressure }, ramp));
                    }
                }
                other => self.ignore(&format!("DLOAD {}", shown(other))),
            }
        }
        self.add_face_loads(b, faces)?;
        let mut carried = self.carried.bodies;
        let all = &mut self.step(b)?.bodies;
        let kind = |(l, _): &Ramped<BodyLoad>| (l.element, matches!(l.force, BodyForce::Gravity(_)));
        let given: BTreeSet<(u32, bool)> = bodies.iter().map(kind).collect();
        carried = retain_carried(all, carried, |l| is_new(b) || given.contains(&kind(l)));
        all.extend(bodies);
        self.carried.bodies = carried;
        Ok(())
    }

    /// Pressures of a DLOAD or DSLOAD. They replace those of earlier steps on the same faces.
    fn add_face_loads(&mut self, b: &Block<'_>, faces: Vec<Ramped<FaceLoad>>) -> Result<(), FeError> {
        let mut carried = self.carried.faces;
        let all = &mut self.step(b)?.faces;
        let given: BTreeSet<(u32, u8)> = faces.iter().map(|(l, _)| (l.element, l.face)).collect();
        carried = retain_carried(all, carried, |(l, _)| is_new(b) || given.contains(&(l.element, l.face)));
        all.extend(faces);
        self.carried.faces = carried;
        Ok(())
    }

    fn dsload(&mut self, b: &Block<'_>) -> Result<(), FeError> {
        self.ignore_parameters(b);
        let ramp = self.ramp(b);
        let mut loads = Vec::new();
        for &(n, line) in &b.data {
            let all: Vec<&[u8]> = fields(line).collect();
            let name = shown(all[0]).to_ascii_uppercase();
            let Some(faces) = self.deck.surfaces.get(&name).cloned() else {
                return Err(invalid(place(n), FeProblem::no("surface", name)));
            };
            self.take_capacity(faces.len(), n)?;
            // Other labels are tractions with directions of their own.
            if !all.get(1).is_some_and(|l| l.eq_ignore_ascii_case(b"P")) {
                self.ignore("DSLOAD other than P");
                continue;
            }
            let pressure = value(n, all.get(2).copied().unwrap_or_default())?;
            let load = |(element, face)| (FaceLoad { element, face, pressure }, ramp);
            loads.extend(faces.into_iter().map(load));
        }
        self.add_face_loads(b, loads)
    }

    /// The steps with their loads multiplied by their amplitudes at the end of the step.
    fn close_steps(&mut self) {
        let steps = std::mem::take(&mut self.steps);
        let periods: Vec<f64> = steps.iter().map(|open| open.period).collect();
        // Factors are known only now: a table may follow the loads that name it, and total time adds up over the steps.
        let mut total_time = 0.0;
        for open in steps {
            total_time += open.period;
            let factor = |ramp: Option<u32>| {
                let Some(ramp) = ramp.map(|i| &self.ramps[i as usize]) else { return 1.0 };
                let amplitude = &self.amplitudes[ramp.amplitude];
                let time = if amplitude.in_total_time { total_time } else { periods[ramp.step] };
                amplitude.at(time - ramp.delay)
            };
            let mut step = open.step;
            step.fixed =
                open.fixed.iter().map(|(f, r)| Fixed { value: f.value * factor(*r), ..*f }).collect();
            let scaled = |(l, r): &Ramped<PointLoad>| PointLoad { value: l.value * factor(*r), ..*l };
            step.point_loads = open.points.iter().map(scaled).collect();
            let scaled = |(l, r): &Ramped<FaceLoad>| FaceLoad { pressure: l.pressure * factor(*r), ..*l };
            step.face_loads = open.faces.iter().map(scaled).collect();
            let scaled = |(l, r): &Ramped<BodyLoad>| {
                let by = factor(*r);
                let force = match l.force {
                    BodyForce::Gravity(a) => BodyForce::Gravity(a.map(|c| c * by)),
                    BodyForce::Centrifugal { speed_squared, point, axis } => {
                        BodyForce::Centrifugal { speed_squared: speed_squared * by, point, axis }
                    }
                };
                BodyLoad { element: l.element, force }
            };
            step.body_loads = open.bodies.iter().map(scaled).collect();
            self.deck.steps.push(step);
        }
        if !self.has_clock {
            let in_total_time = |ramp: &Ramp| self.amplitudes[ramp.amplitude].in_total_time;
            let unknown: Vec<String> =
                self.ramps.iter().filter(|r| in_total_time(r)).map(|r| r.name.clone()).collect();
            unknown.iter().for_each(|name| self.ignore(name));
        }
    }

    fn finish(mut self) -> FeFile {
        self.close_steps();
        // Supports in a job may name these sets.
        for (name, nodes) in &self.deck.node_sets {
            self.file.groups.push(Group { name: name.clone(), nodes: nodes.clone() });
        }
        if !self.deck.ignored.is_empty() {
            let text = format!("not read: *{}", self.deck.ignored.join(", *"));
            self.file.warnings.push(Warning::new(WarningId::FeLeftOut, text));
        }
        self.file.deck = Some(Box::new(self.deck));
        self.file
    }
}

/// The kind of an element from its Abaqus name: family, number of nodes, variant (`C3D10R` is a solid
/// with 10 nodes).
fn element_kind(name: &str) -> (Result<ElementKind, &'static str>, Behaviour) {
    use ElementKind::{Hex8, Hex20, Pyramid5, Quad4, Quad8, Quad9, Tet4, Tet10, Tri3, Tri6, Wedge6, Wedge15};
    // Longer prefixes come before `S`, which would match `SC8R` and `SFM3D4` too.
    const FAMILIES: [(&str, Behaviour); 11] = [
        ("C3D", Behaviour::Solid),
        ("DC3D", Behaviour::Solid),
        ("AC3D", Behaviour::Solid),
        ("CPS", Behaviour::PlaneStress),
        ("CPE", Behaviour::PlaneStrain),
        ("CAX", Behaviour::Axisymmetric),
        ("M3D", Behaviour::Shell),
        ("SC", Behaviour::Solid),
        ("SFM3D", Behaviour::Shell),
        ("STRI", Behaviour::Shell),
        ("S", Behaviour::Shell),
    ];
    let family = FAMILIES.iter().find_map(|(f, b)| {
        let rest = name.strip_prefix(f)?;
        let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
        Some((*b, rest[..digits].parse::<usize>().ok()?))
    });
    let Some((behaviour, n)) = family else {
        // These have two or three nodes and no cross-section in the mesh; they are counted as lines are.
        let beam = ["B2", "B3", "T2", "T3", "PIPE"].iter().any(|b| name.starts_with(b));
        let what = if beam { "beams and trusses" } else { "of kinds grainpath does not read" };
        return (Err(what), Behaviour::Solid);
    };
    let kind = match (behaviour, n) {
        (Behaviour::Solid, 4) => Ok(Tet4),
        (Behaviour::Solid, 5) => Ok(Pyramid5),
        (Behaviour::Solid, 6) => Ok(Wedge6),
        (Behaviour::Solid, 8) => Ok(Hex8),
        (Behaviour::Solid, 10) => Ok(Tet10),
        (Behaviour::Solid, 15) => Ok(Wedge15),
        // C3D27 begins with the nodes of C3D20; nodes inside faces and the volume are dropped.
        (Behaviour::Solid, 20 | 27) => Ok(Hex20),
        (Behaviour::Solid, _) => Err("of kinds grainpath does not read"),
        (_, 3) => Ok(Tri3),
        (_, 4) => Ok(Quad4),
        (_, 6) => Ok(Tri6),
        (_, 8) => Ok(Quad8),
        (_, 9) => Ok(Quad9),
        _ => Err("of kinds grainpath does not read"),
    };
    (kind, behaviour)
}
