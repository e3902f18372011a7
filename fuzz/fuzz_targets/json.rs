//! Texts as models in JSON: they are read or refused, and what is read survives every format.

#![no_main]

#[path = "../../tests/files/there_and_back.rs"]
mod there_and_back;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(model) = serde_json::from_str::<carom::model::Model>(text) {
        there_and_back::through_files(&model);
        let text = serde_json::to_string(&model).expect("a model can be written");
        let again = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        there_and_back::assert_same(&model, &again);
    }
});
