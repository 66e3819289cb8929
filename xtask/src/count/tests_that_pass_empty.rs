//! Tests that can pass without having checked anything.
//!
//! A test is *empty* if it can end early without failing (a `return` without a value, or a `return
//! Ok(())`, outside closures). It is also empty if nothing in it can fail, nor in functions of its file
//! or of the tests' helpers that it calls (`assert!` and its family, `panic!`, `unwrap`, `expect`, `?`,
//! `#[should_panic]`). Ignored tests count alike: when they are run, they must look at something.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::TokenTree;
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
    // A name means the functions of that name in the same file. Only where there is none, it means those of other
    // files. Two of one name in one file count as one: if either can fail, both can.
    let mut by_file: BTreeMap<(&str, &str), bool> = BTreeMap::new();
    for function in &functions {
        *by_file.entry((&function.path, &function.name)).or_default() |= function.fails;
    }
    let elsewhere = |by_file: &BTreeMap<(&str, &str), bool>| -> BTreeSet<String> {
        by_file.iter().filter(|(_, fails)| **fails).map(|((_, name), _)| (*name).to_owned()).collect()
    };
    let can_fail =
        |function: &Function, by_file: &BTreeMap<(&str, &str), bool>, others: &BTreeSet<String>| {
            let called = |c: &String| {
                let own = by_file.get(&(function.path.as_str(), c.as_str()));
                own.copied().unwrap_or_else(|| others.contains(c))
            };
            function.fails || function.calls.iter().any(called)
        };
    // Helpers may call helpers. Two levels are the deepest in use; ten rounds cost nothing.
    let mut others = elsewhere(&by_file);
    for _ in 0..10 {
        for function in &functions {
            if can_fail(function, &by_file, &others) {
                by_file.insert((&function.path, &function.name), true);
            }
        }
        others = elsewhere(&by_file);
    }
    let tests: Vec<&Function> = functions.iter().filter(|f| f.is_test).collect();
    let empty = tests.iter().filter_map(|test| {
        let what = if test.returns_early {
            "can return early"
        } else if !can_fail(test, &by_file, &others) {
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
        // `in` makes the arguments of a property invalid Rust, so its name and its body are found among the tokens:
        // `fn name (...) {...}`.
        if item.path.segments.last().is_none_or(|s| s.ident != "proptest") {
            return;
        }
        let tokens: Vec<TokenTree> = item.tokens.clone().into_iter().collect();
        for window in tokens.windows(4) {
            let [
                TokenTree::Ident(keyword),
                TokenTree::Ident(name),
                TokenTree::Group(_),
                TokenTree::Group(body),
            ] = window
            else {
                continue;
            };
            if keyword != "fn" {
                continue;
            }
            let mut seen = Body { fails: false, returns_early: false, calls: Vec::new(), closures: 0 };
            // A body that cannot be parsed counts as one that asserts nothing, so that it is noticed.
            if let Ok(block) = syn::parse2::<syn::Block>(TokenTree::Group(body.clone()).into()) {
                seen.visit_block(&block);
            }
            self.functions.push(Function {
                path: self.path.to_owned(),
                name: name.to_string(),
                is_test: true,
                fails: seen.fails,
                returns_early: seen.returns_early,
                calls: seen.calls,
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
    fn properties_are_read_and_names_are_those_of_their_file() {
        let file = |path: &str, text: &str| {
            let items = syn::parse_file(text).expect("the test is Rust").items;
            TestFile { path: path.to_owned(), items }
        };
        let a = "proptest! { #[test] fn a(x in 0..3, y: bool) { let _ = run(x); }
                             #[test] fn b(x in 0..3) { prop_assert!(run(x)); }
                             #[test] fn c(x in 0..3) { checked(x); } }
                 #[test] fn d() { survive(); }
                 fn survive() { run(); }";
        let b = "fn survive() { panic!() } fn checked() { panic!() }";
        let (n, found) = find(&[file("a.rs", a), file("b.rs", b)]);
        let found: Vec<&str> = found.iter().map(|e| e.name.as_str()).collect();
        assert_eq!((n, found), (4, vec!["a", "d"]));
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
