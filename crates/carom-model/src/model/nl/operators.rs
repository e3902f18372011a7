//! The operators of expressions: which are taken, and the names of the others.

use super::cursor::Cursor;
use crate::elementary::Elementary;
use crate::error::{Error, ErrorKind};

/// An operator that is taken.
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
    Minimum,
    Maximum,
    Absolute,
    DecimalLogarithm,
    Atan2,
    Elementary(NlFunction),
}

/// A function of one expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NlFunction {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Sqrt,
}

impl NlFunction {
    const ALL: [(i64, NlFunction); 12] = [
        (37, NlFunction::Tanh),
        (38, NlFunction::Tan),
        (39, NlFunction::Sqrt),
        (40, NlFunction::Sinh),
        (41, NlFunction::Sin),
        (43, NlFunction::Ln),
        (44, NlFunction::Exp),
        (45, NlFunction::Cosh),
        (46, NlFunction::Cos),
        (49, NlFunction::Atan),
        (51, NlFunction::Asin),
        (53, NlFunction::Acos),
    ];

    /// The function of the format that one of a model is; the square root for all powers.
    pub(super) fn of(function: &Elementary) -> Option<NlFunction> {
        let is_same = |known: &NlFunction| match (function, known) {
            (Elementary::Power(_), NlFunction::Sqrt) => true,
            _ => known.function() == *function,
        };
        NlFunction::ALL.into_iter().map(|(_, known)| known).find(is_same)
    }

    /// Its number.
    pub(super) fn code(self) -> i64 {
        NlFunction::ALL.into_iter().find(|(_, own)| *own == self).map_or(0, |(code, _)| code)
    }

    pub(super) fn function(self) -> Elementary {
        match self {
            NlFunction::Sin => Elementary::Sin,
            NlFunction::Cos => Elementary::Cos,
            NlFunction::Tan => Elementary::Tan,
            NlFunction::Asin => Elementary::Asin,
            NlFunction::Acos => Elementary::Acos,
            NlFunction::Atan => Elementary::Atan,
            NlFunction::Sinh => Elementary::Sinh,
            NlFunction::Cosh => Elementary::Cosh,
            NlFunction::Tanh => Elementary::Tanh,
            NlFunction::Exp => Elementary::Exp,
            NlFunction::Ln => Elementary::Ln,
            NlFunction::Sqrt => Elementary::Power(0.5),
        }
    }
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
            78 => Operator::Power,
            11 => Operator::Minimum,
            12 => Operator::Maximum,
            15 => Operator::Absolute,
            42 => Operator::DecimalLogarithm,
            48 => Operator::Atan2,
            code => {
                let known = NlFunction::ALL.into_iter().find(|(own, _)| *own == code)?;
                Operator::Elementary(known.1)
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
