//! The same by handles and expressions.

use carom::hybrid::{HybridSystem, Schedule, State, TransitionMut};
use carom::interval::Interval;
use carom::model::Row;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;

use super::plain::{Compared, DOMAIN, Line, Plain, Rows, TIME_STEP, UNNAMED, Way};

/// The handles of a system.
struct Handles {
    states: Vec<State>,
    inputs: Vec<Input>,
    series: [Variable; 2],
}

impl Handles {
    fn sum(&self, line: &Line, states: impl Iterator<Item = Affine>) -> Affine {
        let states = line.states.iter().zip(states).map(|(a, x)| *a * x);
        let inputs = line.inputs.iter().zip(&self.inputs).map(|(b, u)| *b * u);
        let series = line.series.iter().zip(&self.series).map(|(s, p)| *s * p);
        states.chain(inputs).chain(series).sum::<Affine>() + line.constant
    }

    fn start(&self, line: &Line) -> Affine {
        self.sum(line, self.states.iter().map(Affine::from))
    }

    fn predicted(&self, line: &Line) -> Affine {
        let line = Line { inputs: Vec::new(), ..line.clone() };
        self.sum(&line, self.states.iter().map(|state| state.predicted().into()))
    }

    fn rows(&self, rows: &Rows, of: impl Fn(&Line) -> Affine) -> Vec<(State, Affine)> {
        let stated = self.states.iter().zip(rows);
        stated.filter_map(|(state, row)| Some((*state, of(row.as_ref()?)))).collect()
    }
}

fn row(compared: &Compared, left: Affine) -> Row {
    match compared.kind {
        0 => left.le(compared.right),
        1 => left.ge(compared.right),
        2 => left.equals(compared.right),
        _ => left.within(compared.right, compared.right + compared.width),
    }
}

impl Plain {
    pub(super) fn by_handles(&self) -> Result<HybridSystem, Error> {
        let mut system = HybridSystem::new(TIME_STEP);
        let state = |i: usize| system.state(&format!("s{i}"), -DOMAIN, DOMAIN);
        let states = (0..self.states).map(state).collect::<Result<Vec<_>, _>>()?;
        let ends = self.inputs.iter().enumerate();
        let input = |(u, (lower, upper)): (usize, &(Vec<f64>, Vec<f64>))| {
            system.input(&format!("u{u}"), lower.clone(), upper.clone())
        };
        let inputs = ends.map(input).collect::<Result<Vec<_>, _>>()?;
        let [first, second] = self.series.clone();
        let series = [system.series("p", first)?, system.series("q", second)?];
        let out = system.output("out")?;
        let handles = Handles { states, inputs, series };
        for (is_limit, compared) in &self.limits {
            let row = row(compared, handles.start(&compared.line));
            match is_limit {
                true => system.limit("limit", row)?,
                false => system.invariant(row)?,
            }
        }
        if let Some(common) = &self.common {
            let rows = handles.rows(common, |line| handles.start(line));
            match self.is_by_rates {
                true => system.rates(rows)?,
                false => system.next(rows)?,
            }
        }
        for (c, ways) in self.choices.iter().enumerate() {
            let choice = format!("choice {c}");
            let has_memory = self.has_memory && c == 0;
            let modes = match has_memory {
                true => Some(system.modes(&choice, ["a", "b"])?),
                false => None,
            };
            for (number, way) in ways.iter().enumerate() {
                let own = match (modes, number) {
                    (Some([a, _]), 0) => system.stay(a)?,
                    (Some([_, b]), 1) => system.stay(b)?,
                    (Some([a, b]), 2) => system.switch(a, b)?,
                    (Some([a, b]), _) => system.switch(b, a)?.named("switch")?,
                    (None, _) if way.is_event => system.event_of(&choice, &self.name(c, number))?,
                    (None, _) => system.mode_of(&choice, &self.name(c, number))?,
                };
                self.state(way, own, &handles, out)?;
            }
            if c == 0 {
                system.expect(&choice, self.is_free, !self.is_free)?;
                if let Some([_, b]) = modes {
                    system.dwell(b, self.dwell.0, self.dwell.1)?;
                }
            }
        }
        if let Some((state, size)) = self.disturbance {
            system.disturbance(handles.states[state], -size.abs(), size.abs())?;
        }
        if let Some(most) = self.most_events {
            system.most_events(most);
        }
        Ok(system)
    }

    fn state(
        &self,
        way: &Way,
        mut own: TransitionMut<'_>,
        handles: &Handles,
        out: Variable,
    ) -> Result<(), Error> {
        let rows = way.flow.as_ref().map(|rows| handles.rows(rows, |line| handles.start(line)));
        own = match (rows, self.is_by_rates) {
            (None, _) => own,
            (Some(rows), true) => own.rates(rows)?,
            (Some(rows), false) => own.next(rows)?,
        };
        for compared in &way.guards {
            own = own.guard(row(compared, handles.start(&compared.line)))?;
        }
        if let Some(compared) = &way.limit {
            own = own.limit("rule", row(compared, handles.start(&compared.line)))?;
        }
        if let Some(compared) = &way.predicted {
            own = own.guard(row(compared, handles.predicted(&compared.line)))?;
        }
        if let Some(reset) = &way.reset {
            own = own.reset(handles.rows(reset, |line| handles.predicted(line)))?;
        }
        if let Some((is_at_start, line)) = &way.output {
            own = own.output(
                out,
                match is_at_start {
                    true => handles.start(line),
                    false => handles.predicted(line),
                },
            )?;
        }
        own.taken();
        Ok(())
    }

    /// Whether guards leave some input without a value.
    pub(super) fn is_crossed(&self) -> bool {
        let ways = self.choices.iter().enumerate();
        let all = ways.flat_map(|(c, ways)| (0..ways.len()).map(move |number| (c, number)));
        all.into_iter().any(|(c, number)| {
            let transition = self.transition(c, number);
            let empty = |range: &Schedule<Interval>| {
                (0..=range.settles())
                    .any(|step| range.get(step).is_some_and(|range| range.lower > range.upper))
            };
            transition.inputs.iter().any(|(_, range)| empty(range))
        })
    }

    /// Whether nothing states the flow of some transition.
    pub(super) fn lacks_flow(&self) -> bool {
        let own = |number: usize| self.choices[0][number].flow.is_some();
        let stated = match self.has_memory {
            true => own(0) && own(1),
            false => (0..self.choices[0].len()).all(own),
        };
        self.common.is_none() && !stated
    }
}

/// The names of rows without a name are their text, which the other statement does not have.
pub(super) fn without_texts(mut system: HybridSystem) -> HybridSystem {
    let parts = system.parts_mut();
    let transitions = parts.choices.iter_mut().flat_map(|choice| &mut choice.transitions);
    let guards = transitions.flat_map(|t| t.guards.iter_mut().chain(&mut t.prediction_guards));
    for half in guards.chain(&mut *parts.limits).filter(|half| !half.is_limit) {
        assert!(half.name.contains('='), "{}", half.name);
        half.name = UNNAMED.into();
    }
    system
}
