//! Sets of states that follow differential equations: zonotopes, with outward rounding.
//!
//! A step of the system is cut into short ones. Each has a box that the motion cannot leave (by the
//! theorem of Picard and Lindelöf), a Taylor polynomial at the centre with its remainder over the
//! box, and a matrix of intervals for how differences from the centre change (R. J. Lohner,
//! "Enclosing the solutions of ordinary initial and boundary value problems", 1987). What is not
//! known about the motion are generators, which turn with it, so that boxes are not wrapped into
//! boxes.

use crate::elementary::IntervalSeries;
use crate::error::{Error, ErrorKind};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{HybridSystem, Transition};
use crate::interval::Interval;

/// Short steps in a step of the system.
const SHORT_STEPS: usize = 32;

/// The degrees of Taylor polynomials that are tried: rates with kinks have low ones only.
const DEGREES: [usize; 3] = [5, 2, 1];

/// By how much a box grows that the motion might leave (no unit), and how often.
const BOX_GROWTH: f64 = 0.1;
const MOST_BOX_GROWTHS: usize = 40;

/// The most generators; beyond, small ones become a box.
const MOST_GENERATORS: usize = 400;

type IntervalMatrix = Vec<Vec<Interval>>;

/// `centre + sum of a_g g` for all `a_g` from -1 to 1.
#[derive(Debug, Clone)]
pub(super) struct Zonotope {
    pub(super) centre: Vec<f64>,
    pub(super) generators: Vec<Vec<f64>>,
}

/// The error of a motion that has no enclosure.
pub(super) fn lost() -> Error {
    let name = "the enclosure of the motion; shorten the time step".to_owned();
    ErrorKind::NotFinite { name, what: "a bound", value: f64::INFINITY }.into()
}

impl Zonotope {
    /// One state.
    pub(super) fn point(state: &[f64]) -> Self {
        Zonotope { centre: state.to_vec(), generators: Vec::new() }
    }

    /// The largest value of `factors . x`, rounded outward.
    pub(super) fn largest(&self, factors: &[f64]) -> f64 {
        let dot = |x: &[f64]| {
            let terms = factors.iter().zip(x).map(|(a, x)| Interval::point(*a) * *x);
            terms.fold(Interval::point(0.0), |sum, own| sum + own)
        };
        let sizes = self.generators.iter().map(|own| Interval::point(dot(own).magnitude()));
        sizes.fold(dot(&self.centre), |sum, own| sum + own).upper
    }

    /// By how much each state may differ from the centre.
    pub(super) fn radius(&self) -> Vec<f64> {
        let of = |i: usize| {
            let sizes = self.generators.iter().map(|own| Interval::point(own[i].abs()));
            sizes.fold(Interval::point(0.0), |sum, own| sum + own).upper
        };
        (0..self.centre.len()).map(of).collect()
    }

    /// The box around it.
    pub(super) fn around(&self) -> Vec<Interval> {
        let sides = self.centre.iter().zip(self.radius());
        sides.map(|(x, r)| Interval::point(*x) + Interval::new(-r, r)).collect()
    }

    /// Moves on by a step of a flow. Entries after the states are the inputs, which are held;
    /// without them, inputs have the given values.
    pub(super) fn follow(
        &mut self,
        flow: &LinearSystem,
        system: &HybridSystem,
        input: &[f64],
    ) -> Result<(), Error> {
        if !system.functions.is_stated_by_rates(flow) {
            if system.functions.uses(flow) {
                let name = "a nonlinear flow by next values".to_owned();
                let place = "an enclosed motion".to_owned();
                let help = "state rates, because a map has no motion between samples";
                return Err(ErrorKind::Misplaced { name, place, help }.into());
            }
            self.follow_linear(flow, input);
            return Ok(());
        }
        let (n, by) = (flow.states(), Interval::point(system.time_step));
        let by = by / Interval::point(SHORT_STEPS as f64);
        let rates = |entries: &[IntervalSeries], count: usize| {
            let inputs: Vec<IntervalSeries> = match entries.len() > n {
                true => entries[n..].to_vec(),
                false => input
                    .iter()
                    .map(|u| IntervalSeries::constant(Interval::point(*u), count))
                    .collect(),
            };
            let mut rates = system.functions.rate_series(flow, &entries[..n], &inputs, count)?;
            // Inputs are held.
            let held = IntervalSeries::constant(Interval::point(0.0), count);
            rates.resize(entries.len(), held);
            Some(rates)
        };
        let short = ShortStep { rates: &rates, by };
        for _ in 0..SHORT_STEPS {
            let step = DEGREES.iter().find_map(|degree| short.take(self, *degree));
            let (next, matrix) = step.ok_or_else(lost)?;
            self.move_to(&next, &matrix);
        }
        Ok(())
    }

