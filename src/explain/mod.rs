#![doc = include_str!("../../docs/modules/explain.md")]

mod domains;
mod elastic;
mod explanation;
mod groups;
mod infeasibility;
mod narrow;
mod options;
mod oracle;
mod relaxation;
mod violations;

pub use explanation::{Explanation, ExplanationStatus, Group};
pub use infeasibility::infeasibility;
pub use options::ExplainOptions;
pub use relaxation::{ElasticOptions, Relaxed, Stretch, relaxation};
pub use violations::violations;
