//! Sweeps: one question for many cases, with results that outlive the process.
//!
//! A [`Sweep`] is a list or a grid of cases. It calls a function for each case, on all threads, and
//! appends what the function returns to a file, a line of JSON a case. A sweep that finds its file
//! goes on where it was stopped, however that was. With shards, several processes or machines share
//! the cases; their files are merged by concatenation.
//!
//! ```
//! use carom::prelude::*;
//! use carom::sweep::{Sweep, SweepRecord};
//!
//! # let folder = std::env::temp_dir().join(format!("carom-sweep-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder).unwrap();
//! # let file = folder.join("lots.jsonl");
//! let sweep = Sweep::grid("lots", [("room", vec![5.0, 9.0, 14.0]), ("worth", vec![1.0, 3.0])])?
//!     .with_file(&file)
//!     .with_shard("1/2")?;
//! let results = sweep.run(|case| {
//!     let mut model = Model::new("lot");
//!     let n = model.integer("n", 0.0, 10.0)?;
//!     model.add("room", (2.0 * n).le(case.value("room")))?;
//!     model.maximize(case.value("worth") * n)?;
//!     let solution = BranchAndBound::default().solve(&model)?;
//!     Ok(Some(SweepRecord::new().with_number("value", solution.objective())))
//! })?;
//! assert_eq!(results.missing().count(), 3); // those of shard 2/2
//! assert_eq!(results.record(0).and_then(|record| record.number("value")), Some(2.0));
//! # std::fs::remove_dir_all(&folder).unwrap();
//! # Ok::<(), carom::Error>(())
//! ```

mod file;
mod record;

pub use file::SweepFile;
pub use record::SweepRecord;

use std::fmt;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use carom_model::error::{Error, ErrorKind};
use carom_model::solver::Interrupt;
use record::Field;

/// A list or a grid of cases, and where their results go; see the [module](self).
#[derive(Debug, Clone)]
#[must_use]
pub struct Sweep {
    title: String,
    names: Vec<String>,
    /// The values of a case, by name.
    cases: Vec<Vec<f64>>,
    path: Option<PathBuf>,
    /// The shard, from 0, and the number of shards.
    shard: (usize, usize),
    threads: usize,
    interrupt: Interrupt,
}

/// A case of a [`Sweep`].
#[derive(Debug, Clone, Copy)]
pub struct SweepCase<'a> {
    sweep: &'a Sweep,
    index: usize,
}

/// The results of the cases of a [`Sweep`].
#[derive(Debug, Clone)]
pub struct SweepResults {
    records: Vec<Option<SweepRecord>>,
    half_lines: usize,
}

impl Sweep {
    /// All combinations of the values of some axes; the last axis varies fastest.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Sweep`] if a name is empty, occurs twice, or is `sweep` or `case`;
    /// [`ErrorKind::NotFinite`] for a value that is not a finite number.
    pub fn grid<N: Into<String>>(
        title: &str,
        axes: impl IntoIterator<Item = (N, Vec<f64>)>,
    ) -> Result<Self, Error> {
        let (mut names, mut cases) = (Vec::new(), vec![Vec::new()]);
        for (name, values) in axes {
            names.push(name.into());
            let longer = |case: &Vec<f64>| {
                let case = case.clone();
                values.iter().map(move |&value| [&case[..], &[value]].concat()).collect::<Vec<_>>()
            };
            cases = cases.iter().flat_map(longer).collect();
        }
        Sweep::list(title, names, cases)
    }

    /// Cases one by one, each with a value for every name.
    ///
    /// # Errors
    ///
    /// As for [`grid`](Self::grid), and [`ErrorKind::Sweep`] for a case with too few or too many
    /// values.
    pub fn list<N: Into<String>>(
        title: &str,
        names: impl IntoIterator<Item = N>,
        cases: impl IntoIterator<Item = Vec<f64>>,
    ) -> Result<Self, Error> {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        let cases: Vec<Vec<f64>> = cases.into_iter().collect();
        for (k, name) in names.iter().enumerate() {
            let is_taken = names[..k].contains(name) || ["", "sweep", "case"].contains(&&**name);
            if is_taken {
                let what = format!("`{name}` cannot be a name of sweep `{title}`");
                let help = "give each value a name of its own, but `sweep` or `case`";
                return Err(ErrorKind::Sweep { what, help }.into());
            }
        }
        for (k, case) in cases.iter().enumerate() {
            if case.len() != names.len() {
                let (found, wanted) = (case.len(), names.len());
                let what =
                    format!("case {k} of sweep `{title}` has {found} values for {wanted} names");
                return Err(ErrorKind::Sweep { what, help: "give a value for every name" }.into());
            }
            if let Some((name, &value)) = names.iter().zip(case).find(|(_, v)| !v.is_finite()) {
                let name = name.clone();
                return Err(ErrorKind::NotFinite { name, what: "a value", value }.into());
            }
        }
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        Ok(Sweep {
            title: title.to_owned(),
            names,
            cases,
            path: None,
            shard: (0, 1),
            threads,
            interrupt: Interrupt::new(),
        })
    }

    /// Keeps the results in a file. Each process needs a file of its own.
    pub fn with_file(mut self, path: impl Into<PathBuf>) -> Self {
        self.path = Some(path.into());
        self
    }

