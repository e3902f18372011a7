//! The examples as programs: what `solve` reads and prints, and what Ctrl-C does. Cargo builds
//! examples before it runs the tests.

mod ampl;
mod compressed;
#[cfg(unix)]
mod interrupts;
mod options;
mod outputs;
mod pictures;
#[cfg(unix)]
mod sweeps;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;

/// The command that runs an example.
fn example(name: &str) -> Command {
    static BUILDING: Mutex<()> = Mutex::new(());
    let tests = std::env::current_exe().unwrap();
    let folder = tests.parent().and_then(Path::parent).unwrap();
    let path = folder.join("examples").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    // Where only this file of tests is asked for, nobody has built it yet.
    let _one_at_a_time = BUILDING.lock();
    if !path.exists() {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--example", name, "--target-dir"]).arg(folder.parent().unwrap());
        if folder.ends_with("release") {
            cargo.arg("--release");
        }
        let features = [
            (cfg!(feature = "nalgebra"), "nalgebra"),
            (cfg!(feature = "serde"), "serde"),
            (cfg!(feature = "tracing"), "tracing"),
        ];
        for (_, feature) in features.iter().filter(|(is_on, _)| *is_on) {
            cargo.args(["--features", feature]);
        }
        assert!(cargo.status().unwrap().success(), "the example {name} cannot be built");
    }
    Command::new(path)
}

/// What `solve` said, and its exit status.
#[derive(Debug)]
struct Said {
    out: String,
    err: String,
    code: Option<i32>,
}

impl Said {
    fn new(output: Output) -> Said {
        let [out, err] =
            [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        Said { out, err, code: output.status.code() }
    }

    /// A figure of the last line.
    fn figure(&self, name: &str) -> &str {
        let last = self.out.lines().last().unwrap_or_else(|| panic!("no output: {self:?}"));
        let mut figures = last.split(' ').filter_map(|word| word.split_once('='));
        figures.find(|(key, _)| *key == name).unwrap_or_else(|| panic!("no {name}: {self:?}")).1
    }
}

/// Runs `solve` with something on its standard input.
fn solve(words: &[&str], input: &[u8]) -> Said {
    let mut command = example("solve");
    command.args(words).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // It may end without reading.
    let _ = child.stdin.take().unwrap().write_all(input);
    Said::new(child.wait_with_output().unwrap())
}

/// A file of the tests.
fn file(name: &str, contents: &[u8]) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("terminal");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    std::fs::write(&path, contents).unwrap();
    path
}

/// Maximises 3 x + 2 y + z over one row: 13 at (2, 3, 1).
const LP: &str = "maximize\n obj: 3 x + 2 y + z\nsubject to\n c: 2 x + y + 4 z <= 11\n d: x - 0.5 y >= 0.5\n\
                  bounds\n x <= 2\n y <= 3\n z <= 1\ngeneral\n x y z\nend\n";
