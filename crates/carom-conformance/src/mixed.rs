//! Convex quadratic objectives, with and without integers.

use carom_model::error::Error;
use carom_model::model::Model;

use super::answer::{Case, Cases, INF, minimizing};

pub(super) fn cases() -> Result<Vec<Case>, Error> {
    let mut cases = Cases::default();
    continuous(&mut cases)?;
    integer(&mut cases)?;
    Ok(cases.0)
}

fn continuous(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("unconstrained quadratic");
    let (x, y) = (m.continuous("x", -INF, INF)?, m.continuous("y", -INF, INF)?);
    m.minimize((x - 1.0).square() + (x + 2.0 * y).square() + 3.0)?;
    cases.optimal(&m, 3.0, &[(x, 1.0), (y, -0.5)]);

    let mut m = Model::new("a line of optima");
    let (x, y) = (m.continuous("x", -INF, INF)?, m.continuous("y", -INF, INF)?);
    m.minimize((x + y - 1.0).square())?;
    cases.optimal(&m, 0.0, &[]);

    let mut m = Model::new("quadratic over an equality");
    let x = m.continuous_family("x", 3, -INF, INF)?;
    m.add("sum", (x[0] + x[1] + x[2]).equals(6.0))?;
    m.minimize(x[0].square() + 2.0 * x[1].square() + 2.0 * x[2].square())?;
    cases.optimal(&m, 18.0, &[(x[0], 3.0), (x[1], 1.5), (x[2], 1.5)]);

    let mut m = Model::new("infeasible rows of free variables, quadratic");
    let (x, y) = (m.continuous("x", -INF, INF)?, m.continuous("y", -INF, INF)?);
    m.add("above", (x - y).ge(1.0))?;
    m.add("below", (y - x).ge(0.0))?;
    cases.infeasible(&minimizing(m, x.square())?);

    let mut m = Model::new("unbounded quadratic");
    let (x, y) = (m.continuous("x", -INF, INF)?, m.continuous("y", -INF, INF)?);
    cases.unbounded(&minimizing(m, (x - y).square() - x)?);
    Ok(())
}

fn integer(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("mixed-integer quadratic");
    let (x, y) = (m.integer("x", 0.0, 5.0)?, m.integer("y", 0.0, 5.0)?);
    let z = m.continuous("z", 0.0, 0.5)?;
    m.minimize((x + y - 3.4).square() + (x - 0.7).square() + (z - 1.0).square())?;
    cases.optimal(&m, 0.5, &[(x, 1.0), (y, 2.0), (z, 0.5)]);

    let mut m = Model::new("concave quadratic to maximise");
    let (x, k) = (m.continuous("x", -1.0, 1.5)?, m.integer("k", 0.0, 5.0)?);
    m.maximize(4.0 * k - k.square() - (x - 2.0).square())?;
    cases.optimal(&m, 3.75, &[(x, 1.5), (k, 2.0)]);

    let mut m = Model::new("all fixed, quadratic");
    let (x, k) = (m.continuous("x", 0.25, 0.25)?, m.integer("k", -2.0, -2.0)?);
    m.add("row", (x + k).within(-2.0, -1.0))?;
    m.minimize((x - k).square())?;
    cases.optimal(&m, 5.0625, &[(x, 0.25), (k, -2.0)]);
    m.fix(k, -1.5)?;
    cases.infeasible(&m);

    let mut m = Model::new("variables without rows, quadratic");
    let (x, z) = (m.continuous("x", -INF, INF)?, m.continuous("z", -INF, INF)?);
    let k = m.integer("k", 0.0, 4.0)?;
    m.add("row", x.ge(1.0))?;
    m.minimize(x + (z + 1.0).square() - 2.0 * k)?;
    cases.optimal(&m, -7.0, &[(x, 1.0), (z, -1.0), (k, 4.0)]);

    // Binaries choose which of two targets is held; units are far from 1.
    let mut m = Model::new("badly scaled quadratic");
    let (x, z) = (m.continuous("x", 0.0, 1000.0)?, m.binary("z")?);
    m.add("low", (1e-3 * x - 0.75 * z).le(0.25))?;
    m.minimize(1e-4 * (x - 800.0).square() + 20.0 * z)?;
    // 1e-4 * 550^2 = 30.25 without z, 20 with it.
    cases.optimal(&m, 20.0, &[(x, 800.0), (z, 1.0)]);
    Ok(())
}
