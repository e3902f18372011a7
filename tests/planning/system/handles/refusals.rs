//! What cannot be stated.

use carom::ErrorKind;
use carom::hybrid::{HybridSystem, LinearSystem, State};
use carom::prelude::*;

#[track_caller]
fn text<T>(result: Result<T, Error>) -> String {
    match result {
        Ok(_) => panic!("it is refused"),
        Err(error) => error.to_string(),
    }
}

fn misplaced(name: &str, place: &str, help: &str) -> String {
    format!("{name} cannot stand in {place}; {help}")
}

/// How modes with memory are used.
const MEMORY: &str = "use `stay` and `switch` to say what holds in a mode";

/// Two states and an input, without a flow.
fn cart() -> (HybridSystem, [State; 2], Input) {
    let mut cart = HybridSystem::new(0.5);
    let states = ["x", "v"].map(|name| cart.state(name, -9.0, 9.0).unwrap());
    let u = cart.input("u", -1.0, 1.0).unwrap();
    (cart, states, u)
}

#[test]
fn handles_of_other_systems_are_foreign() {
    let (mut cart, [x, v], _) = cart();
    let (mut other, [y, _], w) = self::cart();
    let [on, off] = other.modes("heater", ["on", "off"]).unwrap();
    let foreign = |index: usize, place: &str| {
        format!(
            "variable number {index} used in `{place}` belongs to another model or system; use a \
             handle only with the one that created it (or a clone of it), and take handles of a \
             system at a sample with `at`"
        )
    };
    assert_eq!(text(cart.limit("l", (x + y).le(1.0))), foreign(0, "a limit of the system"));
    assert_eq!(text(cart.rates([(x, w)])), foreign(4, "the common flow"));
    assert_eq!(text(cart.next([(y, 1.0 * x)])), foreign(0, "the common flow"));
    assert_eq!(text(cart.region([y.ge(0.0)])), foreign(0, "a region of states"));
    assert_eq!(text(cart.disturbance(y, 0.0, 0.0)), foreign(0, "a disturbance"));
    assert_eq!(text(cart.stay(on)), foreign(5, "`stay`"));
    assert_eq!(text(cart.switch(on, off)), foreign(5, "`switch`"));
    assert_eq!(text(cart.dwell(off, 1, None)), foreign(6, "`dwell`"));
    let noise = other.output("noise").unwrap();
    let mut mode = |name: &str| cart.mode(name).unwrap().next([(x, 1.0 * x)]).unwrap().taken();
    mode("go");
    assert_eq!(text(cart.mode("m1").unwrap().guard(y.le(0.0))), foreign(0, "a guard of `m1`"));
    assert_eq!(text(cart.mode("m2").unwrap().limit("l", y.le(0.0))), foreign(0, "a guard of `m2`"));
    assert_eq!(
        text(cart.mode("m3").unwrap().reset([(x, y.predicted())])),
        foreign(1, "a reset of `m3`")
    );
    assert_eq!(text(cart.mode("m4").unwrap().output(noise, v)), foreign(7, "an output of `m4`"));
    // Variables of a model are foreign too, and handles are foreign to a model.
    let mut model = Model::new("m");
    let z = model.continuous("z", 0.0, 1.0).unwrap();
    assert!(
        text(cart.mode("m5").unwrap().guard(z.le(0.0)))
            .contains("belongs to another model or system")
    );
    assert!(text(model.add("r", x.le(0.0))).contains("take handles of a system at a sample"));
    assert!(text(model.minimize(x.square())).contains("take handles of a system at a sample"));
}

