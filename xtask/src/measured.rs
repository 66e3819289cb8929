//! Measured numbers: one file holds them, benches write it, and pages quote it by key.
//!
//! `cargo xtask bench NAME --record` writes each number of the tables that a bench prints into `docs/measured.toml`, with
//! the date, the commit and the machine. A page quotes a number as `0.46<!--slicing.benchy.grainpath.wall-s-->`: the
//! comment is invisible and names the key. [`Measured::check_pages`] fails where a quoted number is not the one of the file, or the
//! key is not there; [`Measured::renew_pages`] writes the numbers into the pages. So a new measurement reaches every page that tells
//! of it, and no page can keep an old one.
//!
//! A page may round: `12<!--KEY-->` holds where the recorded number is `12.4`, with as many digits as the page gives, and
//! `2e-6<!--KEY-->` where it is `2.1e-6`. Numbers that tests find come from lines `measured: KEY = NUMBER` of what they
//! print ([`keep_lines`]).
//!
//! Rows of tables that hold figures without a key are counted by `cargo xtask count`, and may only become fewer
//! ([`rows_without_keys`]). A figure that no bench measures names its origin instead, in its cell, in the first cell of its
//! row or in the head of its column: `<!--from: ORIGIN-->`, with a key of `docs/references.bib` as `@KEY`, a file of the
//! repository that holds the number, or a date and a commit, and the command.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use crate::book::{self, read};

/// The numbers.
const FILE: &str = "docs/measured.toml";
/// What stands above them.
const HEAD: &str = "# Measured numbers, written by `cargo xtask bench NAME --record`. Pages quote them by key, see \
                    xtask/src/measured.rs.\n";
const OPENS: &str = "<!--";
const CLOSES: &str = "-->";
/// What stands before the key of a number that a test prints.
const MARK: &str = "measured: ";

/// Pages whose tables are written by programs, from what they print or from the sources.
const GENERATED: [&str; 6] =
    ["commands.md", "constants.md", "fuzzing.md", "nightly.md", "settings.md", "warnings.md"];

/// Numbers of this run by group and name, until [`save`] writes them.
static FOUND: Mutex<Groups> = Mutex::new(BTreeMap::new());

/// Goals that the benches of this run have missed, until [`check_goals`] tells them.
static MISSED: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Numbers by name, in groups: a row of a table is a group.
type Groups = BTreeMap<String, BTreeMap<String, String>>;

/// A table that a bench prints row by row.
pub struct Table {
    bench: &'static str,
    columns: Vec<String>,
    /// How many of the first columns name the row.
    n_names: usize,
}

impl Table {
    /// Prints the head of a table.
    pub fn new(bench: &'static str, header: &[&str], n_names: usize) -> Self {
        println!("\n| {} |\n|{}", header.join(" | "), "---|".repeat(header.len()));
        Self { bench, columns: header.iter().map(|h| key(h)).collect(), n_names }
    }

    /// Prints a row and keeps its numbers.
    pub fn row(&self, cells: &[String]) {
        println!("| {} |", cells.join(" | "));
        let names = cells.iter().take(self.n_names).map(|c| key(c));
        let group = std::iter::once(self.bench.to_owned()).chain(names).collect::<Vec<_>>().join(".");
        let mut found = FOUND.lock().unwrap_or_else(PoisonError::into_inner);
        let values = found.entry(group).or_default();
        for (column, cell) in self.columns.iter().zip(cells).skip(self.n_names) {
            values.insert(column.clone(), cell.clone());
        }
    }
}

/// Prints and keeps the numbers of lines `measured: KEY = NUMBER`; how many there are.
pub fn keep_lines(text: &str) -> Result<usize, String> {
    // The harness of the tests may have begun the line with the name of a test.
    let lines = text.lines().filter_map(|line| line.split_once(MARK));
    let mut n_kept = 0;
    for (_, line) in lines {
        let parts = line.split_once(" = ").and_then(|(key, number)| {
            let (group, name) = key.rsplit_once('.')?;
            Some((group, name, number.trim()))
        });
        let (group, name, number) = parts.ok_or_else(|| format!("{line:?} is not KEY = NUMBER"))?;
        println!("{group}.{name} = {number}");
        let mut found = FOUND.lock().unwrap_or_else(PoisonError::into_inner);
        found.entry(group.to_owned()).or_default().insert(name.to_owned(), number.to_owned());
        n_kept += 1;
    }
    Ok(n_kept)
}

