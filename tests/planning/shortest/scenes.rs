//! Scenes: scenarios as plain numbers seen from the wall, so that they can be moved, mirrored and
//! scaled, and random ones.

use carom::collision_tolerant::{Endpoint, Scenario, Wall};
use carom::hybrid::scene::DamageRule;
use carom::interval::Interval;
use proptest::prelude::*;
use proptest::sample::select;

/// One end: gap to the wall, rate away from it, acceleration away from it if pinned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    pub(crate) gap: f64,
    pub(crate) rate: f64,
    pub(crate) pull: Option<f64>,
}

/// At rest at a gap.
pub(crate) fn rest(gap: f64) -> End {
    moving(gap, 0.0)
}

/// Moving at a gap; away from the wall when positive.
pub(crate) fn moving(gap: f64, rate: f64) -> End {
    End { gap, rate, pull: None }
}

/// A scenario with the wall at 0 and the free side above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scene {
    pub(crate) start: End,
    pub(crate) goal: End,
    pub(crate) limits: (f64, f64),
    pub(crate) max_speed: f64,
    pub(crate) time_step: f64,
    pub(crate) restitution: f64,
    pub(crate) per_impact: Option<f64>,
    pub(crate) cumulative: Option<f64>,
    /// Smallest and largest gap.
    pub(crate) domain: Option<(f64, f64)>,
    pub(crate) collisions: bool,
}

impl Scene {
    /// A plastic wall, accelerations from -4 to 4, time steps of 0.25, speeds that never matter.
    pub(crate) fn new(start: End, goal: End) -> Self {
        Scene {
            start,
            goal,
            limits: (-4.0, 4.0),
            max_speed: 64.0,
            time_step: 0.25,
            restitution: 0.0,
            per_impact: None,
            cumulative: None,
            domain: None,
            collisions: true,
        }
    }

    /// With every length multiplied by a factor.
    pub(crate) fn in_lengths(self, factor: f64) -> Self {
        self.scaled(factor, 1.0)
    }

    /// With every time multiplied by a factor.
    pub(crate) fn in_times(self, factor: f64) -> Self {
        self.scaled(1.0, factor)
    }

    fn scaled(mut self, length: f64, time: f64) -> Self {
        let (speed, acceleration) = (length / time, length / (time * time));
        for end in [&mut self.start, &mut self.goal] {
            end.gap *= length;
            end.rate *= speed;
            end.pull = end.pull.map(|pull| acceleration * pull);
        }
        self.limits = (acceleration * self.limits.0, acceleration * self.limits.1);
        self.max_speed *= speed;
        self.time_step *= time;
        self.per_impact = self.per_impact.map(|limit| speed * limit);
        self.cumulative = self.cumulative.map(|limit| speed * limit);
        self.domain = self.domain.map(|(near, far)| (length * near, length * far));
        self
    }

    /// The scenario with the wall at a position.
    ///
    /// # Arguments
    ///
    /// * `side`: 1 when the free side is above, -1 when it is below.
    pub(crate) fn beside(&self, position: f64, side: f64) -> Scenario {
        let wall = if side > 0.0 { Wall::above(position) } else { Wall::below(position) };
        let end = |end: End| {
            let plain = Endpoint::at_rest(position + side * end.gap);
            let plain = plain.with_velocity(side * end.rate);
            end.pull.map_or(plain, |pull| plain.with_acceleration(side * pull))
        };
        let ordered = |a: f64, b: f64| Interval::new(a.min(b), a.max(b));
        let limits = ordered(side * self.limits.0, side * self.limits.1);
        let (start, goal) = (end(self.start), end(self.goal));
        let (wall, max_speed, dt) = (wall.expect("a finite wall"), self.max_speed, self.time_step);
        let mut scenario = Scenario::new(start, goal, wall, limits, max_speed, dt)
            .with_restitution(self.restitution)
            .expect("a restitution");
        let mut damage = DamageRule::default();
        damage.per_hit = self.per_impact;
        damage.total = self.cumulative;
        scenario.damage = damage;
        scenario.domain =
            self.domain.map(|(near, far)| ordered(position + side * near, position + side * far));
        if self.collisions { scenario } else { scenario.collision_free() }
    }

