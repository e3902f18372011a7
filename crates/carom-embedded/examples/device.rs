//! Look-ups as on a device, whose assembly shows that nothing panics or allocates.
//!
//! `cargo rustc -p carom-embedded --example device --release --target wasm32-unknown-unknown -- \
//! --emit asm`

#![no_std]

use carom_embedded::{LookupAnswer, LookupTable};

/// Looks up a state in 32 bits, with a fallback. Whatever the table holds, this ends.
pub fn look_up_single(table: &LookupTable<'_, f32>, state: &[f32], input: &mut [f32]) -> bool {
    let answer = table.evaluate_or(state, &[0.0], input);
    matches!(answer, LookupAnswer::Plan { .. })
}

/// Looks up a state in 32 bits, and solves its program if it has one.
pub fn solve_single(
    table: &LookupTable<'_, f32>,
    state: &[f32],
    input: &mut [f32],
    work: &mut [f32],
) -> bool {
    table.solve_or(state, &[0.0], input, work).has_inputs()
}

/// Looks up a state in 64 bits, and solves its program if it has one.
pub fn solve_double(
    table: &LookupTable<'_, f64>,
    state: &[f64],
    input: &mut [f64],
    work: &mut [f64],
) -> bool {
    table.solve_or(state, &[0.0], input, work).has_inputs()
}

/// Looks up a state in 64 bits, with a fallback.
pub fn look_up_double(table: &LookupTable<'_, f64>, state: &[f64], input: &mut [f64]) -> bool {
    let answer = table.evaluate_or(state, &[0.0], input);
    matches!(answer, LookupAnswer::Plan { .. })
}
