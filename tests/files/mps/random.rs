//! Random models there and back, and random damage.

use carom::ErrorKind;
use carom::model::{Read, mps};
use carom::prelude::*;
use proptest::prelude::*;

use super::{read, with};
use crate::common::config;
use crate::models::{build, pair, plan, warnings_are_expected};
use crate::there_and_back::assert_same;

/// Files to damage: one written by hand with every section, one written by the crate.
fn whole_files() -> Vec<String> {
    let mut model = Model::new("whole");
    let x = model.continuous_family("x", 3, -1.0, 4.5).unwrap();
    let z = model.binary("z").unwrap();
    model.add("sum", (x[0] + x[1] + 0.5 * x[2]).within(-1.2, 1.1)).unwrap();
    model.add("hit", z.on().implies(x[1].le(0.0))).unwrap();
    model.add("disc", (x[0].square() + (x[1] - x[2]).square()).le(0.5 * x[2] + 9.5)).unwrap();
    model.minimize((x[0] - x[1]).square() + 3.0 * x[2] + 1.0).unwrap();
    let by_hand = with(
        "RHS\n B most 4 least -1e2\n B cost 2\nRANGES\n R most 3 least Infinity\nBOUNDS\n \
         UP B x 4\n MI B y\n BV B k\n SC B w 4\n LO B w 1\nSOS\n S1 p\n x 1\n w 2.5\nQMATRIX\n x x 2\n x y 1D0\n y x 1\n y y 2\nQCMATRIX least\n x x -1\n x y -.25\n \
         y x -.25\n y y -1\nINDICATORS\n \
         IF most k 1\n",
    );
    let by_hand = by_hand.replace(" M1 'MARKER'", " w least 1\n M1 'MARKER'");
    vec![by_hand, mps::write(&model).unwrap()]
}

proptest! {
    #![proptest_config(config(512, "tests/regressions/files.txt"))]

    #[test]
    fn round_trips_are_exact(plan in plan()) {
        let model = build(&plan);
        let text = mps::write(&model).unwrap();
        let found = mps::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        prop_assert!(warnings_are_expected(&found.warnings), "{:?}", found.warnings);
        let again = found.model;
        assert_same(&model, &again);
        prop_assert_eq!(mps::write(&again).unwrap(), text);
    }

    #[test]
    fn two_sided_rows_are_exact((lower, upper) in pair(false)) {
        let mut model = Model::new("");
        let x = model.continuous("x", 0.0, 1.0).unwrap();
        model.add("r", x.within(lower, upper)).unwrap();
        assert_same(&model, &read(&mps::write(&model).unwrap()));
    }

    #[test]
    fn cut_off_files_are_refused(which in 0..2_usize, share in 0.0..1.0_f64) {
        let text = &whole_files()[which];
        let whole = text.len() - "ENDATA\n".len();
        let mut end = (share * whole as f64) as usize;
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let refused = mps::read(&text[..end]).is_err_and(|error| matches!(error.kind(), ErrorKind::Parse { .. }));
        prop_assert!(refused, "{}", &text[..end]);
    }

    #[test]
    fn damage_never_panics(
        which in 0..2_usize,
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4_u8, any::<char>()), 1..6),
        words in prop::collection::vec(
            prop::sample::select(vec!["1e400", "-", "1e-999999999", "nan", "'MARKER'", "x", "UP"]),
            6,
        ),
    ) {
        let mut text: Vec<char> = whole_files()[which].chars().collect();
        for ((place, edit, letter), word) in edits.into_iter().zip(words) {
            let place = place.index(text.len());
            match edit {
                0 => { text.remove(place); }
                1 => text[place] = letter,
                2 => text.insert(place, '\n'),
                _ => { text.splice(place..place, word.chars()); }
            }
        }
        let text: String = text.into_iter().collect();
        if let Ok(Read { model, .. }) = mps::read(&text) {
            let again = read(&mps::write(&model).unwrap());
            prop_assert_eq!(model.to_string(), again.to_string());
        }
    }
}
