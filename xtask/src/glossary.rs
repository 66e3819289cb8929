//! Checks `docs/glossary.md` against the sources and the pages.
//!
//! The first table of that page holds our terms. Each one must occur in a page or a source, so that no entry is
//! left behind by a rename. A type that is named as a term (`Bead`, `Cells`) is defined in one file only: the same
//! name for a second thing is what readers stumble on. The job's choices are left out, because they are the words
//! for the types of the stages.
//!
//! The second table, *Senses kept apart*, lists terms with more than one sense and the places of each sense. A place
//! is a file or a folder; `elsewhere` stands for all others. No place is inside a place of another sense, every
//! place uses the term, and without a row `elsewhere` no item outside the places is named by it. So no file uses a
//! term in two senses. The check knows names and words, not meanings.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use syn::visit::Visit;

use crate::source::{self, Source};

const PAGE: &str = "docs/glossary.md";
/// Words of settings, which name the same things as the types that stages make of them.
const CHOICES: &str = "crates/grainpath-job/src/choices.rs";
/// The place of a sense that holds wherever no other place is named.
const ELSEWHERE: &str = "elsewhere";

/// A sense of a term, and where it holds.
struct Sense {
    term: String,
    places: Vec<String>,
}

/// Checks the page.
pub fn check() -> Result<(), String> {
    let root = crate::root();
    let page = fs::read_to_string(root.join(PAGE)).map_err(|e| format!("{PAGE}: {e}"))?;
    let workspace = source::read(&root)?;
    let mut pages = Vec::new();
    for name in ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"] {
        pages.push(fs::read_to_string(root.join(name)).map_err(|e| format!("{name}: {e}"))?);
    }
    read_pages(&root.join("docs"), &mut pages)?;
    let (terms, senses) = parse(&page);
    let wrong = faults(&terms, &senses, &workspace.sources, &pages);
    if wrong.is_empty() {
        println!("{} terms of {PAGE} are in use; {} senses stay apart", terms.len(), senses.len());
        return Ok(());
    }
    Err(wrong.join("\n       "))
}

/// The pages below a folder, but for the glossary itself.
fn read_pages(folder: &Path, pages: &mut Vec<String>) -> Result<(), String> {
    for entry in fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?.flatten() {
        let path = entry.path();
        if path.is_dir() {
            read_pages(&path, pages)?;
        } else if path.extension().is_some_and(|e| e == "md") && !path.ends_with("glossary.md") {
            pages.push(fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?);
        }
    }
    Ok(())
}

/// Terms of the first table, and senses of the table below the heading *Senses kept apart*.
fn parse(page: &str) -> (Vec<String>, Vec<Sense>) {
    let (mut terms, mut senses, mut is_apart) = (Vec::new(), Vec::new(), false);
    for line in page.lines() {
        is_apart |= line.starts_with("## Senses kept apart");
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let is_row = line.starts_with('|') && !line.starts_with("|-") && cells.get(1) != Some(&"word");
        match cells.as_slice() {
            ["", word, _, ""] if is_row && !is_apart => terms.push((*word).to_owned()),
            ["", word, _, places, ""] if is_row && is_apart => {
                let quoted = places.split('`').skip(1).step_by(2).map(str::to_owned);
                let elsewhere = (*places == ELSEWHERE).then(|| ELSEWHERE.to_owned());
                senses.push(Sense { term: (*word).to_owned(), places: quoted.chain(elsewhere).collect() });
            }
            _ => {}
        }
    }
    (terms, senses)
}

