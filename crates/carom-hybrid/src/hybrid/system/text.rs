//! The text form of a hybrid system.

use std::fmt::{self, Display, Write};

use super::HybridSystem;
use super::choice::{Choice, Dwell};
use super::halfspace::Halfspace;
use super::input_values::InputValues;
use super::norm_limit::{NormEntry, NormLimit};
use super::schedule::Schedule;
use super::transition::Transition;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::step::{ConditionSet, Moment, StepCondition};
use crate::interval::Interval;

/// The whole statement, a line per item: domains, ranges, limits, then each choice with its
/// transitions. `x'` is a state after the flow and before the reset, `x+` the next state.
///
/// ```
/// use carom::hybrid::{HybridSystem, Restitution};
///
/// let ball = HybridSystem::bouncing_ball(0.5, Restitution::new(0.5)?, 3.0, 10.0)?;
/// let text = ball.to_string();
/// let last: Vec<&str> = text.lines().skip(10).map(str::trim).collect();
/// assert_eq!(last, [
///     "transition bounce (event)",
///     "height' = height + 0.5 speed - 1.22625",
///     "speed' = speed - 4.905",
///     "if height' <= 0",
///     "if speed' <= 0",
///     "height+ = -0.5 height'",
///     "speed+ = -0.5 speed'",
///     "impact speed = -speed'",
/// ]);
/// # Ok::<(), carom::Error>(())
/// ```
impl Display for HybridSystem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = Names::new(self);
        for (name, domain) in &self.states {
            writeln!(f, "state {name} in {}", Range(*domain))?;
        }
        for (number, (name, range)) in self.inputs.iter().enumerate() {
            let function = self.functions.iter().find(|(own, _)| *own == number);
            if let Some((_, own)) = function.filter(|_| self.is_nonlinear()) {
                let range = ByStep(range, Range::text);
                writeln!(f, "function {name} = {} in {range}", self.functions.text(own))?;
                continue;
            }
            match self.input_values.get(name) {
                None => writeln!(f, "input {name} in {}", ByStep(range, Range::text))?,
                Some(InputValues::Whole) => {
                    writeln!(f, "input {name} in {}, whole numbers", ByStep(range, Range::text))?;
                }
                Some(InputValues::Listed(list)) => {
                    let list: Vec<String> = list.iter().map(f64::to_string).collect();
                    writeln!(f, "input {name} in {{{}}}", list.join(", "))?;
                }
            }
        }
        for limit in self.conditions() {
            writeln!(f, "always {}", names.condition(limit, ""))?;
        }
        for row in &self.state_rows {
            let name =
                |i: usize| self.states.get(i).map_or(String::new(), |(name, _)| name.clone());
            writeln!(f, "always {}", row.text(&name))?;
        }
        if let Some(most) = self.most_events {
            writeln!(f, "at most {most} events")?;
        }
        for ((name, _), range) in self.states.iter().zip(&self.disturbance) {
            writeln!(f, "disturbance of {name} in {}", Range(*range))?;
        }
        if let Some(flow) = &self.flow {
            writeln!(f, "common flow")?;
            names.flow(f, flow, "'")?;
        }
        self.choices.iter().try_for_each(|choice| names.choice(f, choice))
    }
}

/// A range as `[0, 1]`.
struct Range(Interval);

impl Range {
    fn text(range: &Interval) -> String {
        Range(*range).to_string()
    }
}

impl Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}]", self.0.lower, self.0.upper)
    }
}

/// A value by step as `1 until step 4, 2 from then on`, where `until` includes the step.
struct ByStep<'a, T, F>(&'a Schedule<T>, F);

impl<T, F: Fn(&T) -> String> Display for ByStep<'_, T, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut values = self.0.values().enumerate().peekable();
        let mut is_constant = true;
        while let Some((step, value)) = values.next() {
            match values.peek() {
                Some((_, next)) if self.1(next) == self.1(value) => {}
                Some(_) => {
                    write!(f, "{} until step {step}, ", self.1(value))?;
                    is_constant = false;
                }
                None if is_constant => f.write_str(&self.1(value))?,
                None => write!(f, "{} from then on", self.1(value))?,
            }
        }
        Ok(())
    }
}

/// The names of states and inputs.
struct Names<'a> {
    states: Vec<&'a str>,
    inputs: Vec<&'a str>,
}

impl<'a> Names<'a> {
    fn new(system: &'a HybridSystem) -> Self {
        Names {
            states: system.states.iter().map(|(name, _)| name.as_str()).collect(),
            inputs: system.inputs.iter().map(|(name, _)| name.as_str()).collect(),
        }
    }

    /// `2 x' - v' + 0.5 u`, with a mark behind the states.
    fn sum(&self, factors: &[f64], mark: &str, constant: f64) -> String {
        let states = self.states.iter().map(|name| format!("{name}{mark}"));
        let names = states.chain(self.inputs.iter().map(|name| (*name).to_owned()));
        let mut text = String::new();
        for (factor, name) in factors.iter().zip(names).filter(|(factor, _)| **factor != 0.0) {
            let sign = match (text.is_empty(), *factor < 0.0) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            text += sign;
            // Writing to a string cannot fail.
            let _ = match factor.abs() {
                1.0 => write!(text, "{name}"),
                size => write!(text, "{size} {name}"),
            };
        }
        let _ = match (text.is_empty(), constant) {
            (true, constant) => write!(text, "{constant}"),
            (false, 0.0) => Ok(()),
            (false, constant) if constant < 0.0 => write!(text, " - {}", -constant),
            (false, constant) => write!(text, " + {constant}"),
        };
        text
    }

