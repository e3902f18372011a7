//! Convex sets in one to three dimensions: corners, extents of faces.

use std::f64::consts::TAU;

/// How far a corner may be outside a face, relative to the size of the set (no unit).
const NEAR: f64 = 1e-9;

/// A set that is more of its sizes away from the origin is looked at from nearby.
const FAR_OFF: f64 = 1024.0;

/// A half-space `normal . x <= limit`, with a normal of length 1.
pub(super) type Side = (Vec<f64>, f64);

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The length of a vector.
pub(super) fn length(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// The numbers with the other sign.
pub(super) fn minus(a: &[f64]) -> Vec<f64> {
    a.iter().map(|x| -x).collect()
}

/// The unit vector along an axis.
fn unit(axes: usize, axis: usize, sign: f64) -> Vec<f64> {
    (0..axes).map(|i| if i == axis { sign } else { 0.0 }).collect()
}

/// A box that holds all corners of a set, as sides.
pub(super) fn frame(sides: &[Side], axes: usize) -> Vec<Side> {
    let size = 1e3 * sides.iter().map(|(_, b)| b.abs()).fold(1.0, f64::max);
    (0..axes).flat_map(|i| [1.0, -1.0].map(|sign| (unit(axes, i, sign), size))).collect()
}

/// The corners of a set, each with the sides on which it lies. Of a set far from the origin they
/// are found about a corner of it.
pub(super) fn corners(sides: &[Side], axes: usize) -> Vec<(Vec<f64>, Vec<usize>)> {
    let size = |sides: &[Side]| sides.iter().map(|(_, b)| b.abs()).fold(0.0, f64::max);
    let first: Vec<usize> = (0..axes).collect();
    let (Some(one), true) = (meet_some(sides, axes), sides.len() >= axes) else {
        return corners_near(sides, &first);
    };
    let moved: Vec<Side> = sides.iter().map(|(n, b)| (n.clone(), b - dot(n, &one))).collect();
    if size(sides) <= FAR_OFF * size(&moved) {
        return corners_near(sides, &first);
    }
    let mut found = corners_near(&moved, &first);
    for (corner, _) in &mut found {
        corner.iter_mut().zip(&one).for_each(|(x, by)| *x += by);
    }
    found
}

/// A point at which some of the sides meet.
fn meet_some(sides: &[Side], axes: usize) -> Option<Vec<f64>> {
    let picks = (0..sides.len().saturating_sub(axes - 1)).map(|k| (k..k + axes).collect());
    let mut points = picks.filter_map(|pick: Vec<usize>| meet(sides, &pick));
    points.next()
}

fn corners_near(sides: &[Side], first: &[usize]) -> Vec<(Vec<f64>, Vec<usize>)> {
    let axes = first.len();
    let scale = sides.iter().map(|(_, b)| b.abs()).fold(1.0, f64::max);
    let mut found: Vec<(Vec<f64>, Vec<usize>)> = Vec::new();
    let mut pick: Vec<usize> = first.to_vec();
    if sides.len() < axes {
        return found;
    }
    loop {
        if let Some(x) = meet(sides, &pick) {
            let miss = |(n, b): &Side| dot(n, &x) - b;
            let known = |(y, _): &(Vec<f64>, Vec<usize>)| {
                y.iter().zip(&x).all(|(a, b)| (a - b).abs() <= NEAR * scale)
            };
            if sides.iter().all(|side| miss(side) <= NEAR * scale) && !found.iter().any(known) {
                let on = (0..sides.len()).filter(|&k| miss(&sides[k]).abs() <= NEAR * scale);
                let on = on.collect();
                found.push((x, on));
            }
        }
        // The next choice of sides.
        let Some(last) = (0..axes).rfind(|&i| pick[i] < sides.len() - axes + i) else {
            return found;
        };
        pick[last] += 1;
        for i in last + 1..axes {
            pick[i] = pick[i - 1] + 1;
        }
    }
}

/// Where as many sides as there are axes meet; `None` if that is not one point.
fn meet(sides: &[Side], pick: &[usize]) -> Option<Vec<f64>> {
    let n = pick.len();
    let mut rows: Vec<Vec<f64>> =
        pick.iter().map(|&k| sides[k].0.iter().copied().chain([sides[k].1]).collect()).collect();
    for column in 0..n {
        let pivot =
            (column..n).max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))?;
        if rows[pivot][column].abs() < 1e-9 {
            return None;
        }
        rows.swap(column, pivot);
        for row in 0..n {
            if row != column {
                let factor = rows[row][column] / rows[column][column];
                let own = rows[column].clone();
                rows[row].iter_mut().zip(&own).for_each(|(a, b)| *a -= factor * b);
            }
        }
    }
    Some((0..n).map(|i| rows[i][n] / rows[i][i]).collect())
}

