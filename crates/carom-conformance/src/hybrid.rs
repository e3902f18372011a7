//! Indicators, logic, disjunctions and functions: what is meant, not how it is lowered.

use carom_model::error::Error;
use carom_model::model::{Affine, Logic, Method, Model, at_most, either, exactly, sos1, sos2};

use super::answer::{Case, Cases, minimizing, sum};

pub(super) fn cases() -> Result<Vec<Case>, Error> {
    let mut cases = Cases::default();
    indicators(&mut cases)?;
    logic(&mut cases)?;
    disjunctions(&mut cases)?;
    ordered_sets(&mut cases)?;
    semicontinuous(&mut cases)?;
    functions(&mut cases)?;
    Ok(cases.0)
}

fn indicators(cases: &mut Cases) -> Result<(), Error> {
    // On forces both others up, off forces both down.
    for (cost, optimum, values) in
        [([3.0, -1.0, -1.0], 1.0, [1.0, 1.0, 1.0]), ([-3.0, 1.0, 1.0], 0.0, [0.0, 0.0, 0.0])]
    {
        let mut m = Model::new("indicators over binaries");
        let x = m.binary_family("x", 3)?;
        m.add("up", x[0].on().implies((x[1] + x[2]).ge(2.0)))?;
        m.add("down", x[0].off().implies((x[1] + x[2]).le(0.0)))?;
        m.maximize(sum(&cost, &x))?;
        cases.optimal(&m, optimum, &x.iter().zip(values).collect::<Vec<_>>());
    }

    // Off is left of 2, on is right of 7: the nearer end of a target in between.
    for (target, optimum, far, value) in [(5.0, 2.0, 1.0, 7.0), (4.0, 2.0, 0.0, 2.0)] {
        let mut m = Model::new("indicators, linear");
        let (x, away) = (m.continuous("x", 0.0, 10.0)?, m.continuous("away", 0.0, 20.0)?);
        let z = m.binary("far")?;
        m.add("right", z.on().implies(x.ge(7.0)))?;
        m.add("left", z.off().implies(x.le(2.0)))?;
        m.add("above", (away - x).ge(-target))?;
        m.add("below", (away + x).ge(target))?;
        cases.optimal(&minimizing(m, away)?, optimum, &[(x, value), (z, far)]);

        let mut m = Model::new("indicators, quadratic");
        let (x, z) = (m.continuous("x", 0.0, 10.0)?, m.binary("far")?);
        m.add("right", z.on().implies(x.ge(7.0)))?;
        m.add("left", z.off().implies(x.le(2.0)))?;
        m.minimize((x - target).square())?;
        cases.optimal(&m, 4.0, &[(x, value), (z, far)]);
    }

    let mut m = Model::new("an equality behind an indicator");
    let (x, y) = (m.continuous("x", -5.0, 5.0)?, m.continuous("y", -5.0, 5.0)?);
    let z = m.binary("z")?;
    m.add("same", z.on().implies((x - y).equals(1.0)))?;
    m.add("far", z.off().implies(x.ge(4.0)))?;
    m.add("least", y.ge(-2.0))?;
    // On: x = y + 1 >= -1; off: x = 4.
    cases.optimal(&minimizing(m, x)?, -1.0, &[(x, -1.0), (y, -2.0), (z, 1.0)]);

    let mut m = Model::new("indicators that exclude both");
    let (x, z) = (m.continuous("x", 0.0, 10.0)?, m.binary("z")?);
    m.add("on", z.on().implies(x.ge(8.0)))?;
    m.add("off", z.off().implies(x.ge(7.0)))?;
    m.add("cap", x.le(6.0))?;
    cases.infeasible(&minimizing(m, x)?);
    Ok(())
}

fn logic(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("logic");
    let x = m.binary_family("x", 4)?;
    m.add("either", x[0].xor(x[1]))?;
    m.add("follows", (x[0] | x[2]).implies(x[3]))?;
    m.add("few", at_most(2, &x))?;
    m.maximize(sum(&[3.0, 1.0, 2.0, -1.0], &x))?;
    // x[0] and x[3]: 2; x[1] alone: 1; x[1] and x[2] need x[3], which makes three.
    cases.optimal(&m, 2.0, &x.iter().zip([1.0, 0.0, 0.0, 1.0]).collect::<Vec<_>>());

    let mut m = Model::new("contradicting logic");
    let x = m.binary_family("x", 3)?;
    m.add("one", exactly(1, &x))?;
    m.add("pair", x[0].iff(x[1]))?;
    m.add("none", Logic::any([x[0], x[1]]))?;
    cases.infeasible(&m);

    let mut m = Model::new("a condition that is logic");
    let z = m.binary_family("z", 2)?;
    let x = m.continuous("x", 0.0, 10.0)?;
    m.add("slow", (z[0] & !z[1]).implies(x.le(1.0)))?;
    m.add("fast", (!z[0] & !z[1]).implies(x.le(4.0)))?;
    m.maximize(x - 5.0 * z[1] + 2.0 * z[0])?;
    // Without z[1]: 4, or 3 with z[0]. With it: 10 - 5 and 2 for z[0].
    cases.optimal(&m, 7.0, &[(x, 10.0), (z[0], 1.0), (z[1], 1.0)]);
    Ok(())
}

