//! The shapes of a drawing, their conversion to a region, and the errors of reading.

use grainpath_core::poly::FillRule;
use grainpath_core::units::LengthUnit;
use grainpath_core::{Contour, DVec2, Region, Warning, WarningId};

use crate::text::TextError;

/// Options for reading a drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutlineOptions {
    /// Unit of the drawing; `None` takes what the file states.
    pub unit: Option<LengthUnit>,
    /// Largest distance between a curve and the chords that replace it, mm.
    pub tolerance_mm: f64,
    /// Whether the even-odd rule applies to all closed lines together, whatever the fill of their shapes: going inwards,
    /// every second line bounds a hole. Lines of a DXF always follow this rule.
    pub even_odd: bool,
}

/// The result of reading a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// The part, mm: x to the right and y up from the lower left corner of an SVG's page, from the origin of a DXF.
    pub region: Region,
    /// Warnings about contents that are odd but readable.
    pub warnings: Vec<Warning>,
}

pub(super) fn invalid(place: impl Into<String>, problem: OutlineProblem) -> OutlineError {
    OutlineError::Invalid { place: place.into(), problem: Box::new(problem) }
}

/// Why an outline cannot be read. `place` is a line of a DXF, a byte of an SVG or a character of its path data.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum OutlineError {
    #[error("the file is empty")]
    Empty,
    #[error("the drawing is neither SVG nor ASCII DXF")]
    Unknown,
    #[error("the drawing is a binary DXF; save it as ASCII DXF")]
    BinaryDxf,
    #[error("byte {byte}: the drawing is not UTF-8 text")]
    NotUtf8 { byte: usize },
    #[error(transparent)]
    Text(#[from] TextError),
    #[error("the drawing has no closed line around any area{hints}")]
    NoArea { hints: String },
    #[error("more than {MAX_POINTS} points; grainpath reads no more")]
    TooManyPoints,
    #[error("{place}: {problem}")]
    Invalid { place: String, problem: Box<OutlineProblem> },
}

/// What is wrong at the place that [`OutlineError::Invalid`] names.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum OutlineProblem {
    #[error("the drawing ends in the middle")]
    Ends,
    #[error("the point ({x}, {y}) mm lies beyond {MAX_MM} mm")]
    Beyond { x: f64, y: f64 },
    #[error("path data should begin with M")]
    NoMove,
    /// The XML reader's own words.
    #[error("{0}")]
    Xml(String),
    #[error("<{0}> stands where <svg> should")]
    NotSvg(String),
    #[error("transform {text:?}: {source}")]
    Transform { text: String, source: Box<OutlineError> },
    #[error("groups are nested more than {0} deep")]
    TooDeep(usize),
    #[error("viewBox = {0:?} has no area")]
    NoViewBox(String),
    #[error("{key} = {text:?} should be a length")]
    NotALength { key: String, text: String },
    #[error("<{name}> has {key} {value}, less than nothing")]
    Negative { name: String, key: String, value: f64 },
    #[error("path data: {0}")]
    Path(Box<OutlineError>),
    #[error("<{name}> points: {source}")]
    Points { name: String, source: TextError },
    #[error("should be a list like translate(1 2) rotate(30)")]
    NotATransform,
    #[error("{kind} lacks {expected} (code {code})")]
    Lacks { kind: String, expected: &'static str, code: i32 },
    #[error("a SPLINE of degree {degree}; 1 to {max} are read")]
    SplineDegree { degree: f64, max: usize },
    #[error("a SPLINE of degree {degree} with {n} points and {m} knots: the numbers do not fit")]
    SplineNumbers { degree: f64, n: usize, m: usize },
    #[error("the knots of a SPLINE fall, or a weight is not positive")]
    SplineKnots,
}

