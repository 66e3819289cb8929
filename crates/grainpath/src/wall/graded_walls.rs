//! More walls where the stress is high.
//!
//! The least number of walls runs all around. Each further wall is laid only where the stress asks for it, and ends half a
//! strip before the border of that area. The area of each wall lies within that of the wall outside it. Infill gets the area
//! that the walls leave in each place, so that it meets both the walls and their ends:
//!
//! ```text
//!     =======================   wall 1, everywhere
//!     =======================   wall 2, everywhere
//!     ||||| ----------- |||||   wall 3, where the stress asks for it; infill beside its ends
//!     ||||| ||||||||||| |||||   infill
//! ```
//!
//! Units: mm. Cost: the walls of the polygon are laid once for each number of walls that occurs in it, with three boolean
//! operations each.

use std::collections::BTreeMap;

use grainpath_core::{Polygon, Region};

use super::divided::cut_walls;
use super::{MIN_GAP_MM2, WallSettings, Walls, lay_walls};

/// Lays the walls of a polygon: the number of the settings everywhere, and one wall more in each of the areas `more`. Each
/// of these areas lies within the one before.
pub(crate) fn lay_graded(polygon: &Polygon, settings: &WallSettings, more: &[Region]) -> Walls {
    let section = Region::from(polygon.clone());
    let zones: Vec<Region> = more
        .iter()
        .map(|area| section.intersection(area))
        .take_while(|zone| zone.area_mm2() > MIN_GAP_MM2)
        .collect();
    let least = settings.n_walls;
    let lay = |n_walls: usize| lay_walls(polygon, &WallSettings { n_walls, ..*settings });
    if zones.is_empty() {
        return lay(least);
    }
    let laid: BTreeMap<usize, Walls> = (least..=least + zones.len()).map(|n| (n, lay(n))).collect();
    // A zone less the next zone is the area that gets exactly its number of walls.
    let outer = std::iter::once(&section).chain(&zones);
    let own =
        |(k, zone): (usize, &Region)| zones.get(k).map_or_else(|| zone.clone(), |next| zone.difference(next));
    let own: Vec<Region> = outer.enumerate().map(own).collect();
    let numbers: Vec<(usize, &Region)> = (least..).zip(&own).collect();
    let mut walls = cut_walls(&numbers, &laid, settings);
    let areas: Vec<&Region> = laid.values().map(|walls| &walls.fill).collect();
    let fill = areas.windows(2).zip(&zones).fold(areas[0].clone(), |fill, (area, zone)| {
        fill.difference(&area[0].difference(area[1]).intersection(zone))
    });
    walls.fill =
        Region { polygons: fill.polygons.into_iter().filter(|p| p.area_mm2() > MIN_GAP_MM2).collect() };
    walls
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::DVec2;
    use grainpath_core::units::bead_spacing_mm;

    const SETTINGS: WallSettings = WallSettings {
        n_walls: 2,
        bead_width_mm: 0.45,
        height_mm: 0.2,
        thin_walls: true,
        gap_fill: true,
        min_bead_width_mm: 0.2,
        fill_overlap: 0.0,
    };

    fn plate() -> Polygon {
        Region::rectangle(DVec2::ZERO, DVec2::new(40.0, 20.0)).polygons.remove(0)
    }

    fn middle(half_mm: f64) -> Region {
        Region::rectangle(DVec2::new(20.0 - half_mm, -5.0), DVec2::new(20.0 + half_mm, 25.0))
    }

    #[test]
    fn walls_are_added_where_they_are_asked_for() {
        let s = bead_spacing_mm(0.45, 0.2);
        let walls = lay_graded(&plate(), &SETTINGS, &[middle(10.0), middle(5.0)]);
        assert_eq!(walls.loops.len(), 2, "two all around");
        // The third on both sides over 20 mm, the fourth over 10 mm, each without half a strip at its ends.
        let mut lengths: Vec<f64> = walls.singles.iter().map(|p| p.length_mm()).collect();
        lengths.sort_by(f64::total_cmp);
        let expected = [10.0 - s, 10.0 - s, 20.0 - s, 20.0 - s];
        assert_eq!(lengths.len(), 4, "{lengths:?}");
        assert!(lengths.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-2), "{lengths:?}");
        // Infill loses their strips.
        let without = lay_walls(&plate(), &SETTINGS).fill.area_mm2();
        let lost = without - walls.fill.area_mm2();
        assert!((lost - 2.0 * s * 30.0).abs() < 0.05, "{lost}");
    }

    #[test]
    fn without_places_or_with_all_of_the_part_the_walls_close() {
        assert_eq!(lay_graded(&plate(), &SETTINGS, &[]), lay_walls(&plate(), &SETTINGS));
        let far = Region::rectangle(DVec2::splat(200.0), DVec2::splat(210.0));
        assert_eq!(lay_graded(&plate(), &SETTINGS, &[far]), lay_walls(&plate(), &SETTINGS));
        let all = lay_graded(&plate(), &SETTINGS, &[middle(50.0)]);
        let three = lay_walls(&plate(), &WallSettings { n_walls: 3, ..SETTINGS });
        assert_eq!((all.loops.len(), all.singles.len()), (3, 0));
        assert!((all.fill.area_mm2() - three.fill.area_mm2()).abs() < 1e-3);
    }
}
