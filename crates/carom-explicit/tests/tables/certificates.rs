//! Certificates against the checker, whole and damaged.

use carom::explicit::{ExplicitProgram, ExplicitTable};
use carom_proof::{ProvedTable, check_table};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use crate::programs::{Program, programs};

fn table(program: &Program) -> ExplicitTable {
    let mut built = program.build();
    for &axis in &built.axes {
        // Ends that 32 bits round.
        built.model.set_parameter_range(axis, -1.1, 0.9).unwrap();
    }
    let explicit = ExplicitProgram::new(&built.model, built.axes, built.outputs).unwrap();
    let finest = if program.axes == 3 { 0.75 } else { 1.0 / 8.0 };
    let explicit = explicit.with_loss(0.1, 0.01).unwrap().with_finest(finest).unwrap();
    explicit.with_cell_limit(120).build()
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
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn certificates_are_accepted(program in programs()) {
        let table = table(&program);
        let proved = check_table(certificate(&table).as_bytes());
        let proved = proved.map_err(|failure| TestCaseError::fail(failure.to_string()))?;
        prop_assert!(agrees(&table, &proved), "{proved} {:?}", table.report());
    }
}

/// A plan with another value of a column.
fn with_entry(line: &str, column: &str, value: f64) -> String {
    let words: Vec<&str> = line.split(' ').skip(2).collect();
    let pairs = words.chunks(2).filter(|pair| pair[0] != column);
    let mut pairs: Vec<String> = pairs.map(|pair| pair.join(" ")).collect();
    pairs.push(format!("{column} {value}"));
    format!("x {} {}", pairs.len(), pairs.join(" "))
}

/// Multipliers of the other sign.
fn turned(line: &str) -> String {
    let turn = |(at, word): (usize, &str)| match at >= 3 && at % 2 == 1 {
        true if word.starts_with('-') => word[1..].to_owned(),
        true => format!("-{word}"),
        false => word.to_owned(),
    };
    line.split(' ').enumerate().map(turn).collect::<Vec<_>>().join(" ")
}

/// A damage of the programs of devices, by its kind; `None` if there is nothing to damage.
fn damage_program(
    lines: &mut [String],
    kind: usize,
    place: usize,
    program: &Program,
) -> Option<()> {
    let begin = ["m ", "solves ", "solves ", "q ", "q ", "solves ", "v "][kind - 11];
    let cells = lines.iter().position(|line| line.starts_with("cells"))? + 1;
    let cut = (0..8).find(|k| lines.get(cells + k).is_some_and(|line| line.starts_with("cut")));
    let all = lines.iter_mut().filter(|line| line.starts_with(begin));
    let mut all: Vec<&mut String> = all.collect();
    let which = place % all.len().max(1);
    let line = all.get_mut(which)?;
    let mut words: Vec<String> = line.split(' ').map(str::to_owned).collect();
    let number = |at: usize| words[at].parse::<f64>().ok();
    match kind {
        // An input is another one.
        11 => {
            let at = words.len() - program.axes - 1;
            words[at] = format!("{:?}", number(at)? + 0.5);
        }
        // A cell solves its program twice.
        12 => {
            words[1] = (number(1)? + 1.0).to_string();
            words.extend([words[2].clone(), words[3].clone()]);
        }
        // A cell that is cut solves a program.
        13 => words[2] = cut?.to_string(),
        // A limit of signs is on the other side of 0.
        14 => words[3 + place % 2] = format!("{:?}", -number(3 + place % 2)?),
        // A plan costs less.
        16 => words[3] = "-1.0".to_owned(),
        // The columns are others.
        17 => {
            words[1..].fill("1e3".to_owned());
        }
        // A program has more rows.
        _ => words[1] = (number(1)? + 1.0).to_string(),
    }
    **line = words.join(" ");
    Some(())
}

