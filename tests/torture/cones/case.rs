//! A small program with cones as plain numbers.

use carom::model::{ConicRow, Method, Quadratic, Term, norm};
use carom::prelude::*;

use crate::common::case::{Case, Line};
use crate::common::quadratic_program::dot;

/// `coefficients.x + constant`.
#[derive(Debug, Clone)]
pub(crate) struct Form {
    pub(crate) coefficients: Vec<f64>,
    pub(crate) constant: f64,
}

/// A second-order cone, in the words in which it is written.
#[derive(Debug, Clone)]
pub(crate) enum Shape {
    /// `|tail| <= head`, or the same with both sides squared.
    Norm { tail: Vec<Form>, head: Form, is_squared: bool },
    /// `sum weight square^2 <= bound`, each weight positive.
    Convex { squares: Vec<(f64, Form)>, bound: Form },
    /// `|tail|^2 <= first * second`, which are at least 0 within the bounds.
    Product { tail: Vec<Form>, first: Form, second: Form },
}

/// A cone that holds if all of some binaries have these values.
#[derive(Debug, Clone)]
pub(crate) struct Guarded {
    pub(crate) condition: Vec<(usize, bool)>,
    pub(crate) big_m: Option<f64>,
    pub(crate) shape: Shape,
}

/// A disjunction: exactly one of the selectors is on, and the lines and cones of its term hold.
#[derive(Debug, Clone)]
pub(crate) struct Choice {
    pub(crate) selectors: Vec<usize>,
    pub(crate) terms: Vec<(Vec<Line>, Vec<Shape>)>,
    pub(crate) method: Method,
}

/// A program with cones. Its cost is that of the linear part, and weights times norms.
#[derive(Debug, Clone)]
pub(crate) struct ConicCase {
    pub(crate) base: Case,
    pub(crate) cones: Vec<Guarded>,
    pub(crate) choices: Vec<Choice>,
    pub(crate) norms: Vec<(f64, Vec<Form>)>,
    /// Columns that are parameters; their bounds are their value.
    pub(crate) parameters: Vec<usize>,
    /// The size of the values of continuous columns.
    pub(crate) units: Vec<f64>,
    /// A point that is feasible without any tolerance.
    pub(crate) witness: Option<Vec<f64>>,
}

impl Form {
    pub(crate) fn at(&self, x: &[f64]) -> f64 {
        dot(&self.coefficients, x) + self.constant
    }

    pub(crate) fn magnitude(&self, x: &[f64]) -> f64 {
        let terms = self.coefficients.iter().zip(x).map(|(a, x)| (a * x).abs());
        terms.sum::<f64>() + self.constant.abs()
    }

    pub(crate) fn affine(&self, variables: &[Variable]) -> Affine {
        let terms = self.coefficients.iter().zip(variables).filter(|(a, _)| **a != 0.0);
        terms.map(|(&a, &v)| a * v).sum::<Affine>() + self.constant
    }
}

pub(crate) fn length(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::hypot)
}

impl Shape {
    fn row(&self, variables: &[Variable]) -> ConicRow {
        let affine = |form: &Form| form.affine(variables);
        let sum = |tail: &[Form]| tail.iter().map(|form| affine(form).square()).sum::<Quadratic>();
        match self {
            Shape::Norm { tail, head, is_squared: false } => {
                norm(tail.iter().map(affine)).le(affine(head))
            }
            Shape::Norm { tail, head, .. } if head.coefficients.iter().all(|a| *a == 0.0) => {
                sum(tail).le(head.constant * head.constant)
            }
            Shape::Norm { tail, head, .. } => sum(tail).le(affine(head).square()),
            Shape::Convex { squares, bound } => {
                let square = |(weight, form): &(f64, Form)| *weight * affine(form).square();
                squares.iter().map(square).sum::<Quadratic>().le(affine(bound))
            }
            Shape::Product { tail, first, second } => sum(tail).le(affine(first) * affine(second)),
        }
    }

