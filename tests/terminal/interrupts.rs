//! Ctrl-C: the first one ends a search within a second and keeps what was found, the second one
//! ends the process.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Read};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::{Said, example, file};

/// The exit status after the first signal.
const INTERRUPTED: i32 = 3;

const COLUMNS: usize = 100;
const ROWS: usize = 10;

/// A knapsack with ten rows, which takes hours: weights from 1 to 1000, room for half of
/// everything, and values that go along with the weights.
struct Knapsack {
    value: Vec<u64>,
    weight: Vec<Vec<u64>>,
    room: Vec<u64>,
}

impl Knapsack {
    fn new() -> Self {
        let mut state = 20_261_126_u64;
        let mut random = |most: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            1 + (state >> 33) % most
        };
        let weight: Vec<Vec<u64>> =
            (0..ROWS).map(|_| (0..COLUMNS).map(|_| random(1000)).collect()).collect();
        let sum = |column: usize| weight.iter().map(|row| row[column]).sum::<u64>();
        let value = (0..COLUMNS).map(|column| sum(column) / ROWS as u64 + random(500)).collect();
        let room = weight.iter().map(|row| row.iter().sum::<u64>() / 2).collect();
        Knapsack { value, weight, room }
    }

    fn text(&self) -> String {
        let terms = |of: &[u64]| {
            of.iter().enumerate().fold(String::new(), |mut text, (k, a)| {
                let _ = write!(text, " + {a} x{k}");
                text
            })
        };
        let mut text = format!("maximize\n obj:{}\nsubject to\n", terms(&self.value));
        for (row, room) in self.weight.iter().zip(&self.room) {
            let _ = writeln!(text, "{} <= {room}", terms(row));
        }
        text += "binary\n";
        (0..COLUMNS).for_each(|k| text += &format!(" x{k}\n"));
        text + "end\n"
    }

    /// The value of a point that was written, after checking that it fits.
    fn judge(&self, path: &Path) -> f64 {
        let mut taken = vec![false; COLUMNS];
        for line in
            std::fs::read_to_string(path).unwrap().lines().filter(|line| !line.starts_with('#'))
        {
            let (name, value) = line.split_once(' ').unwrap();
            let value: f64 = value.parse().unwrap();
            assert!((value - 1.0).abs() < 1e-6, "{line}");
            taken[name[1..].parse::<usize>().unwrap()] = true;
        }
        let sum = |of: &[u64]| {
            of.iter().zip(&taken).filter(|(_, taken)| **taken).map(|(a, _)| a).sum::<u64>()
        };
        for (row, room) in self.weight.iter().zip(&self.room) {
            assert!(sum(row) <= *room);
        }
        sum(&self.value) as f64
    }
}

