//! Finds the infill density that gives a part a required mass.
//!
//! Walls, skins and bridges have a mass that does not depend on the density, so it is summed once.
//! The mass of sparse infill is nearly proportional to the density: up to six proportional steps
//! stop within 0.25 % of the mass. The mass also jumps where a line appears or disappears, so the
//! best of six steps is taken within 0.5 % as well. The mass of graded infill is less nearly
//! proportional, and no layer of patterns that lean is a copy: before the first and between two steps over all
//! layers, steps over every eighth of them (`SAMPLED`) correct the density. Where the steps fail, up to 14
//! bisections take the density with the nearest mass; a print that then misses its mass by more than
//! 0.5 % warns (`mass-missed`). Each bisection lays the sparse infill of all layers. Masses are added in
//! the order of the layers, so the result does not depend on the number of threads. A graded density is scaled
//! until its mean gives the mass. A mass that the pattern cannot give is refused, with the range
//! that it can give.

use grainpath_core::{Density, Diagnostics, Region, Role, Toolpath, Warning, WarningId};
use rayon::prelude::*;

use super::steps::{IslandPaths, LayerWalls, Steps};
use crate::error::Error;
use crate::guide::graded_density::GradedDensity;
use crate::wall::skin::SkinSplit;

/// Share of the required mass by which a print may differ without bisection and without a warning. Source: chosen; twice
/// the share at which the proportional steps stop.
const TOLERANCE: f64 = 5e-3;
/// One layer of so many stands for its neighbours while the density of graded infill is corrected. Source: derived. Lines
/// lean by 0.7 mm a mm of height, so eight layers of 0.2 mm move them by about two beads: enough for the sampled layers of a
/// part to lie at different phases, at an eighth of the time. Those of lines that lean are fitted together, too.
const SAMPLED: usize = 8;

