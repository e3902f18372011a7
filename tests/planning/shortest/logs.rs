//! Logs of refuted horizons and of the plan, judged by a checker that shares no code with the
//! crate.

use std::cell::Cell;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use carom::ErrorKind;
use carom::collision_tolerant::{Objective, Scenario};
use carom::hybrid::scene::{Body, DamageRule, Scene, Surface};
use carom::hybrid::{
    HorizonEvent, HorizonModel, HybridSystem, Mission, Monotonicity, Restitution, ShortestHorizon,
    ShortestOptions, ShortestStatus, When, shortest_horizon,
};
use carom::prelude::*;
use carom::solver::{Control, Interrupt};
use carom_proof::{Claim, check};
use carom_solver::internals::proof::write_proof_of;

/// An empty folder of its own for a test, which does not exist yet.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("horizons").join(name);
    fs::remove_dir_all(&folder).ok();
    folder
}

/// A solver that writes logs to a folder.
fn logging(folder: &Path) -> BranchAndBound {
    BranchAndBound::new(Options::default().with_proof(folder))
}

/// Checks that there is a log for every horizon of the outcome, that each is accepted, and that
/// each claims what the outcome says. Returns the point of the plan by column.
fn is_proved<P>(found: &ShortestHorizon<P>, folder: &Path) -> HashMap<String, f64> {
    assert_eq!(found.unlogged().collect::<Vec<_>>(), [0; 0]);
    let refuted = found.refuted_steps.unwrap_or(0);
    let said: Vec<usize> = (1..=refuted).chain(found.steps).collect();
    assert_eq!(found.proofs.iter().map(|proof| proof.steps).collect::<Vec<_>>(), said);
    let mut names: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    let paths: Vec<PathBuf> = found.proofs.iter().map(|proof| proof.path.clone()).collect();
    assert_eq!(names, paths, "other files than logs of horizons, or fewer");
    let mut point = HashMap::new();
    for proof in &found.proofs {
        let log = fs::read(&proof.path).unwrap();
        assert_eq!(proof.report.as_ref().unwrap().bytes, log.len() as u64);
        let proved = check(&log[..]).unwrap_or_else(|error| panic!("{}: {error}", proof.steps));
        let is_plan = found.steps == Some(proof.steps);
        assert_eq!(matches!(proved.claim, Claim::Infeasible), !is_plan, "{}", proof.steps);
        assert_eq!(proved.points.len(), usize::from(is_plan));
        for point in &proved.points {
            let violation = point.to_string();
            let violation = violation.rsplit(' ').next().unwrap().parse::<f64>().unwrap();
            assert!(violation <= 1e-6, "{point}");
        }
        if is_plan {
            point = values(&String::from_utf8(log).unwrap());
        }
    }
    point
}

/// The values of the point of a log, by the names of the columns.
fn values(log: &str) -> HashMap<String, f64> {
    let header = log.lines().take_while(|line| *line != "proof");
    let columns = header.filter_map(|line| line.strip_prefix("c "));
    let names: Vec<&str> = columns.map(|line| line.splitn(4, ' ').nth(3).unwrap()).collect();
    let mut values: HashMap<String, f64> =
        names.iter().map(|name| ((*name).to_owned(), 0.0)).collect();
    let point = log.lines().find_map(|line| line.strip_prefix("a ")).unwrap();
    let words: Vec<&str> = point.split(' ').skip(1).collect();
    for entry in words.chunks(2) {
        values.insert(
            names[entry[0].parse::<usize>().unwrap()].to_owned(),
            entry[1].parse().unwrap(),
        );
    }
    values
}

/// The program that a log states.
fn stated(log: &str) -> &str {
    log.split("\nclaim ").next().unwrap()
}