fn disjunctions(cases: &mut Cases) -> Result<(), Error> {
    for method in [Method::BigM, Method::MultiM, Method::Hull] {
        let mut m = Model::new("a disjunction");
        let (x, y) = (m.continuous("x", 0.0, 10.0)?, m.continuous("y", 0.0, 10.0)?);
        let left = [x.le(2.0), y.ge(6.0)];
        let right = [x.within(7.0, 8.0), y.le(1.0)];
        m.add("site", either(left).or(right).or([(x + y).ge(18.0)]).by(method))?;
        m.add("near", (x + y).le(12.0))?;
        m.maximize(3.0 * x + y)?;
        // Left: 6 + 10, right: 24 + 1; the third is too far.
        cases.optimal(&m, 25.0, &[(x, 8.0), (y, 1.0)]);
    }

    let mut m = Model::new("a disjunction without a way out");
    let x = m.continuous("x", 0.0, 10.0)?;
    m.add("ends", either([x.le(1.0)]).or([x.ge(9.0)]))?;
    m.add("middle", x.within(2.0, 8.0))?;
    cases.infeasible(&m);
    Ok(())
}

fn ordered_sets(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("an ordered set of the first kind");
    let x = m.continuous_family("x", 3, -2.0, 1.5)?;
    m.add("one", sos1(x.iter().zip([1.0, 2.0, 3.0])))?;
    m.maximize(sum(&[1.0, 3.0, -3.0], &x))?;
    cases.optimal(&m, 6.0, &[(x[0], 0.0), (x[1], 0.0), (x[2], -2.0)]);

    let mut m = Model::new("an ordered set of the second kind");
    let x = m.continuous_family("x", 4, -1.0, 1.0)?;
    // In the order of the weights: x[2], x[0], x[3], x[1].
    m.add("two", sos2(x.iter().zip([2.0, 4.0, 1.0, 3.0])))?;
    m.maximize(sum(&[2.0, -3.0, 4.0, 2.5], &x))?;
    // 6, 4.5 or 5.5 for the three pairs.
    cases.optimal(&m, 6.0, &[(x[0], 1.0), (x[1], 0.0), (x[2], 1.0), (x[3], 0.0)]);
    Ok(())
}

fn semicontinuous(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("semi-continuous variables");
    let cheap = m.semicontinuous("cheap", 1.5, 4.0)?;
    let dear = m.semicontinuous("dear", 0.5, 2.0)?;
    m.add("need", (cheap + dear).within(1.0, 3.0))?;
    m.minimize(2.0 * cheap + 2.5 * dear)?;
    // 2.5 with one of them; the cheap one alone costs at least 3.
    cases.optimal(&m, 2.5, &[(cheap, 0.0), (dear, 1.0)]);

    let mut m = Model::new("a semi-integer variable");
    let (n, x) = (m.semiinteger("n", 2.5, 6.0)?, m.continuous("x", 0.0, 10.0)?);
    m.add("near", (n - x).within(-0.5, 0.5))?;
    m.maximize(n - 1.25 * x)?;
    // n - 1.25 (n - 0.5) = 0.625 - 0.25 n for n from 3 on, 0 for n = 0.
    cases.optimal(&m, 0.0, &[(n, 0.0), (x, 0.0)]);

    let mut m = Model::new("a gap of a semi-continuous variable");
    let x = m.semicontinuous("x", -3.0, -1.0)?;
    m.add("gap", x.within(-0.875, -0.125))?;
    cases.infeasible(&m);
    Ok(())
}

fn functions(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("an absolute value to maximise");
    let x = m.continuous("x", -3.0, 2.0)?;
    let size = m.absolute("size", x)?;
    m.maximize(size)?;
    cases.optimal(&m, 3.0, &[(x, -3.0), (size, 3.0)]);

    let mut m = Model::new("a product and a maximum");
    let (x, z) = (m.continuous("x", 0.0, 5.0)?, m.binary("z")?);
    let used = m.product("used", z, x)?;
    let top = m.maximum("top", [Affine::from(x), Affine::constant(2.0)])?;
    m.add("need", (used + top).ge(7.0))?;
    // Without z: top = 7 is beyond 5. With it: 2 x >= 7 and the larger of x and 2.
    m.minimize(top + 3.0 * z)?;
    cases.optimal(&m, 6.5, &[(x, 3.5), (z, 1.0), (used, 3.5), (top, 3.5)]);
    Ok(())
}
