//! Modifier volumes of 3MF projects become regions, and no part of the solid.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{Cursor, Write};

use grainpath::run::{Inputs, Planned, plan_job};
use grainpath_core::{Diagnostics, Role};
use grainpath_io::{MeshFile, parse_mesh};
use grainpath_job::parse_job;

const RELATIONSHIPS: &str = r#"<Relationships><Relationship Target="/3D/m.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
const TYPES: &str = r#"<Types><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/><Default Extension="config" ContentType="text/xml"/></Types>"#;

/// Boxes as one mesh element, 12 triangles each, in order.
fn boxes(all: &[[[f64; 3]; 2]]) -> String {
    let (mut vertices, mut triangles) = (String::new(), String::new());
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for (n, corners) in all.iter().enumerate() {
        for k in 0..8 {
            let [x, y, z] = [0, 1, 2].map(|axis| corners[k >> axis & 1][axis]);
            let _ = write!(vertices, r#"<vertex x="{x}" y="{y}" z="{z}"/>"#);
        }
        for f in faces {
            let f = f.map(|v| v + 8 * n);
            for [a, b, c] in [[f[0], f[1], f[2]], [f[0], f[2], f[3]]] {
                let _ = write!(triangles, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#);
            }
        }
    }
    format!("<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>")
}

fn package(resources: &str, item: &str, config: (&str, &str)) -> Vec<u8> {
    let model = format!(
        r#"<?xml version="1.0" encoding="UTF-8"?><model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>{resources}</resources><build>{item}</build></model>"#
    );
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let parts = [
        ("[Content_Types].xml", TYPES),
        ("_rels/.rels", RELATIONSHIPS),
        ("3D/m.model", model.as_str()),
        config,
    ];
    for (name, text) in parts {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).expect("memory");
        zip.write_all(text.as_bytes()).expect("memory");
    }
    zip.finish().expect("memory").into_inner()
}

const SOLID: [[f64; 3]; 2] = [[0.0, 0.0, 0.0], [30.0, 20.0, 6.0]];
/// The right third, and a millimetre more on every side.
const RIGHT: [[f64; 3]; 2] = [[20.0, -1.0, -1.0], [31.0, 21.0, 7.0]];
const OTHER: [[f64; 3]; 2] = [[2.0, 2.0, 2.0], [5.0, 5.0, 9.0]];

/// A part of 30 x 20 x 6 mm with a modifier and a negative volume, as PrusaSlicer writes it.
fn prusa() -> Vec<u8> {
    let config = r#"<?xml version="1.0" encoding="UTF-8"?><config><object id="1" instances_count="1">
<metadata type="object" key="name" value="part"/>
<volume firstid="0" lastid="11"><metadata type="volume" key="name" value="part"/><metadata type="volume" key="volume_type" value="ModelPart"/></volume>
<volume firstid="12" lastid="23"><metadata type="volume" key="name" value="block"/><metadata type="volume" key="volume_type" value="ParameterModifier"/>
<metadata type="volume" key="matrix" value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/><metadata type="volume" key="source_offset_x" value="0"/>
<metadata type="volume" key="fill_density" value="100%"/><metadata type="volume" key="fill_pattern" value="rectilinear"/><metadata type="volume" key="fill_angle" value="30"/>
<metadata type="volume" key="perimeters" value="4"/><metadata type="volume" key="infill_speed" value="35"/></volume>
<volume firstid="24" lastid="35"><metadata type="volume" key="name" value="cut"/><metadata type="volume" key="volume_type" value="NegativeVolume"/></volume>
</object></config>"#;
    let object = format!(r#"<object id="1" type="model">{}</object>"#, boxes(&[SOLID, RIGHT, OTHER]));
    let item = r#"<item objectid="1" transform="1 0 0 0 1 0 0 0 1 40 50 0"/>"#;
    package(&object, item, ("Metadata/Slic3r_PE_model.config", config))
}

/// The same, as OrcaSlicer and Bambu Studio write it.
fn orca() -> Vec<u8> {
    let config = r#"<?xml version="1.0" encoding="UTF-8"?><config><object id="9"><metadata key="name" value="part"/>
<part id="1" subtype="normal_part"><metadata key="name" value="part"/></part>
<part id="2" subtype="modifier_part"><metadata key="name" value="block"/><metadata key="matrix" value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/>
<metadata key="extruder" value="0"/><metadata key="sparse_infill_density" value="100%"/><metadata key="sparse_infill_pattern" value="zig-zag"/><metadata key="infill_direction" value="30"/>
<metadata key="wall_loops" value="4"/><metadata key="inner_wall_speed" value="35"/><mesh_stat edges_fixed="0"/></part>
<part id="3" subtype="support_enforcer"><metadata key="name" value="cut"/></part></object></config>"#;
    // In real projects each object is in a part of its own; what counts is that each is a component.
    // The modifier lies at the origin and is moved by its component.
    let at_origin = RIGHT.map(|[x, y, z]| [x - 20.0, y, z]);
    let object = |id: usize, kind: &str, corners| {
        format!(r#"<object id="{id}" type="{kind}">{}</object>"#, boxes(&[corners]))
    };
    let resources = [object(1, "model", SOLID), object(2, "other", at_origin), object(3, "other", OTHER)];
    let components = r#"<object id="9" type="model"><components><component objectid="1"/><component objectid="2" transform="1 0 0 0 1 0 0 0 1 20 0 0"/><component objectid="3"/></components></object>"#;
    let item = r#"<item objectid="9" transform="1 0 0 0 1 0 0 0 1 40 50 0"/>"#;
    package(&(resources.concat() + components), item, ("Metadata/model_settings.config", config))
}

fn planned(mesh: MeshFile, sets: &[&str]) -> (Planned, Vec<String>) {
    let usual = ["fill.density=0.15", "fill.pattern=gyroid", "process.walls=2", "process.skirt_loops=0"];
    let sets: Vec<String> = usual.iter().chain(sets).map(|s| (*s).to_owned()).collect();
    let settings = parse_job("", "job.toml", &sets, &|path| Err(path.to_owned())).expect("a sound job");
    let inputs = Inputs {
        mesh,
        path: "part.3mf".into(),
        stress: None,
        deck: None,
        directions: None,
        densities: None,
        photos: Vec::new(),
        texture: None,
        regions: BTreeMap::new(),
        known: None,
    };
    let diagnostics = Diagnostics::default();
    let planned = plan_job(&settings, inputs, &diagnostics).expect("a sound job");
    (planned, diagnostics.warnings().iter().map(ToString::to_string).collect())
}

/// Volume of infill of a layer left and right of the border, mm3, in coordinates of the part.
fn infill(planned: &Planned, layer: usize, border_mm: f64) -> [f64; 2] {
    let layer = &planned.plan.layers[layer];
    let mut sums = [0.0; 2];
    for path in layer.paths.iter().map(|p| &p.path).filter(|p| p.role.is_fill() && p.role != Role::GapFill) {
        for k in 0..path.n_segments() {
            let (a, b, w) = path.segment(k);
            let area = grainpath_core::units::bead_area_mm2(w, layer.height_mm);
            sums[usize::from(0.5 * (a.x + b.x) > border_mm)] += a.distance(b) * area * path.flow;
        }
    }
    sums
}

#[test]
fn modifiers_are_read_apart_from_the_solid() {
    for (name, bytes, left_out) in [("prusa", prusa(), "negative"), ("orca", orca(), "enforcer")] {
        let file = parse_mesh(&bytes, Some("part.3mf")).expect("a sound project");
        assert_eq!((file.bodies.len(), file.modifiers.len()), (1, 1), "{name}");
        let volume = file.bodies[0].mesh.signed_volume();
        assert!((volume - 30.0 * 20.0 * 6.0).abs() < 1e-6, "{name}: {volume}");
        assert_eq!(file.bodies[0].mesh.triangles.len(), 12, "{name}");
        let modifier = &file.modifiers[0];
        assert_eq!(modifier.name.as_deref(), Some("block"));
        let low = modifier.mesh.vertices.iter().copied().reduce(|a, b| a.min(b)).expect("vertices");
        let high = modifier.mesh.vertices.iter().copied().reduce(|a, b| a.max(b)).expect("vertices");
        // Where the item stands: 40, 50 mm on the plate.
        assert_eq!((low.to_array(), high.to_array()), ([60.0, 49.0, -1.0], [71.0, 71.0, 7.0]), "{name}");
        let told: Vec<String> = file.warnings.iter().map(ToString::to_string).collect();
        assert!(told.len() == 1 && told[0].contains("cut") && told[0].contains(left_out), "{name}: {told:?}");
    }
}

#[test]
fn the_settings_of_a_modifier_hold_in_its_volume() {
    let mut plans = Vec::new();
    for (name, bytes, unread) in
        [("prusa", prusa(), "infill_speed = 35"), ("orca", orca(), "inner_wall_speed = 35")]
    {
        let file = parse_mesh(&bytes, Some("part.3mf")).expect("a sound project");
        let (planned, told) = planned(file, &[]);
        let named: Vec<&String> = told.iter().filter(|t| t.contains("modifier \"block\"")).collect();
        assert!(
            named.len() == 1 && named[0].contains(unread) && !named[0].contains("matrix"),
            "{name}: {told:?}"
        );
        let bounds = planned.stack.layers()[0].region().bounds().expect("a section");
        assert!((bounds.size().x - 30.0).abs() < 1e-6 && planned.stack.layers().len() == 30, "{name}");
        let layer = planned.stack.layers().len() / 2;
        let border = bounds.min.x + 20.0;
        let [left, right] = infill(&planned, layer, border);
        // Volumes are compared with the areas inside the walls, to a bead at the border between both.
        // Dense inside four walls on the right, sparse inside two on the left.
        let wall = 0.225 + 0.407 * 3.5;
        let inside = (10.0 - wall) * (20.0 - 2.0 * wall) * 0.2;
        assert!((right / inside - 1.0).abs() < 0.08, "{name}: {right} of {inside}");
        let inside = (20.0 - 0.84) * (20.0 - 2.0 * 0.84) * 0.2;
        assert!((left / inside - 0.15).abs() < 0.06, "{name}: {left} of {inside}");
        plans.push(planned.plan.layers);
    }
    assert!(plans[0] == plans[1], "both programs say the same part");
}

#[test]
fn a_modifier_that_cannot_be_used_is_told_of() {
    let file = || parse_mesh(&prusa(), Some("part.3mf")).expect("a sound project");
    // Another one, far off; one without settings; and one whose pattern needs what the job lacks.
    let mut far = file();
    far.modifiers[0].mesh.vertices.iter_mut().for_each(|p| p.x += 100.0);
    let mut empty = file();
    empty.modifiers[0].settings.clear();
    let mut unknown = file();
    unknown.modifiers[0].settings =
        vec![("fill_pattern".into(), "hilbertcurve".into()), ("fill_density".into(), "140%".into())];
    for (file, expected) in [
        (far, "lies outside the part"),
        (empty, "changes no setting"),
        (unknown, "fill_pattern = hilbertcurve, fill_density = 140%"),
    ] {
        let (planned, told) = planned(file, &[]);
        assert!(told.iter().any(|t| t.contains("modifier \"block\"") && t.contains(expected)), "{told:?}");
        let bounds = planned.stack.layers()[0].region().bounds().expect("a section");
        let [left, right] = infill(&planned, 15, bounds.min.x + 20.0);
        assert!(right < 0.8 * left, "sparse everywhere: {left} {right}");
    }
}

/// A hostile description names the same triangles over and over, or more volumes than anybody makes. Copies would fill the
/// memory.
#[test]
fn volumes_that_share_triangles_or_are_too_many_are_taken_for_solid() {
    let volume = |range: [usize; 2]| {
        format!(
            r#"<volume firstid="{}" lastid="{}"><metadata type="volume" key="volume_type" value="ParameterModifier"/></volume>"#,
            range[0], range[1]
        )
    };
    let many = "<volume/>".repeat(1001);
    for (volumes, reason) in [
        (volume([0, 11]) + &volume([11, 23]), "share triangles"),
        (volume([20, 12]), "share triangles"),
        (many, "1000"),
    ] {
        let config = format!(r#"<config><object id="1">{volumes}</object></config>"#);
        let object = format!(r#"<object id="1" type="model">{}</object>"#, boxes(&[SOLID, RIGHT]));
        let bytes = package(&object, r#"<item objectid="1"/>"#, ("Metadata/Slic3r_PE_model.config", &config));
        let file = parse_mesh(&bytes, None).expect("a part");
        let triangles: usize = file.bodies.iter().map(|b| b.mesh.triangles.len()).sum();
        assert_eq!((triangles, file.modifiers.len()), (24, 0), "{reason}");
        assert!(file.warnings.iter().any(|w| w.text.contains(reason)), "{reason}: {:?}", file.warnings);
    }
}
