//! What tests find beside closed forms, benchmarks and CalculiX: the tables of `docs/verification.md`, of the phantoms in
//! `docs/ct.md` and of the decks in `docs/formats.md`.
//!
//! The tests print each number with its key (see [`crate::measured`]) and hold it within a bound. Meshes of the bracket
//! come from the example `solve_stl` of `grainpath-fea`. Cost: about two minutes of one core.

use std::process::Command;

use crate::measured::{self, Table};

/// Tests that print what they find: the packages and targets that hold them, and their names. Files of tests are built
/// as `cargo xtask test` builds them, with the whole workspace: another choice of packages would be another build.
const TESTS: [(&[&str], &[&str]); 2] = [
    (
        &[
            "--workspace",
            "--test",
            "solid_verification",
            "--test",
            "solid_mesh",
            "--test",
            "solid_voxel",
            "--test",
            "decks",
        ],
        &[
            "patch_test",
            "nafems_le10_thick_plate",
            "nafems_le11_thermal",
            "lame_cylinder_and_orders_of_convergence",
            "cantilever_bends_as_timoshenko_says",
            "calculix_bracket",
            "calculix_plate_with_a_hole",
            "a_hollow_ball_under_pressure_from_surface_to_stress",
            "patch_test_of_turned_materials_and_scales",
            "a_cantilever_of_voxels_bends_as_beams_do",
            "voids_and_stiffness_that_fades_are_carried_and_solved_again",
            "le1_meets_calculix",
            "solids_meet_calculix",
        ],
    ),
    (
        &["-p", "grainpath-imaging", "--lib"],
        &[
            "scan::tests::even_voxels_give_true_sizes_and_counts",
            "scan::tests::canny_follows_the_paper_to_its_accuracy",
            "scan::tests::far_slices_are_bridged_by_matching_and_by_distance",
            "scan::tests::a_slope_of_45_degrees_has_no_stairs",
        ],
    ),
];

/// Sizes of elements on the bracket, mm.
const SIZES_MM: [&str; 4] = ["5.0", "3.7", "3.42", "2.2"];
/// What the largest displacement of the bracket converges to, mm. Source: gmsh's meshes up to 1 032 000 unknowns
/// (`docs/verification.md`).
const CONVERGED_MM: f64 = 0.03050;

/// Runs the tests and the meshes.
pub fn run() -> Result<(), String> {
    let data = crate::setup::data()?;
    for (targets, names) in TESTS {
        let mut command = Command::new("cargo");
        command.args(["test", "--profile", "ci"]).args(targets).arg("--").args(names);
        command.args(["--exact", "--include-ignored", "--nocapture"]).current_dir(crate::root());
        let text = crate::output(crate::setup::export(&mut command))?;
        // The harness leaves out a test that has another name now, without a word.
        let ran = |name: &&&str| text.lines().any(|l| l.starts_with(&format!("test {name} ")));
        if let Some(missing) = names.iter().find(|name| !ran(name)) {
            return Err(format!("no test has the name {missing}"));
        }
        measured::keep_lines(&text)?;
    }
    crate::cargo(&["build", "--profile", "ci", "-p", "grainpath-fea", "--example", "solve_stl"])?;
    let header = [
        "part",
        "size mm",
        "thousands of unknowns",
        "largest displacement mm",
        "off %",
        "volume %",
        "walls lost %",
        "dihedral min deg",
        "dihedral max deg",
    ];
    let table = Table::new("verification", &header, 2);
    for size_mm in SIZES_MM {
        let mut command = Command::new(crate::target().join("ci/examples/solve_stl"));
        command.arg(data.join("meshes/featuretype_inch.stl")).args(["25.4", size_mm]);
        let text = crate::output(&mut command)?;
        let after =
            |mark: &str| number(&text, mark).ok_or_else(|| format!("solve_stl: no number after {mark:?}"));
        let moved_mm = after("largest displacement ")?;
        table.row(&[
            "bracket".to_owned(),
            size_mm.to_owned(),
            format!("{:.3}", after(" elements, ")? / 1e3),
            format!("{moved_mm:.5}"),
            format!("{:+.1}", 100.0 * (moved_mm / CONVERGED_MM - 1.0)),
            format!("{:+.2}", after("volume ")?),
            format!("{:.2}", after("walls lost ")?),
            format!("{:.1}", after("dihedral_min_deg: ")?),
            format!("{:.0}", after("dihedral_max_deg: ")?),
        ]);
    }
    Ok(())
}

/// The number that stands behind a mark.
fn number(text: &str, mark: &str) -> Option<f64> {
    let (_, rest) = text.split_once(mark)?;
    let end = rest.find(|c: char| !c.is_ascii_digit() && !"+-.".contains(c)).unwrap_or(rest.len());
    rest[..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_behind_a_mark_has_its_sign() {
        let text = "12 elements, 236844 dofs, volume -0.062 %, walls lost 0.12 %";
        assert_eq!(number(text, " elements, "), Some(236_844.0));
        assert_eq!(number(text, "volume "), Some(-0.062));
        assert_eq!(number(text, "dihedral "), None);
    }
}
