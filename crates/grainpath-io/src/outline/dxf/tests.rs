//! Drawings written by hand: every entity, units, what is hidden, damage.

use std::f64::consts::PI;

use super::*;
use crate::outline::{Outline, parse_outline};

const OPTIONS: OutlineOptions = OutlineOptions { unit: None, tolerance_mm: 0.002, even_odd: false };

/// A file of these entities, each a word of codes and values.
fn file(unit: &str, layers: &str, entities: &str) -> String {
    let lines = |text: &str| text.split_whitespace().map(|w| format!("{w}\n")).collect::<String>();
    format!(
        "999\nby hand\n{}{}{}{}",
        lines("0 SECTION 2 HEADER 9 $ACADVER 1 AC1015"),
        lines(unit),
        lines(&format!("0 ENDSEC 0 SECTION 2 TABLES 0 TABLE 2 LAYER {layers} 0 ENDTAB 0 ENDSEC")),
        lines(&format!("0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"))
    )
}

fn read(entities: &str) -> Result<Outline, String> {
    let text = file("9 $INSUNITS 70 4", "", entities);
    parse_outline(text.as_bytes(), &OPTIONS).map_err(|e| e.to_string())
}

fn area(entities: &str) -> f64 {
    read(entities).unwrap_or_else(|e| panic!("{entities}: {e}")).region.area_mm2()
}

const PLATE: &str = "0 LWPOLYLINE 8 0 90 4 70 1 10 0 20 0 10 40 20 0 10 40 20 30 10 0 20 30";

#[test]
fn every_kind_of_entity_has_its_area() {
    let knots = "40 0 40 0 40 0 40 1 40 1 40 2 40 2 40 3 40 3 40 4 40 4 40 4";
    // A circle of radius 5 as four rational arcs of second degree.
    let round = [(5, 0), (5, 5), (0, 5), (-5, 5), (-5, 0), (-5, -5), (0, -5), (5, -5), (5, 0)];
    let points: String = round.iter().map(|(x, y)| format!(" 10 {x} 20 {y} 30 0")).collect();
    let weights: String =
        (0..9).map(|k| format!(" 41 {}", if k % 2 == 0 { 1.0 } else { 0.5f64.sqrt() })).collect();
    let circle_of_splines = format!("0 SPLINE 70 12 71 2 72 12 73 9 {knots}{weights}{points}");
    for (entities, expect) in [
        (PLATE, 1200.0),
        ("0 CIRCLE 10 3 20 4 40 5", 25.0 * PI),
        ("0 CIRCLE 10 3 20 4 40 5 230 -1", 25.0 * PI),
        // A half disc whose sides are drawn in opposite directions.
        ("0 ARC 10 0 20 0 40 6 50 0 51 180 0 LINE 10 6 20 0 11 -6 21 0", 18.0 * PI),
        ("0 ARC 10 0 20 0 40 6 50 270 51 90 0 LINE 10 0 20 6 11 0 21 -6", 18.0 * PI),
        // A slot: two straight sides and two half circles, once to the right and once to the left.
        ("0 LWPOLYLINE 70 1 10 0 20 0 10 20 20 0 42 1 10 20 20 10 10 0 20 10 42 1", 200.0 + 25.0 * PI),
        ("0 LWPOLYLINE 70 1 10 0 20 0 42 -1 10 0 20 10 10 20 20 10 42 -1 10 20 20 0", 200.0 + 25.0 * PI),
        // Mirrored as a whole: the same area.
        ("0 LWPOLYLINE 70 1 230 -1 10 0 20 0 10 20 20 0 42 1 10 20 20 10 10 0 20 10 42 1", 200.0 + 25.0 * PI),
        // As release 12 has it; the point of a frame is not on the line.
        (
            "0 POLYLINE 8 0 66 1 70 1 0 VERTEX 10 0 20 0 0 VERTEX 10 9 20 9 70 16 0 VERTEX 10 10 20 0 42 0.41421356237 \
             0 VERTEX 10 10 20 10 0 VERTEX 10 0 20 10 0 SEQEND",
            100.0 + 12.5 * PI - 25.0,
        ),
        ("0 ELLIPSE 10 1 20 2 11 6 21 8 40 0.5 41 0 42 6.283185307179586", 50.0 * PI),
        (
            "0 ELLIPSE 10 0 20 0 11 10 21 0 40 0.5 41 0 42 3.141592653589793 0 LINE 10 10 20 0 11 -10 21 0",
            25.0 * PI,
        ),
        (&circle_of_splines, 25.0 * PI),
        // A Bezier curve and its chord: 3/20 of its control polygon's product.
        (
            "0 SPLINE 70 8 71 3 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 10 0 20 0 10 0 20 20 10 20 20 20 10 20 20 0 \
             0 LINE 10 0 20 0 11 20 21 0",
            0.6 * 400.0,
        ),
    ] {
        let found = area(entities);
        assert!((found / expect - 1.0).abs() < 2e-3, "{entities}: {found}, {expect} expected");
    }
}

