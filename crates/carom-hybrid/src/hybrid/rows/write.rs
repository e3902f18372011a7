//! Writing a hybrid system into a model.

use std::collections::BTreeSet;

use super::change::{Changes, Part, quantity};
use super::constant_rows::{constant, nontrivial};
use super::functions;
use super::levels;
use super::modes;
use super::names::Names;
use super::program::{ChoiceProgram, OneOf, SystemVariables};
use super::statements::ChoiceStep;
use super::support::state_by_support;
use super::switch::{Region, Setting, Switch, switch};
use crate::error::Error;
use crate::hybrid::horizon::Horizon;
use crate::hybrid::step::{self, AffineForm, ConditionMaps, ConditionSet, Dynamics, StepCondition};
use crate::hybrid::system::{Choice, Coordinates, HybridSystem, Restated, Transition};
use crate::interval::Interval;
use crate::model::{Affine, Family, Method, Model, Variable, VariableKind};

/// The changes and rows of a choice, known before its variables are made.
struct Formulation {
    changes: Changes,
    /// The transitions and their rows at every step that differs from others.
    steps: Vec<(Vec<Dynamics>, Switch)>,
}

/// The ranges of the inputs at a step, over all transitions of every choice that limits them.
fn input_ranges(system: &HybridSystem, step: usize) -> Vec<Interval> {
    let range = |u: usize| {
        let ranges = system.input_ranges(u, step);
        ranges.fold(Interval::REALS, |all, range| all.intersection(range))
    };
    (0..system.inputs.len()).map(range).collect()
}

/// The forms that are at most 0 at the start of a step in any case: the limits of the system.
fn known(system: &HybridSystem, step: usize) -> Vec<AffineForm> {
    let width = system.states.len() + system.inputs.len();
    let limits = system.conditions().filter(|limit| !limit.is_limit());
    let row = |limit: StepCondition<'_>| match limit.maps(&[], width, step)? {
        ConditionMaps::HalfSpace(map) => Some(map),
        ConditionMaps::Norm { .. } => None,
    };
    limits.filter_map(row).collect()
}

/// Half-spaces around the norms that a condition of the system, or of a transition, limits: each
/// entry is within the bound.
fn around_norms<'a>(
    conditions: impl Iterator<Item = StepCondition<'a>>,
    predicted: &[AffineForm],
    width: usize,
    step: usize,
) -> Vec<AffineForm> {
    let maps = conditions
        .filter(|own| matches!(own.set, ConditionSet::Norm(_)) && !own.is_limit())
        .filter_map(|own| own.maps(predicted, width, step));
    let sides = |maps| match maps {
        ConditionMaps::HalfSpace(_) => Vec::new(),
        ConditionMaps::Norm { entries, bound } => {
            let sides = |e: &AffineForm| [e.minus(&bound), e.scaled(-1.0).minus(&bound)];
            entries.iter().flat_map(sides).collect()
        }
    };
    maps.flat_map(sides).collect()
}

