//! The irreducible set of families that contradict each other.

use std::collections::BTreeMap;

use super::domains::used_domains;
use super::explanation::{Explanation, ExplanationStatus, StatementGroup};
use super::groups::Groups;
use super::narrow::narrow;
use super::options::ExplainOptions;
use super::oracle::{Feasibility, Oracle};
use crate::error::Error;
use crate::model::{Model, Name};
use crate::solver::{Solver, StopToken};

/// With more families than this, a small contradictory set is first built up from nothing.
const MANY_FAMILIES: usize = 12;

/// Explains why a model has no solution, in terms of its own statements.
///
/// Statements are grouped by family (`damage_limit` stands for `damage_limit[0]`,
/// `damage_limit[1]`, ...). The returned families contradict each other, given the background and
/// the bounds and kinds of the variables. If any one of them is removed, the rest has a solution,
/// which is returned with it. Families with several steps are then narrowed to steps that still
/// contradict the rest, as far as the number of solves allows.
///
/// Every claim is proved. A part has no solution if a solve or propagation has refuted it, and has
/// one if a verified point is known. Objectives play no role. If a solve ends at a limit, its
/// family stays in the set, and the set is not reported as irreducible.
///
/// ```
/// use carom::explain::{ExplainOptions, infeasibility};
/// use carom::prelude::*;
///
/// let mut model = Model::new("late");
/// let x = model.continuous_family("x", 11, -100.0, 100.0)?;
/// model.add("start", x[0].equals(0.0))?;
/// model.add("goal", x[10].ge(8.0))?;
/// for t in 0..10 {
///     model.add(("speed", t), (x[t + 1] - x[t]).within(-0.5, 0.5))?;
///     model.add(("road", t), x[t].le(20.0))?;
/// }
/// let why = infeasibility(&model, &ExplainOptions::default(), &mut BranchAndBound::default())?;
/// assert!(why.is_irreducible());
/// let names: Vec<_> = why.groups().iter().map(|group| group.name()).collect();
/// assert_eq!(names, ["start", "goal", "speed"]);
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Arguments
///
/// * `options`: the background and the limits. If a time limit, an interrupt or a limit on solves
///   stops the search, the best set so far is returned.
///
/// # Errors
///
/// [`ErrorKind::UnknownName`](crate::error::ErrorKind::UnknownName) for a name in the background
/// that the model does not have, and the errors of [`Solver::solve_with`].
pub fn infeasibility(
    model: &Model,
    options: &ExplainOptions,
    solver: &mut dyn Solver,
) -> Result<Explanation, Error> {
    // Its solves are about parts of the model, whose proofs would replace that of the whole.
    let proof = solver.options_mut().proof.take();
    let explained = explain(model, options, solver);
    solver.options_mut().proof = proof;
    explained
}

fn explain(
    model: &Model,
    options: &ExplainOptions,
    solver: &mut dyn Solver,
) -> Result<Explanation, Error> {
    let groups = Groups::of(model, &options.background)?;
    let token = StopToken::new(options.time_limit, &options.interrupt);
    let mut oracle = Oracle::new(model, solver, token, options.solve_limit);
    let everything = vec![true; groups.names.len()];
    let status = match oracle.ask(&everything)? {
        Feasibility::Feasible(_) => Some(ExplanationStatus::Feasible),
        Feasibility::Open => Some(ExplanationStatus::Unknown),
        Feasibility::Infeasible => None,
    };
    if let Some(status) = status {
        return Ok(report(model, &groups, status, Vec::new(), &oracle));
    }
    let (kept, proved) = irreducible(&groups, &mut oracle)?;
    let members = narrow(&groups, &kept, options.narrowing, &mut oracle)?;
    let named = groups.mask(members.iter().map(|members| &members[..]));
    let blamed: Vec<usize> = members.iter().flatten().copied().collect();
    let domains = used_domains(model, &named, &blamed, &oracle)?;
    let status = match proved {
        true => ExplanationStatus::Irreducible,
        false => ExplanationStatus::Reducible,
    };
    let found = kept.iter().zip(members).map(|(&place, members)| {
        let family = &groups.families[place];
        let others = kept.iter().filter(|&&other| other != place);
        let others = groups.mask(others.map(|&other| &groups.families[other].members[..]));
        let without = oracle.known.iter().find(|known| known.satisfies(&others));
        StatementGroup {
            name: family.name.clone(),
            words: model.words(&family.name).to_owned(),
            statements: members.iter().map(|&member| groups.names[member].clone()).collect(),
            family_size: family.members.len(),
            without: without.map(|known| known.point.clone()),
        }
    });
    let found = found.collect();
    // A statement of the same name may have words of its own.
    let families = domains.iter().map(Name::family).filter(|family| !model.has_family(family));
    let words = families.map(|family| (family.to_owned(), model.words(family).to_owned()));
    let domain_words: BTreeMap<String, String> = words.collect();
    Ok(Explanation { domains, domain_words, ..report(model, &groups, status, found, &oracle) })
}

