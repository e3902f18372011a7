//! Certificates against the checker, whole and damaged.

use carom::explicit::{ExplicitProgram, ExplicitTable};
use carom_proof::{ProvedTable, check_table};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use crate::programs::{Program, programs};

fn table(program: &Program) -> ExplicitTable {
    let built = program.build();
    let explicit = ExplicitProgram::new(&built.model, built.axes, built.outputs).unwrap();
    let finest = if program.axes == 3 { 0.75 } else { 1.0 / 8.0 };
    let explicit = explicit.with_loss(0.1, 0.01).unwrap().with_finest(finest).unwrap();
    explicit.with_cell_limit(120).build().unwrap()
}

fn certificate(table: &ExplicitTable) -> String {
    let mut text = Vec::new();
    table.write_certificate(&mut text).unwrap();
    String::from_utf8(text).unwrap()
}

fn agrees(table: &ExplicitTable, proved: &ProvedTable) -> bool {
    let report = table.report();
    let is = |a: f64, b: f64| (a - b).abs() < 1e-9;
    proved.cells == report.cells as u64
        && is(proved.within, report.proved)
        && is(proved.larger + proved.unproved, report.unproved)
        && is(proved.refuted, report.refuted)
        && is(proved.open, report.open)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    #[test]
    fn certificates_are_accepted(program in programs()) {
        let table = table(&program);
        let proved = check_table(certificate(&table).as_bytes());
        let proved = proved.map_err(|failure| TestCaseError::fail(failure.to_string()))?;
        prop_assert!(agrees(&table, &proved), "{proved} {:?}", table.report());
    }
}
