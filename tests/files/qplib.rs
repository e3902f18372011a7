//! QPLIB files: as programs that were made at random, with rows and products, and damaged.

use std::fmt::Write as _;

use carom::ErrorKind;
use carom::model::{Model, VariableKind, qplib};
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

const SMALL: &str = "\
! a comment
small the rest of a line is a comment
QMQ # letters
maximize
3 variables
2 constraints

2 entries of H
1 1 -2.0
3 2 -1.0
0.0
1
2 4.0
1.5 constant
1 entry of the matrices
2 3 3 1.0
3 entries of A
1 1 1.0
1 2 1.0
2 1 1.0
1.0E19 infinite
-1.0E20
0
3.0
1
2 4.0
-1.0
1
2 0.0
5.0
0
0 kinds
1
2 2
0.0
0
0.0
0
0.0
0
1
1 speed
1
2 ball
";

fn read(text: &str) -> Model {
    let read = qplib::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert!(read.warnings.is_empty());
    read.model
}

#[test]
fn every_part_of_a_file_is_where_it_belongs() -> Result<(), Error> {
    let text = SMALL.replace("3 2 -1.0\n", "3 3 -1.0\n");
    let model = read(&text);
    assert_eq!((model.name(), model.sense()), ("small", Sense::Maximize));
    let [x, y, z] = ["speed", "x[2]", "x[3]"].map(|name| match name.split_once('[') {
        Some((family, k)) => model.variable_by_name((family, k[..1].parse().unwrap())),
        None => model.variable_by_name(name),
    });
    let (x, y, z) = (x?, y?, z?);
    let bounds = |of| model.variable_ref(of).map(|own| (own.bounds().lower, own.bounds().upper));
    assert_eq!((bounds(x)?, bounds(y)?, bounds(z)?), ((-1.0, 5.0), (0.0, 1.0), (-1.0, 5.0)));
    assert_eq!(model.variable_ref(y)?.kind(), VariableKind::Binary);
    let row = model.constraints().next().expect("a linear row");
    assert_eq!((row.name().to_string(), row.limits().upper), ("c[1]".to_owned(), 3.0));
    assert_eq!(row.limits().lower, f64::NEG_INFINITY);
    let cone = model.conic_constraints().next().expect("a quadratic row");
    assert_eq!(cone.name().to_string(), "ball");
    // -x² - z²/2 + 4 y + 3/2 with x + y <= 3 and z²/2 + x <= 4.
    let solution = BranchAndBound::default().solve(&model)?;
    assert!((solution.objective().expect("a point") - 5.5).abs() < 1e-6);
    Ok(())
}

#[test]
fn binaries_have_no_bounds_in_the_file() -> Result<(), Error> {
    let text = "b\nLBN\nminimize\n2\n-1.0\n0\n0.0\n1e20\n0.0\n0\n0.0\n0\n0\n";
    let model = read(text);
    assert!(model.variables().all(|own| own.kind() == VariableKind::Binary));
    assert_eq!(BranchAndBound::default().solve(&model)?.objective(), Some(-2.0));
    Ok(())
}

/// `x y` from the lower triangle, and half of it from the upper one.
#[test]
fn an_entry_of_the_upper_triangle_is_the_sum_of_both() -> Result<(), Error> {
    let best = |entry: &str| {
        let text =
            format!("p\nQBN\nmaximize\n2\n1\n{entry} 3.0\n0.0\n0\n0.0\n1e20\n0.0\n0\n0.0\n0\n0\n");
        BranchAndBound::default().solve(&read(&text)).map(|found| found.objective())
    };
    assert_eq!((best("2 1")?, best("1 2")?), (Some(3.0), Some(1.5)));
    Ok(())
}

#[test]
fn what_is_damaged_is_named_with_its_place() {
    let place = |text: &str| match qplib::read(text).unwrap_err().kind() {
        ErrorKind::Parse { line, column, message } => (*line, *column, message.clone()),
        other => panic!("{other:?}"),
    };
    let changed = |from: &str, to: &str| {
        assert!(SMALL.contains(from), "{from}");
        place(&SMALL.replacen(from, to, 1))
    };
    let is = |found: (usize, usize, String), at: (usize, usize), part: &str| {
        assert_eq!((found.0, found.1), at, "{}", found.2);
        assert!(found.2.contains(part), "{}", found.2);
    };
    is(changed("QMQ", "QMX"), (3, 1), "three letters");
    is(changed("maximize", "maximal"), (4, 1), "`minimize` or `maximize`");
    is(changed("1 1 -2.0", "4 1 -2.0"), (9, 1), "an index from 1 to 3");
    is(changed("1 1 -2.0", "2 3 -2.0"), (10, 1), "twice");
    is(changed("1 1 -2.0", "1 1"), (9, 1), "an entry of the entries of the objective's matrix");
    is(changed("1 1 -2.0", "1 1 two"), (9, 5), "not a number");
    is(changed("2 entries", "2e entries"), (8, 1), "the number of entries");
    is(changed("3 variables", "300000000000 variables"), (5, 1), "more than a file of this length");
    is(changed("-1.0E20\n0", "0.0\n0"), (16, 1), "two it is not convex");
    is(place("name\nLCN\nminimize\n1\n0.0\n"), (6, 1), "the file ends before");
    is(place(""), (1, 1), "the file ends before the name");
}

