//! The figures of walls and of supports, drawn from what the code computes; `tests/figure.rs` at the top of the
//! repository says how they are made anew.

#[path = "../../../tests/figure.rs"]
mod figure;

use figure::{BLUE, Figure, GREEN, ORANGE, Panel, RED, hold};
use grainpath::Settings;
use grainpath::run::config;
use grainpath::shape::{SliceSettings, slice};
use grainpath::support::plan;
use grainpath::support::tree::Kind;
use grainpath::wall::{WallSettings, lay_walls};
use grainpath_core::{DVec2, DVec3, Diagnostics, Polygon, Region, TriMesh};
use grainpath_io::PaintedSupports;
use grainpath_job::choices::SupportStyle;

const CRATE: &str = env!("CARGO_MANIFEST_DIR");

#[test]
fn the_figure_of_walls() {
    // A block with a tail that becomes thinner than a bead, and a slot that leaves a thin web.
    let corners = [
        (0.0, 0.0),
        (9.0, 0.0),
        (9.0, 2.6),
        (19.0, 2.95),
        (19.0, 3.25),
        (9.0, 5.2),
        (9.0, 7.0),
        (4.0, 7.0),
        (4.0, 4.2),
        (3.2, 4.2),
        (3.2, 7.0),
        (2.1, 7.0),
        (2.1, 4.2),
        (0.0, 4.2),
    ];
    let polygon = Polygon { outer: corners.map(DVec2::from).to_vec(), holes: Vec::new() };
    let settings = WallSettings {
        n_walls: 2,
        bead_width_mm: 0.5,
        height_mm: 0.2,
        thin_walls: true,
        gap_fill: true,
        min_bead_width_mm: 0.25,
        fill_overlap: 0.0,
    };
    let walls = lay_walls(&polygon, &settings);
    assert!(walls.loops.iter().any(|w| w.depth == 1) && !walls.singles.is_empty() && !walls.fill.is_empty());

    let mut figure = Figure::new(640.0, 270.0);
    let panel = Panel { corner: [24.0, 238.0], low: DVec2::ZERO, scale: 30.0 };
    let part = Region::from(polygon);
    figure.area(&panel, &part, "fill=\"#fff\" stroke=\"none\"");
    figure.area(&panel, &walls.fill, &format!("fill=\"#d9efdd\" stroke=\"{GREEN}\" stroke-width=\".8\""));
    for wall in &walls.loops {
        let fill = if wall.depth == 0 { "#9fc3e6" } else { "#cfe1f3" };
        figure.bead(&panel, &wall.path, &format!("fill=\"{fill}\" stroke=\"{BLUE}\" stroke-width=\".6\""));
    }
    for single in &walls.singles {
        figure.bead(
            &panel,
            single,
            &format!("fill=\"{ORANGE}\" fill-opacity=\".65\" stroke=\"{ORANGE}\" stroke-width=\".6\""),
        );
        figure.line(&panel, &single.points, single.closed, &format!("stroke=\"{RED}\" stroke-width=\"1.4\""));
    }
    figure.area(&panel, &part, "fill=\"none\" stroke=\"#000\" stroke-width=\"1.2\"");
    figure.text([330.0, 30.0], "start", "#000", "dark blue: outer wall, light blue: inner wall");
    figure.text([330.0, 46.0], "start", GREEN, "green: area for the centrelines of the fill");
    figure.text([330.0, 62.0], "start", ORANGE, "orange: single beads where a pair of walls does not fit,");
    figure.text([330.0, 78.0], "start", RED, "red: along the medial axis, as wide as the place");
    figure.text([330.0, 258.0], "middle", "#000", "walls of a part whose tail becomes thinner than a bead");
    hold(CRATE, "src/wall/figures/walls.svg", &figure.svg());
}

/// An outline in x and z, extruded along y; `triangles` divide the outline.
fn extruded(outline: &[(f64, f64)], triangles: &[[u32; 3]], depth_mm: f64) -> TriMesh {
    let n = outline.len() as u32;
    let mut mesh = TriMesh::default();
    for y in [0.0, depth_mm] {
        mesh.vertices.extend(outline.iter().map(|(x, z)| DVec3::new(*x, y, *z)));
    }
    for [a, b, c] in triangles {
        mesh.triangles.push([*a, *b, *c]);
        mesh.triangles.push([n + a, n + c, n + b]);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        mesh.triangles.push([i, n + i, n + j]);
        mesh.triangles.push([i, n + j, j]);
    }
    mesh
}

