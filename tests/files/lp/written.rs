//! The text that is written.

use carom::model::{PiecewiseAffine, at_most, lp, mps};
use carom::prelude::*;

use super::read;
use crate::there_and_back::assert_same;

#[test]
fn the_text_that_is_written() {
    let mut model = Model::new("all kinds");
    let x = model.continuous_family("x", 2, -1.5, 0.1).unwrap();
    let free = model.continuous("free", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    let below = model.continuous("below", f64::NEG_INFINITY, -2.0).unwrap();
    let z = model.binary("z").unwrap();
    let fixed = model.variable("fixed", VariableKind::Binary, 1.0, 1.0).unwrap();
    let n = model.integer("n", 0.0, f64::INFINITY).unwrap();
    let m = model.integer("m-1", 0.0, 1.0).unwrap();
    model.add("obj", (x[0] + 0.1 * x[1]).within(-1.2, 1.1)).unwrap();
    model.add("least", (free - below + 1.0).ge(0.0)).unwrap();
    model.add("same", (n + m).equals(4.0)).unwrap();
    model.add("below", z.off().implies(free.within(0.0, 1e-7))).unwrap();
    model.add("on", fixed.on().implies((0.5 * x[0] - 1e16 * x[1]).le(0.0))).unwrap();
    model.maximize(2.5 * x[0] - x[0].square() - (x[1] - free).square() + 7.0).unwrap();
    let expected = "\
\\ Problem name: all kinds
Maximize
 obj_: 2.5 x{0} + 0 x{1} + 0 %66ree + 0 below + 0 z + 0 fixed + 0 n + 0 m%2D1 + 7 Constant
  + [ - 2 x{0} ^2 - 2 x{1} ^2 + 4 x{1} * %66ree - 2 %66ree ^2 ] / 2
Subject To
 obj%ge: x{0} + 0.1 x{1} >= -1.2
 obj%le: x{0} + 0.1 x{1} <= 1.1
 least: %66ree - below >= -1
 same: n + m%2D1 = 4
 below%ge: z = 0 -> %66ree >= 0
 below%le: z = 0 -> %66ree <= 1e-7
 on: fixed = 1 -> 0.5 x{0} - 1e16 x{1} <= 0
Bounds
 -1.5 <= x{0} <= 0.1
 -1.5 <= x{1} <= 0.1
 %66ree free
 -inf <= below <= -2
 fixed = 1
 0 <= m%2D1 <= 1
 Constant = 1
General
 n m%2D1
Binary
 z fixed
End
";
    let text = lp::write(&model).unwrap();
    // The parts of the objective may be broken elsewhere.
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(words(&text), words(expected), "{text}");
    assert!(text.lines().all(|line| line.len() <= 100), "{text}");
    assert_same(&model, &read(&text));
}

/// A plain number in the objective is a column for Gurobi; `Constant = 1` is what it writes itself.
#[test]
fn the_constant_of_the_objective() {
    let mut model = Model::new("");
    model.minimize(Affine::constant(-0.5)).unwrap();
    let text = "Minimize\n obj: - 0.5 Constant\nSubject To\nBounds\n Constant = 1\nEnd\n";
    assert_eq!(lp::write(&model).unwrap(), text);
    assert_same(&model, &read(text));

    let own = model.continuous("Constant", 1.0, 1.0).unwrap();
    model.minimize(2.0 * own + 1.0).unwrap();
    let text = lp::write(&model).unwrap();
    assert!(text.contains(" obj: 2 %43onstant + Constant\n"), "{text}");
    assert_same(&model, &read(&text));
}

/// Three other readers take `SI` for what it is, and one refuses it; `SC` between markers is
/// semi-continuous for one of them.
#[test]
fn semi_integers() {
    let mut model = Model::new("");
    let x = model.semiinteger("x", 2.0, 5.0).unwrap();
    let y = model.semicontinuous("y", 2.0, f64::INFINITY).unwrap();
    model.maximize(x - y).unwrap();
    let text = mps::write(&model).unwrap();
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("LO BOUND x 2 SI BOUND x 5 LO BOUND y 2 SC BOUND y 1e30"), "{text}");
    assert_same(&model, &mps::read(&text).unwrap().model);
    // Gurobi takes the last of the two sections.
    let text = lp::write(&model).unwrap();
    assert!(text.ends_with("General\n x\nSemi-Continuous\n x y\nEnd\n"), "{text}");
    assert_same(&model, &read(&text));
}

