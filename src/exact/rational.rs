//! Numbers as the user wrote them.

use crate::error::{Error, Result};
use std::fmt;
use std::str::FromStr;

/// An exact number: an integer, a decimal or a ratio, kept in lowest terms.
///
/// ```
/// use texbake::Rational;
///
/// assert_eq!("0.35".parse::<Rational>()?, "7/20".parse()?);
/// assert_eq!("1.5e-3".parse::<Rational>()?.to_string(), "0.0015");
/// assert!("one".parse::<Rational>().is_err());
/// # Ok::<(), texbake::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Rational {
    numerator: i64,
    denominator: i64,
}

/// 18 digits.
const MOST_DIGITS: u32 = 18;
const GREATEST_PART: i64 = 10i64.pow(MOST_DIGITS) - 1;

const RANGE: &str = "an integer, a decimal (0.35, 1e-3) or a ratio (7/3) of at most 18 digits";

impl Rational {
    /// `numerator / denominator`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the denominator is zero, or a part has more than 18 digits in lowest terms.
    pub fn new(numerator: i64, denominator: i64) -> Result<Self> {
        let fails = || Error::parameter("number", format_args!("{numerator}/{denominator}"), RANGE);
        if denominator == 0 || numerator == i64::MIN || denominator == i64::MIN {
            return Err(fails());
        }
        let common = gcd(numerator.unsigned_abs().into(), denominator.unsigned_abs().into()) as i64;
        let [numerator, denominator] = [numerator, denominator].map(|part| denominator.signum() * part / common);
        if [numerator, denominator].iter().any(|part| part.abs() > GREATEST_PART) {
            return Err(fails());
        }
        Ok(Self { numerator, denominator })
    }

    /// The part above the line; it carries the sign.
    pub fn numerator(self) -> i64 {
        self.numerator
    }

    /// The part below the line, at least 1.
    pub fn denominator(self) -> i64 {
        self.denominator
    }
}

impl From<i32> for Rational {
    fn from(integer: i32) -> Self {
        Self { numerator: integer.into(), denominator: 1 }
    }
}

impl TryFrom<f64> for Rational {
    type Error = Error;

    /// The shortest decimal that reads as `value`: 0.35 becomes 7/20, not the binary fraction beside it.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the value is not finite or needs more than 18 digits.
    fn try_from(value: f64) -> Result<Self> {
        format!("{value:e}").parse()
    }
}

impl FromStr for Rational {
    type Err = Error;

    /// # Errors
    /// [`Error::Parameter`] for anything but an integer, a decimal or a ratio of two of them.
    fn from_str(text: &str) -> Result<Self> {
        let fails = || Error::parameter("number", text, RANGE);
        let (above, below) = text.split_once('/').unwrap_or((text, "1"));
        let (a, b) = decimal(above.trim()).ok_or_else(fails)?;
        let (c, d) = decimal(below.trim()).ok_or_else(fails)?;
        let numerator = a.checked_mul(d).ok_or_else(fails)?;
        let denominator = b.checked_mul(c).ok_or_else(fails)?;
        if denominator == 0 {
            return Err(fails());
        }
        let common = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()) as i128;
        let part = |value: i128| i64::try_from(value / common).map_err(|_| fails());
        Self::new(part(numerator)?, part(denominator)?).map_err(|_| fails())
    }
}

/// A decimal as a fraction; `None` if it is none, or too long for 18 digits on either side of the line.
fn decimal(text: &str) -> Option<(i128, i128)> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (negative, unsigned) = match mantissa.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, mantissa.strip_prefix('+').unwrap_or(mantissa)),
    };
    let (whole, fraction) = unsigned.split_once('.').unwrap_or((unsigned, ""));
    let digits = [whole, fraction].concat();
    let only_digits = digits.bytes().all(|byte| byte.is_ascii_digit());
    if digits.is_empty() || !only_digits || digits.len() > MOST_DIGITS as usize {
        return None;
    }
    let magnitude: i128 = digits.parse().ok()?;
    let numerator = if negative { -magnitude } else { magnitude };
    let shift = exponent.checked_sub(fraction.len() as i32)?;
    let power = 10i128.checked_pow(shift.unsigned_abs()).filter(|_| shift.unsigned_abs() <= MOST_DIGITS)?;
    Some(if shift < 0 { (numerator, power) } else { (numerator * power, 1) })
}

