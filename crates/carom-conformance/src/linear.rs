//! Linear programs: over binaries, over integers, over continuous variables, and none at all.

use carom_model::error::Error;
use carom_model::model::{Affine, Model};

use super::answer::{Case, Cases, INF, Truth, minimizing, sum};

/// Values 8, 9, 5, 13, weights 4, 5, 3, 7, capacity 10: the last two, 18. The relaxation has 19.14.
pub(super) fn knapsack() -> Result<Case, Error> {
    let mut m = Model::new("knapsack");
    let x = m.binary_family("x", 4)?;
    m.add("capacity", sum(&[4.0, 5.0, 3.0, 7.0], &x).le(10.0))?;
    m.maximize(sum(&[8.0, 9.0, 5.0, 13.0], &x))?;
    let values = x.iter().zip([0.0, 0.0, 1.0, 1.0]).collect();
    Ok(Case::new(m, Truth::Optimal(18.0, values)))
}

/// Twice a sum of 31 binaries and `odd` make 31, so `odd` is 1 at the optimum. Refuting 0
/// takes an enumeration, because a relaxation does not see parity.
pub(super) fn parity() -> Result<Model, Error> {
    let mut m = Model::new("parity");
    let odd = m.binary("odd")?;
    let x = m.binary_family("x", 31)?;
    let sum: Affine = x.iter().sum();
    m.add("sum", (2.0 * sum + odd).equals(31.0))?;
    minimizing(m, odd)
}

pub(super) fn cases() -> Result<Vec<Case>, Error> {
    let mut cases = Cases(vec![knapsack()?]);
    binary(&mut cases)?;
    continuous(&mut cases)?;
    infeasible(&mut cases)?;
    unbounded(&mut cases)?;
    scaled(&mut cases)?;
    Ok(cases.0)
}

fn binary(cases: &mut Cases) -> Result<(), Error> {
    cases.optimal(&Model::new("empty"), 0.0, &[]);

    let mut m = Model::new("empty, constant objective");
    m.maximize(3.5)?;
    cases.optimal(&m, 3.5, &[]);

    let mut m = Model::new("constant objective");
    let x = m.binary_family("x", 2)?;
    m.add("one", (x[0] + x[1]).equals(1.0))?;
    cases.optimal(&minimizing(m, -7.0)?, -7.0, &[]);

    let mut m = Model::new("all fixed");
    let x = m.binary_family("x", 2)?;
    m.fix(x[0], 1.0)?;
    m.fix(x[1], 0.0)?;
    m.add("sum", (x[0] + x[1]).le(1.0))?;
    m.maximize(2.0 * x[0] + 3.0 * x[1] + 0.5)?;
    cases.optimal(&m, 2.5, &[(x[0], 1.0), (x[1], 0.0)]);

    let mut m = Model::new("all fixed, against a row");
    let x = m.binary_family("x", 2)?;
    m.fix(x[0], 1.0)?;
    m.fix(x[1], 0.0)?;
    m.add("both", (x[0] + x[1]).ge(2.0))?;
    cases.infeasible(&m);

    let mut m = Model::new("equalities over binaries");
    let x = m.binary_family("x", 3)?;
    m.add("two", (x[0] + x[1] + x[2]).equals(2.0))?;
    m.add("same", (x[0] - x[1]).equals(0.0))?;
    let m = minimizing(m, x[0] + 5.0 * x[2])?;
    cases.optimal(&m, 1.0, &[(x[0], 1.0), (x[1], 1.0), (x[2], 0.0)]);

    let mut m = Model::new("a binary without rows");
    let x = m.binary_family("x", 3)?;
    m.add("cover", (x[0] + x[2]).ge(1.0))?;
    let m = minimizing(m, x[0] - x[1] + 2.0 * x[2])?;
    cases.optimal(&m, 0.0, &[(x[0], 1.0), (x[1], 1.0), (x[2], 0.0)]);

    let mut m = Model::new("binaries between whole numbers");
    let x = m.binary_family("x", 3)?;
    m.add("sum", sum(&[1.0; 3], &x).within(1.2, 1.8))?;
    m.maximize(x[0])?;
    cases.infeasible(&m);
    Ok(())
}

