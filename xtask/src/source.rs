//! The sources of our crates as data: the files, which of them are tests, and the class of each line.
//!
//! Files are found as the compiler finds them: from `src/lib.rs` and `src/main.rs` along `mod name;`. What stands
//! below `#[cfg(test)]` is a test, whether inline or in a file of its own. Lines are classed by the tokens on them:
//! a line is *code* if a token other than a doc comment touches it, *doc* if only doc comments do, *blank* if it
//! holds white space only, and *comment* otherwise.

use std::collections::BTreeMap;
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syn::spanned::Spanned;

/// The class of a line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Line {
    Blank,
    Code,
    Comment,
    Doc,
}

/// A source file of one of our crates, without its inline tests.
pub struct Source {
    /// Name of the crate's folder below `crates/`.
    pub package: String,
    /// Path below the repository's top folder, with `/` on every system.
    pub path: String,
    /// The module's path in its crate; empty for the root.
    pub module: Vec<String>,
    /// Everything in the file but what is `#[cfg(test)]`.
    pub items: Vec<syn::Item>,
    /// Inner attributes, among them the module's text.
    pub attrs: Vec<syn::Attribute>,
    /// The class of each line; `None` for lines of inline tests.
    pub lines: Vec<Option<Line>>,
    /// The text of each line.
    pub text: Vec<String>,
}

impl Source {
    /// Number of lines of production code of a class.
    pub fn count(&self, class: Line) -> usize {
        self.lines.iter().filter(|l| **l == Some(class)).count()
    }
}

/// A file with tests: from a crate's `tests/`, or from `src/` below `#[cfg(test)]`.
pub struct TestFile {
    /// Path below the repository's top folder.
    pub path: String,
    pub items: Vec<syn::Item>,
}

/// All of our crates in a repository, whose top folder holds `crates/`.
#[derive(Default)]
pub struct Workspace {
    pub sources: Vec<Source>,
    pub tests: Vec<TestFile>,
    /// Lines of each crate's Rust files that are not blank, tests and examples too.
    pub lines: BTreeMap<String, usize>,
}

/// Reads every crate below `root/crates`.
pub fn read(root: &Path) -> Result<Workspace, String> {
    let mut workspace = Workspace::default();
    for package in folders(&root.join("crates"))? {
        let name = file_name(&package);
        let mut n_lines = 0;
        for path in rust_files(&package)? {
            let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
            // Test files count too: the share of a crate is a measure of how much there is to read.
            n_lines += text.lines().filter(|l| !l.trim().is_empty()).count();
        }
        workspace.lines.insert(name.clone(), n_lines);
        for top in ["lib.rs", "main.rs"] {
            let path = package.join("src").join(top);
            if path.exists() {
                // A binary names its modules from a root of its own; without a prefix they would mix with
                // those of the library.
                let module = if top == "main.rs" && package.join("src/lib.rs").exists() {
                    vec!["main".to_owned()]
                } else {
                    Vec::new()
                };
                workspace.file(root, &name, &path, module, false)?;
            }
        }
        let tests = package.join("tests");
        if tests.exists() {
            for path in rust_files(&tests)? {
                let file = parse(&path)?;
                workspace.tests.push(TestFile { path: below(root, &path), items: file.items });
            }
        }
    }
    Ok(workspace)
}

