//! Where printed material fails first: under a known stress without a finite-element solution on its cells, or in a part
//! whose cells were solved (`PlateTest::first_failures`, `SolidTest::first_failures`).
//!
//! Method under a known stress: the stress of a homogeneous part acts on the filled share of each cell of a [`Laminate`] or of
//! [`Bricks`]. All plies of a cell have the same strain, so the inverse of their mean stiffness gives the strain. In bricks a
//! field fitted to the strains around each cell takes its place (`strain_fit`), as in the virtual test. The stiffness of each ply
//! gives its stress. The failure indices of its card ([`StrengthCard::indices`], [`StrengthCard::layer_index`]) are
//! those of the virtual test. Indices grow with the load, so the load at first failure is the load divided by the highest
//! index.
//!
//! Limits: load moves from soft to stiff places of a part. Here only the filled share of a cell accounts for that; the
//! virtual test solves for it. Stresses are in MPa, order xx, yy, xy for plates and xx, yy, zz, xy, yz, zx for solids, in
//! the directions of the grid. Cost: linear in cells; bricks share stiffnesses by direction, share and bond.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use grainpath_core::dense::solve_spd;
use rayon::prelude::*;

use super::bricks::{Bricks, DIRECTIONS, SHARE_STEPS};
use super::card::{FailureMode, StrengthCard};
use super::damage::{carried_stress, damaged_plane_stiffness, damaged_stiffness, with_joined};
use super::laminate::{Laminate, Ply};
use super::load_stepping::{FailureIndices, LoadedPart};
use super::strain_fit::{ElementCells, judged_strains};
use crate::material::{Orthotropic, Stiffness, Unstable, plane_strain_along, rotated_about_z, rotated_plane};
use crate::plane::PlaneStiffness;

/// The ply of a part that fails first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstFailure {
    /// Its failure index under the given stress: the load divided by the index is the load at first failure.
    pub index: f64,
    /// The cell that it lies in.
    pub cell: usize,
    /// The direction of its beads, radians from the grid's x.
    pub angle_rad: f64,
    /// How it fails.
    pub mode: FailureMode,
}

impl FirstFailure {
    /// The failure of each ply of a cell, from their numbers and directions and from their failure indices times `scale`.
    /// Layers come apart in the whole cell, so the index that its first ply has for this counts for all of them.
    pub(super) fn of_plies(
        cell: usize,
        plies: impl Iterator<Item = ((usize, f64), FailureIndices)>,
        scale: IndexScale,
    ) -> Vec<(usize, Self)> {
        let mut apart: f64 = 0.0;
        let failure = |((ply, angle_rad), indices): ((usize, f64), FailureIndices)| {
            let [through, between, own] = indices.index;
            apart = apart.max(own * scale.between_layers);
            let index = [through * scale.in_plane, between * scale.in_plane, apart];
            let mode = mode_of(index, indices.slides[1], indices.mode);
            (ply, Self { index: index.into_iter().fold(0.0, f64::max), cell, angle_rad, mode })
        };
        plies.map(failure).collect()
    }

    /// The failure with the higher index; of equal ones that in the cell with the lower number.
    fn worse(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        match (a, b) {
            (Some(a), Some(b)) => {
                Some(if b.index > a.index || (b.index == a.index && b.cell < a.cell) { b } else { a })
            }
            (a, b) => a.or(b),
        }
    }
}

/// Factors on failure indices, for cells of another size than those for which the indices are wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IndexScale {
    /// For failure through the beads and between them.
    pub in_plane: f64,
    /// For failure between layers.
    pub between_layers: f64,
}

impl IndexScale {
    /// For indices that are wanted as they are.
    pub const ONE: Self = Self { in_plane: 1.0, between_layers: 1.0 };
}

/// The first failure for each of several cards of one material, for example with low, nominal and high strengths.
pub type OfCards<const N: usize> = [Option<FirstFailure>; N];

