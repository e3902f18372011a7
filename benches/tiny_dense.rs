//! Solves each MPS file of a folder again and again in one process, from nothing and prepared, and
//! prints medians in milliseconds and their geometric means. That is how a library is called that
//! answers in a tenth of a millisecond; the first solve of a process takes as long again to load
//! code and to get memory.
//!
//! `cargo bench -p carom-benches --bench tiny_dense -- FOLDER`

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use carom::model::mps;
use carom::prelude::{BranchAndBound, Control, Solver};

/// Solves of each program; the first one does not count.
const SOLVES: usize = 40;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().skip(1).find(|word| !word.starts_with("--"));
    let Some(folder) = folder else {
        eprintln!("tiny_dense: no folder of MPS files is given");
        return Ok(());
    };
    let mut files: Vec<_> = std::fs::read_dir(Path::new(&folder))?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<_, std::io::Error>>()?;
    files.retain(|path| path.extension().is_some_and(|extension| extension == "mps"));
    files.sort();
    let (mut cold, mut prepared) = (Vec::new(), Vec::new());
    for path in &files {
        let model = mps::read(&std::fs::read_to_string(path)?)?.model;
        cold.push(median(|| {
            let _ = BranchAndBound::default().solve(&model)?;
            Ok(())
        })?);
        let mut solver = BranchAndBound::default();
        let mut ready = solver.prepare(&model)?;
        prepared.push(median(|| {
            let _ = ready.solve(&[], &mut Control::default())?;
            Ok(())
        })?);
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        println!("{name} {:.3} {:.3}", cold[cold.len() - 1], prepared[prepared.len() - 1]);
    }
    println!(
        "{} files, {:.3} from nothing, {:.3} prepared",
        files.len(),
        mean(&cold),
        mean(&prepared)
    );
    Ok(())
}

/// The median of the solves, in milliseconds.
fn median(mut solve: impl FnMut() -> Result<(), carom::Error>) -> Result<f64, carom::Error> {
    let mut times = Vec::with_capacity(SOLVES);
    for _ in 0..SOLVES {
        let began = Instant::now();
        solve()?;
        times.push(1e3 * began.elapsed().as_secs_f64());
    }
    let times = &mut times[1..];
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}

/// The geometric mean.
fn mean(times: &[f64]) -> f64 {
    (times.iter().map(|t| t.ln()).sum::<f64>() / times.len().max(1) as f64).exp()
}