fn formulate(
    system: &HybridSystem,
    choice: &Choice,
    count: usize,
    method: Option<Method>,
) -> Formulation {
    let outputs = step::output_names(&choice.transitions);
    let domains: Vec<Interval> = system.states.iter().map(|(_, domain)| *domain).collect();
    let alone = system.choices.len() == 1;
    let mut steps = Vec::with_capacity(count);
    for t in 0..count {
        let ranges = input_ranges(system, t);
        let known = known(system, t);
        let dynamics = |transition| {
            let inputs = ranges.iter().enumerate().map(|(u, all)| {
                let own = system.input_range(choice, transition, u, t).unwrap_or(*all);
                let both = own.intersection(*all);
                if both.is_empty() { own } else { both }
            });
            step::dynamics(system, transition, &outputs, inputs.collect(), t)
        };
        let own: Vec<Dynamics> = choice.transitions.iter().map(dynamics).collect();
        let width = domains.len() + ranges.len();
        let norms = around_norms(system.conditions(), &[], width, t);
        let region = |(transition, own): (&Transition, &Dynamics)| {
            let flow = step::flow(&transition.flow);
            let norms_of = around_norms(transition.conditions(), &flow, width, t);
            Region::new(own, &domains, &[&known[..], &norms, &norms_of].concat(), alone)
        };
        let regions: Vec<Region> = choice.transitions.iter().zip(&own).map(region).collect();
        steps.push((own, regions, [&domains[..], &ranges].concat(), known));
    }
    let all: Vec<&[Dynamics]> = steps.iter().map(|(own, ..)| &own[..]).collect();
    let last: &[Region] = steps.last().map_or(&[], |(_, regions, ..)| regions);
    let changes = Changes::new(&choice.transitions, &all, last);
    let steps = steps.into_iter().map(|(own, regions, ranges, known)| {
        let setting = Setting { ranges: &ranges, known: &known, alone };
        let (mut rows, analysis) = switch(&own, &changes, &regions, &setting);
        if method.is_none() {
            state_by_support(&mut rows, &analysis, &own, &changes);
        }
        (own, rows)
    });
    Formulation { steps: steps.collect(), changes }
}

/// The numbers of rows, indicators, conic rows and disjunctions.
fn counts(model: &Model) -> [usize; 4] {
    let conic = model.conic_constraint_count();
    [model.constraint_count(), model.indicator_count(), conic, model.disjunctions().len()]
}

/// Adds a checked system to a model, or nothing if something fails.
pub(super) fn write(
    restated: &Restated,
    model: &mut Model,
    prefix: &str,
    horizon: &Horizon,
    method: Option<Method>,
) -> Result<SystemVariables, Error> {
    let system = &restated.system;
    let count = system.settles().min(horizon.steps() - 1) + 1;
    let formulations: Vec<Formulation> =
        system.choices.iter().map(|own| formulate(system, own, count, method)).collect();
    let before = counts(model);
    let (mut program, background, words) = model.all_or_nothing(|model| {
        let mut names = Names::new(prefix);
        let program = variables(restated, model, &mut names, horizon, &formulations)?;
        let mut writer = Writer {
            system,
            model,
            names: Names::new(prefix),
            program: &program,
            formulations: &formulations,
            method,
            as_predicted: as_predicted(system),
            coordinates: &restated.coordinates,
            background: BTreeSet::new(),
        };
        writer.limits()?;
        writer.levels()?;
        writer.steps()?;
        writer.modes()?;
        writer.events()?;
        let (background, words) = (writer.background, writer.names.words());
        Ok((program, background, words))
    })?;
    let after = counts(model);
    program.written = std::array::from_fn(|kind| before[kind]..after[kind]);
    words.into_iter().for_each(|(family, words)| model.describe(&family, words));
    background.iter().try_for_each(|family| model.set_law(family))?;
    if let Some(what) = system.by_step() {
        model.note_by_step(what);
    }
    model.name_handles(system.handles.tag, system.handle_names());
    Ok(program)
}