/// The first failures of a part, and how far each ply is from failing.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged<const N: usize> {
    /// The first failure with each card.
    pub first: OfCards<N>,
    /// The failure index of every ply of the cells with the middle one of the cards, in the order of the plies; 0 for those
    /// that were left out.
    pub of_plies: Vec<f32>,
}

/// The first failures of a part that was solved, whose cells have `n_plies` plies. `failures` gives what fails in an element
/// with each card: the number of each ply, and its failure.
pub(super) fn first_failures_of<const N: usize>(
    part: &dyn LoadedPart,
    n_plies: usize,
    failures: &(dyn Fn(usize) -> [Vec<(usize, FirstFailure)>; N] + Sync),
) -> Judged<N> {
    let breakable = (0..part.n_elements()).into_par_iter().filter(|e| !part.is_unbreakable(*e));
    let of_element = |element: usize| {
        // Strengths differ between the cards and strains do not, so each card judges the same plies.
        let all = failures(element);
        let weakest = |plies: &Vec<(usize, FirstFailure)>| {
            plies.iter().fold(None, |worst, (_, found)| FirstFailure::worse(worst, Some(*found)))
        };
        let indices: Vec<(usize, f32)> = all[N / 2].iter().map(|(ply, f)| (*ply, f.index as f32)).collect();
        (all.each_ref().map(weakest), indices)
    };
    let found: Vec<(OfCards<N>, Vec<(usize, f32)>)> = breakable.map(of_element).collect();
    // Elements hold only the cells that carry. The plies of all others keep the index of 0 and have no reserve.
    let mut of_plies = vec![0.0; n_plies];
    for (ply, index) in found.iter().flat_map(|(_, plies)| plies) {
        of_plies[*ply] = *index;
    }
    Judged { first: worst(found.into_par_iter().map(|(first, _)| first)), of_plies }
}

/// Cells that are judged one after the other, so that their plies lie beside each other in the memory. Source: chosen; a
/// run takes about a millisecond, and no result depends on it.
const RUN_OF_CELLS: usize = 4096;

/// Judges the plies of all cells. `starts` tells which plies a cell has. `judge` gives the first failure of a cell and writes
/// the indices of its plies.
fn judged<const N: usize>(
    starts: &[u32],
    judge: &(dyn Fn(usize, &mut [f32]) -> OfCards<N> + Sync),
) -> Judged<N> {
    let n = starts.len().saturating_sub(1);
    let mut of_plies = vec![0.0; starts.last().map_or(0, |end| *end as usize)];
    // The list of all indices is cut into the pieces of the runs, so that threads write to it without waiting for each
    // other and no cell needs a list of its own.
    let mut runs = Vec::new();
    let mut rest = &mut of_plies[..];
    for from in (0..n).step_by(RUN_OF_CELLS) {
        let to = (from + RUN_OF_CELLS).min(n);
        let (own, others) = rest.split_at_mut((starts[to] - starts[from]) as usize);
        runs.push((from..to, own));
        rest = others;
    }
    let of_run = |(cells, mut rest): (std::ops::Range<usize>, &mut [f32])| {
        let mut worst = [None; N];
        for cell in cells {
            let (own, others) = rest.split_at_mut((starts[cell + 1] - starts[cell]) as usize);
            let found = judge(cell, own);
            worst = std::array::from_fn(|k| FirstFailure::worse(worst[k], found[k]));
            rest = others;
        }
        worst
    };
    let first = worst(runs.into_par_iter().map(of_run));
    Judged { first, of_plies }
}

fn worst<const N: usize>(cells: impl ParallelIterator<Item = OfCards<N>>) -> OfCards<N> {
    // The order of the comparison does not matter, since the cell number decides between equal indices.
    cells.reduce(|| [None; N], |a, b| std::array::from_fn(|k| FirstFailure::worse(a[k], b[k])))
}

