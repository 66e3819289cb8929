//! The interior of a stress result for drawing: tetrahedra for section views, and principal stress lines in space.

use std::cell::Cell;
use std::collections::BTreeSet;

use grainpath_core::math::pow;
use grainpath_core::streamlines::{LineSettings, trace_line};
use grainpath_core::tensor::{principal, von_mises};
use grainpath_core::{DVec3, IVec3};
use grainpath_io::fe::{FeFormat, FeResult, StressField};

use super::ResultMesh;

/// Number of seed points in the bounding box of a solid, then of a plate. Source: chosen by eye; only the picture
/// depends on it.
const SEEDS: [f64; 2] = [2000.0, 600.0];
/// A line ends where its stress falls below this share of the reference stress. The reference is the equivalent stress that
/// 99.5 % of the nodes stay below; the colour scale of the pictures ends at the same value. Source: chosen by eye; the
/// directions of smaller stresses are mostly error of the mesh.
const LEAST_SHARE: f64 = 0.04;
/// Share of the nodes whose stress is below the reference of [`LEAST_SHARE`]. Source: the scale of `stress.png`.
const COVERED: f64 = 0.995;
/// A line ends where its principal stress differs from the middle one by less than this share of the reference, because its
/// direction is arbitrary there. Source: derived; an error of 1 % in the stress then turns the axis by less than 45 degrees.
const DEGENERATE_SHARE: f64 = 0.01;

/// The solid of a result mesh, for drawing sections.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ResultVolume {
    /// Positions, mm, part coordinates.
    pub points: Vec<DVec3>,
    /// The node of the result that each point shows.
    pub nodes: Vec<u32>,
    /// Indices of points, in no particular order.
    pub tetrahedra: Vec<[u32; 4]>,
}

/// A principal stress line.
#[derive(Debug, Clone, PartialEq)]
pub struct StressLine {
    /// Its points, mm, part coordinates; the first is repeated at the end of a closed line.
    pub points: Vec<DVec3>,
    /// The principal stress along the line at each point, MPa, tension positive.
    pub values_mpa: Vec<f64>,
}

/// The tetrahedra that fill an element with this number of corners, as indices of its corners in VTK order.
fn tetrahedra(n_corners: usize) -> &'static [[usize; 4]] {
    match n_corners {
        4 => &[[0, 1, 2, 3]],
        5 => &[[0, 1, 2, 4], [0, 2, 3, 4]],
        6 => &[[0, 1, 2, 5], [0, 1, 5, 4], [0, 3, 4, 5]],
        8 => &[[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]],
        _ => &[],
    }
}

impl ResultMesh {
    /// The solid that the elements fill, without the nodes between their corners. The nodes of a plate lie at
    /// mid-height; its solid reaches from `bottom_mm` to the same distance above the nodes.
    pub fn volume(&self, bottom_mm: f64) -> ResultVolume {
        let is_solid = self.is_solid();
        let n = self.nodes.len() as u32;
        let all = 0..n;
        let mut volume = ResultVolume { nodes: all.clone().collect(), ..ResultVolume::default() };
        if is_solid {
            volume.points.clone_from(&self.nodes);
        } else {
            volume.points.extend(self.nodes.iter().map(|p| p.with_z(bottom_mm)));
            volume.points.extend(self.nodes.iter().map(|p| p.with_z(2.0 * p.z - bottom_mm)));
            volume.nodes.extend(all);
        }
        let dimension = if is_solid { 3 } else { 2 };
        for element in self.elements.iter().filter(|e| e.kind.dimension() == dimension) {
            let mut corners = element.corners().to_vec();
            if !is_solid {
                // A flat element and its copy at the top of the plate form a prism.
                corners.extend(element.corners().iter().map(|c| c + n));
            }
            let of = |tet: &[usize; 4]| tet.map(|k| corners[k]);
            volume.tetrahedra.extend(tetrahedra(corners.len()).iter().map(of));
        }
        volume
    }

    fn is_solid(&self) -> bool {
        self.elements.iter().any(|e| e.kind.dimension() == 3)
    }

