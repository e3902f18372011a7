//! Files and pipes that cannot be written, before the search and behind it; and what is said of
//! proofs, of programs without a bound, and of figures that are 1 or 0.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use carom_proof::{Claim, check};

use crate::{LP, Said, example, file, solve};

const INFEASIBLE: &str =
    "min x\nst\n low: x + y <= 1\n high: x + y >= 3\nbounds\n x <= 9\n y <= 9\nend\n";

/// The folder of the files of these tests.
fn path(name: &str) -> String {
    let path = file("outputs", b"").with_file_name(name);
    let _ = fs::remove_file(&path);
    path.to_str().unwrap().to_owned()
}

#[test]
fn files_that_cannot_be_written_are_refused_first() {
    for option in ["--proof", "--solution", "--write", "--lowered"] {
        let said = solve(&["-", option, "/no/such/folder/a.lp"], LP.as_bytes());
        assert_eq!((said.code, &*said.out), (Some(1), ""), "{option}: {said:?}");
        assert!(said.err.starts_with("solve: /no/such/folder/a.lp: "), "{option}: {said:?}");
        // Nothing is left behind where something else is wrong.
        let untouched = path("untouched.lp");
        let said = solve(&["/no/such/model.lp", option, &untouched], b"");
        assert_eq!(said.code, Some(1), "{option}: {said:?}");
        assert!(!fs::exists(&untouched).unwrap(), "{option}");
    }
    let said = solve(&["-", "--write", &path("a.xls")], LP.as_bytes());
    assert_eq!((said.code, &*said.out), (Some(1), ""), "{said:?}");
    assert!(said.err.contains("a.xls: expected .mps, .lp, .cbf, .nl or .json"), "{said:?}");
}

/// The answer is there, whatever becomes of the files.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_does_not_lose_the_answer() {
    let said = solve(&["-", "--proof", "/dev/full"], LP.as_bytes());
    assert_eq!((said.code, said.figure("status")), (Some(1), "optimal"), "{said:?}");
    assert_eq!(said.figure("objective"), "13");
    assert!(said.out.lines().any(|line| line == "proof=failed"), "{said:?}");
    let last = said.err.lines().last().unwrap();
    assert!(last.starts_with("solve: the proof cannot be written to /dev/full: "), "{said:?}");

    let said = solve(&["-", "--solution", "/dev/full"], LP.as_bytes());
    assert_eq!((said.code, said.figure("objective")), (Some(1), "13"), "{said:?}");
    assert!(said.err.contains("solve: /dev/full: "), "{said:?}");

    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let model = file("full.lp", LP.as_bytes());
    let output = example("solve").arg(model).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write: "), "{output:?}");
}

/// Whoever stops reading gets no panic, and files are written all the same.
#[test]
fn closed_pipes_are_no_error() {
    let (model, solution) = (file("closed.lp", LP.as_bytes()), path("closed.sol"));
    let words = [model.to_str().unwrap(), "--pool", "3", "--solution", &solution];
    let spawn = || {
        let mut command = example("solve");
        command.args(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let mut child = spawn();
    let mut out = BufReader::new(child.stdout.take().unwrap());
    let mut first = String::new();
    out.read_line(&mut first).unwrap();
    assert!(first.starts_with("rows=2 "), "{first}");
    drop(out);
    let said = Said::new(child.wait_with_output().unwrap());
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(fs::read_to_string(&solution).unwrap().starts_with("# Status: optimal"));

    let mut child = spawn();
    drop(child.stderr.take());
    let mut out = String::new();
    child.stdout.take().unwrap().read_to_string(&mut out).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0), "{out}");
    assert!(out.lines().last().unwrap().starts_with("status=optimal "), "{out}");
}

/// What the log proves is said, to the last digit.
#[test]
fn the_bound_of_the_log_is_printed() {
    let proof = path("bound.proof");
    let said = solve(&["-", "--log", "--proof", &proof], LP.as_bytes());
    let line = said.out.lines().find(|line| line.starts_with("proof=")).unwrap();
    assert!(line.starts_with("proof=complete claim=bound bound=13.0000"), "{said:?}");
    let bound = line.split(' ').find_map(|word| word.strip_prefix("bound=")).unwrap();
    let proved = check(fs::read(&proof).unwrap().as_slice()).unwrap();
    assert!(proved.to_string().contains(&format!("objective <= {bound} ")), "{proved}: {line}");
    assert!(said.err.contains("proof of the bound 13.0000"), "{said:?}");

    let said = solve(&["-", "--proof", &proof], INFEASIBLE.as_bytes());
    let line = said.out.lines().find(|line| line.starts_with("proof=")).unwrap();
    assert!(line.starts_with("proof=complete claim=infeasible commands="), "{said:?}");
    // The solves of an explanation write no proofs.
    let before = fs::read(&proof).unwrap();
    let said = solve(&["-", "--explain", "--proof", &proof], INFEASIBLE.as_bytes());
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(fs::read(&proof).unwrap(), before);
    assert_eq!(check(&before[..]).unwrap().claim, Claim::Infeasible);
}

