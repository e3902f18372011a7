//! Service systems with congestion: customers are assigned to facilities, whose capacity is one of
//! some levels, and waiting at a facility grows as `load / (capacity - load)` (Elhedhli,
//! Manufacturing & Service Operations Management 8, 2006). In trees of that size, cuts of cones
//! pass from nodes to their children and between threads. The answers are those of enumeration.

use carom::model::norm;
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/service_systems.txt";

const FACILITIES: usize = 3;
const LEVELS: usize = 2;

/// A service system, in whole numbers.
#[derive(Debug, Clone)]
struct ServiceSystem {
    /// By customer: its demand, and by facility the cost of serving it there.
    customers: Vec<(u32, [u32; FACILITIES])>,
    /// By facility and level: the capacity and the cost.
    levels: [[(u32, u32); LEVELS]; FACILITIES],
    /// The cost of a unit of waiting.
    waiting: u32,
}

impl ServiceSystem {
    /// The least cost of all assignments; `None` if no capacity is enough.
    fn least_cost(&self) -> Option<f64> {
        let count = FACILITIES.pow(self.customers.len() as u32);
        let cost = |assignment: usize| {
            let mut loads = [0; FACILITIES];
            let (mut rest, mut cost) = (assignment, 0.0);
            for (demand, costs) in &self.customers {
                let place = rest % FACILITIES;
                rest /= FACILITIES;
                loads[place] += demand;
                cost += f64::from(costs[place]);
            }
            let facility = |(load, levels): (&u32, &[(u32, u32); LEVELS])| {
                let open = levels.iter().filter(|(capacity, _)| capacity > load);
                let cost = |&(capacity, fixed): &(u32, u32)| {
                    let wait = f64::from(*load) / f64::from(capacity - load);
                    f64::from(fixed) + f64::from(self.waiting) * wait
                };
                let best = open.map(cost).min_by(f64::total_cmp);
                if *load == 0 { Some(0.0) } else { best }
            };
            let facilities = loads.iter().zip(&self.levels).map(facility).sum::<Option<f64>>();
            facilities.map(|facilities| cost + facilities)
        };
        (0..count).filter_map(cost).min_by(f64::total_cmp)
    }

    /// With `load <= capacity part`, `part <= open` and `part (open + wait) <= open wait`, which
    /// for a sum of the levels' parts is a cone for each level:
    /// `wait^2 <= (wait - part) (open + wait)`.
    fn model(&self) -> Model {
        let mut model = Model::new("service system");
        let mut cost = Affine::constant(0.0);
        let mut loads = vec![Affine::constant(0.0); FACILITIES];
        for (j, (demand, costs)) in self.customers.iter().enumerate() {
            let mut served = Affine::constant(0.0);
            for place in 0..FACILITIES {
                let x = model.binary(format!("served_{j}_{place}")).unwrap();
                cost += f64::from(costs[place]) * x;
                loads[place] += f64::from(*demand) * x;
                served += x;
            }
            model.add(("once", j), served.equals(1.0)).unwrap();
        }
        for (place, load) in loads.into_iter().enumerate() {
            let wait = model.continuous(("wait", place), 0.0, 100.0).unwrap();
            cost += f64::from(self.waiting) * wait;
            let (mut room, mut one) = (Affine::constant(0.0), Affine::constant(0.0));
            for (level, (capacity, fixed)) in self.levels[place].iter().enumerate() {
                let open = model.binary(format!("open_{place}_{level}")).unwrap();
                let part = model.continuous(format!("part_{place}_{level}"), 0.0, 1.0).unwrap();
                cost += f64::from(*fixed) * open;
                room += f64::from(*capacity) * part;
                one += open;
                model.add(format!("within_{place}_{level}"), part.le(open)).unwrap();
                let [a, b] = [wait - part, open + wait];
                let cone = norm([2.0 * wait, a.clone() - b.clone()]).le(a + b);
                model.add(format!("congestion_{place}_{level}"), cone).unwrap();
            }
            model.add(("load", place), (load - room).equals(0.0)).unwrap();
            model.add(("one", place), one.le(1.0)).unwrap();
        }
        model.minimize(cost).unwrap();
        model
    }
}

fn systems() -> impl Strategy<Value = ServiceSystem> {
    let customer = (1..10_u32, [0..30_u32, 0..30, 0..30]);
    let levels = [(8..20_u32, 5..40_u32), (20..40_u32, 10..80_u32)];
    (prop::collection::vec(customer, 3..8), [levels.clone(), levels.clone(), levels], 1..60_u32)
        .prop_map(|(customers, levels, waiting)| ServiceSystem { customers, levels, waiting })
}

proptest! {
    #![proptest_config(config(40, REGRESSIONS))]

    #[test]
    fn plans_of_all_searches_cost_the_least(system in systems()) {
        let model = system.model();
        let least = system.least_cost();
        let several = |deterministic| {
            Options::default().with_threads(3).with_deterministic(deterministic)
        };
        for options in [Options::default(), several(false), several(true)] {
            let solution = BranchAndBound::new(options).solve(&model).unwrap();
            match least {
                None => prop_assert!(solution.objective().is_none()),
                Some(least) => {
                    prop_assert!(solution.is_optimal(), "{:?}", solution.termination());
                    let cost = solution.objective().unwrap();
                    let error = (cost - least).abs();
                    prop_assert!(error <= 2e-6 * least.max(1.0), "{} and {}", cost, least);
                    prop_assert!(solution.bound() <= least + 1e-9 * least.max(1.0));
                }
            }
        }
    }
}
