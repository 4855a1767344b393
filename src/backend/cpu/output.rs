//! The last stages of every operation: planes of components become planes of codes, and these interleaved texels.

use super::plane::{BLOCK, LANES, Plane, padded};
use super::round::{Prove, Round, ToF16, ToF32, ToInteger};
use crate::exact::Radicand;
use crate::map::{CodesMut, TexelFormat};

/// Components a / sqrt(s), for as many a as there are channels.
pub(super) type Fraction<S = u128> = ([<S as Radicand>::Part; 3], S);

/// The codes of a map, texel after texel.
pub(super) trait Output<V, S: Radicand = u128> {
    /// Stores the next `count` texels. A component in doubt becomes what `exact` says for the texel of its index.
    fn store(&mut self, components: &[&Plane<V>], count: usize, exact: &dyn Fn(usize) -> Fraction<S>);
}

/// Room for texels whose components are floats as the reference computes them, or need be no better.
pub(super) fn written<'a>(format: TexelFormat, codes: CodesMut<'a>) -> Box<dyn Output<f32> + 'a> {
    match codes {
        CodesMut::U8(codes) => of_channels(format, Written(ToInteger::<u8>::new(format)), codes),
        CodesMut::U16(codes) => of_channels(format, Written(ToInteger::<u16>::new(format)), codes),
        CodesMut::F16(codes) => of_channels(format, Written(ToF16), codes),
        CodesMut::F32(codes) => of_channels(format, Written(ToF32), codes),
    }
}

/// Floats whose error can be told from the distance between codes.
pub(super) trait Proving: Copy + Default {
    /// Room for texels whose components are estimates, off by 13e at most (see [`super::real`]).
    fn proved<'a, S: Radicand + 'a>(format: TexelFormat, codes: CodesMut<'a>) -> Box<dyn Output<Self, S> + 'a>;
}

impl Proving for f32 {
    fn proved<'a, S: Radicand + 'a>(format: TexelFormat, codes: CodesMut<'a>) -> Box<dyn Output<f32, S> + 'a> {
        match codes {
            CodesMut::U8(codes) => of_channels(format, Proved(ToInteger::<u8>::new(format)), codes),
            _ => unreachable!("f32 is for codes of 8 bits"),
        }
    }
}

impl Proving for f64 {
    fn proved<'a, S: Radicand + 'a>(format: TexelFormat, codes: CodesMut<'a>) -> Box<dyn Output<f64, S> + 'a> {
        match codes {
            CodesMut::U8(codes) => of_channels(format, Proved(ToInteger::<u8>::new(format)), codes),
            CodesMut::U16(codes) => of_channels(format, Proved(ToInteger::<u16>::new(format)), codes),
            CodesMut::F16(codes) => of_channels(format, Proved(ToF16), codes),
            CodesMut::F32(codes) => of_channels(format, Proved(ToF32), codes),
        }
    }
}

/// From a component to its code, which may be in doubt.
trait Rule<V> {
    type Code: Copy + Default;

    fn code(&self, component: V) -> (Self::Code, bool);

    /// The code of `a / sqrt(s)`.
    fn exact<S: Radicand>(&self, a: S::Part, s: S) -> Self::Code;
}

struct Written<R>(R);

struct Proved<R>(R);

impl<R: Round> Rule<f32> for Written<R> {
    type Code = R::Code;

    #[inline(always)]
    fn code(&self, component: f32) -> (R::Code, bool) {
        (self.0.code(component), false)
    }

    fn exact<S: Radicand>(&self, _: S::Part, _: S) -> R::Code {
        unreachable!("written floats have no doubts")
    }
}

impl<V, R: Prove<V>> Rule<V> for Proved<R> {
    type Code = R::Code;

    #[inline(always)]
    fn code(&self, component: V) -> (R::Code, bool) {
        self.0.code_or_doubt(component)
    }

    #[cold]
    fn exact<S: Radicand>(&self, a: S::Part, s: S) -> R::Code {
        self.0.exact(a, s)
    }
}

fn of_channels<'a, V: Copy, S: Radicand + 'a, R: Rule<V> + 'a>(
    format: TexelFormat,
    rule: R,
    codes: &'a mut [R::Code],
) -> Box<dyn Output<V, S> + 'a> {
    match format.channels {
        1 => Box::new(Texels::<S, R, R::Code, 1>::new(rule, codes)),
        2 => Box::new(Texels::<S, R, R::Code, 2>::new(rule, codes)),
        _ => Box::new(Texels::<S, R, R::Code, 3>::new(rule, codes)),
    }
}

/// Texels of N codes, and scratch for one block of them.
struct Texels<'a, S: Radicand, R, C, const N: usize> {
    rule: R,
    /// Those to come.
    codes: &'a mut [C],
    planes: [Plane<C>; N],
    doubts: Plane<bool>,
    /// What was in doubt last, and its codes.
    mended: Option<(Fraction<S>, [C; N])>,
}

impl<'a, S: Radicand, R, C: Copy + Default, const N: usize> Texels<'a, S, R, C, N> {
    fn new(rule: R, codes: &'a mut [C]) -> Self {
        Self { rule, codes, planes: [[C::default(); BLOCK]; N], doubts: [false; BLOCK], mended: None }
    }
}

impl<V: Copy, S: Radicand, R: Rule<V>, const N: usize> Output<V, S> for Texels<'_, S, R, R::Code, N> {
    fn store(&mut self, components: &[&Plane<V>], count: usize, exact: &dyn Fn(usize) -> Fraction<S>) {
        let components = components.first_chunk().expect("a component for each channel");
        codes_or_doubts(&self.rule, components, &mut self.planes, &mut self.doubts, padded(count));
        self.mend(count, exact);
        let (texels, rest) = std::mem::take(&mut self.codes).split_at_mut(count * N);
        interleave(&self.planes, texels);
        self.codes = rest;
    }
}

