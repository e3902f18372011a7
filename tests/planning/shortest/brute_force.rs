//! Every set of impacts of every horizon, each decided as a linear program in the accelerations.
//!
//! Once it is said which steps have an impact, the reflecting law is linear: every state is an
//! affine function of a(0), ..., a(τ-1), and a plan is a point that satisfies linear inequalities.
//! All sets of impacts are tried, whatever their number, since no small number of impacts is enough
//! in general: a vehicle that is pushed towards the wall may have to bounce in every second step.
//! The one shortcut is that a set whose first steps alone are impossible is dropped together with
//! all sets that begin like it: their rows are among the rows of every longer set.

use carom::collision_tolerant::{ContactLaw, Scenario};

use super::least_violation::{Row, least_violation, one_is_missed};

/// Violations up to this are rounding: numbers near 10 through about a hundred operations.
const ROUNDING: f64 = 1e-9;

/// Violations from this on cannot be mistaken for plans. The crate accepts rows that are missed by
/// 1e-6 and replays whose samples miss by 1e-6, so a row here, which joins a few of those, may be
/// missed by several 1e-6; ten leave room.
const VISIBLE: f64 = 1e-5;

/// What brute force says about one horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum HorizonVerdict {
    /// There is a plan; the smallest number of impacts of one.
    Feasible { impacts: usize },
    /// There is no plan, not even one that misses its conditions by [`VISIBLE`].
    Infeasible,
    /// The tolerance decides whether there is a plan, or with how many impacts.
    TooClose,
}

/// What brute force says about all horizons up to a largest one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ShortestHorizon {
    Found { steps: usize, impacts: usize },
    NoneWithin { max_steps: usize },
    TooClose,
}

/// The shortest horizon with a plan, and the fewest impacts on it.
pub(crate) fn shortest(scenario: &Scenario, max_steps: usize) -> ShortestHorizon {
    for (horizon, verdict) in Horizons::new(scenario).take(max_steps).enumerate() {
        match verdict {
            HorizonVerdict::Feasible { impacts } => {
                return ShortestHorizon::Found { steps: horizon + 1, impacts };
            }
            HorizonVerdict::TooClose => return ShortestHorizon::TooClose,
            HorizonVerdict::Infeasible => {}
        }
    }
    ShortestHorizon::NoneWithin { max_steps }
}

/// The verdicts on τ = 1, 2, 3, ...; endless.
pub(crate) struct Horizons<'a> {
    scenario: &'a Scenario,
    /// The number of steps decided last.
    steps: usize,
    /// The sets of impacts in these steps that can be begun, as bits; sorted by their size.
    open: Vec<u32>,
}

impl<'a> Horizons<'a> {
    pub(crate) fn new(scenario: &'a Scenario) -> Self {
        Horizons { scenario, steps: 0, open: vec![0] }
    }

    /// The sets over one step more that can be begun.
    fn extend(&mut self) {
        let step = self.steps;
        let hits: &[u32] = match self.scenario.law {
            ContactLaw::Forbidden => &[0],
            _ => &[0, 1],
        };
        let sets = self.open.iter().flat_map(|set| hits.iter().map(move |hit| set | (hit << step)));
        let possible = |&set: &u32| {
            let conditions = Conditions::new(self.scenario, step + 1, set);
            conditions.missed(&conditions.rows) != Size::Visible
        };
        self.open = sets.filter(possible).collect();
        self.open.sort_by_key(|set| set.count_ones());
        self.steps += 1;
    }
}

impl Iterator for Horizons<'_> {
    type Item = HorizonVerdict;

    fn next(&mut self) -> Option<HorizonVerdict> {
        self.extend();
        let mut doubt = None;
        // From few impacts to many.
        for &set in &self.open {
            let impacts = set.count_ones() as usize;
            let conditions = Conditions::new(self.scenario, self.steps, set);
            match conditions.missed(&conditions.with_goal()) {
                Size::Zero if doubt.is_none_or(|fewer| fewer == impacts) => {
                    return Some(HorizonVerdict::Feasible { impacts });
                }
                Size::Zero => return Some(HorizonVerdict::TooClose),
                Size::Small => doubt = doubt.or(Some(impacts)),
                Size::Visible => {}
            }
        }
        Some(if doubt.is_some() { HorizonVerdict::TooClose } else { HorizonVerdict::Infeasible })
    }
}

/// A violation, classified.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Size {
    Zero,
    Small,
    Visible,
}

/// A number that depends on the accelerations: `constant + terms · a`.
#[derive(Debug, Clone)]
struct Number {
    constant: f64,
    terms: Vec<f64>,
}