/// The mode of the highest of three indices: through the beads, between them, and between layers.
fn mode_of([through, between, apart]: [f64; 3], slides: bool, mode: FailureMode) -> FailureMode {
    if apart > through.max(between) {
        FailureMode::Layers
    } else if through >= between {
        if mode == FailureMode::Compression { mode } else { FailureMode::Along }
    } else if slides {
        FailureMode::Shear
    } else if mode == FailureMode::Compression {
        mode
    } else {
        FailureMode::Across
    }
}

/// The first failures of a plate for each of `N` sets of cards: `cards[k]` holds the cards of set `k` in the numbering
/// of the plies' materials. `stress` gives the stress on the filled share of a cell, `None` for cells to be left out.
///
/// # Errors
/// [`Unstable`] when the elastic constants are not those of a stable material.
pub fn first_failure_of_plate<const N: usize>(
    laminate: &Laminate,
    cards: &[Vec<StrengthCard>; N],
    stress: &(dyn Fn(usize) -> Option<[f64; 3]> + Sync),
) -> Result<Judged<N>, Unstable> {
    for card in &cards[0] {
        damaged_plane_stiffness(&card.elastic, [0.0; 2])?;
    }
    // Constants that are stable for whole plies are so for those that are joined in part.
    let own = |ply: &Ply| {
        let elastic = &cards[0][usize::from(ply.material)].elastic;
        damaged_plane_stiffness(elastic, with_joined([0.0; 2], ply.joined)).unwrap_or_default()
    };
    Ok(judged(&laminate.starts, &|cell, indices| {
        let plies = laminate.plies_in(cell);
        let thickness_mm = laminate.thickness_mm(cell);
        let mut worst = [None; N];
        if plies.is_empty() {
            return worst;
        }
        let Some(stress) = stress(cell) else { return worst };
        let mean = mean_stiffness_of_plies(
            plies.iter().map(|p| (own(p), p.angle_rad, p.thickness_mm / thickness_mm)),
        );
        let mean = strain(&mean, stress);
        for (ply, own_index) in plies.iter().zip(indices) {
            let material = usize::from(ply.material);
            // Strengths are those of whole beads, so the stress is taken on the share that carries.
            let [along, across, shear] = stress_of_ply(&own(ply), mean, ply.angle_rad);
            let stress = [along, across / ply.joined, shear / ply.joined];
            for (k, (worst, cards)) in worst.iter_mut().zip(cards).enumerate() {
                let card = &cards[material];
                let ([through, between], mode) = card.indices(stress);
                let mode = mode_of([through, between, 0.0], card.is_sliding(stress), mode);
                let index = through.max(between);
                if k == N / 2 {
                    *own_index = index as f32;
                }
                let found = FirstFailure { index, cell, angle_rad: ply.angle_rad, mode };
                *worst = FirstFailure::worse(*worst, Some(found));
            }
        }
        worst
    }))
}

/// The mean stiffness of plies that have the same strain: from the own stiffness, the direction and the share of the
/// thickness of each.
fn mean_stiffness_of_plies(plies: impl Iterator<Item = (PlaneStiffness, f64, f64)>) -> PlaneStiffness {
    let mut mean: PlaneStiffness = [[0.0; 3]; 3];
    for (own, angle_rad, share) in plies {
        let c = rotated_plane(&own, angle_rad);
        (0..9).for_each(|k| mean[k / 3][k % 3] += share * c[k / 3][k % 3]);
    }
    mean
}

/// The stress in the axes of a ply under the strain that all plies share.
fn stress_of_ply(own: &PlaneStiffness, mean_strain: [f64; 3], angle_rad: f64) -> [f64; 3] {
    let along = plane_strain_along(mean_strain, angle_rad);
    std::array::from_fn(|i| own[i].iter().zip(along).map(|(c, e)| c * e).sum())
}