    /// The scenario with the wall at 0 and the free side above.
    pub(crate) fn plain(&self) -> Scenario {
        self.beside(0.0, 1.0)
    }
}

/// Where a wall stands and where it faces.
pub(crate) fn place() -> impl Strategy<Value = (f64, f64)> {
    (select(vec![0.0, 0.0, 1.0, -2.5, 7.3, -30.1]), select(vec![1.0, -1.0]))
}

/// Quarters from one number to another.
fn quarters(from: i32, to: i32) -> impl Strategy<Value = f64> {
    (4 * from..=4 * to).prop_map(|n| 0.25 * f64::from(n))
}

/// Limits of the acceleration: symmetric, lopsided, only towards or only away from the wall, and
/// one value only.
fn limits() -> impl Strategy<Value = (f64, f64)> {
    let whole = |from: i32, to: i32| (from..=to).prop_map(f64::from);
    prop_oneof![
        5 => whole(2, 6).prop_map(|a| (-a, a)),
        3 => (whole(1, 6), whole(1, 6)).prop_map(|(a, b)| (-a, b)),
        2 => (whole(1, 3), whole(1, 3)).prop_map(|(a, b)| (-a - b, -a)),
        1 => (whole(1, 3), whole(1, 3)).prop_map(|(a, b)| (a, a + b)),
        1 => select(vec![(0.0, 0.0), (-2.0, -2.0), (3.0, 3.0)]),
        1 => (whole(1, 4), any::<bool>()).prop_map(|(a, up)| if up { (0.0, a) } else { (-a, 0.0) }),
    ]
}

/// Where accelerations lead under the law; it ends early where the law has no answer.
pub(crate) struct RollOut {
    /// Gap and rate after each step.
    pub(crate) states: Vec<(f64, f64)>,
    /// Speed of each impact.
    pub(crate) impacts: Vec<f64>,
}

impl RollOut {
    pub(crate) fn new(scene: &Scene, pulls: impl IntoIterator<Item = f64>) -> Self {
        let (dt, e) = (scene.time_step, scene.restitution);
        let (mut gap, mut rate) = (scene.start.gap, scene.start.rate);
        let mut out = RollOut { states: Vec::new(), impacts: Vec::new() };
        for pull in pulls {
            let (p, w) = (gap + dt * rate + 0.5 * dt * dt * pull, rate + dt * pull);
            (gap, rate) = match (p < 0.0, w <= 0.0) {
                (false, _) => (p, w),
                (true, false) => break,
                (true, true) => {
                    out.impacts.push(-w);
                    (-e * p, -e * w)
                }
            };
            out.states.push((gap, rate));
        }
        out
    }
}

/// The draws behind a goal that is rolled out to.
#[derive(Debug, Clone)]
struct Roll {
    /// Each acceleration, as a share of the way from the lower to the upper limit.
    shares: Vec<f64>,
    /// Added to the gap where it ends.
    nudge: f64,
    /// Whether speed and damage are limited to what the roll-out needs.
    tight: bool,
}

fn roll() -> impl Strategy<Value = Roll> {
    let shares = prop::collection::vec(select(vec![0.0, 0.0, 0.0, 0.25, 0.5, 1.0, 1.0]), 2..10);
    let nudge = prop_oneof![
        5 => Just(0.0),
        2 => select(vec![1e-2, 1e-3, 1e-4, -1e-4, -1e-3, -1e-2]),
    ];
    (shares, nudge, prop::bool::weighted(0.25)).prop_map(|(shares, nudge, tight)| Roll {
        shares,
        nudge,
        tight,
    })
}

