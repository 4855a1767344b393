//! Heights of a strip to its maps, block by block: sums, components, codes, texels.

use super::output::{Output, Proving, written};
use super::plane::{BLOCK, padded};
use super::real::Arithmetic;
use super::slopes::{Estimate, Slopes, normals, parallaxes};
use super::sums::{Height, sums_inside};
use crate::map::{CodesMut, TexelFormat};
use crate::ops::bake::{BakePlan, IntegerSlope, Slope};
use crate::stream::{Band, HeightBand};

/// The codes of all texels of a strip, for each map of the plan.
pub(super) fn bake(plan: &BakePlan, strip: &HeightBand<'_>, maps: Vec<CodesMut<'_>>) {
    match (strip, plan.slope) {
        (HeightBand::U8(strip), Slope::Integer(slope)) => bake_integers(plan, slope, 255, strip, maps),
        (HeightBand::U16(strip), Slope::Integer(slope)) => bake_integers(plan, slope, 65_535, strip, maps),
        (HeightBand::F32(strip), Slope::Float(slope)) => fill(plan, &slope, strip, outputs(plan, maps, written)),
        _ => unreachable!("the plan was made for heights of another type"),
    }
}

fn bake_integers<T: Height<Sum = i32> + Into<i32>>(
    plan: &BakePlan,
    slope: IntegerSlope,
    greatest: i32,
    strip: &Band<'_, T>,
    maps: Vec<CodesMut<'_>>,
) {
    match Arithmetic::new(plan.precision, plan.outputs()) {
        Arithmetic::Fast => {
            fill(plan, &Estimate::<f32>::new(slope, greatest), strip, outputs(plan, maps, written));
        }
        Arithmetic::Near => {
            fill(plan, &Estimate::<f32>::new(slope, greatest), strip, outputs(plan, maps, f32::proved));
        }
        Arithmetic::Nearer => {
            fill(plan, &Estimate::<f64>::new(slope, greatest), strip, outputs(plan, maps, f64::proved));
        }
    }
}

type Outputs<'a, V> = Vec<Box<dyn Output<V> + 'a>>;

fn outputs<'a, V>(
    plan: &BakePlan,
    maps: Vec<CodesMut<'a>>,
    output: impl Fn(TexelFormat, CodesMut<'a>) -> Box<dyn Output<V> + 'a>,
) -> Outputs<'a, V> {
    plan.outputs().zip(maps).map(|(format, codes)| output(format, codes)).collect()
}

/// Row by row, block by block.
fn fill<T: Height, S: Slopes<T>>(
    plan: &BakePlan,
    slopes: &S,
    strip: &Band<'_, T>,
    mut outputs: Outputs<'_, S::Component>,
) {
    let width = plan.size.width();
    let mut sums = [[T::Sum::default(); BLOCK]; 2];
    let mut normal = [[S::Component::default(); BLOCK]; 3];
    let mut parallax = [S::Component::default(); BLOCK];
    for row in 0..strip.rows() {
        for first in (0..width).step_by(BLOCK) {
            let count = BLOCK.min(width - first);
            sums_of_columns(plan, strip, row, first, sums.each_mut().map(|sums| &mut sums[..count]));
            normals::<T, S>(slopes, &sums, &mut normal, padded(count));
            let sums = |at: usize| [sums[0][at], sums[1][at]];
            let [x, y, z] = &normal;
            let mut outputs = outputs.iter_mut();
            if plan.normal.is_some() {
                let output = outputs.next().expect("room for the normal map");
                output.store(&[x, y, z], count, &|at| slopes.exact_normal(sums(at)));
            }
            if plan.parallax.is_some() {
                let output = outputs.next().expect("room for the parallax map");
                let heights = &strip.row(row as isize)[first..][..count];
                parallaxes(slopes, z, heights, &mut parallax);
                output.store(&[&parallax], count, &|at| slopes.exact_parallax(sums(at), heights[at]));
            }
        }
    }
}

/// The sums of the columns of a row from `first` on.
pub(super) fn sums_of_columns<T: Height>(
    plan: &BakePlan,
    strip: &Band<'_, T>,
    row: usize,
    first: usize,
    sums: [&mut [T::Sum]; 2],
) {
    let (count, last) = (sums[0].len(), plan.size.width() - 1);
    let mut sums = sums;
    for border in [0, last].into_iter().filter(|column| (first..first + count).contains(column)) {
        let at_border = T::sums(plan.stencil, strip.neighbours(plan.edges.x, border, row));
        sums.iter_mut().zip(at_border).for_each(|(sums, sum)| sums[border - first] = sum);
    }
    let inside = first.max(1)..(first + count).min(last);
    if !inside.is_empty() {
        let rows = [-1, 0, 1].map(|step| strip.row(row as isize + step));
        let sums = sums.map(|sums| &mut sums[inside.start - first..inside.end - first]);
        sums_inside(plan.stencil, rows, inside.start, sums);
    }
}
