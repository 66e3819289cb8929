//! Clipping open lines by a region.

use glam::DVec2;

use super::{Bounds2, Region};
use crate::math::cross;

/// A piece of a clipped polyline.
#[derive(Debug, Clone, PartialEq)]
pub struct ClippedLine {
    /// The piece, in the direction of the line it was cut from.
    pub points: Vec<DVec2>,
    /// For each point, where on the line it was: vertex index plus fraction of the following segment.
    pub at: Vec<f64>,
}

/// Clips many lines by one region. Every line keeps its identity, direction and order; lines may cross.
pub struct LineClipper {
    edges: Vec<(DVec2, DVec2)>,
    bounds: Option<Bounds2>,
}

impl LineClipper {
    /// Prepares the region.
    pub fn new(region: &Region) -> Self {
        let edges = region.contours().flat_map(|c| super::edges(c)).collect();
        Self { edges, bounds: region.bounds() }
    }

    /// The pieces of `line` inside the region, in order. A piece that runs exactly along an edge counts as inside
    /// on one side only (half-open rule).
    pub fn clip(&self, line: &[DVec2]) -> Vec<ClippedLine> {
        let Some(bounds) = self.bounds else { return Vec::new() };
        let _ = bounds;
        let mut out: Vec<ClippedLine> = Vec::new();
        let mut current: Option<ClippedLine> = None;
        for (i, w) in line.windows(2).enumerate() {
            let (a, b) = (w[0], w[1]);
            let mut cuts: Vec<f64> = Vec::new();
            for &(p, q) in &self.edges {
                let (sp, sq) = (cross(b - a, p - a) > 0.0, cross(b - a, q - a) > 0.0);
                let (sa, sb) = (cross(q - p, a - p) > 0.0, cross(q - p, b - p) > 0.0);
                if sp != sq && sa != sb {
                    let (da, db) = (cross(q - p, a - p), cross(q - p, b - p));
                    cuts.push((da / (da - db)).clamp(0.0, 1.0));
                }
            }
            cuts.sort_by(f64::total_cmp);
            let mut t0 = 0.0;
            for t1 in cuts.into_iter().chain([1.0]) {
                let (pa, pb) = (a.lerp(b, t0), a.lerp(b, t1));
                let inside = super::crossings_are_odd(self.edges.iter().copied(), a.lerp(b, 0.5 * (t0 + t1)));
                if inside && t1 > t0 {
                    let piece = current
                        .get_or_insert_with(|| ClippedLine { points: vec![pa], at: vec![i as f64 + t0] });
                    piece.points.push(pb);
                    piece.at.push(i as f64 + t1);
                }
                if !inside && let Some(piece) = current.take() {
                    out.push(piece);
                }
                t0 = t1;
            }
        }
        out.extend(current);
        out
    }
}
