//! Nonlinear expressions as text.

use super::{FunctionPart, Nonlinear};
use crate::model::affine::Affine;
use crate::model::ids::Variable;

impl Nonlinear {
    /// The expression with its variables named: `x cos(heading) + 2`.
    #[doc(hidden)]
    pub fn text(&self, name: &dyn Fn(Variable) -> String) -> String {
        let mut terms: Vec<(f64, String)> = Vec::new();
        for (factor, part) in &self.parts {
            terms.push((*factor, part.text(name)));
        }
        for (first, second, factor) in self.rest.products() {
            terms.push((factor, format!("{} {}", name(first), name(second))));
        }
        let affine = self.rest.affine();
        let mut text = String::new();
        for (factor, term) in terms {
            let sign = match (text.is_empty(), factor < 0.0) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            text += sign;
            if factor.abs() != 1.0 {
                text += &format!("{} ", factor.abs());
            }
            text += &term;
        }
        if text.is_empty() {
            return affine.text(name);
        }
        if *affine != Affine::zero() {
            text += &format!(" + {}", affine.text(name));
        }
        text
    }
}

impl FunctionPart {
    fn text(&self, name: &dyn Fn(Variable) -> String) -> String {
        match self {
            FunctionPart::Elementary(function, of) => function.text(&of.text(name)),
            FunctionPart::Product(a, b) => format!("({}) * ({})", a.text(name), b.text(name)),
            FunctionPart::Quotient(a, b) => format!("({}) / ({})", a.text(name), b.text(name)),
            FunctionPart::Absolute(of) => format!("|{}|", of.text(name)),
            FunctionPart::Maximum(a, b) => format!("max({}, {})", a.text(name), b.text(name)),
            FunctionPart::Piecewise(_, of) => format!("table({})", of.text(name)),
            FunctionPart::Dropped => "...".to_owned(),
        }
    }
}
