//! Regions with settings of their own: the seam at their borders, walls and skins of their own, later ones win.

use std::collections::BTreeMap;

use grainpath::region::{RegionAreas, RegionError, RegionPart};
use grainpath::run::{Steps, config};
use grainpath::shape::Standing;
use grainpath_core::math::{direction, rotated};
use grainpath_core::poly::{FillRule, LineClipper};
use grainpath_core::units::{bead_area_mm2, bead_spacing_mm};
use grainpath_core::{
    DVec2, DVec3, Diagnostics, Layer, LayerPlan, LayerStack, Polygon, Region, Role, TriMesh, WarningId,
};
use grainpath_io::{MeshBody, MeshFile};
use grainpath_job::parse_job;

const LAYERS: usize = 12;

fn turned(r: &Region, turn_rad: f64) -> Region {
    let turn = direction(turn_rad);
    let outer = r.polygons[0].outer.iter().map(|&p| rotated(p, turn)).collect();
    Region::from(Polygon { outer, holes: Vec::new() })
}

/// A block of which the four corners in plan and the heights are given.
fn block(plan: &Region, low: f64, high: f64) -> TriMesh {
    let p = &plan.polygons[0].outer;
    let vertices = [low, high].iter().flat_map(|&z| p.iter().map(move |q| q.extend(z))).collect();
    let mut triangles = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    for k in 0..4 {
        let n = (k + 1) % 4;
        triangles.extend([[k, n, n + 4], [k, n + 4, k + 4]]);
    }
    TriMesh { vertices, triangles }
}

struct Outcome {
    layers: Vec<LayerPlan>,
    warnings: Vec<WarningId>,
}

/// Plans a plate of 40 x 30 mm, turned, with the regions of a job and perhaps a mesh for the first of them.
fn planned(job: &str, turn_rad: f64, mesh: Option<TriMesh>) -> Result<Outcome, RegionError> {
    let settings = parse_job(job, "job.toml", &[], &|path| Err(path.to_owned())).expect("a sound job");
    let section = turned(&Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 30.0)), turn_rad);
    let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section.clone()).expect("a sound layer");
    let stack = LayerStack::new((0..LAYERS).map(layer).collect()).expect("heights rise");
    let surface = block(&section, 0.0, 0.2 * LAYERS as f64);
    let file = |mesh| MeshFile {
        modifiers: Vec::new(),
        bodies: vec![MeshBody { mesh, ..MeshBody::default() }],
        unit: None,
        warnings: vec![],
    };
    let meshes: BTreeMap<usize, MeshFile> = mesh.into_iter().map(|mesh| (0, file(mesh))).collect();
    let part = RegionPart {
        stack: &stack,
        mesh: &surface,
        standing: Standing::new(1.0, [0.0; 3], 0.0),
        unit_mm: 1.0,
        unit_of_file: true,
        slicing: config::placing(&settings).slicing,
    };
    let diagnostics = Diagnostics::default();
    let areas = RegionAreas::new(&settings, &meshes, &part, &diagnostics)?;
    let (step_settings, order) = (config::steps(&settings), config::order(&settings));
    let mut layers = Vec::new();
    Steps::new(&step_settings, &stack)
        .with_regions(Some(&areas))
        .in_windows(5, settings.fill.density.even().expect("a number"), &order, &diagnostics, |layer| {
            layers.push(layer)
        })
        .expect("not stopped");
    Ok(Outcome { layers, warnings: diagnostics.warnings().iter().map(|w| w.id).collect() })
}

