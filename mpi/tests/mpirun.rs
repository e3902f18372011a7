//! The program `carom-mpi` on the ranks of `mpirun`: the same answers as alone, and runs that are
//! killed.
#![cfg(feature = "mpi")]

mod programs;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use carom::prelude::*;
use programs::{knapsack, market, programs};

fn mpirun(ranks: usize, words: &[&str]) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["--allow-run-as-root", "--oversubscribe", "-n", &ranks.to_string()]);
    command.arg(env!("CARGO_BIN_EXE_carom-mpi")).args(words);
    command
}

fn file(folder: &Path, name: &str, model: &Model) -> PathBuf {
    let path = folder.join(format!("{name}.json"));
    fs::write(&path, serde_json::to_string(model).unwrap()).unwrap();
    path
}

/// A figure of the last line that the program has printed.
fn figure(output: &Output, name: &str) -> String {
    let text = String::from_utf8_lossy(&output.stdout);
    let words = text.lines().last().into_iter().flat_map(|line| line.split(' '));
    let found = words.filter_map(|word| word.split_once('=')).find(|(key, _)| *key == name);
    found.map(|(_, value)| value.to_owned()).unwrap_or_else(|| panic!("no {name} in {output:?}"))
}

fn assert_same(output: &Output, alone: &Solution, what: &str) {
    assert!(output.status.success(), "{what}: {output:?}");
    assert_eq!(figure(output, "status"), alone.termination().to_string(), "{what}");
    match alone.objective() {
        None => assert_eq!(figure(output, "objective"), "-", "{what}"),
        Some(best) => {
            let [own, bound] =
                ["objective", "bound"].map(|name| figure(output, name).parse::<f64>().unwrap());
            let allowed = 2e-6 * best.abs().max(1.0);
            assert!((own - best).abs() <= allowed, "{what}: {own}, alone {best}");
            assert!((bound - best).abs() <= allowed, "{what}: bound {bound}, alone {best}");
        }
    }
}

#[test]
fn ranks_of_mpi_come_to_the_answers_of_one_process() {
    let folder = tempfile::tempdir().unwrap();
    for (k, model) in programs().into_iter().enumerate() {
        let alone = BranchAndBound::default().solve(&model).unwrap();
        let path = file(folder.path(), &k.to_string(), &model);
        for ranks in [1, 2, 4] {
            let output = mpirun(ranks, &[path.to_str().unwrap(), "--quiet"]).output().unwrap();
            assert_same(&output, &alone, &format!("{} on {ranks}", model.name()));
        }
    }
}

/// The process of a rank of a run, by a word of its command line.
fn process_of(rank: &str, word: &str) -> Option<String> {
    fs::read_dir("/proc").unwrap().flatten().find_map(|entry| {
        let name = entry.file_name().into_string().ok()?;
        name.parse::<u32>().ok()?;
        let read = |what: &str| fs::read(entry.path().join(what)).ok();
        let own = |bytes: Vec<u8>, word: &str| {
            bytes.split(|&byte| byte == 0).any(|own| own == word.as_bytes())
        };
        let is_own = own(read("cmdline")?, word)
            && own(read("environ")?, &format!("OMPI_COMM_WORLD_RANK={rank}"));
        is_own.then_some(name)
    })
}

fn wait_for(child: &mut Child, found: impl Fn() -> bool) {
    let began = Instant::now();
    while !found() {
        assert!(child.try_wait().unwrap().is_none(), "the run is over too early");
        assert!(began.elapsed() < Duration::from_secs(60));
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_killed_rank_ends_the_run_and_the_checkpoint_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let model = market(4, 24, true);
    let alone = BranchAndBound::default().solve(&model).unwrap();
    let path = file(folder.path(), "market", &model);
    for (ranks, killed, later) in [(2, "1", 3), (4, "2", 1), (3, "0", 2)] {
        let checkpoint = folder.path().join(format!("{ranks}.checkpoint"));
        let words = [path.to_str().unwrap(), "--quiet", "--every", "0.05", "--resume"];
        let words = [&words[..], &["--checkpoint", checkpoint.to_str().unwrap()]].concat();
        let mut run = mpirun(ranks, &words);
        let mut run = run.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        wait_for(&mut run, || checkpoint.exists());
        thread::sleep(Duration::from_millis(50));
        let process = process_of(killed, checkpoint.to_str().unwrap()).expect("the rank");
        assert!(Command::new("kill").args(["-9", &process]).status().unwrap().success());
        assert!(!run.wait().unwrap().success(), "a run without one of its ranks has no answer");
        let output = mpirun(later, &words).output().unwrap();
        assert_same(&output, &alone, &format!("{ranks} ranks, then {later}"));
    }
}

/// A limit is no failure for `mpirun`, and the next run says how much is open.
#[test]
fn a_limit_leaves_a_run_that_can_be_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "market", &market(4, 40, true));
    let checkpoint = folder.path().join("checkpoint");
    let words = [path.to_str().unwrap(), "--node-limit", "300", "--resume", "--checkpoint"];
    let words = [&words[..], &[checkpoint.to_str().unwrap()]].concat();
    let output = mpirun(2, &words).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("rows=4 "), "{output:?}");
    let output = mpirun(2, &words).output().unwrap();
    assert!(String::from_utf8_lossy(&output.stderr).contains("resumed with "), "{output:?}");
}

#[test]
fn bad_checkpoints_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "knapsack", &knapsack(24, 3));
    let checkpoint = folder.path().join("checkpoint");
    let words = [path.to_str().unwrap(), "--quiet", "--checkpoint", checkpoint.to_str().unwrap()];
    for resume in [&["--resume"][..], &[]] {
        fs::write(&checkpoint, "no checkpoint").unwrap();
        let output = mpirun(2, &[&words[..], resume].concat()).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let text = String::from_utf8_lossy(&output.stderr);
        let expected = if resume.is_empty() { " exists; " } else { " is corrupt: the first line" };
        assert!(text.contains("carom-mpi: checkpoint `") && text.contains(expected), "{text}");
        assert_eq!(fs::read_to_string(&checkpoint).unwrap(), "no checkpoint");
    }
}