    /// By how much the cone is missed at a point, in the unit of its row, and the size of its
    /// terms.
    pub(crate) fn miss(&self, x: &[f64]) -> (f64, f64) {
        let size = |tail: &[Form]| tail.iter().map(|form| form.magnitude(x)).sum::<f64>();
        match self {
            Shape::Norm { tail, head, is_squared } => {
                let (all, limit) = (length(tail.iter().map(|form| form.at(x))), head.at(x));
                let size = size(tail) + head.magnitude(x);
                if *is_squared && limit >= 0.0 {
                    ((all - limit) * (all + limit), size * size)
                } else {
                    (all - limit, size)
                }
            }
            Shape::Convex { squares, bound } => {
                let value = |(weight, form): &(f64, Form)| weight * form.at(x).powi(2);
                let size = |(weight, form): &(f64, Form)| weight * form.magnitude(x).powi(2);
                let sum = squares.iter().map(value).sum::<f64>();
                (sum - bound.at(x), squares.iter().map(size).sum::<f64>() + bound.magnitude(x))
            }
            Shape::Product { tail, first, second } => {
                let sum = tail.iter().map(|form| form.at(x).powi(2)).sum::<f64>();
                let squared = size(tail).powi(2);
                let product = first.magnitude(x) * second.magnitude(x);
                (sum - first.at(x) * second.at(x), squared + product)
            }
        }
    }

    fn is_missed(&self, x: &[f64], tolerance: f64) -> Option<f64> {
        let (amount, size) = self.miss(x);
        let excess = amount - tolerance - 16.0 * f64::EPSILON * size;
        (excess.is_nan() || excess > 0.0).then_some(amount)
    }

    pub(crate) fn forms(&mut self) -> Vec<&mut Form> {
        match self {
            Shape::Norm { tail, head, .. } => tail.iter_mut().chain([head]).collect(),
            Shape::Convex { squares, bound } => {
                squares.iter_mut().map(|(_, form)| form).chain([bound]).collect()
            }
            Shape::Product { tail, first, second } => {
                tail.iter_mut().chain([first, second]).collect()
            }
        }
    }
}

impl Guarded {
    pub(crate) fn is_active(&self, x: &[f64]) -> bool {
        self.condition.iter().all(|&(j, on)| (x[j] > 0.5) == on)
    }
}

impl Choice {
    /// The selected term; `None` unless it is exactly one.
    pub(crate) fn selected(&self, x: &[f64]) -> Option<usize> {
        let mut on = (0..self.terms.len()).filter(|&k| x[self.selectors[k]] > 0.5);
        let first = on.next()?;
        on.next().is_none().then_some(first)
    }
}

