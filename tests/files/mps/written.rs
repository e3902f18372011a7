//! The text that is written.

use carom::model::mps;
use carom::prelude::*;

use super::read;
use crate::there_and_back::assert_same;

#[test]
fn the_text_that_is_written() {
    let mut model = Model::new("all kinds");
    let x = model.continuous_family("x", 2, -1.5, 0.1).unwrap();
    let free = model.continuous("free", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    let below = model.continuous("below", f64::NEG_INFINITY, 2.0).unwrap();
    let z = model.binary("z").unwrap();
    let n = model.integer("n", 0.0, f64::INFINITY).unwrap();
    let m = model.integer("m", 3.0, 3.0).unwrap();
    model.integer("i", 0.0, 1.0).unwrap();
    model.add("obj", (x[0] + 0.1 * x[1]).within(-1.2, 1.1)).unwrap();
    model.add("least", (free - below + 1.0).ge(0.0)).unwrap();
    model.add("same", (n + m).equals(4.0)).unwrap();
    model.add("switched", z.off().implies(free.within(0.0, 1e-7))).unwrap();
    model.maximize(2.5 * x[0] - x[0].square() - (x[1] - free).square() + 7.0).unwrap();
    let expected = "\
NAME          all kinds
OBJSENSE
    MAX
ROWS
 N  obj_
 L  obj
 G  least
 E  same
 L  switched
COLUMNS
    x[0]      obj_               2.5
    x[0]      obj                  1
    x[1]      obj                0.1
    free      least                1
    free      switched             1
    below     least               -1
    MARKER0   'MARKER'                 'INTORG'
    z         obj_                 0
    n         same                 1
    m         same                 1
    i         obj_                 0
    MARKER1   'MARKER'                 'INTEND'
RHS
    RHS       obj_                -7
    RHS       obj                1.1
    RHS       least               -1
    RHS       same                 4
    RHS       switched          1e-7
RANGES
    RANGE     obj                2.3
    RANGE     switched          1e-7
BOUNDS
 LO BOUND     x[0]              -1.5
 UP BOUND     x[0]               0.1
 LO BOUND     x[1]              -1.5
 UP BOUND     x[1]               0.1
 FR BOUND     free
 MI BOUND     below
 UP BOUND     below                2
 BV BOUND     z
 PL BOUND     n
 FX BOUND     m                    3
 LI BOUND     i                    0
 UI BOUND     i                    1
QUADOBJ
    x[0]      x[0]                -2
    x[1]      x[1]                -2
    x[1]      free                 2
    free      free                -2
INDICATORS
 IF switched  z                    0
ENDATA
";
    let text = mps::write(&model).unwrap();
    assert_eq!(text, expected);
    assert_same(&model, &read(&text));
}

#[test]
fn names_that_cannot_be_written() {
    let text = mps::write(&Model::new("two\nlines"));
    assert_eq!(
        text.unwrap_err().to_string(),
        "`two\nlines` cannot be a name: it must be one or several words with single blanks between them"
    );
}

#[test]
fn limits_that_no_binary_range_reaches() {
    let pairs = [
        (-1.2, 1.1),
        (-1.0 - 2.0 * f64::EPSILON, 1.0 + f64::EPSILON),
        (-9e19, 9e19),
        (-9.999999999999999e19, 1e-300),
        (5e-324, 9.999999999999999e19),
        (-5e-324, 5e-324),
        (-0.0, 0.0),
        (0.0, -0.0),
        (-0.0, 3.0),
        (-3.0, -0.0),
        (0.1, 0.30000000000000004),
        (1e-9, 1e16),
        (-1e16, 1e-9),
    ];
    let mut model = Model::new("pairs");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    for (k, (lower, upper)) in pairs.into_iter().enumerate() {
        model.add(("r", k), x.within(lower, upper)).unwrap();
    }
    let text = mps::write(&model).unwrap();
    assert_same(&model, &read(&text));
    assert!(text.lines().all(|line| line.len() < 80), "{text}");
}
