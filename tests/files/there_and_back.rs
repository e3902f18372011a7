//! What is read is written, and read again the same, to the last bit. Also for `fuzz`.

use carom::interval::Interval;
use carom::model::{Model, Variable, VariableRef, cbf, lp, mps, nl};

/// Writes a model as LP, as MPS, as CBF and as NL, where these can hold it, and compares what is read
/// back. Norms become quadratic rows, so then it is the texts that are compared. Files have no
/// parameters, only fixed variables, no bounds of semi-continuous variables beside those of their
/// values, and no white space around the model's name.
#[allow(dead_code)] // not everybody who includes this file wants all of it
pub(crate) fn through_files(model: &Model) {
    let is_lost = |variable: VariableRef<'_>| {
        let bits = |(lower, upper): (f64, f64)| (lower.to_bits(), upper.to_bits());
        let hull = |Interval { lower, upper }| {
            (if lower > 0.0 { 0.0 } else { lower }, if upper < 0.0 { 0.0 } else { upper })
        };
        let own = (variable.bounds().lower, variable.bounds().upper);
        let narrowed = variable.semicontinuous().is_some_and(|v| bits(hull(v)) != bits(own));
        narrowed || variable.parameter_range().is_some()
    };
    if model.variables().any(is_lost) || model.name() != model.name().trim() {
        return;
    }
    if let Ok(text) = lp::write(model) {
        let again = lp::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}")).model;
        assert_eq!(lp::write(&again).unwrap(), text);
        if !model.to_string().contains("|(") {
            assert_same(model, &again);
        }
    }
    if let Ok(text) = mps::write(model) {
        let again = mps::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}")).model;
        assert_eq!(mps::write(&again).unwrap(), text);
        if !model.to_string().contains("|(") {
            assert_same(model, &again);
        }
    }
    if let Ok(text) = cbf::write(model) {
        let again = cbf::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}")).model;
        assert_eq!(again.sense(), model.sense());
    }
    if let Ok(text) = nl::write(model) {
        let again = nl::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}")).model;
        assert!(again.variable_count() >= model.variable_count());
        // A function becomes a row, which is read as a function of its own.
        if again.function_count() > 0 {
            return;
        }
        // Columns have their order, and integers within [0, 1] are binaries, only now.
        let text = nl::write(&again).unwrap();
        let again = nl::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}")).model;
        assert_eq!(nl::write(&again).unwrap(), text);
    }
}

/// Text and every number to the last bit.
pub(crate) fn assert_same(left: &Model, right: &Model) {
    assert_eq!(left.to_string(), right.to_string());
    assert_eq!(left.name(), right.name());
    let bits =
        |interval: carom::interval::Interval| (interval.lower.to_bits(), interval.upper.to_bits());
    for (a, b) in left.variables().zip(right.variables()) {
        assert_eq!((a.name(), a.kind()), (b.name(), b.kind()));
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
    for (a, b) in left.variables().zip(right.variables()) {
        let values = [&a, &b].map(|v| v.semicontinuous().map(bits));
        assert_eq!(values[0], values[1], "{}", a.name());
    }
    for (a, b) in left.special_ordered_sets().zip(right.special_ordered_sets()) {
        assert_eq!((a.name(), a.most()), (b.name(), b.most()));
        assert_eq!(terms(a.members()), terms(b.members()), "{}", a.name());
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
