//! Random models there and back, and random damage.

use carom::interval::Interval;
use carom::model::{Read, cbf};
use carom::prelude::*;
use proptest::prelude::*;

use super::{file, read};
use crate::common::config;
use crate::models::{number, pair};

/// The lower bound, the upper bound and whether it is an integer.
type VariablePlan = ((f64, f64), bool);

/// Linear models whose rows have two variables or more.
fn linear() -> impl Strategy<Value = Model> {
    let variables = prop::collection::vec((pair(true), any::<bool>()), 2..6);
    let numbers = prop::array::uniform3(number());
    let rows = prop::collection::vec((numbers, pair(false), 0..6_usize), 0..6);
    (variables, rows, any::<bool>(), number()).prop_map(|(variables, rows, maximize, constant)| {
        let mut model = Model::new("");
        let x: Vec<Variable> = add_variables(&mut model, &variables);
        for (k, ([a, b, c], (lower, upper), pick)) in rows.into_iter().enumerate() {
            let at = |k: usize| x[(pick + k) % x.len()];
            let row = a * at(0) + b * at(1) + c * at(2);
            // A row of one variable becomes a bound.
            if row.terms().len() > 1 {
                model.add(("c", k), row.within(lower, upper)).unwrap();
            }
        }
        let sense = if maximize { Sense::Maximize } else { Sense::Minimize };
        let objective = x.iter().zip([constant, -1.0, 0.1]).map(|(&x, a)| a * x).sum::<Affine>();
        model.set_objective(sense, objective + constant).unwrap();
        model
    })
}

fn add_variables(model: &mut Model, plan: &[VariablePlan]) -> Vec<Variable> {
    let added = plan.iter().enumerate().map(|(k, &((lower, upper), integer))| {
        match integer && (lower != 0.0 || upper > 1.0) {
            true => model.integer(("x", k), lower, upper).unwrap(),
            false => model.continuous(("x", k), lower, upper).unwrap(),
        }
    });
    added.collect()
}

/// Everything but names and signs of zeros, in the order of the model.
fn contents(model: &Model) -> (String, Vec<String>, Vec<String>) {
    let value = |number: f64| format!("{:?}", number + 0.0);
    let limits = |lower: f64, upper: f64| [value(lower), value(upper)].join(" to ");
    let variables = model.variables().map(|v| {
        let Interval { lower, upper } = v.bounds();
        format!("{} {}", limits(lower, upper), v.kind().is_integral())
    });
    let rows = model.constraints().map(|row| {
        let terms: Vec<String> =
            row.terms().iter().map(|&(v, a)| format!("{} {}", v.index(), value(a))).collect();
        format!("{} in {}", terms.join(", "), limits(row.limits().lower, row.limits().upper))
    });
    let terms = model.objective().affine().terms().into_iter();
    let terms: Vec<String> = terms.map(|(v, a)| format!("{} {}", v.index(), value(a))).collect();
    let objective = format!(
        "{:?} {} {}",
        model.sense(),
        terms.join(", "),
        value(model.objective().affine().offset())
    );
    (objective, variables.collect(), rows.collect())
}

proptest! {
    #![proptest_config(config(256, "tests/regressions/files.txt"))]

    #[test]
    fn round_trips_of_linear_models_are_exact(model in linear()) {
        let text = cbf::write(&model).unwrap();
        prop_assert_eq!(contents(&read(&text)), contents(&model), "{}", text);
    }

    #[test]
    fn damage_never_panics(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4_u8, any::<char>()), 1..4),
        words in prop::collection::vec(
            prop::sample::select(vec!["1e400", "-", "nan", "0", "7", "QR", "L+ 1\n", "CON", "1 "]),
            4,
        ),
    ) {
        let whole = file(
            "VAR; 7 3; L+ 2; QR 3; F 2; INT; 2; 0; 3; CON; 9 5; L+ 1; L- 1; Q 3; F 1; QR 3; OBJACOORD; 1; \
             0 1; OBJBCOORD; 2; ACOORD; 9; 0 0 2; 1 0 1; 1 1 3; 2 5 1; 3 6 2; 3 5 1; 6 5 1; 7 6 1; 8 0 4; \
             BCOORD; 3; 0 -1; 1 -9; 2 1.5",
        );
        let mut text: Vec<char> = whole.chars().collect();
        for ((place, edit, letter), word) in edits.into_iter().zip(words) {
            let place = place.index(text.len());
            match edit {
                0 => { text.remove(place); }
                1 => text[place] = letter,
                2 => text.insert(place, '\n'),
                _ => { text.splice(place..place, word.chars()); }
            }
        }
        let text: String = text.into_iter().collect();
        if let Ok(Read { model, .. }) = cbf::read(&text) {
            let again = read(&cbf::write(&model).unwrap());
            prop_assert_eq!(again.conic_constraint_count(), model.conic_constraint_count());
        }
    }
}
