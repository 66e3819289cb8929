//! Reproducible pseudo-random numbers: they are the same on every platform and in every run.
//!
//! The mixing function is the output step of SplitMix64 (Steele, Lea and Flood 2014, `steele2014`
//! in docs/references.bib): one addition, two multiplications and three shifts, and every output
//! bit depends on every input bit. It is not a cryptographic hash.

/// The odd number nearest to 2⁶⁴ divided by the golden ratio. Source: steele2014.
pub(crate) const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// Mixes the bits of a number; different inputs give different outputs.
///
/// ```
/// // The first number of SplitMix64 with seed 0, as published.
/// assert_eq!(grainpath_core::hash::splitmix64(0), 0xe220_a839_7b1d_cdaf);
/// ```
pub const fn splitmix64(seed: u64) -> u64 {
    let mut x = seed.wrapping_add(GOLDEN_GAMMA);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A number from 0 (included) to 1 (excluded) made from the 53 highest bits of [`splitmix64`].
pub fn unit_interval(seed: u64) -> f64 {
    (splitmix64(seed) >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_spread_evenly() {
        let n = 10_000;
        let mut counts = [0u32; 10];
        (0..n).for_each(|i| counts[(10.0 * unit_interval(i)) as usize] += 1);
        // Five standard deviations of a binomial count with p = 0.1.
        assert!(counts.iter().all(|&c| c.abs_diff(1000) < 150), "{counts:?}");
    }
}