#[test]
fn handles_stand_where_they_mean_something() {
    let (mut cart, [x, _], u) = cart();
    let noise = cart.output("noise").unwrap();
    let [on, off] = cart.modes("heater", ["on", "off"]).unwrap();
    let go = cart.mode("go").unwrap().next([(x, 1.0 * x)]).unwrap().taken();
    assert_eq!(
        text(cart.limit("l", x.predicted().le(1.0))),
        misplaced(
            "the prediction in `x' <= 1`",
            "a limit of the system",
            "limits hold at every sample; use the state itself"
        )
    );
    let stands = "transitions and outputs stand in expressions of a program";
    let limit = "a limit of the system";
    assert_eq!(text(cart.limit("l", (x + go).le(1.0))), misplaced("`go`", limit, stands));
    assert_eq!(text(cart.limit("l", noise.le(1.0))), misplaced("`noise`", limit, stands));
    assert_eq!(text(cart.limit("l", (x + on).le(1.0))), misplaced("`heater is on`", limit, MEMORY));
    let of_states = "a region is stated with states and modes";
    let region = "a region of states";
    assert_eq!(text(cart.region([u.le(1.0)])), misplaced("`u`", region, of_states));
    assert_eq!(text(cart.region([x.predicted().le(1.0)])), misplaced("`x'`", region, of_states));
    let modes = "modes are stated as `on.equals(1.0)`, or as a sum of modes of one choice that \
                 equals 1";
    for (row, shown) in [
        (on.le(0.5), "heater is on <= 0.5"),
        (on.equals(0.0), "heater is on = 0"),
        ((2.0 * on).equals(1.0), "2 heater is on = 1"),
        ((on + x).equals(1.0), "x + heater is on = 1"),
    ] {
        let name = format!("the row `{shown}`");
        assert_eq!(text(cart.region([row])), misplaced(&name, region, modes));
    }
    assert_eq!(
        text(cart.region([on.equals(1.0), x.ge(0.0), off.equals(1.0)])),
        misplaced(
            "the row `heater is off = 1`",
            region,
            "another row excludes the modes that it allows"
        )
    );
    let made = "name a mode that `modes` has made";
    assert_eq!(text(cart.stay(go)), misplaced("`go`", "`stay`", made));
    assert_eq!(text(cart.switch(on, x.into())), misplaced("`x`", "`switch`", made));
    assert_eq!(text(cart.dwell(u.into(), 1, 2)), misplaced("`u`", "`dwell`", made));
    let [wet, _] = cart.modes("pump", ["wet", "dry"]).unwrap();
    assert_eq!(
        text(cart.switch(on, wet)),
        misplaced("`pump is wet`", "`switch`", "name two different modes of one choice")
    );
}

#[test]
fn parts_of_a_transition_are_of_its_start_or_of_its_prediction() {
    let (mut cart, [x, v], u) = cart();
    let price = cart.series("price", [1.0, 2.0]).unwrap();
    let noise = cart.output("noise").unwrap();
    let [on, _] = cart.modes("heater", ["on", "off"]).unwrap();
    assert_eq!(
        text(cart.mode("m1").unwrap().next([(x, x.predicted())])),
        misplaced(
            "the row of `x`",
            "the flow of `m1`",
            "a flow starts from states and inputs, not from predictions"
        )
    );
    // A series in a flow is an input.
    cart.mode("m2").unwrap().rates([(v, u + price)]).unwrap();
    assert_eq!(
        text(cart.mode("m3").unwrap().next([(x, x + on)])),
        misplaced("`heater is on`", "the flow of `m3`", MEMORY)
    );
    let alone = "state it of the start of the step alone or of the prediction alone";
    assert_eq!(
        text(cart.mode("m4").unwrap().guard((x - v.predicted()).ge(2.0))),
        misplaced("the row `x - v' >= 2`", "a guard of `m4`", alone)
    );
    assert_eq!(
        text(cart.mode("m5").unwrap().reset([(x, -x)])),
        misplaced(
            "the new value of `x`",
            "a reset of `m5`",
            "state it by predictions, such as `v.predicted()`, and by series"
        )
    );
    assert_eq!(
        text(cart.mode("m6").unwrap().output(noise, u + x.predicted())),
        misplaced("`noise`", "an output of `m6`", alone)
    );
    assert_eq!(
        text(cart.mode("m7").unwrap().output(u.into(), x)),
        misplaced("`u`", "an output of `m7`", "name an output of the system")
    );
    let go_on = cart.mode("m8").unwrap().next([(x, 0.5 * x)]).unwrap();
    assert_eq!(
        text(go_on.rates([(v, u)])),
        misplaced("a second flow", "the statement of `m8`", "state all rows of the flow at once")
    );
    let back = cart.mode("m9").unwrap().reset([(x, 1.0 * v.predicted())]).unwrap();
    assert_eq!(
        text(back.reset([(v, 1.0 * x.predicted())])),
        misplaced(
            "a second reset",
            "the statement of `m9`",
            "name all states of the reset at once"
        )
    );
}

