//! Other solvers as programs. Their answers are read from recorded texts; a pretended program shows
//! what happens when one is missing, hangs, lies or babbles; and where CBC and GLPK are installed,
//! they (and HiGHS and SCIP) run the public suite and are compared with enumeration.
//! `CAROM_EXTERNAL=required` makes it an error that CBC and GLPK are not.
#![cfg(unix)]

mod common;

use std::error::Error as _;
use std::os::unix::fs::PermissionsExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::Command;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use carom::ErrorKind;
use carom::conformance::{Capability, Suite};
use carom::external::{
    Cbc, Dialect, ExternalAnswer, ExternalSolver, Files, Glpk, Highs, Scip, SolverClaim,
};
use carom::hybrid::scene::{Body, Scene, Solid, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::model::norm;
use carom::prelude::*;
use carom::reformulate::relaxed;
use common::config;
use common::enumeration::optimum;
use common::generate::{Shape, case};
use common::quadratic_program::Minimum;
use proptest::prelude::*;

// -- what programs write ------------------------------------------------------------------------

/// Maximises 3 c0 + 2 c1 - c2 as a minimisation: -11 at (3, 1, 0).
fn expect(answer: Result<ExternalAnswer, String>, bound: Option<f64>) {
    let answer = answer.unwrap();
    assert_eq!(
        (answer.claim, answer.objective, answer.bound),
        (SolverClaim::Optimal, Some(-11.0), bound)
    );
    let values: Vec<f64> = answer.values.unwrap().iter().map(|(_, value)| *value).collect();
    assert!(values == [3.0, 1.0, 0.0] || values == [3.0, 1.0], "{values:?}");
}

#[test]
fn recorded_answers_are_read() {
    let cbc = "Optimal - objective value -11.00000000\n      0 c0                     3            \
               -3\n      1 c1                     1                      -2\n      2 c2            \
               0                       1\n";
    expect(Cbc.read(Some(cbc), "Enumerated nodes:               7\n"), None);
    assert_eq!(Cbc.read(Some(cbc), "Enumerated nodes:    7\n").unwrap().nodes, Some(7));
    let glpk = "c Problem:    a\nc Objective:  obj = -11 (MINimum)\nc\ns mip 2 3 o -11\ni 1 7\n\
                i 2 3\nj 1 3\nj 2 1\nj 3 0\ne o f\n";
    expect(Glpk.read(Some(glpk), ""), None);
    let highs = "Model status\nOptimal\n\n# Primal solution values\nFeasible\nObjective -11\n# Columns 3\n\
                 c0 3\nc1 1\nc2 0\n# Rows 2\nr0 7\nr1 3\n\n# Dual solution values\nNone\n";
    expect(
        Highs.read(Some(highs), "  Dual bound        -11\n  Nodes             0\n"),
        Some(-11.0),
    );
    let scip = "solution status: optimal solution found\nobjective value:              -11\n\
                c0                    3 \t(obj:-3)\nc1              1 \t(obj:-2)\n";
    let printed = "SCIP Status        : problem is solved [optimal solution found]\n\
                   Solving Nodes      : 1\nDual Bound         : -1.10000000000000e+01\n";
    expect(Scip.read(Some(scip), printed), Some(-11.0));
}

#[test]
fn other_endings_are_told_apart() {
    let cbc = |first: &str| Cbc.read(Some(first), "Lower bound:      2.5\n").unwrap();
    assert_eq!(cbc("Infeasible - objective value 0.00").claim, SolverClaim::Infeasible);
    assert_eq!(cbc("Integer infeasible - objective value 0.00").claim, SolverClaim::Infeasible);
    assert_eq!(cbc("Unbounded - objective value 0.00").claim, SolverClaim::Unbounded);
    let late = cbc("Stopped on time - objective value 7.5\n  0 c0  1  0");
    assert_eq!(late.claim, SolverClaim::Limit(Termination::TimeLimit));
    assert_eq!((late.objective, late.bound), (Some(7.5), Some(2.5)));
    let none = cbc("Stopped on time (no integer solution - continuous used) - objective value 1\n");
    assert_eq!(none.values, None);
    let glpk = |text: &str, log: &str| Glpk.read(Some(text), log).unwrap().claim;
    assert_eq!(glpk("s mip 2 3 n 0\n", ""), SolverClaim::Infeasible);
    assert_eq!(glpk("s bas 2 3 n f 0\n", ""), SolverClaim::Infeasible);
    assert_eq!(glpk("s bas 2 3 f n 0\n", ""), SolverClaim::Unbounded);
    let late = SolverClaim::Limit(Termination::TimeLimit);
    assert_eq!(glpk("s mip 2 3 u 0\n", "TIME LIMIT EXCEEDED; SEARCH TERMINATED\n"), late);
    // As printed where its own preparation finds it out.
    let early = glpk("s bas 2 2 u u 0\n", "LP HAS NO PRIMAL FEASIBLE SOLUTION\n");
    assert_eq!(early, SolverClaim::Infeasible);
    let falling = "LP RELAXATION HAS NO DUAL FEASIBLE SOLUTION\n";
    assert_eq!(glpk("s mip 1 3 u 0\n", falling), SolverClaim::Unbounded);
    let either = "Model status\nPrimal infeasible or unbounded\n\n# Primal solution values\nNone\n";
    assert_eq!(Highs.read(Some(either), "").unwrap(), ExternalAnswer::new(SolverClaim::Unbounded));
    let empty = Highs.read(Some("Model status\nEmpty\n"), "").unwrap();
    assert_eq!((empty.claim, empty.objective), (SolverClaim::Optimal, Some(0.0)));
    let highs = "Model status\nInfeasible\n\n# Primal solution values\nNone\n";
    assert_eq!(Highs.read(Some(highs), "").unwrap(), ExternalAnswer::new(SolverClaim::Infeasible));
    let scip = "SCIP Status        : problem is solved [infeasible]\nDual Bound   : +1e+20\n";
    assert_eq!(
        Scip.read(Some("no solution available\n"), scip).unwrap().claim,
        SolverClaim::Infeasible
    );
    for dialect in [&Cbc as &dyn Dialect, &Glpk, &Highs, &Scip] {
        assert!(dialect.read(None, "").is_err(), "{dialect:?}");
        // Whatever is in the texts, reading them does not panic.
        for text in ["", "\n\n", "Model status", "s mip", "j x y", "# Columns 9\nc0", "** 1"] {
            drop(dialect.read(Some(text), text));
        }
    }
}

// -- a pretended program ------------------------------------------------------------------------

/// A shell script that stands in for CBC: it finds the solution's path in its last argument.
struct Pretended {
    path: PathBuf,
}

impl Pretended {
    fn new(name: &str, body: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
        let path = folder.join(format!("pretended_{name}.sh"));
        let script = format!("#!/bin/sh\nfor last; do :; done\nout=\"$last\"\n{body}\n");
        std::fs::write(&path, script).unwrap();
        std::fs::set_permissions(&path, PermissionsExt::from_mode(0o755)).unwrap();
        Pretended { path }
    }

    fn solver(&self) -> ExternalSolver {
        ExternalSolver::cbc().with_program(self.path.to_string_lossy())
    }
}

/// Least x >= 0.5 with x >= 2 where z is off; opening costs 5: 2 at z = 0.
fn gate() -> (Model, Variable) {
    let mut model = Model::new("gate");
    let z = model.binary("z").unwrap();
    let x = model.continuous("x", 0.5, 1000.0).unwrap();
    model.add("shut", z.off().implies(x.ge(2.0))).unwrap();
    model.minimize(x + 5.0 * z + 100.0).unwrap();
    (model, x)
}

#[test]
fn a_point_is_certified_not_believed() {
    let (model, x) = gate();
    // Its binary is whole only nearly, and x has trickled below 2.
    let sloppy = "printf 'Optimal - objective value 2\\n0 c0 0.000001 5\\n1 c1 1.9985 1\\n' > $out";
    let solution = Pretended::new("sloppy", sloppy).solver().solve(&model).unwrap();
    assert!(solution.is_optimal());
    assert!((solution.value(x).unwrap() - 2.0).abs() < 1e-6);
    assert!((solution.objective().unwrap() - 102.0).abs() < 1e-6);
    assert!(solution.bound() <= 102.0 && solution.bound() > 101.99);
    assert!(solution.verification().unwrap().holds());
}

#[test]
fn what_is_missing_or_babbles_is_an_error_that_says_so() {
    let (model, _) = gate();
    let message = |solver: ExternalSolver| {
        let mut solver = solver;
        solver.solve(&model).unwrap_err().to_string()
    };
    let missing = message(ExternalSolver::cbc().with_program("no-such-solver"));
    assert!(
        missing == "cannot start `no-such-solver`; check that it is installed and on the `PATH`",
        "{missing}"
    );
    let silent = message(Pretended::new("silent", "echo licence expired; exit 3").solver());
    assert!(silent.contains("it wrote no solution; it printed last: licence expired"), "{silent}");
    let babble = "printf 'Optimal - objective value 2\\nhello\\n' > $out";
    let babble = message(Pretended::new("babble", babble).solver());
    assert!(babble.contains("its solution has a line without a value"), "{babble}");
    let stranger = "printf 'Optimal - objective value 2\\n0 speed 1 0\\n' > $out";
    let stranger = message(Pretended::new("stranger", stranger).solver());
    assert!(stranger.contains("it says that `speed` is 1"), "{stranger}");
    let mut quadratic = model.clone();
    quadratic.minimize(model.objective().clone() + Quadratic::zero()).unwrap();
    let x = quadratic.variable_by_name("x").unwrap();
    quadratic.minimize(x.square()).unwrap();
    let refused = ExternalSolver::cbc().solve(&quadratic).unwrap_err().to_string();
    assert!(refused.contains("cbc does not take a quadratic objective; solve it"), "{refused}");
    let mut conic = model.clone();
    conic.add("disc[2]", norm([2.0 * x, x - 1.0]).le(7.0)).unwrap();
    for (solver, name) in [
        (ExternalSolver::cbc(), "cbc"),
        (ExternalSolver::highs(), "highs"),
        (ExternalSolver::glpk(), "glpsol"),
    ] {
        let refused = { solver }.solve(&conic).unwrap_err();
        assert!(matches!(refused.kind(), ErrorKind::Unsupported { .. }), "{refused}");
        assert_eq!(
            refused.to_string(),
            format!(
                "{name} does not take norms and quadratic rows such as `disc[2]`; solve it with \
                 `BranchAndBound`, or write linear rows in their place"
            )
        );
    }
}

#[test]
fn what_hangs_is_stopped() {
    let (model, _) = gate();
    let hanging = Pretended::new("hanging", "exec sleep 60");
    let interrupt = Interrupt::new();
    let (mut solver, start) = (hanging.solver(), Instant::now());
    let solution = std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(200));
            interrupt.trigger();
        });
        solver.solve_with(&model, &mut Control::default().with_interrupt(&interrupt)).unwrap()
    });
    assert_eq!(solution.termination(), Termination::Interrupted);
    assert!(solution.point().is_none() && solution.bound() == f64::NEG_INFINITY);
    let options = Options::default().with_time_limit(Duration::from_millis(100));
    let solution = hanging.solver().with_options(options).solve(&model).unwrap();
    assert_eq!(solution.termination(), Termination::TimeLimit);
    // It sleeps for a minute; that it was not waited for is the point, not how long it took.
    assert!(start.elapsed() < Duration::from_secs(50));
}

