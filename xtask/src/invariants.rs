//! The rules that `ARCHITECTURE.md` calls *Invariants*, each checked on the syntax tree of our sources.
//!
//! Every point of that page's list ends in "Held by `path`: `function`." where the path is this file, another file
//! of `xtask`, or a test of a crate; [`check`] fails where a point names nothing, or a function that is not there.
//! The rules are lexical: they know names and not types. Tests may do what they like.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::visit::Visit;

use crate::source::{self, Source};

/// Crates that compute with what they are given. `grainpath-io` opens the files of scans, whose slices
/// are read one by one; `grainpath-cli` opens all other files.
const OPENS_NO_FILE: [&str; 8] = [
    "grainpath",
    "grainpath-core",
    "grainpath-fea",
    "grainpath-gcode",
    "grainpath-imaging",
    "grainpath-job",
    "grainpath-parts",
    "grainpath-view",
];

/// A crate from outside, and the modules that may name it: package and path of the module.
const KEPT_IN: [(&str, &[(&str, &str)]); 5] = [
    ("i_overlay", &[("grainpath-core", "poly")]),
    ("clipper2_rust", &[("grainpath-core", "poly")]),
    ("spade", &[("grainpath-core", "triangulation"), ("grainpath-core", "medial")]),
    ("amd", &[("grainpath-fea", "sparse")]),
    ("multiversion", &[("grainpath-core", "lanes"), ("grainpath-fea", "dense_elimination")]),
];

/// Names of files of several folders, and what all of them hold. Any other name stands once.
const SAME_IN_EACH: [(&str, &str); 23] = [
    ("codec", "a file format's compressions"),
    ("error", "a library's errors"),
    ("field", "a field of directions"),
    ("files", "opening files"),
    ("grain", "the grain of wood: its directions, and a picture of them"),
    ("image", "grey values of a photograph"),
    ("markers", "the marker sheet, and the command that prints it"),
    ("memory", "memory that a run takes"),
    ("model", "what all readers of a folder return"),
    ("nodal_forces", "forces at nodes: of a load, and of a deck"),
    ("number", "numbers as text"),
    ("orient", "poses of a part, and the command that ranks them"),
    ("profiles", "profiles, and the command that lists them"),
    ("program", "a G-code program"),
    ("read", "a folder's reader"),
    ("schema", "the schema of jobs, and the command that prints it"),
    ("specimen", "test specimens, and the command that writes them"),
    ("streamlines", "streamlines, and the fill of them"),
    ("strength", "the strength test: its command, Python function and picture"),
    ("studio", "the studio, and the command that serves it"),
    ("support", "pictures of supports, and the command that grows them"),
    ("svg", "an SVG file, read or written"),
    ("write", "a folder's writer"),
];

/// Endings of names of lengths, angles, stresses and the like, which are floats.
const UNITS: [&str; 12] =
    ["_mm", "_mm2", "_mm3", "_mm_s", "_mm_s2", "_um", "_rad", "_deg", "_mpa", "_nmm", "_g", "_s"];

