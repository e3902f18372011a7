//! Circles of files: strongly connected components of the graph of imports.
//!
//! A file points to another one when a path in its code, in a `use` or elsewhere, leads to a name
//! that the other file defines. Paths through re-exports lead to the file behind them, so a
//! `mod.rs` that only declares and re-exports points to nothing. Unit tests are left out.

use std::collections::{BTreeMap, BTreeSet};

/// A file: its modules from the root of the crate, and its text without comments.
pub(crate) struct File {
    pub(crate) module: Vec<String>,
    pub(crate) code: String,
}

/// An import, `use path as name`.
#[derive(Debug, Clone, PartialEq)]
struct Import {
    path: Vec<String>,
    name: String,
    is_public: bool,
}

/// The circles of two or more files, the largest first; a file is an index of the slice.
pub(crate) fn circles(files: &[File]) -> Vec<Vec<usize>> {
    let edges = edges(files);
    let reachable: Vec<BTreeSet<usize>> = (0..files.len()).map(|k| reach(&edges, k)).collect();
    let mut circles: Vec<Vec<usize>> = Vec::new();
    for k in 0..files.len() {
        let on_a_circle = |&other: &usize| reachable[other].contains(&k);
        let circle: Vec<usize> = reachable[k].iter().copied().filter(on_a_circle).collect();
        if circle.first() == Some(&k) && circle.len() > 1 {
            circles.push(circle);
        }
    }
    circles.sort_by_key(|circle| std::cmp::Reverse(circle.len()));
    circles
}

/// The files that can be reached from one, over one edge or more.
fn reach(edges: &[BTreeSet<usize>], start: usize) -> BTreeSet<usize> {
    let (mut reached, mut waiting) = (BTreeSet::new(), vec![start]);
    while let Some(k) = waiting.pop() {
        waiting.extend(edges[k].iter().copied().filter(|&next| reached.insert(next)));
    }
    reached
}

/// The files that each file points to.
fn edges(files: &[File]) -> Vec<BTreeSet<usize>> {
    let graph = Graph::new(files);
    (0..files.len())
        .map(|k| {
            let mut targets = graph.targets(k);
            targets.remove(&k);
            targets
        })
        .collect()
}

struct Graph<'a> {
    files: &'a [File],
    by_module: BTreeMap<&'a [String], usize>,
    imports: Vec<Vec<Import>>,
    /// Paths of two or more names outside of imports.
    paths: Vec<Vec<Vec<String>>>,
    /// Names that stand alone outside of imports.
    words: Vec<BTreeSet<String>>,
}

impl<'a> Graph<'a> {
    fn new(files: &'a [File]) -> Self {
        let by_module = files.iter().enumerate().map(|(k, file)| (&file.module[..], k)).collect();
        let (mut imports, mut paths, mut words) = (Vec::new(), Vec::new(), Vec::new());
        for file in files {
            let parsed = parse(&tokens(&file.code));
            imports.push(parsed.imports);
            words.push(parsed.paths.iter().map(|path| path[0].clone()).collect());
            paths.push(parsed.paths.into_iter().filter(|path| path.len() > 1).collect());
        }
        Graph { files, by_module, imports, paths, words }
    }

    fn targets(&self, k: usize) -> BTreeSet<usize> {
        let module = &self.files[k].module;
        let mut targets = BTreeSet::new();
        for import in &self.imports[k] {
            // A re-export is no use of the name.
            if import.is_public && !self.words[k].contains(&import.name) {
                continue;
            }
            let Some(path) = self.absolute(module, &import.path) else { continue };
            // What is used of an imported module counts, not the module.
            if !self.by_module.contains_key(&path[..]) {
                targets.extend(self.resolve(&path, 0));
            }
        }
        for path in &self.paths[k] {
            let imported = self.imports[k].iter().find(|import| import.name == path[0]);
            let path = match imported {
                Some(import) => [&import.path[..], &path[1..]].concat(),
                None => path.clone(),
            };
            targets.extend(self.absolute(module, &path).and_then(|path| self.resolve(&path, 0)));
        }
        targets
    }

    /// A path from the root of the crate; `None` if it leads out of the crate.
    fn absolute(&self, module: &[String], path: &[String]) -> Option<Vec<String>> {
        let mut base = module.to_vec();
        let mut rest = path;
        match rest.first()?.as_str() {
            "crate" => (base, rest) = (Vec::new(), &rest[1..]),
            "self" => rest = &rest[1..],
            "super" => {
                while rest.first().is_some_and(|name| name == "super") {
                    base.pop()?;
                    rest = &rest[1..];
                }
            }
            first => {
                let child = [module, &[first.to_string()]].concat();
                self.by_module.get(&child[..])?;
            }
        }
        base.extend_from_slice(rest);
        Some(base)
    }

    /// The file that defines what a path from the root leads to.
    fn resolve(&self, path: &[String], depth: usize) -> Option<usize> {
        let length = (0..=path.len()).rev().find(|&n| self.by_module.contains_key(&path[..n]))?;
        let file = self.by_module[&path[..length]];
        let Some(name) = path.get(length).filter(|_| depth < 10) else { return Some(file) };
        let import = self.imports[file].iter().find(|import| import.name == *name);
        let behind = import.and_then(|import| {
            let base = self.absolute(&path[..length], &import.path)?;
            self.resolve(&[&base[..], &path[length + 1..]].concat(), depth + 1)
        });
        Some(behind.unwrap_or(file))
    }
}

