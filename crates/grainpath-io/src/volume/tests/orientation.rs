//! Headers of every axis order, flip, unit, shear and tilt: voxels end up where the formulae of the standards say, and
//! never mirrored.

use grainpath_core::{DMat3, DVec3};

use super::*;

/// A world grid in LPS: value and position of each voxel tell which it is.
const SIZE: [usize; 3] = [5, 4, 3];
const SPACING_MM: [f64; 3] = [0.4, 0.5, 0.7];
const ORIGIN_MM: DVec3 = DVec3::new(10.0, -20.0, 30.0);

fn value(voxel: [usize; 3]) -> i16 {
    (1 + voxel[0] + 10 * voxel[1] + 100 * voxel[2]) as i16
}

/// The grid stored with its axes exchanged and reversed.
struct Stored {
    size: [usize; 3],
    origin_mm: DVec3,
    step_mm: [DVec3; 3],
    voxels: Vec<i16>,
}

/// Stored axis `a` runs along world axis `order[a]`, backwards if `reversed[a]`.
fn stored(order: [usize; 3], reversed: [bool; 3]) -> Stored {
    let size = order.map(|axis| SIZE[axis]);
    let unit = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut origin_mm = ORIGIN_MM;
    let step_mm = [0, 1, 2].map(|a| {
        let step = unit[order[a]] * SPACING_MM[order[a]];
        if reversed[a] {
            origin_mm += step * (size[a] - 1) as f64;
        }
        if reversed[a] { -step } else { step }
    });
    let mut voxels = Vec::new();
    for k in 0..size[2] {
        for j in 0..size[1] {
            for i in 0..size[0] {
                let mut world = [0; 3];
                for (a, index) in [i, j, k].into_iter().enumerate() {
                    world[order[a]] = if reversed[a] { size[a] - 1 - index } else { index };
                }
                voxels.push(value(world));
            }
        }
    }
    Stored { size, origin_mm, step_mm, voxels }
}

fn little_endian(voxels: &[i16]) -> Vec<u8> {
    voxels.iter().flat_map(|v| v.to_le_bytes()).collect()
}

const RAS: DVec3 = DVec3::new(-1.0, -1.0, 1.0);
const LAS: DVec3 = DVec3::new(1.0, -1.0, 1.0);

impl Stored {
    fn nrrd(&self, space: &str, from_lps: DVec3, unit: &str, mm: f64) -> Vec<u8> {
        let text = |v: DVec3| {
            let v = v * from_lps / mm;
            format!("({},{},{})", v.x, v.y, v.z)
        };
        let [nx, ny, nz] = self.size;
        let [a, b, c] = self.step_mm.map(text);
        let origin = text(self.origin_mm);
        let head = format!(
            "NRRD0005\ntype: short\ndimension: 3\nspace: {space}\nsizes: {nx} {ny} {nz}\n\
             space directions: {a} {b} {c}\nspace units: \"{unit}\" \"{unit}\" \"{unit}\"\nspace origin: {origin}\n\
             endian: little\nencoding: raw\n\n"
        );
        [head.into_bytes(), little_endian(&self.voxels)].concat()
    }

    fn metaimage(&self) -> Vec<u8> {
        let [nx, ny, nz] = self.size;
        let lengths = self.step_mm.map(DVec3::length);
        let rows: Vec<String> = (0..3)
            .map(|a| {
                let v = self.step_mm[a] / lengths[a];
                format!("{} {} {}", v.x, v.y, v.z)
            })
            .collect();
        let o = self.origin_mm;
        let head = format!(
            "ObjectType = Image\nNDims = 3\nTransformMatrix = {}\nOffset = {} {} {}\nElementSpacing = {} {} {}\n\
             DimSize = {nx} {ny} {nz}\nElementType = MET_SHORT\nElementDataFile = LOCAL\n",
            rows.join(" "),
            o.x,
            o.y,
            o.z,
            lengths[0],
            lengths[1],
            lengths[2],
        );
        [head.into_bytes(), little_endian(&self.voxels)].concat()
    }

