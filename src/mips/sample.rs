//! What is summed up, and the loops that do it.

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

/// Adds a row of samples, each times `weight`, to sums.
pub(super) fn add_weighted<T: Sample>(samples: &[T], weight: u64, sums: &mut [T::Sum]) {
    match weight {
        1 => add(samples, sums),
        weight => add_times(samples, weight, sums),
    }
}

vectorised! {
    fn add<T: Sample>(samples: &[T], sums: &mut [T::Sum]) {
        for (sum, sample) in sums.iter_mut().zip(samples) {
            *sum = *sum + sample.once();
        }
    }
}

vectorised! {
    fn add_times<T: Sample>(samples: &[T], weight: u64, sums: &mut [T::Sum]) {
        for (sum, sample) in sums.iter_mut().zip(samples) {
            *sum = *sum + sample.times(weight);
        }
    }
}

vectorised! {
    /// The sums of two neighbours each.
    pub(super) fn add_pairs<S: Sum>(columns: &[S], sums: &mut [S]) {
        for (sum, [left, right]) in sums.iter_mut().zip(columns.as_chunks::<2>().0) {
            *sum = left.once() + right.once();
        }
    }
}
