//! Random systems with memory, dwell times, several choices, guards on inputs and values by step,
//! and runs through them, in plain numbers.

use carom::hybrid::{HybridSystem, LinearSystem, Matrix, Schedule};
use carom::interval::Interval;
use carom_hybrid::internals::{Choice, Halfspace, Transition};

/// A small generator of numbers (xorshift), so that a plant is one seed.
#[derive(Debug, Clone)]
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Dice(seed ^ 0x9E37_79B9_7F4A_7C15 | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() as f64 / (1u64 << 53) as f64)
    }

    pub(crate) fn flip(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }

    /// Often 0, so that states come apart.
    fn entry(&mut self, size: f64) -> f64 {
        match self.below(5) {
            0 | 1 => 0.0,
            2 => size,
            _ => self.within(-size, size),
        }
    }

    fn rows(&mut self, rows: usize, columns: usize, size: f64) -> Vec<Vec<f64>> {
        (0..rows).map(|_| (0..columns).map(|_| self.entry(size)).collect()).collect()
    }
}

pub(crate) const DOMAIN: f64 = 20.0;

/// `normal . (state, input) <= limit`, by step; the last limit goes on.
#[derive(Debug, Clone)]
pub(crate) struct Limit {
    normal: Vec<f64>,
    limits: Vec<f64>,
}

#[derive(Debug, Clone)]
pub(crate) struct Flow {
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    c: Vec<f64>,
}

/// A matrix, row by row.
type Rows = Vec<Vec<f64>>;

/// A transition in plain numbers.
#[derive(Debug, Clone)]
pub(crate) struct Law {
    flow: Flow,
    guards: Vec<Limit>,
    prediction_guards: Vec<Limit>,
    reset: Option<(Rows, Rows)>,
    /// Its own range of input 0.
    range: Option<(f64, f64)>,
    /// Input 0 is `factors . state + constant`.
    forced: Option<(Vec<f64>, f64)>,
    modes: Option<(usize, usize)>,
    pub(crate) is_event: bool,
}

#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub(crate) laws: Vec<Law>,
    /// Mode, at least, at most.
    dwell: Option<(usize, usize, Option<usize>)>,
}

#[derive(Debug, Clone)]
pub(crate) struct Plant {
    pub(crate) states: usize,
    pub(crate) inputs: usize,
    common: Flow,
    pub(crate) parts: Vec<Part>,
    limits: Vec<Limit>,
    pub(crate) most_events: Option<usize>,
    pub(crate) disturbance: f64,
}

/// What a run does in a step.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    /// The law of each part.
    pub(crate) taken: Vec<usize>,
    /// The prediction of each part's law.
    pub(crate) predictions: Vec<Vec<f64>>,
    pub(crate) next: Vec<f64>,
}

#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) start: Vec<f64>,
    pub(crate) steps: Vec<Step>,
    /// By sample and part.
    pub(crate) modes: Vec<Vec<Option<usize>>>,
}

fn at<T>(list: &[T], step: usize) -> &T {
    list.get(step).unwrap_or(&list[list.len() - 1])
}

fn times(matrix: &[Vec<f64>], z: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| row.iter().zip(z).map(|(a, b)| a * b).sum()).collect()
}

fn plus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

impl Flow {
    fn random(dice: &mut Dice, states: usize, inputs: usize) -> Self {
        Flow {
            a: dice.rows(states, states, 1.0),
            b: dice.rows(states, inputs, 1.0),
            c: (0..states).map(|_| dice.within(-0.3, 0.3)).collect(),
        }
    }

    fn step(&self, state: &[f64], input: &[f64]) -> Vec<f64> {
        plus(&plus(&times(&self.a, state), &times(&self.b, input)), &self.c)
    }

    fn system(&self, inputs: usize) -> LinearSystem {
        let n = self.c.len();
        let a = Matrix::from_fn(n, n, |i, j| self.a[i][j]);
        let b = Matrix::from_fn(n, inputs, |i, j| self.b[i][j]);
        LinearSystem::new(a, b, self.c.clone()).unwrap()
    }
}

