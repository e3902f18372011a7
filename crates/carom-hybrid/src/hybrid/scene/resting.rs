//! A contact that may come to rest: the time-stepping law of Moreau.
//!
//! A mirrored hit rebounds with the approach at the end of its step, which the acceleration of the
//! rest of the step has enlarged, and which it lifts by the depth once more. Bounces therefore
//! settle at a height instead of dying out. At a surface with rest, with the approach `f0` at the
//! start of the step and `f` at its end:
//!
//! * *hit*: `f0 >= 0`. The step ends at the surface, with the rebound `e f0`;
//! * *settle*: `f0 <= 0`. What brought the body here is the acceleration of this step alone, and a
//!   hop that is shorter than a step is none: the step ends at the surface, at rest across it;
//! * *rest*: the same from a start at rest at the surface. It is no hit.
//!
//! All of them need `g <= 0` and `f >= 0`: the net acceleration holds the body at the surface, and
//! it leaves in free flight as soon as that points away.

use faer::Mat;

use super::contact::ContactFace;
use super::entry::plus;
use super::geometry::minus;
use super::law::{Writer, at_start, norm_of};
use super::rebound::{Guard, Law, laws};
use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Halfspace, Transition};

/// A way to be in contact.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Hit,
    Settle,
    Rest,
}

impl Writer<'_> {
    /// The transitions of a face at which bodies may rest, and whether each is a hit.
    pub(super) fn resting(&self, face: usize, e: f64) -> Result<Vec<(Transition, bool)>, Error> {
        let own = &self.contact.faces[face];
        let mut all = Vec::new();
        for kind in [Kind::Hit, Kind::Settle, Kind::Rest] {
            let rebound = if kind == Kind::Hit { e } else { 0.0 };
            for mut law in laws(own, self.contact.mobility(), 0.0, rebound) {
                let word = match kind {
                    Kind::Hit => "",
                    Kind::Settle => "settle",
                    Kind::Rest => "rest",
                };
                law.name = match &law.name[..] {
                    name if word.is_empty() => name.to_owned(),
                    "hit" => word.to_owned(),
                    name => format!("{word}, {name}"),
                };
                all.push((self.stepped(face, kind, &law)?, kind != Kind::Rest));
            }
        }
        Ok(all)
    }

    fn stepped(&self, face: usize, kind: Kind, law: &Law) -> Result<Transition, Error> {
        let own = &self.contact.faces[face];
        let mut contact = self.hit(face, law);
        // What the step does depends on its start, so that its flow is its own and what was said of
        // the prediction is said of the start and the input.
        let predicted = std::mem::take(&mut contact.prediction_guards);
        contact.guards.extend(predicted.iter().map(|guard| self.before(guard)));
        let predicted = std::mem::take(&mut contact.prediction_norms);
        contact.norms.extend(predicted.iter().map(|norm| self.norm_before(norm)));
        let stepped = |guard: &Guard| {
            let (end, start) = (self.before(&self.guard(guard)), self.velocity(&guard.at_start));
            let limit = self.speed(&guard.at_start);
            plus(end, 1.0, &Halfspace::new("", start, limit))
        };
        contact = contact.with_guards(law.guards.iter().map(stepped));
        contact.norms.extend(norm_of(law.cone.iter().map(stepped)));
        contact = self.starting(contact, kind, own);
        for output in std::mem::take(&mut contact.outputs) {
            let (factors, constant) = self.through(&output.factors);
            let constant = output.constant.map(|own| own + constant);
            if kind != Kind::Rest {
                contact = contact.with_start_output(output.name, factors, constant);
            }
        }
        if kind == Kind::Rest {
            // Rules are about hits.
            contact.guards.retain(|guard| !guard.is_limit);
            contact.norms.retain(|norm| !norm.is_limit);
            contact.is_event = false;
        }
        let (matrix, offset) = self.reset(own, 0.0, law);
        contact.flow = self.own_flow(&matrix, law)?;
        let identity = Mat::<f64>::identity(self.flow.states(), self.flow.states());
        Ok(contact.with_reset_by_step(identity, offset))
    }

    /// The guards on the approach at the start.
    fn starting(&self, contact: Transition, kind: Kind, own: &ContactFace) -> Transition {
        let back = minus(&own.normal);
        let towards =
            |name: &str| Halfspace::new(name, self.velocity(&own.normal), self.speed(&own.normal));
        let away = |name: &str| Halfspace::new(name, self.velocity(&back), self.speed(&back));
        match kind {
            Kind::Hit => contact.with_guard(towards("starts towards it")),
            Kind::Settle => contact.with_guard(away("does not start towards it")),
            Kind::Rest => {
                let touches = Halfspace::new(
                    "starts at it",
                    self.position(&own.normal),
                    at_start(&own.limit),
                );
                contact
                    .with_guard(touches)
                    .with_guard(towards("starts at rest"))
                    .with_guard(away("starts at rest"))
            }
        }
    }

    /// The flow with the reset of a step, and with what the velocity at its start adds.
    fn own_flow(&self, reset: &Mat<f64>, law: &Law) -> Result<LinearSystem, Error> {
        let (a, b, c) = (self.flow.a(), self.flow.b(), self.flow.c());
        let (mut a, b) = (reset * a.faer(), reset * b.faer());
        let width = self.flow.states();
        let constant = (0..width).map(|i| (0..width).map(|j| reset[(i, j)] * c[j]).sum::<f64>());
        for (state, share, row) in self.taken(&law.at_start, &law.along[1]) {
            for (j, change) in self.velocity(row).iter().enumerate() {
                a[(state, j)] += share * change;
            }
        }
        LinearSystem::new(a, b, constant.collect::<Vec<_>>())
    }
}
