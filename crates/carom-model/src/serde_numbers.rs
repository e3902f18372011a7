//! Real numbers with infinities in files: JSON has none, so they travel as text.
//!
//! Used as `#[serde(with = "crate::serde_numbers")]` on numbers that may be infinite. Text formats
//! get `"inf"`, `"-inf"` and `"nan"` for what they cannot write as a number; binary formats get
//! plain floats.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[derive(Deserialize)]
#[serde(untagged)]
enum Real {
    Number(f64),
    Text(String),
}

/// Writes a number.
pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if value.is_finite() || !serializer.is_human_readable() {
        return value.serialize(serializer);
    }
    let text = match *value {
        f64::INFINITY => "inf",
        f64::NEG_INFINITY => "-inf",
        _ => "nan",
    };
    text.serialize(serializer)
}

/// Reads a number.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    if !deserializer.is_human_readable() {
        return f64::deserialize(deserializer);
    }
    match Real::deserialize(deserializer)? {
        Real::Number(value) => Ok(value),
        Real::Text(text) => match text.as_str() {
            "inf" => Ok(f64::INFINITY),
            "-inf" => Ok(f64::NEG_INFINITY),
            "nan" => Ok(f64::NAN),
            other => Err(serde::de::Error::custom(format!(
                "`{other}` is not a number; expected a number, \"inf\", \"-inf\" or \"nan\""
            ))),
        },
    }
}
