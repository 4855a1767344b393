//! A function of the library under examination: its twin and every device beside an oracle in f64.

use super::real::{self, Real};
#[cfg(feature = "gpu")]
use crate::support::{Call, ShaderFunction, Texels};
use texbake::shading::LIBRARY;

/// A function with `A` floats for its arguments, which gives `N`.
pub struct Examined<'a, const A: usize, const N: usize> {
    /// The file.
    pub file: &'static str,
    /// See [`ShaderFunction::call`].
    pub call: &'static str,
    pub twin: &'a dyn Fn([f32; A]) -> [f32; N],
    /// The oracle.
    pub exact: &'a dyn Fn([f64; A]) -> [f64; N],
    /// The order of operations: how far off they may be, and not what they give, is taken from it.
    pub formula: &'a dyn Fn([Real; A]) -> [Real; N],
    pub arguments: Vec<[f32; A]>,
    #[cfg(feature = "gpu")]
    pub texture: Option<&'a Texels>,
}

pub fn text_of(file: &str) -> &'static str {
    LIBRARY.iter().find(|it| it.name == file).expect("a file of the library").wgsl
}

impl<const A: usize, const N: usize> Examined<'_, A, N> {
    /// The twin and every device are within their bounds of the oracle.
    pub fn assert(&self) {
        assert!(self.arguments.len() >= 10);
        for arguments in &self.arguments {
            let (exact, bounds) = self.expected(*arguments, real::CPU);
            let got = (self.twin)(*arguments);
            for ((got, exact), bound) in got.into_iter().zip(exact).zip(bounds) {
                let off = (f64::from(got) - exact).abs();
                let is_within = off <= bound + 1e-14 * exact.abs();
                assert!(is_within, "{}: {arguments:?}: got {got:e}, exactly {exact:e}, {off:e} > {bound:e}", self.call);
            }
        }
        #[cfg(feature = "gpu")]
        self.function(text_of(self.file)).assert_on_every_device(&self.calls(), 0);
    }

    /// The oracle's answer, and how far f32 may be from it.
    fn expected(&self, arguments: [f32; A], by: real::Roundings) -> ([f64; N], [f64; N]) {
        let exact = (self.exact)(arguments.map(f64::from));
        let formula = (self.formula)(arguments.map(|part| Real::given(by, part)));
        for (exact, formula) in exact.iter().zip(formula) {
            // And what f64 is off by.
            let is_one = (exact - formula.value).abs() <= formula.error + 1e-12 * (1.0 + exact.abs());
            assert!(is_one && formula.error.is_finite(), "{}: {arguments:?}: {exact:e}, {formula:?}", self.call);
        }
        (exact, formula.map(|part| part.error))
    }

    #[cfg(feature = "gpu")]
    fn function<'a>(&'a self, wgsl: &'a str) -> ShaderFunction<'a> {
        ShaderFunction { wgsl, call: self.call, texture: self.texture }
    }

    #[cfg(feature = "gpu")]
    fn calls(&self) -> Vec<Call<A, N>> {
        let call = |arguments: &[f32; A]| {
            let (exact, bounds) = self.expected(*arguments, real::DEVICE);
            let expected = exact.map(|part| part as f32);
            // The expected float is half of one off, its difference is rounded, and what is lost below 2^-126 is no error.
            let slack = |at: usize| bounds[at] * 1.000_001 + exact[at].abs() / f64::from(1 << 23) + 1e-37;
            Call { arguments: *arguments, expected, bounds: std::array::from_fn(|at| slack(at) as f32) }
        };
        self.arguments.iter().map(call).collect()
    }

    /// Each text that is changed so fails on every device.
    #[cfg(feature = "gpu")]
    pub fn notices(&self, changes: &[(&str, &str)]) {
        let text = text_of(self.file);
        let calls = self.calls();
        for (from, to) in changes {
            assert!(text.contains(from), "{}: no {from:?}", self.file);
            let changed = text.replacen(from, to, 1);
            for (name, comparison) in self.function(&changed).on_every_device(&calls, 0) {
                assert!(comparison.differing > 0, "{name}: {}: {from:?} to {to:?}", self.call);
            }
        }
    }

    #[cfg(not(feature = "gpu"))]
    pub fn notices(&self, _: &[(&str, &str)]) {}
}

/// Numbers in [-1, 1) that repeat.
pub fn reals(seed: u64) -> impl FnMut() -> f64 {
    let mut random = crate::support::Random::new(seed);
    move || random.below(1 << 20) as f64 / f64::from(1 << 19) - 1.0
}

/// A direction of length one in f32, anywhere but within `lowest` of the plane z = 0 or below.
pub fn above(real: &mut impl FnMut() -> f64, lowest: f64) -> [f32; 3] {
    loop {
        let v = [real(), real(), real()];
        let length = v.iter().map(|part| part * part).sum::<f64>().sqrt();
        let v = v.map(|part| part / length);
        if length > 0.1 && v[2] > lowest {
            return v.map(|part| part as f32);
        }
    }
}

pub mod f64s {
    //! Vectors of f64.

    pub type Vector = [f64; 3];

    pub fn dot(a: Vector, b: Vector) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    pub fn cross(a: Vector, b: Vector) -> Vector {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    pub fn length(a: Vector) -> f64 {
        dot(a, a).sqrt()
    }

    pub fn times(factor: f64, a: Vector) -> Vector {
        a.map(|part| factor * part)
    }

    pub fn normalized(a: Vector) -> Vector {
        times(1.0 / length(a), a)
    }

    /// In degrees.
    pub fn angle(a: Vector, b: Vector) -> f64 {
        length(cross(a, b)).atan2(dot(a, b)).to_degrees()
    }

    /// The x with rows . x = right, by Gaussian elimination with the greatest pivots.
    pub fn solve(mut rows: [Vector; 3], mut right: Vector) -> Vector {
        for step in 0..3 {
            let pivot = (step..3).max_by(|a, b| rows[*a][step].abs().total_cmp(&rows[*b][step].abs())).unwrap();
            rows.swap(step, pivot);
            right.swap(step, pivot);
            for row in (0..3).filter(|row| *row != step) {
                let factor = rows[row][step] / rows[step][step];
                rows[row] = std::array::from_fn(|column| rows[row][column] - factor * rows[step][column]);
                right[row] -= factor * right[step];
            }
        }
        std::array::from_fn(|step| right[step] / rows[step][step])
    }
}
