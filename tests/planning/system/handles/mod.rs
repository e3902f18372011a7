//! Systems stated by handles are those stated by numbers.
//!
//! | module | contents |
//! | --- | --- |
//! | [`plain`] | systems in plain numbers, and random ones |
//! | [`by_matrices`], [`stated`] | the same by matrices, and by handles |
//! | [`refusals`] | what cannot be stated |
//! | [`programs`] | two systems in one program, handles by name |

mod by_matrices;
mod plain;
mod programs;
mod refusals;
mod series_in_flows;
mod stated;

use carom::ErrorKind;
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;
use plain::plain;
use stated::without_texts;

proptest! {
    #![proptest_config(config(400, "tests/regressions/handles.txt"))]

    #[test]
    fn handles_state_what_numbers_do(plain in plain(), from in 0..4_usize) {
        let by_handles = plain.by_handles();
        if plain.is_crossed() {
            let error = by_handles.unwrap_err();
            prop_assert!(matches!(error.kind(), ErrorKind::CrossedBounds { .. }), "{error}");
            return Ok(());
        }
        let by_handles = by_handles.unwrap();
        if plain.lacks_flow() {
            let error = by_handles.check().unwrap_err();
            prop_assert!(error.to_string().contains("the system without a flow"), "{error}");
            return Ok(());
        }
        let by_numbers = plain.by_numbers();
        by_handles.check().unwrap();
        by_numbers.check().unwrap();
        let texts = without_texts(by_handles.clone());
        prop_assert_eq!(&texts, &by_numbers, "{}\n{}", by_handles, by_numbers);
        // The same from a later step on, where series move along with everything else.
        let later = without_texts(by_handles.from_step(from));
        prop_assert_eq!(&later, &by_numbers.from_step(from));
        by_handles.write(&mut Model::new("m"), "", 3).unwrap();
        let (mut own, mut other) = (Model::new("m"), Model::new("m"));
        texts.write(&mut own, "", 3).unwrap();
        by_numbers.write(&mut other, "", 3).unwrap();
        prop_assert_eq!(own.to_string(), other.to_string());
    }
}
