//! Built-in examples (presets): jobs are texts of this crate, parts and other input files are computed.

mod continuous;
mod field;
mod hub;
mod stress_lines;
mod tree_support;
mod woodgrain;

use std::borrow::Cow;

use grainpath_core::spelling::meaning;
use grainpath_core::{DVec2, TriMesh};

use crate::shapes::{arc, prism};

/// A file of an example: name and content.
pub type ExampleFile = (Cow<'static, str>, Vec<u8>);

/// Names that [`preset`] knows.
pub const PRESETS: [&str; 7] = {
    let mut names = [""; MAKERS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = MAKERS[i].0;
        i += 1;
    }
    names
};

/// Makes the files of a preset.
type Maker = fn() -> Vec<ExampleFile>;

/// The presets: name, what it shows, and the function that makes its files.
const MAKERS: [(&str, (&str, Maker)); 7] = [
    ("plate", ("a plate with a hole, as a slicer would print it", plate_files)),
    ("stress-lines", ("bars in tension and bending, filled along the principal stress", stress_lines::files)),
    ("field", ("a plate filled along the directions of a table", field::files)),
    ("ct", ("a wheel hub planned from its CT scan, without a mesh", ct_files)),
    ("woodgrain", ("a board from its photograph, filled along the grain of the wood", woodgrain::files)),
    ("tree-support", ("parts with large overhangs on tree supports", tree_support::files)),
    ("continuous", ("a plate and a hook with one continuous path a layer, for fibre", continuous::files)),
];

/// The files of a preset; `None` for an unknown name.
pub fn preset(name: &str) -> Option<Vec<ExampleFile>> {
    meaning(&MAKERS, name).map(|(_, files)| files())
}

/// What a preset shows, in words; `None` for an unknown name.
pub fn about(name: &str) -> Option<&'static str> {
    meaning(&MAKERS, name).map(|(about, _)| about)
}

fn ct_files() -> Vec<ExampleFile> {
    ct(256)
}

fn plate_files() -> Vec<ExampleFile> {
    vec![
        ("job.toml".into(), include_bytes!("../../jobs/plate.toml").to_vec()),
        ("plate.stl".into(), stl(&plate())),
    ]
}

/// Files of the example `ct`: a scan of the wheel hub with `n` x `n` pixels a slice, its true dimensions, and the job.
pub fn ct(n: usize) -> Vec<ExampleFile> {
    let (size, mm) = hub::lattice(n);
    // A TIFF stack takes two bytes for each voxel, and about 400 bytes of directory for each slice.
    let mut tif = Vec::with_capacity(size.iter().product::<usize>() * 2 + size[2] * 400);
    grainpath_io::volume::write_tiff_stack(size, [mm; 3], |k| hub::slice(n, k), &mut tif)
        .expect("writing to memory cannot fail");
    vec![
        ("job.toml".into(), include_bytes!("../../jobs/ct.toml").to_vec()),
        ("hub.tif".into(), tif),
        ("truth.toml".into(), hub::truth().into_bytes()),
    ]
}

fn stl(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    grainpath_io::write_stl(mesh, &mut bytes).expect("writing to memory cannot fail");
    bytes
}

/// A mounting plate, 80 x 50 x 6 mm, with rounded corners, four bolt holes, a slot, and a thin rib on top.
pub fn plate() -> TriMesh {
    let corners: Vec<DVec2> = [(76.0, 46.0, 0), (4.0, 46.0, 1), (4.0, 4.0, 2), (76.0, 4.0, 3)]
        .into_iter()
        .flat_map(|(x, y, quarter)| arc(DVec2::new(x, y), 4.0, quarter, 1, 8))
        .collect();
    let bolts = [(10.0, 10.0), (70.0, 10.0), (70.0, 40.0), (10.0, 40.0)];
    let mut holes: Vec<Vec<DVec2>> =
        bolts.into_iter().map(|(x, y)| arc(DVec2::new(x, y), 2.75, 0, 4, 12)).collect();
    let slot = arc(DVec2::new(50.0, 25.0), 5.0, 3, 2, 12).into_iter();
    holes.push(slot.chain(arc(DVec2::new(30.0, 25.0), 5.0, 1, 2, 12)).collect());
    let mut mesh = TriMesh::default();
    prism(&corners, &holes, 0.0, 6.0, &mut mesh);
    // The rib reaches 1 mm into the plate: overlapping bodies are united, bodies that only touch may
    // leave a gap.
    let rib = [(20.0, 34.0), (60.0, 34.0), (60.0, 35.2), (20.0, 35.2)].map(DVec2::from);
    prism(&rib, &[], 5.0, 12.0, &mut mesh);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::mesh::diagnose;

    #[test]
    fn every_job_of_a_preset_states_the_format_of_this_version() {
        let mut jobs = 0;
        for (file, content) in PRESETS.iter().filter_map(|name| preset(name)).flatten() {
            let text = String::from_utf8(content).unwrap_or_default();
            // The file with the true dimensions of the scan is TOML too, but not a job.
            if file.ends_with(".toml") && text.lines().any(|line| line.starts_with("[shape")) {
                jobs += 1;
                let format = text
                    .parse::<toml::Table>()
                    .expect("TOML")
                    .get("format")
                    .and_then(toml::Value::as_integer);
                assert_eq!(format, Some(grainpath_job::FORMAT), "{file}");
            }
        }
        assert!(jobs > 20, "{jobs}");
    }

    #[test]
    fn the_plate_is_closed_and_has_its_volume() {
        let mesh = plate();
        let health = diagnose(&mesh).expect("triangles");
        assert!(health.is_closed() && health.shells == 2, "{health:?}");
        let pi = std::f64::consts::PI;
        let area = 80.0 * 50.0 - (4.0 - pi) * 16.0 - 4.0 * pi * 2.75 * 2.75 - pi * 25.0 - 20.0 * 10.0;
        let volume = area * 6.0 + 40.0 * 1.2 * 7.0;
        assert!((mesh.signed_volume() / volume - 1.0).abs() < 2e-3, "{} {volume}", mesh.signed_volume());
    }
}
