//! Contact pairs: a body and an obstacle, or two bodies, that can touch, face by face in one frame.

use super::body::Body;
use super::geometry::{self, Across, Side, dot};
use super::solid::Solid;
use super::statement::{Pair, Scene};
use super::surface::Surface;
use crate::error::SceneError;

/// A face of a contact: the body is in front where `normal . x >= limit`, with the position x of
/// the body, or of the first body relative to the second.
#[derive(Debug, Clone)]
pub(super) struct ContactFace {
    pub(super) normal: Vec<f64>,
    /// By sample; one entry if it stands still.
    pub(super) limit: Vec<f64>,
    pub(super) surface: Surface,
    /// Where the face ends: `normal . x <= limit`, by sample.
    pub(super) extent: Vec<(Vec<f64>, Vec<f64>)>,
    /// The faces that it meets at an acute angle: solid where `normal . x <= limit`, by sample.
    pub(super) sharp: Vec<(Vec<f64>, Vec<f64>)>,
    /// The largest rate of change of the acceleration along the normal, in m/s³.
    pub(super) jerk: f64,
}

/// A way in which a step may pass a contact.
#[derive(Debug, Clone)]
pub(super) struct Mode {
    /// The name of its transition.
    pub(super) name: String,
    pub(super) face: usize,
    pub(super) is_hit: bool,
}

/// The spin of a body in one of its contacts.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactSpin {
    /// The number of its state.
    pub(super) state: usize,
    /// From the centre to the surface, in m.
    pub(super) lever: f64,
    /// In kg m².
    pub(super) inertia: f64,
}

/// A body and an obstacle, or two bodies.
#[derive(Debug, Clone)]
pub(super) struct ContactPair {
    /// The name of its choice.
    pub(super) name: String,
    /// The number of the body.
    pub(super) body: usize,
    /// The number of the other body.
    pub(super) other: Option<usize>,
    /// The number of the obstacle.
    pub(super) obstacle: Option<usize>,
    pub(super) faces: Vec<ContactFace>,
    /// The velocity of the surface by step, in m/s; empty if it stands still.
    pub(super) velocity: Vec<Vec<f64>>,
    /// The share of the velocity's change that the body takes; the other body takes the rest.
    pub(super) share: f64,
    /// The mass that matters in a hit, in kg.
    pub(super) mass: f64,
    /// The spins that impulses along the surface change.
    pub(super) spins: Vec<ContactSpin>,
    /// In the order of the transitions; filled by the statement of the system.
    pub(super) modes: Vec<Mode>,
}

impl ContactFace {
    /// The limit at a sample.
    pub(super) fn limit_at(&self, sample: usize) -> f64 {
        at(&self.limit, sample)
    }
}

/// The value at a sample, of a list whose last entry goes on.
pub(super) fn at(list: &[f64], sample: usize) -> f64 {
    list.get(sample).or(list.last()).copied().unwrap_or(0.0)
}

impl ContactPair {
    /// Whether bodies may bounce off one of its faces.
    pub(super) fn bounces(&self) -> bool {
        self.faces.iter().any(|face| face.surface.restitution.is_some())
    }

    /// By how many times more an impulse along the surface moves the touching points than the
    /// centres: `1 + m Σ r²/I`.
    pub(super) fn mobility(&self) -> f64 {
        let turning = self.spins.iter().map(|spin| spin.lever * spin.lever / spin.inertia);
        1.0 + self.mass * turning.sum::<f64>()
    }

    /// The bodies with the share of the velocity's change that each takes, with its sign.
    pub(super) fn shares(&self) -> impl Iterator<Item = (usize, f64)> {
        [(Some(self.body), self.share), (self.other, self.share - 1.0)]
            .into_iter()
            .filter_map(|(body, share)| Some((body?, share)))
    }

    /// The velocity of the surface in a step, in m/s.
    pub(super) fn velocity_in(&self, step: usize, axes: usize) -> Vec<f64> {
        let last = self.velocity.last();
        self.velocity.get(step).or(last).cloned().unwrap_or_else(|| vec![0.0; axes])
    }
}

