//! Steps that start in or near an acute corner: a hit is at the face through which they enter.

use carom::hybrid::scene::{Body, Scene, ScenePlan, Solid, Surface};
use carom::hybrid::{ImpactEstimate, Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;

use super::seeded_numbers::Numbers;

const TIME_STEP: f64 = 0.1;
const RESTITUTION: f64 = 0.5;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A wedge with its edge in the origin, open to the right: its upper face is 0, its lower one 1.
fn wedge(angle: f64, turn: f64, axes: usize) -> Vec<Vec<f64>> {
    let (up, down) = (turn + 0.5 * angle, turn - 0.5 * angle);
    let normals = [[-up.sin(), up.cos()], [down.sin(), -down.cos()]];
    normals.map(|[x, y]| [x, y, 0.0][..axes].to_vec()).to_vec()
}

struct Case {
    faces: Vec<Vec<f64>>,
    start: Vec<f64>,
    speed: Vec<f64>,
    push: Vec<f64>,
    estimate: ImpactEstimate,
}

impl Case {
    fn scene(&self) -> Scene {
        let axes = self.start.len();
        let still: Vec<Interval> = self.push.iter().map(|&u| Interval::point(u)).collect();
        let body = Body::new("b", vec![Interval::new(-3.0, 3.0); axes], 8.0, 0.0)
            .with_acceleration(still)
            .with_start(Region::point([self.start.clone(), self.speed.clone()].concat()));
        let surface = Surface::bounce(Restitution::new(RESTITUTION).unwrap());
        let faces = self.faces.iter().map(|n| (n.clone(), 0.0));
        Scene::new(TIME_STEP)
            .with_body(body)
            .with_obstacle(Solid::polytope("wedge", faces, surface))
            .with_estimate(self.estimate)
    }

    fn flown(&self, time: f64) -> Vec<f64> {
        let fly = |i: usize| self.start[i] + time * (self.speed[i] + 0.5 * time * self.push[i]);
        (0..self.start.len()).map(fly).collect()
    }

    /// A straight line if only the ends of steps count.
    fn place(&self, part: f64) -> Vec<f64> {
        if self.estimate == ImpactEstimate::Sound {
            return self.flown(part * TIME_STEP);
        }
        let end = self.flown(TIME_STEP);
        self.start.iter().zip(end).map(|(a, b)| a + part * (b - a)).collect()
    }

    /// How far the step is in front of the other face while it is behind this one, before it is
    /// inside for the first time.
    fn passes_by(&self, face: usize) -> f64 {
        let mut most = 0.0_f64;
        for k in 0..=4000 {
            let place = self.place(f64::from(k) / 4000.0);
            let (own, other) = (dot(&self.faces[face], &place), dot(&self.faces[1 - face], &place));
            if own < -1e-9 && other < -1e-9 {
                break;
            }
            if own < -1e-3 {
                most = most.max(other);
            }
        }
        most
    }

    /// A plan that claims a hit at a face, by the law of a frictionless hit.
    fn claim(&self, plan: &ScenePlan, face: usize) -> ScenePlan {
        let mut plan = plan.clone();
        let n = &self.faces[face];
        let (flown, lift) = (self.flown(TIME_STEP), 1.0 + RESTITUTION);
        let w: Vec<f64> =
            self.speed.iter().zip(&self.push).map(|(v, u)| v + TIME_STEP * u).collect();
        let (gap, rate) = (dot(n, &flown), dot(n, &w));
        let body = &mut plan.bodies[0];
        body.acceleration = vec![self.push.clone()];
        let along = |a: &[f64], by: f64| a.iter().zip(n).map(|(a, n)| a - lift * by * n).collect();
        body.position = vec![self.start.clone(), along(&flown, gap)];
        body.velocity = vec![self.speed.clone(), along(&w, rate)];
        plan.hits.truncate(1);
        plan.hits[0].face = face;
        plan
    }
}

/// Any plan with one step and one hit at the wedge.
fn template(faces: &[Vec<f64>], axes: usize) -> ScenePlan {
    let n = &faces[0];
    let into: Vec<f64> = n.iter().map(|n| -3.0 * n).collect();
    let along = [n[1], -n[0], 0.0];
    let case = Case {
        faces: faces.to_vec(),
        start: n.iter().zip(along).map(|(n, t)| 0.1 * n + 1.5 * t).collect(),
        speed: into,
        push: vec![0.0; axes],
        estimate: ImpactEstimate::Sound,
    };
    let program = case.scene().plain_program(1).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    let plan = program.plan(&solution).unwrap();
    assert_eq!(plan.hits.len(), 1);
    plan
}

#[test]
fn a_step_out_of_an_acute_corner_hits_nothing_that_it_does_not_enter() {
    // Out of the tip below the lower face, and back into the wedge through it.
    let case = Case {
        faces: wedge(0.4, 0.0, 2),
        start: vec![0.0, 0.0],
        speed: vec![4.0, -1.2],
        push: vec![0.0, 8.0],
        estimate: ImpactEstimate::Sound,
    };
    let plan = template(&case.faces, 2);
    let upper = case.scene().replay(&case.claim(&plan, 0)).unwrap_err();
    assert!(upper.to_string().contains("leaves in front of another face"), "{upper}");
    // Below the wedge all the time.
    let case = Case { push: vec![0.0, 0.0], ..case };
    let mut program = case.scene().plain_program(1).unwrap();
    let hits = program.hits();
    program.maximize(hits).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    assert_eq!(solution.objective().map(f64::round), Some(0.0));
    assert!(program.plan(&solution).unwrap().hits.is_empty());
    let upper = case.scene().replay(&case.claim(&plan, 0));
    assert!(upper.is_err());
}

#[test]
fn hits_near_acute_corners_are_at_the_face_that_is_entered() {
    let mut numbers = Numbers(5);
    let (mut planned, mut refused, mut at_tip) = (0, 0, 0);
    for round in 0..240 {
        let axes = if round % 3 == 0 { 3 } else { 2 };
        let faces = wedge(numbers.within(0.2, 1.4), numbers.within(-0.3, 0.3), axes);
        let plan = template(&faces, axes);
        let mut all =
            |low: f64, high: f64| (0..axes).map(|_| numbers.within(low, high)).collect::<Vec<_>>();
        let (mut start, speed, push) = (all(-0.3, 0.3), all(-3.0, 3.0), all(-20.0, 20.0));
        if round % 2 == 0 {
            start[..2].fill(0.0);
        } else if faces.iter().all(|n| dot(n, &start) < 0.0) {
            continue;
        }
        let estimate = match round % 5 < 2 {
            true => ImpactEstimate::EndOfStep,
            false => ImpactEstimate::Sound,
        };
        let case = Case { faces, start, speed, push, estimate };
        let scene = case.scene();
        let mut program = scene.plain_program(1).unwrap();
        let hits = program.hits();
        program.maximize(hits).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        if solution.point().is_some() {
            let plan = program.plan(&solution).unwrap();
            planned += plan.hits.len();
            for hit in &plan.hits {
                assert!(case.passes_by(hit.face) <= 1e-3, "round {round}");
            }
        }
        for face in 0..2 {
            let passes_by = case.passes_by(face);
            let replayed = scene.replay(&case.claim(&plan, face));
            if passes_by > 1e-3 {
                assert!(replayed.is_err(), "round {round}, face {face}: {passes_by}");
                refused += 1;
            }
            at_tip += usize::from(round % 2 == 0 && replayed.is_ok());
        }
    }
    assert!(planned > 20 && refused > 20 && at_tip > 10, "{planned}, {refused}, {at_tip}");
}
