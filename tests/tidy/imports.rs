//! Circles of imports: files that cannot be read, tested or moved one before the other.
//!
//! What counts: an arrow goes from a file to each file of the crate that defines something it names, by a `use` or by a
//! path in its code (`super::x::Y`, `crate::x::Y`, `child::Y`). Names are followed through re-exports to the file that
//! defines them, so what a `mod.rs` only declares and passes on leads to no arrow from or to it: a `pub use` counts for
//! the file only when its own code names the thing too. A child that names what its parent's file defines has an arrow
//! to the parent, and a parent that names what a child defines has one to the child: both together are a circle.
//! Methods and fields do not count, since they are called without naming a file; comments and tests do not either.

use std::collections::{BTreeMap, BTreeSet};

/// One file as a module: its path in the crate, and its code.
pub(super) struct Module {
    /// The path from the root of the repository.
    pub(super) file: String,
    /// Code without comments and tests.
    pub(super) code: String,
}

/// All knots of files that name each other in circles: a line for each file, with the files of the knot that it names.
pub(super) fn circles(modules: &[Module]) -> Vec<Vec<String>> {
    let tree = Tree::new(modules);
    let arrows: Vec<BTreeSet<usize>> = (0..modules.len()).map(|from| tree.arrows(from)).collect();
    let reach: Vec<BTreeSet<usize>> = (0..modules.len()).map(|from| reached(&arrows, from)).collect();
    let mut knots = BTreeSet::new();
    for from in 0..modules.len() {
        let knot: BTreeSet<usize> = reach[from].iter().copied().filter(|&to| reach[to].contains(&from)).collect();
        if !knot.is_empty() {
            knots.insert(knot);
        }
    }
    let told = |knot: &BTreeSet<usize>| {
        let inside = |&from: &usize| {
            let to = arrows[from].intersection(knot).map(|&to| short(&modules[to].file));
            format!("{} names {}", modules[from].file, to.collect::<Vec<_>>().join(", "))
        };
        knot.iter().map(inside).collect()
    };
    knots.iter().map(told).collect()
}

fn short(file: &str) -> &str {
    file.trim_start_matches("src/")
}

/// Files that can be reached from a file along arrows; the file itself only along a circle.
fn reached(arrows: &[BTreeSet<usize>], from: usize) -> BTreeSet<usize> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(at) = open.pop() {
        open.extend(arrows[at].iter().copied().filter(|&to| found.insert(to)));
    }
    found
}

type ModPath = Vec<String>;

/// The modules of a crate and the names that each file brings in.
struct Tree {
    /// File of each module.
    files: BTreeMap<ModPath, usize>,
    scopes: Vec<Scope>,
}

/// The names that a file may use in short, and those it does use.
struct Scope {
    /// Names brought in by `use` and by `mod`, with the full paths they stand for.
    names: BTreeMap<String, ModPath>,
    /// Full paths that the file names.
    named: Vec<ModPath>,
}

impl Tree {
    fn new(modules: &[Module]) -> Self {
        let paths: Vec<ModPath> = modules.iter().map(|module| mod_path(&module.file)).collect();
        let files = paths.iter().cloned().zip(0..).collect();
        let scopes = modules.iter().zip(&paths).map(|(module, path)| Scope::read(&module.code, path)).collect();
        Self { files, scopes }
    }

    fn arrows(&self, from: usize) -> BTreeSet<usize> {
        let named = self.scopes[from].named.iter();
        named.filter_map(|path| self.definer(path)).filter(|&to| to != from).collect()
    }

    /// The file that defines what a full path names.
    fn definer(&self, path: &[String]) -> Option<usize> {
        let mut path = path.to_vec();
        // A name is re-exported a few times at most.
        for _ in 0..8 {
            let known = (1..=path.len()).rev().find(|&len| self.files.contains_key(&path[..len]))?;
            let at = self.files[&path[..known]];
            let passed_on = path.get(known).and_then(|name| self.scopes[at].names.get(name));
            let Some(full) = passed_on else { return Some(at) };
            let mut next = full.clone();
            next.extend_from_slice(&path[known + 1..]);
            if next == path {
                return Some(at);
            }
            path = next;
        }
        panic!("{path:?} is passed on in a circle")
    }
}

