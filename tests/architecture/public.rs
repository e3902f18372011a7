//! What users can name: how much it is, that a name stands for one thing, and that public fields
//! can be added later.
//!
//! The sources are read as text: what `pub mod` and `pub use` make reachable from the crate root,
//! without what is hidden from the documentation. Methods, constants, macros and what comes from
//! other crates do not count.

use std::collections::{BTreeMap, BTreeSet};

use crate::{Source, code, sources};

/// The most public types, traits and free functions.
const MOST: usize = 275;

/// Functions that do the same for several formats of files, each in the module of its format.
const BY_FORMAT: [&str; 2] = ["read", "write"];

/// Structs that the caller fills, field by field, and whose fields are all there can be.
const COMPLETE: [&str; 1] = ["interval::Interval"];

/// A public type, trait or function, or a re-export, as a module declares it.
enum Entry<'a> {
    Item(Item<'a>),
    Use(Vec<String>),
}

#[derive(Clone, Copy)]
struct Item<'a> {
    kind: &'a str,
    is_hidden: bool,
    is_non_exhaustive: bool,
    has_public_fields: bool,
}

/// The modules of the crate, by path.
struct Crate<'a> {
    modules: BTreeMap<&'a [String], Module<'a>>,
}

#[derive(Default)]
struct Module<'a> {
    public_modules: Vec<String>,
    entries: Vec<(String, Entry<'a>)>,
}

impl<'a> Crate<'a> {
    fn new(sources: &'a [Source], codes: &'a [String]) -> Crate<'a> {
        let modules = sources.iter().zip(codes).map(|(source, code)| {
            let is_root = source.module == ["lib"];
            (if is_root { &[][..] } else { &source.module[..] }, Module::new(code))
        });
        Crate { modules: modules.collect() }
    }

    /// The definition behind a path, as its module and name; `None` if it is hidden or is a module.
    fn definition(
        &self,
        from: &[String],
        path: &[String],
    ) -> Option<(Vec<String>, Option<Item<'a>>)> {
        let mut module = from.to_vec();
        let mut rest = path;
        match path[0].as_str() {
            "crate" => (module, rest) = (Vec::new(), &path[1..]),
            "self" => rest = &path[1..],
            "super" => {
                module.pop();
                rest = &path[1..];
            }
            first => {
                let child = [&module[..], &[first.to_owned()]].concat();
                let names = self.modules.get(&module[..]).into_iter().flat_map(|m| &m.entries);
                let is_own = names.filter(|entry| !matches!(entry.1, Entry::Use(_)));
                if !self.modules.contains_key(&child[..])
                    && !is_own.map(|entry| &entry.0).any(|name| name == first)
                {
                    return None;
                }
            }
        }
        while let [first, _, ..] = rest {
            module.push(first.clone());
            rest = &rest[1..];
        }
        let name = rest.first()?;
        let entries = &self.modules.get(&module[..])?.entries;
        match entries.iter().find(|entry| entry.0 == *name).map(|entry| &entry.1) {
            Some(Entry::Use(path)) => self.definition(&module, path),
            Some(Entry::Item(item)) if item.is_hidden => None,
            found => {
                module.push(name.clone());
                let Some(Entry::Item(item)) = found else {
                    // A macro makes it.
                    return Some((module, None));
                };
                Some((module, Some(*item)))
            }
        }
    }

    /// All definitions that can be reached from the root.
    fn public(&self) -> BTreeMap<Vec<String>, Option<Item<'a>>> {
        let (mut found, mut waiting) = (BTreeMap::new(), vec![Vec::new()]);
        while let Some(path) = waiting.pop() {
            let Some(module) = self.modules.get(&path[..]) else { continue };
            for name in &module.public_modules {
                waiting.push([&path[..], std::slice::from_ref(name)].concat());
            }
            for (name, _) in &module.entries {
                let name = ["self".to_owned(), name.clone()];
                found.extend(self.definition(&path, &name));
            }
        }
        found
    }
}