#[test]
fn a_system_is_stated_in_order() {
    let late = "a statement after a limit, a mode or a flow";
    let first = "declare all states first";
    let (limited, [x, _], _) = cart();
    let mut after_limit = limited.clone();
    after_limit.limit("l", x.le(1.0)).unwrap();
    assert_eq!(text(after_limit.state("y", 0.0, 1.0)), misplaced("`y`", late, first));
    let mut after_flow = limited.clone();
    after_flow.next([(x, 0.5 * x)]).unwrap();
    assert_eq!(text(after_flow.state("w", 0.0, 1.0)), misplaced("`w`", late, first));
    let mut after_mode = limited.clone();
    after_mode.mode("go").unwrap();
    assert_eq!(text(after_mode.state("y", 0.0, 1.0)), misplaced("`y`", late, first));
    // A common flow is stated once, before modes, and modes keep to its kind.
    let once = misplaced(
        "the common flow",
        "a statement after a flow",
        "state it once, before the first mode",
    );
    assert_eq!(text(after_mode.next([(x, 0.5 * x)])), once);
    assert_eq!(text(after_flow.rates([(x, 0.5 * x)])), once);
    assert_eq!(
        text(after_flow.mode("go").unwrap().rates([(x, 0.5 * x)])),
        misplaced(
            "a flow of another kind than the common one",
            "the flow of `go`",
            "state both by `rates` or both by `next`"
        )
    );
    // A mode without a flow is found when the system is used.
    let missing = misplaced(
        "`go`",
        "the system without a flow",
        "state it by `rates` or by `next`, or state a common flow first",
    );
    assert_eq!(text(after_mode.check()), missing);
    assert_eq!(text(after_mode.program(3)), missing);
    assert_eq!(text(after_mode.simulate(&[0.0, 0.0], &[[0.0]])), missing);
    let mut thermostat = limited.clone();
    let [on, off] = thermostat.modes("heater", ["on", "off"]).unwrap();
    thermostat.switch(on, off).unwrap();
    thermostat.stay(on).unwrap().next([(x, x + 1.0)]).unwrap();
    assert!(text(thermostat.check()).starts_with("`on to off` cannot stand in the system without"));
    // Choices with and without memory.
    assert_eq!(
        text(thermostat.mode_of("heater", "boost")),
        misplaced(
            "the mode `boost`",
            "the choice `heater`",
            "the choice has modes with memory; use `stay` and `switch`"
        )
    );
    let mut mixed = limited;
    mixed.mode_of("heater", "boost").unwrap().next([(x, 1.0 * x)]).unwrap();
    let [warm] = mixed.modes("heater", ["warm"]).unwrap();
    mixed.stay(warm).unwrap().next([(x, 1.0 * x)]).unwrap();
    assert_eq!(
        text(mixed.check()),
        "the number of transitions of `heater` that name modes is 1; it must be none or all of \
         them; use `stay` and `switch` for all"
    );
}

#[test]
fn names_are_given_once() {
    let (mut cart, [x, v], u) = cart();
    let taken = |name: &str, kind: &str| {
        format!("the name `{name}` is already taken by another {kind}; choose another one")
    };
    let declared = "state, input or series";
    assert_eq!(text(cart.state("x", 0.0, 1.0)), taken("x", declared));
    assert_eq!(text(cart.input("v", 0.0, 1.0)), taken("v", declared));
    assert_eq!(text(cart.series("u", 1.0)), taken("u", declared));
    cart.series("price", 1.0).unwrap();
    assert_eq!(text(cart.state("price", 0.0, 1.0)), taken("price", declared));
    assert_eq!(text(cart.modes("heater", ["on", "on"])), taken("on", "mode of the choice"));
    let noise = cart.output("noise").unwrap();
    assert_eq!(text(cart.next([(x, 1.0 * v), (x, 1.0 * u)])), taken("x", "row of the flow"));
    let mut go = cart.mode("go").unwrap().next([(x, 1.0 * x)]).unwrap();
    go = go.output(noise, x).unwrap();
    assert_eq!(text(go.output(noise, x)), taken("noise", "output of the transition"));
    let transition = "transition of the choice";
    assert_eq!(text(cart.mode("go")), taken("go", transition));
    assert_eq!(text(cart.event("go")), taken("go", transition));
    assert_eq!(text(cart.mode("stop").unwrap().named("go")), taken("go", transition));
    let end = cart.mode("end").unwrap();
    let twice = [(v, 1.0 * x.predicted()), (v, 1.0 * v.predicted())];
    assert_eq!(text(end.reset(twice)), taken("v", "state of the reset"));
    let [on] = cart.modes("heater", ["on"]).unwrap();
    cart.stay(on).unwrap();
    assert_eq!(text(cart.stay(on)), taken("on", transition));
    for bad in ["", "two  blanks", "a\ttab"] {
        let invalid = |error: String| assert!(error.contains("cannot be a name"), "{error}");
        let mut system = HybridSystem::new(1.0);
        invalid(text(system.state(bad, 0.0, 1.0)));
        invalid(text(system.input(bad, 0.0, 1.0)));
        invalid(text(system.series(bad, 1.0)));
        invalid(text(system.output(bad)));
        invalid(text(system.modes(bad, ["on"])));
        invalid(text(system.modes("heater", [bad])));
        invalid(text(system.mode(bad)));
        invalid(text(system.mode_of(bad, "go")));
        invalid(text(system.limit(bad, Affine::zero().le(1.0))));
        assert_eq!(
            text(system.mode("go")),
            "the number of states of the hybrid system is 0; it must be at least 1"
        );
        let x = system.state("x", 0.0, 1.0).unwrap();
        invalid(text(system.mode("go").unwrap().limit(bad, x.le(1.0))));
        invalid(text(system.mode("stop").unwrap().named(bad)));
    }
}