#[test]
fn the_figure_of_trees() {
    // A shelf on a post, seen from the side; it is so narrow that all branches lie nearly in one plane.
    let outline = [(0.0, 0.0), (4.0, 0.0), (4.0, 26.0), (44.0, 26.0), (44.0, 29.0), (0.0, 29.0)];
    let mesh = extruded(&outline, &[[0, 1, 2], [0, 2, 5], [2, 4, 5], [2, 3, 4]], 3.0);
    let quiet = Diagnostics::default();
    let slices = SliceSettings {
        layer_height_mm: 0.2,
        first_layer_height_mm: 0.2,
        adaptive: None,
        gap_closing_mm: 0.05,
        simplify_mm: 0.005,
    };
    let stack = slice(&mesh, &slices, &quiet).expect("layers");
    let mut job = Settings::default();
    job.support.style = SupportStyle::Tree;
    let settings = config::support(&job, None, PaintedSupports::default()).expect("trees are asked for");
    let support = plan(&mesh, &stack, &settings, &quiet).expect("a support");
    let nodes = &support.forest.nodes;
    let side = |p: DVec3| DVec2::new(p.x, p.z);

    let mut figure = Figure::new(640.0, 300.0);
    let panel = Panel { corner: [40.0, 270.0], low: DVec2::ZERO, scale: 8.6 };
    let part = Region::from(Polygon { outer: outline.map(DVec2::from).to_vec(), holes: Vec::new() });
    figure.area(&panel, &part, "fill=\"#ddd\" stroke=\"#000\"");
    figure.line(
        &panel,
        &[DVec2::new(-3.0, 0.0), DVec2::new(62.0, 0.0)],
        false,
        "stroke=\"#000\" stroke-width=\"2\"",
    );
    // Skewed cones: from the radius of a node to that of the node below.
    let slope = grainpath_core::math::tan(settings.branch_angle_rad);
    for node in nodes {
        let Some(below) = node.below.map(|k| &nodes[k as usize]) else { continue };
        let across = |i: i32, sign: f64| {
            let at = node.at.lerp(below.at, f64::from(i) / 20.0);
            side(at) + DVec2::X * sign * node.radius_at_mm(below, at.z, slope)
        };
        let down = (0..=20).map(|i| across(i, -1.0));
        let corners = down.chain((0..=20).rev().map(|i| across(i, 1.0))).collect();
        let cone = Region { polygons: vec![Polygon { outer: corners, holes: Vec::new() }] };
        figure.area(&panel, &cone, &format!("fill=\"#bfe3c8\" stroke=\"{GREEN}\" stroke-width=\".8\""));
    }
    for node in nodes {
        let style = match node.kind {
            Kind::Contact(_) => format!("fill=\"{RED}\""),
            Kind::Join => format!("fill=\"{BLUE}\""),
            Kind::Foot => "fill=\"#000\"".to_owned(),
            _ => continue,
        };
        figure.dot(&panel, side(node.at), 3.0, &style);
    }
    let n_joints = nodes.iter().filter(|n| n.kind == Kind::Join).count();
    let n_feet = nodes.iter().filter(|n| n.kind == Kind::Foot).count();
    assert!(n_joints > 0 && n_feet > 0, "{n_joints} {n_feet}");
    let far = DVec2::new(46.5, 0.0);
    let entries = [
        (27.0, RED, "contact on the overhang"),
        (21.0, BLUE, "joint, where two cones meet"),
        (5.0, "#000", "foot on the plate"),
    ];
    for (z, colour, text) in entries {
        let at = far + DVec2::Y * z;
        figure.dot(&panel, at, 3.0, &format!("fill=\"{colour}\""));
        figure.text(
            [panel.corner[0] + at.x * panel.scale + 8.0, panel.corner[1] - z * panel.scale + 4.0],
            "start",
            colour,
            text,
        );
    }
    hold(CRATE, "src/support/figures/tree.svg", &figure.svg());
}
