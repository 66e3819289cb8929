//! Ends of beads that stand on each other from layer to layer.
//!
//! Where a bead ends, starts or turns back, the fill is weaker than along it. In one layer that is harmless; in a column
//! of layers it is a joint through the part. Counted are the places of infill where an open path begins and ends, where
//! a closed path begins, and where a path turns back beside itself (a hairpin).
//!
//! A column is a square of `COLUMN_MM` of a grid. Its places are stacked where more than a third of the layers with
//! infill have one in it, a third being rounded up, or more than `LONGEST_RUN` layers in a row. Where beads meet the
//! border of the infill across, each of them ends there, and less than a column apart: these places are counted by
//! themselves.
//!
//! Lengths are in mm. Cost: linear in the vertices of the infill, and a search around each place for the border.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::poly::edges;
use crate::segments::Segments;
use crate::{DVec2, LayerPlan, LayerStack, Role, Toolpath};

/// Side of a column, mm. Source: derived; about two beads of the usual width, so that neighbouring ends
/// count as one place.
const COLUMN_MM: f64 = 1.0;
/// So many layers in a row may have a place in the same column. Source: as [`COLUMN_MM`].
const LONGEST_RUN: usize = 3;
/// A path turns back where its direction changes by 150 degrees or more: the cosine of that. Source: derived; the joint
/// of two parallel beads turns by 180 degrees, and a corner of a contour by 120 at most but for splinters.
const BACK_COS: f64 = -0.866;
/// The length within which it turns back, in widths. Source: derived; half a circle between two beads side by side is 1.6
/// widths long, and the corners of a square joint lie one width apart.
const BACK_WIDTHS: f64 = 2.0;
/// A place lies at the border of the infill up to this distance from it, in widths. Source: derived; the last
/// centreline lies half a width from the border, and the middle of a hairpin half a width before that.
const AT_BORDER_WIDTHS: f64 = 1.5;

/// How many of the places where beads end are stacked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stacked {
    /// Layers with infill.
    pub layers: usize,
    /// Places inside the infill.
    pub inside: Places,
    /// Places at the border of the infill.
    pub at_border: Places,
}

/// Places where beads end, all at the border or all inside.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Places {
    /// Number of places in all layers.
    pub n: usize,
    /// Those of them that lie in columns with too many layers.
    pub stacked: usize,
    /// The most layers with a place in one column.
    pub most_layers: usize,
    /// The middle of that column, in part coordinates, mm.
    pub most_at_mm: [f64; 2],
    /// The most layers in a row with a place in one column.
    pub longest_run: usize,
}

/// The layers with a place, ascending, and the number of places, of each column.
type Columns = BTreeMap<[i32; 2], (Vec<u32>, usize)>;

impl Places {
    fn count(columns: &Columns, n_layers: usize) -> Self {
        let third = n_layers.div_ceil(3);
        let is_stacked = |layers: &[u32]| layers.len() > third || longest_run(layers) > LONGEST_RUN;
        // The first one among equals.
        let most = columns.iter().max_by(|a, b| a.1.0.len().cmp(&b.1.0.len()).then(b.0.cmp(a.0)));
        let middle = |c: i32| (f64::from(c) + 0.5) * COLUMN_MM;
        Self {
            n: columns.values().map(|c| c.1).sum(),
            stacked: columns.values().filter(|c| is_stacked(&c.0)).map(|c| c.1).sum(),
            most_layers: most.map_or(0, |m| m.1.0.len()),
            most_at_mm: most.map_or([0.0; 2], |m| m.0.map(middle)),
            longest_run: columns.values().map(|c| longest_run(&c.0)).max().unwrap_or(0),
        }
    }
}

/// Counts the places of a plan; `None` where it has no infill.
#[must_use]
pub fn count(layers: &[LayerPlan], stack: &LayerStack) -> Option<Stacked> {
    // Columns of places inside and at the border: the layers with a place, ascending, and the number of places.
    let mut columns: [Columns; 2] = Default::default();
    let mut n_layers = 0_usize;
    for (plan, layer) in layers.iter().zip(stack.layers()) {
        let infill = || plan.paths.iter().map(|p| &p.path).filter(|p| is_infill(p.role));
        if infill().next().is_none() {
            continue;
        }
        // Layers without infill, such as those of a hollow, do not part the ones below and above.
        let number = n_layers as u32;
        n_layers += 1;
        let walls = plan.paths.iter().map(|p| &p.path).filter(|p| is_wall(p.role));
        let outlines = layer.region().contours().flat_map(|c| edges(c));
        let mut border: Vec<[DVec2; 2]> = outlines.map(<[DVec2; 2]>::from).collect();
        border.extend(walls.flat_map(|w| (0..w.n_segments()).map(|i| [w.segment(i).0, w.segment(i).1])));
        let border = Segments::new(border, COLUMN_MM);
        for path in infill() {
            for (place, width_mm) in places(path) {
                let is_inside = border.within(place, AT_BORDER_WIDTHS * width_mm).next().is_none();
                let at = (place / COLUMN_MM).floor();
                let column = columns[usize::from(!is_inside)].entry([at.x as i32, at.y as i32]).or_default();
                if column.0.last() != Some(&number) {
                    column.0.push(number);
                }
                column.1 += 1;
            }
        }
    }
    if n_layers == 0 {
        return None;
    }
    let [inside, at_border] = columns.map(|c| Places::count(&c, n_layers));
    Some(Stacked { layers: n_layers, inside, at_border })
}

