//! Fixtures and loads of a part, resolved against its surface.
//!
//! A job names places in several ways (shapes, facets, faces). The code that reads the job resolves
//! them once into the types here. Plates ([`crate::plane`]), solids ([`crate::solid`]) and both
//! strength tests read only these types, so that a load means the same everywhere.
//!
//! Units: mm, N, N mm, MPa, t/mm3 (1 g/cm3 is 1e-9 t/mm3, so that density times mm/s2 is N/mm3).
//! Places and vectors are in part coordinates. A fixture holds in every load case; the loads of one
//! case act together.

use std::sync::Arc;

use grainpath_core::poly::{LineClipper, edges};
use grainpath_core::selection::{Selection, SurfacePatch};
use grainpath_core::{DMat3, DVec2, DVec3, Region};

/// Least share of a plate's height on which every fixture and load has to act. Source: derived: a force on the share s of the
/// height from one face acts (1 - s) / 2 of the height off the middle, and bends a bar that is held at its other end until the
/// stress at a face is 3 (1 - s) above the mean: 15 % for 0.95, what the reserve is off the virtual test. Measured: of
/// a bar of 60 x 12 x 8 mm pulled on 80 and 60 % of its end, 0.67 and 0.49 of the reserve is left, and 1 / (1 + 3 (1 - s)) is 0.63 and
/// 0.45.
const LEAST_SHARE_OF_HEIGHT: f64 = 0.95;
/// Heights at which places are looked up, evenly from the lowest point of the part to the highest. Source: derived: the least
/// share above leaves out two of them, so that a height that is rounded to layers leaves out one at most.
const HEIGHTS: usize = 41;
/// Distance between the points of a border at which places are looked up, mm. Source: derived: half a bead; what a place
/// catches between two points is less than one bead lays.
const LOOKED_UP_MM: f64 = 0.25;
/// Most points on the border, and most points inside. Source: chosen: a place in each of the latter is a fortieth of the plate
/// wide; looking up 40 places in 10 000 points takes tenths of a second.
const MOST_POINTS: [f64; 2] = [8000.0, 1600.0];

/// Fixtures, load cases and density: everything that acts on a part.
///
/// ```
/// use grainpath_core::DVec3;
/// use grainpath_fea::load_case::{Action, BoundaryConditions, Fixture, Held, Load, LoadCase};
/// use grainpath_core::selection::Selection;
///
/// let end = |x: f64| Selection::Plane {
///     point: DVec3::new(x, 0.0, 0.0),
///     normal: DVec3::X,
///     tolerance_mm: 0.01,
/// };
/// let root = Fixture {
///     name: "fixture 1".into(),
///     on: end(0.0),
///     held: Held::Axes([true; 3]),
///     displacement_mm: DVec3::ZERO,
/// };
/// let pull = Load {
///     name: "load 1".into(),
///     action: Action::Force { on: end(60.0), total_n: DVec3::new(500.0, 0.0, 0.0) },
/// };
/// let conditions = BoundaryConditions {
///     fixtures: vec![root],
///     cases: vec![LoadCase { name: "pull".into(), weight: 1.0, loads: vec![pull] }],
///     density_t_mm3: 1.24e-9,
///     low: DVec3::ZERO,
///     high: DVec3::new(60.0, 10.0, 4.0),
/// };
/// assert!(conditions.cases[0].is_in_plane());
/// assert_eq!(conditions.places().count(), 2);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryConditions {
    /// Fixtures, the same in every case.
    pub fixtures: Vec<Fixture>,
    /// Load cases; the loads of one case act together.
    pub cases: Vec<LoadCase>,
    /// Density of the material, t/mm3, for accelerations.
    pub density_t_mm3: f64,
    /// Lowest corner of the part's bounding box, mm.
    pub low: DVec3,
    /// Highest corner of the part's bounding box, mm.
    pub high: DVec3,
}

/// A place of the surface that is fixed.
#[derive(Debug, Clone, PartialEq)]
pub struct Fixture {
    /// Name in messages: "fixture 1".
    pub name: String,
    /// The surface that it holds.
    pub on: Selection,
    /// The motions that it prevents.
    pub held: Held,
    /// Prescribed displacement along the held directions, mm; zero for a fixture that does not
    /// move.
    pub displacement_mm: DVec3,
}

