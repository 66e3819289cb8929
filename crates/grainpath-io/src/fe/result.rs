//! The stress of a finite-element file at every node, in mm and MPa.
//!
//! Files name their arrays freely and order the components of a stress in three ways. This module decides which array is the
//! stress, converts its unit and orders its components as xx, yy, zz, xy, yz, zx. Two checks warn of a wrong order. The
//! stress is compared with a von Mises stress, if the file holds one. The traction on the free surface has to be small,
//! since it is zero for most of a part. Stress on elements is averaged at nodes, weighted by volume; nodes in the middle of
//! edges without a stress get the mean of the two ends.

use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, Warning, WarningId};

use super::model::{Element, FeArray, FeError, FeFile, FeFormat, On, invalid};
use super::problem::FeProblem;
use grainpath_core::tensor::von_mises;

/// Peak stress in MPa above which the user is warned of a wrong unit. No printed part bears as much. Only this warning
/// depends on the value.
/// Source: chosen; more than twice the tensile strength of continuous carbon fibre composites along the fibre
/// (about 2000 MPa).
const LIKELY_MAX_MPA: f64 = 5000.0;
/// Size in mm above which the user is warned of a wrong unit; only this warning depends on the value.
/// Source: chosen; five times the longest axis of large-format FDM printers (1 m).
const LIKELY_MAX_MM: f64 = 5000.0;
/// Size in mm below which the user is warned that the unit may be metres; only this warning depends on the value.
const LIKELY_MIN_MM: f64 = 1.0;

/// A unit of stress a file may be in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum StressUnit {
    Megapascal,
    Pascal,
    Kilopascal,
    Gigapascal,
    /// Pound-force per square inch.
    Psi,
    /// Thousand psi.
    Ksi,
}

impl StressUnit {
    /// Names in the order of the variants.
    pub const NAMES: [&str; 6] = ["MPa", "Pa", "kPa", "GPa", "psi", "ksi"];

    /// Size of this unit in MPa.
    pub const fn mpa(self) -> f64 {
        match self {
            Self::Megapascal => 1.0,
            Self::Pascal => 1e-6,
            Self::Kilopascal => 1e-3,
            Self::Gigapascal => 1e3,
            // 1 psi = 1 lbf/in2 = 4.448 221 615 260 5 N / (25.4 mm)2, both exact by definition (NIST SP
            // 811).
            Self::Psi => 6.894_757_293_168e-3,
            Self::Ksi => 6.894_757_293_168,
        }
    }

    /// The name used in jobs and reports.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The unit with this name, in any case; `N/mm2` is MPa.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "mpa" | "n/mm2" | "n/mm^2" => Self::Megapascal,
            "pa" | "n/m2" | "n/m^2" => Self::Pascal,
            "kpa" => Self::Kilopascal,
            "gpa" => Self::Gigapascal,
            "psi" => Self::Psi,
            "ksi" => Self::Ksi,
            _ => return None,
        })
    }
}

/// Order of the six components of a stress. All begin with xx, yy, zz.
///
/// ```
/// use grainpath_io::fe::Order;
/// assert_eq!(Order::from_name("Abaqus"), Some(Order::Abaqus));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// xx, yy, zz, xy, yz, zx: VTK, CalculiX, Gmsh scripts, grainpath.
    Vtk,
    /// xx, yy, zz, xy, xz, yz: Abaqus.
    Abaqus,
    /// xx, yy, zz, yz, xz, xy: Voigt.
    Voigt,
}

impl Order {
    /// Names in the order of the variants.
    pub const NAMES: [&str; 3] = ["vtk", "abaqus", "voigt"];

    /// The name used in jobs and reports.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The order with this name, in any case.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Vtk, Self::Abaqus, Self::Voigt].into_iter().find(|o| o.name().eq_ignore_ascii_case(name))
    }

    /// Positions of xx, yy, zz, xy, yz, zx in this order.
    const fn places(self) -> [usize; 6] {
        match self {
            Self::Vtk => [0, 1, 2, 3, 4, 5],
            Self::Abaqus => [0, 1, 2, 3, 5, 4],
            Self::Voigt => [0, 1, 2, 5, 3, 4],
        }
    }
}

