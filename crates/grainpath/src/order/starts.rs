//! Starts of closed infill paths.
//!
//! A start is a weak place, and the shortest travel leads to the same one in every layer. So a start keeps a distance from
//! those of the layers below where the job asks for it. Lengths are in mm. Cost: vertices of the closed paths times the
//! starts below.

use grainpath_core::{DVec2, Toolpath};

/// So many layers below are looked at. Source: derived; a place is then met in every third layer at most.
const LAYERS: usize = 2;

/// Finds starts layer by layer.
#[derive(Debug, Clone, Default)]
pub(super) struct Starts {
    /// Least distance from a start in one of the layers below, mm; 0 for none.
    apart_mm: f64,
    below: [Vec<DVec2>; LAYERS],
    here: Vec<DVec2>,
}

impl Starts {
    pub(super) fn new(apart_mm: f64) -> Self {
        Self { apart_mm, ..Self::default() }
    }

    pub(super) fn next_layer(&mut self) {
        self.below.rotate_right(1);
        self.below[0] = std::mem::take(&mut self.here);
    }

    /// Lets a closed path begin at the vertex nearest to `at`, of those far enough from the starts below.
    pub(super) fn place(&mut self, path: &mut Toolpath, at: DVec2) {
        let apart = self.apart_mm * self.apart_mm;
        let free = |p: &DVec2| self.below.iter().flatten().all(|b| b.distance_squared(*p) >= apart);
        let allowed = path.points.iter().enumerate().filter(|(_, p)| free(p));
        let nearest = allowed.min_by(|a, b| a.1.distance_squared(at).total_cmp(&b.1.distance_squared(at)));
        match nearest {
            Some((start, _)) => path.rotate_to(start),
            None => start_nearest(path, at),
        }
        if self.apart_mm > 0.0 {
            self.here.push(path.start());
        }
    }
}

/// Lets a closed path start at the vertex nearest to `at`; reverses an open path whose end is nearer to `at`.
pub(super) fn start_nearest(path: &mut Toolpath, at: DVec2) {
    if path.closed {
        let near = path.points.iter().map(|p| p.distance_squared(at)).enumerate();
        let start = near.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |n| n.0);
        path.rotate_to(start);
    } else if path.end().distance_squared(at) < path.start().distance_squared(at) {
        path.reverse();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::Role;
    use grainpath_core::polyline::resampled;

    /// A closed square of `side_mm` with a vertex each mm, from its corner at the origin.
    fn square(side_mm: f64) -> Toolpath {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|c| side_mm * DVec2::from(c));
        Toolpath::new(resampled(&corners, true, 1.0), 0.45, Role::SolidFill, true)
    }

    /// The starts of this path in six layers, each entered from a point just outside its first corner.
    fn in_layers(path: &Toolpath, apart_mm: f64) -> [DVec2; 6] {
        let mut starts = Starts::new(apart_mm);
        [0; 6].map(|_| {
            starts.next_layer();
            let mut path = path.clone();
            starts.place(&mut path, DVec2::new(-0.2, -0.1));
            path.start()
        })
    }

    #[test]
    fn a_start_keeps_its_distance_from_those_of_two_layers_below() {
        let found = in_layers(&square(10.0), 1.5);
        let expect = [DVec2::ZERO, DVec2::new(0.0, 2.0), DVec2::new(2.0, 0.0)];
        // The start of three layers below is free again.
        for (found, expect) in found.iter().zip(expect.iter().cycle()) {
            assert!(found.distance(*expect) < 1e-9, "{found} instead of {expect}");
        }
        // Without a distance, and where no vertex is free, each layer starts at the nearest.
        assert_eq!(in_layers(&square(10.0), 0.0), [DVec2::ZERO; 6]);
        assert_eq!(in_layers(&square(1.0), 1.5), [DVec2::ZERO; 6]);
    }

    #[test]
    fn starts_of_one_layer_do_not_push_each_other_away() {
        let mut starts = Starts::new(1.5);
        for _ in 0..2 {
            let mut path = square(10.0);
            starts.place(&mut path, DVec2::ZERO);
            assert_eq!(path.start(), DVec2::ZERO);
        }
    }
}
