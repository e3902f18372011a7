//! The same by matrices and half-spaces.

use carom::hybrid::{HybridSystem, LinearSystem, Matrix, Schedule};
use carom::interval::Interval;
use carom_hybrid::internals::{Choice, Halfspace, Transition};

use super::plain::{Compared, DOMAIN, Line, Plain, Rows, TIME_STEP, UNNAMED};

impl Plain {
    /// A value for each step until nothing changes, where some series matter.
    fn by_step<T>(&self, lines: &[&Line], at: impl Fn(usize) -> T) -> Vec<T> {
        let last = |line: &&Line| {
            let used = (0..2).filter(|&k| line.series[k] != 0.0);
            used.map(|k| self.series[k].len() - 1).max().unwrap_or(0)
        };
        (0..=lines.iter().map(last).max().unwrap_or(0)).map(at).collect()
    }

    fn constant(&self, line: &Line, step: usize) -> f64 {
        let value = |k: usize| self.series[k][step.min(self.series[k].len() - 1)];
        line.constant + line.series[0] * value(0) + line.series[1] * value(1)
    }

    fn normal(&self, line: &Line) -> Vec<f64> {
        match line.inputs.iter().any(|b| *b != 0.0) {
            true => [&line.states[..], &line.inputs].concat(),
            false => line.states.clone(),
        }
    }

    fn halfspaces(&self, name: &str, is_limit: bool, row: &Compared) -> Vec<Halfspace> {
        let (lower, upper) = row.ends();
        let side = |sign: f64, end: f64| {
            let normal: Vec<f64> = self.normal(&row.line).iter().map(|a| sign * a).collect();
            let at = |step| sign * (end - self.constant(&row.line, step));
            let limit = self.by_step(&[&row.line], at);
            match is_limit {
                true => Halfspace::limit(name, normal, limit),
                false => Halfspace::new(name, normal, limit),
            }
        };
        let upper = upper.map(|end| side(1.0, end));
        upper.into_iter().chain(lower.map(|end| side(-1.0, end))).collect()
    }

    /// The flow of stated rows above other rows.
    fn flow(&self, stated: &Rows, below: Option<&Rows>) -> (LinearSystem, Rows) {
        let (n, m) = (self.states, self.inputs.len());
        let keeps = |i: usize| Line {
            states: (0..n).map(|j| f64::from(i == j && !self.is_by_rates)).collect(),
            inputs: vec![0.0; m],
            series: [0.0; 2],
            constant: 0.0,
        };
        let own = |i: usize| stated[i].clone().or_else(|| below.and_then(|rows| rows[i].clone()));
        let all: Vec<Line> = (0..n).map(|i| own(i).unwrap_or_else(|| keeps(i))).collect();
        let a = Matrix::from_fn(n, n, |i, j| all[i].states[j]);
        let b = Matrix::from_fn(n, m, |i, j| all[i].inputs[j]);
        let c: Vec<f64> = all.iter().map(|line| line.constant).collect();
        let flow = match self.is_by_rates {
            true => LinearSystem::zero_order_hold(a, b, c, TIME_STEP),
            false => LinearSystem::new(a, b, c),
        };
        (flow.unwrap(), all.into_iter().map(Some).collect())
    }

    /// The range of an input where a row limits it too, by step.
    fn narrowed(&self, known: &[Interval], input: usize, row: &Compared) -> Vec<Interval> {
        let (lower, upper) = row.ends();
        let factor = row.line.inputs[input];
        let own = self.by_step(&[&row.line], |step| {
            let constant = self.constant(&row.line, step);
            let end =
                |end: Option<f64>, open: f64| end.map_or(open, |end| (end - constant) / factor);
            let low = end(lower, f64::NEG_INFINITY * factor.signum());
            let high = end(upper, f64::INFINITY * factor.signum());
            Interval::new(low.min(high), low.max(high))
        });
        let at = |list: &[Interval], step: usize| list[step.min(list.len() - 1)];
        let both = |step: usize| at(known, step).intersection(at(&own, step));
        (0..known.len().max(own.len())).map(both).collect()
    }

    fn range(&self, input: usize) -> Vec<Interval> {
        let (lower, upper) = &self.inputs[input];
        let at = |list: &[f64], step: usize| list[step.min(list.len() - 1)];
        let steps = 0..lower.len().max(upper.len());
        steps.map(|step| Interval::new(at(lower, step), at(upper, step))).collect()
    }

