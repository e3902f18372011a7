//! Shortest paths through convex sets, against all paths, each a convex program of its own.

use crate::common::config;
use carom::ErrorKind;
use carom::graph_of_sets::{GraphOfSets, GraphVertex};
use carom::model::norm;
use carom::prelude::*;
use proptest::prelude::*;

fn solver() -> BranchAndBound {
    BranchAndBound::new(Options::default().with_threads(1))
}

/// A set in the plane, as statements over any pair of expressions.
#[derive(Debug, Clone)]
enum Set {
    Square,
    Disc,
    /// The part of the square on one side of a line through its centre.
    Half([f64; 2]),
}

/// A cost of an edge, over the points of both ends.
#[derive(Debug, Clone, Copy)]
enum Cost {
    Distance,
    SquaredDistance,
    /// Affine, and below 0 in one direction.
    Slope(f64),
}

#[derive(Debug, Clone)]
struct Case {
    vertices: Vec<([f64; 2], f64, Set)>,
    edges: Vec<(usize, usize, Cost)>,
    /// The longest edge.
    reach: f64,
}

fn case() -> impl Strategy<Value = Case> {
    let set = prop_oneof![
        Just(Set::Square),
        Just(Set::Disc),
        [-1.0..1.0, -1.0..1.0].prop_map(Set::Half),
    ];
    let vertex = ([0.0..4.0, 0.0..4.0], 0.0..0.8, set);
    let cost = prop_oneof![
        3 => Just(Cost::Distance),
        2 => Just(Cost::SquaredDistance),
        1 => (-0.5..0.5).prop_map(Cost::Slope),
    ];
    (prop::collection::vec(vertex, 3..6), 1.0..6.0).prop_flat_map(move |(vertices, reach)| {
        let n = vertices.len();
        let edge = (0..n, 0..n, cost.clone()).prop_filter("a loop", |(a, b, _)| a != b);
        prop::collection::vec(edge, 2..14).prop_map(move |edges| Case {
            vertices: vertices.clone(),
            edges,
            reach,
        })
    })
}

/// Rows and norms of a vertex over its point.
fn say_set(
    (centre, radius, set): &([f64; 2], f64, Set),
    p: &[Variable],
    mut row: impl FnMut(Row),
) -> Option<carom::model::ConicRow> {
    let from = [p[0] - centre[0], p[1] - centre[1]];
    match set {
        Set::Square => {}
        Set::Disc => return (*radius > 0.0).then(|| norm(from).le(*radius)),
        Set::Half(normal) if *radius > 0.0 => {
            row((normal[0] * &from[0] + normal[1] * &from[1]).le(0.1 * radius));
        }
        Set::Half(_) => {}
    }
    None
}

fn graph(case: &Case) -> Result<(GraphOfSets, Vec<GraphVertex>), Error> {
    let mut graph = GraphOfSets::new("random");
    let mut vertices = Vec::new();
    for (k, vertex) in case.vertices.iter().enumerate() {
        let (c, r) = (vertex.0, vertex.1);
        let ranges = [c[0] - r..=c[0] + r, c[1] - r..=c[1] + r];
        let handle = graph.vertex(("v", k), &ranges)?;
        let p = graph.point(handle)?;
        let mut rows = Vec::new();
        let conic = say_set(vertex, &p, |row| rows.push(row));
        for row in rows {
            graph.add(handle, row)?;
        }
        if let Some(conic) = conic {
            graph.add(handle, conic)?;
        }
        // Visits cost something.
        graph.add_cost(handle, 0.1 * (p[0] - c[0]) + 0.05)?;
        vertices.push(handle);
    }
    for &(a, b, cost) in &case.edges {
        let edge = graph.edge(vertices[a], vertices[b])?;
        let (p, q) = (graph.point(vertices[a])?, graph.point(vertices[b])?);
        let d = [p[0] - q[0], p[1] - q[1]];
        graph.add(edge, norm(d.clone()).le(case.reach))?;
        match cost {
            Cost::Distance => graph.add_cost(edge, norm(d))?,
            Cost::SquaredDistance => graph.add_cost(edge, d[0].square() + d[1].square())?,
            Cost::Slope(slope) => graph.add_cost(edge, slope * &d[0])?,
        }
    }
    Ok((graph, vertices))
}

