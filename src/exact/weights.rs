//! The weights of a blend as ratios of small integers.

use super::rational::{Rational, gcd};
use crate::error::{Error, Result};
use std::fmt;

/// Two weights over one denominator: base/q and detail/q.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Weights {
    /// Numerator of the first map's weight.
    pub base: i32,
    /// Numerator of the second map's weight.
    pub detail: i32,
    /// The denominator of both, at least 1.
    pub q: u32,
    /// Whether these are the weights that were asked for, or the nearest ones with parts of at most 65535.
    pub exact: bool,
}

/// Numerators and denominators stay at or below this, as those of a 16-bit mask do, so that every product of an exact
/// blend fits 160 bits.
const GREATEST_PART: i64 = 65_535;

impl Weights {
    /// The weights `base` and `detail`.
    ///
    /// Weights that need a part above 65535 become the nearest pair of ratios, with a common denominator, that does
    /// not, and [`Weights::exact`] says so.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a weight is above 65535 in magnitude.
    pub fn new(base: Rational, detail: Rational) -> Result<Self> {
        let of_q = |q: i64| [over(base, q), over(detail, q)];
        let fits = |q: i64| of_q(q).iter().all(|part| part.abs() <= GREATEST_PART.into());
        for weight in [base, detail] {
            if i128::from(weight.numerator()).abs() > i128::from(GREATEST_PART) * i128::from(weight.denominator()) {
                return Err(Error::parameter("weights", weight, "between -65535 and 65535"));
            }
        }
        let common = i128::from(base.denominator())
            / gcd(base.denominator() as u128, detail.denominator() as u128) as i128
            * i128::from(detail.denominator());
        let common = i64::try_from(common).ok().filter(|q| *q <= GREATEST_PART && fits(*q));
        let error = |q: i64| offset(base, q).max(offset(detail, q));
        let nearest = || (1..=GREATEST_PART).filter(|q| fits(*q)).min_by(|a, b| error(*a).total_cmp(&error(*b)));
        let q = common.or_else(nearest).unwrap_or(1);
        let [base, detail] = of_q(q).map(|part| part as i32);
        Ok(Self { base, detail, q: q as u32, exact: common.is_some() })
    }
}

/// The integer nearest to q times a weight.
fn over(weight: Rational, q: i64) -> i128 {
    let (n, d) = (i128::from(weight.numerator()), i128::from(weight.denominator()));
    (2 * n * i128::from(q) + d).div_euclid(2 * d)
}

/// How far off a weight is when it is written over q.
fn offset(weight: Rational, q: i64) -> f64 {
    let (n, d) = (i128::from(weight.numerator()), i128::from(weight.denominator()));
    let off = over(weight, q) * d - n * i128::from(q);
    off.unsigned_abs() as f64 / (d as f64 * q as f64)
}

impl fmt::Display for Weights {
    /// `1,-0.5`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [base, detail] =
            [self.base, self.detail].map(|part| Rational::new(part.into(), self.q.into()).unwrap_or(0.into()));
        write!(f, "{base},{detail}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(base: &str, detail: &str) -> Weights {
        Weights::new(base.parse().unwrap(), detail.parse().unwrap()).unwrap()
    }

    #[test]
    fn small_ratios_are_exact() {
        for (base, detail, parts) in [
            ("1", "-0.5", (2, -1, 2)),
            ("0.75", "0.25", (3, 1, 4)),
            ("1/3", "0.35", (20, 21, 60)),
            ("0", "0", (0, 0, 1)),
            ("65535", "1", (65535, 1, 1)),
            ("1/65535", "1", (1, 65535, 65535)),
        ] {
            let Weights { base: a, detail: b, q, exact } = weights(base, detail);
            assert_eq!(((a, b, q), exact), (parts, true), "{base} {detail}");
        }
    }

    #[test]
    fn long_numbers_become_the_nearest() {
        // Of all ratios with parts up to 65535 (a search in another language).
        let Weights { base, detail, q, exact } = weights("3.14159265358979", "0");
        assert_eq!((base, detail, q, exact), (65298, 0, 20785, false));
        assert!((f64::from(base) / f64::from(q) - std::f64::consts::PI).abs() < 1.6e-7);
        assert!(Weights::new(65536.into(), 1.into()).is_err());
        assert!(Weights::new(1.into(), (-65536).into()).is_err());
        assert!(Weights::new(1.into(), Rational::new(-131_071, 2).unwrap()).is_err());
    }
}
