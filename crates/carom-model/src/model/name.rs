//! Names of variables and statements: a family and, for members of a horizon, a step.

use std::fmt;

use crate::error::{Error, ErrorKind};

/// The name of a variable or statement: `goal`, or `x[17]` for step 17 of the family `x`.
///
/// A family is one or several words with single blanks between them. Made from a `&str`, a `String`
/// or a pair `(family, step)`; the text `"x[17]"` and the pair `("x", 17)` are the same name.
///
/// ```
/// use carom::model::Name;
///
/// assert_eq!(Name::from("x[17]"), Name::from(("x", 17)));
/// assert_eq!(Name::from(("x", 17)).to_string(), "x[17]");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "SpelledName")
)]
pub struct Name {
    family: String,
    step: Option<usize>,
}

/// A name in a file, which may spell a step as part of its family.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename = "Name")]
struct SpelledName {
    family: String,
    step: Option<usize>,
}

#[cfg(feature = "serde")]
impl From<SpelledName> for Name {
    fn from(parts: SpelledName) -> Self {
        match parts.step {
            Some(step) => Name::from((parts.family, step)),
            None => Name::from(parts.family),
        }
    }
}

impl Name {
    /// The family, or the whole name if there is no step.
    pub fn family(&self) -> &str {
        &self.family
    }

    /// The step inside the family.
    pub fn step(&self) -> Option<usize> {
        self.step
    }

    /// A family as a name, even if it looks like one of its members.
    pub(super) fn of_family(family: &str) -> Name {
        Name { family: family.to_owned(), step: None }
    }

    /// The name with a word and an underscore before it; the step stays. White space of the word
    /// becomes an underscore.
    pub(super) fn prefixed(&self, word: &str) -> Name {
        let plain = |c: char| if c.is_whitespace() || c.is_control() { '_' } else { c };
        let word: String = word.chars().map(plain).collect();
        Name { family: format!("{word}_{}", self.family), step: self.step }
    }

    /// The name with something appended to its family; the step stays.
    #[doc(hidden)]
    pub fn suffixed(&self, suffix: &str) -> Name {
        Name { family: format!("{}{suffix}", self.family), step: self.step }
    }

    /// The name, or one that is not taken: with one to three underscores, then with an underscore
    /// and a number. Asks for few names even if many are taken.
    #[doc(hidden)]
    pub fn free(&self, is_taken: impl Fn(&Name) -> bool) -> Name {
        let candidate = |k: usize| match k {
            0..=3 => self.suffixed(&"_".repeat(k)),
            k => self.suffixed(&format!("_{k}")),
        };
        let (mut taken, mut free) = (0, 0);
        while is_taken(&candidate(free)) {
            taken = free;
            free = if free < 4 { free + 1 } else { 2 * free };
        }
        while free > taken + 1 {
            let middle = taken + (free - taken) / 2;
            if is_taken(&candidate(middle)) { taken = middle } else { free = middle }
        }
        candidate(free)
    }

    /// Refuses names that are not words with single blanks between them.
    #[doc(hidden)]
    pub fn check(&self) -> Result<(), Error> {
        match is_name(&self.family) {
            true => Ok(()),
            false => Err(ErrorKind::InvalidName { name: self.to_string() }.into()),
        }
    }
}

/// Whether a text can be a name, of whatever: words with single blanks between them.
pub fn is_name(text: &str) -> bool {
    let is_word =
        |word: &str| !word.is_empty() && !word.chars().any(|c| c.is_whitespace() || c.is_control());
    text.split(' ').all(is_word)
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.step {
            Some(step) => write!(f, "{}[{step}]", self.family),
            None => f.write_str(&self.family),
        }
    }
}

impl From<&str> for Name {
    fn from(text: &str) -> Self {
        if let Some((family, rest)) = text.rsplit_once('[')
            && let Some(digits) = rest.strip_suffix(']')
            && digits.bytes().all(|b| b.is_ascii_digit())
            && (digits.len() == 1 || !digits.starts_with('0'))
            && let Ok(step) = digits.parse()
            && !family.is_empty()
        {
            return Name { family: family.to_owned(), step: Some(step) };
        }
        Name { family: text.to_owned(), step: None }
    }
}

impl From<String> for Name {
    fn from(text: String) -> Self {
        Name::from(text.as_str())
    }
}

impl From<&String> for Name {
    fn from(text: &String) -> Self {
        Name::from(text.as_str())
    }
}

impl<S: Into<String>> From<(S, usize)> for Name {
    fn from((family, step): (S, usize)) -> Self {
        Name { family: family.into(), step: Some(step) }
    }
}
