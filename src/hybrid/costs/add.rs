//! Costs as expressions of a program.

use faer::Mat;

use super::cost::{Cost, Norm};
use crate::error::Error;
use crate::hybrid::rows::HybridProgram;
use crate::hybrid::system::Schedule;
use crate::model::{Affine, Family, Model, Name, Quadratic};

impl HybridProgram {
    /// The cost of the program's run, for [`Model::minimize`] or for a sum with other costs.
    ///
    /// A 1-norm or infinity-norm adds variables to the model, `name_x[t]`, `name_u[t]` and
    /// `name_end[t]`, each with the cost of one deviation. They are [functions](Model::absolute),
    /// so they have the right value wherever they are used, and need no binaries where they are
    /// minimised.
    ///
    /// # Arguments
    ///
    /// * `name`: of the added variables; different for each cost of a model.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`], [`ErrorKind::Length`] and [`ErrorKind::NotFinite`] if the cost does not
    /// fit the system, [`ErrorKind::UnknownName`] for its transitions, [`ErrorKind::DuplicateName`]
    /// if a name is taken. The model then stays as it was.
    ///
    /// [`ErrorKind::Shape`]: crate::ErrorKind::Shape
    /// [`ErrorKind::Length`]: crate::ErrorKind::Length
    /// [`ErrorKind::NotFinite`]: crate::ErrorKind::NotFinite
    /// [`ErrorKind::UnknownName`]: crate::ErrorKind::UnknownName
    /// [`ErrorKind::DuplicateName`]: crate::ErrorKind::DuplicateName
    pub fn add_cost(&self, model: &mut Model, name: &str, cost: &Cost) -> Result<Quadratic, Error> {
        cost.check(self.system())?;
        let sum = model.all_or_nothing(|model| self.cost(model, name, cost))?;
        let references = [&cost.state_reference, &cost.input_reference];
        if references.into_iter().flatten().any(Schedule::varies) {
            model.note_by_step(format!("the reference of the cost `{name}`"));
        }
        Ok(sum)
    }

    fn cost(&self, model: &mut Model, name: &str, cost: &Cost) -> Result<Quadratic, Error> {
        let steps = self.horizon().steps();
        let (states, inputs) = (&cost.state_reference, &cost.input_reference);
        let mut sum = Quadratic::zero();
        for t in 0..steps {
            let state = deviation(self.states(), states, t);
            let place = (format!("{name}_x"), t);
            sum += measured(model, place, cost.norm, &cost.states, &state)?;
            let input = deviation(self.inputs(), inputs, t);
            let place = (format!("{name}_u"), t);
            sum += measured(model, place, cost.norm, &cost.inputs, &input)?;
            for (choice, transition, price) in &cost.transitions {
                let taken = match self.taken(choice, transition, t)? {
                    None => Affine::constant(1.0),
                    Some(literal) if literal.is_on() => literal.variable().into(),
                    Some(literal) => 1.0 - literal.variable(),
                };
                sum += *price * taken;
            }
        }
        if let Some(terminal) = &cost.terminal {
            let end = deviation(self.states(), states, steps);
            let place = (format!("{name}_end"), steps);
            sum += measured(model, place, cost.norm, terminal, &end)?;
        }
        Ok(sum)
    }
}

/// The members at a step minus their references.
fn deviation(of: &[Family], reference: &Option<Schedule<Vec<f64>>>, step: usize) -> Vec<Affine> {
    let reference = reference.as_ref().and_then(|reference| reference.get(step));
    let entry = |k: usize| reference.and_then(|values| values.get(k)).copied().unwrap_or(0.0);
    let member = |(k, family): (usize, &Family)| {
        family.get(step).map_or(Affine::zero(), Affine::from) - entry(k)
    };
    of.iter().enumerate().map(member).collect()
}

/// The cost of a deviation.
fn measured(
    model: &mut Model,
    (name, step): (String, usize),
    norm: Norm,
    weight: &Mat<f64>,
    deviation: &[Affine],
) -> Result<Quadratic, Error> {
    if norm == Norm::Squares {
        let products = deviation.iter().enumerate().flat_map(|(i, left)| {
            let row = deviation.iter().enumerate().map(move |(j, right)| (i, j, left, right));
            row.filter(|&(i, j, ..)| weight[(i, j)] != 0.0)
        });
        return Ok(products.map(|(i, j, left, right)| weight[(i, j)] * (left * right)).sum());
    }
    let row = |i: usize| -> Affine {
        let terms = deviation.iter().enumerate().filter(|&(j, _)| weight[(i, j)] != 0.0);
        terms.map(|(j, entry)| weight[(i, j)] * entry).sum()
    };
    let rows: Vec<Affine> =
        (0..weight.nrows()).map(row).filter(|row| !row.terms().is_empty()).collect();
    let sum = match (norm, &rows[..]) {
        (_, []) => Affine::zero(),
        (_, [row]) => model.absolute(Name::from((name, step)), row)?.into(),
        (Norm::Largest, rows) => {
            let sides = rows.iter().flat_map(|row| [row.clone(), -row]);
            model.maximum((name, step), sides)?.into()
        }
        (_, rows) => {
            let named = rows.iter().enumerate();
            let magnitudes =
                named.map(|(i, row)| model.absolute((format!("{name}{i}"), step), row));
            magnitudes.map(|variable| variable.map(Affine::from)).sum::<Result<Affine, Error>>()?
        }
    };
    Ok(sum.into())
}
