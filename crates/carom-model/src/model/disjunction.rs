//! Disjunctions: "these rows, or those, or those", as first-class statements of a model.
//!
//! *Exactly one* term of a disjunction is selected, by a binary per term, and the rows of the
//! selected term hold (those of other terms may hold as well). A [`Method`], for the whole model or
//! for one disjunction, decides how it becomes rows. Solutions are checked term by term, not
//! through these rows.

use super::conic::ConicRow;
use super::ids::Disjunction;
use super::literal::Literal;
use super::name::Name;
use super::nonlinear::NonlinearRow;
use super::reformulation::Method;
use super::refs::DisjunctionRef;
use super::row::Row;
use super::statement::{SealedStatement, Statement, stored};
use super::store::Model;
use super::stored::StoredTerm;
use super::variable::VariableKind;
use crate::error::{Error, ErrorKind};

/// The largest depth of disjunctions inside terms.
pub(super) const MAX_NESTING: u32 = 16;

/// One alternative of an [`Either`]: rows, conic rows and nested disjunctions that must hold
/// together if it is selected.
///
/// Made from a [`Row`], a [`ConicRow`], a [`NonlinearRow`], an array or a vector of one of them, or
/// a nested [`Either`]; add more of all with [`and`](Term::and) and
/// [`and_either`](Term::and_either). A term without rows is always true.
#[derive(Debug, Clone, PartialEq, Default)]
#[must_use = "a term does nothing until its disjunction is given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Term {
    rows: Vec<Row>,
    #[cfg_attr(feature = "serde", serde(default))]
    conic: Vec<ConicRow>,
    #[cfg_attr(feature = "serde", serde(default))]
    nonlinear: Vec<NonlinearRow>,
    nested: Vec<Either>,
}

impl Term {
    /// Adds a row, a conic row, several of them, or another term's.
    pub fn and(mut self, rows: impl Into<Term>) -> Self {
        let mut rows = rows.into();
        self.rows.append(&mut rows.rows);
        self.conic.append(&mut rows.conic);
        self.nonlinear.append(&mut rows.nonlinear);
        self.nested.append(&mut rows.nested);
        self
    }

    /// Adds a disjunction that must hold if this term is selected. If it is not, all selectors of
    /// the disjunction are off.
    pub fn and_either(mut self, inner: Either) -> Self {
        self.nested.push(inner);
        self
    }

    fn depth(&self) -> u32 {
        self.nested.iter().map(|inner| inner.depth).max().unwrap_or(0)
    }
}

impl From<Row> for Term {
    fn from(row: Row) -> Self {
        Term { rows: vec![row], ..Term::default() }
    }
}

impl From<Vec<Row>> for Term {
    fn from(rows: Vec<Row>) -> Self {
        Term { rows, ..Term::default() }
    }
}

impl From<ConicRow> for Term {
    fn from(row: ConicRow) -> Self {
        Term { conic: vec![row], ..Term::default() }
    }
}

impl From<Vec<ConicRow>> for Term {
    fn from(conic: Vec<ConicRow>) -> Self {
        Term { conic, ..Term::default() }
    }
}

impl From<NonlinearRow> for Term {
    fn from(row: NonlinearRow) -> Self {
        Term { nonlinear: vec![row], ..Term::default() }
    }
}

impl From<Vec<NonlinearRow>> for Term {
    fn from(nonlinear: Vec<NonlinearRow>) -> Self {
        Term { nonlinear, ..Term::default() }
    }
}

impl<const N: usize> From<[NonlinearRow; N]> for Term {
    fn from(rows: [NonlinearRow; N]) -> Self {
        Term::from(Vec::from(rows))
    }
}

impl<const N: usize> From<[ConicRow; N]> for Term {
    fn from(rows: [ConicRow; N]) -> Self {
        Term::from(Vec::from(rows))
    }
}

impl<const N: usize> From<[Row; N]> for Term {
    fn from(rows: [Row; N]) -> Self {
        Term::from(Vec::from(rows))
    }
}

impl From<Either> for Term {
    fn from(inner: Either) -> Self {
        Term { nested: vec![inner], ..Term::default() }
    }
}

/// A disjunction of terms, not yet added to a model; made by [`either`] and [`Either::of`].
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a disjunction does nothing until it is given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Either {
    terms: Vec<Term>,
    selectors: Option<Vec<Literal>>,
    method: Option<Method>,
    depth: u32,
}

/// Starts a disjunction with its first term; add others with [`Either::or`].
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("doors");
/// let x = model.continuous("x", 0.0, 10.0)?;
/// let y = model.continuous("y", 0.0, 10.0)?;
/// let door = model.add(
///     "door",
///     either([x.le(2.0), y.ge(7.0)]).or(x.ge(6.0)).or([x.within(3.0, 4.0), y.le(1.5)]),
/// )?;
/// model.minimize((x - 4.0).square() + (y - 3.0).square())?;
/// let solution = BranchAndBound::default().solve(&model)?;
/// assert!((solution.value(y)? - 1.5).abs() < 1e-6);
/// let point = solution.point().expect("there is a way");
/// assert_eq!(point.selected(&door)?, Some(2));
/// # Ok::<(), carom::Error>(())
/// ```
pub fn either(first: impl Into<Term>) -> Either {
    Either::of([first])
}

