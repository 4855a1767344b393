//! Part of a row in planar arrays, and the three passes over it.

use super::rule::Rule;
use crate::ops::bake::{Stencil, float_sums, integer_sums};
use std::ops::Range;

/// Texels of a block: its arrays stay in the first cache.
pub(super) const BLOCK: usize = 512;

/// Passes may compute texels up to the next multiple of this, so that narrow blocks have no scalar remainder.
const LANES: usize = 64;

/// What a height is to the sums.
pub(super) trait Height: Copy + Send + Sync {
    type Sum: Copy + Default + PartialEq;

    fn sums(stencil: Stencil, around: [[Self; 3]; 3]) -> [Self::Sum; 2];
}

/// Scratch for the texels of one block.
pub(super) struct Block<S, C> {
    pub sums: [[S; BLOCK]; 2],
    codes: [[C; BLOCK]; 3],
    doubts: [bool; BLOCK],
    /// The sums that were in doubt last, and their codes.
    mended: Option<([S; 2], [C; 3])>,
}

impl<S: Copy + Default + PartialEq, C: Copy + Default> Block<S, C> {
    pub fn new() -> Self {
        Self {
            sums: [[S::default(); BLOCK]; 2],
            codes: [[C::default(); BLOCK]; 3],
            doubts: [false; BLOCK],
            mended: None,
        }
    }

    /// From sums to codes, for the first `count` texels.
    pub fn round<R: Rule<Sum = S, Code = C>>(&mut self, rule: &R, count: usize) {
        estimate(rule, self, count.next_multiple_of(LANES).min(BLOCK));
        for group in (0..count).step_by(LANES) {
            if self.doubts[group..][..LANES].iter().fold(false, |any, doubt| any | doubt) {
                self.mend(rule, group..(group + LANES).min(count));
            }
        }
    }

    /// The exact codes of the texels in doubt.
    fn mend<R: Rule<Sum = S, Code = C>>(&mut self, rule: &R, texels: Range<usize>) {
        for at in texels.filter(|at| self.doubts[*at]) {
            let sums = [self.sums[0][at], self.sums[1][at]];
            // On a plane every texel may lie on the same tie.
            let codes = match self.mended {
                Some((mended, codes)) if mended == sums => codes,
                _ => rule.exact_codes(sums),
            };
            self.mended = Some((sums, codes));
            self.codes.iter_mut().zip(codes).for_each(|(plane, code)| plane[at] = code);
        }
    }

    /// The codes as texels of two or three.
    pub fn interleave(&self, texels: &mut [C], channels: usize) {
        match channels {
            2 => interleave2(&self.codes, texels),
            _ => interleave3(&self.codes, texels),
        }
    }
}

/// The sums of the columns from `first` on, of which none touches a border; the rows are above, this, below.
pub(super) fn sums_inside<T: Height>(stencil: Stencil, rows: [&[T]; 3], first: usize, sums: [&mut [T::Sum]; 2]) {
    match stencil {
        Stencil { outer: 0, .. } => sums_of_central(rows, first, sums),
        _ => sums_of_any(stencil, rows, first, sums),
    }
}

vectorised! {
    fn sums_of_any<T: Height>(stencil: Stencil, rows: [&[T]; 3], first: usize, sums: [&mut [T::Sum]; 2]) {
        sums_of(stencil, rows, first, sums);
    }
}

vectorised! {
    /// The same with constants, so that what weighs nothing is not computed.
    fn sums_of_central<T: Height>(rows: [&[T]; 3], first: usize, sums: [&mut [T::Sum]; 2]) {
        sums_of(Stencil { centre: 1, outer: 0 }, rows, first, sums);
    }
}

#[inline(always)]
fn sums_of<T: Height>(stencil: Stencil, rows: [&[T]; 3], first: usize, sums: [&mut [T::Sum]; 2]) {
    let [gx, gy] = sums;
    let count = gx.len();
    let gy = &mut gy[..count];
    let [[nw, n, ne], [w, o, e], [sw, s, se]] =
        rows.map(|row| [&row[first - 1..][..count], &row[first..][..count], &row[first + 1..][..count]]);
    for i in 0..count {
        let around = [[nw[i], n[i], ne[i]], [w[i], o[i], e[i]], [sw[i], s[i], se[i]]];
        [gx[i], gy[i]] = T::sums(stencil, around);
    }
}

vectorised! {
    fn estimate<R: Rule>(rule: &R, block: &mut Block<R::Sum, R::Code>, count: usize) {
        let Block { sums: [gx, gy], codes: [x, y, z], doubts, .. } = block;
        for i in 0..count.min(BLOCK) {
            let (codes, doubt) = rule.codes([gx[i], gy[i]]);
            [x[i], y[i], z[i]] = codes;
            doubts[i] = doubt;
        }
    }
}

vectorised! {
    fn interleave3<C: Copy>(codes: &[[C; BLOCK]; 3], texels: &mut [C]) {
        let [x, y, z] = codes;
        for (((texel, x), y), z) in texels.as_chunks_mut::<3>().0.iter_mut().zip(x).zip(y).zip(z) {
            *texel = [*x, *y, *z];
        }
    }
}

vectorised! {
    fn interleave2<C: Copy>(codes: &[[C; BLOCK]; 3], texels: &mut [C]) {
        let [x, y, _] = codes;
        for ((texel, x), y) in texels.as_chunks_mut::<2>().0.iter_mut().zip(x).zip(y) {
            *texel = [*x, *y];
        }
    }
}

impl Height for u8 {
    type Sum = i32;

    #[inline(always)]
    fn sums(stencil: Stencil, around: [[Self; 3]; 3]) -> [i32; 2] {
        integer_sums(stencil, around)
    }
}

impl Height for u16 {
    type Sum = i32;

    #[inline(always)]
    fn sums(stencil: Stencil, around: [[Self; 3]; 3]) -> [i32; 2] {
        integer_sums(stencil, around)
    }
}

impl Height for f32 {
    type Sum = f32;

    #[inline(always)]
    fn sums(stencil: Stencil, around: [[Self; 3]; 3]) -> [f32; 2] {
        float_sums(stencil, around)
    }
}
