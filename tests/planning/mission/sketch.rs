//! Missions before they have a system, and what they mean, by their definition: it shares nothing
//! with the crate.

use carom::hybrid::Mission;
use carom::prelude::*;
use proptest::prelude::{Just, Strategy, any, prop_oneof};

use super::systems::{Handles, Sample};

/// A number at a sample.
#[derive(Debug, Clone, Copy)]
pub(super) enum Quantity {
    X,
    /// The second state; the first one again, if there is none.
    Y,
    Both,
    /// The input, which the last sample lacks.
    Input,
    /// The first state, and two more if a mode is taken.
    Jump(usize),
    /// Whether a mode is taken in the step that begins here, and whether it is the mode here.
    Taken(usize),
    Mode(usize),
}

#[derive(Debug, Clone, Copy)]
pub(super) struct SketchRow {
    pub(super) of: Quantity,
    pub(super) lower: f64,
    pub(super) upper: f64,
}

/// Steps, or quarters of a step that are stated in seconds; no end is the end of the run.
#[derive(Debug, Clone, Copy)]
pub(super) enum SketchWindow {
    Steps(usize, Option<usize>),
    Quarters(usize, Option<usize>),
}

#[derive(Debug, Clone)]
pub(super) enum Sketch {
    Rows(Vec<SketchRow>),
    /// One row at the first samples, nothing later.
    Early(Vec<SketchRow>),
    Not(Box<Sketch>),
    All(Vec<Sketch>),
    Any(Vec<Sketch>),
    Always(SketchWindow, Box<Sketch>),
    Eventually(SketchWindow, Box<Sketch>),
    Until(SketchWindow, Box<Sketch>, Box<Sketch>),
    Release(SketchWindow, Box<Sketch>, Box<Sketch>),
}

fn rows(logical: bool) -> impl Strategy<Value = SketchRow> {
    let number = prop_oneof![
        4 => Just(Quantity::X),
        2 => Just(Quantity::Y),
        1 => Just(Quantity::Both),
        1 => Just(Quantity::Input),
        u32::from(logical) => (0_usize..3).prop_map(Quantity::Jump),
    ];
    // Thresholds that runs touch, and others between them.
    let end = || (-8_i32..=8).prop_map(|k| f64::from(k) / 2.0);
    let numeric = (number, end(), 0_u8..=6, 0_u8..4).prop_map(|(of, end, width, shape)| {
        let infinite = f64::INFINITY;
        let (lower, upper) = match shape {
            0 => (end, infinite),
            1 => (-infinite, end),
            _ => (end, end + f64::from(width) / 2.0),
        };
        SketchRow { of, lower, upper }
    });
    let mode = (0_usize..3, any::<bool>(), 0_u8..2).prop_map(|(mode, is_taken, value)| {
        let of = if is_taken { Quantity::Taken(mode) } else { Quantity::Mode(mode) };
        SketchRow { of, lower: f64::from(value), upper: f64::from(value) }
    });
    prop_oneof![4 => numeric, u32::from(logical) => mode]
}

fn windows() -> impl Strategy<Value = SketchWindow> {
    prop_oneof![
        4 => (0_usize..4, 0_usize..5).prop_map(|(a, b)| SketchWindow::Steps(a, Some(a + b))),
        1 => (0_usize..4).prop_map(|a| SketchWindow::Steps(a, None)),
        2 => (0_usize..12, 2_usize..16).prop_map(|(a, b)| SketchWindow::Quarters(a, Some(a + b))),
        1 => (0_usize..12).prop_map(|a| SketchWindow::Quarters(a, None)),
    ]
}

/// Missions of depth up to 4.
pub(super) fn sketches(logical: bool) -> impl Strategy<Value = Sketch> {
    let some = || proptest::collection::vec(rows(logical), 0..3);
    let leaf = prop_oneof![
        12 => rows(logical).prop_map(|row| Sketch::Rows(vec![row])),
        3 => some().prop_map(Sketch::Rows),
        1 => proptest::collection::vec(rows(logical), 0..9).prop_map(Sketch::Early),
    ];
    leaf.prop_recursive(4, 16, 3, |inner| {
        let one = || inner.clone().prop_map(Box::new);
        let several = || proptest::collection::vec(inner.clone(), 0..4);
        prop_oneof![
            2 => one().prop_map(Sketch::Not),
            2 => several().prop_map(Sketch::All),
            2 => several().prop_map(Sketch::Any),
            3 => (windows(), one()).prop_map(|(w, a)| Sketch::Always(w, a)),
            3 => (windows(), one()).prop_map(|(w, a)| Sketch::Eventually(w, a)),
            2 => (windows(), one(), one()).prop_map(|(w, a, b)| Sketch::Until(w, a, b)),
            2 => (windows(), one(), one()).prop_map(|(w, a, b)| Sketch::Release(w, a, b)),
        ]
    })
}