    /// A header with the sform, the qform, or a wrong qform beside the sform.
    fn nifti(&self, forms: &str, unit: u8, mm: f64) -> Vec<u8> {
        let mut h = vec![0u8; 352];
        let mut put = |at: usize, bytes: &[u8]| h[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, &348i32.to_le_bytes());
        for (i, n) in [3, self.size[0], self.size[1], self.size[2], 1, 1, 1, 1].into_iter().enumerate() {
            put(40 + 2 * i, &(n as i16).to_le_bytes());
        }
        put(70, &4i16.to_le_bytes());
        put(108, &352f32.to_le_bytes());
        put(123, &[unit]);
        put(344, b"n+1\0");
        let mut real = |at: usize, v: f64| put(at, &(v as f32).to_le_bytes());
        let lengths = self.step_mm.map(DVec3::length);
        let axes = DMat3::from_cols(
            RAS * self.step_mm[0] / lengths[0],
            RAS * self.step_mm[1] / lengths[1],
            RAS * self.step_mm[2] / lengths[2],
        );
        let handedness = axes.determinant().signum();
        real(76, handedness);
        (0..3).for_each(|k| real(80 + 4 * k, lengths[k] / mm));
        let origin = RAS * self.origin_mm / mm;
        if forms.contains('q') {
            let turn = DMat3::from_cols(axes.x_axis, axes.y_axis, axes.z_axis * handedness);
            let [b, c, d] = quaternion(&turn);
            (0..3).for_each(|i| real(256 + 4 * i, [b, c, d][i]));
            (0..3).for_each(|i| real(268 + 4 * i, origin[i]));
        }
        if forms.contains('s') {
            for row in 0..3 {
                (0..3).for_each(|k| real(280 + 16 * row + 4 * k, axes.col(k)[row] * lengths[k] / mm));
                real(280 + 16 * row + 12, origin[row]);
            }
        }
        put(252, &i16::from(forms.contains(['q', 'w'])).to_le_bytes());
        put(254, &i16::from(forms.contains('s')).to_le_bytes());
        [h, little_endian(&self.voxels)].concat()
    }
}

/// The last three parts of a rotation's quaternion, whose first is not negative.
fn quaternion(m: &DMat3) -> [f64; 3] {
    let diagonal = [m.x_axis.x, m.y_axis.y, m.z_axis.z];
    let trace: f64 = diagonal.iter().sum();
    let a = 0.5 * (1.0 + trace).max(0.0).sqrt();
    if a > 1e-6 {
        let part = |u: f64, v: f64| (u - v) / (4.0 * a);
        return [part(m.y_axis.z, m.z_axis.y), part(m.z_axis.x, m.x_axis.z), part(m.x_axis.y, m.y_axis.x)];
    }
    // A half turn: the axis from the diagonal, its signs from the sums beside it.
    let axis = [0, 1, 2].map(|k| (0.5 * (1.0 + diagonal[k])).max(0.0).sqrt());
    let largest = (0..3).fold(0, |best, k| if axis[k] > axis[best] { k } else { best });
    [0, 1, 2].map(|k| if k == largest { axis[k] } else { m.col(k)[largest] / (2.0 * axis[largest]) })
}

/// All 48 ways to exchange and reverse three axes; half of them mirror.
fn every_order() -> impl Iterator<Item = ([usize; 3], [bool; 3])> {
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]];
    orders.into_iter().flat_map(|o| (0..8u8).map(move |bits| (o, [0, 1, 2].map(|a| bits >> a & 1 == 1))))
}

