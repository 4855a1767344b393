//! The scale of each axis as a ratio of small integers.

use super::rational::{Rational, gcd};
use crate::error::{Error, Result};
use crate::map::Size;
use std::fmt;
use std::num::NonZeroU32;

/// How high h = 1 is.
///
/// ```
/// use texbake::{Scale, Size};
///
/// let bricks = Scale::texels(24);
/// // A map of 2 m by 2 m whose heights span 10 cm has exactly one right normal map.
/// let measured = Scale::physical("2".parse()?, "2".parse()?, "0.1".parse()?);
/// let axes = measured.resolve(Size::new(1024, 1024)?)?;
/// assert_eq!((axes.x, axes.y, axes.q), (256, 256, 5)); // 51.2 texels
/// # let _ = bricks;
/// # Ok::<(), texbake::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Scale {
    /// In widths of one texel (FGED2 eq. 7.41: s); texels are square. Negative: heights are depths.
    Texels(Rational),
    /// In the unit in which the map's own size is given; texels need not be square.
    Physical {
        /// Width and height that the whole map covers, each above zero.
        size: [Rational; 2],
        /// Height of h = 1 in the same unit.
        depth: Rational,
    },
}

/// A scale resolved for one map: x/q and y/q texels on the two axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct AxisScale {
    /// Numerator of the scale along the rows.
    pub x: i32,
    /// Numerator of the scale down the rows.
    pub y: i32,
    /// The denominator of both, at least 1.
    pub q: u32,
    /// Whether this is the scale that was asked for, or the nearest one with parts below 2^24.
    pub exact: bool,
}

/// Numerators and denominators stay below 2^24, so that every product of an exact bake fits 128 bits (DESIGN 3.1).
const GREATEST_PART: i128 = (1 << 24) - 1;

/// Twice a part of a fraction times a small part fits 128 bits; only numbers of 16 digits and more come near.
const GREATEST_FRACTION: i128 = 1 << 100;

impl Default for Scale {
    /// One texel.
    fn default() -> Self {
        Self::texels(1)
    }
}

impl Scale {
    /// h = 1 is as high as `scale` texels are wide.
    pub fn texels(scale: impl Into<Rational>) -> Self {
        Self::Texels(scale.into())
    }

    /// h = 1 is `depth` high where the map is `width` by `height`, all in one unit.
    pub fn physical(width: Rational, height: Rational, depth: Rational) -> Self {
        Self::Physical { size: [width, height], depth }
    }

    /// The same heights over a map that was reduced by a whole factor, whose texels are wider by it.
    ///
    /// ```
    /// use texbake::Scale;
    ///
    /// let by_four = 4.try_into()?;
    /// assert_eq!(Scale::texels(24).shrunk(by_four)?, Scale::texels(6));
    /// let physical = Scale::physical(2.into(), 2.into(), "0.1".parse()?);
    /// assert_eq!(physical.shrunk(by_four)?, physical);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] for a scale with too many digits.
    pub fn shrunk(self, by: NonZeroU32) -> Result<Self> {
        let Self::Texels(scale) = self else { return Ok(self) };
        let below = scale.denominator().checked_mul(by.get().into());
        let shrunk = below.and_then(|below| Rational::new(scale.numerator(), below).ok());
        let too_long = || Error::parameter("scale", scale, format!("a number of fewer digits, with shrink {by}"));
        shrunk.map(Self::Texels).ok_or_else(too_long)
    }

    /// The same heights over a map of other sides with the same texels, of which one of size `from` was given.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a physical size with too many digits.
    #[cfg(feature = "cli")]
    pub(crate) fn over(self, from: Size, to: Size) -> Result<Self> {
        let Self::Physical { size: [width, height], depth } = self else { return Ok(self) };
        let side = |side: Rational, from: usize, to: usize| {
            let above = side.numerator().checked_mul(to as i64);
            let parts = above.zip(side.denominator().checked_mul(from as i64));
            let longer = parts.and_then(|(above, below)| Rational::new(above, below).ok());
            longer.ok_or_else(|| Error::parameter("size", side, "a number of fewer digits, with neighbours"))
        };
        Ok(Self::Physical {
            size: [side(width, from.width(), to.width())?, side(height, from.height(), to.height())?],
            depth,
        })
    }