fn continuous(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("linear");
    let (x, y) = (m.continuous("x", 0.0, 4.0)?, m.continuous("y", 0.0, 6.0)?);
    m.add("row", (3.0 * x + 2.0 * y).le(18.0))?;
    m.maximize(3.0 * x + 5.0 * y)?;
    cases.optimal(&m, 36.0, &[(x, 2.0), (y, 6.0)]);

    let mut m = Model::new("integers");
    let (x, y) = (m.integer("x", 0.0, INF)?, m.integer("y", 0.0, INF)?);
    m.add("first", (6.0 * x + 4.0 * y).le(24.0))?;
    m.add("second", (x + 2.0 * y).le(6.0))?;
    m.maximize(5.0 * x + 4.0 * y)?;
    cases.optimal(&m, 20.0, &[(x, 4.0), (y, 0.0)]);

    for (lower, upper, least, most) in [(0.2, 2.7, 1.0, 2.0), (-2.7, -0.2, -2.0, -1.0)] {
        let mut m = Model::new("an integer with fractional bounds");
        let k = m.integer("k", lower, upper)?;
        m.minimize(k)?;
        cases.optimal(&m, least, &[(k, least)]);
        m.maximize(k)?;
        cases.optimal(&m, most, &[(k, most)]);
    }

    let mut m = Model::new("equalities only");
    let x = m.continuous_family("x", 3, -INF, INF)?;
    m.add("sum", sum(&[1.0; 3], &x).equals(6.0))?;
    m.add("first", (x[0] - x[1]).equals(-1.0))?;
    m.add("second", (x[1] - x[2]).equals(-1.0))?;
    cases.optimal(&minimizing(m, x[0])?, 1.0, &[(x[0], 1.0), (x[1], 2.0), (x[2], 3.0)]);

    let mut m = Model::new("equalities, one twice");
    let (x, k) = (m.continuous("x", -INF, INF)?, m.integer("k", -5.0, 5.0)?);
    m.add("row", (x + 0.5 * k).equals(2.25))?;
    m.add("again", (-4.0 * x - 2.0 * k).equals(-9.0))?;
    m.add("least", x.ge(0.0))?;
    cases.optimal(&minimizing(m, x)?, 0.25, &[(x, 0.25), (k, 4.0)]);

    let mut m = Model::new("free variables");
    let (x, y) = (m.continuous("x", -INF, INF)?, m.continuous("y", -INF, INF)?);
    m.add("sum", (x + y).ge(4.0))?;
    m.add("difference", (x - y).le(2.0))?;
    cases.optimal(&minimizing(m, 2.0 * x + 3.0 * y)?, 9.0, &[(x, 3.0), (y, 1.0)]);

    let mut m = Model::new("a variable without rows");
    let (x, idle) = (m.continuous("x", -INF, INF)?, m.continuous("idle", -3.0, 8.0)?);
    m.add("row", x.ge(1.0))?;
    cases.optimal(&minimizing(m, x + idle)?, -2.0, &[(x, 1.0), (idle, -3.0)]);

    let mut m = Model::new("a row with two limits");
    let (x, k) = (m.continuous("x", 0.0, 1.0)?, m.integer("k", 0.0, 9.0)?);
    m.add("between", (x + 2.0 * k).within(3.5, 4.75))?;
    m.maximize(x - k)?;
    // Two twos and no more than 0.75, or one and 1.5, which is too much.
    cases.optimal(&m, -1.25, &[(x, 0.75), (k, 2.0)]);

    let mut m = Model::new("constant objective of a mixed program");
    let (x, k) = (m.continuous("x", 0.0, 1.0)?, m.integer("k", 0.0, 3.0)?);
    m.add("row", (x + k).equals(2.5))?;
    m.maximize(7.0)?;
    cases.optimal(&m, 7.0, &[(x, 0.5), (k, 2.0)]);
    Ok(())
}