/// Families of a contradictory set, in order, and whether each of them is proved to be needed.
fn irreducible(groups: &Groups, oracle: &mut Oracle<'_>) -> Result<(Vec<usize>, bool), Error> {
    let families = &groups.families;
    let mask = |kept: &[bool]| {
        let kept = families.iter().zip(kept).filter(|(_, kept)| **kept);
        groups.mask(kept.map(|(family, _)| &family.members[..]))
    };
    let mut kept = vec![true; families.len()];
    // Large families are tried first, because fewer statements are left if they go.
    let mut order: Vec<usize> = (0..families.len()).collect();
    order.sort_by_key(|&place| std::cmp::Reverse(families[place].members.len()));

    if oracle.refutes_at_once(&mask(&kept))? {
        // If propagation refutes the whole, it can reduce it without a solve.
        for &place in &order {
            kept[place] = false;
            kept[place] = oracle.is_stopped() || !oracle.refutes_at_once(&mask(&kept))?;
        }
    } else if families.len() > MANY_FAMILIES {
        kept = collect(groups, &mask, oracle)?;
    }

    let mut proved = true;
    for place in order {
        if !std::mem::take(&mut kept[place]) {
            continue;
        }
        match oracle.ask(&mask(&kept))? {
            Feasibility::Infeasible => {}
            Feasibility::Feasible(_) => kept[place] = true,
            Feasibility::Open => (kept[place], proved) = (true, false),
        }
    }
    Ok(((0..families.len()).filter(|&place| kept[place]).collect(), proved))
}

/// Builds a contradictory set up from nothing: while the set has a solution, adds the family that
/// this solution violates most.
fn collect(
    groups: &Groups,
    mask: &dyn Fn(&[bool]) -> Vec<bool>,
    oracle: &mut Oracle<'_>,
) -> Result<Vec<bool>, Error> {
    let mut family_of = vec![None; groups.names.len()];
    for (place, family) in groups.families.iter().enumerate() {
        family.members.iter().for_each(|&member| family_of[member] = Some(place));
    }
    let mut kept = vec![false; groups.families.len()];
    loop {
        let found = match oracle.ask(&mask(&kept))? {
            Feasibility::Infeasible => return Ok(kept),
            Feasibility::Open => break,
            Feasibility::Feasible(found) => found,
        };
        let violated = oracle.known[found].violated.iter();
        let worst = violated.max_by(|a, b| a.1.total_cmp(&b.1));
        let place = worst.and_then(|&(statement, _)| family_of[statement]);
        let Some(place) = place.filter(|&place| !kept[place]) else { break };
        kept[place] = true;
    }
    Ok(vec![true; kept.len()])
}

fn report(
    model: &Model,
    groups: &Groups,
    status: ExplanationStatus,
    found: Vec<StatementGroup>,
    oracle: &Oracle<'_>,
) -> Explanation {
    let mut asked = vec![false; groups.names.len()];
    groups.families.iter().flat_map(|family| &family.members).for_each(|&k| asked[k] = true);
    let quiet = groups.names.iter().zip(&asked).filter(|(_, asked)| !**asked);
    let mut background: Vec<String> = Vec::new();
    for family in quiet.map(|(name, _)| Name::family(name)) {
        if !background.iter().any(|known| known == family) {
            background.push(family.into());
        }
    }
    let mut background_words: Vec<String> = Vec::new();
    for words in background.iter().map(|family| model.words(family)) {
        if !background_words.iter().any(|known| known == words) {
            background_words.push(words.to_owned());
        }
    }
    let point = match status {
        ExplanationStatus::Feasible => oracle.known.first().map(|known| known.point.clone()),
        _ => None,
    };
    Explanation {
        model: model.name().into(),
        status,
        groups: found,
        background,
        background_words,
        domains: Vec::new(),
        domain_words: BTreeMap::new(),
        point,
        solves: oracle.solves,
        propagations: oracle.propagations,
    }
}
