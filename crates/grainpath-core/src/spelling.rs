//! The name that was meant by a misspelled one.

/// The name with the smallest edit distance (Levenshtein) to `word`; of equal ones the first in the
/// alphabet. Empty without names.
///
/// ```
/// use grainpath_core::spelling::nearest;
///
/// assert_eq!(nearest("wals", ["seam", "walls"]), "walls");
/// ```
pub fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> &'a str {
    names.into_iter().min_by_key(|n| (strsim::levenshtein(word, n), *n)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_slip_of_the_finger() {
        assert_eq!(super::nearest("layer_heigth", ["bead_width", "layer_height", "walls"]), "layer_height");
        assert_eq!(super::nearest("x", []), "");
    }
}
