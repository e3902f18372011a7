//! A program that is solved again and again with other numbers.
//!
//! A prepared model stays on the thread that made it, so one thread serves all solves. It ends with
//! the object, and is started again if it is gone: in a fork of the process, or after a panic.

use std::process;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, TryLockError};

use carom::model::{Model, Quadratic, Variable};
use carom::prelude::Solver;
use carom::solution::Solution;
use carom::solver::{Control, Interrupt, MipStart};
use carom::{BranchAndBound, Error};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::answer::Answer;
use crate::arrays::{Arrays, Ranges};
use crate::build::{Built, Layout, Parameter, Side, affine, build};
use crate::errors::{broken, exception};
use crate::numbers::Floats;
use crate::session::{self, Calling, Solved, Solving, Watch};
use crate::settings::{Settings, Task, integral};

/// A program with numbers that change.
#[pyclass(frozen, module = "carom._carom")]
pub(crate) struct Prepared {
    layout: Arc<Layout>,
    parameters: Vec<Parameter>,
    /// Where each number is among the parameters, by array.
    places: [Vec<Option<usize>>; 4],
    state: Mutex<State>,
}

/// What changes from solve to solve.
struct State {
    model: Model,
    /// The numbers of the last solve: `l`, `u`, `lb`, `ub`.
    numbers: [Vec<f64>; 4],
    server: Option<Server>,
}

/// The thread that solves.
struct Server {
    jobs: Sender<Job>,
    calling: Calling<Reply>,
    /// The process that it is in.
    process: u32,
}

/// A solve that is asked for.
struct Job {
    task: Task,
    values: Vec<(Variable, f64)>,
    /// The model, if its costs are new.
    model: Option<Model>,
}

/// What came of a solve; nothing if it was only prepared.
type Reply = Result<Option<Solved>, Error>;

/// The numbers of a solve, of which those that are not given stay.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Numbers {
    l: Option<Floats>,
    u: Option<Floats>,
    lb: Option<Floats>,
    ub: Option<Floats>,
    q: Option<Floats>,
    offset: Option<f64>,
}

const WORDS: [&str; 4] = ["l", "u", "lb", "ub"];

#[pymethods]
impl Prepared {
    #[new]
    fn new(py: Python<'_>, arrays: Arrays, ranges: Ranges) -> PyResult<Self> {
        let built = py.detach(|| build(&arrays, &ranges)).map_err(|error| exception(&error))?;
        let Built { model, layout, parameters } = built;
        let Arrays { l: Floats(l), u: Floats(u), lb: Floats(lb), ub: Floats(ub), .. } = arrays;
        let numbers = [l, u, lb, ub];
        let mut places = numbers.each_ref().map(|numbers| vec![None; numbers.len()]);
        for (k, parameter) in parameters.iter().enumerate() {
            for side in sides(parameter.side) {
                places[*side][parameter.index] = Some(k);
            }
        }
        let mut state = State { model, numbers, server: None };
        let layout = Arc::new(layout);
        state.server(py)?;
        Ok(Prepared { layout, parameters, places, state: Mutex::new(state) })
    }

    /// Solves it with these numbers.
    fn solve(&self, py: Python<'_>, numbers: Numbers, settings: Settings) -> PyResult<Answer> {
        let mut state = match self.state.try_lock() {
            Ok(state) => state,
            Err(TryLockError::Poisoned(state)) => state.into_inner(),
            Err(TryLockError::WouldBlock) => {
                return Err(PyRuntimeError::new_err(
                    "this prepared program is being solved; a second one can be solved at the \
                     same time",
                ));
            }
        };
        let values = self.take_in(&numbers, &mut state)?;
        let model = state.other_costs(&numbers, &self.layout)?;
        let task = settings.task(&state.model)?;
        let watch = Watch {
            interrupt: task.interrupt.clone(),
            callback: settings.callback.as_ref(),
            columns: self.layout.variables.len(),
        };
        let server = state.server(py)?;
        // If nobody takes it, nobody answers either.
        let _ = server.jobs.send(Job { task, values, model });
        match server.calling.wait(py, &watch) {
            Ok(Ok(Some(solved))) => Ok(Answer::new(solved, &self.layout)),
            // After an error, the next solve begins with a new thread, which may have ended.
            Ok(Ok(None)) => Err(broken()).inspect_err(|_| state.server = None),
            Ok(Err(error)) => Err(exception(&error)).inspect_err(|_| state.server = None),
            Err(raised) => Err(raised).inspect_err(|_| state.server = None),
        }
    }
}

/// The arrays that hold a number.
fn sides(side: Side) -> &'static [usize] {
    match side {
        Side::RowLower => &[0],
        Side::RowUpper => &[1],
        Side::RowBoth => &[0, 1],
        Side::Lower => &[2],
        Side::Upper => &[3],
    }
}

