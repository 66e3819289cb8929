//! SVG: filled shapes, closed lines, transforms, and those style properties that decide what is filled.
//!
//! Source: W3C, *Scalable Vector Graphics 1.1 (Second Edition)*. Read are `path`, `rect`, `circle`, `ellipse`, `line`,
//! `polygon` and `polyline`, nested groups, `transform`, and `fill`, `fill-rule`, `display` and `visibility` as attributes,
//! in `style` or in style sheet rules for a single class. Text, images and clones (`use`) are named in a warning; stroke
//! widths, clips and markers are ignored.
//!
//! Units: the page's size over its view box gives the unit; pixels are 1/96 inch. A page without a size is read in mm, with a
//! warning. Result: mm, y up from the lower left corner of the page. Limits: groups nested 1000 deep, 4 million points.
//!
//! Why not usvg (0.49, without its text feature). Measured:
//! - It keeps coordinates as `f32` and turns arcs into cubic curves with a fixed tolerance. A circle of radius 90 mm
//!   came out up to 0.024 mm too large, and one of 45 mm drawn 10^6 units from the origin between 0.015 mm too small and
//!   0.069 mm too large; here the chosen tolerance (0.005 mm) holds.
//! - It read a negative width, an unknown transform and path data that end in a stray letter without an error, and dropped
//!   text silently; here each is an error or a warning with its place.
//! - A file of 15 kB with an entity of 10 000 subpaths used 1000 times took 784 MB and 10 s (on a busy machine). Here
//!   entities are not expanded.
//! - It is 19 crates that take 23 s of compiler time.

use grainpath_core::poly::FillRule;
use grainpath_core::{DVec2, WarningId};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::drawing::{Drawing, Line, OutlineError, OutlineOptions, OutlineProblem, invalid};
use super::path::{Numbers, ellipse, lines};

use crate::xml::attribute;

/// Size of a CSS pixel, mm. Source: CSS 2.1, section 4.3.2: 1 px is 0.75 pt and 1 pt is 1/72 inch.
const PIXEL_MM: f64 = 25.4 / 96.0;
/// Limit on the nesting of groups; each level keeps a state, so a damaged file must not nest without end.
/// Source: chosen; files of real programs stay far below it.
const MAX_DEPTH: usize = 1000;

/// The affine map `(x, y) -> x a + y b + c`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Map {
    a: DVec2,
    b: DVec2,
    c: DVec2,
}

impl Map {
    fn new(m: [f64; 6]) -> Self {
        Self { a: DVec2::new(m[0], m[1]), b: DVec2::new(m[2], m[3]), c: DVec2::new(m[4], m[5]) }
    }

    fn at(&self, p: DVec2) -> DVec2 {
        self.turned(p) + self.c
    }

    fn turned(&self, p: DVec2) -> DVec2 {
        p.x * self.a + p.y * self.b
    }

    /// The map that applies `first` and then this one.
    fn after(&self, first: &Self) -> Self {
        Self { a: self.turned(first.a), b: self.turned(first.b), c: self.at(first.c) }
    }

    /// Upper bound on the factor by which the map lengthens anything: the Frobenius norm of its matrix.
    fn stretch(&self) -> f64 {
        (self.a.length_squared() + self.b.length_squared()).sqrt()
    }
}

/// Properties that a group passes on to its contents.
#[derive(Debug, Clone, Copy)]
struct State {
    map: Map,
    filled: bool,
    rule: FillRule,
    hidden: bool,
}

/// A rule of a style sheet that names one class: the class and its declarations.
type ClassRule = (String, String);

