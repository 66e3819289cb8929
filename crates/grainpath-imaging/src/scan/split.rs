//! Cuts an entity that divides into several, where its parts will separate.
//!
//! Method: that of the published pipeline (`tan2020` in docs/references.bib). The cut between two children is
//! perpendicular to the shortest line `ab` between them. It passes through the point `e` that divides this
//! line in the ratio of the children's thicknesses along it, `ae / eb = ac / bd`. The ends of the cut move to
//! feature points of the parent near by: concave corners within 0.35 of the cut's length, where material
//! narrows. Several children are connected by the shortest lines of a spanning tree (`Kruskal1956`), with one
//! cut for each line. The pieces of the parent go to the child with which they share most area, or to the
//! nearest child.
//!
//! Lengths are in mm. A cut is a strip 4e-4 mm wide, four steps of the grid of booleans, so it removes next
//! to no material. Cost for n children: n^2 shortest lines, each with up to 600 vertices of an outline
//! against the edges of the other, and one boolean for each piece and child.
//!
//! Degenerate cases: children that touch are cut across the line between the middles of their boxes. A parent
//! that is not separated by these cuts, such as a ring, a cut whose point lies outside the parent, and a
//! child left without a piece give no result; the caller then interpolates signed distances.

use grainpath_core::math::cross;
use grainpath_core::poly::{LineClipper, edges};
use grainpath_core::{DVec2, Polygon, Region, segment};

use super::correspond::{Features, feature_points};

/// Width of a cut, mm. Source: derived. Four steps of the grid of 1e-4 mm to which boolean operations round: a narrower
/// cut may vanish, a wider one removes material.
const CUT_MM: f64 = 4e-4;

/// Cuts `parent` into one piece for each child by dividing edges. `None` where that fails: children are
/// connected in more than one place, or one is left without a piece.
///
/// The module text defines the point `e` of a dividing edge and its direction.
pub(super) fn split(parent: &Polygon, children: &[&Polygon], features: Features) -> Option<Vec<Region>> {
    let clipper = LineClipper::new(&Region::from(parent.clone()));
    let mut cuts = Vec::new();
    for (i, j, a, b) in links(children)? {
        let apart = b - a;
        let along = if apart.length() > 1e-9 {
            apart.normalize()
        } else {
            // Children that touch have no shortest line; the line through their centres gives the
            // direction.
            (middle(children[j])? - middle(children[i])?).normalize_or_zero()
        };
        let thick = |k: usize, from: DVec2, way: DVec2| thickness(children[k], from, way);
        let (ac, bd) = (thick(i, a, -along), thick(j, b, along));
        let share = if ac + bd > 0.0 { ac / (ac + bd) } else { 0.5 };
        let e = a.lerp(b, share);
        cuts.push(dividing_edge(parent, &clipper, e, DVec2::new(-along.y, along.x), features)?);
    }
    let cut: Vec<_> = cuts.into_iter().map(strip).collect();
    let knife = Region::from_contours(&cut, grainpath_core::poly::FillRule::NonZero);
    let pieces = Region::from(parent.clone()).difference(&knife);
    let mut out = vec![Region::default(); children.len()];
    for piece in pieces.polygons {
        let region = Region::from(piece.clone());
        let shares: Vec<f64> =
            children.iter().map(|c| region.intersection(&Region::from((*c).clone())).area_mm2()).collect();
        let best = (0..children.len()).max_by(|&x, &y| shares[x].total_cmp(&shares[y]).then(y.cmp(&x)))?;
        // A piece that meets no child goes to the nearest one: all of the parent has to be printed.
        let belongs = if shares[best] > 0.0 {
            best
        } else {
            let p = piece.outer[0];
            let far = |k: usize| nearest_point(children[k], p).distance(p);
            (0..children.len()).min_by(|&x, &y| far(x).total_cmp(&far(y)))?
        };
        // A piece that holds more than a quarter of two children was not divided.
        let reached = (0..children.len()).filter(|&k| shares[k] > 0.25 * children[k].area_mm2()).count();
        if reached > 1 {
            return None;
        }
        out[belongs].polygons.push(piece);
    }
    out.iter().all(|r| r.area_mm2() > 0.0).then_some(out)
}

/// The shortest lines that connect all children: which two, and from where to where.
fn links(children: &[&Polygon]) -> Option<Vec<(usize, usize, DVec2, DVec2)>> {
    let n = children.len();
    let mut all = Vec::new();
    for i in 0..n {
        for j in i + 1..n {
            let (a, b) = closest(children[i], children[j])?;
            all.push((i, j, a, b));
        }
    }
    all.sort_by(|x, y| {
        x.2.distance_squared(x.3).total_cmp(&y.2.distance_squared(y.3)).then((x.0, x.1).cmp(&(y.0, y.1)))
    });
    let mut group: Vec<usize> = (0..n).collect();
    let mut out = Vec::new();
    // Kruskal's algorithm (`Kruskal1956`): the shortest line first, none that closes a ring.
    for link in all {
        let (x, y) = (group[link.0], group[link.1]);
        if x != y {
            group.iter_mut().filter(|g| **g == y).for_each(|g| *g = x);
            out.push(link);
        }
    }
    Some(out)
}

fn middle(p: &Polygon) -> Option<DVec2> {
    p.bounds().map(grainpath_core::Bounds2::centre)
}

