use grainpath_core::math::direction;
use grainpath_core::slices::{SampleType, VolumeInfo};

use super::*;

/// A scan made up as it is read: the signed distance of a solid, blurred, with noise.
pub(super) struct Phantom {
    info: VolumeInfo,
    solid: fn([f64; 3]) -> f64,
    blur_px: f64,
    noise: f64,
    next: usize,
}

const AIR: f64 = 1000.0;
const METAL: f64 = 21000.0;

impl Phantom {
    pub(super) fn new(solid: fn([f64; 3]) -> f64, size: [usize; 3], spacing: [f64; 3]) -> Self {
        let mut info = VolumeInfo::new("phantom", size, SampleType::U16);
        info.spacing_mm = spacing.map(Some);
        Self { info, solid, blur_px: 0.8, noise: 200.0, next: 0 }
    }

    fn value(&self, i: usize, j: usize, k: usize) -> f32 {
        let s = self.info.spacing_mm.map(|v| v.unwrap_or(1.0));
        let p = [(i as f64 + 0.5) * s[0], (j as f64 + 0.5) * s[1], (k as f64 + 0.5) * s[2]];
        let d = (self.solid)(p) / (self.blur_px * s[0]);
        // A Gaussian's integral, close enough: both are odd and end at the same places.
        let share = 1.0 / (1.0 + grainpath_core::math::exp(-1.702 * d));
        // Deterministic noise of about the given deviation: four hashed bytes summed.
        let mut h = (i as u64) << 40 ^ (j as u64) << 20 ^ k as u64;
        h = (h ^ h >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        h = (h ^ h >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h ^= h >> 32;
        let sum: f64 = (0..4).map(|b| (h >> (8 * b) & 255) as f64 - 127.5).sum();
        (AIR + (METAL - AIR) * share + self.noise * sum / 147.8).clamp(0.0, 65535.0).round() as f32
    }
}

impl SliceSource for Phantom {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.next = 0;
        Ok(())
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        let [nx, ny, nz] = self.info.size;
        if self.next == nz {
            return Ok(false);
        }
        out.extend((0..nx * ny).map(|p| self.value(p % nx, p / nx, self.next)));
        self.next += 1;
        Ok(true)
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        let more = self.next < self.info.size[2];
        self.next += usize::from(more);
        Ok(more)
    }
}

pub(super) fn settings() -> CtSettings {
    CtSettings {
        section: "shape.ct",
        spacing_mm: [None; 3],
        scale: 1.0,
        window: None,
        crop_px: None,
        flip: [false; 3],
        threshold: Threshold::Iso50(None),
        denoise: Denoise::None,
        tracing: Tracing::Iso,
        canny: [0.04, 0.1, 1.0],
        interpolation: Interpolation::Auto,
        overlap: 0.2,
        min_island_mm2: 0.2,
        rotate_rad: [0.0; 3],
        min_piece_mm3: 0.0,
        min_pore_mm2: 0.1,
        layer_height_mm: 0.2,
        first_layer_height_mm: 0.2,
        simplify_mm: 0.0125,
    }
}

fn length(p: [f64; 3], c: [f64; 3]) -> f64 {
    (0..3).map(|k| (p[k] - c[k]).powi(2)).sum::<f64>().sqrt()
}

fn sphere(p: [f64; 3]) -> f64 {
    8.0 - length(p, [10.0, 10.0, 10.0])
}

/// 45 degrees, from radius 8.5 at z = 1.
fn cone(p: [f64; 3]) -> f64 {
    let r = (p[0] - 10.0).hypot_(p[1] - 10.0);
    let slope = (8.5 - (p[2] - 1.0) - r) * std::f64::consts::FRAC_1_SQRT_2;
    slope.min(p[2] - 1.0).min(7.5 - p[2])
}

fn torus(p: [f64; 3]) -> f64 {
    let r = (p[0] - 10.0).hypot_(p[1] - 10.0) - 6.0;
    2.5 - r.hypot_(p[2] - 4.0)
}

/// A trunk that parts into two at z = 8.
fn branch(p: [f64; 3]) -> f64 {
    let rod = |a: [f64; 3], b: [f64; 3]| {
        let d = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let l: f64 = d.iter().map(|v| v * v).sum();
        let t = (0..3).map(|k| (p[k] - a[k]) * d[k]).sum::<f64>() / l;
        2.5 - length(p, [0, 1, 2].map(|k| a[k] + t.clamp(0.0, 1.0) * d[k]))
    };
    let arms = rod([10.0, 10.0, 6.0], [4.5, 10.0, 16.0]).max(rod([10.0, 10.0, 6.0], [15.5, 10.0, 16.0]));
    rod([10.0, 10.0, -5.0], [10.0, 10.0, 6.0]).max(arms).min(13.7 - p[2]).min(p[2] - 1.0)
}

fn helix(p: [f64; 3]) -> f64 {
    let turn = p[2] * 0.25;
    let strand = |angle: f64| {
        let c = direction(angle) * 5.0 + 10.0;
        // The section is a disc; the strand leans, so its distance is less.
        (1.8 - (p[0] - c.x).hypot_(p[1] - c.y)) * 0.62
    };
    strand(turn).max(strand(turn + std::f64::consts::PI)).min(p[2] - 1.0).min(14.9 - p[2])
}

/// 1.2 mm thick, leaning.
fn wall(p: [f64; 3]) -> f64 {
    let x = p[0] - 4.0 - 0.5 * p[2];
    (0.6 - x.abs() / 1.25f64.sqrt()).min(p[1] - 3.0).min(17.0 - p[1]).min(p[2] - 1.0).min(14.9 - p[2])
}

fn shells(p: [f64; 3]) -> f64 {
    let r = length(p, [10.0, 10.0, 10.0]);
    let shell = |a: f64, b: f64| (r - a).min(b - r);
    shell(7.0, 8.6).max(shell(4.4, 5.8)).max(2.5 - r)
}

trait Hypot {
    fn hypot_(self, other: f64) -> f64;
}
impl Hypot for f64 {
    fn hypot_(self, other: f64) -> f64 {
        (self * self + other * other).sqrt()
    }
}

type Solid = fn([f64; 3]) -> f64;
const SOLIDS: [(&str, Solid); 7] = [
    ("sphere", sphere),
    ("cone", cone),
    ("torus", torus),
    ("branch", branch),
    ("helix", helix),
    ("wall", wall),
    ("shells", shells),
];

/// Area and number of islands and holes of the true section.
fn truth(solid: Solid, z: f64) -> (f64, [usize; 2]) {
    let n = 400;
    let step = 20.0 / n as f64;
    let at =
        |p: usize| solid([(p % n) as f64 * step + 0.5 * step, (p / n) as f64 * step + 0.5 * step, z]) as f32;
    let contours = SignedImage::new(&(0..n * n).map(at).collect::<Vec<f32>>(), n, n).contours();
    let areas: Vec<f64> = contours.iter().map(|c| signed_area_mm2(c) * step * step).collect();
    let counted = |positive: bool| areas.iter().filter(|a| a.abs() > 0.2 && (**a > 0.0) == positive).count();
    (areas.iter().sum(), [counted(true), counted(false)])
}

/// Mean size error over layers, signed, and layers with a wrong count of islands or holes.
fn errors(name: &str, solid: Solid, stack: &LayerStack, bottom: f64, slice_mm: f64) -> (f64, f64, usize) {
    let (mut sum, mut absolute, mut n, mut wrong) = (0.0, 0.0, 0, 0);
    for l in stack.layers() {
        let z = bottom + l.z_top_mm() - 0.5 * l.height_mm();
        let (area, counts) = truth(solid, z);
        let found = [l.region().polygons.len(), l.region().polygons.iter().map(|p| p.holes.len()).sum()];
        if found != counts {
            // Within a slice of where it changes either count is as right.
            let near = [-1.0, -0.5, 0.5, 1.0].map(|k| truth(solid, z + k * slice_mm).1);
            if !near.contains(&found) {
                println!("{name}: z {z:.2} has {found:?}, should have {counts:?}");
                wrong += 1;
            }
        } else if area > 3.0 && [-1.0, 1.0].iter().all(|k| truth(solid, z + k * slice_mm).0 > 3.0) {
            let e = (l.region().area_mm2() / area).sqrt() - 1.0;
            sum += e;
            absolute += e.abs();
            n += 1;
        }
    }
    (sum / f64::from(n.max(1)), absolute / f64::from(n.max(1)), wrong)
}

/// The lowest point of a solid.
fn bottom(solid: Solid) -> f64 {
    (0..20_000).map(|k| f64::from(k) * 0.001).find(|&z| truth_any(solid, z)).unwrap_or(0.0) - 0.0005
}

fn truth_any(solid: Solid, z: f64) -> bool {
    (0..2500).any(|p| solid([f64::from(p % 50) * 0.4, f64::from(p / 50) * 0.4, z]) > 0.0)
}

fn run(source: &mut Phantom, s: &CtSettings) -> CtStack {
    slice_scan(source, s, &Diagnostics::default()).expect("a scan")
}

#[test]
fn even_voxels_give_true_sizes_and_counts() {
    for (name, solid) in SOLIDS {
        let mut phantom = Phantom::new(solid, [100, 100, 100], [0.2; 3]);
        let made = run(&mut phantom, &settings());
        assert_eq!(made.report.interpolation, "grey");
        let (mean, absolute, wrong) = errors(name, solid, &made.stack, made.report.bottom_mm, 0.2);
        println!("{name}: absolute {:.4} %, {wrong} wrong", 100.0 * absolute);
        println!("measured: ct.{name}.grey = {:.3}", 100.0 * mean);
        assert_eq!(wrong, 0, "{name}");
        assert!(mean.abs() < 0.001, "{name}: {mean}");
        let low = made.report.bottom_mm - bottom(solid);
        assert!(low.abs() < 0.1, "{name} begins {low} mm off");
    }
}

/// Hardly a voxel of the thin wall is all material, which makes its threshold hard to find.
#[test]
fn a_thin_wall_has_its_size_when_its_materials_are_given() {
    let materials = Threshold::Iso50(Some([AIR, METAL]));
    let mut phantom = Phantom::new(wall, [100, 100, 100], [0.2; 3]);
    let made = run(&mut phantom, &CtSettings { threshold: materials, ..settings() });
    let (mean, _, wrong) = errors("wall", wall, &made.stack, made.report.bottom_mm, 0.2);
    println!("wall, materials given: {:.4} %", 100.0 * mean);
    assert!(wrong == 0 && mean.abs() < 0.001, "{mean}");
}

#[test]
fn far_slices_are_bridged_by_matching_and_by_distance() {
    for (mode, key, limit) in
        [(Interpolation::Matched, "matched", 0.01), (Interpolation::Distance, "distance", 0.02)]
    {
        for (name, solid) in SOLIDS {
            let mut phantom = Phantom::new(solid, [100, 100, 25], [0.2, 0.2, 0.8]);
            let made = run(&mut phantom, &CtSettings { interpolation: mode, ..settings() });
            let (mean, absolute, wrong) = errors(name, solid, &made.stack, made.report.bottom_mm, 0.8);
            println!("{mode:?} {name}: absolute {:.4} %, {wrong} wrong", 100.0 * absolute);
            println!("measured: ct.{name}.{key} = {:.3}", 100.0 * mean);
            assert!((made.report.bottom_mm - bottom(solid)).abs() < 0.4, "{name}: {}", made.report.bottom_mm);
            assert!(wrong == 0, "{mode:?} {name}: {wrong}");
            assert!(mean.abs() < limit, "{mode:?} {name}: {mean}");
        }
    }
}

#[test]
fn a_slope_of_45_degrees_has_no_stairs() {
    for (slice_mm, n, mode) in [(0.2, 60, "grey"), (0.8, 15, "matched")] {
        let mut phantom = Phantom::new(cone, [100, 100, n], [0.2, 0.2, slice_mm]);
        let made = run(&mut phantom, &settings());
        assert_eq!(made.report.interpolation, mode);
        let radii: Vec<f64> = made
            .stack
            .layers()
            .iter()
            .map(|l| (l.region().area_mm2() / std::f64::consts::PI).sqrt())
            .collect();
        let inner = &radii[4..radii.len() - 4];
        let jump = inner.windows(2).map(|w| (w[0] - w[1]).abs()).fold(0.0, f64::max);
        println!("measured: ct.slope.{mode}-mm = {jump:.4}");
        assert!(jump < 0.225, "{mode}: {jump}: more than half a bead");
    }
}

#[test]
fn the_same_layers_for_any_number_of_threads() {
    let make = |threads: usize, mode: Interpolation| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut phantom = Phantom::new(branch, [100, 100, 25], [0.2, 0.2, 0.8]);
            run(&mut phantom, &CtSettings { interpolation: mode, ..settings() }).stack
        })
    };
    for mode in [Interpolation::Grey, Interpolation::Matched] {
        let one = make(1, mode);
        assert!(make(2, mode) == one && make(5, mode) == one, "{mode:?}");
    }
}