/// The file that is handed over, as the program sees it.
#[test]
fn the_file_is_a_minimisation_with_plain_names() {
    #[derive(Debug)]
    struct Copying;
    impl Dialect for Copying {
        fn program(&self) -> &str {
            "cp"
        }
        fn takes_cones(&self) -> bool {
            true
        }
        fn arguments(&self, files: &Files, _: &Options, _: Option<Duration>) -> Vec<String> {
            let path = |p: &PathBuf| p.to_string_lossy().into_owned();
            vec![path(&files.model), path(&files.solution)]
        }
        fn read(&self, solution: Option<&str>, _: &str) -> Result<ExternalAnswer, String> {
            Err(solution.unwrap_or("nothing").replace('\n', ";"))
        }
    }
    let mut model = Model::new("m");
    let x = model.continuous("x y".replace(' ', "-").as_str(), -1.0, 4.0).unwrap();
    model.add("limit", (2.0 * x).le(3.0)).unwrap();
    model.maximize(x + 7.0).unwrap();
    let text = ExternalSolver::new(Copying).solve(&model).unwrap_err().to_string();
    let words: Vec<&str> = text.split_whitespace().collect();
    let text = words.join(" ");
    assert!(text.contains("N obj; L r0;COLUMNS; c0 obj -1; c0 r0 2;RHS; RHS r0 3;"), "{text}");
    // A norm is a quadratic row.
    model.add("speed", norm([x - 1.0, 2.0 * x]).le(5.0)).unwrap();
    let text = ExternalSolver::new(Copying).solve(&model).unwrap_err().to_string();
    let words: Vec<&str> = text.split_whitespace().collect();
    let text = words.join(" ");
    assert!(text.contains("N obj; L r0; E r1; L q0;COLUMNS;"), "{text}");
    assert!(text.contains("RHS r1 1; RHS q0 25;"), "{text}");
    assert!(text.contains(";QCMATRIX q0; c0 c0 4; c1 c1 1;ENDATA"), "{text}");
}

