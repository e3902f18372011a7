//! The names of sections: those that are read, and why others are not.

use crate::error::Error;
use crate::model::text::token::Token;

/// The section of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MpsSection {
    /// Before the first section that holds lines; also NAME.
    Start,
    Objsense,
    Objname,
    Rows,
    Columns,
    Rhs,
    Ranges,
    Bounds,
    Quadobj,
    Qsection,
    Qmatrix,
    Qcmatrix,
    Indicators,
    Sets,
}

impl MpsSection {
    /// The section of a name in any case of letters.
    pub(super) fn named(head: &Token<'_>) -> Result<MpsSection, Error> {
        Ok(match head.text.to_ascii_uppercase().as_str() {
            "NAME" => MpsSection::Start,
            "OBJSENSE" => MpsSection::Objsense,
            "OBJNAME" => MpsSection::Objname,
            "ROWS" => MpsSection::Rows,
            "COLUMNS" => MpsSection::Columns,
            "RHS" => MpsSection::Rhs,
            "RANGES" => MpsSection::Ranges,
            "BOUNDS" => MpsSection::Bounds,
            "QUADOBJ" => MpsSection::Quadobj,
            "QSECTION" => MpsSection::Qsection,
            "QMATRIX" => MpsSection::Qmatrix,
            "QCMATRIX" => MpsSection::Qcmatrix,
            "INDICATORS" => MpsSection::Indicators,
            "SOS" | "SOS1" | "SOS2" | "SETS" => MpsSection::Sets,
            other => {
                return Err(head.error(match refused(other) {
                    Some(help) => format!("section `{}` cannot be read: {help}", head.text),
                    None => format!(
                        "section `{}` is not known; expected NAME, OBJSENSE, ROWS, COLUMNS, RHS, \
                         RANGES, BOUNDS, SOS, QUADOBJ, QMATRIX, QCMATRIX, INDICATORS or ENDATA (data \
                         lines begin with a space)",
                        head.text
                    ),
                }));
            }
        })
    }
}

/// The advice about a section that a model cannot hold; `None` for any other section.
fn refused(name: &str) -> Option<&'static str> {
    Some(match name {
        "CSECTION" => "write the cone as a row with QCMATRIX, and its head with the lower bound 0",
        "LAZYCONS" | "USERCUTS" => "move its rows to ROWS, where they always hold",
        "PWLOBJ" | "PWLNAM" | "PWLCON" | "GENCONS" => {
            "functions cannot be read from MPS; write them as rows, or in a program with the \
             functions of a model"
        }
        "OBJECTIVES" | "SCENARIOS" => "a model has one objective; keep one",
        _ => return None,
    })
}
