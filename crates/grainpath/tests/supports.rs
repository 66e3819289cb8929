//! Supports of every real mesh: nothing floats, nothing cuts the part, no branch leans too far, every overhang is
//! near a contact or listed.

use std::path::{Path, PathBuf};

use grainpath::config;
use grainpath::run::mesh_and_layers;
use grainpath::support::cut::count_floating;
use grainpath::support::{Support, SupportSettings, plan};
use grainpath::Settings;
use grainpath_core::{DVec2, Diagnostics, LayerStack};
use rayon::prelude::*;

fn meshes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/meshes");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped: no ../shared/data");
        return Vec::new();
    };
    let mut paths: Vec<PathBuf> = entries.filter_map(|e| e.ok().map(|e| e.path())).filter(|p| p.is_file()).collect();
    paths.sort();
    paths
}

fn settings() -> Settings {
    let mut s = Settings::default();
    s.support.style = "tree".into();
    s.printer.bed_mm = [2000.0; 3];
    s
}

fn supported(path: &Path, s: &Settings) -> Option<(Support, LayerStack, SupportSettings)> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    let bytes = std::fs::read(path).ok()?;
    let file = grainpath_io::parse_mesh(&bytes, Some(&name)).ok()?;
    let mut s = s.clone();
    let longest = file.bodies.iter().filter_map(|b| b.mesh.bounds()).map(|(l, h)| (h - l).max_element());
    let longest = longest.fold(0.0, f64::max);
    // Units are not told in most files; anything between a coin and a bucket will do.
    s.shape.scale = if file.unit.is_some() {
        1.0
    } else if longest < 1.0 {
        60.0 / longest
    } else if longest < 9.0 {
        25.4
    } else {
        1.0
    };
    if longest > 500.0 {
        s.shape.scale = 100.0 / longest;
    }
    let quiet = Diagnostics::default();
    let (mesh, stack) = mesh_and_layers(&s, file, &quiet).ok()?;
    let wanted = config::support(&s, DVec2::ZERO).map(|w| SupportSettings { bed: None, ..w })?;
    let support = plan(&mesh, &stack, &wanted, &quiet).ok()?;
    Some((support, stack, wanted))
}

#[test]
fn supports_of_every_real_mesh_stand_and_keep_off_the_part() {
    let mut wrong = Vec::new();
    let mut done = 0;
    for path in meshes() {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        if name.contains("skull") && std::env::var_os("GRAINPATH_SLOW").is_none() {
            continue;
        }
        if std::env::var("GRAINPATH_MESH").is_ok_and(|part| !name.contains(&part)) {
            continue;
        }
        let start = std::time::Instant::now();
        let Some((support, stack, wanted)) = supported(&path, &settings()) else { continue };
        done += 1;
        let cut: Vec<f64> = (0..stack.layers().len())
            .into_par_iter()
            .map(|k| support.cut.layers[k].region.intersection(stack.layers()[k].region()).area_mm2())
            .collect();
        let cuts = cut.iter().filter(|&&a| a > 1e-3).count();
        let floating = count_floating(&support.cut.layers, &stack, &wanted);
        let steepest = support.forest.steepest_rad().to_degrees();
        let farthest = support.farthest_mm();
        let row = format!(
            "{name}: {} contacts, {} trees, {} unreached, {} near the plate, {} dropped, floating {floating}, cuts {cuts}, \
             steepest {steepest:.2}, farthest {farthest:.2} mm, {:.0} mm3, {:.2} s",
            support.overhangs.contacts.len(),
            support.forest.n_trees(),
            support.unreached.len(),
            support.near_plate,
            support.cut.dropped,
            support.volume_mm3(&stack),
            start.elapsed().as_secs_f64(),
        );
        println!("{row}");
        let limit = wanted.branch_angle_rad.to_degrees() + 0.01;
        if floating > 0 || cuts > 0 || steepest > limit || farthest > 0.5 * wanted.max_unsupported_mm {
            wrong.push(row);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let all = std::env::var_os("GRAINPATH_MESH").is_none();
    assert!(done == 0 || done > 40 || !all, "only {done} meshes could be tried");
}