impl Prepared {
    /// Checks new numbers, and takes all of them or none.
    fn take_in(&self, given: &Numbers, state: &mut State) -> PyResult<Vec<(Variable, f64)>> {
        let Numbers { l, u, lb, ub, .. } = given;
        let mut numbers = state.numbers.clone();
        for (k, given) in [l, u, lb, ub].into_iter().enumerate() {
            let Some(Floats(values)) = given else { continue };
            for (i, (value, known)) in values.iter().zip(&numbers[k]).enumerate() {
                let word = WORDS[k];
                if value.is_nan() {
                    let text = format!("`{word}[{i}]` is NaN; give a number");
                    return Err(PyValueError::new_err(text));
                }
                if self.places[k][i].is_none() && value != known {
                    return Err(PyValueError::new_err(format!(
                        "`{word}[{i}]` is {value} and was prepared as {known}; give `{word}` a \
                         range in which this number may change"
                    )));
                }
            }
            numbers[k].clone_from(values);
        }
        let mut values = Vec::with_capacity(self.parameters.len());
        for Parameter { side, index, variable, range: (low, high) } in &self.parameters {
            let sides = sides(*side);
            let (word, value) = (WORDS[sides[0]], numbers[sides[0]][*index]);
            if !(*low..=*high).contains(&value) {
                return Err(PyValueError::new_err(format!(
                    "`{word}[{index}]` is {value} and was prepared for {low} to {high}; prepare \
                     the program with a wider range"
                )));
            }
            if *side == Side::RowBoth && numbers[1][*index] != value {
                return Err(PyValueError::new_err(format!(
                    "row {index} was prepared as an equation, and `l[{index}]` is {value} where \
                     `u[{index}]` is {}; give both, or prepare the row with two ranges",
                    numbers[1][*index]
                )));
            }
            values.push((*variable, value));
        }
        state.numbers = numbers;
        Ok(values)
    }
}

impl State {
    /// The model with other costs, if they are given.
    fn other_costs(&mut self, given: &Numbers, layout: &Layout) -> PyResult<Option<Model>> {
        if given.q.is_none() && given.offset.is_none() {
            return Ok(None);
        }
        let old = self.model.objective();
        let offset = given.offset.unwrap_or_else(|| old.affine().offset());
        let mut costs = Quadratic::from(match &given.q {
            Some(Floats(q)) => affine(q.iter().copied().enumerate(), offset, &layout.variables),
            None => old.affine().clone() + (offset - old.affine().offset()),
        });
        let products = old.products().into_iter();
        products.for_each(|(first, second, factor)| costs.add_product(factor, first, second));
        self.model.minimize(costs).map_err(|error| exception(&error))?;
        Ok(Some(self.model.clone()))
    }

    /// The thread that solves, which is started if there is none.
    fn server(&mut self, py: Python<'_>) -> PyResult<&mut Server> {
        let process = process::id();
        // What a fork copies has no threads.
        let server = match self.server.take().filter(|server| server.process == process) {
            Some(server) => server,
            None => {
                let (jobs, queue) = channel();
                let (mut calling, solving) = session::link();
                let model = self.model.clone();
                session::spawn(move || serve(model, &queue, &solving))?;
                let nobody = Watch { interrupt: Interrupt::new(), callback: None, columns: 0 };
                calling.wait(py, &nobody)?.map_err(|error| exception(&error))?;
                Server { jobs, calling, process }
            }
        };
        Ok(self.server.insert(server))
    }
}

/// The desk of the thread that solves.
struct Desk<'a> {
    jobs: &'a Receiver<Job>,
    solving: &'a Solving<Reply>,
    integers: Vec<Variable>,
    /// The integers of the last point.
    last: MipStart,
}

/// Solves what is asked for, until nobody can ask any more.
fn serve(mut model: Model, jobs: &Receiver<Job>, solving: &Solving<Reply>) {
    let integers = integral(&model);
    let mut desk = Desk { jobs, solving, integers, last: MipStart::new() };
    let mut first = None;
    while let Some(job) = desk.serve_prepared(&model, first.take()) {
        first = desk.serve_other_costs(job, &mut model);
        if first.is_none() {
            return;
        }
    }
}

impl Desk<'_> {
    /// Prepares a model and solves it until costs change; returns the job with other costs.
    fn serve_prepared(&mut self, model: &Model, first: Option<Job>) -> Option<Job> {
        let mut solver = BranchAndBound::default();
        let mut prepared = match solver.prepare(model) {
            Ok(prepared) => prepared,
            Err(error) => {
                self.solving.done(Err(error));
                return None;
            }
        };
        let mut job = match first {
            Some(job) => job,
            None => {
                self.solving.done(Ok(None));
                self.jobs.recv().ok()?
            }
        };
        while job.model.is_none() {
            self.answer(&job.task, |control| {
                prepared.options_mut().clone_from(&job.task.options);
                prepared.solve(&job.values, control)
            });
            job = self.jobs.recv().ok()?;
        }
        Some(job)
    }

    /// Solves a model with other costs as it is, from the last point, because costs that change each
    /// time are not worth a preparation; returns the first job without other costs.
    fn serve_other_costs(&mut self, mut job: Job, model: &mut Model) -> Option<Job> {
        while let Some(other) = job.model.take() {
            *model = other;
            if job.task.start.is_none() && !self.last.values.is_empty() {
                job.task.start = Some(self.last.clone());
            }
            self.answer(&job.task, |control| {
                job.values.iter().try_for_each(|&(of, value)| model.set_parameter(of, value))?;
                BranchAndBound::new(job.task.options.clone()).solve_with(model, control)
            });
            job = self.jobs.recv().ok()?;
        }
        Some(job)
    }

    fn answer(
        &mut self,
        task: &Task,
        solve: impl FnOnce(&mut Control<'_>) -> Result<Solution, Error>,
    ) {
        let solved = self.solving.solve(task, solve);
        if let Ok(Solved { solution, .. }) = &solved
            && solution.point().is_some()
        {
            self.last = MipStart::of(solution, self.integers.iter().copied());
        }
        self.solving.done(solved.map(Some));
    }
}
