//! Choices that travel as text: comparisons with string literals, and `_` arms that take an unknown word for a
//! default.
//!
//! The crates through which settings flow are looked at. Left out are the job's own crate (which turns
//! words into types), the readers of files, and the vocabulary. Tests are left out.

use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::visit::Visit;

use crate::source::{self, Source};

/// Crates whose texts are no choices: file formats and programs consist of words.
const TEXT_IS_INPUT: [&str; 4] = ["grainpath-core", "grainpath-io", "grainpath-gcode", "grainpath-job"];

/// Where something was found: path and line.
pub type Place = (String, usize);

/// The comparisons found in the sources.
#[derive(Default)]
pub struct Found {
    /// A field other than `name`, `==` or `!=` a string literal, outside `job` and `config.rs`.
    pub settings_compared: Vec<Place>,
    /// Every other comparison of a value with a word: a variable with a literal, `matches!` with a literal, or a
    /// `match` with two arms or more that are literals.
    pub words_compared: Vec<Place>,
    /// A `_` arm beside arms that are string literals, or that are variants of a choice of `grainpath-job`.
    pub wildcard_arms: Vec<Place>,
}

/// Searches the crates in which settings are used.
pub fn find(sources: &[Source]) -> Found {
    let choices = choices(sources);
    let mut found = Found::default();
    for source in sources.iter().filter(|s| !TEXT_IS_INPUT.contains(&s.package.as_str())) {
        let mut look = Look { path: &source.path, choices: &choices, found: &mut found, settings: true };
        // `config` turns words into types, as long as some choices of the job are still text.
        look.settings = source.module.last().is_none_or(|m| m != "config");
        if source.module.first().is_some_and(|m| m == "job") {
            continue;
        }
        for item in &source.items {
            look.visit_item(item);
        }
    }
    found
}

/// Names of the enums that `grainpath-job` defines, by themselves or in the arguments of a macro.
fn choices(sources: &[Source]) -> Vec<String> {
    let mut names = Vec::new();
    for source in sources.iter().filter(|s| s.package == "grainpath-job") {
        for item in &source.items {
            enums(item.to_token_stream(), &mut names);
        }
    }
    names
}

fn enums(tokens: TokenStream, names: &mut Vec<String>) {
    let mut after_enum = false;
    for tree in tokens {
        match tree {
            TokenTree::Ident(name) if after_enum => {
                names.push(name.to_string());
                after_enum = false;
            }
            TokenTree::Ident(name) => after_enum = name == "enum",
            TokenTree::Group(group) => enums(group.stream(), names),
            _ => after_enum = false,
        }
    }
}

struct Look<'a> {
    path: &'a str,
    choices: &'a [String],
    found: &'a mut Found,
    /// Whether comparisons count here, or `_` arms alone.
    settings: bool,
}

impl Look<'_> {
    fn place(&self, span: proc_macro2::Span) -> Place {
        (self.path.to_owned(), span.start().line)
    }
}

impl<'ast> Visit<'ast> for Look<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !source::is_for_tests(source::attributes(item)) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_expr_binary(&mut self, binary: &'ast syn::ExprBinary) {
        let compares = matches!(binary.op, syn::BinOp::Eq(_) | syn::BinOp::Ne(_));
        let other = match (text(&binary.left), text(&binary.right)) {
            (true, false) => Some(&binary.right),
            (false, true) => Some(&binary.left),
            _ => None,
        };
        if let (true, true, Some(other)) = (compares, self.settings, other) {
            let place = self.place(syn::spanned::Spanned::span(binary));
            match stripped(other) {
                syn::Expr::Field(field) if !matches!(&field.member, syn::Member::Named(n) if n == "name") => {
                    self.found.settings_compared.push(place);
                }
                _ => self.found.words_compared.push(place),
            }
        }
        syn::visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_match(&mut self, expr: &'ast syn::ExprMatch) {
        let literals = expr.arms.iter().filter(|a| is_text_pattern(&a.pat)).count();
        let of_choice = expr.arms.iter().any(|a| names_choice(&a.pat, self.choices));
        if literals > 1 && self.settings {
            self.found.words_compared.push(self.place(syn::spanned::Spanned::span(expr)));
        }
        if literals > 0 || of_choice {
            for arm in expr.arms.iter().filter(|a| matches!(a.pat, syn::Pat::Wild(_))) {
                if !refuses(&arm.body) {
                    self.found.wildcard_arms.push(self.place(syn::spanned::Spanned::span(&arm.pat)));
                }
            }
        }
        syn::visit::visit_expr_match(self, expr);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        if self.settings && item.path.is_ident("matches") {
            let mut after_comma = false;
            for tree in item.tokens.clone() {
                match tree {
                    TokenTree::Punct(p) if p.as_char() == ',' => after_comma = true,
                    TokenTree::Literal(l) if after_comma && l.to_string().starts_with('"') => {
                        self.found.words_compared.push(self.place(l.span()));
                        break;
                    }
                    _ => {}
                }
            }
        }
        // The arguments of `assert!` and similar macros are expressions, and are searched as such.
        if let Ok(arguments) =
            item.parse_body_with(syn::punctuated::Punctuated::<syn::Expr, syn::Token![,]>::parse_terminated)
        {
            for argument in &arguments {
                self.visit_expr(argument);
            }
        }
    }
}