#[test]
fn loose_lines_are_joined_and_holes_cut() {
    // The sides of a square in any order and way, one end 4 um off; a hole; a centre line that bounds nothing.
    let square = "0 LINE 10 0 20 0 11 10 21 0 0 LINE 10 0 20 10 11 0 21 0 0 LINE 10 10 20 0.004 11 10 21 10 \
                  0 LINE 10 0 20 10 11 10 21 10";
    let hole = "0 CIRCLE 10 5 20 5 40 2";
    let axis = "0 LINE 10 -5 20 5 11 15 21 5";
    let outline = read(&format!("{square} {hole} {axis}")).expect("a plate");
    assert!((outline.region.area_mm2() - (100.0 - 4.0 * PI)).abs() < 0.03);
    assert_eq!(outline.region.polygons[0].holes.len(), 1);
    let texts: Vec<&str> = outline.warnings.iter().map(|w| w.text.as_str()).collect();
    assert_eq!(texts, ["1 open lines without fill bound nothing and were left out"]);
    // Drawn twice they are there once.
    let outline = read(&format!("{square} {hole} {hole} {square}")).expect("a plate");
    assert!((outline.region.area_mm2() - (100.0 - 4.0 * PI)).abs() < 0.03);
    assert!(outline.warnings[0].text.starts_with("5 lines that lie on others"), "{:?}", outline.warnings);
}

#[test]
fn whether_ends_are_joined_does_not_depend_on_their_place() {
    for k in 0..200 {
        let at = 0.000_37 * f64::from(k);
        let p = |x: f64, y: f64| DVec2::new(at + x, 0.7 * at + y);
        // A triangle whose last end is 9 um from the first, and one where it is 11 um away.
        for (gap, closed) in [(0.009, true), (0.011, false)] {
            let sides = vec![
                vec![p(gap, 0.0), p(10.0, 0.0)],
                vec![p(10.0, 0.0), p(0.0, 5.0)],
                vec![p(0.0, 5.0), p(0.0, 0.0)],
            ];
            let lines = joined(sides);
            assert_eq!(lines.len(), 1, "{gap} mm at {at}");
            assert_eq!(lines[0].closed, closed, "{gap} mm at {at}");
            // Side by side with a far end between them, in either order.
            let apart = joined(vec![vec![p(0.0, 0.0), p(5.0, 0.0)], vec![p(5.0 + gap, 0.0), p(9.0, 3.0)]]);
            assert_eq!(apart.len(), if closed { 1 } else { 2 }, "{gap} mm at {at}");
        }
    }
}

#[test]
fn places_and_units_are_those_of_the_file() {
    let shifted = "0 LINE 10 1 20 1 11 3 21 1 0 LINE 10 3 20 1 11 3 21 2 0 LINE 10 3 20 2 11 1 21 1";
    for (unit, factor, said) in [
        ("9 $INSUNITS 70 4", 1.0, 0),
        ("9 $INSUNITS 70 1", 25.4, 0),
        ("9 $INSUNITS 70 5", 10.0, 0),
        ("9 $INSUNITS 70 0", 1.0, 1),
        ("", 1.0, 1),
    ] {
        let outline = parse_outline(file(unit, "", shifted).as_bytes(), &OPTIONS).expect("a triangle");
        let b = outline.region.bounds().expect("area");
        assert!((b.min - DVec2::splat(factor)).length() < 1e-3, "{unit}: {b:?}");
        assert!((b.max - DVec2::new(3.0, 2.0) * factor).length() < 1e-3, "{unit}: {b:?}");
        assert_eq!(outline.warnings.len(), said, "{:?}", outline.warnings);
    }
    let inch = OutlineOptions { unit: Some(LengthUnit::Inch), ..OPTIONS };
    let outline = parse_outline(file("", "", shifted).as_bytes(), &inch).expect("a triangle");
    assert!((outline.region.area_mm2() - 645.16).abs() < 0.01 && outline.warnings.is_empty());
}