/// The directions in which a fixture holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Held {
    /// Along each of x, y and z whose entry is true.
    Axes([bool; 3]),
    /// Along the normal of the surface: a roller, or a plane of symmetry.
    Normal,
    /// Along each of the turned axes whose entry is true.
    Turned {
        /// Unit vectors along the axes, as columns.
        axes: DMat3,
        /// Whether the fixture holds along each of these axes.
        fixed: [bool; 3],
    },
}

/// Axes are taken as parallel or at a right angle within this sine. Source: derived; sine and cosine of a right angle in radians
/// are off by 1e-16, products of three rotations by a few of it.
const ALIGNED: f64 = 1e-12;

impl Held {
    /// Along some of the axes of a part that is turned by `rotation`: those of x, y and z whose entry is true.
    #[must_use]
    pub fn turned(rotation: DMat3, fixed: [bool; 3]) -> Self {
        if fixed == [true; 3] {
            return Self::Axes(fixed);
        }
        let mut held = [false; 3];
        for axis in (0..3).filter(|&a| fixed[a]) {
            let turned = rotation.col(axis).abs();
            let Some(onto) = (0..3).find(|&k| turned[k] > 1.0 - ALIGNED) else {
                return Self::Turned { axes: rotation, fixed };
            };
            held[onto] = true;
        }
        Self::Axes(held)
    }

    /// The directions in the plane of a plate along which it holds everywhere: none for [`Held::Normal`].
    pub fn in_plane(&self) -> impl Iterator<Item = DVec2> {
        let (axes, fixed) = match *self {
            Self::Axes(fixed) => (DMat3::IDENTITY, fixed),
            Self::Turned { axes, fixed } => (axes, fixed),
            Self::Normal => (DMat3::IDENTITY, [false; 3]),
        };
        (0..3)
            .filter(move |&a| fixed[a] && axes.col(a).z.abs() < ALIGNED)
            .map(move |a| axes.col(a).truncate())
    }

    /// Whether a plate can hold so: along directions in its plane or across it, but along none aslant of it.
    fn suits_plates(&self) -> bool {
        let Self::Turned { axes, fixed } = *self else { return true };
        let is_aslant = |z: f64| (ALIGNED..1.0 - ALIGNED).contains(&z.abs());
        !(0..3).any(|a| fixed[a] && is_aslant(axes.col(a).z))
    }
}

/// Tractions on a piece of the part's surface, given on another mesh of the part.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchTraction {
    /// The piece of the surface.
    pub patch: SurfacePatch,
    /// Traction at the corners of each triangle of the patch, MPa.
    pub corners_mpa: Arc<Vec<[DVec3; 3]>>,
    /// The resultant force that the tractions must have, N.
    pub force_n: DVec3,
    /// The moment about the origin that the tractions must have, N mm.
    pub moment_nmm: DVec3,
}

impl PatchTraction {
    /// The traction at a point of the part's surface with this outward normal, MPa; `None` off the patch.
    pub fn at(&self, p: DVec3, normal: DVec3) -> Option<DVec3> {
        let (triangle, shares) = self.patch.at(p, Some(normal))?;
        let corners = self.corners_mpa.get(triangle)?;
        Some(corners.iter().zip(shares).map(|(t, w)| *t * w).sum())
    }
}

/// Loads that act at the same time.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadCase {
    /// Name in reports.
    pub name: String,
    /// Weight of the case relative to the other cases; positive.
    pub weight: f64,
    /// Its loads.
    pub loads: Vec<Load>,
}

/// One load.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Name in messages: "load 1".
    pub name: String,
    /// Kind of load, and the surface it acts on.
    pub action: Action,
}