    /// Lines along the greatest and along the smallest principal stress, about evenly spaced. In a plate they lie at
    /// mid-height.
    ///
    /// Method: for each of the two stresses, lines start at seed points on a grid, in order of falling stress. A seed is
    /// skipped if a line already passes through its cell, and a line ends where it enters a cell of another line. Cost:
    /// linear in the points of the lines; there are at most as many lines as seeds.
    pub fn stress_lines(&self) -> Vec<StressLine> {
        let is_solid = self.is_solid();
        let known =
            self.nodes.iter().copied().reduce(DVec3::min).zip(self.nodes.iter().copied().reduce(DVec3::max));
        let Some((low, high)) = known else { return Vec::new() };
        let mut sizes: Vec<f64> = self.stress.iter().map(von_mises).filter(|v| v.is_finite()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let at = (COVERED * sizes.len() as f64) as usize;
        let Some(reference) = sizes.get(at.min(sizes.len().saturating_sub(1))).copied() else {
            return Vec::new();
        };
        let field = StressField::new(FeResult {
            format: FeFormat::Vtu,
            nodes: self.nodes.clone(),
            elements: self.elements.clone(),
            stress: self.stress.clone(),
            displacement: None,
            plane: !is_solid,
            stress_array: String::new(),
            warnings: Vec::new(),
        });
        let size = high - low;
        // In a flat solid each direction still gets at least one row of seeds.
        let pitch = if is_solid {
            pow(size.x * size.y * size.z / SEEDS[0], 1.0 / 3.0)
        } else {
            (size.x * size.y / SEEDS[1]).sqrt()
        };
        // A mesh without extent in a direction that needs one, or without stress, has no lines to show.
        if pitch <= 0.0 || reference <= 0.0 {
            return Vec::new();
        }
        let settings = LineSettings {
            tolerance_mm: 0.01 * pitch,
            step_mm: 0.5 * pitch,
            // Source: chosen; a line across the part and back is shorter.
            longest_mm: 4.0 * size.max_element(),
        };
        // Value and axis of a family at a point. Family 0 is the greatest and family 2 the smallest principal stress.
        let sample = |p: DVec3, family: usize| -> Option<(f64, DVec3)> {
            let place = field.locate(p).filter(|at| at.distance_mm == 0.0)?;
            let found = principal(&field.stress_at(&place));
            let (value, middle) = (found.values_mpa[family], found.values_mpa[1]);
            let axis = found.axes[family];
            // In a plate, the principal axis normal to the plane carries no stress and gives no line.
            let is_along = is_solid || axis.z.abs() < 0.5;
            let is_clear = value.abs() >= LEAST_SHARE * reference
                && (value - middle).abs() >= DEGENERATE_SHARE * reference;
            (is_along && is_clear).then_some((value, axis))
        };
        let cells = (size / pitch).ceil().as_ivec3().max(IVec3::ONE);
        let cell = |p: DVec3| ((p - low) / pitch).as_ivec3().to_array();
        let mut lines = Vec::new();
        for family in [0, 2] {
            let mut taken: BTreeSet<[i32; 3]> = BTreeSet::new();
            let seed = |index: i32| {
                let key = IVec3::new(index % cells.x, index / cells.x % cells.y, index / (cells.x * cells.y));
                // The seeds are the centres of the grid's cells, evenly spaced in the box.
                low + size * (key.as_dvec3() + 0.5) / cells.as_dvec3()
            };
            let known = |p: DVec3| sample(p, family).map(|(value, _)| (value.abs(), p));
            let mut seeds: Vec<(f64, DVec3)> =
                (0..cells.x * cells.y * cells.z).map(seed).filter_map(known).collect();
            seeds.sort_by(|a, b| b.0.total_cmp(&a.0));
            for (_, seed) in seeds {
                if taken.contains(&cell(seed)) {
                    continue;
                }
                let last = Cell::new(cell(seed));
                let stop = |p: DVec3, _: f64| {
                    let here = cell(p);
                    let is_new = here != last.replace(here);
                    is_new && taken.contains(&here)
                };
                let axis = |p: DVec3| sample(p, family).map(|(_, axis)| axis);
                let mut line = trace_line(seed, &axis, &stop, &settings);
                if line.length_mm() < pitch {
                    continue;
                }
                if line.closed {
                    line.points.push(line.points[0]);
                }
                taken.extend(line.points.iter().map(|p| cell(*p)));
                let values_mpa =
                    line.points.iter().map(|p| sample(*p, family).map_or(0.0, |(v, _)| v)).collect();
                lines.push(StressLine { points: line.points, values_mpa });
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use grainpath_io::fe::{Element, ElementKind};

    use super::*;

    /// A bar of 12 x 2 x 2 mm of cubes whose stress is `stress` at each node.
    fn bar(stress: impl Fn(DVec3) -> [f64; 6]) -> ResultMesh {
        let (nx, ny, nz) = (13, 3, 3);
        let index = |i: u32, j: u32, k: u32| i + nx * (j + ny * k);
        let mut nodes = Vec::new();
        for k in 0..nz {
            for j in 0..ny {
                nodes.extend((0..nx).map(|i| DVec3::new(f64::from(i), f64::from(j), f64::from(k))));
            }
        }
        let mut elements = Vec::new();
        for (i, j, k) in (0..nx - 1).flat_map(|i| (0..2).flat_map(move |j| (0..2).map(move |k| (i, j, k)))) {
            let square =
                |k: u32| [index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k)];
            let corners = [square(k), square(k + 1)].concat();
            elements.push(Element::new(ElementKind::Hex8, &corners).expect("eight corners"));
        }
        let stress = nodes.iter().map(|p| stress(*p)).collect();
        ResultMesh { name: String::new(), nodes, elements, stress, displacement: None, sets: Vec::new() }
    }

    #[test]
    fn tetrahedra_fill_the_elements() {
        let volume = bar(|_| [0.0; 6]).volume(0.0);
        let size = |t: &[u32; 4]| {
            let [a, b, c, d] = t.map(|k| volume.points[k as usize]);
            (b - a).dot((c - a).cross(d - a)).abs() / 6.0
        };
        let sum: f64 = volume.tetrahedra.iter().map(size).sum();
        assert!((sum - 48.0).abs() < 1e-9, "{sum}");
        for (n, corners) in [(4, 1.0 / 6.0), (5, 1.0 / 3.0), (6, 0.5), (8, 1.0)] {
            let square = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
            let points: Vec<[f64; 3]> = match n {
                4 => vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                5 => square(0.0).into_iter().chain([[0.0, 0.0, 1.0]]).collect(),
                6 => [0.0, 1.0]
                    .into_iter()
                    .flat_map(|z| square(z).into_iter().filter(|p| p[0] + p[1] < 2.0))
                    .collect(),
                _ => [0.0, 1.0].into_iter().flat_map(square).collect(),
            };
            let at = |k: usize| DVec3::from_array(points[k]);
            let volume = |t: &[usize; 4]| {
                (at(t[1]) - at(t[0])).dot((at(t[2]) - at(t[0])).cross(at(t[3]) - at(t[0]))).abs() / 6.0
            };
            let sum: f64 = tetrahedra(n).iter().map(volume).sum();
            assert!((sum - corners).abs() < 1e-12, "{n} corners: {sum}");
        }
    }

    #[test]
    fn a_pulled_bar_has_lines_along_it_and_none_of_compression() {
        let lines = bar(|_| [5.0, 0.0, 0.0, 0.0, 0.0, 0.0]).stress_lines();
        assert!(lines.len() >= 9, "{}", lines.len());
        for line in &lines {
            assert!(line.values_mpa.iter().all(|v| (v - 5.0).abs() < 1e-9), "{:?}", line.values_mpa);
            let (a, b) = (line.points[0], line.points[line.points.len() - 1]);
            assert!((b.x - a.x).abs() > 11.9 && (b - a).with_x(0.0).length() < 1e-6, "{a} {b}");
        }
        assert!(bar(|_| [0.0; 6]).stress_lines().is_empty());
    }

    #[test]
    fn a_bent_bar_is_pulled_above_and_pushed_below_its_middle() {
        let lines = bar(|p| [4.0 * (p.z - 1.0), 0.0, 0.0, 0.0, 0.0, 0.0]).stress_lines();
        let of = |is_above: bool| lines.iter().filter(move |l| (l.points[0].z > 1.0) == is_above);
        assert!(of(true).count() >= 3 && of(false).count() >= 3);
        assert!(of(true).all(|l| l.values_mpa.iter().all(|v| *v > 0.0)));
        assert!(of(false).all(|l| l.values_mpa.iter().all(|v| *v < 0.0)));
    }
}
