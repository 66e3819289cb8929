//! The figures of the module texts, drawn from tests that run. `UPDATE_FIGURES=1 cargo test -p grainpath-fea --test
//! figures` writes them anew.

use std::fmt::Write;
use std::path::Path;

use grainpath_core::diagnostics::CancelFlag;
use grainpath_core::{DVec2, DVec3};
use grainpath_fea::material::Orthotropic;
use grainpath_fea::strength::Outcome;
use grainpath_fea::strength::brick_strength::SolidTest;
use grainpath_fea::strength::bricks::{BrickPly, Bricks};
use grainpath_fea::strength::card::StrengthCard;
use grainpath_fea::strength::cell_grid::CellGrid;
use grainpath_fea::strength::laminate::{Laminate, Ply};
use grainpath_fea::strength::plate_strength::PlateTest;
use grainpath_fea::strength::squares::{GridHold, PlateElements};

fn pla() -> StrengthCard {
    StrengthCard {
        elastic: Orthotropic {
            e_mpa: [2669.0, 2583.0, 2208.0],
            nu: [0.43, 0.37, 0.37],
            g_mpa: [919.0, 844.0, 844.0],
        },
        xt_mpa: 52.0,
        yt_mpa: 37.0,
        s12_mpa: 18.0,
        xc_mpa: 70.0,
        yc_mpa: 70.0,
        zt_mpa: 40.0,
        s_il_mpa: 18.0,
        g_along_n_mm: 4.0,
        g_across_n_mm: 1.3,
    }
}

/// Damage of a row-by-row grid of cells on the left, load over displacement on the right.
fn figure(caption: &str, n: [usize; 2], damage: &[Option<f32>], outcome: &Outcome) -> String {
    let (side, top, right) = (260.0 / n[0] as f64, 28.0, 330.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 560 210\" width=\"560\" font-family=\"sans-serif\" \
         font-size=\"11\"><rect width=\"560\" height=\"210\" fill=\"#fff\"/><text x=\"10\" y=\"16\">{caption}</text>"
    );
    let grey = |d: f32| 225 - (f64::from(d) * 4.0).round() as i32 * 50;
    let greys: Vec<Option<i32>> = damage.iter().map(|d| d.map(grey)).collect();
    for (j, row) in greys.chunks(n[0]).enumerate() {
        let mut x = 0;
        for run in row.chunk_by(|a, b| a == b) {
            if let Some(grey) = run[0] {
                let _ = write!(
                    out,
                    "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{side:.1}\" fill=\"rgb({grey},{grey},{grey})\"/>",
                    10.0 + x as f64 * side,
                    top + (n[1] - 1 - j) as f64 * side,
                    run.len() as f64 * side
                );
            }
            x += run.len();
        }
    }
    let most =
        outcome.curve.iter().fold((0.0f64, 0.0f64), |m, p| (m.0.max(p.displacement_mm), m.1.max(p.load_n)));
    let place = |u: f64, f: f64| (right + 200.0 * u / most.0, 185.0 - 150.0 * f / most.1);
    let line: Vec<String> = (outcome.curve.iter())
        .map(|p| place(p.displacement_mm, p.load_n))
        .map(|(x, y)| format!("{x:.0},{y:.0}"))
        .collect();
    let first = place(0.0, outcome.first_failure_n).1;
    let _ = writeln!(
        out,
        "<path d=\"M{right} 25V185H540\" fill=\"none\" stroke=\"#000\"/>\
         <path d=\"M{right} {first:.0}H540\" stroke=\"#999\" stroke-dasharray=\"4 3\"/>\
         <text x=\"538\" y=\"{:.0}\" text-anchor=\"end\" fill=\"#666\">first failure</text>\
         <polyline points=\"{}\" fill=\"none\" stroke=\"#c22\" stroke-width=\"2\"/>\
         <text x=\"435\" y=\"202\" text-anchor=\"middle\">displacement</text>\
         <text x=\"318\" y=\"105\" text-anchor=\"middle\" transform=\"rotate(-90 318 105)\">load</text></svg>",
        first + 13.0,
        line.join(" ")
    );
    out
}

/// Holds a figure in the sources against the one that the code draws.
fn hold(name: &str, svg: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/strength/figures").join(name);
    if std::env::var_os("UPDATE_FIGURES").is_some() {
        std::fs::write(&path, svg).expect("written");
    }
    let kept = std::fs::read_to_string(&path).expect("a figure");
    assert!(
        kept == svg,
        "{name} is out of date: UPDATE_FIGURES=1 cargo test -p grainpath-fea --test figures"
    );
}

