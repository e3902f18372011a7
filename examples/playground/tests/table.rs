//! The table of the page is that of its program, and what it says is true.
//!
//! `UPDATE=1 cargo test` writes the table and the states that the page shows anew.

use std::path::Path;

use carom::explicit::{ExplicitProgram, LookupAnswer};
use carom::prelude::*;
use carom_playground_table::{PUSH, STEP, STEPS, WALL, cost, look_up};

/// States with an optimum on the page: position (m), speed (m/s).
const STATES: [[f64; 2]; 5] = [[-0.8, 0.6], [0.3, 0.9], [0.6, 0.4], [0.7, -0.5], [0.9, 0.9]];

/// The cart: its program, the axes of its table, and its inputs.
fn cart() -> (carom::hybrid::HybridProgram, Vec<Variable>, Vec<Affine>) {
    let mut cart = HybridSystem::new(STEP);
    let x = cart.state("x", -2.0, 1.25).unwrap(); // m
    let v = cart.state("v", -2.0, 2.0).unwrap(); // m/s
    let u = cart.input("u", -1.0, 1.0).unwrap(); // m/s²
    let flow = |push: Affine| [(x, x + STEP * v), (v, v + STEP * (u + push))];
    cart.mode("free").unwrap().next(flow(0.0.into())).unwrap().guard(x.le(WALL)).unwrap();
    let pushed = flow(PUSH * (WALL - x));
    cart.mode("pushed").unwrap().next(pushed).unwrap().guard(x.ge(WALL)).unwrap();
    let mut program = cart.program(STEPS).unwrap();
    let each = program.sum(x.square() + 0.5 * v.square() + 0.2 * u.square()).unwrap();
    let last = program.end(x.square() + v.square()).unwrap();
    program.minimize(each + 4.0 * last).unwrap();
    let axes = program.open_start([(x, -1.0..=1.0), (v, -1.0..=1.0)]).unwrap();
    let inputs = (0..STEPS).map(|step| program.at(u, step).unwrap()).collect();
    (program, axes, inputs)
}

/// The least costs from states, by a search; `None` without a plan.
fn optima(states: &[[f64; 2]]) -> Vec<Option<f64>> {
    let (program, axes, _) = cart();
    let mut solver = BranchAndBound::default();
    let mut online = solver.prepare(program.model()).unwrap();
    let mut optimum = |state: &[f64; 2]| {
        let values: Vec<_> = axes.iter().copied().zip(*state).collect();
        let found = online.solve(&values, &mut Control::default()).unwrap();
        assert!(found.is_optimal() || found.is_infeasible(), "{state:?}");
        found.objective()
    };
    states.iter().map(|state| optimum(state)).collect()
}

/// The file of this package is this text.
fn check(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    assert!(std::fs::read_to_string(&path).unwrap() == text, "{} is another", path.display());
}

#[test]
fn the_table_is_that_of_the_program() {
    let (program, axes, inputs) = cart();
    let explicit = ExplicitProgram::new(program.model(), axes, inputs).unwrap();
    let explicit = explicit.with_loss(0.1, 0.05).unwrap().with_finest(1.0 / 64.0).unwrap();
    let table = explicit.build();
    println!("{:?}", table.report());
    let source = table.single().rust_source("CART").unwrap();
    let first = "//! Written by `tests/table.rs` of the planners.";
    check("table/src/table.rs", &format!("{first}\n\n{source}"));
}

#[test]
fn states_of_the_page_have_these_optima() {
    let mut text =
        String::from("// Written by `tests/table.rs`: states that a search of carom has solved.\n");
    text += "// Position (m), speed (m/s), and the least cost; null where no plan exists.\n";
    text += "export const SOLVED = [\n";
    for ([x, v], best) in STATES.iter().zip(optima(&STATES)) {
        let best = best.map_or("null".to_owned(), |best| format!("{best:.4}"));
        text += &format!("  [{x}, {v}, {best}],\n");
    }
    check("www/solved_states.js", &(text + "];\n"));
}

/// Plans cost at least the optimum, and at most that and the loss; without a plan there is none.
#[test]
fn answers_are_those_of_a_search() {
    let mut bits = 1_u64;
    let mut random = || {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // A number that 32 bits hold.
        f64::from((bits >> 48) as u16) / 32768.0 - 1.0
    };
    let mut states: Vec<[f64; 2]> = (0..200).map(|_| [random(), random()]).collect();
    states.extend(STATES);
    let (mut plans, mut none) = (0, 0);
    for (state, best) in states.iter().zip(optima(&states)) {
        let [x, v] = *state;
        let (answer, inputs) = look_up(x as f32, v as f32);
        match answer {
            LookupAnswer::Plan { loss } => {
                let best = best.unwrap_or_else(|| panic!("{state:?}: a plan, and none online"));
                let cost = cost(x, v, inputs);
                let off = 1e-4 * (1.0 + best);
                assert!(cost >= best - off, "{state:?}: {cost} is less than {best}");
                assert!(cost <= best + f64::from(loss) + off, "{state:?}: {cost}, {best}, {loss}");
                assert!(inputs.iter().all(|input| input.abs() <= 1.0 + 1e-5), "{inputs:?}");
                plans += 1;
            }
            LookupAnswer::NoPlan => {
                assert_eq!(best, None, "{state:?}");
                none += 1;
            }
            other => assert_eq!(other, LookupAnswer::Open, "{state:?}"),
        }
    }
    println!("{plans} plans, {none} without a plan");
    assert!(plans >= 150 && none >= 3, "{plans} plans, {none} without a plan");
}