/// A program that takes cones, and answers like CBC.
#[derive(Debug)]
struct Conic;

impl Dialect for Conic {
    fn program(&self) -> &str {
        "conic"
    }
    fn takes_cones(&self) -> bool {
        true
    }
    fn arguments(&self, files: &Files, options: &Options, time: Option<Duration>) -> Vec<String> {
        Cbc.arguments(files, options, time)
    }
    fn read(&self, solution: Option<&str>, printed: &str) -> Result<ExternalAnswer, String> {
        Cbc.read(solution, printed)
    }
}

#[test]
fn points_of_programs_with_cones_are_certified() {
    let mut model = Model::new("disc");
    let (x, y) =
        (model.continuous("x", -9.0, 9.0).unwrap(), model.continuous("y", -9.0, 9.0).unwrap());
    model.add("disc", norm([x + 1.0, 1.0 * y]).le(2.0)).unwrap();
    model.maximize(x + y).unwrap();
    // The third column is the square root of a square; the point is outside of the disc.
    let answer = |objective: f64| {
        format!(
            "printf 'Optimal - objective value {objective}\\n0 c0 0.5 1\\n1 c1 1.5 1\\n2 c2 1.5 0\\n' > $out"
        )
    };
    let best = 8.0_f64.sqrt() - 1.0;
    let program = Pretended::new("disc", &answer(-best));
    let mut solver = ExternalSolver::new(Conic).with_program(program.path.to_string_lossy());
    let solution = solver.solve(&model).unwrap();
    assert!(solution.is_optimal(), "{solution:?}");
    assert_eq!(solution.point().unwrap().as_slice().len(), 2);
    assert!((solution.objective().unwrap() - best).abs() < 1e-5);
    assert!((solution.value(x).unwrap() - (2.0_f64.sqrt() - 1.0)).abs() < 1e-3);
    // What is not there is not believed.
    let program = Pretended::new("no_disc", &answer(-2.0));
    let mut solver = ExternalSolver::new(Conic).with_program(program.path.to_string_lossy());
    let solution = solver.solve(&model).unwrap();
    assert_eq!(solution.termination(), Termination::Stalled);
    assert!((solution.objective().unwrap() - best).abs() < 1e-5);
}

