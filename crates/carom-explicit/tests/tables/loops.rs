//! Where the loop stays, against steps from random states.

use carom::ErrorKind;
use carom::explicit::{ExplicitProgram, ExplicitTable, LookupAnswer, TableCell};
use carom::prelude::*;
use carom_proof::{ProvedTable, check_table};
use proptest::prelude::*;

use crate::programs::{Program, programs};

fn proved(table: &ExplicitTable) -> ProvedTable {
    let mut text = Vec::new();
    table.write_certificate(&mut text).unwrap();
    check_table(&text[..]).unwrap()
}

/// The weights of the corners of a cell at a state, by Cramer's rule.
fn weights(cell: &TableCell, state: &[f64]) -> Vec<f64> {
    let n = state.len();
    let base = &cell.corners[n];
    let edge = |v: usize, a: usize| cell.corners[v][a] - base[a];
    let matrix = |replaced: usize| {
        let entry = |a: usize, v: usize| match v == replaced {
            true => state[a] - base[a],
            false => edge(v, a),
        };
        (0..n).map(|a| (0..n).map(|v| entry(a, v)).collect()).collect::<Vec<Vec<f64>>>()
    };
    let whole = determinant(&matrix(n));
    let mut own: Vec<f64> = (0..n).map(|v| determinant(&matrix(v)) / whole).collect();
    own.push(1.0 - own.iter().sum::<f64>());
    own
}

fn determinant(matrix: &[Vec<f64>]) -> f64 {
    let [first, rest @ ..] = matrix else { return 1.0 };
    let minor = |v: usize| -> Vec<Vec<f64>> {
        rest.iter().map(|row| [&row[..v], &row[v + 1..]].concat()).collect()
    };
    let term =
        |(v, a): (usize, &f64)| if v % 2 == 0 { 1.0 } else { -1.0 } * a * determinant(&minor(v));
    first.iter().enumerate().map(term).sum()
}

fn volume(cell: &TableCell) -> f64 {
    let [others @ .., base] = &cell.corners[..] else { return 0.0 };
    let row = |corner: &Vec<f64>| corner.iter().zip(base).map(|(a, b)| a - b).collect();
    let factorial: f64 = (1..=base.len()).map(|k| k as f64).product();
    determinant(&others.iter().map(row).collect::<Vec<Vec<f64>>>()).abs() / factorial
}

/// Random starts of a loop.
const RUNS: usize = 600;

/// A loop: for each axis, factors of all columns and of the axis, and the disturbance.
#[derive(Debug, Clone)]
struct Loop {
    factors: Vec<Vec<f64>>,
    disturbance: f64,
}

fn loops() -> impl Strategy<Value = (Program, Loop)> {
    let factor = (-2..=2_i32).prop_map(|a| 0.25 * f64::from(a));
    (programs(), prop::collection::vec(prop::collection::vec(factor, 8), 3), 0..3_u32).prop_map(
        |(program, factors, size)| (program, Loop { factors, disturbance: 0.1 * f64::from(size) }),
    )
}

impl Loop {
    fn next(&self, a: usize, plan: &[f64], state: &[f64]) -> f64 {
        let own = &self.factors[a];
        plan.iter().zip(own).map(|(x, f)| f * x).sum::<f64>() + own[7] * state[a]
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_stays_is_not_left(
        (program, own) in loops(),
        finest in prop::sample::select(vec![1.0, 0.2]),
        shares in prop::collection::vec(prop::collection::vec(0.0..1.0_f64, 8), 8),
    ) {
        let built = program.build();
        let next = (0..program.axes).map(|a| {
            let mut sum: Affine = own.factors[a][7] * built.axes[a];
            built.outputs.iter().zip(&own.factors[a]).for_each(|(x, f)| sum += *f * *x);
            (sum, own.disturbance)
        });
        let next: Vec<_> = next.collect();
        let explicit = ExplicitProgram::new(&built.model, built.axes.clone(), built.outputs).unwrap();
        let table = explicit.with_loss(0.5, 0.1).unwrap().with_finest(0.25).unwrap()
            .with_next(&built.model, next, finest).unwrap().with_cell_limit(80).build();
        let stays = proved(&table).stays.unwrap();
        // The share of random states from which a disturbed loop stays among states with a plan.
        let mut random = shares[0][0].to_bits();
        let mut number = move || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 11) as f64 / 2_f64.powi(53)
        };
        let stays_from = |number: &mut dyn FnMut() -> f64| {
            let mut state: Vec<f64> = (0..program.axes).map(|_| 2.0 * number() - 1.0).collect();
            (0..30).all(|_| {
                let (answer, plan) = table.evaluate(&state);
                let is_planned = matches!(answer, LookupAnswer::Plan { .. });
                let moved: Vec<f64> =
                    (0..program.axes).map(|_| own.disturbance * (2.0 * number() - 1.0)).collect();
                state = (0..program.axes).map(|a| own.next(a, &plan, &state) + moved[a]).collect();
                is_planned && state.iter().all(|x| x.abs() <= 1.0 + 1e-6)
            })
        };
        let count = (0..RUNS).filter(|_| stays_from(&mut number)).count();
        let most = count as f64 / RUNS as f64 + 4.0 * (0.25 / RUNS as f64).sqrt();
        prop_assert!(stays <= most + 1e-9, "{stays} {most}");
        // Without smaller pieces, whole cells stay or are left: those that a random state leaves are
        // none that stay, as long as there are some.
        if finest < 1.0 {
            return Ok(());
        }
        let cells: Vec<TableCell> = table.cells().collect();
        let mut is_in: Vec<bool> =
            cells.iter().map(|cell| matches!(cell.answer, LookupAnswer::Plan { .. })).collect();
        loop {
            let before = is_in.clone();
            for (k, cell) in cells.iter().enumerate().filter(|(k, _)| before[*k]) {
                for share in &shares {
                    let sum: f64 = share[..=program.axes].iter().sum();
                    let state: Vec<f64> = (0..program.axes)
                        .map(|a| cell.corners.iter().zip(share).map(|(c, s)| s / sum * c[a]).sum())
                        .collect();
                    let (_, plan) = table.evaluate(&state);
                    let moved = |a: usize| own.disturbance * (2.0 * share[7 - a] - 1.0);
                    let next: Vec<f64> =
                        (0..program.axes).map(|a| own.next(a, &plan, &state) + moved(a)).collect();
                    // Well within another cell, or out of all of them.
                    let within = cells.iter().position(|cell| {
                        weights(cell, &next).iter().all(|w| *w > 1e-6)
                    });
                    let is_out = next.iter().any(|x| x.abs() > 1.0 + 1e-6);
                    if is_out || within.is_some_and(|other| !before[other]) {
                        is_in[k] = false;
                    }
                }
            }
            if is_in == before {
                break;
            }
        }
        let left = cells.iter().zip(&is_in).filter(|(_, is_in)| **is_in);
        let most: f64 = left.map(|(cell, _)| volume(cell)).sum::<f64>() / 2_f64.powi(program.axes as i32);
        prop_assert!(stays <= most + 1e-9, "{stays} {most}");
    }
}