pub(super) fn read(text: &str, options: &OutlineOptions) -> Result<Drawing, OutlineError> {
    let mut xml = Reader::from_str(text);
    // A missing end tag would apply a group's transform to what follows.
    xml.config_mut().check_end_names = true;
    let mut svg = Svg { drawing: Drawing::default(), stack: Vec::new(), classes: Vec::new(), options };
    let mut in_style = false;
    loop {
        let at = xml.buffer_position();
        // Errors from deeper levels have no place; the byte of the element is added here.
        let place = |e: OutlineError| match e {
            OutlineError::Invalid { place, problem } if place.is_empty() => {
                invalid(format!("byte {at}"), *problem)
            }
            other => other,
        };
        let event = xml
            .read_event()
            .map_err(|e| invalid(format!("byte {at}"), OutlineProblem::Xml(e.to_string())))?;
        match &event {
            Event::Start(e) => {
                in_style = e.local_name().as_ref() == "style";
                svg.element(e, true).map_err(place)?;
            }
            Event::Empty(e) => svg.element(e, false).map_err(place)?,
            Event::End(_) => {
                in_style = false;
                svg.stack.pop();
            }
            Event::Text(t) if in_style => svg.sheet(t),
            Event::CData(t) if in_style => svg.sheet(t),
            Event::Eof if !svg.stack.is_empty() => {
                return Err(invalid(format!("byte {at}"), OutlineProblem::Ends));
            }
            Event::Eof => return Ok(svg.drawing),
            _ => {}
        }
    }
}

struct Svg<'a> {
    drawing: Drawing,
    stack: Vec<State>,
    classes: Vec<ClassRule>,
    options: &'a OutlineOptions,
}

