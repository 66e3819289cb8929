//! Isosurface stuffing (Labelle and Shewchuk 2007): lattice points near the surface move onto it, the tetrahedra that
//! still cross it are cut, and every tetrahedron keeps dihedral angles far from 0 and 180 degrees.

use grainpath_core::{DVec3, IVec3};
use rayon::prelude::*;

use super::lattice::{Cut, FORWARD, Lattice};

/// Within these shares of a long and a short edge a lattice point is moved onto the surface; from the paper.
const WARP_LONG: f64 = 0.249_99;
const WARP_SHORT: f64 = 0.411_89;

/// Tetrahedra with flat sides.
#[derive(Debug, Clone, Default)]
pub(super) struct Tets {
    pub(super) vertices: Vec<DVec3>,
    pub(super) tets: Vec<[u32; 4]>,
}

/// A corner of the tetrahedra that come out: a lattice point (index) or a cut (index plus the number of points).
type Corner = u64;

/// Fills the inside of a classified lattice.
pub(super) fn stuff(lattice: &Lattice, cuts: &[Cut], keep: impl Fn(DVec3) -> bool + Sync) -> Tets {
    let warp = Warped::of(lattice, cuts);
    let n = lattice.cells();
    let layers: Vec<Vec<[Corner; 4]>> = (0..n.z)
        .into_par_iter()
        .map(|z| {
            let mut out = Vec::new();
            for y in 0..n.y {
                for x in 0..n.x {
                    around(lattice, IVec3::new(x, y, z) * 2 + 1, &warp, &keep, &mut out);
                }
            }
            out
        })
        .collect();
    number(&layers.concat(), &warp)
}

/// Gives the corners in use numbers in the order of their place and sets each tetrahedron right way round.
fn number(corners: &[[Corner; 4]], warp: &Warped<'_>) -> Tets {
    let mut used: Vec<Corner> = corners.iter().flatten().copied().collect();
    used.par_sort_unstable();
    used.dedup();
    let vertices: Vec<DVec3> = used.iter().map(|&c| warp.place(c)).collect();
    let id = |c: Corner| used.binary_search(&c).expect("every corner is in the list") as u32;
    let tets = corners.par_iter().map(|t| upright(t.map(id), &vertices)).collect();
    Tets { vertices, tets }
}

/// The same tetrahedron with positive volume.
fn upright(t: [u32; 4], vertices: &[DVec3]) -> [u32; 4] {
    let [a, b, c, d] = t.map(|i| vertices[i as usize]);
    if (b - a).cross(c - a).dot(d - a) < 0.0 { [t[0], t[2], t[1], t[3]] } else { t }
}

struct Warped<'a> {
    lattice: &'a Lattice,
    cuts: &'a [Cut],
    /// Lattice points moved onto the surface, sorted by index.
    moved: Vec<(u64, DVec3)>,
    n_points: u64,
}

impl<'a> Warped<'a> {
    /// Each point, in order of index, goes to the nearest cut that is too near to it, unless the edge of that cut has
    /// lost it already because its other end went there.
    fn of(lattice: &'a Lattice, cuts: &'a [Cut]) -> Self {
        let n_points = lattice.sign.len() as u64;
        let mut near: Vec<(u64, u64, usize, f64)> = Vec::new();
        let points = Points { lattice };
        for (i, cut) in cuts.iter().enumerate() {
            let (p, q) = points.ends(cut.key);
            let (a, b) = (lattice.position(p), lattice.position(q));
            let share = a.distance(cut.at) / a.distance(b);
            let limit = if cut.key % 8 < 3 { WARP_LONG } else { WARP_SHORT };
            let (p, q) = (lattice.index(p) as u64, lattice.index(q) as u64);
            if share < limit {
                near.push((p, q, i, a.distance(cut.at)));
            } else if 1.0 - share < limit {
                near.push((q, p, i, b.distance(cut.at)));
            }
        }
        near.sort_by(|a, b| a.0.cmp(&b.0).then(a.3.total_cmp(&b.3)).then(a.2.cmp(&b.2)));
        let mut moved: Vec<(u64, DVec3)> = Vec::new();
        for group in near.chunk_by(|a, b| a.0 == b.0) {
            let gone = |other: u64| moved.binary_search_by_key(&other, |m| m.0).is_ok();
            if let Some(&(p, _, cut, _)) = group.iter().find(|g| !gone(g.1)) {
                moved.push((p, cuts[cut].at));
            }
        }
        Self { lattice, cuts, moved, n_points }
    }

    fn find(&self, point: u64) -> Option<DVec3> {
        self.moved.binary_search_by_key(&point, |m| m.0).ok().map(|i| self.moved[i].1)
    }

    fn sign(&self, p: IVec3) -> i8 {
        let s = self.lattice.sign(p);
        if self.find(self.lattice.index(p) as u64).is_some() { 0 } else { s }
    }

    fn cut(&self, p: IVec3, q: IVec3) -> Corner {
        let key = self.lattice.edge_key(p, q);
        let i = self.cuts.binary_search_by_key(&key, |c| c.key).expect("ends of unlike sign have a cut");
        self.n_points + i as u64
    }