#[test]
fn windows_crops_and_flips_take_what_they_say() {
    let whole = run(&mut Phantom::new(cone, [100, 100, 60], [0.2; 3]), &settings());
    let cropped = CtSettings { crop_px: Some([0, 0, 49, 99]), window: Some([0, 30]), ..settings() };
    let part = run(&mut Phantom::new(cone, [100, 100, 60], [0.2; 3]), &cropped);
    let area = |s: &CtStack, i: usize| s.stack.layers()[i].region().area_mm2();
    assert!((area(&part, 10) / area(&whole, 10) - 0.5).abs() < 0.01);
    assert!(part.stack.layers().len() < whole.stack.layers().len());
    // Upside down, the tip of the cone is below.
    let flipped = CtSettings { flip: [false, false, true], ..settings() };
    let turned = run(&mut Phantom::new(cone, [100, 100, 60], [0.2; 3]), &flipped);
    let n = turned.stack.layers().len();
    assert!(n.abs_diff(whole.stack.layers().len()) <= 1);
    assert!(
        (area(&turned, n - 5) / area(&whole, 4) - 1.0).abs() < 0.05
            && area(&turned, 4) < area(&turned, n - 5)
    );
}

#[test]
fn thresholds_that_make_no_sense_say_so() {
    let fails = |s: CtSettings| {
        let mut phantom = Phantom::new(sphere, [50, 50, 20], [0.4, 0.4, 1.0]);
        slice_scan(&mut phantom, &s, &Diagnostics::default()).expect_err("no layers").to_string()
    };
    assert!(
        fails(CtSettings { threshold: Threshold::Value(60000.0), ..settings() })
            .contains("leaves no material")
    );
    assert!(
        fails(CtSettings { threshold: Threshold::Value(0.0), ..settings() }).contains("every voxel material")
    );
    assert!(
        fails(CtSettings { window: Some([3, 20]), ..settings() })
            .contains("should be the first and last of 20")
    );
    assert!(fails(CtSettings { crop_px: Some([0, 0, 50, 9]), ..settings() }).contains("crop_px"));
    assert!(fails(CtSettings { min_island_mm2: 1e4, ..settings() }).contains("min_island_mm2"));
    let mut unknown = Phantom::new(sphere, [50, 50, 20], [0.4, 0.4, 1.0]);
    unknown.info.spacing_mm[2] = None;
    let error = slice_scan(&mut unknown, &settings(), &Diagnostics::default()).expect_err("no spacing");
    assert!(error.to_string().contains("no distance of slices; set shape.ct.slice_mm"));
    unknown.info.spacing_mm = [None; 3];
    let error = slice_scan(&mut unknown, &settings(), &Diagnostics::default()).expect_err("no spacing");
    let both = "no size of pixels and no distance of slices; set shape.ct.pixel_mm and shape.ct.slice_mm";
    assert!(error.to_string().contains(both), "{error}");
}

