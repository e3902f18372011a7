//! Plans that hold for every disturbance within stated ranges.
//!
//! | part | file |
//! | --- | --- |
//! | feedbacks, and the directions of their errors | `robust/feedback.rs` |
//! | a program with a tube | `robust/program.rs` |
//! | the tube as rows: how it grows, what it takes of the system's limits | `robust/tube.rs` |
//! | the program's own statements, tightened | `robust/tighten.rs` |
//! | variables that differ because others define them | `robust/defined.rs` |
//! | the certificate, by interval simulation | `robust/certificate.rs` |
//! | plans and their promise | `robust/plan.rs` |
//! | shortest horizons | `robust/shortest.rs` |
//! | several cases with the inputs shared until they differ | `robust/scenarios.rs` |
//! | what its rows say, in words; modes that no tube goes between | `robust/words.rs` |
//!
//! Disturbed runs are flown by `simulate/disturbed.rs`.

mod certificate;
mod defined;
mod feedback;
mod plan;
mod program;
mod scenarios;
mod shortest;
mod tighten;
mod tube;
mod words;

pub use certificate::RobustCertificate;
pub use feedback::Feedback;
pub use plan::RobustPlan;
pub use program::RobustProgram;
pub(crate) use shortest::shortest_robust;
