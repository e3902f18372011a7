//! A plan of a loop, whole: inputs, transitions and modes, and the states to which they lead.

use crate::error::Error;
use crate::hybrid::memory::Memory;
use crate::hybrid::program::ProgramSystems;
use crate::hybrid::rows::Named;
use crate::hybrid::simulate::{Decided, Decisions, Simulation};
use crate::hybrid::system::{Choice, HybridSystem};
use crate::solution::Point;

/// A plan in numbers and names, or its rest.
#[derive(Debug, Clone, Default)]
pub(super) struct LoopPlan {
    /// By sample; empty if nothing says where the inputs lead.
    pub(super) states: Vec<Vec<f64>>,
    /// By step.
    pub(super) inputs: Vec<Vec<f64>>,
    /// For each choice, the transitions of the steps.
    pub(super) transitions: Named,
    /// For each choice with memory, the modes at the samples.
    pub(super) modes: Named,
    /// By step, the number of events.
    pub(super) events: Vec<usize>,
}

impl LoopPlan {
    /// Reads the choices of all systems that are no cases from a point.
    pub(super) fn choose(&mut self, systems: &ProgramSystems, point: &Point) -> Result<(), Error> {
        self.events = vec![0; systems.steps];
        for (own, names) in systems.steered_choices() {
            let [transitions, modes] = own.chosen(point)?;
            let choices = own.system().choices.iter();
            let known_as = |name: &str| {
                let named = own.system().choices.iter().zip(&names);
                let mut named = named.filter(|(choice, _)| choice.name == name);
                named.next().map_or(String::new(), |(_, known)| known.clone())
            };
            for (choice, (_, taken)) in choices.zip(&transitions) {
                for (count, name) in self.events.iter_mut().zip(taken) {
                    *count += usize::from(is_event(choice, name));
                }
            }
            let named = |all: Named| {
                all.into_iter().map(|(name, own)| (known_as(&name), own)).collect::<Named>()
            };
            self.transitions.extend(named(transitions));
            self.modes.extend(named(modes));
        }
        Ok(())
    }

    /// The run of a simulation.
    pub(super) fn of_simulation(run: &Simulation) -> Self {
        let run_by_name = run.to_run();
        LoopPlan {
            states: run.states.clone(),
            inputs: run.inputs.clone(),
            transitions: run_by_name.transitions,
            modes: run_by_name.modes,
            events: run.steps.iter().map(|step| step.events).collect(),
        }
    }

    /// A plan of one input with the transitions of this plan's first step.
    pub(super) fn with_first_input(&self, input: &[f64]) -> Self {
        LoopPlan { states: Vec::new(), inputs: vec![input.to_vec()], ..self.head(1) }
    }

    /// The first steps of the plan.
    pub(super) fn head(&self, steps: usize) -> Self {
        let first = |all: &Named, count: usize| -> Named {
            let own = all.iter();
            own.map(|(name, own)| (name.clone(), own.iter().take(count).cloned().collect()))
                .collect()
        };
        LoopPlan {
            states: self.states.iter().take(steps + 1).cloned().collect(),
            inputs: self.inputs.iter().take(steps).cloned().collect(),
            transitions: first(&self.transitions, steps),
            modes: first(&self.modes, steps + 1),
            events: self.events.iter().take(steps).copied().collect(),
        }
    }

    /// A plan of one input that stays in its modes.
    pub(super) fn idle(system: &HybridSystem, memory: &Memory, input: &[f64]) -> Self {
        let stay = |choice: &Choice| {
            let mode = memory.mode(&choice.name)?;
            let mut stays = choice.transitions.iter().filter(|own| {
                own.modes.as_ref().is_some_and(|(from, to)| from == mode && to == mode)
            });
            let stay = stays.next()?.name.clone();
            Some((choice.name.clone(), stay, mode.to_owned()))
        };
        let stays: Vec<_> = system.choices.iter().filter_map(stay).collect();
        let transitions =
            stays.iter().map(|(choice, stay, _)| (choice.clone(), vec![stay.clone()]));
        let modes = stays.iter().map(|(choice, _, mode)| (choice.clone(), vec![mode.clone(); 2]));
        LoopPlan {
            states: Vec::new(),
            inputs: vec![input.to_vec()],
            transitions: transitions.collect(),
            modes: modes.collect(),
            events: vec![0],
        }
    }

    /// The plan without its first step.
    pub(super) fn rest(&self) -> Self {
        let behind = |all: &Named| -> Named {
            let own = all.iter();
            own.map(|(name, own)| (name.clone(), own.get(1..).unwrap_or_default().to_vec()))
                .collect()
        };
        LoopPlan {
            states: self.states.get(1..).unwrap_or_default().to_vec(),
            inputs: self.inputs.get(1..).unwrap_or_default().to_vec(),
            transitions: behind(&self.transitions),
            modes: behind(&self.modes),
            events: self.events.get(1..).unwrap_or_default().to_vec(),
        }
    }

    /// Completes the memory at its first sample, and moves it to the next one.
    pub(super) fn pass(&self, choices: &[(String, &Choice)], memory: &mut Memory) -> Memory {
        let mut after = memory.clone();
        for (name, taken) in &self.transitions {
            let Some(first) = taken.first() else { continue };
            let named = choices.iter().find(|(known, _)| known == name);
            let transition = named.and_then(|(_, choice)| {
                choice.transitions.iter().find(|transition| transition.name == *first)
            });
            let Some(transition) = transition else { continue };
            if let Some((from, _)) = &transition.modes {
                memory.decide(name, from);
            }
            after.advance(name, transition);
        }
        after
    }
}

fn is_event(choice: &Choice, name: &str) -> bool {
    choice.transitions.iter().any(|own| own.name == name && own.is_event)
}

/// The steps of names by choice, as names by step.
pub(super) fn by_step(names: &Named, steps: usize) -> Vec<Vec<(&str, &str)>> {
    let at = |t: usize| {
        let own = names.iter();
        own.filter_map(|(choice, own)| Some((choice.as_str(), own.get(t)?.as_str()))).collect()
    };
    (0..steps).map(at).collect()
}

impl Decisions for LoopPlan {
    fn decided(&self) -> Decided<'_> {
        Decided {
            inputs: self.inputs.iter().map(Vec::as_slice).collect(),
            transitions: by_step(&self.transitions, self.inputs.len()),
            ..Decided::default()
        }
    }
}