/// Limit on the points of a drawing. Source: derived. They take 64 MB. A drawing with more is a hatching or a traced
/// photograph.
pub(super) const MAX_POINTS: usize = 4_000_000;
/// Limit on coordinates, mm. A part 1 km wide comes from a wrong unit or damage. Source: chosen; the reason above.
const MAX_MM: f64 = 1e6;
/// Pieces of the part with a smaller area are dropped, mm2. Source: derived. They come from rounding where shapes
/// touch; a bead 0.4 mm wide covers as much in 3 um of length.
const SMALLEST_MM2: f64 = 1e-3;

/// One shape of a drawing: closed lines, mm.
pub(super) struct Shape {
    pub(super) rings: Vec<Contour>,
    /// The fill rule; `None` where only the line is drawn.
    pub(super) filled: Option<FillRule>,
}

/// The shapes of a drawing.
#[derive(Default)]
pub(super) struct Drawing {
    pub(super) shapes: Vec<Shape>,
    pub(super) n_points: usize,
    /// Number of open lines, which bound no area.
    pub(super) dropped: usize,
    pub(super) warnings: Vec<Warning>,
}

impl Drawing {
    /// Adds the lines of a shape. An unfilled open line is counted as dropped.
    pub(super) fn add(&mut self, lines: Vec<Line>, filled: Option<FillRule>) -> Result<(), OutlineError> {
        let mut rings = Vec::with_capacity(lines.len());
        for Line { mut points, closed } in lines {
            self.n_points += points.len();
            if self.n_points > MAX_POINTS {
                return Err(OutlineError::TooManyPoints);
            }
            // Written so that NaN fails the comparison too.
            if let Some(p) = points.iter().find(|p| !p.abs().cmple(DVec2::splat(MAX_MM)).all()) {
                return Err(invalid("", OutlineProblem::Beyond { x: p.x, y: p.y }));
            }
            let meets = points.len() > 2 && points[0].distance(points[points.len() - 1]) < SAME_MM;
            if meets {
                // A contour does not repeat its first point.
                points.pop();
            }
            // Fill closes an open path without drawing the last side (SVG 1.1, section 11.3), so filled
            // shapes need no closing line.
            if filled.is_none() && !closed && !meets {
                self.dropped += 1;
            } else if points.len() > 2 {
                rings.push(points);
            }
        }
        if !rings.is_empty() {
            self.shapes.push(Shape { rings, filled });
        }
        Ok(())
    }

    /// Adds a warning once. Fifty different ones are more than anyone reads.
    pub(super) fn warn(&mut self, id: WarningId, text: impl Into<String>) {
        let warning = Warning::new(id, text);
        if self.warnings.len() < 50 && !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    pub(super) fn region(&self, even_odd: bool) -> Region {
        let mut all: Vec<Contour> = Vec::new();
        let mut lines: Vec<Contour> = Vec::new();
        for shape in &self.shapes {
            match shape.filled {
                // Each filled shape becomes a region by its own fill rule, before all shapes are united.
                Some(rule) if !even_odd => {
                    all.extend(Region::from_contours(&shape.rings, rule).contours().cloned());
                }
                _ => lines.extend(shape.rings.iter().cloned()),
            }
        }
        // The regions may overlap. Each winds once around its own area, so the non-zero rule gives their
        // union.
        let filled = Region::from_contours(&all, FillRule::NonZero);
        let mut region = if lines.is_empty() {
            filled
        } else {
            // A closed line inside filled material cuts a hole, a line outside adds material.
            Region::from_contours(filled.contours().chain(&lines), FillRule::EvenOdd)
        };
        region.polygons.retain(|p| p.area_mm2() > SMALLEST_MM2);
        region
    }
}

/// A line of a drawing.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Line {
    pub(super) points: Vec<DVec2>,
    pub(super) closed: bool,
}

/// Points nearer than this are the same point, mm. Files round their coordinates.
/// Source: derived. Files with three decimals of a millimetre round by half of it.
pub(super) const SAME_MM: f64 = 1e-3;
