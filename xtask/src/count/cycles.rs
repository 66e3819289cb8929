//! Dependency cycles between the files of a crate, and between its folders.
//!
//! A file depends on another where it names something that is defined there: by `use`, by `pub use`, or by a path
//! of two or more segments in code, patterns, types or macro arguments. Names are followed through re-exports to
//! the file that defines them, so that a path through a parent's `pub use` depends on the child and not on the
//! parent. `mod name;` is no dependency; tests are left out.
//!
//! A module's own file (`mod.rs`, or `name.rs` beside `name/`) and the files below it belong together:
//! the module names its parts to call them, and the parts name what they share. Arrows between the two
//! are therefore left out, and counted separately as cycles *with parents*.
//!
//! A *file cycle* is a set of two or more files each of which reaches every other (a strongly connected component).
//! A *folder cycle* is the same among the entries of one folder, of which at least one is a folder: files and
//! folders directly in it, where a folder depends on what any file in it or below it depends on.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::Visit;

use crate::source::{self, Source};

/// Dependencies of the files of a crate: pairs of indices into `sources`, from and to.
pub type Arrows = BTreeSet<(usize, usize)>;

/// Dependencies between files of the same crate.
pub fn arrows(sources: &[Source]) -> Arrows {
    let mut arrows = Arrows::new();
    let packages: BTreeSet<&str> = sources.iter().map(|s| s.package.as_str()).collect();
    for package in packages {
        let mut tree = Modules::default();
        // All modules are declared before any name is resolved, since a file may name one that comes
        // later.
        for (file, source) in sources.iter().enumerate().filter(|(_, s)| s.package == package) {
            let module = tree.module(&source.module);
            tree.nodes[module].file = Some(file);
            tree.declare(module, &source.items);
        }
        for (file, source) in sources.iter().enumerate().filter(|(_, s)| s.package == package) {
            let module = tree.module(&source.module);
            let mut names = Names { tree: &mut tree, module, found: BTreeSet::new() };
            for item in &source.items {
                names.visit_item(item);
            }
            let found = names.found;
            arrows.extend(found.into_iter().filter(|to| *to != file).map(|to| (file, to)));
        }
    }
    arrows
}

/// Dependencies without those between a module's own file and the files below it.
pub fn without_parents(sources: &[Source], arrows: &Arrows) -> Arrows {
    let is_below = |file: usize, parent: usize| {
        let (file, parent) = (&sources[file].module, &sources[parent].module);
        file.len() > parent.len() && file.starts_with(parent)
    };
    arrows.iter().copied().filter(|&(from, to)| !is_below(from, to) && !is_below(to, from)).collect()
}

/// Cycles of files, each as the sorted paths of its files.
pub fn of_files(sources: &[Source], arrows: &Arrows) -> Vec<Vec<String>> {
    let paths = |files: &Vec<usize>| files.iter().map(|f| sources[*f].path.clone()).collect();
    components(sources.len(), arrows).iter().map(paths).collect()
}

/// Cycles of folders, each as the sorted entries of the folder they share.
pub fn of_folders(sources: &[Source], arrows: &Arrows) -> Vec<Vec<String>> {
    let places: Vec<Vec<String>> = sources.iter().map(|s| place(s, sources)).collect();
    type Place = Vec<String>;
    let mut by_folder: BTreeMap<Place, BTreeSet<(Place, Place)>> = BTreeMap::new();
    for (from, to) in arrows {
        let (from, to) = (&places[*from], &places[*to]);
        // The two entries of a folder that the arrow joins are the first names in which the paths differ.
        let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        // Within one entry there is nothing to compare at this level.
        if shared < from.len() && shared < to.len() {
            let pair = (from[..=shared].to_vec(), to[..=shared].to_vec());
            by_folder.entry(from[..shared].to_vec()).or_default().insert(pair);
        }
    }
    let mut cycles = Vec::new();
    for pairs in by_folder.values() {
        let entries: BTreeSet<&Vec<String>> = pairs.iter().flat_map(|(a, b)| [a, b]).collect();
        let entries: Vec<&Vec<String>> = entries.into_iter().collect();
        let index = |entry: &Vec<String>| entries.iter().position(|e| *e == entry).unwrap_or_default();
        let inner: Arrows = pairs.iter().map(|(a, b)| (index(a), index(b))).collect();
        for cycle in components(entries.len(), &inner) {
            let is_folder = |entry: &usize| !entries[*entry].last().is_some_and(|n| n.ends_with(".rs"));
            // A cycle of files alone is counted as a file cycle already.
            if cycle.iter().any(is_folder) {
                cycles.push(cycle.iter().map(|e| entries[*e].join("/")).collect());
            }
        }
    }
    cycles
}