/// A damage that makes a certificate wrong, by its kind; `None` if there is nothing to damage.
pub(crate) fn damaged(text: &str, kind: usize, place: usize, program: &Program) -> Option<String> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let all = |begin: &str| {
        let own = lines.iter().enumerate().filter(|(_, line)| line.starts_with(begin));
        own.map(|(k, _)| k).collect::<Vec<usize>>()
    };
    let one = |begin: &str| {
        let own = all(begin);
        own.get(place % own.len().max(1)).copied()
    };
    let word = |k: usize, at: usize| lines[k].split(' ').nth(at).unwrap_or("").to_owned();
    let with = |k: usize, at: usize, new: &str| {
        let mut words: Vec<&str> = lines[k].split(' ').collect();
        words[at] = new;
        words.join(" ")
    };
    match kind {
        // A binary is half, or a column is far out.
        0 | 1 => {
            let k = one("x ")?;
            let column = match kind {
                0 => program.columns + place % program.binaries,
                _ => place % program.columns,
            };
            // Axes are the first columns of the model.
            let column = (program.axes + column).to_string();
            lines[k] = with_entry(&lines[k], &column, if kind == 0 { 0.5 } else { 7.0 });
        }
        // A line of the cells is gone.
        2 => {
            let first = one("cells")? + 1;
            lines.remove(first + place % (lines.len() - first));
        }
        // An open cell has no plan.
        3 => {
            let k = one("open")?;
            lines[k] = "none 0".to_owned();
        }
        // A half is another cell.
        4 => {
            let k = one("cut ")?;
            lines[k] = with(k, 3 + place % 2, &(place % 7).to_string());
        }
        // The loss is smaller.
        5 => {
            let k = one("plan ")?;
            let loss: f64 = word(k, 1).parse().ok().filter(|loss: &f64| *loss > 1e-5)?;
            lines[k] = with(k, 1, &(loss - 2e-6).to_string());
        }
        // A corner has the plan of another one.
        6 => {
            let k = one("plan ")?;
            let plans = all("x ");
            let other = place % plans.len();
            let own: usize = word(k, 2).parse().ok()?;
            if lines[plans[own]] == lines[plans[other]] {
                return None;
            }
            lines[k] = with(k, 2, &other.to_string());
        }
        // A refutation is turned around.
        7 => {
            let k = one("f ").filter(|_| lines.iter().any(|line| line.starts_with("none")))?;
            if !lines[k].contains('.') {
                return None;
            }
            lines[k] = turned(&lines[k]);
        }
        // A state is rounded by less.
        8 => {
            let k = one("rounding")?;
            let at = 1 + place % (program.axes + 1);
            let own: f64 = word(k, at).parse().ok()?;
            lines[k] = with(k, at, &(own / 10.0).to_string());
        }
        // The integers are cut elsewhere.
        9 => {
            let k = one("s ")?;
            lines[k] = with(k, 2, "1.0");
        }
        // The text ends.
        10 => lines.truncate(1 + place % (lines.len() - 1)),
        11..18 => damage_program(&mut lines, kind, place, program)?,
        // The cost is another one in the corner's evidence: what is saved is worth more.
        _ => {
            let k = one("cost")?;
            lines[k] = with(k, 1, "inf");
        }
    }
    Some(lines.join("\n")).filter(|damaged| damaged.trim_end() != text.trim_end())
}

#[test]
fn damaged_certificates_are_rejected() {
    let mut runner = TestRunner::deterministic();
    let mut counts = [0; 19];
    while counts.iter().sum::<usize>() < 1000 {
        let program = programs().new_tree(&mut runner).unwrap().current();
        let table = table(&program);
        let text = certificate(&table);
        if table.report().cells < 4 || text.len() > 200_000 {
            continue;
        }
        check_table(text.as_bytes()).unwrap();
        for (kind, count) in counts.iter_mut().enumerate() {
            for place in 0..4 {
                let Some(damaged) = damaged(&text, kind, 7919 * place + 13, &program) else {
                    continue;
                };
                let answer = check_table(damaged.as_bytes());
                assert!(answer.is_err(), "kind {kind}: {}", answer.unwrap());
                *count += 1;
            }
        }
    }
    println!("{counts:?}");
    assert!(counts.iter().all(|count| *count > 10), "{counts:?}");
}

#[test]
fn the_checker_wants_convex_costs() {
    let head = "carom-table 1\nsense min\ncolumns 3\nc 0.0 1.0 0 t\nc 0.0 1.0 0 x\nc 0.0 1.0 0 y\n\
                axes 1 0\nrows 0\ncost 0.0 0\np 1 1 1.0\n";
    let rest = "p 2 2 1.0\nlack 0\nloss 0.1 0.0\n";
    let answer = |p: &str| {
        let text = format!("{head}p 1 2 {p}\n{rest}");
        check_table(text.as_bytes()).unwrap_err().reason
    };
    // The text goes on where the cost is convex.
    assert!(answer("1.0").contains("tolerance"), "{}", answer("1.0"));
    assert!(answer("-1.0").contains("tolerance"));
    assert!(answer("1.0000000000000002").contains("not convex"));
    assert!(answer("-3.0").contains("not convex"));
}
