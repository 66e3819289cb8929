//! How near each bead of a part is to failing: the failure indices of all plies of its cells, and the beads that lie in them.
//!
//! The first failure ([`super::first_failure`]) is the highest index of a part. This map keeps the others too, the highest of
//! all load cases for each ply. A bead is as near to failing as the worst ply that it passes: in each cell that it covers,
//! that ply whose direction is nearest to its own. The factor on the loads at which a bead fails is one over that index.
//!
//! Limits: cells know no single beads. Beads that lie in one cell in about the same direction share a value. A cell of a
//! [`Laminate`] reaches through all layers, so beads of one direction above each other have the same value in a plate. A cell
//! of [`Bricks`] may hold several thin layers; it has at most two directions, and others are added to these. Plies that were
//! not judged, near fixtures and loads, have no value.
//!
//! Lengths are in mm. Memory: 6 bytes a ply and 4 bytes a cell. Cost of a bead: four looks for each cell that it covers.

use grainpath_core::math::{atan2, direction};
use grainpath_core::{DVec2, DVec3};

use super::bricks::Bricks;
use super::grid_turn::Frame;
use super::laminate::Laminate;

/// The failure indices of the plies of a part, for all load cases together.
#[derive(Debug, Clone, PartialEq)]
pub struct ReserveMap {
    frame: Frame,
    program_from_part_mm: DVec3,
    /// Cells along each axis of the grid; a plate has one above another.
    n: [usize; 3],
    /// Lowest corner of the grid.
    low: DVec3,
    cell_mm: DVec3,
    /// The plies of a cell are those from `starts[cell]` to `starts[cell + 1]`.
    starts: Vec<u32>,
    /// Direction of each ply in [`TURNS`] of half a turn.
    turns: Vec<u8>,
    materials: Vec<u8>,
    /// Highest failure index of each ply under the loads as they are; 0 for plies that were not judged.
    indices: Vec<f32>,
}

/// Steps of a direction in half a turn. Source: the values of one byte; a step is 0.7 degrees, and the plies of a cell lie
/// 22.5 degrees apart.
const TURNS: f64 = 256.0;

fn turn(angle_rad: f64) -> u8 {
    (angle_rad / std::f64::consts::PI * TURNS).round().rem_euclid(TURNS) as u8
}

/// A straight piece of a bead in the coordinates of its program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaidPiece {
    /// One end, mm.
    pub a: DVec2,
    /// The other end, mm.
    pub b: DVec2,
    /// Its width, mm.
    pub width_mm: f64,
    /// The heights of its lower and its upper side, mm.
    pub z_mm: [f64; 2],
    /// Its material: the number of its card.
    pub material: u8,
}

/// The place of the highest failure index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeakestPlace {
    /// The failure index there.
    pub index: f32,
    /// Middle of its cell in the coordinates of the program, mm.
    pub at_mm: DVec2,
    /// The heights between which the cell lies, mm.
    pub z_mm: [f64; 2],
}

impl ReserveMap {
    /// The map of a plate whose lowest layer begins at `floor_mm`, without any load. `frame` leads from its grid to the part,
    /// `program_from_part_mm` from there to the program.
    pub fn of_plate(laminate: &Laminate, floor_mm: f64, frame: Frame, program_from_part_mm: DVec3) -> Self {
        let grid = laminate.grid;
        Self {
            frame,
            program_from_part_mm,
            n: [grid.nx, grid.ny, 1],
            low: grid.low.extend(floor_mm),
            cell_mm: DVec2::splat(grid.cell_mm).extend(laminate.height_mm),
            starts: laminate.starts.clone(),
            turns: laminate.plies.iter().map(|p| turn(p.angle_rad)).collect(),
            materials: laminate.plies.iter().map(|p| p.material).collect(),
            indices: vec![0.0; laminate.plies.len()],
        }
    }

    /// The map of a solid, as [`ReserveMap::of_plate`].
    pub fn of_bricks(bricks: &Bricks, frame: Frame, program_from_part_mm: DVec3) -> Self {
        Self {
            frame,
            program_from_part_mm,
            n: bricks.n,
            low: bricks.origin,
            cell_mm: bricks.cell_mm,
            starts: bricks.starts.clone(),
            turns: bricks.plies.iter().map(|p| turn(p.angle_rad)).collect(),
            materials: vec![0; bricks.plies.len()],
            indices: vec![0.0; bricks.plies.len()],
        }
    }

    /// Adds a load case by the failure indices of all plies, in the order of the cells.
    pub fn add_case(&mut self, of_plies: &[f32]) {
        for (own, index) in self.indices.iter_mut().zip(of_plies) {
            *own = own.max(*index);
        }
    }