#[test]
fn canny_follows_the_paper_to_its_accuracy() {
    for (name, solid) in SOLIDS {
        let mut phantom = Phantom::new(solid, [100, 100, 100], [0.2; 3]);
        let made = run(&mut phantom, &CtSettings { tracing: Tracing::Canny, ..settings() });
        let (mean, absolute, wrong) = errors(name, solid, &made.stack, made.report.bottom_mm, 0.2);
        println!("canny {name}: absolute {:.4} %", 100.0 * absolute);
        println!("measured: ct.{name}.canny = {:.3}", 100.0 * mean);
        assert_eq!(wrong, 0, "{name}");
        assert!(mean.abs() < 0.002, "{name}: {mean}");
        // Caps and floors have no edges: they stand where the threshold puts them.
        let low = made.report.bottom_mm - bottom(solid);
        assert!(low.abs() < 0.1, "{name} begins {low} mm off");
        let mut phantom = Phantom::new(solid, [100, 100, 100], [0.2; 3]);
        let grey = run(&mut phantom, &settings());
        // The outermost section may be thinner than the filter is wide: a layer more or less.
        let (found, there) = (made.stack.layers().len(), grey.stack.layers().len());
        assert!(found.abs_diff(there) <= 1, "{name}: {found} of {there} layers");
    }
    let mut phantom = Phantom::new(torus, [100, 100, 10], [0.2, 0.2, 0.8]);
    let made = run(&mut phantom, &CtSettings { tracing: Tracing::Canny, ..settings() });
    let (mean, absolute, wrong) = errors("torus", torus, &made.stack, made.report.bottom_mm, 0.8);
    println!("canny, slices 0.8 mm apart: absolute {:.4} %", 100.0 * absolute);
    println!("measured: ct.torus.canny-far-slices = {:.3}", 100.0 * mean);
    assert_eq!(wrong, 0);
    assert!(mean.abs() < 0.01, "{mean}");
}