#[test]
fn numbers_make_sense() {
    let (mut cart, [x, v], u) = cart();
    let mut other = HybridSystem::new(1.0);
    assert!(text(other.state("x", 1.0, 0.0)).contains("bounds of `x` are crossed: 1 > 0"));
    assert!(text(other.state("x", f64::NAN, 0.0)).contains("the lower limit of `x` is NaN"));
    assert!(text(other.state("x", 0.0, f64::INFINITY)).contains("the upper limit of `x` is inf"));
    assert!(text(other.input("u", 0.0, vec![1.0, -1.0])).contains("bounds of `u` are crossed"));
    let empty = Vec::<f64>::new;
    assert_eq!(
        text(other.input("u", empty(), 1.0)),
        "the number of values of the lower end of `u` is 0; it must be at least 1"
    );
    assert_eq!(
        text(other.series("p", empty())),
        "the number of values of the series `p` is 0; it must be at least 1"
    );
    assert!(
        text(other.series("p", [1.0, f64::NAN])).contains("a value of the series of `p` is NaN")
    );
    // Rows that contradict themselves or say nothing, wherever they stand.
    let crossed = |error: String, name: &str| {
        let expected = format!("bounds of `{name}` are crossed: 2 > 1; swap or relax them");
        assert_eq!(error, expected);
    };
    crossed(text(cart.limit("l", x.within(2.0, 1.0))), "l");
    crossed(text(cart.invariant((x + v).within(2.0, 1.0))), "2 <= x + v <= 1");
    crossed(text(cart.region([x.within(2.0, 1.0)])), "2 <= x <= 1");
    crossed(text(cart.region([(-1.0 * x).within(2.0, 1.0)])), "2 <= -x <= 1");
    crossed(text(cart.region([(x + v).within(2.0, 1.0)])), "2 <= x + v <= 1");
    let nothing = "has no finite limit, so it says nothing; give it one or drop it";
    let endless = || x.within(f64::NEG_INFINITY, f64::INFINITY);
    assert_eq!(text(cart.limit("l", endless())), format!("statement `l` {nothing}"));
    assert!(text(cart.region([endless()])).contains(nothing));
    assert!(text(cart.region([x.le(f64::NAN)])).contains("is NaN"));
    assert!(
        text(cart.limit("l", (x - x).le(1.0))).starts_with("statement `l` has no variable left")
    );
    assert_eq!(
        text(cart.region([x.ge(1.0), x.le(0.5)])),
        "bounds of `x` are crossed: 1 > 0.5; swap or relax them"
    );
    assert!(text(cart.dwell(x.into(), 1, 2)).contains("name a mode"));
    let [on] = cart.modes("heater", ["on"]).unwrap();
    for (least, most) in [(0, None), (3, Some(2))] {
        let error = text(cart.dwell(on, least, most));
        assert!(error.contains("dwell time of `on` is"), "{error}");
    }
    assert!(text(cart.expect("fan", true, true)).contains("`fan`"));
    assert!(text(cart.disturbance(x, 1.0, 0.0)).contains("bounds of `x` are crossed"));
    crossed(text(cart.mode("m1").unwrap().guard(x.within(2.0, 1.0))), "2 <= x <= 1");
    crossed(text(cart.mode("m2").unwrap().guard(u.within(2.0, 1.0))), "2 <= u <= 1");
    assert_eq!(
        text(cart.mode("m3").unwrap().guard(u.ge(3.0))),
        "bounds of `u where u >= 3` are crossed: 3 > 1; swap or relax them"
    );
    assert!(text(cart.mode("m4").unwrap().guard(u.le(f64::NAN))).contains("is NaN"));
    assert!(text(cart.mode("m5").unwrap().guard((u - u).le(1.0))).contains("has no variable left"));
    let three =
        LinearSystem::new(carom::hybrid::Matrix::zeros(3, 3), [[0.0]; 3], [0.0; 3]).unwrap();
    let error = cart.mode("m6").unwrap().flow(three).map(|_| ()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Shape { .. }), "{error}");
    for time_step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut system = HybridSystem::new(time_step);
        let x = system.state("x", 0.0, 1.0).unwrap();
        let error = text(system.rates([(x, 1.0 * x)]));
        assert!(error.starts_with("the time step (s) is"), "{error}");
        system.mode("go").unwrap().next([(x, 1.0 * x)]).unwrap();
        assert!(text(system.check()).starts_with("the time step (s) is"));
    }
}