    /// Takes a share of the cases: `"2/8"` is the second of eight, every eighth case.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Sweep`] for any other text.
    pub fn with_shard(mut self, shard: &str) -> Result<Self, Error> {
        let numbers = shard.split_once('/').map(|(i, n)| (i.parse::<usize>(), n.parse::<usize>()));
        match numbers {
            Some((Ok(i), Ok(n))) if 1 <= i && i <= n => self.shard = (i - 1, n),
            _ => {
                let what = format!("`{shard}` is no shard");
                let help = "give `i/n` with i from 1 to n, such as `1/8`";
                return Err(ErrorKind::Sweep { what, help }.into());
            }
        }
        Ok(self)
    }

    /// Sets how many cases run at once; default: one a processor.
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads.max(1);
        self
    }

    /// Begins no further case once the handle is triggered.
    pub fn with_interrupt(mut self, interrupt: &Interrupt) -> Self {
        self.interrupt = interrupt.clone();
        self
    }

    /// The number of cases, of all shards.
    pub fn len(&self) -> usize {
        self.cases.len()
    }

    /// Whether there are no cases.
    pub fn is_empty(&self) -> bool {
        self.cases.is_empty()
    }

    /// A case, by its number.
    #[doc(hidden)]
    pub fn case(&self, index: usize) -> SweepCase<'_> {
        SweepCase { sweep: self, index }
    }

    /// Opens the file of the sweep, for those who run the cases by other means.
    #[doc(hidden)]
    pub fn open(&self) -> Result<SweepFile, Error> {
        SweepFile::open(self)
    }

    /// Calls the function for each case of this shard that is not in the file, and appends its
    /// record. A case for which it returns `None`, because it was interrupted, is left for the next
    /// run. A stopped process loses at most the cases that were running. The results contain all
    /// that the file holds.
    ///
    /// # Errors
    ///
    /// The first error of the function; the cases before it are kept. [`ErrorKind::Io`] if the file
    /// cannot be opened or written; [`ErrorKind::Sweep`] if it holds lines of another sweep, or no
    /// records.
    pub fn run(
        &self,
        answer: impl Fn(SweepCase<'_>) -> Result<Option<SweepRecord>, Error> + Sync,
    ) -> Result<SweepResults, Error> {
        let file = self.open()?;
        let todo = file.todo(self);
        let (file, next, failed) = (Mutex::new(file), AtomicUsize::new(0), AtomicBool::new(false));
        let work = || -> Result<(), Error> {
            while let Some(&k) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
                if self.interrupt.is_triggered() || failed.load(Ordering::Relaxed) {
                    break;
                }
                if let Some(record) = answer(self.case(k))? {
                    let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                    file.append(self, k, record)?;
                }
            }
            Ok(())
        };
        let work = || work().inspect_err(|_| failed.store(true, Ordering::Relaxed));
        std::thread::scope(|scope| {
            let threads = self.threads.min(todo.len());
            let handles: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
            let mut done = work();
            for handle in handles {
                let own = handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
                done = done.and(own);
            }
            done
        })?;
        Ok(file.into_inner().unwrap_or_else(PoisonError::into_inner).into_results())
    }

    /// The name of the sweep in its file, different for other cases.
    fn key(&self) -> String {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut add = |byte: u8| hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        for name in &self.names {
            name.bytes().chain([0]).for_each(&mut add);
        }
        let values = self.cases.iter().flatten();
        values.flat_map(|value| (value + 0.0).to_bits().to_le_bytes()).for_each(&mut add);
        format!("{}-{hash:016x}", self.title)
    }

    /// The first fields of the line of a case.
    fn head(&self, case: usize) -> SweepRecord {
        let head =
            SweepRecord::new().with_text("sweep", &self.key()).with_number("case", case as f64);
        let values = self.names.iter().zip(&self.cases[case]);
        values.fold(head, |head, (name, &value)| head.with(name, Field::Number(value)))
    }
}

impl SweepCase<'_> {
    /// Its number, from 0.
    pub fn index(&self) -> usize {
        self.index
    }

    /// The value of a name; NaN for a name that the sweep does not have.
    pub fn value(&self, name: &str) -> f64 {
        let place = self.sweep.names.iter().position(|own| own == name);
        place.map_or(f64::NAN, |place| self.sweep.cases[self.index][place])
    }
}

impl SweepResults {
    fn new(sweep: &Sweep) -> Self {
        SweepResults { records: vec![None; sweep.len()], half_lines: 0 }
    }

    /// The result of a case; `None` if it is missing.
    pub fn record(&self, case: usize) -> Option<&SweepRecord> {
        self.records.get(case)?.as_ref()
    }

    /// The cases of which nothing is known, in order.
    pub fn missing(&self) -> impl Iterator<Item = usize> + '_ {
        self.records.iter().enumerate().filter(|(_, record)| record.is_none()).map(|(k, _)| k)
    }

    /// The lines that were written by half, when a process was stopped. Their cases were run again.
    pub fn half_lines(&self) -> usize {
        self.half_lines
    }
}

/// One sentence: how many cases are known, and which are missing.
impl fmt::Display for SweepResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const MOST: usize = 10;
        let (all, missing) = (self.records.len(), self.missing().count());
        write!(f, "{} of {all} cases are known", all - missing)?;
        if missing > 0 {
            let first: Vec<String> = self.missing().take(MOST).map(|k| k.to_string()).collect();
            let more = if missing > MOST { ", ..." } else { "" };
            write!(f, "; missing: {}{more}", first.join(", "))?;
        }
        Ok(())
    }
}