/// A stack of one slice: as flat as scans get.
#[test]
fn a_height_that_is_no_whole_layers_is_told() {
    let print = |slice_mm: f64| {
        let disc = |p: [f64; 3]| 8.0 - length([p[0], p[1], 0.0], [10.0, 10.0, 0.0]);
        let mut phantom = Phantom::new(disc, [100, 100, 1], [0.2, 0.2, slice_mm]);
        let diagnostics = Diagnostics::default();
        let made = slice_scan(&mut phantom, &settings(), &diagnostics).expect("layers");
        let heights: Vec<f64> = made.stack.layers().iter().map(Layer::height_mm).collect();
        (heights, diagnostics.warnings().iter().any(|w| w.id == WarningId::ScanHeightRounded))
    };
    assert_eq!(print(0.3), (vec![0.3], false), "one layer is as thick as the slice");
    assert_eq!(print(0.2), (vec![0.2], false));
    assert_eq!(print(0.4), (vec![0.2; 2], false));
    assert!(print(0.5).1, "0.5 mm are no whole layers");
}

#[test]
fn a_turned_scan_stands_on_its_side() {
    let mut phantom = Phantom::new(cone, [100, 100, 60], [0.2; 3]);
    let upright = run(&mut phantom, &settings());
    let on_its_side = CtSettings { rotate_rad: [std::f64::consts::FRAC_PI_2, 0.0, 0.0], ..settings() };
    let mut phantom = Phantom::new(cone, [100, 100, 60], [0.2; 3]);
    let turned = run(&mut phantom, &on_its_side);
    let [x, y, z] = upright.report.size_mm;
    let [u, v, w] = turned.report.size_mm;
    let near = |a: f64, b: f64| (a - b).abs() < 0.35;
    assert!(
        near(u, x) && near(v, z) && near(w, y),
        "{:?} {:?}",
        upright.report.size_mm,
        turned.report.size_mm
    );
    let volume =
        |s: &CtStack| s.stack.layers().iter().map(|l| l.region().area_mm2() * l.height_mm()).sum::<f64>();
    assert!(
        (volume(&turned) / volume(&upright) - 1.0).abs() < 0.02,
        "{} {}",
        volume(&turned),
        volume(&upright)
    );
}

