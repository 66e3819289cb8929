//! Texts drawn at random from the sources, to be read as by somebody who never saw the project.
//!
//! A text is a paragraph of comments or of documentation, or a string with four words or more: a message, a line
//! of help, or what a setting does. Every text is as likely as any other. The same seed draws the same texts from
//! the same sources.

use proc_macro2::{Delimiter, Ident, TokenStream, TokenTree};
use quote::ToTokens;

use crate::source::{self, Line, Source};

/// A text and its place.
#[derive(Debug, PartialEq, Eq)]
struct Text {
    path: String,
    line: usize,
    text: String,
}

/// Prints texts: `words` are the seed and their number.
pub fn run(words: &[&str]) -> Result<(), String> {
    let whole = |k: usize, usual: u64| {
        words.get(k).map_or(Ok(usual), |w| w.parse().map_err(|_| format!("{w} should be a whole number")))
    };
    let (seed, count) = (whole(0, 1)?, whole(1, 40)?);
    let all = texts(&source::read(&crate::root())?.sources);
    println!("{} texts; {count} drawn with seed {seed}\n", all.len());
    for (k, at) in draw(all.len(), count as usize, seed).into_iter().enumerate() {
        let Text { path, line, text } = &all[at];
        println!("{}. {path}:{line}\n   {}\n", k + 1, text.replace('\n', "\n   "));
    }
    Ok(())
}

/// Different numbers below `n`, at most `count` of them.
fn draw(n: usize, count: usize, seed: u64) -> Vec<usize> {
    // splitmix64 (`steele2014`), and the first steps of a Fisher-Yates shuffle.
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let mut all: Vec<usize> = (0..n).collect();
    let count = count.min(n);
    for k in 0..count {
        let other = k + (next() % (n - k) as u64) as usize;
        all.swap(k, other);
    }
    all.truncate(count);
    all
}

/// All texts of the sources, in the order of the files.
fn texts(sources: &[Source]) -> Vec<Text> {
    let mut all = Vec::new();
    for source in sources {
        paragraphs(source, &mut all);
        let mut strings = Vec::new();
        for item in &source.items {
            literals(item.to_token_stream(), &mut strings);
        }
        all.extend(strings.into_iter().map(|(line, text)| Text { path: source.path.clone(), line, text }));
    }
    all
}

/// Comments and documentation, by paragraphs.
fn paragraphs(source: &Source, all: &mut Vec<Text>) {
    let mut open: Option<(Line, Text)> = None;
    for (k, (class, text)) in source.lines.iter().zip(&source.text).enumerate() {
        let class = class.filter(|c| matches!(c, Line::Doc | Line::Comment));
        let words = text.trim().trim_start_matches(['/', '!']).trim_end().to_owned();
        let Some(class) = class.filter(|_| !words.trim().is_empty()) else {
            all.extend(open.take().map(|o| o.1));
            continue;
        };
        match &mut open {
            Some((of, text)) if *of == class => {
                text.text.push('\n');
                text.text.push_str(words.trim_start_matches(' '));
            }
            _ => {
                all.extend(open.take().map(|o| o.1));
                let text = Text { path: source.path.clone(), line: k + 1, text: words.trim().to_owned() };
                open = Some((class, text));
            }
        }
    }
    all.extend(open.map(|o| o.1));
}

/// Strings of four words or more with their lines; documentation is left out.
fn literals(tokens: TokenStream, strings: &mut Vec<(usize, String)>) {
    let mut after_hash = false;
    for tree in tokens {
        let is_hash = matches!(&tree, TokenTree::Punct(p) if p.as_char() == '#' || p.as_char() == '!');
        match tree {
            TokenTree::Group(group) => {
                let first = group.stream().into_iter().next();
                let is_doc = matches!(first, Some(TokenTree::Ident(name)) if is_documentation(&name));
                if !(after_hash && group.delimiter() == Delimiter::Bracket && is_doc) {
                    literals(group.stream(), strings);
                }
            }
            TokenTree::Literal(literal) => {
                let line = literal.span().start().line;
                if let syn::Lit::Str(text) = syn::Lit::new(literal)
                    && text.value().split_whitespace().count() >= 4
                    // Templates of SVG are not read by people.
                    && !text.value().contains("=\"")
                {
                    strings.push((line, text.value()));
                }
            }
            _ => {}
        }
        after_hash = is_hash;
    }
}

/// Whether an attribute holds text that is counted as documentation, or a reason for the compiler.
fn is_documentation(name: &Ident) -> bool {
    name == "doc" || name == "expect" || name == "allow"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_and_messages_are_texts() {
        let text = "//! One.\n//!\n//! Two\n//! lines.\n\n/// Doc.\nfn f() {\n    // Why.\n    g(\"a message of five words\", \"short\");\n}\n";
        let file = syn::parse_file(text).expect("the test is Rust");
        let doc = |k: usize| [1, 2, 3, 4, 6].contains(&k);
        let lines = (1..=10).map(|k| match k {
            k if doc(k) => Some(Line::Doc),
            8 => Some(Line::Comment),
            5 => Some(Line::Blank),
            _ => Some(Line::Code),
        });
        let source = Source {
            package: "p".to_owned(),
            path: "a.rs".to_owned(),
            module: Vec::new(),
            items: file.items,
            attrs: file.attrs,
            lines: lines.collect(),
            text: text.lines().map(str::to_owned).collect(),
        };
        let found: Vec<(usize, String)> = texts(&[source]).into_iter().map(|t| (t.line, t.text)).collect();
        let want =
            [(1, "One."), (3, "Two\nlines."), (6, "Doc."), (8, "Why."), (9, "a message of five words")];
        assert_eq!(found, want.map(|(line, text)| (line, text.to_owned())));
    }

    #[test]
    fn draws_repeat_and_differ_by_seed() {
        let one = draw(1000, 40, 11);
        assert_eq!(one, draw(1000, 40, 11));
        assert_ne!(one, draw(1000, 40, 12));
        let mut sorted = one.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), 40);
        assert_eq!(draw(3, 40, 1).len(), 3);
    }
}
