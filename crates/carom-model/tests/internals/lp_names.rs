//! Names in LP files: what they are written as, and back.

use carom::model::Name;
use carom_model::internals::model::lp_names::{read, write};

/// Names, and how they are written.
const CASES: [(&str, &str); 16] = [
    ("x", "x"),
    ("x[17]", "x{17}"),
    ("x[1][2]", "x%5B1%5D{2}"),
    ("x[01]", "x%5B01%5D"),
    ("a-b", "a%2Db"),
    ("1st", "%31st"),
    ("Free", "%46ree"),
    ("free[0]", "free{0}"),
    ("x{3}", "x%7B3}"),
    ("50%", "%350%"),
    ("a%41", "a%2541"),
    ("r%ge", "r%25ge"),
    ("höhe", "höhe"),
    ("e1", "e1"),
    ("[3]", "%5B3%5D"),
    ("{3}", "%7B3}"),
];

#[test]
fn names_lead_back() {
    for (name, text) in CASES {
        assert_eq!(write(&Name::from(name)), text);
        assert_eq!(read(text), Name::from(name));
    }
}

#[test]
fn foreign_names_are_kept() {
    for text in ["x(3)", "x[3]", "a%41", "r%ge", "100%", "x{03}", "a%2db", "%", "%€"] {
        assert_eq!(read(text), Name::from(text));
    }
}