/// A phantom whose values are changed as they are read; the function also gets the place of the voxel in its slice and the
/// number of the slice. NaN stands for no value, and comes as 0 where finite values are asked for.
struct Changed(Phantom, fn(f32, usize, usize) -> f32, u64);

impl SliceSource for Changed {
    fn info(&self) -> &VolumeInfo {
        &self.0.info
    }
    fn restart(&mut self) -> Result<(), SliceError> {
        self.2 = 0;
        self.0.restart()
    }
    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        let more = self.next_known(out)?;
        out.iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = 0.0);
        Ok(more)
    }
    fn next_known(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        let k = self.0.next;
        let more = self.0.next_slice(out)?;
        out.iter_mut().enumerate().for_each(|(p, v)| *v = (self.1)(*v, p, k));
        self.2 += out.iter().filter(|v| v.is_nan()).count() as u64;
        Ok(more)
    }
    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        self.0.skip_slice()
    }
    fn n_not_finite(&self) -> u64 {
        self.2
    }
}

#[test]
fn values_that_cannot_be_a_scan_stop_early() {
    let refusal = |change: fn(f32, usize, usize) -> f32, settings: CtSettings| {
        let phantom = Phantom::new(sphere, [100, 100, 40], [0.2; 3]);
        let made = slice_scan(&mut Changed(phantom, change, 0), &settings, &Diagnostics::default());
        made.expect_err("no scan").to_string()
    };
    let swapped = |v: f32, _, _| f32::from((v as u16).swap_bytes());
    for threshold in [Threshold::Otsu, Threshold::Value(11000.0)] {
        let told = refusal(swapped, CtSettings { threshold, ..settings() });
        assert!(told.contains("wrong order") && told.contains("shape.ct.byte_order"), "{told}");
    }
    assert!(refusal(|_, _, _| f32::NAN, settings()).contains("NaN, infinite or padding"));
    assert!(refusal(|_, _, _| 5.0, settings()).contains("every voxel has the grey value 5"));
}

