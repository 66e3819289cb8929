//! Figures of the module texts, drawn by tests from what the code computes, so that they cannot go stale.
//!
//! A test runs the algorithm on a small case, draws it with [`Figure`] and calls [`hold`], which compares the text with
//! the file that the documentation includes. `UPDATE_FIGURES=1 cargo test --profile ci -p CRATE figure` writes the
//! files anew; look at them before they are committed.
#![allow(dead_code)]

use std::fmt::Write;
use std::path::Path;

use grainpath_core::{DVec2, Region, Toolpath};

pub(crate) const BLUE: &str = "#27527a";
pub(crate) const RED: &str = "#c22222";
pub(crate) const ORANGE: &str = "#e07b00";
pub(crate) const GREEN: &str = "#1a7a3a";
pub(crate) const GREY: &str = "#888888";
pub(crate) const PALE: &str = "#eeeeee";

/// An SVG with a white ground, so that it is legible on dark pages too.
pub(crate) struct Figure {
    body: String,
    size: [f64; 2],
}

/// A part of a figure with a scale of its own.
#[derive(Clone, Copy)]
pub(crate) struct Panel {
    /// Lower left corner, pixels.
    pub corner: [f64; 2],
    /// What lies there, mm.
    pub low: DVec2,
    /// Pixels per mm.
    pub scale: f64,
}

impl Panel {
    fn place(&self, p: DVec2) -> String {
        let q = (p - self.low) * self.scale;
        format!("{} {}", rounded(self.corner[0] + q.x), rounded(self.corner[1] - q.y))
    }
}

