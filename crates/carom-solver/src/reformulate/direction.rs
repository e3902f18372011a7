//! Which functions can be relaxed to one side, and how a point is moved back onto them.
//!
//! Takes the functions of a model; leaves, for each of them, the sides that need rows.
//!
//! A variable `w = f(...)` with `f` convex can be relaxed to `w >= f(...)` if decreasing `w` alone
//! never harms: it does not worsen the objective and violates no row, indicator or other function.
//! Then decreasing `w` to `f(...)` turns every point of the relaxed model into a point of the
//! original that is at least as good, so optimum, infeasibility and unboundedness are the same.
//! Concave functions are the mirror image. Each lowering checks this on the whole model, so users
//! cannot declare it wrongly.

use crate::error::Error;
use crate::interval::Interval;
use crate::model::{Affine, Function, FunctionRef, Model, StoredConic, Variable};

/// The relation between a function and its variable in the lowered model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tie {
    /// `w = f`.
    Exact,
    /// `w >= f`; the point is restored by lowering `w`.
    Above,
    /// `w <= f`; the point is restored by raising `w`.
    Below,
}

/// Whether moving a variable alone can violate a statement or worsen the objective.
pub(super) struct Harm {
    pub(super) lowering: Vec<bool>,
    raising: Vec<bool>,
}

impl Harm {
    /// The harm to the objective and to all statements but rows and functions.
    pub(super) fn without_rows(model: &Model) -> Harm {
        let count = model.variable_count();
        let mut harm = Harm { lowering: vec![false; count], raising: vec![false; count] };
        let objective = model.objective();
        for (variable, coefficient) in objective.affine().terms() {
            harm.rise(variable, model.sense().sign() * coefficient);
        }
        for (first, second, _) in objective.products() {
            harm.any(first);
            harm.any(second);
        }
        model.indicators().for_each(|row| harm.row(row.terms(), row.limits()));
        model.conic_constraints().for_each(|conic| harm.conic(conic.conic()));
        for term in model.disjunctions().flat_map(|disjunction| disjunction.stored_terms()) {
            term.for_each_row(&mut |row| harm.row(&row.terms, Interval::new(row.lower, row.upper)));
            term.for_each_conic(&mut |conic| harm.conic(conic));
        }
        let sets = model.special_ordered_sets();
        sets.flat_map(|set| set.members()).for_each(|&(member, _)| harm.any(member));
        harm
    }

    pub(super) fn any(&mut self, variable: Variable) {
        self.lowering[variable.index()] = true;
        self.raising[variable.index()] = true;
    }

    /// The statement requires that `coefficient * variable` does not increase.
    fn rise(&mut self, variable: Variable, coefficient: f64) {
        let harm = if coefficient > 0.0 { &mut self.raising } else { &mut self.lowering };
        harm[variable.index()] = true;
    }

    fn conic(&mut self, conic: &StoredConic) {
        match conic {
            StoredConic::Norm { entries, bound } => {
                entries.iter().flat_map(Affine::terms).for_each(|(v, _)| self.any(v));
                bound.terms().into_iter().for_each(|(v, a)| self.rise(v, -a));
            }
            StoredConic::Quadratic { expression } => {
                let products = expression.products().into_iter();
                products.flat_map(|(a, b, _)| [a, b]).for_each(|v| self.any(v));
                expression.affine().terms().into_iter().for_each(|(v, a)| self.rise(v, a));
            }
        }
    }

    fn row(&mut self, terms: &[(Variable, f64)], limits: Interval) {
        for &(variable, coefficient) in terms {
            if limits.upper.is_finite() {
                self.rise(variable, coefficient);
            }
            if limits.lower.is_finite() {
                self.rise(variable, -coefficient);
            }
        }
    }
}

/// The tie of each function, in the order of the model.
pub(crate) fn ties(model: &Model) -> Result<Vec<Tie>, Error> {
    if model.function_count() == 0 {
        return Ok(Vec::new());
    }
    let mut harm = Harm::without_rows(model);
    model.constraints().for_each(|row| harm.row(row.terms(), row.limits()));
    // A function's variable occurs only in functions added later.
    let functions: Vec<FunctionRef<'_>> = model.functions().collect();
    let mut ties = vec![Tie::Exact; functions.len()];
    for (k, function) in functions.iter().enumerate().rev() {
        ties[k] = tie(model, function, &harm)?;
        mark(model, function.function(), ties[k], &mut harm)?;
    }
    Ok(ties)
}