#[test]
fn what_is_not_shown_is_not_there() {
    let layers = "0 LAYER 2 frozen 70 1 62 7 0 LAYER 2 off 70 0 62 -7 0 LAYER 2 on 70 0 62 7";
    let circle = |extra: &str| format!("0 CIRCLE {extra} 10 9 20 9 40 3 ");
    for (extra, there) in
        [("8 frozen", false), ("8 off", false), ("8 on", true), ("60 1", false), ("67 1", false)]
    {
        let text = file("9 $INSUNITS 70 4", layers, &format!("{PLATE} {}", circle(extra)));
        let outline = parse_outline(text.as_bytes(), &OPTIONS).expect("a plate");
        assert_eq!(outline.region.polygons[0].holes.len(), usize::from(there), "{extra}");
    }
    let outline = read(&format!("{PLATE} 0 TEXT 1 plate 0 INSERT 2 block 10 0 20 0")).expect("a plate");
    assert!(
        outline.warnings.len() == 2 && outline.warnings[1].text.starts_with("INSERT"),
        "{:?}",
        outline.warnings
    );
}

#[test]
fn damage_is_named() {
    for (entities, expect) in [
        ("0 LINE 10 0 20 0 11 4", "LINE lacks an end (code 21)"),
        ("0 LINE 10 0 20 x 11 4 21 4", "found \"x\" where a number should be"),
        ("0 LINE 10 0 20 inf 11 4 21 4", "found \"inf\""),
        ("0 CIRCLE 10 0 20 0 40 1e9", "beyond"),
        ("0 SPLINE 71 3 40 0 40 1 10 0 20 0", "the numbers do not fit"),
        ("0 SPLINE 71 99 40 0 40 1 10 0 20 0", "degree 99"),
        ("0 LINE 10 0 20 0 11 4 21 4 x y", "where a group code should be"),
        ("0 LINE 10 0 20 0 11 4 21 4", "1 open lines"),
        ("0 INSERT 2 plate", "INSERT is not read"),
    ] {
        let found = read(entities).expect_err(expect);
        assert!(found.contains(expect) && !found.contains('\n'), "{found:?}, {expect:?} expected");
    }
    let whole = file("9 $INSUNITS 70 4", "", PLATE);
    let cut = &whole[..whole.len() - "0\nEOF\n".len()];
    let found = parse_outline(cut.as_bytes(), &OPTIONS).expect_err("cut").to_string();
    assert!(found.contains("ends in the middle"), "{found}");
    let found = parse_outline(b"AutoCAD Binary DXF\r\n\x1a\0\0\0", &OPTIONS).expect_err("binary").to_string();
    assert!(found.contains("binary DXF"), "{found}");
    // Ends of lines as other systems have them.
    for end in ["\r\n", "\r"] {
        assert!(parse_outline(whole.replace('\n', end).as_bytes(), &OPTIONS).is_ok());
    }
}

proptest::proptest! {
    #[test]
    fn any_entities_are_survived(
        kinds in proptest::collection::vec("LINE|ARC|CIRCLE|LWPOLYLINE|POLYLINE|VERTEX|ELLIPSE|SPLINE", 1..5),
        pairs in proptest::collection::vec((0usize..14, "-?[0-9]{1,3}|1e300|1e-300|x"), 0..40),
    ) {
        let codes = [10, 20, 11, 21, 40, 41, 42, 50, 51, 70, 71, 210, 230, 8];
        let mut text = String::new();
        for (k, kind) in kinds.iter().enumerate() {
            text += &format!(" 0 {kind}");
            for (code, value) in pairs.iter().skip(k) {
                text += &format!(" {} {value}", codes[*code]);
            }
        }
        if let Ok(outline) = read(&text) {
            proptest::prop_assert!(outline.region.contours().flatten().all(|p| p.is_finite()));
            proptest::prop_assert!(outline.region.area_mm2() > 0.0, "{text}");
        }
    }
}
