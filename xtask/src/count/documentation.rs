//! Documentation that is counted: examples that compile, and texts of modules.

use syn::visit::Visit;

use crate::source::{self, Source};

/// Shortest text of a module that counts. Ten lines have room for what a reader of an algorithm needs:
/// what it computes, method and source, units, cost, degenerate cases.
const MIN_MODULE_TEXT_LINES: usize = 10;

/// Files whose `//!` text has 10 lines or more; empty lines count.
pub fn module_texts(sources: &[Source]) -> usize {
    sources.iter().filter(|s| source::doc_text(&s.attrs).len() >= MIN_MODULE_TEXT_LINES).count()
}

/// Examples in doc comments that rustdoc compiles and runs: fenced blocks without a language or of
/// `rust`, except those marked `ignore`, `no_run` or `compile_fail`.
pub fn examples(sources: &[Source]) -> usize {
    let mut look = Examples(0);
    for source in sources {
        look.0 += fenced(&source::doc_text(&source.attrs));
        for item in &source.items {
            look.visit_item(item);
        }
    }
    look.0
}

struct Examples(usize);

impl<'ast> Visit<'ast> for Examples {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !source::is_for_tests(source::attributes(item)) {
            self.0 += fenced(&source::doc_text(source::attributes(item)));
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.0 += fenced(&source::doc_text(&item.attrs));
    }

    fn visit_impl_item_const(&mut self, item: &'ast syn::ImplItemConst) {
        self.0 += fenced(&source::doc_text(&item.attrs));
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        self.0 += fenced(&source::doc_text(&item.attrs));
    }

    fn visit_variant(&mut self, item: &'ast syn::Variant) {
        self.0 += fenced(&source::doc_text(&item.attrs));
    }

    fn visit_field(&mut self, item: &'ast syn::Field) {
        self.0 += fenced(&source::doc_text(&item.attrs));
    }
}

/// The number of compiled examples among the lines of a doc comment.
fn fenced(lines: &[String]) -> usize {
    let (mut open, mut n_examples) = (false, 0);
    for line in lines {
        if let Some(info) = line.trim_start().strip_prefix("```") {
            if !open {
                let mut words = info.split([',', ' ']).map(str::trim).filter(|w| !w.is_empty());
                let runs = words.all(|w| w == "rust" || w == "should_panic" || w.starts_with("edition"));
                n_examples += usize::from(runs);
            }
            // A closing fence has no info text, so it would look like an example.
            open = !open;
        }
    }
    n_examples
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_that_do_not_run_do_not_count() {
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(fenced(&lines("Text.\n```\nlet x = 1;\n```\nMore.\n```rust\nlet y = 2;\n```")), 2);
        for info in ["text", "no_run", "ignore", "rust,no_run", "toml", "compile_fail", "console"] {
            assert_eq!(fenced(&lines(&format!("```{info}\nlet x = 1;\n```"))), 0, "{info}");
        }
    }
}
