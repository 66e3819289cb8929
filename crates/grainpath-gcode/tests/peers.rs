//! G-code of other programs is read with the meaning they gave it.

#[path = "../../../tests/data.rs"]
mod data;

use grainpath_core::Role;
use grainpath_gcode::{Limits, Program, SimulateError, simulate};
use proptest::prelude::*;

fn read(file: &str) -> Program {
    simulate(&data::read_data(&format!("gcode/{file}")), 1.75, &Limits::default()).expect(file)
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn prints_of_other_slicers() {
    for file in ["rrf_prusaslicer.gcode", "rrf_simplify3d.gcode"] {
        let p = read(file);
        assert!(
            p.layers.len() > 10 && p.extruded_mm3 > 1000.0 && p.time_s > 60.0,
            "{file}: {} layers",
            p.layers.len()
        );
        assert!(p.generator.is_some() && p.warnings.is_empty(), "{file}: {:?}", p.warnings);
        // PrusaSlicer 2.1 has one name for all walls.
        let outer = file.contains("simplify3d").then_some(Role::OuterWall);
        for role in outer.into_iter().chain([Role::InnerWall, Role::SparseFill]) {
            assert!(p.layers.iter().any(|l| l.beads.iter().any(|b| b.role == role)), "{file}: no {role:?}");
        }
        let middle = &p.layers[p.layers.len() / 2];
        let bead = middle.beads.iter().find(|b| b.role.is_part()).expect("a bead of the part");
        let width = bead.width_mm(middle.height_mm);
        assert!((0.25..1.0).contains(&width), "{file}: {width}");
    }
}

#[test]
#[ignore = "needs GRAINPATH_DATA"]
fn programs_that_print_nothing_are_read_too() {
    for file in ["rrf_config_2.g", "mach3_cnc.gcode", "rrf_circle_arcs.gcode"] {
        let p = read(file);
        assert!(
            p.commands > 3 && p.layers.is_empty(),
            "{file}: {} commands, {} layers",
            p.commands,
            p.layers.len()
        );
    }
    let p = read("rrf_thumbnail_qoi.gcode");
    assert!(!p.thumbnails.is_empty());
}

#[test]
fn inches_arcs_and_absolute_e() {
    let text = b"G21\nG90\nM82\nG92 E0\nG1 Z0.2 F600\nG1 X10 Y0 F1200\nG1 X20 E1\nG3 X20 Y10 I0 J5 E2\nG20\nM83\nG1 X0 E0.1\n";
    let p = simulate(text, 1.75, &Limits::default()).expect("a program");
    let expect = 10.0 + 5.0 * std::f64::consts::PI + 20.0;
    assert!((p.printed_mm - expect).abs() < 0.02, "{}", p.printed_mm);
    assert!((p.filament_mm - (1.0 + 1.0 + 2.54)).abs() < 1e-9, "{}", p.filament_mm);
    assert!(simulate(b"", 1.75, &Limits::default()).is_err());
    assert_eq!(simulate(b"GCDE\x01\0\0\0", 1.75, &Limits::default()), Err(SimulateError::Binary));
    assert!(simulate(b"hello\nworld\n", 1.75, &Limits::default()).is_err());
}

/// `M200` as Marlin reads it: 10 mm3 three times, and 10 mm of filament once.
#[test]
fn e_counts_volume_where_the_program_says_so() {
    let mm3 = 10.0 * 0.25 * std::f64::consts::PI * 1.75 * 1.75;
    let run = |m200: &str| {
        let text = format!("M83\n{m200}\nG1 Z0.2 F600\nG1 X10 F1200\nG1 X60 E10\nG1 E-4\nG1 E4\nM84\n");
        simulate(text.as_bytes(), 1.75, &Limits::default()).expect("a program")
    };
    let as_length = run("");
    for on in ["M200 D1.75", "M200 S1 D1.75", "M200 S1", "M200 D2.85\nM200 D1.75 T0", "m200d1.75"] {
        let p = run(on);
        assert!((p.extruded_mm3 - 10.0).abs() < 1e-9, "{on}: {}", p.extruded_mm3);
        assert!((p.filament_mm * mm3 - 100.0).abs() < 1e-9, "{on}: {}", p.filament_mm);
        // Retracted by 4 mm3, which is less filament and less time than 4 mm.
        assert!(p.retractions == 1 && p.time_s < as_length.time_s, "{on}: {p:?}");
        assert!(p.warnings.is_empty(), "{on}: {:?}", p.warnings);
    }
    // A filament of another diameter is fed for the same volume.
    let thick = run("M200 D3.5");
    assert!((thick.extruded_mm3 - 10.0).abs() < 1e-9 && (4.0 * thick.filament_mm * mm3 - 100.0).abs() < 1e-9);
    for off in
        ["", "M200", "M200 D0", "M200 S0", "M200 D1.75\nM200 D0", "M200 S1 D1.75\nM200 S0", "M200 S0 D2.85"]
    {
        let p = run(off);
        assert!((p.extruded_mm3 - mm3).abs() < 1e-9 && (p.filament_mm - 10.0).abs() < 1e-9, "{off}: {p:?}");
    }
    // Without a diameter E keeps its meaning; a diameter that is no number is reported.
    for (hostile, said) in [
        ("M200 D-1.75", 1),
        ("M200 D1000000", 1),
        ("M200 D0.0001 S1", 1),
        ("M200 D99999999999999999999999999", 1),
        ("M200 DNaN", 0),
        ("M200 Dinf", 0),
    ] {
        let p = run(hostile);
        assert!((p.extruded_mm3 - mm3).abs() < 1e-9, "{hostile}: {}", p.extruded_mm3);
        assert_eq!(p.warnings.len(), said, "{hostile}: {:?}", p.warnings);
    }
    // In inches E counts cubic inches.
    let inches =
        simulate(b"G20\nM83\nM200 D0.07\nG1 X2 E0.001\n", 1.75, &Limits::default()).expect("a program");
    assert!((inches.extruded_mm3 - 16.387_064).abs() < 1e-9, "{}", inches.extruded_mm3);
}

/// A program around some lines, with E relative and absolute.
fn around(lines: &str) -> [Program; 2] {
    let of = |e: [&str; 3]| {
        let text =
            format!("{}\nG1 Z0.2 F600\nG1 X0 Y0\nG1 X30 {} F1200\n{lines}\nG1 X0 Y20 {}\n", e[0], e[1], e[2]);
        simulate(text.as_bytes(), 1.75, &Limits::default()).expect("a program")
    };
    [of(["M83", "E1", "E1"]), of(["M82", "E1", "E5"])]
}

#[test]
fn lines_that_are_not_understood_are_skipped_whole() {
    let plain = &around("")[0];
    for line in [
        "/G1 X40 E7",
        "@pause G1 E9",
        "?G1 X9 E1",
        "G1 X[foo] E3",
        "G1 X1e400 E1",
        "G1 X1234567890123456789012 E4",
        "X40 Y3 E9",
        "G90 G1 X40 E9",
        "G7 X40 E9",
        "!M83",
        "{G91}",
    ] {
        let p = &around(line)[0];
        assert_eq!((&p.layers, p.filament_mm), (&plain.layers, plain.filament_mm), "{line}");
        assert_eq!(p.warnings.len(), 1, "{line}: {:?}", p.warnings);
    }
    for line in ["N4 G1 (X9 E9) F1200*33", "G29 P9 X10 Y10 W3", "M1006 A0 E9 X4", "M117 X9 E4", "\"X4\" ; X9"]
    {
        let p = &around(line)[0];
        assert!(p.layers == plain.layers && p.warnings.is_empty(), "{line}: {:?}", p.warnings);
    }
}

/// Splines, arcs in other planes and arcs that no circle makes print nothing, and the program goes on from their end.
#[test]
fn motion_that_is_not_read_is_told() {
    for line in [
        "G5 I0 J3 P0 Q-3 X30 Y20 E4",
        "G5.1 I0 J3 X30 Y20 E4",
        "G18\nG2 X30 Y20 I5 K0 E4",
        "G19\nG3 X30 Y20 J5 K0 E4",
        "G2 X30 Y20 R9.9 E4",
        "G2 X30 Y20 I3 J0 E4",
        "G2 X30 Y20 E4",
        "G90.1\nG2 X30 Y20 J10 E4",
        "G2 X30 Y20 I0 J10 P101 E4",
    ] {
        for p in around(line) {
            assert_eq!(p.warnings.len(), 1, "{line}: {:?}", p.warnings);
            assert!((p.printed_mm - 60.0).abs() < 1e-9 && p.arcs == 0, "{line}: {}", p.printed_mm);
        }
        assert!((around(line)[0].filament_mm - 2.0).abs() < 1e-9, "{line}");
        assert!((around(line)[1].filament_mm - 2.0).abs() < 1e-9, "{line}");
    }
    // Half a circle, with its end rounded to two decimals too; centres that are absolute; turns.
    let half = 10.0 * std::f64::consts::PI;
    for (line, mm) in [
        ("G2 X30 Y20 I0 J10 E4", half),
        ("G17\nG3 X30 Y20 R10 E4", half),
        ("G2 X30 Y20 I0 J9.99 E4", half),
        ("G90.1\nG2 X30 Y20 I30 J10 E4", half),
        ("G90.1\nG91.1\nG2 X30 Y20 I0 J10 E4", half),
        ("G3 X30 Y20 I0 J10 P2 E4", 5.0 * half),
        ("G3 I0 J10 E4\nG1 Y20", 2.0 * half),
        ("G3 I0 J10 P1 E4\nG1 Y20", 2.0 * half),
        ("G2 I0 J10 P3 E4\nG1 Y20", 6.0 * half),
    ] {
        for p in around(line) {
            assert!(p.warnings.is_empty() && p.arcs == 1, "{line}: {:?}", p.warnings);
            assert!((p.printed_mm - 60.0 - mm).abs() < 0.1, "{line}: {}", p.printed_mm);
        }
    }
}

/// However filament is drawn back, once it is drawn back it counts once.
#[test]
fn retractions_are_counted_once_each() {
    for (lines, n) in [
        ("G1 E-1\nG1 X40\nG1 E1", 1),
        ("G1 X25 E-.5\nG1 X20 E-.3\nG1 E.8", 1),
        ("G1 E-.2\nG1 X25 E-.5\nG1 E-.3\nG1 X40\nG1 E1", 1),
        ("G1 Z1 E-1\nG1 Z0.2 E1", 1),
        ("G10\nG1 X40\nG11", 1),
        ("G10\nG11\nG1 X35 E1\nG1 E-1\nG1 E1", 2),
        ("G10 P0 S200", 0),
        ("", 0),
    ] {
        assert_eq!(around(&format!("M83\n{lines}"))[0].retractions, n, "{lines}");
    }
}

proptest! {
    #[test]
    fn any_program_is_survived(lines in proptest::collection::vec("([GMT][0-9]{1,3}|M200)( [XYZEFIJRSPNOD][-+]?[0-9.e]{0,9}){0,5}", 0..60)) {
        let text = lines.join("\n");
        if let Ok(p) = simulate(text.as_bytes(), 1.75, &Limits::default()) {
            prop_assert!(p.printed_mm.is_finite() && p.time_s.is_finite());
        }
    }
}
