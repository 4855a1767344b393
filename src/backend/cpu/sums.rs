//! The stencil sums of heights.

use crate::ops::bake::{Stencil, float_sums, integer_sums};

/// What a height is to the sums.
pub(crate) trait Height: Copy + Send + Sync {
    type Sum: Copy + Default + Send;

    fn sums(stencil: Stencil, around: [[Self; 3]; 3]) -> [Self::Sum; 2];
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
