//! Two normal maps to one, block by block: normals of both, blended components, codes, texels.

use super::output::{Fraction, Output, Proving, written};
use super::plane::{BLOCK, Plane, padded, texel};
use super::read;
use super::real::{Arithmetic, Real, unit};
use crate::exact::CodeReading;
use crate::map::{CodesMut, CodesRef};
use crate::ops::Vector;
use crate::ops::blend::{BlendMethod, BlendPlan, blend_floats, blend_integers, blended};
use std::ops::Range;

/// The codes of all texels of some rows: `layers` are those of the two maps and of the mask, if there is one.
pub(super) fn blend(plan: &BlendPlan, layers: &[CodesRef<'_>], codes: CodesMut<'_>) {
    let format = plan.format.texel();
    let texels = codes.len() / format.channels;
    let [base, detail] = plan.layers.map(|layer| layer.codes);
    let (Some(base), Some(detail)) = (base, detail) else {
        return fill_floats(plan, layers, texels, written(format, codes));
    };
    let readings = [base, detail];
    match Arithmetic::new(plan.precision, [format].into_iter()) {
        Arithmetic::Fast => fill_integers::<f32>(plan, readings, layers, texels, written(format, codes)),
        Arithmetic::Near if fits_f32(plan, readings) => {
            fill_integers::<f32>(plan, readings, layers, texels, f32::proved(format, codes));
        }
        _ => fill_integers::<f64>(plan, readings, layers, texels, f64::proved(format, codes)),
    }
}

/// Whether f32 holds every part of a blended normal, and all that it is computed from, as it is; f64 always does.
fn fits_f32(plan: &BlendPlan, readings: [CodeReading; 2]) -> bool {
    let parts = plan.greatest_parts(readings.map(|reading| reading.greatest));
    parts.iter().all(|part| *part < 1 << f32::MANTISSA_DIGITS)
}

/// The numerators of both weights of a texel, and their denominator.
trait Weights {
    fn of_texel(&self, at: usize) -> [i32; 3];
}

/// The same for all texels.
impl Weights for [i32; 3] {
    #[inline(always)]
    fn of_texel(&self, _: usize) -> [i32; 3] {
        *self
    }
}

/// M - H, H and M of a mask.
struct MaskWeights {
    planes: [Plane<i32>; 2],
    greatest: i32,
}

impl Weights for MaskWeights {
    #[inline(always)]
    fn of_texel(&self, at: usize) -> [i32; 3] {
        [self.planes[0][at], self.planes[1][at], self.greatest]
    }
}

/// The weights of the texels of a block.
struct BlockWeights {
    constant: [i32; 3],
    mask: Option<MaskWeights>,
}

impl BlockWeights {
    fn new(plan: &BlendPlan) -> Self {
        let mask = plan.mask.map(|mask| MaskWeights { planes: [[0; BLOCK]; 2], greatest: mask.greatest as i32 });
        Self { constant: [plan.weights.base, plan.weights.detail, plan.weights.q as i32], mask }
    }

    /// Reads the mask's part of `layers`, if there is one.
    fn read(&mut self, layers: &[CodesRef<'_>], texels: Range<usize>) {
        if let Some(MaskWeights { planes: [base, detail], greatest }) = &mut self.mask {
            read::scalars(layers[2], texels, detail);
            base.iter_mut().zip(detail).for_each(|(base, detail)| *base = *greatest - *detail);
        }
    }

    fn of_texel(&self, at: usize) -> [i32; 3] {
        self.mask.as_ref().map_or(self.constant, |mask| mask.of_texel(at))
    }
}

/// Both maps hold integers.
fn fill_integers<V: Real>(
    plan: &BlendPlan,
    readings: [CodeReading; 2],
    layers: &[CodesRef<'_>],
    texels: usize,
    mut output: Box<dyn Output<V> + '_>,
) {
    let scales = [readings[0].greatest, readings[1].greatest];
    let mut weights = BlockWeights::new(plan);
    let [mut base, mut detail] = [[[0; BLOCK]; 3]; 2];
    let mut normal = [[V::default(); BLOCK]; 3];
    for first in (0..texels).step_by(BLOCK) {
        let block = first..texels.min(first + BLOCK);
        let count = block.len();
        read::integers(&plan.layers[0], &readings[0], layers[0], block.clone(), &mut base);
        read::integers(&plan.layers[1], &readings[1], layers[1], block.clone(), &mut detail);
        weights.read(layers, block);
        blend_to_estimates(plan.method, &weights, scales, [&base, &detail], &mut normal, padded(count));
        let [x, y, z] = &normal;
        output.store(&[x, y, z], count, &|at| {
            exact(plan.method, weights.of_texel(at), scales, texel(&base, at), texel(&detail, at))
        });
    }
}

fn exact(method: BlendMethod, weights: [i32; 3], scales: [i32; 2], base: Vector<i32>, detail: Vector<i32>) -> Fraction {
    let normal = blend_integers(method, weights, scales, base, detail);
    (normal, normal.iter().map(|part| u128::from(part.unsigned_abs()).pow(2)).sum())
}

/// One of the maps holds floats.
fn fill_floats(plan: &BlendPlan, layers: &[CodesRef<'_>], texels: usize, mut output: Box<dyn Output<f32> + '_>) {
    let mut weights = BlockWeights::new(plan);
    let mut integers = [[0; BLOCK]; 3];
    let [mut base, mut detail, mut normal] = [[[0.0; BLOCK]; 3]; 3];
    for first in (0..texels).step_by(BLOCK) {
        let block = first..texels.min(first + BLOCK);
        let count = block.len();
        read::floats(&plan.layers[0], layers[0], block.clone(), &mut integers, &mut base);
        read::floats(&plan.layers[1], layers[1], block.clone(), &mut integers, &mut detail);
        weights.read(layers, block);
        blend_written(plan.method, &weights, [&base, &detail], &mut normal, padded(count));
        let [x, y, z] = &normal;
        output.store(&[x, y, z], count, &|_| unreachable!("written floats have no doubts"));
    }
}

/// A loop for each method, with the method as a constant in it.
macro_rules! for_each_method {
    ($method:expr, $weights:expr, $loop_of:ident($($argument:expr),*)) => {{
        let BlockWeights { constant, mask } = $weights;
        match ($method, mask) {
            (BlendMethod::Masked, Some(mask)) => $loop_of(BlendMethod::Masked, mask, $($argument),*),
            // The formula of a mask, with other weights.
            (BlendMethod::Weighted { .. } | BlendMethod::Masked, _) => {
                $loop_of(BlendMethod::Masked, constant, $($argument),*);
            }
            (BlendMethod::Linear, _) => $loop_of(BlendMethod::Linear, constant, $($argument),*),
            (BlendMethod::Overlay, _) => $loop_of(BlendMethod::Overlay, constant, $($argument),*),
            (BlendMethod::Udn, _) => $loop_of(BlendMethod::Udn, constant, $($argument),*),
            (BlendMethod::Whiteout, _) => $loop_of(BlendMethod::Whiteout, constant, $($argument),*),
            (BlendMethod::Rnm, _) => $loop_of(BlendMethod::Rnm, constant, $($argument),*),
        }
    }};
}

vectorised! {
    /// Unit normals off by 4.5e (see [`unit`]) where V holds every part of the blend as it is.
    fn blend_to_estimates<V: Real>(
        method: BlendMethod,
        weights: &BlockWeights,
        scales: [i32; 2],
        inputs: [&[Plane<i32>; 3]; 2],
        normal: &mut [Plane<V>; 3],
        count: usize,
    ) {
        for_each_method!(method, weights, estimate_texels(scales, inputs, normal, count));
    }
}

#[inline(always)]
fn estimate_texels<V: Real>(
    method: BlendMethod,
    weights: &impl Weights,
    scales: [i32; 2],
    [base, detail]: [&[Plane<i32>; 3]; 2],
    [x, y, z]: &mut [Plane<V>; 3],
    count: usize,
) {
    let real = |[x, y, z]: Vector<i32>| [V::of_integer(x), V::of_integer(y), V::of_integer(z)];
    let scales = [V::of_integer(scales[0]), V::of_integer(scales[1])];
    for i in 0..count.min(BLOCK) {
        let normal = blended(method, real(weights.of_texel(i)), scales, real(texel(base, i)), real(texel(detail, i)));
        [x[i], y[i], z[i]] = unit(normal);
    }
}

vectorised! {
    /// The reference's own arithmetic.
    fn blend_written(
        method: BlendMethod,
        weights: &BlockWeights,
        inputs: [&[Plane<f32>; 3]; 2],
        normal: &mut [Plane<f32>; 3],
        count: usize,
    ) {
        for_each_method!(method, weights, write_texels(inputs, normal, count));
    }
}

#[inline(always)]
fn write_texels(
    method: BlendMethod,
    weights: &impl Weights,
    [base, detail]: [&[Plane<f32>; 3]; 2],
    [x, y, z]: &mut [Plane<f32>; 3],
    count: usize,
) {
    for i in 0..count.min(BLOCK) {
        [x[i], y[i], z[i]] = blend_floats(method, weights.of_texel(i), texel(base, i), texel(detail, i));
    }
}