    fn place(&self, corner: Corner) -> DVec3 {
        if corner >= self.n_points {
            return self.cuts[(corner - self.n_points) as usize].at;
        }
        self.find(corner)
            .unwrap_or_else(|| self.lattice.position(Points { lattice: self.lattice }.point(corner)))
    }
}

/// From indices back to points.
struct Points<'a> {
    lattice: &'a Lattice,
}

impl Points<'_> {
    fn point(&self, index: u64) -> IVec3 {
        let n = self.lattice.cells();
        let corners = (n + 1).as_u64vec3().element_product();
        let (rest, m, odd) = if index < corners { (index, n + 1, 0) } else { (index - corners, n, 1) };
        let (x, y) = (rest % m.x as u64, rest / m.x as u64 % m.y as u64);
        IVec3::new(x as i32, y as i32, (rest / (m.x as u64 * m.y as u64)) as i32) * 2 + odd
    }

    fn ends(&self, key: u64) -> (IVec3, IVec3) {
        let p = self.point(key / 8);
        (p, p + FORWARD[(key % 8) as usize])
    }
}

/// The twelve tetrahedra between a cell's centre and those of the next cells along x, y and z.
fn around(
    lattice: &Lattice,
    centre: IVec3,
    warp: &Warped<'_>,
    keep: &impl Fn(DVec3) -> bool,
    out: &mut Vec<[Corner; 4]>,
) {
    for axis in 0..3 {
        let e = IVec3::AXES[axis];
        let other = centre + e * 2;
        if !lattice.has(other) {
            continue;
        }
        let (u, v) = (IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]);
        let ring = [u + v, v - u, -u - v, u - v].map(|r| centre + e + r);
        if ring.iter().chain([&centre, &other]).all(|&p| lattice.sign(p) < 0) {
            continue;
        }
        for i in 0..4 {
            cut_tet([centre, other, ring[i], ring[(i + 1) % 4]], warp, keep, out);
        }
    }
}

fn cut_tet(points: [IVec3; 4], warp: &Warped<'_>, keep: &impl Fn(DVec3) -> bool, out: &mut Vec<[Corner; 4]>) {
    let signs = points.map(|p| warp.sign(p));
    let corner = |p: IVec3| warp.lattice.index(p) as Corner;
    let of = |s: i8| points.into_iter().zip(signs).filter(move |&(_, t)| t == s).map(|(p, _)| p);
    let (plus, zero, minus): (Vec<IVec3>, Vec<IVec3>, Vec<IVec3>) =
        (of(1).collect(), of(0).collect(), of(-1).collect());
    match (plus.as_slice(), minus.as_slice()) {
        ([], []) => {
            // All corners on the surface: neither side is obvious.
            let middle = points.iter().map(|&p| warp.place(corner(p))).sum::<DVec3>() / 4.0;
            if keep(middle) {
                out.push(points.map(corner));
            }
        }
        ([], _) => {}
        (_, []) => out.push(points.map(corner)),
        (&[p], outside) => {
            let mut tet = [corner(p); 4];
            let rest = zero.iter().map(|&z| corner(z)).chain(outside.iter().map(|&m| warp.cut(p, m)));
            for (slot, c) in tet[1..].iter_mut().zip(rest) {
                *slot = c;
            }
            out.push(tet);
        }
        (&[p, q], &[m]) => {
            let quad = [corner(p), corner(q), warp.cut(q, m), warp.cut(p, m)];
            pyramid(quad, corner(zero[0]), out);
        }
        (&[p, q], &[m, o]) => prism(
            [corner(p), warp.cut(p, m), warp.cut(p, o)],
            [corner(q), warp.cut(q, m), warp.cut(q, o)],
            out,
        ),
        (&[p, q, r], &[m]) => {
            prism([p, q, r].map(corner), [p, q, r].map(|inside| warp.cut(inside, m)), out);
        }
        _ => unreachable!("four corners, some inside and some outside"),
    }
}

/// Quadrilaterals are split from their lowest corner, so that neighbours agree.
fn pyramid(q: [Corner; 4], apex: Corner, out: &mut Vec<[Corner; 4]>) {
    if q[0].min(q[2]) < q[1].min(q[3]) {
        out.extend([[q[0], q[1], q[2], apex], [q[0], q[2], q[3], apex]]);
    } else {
        out.extend([[q[1], q[2], q[3], apex], [q[1], q[3], q[0], apex]]);
    }
}

fn prism(a: [Corner; 3], b: [Corner; 3], out: &mut Vec<[Corner; 4]>) {
    let lowest = (0..6).min_by_key(|&i| if i < 3 { a[i] } else { b[i - 3] }).unwrap_or(0);
    let (a, b) = if lowest < 3 { (a, b) } else { (b, a) };
    let turn = |t: [Corner; 3]| [0, 1, 2].map(|i| t[(i + lowest) % 3]);
    let (a, b) = (turn(a), turn(b));
    out.push([a[0], b[0], b[1], b[2]]);
    if a[1].min(b[2]) < a[2].min(b[1]) {
        out.extend([[a[0], a[1], a[2], b[2]], [a[0], a[1], b[2], b[1]]]);
    } else {
        out.extend([[a[0], a[1], a[2], b[1]], [a[0], a[2], b[2], b[1]]]);
    }
}