impl Scope {
    fn read(code: &str, own: &[String]) -> Self {
        let (uses, rest) = without_uses(code);
        let mut names = BTreeMap::new();
        // A visibility such as `pub(in crate::x)` is not a use of that module.
        let rest = rest.split("(in crate::").enumerate().map(|(part, text)| match text.split_once(')') {
            Some((_, after)) if part > 0 => after,
            _ => text,
        });
        let rest = rest.collect::<Vec<_>>().join("");
        let words: Vec<&str> = words(&rest);
        for pair in words.windows(3).filter(|three| three[0] == "mod" && three[2] == ";") {
            names.insert(pair[1].to_owned(), [own, &[pair[1].to_owned()]].concat());
        }
        let children = names.clone();
        let mut named = Vec::new();
        let declared = |place: usize| place > 0 && words[place - 1] == "mod";
        let body: BTreeSet<&str> = (0..words.len()).filter(|&at| !declared(at)).map(|at| words[at]).collect();
        for Use { is_public, tree } in uses {
            for (path, name) in leaves(&tree) {
                let Some(full) = absolute(&path, own, &children) else { continue };
                // A private name that is not used does not compile without a warning.
                if !is_public || body.contains(name.as_str()) {
                    named.push(full.clone());
                }
                names.insert(name, full);
            }
        }
        let paths = paths(&words).into_iter().filter(|path| path.len() > 1);
        named.extend(paths.filter_map(|path| absolute(&path, own, &names)));
        Self { names, named }
    }
}

struct Use {
    is_public: bool,
    tree: String,
}

/// The `use` declarations of a code, and the code without them.
fn without_uses(code: &str) -> (Vec<Use>, String) {
    let (mut uses, mut rest) = (Vec::new(), String::new());
    let mut lines = code.lines();
    while let Some(line) = lines.next() {
        let trimmed = line.trim_start();
        let is_public = trimmed.starts_with("pub");
        let Some(tree) = without_visibility(trimmed).strip_prefix("use ") else {
            rest.push_str(line);
            rest.push('\n');
            continue;
        };
        let mut tree = tree.to_owned();
        while !tree.contains(';') {
            tree.push_str(lines.next().expect("a use ends"));
        }
        uses.push(Use { is_public, tree: tree.replace(';', "") });
    }
    (uses, rest)
}

/// A line without its visibility.
fn without_visibility(line: &str) -> &str {
    let Some(after) = line.strip_prefix("pub") else { return line };
    let after = after.strip_prefix('(').and_then(|inside| Some(inside.split_once(')')?.1)).unwrap_or(after);
    after.strip_prefix(' ').unwrap_or(line)
}

/// Every path of a `use` tree, with the name it is known by.
fn leaves(tree: &str) -> Vec<(Vec<String>, String)> {
    let tree = tree.trim();
    if let Some((prefix, group)) = tree.split_once('{') {
        let group = group.trim_end().strip_suffix('}').expect("a group ends");
        let prefix: Vec<String> = segments(prefix);
        let inside = split_outside_braces(group).into_iter().flat_map(leaves);
        let whole = inside.map(|(path, name)| {
            let is_self = path == ["self"];
            let full = if is_self { prefix.clone() } else { [prefix.clone(), path].concat() };
            let name = if is_self && name == "self" { full.last().cloned().unwrap_or_default() } else { name };
            (full, name)
        });
        return whole.collect();
    }
    let (path, name) =
        tree.split_once(" as ").map_or((tree, None), |(path, name)| (path, Some(name.trim().to_owned())));
    let path = segments(path);
    let Some(last) = path.last().cloned() else { return Vec::new() };
    vec![(path, name.unwrap_or(last))]
}

fn segments(path: &str) -> Vec<String> {
    path.split("::").map(|word| word.trim().to_owned()).filter(|word| !word.is_empty()).collect()
}

fn split_outside_braces(group: &str) -> Vec<&str> {
    let (mut parts, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&group[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&group[start..]);
    parts
}

/// The full path of a path as written in a file; none for another crate's.
fn absolute(path: &[String], own: &[String], names: &BTreeMap<String, ModPath>) -> Option<ModPath> {
    let (first, rest) = path.split_first()?;
    match first.as_str() {
        "crate" => Some(rest.to_vec()),
        "self" => Some([own, rest].concat()),
        "super" => {
            let up = path.iter().take_while(|word| *word == "super").count();
            Some([&own[..own.len().checked_sub(up)?], &path[up..]].concat())
        }
        name => names.get(name).map(|full| [full.as_slice(), rest].concat()),
    }
}

/// Words and punctuation marks of a code; `::` is one mark.
fn words(code: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = code;
    while let Some(c) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let len = if is_word(c) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            c.len_utf8()
        };
        if !c.is_whitespace() {
            found.push(&rest[..len]);
        }
        rest = &rest[len..];
    }
    found
}