fn variables(
    restated: &Restated,
    model: &mut Model,
    names: &mut Names,
    horizon: &Horizon,
    formulations: &[Formulation],
) -> Result<SystemVariables, Error> {
    let (steps, system) = (horizon.steps(), &restated.system);
    let mut program = SystemVariables {
        system: system.clone(),
        stated: None,
        coordinates: Coordinates::default(),
        horizon: *horizon,
        states: Vec::new(),
        inputs: Vec::new(),
        levels: Vec::new(),
        choices: Vec::new(),
        outputs: Vec::new(),
        own_outputs: Vec::new(),
        written: Default::default(),
    };
    for (name, domain) in &system.states {
        let name = names.family(&[name]);
        let family = model.continuous_family(&name, steps + 1, domain.lower, domain.upper)?;
        program.states.push(family);
    }
    for (u, (name, _)) in system.inputs.iter().enumerate() {
        if system.functions.is_function(u) {
            // Its place, until all arguments are there.
            program.inputs.push(Family::from_iter([]));
            program.levels.push(None);
            continue;
        }
        let [above, below] = ["above", "below"].map(|end| names.family(&[name, end, "ranges"]));
        let name = names.family(&[name]);
        let is_whole = system.values_of_input(u).is_some_and(levels::is_whole);
        let kind = if is_whole { VariableKind::Integer } else { VariableKind::Continuous };
        let member = |t: usize| {
            let Interval { lower, upper } = input_ranges(system, t)[u];
            // Ranges of different choices may have nothing in common.
            let (least, most) = (lower.min(upper), lower.max(upper));
            let variable = model.variable((name.as_str(), t), kind, least, most)?;
            if lower > upper {
                model.add((above.as_str(), t), variable.ge(lower))?;
                model.add((below.as_str(), t), variable.le(upper))?;
            }
            Ok(variable)
        };
        program.inputs.push((0..steps).map(member).collect::<Result<Family, Error>>()?);
        program.levels.push(levels::variables(system, u, model, names, steps)?);
    }
    functions::add(restated, model, names, &mut program)?;
    for (choice, own) in system.choices.iter().zip(formulations) {
        // A single choice needs no name.
        let of = if system.choices.len() == 1 { "" } else { &choice.name };
        let transitions: Vec<&str> = choice.transitions.iter().map(|t| t.name.as_str()).collect();
        let on = 1 - own.changes.reference.min(1);
        let taken = one_of(model, names, &transitions, on, steps, &[of])?;
        let modes = one_of(model, names, &choice.modes(), 1, steps + 1, &[&choice.name, "is"])?;
        let mut groups = Vec::new();
        let outputs = step::output_names(&choice.transitions);
        for (g, &quantity) in own.changes.groups.iter().enumerate() {
            let name = match system.states.get(quantity) {
                Some((state, _)) => names.family(&[of, "change", state]),
                None => names.family(&[of, outputs[quantity - system.states.len()]]),
            };
            let member = |t: usize| {
                let range = at(&own.steps, t).1.bounds[g];
                model.continuous((name.as_str(), t), range.lower, range.upper)
            };
            groups.push((0..steps).map(member).collect::<Result<Family, Error>>()?);
        }
        program.choices.push(ChoiceProgram { changes: own.changes.clone(), taken, modes, groups });
    }
    outputs(&mut program, formulations);
    Ok(program)
}

/// The binaries of several things, of which one holds.
fn one_of(
    model: &mut Model,
    names: &mut Names,
    things: &[&str],
    on: usize,
    count: usize,
    before: &[&str],
) -> Result<OneOf, Error> {
    let mut family = |name: &str| {
        let name = names.family(&[before, &[name]].concat());
        model.binary_family(&name, count)
    };
    Ok(match things {
        [] | [_] => OneOf::Only,
        [_, _] => OneOf::Pair(family(things[on])?, on),
        _ => OneOf::Each(things.iter().map(|name| family(name)).collect::<Result<_, _>>()?),
    })
}

/// The value at a step, of a list by step whose last entry goes on.
fn at<T>(list: &[T], step: usize) -> &T {
    &list[step.min(list.len() - 1)]
}

/// A map of states and inputs at a step, as an expression.
pub(in crate::hybrid) fn expression(
    program: &SystemVariables,
    map: &AffineForm,
    step: usize,
) -> Affine {
    let mut sum = Affine::constant(map.constant);
    let variables = program.states.iter().chain(&program.inputs).map(|family| family.get(step));
    for (factor, variable) in map.factors.iter().zip(variables) {
        if let Some(variable) = variable.filter(|_| *factor != 0.0) {
            sum.add_term(*factor, variable);
        }
    }
    sum
}

