//! The keywords that begin a section, in all spellings.

use super::lexer::{Kind, Piece};

/// The section that a keyword begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    Minimize,
    Maximize,
    Rows,
    Bounds,
    Integers,
    Binaries,
    SemiContinuous,
    /// Special ordered sets, and of which kind those are that do not say it.
    Sets(Option<u8>),
    End,
    /// A section that cannot be read unless it is empty, and what to do instead.
    Refused(&'static str),
}

const SEMI_INTEGER_HELP: &str = "list its variables under `Semi-Continuous` and under `General`";
const LAZY_HELP: &str = "move its rows to `Subject To`, where they always hold";
const FUNCTION_HELP: &str = "functions cannot be read from LP files; write them as rows, or in a \
                         program with the functions of a model";
const SCENARIO_HELP: &str = "a model has one objective and one set of limits; keep one";

/// Spellings of one word; sections of two words are below.
const ONE_WORD_SECTIONS: [(&str, Section); 42] = [
    ("minimize", Section::Minimize),
    ("minimise", Section::Minimize),
    ("minimum", Section::Minimize),
    ("min", Section::Minimize),
    ("maximize", Section::Maximize),
    ("maximise", Section::Maximize),
    ("maximum", Section::Maximize),
    ("max", Section::Maximize),
    ("st", Section::Rows),
    ("st.", Section::Rows),
    ("s.t", Section::Rows),
    ("s.t.", Section::Rows),
    ("bounds", Section::Bounds),
    ("bound", Section::Bounds),
    ("generals", Section::Integers),
    ("general", Section::Integers),
    ("gens", Section::Integers),
    ("gen", Section::Integers),
    ("integers", Section::Integers),
    ("integer", Section::Integers),
    ("ints", Section::Integers),
    ("int", Section::Integers),
    ("binaries", Section::Binaries),
    ("binary", Section::Binaries),
    ("bins", Section::Binaries),
    ("bin", Section::Binaries),
    ("end", Section::End),
    ("semis", Section::SemiContinuous),
    ("semi", Section::SemiContinuous),
    ("sos", Section::Sets(None)),
    ("sos1", Section::Sets(Some(1))),
    ("sos2", Section::Sets(Some(2))),
    ("lazy", Section::Refused(LAZY_HELP)),
    ("usercuts", Section::Refused(LAZY_HELP)),
    ("pwlobj", Section::Refused(FUNCTION_HELP)),
    ("pwl", Section::Refused(FUNCTION_HELP)),
    ("gencons", Section::Refused(FUNCTION_HELP)),
    ("gencon", Section::Refused(FUNCTION_HELP)),
    ("genconstr", Section::Refused(FUNCTION_HELP)),
    ("genconstrs", Section::Refused(FUNCTION_HELP)),
    ("scenario", Section::Refused(SCENARIO_HELP)),
    ("scenarios", Section::Refused(SCENARIO_HELP)),
];

/// Sections of two words, the second one in several spellings.
const TWO_WORD_SECTIONS: [(&str, &[&str], Section); 7] = [
    ("subject", &["to", "to:"], Section::Rows),
    ("such", &["that"], Section::Rows),
    ("lazy", &["constraints", "constraint"], Section::Refused(LAZY_HELP)),
    ("user", &["cuts", "cut"], Section::Refused(LAZY_HELP)),
    ("general", &["constraints", "constraint"], Section::Refused(FUNCTION_HELP)),
    ("generals", &["constraints", "constraint"], Section::Refused(FUNCTION_HELP)),
    ("multi", &["objectives"], Section::Refused(SCENARIO_HELP)),
];

/// Words that are part of the language without beginning a section.
const OTHER_KEYWORDS: [&str; 8] =
    ["free", "inf", "infinity", "nan", "subject", "such", "user", "multi"];

/// The section that the pieces begin, and how many of them its name takes.
pub(super) fn section(pieces: &[Piece<'_>]) -> Option<(Section, usize)> {
    let kind = |at: usize| pieces.get(at).map(|piece: &Piece<'_>| piece.kind);
    let is = |at: usize, word: &str| {
        kind(at) == Some(Kind::Word) && pieces[at].token.text.eq_ignore_ascii_case(word)
    };
    if kind(0) != Some(Kind::Word) || kind(1) == Some(Kind::Colon) {
        return None;
    }
    for (first, seconds, section) in TWO_WORD_SECTIONS {
        if is(0, first) && seconds.iter().any(|second| is(1, second)) {
            return Some((section, 2));
        }
    }
    let hyphenated = (is(0, "semi") && (is(2, "continuous") || is(2, "integer")))
        || (is(0, "multi") && is(2, "objectives"));
    if hyphenated && kind(1) == Some(Kind::Minus) {
        let section = match is(0, "semi") {
            true if is(2, "continuous") => Section::SemiContinuous,
            true => Section::Refused(SEMI_INTEGER_HELP),
            false => Section::Refused(SCENARIO_HELP),
        };
        return Some((section, 3));
    }
    let found = ONE_WORD_SECTIONS.iter().find(|(word, _)| is(0, word));
    found.map(|&(_, section)| (section, 1))
}

/// Whether a name would be taken for something else.
pub(super) fn is_keyword(text: &str) -> bool {
    let words = ONE_WORD_SECTIONS.iter().map(|(word, _)| word).chain(&OTHER_KEYWORDS);
    words.into_iter().any(|word| word.eq_ignore_ascii_case(text))
}