fn infeasible(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("infeasible rows and bounds");
    let (x, y) = (m.continuous("x", 0.0, 2.0)?, m.continuous("y", 0.0, 2.0)?);
    m.add("sum", (x + y).ge(5.0))?;
    m.maximize(x)?;
    cases.infeasible(&m);

    let mut m = Model::new("infeasible rows of free variables");
    let (x, y) = (m.continuous("x", -INF, INF)?, m.continuous("y", -INF, INF)?);
    m.add("above", (x - y).ge(1.0))?;
    m.add("below", (y - x).ge(0.0))?;
    cases.infeasible(&minimizing(m, x)?);

    let mut m = Model::new("infeasible for integers only");
    let (x, y) = (m.integer("x", 0.0, 5.0)?, m.integer("y", 0.0, 5.0)?);
    m.add("odd", (2.0 * x + 2.0 * y).equals(7.0))?;
    cases.infeasible(&minimizing(m, x + y)?);

    let mut m = Model::new("infeasible although its objective falls without limit");
    let x = m.continuous("x", 0.0, INF)?;
    let z = m.binary_family("z", 2)?;
    m.add("between", (z[0] + z[1]).within(0.2, 0.8))?;
    cases.infeasible(&minimizing(m, -x)?);

    let mut m = Model::new("no whole number between the bounds");
    let k = m.integer("k", 0.2, 0.8)?;
    m.maximize(k)?;
    cases.infeasible(&m);
    Ok(())
}

fn unbounded(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("unbounded");
    let (x, y) = (m.continuous("x", 0.0, INF)?, m.continuous("y", 0.0, INF)?);
    m.add("row", (x - y).le(1.0))?;
    cases.unbounded(&minimizing(m, -x)?);

    let mut m = Model::new("unbounded with integers");
    let x = m.integer("x", 0.0, INF)?;
    let (y, z) = (m.continuous("y", -INF, INF)?, m.binary("z")?);
    m.add("row", (x - y + z).le(2.0))?;
    m.maximize(x - z)?;
    cases.unbounded(&m);
    Ok(())
}

/// Rows and columns in units far from 1.
fn scaled(cases: &mut Cases) -> Result<(), Error> {
    let mut m = Model::new("rows in other units");
    let x = m.integer_family("x", 2, 0.0, 40.0)?;
    let y = m.continuous("y", 0.0, 10.0)?;
    m.add("large", (3e5 * x[0] + 2e5 * x[1] + 1e5 * y).le(6.55e6))?;
    m.add("small", (1e-4 * x[0] + 3e-4 * x[1] - 1e-4 * y).le(4.25e-3))?;
    m.maximize(2.0 * x[0] + 3.0 * x[1] + 0.5 * y)?;
    // In units of 1e5 and 1e-4: 27 + 28 + 10 <= 65.5 and 9 + 42 - 10 <= 42.5; the next best
    // choice, 7 and 15, has 64.
    cases.optimal(&m, 65.0, &[(x[0], 9.0), (x[1], 14.0), (y, 10.0)]);

    let mut m = Model::new("a column in another unit");
    let (x, z) = (m.continuous("x", 0.0, 1e5)?, m.binary("z")?);
    m.add("room", (1e-4 * x - 6.0 * z).le(2.5))?;
    m.add("cap", (1e-4 * x + 1.5 * z).le(10.0))?;
    m.maximize(1e-3 * x - 50.0 * z)?;
    // Without z 25 at x = 25 000, with it 35 at x = 85 000.
    cases.optimal(&m, 35.0, &[(z, 1.0)]);
    Ok(())
}
