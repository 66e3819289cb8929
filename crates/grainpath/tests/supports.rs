//! Supports of all real meshes: nothing floats, nothing cuts the part, no branch leans too far, and each
//! overhang is near a contact or listed as not reached.

#[path = "../../../tests/data.rs"]
mod data;

use std::path::{Path, PathBuf};

use grainpath::Settings;
use grainpath::run::config;
use grainpath::run::{Sliced, mesh_and_layers};
use grainpath::shape::{SliceSettings, slice};
use grainpath::support::bending;
use grainpath::support::clearance::Clearance;
use grainpath::support::cut::count_floating;
use grainpath::support::tree::{Forest, Kind, Node, cones_meet};
use grainpath::support::{Style, Support, SupportSettings, plan, warn_of_mid_air};
use grainpath_core::{Bounds2, DVec2, DVec3, Diagnostics, LayerStack, TriMesh};
use grainpath_io::PaintedSupports;
use rayon::prelude::*;

fn meshes() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(data::data("meshes")).expect("a folder of meshes");
    let mut paths: Vec<PathBuf> =
        entries.filter_map(|e| e.ok().map(|e| e.path())).filter(|p| p.is_file()).collect();
    paths.sort();
    paths
}

fn settings() -> Settings {
    let mut s = Settings::default();
    s.support.style = grainpath_job::choices::SupportStyle::Tree;
    s.printer.bed_mm = [2000.0; 3];
    s
}

/// What a job that only asks for trees gets.
fn job_settings() -> SupportSettings {
    config::support(&settings(), None, PaintedSupports::default()).expect("trees are asked for")
}

