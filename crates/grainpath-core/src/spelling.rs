//! Which name somebody meant.

/// The name that takes the fewest changes from `word`; of equal ones the first in the alphabet. Empty without names.
pub fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> &'a str {
    names.into_iter().min_by_key(|n| (distance(word, n), *n)).unwrap_or_default()
}

/// Levenshtein distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.iter().enumerate() {
            let substitute = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = substitute.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_slip_of_the_finger() {
        assert_eq!(super::nearest("layer_heigth", ["bead_width", "layer_height", "walls"]), "layer_height");
        assert_eq!(super::nearest("x", []), "");
    }
}
