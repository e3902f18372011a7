//! Damaged files: every error with its line and column.

use carom::model::{Read, nl};
use proptest::prelude::*;

use super::{Sizes, error, read};
use crate::common::config;

fn small() -> String {
    let sizes =
        Sizes { nonlinear: [1, 1, 1], definitions: 1, nonzeros: [3, 1], ..Sizes::new(2, 2, 1) };
    sizes.file(
        "S0 2 sosno; 0 1; 1 1; S4 2 ref; 0 1; 1 2; V2 1 0; 1 2; v0; C0; o5; v0; n2; C1; n0; O0 0; o77; v2; r; \
         1 4; 0 -1 5; b; 0 -2 2; 2 0; k1; 2; J0 2; 0 0; 1 1; J1 1; 1 3; G0 1; 0 1",
    )
}

#[test]
fn headers() {
    let whole = small();
    for (text, expected) in [
        ("", "line 1, column 1: expected `g` or `b` and the options of AMPL, as in `g3 1 1 0`"),
        ("max x\n", "line 1, column 1: expected `g` or `b` and the options"),
        ("g3 1 1 x\n", "line 1, column 1: expected `g` or `b` and the options"),
        (
            "g3 1 1 0\n",
            "line 2, column 1: expected the line of the header with numbers of variables",
        ),
        (
            &whole.replace(" 2 2 1 0 0\t", " 2 2\t"),
            "line 2, column 2: expected the line of the header with numbers of variables, constraints and \
             objectives, at least 3 integers",
        ),
        (&whole.replace(" 2 2 1 0 0\t", " 2 -2 1 0 0\t"), "line 2, column 2: expected the line of"),
        (
            &whole.replace(" 2 2 1 0 0\t", " 200000000 2 1 0 0\t"),
            "line 1, column 1: 200000000 variables are more than the file has bytes",
        ),
        (
            &whole.replace(" 1 1 1\n", " 3 1 1\n"),
            "line 5, column 2: the numbers of nonlinear and discrete variables contradict each other",
        ),
        (&whole.replace("\n 0 0 0 0 0\n", "\n 3 0 0 0 0\n"), "line 5, column 2: the numbers of"),
    ] {
        let found = error(text);
        assert!(found.starts_with(expected), "{text}\n{found}");
    }
}

#[test]
fn segments() {
    let whole = small();
    assert_eq!(read(&whole).conic_constraint_count(), 1);
    for (old, new, expected) in [
        ("C1\n", "C2\n", "line 24, column 2: expected a constraint from 0 to 1, found 2"),
        ("C1\n", "C0\n", "line 24, column 1: this segment is given twice; keep one"),
        (
            "C1\n",
            "c1\n",
            "line 24, column 1: expected a segment, which begins with one of the letters",
        ),
        (
            "O0 0\n",
            "O0 2\n",
            "line 26, column 4: expected 0 to minimise or 1 to maximise from 0 to 1",
        ),
        ("O0 0\n", "O1 0\n", "line 26, column 2: expected an objective from 0 to 0, found 1"),
        ("v2\n", "v3\n", "line 28, column 2: expected a variable from 0 to 2, found 3"),
        ("V2 1 0\n", "V1 1 0\n", "line 17, column 1: `V1` is no defined variable"),
        ("v0\nC0", "v2\nC0", "line 19, column 2: `v2` is used before the segment `V2`"),
        ("1 4\n", "6 4\n", "line 30, column 1: expected the limits of a constraint: a digit"),
        ("1 4\n", "1 four\n", "line 30, column 3: a limit is not a number"),
        ("0 -1 5\n", "0 5 -1\n", "line 31, column 1: the limits of a constraint are crossed"),
        ("0 -2 2\n", "0 2 -2\n", "line 33, column 1: the bounds of a variable are crossed"),
        (
            "J0 2\n0 0\n",
            "J0 2\n2 0\n",
            "line 38, column 1: expected a variable from 0 to 1, found 2",
        ),
        ("J1 1\n1 3\n", "J1 1\n1 1e25\n", "line 41, column 3: a coefficient counts as infinite"),
        ("J1 1\n", "J1 -1\n", "line 40, column 4: the number of coefficients is -1"),
        (
            "J1 1\n",
            "J1 99999999\n",
            "line 40, column 4: the number of coefficients is 99999999, which",
        ),
        ("G0 1\n0 1\n", "G0 2\n0 1\n", "line 44, column 1: the file ends before a variable"),
        ("n2\n", "x2\n", "line 23, column 1: expected an expression: `o`, `n` or `v` and a number"),
        (
            "S4 2 ref\n",
            "S4 2 other\n",
            "line 12, column 3: `x[0]` is in the ordered set 1 and has no",
        ),
        ("0 1\n1 1\n", "0 1.5\n1 1\n", "line 12, column 3: expected a value, found `1.5`"),
    ] {
        assert!(whole.contains(old), "{old}");
        let found = error(&whole.replacen(old, new, 1));
        assert!(found.starts_with(expected), "{old:?} as {new:?}: {found}\nexpected: {expected}");
    }
    let (before, _) = whole.split_once("b\n").unwrap();
    let found = error(before);
    assert!(found.ends_with("the file ends before the bounds (segment `b`)"), "{found}");
    let (before, _) = whole.split_once("J1 1\n").unwrap();
    let expected =
        "line 40, column 1: the header counts 3 terms in segments `J`, and there are 2; the file";
    assert!(error(before).starts_with(expected), "{}", error(before));
    let found = error(&whole.replace("r\n1 4\n0 -1 5\n", ""));
    assert!(found.ends_with("the file ends before the limits (segment `r`)"), "{found}");
}

proptest! {
    #![proptest_config(config(512, "tests/regressions/nl.txt"))]

    #[test]
    fn damage_never_panics(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..5_u8, any::<char>()), 1..4),
        words in prop::collection::vec(
            prop::sample::select(vec!["1e400", "-", "nan", "0", "7", "o2\n", "o54\n3\n", "v1\n", "n1\n", "J0 2\n"]),
            4,
        ),
    ) {
        let mut text: Vec<char> = small().chars().collect();
        for ((place, edit, letter), word) in edits.into_iter().zip(words) {
            if text.is_empty() {
                continue;
            }
            let place = place.index(text.len());
            match edit {
                0 => { text.remove(place); }
                1 => text[place] = letter,
                2 => text.insert(place, '\n'),
                3 => text.truncate(place + 1),
                _ => { text.splice(place..place, word.chars()); }
            }
        }
        let text: String = text.into_iter().collect();
        match nl::read(&text) {
            Ok(Read { model, .. }) => {
                let again = read(&nl::write(&model).unwrap());
                prop_assert_eq!(again.conic_constraint_count(), model.conic_constraint_count());
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
        // Of bytes that are no text, nothing is asked but that.
        let mut bytes = text.into_bytes();
        bytes.iter_mut().take(1).for_each(|first| *first = b'b');
        drop(nl::read(&bytes));
    }
}
