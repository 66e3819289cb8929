//! Graded density as a map: the density that was asked for beside the density that was laid.

use grainpath::measure::laid_density::{CELL_MM, LaidDensity};
use grainpath_core::{Bounds2, DVec2};

use crate::layer::{Canvas, Ramp};

/// Both maps in plan: the density that was asked for on the left, the density that was laid on the right. Each square shows
/// the mean of the cells that lie above each other there. Blue is the least density, red the greatest.
pub fn density_png(laid: &LaidDensity, size_px: u32) -> Vec<u8> {
    let corners = laid.each.iter().map(|c| c.low_mm.truncate());
    let bounds = Bounds2::around_points(corners.clone().chain(corners.map(|p| p + CELL_MM)));
    let Some(bounds) = bounds else {
        return Canvas::over(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE }, size_px).png();
    };
    let size = bounds.size();
    let [nx, ny] = [size.x, size.y].map(|mm| (mm / CELL_MM).round().max(1.0) as usize);
    let mut sums = vec![[0.0, 0.0, 0.0]; nx * ny];
    for cell in &laid.each {
        let at = (cell.low_mm.truncate() - bounds.min) / CELL_MM;
        let sum = &mut sums[(at.y.round() as usize).min(ny - 1) * nx + (at.x.round() as usize).min(nx - 1)];
        *sum = [sum[0] + 1.0, sum[1] + cell.asked, sum[2] + cell.laid];
    }
    // One cell is left free between the two maps.
    let apart = size.x + CELL_MM;
    let all = Bounds2 { min: bounds.min, max: bounds.max + DVec2::new(apart, 0.0) };
    let mut canvas = Canvas::over(all, size_px);
    let ramp = Ramp { low: laid.min, high: laid.max.max(laid.min + 1e-3) };
    // All pixels of a cell have one colour, which is found once.
    let coloured = |what: usize| -> Vec<Option<_>> {
        sums.iter().map(|sum| (sum[0] > 0.0).then(|| ramp.colour(sum[what] / sum[0]))).collect()
    };
    let colours = [coloured(1), coloured(2)];
    let colour = |p: DVec2| {
        let right = p.x - bounds.min.x >= apart;
        let q = (p - bounds.min - if right { DVec2::new(apart, 0.0) } else { DVec2::ZERO }) / CELL_MM;
        let inside = q.x >= 0.0 && q.y >= 0.0 && q.x < nx as f64 && q.y < ny as f64;
        inside.then(|| colours[usize::from(right)][q.y as usize * nx + q.x as usize])?
    };
    let colours: Vec<_> = canvas.pixels().map(colour).collect();
    canvas.paint(colours.into_iter());
    canvas.png()
}
