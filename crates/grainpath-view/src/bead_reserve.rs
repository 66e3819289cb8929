//! The reserve of each bead: the factor on the loads at which it first fails, as numbers and as a picture of a layer.
//!
//! Values come from a [`ReserveMap`]. Beads of skirts, brims and supports have none, and neither have beads near fixtures and
//! loads. The bead that holds the weakest ply of the map always has its value, so the least of all beads is the reserve that
//! the report states.

use grainpath_core::math::ln;
use grainpath_core::{Bounds2, DVec2, Role, segment};
use grainpath_fea::strength::reserve_map::{LaidPiece, ReserveMap};
use grainpath_gcode::{Bead, BeadLayer, Program};
use rayon::prelude::*;

use crate::layer::{Canvas, Ramp, UNASKED};

/// The factor at which the scale of a picture ends, over the least one. Source: chosen; what carries ten times as much is
/// not what breaks.
pub const SCALE: f64 = 10.0;
/// Length of the pieces of a bead that get a colour of their own, mm. Source: chosen by eye; a bead is about as wide.
const PIECE_MM: f64 = 0.5;

/// Radius of the ring about the weakest place, as a share of the longer side of the picture, unless beads are wider.
/// Source: chosen by eye.
const RING_SHARE: f64 = 0.02;

/// The reserves of the beads of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct BeadReserves {
    /// The factor on the loads at first failure of each bead of each layer; infinite for beads without a value.
    pub of_beads: Vec<Vec<f32>>,
    /// The least of them.
    pub least: f32,
    /// Index of the lowest layer that holds it.
    pub layer: usize,
}

/// A bead, or a part of it, as the map knows it.
fn piece(layer: &BeadLayer, bead: &Bead, ends: [DVec2; 2]) -> LaidPiece {
    let [bottom, top] = bead.raise_mm.map(f64::from);
    LaidPiece {
        a: ends[0],
        b: ends[1],
        width_mm: bead.width_mm(layer.height_mm),
        z_mm: [layer.z_mm - layer.height_mm + bottom, layer.z_mm + top],
        material: u8::from(bead.role == Role::Fibre),
    }
}

impl BeadReserves {
    /// The reserves of a program's beads; `None` if the map holds no value. Cost: linear in the cells under all beads.
    pub fn new(map: &ReserveMap, program: &Program) -> Option<Self> {
        let weakest = map.weakest()?;
        let of_layer = |layer: &BeadLayer| -> Vec<f32> {
            let index = |bead: &Bead| {
                let is_part = bead.role.is_part();
                if is_part { map.index(&piece(layer, bead, [bead.start(), bead.end()])) } else { 0.0 }
            };
            layer.beads.iter().map(index).collect()
        };
        // Skirts, brims and supports lie outside the part and its cells.
        let mut indices: Vec<Vec<f32>> = program.layers.par_iter().map(of_layer).collect();
        let holds = |beads: &Vec<f32>| beads.iter().any(|index| *index >= weakest.index);
        let mut layer = indices.iter().position(holds);
        if layer.is_none() {
            // Cells get the material that does not fit into their neighbours, so the weakest ply may lie beside its bead.
            let beads = program.layers.iter().enumerate().flat_map(|(k, layer)| {
                let part = layer.beads.iter().enumerate().filter(|(_, bead)| bead.role.is_part());
                part.map(move |(i, bead)| (k, i, piece(layer, bead, [bead.start(), bead.end()])))
            });
            // Only beads at the height of the cell can hold it.
            let above = |p: &LaidPiece| p.z_mm[1] > weakest.z_mm[0] && p.z_mm[0] < weakest.z_mm[1];
            let off = |p: &LaidPiece| segment::distance_squared_mm2(weakest.at_mm, p.a, p.b);
            let near = beads.filter(|(_, _, p)| above(p));
            let (k, i, _) = near.min_by(|(_, _, p), (_, _, q)| off(p).total_cmp(&off(q)))?;
            indices[k][i] = weakest.index;
            layer = Some(k);
        }
        // An index of 0 becomes a factor without end: no load breaks what is not judged.
        indices.iter_mut().flatten().for_each(|index| *index = 1.0 / *index);
        Some(Self { of_beads: indices, least: 1.0 / weakest.index, layer: layer? })
    }
}

