//! Changes single values in the text of a job and keeps the comments and the order of lines.

use std::ops::Range;

/// The line numbers of a table without its header, counted from 0; `None` if the text has no such header.
fn lines_of_table<L: AsRef<str>>(lines: &[L], table: &str) -> Option<Range<usize>> {
    let header = format!("[{table}]");
    let is_header = |l: &L| l.as_ref().split('#').next().unwrap_or_default().trim() == header;
    let first = lines.iter().position(is_header)? + 1;
    let n = lines[first..].iter().take_while(|l| !l.as_ref().trim_start().starts_with('[')).count();
    Some(first..first + n)
}

/// Whether a line states the value of a key.
fn states(line: &str, key: &str) -> bool {
    line.split('=').next().is_some_and(|name| name.trim() == key)
}

/// The value of a key of a table, as written in the text; `None` if the text does not state the key.
///
/// ```
/// use grainpath_job::edit::value_of;
///
/// assert_eq!(value_of("[printer]\nprofile = \"voron-2.4\" # at home\n", "printer", "profile"), Some("\"voron-2.4\""));
/// ```
pub fn value_of<'t>(text: &'t str, table: &str, key: &str) -> Option<&'t str> {
    let lines: Vec<&'t str> = text.lines().collect();
    let own = &lines[lines_of_table(&lines, table)?];
    let (_, value) = own.iter().find(|line| states(line, key))?.split_once('=')?;
    Some(value.split('#').next().unwrap_or_default().trim())
}

/// The text without the line that states a key of a table; unchanged if there is no such line.
///
/// ```
/// use grainpath_job::edit::without_value;
///
/// let job = "[material]\nprofile = \"abs\"\nbed_temp_c = 60\n";
/// assert_eq!(without_value(job, "material", "bed_temp_c"), "[material]\nprofile = \"abs\"\n");
/// ```
pub fn without_value(text: &str, table: &str, key: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    let stated =
        lines_of_table(&lines, table).and_then(|all| all.into_iter().find(|k| states(lines[*k], key)));
    if let Some(k) = stated {
        lines.remove(k);
    }
    lines.join("\n") + "\n"
}

/// The text with a new value, in TOML, for a key of a table. It replaces the line that states the key, or adds a line below
/// the table's header. `None` if the text has no such header.
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
    let own = lines_of_table(&lines, table)?;
    let first = own.start;
    match own.into_iter().find(|k| states(&lines[*k], key)) {
        Some(k) => {
            let line = &mut lines[k];
            let comment = line.find('#').map_or(String::new(), |at| format!(" {}", &line[at..]));
            *line = new + &comment;
        }
        None => lines.insert(first, new),
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
