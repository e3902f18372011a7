//! Conic rows that hold under a condition.

use super::conic_row::ConicRow;
use crate::error::{Error, ErrorKind};
use crate::model::ids::ConicConstraint;
use crate::model::indicator::{Implication, Implications, one_of_several};
use crate::model::name::Name;
use crate::model::reformulation::BigM;
use crate::model::statement::{SealedStatement, Statement};
use crate::model::store::Model;

impl SealedStatement for Implication<ConicRow> {}
impl Statement for Implication<ConicRow> {
    type Handle = ConicConstraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<ConicConstraint, Error> {
        let conic = self.row.checked(model, &name)?;
        model.push_conic(name, Some(self.condition), conic, self.big_m)
    }
}

impl SealedStatement for Implications<ConicRow> {}
impl Statement for Implications<ConicRow> {
    type Handle = Vec<ConicConstraint>;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Vec<ConicConstraint>, Error> {
        if self.rows.is_empty() {
            return Err(ErrorKind::EmptyRow { name: name.to_string() }.into());
        }
        model.all_or_nothing(|model| {
            let rows = self.rows.into_iter().enumerate();
            rows.map(|(k, row)| {
                let name = one_of_several(&name, k);
                let conic = row.checked(model, &name)?;
                model.push_conic(name, Some(self.condition.clone()), conic, BigM::Automatic)
            })
            .collect()
        })
    }
}
