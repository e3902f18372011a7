//! The keywords that begin a section, in all spellings.

use super::lexer::{TokenKind, TypedToken};

/// The section that a keyword begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LpSection {
    Minimize,
    Maximize,
    Rows,
    Bounds,
    Integers,
    Binaries,
    SemiContinuous,
    /// Special ordered sets, and of which kind those are that do not say it.
    Sets(Option<u8>),
    /// Functions, which Gurobi calls general constraints.
    Functions,
    End,
    /// A section that cannot be read unless it is empty, and what to do instead.
    Refused(&'static str),
}

const SEMI_INTEGER_HELP: &str = "list its variables under `Semi-Continuous` and under `General`";
const LAZY_HELP: &str = "move its rows to `Subject To`, where they always hold";
const FUNCTION_HELP: &str = "write each function under `General Constraints`, as `y = PWL ( x ) : ( 0 , 0 ) \
                             ( 1 , 2 )`, and `y` in the objective";
const SCENARIO_HELP: &str = "a model has one objective and one set of limits; keep one";

/// Spellings of one word; sections of two words are below.
const ONE_WORD_SECTIONS: [(&str, LpSection); 42] = [
    ("minimize", LpSection::Minimize),
    ("minimise", LpSection::Minimize),
    ("minimum", LpSection::Minimize),
    ("min", LpSection::Minimize),
    ("maximize", LpSection::Maximize),
    ("maximise", LpSection::Maximize),
    ("maximum", LpSection::Maximize),
    ("max", LpSection::Maximize),
    ("st", LpSection::Rows),
    ("st.", LpSection::Rows),
    ("s.t", LpSection::Rows),
    ("s.t.", LpSection::Rows),
    ("bounds", LpSection::Bounds),
    ("bound", LpSection::Bounds),
    ("generals", LpSection::Integers),
    ("general", LpSection::Integers),
    ("gens", LpSection::Integers),
    ("gen", LpSection::Integers),
    ("integers", LpSection::Integers),
    ("integer", LpSection::Integers),
    ("ints", LpSection::Integers),
    ("int", LpSection::Integers),
    ("binaries", LpSection::Binaries),
    ("binary", LpSection::Binaries),
    ("bins", LpSection::Binaries),
    ("bin", LpSection::Binaries),
    ("end", LpSection::End),
    ("semis", LpSection::SemiContinuous),
    ("semi", LpSection::SemiContinuous),
    ("sos", LpSection::Sets(None)),
    ("sos1", LpSection::Sets(Some(1))),
    ("sos2", LpSection::Sets(Some(2))),
    ("lazy", LpSection::Refused(LAZY_HELP)),
    ("usercuts", LpSection::Refused(LAZY_HELP)),
    ("pwlobj", LpSection::Refused(FUNCTION_HELP)),
    ("pwl", LpSection::Refused(FUNCTION_HELP)),
    ("gencons", LpSection::Functions),
    ("gencon", LpSection::Functions),
    ("genconstr", LpSection::Functions),
    ("genconstrs", LpSection::Functions),
    ("scenario", LpSection::Refused(SCENARIO_HELP)),
    ("scenarios", LpSection::Refused(SCENARIO_HELP)),
];

/// Sections of two words, the second one in several spellings.
const TWO_WORD_SECTIONS: [(&str, &[&str], LpSection); 7] = [
    ("subject", &["to", "to:"], LpSection::Rows),
    ("such", &["that"], LpSection::Rows),
    ("lazy", &["constraints", "constraint"], LpSection::Refused(LAZY_HELP)),
    ("user", &["cuts", "cut"], LpSection::Refused(LAZY_HELP)),
    ("general", &["constraints", "constraint"], LpSection::Functions),
    ("generals", &["constraints", "constraint"], LpSection::Functions),
    ("multi", &["objectives"], LpSection::Refused(SCENARIO_HELP)),
];

/// Words that are part of the language without beginning a section.
const OTHER_KEYWORDS: [&str; 8] =
    ["free", "inf", "infinity", "nan", "subject", "such", "user", "multi"];

/// The section that the pieces begin, and how many of them its name takes.
pub(super) fn section(pieces: &[TypedToken<'_>]) -> Option<(LpSection, usize)> {
    let kind = |at: usize| pieces.get(at).map(|piece: &TypedToken<'_>| piece.kind);
    let is = |at: usize, word: &str| {
        kind(at) == Some(TokenKind::Word) && pieces[at].token.text.eq_ignore_ascii_case(word)
    };
    if kind(0) != Some(TokenKind::Word) || kind(1) == Some(TokenKind::Colon) {
        return None;
    }
    for (first, seconds, section) in TWO_WORD_SECTIONS {
        if is(0, first) && seconds.iter().any(|second| is(1, second)) {
            return Some((section, 2));
        }
    }
    let hyphenated = (is(0, "semi") && (is(2, "continuous") || is(2, "integer")))
        || (is(0, "multi") && is(2, "objectives"));
    if hyphenated && kind(1) == Some(TokenKind::Minus) {
        let section = match is(0, "semi") {
            true if is(2, "continuous") => LpSection::SemiContinuous,
            true => LpSection::Refused(SEMI_INTEGER_HELP),
            false => LpSection::Refused(SCENARIO_HELP),
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
