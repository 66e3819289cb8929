//! Draws pictures of failing geometry tests.
//!
//! The coordinates that a failing polygon test prints are unreadable. [`FailurePicture`] collects the
//! geometry under test. If it is dropped while the test panics, it writes an SVG to `target/failures/`
//! and prints its path. A test that passes writes nothing.
//!
//! ```
//! use grainpath_core::{DVec2, Region, failure_svg::FailurePicture};
//!
//! let region = Region::rectangle(DVec2::ZERO, DVec2::splat(4.0));
//! let mut picture = FailurePicture::new("doc_example");
//! picture.region("outline", &region);
//! picture.point("offender", DVec2::splat(2.0));
//! assert!(region.contains(DVec2::splat(2.0)), "a failure here would leave an SVG behind");
//! ```

use std::fmt::Write as _;
use std::path::PathBuf;

use glam::DVec2;

use crate::{Bounds2, Contour, Region};

/// The colours of the shapes, in the order in which they are added.
const COLOURS: [&str; 6] = ["#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b"];

/// Longer side of the picture, pixels. Source: chosen by eye; only the picture depends on it.
const SIDE_PX: f64 = 900.0;

enum Shape {
    Area(Vec<Contour>),
    Line(Vec<DVec2>),
    Point(DVec2),
}

/// The geometry that a test examines; it is drawn when the test fails.
pub struct FailurePicture {
    name: String,
    shapes: Vec<(String, Shape)>,
}

impl FailurePicture {
    /// A picture without shapes; `name` becomes the file's name.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), shapes: Vec::new() }
    }

    /// Adds a region, drawn as a translucent area.
    pub fn region(&mut self, label: &str, region: &Region) {
        let contours = region.contours().cloned().collect();
        self.shapes.push((label.to_owned(), Shape::Area(contours)));
    }

    /// Adds an open polyline.
    pub fn line(&mut self, label: &str, points: &[DVec2]) {
        self.shapes.push((label.to_owned(), Shape::Line(points.to_vec())));
    }

    /// Adds a point, drawn as a small ring.
    pub fn point(&mut self, label: &str, point: DVec2) {
        self.shapes.push((label.to_owned(), Shape::Point(point)));
    }

    /// The SVG text: millimetres with y upwards, and a legend of the labels.
    pub fn svg(&self) -> String {
        let points = self.shapes.iter().flat_map(|(_, shape)| match shape {
            Shape::Area(contours) => contours.iter().flatten().copied().collect::<Vec<_>>(),
            Shape::Line(points) => points.clone(),
            Shape::Point(p) => vec![*p],
        });
        // Points that are not finite are often the failure itself; in the bounds they would make the picture unreadable.
        let finite = points.filter(|p| p.is_finite());
        let bounds = Bounds2::around_points(finite).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE });
        // The extent of a single point is zero, by which the scale below would divide.
        let margin = 0.05 * bounds.size().max_element().max(1e-6);
        let bounds = bounds.grown(margin);
        let scale = SIDE_PX / bounds.size().max_element();
        let size = bounds.size() * scale;
        let place = |p: DVec2| {
            let q = (p - bounds.min) * scale;
            // In SVG, y points downwards.
            format!("{:.3},{:.3}", q.x, size.y - q.y)
        };
        let path = |points: &[DVec2]| points.iter().map(|&p| place(p)).collect::<Vec<_>>().join(" ");
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0}\" height=\"{:.0}\" font-family=\"sans-serif\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
            size.x, size.y
        );
        for (i, (label, shape)) in self.shapes.iter().enumerate() {
            let colour = COLOURS[i % COLOURS.len()];
            let drawn = match shape {
                Shape::Area(contours) => {
                    let d: String = contours.iter().map(|c| format!("M{}Z", path(c))).collect();
                    format!(
                        "<path d=\"{d}\" fill=\"{colour}\" fill-opacity=\"0.2\" fill-rule=\"evenodd\" stroke=\"{colour}\"/>"
                    )
                }
                Shape::Line(points) => {
                    format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\"/>", path(points))
                }
                Shape::Point(p) => {
                    let q = place(*p);
                    let (x, y) = q.split_once(',').unwrap_or_default();
                    format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"5\" fill=\"none\" stroke=\"{colour}\"/>")
                }
            };
            // Labels may hold expressions with `<`, which is not allowed in XML text.
            let label = label.replace('&', "&amp;").replace('<', "&lt;");
            let y = 16 * (i + 1);
            let _ = writeln!(
                out,
                "{drawn}\n<text x=\"6\" y=\"{y}\" font-size=\"13\" fill=\"{colour}\">{label}</text>"
            );
        }
        out.push_str("</svg>\n");
        out
    }

    /// Returns `condition`, and draws the picture if it is false. Property tests need this, because
    /// they report failures without a panic. They shrink a failing case, and each failure overwrites the
    /// picture, so the last picture shows the smallest case.
    pub fn holds(&self, condition: bool) -> bool {
        if !condition {
            self.write();
        }
        condition
    }

    fn write(&self) {
        let path = Self::folder().join(format!("{}.svg", self.name));
        let written =
            std::fs::create_dir_all(Self::folder()).and_then(|()| std::fs::write(&path, self.svg()));
        match written {
            Ok(()) => eprintln!("the failing geometry is drawn in {}", path.display()),
            Err(e) => eprintln!("the failing geometry could not be drawn in {}: {e}", path.display()),
        }
    }

    /// The folder of pictures: `failures` in the target folder of the running test binary; without a target
    /// folder, in the temporary folder.
    fn folder() -> PathBuf {
        let binary = std::env::current_exe().unwrap_or_default();
        let target = binary.ancestors().find(|p| p.ends_with("target")).map(PathBuf::from);
        target.unwrap_or_else(std::env::temp_dir).join("failures")
    }
}

impl Drop for FailurePicture {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.write();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failing_test_leaves_a_picture_and_a_passing_one_none() {
        let draw = |name: &str, fails: bool| {
            let name = name.to_owned();
            let path = FailurePicture::folder().join(format!("{name}.svg"));
            let _ = std::fs::remove_file(&path);
            let ended = std::panic::catch_unwind(|| {
                let mut picture = FailurePicture::new(name);
                picture.region("a < b", &Region::rectangle(DVec2::ZERO, DVec2::splat(2.0)));
                picture.line("way", &[DVec2::ZERO, DVec2::new(f64::NAN, 1.0)]);
                picture.point("here", DVec2::ONE);
                assert!(!fails, "on purpose");
            });
            assert_eq!(ended.is_err(), fails);
            let text = std::fs::read_to_string(&path).ok();
            let _ = std::fs::remove_file(&path);
            text
        };
        assert_eq!(draw("failure_svg_passes", false), None);
        let svg = draw("failure_svg_fails", true).expect("a picture");
        assert!(svg.contains("a &lt; b") && svg.contains("<circle") && svg.ends_with("</svg>\n"), "{svg}");
    }
}
