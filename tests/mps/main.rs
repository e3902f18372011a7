//! MPS files: what each section means, what damaged files say, and exact round trips.

mod damaged;
mod random;
mod sections;
mod written;

use carom::model::mps;
use carom::prelude::*;

fn read(text: &str) -> Model {
    mps::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn error(text: &str) -> String {
    match mps::read(text) {
        Ok(model) => panic!("was read:\n{model}"),
        Err(error) => error.to_string(),
    }
}

/// A file with one objective row, rows of all kinds and the columns `x`, `y` (continuous) and `k`
/// (integer), followed by the given sections.
fn with(sections: &str) -> String {
    format!(
        "NAME small\nROWS\n N cost\n L most\n G least\n E same\nCOLUMNS\n x cost 1 most 1\n \
         x least 1\n y most 2 same 1\n M1 'MARKER' 'INTORG'\n k cost -1 least 3\n \
         M2 'MARKER' 'INTEND'\n{sections}ENDATA\n"
    )
}

/// Text and every number to the last bit.
fn assert_same(left: &Model, right: &Model) {
    assert_eq!(left.to_string(), right.to_string());
    assert_eq!(left.name(), right.name());
    let bits =
        |interval: carom::interval::Interval| (interval.lower.to_bits(), interval.upper.to_bits());
    for (a, b) in left.variables().zip(right.variables()) {
        assert_eq!(bits(a.bounds()), bits(b.bounds()), "{}", a.name());
    }
    let terms = |terms: &[(Variable, f64)]| -> Vec<(usize, u64)> {
        terms.iter().map(|(v, a)| (v.index(), a.to_bits())).collect()
    };
    for (a, b) in left.constraints().zip(right.constraints()) {
        assert_eq!(bits(a.limits()), bits(b.limits()), "{}", a.name());
        assert_eq!(terms(a.terms()), terms(b.terms()), "{}", a.name());
    }
    for (a, b) in left.indicators().zip(right.indicators()) {
        assert_eq!(bits(a.limits()), bits(b.limits()), "{}", a.name());
        assert_eq!(terms(a.terms()), terms(b.terms()), "{}", a.name());
    }
    let (a, b) = (left.objective(), right.objective());
    assert_eq!(terms(&a.affine().terms()), terms(&b.affine().terms()));
    assert_eq!(a.affine().offset().to_bits(), b.affine().offset().to_bits());
    let products = |model: &Model| -> Vec<(usize, usize, u64)> {
        let products = model.objective().products();
        products.iter().map(|(a, b, q)| (a.index(), b.index(), q.to_bits())).collect()
    };
    assert_eq!(products(left), products(right));
}
