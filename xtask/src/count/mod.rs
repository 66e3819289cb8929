//! Counts of how readable and how well divided the code is, with limits that may only improve.
//!
//! The review of commit ee21024 counted by hand-made scripts; by the rules here that commit has
//!
//! | count | review | here | why they differ |
//! |---|---|---|---|
//! | largest crate | 48 % | 47.5 % | the review's list of files is not known |
//! | dependency cycles | 8 | 9 of files, 4 of folders | here `streamlines <-> stripes` of fills and `direct <-> solve` of solids too, which full paths close; `examples <-> test_pieces` is a cycle of a folder |
//! | settings compared with text | 16 | 16 | |
//! | `_` arms | 10 | 14 | 8 of the review's; its other two, in `config.rs`, match no word; 6 are outside that file |
//! | comment lines per code line | 0.012 | 0.0115 | |
//! | doc lines per code line | 0.11 | 0.111 | |
//! | doc examples | 0 | 0 | |
//! | module texts of 10 lines | 0 | 0 | |
//! | named numbers, with a source | 356, 8 | 381 without | here arrays and sums of numbers too, and only "Source:" and "Measured:" tell a source |
//! | empty tests | 26 | 26 | |
//!
//! The rule of each count stands in the text of its module; [`COUNTS`] lists them with a line each.
//! `cargo xtask count` prints them beside the limits of `xtask/counts.toml` and fails where one is missed.
//! `--tighten` writes every count that is better than its limit as the new limit; `--list NAME` prints the places.

mod constants;
mod cycles;
mod documentation;
mod tests_that_pass_empty;
mod words;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::source::{self, Line, Source, Workspace};

/// Whether fewer or more are better.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Better {
    Less,
    More,
}

/// The counts: name, direction of improvement, and what is counted.
const COUNTS: [(&str, Better, &str); 16] = [
    (
        "largest_crate_percent",
        Better::Less,
        "largest crate's share of all lines that are not blank, tests too",
    ),
    ("file_cycles", Better::Less, "dependency cycles between files"),
    ("folder_cycles", Better::Less, "dependency cycles between folders, or folders and files, of one folder"),
    ("cycles_with_parents", Better::Less, "file cycles with arrows between a module and its parts"),
    (
        "planner_arrows_upwards",
        Better::Less,
        "a module of the planner names one that `lib.rs` declares before it",
    ),
    ("settings_compared_with_text", Better::Less, "lines that compare a setting with a text outside `job`"),
    ("words_compared", Better::Less, "other comparisons of a value with a word where settings are used"),
    ("wildcard_arms", Better::Less, "`_` arms that take an unknown word or choice for a default"),
    ("comment_lines_per_1000_code_lines", Better::More, "comment lines, doc comments left out"),
    ("doc_lines_per_1000_code_lines", Better::More, "lines of doc comments"),
    ("doc_examples", Better::More, "examples in doc comments that rustdoc compiles and runs"),
    ("module_texts", Better::More, "files whose `//!` text has 10 lines or more"),
    (
        "constants_without_source_in_four_folders",
        Better::Less,
        "fea/strength, fill/field, fill/continuous, support",
    ),
    ("constants_without_source_elsewhere", Better::Less, "named numbers of all other folders"),
    ("empty_tests", Better::Less, "tests that can return early or assert nothing"),
    (
        "table_rows_without_keys",
        Better::Less,
        "rows of tables of measured figures in pages of docs with a figure that has neither a key nor an origin",
    ),
];

/// The folders whose constants decide what is printed or how strong the print is.
const FOUR_FOLDERS: [&str; 4] =
    ["grainpath-fea/src/strength/", "src/fill/field/", "src/fill/continuous/", "grainpath/src/support/"];

/// One count: its value, and the places that it counts.
#[derive(Default)]
struct Count {
    value: f64,
    places: Vec<String>,
}

impl Count {
    fn of_places(places: Vec<String>) -> Self {
        Self { value: places.len() as f64, places }
    }
}

/// Runs the command.
pub fn run(words: &[&str]) -> Result<(), String> {
    match words {
        [] => check(&crate::root(), false),
        ["--tighten"] => check(&crate::root(), true),
        ["--list", name] => list(&crate::root(), name),
        // Another state of the sources, such as an older commit.
        ["--in", folder] => {
            let counts = count(Path::new(folder))?;
            for (name, _, what) in COUNTS {
                println!("{name:<42} {:>8}   {what}", counts[name].value);
            }
            Ok(())
        }
        ["--in", folder, "--list", name] => list(Path::new(folder), name),
        _ => {
            Err("count: there are --tighten, --list NAME, --in FOLDER and --in FOLDER --list NAME".to_owned())
        }
    }
}

/// Prints the places that make up a count.
fn list(root: &Path, name: &str) -> Result<(), String> {
    let counts = count(root)?;
    let count = counts.get(name).ok_or_else(|| format!("no count {name:?}"))?;
    for place in &count.places {
        println!("{place}");
    }
    println!("{name} = {}", count.value);
    Ok(())
}

