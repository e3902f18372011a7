//! Variables of a program that differ between runs because states and inputs define them: by
//! functions, and by equations.

use std::collections::{BTreeMap, BTreeSet};

use super::tighten::{BOUNDS, Carried, StatementTightening};
use crate::error::{Error, RobustError};
use crate::interval::Interval;
use crate::model::{Affine, Function, FunctionRef, Model, StoredRow, Variable, VariableKind};

impl StatementTightening<'_> {
    /// Finds the variables that differ, however they define each other. Returns the positions of
    /// the equations that define one.
    pub(super) fn defined(
        &mut self,
        model: &mut Model,
        original: &Model,
    ) -> Result<BTreeSet<usize>, Error> {
        let mut equations = BTreeSet::new();
        // How many variables of a function differed when its width was taken.
        let mut known: BTreeMap<Variable, usize> = BTreeMap::new();
        loop {
            let before = self.carried.len();
            while self.definitions(model, original, &mut equations)? {}
            for own in original.functions() {
                let count = self.count(&own);
                match known.get(&own.result()) {
                    None if count > 0 => {
                        let width = self.function(model, original, &own)?;
                        self.carried.insert(own.result(), Carried::Width(width));
                        known.insert(own.result(), count);
                    }
                    Some(known) if count > *known => {
                        let help = "state what defines its arguments before it";
                        let kind = "a function of variables that later functions define";
                        return Err(refused(&own, kind, help));
                    }
                    _ => {}
                }
            }
            if self.carried.len() == before {
                return Ok(equations);
            }
        }
    }

    /// How many variables differ in the arguments of a function.
    fn count(&self, own: &FunctionRef<'_>) -> usize {
        let all = own.function().expressions().iter().flat_map(|e| e.terms());
        let all = all.map(|(variable, _)| variable).chain(own.function().factor());
        all.filter(|variable| self.carried.contains_key(variable)).count()
    }

    /// Half the width of a function.
    fn function(
        &self,
        model: &mut Model,
        original: &Model,
        own: &FunctionRef<'_>,
    ) -> Result<Affine, Error> {
        let factor = own.function().factor();
        if factor.is_some_and(|factor| self.carried.contains_key(&factor)) {
            let help = "let its factor be a part of the plan, such as a mode";
            return Err(refused(own, "a product of two variables that differ between runs", help));
        }
        let widths = own.function().expressions().iter().map(|e| self.width(&e.terms()));
        let wide: Vec<Affine> = widths.filter(|w| !w.terms().is_empty()).collect();
        let Some(first) = wide.first() else { return Ok(Affine::zero()) };
        match own.function() {
            Function::Absolute(_) => Ok(first.clone()),
            Function::Product { factor, .. } => {
                let most = original.variable_ref(*factor)?.bounds().magnitude();
                Ok(most * first)
            }
            Function::Maximum(_) | Function::Minimum(_) => {
                let mut most = 0.0_f64;
                for width in &wide {
                    most = most.max(model.range(width)?.upper);
                }
                let name = own.name().suffixed("_tube");
                let half = model.continuous(name.clone(), 0.0, most)?;
                let words = format!("the tube of `{}`", own.name().family());
                for (k, width) in wide.iter().enumerate() {
                    let name = name.suffixed(&format!("_{k}"));
                    model.describe(name.family(), words.clone());
                    model.add(name, half.ge(width))?;
                }
                Ok(half.into())
            }
            other => {
                let help = "state it by rows, or about variables that do not differ";
                let what = match other.is_smooth() {
                    true => "a nonlinear function of states or inputs",
                    false => "a piecewise function of states or inputs",
                };
                Err(refused(own, what, help))
            }
        }
    }

    /// Finds continuous variables that equations define by variables that differ. Whether there is
    /// a new one.
    fn definitions(
        &mut self,
        model: &mut Model,
        original: &Model,
        equations: &mut BTreeSet<usize>,
    ) -> Result<bool, Error> {
        let before = equations.len();
        let results: BTreeSet<Variable> = original.functions().map(|own| own.result()).collect();
        for (position, row) in original.constraints().enumerate() {
            if self.tube.own.wrote(0, position)
                || row.limits().width() > 0.0
                || equations.contains(&position)
                || self.is_start(original, row.terms())?
            {
                continue;
            }
            let mut open = Vec::new();
            for &(variable, factor) in row.terms() {
                let is_continuous =
                    original.variable_ref(variable)?.kind() == VariableKind::Continuous;
                if is_continuous && !self.carried.contains_key(&variable) {
                    open.push((variable, factor));
                }
            }
            let width = self.width(row.terms());
            if let ([(variable, factor)], false) = (&open[..], width.terms().is_empty())
                && !results.contains(variable)
            {
                let width = (1.0 / factor.abs()) * width;
                self.carried.insert(*variable, Carried::Width(width));
                // The definition holds in every run; what is left is the variable's own range.
                let Interval { lower, upper } = original.variable_ref(*variable)?.bounds();
                let own = StoredRow { terms: vec![(*variable, 1.0)], lower, upper };
                self.linear(model, row.name(), BOUNDS, None, &own)?;
                equations.insert(position);
            }
        }
        Ok(equations.len() > before)
    }

    /// Whether an equation says where the plan starts: it is about states at the first sample, and
    /// about parameters.
    pub(super) fn is_start(
        &self,
        original: &Model,
        terms: &[(Variable, f64)],
    ) -> Result<bool, Error> {
        if self.tube.first > 0 {
            return Ok(false);
        }
        let mut starts = self.tube.own.states().iter().filter_map(|family| family.get(0));
        for (variable, _) in terms {
            let is_parameter = original.variable_ref(*variable)?.parameter_range().is_some();
            if !is_parameter && !starts.clone().any(|start| start == *variable) {
                return Ok(false);
            }
        }
        Ok(starts.any(|start| terms.iter().any(|(variable, _)| *variable == start)))
    }
}

fn refused(own: &FunctionRef<'_>, kind: &'static str, help: &'static str) -> Error {
    RobustError::Statement { statement: own.name().to_string(), kind, help }.into()
}
