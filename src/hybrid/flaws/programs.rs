//! The small programs behind the search for flaws, and the checks of their answers.

use super::piece::{AffineMap, Facet, Piece, Units, base, common, next_state, piece};
use crate::error::{Error, ErrorKind};
use crate::hybrid::system::HybridSystem;
use crate::interval::Interval;
use crate::model::{Affine, Either, Model, Row, Term, Variable};
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

fn sum(factors: &[f64], point: &[Variable], constant: f64) -> Affine {
    let mut sum = Affine::constant(constant);
    let terms = factors.iter().zip(point).filter(|(factor, _)| **factor != 0.0);
    terms.for_each(|(factor, variable)| sum.add_term(*factor, *variable));
    sum
}

/// The expression that a facet limits from above by 0.
fn violation(facet: &Facet, point: &[Variable]) -> Affine {
    sum(&facet.normal, point, -facet.limit)
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

/// Whether no inputs complete a state to a point of a piece, by more than the margin.
pub(super) fn is_empty_at(
    piece: &Piece,
    state: &[f64],
    size: usize,
    solver: &mut dyn Solver,
) -> Result<bool, Error> {
    if piece.is_empty(false) {
        return Ok(true);
    }
    let mut model = Model::new("completion");
    let missing = model.continuous("missing", 0.0, WIDEST)?;
    let point: Vec<Variable> = model.continuous_family("point", size, 0.0, 1.0)?.iter().collect();
    for (&variable, &value) in point.iter().zip(state) {
        model.fix(variable, value)?;
    }
    for (k, facet) in piece.facets(false).enumerate() {
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

/// The point of a piece at which an affine function of the unit box is the largest, if it is more
/// than 0 there.
pub(super) fn largest(
    base: &Piece,
    piece: &Piece,
    map: &AffineMap,
    solver: &mut dyn Solver,
) -> Result<Option<Found>, Error> {
    if base.is_empty(true) || piece.is_empty(true) || map.range().upper <= MARGIN {
        return Ok(None);
    }
    let mut question = Question::new(base, map.factors.len())?;
    for (k, facet) in piece.facets(true).enumerate() {
        let row = violation(facet, &question.point).le(0.0);
        question.model.add(("inside", k), row)?;
    }
    let value = sum(&map.factors, &question.point, map.constant);
    question.model.add("beyond", value.ge(question.margin))?;
    let point = question.solve(solver)?;
    let inside = |point: &[f64]| piece.facets(true).all(|facet| facet.violation(point) <= MARGIN);
    let point = point.filter(|point| inside(point));
    Ok(checked(base, point, |point| map.value(point)))
}

/// Steps of a run: for each one its number and, for each choice, the transitions that may be taken,
/// by their positions.
pub(super) type Steps = Vec<(usize, Vec<Vec<usize>>)>;

/// Whether there is a run of these steps, modes and events left aside.
pub(super) fn is_possible(
    system: &HybridSystem,
    steps: &Steps,
    solver: &mut dyn Solver,
) -> Result<bool, Error> {
    let mut model = Model::new("run");
    let missing = model.continuous("missing", 0.0, WIDEST)?;
    let (n, size) = (system.states.len(), system.states.len() + system.inputs.len());
    let mut next: Vec<Affine> = Vec::new();
    for (k, (step, allowed)) in steps.iter().enumerate() {
        let units = Units::new(system, *step);
        let point = model.continuous_family(&format!("point{k}"), size, 0.0, 1.0)?;
        let point: Vec<Variable> = point.iter().collect();
        for (i, (value, &state)) in next.iter().zip(&point).enumerate() {
            let name = |side| (format!("{side}_{k}"), i);
            model.add(name("above"), (value - state).le(missing))?;
            model.add(name("below"), (state - value).le(missing))?;
        }
        let limits = base(system, &units, *step);
        if limits.is_empty(true) {
            return Ok(false);
        }
        for (i, facet) in limits.facets(true).enumerate() {
            model.add((format!("base{k}"), i), violation(facet, &point).le(missing))?;
        }
        let mut parts = Vec::new();
        for (c, allowed) in allowed.iter().enumerate() {
            let place = Place { system, units: &units, step: *step, point: &point, missing };
            let name = format!("choice{k}_{c}");
            match place.add_choice(&mut model, &name, c, allowed)? {
                Some(part) => parts.push(part),
                None => return Ok(false),
            }
        }
        let common = common(system).filter(|_| parts.len() > 1);
        next = (0..n)
            .map(|i| {
                let sum: Affine = parts.iter().map(|part| part[i].clone()).sum();
                match &common {
                    None => sum,
                    Some(common) => {
                        let map = in_units(&units.scaled(&common[i]), &units, i);
                        sum - (parts.len() as f64 - 1.0)
                            * self::sum(&map.factors, &point, map.constant)
                    }
                }
            })
            .collect();
    }
    // The last sample lies in the domain and satisfies the limits on states.
    let after = steps.last().map_or(0, |(step, _)| step + 1);
    for (i, value) in next.iter().enumerate() {
        model.add(("last_above", i), (value - 1.0).le(missing))?;
        model.add(("last_below", i), (-1.0 * value).le(missing))?;
    }
    let limits = system.limits.iter().filter(|limit| !limit.is_joint(n)).enumerate();
    for (k, limit) in limits {
        let units = Units::new(system, after);
        let mut piece = Piece::default();
        let mut factors = limit.normal.clone();
        factors.resize(size, 0.0);
        piece.cut(&units, &AffineMap { factors, constant: 0.0 }, limit.limit_at(after), false);
        for (i, facet) in piece.facets(true).enumerate() {
            let terms = facet.normal.iter().zip(&next).map(|(factor, value)| *factor * value);
            let value: Affine = terms.sum();
            model.add((format!("last_limit{k}"), i), (value - facet.limit).le(missing))?;
        }
    }
    model.minimize(missing)?;
    let solution = solver.solve(&model)?;
    match answer(&solution)? {
        Some(solution) => Ok(solution.value(missing)? <= MARGIN),
        None => Ok(false),
    }
}

/// A next state in units of its domain.
fn in_units(map: &AffineMap, units: &Units, state: usize) -> AffineMap {
    let width = if units.width[state] > 0.0 { units.width[state] } else { 1.0 };
    let factors = map.factors.iter().map(|n| n / width).collect();
    AffineMap { factors, constant: (map.constant - units.lower[state]) / width }
}

/// One step of a run in a program.
struct Place<'a> {
    system: &'a HybridSystem,
    units: &'a Units,
    step: usize,
    point: &'a [Variable],
    missing: Variable,
}

impl Place<'_> {
    /// Adds the transitions of a choice. Returns the next state to which they lead, in units of the
    /// domains; `None` if none of them is possible.
    fn add_choice(
        &self,
        model: &mut Model,
        name: &str,
        choice: usize,
        allowed: &[usize],
    ) -> Result<Option<Vec<Affine>>, Error> {
        let Some(choice) = self.system.choices.get(choice) else { return Ok(None) };
        let mut ways: Vec<(Vec<Row>, Vec<AffineMap>)> = Vec::new();
        for transition in allowed.iter().filter_map(|&k| choice.transitions.get(k)) {
            let piece = piece(self.system, self.units, choice, transition, self.step);
            if piece.is_empty(true) {
                continue;
            }
            let facets = piece.facets(true);
            let rows = facets.map(|facet| violation(facet, self.point).le(self.missing));
            let maps = next_state(self.system, transition, self.step);
            let maps = maps.iter().enumerate();
            let maps = maps.map(|(i, map)| in_units(&self.units.scaled(map), self.units, i));
            ways.push((rows.collect(), maps.collect()));
        }
        let expression = |map: &AffineMap| sum(&map.factors, self.point, map.constant);
        if ways.len() <= 1 {
            let Some((rows, maps)) = ways.pop() else { return Ok(None) };
            for (k, row) in rows.into_iter().enumerate() {
                model.add((name, k), row)?;
            }
            return Ok(Some(maps.iter().map(expression).collect()));
        }
        let states = self.system.states.len();
        let mut next = Vec::new();
        for i in 0..states {
            let ranges = ways.iter().map(|(_, maps)| maps[i].range());
            let range = ranges.reduce(|a, b| a.hull(b)).unwrap_or(Interval::REALS);
            next.push(model.continuous((format!("{name}_next"), i), range.lower, range.upper)?);
        }
        let terms = ways.into_iter().map(|(mut rows, maps)| {
            rows.extend(next.iter().zip(&maps).map(|(next, map)| next.equals(expression(map))));
            Term::from(rows)
        });
        model.add(name, Either::of(terms))?;
        Ok(Some(next.into_iter().map(Affine::from).collect()))
    }
}