#[test]
fn the_figure_of_plates() {
    let (n, cell_mm) = ([40usize, 16usize], 0.5);
    let grid = CellGrid { low: DVec2::new(-10.0, -4.0), cell_mm, nx: n[0], ny: n[1] };
    let mut laminate =
        Laminate { grid, starts: vec![0], plies: Vec::new(), height_mm: 1.0, volume_mm3: 1.0, laid_mm3: 1.0 };
    let active: Vec<bool> = (0..n[0] * n[1]).map(|c| grid.centre(c).length() > 1.5).collect();
    for active in &active {
        if *active {
            laminate.plies.push(Ply {
                thickness_mm: 1.0,
                angle_rad: 0.0,
                coherence: 1.0,
                material: 0,
                joined: 1.0,
            });
        }
        laminate.starts.push(laminate.plies.len() as u32);
    }
    let elements = PlateElements::from_cells(&grid, &active);
    let mut holds = Vec::new();
    let mut forces = vec![DVec2::ZERO; elements.places.len()];
    for (i, p) in elements.places.iter().enumerate() {
        if p[0] == 0 {
            holds.extend([DVec2::X, DVec2::Y].map(|along| GridHold { node: i as u32, along }));
        } else if p[0] as usize == n[0] {
            forces[i] = DVec2::X;
        }
    }
    let unbreakable: Vec<bool> =
        elements.cells.iter().map(|c| !(5..35).contains(&(*c as usize % n[0]))).collect();
    let test = PlateTest {
        laminate: &laminate,
        elements: &elements,
        holds: &holds,
        forces_n: &forces,
        load_n: 17.0,
        unbreakable: &unbreakable,
        cards: &[pla()],
        max_mib: 1024.0,
        cancel: CancelFlag::default(),
    };
    let outcome = test.run().expect("an answer");
    let mut damage = vec![None; active.len()];
    elements.cells.iter().zip(&outcome.damage).for_each(|(c, d)| damage[*c as usize] = Some(*d));
    hold("plate.svg", &figure("A plate with a hole, pulled to failure", n, &damage, &outcome));
}

#[test]
fn the_figure_of_solids() {
    let n = [36usize, 4, 8];
    let count = n[0] * n[1] * n[2];
    let place = |c: usize| [c % n[0], c / n[0] % n[1], c / n[0] / n[1]];
    let bricks = Bricks {
        n,
        origin: DVec3::ZERO,
        cell_mm: DVec3::ONE,
        filled: vec![1.0; count],
        bond: (0..count).map(|c| if place(c)[2] == 4 { 0.3 } else { 1.0 }).collect(),
        starts: (0..=count as u32).collect(),
        plies: vec![BrickPly { share: 1.0, angle_rad: 0.0 }; count],
        volume_mm3: 1.0,
        laid_mm3: 1.0,
    };
    let active: Vec<bool> = (0..count).map(|c| place(c)[0] < 22 || place(c)[2] != 4).collect();
    let face = |x: usize, low: usize| (low..=n[2]).flat_map(move |z| (0..=n[1]).map(move |y| [x, y, z]));
    let holds: Vec<_> = face(0, 0).flat_map(|p| DVec3::AXES.map(|a| (p, a))).collect();
    let ends: Vec<_> = face(n[0], n[2]).collect();
    let forces: Vec<_> = ends.iter().map(|p| (*p, DVec3::Z * (100.0 / ends.len() as f64))).collect();
    let unbreakable: Vec<bool> = (0..count).map(|c| place(c)[0] < 3 || place(c)[0] + 3 >= n[0]).collect();
    let test = SolidTest {
        bricks: &bricks,
        active: &active,
        holds: &holds,
        forces_n: &forces,
        load_n: 100.0,
        unbreakable: &unbreakable,
        card: &pla(),
        max_mib: 1024.0,
        cancel: CancelFlag::default(),
    };
    let outcome = test.run().expect("an answer");
    let mut all = vec![None; count];
    (0..count).filter(|c| active[*c]).zip(&outcome.damage).for_each(|(c, d)| all[c] = Some(*d));
    let section: Vec<Option<f32>> =
        (0..n[0] * n[2]).map(|i| all[(i / n[0] * n[1] + n[1] / 2) * n[0] + i % n[0]]).collect();
    hold(
        "solid.svg",
        &figure("A beam with a slit between layers, bent open", [n[0], n[2]], &section, &outcome),
    );
}