impl Limit {
    fn random(dice: &mut Dice, states: usize, inputs: usize) -> Self {
        let mut normal: Vec<f64> = (0..states).map(|_| dice.entry(1.0)).collect();
        if inputs > 0 && dice.flip(60) {
            normal.extend((0..inputs).map(|_| dice.entry(1.0)));
        }
        let count = if dice.flip(30) { 1 + dice.below(4) } else { 1 };
        let limit = |dice: &mut Dice| match dice.flip(15) {
            true => f64::INFINITY,
            false => dice.within(-0.5, 5.0),
        };
        let limits = (0..count).map(|_| limit(dice)).collect();
        Limit { normal, limits }
    }

    fn holds(&self, point: &[f64], step: usize) -> bool {
        let value: f64 = self.normal.iter().zip(point).map(|(n, x)| n * x).sum();
        value <= *at(&self.limits, step)
    }

    fn halfspace(&self, name: &str) -> Halfspace {
        Halfspace::new(name, self.normal.clone(), self.limits.clone())
    }
}

impl Law {
    fn random(dice: &mut Dice, states: usize, inputs: usize, common: Option<&Flow>) -> Self {
        let flow = match common {
            // Shared, shifted, or with another effect.
            Some(common) if dice.flip(50) => {
                let mut flow = common.clone();
                if dice.flip(50) {
                    flow.c = flow.c.iter().map(|c| c + dice.within(-0.5, 0.5)).collect();
                }
                flow
            }
            _ => Flow::random(dice, states, inputs),
        };
        let guards = |dice: &mut Dice, inputs: usize| -> Vec<Limit> {
            (0..dice.below(2)).map(|_| Limit::random(dice, states, inputs)).collect()
        };
        let reset = dice.flip(40).then(|| {
            let offset = |dice: &mut Dice| (0..states).map(|_| dice.within(-0.5, 0.5)).collect();
            let count = 1 + dice.below(2);
            (dice.rows(states, states, 1.0), (0..count).map(|_| offset(dice)).collect())
        });
        let forced = dice.flip(20).then(|| {
            let factors = (0..states).map(|_| dice.entry(0.5)).collect();
            (factors, dice.within(-0.3, 0.3))
        });
        let range = match forced {
            Some(_) => Some((-3.0, 3.0)),
            None => dice.flip(20).then(|| (dice.within(-2.0, 0.0), dice.within(0.0, 1.5))),
        };
        Law {
            flow,
            guards: guards(dice, inputs),
            prediction_guards: guards(dice, 0),
            reset,
            range,
            forced,
            modes: None,
            is_event: dice.flip(40),
        }
    }

    fn transition(&self, name: String, states: usize, inputs: usize) -> Transition {
        let flow = self.flow.system(inputs);
        let mut transition = match self.is_event {
            true => Transition::event(name, flow),
            false => Transition::new(name, flow),
        };
        transition = transition.with_guards(self.guards.iter().map(|g| g.halfspace("guard")));
        for guard in &self.prediction_guards {
            transition = transition.with_prediction_guard(guard.halfspace("prediction"));
        }
        if let Some((matrix, offsets)) = &self.reset {
            let matrix = Matrix::from_fn(states, states, |i, j| matrix[i][j]);
            transition = transition.with_reset_by_step(matrix, Schedule::from(offsets.clone()));
        }
        if let Some((low, high)) = self.range {
            transition = transition.with_input_range("u0", Interval::new(low, high));
        }
        if let Some((factors, constant)) = &self.forced {
            // u0 - factors . x = constant.
            let mut normal: Vec<f64> = factors.iter().map(|f| -f).collect();
            normal.extend((0..inputs).map(|j| if j == 0 { 1.0 } else { 0.0 }));
            transition = transition.with_guards(Halfspace::equality("law", normal, *constant));
        }
        match self.modes {
            Some((from, to)) => transition.between(format!("m{from}"), format!("m{to}")),
            None => transition,
        }
    }
}

impl Part {
    /// The modes that its laws name, ascending.
    pub(crate) fn modes(&self) -> Vec<usize> {
        let named = self.laws.iter().filter_map(|law| law.modes);
        let mut modes: Vec<usize> = named.flat_map(|(from, to)| [from, to]).collect();
        modes.sort_unstable();
        modes.dedup();
        modes
    }
}

