//! Formulas as statements of a model.

use super::super::ids::LogicalConstraint;
use super::super::literal::Literal;
use super::super::name::Name;
use super::super::statement::{SealedStatement, Statement};
use super::super::store::Model;
use super::super::variable::VariableKind;
use super::{Formula, Logic, MAX_LOGIC_DEPTH};
use crate::error::{Error, ErrorKind};

impl Logic {
    /// Refuses a formula that the model cannot hold under this name.
    pub(in crate::model) fn check(&self, model: &Model, name: &Name) -> Result<(), Error> {
        if self.is_too_deep() {
            return Err(
                ErrorKind::TooDeep { name: name.to_string(), limit: MAX_LOGIC_DEPTH }.into()
            );
        }
        let variables = self.variables();
        if variables.is_empty() {
            return Err(ErrorKind::EmptyLogic { name: name.to_string() }.into());
        }
        for variable in variables {
            model.check_variable(variable, name)?;
            let variable = model.variable_ref(variable)?;
            if variable.kind() != VariableKind::Binary {
                let (name, place) = (variable.name().to_string(), name.to_string());
                return Err(ErrorKind::NotBinary { name, place }.into());
            }
        }
        Ok(())
    }
}

impl SealedStatement for Logic {}
impl Statement for Logic {
    type Handle = LogicalConstraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<LogicalConstraint, Error> {
        self.check(model, &name)?;
        if Formula::of(&self, true) == Formula::Constant(false) {
            return Err(ErrorKind::NeverTrue { name: name.to_string() }.into());
        }
        model.push_logical(name, self)
    }
}

impl SealedStatement for Literal {}
impl Statement for Literal {
    type Handle = LogicalConstraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<LogicalConstraint, Error> {
        Logic::from(self).add_to(model, name)
    }
}
