//! Pictures of plans.

use carom::hybrid::scene::{Body, Scene, ScenePlan, Shape, Solid, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::picture::{COLOURS, Chart};
use carom::prelude::*;
use proptest::prelude::{ProptestConfig, prop, prop_assert, prop_assert_eq, proptest};

fn plan(axes: usize) -> (Scene, ScenePlan) {
    let room = vec![Interval::new(0.0, 2.0); axes];
    let speed = (0..axes).map(|i| if i == 0 { -2.0 } else { 0.4 }).collect();
    let start = [vec![0.5; axes], speed].concat();
    let body = Body::new("a <puck>", room, 4.0, 2.0)
        .with_shape(Shape::Ball(0.1))
        .with_start(Region::point(start));
    let normal: Vec<f64> = (0..axes).map(|i| if i == 0 { 1.0 } else { 0.0 }).collect();
    let cushion = Surface::bounce(Restitution::new(0.5).unwrap());
    let wall = Solid::halfspace("wall", normal, 0.0, cushion);
    let sides = vec![Interval::new(0.75, 0.9); axes];
    let gate = Solid::cuboid("gate", &sides, Surface::avoid());
    let course = (0..=4).map(|t| vec![0.02 * f64::from(t); axes]);
    let scene =
        Scene::new(0.1).with_body(body).with_obstacle(wall).with_obstacle(gate.with_course(course));
    let program = scene.program(4).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    let plan = program.plan(&solution).unwrap();
    (scene, plan)
}

/// The value of an attribute, wherever it is.
fn values<'a>(svg: &'a str, attribute: &str) -> Vec<&'a str> {
    let before = format!(" {attribute}=\"");
    svg.match_indices(&before)
        .map(|(at, _)| svg[at + before.len()..].split('"').next().unwrap())
        .collect()
}

