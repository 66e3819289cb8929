//! Example `field`: a plate whose beads follow a table of directions, those of a flow round its hole.

use std::fmt::Write;

use grainpath_core::math::atan2;
use grainpath_core::{DVec2, TriMesh};

use super::{ExampleFile, stl};
use crate::shapes::{arc, prism};

/// Length and width of the plate, mm; its centre is the origin. Source: chosen; the shape of an example of ours.
const SIZE_MM: DVec2 = DVec2::new(60.0, 40.0);
/// Source: chosen; the shape of an example of ours.
const THICKNESS_MM: f64 = 1.6;
/// Source: chosen; the shape of an example of ours.
const HOLE_RADIUS_MM: f64 = 8.0;
/// Distance between neighbouring points of the table, mm. Source: derived: the flow turns by less than
/// 30 degrees over 2 mm at the hole.
const PITCH_MM: f64 = 2.0;

/// The job, the plate and the table of directions.
pub(super) fn files() -> Vec<ExampleFile> {
    vec![
        ("job.toml".into(), include_bytes!("../../jobs/field.toml").to_vec()),
        ("plate.stl".into(), stl(&plate())),
        ("theta.csv".into(), directions().into_bytes()),
    ]
}

fn plate() -> TriMesh {
    let half = 0.5 * SIZE_MM;
    let outline = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|s| DVec2::from(s) * half);
    let mut mesh = TriMesh::default();
    prism(&outline, &[arc(DVec2::ZERO, HOLE_RADIUS_MM, 0, 4, 24)], 0.0, THICKNESS_MM, &mut mesh);
    mesh
}

/// Direction at `p` of the plane potential flow round the hole, degrees in `[0, 180)`.
fn angle_deg(p: DVec2) -> f64 {
    // The complex velocity 1 - R^2 / z^2, conjugated.
    let squared = DVec2::new(p.x * p.x - p.y * p.y, 2.0 * p.x * p.y);
    let scale = HOLE_RADIUS_MM * HOLE_RADIUS_MM / squared.length_squared();
    atan2(-scale * squared.y, 1.0 - scale * squared.x).to_degrees().rem_euclid(180.0)
}

/// The table as CSV: one row for each point of a square grid outside the hole or up to 2 mm inside its rim.
fn directions() -> String {
    let mut table = String::from("x_mm,y_mm,angle_deg\n");
    let n = (SIZE_MM / PITCH_MM).round();
    for row in 0..=n.y as usize {
        for column in 0..=n.x as usize {
            let p = DVec2::new(column as f64, row as f64) * PITCH_MM - 0.5 * SIZE_MM;
            if p.length() >= HOLE_RADIUS_MM - PITCH_MM {
                writeln!(table, "{},{},{:.2}", p.x, p.y, angle_deg(p))
                    .expect("writing to a string cannot fail");
            }
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flow_runs_round_the_hole() {
        assert!(angle_deg(DVec2::new(0.0, HOLE_RADIUS_MM)).abs() < 1e-9);
        assert!(angle_deg(DVec2::new(-500.0, 3.0)).min(180.0 - angle_deg(DVec2::new(-500.0, 3.0))) < 0.1);
        // Beside the stagnation point the flow runs along the rim, which turns there.
        let rim = grainpath_core::math::direction(0.3) * HOLE_RADIUS_MM;
        let tangent = (0.3f64.to_degrees() + 90.0).rem_euclid(180.0);
        assert!((angle_deg(rim) - tangent).abs() < 1e-6, "{}", angle_deg(rim));
    }
}