/// A picture of the beads of a layer, each coloured along its length: red at the least reserve of the part, blue from
/// [`SCALE`] times that on, in equal steps for equal ratios; grey where there is no value. A ring marks the weakest place of
/// the part, with the factor beside it.
pub fn reserve_png(map: &ReserveMap, layer: &BeadLayer, least: f64, size_px: u32) -> Vec<u8> {
    let beads: Vec<&Bead> = layer.beads.iter().filter(|b| b.role.is_part()).collect();
    let around = |b: &&Bead| {
        let ends = Bounds2 { min: b.start().min(b.end()), max: b.start().max(b.end()) };
        ends.grown(0.5 * b.width_mm(layer.height_mm))
    };
    let bounds = beads.iter().map(around).reduce(Bounds2::union);
    let bounds = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE });
    let mut canvas = Canvas::over(bounds, size_px);
    // Nearness to failing, on a scale of ratios, so that the least reserve is red.
    let ramp = Ramp { low: -ln(SCALE * least), high: -ln(least) };
    let widths = |bead: &Bead| {
        let wide = canvas.pixels_of(bead.width_mm(layer.height_mm));
        // A rim shows where beads touch; on a bead of few pixels it is a tenth of its width.
        (wide, (wide - 2.0).max(0.8 * wide))
    };
    let widths: Vec<(f32, f32)> = beads.iter().map(|b| widths(b)).collect();
    // All rims lie below all colours. Pieces of one bead would otherwise show a rim at each joint.
    for (bead, (wide, _)) in beads.iter().zip(&widths) {
        canvas.line(&[bead.start(), bead.end()], *wide, [14, 15, 17], 255);
    }
    for (bead, (_, wide)) in beads.iter().zip(&widths) {
        let (a, b) = (bead.start(), bead.end());
        let n = (a.distance(b) / PIECE_MM).ceil().clamp(1.0, 1e5) as usize;
        let at = |k: usize| a.lerp(b, k as f64 / n as f64);
        let colour = |k: usize| {
            let index = map.index(&piece(layer, bead, [at(k), at(k + 1)]));
            if index > 0.0 { ramp.colour(ln(f64::from(index))) } else { UNASKED }
        };
        let colours: Vec<[u8; 3]> = (0..n).map(colour).collect();
        // Pieces of one colour are one stroke.
        let mut from = 0;
        for run in colours.chunk_by(|p, q| p == q) {
            let to = from + run.len();
            canvas.line(&[at(from), at(to)], *wide, run[0], 255);
            from = to;
        }
    }
    if let Some(weakest) = map.weakest() {
        // The bead stays in sight inside the ring, which is large enough to be seen on a picture of thousands of beads.
        let wide = widths.iter().fold(0.0, |most: f32, (wide, _)| most.max(*wide));
        let radius = f64::from(1.5 * wide).max(RING_SHARE * f64::from(size_px));
        canvas.ring(weakest.at_mm, radius, &factor(least));
    }
    canvas.png()
}

/// A factor on the loads with three digits.
fn factor(times: f64) -> String {
    let places = if times < 10.0 { 2 } else { usize::from(times < 100.0) };
    format!("{times:.places$}x")
}

#[cfg(test)]
mod tests {
    use grainpath_core::DVec3;
    use grainpath_fea::strength::grid_turn::Frame;
    use grainpath_fea::strength::laminate::{BeadPiece, BeadSheet, Laminate};
    use grainpath_gcode::{Limits, simulate};

    use super::*;

