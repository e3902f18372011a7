//! The floors within the crates: who may import whom, which circles of files there may be, who may
//! name the relaxation's library, how long a file may be, and that a name stands for one thing,
//! that each message has its section of help, and that links between pages lead somewhere.
//! Between crates, Cargo sees to it. See `docs/architecture.md`.

mod circles;
mod help;
mod names;
mod pages;
mod public;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use circles::{File, circles};

/// What everything stands on, from the bottom up; each module sees those before it.
const GROUND: [&str; 17] = [
    "setters",
    "mutations",
    "rounding",
    "number",
    "random",
    "serde_numbers",
    "error",
    "tolerance",
    "interval",
    "elementary",
    "activity",
    "sum",
    "union_find",
    "semidefinite",
    "model",
    "solution",
    "solver",
];

/// The modelling tower on the ground, from the bottom up.
const MODELLING: [&str; 4] = ["picture", "graph_of_sets", "hybrid", "collision_tolerant"];

/// The solving tower on the ground, from the bottom up.
const SOLVING: [&str; 11] = [
    "program",
    "presolve",
    "relaxation",
    "reformulate",
    "search",
    "spatial",
    "proof",
    "branch_and_bound",
    "explain",
    "external",
    "highs",
];

/// Beside the towers, on the ground, imported by nobody.
const BESIDE: [&str; 4] = ["conformance", "sweep", "explicit", "embedded"];

/// Macros, which stand at the root of their crate.
const MACROS: [&str; 5] = ["setters", "sums", "scaling", "products", "comparisons"];

/// Files that name everything.
const EXEMPT: [&str; 4] = ["lib", "prelude", "guide", "internals"];

/// The longest file, in lines.
const LONGEST: usize = 500;

/// The most files on a circle of imports.
const CIRCLE: usize = 3;

/// The folders of sources, and the module of `carom` that each is; those without one share the
/// root.
const CRATES: [(&str, &str); 8] = [
    ("src", ""),
    ("crates/carom-model/src", ""),
    ("crates/carom-solver/src", ""),
    ("crates/carom-hybrid/src", ""),
    ("crates/carom-conformance/src", "conformance"),
    ("crates/carom-sweep/src", "sweep"),
    ("crates/carom-explicit/src", "explicit"),
    ("crates/carom-embedded/src", "embedded"),
];

struct Source {
    path: PathBuf,
    /// Modules from the root of `carom`, `["model", "mps", "read"]`.
    module: Vec<String>,
    text: String,
}

/// The sources of all crates, as if they were one: their modules have different names.
fn sources() -> Vec<Source> {
    let mut sources: Vec<Source> = Vec::new();
    let mut root = String::new();
    for (folder, module) in CRATES {
        for source in sources_in(folder, module) {
            // The roots are one: what each declares can be reached from `carom`.
            match source.module == ["lib"] {
                true => root += &source.text,
                false => sources.push(source),
            }
        }
    }
    root += "pub mod conformance;\npub mod sweep;\npub mod explicit;\n";
    sources.push(Source { path: "src/lib.rs".into(), module: vec!["lib".into()], text: root });
    sources.sort_by(|a, b| a.path.cmp(&b.path));
    sources
}

fn sources_in(folder: &str, prefix: &str) -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut sources = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let module = path.strip_prefix(&root).unwrap().with_extension("");
                let names = module.iter().map(|name| name.to_string_lossy().into_owned());
                let mut module: Vec<String> = names.filter(|name| name != "mod").collect();
                if !prefix.is_empty() {
                    module.retain(|name| name != "lib");
                    module.insert(0, prefix.to_owned());
                }
                let text = fs::read_to_string(&path).unwrap();
                sources.push(Source { path, module, text });
            }
        }
    }
    sources
}

/// The text without line comments; in this crate `//` stands in no string.
fn code(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or(""));
    lines.collect::<Vec<_>>().join("\n")
}

/// The first names of the paths after each `crate::`, braces opened, in `code`.
fn after_crate(code: &str) -> Vec<String> {
    let mut names = Vec::new();
    for (start, _) in code.match_indices("crate::") {
        let rest = &code[start + "crate::".len()..];
        let Some(list) = rest.strip_prefix('{') else {
            names.push(first_name(rest));
            continue;
        };
        let (mut depth, mut at_start) = (0_usize, true);
        for (k, letter) in list.char_indices() {
            match letter {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => at_start = true,
                _ if letter.is_whitespace() => {}
                _ if at_start => {
                    names.push(first_name(&list[k..]));
                    at_start = false;
                }
                _ => {}
            }
        }
    }
    names
}

/// Names reached by climbing to the root of the crate with `super::`.
fn after_super(code: &str, depth: usize) -> Vec<String> {
    let climb = "super::".repeat(depth);
    let found = code.match_indices(&climb).map(|(start, _)| &code[start + climb.len()..]);
    found.map(first_name).filter(|name| is_module(name)).collect()
}

fn first_name(path: &str) -> String {
    path.chars().take_while(|&c| c.is_alphanumeric() || c == '_').collect()
}

fn is_module(name: &str) -> bool {
    [&GROUND[..], &MODELLING, &SOLVING, &BESIDE].concat().contains(&name)
}