/// Share of a band that no bead reaches, and the volume laid in it over its own, less one.
fn gap_and_surplus(layer: &LayerPlan, band: &Region) -> (f64, f64) {
    let clipper = LineClipper::new(band);
    let (mut volume, mut beads) = (0.0, Vec::new());
    for path in layer.paths.iter().map(|p| &p.path).filter(|p| p.role.is_part()) {
        for k in 0..path.n_segments() {
            let (a, b, width) = path.segment(k);
            for piece in clipper.clip(&[a, b]) {
                let length: f64 = piece.points.windows(2).map(|w| w[0].distance(w[1])).sum();
                volume += length * bead_area_mm2(width, layer.height_mm);
            }
            beads.push(Region::around_line(&[a, b], false, 0.5 * width));
        }
    }
    let covered = Region::from_contours(beads.iter().flat_map(Region::contours), FillRule::NonZero);
    let area = band.area_mm2();
    let open = band.difference(&covered).area_mm2();
    (open / area, volume / (area * layer.height_mm) - 1.0)
}

/// The face at x = 40 of the plate, by its name.
fn right_face() -> String {
    let plate = block(&Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 30.0)), 0.0, 0.2 * LAYERS as f64);
    let faces = grainpath_core::faces::Faces::segment(&plate);
    let right =
        (0..faces.len()).find(|&f| (faces.all()[f].centroid - DVec3::new(40.0, 15.0, 1.2)).length() < 1e-6);
    faces.name(right.expect("a plane at x = 40"))
}

