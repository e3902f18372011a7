//! Random models there and back, and random damage.

use carom::ErrorKind;
use carom::model::{Read, lp, mps};
use carom::prelude::*;
use proptest::prelude::*;

use super::read;
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
    let by_hand = "\\ Problem name: by hand\nMinimize\n obj: 3 x + y - 2 + [ x^2 + 2 x * y + y^2 ] / 2\n\
                   Subject To\n r: 1 <= x + y <= 4\n q: 2 x - [ x ^2 + x * y + y^2 ] >= -9.5\n s: z = 1 -> x = 2\n x - k >= -1e2\nBounds\n \
                   -inf <= x <= 5\n y free\n k <= 7\nGenerals\n k\nBinaries\n z\nSemis\n k\nSOS\n p: S2:: x:1 y:-2 z:1.5\n \
                   S1:: x:1\nEnd\n";
    vec![by_hand.to_owned(), lp::write(&model).unwrap()]
}

proptest! {
    #![proptest_config(config(512, "tests/regressions/files.txt"))]

    #[test]
    fn round_trips_are_exact(plan in plan()) {
        let model = build(&plan);
        let text = lp::write(&model).unwrap();
        let found = lp::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        prop_assert!(warnings_are_expected(&found.warnings), "{:?}", found.warnings);
        let again = found.model;
        assert_same(&model, &again);
        prop_assert_eq!(lp::write(&again).unwrap(), text);
        // And through the other format.
        let other = mps::read(&mps::write(&model).unwrap()).unwrap().model;
        assert_same(&model, &read(&lp::write(&other).unwrap()));
    }

    #[test]
    fn two_sided_rows_are_exact((lower, upper) in pair(false)) {
        let mut model = Model::new("");
        let x = model.continuous("x", 0.0, 1.0).unwrap();
        model.add("r", x.within(lower, upper)).unwrap();
        assert_same(&model, &read(&lp::write(&model).unwrap()));
    }

    #[test]
    fn cut_off_files_are_noticed(which in 0..2_usize, share in 0.0..1.0_f64) {
        let text = &whole_files()[which];
        let whole = text.len() - "End\n".len();
        let end = (share * whole as f64) as usize;
        let noticed = match lp::read(&text[..end]) {
            Ok(read) => read.warnings.iter().any(|warning| warning.message.contains("without `End`")),
            Err(error) => matches!(error.kind(), ErrorKind::Parse { .. }),
        };
        prop_assert!(noticed, "{}", &text[..end]);
    }

    #[test]
    fn damage_never_panics(
        which in 0..2_usize,
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4_u8, any::<char>()), 1..6),
        words in prop::collection::vec(
            prop::sample::select(vec![
                "1e400", "-", "1e-999999999", "inf", "->", "[", "]", "<=", " x ", " End ", "%ge", ":",
                " st ", "\\", "^", "=",
            ]),
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
        if let Ok(Read { model, .. }) = lp::read(&text) {
            assert_same(&model, &read(&lp::write(&model).unwrap()));
            assert_same(&model, &mps::read(&mps::write(&model).unwrap()).unwrap().model);
        }
    }

    #[test]
    fn any_text_is_an_answer(text in any::<String>(), pieces in prop::collection::vec(
        prop::sample::select(vec![
            "min", "max", "st", "bounds", "gen", "bin", "end", "x", "y", ":", "+", "-", "<=", ">=", "=",
            "->", "[", "]", "/", "2", "*", "^", "1.5", "+ [ x ^2 + y ^2 ]", "inf", "free", "\n", "semi", "sos",
        ]),
        0..40,
    )) {
        drop(lp::read(&text));
        drop(mps::read(&text));
        drop(lp::read(&format!("min {text} end")));
        let text = format!("min {} end", pieces.join(" "));
        if let Ok(Read { model, .. }) = lp::read(&text) {
            assert_same(&model, &read(&lp::write(&model).unwrap()));
        }
    }
}
