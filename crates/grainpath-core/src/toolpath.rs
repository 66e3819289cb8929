//! Paths of beads in printing order, in part coordinates: made by the planner, written as G-code.
//!
//! A [`Toolpath`] is one bead, a [`LayerPlan`] the paths of a layer with the travels between them,
//! a [`Plan`] all layers. Lengths are mm; widths are full widths of the bead.

use glam::{DVec2, DVec3};

use crate::units::bead_area_mm2;

/// The purpose of a bead. Viewers of G-code colour beads by the names of these roles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// The wall that is seen from outside.
    OuterWall,
    /// Any wall inside the outer one.
    InnerWall,
    /// A single bead where two walls do not fit.
    ThinWall,
    /// A single bead of varying width between walls, or between walls and fill.
    GapFill,
    /// Dense fill not seen from outside, and the lowest layers.
    SolidFill,
    /// Dense fill seen from above.
    TopSkin,
    /// Fill of less than full density.
    SparseFill,
    /// Continuous fibre.
    Fibre,
    /// Fill over air.
    Bridge,
    /// Loops around the part that start the flow.
    Skirt,
    /// Loops around the part that hold it down.
    Brim,
    /// Support.
    Support,
    /// The layers of the support that touch the part.
    SupportInterface,
    /// A line of dense fill that is laid first; the rest of the fill consists of its offsets.
    SeedLine,
}

impl Role {
    /// Every role.
    pub const ALL: [Self; 14] = [
        Self::OuterWall,
        Self::InnerWall,
        Self::ThinWall,
        Self::GapFill,
        Self::SolidFill,
        Self::TopSkin,
        Self::SparseFill,
        Self::Fibre,
        Self::Bridge,
        Self::Skirt,
        Self::Brim,
        Self::Support,
        Self::SupportInterface,
        Self::SeedLine,
    ];

    /// The name after `;TYPE:` in G-code, as PrusaSlicer writes it.
    pub const fn gcode_name(self) -> &'static str {
        match self {
            Self::OuterWall => "External perimeter",
            Self::InnerWall => "Perimeter",
            Self::ThinWall => "Thin wall",
            Self::GapFill => "Gap fill",
            Self::SolidFill => "Solid infill",
            Self::TopSkin => "Top solid infill",
            Self::SparseFill => "Internal infill",
            Self::Fibre => "Fibre infill",
            Self::Bridge => "Bridge infill",
            Self::Skirt => "Skirt",
            Self::Brim => "Brim",
            Self::Support => "Support material",
            Self::SupportInterface => "Support material interface",
            Self::SeedLine => "Seed line",
        }
    }

    /// Whether the bead is a wall of the part.
    pub const fn is_wall(self) -> bool {
        matches!(self, Self::OuterWall | Self::InnerWall | Self::ThinWall)
    }

    /// Whether the bead belongs to the part, in contrast to skirt, brim and support.
    pub const fn is_part(self) -> bool {
        !matches!(self, Self::Skirt | Self::Brim | Self::Support | Self::SupportInterface)
    }

    /// Whether the bead belongs to the part and is not a wall.
    pub const fn is_fill(self) -> bool {
        self.is_part() && !self.is_wall()
    }
}

/// Class of a path's speed, for paths whose speed depends on more than their role.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SpeedClass {
    /// The speed of the path's role.
    #[default]
    Normal,
    /// A wall around a small hole or island.
    SmallWall,
    /// A wall that hangs over air.
    Overhang,
    /// Fill over air.
    Bridge,
}

/// Bead width along a path, mm.
#[derive(Debug, Clone, PartialEq)]
pub enum BeadWidth {
    /// The same width all along.
    Constant(f64),
    /// One width for each vertex, linear between them.
    PerVertex(Vec<f64>),
}

/// How far the bottom and the top of a bead lie above those of its layer, mm. Both are 0 except for staggered walls,
/// which stand half a layer higher than their neighbours.
///
/// ```text
///          ┌────┐ <- top_mm above the layer
///     ┌────┤    ├────┐ top of the layer
///     │    │    │    │
///     │    └────┘ <- bottom_mm above the layer's bottom
///     └────┘    └────┘ bottom of the layer
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BeadRaise {
    /// How far the bead's bottom lies above the layer's bottom.
    pub bottom_mm: f64,
    /// How far the bead's top, where the nozzle is, lies above the layer's top.
    pub top_mm: f64,
}