impl Scene {
    /// Refuses surfaces that add energy in one of their contacts.
    pub(super) fn check_energy(&self) -> Result<(), SceneError> {
        for contact in contacts(self) {
            let name = contact.obstacle.map_or(&contact.name, |o| &self.obstacles[o].name);
            let mut surfaces = contact.faces.iter().map(|face| face.surface);
            surfaces.try_for_each(|surface| surface.check_energy(name, contact.mobility()))?;
        }
        Ok(())
    }
}

/// All contacts of a checked scene: bounces before what is avoided, single faces before several.
pub(super) fn contacts(scene: &Scene) -> Vec<ContactPair> {
    let mut all = Vec::new();
    for (o, obstacle) in scene.obstacles.iter().enumerate() {
        for (b, body) in scene.bodies.iter().enumerate() {
            all.push(with_obstacle(scene, (b, body), (o, obstacle)));
        }
    }
    all.extend(scene.pairs.iter().map(|pair| between(scene, pair)));
    all.sort_by_key(|contact| (!contact.bounces(), contact.faces.len()));
    all
}

fn with_obstacle(
    scene: &Scene,
    (b, body): (usize, &Body),
    (o, obstacle): (usize, &Solid),
) -> ContactPair {
    let axes = body.axes();
    let samples = obstacle.course.len().max(1);
    let places: Vec<Vec<f64>> = (0..samples).map(|t| obstacle.displacement(t, axes)).collect();
    let sides: Vec<Side> = obstacle
        .faces
        .iter()
        .map(|face| (face.normal.clone(), face.offset + body.shape.reach(&face.normal)))
        .collect();
    let surfaces: Vec<Surface> = obstacle.faces.iter().map(|face| face.surface).collect();
    let velocity = places
        .windows(2)
        .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| (b - a) / scene.time_step).collect());
    ContactPair {
        name: format!("{} at {}", body.name, obstacle.name),
        body: b,
        other: None,
        obstacle: Some(o),
        faces: faces(&sides, &surfaces, &places, &|n| body.largest_jerk(n, scene.time_step)),
        velocity: velocity.collect(),
        share: 1.0,
        mass: body.mass,
        spins: scene.contact_spins(&[b]),
        modes: Vec::new(),
    }
}

fn between(scene: &Scene, pair: &Pair) -> ContactPair {
    let [first, second] = [pair.first, pair.second].map(|b| &scene.bodies[b]);
    let sides: Vec<Side> = pair
        .normals
        .iter()
        .map(|n| (n.clone(), first.shape.reach(n) + second.shape.reach(n)))
        .collect();
    let surfaces = vec![pair.surface; sides.len()];
    let jerk = |n: &[f64]| [first, second].map(|b| b.largest_jerk(n, scene.time_step)).iter().sum();
    let total = first.mass + second.mass;
    ContactPair {
        name: format!("{} and {}", first.name, second.name),
        body: pair.first,
        other: Some(pair.second),
        obstacle: None,
        faces: faces(&sides, &surfaces, &[vec![0.0; first.axes()]], &jerk),
        velocity: Vec::new(),
        share: second.mass / total,
        mass: first.mass * second.mass / total,
        spins: scene.contact_spins(&[pair.first, pair.second]),
        modes: Vec::new(),
    }
}

fn faces(
    sides: &[Side],
    surfaces: &[Surface],
    places: &[Vec<f64>],
    jerk: &dyn Fn(&[f64]) -> f64,
) -> Vec<ContactFace> {
    // The limits of all sides at every sample.
    let limits: Vec<Vec<f64>> =
        places.iter().map(|place| sides.iter().map(|(n, b)| b + dot(n, place)).collect()).collect();
    let sharp = geometry::sharp(sides);
    let face = |(k, (normal, _)): (usize, &Side)| {
        let by_sample = |other: usize| limits.iter().map(|limits| limits[other]).collect();
        let extent = |side: Across| {
            let by_sample = limits.iter().map(|limits| side.limit(k, limits)).collect();
            (side.normal, by_sample)
        };
        ContactFace {
            normal: normal.clone(),
            limit: by_sample(k),
            surface: surfaces[k],
            extent: geometry::across(sides, k).into_iter().map(extent).collect(),
            sharp: sharp[k].iter().map(|&k| (sides[k].0.clone(), by_sample(k))).collect(),
            jerk: jerk(normal),
        }
    };
    sides.iter().enumerate().map(face).collect()
}
