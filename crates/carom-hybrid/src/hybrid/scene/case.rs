//! Scenes as cases of a scene's program.

use super::program::SceneProgram;
use super::statement::Scene;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;

impl SceneProgram {
    /// Adds a case: another scene with the same bodies' inputs, such as one with another
    /// restitution or another place of a gate, from its own starts to its own goals and with its
    /// own rules. In the steps before `until` it has the inputs of the program's scene; from then
    /// on the cases can be told apart.
    ///
    /// A clone of a scene has its handles, which then stand for the scene that came first; those of
    /// the case are found by their names, in [`system`](crate::hybrid::HybridProgram::system) of
    /// the case.
    ///
    /// The objective stays as it is. [`in_case`](SceneProgram::in_case) gives the costs of a case,
    /// to be added with weights or limited by [`worst`](crate::hybrid::HybridProgram::worst). Plans
    /// have those of the cases in [`cases`](super::ScenePlan::cases).
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A gate that is high or low, which is seen after three steps.
    /// let yard = |gate: std::ops::RangeInclusive<f64>| {
    ///     let drone = Body::new("drone", [0.0..=4.0, 0.0..=2.0], 2.0, 3.0)
    ///         .with_start([0.4, 1.0, 0.0, 0.0])
    ///         .with_goal([3.0..=3.6, 0.8..=1.2, -1.0..=1.0, -1.0..=1.0]);
    ///     let below = [1.8..=2.0, -1.0..=*gate.start()];
    ///     let above = [1.8..=2.0, *gate.end()..=3.0];
    ///     Scene::new(0.25)
    ///         .with_body(drone)
    ///         .with_obstacle(Solid::cuboid("below", &below, Surface::avoid()))
    ///         .with_obstacle(Solid::cuboid("above", &above, Surface::avoid()))
    /// };
    /// let mut program = yard(0.1..=0.6).program(9)?;
    /// program.add_case("high", &yard(1.4..=1.9), 3)?;
    /// let costs = [program.effort()?, program.in_case("high", |case| case.effort())?];
    /// let [low, high] = costs;
    /// program.minimize(0.5 * low + 0.5 * high)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// let (low, high) = (&plan.bodies[0], &plan.cases["high"].bodies[0]);
    /// assert!((0..3).all(|t| (low.acceleration[t][1] - high.acceleration[t][1]).abs() < 1e-6));
    /// assert!(low.position[5][1] < high.position[5][1]);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`Scene::program`] for the case; [`ErrorKind::UnknownName`] if an input of the
    /// program's scene has no counterpart of the same name; [`ErrorKind::OutOfRange`] for steps
    /// beyond the horizon and another time step; [`ErrorKind::DuplicateName`]. The program then
    /// stays as it was.
    pub fn add_case(&mut self, name: &str, scene: &Scene, until: usize) -> Result<(), Error> {
        let mut stated = scene.stated()?;
        let tag = stated.system.handles.tag;
        if self.program.systems.iter().any(|own| own.system().handles.tag == tag) {
            stated.system.handles.renew();
        }
        stated.check_courses(self.steps())?;
        let user = stated.user_system()?;
        let case = self.program.write_case(
            name,
            &user,
            &stated.restated(),
            until,
            |program| {
                let mut case = stated.completed(program)?;
                if !case.tighten_by_sets(&stated)? {
                    case.contradict()?;
                }
                Ok(case)
            },
            SceneProgram::program_mut,
        )?;
        self.cases.push((name.to_owned(), case));
        Ok(())
    }
}