/// Everything that is wrong with the glossary or with the names in the sources.
fn faults(terms: &[String], senses: &[Sense], sources: &[Source], pages: &[String]) -> Vec<String> {
    let mut wrong = Vec::new();
    let texts: Vec<String> = sources.iter().map(|s| normal(&s.text.join("\n"))).collect();
    let pages: Vec<String> = pages.iter().map(|p| normal(p)).collect();
    let mut sorted = terms.to_vec();
    sorted.sort();
    sorted.dedup();
    if terms.is_empty() || sorted != terms {
        wrong.push(format!("{PAGE}: the terms should be in alphabetical order, each once"));
    }
    for term in terms {
        if !texts.iter().chain(&pages).any(|t| uses(t, term)) {
            wrong.push(format!("{PAGE}: \"{term}\" is used in no page and no source"));
        }
    }
    let named: Vec<Names> = sources.iter().map(Names::new).collect();
    for term in terms {
        let mut files: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for (source, names) in sources.iter().zip(&named).filter(|(s, _)| s.path != CHOICES) {
            for name in names.types.iter().filter(|n| forms(term).any(|f| normal(n).trim() == f)) {
                files.entry(name).or_default().insert(&source.path);
            }
        }
        for (name, files) in files.iter().filter(|(_, files)| files.len() > 1) {
            wrong.push(format!("the type {name}, a term of {PAGE}, is defined in {files:?}"));
        }
    }
    for term in senses.iter().map(|s| s.term.as_str()).collect::<BTreeSet<_>>() {
        let of_term: Vec<&Sense> = senses.iter().filter(|s| s.term == term).collect();
        if of_term.len() < 2 || !terms.iter().any(|t| t == term) {
            wrong.push(format!("{PAGE}: \"{term}\" should be a term with two senses or more"));
        }
        wrong.extend(faults_of_senses(term, &of_term, sources, &texts, &named));
    }
    wrong
}

fn faults_of_senses(
    term: &str,
    senses: &[&Sense],
    sources: &[Source],
    texts: &[String],
    named: &[Names],
) -> Vec<String> {
    let mut wrong = Vec::new();
    let is_in = |path: &str, place: &str| path == place || path.starts_with(&format!("{place}/"));
    for (i, sense) in senses.iter().enumerate() {
        if sense.places.is_empty() {
            wrong.push(format!("{PAGE}: a sense of \"{term}\" names no place"));
        }
        for place in sense.places.iter().filter(|p| *p != ELSEWHERE) {
            let used = sources.iter().zip(texts).any(|(s, t)| is_in(&s.path, place) && uses(t, term));
            if !used {
                wrong.push(format!("{PAGE}: \"{term}\" is not used in {place}"));
            }
            let others = senses[..i].iter().chain(&senses[i + 1..]).flat_map(|s| &s.places);
            for other in others.filter(|other| is_in(place, other)) {
                wrong.push(format!("{PAGE}: \"{term}\" has one sense in {place} and another in {other}"));
            }
        }
    }
    let places: Vec<&str> = senses.iter().flat_map(|s| &s.places).map(String::as_str).collect();
    if !places.contains(&ELSEWHERE) {
        for (source, names) in sources.iter().zip(named) {
            let outside = !places.iter().any(|place| is_in(&source.path, place));
            for name in names.all.iter().filter(|n| outside && uses(&normal(n), term)) {
                wrong.push(format!("{}: {name} uses \"{term}\" outside the places in {PAGE}", source.path));
            }
        }
    }
    wrong
}

/// A text as lower-case words with one blank around each: `LayerMark`, `layer_mark` and "layer\n/// mark" are the
/// same.
fn normal(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + text.len() / 8);
    out.push(' ');
    let mut last = ' ';
    for c in text.chars() {
        let starts_word = c.is_uppercase() && last.is_lowercase();
        if (starts_word || !c.is_alphabetic()) && !out.ends_with(' ') {
            out.push(' ');
        }
        if c.is_alphabetic() {
            out.extend(c.to_lowercase());
        }
        last = c;
    }
    if !out.ends_with(' ') {
        out.push(' ');
    }
    out
}

/// A term and its plural.
fn forms(term: &str) -> impl Iterator<Item = String> {
    let plural = match term.strip_suffix('y') {
        Some(stem) => format!("{stem}ies"),
        None if term.ends_with(['s', 'x', 'h']) => format!("{term}es"),
        None => format!("{term}s"),
    };
    [term.to_owned(), plural].into_iter()
}

/// Whether a normal text uses a term.
fn uses(normal_text: &str, term: &str) -> bool {
    forms(term).any(|form| normal_text.contains(&format!(" {form} ")))
}

