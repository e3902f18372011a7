//! Missions in signal temporal logic.
//!
//! | part | file |
//! | --- | --- |
//! | formulas and the operators that make them | `mission/formula.rs` |
//! | windows, in steps or in seconds | `mission/window.rs` |
//! | the text form | `mission/text.rs` |
//! | the robustness of a run, from its values alone | `mission/robustness.rs` |
//! | ranges that decide predicates beforehand | `mission/ranges.rs` |
//! | the mission over the samples, equal parts once | `mission/unrolled.rs` |
//! | its rows | `mission/rows.rs` |
//! | values of handles in plans and runs | `mission/values.rs` |
//! | the missions that a program requires | `mission/required.rs` |
//! | programs and plans with missions | `mission/program.rs` |
//! | which part is the reason why there is no plan | `mission/conflict.rs` |

mod conflict;
mod formula;
mod program;
mod ranges;
mod required;
mod robustness;
mod rows;
mod text;
mod unrolled;
mod values;
mod window;

pub use formula::Mission;
pub(crate) use required::RequiredMission;
pub use window::IntoWindow;
