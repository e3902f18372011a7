//! The extension module `carom._carom`: programs from arrays, solved by [`carom`].
//!
//! Python's side (`python/carom`) checks what users give and speaks in numpy arrays. This side gets
//! numbers as bytes, so that it depends on no version of numpy and copies each array once.
//!
//! * `numbers` - bytes as numbers, and back
//! * `arrays` - the arrays of a program; `build` - their model
//! * `settings` - what a solve is told; `session` - a solve on a thread of its own, and the wait for it
//! * `answer` - what came of it; `explain` - why there is no point
//! * `program` - a program that is solved; `prepared` - one that is solved again and again
//! * `planner` - hybrid systems, scenes and missions
//! * `errors` - errors as exceptions

mod answer;
mod arrays;
mod build;
mod errors;
mod explain;
mod numbers;
mod planner;
mod prepared;
mod program;
mod session;
mod settings;

/// The module that Python imports.
#[pyo3::pymodule]
mod _carom {
    /// The version of the package.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use crate::answer::Answer;
    #[pymodule_export]
    use crate::planner::{
        Controller, Expression, HybridProgram, HybridSystem, Mission, Norm, Plan, Row, Scene,
        Shortest, ShortestInScene, Transition, norm,
    };
    #[pymodule_export]
    use crate::prepared::Prepared;
    #[pymodule_export]
    use crate::program::Program;
}