impl Quantity {
    fn value(self, sample: &Sample) -> Option<f64> {
        let truth = |is: bool| f64::from(u8::from(is));
        match self {
            Quantity::X => Some(sample.x),
            Quantity::Y => Some(sample.y),
            Quantity::Both => Some(sample.x + sample.y),
            Quantity::Input => sample.input,
            Quantity::Jump(k) => {
                sample.taken.map(|t| sample.x + 2.0 * truth(t == k % sample.modes))
            }
            Quantity::Taken(k) => sample.taken.map(|t| truth(t == k % sample.modes)),
            // Without memory there is no mode at the last sample.
            Quantity::Mode(k) => sample.mode.map(|m| truth(m == k % sample.modes)),
        }
    }

    fn is_logical(self) -> bool {
        matches!(self, Quantity::Taken(_) | Quantity::Mode(_))
    }

    pub(super) fn expression(self, of: &Handles) -> Affine {
        let [x, y] = [of.x, of.y.unwrap_or(of.x)].map(Affine::from);
        match self {
            Quantity::X => x,
            Quantity::Y => y,
            Quantity::Both => x + y,
            Quantity::Input => of.input.into(),
            Quantity::Jump(k) => x + 2.0 * Affine::from(of.taken[k % of.taken.len()]),
            Quantity::Taken(k) => of.taken[k % of.taken.len()].into(),
            Quantity::Mode(k) => of.modes[k % of.modes.len()].into(),
        }
    }
}

impl SketchRow {
    pub(super) fn row(&self, of: &Handles) -> Row {
        self.of.expression(of).within(self.lower, self.upper)
    }

    /// The slack; that of modes is infinite.
    fn slack(&self, sample: &Sample) -> Option<f64> {
        let value = self.of.value(sample)?;
        let slack = (value - self.lower).min(self.upper - value);
        let truth = if slack >= 0.0 { f64::INFINITY } else { f64::NEG_INFINITY };
        Some(if self.of.is_logical() { truth } else { slack })
    }
}

impl SketchWindow {
    pub(super) fn apply(self, time_step: f64, with: impl Fn(WindowText) -> Mission) -> Mission {
        let seconds = |quarters: usize| quarters as f64 / 4.0 * time_step;
        with(match self {
            SketchWindow::Steps(a, Some(b)) => WindowText::Steps(a..=b),
            SketchWindow::Steps(a, None) => WindowText::StepsFrom(a..),
            SketchWindow::Quarters(a, Some(b)) => WindowText::Seconds(seconds(a)..=seconds(b)),
            SketchWindow::Quarters(a, None) => WindowText::SecondsFrom(seconds(a)..),
        })
    }

    /// The samples of the window at a sample of a run, and whether there is more of it after the
    /// last one.
    pub(super) fn samples(
        self,
        k: usize,
        run: &[Sample],
        of: &[&Sketch],
    ) -> (std::ops::Range<usize>, bool) {
        let (first, last) = self.steps();
        let count = match last {
            Some(_) => run.len(),
            None => of.iter().map(|part| part.valued(run)).min().unwrap_or(run.len()),
        };
        let stop = last.map_or(count, |last| (k + last + 1).min(count));
        let is_cut = last.map_or(k + first >= count, |last| k + last >= count);
        (k + first..stop, is_cut)
    }

    /// The first and the last sample, counted from the operator; quarters are rounded inwards.
    fn steps(self) -> (usize, Option<usize>) {
        match self {
            SketchWindow::Steps(a, b) => (a, b),
            SketchWindow::Quarters(a, b) => (a.div_ceil(4), b.map(|b| b / 4)),
        }
    }
}

/// A window as it is given to the crate.
#[derive(Debug, Clone)]
pub(super) enum WindowText {
    Steps(std::ops::RangeInclusive<usize>),
    StepsFrom(std::ops::RangeFrom<usize>),
    Seconds(std::ops::RangeInclusive<f64>),
    SecondsFrom(std::ops::RangeFrom<f64>),
}

macro_rules! with_window {
    ($window:expr, $time_step:expr, |$w:ident| $mission:expr) => {
        $window.apply($time_step, |window| match window {
            WindowText::Steps($w) => $mission,
            WindowText::StepsFrom($w) => $mission,
            WindowText::Seconds($w) => $mission,
            WindowText::SecondsFrom($w) => $mission,
        })
    };
}

const NEVER: f64 = f64::NEG_INFINITY;

impl Sketch {
    pub(super) fn mission(&self, handles: &Handles, time_step: f64) -> Mission {
        let of = |inner: &Sketch| inner.mission(handles, time_step);
        let name = |rows: &[SketchRow]| {
            let text: String = format!("{rows:?}").chars().filter(|c| *c != '`').collect();
            text
        };
        match self {
            Sketch::Rows(rows) => Mission::holds(name(rows), rows.iter().map(|r| r.row(handles))),
            Sketch::Early(rows) => {
                let lists = rows.iter().map(|row| [row.row(handles)]);
                Mission::holds_by_sample(format!("early {}", name(rows)), lists)
            }
            Sketch::Not(a) => !of(a),
            Sketch::All(all) => Mission::all(all.iter().map(of)),
            Sketch::Any(all) => Mission::any(all.iter().map(of)),
            Sketch::Always(w, a) => with_window!(w, time_step, |w| of(a).always(w)),
            Sketch::Eventually(w, a) => with_window!(w, time_step, |w| of(a).eventually(w)),
            Sketch::Until(w, a, b) => with_window!(w, time_step, |w| of(a).until(w, of(b))),
            Sketch::Release(w, a, b) => with_window!(w, time_step, |w| of(a).release(w, of(b))),
        }
    }

