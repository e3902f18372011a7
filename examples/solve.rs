//! The program `carom`, which solves a model file or writes it in another format, as an example:
//! `cargo run --release --example solve -- FILE [OPTIONS]`; `--help` lists the options.

include!("../crates/carom-cli/src/main.rs");
