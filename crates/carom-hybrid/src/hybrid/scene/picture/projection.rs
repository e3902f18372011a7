//! Scenes in space, seen along an axis: from above, and from the side.

use super::plans::ScenePicture;
use super::view::moved;
use crate::hybrid::scene::axes::AXES;
use crate::hybrid::scene::body::Shape;
use crate::hybrid::scene::geometry::{Side, corners};
use crate::hybrid::scene::solid::Solid;
use crate::interval::Interval;

/// The axes that are seen, to the right and upward, and the one along which a scene is seen.
const VIEWS: [[usize; 3]; 2] = [[0, 1, 2], [0, 2, 1]];

/// Entries of normals below this are none (no unit).
const ALONG_THE_VIEW: f64 = 1e-9;

/// The picture from each side, in the plane of two axes, with the names of these. Positions and
/// velocities keep their third entry, so that speeds are those in space.
pub(super) fn views(picture: &ScenePicture) -> Vec<(ScenePicture, [&'static str; 2])> {
    let frame = frame(picture);
    VIEWS
        .iter()
        .map(|order| (seen(picture, order, &frame), [AXES[order[0]], AXES[order[1]]]))
        .collect()
}

fn seen(picture: &ScenePicture, order: &[usize; 3], frame: &[Side]) -> ScenePicture {
    let mut view = picture.clone();
    let place = |x: &mut Vec<f64>| {
        if x.len() == order.len() {
            *x = order.iter().map(|&i| x[i]).collect();
        }
    };
    for body in &mut view.scene.bodies {
        body.domain = order[..2].iter().map(|&i| body.domain[i]).collect();
        if let Shape::Box(half) = &mut body.shape {
            place(half);
        }
        if let Some(ranges) = body.goal.as_mut().and_then(|goal| goal.ranges.get_mut(..3)) {
            let own = order.map(|i| ranges[i]);
            ranges.copy_from_slice(&own);
        }
    }
    for plan in view.plans.iter_mut().map(|(_, plan)| plan) {
        for path in &mut plan.bodies {
            let rows = [&mut path.position, &mut path.velocity, &mut path.acceleration];
            rows.into_iter().flatten().for_each(place);
        }
        for hit in &mut plan.hits {
            [&mut hit.place, &mut hit.impulse].into_iter().for_each(place);
        }
    }
    let solids = picture.scene.obstacles.iter();
    view.scene.obstacles = solids.filter_map(|solid| shadow(solid, order, frame)).collect();
    view
}

/// The shadow of an obstacle; `None` where it covers everything, as that of a floor from above.
fn shadow(solid: &Solid, order: &[usize; 3], frame: &[Side]) -> Option<Solid> {
    let covers = |normal: &[f64]| order[..2].iter().all(|&i| normal[i].abs() < ALONG_THE_VIEW);
    if solid.faces.iter().all(|face| covers(&face.normal)) {
        return None;
    }
    let corners = corners(&[moved(solid, 0, 3), frame.to_vec()].concat(), 3);
    let points = corners.into_iter().map(|(x, _)| [x[order[0]], x[order[1]]]);
    let sides = sides_of(hull(points.collect()));
    let bounces = |solid: &Solid| {
        let bouncing = solid.faces.iter().find(|face| face.surface.restitution.is_some());
        bouncing.or(solid.faces.first()).map(|face| face.surface)
    };
    let mut shadow = Solid::polytope(solid.name.as_str(), sides, bounces(solid)?);
    // Sides are where the obstacle is at first.
    let first = solid.displacement(0, 3);
    let displaced = |x: &Vec<f64>| order[..2].iter().map(|&i| x[i] - first[i]).collect();
    shadow.course = solid.course.iter().map(displaced).collect();
    (shadow.faces.len() > 2).then_some(shadow)
}

/// A box that holds the domains of the bodies and their paths.
fn frame(picture: &ScenePicture) -> Vec<Side> {
    let axis = |i: usize| {
        let paths = picture.plans.iter().flat_map(|(_, plan)| &plan.bodies);
        let places = paths.flat_map(|path| &path.position).map(|x| Interval::point(x[i]));
        let all = places.reduce(|a, b| a.hull(b)).unwrap_or(Interval::point(0.0));
        let room = all.width() + picture.unit;
        let near = Interval::new(all.lower - room, all.upper + room);
        let domains = picture.scene.bodies.iter().map(|body| body.domain[i]);
        let domain = domains.reduce(|a, b| a.hull(b)).unwrap_or(near);
        let of = |end: f64, other: f64| if end.is_finite() { end } else { other };
        Interval::new(of(domain.lower, near.lower), of(domain.upper, near.upper))
    };
    let unit = |i: usize, sign: f64| (0..3).map(|j| if i == j { sign } else { 0.0 }).collect();
    let sides =
        (0..3).flat_map(|i| [(unit(i, 1.0), axis(i).upper), (unit(i, -1.0), -axis(i).lower)]);
    sides.collect()
}

/// The corners of the convex hull of points, counterclockwise (A. M. Andrew, "Another efficient
/// algorithm for convex hulls in two dimensions", Information Processing Letters 9(5), 1979).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turn = |o: &[f64; 2], a: &[f64; 2], b: &[f64; 2]| {
        (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
    };
    let half = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while chain.len() > 1
                && turn(&chain[chain.len() - 2], &chain[chain.len() - 1], point) <= 0.0
            {
                chain.pop();
            }
            chain.push(*point);
        }
        chain.pop();
        chain
    };
    let (below, above) = (half(&mut points.iter()), half(&mut points.iter().rev()));
    [below, above].concat()
}

/// The sides of a polygon whose corners are counterclockwise.
fn sides_of(corners: Vec<[f64; 2]>) -> Vec<Side> {
    let next = corners.iter().cycle().skip(1);
    let sides = corners.iter().zip(next).filter_map(|(a, b)| {
        let (x, y) = (b[1] - a[1], a[0] - b[0]);
        let length = x.hypot(y);
        let normal = [x / length, y / length];
        (length > 0.0).then(|| (normal.to_vec(), normal[0] * a[0] + normal[1] * a[1]))
    });
    sides.collect()
}
