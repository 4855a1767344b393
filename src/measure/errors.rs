//! How far many answers are from the truth, in three numbers.

use serde::Serialize;

/// The sizes of many errors, in the unit of what was compared.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Errors {
    /// The largest.
    pub largest: f64,
    /// What 99 of 100 do not exceed: the one of rank ceil(0.99 n) of n in their order.
    pub percentile_99: f64,
    /// Their mean.
    pub mean: f64,
}

impl Errors {
    /// Of errors at or above zero, in any order; of none all are zero. One that is NaN counts as infinite, so that it is
    /// within no tolerance.
    ///
    /// ```
    /// use texbake::measure::Errors;
    ///
    /// let errors = Errors::of((1..=200).map(|error| error as f32).collect());
    /// assert_eq!(errors, Errors { largest: 200.0, percentile_99: 198.0, mean: 100.5 });
    /// ```
    pub fn of(mut errors: Vec<f32>) -> Self {
        if errors.is_empty() {
            return Self::default();
        }
        errors.iter_mut().filter(|error| error.is_nan()).for_each(|error| *error = f32::INFINITY);
        let count = errors.len();
        let mean = errors.iter().copied().map(f64::from).sum::<f64>() / count as f64;
        let largest = errors.iter().copied().fold(0.0, f32::max);
        let rank = (count * 99).div_ceil(100);
        let (_, percentile_99, _) = errors.select_nth_unstable_by(rank - 1, f32::total_cmp);
        Self { largest: largest.into(), percentile_99: (*percentile_99).into(), mean }
    }
}

#[cfg(test)]
mod tests {
    use super::Errors;

    #[test]
    fn what_is_no_number_is_the_largest() {
        for nan in [f32::NAN, -f32::NAN] {
            let mut errors = vec![1.0; 200];
            errors[77] = nan;
            assert_eq!(Errors::of(errors), Errors { largest: f64::INFINITY, percentile_99: 1.0, mean: f64::INFINITY });
        }
    }
}