/// The table of a cart on a rail that is disturbed, which is to come to the middle.
fn cart(disturbance: f64, finest: f64) -> ExplicitTable {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", -4.0, 4.0).unwrap();
    let u = cart.input("u", -1.0, 1.0).unwrap();
    cart.mode("roll").unwrap().next([(x, x + u)]).unwrap();
    let mut program = cart.program(2).unwrap();
    program.minimize(program.sum(x.square() + 0.1 * u.square()).unwrap()).unwrap();
    let start = program.open_start([(x, -2.0..=2.0)]).unwrap();
    let (input, after) = (program.at(u, 0).unwrap(), program.at(x, 1).unwrap());
    let explicit = ExplicitProgram::new(program.model(), start, [input]).unwrap();
    let explicit = explicit.with_next(program.model(), [(after, disturbance)], finest).unwrap();
    explicit.with_goal([-0.3..=0.3]).unwrap().build()
}

#[test]
fn a_cart_stays_where_its_input_is_stronger() {
    // From the ends, the input leads back by one.
    for (disturbance, share) in [(0.0, 1.0), (0.99, 1.0), (1.01, 0.0)] {
        assert_eq!(proved(&cart(disturbance, 1.0)).stays, Some(share));
    }
}

#[test]
fn a_cart_comes_to_its_goal() {
    let table = cart(0.1, 1.0 / 64.0);
    let (share, most) = proved(&table).reaches.unwrap();
    assert_eq!(share, 1.0);
    // From an end by at most 1.1 and at least 0.9 a step.
    assert!((2..=4).contains(&most), "{most}");
    let mut random = 12345_u64;
    for k in 0..=400 {
        let mut x = f64::from(k) / 100.0 - 2.0;
        let mut steps = 0;
        while x.abs() > 0.3 {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            x += table.evaluate(&[x]).1[0] + 0.2 * ((random >> 11) as f64 / 2_f64.powi(53) - 0.5);
            steps += 1;
        }
        assert!(steps <= most, "{steps} {most}");
    }
    // Pieces that are as long as the goal do not fit in.
    assert_eq!(proved(&cart(0.1, 1.0)).reaches, Some((0.0, 0)));
}

#[test]
fn loops_are_stated_for_each_axis() {
    let (model, x, u) = crate::limits::steps();
    let new = || ExplicitProgram::new(&model, [x], [u]).unwrap();
    let none: [(Variable, f64); 0] = [];
    for error in [
        new().with_next(&model, none, 1.0).unwrap_err(),
        new().with_next(&model, [(u, -1.0)], 1.0).unwrap_err(),
        new().with_next(&model, [(u, 0.0)], 0.0).unwrap_err(),
        new().with_next(&model, [(u, f64::INFINITY)], 1.0).unwrap_err(),
    ] {
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    }
    let other = Model::new("other");
    assert!(new().with_next(&other, [(u, 0.0)], 1.0).is_err());
    assert_eq!(proved(&new().build()).stays, None);
    let error = new().with_goal([0.0..=1.0]).unwrap_err();
    assert!(error.to_string().contains("no loop"), "{error}");
    let with = || new().with_next(&model, [(u, 0.0)], 1.0).unwrap();
    assert!(with().with_goal([0.0..=1.0, 0.0..=1.0]).is_err());
    assert!(with().with_goal([0.0..=f64::INFINITY]).is_err());
    let proved = proved(&with().build());
    assert!(proved.stays.is_some() && proved.reaches.is_none());
}