    /// Two beads of 20 mm side by side and a skirt; the index grows from 0.1 at the left end to 0.5 at the right one.
    fn bar() -> (Program, ReserveMap) {
        let text = "M83\n;LAYER_CHANGE\nG1 Z0.2\n;TYPE:Skirt\nG1 X0 Y-5 F6000\nG1 X20 E0.67 F1200\n;TYPE:Solid infill\nG1 X0 Y0.2 F6000\n\
                    G1 X20 E0.67 F1200\nG1 X0 Y0.6 F6000\nG1 X20 E0.67 F1200\n";
        let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
        let bead = |y: f64| BeadPiece {
            a: DVec2::new(0.0, y),
            b: DVec2::new(20.0, y),
            volume_mm3: 1.6,
            material: 0,
        };
        let sheets = [BeadSheet { height_mm: 0.2, beads: vec![bead(0.2), bead(0.6)] }];
        let laminate = Laminate::from_layers(&sheets, 0.4).expect("cells");
        let mut map = ReserveMap::of_plate(&laminate, 0.0, Frame::default(), DVec3::ZERO);
        let cells = 0..laminate.starts.len() - 1;
        let of_cell = |cell: usize| {
            let n = laminate.starts[cell + 1] - laminate.starts[cell];
            std::iter::repeat_n(0.1 + 0.02 * laminate.grid.centre(cell).x as f32, n as usize)
        };
        map.add_case(&cells.flat_map(of_cell).collect::<Vec<_>>());
        (program, map)
    }

    #[test]
    fn the_least_of_all_beads_is_that_of_the_map() {
        let (program, map) = bar();
        let reserves = BeadReserves::new(&map, &program).expect("values");
        let weakest = map.weakest().expect("a place");
        assert_eq!((reserves.least, reserves.layer), (1.0 / weakest.index, 0));
        let [skirt, first, second] = &reserves.of_beads[0][..] else { panic!("three beads") };
        assert_eq!((*skirt, *first, *second), (f32::INFINITY, reserves.least, reserves.least));
        // A map whose weakest place no bead covers: the nearest bead holds it.
        let away = simulate(
            b"M83\n;LAYER_CHANGE\nG1 Z0.2\n;TYPE:Solid infill\nG1 X0 Y0.2 F6000\nG1 X10 E0.33 F1200\n",
            1.75,
            &Limits::default(),
        );
        let reserves = BeadReserves::new(&map, &away.expect("G-code")).expect("values");
        assert_eq!(reserves.of_beads, [[1.0 / weakest.index]]);
        assert_eq!(BeadReserves::new(&map, &Program::default()), None);
    }

