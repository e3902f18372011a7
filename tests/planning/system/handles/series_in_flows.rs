//! Series in flows: the same system as with an input of one value in each step.

use carom::hybrid::HybridRun;
use carom::prelude::*;
use proptest::prelude::*;

/// A store whose demand is in the flow. It sells in one mode, and has a limit, a guard and an
/// output of both inputs that are stated before a mode's flow names a second series.
fn store(demand: &[f64], gain: &[f64], as_series: bool) -> HybridSystem {
    let mut store = HybridSystem::new(1.0);
    let x = store.state("x", -20.0, 20.0).unwrap();
    let u = store.input("u", -3.0, 3.0).unwrap();
    let known = |store: &mut HybridSystem, name: &str, values: &[f64]| match as_series {
        true => store.series(name, values).unwrap(),
        false => store.input(name, values.to_vec(), values.to_vec()).unwrap().into(),
    };
    let d = known(&mut store, "d", demand);
    let g = known(&mut store, "g", gain);
    store.next([x.is(x + u - d)]).unwrap();
    let fee = store.output("fee").unwrap();
    store.limit("pace", (x + u).le(19.0)).unwrap();
    store.mode("keep").unwrap().guard((x - u).ge(-19.0)).unwrap().output(fee, x + u).unwrap();
    store.mode("sell").unwrap().next([x.is(0.5 * x + u - d + g)]).unwrap();
    store
}

fn best(system: &HybridSystem, steps: usize) -> (Option<f64>, Vec<f64>, HybridRun) {
    let mut program = system.program(steps).unwrap();
    let x = program.system().state_named("x").unwrap();
    program.start([x.equals(1.0)]).unwrap();
    let cost = program.sum((x - 2.0).square()).unwrap();
    program.minimize(cost).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    let run = plan.run.clone();
    (plan.solution.objective(), run.state("x").unwrap().to_vec(), run)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn a_series_is_an_input_of_one_value(
        demand in prop::collection::vec(-2..=2_i32, 2..6),
        gain in prop::collection::vec(-2..=2_i32, 2..6),
    ) {
        let numbers = |values: Vec<i32>| values.into_iter().map(f64::from).collect::<Vec<f64>>();
        let (demand, gain) = (numbers(demand), numbers(gain));
        let [series, inputs] = [true, false].map(|own| store(&demand, &gain, own));
        prop_assert!(series.check().is_ok());
        let (one, other) = (best(&series, 4), best(&inputs, 4));
        prop_assert!((one.0.unwrap() - other.0.unwrap()).abs() < 1e-6);
        // The run is that of the numbers.
        let at = |values: &[f64], k: usize| values[k.min(values.len() - 1)];
        let (run, x) = (one.2, one.1);
        let u = run.input("u").unwrap();
        for (k, mode) in run.transitions("mode").unwrap().iter().enumerate() {
            let next = match mode.as_str() {
                "keep" => x[k] + u[k] - at(&demand, k),
                _ => 0.5 * x[k] + u[k] - at(&demand, k) + at(&gain, k),
            };
            prop_assert!((x[k + 1] - next).abs() < 1e-6);
        }
    }
}
