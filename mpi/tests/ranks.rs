//! The protocol on threads: ranks that are threads of this process.

mod programs;

use std::path::Path;
use std::thread;
use std::time::Duration;

use carom::prelude::*;
use carom_mpi::{Answer, Error, Run, ThreadChannel};
use programs::{knapsack, programs};

/// Solves a model on ranks that are threads; the answer is that of rank 0.
fn solve(model: &Model, run: &Run, ranks: usize) -> Result<Answer, Error> {
    let mut ends = ThreadChannel::ends(ranks);
    let workers: Vec<_> = ends.drain(1..).collect();
    thread::scope(|scope| {
        for mut end in workers {
            scope.spawn(move || run.solve_on(model, &mut end));
        }
        run.solve_on(model, &mut ends[0])
    })
}

fn solution(model: &Model, run: &Run, ranks: usize) -> Solution {
    solve(model, run, ranks).unwrap().solution.unwrap()
}

fn assert_same(solution: &Solution, alone: &Solution, what: &str) {
    assert_eq!(solution.termination(), alone.termination(), "{what}");
    let (own, other) = (solution.objective(), alone.objective());
    assert_eq!(own.is_some(), other.is_some(), "{what}");
    if let Some((own, other)) = own.zip(other) {
        assert!((own - other).abs() <= 2e-6 * own.abs().max(1.0), "{what}: {own}, alone {other}");
        assert!(solution.relative_gap() <= 1e-6 || solution.gap() <= 1e-7, "{what}");
        assert!(solution.verification().is_some_and(|check| check.holds()), "{what}");
    }
}

#[test]
fn any_number_of_ranks_comes_to_the_same_answer() {
    for model in programs() {
        let alone = BranchAndBound::default().solve(&model).unwrap();
        for ranks in [1, 2, 5] {
            for works in [true, false] {
                let run = Run::new(&Options::default()).with_working_root(works);
                let found = solution(&model, &run, ranks);
                assert_same(&found, &alone, &format!("{} on {ranks}, {works}", model.name()));
            }
        }
    }
}

#[test]
fn limits_leave_a_bound_that_holds_and_a_checkpoint_that_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    for (k, model) in programs().into_iter().enumerate() {
        let alone = BranchAndBound::default().solve(&model).unwrap();
        let sense = model.sense().sign();
        let path = folder.path().join(format!("{k}.checkpoint"));
        let (mut ranks, mut limit) = (3, 20);
        loop {
            let run = Run::new(&Options::default().with_node_limit(limit))
                .with_checkpoint(&path, Duration::from_millis(20))
                .with_resume(true);
            let found = solution(&model, &run, ranks);
            if found.termination() != Termination::NodeLimit {
                assert_same(&found, &alone, model.name());
                break;
            }
            if let Some(best) = alone.objective() {
                assert!(sense * found.bound() <= sense * best + 1e-6, "{}", model.name());
            }
            (ranks, limit) = (ranks % 4 + 1, limit * 2);
        }
        // What is finished stays so.
        let run = Run::new(&Options::default())
            .with_checkpoint(&path, Duration::from_secs(1))
            .with_resume(true);
        assert_same(&solution(&model, &run, 2), &alone, model.name());
    }
}

fn error(model: &Model, path: &Path, resumes: bool) -> String {
    let run = Run::new(&Options::default())
        .with_checkpoint(path, Duration::from_secs(1))
        .with_resume(resumes);
    let error = solve(model, &run, 2).unwrap_err().to_string();
    error.replace(&*path.to_string_lossy(), "FILE")
}

#[test]
fn bad_checkpoints_are_errors_and_stay_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let model = knapsack(24, 3);
    let run = Run::new(&Options::default().with_node_limit(30))
        .with_checkpoint(&path, Duration::from_secs(1));
    assert_eq!(solution(&model, &run, 2).termination(), Termination::NodeLimit);
    let whole = std::fs::read(&path).unwrap();

    assert_eq!(
        error(&model, &path, false),
        "checkpoint `FILE` exists; resume from it, remove it, or choose another file"
    );
    assert_eq!(
        error(&knapsack(24, 4), &path, true),
        "checkpoint `FILE` belongs to another model, or to this one with other options; resume with \
         what it was written for"
    );
    for length in 0..whole.len() {
        if length % 97 == 0 || length < 60 || length + 12 > whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let text = error(&model, &path, true);
            assert!(text.starts_with("checkpoint `FILE` is truncated: "), "{length}: {text}");
            assert_eq!(std::fs::read(&path).unwrap(), whole[..length]);
        }
    }
    for place in (0..whole.len()).step_by(61) {
        let mut changed = whole.clone();
        changed[place] ^= 0x10;
        std::fs::write(&path, &changed).unwrap();
        let text = error(&model, &path, true);
        assert!(text.starts_with("checkpoint `FILE` is "), "{place}: {text}");
        assert_eq!(std::fs::read(&path).unwrap(), changed);
    }
    std::fs::write(&path, [&whole[..], b"x"].concat()).unwrap();
    assert_eq!(
        error(&model, &path, true),
        "checkpoint `FILE` is corrupt: it goes on after its end; begin without it"
    );
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1, "no file is left behind");
}

#[test]
fn errors_of_models_are_errors_on_all_ranks() {
    let mut model = Model::new("m");
    let x = model.continuous("x", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    let on = model.binary("on").unwrap();
    model.add("row", on.on().implies(x.le(3.0))).unwrap();
    model.minimize(x).unwrap();
    let error = solve(&model, &Run::new(&Options::default()), 3).unwrap_err();
    assert!(matches!(error, Error::Carom(_)), "{error}");
    let options = Options::default().with_pool(3, carom::solver::PoolMode::Best);
    let error = solve(&knapsack(10, 1), &Run::new(&options), 2).unwrap_err();
    assert!(error.to_string().contains("a pool of several points"), "{error}");
}

#[test]
fn an_interrupt_ends_all_ranks() {
    let model = knapsack(60, 5);
    let interrupt = Interrupt::new();
    let run = Run::new(&Options::default()).with_interrupt(&interrupt);
    let found = thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(Duration::from_millis(300));
            interrupt.trigger();
        });
        solution(&model, &run, 3)
    });
    assert!(matches!(found.termination(), Termination::Interrupted | Termination::Optimal));
    assert!(found.objective().is_none_or(|best| found.bound() >= best - 1e-6));
}
