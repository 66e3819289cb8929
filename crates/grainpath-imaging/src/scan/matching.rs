//! Combines two neighbouring slices: matches entities, pairs contours, and finds which entities begin,
//! end or branch.
//!
//! An *entity* is an island of a section: an outline with its holes. Where slices lie far apart, the layers between two
//! slices are made by moving the contours of the lower slice to those of the upper one.
//!
#![doc = include_str!("figures/matching.svg")]
//!
//! # Method
//! 1. Entities belong to one group where one covers a share of the other (`MatchSettings::overlap`); leftovers of like size
//!    that lie side by side are paired as well, so that a thin wall may move by more than its thickness.
//! 2. One to one: points of the two contours are paired by dynamic programming over distance and direction (`fuchs1977` in
//!    docs/references.bib), or between feature points by number, as published (`tan2020`).
//! 3. One to several: the parent is cut by dividing edges (`tan2020`), see `split`.
//! 4. Several to several, holes that open, and pairings that fold over themselves: signed distances of both sections are
//!    mixed (`raya1990`).
//! 5. An entity without a partner begins or ends where the grey values of the two slices cross the threshold.
//!
//! Lengths are in mm in the plane of the slices; `t` runs from 0 at the lower slice to 1 at the upper one. Cost: pairing is
//! quadratic in the points of a contour, of which at most 700 are matched. Limits: between slices a curved flank is
//! replaced by its chords, so a torus in slices four pixels apart becomes 0.8 % too small (docs/ct.md).

use grainpath_core::DisjointSets;
use grainpath_core::poly::{FillRule, signed_area_mm2};
use grainpath_core::{Bounds2, Contour, DVec2, Polygon, Region};

use super::correspond::{Features, Pairing, by_features, dynamic};
use super::split::split;
use super::trace::SignedImage;
use crate::distance::{Raster, signed_distance};

/// Parameters for matching neighbouring slices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchSettings {
    /// Share of an entity that its partner must cover at least.
    pub overlap: f64,
    /// Distance of pixels, mm.
    pub pixel_mm: DVec2,
    /// Whether points are paired by features, as in the paper, instead of by dynamic programming.
    pub features: bool,
}

impl MatchSettings {
    fn step_mm(&self) -> f64 {
        self.pixel_mm.min_element()
    }

    fn feature_points(&self) -> Features {
        Features { curvature: 1.5, min_edge_mm: self.step_mm() }
    }
}

/// Entities of two slices that belong together.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Group {
    /// Entities of the lower slice.
    pub lower: Vec<usize>,
    /// Entities of the upper slice.
    pub upper: Vec<usize>,
}

/// Counts of what happens between two slices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Events {
    /// Entities that begin.
    pub births: usize,
    /// Entities that end.
    pub deaths: usize,
    /// Entities that divide into several or merge from several.
    pub branches: usize,
}

/// The matched contours between two slices.
#[derive(Debug, Clone, Default)]
pub struct Slab {
    moving: Vec<Pairing>,
    /// Contours that keep their shape, each with the fractions `t` between which it exists.
    still: Vec<(Contour, f64, f64)>,
    blends: Vec<Blend>,
    /// Half width of the gaps to be closed between the pieces of a branching entity, mm.
    heal_mm: f64,
    /// Births, deaths and branches between the slices.
    pub events: Events,
}

/// A group whose contours cannot be paired: the signed distances of both sections are mixed.
#[derive(Debug, Clone)]
struct Blend {
    raster: Raster,
    lower: Vec<f32>,
    upper: Vec<f32>,
}

impl Blend {
    fn new(lower: &Region, upper: &Region, pixel_mm: DVec2) -> Option<Self> {
        let bounds = lower.bounds()?.union(upper.bounds()?);
        let raster = Raster::over(bounds, pixel_mm);
        let (lower, upper) = (signed_distance(lower, &raster), signed_distance(upper, &raster));
        Some(Self { raster, lower, upper })
    }

    fn at(&self, t: f64) -> Vec<Contour> {
        let grid = SignedImage::mixed(&self.lower, &self.upper, t as f32, self.raster.nx, self.raster.ny);
        let to_mm = |c: Contour| c.into_iter().map(|p| self.raster.to_mm(p)).collect();
        grid.contours().into_iter().map(to_mm).collect()
    }
}

