//! Cones that binaries switch off: the same whole points, and a tighter relaxation.

use carom::model::norm;
use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::tighten_switched_cones;
use carom_solver::internals::program::{Cone, ConeRole, ConeShape, Program};
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/switched_cones.txt";

const BINARIES: usize = 3;

/// How the entries of a tail are switched off.
#[derive(Debug, Clone, Copy)]
enum Switch {
    Never,
    /// While a binary is 0, or 1.
    By(usize, bool),
    /// While either of two binaries is 0.
    Either(usize, usize),
    /// While a binary is 0, through a column in between.
    Indirect(usize),
}

#[derive(Debug, Clone, Copy)]
enum Form {
    /// `sum z^2 <= s`
    Quadratic,
    /// `sum z^2 <= s c`, one or two entries
    Rotated(f64),
    /// `|z| <= c`
    Norm(f64),
}

#[derive(Debug, Clone)]
struct Case {
    forms: Vec<(Form, Vec<Switch>)>,
    /// `b_0 <= b_1`
    ordered: bool,
}

fn switch() -> impl Strategy<Value = Switch> {
    prop_oneof![
        1 => Just(Switch::Never),
        4 => (0..BINARIES, prop::bool::weighted(0.3)).prop_map(|(b, one)| Switch::By(b, one)),
        1 => (0..BINARIES, 0..BINARIES).prop_map(|(a, b)| Switch::Either(a, b)),
        1 => (0..BINARIES).prop_map(Switch::Indirect),
    ]
}

fn case() -> impl Strategy<Value = Case> {
    let value = || prop_oneof![2 => Just(1.0), 1 => Just(2.0), 1 => 0.3..3.0];
    let form = prop_oneof![
        1 => Just(Form::Quadratic),
        1 => value().prop_map(Form::Rotated),
        1 => value().prop_map(Form::Norm),
    ];
    let alike = (switch(), 1..=3_usize).prop_map(|(switch, n)| vec![switch; n]);
    let switches = prop_oneof![1 => alike, 2 => prop::collection::vec(switch(), 1..=3)];
    (prop::collection::vec((form, switches), 1..=2), any::<bool>())
        .prop_map(|(forms, ordered)| Case { forms, ordered })
}

/// The program of a case; and the columns of the binaries, of the entries, and of the other heads.
fn build(case: &Case) -> (Program, Vec<usize>, Vec<usize>, Vec<usize>) {
    let mut model = Model::new("switched");
    let binaries = model.binary_family("b", BINARIES).unwrap();
    if case.ordered {
        model.add("ordered", binaries[0].le(binaries[1])).unwrap();
    }
    let (mut entries, mut heads, mut rotated) = (Vec::new(), Vec::new(), Vec::new());
    for (k, (form, switches)) in case.forms.iter().enumerate() {
        let most = if matches!(form, Form::Rotated(_)) { 2 } else { 3 };
        let mut tail = Vec::new();
        for (i, &switch) in switches.iter().take(most).enumerate() {
            let place = 10 * k + i;
            let z = model.integer(("z", place), -2.0, 2.0).unwrap();
            let limit = |name: &str, on: Affine, model: &mut Model| {
                model.add((format!("{name}_most"), place), z.le(2.0 * on.clone())).unwrap();
                model.add((format!("{name}_least"), place), z.ge(-2.0 * on)).unwrap();
            };
            match switch {
                Switch::Never => {}
                Switch::By(b, false) => limit("by", binaries[b].into(), &mut model),
                Switch::By(b, true) => limit("by", 1.0 - binaries[b], &mut model),
                Switch::Either(a, b) => {
                    limit("a", binaries[a].into(), &mut model);
                    limit("b", binaries[b].into(), &mut model);
                }
                Switch::Indirect(b) => {
                    let flow = model.continuous(("flow", place), 0.0, 2.0).unwrap();
                    model.add(("open", place), flow.le(2.0 * binaries[b])).unwrap();
                    limit("flow", 0.5 * flow, &mut model);
                }
            }
            tail.push(z);
        }
        entries.extend(tail.iter().map(|z| z.index()));
        match form {
            Form::Quadratic => {
                let s = model.continuous(("s", k), 0.0, 12.0).unwrap();
                heads.push(s.index());
                let sum = tail.iter().fold(Quadratic::zero(), |sum, z| sum + z.square());
                model.add(("cone", k), sum.le(s)).unwrap();
            }
            Form::Rotated(value) => {
                let s = model.continuous(("s", k), 0.0, 40.0).unwrap();
                let y = model.continuous(("y", k), *value, *value).unwrap();
                heads.push(s.index());
                let columns = [s, y].iter().chain(&tail).map(|v| v.index()).collect();
                let shape = ConeShape::Rotated;
                rotated.push(Cone { shape, columns, role: ConeRole::Single });
            }
            Form::Norm(value) => {
                model.add(("cone", k), norm(tail).le(*value)).unwrap();
            }
        }
    }
    let mut program = Program::assemble(&model).unwrap();
    program.cones.extend(rotated);
    (program, binaries.iter().map(|b| b.index()).collect(), entries, heads)
}