/// Kind of a load.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// A force, spread evenly over the selected area.
    Force {
        /// Where it acts.
        on: Selection,
        /// Its resultant, N.
        total_n: DVec3,
    },
    /// A pressure against the selected surface.
    Pressure {
        /// Where it acts.
        on: Selection,
        /// MPa, positive towards the material.
        mpa: f64,
    },
    /// A pure moment about the centroid of the selected area.
    Moment {
        /// Where it acts.
        on: Selection,
        /// Its resultant, N mm.
        total_nmm: DVec3,
    },
    /// The force of a pin or a bolt on the wall of a hole: a pressure on the loaded half of the wall,
    /// proportional to the cosine of the angle from the force.
    Bearing {
        /// The wall of the hole.
        on: Selection,
        /// Its resultant, N.
        total_n: DVec3,
    },
    /// A torque about an axis, applied as tangential forces that grow with the distance from the axis.
    Torque {
        /// Where it acts.
        on: Selection,
        /// A point of the axis, mm.
        point: DVec3,
        /// Unit vector along the axis.
        axis: DVec3,
        /// Its moment, N mm; positive by the right-hand rule.
        total_nmm: f64,
    },
    /// A force that acts at a point elsewhere and reaches the place through a rigid link that leaves it
    /// free to deform.
    RemoteForce {
        /// The place on the part where the link is attached.
        on: Selection,
        /// The force, N.
        total_n: DVec3,
        /// The point where it acts, mm.
        at_mm: DVec3,
    },
    /// One end of a bolt that clamps the part: a force towards the centre of its other end, spread evenly. The forces of
    /// both ends lie on one line, so that they cancel each other.
    Clamp {
        /// The surface below the head or the nut.
        on: Selection,
        /// The surface below the other end.
        towards: Selection,
        /// The tension of the bolt, N.
        total_n: f64,
    },
    /// The inertia of a part that turns about an axis.
    Centrifugal {
        /// A point of the axis, mm.
        point: DVec3,
        /// Unit vector along the axis.
        axis: DVec3,
        /// Speed, rad/s.
        rad_s: f64,
    },
    /// Tractions given on another mesh of the part, transferred so that their resultant force and moment are kept.
    Carried {
        /// The piece of the surface.
        on: Selection,
        /// The tractions that act there.
        traction: PatchTraction,
    },
    /// Forces at points of the surface.
    Points {
        /// The points.
        on: Selection,
        /// Each point, mm, with the force that acts on it, N.
        forces: Arc<Vec<(DVec3, DVec3)>>,
    },
    /// An acceleration of the whole part: gravity is (0, 0, -9810).
    Acceleration {
        /// mm/s2.
        mm_s2: DVec3,
    },
}

impl Action {
    /// The surface on which the load acts; `None` for loads on the whole volume.
    pub fn on(&self) -> Option<&Selection> {
        match self {
            Self::Force { on, .. }
            | Self::Pressure { on, .. }
            | Self::Moment { on, .. }
            | Self::Bearing { on, .. }
            | Self::Torque { on, .. }
            | Self::RemoteForce { on, .. }
            | Self::Clamp { on, .. }
            | Self::Carried { on, .. }
            | Self::Points { on, .. } => Some(on),
            Self::Centrifugal { .. } | Self::Acceleration { .. } => None,
        }
    }

    /// The key of the load in a job.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Force { .. } => "force_n",
            Self::Pressure { .. } => "pressure_mpa",
            Self::Moment { .. } => "moment_nmm",
            Self::Bearing { .. } => "bearing_n",
            Self::Torque { .. } => "torque_nmm",
            Self::RemoteForce { .. } => "at_mm",
            Self::Clamp { .. } => "preload_n",
            Self::Carried { .. } | Self::Points { .. } => "guide.deck",
            Self::Centrifugal { .. } => "centrifugal",
            Self::Acceleration { .. } => "acceleration_mm_s2",
        }
    }

    /// Whether the load can be solved for a solid only, not for a plate.
    pub fn is_for_solids(&self) -> bool {
        match self {
            Self::Bearing { .. }
            | Self::Torque { .. }
            | Self::RemoteForce { .. }
            | Self::Clamp { .. }
            | Self::Carried { .. }
            | Self::Points { .. }
            | Self::Centrifugal { .. } => true,
            Self::Force { .. } | Self::Pressure { .. } | Self::Moment { .. } | Self::Acceleration { .. } => {
                false
            }
        }
    }

    /// Whether the load leaves a plate in the xy plane flat: a force in the plane, a moment about
    /// z, any pressure on the plate's edge. Components up to 1e-9 of the vector count as rounding.
    pub fn is_in_plane(&self) -> bool {
        // Source: derived: turning a vector about several axes changes its components by rounding errors
        // of about 1e-15 of its length; 1e-9 is far above that and far below any load that matters.
        const ROUNDING: f64 = 1e-9;
        let flat = |v: &DVec3| v.z.abs() <= ROUNDING * v.length();
        match self {
            Self::Force { total_n: v, .. } | Self::Acceleration { mm_s2: v } => flat(v),
            Self::Pressure { .. } => true,
            // Parts with these loads are solved as solids.
            Self::Bearing { .. }
            | Self::Torque { .. }
            | Self::RemoteForce { .. }
            | Self::Clamp { .. }
            | Self::Carried { .. }
            | Self::Points { .. }
            | Self::Centrifugal { .. } => false,
            Self::Moment { total_nmm: m, .. } => m.truncate().length() <= ROUNDING * m.length(),
        }
    }
}