impl Svg<'_> {
    /// Stores the rules of a style sheet that name a single class. Drawing programs export colours in
    /// this form.
    fn sheet(&mut self, text: &str) {
        for rule in text.split('}') {
            let Some((names, declarations)) = rule.split_once('{') else { continue };
            for name in names.split(',') {
                if let Some(class) = name.trim().strip_prefix('.')
                    // Ten thousand rules bound the time to look a class up.
                    && self.classes.len() < 10_000
                {
                    self.classes.push((class.to_owned(), declarations.to_owned()));
                }
            }
        }
    }

    fn element(&mut self, e: &BytesStart<'_>, opens: bool) -> Result<(), OutlineError> {
        let name = e.local_name();
        let name = name.as_ref();
        let outer = match self.stack.last() {
            Some(state) => *state,
            // Fill black with the non-zero rule is the initial state (SVG 1.1, section 11.3).
            None if name == "svg" => {
                State { map: self.page(e)?, filled: true, rule: FillRule::NonZero, hidden: false }
            }
            None => return Err(invalid("", OutlineProblem::NotSvg(name.to_owned()))),
        };
        let mut state = self.styled(outer, e);
        if let Some(text) = attribute(e, "transform") {
            let own = transform(&text).map_err(|e| {
                let text = text.chars().take(40).collect();
                invalid("", OutlineProblem::Transform { text, source: Box::new(e) })
            })?;
            state.map = state.map.after(&own);
        }
        match name {
            "svg" | "g" | "a" | "switch" | "title" | "desc" | "metadata" | "style" | "namedview" => {}
            // These elements draw nothing themselves.
            "defs" | "symbol" | "clipPath" | "mask" | "pattern" | "marker" | "linearGradient"
            | "radialGradient" | "filter" => state.hidden = true,
            "text" | "image" | "use" | "foreignObject" if !state.hidden => {
                // Each of these changes the outline, so the user is told.
                self.drawing.warn(WarningId::OutlineNotRead, format!("<{name}> is not read; make it a path"));
                state.hidden = true;
            }
            _ if state.hidden => {}
            _ => self.shape(name, e, &state)?,
        }
        // A nested <svg> has its own origin.
        if name == "svg" && !self.stack.is_empty() {
            let at = DVec2::new(self.length(e, "x")?.unwrap_or(0.0), self.length(e, "y")?.unwrap_or(0.0));
            state.map.c = state.map.at(at);
        }
        if opens {
            if self.stack.len() == MAX_DEPTH {
                return Err(invalid("", OutlineProblem::TooDeep(MAX_DEPTH)));
            }
            self.stack.push(state);
        }
        Ok(())
    }

    /// The map from the page's unit to mm, with y up from the lower edge.
    fn page(&mut self, e: &BytesStart<'_>) -> Result<Map, OutlineError> {
        let view = match attribute(e, "viewBox") {
            None => None,
            Some(text) => {
                let mut words = Numbers::new(&text);
                let (low, size) = (words.point()?, words.point()?);
                if !size.cmpgt(DVec2::ZERO).all() {
                    return Err(invalid("", OutlineProblem::NoViewBox(text.clone())));
                }
                Some((low, size))
            }
        };
        let (width, height) = (physical(e, "width"), physical(e, "height"));
        let view_size = view.map_or(DVec2::ONE, |v| v.1);
        // Width and height over the view box: mm for each user unit.
        let scales = [(width, view_size.x), (height, view_size.y)].map(|(l, v)| l.map(|l| l / v));
        let mm = match (self.options.unit, view, scales) {
            (Some(unit), ..) => unit.mm(),
            // Without a view box, user units are pixels, whatever the size of the page (SVG 1.1, section
            // 7.10).
            (None, None, [Some(_), _] | [_, Some(_)]) => PIXEL_MM,
            // Different scales mean that the drawing is fitted into the page; the smaller one is used
            // (`meet`).
            (None, Some(_), [Some(x), Some(y)]) => x.min(y),
            (None, Some(_), [Some(s), None] | [None, Some(s)]) => s,
            _ => {
                self.drawing.warn(
                    WarningId::UnitAssumed,
                    "the drawing states no size in mm or inches; its unit is taken for mm",
                );
                1.0
            }
        };
        let low = view.map_or(DVec2::ZERO, |v| v.0);
        // The lower edge becomes y = 0.
        let lower_edge = match (view, height) {
            (Some((low, size)), _) => low.y + size.y,
            (None, Some(h)) => h / mm,
            (None, None) => self.length(e, "height").ok().flatten().unwrap_or(0.0),
        };
        Ok(Map::new([mm, 0.0, 0.0, -mm, -mm * low.x, mm * lower_edge]))
    }

    /// Applies fill, fill rule and visibility. A `style` attribute beats a class, and a class beats an
    /// attribute.
    fn styled(&self, mut state: State, e: &BytesStart<'_>) -> State {
        for key in ["fill", "fill-rule", "display", "visibility"] {
            if let Some(value) = attribute(e, key) {
                state.declare(key, &value);
            }
        }
        if let Some(classes) = attribute(e, "class") {
            for (class, declarations) in &self.classes {
                if classes.split_ascii_whitespace().any(|c| c == class) {
                    state.declare_all(declarations);
                }
            }
        }
        if let Some(style) = attribute(e, "style") {
            state.declare_all(&style);
        }
        state
    }

    /// A length in the drawing's user unit.
    fn length(&self, e: &BytesStart<'_>, key: &str) -> Result<Option<f64>, OutlineError> {
        let Some(text) = attribute(e, key) else { return Ok(None) };
        let wrong = || invalid("", OutlineProblem::NotALength { key: key.to_owned(), text: text.clone() });
        let (value, unit) = split_length(&text).ok_or_else(wrong)?;
        // A user unit is one pixel, so physical units are converted to pixels.
        Ok(Some(value * if unit.is_empty() { 1.0 } else { unit_mm(unit).ok_or_else(wrong)? / PIXEL_MM }))
    }

    fn shape(&mut self, name: &str, e: &BytesStart<'_>, state: &State) -> Result<(), OutlineError> {
        // The tolerance in mm is divided by the stretch of the map, so that it holds after the map is
        // applied.
        let tolerance = self.options.tolerance_mm / state.map.stretch().max(1e-12);
        let length = |key: &str| self.length(e, key);
        let size = |key: &str| match length(key)? {
            Some(v) if v < 0.0 => Err(invalid(
                "",
                OutlineProblem::Negative { name: name.to_owned(), key: key.to_owned(), value: v },
            )),
            v => Ok(v),
        };
        let point = |x: &str, y: &str| -> Result<DVec2, OutlineError> {
            Ok(DVec2::new(length(x)?.unwrap_or(0.0), length(y)?.unwrap_or(0.0)))
        };
        let mut found = match name {
            "path" => {
                let data = attribute(e, "d").unwrap_or_default();
                lines(&data, tolerance).map_err(|e| invalid("", OutlineProblem::Path(Box::new(e))))?
            }
            "rect" => {
                let (low, w, h) = (point("x", "y")?, size("width")?, size("height")?);
                let size_ = DVec2::new(w.unwrap_or(0.0), h.unwrap_or(0.0));
                let (rx, ry) = (size("rx")?, size("ry")?);
                // One missing radius takes the value of the other, and both stop at half the side (SVG
                // 1.1, section 9.2).
                let radii = DVec2::new(rx.or(ry).unwrap_or(0.0), ry.or(rx).unwrap_or(0.0)).min(0.5 * size_);
                if size_.min_element() > 0.0 {
                    vec![rectangle(low, size_, radii, tolerance)]
                } else {
                    Vec::new()
                }
            }
            "circle" | "ellipse" => {
                let r = size("r")?;
                let radii = match (name, size("rx")?, size("ry")?) {
                    ("circle", ..) => DVec2::splat(r.unwrap_or(0.0)),
                    (_, rx, ry) => DVec2::new(rx.or(ry).unwrap_or(0.0), ry.or(rx).unwrap_or(0.0)),
                };
                let centre = point("cx", "cy")?;
                if radii.min_element() > 0.0 { vec![ellipse(centre, radii, tolerance)] } else { Vec::new() }
            }
            "polygon" | "polyline" => {
                let text = attribute(e, "points").unwrap_or_default();
                let mut words = Numbers::new(&text);
                let mut points = Vec::new();
                while !words.is_done() {
                    let wrong =
                        |source| invalid("", OutlineProblem::Points { name: name.to_owned(), source });
                    points.push(words.point().map_err(wrong)?);
                }
                // Fill closes a polyline; without fill it stays open.
                vec![Line { points, closed: name == "polygon" }]
            }
            "line" => vec![Line { points: vec![point("x1", "y1")?, point("x2", "y2")?], closed: false }],
            // Elements of other programs (guides, layers, previews) draw nothing.
            _ => return Ok(()),
        };
        for p in found.iter_mut().flat_map(|l| &mut l.points) {
            *p = state.map.at(*p);
        }
        self.drawing.add(found, state.filled.then_some(state.rule))
    }
}

