//! Pictures of a strength test: the material that broke, the failure index, and the curve of load over
//! displacement.

use std::fmt::Write;

use grainpath_core::{Bounds2, DVec2, DVec3};

use crate::layer::{Canvas, Ramp};
use grainpath::measure::strength::{Map, StrengthReport, Tested, three_digits};

/// A picture of a value of each element. A plate has one tile, a solid one tile for each height that is shown.
/// The text lists these heights.
fn map_png(tested: &Tested, values: &[f32], size_px: u32) -> (Vec<u8>, String) {
    let (n, cell, low, cells) = match &tested.map {
        Map::Plane(e) => {
            let cell = DVec3::splat(e.grid.cell_mm);
            ([e.grid.nx, e.grid.ny, 1], cell, e.grid.low, &e.cells)
        }
        Map::Voxels { n, cell_mm, low, cells } => (*n, *cell_mm, low.truncate(), cells),
    };
    // Elements without material have no value and get no colour.
    let mut shown = vec![None; n.iter().product()];
    for (cell, v) in cells.iter().zip(values) {
        shown[*cell as usize] = Some(*v);
    }
    let tiles = tiles(n, &shown);
    let size = cell.truncate() * DVec2::new(n[0] as f64, n[1] as f64);
    // The number of columns is chosen so that the picture is about as wide as it is high.
    let columns = (tiles.len() as f64 * size.y / size.x).sqrt().round().clamp(1.0, tiles.len() as f64);
    let rows = (tiles.len() as f64 / columns).ceil();
    let all = size * DVec2::new(columns, rows);
    let mut canvas = Canvas::over(Bounds2 { min: low, max: low + all }, size_px);
    let ramp = Ramp { low: 0.0, high: 1.0 };
    let colours = canvas.pixels().map(|p| {
        let at = (p - low) / size;
        let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < columns && at.y < rows;
        // Tiles are arranged like words of a text: the lowest height is at the upper left.
        let row = rows - 1.0 - at.y.floor();
        let tile = inside.then(|| tiles.get((row * columns + at.x.floor()) as usize)).flatten()?;
        // The position within the tile, as a fraction, times the number of cells gives the cell. Its index
        // runs along x first, then y, then z.
        let q = (at - at.floor()) * DVec2::new(n[0] as f64, n[1] as f64);
        shown[(tile * n[1] + q.y as usize) * n[0] + q.x as usize].map(|v| ramp.colour(f64::from(v)))
    });
    let colours: Vec<_> = colours.collect();
    canvas.paint(colours.into_iter());
    let heights = match &tested.map {
        Map::Plane(_) => String::new(),
        Map::Voxels { low, .. } => {
            let z = |k: &usize| format!("{:.1}", low.z + (*k as f64 + 0.5) * cell.z);
            let all: Vec<String> = tiles.iter().map(z).collect();
            format!("; at heights of {} mm, row by row", all.join(", "))
        }
    };
    (canvas.png(), heights)
}

/// The greatest number of heights in one picture of a solid: more tiles would be too small to show a crack of one
/// cell. Source: chosen by eye; only the picture depends on it.
const TILES: usize = 12;

/// The heights that are shown, spaced evenly from bottom to top. The height nearest to the element with the
/// greatest value is moved to it, so that the worst place is always shown.
fn tiles(n: [usize; 3], shown: &[Option<f32>]) -> Vec<usize> {
    let area = n[0] * n[1];
    let greatest =
        |z: usize| shown[z * area..(z + 1) * area].iter().flatten().fold(0.0, |m: f32, v| m.max(*v));
    let count = n[2].min(TILES);
    // The heights are the middles of equal slabs, in whole numbers. No height occurs twice, because `count`
    // is at most `n[2]`.
    let mut all: Vec<usize> = (0..count).map(|k| (2 * k + 1) * n[2] / (2 * count)).collect();
    let worst =
        (0..n[2]).fold((0.0, 0), |best, z| if greatest(z) > best.0 { (greatest(z), z) } else { best });
    if let Some(near) = all.iter_mut().min_by_key(|z| z.abs_diff(worst.1)) {
        *near = worst.1;
    }
    all
}

/// A picture of the share of each element's material that broke: blue for none, red for all. For solids the
/// text lists the heights that are shown.
pub fn damage_png(tested: &Tested, size_px: u32) -> (Vec<u8>, String) {
    map_png(tested, &tested.outcome.damage, size_px)
}