/// The least cost of a path by its edges, as a program over the points of its vertices.
fn cost_along(case: &Case, edges: &[usize]) -> Option<f64> {
    let mut model = Model::new("path");
    let mut stops = vec![case.edges[edges[0]].0];
    stops.extend(edges.iter().map(|&edge| case.edges[edge].1));
    let (mut points, mut cost) = (Vec::new(), Quadratic::zero());
    for (k, &stop) in stops.iter().enumerate() {
        let vertex = &case.vertices[stop];
        let (c, r) = (vertex.0, vertex.1);
        let x = model.continuous(("x", k), c[0] - r, c[0] + r).unwrap();
        let y = model.continuous(("y", k), c[1] - r, c[1] + r).unwrap();
        let mut rows = Vec::new();
        let conic = say_set(vertex, &[x, y], |row| rows.push(row));
        for row in rows {
            model.add(("row", k), row).unwrap();
        }
        if let Some(conic) = conic {
            model.add(("disc", k), conic).unwrap();
        }
        cost += Quadratic::from(0.1 * (x - c[0]) + 0.05);
        points.push([x, y]);
    }
    for (k, &edge) in edges.iter().enumerate() {
        let d = [points[k][0] - points[k + 1][0], points[k][1] - points[k + 1][1]];
        model.add(("reach", k), norm(d.clone()).le(case.reach)).unwrap();
        match case.edges[edge].2 {
            Cost::Distance => {
                let length = model.continuous(("length", k), 0.0, 100.0).unwrap();
                model.add(("length", k), norm(d).le(length)).unwrap();
                cost += Quadratic::from(length);
            }
            Cost::SquaredDistance => cost += d[0].square() + d[1].square(),
            Cost::Slope(slope) => cost += Quadratic::from(slope * &d[0]),
        }
    }
    model.minimize(cost).unwrap();
    solver().solve(&model).unwrap().objective()
}

/// The least cost of all paths from the first vertex to the last.
fn enumerated(case: &Case) -> Option<f64> {
    fn extend(case: &Case, at: usize, path: &mut Vec<usize>, best: &mut Option<f64>) {
        if at + 1 == case.vertices.len() {
            let cost = cost_along(case, path);
            if let Some(cost) = cost {
                *best = Some(best.map_or(cost, |least| least.min(cost)));
            }
            return;
        }
        for (k, &(from, to, _)) in case.edges.iter().enumerate() {
            let is_seen = to == 0 || path.iter().any(|&edge| case.edges[edge].1 == to);
            if from == at && !is_seen {
                path.push(k);
                extend(case, to, path, best);
                path.pop();
            }
        }
    }
    let mut best = None;
    extend(case, 0, &mut Vec::new(), &mut best);
    best
}

proptest! {
    #![proptest_config(config(48, "tests/regressions/graph_of_sets.txt"))]

    #[test]
    fn the_shortest_path_is_the_best_of_all(case in case()) {
        let (graph, vertices) = graph(&case).unwrap();
        let found = graph.shortest_path(vertices[0], *vertices.last().unwrap(), &mut solver());
        let plain = graph.program(vertices[0], *vertices.last().unwrap());
        match enumerated(&case) {
            Some(least) => {
                let found = found.unwrap();
                prop_assert!((found.cost - least).abs() < 1e-4, "{} {least}", found.cost);
                prop_assert!(found.bound <= least + 1e-6, "{} {least}", found.bound);
                prop_assert!(found.bound >= least - 1e-3, "{} {least}", found.bound);
                // The program of all edges says the same.
                let plain = plain.unwrap().solve(&mut solver()).unwrap();
                prop_assert!((plain.cost - least).abs() < 1e-4, "{} {least}", plain.cost);
                prop_assert!(found.edges_left <= plain.edges_left);
                // The points are in their boxes, and edges connect them.
                for (stop, next) in found.stops.iter().zip(&found.edges) {
                    prop_assert_eq!(graph.ends(*next).unwrap()[0], stop.vertex);
                    let (centre, radius, _) = &case.vertices[stop.vertex.index()];
                    let inside = |k: usize| (stop.point[k] - centre[k]).abs() <= radius + 1e-9;
                    prop_assert!(inside(0) && inside(1));
                }
            }
            None => {
                let is_refused = matches!(found.unwrap_err().kind(), ErrorKind::NoPlan { .. });
                prop_assert!(is_refused);
            }
        }
    }
}