/// What the job states about the stress of a file. `None` takes the statement of the file, or else the default given
/// here.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FeOptions {
    /// Unit of positions and displacements; mm when not given.
    pub length_unit: Option<LengthUnit>,
    /// Unit of the stress; MPa when not given.
    pub stress_unit: Option<StressUnit>,
    /// Name of the array that is the stress, or the beginning of the names of its component arrays.
    pub stress_array: Option<String>,
    /// Order of its components. When not given, components are taken by name, or in VTK's order where they have no names.
    pub order: Option<Order>,
    /// Step of the analysis, from 1; the last when not given.
    pub step: Option<usize>,
}

/// A result ready for use: positions in mm, stresses in MPa, components xx, yy, zz, xy, yz, zx.
#[derive(Debug, Clone, PartialEq)]
pub struct FeResult {
    /// Format of the file.
    pub format: FeFormat,
    /// Positions, mm.
    pub nodes: Vec<DVec3>,
    /// Elements of the highest dimension, each with a stress at all its nodes; empty for points without a mesh.
    pub elements: Vec<Element>,
    /// Stress at each node, MPa, tension positive. NaN at nodes that belong to no element and have no stress.
    pub stress: Vec<[f64; 6]>,
    /// Displacement of each node, mm, where the file has one.
    pub displacement: Option<Vec<DVec3>>,
    /// Whether all nodes lie in a plane of constant z. The z of a sampled point is ignored then.
    pub plane: bool,
    /// Name of the array that the stress was read from.
    pub stress_array: String,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

impl FeResult {
    /// Highest von Mises stress at any node, MPa.
    pub fn max_von_mises_mpa(&self) -> f64 {
        self.stress.iter().map(von_mises).filter(|v| v.is_finite()).fold(0.0, f64::max)
    }

    /// Lowest and highest corner of the box around the elements, mm; around all nodes where there are no elements.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let grown = |(lo, hi): (DVec3, DVec3), p: DVec3| (lo.min(p), hi.max(p));
        let mut used = self.elements.iter().flat_map(|e| e.nodes()).map(|&i| self.nodes[i as usize]);
        match used.next() {
            Some(first) => Some(used.fold((first, first), grown)),
            None => box_of(&self.nodes),
        }
    }
}

/// Source of each of the six components: an array (by index) and a component in it.
struct Choice {
    label: String,
    on: On,
    /// xx, yy, zz, xy, yz, zx; `None` for a component that is zero (plane stress).
    from: [Option<(usize, usize)>; 6],
    /// The mirrored component of each shear, for tensors with nine components.
    mirror: [Option<(usize, usize)>; 6],
    /// Whether the file itself states the order of the components.
    by_name: bool,
    /// Whether the order given by the user, or VTK's in its place, says which component is which.
    in_order: bool,
}

