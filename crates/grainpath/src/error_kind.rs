//! Kinds of errors, the same for all stages.

/// Whose mistake an error is, for front ends that answer differently to each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The job asks for something that is not there or makes no sense.
    Job,
    /// An input file cannot be used.
    Input,
    /// What was asked for is impossible: off the bed, no such mass, no solution.
    Physics,
    /// The user stopped the run.
    Interrupted,
}