/// Pairs of top modules of a crate of which the first names the second, although `lib.rs` declares the
/// second before it. In `lib.rs` modules are declared from the whole down to what it calls.
pub fn upwards(sources: &[Source], arrows: &Arrows, package: &str) -> Vec<String> {
    let Some(root) = sources.iter().find(|s| s.package == package && s.module.is_empty()) else {
        return Vec::new();
    };
    let declared: Vec<String> = root
        .items
        .iter()
        .filter_map(|item| match item {
            syn::Item::Mod(module) => Some(module.ident.to_string()),
            _ => None,
        })
        .collect();
    let rank = |file: usize| {
        let top = sources[file].module.first().filter(|_| sources[file].package == package)?;
        declared.iter().position(|name| name == top)
    };
    let upwards =
        |&(from, to): &(usize, usize)| Some((rank(from)?, rank(to)?)).filter(|(from, to)| from > to);
    let pairs: BTreeSet<(usize, usize)> = arrows.iter().filter_map(upwards).collect();
    pairs.into_iter().map(|(from, to)| format!("{} names {}", declared[from], declared[to])).collect()
}

/// The folders of a file and its name. The own file of a module with child files is `mod.rs` in its
/// folder.
fn place(source: &Source, sources: &[Source]) -> Vec<String> {
    let mut place: Vec<String> = vec![source.package.clone()];
    place.extend(source.module.iter().cloned());
    let is_child = |other: &Source| {
        other.package == source.package
            && other.module.len() > source.module.len()
            && other.module.starts_with(&source.module)
    };
    if source.module.is_empty() || sources.iter().any(is_child) {
        place.push("mod.rs".to_owned());
    } else if let Some(last) = place.last_mut() {
        last.push_str(".rs");
    }
    place
}

/// The modules of a crate, inline ones too.
#[derive(Default)]
struct Modules {
    nodes: Vec<Module>,
}

#[derive(Default)]
struct Module {
    parent: usize,
    file: Option<usize>,
    children: BTreeMap<String, usize>,
    items: BTreeSet<String>,
    /// Names that `use` brings in, with the path of each.
    uses: Vec<(String, Vec<String>)>,
    /// Paths before `::*`.
    globs: Vec<Vec<String>>,
}

impl Modules {
    fn module(&mut self, path: &[String]) -> usize {
        if self.nodes.is_empty() {
            self.nodes.push(Module::default());
        }
        path.iter().fold(0, |module, name| self.child(module, name))
    }

    fn child(&mut self, module: usize, name: &str) -> usize {
        if let Some(child) = self.nodes[module].children.get(name) {
            return *child;
        }
        let child = self.nodes.len();
        self.nodes.push(Module { parent: module, ..Module::default() });
        self.nodes[module].children.insert(name.to_owned(), child);
        child
    }

