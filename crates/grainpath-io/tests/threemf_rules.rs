//! A 3MF package that breaks one rule of the specification is refused or read with a warning that names the section.

use std::io::{Cursor, Write};

use grainpath_io::parse_mesh;

const TYPES: &str = r#"<Types><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"#;
const RELATIONSHIPS: &str = r#"<Relationships><Relationship Target="/3D/m.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
const MODEL: &str = r##"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" requiredextensions="m p">
<metadata name="Title">a</metadata>
<resources>
<basematerials id="5"><base name="a" displaycolor="#112233"/><base name="b" displaycolor="#112233"/></basematerials>
<m:colorgroup id="6"><m:color color="#112233"/></m:colorgroup>
<object id="1" pid="5" pindex="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3" p1="1"/><triangle v1="0" v2="3" v3="2" pid="6" p1="0"/><triangle v1="1" v2="2" v3="3"/></triangles></mesh></object>
<object id="2"><components><component objectid="1"/></components></object>
</resources>
<build><item objectid="2" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/></build></model>"##;

fn package(types: Option<&str>, relationships: &str, model: impl AsRef<[u8]>) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let parts = [
        ("[Content_Types].xml", types.map(str::as_bytes)),
        ("_rels/.rels", Some(relationships.as_bytes())),
        ("3D/m.model", Some(model.as_ref())),
    ];
    for (name, text) in parts.into_iter().filter_map(|(n, t)| Some((n, t?))) {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).expect("memory");
        zip.write_all(text).expect("memory");
    }
    zip.finish().expect("memory").into_inner()
}

/// All messages about a package: its warnings, or the reason why it is refused.
fn told(bytes: &[u8]) -> Vec<String> {
    parse_mesh(bytes, Some("a.3mf"))
        .map_or_else(|e| vec![e.to_string()], |file| file.warnings.iter().map(ToString::to_string).collect())
}

#[test]
fn a_package_that_keeps_the_rules_is_read_without_a_word() {
    assert_eq!(told(&package(Some(TYPES), RELATIONSHIPS, MODEL)), [""; 0]);
}

/// UTF-16 with and without a byte order mark, in either byte order; characters of one and two units.
#[test]
fn utf_16_is_read_as_utf_8_is() {
    let model = MODEL.replace("UTF-8", "UTF-16").replace("name=\"a\"", "name=\"\u{e9}\u{1f600}\"");
    for mark in ["", "\u{feff}"] {
        let units: Vec<u16> = format!("{mark}{model}").encode_utf16().collect();
        for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
            let text: Vec<u8> = units.iter().flat_map(|u| bytes(*u)).collect();
            let whole = package(Some(TYPES), RELATIONSHIPS, &text);
            assert_eq!(told(&whole), [""; 0]);
            let file = parse_mesh(&whole, Some("a.3mf")).expect("a model");
            assert_eq!(file.bodies[0].mesh.triangles.len(), 4);
            let cut = package(Some(TYPES), RELATIONSHIPS, &text[..text.len() / 2 + 1]);
            assert!(parse_mesh(&cut, Some("a.3mf")).is_err());
        }
    }
}

