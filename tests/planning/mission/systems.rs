//! Random systems without a free number: a run is a sequence of transitions, and all of them can be
//! listed.

use carom::prelude::*;
use proptest::prelude::{Just, Strategy, any, prop_oneof};

/// What is known at a sample of a run.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    pub(super) x: f64,
    pub(super) y: f64,
    /// The input of the step that begins here and the mode that it is spent in.
    pub(super) input: Option<f64>,
    pub(super) taken: Option<usize>,
    /// The mode in which the run is.
    pub(super) mode: Option<usize>,
    pub(super) modes: usize,
}

pub(super) struct Handles {
    pub(super) x: State,
    pub(super) y: Option<State>,
    pub(super) input: Input,
    /// By mode: that it is taken in a step, and that it is the mode at a sample.
    pub(super) taken: Vec<Variable>,
    pub(super) modes: Vec<Variable>,
}

#[derive(Debug, Clone, Copy)]
enum Reset {
    None,
    Mirror,
    Zero,
}

/// A mode with its own input: `x' = sign x + input + push`.
#[derive(Debug, Clone)]
struct SketchMode {
    sign: f64,
    push: f64,
    input: f64,
    /// On x at the start and the end of the step.
    guard: Option<(bool, f64)>,
    end_guard: Option<(bool, f64)>,
    reset: Reset,
    /// Modes that may follow, if there is memory.
    follow: [bool; 3],
}

#[derive(Debug, Clone, Copy)]
enum Second {
    None,
    /// The second state sums steps, is the last x, or changes its sign.
    Drift,
    Last,
    Flip,
}

#[derive(Debug, Clone)]
pub(super) struct SketchSystem {
    pub(super) time_step: f64,
    pub(super) start: f64,
    modes: Vec<SketchMode>,
    has_memory: bool,
    second: Second,
    /// Domains are `±domain`.
    domain: f64,
}

const MODES: [&str; 3] = ["a", "b", "c"];

pub(super) fn systems() -> impl Strategy<Value = SketchSystem> {
    let guard = || {
        let some = (any::<bool>(), -4_i32..=4)
            .prop_map(|(is_least, k)| Some((is_least, f64::from(k) / 2.0)));
        prop_oneof![3 => Just(None), 1 => some]
    };
    let reset =
        prop_oneof![6 => Just(Reset::None), 1 => Just(Reset::Mirror), 1 => Just(Reset::Zero)];
    let mode = (
        prop_oneof![5 => Just(1.0), 1 => Just(-1.0), 1 => Just(0.0)],
        -2_i32..=2,
        -1_i32..=1,
        guard(),
        guard(),
        reset,
        any::<[bool; 3]>(),
    )
        .prop_map(|(sign, push, input, guard, end_guard, reset, follow)| {
            let (push, input) = (f64::from(push), f64::from(input));
            SketchMode { sign, push, input, guard, end_guard, reset, follow }
        });
    let second = prop_oneof![
        Just(Second::None),
        Just(Second::Drift),
        Just(Second::Last),
        Just(Second::Flip)
    ];
    (
        prop_oneof![Just(1.0), Just(0.5), Just(0.1), Just(0.3)],
        -3_i32..=3,
        proptest::collection::vec(mode, 1..=3),
        any::<bool>(),
        second,
        prop_oneof![3 => Just(40.0), 1 => Just(4.0)],
    )
        .prop_map(|(time_step, start, modes, has_memory, second, domain)| {
            let start = f64::from(start);
            SketchSystem { time_step, start, modes, has_memory, second, domain }
        })
}