fn is_infill(role: Role) -> bool {
    matches!(role, Role::SolidFill | Role::TopSkin | Role::SparseFill | Role::Fibre | Role::SeedLine)
}

fn is_wall(role: Role) -> bool {
    matches!(role, Role::OuterWall | Role::InnerWall | Role::ThinWall)
}

/// The most numbers that follow each other in an ascending list.
fn longest_run(numbers: &[u32]) -> usize {
    numbers.chunk_by(|a, b| a + 1 == *b).map(<[u32]>::len).max().unwrap_or(0)
}

/// Where a path begins, ends and turns back, each with its width there.
fn places(path: &Toolpath) -> Vec<(DVec2, f64)> {
    let last = path.points.len().saturating_sub(1);
    let mut out = Vec::new();
    if path.points.is_empty() {
        return out;
    }
    out.push((path.points[0], path.width_at(0)));
    let begins_where_it_ends = path.closed || path.points[0].distance(path.points[last]) < 1e-3;
    if !begins_where_it_ends {
        out.push((path.points[last], path.width_at(last)));
    }
    let pieces: Vec<(DVec2, DVec2)> = (0..path.n_segments())
        .map(|i| (path.segment(i).0, path.segment(i).1))
        .filter(|p| p.0 != p.1)
        .collect();
    let along = |i: usize| (pieces[i].1 - pieces[i].0).normalize_or_zero();
    let mut i = 0;
    while i < pieces.len() {
        let reach_mm = BACK_WIDTHS * path.width_at(i.min(last));
        let mut turned_mm = 0.0;
        let back = (i + 1..pieces.len()).find_map(|j| {
            // `None` ends the search as soon as the turn is too long to be a hairpin.
            if turned_mm > reach_mm {
                return Some(None);
            }
            turned_mm += pieces[j].0.distance(pieces[j].1);
            (along(i).dot(along(j)) < BACK_COS).then_some(Some(j))
        });
        match back.flatten() {
            Some(j) => {
                out.push((pieces[i].1.midpoint(pieces[j].0), path.width_at(i.min(last))));
                i = j;
            }
            None => i += 1,
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layer, PlannedPath, Region, Travel};

    /// Layers of a square of 20 mm, each with these lines.
    fn plan(lines: &dyn Fn(usize) -> Vec<Vec<[f64; 2]>>) -> (Vec<LayerPlan>, LayerStack) {
        let section = Region::rectangle(DVec2::ZERO, DVec2::splat(20.0));
        let n = 9;
        let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section.clone()).expect("a layer");
        let path = |points: Vec<[f64; 2]>| PlannedPath {
            travel: Travel::default(),
            path: Toolpath::new(points.into_iter().map(DVec2::from).collect(), 0.45, Role::SolidFill, false),
        };
        let planned = |i: usize| LayerPlan {
            z_top_mm: 0.2 * (i + 1) as f64,
            height_mm: 0.2,
            paths: lines(i).into_iter().map(path).collect(),
        };
        let stack = LayerStack::new((0..n).map(layer).collect()).expect("a stack");
        ((0..n).map(planned).collect(), stack)
    }

    #[test]
    fn ends_are_told_from_hairpins_and_by_their_place() {
        // From the border to the middle, back beside itself, and along a corner: one end of two at the border, and one
        // hairpin.
        let path = vec![[0.3, 5.2], [10.2, 5.2], [10.2, 5.6], [4.2, 5.6], [4.2, 9.2]];
        let (layers, stack) = plan(&|_| vec![path.clone()]);
        let found = count(&layers, &stack).expect("infill");
        assert_eq!((found.inside.n, found.at_border.n, found.layers), (18, 9, 9));
        assert_eq!((found.inside.stacked, found.inside.most_layers, found.inside.longest_run), (18, 9, 9));
        assert_eq!((found.at_border.stacked, found.at_border.most_at_mm), (9, [0.5, 5.5]));
    }

    #[test]
    fn a_third_of_the_layers_and_three_in_a_row_are_allowed() {
        let at = |x: f64| vec![vec![[x, 5.5], [x, 15.5]]];
        let in_turn = plan(&|i| at(5.5 + 2.0 * (i % 3) as f64));
        let inside = |plan: &(Vec<LayerPlan>, LayerStack)| {
            count(&plan.0, &plan.1).map(|f| (f.inside.stacked, f.inside.most_layers, f.inside.longest_run))
        };
        assert_eq!(inside(&in_turn), Some((0, 3, 1)));
        let in_pairs = plan(&|i| at(5.5 + 2.0 * (i % 2) as f64));
        // Five and four of nine layers.
        assert_eq!(inside(&in_pairs), Some((18, 5, 1)));
        assert_eq!(longest_run(&[0, 1, 3, 4, 5, 6, 9]), 4);
        assert_eq!(count(&[], &in_turn.1), None);
    }
}