impl State {
    fn declare(&mut self, key: &str, value: &str) {
        match (key, value.trim()) {
            // Gradients and patterns fill the shape as colours do.
            ("fill", value) if value != "inherit" => self.filled = !matches!(value, "none" | "transparent"),
            ("fill-rule", "evenodd") => self.rule = FillRule::EvenOdd,
            ("fill-rule", "nonzero") => self.rule = FillRule::NonZero,
            ("display", "none") | ("visibility", "hidden" | "collapse") => self.hidden = true,
            _ => {}
        }
    }

    fn declare_all(&mut self, declarations: &str) {
        for (key, value) in declarations.split(';').filter_map(|d| d.split_once(':')) {
            self.declare(key.trim(), value);
        }
    }
}

fn rectangle(low: DVec2, size: DVec2, radii: DVec2, tolerance: f64) -> Line {
    let high = low + size;
    if !radii.cmpgt(DVec2::ZERO).all() {
        return Line {
            points: vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)],
            closed: true,
        };
    }
    // Each corner takes a quarter of the ellipse.
    let round = ellipse(DVec2::ZERO, radii, tolerance).points;
    let n = round.len().div_ceil(4);
    let corners = [
        // Centres of the corner ellipses, in the order of their angles.
        high - radii,
        DVec2::new(low.x + radii.x, high.y - radii.y),
        low + radii,
        DVec2::new(high.x - radii.x, low.y + radii.y),
    ];
    let quarter = |(k, &centre): (usize, &DVec2)| {
        (0..=n).map(move |i| {
            let turn = (k as f64 + i as f64 / n as f64) * std::f64::consts::FRAC_PI_2;
            centre + grainpath_core::math::direction(turn) * radii
        })
    };
    Line { points: corners.iter().enumerate().flat_map(quarter).collect(), closed: true }
}