fn nearest_point(polygon: &Polygon, p: DVec2) -> DVec2 {
    let all = edges(&polygon.outer).map(|(a, b)| segment::closest_point(p, a, b));
    all.fold(
        polygon.outer[0],
        |best, q| {
            if q.distance_squared(p) < best.distance_squared(p) { q } else { best }
        },
    )
}

/// The closest points of two outlines, measured from the vertices of each to the other.
fn closest(a: &Polygon, b: &Polygon) -> Option<(DVec2, DVec2)> {
    // Fewer than 600 vertices of each outline bound the time; the dividing edge is moved to feature points anyway.
    let thin =
        |p: &Polygon| p.outer.iter().copied().step_by((p.outer.len() / 300).max(1)).collect::<Vec<_>>();
    let from_a = thin(a).into_iter().map(|p| (p, nearest_point(b, p)));
    let from_b = thin(b).into_iter().map(|p| (nearest_point(a, p), p));
    from_a.chain(from_b).min_by(|x, y| x.0.distance_squared(x.1).total_cmp(&y.0.distance_squared(y.1)))
}

/// Length that a ray from the border of a child runs inside it.
fn thickness(child: &Polygon, from: DVec2, way: DVec2) -> f64 {
    let mut hits: Vec<f64> = child
        .contours()
        .flat_map(|c| edges(c))
        .filter_map(|(p, q)| {
            let d = cross(way, q - p);
            let s = cross(p - from, way) / d;
            let t = cross(p - from, q - p) / d;
            // The point itself lies on the border and is no hit.
            (d.abs() > 1e-15 && (0.0..=1.0).contains(&s) && t > 1e-4).then_some(t)
        })
        .collect();
    hits.sort_by(f64::total_cmp);
    hits.first().copied().unwrap_or(0.0)
}

/// The line through `e` across the parent. Its ends move to feature points where there are any nearby.
fn dividing_edge(
    parent: &Polygon,
    clipper: &LineClipper,
    e: DVec2,
    way: DVec2,
    features: Features,
) -> Option<(DVec2, DVec2)> {
    // Between the arms of a C the point `e` may lie outside the parent, where there is nothing to cut.
    if !clipper.contains(e) {
        return None;
    }
    let far = parent.bounds()?.size().length() * way;
    let end = |to: DVec2| clipper.crossings(e, e + to).first().map(|c| e + to * c.t);
    let (p, q) = (end(far)?, end(-far)?);
    // A corner within a third of the cut's length may take its end; farther ones belong to other details.
    let reach = 0.35 * p.distance(q);
    let corners: Vec<DVec2> = parent
        .contours()
        // Only concave corners, where material narrows, are natural ends of a cut.
        .flat_map(|c| feature_points(c, features).into_iter().filter(|f| f.1 < 0.0).map(|f| c[f.0]))
        .collect();
    let snap = |end: DVec2, other: DVec2| {
        let near = corners.iter().copied().filter(|c| c.distance(end) < reach && c.distance(other) > reach);
        near.min_by(|x, y| x.distance_squared(end).total_cmp(&y.distance_squared(end))).unwrap_or(end)
    };
    let snapped = (snap(p, q), snap(q, p));
    // A snapped line that leaves the parent would cut something else.
    let inside = (1..8).all(|k| clipper.contains(snapped.0.lerp(snapped.1, f64::from(k) / 8.0)));
    Some(if inside { snapped } else { (p, q) })
}

/// A cut as a thin strip that extends slightly beyond its ends, so that it separates the border too.
fn strip((p, q): (DVec2, DVec2)) -> Vec<DVec2> {
    let along = (q - p).normalize_or_zero() * 2.0 * CUT_MM;
    let side = DVec2::new(-along.y, along.x) * 0.25;
    vec![p - along - side, q + along - side, q + along + side, p - along + side]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Polygon {
        Region::rectangle(DVec2::new(x0, y0), DVec2::new(x1, y1)).polygons.remove(0)
    }

    const FEATURES: Features = Features { curvature: 1.0, min_edge_mm: 0.2 };

    #[test]
    fn a_bar_is_cut_between_its_children_as_they_are_thick() {
        let parent = rectangle(0.0, 0.0, 20.0, 5.0);
        let (a, b) = (rectangle(1.0, 1.0, 7.0, 4.0), rectangle(16.0, 1.0, 19.0, 4.0));
        let pieces = split(&parent, &[&a, &b], FEATURES).expect("two pieces");
        let areas: Vec<f64> = pieces.iter().map(Region::area_mm2).collect();
        // ac = 6, bd = 3: the 9 mm between are divided as 2 to 1, at x = 13.
        assert!((areas[0] - 65.0).abs() < 0.1 && (areas[1] - 35.0).abs() < 0.1, "{areas:?}");
        let c = rectangle(9.0, 1.0, 12.0, 4.0);
        let three = split(&parent, &[&a, &b, &c], FEATURES).expect("three pieces");
        assert_eq!(three.len(), 3);
        assert!((three.iter().map(Region::area_mm2).sum::<f64>() - 100.0).abs() < 0.05);
    }

    #[test]
    fn a_ring_is_not_cut_by_one_edge() {
        let outer = Region::rectangle(DVec2::ZERO, DVec2::splat(20.0));
        let ring = outer.difference(&Region::rectangle(DVec2::splat(5.0), DVec2::splat(15.0)));
        let (a, b) = (rectangle(1.0, 1.0, 4.0, 19.0), rectangle(16.0, 1.0, 19.0, 19.0));
        assert!(split(&ring.polygons[0], &[&a, &b], FEATURES).is_none());
    }
}
