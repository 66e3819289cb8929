//! The figure of matched slices.

#[path = "../../../../tests/figure.rs"]
mod figure;

use std::f64::consts::TAU;

use figure::{BLUE, Figure, Panel, RED, hold};
use grainpath_core::math::direction;
use grainpath_core::{DVec2, Polygon, Region};

use super::matching::{Events, MatchSettings, Slab};

fn ellipse(at: [f64; 2], radii: [f64; 2]) -> Polygon {
    let point = |i: i32| DVec2::from(at) + DVec2::from(radii) * direction(f64::from(i) / 60.0 * TAU);
    Polygon { outer: (0..60).map(point).collect(), holes: Vec::new() }
}

#[test]
fn the_figure_of_matching() {
    let settings = MatchSettings { overlap: 0.2, pixel_mm: DVec2::splat(0.2), features: false };
    let lower = [ellipse([0.0, 0.0], [7.0, 4.0]), ellipse([24.0, 0.0], [8.5, 4.0])];
    let upper = [
        ellipse([2.0, 0.0], [4.5, 3.0]),
        ellipse([19.5, 0.0], [3.0, 2.4]),
        ellipse([28.5, 0.0], [3.6, 2.8]),
        ellipse([46.0, 0.0], [4.0, 3.0]),
    ];
    let region = |all: &[Polygon]| Region { polygons: all.to_vec() };
    // The grey values of the last entity cross the threshold at two fifths of the way.
    let slab = Slab::between(&region(&lower), &region(&upper), &settings, &|_, _| 0.4);
    assert_eq!(slab.events, Events { births: 1, deaths: 0, branches: 1 });

    let mut figure = Figure::new(560.0, 250.0);
    let rise_px = 34.0;
    let step = 5;
    for k in 0..=step {
        let t = f64::from(k) / f64::from(step);
        // Seen from obliquely above: depth is drawn shorter, and each section a little higher.
        let panel = Panel { corner: [105.0, 205.0 - rise_px * f64::from(k)], low: DVec2::ZERO, scale: 8.0 };
        let mut section = slab.at(t.min(1.0 - 1e-9));
        let flat =
            section.polygons.iter_mut().flat_map(|p| std::iter::once(&mut p.outer).chain(&mut p.holes));
        flat.for_each(|contour| contour.iter_mut().for_each(|p| p.y *= 0.45));
        let ends = k == 0 || k == step;
        let (colour, width) = if ends { (BLUE, 2.0) } else { (RED, 1.0) };
        let style =
            format!("fill=\"#fff\" fill-opacity=\".55\" stroke=\"{colour}\" stroke-width=\"{width}\"");
        figure.area(&panel, &section, &style);
        let text = match k {
            0 => "lower".to_owned(),
            k if k == step => "upper".to_owned(),
            _ => format!("t = {t:.1}"),
        };
        figure.text([4.0, panel.corner[1] + 3.0], "start", colour, &text);
    }
    for (x, text) in [(110.0, "one to one"), (297.0, "one to two: cut in two"), (473.0, "begins between")] {
        figure.text([x, 242.0], "middle", "#000", text);
    }
    hold(env!("CARGO_MANIFEST_DIR"), "src/scan/figures/matching.svg", &figure.svg());
}