/// Squares around points of a line, with edges each way between neighbours.
fn line(count: usize) -> (GraphOfSets, Vec<GraphVertex>) {
    let mut graph = GraphOfSets::new("line");
    let vertices: Vec<GraphVertex> = (0..count)
        .map(|k| {
            let x = k as f64;
            graph.vertex(("v", k), &[x..=x + 0.5]).unwrap()
        })
        .collect();
    for pair in vertices.windows(2) {
        for edge in graph.edges_between(pair[0], pair[1]).unwrap() {
            let [a, b] = graph.ends(edge).unwrap();
            let (p, q) = (graph.point(a).unwrap(), graph.point(b).unwrap());
            graph.add_cost(edge, norm([p[0] - q[0]])).unwrap();
        }
    }
    (graph, vertices)
}

#[test]
fn cycles_that_pay_are_no_part_of_a_path() {
    let (mut graph, v) = line(3);
    // A triangle aside whose every edge pays.
    let ring: Vec<GraphVertex> =
        (0..3).map(|k| graph.vertex(("ring", k), &[0.0..=1.0]).unwrap()).collect();
    for k in 0..3 {
        let edge = graph.edge(ring[k], ring[(k + 1) % 3]).unwrap();
        graph.add_cost(edge, -1.0).unwrap();
    }
    let (inward, outward) =
        (graph.edge(v[0], ring[0]).unwrap(), graph.edge(ring[1], v[2]).unwrap());
    graph.add_cost(inward, 10.0).unwrap();
    graph.add_cost(outward, 10.0).unwrap();
    let searched = graph.shortest_path(v[0], v[2], &mut solver()).unwrap();
    let plain = graph.program(v[0], v[2]).unwrap().solve(&mut solver()).unwrap();
    for path in [searched, plain] {
        // From 0.5 to 2.
        assert!((path.cost - 1.5).abs() < 1e-5, "{}", path.cost);
        assert!(path.bound <= path.cost && path.bound > 1.5 - 1e-3, "{}", path.bound);
        let stops: Vec<GraphVertex> = path.stops.iter().map(|stop| stop.vertex).collect();
        assert_eq!(stops, v);
    }
}

#[test]
fn rows_about_the_whole_path_hold() {
    let mut graph = GraphOfSets::new("detour");
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let v: Vec<GraphVertex> = corners
        .iter()
        .enumerate()
        .map(|(k, c)| graph.vertex(("corner", k), &[c[0]..=c[0], c[1]..=c[1]]).unwrap())
        .collect();
    let mut lengths = Vec::new();
    for a in 0..4 {
        for b in (0..4).filter(|&b| b != a) {
            let edge = graph.edge(v[a], v[b]).unwrap();
            let (p, q) = (graph.point(v[a]).unwrap(), graph.point(v[b]).unwrap());
            graph.add_cost(edge, norm([p[0] - q[0], p[1] - q[1]])).unwrap();
            lengths.push((edge, p[0] - q[0]));
        }
    }
    assert!(
        (graph.shortest_path(v[0], v[2], &mut solver()).unwrap().cost - 2_f64.sqrt()).abs() < 1e-5
    );
    // All corners.
    let mut program = graph.program(v[0], v[2]).unwrap();
    for (k, &corner) in v.iter().enumerate() {
        let visits = program.visits(corner).unwrap();
        if k == 1 || k == 3 {
            program.add(("visit", k), visits.equals(1.0)).unwrap();
        }
    }
    let tour = program.solve(&mut solver()).unwrap();
    assert_eq!(tour.stops.len(), 4);
    assert!((tour.cost - (2.0 + 2_f64.sqrt())).abs() < 1e-5, "{}", tour.cost);
    // No edge goes right: the way is up first, and then there is none.
    let mut program = graph.program(v[0], v[2]).unwrap();
    let left: Affine =
        lengths.iter().map(|(edge, left)| program.at(*edge, left.clone()).unwrap()).sum();
    // Along every path the sum is -1.
    program.add("left", left.ge(-0.5)).unwrap();
    let error = program.solve(&mut solver()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NoPlan { .. }));
}