/// Random scenes whose shortest horizons are mostly between 2 and 10 steps.
///
/// Positions and speeds are drawn in units of what the largest acceleration does in a step, and
/// rounded to hundredths. Most goals lie where some accelerations lead, so that they can be reached
/// with whatever speed is left; some of these are then moved by a little, so that the last step
/// just suffices or just does not. The other goals are drawn freely, most of them at rest.
///
/// # Arguments
///
/// * `reach`: the largest gap at the start, in those units.
pub(crate) fn scene(reach: i32) -> impl Strategy<Value = Scene> {
    let physics = (
        limits(),
        select(vec![0.1, 0.2, 0.25, 0.4, 0.5]),
        prop_oneof![
            2 => Just(0.0),
            3 => Just(1.0),
            4 => select(vec![0.1, 0.25, 0.5, 0.75, 0.9]),
        ],
    );
    let start = (
        prop_oneof![1 => Just(0.0), 6 => quarters(0, reach)],
        prop_oneof![1 => Just(0.0), 5 => quarters(-5, 1)],
        prop_oneof![4 => Just(None), 2 => select(vec![0.0, 0.5, 1.0]).prop_map(Some)],
    );
    let goal = (
        prop_oneof![1 => Just(0.0), 6 => quarters(0, 4)],
        prop_oneof![3 => Just(0.0), 1 => quarters(-2, 3)],
        prop_oneof![1 => Just(None), 2 => roll().prop_map(Some)],
        any::<bool>(),
    );
    let limit = |from, to| prop_oneof![2 => Just(None), 1 => quarters(from, to).prop_map(Some)];
    let extras = (
        limit(1, 4),
        limit(1, 5),
        limit(0, 1),
        prop_oneof![
            4 => Just(None),
            1 => (select(vec![-1.0, 0.0, 0.5]), quarters(0, 2)).prop_map(Some)
        ],
        prop::bool::weighted(0.95),
    );
    (physics, start, goal, extras).prop_map(|(physics, start, goal, extras)| {
        let (limits, time_step, restitution) = physics;
        let speed = limits.0.abs().max(limits.1.abs()).max(1.0) * time_step;
        let hundredths = |value: f64| (100.0 * value).round() / 100.0;
        let end = |gap: f64, rate: f64| {
            moving(hundredths(gap * speed * time_step), hundredths(rate * speed))
        };
        let within = |share: f64| limits.0 + share * (limits.1 - limits.0);
        let mut scene = Scene::new(end(start.0, start.1), end(goal.0, goal.1));
        (scene.limits, scene.time_step, scene.restitution) = (limits, time_step, restitution);
        scene.start.pull = start.2.map(within);
        scene.goal.pull = goal.3.then(|| within(0.5));
        let (per_impact, cumulative, margin, domain, collisions) = extras;
        scene.per_impact = per_impact.map(|limit| limit * speed);
        scene.cumulative = cumulative.map(|limit| limit * speed);
        scene.collisions = collisions;
        let mut fastest = scene.start.rate.abs();
        if let Some(roll) = goal.2 {
            let pulls = scene.start.pull.into_iter().chain(roll.shares.into_iter().map(within));
            let out = RollOut::new(&scene, pulls);
            if let Some(&(gap, rate)) = out.states.last() {
                (scene.goal.gap, scene.goal.rate) = ((gap + roll.nudge).max(0.0), rate);
            }
            if roll.tight {
                fastest =
                    out.states.iter().fold(fastest, |so_far, state| so_far.max(state.1.abs()));
                scene.per_impact = out.impacts.iter().copied().reduce(f64::max);
                scene.cumulative = out.impacts.iter().copied().reduce(|a, b| a + b);
            }
        }
        fastest = fastest.max(scene.goal.rate.abs()).max(0.25 * speed);
        scene.max_speed = margin.map_or(64.0, |margin| fastest + margin * speed);
        let gaps = (scene.start.gap, scene.goal.gap);
        scene.domain = domain.map(|(place, margin): (f64, f64)| {
            (place * gaps.0.min(gaps.1), gaps.0.max(gaps.1) + margin * speed * time_step)
        });
        scene
    })
}
