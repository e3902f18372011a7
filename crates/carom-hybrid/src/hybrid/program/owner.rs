//! Programs of more than a system, which own its hybrid program.

/// Gives a type the statements of the [`HybridProgram`](super::HybridProgram) in its field
/// `program`, and access to that program for everything else.
macro_rules! owns_program {
    ($type:ty) => {
        impl $type {
            /// The hybrid program, for questions that this type has no method for.
            pub fn program(&self) -> &$crate::hybrid::HybridProgram {
                &self.program
            }

            /// The hybrid program, for statements that this type has no method for.
            pub fn program_mut(&mut self) -> &mut $crate::hybrid::HybridProgram {
                &mut self.program
            }

            /// The model.
            pub fn model(&self) -> &$crate::model::Model {
                self.program.model()
            }

            /// The model, for statements of your own.
            pub fn model_mut(&mut self) -> &mut $crate::model::Model {
                self.program.model_mut()
            }

            /// The number of steps, τ.
            pub fn steps(&self) -> usize {
                self.program.steps()
            }

            /// The system, as [`HybridProgram::system`](crate::hybrid::HybridProgram::system).
            pub fn system(&self) -> &$crate::hybrid::HybridSystem {
                self.program.system()
            }

            /// An expression at a sample, as
            /// [`HybridProgram::at`](crate::hybrid::HybridProgram::at).
            ///
            /// # Errors
            ///
            /// Those of [`HybridProgram::at`](crate::hybrid::HybridProgram::at).
            pub fn at<E: $crate::hybrid::AtSample>(
                &self,
                expression: E,
                sample: usize,
            ) -> Result<E::Output, $crate::error::Error> {
                self.program.at(expression, sample)
            }

            /// An expression at the last sample, as
            /// [`HybridProgram::end`](crate::hybrid::HybridProgram::end).
            ///
            /// # Errors
            ///
            /// Those of [`HybridProgram::end`](crate::hybrid::HybridProgram::end).
            pub fn end<E: $crate::hybrid::AtSample>(
                &self,
                expression: E,
            ) -> Result<E::Output, $crate::error::Error> {
                self.program.end(expression)
            }

            /// The sum of an expression over the steps, as
            /// [`HybridProgram::sum`](crate::hybrid::HybridProgram::sum).
            ///
            /// # Errors
            ///
            /// Those of [`HybridProgram::sum`](crate::hybrid::HybridProgram::sum).
            pub fn sum<E>(&self, expression: E) -> Result<E::Output, $crate::error::Error>
            where
                E: $crate::hybrid::AtSample,
                E::Output: std::iter::Sum,
            {
                self.program.sum(expression)
            }

            /// Requires rows at samples, as
            /// [`HybridProgram::require`](crate::hybrid::HybridProgram::require).
            ///
            /// # Errors
            ///
            /// Those of [`HybridProgram::require`](crate::hybrid::HybridProgram::require).
            pub fn require(
                &mut self,
                name: &str,
                region: impl $crate::hybrid::IntoRegion,
                when: $crate::hybrid::When,
            ) -> Result<(), $crate::error::Error> {
                self.program.require(name, region, when)
            }

            /// Requires a mission, as
            /// [`HybridProgram::require_mission`](crate::hybrid::HybridProgram::require_mission).
            ///
            /// # Errors
            ///
            /// Those of
            /// [`HybridProgram::require_mission`](crate::hybrid::HybridProgram::require_mission).
            pub fn require_mission(
                &mut self,
                name: &str,
                mission: &$crate::hybrid::Mission,
            ) -> Result<(), $crate::error::Error> {
                self.program.require_mission(name, mission)
            }

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

        impl AsRef<$crate::model::Model> for $type {
            fn as_ref(&self) -> &$crate::model::Model {
                self.program.model()
            }
        }

        impl AsMut<$crate::model::Model> for $type {
            fn as_mut(&mut self) -> &mut $crate::model::Model {
                self.program.model_mut()
            }
        }
    };
}

pub(crate) use owns_program;