impl Steps<'_> {
    /// The density of the job, or the density that gives the required mass. `walls` and `skins` are
    /// those of all layers. A mass that is missed by more than 0.5 % is a warning.
    ///
    /// # Errors
    /// [`Error::Mass`] if no density gives the mass.
    pub fn density(
        &self,
        walls: &[LayerWalls],
        skins: &[SkinSplit],
        diagnostics: &Diagnostics,
    ) -> Result<Density, Error> {
        let density = self.density_of_mass(walls, skins, diagnostics);
        // Notes from tried densities are discarded, because they do not concern the print.
        self.discard_notes();
        density
    }

    fn density_of_mass(
        &self,
        walls: &[LayerWalls],
        skins: &[SkinSplit],
        diagnostics: &Diagnostics,
    ) -> Result<Density, Error> {
        let Some(asked_g) = self.settings.infill.mass_g else {
            // A graded density is represented by its mean.
            return Ok(self.graded.map_or(self.settings.infill.density, |g| Density::Sparse(g.mean)));
        };
        // The range of densities that are tried. For a graded density they are means, which fix its scale.
        let [least, most] = self.graded.map_or([0.0, 1.0], GradedDensity::range);
        let grams = |path: &Toolpath, height_mm: f64| {
            let infill = &self.settings.infill;
            let m = if path.role == Role::Fibre { infill.fibre_material } else { infill.material };
            path.volume_mm3(height_mm) * 1e-3 * m.density_g_cm3 * m.flow
        };
        // Layers that the run copies have the mass of the layer that they are copied from.
        let copies = self.duplicates(0, skins);
        let masses = |each: &(dyn Fn(usize) -> f64 + Sync)| -> Vec<f64> {
            let own = |i: usize| if copies[i] == i { each(i) } else { 0.0 };
            (0..copies.len()).into_par_iter().map(own).collect()
        };
        // Masses are added in the order of the layers, so that the sum is the same for any number of threads.
        let sum = |masses: &[f64]| -> f64 { copies.iter().map(|&i| masses[i]).sum() };
        let height = |i: usize| self.stack.layers()[i].height_mm();
        let of_walls = |i: usize| -> f64 {
            let paths = walls[i]
                .islands
                .iter()
                .flat_map(|island| island.walls.iter().map(|w| &w.path).chain(&island.fills));
            paths.map(|p| grams(p, height(i))).sum()
        };
        let fixed = (0..copies.len()).map(of_walls).sum::<f64>()
            + sum(&masses(&|i| {
                let mut paths = Vec::new();
                let split = self.line_seams(i, &skins[i], &mut paths);
                self.dense_fill(i, &split, &mut |island, path| paths.push((island, path)));
                paths.iter().map(|(_, path)| grams(path, height(i))).sum()
            }));
        let of_sparse = |density: f64, i: usize| {
            let mut mass = 0.0;
            self.sparse_fill(i, &skins[i], Density::new(density), None, &mut |_, p| {
                mass += grams(&p, height(i))
            });
            mass
        };
        let every: Vec<usize> = (0..copies.len()).collect();
        let leaning: Vec<Vec<Region>> =
            every.par_iter().map(|i| self.leaning_areas(*i, &skins[*i])).collect();
        // Beads that lean have their widths only when those of all layers, or of all sampled ones, are laid.
        let of_fitted = |density: f64, layers: &[usize]| -> Vec<f64> {
            let lay = |&i: &usize| {
                let mut paths = Vec::new();
                let mut add = |island, path| paths.push((island, path));
                self.sparse_fill(i, &skins[i], Density::new(density), None, &mut add);
                paths
            };
            let mut laid: Vec<IslandPaths> = layers.par_iter().map(lay).collect();
            let own = laid.iter_mut().zip(layers);
            let mut all: Vec<_> = own.map(|(paths, &i)| (i, leaning[i].as_slice(), paths)).collect();
            self.fit_leaning(Density::new(density), &mut all);
            let grams = |(i, _, paths): &(usize, &[Region], &mut IslandPaths)| {
                paths.iter().map(|(_, path)| grams(path, height(*i))).sum()
            };
            all.iter().map(grams).collect()
        };
        let of_all = |density: f64| {
            if self.leans() { of_fitted(density, &every) } else { masses(&|i| of_sparse(density, i)) }
        };
        let mass = |density: f64| fixed + sum(&of_all(density));
        let sampled: Vec<usize> = (0..copies.len()).filter(|i| copies[*i] == *i).step_by(SAMPLED).collect();
        let of_sampled = |density: f64| -> f64 {
            let masses: Vec<f64> = if self.leans() {
                of_fitted(density, &sampled)
            } else {
                sampled.par_iter().map(|i| of_sparse(density, *i)).collect()
            };
            masses.iter().sum()
        };
        // The density at which the sampled layers have this mass.
        let of_mass = |from: f64, wanted_g: f64| {
            let mut density = from;
            // All steps together lay half as much as one over all layers.
            for _ in 0..SAMPLED / 2 {
                let ratio = of_sampled(density.clamp(least, most)) / wanted_g;
                // Without infill in the sampled layers the ratio is no number.
                if !ratio.is_finite() || (ratio - 1.0).abs() < 1e-3 {
                    break;
                }
                density = (density / ratio).clamp(0.1 * from, 10.0 * from);
            }
            density.clamp(least, most)
        };
        // Mass is nearly proportional to density, so each step scales the density by required over found infill mass.
        let mut density = 0.3;
        if let Some(graded) = self.graded {
            // The sampled layers get the share of the mass that they have of the volume.
            let volume = |i: usize| self.stack.layers()[i].height_mm() * sparse_mm2(&skins[i]);
            let share = sampled.iter().map(|i| volume(*i)).sum::<f64>()
                / every.iter().map(|i| volume(*i)).sum::<f64>();
            density = of_mass(graded.mean, share * (asked_g - fixed).max(0.0));
        }
        let mut nearest = (f64::INFINITY, density);
        for _ in 0..6 {
            let laid = of_all(density);
            let found = fixed + sum(&laid);
            let off = (found - asked_g).abs();
            if off < nearest.0 {
                nearest = (off, density);
            }
            if off < 2.5e-3 * asked_g {
                return Ok(Density::new(density));
            }
            let change = (asked_g - fixed) / (found - fixed).max(1e-9);
            let from = density;
            density *= change;
            // Outside this range the mass is no longer proportional to the density: a line appears or
            // the infill becomes dense.
            if self.graded.is_some() {
                // The sampled layers have to change as all layers should.
                let before = if self.leans() {
                    of_sampled(from)
                } else {
                    sampled.iter().map(|i| laid[*i]).sum::<f64>()
                };
                density = of_mass(density, before * change);
            } else if !(0.01..0.95).contains(&density) {
                break;
            }
        }
        // This error is accepted without bisection: the steps then alternate around a jump.
        if nearest.0 < TOLERANCE * asked_g {
            return Ok(Density::new(nearest.1));
        }
        let high_g = mass(most);
        let low_g = if self.graded.is_some() { mass(least) } else { fixed };
        if asked_g < low_g * 0.99 || asked_g > high_g * 1.01 {
            return Err(match self.graded {
                Some(_) => Error::GradedMass { asked_g, least, low_g, most, high_g },
                None => Error::Mass { asked_g, low_g, high_g },
            });
        }
        // Bisection: mass rises with density, in small jumps where a line appears.
        let (mut low, mut high) = (least, most);
        let mut best = (f64::INFINITY, 0.0);
        for _ in 0..14 {
            let middle = 0.5 * (low + high);
            let off = mass(middle) - asked_g;
            if off.abs() < f64::abs(best.0) {
                best = (off, middle);
            }
            if off.abs() < 1e-3 * asked_g {
                break;
            }
            if off < 0.0 { low = middle } else { high = middle }
        }
        if best.0.abs() > TOLERANCE * asked_g {
            let text = format!(
                "no density gives {asked_g} g: a line of infill more or less changes the mass in steps, and the nearest \
                 density gives {:.3} g",
                asked_g + best.0
            );
            diagnostics.push(Warning::new(WarningId::MassMissed, text));
        }
        Ok(Density::new(best.1))
    }
}

/// Area of the sparse infill of a layer, with that of regions, mm2.
fn sparse_mm2(split: &SkinSplit) -> f64 {
    let all = std::iter::once(split).chain(&split.regions);
    all.flat_map(|split| &split.sparse).map(|(_, polygon)| polygon.area_mm2()).sum()
}
