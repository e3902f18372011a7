//! Pictures of plans.

use carom::hybrid::scene::{Body, Scene, ScenePlan, Shape, Solid, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::picture::{COLOURS, Chart};
use carom::prelude::*;

fn plan(axes: usize) -> (Scene, ScenePlan) {
    let room = vec![Interval::new(0.0, 2.0); axes];
    let speed = (0..axes).map(|i| if i == 0 { -2.0 } else { 0.0 }).collect();
    let start = [vec![0.5; axes], speed].concat();
    let body = Body::new("a <puck>", room, 4.0, 2.0)
        .with_shape(Shape::Ball(0.1))
        .with_start(Region::point(start));
    let normal: Vec<f64> = (0..axes).map(|i| if i == 0 { 1.0 } else { 0.0 }).collect();
    let cushion = Surface::bounce(Restitution::new(0.5).unwrap());
    let wall = Solid::halfspace("wall", normal, 0.0, cushion);
    let sides = vec![Interval::new(1.5, 1.8); axes];
    let gate = Solid::cuboid("gate", &sides, Surface::avoid());
    let course = (0..=4).map(|t| vec![0.02 * f64::from(t); axes]);
    let scene =
        Scene::new(0.1).with_body(body).with_obstacle(wall).with_obstacle(gate.with_course(course));
    let program = scene.program(4).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    let plan = program.plan(&solution).unwrap();
    (scene, plan)
}

/// All numbers of an attribute.
fn numbers(svg: &str, attribute: &str) -> Vec<f64> {
    let before = format!(" {attribute}=\"");
    let parts = svg.split(&before).skip(1);
    parts.filter_map(|part| part.split('"').next()?.parse().ok()).collect()
}

fn tidy(svg: &str) {
    assert!(svg.starts_with("<svg xmlns") && svg.trim_end().ends_with("</svg>"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    // Names are escaped, and nothing is loaded from elsewhere.
    assert!(svg.contains("a &lt;puck") && !svg.contains("<puck"));
    assert!(!svg.contains("href") && svg.matches("http").count() == 1);
}

#[test]
fn the_plane_has_equal_axes_and_a_legend_below() {
    let (scene, plan) = plan(2);
    let svg = plan.to_svg(&scene).unwrap();
    tidy(&svg);
    assert!(svg.contains("x (m)") && svg.contains("y (m)"));
    assert_eq!(plan.hits.len(), 1);
    // The disc is round: the same radius at both ends, and as wide as 0.1 m is along both axes.
    let tall = numbers(&svg, "height")[0];
    let frame = svg.split("stroke=\"#888888\"/>").next().unwrap();
    let bottom = numbers(frame, "y").last().unwrap() + numbers(frame, "height").last().unwrap();
    // The legend is below the frame, inside the picture.
    let entry = svg.lines().find(|line| line.contains("a &lt;puck")).unwrap();
    let place = entry.split("translate(").nth(1).unwrap().split(')').next().unwrap();
    let y: f64 = place.split(' ').nth(1).unwrap().parse().unwrap();
    assert!(y > bottom && y < tall, "{y} {bottom} {tall}");
    let moving = plan.to_animation(&scene).unwrap();
    tidy(&moving);
    assert!(moving.contains("animateTransform") && !moving.contains("<script"));
}

#[test]
fn a_line_is_drawn_over_time_and_space_is_refused() {
    let (scene, on_line) = plan(1);
    let svg = on_line.to_svg(&scene).unwrap();
    tidy(&svg);
    assert!(svg.contains("time (s)") && svg.contains("position (m)"));
    assert!(on_line.to_animation(&scene).is_err());
    let (scene, in_space) = plan(3);
    assert!(in_space.to_svg(&scene).is_err() && in_space.to_animation(&scene).is_err());
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
    // In the legend once; where nothing is out of the line, it has no points.
    assert_eq!(svg.matches("a &lt;b&gt;").count(), 1);
    let path = svg.split("<path d=\"M").nth(1).unwrap().split('"').next().unwrap();
    let points: Vec<Vec<f64>> =
        path.split('L').map(|p| p.split(' ').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!(points.len(), 3, "{path}");
    let (start, bend) = (&points[0], &points[1]);
    assert!(
        (bend[0] - start[0] - 150.0).abs() < 0.011 && (start[1] - bend[1] - 50.0).abs() < 0.011
    );
    assert_eq!(svg.matches("<circle").count(), 3);
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
