#![doc = include_str!("../../docs/modules/explain.md")]

mod domains;
mod elastic;
mod elastic_relaxation;
mod explanation;
mod groups;
mod infeasibility;
mod narrow;
mod options;
mod oracle;
mod violations;

pub use elastic_relaxation::{ElasticOptions, ElasticRelaxation, Stretch, elastic_relaxation};
pub use explanation::{Explanation, ExplanationStatus, Group};
pub use infeasibility::infeasibility;
pub use options::ExplainOptions;
pub use violations::violations;
