//! The specification: one texel after the other, in plain code.

use super::ParallaxPlan;
use crate::map::{CodesMut, CodesRef};
use crate::ops::Vector;
use crate::ops::bake::{float_parallax, unit};
use crate::ops::store::{store_floats, store_fractions};

/// The codes of all texels: `layers` are the rows of the height map and of the normal map.
pub(crate) fn codes_of_layers(plan: &ParallaxPlan, layers: &[CodesRef<'_>], codes: &mut CodesMut<'_>) {
    let format = plan.format.texel();
    for texel in 0..codes.len() {
        match (plan.height_type.greatest_code(), plan.normals.codes) {
            (Some(greatest), Some(reading)) => {
                let normal = plan.normals.integers(&reading, layers[1], texel);
                let (a, s) = parallax_of_integers(integer_height(layers[0], texel), greatest as i32, normal);
                store_fractions(format, &[a], s, codes, texel);
            }
            (greatest, _) => {
                let normal = plan.normals.floats(layers[1], texel);
                let height = match greatest {
                    Some(greatest) => integer_height(layers[0], texel) as f32 * (1.0 / greatest as f32),
                    None => float_height(layers[0], texel),
                };
                store_floats(format, &[parallax_of_floats(height, normal)], codes, texel);
            }
        }
    }
}

fn integer_height(heights: CodesRef<'_>, texel: usize) -> i32 {
    match heights {
        CodesRef::U8(heights) => heights[texel].into(),
        CodesRef::U16(heights) => heights[texel].into(),
        CodesRef::F16(_) | CodesRef::F32(_) => unreachable!("the plan says integer heights"),
    }
}

fn float_height(heights: CodesRef<'_>, texel: usize) -> f32 {
    match heights {
        CodesRef::F32(heights) => heights[texel],
        _ => unreachable!("the plan says float heights"),
    }
}

/// n_z (2h - 1) as `a / sqrt(s)`: z (2H - M) over M sqrt(x^2 + y^2 + z^2).
#[inline(always)]
pub(crate) fn parallax_of_integers(height: i32, greatest: i32, normal: Vector<i32>) -> (i64, u128) {
    let square: u128 = normal.iter().map(|part| u128::from(part.unsigned_abs()).pow(2)).sum();
    let s = u128::from(greatest.unsigned_abs()).pow(2) * square;
    (i64::from(normal[2]) * i64::from(2 * height - greatest), s)
}

/// n_z (2h - 1) in f32, in this order of operations.
#[inline(always)]
pub(crate) fn parallax_of_floats(height: f32, normal: Vector<f32>) -> f32 {
    float_parallax(unit(normal)[2], height)
}
