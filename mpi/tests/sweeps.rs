//! Sweeps on ranks that are threads.

use std::fs;
use std::thread;

use carom::sweep::{Sweep, SweepRecord, SweepResults};
use carom_mpi::{ThreadChannel, sweep_on};

fn run(
    sweep: &Sweep,
    ranks: usize,
    answer: impl Fn(usize) -> Result<Option<SweepRecord>, carom::Error> + Sync,
) -> Result<SweepResults, carom_mpi::Error> {
    let answer = &answer;
    let mut ends = ThreadChannel::ends(ranks);
    let workers: Vec<_> = ends.drain(1..).collect();
    thread::scope(|scope| {
        for mut end in workers {
            scope.spawn(move || sweep_on(sweep, &mut end, |case| answer(case.index())));
        }
        let results = sweep_on(sweep, &mut ends[0], |case| answer(case.index()));
        results.map(|results| results.expect("rank 0 has the results"))
    })
}

fn record(k: usize) -> Result<Option<SweepRecord>, carom::Error> {
    Ok(Some(SweepRecord::new().with_number("square", (k * k) as f64)))
}

#[test]
fn ranks_write_the_file_of_one_process() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = Sweep::grid("squares", [("k", (0..50).map(f64::from).collect())]).unwrap();
    let mut files = Vec::new();
    for ranks in [1, 2, 5] {
        let path = folder.path().join(ranks.to_string());
        let sweep = sweep.clone().with_file(&path);
        assert_eq!(run(&sweep, ranks, record).unwrap().missing().count(), 0);
        let text = fs::read_to_string(&path).unwrap();
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines.sort();
        files.push(lines);
        // Nothing is left to do.
        let none = |_| Err(carom::Error::other("called"));
        run(&sweep, ranks, none).unwrap();
    }
    assert!(files.iter().all(|lines| lines.len() == 50 && *lines == files[0]));
}

#[test]
fn a_failing_case_ends_all_ranks_and_keeps_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let sweep = Sweep::grid("squares", [("k", (0..50).map(f64::from).collect())]).unwrap();
    let sweep = sweep.with_file(&path);
    let failing = |k| if k == 20 { Err(carom::Error::other("no")) } else { record(k) };
    let error = run(&sweep, 3, failing).unwrap_err().to_string();
    assert!(error.starts_with("case 20 failed on rank ") && error.ends_with(": no"), "{error}");
    let known = fs::read_to_string(&path).unwrap().lines().count();
    assert!((19..50).contains(&known), "{known}");
    assert_eq!(run(&sweep, 4, record).unwrap().missing().count(), 0);

    fs::write(&path, "steps,time\n").unwrap();
    let error = run(&sweep, 3, record).unwrap_err().to_string();
    assert!(error.contains("is no record of a sweep"), "{error}");
}
