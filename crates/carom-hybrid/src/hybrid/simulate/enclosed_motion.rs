//! The motion between samples, enclosed: intervals that hold the solution of the differential
//! equations, proved with outward rounding.
//!
//! `zonotope.rs` follows the equations; here is what is said of a run.

use super::motion::ContinuousMotion;
use super::plan::PlannedRun;
use super::zonotope::Zonotope;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::HybridSystem;
use crate::interval::Interval;

impl HybridSystem {
    /// Encloses the motion of a run's inputs and transitions by the differential equations, from
    /// the run's first sample: at every sample it is within a radius that is proved by interval
    /// arithmetic, so that the [errors](ContinuousMotion::errors) bound by how much the
    /// [discretization](HybridSystem::discretization) is off.
    ///
    /// The claim is about the differential equations as they are stated, with inputs held over
    /// each step and the transitions of the run at its samples. It assumes that functions of the
    /// standard library err by less than four units in the last place.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut pendulum = HybridSystem::new(0.05); // s
    /// let angle = pendulum.state("angle", -4.0, 4.0)?; // rad
    /// let rate = pendulum.state("rate", -9.0, 9.0)?; // rad/s
    /// let torque = pendulum.input("torque", -5.0, 5.0)?; // 1/s²
    /// pendulum.mode("swing")?.rates([angle.is(rate), rate.is(torque - 9.81 * angle.sin())])?;
    /// let run = pendulum.simulate(&[0.5, 0.0], &vec![[2.0]; 20])?.to_run();
    /// let motion = pendulum.enclose_motion(&run)?;
    /// assert!(motion.radii[20][0] < 1e-8); // rad
    /// // So much is proved of the midpoint rule in this run.
    /// assert!(motion.errors[0] < 0.01); // rad
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`motion`](HybridSystem::motion); [`ErrorKind::NotFinite`] if no box is found that
    /// the motion keeps to, because it may leave the range in which rates have values or because
    /// the step is too long.
    pub fn enclose_motion(&self, run: &HybridRun) -> Result<ContinuousMotion, Error> {
        self.check()?;
        let plan = PlannedRun::new(self, run)?;
        let mut own = Zonotope::point(&plan.states[0]);
        let n = own.centre.len();
        let first = plan.states[0].clone();
        let mut found = ContinuousMotion {
            samples: vec![first.clone()],
            radii: vec![vec![0.0; n]],
            path: vec![(0.0, first)],
            errors: vec![0.0; n],
        };
        for (step, input) in plan.inputs.iter().enumerate() {
            let taken = plan.transitions(step);
            own.follow(self.flow_together(&taken)?, self, input)?;
            own.reset(&taken, step);
            let radius = own.radius();
            let each = own.centre.iter().zip(&plan.states[step + 1]).zip(&radius);
            for (error, ((centre, sample), radius)) in found.errors.iter_mut().zip(each) {
                let off = Interval::point(*centre) + Interval::point(-sample);
                let most = Interval::point(off.magnitude()) + Interval::point(*radius);
                *error = error.max(most.upper);
            }
            let time = (step + 1) as f64 * self.time_step;
            found.path.push((time, own.centre.clone()));
            found.samples.push(own.centre.clone());
            found.radii.push(radius);
        }
        Ok(found)
    }
}
