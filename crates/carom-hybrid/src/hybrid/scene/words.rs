//! Names of the states, inputs and contacts of a scene in explanations.

use super::axes::AXES;
use super::contact::ContactPair;
use super::system::Stated;
use crate::hybrid::reach::Words;

impl Stated {
    pub(super) fn words(&self) -> Words {
        let axes = &AXES[..self.scene.axes()];
        let mut quantities = Vec::new();
        for body in self.scene.bodies.iter().map(|body| &body.name) {
            for axis in axes {
                let along = if axes.len() == 1 { String::new() } else { format!(" along {axis}") };
                quantities.push((format!("{body} {axis}"), format!("{axis} of {body}"), "m"));
                let speed = format!("the velocity of {body}{along}");
                quantities.push((format!("{body} v{axis}"), speed, "m/s"));
                let push = format!("the acceleration of {body}{along}");
                quantities.push((format!("{body} a{axis}"), push, "m/s²"));
            }
        }
        for body in self.scene.spins().map(|(b, _)| &self.scene.bodies[b].name) {
            quantities.push((format!("{body} spin"), format!("the spin of {body}"), "rad/s"));
            quantities.push((format!("{body} torque"), format!("the torque on {body}"), "N m"));
        }
        for body in self.scene.headings().map(|(b, _)| &self.scene.bodies[b].name) {
            quantities.push((format!("{body} heading"), format!("the heading of {body}"), "rad"));
        }
        let transitions = self.contacts.iter().flat_map(|contact| self.undone(contact)).collect();
        Words { quantities, transitions, event: Some("hit") }
    }

    /// The sentence that says what cannot be done where a contact's transitions are impossible.
    fn undone(&self, contact: &ContactPair) -> Vec<(String, String, Option<&'static str>)> {
        let body = &self.scene.bodies[contact.body].name;
        let other = match (contact.obstacle, contact.other) {
            (Some(o), _) => &self.scene.obstacles[o].name,
            (None, Some(b)) => &self.scene.bodies[b].name,
            (None, None) => return Vec::new(),
        };
        let modes = contact.modes.iter().map(|mode| {
            let (words, unit) = match mode.is_hit {
                true => (format!("{body} cannot hit {other}"), None),
                false => (format!("{body} cannot keep clear of {other}"), Some("m")),
            };
            (format!("{} of {}", mode.name, contact.name), words, unit)
        });
        modes.collect()
    }
}