    /// The step of a linear flow.
    fn follow_linear(&mut self, flow: &LinearSystem, input: &[f64]) {
        let (n, all) = (flow.states(), self.centre.len());
        let entry = |i: usize, j: usize| {
            Interval::point(match (i < n, j < n) {
                (true, true) => flow.a()[(i, j)],
                (true, false) => flow.b()[(i, j - n)],
                (false, _) => f64::from(u8::from(i == j)),
            })
        };
        let row = |i: usize| {
            let own = (0..all).map(|j| entry(i, j) * self.centre[j]);
            let start = Interval::point(if i < n { flow.c()[i] } else { 0.0 });
            let sum = own.fold(start, |sum, own| sum + own);
            let used = (0..input.len()).filter(|&u| all == n && flow.b()[(i, u)] != 0.0);
            used.map(|u| Interval::point(flow.b()[(i, u)]) * input[u])
                .fold(sum, |sum, own| sum + own)
        };
        let next: Vec<Interval> = (0..all).map(row).collect();
        let matrix = (0..all).map(|i| (0..all).map(|j| entry(i, j)).collect()).collect();
        self.move_to(&next, &matrix);
    }

    /// The resets after a step.
    pub(super) fn reset(&mut self, taken: &[&Transition], step: usize) {
        // After a flow, inputs are left out.
        let n = self.centre.len();
        for reset in taken.iter().filter_map(|own| own.reset.as_ref()) {
            let offset = reset.offset.get(step);
            let row = |i: usize| {
                let offset = offset.and_then(|own| own.get(i)).copied().unwrap_or(0.0);
                let terms = (0..n).map(|j| Interval::point(reset.matrix[(i, j)]) * self.centre[j]);
                terms.fold(Interval::point(offset), |sum, own| sum + own)
            };
            let next: Vec<Interval> = (0..n).map(row).collect();
            let entry = |i: usize, j: usize| Interval::point(reset.matrix[(i, j)]);
            let matrix = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
            self.move_to(&next, &matrix);
        }
    }

    /// Where the centre leads, and how differences from it change.
    fn move_to(&mut self, next: &[Interval], matrix: &IntervalMatrix) {
        let n = self.centre.len();
        let middle = |own: &Interval| 0.5 * own.lower + 0.5 * own.upper;
        let around = self.radius();
        let mut rest: Vec<Interval> = Vec::with_capacity(n);
        for (i, own) in next.iter().enumerate() {
            let centre = middle(own);
            let mut sum = Interval::point((*own + Interval::point(-centre)).magnitude());
            for j in 0..n {
                let entry = matrix[i][j];
                let off = (entry + Interval::point(-middle(&entry))).magnitude();
                sum = sum + Interval::point(off) * around[j];
            }
            rest.push(sum);
            self.centre[i] = centre;
        }
        for own in &mut self.generators {
            let old = own.clone();
            for (i, entry) in own.iter_mut().enumerate() {
                let terms = (0..n).map(|j| Interval::point(middle(&matrix[i][j])) * old[j]);
                let exact = terms.fold(Interval::point(0.0), |sum, own| sum + own);
                *entry = middle(&exact);
                let rounding = (exact + Interval::point(-*entry)).magnitude();
                rest[i] = rest[i] + Interval::point(rounding);
            }
        }
        if self.generators.len() + n > MOST_GENERATORS {
            // The older half becomes a box.
            for own in self.generators.drain(..MOST_GENERATORS / 2) {
                for (sum, entry) in rest.iter_mut().zip(&own) {
                    *sum = *sum + Interval::point(entry.abs());
                }
            }
        }
        for (i, sum) in rest.iter().enumerate() {
            let mut own = vec![0.0; n];
            own[i] = sum.upper;
            self.generators.push(own);
        }
    }
}

/// Rates as series of states, with so many coefficients.
type SeriesRates<'a> = dyn Fn(&[IntervalSeries], usize) -> Option<Vec<IntervalSeries>> + 'a;

/// A short step of the differential equations.
struct ShortStep<'a> {
    /// `None` where they have none.
    rates: &'a SeriesRates<'a>,
    /// In s.
    by: Interval,
}

