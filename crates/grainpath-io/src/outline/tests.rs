use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec2, Region};

use super::*;

const OPTIONS: OutlineOptions = OutlineOptions { unit: None, tolerance_mm: 0.002, even_odd: false };

fn read(text: &str) -> Result<Outline, String> {
    parse_outline(text.as_bytes(), &OPTIONS).map_err(|e| e.to_string())
}

fn page(content: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" \"a.dtd\">\n<svg \
         xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"50mm\" viewBox=\"0 0 200 100\">{content}</svg>"
    )
}

fn area(content: &str) -> f64 {
    let text = page(content);
    read(&text).unwrap_or_else(|e| panic!("{content}: {e}")).region.area_mm2()
}

#[test]
fn every_kind_of_shape_has_its_area() {
    let pi = std::f64::consts::PI;
    // Two units of the drawing are a millimetre.
    for (content, expect) in [
        ("<rect x='10' y='10' width='40' height='20'/>", 200.0),
        ("<rect width='40' height='20' rx='4'/>", 200.0 - (4.0 - pi) * 4.0),
        ("<circle cx='50' cy='50' r='20'/>", 100.0 * pi),
        ("<ellipse cx='50' cy='50' rx='20' ry='10'/>", 50.0 * pi),
        ("<polygon points='0,0 20,0 20,20'/>", 50.0),
        ("<polyline points='0 0 20 0 20 20'/>", 50.0),
        ("<path d='M0 0h40v20h-40z'/>", 200.0),
        ("<path d='m10,10 40,0 0,20 -40,0z m10,5 v10 h20 v-10 z' fill-rule='evenodd'/>", 150.0),
        ("<path d='M10 50a40 40 0 1 1 80 0a40 40 0 1 1 -80 0'/>", 400.0 * pi),
        ("<path d='M0 0Q20 40 40 0Z'/>", 2.0 / 3.0 * 20.0 * 20.0 * 0.5),
        ("<path d='M0 0C0 40 40 40 40 0S40 0 40 0Z'/>", 0.6 * 40.0 * 40.0 / 4.0),
        ("<path d='M0 0Q10 20 20 0T40 0V-40H0Z'/>", 400.0),
        // A number may begin where the last one ends, a flag anywhere.
        ("<path d='M.5.5 10.5.5-1e1.5z'/>", 0.0),
        ("<path d='M10 50a40,40 0 0180 0z'/>", 200.0 * pi),
    ] {
        let text = page(content);
        if expect == 0.0 {
            assert!(read(&text).is_err(), "{content}");
        } else {
            let found = area(content);
            assert!((found / expect - 1.0).abs() < 1e-3, "{content}: {found}, {expect} expected");
        }
    }
}

#[test]
fn holes_follow_fill_rule_and_style() {
    let plate = "<rect width='80' height='60'/>";
    let hole = "<circle cx='40' cy='30' r='10'/>";
    let disc = std::f64::consts::PI * 25.0;
    let near = |found: f64, expect: f64| assert!((found - expect).abs() < 0.2, "{found}, {expect} expected");
    // Filled shapes unite; lines alone count even-odd, on their own and over what is filled.
    near(area(&format!("{plate}{hole}")), 1200.0);
    near(area(&format!("<g style='stroke:red; fill : none'>{plate}{hole}</g>")), 1200.0 - disc);
    near(area(&format!("{plate}<g fill='none'>{hole}</g>")), 1200.0 - disc);
    near(area(&format!("<style>.a, .b{{fill:none}}</style><g class='c b'>{plate}{hole}</g>")), 1200.0 - disc);
    let together = OutlineOptions { even_odd: true, ..OPTIONS };
    let read = parse_outline(page(&format!("{plate}{hole}")).as_bytes(), &together).expect("a plate");
    near(read.region.area_mm2(), 1200.0 - disc);
    assert_eq!(read.region.polygons[0].holes.len(), 1);
    // Non-zero keeps what winds the same way, even-odd does not.
    let twice = "M0 0H80V60H0ZM20 20H40V40H20Z";
    near(area(&format!("<path d='{twice}'/>")), 1200.0);
    near(area(&format!("<g fill-rule='evenodd'><path d='{twice}'/></g>")), 1100.0);
    // Elements that are not drawn give no outline.
    near(
        area(&format!(
            "{plate}<defs>{hole}</defs><g display='none'><rect x='100' width='9' height='9'/></g>"
        )),
        1200.0,
    );
}