/// The slices must be the world grid itself, whichever way it was stored.
fn is_the_world(bytes: Vec<u8>, what: &str) {
    let mut source = single(&[("a", bytes)]).unwrap_or_else(|e| panic!("{what}: {e}"));
    let info = source.info().clone();
    assert_eq!(info.size, SIZE, "{what}");
    for _ in 0..2 {
        let slices = all(&mut *source).expect("slices");
        for z in 0..SIZE[2] {
            for y in 0..SIZE[1] {
                for x in 0..SIZE[0] {
                    let found = slices[z][y * SIZE[0] + x];
                    assert_eq!(found, f32::from(value([x, y, z])), "{what}: voxel {x} {y} {z}");
                    let expected =
                        ORIGIN_MM + DVec3::new(x as f64, y as f64, z as f64) * DVec3::from(SPACING_MM);
                    let centre = info.world_mm([x, y, z]).expect("a world");
                    assert!(centre.distance(expected) < 1e-4, "{what}: {centre} for {expected}");
                }
            }
        }
        source.restart().expect("again");
    }
    // Passing over slices comes to the same slice.
    source.skip_slice().expect("one");
    let mut second = Vec::new();
    source.next_slice(&mut second).expect("two");
    assert_eq!(second[0], f32::from(value([0, 0, 1])), "{what}");
}

#[test]
fn every_axis_order_and_flip_gives_the_same_slices() {
    for (order, reversed) in every_order() {
        let s = stored(order, reversed);
        let what = |format: &str| format!("{format}, axes {order:?}, reversed {reversed:?}");
        is_the_world(s.nrrd("left-posterior-superior", DVec3::ONE, "mm", 1.0), &what("NRRD LPS"));
        is_the_world(s.nrrd("RAS", RAS, "m", 1000.0), &what("NRRD RAS m"));
        is_the_world(s.nrrd("left-anterior-superior", LAS, "um", 1e-3), &what("NRRD LAS um"));
        is_the_world(s.metaimage(), &what("MetaImage"));
        is_the_world(s.nifti("s", 2, 1.0), &what("NIfTI sform"));
        is_the_world(s.nifti("q", 2, 1.0), &what("NIfTI qform"));
        is_the_world(s.nifti("qs", 1, 1000.0), &what("NIfTI m"));
        is_the_world(s.nifti("s", 3, 1e-3), &what("NIfTI um"));
    }
}

/// The first slice of the world has no value at all, and the others none in their third column.
#[test]
fn voxels_without_a_value_are_those_that_were_stored_without_one() {
    let is_lost = |v: i16| v < 100 || v % 10 == 3;
    for (order, reversed) in every_order() {
        let s = stored(order, reversed);
        let bytes = s.nrrd("left-posterior-superior", DVec3::ONE, "mm", 1.0);
        let head =
            String::from_utf8_lossy(&bytes[..bytes.len() - 2 * s.voxels.len()]).replace("short", "float");
        let stored = s.voxels.iter().map(|&v| if is_lost(v) { f32::NAN } else { f32::from(v) });
        let bytes: Vec<u8> = head.bytes().chain(stored.flat_map(f32::to_le_bytes)).collect();
        let what = format!("axes {order:?}, reversed {reversed:?}");
        let mut source = single(&[("a.nrrd", bytes)]).expect(&what);
        let world = |z: usize| (0..20).map(move |p| value([p % 5, p / 5, z]));
        for (finite, air) in [(false, f32::NAN), (true, 101.0)] {
            source.restart().expect("again");
            let (mut slice, mut n_lost) = (Vec::new(), 0);
            for z in 0..3 {
                let more = if finite { source.next_slice(&mut slice) } else { source.next_known(&mut slice) };
                assert!(more.expect("a slice"));
                // The least value of the third slice is higher by 100.
                let air = air + if z == 2 { 100.0 } else { 0.0 };
                let expected: Vec<f32> =
                    world(z).map(|v| if is_lost(v) { air } else { f32::from(v) }).collect();
                assert_eq!(format!("{slice:?}"), format!("{expected:?}"), "{what}, slice {z}");
                n_lost += world(z).filter(|v| is_lost(*v)).count() as u64;
                assert_eq!(source.n_not_finite(), n_lost, "{what}, slice {z}");
            }
        }
    }
}

#[test]
fn the_sform_counts_before_a_qform_that_contradicts_it() {
    let bytes = stored([1, 0, 2], [false, true, false]).nifti("sw", 2, 1.0);
    let source = single(&[("a", bytes.clone())]).expect("a volume");
    let told = source.info().warnings.iter().any(|w| w.text.contains("the sform is taken"));
    assert!(told, "{:?}", source.info().warnings);
    is_the_world(bytes, "sform against qform");
}

