//! Colours of beads, and the values that they stand for.

use grainpath_core::Role;

use super::{DrawnBead, LayerPicture};

/// The quantity that the colour of a bead shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColourBy {
    /// The role of the bead.
    #[default]
    Role,
    /// The width of the bead.
    Width,
    /// The speed of the bead.
    Speed,
    /// The angle between the bead and the direction of the guide: blue at 0 degrees, red from 45 degrees
    /// on.
    Direction,
}

impl ColourBy {
    /// The choice with this name: `role`, `width`, `speed` or `direction`.
    pub fn from_name(name: &str) -> Option<Self> {
        let names = [
            ("role", Self::Role),
            ("width", Self::Width),
            ("speed", Self::Speed),
            ("direction", Self::Direction),
        ];
        grainpath_core::spelling::meaning(&names, name)
    }
}

/// A colour, red green blue.
pub(super) type Rgb = [u8; 3];

/// Colour of beads without a value, such as those for which the guide asks for no direction: a grey that is not on the
/// ramp, so that it cannot be read as a value. Source: chosen by eye; only the picture depends on it.
pub(crate) const UNASKED: Rgb = [88, 92, 100];

/// The colour of a role, similar to those in the previews of slicers.
pub fn of_role(role: Role) -> Rgb {
    match role {
        Role::OuterWall => [242, 120, 45],
        Role::InnerWall => [250, 200, 70],
        Role::ThinWall => [214, 60, 60],
        Role::GapFill => [240, 240, 245],
        Role::SolidFill => [150, 84, 204],
        Role::SeedLine => [84, 30, 140],
        Role::TopSkin => [228, 64, 92],
        Role::SparseFill => [178, 74, 60],
        Role::Fibre => [70, 200, 190],
        Role::Bridge => [80, 130, 225],
        Role::Skirt | Role::Brim => [20, 120, 100],
        Role::Support => [60, 180, 75],
        Role::SupportInterface => [30, 130, 50],
    }
}

/// A scale from values to colours, over the range of one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    by: ColourBy,
    /// The lowest value: mm, mm/s or degrees.
    pub low: f64,
    /// The highest.
    pub high: f64,
}

impl Scale {
    /// The scale of a layer.
    pub fn new(picture: &LayerPicture, by: ColourBy) -> Self {
        // The range for directions is fixed, so that layers and jobs can be compared. A bead at 45 degrees runs
        // as much across the direction as along it.
        if by == ColourBy::Direction {
            return Self { by, low: 0.0, high: 45.0 };
        }
        let value = |b: &DrawnBead| if by == ColourBy::Width { b.width_mm } else { b.speed_mm_s };
        let fold = |(lo, hi): (f64, f64), v: f64| (lo.min(v), hi.max(v));
        let (low, high) = picture.beads.iter().map(value).fold((f64::INFINITY, f64::NEG_INFINITY), fold);
        Self { by, low, high }
    }

    /// The bead's colour.
    pub fn colour(&self, bead: &DrawnBead) -> Rgb {
        match self.by {
            ColourBy::Role => of_role(bead.role),
            ColourBy::Width => self.ramp(bead.width_mm),
            ColourBy::Speed => self.ramp(bead.speed_mm_s),
            ColourBy::Direction => bead.off_deg.map_or(UNASKED, |off| self.ramp(off)),
        }
    }

    fn ramp(&self, value: f64) -> Rgb {
        ramp(value, self.low, self.high)
    }
}

/// The colour of a value on the ramp from blue through green and yellow to red. An empty range gives the middle colour.
pub(super) fn ramp(value: f64, low: f64, high: f64) -> Rgb {
    // Five colours in even steps, chosen so that neighbours differ and the bead's darker rim still shows
    // on each. No value is read back from a picture.
    // Source: chosen by eye; only the picture depends on it.
    const STOPS: [[f64; 3]; 5] = [
        [60.0, 80.0, 200.0],
        [50.0, 160.0, 200.0],
        [90.0, 190.0, 90.0],
        [240.0, 205.0, 70.0],
        [215.0, 60.0, 50.0],
    ];
    let span = high - low;
    let t = if span > 1e-9 { ((value - low) / span).clamp(0.0, 1.0) } else { 0.5 };
    let x = t * (STOPS.len() - 1) as f64;
    // The greatest value belongs to the last interval; without the bound it would index past the end.
    let i = (x as usize).min(STOPS.len() - 2);
    let f = x - i as f64;
    std::array::from_fn(|k| (STOPS[i][k] * (1.0 - f) + STOPS[i + 1][k] * f).round() as u8)
}
