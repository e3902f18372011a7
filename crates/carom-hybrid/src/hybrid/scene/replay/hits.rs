//! The hits of a step: which of the changes that their laws allow the plan makes, and what they do.

use super::events::Span;
use super::world::{State, Touch};
use super::{MISS, Played};
use crate::error::SceneError;
use crate::hybrid::damage::ImpactEstimate;
use crate::hybrid::scene::geometry::{dot, length};
use crate::hybrid::scene::surface::Tangential;

/// The most combinations of directions of friction that are compared.
const MOST_COMBINATIONS: usize = 1 << 16;

/// The things that touch, the face, and the number of the hit; `None` if the body rests there.
pub(super) type Claim = (Touch, usize, Option<usize>);

/// The effect of a contact: by how many gaps it moves the body, and the change of the relative
/// velocity.
#[derive(Clone)]
struct Effect {
    lift: f64,
    change: Vec<f64>,
}

impl Played<'_> {
    /// Where a step leads from a state, with the plan's inputs and hits.
    pub(super) fn lead(&self, step: usize, start: &State) -> State {
        let world = &self.world;
        let flown = world.fly(start, &self.inputs[step], world.scene.time_step);
        let touching = self.touching(step);
        let effects = self.effects(step, start, &flown, &touching);
        let mut next = flown.clone();
        for (&(touch, face, _), effect) in touching.iter().zip(&effects) {
            let n = world.normal(touch, face);
            let gap = world.gap(touch, face, &flown.x, step, 1.0);
            for (body, share) in world.shares(touch) {
                let x = next.x[body].iter_mut().zip(n);
                x.for_each(|(x, n)| *x -= share * effect.lift * gap * n);
            }
            world.strike(touch, face, &effect.change, &mut next);
        }
        next
    }

    /// The hits that a plan claims in a step, and where bodies rest in it.
    fn touching(&self, step: usize) -> Vec<Claim> {
        let claimed = self.claimed(step);
        let rests = self.rests(step);
        let rests = rests.into_iter().filter(|(touch, _)| claimed.iter().all(|c| c.0 != *touch));
        let rests = rests.map(|(touch, face)| (touch, face, None));
        claimed.iter().map(|&(touch, face, k)| (touch, face, Some(k))).chain(rests).collect()
    }

    /// The faces at which bodies start a step at rest, and behind which its flight would end.
    pub(super) fn rests(&self, step: usize) -> Vec<(Touch, usize)> {
        let world = &self.world;
        let start = &self.samples[step];
        let flown = world.fly(start, &self.inputs[step], world.scene.time_step);
        let faces = world.touches().into_iter();
        let faces = faces.flat_map(|touch| (0..world.faces(touch)).map(move |face| (touch, face)));
        faces
            .filter(|&(touch, face)| {
                let n = world.normal(touch, face);
                let rate = |state: &State| dot(n, &world.relative(touch, &state.v, step));
                let gap = |state: &State, part| world.gap(touch, face, &state.x, step, part);
                world.surface(touch, face).rests
                    && gap(start, 0.0).abs() <= 10.0 * MISS
                    && rate(start).abs() <= 10.0 * MISS
                    && gap(&flown, 1.0) <= MISS
                    && rate(&flown) <= MISS
            })
            .collect()
    }

    /// Drops hits of bodies that start the step at rest at the face: they lie there, and may settle
    /// once more without a change.
    pub(super) fn drop_rests(&mut self, steps: usize) {
        let rests: Vec<(usize, String, usize)> = (0..steps)
            .flat_map(|step| self.rests(step).into_iter().map(move |rest| (step, rest)))
            .map(|(step, (touch, face))| (step, self.world.name(touch), face))
            .collect();
        self.hits.retain(|hit| {
            rests.iter().all(|(step, name, face)| {
                (*step, name, *face) != (hit.step, &hit.contact, hit.face)
            })
        });
    }

    /// The effect of each contact of a step: where laws allow several changes, those that together
    /// come nearest to the plan, because the effects of the contacts of a body add up.
    fn effects(&self, step: usize, start: &State, flown: &State, claimed: &[Claim]) -> Vec<Effect> {
        let world = &self.world;
        let allowed = |&(touch, face, number): &Claim| {
            let lift = world.lift(touch, face);
            let changes = world.changes(touch, face, step, [start, flown], MISS).into_iter();
            let mut all: Vec<Effect> = changes.map(|change| Effect { lift, change }).collect();
            // It may fly on, over an edge for example.
            let grazes = number.is_none() && world.clearance(touch, &flown.x, step, 1.0).0 >= -MISS;
            if all.is_empty() || grazes {
                all.push(Effect { lift: 0.0, change: vec![0.0; world.scene.axes()] });
            }
            all
        };
        let allowed: Vec<Vec<Effect>> = claimed.iter().map(allowed).collect();
        let mut picks = vec![0; claimed.len()];
        for group in self.groups(claimed) {
            let counts = group.iter().map(|&k| allowed[k].len());
            let combinations = counts.fold(1, usize::saturating_mul);
            if combinations == 1 {
                continue;
            }
            let miss = |picks: &[usize]| {
                let chosen = group.iter().map(|&k| (claimed[k], &allowed[k][picks[k]]));
                self.miss(step, flown, chosen)
            };
            let mut best = (miss(&picks), picks.clone());
            if combinations <= MOST_COMBINATIONS {
                for number in 1..combinations {
                    let mut rest = number;
                    for &k in &group {
                        picks[k] = rest % allowed[k].len();
                        rest /= allowed[k].len();
                    }
                    let own = miss(&picks);
                    if own < best.0 {
                        best = (own, picks.clone());
                    }
                }
            } else {
                // One hit at a time, until none comes nearer.
                loop {
                    let before = best.0;
                    for &k in &group {
                        for pick in 0..allowed[k].len() {
                            picks.clone_from(&best.1);
                            picks[k] = pick;
                            let own = miss(&picks);
                            if own < best.0 {
                                best = (own, picks.clone());
                            }
                        }
                    }
                    if best.0 >= before {
                        break;
                    }
                }
            }
            picks = best.1;
        }
        allowed.into_iter().zip(picks).map(|(mut all, pick)| all.swap_remove(pick)).collect()
    }

    /// Hits that share a body with each other, by their places among those claimed.
    fn groups(&self, claimed: &[Claim]) -> Vec<Vec<usize>> {
        let bodies = |k: usize| self.world.shares(claimed[k].0).into_iter().map(|(body, _)| body);
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for k in 0..claimed.len() {
            let own: Vec<usize> = bodies(k).collect();
            let meets = |group: &Vec<usize>| {
                group.iter().any(|&other| bodies(other).any(|body| own.contains(&body)))
            };
            let (mut joined, apart): (Vec<_>, Vec<_>) = groups.into_iter().partition(meets);
            joined.push(vec![k]);
            groups = apart;
            groups.push(joined.concat());
        }
        groups
    }

    /// How far the velocities and spins that a choice of changes gives the bodies of some contacts
    /// are from those of the plan, in m/s and rad/s.
    fn miss<'a>(
        &self,
        step: usize,
        flown: &State,
        chosen: impl Iterator<Item = (Claim, &'a Effect)>,
    ) -> f64 {
        let planned = &self.samples[step + 1];
        let (mut next, mut bodies) = (flown.clone(), Vec::new());
        for ((touch, face, _), effect) in chosen {
            self.world.strike(touch, face, &effect.change, &mut next);
            bodies.extend(self.world.shares(touch).into_iter().map(|(body, _)| body));
        }
        let apart = bodies.into_iter().flat_map(|b| {
            let velocities = next.v[b].iter().zip(&planned.v[b]);
            velocities
                .chain([(&next.w[b], &planned.w[b])])
                .map(|(own, planned)| (own - planned).abs())
        });
        apart.fold(0.0, f64::max)
    }

    /// Completes the hits of a step: speeds, impulse, energy, the located impact.
    pub(super) fn account(&mut self, step: usize) -> Result<(), SceneError> {
        let world = &self.world;
        let dt = world.scene.time_step;
        let touching = self.touching(step);
        let start = &self.samples[step];
        let inputs = &self.inputs[step];
        let flown = world.fly(start, inputs, dt);
        let mut worst = self.certificate.clone();
        let made = self.effects(step, start, &flown, &touching);
        let mut pushes: Vec<(Touch, Vec<f64>)> = Vec::new();
        for (&(touch, face, number), effect) in touching.iter().zip(&made) {
            let Some(number) = number else {
                pushes.push((touch, vec![0.0; effect.change.len()]));
                continue;
            };
            let n = world.normal(touch, face);
            let [first, r] = [start, &flown].map(|s| world.relative(touch, &s.v, step));
            let (at_start, at_end) = (-dot(n, &first), -dot(n, &r));
            let shares = world.shares(touch);
            let jerk: f64 =
                shares.iter().map(|(b, _)| world.scene.bodies[*b].largest_jerk(n, dt)).sum();
            let counted = match world.scene.estimate {
                ImpactEstimate::Sound => at_start.max(at_end) + jerk * dt * dt / 8.0,
                ImpactEstimate::EndOfStep => at_end,
            };
            let span = Span { step, inputs, from: 0.0 };
            let impact = world.first_impact(touch, start, span, 0.0);
            let hit = &mut self.hits[number];
            (hit.start_speed, hit.end_speed, hit.damage) = (at_start, at_end, counted.max(0.0));
            (hit.time, hit.speed) = (step as f64 * dt + dt, at_end.max(0.0));
            if let Some(impact) = impact {
                (hit.time, hit.speed) = (step as f64 * dt + impact.time, impact.speed);
                if impact.face == face {
                    worst.unreported = worst.unreported.max(impact.speed - counted);
                }
            }
            let at = world.fly(start, inputs, (hit.time - step as f64 * dt).clamp(0.0, dt));
            hit.place = at.x[shares[0].0].clone();
            let planned = &self.samples[step + 1];
            let single = touching.len() == 1;
            let (body, share) = shares[0];
            // What the plan does, if it can be told apart from other hits.
            let change: Vec<f64> = match single {
                true => {
                    (0..n.len()).map(|i| (planned.v[body][i] - flown.v[body][i]) / share).collect()
                }
                false => effect.change.clone(),
            };
            let mass = world.mass(touch);
            hit.impulse = change.iter().map(|c| mass * c).collect();
            hit.energy = world.lost((touch, face), step, &flown, &change);
            pushes.push((touch, hit.impulse.clone()));
            let normal = dot(&hit.impulse, n);
            let along: Vec<f64> = hit.impulse.iter().zip(n).map(|(j, n)| j - normal * n).collect();
            if let Tangential::Coulomb { coefficient, .. } = world.surface(touch, face).tangential {
                let excess = length(&along) - coefficient * normal;
                worst.cone_excess = worst.cone_excess.max(excess);
            }
            if single {
                let error = world.turned_about((touch, face), [&flown, planned]);
                worst.angular_momentum_error = worst.angular_momentum_error.max(error);
            }
            if let (true, [(a, _), (b, _)]) = (single, &shares[..]) {
                let [a, b] = [*a, *b];
                let of = |b: usize, i: usize| {
                    world.scene.bodies[b].mass * (planned.v[b][i] - flown.v[b][i])
                };
                let sums = (0..n.len()).map(|i| (of(a, i) + of(b, i)).abs());
                worst.momentum_error = sums.fold(worst.momentum_error, f64::max);
            }
        }
        let before = self.kept(&flown, &touching, &made);
        for group in self.groups(&touching) {
            let own = group.iter().filter_map(|&k| pushes.get(k));
            worst.energy_gain = worst.energy_gain.max(self.energy_added(step, &before, own));
        }
        let excess = worst.unreported;
        self.certificate = worst;
        if self.world.scene.estimate == ImpactEstimate::Sound {
            self.refuse(step, "an impact is faster than its damage (m/s)", excess, MISS)?;
        }
        Ok(())
    }

    /// The end of free flight with what rest does to it, which hits change.
    fn kept(&self, flown: &State, touching: &[Claim], made: &[Effect]) -> State {
        let mut kept = flown.clone();
        for (&(touch, face, _), effect) in touching.iter().zip(made).filter(|(c, _)| c.2.is_none())
        {
            self.world.strike(touch, face, &effect.change, &mut kept);
        }
        kept
    }

    /// The kinetic energy that hits of the same bodies add, beside the work of moving surfaces, in
    /// J.
    fn energy_added<'a>(
        &self,
        step: usize,
        flown: &State,
        pushes: impl Iterator<Item = &'a (Touch, Vec<f64>)>,
    ) -> f64 {
        let world = &self.world;
        let planned = &self.samples[step + 1];
        let mut bodies: Vec<usize> = Vec::new();
        let mut work = 0.0;
        for (touch, impulse) in pushes {
            bodies.extend(world.shares(*touch).into_iter().map(|(body, _)| body));
            if let Touch::Obstacle(body, _) = *touch {
                let v = &flown.v[body];
                let r = world.relative(*touch, &flown.v, step);
                let surface: Vec<f64> = v.iter().zip(&r).map(|(v, r)| v - r).collect();
                work += dot(impulse, &surface);
            }
        }
        bodies.sort_unstable();
        bodies.dedup();
        let energy = |state: &State, b: usize| state.energy(&world.scene.bodies[b], b);
        bodies.iter().map(|&b| energy(planned, b) - energy(flown, b)).sum::<f64>() - work
    }

    /// By how much the energy of the bodies that hit something in a step, with the potential of
    /// their inputs and of gravity, is above that of the step with located impacts, in J.
    pub(super) fn stepped_gain(&self, step: usize, located: &State) -> f64 {
        let world = &self.world;
        let claimed = self.claimed(step);
        let mut bodies: Vec<usize> =
            claimed.iter().flat_map(|c| world.shares(c.0)).map(|(body, _)| body).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let energy = |state: &State, b: usize| {
            let body = &world.scene.bodies[b];
            let pushes = self.inputs[step][b].iter().zip(&body.gravity).map(|(u, g)| u + g);
            let potential: f64 = pushes.zip(&state.x[b]).map(|(a, x)| -a * x).sum();
            state.energy(body, b) + body.mass * potential
        };
        let planned = &self.samples[step + 1];
        bodies.iter().map(|&b| energy(planned, b) - energy(located, b)).sum()
    }
}