/// Stacked plies of one material that have the same strain in their plane, with any directions and shares.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlyJudge {
    card: StrengthCard,
    own: PlaneStiffness,
}

impl PlyJudge {
    /// Makes the judge for plies of one card's material.
    pub(super) fn new(card: &StrengthCard) -> Result<Self, Unstable> {
        Ok(Self { card: *card, own: damaged_plane_stiffness(&card.elastic, [0.0; 2])? })
    }

    /// The failure index of the ply that fails first, for each of several plane stresses on the stack. `plies` gives the
    /// direction of each ply and its share of the thickness.
    pub(super) fn indices(&self, plies: &[(f64, f64)], stresses: &[[f64; 3]], out: &mut Vec<f64>) {
        out.clear();
        let mean = mean_stiffness_of_plies(plies.iter().map(|(angle, share)| (self.own, *angle, *share)));
        out.extend(stresses.iter().map(|stress| {
            let mean = strain(&mean, *stress);
            let index = |(angle, _): &(f64, f64)| {
                let ([through, between], _) = self.card.indices(stress_of_ply(&self.own, mean, *angle));
                through.max(between)
            };
            plies.iter().map(index).fold(0.0, f64::max)
        }));
    }
}

/// The strain under a stress.
fn strain<const K: usize>(stiffness: &[[f64; K]; K], stress: [f64; K]) -> [f64; K] {
    solve_spd(*stiffness, stress.map(|s| [s])).map(|[e]| e)
}

/// For each cell, the share of the layers' area that rests on the layer below, as the mean over the cells beside it.
/// Load moves around a cell that has less contact than those beside it: the given stress does not act on its contact alone.
fn bonds_around(bricks: &Bricks) -> Vec<f32> {
    let [nx, ny, _] = bricks.n;
    let around = |cell: usize| {
        let (i, j, layer) = (cell % nx, cell / nx % ny, cell / (nx * ny) * nx * ny);
        let beside = (j.saturating_sub(1)..=(j + 1).min(ny - 1))
            .flat_map(|j| (i.saturating_sub(1)..=(i + 1).min(nx - 1)).map(move |i| layer + j * nx + i));
        let [resting, filled] = beside.fold([0.0f32; 2], |[resting, filled], k| {
            [resting + bricks.filled[k] * bricks.bond[k], filled + bricks.filled[k]]
        });
        if bricks.filled[cell] > 0.0 { resting / filled } else { 0.0 }
    };
    (0..bricks.filled.len()).into_par_iter().map(around).collect()
}

/// What the mean stiffness of a brick depends on: the directions of its plies, the share of the second, and the bond.
type BrickKey = [u8; 4];

fn key(bricks: &Bricks, bond: f32, cell: usize) -> BrickKey {
    let plies = bricks.plies_in(cell);
    let turn = |a: f64| (a / std::f64::consts::PI * DIRECTIONS).round().rem_euclid(DIRECTIONS) as u8;
    let second = plies.get(1);
    [
        plies.first().map_or(0, |p| turn(p.angle_rad)),
        second.map_or(0, |p| turn(p.angle_rad)),
        second.map_or(0, |p| (p.share * SHARE_STEPS).round().max(1.0) as u8),
        (f64::from(bond) * SHARE_STEPS).round().max(1.0) as u8,
    ]
}

fn mean_stiffness(
    elastic: &Orthotropic,
    [first, second, share, bond]: BrickKey,
) -> Result<Stiffness, Unstable> {
    let own = damaged_stiffness(elastic, [0.0; 3], f64::from(bond) / SHARE_STEPS)?;
    let turned = |a: u8| rotated_about_z(&own, f64::from(a) / DIRECTIONS * std::f64::consts::PI);
    let (a, b, w) = (turned(first), turned(second), f64::from(share) / SHARE_STEPS);
    // Rotation leaves the matrix slightly asymmetric because of rounding.
    let mean = |i: usize, j: usize| (1.0 - w) * a[i][j] + w * b[i][j];
    Ok(std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (mean(i, j) + mean(j, i)))))
}

