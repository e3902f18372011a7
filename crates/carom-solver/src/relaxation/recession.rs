//! Recession directions: proof that a program has no finite optimum.
//!
//! A program may fall for ever along no ray: `x` under `x^2 <= y` along a parabola only, whose
//! direction far out is that of `y`, which costs nothing. So there are two steps: a ray `r` that
//! costs nothing and along which such heads grow, and a ray `d` of descent of the program without
//! the cones, rows and bounds that `r` leaves ever more room. The curve `s d + s^2 r` keeps them
//! all, and the objective falls along it.

use crate::presolve::{Compressed, ConeEntry, FIXED, Reduced, ReducedCone};
use crate::tolerance::{self, largest_magnitude};

/// The largest violation of a row by a ray, relative to the row's largest term along it (no unit).
const ROW_TOLERANCE: f64 = 1e-8;

/// The size of an entry of a ray, relative to its largest one, up to which it may be rounding (no
/// unit).
const RAY_ROUNDING: f64 = 1e-9;

/// The entry of a ray at a bound, or its miss of a cone, that may be rounding (no unit).
const RAY_TOLERANCE: f64 = 1e-7;

/// The curvature along a ray that may be rounding, relative to its terms (no unit). An error of the
/// ray enters squared.
const CURVATURE_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The program whose solutions are the steepest recession directions: the rows, bounds and cones
/// without their constants, no curvature along the way, every entry within `[-1, 1]`. Nothing when
/// the box leaves no direction.
pub(super) fn recession_program(program: &Reduced) -> Option<Reduced> {
    let n = program.columns.len();
    let cone = |limit: &f64| if limit.is_finite() { 0.0 } else { *limit };
    let side = |bound: &f64| if bound.is_finite() { 0.0 } else { bound.signum() };
    let mut directions = Reduced {
        columns: (0..n).collect(),
        values: vec![0.0; n],
        slack: vec![0.0; n],
        quadratic: Compressed { start: vec![0; n + 1], ..Compressed::default() },
        linear: program.linear.clone(),
        offset: 0.0,
        rows: program.rows.clone(),
        merged: Vec::new(),
        origin: Vec::new(),
        row_lower: program.row_lower.iter().map(cone).collect(),
        row_upper: program.row_upper.iter().map(cone).collect(),
        lower: program.lower.iter().map(side).collect(),
        upper: program.upper.iter().map(side).collect(),
        steepness: Vec::new(),
        cones: Vec::new(),
        is_cut_off: false,
        wants_vertex: false,
        spread: program.spread,
    };
    if directions.lower.iter().chain(&directions.upper).all(|&bound| bound == 0.0) {
        return None;
    }
    program.cones.iter().for_each(|cone| directions.add_directions(cone));
    let mut curvature = vec![Vec::new(); n];
    for j in 0..n {
        let (rows, entries) = program.quadratic.vector(j);
        for (&i, &p) in rows.iter().zip(entries) {
            curvature[i].push((j, p));
            if i != j {
                curvature[j].push((i, p));
            }
        }
    }
    for row in curvature.iter().filter(|row| !row.is_empty()) {
        directions.rows.index.extend(row.iter().map(|(j, _)| j));
        directions.rows.value.extend(row.iter().map(|(_, p)| p));
        directions.rows.start.push(directions.rows.index.len());
        directions.row_lower.push(0.0);
        directions.row_upper.push(0.0);
    }
    Some(directions)
}

/// The program whose solutions are recession directions without cost along which the free heads of
/// rotated cones grow, where the other head is fixed; `None` if there are no such cones.
pub(super) fn growth_program(program: &Reduced) -> Option<Reduced> {
    let mut directions = recession_program(program)?;
    directions.rows.push(program.linear.iter().copied().enumerate().filter(|(_, q)| *q != 0.0));
    directions.row_lower.push(f64::NEG_INFINITY);
    directions.row_upper.push(0.0);
    directions.linear.fill(0.0);
    for head in program.cones.iter().filter_map(growing_head) {
        directions.linear[head] = -1.0;
    }
    directions.linear.iter().any(|q| *q != 0.0).then_some(directions)
}

/// The free head of a rotated cone whose other head is fixed, and not at 0.
fn growing_head(cone: &ReducedCone) -> Option<usize> {
    match cone.head() {
        [free, fixed] | [fixed, free] if fixed.is_fixed() && !free.is_fixed() => {
            (fixed.value > 0.0).then_some(free.place)
        }
        _ => None,
    }
}