#[test]
fn a_single_edge_and_parallel_edges_are_paths() {
    let (mut graph, v) = line(2);
    let path = graph.shortest_path(v[0], v[1], &mut solver()).unwrap();
    assert!((path.cost - 0.5).abs() < 1e-5);
    let cheap = graph.edge(v[0], v[1]).unwrap();
    let (p, q) = (graph.point(v[0]).unwrap(), graph.point(v[1]).unwrap());
    graph.add_cost(cheap, (0.5 * q[0] - 0.5 * p[0]).square()).unwrap();
    let path = graph.shortest_path(v[0], v[1], &mut solver()).unwrap();
    assert_eq!(path.edges, [cheap]);
    assert!((path.cost - 0.0625).abs() < 1e-5, "{}", path.cost);
}

fn text<T: std::fmt::Debug>(result: Result<T, Error>) -> String {
    result.unwrap_err().to_string()
}

#[test]
fn slips_are_named() {
    let (mut graph, v) = line(3);
    let (other, w) = line(2);
    let p = graph.point(v[0]).unwrap();
    let q = graph.point(v[2]).unwrap();
    assert_eq!(
        text(graph.vertex("plain", &[0.0..=1.0, 0.0..=f64::INFINITY])),
        "coordinate 1 of the vertex `plain` has no upper bound; give it a finite one, since only bounded \
         sets can be switched off by perspectives"
    );
    assert_eq!(
        text(graph.vertex("crossed", &[1.0..=0.0])),
        "bounds of `crossed` are crossed: 1 > 0; swap or relax them"
    );
    assert_eq!(
        text(graph.vertex("v[0]", &[])),
        "the name `v[0]` is already taken by another vertex; choose another one"
    );
    assert_eq!(
        text(graph.edge(v[1], v[1])),
        "the vertex `v[1]` cannot stand in both ends of an edge; take two vertices, since a path visits \
         each once; give the end a copy of the set"
    );
    assert_eq!(
        text(graph.shortest_path(v[1], v[1], &mut solver())),
        "the vertex `v[1]` cannot stand in both ends of a path; take two vertices, since a path visits \
         each once; give the end a copy of the set"
    );
    assert_eq!(
        text(graph.add(v[0], (p[0] + q[0]).le(1.0))),
        "`v[2] 0` cannot stand in what is said of the vertex `v[0]`; a vertex takes its own coordinates, and \
         an edge those of its two ends"
    );
    let edge = graph.edge(v[0], v[1]).unwrap();
    assert_eq!(
        text(graph.add_cost(edge, norm([p[0] - q[0]]))),
        "`v[2] 0` cannot stand in what is said of the edge `v[0] to v[1] again 1`; a vertex takes its own \
         coordinates, and an edge those of its two ends"
    );
    assert!(text(graph.add_cost(edge, -p[0].square())).starts_with("the objective is not convex"));
    assert_eq!(
        text(graph.add_cost(edge, norm([f64::INFINITY * p[0]]))),
        "a coefficient of the cost of `v[0] to v[1] again 1` is inf; give a finite number"
    );
    assert!(text(graph.edge(v[0], w[1])).contains("vertex number 1 used in `an edge`"));
    assert!(text(other.point(v[2])).contains("belongs to another model"));
    assert!(text(other.shortest_path(v[0], v[1], &mut solver())).contains("belongs to another"));
    // Nothing that was refused is left behind.
    assert!(graph.shortest_path(v[0], v[2], &mut solver()).is_ok());
}

