//! A helicopter flies over islands, on which it may land and charge its battery: a shortest path through a
//! graph of convex sets.
//!
//! `cargo run --release --example helicopter [-- ISLANDS.csv [PICTURE.svg]]`
//!
//! Islands are discs, a line `x,y,radius` each. Flying one unit takes one unit of time and five of the
//! battery, of which there is one; resting charges one a unit of time. Which islands, where to land on them, and
//! how long to rest?

use carom::graph_of_sets::{GraphOfSets, GraphVertex};
use carom::model::norm;
use carom::picture::{COLOURS, Chart};
use carom::prelude::*;

/// Seven islands, if no file is given.
const ISLANDS: &str = "x,y,radius
0.05,0.05,0.08\n0.25,0.2,0.07\n0.1,0.35,0.09\n0.4,0.4,0.06\n0.3,0.6,0.08\n0.55,0.55,0.05\n0.5,0.8,0.07";
const DISCHARGE: f64 = 5.0;
const CHARGE: f64 = 1.0;
const SPEED: f64 = 1.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let text = arguments.next().map_or(Ok(ISLANDS.to_owned()), std::fs::read_to_string)?;
    let mut islands = Vec::new();
    for line in text.lines().skip(1) {
        let numbers: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
        islands.push([numbers[0], numbers[1], numbers[2]]);
    }
    let distance = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let nearest = |to: [f64; 3]| {
        let order =
            |a: &usize, b: &usize| distance(islands[*a], to).total_cmp(&distance(islands[*b], to));
        (0..islands.len()).min_by(order).unwrap_or(0)
    };
    let goal = if islands.len() < 30 { [0.5, 0.8] } else { [islands.len() as f64 / 60.0, 2.0] };
    let (start, goal) = (nearest([0.0; 3]), nearest([goal[0], goal[1], 0.0]));

    let mut graph = GraphOfSets::new("helicopter");
    let mut vertices: Vec<GraphVertex> = Vec::new();
    for (k, &[x, y, radius]) in islands.iter().enumerate() {
        // The battery at landing and at take-off; it is full at the start.
        let battery = if k == start { 1.0..=1.0 } else { 0.0..=1.0 };
        let ranges = [x - radius..=x + radius, y - radius..=y + radius, battery.clone(), battery];
        let vertex = graph.vertex(("island", k), &ranges)?;
        let p = graph.point(vertex)?;
        graph.add(vertex, norm([p[0] - x, p[1] - y]).le(radius))?;
        if k != start {
            graph.add(vertex, p[3].ge(p[2]))?;
            graph.add_cost(vertex, (1.0 / CHARGE) * (p[3] - p[2]))?;
        }
        vertices.push(vertex);
    }
    let pairs = (0..islands.len()).flat_map(|i| (0..islands.len()).map(move |j| (i, j)));
    for (i, j) in pairs.filter(|(i, j)| i != j) {
        let gap = distance(islands[i], islands[j]) - islands[i][2] - islands[j][2];
        if gap < SPEED / DISCHARGE {
            let flight = graph.edge(vertices[i], vertices[j])?;
            let (p, q) = (graph.point(vertices[i])?, graph.point(vertices[j])?);
            let time = (1.0 / DISCHARGE) * (p[3] - q[2]);
            graph.add(flight, norm([p[0] - q[0], p[1] - q[1]]).le(SPEED * &time))?;
            graph.add_cost(flight, time)?;
        }
    }

    let began = std::time::Instant::now();
    let options = Options::default().with_threads(1);
    let mut solver = BranchAndBound::new(options);
    let path = graph.shortest_path(vertices[start], vertices[goal], &mut solver)?;
    println!("time {:.6}, proved least above {:.6}", path.cost, path.bound);
    println!(
        "{} stops; {} edges searched; {} nodes; {:.2} s",
        path.stops.len(),
        path.edges_left,
        path.nodes,
        began.elapsed().as_secs_f64()
    );
    if let Some(picture) = arguments.next() {
        let mut chart = Chart::new("x", "y").with_size(720.0, 720.0);
        for &[x, y, radius] in &islands {
            let turn = (0..=48).map(|k| f64::from(k) / 48.0 * std::f64::consts::TAU);
            let rim = turn.map(|a| [x + radius * a.cos(), y + radius * a.sin()]);
            chart.line("islands", COLOURS[2], rim);
        }
        chart.line("flight", COLOURS[0], path.stops.iter().map(|s| [s.point[0], s.point[1]]));
        std::fs::write(picture, Chart::to_svg(&[chart], ""))?;
    }
    Ok(())
}