impl LoadCase {
    /// Whether all of its loads leave a plate in the xy plane flat.
    pub fn is_in_plane(&self) -> bool {
        self.loads.iter().all(|load| load.action.is_in_plane())
    }
}

impl BoundaryConditions {
    /// The selections of all fixtures and of the loads of all cases. The surface outside them is free.
    pub fn places(&self) -> impl Iterator<Item = &Selection> {
        let loads = self.cases.iter().flat_map(|case| &case.loads);
        self.fixtures.iter().map(|fixture| &fixture.on).chain(loads.filter_map(|load| load.action.on()))
    }

    /// The selections that act in a case, each with its name: fixtures, then the loads of the case.
    pub fn named_places<'a>(&'a self, case: &'a LoadCase) -> impl Iterator<Item = (&'a str, &'a Selection)> {
        let loads = case.loads.iter().filter_map(|l| Some((l.name.as_str(), l.action.on()?)));
        self.fixtures.iter().map(|f| (f.name.as_str(), &f.on)).chain(loads)
    }

    /// Whether a fixture holds in a way that plates do not support: aslant of their plane, or at places given by another mesh.
    pub fn are_held_in_space(&self) -> bool {
        let is = |f: &Fixture| {
            !f.held.suits_plates() || matches!(f.on, Selection::Patch(_) | Selection::Points(_))
        };
        self.fixtures.iter().any(is)
    }

    /// The first fixture or load that acts on less of the height than a plate of this section allows: on less than 95 % of the
    /// height of the points that it catches at any height. `None` if the part may be a plate.
    ///
    /// Points are looked up on the border, and inside at larger distances. What catches less than lies between two points is
    /// looked up once more a quarter of a millimetre around it.
    pub fn part_of_height(&self, section: &Region) -> Option<PartOfHeight> {
        let [on_border, inside] = MOST_POINTS;
        let step_mm = LOOKED_UP_MM.max(section.perimeter_mm() / on_border);
        let mut points = Vec::new();
        for contour in section.contours() {
            // Every contour has a point, however short it is.
            let mut next_mm = 0.0;
            for (a, b) in edges(contour) {
                let length_mm = a.distance(b);
                while next_mm < length_mm {
                    points.push(a.lerp(b, next_mm / length_mm));
                    next_mm += step_mm;
                }
                next_mm -= length_mm;
            }
        }
        // Loads on the volume and fixtures inside the section catch no border, so the inside is looked up too.
        let bounds = section.bounds()?;
        let (clipper, size) = (LineClipper::new(section), bounds.size());
        let pitch_mm = (size.x * size.y / inside).sqrt().max(step_mm);
        let [nx, ny] = [size.x, size.y].map(|mm| (mm / pitch_mm).ceil() as usize);
        let grid = (0..nx * ny)
            .map(|k| bounds.min + pitch_mm * (DVec2::new((k % nx) as f64, (k / nx) as f64) + 0.5));
        points.extend(grid.filter(|p| clipper.contains(*p)));
        let z_mm = |k: usize| self.low.z + (self.high.z - self.low.z) * k as f64 / (HEIGHTS - 1) as f64;
        // Points that a place catches at no height do not belong to it, and the others count each height that it leaves out.
        let share = |on: &Selection| {
            let at = |p: &DVec2| (0..HEIGHTS).filter(|k| on.contains(p.extend(z_mm(*k)))).count();
            let caught: Vec<usize> = points.iter().map(at).filter(|n| *n > 0).collect();
            let all = HEIGHTS * caught.len();
            (all > 0).then(|| caught.iter().sum::<usize>() as f64 / all as f64)
        };
        let loads = self.cases.iter().flat_map(|case| &case.loads);
        let loads = loads.filter_map(|load| Some((&load.name, load.action.on()?)));
        self.fixtures.iter().map(|fixture| (&fixture.name, &fixture.on)).chain(loads).find_map(
            |(name, on)| {
                // A roller touches the border at a point that may lie between two that were looked up.
                let share = share(on).or_else(|| share(&on.grown(step_mm))).unwrap_or(0.0);
                let short = PartOfHeight { name: name.clone(), shape: on.name(), share };
                (share < LEAST_SHARE_OF_HEIGHT).then_some(short)
            },
        )
    }

    /// The index of the case with the largest weight, the first of equal ones; `None` without cases.
    pub fn heaviest_case(&self) -> Option<usize> {
        let by_weight = |a: &usize, b: &usize| self.cases[*a].weight.total_cmp(&self.cases[*b].weight);
        // `max_by` returns the last of equal values; on the reversed list that is the first case.
        (0..self.cases.len()).rev().max_by(by_weight)
    }

    /// The error for a fixture or load whose selection contains none of `searched`: "the part's surface".
    pub fn catches_nothing(&self, name: &str, on: &Selection, searched: &'static str) -> CatchesNothing {
        CatchesNothing { name: name.to_owned(), shape: on.name(), searched, low: self.low, high: self.high }
    }
}

