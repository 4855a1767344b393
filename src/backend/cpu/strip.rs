//! Some rows of a map, baked on one thread.

use super::block::{BLOCK, Block, Height, sums_inside};
use super::round::{ToF16, ToF32, ToInteger};
use super::rule::{Estimate, Estimated, Proved, Rule, Written};
use crate::map::{CodesMut, TexelFormat};
use crate::ops::Precision;
use crate::ops::bake::{BakePlan, FloatSlope, IntegerSlope, Slope, codes_of_band};
use crate::stream::{Band, HeightBand};

/// The codes of all texels of a strip, for each map of the plan.
pub(super) fn bake(plan: &BakePlan, strip: &HeightBand<'_>, maps: &mut [CodesMut<'_>]) {
    let (Some(format), None) = (plan.normal, plan.parallax) else {
        return codes_of_band(plan, strip, maps);
    };
    let all = 0..maps[0].len();
    let codes = maps[0].slice(all);
    match (strip, plan.slope) {
        (HeightBand::U8(strip), Slope::Integer(slope)) => bake_integers(plan, format.texel(), slope, strip, codes),
        (HeightBand::U16(strip), Slope::Integer(slope)) => bake_integers(plan, format.texel(), slope, strip, codes),
        (HeightBand::F32(strip), Slope::Float(slope)) => bake_floats(plan, format.texel(), slope, strip, codes),
        _ => unreachable!("the plan was made for heights of another type"),
    }
}

fn bake_integers<T: Height<Sum = i32>>(
    plan: &BakePlan,
    format: TexelFormat,
    slope: IntegerSlope,
    strip: &Band<'_, T>,
    codes: CodesMut<'_>,
) {
    match plan.precision {
        Precision::Exact => {
            let (near, nearer) = (Estimate::<f32>::from(slope), Estimate::<f64>::from(slope));
            match codes {
                CodesMut::U8(codes) => {
                    fill(
                        plan,
                        format.channels,
                        &Proved { slope, estimate: near, round: ToInteger::<u8>::new(format) },
                        strip,
                        codes,
                    );
                }
                CodesMut::U16(codes) => {
                    fill(
                        plan,
                        format.channels,
                        &Proved { slope, estimate: nearer, round: ToInteger::<u16>::new(format) },
                        strip,
                        codes,
                    );
                }
                CodesMut::F16(codes) => {
                    fill(plan, format.channels, &Proved { slope, estimate: nearer, round: ToF16 }, strip, codes)
                }
                CodesMut::F32(codes) => {
                    fill(plan, format.channels, &Proved { slope, estimate: nearer, round: ToF32 }, strip, codes)
                }
            }
        }
        Precision::Fast => {
            let estimate = Estimate::from(slope);
            match codes {
                CodesMut::U8(codes) => {
                    fill(
                        plan,
                        format.channels,
                        &Estimated { estimate, round: ToInteger::<u8>::new(format) },
                        strip,
                        codes,
                    );
                }
                CodesMut::U16(codes) => {
                    fill(
                        plan,
                        format.channels,
                        &Estimated { estimate, round: ToInteger::<u16>::new(format) },
                        strip,
                        codes,
                    );
                }
                CodesMut::F16(codes) => {
                    fill(plan, format.channels, &Estimated { estimate, round: ToF16 }, strip, codes)
                }
                CodesMut::F32(codes) => {
                    fill(plan, format.channels, &Estimated { estimate, round: ToF32 }, strip, codes)
                }
            }
        }
    }
}

fn bake_floats(plan: &BakePlan, format: TexelFormat, slope: FloatSlope, strip: &Band<'_, f32>, codes: CodesMut<'_>) {
    match codes {
        CodesMut::U8(codes) => {
            fill(plan, format.channels, &Written { slope, round: ToInteger::<u8>::new(format) }, strip, codes)
        }
        CodesMut::U16(codes) => {
            fill(plan, format.channels, &Written { slope, round: ToInteger::<u16>::new(format) }, strip, codes)
        }
        CodesMut::F16(codes) => fill(plan, format.channels, &Written { slope, round: ToF16 }, strip, codes),
        CodesMut::F32(codes) => fill(plan, format.channels, &Written { slope, round: ToF32 }, strip, codes),
    }
}

/// Row by row, block by block.
fn fill<T: Height, R: Rule<Sum = T::Sum>>(
    plan: &BakePlan,
    channels: usize,
    rule: &R,
    strip: &Band<'_, T>,
    codes: &mut [R::Code],
) {
    let mut block = Block::new();
    for (row, codes) in codes.chunks_mut(plan.size.width() * channels).enumerate() {
        for (first, texels) in (0..).step_by(BLOCK).zip(codes.chunks_mut(BLOCK * channels)) {
            let count = texels.len() / channels;
            sums_of_block(plan, strip, row, first, &mut block.sums, count);
            block.round(rule, count);
            block.interleave(texels, channels);
        }
    }
}

/// The sums of the columns `first..first + count` of a row.
fn sums_of_block<T: Height>(
    plan: &BakePlan,
    strip: &Band<'_, T>,
    row: usize,
    first: usize,
    sums: &mut [[T::Sum; BLOCK]; 2],
    count: usize,
) {
    let last = plan.size.width() - 1;
    for border in [0, last].into_iter().filter(|column| (first..first + count).contains(column)) {
        let at_border = T::sums(plan.stencil, strip.neighbours(plan.edges.x, border, row));
        sums.iter_mut().zip(at_border).for_each(|(sums, sum)| sums[border - first] = sum);
    }
    let inside = first.max(1)..(first + count).min(last);
    if !inside.is_empty() {
        let rows = [-1, 0, 1].map(|step| strip.row(row as isize + step));
        let sums = sums.each_mut().map(|sums| &mut sums[inside.start - first..inside.end - first]);
        sums_inside(plan.stencil, rows, inside.start, sums);
    }
}
