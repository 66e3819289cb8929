//! Lays the walls of a polygon that regions divide, and finds the areas for infill in each region.
//!
//! Regions may ask for different numbers of walls. Loops that all of them have stay whole. A loop that only some have is
//! cut along their borders into open walls, and single beads are cut likewise. On both sides of a border the area for infill
//! ends at such a distance that the strips of the beads meet at the border:
//!
//! ```text
//!     region      |     rest           each side is shrunk by `inset`, half a strip: the outermost
//!    ===========  |  ===========       bead lies on the edge of its area
//!          inset >|< inset
//! ```
//!
//! A piece too narrow for a bead, such as a strip between the side of a box and a wall, goes to its neighbour. Units: mm.
//! Cost: the walls are laid once for each number of walls, with a few booleans and offsets for each polygon. Polygons that
//! no region meets cost nothing more.

use std::collections::BTreeMap;

use grainpath_core::poly::LineClipper;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{BeadWidth, Polygon, Region, Toolpath};

use super::{MIN_GAP_MM2, MIN_LOOP_MM, MITER, Wall, WallSettings, Walls, lay_walls};

/// Pieces narrower than this share of a strip go to their neighbour. Source: derived. A strip shrunk by half of its width
/// on both sides has no area left for a centreline; the surplus covers rounding to the grid of the booleans.
const NARROW: f64 = 1.02;
/// How far a leftover may lie from the region that gets it, mm. Source: derived. Ten times the grid of the booleans.
const TOUCH_MM: f64 = 1e-3;

/// The area and the walls of a region, or of the rest of the part.
#[derive(Debug, Clone, Copy)]
pub struct Share<'a> {
    /// Area of the region in this layer; not used for the rest of the part.
    pub area: &'a Region,
    /// Number of walls.
    pub n_walls: usize,
    /// Distance of infill centrelines from the border of the area, mm.
    pub inset_mm: f64,
}

/// The walls of a polygon, and the areas for the centrelines of infill in each region.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DividedWalls {
    /// Walls, single beads, and the area for infill outside all regions.
    pub rest: Walls,
    /// The areas for infill in the regions, in their order.
    pub regions: Vec<Region>,
}