/// The first failures of a solid for each of `N` cards, as [`first_failure_of_plate`], with indices times `scale`.
///
/// # Errors
/// [`Unstable`] when the elastic constants are not those of a stable material.
pub fn first_failure_of_bricks<const N: usize>(
    bricks: &Bricks,
    cards: &[StrengthCard; N],
    scale: IndexScale,
    stress: &(dyn Fn(usize) -> Option<[f64; 6]> + Sync),
) -> Result<Judged<N>, Unstable> {
    let elastic = &cards[0].elastic;
    let n = bricks.filled.len();
    let bonds = bonds_around(bricks);
    let mut known: BTreeMap<BrickKey, Stiffness> = BTreeMap::new();
    for cell in (0..n).filter(|c| bricks.filled[*c] > 0.0) {
        let key = key(bricks, bonds[cell], cell);
        if let Entry::Vacant(free) = known.entry(key) {
            free.insert(mean_stiffness(elastic, key)?);
        }
    }
    // Cells without material or stress have no strain.
    let strain_of = |cell: usize| {
        let mean = known.get(&key(bricks, bonds[cell], cell)).filter(|_| bricks.filled[cell] > 0.0)?;
        Some(strain(mean, stress(cell)?))
    };
    let strains: Vec<Option<[f64; 6]>> = (0..n).into_par_iter().map(strain_of).collect();
    let (cells, strains): (Vec<u32>, Vec<[f64; 6]>) =
        strains.iter().enumerate().filter_map(|(c, strain)| Some((c as u32, (*strain)?))).unzip();
    let mut element_of = vec![None; n];
    cells.iter().enumerate().for_each(|(e, c)| element_of[*c as usize] = Some(e as u32));
    let part = ElementCells { n: bricks.n, cell_mm: bricks.cell_mm, element_of: &element_of, cells: &cells };
    let strains = judged_strains(bricks, &cards[N / 2], &part, &strains, &|_| true);
    Ok(judged(&bricks.starts, &|cell, indices| {
        let mut worst = [None; N];
        let Some(element) = element_of[cell] else { return worst };
        let strains = strains[element as usize];
        let bond = f64::from(bonds[cell]).max(1.0 / SHARE_STEPS);
        let mut apart_of_cell = 0.0;
        for (k, (ply, own_index)) in bricks.plies_in(cell).iter().zip(indices).enumerate() {
            let Ok(stress) = carried_stress(elastic, [0.0; 3], bond, strains, ply.angle_rad) else {
                return worst;
            };
            let plane = [stress[0], stress[1], stress[3]];
            for (of_card, (worst, card)) in worst.iter_mut().zip(cards).enumerate() {
                let (in_layer, mode) = card.indices(plane);
                let [through, between] = in_layer.map(|index| index * scale.in_plane);
                // All plies of a brick separate from the layer below together, so only the first is tested. A brick over
                // air has nothing to separate from.
                let apart = if k == 0 && bricks.bond[cell] > 0.0 {
                    card.layer_index([stress[2], stress[4], stress[5]]).0 * scale.between_layers
                } else {
                    0.0
                };
                let mode = mode_of([through, between, apart], card.is_sliding(plane), mode);
                let index = through.max(between).max(apart);
                if of_card == N / 2 {
                    // Layers come apart below all plies of a brick, so the index of its first ply counts for all.
                    apart_of_cell = f64::max(apart_of_cell, apart);
                    *own_index = index.max(apart_of_cell) as f32;
                }
                let found = FirstFailure { index, cell, angle_rad: ply.angle_rad, mode };
                *worst = FirstFailure::worse(*worst, Some(found));
            }
        }
        worst
    }))
}

#[cfg(test)]
mod tests {
    use grainpath_core::DVec2;

    use super::super::card::tests::pla;
    use super::super::laminate::{BeadPiece, BeadSheet};
    use super::*;

