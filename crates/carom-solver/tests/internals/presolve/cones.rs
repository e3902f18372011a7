//! Presolve of programs with cones: the same optimum, and points that are restored.
//!
//! The columns of the cones are whole, and all of their values are tried: what is left each time is
//! a program without cones.

use carom::model::norm;
use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::root::{Presolve, PresolveRule, blocks, presolve};
use carom_solver::internals::program::{Cone, ConeRole, ConeShape, Program};
use proptest::prelude::*;

use super::logical_programs::{coded, conjunctions};
use super::programs::program;
use super::search_alone;
use super::switched_cones::complete;
use crate::common::case::Case;
use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/cones.txt";

/// Most columns of a cone, and of one with parts.
const LONGEST: usize = 3;
const LONGEST_SPLIT: usize = 5;

/// Most assignments that are tried.
const MOST_ASSIGNMENTS: f64 = 400.0;

/// What a point may miss a cone by, in the unit of its head.
const TOLERANCE: f64 = 1e-6;

/// What a cone is made of: its shape, or none for a norm that is split; columns; those that are 0.
type Shape = (Option<ConeShape>, Vec<(prop::sample::Index, bool)>);

/// What cones of a program are made of.
fn shapes() -> impl Strategy<Value = Vec<Shape>> {
    let columns = || (any::<prop::sample::Index>(), prop::bool::weighted(0.2));
    let short = prop::collection::vec(columns(), 2..=LONGEST);
    let long = prop::collection::vec(columns(), 4..=LONGEST_SPLIT);
    let shape = prop_oneof![Just(ConeShape::Norm), Just(ConeShape::Rotated)];
    let cone = prop_oneof![
        3 => (shape.prop_map(Some), short),
        1 => (Just(None), long),
    ];
    prop::collection::vec(cone, 1..=2)
}

/// The program of a case with cones over whole columns with bounds, and heads that are at least 0.
fn with_cones(case: &Case, shapes: &[Shape]) -> Option<Program> {
    let (mut model, variables) = case.build();
    let plain = Program::assemble(&model).unwrap();
    let whole = |j: &usize| plain.lower[*j].is_finite() && plain.upper[*j].is_finite();
    let open: Vec<usize> = plain.integers.iter().copied().filter(whole).collect();
    let (mut cones, mut zeros) = (Vec::new(), Vec::new());
    for (k, (shape, picks)) in shapes.iter().enumerate() {
        let mut columns: Vec<usize> = Vec::new();
        for (pick, is_zero) in picks {
            let j = *open.get(pick.index(open.len().max(1)))?;
            if !columns.contains(&j) {
                columns.push(j);
                zeros.extend(
                    (*is_zero && plain.lower[j] <= 0.0 && plain.upper[j] >= 0.0).then_some(j),
                );
            }
        }
        let Some(shape) = *shape else {
            if columns.len() < 2 {
                continue;
            }
            let tail = columns[1..].iter().map(|&j| variables[j]);
            model.add(("split", k), norm(tail).le(variables[columns[0]])).unwrap();
            continue;
        };
        if columns.len() > shape.head() {
            cones.push(Cone { shape, columns, role: ConeRole::Single });
        }
    }
    let mut program = Program::assemble(&model).unwrap();
    for cone in &cones {
        cone.head().iter().for_each(|&j| program.lower[j] = program.lower[j].max(0.0));
    }
    zeros.iter().for_each(|&j| (program.lower[j], program.upper[j]) = (0.0, 0.0));
    program.cones.extend(cones);
    let tried = tried(&program);
    let assignments: f64 =
        tried.iter().map(|&j| program.upper[j] - program.lower[j] + 1.0).product();
    (!program.cones.is_empty() && assignments <= MOST_ASSIGNMENTS).then_some(program)
}

/// The columns of cones that are not whole: parts, and values that binaries switch off.
fn helpers(program: &Program) -> Vec<bool> {
    let mut open = vec![false; program.column_count()];
    let columns = program.cones.iter().flat_map(|cone| &cone.columns);
    columns.filter(|&&j| !program.integral[j]).for_each(|&j| open[j] = true);
    open
}

/// The whole columns that decide about cones.
fn tried(program: &Program) -> Vec<usize> {
    let mut columns: Vec<usize> = program.cones.iter().flat_map(|c| c.columns.clone()).collect();
    for j in columns.clone().into_iter().filter(|&j| !program.integral[j]) {
        columns.extend(program.column(j).0.iter().flat_map(|&row| program.row(row).0));
    }
    columns.sort_unstable();
    columns.dedup();
    columns.retain(|&j| program.integral[j]);
    columns
}

/// The best point of a program by trying all values of the columns of its cones; or whether the
/// objective falls forever.
#[derive(Debug)]
enum Best {
    None,
    Unbounded,
    Unknown,
    At(f64, Vec<f64>),
}

fn best(program: &Program) -> Best {
    let columns = tried(program);
    let mut rest = program.clone();
    rest.cones = Vec::new();
    let mut best = Best::None;
    try_all(program, &mut rest, &columns, &mut best);
    best
}

