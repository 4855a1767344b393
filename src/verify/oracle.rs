//! The formulas in whole numbers of any size: what each component is in real arithmetic.
//!
//! Nothing here is shared with the code that it judges but the options' types. Every input is a ratio of integers -
//! codes are, and floats are over 2^149 - and every formula is homogeneous, so that a component is A / sqrt(S).

use crate::exact::Rational;
use crate::map::{Channels, CodesRef, Convention, Depth, Edge, Encoding, HeightMap, Heights, NormalMap, TexelFormat};
use crate::ops::bake::{BakeOptions, Filter};
use crate::ops::blend::BlendMethod;
use num_bigint::{BigInt, Sign};
use std::fmt;

/// a / sqrt(s).
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Real {
    a: BigInt,
    s: BigInt,
}

/// A vector up to its length.
type Direction = [BigInt; 3];

impl Real {
    /// Component `channel` of a direction.
    fn of(direction: &Direction, channel: usize) -> Self {
        Self { a: direction[channel].clone(), s: square(direction) }
    }

    /// floor(factor a / sqrt(s)), and whether nothing was cut off.
    fn floor_times(&self, factor: &BigInt) -> (BigInt, bool) {
        let multiple = factor * &self.a;
        let squared = &multiple * &multiple;
        let root = (&squared / &self.s).sqrt();
        let is_whole = &root * &root * &self.s == squared;
        if multiple.sign() == Sign::Minus { (-root - u32::from(!is_whole), is_whole) } else { (root, is_whole) }
    }

    /// The stored bits of the nearest integer code, half up; `None` for floats.
    pub fn code(&self, format: TexelFormat) -> Option<u32> {
        let greatest = format.encoding.greatest_code(format.depth)?;
        // Twice the code before it is rounded: L v + L of unorm, 2 L v of the others.
        let (factor, offset) = match format.encoding {
            Encoding::Unorm => (greatest, greatest),
            _ => (2 * greatest, 0),
        };
        // floor((x + 1) / 2) = floor((floor(x) + 1) / 2).
        let doubled: BigInt = self.floor_times(&factor.into()).0 + offset;
        let code = i64::try_from((doubled + 1u32) >> 1).ok()?;
        let stored = if format.encoding == Encoding::Biased { code + i64::from(greatest) + 1 } else { code };
        let mask = if format.depth == Depth::Bits8 { 0xff } else { 0xffff };
        Some(stored as u32 & mask)
    }
}

impl fmt::Display for Real {
    /// Twelve digits after the point; `=` where they are all.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (digits, is_whole) = self.floor_times(&BigInt::from(10u64.pow(12)));
        let magnitude = digits.magnitude().to_string();
        let magnitude = format!("{magnitude:0>13}");
        let (whole, fraction) = magnitude.split_at(magnitude.len() - 12);
        let sign = if digits.sign() == Sign::Minus { "-" } else { "" };
        write!(f, "{sign}{whole}.{fraction}{}", if is_whole { " exactly" } else { "" })
    }
}

/// The component `channel` of the normal of a texel (FGED2 eq. 7.41 to 7.43).
pub(crate) fn normal(heights: &HeightMap, options: &BakeOptions, texel: usize, channel: usize) -> Option<Real> {
    let convention = options.normal.unwrap_or_default().convention;
    Some(Real::of(&direction(heights, options, convention, texel)?, channel))
}

/// n_z (2h - 1) of a texel (FGED2 section 7.7).
pub(crate) fn parallax(heights: &HeightMap, options: &BakeOptions, texel: usize) -> Option<Real> {
    let normal = direction(heights, options, Convention::Gl, texel)?;
    Some(parallax_of(&normal, heights, texel))
}

/// The same with the normal of another map.
pub(crate) fn parallax_with_normals(heights: &HeightMap, normals: &NormalMap, texel: usize) -> Option<Real> {
    let (normal, _) = read(normals, normals.format().convention, texel)?;
    Some(parallax_of(&normal, heights, texel))
}