/// Splits a length into its number and its unit.
fn split_length(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let end = text
        .char_indices()
        .find(|&(i, c)| {
            c == '%'
                || c.is_ascii_alphabetic()
                    // `e` begins an exponent only if a digit or sign follows: `1em` is one em.
                    && !(matches!(c, 'e' | 'E')
                        && text[i + 1..].starts_with(|n: char| n.is_ascii_digit() || n == '-' || n == '+'))
        })
        .map_or(text.len(), |(i, _)| i);
    let value: f64 = text[..end].trim().parse().ok()?;
    value.is_finite().then_some((value, text[end..].trim()))
}

fn unit_mm(unit: &str) -> Option<f64> {
    Some(match unit {
        "px" => PIXEL_MM,
        "mm" => 1.0,
        "cm" => 10.0,
        "in" => 25.4,
        "pt" => 25.4 / 72.0,
        "pc" => 25.4 / 6.0,
        "Q" | "q" => 0.25,
        _ => return None,
    })
}

/// Width or height of the page in mm, where a physical unit is stated. Percentages are not.
fn physical(e: &BytesStart<'_>, key: &str) -> Option<f64> {
    let text = attribute(e, key)?;
    let (value, unit) = split_length(&text)?;
    unit_mm(unit).map(|mm| value * mm).filter(|&mm| mm > 0.0)
}

/// Combines a list of transforms into one map. The last in the list is applied first (SVG 1.1, section
/// 7.6).
fn transform(text: &str) -> Result<Map, OutlineError> {
    let mut map = Map::new([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let mut rest = text.trim();
    while !rest.is_empty() {
        let wrong = || invalid("", OutlineProblem::NotATransform);
        let (name, after) = rest.split_once('(').ok_or_else(wrong)?;
        let (arguments, after) = after.split_once(')').ok_or_else(wrong)?;
        let mut words = Numbers::new(arguments);
        let mut v = Vec::new();
        // A matrix has six numbers; a seventh shows that the list is wrong, and no more are needed for
        // that.
        while !words.is_done() && v.len() < 7 {
            v.push(words.number()?);
        }
        let turn = |deg: f64| grainpath_core::math::sin_cos(deg.to_radians());
        let own = match (name.trim(), v.as_slice()) {
            ("matrix", &[a, b, c, d, e, f]) => [a, b, c, d, e, f],
            ("translate", &[x]) => [1.0, 0.0, 0.0, 1.0, x, 0.0],
            ("translate", &[x, y]) => [1.0, 0.0, 0.0, 1.0, x, y],
            ("scale", &[s]) => [s, 0.0, 0.0, s, 0.0, 0.0],
            ("scale", &[x, y]) => [x, 0.0, 0.0, y, 0.0, 0.0],
            ("rotate", &[deg]) => {
                let (s, c) = turn(deg);
                [c, s, -s, c, 0.0, 0.0]
            }
            ("rotate", &[deg, x, y]) => {
                let (s, c) = turn(deg);
                // Rotation about (x, y).
                [c, s, -s, c, x - c * x + s * y, y - s * x - c * y]
            }
            ("skewX", &[deg]) => [1.0, 0.0, grainpath_core::math::tan(deg.to_radians()), 1.0, 0.0, 0.0],
            ("skewY", &[deg]) => [1.0, grainpath_core::math::tan(deg.to_radians()), 0.0, 1.0, 0.0, 0.0],
            _ => return Err(wrong()),
        };
        map = map.after(&Map::new(own));
        rest = after.trim_start_matches(|c: char| c.is_whitespace() || c == ',');
    }
    Ok(map)
}