#[test]
fn what_cannot_be_written() {
    let error = |model: &Model| lp::write(model).unwrap_err().to_string();
    assert_eq!(
        error(&Model::new("two\nlines")),
        "`two\nlines` cannot be a name: it must be one or several words with single blanks between them"
    );
    let mut model = Model::new("logic");
    let z = model.binary_family("z", 3).unwrap();
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    let mut compound = model.clone();
    compound.add("both", (z[0] & z[1]).implies(x.le(0.5))).unwrap();
    assert_eq!(
        error(&compound),
        "LP cannot express the compound condition of `both`; write the lowered model instead \
         (`reformulate::lower(&model)?.model()`)"
    );
    let mut function = model.clone();
    function.absolute("size", x - 0.5).unwrap();
    assert!(
        error(&function).starts_with("LP cannot express the function `size`; write the lowered")
    );
    model.add("few", at_most(1, &z)).unwrap();
    assert!(error(&model).starts_with("LP cannot express the logic of `few`; write the lowered"));
    for model in [model, compound, function] {
        let lowered = carom::reformulate::lower(&model).unwrap();
        assert_same(lowered.model(), &read(&lp::write(lowered.model()).unwrap()));
    }
}

/// What no file can say, files can say once it is lowered: the same rows, to the last bit.
#[test]
fn every_construct_survives_once_lowered() {
    let mut model = Model::new("constructs");
    let v = model.binary_family("v", 4).unwrap();
    let n = model.integer("n", 0.0, 3.0).unwrap();
    let x = model.continuous("x", -2.1, 2.3).unwrap();
    let a = model.absolute("a", x - 1.1).unwrap();
    let top = model.maximum("top", [a + x, Affine::constant(0.5)]).unwrap();
    let law = PiecewiseAffine::new([(-2.1, 1.0), (0.1, 0.0), (2.3, 3.7)]).unwrap();
    let f = model.piecewise("f", x, &law).unwrap();
    let p = model.product("p", n, x).unwrap();
    let q = model.product("q", v[0], x).unwrap();
    let low = model.minimum("low", [f, p]).unwrap();
    model.add("logic", !(v[0] & !v[1]) | at_most(1, &v).iff(v[2].xor(v[3]))).unwrap();
    model.add("early", (v[0] | v[2]).implies(top.le(1.5))).unwrap();
    model.add("rows", v[1].on().implies_all([x.le(0.7), (x + n).ge(0.3)])).unwrap();
    model.add(("near", 2), v[3].on().reify(x.within(0.1, 1.3), 0.25)).unwrap();
    model.minimize(top - low + q + x.square()).unwrap();
    let lowered = carom::reformulate::lower(&model).unwrap();
    let lowered = lowered.model();
    assert_same(lowered, &read(&lp::write(lowered).unwrap()));
    assert_same(lowered, &mps::read(&mps::write(lowered).unwrap()).unwrap().model);
}

/// Rows that look like the two halves of one stay what they are.
#[test]
fn rows_named_like_halves() {
    let mut model = Model::new("");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    model.add("r%ge", x.ge(0.25)).unwrap();
    model.add("r%le", x.le(0.75)).unwrap();
    model.add("%ge", x.ge(0.5)).unwrap();
    let text = lp::write(&model).unwrap();
    assert!(text.contains(" r%25ge: x >= 0.25\n r%25le: x <= 0.75\n"), "{text}");
    assert_same(&model, &read(&text));
}

#[test]
fn long_rows_are_broken_before_signs() {
    let mut model = Model::new("");
    let x = model.continuous_family("long_name", 20, 0.0, 1.0).unwrap();
    let sum: Affine = x.iter().map(|v| 0.5 * v).sum();
    model.add("sum", sum.le(1.0)).unwrap();
    let text = lp::write(&model).unwrap();
    assert!(text.lines().all(|line| line.chars().count() <= 110), "{text}");
    assert!(text.contains("\n  + 0.5 long_name{"), "{text}");
}