/// The component `channel` of a blended normal (FGED2 eq. 7.46, 7.47; Blending in Detail); `None` where an input's
/// length is no ratio of integers and the method takes it for one.
pub(crate) fn blended(
    method: BlendMethod,
    maps: [(&NormalMap, usize); 2],
    mask: Option<(&HeightMap, usize)>,
    convention: Convention,
    channel: usize,
) -> Option<Real> {
    let [(first, one1), (second, one2)] =
        [read(maps[0].0, convention, maps[0].1)?, read(maps[1].0, convention, maps[1].1)?];
    // Over one common unit.
    let [first, second] = [first.map(|part| part * &one2), second.map(|part| part * &one1)];
    let one = one1 * one2;
    let [x1, y1, z1] = &first;
    let [x2, y2, z2] = &second;
    let sum = match method {
        BlendMethod::Weighted { base, detail } => weighted(ratio(base), ratio(detail), &first, &second),
        BlendMethod::Masked => {
            let (mask, texel) = mask?;
            let (t, greatest) = transition(mask, texel);
            weighted((&greatest - &t, greatest.clone()), (t, greatest.clone()), &first, &second)
        }
        BlendMethod::Linear => [x1 + x2, y1 + y2, z1 + z2],
        // v1 + v2 (1 - |v1|), times the unit.
        BlendMethod::Overlay => {
            [0, 1, 2].map(|axis| &one * &first[axis] + &second[axis] * (&one - magnitude(&first[axis])))
        }
        BlendMethod::Udn => [x1 + x2, y1 + y2, z1.clone()],
        BlendMethod::Whiteout => [&one * (x1 + x2), &one * (y1 + y2), z1 * z2],
        // t (t.u) / t_z - u with t = n1 + (0, 0, 1), u = (-x2, -y2, z2), times t_z and the unit squared.
        BlendMethod::Rnm => {
            let t = [x1.clone(), y1.clone(), z1 + &one];
            let u = [-x2, -y2, z2.clone()];
            let dot: BigInt = (0..3).map(|axis| &t[axis] * &u[axis]).sum();
            [0, 1, 2].map(|axis| &t[axis] * &dot - &u[axis] * &t[2] * &one)
        }
    };
    let is_nothing = sum.iter().all(|part| part.sign() == Sign::NoSign);
    let sum = if is_nothing { [0.into(), 0.into(), 1.into()] } else { sum };
    Some(Real::of(&sum, channel))
}

/// (a x1/z1 + b x2/z2, ..., 1), times both z and both denominators.
fn weighted((a, p): (BigInt, BigInt), (b, q): (BigInt, BigInt), v1: &Direction, v2: &Direction) -> Direction {
    let leaning = |axis: usize| &a * &q * &v1[axis] * &v2[2] + &b * &p * &v2[axis] * &v1[2];
    [leaning(0), leaning(1), &p * &q * &v1[2] * &v2[2]]
}

fn ratio(weight: Rational) -> (BigInt, BigInt) {
    (weight.numerator().into(), weight.denominator().into())
}

/// t of a texel over that of 1; a float mask is rounded to 16 bits first, half up.
fn transition(mask: &HeightMap, texel: usize) -> (BigInt, BigInt) {
    match mask.heights() {
        Heights::U8(codes) => (codes[texel].into(), 255.into()),
        Heights::U16(codes) => (codes[texel].into(), 65_535.into()),
        Heights::F32(heights) => {
            let twice = 2 * 65_535 * of_float(heights[texel].clamp(0.0, 1.0)) + float_unit();
            (twice / (2 * float_unit()), 65_535.into())
        }
    }
}

