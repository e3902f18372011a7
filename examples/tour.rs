//! The shortest tour of a drone over some way-points, with the rows against subtours found on the
//! way.
//!
//! Two flights at every way-point allow several small tours instead of one. There are too many rows
//! against that to write down, so they are lazy constraints: a callback sees each candidate, and
//! returns the rows that it violates.
//!
//! `cargo run --release --example tour`

use carom::prelude::*;
use carom::solution::Point;

const PLACES: [(f64, f64); 20] = [
    (0.5, 1.1),
    (0.7, 1.2),
    (1.3, 0.1),
    (0.0, 1.7),
    (1.0, 7.5),
    (2.5, 7.9),
    (2.2, 8.0),
    (1.8, 7.3),
    (8.3, 2.2),
    (8.0, 2.0),
    (8.3, 0.6),
    (8.5, 1.7),
    (8.1, 7.6),
    (9.2, 8.4),
    (8.9, 9.3),
    (8.9, 9.3),
    (4.8, 5.6),
    (4.9, 5.9),
    (5.8, 4.2),
    (4.3, 4.4),
];

/// The way-points that each one is connected with, by the first of them.
fn parts(flights: &[(usize, usize, Variable)], point: &Point) -> Result<Vec<usize>, Error> {
    let mut part: Vec<usize> = (0..PLACES.len()).collect();
    for &(a, b, flown) in flights {
        if point.is_on(flown)? {
            let (kept, gone) = (part[a].min(part[b]), part[a].max(part[b]));
            part.iter_mut().filter(|p| **p == gone).for_each(|p| *p = kept);
        }
    }
    Ok(part)
}

fn main() -> Result<(), Error> {
    let mut model = Model::new("tour");
    let mut flights = Vec::new();
    let mut length = Affine::zero();
    for (a, (ax, ay)) in PLACES.into_iter().enumerate() {
        for (b, (bx, by)) in PLACES.into_iter().enumerate().skip(a + 1) {
            let flown = model.binary(format!("flight {a} {b}"))?;
            length += (ax - bx).hypot(ay - by) * flown;
            flights.push((a, b, flown));
        }
    }
    for place in 0..PLACES.len() {
        let here = flights.iter().filter(|(a, b, _)| *a == place || *b == place);
        let degree: Affine = here.map(|(_, _, flown)| 1.0 * *flown).sum();
        model.add(("way-point", place), degree.equals(2.0))?;
    }
    model.minimize(&length)?;

    // Every part that is not all must be left, and entered again.
    let subtours = |point: &Point| {
        let part = parts(&flights, point)?;
        let mut rows = Vec::new();
        for first in (1..PLACES.len()).filter(|&place| part[place] == place) {
            let inside = |place: usize| part[place] == first;
            let leaving = flights.iter().filter(|(a, b, _)| inside(*a) != inside(*b));
            let leaving: Affine = leaving.map(|(_, _, flown)| 1.0 * *flown).sum();
            rows.push(leaving.ge(2.0));
        }
        Ok(rows)
    };
    let mut control = Control::default().with_lazy_constraints(&subtours);
    let solution = BranchAndBound::default().solve_with(&model, &mut control)?;

    let mut tour = vec![0];
    let mut left: Vec<_> = flights;
    for _ in 1..PLACES.len() {
        let here = tour[tour.len() - 1];
        let mut next = None;
        for (k, &(a, b, flown)) in left.iter().enumerate() {
            if (a == here || b == here) && solution.is_on(flown)? {
                next = Some((k, a + b - here));
            }
        }
        let Some((k, place)) = next else { break };
        left.remove(k);
        tour.push(place);
    }
    println!("tour {tour:?}");
    println!(
        "length {:.3}, {}, {} rows against subtours, {} nodes",
        solution.value(&length)?,
        solution.termination(),
        solution.statistics().lazy_constraints,
        solution.statistics().nodes
    );
    Ok(())
}