/// Sets columns that follow from whole ones by equalities, one after the other, and tells which
/// they are.
fn follow(program: &Program, x: &mut [f64]) -> Vec<bool> {
    let mut known = program.integral.clone();
    let equalities: Vec<usize> = (0..program.row_count())
        .filter(|&i| program.row_lower[i] == program.row_upper[i])
        .collect();
    for _ in 0..equalities.len() {
        for &row in &equalities {
            let (columns, values) = program.row(row);
            let terms = || columns.iter().zip(values);
            let mut unknown = terms().filter(|(j, _)| !known[**j]);
            if let (Some((&j, a)), None) = (unknown.next(), unknown.next()) {
                let others: f64 = terms().filter(|(i, _)| **i != j).map(|(&i, a)| a * x[i]).sum();
                x[j] = (program.row_upper[row] - others) / a;
                known[j] = true;
            }
        }
    }
    known
}

/// Sets the columns between binaries and entries, further heads and parts so as to leave as much
/// room as there is.
pub(super) fn complete(program: &Program, x: &mut [f64], open: &[bool]) {
    let known = follow(program, x);
    let is_open = |j: usize| open[j] && !known[j];
    for j in (0..program.column_count()).filter(|&j| is_open(j)) {
        let is_part = |cone: &&Cone| cone.shape == ConeShape::Rotated && cone.columns[0] == j;
        if program.cones.iter().any(|cone| is_part(&cone)) {
            continue;
        }
        // What the rows with whole columns leave.
        let (rows, factors) = program.column(j);
        x[j] = program.upper[j];
        for (&row, &a) in rows.iter().zip(factors).filter(|(_, a)| **a > 0.0) {
            let (columns, values) = program.row(row);
            if columns.iter().all(|&i| i == j || program.integral[i]) {
                let others = columns.iter().zip(values).filter(|(i, _)| **i != j);
                let others: f64 = others.map(|(&i, a)| a * x[i]).sum();
                x[j] = x[j].min((program.row_upper[row] - others) / a);
            }
        }
    }
    for cone in program.cones.iter().filter(|cone| cone.shape == ConeShape::Rotated) {
        let [part, head, ref tail @ ..] = cone.columns[..] else { continue };
        if is_open(part) {
            let square: f64 = tail.iter().map(|&j| x[j] * x[j]).sum();
            x[part] = if square == 0.0 { 0.0 } else { square / x[head].max(1e-300) };
        }
    }
}

fn holds(program: &Program, x: &[f64]) -> bool {
    (0..x.len()).all(|j| program.lower[j] - 1e-9 <= x[j] && x[j] <= program.upper[j] + 1e-9)
        && (0..program.row_count()).all(|row| {
            let (columns, values) = program.row(row);
            let sum: f64 = columns.iter().zip(values).map(|(&j, a)| a * x[j]).sum();
            program.row_lower[row] - 1e-9 <= sum && sum <= program.row_upper[row] + 1e-9
        })
        && program.cones.iter().all(|cone| cone.miss(x) <= 1e-9)
}

