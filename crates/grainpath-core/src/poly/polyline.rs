//! Open polylines: length and even steps.

use crate::DVec2;

/// Length of an open line, mm.
pub fn length_mm(line: &[DVec2]) -> f64 {
    line.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// A line with points at equal steps of about `step_mm`; its ends stay.
pub fn resampled(line: &[DVec2], step_mm: f64) -> Vec<DVec2> {
    let length = length_mm(line);
    let (Some(&first), Some(&last)) = (line.first(), line.last()) else { return Vec::new() };
    let n = (length / step_mm).round().clamp(1.0, 1e6) as usize;
    let mut out = vec![first];
    let (mut walked, mut i) = (0.0, 0);
    for k in 1..n {
        let target = length * k as f64 / n as f64;
        while i + 2 < line.len() && walked + line[i].distance(line[i + 1]) < target {
            walked += line[i].distance(line[i + 1]);
            i += 1;
        }
        let segment = line[i].distance(line[i + 1]);
        out.push(line[i].lerp(line[i + 1], ((target - walked) / segment.max(1e-12)).clamp(0.0, 1.0)));
    }
    out.push(last);
    out
}
