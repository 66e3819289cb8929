//! Measured figures of the README: one file says which, and the table is made from it.
//!
//! `docs/figures.toml` has a row for each figure with the command that measures it and the page that tells of the
//! measurement. Its numbers are keys of `docs/measured.toml` in braces, as `{slicing.benchy.grainpath.wall-s} s`. [`run`]
//! fails where the table of `README.md` is not the one that both files make, where a number of the table is typed, or
//! where a page quotes another number than the measured one ([`crate::measured`]).

use std::fmt::Write;
use std::fs;

use crate::measured::Measured;

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
}

/// Compares the table and the pages with the files, or writes them.
pub fn run(words: &[&str]) -> Result<(), String> {
    let measured = Measured::read()?;
    let figures = parse(&read(FILE)?)?;
    let page = read(PAGE)?;
    let made = with_table(&page, &table(&figures, &measured)?)?;
    match words {
        ["--write"] => {
            fs::write(crate::root().join(PAGE), &made).map_err(|e| format!("{PAGE}: {e}"))?;
            measured.renew_pages()?;
        }
        [] if made != page => {
            return Err(format!(
                "the table of {PAGE} is not that of {FILE}; `cargo xtask figures --write` writes it"
            ));
        }
        [] => {}
        _ => return Err("usage: cargo xtask figures [--write]".to_owned()),
    }
    let n_quotes = measured.check_pages()?;
    println!(
        "{} figures of {PAGE} and {n_quotes} numbers of pages are those that were measured",
        figures.len()
    );
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
        Ok(Figure {
            what: text("what")?,
            ours: text("ours")?,
            beside: text("beside")?,
            command: text("command")?,
            page: text("page")?,
        })
    };
    rows.iter().map(read).collect()
}

fn table(figures: &[Figure], measured: &Measured) -> Result<String, String> {
    let mut out = String::from("| measured | grainpath | beside | with |\n|---|---|---|---|\n");
    for f in figures {
        let (ours, beside) = (filled(&f.ours, measured)?, filled(&f.beside, measured)?);
        let _ = writeln!(out, "| {} | **{ours}** | {beside} | [`{}`]({}) |", f.what, f.command, f.page);
    }
    Ok(out)
}

/// A text with its keys replaced by their numbers.
fn filled(text: &str, measured: &Measured) -> Result<String, String> {
    let (mut out, mut typed) = (String::new(), String::new());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('{') {
        let (key, after) = after.split_once('}').ok_or_else(|| format!("{FILE}: {text:?} lacks a brace"))?;
        typed += before;
        out += before;
        out += measured.value(key)?;
        rest = after;
    }
    typed += rest;
    if typed.contains(|c: char| c.is_ascii_digit()) || out.is_empty() {
        return Err(format!(
            "{FILE}: {text:?} holds a number that is typed; it should be the key of a measurement"
        ));
    }
    Ok(out + rest)
}

fn with_table(page: &str, table: &str) -> Result<String, String> {
    let lacks = || format!("{PAGE} lacks the lines {BEGIN:?} and {END:?}");
    let (before, rest) = page.split_once(BEGIN).ok_or_else(lacks)?;
    let (_, after) = rest.split_once(END).ok_or_else(lacks)?;
    Ok(format!("{before}{BEGIN}\n{table}{END}{after}"))
}

fn read(path: &str) -> Result<String, String> {
    fs::read_to_string(crate::root().join(path)).map_err(|e| format!("{path}: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_from_the_measurement_alone() {
        let measured =
            Measured::parse("[\"slicing.benchy\"]\nwall-s = \"0.46\"\npeak-mib = \"24\"\n").expect("a file");
        let fill = |text: &str| filled(text, &measured);
        assert_eq!(
            fill("{slicing.benchy.wall-s} s, {slicing.benchy.peak-mib} MiB"),
            Ok("0.46 s, 24 MiB".to_owned())
        );
        assert!(fill("0.46 s").is_err_and(|e| e.contains("typed")));
        assert!(fill("{slicing.benchy.wall-s} s, 24 MiB").is_err_and(|e| e.contains("typed")));
        assert!(fill("24 MiB, {slicing.benchy.wall-s} s").is_err_and(|e| e.contains("typed")));
        assert!(fill("{slicing.bunny.wall-s} s").is_err_and(|e| e.contains("has no")));
        assert!(fill("fast").is_err());
    }

    #[test]
    fn a_page_without_the_marks_is_refused() {
        assert!(with_table("no marks", "table").is_err());
        let page = format!("a\n{BEGIN}\nold\n{END}\nb");
        assert_eq!(with_table(&page, "new\n"), Ok(format!("a\n{BEGIN}\nnew\n{END}\nb")));
    }
}