    /// The place with the highest index, of equal ones the lowest in the order of the cells; `None` if nothing was judged.
    pub fn weakest(&self) -> Option<WeakestPlace> {
        // A strict comparison keeps the first of equal plies, which lies in the lowest layer.
        let higher =
            |best: usize, ply: usize| if self.indices[ply] > self.indices[best] { ply } else { best };
        let ply = (0..self.indices.len()).reduce(higher).filter(|ply| self.indices[*ply] > 0.0)?;
        let cell = self.starts.partition_point(|start| *start as usize <= ply) - 1;
        let [nx, ny, _] = self.n;
        let at = DVec3::new((cell % nx) as f64, (cell / nx % ny) as f64, (cell / (nx * ny)) as f64);
        let low = self.low + self.cell_mm * at;
        let middle = self.frame.to_part_3d(low + 0.5 * self.cell_mm) + self.program_from_part_mm;
        let z_mm = [low.z, low.z + self.cell_mm.z].map(|z| z + self.program_from_part_mm.z);
        Some(WeakestPlace { index: self.indices[ply], at_mm: middle.truncate(), z_mm })
    }

    /// The highest failure index along a piece of a bead; 0 where nothing was judged.
    pub fn index(&self, piece: &LaidPiece) -> f32 {
        let shift = self.program_from_part_mm;
        // Cells lie in the frame of the grid, which is turned with the part and begins at its lowest corner.
        let [a, b] = [piece.a, piece.b].map(|p| self.frame.to_grid(p - shift.truncate()));
        let along = b - a;
        let angle_rad = atan2(along.y, along.x);
        let across = direction(angle_rad).perp() * piece.width_mm;
        // Two looks a cell in both directions miss no cell that the bead covers by half.
        let looks = |mm: f64| (2.0 * mm / self.cell_mm.x).ceil().clamp(1.0, 1e6) as usize;
        let (n_along, n_across) = (looks(along.length()), looks(piece.width_mm));
        // Rounded heights of a program may touch the next cell by less than a thousandth of a cell.
        let level = |z: f64| (z - shift.z - self.low.z) / self.cell_mm.z;
        let [bottom, top] = [level(piece.z_mm[0]) + 1e-3, level(piece.z_mm[1]) - 1e-3];
        let highest = (self.n[2] - 1) as f64;
        let levels = bottom.floor().clamp(0.0, highest) as usize..=top.floor().clamp(0.0, highest) as usize;
        let own_turn = turn(angle_rad);
        let mut worst: f32 = 0.0;
        // Lines side by side within the bead, each looked along from end to end. A bead has no value of its own at its
        // middle line alone: cells are half as wide as beads in a plate.
        for j in 0..n_across {
            let side = a + across * ((j as f64 + 0.5) / n_across as f64 - 0.5);
            let mut before = None;
            for i in 0..n_along {
                let at = side + along * ((i as f64 + 0.5) / n_along as f64);
                let place = ((at - self.low.truncate()) / self.cell_mm.x).floor();
                let is_inside =
                    place.min_element() >= 0.0 && place.x < self.n[0] as f64 && place.y < self.n[1] as f64;
                if !is_inside || before.replace(place) == Some(place) {
                    continue;
                }
                for level in levels.clone() {
                    let cell = (level * self.n[1] + place.y as usize) * self.n[0] + place.x as usize;
                    worst = worst.max(self.nearest_ply(cell, own_turn, piece.material));
                }
            }
        }
        worst
    }

    /// The index of that ply of a cell whose direction is nearest; 0 in a cell without plies of the material.
    fn nearest_ply(&self, cell: usize, own_turn: u8, material: u8) -> f32 {
        let plies = self.starts[cell] as usize..self.starts[cell + 1] as usize;
        let off = |ply: &usize| {
            // Directions have no sign: the difference wraps around at half a turn, as the byte does.
            let d = self.turns[*ply].wrapping_sub(own_turn);
            d.min(d.wrapping_neg())
        };
        let nearest = plies.filter(|ply| self.materials[*ply] == material).min_by_key(off);
        nearest.map_or(0.0, |ply| self.indices[ply])
    }
}

#[cfg(test)]
mod tests {
    use super::super::laminate::{BeadPiece, BeadSheet};
    use super::*;

    /// A square of 8 mm in two layers of beads of 0.4 mm: the lower ones along x, the upper ones along y.
    fn crossed() -> Vec<BeadSheet> {
        let sheet = |along: DVec2| {
            let bead = |k: i32| {
                let a = along.perp() * (0.4 * f64::from(k) + 0.2) - along * 4.0;
                BeadPiece { a, b: a + along * 8.0, volume_mm3: 8.0 * 0.4 * 0.2, material: 0 }
            };
            BeadSheet { height_mm: 0.2, beads: (-10..10).map(bead).collect() }
        };
        vec![sheet(DVec2::X), sheet(DVec2::Y)]
    }

