//! Norms, quadratic rows and rotated cones, with and without integers.

use carom_model::error::Error;
use carom_model::model::{Model, either, norm};

use super::answer::{Case, Cases, INF, minimizing};

pub(super) fn cases() -> Result<Vec<Case>, Error> {
    let mut cases = Cases::default();
    continuous(&mut cases)?;
    integer(&mut cases)?;
    conditional(&mut cases)?;
    without_a_point(&mut cases)?;
    Ok(cases.0)
}

fn continuous(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("the farthest point of a disc");
    let (x, y) = (m.continuous("x", -5.0, 5.0)?, m.continuous("y", -5.0, 5.0)?);
    m.add("disc", norm([x, y]).le(2.0))?;
    m.maximize(3.0 * x + 4.0 * y)?;
    cases.optimal(&m, 10.0, &[(x, 1.2), (y, 1.6)]);

    let mut m = Model::new("the distance of a point from a box");
    let (x, y) = (m.continuous("x", -1.0, 0.0)?, m.continuous("y", -1.0, 0.0)?);
    let far = m.continuous("far", -INF, INF)?;
    m.add("distance", norm([x - 3.0, 4.0 - y]).le(far))?;
    cases.optimal(&minimizing(m, far)?, 5.0, &[(x, 0.0), (y, 0.0), (far, 5.0)]);

    let mut m = Model::new("a quadratic row with a linear part");
    let (x, y) = (m.continuous("x", -5.0, 5.0)?, m.continuous("y", -INF, INF)?);
    m.add("bowl", (x - 1.0).square().le(y - x))?;
    // y >= x^2 - x + 1.
    cases.optimal(&minimizing(m, y)?, 0.75, &[(x, 0.5), (y, 0.75)]);

    let mut m = Model::new("a rotated cone");
    let (x, y) = (m.continuous("x", 0.0, INF)?, m.continuous("y", 0.0, INF)?);
    let z = m.continuous("z", -3.0, -2.0)?;
    m.add("cone", z.square().le(x * y))?;
    m.minimize(x + 4.0 * y)?;
    cases.optimal(&m, 8.0, &[(x, 4.0), (y, 1.0), (z, -2.0)]);

    let mut m = Model::new("a sum of lengths");
    let (x, y) = (m.continuous("x", -9.0, 9.0)?, m.continuous("y", -9.0, 9.0)?);
    let parts = m.continuous_family("part", 2, 0.0, INF)?;
    m.add("first", norm([x, y]).le(parts[0]))?;
    m.add("second", norm([x - 8.0, y - 6.0]).le(parts[1]))?;
    m.add("away", x.le(2.0))?;
    m.minimize(2.0 * parts[0] + parts[1])?;
    // Twice as dear near the origin, so all of the way is near the other point.
    cases.optimal(&m, 10.0, &[(x, 0.0), (y, 0.0)]);
    Ok(())
}

fn integer(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("the points of a lattice in a disc");
    let (i, j) = (m.integer("i", -9.0, 9.0)?, m.integer("j", -9.0, 9.0)?);
    m.add("disc", norm([i, j]).le(5.0))?;
    m.maximize(2.0 * i + 3.0 * j)?;
    cases.optimal(&m, 18.0, &[(i, 3.0), (j, 4.0)]);

    let mut m = Model::new("a radius that can be bought");
    let (x, y) = (m.continuous("x", -5.0, 5.0)?, m.continuous("y", -5.0, 5.0)?);
    let z = m.binary("z")?;
    m.add("disc", norm([x, y]).le(z + 1.0))?;
    m.maximize(x + y - z)?;
    // 2 sqrt(2) - 1 beside sqrt(2).
    cases.optimal(&m, 8.0_f64.sqrt() - 1.0, &[(z, 1.0), (x, 2.0_f64.sqrt())]);
    m.maximize(x + y - 2.0 * z)?;
    cases.optimal(&m, 2.0_f64.sqrt(), &[(z, 0.0), (y, 0.5_f64.sqrt())]);

    let mut m = Model::new("a rotated cone of integers");
    let (i, j) = (m.integer("i", 0.0, 9.0)?, m.integer("j", 0.0, 9.0)?);
    let x = m.continuous("x", 3.5, INF)?;
    m.add("cone", x.square().le(i * j))?;
    m.minimize(2.0 * i + 3.0 * j)?;
    // i j >= 12.25: of (5, 3), (7, 2), (4, 4), ... the first one.
    cases.optimal(&m, 19.0, &[(i, 5.0), (j, 3.0)]);

    let mut m = Model::new("squares of binaries and of others");
    let z = m.binary_family("z", 3)?;
    let x = m.continuous("x", 0.0, 4.0)?;
    m.add("load", (z[0].square() + 2.0 * z[1].square() + z[2].square() + x.square()).le(3.25))?;
    m.maximize(z[0] + 2.0 * z[1] + z[2] + x)?;
    // The second and another one leave 0.5 for x; one alone or the other two leave 1.118.
    cases.optimal(&m, 3.5, &[(z[1], 1.0), (x, 0.5)]);
    Ok(())
}