/// A fixture or load that acts on a part of a plate's height, which a plate cannot tell from one on all of it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{name} ({shape}) acts on {:.0} % of the part's height, not on all of it", 100.0 * share)]
pub struct PartOfHeight {
    /// "fixture 1", "load 2".
    pub name: String,
    /// The kind of selection: "box".
    pub shape: &'static str,
    /// The share of the height on which it acts, the mean of all points that it catches; 0 if none was found.
    pub share: f64,
}

/// A fixture or load whose selection contains no part of the surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "{name} ({shape}) contains nothing of {searched}; the part lies from ({:.2}, {:.2}, {:.2}) to ({:.2}, {:.2}, {:.2}) mm",
    low.x, low.y, low.z, high.x, high.y, high.z
)]
pub struct CatchesNothing {
    /// "fixture 1", "load 2".
    pub name: String,
    /// The kind of selection: "box".
    pub shape: &'static str,
    /// The geometry that was searched: "the part's surface".
    pub searched: &'static str,
    /// Lowest corner of the part's bounding box, mm.
    pub low: DVec3,
    /// Highest corner of the part's bounding box, mm.
    pub high: DVec3,
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use grainpath_core::Polygon;
    use grainpath_core::math::direction;
    use grainpath_core::selection::Facets;

    use super::*;

    fn anywhere() -> Selection {
        Selection::Sphere { centre: DVec3::ZERO, radius_mm: 1e3 }
    }

    #[test]
    fn loads_out_of_the_plane_are_told_from_loads_in_it() {
        let force = |total_n| Action::Force { on: anywhere(), total_n };
        let moment = |total_nmm| Action::Moment { on: anywhere(), total_nmm };
        assert!(force(DVec3::new(3.0, -4.0, 0.0)).is_in_plane());
        assert!(!force(DVec3::new(3.0, -4.0, 1e-3)).is_in_plane());
        assert!(moment(DVec3::Z).is_in_plane() && !moment(DVec3::new(1e-3, 0.0, 1.0)).is_in_plane());
        assert!(Action::Pressure { on: anywhere(), mpa: 1.0 }.is_in_plane());
        assert!(!Action::Acceleration { mm_s2: DVec3::new(0.0, 0.0, -9810.0) }.is_in_plane());
    }