/// Notes whether a measured number meets its goal; the cell of a table.
pub fn goal(what: &str, goal: &str, is_met: bool) -> String {
    if is_met {
        return format!("{goal}: met");
    }
    MISSED.lock().unwrap_or_else(PoisonError::into_inner).push(format!("{what} ({goal})"));
    format!("{goal}: MISSED")
}

/// Fails where a goal was missed. Numbers are recorded before, because a miss is a result too.
pub fn check_goals() -> Result<(), String> {
    let missed = std::mem::take(&mut *MISSED.lock().unwrap_or_else(PoisonError::into_inner));
    if missed.is_empty() { Ok(()) } else { Err(format!("goals missed: {}", missed.join("; "))) }
}

/// A text as a part of a key: small letters and digits, with `-` for all between.
fn key(text: &str) -> String {
    let parts = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|p| !p.is_empty());
    parts.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-")
}

/// Writes the numbers of this run into the file, in place of those with the same key.
pub fn save() -> Result<(), String> {
    let found = std::mem::take(&mut *FOUND.lock().unwrap_or_else(PoisonError::into_inner));
    if found.is_empty() {
        return Err("this bench prints no table whose numbers are recorded".to_owned());
    }
    let path = crate::root().join(FILE);
    let mut all = Measured::parse(&read(&path)?)?;
    let git = |words: &[&str]| crate::output(Command::new("git").args(words).current_dir(crate::root()));
    let commit = git(&["rev-parse", "--short", "HEAD"])?.trim().to_owned();
    // Pages may differ from the commit, programs may not.
    let changed = git(&["status", "--porcelain", "--untracked-files=no"])?;
    if let Some(line) = changed.lines().find(|l| !l.ends_with(".md") && !l.ends_with(FILE)) {
        return Err(format!(
            "numbers are recorded with their commit, but files have changed since: {}",
            line.trim()
        ));
    }
    let date = crate::output(Command::new("date").arg("+%Y-%m-%d"))?.trim().to_owned();
    for (group, mut values) in found {
        println!("recorded {} numbers of {group}", values.len());
        values.insert("measured".into(), format!("{date}, {commit}, {}", machine()));
        all.0.insert(group, values);
    }
    fs::write(&path, all.text()).map_err(|e| format!("{FILE}: {e}"))
}

/// Processors and memory of this machine, as a reader needs them beside a time.
fn machine() -> String {
    let cores = crate::cores();
    let memory = fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let kib = memory.split_whitespace().nth(1).and_then(|w| w.parse::<f64>().ok());
    let memory = kib.map_or_else(String::new, |kib| format!(", {:.0} GiB", kib / 1024.0 / 1024.0));
    format!("{cores} cores{memory}")
}

/// The numbers of the file.
#[derive(Debug, PartialEq)]
pub struct Measured(Groups);

impl Measured {
    /// Reads the file.
    pub fn read() -> Result<Self, String> {
        Self::parse(&read(&crate::root().join(FILE))?)
    }

    /// Reads the text of the file.
    pub fn parse(text: &str) -> Result<Self, String> {
        let table: toml::Table = text.parse().map_err(|e| format!("{FILE}: {e}"))?;
        let group = |(name, values): (String, toml::Value)| {
            let values = values.as_table().cloned().ok_or_else(|| format!("{FILE}: {name} is no table"))?;
            let text = |(key, value): (String, toml::Value)| match value {
                toml::Value::String(text) => Ok((key, text)),
                other => Err(format!("{FILE}: {name}.{key} is {other}, not a text")),
            };
            let values = values.into_iter().map(text).collect::<Result<_, String>>()?;
            Ok((name, values))
        };
        Ok(Self(table.into_iter().map(group).collect::<Result<_, String>>()?))
    }

