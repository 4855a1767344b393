//! The specification: one texel after the other, in plain code.
//!
//! Every method has the form (ca x1 + cb x2, ca y1 + cb y2, Z). On integers over L1 and L2 each is multiplied by what
//! makes it an integer too, so that the result is A / sqrt(S) and can be rounded correctly (DESIGN 3.1).

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
#[inline(always)]
pub(crate) fn blend_integers(
    method: BlendMethod,
    [a, b, q]: [i32; 3],
    [l1, l2]: [i32; 2],
    base: Vector<i32>,
    detail: Vector<i32>,
) -> Vector<i64> {
    let [a, b, q, l1, l2] = [a, b, q, l1, l2].map(i64::from);
    let ([x1, y1, z1], [x2, y2, z2]) = (base.map(i64::from), detail.map(i64::from));
    let overlay = |v1: i64, v2: i64| l2 * v1 + (l1 - v1.abs()) * v2;
    let [x, y, z] = match method {
        BlendMethod::Weighted { .. } | BlendMethod::Masked => {
            let (ca, cb) = (a * z2, b * z1);
            [ca * x1 + cb * x2, ca * y1 + cb * y2, q * z1 * z2]
        }
        BlendMethod::Linear => [l2 * x1 + l1 * x2, l2 * y1 + l1 * y2, l2 * z1 + l1 * z2],
        BlendMethod::Overlay => [overlay(x1, x2), overlay(y1, y2), overlay(z1, z2)],
        BlendMethod::Udn => [l2 * x1 + l1 * x2, l2 * y1 + l1 * y2, l2 * z1],
        BlendMethod::Whiteout => [l2 * x1 + l1 * x2, l2 * y1 + l1 * y2, z1 * z2],
        BlendMethod::Rnm => {
            // t = (x1, y1, z1 + 1), u = (-x2, -y2, z2); t (t.u) / t_z - u, times t_z.
            let tz = z1 + l1;
            let tu = tz * z2 - (x1 * x2 + y1 * y2);
            [tu * x1 + l1 * tz * x2, tu * y1 + l1 * tz * y2, tz * (tu - l1 * z2)]
        }
    };
    if [x, y, z] == [0; 3] { [0, 0, 1] } else { [x, y, z] }
}

/// The blended unit normal in f32, in this order of operations; (0, 0, 1) where nothing is left.
#[inline(always)]
pub(crate) fn blend_floats(
    method: BlendMethod,
    weights: [i32; 3],
    [x1, y1, z1]: Vector<f32>,
    [x2, y2, z2]: Vector<f32>,
) -> Vector<f32> {
    let [a, b, q] = [weights[0] as f32, weights[1] as f32, weights[2] as f32];
    let overlay = |v1: f32, v2: f32| v1 + (1.0 - v1.abs()) * v2;
    let [x, y, z] = match method {
        BlendMethod::Weighted { .. } | BlendMethod::Masked => {
            let (ca, cb) = (a * z2, b * z1);
            [ca * x1 + cb * x2, ca * y1 + cb * y2, q * (z1 * z2)]
        }
        BlendMethod::Linear => [x1 + x2, y1 + y2, z1 + z2],
        BlendMethod::Overlay => [overlay(x1, x2), overlay(y1, y2), overlay(z1, z2)],
        BlendMethod::Udn => [x1 + x2, y1 + y2, z1],
        BlendMethod::Whiteout => [x1 + x2, y1 + y2, z1 * z2],
        BlendMethod::Rnm => {
            let tz = z1 + 1.0;
            let tu = tz * z2 - (x1 * x2 + y1 * y2);
            [tu * x1 + tz * x2, tu * y1 + tz * y2, tz * (tu - z2)]
        }
    };
    // So that no square is subnormal.
    let part = |part: f32| zero_below(2f32.powi(-60), part);
    let [x, y, z] = [part(x), part(y), part(z)];
    if x == 0.0 && y == 0.0 && z == 0.0 { [0.0, 0.0, 1.0] } else { unit([x, y, z]) }
}