/// Functions of the system's library, whose last bits differ between platforms.
const PLATFORM_MATHS: [&str; 12] =
    ["sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "hypot", "exp", "ln", "powf"];

/// Checks every rule and the page that states them.
pub fn check() -> Result<(), String> {
    let workspace = source::read(&crate::root())?;
    let sources = &workspace.sources;
    let mut broken = Vec::new();
    broken.extend(outside_crates_stay_where_they_are_wrapped(sources));
    broken.extend(only_front_ends_open_files(sources));
    broken.extend(only_diagnostics_read_the_clock(sources));
    broken.extend(no_length_is_an_integer(sources));
    broken.extend(a_file_name_means_one_thing(sources));
    broken.extend(platform_maths_and_hash_order_are_banned()?);
    broken.extend(points_name_what_holds_them()?);
    if broken.is_empty() {
        println!("{} files keep the invariants of ARCHITECTURE.md", sources.len());
        return Ok(());
    }
    Err(broken.join("\n       "))
}

/// A clipping, triangulation or linear-algebra crate is named in the module that wraps it and nowhere else.
fn outside_crates_stay_where_they_are_wrapped(sources: &[Source]) -> Vec<String> {
    let mut broken = Vec::new();
    for source in sources {
        let module = source.module.join("::");
        for (name, line) in first_names(source) {
            let Some((_, places)) = KEPT_IN.iter().find(|(kept, _)| *kept == name) else { continue };
            let is_allowed = |&(package, top): &(&str, &str)| {
                // A module and the modules below it may name the crate.
                source.package == package && (module == top || module.starts_with(&format!("{top}::")))
            };
            if !places.iter().any(is_allowed) {
                broken.push(format!("{}:{line} names {name}, which {places:?} wrap", source.path));
            }
        }
    }
    broken
}

/// Only the readers touch files, processes, sockets or the environment.
fn only_front_ends_open_files(sources: &[Source]) -> Vec<String> {
    let system = [["std", "fs"], ["std", "net"], ["std", "process"], ["std", "env"]];
    let mut broken = Vec::new();
    // One module draws the failing region of a test into a file; no other code calls it.
    let draws_for_tests = |s: &Source| s.module == ["failure_svg"];
    let libraries = sources.iter().filter(|s| OPENS_NO_FILE.contains(&s.package.as_str()));
    for source in libraries.filter(|s| !draws_for_tests(s)) {
        for (path, line) in paths(source) {
            if system.iter().any(|s| path.starts_with(&s.map(str::to_owned))) {
                broken.push(format!("{}:{line} names {}", source.path, path.join("::")));
            }
        }
    }
    broken
}

/// A file's name stands in one folder, unless [`SAME_IN_EACH`] says what the files of that name have in common.
fn a_file_name_means_one_thing(sources: &[Source]) -> Vec<String> {
    let mut named: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for source in sources.iter().filter(|s| s.path.starts_with("crates/")) {
        let name = source.path.rsplit('/').next().and_then(|file| file.strip_suffix(".rs"));
        let Some(name) = name.filter(|n| !["lib", "main", "mod", "tests"].contains(n)) else { continue };
        named.entry(name).or_default().push(&source.path);
    }
    let twice = |name: &str| named.get(name).is_some_and(|paths| paths.len() > 1);
    let is_listed = |name: &str| SAME_IN_EACH.iter().any(|(listed, _)| *listed == name);
    let mut broken: Vec<String> = Vec::new();
    for (name, paths) in named.iter().filter(|(name, _)| twice(name) && !is_listed(name)) {
        broken.push(format!("{name}.rs means two things: {}", paths.join(", ")));
    }
    let once = SAME_IN_EACH.iter().filter(|(name, _)| !twice(name));
    broken.extend(once.map(|(name, _)| format!("{name}.rs stands once and needs no line in SAME_IN_EACH")));
    broken
}

/// The libraries take the time from `Diagnostics`, to which a front end may hand a clock: WebAssembly has none.
fn only_diagnostics_read_the_clock(sources: &[Source]) -> Vec<String> {
    let clocks = [["std", "time", "Instant"], ["std", "time", "SystemTime"]];
    let mut broken = Vec::new();
    let holds_it = |s: &Source| s.package == "grainpath-core" && s.module == ["diagnostics"];
    let libraries = sources.iter().filter(|s| OPENS_NO_FILE.contains(&s.package.as_str()));
    for source in libraries.filter(|s| !holds_it(s)) {
        for (path, line) in paths(source) {
            if clocks.iter().any(|clock| path.starts_with(&clock.map(str::to_owned))) {
                broken.push(format!("{}:{line} names {}", source.path, path.join("::")));
            }
        }
    }
    broken
}

/// Arguments of public functions and fields of public types whose names end in a unit are floats.
fn no_length_is_an_integer(sources: &[Source]) -> Vec<String> {
    let mut broken = Vec::new();
    for source in sources {
        let mut look = Signatures { path: &source.path, broken: &mut broken };
        for item in &source.items {
            look.visit_item(item);
        }
    }
    broken
}

/// `clippy.toml` and the workspace's lints ban what gives other bytes on other machines, in every crate.
fn platform_maths_and_hash_order_are_banned() -> Result<Vec<String>, String> {
    let read = |path: &str| fs::read_to_string(crate::root().join(path)).map_err(|e| format!("{path}: {e}"));
    let mut broken = Vec::new();
    let clippy = read("clippy.toml")?;
    for name in PLATFORM_MATHS {
        // The list in clippy.toml does the work; this check makes sure that no entry is removed.
        if !clippy.contains(&format!("\"f64::{name}\"")) {
            broken.push(format!("clippy.toml does not ban f64::{name}"));
        }
    }
    if !read("Cargo.toml")?.contains("iter_over_hash_type = \"warn\"") {
        broken.push("Cargo.toml does not turn on the lint iter_over_hash_type".to_owned());
    }
    let crates = crate::root().join("crates");
    for entry in fs::read_dir(&crates).map_err(|e| e.to_string())?.flatten() {
        let manifest = format!("crates/{}/Cargo.toml", entry.file_name().to_string_lossy());
        if !read(&manifest)?.contains("[lints]\nworkspace = true") {
            broken.push(format!("{manifest} does not take the workspace's lints"));
        }
    }
    Ok(broken)
}

/// Each point below *Invariants* ends in "Held by `path`: `function`.", and that function exists.
fn points_name_what_holds_them() -> Result<Vec<String>, String> {
    let page = fs::read_to_string(crate::root().join("ARCHITECTURE.md"))
        .map_err(|e| format!("ARCHITECTURE.md: {e}"))?;
    let mut broken = Vec::new();
    let points: Vec<&str> = page
        .lines()
        .skip_while(|l| *l != "*Invariants*")
        .skip(1)
        .take_while(|l| l.starts_with("- ") || l.trim().is_empty())
        .filter(|l| l.starts_with("- "))
        .collect();
    if points.is_empty() {
        broken.push("ARCHITECTURE.md has no list of *Invariants*".to_owned());
    }
    for point in points {
        let Some((_, holders)) = point.split_once("Held by ") else {
            broken.push(format!("ARCHITECTURE.md does not say what holds \"{point}\""));
            continue;
        };
        let quoted: Vec<&str> = holders.split('`').skip(1).step_by(2).collect();
        for pair in quoted.chunks(2) {
            let [path, function] = pair else {
                broken.push(format!(
                    "ARCHITECTURE.md: after \"Held by\" come a path and a function: {holders}"
                ));
                continue;
            };
            let text = fs::read_to_string(crate::root().join(path)).unwrap_or_default();
            if !text.contains(&format!("fn {function}(")) {
                broken.push(format!("ARCHITECTURE.md names {function} of {path}, which is not there"));
            }
        }
    }
    Ok(broken)
}

/// Paths that `use` and code of a file name, with their lines.
fn paths(source: &Source) -> Vec<(Vec<String>, usize)> {
    let mut paths = Paths(Vec::new());
    for item in &source.items {
        paths.visit_item(item);
    }
    paths.0
}

/// First segments of those paths, each once for each line.
fn first_names(source: &Source) -> BTreeSet<(String, usize)> {
    paths(source).into_iter().filter_map(|(path, line)| Some((path.first()?.clone(), line))).collect()
}

struct Paths(Vec<(Vec<String>, usize)>);

impl Paths {
    /// Sequences of names joined by `::`. Groups of a `use` are read as if the path before them stood
    /// before each of their names.
    fn tokens(&mut self, tokens: TokenStream, before: &[String]) {
        let mut path = before.to_vec();
        let (mut colons, mut line) = (2, 0);
        let mut starts = true;
        for tree in tokens {
            match tree {
                TokenTree::Ident(name) => {
                    // Two names without `::` between them belong to two paths.
                    if colons != 2 && !starts {
                        self.push(&path, before, line);
                        path = before.to_vec();
                    }
                    line = name.span().start().line;
                    path.push(name.to_string());
                    (colons, starts) = (0, false);
                }
                TokenTree::Punct(p) if p.as_char() == ':' => colons += 1,
                TokenTree::Group(group) => {
                    // Only a group after `::` is a group of a `use`; other groups start afresh.
                    let inner = if colons == 2 && !starts { path.clone() } else { Vec::new() };
                    self.tokens(group.stream(), &inner);
                    self.push(&path, before, line);
                    path = before.to_vec();
                    (colons, starts) = (2, true);
                }
                _ => {
                    self.push(&path, before, line);
                    path = before.to_vec();
                    (colons, starts) = (2, true);
                }
            }
        }
        self.push(&path, before, line);
    }

    fn push(&mut self, path: &[String], before: &[String], line: usize) {
        // A single name is a local variable as often as a path.
        if path.len() > before.len().max(1) {
            self.0.push((path.to_vec(), line));
        }
    }
}

impl<'ast> Visit<'ast> for Paths {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if source::is_for_tests(source::attributes(item)) {
            return;
        }
        match item {
            syn::Item::Mod(module) => {
                for item in module.content.iter().flat_map(|(_, items)| items) {
                    self.visit_item(item);
                }
            }
            other => self.tokens(other.to_token_stream(), &[]),
        }
    }
}

