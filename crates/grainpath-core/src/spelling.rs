//! Finds the name that a misspelled word was meant to be, and the meaning of a word in a table.

/// The name that `word` was probably meant to be; empty if there are no names.
///
/// Names that contain every part of the word are preferred: `layer_mm` means `layer_height_mm`, although a shorter name
/// has a smaller edit distance. Among these names, or among all names if there is none of the kind, the one with the
/// smallest edit distance (Levenshtein) is chosen; of equal ones, the first in the alphabet.
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

/// The value that a table assigns to a word; `None` for words outside the table. Words from files and arguments
/// are turned into enums with it, as soon as they are read.
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
