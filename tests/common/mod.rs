//! What the test files share: small programs as plain numbers, their generation, and an exact
//! answer by enumeration. Nothing here uses the crate's solving code; a program is handed to the
//! crate through its public modelling language only.

// Every test file is a crate of its own and uses a part of this module.
#![allow(dead_code)]

pub(crate) mod case;
pub(crate) mod enumeration;
pub(crate) mod generate;
pub(crate) mod judge;
pub(crate) mod mode_steps;
pub(crate) mod other_words;
pub(crate) mod quadratic_program;
pub(crate) mod rows;

use proptest::test_runner::{Config, FileFailurePersistence, RngSeed};

/// A fixed seed, so that every run tests the same programs and a failure is never a matter of
/// luck. `PROPTEST_CASES` and `PROPTEST_RNG_SEED` widen the search; what they find is kept in
/// `regressions` and becomes part of every later run.
pub(crate) fn config(cases: u32, regressions: &'static str) -> Config {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    Config {
        cases: number("PROPTEST_CASES").map_or(cases, |cases| cases as u32),
        rng_seed: RngSeed::Fixed(number("PROPTEST_RNG_SEED").unwrap_or(0x00CA_704F)),
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(regressions))),
        max_shrink_iters: 4000,
        max_global_rejects: 100_000,
        ..Config::default()
    }
}
