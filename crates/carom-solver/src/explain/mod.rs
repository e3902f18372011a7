#![doc = include_str!("../../docs/explain.md")]

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

#[doc(alias("feasibility relaxation", "feasRelax", "slack"))]
pub use elastic_relaxation::elastic_relaxation;
pub use elastic_relaxation::{ElasticOptions, ElasticRelaxation, Stretch};
pub use explanation::{Explanation, ExplanationStatus, StatementGroup};
#[doc(alias("IIS", "irreducible infeasible subsystem", "conflict refiner"))]
pub use infeasibility::infeasibility;
pub use options::ExplainOptions;
pub use violations::violations;
