//! Interrupts: before the start, from another thread, from within the callback.

use std::thread;

use web_time::Duration;

use carom_model::model::Model;
use carom_model::solution::{Solution, Termination};
use carom_model::solver::{Control, Event, Interrupt, Solver};

use super::conduct::{or_complain, usable};
use super::judge::{Complaints, sound};
use super::linear;

/// The optimum of [`linear::parity`].
const OPTIMUM: f64 = 1.0;

/// Checks that an interrupted solve says so, unless it finished first.
fn interrupted(
    solver: &dyn Solver,
    model: &Model,
    solution: &Solution,
    complaints: &mut Complaints,
) {
    let ended = solution.termination();
    let heard = matches!(ended, Termination::Interrupted | Termination::Optimal);
    complaints.unless(heard, || format!("it ended with `{ended}` instead of `interrupted`"));
    sound(model, solution, OPTIMUM, solver.options(), complaints);
}

pub(super) fn before(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(model) = or_complain(linear::parity(), complaints) else { return };
    let interrupt = Interrupt::new();
    interrupt.trigger();
    let mut control = Control::default().with_interrupt(&interrupt);
    let solution = solver.solve_with(&model, &mut control);
    if let Some(solution) = or_complain(solution, complaints) {
        let ended = solution.termination();
        complaints.unless(ended == Termination::Interrupted, || format!("it ended with `{ended}`"));
        sound(&model, &solution, OPTIMUM, solver.options(), complaints);
    }
    complaints.unless(interrupt.is_triggered(), || "the interrupt was reset".into());
    interrupt.reset();
    usable(solver, &interrupt, complaints);
}

/// Waits a little, because there may be no events that tell when the search is running.
pub(super) fn from_another_thread(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(model) = or_complain(linear::parity(), complaints) else { return };
    for wait in [1, 20, 150] {
        complaints.about(format!("after {wait} ms"));
        let interrupt = Interrupt::new();
        let solution = thread::scope(|scope| {
            let other = interrupt.clone();
            let trigger = move || {
                thread::sleep(Duration::from_millis(wait));
                other.trigger();
            };
            // Without threads, there is nothing to test.
            thread::Builder::new().spawn_scoped(scope, trigger).ok()?;
            let mut control = Control::default().with_interrupt(&interrupt);
            Some(solver.solve_with(&model, &mut control))
        });
        let Some(solution) = solution else { return };
        if let Some(solution) = or_complain(solution, complaints) {
            interrupted(solver, &model, &solution, complaints);
        }
        interrupt.reset();
        usable(solver, &interrupt, complaints);
    }
}

pub(super) fn from_within(solver: &mut dyn Solver, complaints: &mut Complaints) {
    let Some(model) = or_complain(linear::parity(), complaints) else { return };
    for wait_for_incumbent in [false, true] {
        let at = if wait_for_incumbent { "first incumbent" } else { "first event" };
        complaints.about(format!("at the {at}"));
        let interrupt = Interrupt::new();
        let mut callback = |event: &Event| {
            if !wait_for_incumbent || matches!(event, Event::Incumbent(_)) {
                interrupt.trigger();
            }
        };
        let mut control =
            Control::default().with_progress(&mut callback).with_interrupt(&interrupt);
        let solution = solver.solve_with(&model, &mut control);
        if let Some(solution) = or_complain(solution, complaints) {
            interrupted(solver, &model, &solution, complaints);
            let kept = !wait_for_incumbent || solution.objective().is_some();
            complaints.unless(kept, || "the incumbent is lost".into());
        }
        interrupt.reset();
        usable(solver, &interrupt, complaints);
    }
}