fn try_all(program: &Program, rest: &mut Program, columns: &[usize], best: &mut Best) {
    let Some((&j, others)) = columns.split_first() else {
        let (mut rest, open) = (rest.clone(), helpers(program));
        let mut x = rest.lower.clone();
        complete(program, &mut x, &open);
        if program.cones.iter().any(|cone| cone.miss(&x) > TOLERANCE) {
            return;
        }
        for j in (0..x.len()).filter(|&j| open[j]) {
            if x[j] > rest.upper[j] + TOLERANCE || x[j] < rest.lower[j] - TOLERANCE {
                return;
            }
            (rest.lower[j], rest.upper[j]) = (x[j], x[j]);
        }
        let found = search_alone(&rest, &|_: &[f64]| true);
        match (found.termination, found.points.first()) {
            (Termination::Infeasible, _) => {}
            (Termination::Unbounded, _) => *best = Best::Unbounded,
            (Termination::Optimal, Some(x)) => {
                let value = rest.objective(x);
                if !matches!(best, Best::At(old, _) if *old <= value)
                    && matches!(best, Best::None | Best::At(..))
                {
                    *best = Best::At(value, x.clone());
                }
            }
            _ => *best = Best::Unknown,
        }
        return;
    };
    let [lower, upper] = [program.lower[j], program.upper[j]];
    let mut value = lower.ceil();
    while value <= upper {
        (rest.lower[j], rest.upper[j]) = (value, value);
        try_all(program, rest, others, best);
        value += 1.0;
    }
    (rest.lower[j], rest.upper[j]) = (lower, upper);
}

fn compare(program: &Program, rules: &[PresolveRule]) -> Result<(), TestCaseError> {
    let expected = best(program);
    let presolved = match presolve(program, rules, &StopToken::default()).unwrap() {
        Presolve::Presolved(presolved) => presolved,
        Presolve::Stopped => unreachable!("the default token never stops"),
        Presolve::Infeasible => {
            prop_assert!(matches!(expected, Best::None | Best::Unknown), "{:?}", expected);
            return Ok(());
        }
    };
    let found = best(&presolved.program);
    match (expected, found) {
        (Best::At(value, _), Best::At(here, x)) => {
            let tolerance = 1e-5 * value.abs().max(1.0);
            prop_assert!((here - value).abs() <= tolerance, "{here} instead of {value}");
            let point = presolved.postsolve.point(&x);
            prop_assert!((program.objective(&point) - value).abs() <= tolerance);
            for cone in program.cones.iter().filter(|cone| cone.role != ConeRole::Part) {
                prop_assert!(cone.miss(&point) <= TOLERANCE, "{:?} at {:?}", cone, point);
            }
            for row in 0..program.row_count() {
                let sum = program.row(row);
                let sum: f64 = sum.0.iter().zip(sum.1).map(|(&j, a)| a * point[j]).sum();
                let miss = (program.row_lower[row] - sum).max(sum - program.row_upper[row]);
                prop_assert!(miss <= 1e-5, "row {row} is missed by {miss}");
            }
            for (j, &x) in point.iter().enumerate() {
                let miss = (program.lower[j] - x).max(x - program.upper[j]);
                prop_assert!(miss <= 1e-5, "column {j} is missed by {miss}");
                let part = if program.integral[j] { (x - x.round()).abs() } else { 0.0 };
                prop_assert!(part <= 1e-5, "column {j} is {x}");
            }
        }
        (Best::Unknown, _) | (_, Best::Unknown) => {}
        (Best::None, Best::None) | (Best::Unbounded, Best::Unbounded) => {}
        (expected, found) => prop_assert!(false, "{found:?} instead of {expected:?}"),
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(150, REGRESSIONS))]

    #[test]
    fn each_rule(case in program(false), shapes in shapes(), rule in 0..PresolveRule::ALL.len()) {
        let Some(program) = with_cones(&case, &shapes) else { return Ok(()) };
        compare(&program, &[PresolveRule::ALL[rule]])?;
    }

    #[test]
    fn all_rules(case in program(false), curved in program(true), shapes in shapes()) {
        for case in [case, curved] {
            if let Some(program) = with_cones(&case, &shapes) {
                compare(&program, &PresolveRule::ALL)?;
            }
        }
    }

    #[test]
    fn rules_for_logic(coded in coded(), conjunctions in conjunctions(), shapes in shapes()) {
        for case in [coded, conjunctions] {
            if let Some(program) = with_cones(&case, &shapes) {
                compare(&program, &PresolveRule::ALL)?;
            }
        }
    }

    #[test]
    fn blocks_share_the_cones(case in program(false), shapes in shapes()) {
        let Some(program) = with_cones(&case, &shapes) else { return Ok(()) };
        let blocks = blocks(&program);
        prop_assume!(!blocks.is_empty());
        let mut cones: Vec<Cone> = Vec::new();
        for block in &blocks {
            let own = |cone: &Cone| Cone {
                columns: cone.columns.iter().map(|&k| block.columns[k]).collect(),
                ..cone.clone()
            };
            cones.extend(block.program.cones.iter().map(own));
        }
        prop_assert_eq!(cones.len(), program.cones.len());
        prop_assert!(program.cones.iter().all(|cone| cones.contains(cone)));
    }
}

/// A column that only a cone keeps from falling is not dominated.
#[test]
fn a_cone_holds_its_head() {
    let mut model = Model::new("held");
    let [x, y] = ["x", "y"].map(|name| model.continuous(name, 3.0, 4.0).unwrap());
    let length = model.continuous("length", 0.0, 10.0).unwrap();
    model.add("length_of", norm([x, y]).le(length)).unwrap();
    model.minimize(length).unwrap();
    let program = Program::assemble(&model).unwrap();
    let Presolve::Presolved(presolved) =
        presolve(&program, &PresolveRule::ALL, &StopToken::default()).unwrap()
    else {
        panic!("nothing contradicts")
    };
    let program = &presolved.program;
    assert_eq!(program.cones.len(), 1);
    assert_eq!((program.column_count(), program.linear[2]), (3, 1.0));
}