impl Plant {
    pub(crate) fn random(seed: u64) -> Self {
        let dice = &mut Dice::new(seed);
        let (states, inputs) = (1 + dice.below(4), 1 + dice.below(2));
        let common = Flow::random(dice, states, inputs);
        let count = if dice.flip(40) { 2 } else { 1 };
        let mut parts = Vec::new();
        for p in 0..count {
            let laws = 1 + dice.below(3);
            let shared = (count > 1).then_some(&common);
            let mut laws: Vec<Law> =
                (0..laws).map(|_| Law::random(dice, states, inputs, shared)).collect();
            if p > 0 {
                // Ranges and laws of the input are of the first part.
                laws.iter_mut().for_each(|law| (law.range, law.forced) = (None, None));
            }
            let mut dwell = None;
            if dice.flip(50) {
                let modes = 1 + dice.below(3);
                for law in &mut laws {
                    law.modes = Some((dice.below(modes), dice.below(modes)));
                }
                // A way to stay and a way on, so that runs do not end at once.
                for mode in 0..modes {
                    let mut stay = Law::random(dice, states, inputs, shared);
                    (stay.guards, stay.prediction_guards) = (Vec::new(), Vec::new());
                    (stay.range, stay.forced) = (None, None);
                    let mut leave = stay.clone();
                    stay.modes = Some((mode, mode));
                    leave.modes = Some((mode, (mode + 1) % modes));
                    laws.extend([stay, leave]);
                }
                let least = 1 + dice.below(3);
                let most = dice.flip(50).then(|| least + dice.below(2));
                dwell = dice.flip(60).then(|| (dice.below(modes), least, most));
            }
            parts.push(Part { laws, dwell });
        }
        let limits = (0..dice.below(2)).map(|_| Limit::random(dice, states, inputs)).collect();
        let most_events = dice.flip(30).then(|| dice.below(4));
        let disturbance = dice.within(0.0, 0.2);
        Plant { states, inputs, common, parts, limits, most_events, disturbance }
    }

    pub(crate) fn hybrid(&self) -> HybridSystem {
        let mut system = HybridSystem::new(1.0);
        for i in 0..self.states {
            system = system.with_state(format!("s{i}"), Interval::new(-DOMAIN, DOMAIN));
        }
        for j in 0..self.inputs {
            system = system.with_input(format!("u{j}"), Interval::new(-1.0, 1.0));
        }
        for limit in &self.limits {
            system = system.with_limit(limit.halfspace("limit"));
        }
        for (p, part) in self.parts.iter().enumerate() {
            let mut choice = Choice::new(format!("part {p}"));
            for (k, law) in part.laws.iter().enumerate() {
                let name = format!("law {k}");
                choice = choice.with_transition(law.transition(name, self.states, self.inputs));
            }
            if let Some((mode, least, most)) = part.dwell {
                // A mode that no law names has no dwell time.
                let mode = format!("m{mode}");
                if choice.modes().contains(&mode.as_str()) {
                    choice = choice.with_dwell(mode, least, most);
                }
            }
            system = system.with_choice(choice);
        }
        if let Some(most) = self.most_events {
            system = system.with_most_events(most);
        }
        let box_around = vec![Interval::new(-self.disturbance, self.disturbance); self.states];
        system.with_flow(self.common.system(self.inputs)).with_disturbance(box_around)
    }

    /// A random run of at most `most` steps.
    pub(crate) fn run(&self, seed: u64, most: usize, is_disturbed: bool) -> Run {
        let dice = &mut Dice::new(seed);
        let start: Vec<f64> = (0..self.states).map(|_| dice.within(-2.0, 2.0)).collect();
        let mode = |part: &Part, dice: &mut Dice| {
            let modes: Vec<usize> = part.laws.iter().filter_map(|l| Some(l.modes?.0)).collect();
            (!modes.is_empty()).then(|| modes[dice.below(modes.len())])
        };
        let first = self.parts.iter().map(|part| mode(part, dice)).collect();
        let mut run = Run { start, steps: Vec::new(), modes: vec![first] };
        if !self.keeps_limits(&run.start, None, 0) {
            return run;
        }
        while run.steps.len() < most {
            let found = (0..30).find_map(|_| self.step(&run, dice, is_disturbed));
            let Some(step) = found else { break };
            let modes = self.parts.iter().zip(&step.taken);
            run.modes.push(modes.map(|(part, &k)| Some(part.laws[k].modes?.1)).collect());
            run.steps.push(step);
        }
        run
    }