impl Slab {
    /// The section at the fraction `t` of the way from the lower slice to the upper one.
    pub fn at(&self, t: f64) -> Region {
        let mut contours: Vec<Contour> = self.moving.iter().map(|p| p.at(t)).collect();
        contours.extend(self.still.iter().filter(|s| s.1 <= t && t < s.2).map(|s| s.0.clone()));
        contours.extend(self.blends.iter().flat_map(|b| b.at(t)));
        let region = Region::from_contours(&contours, FillRule::Positive);
        if self.heal_mm > 0.0 { region.closed(self.heal_mm) } else { region }
    }

    /// Whether the area halfway between the slices, net of holes, exceeds the areas in both. Then entities were matched that
    /// do not belong together, although each outline was paired well. An example is a C and the outside of a ring: the space
    /// between them would be filled.
    fn swells(&self, a: &[&Polygon], b: &[&Polygon], step_mm: f64) -> bool {
        let area = |ps: &[&Polygon]| ps.iter().map(|p| p.area_mm2()).sum::<f64>();
        let moving: f64 = self.moving.iter().map(|p| signed_area_mm2(&p.at(0.5))).sum();
        let still = self.still.iter().filter(|s| s.1 <= 0.5 && 0.5 < s.2);
        let middle = moving + still.map(|s| signed_area_mm2(&s.0)).sum::<f64>();
        middle > most_mm2(area(a), area(b), step_mm)
    }

    /// Matches two slices. `change` returns the fraction of the way at which the inside of a contour
    /// changes between material and air, from the grey values; the flag says whether the contour is the
    /// lower slice's.
    pub fn between(
        lower: &Region,
        upper: &Region,
        settings: &MatchSettings,
        change: &dyn Fn(&Contour, bool) -> f64,
    ) -> Self {
        let mut slab = Self::default();
        let builder = Builder { settings, change };
        for group in match_entities(&lower.polygons, &upper.polygons, settings.overlap) {
            let a: Vec<&Polygon> = group.lower.iter().map(|&i| &lower.polygons[i]).collect();
            let b: Vec<&Polygon> = group.upper.iter().map(|&j| &upper.polygons[j]).collect();
            slab.events.deaths += usize::from(b.is_empty());
            slab.events.births += usize::from(a.is_empty());
            slab.events.branches += usize::from(a.len() + b.len() > 2);
            // The group is built in a slab of its own, so that a failed attempt adds nothing to the result.
            let mut part = Self::default();
            let carried = builder.group(&a, &b, &mut part).is_some();
            if !carried || part.swells(&a, &b, settings.step_mm()) {
                part = Self::default();
                let region = |ps: &[&Polygon]| Region { polygons: ps.iter().map(|p| (*p).clone()).collect() };
                part.blends.extend(Blend::new(&region(&a), &region(&b), settings.pixel_mm));
            }
            slab.moving.append(&mut part.moving);
            slab.still.append(&mut part.still);
            slab.blends.append(&mut part.blends);
        }
        // Near the slice that was cut, the pieces lie closer together than the scan resolves, and the cut
        // would print as a gap.
        if slab.events.branches > 0 && !settings.features {
            slab.heal_mm = 0.5 * settings.step_mm();
        }
        slab
    }
}

/// Largest plausible area halfway between two areas, mm2.
fn most_mm2(a: f64, b: f64, step_mm: f64) -> f64 {
    // 5 % and a pixel cover the rounding of the contours; a paired outline interpolates between both
    // areas.
    1.05 * a.max(b) + step_mm * step_mm
}

struct Builder<'a> {
    settings: &'a MatchSettings,
    change: &'a dyn Fn(&Contour, bool) -> f64,
}

