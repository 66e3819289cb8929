//! Named numbers, and whether a comment says where each comes from.
//!
//! A *constant* is a `const` or `static`, at any depth outside tests, whose value holds a number of its own: an
//! integer or a float other than 0, 1, -1 and 2 in its expression, not in its type. It has a *source* if the comments
//! directly above it, or after it on its lines, hold "Source:" or "Measured:". A comment above several constants
//! without a blank line between them speaks for the first of them alone.

use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::spanned::Spanned;
use syn::visit::Visit;

use crate::source::{self, Source};

/// A constant: its place, its name, and whether it has a source.
pub struct Constant {
    pub path: String,
    pub line: usize,
    pub name: String,
    pub has_source: bool,
}

/// The constants of all files.
pub fn find(sources: &[Source]) -> Vec<Constant> {
    let mut constants = Vec::new();
    for source in sources {
        let mut look = Look { source, constants: &mut constants };
        for item in &source.items {
            look.visit_item(item);
        }
    }
    constants
}

struct Look<'a> {
    source: &'a Source,
    constants: &'a mut Vec<Constant>,
}

impl Look<'_> {
    fn note(&mut self, name: &syn::Ident, value: &syn::Expr, whole: proc_macro2::Span) {
        if !holds_number(value.to_token_stream()) {
            return;
        }
        let comments = self.comments(name.span().start().line, whole.end().line);
        let has_source = comments.contains("Source:") || comments.contains("Measured:");
        self.constants.push(Constant {
            path: self.source.path.clone(),
            line: name.span().start().line,
            name: name.to_string(),
            has_source,
        });
    }

    /// The comments directly above a line, and those on the lines up to `last`.
    fn comments(&self, first: usize, last: usize) -> String {
        let is_above = |line: &&String| {
            let line = line.trim_start();
            line.starts_with("//") || line.starts_with("#[")
        };
        let above: Vec<&String> =
            // Attributes may stand between a comment and its constant.
            self.source.text[..first.saturating_sub(1)].iter().rev().take_while(is_above).collect();
        let own = self.source.text.iter().skip(first - 1).take(last + 1 - first);
        let after = own.filter_map(|line| line.split_once("//").map(|(_, comment)| comment));
        let text = |line: &String| line.trim_start().trim_start_matches(['/', '!']).trim().to_owned();
        let above = above.into_iter().rev().map(text);
        above.chain(after.map(str::to_owned)).collect::<Vec<_>>().join(" ")
    }
}

impl<'ast> Visit<'ast> for Look<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !source::is_for_tests(source::attributes(item)) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_item_const(&mut self, item: &'ast syn::ItemConst) {
        // The expression of a constant may hold constants of its own.
        self.note(&item.ident, &item.expr, item.span());
        syn::visit::visit_item_const(self, item);
    }

    fn visit_impl_item_const(&mut self, item: &'ast syn::ImplItemConst) {
        self.note(&item.ident, &item.expr, item.span());
    }

    fn visit_item_static(&mut self, item: &'ast syn::ItemStatic) {
        self.note(&item.ident, &item.expr, item.span());
    }
}

/// Whether an expression holds a number that somebody chose.
fn holds_number(tokens: TokenStream) -> bool {
    tokens.into_iter().any(|tree| match tree {
        TokenTree::Literal(literal) => match syn::Lit::new(literal) {
            // 0, 1 and 2 are structure (empty, one, both, halves) and seldom a choice.
            syn::Lit::Int(n) => n.base10_parse::<u128>().map_or(true, |n| n > 2),
            syn::Lit::Float(x) => x.base10_parse::<f64>().map_or(true, |x| x != 0.0 && x != 1.0 && x != 2.0),
            _ => false,
        },
        TokenTree::Group(group) => holds_number(group.stream()),
        _ => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constants(text: &str) -> Vec<(String, bool)> {
        let source = Source {
            package: "p".to_owned(),
            path: "a.rs".to_owned(),
            module: Vec::new(),
            items: syn::parse_file(text).expect("the test is Rust").items,
            attrs: Vec::new(),
            lines: Vec::new(),
            text: text.lines().map(str::to_owned).collect(),
        };
        find(&[source]).into_iter().map(|c| (c.name, c.has_source)).collect()
    }

    #[test]
    fn a_source_stands_above_or_behind_a_constant() {
        let text = "/// Length.\n/// Source: [Aspnes1994].\nconst A: f64 = 3.0;\nconst B: f64 = 4.0;\n\
                    const C: f64 = 5.0; // Measured: cargo xtask bench constants C\nconst D: usize = 2;\n\
                    const E: f64 = A * B;\nconst F: &str = \"3.0\";\n";
        let row = |name: &str, source| (name.to_owned(), source);
        assert_eq!(constants(text), [row("A", true), row("B", false), row("C", true)]);
    }
}