impl<C: Copy, S: Radicand, R, const N: usize> Texels<'_, S, R, C, N> {
    /// The exact codes of the texels in doubt.
    fn mend<V>(&mut self, count: usize, exact: &dyn Fn(usize) -> Fraction<S>)
    where
        R: Rule<V, Code = C>,
    {
        for group in (0..count).step_by(LANES) {
            if self.doubts[group..][..LANES].iter().fold(false, |any, doubt| any | doubt) {
                let in_doubt = |at: &usize| self.doubts[*at];
                for at in (group..(group + LANES).min(count)).filter(in_doubt) {
                    let fraction = exact(at);
                    // On a plane every texel may lie on the same tie.
                    let codes = match self.mended {
                        Some((mended, codes)) if mended == fraction => codes,
                        _ => std::array::from_fn(|channel| self.rule.exact(fraction.0[channel], fraction.1)),
                    };
                    self.mended = Some((fraction, codes));
                    self.planes.iter_mut().zip(codes).for_each(|(plane, code)| plane[at] = code);
                }
            }
        }
    }
}

vectorised! {
    fn codes_or_doubts<V: Copy, R: Rule<V>, const N: usize>(
        rule: &R,
        components: &[&Plane<V>; N],
        codes: &mut [Plane<R::Code>; N],
        doubts: &mut Plane<bool>,
        count: usize,
    ) {
        for i in 0..count.min(BLOCK) {
            let mut any = false;
            for channel in 0..N {
                let (code, doubt) = rule.code(components[channel][i]);
                codes[channel][i] = code;
                any |= doubt;
            }
            doubts[i] = any;
        }
    }
}

vectorised! {
    fn interleave<C: Copy, const N: usize>(codes: &[Plane<C>; N], texels: &mut [C]) {
        let texels = texels.as_chunks_mut::<N>().0;
        let count = texels.len().min(BLOCK);
        let codes = codes.each_ref();
        for i in 0..count {
            let mut texel = [codes[0][i]; N];
            for channel in 1..N {
                texel[channel] = codes[channel][i];
            }
            texels[i] = texel;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::real::{Real, unit};
    use super::*;
    use crate::exact::CodeRounding;
    use crate::map::{Depth, Encoding};
    use std::fmt::Debug;

    /// Believes every estimate, as a bound of zero would.
    struct Trusting<R>(R);

    impl<V, R: Prove<V>> Rule<V> for Trusting<R> {
        type Code = R::Code;

        fn code(&self, component: V) -> (R::Code, bool) {
            (self.0.code_or_doubt(component).0, false)
        }

        fn exact<S: Radicand>(&self, _: S::Part, _: S) -> R::Code {
            unreachable!("it has no doubts")
        }
    }

    /// Normals of which a component lies half-way between two codes: Pythagorean quadruples.
    fn ties(greatest: i32) -> Vec<[i32; 3]> {
        let quadruple = |[x, y, z]: [i32; 3]| {
            let length = f64::from(x * x + y * y + z * z).sqrt() as i32;
            let is_whole = length * length == x * x + y * y + z * z;
            is_whole && (greatest * x) % length == 0 && (greatest * x / length) % 2 == 0
        };
        let normals = (1..60).flat_map(|x| (0..60).flat_map(move |y| (1..60).map(move |z| [x, y, z])));
        normals.filter(|normal| quadruple(*normal)).take(BLOCK).collect()
    }

    fn stored<V: Real, R: Rule<V>>(rule: R, normals: &[[i32; 3]]) -> Vec<R::Code> {
        let mut planes = [[V::default(); BLOCK]; 3];
        for (at, [x, y, z]) in normals.iter().enumerate() {
            let components = unit([V::of_integer(*x), V::of_integer(*y), V::of_integer(*z)]);
            planes.iter_mut().zip(components).for_each(|(plane, component)| plane[at] = component);
        }
        let exact = |at: usize| {
            let [x, y, z] = normals[at];
            ([x.into(), y.into(), z.into()], (x * x + y * y + z * z) as u128)
        };
        let mut codes = vec![R::Code::default(); 3 * normals.len()];
        let [x, y, z] = &planes;
        Texels::<u128, R, R::Code, 3>::new(rule, &mut codes).store(&[x, y, z], normals.len(), &exact);
        codes
    }

    fn assert_doubts_matter<V: Real, C: Copy + Default + Debug + PartialEq + TryFrom<u32>>(depth: Depth)
    where
        ToInteger<C>: Prove<V, Code = C>,
    {
        let format = TexelFormat { encoding: Encoding::Unorm, depth, channels: 3 };
        let rounding = CodeRounding::new(format).unwrap();
        let normals = ties(rounding.greatest);
        let codes_of = |[x, y, z]: [i32; 3]| {
            let s = (x * x + y * y + z * z) as u128;
            [x, y, z].map(|part| C::try_from(rounding.code(part.into(), s)).ok().unwrap())
        };
        let expected: Vec<C> = normals.iter().flat_map(|normal| codes_of(*normal)).collect();
        assert!(normals.len() > 50, "{}", normals.len());
        assert_eq!(stored::<V, _>(Proved(ToInteger::<C>::new(format)), &normals), expected);
        assert_ne!(stored::<V, _>(Trusting(ToInteger::<C>::new(format)), &normals), expected);
    }

    #[test]
    fn without_doubts_ties_would_be_wrong() {
        assert_doubts_matter::<f32, u8>(Depth::Bits8);
        assert_doubts_matter::<f64, u8>(Depth::Bits8);
        assert_doubts_matter::<f64, u16>(Depth::Bits16);
    }
}
