//! Loose pieces: volumes connected over the layers, and the small ones among them that are dropped.
//!
//! # Method
//! Each island of a layer is an element of disjoint sets (`tarjan1984` in docs/references.bib). Islands
//! of neighbouring layers that overlap are united. The volume of a piece is the sum of its islands'
//! areas, without holes, times the thickness of their layers.
//!
//! # Units, cost and limits
//! Areas in mm2, volumes in mm3. The cost is one intersection of regions for each pair of islands of
//! neighbouring layers whose boxes overlap and that are not connected yet. Islands that touch in a point
//! or along an edge are not connected. Layers without a section separate what is above them from what is
//! below.

use grainpath_core::{DisjointSets, Region};

/// Drops pieces of less than `least_mm3` from a stack of sections. Returns how many were dropped.
///
/// Two islands of neighbouring layers belong to one piece where they overlap. The volume of a piece is the sum of its
/// islands' areas (without holes) times the thickness of their layers, `height_mm(layer)`. Cost: one intersection for each
/// pair of islands of neighbouring layers whose boxes overlap.
pub(super) fn drop_loose(
    layers: &mut [(usize, Region)],
    height_mm: impl Fn(usize) -> f64,
    least_mm3: f64,
) -> usize {
    // Islands of all layers are numbered through; `starts` holds the first number of each layer.
    let starts: Vec<usize> = layers
        .iter()
        .scan(0, |n, (_, region)| {
            let start = *n;
            *n += region.polygons.len();
            Some(start)
        })
        .collect();
    let n_islands: usize = layers.iter().map(|(_, region)| region.polygons.len()).sum();
    let mut pieces = DisjointSets::new(n_islands);
    for (k, pair) in layers.windows(2).enumerate() {
        // Layers without a section are missing from the list, and nothing connects across them.
        if pair[1].0 != pair[0].0 + 1 {
            continue;
        }
        for (i, low) in pair[0].1.polygons.iter().enumerate() {
            let Some(box_low) = low.bounds() else { continue };
            for (j, high) in pair[1].1.polygons.iter().enumerate() {
                let apart = high
                    .bounds()
                    .is_none_or(|b| b.min.cmpgt(box_low.max).any() || b.max.cmplt(box_low.min).any());
                let (a, b) = (starts[k] + i, starts[k + 1] + j);
                // Intersections are the cost of this function, so islands already connected are not
                // intersected again.
                if apart || pieces.lowest(a) == pieces.lowest(b) {
                    continue;
                }
                let common = Region::from(low.clone()).intersection(&Region::from(high.clone()));
                if !common.is_empty() {
                    pieces.union(a, b);
                }
            }
        }
    }
    let mut volume_mm3 = vec![0.0; n_islands];
    for (k, (layer, region)) in layers.iter().enumerate() {
        for (i, polygon) in region.polygons.iter().enumerate() {
            volume_mm3[pieces.lowest(starts[k] + i)] += polygon.area_mm2() * height_mm(*layer);
        }
    }
    for (k, (_, region)) in layers.iter_mut().enumerate() {
        let mut i = starts[k];
        region.polygons.retain(|_| {
            let keep = volume_mm3[pieces.lowest(i)] >= least_mm3;
            i += 1;
            keep
        });
    }
    (0..n_islands).filter(|&n| pieces.lowest(n) == n && volume_mm3[n] < least_mm3).count()
}

#[cfg(test)]
mod tests {
    use grainpath_core::DVec2;

    use super::*;

    fn square(x: f64, side: f64) -> Region {
        Region::rectangle(DVec2::new(x, 0.0), DVec2::new(x + side, side))
    }

    /// A bar that leans, beside it a crumb as large in section but two layers high, and an island that only touches the
    /// bar from above.
    #[test]
    fn pieces_go_by_their_volume_not_by_their_sections() {
        let mut layers: Vec<(usize, Region)> = (0..10)
            .map(|k| {
                let mut region = square(0.5 * k as f64, 2.0);
                if (4..6).contains(&k) {
                    region.polygons.extend(square(20.0, 2.0).polygons);
                }
                (k, region)
            })
            .collect();
        let dropped = drop_loose(&mut layers, |_| 0.2, 2.0);
        assert_eq!(dropped, 1, "the crumb has 2 x 4 x 0.2 = 1.6 mm3, the bar 8");
        assert!(layers.iter().all(|(_, region)| region.polygons.len() == 1));
        assert_eq!(drop_loose(&mut layers, |_| 0.2, 2.0), 0);
        assert_eq!(drop_loose(&mut layers, |_| 0.2, 10.0), 1);
        assert!(layers.iter().all(|(_, region)| region.is_empty()));
    }
}