impl FeFile {
    /// The stress of the file.
    ///
    /// # Errors
    /// [`FeError`] when there is no stress, no array of the name asked for, or too little of it to be used.
    pub fn result(&self, options: &FeOptions) -> Result<FeResult, FeError> {
        let choice = self.choose(options)?;
        let mut warnings = self.warnings.clone();
        // Points and lines carry no stress in any mesh, so their absence is not worth a warning.
        let lost = self.left_out.iter().filter(|(what, _)| what != "points" && what != "lines");
        warnings.extend(lost.map(|(what, n)| {
            Warning::new(WarningId::FeLeftOut, format!("{n} elements are left out: {what}"))
        }));
        let mm = options.length_unit.unwrap_or(LengthUnit::Millimetre).mm();
        let mpa = options.stress_unit.unwrap_or(StressUnit::Megapascal).mpa();
        let nodes: Vec<DVec3> = self.nodes.iter().map(|p| *p * mm).collect();
        let n_tuples = if choice.on == On::Nodes { self.nodes.len() } else { self.elements.len() };
        let value = |slot: Option<(usize, usize)>, i: usize| {
            slot.map_or(0.0, |(a, c)| {
                let array = &self.arrays[a];
                array.values.get(i * array.components + c).copied().unwrap_or(f64::NAN)
            })
        };
        let tensor = |i: usize| -> [f64; 6] {
            std::array::from_fn(|k| {
                let v = value(choice.from[k], i);
                // A tensor with nine components holds each shear twice. The mean removes the
                // antisymmetric part that interpolation in other programs may leave.
                let v = if choice.mirror[k].is_some() { 0.5 * (v + value(choice.mirror[k], i)) } else { v };
                v * mpa
            })
        };
        let mut stress: Vec<[f64; 6]> = (0..n_tuples).map(tensor).collect();
        // A solid mesh often holds its surface as triangles too. Only elements of the highest dimension
        // are interpolated.
        let top = self.elements.iter().map(|e| e.kind.dimension()).max().unwrap_or(0);
        let mut elements: Vec<Element> = Vec::with_capacity(self.elements.len());
        if choice.on == On::Elements {
            stress = self.averaged(&nodes, &stress, top);
        }
        // Middle nodes are filled in after averaging, so that results on nodes and on elements both reach them.
        fill_middles(&self.elements, &mut stress);
        let whole = |s: &[f64; 6]| s.iter().all(|v| v.is_finite());
        let mut without = 0;
        for e in self.elements.iter().filter(|e| e.kind.dimension() == top) {
            if e.nodes().iter().all(|&i| whole(&stress[i as usize])) {
                elements.push(*e);
            } else {
                without += 1;
            }
        }
        if top > 0 && elements.is_empty() {
            return Err(invalid(format!("array {:?}", choice.label), FeProblem::NoFiniteElement));
        }
        if without > 0 {
            let text = format!("{without} elements have no finite stress at some node and are left out");
            warnings.push(Warning::new(WarningId::FeLeftOut, text));
        }
        if top == 0 && !stress.iter().any(whole) {
            return Err(invalid(format!("array {:?}", choice.label), FeProblem::NoFinitePoint));
        }
        let displacement = self.displacement(options.step).map(|a| {
            let c = a.components;
            // Two components are displacements in the plane.
            let p = |i: usize| {
                let t = &a.values[i * c..(i + 1) * c];
                DVec3::new(t[0], t[1], t.get(2).copied().unwrap_or(0.0)) * mm
            };
            (0..nodes.len()).map(p).collect()
        });
        let mut result = FeResult {
            format: self.format,
            plane: is_plane(&nodes, &elements),
            nodes,
            elements,
            stress,
            displacement,
            stress_array: choice.label.clone(),
            warnings: Vec::new(),
        };
        self.check(&result, &choice, options, mpa, &mut warnings);
        result.warnings = warnings;
        Ok(result)
    }

    /// Stresses of elements averaged to the nodes by volume.
    fn averaged(&self, nodes: &[DVec3], stress: &[[f64; 6]], top: usize) -> Vec<[f64; 6]> {
        let mut sum = vec![[0.0; 6]; nodes.len()];
        let mut weight = vec![0.0; nodes.len()];
        for (e, s) in self.elements.iter().zip(stress) {
            if e.kind.dimension() != top || !s.iter().all(|v| v.is_finite()) {
                continue;
            }
            let w = e.size(nodes).max(f64::MIN_POSITIVE);
            for &i in e.nodes() {
                weight[i as usize] += w;
                for (to, v) in sum[i as usize].iter_mut().zip(s) {
                    *to += w * v;
                }
            }
        }
        // A node of no averaged element divides 0 by 0. The NaN means that there is no stress.
        sum.iter().zip(weight).map(|(s, w)| s.map(|v| v / w)).collect()
    }

    /// Names of arrays for an error message.
    fn listed(&self) -> String {
        if self.arrays.is_empty() {
            return ": it has no arrays".into();
        }
        let mut names: Vec<String> =
            self.arrays.iter().map(|a| format!("{} ({})", a.name, a.components)).collect();
        names.dedup();
        let more = names.len().saturating_sub(12);
        names.truncate(12);
        let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("; its arrays (components) are {}{tail}", names.join(", "))
    }