    /// Whether the limits hold at a sample, or, with the inputs, at the start of a step.
    fn keeps_limits(&self, state: &[f64], input: Option<&[f64]>, step: usize) -> bool {
        let point: Vec<f64> = state.iter().chain(input.unwrap_or(&[])).copied().collect();
        let inside = state.iter().all(|x| x.abs() <= DOMAIN);
        // Limits that do not depend on the inputs hold at every sample.
        let is_joint = |limit: &Limit| limit.normal.iter().skip(self.states).any(|&m| m != 0.0);
        let is_stated = |limit: &&Limit| input.is_some() || !is_joint(limit);
        inside && self.limits.iter().filter(is_stated).all(|limit| limit.holds(&point, step))
    }

    fn step(&self, run: &Run, dice: &mut Dice, is_disturbed: bool) -> Option<Step> {
        let t = run.steps.len();
        let state = run.state(t);
        let taken: Vec<usize> = self.parts.iter().map(|part| dice.below(part.laws.len())).collect();
        let laws: Vec<&Law> =
            self.parts.iter().zip(&taken).map(|(part, &k)| &part.laws[k]).collect();
        let events = self.events(run) + laws.iter().filter(|law| law.is_event).count();
        let may = events <= self.most_events.unwrap_or(usize::MAX)
            && (0..laws.len()).all(|p| self.remembers(run, p, laws[p]));
        if !may {
            return None;
        }
        let (low, high) = laws[0].range.unwrap_or((-1.0, 1.0));
        let mut input: Vec<f64> = (0..self.inputs).map(|_| dice.within(-1.0, 1.0)).collect();
        input[0] = match dice.below(4) {
            0 => low,
            1 => high,
            _ => dice.within(low, high),
        };
        if let Some((factors, constant)) = &laws[0].forced {
            input[0] = factors.iter().zip(state).map(|(f, x)| f * x).sum::<f64>() + constant;
        }
        let point: Vec<f64> = state.iter().chain(&input).copied().collect();
        let kept = low <= input[0]
            && input[0] <= high
            && laws.iter().all(|law| law.guards.iter().all(|guard| guard.holds(&point, t)))
            && self.keeps_limits(state, Some(&input), t);
        if !kept {
            return None;
        }
        let common = self.common.step(state, &input);
        let predictions: Vec<Vec<f64>> =
            laws.iter().map(|law| law.flow.step(state, &input)).collect();
        let mut next = if laws.len() > 1 { common.clone() } else { vec![0.0; self.states] };
        for (law, prediction) in laws.iter().zip(&predictions) {
            if !law.prediction_guards.iter().all(|guard| guard.holds(prediction, t)) {
                return None;
            }
            let after = match &law.reset {
                Some((matrix, offsets)) => {
                    plus(&times(matrix, prediction), at::<Vec<f64>>(offsets, t))
                }
                None => prediction.clone(),
            };
            for i in 0..self.states {
                next[i] += after[i] - if laws.len() > 1 { common[i] } else { 0.0 };
            }
        }
        if is_disturbed {
            for x in &mut next {
                *x += match dice.below(3) {
                    0 => self.disturbance,
                    1 => -self.disturbance,
                    _ => dice.within(-self.disturbance, self.disturbance),
                };
            }
        }
        self.keeps_limits(&next, None, t + 1).then_some(Step { taken, predictions, next })
    }

    fn events(&self, run: &Run) -> usize {
        run.steps.iter().map(|step| self.events_of(step)).sum()
    }

    pub(crate) fn events_of(&self, step: &Step) -> usize {
        let taken = self.parts.iter().zip(&step.taken);
        taken.filter(|(part, k)| part.laws[**k].is_event).count()
    }

    /// Whether the mode and its dwell time allow a law.
    fn remembers(&self, run: &Run, part: usize, law: &Law) -> bool {
        let Some((from, to)) = law.modes else { return true };
        let history: Vec<usize> = run.modes.iter().filter_map(|modes| modes[part]).collect();
        let now = history[history.len() - 1];
        let lasted = history.iter().rev().take_while(|&&mode| mode == now).count();
        let is_first = lasted == history.len();
        let dwell = self.parts[part].dwell.filter(|dwell| dwell.0 == now);
        let (least, most) = dwell.map_or((1, None), |(_, least, most)| (least, most));
        let allowed = match from == to {
            true => most.is_none_or(|most| lasted < most),
            false => is_first || lasted >= least,
        };
        now == from && allowed
    }
}

impl Run {
    pub(crate) fn state(&self, sample: usize) -> &[f64] {
        if sample == 0 { &self.start } else { &self.steps[sample - 1].next }
    }
}