    /// The scale of each axis for a map of this size, in texels.
    ///
    /// A number that needs a part of 2^24 or more becomes the nearest ratio that does not
    /// (for two different axes: the nearest with their common denominator), and [`AxisScale::exact`] says so.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a scale is 2^24 texels or more, or a physical size is not above zero.
    pub fn resolve(&self, size: Size) -> Result<AxisScale> {
        match self {
            Self::Texels(scale) => {
                let fraction = Fraction::new(scale.numerator().into(), scale.denominator().into())?;
                AxisScale::nearest(fraction, fraction)
            }
            Self::Physical { size: [width, height], depth } => {
                let x = texels_high(*depth, *width, size.width())?;
                let y = texels_high(*depth, *height, size.height())?;
                AxisScale::nearest(x, y)
            }
        }
    }
}

/// The height `depth` in texels, of which `count` cover the length `extent`.
fn texels_high(depth: Rational, extent: Rational, count: usize) -> Result<Fraction> {
    if extent.numerator() <= 0 {
        return Err(Error::parameter("size", extent, "above zero"));
    }
    let too_long = || Error::parameter("depth", depth, "a number of fewer digits, together with the size");
    let [dn, dd] = [depth.numerator(), depth.denominator()].map(i128::from);
    let [en, ed] = [extent.numerator(), extent.denominator()].map(i128::from);
    let above = dn.checked_mul(ed).and_then(|n| n.checked_mul(count as i128)).ok_or_else(too_long)?;
    let below = dd.checked_mul(en).ok_or_else(too_long)?;
    Fraction::new(above, below)
}

impl AxisScale {
    fn nearest(x: Fraction, y: Fraction) -> Result<Self> {
        for fraction in [x, y] {
            if fraction.n.abs() > GREATEST_PART * fraction.d {
                return Err(too_steep(fraction.n as f64 / fraction.d as f64));
            }
        }
        if x == y {
            let nearest = x.nearest_small();
            return Self::of(nearest.n, nearest.n, nearest.d, nearest == x);
        }
        let q = x.d / gcd(x.d as u128, y.d as u128) as i128;
        match q.checked_mul(y.d).filter(|q| *q <= GREATEST_PART) {
            Some(q) if x.times(q).abs() <= GREATEST_PART && y.times(q).abs() <= GREATEST_PART => {
                Self::of(x.times(q), y.times(q), q, true)
            }
            _ => Self::nearest_with_common_denominator(x, y),
        }
    }

    /// Both axes over the largest denominator that keeps both numerators small: each is off by at most 1/(2q).
    fn nearest_with_common_denominator(x: Fraction, y: Fraction) -> Result<Self> {
        let largest = |axis: Fraction| GREATEST_PART * axis.d / axis.n.abs().max(1);
        let q = largest(x).min(largest(y)).min(GREATEST_PART);
        Self::of(x.times(q), y.times(q), q, false)
    }

    fn of(x: i128, y: i128, q: i128, exact: bool) -> Result<Self> {
        let small = |part: i128| part.abs() <= GREATEST_PART;
        if !(small(x) && small(y) && small(q) && q > 0) {
            return Err(too_steep(format_args!("{x}/{q},{y}/{q}")));
        }
        Ok(Self { x: x as i32, y: y as i32, q: q as u32, exact })
    }
}

fn too_steep(scale: impl ToString) -> Error {
    Error::parameter("scale", scale, "between -16777215 and 16777215 texels")
}

impl fmt::Display for Scale {
    /// `7/3`, or `2 x 2 by 0.1 high`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Texels(scale) => scale.fmt(f),
            Self::Physical { size: [width, height], depth } => write!(f, "{width} x {height} by {depth} high"),
        }
    }
}

impl fmt::Display for AxisScale {
    /// `51.2`, or `51.2,25.6` for x and y.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = [self.x, self.y].map(|part| Rational::new(part.into(), self.q.into()).unwrap_or(0.into()));
        if x == y { x.fmt(f) } else { write!(f, "{x},{y}") }
    }
}

/// n / d in lowest terms, d at least 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Fraction {
    n: i128,
    d: i128,
}

impl Fraction {
    fn new(n: i128, d: i128) -> Result<Self> {
        let common = gcd(n.unsigned_abs(), d.unsigned_abs()) as i128;
        let (n, d) = (n / common, d / common);
        if n.abs() >= GREATEST_FRACTION || d >= GREATEST_FRACTION {
            return Err(Error::parameter("scale", format_args!("{n}/{d}"), "a number of fewer digits"));
        }
        Ok(Self { n, d })
    }

    /// The nearest integer to this times `factor`.
    fn times(self, factor: i128) -> i128 {
        (2 * self.n * factor + self.d).div_euclid(2 * self.d)
    }

