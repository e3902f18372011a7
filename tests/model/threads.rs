//! What users hold can be sent to other threads and shared between them.

use carom::collision_tolerant::{Plan, Scenario, Wall};
use carom::explain::Explanation;
use carom::hybrid::HybridSystem;
use carom::hybrid::reach::ReachSets;
use carom::hybrid::{LinearSystem, ShortestHorizon};
use carom::prelude::*;
use carom::reformulate::{BigMReport, Lowered};
use carom::solution::Pool;
use carom::solver::MipStart;

fn shared<T: Send + Sync>() {}

/// Does not compile where one of them is not.
const _: fn() = || {
    shared::<Model>();
    shared::<Solution>();
    shared::<Pool>();
    shared::<Options>();
    shared::<BranchAndBound>();
    shared::<Error>();
    shared::<Interrupt>();
    shared::<MipStart>();
    shared::<Lowered>();
    shared::<BigMReport>();
    shared::<Explanation>();
    shared::<LinearSystem>();
    shared::<Wall>();
    shared::<HybridSystem>();
    shared::<ReachSets>();
    shared::<Scenario>();
    shared::<Plan>();
    shared::<ShortestHorizon<Plan>>();
};

/// A model that two threads solve at once, and a solution that they both read.
#[test]
fn models_and_solutions_are_shared_between_threads() {
    let mut model = Model::new("shared");
    let x = model.integer("x", 0.0, 10.0).unwrap();
    model.add("odd", (2.0 * x).within(3.0, 9.0)).unwrap();
    model.maximize(x).unwrap();
    let first = BranchAndBound::default().solve(&model).unwrap();
    std::thread::scope(|scope| {
        let same = || {
            let own = BranchAndBound::default().solve(&model).unwrap();
            (own.value(x).unwrap(), first.value(x).unwrap())
        };
        for thread in [scope.spawn(same), scope.spawn(same)] {
            assert_eq!(thread.join().unwrap(), (4.0, 4.0));
        }
    });
}
