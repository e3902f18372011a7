//! The operators of expressions: which are taken, and the names of the others.

use super::cursor::Cursor;
use crate::elementary::Elementary;
use crate::error::{Error, ErrorKind};

/// An operator that is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operator {
    Plus,
    Minus,
    Times,
    Divide,
    Power,
    Negate,
    Sum,
    Square,
    Minimum,
    Maximum,
    Absolute,
    DecimalLogarithm,
    Atan2,
    Elementary(&'static Elementary),
}

/// The functions of one expression, with their numbers.
pub(super) static FUNCTIONS: [(i64, Elementary); 12] = [
    (37, Elementary::Tanh),
    (38, Elementary::Tan),
    (39, Elementary::Power(0.5)),
    (40, Elementary::Sinh),
    (41, Elementary::Sin),
    (43, Elementary::Ln),
    (44, Elementary::Exp),
    (45, Elementary::Cosh),
    (46, Elementary::Cos),
    (49, Elementary::Atan),
    (51, Elementary::Asin),
    (53, Elementary::Acos),
];

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
            78 => Operator::Power,
            11 => Operator::Minimum,
            12 => Operator::Maximum,
            15 => Operator::Absolute,
            42 => Operator::DecimalLogarithm,
            48 => Operator::Atan2,
            code => {
                let known = FUNCTIONS.iter().find(|(own, _)| *own == code)?;
                Operator::Elementary(&known.1)
            }
        })
    }

    /// The number of arguments, or `None` if the file says it.
    pub(super) fn arity(self) -> Option<usize> {
        match self {
            Operator::Sum | Operator::Minimum | Operator::Maximum => None,
            Operator::Negate
            | Operator::Square
            | Operator::Absolute
            | Operator::DecimalLogarithm
            | Operator::Elementary(_) => Some(1),
            _ => Some(2),
        }
    }
}

/// The names of operators that are refused, by number.
const OTHERS: [(i64, &str); 37] = [
    (4, "mod"),
    (6, "less"),
    (13, "floor"),
    (14, "ceil"),
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
    (47, "atanh"),
    (50, "asinh"),
    (52, "acosh"),
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
        64 => "write it as linear rows, or state it as a piecewise-affine function of a `Model`",
        20..=35 | 59..=63 | 65.. => {
            "logic is not read: write it as linear rows over binaries, or state it in a `Model`"
        }
        _ => "replace it by functions that are taken, or by a piecewise linear one",
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
