//! Threads, builds that go on, and progress.

use std::time::Duration;

use carom::explicit::{ExplicitProgram, ExplicitTable, TableProgress};
use carom_proof::check_table;
use proptest::prelude::*;

use crate::certificates::damaged;
use crate::limits::steps;
use crate::programs::{Program, programs};

fn explicit<'a>(program: &Program) -> ExplicitProgram<'a> {
    let built = program.build();
    let explicit = ExplicitProgram::new(&built.model, built.axes, built.outputs).unwrap();
    let finest = if program.axes == 3 { 0.5 } else { 1.0 / 16.0 };
    explicit.with_loss(0.1, 0.01).unwrap().with_finest(finest).unwrap()
}

fn certificate(table: &ExplicitTable) -> Vec<u8> {
    let mut text = Vec::new();
    table.write_certificate(&mut text).unwrap();
    text
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn threads_make_no_difference(program in programs(), limit in 20..300_usize) {
        let one = explicit(&program).with_cell_limit(limit).with_threads(1).build();
        let many = explicit(&program).with_cell_limit(limit).with_threads(3).build();
        prop_assert_eq!(one.double(), many.double());
        prop_assert!(certificate(&one) == certificate(&many));
        prop_assert_eq!(one.report().relaxations, many.report().relaxations);
    }

    #[test]
    fn certificates_go_on(
        program in programs(),
        limit in 2..40_usize,
        kind in 0..12_usize,
        place in any::<u16>(),
    ) {
        let few = explicit(&program).with_cell_limit(limit).build();
        let (report, text) = (*few.report(), certificate(&few));
        // Without more cells it is the same table, but for cells that are tried anew.
        let same = explicit(&program).with_cell_limit(report.cells).resume_from(&text[..]).unwrap();
        let same = same.build();
        prop_assert_eq!(same.report().cells, report.cells);
        prop_assert!(same.report().proved + 1e-12 >= report.proved);
        prop_assert!(same.report().refuted + 1e-12 >= report.refuted);
        if report.open + report.unproved == 0.0 {
            prop_assert!(certificate(&same) == text);
        }
        let more = explicit(&program).with_cell_limit(200).resume_from(&text[..]).unwrap().build();
        prop_assert!(check_table(&certificate(&more)[..]).is_ok());
        // What is wrong is refused, or built anew.
        let text = String::from_utf8(text).unwrap();
        if let Some(damaged) = damaged(&text, kind, place.into(), &program) {
            let damaged = explicit(&program).with_cell_limit(100).resume_from(damaged.as_bytes());
            if let Ok(damaged) = damaged {
                let proved = check_table(&certificate(&damaged.build())[..]);
                prop_assert!(proved.is_ok(), "{}", proved.unwrap_err());
            }
        }
    }

    #[test]
    fn tables_go_on(program in programs(), limit in 2..40_usize) {
        let few = explicit(&program).with_cell_limit(limit).build();
        let before = *few.report();
        let more = explicit(&program).with_cell_limit(300).resume(few).unwrap().build();
        let report = *more.report();
        prop_assert!(report.proved + 1e-12 >= before.proved, "{before:?} {report:?}");
        prop_assert!(report.refuted + 1e-12 >= before.refuted, "{before:?} {report:?}");
        let proved = check_table(&certificate(&more)[..]);
        let proved = proved.map_err(|failure| TestCaseError::fail(failure.to_string()))?;
        prop_assert!((proved.within - report.proved).abs() < 1e-9);
        // Without more cells, nothing is cut; what is not proved is tried anew.
        let cells = report.cells;
        let again = explicit(&program).with_cell_limit(cells).resume(more).unwrap().build();
        prop_assert_eq!(again.report().cells, cells);
        prop_assert!(again.report().proved + 1e-12 >= report.proved);
    }
}

#[test]
fn a_smaller_loss_goes_on() {
    let (model, x, u) = steps();
    let new = || ExplicitProgram::new(&model, [x], [u]).unwrap();
    let wide = new().with_loss(0.5, 0.0).unwrap().build();
    let cells = wide.report().cells;
    // Without time, the laws of before are kept, also those that lose too much now.
    let late = new().with_loss(0.01, 0.0).unwrap().with_time_limit(Duration::ZERO);
    let wide = late.resume(wide).unwrap().build();
    assert_eq!((wide.report().cells, wide.report().open), (cells, 0.0));
    assert!(wide.report().unproved > 0.0);
    let fine = new().with_loss(0.01, 0.0).unwrap().resume(wide).unwrap().build();
    assert!(fine.report().cells > cells && fine.report().loss <= 0.01);
    assert!(fine.report().proved > 0.9);
    let error = ExplicitProgram::new(&model, [x], [2.0 * u]).unwrap().resume(fine).unwrap_err();
    assert!(error.to_string().contains("another program"), "{error}");
}

#[test]
fn progress_ends_at_the_whole() {
    let (model, x, u) = steps();
    let mut told: Vec<TableProgress> = Vec::new();
    let watch = |progress: &TableProgress| told.push(*progress);
    let explicit = ExplicitProgram::new(&model, [x], [u]).unwrap();
    let table = explicit.with_threads(2).with_progress(watch).build();
    for pair in told.windows(2) {
        assert!(pair[1].cells >= pair[0].cells && pair[1].share >= pair[0].share);
        assert!(pair[1].elapsed >= pair[0].elapsed);
    }
    assert!(told.iter().all(|progress| progress.expected_cells >= progress.cells));
    let last = told.last().unwrap();
    assert_eq!(last.cells, table.report().cells);
    assert_eq!(last.expected_cells, table.report().cells);
    assert!((last.share - 1.0).abs() < 1e-12);
}
