//! The reflecting wall: the general rows beside the hand-written ones.

use carom::collision_tolerant::Wall;
use carom::hybrid::reach::{ReachSets, SetOptions};
use carom::hybrid::scene::DamageRule;
use carom::hybrid::{HybridSystem, ImpactEstimate, LinearSystem, Restitution};
use carom::interval::Interval;
use carom::prelude::*;
use carom::reformulate;
use carom_hybrid::internals::{HasParts, SystemVariables, Transition};

const TIME_STEP: f64 = 0.1;
const POSITIONS: Interval = Interval { lower: 0.0, upper: 20.0 };
const SPEEDS: Interval = Interval { lower: -5.0, upper: 5.0 };
const FORCES: Interval = Interval { lower: -10.0, upper: 10.0 };

/// The law of a wall on a line, by other names: the transitions of the system of a scene.
pub(crate) fn transitions<const N: usize>(
    wall: Wall,
    surface: Surface,
    time_step: f64,
    rule: Option<DamageRule>,
    names: [&str; N],
) -> [Transition; N] {
    let n = wall.normal();
    let scene = Scene::new(time_step)
        .with_body(Body::new("ball", [-1e5..=1e5], 1e5, 1e5))
        .with_obstacle(Solid::halfspace("wall", [n], n * wall.position(), surface))
        .with_estimate(ImpactEstimate::EndOfStep);
    let system = rule.into_iter().fold(scene, Scene::with_rule).hybrid_system().unwrap();
    let mut names = names.into_iter();
    let named = system.parts().choices[0].transitions.iter().cloned().map(|mut own| {
        own.name = names.next().unwrap().to_owned();
        own
    });
    named.collect::<Vec<_>>().try_into().unwrap()
}

/// The flight and the impact of the law that reflects steps, with a limit on the impact speed.
pub(crate) fn reflecting(
    wall: Wall,
    e: f64,
    time_step: f64,
    max_speed: Option<f64>,
) -> [Transition; 2] {
    let surface = Surface::bounce(Restitution::new(e).unwrap());
    let rule = DamageRule::new("the limit on the impact speed", Default::default());
    let rule = max_speed.map(|most| rule.with_per_hit(most));
    transitions(wall, surface, time_step, rule, ["flight", "impact"])
}

/// The wall as a system.
fn system(e: f64) -> HybridSystem {
    let [flight, impact] = reflecting(Wall::default(), e, TIME_STEP, None);
    HybridSystem::new(TIME_STEP)
        .with_state("x", POSITIONS)
        .with_state("v", SPEEDS)
        .with_input("a", FORCES)
        .with_transition(flight)
        .with_transition(impact)
}

fn general(e: f64, steps: usize) -> (Model, SystemVariables) {
    let mut model = Model::new("general");
    let program = system(e).write(&mut model, "", steps).unwrap();
    (model, program)
}

/// A step beside a wall at 0 m, free above, by hand: the penetration `h` and the impact speed `f`
/// are switched, and `x⁺ = p + (1+e) h`, `v⁺ = w + (1+e) f` hold in both modes.
pub(crate) fn add_by_hand(
    model: &mut Model,
    e: f64,
    t: usize,
    [p, w]: [&Affine; 2],
    [x, v]: [Variable; 2],
    hit: Variable,
) {
    let mut shortfall = |family: &str, of: &Affine| {
        let largest = (-model.range(of).unwrap().lower).max(0.0);
        model.continuous((family, t), 0.0, largest).unwrap()
    };
    let (h, f) = (shortfall("penetration", p), shortfall("impact_speed", w));
    model.add(("position", t), x.equals(p + (1.0 + e) * h)).unwrap();
    model.add(("velocity", t), v.equals(w + (1.0 + e) * f)).unwrap();
    model.add(("outside", t), (h + p).ge(0.0)).unwrap();
    model.add(("free_position", t), hit.off().implies(h.le(0.0))).unwrap();
    model.add(("free_velocity", t), hit.off().implies(f.le(0.0))).unwrap();
    model.add(("impact_position", t), hit.on().implies(x.le(-e * p))).unwrap();
    model.add(("impact_velocity", t), hit.on().implies(v.equals(-e * w))).unwrap();
}

/// The same system by hand.
fn by_hand(e: f64, steps: usize) -> Model {
    let mut model = Model::new("by hand");
    let x = model.continuous_family("x", steps + 1, POSITIONS.lower, POSITIONS.upper).unwrap();
    let v = model.continuous_family("v", steps + 1, SPEEDS.lower, SPEEDS.upper).unwrap();
    let a = model.continuous_family("a", steps, FORCES.lower, FORCES.upper).unwrap();
    let zeta = model.binary_family("impact", steps).unwrap();
    let vehicle = LinearSystem::double_integrator(TIME_STEP).unwrap();
    for t in 0..steps {
        let predicted = vehicle.predict(&[x[t], v[t]], &[a[t]]).unwrap();
        let next = [x[t + 1], v[t + 1]];
        add_by_hand(&mut model, e, t, [&predicted[0], &predicted[1]], next, zeta[t]);
    }
    model
}

#[test]
fn the_wall_has_the_rows_of_the_hand_written_one() {
    for e in [0.0, 0.5, 1.0] {
        let (model, _) = general(e, 3);
        let (own, hand) =
            (reformulate::lower(&model).unwrap(), reformulate::lower(&by_hand(e, 3)).unwrap());
        assert_eq!(own.model().variable_count(), hand.model().variable_count());
        assert_eq!(own.model().constraint_count(), hand.model().constraint_count());
    }
}