impl Workspace {
    fn file(
        &mut self,
        root: &Path,
        package: &str,
        path: &Path,
        module: Vec<String>,
        is_test: bool,
    ) -> Result<(), String> {
        let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let file = syn::parse_file(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        let mut lines: Vec<Option<Line>> = classes(&text).into_iter().map(Some).collect();
        let folder = folder_of_modules(path);
        let (mut items, mut tests) = (Vec::new(), Vec::new());
        self.children(root, package, &folder, &module, &file.items, is_test)?;
        for item in file.items {
            if is_test {
                tests.push(item);
            } else if is_for_tests(attributes(&item)) {
                // Lines of inline tests belong to no class, so that neither their code nor their comments
                // change the densities.
                for line in lines_of(&item) {
                    if let Some(class) = lines.get_mut(line - 1) {
                        *class = None;
                    }
                }
                tests.push(item);
            } else {
                items.push(item);
            }
        }
        if !tests.is_empty() {
            self.tests.push(TestFile { path: below(root, path), items: tests });
        }
        if !is_test {
            self.sources.push(Source {
                package: package.to_owned(),
                path: below(root, path),
                module,
                items,
                attrs: file.attrs,
                lines,
                text: text.lines().map(str::to_owned).collect(),
            });
        }
        Ok(())
    }

    /// Reads the files of `mod name;` among `items`.
    fn children(
        &mut self,
        root: &Path,
        package: &str,
        folder: &Path,
        module: &[String],
        items: &[syn::Item],
        is_test: bool,
    ) -> Result<(), String> {
        for item in items {
            let syn::Item::Mod(child) = item else { continue };
            let is_test = is_test || is_for_tests(&child.attrs);
            // A file in another folder, which tests of several crates share.
            if child.attrs.iter().any(|attr| attr.path().is_ident("path")) {
                continue;
            }
            let name = child.ident.to_string();
            let mut path = module.to_vec();
            path.push(name.clone());
            if let Some((_, inner)) = &child.content {
                self.children(root, package, &folder.join(&name), &path, inner, is_test)?;
                continue;
            }
            let files = [folder.join(format!("{name}.rs")), folder.join(&name).join("mod.rs")];
            let Some(file) = files.iter().find(|f| f.exists()) else {
                return Err(format!("no file of the module {name} in {}", folder.display()));
            };
            self.file(root, package, file, path, is_test)?;
        }
        Ok(())
    }
}

/// The folder in which the child modules of a file lie.
fn folder_of_modules(path: &Path) -> PathBuf {
    let folder = path.parent().unwrap_or(Path::new(""));
    match path.file_stem().and_then(|s| s.to_str()) {
        Some("lib" | "main" | "mod") | None => folder.to_owned(),
        Some(stem) => folder.join(stem),
    }
}

fn parse(path: &Path) -> Result<syn::File, String> {
    let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    syn::parse_file(&text).map_err(|e| format!("{}: {e}", path.display()))
}

/// The class of each line of a Rust text.
pub fn classes(text: &str) -> Vec<Line> {
    // Comments leave no tokens, so each line counts as one until a token is found on it.
    let mut lines: Vec<Line> =
        text.lines().map(|l| if l.trim().is_empty() { Line::Blank } else { Line::Comment }).collect();
    if let Ok(tokens) = text.parse::<TokenStream>() {
        mark(tokens, &mut lines);
    }
    lines
}

fn mark(tokens: TokenStream, lines: &mut [Line]) {
    let mut put = |span: proc_macro2::Span, class: Line| {
        for line in span.start().line..=span.end().line {
            if let Some(seen) = lines.get_mut(line.wrapping_sub(1)) {
                // A line with code and a doc comment after it is code.
                *seen = if *seen == Line::Code { Line::Code } else { class };
            }
        }
    };
    let trees: Vec<TokenTree> = tokens.into_iter().collect();
    let mut groups = Vec::new();
    let mut index = 0;
    while let Some(tree) = trees.get(index) {
        let length = doc_length(&trees[index..]);
        if length > 0 {
            put(tree.span(), Line::Doc);
            index += length;
            continue;
        }
        match tree {
            TokenTree::Group(group) => {
                put(group.span_open(), Line::Code);
                put(group.span_close(), Line::Code);
                groups.push(group.stream());
            }
            other => put(other.span(), Line::Code),
        }
        index += 1;
    }
    for group in groups {
        mark(group, lines);
    }
}

/// Number of tokens at the front that form one doc comment: `#`, a `!` for inner ones, and `[doc = ...]`;
/// 0 for other tokens. The tokeniser turns doc comments into this form.
fn doc_length(trees: &[TokenTree]) -> usize {
    let is =
        |tree: Option<&TokenTree>, c: char| matches!(tree, Some(TokenTree::Punct(p)) if p.as_char() == c);
    if !is(trees.first(), '#') {
        return 0;
    }
    let bracket = if is(trees.get(1), '!') { 2 } else { 1 };
    match trees.get(bracket) {
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Bracket => {
            let mut inner = group.stream().into_iter();
            let is_doc = matches!(inner.next(), Some(TokenTree::Ident(name)) if name == "doc")
                && is(inner.next().as_ref(), '=');
            if is_doc { bracket + 1 } else { 0 }
        }
        _ => 0,
    }
}

/// Whether `#[cfg(test)]` or `#[test]` stands among the attributes.
pub fn is_for_tests(attrs: &[syn::Attribute]) -> bool {
    attrs.iter().any(|attr| {
        let is_cfg_test = attr.path().is_ident("cfg")
            && matches!(&attr.meta, syn::Meta::List(list) if list.tokens.to_string() == "test");
        is_cfg_test || attr.path().is_ident("test")
    })
}

/// The attributes of any item.
pub fn attributes(item: &syn::Item) -> &[syn::Attribute] {
    match item {
        syn::Item::Const(i) => &i.attrs,
        syn::Item::Enum(i) => &i.attrs,
        syn::Item::ExternCrate(i) => &i.attrs,
        syn::Item::Fn(i) => &i.attrs,
        syn::Item::ForeignMod(i) => &i.attrs,
        syn::Item::Impl(i) => &i.attrs,
        syn::Item::Macro(i) => &i.attrs,
        syn::Item::Mod(i) => &i.attrs,
        syn::Item::Static(i) => &i.attrs,
        syn::Item::Struct(i) => &i.attrs,
        syn::Item::Trait(i) => &i.attrs,
        syn::Item::TraitAlias(i) => &i.attrs,
        syn::Item::Type(i) => &i.attrs,
        syn::Item::Union(i) => &i.attrs,
        syn::Item::Use(i) => &i.attrs,
        // `syn` may add kinds of items, so its enum cannot be matched whole.
        _ => &[],
    }
}

/// The text of doc comments among attributes, a string for each line.
pub fn doc_text(attrs: &[syn::Attribute]) -> Vec<String> {
    let text = |attr: &syn::Attribute| match &attr.meta {
        syn::Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => Some(text.value()),
            _ => None,
        },
        _ => None,
    };
    attrs.iter().filter_map(text).flat_map(|t| t.lines().map(str::to_owned).collect::<Vec<_>>()).collect()
}

/// The lines that an item stands on, counted from 1.
fn lines_of(item: &syn::Item) -> RangeInclusive<usize> {
    item.span().start().line..=item.span().end().line
}

fn below(root: &Path, path: &Path) -> String {
    path.strip_prefix(root).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Folders in a folder, by name.
fn folders(path: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut folders: Vec<PathBuf> = entries.flatten().map(|e| e.path()).filter(|p| p.is_dir()).collect();
    // The order of a directory differs between file systems; lists must not.
    folders.sort();
    Ok(folders)
}

/// Every `.rs` file below a folder, by name.
pub fn rust_files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for path in entries.flatten().map(|e| e.path()) {
        if path.is_dir() {
            files.extend(rust_files(&path)?);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_classed_by_what_stands_on_them() {
        let text = "//! Text.\n\n// Why.\nfn f() { // after code\n    /* two\n       lines */\n    \
                    let s = \"a\n// in a string\";\n}\n#[doc = \"x\"]\nstruct S;\n";
        use Line::{Blank, Code, Comment, Doc};
        assert_eq!(classes(text), [Doc, Blank, Comment, Code, Comment, Comment, Code, Code, Code, Doc, Code]);
    }
}
