//! Names, prefixes, several systems in one model, look-ups, files of values.

use carom::ErrorKind;
use carom::hybrid::{HybridSystem, LinearSystem};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::{Choice, Halfspace, Transition};

fn flow(gain: f64, heat: f64) -> LinearSystem {
    LinearSystem::new([[0.9]], [[gain]], [heat]).unwrap()
}

/// A heater with memory, and a fan with two speeds.
fn heater() -> HybridSystem {
    let heater = Choice::new("heater")
        .with_transition(Transition::new("idle", flow(0.1, 0.0)).within("off"))
        .with_transition(Transition::event("start", flow(0.1, 3.0)).between("off", "on"))
        .with_transition(Transition::new("heat", flow(0.1, 3.0)).within("on"))
        .with_transition(Transition::event("stop", flow(0.1, 0.0)).between("on", "off"))
        .with_dwell("on", 2, 3);
    let fan = Choice::new("fan")
        .with_transition(Transition::new("slow", flow(0.1, 0.0)))
        .with_transition(
            Transition::new("fast", flow(0.1, -1.0))
                .with_guard(Halfspace::limit("not in the cold", [-1.0], -5.0))
                .with_output("noise", [0.0], 40.0),
        );
    HybridSystem::new(0.5)
        .with_state("air temperature", Interval::new(0.0, 30.0))
        .with_input("window", Interval::new(-1.0, 1.0))
        .with_flow(flow(0.1, 0.0))
        .with_choice(heater)
        .with_choice(fan)
        .with_most_events(3)
}

#[test]
fn a_model_reads_like_the_system() {
    let mut model = Model::new("house");
    heater().write(&mut model, "", 1).unwrap();
    let text = model.to_string();
    for line in [
        "  dynamics_air_temperature[0]: -0.9 air_temperature[0] + air_temperature[1] \
         - 0.1 window[0] - 3 heater_start[0] - 3 heater_heat[0] + fan_fast[0] = 0",
        "  heater_leaves_on[0]: heater_heat[0] + heater_stop[0] - heater_is_on[0] = 0",
        "  heater_enters_on[0]: heater_start[0] + heater_heat[0] - heater_is_on[1] = 0",
        "  most_events: heater_start[0] + heater_stop[0] <= 3",
        "  fan_fast_not_in_the_cold[0]: fan_fast[0] = 1 implies -air_temperature[0] <= -5",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
    assert!(model.is_background("dynamics_air_temperature[0]"));
    assert!(model.is_background("heater_leaves_on[0]"));
    assert!(!model.is_background("fan_fast_not_in_the_cold[0]"));
}

#[test]
fn several_systems_share_a_model() {
    let mut model = Model::new("street");
    let first = heater().write(&mut model, "first", 4).unwrap();
    let second = heater().write(&mut model, "second", 4).unwrap();
    let before = model.to_string();
    let error = heater().write(&mut model, "first", 4).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::DuplicateName { name, .. }
        if name == "first_air_temperature[0]"));
    assert_eq!(model.to_string(), before);
    // A clash in the middle of the statements leaves nothing behind either.
    let mut model = Model::new("one statement");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    model.add("heater_leaves_on[3]", x.le(0.5)).unwrap();
    let before = model.to_string();
    heater().write(&mut model, "", 4).unwrap_err();
    assert_eq!(model.to_string(), before);
    heater().write(&mut model, "own", 4).unwrap();
    assert_ne!(
        first.state("air temperature").unwrap()[0],
        second.state("air temperature").unwrap()[0]
    );
}

/// The rule for names in models: words with single blanks between them.
#[test]
fn names_are_words() {
    for name in ["", " air", "air  temperature", "air\ttemperature", "air\n"] {
        let system = HybridSystem::new(0.5)
            .with_state(name, Interval::new(0.0, 30.0))
            .with_input("window", Interval::new(-1.0, 1.0))
            .with_flow(flow(0.1, 0.0))
            .with_choice(
                Choice::new("fan").with_transition(Transition::new("slow", flow(0.1, 0.0))),
            );
        let error = system.write(&mut Model::new("house"), "", 2).unwrap_err();
        let text = "it must be one or several words with single blanks between them";
        assert_eq!(error.to_string(), format!("`{name}` cannot be a name: {text}"));
    }
}

