use grainpath_core::{BeadWidth, DVec2, DVec3, LayerPlan, PlannedPath, Role, Toolpath, Travel};

use super::*;
use crate::machine::Flavour;
use crate::{Corner, Limits, simulate};

fn config(flavour: Flavour) -> WriteConfig {
    let limits = Limits { corner: Corner::Jerk([8.0, 8.0, 0.4, 4.0]), ..Limits::default() };
    WriteConfig {
        machine: Machine {
            flavour,
            nozzle_mm: 0.4,
            filament_mm: 1.75,
            bed_mm: [200.0, 200.0, 200.0],
            origin_at_centre: false,
            limits,
            relative_e: true,
            start_gcode: "G28\nM109 S{first_layer_nozzle_temp_c}".into(),
            end_gcode: "M84".into(),
        },
        material: Material {
            name: "PLA".into(),
            density_g_cm3: 1.24,
            nozzle_temp_c: 205.0,
            first_layer_nozzle_temp_c: 210.0,
            bed_temp_c: 60.0,
            first_layer_bed_temp_c: 60.0,
            flow: 1.0,
            pressure_advance: Some(0.05),
            max_volumetric_mm3_s: 100.0,
        },
        speeds: Speeds {
            outer_wall: 40.0,
            inner_wall: 60.0,
            small_wall: 25.0,
            overhang: 20.0,
            gap_fill: 30.0,
            solid: 60.0,
            top: 40.0,
            sparse: 80.0,
            bridge: 30.0,
            support: 60.0,
            adhesion: 25.0,
            travel: 150.0,
            travel_z: 10.0,
            first_layer: 25.0,
        },
        cooling: Cooling {
            fan_min: 0.5,
            fan_max: 1.0,
            fan_bridge: 1.0,
            fan_off_layers: 1,
            min_layer_time_s: 0.0,
            fan_below_layer_time_s: 1e-6,
            min_speed_mm_s: 5.0,
        },
        retraction: Retraction {
            length_mm: 0.8,
            speed_mm_s: 40.0,
            unretract_speed_mm_s: 30.0,
            z_hop_mm: 0.2,
        },
        arc_tolerance_mm: None,
        header: Vec::new(),
    }
}

fn square(at: f64, retract: bool) -> PlannedPath {
    let points = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|p| DVec2::from(p) + at).to_vec();
    PlannedPath {
        travel: Travel { via: Vec::new(), retract },
        path: Toolpath::new(points, 0.45, Role::OuterWall, true),
    }
}

fn plan() -> Plan {
    let layer = |z: f64| LayerPlan {
        z_top_mm: z,
        height_mm: 0.2,
        paths: vec![square(0.0, true), square(20.0, true)],
    };
    Plan { layers: vec![layer(0.2), layer(0.4)], plate_from_part_mm: DVec3::new(50.0, 50.0, 0.0) }
}

fn written(plan: &Plan, config: &WriteConfig) -> (String, Written) {
    let mut out = Vec::new();
    let written = write_gcode(plan, config, &[], &mut out).expect("a sound plan");
    (String::from_utf8(out).expect("text"), written)
}

#[test]
fn a_program_as_it_should_read() {
    let (text, _) = written(&plan(), &config(Flavour::Marlin));
    let expect = "\
G28
M109 S210
G21 ; mm
G90 ; positions are absolute
M83 ; extrusion is relative
M900 K0.05
;LAYER_CHANGE
;Z:0.2
;HEIGHT:0.2
G1 Z0.2 F600
M204 S1000
G1 F9000
G1 X50 Y50
;TYPE:External perimeter
;WIDTH:0.45
G1 F1500
G1 X60 E0.33849
G1 Y60 E0.33849
G1 X50 E0.33848
G1 Y50 E0.33849
G1 E-0.8 F2400
G1 Z0.4 F600
G1 F9000
G1 X70 Y70
G1 Z0.2 F600
G1 E0.8 F1800
G1 F1500
G1 X80 E0.33849
";
    let from = text.find("G28").expect("the start program");
    assert!(text[from..].starts_with(expect), "{}", &text[from..from + expect.len().min(text.len() - from)]);
    assert!(text.contains("\nM104 S205\n") && text.contains("\nM106 S128\n") && text.ends_with('\n'));
    assert!(text.contains("; estimated printing time (normal mode) = "));
}

