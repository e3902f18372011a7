//! The replay of a plan through its scene. It evaluates gaps, flights and laws of hits itself, and
//! reads no rows, transitions or sets.

mod entry;
mod events;
mod hits;
mod rules;
mod world;

use std::fmt;

use events::Span;
use world::{State, Touch, World};

use super::plan::{BodyPath, SceneHit};
use super::statement::Scene;
use crate::error::SceneError;
use crate::hybrid::damage::ImpactEstimate;
use crate::tolerance::{CONTACT_TIE, FEASIBILITY, REPLAY, allowed_drift, margin_scale};

/// By how much a plan may miss what the scene says: its rows hold to `FEASIBILITY`, and its samples
/// agree to `REPLAY`.
const MISS: f64 = FEASIBILITY + REPLAY;

/// The result of replaying a plan, if the plan is what the scene does.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SceneCertificate {
    /// Δt of the time-stepped law that the plan follows, in s.
    #[cfg_attr(feature = "serde", serde(default))]
    pub time_step: f64,
    /// Largest difference between a sample and where the step before leads, in m, m/s and rad/s.
    pub largest_residual: f64,
    /// Largest difference between a sample and where the inputs and hits lead from the first sample
    /// alone, in m, m/s and rad/s.
    pub drift: f64,
    /// Largest depth of a sample inside an obstacle or another body, in m.
    pub penetration: f64,
    /// Largest depth between samples of steps without a hit there, in m.
    pub dip: f64,
    /// Largest excess of an impact speed over the counted damage, where the impact is located
    /// within its step, in m/s. Up to the largest acceleration times Δt with
    /// [`ImpactEstimate::EndOfStep`].
    pub unreported: f64,
    /// Number of steps without a hit in which an impact is located.
    pub missed: usize,
    /// Largest change of the momentum of two bodies in their hits, in kg m/s.
    pub momentum_error: f64,
    /// Largest change of the angular momentum of a body with spin about the point at which it hits
    /// something, in kg m²/s.
    #[cfg_attr(feature = "serde", serde(default))]
    pub angular_momentum_error: f64,
    /// Largest kinetic energy, with that of spins, that the law of a hit adds to that of the
    /// flight's end, in J; of hits of a body in one step, all together. What counting a hit at the
    /// end of its step adds is in `stepped_gain`.
    pub energy_gain: f64,
    /// Largest energy by which a step with hits ends above the same step with its impacts where
    /// they are located, in J: what the time-stepped law adds, beside the work of torques. It
    /// shrinks with Δt.
    #[cfg_attr(feature = "serde", serde(default))]
    pub stepped_gain: f64,
    /// Largest excess of a friction impulse over its cone, in N s.
    pub cone_excess: f64,
    /// Largest distance between a sample and where its step leads if impacts happen when they are
    /// located, in m. It shrinks with Δt.
    pub step_error: f64,
    /// The same of velocities, in m/s. In the plan's own step, an impact within
    /// [`CONTACT_TIE`] of the surface counts in the step in which the plan has it.
    #[cfg_attr(feature = "serde", serde(default))]
    pub step_speed_error: f64,
    /// The distance from the first sample alone, in m. Later impacts amplify it.
    pub continuous_drift: f64,
}

impl fmt::Display for SceneCertificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time_step, largest_residual, step_error, stepped_gain, .. } = self;
        write!(
            f,
            "samples follow the time-stepped law with Δt = {time_step} s to {largest_residual:.1e}; \
             beside impacts where they are located, a step is off by up to {step_error:.3} m and \
             adds up to {stepped_gain:.3} J"
        )
    }
}

/// A plan in numbers.
struct Played<'a> {
    world: World<'a>,
    samples: Vec<State>,
    /// By step and body: accelerations, and last the torque of a body with spin.
    stated: Vec<Vec<Vec<f64>>>,
    /// The same with what functions of the motion make of it, along the axes of the world.
    inputs: Vec<Vec<Vec<f64>>>,
    hits: &'a mut Vec<SceneHit>,
    certificate: SceneCertificate,
}