/// The normal of a texel of a height map. `None` if the scale is no ratio that this knows.
fn direction(heights: &HeightMap, options: &BakeOptions, convention: Convention, texel: usize) -> Option<Direction> {
    let size = heights.size();
    let scale = options.scale.resolve(size).ok()?;
    let (centre, outer) = match options.filter {
        Filter::Central => (1, 0),
        Filter::Sobel => (2, 1),
        Filter::Scharr => (10, 3),
        Filter::Prewitt => (1, 1),
    };
    let (x, y) = ((texel % size.width()) as i64, (texel / size.width()) as i64);
    let at = |dx: i64, dy: i64| {
        let column = beyond(options.edges.x, x + dx, size.width() as i64);
        let row = beyond(options.edges.y, y + dy, size.height() as i64);
        height(heights, (row * size.width() as i64 + column) as usize).0
    };
    let along_x = |dy: i64| at(1, dy) - at(-1, dy);
    let along_y = |dx: i64| at(dx, 1) - at(dx, -1);
    let sum = |along: &dyn Fn(i64) -> BigInt| -> BigInt { along(0) * centre + (along(-1) + along(1)) * outer };
    let divisor = 2 * (centre + 2 * outer);
    let one = height(heights, 0).1;
    let up = if convention == Convention::Gl { 1 } else { -1 };
    let leaning_x = -sum(&along_x) * scale.x;
    // Rows grow down; green up turns y around.
    let leaning_y = sum(&along_y) * scale.y * up;
    Some([leaning_x, leaning_y, one * divisor * scale.q])
}

/// n_z (2h - 1); heights beyond 0 and 1 count as 0 and 1.
fn parallax_of(normal: &Direction, heights: &HeightMap, texel: usize) -> Real {
    let (h, one) = height(heights, texel);
    let h = h.clamp(0.into(), one.clone());
    Real { a: &normal[2] * (2 * h - &one), s: square(normal) * &one * &one }
}

/// A height and what 1 is.
fn height(heights: &HeightMap, texel: usize) -> (BigInt, BigInt) {
    match heights.heights() {
        Heights::U8(codes) => (codes[texel].into(), 255.into()),
        Heights::U16(codes) => (codes[texel].into(), 65_535.into()),
        Heights::F32(heights) => (of_float(heights[texel]), float_unit()),
    }
}

/// The normal of a texel as it is stored, with green of `convention`, and what 1 is. `None` for a float map of two
/// channels, whose z is a root.
fn read(map: &NormalMap, convention: Convention, texel: usize) -> Option<(Direction, BigInt)> {
    let format = map.format();
    let at = texel * format.channels.count();
    let green = if format.convention == convention { 1 } else { -1 };
    let component = |channel: usize| -> BigInt {
        let stored = match map.codes() {
            CodesRef::U8(codes) => i64::from(codes[at + channel]),
            CodesRef::U16(codes) => codes[at + channel].into(),
            CodesRef::F16(codes) => return of_float(codes[at + channel].to_f32()),
            CodesRef::F32(codes) => return of_float(codes[at + channel]),
        };
        let greatest = i64::from(format.encoding.greatest_code(format.depth).unwrap_or(1));
        let signed = |code: i64| if code > greatest { code - 2 * (greatest + 1) } else { code };
        let u = match format.encoding {
            // The code that zero is written as reads as zero.
            Encoding::Unorm if stored == (greatest + 1) / 2 => 0,
            Encoding::Unorm => 2 * stored - greatest,
            Encoding::Biased => stored - greatest - 1,
            _ => signed(stored),
        };
        u.max(-greatest).into()
    };
    let [x, y] = [component(0), component(1)];
    let (z, one) = match (format.encoding.greatest_code(format.depth), format.channels) {
        (Some(greatest), Channels::Xyz) => (component(2).max(1.into()), greatest.into()),
        (Some(greatest), Channels::Xy) => {
            let rest = BigInt::from(greatest).pow(2) - &x * &x - &y * &y;
            (rest.max(1.into()).sqrt(), greatest.into())
        }
        // 2^-24.
        (None, Channels::Xyz) => (component(2).max(float_unit() >> 24), float_unit()),
        (None, Channels::Xy) => return None,
    };
    Some(([x, y * green, z], one))
}