    /// Whether an array is of the requested step, or of the last one where none is requested.
    fn of_step(&self, index: usize, step: Option<usize>) -> bool {
        let a = &self.arrays[index];
        match (step, a.step) {
            (Some(wanted), Some(has)) => {
                let later = self.arrays[index + 1..].iter();
                wanted == has && !later.clone().any(|b| b.name == a.name && b.on == a.on && b.step == a.step)
            }
            _ => !self.arrays[index + 1..].iter().any(|b| b.name == a.name && b.on == a.on),
        }
    }

    fn choose(&self, options: &FeOptions) -> Result<Choice, FeError> {
        if let Some(step) = options.step
            && !self.arrays.iter().any(|a| a.step == Some(step))
        {
            let last = self.arrays.iter().filter_map(|a| a.step).max().unwrap_or(1);
            // A file with one step may leave its arrays without a number; step 1 is that one.
            if step != 1 || last != 1 {
                return Err(invalid(format!("step {step}"), FeProblem::NoSuchStep { last }));
            }
        }
        let named = options.stress_array.as_deref();
        let usable = |a: &FeArray| match a.components {
            6 | 9 => true,
            // Plane tensors are taken only where the user names the array: three numbers are usually a
            // vector.
            3 | 4 => named.is_some(),
            _ => false,
        };
        let all: Vec<usize> = (0..self.arrays.len()).filter(|&i| self.of_step(i, options.step)).collect();
        let whole: Vec<usize> = all.iter().copied().filter(|&i| usable(&self.arrays[i])).collect();
        let pick = |test: &dyn Fn(&FeArray) -> bool| {
            let on =
                |on: On| whole.iter().copied().find(|&i| self.arrays[i].on == on && test(&self.arrays[i]));
            // Values on nodes are preferred: averaging element values smooths peaks.
            on(On::Nodes).or_else(|| on(On::Elements))
        };
        if let Some(name) = named {
            if let Some(i) =
                pick(&|a| a.name == name).or_else(|| pick(&|a| a.name.eq_ignore_ascii_case(name)))
            {
                return self.whole_array(i, options);
            }
            return self
                .by_parts(&all, Some(name))
                .ok_or_else(|| FeError::NoSuchArray { name: name.to_owned(), arrays: self.listed() });
        }
        let usual = ["s", "stress", "stresses", "sigma", "cauchy_stress", "cauchy stress", "stress tensor"];
        let exact = usual.iter().find_map(|u| pick(&|a| a.name.eq_ignore_ascii_case(u)));
        // Names such as `stress_error` or `plastic strain energy` contain the word and are no stress.
        let strain =
            |n: &str| n.contains("strain") || n.contains("error") || n == "e" || n == "le" || n == "pe";
        let like = || {
            pick(&|a| {
                let n = a.name.to_ascii_lowercase();
                (n.contains("stress") || n.contains("sigma")) && !strain(&n)
            })
        };
        if let Some(i) = exact.or_else(like) {
            return self.whole_array(i, options);
        }
        if let Some(choice) = self.by_parts(&all, None) {
            return Ok(choice);
        }
        Err(FeError::NoStress { arrays: self.listed() })
    }

    /// Components of an array that holds the whole tensor.
    fn whole_array(&self, index: usize, options: &FeOptions) -> Result<Choice, FeError> {
        let a = &self.arrays[index];
        let at = |c: usize| Some((index, c));
        let mut from = [None; 6];
        let mut mirror = [None; 6];
        let (mut by_name, mut in_order) = (false, false);
        let named: Vec<Option<usize>> = a.component_names.iter().map(|n| component(n)).collect();
        let place = |k: usize| named.iter().position(|c| *c == Some(k));
        match a.components {
            // Row-major 3 x 3: the diagonal is 0, 4, 8; xy, yz, zx and their mirror images are off the
            // diagonal.
            9 => {
                from = [0, 4, 8, 1, 5, 6].map(at);
                (mirror[3], mirror[4], mirror[5]) = (at(3), at(7), at(2));
                by_name = true;
            }
            // Named components beat the default order, and an order given by the user beats the names.
            6 if options.order.is_none() && (0..6).all(|k| place(k).is_some()) => {
                from = std::array::from_fn(|k| place(k).and_then(at));
                by_name = true;
            }
            6 => {
                from = options.order.unwrap_or(Order::Vtk).places().map(at);
                in_order = true;
            }
            // Four components are xx, yy, zz, xy (plane strain); three are xx, yy, xy (plane stress).
            4 => (from[0], from[1], from[2], from[3]) = (at(0), at(1), at(2), at(3)),
            _ => (from[0], from[1], from[3]) = (at(0), at(1), at(2)),
        }
        Ok(Choice { label: a.name.clone(), on: a.on, from, mirror, by_name, in_order })
    }

