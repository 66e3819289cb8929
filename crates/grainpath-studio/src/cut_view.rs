//! Sections through a solid that was solved: the plane cuts its tetrahedra into triangles.

use std::collections::BTreeMap;

use crate::engine::StressVolume;

/// A section: points, triangles, and nine values a point.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct StressSection {
    pub points: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub values: Vec<[f32; 9]>,
}

/// The section at position `at_mm` on an axis (0 to 2 for x to z). Values of a load case are interpolated along cut edges.
///
/// A point in the plane counts as above it, so that a plane through points gives no triangle twice. Cost: one look at each
/// tetrahedron.
pub(crate) fn cut(volume: &StressVolume, values: &[[f32; 9]], axis: usize, at_mm: f32) -> StressSection {
    let mut section = StressSection::default();
    let mut known: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let is_above = |k: u32| volume.points[k as usize][axis] >= at_mm;
    for tet in &volume.tetrahedra {
        let (mut above, mut below) = ([0; 4], [0; 4]);
        let (mut n, mut m) = (0, 0);
        for &k in tet {
            if is_above(k) {
                above[n] = k;
                n += 1;
            } else {
                below[m] = k;
                m += 1;
            }
        }
        let mut point = |a: u32, b: u32| {
            let key = (a.min(b), a.max(b));
            *known.entry(key).or_insert_with(|| {
                let (a, b) = (key.0 as usize, key.1 as usize);
                let (p, q) = (volume.points[a], volume.points[b]);
                let t = (at_mm - p[axis]) / (q[axis] - p[axis]);
                section.points.push(std::array::from_fn(|c| p[c] + t * (q[c] - p[c])));
                section
                    .values
                    .push(std::array::from_fn(|c| values[a][c] + t * (values[b][c] - values[a][c])));
                section.points.len() as u32 - 1
            })
        };
        match (n, m) {
            (1, 3) => section.triangles.push([0, 1, 2].map(|k| point(above[0], below[k]))),
            (3, 1) => section.triangles.push([0, 1, 2].map(|k| point(above[k], below[0]))),
            (2, 2) => {
                let round = [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(i, j)| point(above[i], below[j]));
                section.triangles.extend([[round[0], round[1], round[2]], [round[0], round[2], round[3]]]);
            }
            _ => {}
        }
    }
    section
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of 2 mm as six tetrahedra, with the height as its first value.
    fn cube() -> (StressVolume, Vec<[f32; 9]>) {
        let points: Vec<[f32; 3]> = (0..8).map(|k| [0, 1, 2].map(|a| (k >> a & 1) as f32 * 2.0)).collect();
        let tetrahedra =
            vec![[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];
        let values = points.iter().map(|p| [p[2], p[0], 7.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        (StressVolume { points, tetrahedra }, values)
    }

    fn area(section: &StressSection) -> f32 {
        let triangle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| section.points[k as usize]);
            let side = |p: [f32; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
            let (u, v) = (side(b), side(c));
            let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            cross.iter().map(|x| x * x).sum::<f32>().sqrt() / 2.0
        };
        section.triangles.iter().map(triangle).sum()
    }

    #[test]
    fn a_section_covers_the_cut_with_the_values_between() {
        let (volume, values) = cube();
        for axis in 0..3 {
            for at in [0.1, 0.5, 1.0, 1.9, 2.0] {
                let section = cut(&volume, &values, axis, at);
                assert!((area(&section) - 4.0).abs() < 1e-4, "{axis} {at}: {}", area(&section));
                for (p, v) in section.points.iter().zip(&section.values) {
                    assert!((p[axis] - at).abs() < 1e-6);
                    assert!((v[0] - p[2]).abs() < 1e-6 && (v[1] - p[0]).abs() < 1e-6 && v[2] == 7.0);
                }
            }
            for beside in [-0.1, 2.1] {
                assert_eq!(cut(&volume, &values, axis, beside), StressSection::default());
            }
        }
    }
}