/// f32 over 2^149, the least of them.
fn of_float(value: f32) -> BigInt {
    let bits = value.to_bits();
    let exponent = bits >> 23 & 0xff;
    let mantissa = BigInt::from(bits & 0x7f_ffff | u32::from(exponent > 0) << 23);
    let magnitude = mantissa << (exponent.max(1) - 1);
    if bits >> 31 == 1 { -magnitude } else { magnitude }
}

/// 1 over 2^149.
fn float_unit() -> BigInt {
    BigInt::from(1) << 149
}

fn beyond(edge: Edge, i: i64, n: i64) -> i64 {
    match edge {
        Edge::Wrap => (i + n) % n,
        Edge::Clamp => i.max(0).min(n - 1),
        // One texel beyond the first is the second, if there is one.
        Edge::Mirror if i < 0 => 1.min(n - 1),
        Edge::Mirror if i == n => (n - 2).max(0),
        Edge::Mirror => i,
    }
}

fn square(direction: &Direction) -> BigInt {
    direction.iter().map(|part| part * part).sum()
}

fn magnitude(number: &BigInt) -> BigInt {
    number.magnitude().clone().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::Scale;
    use crate::map::{Grid, NormalFormat};

    fn real(a: i64, s: i64) -> Real {
        Real { a: a.into(), s: s.into() }
    }

    #[test]
    fn numbers_print_as_they_are() {
        assert_eq!(real(2, 9).to_string(), "0.666666666666");
        assert_eq!(real(-3, 25).to_string(), "-0.600000000000 exactly");
        assert_eq!(real(-2, 9).to_string(), "-0.666666666667");
        assert_eq!(real(0, 4).to_string(), "0.000000000000 exactly");
    }

    #[test]
    fn known_fractions_have_known_codes() {
        let code = |a, s, encoding, depth| real(a, s).code(TexelFormat { encoding, depth, channels: 1 });
        // 212.5 and 42.5 round up.
        assert_eq!(code(2, 9, Encoding::Unorm, Depth::Bits8), Some(213));
        assert_eq!(code(-2, 9, Encoding::Unorm, Depth::Bits8), Some(43));
        assert_eq!(code(0, 1, Encoding::Unorm, Depth::Bits16), Some(32768));
        assert_eq!(code(-2, 9, Encoding::Snorm, Depth::Bits8), Some(171));
        assert_eq!(code(-2, 9, Encoding::Biased, Depth::Bits8), Some(43));
        assert_eq!(code(1, 1, Encoding::Float, Depth::Float32), None);
    }

    #[test]
    fn a_ramp_of_one_has_a_normal_of_45_degrees() {
        let heights = HeightMap::from(Grid::from_fn(3, 1, |x, _| 51 * x as u8).unwrap());
        let options = BakeOptions { scale: Scale::texels(5), ..Default::default() };
        let component = |channel| normal(&heights, &options, 1, channel).unwrap().to_string();
        assert_eq!([0, 1, 2].map(component), ["-0.707106781187", "0.000000000000 exactly", "0.707106781186"]);
    }

    #[test]
    fn floats_are_whole_over_their_unit() {
        assert_eq!(of_float(1.0), float_unit());
        assert_eq!(of_float(-0.75) * 4, float_unit() * -3);
        assert_eq!(of_float(f32::from_bits(1)), 1.into());
    }

    #[test]
    fn two_slopes_of_45_degrees_add_up() {
        let format = NormalFormat { encoding: Encoding::Snorm, ..Default::default() };
        let map = NormalMap::new(crate::map::Size::new(1, 1).unwrap(), format, crate::map::Codes::U8(vec![90, 0, 90]))
            .unwrap();
        let sum = blended(BlendMethod::add(), [(&map, 0); 2], None, Convention::Gl, 0).unwrap();
        // 2 / sqrt(5).
        assert_eq!(sum.to_string(), "0.894427190999");
    }
}
