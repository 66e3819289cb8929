//! The name that was meant by a misspelled one.

/// The name that `word` was meant to be; empty without names.
///
/// Names that hold every part of the word come first (`layer_mm` for `layer_height_mm`: a part left out is a longer edit
/// than another short name). Among them, or among all where none does, the smallest edit distance (Levenshtein) wins,
/// and of equal ones the first in the alphabet.
///
/// ```
/// use grainpath_core::spelling::nearest;
///
/// assert_eq!(nearest("wals", ["seam", "walls"]), "walls");
/// ```
pub fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> &'a str {
    let lacks_a_part = |name: &str| word.split('_').any(|part| !name.split('_').any(|p| p == part));
    names.into_iter().min_by_key(|n| (lacks_a_part(n), strsim::levenshtein(word, n), *n)).unwrap_or_default()
}

/// What a word of a table stands for; `None` for words outside the table. Words from files and arguments become
/// enums here, at the border.
///
/// ```
/// use grainpath_core::spelling::meaning;
///
/// assert_eq!(meaning(&[("svg", 1), ("png", 2)], "png"), Some(2));
/// assert_eq!(meaning(&[("svg", 1), ("png", 2)], "PNG"), None);
/// ```
pub fn meaning<T: Copy>(table: &[(&str, T)], word: &str) -> Option<T> {
    table.iter().find(|(name, _)| *name == word).map(|(_, of)| *of)
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_slip_of_the_finger() {
        assert_eq!(super::nearest("layer_heigth", ["bead_width", "layer_height", "walls"]), "layer_height");
        assert_eq!(super::nearest("layer_mm", ["arcs", "seam", "layer_height_mm"]), "layer_height_mm");
        assert_eq!(super::nearest("x", []), "");
    }
}
