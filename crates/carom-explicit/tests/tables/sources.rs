//! Sources in C and Rust against the look-up, and 32 bits against 64.

use std::fmt::Write;
use std::process::Command;

use carom::ErrorKind;
use carom::explicit::{ExplicitProgram, ExplicitTable, LookupAnswer, LookupArrays};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;

use crate::limits::steps;
use crate::programs::programs;
use crate::solving::pushes;

/// Tables that have plans, states without a plan, and open ones.
fn tables() -> Vec<ExplicitTable> {
    let mut runner = TestRunner::deterministic();
    let mut tables = Vec::new();
    while tables.len() < 6 {
        let program = programs().new_tree(&mut runner).unwrap().current();
        let built = program.build();
        let explicit = ExplicitProgram::new(&built.model, built.axes, built.outputs).unwrap();
        let finest = if program.axes == 3 { 0.5 } else { 1.0 / 16.0 };
        let table = explicit.with_finest(finest).unwrap().with_cell_limit(300).build();
        if table.report().cells > 20 {
            tables.push(table);
        }
    }
    tables
}

/// Tables whose devices exchange pairs.
fn solving_tables() -> Vec<ExplicitTable> {
    let mut runner = TestRunner::deterministic();
    let mut tables = Vec::new();
    while tables.len() < 2 {
        let program = programs().new_tree(&mut runner).unwrap().current();
        if program.squares[0] == 0.0 {
            continue;
        }
        let built = program.build();
        let explicit = ExplicitProgram::new(&built.model, built.axes, built.outputs).unwrap();
        let finest = if program.axes == 3 { 0.5 } else { 1.0 / 16.0 };
        let table = explicit.with_finest(finest).unwrap().with_cell_limit(300).build();
        let single = table.single_solving();
        if single.view().programs.iter().any(|own| own.exchanges > 0) {
            tables.push(table);
        }
    }
    tables
}

/// States in the box, a few outside, a few at corners.
fn states(axes: usize, count: usize) -> Vec<Vec<f64>> {
    let mut runner = TestRunner::deterministic();
    let state = proptest::collection::vec(-1.05..=1.05_f64, axes);
    let mut states: Vec<Vec<f64>> = vec![vec![-1.0; axes], vec![1.0; axes], vec![f64::NAN; axes]];
    states.extend((0..count).map(|_| state.new_tree(&mut runner).unwrap().current()));
    states
}

fn word<T>(answer: &LookupAnswer<T>) -> i32 {
    match answer {
        LookupAnswer::Plan { .. } => 0,
        LookupAnswer::NoPlan => 1,
        LookupAnswer::Open => 2,
        LookupAnswer::Outside => 3,
        LookupAnswer::Damaged => 4,
    }
}

#[test]
fn single_numbers_differ_by_their_rounding() {
    for table in tables() {
        let (double, single) = (table.double(), table.single());
        assert!(single.view().is_sound());
        assert!(single.bytes() < double.bytes());
        let axes = single.state_rounding().len();
        for state in states(axes, 500) {
            let narrow: Vec<f32> = state.iter().map(|&x| x as f32).collect();
            let mut inputs = vec![0.0; single.inputs()];
            let answer = single.view().evaluate(&narrow, &mut inputs);
            // Each of the states that the look-up may have taken has a cell; one of them must agree.
            let near = |shift: &[f64]| {
                let moved: Vec<f64> = narrow
                    .iter()
                    .zip(shift)
                    .map(|(&x, d)| (f64::from(x) + d).clamp(-1.0, 1.0))
                    .collect();
                table.evaluate(&moved)
            };
            if word(&answer) == 3 {
                assert!(state.iter().any(|x| x.abs() > 1.0 || x.is_nan()));
                continue;
            }
            let off = single.state_rounding();
            let agrees = (0..3_usize.pow(axes as u32)).any(|pattern| {
                let mut rest = pattern;
                let mut shift = Vec::new();
                for off in off {
                    shift.push((rest % 3) as f64 * off - off);
                    rest /= 3;
                }
                let (other, others) = near(&shift);
                let apart = inputs.iter().zip(&others).map(|(a, b)| (f64::from(*a) - b).abs());
                // Gains are at most some hundreds here.
                word(&answer) == word(&other) && apart.fold(0.0, f64::max) < 1e-3
            });
            assert!(agrees, "{state:?} {answer:?}");
        }
    }
}

