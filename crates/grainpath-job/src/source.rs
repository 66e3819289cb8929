//! Parses a TOML file and finds the line of each of its values.

use std::ops::Range;

use toml::Table;
use toml::de::{DeTable, DeValue};

use crate::error::{JobError, Location};
use crate::value::Step;

/// A parsed TOML file.
pub(crate) struct Source<'a> {
    name: &'a str,
    text: &'a str,
    spans: DeTable<'a>,
    /// The values of the file.
    pub table: Table,
}

impl<'a> Source<'a> {
    /// Parses `text`. Errors call the file `name`.
    pub(crate) fn parse(text: &'a str, name: &'a str) -> Result<Self, JobError> {
        let syntax = |e: &toml::de::Error| {
            let line = e.span().map_or(1, |s| line_at(text, s.start));
            let location = Location { file: name.to_owned(), line: Some(line) };
            JobError::Syntax { location, message: e.message().replace('\n', "; ") }
        };
        // The file is parsed twice: values for reading, spans for lines. Both are small, and only the
        // second parser keeps positions.
        let table = text.parse::<Table>().map_err(|e| syntax(&e))?;
        let spans = DeTable::parse(text).map_err(|e| syntax(&e))?.into_inner();
        Ok(Self { name, text, spans, table })
    }

    /// The line of the value at the end of the path `keys` followed by `steps`. If the file lacks the end of
    /// this path, it is the line of the last part that the file has.
    pub(crate) fn location(&self, keys: &[&str], steps: &[Step]) -> Location {
        let keys = keys.iter().map(|k| Step::Key((*k).to_owned()));
        let mut steps = keys.chain(steps.iter().cloned());
        let mut found: Option<Range<usize>> = None;
        let mut value: Option<&DeValue<'_>> = None;
        let mut table = Some(&self.spans);
        for step in &mut steps {
            let next = match (&step, table, value) {
                (Step::Key(key), Some(t), _) => {
                    t.iter().find(|(k, _)| k.get_ref() == key).map(|(k, v)| (k.span(), v.get_ref()))
                }
                (Step::Index(i), None, Some(DeValue::Array(a))) => a.get(*i).map(|v| (v.span(), v.get_ref())),
                (Step::Key(_) | Step::Index(_), _, _) => None,
            };
            // A missing key has no line; its error then gives the line of the table that should hold it.
            let Some((span, inner)) = next else { break };
            found = Some(span);
            table = inner.as_table();
            value = Some(inner);
        }
        Location { file: self.name.to_owned(), line: Some(found.map_or(1, |s| line_at(self.text, s.start))) }
    }
}

/// The line of a byte, counted from 1.
fn line_at(text: &str, byte: usize) -> usize {
    text.bytes().take(byte).filter(|b| *b == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_every_way_to_write_a_key() {
        let text = "\
process.walls = 2
[fill]
angles_deg = [
  0,
  90,
]
[printer]
start_gcode = \"\"\"
[process]
walls = 9
\"\"\"
\"nozzle_mm\" = 0.4
[[guide.load]]
force_n = [1, 2, 3]
[[guide.load]]
on = { box_mm = [[0, 0, 0], [1, 1, 1]] }
force_n = [1, 2, 3]
[shape]
ct = { path = \"scan\" }
[guide.image]
files = []
";
        let source = Source::parse(text, "job.toml").expect("sound TOML");
        let line = |keys: &[&str], steps: &[Step]| source.location(keys, steps).line;
        let key = |k: &str| Step::Key(k.to_owned());
        assert_eq!(line(&["process", "walls"], &[]), Some(1));
        assert_eq!(line(&["fill"], &[]), Some(2));
        assert_eq!(line(&["fill", "angles_deg"], &[Step::Index(1)]), Some(5));
        assert_eq!(line(&["printer", "nozzle_mm"], &[]), Some(12));
        assert_eq!(line(&["guide", "load"], &[Step::Index(1), key("force_n")]), Some(17));
        assert_eq!(line(&["guide", "load"], &[Step::Index(1), key("on"), key("box_mm")]), Some(16));
        assert_eq!(line(&["shape", "ct", "path"], &[]), Some(19));
        assert_eq!(line(&["guide", "image", "files"], &[]), Some(21));
        // A key that is missing has the line of what should hold it.
        assert_eq!(line(&["guide", "image", "corners_px"], &[]), Some(20));
    }
}
