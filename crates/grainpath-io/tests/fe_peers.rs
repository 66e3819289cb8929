//! Files that we write open in other programs with the same numbers: in meshio, and in VTK where it is
//! installed.

#[path = "../../../tests/data.rs"]
mod data;

use std::path::Path;

use grainpath_io::fe::{
    Element, ElementKind, Encoding, FeOptions, VtuMesh, parse_fe, stress_point_data, write_vtu,
};

/// Prints the number of points and cells, the sum of all stresses, and the sum of the squares of all
/// principal vectors.
const MESHIO: &str = "
import sys, meshio, numpy as np
m = meshio.read(sys.argv[1])
v = [m.point_data['principal_' + k] for k in ('max', 'mid', 'min')]
print(len(m.points), sum(len(c.data) for c in m.cells), repr(float(m.point_data['S'].sum())), repr(float(sum((x * x).sum() for x in v))))
";

const VTK: &str = "
import sys, vtk
from vtk.util.numpy_support import vtk_to_numpy
r = vtk.vtkXMLUnstructuredGridReader()
r.SetFileName(sys.argv[1])
r.Update()
g = r.GetOutput()
d = g.GetPointData()
v = [vtk_to_numpy(d.GetArray('principal_' + k)) for k in ('max', 'mid', 'min')]
assert d.GetArray('S').GetComponentName(3) == 'XY'
print(g.GetNumberOfPoints(), g.GetNumberOfCells(), repr(float(vtk_to_numpy(d.GetArray('S')).sum())), repr(float(sum((x * x).sum() for x in v))))
";

#[test]
#[ignore = "needs python"]
fn vtu_opens_in_meshio() {
    opens_in("meshio", MESHIO);
}

#[test]
#[ignore = "needs python with vtk"]
fn vtu_opens_in_vtk() {
    opens_in("vtk", VTK);
}

/// Writes a result in each encoding, and compares the numbers that a Python package reads with those
/// written.
fn opens_in(module: &str, script: &str) {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fe/base64.vtu");
    let file = parse_fe(&std::fs::read(fixture).expect("a fixture"), None).expect("a good file");
    let result = file.result(&FeOptions::default()).expect("a stress");
    let data = stress_point_data(&result.stress, result.displacement.as_deref());
    let sum: f64 = result.stress.iter().flatten().sum();
    // The squares of the principal stresses add up to the squares of the tensor's components, so one
    // number checks all vectors.
    let squares: f64 = result
        .stress
        .iter()
        .flat_map(|s| (0..6).map(|k| if k < 3 { s[k] * s[k] } else { 2.0 * s[k] * s[k] }))
        .sum();
    // meshio does not know the wedge of 15 nodes.
    let known = |e: &&Element| module != "meshio" || e.kind != ElementKind::Wedge15;
    let elements: Vec<Element> = result.elements.iter().filter(known).copied().collect();
    for (name, encoding) in [("ascii", Encoding::Ascii), ("raw", Encoding::Raw), ("zlib", Encoding::Zlib)] {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("peer-{module}-{name}.vtu"));
        let mut out = Vec::new();
        let mesh = VtuMesh { nodes: &result.nodes, elements: &elements };
        write_vtu(mesh, &data, encoding, &mut out).expect("memory takes all");
        std::fs::write(&path, out).expect("a file");
        let seen = data::python(|python| {
            python.args(["-c", script]).arg(&path);
        });
        let text = String::from_utf8_lossy(&seen);
        let numbers: Vec<f64> = text.split_whitespace().filter_map(|w| w.parse().ok()).collect();
        let [points, cells, s, p] = numbers[..] else { panic!("{module} {name}: {text}") };
        assert_eq!((points, cells), (68.0, elements.len() as f64), "{module} {name}");
        assert!(
            (s / sum - 1.0).abs() < 1e-12 && (p / squares - 1.0).abs() < 1e-12,
            "{module} {name}: {s} {p}"
        );
    }
}