    /// Notes the names that items define in a module.
    fn declare(&mut self, module: usize, items: &[syn::Item]) {
        for item in items {
            let name = match item {
                syn::Item::Const(i) => i.ident.to_string(),
                syn::Item::Enum(i) => i.ident.to_string(),
                syn::Item::Fn(i) => i.sig.ident.to_string(),
                syn::Item::Static(i) => i.ident.to_string(),
                syn::Item::Struct(i) => i.ident.to_string(),
                syn::Item::Trait(i) => i.ident.to_string(),
                syn::Item::Type(i) => i.ident.to_string(),
                syn::Item::Union(i) => i.ident.to_string(),
                // A macro may define items that only its expansion shows; the names in its arguments are
                // a good guess.
                syn::Item::Macro(i) => {
                    defined_in_macro(i.mac.tokens.clone(), &mut self.nodes[module].items);
                    continue;
                }
                syn::Item::Use(i) if !source::is_for_tests(&i.attrs) => {
                    for (name, path) in flat(&i.tree) {
                        match name.as_str() {
                            "*" => self.nodes[module].globs.push(path),
                            _ => self.nodes[module].uses.push((name, path)),
                        }
                    }
                    continue;
                }
                syn::Item::Mod(i) if !source::is_for_tests(&i.attrs) => {
                    let child = self.child(module, &i.ident.to_string());
                    if let Some((_, items)) = &i.content {
                        // An inline module has no file of its own.
                        self.nodes[child].file = self.nodes[module].file;
                        self.declare(child, items);
                    }
                    continue;
                }
                _ => continue,
            };
            self.nodes[module].items.insert(name);
        }
    }

    /// The file that defines what a path names, seen from a module; `None` for names of other crates.
    fn file(&self, module: usize, path: &[String], depth: usize) -> Option<usize> {
        let (first, mut rest) = path.split_first()?;
        let mut here = match first.as_str() {
            "crate" => 0,
            "self" => module,
            "super" => self.nodes[module].parent,
            // A path of one segment is an item of this file or a local name.
            name if rest.is_empty() => return self.item(module, name, depth),
            name => match self.nodes[module].children.get(name) {
                Some(child) => *child,
                None => return self.through_use(module, name, rest, depth),
            },
        };
        while let Some((name, after)) = rest.split_first() {
            if name == "super" {
                here = self.nodes[here].parent;
            } else if let Some(child) = self.nodes[here].children.get(name) {
                here = *child;
            } else {
                return self
                    .through_use(here, name, after, depth)
                    .or_else(|| self.item(here, name, depth))
                    .or(self.nodes[here].file);
            }
            rest = after;
        }
        self.nodes[here].file
    }

    /// Follows a name that `use` brought into a module.
    fn through_use(&self, module: usize, name: &str, rest: &[String], depth: usize) -> Option<usize> {
        // Re-exports can form a circle; eight steps are more than any honest path takes.
        if depth > 8 {
            return None;
        }
        if self.nodes[module].items.contains(name) {
            return self.nodes[module].file;
        }
        let (_, path) = self.nodes[module].uses.iter().find(|(n, _)| n == name)?;
        let whole: Vec<String> = path.iter().chain(rest).cloned().collect();
        self.file(module, &whole, depth + 1)
    }

    /// The file of an item that a module defines, or re-exports by name or by `*`.
    fn item(&self, module: usize, name: &str, depth: usize) -> Option<usize> {
        if depth > 8 {
            return None;
        }
        let node = &self.nodes[module];
        if node.items.contains(name) {
            return node.file;
        }
        if let Some((_, path)) = node.uses.iter().find(|(n, _)| n == name) {
            return self.file(module, path, depth + 1);
        }
        // Globs come last, as in the language: names that are declared or imported by name hide them.
        node.globs.iter().find_map(|glob| {
            let module = self.path_module(module, glob)?;
            self.item(module, name, depth + 1)
        })
    }

    /// The module that a path names.
    fn path_module(&self, module: usize, path: &[String]) -> Option<usize> {
        path.iter().enumerate().try_fold(module, |here, (index, name)| match name.as_str() {
            "crate" if index == 0 => Some(0),
            "self" => Some(here),
            "super" => Some(self.nodes[here].parent),
            name => self.nodes[here].children.get(name).copied(),
        })
    }
}