fn send(child: &Child, signal: &str) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// Begins to run an example.
fn start(name: &str, words: &[&str]) -> Child {
    let mut command = example(name);
    command.args(words).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// Reads lines until one of them tells of a point, and goes on reading in the background.
fn until_point(child: &mut Child) -> thread::JoinHandle<String> {
    let mut lines = BufReader::new(child.stderr.take().unwrap());
    let mut text = String::new();
    let is_point = |line: &str| !line.starts_with(' ') && line.split_whitespace().count() == 10;
    while !text.lines().skip_while(|line| !line.contains(" incumbent ")).any(is_point) {
        assert!(lines.read_line(&mut text).unwrap() > 0, "it ended: {text}");
    }
    thread::spawn(move || {
        let _ = lines.read_to_string(&mut text);
        text
    })
}

/// Ends a solve by a signal after a while. Returns what it said, and how long it took to end.
fn interrupted(signal: &str, threads: &str, wait: Duration, solution: &Path) -> (Said, Duration) {
    let model = file("knapsack.lp", Knapsack::new().text().as_bytes());
    let words =
        [model.to_str().unwrap(), "--threads", threads, "--solution", solution.to_str().unwrap()];
    let mut child = start("solve", &words);
    let err = until_point(&mut child);
    thread::sleep(wait);
    let began = Instant::now();
    send(&child, signal);
    let mut said = Said::new(child.wait_with_output().unwrap());
    let took = began.elapsed();
    said.err = err.join().unwrap();
    (said, took)
}

/// Something is measured that a busy machine may delay: the best of some attempts counts.
fn in_time(mut attempt: impl FnMut() -> Duration) {
    let mut least = Duration::MAX;
    for _ in 0..3 {
        least = least.min(attempt());
        if least < Duration::from_secs(1) {
            return;
        }
    }
    panic!("it took {least:?}");
}

#[test]
fn a_search_of_hours_ends_within_a_second_and_keeps_its_point() {
    let knapsack = Knapsack::new();
    for (signal, threads, wait) in [("-INT", "1", 0), ("-INT", "2", 700), ("-TERM", "1", 300)] {
        in_time(|| {
            let solution = file(&format!("kept{signal}{threads}.sol"), b"");
            let (said, took) = interrupted(signal, threads, Duration::from_millis(wait), &solution);
            assert_eq!(
                (said.code, said.figure("status")),
                (Some(INTERRUPTED), "feasible"),
                "{said:?}"
            );
            let figure = |name: &str| said.figure(name).parse::<f64>().unwrap();
            let (objective, bound) = (figure("objective"), figure("bound"));
            assert!(bound.is_finite() && objective < bound && bound < 1.1 * objective, "{said:?}");
            assert_eq!(knapsack.judge(&solution), objective);
            assert!(said.err.lines().any(|line| line.starts_with("interrupted: ")), "{said:?}");
            took
        });
    }
}

/// A signal in the proof ends it, and the answer of the search is printed.
#[test]
fn a_signal_in_the_proof_keeps_the_answer() {
    let model = file("knapsack_3.lp", Knapsack::new().text().as_bytes());
    let proof = file("interrupted.proof", b"");
    let words = [model.to_str().unwrap(), "--node-limit", "3000", "--proof"];
    let words = [&words[..], &[proof.to_str().unwrap()]].concat();
    in_time(|| {
        let mut child = start("solve", &words);
        let mut lines = BufReader::new(child.stderr.take().unwrap());
        let mut err = String::new();
        while !err.contains("the proof is written") {
            assert!(lines.read_line(&mut err).unwrap() > 0, "it ended: {err}");
        }
        thread::sleep(Duration::from_millis(100));
        let began = Instant::now();
        send(&child, "-INT");
        let said = Said::new(child.wait_with_output().unwrap());
        assert_eq!((said.code, said.figure("status")), (Some(INTERRUPTED), "feasible"), "{said:?}");
        assert!(said.out.lines().any(|line| line.starts_with("proof=incomplete ")), "{said:?}");
        began.elapsed()
    });
}

/// Before the search there is nothing to keep, so the first signal ends the process.
#[test]
fn a_signal_while_reading_ends_the_process() {
    let child = start("solve", &["-"]);
    thread::sleep(Duration::from_millis(300));
    // Shells let processes in the background ignore SIGINT.
    send(&child, "-TERM");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(15), "{output:?}");
}

#[test]
fn the_second_signal_ends_the_process() {
    let model = file("knapsack_2.lp", Knapsack::new().text().as_bytes());
    // The second one may come when all is over, or together with the first.
    for attempt in 0..20 {
        let mut child = start("solve", &[model.to_str().unwrap()]);
        let err = until_point(&mut child);
        let twice = format!("kill -INT {0}; sleep 0.00{attempt}; kill -INT {0}", child.id());
        let _ = Command::new("sh").args(["-c", &twice]).stderr(Stdio::null()).status();
        let output = child.wait_with_output().unwrap();
        let _ = err.join();
        match output.status.signal() {
            Some(signal) => return assert_eq!(signal, 2),
            None => assert_eq!(output.status.code(), Some(INTERRUPTED)),
        }
    }
    panic!("no second signal has ended the process");
}

/// Ends an example that runs for minutes.
fn tool(name: &str, words: &[&str]) -> (Said, Duration) {
    let child = start(name, words);
    thread::sleep(Duration::from_millis(1500));
    let began = Instant::now();
    send(&child, "-INT");
    let said = Said::new(child.wait_with_output().unwrap());
    (said, began.elapsed())
}

#[test]
fn tools_keep_what_is_proved() {
    let folder = file("plots", b"").with_file_name("interrupted");
    let folder = folder.to_str().unwrap();
    in_time(|| {
        let (said, took) =
            tool("map", &["--csv", "--size", "40", "--time-step", "0.005", "--out", folder]);
        assert_eq!(said.code, Some(INTERRUPTED), "{said:?}");
        assert_eq!(said.out.lines().count(), 1 + 40 * 40, "{said:?}");
        took
    });
    assert!(Path::new(folder).join("map.svg").exists());
    in_time(|| {
        let (said, took) = tool("paper", &["--out", folder]);
        assert_eq!(said.code, Some(INTERRUPTED), "{said:?}");
        assert!(said.out.starts_with("interrupted: "), "{said:?}");
        took
    });
    let out = Path::new(folder).join("torture");
    in_time(|| {
        let words = ["--cases", "10000000", "--family", "mixed", "--out", out.to_str().unwrap()];
        let (said, took) = tool("torture", &words);
        assert_eq!(said.code, Some(INTERRUPTED), "{said:?}");
        assert!(said.out.contains(" programs in ") && said.out.contains("right: "), "{said:?}");
        took
    });
}
