//! Models made from bytes, to text and back.

#![no_main]

#[path = "../../tests/files/there_and_back.rs"]
mod there_and_back;

use carom::model::{Either, Term, at_most, either, sos1, sos2};
use carom::prelude::*;
use libfuzzer_sys::arbitrary::{self, Unstructured};
use libfuzzer_sys::fuzz_target;

/// Most variables and statements of a model.
const MOST: usize = 8;

fn number(bytes: &mut Unstructured<'_>) -> arbitrary::Result<f64> {
    const AWKWARD: [f64; 8] = [-0.0, 5e-324, 1e-300, 9.9e19, 1e20, 0.1, f64::INFINITY, f64::NAN];
    Ok(match bytes.int_in_range(0..=9_u8)? {
        0 => *bytes.choose(&AWKWARD)?,
        1 => bytes.arbitrary()?,
        2 => -*bytes.choose(&AWKWARD)?,
        _ => f64::from(bytes.arbitrary::<i16>()?) / 8.0,
    })
}

fn name(bytes: &mut Unstructured<'_>) -> arbitrary::Result<String> {
    const WORDS: [&str; 8] = ["x", "free", "Constant", "RHS", "two words", "x[3]", "a%20", "end"];
    match bytes.ratio(1, 3)? {
        true => Ok((*bytes.choose(&WORDS)?).to_owned()),
        false => {
            let length = bytes.int_in_range(1..=6)?;
            (0..length).map(|_| Ok(char::from(bytes.int_in_range(b' '..=b'~')?))).collect()
        }
    }
}

fn expression(bytes: &mut Unstructured<'_>, variables: &[Variable]) -> arbitrary::Result<Affine> {
    let mut sum = Affine::constant(number(bytes)?);
    for _ in 0..bytes.int_in_range(0..=3)? {
        sum.add_term(number(bytes)?, *bytes.choose(variables)?);
    }
    Ok(sum)
}

fn row(bytes: &mut Unstructured<'_>, variables: &[Variable]) -> arbitrary::Result<Row> {
    let e = expression(bytes, variables)?;
    Ok(match bytes.int_in_range(0..=3_u8)? {
        0 => e.le(number(bytes)?),
        1 => e.ge(number(bytes)?),
        2 => e.equals(number(bytes)?),
        _ => e.within(number(bytes)?, number(bytes)?),
    })
}

/// A model of what its methods accept; what they refuse is left out.
fn model(bytes: &mut Unstructured<'_>) -> arbitrary::Result<Option<Model>> {
    let mut model = Model::new(name(bytes)?);
    for _ in 0..bytes.int_in_range(1..=MOST)? {
        let (name, low, high) = (name(bytes)?, number(bytes)?, number(bytes)?);
        let _ = match bytes.int_in_range(0..=5_u8)? {
            0 => model.binary(name),
            1 => model.integer(name, low, high),
            2 => model.semicontinuous(name, low, high),
            3 => model.semiinteger(name, low, high),
            4 => model.parameter(name, low, low, high),
            _ => model.continuous(name, low, high),
        };
    }
    let all: Vec<Variable> = model.variables().map(|variable| variable.id()).collect();
    if all.is_empty() {
        return Ok(None);
    }
    for _ in 0..bytes.int_in_range(0..=MOST)? {
        let (name, row) = (name(bytes)?, row(bytes, &all)?);
        let (a, b, c) = (*bytes.choose(&all)?, *bytes.choose(&all)?, *bytes.choose(&all)?);
        let weights = [number(bytes)?, number(bytes)?, number(bytes)?];
        let members = [a, b, c].into_iter().zip(weights);
        match bytes.int_in_range(0..=8_u8)? {
            0 => _ = model.add(name, a.on().implies(row)),
            1 => _ = model.add(name, a.off().implies(row)),
            2 => _ = model.add(name, sos1(members)),
            3 => _ = model.add(name, sos2(members)),
            4 => _ = model.add(name, (a & !b).implies(row)),
            5 => _ = model.add(name, at_most(1, [a, b, c])),
            6 => _ = model.add(name, either(row).or(Either::of([Term::default()]))),
            _ => _ = model.add(name, row),
        }
    }
    let mut cost = Quadratic::from(expression(bytes, &all)?);
    for _ in 0..bytes.int_in_range(0..=3)? {
        cost += number(bytes)? * expression(bytes, &all)?.square();
    }
    let _ = if bytes.arbitrary()? { model.minimize(cost) } else { model.maximize(cost) };
    Ok(Some(model))
}

fuzz_target!(|bytes: &[u8]| {
    let Ok(Some(model)) = model(&mut Unstructured::new(bytes)) else { return };
    there_and_back::through_files(&model);
    let text = serde_json::to_string(&model).expect("a model can be written");
    let again = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    there_and_back::assert_same(&model, &again);
    if let Ok(lowered) = carom::reformulate::lower(&model) {
        there_and_back::through_files(lowered.model());
    }
});