    fn piece(a: (f64, f64), b: (f64, f64), layer: f64) -> LaidPiece {
        let z_mm = [0.2 * layer + 5.0, 0.2 * layer + 5.2];
        LaidPiece { a: a.into(), b: b.into(), width_mm: 0.4, z_mm, material: 0 }
    }

    /// The map with an index of its own in each cell: 1 + x / 100 for plies along x, half of it for those along y.
    fn filled(mut map: ReserveMap, centre: &dyn Fn(usize) -> DVec2) -> ReserveMap {
        let mut of_plies = vec![0.0; map.indices.len()];
        for cell in 0..map.starts.len() - 1 {
            for ply in map.starts[cell] as usize..map.starts[cell + 1] as usize {
                let along_x = map.turns[ply] < 64 || map.turns[ply] > 192;
                of_plies[ply] = (1.0 + centre(cell).x as f32 / 100.0) * if along_x { 1.0 } else { 0.5 };
            }
        }
        map.add_case(&of_plies);
        // The least reserve of all cases counts, which is the highest index.
        // A weaker case changes nothing.
        map.add_case(&vec![0.1; of_plies.len()]);
        map
    }

    #[test]
    fn beads_have_the_index_of_the_plies_in_their_direction() {
        let shift = DVec3::new(50.0, 30.0, 5.0);
        let sheets = crossed();
        let laminate = Laminate::from_layers(&sheets, 0.4).expect("cells");
        let bricks = Bricks::from_layers(&sheets, 0.4, 0.0).expect("cells");
        let plate = ReserveMap::of_plate(&laminate, 0.0, Frame::default(), shift);
        let plate = filled(plate, &|cell| laminate.grid.centre(cell));
        let solid = ReserveMap::of_bricks(&bricks, Frame::default(), shift);
        let solid = filled(solid, &|cell| bricks.centre(cell).truncate());
        for map in [plate, solid] {
            // The far end of a bead along x has the highest index that it passes; the other way round it is the same bead.
            let along = piece((46.1, 30.2), (53.8, 30.2), 0.0);
            let back = LaidPiece { a: along.b, b: along.a, ..along };
            assert!((map.index(&along) - 1.038).abs() < 0.004, "{}", map.index(&along));
            assert_eq!(map.index(&along), map.index(&back));
            let short = piece((46.1, 30.2), (48.0, 30.2), 0.0);
            assert!((map.index(&short) - 0.98).abs() < 0.004, "{}", map.index(&short));
            let across = piece((50.2, 27.0), (50.2, 33.0), 1.0);
            assert!((map.index(&across) - 0.501).abs() < 0.004, "{}", map.index(&across));
            assert_eq!(map.index(&piece((80.0, 30.0), (90.0, 30.0), 0.0)), 0.0, "outside the part");
            let weakest = map.weakest().expect("a place");
            assert!((weakest.index - 1.038).abs() < 0.004 && weakest.at_mm.x > 53.5, "{weakest:?}");
            assert!(weakest.z_mm[0] >= 5.0 && weakest.z_mm[1] < 5.5, "{weakest:?}");
        }
    }

    #[test]
    fn a_turned_grid_finds_the_same_beads() {
        let turned = direction(0.5);
        let sheets: Vec<BeadSheet> = crossed()
            .into_iter()
            .map(|mut sheet| {
                let turn = |p: DVec2| turned * p.x + turned.perp() * p.y;
                sheet.beads.iter_mut().for_each(|b| (b.a, b.b) = (turn(b.a), turn(b.b)));
                sheet
            })
            .collect();
        // The grid is aligned with the turned square, so that its cells hold the same beads as those of the upright one.
        let frame = Frame::new(&sheets);
        let laminate = Laminate::from_layers(&frame.beads(sheets.clone()), 0.4).expect("cells");
        let mut map = ReserveMap::of_plate(&laminate, 0.0, frame, DVec3::ZERO);
        assert_eq!(map.weakest(), None);
        let n = map.indices.len();
        map.add_case(&vec![0.25; n]);
        for bead in sheets.iter().flat_map(|s| &s.beads) {
            let piece = LaidPiece { a: bead.a, b: bead.b, width_mm: 0.4, z_mm: [0.0, 0.2], material: 0 };
            assert_eq!(map.index(&piece), 0.25, "{bead:?}");
            assert_eq!(map.index(&LaidPiece { material: 1, ..piece }), 0.0, "another material");
        }
    }
}