/// Both laws of the paper, with and without collisions, and with a limit on the damage; every
/// program is the one that the scenario states, without what sets say.
#[test]
fn the_paper_is_logged() -> Result<(), Error> {
    let paper = Scenario::paper().with_time_step(0.1).with_restitution(0.5)?;
    let gentle = paper.clone().with_damage(DamageRule::default().with_per_hit(6.0));
    for (name, scenario) in
        [("free", paper.clone().collision_free()), ("open", paper), ("gentle", gentle)]
    {
        let folder = folder(&format!("paper_{name}"));
        let options = ShortestOptions::default();
        let without = scenario.shortest_with(&options, &mut BranchAndBound::default())?;
        assert!(without.proofs.is_empty());
        let said = without.refuted_steps.unwrap() + 1;
        assert_eq!(without.unlogged().count(), said);
        let mut solver = logging(&folder);
        let found = scenario.shortest_with(&options, &mut solver)?;
        assert_eq!(solver.options().proof.as_deref(), Some(&*folder));
        assert!(found.is_found());
        assert_eq!((found.steps, found.refuted_steps), (without.steps, without.refuted_steps));
        let values = is_proved(&found, &folder);
        let (plan, other) = (found.plan.unwrap(), without.plan.unwrap());
        assert_eq!(plan.fewest_impacts, other.fewest_impacts);
        assert_eq!(plan.trajectory.impacts.len(), other.trajectory.impacts.len());
        for (t, x) in plan.trajectory.position.iter().enumerate() {
            assert!((values[&format!("vehicle_x[{t}]")] - x).abs() <= 1e-9, "{name}: {t}");
        }
        for proof in &found.proofs {
            let is_plan = found.steps == Some(proof.steps);
            let objective = if is_plan { Objective::Impacts } else { Objective::Feasibility };
            let program = scenario.program(proof.steps, objective)?;
            let mut plain = Vec::new();
            let _report = write_proof_of(program.model(), None, &mut plain)?;
            let (log, plain) = (fs::read(&proof.path).unwrap(), plain);
            let (log, plain) = (String::from_utf8_lossy(&log), String::from_utf8_lossy(&plain));
            assert_eq!(stated(&log), stated(&plain), "{name}: {}", proof.steps);
        }
    }
    Ok(())
}

/// A comparison has a folder for each of its two searches.
#[test]
fn a_comparison_has_two_folders() -> Result<(), Error> {
    let folder = folder("comparison");
    let scenario = Scenario::paper().with_time_step(0.2);
    let both = scenario.compare(&ShortestOptions::default(), &mut logging(&folder))?;
    is_proved(&both.free, &folder.join("free"));
    is_proved(&both.tolerant, &folder.join("tolerant"));
    Ok(())
}

/// A cart that moves by at most 1 a step.
fn cart() -> Result<(HybridSystem, carom::hybrid::State, Input), Error> {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", -9.0, 9.0)?;
    let v = cart.input("v", -1.0, 1.0)?;
    cart.mode("roll")?.next([x.is(x + v)])?;
    Ok((cart, x, v))
}

/// Systems: alone, with a window, with rows, with a mission, and without a plan.
#[test]
fn systems_are_logged() -> Result<(), Error> {
    let (cart, x, v) = cart()?;
    let options = ShortestOptions::default();
    let depot = Mission::holds("at the depot", [x.within(-2.0, -1.0)]);
    let mission = depot.always(0..=1).eventually(0..);
    let slow = move |program: &mut carom::hybrid::HybridProgram| {
        for t in (0..program.steps()).step_by(2) {
            program.add(("slow", t), program.at(v.le(0.5), t)?)?;
        }
        Ok(())
    };
    let window = options.clone().with_window("depot", [x.le(-1.0)], When::OnceIn(2..=5));
    let cases = [
        ("system", options.clone(), Some(3)),
        ("window", window, Some(6)),
        ("rows", options.clone().with_rows(slow), Some(4)),
        ("mission", options.clone().with_mission("mission", &mission), Some(6)),
        ("short", options.with_max_steps(2), None),
    ];
    for (name, options, steps) in cases {
        let folder = folder(name);
        let (start, goal) = ([x.equals(0.0)], [x.equals(3.0)]);
        let found = cart.shortest_with(start, goal, &options, &mut logging(&folder))?;
        assert_eq!(found.steps, steps, "{name}");
        if steps.is_none() {
            assert_eq!(found.status, ShortestStatus::NoneWithin { max_steps: 2 });
        }
        let values = is_proved(&found, &folder);
        if let Some(plan) = found.plan {
            let last = plan.run.states[0].1.last().unwrap();
            assert!((last - values[&format!("x[{}]", steps.unwrap())]).abs() <= 1e-9, "{name}");
        }
    }
    Ok(())
}