#[test]
fn a_seam_between_dense_regions_is_closed_and_laid_once() {
    let s = bead_spacing_mm(0.45, 0.2);
    let square = |low: [f64; 2], high: [f64; 2]| Region::rectangle(DVec2::from(low), DVec2::from(high));
    // Places of a border, each with the turn of the plate and the area inside the border.
    let inner = square([11.3, 8.1], [27.7, 21.9]);
    let turn = 37f64.to_radians();
    let face = format!("{{ face = \"{}\", depth_mm = 11.3 }}", right_face());
    let within = "{ box_mm = [[11.3, 8.1, 0], [27.7, 21.9, 9]] }".to_owned();
    let across = "{ box_mm = [[17.3, -99, 0], [99, 99, 9]] }".to_owned();
    let slanted = "{ box_mm = [[7.3, -99, 0], [99, 99, 9]] }".to_owned();
    let mesh = "{ mesh = \"inner.stl\" }".to_owned();
    let places = [
        ("box", within, 0.0, inner.clone()),
        ("box through the section", across, 0.0, square([17.3, -99.0], [99.0, 99.0])),
        ("box through the turned section", slanted, turn, square([7.3, -99.0], [99.0, 99.0])),
        ("mesh", mesh.clone(), 0.0, inner.clone()),
        ("turned mesh", mesh, turn, turned(&inner, turn)),
        ("depth below a face", face, 0.0, square([28.7, -99.0], [99.0, 99.0])),
    ];
    // Infill of the part and of the region.
    let lines = |angles: &str| format!("pattern = \"rectilinear\", density = 1, angles_deg = {angles}");
    let dense = |pattern: &str| format!("pattern = \"{pattern}\", density = 1");
    let pairs = [
        (lines("[45, -45]"), lines("[0, 90]")),
        (lines("[45, -45]"), lines("[20, 110]")),
        (lines("[45, -45]"), lines("[45, -45]")),
        (lines("[45, -45]"), dense("concentric")),
        (dense("stripes"), lines("[10, 100]")),
        (dense("gyroid"), dense("honeycomb")),
        (lines("[30, 120]"), dense("continuous")),
        // Skins over sparse infill.
        ("density = 0.2".to_owned(), "pattern = \"grid\", density = 0.3, angles_deg = [20, 110]".to_owned()),
    ];
    let (mut wrong, mut worst) = (Vec::new(), [0.0f64; 2]);
    for (name, on, turn_rad, area) in &places {
        // Up to the strips of the walls, a bead on each side of the border.
        let section = turned(&Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 30.0)), *turn_rad);
        let ring = |mm| area.offset(mm, grainpath_core::poly::Join::Miter(3.0));
        let filled = section.offset(-0.225 - 1.5 * s, grainpath_core::poly::Join::Miter(3.0));
        let band = ring(s).difference(&ring(-s)).intersection(&filled);
        for (of_part, of_region) in &pairs {
            // Stripes need a guide, which the region does not follow.
            let [guide, without] = match of_part.contains("stripes") {
                true => ["guide = { kind = \"angle\", angle_deg = 70 }", "guide = false"],
                false => [""; 2],
            };
            let job = format!(
                "fill = {{ {of_part} }}\n{guide}\n[[region]]\non = {on}\nfill = {{ {of_region} }}\n{without}\n"
            );
            let outcome = planned(&job, *turn_rad, Some(block(area, -1.0, 5.0))).expect("inside");
            let (gap, surplus) = gap_and_surplus(&outcome.layers[1], &band);
            worst = [worst[0].max(gap), worst[1].max(surplus.abs())];
            if gap > 0.005 || surplus.abs() > 0.015 {
                wrong.push(format!("{name}, {of_part}, {of_region}: gap {gap:.4}, {surplus:+.4}"));
            }
        }
    }
    println!("worst gap {:.4}, volume {:.4} off", worst[0], worst[1]);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_region_has_its_own_walls_density_and_skins() {
    let on = "on = { box_mm = [[20, -1, 0], [50, 50, 1.2]] }";
    let job = format!(
        "[fill]\npattern = \"grid\"\ndensity = 0.2\n[process]\ntop_layers = 2\nbottom_layers = 2\n[[region]]\n{on}\n\
         fill = {{ pattern = \"aligned\", density = 0.5, angles_deg = [10] }}\n\
         process = {{ walls = 4, bottom_layers = 4 }}\n"
    );
    let outcome = planned(&job, 0.0, None).expect("inside");
    let length = |k: usize, role: Role, right: bool| -> f64 {
        let paths = outcome.layers[k].paths.iter().map(|p| &p.path).filter(|p| p.role == role);
        let segments = paths.flat_map(|p| (0..p.n_segments()).map(|i| p.segment(i)));
        let here = segments.filter(|(a, b, _)| (0.5 * (a.x + b.x) > 20.0) == right);
        here.map(|(a, b, _)| a.distance(b)).sum()
    };
    let s = bead_spacing_mm(0.45, 0.2);
    // Layers 3 and 4 are bottom skin in the region alone, layers 5 and 6 sparse on both sides.
    assert!(length(2, Role::SparseFill, true) == 0.0 && length(2, Role::SolidFill, true) > 1000.0);
    // Masks round the corners of sparse infill, which leaves less than a square millimetre of solid infill in each.
    assert!(length(2, Role::SparseFill, false) > 200.0 && length(2, Role::SolidFill, false) < 10.0);
    let area = |walls: f64| (20.0 - 0.225 - walls * s) * (30.0 - 2.0 * (0.225 + walls * s));
    for k in [4, 5] {
        let density = |right: bool, walls: f64| length(k, Role::SparseFill, right) * s / area(walls);
        assert!((density(true, 4.0) - 0.5).abs() < 0.05, "layer {k}: {}", density(true, 4.0));
        // What joins lines along the border adds up to a third to a grid this coarse in an area this small.
        assert!((0.19..0.27).contains(&density(false, 2.0)), "layer {k}: {}", density(false, 2.0));
        // The second wall all around, and the third and fourth in the region alone, as far as half a strip from its border.
        let walls = length(k, Role::InnerWall, false) + length(k, Role::InnerWall, true);
        let inset = |depth: f64| 0.225 + depth * s;
        let open = |depth: f64| 2.0 * (20.0 - 0.5 * s - inset(depth)) + 30.0 - 2.0 * inset(depth);
        let expected = 140.0 - 8.0 * inset(1.0) + open(2.0) + open(3.0);
        assert!((walls - expected).abs() < 0.05, "layer {k}: {walls} {expected}");
    }
    // Above 1.2 mm there is no region.
    let above = length(7, Role::InnerWall, false) + length(7, Role::InnerWall, true);
    assert!((above - (140.0 - 8.0 * (0.225 + s))).abs() < 0.05, "{above}");
}

