//! Tests that can pass without having checked anything.
//!
//! A test is *empty* if it can end early without failing (a `return` without a value, or a `return
//! Ok(())`, outside closures). It is also empty if nothing in it can fail, nor in functions of its file
//! or of the tests' helpers that it calls (`assert!` and its family, `panic!`, `unwrap`, `expect`, `?`,
//! `#[should_panic]`). Ignored tests count alike: when they are run, they must look at something.

use std::collections::BTreeMap;

use syn::visit::Visit;

use crate::source::TestFile;

/// An empty test: its file, its name, and the reason.
pub struct Empty {
    pub path: String,
    pub name: String,
    pub what: &'static str,
}

/// The number of tests, and the empty ones.
pub fn find(files: &[TestFile]) -> (usize, Vec<Empty>) {
    let mut functions = Vec::new();
    for file in files {
        let mut collect = Collect { path: &file.path, functions: &mut functions };
        for item in &file.items {
            collect.visit_item(item);
        }
    }
    // Functions are known by name alone, so two of one name count as one: if either can fail, both can.
    let mut fails: BTreeMap<&str, bool> = BTreeMap::new();
    for function in &functions {
        *fails.entry(&function.name).or_default() |= function.fails;
    }
    // Helpers may call helpers. Two levels are the deepest in use; ten rounds cost nothing.
    for _ in 0..10 {
        for function in &functions {
            if function.calls.iter().any(|c| fails.get(c.as_str()).copied().unwrap_or_default()) {
                fails.insert(&function.name, true);
            }
        }
    }
    let tests: Vec<&Function> = functions.iter().filter(|f| f.is_test).collect();
    let empty = tests.iter().filter_map(|test| {
        let what = if test.returns_early {
            "can return early"
        } else if !test.fails && !fails.get(test.name.as_str()).copied().unwrap_or_default() {
            "asserts nothing"
        } else {
            return None;
        };
        Some(Empty { path: test.path.clone(), name: test.name.clone(), what })
    });
    (tests.len(), empty.collect())
}

struct Function {
    path: String,
    name: String,
    is_test: bool,
    fails: bool,
    returns_early: bool,
    calls: Vec<String>,
}

struct Collect<'a> {
    path: &'a str,
    functions: &'a mut Vec<Function>,
}

impl<'ast> Visit<'ast> for Collect<'_> {
    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        let has = |name: &str| item.attrs.iter().any(|a| a.path().is_ident(name));
        let mut body =
            Body { fails: has("should_panic"), returns_early: false, calls: Vec::new(), closures: 0 };
        body.visit_block(&item.block);
        self.functions.push(Function {
            path: self.path.to_owned(),
            name: item.sig.ident.to_string(),
            is_test: has("test"),
            fails: body.fails,
            returns_early: body.returns_early,
            calls: body.calls,
        });
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        // The arguments of `proptest!` cannot be parsed as Rust, so their text is searched: the macro
        // counts as one test.
        if item.path.is_ident("proptest") {
            let text = item.tokens.to_string();
            self.functions.push(Function {
                path: self.path.to_owned(),
                name: "proptest!".to_owned(),
                is_test: true,
                fails: text.contains("assert"),
                returns_early: text.contains("return ;") || text.contains("return;"),
                calls: Vec::new(),
            });
        }
    }
}

struct Body {
    fails: bool,
    returns_early: bool,
    calls: Vec<String>,
    closures: usize,
}

impl<'ast> Visit<'ast> for Body {
    fn visit_expr_closure(&mut self, closure: &'ast syn::ExprClosure) {
        self.closures += 1;
        syn::visit::visit_expr_closure(self, closure);
        self.closures -= 1;
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        // A `return` in an inner function ends that function and not the test.
        self.closures += 1;
        syn::visit::visit_item_fn(self, item);
        self.closures -= 1;
    }

    fn visit_expr_return(&mut self, expr: &'ast syn::ExprReturn) {
        let is_success = match expr.expr.as_deref() {
            None => true,
            Some(syn::Expr::Call(call)) => {
                matches!(&*call.func, syn::Expr::Path(p) if p.path.is_ident("Ok"))
            }
            Some(_) => false,
        };
        self.returns_early |= is_success && self.closures == 0;
        syn::visit::visit_expr_return(self, expr);
    }

    fn visit_expr_try(&mut self, expr: &'ast syn::ExprTry) {
        // `?` ends the test with an error, which fails it; inside a closure the error may be dropped.
        self.fails |= self.closures == 0;
        syn::visit::visit_expr_try(self, expr);
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        let name = call.method.to_string();
        self.fails |=
            // `success` and `failure` are assertions of the command-line tests.
            ["unwrap", "expect", "unwrap_err", "expect_err", "success", "failure"].contains(&name.as_str());
        self.calls.push(name);
        syn::visit::visit_expr_method_call(self, call);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        // All names count as calls: a function passed by name is called elsewhere.
        self.calls.extend(path.segments.last().map(|s| s.ident.to_string()));
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        let name = item.path.segments.last().map(|s| s.ident.to_string()).unwrap_or_default();
        self.fails |= name.contains("assert") || ["panic", "unreachable", "todo"].contains(&name.as_str());
        if let Ok(arguments) =
            item.parse_body_with(syn::punctuated::Punctuated::<syn::Expr, syn::Token![,]>::parse_terminated)
        {
            for argument in &arguments {
                self.visit_expr(argument);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn empty(text: &str) -> Vec<(String, &'static str)> {
        let items = syn::parse_file(text).expect("the test is Rust").items;
        let (_, empty) = find(&[TestFile { path: "a.rs".to_owned(), items }]);
        empty.into_iter().map(|e| (e.name, e.what)).collect()
    }

    #[test]
    fn tests_that_return_early_or_assert_nothing_are_found() {
        let text = "#[test] fn a() { let Some(x) = data() else { return }; assert!(x); }
                    #[test] fn b() { run(); }
                    #[test] fn c() { helper(); }
                    #[test] fn d() { let f = || return; f(); assert_eq!(1, 1); }
                    #[test] #[should_panic] fn e() { run(); }
                    fn helper() { inner() } fn inner() { panic!() }";
        let found = empty(text);
        assert_eq!(found, [("a".to_owned(), "can return early"), ("b".to_owned(), "asserts nothing")]);
    }
}
