//! How far off a formula in f32 may be: running error analysis (Higham, Accuracy and Stability of Numerical Algorithms,
//! section 3.3).
//!
//! A `Real` is what an operation gives in f64, with a bound of how far the same operation is off in f32, its operands
//! being as far off as they may be. The bound holds for products and sums that are fused, too: a rounding less.

use std::ops::{Add, Div, Mul, Neg, Sub};

const U: f64 = 1.0 / (1 << 24) as f64;

/// How far operations are off, in u = 2^-24 of their result.
#[derive(Debug, Clone, Copy)]
pub struct Roundings {
    /// + - *
    plain: f64,
    division: f64,
    root: f64,
    /// One over a root.
    inverse_root: f64,
    /// A logarithm: an error in u, not of the result, where the argument is between 1/2 and 2.
    logarithm: f64,
    exponential: f64,
    /// The place between two texels that a texture unit knows, in texels.
    subtexel: f64,
}

/// The nearest float; `powf` is off by one ULP; the textures of the tests are filtered in f64.
pub const CPU: Roundings = Roundings {
    plain: 1.0,
    division: 1.0,
    root: 1.0,
    inverse_root: 2.0,
    logarithm: 0.0,
    exponential: 2.0,
    subtexel: 0.0,
};

/// What WGSL asks for: either neighbour, so 2 u, of + - *; 2.5 ULP of a division, 2 ULP of inverseSqrt, a root as one
/// over that; 2^-21 of a logarithm near 1 and 3 ULP elsewhere; 3 + 2 |x| ULP of an exponential. Texture units have 8 bits
/// between two texels, and may cut off the rest.
#[cfg(feature = "gpu")]
pub const DEVICE: Roundings = Roundings {
    plain: 2.0,
    division: 5.0,
    root: 9.0,
    inverse_root: 4.0,
    logarithm: 8.0,
    exponential: 6.0,
    subtexel: 1.0 / 256.0,
};

#[derive(Debug, Clone, Copy)]
pub struct Real {
    pub value: f64,
    /// At most.
    pub error: f64,
    by: Roundings,
}

impl Real {
    /// A float as it is given.
    pub fn given(by: Roundings, value: f32) -> Self {
        Self { value: value.into(), error: 0.0, by }
    }

    /// A constant beside it.
    pub fn constant(self, value: f64) -> Self {
        Self { value, error: 0.0, ..self }
    }

    /// The result of an operation: so many u of it are added to what the operands are off by.
    fn rounded(self, value: f64, inherited: f64, roundings: f64) -> Self {
        Self { value, error: inherited + roundings * U * (value.abs() + inherited), by: self.by }
    }

    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let low = (self.value - self.error).max(0.0).sqrt();
        let inherited = (root - low).max((self.value + self.error).sqrt() - root);
        self.rounded(root, inherited, self.by.root)
    }

    pub fn inverse_sqrt(self) -> Self {
        let inverse = 1.0 / self.value.sqrt();
        let inherited = 1.0 / (self.value - self.error).max(0.0).sqrt() - inverse;
        self.rounded(inverse, inherited, self.by.inverse_root)
    }

    pub fn max(self, other: Self) -> Self {
        Self { value: self.value.max(other.value), error: self.error.max(other.error), ..self }
    }

    pub fn min(self, other: Self) -> Self {
        -(-self).max(-other)
    }

    /// For a base in [0, 1] that is not next to 0: exp2(exponent log2(base)).
    pub fn powf(self, exponent: Self) -> Self {
        let power = self.value.powf(exponent.value);
        let low = (self.value - self.error).max(0.0).powf(exponent.value);
        let high = (self.value + self.error).powf(exponent.value);
        let log = self.value.log2().abs().max(if self.by.logarithm > 0.0 { 1.0 } else { 0.0 });
        let in_exponent = exponent.value * (self.by.logarithm + self.by.plain) * U * log * std::f64::consts::LN_2;
        let inherited = (power - low).max(high - power) + power * in_exponent.exp_m1();
        let roundings = self.by.exponential + if self.by.logarithm > 0.0 { 4.0 * (exponent.value * log) } else { 0.0 };
        self.rounded(power, inherited, roundings)
    }

    /// What a texture gives at a place that is off, in texels, by so much: `value` there, the greatest differences between
    /// texels next to each other along both axes, and the greatest texel.
    pub fn sampled(self, value: f64, off: [f64; 2], steepest: [f64; 2], greatest: f64) -> Self {
        let moved: f64 = off.iter().zip(steepest).map(|(off, steepest)| (off + self.by.subtexel) * steepest).sum();
        // Weights, products and sums.
        Self { value, error: moved + 8.0 * self.by.plain * U * greatest, ..self }
    }

    /// Whether its sign is sure.
    pub fn is_clear(self) -> bool {
        self.value.abs() > self.error
    }
}

impl Add for Real {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.rounded(self.value + other.value, self.error + other.error, self.by.plain)
    }
}

impl Sub for Real {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Real {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let inherited = self.value.abs() * other.error + other.value.abs() * self.error + self.error * other.error;
        self.rounded(self.value * other.value, inherited, self.by.plain)
    }
}

impl Div for Real {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let inherited = match other.is_clear() {
            true => (self.error + quotient.abs() * other.error) / (other.value.abs() - other.error),
            false => f64::INFINITY,
        };
        self.rounded(quotient, inherited, self.by.division)
    }
}

impl Neg for Real {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

pub fn dot(a: [Real; 3], b: [Real; 3]) -> Real {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: [Real; 3], b: [Real; 3]) -> [Real; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn times<const N: usize>(factor: Real, v: [Real; N]) -> [Real; N] {
    v.map(|part| factor * part)
}

pub fn add(a: [Real; 3], b: [Real; 3]) -> [Real; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The parts over the length, as WGSL has it; with a product more where one over the length is multiplied by.
pub fn normalized(v: [Real; 3]) -> [Real; 3] {
    let length = dot(v, v).sqrt();
    v.map(|part| part / length * length.constant(1.0))
}