/// Lays the walls of a polygon in which each region has its own number of walls. Areas of regions must not overlap.
pub(crate) fn lay_divided(
    polygon: &Polygon,
    settings: &WallSettings,
    rest: Share<'_>,
    regions: &[Share<'_>],
) -> DividedWalls {
    let section = Region::from(polygon.clone());
    let zones: Vec<Region> = regions.iter().map(|r| section.intersection(r.area)).collect();
    let meets = |zone: &Region| zone.area_mm2() > MIN_GAP_MM2;
    if !zones.iter().any(meets) {
        let rest = lay_walls(polygon, &WallSettings { n_walls: rest.n_walls, ..*settings });
        return DividedWalls { rest, regions: vec![Region::default(); regions.len()] };
    }
    let open = zones.iter().fold(section, |open, zone| open.difference(zone));
    // The rest is the last of all zones.
    let shares: Vec<(Share<'_>, Region)> = regions.iter().copied().zip(zones).chain([(rest, open)]).collect();
    let mut laid: BTreeMap<usize, Walls> = BTreeMap::new();
    for (share, _) in shares.iter().filter(|s| meets(&s.1)) {
        let n_walls = share.n_walls;
        laid.entry(n_walls).or_insert_with(|| lay_walls(polygon, &WallSettings { n_walls, ..*settings }));
    }
    let numbers: Vec<(usize, &Region)> = shares.iter().map(|(share, zone)| (share.n_walls, zone)).collect();
    let mut walls = cut_walls(&numbers, &laid, settings);
    let mut fills = areas(&shares, &laid, settings);
    walls.fill = fills.pop().unwrap_or_default();
    DividedWalls { rest: walls, regions: fills }
}

/// Cuts walls and single beads to zones, each of which has its own number of walls.
pub(super) fn cut_walls(
    zones: &[(usize, &Region)],
    laid: &BTreeMap<usize, Walls>,
    settings: &WallSettings,
) -> Walls {
    let mut walls = Walls::default();
    let (Some((&fewest, common)), Some((&most, all))) = (laid.first_key_value(), laid.last_key_value())
    else {
        return walls;
    };
    walls.loops.clone_from(&common.loops);
    if fewest == most {
        walls.singles.clone_from(&common.singles);
        return walls;
    }
    let zone = |has: &dyn Fn(usize) -> bool| {
        let mine = zones.iter().filter(|(n_walls, _)| has(*n_walls));
        mine.fold(Region::default(), |zone, (_, own)| zone.union(own))
    };
    let s = bead_spacing_mm(settings.bead_width_mm, settings.height_mm);
    for depth in fewest..most {
        // The end of a wall keeps as far from the border as infill does.
        let zone = zone(&|n| n > depth).offset(-0.5 * s, MITER);
        let clipper = LineClipper::new(&zone);
        for wall in all.loops.iter().filter(|w| w.depth == depth) {
            let mut pieces = cut(&wall.path, &clipper);
            match pieces.pop_if(|only| only.closed) {
                Some(path) => walls.loops.push(Wall { path, depth }),
                None => walls.singles.extend(pieces.into_iter().filter(|p| p.length_mm() > MIN_LOOP_MM)),
            }
        }
    }
    for (&n, own) in laid {
        let clipper = LineClipper::new(&zone(&|other| other == n));
        let pieces = own.singles.iter().flat_map(|single| cut(single, &clipper));
        walls.singles.extend(pieces.filter(|p| p.length_mm() > MIN_LOOP_MM));
    }
    walls
}

/// The pieces of a path in a zone; a closed path that lies in it whole stays closed.
fn cut(path: &Toolpath, zone: &LineClipper) -> Vec<Toolpath> {
    let mut points = path.points.clone();
    points.extend(path.closed.then(|| path.start()));
    let last = (points.len() - 1) as f64;
    let mut pieces = zone.clip(&points);
    if pieces.len() == 1 && pieces[0].points.len() == points.len() && pieces[0].at.last() == Some(&last) {
        return vec![path.clone()];
    }
    // The start of a loop is arbitrary, so the first and the last piece of a cut loop are joined there.
    if path.closed
        && pieces.len() > 1
        && pieces[0].at[0] == 0.0
        && pieces[pieces.len() - 1].at.last() == Some(&last)
    {
        let first = pieces.remove(0);
        let end = pieces.len() - 1;
        pieces[end].points.extend(first.points.into_iter().skip(1));
        pieces[end].at.extend(first.at.into_iter().skip(1));
    }
    let n = path.points.len();
    let width = |at: f64| {
        let (a, b) = (at.floor() as usize % n, (at.floor() as usize + 1) % n);
        path.width_at(a) + (path.width_at(b) - path.width_at(a)) * at.fract()
    };
    let piece = |p: grainpath_core::poly::ClippedLine| Toolpath {
        width: match &path.width {
            BeadWidth::Constant(mm) => BeadWidth::Constant(*mm),
            BeadWidth::PerVertex(_) => BeadWidth::PerVertex(p.at.iter().map(|&at| width(at)).collect()),
        },
        points: p.points,
        closed: false,
        ..path.clone()
    };
    pieces.into_iter().map(piece).collect()
}

/// The area for the centrelines of infill of each share.
fn areas(
    shares: &[(Share<'_>, Region)],
    laid: &BTreeMap<usize, Walls>,
    settings: &WallSettings,
) -> Vec<Region> {
    let s = bead_spacing_mm(settings.bead_width_mm, settings.height_mm);
    let narrow = 0.5 * NARROW * s;
    let none = Walls::default();
    let walls = |share: &Share<'_>| laid.get(&share.n_walls).unwrap_or(&none);
    // `whole` is the area that each share is to fill; `wide` lacks the places too narrow for a bead.
    let whole: Vec<Region> = shares
        .iter()
        .map(|(share, zone)| zone.intersection(&walls(share).fill.offset(0.5 * s, MITER)))
        .collect();
    let mut wide: Vec<Region> =
        whole.iter().map(|w| w.offset(-narrow, MITER).offset(narrow, MITER).intersection(w)).collect();
    for (k, whole) in whole.iter().enumerate() {
        for left in whole.difference(&wide[k]).polygons.into_iter().filter(|p| p.area_mm2() > MIN_GAP_MM2) {
            let left = Region::from(left);
            let near = left.offset(TOUCH_MM, MITER);
            // Of several neighbours the last in the list wins: the rest of the part, or else the last region.
            let touches = |&other: &usize| other != k && !wide[other].intersection(&near).is_empty();
            if let Some(other) = (0..wide.len()).rev().find(touches) {
                // The leftover is grown a little, so that it becomes one polygon with the neighbour's area.
                wide[other] = wide[other].union(&near.difference(&wide[k]));
            }
        }
    }
    shares
        .iter()
        .zip(wide)
        .map(|((share, _), wide)| wide.offset(-share.inset_mm, MITER).intersection(&walls(share).fill))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::failure_svg::FailurePicture;
    use grainpath_core::math::{direction, rotated};
    use grainpath_core::{DVec2, Role};

    const SETTINGS: WallSettings = WallSettings {
        n_walls: 2,
        bead_width_mm: 0.45,
        height_mm: 0.2,
        thin_walls: true,
        gap_fill: true,
        min_bead_width_mm: 0.2,
        fill_overlap: 0.0,
    };

    /// A plate of 30 x 20 mm and a region that covers its right half from x = 15, both turned.
    fn halves(turn_rad: f64, from_mm: f64) -> (Polygon, Region) {
        let turn = direction(turn_rad);
        let turned = |r: Region| {
            let point = |p: &DVec2| rotated(*p, turn);
            let outer = r.polygons[0].outer.iter().map(point).collect();
            Polygon { outer, holes: Vec::new() }
        };
        let plate = Region::rectangle(DVec2::ZERO, DVec2::new(30.0, 20.0));
        let right = Region::rectangle(DVec2::new(from_mm, -5.0), DVec2::new(50.0, 25.0));
        (turned(plate), Region::from(turned(right)))
    }

    fn share(area: &Region, n_walls: usize) -> Share<'_> {
        Share { area, n_walls, inset_mm: 0.5 * bead_spacing_mm(0.45, 0.2) }
    }

    #[test]
    fn fills_on_both_sides_keep_half_a_strip_from_the_border() {
        let s = bead_spacing_mm(0.45, 0.2);
        for turn in [0.0, 37f64.to_radians()] {
            let (plate, right) = halves(turn, 15.0);
            let none = Region::default();
            let divided = lay_divided(&plate, &SETTINGS, share(&none, 2), &[share(&right, 2)]);
            // Two walls on three sides, half a strip from the walls and from the border.
            let depth = 0.5 * 0.45 + 2.0 * s;
            let expected = (15.0 - depth - 0.5 * s) * (20.0 - 2.0 * depth);
            let mut picture = FailurePicture::new("fills on both sides of a border");
            picture.region("part", &Region::from(plate.clone()));
            picture.region("rest", &divided.rest.fill);
            picture.region("region", &divided.regions[0]);
            for fill in [&divided.rest.fill, &divided.regions[0]] {
                assert!((fill.area_mm2() / expected - 1.0).abs() < 1e-3, "{} {expected}", fill.area_mm2());
            }
            // The same walls on both sides: no wall is cut.
            assert_eq!(divided.rest.loops, lay_walls(&plate, &SETTINGS).loops);
            assert!(divided.rest.singles.is_empty());
        }
    }

    #[test]
    fn walls_that_only_the_region_has_end_at_its_border() {
        let s = bead_spacing_mm(0.45, 0.2);
        let (plate, right) = halves(37f64.to_radians(), 15.0);
        let none = Region::default();
        let divided = lay_divided(&plate, &SETTINGS, share(&none, 2), &[share(&right, 4)]);
        let mut picture = FailurePicture::new("walls of a region");
        picture.region("region", &right);
        divided.rest.singles.iter().for_each(|wall| picture.line("open wall", &wall.points));
        assert_eq!(divided.rest.loops.len(), 2);
        assert_eq!(divided.rest.singles.len(), 2, "the third and fourth wall, open");
        for (wall, depth) in divided.rest.singles.iter().zip([2.0, 3.0]) {
            let inset = 0.225 + depth * s;
            // Out along one side, across the end, and back along the other.
            let expected = 2.0 * (15.0 - 0.5 * s - inset) + 20.0 - 2.0 * inset;
            assert!((wall.length_mm() - expected).abs() < 1e-2, "{} {expected}", wall.length_mm());
            assert!(!wall.closed && wall.role == Role::InnerWall);
        }
        let inner = 0.225 + 4.0 * s;
        let expected = (15.0 - inner - 0.5 * s) * (20.0 - 2.0 * inner);
        let found = divided.regions[0].area_mm2();
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    }

    #[test]
    fn a_piece_too_narrow_for_a_bead_goes_to_its_neighbour() {
        // The region ends 0.3 mm before the inner edge of the walls, and the rest gets no room there.
        let s = bead_spacing_mm(0.45, 0.2);
        let inner = 30.0 - 0.225 - 1.5 * s;
        let (plate, _) = halves(0.0, 15.0);
        let region = Region::rectangle(DVec2::new(15.0, -5.0), DVec2::new(inner - 0.3, 25.0));
        let none = Region::default();
        let divided = lay_divided(&plate, &SETTINGS, share(&none, 2), &[share(&region, 2)]);
        let bounds = divided.regions[0].bounds().expect("an area");
        assert!((bounds.max.x - (inner - 0.5 * s)).abs() < 5e-3, "{} {inner}", bounds.max.x);
        let rest = divided.rest.fill.bounds().expect("an area");
        assert!((rest.max.x - (15.0 - 0.5 * s)).abs() < 5e-3, "{}", rest.max.x);
        assert_eq!(divided.rest.fill.polygons.len(), 1);
    }

    #[test]
    fn a_polygon_that_no_region_meets_is_laid_as_without_regions() {
        let (plate, _) = halves(0.3, 15.0);
        let far = Region::rectangle(DVec2::splat(200.0), DVec2::splat(210.0));
        let divided = lay_divided(&plate, &SETTINGS, share(&far, 2), &[share(&far, 5)]);
        assert_eq!(divided.rest, lay_walls(&plate, &SETTINGS));
        assert!(divided.regions[0].is_empty());
    }
}