#[test]
fn runs_are_read_by_name() {
    let mut model = Model::new("house");
    let program = heater().write(&mut model, "", 4).unwrap();
    let x = program.state("air temperature").unwrap().clone();
    model.fix(x[0], 10.0).unwrap();
    let off = program.mode("heater", "off", 0).unwrap().unwrap();
    model.add("begin", off).unwrap();
    model.add("end", program.mode("heater", "off", 4).unwrap().unwrap()).unwrap();
    let loud: Affine = program.output("noise").unwrap().iter().sum();
    model.maximize(x[4] - 0.001 * loud).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    let run = program.read(&solution).unwrap();
    assert_eq!(run.transitions("heater").unwrap(), ["start", "heat", "heat", "stop"]);
    assert_eq!(run.modes("heater").unwrap(), ["off", "on", "on", "on", "off"]);
    assert_eq!(run.transitions("fan").unwrap(), ["slow"; 4]);
    assert_eq!(run.output("noise").unwrap(), [0.0; 4]);
    let csv = run.to_csv();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "time,air temperature,window,noise,heater,fan,heater mode");
    assert_eq!(lines.len(), 6);
    assert!(lines[1].starts_with("0,10,") && lines[1].ends_with(",start,slow,off"), "{csv}");
    assert!(lines[5].starts_with("2,") && lines[5].ends_with(",,,,,off"), "{csv}");
    // What was read is a point of the model.
    let values = program.values(&run).unwrap();
    for (variable, value) in values {
        assert!((solution.value(variable).unwrap() - value).abs() < 1e-6);
    }
}

#[test]
fn unknown_names_are_refused() {
    let mut model = Model::new("house");
    let program = heater().write(&mut model, "", 2).unwrap();
    let texts = [
        program.state("y").unwrap_err(),
        program.taken("fan", "medium", 0).unwrap_err(),
        program.taken("door", "open", 0).unwrap_err(),
        program.mode("fan", "on", 0).unwrap_err(),
        program.taken("fan", "fast", 2).unwrap_err(),
        program.mode("heater", "on", 3).unwrap_err(),
        program.output("light").unwrap_err(),
    ];
    let texts = texts.map(|error| error.to_string());
    assert_eq!(
        texts,
        [
            "the model has no state of the system named `y`",
            "the model has no transition of the choice named `medium`",
            "the model has no choice of the system named `door`",
            "the model has no mode of the choice named `on`",
            "the step is 2; it must be below 2",
            "the sample is 3; it must be below 3",
            "the model has no output of the system named `light`",
        ]
    );
}

/// A cart that is slower than its goal asks for.
fn slow_cart() -> Result<(HybridProgram, State, State), Error> {
    let mut cart = HybridSystem::new(1.0); // s
    let x = cart.state("x", 0.0, 9.0)?;
    let v = cart.state("v", -2.0, 2.0)?;
    let u = cart.input("u", -1.0, 1.0)?;
    cart.rates([x.is(v), v.is(u)])?;
    cart.mode("roll")?.invariant(x.le(5.0))?.limit("slow", v.le(0.5))?;
    cart.mode("run")?.invariant(x.ge(5.0))?.limit("quick", v.le(0.7))?;
    Ok((cart.program(6)?, x, v))
}

#[test]
fn explanations_speak_of_starts_and_limits() {
    let (mut program, x, v) = slow_cart().unwrap();
    program.start([x.equals(0.0), v.equals(0.0)]).unwrap();
    program.goal([x.ge(6.0), (x + v).le(9.0), x.le(8.0)]).unwrap();
    let text = program.model().to_string();
    for name in ["start_x[0]:", "start_v[0]:", "goal_x[6]:", "goal_1[6]:", "goal_2[6]:"] {
        assert!(text.contains(name), "{name} in {text}");
    }
    let mut solver = BranchAndBound::default();
    let options = carom::explain::ExplainOptions::default();
    let why = carom::explain::infeasibility(program.model(), &options, &mut solver).unwrap();
    let names: Vec<&str> = why.groups().iter().map(|group| group.name()).collect();
    assert_eq!(names, ["start_x", "goal_x", "roll_slow"]);
    let why = why.to_string();
    for words in [
        "the start of `x` at step 0; the goal of `x` at step 6; the limit `slow` of `roll` at steps",
        "(background: the laws of the system)",
    ] {
        assert!(why.contains(words), "{why}");
    }
    assert!(!why.contains('_'), "{why}");
}

#[test]
fn plans_are_comma_separated_values() {
    let (mut program, x, v) = slow_cart().unwrap();
    let mut other = HybridSystem::new(1.0); // s
    let y = other.state("y", 0.0, 9.0).unwrap();
    other.mode("rest").unwrap().next([y.is(y)]).unwrap();
    program.join("second", &other).unwrap();
    program.start([x.equals(0.0), v.equals(0.0), y.equals(1.0)]).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap().to_string();
    let mut tables = plan.lines().collect::<Vec<&str>>();
    assert!(tables[0].starts_with("# objective "), "{plan}");
    let second = tables.iter().position(|line| *line == "# second").expect("the name of a system");
    let last = tables.split_off(second);
    for table in [&tables[1..], &last[1..]] {
        assert!(table[0].starts_with("time,"), "{plan}");
        let commas = |line: &str| line.matches(',').count();
        assert!(table.len() == 8 && table.iter().all(|line| commas(line) == commas(table[0])));
    }
}
