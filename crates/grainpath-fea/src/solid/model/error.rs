//! Errors of meshing and solving a solid.

use thiserror::Error;

use crate::load_case::CatchesNothing;

/// Why a part could not be meshed or solved.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SolidError {
    /// A stop was asked for.
    #[error(transparent)]
    Interrupted(#[from] grainpath_core::diagnostics::Interrupted),
    /// The lattice has no point inside the part.
    #[error("the mesh encloses nothing to compute on; a closed surface is needed")]
    NothingInside,
    /// More lattice points than are allowed.
    #[error(
        "elements this small need {points:.0} lattice points; {least_mm:.3} mm is the smallest size for this part"
    )]
    TooFine {
        /// Lattice points over the part's box.
        points: f64,
        /// Smallest size that is accepted, mm.
        least_mm: f64,
    },
    /// Walls thinner than an element.
    #[error(
        "walls of {thickness_mm:.2} mm are too thin for elements of {size_mm:.2} mm; {}",
        advice(*thickness_mm, *fitting_mm, *limit_mib)
    )]
    ThinWalls {
        /// Thickness that the walls of all but two percent of the volume exceed, mm.
        thickness_mm: f64,
        /// Element size, mm.
        size_mm: f64,
        /// Largest of the sizes that resolve the walls and fit the memory limit, mm; `None` where
        /// no size does both.
        fitting_mm: Option<f64>,
        /// Memory limit, MiB.
        limit_mib: f64,
    },
    /// More memory than allowed.
    #[error(
        "{what} would take {need_mib:.0} MiB of the {limit_mib:.0} MiB allowed; elements of {fitting_mm:.2} mm fit"
    )]
    Memory {
        /// The step that would need it.
        what: &'static str,
        /// Estimate, MiB.
        need_mib: f64,
        /// Limit, MiB.
        limit_mib: f64,
        /// Element size that fits the limit, mm.
        fitting_mm: f64,
    },
    /// A fixture or load without a face.
    #[error(transparent)]
    CatchesNothing(#[from] CatchesNothing),
    /// A fixture or load whose place lies on the part, between the middles of the elements' sides.
    #[error(
        "{name} ({shape}) is smaller than the elements of about {element_mm:.2} mm and holds the middle of none of their sides; \
         lower guide.element_mm, or take a larger place"
    )]
    PlaceTooSmall {
        /// "fixture 1", "load 2".
        name: String,
        /// The kind of selection: "sphere".
        shape: &'static str,
        /// Size of the elements, mm.
        element_mm: f64,
    },
    /// A bearing load that its wall does not face.
    #[error(
        "{name}: bearing_n presses on a wall that faces the force, and no wall of its place does so; take the wall of a hole across \
         the force, or force_n for a force along or away from a wall"
    )]
    NoBearing {
        /// "load 1".
        name: String,
    },
    /// The part is not held.
    #[error("piece {piece} of {pieces} (around {around}) is not held: it is free to {free}")]
    Free {
        /// Number of the piece, from 1.
        piece: usize,
        /// Number of pieces.
        pieces: usize,
        /// Its position, as text in mm.
        around: String,
        /// The motions left, as text.
        free: String,
    },
    /// Constraints that contradict one another.
    #[error("node {node} at {at} is prescribed two different displacements along one direction")]
    Contradiction {
        /// Node index.
        node: usize,
        /// Its place, as text in mm.
        at: String,
    },
    /// A stiffness that no material has.
    #[error("the stiffness of material {material} is not symmetric and positive")]
    Material {
        /// Its index.
        material: usize,
    },
    /// The factorization broke down.
    #[error("the stiffness matrix is not positive definite; an element may be turned inside out")]
    NotPositive,
    /// A load that is no number, or with which the solver cannot compute.
    #[error("a load or a prescribed displacement is not a finite number, or too large to compute with")]
    LoadNotFinite,
    /// The iteration ended before it reached the required residual.
    #[error("the solution did not converge: residual {residual:.1e} after {iterations} iterations")]
    NotConverged {
        /// Relative residual reached.
        residual: f64,
        /// Iterations made.
        iterations: usize,
    },
}

/// The remedy for walls that are too thin for the elements.
fn advice(thickness_mm: f64, fitting_mm: Option<f64>, limit_mib: f64) -> String {
    match fitting_mm {
        Some(size_mm) => format!("elements of {size_mm:.2} mm resolve them within {limit_mib:.0} MiB"),
        None => format!(
            "no element size resolves walls of {thickness_mm:.2} mm within the memory limit of {limit_mib:.0} MiB: raise \
             the limit or thicken the walls"
        ),
    }
}