    pub(super) fn transition(&self, choice: usize, number: usize) -> Transition {
        let way = &self.choices[choice][number];
        let common = self.common.as_ref();
        // A switch has the flow of the mode that it enters.
        let entered = match (self.has_memory && choice == 0, number) {
            (true, 2) => self.choices[0][1].flow.as_ref(),
            (true, 3) => self.choices[0][0].flow.as_ref(),
            _ => None,
        };
        let nothing = vec![None; self.states];
        let stated = way.flow.as_ref().or(entered).unwrap_or(&nothing);
        let name = self.name(choice, number);
        let mut own = Transition::new(&name, self.flow(stated, common).0);
        own.is_event = self.is_event(choice, number);
        for row in &way.guards {
            let used: Vec<usize> =
                (0..self.inputs.len()).filter(|&u| row.line.inputs[u] != 0.0).collect();
            if row.line.states.iter().any(|a| *a != 0.0) || used.len() != 1 {
                own.guards.extend(self.halfspaces(UNNAMED, false, row));
                continue;
            }
            let name = format!("u{}", used[0]);
            let known = own.inputs.iter().position(|(own, _)| *own == name);
            let before: Vec<Interval> = match known {
                Some(k) => {
                    let list = &own.inputs[k].1;
                    (0..=list.settles()).map(|step| *list.get(step).unwrap()).collect()
                }
                None => self.range(used[0]),
            };
            let range: Schedule<Interval> = self.narrowed(&before, used[0], row).into();
            match known {
                Some(k) => own.inputs[k].1 = range,
                None => own = own.with_input_range(name, range),
            }
        }
        if let Some(row) = &way.limit {
            own.guards.extend(self.halfspaces("rule", true, row));
        }
        if let Some(row) = &way.predicted {
            own.prediction_guards.extend(self.halfspaces(UNNAMED, false, row));
        }
        if let Some(reset) = &way.reset {
            let n = self.states;
            let matrix = Matrix::from_fn(n, n, |i, j| match &reset[i] {
                Some(line) => line.states[j],
                None => f64::from(i == j),
            });
            let lines: Vec<&Line> = reset.iter().flatten().collect();
            let offset = self.by_step(&lines, |step| {
                let entry =
                    |row: &Option<Line>| row.as_ref().map_or(0.0, |l| self.constant(l, step));
                reset.iter().map(entry).collect::<Vec<f64>>()
            });
            own = own.with_reset_by_step(matrix, offset);
        }
        if let Some((is_at_start, line)) = &way.output {
            let constant = self.by_step(&[line], |step| self.constant(line, step));
            let is_empty = line.states.iter().chain(&line.inputs).all(|a| *a == 0.0);
            own = match *is_at_start && !is_empty {
                true => own.with_start_output("out", self.normal(line), constant),
                false => own.with_output("out", line.states.clone(), constant),
            };
        }
        match (self.has_memory && choice == 0, number) {
            (true, 0) => own.within("a"),
            (true, 1) => own.within("b"),
            (true, 2) => own.between("a", "b"),
            (true, _) => own.between("b", "a"),
            (false, _) => own,
        }
    }

    pub(super) fn name(&self, choice: usize, number: usize) -> String {
        match (self.has_memory && choice == 0, number) {
            (true, 0) => "a".into(),
            (true, 1) => "b".into(),
            (true, 2) => "a to b".into(),
            (true, 3) => "switch".into(),
            _ => format!("way {number}"),
        }
    }

    fn is_event(&self, choice: usize, number: usize) -> bool {
        match self.has_memory && choice == 0 {
            true => number >= 2,
            false => self.choices[choice][number].is_event,
        }
    }

    pub(super) fn by_numbers(&self) -> HybridSystem {
        let mut system = HybridSystem::new(TIME_STEP);
        for i in 0..self.states {
            system = system.with_state(format!("s{i}"), Interval::new(-DOMAIN, DOMAIN));
        }
        for u in 0..self.inputs.len() {
            system = system.with_input(format!("u{u}"), self.range(u));
        }
        for (is_limit, row) in &self.limits {
            let name = if *is_limit { "limit" } else { UNNAMED };
            for half in self.halfspaces(name, *is_limit, row) {
                system = system.with_limit(half);
            }
        }
        if let Some(common) = &self.common {
            system = system.with_flow(self.flow(common, None).0);
        }
        for (c, ways) in self.choices.iter().enumerate() {
            let mut choice = Choice::new(format!("choice {c}"));
            for number in 0..ways.len() {
                choice = choice.with_transition(self.transition(c, number));
            }
            if c == 0 {
                choice = choice.with_free_choice(self.is_free).with_dead_ends(!self.is_free);
                if self.has_memory {
                    choice = choice.with_dwell("b", self.dwell.0, self.dwell.1);
                }
            }
            system = system.with_choice(choice);
        }
        if let Some((state, size)) = self.disturbance {
            let mut ranges = vec![Interval::point(0.0); self.states];
            ranges[state] = Interval::new(-size.abs(), size.abs());
            system = system.with_disturbance(ranges);
        }
        match self.most_events {
            Some(most) => system.with_most_events(most),
            None => system,
        }
    }
}

impl Compared {
    fn ends(&self) -> (Option<f64>, Option<f64>) {
        match self.kind {
            0 => (None, Some(self.right)),
            1 => (Some(self.right), None),
            2 => (Some(self.right), Some(self.right)),
            _ => (Some(self.right), Some(self.right + self.width)),
        }
    }
}
