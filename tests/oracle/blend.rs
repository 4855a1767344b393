//! Blends of two maps of integer codes, from the published formulas over one common denominator.

use super::Exact;
use super::rounding::{rounded_wide, square};
use super::texels::{UnormZero, normals};
use crate::support::Image;
use num_integer::Integer;
use texbake::{
    BlendInputs, BlendMethod, BlendOptions, Convention, HeightMap, Heights, NormalFormat, NormalMap, Rational, Size,
};

/// A normal times some number.
pub type Tangent = [i128; 3];

/// The blend of two maps, repeating the second one.
pub fn blend(
    inputs: &BlendInputs<&NormalMap, &HeightMap>,
    options: &BlendOptions,
    zero: UnormZero,
) -> Exact<NormalFormat> {
    let size = inputs.base.size();
    let [base, detail] = [inputs.base, inputs.detail].map(|map| normals(map, options.format.convention, zero));
    let mask = inputs.mask.map(transitions);
    // Both normals are integers over this.
    let unit = i128::from(base.greatest * detail.greatest);
    let over_unit = |vector: [i64; 3], factor: i64| vector.map(|part| i128::from(part * factor));
    let blended = (0..size.texels()).map(|texel| {
        let first = over_unit(base.vectors[texel], detail.greatest);
        let second = over_unit(detail.vectors[tiled(texel, size, inputs.detail.size())], base.greatest);
        let weights = match (options.method, &mask) {
            (BlendMethod::Weighted { base, detail }, _) => [base, detail].map(ratio),
            (_, Some((transitions, greatest))) => {
                let t = transitions[texel];
                [(greatest - t, *greatest), (t, *greatest)]
            }
            _ => [(1, 1); 2],
        };
        formula(options.method, weights, unit, first, second)
    });
    stored(blended, size, options.format)
}

/// A map's own normals at unit length, in another format.
pub fn renormalised(map: &NormalMap, format: NormalFormat) -> Image {
    let own = normals(map, format.convention, UnormZero::Zero).vectors;
    stored(own.into_iter().map(|vector| vector.map(i128::from)), map.size(), format).image
}

fn stored(normals: impl Iterator<Item = Tangent>, size: Size, format: NormalFormat) -> Exact<NormalFormat> {
    let mut exact = Exact { image: Image { size, format, bits: Vec::new() }, ties: 0 };
    for normal in normals {
        let normal = in_lowest_terms(normal);
        let square = square(&normal);
        for part in &normal[..format.channels.count()] {
            let code = rounded_wide(*part, square, format.encoding, format.depth);
            exact.image.bits.push(code.bits);
            exact.ties += usize::from(code.tie);
        }
    }
    exact
}

/// Where a texel lies in a map that repeats from the first texel on.
fn tiled(texel: usize, size: Size, tile: Size) -> usize {
    let (x, y) = (texel % size.width(), texel / size.width());
    y % tile.height() * tile.width() + x % tile.width()
}

fn ratio(weight: Rational) -> (i128, i128) {
    (weight.numerator().into(), weight.denominator().into())
}

/// The codes of t, and that of t = 1.
fn transitions(mask: &HeightMap) -> (Vec<i128>, i128) {
    match mask.heights() {
        Heights::U8(codes) => (codes.iter().map(|&code| code.into()).collect(), 255),
        Heights::U16(codes) => (codes.iter().map(|&code| code.into()).collect(), 65_535),
        // Half up: f32 times 65535 is exact in f64.
        Heights::F32(heights) => {
            let code = |t: &f32| (f64::from(t.clamp(0.0, 1.0)) * 65_535.0 + 0.5).floor() as i128;
            (heights.iter().map(code).collect(), 65_535)
        }
    }
}

