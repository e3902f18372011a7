//! How a backend behaves: options, limits, events, repetition.

use web_time::Duration;

use carom_model::error::{Error, ErrorKind};
use carom_model::model::{Model, mps};
use carom_model::solution::{Point, Solution, Termination};
use carom_model::solver::{Control, Event, Interrupt, Options, Solver};

use super::answer::Case;
use super::answer::Truth;
use super::judge::{self, Complaints, judge, sound};
use super::{answers, linear};

/// The value, or a complaint.
pub(super) fn or_complain<T>(result: Result<T, Error>, complaints: &mut Complaints) -> Option<T> {
    result.map_err(|error| complaints.add(format!("an unexpected error: {error}"))).ok()
}

/// Checks that the solver can still be used.
pub(super) fn usable(solver: &mut dyn Solver, interrupt: &Interrupt, complaints: &mut Complaints) {
    let Some(case) = or_complain(linear::knapsack(), complaints) else { return };
    let mut control = Control::default().with_interrupt(interrupt);
    match solver.solve_with(&case.model, &mut control) {
        Ok(solution) => {
            let mut again = Complaints::default();
            judge(solver.options(), &case, &solution, &mut again);
            if let super::CaseOutcome::Failed(texts) = again.outcome() {
                texts.iter().for_each(|text| complaints.add(format!("afterwards {text}")));
            }
        }
        Err(error) => complaints.add(format!("afterwards a solve fails: {error}")),
    }
}

pub(super) fn identity(solver: &mut dyn Solver, complaints: &mut Complaints) {
    complaints.unless(!solver.name().is_empty(), || "it has no name".into());
    let (name, before) = (solver.name().to_owned(), solver.options().clone());
    let changed = before.clone().with_relative_gap(0.125).with_absolute_gap(0.25);
    *solver.options_mut() = changed.clone();
    complaints.unless(*solver.options() == changed, || "changed options are not in force".into());
    complaints.unless(solver.name() == name, || "its name changes".into());
    *solver.options_mut() = before;
    usable(solver, &Interrupt::new(), complaints);
}

pub(super) fn refused_options(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(case) = or_complain(linear::knapsack(), complaints) else { return };
    let original = solver.options().clone();
    type OptionChange = fn(&mut Options);
    let refused: [(&str, OptionChange); 12] = [
        ("relative_gap -1", |o| o.relative_gap = -1.0),
        ("relative_gap inf", |o| o.relative_gap = f64::INFINITY),
        ("relative_gap NaN", |o| o.relative_gap = f64::NAN),
        ("absolute_gap -0.5", |o| o.absolute_gap = -0.5),
        ("absolute_gap NaN", |o| o.absolute_gap = f64::NAN),
        ("feasibility 0", |o| o.feasibility = 0.0),
        ("feasibility 0.1", |o| o.feasibility = 0.1),
        ("feasibility NaN", |o| o.feasibility = f64::NAN),
        ("integrality 0", |o| o.integrality = 0.0),
        ("integrality 0.5", |o| o.integrality = 0.5),
        ("threads 0", |o| o.threads = 0),
        ("threads 257", |o| o.threads = 257),
    ];
    for (what, change) in refused {
        complaints.about(what);
        change(solver.options_mut());
        match solver.solve(&case.model) {
            Err(error) if matches!(error.kind(), ErrorKind::OutOfRange { .. }) => {}
            Err(error) => complaints.add(format!("not `ErrorKind::OutOfRange`, but: {error}")),
            Ok(_) => complaints.add("it is not refused; call `Options::check` first"),
        }
        *solver.options_mut() = original.clone();
        usable(solver, &Interrupt::new(), complaints);
    }
}