/// A polyline along the middle of a bead.
///
/// ```
/// use grainpath_core::{BeadRaise, BeadWidth, DVec2, Role, SpeedClass, Toolpath};
///
/// let path = Toolpath {
///     points: vec![DVec2::ZERO, DVec2::new(10.0, 0.0), DVec2::new(10.0, 10.0), DVec2::new(0.0, 10.0)],
///     width: BeadWidth::Constant(0.45),
///     role: Role::OuterWall,
///     speed: SpeedClass::Normal,
///     flow: 1.0,
///     closed: true,
///     rank: 0,
///     raise: BeadRaise::default(),
/// };
/// assert_eq!((path.n_segments(), path.length_mm()), (4, 40.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Toolpath {
    /// The centreline, mm, part coordinates. A closed path does not repeat its first point.
    pub points: Vec<DVec2>,
    /// Full width of the bead.
    pub width: BeadWidth,
    /// Factor on the material laid: cross-section of the bead over that of a stadium. It may be
    /// below 1 for bridges.
    pub flow: f64,
    /// Purpose of the bead.
    pub role: Role,
    /// Speed of printing.
    pub speed: SpeedClass,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Fill of lower rank is printed first, island by island; 0 unless a pattern prescribes an
    /// order.
    pub rank: u8,
    /// How far it stands above its layer.
    pub raise: BeadRaise,
}

impl Toolpath {
    /// A path of one width at its role's normal speed.
    pub fn new(points: Vec<DVec2>, width_mm: f64, role: Role, closed: bool) -> Self {
        let width = BeadWidth::Constant(width_mm);
        let raise = BeadRaise::default();
        Self { points, width, flow: 1.0, role, speed: SpeedClass::Normal, closed, rank: 0, raise }
    }

    /// Returns the memory that the points and widths reserve beyond their number. A plan keeps all paths of a part until
    /// its end, so what they reserved while they grew would be kept as well.
    pub fn shrink_to_fit(&mut self) {
        self.points.shrink_to_fit();
        if let BeadWidth::PerVertex(widths_mm) = &mut self.width {
            widths_mm.shrink_to_fit();
        }
    }

    /// Height of the bead in a layer of this height, mm.
    pub fn height_mm(&self, layer_mm: f64) -> f64 {
        layer_mm + (self.raise.top_mm - self.raise.bottom_mm)
    }

    /// Width at vertex `i`, mm. For a closed path `i` may equal the number of points, which means the first vertex.
    pub fn width_at(&self, i: usize) -> f64 {
        match &self.width {
            BeadWidth::Constant(w) => *w,
            BeadWidth::PerVertex(w) => w[i % w.len()],
        }
    }

    /// Number of straight segments.
    pub fn n_segments(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len().saturating_sub(1) }
    }

    /// Segment `i`: its two ends and the mean width along it.
    #[inline]
    pub fn segment(&self, i: usize) -> (DVec2, DVec2, f64) {
        let j = if i + 1 < self.points.len() { i + 1 } else { 0 };
        (self.points[i], self.points[j], 0.5 * (self.width_at(i) + self.width_at(j)))
    }

    /// Length of the centreline, mm.
    pub fn length_mm(&self) -> f64 {
        (0..self.n_segments()).map(|i| self.segment(i)).map(|(a, b, _)| a.distance(b)).sum()
    }

    /// Volume laid in a layer of this height, mm3.
    pub fn volume_mm3(&self, layer_mm: f64) -> f64 {
        let height_mm = self.height_mm(layer_mm);
        let segments = (0..self.n_segments()).map(|i| self.segment(i));
        // The volume depends linearly on the mean width. Along a segment whose width passes the
        // height of the bead, the result is slightly too low.
        segments.map(|(a, b, w)| a.distance(b) * bead_area_mm2(w, height_mm)).sum::<f64>() * self.flow
    }

    /// The point where printing starts.
    pub fn start(&self) -> DVec2 {
        self.points[0]
    }

    /// The point where printing ends: the start again for a closed path.
    pub fn end(&self) -> DVec2 {
        if self.closed { self.points[0] } else { self.points[self.points.len() - 1] }
    }

    /// The same path as an open one: a closed one then ends where it begins.
    pub fn opened(mut self) -> Self {
        if self.closed {
            self.closed = false;
            self.points.extend(self.points.first().copied());
            if let BeadWidth::PerVertex(widths_mm) = &mut self.width {
                widths_mm.extend(widths_mm.first().copied());
            }
        }
        self
    }

    /// The part of an open path between two lengths along it, mm. Widths at its ends are interpolated. Points
    /// that lie on each other become one.
    ///
    /// ```
    /// use grainpath_core::{DVec2, Role, Toolpath};
    ///
    /// let path = Toolpath::new(vec![DVec2::ZERO, DVec2::new(10.0, 0.0)], 0.4, Role::SparseFill, false);
    /// assert_eq!(path.part(2.0, 5.0).points, [DVec2::new(2.0, 0.0), DVec2::new(5.0, 0.0)]);
    /// ```
    pub fn part(&self, from_mm: f64, to_mm: f64) -> Self {
        /// The end of a segment and the start of the next are one point if they are nearer than the root of
        /// this, a nanometre. Source: derived: coordinates of a metre are rounded to a millionth of that.
        const SAME_MM2: f64 = 1e-18;
        let (mut points, mut widths) = (Vec::new(), Vec::new());
        let mut done = 0.0;
        for i in 0..self.n_segments() {
            let (a, b, _) = self.segment(i);
            let l = a.distance(b);
            let (low, high) = ((from_mm - done).max(0.0), (to_mm - done).min(l));
            if low <= high && l > 0.0 {
                for t in [low / l, high / l] {
                    let p = a.lerp(b, t);
                    if points.last().is_none_or(|q: &DVec2| q.distance_squared(p) > SAME_MM2) {
                        points.push(p);
                        widths.push(self.width_at(i) * (1.0 - t) + self.width_at(i + 1) * t);
                    }
                }
            }
            done += l;
        }
        let width = match &self.width {
            BeadWidth::Constant(width_mm) => BeadWidth::Constant(*width_mm),
            BeadWidth::PerVertex(_) => BeadWidth::PerVertex(widths),
        };
        Self { points, width, ..self.clone() }
    }

    /// Reverses the path. A closed path keeps its start.
    pub fn reverse(&mut self) {
        self.points.reverse();
        if let BeadWidth::PerVertex(w) = &mut self.width {
            w.reverse();
        }
        // Reversing moves the start of a closed path to the end of the list.
        if self.closed {
            self.rotate_to(self.points.len().saturating_sub(1));
        }
    }

    /// Makes vertex `i` of a closed path its start.
    pub fn rotate_to(&mut self, i: usize) {
        self.points.rotate_left(i);
        if let BeadWidth::PerVertex(w) = &mut self.width {
            w.rotate_left(i);
        }
    }
}

