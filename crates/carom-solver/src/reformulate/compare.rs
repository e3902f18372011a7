//! A comparison of the methods for lowering disjunctions: sizes and root bounds.

use std::fmt;

use super::{Lowered, lower_by};
use crate::error::Error;
use crate::model::{Method, Model};
use crate::solution::FacetCounts;
use crate::solver::{Heuristics, PoolMode, Solver};

/// A model lowered by one method.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MethodSize {
    /// The method, used for every disjunction.
    pub method: Method,
    /// Rows of the lowered model.
    pub rows: usize,
    /// Columns of the lowered model.
    pub columns: usize,
    /// Non-zero coefficients of its rows.
    pub nonzeros: usize,
    /// Proved bound of the continuous relaxation, in the objective's unit; infinite if the
    /// relaxation is infeasible or unbounded.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub root_bound: f64,
    /// Facets of unions that the search would find at the root, and what they lift: 0 of them if
    /// the rows and other cuts leave nothing to lift, or if the solver looks for none.
    pub facets: FacetCounts,
}

/// Sizes and root bounds by method; made by [`compare_methods`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MethodComparison {
    entries: Vec<MethodSize>,
}

impl MethodComparison {
    /// One entry per method, in the order of [`Method::ALL`].
    pub fn entries(&self) -> &[MethodSize] {
        &self.entries
    }
}

impl fmt::Display for MethodComparison {
    /// A table with one line per method.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "method     rows  columns  non-zeros  root bound  facets  with facets")?;
        for entry in &self.entries {
            let MethodSize { rows, columns, nonzeros, root_bound, .. } = entry;
            let method = entry.method.word();
            write!(f, "{method:<8}{rows:>7}{columns:>9}{nonzeros:>11}{root_bound:>12.6}")?;
            match entry.facets.facets {
                0 => writeln!(f, "{:>8}{:>13}", 0, "-")?,
                facets => writeln!(f, "{facets:>8}{:>13.6}", entry.facets.root_after)?,
            }
        }
        Ok(())
    }
}

/// Lowers a model by each method and solves its relaxation; then looks at the root for facets of
/// its unions, as a search does after many nodes, without presolve. Where there are some, the
/// bound with them is that of the root with all cuts.
///
/// ```
/// use carom::prelude::*;
/// use carom::reformulate;
///
/// let mut model = Model::new("two_boxes");
/// let x = model.continuous("x", 0.0, 8.0)?;
/// let y = model.continuous("y", 0.0, 9.0)?;
/// let (near, far) = ([x.le(2.0), y.le(1.0)], [x.ge(6.0), y.within(4.0, 5.0)]);
/// model.add("box", either(near).or(far))?;
/// model.maximize(y - x)?;
/// let table = reformulate::compare_methods(&model, &mut BranchAndBound::default())?;
/// let bounds: Vec<f64> = table.entries().iter().map(|entry| entry.root_bound.round()).collect();
/// // The optimum is 1, which an M over the whole box does not prove.
/// assert_eq!(bounds, [2.0, 1.0, 1.0]);
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Errors
///
/// Those of [`lower`](super::lower) and of the solver.
pub fn compare_methods<S: Solver + ?Sized>(
    model: &Model,
    solver: &mut S,
) -> Result<MethodComparison, Error> {
    let mut entries = Vec::with_capacity(Method::ALL.len());
    for method in Method::ALL {
        let lowered: Lowered = lower_by(model, Some(method))?;
        let plain = lowered.model();
        let relaxed = solver.solve(&plain.clone().with_continuous_variables())?;
        let facets = facets(plain, solver)?;
        entries.push(MethodSize {
            method,
            rows: plain.constraint_count(),
            columns: plain.variable_count(),
            nonzeros: plain.constraints().map(|row| row.terms().len()).sum(),
            root_bound: relaxed.bound(),
            facets,
        });
    }
    Ok(MethodComparison { entries })
}

/// The facets that a solver finds for the root of a model.
fn facets<S: Solver + ?Sized>(model: &Model, solver: &mut S) -> Result<FacetCounts, Error> {
    let options = solver.options().clone();
    let mut root = options.clone().with_presolve(false).with_heuristics(Heuristics::none());
    root = root.with_pool(1, PoolMode::Found).with_cuts(true).with_node_limit(1);
    // Other threads would take nodes before the root has ended.
    root = root.with_threads(1).with_deterministic(false);
    root.proof = None;
    *solver.options_mut() = root.with_leaves(false).with_facet_nodes(0);
    let solved = solver.solve(model);
    *solver.options_mut() = options;
    Ok(solved?.statistics().facets)
}
