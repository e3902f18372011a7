//! Spin: random hits keep what mechanics keeps, plans are what their laws do, and without friction
//! nothing changes.

use carom::ErrorKind;
use carom::hybrid::scene::{Body, Scene, SceneError, ScenePlan, Shape, Solid, Surface};
use carom::hybrid::{Region, Restitution, ShortestOptions};
use carom::interval::Interval;
use carom::prelude::*;

use super::seeded_numbers::Numbers;

/// A disc, in numbers.
#[derive(Clone, Copy)]
struct Disc {
    mass: f64,
    inertia: f64,
    radius: f64,
}

impl Disc {
    fn random(numbers: &mut Numbers) -> Disc {
        let (mass, radius) = (numbers.within(0.3, 3.0), numbers.within(0.05, 0.3));
        let inertia = numbers.within(0.1, 1.0) * mass * radius * radius;
        Disc { mass, inertia, radius }
    }

    fn body(&self, name: &str) -> Body {
        Body::new(name, [-9.0..=9.0, -9.0..=9.0], 1e3, 0.0)
            .with_mass(self.mass)
            .with_shape(Shape::Ball(self.radius))
            .with_spin(self.inertia, 1e4, 0.0)
    }

    fn energy(&self, [x, y, w]: [f64; 3]) -> f64 {
        0.5 * (self.mass * (x * x + y * y) + self.inertia * w * w)
    }
}

/// What happens along the surface.
#[derive(Debug, Clone, Copy)]
enum Along {
    Smooth,
    Friction(f64),
    Linear(f64, f64),
}

impl Along {
    /// Lawful for every restitution: a linear map keeps e² + b² + a² - a² e² below 1.
    fn random(numbers: &mut Numbers, e: f64) -> Along {
        match numbers.within(0.0, 3.0) as usize {
            0 => Along::Smooth,
            1 => Along::Friction(numbers.within(0.0, 1.5)),
            _ => {
                let keep = numbers.within(-1.0, 1.0);
                let most = ((1.0 - e * e) * (1.0 - keep * keep)).sqrt();
                Along::Linear(keep, numbers.within(-most, most))
            }
        }
    }

    fn surface(self, e: f64) -> Surface {
        let surface = Surface::bounce(Restitution::new(e).unwrap());
        match self {
            Along::Smooth => surface,
            Along::Friction(coefficient) => surface.with_friction(coefficient),
            Along::Linear(keep, from_normal) => surface.with_linear_map(keep, from_normal),
        }
    }

    /// The impulses along the normal and along the normal turned left, integrated in small parts of
    /// the normal impulse: in each part the touching points slide, and rub against each other, or
    /// stick.
    ///
    /// # Arguments
    ///
    /// * `f`, `u`: approach and sliding speed of the touching points; `ease`: by how much an
    ///   impulse along the normal and one along the surface change them, in 1/kg.
    fn impulses(self, e: f64, f: f64, u: f64, ease: [f64; 2]) -> [f64; 2] {
        let normal = (1.0 + e) * f / ease[0];
        let along = match self {
            Along::Smooth => 0.0,
            Along::Linear(keep, from_normal) => (keep * u + from_normal * f - u) / ease[1],
            Along::Friction(coefficient) => {
                let (parts, mut sum, mut sliding) = (20_000, 0.0, u);
                for _ in 0..parts {
                    let most = coefficient * normal / f64::from(parts);
                    let push = (-sliding / ease[1]).clamp(-most, most);
                    sum += push;
                    sliding += push * ease[1];
                }
                sum
            }
        };
        [normal, along]
    }
}

/// The states of a disc at the end of a run's only step: velocity, and spin.
fn after(end: &[f64], body: usize, bodies: usize) -> [f64; 3] {
    [end[4 * body + 2], end[4 * body + 3], end[4 * bodies + body]]
}

fn turned([x, y]: [f64; 2]) -> [f64; 2] {
    [-y, x]
}