/// Paths of words joined by `::`.
fn paths(words: &[&str]) -> Vec<Vec<String>> {
    let mut found: Vec<Vec<String>> = Vec::new();
    let mut joins = false;
    for word in words {
        let is_word = word.starts_with(|c: char| c.is_alphanumeric() || c == '_');
        if is_word && joins {
            found.last_mut().expect("a mark joins words").push((*word).to_owned());
        } else if is_word {
            found.push(vec![(*word).to_owned()]);
        }
        joins = *word == "::" && !found.is_empty();
    }
    found
}

/// Module path of a file: `src/render/gpu.rs` is `render::gpu`, `src/render/mod.rs` is `render`, `src/lib.rs` the root.
fn mod_path(file: &str) -> ModPath {
    let inside = short(file).trim_end_matches(".rs");
    let inside = inside.strip_suffix("/mod").unwrap_or(inside);
    segments(&inside.replace('/', "::")).into_iter().filter(|word| word != "lib").collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Knots among files given as path and code.
    fn knots(files: &[(&str, &str)]) -> usize {
        let module = |&(file, code): &(&str, &str)| Module { file: file.to_owned(), code: code.to_owned() };
        circles(&files.iter().map(module).collect::<Vec<_>>()).len()
    }

    #[test]
    fn two_files_that_name_each_other_are_a_circle() {
        let ab = [("src/m/a.rs", "use super::b::B;\nstruct A;"), ("src/m/b.rs", "use crate::m::a::A;\nstruct B;")];
        assert_eq!(knots(&ab), 1, "by use");
        let ab =
            [("src/m/a.rs", "fn a() { super::b::b() }"), ("src/m/b.rs", "use super::{a, c::C};\nfn b() { a::a() }")];
        assert_eq!(knots(&ab), 1, "by a path in the code");
        let ab = [("src/m/a.rs", "use super::b::B;\nstruct A;"), ("src/m/b.rs", "struct B;")];
        assert_eq!(knots(&ab), 0, "one way");
    }

    #[test]
    fn a_circle_over_three_files_and_a_re_export_is_found() {
        let front = ("src/m/mod.rs", "mod a;\nmod b;\nmod c;\npub use a::A;\npub use b::{B, b2 as b3};");
        let c = ("src/m/c.rs", "use super::A;\nstruct C;");
        let circle = [front, ("src/m/a.rs", "use super::b3;\nstruct A;"), ("src/m/b.rs", "use crate::m::c::C;"), c];
        assert_eq!(knots(&circle), 1, "a, b and c through what the parent passes on");
        assert_eq!(knots(&circle[..3]), 0, "without c the chain has an end");
        let front = ("src/m/mod.rs", "mod a;\nmod b;\npub(in crate::m) use b::B;");
        let circle = [front, ("src/m/a.rs", "use super::B;\npub struct A;"), ("src/m/b.rs", "use super::a::A;")];
        assert_eq!(knots(&circle), 1, "passed on to some only");
    }

    #[test]
    fn a_parent_that_only_passes_names_on_is_in_no_circle() {
        let child = ("src/m/a.rs", "use super::P;\npub struct A;");
        assert_eq!(knots(&[("src/m/mod.rs", "mod a;\npub use a::A;\npub struct P;"), child]), 0, "passes on");
        assert_eq!(knots(&[("src/m/mod.rs", "mod a;\npub use a::A;\npub struct P(A);"), child]), 1, "names it too");
        assert_eq!(knots(&[("src/m.rs", "mod a;\npub struct P;\nfn f() { a::A }"), child]), 1, "by a path");
        let function = ("src/m/a.rs", "use super::P;\npub fn a() {}");
        assert_eq!(knots(&[("src/m/mod.rs", "mod a;\npub use a::a;\npub struct P;"), function]), 0, "of one name");
    }
}