#[test]
fn anatomical_orientation_is_read_where_there_is_no_matrix() {
    let s = stored([0, 1, 2], [true, true, false]);
    let text = String::from_utf8_lossy(&s.metaimage()).into_owned();
    let head: String = text
        .lines()
        .take_while(|l| !l.starts_with("ElementDataFile"))
        .filter(|l| !l.starts_with("TransformMatrix"))
        .map(|l| format!("{l}\n"))
        .collect();
    let head = format!("{head}AnatomicalOrientation = LPI\nElementDataFile = LOCAL\n");
    is_the_world([head.into_bytes(), little_endian(&s.voxels)].concat(), "LPI");
}

/// A grey value that is linear in the world: interpolation keeps it exactly.
fn ramp(p: DVec3) -> f64 {
    500.0 + p.dot(DVec3::new(7.0, 11.0, 13.0))
}

/// A stack of slices with any affine placement and the grey values of [`ramp`], as NRRD in double precision.
fn affine(size: [usize; 3], origin_mm: DVec3, step_mm: [DVec3; 3]) -> Vec<u8> {
    let text = |v: DVec3| format!("({},{},{})", v.x, v.y, v.z);
    let [nx, ny, nz] = size;
    let mut bytes = format!(
        "NRRD0005\ntype: double\ndimension: 3\nspace: LPS\nsizes: {nx} {ny} {nz}\nspace directions: {} {} {}\n\
         space origin: {}\nendian: little\nencoding: raw\n\n",
        text(step_mm[0]),
        text(step_mm[1]),
        text(step_mm[2]),
        text(origin_mm)
    )
    .into_bytes();
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let p = origin_mm + step_mm[0] * i as f64 + step_mm[1] * j as f64 + step_mm[2] * k as f64;
                bytes.extend(ramp(p).to_le_bytes());
            }
        }
    }
    bytes
}

/// Every voxel within the stored stack has the grey value of its place in the world; gives how many those are.
fn follows_the_ramp(
    bytes: Vec<u8>,
    size: [usize; 3],
    origin_mm: DVec3,
    step_mm: [DVec3; 3],
    what: &str,
) -> usize {
    let mut source = single(&[("a", bytes)]).unwrap_or_else(|e| panic!("{what}: {e}"));
    let info = source.info().clone();
    let world = info.world.expect("a world");
    assert!((world.axes.determinant() - 1.0).abs() < 1e-9, "{what}: the slices' axes must be right-handed");
    let to_stored = DMat3::from_cols(step_mm[0], step_mm[1], step_mm[2]).inverse();
    let slices = all(&mut *source).expect("slices");
    assert_eq!(slices.len(), info.size[2], "{what}");
    let mut n_inside = 0;
    for (z, slice) in slices.iter().enumerate() {
        for (n, found) in slice.iter().enumerate() {
            let p = info.world_mm([n % info.size[0], n / info.size[0], z]).expect("a world");
            let at = to_stored * (p - origin_mm);
            let inside = (0..3).all(|a| at[a] >= -1e-6 && at[a] <= (size[a] - 1) as f64 + 1e-6);
            if inside {
                n_inside += 1;
                let expected = ramp(p);
                assert!((f64::from(*found) - expected).abs() < 2e-3, "{what}: {found} for {expected} at {p}");
            }
        }
    }
    n_inside
}

