//! The program `carom-mpi` in a build without MPI, whose ranks are threads: what it prints, and its
//! exit status.
#![cfg(not(feature = "mpi"))]

mod programs;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::thread;
use std::time::{Duration, Instant};

use carom::prelude::*;
use programs::{knapsack, market};

fn run(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_carom-mpi")).args(words).output().unwrap()
}

fn file(folder: &Path, model: &Model) -> String {
    let path = folder.join("model.json");
    fs::write(&path, serde_json::to_string(model).unwrap()).unwrap();
    path.to_str().unwrap().to_owned()
}

fn lines(output: &Output) -> Vec<String> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn it_prints_what_carom_prints() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), &knapsack(24, 3));
    let output = run(&[&path, "--ranks", "3"]);
    let out = lines(&output);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(out[0], "rows=3 columns=24 integers=24 nonzeros=72");
    let last = out.last().unwrap();
    assert!(last.starts_with("status=optimal objective="), "{last}");
    for figure in [" bound=", " nodes=", " seconds="] {
        assert!(last.contains(figure), "{last}");
    }
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(err.contains("rank 2: "), "{err}");
}

/// `mpirun` takes any status but 0 for a failure of the run.
#[test]
fn a_limit_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), &market(4, 40, true));
    let checkpoint = folder.path().join("checkpoint");
    let checkpoint = checkpoint.to_str().unwrap();
    let words = [&*path, "--ranks", "2", "--checkpoint", checkpoint, "--node-limit", "300"];
    let output = run(&words);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let out = lines(&output);
    let last = out.last().unwrap();
    assert!(last.starts_with("status=feasible ") || last.starts_with("status=limit "), "{last}");
    let output = run(&[&words[..], &["--resume"]].concat());
    let err = String::from_utf8(output.stderr).unwrap();
    let resumed = err.lines().find_map(|line| line.strip_prefix("resumed with ")).unwrap();
    let open: usize = resumed.strip_suffix(" open nodes").unwrap().parse().unwrap();
    assert!(open > 1, "{err}");
}

#[test]
fn wrong_words_are_told_from_errors() {
    for words in [&[][..], &["--color"], &["a.lp", "--every", "-3"], &["a.lp", "--ranks", "0"]] {
        let output = run(words);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(err.contains("usage: carom-mpi FILE"), "{err}");
    }
    assert_eq!(run(&["/no/such/file.lp"]).status.code(), Some(1));
    let help = run(&["--help"]);
    assert_eq!(help.status.code(), Some(0));
    assert!(String::from_utf8(help.stdout).unwrap().contains("exit status: 0"));
}

/// The first checkpoint does not wait, and the next ones come in time.
#[test]
fn checkpoints_come_from_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), &market(5, 50, true));
    let checkpoint = folder.path().join("checkpoint");
    let words = ["--quiet", "--ranks", "2", "--time-limit", "8", "--every", "3", "--checkpoint"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_carom-mpi"))
        .arg(&path)
        .args(words)
        .arg(&checkpoint)
        .spawn()
        .unwrap();
    let (began, mut seen) = (Instant::now(), Vec::new());
    let mut last = None;
    while child.try_wait().unwrap().is_none() {
        let written = fs::metadata(&checkpoint).and_then(|file| file.modified()).ok();
        if written.is_some() && written != last {
            last = written;
            seen.push(began.elapsed());
        }
        thread::sleep(Duration::from_millis(20));
    }
    assert!(child.wait().unwrap().success());
    // At the start, after 3 s and 6 s; a busy machine may be late by a half.
    assert!(seen.len() >= 3, "{seen:?}");
    assert!(seen[0] < Duration::from_secs(3), "{seen:?}");
    assert!(seen[1] - seen[0] < Duration::from_millis(4500), "{seen:?}");
}
