//! Scales of many digits, resolved in 128 bits, against integers of any size.

use crate::support::Random;
use num_bigint::BigInt;
use num_traits::Signed;
use texbake::{AxisScale, Error, Rational, Scale, Size};

const GREATEST_PART: i64 = (1 << 24) - 1;

/// Parts of a scale below this are never refused.
const LEAST_REFUSED: u32 = 100;

fn number(text: &str) -> Rational {
    text.parse().expect("a number")
}

/// A fraction of integers of any size; the lower part is above zero.
struct Fraction {
    n: BigInt,
    d: BigInt,
}

/// The height `depth` in texels, of which `count` cover `extent`.
fn texels_high(depth: Rational, extent: Rational, count: usize) -> Fraction {
    Fraction {
        n: BigInt::from(depth.numerator()) * extent.denominator() * count,
        d: BigInt::from(depth.denominator()) * extent.numerator(),
    }
}

impl Fraction {
    fn is_too_steep(&self) -> bool {
        self.n.abs() > &self.d * GREATEST_PART
    }

    fn may_be_refused(&self) -> bool {
        let limit = BigInt::from(1) << LEAST_REFUSED;
        self.is_too_steep() || self.n.abs() >= limit || self.d >= limit
    }

    /// Whether no denominator above `q` leaves the numerator small.
    fn allows_no_more_than(&self, q: u32) -> bool {
        self.n.abs() * (i64::from(q) + 1) > &self.d * GREATEST_PART
    }

    /// q d times the distance to `part / q`.
    fn distance(&self, part: i32, q: u32) -> BigInt {
        (&self.n * q - &self.d * part).abs()
    }
}

/// The resolved scale is one that an exact bake can use, and as near as it must be.
fn assert_near(what: &str, found: AxisScale, [x, y]: [&Fraction; 2]) {
    let AxisScale { x: px, y: py, q, exact } = found;
    let small = |part: i64| part.abs() <= GREATEST_PART;
    assert!(small(px.into()) && small(py.into()) && small(q.into()) && q > 0, "{what}: {found:?}");
    let distances = [x.distance(px, q), y.distance(py, q)];
    if exact {
        assert!(distances.iter().all(|distance| *distance == BigInt::from(0)), "{what}: {found:?}");
    } else if &x.n * &y.d == &y.n * &x.d {
        // Neighbours a/b and c/d among the fractions of small parts are 1/(bd) apart, and one of the sums a + c and
        // b + d is too large: the nearer is within t^2/(2 GREATEST_PART), or 1/(2 GREATEST_PART) for t below 1.
        let ceiling = x.n.abs() / &x.d + 1;
        assert!(&distances[0] * 2 * GREATEST_PART <= &ceiling * &ceiling * &x.d * q, "{what}: {found:?}");
    } else {
        // Each numerator is rounded, over the largest denominator that there is room for.
        assert!(&distances[0] * 2 <= x.d && &distances[1] * 2 <= y.d, "{what}: {found:?}");
        let largest = i64::from(q) == GREATEST_PART || x.allows_no_more_than(q) || y.allows_no_more_than(q);
        assert!(largest, "{what}: {found:?}");
    }
}

/// Whether the scale resolves; if so, to a good one, and if not, for a reason.
fn resolves([width, height, depth]: [Rational; 3], [columns, rows]: [usize; 2]) -> bool {
    let what = format!("{columns} x {rows} texels, {width} x {height} by {depth}");
    let scales = [texels_high(depth, width, columns), texels_high(depth, height, rows)];
    match Scale::physical(width, height, depth).resolve(Size::new(columns, rows).expect("a size")) {
        Ok(found) => {
            assert_near(&what, found, scales.each_ref());
            true
        }
        Err(error) => {
            assert!(matches!(error, Error::Parameter { .. }), "{what}: {error:?}");
            assert!(scales.iter().any(Fraction::may_be_refused), "{what}: {error}");
            false
        }
    }
}

#[test]
fn the_steeper_axis_bounds_the_denominator_whatever_the_digits() {
    let lengths = ["1.00000000000000003", "3.00000000000000007", ".99999999999999989"].map(number);
    assert!(resolves(lengths, [1025, 513]));
}

#[test]
fn no_more_than_the_greatest_numerator() {
    let resolve = |depth| Scale::physical(1.into(), 3.into(), number(depth)).resolve(Size::new(1, 1).expect("a size"));
    let axes = resolve("16777215").expect("a scale");
    assert_eq!((axes.x, axes.y, axes.q, axes.exact), (16_777_215, 5_592_405, 1, true));
    let error = resolve("16777215.6").expect_err("too steep").to_string();
    assert_eq!(error, "scale is 16777215.6: it must be between -16777215 and 16777215 texels");
}

/// A decimal above zero of 1 to `digits` digits, its point anywhere among them or a little beside.
fn decimal(random: &mut Random, digits: u64) -> Rational {
    let count = 1 + random.below(digits);
    let value = 1 + random.below(10u64.pow(count as u32) - 1);
    let exponent = random.below(count + 3) as i64 - count as i64 - 1;
    // Nine times in ten a number of 18 digits and a zero more is no number; then there is another.
    format!("{value}e{exponent}").parse().unwrap_or_else(|_| decimal(random, digits))
}

fn negative(number: Rational) -> Rational {
    Rational::new(-number.numerator(), number.denominator()).expect("a number")
}

#[test]
fn every_physical_scale_resolves_or_is_refused() {
    let count = |random: &mut Random| 1 + random.any_magnitude(65535).unsigned_abs() as usize;
    let mut random = Random::new(11);
    let mut resolved = 0;
    for round in 0..200_000 {
        // All digits there can be, and as many as people write.
        let digits = if round % 2 == 0 { 18 } else { 8 };
        let [width, height, depth] = [(); 3].map(|()| decimal(&mut random, digits));
        let height = if round % 5 == 0 { width } else { height };
        let depth = if round % 3 == 0 { negative(depth) } else { depth };
        let columns = count(&mut random);
        let rows = if round % 10 == 0 { columns } else { count(&mut random) };
        resolved += u32::from(resolves([width, height, depth], [columns, rows]));
    }
    assert!(resolved > 100_000, "only {resolved} scales were compared");
}