/// Compares all counts with their limits.
fn check(root: &Path, tighten: bool) -> Result<(), String> {
    let file = root.join("xtask/counts.toml");
    let text = fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    let mut limits = limits(&text)?;
    let counts = count(root)?;
    let mut missed = Vec::new();
    for (name, better, what) in COUNTS {
        let value = counts[name].value;
        let limit = *limits.get(name).ok_or_else(|| format!("xtask/counts.toml has no {name}"))?;
        // Equal is accepted: a limit is the state that was reached.
        let is_worse = if better == Better::Less { value > limit } else { value < limit };
        if is_worse {
            missed.push(name);
        } else if tighten {
            limits.insert(name.to_owned(), value);
        }
        let mark = if is_worse { "WORSE" } else { "" };
        println!("{name:<42} {value:>8} limit {limit:>8} {mark:<5} {what}");
    }
    if tighten {
        fs::write(&file, table(&limits)).map_err(|e| format!("{}: {e}", file.display()))?;
    }
    if missed.is_empty() {
        return Ok(());
    }
    Err(format!(
        "worse than xtask/counts.toml: {}; `cargo xtask count --list NAME` prints the places",
        missed.join(", ")
    ))
}

fn limits(text: &str) -> Result<BTreeMap<String, f64>, String> {
    let table: toml::Table = text.parse().map_err(|e| format!("xtask/counts.toml: {e}"))?;
    let number = |v: &toml::Value| v.as_float().or_else(|| v.as_integer().map(|n| n as f64));
    Ok(table.iter().filter_map(|(name, value)| Some((name.clone(), number(value)?))).collect())
}

fn table(limits: &BTreeMap<String, f64>) -> String {
    let mut text = String::from(
        "# Limits of `cargo xtask count`. A change may make a count better and never worse.\n\
         # `cargo xtask count --tighten` writes what has become better.\n",
    );
    for (name, _, _) in COUNTS {
        text += &format!("{name} = {}\n", limits.get(name).copied().unwrap_or_default());
    }
    text
}

/// All counts of a state of the sources.
fn count(root: &Path) -> Result<BTreeMap<&'static str, Count>, String> {
    let workspace = &source::read(root)?;
    let sources = &workspace.sources;
    let every_arrow = cycles::arrows(sources);
    let arrows = cycles::without_parents(sources, &every_arrow);
    let cycle = |cycle: Vec<String>| cycle.join(" <-> ");
    let cycles_of = |arrows| cycles::of_files(sources, arrows).into_iter().map(cycle).collect();
    let words = words::find(sources);
    let place = |(path, line): (String, usize)| format!("{path}:{line}");
    let mut settings: Vec<String> = words.settings_compared.into_iter().map(place).collect();
    // Several comparisons on a line count once, as in the review.
    settings.dedup();
    let constants = constants::find(sources);
    let in_four = |c: &constants::Constant| FOUR_FOLDERS.iter().any(|f| c.path.contains(f));
    let without = |four: bool| {
        let chosen = constants.iter().filter(|c| !c.has_source && in_four(c) == four);
        Count::of_places(chosen.map(|c| format!("{}:{}: {}", c.path, c.line, c.name)).collect())
    };
    let (_, empty) = tests_that_pass_empty::find(&workspace.tests);
    let empty = empty.into_iter().map(|e| format!("{}: {} {}", e.path, e.name, e.what));
    let plain = |value: f64| Count { value, places: Vec::new() };
    Ok(BTreeMap::from([
        ("largest_crate_percent", largest_crate(workspace)),
        ("file_cycles", Count::of_places(cycles_of(&arrows))),
        ("cycles_with_parents", Count::of_places(cycles_of(&every_arrow))),
        (
            "folder_cycles",
            Count::of_places(cycles::of_folders(sources, &arrows).into_iter().map(cycle).collect()),
        ),
        ("planner_arrows_upwards", Count::of_places(cycles::upwards(sources, &every_arrow, "grainpath"))),
        ("settings_compared_with_text", Count::of_places(settings)),
        ("words_compared", Count::of_places(words.words_compared.into_iter().map(place).collect())),
        ("wildcard_arms", Count::of_places(words.wildcard_arms.into_iter().map(place).collect())),
        ("comment_lines_per_1000_code_lines", plain(per_1000(sources, Line::Comment))),
        ("doc_lines_per_1000_code_lines", plain(per_1000(sources, Line::Doc))),
        ("doc_examples", plain(documentation::examples(sources) as f64)),
        ("module_texts", plain(documentation::module_texts(sources) as f64)),
        ("constants_without_source_in_four_folders", without(true)),
        ("constants_without_source_elsewhere", without(false)),
        ("empty_tests", Count::of_places(empty.collect())),
        ("table_rows_without_keys", Count::of_places(crate::measured::rows_without_keys(root)?)),
    ]))
}

fn per_1000(sources: &[Source], class: Line) -> f64 {
    let sum = |class: Line| sources.iter().map(|s| s.count(class)).sum::<usize>() as f64;
    // One decimal: the count of a large workspace should not change with each line.
    (1e4 * sum(class) / sum(Line::Code)).round() / 10.0
}

/// The largest crate's share; the places are the shares of all.
fn largest_crate(workspace: &Workspace) -> Count {
    let all = workspace.lines.values().sum::<usize>() as f64;
    let share = |n: usize| (1e3 * n as f64 / all).round() / 10.0;
    let value = workspace.lines.values().copied().max().map_or(0.0, share);
    let row = |(name, n): (&String, &usize)| format!("{name}: {n} lines, {} %", share(*n));
    Count { value, places: workspace.lines.iter().map(row).collect() }
}