#[test]
fn what_is_not_convex_is_refused() {
    // A product of two variables that are no binaries.
    let text = SMALL.replace("3 2 -1.0", "3 1 -1.0");
    let error = qplib::read(&text).and_then(|read| BranchAndBound::default().solve(&read.model));
    let error = error.unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotConvex { .. }), "{error}");
}

/// A program and its text: a convex objective over integers and continuous variables, with rows.
#[derive(Debug, Clone)]
struct Case {
    square: Vec<f64>,
    linear: Vec<f64>,
    kinds: Vec<bool>,
    rows: Vec<(Vec<f64>, f64)>,
    default: f64,
}

impl Case {
    fn text(&self) -> String {
        let n = self.square.len();
        let mut text = format!("random\nCGL\nminimize\n{n}\n{}\n", self.rows.len());
        let entries = |values: &[f64], skipped: f64| {
            let own = values.iter().zip(1..).filter(|(value, _)| **value != skipped);
            let own: Vec<String> = own.map(|(value, k)| format!("{k} {value:?}")).collect();
            format!(
                "{}\n{}",
                own.len(),
                own.iter().map(|line| format!("{line}\n")).collect::<String>()
            )
        };
        let _ = writeln!(text, "{n}");
        self.square.iter().zip(1..).for_each(|(h, k)| {
            let _ = writeln!(text, "{k} {k} {h:?}");
        });
        let _ = write!(text, "{:?}\n{}0.25\n", self.default, entries(&self.linear, self.default));
        let _ = writeln!(text, "{}", n * self.rows.len());
        for (row, i) in self.rows.iter().zip(1..) {
            row.0.iter().zip(1..).for_each(|(a, k)| {
                let _ = writeln!(text, "{i} {k} {a:?}");
            });
        }
        let limits: Vec<f64> = self.rows.iter().map(|row| row.1).collect();
        let _ = write!(text, "1e20\n-1e20\n0\n1e20\n{}", entries(&limits, 1e20));
        text += "-3.0\n0\n3.0\n0\n0\n";
        let kinds: Vec<f64> = self.kinds.iter().map(|whole| f64::from(u8::from(*whole))).collect();
        text += &entries(&kinds, 0.0);
        text += "0.0\n0\n0.0\n0\n0.0\n0\n0\n0\n";
        text
    }

    fn model(&self) -> Model {
        let mut model = Model::new("random");
        let kind =
            |whole: bool| if whole { VariableKind::Integer } else { VariableKind::Continuous };
        let x: Vec<Variable> = self
            .kinds
            .iter()
            .zip(1..)
            .map(|(whole, k)| model.variable(("x", k), kind(*whole), -3.0, 3.0).unwrap())
            .collect();
        for (row, i) in self.rows.iter().zip(1..) {
            let left: Affine = row.0.iter().zip(&x).map(|(a, x)| *a * x).sum();
            model.add(("c", i), left.le(row.1)).unwrap();
        }
        let linear: Affine = self.linear.iter().zip(&x).map(|(g, x)| *g * x).sum();
        let squares: Quadratic =
            self.square.iter().zip(&x).map(|(h, x)| 0.5 * *h * x.square()).sum();
        model.minimize(squares + linear + 0.25).unwrap();
        model
    }
}

fn cases() -> impl Strategy<Value = Case> {
    let number = || (-8..9_i32).prop_map(|value| f64::from(value) / 4.0);
    (1..5_usize, 0..4_usize).prop_flat_map(move |(n, m)| {
        let positive = (1..9_i32).prop_map(|value| f64::from(value) / 4.0);
        // Without variables a row is refused.
        let row = (prop::collection::vec(number(), n), number());
        let row = row.prop_map(|(mut factors, limit)| {
            factors[0] += 2.25;
            (factors, limit)
        });
        (
            prop::collection::vec(positive, n),
            prop::collection::vec(number(), n),
            prop::collection::vec(any::<bool>(), n),
            prop::collection::vec(row, m),
            number(),
        )
            .prop_map(|(square, linear, kinds, rows, default)| Case {
                square,
                linear,
                kinds,
                rows,
                default,
            })
    })
}

proptest! {
    #![proptest_config(config(64, "tests/regressions/qplib.txt"))]

    #[test]
    fn a_file_is_the_program_that_it_was_made_of(case in cases()) {
        let (read, stated) = (read(&case.text()), case.model());
        let [own, expected] = [&read, &stated].map(|m| BranchAndBound::default().solve(m).unwrap());
        prop_assert_eq!(own.termination(), expected.termination());
        prop_assert_eq!(own.objective().is_some(), expected.objective().is_some());
        if let (Some(a), Some(b)) = (own.objective(), expected.objective()) {
            prop_assert!((a - b).abs() <= 2e-6 * a.abs().max(1.0), "{} {}", a, b);
        }
        let variables = |model: &Model| {
            model.variables().map(|v| (v.name().to_string(), v.kind(), v.bounds())).collect::<Vec<_>>()
        };
        prop_assert_eq!(variables(&read), variables(&stated));
    }
}