/// A wide gap allows stopping early, not wrong bounds.
pub(super) fn gaps(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(case) = or_complain(linear::knapsack(), complaints) else { return };
    let original = solver.options().clone();
    for (gap, feasibility) in [(0.0, 1e-9), (1e6, 1e-3)] {
        complaints.about(format!("gap {gap}, feasibility {feasibility}"));
        let mut options = original.clone().with_relative_gap(gap).with_absolute_gap(gap);
        options.feasibility = feasibility;
        *solver.options_mut() = options.clone();
        if let Some(solution) = or_complain(solver.solve(&case.model), complaints) {
            let ended = solution.termination();
            complaints.unless(ended == Termination::Optimal, || format!("it ends with `{ended}`"));
            sound(&case.model, &solution, judge::optimum(&case), &options, complaints);
            let size = solution.objective().map_or(0.0, |objective| objective.abs().max(1.0));
            let allowed = gap * size + 1e-9 * size;
            complaints.unless(solution.gap() <= allowed, || format!("gap {}", solution.gap()));
        }
    }
    *solver.options_mut() = original;
    usable(solver, &Interrupt::new(), complaints);
}

/// Checks that a stopped solve has a valid bound, and a verified point if any, and that a finished
/// one is right.
fn stopped(
    solver: &dyn Solver,
    case: &Case,
    solution: &Solution,
    limit: Termination,
    complaints: &mut Complaints,
) {
    let ended = solution.termination();
    if ended == limit {
        complaints.unless(ended.is_limit(), || "the termination is not a limit".into());
        sound(&case.model, solution, judge::optimum(case), solver.options(), complaints);
    } else {
        judge(solver.options(), case, solution, complaints);
    }
}

/// A small program and one whose tree is large.
fn small_and_large() -> Result<[Case; 2], Error> {
    let model = linear::parity()?;
    let answer = Truth::Optimal(1.0, Vec::new());
    Ok([linear::knapsack()?, Case::new(model, answer)])
}

pub(super) fn node_limits(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(cases) = or_complain(small_and_large(), complaints) else { return };
    let original = solver.options().clone();
    // Workers that are busy when the limit is reached may finish their nodes.
    let threads = original.threads as u64;
    for limit in [0, 1, 2, 20] {
        for case in &cases {
            complaints.about(format!("limit {limit}, {}", case.name));
            *solver.options_mut() = original.clone().with_node_limit(limit);
            if let Some(solution) = or_complain(solver.solve(&case.model), complaints) {
                stopped(solver, case, &solution, Termination::NodeLimit, complaints);
                let nodes = solution.statistics().nodes;
                complaints.unless(nodes < limit + threads, || format!("{nodes} nodes"));
            }
            *solver.options_mut() = original.clone();
            usable(solver, &Interrupt::new(), complaints);
        }
    }
}

pub(super) fn no_time(solver: &mut dyn Solver, complaints: &mut Complaints) {
    time(solver, Duration::ZERO, complaints);
}

pub(super) fn short_time(solver: &mut dyn Solver, complaints: &mut Complaints) {
    time(solver, Duration::from_millis(200), complaints);
}

fn time(solver: &mut dyn Solver, limit: Duration, complaints: &mut Complaints) {
    let Some(cases) = or_complain(small_and_large(), complaints) else { return };
    let original = solver.options().clone();
    for case in &cases {
        complaints.about(&case.name);
        *solver.options_mut() = original.clone().with_time_limit(limit);
        if let Some(solution) = or_complain(solver.solve(&case.model), complaints) {
            stopped(solver, case, &solution, Termination::TimeLimit, complaints);
        }
        *solver.options_mut() = original.clone();
        usable(solver, &Interrupt::new(), complaints);
    }
}