fn tie(model: &Model, function: &FunctionRef<'_>, harm: &Harm) -> Result<Tie, Error> {
    let result = function.result();
    let (convex, concave) = match function.function() {
        Function::Absolute(_) | Function::Maximum(_) => (true, false),
        Function::Minimum(_) => (false, true),
        Function::Piecewise { of, graph } => {
            let graph = graph.restricted(model.range(of)?);
            (graph.bends(1.0), graph.bends(-1.0))
        }
        Function::Product { .. } => (false, false),
        // Their rows are those of the search, which follows curvature by itself.
        Function::Elementary { .. } | Function::Bilinear(_) | Function::Quotient(_) => (true, true),
    };
    let bounds = model.variable_ref(result)?.bounds();
    let range = range(model, function.function())?;
    // Moving back onto the function must not violate the variable's own bounds.
    let down = !harm.lowering[result.index()] && bounds.lower <= range.lower;
    let up = !harm.raising[result.index()] && range.upper <= bounds.upper;
    Ok(match () {
        () if convex && down => Tie::Above,
        () if concave && up => Tie::Below,
        () => Tie::Exact,
    })
}

/// Records what a function requires of its arguments.
fn mark(model: &Model, function: &Function, tie: Tie, harm: &mut Harm) -> Result<(), Error> {
    // 1 if the function rises with its arguments, -1 if it falls.
    let slope = match function {
        Function::Maximum(_) | Function::Minimum(_) => 1.0,
        Function::Elementary { function, of } => function.direction(model.range(of)?),
        _ => 0.0,
    };
    function.factor().into_iter().for_each(|factor| harm.any(factor));
    for (variable, coefficient) in function.expressions().iter().flat_map(Affine::terms) {
        match tie {
            // `w >= e` and `w <= e` for each argument.
            Tie::Above if slope != 0.0 => harm.rise(variable, slope * coefficient),
            Tie::Below if slope != 0.0 => harm.rise(variable, -slope * coefficient),
            _ => harm.any(variable),
        }
    }
    Ok(())
}

/// The values of a function over the current bounds, rounded outward.
pub(super) fn range(model: &Model, function: &Function) -> Result<Interval, Error> {
    let ranges = |of: &[Affine]| of.iter().map(|e| model.range(e)).collect::<Result<Vec<_>, _>>();
    let extreme = |of: &[Interval], pick: fn(f64, f64) -> f64, start: f64| {
        Interval::new(
            of.iter().map(|r| r.lower).fold(start, pick),
            of.iter().map(|r| r.upper).fold(start, pick),
        )
    };
    Ok(match function {
        Function::Absolute(of) => {
            let range = model.range(of)?;
            let folded = extreme(&[range, -range], f64::max, f64::NEG_INFINITY);
            Interval::new(folded.lower.max(0.0), folded.upper)
        }
        Function::Maximum(of) => extreme(&ranges(of)?, f64::max, f64::NEG_INFINITY),
        Function::Minimum(of) => extreme(&ranges(of)?, f64::min, f64::INFINITY),
        Function::Piecewise { of, graph } => {
            let range = model.range(of)?;
            let values = graph.values_within(range.lower, range.upper);
            // Values between breakpoints are rounded.
            let slack = 4.0 * f64::EPSILON * values.magnitude();
            Interval::new(values.lower - slack, values.upper + slack)
        }
        Function::Product { factor, of } => {
            let (factor, of) = (model.variable_ref(*factor)?.bounds(), model.range(of)?);
            if factor.is_bounded() && of.is_bounded() {
                (of * factor.lower).hull(of * factor.upper)
            } else {
                Interval::REALS
            }
        }
        Function::Elementary { function, of } => function.range(model.range(of)?),
        Function::Bilinear([left, right]) => model.range(left)? * model.range(right)?,
        Function::Quotient([left, right]) => model.range(left)? / model.range(right)?,
    })
}

/// Moves the variable of a relaxed function back onto the function.
pub(super) fn restore(variable: Variable, function: &Function, tie: Tie, values: &mut [f64]) {
    let exact = function.evaluate(|v| values[v.index()]);
    let value = &mut values[variable.index()];
    match tie {
        Tie::Exact => {}
        Tie::Above => *value = value.min(exact),
        Tie::Below => *value = value.max(exact),
    }
}
