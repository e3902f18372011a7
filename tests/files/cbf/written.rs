//! The text that is written.

use carom::model::{cbf, norm};
use carom::prelude::*;

use super::read;

#[test]
fn the_text_that_is_written() {
    let mut model = Model::new("all kinds");
    let x = model.continuous_family("x", 3, 0.0, f64::INFINITY).unwrap();
    let v = model.continuous_family("v", 2, -1.5, 2.0).unwrap();
    let z = model.binary("z").unwrap();
    let n = model.integer("n", f64::NEG_INFINITY, 0.0).unwrap();
    model.add("sum", (x[0] + 2.0 * x[1]).within(-1.0, 4.0)).unwrap();
    model.add("same", (n + z).equals(0.0)).unwrap();
    model.add("speed", norm([v[0] + 0.5, 2.0 * v[1]]).le(3.0 * z + 1.0)).unwrap();
    model.add("rotated", v[0].square().le(x[0] * x[2])).unwrap();
    model.maximize(x[1] - 0.5 * n + 7.0).unwrap();
    let expected = "\
# all kinds
VER
1

OBJSENSE
MAX

VAR
7 4
L+ 3
F 2
L+ 1
L- 1

INT
2
5
6

CON
14 8
L+ 1
L- 1
L+ 1
L- 2
L+ 1
L- 1
L= 1
Q 3
QR 3

OBJACOORD
2
1 1
6 -0.5

OBJBCOORD
7

ACOORD
19
";
    let text = cbf::write(&model).unwrap();
    assert!(text.starts_with(&expected[..expected.find("CON").unwrap()]), "{text}");
    let again = read(&text);
    assert_eq!(cbf::write(&again).unwrap().replace("VER", "# all kinds\nVER"), text);
    assert_eq!((again.constraint_count(), again.conic_constraint_count()), (2, 2));
}