/// A detector's numbers of 16 bits on an offset, in integers of 32.
#[test]
fn grey_values_that_float32_rounds_are_told() {
    let told = |sample: SampleType, change: fn(f32, usize, usize) -> f32| {
        let mut phantom = Phantom::new(sphere, [100, 100, 40], [0.2; 3]);
        phantom.info.sample = sample;
        let diagnostics = Diagnostics::default();
        slice_scan(&mut Changed(phantom, change, 0), &settings(), &diagnostics).expect("layers");
        diagnostics.warnings().into_iter().find(|w| w.id == WarningId::ScanValuesRounded).map(|w| w.text)
    };
    let far: fn(f32, usize, usize) -> f32 = |v, _, _| v + 2_147_483_648.0;
    let text = told(SampleType::U32, far).expect("a warning");
    assert!(text.contains("where float32 has 8") && text.ends_with(" steps between them"), "{text}");
    assert!(told(SampleType::F64, far).is_some());
    // A step of float32 at 2^31 is 256; the threshold lies between the two values.
    let two: fn(f32, usize, usize) -> f32 = |v, _, _| 2_147_483_648.0 + if v > 11000.0 { 256.0 } else { 0.0 };
    let text = told(SampleType::U32, two).expect("a warning");
    assert!(text.ends_with("where float32 has 1 step between them"), "{text}");
    assert_eq!(told(SampleType::U32, |v, _, _| v), None);
    assert_eq!(told(SampleType::U32, |v, _, _| v + 4_194_304.0), None, "half steps are left");
    assert_eq!(told(SampleType::F32, far), None, "the file itself holds no more");
}

#[test]
fn voxels_without_a_value_move_no_threshold() {
    // A round field of view is padded. A turned stack does not fill the box around it.
    let round: fn(f32, usize, usize) -> f32 = |v, p, _| {
        let (x, y) = ((p % 100) as f64 - 49.5, (p / 100) as f64 - 49.5);
        if x * x + y * y > 48.0 * 48.0 { f32::NAN } else { v }
    };
    let whole: fn(f32, usize, usize) -> f32 = |v, _, _| v;
    for threshold in [Threshold::Otsu, Threshold::Iso50(None)] {
        let made = |change: fn(f32, usize, usize) -> f32, rotate_deg: [f64; 3]| {
            let mut phantom = Phantom::new(sphere, [100, 100, 40], [0.2; 3]);
            // Air lies far enough above 0 that its noise is not cut.
            phantom.noise = 300.0;
            phantom.info.padded = true;
            let rotate_rad = rotate_deg.map(f64::to_radians);
            let (wanted, diagnostics) =
                (CtSettings { threshold, rotate_rad, ..settings() }, Diagnostics::default());
            let made = slice_scan(&mut Changed(phantom, change, 0), &wanted, &diagnostics).expect("layers");
            let told = diagnostics.warnings().iter().any(|w| w.text.contains("are padding"));
            (made.report.threshold[0], told)
        };
        let plain = made(whole, [0.0; 3]);
        assert!(!plain.1);
        for rotate_deg in [[0.0; 3], [90.0, 0.0, 0.0], [0.0, 90.0, 0.0], [20.0, 30.0, 37.0]] {
            for (change, is_padded) in [(round, true), (whole, false)] {
                let found = made(change, rotate_deg);
                println!("{threshold:?}, turned by {rotate_deg:?}, padded {is_padded}: {plain:?} {found:?}");
                let off = (found.0 - plain.0).abs() / (METAL - AIR);
                assert!(off < 0.005, "{threshold:?}, {rotate_deg:?}, padded {is_padded}: {off}");
                assert_eq!(found.1, is_padded, "{threshold:?}, {rotate_deg:?}");
            }
        }
    }
}

