//! Hard cases picked by hand.

use super::answer;
use super::brute_force::{HorizonVerdict, Horizons, ShortestHorizon};
use super::scenes::{End, Scene, moving, rest};

/// A scene and what each horizon is, from τ = 1 on: `-` where there is no plan, else the fewest
/// impacts of one.
struct Case {
    name: &'static str,
    horizons: &'static str,
    scene: Scene,
}

fn case(name: &'static str, horizons: &'static str, scene: Scene) -> Case {
    Case { name, horizons, scene }
}

impl Case {
    /// What the horizons say about the shortest one.
    fn shortest(&self) -> ShortestHorizon {
        let impacts = self.horizons.chars().map(|letter| letter.to_digit(10)).enumerate();
        let mut found = impacts.filter_map(|(t, impacts)| Some((t + 1, impacts? as usize)));
        match found.next() {
            Some((steps, impacts)) => ShortestHorizon::Found { steps, impacts },
            None => ShortestHorizon::NoneWithin { max_steps: self.horizons.len() },
        }
    }
}

/// What brute force says about the first horizons.
fn horizons(scene: &Scene, count: usize) -> String {
    let scenario = scene.plain();
    let letter = |verdict| match verdict {
        HorizonVerdict::Feasible { impacts } => impacts.to_string(),
        HorizonVerdict::Infeasible => "-".into(),
        HorizonVerdict::TooClose => "?".into(),
    };
    Horizons::new(&scenario).take(count).map(letter).collect()
}

fn check(cases: &[Case]) {
    for case in cases {
        let count = case.horizons.len();
        assert_eq!(horizons(&case.scene, count), case.horizons, "brute force: {}", case.name);
        for (at, side) in [(0.0, 1.0), (3.5, -1.0), (-2.0, 1.0)] {
            let found = answer(&case.scene.beside(at, side), count);
            assert_eq!(found, Ok(case.shortest()), "{} (wall at {at}, {side})", case.name);
        }
    }
}

#[test]
fn ends_at_the_wall_and_ends_in_motion() {
    let plain = Scene::new;
    let bouncy = |scene| Scene { restitution: 0.5, ..scene };
    let elastic = |scene| Scene { restitution: 1.0, ..scene };
    let into_the_wall = moving(0.0, -2.0);
    check(&[
        case("already there, at rest", "000", plain(rest(1.0), rest(1.0))),
        // It has to go away and come back.
        case("already there, in motion", "---00", plain(moving(1.0, 1.0), moving(1.0, 1.0))),
        case("a plastic wall stops it", "---1100", plain(rest(2.0), rest(0.0))),
        case("an elastic one does not", "-----0", elastic(plain(rest(2.0), rest(0.0)))),
        // Steps that end on the wall to the last bit.
        case("arriving at the wall", "----0", plain(rest(2.0), into_the_wall)),
        case("braking to the wall", "00", plain(moving(0.125, -1.0), rest(0.0))),
        case("nothing leaves a plastic wall", "----------", plain(rest(1.0), moving(0.0, 2.0))),
        case("a rebound starts there", "-------1", bouncy(plain(rest(1.0), moving(0.0, 2.0)))),
        case("starting into the wall", "--11", bouncy(plain(into_the_wall, rest(0.5)))),
        case(
            "starting into the wall, pushed",
            "---1",
            plain(End { pull: Some(-4.0), ..moving(0.25, -1.0) }, rest(0.5)),
        ),
        case(
            "two bounces on the way",
            "---22",
            Scene { time_step: 0.5, ..elastic(plain(moving(0.0, -1.25), moving(1.249, 3.75))) },
        ),
    ]);
}

#[test]
fn limits_on_damage() {
    let fall = Scene { time_step: 0.1, ..Scene::new(rest(0.9), rest(0.02)) };
    let bounces = Scene {
        restitution: 1.0,
        limits: (-2.0, 2.0),
        ..Scene::new(moving(0.31, -1.0), moving(0.16, 1.5))
    };
    // Its wall is hit whatever it does.
    let doomed = Scene { restitution: 0.5, ..Scene::new(moving(0.0, -2.0), rest(0.5)) };
    check(&[
        case("a hit saves a step", "--------10", fall),
        case("forbidden", "---------0", Scene { collisions: false, ..fall }),
        case("slow enough", "--------10", Scene { per_impact: Some(2.0), ..fall }),
        case("too fast", "---------0", Scene { per_impact: Some(1.5), ..fall }),
        case("no damage at all", "---------0", Scene { per_impact: Some(0.0), ..fall }),
        case("a budget", "--------10", Scene { cumulative: Some(2.0), ..fall }),
        case("two bounces save two steps", "------221", bounces),
        case("a budget for one", "--------1", Scene { cumulative: Some(1.5), ..bounces }),
        case("a hit that cannot be avoided", "--1", doomed),
        case("and is not allowed", "----------", Scene { per_impact: Some(0.0), ..doomed }),
        // Braking all the way it hits at 1 to the last bit.
        case("but just allowed", "--1", Scene { cumulative: Some(1.0), ..doomed }),
        case("nor in sum", "----------", Scene { cumulative: Some(0.9), ..doomed }),
    ]);
}