#[test]
fn no_path_is_an_error_with_the_reason() {
    let mut graph = GraphOfSets::new("apart");
    let v: Vec<GraphVertex> =
        (0..2).map(|k| graph.vertex(("v", k), &[0.0..=1.0]).unwrap()).collect();
    let expected = "the search ended without a plan (`infeasible`); no path of the graph satisfies its sets \
                    and edges; check them";
    assert_eq!(text(graph.shortest_path(v[0], v[1], &mut solver())), expected);
    assert_eq!(text(graph.program(v[0], v[1]).unwrap().solve(&mut solver())), expected);
    let edge = graph.edge(v[0], v[1]).unwrap();
    let (p, q) = (graph.point(v[0]).unwrap(), graph.point(v[1]).unwrap());
    graph.add(edge, (q[0] - p[0]).ge(2.0)).unwrap();
    assert_eq!(text(graph.shortest_path(v[0], v[1], &mut solver())), expected);
}

/// Discs with a radius at pseudo-random places of a square, with edges between those that are near.
fn islands(count: usize) -> (GraphOfSets, Vec<GraphVertex>) {
    let mut graph = GraphOfSets::new("islands");
    let mut state = 7_u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let places: Vec<[f64; 2]> = (0..count).map(|_| [draw(), draw()]).collect();
    let mut vertices = Vec::new();
    for (k, place) in places.iter().enumerate() {
        let ranges = place.map(|c| c - 0.08..=c + 0.08);
        let vertex = graph.vertex(("island", k), &ranges).unwrap();
        let p = graph.point(vertex).unwrap();
        graph.add(vertex, norm([p[0] - place[0], p[1] - place[1]]).le(0.08)).unwrap();
        vertices.push(vertex);
    }
    for (i, a) in places.iter().enumerate() {
        for (j, b) in places.iter().enumerate() {
            if i != j && (a[0] - b[0]).hypot(a[1] - b[1]) < 0.45 {
                let edge = graph.edge(vertices[i], vertices[j]).unwrap();
                let (p, q) = (graph.point(vertices[i]).unwrap(), graph.point(vertices[j]).unwrap());
                let d = [p[0] - q[0], p[1] - q[1]];
                graph.add(edge, norm(d.clone()).le(0.3)).unwrap();
                // Short hops are cheap.
                graph.add_cost(edge, d[0].square() + d[1].square()).unwrap();
                graph.add_cost(edge, norm(d)).unwrap();
            }
        }
    }
    (graph, vertices)
}

#[test]
fn pruning_leaves_few_edges_and_the_answer_of_the_whole_program() {
    let (graph, v) = islands(9);
    let found = graph.shortest_path(v[0], v[8], &mut solver()).unwrap();
    let plain = graph.program(v[0], v[8]).unwrap().solve(&mut solver()).unwrap();
    assert!((found.cost - plain.cost).abs() < 1e-4, "{} {}", found.cost, plain.cost);
    assert!(found.bound <= found.cost && found.bound > found.cost - 1e-3);
    assert!(2 * found.edges_left < plain.edges_left, "{} {}", found.edges_left, plain.edges_left);
}

#[test]
fn a_limit_keeps_the_best_path_and_a_bound() {
    use std::time::Duration;
    let (graph, v) = islands(9);
    let best = graph.shortest_path(v[0], v[8], &mut solver()).unwrap();
    for millis in [0, 1, 5, 20, 50, 100, 200] {
        let limit = Duration::from_millis(millis);
        let options = Options::default().with_threads(1).with_time_limit(limit);
        let mut limited = BranchAndBound::new(options);
        match graph.shortest_path(v[0], v[8], &mut limited) {
            Ok(found) => {
                assert!(found.bound <= best.cost + 1e-6 && found.cost >= best.cost - 1e-5);
            }
            Err(error) => assert!(matches!(error.kind(), ErrorKind::NoPlan { .. }), "{error}"),
        }
        assert_eq!(limited.options().time_limit, Some(limit));
    }
}
