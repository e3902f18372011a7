//! A helicopter flies over islands, where it may land and charge its battery: which islands, where
//! to land on them, and how long to rest? A shortest path through a graph of convex sets.
//!
//! `cargo run --release --example helicopter [-- ISLANDS.csv [PICTURE.svg]]`
//!
//! Flying one unit takes one unit of time and five of the battery, which holds one; resting charges
//! one a unit of time. The file has a line `x,y,radius` for each island after its heading. Ctrl-C
//! ends the search with the best path so far, and the exit status is 3.

#[path = "../crates/carom-cli/src/interrupts.rs"]
mod interrupts;

use std::process::ExitCode;

use carom::graph_of_sets::GraphOfSets;
use carom::model::norm;
use carom::picture::{Chart, GOAL_COLOUR, SOLID, WITHOUT_COLLISION};
use carom::prelude::*;
use interrupts::{INTERRUPTED, Signals};

/// Some islands, if no file is given.
const ISLANDS: &str = "x,y,radius
0.05,0.05,0.08\n0.25,0.2,0.07\n0.1,0.35,0.09\n0.4,0.4,0.06\n0.3,0.6,0.08\n0.55,0.55,0.05
0.5,0.8,0.07\n0.15,0.7,0.06\n0.35,0.95,0.09\n0.1,1.1,0.08\n0.55,1.2,0.07\n0.3,1.35,0.08
0.1,1.5,0.07\n0.5,1.5,0.06\n0.3,1.7,0.09\n0.1,1.9,0.06\n0.5,1.85,0.08\n0.4,2.1,0.06";
const DISCHARGE: f64 = 5.0;
const RANGE: f64 = 1.0 / DISCHARGE;

/// A solver whose solves end at an interrupt.
struct Interruptible {
    solver: BranchAndBound,
    interrupt: Interrupt,
}

impl Solver for Interruptible {
    fn name(&self) -> &str {
        self.solver.name()
    }

    fn options(&self) -> &Options {
        self.solver.options()
    }

    fn options_mut(&mut self) -> &mut Options {
        self.solver.options_mut()
    }

    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        *control = std::mem::take(control).with_interrupt(&self.interrupt);
        self.solver.solve_with(model, control)
    }
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let text = arguments.next().map_or(Ok(ISLANDS.to_owned()), std::fs::read_to_string)?;
    let mut islands = Vec::new();
    for line in text.lines().skip(1) {
        let numbers: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
        islands.push(<[f64; 3]>::try_from(numbers).map_err(|_| format!("`{line}` is no island"))?);
    }
    let distance = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let nearest = |place: [f64; 3]| {
        let far = |k: &usize| distance(islands[*k], place);
        (0..islands.len()).min_by(|a, b| far(a).total_cmp(&far(b))).ok_or("no islands")
    };
    let (start, goal) = (nearest([0.0; 3])?, nearest([islands.len() as f64 / 60.0, 2.0, 0.0])?);

    let mut graph = GraphOfSets::new("helicopter");
    let (mut vertices, mut points) = (Vec::new(), Vec::new());
    for (k, &[x, y, radius]) in islands.iter().enumerate() {
        // Where it lands, and the battery at landing and at take-off; it is full at the start.
        let battery = if k == start { 1.0..=1.0 } else { 0.0..=1.0 };
        let ranges = [x - radius..=x + radius, y - radius..=y + radius, battery.clone(), battery];
        let island = graph.vertex(("island", k), &ranges)?;
        let p = graph.point(island)?;
        graph.add(island, norm([p[0] - x, p[1] - y]).le(radius))?;
        if k != start {
            graph.add(island, p[3].ge(p[2]))?;
            graph.add_cost(island, p[3] - p[2])?;
        }
        vertices.push(island);
        points.push(p);
    }
    for (i, j) in (0..islands.len()).flat_map(|i| (0..islands.len()).map(move |j| (i, j))) {
        let gap = distance(islands[i], islands[j]) - islands[i][2] - islands[j][2];
        if i != j && gap < RANGE {
            let (flight, p, q) = (graph.edge(vertices[i], vertices[j])?, &points[i], &points[j]);
            let time = RANGE * (p[3] - q[2]);
            graph.add(flight, norm([p[0] - q[0], p[1] - q[1]]).le(&time))?;
            graph.add_cost(flight, time)?;
        }
    }
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let mut solver = Interruptible { solver: BranchAndBound::default(), interrupt };
    let began = std::time::Instant::now();
    let path = graph.shortest_path(vertices[start], vertices[goal], &mut solver)?;
    println!("time {:.6}, proved: no less than {:.6}", path.cost, path.bound);
    println!("{} edges left, {} nodes, {:.2?}", path.edges_left, path.nodes, began.elapsed());
    let status = if signals.came() { INTERRUPTED.into() } else { ExitCode::SUCCESS };
    let Some(picture) = arguments.next() else { return Ok(status) };
    let mut chart = Chart::new("x (units of length)", "y (units of length)")
        .with_size(560.0, 720.0)
        .with_equal_axes();
    for &[x, y, radius] in &islands {
        chart.discs("", SOLID, 0.6, radius, [[x, y]]);
    }
    let stops: Vec<[f64; 2]> = path.stops.iter().map(|s| [s.point[0], s.point[1]]).collect();
    chart.line("flight", WITHOUT_COLLISION[0], stops.iter().copied());
    chart.dots("landing", WITHOUT_COLLISION[0], 4.0, stops.iter().copied());
    if let [first, .., last] = stops[..] {
        chart.start("start", "black", first);
        chart.goal("goal", GOAL_COLOUR, last);
    }
    let title = format!(
        "A flight over {} islands\n{} landings, time {:.3}, proved to be the shortest.",
        islands.len(),
        stops.len().saturating_sub(2),
        path.cost
    );
    std::fs::write(picture, Chart::to_svg(&[chart], &title))?;
    Ok(status)
}