fn conditional(cases: &mut Cases) -> Result<(), Error> {
    // A disc around one point or around another one, the farther one dearer.
    for (cost, optimum, on) in [(1.0, 5.0, 1.0), (4.0, 3.0, 0.0)] {
        let mut m = Model::new("one disc or another one");
        let (x, y) = (m.continuous("x", -9.0, 9.0)?, m.continuous("y", -9.0, 9.0)?);
        let z = m.binary("z")?;
        m.add("far", z.on().implies(norm([x - 4.0, 1.0 * y]).le(2.0)))?;
        m.add("near", z.off().implies(norm([x - 1.0, 1.0 * y]).le(2.0)))?;
        m.maximize(x - cost * z)?;
        cases.optimal(&m, optimum, &[(x, 3.0 + 3.0 * on), (z, on)]);
    }

    let mut m = Model::new("a rotated cone under a condition");
    let (x, y) = (m.continuous("x", 0.0, 9.0)?, m.continuous("y", 0.0, 9.0)?);
    let (t, z) = (m.continuous("t", 2.0, 3.0)?, m.binary("z")?);
    m.add("cone", z.on().implies(t.square().le(x * y)))?;
    m.add("dear", z.off().implies((x + y).ge(5.0)))?;
    m.minimize(x + y)?;
    cases.optimal(&m, 4.0, &[(x, 2.0), (y, 2.0), (t, 2.0), (z, 1.0)]);

    let mut m = Model::new("a disc or a box");
    let (x, y) = (m.continuous("x", -9.0, 9.0)?, m.continuous("y", -9.0, 9.0)?);
    m.add("place", either(norm([x, y]).le(2.0)).or([x.within(2.0, 3.0), y.within(-1.0, 0.5)]))?;
    m.maximize(x + y)?;
    cases.optimal(&m, 3.5, &[(x, 3.0), (y, 0.5)]);
    m.maximize(2.0 * y - 10.0 * x)?;
    cases.optimal(&m, 416.0_f64.sqrt(), &[]);
    Ok(())
}

fn without_a_point(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("a line beside a disc");
    let (x, y) = (m.continuous("x", -5.0, 5.0)?, m.continuous("y", -5.0, 5.0)?);
    m.add("disc", norm([x, y]).le(1.0))?;
    m.add("line", (x + y).ge(1.5))?;
    cases.infeasible(&minimizing(m, x)?);

    let mut m = Model::new("no point of a lattice in a disc");
    let (i, j) = (m.integer("i", -9.0, 9.0)?, m.integer("j", -9.0, 9.0)?);
    m.add("disc", norm([i - 0.5, j - 0.5]).le(0.6))?;
    cases.infeasible(&minimizing(m, i)?);

    let mut m = Model::new("a cone without end");
    let (x, y) = (m.continuous("x", -INF, INF)?, m.continuous("y", -5.0, 5.0)?);
    m.add("cone", (y - 1.0).square().le(x))?;
    m.maximize(x - y)?;
    cases.unbounded(&m);
    Ok(())
}