/// A tenth of a pixel is seen by nobody; more digits would make the file larger.
fn rounded(pixels: f64) -> String {
    let text = format!("{pixels:.1}");
    let text = text.strip_suffix(".0").unwrap_or(&text);
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

impl Figure {
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self { body: String::new(), size: [width, height] }
    }

    /// Text whose middle, start or end lies at a place in pixels.
    pub(crate) fn text(&mut self, at: [f64; 2], anchor: &str, colour: &str, text: &str) {
        let [x, y] = at.map(rounded);
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        let _ = writeln!(
            self.body,
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{text}</text>"
        );
    }

    /// Text beside a place of a panel, `by` pixels away, and a thin line from it to the place.
    pub(crate) fn note(&mut self, panel: &Panel, at: DVec2, by: [f64; 2], text: &str) {
        let place = panel.place(at);
        let [x, y]: [f64; 2] = {
            let mut numbers = place.split(' ').map(|n| n.parse().unwrap_or(0.0));
            [numbers.next().unwrap_or(0.0), numbers.next().unwrap_or(0.0)]
        };
        let end = [x + by[0], y + by[1]];
        let _ = writeln!(
            self.body,
            "<path d=\"M{place}L{} {}\" stroke=\"#000\" stroke-width=\".7\" fill=\"none\"/>",
            rounded(end[0]),
            rounded(end[1])
        );
        let anchor = if by[0] < -2.0 {
            "end"
        } else if by[0] > 2.0 {
            "start"
        } else {
            "middle"
        };
        let shift = [
            if by[0] < -2.0 {
                -2.0
            } else if by[0] > 2.0 {
                2.0
            } else {
                0.0
            },
            if by[1] > 2.0 { 10.0 } else { -2.0 },
        ];
        self.text([end[0] + shift[0], end[1] + shift[1]], anchor, "#000", text);
    }

    /// A filled area; `style` holds attributes such as `fill="#eee"`.
    pub(crate) fn area(&mut self, panel: &Panel, region: &Region, style: &str) {
        let mut d = String::new();
        for contour in region.contours() {
            let points: Vec<String> = contour.iter().map(|p| panel.place(*p)).collect();
            let _ = write!(d, "M{}Z", points.join("L"));
        }
        let _ = writeln!(self.body, "<path d=\"{d}\" fill-rule=\"evenodd\" {style}/>");
    }

    /// A polyline; `style` holds attributes such as `stroke="#c22"`.
    pub(crate) fn line(&mut self, panel: &Panel, points: &[DVec2], closed: bool, style: &str) {
        let places: Vec<String> = points.iter().map(|p| panel.place(*p)).collect();
        let end = if closed { "Z" } else { "" };
        let _ = writeln!(self.body, "<path d=\"M{}{end}\" fill=\"none\" {style}/>", places.join("L"));
    }

    /// Many lines of one style as one element.
    pub(crate) fn lines(&mut self, panel: &Panel, lines: &[(Vec<DVec2>, bool)], style: &str) {
        let mut d = String::new();
        for (points, closed) in lines {
            let places: Vec<String> = points.iter().map(|p| panel.place(*p)).collect();
            let _ = write!(d, "M{}{}", places.join("L"), if *closed { "Z" } else { "" });
        }
        let _ = writeln!(self.body, "<path d=\"{d}\" fill=\"none\" {style}/>");
    }

    /// A disc of a radius in pixels.
    pub(crate) fn dot(&mut self, panel: &Panel, at: DVec2, radius: f64, style: &str) {
        let place = panel.place(at);
        let (x, y) = place.split_once(' ').unwrap_or_default();
        let _ = writeln!(self.body, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\" {style}/>", rounded(radius));
    }

    /// A row of squares of one grey from a place on, `n` of them with this side in mm.
    pub(crate) fn squares(&mut self, panel: &Panel, centre: DVec2, side_mm: f64, n: usize, grey: u8) {
        let corner = panel.place(centre + 0.5 * side_mm * DVec2::new(-1.0, 1.0));
        let (x, y) = corner.split_once(' ').unwrap_or_default();
        // A little more than the side, so that no seams show between neighbours.
        let side = side_mm * panel.scale + 0.2;
        let _ = writeln!(
            self.body,
            "<path d=\"M{x} {y}h{}v{}h-{0}Z\" fill=\"rgb({grey},{grey},{grey})\"/>",
            rounded(n as f64 * side_mm * panel.scale + 0.2),
            rounded(side)
        );
    }

    /// A bead with its width, as an area.
    pub(crate) fn bead(&mut self, panel: &Panel, bead: &Toolpath, style: &str) {
        let n = bead.points.len();
        let side = |sign: f64| -> Vec<DVec2> {
            let offset = |i: usize| {
                let (before, after) = if bead.closed {
                    ((i + n - 1) % n, (i + 1) % n)
                } else {
                    (i.saturating_sub(1), (i + 1).min(n - 1))
                };
                let (u, v) = (bead.points[i] - bead.points[before], bead.points[after] - bead.points[i]);
                let (u, v) = (u.normalize_or(v.normalize_or_zero()), v.normalize_or(u.normalize_or_zero()));
                // A corner is mitred, up to twice the width.
                let along = (u + v).normalize_or(u);
                let half = 0.5 * bead.width_at(i) / along.dot(u).max(0.5);
                bead.points[i] + sign * half * DVec2::new(-along.y, along.x)
            };
            (0..n).map(offset).collect()
        };
        let places = |points: Vec<DVec2>| -> String {
            points.iter().map(|p| panel.place(*p)).collect::<Vec<_>>().join("L")
        };
        let (left, mut right) = (side(1.0), side(-1.0));
        let d = if bead.closed {
            format!("M{}ZM{}Z", places(left), places(right))
        } else {
            right.reverse();
            format!("M{}L{}Z", places(left), places(right))
        };
        let _ = writeln!(self.body, "<path d=\"{d}\" fill-rule=\"evenodd\" {style}/>");
    }

    /// The whole file.
    pub(crate) fn svg(&self) -> String {
        let [w, h] = self.size.map(rounded);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" font-family=\"sans-serif\" \
             font-size=\"11\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n{}</svg>\n",
            self.body
        )
    }
}

/// Holds a figure in the sources against the one that the code draws. `folder` is that of the crate, `name` the path of
/// the figure in it.
pub(crate) fn hold(folder: &str, name: &str, svg: &str) {
    let path = Path::new(folder).join(name);
    if std::env::var_os("UPDATE_FIGURES").is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder is made");
        std::fs::write(&path, svg).expect("a figure is written");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    // Nobody could read the difference of two such texts.
    assert!(kept == svg, "{name} is out of date: UPDATE_FIGURES=1 cargo test --profile ci figure");
}