/// The relaxation of a model: its rows over continuous variables.
fn relaxed(model: &Model) -> (Model, Vec<Variable>) {
    let lowered = reformulate::lower(model).unwrap();
    let mut relaxed = Model::new("relaxed");
    let variables: Vec<Variable> = lowered
        .model()
        .variables()
        .map(|v| {
            let bounds = v.bounds();
            relaxed.continuous(v.name().clone(), bounds.lower, bounds.upper).unwrap()
        })
        .collect();
    for row in lowered.model().constraints() {
        let sum: Affine = row.terms().iter().map(|&(v, a)| a * variables[v.index()]).sum();
        let limits = row.limits();
        relaxed.add(row.name().clone(), sum.within(limits.lower, limits.upper)).unwrap();
    }
    (relaxed, variables)
}

#[test]
fn relaxations_are_never_weaker_than_by_hand() {
    let mut state = 0x2545_F491_u64;
    let mut number = || {
        // A linear congruential generator; the upper bits as a number in [-1, 1].
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 23) - 1.0
    };
    for e in [0.0, 0.5, 0.9, 1.0] {
        let (mut own, variables) = relaxed(&general(e, 1).0);
        let (mut hand, by_hand) = relaxed(&by_hand(e, 1));
        let mut solver = BranchAndBound::default();
        for _ in 0..60 {
            // In x, v, a and the binary; states have two samples each.
            let cost: Vec<f64> = (0..6).map(|_| number()).collect();
            let mut bounds = [0.0; 2];
            for (bound, (model, variables)) in
                bounds.iter_mut().zip([(&mut own, &variables), (&mut hand, &by_hand)])
            {
                let sum: Affine = cost.iter().zip(variables).map(|(c, v)| *c * *v).sum();
                model.minimize(sum).unwrap();
                let solution = solver.solve(model).unwrap();
                assert!(solution.is_optimal());
                *bound = solution.bound();
            }
            assert!(bounds[0] >= bounds[1] - 1e-6, "e = {e}: {bounds:?}, {cost:?}");
        }
    }
}

#[test]
fn a_limit_on_the_impact_speed_can_be_blamed() {
    let [flight, impact] = reflecting(Wall::default(), 0.5, TIME_STEP, Some(2.0));
    let mut limited = system(0.5);
    limited.parts_mut().choices.clear();
    let limited = limited.with_transition(flight).with_transition(impact);
    let mut model = Model::new("limited");
    let program = limited.write(&mut model, "", 1).unwrap();
    // It holds in flight as well, where the impact speed is 0, and does not tighten anything else.
    let row = "  impact_the_limit_on_the_impact_speed[0]: impact_speed[0] <= 2";
    assert!(model.to_string().contains(row), "{model}");
    assert!(!model.is_background("impact_the_limit_on_the_impact_speed[0]"));
    assert!(model.is_background("impact_x[0]") && model.is_background("flight_x[0]"));
    let speed = model.variable_by_name("impact_speed[0]").unwrap();
    let largest = model.variable_ref(speed).unwrap().bounds().upper;
    assert!((largest - 6.0).abs() < 1e-9);
    assert_eq!(program.output("impact speed").unwrap()[0], Affine::from(speed));
}

#[test]
fn a_tube_tightens_the_rows() {
    let steps = 20;
    let (mut model, program) = general(0.5, steps);
    let (x, v) = (program.state("x").unwrap(), program.state("v").unwrap());
    for (variable, value) in [(x[0], 5.0), (v[0], 0.0), (x[steps], 1.0), (v[steps], 0.0)] {
        model.fix(variable, value).unwrap();
    }
    let effort: Quadratic = program.inputs()[0].iter().map(|a| (1.0 * a).square()).sum();
    model.minimize(effort).unwrap();
    let before = BranchAndBound::default().solve(&model).unwrap().objective().unwrap();

    let at = |x| [Interval::point(x), Interval::point(0.0)];
    let mut sets = ReachSets::new(&system(0.5), at(5.0), at(1.0), SetOptions::default()).unwrap();
    let tube = sets.tube(steps).unwrap();
    let report = tube.tighten(&mut model, &program.horizon_variables()).unwrap();
    // In the first steps the wall is out of reach.
    assert_eq!(
        model
            .variable_ref(program.taken("mode", "impact", 0).unwrap().unwrap().variable())
            .unwrap()
            .bounds()
            .upper,
        0.0
    );
    for family in ["impact_speed", "change_x"] {
        assert!(report.parts().tightened.iter().any(|change| change.name.family() == family));
    }
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!((solution.objective().unwrap() - before).abs() < 1e-4);
    let mut run = program.read(&solution).unwrap();
    assert!(system(0.5).certify(&run).unwrap().largest_residual < 1e-6);
    // The picture names the transitions where they change.
    let svg = tube.to_svg(0, 1, Some(&run)).unwrap();
    assert!(svg.contains(">flight</text>") && svg.contains("<path d=\"M"), "{svg}");
    run.transitions[0].1[3] = "im<pact".into();
    assert!(tube.to_svg(0, 1, Some(&run)).unwrap().contains(">im&lt;pact</text>"));
    run.states.remove(0);
    assert!(tube.to_svg(0, 1, Some(&run)).is_err());
}
