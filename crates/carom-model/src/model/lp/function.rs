//! A function under `General Constraints`, as the file has it.

use crate::model::text::token::Token;

/// `result = KIND ( arguments )` as the file has it.
#[derive(Debug)]
pub(super) struct LpFunction<'a> {
    /// Its label, or the result.
    pub(super) place: Token<'a>,
    pub(super) is_named: bool,
    pub(super) result: usize,
    pub(super) kind: LpFunctionKind,
    pub(super) arguments: Vec<LpArgument>,
    /// The points of a piecewise function.
    pub(super) points: Vec<(f64, f64)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LpFunctionKind {
    Maximum,
    Minimum,
    Absolute,
    And,
    Or,
    /// The sum of magnitudes.
    OneNorm,
    /// The largest magnitude.
    LargestNorm,
    Piecewise,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum LpArgument {
    Column(usize),
    Number(f64),
}