/// Names that a `use` brings in, each with its path; `*` is a name here.
fn flat(tree: &syn::UseTree) -> Vec<(String, Vec<String>)> {
    let before = |name: &syn::Ident, inner: Vec<(String, Vec<String>)>| {
        let put = |(alias, path): (String, Vec<String>)| {
            (alias, std::iter::once(name.to_string()).chain(path).collect())
        };
        inner.into_iter().map(put).collect()
    };
    match tree {
        syn::UseTree::Path(path) => before(&path.ident, flat(&path.tree)),
        // `use a::{self}` names a.
        syn::UseTree::Name(name) if name.ident == "self" => vec![("self".to_owned(), Vec::new())],
        syn::UseTree::Name(name) => vec![(name.ident.to_string(), vec![name.ident.to_string()])],
        syn::UseTree::Rename(name) if name.ident == "self" => vec![(name.rename.to_string(), Vec::new())],
        syn::UseTree::Rename(name) => vec![(name.rename.to_string(), vec![name.ident.to_string()])],
        syn::UseTree::Glob(_) => vec![("*".to_owned(), Vec::new())],
        syn::UseTree::Group(group) => group.items.iter().flat_map(flat).collect(),
    }
    .into_iter()
    .map(|(alias, path): (String, Vec<String>)| match alias.as_str() {
        "self" => (path.last().cloned().unwrap_or(alias), path),
        _ => (alias, path),
    })
    .collect()
}

/// Names after `struct`, `enum`, `const`, `type` and `fn` in the arguments of a macro.
fn defined_in_macro(tokens: TokenStream, items: &mut BTreeSet<String>) {
    let mut defines = false;
    for tree in tokens {
        match tree {
            TokenTree::Ident(name) if defines => {
                items.insert(name.to_string());
                defines = false;
            }
            TokenTree::Ident(name) => {
                defines = ["struct", "enum", "const", "type", "fn"].contains(&name.to_string().as_str());
            }
            TokenTree::Group(group) => {
                defines = false;
                defined_in_macro(group.stream(), items);
            }
            _ => defines = false,
        }
    }
}

/// Collects the files of all paths in a file.
struct Names<'a> {
    tree: &'a mut Modules,
    module: usize,
    found: BTreeSet<usize>,
}

impl Names<'_> {
    fn path(&mut self, path: &[String]) {
        self.found.extend(self.tree.file(self.module, path, 0));
    }

    /// Paths of two or more segments in the arguments of a macro.
    fn tokens(&mut self, tokens: TokenStream) {
        let (mut path, mut colons) = (Vec::new(), 0);
        for tree in tokens {
            match tree {
                TokenTree::Ident(name) => {
                    // Only `::` joins two names; anything else starts a new path.
                    if colons != 2 {
                        self.finish(&mut path);
                    }
                    path.push(name.to_string());
                    colons = 0;
                }
                TokenTree::Punct(p) if p.as_char() == ':' && !path.is_empty() => colons += 1,
                TokenTree::Group(group) => {
                    self.finish(&mut path);
                    colons = 0;
                    self.tokens(group.stream());
                }
                _ => {
                    self.finish(&mut path);
                    colons = 0;
                }
            }
        }
        self.finish(&mut path);
    }

    fn finish(&mut self, path: &mut Vec<String>) {
        // One name alone may be a variable.
        if path.len() > 1 {
            self.path(path);
        }
        path.clear();
    }
}

impl<'ast> Visit<'ast> for Names<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !source::is_for_tests(source::attributes(item)) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if item.content.is_some() {
            let outside = self.module;
            self.module = self.tree.child(outside, &item.ident.to_string());
            syn::visit::visit_item_mod(self, item);
            self.module = outside;
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        for (_, path) in flat(&item.tree) {
            self.path(&path);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.segments.len() > 1 {
            let names: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
            self.path(&names);
        }
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        self.tokens(item.tokens.clone());
    }

    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {
        // `pub(in crate::shape)` limits who may use a name and uses nothing itself.
    }
}