/// Scenes: a puck that bounces; one whose hits couple two bodies, where any plan will do.
#[test]
fn scenes_are_logged() -> Result<(), Error> {
    let table = [0.0..=2.0];
    let bounce = || Ok::<_, Error>(Surface::bounce(Restitution::new(0.9)?));
    let puck =
        Body::new("puck", table.clone(), 3.0, 3.0).with_start([1.2, 2.0]).with_goal([0.4, 0.0]);
    let other =
        Body::new("other", table.clone(), 3.0, 3.0).with_start([0.1, 0.0]).with_goal([0.1, 0.0]);
    let alone = Scene::new(0.1).with_body(puck.clone()).with_room("cushion", &table, bounce()?);
    let mut two = Scene::new(0.2);
    let pair = [two.body(puck)?, two.body(other)?];
    two.pair(pair[0], pair[1], bounce()?)?;
    for (name, scene) in [("puck", alone), ("two", two)] {
        let folder = folder(name);
        let found = scene.shortest(&mut logging(&folder))?;
        assert!(found.is_found(), "{name}: {found}");
        let values = is_proved(&found, &folder);
        let plan = found.plan.unwrap();
        for (t, position) in plan.bodies[0].position.iter().enumerate() {
            assert!((position[0] - values[&format!("puck_x[{t}]")]).abs() <= 1e-9, "{name}");
        }
    }
    Ok(())
}

/// A family of programs of one's own: an even number of at most twice the steps that is at least 7.
struct Own;

impl HorizonModel for Own {
    type Program = Model;

    fn build(&self, steps: usize) -> Result<Model, Error> {
        let mut model = Model::new("own");
        let n = model.integer("n", 0.0, steps as f64)?;
        model.add("least", (n * 2.0).ge(7.0))?;
        Ok(model)
    }

    fn monotonicity(&self) -> Monotonicity {
        Monotonicity::NotMonotone("nobody knows".into())
    }
}

/// Programs of one's own. What an earlier search has left in the folder does not count.
#[test]
fn programs_of_ones_own_are_logged() -> Result<(), Error> {
    let folder = folder("own");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("steps_000002.proof"), "old").unwrap();
    let found = shortest_horizon(&Own, &ShortestOptions::default(), &mut logging(&folder))?;
    assert_eq!(found.steps, Some(4));
    assert_eq!(is_proved(&found, &folder)["n"], 4.0);
    Ok(())
}

/// A fixed horizon that sets refute has a log of the program that the scenario states.
#[test]
fn fixed_horizons_are_logged_without_sets() -> Result<(), Error> {
    let scenario = Scenario::paper().with_time_step(0.1);
    let path = folder("fixed").with_extension("proof");
    fs::remove_file(&path).ok();
    let error = scenario.plan(20, Objective::Effort, &mut logging(&path)).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NoPlan { .. }), "{error}");
    let log = fs::read_to_string(&path).unwrap();
    assert_eq!(check(log.as_bytes()).unwrap().claim, Claim::Infeasible);
    let (program, mut plain) = (scenario.program(20, Objective::Effort)?, Vec::new());
    let _report = write_proof_of(program.model(), None, &mut plain)?;
    assert_eq!(stated(&log), stated(&String::from_utf8(plain).unwrap()));
    Ok(())
}

/// A folder that cannot be made is an error before the search begins, and the option stays.
#[test]
fn a_folder_that_cannot_be_made_is_an_error() -> Result<(), Error> {
    let file = folder("a_file");
    fs::create_dir_all(file.parent().unwrap()).unwrap();
    fs::write(&file, "").unwrap();
    let (cart, x, _) = cart()?;
    for path in [file.clone(), file.join("below")] {
        let mut solver = logging(&path);
        let error = cart.shortest([x.equals(0.0)], [x.equals(3.0)], &mut solver).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::Io { .. }), "{error}");
        assert_eq!(
            error.to_string(),
            format!(
                "the proofs cannot be written to {}; choose a folder that can be made and written",
                path.display()
            )
        );
        assert_eq!(solver.options().proof.as_deref(), Some(&*path));
    }
    fs::remove_file(&file).ok();
    Ok(())
}