// -- folders and the operating system ------------------------------------------------------------

/// Notes the folder that it is given, and panics where its answer is read.
#[derive(Debug, Clone, Default)]
struct Panicking {
    folder: Arc<Mutex<PathBuf>>,
}

impl Dialect for Panicking {
    fn program(&self) -> &str {
        "true"
    }
    fn arguments(&self, files: &Files, _: &Options, _: Option<Duration>) -> Vec<String> {
        *self.folder.lock().unwrap() = files.model.parent().unwrap().to_owned();
        Vec::new()
    }
    fn read(&self, _: Option<&str>, _: &str) -> Result<ExternalAnswer, String> {
        let mode = self.folder.lock().unwrap().metadata().unwrap().permissions().mode();
        panic!("mode {:o}", mode & 0o777)
    }
}

#[test]
fn folders_are_private_and_go_even_when_reading_panics() {
    let (model, _) = gate();
    let mut seen = Vec::new();
    for _ in 0..2 {
        let dialect = Panicking::default();
        let mut solver = ExternalSolver::new(dialect.clone());
        let solved = catch_unwind(AssertUnwindSafe(|| solver.solve(&model)));
        let panic = solved.expect_err("it panics");
        assert_eq!(panic.downcast_ref::<String>().unwrap(), "mode 700");
        let folder = dialect.folder.lock().unwrap_or_else(PoisonError::into_inner).clone();
        assert!(!folder.exists(), "{} is still there", folder.display());
        seen.push(folder);
    }
    assert_ne!(seen[0], seen[1]);
}