    fn text(&self) -> String {
        let mut out = HEAD.to_owned();
        for (group, values) in &self.0 {
            out += &format!("\n[\"{group}\"]\n");
            values.iter().for_each(|(key, value)| out += &format!("{key} = {value:?}\n"));
        }
        out
    }

    /// The number of a key.
    pub fn value(&self, key: &str) -> Result<&str, String> {
        let found = key.rsplit_once('.').and_then(|(group, name)| self.0.get(group)?.get(name));
        found.map(String::as_str).ok_or_else(|| format!("{FILE} has no {key}"))
    }

    /// Compares the numbers that pages quote with these; the number of quotes.
    pub fn check_pages(&self) -> Result<usize, String> {
        let mut n_quotes = 0;
        for page in pages()? {
            let text = read(&page)?;
            let quotes = quotes(&text);
            n_quotes += quotes.len();
            if let Some(wrong) = quotes.iter().find_map(|quote| quote.problem(self).err()) {
                return Err(format!("{}: {wrong}; `cargo xtask figures --write` renews it", page.display()));
            }
        }
        Ok(n_quotes)
    }

    /// Writes the numbers into the pages that quote them, with as many digits as stand there.
    pub fn renew_pages(&self) -> Result<(), String> {
        for page in pages()? {
            let old = read(&page)?;
            let mut new = old.clone();
            for quote in quotes(&old).iter().rev() {
                let number = quote.renewed(self).map_err(|e| format!("{}: {e}", page.display()))?;
                new.replace_range(quote.start..quote.start + quote.number.len(), &number);
            }
            if new != old {
                fs::write(&page, new).map_err(|e| format!("{}: {e}", page.display()))?;
            }
        }
        Ok(())
    }
}

/// A number of a page and the key behind it.
#[derive(Debug, PartialEq)]
struct Quote<'a> {
    start: usize,
    number: &'a str,
    key: &'a str,
}

impl Quote<'_> {
    /// The recorded number with as many digits after the point as the page gives, written as it is recorded: with a power
    /// of ten, with a sign.
    fn renewed(&self, all: &Measured) -> Result<String, String> {
        let recorded = all.value(self.key)?;
        let digits = |number: &str| {
            let whole = number.split_once('e').map_or(number, |(whole, _)| whole);
            whole.split_once('.').map_or(0, |(_, after)| after.len())
        };
        let n_digits = digits(self.number);
        if n_digits >= digits(recorded) {
            return Ok(recorded.to_owned());
        }
        let number: f64 = recorded.parse().map_err(|_| format!("{}: {recorded:?} is no number", self.key))?;
        let rounded = match recorded {
            _ if recorded.contains('e') => format!("{number:.n_digits$e}"),
            _ if recorded.starts_with('+') => format!("{number:+.n_digits$}"),
            _ => format!("{number:.n_digits$}"),
        };
        // What is rounded to nothing has no sign.
        let is_zero = !rounded.contains(|c: char| ('1'..='9').contains(&c));
        Ok(if is_zero { rounded.trim_start_matches(['-', '+']).to_owned() } else { rounded })
    }

    fn problem(&self, all: &Measured) -> Result<(), String> {
        let right = self.renewed(all)?;
        if self.number == right {
            return Ok(());
        }
        Err(format!("{} is {right} and not {:?}", self.key, self.number))
    }
}

/// The quotes of a page: a number with a key right behind it.
fn quotes(page: &str) -> Vec<Quote<'_>> {
    let mut found = Vec::new();
    for (at, _) in page.match_indices(OPENS) {
        let Some(end) = page[at..].find(CLOSES) else { continue };
        let key = &page[at + OPENS.len()..at + end];
        let is_key =
            key.contains('.') && key.bytes().all(|b| b.is_ascii_alphanumeric() || b".-_".contains(&b));
        let number = |c: char| c.is_ascii_digit() || c == '.' || c == '-' || c == '+';
        let mut start = page[..at].trim_end_matches(number).len();
        // A power of ten, as in 2.1e-6.
        if let Some(before) = page[..start].strip_suffix('e') {
            let mantissa = before.trim_end_matches(number).len();
            if before[mantissa..].ends_with(|c: char| c.is_ascii_digit()) {
                start = mantissa;
            }
        }
        if is_key && start < at {
            found.push(Quote { start, number: &page[start..at], key });
        }
    }
    found
}

