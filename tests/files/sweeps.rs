//! Files of sweeps: what they hold, and what is wrong with others.

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

use carom::prelude::*;
use carom::sweep::{Sweep, SweepRecord, SweepResults};
use proptest::prelude::*;

fn sweep() -> Sweep {
    Sweep::grid("small", [("a", vec![0.1, 2.0, -3.5e30]), ("b", vec![1.0, 2.0])]).unwrap()
}

/// Runs a sweep; returns also how many cases were run.
fn run(sweep: &Sweep) -> Result<(SweepResults, usize), Error> {
    let count = AtomicUsize::new(0);
    let results = sweep.run(|case| {
        count.fetch_add(1, Ordering::Relaxed);
        let record = SweepRecord::new()
            .with_number("sum", case.value("a") + case.value("b"))
            .with_number("none", None)
            .with_number("far", f64::INFINITY)
            .with_text("word", "a \"quoted\\ word\"\n{\"sweep\":");
        Ok(Some(record))
    })?;
    Ok((results, count.into_inner()))
}

fn assert_whole(results: &SweepResults) {
    assert_eq!(results.missing().count(), 0);
    assert_eq!(results.to_string(), "6 of 6 cases are known");
    let record = results.record(1).unwrap();
    assert_eq!(record.number("sum"), Some(0.1 + 2.0));
    assert_eq!(record.number("none"), None);
    assert_eq!(record.number("far"), Some(f64::INFINITY));
    assert_eq!(record.text("word"), Some("a \"quoted\\ word\"\n{\"sweep\":"));
    assert_eq!(record.number("a"), None);
}

#[test]
fn every_end_of_a_file_is_taken_up() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let sweep = sweep().with_file(&path).with_threads(1);
    let (results, count) = run(&sweep).unwrap();
    assert_whole(&results);
    assert_eq!(count, 6);
    let whole = fs::read(&path).unwrap();
    for length in 0..=whole.len() {
        fs::write(&path, &whole[..length]).unwrap();
        let (results, count) = run(&sweep).unwrap();
        assert_whole(&results);
        let lines = whole[..length].iter().filter(|&&byte| byte == b'\n').count();
        // A line that lacks nothing but its end is whole.
        let is_whole = whole.get(length) == Some(&b'\n');
        assert_eq!(count, 6 - lines - usize::from(is_whole), "{length}");
        assert_eq!(fs::read(&path).unwrap(), whole, "{length}");
    }
}

#[test]
fn results_say_what_is_missing() {
    let shard = sweep().with_shard("2/4").unwrap();
    let (results, count) = run(&shard).unwrap();
    assert_eq!(count, 2);
    assert_eq!(results.missing().collect::<Vec<_>>(), [0, 2, 3, 4]);
    assert_eq!(results.to_string(), "2 of 6 cases are known; missing: 0, 2, 3, 4");
    let interrupt = Interrupt::new();
    interrupt.trigger();
    let (results, count) = run(&sweep().with_interrupt(&interrupt)).unwrap();
    assert_eq!((results.missing().count(), count), (6, 0));
}

#[test]
fn an_error_of_a_case_keeps_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let sweep = sweep().with_file(&path).with_threads(1);
    let failed = sweep.run(|case| match case.index() {
        4 => Err(Error::other("case 4")),
        k => Ok(Some(SweepRecord::new().with_number("k", k as f64))),
    });
    assert_eq!(failed.unwrap_err().to_string(), "case 4");
    assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), 4);
    assert_eq!(run(&sweep).unwrap().1, 2);
}

#[test]
fn other_files_and_names_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let own = sweep().with_file(&path);
    run(&own).unwrap();
    let whole = fs::read_to_string(&path).unwrap();
    let error = |sweep: &Sweep| {
        let before = fs::read(&path).unwrap();
        let text = run(sweep).unwrap_err().to_string().replace(&*path.to_string_lossy(), "FILE");
        assert_eq!(fs::read(&path).unwrap(), before);
        text
    };
    let foreign = "line 1 of `FILE` belongs to another sweep; choose another file, or run the sweep \
                   that it belongs to";
    let grid = |title, a: f64| Sweep::grid(title, [("a", vec![a]), ("b", vec![2.0])]).unwrap();
    assert_eq!(error(&grid("small", 1.0).with_file(&path)), foreign);
    for (line, expected) in [
        ("steps,time", "is no record of a sweep; give the sweep a file of its own"),
        ("{\"a\":1}", "is no record of a sweep; give the sweep a file of its own"),
        (
            &whole.lines().next().unwrap().replace("\"case\":", "\"case\":6"),
            "names no case of the sweep; remove the line",
        ),
    ] {
        for end in ["", "\n", "\n\n"] {
            fs::write(&path, format!("{whole}{line}{end}")).unwrap();
            assert_eq!(error(&own), format!("line 7 of `FILE` {expected}"));
        }
    }
    let nowhere = sweep().with_file(folder.path().join("no").join("file"));
    let text = format!("{}", run(&nowhere).unwrap_err());
    assert!(text.ends_with("; make the folder first"), "{text}");

    let text = |error: Error| error.to_string();
    for shard in ["", "1", "0/2", "3/2", "1/0", "a/b", "1/2/3", "-1/2"] {
        let expected =
            format!("`{shard}` is no shard; give `i/n` with i from 1 to n, such as `1/8`");
        assert_eq!(text(sweep().with_shard(shard).unwrap_err()), expected);
    }
    let names = Sweep::list("s", ["a", "a"], [vec![1.0, 2.0]]).unwrap_err();
    let help = "give each value a name of its own, but `sweep` or `case`";
    assert_eq!(text(names), format!("`a` cannot be a name of sweep `s`; {help}"));
    let case = Sweep::list("s", ["a"], [vec![1.0], vec![]]).unwrap_err();
    let expected = "case 1 of sweep `s` has 0 values for 1 names; give a value for every name";
    assert_eq!(text(case), expected);
    let value = Sweep::list("s", ["a"], [vec![f64::NAN]]).unwrap_err();
    assert_eq!(text(value), "a value of `a` is NaN; give a finite number");
}

proptest! {
    #[test]
    fn records_come_back(text in ".*", name in ".+", value in any::<f64>()) {
        let record = SweepRecord::new().with_text(&name, &text).with_number("number ", value);
        let again = SweepRecord::from_line(&record.to_line()).unwrap();
        prop_assert_eq!(again.text(&name), Some(&*text));
        let number = again.number("number ").unwrap();
        prop_assert!(number == value || number.is_nan() && value.is_nan());
        // No part of a line is a line.
        let line = record.to_line();
        for (end, _) in line.char_indices() {
            prop_assert_eq!(SweepRecord::from_line(&line[..end]), None);
        }
    }

    #[test]
    fn no_line_makes_it_panic(line in ".*") {
        let _ = SweepRecord::from_line(&line);
        let _ = SweepRecord::from_line(&format!("{{\"a\":{line}"));
    }
}
