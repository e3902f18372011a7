//! What a relaxation leaves reaches the relaxations of the children, and no others.

use std::sync::{Arc, Mutex};

use carom::prelude::*;
use carom::solver::Heuristics;
use carom_solver::internals::presolve::Reduced;
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::{
    CascadePool, ClarabelRelaxation, Effort, MethodCascade, Relaxation, RelaxationResult, WarmState,
};

use crate::presolve::search_by;

/// What the method keeps: the columns that were open, and the relaxation's number.
struct Kept {
    number: usize,
    columns: Vec<usize>,
}

/// The numbers of the relaxations that were handed over, one entry a relaxation.
type Log = Arc<Mutex<Vec<Option<usize>>>>;

/// Clarabel, with a state that says where it comes from.
struct Counting {
    inner: ClarabelRelaxation,
    log: Log,
}

impl Relaxation for Counting {
    fn solve(&mut self, program: &Reduced, effort: &Effort<'_>) -> RelaxationResult {
        let mut log = self.log.lock().unwrap();
        let parent = effort.warm.map(|state| state.get::<Kept>().expect("its own state"));
        if let Some(parent) = parent {
            let known = |column: &usize| parent.columns.contains(column);
            assert!(program.columns.iter().all(known), "the state is an ancestor's");
        }
        let kept = Kept { number: log.len(), columns: program.columns.clone() };
        log.push(parent.map(|parent| parent.number));
        RelaxationResult { warm: Some(WarmState::new(kept)), ..self.inner.solve(program, effort) }
    }
}

/// A knapsack with two rows.
fn program() -> Program {
    let mut model = Model::new("knapsack");
    let take = model.binary_family("take", 16).unwrap();
    let sum = |k: u32, m: u32| {
        let term = |i: usize| f64::from((k * (i as u32 + 3)) % m + 5) * take[i];
        (0..16).map(term).sum::<Affine>()
    };
    model.add("room", sum(7, 23).le(90.0)).unwrap();
    model.add("weight", sum(11, 19).le(80.0)).unwrap();
    model.maximize(sum(13, 29)).unwrap();
    Program::assemble(&model).unwrap()
}

#[test]
fn children_receive_what_their_parents_leave() {
    let (program, log) = (program(), Log::default());
    let options = Options::default().with_heuristics(Heuristics::none()).with_probing(false);
    let all = log.clone();
    let cascades = CascadePool::with_cascades(&options, move || {
        let inner = ClarabelRelaxation::new();
        MethodCascade::with_method(Box::new(Counting { inner, log: all.clone() }))
    });
    let found = search_by(&program, &|_: &[f64]| true, &options, &cascades);
    assert_eq!(found.termination, Termination::Optimal);
    let log = log.lock().unwrap();
    let counts = found.statistics.relaxation_counts;
    assert_eq!(log.len() as u64, counts.total());
    assert!(log.len() > 20, "{}", log.len());
    assert_eq!(log[0], None, "the root has no parent");
    // Whoever comes after the root has one, and it came before.
    assert!(log.iter().enumerate().skip(1).all(|(k, parent)| parent.is_some_and(|p| p < k)));
    let mut parents: Vec<_> = log.iter().flatten().collect();
    parents.sort_unstable();
    parents.dedup();
    assert!(parents.len() > 5, "not all from one node: {parents:?}");
}

/// A state of another method is passed over, not misread.
#[test]
fn states_are_read_by_who_made_them() {
    let state = WarmState::new(7_u32);
    assert_eq!(state.clone().get::<u32>(), Some(&7));
    assert_eq!(state.get::<Kept>().map(|kept| kept.number), None);
}
