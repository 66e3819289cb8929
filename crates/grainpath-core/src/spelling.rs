//! Finds the name that a misspelled word was meant to be and the meaning of a word in a table, and counts things in words.

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

/// The end of a message that a word is none of the names: `; did you mean "walls"?`, or `.` if no name is near.
///
/// ```
/// use grainpath_core::spelling::question;
///
/// assert_eq!(question("petgg", ["abs", "petg"]), "; did you mean \"petg\"?");
/// assert_eq!(question("foo", ["abs", "petg"]), ".");
/// ```
pub fn question<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let near = nearest(word, names);
    let is_part = !word.is_empty() && (near.contains(word) || (!near.is_empty() && word.contains(near)));
    if is_part || 3 * strsim::levenshtein(word, near) <= word.chars().count().max(near.chars().count()) {
        format!("; did you mean {near:?}?")
    } else {
        ".".to_owned()
    }
}

/// A number of things, with an `s` for all numbers but one.
///
/// ```
/// use grainpath_core::spelling::counted;
///
/// assert_eq!([1, 2].map(|n| counted(n, "tree")), ["1 tree", "2 trees"]);
/// ```
pub fn counted(n: usize, thing: &str) -> String {
    format!("{n} {thing}{}", if n == 1 { "" } else { "s" })
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