#[test]
fn unbounded_programs_have_no_bound() {
    let said = solve(&["-", "--log"], b"max x + y\nst\n c: x - y >= 0\nend\n");
    assert_eq!((said.code, said.figure("status")), (Some(0), "unbounded"), "{said:?}");
    assert_eq!(said.figure("bound"), "-", "{said:?}");
    assert!(said.err.contains("bound -,"), "{said:?}");
}

#[test]
fn one_is_not_many_and_rounding_is_not_shown() {
    let said = solve(&["-"], b"min x\nst\n c: x >= 1\ngeneral\n x\nend\n");
    assert!(said.err.contains("\n1 row, 1 column (1 integral), 1 nonzero\n"), "{said:?}");
    assert!(!said.err.contains(" 1 nodes") && !said.err.contains(" 1 rows"), "{said:?}");
    // 0.1 + 0.2 - 0.3 is 5.6e-17 in floats.
    let text =
        "min 0.1 x + 0.2 y - 0.3 z\nst\n a: x >= 1\n b: y >= 1\n c: z <= 1\ngeneral\n x y z\nend\n";
    let said = solve(&["-", "--log"], text.as_bytes());
    assert_eq!((said.figure("objective"), said.figure("bound")), ("0", "0"), "{said:?}");
    assert!(said.err.contains("optimal: objective 0, bound 0, "), "{said:?}");
    // What is small by itself is shown.
    let said = solve(&["-"], b"min 1e-13 x\nst\n a: x >= 1\nend\n");
    assert_eq!(said.figure("objective"), "1e-13", "{said:?}");
}

/// Where no line moves, there is one now and then, whatever is done.
#[test]
fn silence_is_broken() {
    let mut command = example("solve");
    command.arg("-").stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    thread::sleep(Duration::from_millis(6500));
    child.stdin.take().unwrap().write_all(LP.as_bytes()).unwrap();
    let said = Said::new(child.wait_with_output().unwrap());
    assert_eq!(said.figure("status"), "optimal", "{said:?}");
    let still = said.err.lines().filter(|line| line.starts_with("still at reading, for 5 s ("));
    assert_eq!(still.count(), 1, "{said:?}");
}

#[test]
fn tools_have_help_and_tell_wrong_words() {
    for (name, wrong) in [("paper", &["--size", "3"]), ("map", &["--size", "1"])] {
        let run = |words: &[&str]| Said::new(example(name).args(words).output().unwrap());
        let help = run(&["--help"]);
        assert_eq!((help.code, &*help.err), (Some(0), ""), "{help:?}");
        for word in [&format!("usage: {name} ")[..], "--out FOLDER", "exit status: 0", "Ctrl-C"] {
            assert!(help.out.contains(word), "{word}: {help:?}");
        }
        for words in [&wrong[..], &["--color"], &["--out"]] {
            let said = run(words);
            assert_eq!((said.code, &*said.out), (Some(2), ""), "{words:?}: {said:?}");
            assert!(said.err.contains(&format!("usage: {name} ")), "{words:?}: {said:?}");
        }
    }
}

/// A folder that holds nothing.
fn empty_folder(name: &str) -> std::path::PathBuf {
    let folder = file("outputs", b"").with_file_name(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// A shard that is interrupted tells what it knows, and writes to no place that it was not told.
#[cfg(unix)]
#[test]
fn an_interrupted_shard_keeps_to_its_file() {
    let here = empty_folder("shard_here");
    let there = empty_folder("shard_there").join("map.jsonl");
    let mut command = example("map");
    command.args(["--size", "40", "--time-step", "0.005", "--shard", "1/2", "--file"]).arg(&there);
    command.current_dir(&here).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    thread::sleep(Duration::from_millis(1500));
    assert!(
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success()
    );
    let said = Said::new(child.wait_with_output().unwrap());
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.out.starts_with("interrupted: "), "{said:?}");
    assert!(said.out.contains(" of 1600 cells are known") || said.out.contains("cases are known"));
    assert_eq!(fs::read_dir(&here).unwrap().count(), 0, "{said:?}");
}