impl Builder<'_> {
    /// Pairs the contours of a group. `None` where pairing does not reproduce its shape.
    fn group(&self, a: &[&Polygon], b: &[&Polygon], slab: &mut Slab) -> Option<()> {
        match (a, b) {
            (_, []) => {
                for p in a {
                    let end = (self.change)(&p.outer, true);
                    slab.still.extend(p.contours().map(|c| (c.clone(), 0.0, end)));
                }
                Some(())
            }
            ([], _) => {
                for p in b {
                    // An entity that begins has no end within the slab; infinity includes t = 1.
                    let begin = (self.change)(&p.outer, false);
                    slab.still.extend(p.contours().map(|c| (c.clone(), begin, f64::INFINITY)));
                }
                Some(())
            }
            ([p], [q]) => self.entity(p, q, slab),
            ([parent], children) => self.branch(parent, children, false, slab),
            (children, [parent]) => self.branch(parent, children, true, slab),
            _ => None,
        }
    }

    fn branch(
        &self,
        parent: &Polygon,
        children: &[&Polygon],
        parent_above: bool,
        slab: &mut Slab,
    ) -> Option<()> {
        let pieces = split(parent, children, self.settings.feature_points())?;
        for (piece, child) in pieces.iter().zip(children) {
            let [piece] = piece.polygons.as_slice() else { return None };
            if parent_above {
                self.entity(child, piece, slab)?
            } else {
                self.entity(piece, child, slab)?
            };
        }
        Some(())
    }

    /// One entity on each side: outlines are paired, and holes are matched like entities.
    fn entity(&self, p: &Polygon, q: &Polygon, slab: &mut Slab) -> Option<()> {
        self.pair(&p.outer, &q.outer, slab)?;
        if p.holes.is_empty() && q.holes.is_empty() {
            return Some(());
        }
        // Holes are reversed to outlines, so that the same matching serves both.
        let solid = |holes: &[Contour]| -> Vec<Polygon> {
            let turned =
                |h: &Contour| Polygon { outer: h.iter().rev().copied().collect(), holes: Vec::new() };
            holes.iter().map(turned).collect()
        };
        let (a, b) = (solid(&p.holes), solid(&q.holes));
        for group in match_entities(&a, &b, self.settings.overlap) {
            let lower: Vec<&Polygon> = group.lower.iter().map(|&i| &a[i]).collect();
            let upper: Vec<&Polygon> = group.upper.iter().map(|&j| &b[j]).collect();
            // A hole that ends outside the other outline, not under material, has opened. Then holes
            // alone cannot describe the change.
            let opens = |hole: &Polygon, other: &Polygon| {
                let hole = Region::from(hole.clone());
                let covered = Region::from(Polygon { outer: other.outer.clone(), holes: Vec::new() });
                hole.intersection(&covered).area_mm2() < 0.5 * hole.area_mm2()
            };
            if (upper.is_empty() && lower.iter().any(|h| opens(h, q)))
                || (lower.is_empty() && upper.iter().any(|h| opens(h, p)))
            {
                return None;
            }
            let mut inner = Slab::default();
            self.group(&lower, &upper, &mut inner)?;
            let turn = |c: &mut Contour| c.reverse();
            for m in &mut inner.moving {
                turn(&mut m.from);
                turn(&mut m.to);
            }
            inner.still.iter_mut().for_each(|s| turn(&mut s.0));
            slab.moving.append(&mut inner.moving);
            slab.still.append(&mut inner.still);
        }
        Some(())
    }

    fn pair(&self, p: &Contour, q: &Contour, slab: &mut Slab) -> Option<()> {
        let (bp, bq) =
            (Bounds2::around_points(p.iter().copied())?, Bounds2::around_points(q.iter().copied())?);
        let apart = bq.centre() - bp.centre();
        // Contours that do not overlap, or that move more than they grow, are brought together first.
        let over = apart.abs().cmplt(0.5 * (bp.size().min(bq.size()))).all();
        let moves = apart.abs().cmpgt((bq.size() - bp.size()).abs());
        let shift = if over { DVec2::select(moves, apart, DVec2::ZERO) } else { apart };
        let step = self.settings.step_mm();
        let pairing = if self.settings.features {
            by_features(p, q, step, self.settings.feature_points(), shift)
        } else {
            dynamic(p, q, step, shift)
        };
        // A pairing that folds over itself halfway has failed: its signed area differs from the area it covers. A pairing
        // that covers more halfway than at both ends has slid along the contour and has failed too.
        let middle = pairing.at(0.5);
        let covered: f64 = Region::from_contours(std::iter::once(&middle), FillRule::NonZero).area_mm2();
        let signed = signed_area_mm2(&middle);
        let (a, b) = (signed_area_mm2(p), signed_area_mm2(q));
        // 2 % and a pixel: folds of that size vanish when contours are united.
        let unlike = (covered - signed).abs() > 0.02 * signed + step * step;
        if signed < 0.5 * a.min(b) || signed > most_mm2(a, b, step) || unlike {
            return None;
        }
        slab.moving.push(pairing);
        Some(())
    }
}

