//! The result of a run of the suite.

use std::fmt;

use super::capability::Capability;

/// The result of a case.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum CaseOutcome {
    /// Everything is as it must be.
    Passed,
    /// The faults, in words.
    Failed(Vec<String>),
    /// Left out, because the backend lacks this capability.
    Skipped(Capability),
}

/// The result of a run of the suite, case by case. Its text lists the failures.
#[derive(Debug, Clone)]
#[must_use]
pub struct Report {
    backend: String,
    cases: Vec<(String, CaseOutcome)>,
}

impl Report {
    pub(super) fn new(backend: &str) -> Self {
        Report { backend: backend.to_owned(), cases: Vec::new() }
    }

    pub(super) fn add(&mut self, name: &str, outcome: CaseOutcome) {
        self.cases.push((name.to_owned(), outcome));
    }

    /// The cases in the order in which they ran; programs run twice.
    pub fn cases(&self) -> impl ExactSizeIterator<Item = (&str, &CaseOutcome)> {
        self.cases.iter().map(|(name, outcome)| (&name[..], outcome))
    }

    /// The cases that failed, with what is wrong.
    pub fn failures(&self) -> impl Iterator<Item = (&str, &[String])> {
        self.cases().filter_map(|(name, outcome)| match outcome {
            CaseOutcome::Failed(complaints) => Some((name, &complaints[..])),
            _ => None,
        })
    }

    /// Whether no case failed and at least one was run.
    pub fn passed(&self) -> bool {
        let ran = self.cases.iter().any(|(_, outcome)| *outcome == CaseOutcome::Passed);
        ran && self.failures().next().is_none()
    }

    /// Asserts that the suite [passed](Self::passed).
    ///
    /// # Panics
    ///
    /// If a case failed or none was run, with this report as the message.
    #[track_caller]
    pub fn assert_passed(&self) {
        assert!(self.passed(), "{self}");
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count =
            |test: fn(&CaseOutcome) -> bool| self.cases.iter().filter(|(_, o)| test(o)).count();
        let passed = count(|outcome| *outcome == CaseOutcome::Passed);
        let failed = count(|outcome| matches!(outcome, CaseOutcome::Failed(_)));
        let skipped = count(|outcome| matches!(outcome, CaseOutcome::Skipped(_)));
        writeln!(f, "{}: {passed} passed, {failed} failed, {skipped} skipped", self.backend)?;
        for (name, complaints) in self.failures() {
            writeln!(f, "failed: {name}")?;
            for complaint in complaints {
                writeln!(f, "  {complaint}")?;
            }
        }
        let mut told: Vec<Capability> = Vec::new();
        for (_, outcome) in self.cases() {
            if let CaseOutcome::Skipped(capability) = *outcome
                && !told.contains(&capability)
            {
                told.push(capability);
                writeln!(f, "skipped: cases that need {capability}")?;
            }
        }
        Ok(())
    }
}
