//! Expressions: their values, and what is refused, with its name and place.

use carom::ErrorKind;
use carom::model::nl;
use carom::prelude::Model;

use super::{Sizes, error, read};

/// A file whose objective is an expression of three variables and a definition `v3 = x + 2 y - 1`.
fn file(expression: &str) -> String {
    let sizes = Sizes { nonlinear: [0, 3, 0], definitions: 1, functions: 1, ..Sizes::new(3, 0, 1) };
    sizes.file(&format!(
        "F0 1 -1 hypot; V3 2 0; 0 1; 1 2; n-1; O0 0; {expression}; b; 0 -9 9; 0 -9 9; 0 -9 9"
    ))
}

/// An expression, and the same in Rust.
type Meant = (&'static str, fn(f64, f64, f64) -> f64);

#[test]
fn values_are_those_of_the_expression() {
    let meant: [Meant; 16] = [
        ("n2.5", |_, _, _| 2.5),
        ("s-3", |_, _, _| -3.0),
        ("l70000", |_, _, _| 70000.0),
        ("o0; v0; v2", |x, _, z| x + z),
        ("o1; v0; o1; v1; v2", |x, y, z| x - (y - z)),
        ("o2; n3; v1", |_, y, _| 3.0 * y),
        ("o2; o0; v1; n1; o0; n-2; n6", |_, y, _| 4.0 * (y + 1.0)),
        ("o3; o0; v0; n6; n4", |x, _, _| (x + 6.0) / 4.0),
        ("o16; v2", |_, _, z| -z),
        ("o54; 3; v0; v0; n1", |x, _, _| 2.0 * x + 1.0),
        ("v3", |x, y, _| x + 2.0 * y - 1.0),
        ("o5; v3; n2", |x, y, _| (x + 2.0 * y - 1.0).powi(2)),
        ("o0; o2; v0; v0; o77; o1; v1; v2", |x, y, z| x * x + (y - z).powi(2)),
        ("o1; o5; o0; v0; v1; n2; o2; n2; o2; v0; v1", |x, y, _| x * x + y * y),
        ("o0; o5; v2; n0; o5; o5; v1; n1; o5; n4; n0.5", |_, y, _| 1.0 + y * y),
        // What cancels has no degree.
        ("o2; o0; v2; o1; o5; v0; n2; o2; v0; v0; v2", |_, _, z| z * z),
    ];
    for (expression, value) in meant {
        let model = read(&file(expression));
        for [x, y, z] in [[0.0, 0.0, 0.0], [1.5, -2.0, 4.0], [-0.5, 3.0, 1.0]] {
            let found = model.objective().evaluate(|own| [x, y, z][own.index()]);
            assert!(
                (found - value(x, y, z)).abs() < 1e-12,
                "{expression} at {x}, {y}, {z}: {found}"
            );
        }
    }
}

/// The line of the objective's expression.
const LINE: usize = 17;

#[test]
fn operators_are_refused_by_name_and_place() {
    for (code, name) in [
        (4, "mod"),
        (13, "floor"),
        (22, "<"),
        (34, "not"),
        (35, "if"),
        (64, "a piecewise-linear term"),
        (47, "atanh"),
        (72, "==>"),
    ] {
        let text = file(&format!("o0; v0; o2; n2; o{code}; v1"));
        let error = nl::read(&text).unwrap_err();
        let ErrorKind::Operator { line, column, operator, help } = error.kind() else {
            panic!("{error}");
        };
        assert_eq!((*line, *column, operator.as_str()), (LINE + 4, 1, name));
        assert!(help.len() > 20 && error.code() == "unsupported", "{error}");
    }
    let at = |expression: &str| error(&file(expression));
    assert_eq!(
        at("o47; v0"),
        "line 17, column 1: `atanh` is not taken; replace it by functions that are taken, or by a piecewise \
         linear one"
    );
    for (expression, start) in [
        ("o5; n-2; v0", "line 17, column 1: `^` is not taken; a power with a base"),
        ("f0 2; v0; v1", "line 17, column 1: `hypot` is not taken; functions from outside"),
        ("h3:abc", "line 17, column 1: `a text` is not taken"),
    ] {
        let error = at(expression);
        assert!(error.starts_with(start), "{expression}: {error}");
    }
    assert_eq!(at("o90; v0"), "line 17, column 1: there is no operator `o90`");
    assert_eq!(at("o3; v0; o1; n2; n2"), "line 17, column 1: the expression divides by 0");
}

#[test]
fn constraints_of_other_kinds_are_refused_by_name() {
    let sizes = Sizes::new(1, 1, 0);
    let text = sizes.file("L0; o22; v0; n1; b; 0 0 1");
    let start = "line 11, column 1: `a logical constraint` is not taken; ";
    assert!(error(&text).starts_with(start), "{}", error(&text));
    let text = sizes.file("C0; n0; r; 5 1 1; b; 0 0 1");
    let start = "line 14, column 1: `complements` is not taken; ";
    assert!(error(&text).starts_with(start), "{}", error(&text));
    let text = sizes.file("").replace(" 1 1 0 0 0\t# sizes", " 1 1 0 0 0 2");
    let start = "line 2, column 2: the program has 2 logical constraints, which are not read";
    assert!(error(&text).starts_with(start), "{}", error(&text));
}

/// An objective over three variables, its value, and one constant that is added.
#[test]
fn functions_have_their_values() {
    type Value = fn(f64, f64, f64) -> f64;
    let meant: [(&str, Value); 19] = [
        ("o2; v0; o2; v1; v2", |x, y, z| x * y * z),
        ("o5; v0; n3", |x, _, _| x.powi(3)),
        ("o5; o5; v0; n2; n2", |x, _, _| x.powi(4)),
        ("o3; v1; o0; n4; v0", |x, y, _| y / (4.0 + x)),
        ("o3; n1; o0; n4; v0", |x, _, _| 1.0 / (4.0 + x)),
        ("o5; n2; v0", |x, _, _| x.exp2()),
        ("o5; o0; n3; v0; v1", |x, y, _| (3.0 + x).powf(y)),
        ("o41; v0", |x, _, _| x.sin()),
        ("o46; v0", |x, _, _| x.cos()),
        ("o38; o2; n0.5; v0", |x, _, _| (0.5 * x).tan()),
        ("o49; v1", |_, y, _| y.atan()),
        ("o37; v1", |_, y, _| y.tanh()),
        ("o44; v0", |x, _, _| x.exp()),
        ("o43; o0; n3; v0", |x, _, _| (3.0 + x).ln()),
        ("o42; o0; n3; v0", |x, _, _| (3.0 + x).log10()),
        ("o39; o0; n3; v0", |x, _, _| (3.0 + x).sqrt()),
        ("o15; v1", |_, y, _| y.abs()),
        ("o12; 3; v0; v1; v2", |x, y, z| x.max(y).max(z)),
        ("o48; v1; o0; n4; v0", |x, y, _| y.atan2(4.0 + x)),
    ];
    for (expression, value) in meant {
        let model = read(&file(expression));
        let written = read(&nl::write(&model).unwrap());
        for at in [[0.0; 3], [1.5; 3], [-0.5; 3], [1.5, -2.0, 4.0], [-0.5, 3.0, 1.0]] {
            // In a file that was written, variables have another order.
            let is_symmetric = at[0] == at[1] && at[1] == at[2];
            for model in [Some(&model), is_symmetric.then_some(&written)].into_iter().flatten() {
                let found = objective_at(model, &at);
                let meant = value(at[0], at[1], at[2]);
                assert!((found - meant).abs() < 1e-12, "{expression}: {found} for {meant}");
            }
        }
    }
}

/// The value of the objective where functions follow from the first variables, in the order of the
/// file, and where variables that a row ties to a function follow from it.
fn objective_at(model: &Model, at: &[f64]) -> f64 {
    let mut values: Vec<Option<f64>> = vec![None; model.variable_count()];
    let plain: Vec<usize> = (0..values.len()).collect();
    let results: Vec<usize> = model.functions().map(|f| f.result().index()).collect();
    // Variables that rows define, as those of a file that was written.
    let tied = |k: usize| {
        model.constraints().any(|row| {
            let terms = row.terms();
            row.limits().width() == 0.0
                && terms.iter().any(|(v, a)| v.index() == k && *a == -1.0)
                && terms.iter().any(|(v, _)| results.contains(&v.index()))
        })
    };
    let free = plain.into_iter().filter(|&k| !results.contains(&k) && !tied(k));
    free.zip(at).for_each(|(k, value)| values[k] = Some(*value));
    for _ in 0..values.len() {
        for function in model.functions() {
            let terms = function.function().expressions().iter().flat_map(|e| e.terms());
            if terms.into_iter().all(|(v, _)| values[v.index()].is_some()) {
                let value = function.function().evaluate(|v| values[v.index()].unwrap());
                values[function.result().index()] = Some(value);
            }
        }
        for row in model.constraints().filter(|row| row.limits().width() == 0.0) {
            let open: Vec<_> =
                row.terms().iter().filter(|(v, _)| values[v.index()].is_none()).collect();
            if let [(variable, factor)] = open[..] {
                let known = row.terms().iter().filter(|(v, _)| v != variable);
                let sum: f64 = known.map(|(v, a)| a * values[v.index()].unwrap()).sum();
                values[variable.index()] = Some((row.limits().lower - sum) / factor);
            }
        }
    }
    model.objective().evaluate(|v| values[v.index()].unwrap())
}

#[test]
fn what_is_not_convex_is_a_function() {
    let product = read(&file("o2; v0; v1"));
    assert_eq!(product.function_count(), 1);
    let sizes = Sizes { nonlinear: [2, 0, 0], ..Sizes::new(2, 1, 0) };
    let row =
        |row: &str, limits: &str| read(&sizes.file(&format!("C0; {row}; r; {limits}; b; 3; 3")));
    let ring = row("o0; o5; v0; n2; o5; v1; n2", "2 4");
    assert_eq!((ring.function_count(), ring.conic_constraint_count()), (2, 0));
    assert_eq!(row("o5; v0; n2", "4 4").function_count(), 1);
    let disc = row("o0; o5; v0; n2; o5; v1; n2", "1 4");
    assert_eq!((disc.function_count(), disc.conic_constraint_count()), (0, 1));
}

/// As many operators as a file likes, without a call for each.
#[test]
fn deep_expressions_are_read() {
    let depth = 200_000;
    let text = file(&format!("{}v0", "o16; ".repeat(depth)));
    assert_eq!(read(&text).objective().evaluate(|_| 3.0), 3.0);
    let waves = error(&file(&format!("{}v0", "o41; ".repeat(depth))));
    assert!(waves.contains("the number of functions inside each other in `objective`"), "{waves}");
    assert_eq!(read(&file(&format!("{}v0", "o41; ".repeat(150)))).function_count(), 150);
    let left = file(&format!("{}v0{}", "o0; ".repeat(depth), "; n1".repeat(depth)));
    assert_eq!(read(&left).objective().affine().offset(), depth as f64);
}