    /// A bar of 60 x 10 mm with a hole, 20 mm high, with a place of every kind on its whole height and on a part of it.
    #[test]
    fn places_on_a_part_of_the_height_are_told_from_those_on_all_of_it() {
        let hole = (0..64).map(|k| DVec2::new(30.0, 5.0) + 2.0 * direction(f64::from(k) * -TAU / 64.0));
        let outer = Region::rectangle(DVec2::ZERO, DVec2::new(60.0, 10.0));
        let section = outer.difference(&Polygon { outer: hole.rev().collect(), holes: Vec::new() }.into());
        let on_box = |x: [f64; 2], y: [f64; 2], z: [f64; 2]| Selection::Box {
            low: DVec3::new(x[0], y[0], z[0]),
            high: DVec3::new(x[1], y[1], z[1]),
        };
        let end = |z| on_box([0.0, 4.0], [0.0, 10.0], z);
        let plane = |point, normal| Selection::Plane { point, normal, tolerance_mm: 0.01 };
        let bore = |length_mm| Selection::Cylinder {
            point: DVec3::new(30.0, 5.0, 10.0),
            axis: DVec3::Z,
            radius_mm: 2.05,
            length_mm,
        };
        let ball = |radius_mm| Selection::Sphere { centre: DVec3::new(0.0, 5.0, 10.0), radius_mm };
        let side = |top: f64| {
            let [a, b] = [0.0, 10.0].map(|y| DVec3::new(0.0, y, 0.0));
            let up = DVec3::Z * top;
            Selection::Triangles(Facets::new(vec![[a, b, b + up], [a, b + up, a + up]]))
        };
        let found = |on: Selection| {
            let fixture = Fixture {
                name: "fixture 1".into(),
                on: end([0.0, 20.0]),
                held: Held::Axes([true; 3]),
                displacement_mm: DVec3::ZERO,
            };
            let load = Load { name: "load 1".into(), action: Action::Force { on, total_n: DVec3::X } };
            let conditions = BoundaryConditions {
                fixtures: vec![fixture],
                cases: vec![LoadCase { name: String::new(), weight: 1.0, loads: vec![load] }],
                density_t_mm3: 0.0,
                low: DVec3::ZERO,
                high: DVec3::new(60.0, 10.0, 20.0),
            };
            conditions.part_of_height(&section)
        };
        let whole = [
            end([0.0, 20.0]),
            end([-1.0, 21.0]),
            // Typed a little short, or rounded to layers.
            end([0.2, 19.8]),
            end([0.0, 19.1]),
            // Inside the border alone.
            on_box([8.0, 12.0], [3.0, 7.0], [0.0, 20.0]),
            plane(DVec3::ZERO, DVec3::X),
            bore(None),
            bore(Some(20.0)),
            // A roller that touches the border at one point.
            Selection::Cylinder {
                point: DVec3::new(17.13, -3.0, 0.0),
                axis: DVec3::Z,
                radius_mm: 3.0,
                length_mm: None,
            },
            side(20.0),
        ];
        for on in whole {
            assert_eq!(found(on.clone()), None, "{on:?}");
        }
        let part = [
            (end([-1.0, 4.0]), 0.2),
            (end([0.0, 18.0]), 0.9),
            (end([9.5, 10.5]), 0.05),
            (plane(DVec3::ZERO, DVec3::Z), 0.02),
            (bore(Some(10.0)), 0.5),
            (ball(10.5), 0.5),
            (side(10.0), 0.5),
            // Beside the part.
            (end([21.0, 25.0]), 0.0),
        ];
        for (on, share) in part {
            let short = found(on.clone()).unwrap_or_else(|| panic!("{on:?}"));
            assert_eq!(short.name, "load 1");
            let off = (short.share - share).abs();
            assert!(off < 0.05 || matches!(on, Selection::Sphere { .. }), "{on:?}: {}", short.share);
        }
    }

    #[test]
    fn of_equally_heavy_cases_the_first_is_taken() {
        let case = |weight| LoadCase { name: String::new(), weight, loads: Vec::new() };
        let conditions = |weights: &[f64]| BoundaryConditions {
            fixtures: Vec::new(),
            cases: weights.iter().map(|w| case(*w)).collect(),
            density_t_mm3: 0.0,
            low: DVec3::ZERO,
            high: DVec3::ONE,
        };
        assert_eq!(conditions(&[1.0, 2.0, 2.0]).heaviest_case(), Some(1));
        assert_eq!(conditions(&[]).heaviest_case(), None);
    }
}
