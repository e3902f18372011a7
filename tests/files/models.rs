//! Random models for the tests of file formats.

use carom::model::{Warning, sos1, sos2};
use carom::prelude::*;
use proptest::prelude::*;

/// The number, or one of the small ones where a model cannot hold it.
fn bounded(value: f64) -> f64 {
    match value.abs() < 1e20 {
        true => value,
        false if value.is_nan() => 0.3,
        false => 1.0 / value,
    }
}

/// A number a model can hold: round decimals, any bits, and the awkward ones.
pub(crate) fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-400_i32..400).prop_map(|n| f64::from(n) / 10.0),
        2 => any::<f64>().prop_map(bounded),
        2 => -3.0..3.0_f64,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, 5e-324, -9.9e19, 1e-300, 1e16, 0.1]),
    ]
}

/// Two numbers in order, either possibly infinite but not both unless allowed.
pub(crate) fn pair(both_infinite: bool) -> impl Strategy<Value = (f64, f64)> {
    let open = if both_infinite { 1 } else { 0 };
    prop_oneof![
        6 => (number(), number()).prop_map(|(a, b)| if a <= b { (a, b) } else { (b, a) }),
        2 => number().prop_map(|a| (a, a)),
        2 => prop::sample::select(vec![(0.0, 1.0), (0.0, 0.0), (1.0, 1.0), (0.25, 0.5), (-0.0, 1.0)]),
        2 => number().prop_map(|a| (a, f64::INFINITY)),
        2 => number().prop_map(|a| (f64::NEG_INFINITY, a)),
        open => Just((f64::NEG_INFINITY, f64::INFINITY)),
    ]
}

fn name() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => "[a-zA-Z_][a-zA-Z0-9_.]{0,6}",
        2 => "[a-z]\\[[0-9]{1,3}\\]",
        1 => prop::sample::select(vec![
            "RHS", "BOUND", "RANGE", "obj", "obj_", "'MARKER'", "'INTORG'", "*", "$", "1", "-1e5",
            "IF", "Constant", "air temperature", "a b[3]", "a%20b", "%2 5", "% 2", "%25 20", "a%20", "S1", "s2", "SOS", "semis", "MAX", "ENDATA", "NAME", "höhe", "UP", "FR", "MARKER0",
            "a-b", "x[01]", "1st", "free", "St", "END", "%", "a%41", "r%ge", "r%le", "x{3}", "[3]",
            ".5", "(a", "Subject", "e1", "inf", "nan", "a:b", "\\x", "<=", "x]", "general", "x[1][2]",
        ]).prop_map(str::to_owned),
    ]
}

/// Whether written files give only warnings about what other solvers may refuse.
pub(crate) fn warnings_are_expected(warnings: &[Warning]) -> bool {
    warnings.iter().all(|warning| warning.message.contains("some solvers"))
}

/// Name, terms, limits, condition.
type RowPlan = (String, Vec<(usize, f64)>, (f64, f64), Option<(usize, bool)>);

/// Name, kind, members and weights.
type SetPlan = (String, bool, Vec<(usize, f64)>);

#[derive(Debug, Clone)]
pub(crate) struct Plan {
    name: String,
    maximize: bool,
    constant: f64,
    variables: Vec<(String, u8, (f64, f64), f64)>,
    rows: Vec<RowPlan>,
    squares: Vec<(f64, usize, f64, usize)>,
    sets: Vec<SetPlan>,
}

pub(crate) fn plan() -> impl Strategy<Value = Plan> {
    let variable = (name(), 0..7_u8, pair(true), number());
    let terms = prop::collection::vec((0..8_usize, number()), 1..5);
    let row = (name(), terms, pair(false), prop::option::of((0..8_usize, any::<bool>())));
    let members = prop::collection::vec((0..8_usize, number()), 1..5);
    let square = (-9.0..9.0_f64, 0..8_usize, -9.0..9.0_f64, 0..8_usize);
    (
        "[a-z ]{0,8}",
        any::<bool>(),
        number(),
        prop::collection::vec(variable, 1..8),
        prop::collection::vec(row, 0..8),
        prop::collection::vec(square, 0..4),
        prop::collection::vec((name(), any::<bool>(), members), 0..3),
    )
        .prop_map(|(name, maximize, constant, variables, rows, squares, sets)| Plan {
            name: name.trim().to_owned(),
            maximize,
            constant,
            variables,
            rows,
            squares,
            sets,
        })
}

/// Builds what a plan says; statements that a model refuses (names taken, empty rows) are left
/// out.
pub(crate) fn build(plan: &Plan) -> Model {
    let mut model = Model::new(plan.name.clone());
    let mut variables = Vec::new();
    for (name, kind, (lower, upper), _) in &plan.variables {
        let added = match kind {
            0 => model.binary(name),
            1 => model.integer(name, *lower, *upper),
            2 if *lower >= 0.0 && *upper <= 1.0 => {
                model.variable(name.as_str(), VariableKind::Binary, *lower, *upper)
            }
            5 => model.semicontinuous(name, *lower, *upper),
            6 => model.semiinteger(name, *lower, *upper),
            _ => model.continuous(name, *lower, *upper),
        };
        variables.extend(added);
    }
    if variables.is_empty() {
        return model;
    }
    let pick = |k: usize| variables[k % variables.len()];
    for (name, terms, (lower, upper), condition) in &plan.rows {
        let mut expression = Affine::zero();
        terms.iter().for_each(|&(k, a)| expression.add_term(a, pick(k)));
        let row = expression.within(*lower, *upper);
        let refused = match *condition {
            Some((k, true)) => model.add(name, pick(k).on().implies(row)).err(),
            Some((k, false)) => model.add(name, pick(k).off().implies(row)).err(),
            None => model.add(name, row).err(),
        };
        drop(refused);
    }
    for (name, second, members) in &plan.sets {
        let members = members.iter().map(|&(k, weight)| (pick(k), weight));
        let set = if *second { sos2(members) } else { sos1(members) };
        drop(model.add(name, set).err());
    }
    let mut objective = Quadratic::from(plan.constant);
    for (variable, (.., cost)) in variables.iter().zip(&plan.variables) {
        objective += *cost * *variable;
    }
    let sign = if plan.maximize { -1.0 } else { 1.0 };
    for &(a, i, b, j) in &plan.squares {
        objective += (a * pick(i) + b * pick(j)).square() * sign;
    }
    let sense = if plan.maximize { Sense::Maximize } else { Sense::Minimize };
    model.set_objective(sense, objective).unwrap();
    model
}