/// The program without the cones, and the sides of rows and bounds, that a ray leaves ever more
/// room; `None` if the ray does not stay in the program, or if it relaxes no cone.
pub(super) fn relaxed_along(program: &Reduced, ray: &[f64]) -> Option<Reduced> {
    /// The part of the largest entry of a ray beyond which an entry or a row grows.
    const GROWS: f64 = 1e-3;
    let size = largest_magnitude(ray);
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let ray: Vec<f64> = ray.iter().map(|v| v / size).collect();
    let costs = program.linear.iter().zip(&ray).map(|(q, d)| q * d);
    let (cost, scale) = costs.fold((0.0, 1.0_f64), |(sum, most), q| (sum + q, most.max(q.abs())));
    if cost > RAY_TOLERANCE * scale || !stays(program, &ray) {
        return None;
    }
    let mut relaxed = program.clone();
    let grows = |cone: &ReducedCone| growing_head(cone).is_some_and(|head| ray[head] > GROWS);
    relaxed.cones.retain(|cone| !grows(cone));
    for (j, &d) in ray.iter().enumerate() {
        if d > GROWS {
            relaxed.lower[j] = f64::NEG_INFINITY;
        } else if d < -GROWS {
            relaxed.upper[j] = f64::INFINITY;
        }
    }
    for i in 0..program.rows.len() {
        let (columns, values) = program.rows.vector(i);
        let terms = || columns.iter().zip(values).map(|(&j, &a)| a * ray[j]);
        let largest = largest_magnitude(terms());
        let change: f64 = terms().sum();
        if change > GROWS * largest {
            relaxed.row_lower[i] = f64::NEG_INFINITY;
        } else if change < -GROWS * largest {
            relaxed.row_upper[i] = f64::INFINITY;
        }
    }
    (relaxed.cones.len() < program.cones.len()).then_some(relaxed)
}

impl Reduced {
    /// Adds the directions in which a cone of another program goes on for ever. As bounds, if a
    /// fixed head leaves none but `tail = 0`: such a cone has no interior, which methods need.
    fn add_directions(&mut self, cone: &ReducedCone) {
        if cone.head().iter().any(ConeEntry::is_fixed) {
            for entry in cone.tail().iter().filter(|entry| !entry.is_fixed()) {
                (self.lower[entry.place], self.upper[entry.place]) = (0.0, 0.0);
            }
            for entry in cone.head().iter().filter(|entry| !entry.is_fixed()) {
                self.lower[entry.place] = 0.0;
            }
            return;
        }
        let along = |entry: &ConeEntry| ConeEntry { column: entry.place, value: 0.0, ..*entry };
        let mut cone = cone.clone();
        cone.entries = cone.entries.iter().map(along).collect();
        self.cones.push(cone);
    }
}

/// Whether `ray` is a direction along which the reduced program stays feasible and its objective
/// falls without limit.
pub(super) fn is_descent_ray(program: &Reduced, ray: &[f64]) -> bool {
    let size = largest_magnitude(ray);
    if !(size > 0.0 && size.is_finite()) {
        return false;
    }
    let mut d: Vec<f64> = ray.iter().map(|v| v / size).collect();
    if !keeps_bounds(program, &d) {
        return false;
    }
    d.iter_mut().enumerate().filter(|(j, d)| is_held(program, *j, **d)).for_each(|(_, d)| *d = 0.0);
    // Of columns that hardly move, a fall may be rounding, and curvature would end it early. Those
    // costs count as a rise, because the others may be the price of what moves.
    let moves = |d: f64| if d.abs() > 10.0 * RAY_ROUNDING { d } else { 0.0 };
    let of_column = |(q, &d): (&f64, &f64)| if moves(d) == 0.0 { (q * d).abs() } else { q * d };
    let costs = || program.linear.iter().zip(&d).map(of_column);
    let cost: f64 = costs().sum();
    let cost_scale = largest_magnitude(costs());
    // A cone that the ray misses by a tolerance costs what its head must grow by.
    let mended: f64 = program.cones.iter().map(|cone| mending_cost(program, cone, &d)).sum();
    let fall = cost + mended;
    if fall.is_nan() || fall >= -1e-6 * cost_scale {
        return false;
    }
    // The least curvature ends the fall somewhere, however far out.
    let is_steep = |(s, &d): (&f64, &f64)| *s > 0.0 && moves(d) != 0.0;
    if program.steepness.iter().zip(&d).any(is_steep) {
        return false;
    }
    // The objective falls up to the radius for which bounds are proved, and the curvature along the
    // ray is rounding.
    let (mut curved, mut bent, mut bends) = (vec![0.0; d.len()], 0.0, 0.0);
    for j in 0..d.len() {
        let (rows, entries) = program.quadratic.vector(j);
        for (&i, &p) in rows.iter().zip(entries) {
            curved[i] += p * d[j];
            if i != j {
                curved[j] += p * d[i];
            }
            let term = p * moves(d[i]) * moves(d[j]);
            bent += if i == j { term } else { 2.0 * term };
            bends += term.abs();
        }
    }
    let bend: f64 = curved.iter().zip(&d).map(|(c, d)| c * d).sum();
    let flat = bent <= CURVATURE_ROUNDING * bends
        && bend * tolerance::FREE_RADIUS <= -cost
        && curved.iter().all(|c| c.abs() <= RAY_TOLERANCE * cost_scale.max(1.0));
    flat && keeps_rows(program, &d)
}

