//! The cart: what a plan costs.

/// The number of steps of a plan.
pub const STEPS: usize = 4;
/// The length of a step, in s.
pub const STEP: f64 = 0.2;
/// Where the wall begins, in m.
pub const WALL: f64 = 0.5;
/// The push of the wall, in m/s² for each m.
pub const PUSH: f64 = 10.0;

/// The cost of the plan with these inputs (m/s²), from a position (m) and a speed (m/s).
pub fn cost(position: f64, speed: f64, inputs: [f32; STEPS]) -> f64 {
    let [mut x, mut v] = [position, speed];
    let mut cost = 0.0;
    for input in inputs.map(f64::from) {
        cost += x * x + 0.5 * v * v + 0.2 * input * input;
        let push = if x > WALL { PUSH * (WALL - x) } else { 0.0 };
        [x, v] = [x + STEP * v, v + STEP * (input + push)];
    }
    cost + 4.0 * (x * x + v * v)
}