/// What every picture is: closed elements, a title and a description, colours for light and dark
/// pages, nothing from elsewhere.
fn tidy(svg: &str) {
    assert!(svg.starts_with("<svg xmlns") && svg.trim_end().ends_with("</svg>"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    assert!(!svg.contains("href") && !svg.contains("<script") && svg.matches("http").count() == 1);
    let start = svg.lines().next().unwrap();
    assert!(start.contains("role=\"img\"") && start.contains("viewBox"));
    assert!(svg.contains("<title>") && svg.contains("<desc>"));
    assert!(svg.contains("@media (prefers-color-scheme:dark)"));
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').unwrap_or_else(|| panic!("an open `<` in {tag}"));
        let name = tag.split([' ', '\n']).next().unwrap();
        if let Some(name) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn the_plane_has_equal_axes_start_goal_and_hits() {
    let (scene, plan) = plan(2);
    let svg = plan.to_svg(&scene).unwrap();
    tidy(&svg);
    assert!(svg.contains("a &lt;puck") && !svg.contains("<puck"));
    assert!(svg.contains("x (m)") && svg.contains("y (m)"));
    let [hit] = &plan.hits[..] else { panic!("one hit") };
    let speed = format!("hit at {:.2}", hit.speed);
    assert!(svg.contains(speed.trim_end_matches('0')), "{speed}");
    assert!(svg.contains(">start, 2.04 m/s</text>") && svg.contains(">end, "), "{svg}");
    // Discs are round, and bodies are shown more than twice.
    let (rx, ry) = (values(&svg, "rx"), values(&svg, "ry"));
    assert!(ry.len() > 2 && ry.iter().all(|r| rx.contains(r)), "{rx:?} {ry:?}");
    // A moving obstacle is there at the start and at the end.
    assert!(svg.contains(">gate at 0 s</text>") && svg.contains(">gate at 0.4 s</text>"));
}

#[test]
fn what_moves_is_shown_only_where_it_is_played() {
    let (scene, plan) = plan(2);
    let (still, moving) = (plan.to_svg(&scene).unwrap(), plan.to_animation(&scene).unwrap());
    tidy(&moving);
    assert!(moving.contains("animateTransform") && !still.contains("animate"));
    assert!(moving.contains("@media (prefers-reduced-motion:reduce){.carom .live{display:none}}"));
    // Without what moves, it says what the still picture says.
    let lines = moving.lines().filter(|line| !line.contains("class=\"live\""));
    let rest: Vec<&str> = lines.filter(|line| !line.contains("reduced-motion")).collect();
    assert!(rest.iter().all(|line| !line.contains("animate")));
    let texts = |svg: &str| svg.matches("class=\"h\"").count();
    assert_eq!(texts(&rest.join("\n")), texts(&still));
    for element in moving.lines().filter(|line| line.contains("class=\"live\"")) {
        assert!(element.contains("visibility=\"hidden\"><set attributeName=\"visibility\""));
        let (times, places) = (values(element, "keyTimes"), values(element, "values"));
        let count = |text: &str| text.split(';').count();
        assert_eq!(count(times[0]), count(places[0]));
        let times: Vec<f64> = times[0].split(';').map(|t| t.parse().unwrap()).collect();
        assert!(times[0] == 0.0 && times.windows(2).all(|t| t[0] < t[1]) && times.len() > 1);
    }
}

#[test]
fn plans_race_in_one_picture() {
    let (scene, plan) = plan(2);
    let picture = plan.picture(&scene).unwrap().with_name("one").with_title("Both\nand how long");
    let picture = picture.with_rival("other & same", &plan).unwrap();
    for svg in [picture.to_svg(), picture.to_animation().unwrap()] {
        tidy(&svg);
        assert!(svg.contains("<title>Both. and how long</title>"));
        assert!(
            svg.contains(">one: 0.4 s</text>") && svg.contains(">other &amp; same: 0.4 s</text>")
        );
        // They start and end together, which is said once.
        assert_eq!(svg.matches(">start, ").count(), 1);
    }
    // The clock counts tenths.
    let moving = picture.to_animation().unwrap();
    assert!(moving.contains(">0.0 s</tspan>") && moving.contains(">0.4 s</tspan>"));
    assert!(!moving.contains(">0.5 s</tspan>"));
    let mut other = plan.clone();
    other.bodies.clear();
    assert!(picture.with_rival("of no body", &other).is_err());
    let (line, _) = self::plan(1);
    assert!(plan.picture(&line).is_err());
}

#[test]
fn a_line_is_drawn_over_time() {
    let (scene, on_line) = plan(1);
    let svg = on_line.to_svg(&scene).unwrap();
    tidy(&svg);
    assert!(svg.contains("time (s)") && svg.contains("position (m)"));
    assert!(svg.contains(">start, 2 m/s</text>") && svg.contains(">hit at "));
    assert!(on_line.to_animation(&scene).is_err());
}

#[test]
fn space_is_drawn_from_above_and_from_the_side() {
    let (scene, plan) = plan(3);
    let svg = plan.to_svg(&scene).unwrap();
    tidy(&svg);
    // Two charts with the axis to the right in common, and the speeds in space.
    assert!(svg.matches(">x (m)</text>").count() >= 2);
    assert!(svg.contains(">y (m)</text>") && svg.contains(">z (m)</text>"));
    assert_eq!(svg.matches(">start, 2.08 m/s</text>").count(), 2);
    assert!(svg.contains("starts at (0.5, 0.5, 0.5) m"));
    assert!(svg.contains(">gate at 0 s</text>"));
    // A floor covers everything from above, and is a strip from the side.
    let floored = scene.clone().with_obstacle(Solid::cuboid(
        "floor",
        [0.0..=2.0, 0.0..=2.0, -0.1..=0.0],
        Surface::avoid(),
    ));
    assert!(plan.to_svg(&floored).unwrap().matches("<path").count() > svg.matches("<path").count());
    let text = plan.to_animation(&scene).unwrap_err().to_string();
    assert!(text.starts_with("the number of axes of an animation is 3"), "{text}");
}

#[test]
fn bodies_on_one_line_of_the_plane_are_drawn_over_time() {
    let lane = [0.0..=6.0, 0.0..=1.0];
    let body = |name: &str, x: f64, v: f64| {
        let half = Shape::Box(vec![0.2, 0.1]);
        Body::new(name, &lane, 3.0, 0.0).with_shape(half).with_start([x, 0.5, v, 0.0])
    };
    let mut scene = Scene::new(0.25);
    let first = scene.body(body("first", 0.5, 2.0)).unwrap();
    let second = scene.body(body("second", 1.5, 0.0)).unwrap();
    scene.pair(first, second, Surface::bounce(Restitution::new(1.0).unwrap())).unwrap();
    let plan = scene.program(6).unwrap().solve(&mut BranchAndBound::default()).unwrap();
    let svg = plan.to_svg(&scene).unwrap();
    tidy(&svg);
    assert!(svg.contains(">time (s)<") && svg.contains(">x (m)<") && !svg.contains(">y (m)<"));
    assert!(svg.contains(">first: start, 2 m/s<") && svg.contains(">second: start, at rest<"));
    tidy(&plan.to_animation(&scene).unwrap());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Names of curves are written once, within the picture, and not over each other.
    #[test]
    fn names_are_beside_curves_or_in_the_legend(
        curves in prop::collection::vec(prop::collection::vec(-2.0..2.0_f64, 2..12), 1..7),
    ) {
        let mut chart = Chart::new("time (s)", "height (m)").with_size(400.0, 200.0);
        for (k, heights) in curves.iter().enumerate() {
            let points = heights.iter().enumerate().map(|(t, &x)| [t as f64, x]);
            chart.line(format!("curve {k}"), COLOURS[k % COLOURS.len()], points);
        }
        let svg = Chart::to_svg(&[chart], "curves");
        tidy(&svg);
        let mut boxes: Vec<[f64; 4]> = Vec::new();
        for k in 0..curves.len() {
            let name = format!(">curve {k}</text>");
            prop_assert_eq!(svg.matches(&name).count(), 1, "{}", name);
            let line = svg.lines().find(|line| line.contains(&name)).unwrap();
            if line.contains("class=\"h\"") {
                let [x, y] = ["x", "y"].map(|of| values(line, of)[0].parse::<f64>().unwrap());
                // Seven letters of at least five pixels, in the middle of the frame from 66 to 466.
                prop_assert!(x - 18.0 > 66.0 && x + 18.0 < 466.0, "{}", line);
                let own = [x - 18.0, y - 9.0, x + 18.0, y];
                for other in &boxes {
                    let apart = own[0] > other[2] || other[0] > own[2]
                        || own[1] > other[3] || other[1] > own[3];
                    prop_assert!(apart, "{:?} {:?}", own, other);
                }
                boxes.push(own);
            }
        }
    }
}

#[test]
fn charts_are_exact_to_less_than_a_pixel() {
    // A slope of a third of a pixel per point, and a bend.
    let mut chart = Chart::new("t & s (s)", "x (m)")
        .with_size(300.0, 100.0)
        .with_ranges(Interval::new(0.0, 300.0), Interval::new(0.0, 100.0));
    let bend = (0..=300).map(|t| [f64::from(t), (f64::from(t) / 3.0).min(50.0)]);
    chart.line("a <b>", COLOURS[0], bend);
    chart.dots("dots", COLOURS[1], 2.0, [[10.0, f64::NAN], [20.0, 30.0]]);
    chart.area("", COLOURS[2], 0.1, [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]]);
    let svg = Chart::to_svg(&[chart.clone(), chart], "two");
    assert!(svg.starts_with("<svg xmlns") && svg.trim_end().ends_with("</svg>"));
    assert!(!svg.contains("NaN") && svg.contains("t &amp; s (s)"));
    // Named once; where nothing is out of the line, it has no points.
    assert_eq!(svg.matches(">a &lt;b&gt;</text>").count(), 1);
    assert_eq!(svg.matches(">dots</text>").count(), 1);
    let path = svg.split("<path class=\"c0\" d=\"M").nth(1).unwrap().split('"').next().unwrap();
    let points: Vec<Vec<f64>> =
        path.split('L').map(|p| p.split(' ').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!(points.len(), 3, "{path}");
    let (start, bend) = (&points[0], &points[1]);
    assert!(
        (bend[0] - start[0] - 150.0).abs() < 0.011 && (start[1] - bend[1] - 50.0).abs() < 0.011
    );
    assert_eq!(svg.matches("<circle").count(), 2);
}

#[test]
fn logarithmic_charts_have_ticks_at_round_numbers() {
    let mut chart = Chart::new("x", "y").with_logarithms();
    chart.line("", "black", [[1.0, 0.01], [100.0, 1.0]]);
    let svg = Chart::to_svg(&[chart], "");
    for tick in ["1", "2", "5", "10", "20", "50", "100", "0.01", "0.02", "0.05", "0.1"] {
        assert!(svg.contains(&format!(">{tick}</text>")), "{tick}");
    }
    // An empty chart is one, too.
    assert!(!Chart::to_svg(&[Chart::new("x", "y")], "none").contains("NaN"));
}