fn supported(path: &Path, s: &Settings) -> Option<(Support, LayerStack, SupportSettings)> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    let bytes = std::fs::read(path).ok()?;
    let file = grainpath_io::parse_mesh(&bytes, Some(&name)).ok()?;
    let mut s = s.clone();
    let longest = file.bodies.iter().filter_map(|b| b.mesh.bounds()).map(|(l, h)| (h - l).max_element());
    let longest = longest.fold(0.0, f64::max);
    // Most files state no unit, so sizes are scaled to lie between a coin's and a bucket's.
    s.shape.scale = if file.unit.is_some() {
        1.0
    } else if longest < 1.0 {
        60.0 / longest
    } else if longest < 9.0 {
        25.4
    } else {
        1.0
    };
    if longest > 500.0 {
        s.shape.scale = 100.0 / longest;
    }
    let quiet = Diagnostics::default();
    let Sliced { mesh, stack, .. } = mesh_and_layers(&config::placing(&s), file, &quiet).ok()?;
    let wanted = config::support(&s, None, PaintedSupports::default())?;
    let support = plan(&mesh, &stack, &wanted, &quiet).ok()?;
    Some((support, stack, wanted))
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn supports_of_every_real_mesh_stand_and_keep_off_the_part() {
    let mut wrong = Vec::new();
    let mut done = 0;
    for path in meshes() {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        // These two take many minutes; all others together about two.
        let is_slow = ["skull", "bone_lattice"].iter().any(|slow| name.contains(slow));
        if is_slow && std::env::var_os("GRAINPATH_SLOW").is_none() {
            continue;
        }
        if std::env::var("GRAINPATH_MESH").is_ok_and(|part| !name.contains(&part)) {
            continue;
        }
        let start = std::time::Instant::now();
        let Some((support, stack, wanted)) = supported(&path, &settings()) else { continue };
        done += 1;
        let cut: Vec<f64> = (0..stack.layers().len())
            .into_par_iter()
            .map(|k| support.cut.layers[k].region.intersection(stack.layers()[k].region()).area_mm2())
            .collect();
        // Areas below this come from rounding to the grid of the boolean operations.
        let cuts = cut.iter().filter(|&&a| a > 1e-3).count();
        let (layer, worst_mm2) =
            cut.iter().enumerate().fold((0, 0.0), |m, (k, &a)| if a > m.1 { (k, a) } else { m });
        let floating = count_floating(&support.cut.layers, &stack, &wanted);
        let steepest = support.forest.steepest_rad().to_degrees();
        let farthest = support.farthest_mm();
        let (on_air, left_out) = (support.cut.floating, support.cut.left_out_mm);
        let row = format!(
            "{name}: {} contacts, {} trees, {} unreached, {} near the plate, {} dropped, floating {floating} of the solid, {on_air} beads on air, {left_out:.2} mm left out, cuts {cuts} (at most {worst_mm2:.4} mm2, in layer {layer}), \
             steepest {steepest:.2}, farthest {farthest:.2} mm, {:.0} mm3, {:.2} s",
            support.overhangs.contacts.len(),
            support.forest.n_trees(),
            support.unreached.len(),
            support.near_plate,
            support.cut.dropped,
            support.volume_mm3(&stack),
            start.elapsed().as_secs_f64(),
        );
        println!("{row}");
        let limit = wanted.branch_angle_rad.to_degrees() + 0.01;
        // Beads that nothing can hold are left out; their section stays in the solid.
        let in_solid = usize::from(left_out > 0.0);
        if on_air > 0
            || floating > in_solid
            || cuts > 0
            || steepest > limit
            || farthest > 0.5 * wanted.max_unsupported_mm
        {
            wrong.push(row);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let all = std::env::var_os("GRAINPATH_MESH").is_none();
    assert!(done == 0 || done > 40 || !all, "only {done} meshes could be tried");
}

/// Overlapping boxes as one mesh; slicing unites them.
fn boxes(all: &[[[f64; 3]; 2]]) -> TriMesh {
    let mut mesh = TriMesh::default();
    for [low, high] in all {
        let first = mesh.vertices.len() as u32;
        let pick = |i: usize, k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
        mesh.vertices.extend((0..8).map(|i| DVec3::new(pick(i, 0), pick(i, 1), pick(i, 2))));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for [a, b, c, d] in quads.map(|q: [u32; 4]| q.map(|i| i + first)) {
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

fn layers(mesh: &TriMesh, diagnostics: &Diagnostics) -> LayerStack {
    let slicing = SliceSettings {
        layer_height_mm: 0.2,
        first_layer_height_mm: 0.2,
        adaptive: None,
        gap_closing_mm: 0.05,
        simplify_mm: 0.0125,
    };
    slice(mesh, &slicing, diagnostics).expect("a sound mesh")
}

fn planned(
    mesh: &TriMesh,
    change: impl Fn(&mut SupportSettings),
) -> (Support, LayerStack, Vec<grainpath_core::Warning>) {
    let quiet = Diagnostics::default();
    let stack = layers(mesh, &quiet);
    let mut settings = job_settings();
    change(&mut settings);
    let support = plan(mesh, &stack, &settings, &quiet).expect("not stopped");
    assert_eq!(count_floating(&support.cut.layers, &stack, &settings), 0);
    (support, stack, quiet.warnings())
}

/// A table: a leg, and a top 12 mm up that projects by 20 mm on all sides. With `shelf` a lower shelf
/// lies below one side.
fn table(shelf: bool) -> TriMesh {
    let mut all = vec![[[-2.0, -2.0, 0.0], [2.0, 2.0, 12.5]], [[-22.0, -22.0, 12.0], [22.0, 22.0, 14.0]]];
    if shelf {
        all.push([[0.0, -60.0, 0.0], [60.0, 60.0, 3.0]]);
    }
    boxes(&all)
}

#[test]
fn a_part_without_overhangs_gets_none_and_is_told_so() {
    let (support, _, warnings) = planned(&boxes(&[[[0.0; 3], [20.0, 20.0, 10.0]]]), |_| ());
    assert!(support.overhangs.contacts.is_empty() && support.cut.layers.iter().all(|l| l.region.is_empty()));
    assert!(warnings[0].text.contains("no overhang"), "{warnings:?}");
}

#[test]
fn the_same_trees_for_any_number_of_threads() {
    let mesh = grainpath_parts::specimen::hanging_ball();
    let with = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("a pool");
        pool.install(|| planned(&mesh, |_| ()).0)
    };
    let one = with(1);
    assert_eq!(one.forest.n_trees(), 1);
    assert!(one.overhangs.contacts.len() > 5 && one.unreached.is_empty());
    for n in [2, 8] {
        assert!(with(n) == one, "{n} threads");
    }
}

#[test]
fn where_the_plate_cannot_be_reached_branches_stand_on_the_part_or_are_listed() {
    let on_part =
        |s: &Support| s.forest.nodes.iter().filter(|n| n.kind == Kind::Landing && n.carries > 0).count();
    let (free, ..) = planned(&table(false), |_| ());
    assert_eq!((on_part(&free), free.unreached.len()), (0, 0));
    let (shelf, stack, _) = planned(&table(true), |_| ());
    assert!(on_part(&shelf) > 0 && shelf.unreached.is_empty());
    for (layer, part) in shelf.cut.layers.iter().zip(stack.layers()) {
        assert!(layer.region.intersection(part.region()).area_mm2() < 1e-3);
    }
    let (plate, _, warnings) = planned(&table(true), |s| s.from_plate_only = true);
    assert_eq!(on_part(&plate), 0);
    assert!(
        !plate.unreached.is_empty() && warnings.iter().any(|w| w.text.contains("no way to the overhang"))
    );
    assert!(plate.unreached.iter().all(|u| u.at.x > -0.5 && (u.at.z - 12.0).abs() < 1e-9));
}

#[test]
fn boxes_and_facets_enforce_and_block() {
    let half = [DVec3::new(0.0, -30.0, 0.0), DVec3::new(30.0, 30.0, 30.0)];
    let (blocked, ..) = planned(&table(false), |s| s.block = vec![half]);
    assert!(!blocked.overhangs.contacts.is_empty());
    assert!(blocked.overhangs.contacts.iter().all(|c| c.at.x < 0.01));
    // A wall that leans by 30 degrees needs no support unless the settings demand it.
    let mut wedge = boxes(&[[[0.0; 3], [10.0, 10.0, 20.0]]]);
    wedge.vertices.iter_mut().for_each(|p| p.x += 0.577 * p.z);
    let (none, ..) = planned(&wedge, |_| ());
    assert!(none.overhangs.contacts.is_empty(), "{:?}", none.overhangs.contacts);
    let all = [DVec3::splat(-100.0), DVec3::splat(100.0)];
    let (asked, ..) = planned(&wedge, |s| s.enforce = vec![all]);
    assert!(asked.overhangs.contacts.len() > 3);
    let leaning: Vec<u32> = none_facing_down(&wedge);
    let (listed, ..) = planned(&wedge, |s| s.enforce_facets = leaning.clone());
    assert!(listed.overhangs.contacts.len() > 3);
    let (both, ..) = planned(&wedge, |s| {
        s.enforce = vec![all];
        s.block_facets = leaning.clone();
    });
    assert!(both.overhangs.contacts.is_empty());
}

#[test]
fn what_is_painted_overrides_angles_and_boxes() {
    let patch = |at: [f64; 2], size: f64| {
        let [x, y] = at;
        let corners = [[x, y], [x, y + size], [x + size, y]];
        let vertices = corners.map(|[x, y]| DVec3::new(x, y, 12.0)).to_vec();
        TriMesh { vertices, triangles: vec![[0, 1, 2]] }
    };
    let everywhere = [DVec3::splat(-100.0), DVec3::splat(100.0)];
    // Supported only where painted, although a box blocks all of the part.
    let held = |marks: PaintedSupports| {
        let (support, ..) = planned(&table(false), |s| {
            s.block = vec![everywhere];
            s.painted = marks.clone();
        });
        support.overhangs
    };
    let found = held(PaintedSupports { enforcers: patch([5.0, 5.0], 12.0), ..PaintedSupports::default() });
    assert!(found.contacts.len() > 1);
    let inside = |p: DVec3| p.x > 4.99 && p.y > 4.99 && p.x + p.y < 22.01;
    assert!(found.samples.iter().all(|s| inside(s.at)), "{:?}", found.samples);
    // A painted patch smaller than the spacing of samples is not missed.
    let speck = held(PaintedSupports { enforcers: patch([10.3, 10.3], 0.2), ..PaintedSupports::default() });
    assert_eq!(speck.contacts.len(), 1);
    assert!(speck.contacts[0].at.distance(DVec3::new(10.4, 10.4, 12.0)) < 0.2);
    // Left free where painted, supported elsewhere.
    let (support, ..) = planned(&table(false), |s| s.painted.blockers = patch([5.0, 5.0], 12.0));
    let samples = &support.overhangs.samples;
    assert!(samples.len() > 100 && samples.iter().all(|s| s.at.x + s.at.y > 21.99 || !inside(s.at)));
}

fn none_facing_down(mesh: &TriMesh) -> Vec<u32> {
    let v = |i: u32| mesh.vertices[i as usize];
    let down = |t: &[u32; 3]| (v(t[1]) - v(t[0])).cross(v(t[2]) - v(t[0])).normalize().z;
    (0..mesh.triangles.len() as u32)
        .filter(|&t| (-0.9..-0.1).contains(&down(&mesh.triangles[t as usize])))
        .collect()
}

#[test]
fn what_begins_in_mid_air_without_support_is_warned_of_once_with_its_place() {
    let warned = |mesh: &TriMesh| {
        let quiet = Diagnostics::default();
        warn_of_mid_air(&layers(mesh, &quiet), &quiet);
        quiet.warnings()
    };
    assert!(warned(&table(false)).is_empty());
    let leg = [[0.0; 3], [4.0, 4.0, 20.0]];
    // Two pieces hang beside a leg, one of them from its top, as a hook does.
    let pieces = boxes(&[
        leg,
        [[8.0, 0.0, 6.0], [12.0, 4.0, 20.0]],
        [[3.0, 0.0, 18.0], [9.0, 4.0, 20.0]],
        [[-20.0, 0.0, 10.0], [-10.0, 4.0, 15.0]],
    ]);
    let all = warned(&pieces);
    assert_eq!(all.len(), 1, "{all:?}");
    assert_eq!(all[0].id, grainpath_core::WarningId::PartInMidAir);
    assert!(all[0].text.contains("2 places") && all[0].text.contains("40.00 mm2"), "{}", all[0].text);
    let at = all[0].place.as_ref().map(|p| p.point_mm.clone()).expect("a place");
    assert!((at[0] + 15.0).abs() < 0.1 && (at[1] - 2.0).abs() < 0.1 && (at[2] - 10.0).abs() < 0.21, "{at:?}");
}

#[test]
fn tips_move_as_beam_theory_says_and_no_further_than_allowed() {
    let s = job_settings();
    // A straight trunk of one radius: F L^3 / (3 E I).
    let node = |z: f64, below: Option<u32>, kind: Kind| Node {
        at: DVec3::new(0.0, 0.0, z),
        radius_mm: 2.0,
        end_mm: 2.0,
        carries: 1,
        top_mm: 40.0,
        below,
        kind,
        post: false,
    };
    let nodes = vec![node(40.0, Some(1), Kind::Contact(0)), node(0.0, None, Kind::Foot)];
    // A part that is far away.
    let stack = layers(&boxes(&[[[20.0, 0.0, 0.0], [30.0, 10.0, 45.0]]]), &Diagnostics::default());
    let bed = Bounds2 { min: DVec2::splat(-100.0), max: DVec2::splat(100.0) };
    let clearance = Clearance::new(&stack, bed, 40.0, 1.0, s.branch_angle_rad);
    let found = bending::tip_bending(&Forest { nodes, ..Forest::default() }, &clearance, &s);
    let wall = s.beads.bead_width_mm;
    let second = 0.25 * std::f64::consts::PI * (2f64.powi(4) - (2.0 - wall).powi(4));
    let exact = s.side_load_n * 40f64.powi(3) / (3.0 * s.stiffness_mpa * second);
    assert!((found.worst_mm / exact - 1.0).abs() < 0.002, "{} and {exact}", found.worst_mm);
    // A slender trunk is warned of, a stout one of little height is not.
    let post =
        |top: f64| boxes(&[[[0.0; 3], [4.0, 4.0, top + 3.0]], [[0.0, 0.0, top], [14.0, 4.0, top + 3.0]]]);
    let radius_mm = |s: &Support| s.forest.nodes.iter().map(|n| n.radius_mm).fold(0.0, f64::max);
    let (slender, ..) = planned(&post(60.0), |s| s.side_load_n = 0.0);
    for (top, load_n, bends) in
        [(60.0, 1.0, true), (60.0, 0.1, false), (60.0, 0.0, false), (5.0, 0.01, false)]
    {
        let (held, _, warnings) = planned(&post(top), |s| s.side_load_n = load_n);
        // No thicker than it has to be: what it may move is used.
        if (top, load_n) == (60.0, 0.1) {
            let limit_mm = s.tip_moves_at_most_mm();
            assert!((0.9 * limit_mm..=limit_mm).contains(&held.bending.worst_mm), "{:?}", held.bending);
            assert!(radius_mm(&held) > 1.5 * radius_mm(&slender), "{} mm", radius_mm(&held));
        }
        assert_eq!(held.bending.over > 0, bends, "{top} mm, {load_n} N: {:?}", held.bending);
        assert_eq!(warnings.iter().any(|w| w.id == grainpath_core::WarningId::SupportBends), bends);
    }
}

#[test]
fn trunks_close_to_a_wall_move_to_where_they_can_be_thick_enough() {
    // A tower with a narrow ledge near its top, alone and with a wall that leaves a slot of 4 mm below the ledge.
    let tower = [[[-5.0, -5.0, 0.0], [5.0, 5.0, 63.0]], [[-5.0, -5.0, 60.0], [8.0, 5.0, 63.0]]];
    let slot = [&tower[..], &[[[9.0, -30.0, 0.0], [15.0, 30.0, 63.0]]]].concat();
    for (parts, has_room) in [(&tower[..], true), (&slot[..], false)] {
        let (support, _, warnings) = planned(&boxes(parts), |_| ());
        let bends = warnings.iter().any(|w| w.id == grainpath_core::WarningId::SupportBends);
        assert_eq!((support.bending.over == 0, bends), (has_room, !has_room), "{:?}", support.bending);
        assert!(support.forest.steepest_rad().to_degrees() <= 40.0);
        assert!(support.unreached.is_empty() && support.cut.lost.is_empty(), "{:?}", support.unreached);
        // A tip leaves the ledge beside the wall; the foot has room for the thickest trunk.
        let feet = support.forest.nodes.iter().filter(|n| n.kind == Kind::Foot);
        let nearest = feet.map(|n| n.at.x - 5.0).fold(f64::INFINITY, f64::min);
        assert_eq!(nearest > 2.5, has_room, "{nearest} mm from the tower");
    }
}

#[test]
fn trees_do_not_depend_on_how_the_surface_is_cut_into_triangles() {
    // Every triangle in three about a point of its own, or in four about the middles of its sides.
    let in_three = |mesh: &TriMesh| {
        let mut out = TriMesh { vertices: mesh.vertices.clone(), triangles: Vec::new() };
        for (k, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            let [p, q, r] = [a, b, c].map(|i| mesh.vertices[i as usize]);
            let (u, v) = ([0.2, 0.37, 0.61][k % 3], [0.3, 0.11, 0.25][k % 3]);
            let middle = out.vertices.len() as u32;
            out.vertices.push(p + u * (q - p) + v * (r - p));
            out.triangles.extend([[a, b, middle], [b, c, middle], [c, a, middle]]);
        }
        out.triangles.reverse();
        out
    };
    let in_four = |mesh: &TriMesh| {
        let mut out = TriMesh { vertices: mesh.vertices.clone(), triangles: Vec::new() };
        let mut middles = std::collections::BTreeMap::new();
        for &[a, b, c] in &mesh.triangles {
            let [x, y, z] = [(a, b), (b, c), (c, a)].map(|(i, j)| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    out.vertices.push(0.5 * (mesh.vertices[i as usize] + mesh.vertices[j as usize]));
                    out.vertices.len() as u32 - 1
                })
            });
            out.triangles.extend([[x, y, z], [a, x, z], [x, b, y], [z, y, c]]);
        }
        out
    };
    // Flat, and with an underside that leans in both directions; on the grid of the samples and beside it.
    for (lean, shift) in [(DVec2::ZERO, 0.0), (DVec2::ZERO, 0.3), (DVec2::new(0.21, 0.13), 0.3)] {
        let mut whole = table(false);
        for p in &mut whole.vertices {
            p.z += if p.z > 6.0 { lean.dot(p.truncate()) } else { 0.0 };
            *p += DVec3::new(shift, -shift, 0.0);
        }
        let (support, ..) = planned(&whole, |_| ());
        let places = |s: &Support| -> Vec<DVec3> { s.overhangs.contacts.iter().map(|c| c.at).collect() };
        assert!(places(&support).len() > 20);
        for cut in [in_three(&whole), in_four(&whole), in_three(&in_four(&whole))] {
            let (other, ..) = planned(&cut, |_| ());
            assert_eq!(places(&other), places(&support), "{lean}, {shift}");
            assert_eq!(other.overhangs.lines, support.overhangs.lines);
            let mm = |s: &Support| s.cut.layers.iter().map(|l| l.region.area_mm2()).sum::<f64>();
            assert!((mm(&other) / mm(&support) - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn gaps_pads_and_tips_are_as_asked() {
    let (support, stack, _) = planned(&table(false), |s| {
        s.interface_layers = 2;
        s.z_gap_mm = 0.3;
    });
    // The top begins in the layer that ends at 12.2 mm; two layers of 0.2 mm below it stay free.
    let top = support.cut.layers.iter().rposition(|l| !l.region.is_empty()).expect("support");
    assert!((stack.layers()[top].z_top_mm() - 11.6).abs() < 1e-9, "{}", stack.layers()[top].z_top_mm());
    let pads = |k: usize| support.cut.layers[k].interface.area_mm2();
    assert!(pads(top) > 50.0 && pads(top - 1) > 50.0 && pads(top - 2) == 0.0);
    assert!(support.forest.steepest_rad().to_degrees() <= 40.0);
}

/// A wedge of 60 mm in mid-air, 20 mm up, with an edge of this width down and turned in plan. Its flanks lean by 30 degrees
/// from the vertical and need no support.
fn blade(edge_mm: f64, turn_deg: f64) -> TriMesh {
    let mut mesh = boxes(&[[[-30.0, -0.5, 20.0], [30.0, 0.5, 24.0]]]);
    for v in &mut mesh.vertices {
        let width_mm = edge_mm + 2.0 * (v.z - 20.0) * grainpath_core::math::tan(30f64.to_radians());
        let turned = DVec2::from_angle(turn_deg.to_radians()).rotate(DVec2::new(v.x, v.y * width_mm));
        *v = turned.extend(v.z);
    }
    mesh
}

/// Samples of an overhang lie 1 mm apart on a grid, which misses most of a narrower edge.
#[test]
fn edges_narrower_than_the_grid_of_samples_are_held_along_their_length() {
    for edge_mm in [0.01, 0.05, 0.2, 0.4, 1.0, 1.6] {
        for turn_deg in [0.0, 10.0, 37.0, 45.0, 90.0] {
            let (support, ..) = planned(&blade(edge_mm, turn_deg), |_| ());
            let contacts = &support.overhangs.contacts;
            let farthest_mm = (0..=120).map(|i| {
                let p = DVec2::from_angle(turn_deg.to_radians()) * (f64::from(i) * 0.5 - 30.0);
                contacts.iter().map(|c| c.at.distance(p.extend(20.0))).fold(f64::INFINITY, f64::min)
            });
            let farthest_mm = farthest_mm.fold(0.0, f64::max);
            println!("{edge_mm} mm at {turn_deg}: {} contacts, {farthest_mm:.2} mm", contacts.len());
            // Half of the longest stretch over air, and half a step of the grid for points between samples.
            assert!(farthest_mm < 5.5, "{edge_mm} mm at {turn_deg} degrees: {farthest_mm} mm from a contact");
            assert!(contacts.len() < 30, "{edge_mm} mm at {turn_deg} degrees: {} contacts", contacts.len());
        }
    }
}

#[test]
fn baselines_stand_below_every_overhang() {
    for style in [Style::Columns, Style::Box] {
        let (support, stack, _) = planned(&table(false), |s| s.style = style);
        let trees = planned(&table(false), |_| ()).0.volume_mm3(&stack);
        let area = support.cut.layers[10].region.area_mm2();
        assert!(area > 1500.0 && support.volume_mm3(&stack) > 2.0 * trees, "{style:?}: {area}");
    }
}

#[test]
fn cones_meet_at_their_highest_common_point() {
    // The highest point that both cones reach, found by search.
    let slope = grainpath_core::math::tan(40f64.to_radians());
    for (p, q) in [
        ((0.0, 0.0, 30.0), (8.0, 3.0, 26.0)),
        ((1.0, 2.0, 20.0), (9.0, -3.0, 20.0)),
        ((0.0, 0.0, 30.0), (1.0, 0.0, 5.0)),
    ] {
        let (p, q) = (DVec3::from(p), DVec3::from(q));
        let m = cones_meet(p, q, slope);
        assert_eq!(m, cones_meet(q, p, slope));
        let reached = |m: DVec3, a: DVec3| (m - a).truncate().length() <= (a.z - m.z) * slope + 1e-9;
        assert!(reached(m, p) && reached(m, q), "{m}");
        let mut highest = f64::NEG_INFINITY;
        for i in 0..=400 {
            let at = p.truncate().lerp(q.truncate(), f64::from(i) / 400.0);
            let z = |a: DVec3| a.z - (at - a.truncate()).length() / slope;
            highest = highest.max(z(p).min(z(q)));
        }
        assert!((m.z - highest).abs() < 0.05, "{} and {highest}", m.z);
    }
}