impl Either {
    /// The disjunction of any number of terms.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("gates");
    /// let x = model.continuous("x", 0.0, 10.0)?;
    /// let gates = [(0.0, 1.0), (4.0, 5.0), (9.0, 10.0)];
    /// model.add("gate", Either::of(gates.map(|(low, high)| x.within(low, high))))?;
    /// model.minimize((x - 6.0).square())?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.value(x)? - 5.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn of<T: Into<Term>>(terms: impl IntoIterator<Item = T>) -> Either {
        let none = Either { terms: Vec::new(), selectors: None, method: None, depth: 1 };
        terms.into_iter().fold(none, Either::or)
    }

    /// Adds a term.
    pub fn or(mut self, term: impl Into<Term>) -> Self {
        let mut term = term.into();
        if term.depth() > MAX_NESTING {
            // Terms that are nested too deep are dropped, so that no later code walks them. The
            // recorded depth stays, and adding the disjunction is refused.
            term.nested.clear();
            self.depth = MAX_NESTING + 2;
        }
        self.depth = self.depth.max(term.depth() + 1);
        self.terms.push(term);
        self
    }

    /// Selects the terms by these conditions, in order, instead of new binaries. Exactly one of
    /// them is true. Two terms can share one binary: `[z.on(), z.off()]`. In a nested disjunction,
    /// exactly one is true if the term around it is selected, and none otherwise, so
    /// `[z.on(), z.off()]` would force that term.
    pub fn selected_by(mut self, selectors: impl IntoIterator<Item = Literal>) -> Self {
        self.selectors = Some(selectors.into_iter().collect());
        self
    }

    /// Lowers this disjunction by this method instead of the one in the model's
    /// [`Reformulation`](super::Reformulation). This has no effect on a nested disjunction: the
    /// outermost one decides.
    pub fn by(mut self, method: Method) -> Self {
        self.method = Some(method);
        self
    }
}

/// A disjunction in a model.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Selected {
    /// The handle.
    pub disjunction: Disjunction,
    /// The condition that selects each term, in the order of the terms.
    pub selectors: Vec<Literal>,
}

impl SealedStatement for Either {}
impl Statement for Either {
    type Handle = Selected;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Selected, Error> {
        if self.depth > MAX_NESTING {
            return Err(Error::out_of_range_with(
                format!("the number of levels of `{name}`"),
                f64::from(self.depth),
                ..=f64::from(MAX_NESTING),
                "; give inner disjunctions statements of their own",
            ));
        }
        let method = self.method;
        model.all_or_nothing(|model| {
            let terms = store(self, model, &name, false)?;
            let selectors = terms.iter().map(|term| term.selector).collect();
            let disjunction = model.push_disjunction(name, method, terms)?;
            Ok(Selected { disjunction, selectors })
        })
    }
}

/// Checks the terms of a disjunction and gives those without a selector one.
fn store(
    of: Either,
    model: &mut Model,
    name: &Name,
    inner: bool,
) -> Result<Vec<StoredTerm>, Error> {
    let count = of.terms.len();
    if count == 0 {
        return Err(Error::out_of_range(format!("the number of terms of `{name}`"), 0.0, 1.0..));
    }
    let selectors = match of.selectors {
        Some(given) if given.len() != count => {
            let (what, terms) = (format!("the number of selectors of `{name}`"), count as f64);
            let (given, more) = (given.len() as f64, ", one for each term");
            return Err(Error::out_of_range_with(what, given, terms..=terms, more));
        }
        Some(given) => given,
        // Two terms share one binary, unless both can be off.
        None if count == 2 && !inner => {
            let first = model.binary(free_name(model, name, "_first"))?;
            vec![first.on(), first.off()]
        }
        None => {
            let mut own = Vec::with_capacity(count);
            for k in 1..=count {
                own.push(model.binary(free_name(model, name, &format!("_is{k}")))?.on());
            }
            own
        }
    };
    let mut terms = Vec::with_capacity(count);
    for (k, (term, selector)) in of.terms.into_iter().zip(selectors).enumerate() {
        let name = name.suffixed(&format!("_{}", k + 1));
        check_selector(selector, model, &name)?;
        let mut all = term.rows;
        for row in term.nonlinear {
            all.push(row.define(model, &name)?);
        }
        let rows = all.into_iter().map(|row| stored(row, model, &name));
        let rows = rows.collect::<Result<_, _>>()?;
        let conic = term.conic.into_iter().map(|row| row.checked(model, &name));
        let conic = conic.collect::<Result<_, _>>()?;
        let nested = term.nested.into_iter().map(|inner| store(inner, model, &name, true));
        let nested = nested.collect::<Result<_, _>>()?;
        terms.push(StoredTerm { selector, rows, conic, nested });
    }
    Ok(terms)
}

/// The name with a suffix, and underscores if that is taken.
fn free_name(model: &Model, name: &Name, suffix: &str) -> Name {
    name.suffixed(suffix).free(|name| model.variable_by_name(name.clone()).is_ok())
}

pub(super) fn check_selector(selector: Literal, model: &Model, name: &Name) -> Result<(), Error> {
    model.check_variable(selector.variable, name)?;
    let variable = model.variable_ref(selector.variable)?;
    if variable.kind() != VariableKind::Binary {
        let (name, place) = (variable.name().to_string(), name.to_string());
        return Err(ErrorKind::NotBinary { name, place }.into());
    }
    Ok(())
}

impl Model {
    /// Number of disjunctions, without nested ones.
    pub fn disjunction_count(&self) -> usize {
        self.stored.disjunctions.len()
    }

    /// The disjunctions in the order of creation.
    pub fn disjunctions(&self) -> impl ExactSizeIterator<Item = DisjunctionRef<'_>> {
        let data = self.stored.disjunctions.iter().enumerate();
        data.map(|(i, data)| DisjunctionRef { id: Disjunction::new(i, self.stored.tag), data })
    }
}
