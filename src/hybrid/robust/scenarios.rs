//! Scenarios: several cases of a system in one program, whose inputs are the same until the cases can be told
//! apart.

use crate::error::{Error, ErrorKind};
use crate::hybrid::program::HybridProgram;
use crate::hybrid::system::HybridSystem;
use crate::model::{Affine, Variable};

impl HybridProgram {
    /// Adds a case: another system with the same inputs, such as one with another restitution, another push
    /// or another place of a gate. In the steps before `until` it has the inputs of the first system;
    /// from then on the cases can be told apart, and each has inputs of its own. Cases that are added with
    /// different `until` make a tree.
    ///
    /// Starts, goals and costs are stated for each case by the handles of its system. Costs are added with
    /// weights, or limited by [`worst`](HybridProgram::worst).
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A gate at 3 m or at 4 m, which is seen after two steps.
    /// let cart = |gate: f64| {
    ///     let mut cart = HybridSystem::new(1.0); // s
    ///     let x = cart.state("x", 0.0, 9.0)?;
    ///     let u = cart.input("u", -2.0, 2.0)?;
    ///     cart.mode("roll")?.next([x.is(x + u)])?;
    ///     Ok::<_, Error>((cart, x, u, gate))
    /// };
    /// let ((near, x, u, at_near), (far, y, w, at_far)) = (cart(3.0)?, cart(4.0)?);
    /// let mut program = near.program(3)?;
    /// program.add_case("far", &far, 2)?;
    /// program.start([x.equals(0.0), y.equals(0.0)])?;
    /// program.goal([x.equals(at_near), y.equals(at_far)])?;
    /// let costs = [program.sum_abs("near_way", u)?, program.sum_abs("far_way", w)?];
    /// let worst = program.worst("worst", costs)?;
    /// program.minimize(worst)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert!((plan.value(u, 1)? - plan.value(w, 1)?).abs() < 1e-6);
    /// assert!((plan.value(x, 3)? - 3.0).abs() < 1e-6 && (plan.value(y, 3)? - 4.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`join`](HybridProgram::join); [`ErrorKind::UnknownName`] if an input of the first system has
    /// no counterpart of the same name; [`ErrorKind::OutOfRange`] for steps beyond the horizon. The program
    /// then stays as it was.
    #[doc(alias("scenario tree", "multi-stage", "stochastic programming"))]
    pub fn add_case(
        &mut self,
        name: &str,
        system: &HybridSystem,
        until: usize,
    ) -> Result<(), Error> {
        if until > self.steps() {
            let what = format!("the number of steps that `{name}` shares");
            let range = format!("at most {}, the number of steps", self.steps());
            return Err(Error::out_of_range(what, until as f64, range));
        }
        let names = |of: &HybridSystem| -> Vec<String> {
            of.inputs.iter().map(|(name, _)| name.clone()).collect()
        };
        let (own, its) = (names(self.system()), names(system));
        if let Some(missing) = own.iter().chain(&its).find(|u| !own.contains(u) || !its.contains(u))
        {
            return Err(Error::unknown_name(missing, "input of all cases"));
        }
        let before = self.clone();
        let shared = self.join(name, system).and_then(|()| self.share(name, &own, until));
        if shared.is_err() {
            *self = before;
        }
        shared
    }

    fn share(&mut self, name: &str, inputs: &[String], until: usize) -> Result<(), Error> {
        let members = self.members.clone();
        let (Some(first), Some(last)) = (members.iter().next(), members.iter().last()) else {
            return Ok(());
        };
        for (k, input) in inputs.iter().enumerate() {
            let both: [&crate::model::Family; 2] = [first.input(input)?, last.input(input)?];
            let family = format!("{name}_shares_{k}");
            for step in 0..until {
                let pair: Vec<Variable> = both.iter().filter_map(|own| own.get(step)).collect();
                if let [own, its] = pair[..] {
                    self.add((family.as_str(), step), (its - own).equals(0.0))?;
                }
            }
        }
        Ok(())
    }

    /// The largest of several costs, as a new variable of the model that is at least each of them: to
    /// minimise it is to plan for the worst case.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`]; those of [`Model::add`](crate::model::Model::add);
    /// [`ErrorKind::EmptyRow`] without costs.
    pub fn worst<E: Into<Affine>>(
        &mut self,
        name: &str,
        costs: impl IntoIterator<Item = E>,
    ) -> Result<Affine, Error> {
        let costs: Vec<Affine> = costs.into_iter().map(E::into).collect();
        if costs.is_empty() {
            return Err(ErrorKind::EmptyRow { name: name.to_owned() }.into());
        }
        self.model.all_or_nothing(|model| {
            let mut range: Option<crate::interval::Interval> = None;
            for cost in &costs {
                let own = model.range(cost)?;
                range = Some(range.map_or(own, |all| all.hull(own)));
            }
            let range = range.unwrap_or(crate::interval::Interval::REALS);
            let worst = model.continuous(name, range.lower, range.upper)?;
            for (k, cost) in costs.into_iter().enumerate() {
                model.add(format!("{name}_{k}"), worst.ge(cost))?;
            }
            Ok(worst.into())
        })
    }
}
