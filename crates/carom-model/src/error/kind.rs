//! The kinds of errors, a variant each, with the text that says what went wrong.

use thiserror::Error;

use super::dead_end::DeadEnd;
use super::handle::foreign;
use super::robust::RobustError;
use super::run::RunError;
use super::scene::SceneError;
use super::terminal::TerminalError;
use crate::number::Exact;

/// The kind of an [`Error`](super::Error).
///
/// The text of a kind says what is wrong, and after a semicolon what to do.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A number that must be finite is NaN or infinite.
    #[error("{what} of `{name}` is {}; give a finite number", Exact(*.value))]
    NotFinite {
        /// The variable or statement.
        name: String,
        /// Which of its numbers.
        what: &'static str,
        /// The offending value.
        value: f64,
    },
    /// Lower bound above upper bound.
    #[error(
        "bounds of `{name}` are crossed: {} > {}; swap or relax them",
        Exact(*.lower), Exact(*.upper)
    )]
    CrossedBounds {
        /// The variable or statement.
        name: String,
        /// The lower end.
        lower: f64,
        /// The upper end.
        upper: f64,
    },
    /// A statement that contains no variable.
    #[error(
        "statement `{name}` has no variable left (all coefficients are zero); drop it, or check \
         the expression it was built from"
    )]
    EmptyRow {
        /// The statement.
        name: String,
    },
    /// A row without variables whose constant is outside its limits.
    #[error(
        "statement `{name}` has no variable left, and its constant {} is not within {} and {}; check \
         the expression it was built from",
        Exact(*.value), Exact(*.lower), Exact(*.upper)
    )]
    FalseRow {
        /// The statement.
        name: String,
        /// The constant.
        value: f64,
        /// The lower limit, or `-inf`.
        lower: f64,
        /// The upper limit, or `inf`.
        upper: f64,
    },
    /// A row with neither a lower nor an upper limit.
    #[error("statement `{name}` has no finite limit, so it says nothing; give it one or drop it")]
    UnlimitedRow {
        /// The statement.
        name: String,
    },
    /// A name used twice.
    #[error("the name `{name}` is already taken by another {kind}; choose another one")]
    DuplicateName {
        /// The name.
        name: String,
        /// `variable` or `statement`.
        kind: &'static str,
    },
    /// A name that is not one or several words with single blanks between them.
    #[error(
        "`{name}` cannot be a name: it must be one or several words with single blanks between them"
    )]
    InvalidName {
        /// The name.
        name: String,
    },
    /// No statement or variable of the model has this name.
    #[error("the model has no {kind} named `{name}`")]
    UnknownName {
        /// The name.
        name: String,
        /// `variable` or `statement`.
        kind: &'static str,
    },
    /// A handle of another model or hybrid system.
    #[error("{}", foreign(.kind, *.index, .place, .name.as_deref()))]
    ForeignHandle {
        /// `variable`, `constraint` or `indicator`.
        kind: &'static str,
        /// Position of the handle in its own model.
        index: usize,
        /// Where it was used.
        place: String,
        /// The name of a handle of a system that the model describes, where a variable of the model
        /// is needed.
        name: Option<String>,
    },
    /// A condition or logic on a variable that is not binary.
    #[error(
        "`{name}` is not binary; conditions and logic, as in `{place}`, take binary variables \
         only"
    )]
    NotBinary {
        /// The variable.
        name: String,
        /// The statement.
        place: String,
    },
    /// A product with a continuous factor.
    #[error(
        "`{name}` is continuous; the factor of the product `{place}` must be a binary or integer \
         variable"
    )]
    NotIntegral {
        /// The factor.
        name: String,
        /// The product.
        place: String,
    },
    /// The bounds of a parameter were set as if it were a variable.
    #[error(
        "`{name}` is a parameter; give it a value with `set_parameter` and a range with \
         `set_parameter_range`"
    )]
    IsParameter {
        /// The parameter.
        name: String,
    },
    /// A variable that is not a parameter was used as one.
    #[error("`{name}` is not a parameter; make it one with `Model::parameter`")]
    NotParameter {
        /// The variable.
        name: String,
    },
    /// A lowered form of a model that has changed since.
    #[error(
        "the model `{model}` was changed after it was lowered, so the lowered form and its \
         big-Ms are out of date; lower it again"
    )]
    Stale {
        /// The model.
        model: String,
    },
    /// A function or another statement needs a bound that a variable does not have.
    #[error(
        "`{function}` cannot be written as rows, because `{variable}` has no {bound} bound{chain}; \
         give {remedy} a finite one"
    )]
    UnboundedFunction {
        /// The variable that is the function, or the statement.
        function: String,
        /// The unbounded variable.
        variable: String,
        /// `lower` or `upper`: the missing bound.
        bound: &'static str,
        /// Why rows do not imply the bound, in words; empty if no row holds the variable.
        chain: String,
        /// The variables whose bounds would help, in words.
        remedy: String,
    },
    /// A function is infinite somewhere within the range of its argument.
    #[error("`{function}` has a pole between {:?} and {:?}; keep its argument on one side", .range.0, .range.1)]
    Pole {
        /// The function, with its variables.
        function: String,
        /// The ends of the range.
        range: (f64, f64),
    },
    /// A vertex of a `GraphOfSets` whose set may be unbounded.
    #[error(
        "coordinate {coordinate} of the vertex `{vertex}` has no {bound} bound; give it a finite \
         one, since only bounded sets can be switched off by perspectives"
    )]
    UnboundedSet {
        /// The vertex.
        vertex: String,
        /// The coordinate, from 0.
        coordinate: usize,
        /// `lower` or `upper`: the missing bound.
        bound: &'static str,
    },
    /// A logic formula that contains no variable.
    #[error(
        "the logic of `{name}` contains no binary variable; drop the statement, or check the \
         list it was built from"
    )]
    EmptyLogic {
        /// The statement.
        name: String,
    },
    /// A logic statement that is false whatever the binaries are.
    #[error(
        "statement `{name}` can never hold, whatever the values of its binaries; check its \
         counts, and look for binaries combined with their own negation"
    )]
    NeverTrue {
        /// The statement.
        name: String,
    },
    /// A logic formula that is nested too deeply.
    #[error(
        "the logic of `{name}` is nested more than {limit} levels deep; define parts of it with \
         binaries of their own (`part.iff(...)`)"
    )]
    TooDeep {
        /// The statement.
        name: String,
        /// The largest number of levels.
        limit: u32,
    },
    /// A statement that a file format cannot express.
    #[error(
        "{format} cannot express {what} `{name}`; write the lowered model instead \
         (`reformulate::lower(&model)?.model()`)"
    )]
    NotInFile {
        /// The file format.
        format: &'static str,
        /// The kind of statement.
        what: &'static str,
        /// The statement.
        name: String,
    },
    /// An objective that is not convex in the direction of optimisation.
    #[error(
        "the objective is not convex: in the {sense} direction its quadratic part has curvature \
         {curvature:.3e} along the direction {direction}; {help}"
    )]
    NotConvex {
        /// `minimize` or `maximize`.
        sense: &'static str,
        /// The curvature along the direction, in the objective's unit per unit of length squared.
        curvature: f64,
        /// The variable with the largest step in the direction.
        name: String,
        /// The variables of the direction with their steps, the largest ones first.
        direction: String,
        /// The advice on what to do.
        help: &'static str,
    },
    /// A quadratic row that no second-order cone expresses.
    #[error(
        "the quadratic row `{row}` is not convex: its left side minus its right side has curvature \
         {curvature:.3e} along the direction {direction}; write convex expressions on the smaller side, a \
         square or a product of expressions that are at least 0 on the larger one, or a disjunction of \
         rows (`either`)"
    )]
    NotCone {
        /// The row.
        row: String,
        /// The curvature along the direction, in the row's unit per unit of length squared.
        curvature: f64,
        /// The variable with the largest step in the direction.
        name: String,
        /// The variables of the direction with their steps, the largest ones first.
        direction: String,
    },
    /// A quadratic row that is a cone only where an expression has a sign that bounds do not show.
    #[error(
        "the quadratic row `{row}` is a cone only where {expression} cannot be negative, and the bounds of \
         its variables do not show that; give them bounds, or make it equal to a variable with the lower \
         bound 0"
    )]
    UnknownSign {
        /// The row.
        row: String,
        /// The expression, or the two factors of a product, in words.
        expression: String,
    },
    /// A comparison of a norm or of a quadratic expression that is no convex row.
    #[error("the row `{row}` {comparison}, which is not convex; {help}")]
    NotConicRow {
        /// The row.
        row: String,
        /// The comparison, in words.
        comparison: &'static str,
        /// The advice on what to do.
        help: &'static str,
    },
    /// An indicator's row has no finite big-M because a variable has no bound.
    #[error(
        "indicator `{indicator}` needs a big-M for its {side} side, but `{variable}` has no \
         {bound} bound{chain}; give {remedy} a finite one"
    )]
    UnboundedIndicator {
        /// The indicator.
        indicator: String,
        /// `lower` or `upper`: the side of the row.
        side: &'static str,
        /// The unbounded variable.
        variable: String,
        /// `lower` or `upper`: the missing bound.
        bound: &'static str,
        /// Why rows do not imply the bound, in words; empty if no row holds the variable.
        chain: String,
        /// The variables whose bounds would help, in words.
        remedy: String,
    },
    /// A user's big-M that the bounds do not justify.
    #[error(
        "the big-M {} given for the {side} side of indicator `{indicator}` is too small: the \
         bounds require at least {}; raise it, tighten the bounds of `{variable}`, or mark it \
         `assume_valid`", Exact(*.given), Exact(*.needed)
    )]
    UnsafeBigM {
        /// The indicator.
        indicator: String,
        /// `lower` or `upper`.
        side: &'static str,
        /// The user's value, in the row's unit.
        given: f64,
        /// The smallest value the bounds prove, in the row's unit.
        needed: f64,
        /// The variable that contributes most.
        variable: String,
    },
    /// A user cut that excludes a verified point of the model.
    #[error(
        "the user cut `{cut}`: {row} is wrong: a point of the model violates it by {}, with an \
         objective of {}; return only rows that every solution satisfies", Exact(*.amount),
        Exact(*.objective)
    )]
    WrongCut {
        /// The name of the cut.
        cut: String,
        /// The cut, as the text form of a model shows it.
        row: String,
        /// By how much the point violates it, in its unit.
        amount: f64,
        /// The objective of the point.
        objective: f64,
    },
    /// A number outside its range.
    #[error("{what} is {}; it must be {range}", Exact(*.value))]
    OutOfRange {
        /// The name of the number, as a noun phrase.
        what: String,
        /// Its value.
        value: f64,
        /// The lower limit, in the unit of the value; `None` if there is none. Whether it is
        /// allowed itself is said by `range`.
        lower: Option<f64>,
        /// The upper limit, likewise.
        upper: Option<f64>,
        /// The allowed range, in words, which may say more than the limits.
        range: String,
    },
    /// A matrix whose shape does not fit.
    #[error("{what} has shape {rows}x{columns}; expected {expected}")]
    Shape {
        /// The matrix.
        what: &'static str,
        /// Its number of rows.
        rows: usize,
        /// Its number of columns.
        columns: usize,
        /// The expected shape.
        expected: String,
    },
    /// A model file that cannot be read.
    ///
    /// Where a number is damaged, the source is a [`std::num::ParseFloatError`].
    #[error("line {line}, column {column}: {message}")]
    Parse {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The fault, and what was expected.
        message: String,
    },
    /// An operator of a model file that no statement of a model expresses.
    #[error("line {line}, column {column}: `{operator}` is not taken; {help}")]
    Operator {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The name of the operator.
        operator: String,
        /// The advice on what to do.
        help: &'static str,
    },
    /// A value was asked for, but the solution holds no point.
    #[error("there is no value to read: the solve ended without a point (`{termination}`)")]
    NoPoint {
        /// The termination status.
        termination: String,
    },
    /// A plan was asked for, but the search ended without one.
    #[error("the search ended without a plan (`{termination}`); {help}")]
    NoPlan {
        /// The termination status.
        termination: String,
        /// The advice on what to do.
        help: &'static str,
    },
    /// A shadow price or a reduced cost was asked for, but the solution has none.
    #[error(
        "the solution has no multipliers (`{termination}`); they come with an optimal solution of \
         `BranchAndBound` for a model without integers, such as `reformulate::relaxed(&model)`"
    )]
    NoMultipliers {
        /// The termination status.
        termination: String,
    },
    /// A model that a solver does not support.
    #[error("{solver} does not take {what}; {help}")]
    Unsupported {
        /// The solver.
        solver: String,
        /// The statement or feature that it does not take.
        what: String,
        /// The advice on what to do instead.
        help: String,
    },
    /// A variable of a hybrid system at a place where it has no meaning.
    #[error("{name} cannot stand in {place}; {help}")]
    Misplaced {
        /// The variable, in words.
        name: String,
        /// Where it was used.
        place: String,
        /// The advice on what to do instead.
        help: &'static str,
    },
    /// A list of a wrong length.
    #[error("the length of {what} is {found}; it must be {expected}")]
    Length {
        /// The list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length that was expected.
        expected: usize,
    },
    /// The matrices of a program do not fit into memory.
    ///
    /// The source is the error of the matrix library.
    #[error("the matrices of the program cannot be allocated; solve a smaller one")]
    Allocation,
    /// The operating system refused something.
    ///
    /// The source is a [`std::io::Error`].
    #[error("{what}; {help}")]
    Io {
        /// The action that failed, in words.
        what: String,
        /// The advice on what to do.
        help: &'static str,
    },
    /// Cases, a shard or a file that are none of a sweep.
    #[error("{what}; {help}")]
    Sweep {
        /// The reason, in words.
        what: String,
        /// The advice on what to do.
        help: &'static str,
    },
    /// A solver broke down, or answered something that its contract excludes.
    #[error("{solver} failed: {message}")]
    Backend {
        /// The solver.
        solver: String,
        /// The failure, in words.
        message: String,
    },
    /// A scene that contradicts itself, or a plan that its replay refuses.
    #[error(transparent)]
    Scene(SceneError),
    /// A run that is not what its hybrid system says.
    #[error(transparent)]
    Run(RunError),
    /// A program or a plan that does not hold for every disturbance.
    #[error(transparent)]
    Robust(RobustError),
    /// A system without the terminal cost or the terminal set.
    #[error(transparent)]
    Terminal(TerminalError),
    /// A simulation that has no end, because it cannot go on or does not know where.
    #[error(transparent)]
    DeadEnd(DeadEnd),
    /// An error of a type that the crate does not know, such as that of a solver outside the crate.
    ///
    /// The source is that error, and the [`Error`](super::Error) has the same text.
    #[error("another error; see its source")]
    Other,
}