/// A folder that goes while logs are written does not lose the plan, and ends the logs.
#[test]
fn a_folder_that_goes_does_not_lose_the_plan() -> Result<(), Error> {
    let folder = folder("gone");
    let (cart, x, _) = cart()?;
    let (start, goal) = ([x.equals(0.0)], [x.equals(6.0)]);
    let plain = cart.shortest(start.clone(), goal.clone(), &mut BranchAndBound::default())?;
    let (gone, logged) = (folder.clone(), Arc::new(AtomicUsize::new(0)));
    let count = Arc::clone(&logged);
    let watch = move |event: &HorizonEvent| {
        if let HorizonEvent::Logged(_) = event {
            count.fetch_add(1, Ordering::Relaxed);
            fs::remove_dir_all(&gone).ok();
        }
    };
    let options = ShortestOptions::default().with_progress(watch);
    let found = cart.shortest_with(start, goal, &options, &mut logging(&folder))?;
    assert!(found.is_found());
    assert_eq!((found.steps, found.refuted_steps), (plain.steps, plain.refuted_steps));
    // The plan has the first log. The next one cannot be written, and no other is tried.
    let failures = found.proofs.iter().filter_map(|proof| proof.report.as_ref()?.failure.as_ref());
    let failures: Vec<&String> = failures.collect();
    assert_eq!(failures.len(), 1, "{:?}", found.proofs);
    assert!(failures[0].contains("steps_000001.proof"), "{failures:?}");
    assert_eq!(logged.load(Ordering::Relaxed), found.proofs.len());
    assert_eq!(found.unlogged().count(), found.refuted_steps.unwrap());
    Ok(())
}

/// What an interrupt leaves out is listed; the outcome of the search stays.
#[test]
fn horizons_without_a_log_are_listed() -> Result<(), Error> {
    let folder = folder("interrupted");
    let interrupt = Interrupt::new();
    let scenario = Scenario::paper().with_time_step(0.2);
    let logged = Arc::new(AtomicUsize::new(0));
    let (count, trigger) = (Arc::clone(&logged), interrupt.clone());
    let watch = move |event: &HorizonEvent| {
        if let HorizonEvent::Logged(proof) = event {
            count.fetch_add(1, Ordering::Relaxed);
            if proof.steps == 5 {
                trigger.trigger();
            }
        }
    };
    let options = ShortestOptions::default().with_interrupt(&interrupt).with_progress(watch);
    let found = scenario.shortest_with(&options, &mut logging(&folder))?;
    let (steps, refuted) = (found.steps.unwrap(), found.refuted_steps.unwrap());
    assert!(found.is_found() && refuted > 6);
    assert_eq!(found.unlogged().collect::<Vec<_>>(), (6..=refuted).collect::<Vec<_>>());
    assert_eq!(found.proofs.len(), steps);
    assert_eq!(logged.load(Ordering::Relaxed), steps);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 6);
    Ok(())
}

/// A solver that writes no logs.
struct Silent<'a>(BranchAndBound, &'a Cell<usize>);

impl Solver for Silent<'_> {
    fn name(&self) -> &str {
        "silent"
    }

    fn options(&self) -> &Options {
        self.0.options()
    }

    fn options_mut(&mut self) -> &mut Options {
        self.0.options_mut()
    }

    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        let asked = self.0.options_mut().proof.take();
        self.1.set(self.1.get() + usize::from(asked.is_some()));
        let solution = self.0.solve_with(model, control);
        self.0.options_mut().proof = asked;
        solution
    }
}

/// A solver that writes no logs is not asked again for each horizon, and all horizons are listed.
#[test]
fn solvers_without_logs_are_asked_once() -> Result<(), Error> {
    let (folder, asked) = (folder("silent"), Cell::new(0));
    let (cart, x, _) = cart()?;
    let mut solver = Silent(logging(&folder), &asked);
    let found = cart.shortest([x.equals(0.0)], [x.equals(8.0)], &mut solver)?;
    assert_eq!((found.steps, asked.get()), (Some(8), 1));
    assert_eq!(found.unlogged().count(), 8);
    assert!(found.proofs.iter().all(|proof| proof.report.is_none() && !proof.path.exists()));
    Ok(())
}

#[test]
fn horizons_of_a_nonlinear_system_are_proved() {
    let mut pendulum = HybridSystem::new(0.25); // s
    let angle = pendulum.state("angle", -1.0, 4.0).unwrap(); // rad from hanging
    let rate = pendulum.state("rate", -8.0, 8.0).unwrap(); // rad/s
    let motor = pendulum.input("motor", -15.0, 15.0).unwrap(); // rad/s²
    let swing = [angle.is(rate), rate.is(motor - 9.81 * angle.sin())];
    pendulum.mode("swing").unwrap().rates(swing).unwrap();
    let start = [angle.equals(0.0), rate.equals(0.0)];
    let goal: [carom::hybrid::SystemRow; 1] = [angle.cos().le(-0.9).into()];
    let folder = folder("pendulum");
    let found = pendulum.shortest(start, goal, &mut logging(&folder)).unwrap();
    assert!(found.steps.is_some_and(|steps| steps > 1), "{:?}", found.steps);
    is_proved(&found, &folder);
}