/// Whether a bound ends the movement of a column along its entry of a ray.
fn is_held(program: &Reduced, j: usize, d: f64) -> bool {
    let side = if d > 0.0 { program.upper[j] } else { program.lower[j] };
    side.is_finite()
}

/// Whether no bound is left along a ray whose largest entry is 1.
fn keeps_bounds(program: &Reduced, d: &[f64]) -> bool {
    d.iter().enumerate().all(|(j, &d)| !is_held(program, j, d) || d.abs() <= RAY_TOLERANCE)
}

/// Whether a ray, whose largest entry is 1, stays in the program, and costs no curvature.
fn stays(program: &Reduced, d: &[f64]) -> bool {
    let is_flat = (0..d.len()).all(|j| {
        let (rows, entries) = program.quadratic.vector(j);
        let moves = |k: usize| d[k].abs() > 10.0 * RAY_ROUNDING;
        rows.iter().zip(entries).all(|(&i, &p)| p == 0.0 || !(moves(i) || moves(j)))
    });
    is_flat && keeps_bounds(program, d) && keeps_rows(program, d)
}

/// Whether rows and cones stay satisfied along a ray whose largest entry is 1.
fn keeps_rows(program: &Reduced, d: &[f64]) -> bool {
    let rows = (0..program.rows.len()).all(|i| {
        let (columns, values) = program.rows.vector(i);
        let terms = || columns.iter().zip(values).map(|(&j, &a)| a * d[j]);
        let change: f64 = terms().sum();
        let largest = |m: f64, v: f64| m.max(v.abs());
        let slack = ROW_TOLERANCE * terms().fold(0.0, largest)
            + RAY_ROUNDING * values.iter().copied().fold(0.0, largest);
        (change <= slack || program.row_upper[i].is_infinite())
            && (change >= -slack || program.row_lower[i].is_infinite())
    });
    let inside = |cone: &ReducedCone| {
        let along = along(cone, d);
        along.miss(&[]) <= RAY_TOLERANCE && along.head().iter().all(|e| e.value >= -RAY_TOLERANCE)
    };
    rows && program.cones.iter().all(inside)
}

/// A cone with a direction in the place of the point.
fn along(cone: &ReducedCone, d: &[f64]) -> ReducedCone {
    let at = |entry: &ConeEntry| if entry.is_fixed() { 0.0 } else { d[entry.place] };
    let mut along = cone.clone();
    along.entries.iter_mut().for_each(|entry| (entry.value, entry.place) = (at(entry), FIXED));
    along
}

/// The cost of raising the head of a cone by as much as a direction misses it.
fn mending_cost(program: &Reduced, cone: &ReducedCone, d: &[f64]) -> f64 {
    let miss = along(cone, d).miss(&[]).max(0.0);
    let costs = cone.head().iter().filter(|entry| !entry.is_fixed());
    let most = costs.fold(0.0_f64, |most, entry| most.max(program.linear[entry.place].abs()));
    // Of a rotated cone, one factor grows by twice the miss.
    2.0 * most * miss
}