pub(super) fn events(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(case) = or_complain(linear::knapsack(), complaints) else { return };
    // Many times, because with several threads it depends on timing which thread finds what.
    for _ in 0..20 {
        let mut events = Vec::new();
        let mut callback = |event: &Event| events.push(event.clone());
        let mut control = Control::default().with_progress(&mut callback);
        let solution = solver.solve_with(&case.model, &mut control);
        let Some(solution) = or_complain(solution, complaints) else { return };
        judge(solver.options(), &case, &solution, complaints);
        let roots = events.iter().filter(|event| matches!(event, Event::Root(_))).count();
        complaints.unless(roots == 1, || format!("{roots} events of the root"));
        let found = events.iter().filter(|event| matches!(event, Event::Incumbent(_)));
        let found: Vec<Option<f64>> = found.map(|event| event.progress().incumbent).collect();
        let better = found.windows(2).all(|pair| pair[0] < pair[1]);
        complaints.unless(better, || format!("incumbents do not improve: {found:?}"));
        complaints.unless(found.last().copied().flatten() == solution.objective(), || {
            format!("the last incumbent of {found:?} is not {:?}", solution.objective())
        });
        for event in &events {
            let progress = event.progress();
            let bound = progress.bound >= 18.0 - 18e-9;
            complaints.unless(bound, || format!("the bound is beyond 18 in {event:?}"));
            let point = progress.incumbent.is_none_or(|value| value <= 18.0 + 1e-5);
            complaints.unless(point, || format!("the incumbent is beyond 18 in {event:?}"));
        }
        let nodes: Vec<u64> = events.iter().map(|event| event.progress().nodes).collect();
        let last = nodes.last().is_none_or(|&last| last <= solution.statistics().nodes);
        complaints.unless(nodes.is_sorted() && last, || format!("counts of nodes: {nodes:?}"));
    }
}

pub(super) fn lazy_constraints(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(mut case) = or_complain(linear::knapsack(), complaints) else { return };
    let Some(x) = or_complain(case.model.variable_by_name(("x", 3)), complaints) else { return };
    // Without the last item, the first two are worth 17.
    let without = |_: &Point| Ok(vec![x.le(0.0)]);
    let mut control = Control::default().with_lazy_constraints(&without);
    match solver.solve_with(&case.model, &mut control) {
        Ok(solution) => {
            case.answer = Truth::Optimal(17.0, Vec::new());
            judge(solver.options(), &case, &solution, complaints);
        }
        Err(error) => {
            let refused = matches!(error.kind(), ErrorKind::Unsupported { .. });
            complaints.unless(refused, || format!("an unexpected error: {error}"));
        }
    }
    usable(solver, &Interrupt::new(), complaints);
}

pub(super) fn model_unchanged(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(mut case) = or_complain(linear::knapsack(), complaints) else { return };
    let text = |model: &Model| (model.to_string(), mps::write(model).ok());
    let before = text(&case.model);
    judge::solve(solver, &case, complaints);
    complaints.unless(text(&case.model) == before, || "the model has changed".into());
    // It can be changed and solved again: without the last item, the first two are worth 17.
    let largest = case.model.variable_by_name(("x", 3)).and_then(|x| case.model.fix(x, 0.0));
    if or_complain(largest, complaints).is_some() {
        case.answer = Truth::Optimal(17.0, Vec::new());
        complaints.about("after a change of the model");
        judge::solve(solver, &case, complaints);
    }
}

pub(super) fn twice(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(case) = or_complain(linear::knapsack(), complaints) else { return };
    let first = or_complain(solver.solve(&case.model), complaints);
    let second = or_complain(solver.solve(&case.model), complaints);
    let figures = |s: &Solution| (s.termination(), s.objective());
    let (first, second) = (first.as_ref().map(figures), second.as_ref().map(figures));
    complaints.unless(first == second, || format!("{first:?}, then {second:?}"));
}

pub(super) fn as_good_as_new(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(cases) = or_complain(answers(), complaints) else { return };
    for case in &cases {
        complaints.about(format!("after `{}`", case.name));
        // The outcome does not matter; it may be an error.
        let _ = solver.solve(&case.model);
        usable(solver, &Interrupt::new(), complaints);
        if !complaints.is_empty() {
            break;
        }
    }
}