struct Signatures<'a> {
    path: &'a str,
    broken: &'a mut Vec<String>,
}

impl Signatures<'_> {
    fn typed(&mut self, name: &syn::Ident, of_type: &syn::Type) {
        let text = name.to_string();
        if UNITS.iter().any(|unit| text.ends_with(unit)) && holds_integer(of_type.to_token_stream()) {
            let line = name.span().start().line;
            self.broken.push(format!("{}:{line} {text} has a unit and is an integer", self.path));
        }
    }

    fn signature(&mut self, signature: &syn::Signature) {
        for argument in &signature.inputs {
            if let syn::FnArg::Typed(argument) = argument
                && let syn::Pat::Ident(name) = &*argument.pat
            {
                self.typed(&name.ident, &argument.ty);
            }
        }
        if let syn::ReturnType::Type(_, of_type) = &signature.output {
            self.typed(&signature.ident, of_type);
        }
    }
}

impl<'ast> Visit<'ast> for Signatures<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if !source::is_for_tests(source::attributes(item)) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if matches!(item.vis, syn::Visibility::Public(_)) {
            self.signature(&item.sig);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if matches!(item.vis, syn::Visibility::Public(_)) {
            self.signature(&item.sig);
        }
    }

    fn visit_field(&mut self, field: &'ast syn::Field) {
        if let (syn::Visibility::Public(_), Some(name)) = (&field.vis, &field.ident) {
            self.typed(name, &field.ty);
        }
    }
}

