//! Programs of more than a system, which own its hybrid program and can do all that it can.

/// Lets a type be used as the [`HybridProgram`](super::HybridProgram) in its field `program`.
///
/// Statements have methods of their own, because one reached through `DerefMut` borrows the program
/// before its arguments can ask it for expressions.
macro_rules! owns_program {
    ($type:ty) => {
        impl $type {
            /// Adds a statement, as [`HybridProgram::add`](crate::hybrid::HybridProgram::add) does.
            ///
            /// # Errors
            ///
            /// Those of [`HybridProgram::add`](crate::hybrid::HybridProgram::add).
            pub fn add<S: $crate::model::Statement>(
                &mut self,
                name: impl Into<$crate::model::Name>,
                statement: S,
            ) -> Result<S::Handle, $crate::error::Error> {
                self.program.add(name, statement)
            }

            /// Sets the cost, as
            /// [`HybridProgram::minimize`](crate::hybrid::HybridProgram::minimize) does.
            ///
            /// # Errors
            ///
            /// Those of [`HybridProgram::minimize`](crate::hybrid::HybridProgram::minimize).
            pub fn minimize(
                &mut self,
                cost: impl Into<$crate::model::Quadratic>,
            ) -> Result<(), $crate::error::Error> {
                self.program.minimize(cost)
            }

            /// Sets the objective, as
            /// [`HybridProgram::maximize`](crate::hybrid::HybridProgram::maximize) does.
            ///
            /// # Errors
            ///
            /// Those of [`HybridProgram::maximize`](crate::hybrid::HybridProgram::maximize).
            pub fn maximize(
                &mut self,
                gain: impl Into<$crate::model::Quadratic>,
            ) -> Result<(), $crate::error::Error> {
                self.program.maximize(gain)
            }

            /// Hands a case over that [`add_case`](Self::add_case) has added, for statements and
            /// costs about it: within `state` it is a program of its own, with the variables and
            /// rules of the case, and what it adds to the model has a name that begins with that of
            /// the case.
            ///
            /// # Errors
            ///
            /// [`ErrorKind::UnknownName`](crate::error::ErrorKind::UnknownName); those of `state`.
            pub fn in_case<T>(
                &mut self,
                name: &str,
                state: impl FnOnce(&mut Self) -> Result<T, $crate::error::Error>,
            ) -> Result<T, $crate::error::Error> {
                let found = self.cases.iter().position(|(own, _)| own == name);
                let unknown = || $crate::error::Error::unknown_name(name, "case of the program");
                let k = found.ok_or_else(unknown)?;
                let (own, mut case) = self.cases.remove(k);
                self.program.lend_to(&mut case.program, name);
                let result = state(&mut case);
                self.program.take_back(&mut case.program);
                self.cases.insert(k, (own, case));
                result
            }
        }

        impl From<$type> for $crate::hybrid::HybridProgram {
            /// The program with its rules and cases, for controllers.
            fn from(program: $type) -> Self {
                program.program
            }
        }

        impl std::ops::Deref for $type {
            type Target = $crate::hybrid::HybridProgram;

            fn deref(&self) -> &Self::Target {
                &self.program
            }
        }

        impl std::ops::DerefMut for $type {
            fn deref_mut(&mut self) -> &mut Self::Target {
                &mut self.program
            }
        }

        impl std::borrow::Borrow<$crate::model::Model> for $type {
            fn borrow(&self) -> &$crate::model::Model {
                self.program.model()
            }
        }

        impl std::borrow::BorrowMut<$crate::model::Model> for $type {
            fn borrow_mut(&mut self) -> &mut $crate::model::Model {
                self.program.model_mut()
            }
        }
    };
}

pub(crate) use owns_program;