/// Rows with figures that have neither a key nor an origin, in tables of pages that hold measured figures: page and line of
/// each.
pub fn rows_without_keys(root: &Path) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    let references = read(&root.join("docs/references.bib"))?;
    let is_origin = |words: &str| is_origin(words, &references, root);
    for page in book::pages(&root.join("docs"))? {
        if GENERATED.iter().any(|name| page.ends_with(name)) {
            continue;
        }
        let text = read(&page)?;
        let name = page.strip_prefix(root).unwrap_or(&page).display().to_string();
        for table in tables(&text) {
            found.extend(bare_rows(&table, &is_origin).into_iter().map(|line| format!("{name}:{line}")));
        }
    }
    Ok(found)
}

/// A table of a page.
struct PageTable<'a> {
    /// The line of the head, from 1.
    line: usize,
    head: &'a str,
    rows: Vec<&'a str>,
}

/// The tables of a page.
fn tables(page: &str) -> Vec<PageTable<'_>> {
    let lines: Vec<&str> = page.lines().collect();
    let heads = (1..lines.len()).filter(|&i| lines[i].starts_with("|---"));
    let table = |i: usize| PageTable {
        line: i,
        head: lines[i - 1],
        rows: lines[i + 1..].iter().copied().take_while(|l| l.starts_with('|')).collect(),
    };
    heads.map(table).collect()
}

/// Lines of the rows of a table that hold a figure without a key or an origin.
///
/// A table holds measured figures if a row quotes one, or if at least half of its rows hold two numbers with a decimal point
/// or more. In such a table every number with a decimal point outside the first column is a figure, and every number at all
/// in a column that quotes a key or holds numbers alone.
fn bare_rows(table: &PageTable<'_>, is_origin: &dyn Fn(&str) -> bool) -> Vec<usize> {
    let rows = &table.rows;
    let with_figures =
        rows.iter().filter(|row| numbers(row).filter(|n| n.contains('.')).count() >= 2).count();
    let quotes_any = rows.iter().any(|row| !quotes(row).is_empty());
    if !quotes_any && (with_figures == 0 || 2 * with_figures < rows.len()) {
        return Vec::new();
    }
    let head = cells(table.head);
    let rows: Vec<Vec<&str>> = rows.iter().map(|row| cells(row)).collect();
    let of_column = |row: &[&str], c: usize| row.get(c).copied().unwrap_or_default().to_owned();
    let says_origin = |cell: &str| origin(cell).is_some_and(is_origin);
    let is_measured = |c: usize| {
        let quotes_any = rows.iter().any(|row| !quotes(&of_column(row, c)).is_empty());
        let column: Vec<String> = rows.iter().map(|row| without_quotes(&of_column(row, c))).collect();
        let words = |cell: &String| cell.contains(|c: char| c.is_alphabetic());
        quotes_any || !column.iter().any(words)
    };
    let measured: Vec<bool> = (0..head.len()).map(is_measured).collect();
    let is_bare = |row: &[&str], c: usize| {
        let cell = of_column(row, c);
        let has_origin =
            [of_column(&head, c), cell.clone(), of_column(row, 0)].iter().any(|c| says_origin(c));
        let rest = without_quotes(&cell);
        !has_origin && numbers(&rest).any(|n| n.contains('.') || measured[c])
    };
    let bare = rows.iter().enumerate().filter(|(_, row)| (1..head.len()).any(|c| is_bare(row, c)));
    bare.map(|(k, _)| table.line + 2 + k).collect()
}

/// The cells of a row.
fn cells(row: &str) -> Vec<&str> {
    row.trim().trim_start_matches('|').trim_end_matches('|').split('|').map(str::trim).collect()
}

