//! What is summed up, and the loops that do it.

use super::axis::{Axis, Covered};
use std::ops::Add;

/// A number that is summed up with weights.
pub(super) trait Sample: Copy + Default + Send + Sync {
    /// Integers add up without error as long as a map has less than 2^42 texels; floats in f64, each product and sum
    /// rounded.
    type Sum: Sum;

    /// As a sum.
    fn once(self) -> Self::Sum;

    /// Times a weight below 2^42.
    fn times(self, weight: u64) -> Self::Sum;
}

/// What samples add up to, and sums too.
pub(super) trait Sum: Sample<Sum = Self> + Add<Output = Self> {}

impl Sum for i64 {}
impl Sum for f64 {}

macro_rules! sample {
    ($($sample:ty => $sum:ty),*) => {$(
        impl Sample for $sample {
            type Sum = $sum;

            #[inline(always)]
            fn once(self) -> $sum {
                self.into()
            }

            #[inline(always)]
            fn times(self, weight: u64) -> $sum {
                self.once() * weight as $sum
            }
        }
    )*};
}

sample!(i32 => i64, i64 => i64, f32 => f64, f64 => f64);

/// Adds to the sums of texels from texel `first` on what they cover of a row of finer ones, times `weight`.
pub(super) fn add_along<T: Sample>(axis: Axis, first: usize, row: &[T], weight: u64, sums: &mut [T::Sum]) {
    if axis.is_pairs() && weight == 1 {
        add_pairs(&row[2 * first..], sums);
    } else {
        add_covered(axis, first, row, weight, sums);
    }
}

vectorised! {
    fn add_pairs<T: Sample>(row: &[T], sums: &mut [T::Sum]) {
        for (sum, [left, right]) in sums.iter_mut().zip(row.as_chunks::<2>().0) {
            *sum = *sum + (left.once() + right.once());
        }
    }
}

vectorised! {
    fn add_covered<T: Sample>(axis: Axis, first: usize, row: &[T], weight: u64, sums: &mut [T::Sum]) {
        for (sum, Covered { finer, left, inner, right }) in sums.iter_mut().zip(axis.texels(first)) {
            let along = match &row[finer] {
                [] => T::Sum::default(),
                [only] => only.times(left),
                [first, between @ .., last] => {
                    let whole = between.iter().fold(T::Sum::default(), |sum, sample| sum + sample.once());
                    first.times(left) + whole.times(inner) + last.times(right)
                }
            };
            *sum = *sum + along.times(weight);
        }
    }
}