/// The change that a choice adds to a quantity of its reference in a step, as an expression.
fn change(program: &ChoiceProgram, own: &[Dynamics], number: usize, step: usize) -> Affine {
    match program.changes.parts[number] {
        Part::Same => Affine::zero(),
        Part::Constant => {
            let constants = (0..own.len()).map(|j| program.changes.of(own, j, number).constant);
            let taken = constants.enumerate().filter(|(_, constant)| *constant != 0.0);
            taken.map(|(j, constant)| constant * program.taken.value(j, step)).sum()
        }
        Part::Shared { group, ratio } => {
            let variable: Option<Variable> = program.groups[group].get(step);
            variable.map_or(Affine::zero(), |variable| ratio * variable)
        }
    }
}

/// Adds the outputs of all choices, by name.
fn outputs(program: &mut SystemVariables, formulations: &[Formulation]) {
    let (n, steps) = (program.states.len(), program.horizon.steps());
    let mut outputs: Vec<(String, Vec<Affine>)> = Vec::new();
    let mut by_choice = Vec::new();
    for (c, choice) in program.system.choices.iter().enumerate() {
        let mut of_choice = Vec::new();
        for (o, name) in step::output_names(&choice.transitions).into_iter().enumerate() {
            let value = |t: usize| {
                let own = &at(&formulations[c].steps, t).0;
                let changes = &program.choices[c].changes;
                let common = quantity(&own[changes.reference], n + o);
                expression(program, common, t) + change(&program.choices[c], own, n + o, t)
            };
            let values: Vec<Affine> = (0..steps).map(value).collect();
            of_choice.push((name.to_owned(), values.clone()));
            match outputs.iter_mut().find(|(own, _)| own == name) {
                None => outputs.push((name.to_owned(), values)),
                Some((_, sums)) => sums.iter_mut().zip(values).for_each(|(sum, v)| *sum += v),
            }
        }
        by_choice.push(of_choice);
    }
    // What no transition states is 0.
    for name in program.system.output_names() {
        if outputs.iter().all(|(own, _)| *own != name) {
            outputs.push((name, vec![Affine::zero(); steps]));
        }
    }
    (program.outputs, program.own_outputs) = (outputs, by_choice);
}

/// Which states every transition of every choice leaves as one common flow has them, so that the
/// next state is what is predicted.
fn as_predicted(system: &HybridSystem) -> Vec<bool> {
    let flow = system.flow.as_ref().or(system.transitions().next().map(|t| &t.flow));
    let Some(flow) = flow.map(step::flow) else { return Vec::new() };
    let shared = system.transitions().all(|t| step::flow(&t.flow) == flow);
    let keeps = |t: &crate::hybrid::system::Transition, i: usize| match &t.reset {
        None => true,
        Some(reset) => {
            let unit = |j: usize| if i == j { 1.0 } else { 0.0 };
            let is_row = (0..flow.len()).all(|j| reset.matrix[(i, j)] == unit(j));
            is_row && reset.offset.values().all(|offset| offset.get(i) == Some(&0.0))
        }
    };
    (0..flow.len()).map(|i| shared && system.transitions().all(|t| keeps(t, i))).collect()
}

struct Writer<'a> {
    system: &'a HybridSystem,
    model: &'a mut Model,
    names: Names,
    program: &'a SystemVariables,
    formulations: &'a [Formulation],
    method: Option<Method>,
    /// Which states are as predicted.
    as_predicted: Vec<bool>,
    coordinates: &'a Coordinates,
    /// Families of statements that describe the system.
    background: BTreeSet<String>,
}

