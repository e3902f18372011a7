//! The codes of messages are the sections of the page "Help". That each kind of message has a code
//! is seen to by the compiler, because the functions that give it match all kinds.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The files with functions `code`.
const CODES: [&str; 3] = [
    "crates/carom-model/src/error/code.rs",
    "crates/carom-model/src/solution/note.rs",
    "crates/carom-hybrid/src/hybrid/well_posedness/ill_posedness.rs",
];

/// The status in the last line of the program `carom`, and how its warnings begin.
const OF_THE_PROGRAM: [&str; 6] =
    ["optimal", "infeasible", "unbounded", "feasible", "limit", "warning"];

fn text(file: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect(file)
}

/// The words that arms of matches are: what stands in quotes behind an arrow, alone.
fn codes(text: &str) -> Vec<String> {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ").replace("=> { ", "=> ");
    let arms = text.split("=> \"").skip(1).filter_map(|rest| rest.split_once('"'));
    let words = arms.filter(|(_, rest)| rest.starts_with(',') || rest.starts_with(" }"));
    words.map(|(word, _)| word.to_owned()).collect()
}

#[test]
fn each_code_is_a_section_of_help_and_each_section_a_code() {
    let mut all: BTreeSet<String> = OF_THE_PROGRAM.map(str::to_owned).into();
    for file in CODES {
        let own = codes(&text(file));
        assert!(!own.is_empty(), "no codes in {file}");
        all.extend(own);
    }
    let page = text("docs/help.md");
    let sections = page.lines().filter_map(|line| line.strip_prefix("## `")?.strip_suffix('`'));
    let list: Vec<String> = sections.map(str::to_owned).collect();
    let sections: BTreeSet<String> = list.iter().cloned().collect();
    assert_eq!(list.len(), sections.len(), "a section is there twice");
    assert_eq!(all, sections);
    // An anchor of the page, as it stands.
    let is_word =
        |code: &str| code.bytes().all(|letter| letter.is_ascii_lowercase() || letter == b'-');
    assert!(all.iter().all(|code| is_word(code)), "{all:?}");
}
