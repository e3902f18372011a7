//! Whether a system can wait, decided from its statement.

use super::Monotonicity;
use crate::error::Error;
use crate::hybrid::step::{AffineForm, CartesianProduct};
use crate::hybrid::system::{Choice, Coordinates, HybridSystem, Region, Restated};
use crate::hybrid::terminal::Stay;

/// How far a held state may drift in a step relative to its domain, and how far a limit may be
/// missed relative to its magnitude: rounding, far below what programs tolerate.
const ROUNDING: f64 = 1e-12;

/// The most combinations of transitions that are tried.
const MOST: usize = 256;

impl HybridSystem {
    /// Whether waiting is free between a start and a goal: whether every run of τ steps can be
    /// extended to τ+1, with the argument in words.
    ///
    /// It is free if nothing in the system depends on the step, and if the start or the goal is a
    /// single state that some input holds in place, in every mode that is allowed there, by
    /// transitions that can be repeated. If this cannot be shown, waiting counts as not free.
    #[doc(hidden)]
    pub fn monotonicity(&self, start: &Region, goal: &Region) -> Result<Monotonicity, Error> {
        self.check()?;
        start.check(self, "the start")?;
        goal.check(self, "the goal")?;
        let Restated { system, coordinates } = self.restated()?;
        system.waits(&coordinates, &coordinates.region(start), &coordinates.region(goal))
    }

    /// The same of a system and regions in coordinates.
    pub(in crate::hybrid) fn waits(
        &self,
        coordinates: &Coordinates,
        start: &Region,
        goal: &Region,
    ) -> Result<Monotonicity, Error> {
        if self.settles() > 0 {
            let reason = "limits, ranges or guards of the system depend on the step";
            return Ok(Monotonicity::NotMonotone(reason.into()));
        }
        let mut obstacles = Vec::new();
        for (place, region) in [("start", start), ("goal", goal)] {
            match self.rest(coordinates, region)? {
                Ok(how) => {
                    return Ok(Monotonicity::Monotone(format!(
                        "the {place} is held by {how}, and nothing depends on the step"
                    )));
                }
                Err(obstacle) => obstacles.push(format!("the {place} {obstacle}")),
            }
        }
        Ok(Monotonicity::NotMonotone(obstacles.join("; ")))
    }

    /// How the only state of a region can be held in all its modes, or why not.
    fn rest(
        &self,
        coordinates: &Coordinates,
        region: &Region,
    ) -> Result<Result<String, String>, Error> {
        if region.ranges.iter().any(|range| range.lower != range.upper) {
            return Ok(Err("is not a single state".into()));
        }
        let state: Vec<f64> = region.ranges.iter().map(|range| range.lower).collect();
        // The modes of each choice that the region allows; one entry without memory.
        let modes: Vec<Vec<Option<&str>>> =
            self.choices.iter().map(|choice| allowed_modes(choice, region)).collect();
        let Some(combinations) = product(&modes) else {
            return Ok(Err("allows too many combinations of modes".into()));
        };
        let mut how = String::new();
        for modes in combinations {
            let candidates: Vec<Vec<&str>> = self
                .choices
                .iter()
                .zip(&modes)
                .map(|(choice, mode)| transitions_within(choice, *mode))
                .collect();
            let Some(transitions) = product(&candidates) else {
                return Ok(Err("has too many combinations of transitions".into()));
            };
            let mut held = None;
            for names in transitions {
                if let Some(input) = self.held(&state, &names)? {
                    held = Some((names, input));
                    break;
                }
            }
            match held {
                Some((names, input)) if how.is_empty() => {
                    let stated = input.iter().enumerate();
                    let stated = stated.map(|(k, u)| coordinates.input(k).outward(*u));
                    how = describe(self, &names, &stated.collect::<Vec<f64>>());
                }
                Some(_) => {}
                None => {
                    let named: Vec<&str> = modes.into_iter().flatten().collect();
                    return Ok(Err(match &named[..] {
                        [] => "cannot be held".into(),
                        named => format!("cannot be held in mode `{}`", named.join("`, `")),
                    }));
                }
            }
        }
        Ok(Ok(how))
    }

    /// The input with which these transitions hold a state, if one is found.
    fn held(&self, state: &[f64], names: &[&str]) -> Result<Option<Vec<f64>>, Error> {
        // A transition that cannot be repeated is no way to wait.
        let Ok(stay) = Stay::new(self, names) else { return Ok(None) };
        let nearest: Vec<f64> = stay.ranges.iter().map(|range| range.nearest(0.0)).collect();
        let middle: Vec<f64> = stay.ranges.iter().map(|r| 0.5 * (r.lower + r.upper)).collect();
        let mut candidates = vec![nearest.clone()];
        for from in [nearest, middle] {
            candidates.push(stay.holding_input(state, &from)?);
        }
        for input in candidates {
            let (_, _, drift) = stay.drift(self, state, &input)?;
            if drift <= ROUNDING && self.keeps(&stay, state, &input) {
                return Ok(Some(input));
            }
        }
        Ok(None)
    }

    /// Whether domains, ranges, limits and guards hold.
    fn keeps(&self, stay: &Stay, state: &[f64], input: &[f64]) -> bool {
        let within = |range: &crate::interval::Interval, x: f64| {
            let slack = ROUNDING * range.magnitude().max(1.0);
            range.lower - slack <= x && x <= range.upper + slack
        };
        let holds = |(_, form): &(String, AffineForm)| {
            let terms = form.factors.iter().zip(state.iter().chain(input)).map(|(a, x)| a * x);
            let (sum, size) = terms
                .fold((0.0, form.constant.abs().max(1.0)), |(sum, size), term| {
                    (sum + term, size + f64::abs(term))
                });
            sum <= -form.constant + ROUNDING * size
        };
        self.states.iter().zip(state).all(|((_, domain), &x)| within(domain, x))
            && stay.ranges.iter().zip(input).all(|(range, &u)| within(range, u))
            && stay.limits.iter().all(holds)
    }
}

fn allowed_modes<'a>(choice: &'a Choice, region: &Region) -> Vec<Option<&'a str>> {
    let modes = choice.modes();
    if modes.is_empty() {
        return vec![None];
    }
    modes.into_iter().filter(|mode| region.allows(&choice.name, mode)).map(Some).collect()
}

/// The transitions that stay in a mode, or all without memory.
fn transitions_within<'a>(choice: &'a Choice, mode: Option<&str>) -> Vec<&'a str> {
    let stays = |modes: &Option<(String, String)>| match (modes, mode) {
        (Some((from, to)), Some(mode)) => from == mode && to == mode,
        (None, None) => true,
        _ => false,
    };
    let transitions = choice.transitions.iter().filter(|t| stays(&t.modes));
    transitions.map(|transition| transition.name.as_str()).collect()
}

/// All ways to take one entry of each list; `None` if there are too many.
fn product<T: Copy>(lists: &[Vec<T>]) -> Option<impl Iterator<Item = Vec<T>>> {
    let all = CartesianProduct::at_most(MOST, lists.iter().map(Vec::len))?;
    Some(all.map(move |taken| taken.iter().zip(lists).map(|(&k, list)| list[k]).collect()))
}

fn describe(system: &HybridSystem, names: &[&str], input: &[f64]) -> String {
    let inputs = system.inputs.iter().zip(input).map(|((name, _), u)| format!("{name} = {u}"));
    let inputs: Vec<String> = inputs.collect();
    let with =
        if inputs.is_empty() { String::new() } else { format!(" with {}", inputs.join(", ")) };
    format!("`{}`{with}", names.join("`, `"))
}
