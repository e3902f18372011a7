//! Numbers out of their ranges: the limits as numbers beside the words.

use std::ops::Bound::{Excluded, Included, Unbounded};

use carom::ErrorKind;
use carom::hybrid::{Restitution, ShortestOptions};
use carom::model::PiecewiseAffine;
use carom::prelude::*;

type Limits = (Option<f64>, Option<f64>);

/// The value and its limits.
fn numbers<T>(result: Result<T, Error>) -> (f64, Option<f64>, Option<f64>) {
    let Err(error) = result else { panic!("no error") };
    match error.kind() {
        ErrorKind::OutOfRange { value, lower, upper, .. } => (*value, *lower, *upper),
        other => panic!("{other:?}"),
    }
}

#[test]
fn limits_come_as_numbers() {
    assert_eq!(numbers(Restitution::new(1.5)), (1.5, Some(0.0), Some(1.0)));
    assert_eq!(numbers(PiecewiseAffine::new([(0.0, 1.0)])), (1.0, Some(2.0), None));
    // Ends that are excluded are limits, too, and words that say more change nothing.
    assert_eq!(numbers(HybridSystem::new(-0.5).check()), (-0.5, Some(0.0), None));
    let descending = PiecewiseAffine::new([(3.0, 1.0), (2.0, 1.0)]);
    assert_eq!(numbers(descending), (2.0, Some(3.0), None));
    assert_eq!(
        numbers(PiecewiseAffine::new([(f64::INFINITY, 1.0); 2])),
        (f64::INFINITY, None, None)
    );
    let options = Options::default().with_threads(0);
    assert_eq!(numbers(options.check()), (0.0, Some(1.0), Some(256.0)));

    let mut cart = HybridSystem::new(0.5);
    let x = cart.state("x", -9.0, 4.0).unwrap();
    let u = cart.input("u", -1.0, 1.0).unwrap();
    cart.mode("roll").unwrap().next([x.is(x + u)]).unwrap();
    let options = ShortestOptions::default();
    let solver = &mut BranchAndBound::default();
    let outside = cart.shortest_with([x.equals(5.0)], [x.equals(0.0)], &options, solver);
    assert_eq!(numbers(outside), (5.0, Some(-9.0), Some(4.0)));
    let program = cart.program(3).unwrap();
    assert_eq!(numbers(program.variable(x, 4)), (4.0, None, Some(3.0)));
    assert_eq!(numbers(program.variable(u, 3)), (3.0, None, Some(3.0)));
}

#[test]
fn words_are_made_from_limits() {
    let infinity = f64::INFINITY;
    let cases: [((_, _), &str, Limits); 12] = [
        ((Included(1.0), Unbounded), "at least 1", (Some(1.0), None)),
        ((Included(1.0), Included(infinity)), "at least 1", (Some(1.0), None)),
        ((Excluded(0.0), Unbounded), "above 0", (Some(0.0), None)),
        ((Unbounded, Included(2.5)), "at most 2.5", (None, Some(2.5))),
        ((Unbounded, Excluded(5.0)), "below 5", (None, Some(5.0))),
        ((Included(0.0), Included(1.0)), "within [0, 1]", (Some(0.0), Some(1.0))),
        ((Included(2.0), Included(2.0)), "2", (Some(2.0), Some(2.0))),
        ((Excluded(0.0), Excluded(infinity)), "finite and positive", (Some(0.0), None)),
        ((Included(0.0), Excluded(infinity)), "finite and at least 0", (Some(0.0), None)),
        ((Excluded(-infinity), Included(3.0)), "finite and at most 3", (None, Some(3.0))),
        ((Excluded(1.0), Excluded(2.0)), "above 1 and below 2", (Some(1.0), Some(2.0))),
        ((Excluded(-infinity), Excluded(infinity)), "finite", (None, None)),
    ];
    for (range, words, limits) in cases {
        let error = Error::out_of_range("the size", -1.0, range);
        assert_eq!(error.to_string(), format!("the size is -1; it must be {words}"));
        assert_eq!(numbers::<()>(Err(error)), (-1.0, limits.0, limits.1));
    }
}