#[test]
fn later_regions_win_and_those_outside_are_refused() {
    let two = "[fill]\ndensity = 0.2\n[process]\ntop_layers = 0\nbottom_layers = 0\n\
               [[region]]\non = { layers = [[1, 6]] }\nfill = { density = 0 }\n\
               [[region]]\non = { layers = [[4, 12]] }\nfill = { density = 0.4 }\n";
    let outcome = planned(two, 0.0, None).expect("inside");
    assert_eq!(outcome.warnings, [WarningId::RegionsOverlap]);
    for (k, layer) in outcome.layers.iter().enumerate() {
        let sparse = layer.paths.iter().any(|p| p.path.role == Role::SparseFill);
        assert_eq!(sparse, k >= 3, "layer {k}");
    }
    for on in ["{ box_mm = [[100, 0, 0], [110, 9, 9]] }", "{ layers = [[13, 20]] }"] {
        let job = format!(
            "[[region]]\non = {{ layers = [[1, 2]] }}\nfill = {{ density = 0.5 }}\n\
             [[region]]\non = {on}\nfill = {{ density = 0.5 }}\n"
        );
        let refused = planned(&job, 0.0, None).err().expect("outside");
        assert_eq!(refused.to_string(), "region[2] lies outside the part: no layer has any of it");
    }
}

#[test]
fn a_depth_below_a_face_is_a_region() {
    let name = right_face();
    let job = format!(
        "[fill]\ndensity = 0\n[process]\ntop_layers = 0\nbottom_layers = 0\n[[region]]\non = {{ face = \"{name}\", depth_mm = 5 }}\n\
         fill = {{ pattern = \"rectilinear\", density = 1, angles_deg = [0] }}\n"
    );
    let outcome = planned(&job, 0.0, None).expect("inside");
    let fill = outcome.layers[5].paths.iter().map(|p| &p.path).filter(|p| p.role == Role::SolidFill);
    // Corners of the hollow rest are solid, by less than a square millimetre each.
    let x: Vec<f64> =
        fill.filter(|p| p.length_mm() > 20.0).flat_map(|p| p.points.iter().map(|q| q.x)).collect();
    let (low, high) = x.iter().fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
    let s = bead_spacing_mm(0.45, 0.2);
    assert!((low - (35.0 + 0.5 * s)).abs() < 0.02, "{low}");
    assert!(high > 38.0 && high < 40.0, "{high}");
}

/// Defects are told as those of the part are, and the region is that of the sound mesh.
#[test]
fn the_mesh_of_a_region_is_mended_as_that_of_the_part() {
    let sound = block(&Region::rectangle(DVec2::new(11.3, 8.1), DVec2::new(27.7, 21.9)), -1.0, 5.0);
    let job = "fill.density = 0.2\n[[region]]\non = { mesh = \"inner.stl\" }\nfill = { density = 0.6 }\n";
    let laid_mm = |outcome: &Outcome| {
        let paths = outcome.layers[6].paths.iter().filter(|p| p.path.role == Role::SparseFill);
        paths.map(|p| p.path.length_mm()).sum::<f64>()
    };
    let want = planned(job, 0.0, Some(sound.clone())).expect("inside");
    assert_eq!(want.warnings, []);
    for every in [1, 2, 5] {
        let mut mesh = sound.clone();
        mesh.triangles.iter_mut().step_by(every).for_each(|t| t.swap(0, 1));
        let found = planned(job, 0.0, Some(mesh)).expect("inside");
        let is_told =
            !found.warnings.is_empty() && found.warnings.iter().all(|w| *w == WarningId::MeshRepaired);
        assert!(is_told, "{every}: {:?}", found.warnings);
        let (found, want) = (laid_mm(&found), laid_mm(&want));
        assert!((found / want - 1.0).abs() < 1e-3, "{every}: {found} for {want}");
    }
    let sheet = TriMesh { triangles: sound.triangles[..2].to_vec(), ..sound };
    let refused = planned(job, 0.0, Some(sheet)).err().expect("a sheet");
    assert!(refused.to_string().starts_with("region[1].on.mesh: no closed volume:"), "{refused}");
}