/// A cell without the numbers that have keys, without comments and without code.
fn without_quotes(cell: &str) -> String {
    let mut rest = cell.to_owned();
    for quote in quotes(cell).iter().rev() {
        rest.replace_range(quote.start..quote.start + quote.number.len(), "");
    }
    while let Some((at, n)) = rest.find(OPENS).and_then(|at| Some((at, rest[at..].find(CLOSES)?))) {
        rest.replace_range(at..at + n + CLOSES.len(), "");
    }
    rest.split('`').step_by(2).collect::<Vec<_>>().join(" ")
}

/// Numbers of a text, without those that end a word as in `tet10`.
fn numbers(text: &str) -> impl Iterator<Item = &str> {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '.');
    let words = words.map(|w| w.trim_matches('.'));
    words.filter(|w| w.starts_with(|c: char| c.is_ascii_digit()))
}

/// What a cell says about the origin of its figures.
fn origin(cell: &str) -> Option<&str> {
    let (_, rest) = cell.split_once("<!--from: ")?;
    rest.split_once(CLOSES).map(|(words, _)| words)
}

/// Whether words name an origin that can be found: a reference, a file, or a date with a commit.
fn is_origin(words: &str, references: &str, root: &Path) -> bool {
    let mut parts = words.split([' ', ',', ';']).filter(|w| !w.is_empty());
    let is_date = |w: &str| w.len() == 10 && w.starts_with("20") && w.split('-').count() == 3;
    let is_commit = |w: &str| w.len() >= 7 && w.bytes().all(|b| b.is_ascii_hexdigit());
    let dated = words.split([' ', ',', ';']).any(is_date) && words.split([' ', ',', ';']).any(is_commit);
    dated
        || parts.any(|w| match w.strip_prefix('@') {
            Some(key) => references.contains(&format!("{{{key},")),
            None => w.contains('/') && root.join(w).is_file(),
        })
}

