//! The call of AMPL: NL files there, SOL files back, whatever becomes of the program.

use std::fs;
use std::path::Path;

use carom::model::nl::{self, SolFile};
use carom::prelude::*;

use crate::{Said, example, file, solve};

/// 3 x + 2 y + z over one row, with an integer: 13 at (2, 3, 1).
fn bag() -> Result<Model, Error> {
    let mut model = Model::new("bag");
    let x = model.integer("x", 0.0, 2.0)?;
    let y = model.continuous("y", 0.0, 3.0)?;
    let z = model.binary("z")?;
    model.add("c", (2.0 * x + y + 4.0 * z).le(11.0))?;
    model.maximize(3.0 * x + 2.0 * y + z)?;
    Ok(model)
}

/// The stub of a file of the tests.
fn stub(name: &str, text: &str) -> String {
    let path = file(&format!("{name}.nl"), text.as_bytes());
    let _ = fs::remove_file(path.with_extension("sol"));
    path.with_extension("").to_str().unwrap().to_owned()
}

/// Calls the program, and reads its answer.
fn called(stub: &str, words: &[&str], environment: &str) -> (Said, SolFile) {
    let mut command = example("solve");
    command.args([&[stub, "-AMPL"], words].concat()).env("carom_options", environment);
    let said = Said::new(command.output().unwrap());
    let path = format!("{}.sol", stub.strip_suffix(".nl").unwrap_or(stub));
    let text =
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}: {said:?}"));
    (said, SolFile::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}")))
}

