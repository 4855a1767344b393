//! Values of options that are no type of the library, and how values are read.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::fmt;
use std::num::{NonZeroU32, NonZeroUsize};
use std::str::FromStr;
use texbake::batch::MapKind;
use texbake::{Error, Rational};

/// Reads a value; what it must be becomes the message.
pub fn value<T: FromStr<Err = Error>>(text: &str) -> Result<T, String> {
    text.parse().map_err(|error| match error {
        Error::Parameter { range, .. } => format!("it must be {range}"),
        other => other.to_string(),
    })
}

/// Reads one of `names`, which help and errors list.
pub fn choice<T>(names: &'static [&'static str]) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = Error> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names.iter().copied()).try_map(|name| name.parse::<T>())
}

/// Width and height in a unit of length, `2.0x1.5`; both are above zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent(pub [Rational; 2]);

impl FromStr for Extent {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let length = |text: &str| text.parse::<Rational>().ok().filter(|length| length.numerator() > 0);
        let sides = text.split_once('x').and_then(|(width, height)| Some([length(width)?, length(height)?]));
        sides.map(Self).ok_or_else(|| wrong("size", text, "a width and a height above zero, as 2.0x1.5"))
    }
}

/// A number of bytes: `512M`, `4G`, in powers of 1024.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ByteSize(pub u64);

impl FromStr for ByteSize {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let upper = text.to_ascii_uppercase();
        let plain = upper.trim_end_matches("IB").trim_end_matches('B');
        let (digits, shift) = match plain.find(['K', 'M', 'G', 'T']).map(|at| plain.split_at(at)) {
            None => (plain, 0),
            Some((digits, "K")) => (digits, 10),
            Some((digits, "M")) => (digits, 20),
            Some((digits, "G")) => (digits, 30),
            Some((digits, "T")) => (digits, 40),
            Some(_) => ("", 0),
        };
        let bytes = digits.parse::<u64>().ok().and_then(|count| count.checked_mul(1 << shift));
        let bytes = bytes.filter(|bytes| *bytes > 0).map(Self);
        bytes.ok_or_else(|| wrong("max-bytes", text, "a whole number of bytes from 1 to 16777215T, as 512M or 4G"))
    }
}

/// The weights of two maps, `1,-0.5`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WeightPair(pub [Rational; 2]);

impl FromStr for WeightPair {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let weight = |text: &str| text.trim().parse::<Rational>().ok();
        let weights = text.split_once(',').and_then(|(base, detail)| Some([weight(base)?, weight(detail)?]));
        weights.map(Self).ok_or_else(|| wrong("weights", text, "two numbers, as 1,-0.5 or 1/3,2/3"))
    }
}

impl fmt::Display for WeightPair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.0[0], self.0[1])
    }
}

/// One of what `--maps` lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapChoice {
    Map(MapKind),
    /// The file gets no map.
    None,
}

impl MapChoice {
    pub const NAMES: &'static [&'static str] = &["normal", "parallax", "roughness", "none"];

    /// The maps of a list; none of "none".
    ///
    /// # Errors
    /// [`Error::Parameter`] for "none" beside a map.
    pub fn kinds(choices: &[Self]) -> Result<Vec<MapKind>, Error> {
        let kinds: Vec<MapKind> = choices.iter().filter_map(Self::kind).collect();
        match choices.len() - kinds.len() {
            0 => Ok(kinds),
            _ if kinds.is_empty() => Ok(kinds),
            _ => Err(wrong("maps", "none and others", "none alone, or a list of normal, parallax and roughness")),
        }
    }

    fn kind(&self) -> Option<MapKind> {
        match self {
            Self::Map(kind) => Some(*kind),
            Self::None => None,
        }
    }
}

impl FromStr for MapChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        if text == "none" { Ok(Self::None) } else { text.parse().map(Self::Map) }
    }
}

/// A number of cores or jobs.
pub fn count(text: &str) -> Result<NonZeroUsize, String> {
    let count = text.parse().ok().filter(|count: &NonZeroUsize| count.get() <= MOST);
    count.ok_or_else(|| format!("it must be a whole number from 1 to {MOST}"))
}

/// More than any machine has cores.
const MOST: usize = 65535;

/// A number of texels.
pub fn texels(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "it must be a whole number of texels".into())
}

/// Steps of a shader through a parallax map.
pub fn iterations(text: &str) -> Result<NonZeroU32, String> {
    let steps = text.parse().ok().filter(|steps: &NonZeroU32| steps.get() <= 1000);
    steps.ok_or_else(|| "it must be a whole number from 1 to 1000".into())
}

/// A factor by which height maps are reduced.
pub fn shrink(text: &str) -> Result<NonZeroU32, String> {
    let factor = text.parse().ok().filter(|factor: &NonZeroU32| factor.get() <= 64);
    factor.ok_or_else(|| "it must be a whole number from 1 to 64".into())
}

/// An angle up to a right one.
pub fn degrees(text: &str) -> Result<f32, String> {
    let angle = text.parse().ok().filter(|angle| (0.0..=90.0).contains(angle));
    angle.ok_or_else(|| "it must be a number of degrees from 0 to 90".into())
}

/// The steps of FGED2 listing 7.9.
pub const USUAL_ITERATIONS: NonZeroU32 = NonZeroU32::new(4).unwrap();

fn wrong(parameter: &'static str, value: &str, range: &str) -> Error {
    Error::Parameter { parameter, value: value.into(), range: range.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn byte_sizes_are_powers_of_1024() {
        for (text, bytes) in
            [("1", 1), ("2k", 2048), ("512M", 512 << 20), ("4G", 4 << 30), ("4GiB", 4 << 30), ("1TB", 1 << 40)]
        {
            assert_eq!(text.parse::<ByteSize>().unwrap(), ByteSize(bytes), "{text}");
        }
        for text in ["", "0", "G", "4X", "-1", "1.5G", "4GG", "99999999T"] {
            assert!(text.parse::<ByteSize>().is_err(), "{text}");
        }
    }

    #[test]
    fn extents_are_two_lengths() {
        assert_eq!("2.0x1/2".parse::<Extent>().unwrap(), Extent([2.into(), "0.5".parse().unwrap()]));
        for text in ["", "2", "2x", "0x1", "1x-1", "1x1x1"] {
            assert!(text.parse::<Extent>().is_err(), "{text}");
        }
    }
}
