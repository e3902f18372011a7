// The program `carom`: solves a model file, or writes it in another format. `--help` lists the
// options.
//
// Files are MPS (free or fixed), LP, CBF, QPLIB, NL, or JSON (with the feature `serde`), plain or
// compressed by gzip; `-` is the standard input. The format follows from `--format`, else from the
// extension `.mps`, `.lp`, `.cbf`, `.qplib`, `.nl` or `.json`, otherwise from the contents. It also
// answers the call of AMPL (`ampl`).
//
// The first line of the output is `rows=… columns=… integers=… nonzeros=…`, as read; rows include
// those of indicators, and ` cones=…` follows if there are norms or quadratic rows. The last line
// is `status=… objective=… bound=… nodes=… seconds=…`. The status is `optimal`, `infeasible`,
// `unbounded`, `feasible` (stopped with a point that is not proved optimal) or `limit` (stopped
// without a point). The objective is `-` if there is no point. The seconds exclude reading the
// file. What people want to see is on the standard error: the size and the numbers of the program,
// what presolve has left, the bound before and after cuts, lines of progress and a summary; on a
// terminal, a last line moves.
//
// Ctrl-C ends the search and keeps what was found; see `--help` for that and for the exit status.
//
// These are no doc comments, because the example `solve` of `carom` includes this file.

#[macro_use]
mod output;
mod interrupts;
mod sol;

mod ampl;
mod answer;
mod arguments;
mod format;
mod header;
mod input;
mod live;
mod warnings;

use std::error::Error;
use std::fmt::Display;
use std::process::ExitCode;
use std::time::Instant;

use carom::explain::{ExplainOptions, infeasibility};
use carom::prelude::{
    BranchAndBound, Control, Event, Interrupt, Model, Solver, Termination, Variable,
};
use carom::reformulate;
use carom::solver::MipStart;

use arguments::{Arguments, Command, Values};
use format::{Format, FromFile};
use interrupts::{INTERRUPTED, Signals};
use live::Live;

/// The name of the program, `carom` or that of the example.
const NAME: &str = env!("CARGO_BIN_NAME");

/// The exit status for wrong arguments; all of them are in `--help`.
const WRONG_ARGUMENTS: u8 = 2;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if ampl::is_called(&words) {
        return ampl::run(&words);
    }
    let arguments = match arguments::read(words.into_iter()) {
        Ok(Command::Solve(arguments)) => *arguments,
        Ok(Command::Print(text)) => {
            println!("{text}");
            return ExitCode::SUCCESS;
        }
        Err(error) => {
            eprintln!("{NAME}: {error}");
            return WRONG_ARGUMENTS.into();
        }
    };
    match run(arguments) {
        Ok(Ended { has_failed: true, .. }) => ExitCode::FAILURE,
        Ok(Ended { is_interrupted: true, .. }) => INTERRUPTED.into(),
        Ok(_) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{NAME}: {}", coded(&*error));
            ExitCode::FAILURE
        }
    }
}

/// How a run has ended that has printed its answer.
#[derive(Default)]
struct Ended {
    /// Whether Ctrl-C has left something unfinished.
    is_interrupted: bool,
    /// Whether something could not be written, which was said.
    has_failed: bool,
}

impl Ended {
    /// Says what has failed beside the answer.
    fn fail(&mut self, error: &dyn Display) {
        eprintln!("{NAME}: {error}");
        self.has_failed = true;
    }
}

