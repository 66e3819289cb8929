//! Raster angles per range of layers and of skins, and lines of several beads: what a pattern lays, and from a job to paths
//! in order.

use std::ops::Range;

use grainpath::fill::{Continuous, FillContext, Infill, LineFit, SideBySide, TreeKind};
use grainpath::run::{Steps, config};
use grainpath_core::math::direction;
use grainpath_core::poly::{FillRule, Join};
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{
    Bounds2, DVec2, Density, Diagnostics, Layer, LayerPlan, LayerStack, Polygon, Region, Role, Toolpath,
    UniformField,
};
use grainpath_job::choices::{BeadEnds, BeadWidths, Choice, Pattern};
use grainpath_job::parse_job;

static FIELD: UniformField = UniformField { axis_rad: 0.4 };

/// A square, and a disc with a hole that is not in its middle.
fn regions() -> [Polygon; 2] {
    let disc = |r: f64, n: usize, at: DVec2| {
        (0..n).map(|i| at + r * direction(i as f64 / n as f64 * std::f64::consts::TAU)).collect::<Vec<_>>()
    };
    let hole = disc(9.0, 60, DVec2::new(8.0, 3.0)).into_iter().rev().collect();
    let square = Region::rectangle(DVec2::splat(-32.0), DVec2::splat(32.0)).polygons.remove(0);
    [square, Polygon { outer: disc(36.0, 120, DVec2::ZERO), holes: vec![hole] }]
}

fn context(density: f64, angle_rad: f64, z_mid_mm: f64) -> FillContext<'static> {
    FillContext {
        z_mid_mm,
        height_mm: 0.2,
        bead_width_mm: 0.45,
        min_bead_width_mm: 0.2,
        density: Density::new(density),
        angle_rad,
        part: Bounds2 { min: DVec2::splat(-40.0), max: DVec2::splat(40.0) },
        role: Role::SparseFill,
        border_mm: 0.5 * bead_spacing_mm(0.45, 0.2),
        ends: BeadEnds::Joined,
        shift: grainpath::fill::Shift::NONE,
        below: None,
        fills_wedges: false,
        widths: BeadWidths::Variable,
        field: Some(&FIELD),
    }
}

fn wide_patterns() -> impl Iterator<Item = Pattern> {
    Pattern::ALL.iter().copied().filter(|p| p.takes_several_beads())
}

/// Lines of some beads each. None of these patterns reads the settings of `continuous`.
fn side_by_side(pattern: Pattern, beads: usize) -> SideBySide {
    let continuous = Continuous { tree: TreeKind::Undirected, aspect: 1.0, variable: true };
    SideBySide { pattern, beads, continuous, fit: LineFit::NONE }
}

fn laid(several: &SideBySide, context: &FillContext<'_>, region: &Polygon) -> Vec<Toolpath> {
    let mut paths = Vec::new();
    several.fill(context, region, &mut paths);
    paths
}

/// The range of the volume share that lines of several beads may lay: about 1.3 times what was measured.
fn expected_share(pattern: Pattern, name: &str, region: &Polygon, density: f64) -> Range<f64> {
    // The share of one bead along the whole border.
    let border = region.perimeter_mm() * bead_spacing_mm(0.45, 0.2) / region.area_mm2();
    let between = |low: f64, high: f64| density + low..density + high;
    match pattern {
        // As for single lines, up to half of the border joins the lines of each direction.
        Pattern::Rectilinear | Pattern::Aligned => between(0.23 * border, 0.53 * border),
        Pattern::Grid => between(0.6 * border, 1.05 * border),
        // Lines of one direction are 12 mm apart here, so on the disc their place beside the hole counts.
        Pattern::Triangles if name == "disc" => between(-0.3 * border, 0.35 * border),
        Pattern::Triangles => between(0.8 * border, 1.25 * border),
        Pattern::Gyroid => between(0.0, 0.0028),
        // Cells are cut at the border.
        Pattern::Honeycomb => between(-0.004, 0.009),
        // Groups of loops have a whole number. Around a hole the last ones run out in the middle.
        Pattern::Concentric if name == "disc" => between(-0.0105, 0.0),
        Pattern::Concentric => between(-0.0005, 0.0005),
        // The lines are laid again until their beads have the volume of the area to be filled, which begins at the strips
        // of the surrounding beads.
        Pattern::Streamlines | Pattern::Stripes => {
            let border_mm = 0.5 * bead_spacing_mm(0.45, 0.2);
            let filled = Region::from(region.clone()).offset(border_mm, Join::Miter(2.0)).area_mm2();
            let share = density * filled / region.area_mm2();
            0.998 * share..1.002 * share
        }
        other => panic!("{} does not take several beads", other.name()),
    }
}

