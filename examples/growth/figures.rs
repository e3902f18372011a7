//! What was measured, as a table of figures.

use std::error::Error;
use std::fmt;
use std::path::Path;

use serde_json::Value;

use crate::families::FAMILIES;

const HEADING: &str = "family,size,columns,solver,status,seconds,nodes,megabytes";

/// One solve.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Figure {
    pub(crate) family: String,
    pub(crate) size: usize,
    pub(crate) columns: usize,
    pub(crate) solver: String,
    pub(crate) status: String,
    pub(crate) seconds: f64,
    pub(crate) nodes: u64,
    /// The most memory that its process took, where the system tells it.
    pub(crate) megabytes: Option<f64>,
}

impl fmt::Display for Figure {
    /// A line of the table.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Figure { family, size, columns, solver, status, seconds, nodes, .. } = self;
        write!(f, "{family},{size},{columns},{solver},{status},{seconds:.4},{nodes},")?;
        self.megabytes.map_or(Ok(()), |megabytes| write!(f, "{megabytes:.1}"))
    }
}

impl Figure {
    /// Whether the solve came to its end.
    pub(crate) fn is_solved(&self) -> bool {
        matches!(self.status.as_str(), "optimal" | "infeasible")
    }

    /// The figure of a line.
    pub(crate) fn read(line: &str) -> Option<Figure> {
        let mut words = line.split(',');
        let mut word = || words.next();
        Some(Figure {
            family: word()?.to_owned(),
            size: word()?.parse().ok()?,
            columns: word()?.parse().ok()?,
            solver: word()?.to_owned(),
            status: word()?.to_owned(),
            seconds: word()?.parse().ok()?,
            nodes: word()?.parse().ok()?,
            megabytes: match word()? {
                "" => None,
                megabytes => Some(megabytes.parse().ok()?),
            },
        })
    }
}

pub(crate) fn read(path: &Path) -> Result<Vec<Figure>, Box<dyn Error>> {
    let name = path.display();
    let text = std::fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?;
    let wrong = |line| format!("{name}: `{line}` is not `{HEADING}`");
    let figure = |line| Figure::read(line).ok_or_else(|| wrong(line).into());
    text.lines().skip(1).map(figure).collect()
}

pub(crate) fn write(path: &Path, figures: &[Figure]) -> Result<(), Box<dyn Error>> {
    let lines: Vec<String> = figures.iter().map(Figure::to_string).collect();
    std::fs::write(path, format!("{HEADING}\n{}\n", lines.join("\n")))?;
    Ok(())
}

/// The figures of HiGHS in the answers that `benches/compare.py --json` writes, for the programs
/// that were measured. Their files are called after family and size.
pub(crate) fn compared(path: &str, figures: &[Figure]) -> Result<Vec<Figure>, Box<dyn Error>> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    let answers: Value = serde_json::from_str(&text)?;
    let figure = |own: &Figure| {
        let answer = &answers["results"][file_stem(&own.family, own.size)]["highs"];
        Some(Figure {
            solver: "HiGHS".into(),
            status: answer[0].as_str()?.to_owned(),
            seconds: answer[1].as_f64()?,
            nodes: answer[2].as_u64()?,
            megabytes: None,
            ..own.clone()
        })
    };
    Ok(figures.iter().filter(|own| own.solver == "carom").filter_map(figure).collect())
}

/// The name of the file of a program.
pub(crate) fn file_stem(family: &str, size: usize) -> String {
    format!("{family}_{size}")
}

/// The figures as a table in Markdown: a line for each program, and the solvers side by side.
pub(crate) fn table(figures: &[Figure]) -> String {
    let mut text = String::from(
        "| family | size | columns | carom: s (nodes) | MB | HiGHS: s (nodes) | MB |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for family in &FAMILIES {
        let of_family = |figure: &&Figure| figure.family == family.name;
        for own in figures.iter().filter(of_family).filter(|figure| figure.solver == "carom") {
            let size = format!("{} {}", own.size, family.size);
            text += &format!("| {} | {size} | {} |", own.family, own.columns);
            let other = figures.iter().filter(of_family);
            let mut other = other.filter(|f| f.size == own.size && f.solver != "carom");
            for figure in [Some(own), other.next()] {
                text += &figure.map_or(" - | - |".into(), cells);
            }
            text += "\n";
        }
    }
    text
}

fn cells(figure: &Figure) -> String {
    let sign = if figure.is_solved() { "" } else { "> " };
    let memory = figure.megabytes.map_or("-".into(), |megabytes| format!("{megabytes:.0}"));
    format!(" {sign}{:.3} ({}) | {memory} |", figure.seconds, figure.nodes)
}