#[test]
fn each_broken_rule_of_the_model_names_its_section() {
    let second = "<object id=\"3\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/></vertices><triangles/></mesh></object></resources>";
    // Each row breaks one rule by one replacement, so the message can come from that rule only.
    for (from, to, section) in [
        ("encoding=\"UTF-8\"", "encoding=\"ISO-8859-1\"", "core 2.3.2"),
        ("<model ", "<!DOCTYPE model><model ", "core 2.3.2"),
        ("core/2015/02", "core/2030/02", "core 2.3.3.1"),
        ("xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"", "", "core 2.3.3.1"),
        ("vertex x=\"1\"", "vertex x=\"5,0\"", "x is \"5,0\""),
        ("object id=\"1\"", "object id=\"1\" type=\"support\"", "core 4"),
        ("<metadata ", "<q:thing/><metadata ", "core 2.3.3.1"),
        ("<metadata ", "<thing/><metadata ", "core 2.3.2"),
        ("<metadata ", "<metadata xsi:type=\"a\" ", "core 2.3.2"),
        ("<metadata ", "<metadata xml:space=\"preserve\" ", "core 2.3.4"),
        ("requiredextensions=\"m p\"", "requiredextensions=\"m q\"", "core 3.4"),
        ("requiredextensions=\"m p\"", "xmlns:q=\"http://a.b\" requiredextensions=\"q\"", "core 3.4"),
        ("requiredextensions=\"m p\"", "xmlns:q=\"http://a.b\" recommendedextensions=\"q\"", "core 3.4"),
        ("unit=\"millimeter\"", "unit=\"furlong\"", "furlong"),
        ("name=\"Title\"", "name=\"Colour\"", "core 3.4.1"),
        ("name=\"Title\"", "name=\"q:Colour\"", "core 3.4.1"),
        ("name=\"Title\"", "", "core 3.4.1"),
        (
            "<metadata name=\"Title\">a",
            "<metadata name=\"Title\">a</metadata><metadata name=\"Title\">a",
            "core 3.4.1",
        ),
        ("</model>", "</model><model/>", "core 3.4"),
        ("<build>", "<resources/><build>", "core 3.4"),
        ("<build>", "<build/><build>", "core 3.4"),
        ("objectid=\"2\"", "objectid=\"9\"", "core 3.4.3.1"),
        ("objectid=\"2\"", "", "core 3.4.3.1"),
        ("<item objectid=\"2\"", "<item printable=\"0\" objectid=\"2\"", "core 3.4.3"),
        ("<component objectid=\"1\"/>", "<component objectid=\"2\"/>", "core 3.4"),
        ("<component objectid=\"1\"/>", "<component objectid=\"1\"/><component objectid=\"3\"/>", "core 3.4"),
        ("transform=\"-1 0 0", "transform=\"-1 0", "core 3.3"),
        ("transform=\"-1 0 0 0 1 0 0 0 1", "transform=\"-1 0 0 0 1 0 0 0 0", "core 3.3"),
        ("id=\"6\"", "id=\"5\"", "core 3.4.2"),
        ("id=\"6\"", "id=\"0\"", "core 3.4.2"),
        ("id=\"6\"", "", "core 3.4.2"),
        ("</resources>", "<m:colorgroup id=\"1\"/></resources>", "core 3.4.2"),
        ("object id=\"1\"", "object id=\"1\" type=\"thing\"", "core 4"),
        ("object id=\"1\"", "object id=\"1\" type=\"other\"", "core 3.4.3.1"),
        ("object id=\"1\"", "object id=\"1\" type=\"surface\"", "core 4.1"),
        ("pindex=\"1\"", "pindex=\"2\"", "core 4"),
        ("pid=\"5\" pindex", "pid=\"9\" pindex", "core 4"),
        ("pid=\"5\" pindex", "pindex", "core 4"),
        ("id=\"1\" pid=\"5\" pindex=\"1\"", "id=\"1\"", "core 4"),
        ("<object id=\"2\">", "<object id=\"2\" pid=\"5\" pindex=\"0\">", "core 4"),
        ("<components>", "<mesh><vertices/><triangles/></mesh><components>", "core 4"),
        ("</resources>", "<object id=\"3\"/></resources>", "core 4"),
        ("</resources>", second, "core 4.1.3"),
        ("</resources>", second, "core 4.1.4"),
        ("<triangle v1=\"1\" v2=\"2\" v3=\"3\"/>", "", "core 4.1.4"),
        ("v1=\"1\" v2=\"2\" v3=\"3\"", "v1=\"1\" v2=\"1\" v3=\"3\"", "core 4.1.4.1"),
        ("v1=\"1\" v2=\"2\" v3=\"3\"", "v1=\"1\" v2=\"2\" v3=\"4\"", "vertex 4 does not exist"),
        ("v1=\"1\" v2=\"2\" v3=\"3\"", "v1=\"1\" v2=\"2\"", "vertex -1 does not exist"),
        ("<vertex x=\"0\" y=\"1\" z=\"0\"/>", "<vertex x=\"0\" z=\"0\"/>", "not a finite number"),
        ("<vertex x=\"0\" y=\"1\" z=\"0\"/>", "", "vertex 3 does not exist"),
        ("p1=\"1\"", "p1=\"2\"", "core 4.1.4.1"),
        ("p1=\"1\"", "p2=\"1\"", "core 4.1.4.1"),
        ("p1=\"1\"", "p1=\"1\" p2=\"0\"", "core 4.1.4.1"),
        ("pid=\"6\"", "pid=\"9\"", "core 4.1.4.1"),
        ("color=\"#112233\"/></m", "/></m", "materials 2"),
    ] {
        assert!(MODEL.contains(from), "{from}");
        let found = told(&package(Some(TYPES), RELATIONSHIPS, MODEL.replacen(from, to, 1)));
        assert!(found.iter().any(|t| t.contains(section)), "{from} -> {to}: {found:?}, {section} expected");
    }
}

#[test]
fn each_broken_rule_of_the_package_names_its_section() {
    let ticket = r#"<Relationship Target="/t.xml" Id="t" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/printticket"/>"#;
    let doubled = ticket.replace("/t.xml", "/u.xml").replace("\"t\"", "\"u\"");
    let outside = r#"<Relationship Target="http://a.b/c" Id="t" Type="x" TargetMode="External"/>"#;
    let twin = r#"<Relationship Target="/3D/n.model" Id="s" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>"#;
    let with = |more: &str| RELATIONSHIPS.replace("</Rel", &format!("{more}</Rel"));
    for (relationships, section) in [
        (RELATIONSHIPS.replace("m.model", "n.model"), "no such part"),
        (RELATIONSHIPS.replace("3dmodel\"/", "model\"/"), "core 2.1.1"),
        (with(twin), "core 2.1.2"),
        (with(ticket), "core 2.1.1"),
        (with(&format!("{ticket}{doubled}")), "core 2.1.4"),
        (with(&ticket.replace("\"t\"", "\"r\"")), "OPC"),
        (with(&format!("{ticket}{ticket}")), "core 2.1.1"),
        (with(outside), "outside the package (3MF core 2.1.1)"),
    ] {
        let found = told(&package(Some(TYPES), &relationships, MODEL));
        assert!(found.iter().any(|t| t.contains(section)), "{relationships}: {found:?}, {section} expected");
    }
    for types in [None, Some("<Types/>"), Some("<Types>")] {
        let found = told(&package(types, RELATIONSHIPS, MODEL));
        assert!(found.iter().any(|t| t.contains("core 2.1")), "{types:?}: {found:?}");
    }
}

#[test]
fn triangles_of_other_namespaces_are_no_triangles_of_the_mesh() {
    let model = MODEL.replace("xmlns:m=", "xmlns:d=\"http://a.b/displacement\" xmlns:m=").replace(
        "</triangles>",
        "</triangles><d:triangles><d:triangle v1=\"0\" v2=\"1\" v3=\"9\"/></d:triangles>",
    );
    let file = parse_mesh(&package(Some(TYPES), RELATIONSHIPS, &model), None).expect("a mesh");
    assert_eq!(file.bodies[0].mesh.triangles.len(), 4);
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
}
