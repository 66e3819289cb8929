//! Kinds of errors, the same for all stages.

/// Who has to act on an error. Front ends answer differently to each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The job names something that does not exist, or contradicts itself.
    Job,
    /// An input file cannot be used.
    Input,
    /// The job cannot be met: the part is off the bed, no density gives the mass, or there is no
    /// solution.
    Physics,
    /// The user stopped the run.
    Interrupted,
}