    /// Sheets of beads side by side over a square of 8 mm, one raster angle a sheet.
    fn sheets(degrees: &[f64]) -> Vec<BeadSheet> {
        let sheet = |deg: &f64| {
            let d = grainpath_core::math::direction(deg.to_radians());
            let bead = |k: i32| {
                let middle = DVec2::splat(4.0) + d.perp() * (0.4 * f64::from(k));
                let (a, b) = (middle - d * 8.0, middle + d * 8.0);
                BeadPiece { a, b, volume_mm3: 16.0 * 0.4 * 0.2, material: 0 }
            };
            BeadSheet { height_mm: 0.2, beads: (-20..20).map(bead).collect() }
        };
        degrees.iter().map(sheet).collect()
    }

    fn middle(p: DVec2) -> bool {
        (p - 4.0).abs().max_element() < 2.0
    }

    #[test]
    fn a_raster_fails_at_the_stress_of_tsai_and_hill() {
        for deg in [0.0, 15.0, 30.0, 45.0, 60.0, 90.0f64] {
            let laminate = Laminate::from_layers(&sheets(&[deg]), 0.4).expect("cells");
            let stress = |cell: usize| middle(laminate.grid.centre(cell)).then_some([10.0, 0.0, 0.0]);
            let [found] = first_failure_of_plate(&laminate, &[vec![pla()]], &stress).expect("stable").first;
            let found = found.expect("a cell in the middle");
            let want = 10.0 / pla().tsai_hill_mpa(deg.to_radians());
            assert!((found.index / want - 1.0).abs() < 1e-3, "{deg}: {} {want}", found.index);
            // The mode is the largest term of Tsai and Hill: with this card shear leads from atan(18 / 52) = 19 degrees on.
            let d = grainpath_core::math::direction(deg.to_radians());
            let card = pla();
            let terms = [
                (d.x * d.x / card.xt_mpa, FailureMode::Along),
                (d.x * d.y / card.s12_mpa, FailureMode::Shear),
                (d.y * d.y / card.yt_mpa, FailureMode::Across),
            ];
            let largest = terms.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("three");
            assert_eq!(found.mode, largest.1, "{deg}");
            let bricks = Bricks::from_layers(&sheets(&[deg; 4]), 0.4, 0.0).expect("cells");
            let stress = |cell: usize| {
                middle(bricks.centre(cell).truncate()).then_some([10.0, 0.0, 0.0, 0.0, 0.0, 0.0])
            };
            let [found] =
                first_failure_of_bricks(&bricks, &[pla()], IndexScale::ONE, &stress).expect("stable").first;
            let found = found.expect("a cell in the middle");
            // Directions of the mean stiffness are rounded by up to 2.8 degrees.
            assert!((found.index / want - 1.0).abs() < 0.02, "{deg}: {} {want}", found.index);
        }
    }

    #[test]
    fn plies_are_judged_as_the_cells_of_a_plate_are() {
        let card = pla();
        let judge = PlyJudge::new(&card).expect("stable");
        for stress in [[10.0, 0.0, 0.0], [0.0, -8.0, 2.0], [3.0, 5.0, -4.0]] {
            let laminate = Laminate::from_layers(&sheets(&[20.0, 110.0, 20.0]), 0.4).expect("cells");
            let at = |cell: usize| middle(laminate.grid.centre(cell)).then_some(stress);
            let [found] = first_failure_of_plate(&laminate, &[vec![card]], &at).expect("stable").first;
            let plies = [(20f64.to_radians(), 2.0 / 3.0), (110f64.to_radians(), 1.0 / 3.0)];
            let mut told = Vec::new();
            judge.indices(&plies, &[stress, [0.0; 3]], &mut told);
            assert!((told[0] / found.expect("a cell").index - 1.0).abs() < 1e-3, "{stress:?}: {told:?}");
            assert_eq!(told[1], 0.0);
        }
    }

