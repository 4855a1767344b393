//! Blends and parallax maps where a map holds floats: f32, one rounding for each operation, in the order given here.

use super::texels::{UnormZero, normals};
use crate::support::{Format, Image};
use half::f16;
use texbake::{
    BlendInputs, BlendMethod, BlendOptions, Channels, CodesRef, Convention, Depth, Encoding, HeightMap, Heights,
    NormalMap, ParallaxFormat, Rational,
};

/// The blend of two maps of one size, one of them of floats.
pub fn float_blend(inputs: &BlendInputs<&NormalMap, &HeightMap>, options: &BlendOptions) -> Image {
    let [base, detail] = [inputs.base, inputs.detail].map(|map| float_normals(map, options.format.convention));
    let bits = base.into_iter().zip(detail).enumerate().flat_map(|(texel, (first, second))| {
        let weights = match (options.method, inputs.mask.map(HeightMap::heights)) {
            (BlendMethod::Weighted { base, detail }, _) => over_common_denominator(base, detail),
            (_, Some(Heights::U8(codes))) => [255 - i32::from(codes[texel]), codes[texel].into(), 255],
            (_, Some(Heights::U16(codes))) => [65_535 - i32::from(codes[texel]), codes[texel].into(), 65_535],
            (_, Some(Heights::F32(_))) => panic!("float masks are for the integer oracle"),
            _ => [1; 3],
        };
        let normal = formula(options.method, weights.map(|part| part as f32), first, second);
        normal.into_iter().take(options.format.channels.count()).map(|v| stored(v, options.format))
    });
    Image { size: inputs.base.size(), format: options.format, bits: bits.collect() }
}

/// The parallax map of heights, floats or not, with the normals of a map, floats or not.
pub fn float_parallax_with_normals(
    heights: &HeightMap,
    map: &NormalMap,
    format: ParallaxFormat,
) -> Image<ParallaxFormat> {
    let z = float_normals(map, map.format().convention).into_iter().map(|normal| unit(normal)[2]);
    float_parallax(heights, z, format)
}

/// The parallax map of heights whose unit normals have these z.
pub fn float_parallax(map: &HeightMap, z: impl Iterator<Item = f32>, format: ParallaxFormat) -> Image<ParallaxFormat> {
    let heights: Vec<f32> = match map.heights() {
        Heights::U8(codes) => codes.iter().map(|&code| f32::from(code) * (1.0 / 255.0)).collect(),
        Heights::U16(codes) => codes.iter().map(|&code| f32::from(code) * (1.0 / 65_535.0)).collect(),
        Heights::F32(heights) => heights.to_vec(),
    };
    let parallax = |height: f32, z: f32| least(2f32.powi(-100), z * (2.0 * height.clamp(0.0, 1.0) - 1.0));
    let bits = heights.iter().zip(z).map(|(&height, z)| stored(parallax(height, z), format)).collect();
    Image { size: map.size(), format, bits }
}

/// The numerators of both weights and their common denominator.
fn over_common_denominator(base: Rational, detail: Rational) -> [i32; 3] {
    let common = num_integer::lcm(base.denominator(), detail.denominator());
    let over = |weight: Rational| (weight.numerator() * (common / weight.denominator())) as i32;
    [over(base), over(detail), common as i32]
}

/// Zero where the magnitude is below a limit.
pub fn least(limit: f32, value: f32) -> f32 {
    if value.abs() < limit { 0.0 } else { value }
}

/// The normals of a map in f32: u (1/L) for codes.
fn float_normals(map: &NormalMap, convention: Convention) -> Vec<[f32; 3]> {
    let components: Vec<f32> = match map.codes() {
        CodesRef::F16(codes) => codes.iter().map(|code| code.to_f32()).collect(),
        CodesRef::F32(codes) => codes.to_vec(),
        CodesRef::U8(_) | CodesRef::U16(_) => {
            let integers = normals(map, convention, UnormZero::Zero);
            let over = |part: i64| part as f32 * (1.0 / integers.greatest as f32);
            return integers.vectors.into_iter().map(|normal| normal.map(over)).collect();
        }
    };
    let green = if map.format().convention == convention { 1.0 } else { -1.0 };
    let normal = |texel: &[f32]| {
        let [x, y] = [texel[0], texel[1]].map(|part| least(2f32.powi(-25), part));
        let z = match map.format().channels {
            Channels::Xyz => texel[2].max(2f32.powi(-24)),
            Channels::Xy => (1.0 - (x * x + y * y)).max(2f32.powi(-48)).sqrt(),
        };
        [x, green * y, z]
    };
    components.chunks(map.format().channels.count()).map(normal).collect()
}

/// The blend of two normals with the weights a/q and b/q, at unit length.
fn formula(method: BlendMethod, [a, b, q]: [f32; 3], [x1, y1, z1]: [f32; 3], [x2, y2, z2]: [f32; 3]) -> [f32; 3] {
    let blended = match method {
        BlendMethod::Weighted { .. } | BlendMethod::Masked => {
            let (first, second) = (a * z2, b * z1);
            [first * x1 + second * x2, first * y1 + second * y2, q * (z1 * z2)]
        }
        BlendMethod::Linear => [x1 + x2, y1 + y2, z1 + z2],
        BlendMethod::Overlay => {
            let overlay = |v1: f32, v2: f32| v1 + (1.0 - v1.abs()) * v2;
            [overlay(x1, x2), overlay(y1, y2), overlay(z1, z2)]
        }
        BlendMethod::Udn => [x1 + x2, y1 + y2, z1],
        BlendMethod::Whiteout => [x1 + x2, y1 + y2, z1 * z2],
        BlendMethod::Rnm => {
            let tz = z1 + 1.0;
            let tu = tz * z2 - (x1 * x2 + y1 * y2);
            [tu * x1 + tz * x2, tu * y1 + tz * y2, tz * (tu - z2)]
        }
    };
    match blended.map(|part| least(2f32.powi(-60), part)) {
        [0.0, 0.0, 0.0] => [0.0, 0.0, 1.0],
        normal => unit(normal),
    }
}

pub fn unit([x, y, z]: [f32; 3]) -> [f32; 3] {
    let inverse = 1.0 / ((x * x + y * y) + z * z).sqrt();
    [x, y, z].map(|part| least(2f32.powi(-100), part * inverse))
}

/// v (m/2) + (c + 1)/2 rounded down, m = c = L for unorm, m = 2L and c = 0 for the signed codes; floats as they are.
pub fn stored(v: f32, format: impl Format) -> u32 {
    let (encoding, depth) = format.code();
    let (bits, l) = match depth {
        Depth::Float16 => return f16::from_f32(v).to_bits().into(),
        Depth::Float32 => return v.to_bits(),
        Depth::Bits8 => (8, encoding.greatest_code(depth)),
        Depth::Bits16 => (16, encoding.greatest_code(depth)),
    };
    let l = l.expect("integer codes") as f32;
    let code = match encoding {
        Encoding::Unorm => (v * (l * 0.5) + (l + 1.0) * 0.5).floor() as i32,
        Encoding::Biased => (v * l + 0.5).floor() as i32 + (1 << (bits - 1)),
        _ => (v * l + 0.5).floor() as i32,
    };
    code as u32 & ((1 << bits) - 1)
}
