//! Scenarios: several cases of a system in one program, whose inputs are the same until the cases
//! can be told apart.

use std::sync::Arc;

use crate::error::{Error, ErrorKind};
use crate::hybrid::horizon::Horizon;
use crate::hybrid::program::HybridProgram;
use crate::hybrid::system::{HybridSystem, Restated};
use crate::model::{Affine, Family, Model, Variable};

impl HybridProgram {
    /// Adds a case: another system with the same inputs, such as one with another restitution,
    /// another push or another place of a gate. In the steps before `until` it has the inputs of
    /// the first system; from then on the cases can be told apart, and each has inputs of its own.
    /// Cases that are added with different `until` make a tree.
    ///
    /// Starts, goals and costs are stated for each case by the handles of its system. Costs are
    /// added with weights, or limited by [`worst`](HybridProgram::worst).
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
    /// Those of [`join`](HybridProgram::join); [`ErrorKind::UnknownName`] if an input of the first
    /// system has no counterpart of the same name; [`ErrorKind::OutOfRange`] for steps beyond the
    /// horizon. The program then stays as it was.
    #[doc(alias("scenario tree", "multi-stage", "stochastic programming"))]
    pub fn add_case(
        &mut self,
        name: &str,
        system: &HybridSystem,
        until: usize,
    ) -> Result<(), Error> {
        let before = self.clone();
        let added = self.check_case(name, system, until).and_then(|inputs| {
            self.join(name, system)?;
            self.share(["", name], &inputs, until)
        });
        match added {
            Ok(()) => Arc::make_mut(&mut self.systems).cases.insert(name.to_owned(), until),
            Err(error) => {
                *self = before;
                return Err(error);
            }
        };
        Ok(())
    }

    /// Lets two cases have the same inputs in the steps before `until`, where neither is the first
    /// system: so that cases which part from the first one together can be told apart later.
    ///
    /// # Arguments
    ///
    /// * `cases`: their names.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`]; [`ErrorKind::OutOfRange`] for steps beyond the horizon;
    /// [`ErrorKind::DuplicateName`] at the second call for the same cases. The program then stays
    /// as it was.
    pub fn share_inputs(&mut self, cases: [&str; 2], until: usize) -> Result<(), Error> {
        for name in cases {
            if !self.systems.cases.contains_key(name) {
                return Err(Error::unknown_name(name, "case of the program"));
            }
        }
        self.check_until(&format!("`{}` and `{}` share", cases[0], cases[1]), until)?;
        let inputs = input_names(self.system());
        self.share(cases, &inputs, until)
    }

    fn check_until(&self, who: &str, until: usize) -> Result<(), Error> {
        if until > self.steps() {
            let what = format!("the number of steps that {who}");
            let (until, steps) = (until as f64, self.steps() as f64);
            let more = ", the number of steps";
            return Err(Error::out_of_range_with(what, until, ..=steps, more));
        }
        Ok(())
    }

    /// Refuses a case that cannot be added. Returns the names of the inputs that it shares.
    fn check_case(
        &self,
        name: &str,
        system: &HybridSystem,
        until: usize,
    ) -> Result<Vec<String>, Error> {
        self.check_until(&format!("`{name}` shares"), until)?;
        let (own, its) = (input_names(self.system()), input_names(system));
        if let Some(missing) = own.iter().chain(&its).find(|u| !own.contains(u) || !its.contains(u))
        {
            return Err(Error::unknown_name(missing, "input of all cases"));
        }
        self.systems.check_new(name, system)?;
        Ok(own)
    }

    /// Adds a case whose owner, such as a scene, writes it: into a program in which the case's
    /// system stands first, and where names begin with that of the case. An error leaves the
    /// program as it was.
    ///
    /// # Returns
    ///
    /// The owner, without the model.
    pub(crate) fn write_case<P>(
        &mut self,
        name: &str,
        system: &HybridSystem,
        restated: &Restated,
        until: usize,
        write: impl FnOnce(HybridProgram) -> Result<P, Error>,
        program_of: impl FnOnce(&mut P) -> &mut HybridProgram,
    ) -> Result<P, Error> {
        let inputs = self.check_case(name, system, until)?;
        let mut whole = self.clone();
        whole.model.set_scope(name);
        let horizon = Horizon::new(self.steps(), system.time_step)?;
        let model = &mut whole.model;
        let variables = system.write_restated(restated, model, "", &horizon, None)?;
        let systems = Arc::make_mut(&mut whole.systems);
        systems.push(name, variables);
        systems.cases.insert(name.to_owned(), until);
        systems.put_first(name);
        let mut case = write(whole)?;
        let mut whole = self.without_model();
        whole.take_back(program_of(&mut case));
        whole.share(["", name], &inputs, until)?;
        *self = whole;
        Ok(case)
    }

    fn without_model(&self) -> Self {
        HybridProgram { model: Model::new("case"), systems: self.systems.clone() }
    }

    /// Hands the model over to a case, whose system stands first in it.
    pub(crate) fn lend_to(&mut self, case: &mut HybridProgram, name: &str) {
        std::mem::swap(&mut self.model, &mut case.model);
        case.model.set_scope(name);
        case.systems = self.systems.clone();
        Arc::make_mut(&mut case.systems).put_first(name);
    }

    /// Takes the model back from a case.
    pub(crate) fn take_back(&mut self, case: &mut HybridProgram) {
        std::mem::swap(&mut self.model, &mut case.model);
        self.model.set_scope("");
        self.systems = case.systems.clone();
        Arc::make_mut(&mut self.systems).put_first("");
    }

    /// Adds the rows by which two systems share their inputs.
    fn share(
        &mut self,
        [first, second]: [&str; 2],
        inputs: &[String],
        until: usize,
    ) -> Result<(), Error> {
        let systems = self.systems.clone();
        let of = |name: &str| systems.named().find(|(own, _)| *own == name).map(|(_, own)| own);
        let (Some(own), Some(its)) = (of(first), of(second)) else { return Ok(()) };
        let prefix = if first.is_empty() { second.to_owned() } else { format!("{first}_{second}") };
        self.model.all_or_nothing(|model| {
            for (k, input) in inputs.iter().enumerate() {
                let both: [&Family; 2] = [own.input(input)?, its.input(input)?];
                let family = format!("{prefix}_shares_{k}");
                let measures = [own, its].map(|of| of.input_measure(input));
                let scale = measures[0].scale;
                for step in 0..until {
                    let pair: Vec<Variable> = both.iter().filter_map(|own| own.get(step)).collect();
                    let [first, second] = pair[..] else { continue };
                    let row = match measures[0] == measures[1] {
                        true => (second - first).equals(0.0),
                        false => {
                            let second = its.in_units(measures[1], second);
                            let apart = second - own.in_units(measures[0], first);
                            ((1.0 / scale) * apart).equals(0.0)
                        }
                    };
                    model.add((family.as_str(), step), row)?;
                }
            }
            Ok(())
        })
    }

    /// The largest of several costs, as a new variable of the model that is at least each of them:
    /// to minimise it is to plan for the worst case.
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

fn input_names(system: &HybridSystem) -> Vec<String> {
    system.inputs.iter().map(|(name, _)| name.clone()).collect()
}
