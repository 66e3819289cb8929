//! Changing single values of a job's text, so that comments and the order of lines stay.

/// The text with another value, as TOML writes it, of a key of a table: in the line that states one, or in a new line below
/// the table's header. `None` where the text has no such header.
///
/// ```
/// use grainpath_job::edit::with_value;
///
/// let text = "[shape]\nmesh = \"a.stl\"\n";
/// let turned = with_value(text, "shape", "rotate_deg", "[90, 0, 0]").unwrap();
/// assert_eq!(turned, "[shape]\nrotate_deg = [90, 0, 0]\nmesh = \"a.stl\"\n");
/// ```
pub fn with_value(text: &str, table: &str, key: &str, value: &str) -> Option<String> {
    let new = format!("{key} = {value}");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let header = format!("[{table}]");
    let head = lines.iter().position(|l| l.split('#').next().unwrap_or_default().trim() == header)?;
    let end = lines.iter().skip(head + 1).position(|l| l.trim_start().starts_with('['));
    let end = end.map_or(lines.len(), |k| head + 1 + k);
    let states_it = |l: &String| l.split('=').next().is_some_and(|name| name.trim() == key);
    match lines[head..end].iter().position(states_it) {
        Some(k) => {
            let line = &mut lines[head + k];
            let comment = line.find('#').map_or(String::new(), |at| format!(" {}", &line[at..]));
            *line = new + &comment;
        }
        None => lines.insert(head + 1, new),
    }
    Some(lines.join("\n") + "\n")
}

#[cfg(test)]
mod tests {
    use super::with_value;

    #[test]
    fn a_value_is_written_where_the_job_has_it() {
        let turned = |text| with_value(text, "shape", "rotate_deg", "[90, 0, 0]");
        assert_eq!(
            turned("# job\n[shape] # a part\nmesh = \"a.stl\"\n\n[fill]\n").expect("a table"),
            "# job\n[shape] # a part\nrotate_deg = [90, 0, 0]\nmesh = \"a.stl\"\n\n[fill]\n"
        );
        assert_eq!(
            turned("[shape]\nrotate_deg = [0, 0, 4] # as bought\n[image]\nrotate_deg = 3\n")
                .expect("a table"),
            "[shape]\nrotate_deg = [90, 0, 0] # as bought\n[image]\nrotate_deg = 3\n"
        );
        assert_eq!(turned("shape.mesh = \"a.stl\"\n"), None);
    }
}
