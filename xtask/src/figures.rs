//! Measured figures of the README: one file holds them, and the table is made from it.
//!
//! `docs/figures.toml` has a row for each figure with the command that measures it, the page that tells of the
//! measurement, and the pieces of that page that hold the numbers. [`run`] fails where the table of `README.md` is not
//! the one that the file makes, where a piece is no longer in its page, or where a number of the table is in none of
//! the pieces. A new measurement therefore changes the page, the file and the README together.

use std::fmt::Write;
use std::fs;

/// The figures.
const FILE: &str = "docs/figures.toml";
/// The page with the table.
const PAGE: &str = "README.md";
/// The lines between which the table stands.
const BEGIN: &str = "<!-- figures: written by `cargo xtask figures --write` from docs/figures.toml -->";
const END: &str = "<!-- end of figures -->";

/// A measured figure.
#[derive(Debug)]
struct Figure {
    what: String,
    ours: String,
    beside: String,
    command: String,
    page: String,
    quotes: Vec<String>,
    measured: String,
}

/// Compares the table with the file, or writes it.
pub fn run(words: &[&str]) -> Result<(), String> {
    let figures = parse(&read(FILE)?)?;
    let page = read(PAGE)?;
    let made = with_table(&page, &table(&figures))?;
    match words {
        ["--write"] => fs::write(crate::root().join(PAGE), &made).map_err(|e| format!("{PAGE}: {e}"))?,
        [] if made != page => {
            return Err(format!(
                "the table of {PAGE} is not that of {FILE}; `cargo xtask figures --write` writes it"
            ));
        }
        [] => {}
        _ => return Err("usage: cargo xtask figures [--write]".to_owned()),
    }
    for figure in &figures {
        unfounded(figure, &read(&figure.page)?)?;
    }
    println!("{} figures of {PAGE} stand in their pages", figures.len());
    Ok(())
}

fn parse(text: &str) -> Result<Vec<Figure>, String> {
    let table: toml::Table = text.parse().map_err(|e| format!("{FILE}: {e}"))?;
    let rows = table.get("figure").and_then(toml::Value::as_array).ok_or(format!("{FILE}: no [[figure]]"))?;
    let read = |row: &toml::Value| {
        let text = |key: &str| {
            let value = row.get(key).and_then(toml::Value::as_str);
            value.map(str::to_owned).ok_or(format!("{FILE}: a figure lacks `{key}`: {row}"))
        };
        let quotes = row.get("quotes").and_then(toml::Value::as_array).cloned().unwrap_or_default();
        Ok(Figure {
            what: text("what")?,
            ours: text("ours")?,
            beside: text("beside")?,
            command: text("command")?,
            page: text("page")?,
            quotes: quotes.iter().filter_map(|q| q.as_str().map(str::to_owned)).collect(),
            measured: text("measured")?,
        })
    };
    rows.iter().map(read).collect()
}

fn table(figures: &[Figure]) -> String {
    let mut out = String::from("| measured | grainpath | beside | with |\n|---|---|---|---|\n");
    for f in figures {
        let _ =
            writeln!(out, "| {} | **{}** | {} | [`{}`]({}) |", f.what, f.ours, f.beside, f.command, f.page);
    }
    out
}

fn with_table(page: &str, table: &str) -> Result<String, String> {
    let lacks = || format!("{PAGE} lacks the lines {BEGIN:?} and {END:?}");
    let (before, rest) = page.split_once(BEGIN).ok_or_else(lacks)?;
    let (_, after) = rest.split_once(END).ok_or_else(lacks)?;
    Ok(format!("{before}{BEGIN}\n{table}{END}{after}"))
}

/// Fails where a quote is not in the page, or a number in no quote.
fn unfounded(figure: &Figure, page: &str) -> Result<(), String> {
    if let Some(quote) = figure.quotes.iter().find(|q| !page.contains(*q)) {
        return Err(format!("{}: {} does not hold {quote:?}", figure.what, figure.page));
    }
    if figure.measured.split(", ").count() != 2 {
        return Err(format!("{}: `measured` should be a date and a commit", figure.what));
    }
    let quoted: Vec<String> = figure.quotes.iter().flat_map(|q| numbers(q)).collect();
    let told = [numbers(&figure.ours), numbers(&figure.beside)].concat();
    match told.iter().find(|n| !quoted.contains(n)) {
        None => Ok(()),
        Some(n) => Err(format!("{}: {n} is in none of the quotes of {}", figure.what, figure.page)),
    }
}

/// The numbers of a text, as they are written.
fn numbers(text: &str) -> Vec<String> {
    let parts = text.split(|c: char| !c.is_ascii_digit() && c != '.');
    parts.map(|p| p.trim_matches('.').to_owned()).filter(|p| !p.is_empty()).collect()
}

fn read(path: &str) -> Result<String, String> {
    fs::read_to_string(crate::root().join(path)).map_err(|e| format!("{path}: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(ours: &str) -> Figure {
        Figure {
            what: "a part".into(),
            ours: ours.into(),
            beside: "peer 2.5 s".into(),
            command: "cargo xtask bench".into(),
            page: "docs/page.md".into(),
            quotes: vec!["| part | 0.4 s | 2.5 s |".into()],
            measured: "2026-01-01, abc".into(),
        }
    }

    #[test]
    fn a_number_that_no_page_holds_is_found() {
        let page = "text\n| part | 0.4 s | 2.5 s | more |\n";
        assert_eq!(unfounded(&figure("0.4 s"), page), Ok(()));
        assert!(unfounded(&figure("0.3 s"), page).is_err_and(|e| e.contains("0.3 is in none")));
        assert!(
            unfounded(&figure("0.4 s"), "| part | 0.5 s | 2.5 s |")
                .is_err_and(|e| e.contains("does not hold"))
        );
    }

    #[test]
    fn the_table_replaces_what_stands_between_its_lines() {
        let page = format!("# Title\n{BEGIN}\nold\n{END}\nrest\n");
        let made = with_table(&page, &table(&[figure("0.4 s")])).expect("both lines");
        assert!(
            made.starts_with("# Title\n") && made.ends_with("\nrest\n") && !made.contains("old"),
            "{made}"
        );
        assert!(made.contains("| a part | **0.4 s** | peer 2.5 s |"), "{made}");
        assert!(with_table("no table", "").is_err());
    }
}