/// Whether a type names an integer.
fn holds_integer(tokens: TokenStream) -> bool {
    let integers = ["i8", "i16", "i32", "i64", "i128", "isize", "u8", "u16", "u32", "u64", "u128", "usize"];
    tokens.into_iter().any(|tree| match tree {
        TokenTree::Ident(name) => integers.iter().any(|i| name == i),
        // The length of an array has no unit.
        TokenTree::Group(group) if group.delimiter() == proc_macro2::Delimiter::Bracket => {
            let element = group.stream().into_iter();
            holds_integer(
                element.take_while(|t| !matches!(t, TokenTree::Punct(p) if p.as_char() == ';')).collect(),
            )
        }
        TokenTree::Group(group) => holds_integer(group.stream()),
        _ => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(package: &str, module: &str, text: &str) -> Source {
        Source {
            package: package.to_owned(),
            path: "a.rs".to_owned(),
            module: module.split("::").map(str::to_owned).collect(),
            items: syn::parse_file(text).expect("the test is Rust").items,
            attrs: Vec::new(),
            lines: Vec::new(),
            text: Vec::new(),
        }
    }

    #[test]
    fn outside_crates_are_found_outside_their_modules() {
        let n = |module, text| {
            outside_crates_stay_where_they_are_wrapped(&[source("grainpath-core", module, text)]).len()
        };
        for text in ["use spade::Point2;", "fn f() { spade::refine(); }", "fn f() -> spade::Point2 { g() }"] {
            assert_eq!(n("poly", text), 1, "{text}");
            assert_eq!(n("medial", text), 0, "{text}");
            assert_eq!(n("medial::inner", text), 0, "{text}");
        }
        assert_eq!(n("poly", "#[cfg(test)] mod tests { use spade::Point2; }"), 0);
        assert_eq!(n("poly", "/// As spade::refine does.\nfn f() {}"), 0);
    }

    #[test]
    fn files_are_opened_by_front_ends_and_readers_alone() {
        for text in [
            "use std::fs;",
            "use std::{io, fs::File};",
            "fn f() { std::fs::read(\"/proc/self/status\"); }",
            "fn f() { g(std::env::var(\"HOME\")) }",
        ] {
            assert!(!only_front_ends_open_files(&[source("grainpath", "a", text)]).is_empty(), "{text}");
            assert!(only_front_ends_open_files(&[source("grainpath-cli", "a", text)]).is_empty(), "{text}");
        }
        assert!(only_front_ends_open_files(&[source("grainpath", "a", "use std::{io, fmt};")]).is_empty());
    }

    #[test]
    fn integers_with_units_are_found_in_public_signatures() {
        let n = |text| no_length_is_an_integer(&[source("p", "a", text)]).len();
        assert_eq!(n("pub fn f(x_mm: i64, n: usize, y_mm: [f64; 3]) {}"), 1);
        assert_eq!(n("pub struct S { pub x_um: Vec<i32>, z_um: i32 }"), 1);
        assert_eq!(n("pub fn width_mm() -> u32 { 1 } fn g(x_mm: i64) {}"), 1);
        assert_eq!(n("pub fn f(x_mm: f64) -> usize { 1 }"), 0);
    }
}
