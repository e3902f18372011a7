//! Which parts of a mission are the reason why there is no plan.

use super::formula::{Mission, MissionNode};
use crate::error::{Error, ErrorKind};
use crate::hybrid::program::HybridProgram;
use crate::model::Affine;
use crate::solver::Solver;

/// The parts of a mission that all must hold: conjunctions are taken apart, also inside *always*.
fn conjuncts(mission: &Mission) -> Vec<Mission> {
    let each = |of: &[Mission]| of.iter().flat_map(conjuncts).collect();
    match &mission.node {
        MissionNode::And(of) => each(of),
        MissionNode::Always(window, of) => {
            conjuncts(of).into_iter().map(|part| part.always(*window)).collect()
        }
        MissionNode::Not(of) => match &of.node {
            MissionNode::Or(parts) => parts.iter().flat_map(|part| conjuncts(&!part)).collect(),
            MissionNode::Eventually(window, inner) => conjuncts(&(!&**inner).always(*window)),
            MissionNode::Not(inner) => conjuncts(inner),
            _ => vec![mission.clone()],
        },
        _ => vec![mission.clone()],
    }
}

impl HybridProgram {
    /// Which parts of a mission are the reason why the program has no plan that does what it says;
    /// `None` if there is one, or if the solver's limits leave that open. The program itself must
    /// not require the mission.
    ///
    /// The parts are missions themselves, and all are needed: without any of them there is a plan.
    /// Windows of *always* are as short as that allows. A part for which the run is too short is a
    /// reason by itself. Without a single part, the program has no plan even without the mission.
    ///
    /// ```
    /// use carom::hybrid::Mission;
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(0.5); // s
    /// let x = cart.state("x", -9.0, 9.0)?; // m
    /// let u = cart.input("u", -1.0, 1.0)?; // m/s
    /// cart.mode("roll")?.next([x.is(x + 0.5 * u)])?;
    /// let mut program = cart.program(10)?;
    /// program.start([x.equals(0.0)])?;
    /// let predicates = [
    ///     Mission::holds("in A", [x.ge(1.0)]),
    ///     Mission::holds("in B", [x.le(-1.0)]),
    ///     Mission::holds("in D", [x.ge(0.5)]),
    /// ];
    /// let mission = Mission::parse("F[0,3s] in A & F[0,5s] in B & G[0,5s] !in D", predicates)?;
    /// let solver = &mut BranchAndBound::default();
    /// let parts = program.mission_conflict(&mission, solver)?.expect("there is no plan");
    /// let words: Vec<String> = parts.iter().map(Mission::to_string).collect();
    /// assert_eq!(words, ["F[0,3s] in A", "G[1.5,2.5s] !in D"]);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`require_mission`](HybridProgram::require_mission) and of the solver.
    #[doc(alias("explain", "irreducible infeasible subset"))]
    pub fn mission_conflict(
        &self,
        mission: &Mission,
        solver: &mut dyn Solver,
    ) -> Result<Option<Vec<Mission>>, Error> {
        let mut parts = conjuncts(mission);
        if !self.refutes(&parts, true, solver)? {
            return Ok(None);
        }
        // From the last part to the first, so that those named first stay where there is a choice.
        for k in (0..parts.len()).rev() {
            let without = [&parts[..k], &parts[k + 1..]].concat();
            if self.refutes(&without, true, solver)? {
                parts = without;
            }
        }
        for k in 0..parts.len() {
            if let MissionNode::Always(window, of) = parts[k].node.clone() {
                let (first, last) = window.steps(self.system().time_step())?;
                let longest = last.unwrap_or(self.steps()).min(self.steps());
                let mut narrower = |first: usize, last: usize| {
                    let window = window.narrowed(self.system().time_step(), first, last);
                    let mut parts = parts.clone();
                    parts[k] = of.clone().always(window);
                    Ok::<_, Error>(self.refutes(&parts, false, solver)?.then_some(parts))
                };
                // The latest beginning, and then the earliest end, that still leave no plan.
                let (mut begin, mut known, mut found) = (longest + 1, first, None);
                while known + 1 < begin {
                    let middle = known + (begin - known) / 2;
                    match narrower(middle, longest)? {
                        Some(parts) => (known, found) = (middle, Some(parts)),
                        None => begin = middle,
                    }
                }
                let (first, mut end, mut open) = (known, longest, known);
                while open < end {
                    let middle = open + (end - open) / 2;
                    match narrower(first, middle)? {
                        Some(parts) => (end, found) = (middle, Some(parts)),
                        None => open = middle + 1,
                    }
                }
                parts = found.unwrap_or(parts);
            }
        }
        Ok(Some(parts))
    }

    /// Whether it is proved that no plan does what all of these say.
    ///
    /// # Arguments
    ///
    /// * `counts_late`: whether it is a proof, too, that the run ends before a window. It is none
    ///   for a window that has been moved.
    fn refutes(
        &self,
        parts: &[Mission],
        counts_late: bool,
        solver: &mut dyn Solver,
    ) -> Result<bool, Error> {
        let mut program = self.clone();
        program.minimize(Affine::zero())?;
        for (k, part) in parts.iter().enumerate() {
            let name = format!("part {} of the mission", k + 1);
            let stated = match counts_late {
                true => program.require_mission_if_in_time(&name, part),
                false => program.require_mission(&name, part),
            };
            match stated {
                Err(error) if !counts_late && is_late(&error) => return Ok(false),
                other => other?,
            }
        }
        Ok(solver.solve(program.model())?.is_infeasible())
    }
}

fn is_late(error: &Error) -> bool {
    matches!(error.kind(), ErrorKind::OutOfRange { .. })
}