    /// The nearest fraction whose parts are at most [`GREATEST_PART`].
    ///
    /// The continued fraction's last convergent within the bound, and the farthest step towards the next one,
    /// are the neighbours on either side (Hardy and Wright, chapter 10); the nearer of them is the answer.
    fn nearest_small(self) -> Self {
        let fits = |n: i128, d: i128| n <= GREATEST_PART && d <= GREATEST_PART;
        let (sign, target) = (self.n.signum(), Self { n: self.n.abs(), d: self.d });
        if fits(target.n, target.d) {
            return self;
        }
        let (mut before, mut last) = ((0, 1), (1, 0));
        let (mut n, mut d) = (target.n, target.d);
        let step = loop {
            let whole = n / d;
            let next = (before.0 + whole * last.0, before.1 + whole * last.1);
            if !fits(next.0, next.1) {
                let room = |before: i128, last: i128| if last == 0 { whole } else { (GREATEST_PART - before) / last };
                break room(before.0, last.0).min(room(before.1, last.1));
            }
            (before, last) = (last, next);
            (n, d) = (d, n % d);
        };
        let far = (before.0 + step * last.0, before.1 + step * last.1);
        let error = |(n, d): (i128, i128)| (n * target.d - target.n * d).abs();
        let far_is_nearer = last.1 == 0 || (far.1 != 0 && error(far) * last.1 < error(last) * far.1);
        let (n, d) = if far_is_nearer { far } else { last };
        Self { n: sign * n, d }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uniform(text: &str) -> Result<AxisScale> {
        Scale::Texels(text.parse()?).resolve(Size::new(512, 256)?)
    }

    #[test]
    fn small_ratios_are_kept() {
        for (text, x, q) in [("24", 24, 1), ("0.35", 7, 20), ("-7/3", -7, 3), ("0", 0, 1), ("1e6", 1_000_000, 1)] {
            assert_eq!(uniform(text).unwrap(), AxisScale { x, y: x, q, exact: true }, "{text}");
        }
    }

    #[test]
    fn a_long_number_becomes_the_nearest_ratio() {
        for text in ["3.14159265358979", "0.000000001", "-123456.789012345", "0.6180339887498949", "16777214.6"] {
            let wanted: Rational = text.parse().unwrap();
            let found = uniform(text).unwrap();
            assert!(!found.exact, "{text}");
            let error = |n: i128, q: i128| {
                let exact = i128::from(wanted.numerator());
                (n * i128::from(wanted.denominator()) - exact * q).unsigned_abs() as f64 / q as f64
            };
            let best = (1..=GREATEST_PART).fold(f64::INFINITY, |best, q| {
                let target = Fraction { n: wanted.numerator().into(), d: wanted.denominator().into() };
                let n = target.times(q);
                if n.abs() <= GREATEST_PART { best.min(error(n, q)) } else { best }
            });
            assert!(error(found.x.into(), found.q.into()) <= best, "{text}: {found:?}");
        }
    }

    #[test]
    fn physical_sizes_scale_each_axis() {
        let scale = Scale::physical(2.into(), 2.into(), "0.1".parse().unwrap());
        let axes = scale.resolve(Size::new(1024, 512).unwrap()).unwrap();
        assert_eq!(axes, AxisScale { x: 256, y: 128, q: 5, exact: true }); // 51.2 and 25.6 texels
    }

    #[test]
    fn incommensurable_axes_keep_24_bits() {
        let scale = Scale::physical("1.0000001".parse().unwrap(), "3.0000007".parse().unwrap(), 1.into());
        let axes = scale.resolve(Size::new(1000, 1000).unwrap()).unwrap();
        assert!(!axes.exact);
        let [x, y] = [axes.x, axes.y].map(|part| f64::from(part) / f64::from(axes.q));
        assert!((x / (1000.0 / 1.0000001) - 1.0).abs() < 1e-6, "{x}");
        assert!((y / (1000.0 / 3.0000007) - 1.0).abs() < 1e-6, "{y}");
    }

    #[test]
    fn out_of_range_is_an_error_that_says_so() {
        let error = uniform("16777216").unwrap_err().to_string();
        assert!(error.contains("scale is 16777216") && error.contains("16777215"), "{error}");
        let flat = Scale::physical(0.into(), 1.into(), 1.into());
        assert!(flat.resolve(Size::new(4, 4).unwrap()).unwrap_err().to_string().contains("above zero"));
    }
}