impl Writer<'_> {
    /// The limits of the system: at every sample, or, if they are joint, at every step.
    fn limits(&mut self) -> Result<(), Error> {
        let (n, steps) = (self.system.states.len(), self.program.horizon.steps());
        let width = n + self.system.inputs.len();
        for limit in self.system.conditions() {
            let family = self.names.family(&[limit.name()]);
            let last = if limit.set.is_joint(n) { steps } else { steps + 1 };
            let mut any = false;
            for t in 0..last {
                let Some(maps) = limit.maps(&[], width, t) else { continue };
                let row = maps.row(|map| expression(self.program, map, t));
                let Some(row) = nontrivial(self.program, row, t) else { continue };
                row.add_to(self.model, (family.as_str(), t), None)?;
                any = true;
            }
            if any && !limit.is_limit() {
                self.background.insert(family);
            }
        }
        for row in &self.system.state_rows {
            let family = self.names.family(&[&row.name]);
            for t in 0..=steps {
                let states = self.stated_states(t);
                self.model.add((family.as_str(), t), row.over(&states))?;
            }
            if !row.is_limit {
                self.background.insert(family);
            }
        }
        Ok(())
    }

    /// The states at a sample in the user's numbers.
    fn stated_states(&self, sample: usize) -> Vec<Affine> {
        let families = self.program.states.iter().enumerate();
        let own = families.filter_map(|(i, family)| {
            Some(self.program.in_units(self.coordinates.state(i), family.get(sample)?))
        });
        own.collect()
    }

    /// The values that inputs take, if they take some only.
    fn levels(&mut self) -> Result<(), Error> {
        for input in 0..self.program.inputs.len() {
            let families = levels::add(self.model, &mut self.names, self.program, input)?;
            self.background.extend(families);
        }
        Ok(())
    }

    /// The next state, and the rows of every choice.
    fn steps(&mut self) -> Result<(), Error> {
        let names: Vec<String> = self
            .system
            .states
            .iter()
            .map(|(name, _)| self.names.family(&["dynamics", name]))
            .collect();
        for t in 0..self.program.horizon.steps() {
            for (i, name) in names.iter().enumerate() {
                let next = self.next(i, t);
                if let Some(variable) = self.program.states[i].get(t + 1) {
                    self.model.add((name.as_str(), t), variable.equals(next))?;
                }
            }
            for (number, formulation) in self.formulations.iter().enumerate() {
                let (own, rows) = at(&formulation.steps, t);
                let method = self.method;
                let as_predicted = &self.as_predicted;
                let step = ChoiceStep {
                    program: self.program,
                    number,
                    own,
                    rows,
                    step: t,
                    method,
                    as_predicted,
                };
                step.add(self.model, &mut self.names, &mut self.background)?;
            }
        }
        self.background.extend(names);
        Ok(())
    }

    /// The next value of a state: the common flow, and what the choices change about it.
    fn next(&self, state: usize, step: usize) -> Affine {
        let width = self.system.states.len() + self.system.inputs.len();
        let choices = self.program.choices.iter().zip(self.formulations);
        let mut choices = choices.map(|(own, formulation)| (own, &at(&formulation.steps, step).0));
        let mut sum = Affine::zero();
        let has_several = self.formulations.len() > 1;
        let flow = self.system.flow.as_ref().filter(|_| has_several).map(step::flow);
        let mut common = flow.map_or(AffineForm::constant(width, 0.0), |flow| flow[state].clone());
        let base = has_several.then(|| common.clone());
        choices.by_ref().for_each(|(choice, own)| {
            let reference = &own[choice.changes.reference].next[state];
            let difference = base.as_ref().map_or(reference.clone(), |base| reference.minus(base));
            common.add(1.0, &difference);
            sum += change(choice, own, state, step);
        });
        sum + expression(self.program, &common, step)
    }

    fn modes(&mut self) -> Result<(), Error> {
        for number in 0..self.formulations.len() {
            let families = modes::add(self.model, &mut self.names, self.program, number)?;
            self.background.extend(families);
        }
        Ok(())
    }

    fn events(&mut self) -> Result<(), Error> {
        let Some(most) = self.system.most_events else { return Ok(()) };
        let steps = 0..self.program.horizon.steps();
        let total: Affine = steps.map(|t| self.program.count_events(t)).sum();
        let mut row = total.le(most as f64);
        match constant(&row) {
            None => {}
            Some(true) => return Ok(()),
            Some(false) => row = self.program.infeasible_row_at(0),
        }
        let family = self.names.family(&["most_events"]);
        self.model.add(family.as_str(), row)?;
        Ok(())
    }
}
