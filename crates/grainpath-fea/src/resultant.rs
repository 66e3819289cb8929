//! Resultants of loads and fixtures on a mesh: areas, forces and moments, and their balance.
//!
//! A selection catches whole faces of a mesh, so the area that it covers is known only once the
//! mesh exists. Loads are summed from the forces at the nodes. Reactions are the forces with which
//! fixtures hold the nodes of a solution. In equilibrium the two cancel, up to the residual of the
//! solver. The sum checks the assembly of loads, supports and stiffness at once.
//!
//! Units: mm, mm2, N, N mm; vectors in part coordinates.

use grainpath_core::DVec3;

/// A load or a reaction as one force and one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Resultant {
    /// Name of the load or fixture, such as "load 1".
    pub name: String,
    /// Area of the selected faces, mm2; 0 for loads on the volume.
    pub area_mm2: f64,
    /// Centroid of that area, or of the volume, mm: the point that the moment is taken about.
    pub centroid_mm: DVec3,
    /// Sum of the forces on the part, N.
    pub force_n: DVec3,
    /// Sum of their moments about the centroid, N mm.
    pub moment_nmm: DVec3,
    /// Sum of the lengths of the single forces, N; the resultant may be zero though they are not.
    pub amount_n: f64,
    /// Sum of the lengths of their single moments about the centroid, N mm.
    pub moment_amount_nmm: f64,
}

impl Resultant {
    /// The sum of forces at points, with moments about `centroid_mm`.
    pub fn new(
        name: &str,
        area_mm2: f64,
        centroid_mm: DVec3,
        forces: impl Iterator<Item = (DVec3, DVec3)>,
    ) -> Self {
        let (mut force_n, mut moment_nmm) = (DVec3::ZERO, DVec3::ZERO);
        let (mut amount_n, mut moment_amount_nmm) = (0.0, 0.0);
        for (place, force) in forces {
            let moment = (place - centroid_mm).cross(force);
            force_n += force;
            moment_nmm += moment;
            amount_n += force.length();
            moment_amount_nmm += moment.length();
        }
        let name = name.to_owned();
        Self { name, area_mm2, centroid_mm, force_n, moment_nmm, amount_n, moment_amount_nmm }
    }

    /// The moment about another point, N mm.
    pub fn moment_about_nmm(&self, point: DVec3) -> DVec3 {
        self.moment_nmm + (self.centroid_mm - point).cross(self.force_n)
    }
}

/// The loads of a case and the reactions of its fixtures.
///
/// ```
/// use grainpath_core::DVec3;
/// use grainpath_fea::resultant::{CaseBalance, Resultant};
///
/// let tip = DVec3::new(60.0, 0.0, 0.0);
/// let load = Resultant::new("load 1", 40.0, tip, [(tip, DVec3::new(0.0, 0.0, -10.0))].into_iter());
/// // A lever of 1 mm at the root holds the part against the moment of 600 N mm.
/// let up = |x: f64, z: f64| (DVec3::new(x, 0.0, 0.0), DVec3::new(0.0, 0.0, z));
/// let held = [up(0.0, -590.0), up(1.0, 600.0)];
/// let root = Resultant::new("fixture 1", 40.0, DVec3::ZERO, held.into_iter());
/// let balance = CaseBalance { case: "bend".into(), loads: vec![load], reactions: vec![root] };
/// assert!(balance.imbalance() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CaseBalance {
    /// The load case.
    pub case: String,
    /// Resultant of each load.
    pub loads: Vec<Resultant>,
    /// Reaction of each fixture.
    pub reactions: Vec<Resultant>,
}

impl CaseBalance {
    /// Relative imbalance of loads and reactions: the larger of the unbalanced force over the sum of the
    /// lengths of all forces at nodes, and the unbalanced moment over the like sum of moments about the
    /// same point. 0 where no load acts.
    pub fn imbalance(&self) -> f64 {
        let all = || self.loads.iter().chain(&self.reactions);
        let Some(first) = all().next() else { return 0.0 };
        let point = first.centroid_mm;
        // Resultants are no measure: those of a moment, and of a pressure on a closed surface, are zero
        // but for rounding errors.
        let (mut force, mut forces) = (DVec3::ZERO, 0.0);
        let (mut moment, mut moments) = (DVec3::ZERO, 0.0);
        for r in all() {
            force += r.force_n;
            forces += r.amount_n;
            moment += r.moment_about_nmm(point);
            moments += r.moment_amount_nmm + r.centroid_mm.distance(point) * r.amount_n;
        }
        let share = |sum: DVec3, size: f64| if size > 0.0 { sum.length() / size } else { 0.0 };
        share(force, forces).max(share(moment, moments))
    }
}