/// Names, `::`, and signs of one character each; strings and characters are left out.
fn tokens(code: &str) -> Vec<String> {
    let code = code.split("#[cfg(test)]\nmod tests").next().unwrap_or(code);
    let letters: Vec<char> = code.chars().collect();
    let (mut tokens, mut k) = (Vec::new(), 0);
    while k < letters.len() {
        let letter = letters[k];
        let start = k;
        k += 1;
        if letter.is_alphanumeric() || letter == '_' {
            while k < letters.len() && (letters[k].is_alphanumeric() || letters[k] == '_') {
                k += 1;
            }
            tokens.push(letters[start..k].iter().collect());
        } else if letter == '"' {
            while k < letters.len() && letters[k] != '"' {
                k += if letters[k] == '\\' { 2 } else { 1 };
            }
            k += 1;
        } else if letter == '\'' && letters.get(k) == Some(&'\\') {
            k += letters[k + 2..].iter().position(|&c| c == '\'').map_or(1, |n| n + 3);
        } else if letter == '\'' && letters.get(k + 1) == Some(&'\'') {
            k += 2;
        } else if letter == ':' && letters.get(k) == Some(&':') {
            k += 1;
            tokens.push("::".to_string());
        } else if !letter.is_whitespace() {
            tokens.push(letter.to_string());
        }
    }
    tokens
}

#[derive(Default)]
struct Parsed {
    imports: Vec<Import>,
    paths: Vec<Vec<String>>,
}

fn parse(tokens: &[String]) -> Parsed {
    let mut parsed = Parsed::default();
    let mut k = 0;
    while k < tokens.len() {
        if tokens[k] == "use" {
            let is_public = k > 0 && (tokens[k - 1] == "pub" || tokens[k - 1] == ")");
            k = tree(tokens, k + 1, &[], is_public, &mut parsed.imports);
        } else if is_name(&tokens[k]) {
            let mut path = vec![tokens[k].clone()];
            while tokens.get(k + 1).is_some_and(|t| t == "::")
                && tokens.get(k + 2).is_some_and(|t| is_name(t))
            {
                path.push(tokens[k + 2].clone());
                k += 2;
            }
            parsed.paths.push(path);
            k += 1;
        } else {
            k += 1;
        }
    }
    parsed
}

/// Reads a tree of imports after its `prefix`; the place behind it.
fn tree(
    tokens: &[String],
    mut k: usize,
    prefix: &[String],
    is_public: bool,
    imports: &mut Vec<Import>,
) -> usize {
    let mut path = prefix.to_vec();
    while k < tokens.len() {
        match tokens[k].as_str() {
            "{" => {
                k += 1;
                while k < tokens.len() && tokens[k] != "}" {
                    k = tree(tokens, k, &path, is_public, imports);
                    k += usize::from(tokens.get(k).is_some_and(|t| t == ","));
                }
                return k + 1;
            }
            "::" => k += 1,
            "as" => {
                let name = tokens.get(k + 1).cloned().unwrap_or_default();
                imports.push(Import { path, name, is_public });
                return k + 2;
            }
            name if is_name(name) || name == "*" => {
                // `self` at the end of a tree is its prefix.
                if name != "self" || path.is_empty() {
                    path.push(name.to_string());
                }
                k += 1;
            }
            _ => break,
        }
    }
    if let Some(name) = path.last().cloned() {
        imports.push(Import { path, name, is_public });
    }
    k
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files from pairs of a module and its code, and the names of the modules on each circle.
    fn found(sources: &[(&str, &str)]) -> Vec<Vec<String>> {
        let file = |&(module, code): &(&str, &str)| File {
            module: module.split("::").filter(|name| !name.is_empty()).map(String::from).collect(),
            code: code.to_string(),
        };
        let files: Vec<File> = sources.iter().map(file).collect();
        let name = |k: usize| files[k].module.join("::");
        circles(&files).into_iter().map(|c| c.into_iter().map(name).collect()).collect()
    }

    #[test]
    fn a_circle_of_four_files_is_found() {
        let circle = found(&[
            ("a", "use super::b::B;"),
            ("b", "use crate::{c::{C, D}, e};"),
            ("c", "fn f() { super::d::g() }"),
            ("d", "use super::a::A as B;"),
            ("e", "use super::d::g;"),
        ]);
        assert_eq!(circle, [["a", "b", "c", "d"]]);
    }

    #[test]
    fn imported_modules_and_aliases_are_followed() {
        let circle = found(&[
            ("a", "use super::b as other; fn f() { other::g() }"),
            ("b", "use crate::a::f;"),
        ]);
        assert_eq!(circle, [["a", "b"]]);
        assert!(found(&[("a", "use super::b as other;"), ("b", "use crate::a::f;")]).is_empty());
    }

    #[test]
    fn re_exports_lead_to_the_file_behind_them() {
        let one = ("m::one", "use super::{Two, three};");
        let apart = [
            ("m", "mod one; mod two; pub use one::One; pub(crate) use two::Two; fn three() {}"),
            one,
            ("m::two", "use std::fmt; fn f() { fmt::g() }"),
        ];
        assert!(found(&apart).is_empty());
        // A name that the parent uses itself is a use of the child.
        let parent =
            ("m", "mod one; mod two; pub use one::One; pub use two::Two; fn three() -> One {}");
        assert_eq!(found(&[parent, one, apart[2]]), [["m", "m::one"]]);
    }

    #[test]
    fn tests_strings_and_other_crates_count_for_nothing() {
        let a = (
            "a",
            "fn f() { '\\''; \"super::b::g\" }\n#[cfg(test)]\nmod tests { use crate::b::g; }",
        );
        assert!(found(&[a, ("b", "use super::a::f; use std::a::g; use a::h;")]).is_empty());
    }
}