fn dot(a: [f64; 2], b: &[f64]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Discs before a face, and behind it after the step: their approach, how their centres slide,
/// velocities and spins, and the state.
fn thrown(
    numbers: &mut Numbers,
    bodies: usize,
    reach: f64,
    [n, t]: [[f64; 2]; 2],
) -> (f64, f64, [[f64; 3]; 2], Vec<f64>) {
    let f = numbers.within(0.5, 3.0);
    let gap = numbers.within(0.0, 0.09) * f;
    let mut before = [[0.0; 3]; 2];
    for own in &mut before[..bodies] {
        *own = [(); 3].map(|()| numbers.within(-2.0, 2.0));
        own[2] *= 10.0;
    }
    // Two bodies stay in front of the same face.
    let most = if bodies == 2 { 9.0 * reach } else { 3.0 };
    let (other, slide) = (before[1], numbers.within(-most, most));
    before[0][0] = other[0] - f * n[0] + slide * t[0];
    before[0][1] = other[1] - f * n[1] + slide * t[1];
    let mut state = vec![n[0] * (gap + reach), n[1] * (gap + reach)];
    state.extend(&before[0][..2]);
    if bodies == 2 {
        state.extend([0.0, 0.0, other[0], other[1]]);
    }
    state.extend(before[..bodies].iter().map(|own| own[2]));
    (f, slide, before, state)
}

#[test]
fn ten_thousand_hits_keep_energy_and_both_momenta() {
    let mut numbers = Numbers(3);
    let (mut hits, mut least_lost, mut kinds) = (0, f64::INFINITY, [0; 3]);
    while hits < 10_000 {
        let discs = [Disc::random(&mut numbers), Disc::random(&mut numbers)];
        let bodies = 1 + usize::from(numbers.within(0.0, 1.0) < 0.4);
        let e = if hits % 5 == 0 { 1.0 } else { numbers.within(0.0, 1.0) };
        let along = Along::random(&mut numbers, e);
        let angle = numbers.within(0.0, 6.0);
        let n = [angle.cos(), angle.sin()];
        let t = turned(n);
        let mut scene = Scene::new(0.1);
        let first = scene.body(discs[0].body("first")).unwrap();
        let wall_speed = if bodies == 1 { numbers.within(-0.5, 0.5) } else { 0.0 };
        if bodies == 1 {
            let course = [[0.0; 2], [0.1 * wall_speed * t[0], 0.1 * wall_speed * t[1]]];
            let wall = Solid::halfspace("wall", n, 0.0, along.surface(e)).with_course(course);
            scene.obstacle(wall).unwrap();
        } else {
            let second = scene.body(discs[1].body("second")).unwrap();
            let around = [n, t, n.map(|n| -n), t.map(|t| -t)];
            scene.pair_along(first, second, along.surface(e), around).unwrap();
        }
        let system = scene.hybrid_system().unwrap();
        let reach: f64 = discs[..bodies].iter().map(|disc| disc.radius).sum();
        for _ in 0..40 {
            let (f, slide, before, state) = thrown(&mut numbers, bodies, reach, [n, t]);
            let run = system.simulate(&state, &[vec![0.0; 3 * bodies]]).unwrap();
            assert!(run.is_complete() && run.events() == 1, "{along:?}, {state:?}");
            let end = run.end().unwrap();
            // By small parts of the impulse.
            let turning = |disc: &Disc| disc.radius * disc.radius / disc.inertia;
            let ease = discs[..bodies].iter().fold([0.0, 0.0], |[normal, along], disc| {
                [normal + 1.0 / disc.mass, along + 1.0 / disc.mass + turning(disc)]
            });
            let spins = discs.iter().zip(&before).take(bodies);
            let u = slide - wall_speed - spins.map(|(d, own)| d.radius * own[2]).sum::<f64>();
            let [normal, tangential] = along.impulses(e, f, u, ease);
            let (mut lost, mut momentum) = (0.0, [0.0; 2]);
            for (b, disc) in discs.iter().enumerate().take(bodies) {
                let found = after(&end, b, bodies);
                let sign = [1.0, -1.0][b];
                let change = [found[0] - before[b][0], found[1] - before[b][1]];
                for i in 0..2 {
                    let impulse = sign * (normal * n[i] + tangential * t[i]);
                    assert!((disc.mass * change[i] - impulse).abs() < 1e-3, "{along:?}");
                    momentum[i] += disc.mass * change[i];
                }
                let turn = disc.inertia * (found[2] - before[b][2]);
                assert!((turn + disc.radius * tangential).abs() < 1e-3, "{along:?}");
                // Its centre is at r n, or at -r n, from the touching point.
                let about = turn + sign * disc.radius * disc.mass * dot(t, &change);
                assert!(about.abs() < 1e-9, "{along:?}: {about}");
                // In the frame of the wall.
                let seen = |own: [f64; 3]| {
                    [own[0] - wall_speed * t[0], own[1] - wall_speed * t[1], own[2]]
                };
                lost += disc.energy(seen(before[b])) - disc.energy(seen(found));
            }
            if bodies == 2 {
                assert!(momentum.iter().all(|sum| sum.abs() < 1e-9), "{momentum:?}");
            }
            if let (Along::Smooth, true) = (along, e < 1.0) {
                assert_eq!(after(&end, 0, bodies)[2], before[0][2]);
            }
            least_lost = lost.min(least_lost);
            hits += 1;
        }
        kinds[match along {
            Along::Smooth => 0,
            Along::Friction(_) => 1,
            Along::Linear(..) => 2,
        }] += 1;
    }
    assert!(least_lost > -1e-9, "a hit adds {} J", -least_lost);
    assert!(kinds.iter().all(|count| *count > 50), "{kinds:?}");
}

/// A room, and a disc that is thrown through it.
fn room(surface: Surface, with_spin: bool) -> Scene {
    let sides = [Interval::new(0.0, 2.0), Interval::new(0.0, 1.0)];
    let disc = Body::new("disc", sides, 5.0, 2.0).with_mass(2.0).with_shape(Shape::Ball(0.1));
    let disc = match with_spin {
        true => disc
            .with_spin(0.01, 60.0, 0.05)
            .with_start([0.5, 0.5, 1.5, -1.5, 7.0])
            .with_goal([1.0, 0.5, 0.0, 0.0]),
        false => disc.with_start([0.5, 0.5, 1.5, -1.5]).with_goal([1.0, 0.5, 0.0, 0.0]),
    };
    Scene::new(0.1).with_body(disc).with_room("wall", sides, surface)
}

fn bounce(e: f64) -> Surface {
    Surface::bounce(Restitution::new(e).unwrap())
}

fn shortest(scene: &Scene) -> ScenePlan {
    let found = scene.shortest(&mut BranchAndBound::default());
    found.unwrap().plan.unwrap()
}

#[test]
fn without_friction_everything_is_as_without_spin() {
    for e in [0.0, 0.3, 0.7, 1.0] {
        for surface in
            [bounce(e), bounce(e).with_friction(0.0), bounce(e).with_linear_map(1.0, 0.0)]
        {
            let (with, without) = (room(surface, true), room(surface, false));
            // What moves does so to the last digit, and the spin stays.
            let systems = [&with, &without].map(|scene| scene.hybrid_system().unwrap());
            let mut numbers = Numbers(5);
            for _ in 0..100 {
                let (x, y) = (numbers.within(0.1, 1.9), numbers.within(0.1, 0.9));
                let state = [x, y, numbers.within(-4.0, 4.0), numbers.within(-4.0, 4.0)];
                let push = [numbers.within(-2.0, 2.0), numbers.within(-2.0, 2.0)];
                let spinning = [&state[..], &[7.0]].concat();
                let turning =
                    systems[0].simulate(&spinning, &[[&push[..], &[0.0]].concat()]).unwrap();
                let sliding = systems[1].simulate(&state, &[push.to_vec()]).unwrap();
                assert_eq!(turning.is_complete(), sliding.is_complete());
                assert_eq!(turning.taken(), sliding.taken());
                if sliding.is_complete() {
                    assert_eq!(turning.end().unwrap()[..4], sliding.end().unwrap()[..]);
                    assert_eq!(turning.end().unwrap()[4], 7.0);
                }
            }
            let [turning, sliding] = [&with, &without].map(shortest);
            assert_eq!(turning.steps(), sliding.steps(), "e = {e}");
            assert!(turning.certificate.angular_momentum_error < 1e-7);
        }
    }
}

#[test]
fn a_superball_does_what_garwin_says() {
    // A solid ball of 2/5 m r², with everything elastic.
    let (radius, speed, spin) = (0.1, 1.0, 30.0);
    let ball = Body::new("ball", [-9.0..=9.0, 0.0..=9.0], 9.0, 0.0)
        .with_mass(0.2)
        .with_shape(Shape::Ball(radius))
        .with_spin(0.4 * 0.2 * radius * radius, 99.0, 0.0)
        .with_start([0.0, 0.3, speed, -3.0, spin]);
    let surface = bounce(1.0).with_linear_map(-1.0, 0.0);
    let scene = Scene::new(0.1).with_body(ball).with_obstacle(Solid::halfspace(
        "floor",
        [0.0, 1.0],
        0.0,
        surface,
    ));
    let plan = scene.program(2).unwrap().solve(&mut BranchAndBound::default()).unwrap();
    let (v, w) = (&plan.bodies[0].velocity[2], plan.bodies[0].spin[2]);
    // The floor is below, so that the touching point moves with v + r ω along x.
    assert!((v[0] - (3.0 * speed - 4.0 * radius * spin) / 7.0).abs() < 1e-6);
    assert!((radius * w + (10.0 * speed + 3.0 * radius * spin) / 7.0).abs() < 1e-6);
    assert!((v[1] - 3.0).abs() < 1e-6);
    let certificate = &plan.certificate;
    assert!(plan.hits[0].energy.abs() < 1e-6 && certificate.energy_gain < 1e-6);
    assert!(certificate.angular_momentum_error < 1e-7 && certificate.largest_residual < 1e-6);
}

#[test]
fn plans_with_friction_and_torque_are_replayed_and_broken_ones_refused() {
    for surface in [bounce(0.6).with_friction(0.3), bounce(0.6).with_linear_map(-0.4, 0.2)] {
        let scene = room(surface, true);
        let plan = shortest(&scene);
        let certificate = &plan.certificate;
        assert!(certificate.energy_gain < 1e-5 && certificate.cone_excess < 1e-5);
        assert!(certificate.angular_momentum_error < 1e-6 && certificate.drift < 1e-5);
        assert_eq!(scene.replay(&plan).unwrap(), plan);
        let refused = |change: &dyn Fn(&mut ScenePlan)| {
            let mut broken = plan.clone();
            change(&mut broken);
            scene.replay(&broken).unwrap_err().to_string()
        };
        let last = plan.steps() - 1;
        assert!(refused(&|plan| plan.bodies[0].spin[1] += 1e-3).contains("next sample differs"));
        assert!(refused(&|plan| plan.bodies[0].spin[0] += 1e-3).contains("misses its start"));
        assert!(refused(&|plan| plan.bodies[0].torque[last] += 0.2).contains("turns beyond"));
        assert!(refused(&|plan| plan.bodies[0].spin[last] = 61.0).contains("spins too fast"));
        assert!(refused(&|plan| plan.bodies[0].spin.clear()).contains("the spins of a body"));
    }
}

#[test]
fn torque_is_an_input_and_spin_stands_in_rows() {
    let mut scene = Scene::new(0.1);
    let disc = Body::new("disc", [0.0..=1.0, 0.0..=1.0], 1.0, 1.0).with_shape(Shape::Ball(0.1));
    let still = scene.body(disc.clone()).unwrap();
    let mut spinning = disc.with_spin(0.02, 10.0, 0.5).with_start([0.5, 0.5, 0.0, 0.0, 0.0]);
    spinning.name = "spinning".into();
    let spinning = scene.body(spinning).unwrap();
    let mut program = scene.program(4).unwrap();
    program.maximize(program.end(spinning.spin()).unwrap()).unwrap();
    let first = program.at(spinning.torque(), 0).unwrap();
    program.add("gently", first.le(0.1)).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    // 0.1 + 3 × 0.5 N m for 0.1 s each, over 0.02 kg m².
    let path = plan.body("spinning").unwrap();
    assert!((path.spin[4] - 8.0).abs() < 1e-6, "{:?}", path.spin);
    assert!(plan.bodies[0].spin.is_empty() && plan.bodies[0].torque.is_empty());
    assert!(program.at(still.spin(), 0).is_err() && program.at(still.torque(), 0).is_err());
    // Effort and fuel are of what pushes.
    program.add("turns", program.end(spinning.spin()).unwrap().ge(5.0)).unwrap();
    let cost = program.effort().unwrap() + program.fuel().unwrap();
    program.minimize(cost).unwrap();
    let cheapest = BranchAndBound::default().solve(program.model()).unwrap();
    assert!(cheapest.objective().unwrap().abs() < 1e-6);
}

#[test]
fn a_sliding_disc_ends_up_rolling() {
    // On a floor with rest, a solid disc keeps two thirds of its speed.
    let disc = Body::new("disc", [-1.0..=9.0, 0.0..=1.0], 5.0, 0.0)
        .with_gravity([0.0, -9.81])
        .with_shape(Shape::Ball(0.1))
        .with_spin(0.005, 99.0, 0.0)
        .with_start([0.0, 0.1, 1.5, 0.0, 0.0]);
    let floor = bounce(0.5).with_rest().with_friction(0.1);
    let scene = Scene::new(0.05).with_body(disc).with_obstacle(Solid::halfspace(
        "floor",
        [0.0, 1.0],
        0.0,
        floor,
    ));
    let plan = scene.program(20).unwrap().solve(&mut BranchAndBound::default()).unwrap();
    let path = &plan.bodies[0];
    assert!((path.velocity[20][0] - 1.0).abs() < 1e-6, "{:?}", path.velocity);
    assert!((path.spin[20] + 10.0).abs() < 1e-5, "{:?}", path.spin);
    // v = 1.5 - μ g t until then.
    assert!((path.velocity[5][0] - (1.5 - 0.981 * 0.25)).abs() < 1e-6);
}

fn refused(scene: &Scene) -> String {
    scene.hybrid_system().unwrap_err().to_string()
}

#[test]
fn spins_that_cannot_be_are_refused() {
    let disc = || Body::new("disc", [0.0..=2.0, 0.0..=1.0], 3.0, 3.0).with_shape(Shape::Ball(0.1));
    let scene = |body: Body| Scene::new(0.1).with_body(body);
    for (inertia, rate, torque, word) in [
        (-0.1, 9.0, 1.0, "inertia"),
        (0.0, 9.0, 1.0, "inertia"),
        (f64::NAN, 9.0, 1.0, "inertia"),
        (0.1, 0.0, 1.0, "largest spin"),
        (0.1, f64::INFINITY, 1.0, "largest spin"),
        (0.1, 9.0, -1.0, "largest torque"),
        (0.1, 9.0, f64::NAN, "largest torque"),
    ] {
        let text = refused(&scene(disc().with_spin(inertia, rate, torque)));
        assert!(text.contains(word) && text.contains("`disc`"), "{text}");
    }
    let spinning = |body: Body| scene(body.with_spin(0.1, 9.0, 1.0));
    let kind = |scene: &Scene| {
        let error = scene.hybrid_system().unwrap_err();
        match error.kind() {
            ErrorKind::Scene(own) => Some(own.clone()),
            _ => None,
        }
    };
    for (body, words) in [
        (disc().with_shape(Shape::Point), "give it the shape of a ball"),
        (disc().with_shape(Shape::Box(vec![0.1, 0.1])), "give it the shape of a ball"),
        (Body::new("disc", [0.0..=2.0], 3.0, 3.0).with_shape(Shape::Ball(0.1)), "in the plane"),
        (Body::new("disc", [0.0..=2.0, 0.0..=1.0, 0.0..=1.0], 3.0, 3.0), "in the plane"),
    ] {
        let scene = spinning(body);
        assert!(matches!(kind(&scene), Some(SceneError::Spin { body, .. }) if body == "disc"));
        assert!(refused(&scene).contains(words), "{}", refused(&scene));
    }
    // A start without its spin, and one that is too fast; a goal may leave it out.
    let found = kind(&spinning(disc().with_start([0.5, 0.5, 0.0, 0.0])));
    let expected = SceneError::Axes { name: "the start of disc".into(), found: 4, expected: 5 };
    assert_eq!(found, Some(expected));
    let found = kind(&spinning(disc().with_start([0.5, 0.5, 0.0, 0.0, 10.0])));
    assert!(matches!(found, Some(SceneError::Limits { what, .. }) if what == "spin"));
    let found = kind(&scene(disc().with_start([0.5, 0.5, 0.0, 0.0, 1.0])));
    assert!(matches!(found, Some(SceneError::Axes { found: 5, expected: 4, .. })));
    let goal = disc().with_goal(Region::point([0.5, 0.5, 0.0, 0.0]));
    assert!(spinning(goal).hybrid_system().is_ok());
    // Maps that add energy: a spin makes room for more along the surface, not for more than there
    // is.
    let with = |body: Body, keep: f64, from_normal: f64| {
        let surface = bounce(0.6).with_linear_map(keep, from_normal);
        scene(body).with_obstacle(Solid::halfspace("wall", [1.0, 0.0], -1.0, surface))
    };
    let solid = || disc().with_spin(0.005, 9.0, 1.0);
    for (body, keep, from_normal, is_lawful) in [
        (disc(), 0.0, 0.79, true),
        (disc(), 0.0, 0.81, false),
        (solid(), 0.0, 1.38, true),
        (solid(), 0.0, 1.39, false),
        (solid(), -1.0, 0.0, true),
        (solid(), -1.01, 0.0, false),
        (solid(), f64::NAN, 0.0, false),
    ] {
        let scene = with(body, keep, from_normal);
        assert_eq!(scene.hybrid_system().is_ok(), is_lawful, "{keep}, {from_normal}");
        if !is_lawful {
            assert!(
                matches!(kind(&scene), Some(SceneError::Surface { obstacle, .. }) if obstacle == "wall")
            );
        }
    }
}

#[test]
fn grids_that_get_coarser_without_plans_end() {
    // A room with friction, of which no coarser grid has a plan: its steps are too long for hits.
    let sides = [Interval::new(0.0, 2.0), Interval::new(0.0, 1.0)];
    let puck = Body::new("puck", sides, 5.0, 2.0)
        .with_shape(Shape::Ball(0.1))
        .with_start([0.5, 0.5, 1.5, -1.5])
        .with_goal([1.0, 0.5, 0.0, 0.0]);
    let walls = bounce(0.6).with_friction(0.3);
    let scene = Scene::new(0.1).with_body(puck).with_room("wall", sides, walls);
    let steps = |options: ShortestOptions| {
        scene.shortest_with(&options, &mut BranchAndBound::default()).unwrap().steps
    };
    let options = ShortestOptions::default();
    assert_eq!(steps(options.clone()), Some(9));
    assert_eq!(steps(options.with_coarse_guess(false)), Some(9));
}

/// Pushes change velocities alone, also of a body whose state has a spin.
#[test]
fn a_spinning_disc_may_be_pushed() {
    let disc = Disc { mass: 1.0, inertia: 0.005, radius: 0.1 };
    let body = disc.body("disc").with_pushes([-0.1..=0.1, 0.0..=0.0]);
    let scene = Scene::new(0.1).with_body(body.with_start([0.0, 0.0, 1.0, 0.0, 2.0]));
    let system = scene.hybrid_system().unwrap();
    assert!(system.check().is_ok());
    assert!(scene.program(2).unwrap().solve(&mut BranchAndBound::default()).is_ok());
}
