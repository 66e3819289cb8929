//! Kinds of errors, the same for all stages.

/// The kind of an error by who has to act on it. Front ends respond differently to each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The job names something that does not exist, or contradicts itself.
    Job,
    /// An input file cannot be used.
    Input,
    /// The job cannot be fulfilled: the part lies outside the bed, no density gives the mass, or an analysis
    /// has no solution.
    Physics,
    /// The user stopped the run.
    Interrupted,
}