impl ShortStep<'_> {
    /// Where the centre leads, and how differences from it change; `None` without an enclosure.
    fn take(&self, from: &Zonotope, degree: usize) -> Option<(Vec<Interval>, IntervalMatrix)> {
        let around = from.around();
        let kept = self.kept(&around)?;
        let centre: Vec<Interval> = from.centre.iter().map(|x| Interval::point(*x)).collect();
        let (polynomial, remainder) =
            (self.coefficients(&centre, degree)?, self.coefficients(&kept, degree + 1)?);
        let next = (0..centre.len()).map(|i| {
            let mut sum = remainder[i].coefficients()[degree];
            for k in (0..degree).rev() {
                sum = sum * self.by + polynomial[i].coefficients()[k];
            }
            sum
        });
        let next: Vec<Interval> = next.collect();
        let matrix = self.transition(&kept)?;
        let all = next.iter().chain(matrix.iter().flatten());
        all.into_iter().all(Interval::is_bounded).then_some((next, matrix))
    }

    /// A box that the motion from a box does not leave within the step.
    fn kept(&self, around: &[Interval]) -> Option<Vec<Interval>> {
        let within = Interval::new(0.0, self.by.upper);
        let mut kept = around.to_vec();
        for _ in 0..MOST_BOX_GROWTHS {
            let rates = self.values(&kept)?;
            let moved = around.iter().zip(&rates).map(|(x, f)| *x + within * *f);
            let moved: Vec<Interval> = moved.collect();
            let holds = |(own, moved): (&Interval, &Interval)| {
                own.lower <= moved.lower && moved.upper <= own.upper
            };
            if kept.iter().zip(&moved).all(holds) {
                // The motion from the box is in the image, too.
                return moved.iter().all(Interval::is_bounded).then_some(moved);
            }
            kept = moved
                .iter()
                .map(|own| {
                    let more = BOX_GROWTH * own.width() + f64::EPSILON * own.magnitude();
                    *own + Interval::new(-more, more)
                })
                .collect();
        }
        None
    }

    /// The rates over a box.
    fn values(&self, over: &[Interval]) -> Option<Vec<Interval>> {
        let states: Vec<IntervalSeries> =
            over.iter().map(|x| IntervalSeries::constant(*x, 1)).collect();
        let rates = (self.rates)(&states, 1)?;
        Some(rates.iter().map(|own| own.coefficients()[0]).collect())
    }

    /// The Taylor coefficients in time of the motions from a box.
    fn coefficients(&self, over: &[Interval], count: usize) -> Option<Vec<IntervalSeries>> {
        let mut all: Vec<Vec<Interval>> = over.iter().map(|x| vec![*x]).collect();
        for k in 1..count {
            let states: Vec<IntervalSeries> =
                all.iter().map(|own| IntervalSeries::new(own.clone())).collect();
            let rates = (self.rates)(&states, k)?;
            for (own, rate) in all.iter_mut().zip(&rates) {
                own.push(rate.coefficients()[k - 1] / Interval::point(k as f64));
            }
        }
        Some(all.into_iter().map(IntervalSeries::new).collect())
    }

    /// The derivatives of where motions lead by where they begin, for all in a box that holds them:
    /// `I + h J + h²/2 J J M`, where M holds these derivatives within the step.
    fn transition(&self, kept: &[Interval]) -> Option<IntervalMatrix> {
        let n = kept.len();
        let jacobian = self.jacobian(kept)?;
        let unit = |i: usize, j: usize| Interval::point(if i == j { 1.0 } else { 0.0 });
        let within = Interval::new(0.0, self.by.upper);
        let identity: IntervalMatrix =
            (0..n).map(|i| (0..n).map(|j| unit(i, j)).collect()).collect();
        let mut middle = identity.clone();
        let mut is_kept = false;
        for _ in 0..MOST_BOX_GROWTHS {
            let moved = product(&jacobian, &middle);
            let moved = added(&identity, &scaled(&moved, within));
            let pairs = middle.iter().flatten().zip(moved.iter().flatten());
            if pairs.into_iter().all(|(a, b)| a.lower <= b.lower && b.upper <= a.upper) {
                is_kept = true;
                break;
            }
            let grown = |own: &Interval| {
                let more = BOX_GROWTH * own.width() + f64::EPSILON;
                *own + Interval::new(-more, more)
            };
            middle = moved.iter().map(|row| row.iter().map(grown).collect()).collect();
        }
        if !is_kept {
            return None;
        }
        let half = self.by * self.by * 0.5;
        let second = scaled(&product(&jacobian, &product(&jacobian, &middle)), half);
        Some(added(&added(&identity, &scaled(&jacobian, self.by)), &second))
    }

    /// The derivatives of the rates by the states over a box.
    fn jacobian(&self, over: &[Interval]) -> Option<IntervalMatrix> {
        let n = over.len();
        let mut jacobian = vec![vec![Interval::point(0.0); n]; n];
        for j in 0..n {
            let series = |(i, x): (usize, &Interval)| {
                let slope = if i == j { 1.0 } else { 0.0 };
                IntervalSeries::new(vec![*x, Interval::point(slope)])
            };
            let states: Vec<IntervalSeries> = over.iter().enumerate().map(series).collect();
            let rates = (self.rates)(&states, 2)?;
            for (row, rate) in jacobian.iter_mut().zip(&rates) {
                row[j] = rate.coefficients()[1];
            }
        }
        Some(jacobian)
    }
}

fn product(a: &IntervalMatrix, b: &IntervalMatrix) -> IntervalMatrix {
    let n = a.len();
    let entry = |i: usize, j: usize| {
        let terms = (0..n).map(|k| a[i][k] * b[k][j]);
        terms.fold(Interval::point(0.0), |sum, own| sum + own)
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

fn added(a: &IntervalMatrix, b: &IntervalMatrix) -> IntervalMatrix {
    let rows = a.iter().zip(b);
    rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| *a + *b).collect()).collect()
}

fn scaled(a: &IntervalMatrix, by: Interval) -> IntervalMatrix {
    a.iter().map(|row| row.iter().map(|own| *own * by).collect()).collect()
}
