//! Functions of a model as rows `function - variable = 0`.

use std::borrow::Cow;
use std::fmt::Write as _;

use super::operators::FUNCTIONS;
use crate::elementary::Elementary;
use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::Model;
use crate::model::affine::Affine;
use crate::model::function::Function;
use crate::model::ids::Variable;
use crate::model::text::lines::{FileLine, number};

/// A row for each function.
pub(super) fn function_lines(model: &Model) -> Result<Vec<FileLine<'_>>, Error> {
    let line = |function: crate::model::FunctionRef<'_>| {
        let is_known = match function.function() {
            Function::Piecewise { .. } => false,
            Function::Elementary { function: Elementary::Power(_), .. } => true,
            Function::Elementary { function, .. } => code(function).is_some(),
            _ => true,
        };
        match is_known {
            true => Ok(()),
            false => {
                let (format, what, name) = ("NL", "the function", function.name().to_string());
                Err(Error::from(ErrorKind::NotInFile { format, what, name }))
            }
        }
    };
    model.functions().try_for_each(line)?;
    Ok(model.function_rows())
}

impl Model {
    /// The rows `function - variable = 0`.
    fn function_rows(&self) -> Vec<FileLine<'_>> {
        let rows = self.stored.functions.iter().map(|data| FileLine {
            name: &self.stored.variables[data.result.index()].name,
            terms: Cow::Owned(vec![(data.result, -1.0)]),
            products: Vec::new(),
            limits: Interval::point(0.0),
            condition: None,
            function: Some(&data.function),
        });
        rows.collect()
    }
}

/// The number of a function in files.
fn code(function: &Elementary) -> Option<i64> {
    FUNCTIONS.iter().find(|(_, known)| known == function).map(|(code, _)| *code)
}

/// The variables on which a function depends.
pub(super) fn arguments(function: &Function) -> Vec<Variable> {
    let terms = function.expressions().iter().flat_map(Affine::terms).map(|(v, _)| v);
    terms.chain(function.factor()).collect()
}

/// The expression of a function.
pub(super) fn function(text: &mut String, own: &Function, column: &dyn Fn(Variable) -> usize) {
    match own {
        Function::Product { factor, of } => {
            put(text, format_args!("o2\nv{}\n", column(*factor)));
            affine(text, of, column);
        }
        Function::Bilinear([left, right]) => {
            text.push_str("o2\n");
            affine(text, left, column);
            affine(text, right, column);
        }
        Function::Quotient([left, right]) => {
            text.push_str("o3\n");
            affine(text, left, column);
            affine(text, right, column);
        }
        Function::Absolute(of) => {
            text.push_str("o15\n");
            affine(text, of, column);
        }
        Function::Maximum(of) | Function::Minimum(of) => {
            let code = if matches!(own, Function::Maximum(_)) { 12 } else { 11 };
            put(text, format_args!("o{code}\n{}\n", of.len()));
            of.iter().for_each(|of| affine(text, of, column));
        }
        Function::Elementary { function: Elementary::Power(p), of } if *p != 0.5 => {
            text.push_str("o5\n");
            affine(text, of, column);
            put(text, format_args!("n{}\n", number(*p)));
        }
        Function::Elementary { function, of } => {
            if let Some(code) = code(function) {
                put(text, format_args!("o{code}\n"));
            }
            affine(text, of, column);
        }
        // Refused before.
        Function::Piecewise { of, .. } => affine(text, of, column),
    }
}

/// The expression of a sum.
fn affine(text: &mut String, of: &Affine, column: &dyn Fn(Variable) -> usize) {
    let (terms, constant) = (of.terms(), of.offset());
    let has_constant = constant != 0.0 || terms.is_empty();
    match terms.len() + usize::from(has_constant) {
        1 => {}
        2 => text.push_str("o0\n"),
        count => put(text, format_args!("o54\n{count}\n")),
    }
    for (variable, factor) in terms {
        if factor != 1.0 {
            put(text, format_args!("o2\nn{}\n", number(factor)));
        }
        put(text, format_args!("v{}\n", column(variable)));
    }
    if has_constant {
        put(text, format_args!("n{}\n", number(constant)));
    }
}

fn put(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing into a string cannot fail.
    let _ = text.write_fmt(arguments);
}