/// The answer of a look-up, and the bits of its inputs and its loss.
fn double_bits(arrays: &LookupArrays<f64>, state: &[f64]) -> String {
    let (mut inputs, mut work) = (vec![0.0; arrays.inputs()], vec![0.0; arrays.work()]);
    let answer = arrays.view().solve(state, &mut inputs, &mut work);
    inputs.push(if let LookupAnswer::Plan { loss } = answer { loss } else { 0.0 });
    let bits: Vec<String> = inputs.iter().map(|x| format!(" {}", x.to_bits())).collect();
    format!("{}{}", word(&answer), bits.concat())
}

fn single_bits(arrays: &LookupArrays<f32>, state: &[f64]) -> String {
    let state: Vec<f32> = state.iter().map(|&x| x as f32).collect();
    let (mut inputs, mut work) = (vec![0.0; arrays.inputs()], vec![0.0; arrays.work()]);
    let answer = arrays.view().solve(&state, &mut inputs, &mut work);
    inputs.push(if let LookupAnswer::Plan { loss } = answer { loss } else { 0.0 });
    let bits: Vec<String> = inputs.iter().map(|x| format!(" {}", x.to_bits())).collect();
    format!("{}{}", word(&answer), bits.concat())
}

/// Compiles a table in C, and compares it with the look-up.
fn assert_c_agrees(
    texts: [String; 2],
    is_double: bool,
    states: &[Vec<f64>],
    expected: impl Fn(&[f64]) -> String,
) {
    let folder = tempfile::tempdir().unwrap();
    let [header, source] = texts;
    let number = if is_double { "double" } else { "float" };
    let bits = if is_double { "uint64_t" } else { "uint32_t" };
    let mut values = String::new();
    for state in states.iter().flatten() {
        match is_double {
            true => write!(values, "{}ULL,", state.to_bits()).unwrap(),
            false => write!(values, "{}UL,", (*state as f32).to_bits()).unwrap(),
        }
    }
    let main = format!(
        "#include \"law.h\"
#include <stdint.h>
#include <stdio.h>
#include <string.h>
static const {bits} states[] = {{ {values} }};
int main(void)
{{
    size_t k;
    for (k = 0; k < sizeof states / sizeof states[0]; k += LAW_STATES) {{
        {number} state[LAW_STATES];
        {number} inputs[LAW_INPUTS + 1];
        {bits} out;
        int m;
        int answer;
        memset(inputs, 0, sizeof inputs);
        memcpy(state, states + k, sizeof state);
        answer = (int)law_evaluate(state, inputs, inputs + LAW_INPUTS);
        printf(\"%d\", answer);
        for (m = 0; m <= LAW_INPUTS; m++) {{
            memcpy(&out, inputs + m, sizeof out);
            printf(\" %llu\", (unsigned long long)out);
        }}
        printf(\"\\n\");
    }}
    return 0;
}}
"
    );
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("law.h"), header).unwrap();
    std::fs::write(path("law.c"), source).unwrap();
    std::fs::write(path("main.c"), main).unwrap();
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-O2", "-pedantic"];
    let compile = |words: &[&str]| {
        let compiled =
            Command::new("cc").current_dir(&folder).args(strict).args(words).output().unwrap();
        assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    };
    compile(&["-c", "law.c"]);
    // Nothing is called to copy or clear numbers; what guards a stack is the compiler's own.
    if let Ok(symbols) = Command::new("nm").current_dir(&folder).args(["-u", "law.o"]).output() {
        let symbols = String::from_utf8_lossy(&symbols.stdout);
        assert!(!symbols.contains("mem") && !symbols.contains("printf"), "{symbols}");
    }
    compile(&["law.o", "main.c", "-o", "law"]);
    let output = Command::new(path("law")).output().unwrap();
    let output = String::from_utf8(output.stdout).unwrap();
    let mut lines = output.lines();
    for state in states {
        assert_eq!(lines.next(), Some(&expected(state)[..]), "{state:?}");
    }
    assert_eq!(lines.next(), None);
}

#[test]
fn c_agrees_bit_for_bit() {
    if Command::new("cc").arg("--version").output().is_err() {
        return;
    }
    let agree = |double: &LookupArrays<f64>, single: &LookupArrays<f32>| {
        let states = states(double.state_rounding().len(), 1000);
        let bits = |state: &[f64]| double_bits(double, state);
        assert_c_agrees(double.c_source("law").unwrap(), true, &states, bits);
        let bits = |state: &[f64]| single_bits(single, state);
        assert_c_agrees(single.c_source("law").unwrap(), false, &states, bits);
    };
    for table in tables().iter().take(3) {
        agree(table.double(), &table.single());
    }
    for table in solving_tables() {
        agree(&table.double_solving(), &table.single_solving());
    }
}

#[test]
fn rust_sources_hold_the_numbers_of_the_table() {
    for table in tables() {
        let text = table.single().rust_source("LAW").unwrap();
        assert!(text.contains("pub const LAW: carom_embedded::LookupTable<f32>"));
        let after = text.split("values: &[").nth(1).unwrap();
        let values = after.split(']').next().unwrap().split(',').map(str::trim);
        let values: Vec<f32> =
            values.filter(|v| !v.is_empty()).map(|v| v.parse().unwrap()).collect();
        assert_eq!(values, table.single().view().values);
    }
}

/// The table of `steps` as it was written.
#[allow(unreachable_pub)]
mod written {
    include!("steps_law.rs");
    include!("pushes_law.rs");
}

#[test]
fn written_tables_are_constants() {
    let (model, x, u) = steps();
    let table = ExplicitProgram::new(&model, [x], [u]).unwrap().build().single();
    let text = table.rust_source("STEPS").unwrap();
    let (model, x, sum) = pushes();
    let solving = ExplicitProgram::new(&model, [x], [sum]).unwrap().build().single_solving();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables");
    if std::env::var_os("CAROM_WRITE_TABLES").is_some() {
        std::fs::write(folder.join("steps_law.rs"), text).unwrap();
        std::fs::write(folder.join("pushes_law.rs"), solving.rust_source("PUSHES").unwrap())
            .unwrap();
        return;
    }
    for k in 0..=60 {
        let state = [k as f32 / 10.0 - 3.0];
        let (mut own, mut other) = ([0.0], [0.0]);
        let answer = table.view().evaluate(&state, &mut own);
        assert_eq!(word(&answer), word(&written::STEPS.evaluate(&state, &mut other)));
        assert!((own[0] - other[0]).abs() < 1e-5, "{state:?} {own:?} {other:?}");
        let (mut work, mut other_work) = (vec![0.0; solving.work()], [0.0; 100]);
        let answer = solving.view().solve(&state, &mut own, &mut work);
        let written = written::PUSHES.solve(&state, &mut other, &mut other_work);
        assert_eq!(word(&answer), word(&written));
        assert!((own[0] - other[0]).abs() < 1e-5, "{state:?} {own:?} {other:?}");
    }
    assert!(written::PUSHES.programs.iter().any(|own| own.exchanges > 0));
}

#[test]
fn names_are_checked() {
    let table = tables().remove(0);
    for name in ["", "1a", "a b", "a-b"] {
        let error = table.double().c_source(name).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::Unsupported { .. }), "{error}");
        assert!(table.single().rust_source(name).is_err());
    }
}