    fn parts(&self) -> Vec<&Sketch> {
        match self {
            Sketch::Rows(_) | Sketch::Early(_) => Vec::new(),
            Sketch::Not(a) | Sketch::Always(_, a) | Sketch::Eventually(_, a) => vec![a],
            Sketch::All(of) | Sketch::Any(of) => of.iter().collect(),
            Sketch::Until(_, a, b) | Sketch::Release(_, a, b) => vec![a, b],
        }
    }

    /// Whether a window has no sample.
    pub(super) fn has_empty_window(&self) -> bool {
        let own = match self {
            Sketch::Always(w, _)
            | Sketch::Eventually(w, _)
            | Sketch::Until(w, ..)
            | Sketch::Release(w, ..) => w.steps().1.is_some_and(|last| last < w.steps().0),
            _ => false,
        };
        own || self.parts().into_iter().any(Sketch::has_empty_window)
    }

    /// How many samples at the beginning have values for all rows: an open window ends there.
    fn valued(&self, run: &[Sample]) -> usize {
        let has = |rows: &[SketchRow], sample: &Sample| {
            rows.iter().all(|row| row.slack(sample).is_some())
        };
        let count = |is: &dyn Fn(usize) -> bool| (0..run.len()).rev().find(|k| is(*k));
        match self {
            Sketch::Rows(rows) => count(&|k| has(rows, &run[k])).map_or(0, |k| k + 1),
            Sketch::Early(rows) => {
                let known = |k: usize| k < rows.len() && has(&rows[k..=k], &run[k]);
                count(&known).map_or(0, |k| k + 1)
            }
            _ => self.parts().iter().map(|part| part.valued(run)).min().unwrap_or(run.len()),
        }
    }

    /// By how much the mission, or its negation, is true at a sample; what is beyond the end is not
    /// true. If `strict`, 1 where it is true, where a negated row must fail by itself, and less
    /// where it is not.
    pub(super) fn value(&self, run: &[Sample], k: usize, positive: bool, strict: bool) -> f64 {
        let Some(here) = run.get(k) else { return NEVER };
        let pick = |all: bool, values: &mut dyn Iterator<Item = f64>| match all {
            true => values.fold(f64::INFINITY, f64::min),
            false => values.fold(NEVER, f64::max),
        };
        let at = |of: &Sketch, k: usize| of.value(run, k, positive, strict);
        let leaf = |rows: &[SketchRow]| {
            let Some(slacks) = rows.iter().map(|row| row.slack(here)).collect::<Option<Vec<f64>>>()
            else {
                return NEVER;
            };
            let least = pick(true, &mut slacks.into_iter());
            match (positive, strict) {
                (_, true) => f64::from(u8::from((least >= 0.0) == positive)) * 2.0 - 1.0,
                (true, false) => least,
                (false, false) => -least,
            }
        };
        let window = |w: SketchWindow, of: &[&Sketch]| w.samples(k, run, of);
        match self {
            Sketch::Rows(rows) => leaf(rows),
            Sketch::Early(rows) => rows.get(k).map_or(NEVER, |row| leaf(&[*row])),
            Sketch::Not(a) => a.value(run, k, !positive, strict),
            Sketch::All(of) => pick(positive, &mut of.iter().map(|part| at(part, k))),
            Sketch::Any(of) => pick(!positive, &mut of.iter().map(|part| at(part, k))),
            Sketch::Always(w, a) | Sketch::Eventually(w, a) => {
                let all = matches!(self, Sketch::Always(..)) == positive;
                let (samples, is_cut) = window(*w, &[a]);
                let value = pick(all, &mut samples.map(|t| at(a, t)));
                if all && is_cut { NEVER } else { value }
            }
            Sketch::Until(w, a, b) | Sketch::Release(w, a, b) => {
                let is_until = matches!(self, Sketch::Until(..)) == positive;
                let (samples, is_cut) = window(*w, &[a, b]);
                let before = |t: usize| pick(is_until, &mut (k..t).map(|s| at(a, s)));
                let mut terms: Vec<f64> = samples
                    .map(|t| pick(is_until, &mut [at(b, t), before(t)].into_iter()))
                    .collect();
                if is_cut {
                    terms.push(if is_until { NEVER } else { before(run.len()) });
                }
                pick(!is_until, &mut terms.into_iter())
            }
        }
    }
}