    fn condition(&self, condition: StepCondition<'_>, mark: &str) -> String {
        match condition.set {
            ConditionSet::HalfSpace(own) => self.halfspace(own, mark),
            ConditionSet::Norm(own) => self.norm(own, mark),
        }
    }

    fn halfspace(&self, halfspace: &Halfspace, mark: &str) -> String {
        let limit = ByStep(&halfspace.limit, f64::to_string);
        let sum = self.sum(&halfspace.normal, mark, 0.0);
        let kind = if halfspace.is_limit { "; a limit" } else { "" };
        let is_row = [" <= ", " >= ", " = "].iter().any(|sign| halfspace.name.contains(sign));
        if is_row && !halfspace.limit.varies() {
            return format!("{}{kind}", halfspace.name);
        }
        format!("{sum} <= {limit} ({}{kind})", halfspace.name)
    }

    /// `|(vx, vy)| <= 3 (speed)`.
    fn norm(&self, limit: &NormLimit, mark: &str) -> String {
        let text = |part: &NormEntry| {
            let text = |constant: &f64| self.sum(&part.factors, mark, *constant);
            ByStep(&part.constant, text).to_string()
        };
        let entries: Vec<String> = limit.entries.iter().map(text).collect();
        let stated = format!("|({})| <= {}", entries.join(", "), text(&limit.bound));
        let kind = if limit.is_limit { "; a limit" } else { "" };
        match stated == limit.name {
            true => stated,
            false => format!("{stated} ({}{kind})", limit.name),
        }
    }

    fn flow(&self, f: &mut fmt::Formatter<'_>, flow: &LinearSystem, mark: &str) -> fmt::Result {
        let names = self.states.iter().zip(flow.c()).enumerate();
        for (i, (name, &constant)) in names.take(flow.states()) {
            let from_states = (0..flow.states()).map(|j| flow.a()[(i, j)]);
            let factors = from_states.chain((0..flow.inputs()).map(|j| flow.b()[(i, j)]));
            let factors: Vec<f64> = factors.collect();
            writeln!(f, "    {name}{mark} = {}", self.sum(&factors, "", constant))?;
        }
        Ok(())
    }

    fn choice(&self, f: &mut fmt::Formatter<'_>, choice: &Choice) -> fmt::Result {
        write!(f, "choice {}", choice.name)?;
        if choice.is_free {
            write!(f, ", free")?;
        }
        if choice.may_end {
            write!(f, ", may end")?;
        }
        writeln!(f)?;
        for Dwell { mode, least, most } in &choice.dwells {
            match most {
                Some(most) => writeln!(f, "  {mode} lasts for {least} to {most} samples")?,
                None => writeln!(f, "  {mode} lasts for at least {least} samples")?,
            }
        }
        choice.transitions.iter().try_for_each(|transition| self.transition(f, transition))
    }

    fn transition(&self, f: &mut fmt::Formatter<'_>, transition: &Transition) -> fmt::Result {
        write!(f, "  transition {}", transition.name)?;
        if let Some((from, to)) = &transition.modes {
            write!(f, ", from {from} to {to}")?;
        }
        writeln!(f, "{}", if transition.is_event { " (event)" } else { "" })?;
        let mark = if transition.reset.is_some() { "'" } else { "+" };
        let of = |moment| transition.conditions().filter(move |own| own.moment == moment);
        for guard in of(Moment::Start) {
            writeln!(f, "    if {}", self.condition(guard, ""))?;
        }
        for (input, range) in &transition.inputs {
            writeln!(f, "    {input} in {}", ByStep(range, Range::text))?;
        }
        self.flow(f, &transition.flow, mark)?;
        for guard in of(Moment::Prediction) {
            writeln!(f, "    if {}", self.condition(guard, mark))?;
        }
        if let Some(reset) = &transition.reset {
            for (i, name) in self.states.iter().enumerate().take(reset.matrix.nrows()) {
                let row: Vec<f64> =
                    (0..reset.matrix.ncols()).map(|j| reset.matrix[(i, j)]).collect();
                let text =
                    |offset: &Vec<f64>| self.sum(&row, mark, offset.get(i).copied().unwrap_or(0.0));
                writeln!(f, "    {name}+ = {}", ByStep(&reset.offset, text))?;
            }
        }
        for own in &transition.uncertain {
            let effect = &own.effect;
            for (i, name) in self.states.iter().enumerate().take(effect.matrix.nrows()) {
                let row: Vec<f64> =
                    (0..effect.matrix.ncols()).map(|j| effect.matrix[(i, j)]).collect();
                let text =
                    |offset: &Vec<f64>| self.sum(&row, mark, offset.get(i).copied().unwrap_or(0.0));
                let is_none = |offset: &Vec<f64>| offset.get(i) == Some(&0.0);
                if row.iter().all(|&a| a == 0.0) && effect.offset.values().all(is_none) {
                    continue;
                }
                let by = ByStep(&effect.offset, text);
                writeln!(f, "    {name}+ uncertain by {} times {by}", Range(own.range))?;
            }
        }
        for output in &transition.outputs {
            let mark = if output.is_at_start { "" } else { mark };
            let text = |constant: &f64| self.sum(&output.factors, mark, *constant);
            writeln!(f, "    {} = {}", output.name, ByStep(&output.constant, text))?;
        }
        Ok(())
    }
}