#[test]
fn sheared_stacks_are_moved_upright_and_say_so() {
    let size = [12, 10, 9];
    let origin_mm = DVec3::new(3.0, -4.0, 5.0);
    let mut n = 0;
    for (order, reversed) in every_order() {
        let s = stored(order, reversed);
        // Each stored axis leans towards the others, by up to 20 degrees.
        for (lean, what) in
            [([0.0, 0.3, 0.0], "rows"), ([0.0, 0.0, -0.35], "slices"), ([0.1, -0.2, 0.25], "all")]
        {
            let step_mm = [0, 1, 2].map(|a: usize| {
                let other = s.step_mm[(a + 1) % 3] / s.step_mm[(a + 1) % 3].length();
                s.step_mm[a] + other * lean[a] * s.step_mm[a].length()
            });
            let what = format!("{what} lean, axes {order:?}, reversed {reversed:?}");
            let bytes = affine(size, origin_mm, step_mm);
            let mut source = single(&[("a", bytes.clone())]).expect(&what);
            let told = source.info().warnings.iter().any(|w| w.text.contains("moved upright"));
            assert!(told, "{what}: {:?}", source.info().warnings);
            // The corners that the stored stack does not reach have no value, and the file holds all of its own.
            let (mut slice, mut n_unknown) = (Vec::new(), 0);
            while source.next_known(&mut slice).expect("slices") {
                n_unknown += slice.iter().filter(|v| v.is_nan()).count();
            }
            assert!(n_unknown > 50 && source.n_not_finite() == 0, "{what}: {n_unknown}");
            let inside = follows_the_ramp(bytes, size, origin_mm, step_mm, &what);
            assert!(inside > 12 * 10 * 9 * 4 / 5, "{what}: {inside}");
            n += 1;
        }
    }
    assert_eq!(n, 144);
}

#[test]
fn an_oblique_scan_is_not_resampled_and_says_its_angle() {
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 20f64.to_radians());
    let size = [6, 5, 4];
    for (order, reversed) in every_order() {
        let s = stored(order, reversed);
        let step_mm = s.step_mm.map(|v| turn * v);
        let bytes = affine(size, ORIGIN_MM, step_mm);
        let source = single(&[("a", bytes.clone())]).expect("a volume");
        let warnings = &source.info().warnings;
        assert!(warnings.iter().any(|w| w.text.contains("turned by 20.00 degrees")), "{warnings:?}");
        assert!(!warnings.iter().any(|w| w.text.contains("moved upright")), "{warnings:?}");
        assert_eq!(follows_the_ramp(bytes, size, ORIGIN_MM, step_mm, "oblique"), 120);
    }
}

#[test]
fn axes_that_span_no_volume_are_refused() {
    let flat = [DVec3::X, DVec3::Y, DVec3::new(1.0, 2.0, 0.0)];
    says(single(&[("a.nrrd", affine([2, 2, 2], DVec3::ZERO, flat))]), "a.nrrd", "span no volume");
    let steep = [DVec3::X, DVec3::Y, DVec3::new(3.0, 0.0, 1.0)];
    says(single(&[("a.nrrd", affine([2, 2, 2], DVec3::ZERO, steep))]), "a.nrrd", "leans by 71.6 degrees");
    let text = String::from_utf8_lossy(&affine([2, 2, 2], DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z]))
        .replace("space: LPS", "space: left-posterior-superior-time");
    says(single(&[("a.nrrd", text.into_bytes())]), "a.nrrd", "a space of three axes");
}

#[test]
fn many_blocks_are_read_where_slices_lie_across() {
    // 1200 x 1200 slices of float need 5.8 MB each: 46 fit, so 50 slices along the rows take two passes.
    let (nx, ny, nz) = (1200, 50, 1200);
    let mut bytes = format!(
        "NRRD0005\ntype: uint8\ndimension: 3\nspace: LPS\nsizes: {nx} {ny} {nz}\n\
         space directions: (0.1,0,0) (0,0,0.1) (0,-0.1,0)\nspace origin: (0,0,0)\nencoding: raw\n\n"
    )
    .into_bytes();
    bytes.extend((0..nx * ny * nz).map(|n| ((n / nx) % ny * 5) as u8));
    let mut source = single(&[("a.nrrd", bytes)]).expect("a volume");
    assert_eq!(source.info().size, [nx, nz, ny]);
    assert!(source.info().warnings[0].text.contains("2 times"), "{:?}", source.info().warnings);
    let mut slice = Vec::new();
    for z in 0..ny {
        assert!(source.next_slice(&mut slice).expect("a slice"));
        assert!(slice.iter().all(|v| *v == (z * 5) as f32), "slice {z}");
    }
    assert!(!source.next_slice(&mut slice).expect("the end"));
}