/// The error of the operating system at the end of a chain of sources.
fn system_error(error: &Error) -> &std::io::Error {
    assert!(matches!(error.kind(), ErrorKind::Io { .. }), "{error}");
    error.source().and_then(|source| source.downcast_ref()).expect("an io error")
}

#[test]
fn a_missing_program_keeps_the_error_of_the_system() {
    let (model, _) = gate();
    let error = ExternalSolver::cbc().with_program("no-such-solver").solve(&model).unwrap_err();
    assert_eq!(system_error(&error).kind(), std::io::ErrorKind::NotFound);
    let whole = format!("{error:#}");
    assert!(whole.starts_with(&format!("{error}: ")) && whole.len() > error.to_string().len());
    assert_eq!(format!("{error:?}"), format!("{whole} [operating-system]"));
    assert_eq!(error, error.clone());
}

#[test]
fn an_answer_that_cannot_be_read_keeps_the_error_of_the_system() {
    let (model, _) = gate();
    let error = Pretended::new("folder", "mkdir $out").solver().solve(&model).unwrap_err();
    assert!(error.to_string().starts_with("cannot read the answer of `"), "{error}");
    assert_eq!(system_error(&error).kind(), std::io::ErrorKind::IsADirectory);
}

/// No folder can be made where the folder for temporary files is a file. The test calls itself,
/// because the variable of the environment belongs to the whole process.
#[test]
fn a_folder_that_cannot_be_made_keeps_the_error_of_the_system() {
    const NAME: &str = "a_folder_that_cannot_be_made_keeps_the_error_of_the_system";
    if std::env::var_os("CAROM_NO_FOLDER").is_none() {
        let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("no_folder");
        std::fs::write(&file, "").unwrap();
        let mut itself = Command::new(std::env::current_exe().unwrap());
        itself.args(["--exact", NAME]).env("CAROM_NO_FOLDER", "1").env("TMPDIR", &file);
        let output = itself.output().unwrap();
        let printed = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && printed.contains("1 passed"), "{printed}");
        return;
    }
    let (model, _) = gate();
    let error = ExternalSolver::cbc().solve(&model).unwrap_err();
    assert!(
        error.to_string().starts_with("no temporary folder can be made for `cbc`; "),
        "{error}"
    );
    assert_eq!(system_error(&error).kind(), std::io::ErrorKind::NotADirectory);
}

// -- real programs ------------------------------------------------------------------------------

/// The programs that are installed; CBC and GLPK are not missing where that is required.
fn installed() -> Vec<ExternalSolver> {
    let required = std::env::var("CAROM_EXTERNAL").is_ok_and(|value| value == "required");
    let found = |solver: &ExternalSolver, program: &str, needed: bool| {
        let runs = Command::new(program).arg("--version").output().is_ok();
        assert!(runs || !(required && needed), "{} is not installed", solver.name());
        runs
    };
    let known = [
        (ExternalSolver::cbc(), "cbc", true),
        (ExternalSolver::glpk(), "glpsol", true),
        (ExternalSolver::highs(), "highs", false),
        (ExternalSolver::scip(), "scip", false),
    ];
    let here =
        known.into_iter().filter(|(solver, program, needed)| found(solver, program, *needed));
    here.map(|(solver, ..)| solver).collect()
}

/// The public suite, as far as these programs go.
#[test]
fn programs_pass_the_suite() {
    // Most of the time is waiting.
    std::thread::scope(|scope| {
        for mut solver in installed() {
            let mut lacking = vec![Capability::Events];
            if solver.name() != "scip" {
                lacking.extend([
                    Capability::Quadratic,
                    Capability::MixedIntegerQuadratic,
                    Capability::Cones,
                ]);
            }
            if solver.name() == "glpsol" {
                lacking.push(Capability::NodeLimit);
            }
            let suite = Suite::default().without(lacking);
            scope.spawn(move || suite.run(&mut solver).assert_passed());
        }
    });
}