    /// Components in arrays of their own: `S11`, `sigma_xy`, `Stress XX Component`.
    fn by_parts(&self, all: &[usize], prefix: Option<&str>) -> Option<Choice> {
        let squeeze = |s: &str| -> String {
            s.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase()
        };
        let wanted = prefix.map(squeeze);
        for on in [On::Nodes, On::Elements] {
            let mut found: Vec<(String, usize, usize)> = Vec::new();
            for &i in all.iter().filter(|&&i| self.arrays[i].on == on && self.arrays[i].components == 1) {
                let name = squeeze(unit_off(&self.arrays[i].name));
                let name = name.strip_suffix("component").unwrap_or(&name);
                let cut = name.len().checked_sub(2).filter(|&c| name.is_char_boundary(c));
                let Some((stem, tail)) = cut.map(|c| name.split_at(c)) else { continue };
                if let Some(k) = component(tail) {
                    found.push((stem.to_owned(), k, i));
                }
            }
            let stems: Vec<String> = match &wanted {
                Some(w) => vec![w.clone()],
                // The empty stem stands for bare names such as `xx`; it comes last because it fits almost
                // anything.
                None => ["s", "stress", "sigma", "sig", "stresstensor", "t", ""].map(str::to_owned).to_vec(),
            };
            for stem in stems {
                let mut from = [None; 6];
                for (_, k, i) in found.iter().filter(|(s, ..)| *s == stem) {
                    from[*k] = from[*k].or(Some((*i, 0)));
                }
                // A plane tensor needs xx, yy and xy. The missing components are zero.
                if from[0].is_some() && from[1].is_some() && from[3].is_some() {
                    let label = from.iter().flatten().map(|&(i, _)| self.arrays[i].name.as_str());
                    let label = label.collect::<Vec<_>>().join(", ");
                    return Some(Choice {
                        label,
                        on,
                        from,
                        mirror: [None; 6],
                        by_name: true,
                        in_order: false,
                    });
                }
            }
        }
        None
    }

    fn displacement(&self, step: Option<usize>) -> Option<&FeArray> {
        let usual = ["u", "disp", "displ", "displacement", "displacements"];
        let is = |i: usize| {
            let a = &self.arrays[i];
            a.on == On::Nodes
                && (2..=3).contains(&a.components)
                && a.values.len() == self.nodes.len() * a.components
                && self.of_step(i, step)
        };
        let found = |name: &str| {
            (0..self.arrays.len()).find(|&i| is(i) && self.arrays[i].name.eq_ignore_ascii_case(name))
        };
        usual.iter().find_map(|n| found(n)).map(|i| &self.arrays[i])
    }