proptest! {
    #![proptest_config(config(300, REGRESSIONS))]

    #[test]
    fn whole_points_stay(case in case()) {
        let (program, binaries, entries, heads) = build(&case);
        let tight = tighten_switched_cones(&program, &StopToken::default());
        let Some(tight) = tight else { return Ok(()) };
        let n = program.column_count();
        prop_assert!((0..n).all(|j| tight.lower[j] == program.lower[j]));
        let mut open = vec![true; tight.column_count()];
        binaries.iter().chain(&entries).chain(&heads).for_each(|&j| open[j] = false);
        let mut feasible = 0;
        for code in 0..(1 << BINARIES) * 5_usize.pow(entries.len() as u32) * 4 {
            let mut x = vec![0.0; tight.column_count()];
            let mut rest = code;
            let mut digit = |base: usize| { let digit = rest % base; rest /= base; digit };
            binaries.iter().for_each(|&j| x[j] = digit(2) as f64);
            entries.iter().for_each(|&j| x[j] = digit(5) as f64 - 2.0);
            let room = [0.999, 1.001, 0.0, 2.0][digit(4)];
            if room == 0.0 && code % 7 != 0 {
                continue;
            }
            for (&j, cone) in heads.iter().flat_map(|j| program.cones.iter().filter(|c| c.columns[0] == *j).map(move |c| (j, c))) {
                let square: f64 = cone.tail().iter().map(|&j| x[j] * x[j]).sum();
                x[j] = (room * square / program.upper[cone.columns[1]]).min(program.upper[j]);
            }
            let mut point = x[..n].to_vec();
            complete(&program, &mut point, &open[..n]);
            complete(&tight, &mut x, &open);
            prop_assert_eq!(holds(&program, &point), holds(&tight, &x), "{:?} and {:?} in {:?}", point, x, tight.cones);
            feasible += usize::from(holds(&program, &point));
        }
        prop_assert!(feasible > 0);
    }
}

/// `x^2 <= s` with `x <= b` becomes `x^2 <= s b`.
#[test]
fn a_binary_takes_the_place_of_one() {
    let mut model = Model::new("perspective");
    let open = model.binary("open").unwrap();
    let share = model.continuous("share", 0.0, 1.0).unwrap();
    let cost = model.continuous("cost", 0.0, 10.0).unwrap();
    model.add("only_open", share.le(open)).unwrap();
    model.add("square", share.square().le(cost)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let tight = tighten_switched_cones(&program, &StopToken::default()).unwrap();
    assert_eq!(tight.column_count(), program.column_count());
    assert_eq!(tight.cones[0].head(), [cost.index(), open.index()]);
}

/// A norm with one binary has its largest length times the binary; entries with binaries of their
/// own are split.
#[test]
fn norms_are_switched_as_a_whole_or_by_entries() {
    let mut model = Model::new("norms");
    let on = model.binary_family("on", 2).unwrap();
    let x = model.continuous_family("x", 2, -9.0, 9.0).unwrap();
    let y = model.continuous_family("y", 2, -9.0, 9.0).unwrap();
    for k in 0..2 {
        for (name, z, b) in [("x", x[k], on[0]), ("y", y[k], on[k])] {
            model.add((format!("{name}_most"), k), z.le(9.0 * b)).unwrap();
            model.add((format!("{name}_least"), k), z.ge(-9.0 * b)).unwrap();
        }
    }
    model.add("whole", norm(x.iter()).le(5.0)).unwrap();
    model.add("split", norm(y.iter()).le(3.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let tight = tighten_switched_cones(&program, &StopToken::default()).unwrap();
    let shapes: Vec<ConeShape> = tight.cones.iter().map(|cone| cone.shape).collect();
    assert_eq!(shapes, [ConeShape::Norm, ConeShape::Rotated, ConeShape::Rotated]);
    assert_eq!(tight.upper[tight.cones[0].columns[0]], 5.0);
    // `5 on`, two parts and `3 on` for each.
    assert_eq!(tight.column_count(), program.column_count() + 5);
}

/// Cones whose tail no binary switches off stay, and so do programs without binaries.
#[test]
fn other_cones_stay() {
    let mut model = Model::new("stays");
    let on = model.binary("on").unwrap();
    let x = model.continuous_family("x", 2, -9.0, 9.0).unwrap();
    model.add("some", x[0].le(9.0 * on)).unwrap();
    model.add("length", norm(x.iter()).le(5.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    assert!(tighten_switched_cones(&program, &StopToken::default()).is_none());
}

/// A tail that is a slight constant where a binary is 0, as completed squares leave it, is not off.
#[test]
fn a_slight_constant_is_not_off() {
    let is_switched = |constant: f64| {
        let mut model = Model::new("constant");
        let b = model.binary("b").unwrap();
        let z = model.continuous("z", -10.0, 10.0).unwrap();
        let s = model.continuous("s", 0.0, 100.0).unwrap();
        model.add("sum", z.equals(b + constant)).unwrap();
        model.add("cone", z.square().le(s)).unwrap();
        model.minimize(s).unwrap();
        let program = Program::assemble(&model).unwrap();
        tighten_switched_cones(&program, &StopToken::default()).is_some()
    };
    assert!(is_switched(0.0));
    for constant in [1e-9, 7e-9, 1e-8, 1e-3, -7e-9] {
        assert!(!is_switched(constant), "{constant}");
    }
}