/// An expression without the references, brackets and `as_str()` or `as_ref()` around it.
fn stripped(expr: &syn::Expr) -> &syn::Expr {
    match expr {
        syn::Expr::Reference(e) => stripped(&e.expr),
        syn::Expr::Paren(e) => stripped(&e.expr),
        syn::Expr::Unary(e) => stripped(&e.expr),
        syn::Expr::MethodCall(e) if ["as_str", "as_ref", "as_deref"].iter().any(|m| e.method == m) => {
            stripped(&e.receiver)
        }
        other => other,
    }
}

fn text(expr: &syn::Expr) -> bool {
    matches!(stripped(expr), syn::Expr::Lit(l) if matches!(l.lit, syn::Lit::Str(_)))
}

/// Whether a pattern is a string literal, alone or in `Some(...)` or an alternative.
fn is_text_pattern(pattern: &syn::Pat) -> bool {
    match pattern {
        syn::Pat::Lit(l) => matches!(l.lit, syn::Lit::Str(_)),
        syn::Pat::Or(or) => or.cases.iter().any(is_text_pattern),
        syn::Pat::Tuple(t) => t.elems.iter().any(is_text_pattern),
        syn::Pat::TupleStruct(t) => t.elems.iter().any(is_text_pattern),
        syn::Pat::Paren(p) => is_text_pattern(&p.pat),
        syn::Pat::Reference(r) => is_text_pattern(&r.pat),
        _ => false,
    }
}

/// Whether a pattern names a variant of a choice.
fn names_choice(pattern: &syn::Pat, choices: &[String]) -> bool {
    let of = |path: &syn::Path| {
        let n = path.segments.len();
        n > 1 && choices.iter().any(|c| path.segments[n - 2].ident == c)
    };
    match pattern {
        syn::Pat::Path(p) => of(&p.path),
        syn::Pat::TupleStruct(t) => of(&t.path) || t.elems.iter().any(|p| names_choice(p, choices)),
        syn::Pat::Struct(s) => of(&s.path),
        syn::Pat::Or(or) => or.cases.iter().any(|p| names_choice(p, choices)),
        syn::Pat::Tuple(t) => t.elems.iter().any(|p| names_choice(p, choices)),
        _ => false,
    }
}

/// Whether an arm refuses the value: by an error, `return`, `None`, `continue` or a panic. Such an arm is
/// no default.
fn refuses(body: &syn::Expr) -> bool {
    match stripped(body) {
        syn::Expr::Return(_) | syn::Expr::Continue(_) => true,
        syn::Expr::Path(p) => p.path.is_ident("None"),
        syn::Expr::Call(call) => {
            matches!(&*call.func, syn::Expr::Path(p) if p.path.segments.last().is_some_and(|s| s.ident == "Err"))
        }
        syn::Expr::Macro(m) => {
            m.mac.path.segments.last().is_some_and(|s| s.ident == "unreachable" || s.ident == "panic")
        }
        syn::Expr::Block(block) => match block.block.stmts.as_slice() {
            [.., syn::Stmt::Expr(last, _)] => refuses(last),
            _ => false,
        },
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> [usize; 3] {
        let source = Source {
            package: "grainpath".to_owned(),
            path: "a.rs".to_owned(),
            module: vec!["a".to_owned()],
            items: syn::parse_file(text).expect("the test is Rust").items,
            attrs: Vec::new(),
            lines: Vec::new(),
            text: Vec::new(),
        };
        let choice = Source {
            package: "grainpath-job".to_owned(),
            path: "b.rs".to_owned(),
            module: vec!["b".to_owned()],
            items: syn::parse_file("words! { pub enum Seam { Rear, Near } }").expect("Rust").items,
            attrs: Vec::new(),
            lines: Vec::new(),
            text: Vec::new(),
        };
        let found = find(&[source, choice]);
        [found.settings_compared.len(), found.words_compared.len(), found.wildcard_arms.len()]
    }

    #[test]
    fn comparisons_of_settings_and_of_other_words_are_told_apart() {
        assert_eq!(found(r#"fn f() { if s.kind == "a" || "b" != s.fill.kind.as_str() {} }"#), [2, 0, 0]);
        assert_eq!(found(r#"fn f() { if kind == "a" || p.name == "b" {} }"#), [0, 2, 0]);
        assert_eq!(found(r#"fn f() { matches!(kind, "a" | "b"); }"#), [0, 1, 0]);
        assert_eq!(found(r#"fn f() { assert!(s.kind == "a"); }"#), [1, 0, 0]);
        assert_eq!(found(r#"#[cfg(test)] mod t { fn f() { s.kind == "a"; } }"#), [0, 0, 0]);
    }

    #[test]
    fn arms_that_take_the_unknown_for_a_default_count() {
        assert_eq!(found(r#"fn f() { match s { "a" => 1, "b" => 2, _ => 3 }; }"#), [0, 1, 1]);
        assert_eq!(found(r#"fn f() { match s { "a" => Ok(1), _ => Err(2) }; }"#), [0, 0, 0]);
        assert_eq!(found("fn f() { match s { Seam::Rear => 1, _ => 2 }; }"), [0, 0, 1]);
        assert_eq!(found("fn f() { match s { Other::Rear => 1, _ => 2 }; }"), [0, 0, 0]);
    }
}