    /// Warns of units and orders that cannot be right.
    fn check(
        &self,
        result: &FeResult,
        choice: &Choice,
        options: &FeOptions,
        mpa: f64,
        warnings: &mut Vec<Warning>,
    ) {
        let peak = result.max_von_mises_mpa();
        // A wrong unit is a warning and not an error: principal directions, which guide the fill, do not
        // depend on it.
        if peak > LIKELY_MAX_MPA {
            let text = format!("the peak von Mises stress is {peak:.3e} MPa, more than any plastic bears");
            let warning = Warning::new(WarningId::FeUnitDoubtful, text);
            // Stress in Pa would still exceed 1e-4 MPa after conversion; a smaller value would be noise
            // in any unit.
            let in_pa = options.stress_unit.is_none() && peak * 1e-6 > 1e-4;
            warnings.push(if in_pa {
                warning.with_remedy("if it is in Pa, set guide.import_stress_unit = \"Pa\"")
            } else {
                warning
            });
        }
        if peak == 0.0 {
            warnings.push(Warning::new(WarningId::FeZeroStress, "the stress is zero everywhere"));
        }
        if let Some((lo, hi)) = result.bounds() {
            let size = (hi - lo).max_element();
            if options.length_unit.is_none() && !(LIKELY_MIN_MM..=LIKELY_MAX_MM).contains(&size) {
                warnings.push(
                    Warning::new(WarningId::FeUnitDoubtful, format!("the mesh is {size:.4} mm long"))
                        .with_remedy(
                            "if it is not in mm, set guide.import_length_unit, for example to \"m\"",
                        ),
                );
            }
        }
        self.check_von_mises(result, mpa, warnings);
        if let (Some(order), false) = (options.order, choice.in_order) {
            let text = format!(
                "the order {} of stress components is not used: array {} is no array of six components",
                order.name(),
                choice.label
            );
            warnings.push(Warning::new(WarningId::FeOrderUnused, text));
        }
        if !choice.by_name
            && let Some((order, stated, best)) = better_order(result, options.order)
        {
            let text = format!(
                "the order of the components may be {}: with it the stress across free faces is {best:.3} of the \
                 whole, with {} it is {stated:.3}",
                order.name(),
                options.order.unwrap_or(Order::Vtk).name()
            );
            warnings.push(Warning::new(WarningId::FeOrderDoubtful, text));
        }
    }

    /// Compares the stress with a von Mises stress that the file holds. Misplaced components make the two differ.
    fn check_von_mises(&self, result: &FeResult, mpa: f64, warnings: &mut Vec<Warning>) {
        let like = |a: &&FeArray| {
            let name = a.name.to_ascii_lowercase();
            a.on == On::Nodes
                && a.components == 1
                && name.contains("mises")
                && !name.contains("strain")
                && a.values.len() == result.stress.len()
        };
        let Some(array) = self.arrays.iter().rev().find(like) else { return };
        let (mut off, mut total) = (0.0, 0.0);
        for (s, v) in result.stress.iter().zip(&array.values) {
            let (ours, theirs) = (von_mises(s), v * mpa);
            if ours.is_finite() && theirs.is_finite() {
                off += (ours - theirs).abs();
                total += theirs.abs();
            }
        }
        // Averaging at nodes and rounding differ by a few per cent between programs; swapped components
        // differ by far more.
        if off > 0.1 * total {
            let text = format!(
                "the stress does not give the von Mises stress of array {:?} (off by {:.0} % on average)",
                array.name,
                100.0 * off / total.max(f64::MIN_POSITIVE)
            );
            warnings.push(Warning::new(WarningId::FeOrderDoubtful, text));
        }
    }
}

/// Name without a unit after it: `S11 [MPa]`, `sxx_mpa`.
fn unit_off(name: &str) -> &str {
    let bare = name.split(['[', '(']).next().unwrap_or(name).trim_end();
    match bare.rsplit_once(['_', ' ']) {
        Some((stem, unit)) if StressUnit::from_name(unit).is_some() => stem,
        _ => bare,
    }
}

/// Component (xx, yy, zz, xy, yz, zx) that the end of a name stands for: `SXX`, `S11`, `xy`.
fn component(name: &str) -> Option<usize> {
    let lower = name.to_ascii_lowercase();
    let at = lower.len().checked_sub(2)?;
    Some(match lower.get(at..)? {
        "xx" | "11" => 0,
        "yy" | "22" => 1,
        "zz" | "33" => 2,
        "xy" | "yx" | "12" | "21" => 3,
        "yz" | "zy" | "23" | "32" => 4,
        "zx" | "xz" | "31" | "13" => 5,
        _ => return None,
    })
}

/// Nodes on edges get the mean of their ends where only corners have a stress.
fn fill_middles(elements: &[Element], stress: &mut [[f64; 6]]) {
    for e in elements {
        for (&node, &[i, j]) in e.nodes()[e.kind.n_corners()..].iter().zip(e.kind.edges()) {
            if !stress[node as usize].iter().all(|v| v.is_nan()) {
                continue;
            }
            let (a, b) = (stress[e.nodes()[i] as usize], stress[e.nodes()[j] as usize]);
            stress[node as usize] = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        }
    }
}

