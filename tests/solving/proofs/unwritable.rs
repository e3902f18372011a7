//! Proofs that cannot be written: known before the search, or told beside its answer.

use std::fs;

use carom::ErrorKind;
use carom::prelude::*;
use carom::solution::Point;
use carom_proof::{Claim, check};
use tempfile::tempdir;

fn model() -> Result<Model, Error> {
    let mut model = Model::new("cover");
    let x = model.binary_family("x", 7)?;
    for k in 0..7 {
        model.add(("pair", k), (x[k] + x[(k + 1) % 7]).ge(1.0))?;
    }
    model.minimize(x.iter().map(|x| 1.0 * x).sum::<Affine>())?;
    Ok(model)
}

#[test]
fn a_path_that_cannot_be_written_is_refused_before_the_search() -> Result<(), Error> {
    let (model, folder) = (model()?, tempdir().unwrap());
    let file = folder.path().join("file");
    fs::write(&file, "old").unwrap();
    for path in [folder.path().join("missing/a.proof"), file.join("below")] {
        let mut events = 0;
        let mut count = |_: &Event| events += 1;
        let mut control = Control::default().with_progress(&mut count);
        let mut solver = BranchAndBound::new(Options::default().with_proof(&path));
        let error = solver.solve_with(&model, &mut control).unwrap_err();
        assert_eq!(events, 0);
        assert!(matches!(error.kind(), ErrorKind::Io { .. }), "{error}");
        assert_eq!(
            error.to_string(),
            format!(
                "the proof cannot be written to {}; choose a file or a folder that can be written",
                path.display()
            )
        );
        assert!(solver.prepare(&model)?.solve(&[], &mut Control::default()).is_err());
        let source = |_: &Point| Ok(Vec::new());
        let mut control = Control::default().with_lazy_constraints(&source);
        assert!(solver.solve_with(&model, &mut control).is_err());
    }
    // A search without a claim leaves what was there, and nothing where nothing was.
    let interrupt = Interrupt::new();
    interrupt.trigger();
    for path in [file.clone(), folder.path().join("new"), folder.path().to_owned()] {
        let mut control = Control::default().with_interrupt(&interrupt);
        let mut solver = BranchAndBound::new(Options::default().with_proof(&path));
        let solution = solver.solve_with(&model, &mut control)?;
        assert!(solution.proof().is_none() && solution.point().is_none());
    }
    assert_eq!(fs::read_to_string(&file).unwrap(), "old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    Ok(())
}

/// The answer is as good as without a proof, and says what has failed.
#[test]
fn a_folder_that_goes_does_not_lose_the_answer() -> Result<(), Error> {
    let model = model()?;
    for lazily in [false, true] {
        let folder = tempdir().unwrap();
        let path = folder.path().join("logs");
        fs::create_dir(&path).unwrap();
        let proof = path.join("a.proof");
        let mut told = Vec::new();
        let mut remove = |event: &Event| {
            fs::remove_dir_all(&path).ok();
            told.push(event.clone());
        };
        let source = |_: &Point| Ok(Vec::new());
        let mut control = Control::default().with_progress(&mut remove);
        if lazily {
            control = control.with_lazy_constraints(&source);
        }
        let mut solver = BranchAndBound::new(Options::default().with_proof(&proof));
        let solution = solver.solve_with(&model, &mut control)?;
        assert_eq!((solution.is_optimal(), solution.objective()), (true, Some(4.0)));
        let report = solution.proof().unwrap();
        assert!(!report.is_complete);
        let failure = report.failure.as_ref().unwrap();
        let begins = format!("the proof cannot be written to {}: ", proof.display());
        assert!(failure.starts_with(&begins), "{failure}");
        assert!(matches!(told.last(), Some(Event::Proving(_))), "{told:?}");
        let mut log = Log::new(Vec::new());
        log.finish(&solution);
        let text = String::from_utf8(log.into_inner().unwrap()).unwrap();
        assert!(text.contains(&begins), "{text}");
    }
    Ok(())
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_does_not_lose_the_answer() -> Result<(), Error> {
    let solution =
        BranchAndBound::new(Options::default().with_proof("/dev/full")).solve(&model()?)?;
    assert_eq!(solution.objective(), Some(4.0));
    let failure = solution.proof().unwrap().failure.as_ref().unwrap();
    assert!(failure.contains("/dev/full"), "{failure}");
    Ok(())
}

/// The report has the bound that the log claims, in the sense of the model.
#[test]
fn the_report_says_what_is_claimed() -> Result<(), Error> {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.proof");
    let mut solver = BranchAndBound::new(Options::default().with_proof(&path));
    for sign in [1.0, -1.0] {
        let mut model = model()?;
        let x: Vec<Variable> = model.variables().map(|x| x.id()).collect();
        let sum: Affine = x.iter().map(|x| 1.0 * x).sum::<Affine>() + 0.25;
        if sign > 0.0 {
            model.minimize(sum)?
        } else {
            model.maximize(-1.0 * sum)?
        };
        let solution = solver.solve(&model)?;
        let report = solution.proof().unwrap();
        assert!(report.is_complete && report.failure.is_none());
        let bound = report.bound.unwrap();
        let log = fs::read(&path).unwrap();
        assert_eq!(check(&log[..]).unwrap().claim, Claim::Bound(sign * bound));
        assert!(sign * bound <= sign * solution.bound(), "{bound}");
        assert!((bound - sign * 4.25).abs() <= 1e-5, "{bound}");
        model.add("none", (1.0 * x[0] + x[1]).le(0.5))?;
        let solution = solver.solve(&model)?;
        assert!(solution.is_infeasible());
        assert_eq!(solution.proof().unwrap().bound, None);
    }
    Ok(())
}