/// Strongly connected components of two or more nodes, sorted. Source: Tarjan, Depth-first search and
/// linear graph algorithms, 1972.
fn components(n_nodes: usize, arrows: &Arrows) -> Vec<Vec<usize>> {
    struct State<'a> {
        next: &'a [Vec<usize>],
        order: Vec<Option<usize>>,
        low: Vec<usize>,
        on_stack: Vec<bool>,
        stack: Vec<usize>,
        n_seen: usize,
        found: Vec<Vec<usize>>,
    }
    fn visit(s: &mut State<'_>, node: usize) {
        s.order[node] = Some(s.n_seen);
        s.low[node] = s.n_seen;
        s.n_seen += 1;
        s.stack.push(node);
        s.on_stack[node] = true;
        for &next in &s.next[node] {
            match s.order[next] {
                None => {
                    visit(s, next);
                    s.low[node] = s.low[node].min(s.low[next]);
                }
                // Nodes that left the stack belong to a component found before, and do not join this one.
                Some(order) if s.on_stack[next] => s.low[node] = s.low[node].min(order),
                Some(_) => {}
            }
        }
        // A node that reaches nothing older than itself is the root of its component, which lies above it
        // on the stack.
        if s.order[node] == Some(s.low[node]) {
            let mut component = Vec::new();
            while let Some(last) = s.stack.pop() {
                s.on_stack[last] = false;
                component.push(last);
                if last == node {
                    break;
                }
            }
            if component.len() > 1 {
                component.sort_unstable();
                s.found.push(component);
            }
        }
    }
    let mut next = vec![Vec::new(); n_nodes];
    for (from, to) in arrows {
        if from != to {
            next[*from].push(*to);
        }
    }
    let mut state = State {
        next: &next,
        order: vec![None; n_nodes],
        low: vec![0; n_nodes],
        on_stack: vec![false; n_nodes],
        stack: Vec::new(),
        n_seen: 0,
        found: Vec::new(),
    };
    for node in 0..n_nodes {
        if state.order[node].is_none() {
            visit(&mut state, node);
        }
    }
    state.found.sort();
    state.found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(module: &str, text: &str) -> Source {
        let module: Vec<String> = module.split("::").filter(|m| !m.is_empty()).map(str::to_owned).collect();
        let file = syn::parse_file(text).expect("the test is Rust");
        Source {
            package: "p".to_owned(),
            path: module.join("/"),
            module,
            items: file.items,
            attrs: file.attrs,
            lines: Vec::new(),
            text: Vec::new(),
        }
    }

    #[test]
    fn names_are_followed_through_re_exports_to_the_file_that_defines_them() {
        let sources = [
            source("", "mod a; mod b;"),
            source("a", "mod x; mod y; pub use x::X;"),
            source("a::x", "pub struct X;"),
            source("a::y", "use super::X; fn f(_: X) {}"),
            source("b", "fn f() { let _ = crate::a::X; }"),
        ];
        assert_eq!(arrows(&sources), Arrows::from([(1, 2), (3, 2), (4, 2)]));
        assert!(of_files(&sources, &arrows(&sources)).is_empty());
    }

    #[test]
    fn full_paths_macro_arguments_and_pub_use_close_cycles() {
        for back in [
            "fn f() { crate::a::g() }",
            "fn f() { println!(\"{}\", super::a::g()) }",
            "pub use crate::a::g;",
            "fn f() { use crate::a; a::g() }",
        ] {
            let sources = [
                source("", "mod a; mod b;"),
                source("a", "use crate::b::f; pub fn g() {}"),
                source("b", &format!("pub struct S; {back}")),
            ];
            assert_eq!(of_files(&sources, &arrows(&sources)).len(), 1, "{back}");
        }
    }

    #[test]
    fn a_module_that_names_one_above_it_is_found() {
        let sources = [
            source("", "mod a; mod b;"),
            source("a", "use crate::b::f; pub fn g() {}"),
            source("b", "use crate::a::g; pub fn f() {}"),
        ];
        assert_eq!(upwards(&sources, &arrows(&sources), "p"), ["b names a"]);
    }

    #[test]
    fn tests_close_no_cycle() {
        let back = "#[cfg(test)] mod tests { use crate::a::g; } pub fn f() {}";
        let sources = [source("", ""), source("a", "use crate::b::f; pub fn g() {}"), source("b", back)];
        assert!(of_files(&sources, &arrows(&sources)).is_empty());
    }

    #[test]
    fn folders_form_cycles_that_no_file_forms() {
        let sources = [
            source("", ""),
            source("a", ""),
            source("a::one", "use crate::b::one::B;"),
            source("a::two", "pub struct A;"),
            source("b", ""),
            source("b::one", "pub struct B;"),
            source("b::two", "use crate::a::two::A;"),
        ];
        let arrows = arrows(&sources);
        assert!(of_files(&sources, &arrows).is_empty());
        assert_eq!(of_folders(&sources, &arrows), [["p/a", "p/b"]]);
    }
}