/// The way of the nozzle to the start of a path, without printing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Travel {
    /// Points passed on the way, without the path's start.
    pub via: Vec<DVec2>,
    /// Whether the filament is retracted for it.
    pub retract: bool,
}

/// A path and the travel to it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedPath {
    /// Travel from the end of the path before.
    pub travel: Travel,
    /// The path that is printed.
    pub path: Toolpath,
}

/// The paths of one layer, in printing order.
///
/// ```
/// use grainpath_core::{DVec2, LayerPlan, PlannedPath, Role, Toolpath, Travel};
///
/// let bead = |y_mm: f64| {
///     let points = vec![DVec2::new(0.0, y_mm), DVec2::new(20.0, y_mm)];
///     let path = Toolpath::new(points, 0.45, Role::SolidFill, false);
///     PlannedPath { travel: Travel::default(), path }
/// };
/// // The second layer of 0.2 mm: the nozzle stands at its top.
/// let layer = LayerPlan { z_top_mm: 0.4, height_mm: 0.2, paths: vec![bead(0.0), bead(0.4)] };
/// let volume_mm3: f64 = layer.paths.iter().map(|p| p.path.volume_mm3(layer.height_mm)).sum();
/// // Two beads of 20 mm, with a section of 0.2 (0.45 - 0.2 (1 - pi/4)) mm2.
/// assert!((volume_mm3 - 3.257).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LayerPlan {
    /// Height of the nozzle above the plate, mm.
    pub z_top_mm: f64,
    /// Thickness of the layer, mm.
    pub height_mm: f64,
    /// The paths, in printing order.
    pub paths: Vec<PlannedPath>,
}

/// A whole print.
///
/// ```
/// use grainpath_core::{BeadRaise, BeadWidth, DVec2, DVec3, LayerPlan, Plan, PlannedPath, Role, SpeedClass, Toolpath, Travel};
///
/// let path = Toolpath {
///     points: vec![DVec2::ZERO, DVec2::new(20.0, 0.0)],
///     width: BeadWidth::Constant(0.45),
///     flow: 1.0,
///     role: Role::SolidFill,
///     speed: SpeedClass::Normal,
///     closed: false,
///     rank: 0,
///     raise: BeadRaise::default(),
/// };
/// let travel = Travel { via: Vec::new(), retract: false };
/// let layer = LayerPlan { z_top_mm: 0.2, height_mm: 0.2, paths: vec![PlannedPath { travel, path }] };
/// let plan = Plan { layers: vec![layer], plate_from_part_mm: DVec3::new(100.0, 100.0, 0.0) };
/// let printed_mm: f64 = plan.layers.iter().flat_map(|l| &l.paths).map(|p| p.path.length_mm()).sum();
/// assert_eq!(printed_mm, 20.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Lowest first.
    pub layers: Vec<LayerPlan>,
    /// Position of the part: plate coordinates are part coordinates plus this. It is added once,
    /// when G-code is written. Heights of layers are counted from the plate already, so G-code
    /// uses its z only in the header.
    pub plate_from_part_mm: DVec3,
}
