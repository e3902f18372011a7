//! Proofs of random programs with cones and with squares over columns without upper bounds.

use carom::model::Model;
use carom::prelude::*;

use super::is_proved;

/// Pseudo-random numbers.
struct Numbers(u64);

impl Numbers {
    /// A number between two others, in hundredths.
    fn within(&mut self, least: f64, most: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let part = ((self.0 >> 33) % 1001) as f64 / 1000.0;
        ((least + part * (most - least)) * 100.0).round() / 100.0
    }
}

/// Random programs with norms of forms over bounded columns: each log is complete.
#[test]
fn cones_over_bounded_columns_are_proved() -> Result<(), Error> {
    let mut numbers = Numbers(3);
    for case in 0..50 {
        let mut model = Model::new("cones");
        let columns = 3 + (case % 4);
        let mut x = Vec::new();
        for j in 0..columns {
            x.push(match numbers.within(0.0, 1.0) < 0.4 {
                true => model.integer(format!("n[{j}]"), -8.0, 8.0)?,
                false => model.continuous(format!("x[{j}]"), -8.0, 8.0)?,
            });
        }
        let form = |numbers: &mut Numbers, size: f64| {
            x.iter().map(|x| *x * numbers.within(-size, size)).sum::<Affine>()
        };
        for k in 0..1 + case % 3 {
            let tail: Vec<Affine> =
                (0..2 + k).map(|_| form(&mut numbers, 2.0) + numbers.within(-1.0, 1.0)).collect();
            let head = form(&mut numbers, 0.5) + numbers.within(3.0, 9.0);
            model.add(format!("cone[{k}]"), norm(tail).le(head))?;
        }
        let row = form(&mut numbers, 3.0);
        model.add("row", row.le(numbers.within(0.0, 2.0)))?;
        let cost = form(&mut numbers, 3.0);
        model.minimize(cost)?;
        let _ = is_proved(&model, &format!("cones_{case}"));
    }
    Ok(())
}

/// Random programs that place things on a line, with distances that no bound limits and squares:
/// multipliers that should be 0 are not quite, and the tangent's point is at bounds. Each log is
/// complete.
#[test]
fn distances_without_bounds_are_proved() -> Result<(), Error> {
    let mut numbers = Numbers(8);
    for case in 0..40 {
        let mut model = Model::new("distances");
        let x = model.continuous_family("x", 5, 0.0, f64::INFINITY)?;
        let mut cost: Option<Quadratic> = None;
        for x in x.iter() {
            let target = numbers.within(0.0, 12.0);
            let square = (x - target).square() * numbers.within(1.0, 30.0);
            cost = Some(match cost {
                Some(cost) => cost + square,
                None => square,
            });
        }
        let mut linear = Affine::from(0.0);
        for i in 0..x.len() {
            let k = (i + 1) % x.len();
            let [up, down, apart] = ["up", "down", "apart"]
                .map(|name| model.continuous(format!("{name}[{i}]"), 0.0, f64::INFINITY));
            let (up, down, apart) = (up?, down?, apart?);
            model.add(("sides", i), (x[i] - x[k] - up + down).equals(0.0))?;
            model.add(("distance", i), (apart - up - down).equals(0.0))?;
            if numbers.within(0.0, 1.0) < 0.5 {
                linear += apart * numbers.within(0.0, 90.0);
            }
            let side = model.binary(format!("side[{i}]"))?;
            let gap = numbers.within(0.0, 5.0);
            model.add(("right", i), (x[i] - x[k] + side * 40.0).ge(gap))?;
            model.add(("left", i), (x[k] - x[i] - side * 40.0).ge(gap - 40.0))?;
        }
        if let Some(cost) = cost {
            model.minimize(cost + linear)?;
        }
        let _ = is_proved(&model, &format!("distances_{case}"));
    }
    Ok(())
}