#[test]
fn flavours_say_the_same_in_their_own_words() {
    let (klipper, _) = written(&plan(), &config(Flavour::Klipper));
    assert!(
        klipper.contains("SET_PRESSURE_ADVANCE ADVANCE=0.05\n")
            && klipper.contains("SET_VELOCITY_LIMIT ACCEL=1000\n")
    );
    let (rrf, _) = written(&plan(), &config(Flavour::RepRapFirmware));
    assert!(rrf.contains("M572 D0 S0.05\n") && rrf.contains("M204 P1000 T1000\n"));
}

#[test]
fn the_filament_is_that_of_the_volume_and_absolute_e_is_the_same() {
    let mut plan = plan();
    for layer in &mut plan.layers {
        for p in &mut layer.paths {
            p.path.width = BeadWidth::PerVertex(vec![0.3, 0.45, 0.61, 0.4]);
        }
    }
    let exact: f64 =
        plan.layers.iter().flat_map(|l| l.paths.iter().map(|p| p.path.volume_mm3(l.height_mm))).sum();
    let mut config = config(Flavour::Marlin);
    let (relative, report) = written(&plan, &config);
    assert!((report.extruded_mm3 - exact).abs() < 1e-9);
    config.machine.relative_e = false;
    let (absolute, _) = written(&plan, &config);
    let limits = config.machine.limits;
    let [a, b] = [&relative, &absolute].map(|t| simulate(t.as_bytes(), 1.75, &limits).expect("a program"));
    assert!((a.extruded_mm3 / exact - 1.0).abs() < 1e-5, "{} {exact}", a.extruded_mm3);
    assert!((a.extruded_mm3 - b.extruded_mm3).abs() < 1e-3, "{} {}", a.extruded_mm3, b.extruded_mm3);
    // Two travels each layer but the first, and the end.
    assert_eq!((a.retractions, b.retractions, report.retractions), (4, 4, 4));
    assert!((a.time_s / report.time_s - 1.0).abs() < 0.02, "{} {}", a.time_s, report.time_s);
}

#[test]
fn arcs_stand_for_the_points_and_keep_the_volume() {
    let circle = (0..200)
        .map(|i| grainpath_core::math::direction(f64::from(i) / 200.0 * std::f64::consts::TAU) * 15.0);
    let path = Toolpath::new(circle.collect(), 0.45, Role::OuterWall, true);
    let paths = vec![PlannedPath { travel: Travel::default(), path: path.clone() }];
    let layers = vec![LayerPlan { z_top_mm: 0.2, height_mm: 0.2, paths }];
    let plan = Plan { layers, plate_from_part_mm: DVec3::new(100.0, 100.0, 0.0) };
    let mut config = config(Flavour::Marlin);
    config.arc_tolerance_mm = Some(0.01);
    let (text, _) = written(&plan, &config);
    let n = text.lines().filter(|l| l.starts_with("G2 ") || l.starts_with("G3 ")).count();
    assert!((1..=3).contains(&n), "{n} arcs for a circle");
    let program = simulate(text.as_bytes(), 1.75, &config.machine.limits).expect("a program");
    assert!((program.extruded_mm3 / path.volume_mm3(0.2) - 1.0).abs() < 1e-4);
    for bead in &program.layers[0].beads {
        let r = bead.end().distance(DVec2::splat(100.0));
        assert!((r - 15.0).abs() < 0.012, "{r}");
    }
}

#[test]
fn short_layers_are_slowed_down() {
    let (_, fast) = written(&plan(), &config(Flavour::Marlin));
    let mut slow = config(Flavour::Marlin);
    slow.cooling.min_layer_time_s = 10.0;
    let (_, slow) = written(&plan(), &slow);
    assert!(
        fast.time_s < 12.0 && slow.time_s > 19.0 && slow.time_s < 23.0,
        "{} {}",
        fast.time_s,
        slow.time_s
    );
}

#[test]
fn what_cannot_be_written_is_said() {
    let config = config(Flavour::Marlin);
    let mut far = plan();
    far.plate_from_part_mm.x = 175.0;
    let error = check_fits(&far, &config.machine).expect_err("off the bed").to_string();
    assert!(error.starts_with("the print reaches X = 205.2"), "{error}");
    let mut broken = plan();
    broken.layers[1].paths[0].path.points[2].y = f64::NAN;
    assert!(matches!(check_fits(&broken, &config.machine), Err(GcodeError::NotANumber { .. })));
    let mut typo = config;
    typo.machine.end_gcode = "G1 Z{zmax_mm}".into();
    let error = write_gcode(&plan(), &typo, &[], &mut Vec::new()).expect_err("a typo").to_string();
    assert_eq!(error, "end_gcode: unknown placeholder {zmax_mm}; did you mean {z_max_mm}?");
}
