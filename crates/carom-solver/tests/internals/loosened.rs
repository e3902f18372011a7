//! A program with cones that is loosened keeps all of its points, but for larger heads of cones, and
//! is loosened by less than points may miss.

use carom::model::norm;
use carom::prelude::*;
use carom::tolerance::FEASIBILITY;
use carom_solver::internals::presolve::{Domain, Reduced, reduce};
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::loosened;
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/loosened.txt";

const VARIABLES: usize = 3;

type Numbers = [i8; VARIABLES];

/// `|tail| <= head`, or its square at most the head: rows and offsets of the tail, the head.
#[derive(Debug, Clone)]
struct ConicRow {
    tail: Vec<(Numbers, i8)>,
    head: Numbers,
    is_square: bool,
    /// Whether the head is a variable of its own, which equals the head or is at least it, and may
    /// be an entry of the next tail.
    is_variable: Option<(bool, bool)>,
    room: u8,
}

#[derive(Debug, Clone)]
struct Case {
    point: Numbers,
    bounds: [(u8, u8); VARIABLES],
    cones: Vec<ConicRow>,
    rows: Vec<(Numbers, u8)>,
    share: f64,
}

fn numbers() -> impl Strategy<Value = Numbers> {
    prop::array::uniform3(prop_oneof![1 => Just(0i8), 2 => -8i8..=8])
}

fn case() -> impl Strategy<Value = Case> {
    let tail = prop::collection::vec((numbers(), -8i8..=8), 1..=3);
    let head = prop_oneof![1 => Just([0; VARIABLES]), 2 => numbers()];
    let is_variable = prop::option::of((any::<bool>(), any::<bool>()));
    let cone = (tail, head, any::<bool>(), is_variable, 0u8..=2).prop_map(
        |(tail, head, is_square, is_variable, room)| ConicRow {
            tail,
            head,
            is_square,
            is_variable,
            room,
        },
    );
    (
        numbers(),
        prop::array::uniform3((0u8..=9, 0u8..=9)),
        prop::collection::vec(cone, 1..=3),
        prop::collection::vec((numbers(), 0u8..=2), 0..=2),
        prop_oneof![Just(0.3), Just(0.003)],
    )
        .prop_map(|(point, bounds, cones, rows, share)| Case {
            point,
            bounds,
            cones,
            rows,
            share,
        })
}

fn sum(coefficients: &Numbers, x: &[Variable]) -> Affine {
    let terms = coefficients.iter().zip(x).map(|(&a, &x)| f64::from(a) * x);
    terms.fold(Affine::zero(), |sum, term| sum + term)
}

fn at(coefficients: &Numbers, point: &Numbers) -> f64 {
    coefficients.iter().zip(point).map(|(&a, &p)| f64::from(a) * f64::from(p)).sum()
}

/// The model, which has the point of the case, and the values of the heads that are variables. It
/// refuses statements without variables.
fn model(case: &Case) -> (Model, Vec<f64>) {
    let mut model = Model::new("loosened");
    let variable = |k: usize| {
        let (value, (below, above)) = (f64::from(case.point[k]), case.bounds[k]);
        let end = |room: u8| if room == 9 { f64::INFINITY } else { f64::from(room) };
        (value - end(below), value + end(above))
    };
    let bounds: Vec<(f64, f64)> = (0..VARIABLES).map(variable).collect();
    let names = bounds.iter().enumerate();
    let x: Vec<Variable> =
        names.map(|(k, &(l, u))| model.continuous(("x", k), l, u).unwrap()).collect();
    let mut values_of_heads = Vec::new();
    let mut next: Option<(Variable, f64)> = None;
    for (k, cone) in case.cones.iter().enumerate() {
        let mut entries: Vec<Affine> =
            cone.tail.iter().map(|(a, offset)| sum(a, &x) + f64::from(*offset)).collect();
        let values = cone.tail.iter().map(|(a, b)| at(a, &case.point) + f64::from(*b));
        let mut square: f64 = values.map(|value| value * value).sum();
        if let Some((variable, value)) = next.take() {
            entries.push(variable.into());
            square += value * value;
        }
        let least = if cone.is_square { square } else { square.sqrt() } + f64::from(cone.room);
        let mut head = sum(&cone.head, &x) + (least - at(&cone.head, &case.point));
        if let Some((is_equal, is_next)) = cone.is_variable {
            let variable = model.continuous(("head", k), 0.0, f64::INFINITY).unwrap();
            values_of_heads.push(least);
            let difference = variable - head;
            let row = if is_equal { difference.equals(0.0) } else { difference.le(0.0) };
            model.add(("head", k), row).unwrap();
            // Rows that keep the head from growing.
            let other = 4.0 * variable + x[k];
            let value = 4.0 * least + f64::from(case.point[k]);
            match cone.room {
                1 => _ = model.add(("limit", k), other.le(value)).unwrap(),
                2 => _ = model.add(("equation", k), other.equals(value)).unwrap(),
                _ => {}
            }
            head = variable.into();
            next = is_next.then_some((variable, least));
        }
        if cone.is_square {
            let squares = entries.iter().map(|entry| entry * entry);
            let squares = squares.reduce(|sum, square| sum + square).unwrap();
            _ = model.add(("cone", k), squares.le(head));
        } else {
            _ = model.add(("cone", k), norm(entries).le(head));
        }
    }
    for (k, (row, room)) in case.rows.iter().enumerate() {
        let limit = at(row, &case.point) + f64::from(*room);
        _ = model.add(("row", k), sum(row, &x).le(limit));
    }
    (model, values_of_heads)
}

