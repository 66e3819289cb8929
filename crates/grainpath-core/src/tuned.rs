//! Numbers that were chosen by measurement, and the means to measure them again.
//!
//! Some constants of a fill, of a support or of the strength test cannot be derived from a formula
//! or taken from a paper. They were chosen because the plans came out best. Such a constant is a
//! [`Tuned`] number. It has a name, and `cargo xtask bench constants NAME` plans the same pieces
//! with five or more values of it and prints gap, overlap, angle, paths and printing time of each,
//! so that anyone can see how much depends on the choice.
//!
//! Ordinary builds use the value in the source only. The bench builds the program with the feature
//! `sweep`. The command line of such a build passes the environment variable `GRAINPATH_SWEEP` to this
//! module (`fill.continuous.finish.GAP=1.5`, or several with commas between them).
//!
//! ```
//! use grainpath_core::tuned::Tuned;
//!
//! /// Rounds of smoothing. Measured: row `example.ROUNDS` of `cargo xtask bench constants`.
//! static ROUNDS: Tuned<usize> = Tuned::new("example.ROUNDS", 3);
//! assert_eq!(ROUNDS.value(), 3);
//! ```

/// A number chosen by measurement, with the name of its row in `cargo xtask bench constants`.
#[derive(Debug)]
pub struct Tuned<T> {
    name: &'static str,
    value: T,
    #[cfg(feature = "sweep")]
    swept: std::sync::OnceLock<Option<T>>,
}

impl<T: Copy + std::str::FromStr> Tuned<T> {
    /// A number with its name in the bench: the modules and the constant, separated by dots.
    #[must_use]
    pub const fn new(name: &'static str, value: T) -> Self {
        Self {
            name,
            value,
            #[cfg(feature = "sweep")]
            swept: std::sync::OnceLock::new(),
        }
    }

    /// The name of its row in the bench.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// The value to compute with.
    #[inline]
    #[must_use]
    pub fn value(&self) -> T {
        #[cfg(feature = "sweep")]
        if let Some(swept) = self.swept.get_or_init(|| swept(self.name)) {
            return *swept;
        }
        self.value
    }
}

/// Names and values of the constants whose values the bench replaces.
#[cfg(feature = "sweep")]
static SWEPT: std::sync::OnceLock<Vec<(String, String)>> = std::sync::OnceLock::new();

/// Replaces the values of constants: `name=value`, with commas between several. Only the first call
/// has an effect, and it has to come before the constants are read.
#[cfg(feature = "sweep")]
pub fn sweep(text: &str) {
    let pairs = text.split(',').filter_map(|pair| pair.split_once('='));
    SWEPT.get_or_init(|| pairs.map(|(name, value)| (name.to_owned(), value.to_owned())).collect());
}

/// The value that was set for the constant of this name.
#[cfg(feature = "sweep")]
fn swept<T: std::str::FromStr>(name: &str) -> Option<T> {
    SWEPT.get()?.iter().find(|(swept, _)| swept == name)?.1.parse().ok()
}
