//! Sweeps that are killed go on where they were, and shards are merged by concatenation.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::thread;
use std::time::Duration;

use crate::{Said, example, file};

/// A folder of its own for files of sweeps.
fn folder(name: &str) -> PathBuf {
    let folder = file("sweeps", b"").with_file_name(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The words of a map of 15 x 15 plans.
fn words(folder: &Path, file: &Path, shard: &str) -> Vec<String> {
    let words = ["--csv", "--size", "15", "--time-step", "0.02", "--shard", shard];
    let mut words = words.map(str::to_owned).to_vec();
    for (name, path) in [("--out", folder), ("--file", file)] {
        words.extend([name.to_owned(), path.to_str().unwrap().to_owned()]);
    }
    words
}

fn run(folder: &Path, file: &Path, shard: &str) -> Said {
    Said::new(example("map").args(words(folder, file, shard)).output().unwrap())
}

/// The lines of a file in order, each once.
fn lines(file: &Path) -> Vec<String> {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.ends_with('\n'));
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines.sort();
    lines
}

#[test]
fn a_killed_sweep_goes_on_where_it_was() {
    let folder = folder("killed");
    let (whole, killed) = (folder.join("whole.jsonl"), folder.join("killed.jsonl"));
    let said = run(&folder, &whole, "1/1");
    assert_eq!(said.code, Some(0), "{said:?}");
    let whole = lines(&whole);
    assert_eq!(whole.len(), 225);

    let mut state = 20_261_126_u64;
    let mut known = BTreeSet::new();
    for kill in 0..10 {
        let mut child = example("map");
        child.args(words(&folder, &killed, "1/1")).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = child.spawn().unwrap();
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let lines = || fs::read(&killed).map_or(0, |text| text.split(|&b| b == b'\n').count());
        let wanted = (lines() + (state >> 33) as usize % 20).min(220);
        while lines() < wanted && child.try_wait().unwrap().is_none() {
            thread::sleep(Duration::from_millis(1));
        }
        thread::sleep(Duration::from_millis((state >> 40) % 20));
        // SIGKILL, which nobody catches.
        child.kill().unwrap();
        child.wait().unwrap();
        let text = fs::read_to_string(&killed).unwrap_or_default();
        known.insert(text.lines().count());
        if kill % 2 == 1 {
            // As if the kill had come within a line.
            fs::write(&killed, &text[..text.len().saturating_sub(kill)]).unwrap();
        }
    }
    assert!(known.len() > 2, "the kills came too late or too early: {known:?}");
    let said = run(&folder, &killed, "1/1");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(lines(&killed), whole);
    // There is nothing left to do, and the rows are the same.
    let again = run(&folder, &killed, "1/1");
    assert_eq!((again.code, again.out), (Some(0), said.out));
    assert_eq!(lines(&killed), whole);
}

#[test]
fn shards_are_merged_by_concatenation() {
    let folder = folder("shards");
    let whole = folder.join("whole.jsonl");
    let expected = run(&folder, &whole, "1/1");
    let mut merged = Vec::new();
    for shard in ["1/3", "2/3", "3/3"] {
        let file = folder.join("shard.jsonl");
        let _ = fs::remove_file(&file);
        let said = run(&folder, &file, shard);
        assert_eq!(said.code, Some(0), "{said:?}");
        assert_eq!(lines(&file).len(), 75);
        merged.extend(fs::read(&file).unwrap());
        // A shard that was killed within a line.
        merged.extend(b"{\"sweep\":\"map of st");
    }
    let file = folder.join("merged.jsonl");
    fs::write(&file, merged).unwrap();
    let said = run(&folder, &file, "1/1");
    assert_eq!((said.code, &said.out), (Some(0), &expected.out));
    let whole: BTreeSet<String> = lines(&whole).into_iter().collect();
    let found = fs::read_to_string(&file).unwrap();
    assert_eq!(found.lines().count(), 225);
    assert!(whole.iter().all(|line| found.contains(line.as_str())));

    let other = Said::new(
        example("map")
            .args(["--csv", "--size", "14", "--out", folder.to_str().unwrap(), "--file"])
            .arg(&file)
            .output()
            .unwrap(),
    );
    assert_eq!(other.code, Some(1), "{other:?}");
    assert!(other.err.contains("belongs to another sweep"), "{other:?}");
    assert_eq!(fs::read_to_string(&file).unwrap(), found);
    let said = run(&folder, &file, "4/3");
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("`4/3` is no shard; give `i/n` with i from 1 to n"), "{said:?}");
}