proptest! {
    #![proptest_config(config(40, "tests/regressions/external.txt"))]

    /// Random linear programs with integers and indicators.
    #[test]
    fn programs_agree_with_enumeration(case in case(Shape { quadratic: false, ..Shape::BOUNDED })) {
        let (model, _) = case.build();
        for mut solver in installed() {
            let solution = solver.solve(&model).unwrap();
            match optimum(&case) {
                Minimum::Attained { value, point } => {
                    prop_assert!(solution.is_optimal(), "{}: {solution:?}", solver.name());
                    let found = case.sign() * solution.objective().unwrap();
                    prop_assert!((found - value).abs() < 1e-5 * value.abs().max(1.0), "{point:?}");
                    let point = solution.point().unwrap();
                    prop_assert_eq!(case.violation(point.as_slice(), 1e-6), None);
                }
                _ => prop_assert!(solution.is_infeasible(), "{}: {solution:?}", solver.name()),
            }
        }
    }
}

/// Coarse relatives of the scenes in `docs/scenes.md`, each with a horizon.
fn scenes() -> Vec<(&'static str, Scene, usize)> {
    let bounce = |e: f64| Surface::bounce(Restitution::new(e).unwrap());
    let point = |state: [f64; 4]| Region::point(state);
    let table = [Interval::new(0.0, 2.0), Interval::new(0.0, 1.0)];
    let puck = Body::new("puck", table, 3.0, 3.0)
        .with_start(point([1.2, 0.2, 2.0, 2.0]))
        .with_goal(point([0.4, 0.2, 0.0, 0.0]));
    let bank = Scene::new(0.1).with_body(puck).with_room("cushion", table, bounce(0.9));
    let hall = [Interval::new(0.0, 4.0), Interval::new(0.0, 2.0)];
    let drone = Body::new("drone", hall, 1.5, 2.0)
        .with_start(point([0.5, 1.0, 0.0, 0.0]))
        .with_goal(point([3.5, 1.0, 0.0, 0.0]));
    let box_of = |x: [f64; 2], y: [f64; 2]| [Interval::new(x[0], x[1]), Interval::new(y[0], y[1])];
    let room = |name: &str, surface| Solid::cuboid(name, box_of([1.5, 2.0], [-0.1, 1.3]), surface);
    let boxes = Scene::new(0.5)
        .with_body(drone.clone())
        .with_obstacle(room("low", Surface::avoid()))
        .with_obstacle(Solid::cuboid("high", box_of([2.6, 3.0], [0.7, 2.1]), Surface::avoid()));
    let pillar = Scene::new(0.5).with_body(drone.clone()).with_obstacle(room("low", bounce(0.5)));
    let door = Solid::cuboid("door", box_of([1.9, 2.1], [-0.5, 2.5]), Surface::avoid());
    let course = (0..=9).map(|t| [0.0, 0.5 * (0.5 * f64::from(t) - 1.0_f64).clamp(0.0, 4.0)]);
    let gate = Scene::new(0.5).with_body(drone).with_obstacle(door.with_course(course));
    vec![
        ("bank shot", bank.clone(), 13),
        ("bank shot", bank, 15),
        ("boxes", boxes, 8),
        ("pillar", pillar, 7),
        ("gate", gate.clone(), 6),
        ("gate", gate, 9),
    ]
}

/// Programs of scenes, as MPS files: the same status, the same optimum, a point that replays.
#[test]
fn programs_agree_about_scenes() {
    for mut solver in installed().into_iter().filter(|solver| solver.name() != "glpsol") {
        for (name, scene, steps) in scenes() {
            let mut program = scene.program(steps).unwrap();
            let fuel = program.fuel().unwrap();
            program.minimize(fuel).unwrap();
            let own = BranchAndBound::default().solve(program.model()).unwrap();
            let other = solver.solve(program.model()).unwrap();
            assert_eq!(own.termination(), other.termination(), "{name}, {steps} steps");
            if let (Some(one), Some(two)) = (own.objective(), other.objective()) {
                assert!((one - two).abs() < 1e-5 * one.abs().max(1.0), "{name}: {one}, {two}");
                assert!(program.plan(&other).is_ok(), "{name}");
            }
        }
    }
}

/// Numbers that look random, and are always the same.
struct Random(u64);

impl Random {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }
}