#[test]
fn limits_on_speed_and_place() {
    let elastic = Scene { restitution: 1.0, ..Scene::new(rest(1.0), moving(0.5, 2.0)) };
    let there_and_back =
        Scene { restitution: 1.0, ..Scene::new(moving(0.5, -3.0), moving(0.5, 3.0)) };
    check(&[
        case("fast", "-----0", Scene::new(rest(2.0), rest(0.125))),
        case("slow", "------0", Scene { max_speed: 1.5, ..Scene::new(rest(2.0), rest(0.125)) }),
        case("a rebound at full speed", "---11", Scene { max_speed: 2.0, ..elastic }),
        // Within the step of an impact it may be faster than at any sample.
        case(
            "an impact above the limit",
            "-11",
            Scene {
                restitution: 0.5,
                max_speed: 2.0,
                ..Scene::new(moving(0.5, -2.0), moving(0.25, 1.25))
            },
        ),
        case("there and back", "-----2", there_and_back),
        // Samples near the wall are excluded, impacts between samples are not.
        case("and never near", "-------2", Scene { domain: Some((0.25, 9.0)), ..there_and_back }),
        case(
            "a plastic wall out of bounds",
            "----------",
            Scene { domain: Some((0.25, 9.0)), ..Scene::new(moving(0.5, -3.0), rest(0.5)) },
        ),
    ]);
}

#[test]
fn zero_is_no_acceleration() {
    let pushed = |lower: f64, upper: f64, scene| Scene { limits: (lower, upper), ..scene };
    let home = Scene::new(rest(0.5), rest(0.0));
    let up = Scene::new(rest(1.0), rest(0.5));
    check(&[
        case("no standing still", "----------", pushed(1.0, 2.0, Scene::new(rest(0.5), rest(0.5)))),
        // Pushed away from the wall it comes to rest once.
        case(
            "pushed away",
            "--00------",
            pushed(1.0, 4.0, Scene::new(moving(1.0, -2.0), rest(0.25))),
        ),
        // Pushed towards the wall it rests on it, with an impact in every step.
        case("pushed home", "-111123456", pushed(-4.0, -1.0, home)),
        case(
            "and damage forbids the first and the last",
            "--1112----",
            Scene { cumulative: Some(1.6), ..pushed(-4.0, -1.0, home) },
        ),
        case("never up again", "----------", pushed(-4.0, -1.0, up)),
        case(
            "but off the wall",
            "-----11112",
            Scene { restitution: 1.0, ..pushed(-4.0, -1.0, up) },
        ),
    ]);
}

#[test]
fn feasibility_that_is_not_monotone() {
    let cases = [
        // Only coasting on gets there at once; otherwise it has to turn round twice.
        case(
            "now or later",
            "0---000000",
            Scene {
                limits: (-6.0, 6.0),
                time_step: 0.5,
                ..Scene::new(moving(3.38, -2.25), moving(1.505, -5.25))
            },
        ),
        case(
            "one bounce or two",
            "-1----22-3",
            Scene {
                restitution: 1.0,
                limits: (-4.0, -2.0),
                ..Scene::new(moving(0.0, -1.0), moving(0.63, 1.0))
            },
        ),
        case(
            "one, three or four",
            "-1---3-445",
            Scene {
                restitution: 0.75,
                limits: (-3.0, -2.0),
                time_step: 0.5,
                ..Scene::new(rest(0.0), moving(0.25, -0.5))
            },
        ),
        case(
            "three, and not one step more",
            "-------3-4",
            Scene {
                restitution: 0.5,
                limits: (-3.0, -2.0),
                time_step: 0.5,
                ..Scene::new(rest(1.88), moving(0.19, 0.75))
            },
        ),
    ];
    for case in &cases {
        assert!(!case.scene.plain().monotonicity().is_monotone(), "{}", case.name);
        let later = case.horizons.trim_start_matches('-');
        assert!(later.contains('-'), "{} is monotone", case.name);
    }
    check(&cases);
}
