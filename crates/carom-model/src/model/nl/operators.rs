//! The operators of expressions: which are taken, and the names of the others.

use super::cursor::Cursor;
use crate::error::{Error, ErrorKind};

/// An operator that makes affine and quadratic expressions of such.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operator {
    Plus,
    Minus,
    Times,
    Divide,
    Power,
    Negate,
    Sum,
    Square,
}

impl Operator {
    /// The operator with a number, if it is taken.
    pub(super) fn of(code: i64) -> Option<Operator> {
        Some(match code {
            0 => Operator::Plus,
            1 => Operator::Minus,
            2 => Operator::Times,
            3 => Operator::Divide,
            5 | 76 => Operator::Power,
            16 => Operator::Negate,
            54 => Operator::Sum,
            77 => Operator::Square,
            _ => return None,
        })
    }

    /// The number of arguments, or `None` if the file says it.
    pub(super) fn arity(self) -> Option<usize> {
        match self {
            Operator::Sum => None,
            Operator::Negate | Operator::Square => Some(1),
            _ => Some(2),
        }
    }
}

/// The names of operators that are refused, by number.
const OTHERS: [(i64, &str); 54] = [
    (4, "mod"),
    (6, "less"),
    (11, "min"),
    (12, "max"),
    (13, "floor"),
    (14, "ceil"),
    (15, "abs"),
    (20, "or"),
    (21, "and"),
    (22, "<"),
    (23, "<="),
    (24, "="),
    (28, ">="),
    (29, ">"),
    (30, "!="),
    (34, "not"),
    (35, "if"),
    (37, "tanh"),
    (38, "tan"),
    (39, "sqrt"),
    (40, "sinh"),
    (41, "sin"),
    (42, "log10"),
    (43, "log"),
    (44, "exp"),
    (45, "cosh"),
    (46, "cos"),
    (47, "atanh"),
    (48, "atan2"),
    (49, "atan"),
    (50, "asinh"),
    (51, "asin"),
    (52, "acosh"),
    (53, "acos"),
    (55, "div"),
    (56, "precision"),
    (57, "round"),
    (58, "trunc"),
    (59, "count"),
    (60, "numberof"),
    (61, "numberof"),
    (62, "atleast"),
    (63, "atmost"),
    (64, "a piecewise-linear term"),
    (65, "if"),
    (66, "exactly"),
    (67, "!atleast"),
    (68, "!atmost"),
    (69, "!exactly"),
    (70, "forall"),
    (71, "exists"),
    (72, "==>"),
    (73, "<==>"),
    (74, "alldiff"),
];

/// The error about an operator that is not taken.
pub(super) fn refused(cursor: &Cursor<'_>, place: usize, code: i64) -> Error {
    let name = OTHERS.iter().find(|(number, _)| *number == code);
    let name = match (name, code) {
        (Some((_, name)), _) => (*name).to_owned(),
        (None, 78) => "^".to_owned(),
        (None, _) => return cursor.error(place, format!("there is no operator `o{code}`")),
    };
    let help = match code {
        11 | 12 | 15 | 64 => {
            "expressions have to be affine or quadratic: write it as linear rows, or state it as a function \
             of a `Model`"
        }
        20..=35 | 59..=63 | 65.. => {
            "logic is not read: write it as linear rows over binaries, or state it in a `Model`"
        }
        _ => {
            "expressions have to be affine or quadratic: replace it by a piecewise linear function"
        }
    };
    not_taken(cursor, place, name, help)
}

/// The error about an operator that is taken, but not with these arguments.
pub(super) fn not_taken(
    cursor: &Cursor<'_>,
    place: usize,
    operator: impl Into<String>,
    help: &'static str,
) -> Error {
    let (line, column) = cursor.line_and_column(place);
    ErrorKind::Operator { line, column, operator: operator.into(), help }.into()
}