/// A picture of the failure index of each element at the load of first failure; red is 1. For solids the text
/// lists the heights that are shown.
pub fn index_png(tested: &Tested, size_px: u32) -> (Vec<u8>, String) {
    map_png(tested, &tested.outcome.failure_index, size_px)
}

/// The curve of load over displacement as SVG, with the interval of the peak load.
pub fn chart_svg(report: &StrengthReport) -> String {
    let (w, h, left, bottom) = (640.0, 400.0, 64.0, 44.0);
    // A step of 1, 2 or 5 times a power of ten that gives about five grid lines.
    let nice = |v: f64| {
        let unit = 10f64
            .powi(grainpath_core::math::ln(v.max(1e-9) / 5.0).div_euclid(std::f64::consts::LN_10) as i32);
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|s| s * unit * 5.0 >= v).unwrap_or(10.0);
        step * unit
    };
    // The lower bound of 1e-9 keeps the axes finite for a test that failed at once.
    let most = |k: usize| report.curve.iter().map(|p| p[k]).fold(1e-9, f64::max);
    // The axes end a little beyond the curve. The interval of the peak load may reach above the curve, so the
    // load axis covers it too.
    let (u_max, f_max) = (most(0) * 1.05, report.high_n.max(most(1)) * 1.08);
    let x = |u: f64| left + (w - left - 16.0) * u / u_max;
    let y = |f: f64| h - bottom - (h - bottom - 16.0) * f / f_max;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" font-family=\"system-ui,sans-serif\" font-size=\"13\">\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n"
    );
    let band = (y(report.high_n), y(report.low_n));
    let _ = writeln!(
        out,
        "<rect x=\"{left}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#f3d9b8\"/>",
        band.0,
        w - left - 16.0,
        (band.1 - band.0).max(0.0)
    );
    for (max, vertical) in [(u_max, false), (f_max, true)] {
        let step = nice(max);
        let mut k = 0.0;
        // Labels are whole multiples of the step, because adding up the step would add up rounding errors.
        while k * step <= max {
            let v = k * step;
            // The step is 1, 2 or 5 times a power of ten, so the power gives the number of decimals. The
            // factor 1.01 avoids a wrong power where the logarithm of an exact power is rounded.
            let places = (-grainpath_core::math::ln(step * 1.01) / std::f64::consts::LN_10).ceil().max(0.0);
            let text = format!("{v:.0$}", places as usize);
            let _ = if vertical {
                writeln!(
                    out,
                    "<path d=\"M{left} {0:.1}H{1}\" stroke=\"#dde\"/><text x=\"{2}\" y=\"{3:.1}\" text-anchor=\"end\">{text}</text>",
                    y(v),
                    w - 16.0,
                    left - 6.0,
                    y(v) + 4.0
                )
            } else {
                writeln!(
                    out,
                    "<path d=\"M{0:.1} {1}V16\" stroke=\"#dde\"/><text x=\"{0:.1}\" y=\"{2}\" text-anchor=\"middle\">{text}</text>",
                    x(v),
                    h - bottom,
                    h - bottom + 18.0
                )
            };
            k += 1.0;
        }
    }
    let line: Vec<String> = report.curve.iter().map(|p| format!("{:.1},{:.1}", x(p[0]), y(p[1]))).collect();
    let _ = writeln!(
        out,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#1f5fbf\" stroke-width=\"2.5\"/>\n\
         <path d=\"M{left} {3:.1}H{4}\" stroke=\"#c33\" stroke-dasharray=\"5 4\"/>\n\
         <text x=\"{4}\" y=\"{5:.1}\" text-anchor=\"end\" fill=\"#c33\">{6} N ({7})</text>\n\
         <text x=\"{1}\" y=\"{2}\" text-anchor=\"middle\">displacement, mm</text>\n\
         <text x=\"14\" y=\"{8}\" transform=\"rotate(-90 14 {8})\" text-anchor=\"middle\">load, N</text>\n</svg>",
        line.join(" "),
        0.5 * (w + left),
        h - 8.0,
        y(report.peak_load_n),
        w - 16.0,
        y(report.peak_load_n) - 6.0,
        three_digits(report.peak_load_n),
        report.over(),
        0.5 * (h - bottom),
    );
    out
}