/// An error, and its section of the page "Help" in brackets, if it is one of the library.
pub(crate) fn coded(error: &(dyn Error + 'static)) -> String {
    match error.downcast_ref::<carom::Error>() {
        Some(own) => format!("{own} [{}]", own.code()),
        None => error.to_string(),
    }
}

/// Refuses files that cannot be written, before the work that leads to them.
fn check_files(arguments: &Arguments) -> Result<(), String> {
    let models = [&arguments.write, &arguments.lowered];
    models.into_iter().flatten().try_for_each(|path| format::check(path))?;
    if let Some(Values::Written(path)) = &arguments.solution {
        answer::check(path)?;
    }
    match arguments.options.proof.as_deref() {
        // Folders get a new file.
        Some(path) if !path.is_dir() => answer::check(&path.to_string_lossy()),
        _ => Ok(()),
    }
}

/// Does what is asked for.
fn run(arguments: Arguments) -> Result<Ended, Box<dyn Error>> {
    check_files(&arguments)?;
    let mut live = Live::new(arguments.quiet);
    live.doing("reading");
    let FromFile { model, warnings, format, start: guess } =
        format::read(&arguments.file, arguments.format)?;
    warnings.iter().for_each(|warning| live.say(warning));
    live.aside(|| println!("{}", header::counts(&model)));
    if let Some(path) = arguments.write {
        format::write(&model, &path)?;
        return Ok(Ended::default());
    }
    if let Some(path) = arguments.lowered {
        format::write(reformulate::lower(&model)?.model(), &path)?;
    }
    let mip_start = start(&model, arguments.start.as_deref(), guess, format)?;
    live.say(&header::header(&model));
    live.doing("presolve");

    let threads = arguments.options.threads;
    let mut solver = BranchAndBound::new(arguments.options);
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let (start, cpu) = (Instant::now(), processor_seconds(threads));
    let mut show = |event: &Event| live.show(event);
    let mut control = Control::default().with_progress(&mut show).with_interrupt(&interrupt);
    if let Some(start) = &mip_start {
        control = control.with_start(start);
    }
    let solution = solver.solve_with(&model, &mut control)?;
    let seconds = start.elapsed().as_secs_f64();
    let cpu = processor_seconds(threads).zip(cpu).map(|(end, start)| end - start);

    let mut ended = Ended {
        is_interrupted: solution.termination() == Termination::Interrupted,
        ..Ended::default()
    };
    // Before anything is printed, because nobody may read that.
    if let Some(Values::Written(path)) = &arguments.solution
        && let Err(error) = answer::write(&model, &solution, path)
    {
        live.aside(|| ended.fail(&error));
    }
    let explanation = (arguments.explain && solution.is_infeasible()).then(|| {
        live.doing("the explanation");
        let options = ExplainOptions::default().with_interrupt(&interrupt);
        infeasibility(&model, &options, &mut solver)
    });
    live.end();

    if let Some(report) = solution.start_report() {
        live.say(&answer::start_report(report.status.as_ref()));
    }
    if arguments.log {
        live.summarise(&solution);
    } else {
        live.say(&answer::summary(&model, &solution, seconds));
    }
    if solver.options().pool > 1 {
        println!("{}", answer::pool(&solution));
    }
    if arguments.solution == Some(Values::Printed) {
        answer::values(&model, &solution).iter().for_each(|line| println!("{line}"));
    }
    match explanation {
        Some(Ok(explanation)) => {
            println!("{explanation}");
            let domains = answer::domains(&model, &explanation, format == Format::Lp);
            domains.iter().for_each(|line| println!("{line}"));
            ended.is_interrupted |= signals.came();
        }
        Some(Err(error)) => ended.fail(&coded(&error)),
        None => {}
    }
    if let Some(proof) = solution.proof() {
        println!("{}", answer::proof_line(proof));
        ended.is_interrupted |= signals.came() && !proof.is_complete;
    }
    println!("{}", answer::status_line(&solution, seconds, cpu));
    if let Some(failure) = solution.proof().and_then(|proof| proof.failure.as_ref()) {
        ended.fail(failure);
    }
    Ok(ended)
}

/// Processor time of this thread (s), or of the process if the search has several, where the system
/// tells it: not disturbed by other programs.
fn processor_seconds(threads: usize) -> Option<f64> {
    if threads > 1 {
        // User and system time, in hundredths of a second, are the 14th and 15th word; the 2nd is
        // in parentheses and may have blanks.
        let text = std::fs::read_to_string("/proc/self/stat").ok()?;
        let times = text.rsplit(')').next()?.split_whitespace().skip(11).take(2);
        return times.map(|ticks| Some(0.01 * ticks.parse::<f64>().ok()?)).sum();
    }
    std::thread::yield_now(); // brings the count up to date
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

/// The MIP start of a file, or of values that came with the model.
fn start(
    model: &Model,
    path: Option<&str>,
    guess: Vec<(Variable, f64)>,
    format: Format,
) -> Result<Option<MipStart>, String> {
    let Some(path) = path else { return Ok(guessed(model, guess)) };
    let text = input::text(path)?;
    let answer = (format == Format::Nl).then(|| sol::of_answer(model, &text)).flatten();
    let values = answer.map_or_else(|| sol::integers(model, &text), Ok);
    let values = values.map_err(|error| format!("{path}: {error}"))?;
    Ok(Some(MipStart::new().with_values(values)))
}

/// The MIP start of values that came with a model, if there are some of integers.
pub(crate) fn guessed(model: &Model, mut values: Vec<(Variable, f64)>) -> Option<MipStart> {
    let is_integral =
        |own: Variable| model.variable_ref(own).is_ok_and(|own| own.kind().is_integral());
    values.retain(|(own, _)| is_integral(*own));
    values.iter_mut().for_each(|(_, value)| *value = value.round());
    (!values.is_empty()).then(|| MipStart::new().with_values(values))
}
