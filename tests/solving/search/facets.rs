//! Facets of unions: what is told of a search that begins again with them, and how they are left
//! out.

use carom::model::Method;
use carom::prelude::*;
use carom::reformulate::compare_methods;
use carom::solution::FacetCounts;

/// The fuel of a car whose engine is off, on or starting, stated with one M for each row, and its
/// energy at the start.
pub(crate) fn car(steps: usize) -> Result<(HybridProgram, Affine), Error> {
    let mut car = HybridSystem::new(1.0); // s
    let energy = car.state("energy", 0.0, 20.0)?; // kJ
    let power = car.input("power", 0.0, 10.0)?; // kW
    let need = |k: f64| 2.0 + (0.9 * k).sin() + (0.23 * k).cos();
    let need: Vec<f64> = (0..steps).map(|k| need(k as f64)).collect();
    let need = car.input("need", need.clone(), need)?; // kW
    car.next([energy.is(energy + power - need)])?;
    let fuel = car.output("fuel")?;
    let [off, on] = car.modes("engine", ["off", "on"])?;
    car.stay(off)?.guard(power.le(0.0))?;
    car.stay(on)?.guard(power.ge(3.0))?.output(fuel, 2.0 + power)?;
    car.switch(off, on)?.guard(power.ge(3.0))?.output(fuel, 5.0 + power)?;
    car.switch(on, off)?.guard(power.le(0.0))?;
    let mut program = car.program_with(steps, Method::BigM)?;
    program.start([off.equals(1.0)])?;
    program.goal([energy.ge(8.0)])?;
    program.minimize(program.sum(fuel)?)?;
    let first = program.at(energy, 0)?;
    Ok((program, first))
}

/// The car, with some energy at the start.
fn started(steps: usize) -> Result<HybridProgram, Error> {
    let (mut program, first) = car(steps)?;
    program.add("begin", first.equals(8.0))?;
    Ok(program)
}

/// A solve, its events of facets, and its log.
fn solve(model: &Model, options: Options) -> Result<(Solution, Vec<Event>, String), Error> {
    let (mut log, mut told) = (Log::new(Vec::new()), Vec::new());
    let mut record = |event: &Event| {
        log.record(event);
        told.extend(Some(event.clone()).filter(|event| matches!(event, Event::BegunAgain(..))));
    };
    let mut control = Control::default().with_progress(&mut record);
    let solution = BranchAndBound::new(options).solve_with(model, &mut control)?;
    log.finish(&solution);
    let log = log.into_inner().map(String::from_utf8);
    Ok((solution, told, log.expect("a log").expect("text")))
}

#[test]
fn a_search_tells_of_its_facets() -> Result<(), Error> {
    let program = started(26)?;
    let few = Options::default().with_node_limit(510);
    let (with, told, log) = solve(program.model(), few.clone())?;
    let counts = with.statistics().facets;
    assert!(counts.facets > 0 && counts.unions > 0 && counts.unions <= counts.all_unions);
    let best = with.objective().expect("a point");
    let FacetCounts { root_before, root_after, .. } = counts;
    assert!(root_before < root_after && root_after < best + 1e-6, "{counts:?} of {best}");
    assert!(with.bound() > root_after - 1e-3, "{with:?}");
    assert_eq!(counts.lift(), root_after - root_before);
    let [Event::BegunAgain(told, progress)] = &told[..] else { panic!("{told:?}") };
    assert_eq!(*told, counts);
    assert!(progress.nodes >= 500 && progress.nodes <= with.statistics().nodes, "{progress:?}");
    let nodes = progress.nodes;
    let again = format!("the search begins again after {nodes} nodes: {counts} lift the root from");
    assert!(log.contains(&again), "{log}");
    assert_eq!(log.matches(&format!("{counts} lift the root from ")).count(), 2, "{log}");

    let (without, told, log) = solve(program.model(), few.with_facets(false))?;
    assert_eq!(without.statistics().facets, FacetCounts::default());
    assert!(told.is_empty() && !log.contains("facet"), "{log}");
    assert!(without.bound() < root_after, "{} without, {counts:?}", without.bound());
    assert_eq!(Options::default().with_facets(false).with_facets(true), Options::default());
    Ok(())
}

#[test]
fn methods_are_compared_with_facets() -> Result<(), Error> {
    let mut gain = started(6)?.model().clone();
    gain.maximize(-1.0 * gain.objective().clone())?;
    let mut solver = BranchAndBound::new(Options::default().with_threads(2));
    let table = compare_methods(&gain, &mut solver)?;
    assert_eq!(solver.options(), &Options::default().with_threads(2));
    let optimum = solver.solve(&gain)?.objective().expect("a point");
    for entry in table.entries() {
        let FacetCounts { facets, root_after, .. } = entry.facets;
        assert!(facets > 0, "{entry:?}");
        assert!(entry.root_bound > root_after && root_after > optimum - 1e-6, "{entry:?}");
    }
    let text = table.to_string();
    assert!(text.lines().next().is_some_and(|heading| heading.ends_with("facets  with facets")));
    assert_eq!(text.lines().map(str::len).max(), text.lines().map(str::len).min(), "{text}");

    // Facets have nothing to add to a program without binaries.
    let mut plain = Model::new("plain");
    let x = plain.continuous("x", 0.0, 1.0)?;
    plain.minimize(x)?;
    let table = compare_methods(&plain, &mut solver)?;
    assert!(table.entries().iter().all(|entry| entry.facets == FacetCounts::default()), "{table}");
    Ok(())
}