/// All pages that may quote.
fn pages() -> Result<Vec<PathBuf>, String> {
    let mut all = book::pages(&crate::root().join("docs"))?;
    all.push(crate::root().join("README.md"));
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recorded() -> Measured {
        Measured::parse(
            "[\"slicing.benchy.grainpath\"]\nwall-s = \"0.46\"\nmeasured = \"2026-01-01, abc, 2 cores\"\n",
        )
        .expect("a file")
    }

    #[test]
    fn a_missed_goal_fails_the_run_that_missed_it() {
        assert_eq!(goal("the first", "at most 1", true), "at most 1: met");
        assert_eq!(check_goals(), Ok(()));
        assert_eq!(goal("the second", "at most 1", false), "at most 1: MISSED");
        assert_eq!(check_goals(), Err("goals missed: the second (at most 1)".to_owned()));
        assert_eq!(check_goals(), Ok(()), "the next bench does not answer for it");
    }

    #[test]
    fn a_number_that_is_not_the_recorded_one_is_found_and_renewed() {
        let page =
            "| 0.51<!--slicing.benchy.grainpath.wall-s--> s | 0.5<!--slicing.benchy.grainpath.wall-s--> s |";
        let found = quotes(page);
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].number, "0.51");
        assert!(found[0].problem(&recorded()).is_err_and(|e| e.contains("0.46")));
        // A page may give fewer digits.
        assert_eq!(found[1].problem(&recorded()), Ok(()));
        assert_eq!(found[0].renewed(&recorded()), Ok("0.46".to_owned()));
    }

    #[test]
    fn powers_of_ten_and_signs_stay_as_they_are_recorded() {
        let of = |recorded: &str| Measured::parse(&format!("[\"a.b\"]\nx = {recorded:?}\n")).expect("a file");
        for (page, recorded, right) in [
            ("about 7e-12<!--a.b.x-->", "1.6e-6", "2e-6"),
            ("2.1e-6<!--a.b.x-->", "1.6e-6", "1.6e-6"),
            ("size 3<!--a.b.x-->", "12.4", "12"),
            ("+0.1<!--a.b.x--> %", "+0.370", "+0.4"),
            ("-0.01<!--a.b.x--> %", "-0.004", "0.00"),
        ] {
            let found = quotes(page);
            assert_eq!(found[0].renewed(&of(recorded)), Ok(right.to_owned()), "{page}");
        }
        assert_eq!(quotes("about 7e-12<!--a.b.x-->")[0].number, "7e-12");
    }

    #[test]
    fn numbers_that_tests_print_are_kept_by_key() {
        let text =
            "test one ... measured: tests.one.mm = 2.515\nok\nother text\nmeasured: tests.one.off = 1.2e-6\n";
        assert_eq!(keep_lines(text), Ok(2));
        let kept = FOUND.lock().expect("no panic")["tests.one"].clone();
        assert_eq!((kept["mm"].as_str(), kept["off"].as_str()), ("2.515", "1.2e-6"));
        assert!(keep_lines("measured: no number").is_err_and(|e| e.contains("KEY = NUMBER")));
    }

    #[test]
    fn a_key_without_a_number_behind_it_in_the_file_is_refused() {
        let found = quotes("1<!--slicing.bunny.grainpath.wall-s-->");
        assert!(found[0].problem(&recorded()).is_err_and(|e| e.contains("has no")));
    }

    #[test]
    fn other_comments_are_no_keys() {
        assert!(quotes("text <!-- figures: written by a program --> 1.0 <!---->").is_empty());
    }

    #[test]
    fn the_file_is_read_as_it_is_written() {
        assert_eq!(Measured::parse(&recorded().text()), Ok(recorded()));
    }

    #[test]
    fn rows_of_figures_without_keys_are_found() {
        let bare = |page: &str| {
            let known = |words: &str| words == "known";
            tables(page).iter().flat_map(|t| bare_rows(t, &known)).collect::<Vec<_>>()
        };
        assert_eq!(bare("text\n\n| part | s |\n|---|---|\n| a | 1.5, 2.5 |\n| b | 3.5, 0.1 |\n"), [5, 6]);
        assert!(bare("| key | meaning |\n|---|---|\n| a | about 1.5 |\n").is_empty());
        // One key does not cover the row, nor the table.
        let quoted = "| part | s | n |\n|---|---|---|\n| a 2.5 | 1.5<!--x.y.s--> | 9 beads |\n";
        assert!(bare(quoted).is_empty());
        assert_eq!(bare(&format!("{quoted}| b | 3 | 9 |\n")), [4]);
        assert_eq!(bare(&quoted.replace("9 beads", "9.5 beads")), [3]);
        assert_eq!(bare(&quoted.replace("9 beads", "9")), [3]);
        assert_eq!(bare(&quoted.replace("s-->", "s-->, 2.5")), [3]);
        // An origin holds for its cell, its row or its column; code is no figure.
        for more in [
            "| b | 3.5<!--from: known--> | 9 |",
            "| b<!--from: known--> | 3.5 | 9.5 |",
            "| b | `0.5` | tet10 |",
        ] {
            assert!(bare(&format!("{quoted}{more}\n")).is_empty(), "{more}");
        }
        assert_eq!(bare(&format!("{quoted}| b | 3.5<!--from: hearsay--> | 9 |\n")), [4]);
        let column = quoted.replace("| n |", "| n<!--from: known--> |").replace("9 beads", "9.5");
        assert!(bare(&column).is_empty());
    }

    #[test]
    fn an_origin_is_a_reference_a_file_or_a_date_with_a_commit() {
        let root = crate::root();
        let known = |words: &str| is_origin(words, "@book{higham2002,\n", &root);
        assert!(known("@higham2002, table 3") && known("the page of README, xtask/src/measured.rs"));
        assert!(known("2026-11-21, 176c775, cargo xtask bench continuous"));
        for vague in ["measured before", "@nobody1900", "xtask/src/nothing.rs", "2026-11-21", "176c775"] {
            assert!(!known(vague), "{vague}");
        }
    }
}
