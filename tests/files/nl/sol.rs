//! Answers: the text that is written, what other solvers write, and what is damaged.

use carom::model::nl::{self, SolFile};
use carom::prelude::*;

use super::Sizes;

#[test]
fn the_text_that_is_written() {
    let mut answer = SolFile::to(Sizes::new(2, 3, 1).file("")).unwrap();
    answer.message = "carom: optimal\nOptions".to_owned();
    (answer.values, answer.bound, answer.code) = (vec![0.1, -2.0], Some(7.5), 400);
    let text = answer.to_string();
    assert_eq!(
        text,
        "carom: optimal\n> Options\n\nOptions\n3\n1\n1\n0\n3\n0\n2\n2\n0.1\n-2\nobjno 0 400\nsuffix 6 1 10 0 \
         0\nbestbound\n0 7.5\n"
    );
    let again = SolFile::read(&text).unwrap();
    assert_eq!(again.values, answer.values);
    assert_eq!((again.bound, again.code, again.rows), (Some(7.5), 400, 3));
    assert_eq!(again.options, [1, 1, 0]);
    // A tolerance in the header comes back behind the sizes.
    let first = Sizes::new(1, 0, 1).header("g3 1 3 0 1e-05\t# problem p");
    let mut answer = SolFile::to(first).unwrap();
    answer.values = vec![4.0];
    let text = answer.to_string();
    assert_eq!(text, "\nOptions\n5\n1\n3\n0\n0\n0\n1\n1\n1e-5\n4\nobjno 0 0\n");
    assert_eq!(SolFile::read(&text).unwrap(), answer);
}

/// With multipliers, suffixes with a table, and something of the solver's own at the end.
#[test]
fn what_other_solvers_write_is_read() {
    let text = "\nsolver 9.1: best objective 5\n12 nodes\n\nOptions\n3\n0\n1\n0\n2\n2\n2\n2\n0.5\n-0\n1e-9\n\
                3.0000000001\nobjno 0 2\nsuffix 0 2 8 30 2\nsstatus\n0\tnone\tno status\n1\tbas\tbasic\n0 1\n1 \
                3\nsuffix 6 1 10 0 0\nbestbound\n0 5.25\nkestrel 1\n";
    let answer = SolFile::read(text).unwrap();
    assert_eq!(answer.message, "solver 9.1: best objective 5\n12 nodes");
    assert_eq!((answer.multipliers, answer.values), (vec![0.5, -0.0], vec![1e-9, 3.000_000_000_1]));
    assert_eq!((answer.code, answer.bound), (2, Some(5.25)));
    let none =
        SolFile::read("infeasible\n\nOptions\n3\n1\n1\n0\n2\n0\n2\n0\nobjno 0 200\n").unwrap();
    assert!(none.values.is_empty() && none.code == 200 && none.columns == 2);
}

#[test]
fn damage_is_named_with_its_place() {
    for (text, expected) in [
        ("message\n", "line 2, column 1: the file ends before the line `Options`"),
        ("Options\nx\n", "line 2, column 1: expected the number of options, found `x`"),
        ("Options\n0\n1\n0\n2\n2\n1.5\n", "line 8, column 1: the file ends before a value"),
        ("Options\n0\n1\n0\n2\n1\none\n", "line 7, column 1: a value is not a number"),
        (
            "Options\n0\n0\n0\n0\n0\nobjno 1\n",
            "line 7, column 1: expected the objective and the code",
        ),
        (
            "Options\n0\n999999999\n999999999\n0\n0\n",
            "line 7, column 1: 999999999 numbers are more",
        ),
        ("Options\n0\n-1\n0\n0\n0\n", "line 3, column 1: expected a size from 0 to"),
    ] {
        let error = SolFile::read(text).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{text:?}: {error}");
    }
}

/// The columns of a written file have another order than the variables.
#[test]
fn values_find_their_variables() -> Result<(), Error> {
    let mut model = Model::new("order");
    let z = model.binary("z")?;
    let n = model.integer("n", 0.0, 5.0)?;
    let x = model.continuous("x", -3.0, 3.0)?;
    let y = model.integer("y", -3.0, 3.0)?;
    model.add("disc", (x.square() + y.square()).le(4.0))?;
    model.add("sum", (z + n + x).le(3.5))?;
    model.minimize(x.square() - z - n)?;
    let text = nl::write(&model)?;
    // x is in both, y in the constraint, z a binary, n an integer.
    let mut answer = SolFile::to(&text)?;
    answer.values = vec![0.5, -1.0, 1.0, 2.0];
    let values = answer.values_of(&model)?;
    assert_eq!(values, [(z, 1.0), (n, 2.0), (x, 0.5), (y, -1.0)]);
    let [own, file] =
        [&model, &nl::read(&text)?.model].map(|m| BranchAndBound::default().solve(m).unwrap());
    let difference = own.objective().unwrap() - file.objective().unwrap();
    assert!(difference.abs() < 1e-6, "{difference}");
    answer.values.pop();
    assert!(answer.values_of(&model).unwrap_err().to_string().contains("SOL file is 3"));
    Ok(())
}