/// What a module may import, or `None` for a module that has no floor yet.
fn allowed(module: &str) -> Option<Vec<&'static str>> {
    let below = |tower: &'static [&'static str]| {
        let floor = tower.iter().position(|name| *name == module)?;
        Some(tower[..=floor].to_vec())
    };
    below(&GROUND).or_else(|| {
        let tower = below(&MODELLING).or_else(|| below(&SOLVING)).or_else(|| below(&BESIDE))?;
        Some([&GROUND[..], &tower].concat())
    })
}

#[test]
fn imports_run_downward() {
    let mut wrong = Vec::new();
    for source in sources() {
        let module = source.module.first().map(String::as_str).unwrap_or("");
        // Those beside the towers are crates of one floor.
        if EXEMPT.contains(&module) || BESIDE.contains(&module) {
            continue;
        }
        let Some(allowed) = allowed(module) else {
            wrong.push(format!("{}: no floor for module `{module}`", source.path.display()));
            continue;
        };
        let code = code(&source.text);
        let mut names = after_crate(&code);
        names.extend(after_super(&code, source.module.len()));
        for name in names {
            // Re-exports at the root count as the module they come from.
            let target = match name.as_str() {
                "Error" => "error",
                "BranchAndBound" => "branch_and_bound",
                name => name,
            };
            if !allowed.contains(&target) && !MACROS.contains(&target) {
                wrong.push(format!("{}: uses `crate::{name}`", source.path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "imports against the floors:\n{}", wrong.join("\n"));
}

#[test]
fn circles_are_small() {
    let sources = sources();
    let file = |source: &Source| File {
        // The root of the crate is `lib.rs`.
        module: source.module.iter().filter(|name| *name != "lib").cloned().collect(),
        code: code(&source.text),
    };
    let files: Vec<File> = sources.iter().map(file).collect();
    let module = |k: usize| files[k].module.first().map_or("lib", String::as_str);
    let mut largest: BTreeMap<&str, usize> = (0..files.len()).map(|k| (module(k), 1)).collect();
    let mut wrong = Vec::new();
    for circle in circles(&files) {
        let size = largest.entry(module(circle[0])).or_default();
        *size = circle.len().max(*size);
        if circle.len() > CIRCLE {
            let names = circle.iter().map(|&k| files[k].module.join("::"));
            wrong.push(format!("{} files: {}", circle.len(), names.collect::<Vec<_>>().join(", ")));
        }
    }
    let sizes: Vec<String> = largest.iter().map(|(name, size)| format!("{name} {size}")).collect();
    println!("files on the largest circle of each module: {}", sizes.join(", "));
    assert!(wrong.is_empty(), "circles of more than {CIRCLE} files:\n{}", wrong.join("\n"));
}

#[test]
fn one_file_names_the_relaxation_library() {
    let mut naming = Vec::new();
    for source in sources() {
        let code = code(&source.text);
        // Our own module has the same name.
        let code = code.replace("pub use clarabel::ClarabelRelaxation;", "");
        let code = code.replace("super::clarabel::", "");
        if code.contains("clarabel::") {
            naming.push(source.module.join("::"));
        }
    }
    assert_eq!(naming, ["relaxation::clarabel"]);
}

/// The planner of the paper is built from what users can name.
#[test]
fn the_crate_that_users_add_uses_no_internals() {
    for source in sources_in("src", "") {
        let path = source.path.display();
        assert!(!code(&source.text).contains("internals"), "{path}");
    }
}

/// Formatting leaves comments as they are. Rows of tables cannot be broken.
#[test]
fn comments_end_at_column_100() {
    let is_wide = |line: &&str| {
        let text = line.trim_start();
        let row = text.trim_start_matches(['/', '!']).trim_start().starts_with('|');
        text.starts_with("//") && !row && line.chars().count() > 100
    };
    for source in sources() {
        let wide: Vec<&str> = source.text.lines().filter(is_wide).collect();
        assert!(wide.is_empty(), "{}: {wide:#?}", source.path.display());
    }
}

#[test]
fn files_stay_short() {
    let long: Vec<String> = sources()
        .iter()
        .filter(|source| source.text.lines().count() > LONGEST)
        .map(|source| format!("{}: {}", source.path.display(), source.text.lines().count()))
        .collect();
    assert!(long.is_empty(), "files over {LONGEST} lines:\n{}", long.join("\n"));
}

#[test]
fn the_check_sees_what_it_should() {
    let code = code(
        "use crate::error::Error; // crate::search\n/// [`x`](crate::search)\n\
         use crate::{\n    model::{Model, Name},\n    solution::Solution,\n};\n\
         fn f() { crate::solver::g() }",
    );
    assert_eq!(after_crate(&code), ["error", "model", "solution", "solver"]);
    assert_eq!(after_super("use super::super::hybrid::Wall;", 2), ["hybrid"]);
    assert_eq!(allowed("error").unwrap().last(), Some(&"error"));
    assert!(allowed("solution").unwrap().contains(&"model"));
    assert!(!allowed("solution").unwrap().contains(&"solver"));
    assert!(!allowed("hybrid").unwrap().contains(&"search"));
    assert!(!allowed("search").unwrap().contains(&"branch_and_bound"));
    assert_eq!(allowed("cellar"), None);
}