#[test]
fn the_answer_has_values_bound_and_code() -> Result<(), Error> {
    let model = bag()?;
    let stub = stub("bag", &nl::write(&model)?);
    for name in [stub.clone(), format!("{stub}.nl")] {
        let (said, answer) = called(&name, &[], "");
        assert_eq!((said.code, &*said.out, &*said.err), (Some(0), "", ""));
        assert_eq!((answer.code, answer.objective, answer.rows, answer.columns), (0, 0, 1, 3));
        let start = concat!("carom ", env!("CARGO_PKG_VERSION"), ": optimal: objective 13, ");
        assert!(answer.message.starts_with(start), "{}", answer.message);
        let values: Vec<f64> = answer.values_of(&model)?.iter().map(|(_, value)| *value).collect();
        let expected = [2.0, 3.0, 1.0];
        assert!(values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{values:?}");
        let bound = answer.bound.expect("a bound");
        assert!((13.0 - 1e-9..13.0 + 1e-4).contains(&bound), "{bound}");
        assert!(answer.multipliers.is_empty());
    }
    // The answer is a start of the same program.
    let sol = format!("{stub}.sol");
    let said = solve(&[&format!("{stub}.nl"), "--start", &sol], b"");
    assert!(said.err.lines().any(|line| line == "start: accepted"), "{said:?}");
    assert_eq!(said.figure("objective"), "13");
    Ok(())
}

#[test]
fn prices_come_with_programs_without_integers() -> Result<(), Error> {
    let mut model = Model::new("diet");
    let x = model.continuous_family("x", 2, 0.0, 10.0)?;
    model.add("more", (x[0] - x[1]).le(30.0))?;
    model.add("need", (2.0 * x[0] + 4.0 * x[1]).ge(12.0))?;
    model.minimize(x[0] + 3.0 * x[1])?;
    let (_, answer) = called(&stub("diet", &nl::write(&model)?), &[], "");
    assert!((answer.multipliers[1] - 0.5).abs() < 1e-6, "{answer:?}");
    assert!(answer.multipliers[0].abs() < 1e-6 && answer.code == 0, "{answer:?}");
    Ok(())
}

#[test]
fn every_end_has_its_code() -> Result<(), Error> {
    let mut model = bag()?;
    let text = nl::write(&model)?;
    let known = stub("ends", &text);
    let (_, limited) = called(&known, &["timelim=0"], "");
    assert!([400, 470].contains(&limited.code), "{limited:?}");
    let x = model.variable_by_name("x")?;
    model.add("much", (2.0 * x).ge(5.0))?;
    let (_, none) = called(&stub("none", &nl::write(&model)?), &[], "");
    assert_eq!((none.code, none.values.len(), none.rows), (200, 0, 2));
    let mut open = Model::new("open");
    let y = open.continuous("y", f64::NEG_INFINITY, f64::INFINITY)?;
    open.minimize(y)?;
    assert_eq!(called(&stub("open", &nl::write(&open)?), &[], "").1.code, 300);
    // Without its objective it has an optimum.
    let (_, any) = called(&stub("any", &nl::write(&open)?), &["objno=0"], "");
    assert_eq!((any.code, any.objective, any.bound), (0, -1, None));
    // The message of a failure has the name and the place.
    let refused = text.replace("O0 1\nn0\n", "O0 1\no13\nv0\n");
    let (said, refused) = called(&stub("refused", &refused), &[], "");
    assert_eq!((said.code, refused.code, refused.columns), (Some(0), 500, 3));
    assert!(refused.message.contains("line 14, column 1: `floor` is not taken; "), "{refused:?}");
    assert!(refused.message.ends_with("[unsupported]"), "{refused:?}");
    Ok(())
}

#[test]
fn options_come_from_the_environment_and_the_call() -> Result<(), Error> {
    let stub = stub("options", &nl::write(&bag()?)?);
    let proof = format!("{stub}.proof");
    let quoted = format!("proof = '{proof}' timelim 60 outlev=1");
    let (said, answer) = called(&stub, &["threads=2", "mipgap", "1e-4"], &quoted);
    assert_eq!((said.code, answer.code), (Some(0), 0));
    assert!(said.err.contains("1 row, 3 columns (2 integral)"), "{said:?}");
    assert!(Path::new(&proof).exists());
    // The call comes after the environment.
    assert_eq!(called(&stub, &["outlev=0"], "outlev=1").0.err, "");
    for (words, environment, part) in [
        (&["colour=red"][..], "", "no option is called `colour`; `solve -=` lists them"),
        (&["threads=two"], "", "threads cannot be `two`"),
        (&["timelim=-1"], "", "timelim cannot be `-1`"),
        (&["objno=2"], "", "objno cannot be `2`; of several objectives the first one is solved"),
        (&[], "timelim", "the option `timelim` needs a value"),
    ] {
        let (said, answer) = called(&stub, words, environment);
        assert_eq!((said.code, answer.code), (Some(0), 500), "{answer:?}");
        assert!(answer.message.ends_with(part), "{answer:?}");
    }
    let said = solve(&["-="], b"");
    assert!(said.code == Some(0) && said.out.contains("\n  timelim S "), "{said:?}");
    let version = concat!("carom ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!(solve(&["-v"], b"").out, version);
    Ok(())
}

/// Values in the file are where a search begins.
#[test]
fn a_guess_in_the_file_is_a_start() -> Result<(), Error> {
    let text = nl::write(&bag()?)?.replace("\nr\n", "\nx2\n1 1\n2 2\nr\n");
    let path = file("guess.nl", text.as_bytes());
    let said = solve(&[path.to_str().unwrap()], b"");
    assert!(said.err.lines().any(|line| line.starts_with("start: ")), "{said:?}");
    assert_eq!(said.figure("objective"), "13");
    Ok(())
}

#[test]
fn what_is_no_file_of_ampl_has_no_answer() {
    let said = solve(&["-AMPL"], b"");
    assert_eq!((said.code, &*said.err), (Some(2), "solve: no file is named before `-AMPL`\n"));
    let said = solve(&["/no/such/stub", "-AMPL"], b"");
    assert_eq!(said.code, Some(1));
    assert!(said.err.starts_with("solve: /no/such/stub.nl: "), "{said:?}");
    let stub = stub("no_header", "maximize x\n");
    let said = solve(&[&stub, "-AMPL"], b"");
    assert_eq!((said.code, fs::exists(format!("{stub}.sol")).unwrap()), (Some(1), false));
    assert!(said.err.contains("line 1, column 1: expected `g` or `b`"), "{said:?}");
}

#[test]
fn files_of_ampl_are_read_written_and_recognised() -> Result<(), Error> {
    let path = file("as_model.nl", nl::write(&bag()?)?.as_bytes());
    let path = path.to_str().unwrap();
    assert_eq!(solve(&[path, "--quiet"], b"").figure("objective"), "13");
    let text = fs::read(path).unwrap();
    assert_eq!(solve(&["-"], &text).figure("objective"), "13");
    assert_eq!(solve(&["-", "--format", "nl"], &text).figure("objective"), "13");
    let lp = path.replace(".nl", ".lp");
    let again = path.replace("as_model", "again");
    assert_eq!(solve(&[path, "--write", &lp], b"").code, Some(0));
    assert_eq!(solve(&[&lp, "--write", &again], b"").code, Some(0));
    assert_eq!(solve(&[&again], b"").figure("objective"), "13");
    Ok(())
}