/// The reduced program of the model, and its point.
fn reduced(case: &Case) -> Option<(Reduced, Vec<f64>)> {
    let (model, heads) = model(case);
    let program = Program::assemble(&model).ok()?;
    let mut x: Vec<f64> = case.point.iter().map(|&value| f64::from(value)).chain(heads).collect();
    // The columns of expressions follow from those before them.
    for j in x.len()..program.column_count() {
        let found = (0..program.row_count()).find_map(|row| {
            let (columns, values) = program.row(row);
            let (last, rest) = columns.split_last()?;
            let own = *last == j && program.row_lower[row] == program.row_upper[row];
            let sum = || rest.iter().zip(values).map(|(&j, a)| a * x[j]).sum::<f64>();
            own.then(|| (program.row_lower[row] - sum()) / values[rest.len()])
        });
        x.push(found.unwrap_or(program.lower[j]));
    }
    let reduced = reduce(&program, &Domain::new(&program))?;
    let x = reduced.columns.iter().map(|&j| x[j]).collect();
    Some((reduced, x))
}

proptest! {
    #![proptest_config(config(2000, REGRESSIONS))]

    #[test]
    fn loosened_programs_keep_all_points(case in case()) {
        let Some((program, x)) = reduced(&case) else { return Ok(()) };
        let wide = loosened(&program, &x, case.share);
        let most = case.share * FEASIBILITY;
        let mut wider = x.clone();
        for row in 0..program.rows.len() {
            let limits = [program.row_lower[row], program.row_upper[row]];
            let wide_limits = [wide.row_lower[row], wide.row_upper[row]];
            if limits[0] == limits[1] && wide_limits != limits {
                // The equation of a head, which grows.
                let (columns, values) = program.rows.vector(row);
                let heads: Vec<usize> = columns.iter().copied().filter(|j| {
                    program.cones.iter().any(|cone| cone.head().iter().any(|e| e.place == *j))
                }).collect();
                let [head] = heads[..] else { panic!("{heads:?} for an equation") };
                let a = values[columns.iter().position(|&j| j == head).unwrap()];
                let grows = (wide_limits[0] - limits[0]) / a;
                let rounding = 1e-15 * limits[0].abs();
                prop_assert!(grows > 0.0 && grows <= 1.01 * most + rounding, "a head by {}", grows);
                wider[head] += grows;
            } else {
                prop_assert!(wide_limits[0] <= limits[0] && wide_limits[1] >= limits[1]);
                for (limit, wide) in limits.into_iter().zip(wide_limits) {
                    let by = (wide - limit).abs();
                    prop_assert!(limit.is_infinite() || by <= 1.01 * most + 1e-15 * limit.abs());
                }
            }
        }
        prop_assert!(wide.objective(&wider) <= program.objective(&x));
        let misses = |program: &Reduced, x: &[f64]| -> Vec<f64> {
            let rows = (0..program.rows.len()).map(|row| {
                let (columns, values) = program.rows.vector(row);
                let sum: f64 = columns.iter().zip(values).map(|(&j, a)| a * x[j]).sum();
                let size: f64 = columns.iter().zip(values).map(|(&j, a)| (a * x[j]).abs()).sum();
                let miss = (program.row_lower[row] - sum).max(sum - program.row_upper[row]);
                (miss - 1e-14 * size).max(0.0)
            });
            rows.collect()
        };
        for (own, wide) in misses(&program, &x).into_iter().zip(misses(&wide, &wider)) {
            prop_assert!(wide <= own + 1e-12, "a row is missed by {} instead of {}", wide, own);
        }
        for j in 0..x.len() {
            prop_assert!(wide.lower[j] <= program.lower[j].min(wider[j]) || x[j] < program.lower[j]);
            prop_assert!(wide.upper[j] >= program.upper[j] && wide.upper[j] >= wider[j] || x[j] > program.upper[j]);
        }
        for (cone, wide) in program.cones.iter().zip(&wide.cones) {
            let rounding = 1e-13 * cone.reach(&x).abs();
            prop_assert!(wide.miss(&wider) <= cone.miss(&x) + rounding, "{:?} {:?}", cone, wide);
        }
    }
}
