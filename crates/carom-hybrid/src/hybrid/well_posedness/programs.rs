//! The small programs behind the search for flaws, and the checks of their answers.

use super::piece::{Facet, Piece};
use crate::error::{Error, ErrorKind};
use crate::model::{Affine, Either, Model, Row, Variable};
use crate::solution::Solution;
use crate::solver::Solver;

/// Margins up to this are none, as a fraction of the widths of domains and ranges. It is above the
/// feasibility tolerance of the programs.
pub(super) const MARGIN: f64 = 1e-5;

/// The largest margin that a program looks for; wider than the unit box.
const WIDEST: f64 = 4.0;

/// A point of the unit box, and a margin that was computed from it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    pub(super) point: Vec<f64>,
    pub(super) margin: f64,
}

/// The expression that a facet limits from above by 0.
fn violation(facet: &Facet, point: &[Variable]) -> Affine {
    let mut sum = Affine::constant(-facet.limit);
    let terms = facet.normal.iter().zip(point).filter(|(factor, _)| **factor != 0.0);
    terms.for_each(|(factor, variable)| sum.add_term(*factor, *variable));
    sum
}

/// The point of an optimal solution; `None` if there is none.
fn answer(solution: &Solution) -> Result<Option<&Solution>, Error> {
    if solution.is_infeasible() {
        return Ok(None);
    }
    if solution.is_optimal() {
        return Ok(Some(solution));
    }
    let termination = solution.termination().to_string();
    Err(ErrorKind::NoPoint { termination }.into())
}

/// A program over the unit box with a margin to be maximised.
struct Question {
    model: Model,
    point: Vec<Variable>,
    margin: Variable,
}

impl Question {
    fn new(base: &Piece, size: usize) -> Result<Self, Error> {
        let mut model = Model::new("flaws");
        let point = model.continuous_family("point", size, 0.0, 1.0)?.iter().collect();
        let margin = model.continuous("margin", 0.0, WIDEST)?;
        let mut question = Question { model, point, margin };
        for (k, facet) in base.facets(true).enumerate() {
            let row = violation(facet, &question.point).le(0.0);
            question.model.add(("base", k), row)?;
        }
        Ok(question)
    }

    /// The point with the largest margin, moved into the box.
    fn solve(mut self, solver: &mut dyn Solver) -> Result<Option<Vec<f64>>, Error> {
        self.model.maximize(self.margin)?;
        let solution = solver.solve(&self.model)?;
        let Some(solution) = answer(&solution)? else { return Ok(None) };
        let values = self.point.iter().map(|&variable| solution.value(variable));
        values.map(|value| Ok(value?.clamp(0.0, 1.0))).collect::<Result<_, Error>>().map(Some)
    }
}

/// Keeps a point only if its margin, computed from the point itself, is one, and if it lies in the
/// base.
fn checked(base: &Piece, point: Option<Vec<f64>>, margin: impl Fn(&[f64]) -> f64) -> Option<Found> {
    let point = point?;
    let margin = margin(&point);
    let is_inside = base.facets(true).all(|facet| facet.violation(&point) <= MARGIN);
    (margin > MARGIN && is_inside).then_some(Found { point, margin })
}

/// The point of the base that is the farthest from all pieces, without their limits for the
/// planner.
pub(super) fn gap(
    base: &Piece,
    pieces: &[&Piece],
    size: usize,
    solver: &mut dyn Solver,
) -> Result<Option<Found>, Error> {
    let open = |piece: &&&Piece| !piece.is_empty(false);
    if base.is_empty(true)
        || pieces.iter().filter(open).any(|piece| piece.facets(false).next().is_none())
    {
        return Ok(None);
    }
    let mut question = Question::new(base, size)?;
    for (k, piece) in pieces.iter().filter(open).enumerate() {
        let (point, margin) = (&question.point, question.margin);
        let rows = piece.facets(false).map(|facet| violation(facet, point).ge(margin));
        let rows: Vec<Row> = rows.collect();
        match <[Row; 1]>::try_from(rows) {
            Ok([row]) => {
                question.model.add(("outside", k), row)?;
            }
            Err(rows) => {
                question.model.add(("outside", k), Either::of(rows))?;
            }
        }
    }
    let point = question.solve(solver)?;
    let violated = |piece: &Piece, point: &[f64]| {
        piece.facets(false).map(|facet| facet.violation(point)).fold(f64::NEG_INFINITY, f64::max)
    };
    Ok(checked(base, point, |point| {
        let distances = pieces.iter().filter(open).map(|piece| violated(piece, point));
        distances.fold(WIDEST, f64::min)
    }))
}

/// Whether no point of a piece begins with these coordinates, by more than the margin.
pub(super) fn is_empty_at(
    piece: &Piece,
    first: &[f64],
    size: usize,
    with_limits: bool,
    solver: &mut dyn Solver,
) -> Result<bool, Error> {
    if piece.is_empty(with_limits) {
        return Ok(true);
    }
    let mut model = Model::new("completion");
    let missing = model.continuous("missing", 0.0, WIDEST)?;
    let point: Vec<Variable> = model.continuous_family("point", size, 0.0, 1.0)?.iter().collect();
    for (&variable, &value) in point.iter().zip(first) {
        model.fix(variable, value)?;
    }
    for (k, facet) in piece.facets(with_limits).enumerate() {
        model.add(("inside", k), violation(facet, &point).le(missing))?;
    }
    model.minimize(missing)?;
    let solution = solver.solve(&model)?;
    match answer(&solution)? {
        Some(solution) => Ok(solution.value(missing)? > MARGIN),
        None => Ok(true),
    }
}

/// The point of the base that is the farthest inside two pieces.
pub(super) fn overlap(
    base: &Piece,
    pieces: [&Piece; 2],
    size: usize,
    solver: &mut dyn Solver,
) -> Result<Option<Found>, Error> {
    if base.is_empty(true) || pieces.iter().any(|piece| piece.is_empty(true)) {
        return Ok(None);
    }
    let mut question = Question::new(base, size)?;
    for (k, facet) in pieces.iter().flat_map(|piece| piece.facets(true)).enumerate() {
        let row = (violation(facet, &question.point) + question.margin).le(0.0);
        question.model.add(("inside", k), row)?;
    }
    let point = question.solve(solver)?;
    Ok(checked(base, point, |point| {
        let facets = pieces.iter().flat_map(|piece| piece.facets(true));
        facets.map(|facet| -facet.violation(point)).fold(WIDEST, f64::min)
    }))
}