impl Number {
    fn constant(value: f64, steps: usize) -> Self {
        Number { constant: value, terms: vec![0.0; steps] }
    }

    /// `self + factor * other`.
    fn plus(mut self, factor: f64, other: &Number) -> Self {
        self.constant += factor * other.constant;
        self.terms.iter_mut().zip(&other.terms).for_each(|(a, b)| *a += factor * b);
        self
    }

    /// `self + factor * a(step)`.
    fn plus_acceleration(mut self, factor: f64, step: usize) -> Self {
        self.terms[step] += factor;
        self
    }

    /// `self * factor + offset`.
    fn scaled(mut self, factor: f64, offset: f64) -> Self {
        self.constant = self.constant * factor + offset;
        self.terms.iter_mut().for_each(|term| *term *= factor);
        self
    }

    /// The row `factor * self <= limit`.
    fn at_most(&self, factor: f64, limit: f64) -> Row {
        let terms = self.terms.iter().map(|term| factor * term).collect();
        Row { terms, limit: limit - factor * self.constant }
    }
}

/// What the accelerations must satisfy for a given set of impacts.
pub(crate) struct Conditions<'a> {
    scenario: &'a Scenario,
    /// All but the end conditions and the cumulative damage.
    rows: Vec<Row>,
    position: Number,
    velocity: Number,
    damage: Number,
    limits: Vec<(f64, f64)>,
}

impl<'a> Conditions<'a> {
    /// # Arguments
    ///
    /// * `impacts`: bit t says whether step t has one.
    pub(crate) fn new(scenario: &'a Scenario, steps: usize, impacts: u32) -> Self {
        let (wall, e) = (scenario.wall, scenario.restitution.value());
        // `normal * x >= normal * position` is the free side.
        let (normal, at) = (wall.normal(), wall.position());
        let dt = scenario.time_step;
        let mut rows = Vec::new();
        let mut x = Number::constant(scenario.start.position, steps);
        let mut v = Number::constant(scenario.start.velocity, steps);
        let mut damage = Number::constant(0.0, steps);
        for t in 0..steps {
            let p = x.plus(dt, &v).plus_acceleration(0.5 * dt * dt, t);
            let w = v.plus_acceleration(dt, t);
            if impacts >> t & 1 == 1 {
                rows.push(p.at_most(normal, normal * at));
                rows.push(w.at_most(normal, 0.0));
                if let Some(limit) = scenario.damage.per_hit {
                    rows.push(w.at_most(-normal, limit));
                }
                damage = damage.plus(-normal, &w);
                x = p.scaled(-e, (1.0 + e) * at);
                v = w.scaled(-e, 0.0);
            } else {
                rows.push(p.at_most(-normal, -normal * at));
                (x, v) = (p, w);
            }
            for sign in [-1.0, 1.0] {
                rows.push(v.at_most(sign, scenario.max_speed));
            }
            if let Some(domain) = scenario.domain {
                rows.push(x.at_most(-1.0, -domain.lower));
                rows.push(x.at_most(1.0, domain.upper));
            }
        }
        let mut limits = vec![(scenario.acceleration.lower, scenario.acceleration.upper); steps];
        if let Some(value) = scenario.start.acceleration {
            limits[0] = (value, value);
        }
        Conditions { scenario, rows, position: x, velocity: v, damage, limits }
    }

    /// The rows with the end conditions and the cumulative damage, which concern whole plans.
    fn with_goal(&self) -> Vec<Row> {
        let goal = self.scenario.goal;
        let mut rows = self.rows.clone();
        for (number, wanted) in [(&self.position, goal.position), (&self.velocity, goal.velocity)] {
            rows.extend([-1.0, 1.0].map(|sign| number.at_most(sign, sign * wanted)));
        }
        if let Some(limit) = self.scenario.damage.total {
            rows.push(self.damage.at_most(1.0, limit));
        }
        rows
    }

    /// By how much they must be missed.
    fn missed(&self, rows: &[Row]) -> Size {
        if one_is_missed(rows, &self.limits, VISIBLE) {
            return Size::Visible;
        }
        let violation = least_violation(rows, &self.limits);
        if violation.upper <= ROUNDING {
            Size::Zero
        } else if violation.lower >= VISIBLE {
            Size::Visible
        } else {
            Size::Small
        }
    }

    /// How much these accelerations miss of what a whole plan must satisfy.
    pub(crate) fn missed_by(&self, accelerations: &[f64]) -> f64 {
        let rows = self.with_goal();
        let beyond = rows.iter().map(|row| row.excess(accelerations));
        let outside = accelerations.iter().zip(&self.limits).map(|(a, (l, u))| (l - a).max(a - u));
        beyond.chain(outside).fold(0.0, f64::max)
    }
}