impl<'a> Played<'a> {
    fn new(scene: &'a Scene, bodies: &[BodyPath], hits: &'a mut Vec<SceneHit>) -> Self {
        let samples = bodies.first().map_or(0, |body| body.position.len());
        let state = |t: usize| State {
            x: bodies.iter().map(|body| body.position[t].clone()).collect(),
            v: bodies.iter().map(|body| body.velocity[t].clone()).collect(),
            w: bodies.iter().map(|body| body.spin.get(t).copied().unwrap_or(0.0)).collect(),
            heading: bodies
                .iter()
                .map(|body| body.heading.get(t).copied().unwrap_or(0.0))
                .collect(),
        };
        let steps = samples.saturating_sub(1);
        let input = |t: usize| {
            let of = |body: &BodyPath| {
                let torque = body.torque.get(t);
                body.acceleration[t].iter().chain(torque).copied().collect()
            };
            bodies.iter().map(of).collect()
        };
        let samples: Vec<State> = (0..samples).map(state).collect();
        let stated: Vec<Vec<Vec<f64>>> = (0..steps).map(input).collect();
        let world = World { scene };
        let inputs = samples.iter().zip(&stated).map(|(from, input)| world.held(from, input));
        Played {
            inputs: inputs.collect(),
            world,
            samples,
            stated,
            hits,
            certificate: SceneCertificate { time_step: scene.time_step, ..Default::default() },
        }
    }
}

/// Replays a plan; completes its hits, and drops those that are rest. Its residual and its drift
/// are in these units of places, velocities, spins and headings, and all else is in those of the
/// scene.
pub(super) fn certify(
    scene: &Scene,
    bodies: &[BodyPath],
    hits: &mut Vec<SceneHit>,
    units: [f64; 4],
) -> Result<SceneCertificate, SceneError> {
    let most = |apart: [f64; 4]| {
        apart.iter().zip(units).map(|(apart, unit)| apart * unit).fold(0.0, f64::max)
    };
    let mut played = Played::new(scene, bodies, hits);
    let steps = played.inputs.len();
    let Some(first) = played.samples.first().cloned() else {
        return Ok(played.certificate);
    };
    let late = played.hits.iter().filter(|hit| hit.step >= steps).count() as f64;
    played.refuse(steps, "hits after the last step", late, 0.0)?;
    played.limits()?;
    played.drop_rests(steps);
    let (mut open, mut continuous) = (first.clone(), first);
    for step in 0..steps {
        played.one_hit(step)?;
        played.flights(step)?;
        let start = played.samples[step].clone();
        let next = played.lead(step, &start);
        let end = played.samples[step + 1].clone();
        let apart_by_kind = apart(&next, &end);
        let residual = apart_by_kind.into_iter().fold(0.0, f64::max);
        let values = next.x.iter().chain(&next.v).flatten().chain(&next.w).chain(&next.heading);
        let size = values.fold(0.0_f64, |a, b| a.max(b.abs()));
        let allowed = REPLAY * margin_scale(size, 0.0);
        played.refuse(step, "the next sample differs (m, m/s, rad/s)", residual, allowed)?;
        let certificate = &mut played.certificate;
        certificate.largest_residual = certificate.largest_residual.max(most(apart_by_kind));
        open = played.lead(step, &open);
        played.account(step)?;
        let inputs = played.inputs[step].clone();
        let located = played.located(step, &start);
        let gain = played.stepped_gain(step, &located);
        continuous = played.world.advance(&continuous, step, &inputs, &|_| 0.0).state;
        let certificate = &mut played.certificate;
        certificate.drift = certificate.drift.max(most(apart(&open, &end)));
        certificate.stepped_gain = certificate.stepped_gain.max(gain);
        certificate.step_error = certificate.step_error.max(largest(&located.x, &end.x));
        certificate.step_speed_error =
            certificate.step_speed_error.max(largest(&located.v, &end.v));
        let drift = largest(&continuous.x, &end.x);
        certificate.continuous_drift = certificate.continuous_drift.max(drift);
        played.near(step, &open, &end)?;
    }
    played.rules()?;
    Ok(played.certificate)
}

