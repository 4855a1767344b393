//! The specification: one texel after the other, in plain code.
//!
//! Every method has the form (ca x1 + cb x2, ca y1 + cb y2, Z). On integers over L1 and L2 each is multiplied by what
//! makes it an integer too, so that the result is A / sqrt(S) and can be rounded correctly (DESIGN 3.1).

use super::formula::blended;
use super::{BlendMethod, BlendPlan};
use crate::map::{CodesMut, CodesRef};
use crate::ops::Vector;
use crate::ops::bake::{unit, zero_below};
use crate::ops::store::{store_floats, store_fractions};

/// The codes of all texels: `layers` are the rows of the two maps and of the mask, if there is one.
pub(crate) fn codes_of_layers(plan: &BlendPlan, layers: &[CodesRef<'_>], codes: &mut CodesMut<'_>) {
    let format = plan.format.texel();
    for texel in 0..codes.len() / format.channels {
        let weights = weights_of_texel(plan, layers.get(2).copied(), texel);
        match (plan.integer_scales(), plan.layers.map(|layer| layer.codes)) {
            (Some(scales), [Some(base), Some(detail)]) => {
                let base = plan.layers[0].integers(&base, layers[0], texel);
                let detail = plan.layers[1].integers(&detail, layers[1], texel);
                let normal = blend_integers(plan.method, weights, scales, base, detail);
                let square = normal.iter().map(|part| u128::from(part.unsigned_abs()).pow(2)).sum();
                store_fractions(format, &normal, square, codes, texel);
            }
            _ => {
                let [base, detail] = [0, 1].map(|layer| plan.layers[layer].floats(layers[layer], texel));
                let normal = blend_floats(plan.method, weights, base, detail);
                store_floats(format, &normal, codes, texel);
            }
        }
    }
}

/// The numerators of both weights and their denominator: M - H, H and M of a mask.
fn weights_of_texel(plan: &BlendPlan, mask: Option<CodesRef<'_>>, texel: usize) -> [i32; 3] {
    let (Some(codes), Some(mask)) = (mask, plan.mask) else {
        return [plan.weights.base, plan.weights.detail, plan.weights.q as i32];
    };
    let transition = match codes {
        CodesRef::U8(codes) => codes[texel].into(),
        CodesRef::U16(codes) => codes[texel].into(),
        CodesRef::F16(_) | CodesRef::F32(_) => unreachable!("a mask holds integers"),
    };
    [mask.greatest as i32 - transition, transition, mask.greatest as i32]
}

/// The blended normal of two normals over L1 and L2, times some number; (0, 0, 1) where nothing is left.
///
/// Components are at most 65535, weights too; every part of the result is below 2^53, the sum of its squares below
/// 2^107.
pub(crate) fn blend_integers(
    method: BlendMethod,
    weights: [i32; 3],
    scales: [i32; 2],
    base: Vector<i32>,
    detail: Vector<i32>,
) -> Vector<i64> {
    let [base, detail] = [base, detail].map(|normal| normal.map(i64::from));
    match blended(method, weights.map(i64::from), scales.map(i64::from), base, detail) {
        [0, 0, 0] => [0, 0, 1],
        normal => normal,
    }
}

/// The blended unit normal in f32, in this order of operations; (0, 0, 1) where nothing is left.
#[inline(always)]
pub(crate) fn blend_floats(
    method: BlendMethod,
    [a, b, q]: [i32; 3],
    base: Vector<f32>,
    detail: Vector<f32>,
) -> Vector<f32> {
    let [x, y, z] = blended(method, [a as f32, b as f32, q as f32], [1.0; 2], base, detail);
    // So that no square is subnormal.
    let part = |part: f32| zero_below(2f32.powi(-60), part);
    let [x, y, z] = [part(x), part(y), part(z)];
    if x == 0.0 && y == 0.0 && z == 0.0 { [0.0, 0.0, 1.0] } else { unit([x, y, z]) }
}