impl ConicCase {
    /// The model, and its variables in the order of the columns.
    pub(crate) fn build(&self) -> Result<(Model, Vec<Variable>), Error> {
        let mut model = Model::new("cones");
        let mut variables = Vec::new();
        for (j, column) in self.base.columns.iter().enumerate() {
            let (lower, upper) = (column.lower, column.upper);
            let variable = match self.parameters.contains(&j) {
                true => {
                    let reach = 1.0_f64.max(lower.abs());
                    model.parameter(format!("v{j}"), lower, lower - reach, lower + reach)?
                }
                false => model.variable(format!("v{j}"), column.kind, lower, upper)?,
            };
            variables.push(variable);
        }
        for (i, line) in self.base.lines.iter().enumerate() {
            model.add(format!("r{i}"), line.row(&variables))?;
        }
        for (i, switch) in self.base.switches.iter().enumerate() {
            let binary = variables[switch.binary];
            let condition = if switch.on { binary.on() } else { binary.off() };
            model.add(format!("i{i}"), condition.implies(switch.line.row(&variables)))?;
        }
        for (i, cone) in self.cones.iter().enumerate() {
            let row = cone.shape.row(&variables);
            let literal = |&(j, on): &(usize, bool)| match on {
                true => variables[j].on(),
                false => variables[j].off(),
            };
            let name = format!("c{i}");
            let implication = match &cone.condition[..] {
                [] => {
                    model.add(name, row)?;
                    continue;
                }
                [one] => literal(one).implies(row),
                [one, two, ..] => (Logic::from(literal(one)) & literal(two)).implies(row),
            };
            match cone.big_m {
                Some(m) => model.add(name, implication.big_m(m))?,
                None => model.add(name, implication)?,
            };
        }
        for (i, choice) in self.choices.iter().enumerate() {
            let terms = choice.terms.iter().map(|(lines, shapes)| {
                let rows: Vec<Row> = lines.iter().map(|line| line.row(&variables)).collect();
                let rows = Term::from(rows);
                rows.and(shapes.iter().map(|shape| shape.row(&variables)).collect::<Vec<_>>())
            });
            let selectors = choice.selectors.iter().map(|&j| variables[j].on());
            let either = Either::of(terms).selected_by(selectors).by(choice.method);
            model.add(format!("e{i}"), either)?;
        }
        let affine = Form { coefficients: self.base.linear.clone(), constant: self.base.constant };
        let mut cost = Quadratic::from(affine.affine(&variables));
        for square in &self.base.squares {
            let inner =
                Form { coefficients: square.coefficients.clone(), constant: square.constant };
            cost += square.weight * inner.affine(&variables).square();
        }
        for (i, (weight, tail)) in self.norms.iter().enumerate() {
            let length = model.norm(format!("n{i}"), tail.iter().map(|f| f.affine(&variables)))?;
            cost += Quadratic::from(*weight * length);
        }
        if self.base.maximize {
            model.maximize(-cost)?;
        } else {
            model.minimize(cost)?;
        }
        Ok((model, variables))
    }

    /// The cost that is minimised.
    pub(crate) fn cost(&self, x: &[f64]) -> f64 {
        let norm =
            |(weight, tail): &(f64, Vec<Form>)| weight * length(tail.iter().map(|f| f.at(x)));
        self.base.cost(x) + self.norms.iter().map(norm).sum::<f64>()
    }

    /// The sum of the magnitudes of the terms of the cost.
    pub(crate) fn cost_size(&self, x: &[f64]) -> f64 {
        let linear = self.base.linear.iter().zip(x).map(|(c, x)| (c * x).abs()).sum::<f64>();
        let square = |coefficients: &[f64], constant: f64| {
            Form { coefficients: coefficients.to_vec(), constant }.magnitude(x).powi(2)
        };
        let squares = self.base.squares.iter();
        let squares = squares.map(|s| s.weight * square(&s.coefficients, s.constant));
        let norm = |(weight, tail): &(f64, Vec<Form>)| {
            weight * tail.iter().map(|f| f.magnitude(x)).sum::<f64>()
        };
        let norms = self.norms.iter().map(norm).sum::<f64>();
        linear + self.base.constant.abs() + squares.sum::<f64>() + norms
    }

    /// What a point violates beyond the tolerance, in words.
    pub(crate) fn violation(&self, x: &[f64], tolerance: f64) -> Option<String> {
        if let Some(violation) = self.base.violation(x, tolerance) {
            return Some(violation);
        }
        for (i, cone) in self.cones.iter().enumerate().filter(|(_, cone)| cone.is_active(x)) {
            if let Some(amount) = cone.shape.is_missed(x, tolerance) {
                return Some(format!("cone c{i} is missed by {amount}"));
            }
        }
        for (i, choice) in self.choices.iter().enumerate() {
            let Some(selected) = choice.selected(x) else {
                return Some(format!("not exactly one term of e{i} is selected"));
            };
            let (lines, shapes) = &choice.terms[selected];
            let excess = lines.iter().map(|line| line.excess(x, tolerance)).fold(0.0, f64::max);
            let missed = shapes.iter().find_map(|shape| shape.is_missed(x, tolerance));
            if excess > 0.0 || missed.is_some() {
                return Some(format!("e{i} is missed by {excess} or {missed:?}"));
            }
        }
        None
    }
}
