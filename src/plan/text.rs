//! TOML with the values of the command line.

use crate::error::{Error, Result};
use serde::de::{self, Deserialize, DeserializeOwned, Deserializer, Visitor};
use serde::ser::{Serialize, Serializer};
use std::fmt::{self, Display};
use std::marker::PhantomData;
use std::path::Path;
use std::str::FromStr;

/// A value that is written as on the command line: as text, or as a number where that is the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Text<T>(pub T);

impl<'de, T: FromStr<Err = Error>> Deserialize<'de> for Text<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TextVisitor(PhantomData))
    }
}

impl<T: Display> Serialize for Text<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let text = self.0.to_string();
        match (text.parse::<i64>(), text.parse::<f64>()) {
            (Ok(number), _) if number.to_string() == text => serializer.serialize_i64(number),
            (_, Ok(number)) if number.is_finite() && number.to_string() == text => serializer.serialize_f64(number),
            _ => serializer.serialize_str(&text),
        }
    }
}

/// For fields that are written as [`Text`].
pub(super) mod named {
    use super::{Deserialize, Deserializer, Display, Error, FromStr, Serialize, Serializer, Text};

    pub fn serialize<T: Display, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
        Text(value).serialize(serializer)
    }

    pub fn deserialize<'de, T: FromStr<Err = Error>, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
        Text::deserialize(deserializer).map(|Text(value)| value)
    }
}

/// The same for fields that may be missing.
pub(super) mod named_option {
    use super::{Deserialize, Deserializer, Display, Error, FromStr, Serialize, Serializer, Text};

    pub fn serialize<T: Display, S: Serializer>(value: &Option<T>, serializer: S) -> Result<S::Ok, S::Error> {
        value.as_ref().map(Text).serialize(serializer)
    }

    pub fn deserialize<'de, T: FromStr<Err = Error>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<T>, D::Error> {
        Option::<Text<T>>::deserialize(deserializer).map(|value| value.map(|Text(value)| value))
    }
}

struct TextVisitor<T>(PhantomData<T>);

impl<T: FromStr<Err = Error>> Visitor<'_> for TextVisitor<T> {
    type Value = Text<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("text or a number")
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Text<T>, E> {
        text.parse().map(Text).map_err(|error| match error {
            Error::Parameter { value, range, .. } => E::custom(format!("{value}: it must be {range}")),
            other => E::custom(other),
        })
    }

    fn visit_i64<E: de::Error>(self, number: i64) -> Result<Text<T>, E> {
        self.visit_str(&number.to_string())
    }

    fn visit_f64<E: de::Error>(self, number: f64) -> Result<Text<T>, E> {
        self.visit_str(&number.to_string())
    }
}

/// Reads a document; `remedy` is for its mistakes.
///
/// # Errors
/// [`Error::File`] with file and line.
pub(super) fn document<T: DeserializeOwned>(path: &Path, text: &str, remedy: &str) -> Result<T> {
    toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let place = format!("{}:{}", path.display(), line(text, at));
        let reason = ["an array of length 2", "f64", "u32", "usize"]
            .into_iter()
            .zip(["[a, b]", "a number", "a whole number", "a whole number"])
            .fold(error.message().to_owned(), |text, (theirs, ours)| text.replace(theirs, ours));
        let key = if reason.starts_with("invalid ") { key(text, at).map(|key| format!("{key}: ")) } else { None };
        Error::file(place, key.unwrap_or_default() + &reason, remedy)
    })
}

/// The key whose value holds a byte: what is before the last `=` on its line.
fn key(text: &str, at: usize) -> Option<&str> {
    let before = text.get(..at)?;
    let (line, _) = before[before.rfind('\n').map_or(0, |end| end + 1)..].rsplit_once('=')?;
    let key = line.trim_end().rsplit([' ', '{', ',']).next()?;
    (!key.is_empty()).then_some(key)
}

/// The line, counted from 1, of a byte.
pub(super) fn line(text: &str, at: usize) -> usize {
    1 + text.as_bytes().iter().take(at).filter(|byte| **byte == b'\n').count()
}