    fn decoded(png: Vec<u8>) -> (png::OutputInfo, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().expect("a PNG");
        let mut data = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut data).expect("a frame");
        (info, data)
    }

    /// Beads of 20 mm whose index is 0.5 at a place and falls with the distance from it.
    #[test]
    fn a_ring_and_the_factor_mark_the_weakest_place() {
        // Two squares with room on either side, and two upright bars with room above or below.
        for (n, is_upright, place, label) in [
            (50, false, DVec2::new(3.0, 11.0), DVec2::X),
            (50, false, DVec2::new(17.0, 9.0), DVec2::NEG_X),
            (5, true, DVec2::new(1.0, 17.0), DVec2::NEG_Y),
            (5, true, DVec2::new(1.0, 3.0), DVec2::Y),
        ] {
            let turned = |p: DVec2| if is_upright { DVec2::new(p.y, p.x) } else { p };
            let ends = |k: i32| [0.0, 20.0].map(|x| turned(DVec2::new(x, 0.2 + 0.4 * f64::from(k))));
            let mut text = "M83
;LAYER_CHANGE
G1 Z0.2
;TYPE:Solid infill
"
            .to_owned();
            for [a, b] in (0..n).map(ends) {
                text.push_str(&format!(
                    "G1 X{:.2} Y{:.2} F6000
G1 X{:.2} Y{:.2} E0.67 F1200
",
                    a.x, a.y, b.x, b.y
                ));
            }
            let program = simulate(text.as_bytes(), 1.75, &Limits::default()).expect("G-code");
            let beads = (0..n).map(ends).map(|[a, b]| BeadPiece { a, b, volume_mm3: 1.6, material: 0 });
            let sheets = [BeadSheet { height_mm: 0.2, beads: beads.collect() }];
            let laminate = Laminate::from_layers(&sheets, 0.4).expect("cells");
            let mut map = ReserveMap::of_plate(&laminate, 0.0, Frame::default(), DVec3::ZERO);
            let of_cell = |cell: usize| {
                let n = laminate.starts[cell + 1] - laminate.starts[cell];
                let off = laminate.grid.centre(cell).distance(place);
                std::iter::repeat_n((0.5 - 0.01 * off) as f32, n as usize)
            };
            map.add_case(&(0..laminate.starts.len() - 1).flat_map(of_cell).collect::<Vec<_>>());
            let weakest = map.weakest().expect("a place");
            assert!(weakest.at_mm.distance(place) < 0.4, "{weakest:?}");
            let (info, data) =
                decoded(reserve_png(&map, &program.layers[0], 1.0 / f64::from(weakest.index), 800));
            // Beads are 0.446 mm wide, and the window has a margin of two per cent and 0.2 mm.
            let low = turned(DVec2::new(-0.223, 0.2 - 0.223)) - 0.609;
            let scale = 800.0 / 21.664;
            let colour = |off_px: DVec2| {
                let at = (weakest.at_mm - low) * scale + off_px;
                let (column, row) = (at.x as usize, (f64::from(info.height) - at.y) as usize);
                let k = 4 * (row * info.width as usize + column);
                [data[k], data[k + 1], data[k + 2]]
            };
            let is_light = |c: [u8; 3]| c.into_iter().all(|v| v > 150);
            let radius = (1.5 * 0.446 * scale).max(RING_SHARE * 800.0);
            for k in 0..16 {
                let out = grainpath_core::math::direction(f64::from(k) * std::f64::consts::TAU / 16.0);
                assert!(is_light(colour(radius * out)), "{place} {k}: {:?}", colour(radius * out));
                // Its rims are dark on both sides, so that it is seen on light colours too.
                for rim in [radius - 3.0, radius + 3.0] {
                    assert!(
                        colour(rim * out).into_iter().all(|v| v < 120),
                        "{place} {k}: {:?}",
                        colour(rim * out)
                    );
                }
            }
            let [red, green, blue] = colour(DVec2::ZERO);
            assert!(red > 150 && green < 100 && blue < 100, "the bead is seen inside the ring");
            // The plate of the number lies beside the ring, on the side with the most room.
            let plate = radius + 7.0 + 1.0;
            for side in [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y] {
                assert_eq!(is_light(colour(plate * side)), side == label, "{place} {side}");
            }
        }
        assert_eq!([0.934, 2.0, 12.34, 416.2].map(factor), ["0.93x", "2.00x", "12.3x", "416x"]);
    }

    #[test]
    fn a_picture_shows_where_the_least_reserve_is() {
        let (program, map) = bar();
        let least = 1.0 / f64::from(map.weakest().expect("a place").index);
        let (info, data) = decoded(reserve_png(&map, &program.layers[0], least, 400));
        // The middle of the lower bead: beads are 0.446 mm wide, so the picture with its margin begins at x = -0.83 and is
        // 21.66 mm wide; its middle lies between both beads.
        let colour = |x: f64| {
            let column = ((x + 0.83) / 21.66 * f64::from(info.width)) as usize;
            let row = (0.5 * f64::from(info.height) + 0.2 / 21.66 * f64::from(info.width)) as usize;
            let at = 4 * (row * info.width as usize + column);
            [data[at], data[at + 1], data[at + 2]]
        };
        let ramp = Ramp { low: -ln(SCALE * least), high: -ln(least) };
        for x in [1.0, 10.0, 16.0] {
            let wanted = ramp.colour(ln(0.1 + 0.02 * x));
            let (found, far) = (colour(x), |(p, q): (u8, u8)| p.abs_diff(q) > 25);
            assert!(!found.into_iter().zip(wanted).any(far), "{x}: {found:?} {wanted:?}");
        }
        assert!(colour(16.0)[0] > 150 && colour(1.0)[0] < 100, "red where it fails first");
    }
}
