//! Several additions to a model that are made together, or not at all.

use super::store::Model;
use crate::error::Error;

impl Model {
    /// Makes several additions, or none if one of them fails.
    #[doc(hidden)]
    pub fn all_or_nothing<T>(
        &mut self,
        add: impl FnOnce(&mut Model) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let stored = &self.stored;
        let (variables, rows) = (stored.variables.len(), stored.constraints.len());
        let (indicators, logic) = (stored.indicators.len(), stored.logic.len());
        let conic = stored.conic.len();
        let (disjunctions, sets) = (stored.disjunctions.len(), stored.sets.len());
        let functions = stored.functions.len();
        let result = add(self);
        if result.is_err() {
            let Model { stored, variable_names, statement_names, parts, .. } = self;
            parts.retain(|_, part| part.index() < variables);
            stored.functions.truncate(functions);
            for data in stored.variables.drain(variables..) {
                variable_names.remove(&data.name);
            }
            let rows = stored.constraints.drain(rows..).map(|data| data.name);
            let indicators = stored.indicators.drain(indicators..).map(|data| data.name);
            let logic = stored.logic.drain(logic..).map(|data| data.name);
            let disjunctions = stored.disjunctions.drain(disjunctions..).map(|data| data.name);
            let sets = stored.sets.drain(sets..).map(|data| data.name);
            let conic = stored.conic.drain(conic..).map(|data| data.name);
            let rows = rows.chain(conic);
            for name in rows.chain(indicators).chain(logic).chain(disjunctions).chain(sets) {
                statement_names.remove(&name);
            }
        }
        result
    }
}