impl<'a> Module<'a> {
    fn new(code: &'a str) -> Module<'a> {
        let (mut module, mut attributes, mut at) = (Module::default(), "".to_owned(), 0);
        while at < code.len() {
            let rest = &code[at..];
            let line = rest.lines().next().unwrap_or("");
            at += line.len() + 1;
            if line.starts_with('#') {
                attributes.push_str(line);
                continue;
            }
            if let Some(declared) = line.strip_prefix("pub ") {
                module.read(declared, rest, &attributes);
            }
            attributes.clear();
        }
        module
    }

    /// Reads a line that begins with `pub`; `rest` is the text from there.
    fn read(&mut self, line: &'a str, rest: &'a str, attributes: &str) {
        let is_hidden = attributes.contains("doc(hidden)");
        let (kind, name) = line.split_once(' ').unwrap_or((line, ""));
        match kind {
            "mod" if !is_hidden => {
                self.public_modules.extend(name.strip_suffix(';').map(str::to_owned))
            }
            "use" => {
                let list = rest["pub use ".len()..].split(';').next().unwrap_or("");
                self.entries.extend(opened(list));
            }
            "struct" | "enum" | "trait" | "fn" | "type" | "union" => {
                let name = crate::first_name(name);
                let end = rest.find("\n}").unwrap_or(rest.len());
                let braced = rest[..end].lines().skip(1).any(|line| line.starts_with("    pub "));
                let tuple = line.contains("(pub ");
                self.entries.push((
                    name,
                    Entry::Item(Item {
                        kind,
                        is_hidden,
                        is_non_exhaustive: attributes.contains("non_exhaustive"),
                        has_public_fields: kind == "struct"
                            && (tuple || line.ends_with('{') && braced),
                    }),
                ));
            }
            _ => {}
        }
    }
}

/// The names that `a::{b, c as d}` brings, one level of braces, with their paths.
fn opened<'a>(list: &str) -> Vec<(String, Entry<'a>)> {
    let (prefix, names) = match list.split_once('{') {
        Some((prefix, names)) => (prefix, names.trim_end().trim_end_matches('}')),
        None => ("", list),
    };
    let names = names.split(',').map(str::trim).filter(|name| !name.is_empty());
    let entries = names.map(|name| {
        let (path, alias) = name.split_once(" as ").unwrap_or((name, ""));
        let path: Vec<String> =
            format!("{}{path}", prefix.trim()).split("::").map(str::to_owned).collect();
        let alias = if alias.is_empty() { path[path.len() - 1].clone() } else { alias.to_owned() };
        (alias, Entry::Use(path))
    });
    entries.collect()
}

/// Calls `check` with all public definitions.
fn with_public(check: impl FnOnce(&BTreeMap<Vec<String>, Option<Item<'_>>>)) {
    let sources = sources();
    let codes: Vec<String> = sources.iter().map(|source| code(&source.text)).collect();
    check(&Crate::new(&sources, &codes).public());
}

#[test]
fn the_public_surface_is_small() {
    with_public(|public| {
        let names: BTreeSet<String> = public.keys().map(|path| path.join("::")).collect();
        for name in &names {
            println!("{name}");
        }
        println!("{} public types, traits and free functions", names.len());
        assert!(names.len() <= MOST, "{} public names, {MOST} are allowed", names.len());
    });
}

#[test]
fn a_public_name_stands_for_one_thing() {
    with_public(|public| {
        let mut meanings: BTreeMap<&String, Vec<String>> = BTreeMap::new();
        for path in public.keys() {
            meanings.entry(&path[path.len() - 1]).or_default().push(path.join("::"));
        }
        meanings.retain(|name, paths| paths.len() > 1 && !BY_FORMAT.contains(&name.as_str()));
        assert!(meanings.is_empty(), "names with several meanings: {meanings:#?}");
    });
}

#[test]
fn public_fields_leave_room_for_more() {
    with_public(|public| {
        let closed = public.iter().filter(|(_, item)| {
            item.is_some_and(|item| item.has_public_fields && !item.is_non_exhaustive)
        });
        let mut closed: Vec<String> = closed.map(|(path, _)| path.join("::")).collect();
        closed.retain(|name| !COMPLETE.contains(&name.as_str()));
        assert!(closed.is_empty(), "not `#[non_exhaustive]`: {closed:#?}");
    });
}

#[test]
fn the_list_sees_what_it_should() {
    let source = |module: &[&str], text: &str| Source {
        path: module.join("/").into(),
        module: module.iter().map(|&name| name.to_owned()).collect(),
        text: text.to_owned(),
    };
    let sources = [
        source(&["lib"], "pub mod a;\nmod b;\n#[doc(hidden)]\npub mod c;\npub use a::F;\n"),
        source(
            &["a"],
            "mod d;\npub use d::{\n    F, G as H,\n};\npub struct S {\n    pub x: u8,\n}\n",
        ),
        source(
            &["a", "d"],
            "pub fn F() {}\n#[non_exhaustive]\npub struct G {\n    pub x: u8,\n}\n",
        ),
        source(&["b"], "pub enum E {}\n"),
        source(&["c"], "pub enum E {}\n"),
    ];
    let codes: Vec<String> = sources.iter().map(|source| code(&source.text)).collect();
    let krate = Crate::new(&sources, &codes);
    let public = krate.public();
    let names: Vec<String> = public.keys().map(|path| path.join("::")).collect();
    assert_eq!(names, ["a::S", "a::d::F", "a::d::G"]);
    let open = |path: &[&str]| {
        let path: Vec<String> = path.iter().map(|&name| name.to_owned()).collect();
        let item = public[&path].unwrap();
        (item.kind, item.has_public_fields && item.is_non_exhaustive)
    };
    assert_eq!(open(&["a", "d", "G"]), ("struct", true));
    assert_eq!(open(&["a", "S"]), ("struct", false));
}