#[test]
fn dicom_planes_and_tilted_gantries_come_upright() {
    let size = [9u16, 8, 7];
    let pixel_mm = [0.6, 0.5];
    let tilt = |degrees: f64| grainpath_core::math::sin_cos(degrees.to_radians());
    let planes: [(&str, DVec3, DVec3, DVec3); 6] = [
        ("axial", DVec3::X, DVec3::Y, DVec3::new(0.0, 0.0, 1.5)),
        ("axial, feet first in the files", DVec3::NEG_X, DVec3::NEG_Y, DVec3::new(0.0, 0.0, -1.5)),
        ("coronal", DVec3::X, DVec3::NEG_Z, DVec3::new(0.0, 1.5, 0.0)),
        ("sagittal", DVec3::Y, DVec3::NEG_Z, DVec3::new(1.5, 0.0, 0.0)),
        ("tilted", DVec3::X, DVec3::new(0.0, tilt(18.0).1, -tilt(18.0).0), DVec3::new(0.0, 0.0, 1.5)),
        ("tilted back", DVec3::X, DVec3::new(0.0, tilt(18.0).1, tilt(18.0).0), DVec3::new(0.0, 0.0, 1.5)),
    ];
    for (what, row, column, step) in planes {
        let origin_mm = DVec3::new(1.0, 2.0, 3.0);
        let step_mm = [row * pixel_mm[1], column * pixel_mm[0], step];
        let series: Vec<(String, Vec<u8>)> = (0..usize::from(size[2]))
            .map(|k| {
                let p = origin_mm + step * k as f64;
                let pixels = |i: u16, j: u16| {
                    let at = p + step_mm[0] * f64::from(i) + step_mm[1] * f64::from(j);
                    (ramp(at) * 10.0).round() as u16
                };
                let slice = Dicom {
                    position: p.to_array(),
                    orientation: [row.x, row.y, row.z, column.x, column.y, column.z],
                    pixel_mm,
                    size: [size[0], size[1]],
                    pixels: Some(
                        (0..size[1]).flat_map(|j| (0..size[0]).map(move |i| pixels(i, j))).collect(),
                    ),
                    rescale: (0.1, 0.0),
                    ..Dicom::default()
                };
                (format!("{:02}", (7 * k + 3) % 10), slice.bytes())
            })
            .collect();
        let named: Vec<(&str, Vec<u8>)> = series.iter().map(|(n, b)| (n.as_str(), b.clone())).collect();
        let mut source = folder(&named).expect(what);
        let info = source.info().clone();
        let world = info.world.expect("a world");
        assert!((world.axes.determinant() - 1.0).abs() < 1e-9, "{what}");
        let told = |word: &str| info.warnings.iter().any(|w| w.text.contains(word));
        assert_eq!(
            told("the stack leans by 18.00 degrees"),
            what.starts_with("tilted"),
            "{:?}",
            info.warnings
        );
        let to_stored = DMat3::from_cols(step_mm[0], step_mm[1], step_mm[2]).inverse();
        let mut n_inside = 0;
        for (z, slice) in all(&mut *source).expect("slices").iter().enumerate() {
            for (n, found) in slice.iter().enumerate() {
                let p = info.world_mm([n % info.size[0], n / info.size[0], z]).expect("a world");
                let at = to_stored * (p - origin_mm);
                if (0..3).all(|a| at[a] > -1e-6 && at[a] < f64::from(size[a] - 1) + 1e-6) {
                    n_inside += 1;
                    assert!(
                        (f64::from(*found) - ramp(p)).abs() < 0.06,
                        "{what}: {found} for {} at {p}",
                        ramp(p)
                    );
                }
            }
        }
        assert!(n_inside > 9 * 8 * 7 * 4 / 5, "{what}: {n_inside}");
    }
}
