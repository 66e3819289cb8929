//! Points of overhangs, and the contacts that hold them: the data that pass from `overhang` to `tree`, `cut`
//! and `held`.
//!
//! A [`Sample`] stands for a small area of an overhang. A [`Contact`] is a point at which a support is to
//! touch the part; it holds the samples around it. A [`ContactGrid`] says where the contacts of one overhang are
//! placed. Lengths are in mm in the coordinates of the part on the plate, areas in mm2 in plan; normals point
//! out of the part.

use grainpath_core::DVec3;

/// A point of an overhang, on the part's surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Its position, mm.
    pub at: DVec3,
    /// The surface's outward normal there.
    pub normal: DVec3,
    /// Area of the overhang that the point stands for, in plan, mm2.
    pub area_mm2: f64,
}

/// The kind of overhang that a contact holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// Facets that lean by more than the critical angle.
    Facets,
    /// An edge that leans by more than the critical angle, between facets that do not.
    Edge,
    /// The part begins here in mid-air.
    Lowest,
}

/// A point at which the support touches the part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Its position on the part, mm.
    pub at: DVec3,
    /// The surface's outward normal there, unit length.
    pub normal: DVec3,
    /// Area of the overhang that it holds, in plan, mm2.
    pub area_mm2: f64,
    /// The kind of overhang that it holds.
    pub reason: Reason,
    /// The least length of its tip, mm. It is more than 0 where arches below interface lines end on the tip.
    pub tip_mm: f64,
}

/// The grid in plan that the contacts of an overhang are placed on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactGrid {
    /// Lowest corner of the overhang, where the grid begins.
    pub low: DVec3,
    /// Width of a cell, mm.
    pub cell_mm: f64,
}