#[test]
fn places_are_those_of_the_page_with_y_up() {
    let text = page(
        "<g transform='translate(20 10) scale(2)'><rect width='10' height='5' transform='rotate(90 5 2.5)'/></g>",
    );
    let outline = read(&text).expect("a rectangle");
    let b = outline.region.bounds().expect("area");
    // rotate(90) about the middle gives x 2.5..7.5, y -2.5..7.5; twice that from (20, 10); halved to mm.
    let expect = [12.5, 50.0 - 12.5, 17.5, 50.0 - 2.5];
    for (found, expect) in [b.min.x, b.min.y, b.max.x, b.max.y].iter().zip(expect) {
        assert!((found - expect).abs() < 1e-3, "{b:?}");
    }
    assert!(outline.warnings.is_empty(), "{:?}", outline.warnings);
    // Without a size the page's unit is read as mm, with a warning; a unit in the options wins.
    let bare = "<svg viewBox='0 0 30 20'><rect width='30' height='20'/></svg>";
    let outline = read(bare).expect("a rectangle");
    assert_eq!((outline.region.area_mm2(), outline.warnings.len()), (600.0, 1));
    let inch = OutlineOptions { unit: Some(LengthUnit::Inch), ..OPTIONS };
    let outline = parse_outline(bare.as_bytes(), &inch).expect("a rectangle");
    assert!((outline.region.area_mm2() - 600.0 * 645.16).abs() < 1e-3 && outline.warnings.is_empty());
}

#[test]
fn damage_is_named() {
    for (text, expect) in [
        (String::new(), "empty"),
        ("hello".into(), "is neither SVG nor ASCII DXF"),
        (page("<path d='M0 0L10 x'/>"), "found \"x\" where a number should be"),
        (page("<path d='L0 0'/>"), "should begin with M"),
        (page("<path d='M0 0A1 1 0 2 0 5 5'/>"), "where 0 or 1 should be"),
        (page("<rect width='-4' height='3'/>"), "width -4"),
        (page("<rect width='4' height='3' transform='turn(3)'/>"), "transform"),
        (page("<g><rect width='4' height='3'/>"), "byte"),
        (page("<circle r='1e300'/>"), "beyond"),
        (page("<text>plate</text>"), "no closed line around any area (<text> is not read"),
        (page("<line x1='0' y1='0' x2='5' y2='5'/>"), "no closed line"),
        (page("<path fill='none' d='M0 0H9V9'/>"), "1 open lines"),
    ] {
        let found = read(&text).expect_err(expect);
        assert!(found.contains(expect) && !found.contains('\n'), "{found:?}, {expect:?} expected");
    }
}

#[test]
fn our_own_layers_are_read_back() {
    let region = Region::rectangle(DVec2::ZERO, DVec2::new(10.0, 8.0))
        .difference(&Region::rectangle(DVec2::splat(2.0), DVec2::splat(4.5)));
    let layer = grainpath_core::Layer::new(0.2, 0.2, region.clone()).expect("a layer");
    let stack = grainpath_core::LayerStack::new(vec![layer]).expect("rising");
    let mut svg = Vec::new();
    crate::write_svg_layers(&stack, &mut svg).expect("memory");
    let outline = parse_outline(&svg, &OPTIONS).expect("our own file");
    assert!(outline.region.difference(&region).is_empty() && region.difference(&outline.region).is_empty());
}

proptest::proptest! {
    #[test]
    fn any_path_data_is_survived(d in "[MmLlHhVvCcSsQqTtAaZz0-9 .,eE+-]{0,60}", tail in ".{0,20}") {
        for shape in [format!("<path d='{d}'/>{tail}"), format!("<polygon transform='matrix({d})' points='{d}'/>")] {
            if let Ok(outline) = read(&page(&shape)) {
                proptest::prop_assert!(outline.region.contours().flatten().all(|p| p.is_finite()));
                proptest::prop_assert!(outline.region.area_mm2() > 0.0, "{shape}");
            }
        }
    }
}
