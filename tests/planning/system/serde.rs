//! Hybrid systems from and to `serde`.

use carom::hybrid::{HybridSystem, Region, SimulationOptions};
use carom::interval::Interval;
use carom::model::norm;
use carom_hybrid::internals::{Halfspace, HasParts};
use proptest::prelude::*;

use super::random::{system, wishes};
use crate::common::config;

proptest! {
    #![proptest_config(config(100, "tests/regressions/systems_serde.txt"))]

    #[test]
    fn systems_and_runs_come_back(raw in system(), wishes in wishes()) {
        let mut system = raw.hybrid();
        let ones = vec![1.0; system.parts().states.len()];
        system = system.with_limit(Halfspace::new("late", ones, vec![9.0, f64::INFINITY]));
        let text = serde_json::to_string(&system).unwrap();
        let back: HybridSystem = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(&back, &system);
        prop_assert_eq!(back.to_string(), system.to_string());
        let (start, inputs) = raw.cut(&wishes);
        let first = SimulationOptions::default().with_first_possible(true);
        let run = back.simulate_with(&start, &inputs, &first).unwrap();
        let text = serde_json::to_string(&run).unwrap();
        prop_assert_eq!(serde_json::from_str::<carom::hybrid::Simulation>(&text).unwrap(), run);
    }
}

#[test]
fn norms_come_back_and_are_checked() {
    let mut cart = HybridSystem::new(1.0);
    let (x, y) = (cart.state("x", -9.0, 9.0).unwrap(), cart.state("y", -9.0, 9.0).unwrap());
    let u = cart.input("u", -1.0, 1.0).unwrap();
    cart.limit("round", norm([x, y]).le(5.0)).unwrap();
    let roll = cart.mode("roll").unwrap().next([x.is(x + u)]).unwrap();
    let roll = roll.guard(norm([u - 0.5, x - y]).le(4.0)).unwrap();
    roll.guard(norm([x.predicted(), y.predicted()]).le(4.5)).unwrap();
    let region = cart.region([norm([x - 0.5, y - 1.0]).le(2.0)]).unwrap();
    let text = serde_json::to_string(&cart).unwrap();
    let back: HybridSystem = serde_json::from_str(&text).unwrap();
    assert_eq!(back, cart);
    assert_eq!(back.to_string(), cart.to_string());
    let stated = serde_json::to_string(&region).unwrap();
    assert_eq!(serde_json::from_str::<Region>(&stated).unwrap(), region);
    let mut value: serde_json::Value = serde_json::from_str(&text).unwrap();
    value["norms"][0]["entries"][0]["factors"] = serde_json::json!([1.0]);
    let error = serde_json::from_value::<HybridSystem>(value).unwrap_err().to_string();
    assert!(error.contains("the number of factors of the norm `round`"), "{error}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let room =
        HybridSystem::thermostat(60.0, 1800.0, 5.0, 40.0, Interval::new(19.0, 21.0)).unwrap();
    let value = serde_json::to_value(&room).unwrap();
    let error = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut value = value.clone();
        change(&mut value);
        serde_json::from_value::<HybridSystem>(value).unwrap_err().to_string()
    };
    let text = error(&|v| v["states"][0][1]["lower"] = 90.into());
    assert!(text.contains("bounds of `temperature` are crossed"), "{text}");
    let text = error(&|v| v["choices"][0]["transitions"] = serde_json::json!([]));
    assert!(text.contains("the number of transitions"), "{text}");
    let text = error(&|v| v["choices"][0]["transitions"][0]["name"] = "start".into());
    assert!(text.contains("`start` is already taken"), "{text}");
    let text = error(&|v| {
        let reset =
            serde_json::json!({"matrix": [[1.0], [1.0, 2.0]], "offset": {"values": [[0.0]]}});
        v["choices"][0]["transitions"][0]["reset"] = reset;
    });
    assert!(text.contains("the matrix of a reset"), "{text}");
    let text = error(&|v| {
        v["choices"][0]["transitions"][0]["guards"][0]["limit"] = serde_json::json!({"values": []});
    });
    assert!(text.contains("the number of values of the limit of `temperature >= 19`"), "{text}");
}