/// The blend of two normals over `unit`, times some number.
fn formula(
    method: BlendMethod,
    [(na, da), (nb, db)]: [(i128, i128); 2],
    unit: i128,
    [x1, y1, z1]: Tangent,
    [x2, y2, z2]: Tangent,
) -> Tangent {
    match method {
        // a x1/z1 + b x2/z2 and 1, times both denominators of the weights and both z (FGED2 eq. 7.46).
        BlendMethod::Weighted { .. } | BlendMethod::Masked => {
            let common = da.lcm(&db);
            let greatest = common.max((na * common / da).abs()).max((nb * common / db).abs());
            assert!(greatest <= 65_535, "weights with a part of {greatest} are replaced by nearby ones");
            let slope = |part1: i128, part2: i128| na * db * part1 * z2 + nb * da * part2 * z1;
            [slope(x1, x2), slope(y1, y2), da * db * z1 * z2]
        }
        BlendMethod::Linear => [x1 + x2, y1 + y2, z1 + z2],
        // Where a is above zero 1 - 2 (1 - a)(1 - b) in [0, 1] is v1 + v2 - v1 v2 in [-1, 1], below it 2ab is
        // v1 + v2 + v1 v2; times unit^2.
        BlendMethod::Overlay => {
            let overlay = |v1: i128, v2: i128| {
                let product = v1 * v2;
                (v1 + v2) * unit + if v1 < 0 { product } else { -product }
            };
            [overlay(x1, x2), overlay(y1, y2), overlay(z1, z2)]
        }
        BlendMethod::Udn => [x1 + x2, y1 + y2, z1],
        BlendMethod::Whiteout => [(x1 + x2) * unit, (y1 + y2) * unit, z1 * z2],
        // t (t.u) / t_z - u with t = n1 + (0, 0, 1) and u = (-x2, -y2, z2), times t_z unit^2.
        BlendMethod::Rnm => {
            let (t, u) = ([x1, y1, z1 + unit], [-x2, -y2, z2]);
            let product: i128 = t.iter().zip(&u).map(|(t, u)| t * u).sum();
            [0, 1, 2].map(|axis| t[axis] * product - u[axis] * t[2] * unit)
        }
    }
}

/// (0, 0, 1) where nothing is left.
fn in_lowest_terms(normal: Tangent) -> Tangent {
    match normal.iter().fold(0, |common: i128, part| common.gcd(part)) {
        0 => [0, 0, 1],
        common => normal.map(|part| part / common),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formulas over 2, by hand: n1 = (1, -1, 1)/2 and n2 = (2, 1, 2)/2.
    #[test]
    fn known_normals_blend_as_published() {
        let (one, unit) = ([(1, 1); 2], 2);
        let of = |method, weights| in_lowest_terms(formula(method, weights, unit, [1, -1, 1], [2, 1, 2]));
        // Slopes (1, -1) and (1, 1/2).
        assert_eq!(of(BlendMethod::add(), one), [4, -1, 2]);
        assert_eq!(of(BlendMethod::Masked, [(1, 2), (-2, 3)]), [-1, -5, 6]);
        // Halves: (3, 0, 3), (1/2 + 1 (1 - 1/2), -1/2 + 1/2 (1 - 1/2), 1/2 + 1 (1 - 1/2)) = (1, -1/4, 1).
        assert_eq!(of(BlendMethod::Linear, one), [1, 0, 1]);
        assert_eq!(of(BlendMethod::Overlay, one), [4, -1, 4]);
        assert_eq!(of(BlendMethod::Udn, one), [3, 0, 1]);
        // (3/2, 0, 1/2).
        assert_eq!(of(BlendMethod::Whiteout, one), [3, 0, 1]);
        // t = (1/2, -1/2, 3/2), u = (-1, -1/2, 1): t.u = 5/4, t (t.u)/t_z = (5, -5, 15)/12, less u: (17, 1, 3)/12.
        assert_eq!(of(BlendMethod::Rnm, one), [17, 1, 3]);
        assert_eq!(in_lowest_terms([0; 3]), [0, 0, 1]);
    }

    #[test]
    fn tiles_repeat_from_the_first_texel_on() {
        let (size, tile) = (Size::new(5, 3).unwrap(), Size::new(2, 2).unwrap());
        let found: Vec<_> = (0..15).map(|texel| tiled(texel, size, tile)).collect();
        assert_eq!(found, [0, 1, 0, 1, 0, 2, 3, 2, 3, 2, 0, 1, 0, 1, 0]);
    }

    #[test]
    fn conventions_turn_green_around() {
        let dx = NormalFormat { convention: Convention::Dx, ..crate::support::SNORM8 };
        let map = crate::support::normal_map(1, 1, dx, &[0, 60, 80]);
        assert_eq!(renormalised(&map, crate::support::SNORM8).bits, [0, 0x100 - 76, 102]);
    }
}