impl SketchSystem {
    pub(super) fn build(&self) -> Result<(HybridSystem, Handles), Error> {
        let mut system = HybridSystem::new(self.time_step);
        let x = system.state("x", -self.domain, self.domain)?;
        let y = match self.second {
            Second::None => None,
            _ => Some(system.state("y", -self.domain, self.domain)?),
        };
        let input = system.input("u", -1.0, 1.0)?;
        let names = &MODES[..self.modes.len()];
        let in_mode = match (self.has_memory, names.len()) {
            (false, _) => Vec::new(),
            (true, 1) => system.modes("mode", [MODES[0]])?.to_vec(),
            (true, 2) => system.modes("mode", [MODES[0], MODES[1]])?.to_vec(),
            (true, _) => system.modes("mode", MODES)?.to_vec(),
        };
        for (k, mode) in self.modes.iter().enumerate() {
            let mut to = vec![(mode, None)];
            if self.has_memory {
                let follow = (0..self.modes.len()).filter(|j| *j != k && mode.follow[*j]);
                to.extend(follow.map(|j| (&self.modes[j], Some(j))));
            }
            for (mode, to) in to {
                let mut stated = match to {
                    _ if !self.has_memory => system.mode(names[k])?,
                    None => system.stay(in_mode[k])?,
                    Some(to) => system.switch(in_mode[k], in_mode[to])?,
                };
                let mut next = vec![x.is(mode.sign * x + input + mode.push)];
                match (self.second, y) {
                    (Second::Drift, Some(y)) => next.push(y.is(y + mode.push)),
                    (Second::Last, Some(y)) => next.push(y.is(x)),
                    (Second::Flip, Some(y)) => next.push(y.is(-y)),
                    _ => {}
                }
                stated = stated.next(next)?.guard(input.equals(mode.input))?;
                let side = |of: Affine, (is_least, end): (bool, f64)| match is_least {
                    true => of.ge(end),
                    false => of.le(end),
                };
                if let Some(guard) = mode.guard {
                    stated = stated.guard(side(x.into(), guard))?;
                }
                if let Some(guard) = mode.end_guard {
                    stated = stated.guard(side(x.predicted().into(), guard))?;
                }
                match mode.reset {
                    Reset::None => {}
                    Reset::Mirror => _ = stated.reset([x.is(-x.predicted())])?,
                    Reset::Zero => _ = stated.reset([x.is(0.0)])?,
                }
            }
        }
        let mut taken = Vec::new();
        for (k, name) in names.iter().enumerate() {
            taken.push(match self.has_memory {
                true => system.acting(in_mode[k])?,
                false => system.transition_named("mode", name)?,
            });
        }
        let modes = if self.has_memory { in_mode } else { taken.clone() };
        Ok((system, Handles { x, y, input, taken, modes }))
    }

    fn start_y(&self) -> f64 {
        if matches!(self.second, Second::None) { self.start } else { 1.0 }
    }

    pub(super) fn starts(&self, handles: &Handles) -> Vec<Row> {
        let mut rows = vec![handles.x.equals(self.start)];
        rows.extend(handles.y.map(|y| y.equals(1.0)));
        if self.has_memory {
            rows.push(Affine::from(handles.modes[0]).equals(1.0));
        }
        rows
    }

    /// All runs of some steps; `None` if there are more than `most`.
    pub(super) fn runs(&self, steps: usize, most: usize) -> Option<Vec<Vec<Sample>>> {
        let modes = self.modes.len();
        let first = Sample {
            x: self.start,
            y: self.start_y(),
            input: None,
            taken: None,
            mode: self.has_memory.then_some(0),
            modes,
        };
        if first.x.abs() > self.domain {
            return Some(Vec::new());
        }
        let mut runs = vec![vec![first]];
        for _ in 0..steps {
            let mut longer = Vec::new();
            for run in &runs {
                for (k, mode) in self.modes.iter().enumerate() {
                    longer.extend(self.step(run, k, mode));
                }
            }
            if longer.len() > most {
                return None;
            }
            runs = longer;
        }
        Some(runs)
    }

    fn step(&self, run: &[Sample], to: usize, mode: &SketchMode) -> Option<Vec<Sample>> {
        let here = run.last()?;
        let holds = |guard: Option<(bool, f64)>, x: f64| {
            guard.is_none_or(|(is_least, end)| if is_least { x >= end } else { x <= end })
        };
        let may_follow = match here.mode {
            Some(from) => from == to || self.modes[from].follow[to],
            None => true,
        };
        let predicted = mode.sign * here.x + mode.input + mode.push;
        if !may_follow || !holds(mode.guard, here.x) || !holds(mode.end_guard, predicted) {
            return None;
        }
        let x = match mode.reset {
            Reset::None => predicted,
            Reset::Mirror => -predicted,
            Reset::Zero => 0.0,
        };
        let y = match self.second {
            Second::None => x,
            Second::Drift => here.y + mode.push,
            Second::Last => here.x,
            Second::Flip => -here.y,
        };
        if x.abs() > self.domain || y.abs() > self.domain {
            return None;
        }
        let mut longer = run.to_vec();
        let last = longer.last_mut()?;
        (last.input, last.taken) = (Some(mode.input), Some(to));
        if !self.has_memory {
            last.mode = Some(to);
        }
        let mode = self.has_memory.then_some(to);
        longer.push(Sample { x, y, input: None, taken: None, mode, modes: self.modes.len() });
        Some(longer)
    }
}