/// Decimals of at most this many places and 18 digits are written as such; what is longer, or never ends, as a ratio.
const MOST_PLACES: u32 = 6;

impl fmt::Display for Rational {
    /// `24`, `0.35`, `-12.8`, or `7/3`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_decimal = |places: &u32| 10i64.pow(*places) % self.denominator == 0;
        let is_short = |places: &u32| {
            let parts = i128::from(self.numerator) * i128::from(10i64.pow(*places) / self.denominator);
            parts.abs() <= GREATEST_PART.into()
        };
        match (0..=MOST_PLACES).find(is_decimal).filter(is_short) {
            Some(0) => write!(f, "{}", self.numerator),
            Some(places) => {
                let unit = 10i128.pow(places);
                let parts = i128::from(self.numerator) * (unit / i128::from(self.denominator));
                let (sign, parts) = (if parts < 0 { "-" } else { "" }, parts.abs());
                write!(f, "{sign}{}.{:0width$}", parts / unit, parts % unit, width = places as usize)
            }
            None => write!(f, "{}/{}", self.numerator, self.denominator),
        }
    }
}

/// The greatest common divisor; of zero and n it is n.
pub(super) fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_integers_decimals_and_ratios_exactly() {
        for (text, numerator, denominator) in [
            ("24", 24, 1),
            ("-24", -24, 1),
            ("+3", 3, 1),
            ("0", 0, 1),
            ("-0.0", 0, 1),
            (".5", 1, 2),
            ("0.35", 7, 20),
            ("7/3", 7, 3),
            ("-7/21", -1, 3),
            ("7/-21", -1, 3),
            ("0.1/0.3", 1, 3),
            ("1e6", 1_000_000, 1),
            ("1.5e-3", 3, 2000),
            ("123456789012345678", 123_456_789_012_345_678, 1),
        ] {
            let number: Rational = text.parse().unwrap();
            assert_eq!((number.numerator(), number.denominator()), (numerator, denominator), "{text}");
        }
    }

    #[test]
    fn short_decimals_print_as_such_and_others_as_ratios() {
        for (text, printed) in [
            ("24", "24"),
            ("3/2", "1.5"),
            ("64/5", "12.8"),
            ("-0.1", "-0.1"),
            ("-1/16", "-0.0625"),
            ("1e-6", "0.000001"),
            ("1e-7", "1/10000000"),
            ("1/128", "1/128"),
            ("1/3", "1/3"),
            ("-7/6", "-7/6"),
            ("100", "100"),
            ("0", "0"),
            ("99999999999999999.5", "99999999999999999.5"),
        ] {
            let number: Rational = text.parse().unwrap();
            assert_eq!(number.to_string(), printed);
            assert_eq!(printed.parse::<Rational>().unwrap(), number, "{text}");
        }
    }

    #[test]
    fn refuses_what_is_no_number() {
        for text in ["", "-", ".", "1/0", "1/2/3", "0x10", "1e99", "nan", "inf", "1234567890123456789", "1 2", "--1"] {
            assert!(text.parse::<Rational>().is_err(), "{text:?}");
        }
        assert!(Rational::try_from(f64::NAN).is_err());
        assert!(Rational::new(1, 0).is_err());
    }

    #[test]
    fn floats_mean_their_shortest_decimal() {
        assert_eq!(Rational::try_from(0.35).unwrap(), Rational::new(7, 20).unwrap());
        assert_eq!(Rational::try_from(-24.0).unwrap(), Rational::from(-24));
    }
}
