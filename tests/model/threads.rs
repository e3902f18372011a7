//! What users hold can be sent to other threads and shared between them.

use carom::collision_tolerant::{Plan, Scenario, ShortestPlan};
use carom::explain::Explanation;
use carom::hybrid::HybridSystem;
use carom::hybrid::reach::ReachSets;
use carom::hybrid::{Contact, LinearSystem};
use carom::prelude::*;
use carom::reformulate::{BigMReport, Lowered};
use carom::solution::Pool;
use carom::solver::TreeSeed;

fn shared<T: Send + Sync>() {}

#[test]
fn what_users_hold_is_send_and_sync() {
    shared::<Model>();
    shared::<Solution>();
    shared::<Pool>();
    shared::<Options>();
    shared::<BranchAndBound>();
    shared::<Error>();
    shared::<Interrupt>();
    shared::<TreeSeed>();
    shared::<Lowered>();
    shared::<BigMReport>();
    shared::<Explanation>();
    shared::<LinearSystem>();
    shared::<Contact>();
    shared::<HybridSystem>();
    shared::<ReachSets>();
    shared::<Scenario>();
    shared::<Plan>();
    shared::<ShortestPlan>();
}
