//! Heights and normals to a parallax map, block by block: heights and normals, components, codes, texels.

use super::output::{Output, Proving, written};
use super::plane::{BLOCK, Plane, padded, texel};
use super::read;
use super::real::{Arithmetic, Real, unit};
use crate::exact::CodeReading;
use crate::map::{CodesMut, CodesRef};
use crate::ops::parallax::{ParallaxPlan, parallax_of_floats, parallax_of_integers};

/// The codes of all texels of some rows: `layers` are those of the height map and of the normal map.
pub(super) fn parallax(plan: &ParallaxPlan, layers: &[CodesRef<'_>], codes: CodesMut<'_>) {
    let format = plan.format.texel();
    let texels = codes.len();
    let (Some(greatest), Some(reading)) = (plan.height_type.greatest_code(), plan.normals.codes) else {
        return fill_floats(plan, layers, texels, written(format, codes));
    };
    let greatest = greatest as i32;
    match Arithmetic::new(plan.precision, [format].into_iter()) {
        Arithmetic::Fast => fill_integers::<f32>(plan, greatest, reading, layers, texels, written(format, codes)),
        Arithmetic::Near => fill_integers(plan, greatest, reading, layers, texels, f32::proved(format, codes)),
        Arithmetic::Nearer => fill_integers(plan, greatest, reading, layers, texels, f64::proved(format, codes)),
    }
}

/// Both maps hold integers.
fn fill_integers<V: Real>(
    plan: &ParallaxPlan,
    greatest: i32,
    reading: CodeReading,
    layers: &[CodesRef<'_>],
    texels: usize,
    mut output: Box<dyn Output<V> + '_>,
) {
    let mut heights = [0; BLOCK];
    let mut normals = [[0; BLOCK]; 3];
    let mut parallax = [V::default(); BLOCK];
    for first in (0..texels).step_by(BLOCK) {
        let block = first..texels.min(first + BLOCK);
        let count = block.len();
        read::scalars(layers[0], block.clone(), &mut heights);
        read::integers(&plan.normals, &reading, layers[1], block, &mut normals);
        estimate(greatest, &heights, &normals, &mut parallax, padded(count));
        output.store(&[&parallax], count, &|at| {
            let (a, s) = parallax_of_integers(heights[at], greatest, texel(&normals, at));
            ([a, 0, 0], s)
        });
    }
}

/// One of the maps holds floats.
fn fill_floats(plan: &ParallaxPlan, layers: &[CodesRef<'_>], texels: usize, mut output: Box<dyn Output<f32> + '_>) {
    let mut codes = [0; BLOCK];
    let mut integers = [[0; BLOCK]; 3];
    let mut heights = [0.0; BLOCK];
    let mut normals = [[0.0; BLOCK]; 3];
    let mut parallax = [0.0; BLOCK];
    for first in (0..texels).step_by(BLOCK) {
        let block = first..texels.min(first + BLOCK);
        let count = block.len();
        match (plan.height_type.greatest_code(), layers[0]) {
            (Some(greatest), layer) => {
                read::scalars(layer, block.clone(), &mut codes);
                heights_of_codes(greatest, &codes, &mut heights, padded(count));
            }
            (None, CodesRef::F32(layer)) => heights[..count].copy_from_slice(&layer[block.clone()]),
            (None, _) => unreachable!("the plan says float heights"),
        }
        read::floats(&plan.normals, layers[1], block, &mut integers, &mut normals);
        write(&heights, &normals, &mut parallax, padded(count));
        output.store(&[&parallax], count, &|_| unreachable!("written floats have no doubts"));
    }
}

vectorised! {
    /// z / |n| times (2H - M) (1/M): the first is off by 4.5e (see [`unit`]) and 2H - M is exact, so with the errors of
    /// 1/M and of two products it is off by 7.5e.
    fn estimate<V: Real>(
        greatest: i32,
        heights: &Plane<i32>,
        normals: &[Plane<i32>; 3],
        parallax: &mut Plane<V>,
        count: usize,
    ) {
        let over_greatest = V::of(1.0 / f64::from(greatest));
        for i in 0..count.min(BLOCK) {
            let [x, y, z] = texel(normals, i);
            let [_, _, z] = unit([V::of_integer(x), V::of_integer(y), V::of_integer(z)]);
            parallax[i] = z * (V::of_integer(2 * heights[i] - greatest) * over_greatest);
        }
    }
}

vectorised! {
    fn heights_of_codes(greatest: u32, codes: &Plane<i32>, heights: &mut Plane<f32>, count: usize) {
        for i in 0..count.min(BLOCK) {
            heights[i] = codes[i] as f32 * (1.0 / greatest as f32);
        }
    }
}

vectorised! {
    /// The reference's own arithmetic.
    fn write(heights: &Plane<f32>, normals: &[Plane<f32>; 3], parallax: &mut Plane<f32>, count: usize) {
        for i in 0..count.min(BLOCK) {
            parallax[i] = parallax_of_floats(heights[i], texel(normals, i));
        }
    }
}