/// The names that a file defines.
#[derive(Default)]
struct Names {
    types: Vec<String>,
    /// Types, functions, constants and fields.
    all: Vec<String>,
}

impl Names {
    fn new(source: &Source) -> Self {
        let mut names = Self::default();
        source.items.iter().for_each(|item| names.visit_item(item));
        names
    }

    fn add_type(&mut self, name: &syn::Ident) {
        self.types.push(name.to_string());
        self.all.push(name.to_string());
    }
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if source::is_for_tests(source::attributes(item)) {
            return;
        }
        match item {
            syn::Item::Struct(i) => self.add_type(&i.ident),
            syn::Item::Enum(i) => self.add_type(&i.ident),
            syn::Item::Trait(i) => self.add_type(&i.ident),
            syn::Item::Type(i) => self.add_type(&i.ident),
            syn::Item::Const(i) => self.all.push(i.ident.to_string()),
            syn::Item::Static(i) => self.all.push(i.ident.to_string()),
            _ => {}
        }
        syn::visit::visit_item(self, item);
    }

    fn visit_signature(&mut self, signature: &'ast syn::Signature) {
        self.all.push(signature.ident.to_string());
    }

    fn visit_field(&mut self, field: &'ast syn::Field) {
        self.all.extend(field.ident.as_ref().map(ToString::to_string));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(path: &str, text: &str) -> Source {
        Source {
            package: "p".to_owned(),
            path: path.to_owned(),
            module: Vec::new(),
            items: syn::parse_file(text).expect("the test is Rust").items,
            attrs: Vec::new(),
            lines: Vec::new(),
            text: vec![text.to_owned()],
        }
    }

    fn found(page: &str, sources: &[Source]) -> Vec<String> {
        let (terms, senses) = parse(page);
        faults(&terms, &senses, sources, &["A page on crack\nfronts.".to_owned()])
    }

    const TERMS: &str = "| word | meaning |\n|---|---|\n| bead | a line |\n| crack front | cells |\n";

    #[test]
    fn terms_without_use_are_found() {
        assert_eq!(found(TERMS, &[source("a.rs", "struct WideBead;")]), Vec::<String>::new());
        let wrong = found(TERMS, &[source("a.rs", "struct Beady;")]);
        assert!(wrong.len() == 1 && wrong[0].contains("\"bead\" is used in no page"), "{wrong:?}");
    }

    #[test]
    fn types_with_the_name_of_a_term_are_defined_once() {
        let twice = [source("a.rs", "struct Bead;"), source("b.rs", "enum Bead {}")];
        let wrong = found(TERMS, &twice);
        assert!(wrong.len() == 1 && wrong[0].contains("the type Bead"), "{wrong:?}");
        let tests =
            [source("a.rs", "struct Bead;"), source("b.rs", "#[cfg(test)] mod tests { struct Bead; }")];
        assert_eq!(found(TERMS, &tests), Vec::<String>::new());
    }

    #[test]
    fn senses_have_places_of_their_own() {
        let page = |a: &str, b: &str| {
            format!(
                "{TERMS}\n## Senses kept apart\n\n| word | sense | where |\n|---|---|---|\n| bead | one | {a} |\n| bead | two | {b} |\n"
            )
        };
        let sources = [source("x/a.rs", "struct Bead;"), source("y/b.rs", "fn lay_beads() {}")];
        assert_eq!(found(&page("`x`", "`y/b.rs`"), &sources), Vec::<String>::new());
        assert_eq!(found(&page("`x`", "elsewhere"), &sources), Vec::<String>::new());
        let says = |a, b, text: &str| {
            let wrong = found(&page(a, b), &sources);
            assert!(wrong.iter().any(|w| w.contains(text)), "{wrong:?} should say {text:?}");
        };
        says("`x`", "`x/a.rs`", "has one sense in x/a.rs and another in x");
        says("`x`", "`z`", "is not used in z");
        says("`x/a.rs`", "`x/a.rs`", "lay_beads uses \"bead\" outside");
        says("`x`", "", "names no place");
    }
}
