//! An axis: which numbers it shows, and where.

use crate::measure::digits;

/// How numbers lie along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Spacing {
    Linear,
    /// By their logarithms; zero lies at the beginning.
    Log,
    /// By the logarithms of one more: zero is a number like others.
    LogFromZero,
}

/// An axis with what it measures.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    pub name: String,
    spacing: Spacing,
    low: f64,
    high: f64,
    /// Whether the beginning stands for zero.
    has_zero: bool,
}

impl Axis {
    /// One that shows all of some numbers at or above zero.
    pub fn new(name: impl Into<String>, spacing: Spacing, numbers: impl Iterator<Item = f64>) -> Self {
        let numbers: Vec<f64> = numbers.filter(|number| number.is_finite()).collect();
        let above_zero = || numbers.iter().copied().filter(|number| *number > 0.0);
        let least = above_zero().fold(f64::INFINITY, f64::min);
        let most = above_zero().fold(0.0, f64::max);
        let (least, most) = if most > 0.0 { (least, most) } else { (1.0, 1.0) };
        let has_zero = numbers.contains(&0.0);
        let (low, high) = match spacing {
            Spacing::Linear => {
                (if has_zero { 0.0 } else { least - 0.08 * (most - least) }, most + 0.08 * (most - least))
            }
            Spacing::Log if has_zero => (10f64.powf(least.log10().floor() - 1.0), most * 2.0),
            Spacing::Log => (least / 2.0, most * 2.0),
            Spacing::LogFromZero => (0.0, most * 1.3),
        };
        let high = if high > low { high } else { low + 1.0 };
        Self { name: name.into(), spacing, low, high, has_zero }
    }

    /// Where a number lies, from 0 to 1.
    pub fn share(&self, number: f64) -> f64 {
        let at = |number: f64| match self.spacing {
            Spacing::Linear => number,
            Spacing::Log => number.max(self.low).log10(),
            Spacing::LogFromZero => number.ln_1p(),
        };
        (at(number) - at(self.low)) / (at(self.high) - at(self.low))
    }

    /// Numbers to write along the axis, with their text.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let numbers: Vec<f64> = match self.spacing {
            Spacing::Linear => {
                let step = round_step((self.high - self.low) / 8.0);
                let first = (self.low / step).ceil() as i64;
                (first..).map(|i| i as f64 * step).take_while(|number| *number <= self.high).collect()
            }
            Spacing::Log => {
                let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
                let is_short = self.high / self.low < 200.0;
                let multiples: &[f64] = if is_short { &[1.0, 2.0, 5.0] } else { &[1.0] };
                decades.flat_map(|decade| multiples.iter().map(move |it| it * 10f64.powi(decade))).collect()
            }
            Spacing::LogFromZero => std::iter::successors(Some(1.0), |number| Some(2.0 * number))
                .take_while(|number| *number <= self.high)
                .collect(),
        };
        let mut ticks: Vec<(f64, String)> = numbers
            .into_iter()
            .filter(|number| *number <= self.high && (*number > self.low || (*number == self.low && !self.has_zero)))
            .map(|number| (number, digits(number)))
            .collect();
        if self.has_zero {
            ticks.push((self.low, "0".into()));
        }
        ticks
    }
}

/// The next of 1, 2, 5, 10 and so on.
fn round_step(at_least: f64) -> f64 {
    let decade = 10f64.powf(at_least.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|it| it * decade).find(|step| *step >= at_least).unwrap_or(10.0 * decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_and_within_the_axis() {
        let bytes = Axis::new("bytes", Spacing::Linear, [2.0, 12.0].into_iter());
        assert_eq!(texts(&bytes), ["2", "4", "6", "8", "10", "12"]);
        let degrees = Axis::new("degrees", Spacing::Log, [3e-6, 0.0, 0.4].into_iter());
        assert_eq!(texts(&degrees), ["1e-6", "1e-5", "0.0001", "0.001", "0.01", "0.1", "0"]);
        assert_eq!((degrees.share(0.0), degrees.share(0.8)), (0.0, 1.0));
        let fetches = Axis::new("fetches", Spacing::LogFromZero, [0.0, 21.0].into_iter());
        assert_eq!(texts(&fetches), ["1", "2", "4", "8", "16", "0"]);
        // Numbers that are all the same, or none, have an axis too.
        assert!(Axis::new("", Spacing::Log, [0.0].into_iter()).share(0.0).is_finite());
        assert!(Axis::new("", Spacing::Linear, std::iter::empty()).share(1.0).is_finite());
    }
}
