//! The table of a cart beside a soft wall, with the look-up that a chip has.
//!
//! A page calls the functions with C names. There is neither an allocator nor `std` behind them: this is
//! the code of a device, compiled for WebAssembly. `tests/table.rs` of the planners writes
//! `table.rs`, and compares its answers with those of a search.

// Natively, the tests of the planners link this, with `std`.
#![cfg_attr(target_arch = "wasm32", no_std)]

mod cart;
#[rustfmt::skip]
mod table;

use carom_embedded::LookupAnswer;

pub use cart::{PUSH, STEP, STEPS, WALL, cost};
pub use table::CART;

/// The answer of the table for a state: position (m) and speed (m/s). With a plan come the inputs of all
/// its steps, in m/s².
pub fn look_up(position: f32, speed: f32) -> (LookupAnswer<f32>, [f32; STEPS]) {
    let mut inputs = [0.0; STEPS];
    (CART.evaluate(&[position, speed], &mut inputs), inputs)
}

/// The look-up behind each function for the page.
#[cfg(target_arch = "wasm32")]
mod page {
    // A name that another language can call is unsafe, as two functions may have the same one.
    #![expect(unsafe_code)]

    use super::{CART, LookupAnswer, cost, look_up};
    use core::mem::size_of_val;

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        core::arch::wasm32::unreachable()
    }

    /// 0 for a plan, 1 for no plan, 2 for a state that is not decided, and 3 for one outside.
    #[unsafe(no_mangle)]
    extern "C" fn answer(position: f32, speed: f32) -> u32 {
        match look_up(position, speed).0 {
            LookupAnswer::Plan { .. } => 0,
            LookupAnswer::NoPlan => 1,
            LookupAnswer::Open => 2,
            LookupAnswer::Outside | LookupAnswer::Damaged => 3,
        }
    }

    /// The input of the first step, in m/s²; 0 without a plan.
    #[unsafe(no_mangle)]
    extern "C" fn input(position: f32, speed: f32) -> f32 {
        look_up(position, speed).1[0]
    }

    /// The most that the plan costs above the least cost; 0 without a plan.
    #[unsafe(no_mangle)]
    extern "C" fn loss(position: f32, speed: f32) -> f32 {
        match look_up(position, speed).0 {
            LookupAnswer::Plan { loss } => loss,
            _ => 0.0,
        }
    }

    /// The cost of the plan.
    #[unsafe(no_mangle)]
    extern "C" fn cost_of_plan(position: f32, speed: f32) -> f64 {
        cost(position.into(), speed.into(), look_up(position, speed).1)
    }

    /// An end of the range of an axis: 0 for the position (m), 1 for the speed (m/s).
    #[unsafe(no_mangle)]
    extern "C" fn end(axis: usize, is_upper: u32) -> f32 {
        let ends = if is_upper == 0 { CART.lower } else { CART.upper };
        ends.get(axis).copied().unwrap_or(0.0)
    }

    /// The number of cells: each cut makes two of one.
    #[unsafe(no_mangle)]
    extern "C" fn cells() -> usize {
        CART.nodes.len() + CART.roots.len()
    }

    /// The most cuts on the way to a cell.
    #[unsafe(no_mangle)]
    extern "C" fn depth() -> u32 {
        CART.depth
    }

    /// The bytes that the table takes here.
    #[unsafe(no_mangle)]
    extern "C" fn bytes() -> usize {
        size_of_val(CART.nodes)
            + size_of_val(CART.leaves)
            + size_of_val(CART.laws)
            + size_of_val(CART.values)
            + size_of_val(CART.roots)
            + size_of_val(CART.lower)
            + size_of_val(CART.upper)
            + size_of_val(CART.scale)
    }
}
