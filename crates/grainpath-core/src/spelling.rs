//! Finds the name that a misspelled word was meant to be and the meaning of a word in a table, and counts things in words.

/// The name that comes nearest to `word`, however far it is; empty if there are no names.
///
/// Names that contain every part of the word are preferred: `layer_mm` means `layer_height_mm`, although a shorter name
/// has a smaller edit distance. Among these names, or among all names if there is none of the kind, the one with the
/// smallest edit distance is chosen, in which two letters that changed places count once; of equal ones, the first in the alphabet.
fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> &'a str {
    let lacks_a_part = |name: &str| !has_parts(name, word);
    names.into_iter().min_by_key(|n| (lacks_a_part(n), strsim::osa_distance(word, n), *n)).unwrap_or_default()
}

/// Whether a name contains every part of a word; parts stand between underscores.
fn has_parts(name: &str, word: &str) -> bool {
    word.split('_').all(|part| name.split('_').any(|p| p == part))
}

/// The name that `word` was probably meant to be. A name is near if a third of its letters differ at most, if one
/// of the two contains the other, or if it contains every part of the word.
///
/// ```
/// use grainpath_core::spelling::near;
///
/// assert_eq!(near("wals", ["seam", "walls"]), Some("walls"));
/// assert_eq!(near("colour", ["seam", "walls"]), None);
/// ```
pub fn near<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let near = nearest(word, names);
    if word.is_empty() || near.is_empty() {
        return None;
    }
    let is_part = near.contains(word) || word.contains(near) || has_parts(near, word);
    let most = word.chars().count().max(near.chars().count());
    (is_part || 3 * strsim::osa_distance(word, near) <= most).then_some(near)
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
    near(word, names).map_or_else(|| ".".to_owned(), |near| format!("; did you mean {near:?}?"))
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
        assert_eq!(
            super::near("layer_heigth", ["bead_width", "layer_height", "walls"]),
            Some("layer_height")
        );
        assert_eq!(super::near("layer_mm", ["arcs", "seam", "layer_height_mm"]), Some("layer_height_mm"));
        assert_eq!(super::near("mehs", ["ct", "mesh"]), Some("mesh"), "two letters that changed places");
        assert_eq!(super::near("x", ["arcs", "seam"]), None);
        assert_eq!(super::near("x", []), None);
        assert_eq!(super::near("", ["arcs"]), None);
    }
}