/// Whether corners on a face span it: whether they are not all on a line in space, or one point in
/// the plane.
pub(super) fn spans(corners: &[&Vec<f64>], axes: usize) -> bool {
    let Some(first) = corners.first() else { return false };
    let edges: Vec<Vec<f64>> = corners[1..]
        .iter()
        .map(|corner| corner.iter().zip(first.iter()).map(|(a, b)| a - b).collect())
        .collect();
    let size = edges.iter().map(|e| dot(e, e)).fold(0.0, f64::max);
    match axes {
        1 => true,
        2 => size > 0.0,
        _ => edges.iter().any(|a| {
            edges.iter().any(|b| {
                let (aa, ab, bb) = (dot(a, a), dot(a, b), dot(b, b));
                aa * bb - ab * ab > 1e-12 * size * size
            })
        }),
    }
}

/// The prism over a face of a set: sides across the face, which hold the points that are in front
/// of or behind the face itself. Each names the two faces of which it is made, with the factor of
/// the face's own limit: `limit = (b_k - c b_face) / length`.
pub(super) struct Across {
    pub(super) normal: Vec<f64>,
    pub(super) other: usize,
    pub(super) own_factor: f64,
    pub(super) length: f64,
}

impl Across {
    /// The limit, given those of the faces.
    pub(super) fn limit(&self, face: usize, limits: &[f64]) -> f64 {
        (limits[self.other] - self.own_factor * limits[face]) / self.length
    }
}

/// The sides across a face, without those that others imply.
pub(super) fn across(sides: &[Side], face: usize) -> Vec<Across> {
    let (own, _) = &sides[face];
    let limits: Vec<f64> = sides.iter().map(|(_, b)| *b).collect();
    let mut kept: Vec<Across> = Vec::new();
    for (other, (normal, _)) in sides.iter().enumerate().filter(|(k, _)| *k != face) {
        let own_factor = dot(normal, own);
        let edge: Vec<f64> = normal.iter().zip(own).map(|(n, o)| n - own_factor * o).collect();
        let length = length(&edge);
        if length < 1e-9 {
            continue;
        }
        let tidy = |e: f64| if (e / length).abs() < 1e-14 { 0.0 } else { e / length };
        let normal: Vec<f64> = edge.into_iter().map(tidy).collect();
        let side = Across { normal, other, own_factor, length };
        let limit = side.limit(face, &limits);
        let same = |old: &Across| dot(&old.normal, &side.normal) > 1.0 - 1e-12;
        match kept.iter().position(same) {
            Some(k) if kept[k].limit(face, &limits) <= limit => {}
            Some(k) => kept[k] = side,
            None => kept.push(side),
        }
    }
    kept
}

/// The faces that each face meets at an acute angle, in an edge or a corner.
pub(super) fn sharp(sides: &[Side]) -> Vec<Vec<usize>> {
    let is_acute = |a: usize, b: usize| {
        let across = dot(&sides[a].0, &sides[b].0);
        across < -1e-9 && across > -1.0 + 1e-12
    };
    let count = sides.len();
    let acute: Vec<(usize, usize)> = (0..count)
        .flat_map(|a| (0..count).map(move |b| (a, b)))
        .filter(|&(a, b)| is_acute(a, b))
        .collect();
    let mut found = vec![Vec::new(); count];
    let Some((normal, _)) = sides.first().filter(|_| !acute.is_empty()) else { return found };
    let axes = normal.len();
    let framed: Vec<Side> = sides.iter().cloned().chain(frame(sides, axes)).collect();
    let corners = corners(&framed, axes);
    for (a, b) in acute {
        if corners.iter().any(|(_, on)| on.contains(&a) && on.contains(&b)) {
            found[a].push(b);
        }
    }
    found
}

/// Unit vectors along a face of a normal: one in the plane, the normal turned left; two in space.
pub(super) fn tangents(normal: &[f64]) -> Vec<Vec<f64>> {
    match normal {
        [x, y] => vec![vec![-y, *x]],
        [x, y, z] => {
            let axis = [x.abs(), y.abs(), z.abs()];
            let least = (0..3).min_by(|&a, &b| axis[a].total_cmp(&axis[b])).unwrap_or(0);
            let along = unit(3, least, 1.0);
            let part = dot(&along, normal);
            let first: Vec<f64> = along.iter().zip(normal).map(|(a, n)| a - part * n).collect();
            let length = length(&first);
            let first: Vec<f64> = first.into_iter().map(|a| a / length).collect();
            let second = vec![
                y * first[2] - z * first[1],
                z * first[0] - x * first[2],
                x * first[1] - y * first[0],
            ];
            vec![first, second]
        }
        _ => Vec::new(),
    }
}

/// Directions along a face: both in the plane, `count` in space, none on a line.
pub(super) fn around(normal: &[f64], count: usize) -> impl Iterator<Item = Vec<f64>> {
    let tangents = tangents(normal);
    let all: Vec<Vec<f64>> = match &tangents[..] {
        [one] => vec![one.clone(), one.iter().map(|t| -t).collect()],
        [one, two] => (0..count)
            .map(|k| {
                let (sin, cos) = (TAU * k as f64 / count as f64).sin_cos();
                one.iter().zip(two).map(|(a, b)| cos * a + sin * b).collect()
            })
            .collect(),
        _ => Vec::new(),
    };
    all.into_iter()
}