#[test]
fn lines_of_several_beads_have_the_density_asked_for() {
    let mut wrong = Vec::new();
    for (pattern, (name, region)) in
        wide_patterns().flat_map(|p| ["square", "disc"].into_iter().zip(regions()).map(move |r| (p, r)))
    {
        for (beads, density) in [(2, 0.2), (3, 0.3), (4, 0.4)] {
            let several = side_by_side(pattern, beads);
            // A whole number of periods of the gyroid would show a part of its heights only.
            let layers = if pattern == Pattern::Gyroid { 11 } else { 2 };
            let one = |k: usize| {
                let context = context(density, 0.8 + 1.5 * (k % 2) as f64, 0.1 + 1.7 * k as f64);
                laid(&several, &context, &region).iter().map(|p| p.volume_mm3(0.2)).sum::<f64>()
            };
            let volume: f64 = (0..layers).map(one).sum();
            let found = volume / (region.area_mm2() * 0.2 * layers as f64);
            let expected = expected_share(pattern, name, &region, density);
            if !expected.contains(&found) {
                let pattern = pattern.name();
                wrong.push(format!(
                    "{pattern} of {beads} on {name} at {density}: {found:.4}, not in {expected:.4?}"
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_rows_of_a_line_are_a_spacing_apart_and_lines_as_far_as_the_density_says() {
    let context = context(0.25, 0.0, 0.1);
    let several = side_by_side(Pattern::Aligned, 3);
    let [square, _] = regions();
    let mut rows: Vec<f64> = Vec::new();
    for (a, b) in laid(&several, &context, &square).iter().flat_map(|p| p.points.iter().zip(&p.points[1..])) {
        if a.y == b.y && (a.x - b.x).abs() > 60.0 {
            rows.push(a.y);
        }
    }
    rows.sort_by(f64::total_cmp);
    let s = context.spacing_mm();
    let step = 3.0 * s / 0.25;
    assert_eq!(rows.len(), 3 * (64.0 / step).round() as usize, "{rows:?}");
    // The middle row of a group lies where a single line would.
    assert!(rows.iter().any(|y| y.abs() < 1e-9), "{rows:?}");
    for (k, pair) in rows.windows(2).enumerate() {
        let expected = if k % 3 == 2 { step - 2.0 * s } else { s };
        assert!((pair[1] - pair[0] - expected).abs() < 1e-9, "row {k}: {pair:?}, {expected}");
    }
}

#[test]
fn beads_lie_beside_each_other_inside_the_region() {
    let [_, region] = regions();
    let grown = Region::from(region.clone()).offset(2e-3, Join::Miter(3.0));
    for pattern in [Pattern::Gyroid, Pattern::Honeycomb, Pattern::Streamlines, Pattern::Concentric] {
        for beads in [2, 3, 5] {
            let context = context(0.3, 0.3, 1.3);
            let several = side_by_side(pattern, beads);
            let paths = laid(&several, &context, &region);
            assert_eq!(paths, laid(&several, &context, &region), "the same again");
            for p in paths.iter().flat_map(|p| &p.points) {
                assert!(grown.contains(*p), "{} of {beads}: {p} is outside", pattern.name());
            }
            // Strips of beads that lie on each other would cover less than their length says.
            let s = context.spacing_mm();
            let strips: Vec<Region> =
                paths.iter().map(|p| Region::around_line(&p.points, p.closed, 0.5 * s)).collect();
            let covered = Region::from_contours(strips.iter().flat_map(Region::contours), FillRule::NonZero);
            let asked: f64 = paths.iter().map(|p| p.length_mm() * s).sum();
            let share = covered.area_mm2() / asked;
            assert!(share > 0.96, "{} of {beads}: {share:.4}", pattern.name());
        }
    }
}

/// Plans a box of 30 x 20 mm and 20 layers.
fn planned(sets: &[&str]) -> Vec<LayerPlan> {
    planned_of(&Region::rectangle(DVec2::ZERO, DVec2::new(30.0, 20.0)), sets)
}

/// Plans 20 layers of a section.
fn planned_of(section: &Region, sets: &[&str]) -> Vec<LayerPlan> {
    let sets: Vec<String> = sets.iter().map(|s| (*s).to_owned()).collect();
    let settings = parse_job("", "job.toml", &sets, &|path| Err(path.to_owned())).expect("a sound job");
    let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section.clone()).expect("a sound layer");
    let stack = LayerStack::new((0..20).map(layer).collect()).expect("heights rise");
    let (step_settings, order) = (config::steps(&settings), config::order(&settings));
    let mut layers = Vec::new();
    Steps::new(&step_settings, &stack)
        .in_windows(
            20,
            settings.fill.density.even().expect("a number"),
            &order,
            &Diagnostics::default(),
            |layer| layers.push(layer),
        )
        .expect("not stopped");
    layers
}

#[test]
fn lines_of_several_beads_meet_the_density_of_a_part_of_few_lines() {
    // A plate of 70 x 40 mm with two holes and a notch: lines of eight beads at 0.15 are up to 65 mm apart.
    let disc = |at: DVec2, r: f64| {
        let outer =
            (0..128).map(|i| at + r * direction(f64::from(i) / 128.0 * std::f64::consts::TAU)).collect();
        Region::from(Polygon { outer, holes: Vec::new() })
    };
    let notch = [[38.0, 28.0], [42.0, 41.0], [30.0, 41.0], [33.0, 28.0]].map(DVec2::from).to_vec();
    let plate = Region::rectangle(DVec2::ZERO, DVec2::new(70.0, 40.0))
        .difference(&disc(DVec2::new(15.0, 22.0), 5.0))
        .difference(&disc(DVec2::new(55.0, 15.0), 6.0))
        .difference(&Region::from(Polygon { outer: notch, holes: Vec::new() }));
    // Up to the strips of two walls.
    let inside = plate.offset(-0.225 - 1.5 * bead_spacing_mm(0.45, 0.2), Join::Miter(2.0)).area_mm2();
    let mut wrong = Vec::new();
    for pattern in wide_patterns().filter(|p| !p.follows_field()) {
        for (density, beads) in [0.15, 0.3].into_iter().flat_map(|d| [2, 3, 5, 8].map(|n| (d, n))) {
            let layers = planned_of(
                &plate,
                &[
                    &format!("fill.pattern={}", pattern.name()),
                    &format!("fill.density={density}"),
                    &format!("fill.lines={beads}"),
                    "process.top_layers=0",
                    "process.bottom_layers=0",
                ],
            );
            let sparse =
                layers.iter().flat_map(|l| &l.paths).map(|p| &p.path).filter(|p| p.role == Role::SparseFill);
            let volume: f64 = sparse.map(|p| p.volume_mm3(0.2)).sum();
            let found = volume / (inside * 0.2 * layers.len() as f64);
            println!("{} of {beads} at {density}: {found:.3}", pattern.name());
            if (found / density - 1.0).abs() > 0.05 {
                wrong.push(format!("{} of {beads} at {density}: {found:.4}", pattern.name()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The direction in which most length of a role lies, whole degrees from 0 to 179.
fn angle_deg(layer: &LayerPlan, role: Role) -> Option<i64> {
    let mut length = vec![0.0; 180];
    for path in layer.paths.iter().map(|p| &p.path).filter(|p| p.role == role) {
        for i in 0..path.n_segments() {
            let (a, b, _) = path.segment(i);
            let deg = (b - a).to_angle().to_degrees().round() as i64;
            length[deg.rem_euclid(180) as usize] += a.distance(b);
        }
    }
    let (deg, most) = (0..).zip(&length).max_by(|a, b| a.1.total_cmp(b.1))?;
    (*most > 0.0).then_some(deg)
}

#[test]
fn each_range_of_layers_has_its_own_angles_and_skins_theirs() {
    let angles = "fill.angles_deg={ layers = { \"1-10\" = [0], \"11-\" = [30, 120] } }";
    let common = ["fill.pattern=rectilinear", "process.top_layers=2", "process.bottom_layers=3", angles];
    let layers = planned(&common);
    let skins = planned(&[&common[..], &["fill.skin_angles_deg=[10, 100]"]].concat());
    for (k, (layer, other)) in layers.iter().zip(&skins).enumerate() {
        let inside = (3..18).contains(&k);
        let role = match k {
            19 => Role::TopSkin,
            _ if inside => Role::SparseFill,
            _ => Role::SolidFill,
        };
        // The top layer has no layer above, so all of its skin is seen; skins between are solid fill.
        let role = if k == 19 && angle_deg(layer, role).is_none() { Role::SolidFill } else { role };
        let infill = if k < 10 { 0 } else { [30, 120][(k - 10) % 2] };
        assert_eq!(angle_deg(layer, role), Some(infill), "layer {k}");
        let skin = [10, 100][k % 2];
        assert_eq!(angle_deg(other, role), Some(if inside { infill } else { skin }), "layer {k}");
    }
}

#[test]
fn lines_of_several_beads_have_the_volume_that_the_density_asks_for() {
    let volume = |sets: &[&str]| -> f64 {
        let sparse = |layer: &LayerPlan| {
            let paths = layer.paths.iter().map(|p| &p.path).filter(|p| p.role == Role::SparseFill);
            paths.map(|p| p.volume_mm3(0.2)).sum::<f64>()
        };
        planned(sets).iter().map(sparse).sum()
    };
    let common = ["fill.pattern=grid", "fill.density=0.3", "fill.angles_deg=[37]"];
    let single = volume(&common);
    // 11 sparse layers, up to the strips of two walls.
    let inset = 0.45 + 3.0 * bead_spacing_mm(0.45, 0.2);
    let asked = 0.3 * 11.0 * 0.2 * (30.0 - inset) * (20.0 - inset);
    for lines in ["fill.lines=2", "fill.lines=3"] {
        let several = volume(&[&common[..], &[lines]].concat());
        assert!((several / asked - 1.0).abs() < 0.05, "{lines}: {several:.2} mm3 of {asked:.2} mm3");
    }
    // 11 sparse layers of about 28 x 18 mm at 0.3; what joins single lines along the border adds a fifth.
    assert!((1.0..1.3).contains(&(single / (11.0 * 0.2 * 28.0 * 18.0 * 0.3))), "{single}");
}