/// Where one step of the only body of a scene on a line leads if impacts happen where they are:
/// position (m) and velocity (m/s), impacts as time (s) and speed (m/s), and whether it came to
/// rest.
pub fn advance_line(
    scene: &Scene,
    [x, v]: [f64; 2],
    input: f64,
) -> ([f64; 2], Vec<(f64, f64)>, bool) {
    let start = State { x: vec![vec![x]], v: vec![vec![v]], w: vec![0.0], heading: vec![0.0] };
    let end = World { scene }.advance(&start, 0, &[vec![input]], &|_| 0.0);
    ([end.state.x[0][0], end.state.v[0][0]], end.impacts, end.rested)
}

/// Largest differences in place, velocity, spin and heading.
fn apart(a: &State, b: &State) -> [f64; 4] {
    let spins = largest(std::slice::from_ref(&a.w), std::slice::from_ref(&b.w));
    let headings = largest(std::slice::from_ref(&a.heading), std::slice::from_ref(&b.heading));
    [largest(&a.x, &b.x), largest(&a.v, &b.v), spins, headings]
}

/// Largest difference; NaN counts as infinite.
fn largest(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let each = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs());
    each.fold(0.0, |most, d| if d.is_nan() { f64::INFINITY } else { most.max(d) })
}

impl Played<'_> {
    /// Where a step of the plan leads if impacts happen where they are located. The plan decides
    /// whether an impact at a sample belongs to the step before it or to the one after it.
    fn located(&self, step: usize, start: &State) -> State {
        let (claimed, rests) = (self.claimed(step), self.rests(step));
        let shift = |touch: Touch| {
            if claimed.iter().any(|claim| claim.0 == touch) {
                return -CONTACT_TIE;
            }
            if rests.iter().any(|rest| rest.0 == touch) { 0.0 } else { CONTACT_TIE }
        };
        self.world.advance(start, step, &self.inputs[step], &shift).state
    }

    fn refuse(&self, step: usize, what: &str, by: f64, allowed: f64) -> Result<(), SceneError> {
        if by <= allowed {
            return Ok(());
        }
        Err(SceneError::Replay { step, what: what.to_owned(), by, allowed })
    }

    /// Refuses a sample that is farther from where the inputs and hits lead from the first one than
    /// drifts may be. Bodies with springs or drag are left out: their motion is integrated here,
    /// and the certificate of the run judges them.
    fn near(&self, step: usize, open: &State, end: &State) -> Result<(), SceneError> {
        let steps = self.inputs.len();
        let what = "the inputs lead elsewhere from the first sample alone (m, m/s, rad/s)";
        let bodies = self.world.scene.bodies.iter().enumerate();
        for (b, body) in bodies.filter(|(_, body)| body.dynamics.is_none()) {
            let places = body.domain.iter().map(|domain| domain.upper - domain.lower);
            let speeds = body.domain.iter().map(|_| 2.0 * body.max_speed);
            let runs = open.x[b].iter().chain(&open.v[b]).chain(&open.w[b..=b]);
            let samples = end.x[b].iter().chain(&end.v[b]).chain(&end.w[b..=b]);
            let widths = places.chain(speeds).chain([f64::INFINITY]);
            for ((run, sample), width) in runs.zip(samples).zip(widths) {
                let allowed = allowed_drift(width, *sample, steps);
                self.refuse(step, what, (run - sample).abs(), allowed)?;
            }
        }
        Ok(())
    }

    /// The faces that the plan hits in a step.
    fn claimed(&self, step: usize) -> Vec<(Touch, usize, usize)> {
        let own = self.hits.iter().enumerate().filter(|(_, hit)| hit.step == step);
        let touch = |hit: &SceneHit| {
            let names = self.world.touches().into_iter();
            names.into_iter().find(|&touch| self.world.name(touch) == hit.contact)
        };
        own.filter_map(|(k, hit)| Some((touch(hit)?, hit.face, k))).collect()
    }

    /// Each hit is at a surface to bounce off, and each body hits once in a step, unless corners
    /// are allowed.
    fn one_hit(&self, step: usize) -> Result<(), SceneError> {
        let world = &self.world;
        let claimed = self.claimed(step);
        let stated = self.hits.iter().filter(|hit| hit.step == step).count();
        let bounces = |&&(touch, face, _): &&(Touch, usize, usize)| {
            face < world.faces(touch) && world.surface(touch, face).restitution.is_some()
        };
        let known = claimed.iter().filter(bounces).count();
        let unknown = (stated - known) as f64;
        self.refuse(step, "hits at no surface to bounce off", unknown, 0.0)?;
        let faces = claimed.iter().enumerate();
        let twice = |(k, hit): (usize, &(Touch, usize, usize))| {
            claimed[..k].iter().any(|other| other.0 == hit.0)
        };
        let twice = faces.filter(|hit| twice(*hit)).count() as f64;
        self.refuse(step, "hits at two faces of one thing", twice, 0.0)?;
        if world.scene.corners {
            return Ok(());
        }
        for (b, body) in world.scene.bodies.iter().enumerate() {
            let of_body = |hit: &&(Touch, usize, usize)| {
                world.shares(hit.0).iter().any(|(body, _)| *body == b)
            };
            let more = claimed.iter().filter(of_body).count() as f64 - 1.0;
            self.refuse(step, &format!("{}: hits more than one thing", body.name), more, 0.0)?;
        }
        Ok(())
    }

    /// Steps without a hit stay outside, hits enter where there is a face.
    fn flights(&mut self, step: usize) -> Result<(), SceneError> {
        let world = &self.world;
        let is_sound = world.scene.estimate == ImpactEstimate::Sound;
        let (start, inputs) = (&self.samples[step], &self.inputs[step]);
        let flown = world.fly(start, inputs, world.scene.time_step);
        let claimed = self.claimed(step);
        let rests = self.rests(step);
        let mut worst = self.certificate.clone();
        for touch in world.touches() {
            let name = world.name(touch);
            if step == 0 {
                let inside = -world.clearance(touch, &start.x, step, 0.0).0;
                self.refuse(
                    step,
                    &format!("{name}: the first sample is inside (m)"),
                    inside,
                    MISS,
                )?;
                worst.penetration = worst.penetration.max(inside);
            }
            let inside = -world.clearance(touch, &self.samples[step + 1].x, step, 1.0).0;
            self.refuse(step, &format!("{name}: the next sample is inside (m)"), inside, MISS)?;
            worst.penetration = worst.penetration.max(inside);
            if let Some(&(_, face, _)) = claimed.iter().find(|(own, ..)| *own == touch) {
                self.entry(step, touch, face, &flown)?;
                continue;
            }
            let end = -world.clearance(touch, &flown.x, step, 1.0).0;
            if let Some(&(_, face)) = rests.iter().find(|(own, _)| *own == touch && end > MISS) {
                self.entry(step, touch, face, &flown)?;
                continue;
            }
            self.refuse(step, &format!("{name}: enters without a hit (m)"), end, MISS)?;
            let span = Span { step, inputs, from: 0.0 };
            let dip = world.dip(touch, start, span);
            worst.dip = worst.dip.max(dip);
            if is_sound {
                self.refuse(step, &format!("{name}: dips in without a hit (m)"), dip, MISS)?;
            }
            if dip > MISS && world.first_impact(touch, start, span, 0.0).is_some() {
                worst.missed += 1;
            }
        }
        self.certificate = worst;
        Ok(())
    }
}