fn box_of(nodes: &[DVec3]) -> Option<(DVec3, DVec3)> {
    let first = *nodes.first()?;
    Some(nodes.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p))))
}

fn is_plane(nodes: &[DVec3], elements: &[Element]) -> bool {
    let Some((lo, hi)) = box_of(nodes) else { return false };
    // The nodes of a plane mesh may differ in z by rounding.
    let flat = hi.z - lo.z <= 1e-9 * (hi - lo).max_element();
    flat && elements.first().is_none_or(|e| e.kind.dimension() == 2)
}

/// An order of the shears that gives much less traction on the free surface than the stated order, and the traction's share
/// of the stress with the stated and with the better order. Most of a part's surface carries no load, so the right order
/// gives little traction there.
fn better_order(result: &FeResult, stated: Option<Order>) -> Option<(Order, f64, f64)> {
    if result.elements.first()?.kind.dimension() != 3 {
        return None;
    }
    let stated = stated.unwrap_or(Order::Vtk);
    let all = [Order::Vtk, Order::Abaqus, Order::Voigt];
    let mut across = [0.0; 3];
    let mut total = 0.0;
    for (e, face) in free_faces(&result.elements) {
        let e = &result.elements[e as usize];
        let corners = e.kind.faces()[face as usize];
        let face: [u32; 4] = std::array::from_fn(|k| e.nodes()[corners[k.min(corners.len() - 1)]]);
        let face = &face[..corners.len()];
        let p = |k: usize| result.nodes[face[k] as usize];
        let area = (p(1) - p(0)).cross(p(2) - p(0));
        let size = area.length();
        if size == 0.0 {
            continue;
        }
        let n = area / size;
        // Undoes the stated order: `raw` holds the components in the order of the file, to which every order is applied.
        let places = stated.places();
        let mut raw = [0.0; 6];
        for &i in face {
            for (k, v) in result.stress[i as usize].iter().enumerate() {
                raw[places[k]] += v / face.len() as f64;
            }
        }
        for (sum, order) in across.iter_mut().zip(all) {
            let [xx, yy, zz, xy, yz, zx] = order.places().map(|k| raw[k]);
            let t = DVec3::new(
                xx * n.x + xy * n.y + zx * n.z,
                xy * n.x + yy * n.y + yz * n.z,
                zx * n.x + yz * n.y + zz * n.z,
            );
            *sum += size * t.length();
        }
        // The Frobenius norm counts each shear twice.
        let norm = raw.iter().enumerate().map(|(k, v)| if k < 3 { v * v } else { 2.0 * v * v }).sum::<f64>();
        total += size * norm.sqrt();
    }
    let share = |o: Order| across[o as usize] / total;
    let best = all.into_iter().min_by(|a, b| share(*a).total_cmp(&share(*b)))?;
    // Noise must not raise the warning: the better order has to reduce the traction by 30 %, and the
    // traction has to be more than 5 % of the stress. Both values decide only whether the user is warned.
    (share(best) < 0.7 * share(stated) && share(stated) > 0.05).then(|| (best, share(stated), share(best)))
}

/// Free faces of solids (free edges of surfaces), which only one element has: the element and the number of the face in it.
pub(crate) fn free_faces(elements: &[Element]) -> Vec<(u32, u8)> {
    let mut faces: Vec<([u32; 4], u32, u8)> = Vec::new();
    for (i, e) in elements.iter().enumerate() {
        for (f, face) in e.kind.faces().iter().enumerate() {
            // Faces of three corners keep u32::MAX in the fourth place, which no index reaches.
            let mut key = [u32::MAX; 4];
            for (k, &c) in key.iter_mut().zip(*face) {
                *k = e.nodes()[c];
            }
            key.sort_unstable();
            faces.push((key, i as u32, f as u8));
        }
    }
    // Sorting brings the two copies of an inner face together; free faces stay single. A hash map would
    // use more memory and return them in no fixed order.
    faces.sort_unstable();
    let single = faces.chunk_by(|a, b| a.0 == b.0).filter(|c| c.len() == 1);
    single.map(|c| (c[0].1, c[0].2)).collect()
}
