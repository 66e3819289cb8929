//! Moves lattice points in a thin wall or gap to its middle, before the lattice is cut.
//!
//! Stuffing moves points near the surface onto it. In a wall about as thin as a cell both sides attract the
//! same points; if a point moved onto one side, the other one would be lost. A point in the middle instead
//! keeps both sides apart, since edges from it cross each of them.
//!
//! Method: our own. A point qualifies if an edge at it is cut by a side that faces away from its nearest side
//! (cosine of the normals below -0.5), too far from the edge's other end for that one to move there. It moves
//! along the normal by half the difference of its distances to both sides, or by 3/4, 1/2 or 1/4 of that. The
//! first of these is taken that leaves every tetrahedron around with a mean ratio above 0.2 and the point on
//! its side of the surface. Cuts at moved points are then found anew. All these points are excluded from
//! stuffing's moves, except those closer to the surface than 0.08 of an edge, because slivers are worse.
//!
//! Lengths are in mm. Cost: sorting the cuts, and a few queries of the tree for each point that moves.
//! Degenerate cases: a lattice without thin walls or gaps is left as it is. A cut in a hole of the surface
//! has no normal and is ignored.

use grainpath_core::{Bvh, DVec3, TriMesh};

use super::lattice::{Background, Cut};
use super::stuffing::warp_limit;
use crate::solid::model::adjacency::incidence;
use crate::solid::model::tet_shape::mean_ratio;

/// Two surfaces face away from each other, as the sides of a wall or gap do, if the cosine between
/// their normals is below this.
const OPPOSITE: f64 = -0.5;
/// Least mean ratio of the lattice tetrahedra after a move; before moves, cells of one size have
/// 0.95 and halved ones 0.6.
const LEAST_RATIO: f64 = 0.2;
/// A point nearer to the surface than this share of an edge is moved onto the surface in spite of
/// the thin wall, because slivers are worse.
const TOO_NEAR: f64 = 0.08;

/// Moves the points in thin walls and gaps towards the middle. Returns for each point whether it has to stay
/// where it is afterwards.
pub(super) fn centre(lattice: &mut Background, surface: &TriMesh, bvh: &Bvh) -> Vec<bool> {
    let wanted = between(lattice);
    if wanted.is_empty() {
        return vec![false; lattice.points.len()];
    }
    let (start, around) = incidence(lattice.points.len(), &lattice.tets);
    let mut moved = vec![false; lattice.points.len()];
    for &(p, shift) in &wanted {
        let i = p as usize;
        let tets = &around[start[i] as usize..start[i + 1] as usize];
        let worst = |lattice: &Background, at: DVec3| {
            let ratio = |&t: &u32| {
                let t = lattice.tets[t as usize];
                let before = mean_ratio(&t.map(|k| lattice.points[k as usize]));
                let after = mean_ratio(&t.map(|k| if k == p { at } else { lattice.points[k as usize] }));
                after * before.signum()
            };
            tets.iter().map(ratio).fold(f64::INFINITY, f64::min)
        };
        // The full distance is tried first, then shorter ones: half way to the middle is still better than no move.
        for part in [1.0, 0.75, 0.5, 0.25] {
            let at = lattice.points[i] + part * shift;
            if worst(lattice, at) > LEAST_RATIO && bvh.contains(at) == (lattice.sign[i] > 0) {
                (lattice.points[i], moved[i]) = (at, true);
                break;
            }
        }
    }
    lattice.cut_again(surface, bvh, &moved);
    let mut stays = vec![false; lattice.points.len()];
    for &(p, _) in &wanted {
        stays[p as usize] = true;
    }
    for cut in &lattice.cuts {
        for (k, share) in [lattice.share(cut), 1.0 - lattice.share(cut)].into_iter().enumerate() {
            stays[cut.ends[k] as usize] &= share > TOO_NEAR;
        }
    }
    stays
}

/// Points in a wall or gap so thin that a move onto the nearer side would lose the other one, each
/// with the vector to the middle.
fn between(lattice: &Background) -> Vec<(u32, DVec3)> {
    let mut at: Vec<(u32, usize)> =
        lattice.cuts.iter().enumerate().flat_map(|(c, cut)| cut.ends.map(|p| (p, c))).collect();
    at.sort_unstable();
    let way = |own: &[(u32, usize)]| {
        let p = own[0].0;
        let (place, side) = (lattice.points[p as usize], f64::from(lattice.sign[p as usize]));
        let depth = |cut: &Cut| side * (cut.at - place).dot(cut.normal);
        let share = |cut: &Cut| {
            let share = lattice.share(cut);
            if cut.ends[0] == p { share } else { 1.0 - share }
        };
        let cuts = || own.iter().map(|&(_, c)| &lattice.cuts[c]);
        let near = cuts().min_by(|a, b| share(a).total_cmp(&share(b)))?;
        // The other side is lost if it faces away from the nearer one and the point at the other
        // end of the edge is too far from the cut to move onto it.
        let lost =
            |cut: &&Cut| cut.normal.dot(near.normal) < OPPOSITE && 1.0 - share(cut) > warp_limit(cut.short);
        let far = cuts().filter(lost).min_by(|a, b| depth(a).total_cmp(&depth(b)))?;
        Some((p, -0.5 * side * (depth(far) - depth(near)) * near.normal))
    };
    at.chunk_by(|a, b| a.0 == b.0).filter_map(way).collect()
}