/// Compares shadow prices and reduced costs of a linear program with those of GLPK's simplex
/// method.
fn assert_multipliers(model: &Model) {
    let folder = tempfile::tempdir().unwrap();
    let (file, answer) = (folder.path().join("model.mps"), folder.path().join("answer"));
    let solution = BranchAndBound::default().solve(model).unwrap();
    assert!(solution.is_optimal(), "{solution:?}");

    std::fs::write(&file, carom::model::mps::write(model).unwrap()).unwrap();
    let arguments =
        ["--freemps".as_ref(), file.as_os_str(), "--write".as_ref(), answer.as_os_str()];
    assert!(Command::new("glpsol").args(arguments).output().unwrap().status.success());
    let text = std::fs::read_to_string(&answer).unwrap();
    // `i` or `j`, number, status, value, dual value.
    let duals = |kind: &str| -> Vec<f64> {
        let lines = text.lines().map(|line| line.split(' ').collect::<Vec<_>>());
        let of_kind = lines.filter(|words| words[0] == kind);
        of_kind.map(|words| words[4].parse().unwrap()).collect()
    };
    let near = |ours: f64, theirs: f64| (ours - theirs).abs() <= 1e-4 * theirs.abs().max(1.0);
    let (prices, costs) = (duals("i"), duals("j"));
    assert_eq!((prices.len(), costs.len()), (model.constraint_count(), model.variable_count()));
    for (row, theirs) in model.constraints().zip(prices) {
        let ours = solution.shadow_price(row.id()).unwrap();
        assert!(near(ours, theirs), "{}: {ours} beside {theirs}\n{model}", row.name());
    }
    for (variable, theirs) in model.variables().zip(costs) {
        let ours = solution.reduced_cost(variable.id()).unwrap();
        assert!(near(ours, theirs), "{}: {ours} beside {theirs}\n{model}", variable.name());
    }
}

/// Random data make the optimum unique, with a single basis.
#[test]
fn multipliers_agree_with_glpk() {
    if !installed().iter().any(|solver| solver.name() == "glpsol") {
        return;
    }
    let mut random = Random(1);
    for _ in 0..20 {
        let mut model = Model::new("blend");
        let x: Vec<_> = (0..8)
            .map(|j| {
                let (lower, upper) = (random.within(-1.0, 0.0), random.within(1.0, 3.0));
                model.continuous(("x", j), lower, upper).unwrap()
            })
            .collect();
        for i in 0..5 {
            let sum: Affine = x.iter().map(|&x| random.within(-1.0, 2.0) * x).sum();
            let row = if i < 3 {
                sum.ge(random.within(0.5, 1.5))
            } else {
                sum.le(random.within(1.0, 2.0))
            };
            model.add(("row", i), row).unwrap();
        }
        model.minimize(x.iter().map(|&x| random.within(0.1, 2.0) * x).sum::<Affine>()).unwrap();
        assert_multipliers(&model);
    }
}

/// The continuous relaxation of models with integers and indicators. Selectors of disjunctions
/// would make optima degenerate.
#[test]
fn multipliers_of_relaxations_agree_with_glpk() {
    if !installed().iter().any(|solver| solver.name() == "glpsol") {
        return;
    }
    let mut random = Random(2);
    for _ in 0..20 {
        let mut model = Model::new("relaxed");
        let x: Vec<_> = (0..6)
            .map(|j| model.continuous(("x", j), 0.0, random.within(2.0, 5.0)).unwrap())
            .collect();
        let n: Vec<_> = (0..4)
            .map(|j| model.integer(("n", j), 0.0, random.within(2.0, 6.0).floor()).unwrap())
            .collect();
        for i in 0..4 {
            let sum: Affine = x.iter().chain(&n).map(|&x| random.within(0.1, 2.0) * x).sum();
            model.add(("row", i), sum.ge(random.within(4.0, 9.0))).unwrap();
        }
        let z = model.binary("z").unwrap();
        let much = (x[0] + random.within(0.5, 1.5) * n[0]).ge(random.within(1.5, 3.0));
        model.add("much", z.on().implies(much)).unwrap();
        let cost: Affine = x.iter().chain(&n).map(|&x| random.within(0.5, 2.0) * x).sum();
        // Worth its price: where the condition is off, the row is degenerate.
        model.minimize(cost - random.within(6.0, 9.0) * z).unwrap();
        assert_multipliers(&relaxed(&model).unwrap());
    }
}
