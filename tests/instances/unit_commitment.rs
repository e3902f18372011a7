//! Unit commitment with data of its own: which units run in which hour, at least cost.
//!
//! The usual formulation with three binaries for a unit and an hour (on, started, stopped), minimum
//! times up and down, ramps, a reserve, and piecewise linear costs. Demand has a peak in the morning
//! and one in the evening.

use std::ops::RangeInclusive;

use carom::prelude::*;

use super::random_miqp::Random;

/// Demand of the hours of a day, as a share of what all units can produce.
const DAY: [f64; 24] = [
    0.44, 0.41, 0.39, 0.38, 0.39, 0.44, 0.53, 0.62, 0.68, 0.7, 0.69, 0.67, 0.65, 0.63, 0.62, 0.62,
    0.65, 0.71, 0.76, 0.78, 0.74, 0.66, 0.56, 0.48,
];

/// What is on beyond the demand, as a share of it.
const RESERVE: f64 = 0.05;

/// A unit: what it produces (MW), what that costs, and how fast it changes.
struct Unit {
    least: f64,
    most: f64,
    /// The most change within an hour (MW).
    ramp: f64,
    /// Fewest hours on and off.
    times: [usize; 2],
    /// Cost of an hour at the least power, and of a start.
    costs: [f64; 2],
    /// Cost of a MWh in the lower and the upper half of the range.
    prices: [f64; 2],
}

impl Unit {
    fn random(random: &mut Random) -> Unit {
        let mut between = |least: f64, most: f64| least + (most - least) * random.uniform();
        let most = between(50.0, 400.0).round();
        let least = (between(0.3, 0.5) * most).round();
        // Large units are slow and cheap.
        let size = most / 400.0;
        let price = between(18.0, 26.0) + 14.0 * (1.0 - size);
        Unit {
            least,
            most,
            ramp: (between(0.3, 0.6) * (most - least)).round() + 1.0,
            times: [1 + (7.0 * size) as usize, 1 + (6.0 * size) as usize],
            costs: [(1.1 * price * least).round(), (between(8.0, 20.0) * most).round()],
            prices: [price, between(1.05, 1.4) * price],
        }
    }
}

/// The last `count` hours up to and with `hour`, as far as there are so many.
fn last(hour: usize, count: usize) -> RangeInclusive<usize> {
    (hour + 1).saturating_sub(count)..=hour
}

/// The program of so many hours and units.
pub(crate) fn unit_commitment(hours: usize, count: usize) -> Result<Model, Error> {
    let mut random = Random(count as u64);
    let units: Vec<Unit> = (0..count).map(|_| Unit::random(&mut random)).collect();
    let mut model = Model::new("units");
    let (mut cost, mut produced) = (Affine::zero(), vec![Affine::zero(); hours]);
    let mut possible = produced.clone();
    let shape = (count, hours);
    let on = model.binary_family("on", shape)?;
    let started = model.binary_family("started", shape)?;
    let stopped = model.binary_family("stopped", shape)?;
    // What is produced beyond the least power: shares of the lower and the upper half of the range.
    let low = model.continuous_family("low", shape, 0.0, 1.0)?;
    let high = model.continuous_family("high", shape, 0.0, 1.0)?;
    for (k, unit) in units.iter().enumerate() {
        let half = 0.5 * (unit.most - unit.least);
        let beyond = |t: usize| half * (low[k][t] + high[k][t]);
        for t in 0..hours {
            let (on_now, name) = (on[k][t], |what: &str| format!("{what}[{k}][{t}]"));
            cost += unit.costs[0] * on_now + unit.costs[1] * started[k][t];
            cost += half * (unit.prices[0] * low[k][t] + unit.prices[1] * high[k][t]);
            produced[t] += unit.least * on_now + beyond(t);
            possible[t] += unit.most * on_now;
            model.add(name("low"), low[k][t].le(on_now))?;
            model.add(name("high"), high[k][t].le(on_now - started[k][t]))?;
            let starts: Affine = last(t, unit.times[0]).map(|s| Affine::from(started[k][s])).sum();
            model.add(name("up"), starts.le(on_now))?;
            let stops: Affine = last(t, unit.times[1]).map(|s| Affine::from(stopped[k][s])).sum();
            model.add(name("down"), (stops + on_now).le(1.0))?;
            if t > 0 {
                let change = on_now - on[k][t - 1];
                model.add(name("switch"), change.equals(started[k][t] - stopped[k][t]))?;
                let step = beyond(t) - beyond(t - 1);
                model.add(name("ramp"), step.within(-unit.ramp, unit.ramp))?;
            }
        }
    }
    let all: f64 = units.iter().map(|unit| unit.most).sum();
    for (t, (produced, possible)) in produced.into_iter().zip(possible).enumerate() {
        let demand = (DAY[t % DAY.len()] * all).round();
        model.add(("demand", t), produced.equals(demand))?;
        model.add(("reserve", t), possible.ge((1.0 + RESERVE) * demand))?;
    }
    model.minimize(cost)?;
    Ok(model)
}