/// Groups the entities of two slices. Entities belong together where one covers at least `overlap` of the
/// other; leftovers of similar size that lie side by side are added.
pub fn match_entities(lower: &[Polygon], upper: &[Polygon], overlap: f64) -> Vec<Group> {
    let n = lower.len();
    let mut groups = DisjointSets::new(n + upper.len());
    let bounds = |p: &Polygon| p.bounds().unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
    let (bl, bu): (Vec<_>, Vec<_>) = (lower.iter().map(bounds).collect(), upper.iter().map(bounds).collect());
    let (al, au): (Vec<_>, Vec<_>) =
        (lower.iter().map(Polygon::area_mm2).collect(), upper.iter().map(Polygon::area_mm2).collect());
    let (mut free_l, mut free_u) = (vec![true; n], vec![true; upper.len()]);
    for i in 0..n {
        for j in (0..upper.len()).filter(|&j| bl[i].meets(bu[j])) {
            let (a, b) = (Region::from(lower[i].clone()), Region::from(upper[j].clone()));
            let shared = a.intersection(&b).area_mm2();
            // Either share counts, so that a small branch belongs to a large trunk.
            if shared > overlap * al[i] || shared > overlap * au[j] {
                groups.union(i, n + j);
                (free_l[i], free_u[j]) = (false, false);
            }
        }
    }
    // Entities that moved by more than their own thickness between slices: the nearest of similar size.
    let mut near: Vec<(f64, usize, usize)> = Vec::new();
    for i in (0..n).filter(|&i| free_l[i]) {
        for j in (0..upper.len()).filter(|&j| free_u[j]) {
            let apart = (bl[i].centre() - bu[j].centre()).length();
            let like = al[i] < 2.0 * au[j] && au[j] < 2.0 * al[i];
            if like && apart < 0.75 * (bl[i].size().max_element() + bu[j].size().max_element()) {
                near.push((apart, i, j));
            }
        }
    }
    // Ties in distance are ordered by index.
    near.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    for (_, i, j) in near {
        if free_l[i] && free_u[j] {
            groups.union(i, n + j);
            (free_l[i], free_u[j]) = (false, false);
        }
    }
    let mut slots = vec![usize::MAX; n + upper.len()];
    let mut out: Vec<Group> = Vec::new();
    // Groups are numbered by their first entity, so the order does not depend on how sets were joined.
    for k in 0..n + upper.len() {
        let r = groups.lowest(k);
        if slots[r] == usize::MAX {
            slots[r] = out.len();
            out.push(Group::default());
        }
        let group = &mut out[slots[r]];
        if k < n { group.lower.push(k) } else { group.upper.push(k - n) }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::math::direction;

    const SETTINGS: MatchSettings =
        MatchSettings { overlap: 0.2, pixel_mm: DVec2::new(0.2, 0.2), features: false };

    fn disc(x: f64, y: f64, r: f64) -> Polygon {
        let point = |i: i32| DVec2::new(x, y) + r * direction(f64::from(i) / 90.0 * std::f64::consts::TAU);
        Polygon { outer: (0..90).map(point).collect(), holes: Vec::new() }
    }

    fn ring(r: f64, hole: f64) -> Polygon {
        let mut p = disc(0.0, 0.0, r);
        let mut h = disc(0.0, 0.0, hole).outer;
        h.reverse();
        p.holes.push(h);
        p
    }

    fn between(a: &[Polygon], b: &[Polygon], features: bool) -> Slab {
        let region = |p: &[Polygon]| Region { polygons: p.to_vec() };
        Slab::between(&region(a), &region(b), &MatchSettings { features, ..SETTINGS }, &|_, _| 0.3)
    }

    #[test]
    fn rings_stay_rings_and_discs_are_born_and_die() {
        for features in [false, true] {
            let slab = between(&[ring(10.0, 5.0)], &[ring(12.0, 4.0)], features);
            let middle = slab.at(0.5);
            assert_eq!((middle.polygons.len(), middle.polygons[0].holes.len()), (1, 1));
            let truth = std::f64::consts::PI * (121.0 - 4.5 * 4.5);
            assert!((middle.area_mm2() / truth - 1.0).abs() < 0.01, "{} {truth}", middle.area_mm2());
            let slab = between(&[disc(0.0, 0.0, 3.0)], &[disc(50.0, 0.0, 3.0)], features);
            assert_eq!(slab.events, Events { births: 1, deaths: 1, branches: 0 });
            let count = |t: f64| slab.at(t).polygons.len();
            assert_eq!((count(0.1), count(0.5)), (1, 1));
        }
    }

    #[test]
    fn a_thin_wall_that_leans_is_followed_without_overlap() {
        let wall = |x: f64| Region::rectangle(DVec2::new(x, 0.0), DVec2::new(x + 0.6, 20.0)).polygons;
        let slab = between(&wall(0.0), &wall(1.0), false);
        let middle = slab.at(0.5);
        assert_eq!(middle.polygons.len(), 1);
        let bounds = middle.bounds().expect("a wall");
        assert!((bounds.min.x - 0.5).abs() < 0.02 && (middle.area_mm2() - 12.0).abs() < 0.1);
    }

    #[test]
    fn a_ring_whose_mouth_moves_is_not_filled() {
        let open = |angle: f64| {
            let mouth = 12.0 * direction(angle);
            let knife = vec![DVec2::ZERO, mouth, mouth + 4.0 * direction(angle + 1.57)];
            let knife = Region::from_contours(std::iter::once(&knife), FillRule::NonZero);
            Region::from(ring(10.0, 8.5)).difference(&knife).polygons
        };
        for (features, turn) in [(false, 0.4), (false, 2.5), (true, 0.4), (true, 2.5)] {
            let (a, b) = (open(3.4), open(3.4 + turn));
            let middle = between(&a, &b, features).at(0.5);
            let most = a[0].area_mm2().max(b[0].area_mm2());
            assert!(middle.area_mm2() < 1.1 * most, "{features} {turn}: {} {most}", middle.area_mm2());
            assert!(middle.area_mm2() > 0.7 * most, "{features} {turn}: {} {most}", middle.area_mm2());
        }
    }

    #[test]
    fn a_ring_that_closes_keeps_its_inside_empty() {
        let closed = Region::from(ring(10.0, 8.5));
        let knife = Region::rectangle(DVec2::new(0.0, -2.0), DVec2::new(12.0, 2.0));
        let open = closed.difference(&knife);
        for features in [false, true] {
            let middle = between(&open.polygons, &closed.polygons, features).at(0.5);
            let (a, b) = (open.area_mm2(), closed.area_mm2());
            assert!(
                middle.area_mm2() < 1.05 * b && middle.area_mm2() > 0.9 * a,
                "{} {a} {b}",
                middle.area_mm2()
            );
        }
    }

    #[test]
    fn branches_part_and_meet_and_everything_in_between_hangs_together() {
        let bar = Region::rectangle(DVec2::new(-10.0, -3.0), DVec2::new(10.0, 3.0)).polygons;
        let two = [disc(-7.0, 0.0, 2.0), disc(7.0, 0.0, 2.0)];
        for features in [false, true] {
            let slab = between(&bar, &two, features);
            assert_eq!(slab.events.branches, 1);
            assert_eq!(slab.at(0.5).polygons.len(), 2);
            assert!((slab.at(0.0).area_mm2() - 120.0).abs() < 0.1);
            let truth = 8.0 * std::f64::consts::PI;
            assert!((slab.at(1.0).area_mm2() / truth - 1.0).abs() < 0.01);
        }
        // Many to many goes by distances, and so does a ring that opens.
        let crossed = [disc(0.0, -7.0, 2.5), disc(0.0, 7.0, 2.5)];
        let plus = [
            Region::rectangle(DVec2::new(-9.0, -8.0), DVec2::new(9.0, -6.0)).polygons.remove(0),
            Region::rectangle(DVec2::new(-9.0, 6.0), DVec2::new(9.0, 8.0)).polygons.remove(0),
        ];
        assert_eq!(between(&crossed, &plus, false).at(0.5).polygons.len(), 2);
        let open = Region { polygons: vec![ring(10.0, 6.0)] }
            .difference(&Region::rectangle(DVec2::new(5.0, -2.0), DVec2::new(11.0, 2.0)));
        let slab = between(&[ring(10.0, 6.0)], &open.polygons, false);
        let (early, late) = (slab.at(0.05), slab.at(0.95));
        assert_eq!((early.polygons.len(), early.polygons[0].holes.len()), (1, 1));
        assert_eq!((late.polygons.len(), late.polygons[0].holes.len()), (1, 0));
    }
}