/// The first slices have no value at all. The values begin below 0, so that 0 would be material.
#[test]
fn slices_without_a_value_are_air_in_every_part() {
    let scan = || {
        let lower: fn(f32, usize, usize) -> f32 = |v, _, k| if k < 5 { f32::NAN } else { v - 16000.0 };
        Changed(Phantom::new(sphere, [60, 60, 40], [0.34; 3]), lower, 0)
    };
    for threshold in [Threshold::Iso50(None), Threshold::Value(-5000.0)] {
        let settings = CtSettings { threshold, ..settings() };
        let diagnostics = Diagnostics::default();
        let whole = slice_scan(&mut scan(), &settings, &diagnostics).expect("a whole scan");
        assert!((whole.report.bottom_mm - 2.0).abs() < 0.2, "{}", whole.report.bottom_mm);
        let cut = PartedScan::new(scan().info(), &settings).expect("a sound header");
        let survey = cut.survey(&mut scan(), &diagnostics).expect("a scan");
        let part =
            |slices: Range<usize>| cut.cut(&mut scan(), &survey, slices, &diagnostics).expect("a part");
        let joined = cut.join(&survey, vec![part(0..3), part(3..20), part(20..40)], &diagnostics);
        assert_eq!(joined.expect("a whole scan"), whole);
    }
}

/// A scan that is cut in parts, which travel as bytes and arrive in any order, has the layers and the report of the whole.
#[test]
fn parts_join_to_the_whole() {
    for (interpolation, tracing, flip) in [
        (Interpolation::Grey, Tracing::Iso, false),
        (Interpolation::Matched, Tracing::Iso, true),
        (Interpolation::Matched, Tracing::Canny, false),
        (Interpolation::Distance, Tracing::Iso, false),
    ] {
        let settings = CtSettings {
            interpolation,
            tracing,
            flip: [false, false, flip],
            window: Some([2, 38]),
            min_piece_mm3: 1.0,
            ..settings()
        };
        let phantom = || Phantom::new(sphere, [60, 60, 40], [0.34; 3]);
        let diagnostics = Diagnostics::default();
        let whole = slice_scan(&mut phantom(), &settings, &diagnostics).expect("a whole scan");
        let scan = PartedScan::new(phantom().info(), &settings).expect("a sound header");
        assert_eq!(scan.slices(), 2..39);
        let survey = scan.survey(&mut phantom(), &diagnostics).expect("a scan");
        let part = |slices: Range<usize>| {
            let part = scan.cut(&mut phantom(), &survey, slices, &diagnostics).expect("a part");
            ScanPart::from_bytes(&part.to_bytes()).expect("our own bytes")
        };
        let parts = vec![part(20..37), part(0..1), part(1..13), part(13..20)];
        let joined = scan.join(&survey, parts.clone(), &diagnostics).expect("a whole scan");
        assert_eq!(joined, whole, "{interpolation:?} {tracing:?}");
        assert!(joined.stack.layers().len() > 40);
        let error = scan.join(&survey, parts[1..].to_vec(), &diagnostics).expect_err("slices are missing");
        assert!(matches!(error, ScanError::MissingPart { slice: 20 }), "{error}");
    }
    let turned = CtSettings { rotate_rad: [0.1, 0.0, 0.0], ..settings() };
    let info = Phantom::new(sphere, [60, 60, 40], [0.34; 3]).info;
    assert!(matches!(PartedScan::new(&info, &turned), Err(ScanError::TurnedInParts)));
}

/// Bytes that are cut or changed are refused, or give a part.
#[test]
fn damaged_parts_are_refused_or_read() {
    let mut phantom = Phantom::new(sphere, [60, 60, 40], [0.34; 3]);
    let scan = PartedScan::new(&phantom.info, &settings()).expect("a sound header");
    let diagnostics = Diagnostics::default();
    let survey = scan.survey(&mut phantom, &diagnostics).expect("a scan");
    let bytes = scan.cut(&mut phantom, &survey, 19..21, &diagnostics).expect("a part").to_bytes();
    assert!(bytes.len() > 200);
    for at in 0..bytes.len() {
        assert!(ScanPart::from_bytes(&bytes[..at]).is_err(), "cut at {at}");
        let mut changed = bytes.clone();
        changed[at] ^= 0x81;
        if let Ok(part) = ScanPart::from_bytes(&changed) {
            let _ = scan.join(&survey, vec![part], &diagnostics);
        }
    }
}
