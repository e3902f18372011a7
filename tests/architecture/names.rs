//! A name stands for one thing: types, traits and constants of the whole crate, private ones too.
//!
//! The sources are read as text. Aliases, associated types and constants, and constants within
//! functions do not count, and neither do the two forms of a type that a feature switches within
//! one file.

use std::collections::{BTreeMap, BTreeSet};

use crate::{code, first_name, sources};

/// Types and traits that still share their name with another one.
const SHARED_TYPES: [&str; 20] = [
    "Context",
    "Cut",
    "Facet",
    "Guard",
    "Handles",
    "Label",
    "Law",
    "Limit",
    "Memory",
    "Multipliers",
    "Names",
    "Pair",
    "Polyhedron",
    "Question",
    "Region",
    "Search",
    "Shape",
    "State",
    "Step",
    "Writer",
];

/// Constants that still share their name with another one.
const SHARED_CONSTANTS: [&str; 10] = [
    "AXES",
    "COARSER",
    "MARGIN",
    "MISS",
    "MOST_COMBINATIONS",
    "NOISE",
    "ROUNDING",
    "ROUNDS",
    "SHARE",
    "SIZE",
];

/// Declarations: their keywords, and whether indented ones count.
struct Kind {
    keywords: &'static [&'static str],
    indented: bool,
}

const TYPES: Kind = Kind { keywords: &["struct", "enum", "trait", "union"], indented: true };
const CONSTANTS: Kind = Kind { keywords: &["const", "static"], indented: false };

/// The name that a line declares, behind any visibility.
fn declared<'a>(line: &'a str, kind: &Kind) -> Option<&'a str> {
    let line = if kind.indented { line.trim_start() } else { line };
    let rest = match line.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(')')?.1.trim_start(),
        Some(rest) => rest.trim_start(),
        None => line,
    };
    let (keyword, rest) = rest.split_once(' ')?;
    let name = &rest[..first_name(rest).len()];
    (kind.keywords.contains(&keyword) && name.starts_with(char::is_uppercase)).then_some(name)
}

/// The names that several files declare, with the files.
fn repeated(files: &[(String, String)], kind: &Kind) -> BTreeMap<String, BTreeSet<String>> {
    let mut found: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (file, text) in files {
        for name in code(text).lines().filter_map(|line| declared(line, kind)) {
            found.entry(name.to_owned()).or_default().insert(file.clone());
        }
    }
    found.retain(|_, files| files.len() > 1);
    found
}

/// Fails where a name outside a list is declared twice, and where one of the list is not.
fn check(kind: &Kind, shared: &[&str]) {
    let files = sources().into_iter().map(|source| (source.module.join("::"), source.text));
    let mut found = repeated(&files.collect::<Vec<_>>(), kind);
    let settled: Vec<_> = shared.iter().filter(|name| found.remove(**name).is_none()).collect();
    assert!(found.is_empty(), "names with several meanings: {found:#?}");
    assert!(settled.is_empty(), "take off the list what has one meaning by now: {settled:?}");
}

#[test]
fn a_type_name_stands_for_one_type() {
    check(&TYPES, &SHARED_TYPES);
}

#[test]
fn a_constant_name_stands_for_one_constant() {
    check(&CONSTANTS, &SHARED_CONSTANTS);
}

#[test]
fn the_check_sees_what_it_should() {
    let file = |name: &str, text: &str| (name.to_owned(), text.to_owned());
    let files = [
        file(
            "a",
            "pub struct Row<'a> {\n}\nstruct Wall(f64);\nconst fn most() {}\nconst _: () = ();",
        ),
        file("b", "pub(super) enum Row {\n}\n    type Wall = f64;\nconst MOST: usize = 1;"),
        file("c", "// struct Wall;\npub(in crate::b) static MOST: usize = 2;\nconst _: () = ();"),
        file(
            "d",
            "#[cfg(a)]\nstruct Span(u8);\n#[cfg(not(a))]\nstruct Span;\n    const ALL: u8 = 1;",
        ),
        file("e", "    const ALL: u8 = 2;\nuse a::Wall;\nconst fn most() {}"),
    ];
    let names = |kind| repeated(&files, kind).into_keys().collect::<Vec<_>>();
    assert_eq!(names(&TYPES), ["Row"]);
    assert_eq!(names(&CONSTANTS), ["MOST"]);
}
