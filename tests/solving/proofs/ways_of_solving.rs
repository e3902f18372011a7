//! Proofs of solves in every way: no way of solving leaves an answer without its log, or without a
//! word.

use carom::model::Model;
use carom::prelude::*;
use carom::solver::{MipStart, PoolMode};
use carom_proof::check;

use super::file;

/// Chooses things of the largest value below a weight that is a parameter.
fn knapsack() -> Result<(Model, Vec<Variable>, Variable), Error> {
    let mut model = Model::new("knapsack");
    let x: Vec<Variable> =
        (0..9).map(|k| model.binary(format!("x[{k}]"))).collect::<Result<_, _>>()?;
    let most = model.parameter("most", 17.0, 5.0, 25.0)?;
    let sum = |of: &[f64]| x.iter().zip(of).map(|(x, a)| *x * *a).sum::<Affine>();
    let weight = sum(&[5.0, 7.0, 4.0, 3.0, 6.0, 5.0, 9.0, 2.0, 8.0]);
    model.add("weight", (weight - most).le(0.0))?;
    model.maximize(sum(&[8.0, 11.0, 6.0, 4.0, 9.0, 7.0, 13.0, 3.0, 12.0]))?;
    Ok((model, x, most))
}

/// Checks the log of a solution at a path.
fn is_proved(solution: &Solution, path: &std::path::Path, name: &str) {
    let report = solution.proof().unwrap_or_else(|| panic!("{name}: no log"));
    assert!(report.is_complete, "{name}: {report:?}");
    let log = std::fs::read(path).expect("a log");
    assert_eq!(report.bytes, log.len() as u64, "{name}");
    let proved = check(&log[..]).unwrap_or_else(|failure| panic!("{name}: {failure}"));
    let objective = solution.objective().expect("a point");
    match proved.claim {
        carom_proof::Claim::Bound(bound) => {
            assert!((bound + objective).abs() < 1e-4 * objective.abs(), "{name}: {bound}");
        }
        claim => panic!("{name}: {claim:?}"),
    }
}

/// Threads, rounds, pools, no presolve, leaves, a start.
#[test]
fn options_leave_no_answer_without_a_log() -> Result<(), Error> {
    let (model, x, _) = knapsack()?;
    let start = MipStart::new().with_values(x.iter().map(|x| (*x, 0.0)));
    let plain = Options::default;
    for (name, options) in [
        ("threads", plain().with_threads(3)),
        ("rounds", plain().with_deterministic(true).with_threads(2)),
        ("pool", plain().with_pool(4, PoolMode::Best)),
        ("leaves", plain().with_leaves(true)),
        ("without presolve", plain().with_presolve(false)),
        ("without cuts", plain().with_cuts(false)),
    ] {
        let path = file(&format!("way_{name}"));
        let mut solver = BranchAndBound::new(options.with_proof(&path));
        is_proved(&solver.solve(&model)?, &path, name);
        let mut control = Control::default().with_start(&start);
        is_proved(&solver.solve_with(&model, &mut control)?, &path, name);
    }
    Ok(())
}

/// A program of blocks is searched block by block, and one log proves the sum.
#[test]
fn blocks_have_one_log() -> Result<(), Error> {
    let mut model = Model::new("blocks");
    let mut cost = Affine::default();
    for k in 0..3 {
        let n = model.integer(format!("n{k}"), 0.0, 9.0)?;
        let m = model.integer(format!("m{k}"), 0.0, 9.0)?;
        model.add(format!("row{k}"), (n * 3.0 + m * 5.0).ge(7.0 + k as f64))?;
        cost += n * 2.0 + m * 3.5;
    }
    model.minimize(cost)?;
    let path = file("way_blocks");
    let solution = BranchAndBound::new(Options::default().with_proof(&path)).solve(&model)?;
    let log = std::fs::read(&path).expect("a log");
    assert!(solution.proof().is_some_and(|report| report.is_complete));
    assert_eq!(check(&log[..]).expect("a proof").points.len(), 1);
    Ok(())
}

/// Each solve of a prepared model has a log, which is about the values of its parameters.
#[test]
fn prepared_solves_have_logs() -> Result<(), Error> {
    let (model, _, most) = knapsack()?;
    let path = file("way_prepared");
    let mut solver = BranchAndBound::new(Options::default().with_proof(&path));
    let mut prepared = solver.prepare(&model)?;
    for weight in [17.0, 9.0, 21.0, 5.0] {
        let solution = prepared.solve(&[(most, weight)], &mut Control::default())?;
        is_proved(&solution, &path, &format!("prepared {weight}"));
        let mut plain = BranchAndBound::default();
        let plain = plain.prepare(&model)?.solve(&[(most, weight)], &mut Control::default())?;
        assert_eq!(solution.objective(), plain.objective());
    }
    Ok(())
}

/// Lazy constraints and user cuts that were found are rows of the program in the log, which is
/// written once.
#[test]
fn rows_that_are_found_are_rows_of_the_log() -> Result<(), Error> {
    let (model, x, _) = knapsack()?;
    let pairs: Vec<(Variable, Variable)> = x.windows(2).map(|pair| (pair[0], pair[1])).collect();
    let lazy = |point: &carom::solution::Point| {
        let is_both =
            |(a, b): &&(Variable, Variable)| point.value(*a + *b).is_ok_and(|sum| sum > 1.5);
        Ok(pairs.iter().filter(is_both).map(|(a, b)| (*a + *b).le(1.0)).collect::<Vec<Row>>())
    };
    let folder = file("way_lazy");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let mut solver = BranchAndBound::new(Options::default().with_proof(&folder));
    let mut control = Control::default().with_lazy_constraints(&lazy);
    let solution = solver.solve_with(&model, &mut control)?;
    assert!(solution.statistics().lazy_constraints > 0);
    let logs: Vec<_> = std::fs::read_dir(&folder).expect("the folder").flatten().collect();
    assert_eq!(logs.len(), 1, "one log");
    is_proved(&solution, &logs[0].path(), "lazy");
    // The model with all rows has the same answer; the log is about it.
    let mut whole = model.clone();
    for (k, (a, b)) in pairs.iter().enumerate() {
        whole.add(format!("pair{k}"), (*a + *b).le(1.0))?;
    }
    assert_eq!(BranchAndBound::default().solve(&whole)?.objective(), solution.objective());
    let log = std::fs::read_to_string(logs[0].path()).expect("a log");
    let rows = 1 + solution.statistics().lazy_constraints;
    assert!(log.contains(&format!("rows {rows}\n")), "{rows}");
    Ok(())
}

/// Without a bound there is no log, and the solution says so.
#[test]
fn an_unbounded_model_has_no_log() -> Result<(), Error> {
    let mut model = Model::new("unbounded");
    let n = model.integer("n", 0.0, f64::INFINITY)?;
    model.maximize(n)?;
    let path = file("way_unbounded");
    let _ = std::fs::remove_file(&path);
    let solution = BranchAndBound::new(Options::default().with_proof(&path)).solve(&model)?;
    assert!(solution.proof().is_none() && !path.exists(), "{:?}", solution.termination());
    Ok(())
}