    #[test]
    fn plies_across_each_other_share_the_load_by_stiffness() {
        let laminate = Laminate::from_layers(&sheets(&[0.0, 90.0]), 0.4).expect("cells");
        let stress = |cell: usize| middle(laminate.grid.centre(cell)).then_some([10.0, 0.0, 0.0]);
        let [found] = first_failure_of_plate(&laminate, &[vec![pla()]], &stress).expect("stable").first;
        let found = found.expect("a cell in the middle");
        // Classical lamination of two plies, without Poisson's coupling in the sum: the ply across carries
        // E2 / (E1 + E2) of the force, twice its share of the area.
        let across = 2.0 * 10.0 * 2583.0 / (2669.0 + 2583.0);
        assert_eq!(found.mode, FailureMode::Across);
        assert!((found.index / (across / 37.0) - 1.0).abs() < 0.02, "{}", found.index);
    }

    #[test]
    fn pull_from_layer_to_layer_parts_them() {
        let bricks = Bricks::from_layers(&sheets(&[0.0; 4]), 0.4, 0.0).expect("cells");
        let stress = |cell: usize| {
            let whole = middle(bricks.centre(cell).truncate()) && bricks.bond[cell] > 0.99;
            whole.then_some([0.0, 0.0, 8.0, 0.0, 0.0, 0.0])
        };
        let mut weak = pla();
        weak.zt_mpa = 10.0;
        let [found, low] =
            first_failure_of_bricks(&bricks, &[pla(), weak], IndexScale::ONE, &stress).expect("stable").first;
        let (found, low) = (found.expect("a cell"), low.expect("a cell"));
        assert_eq!((found.mode, low.mode), (FailureMode::Layers, FailureMode::Layers));
        assert!((found.index - 0.2).abs() < 1e-3 && (low.index - 0.8).abs() < 4e-3, "{found:?} {low:?}");
    }

    #[test]
    fn a_place_of_little_contact_is_judged_with_what_lies_around_it() {
        let whole = Bricks::from_layers(&sheets(&[0.0; 4]), 0.4, 0.0).expect("cells");
        let [nx, ny, _] = whole.n;
        let stress =
            |cell: usize| middle(whole.centre(cell).truncate()).then_some([0.0, 0.0, 8.0, 0.0, 0.0, 0.0]);
        let layer = nx * ny;
        let centre = layer + ny / 2 * nx + nx / 2;
        let index = |contact: &dyn Fn(usize) -> f32| {
            let bond = (0..whole.bond.len()).map(contact).collect();
            let [found] = first_failure_of_bricks(
                &Bricks { bond, ..whole.clone() },
                &[pla()],
                IndexScale::ONE,
                &stress,
            )
            .expect("stable")
            .first;
            found.expect("a cell").index
        };
        let full = index(&|_| 1.0);
        assert!(
            (index(&|_| 0.25) / full - 4.0).abs() < 0.1,
            "lines that cross carry the load on their crossings"
        );
        let one = index(&|cell| if cell == centre { 0.1 } else { 1.0 });
        // The mean of nine cells is 0.9; stiffnesses are rounded to eighths.
        assert!((1.0..1.2).contains(&(one / full)), "{one} {full}");
        let over_air = index(&|cell| if cell >= layer { 0.0 } else { 1.0 });
        assert!((over_air / full - 1.0).abs() < 1e-6, "{over_air} {full}");
    }

    #[test]
    fn what_is_left_out_does_not_fail() {
        let laminate = Laminate::from_layers(&sheets(&[0.0]), 0.4).expect("cells");
        let none = first_failure_of_plate(&laminate, &[vec![pla()]], &|_| None).expect("stable");
        assert_eq!(none.first, [None]);
        assert!(!none.of_plies.is_empty() && none.of_plies.iter().all(|index| *index == 0.0));
    }
}
