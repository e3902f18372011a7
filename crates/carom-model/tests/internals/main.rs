//! Parts of this crate that no user sees.

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod decimal;
mod lp_names;
mod name_table;
mod semidefinite;
mod standard_cone;
mod subset;
mod sum;
