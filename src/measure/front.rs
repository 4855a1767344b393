//! What each step buys and costs: Pareto fronts.

use super::Errors;
use serde::Serialize;
use std::fmt;

/// The error by which candidates are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// [`Errors::percentile_99`].
    #[serde(rename = "percentile_99")]
    Percentile99,
    /// [`Errors::mean`].
    Mean,
}

/// Something that may be chosen, with what it costs and how wrong it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Candidate {
    /// What it is.
    pub name: String,
    /// In the front's unit of costs.
    pub cost: f64,
    /// In the front's unit of errors.
    pub error: f64,
    /// Whether it is worth its cost: nothing that costs as little is as right, but for what is noise.
    pub is_on_front: bool,
}

/// From one candidate of a front to the next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Step {
    /// The cheaper one.
    pub from: String,
    /// The better one.
    pub to: String,
    /// What it costs more.
    pub extra_cost: f64,
    /// How many times smaller the error is; nothing where none is left.
    pub times_less_error: Option<f64>,
    /// The same in words.
    pub words: String,
}

/// Candidates that are compared, those that are worth choosing, and what each of these buys.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Front {
    /// What is compared.
    pub name: String,
    /// The error by which it is compared.
    pub by: Statistic,
    /// `bytes per texel`.
    pub cost_unit: &'static str,
    /// `degrees`.
    pub error_unit: &'static str,
    /// All of them, in the order in which they were measured.
    pub candidates: Vec<Candidate>,
    /// From the cheapest to the most right.
    pub steps: Vec<Step>,
}

/// The indices of the points (cost, error) that no other one beats: none costs as little with less error, nor less with
/// no more of it. By rising cost; of equal points the first.
///
/// ```
/// use texbake::measure::pareto_front;
///
/// assert_eq!(pareto_front(&[(1.0, 9.0), (2.0, 9.0), (2.0, 5.0), (3.0, 6.0)]), [0, 2]);
/// ```
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let by_cost_and_error = |&a: &usize, &b: &usize| {
        let ((cost, error), (other_cost, other_error)) = (points[a], points[b]);
        cost.total_cmp(&other_cost).then(error.total_cmp(&other_error))
    };
    order.sort_by(by_cost_and_error);
    let mut least = f64::INFINITY;
    order.retain(|&point| {
        let is_better = points[point].1 < least;
        least = least.min(points[point].1);
        is_better
    });
    order
}

/// The share of costs and errors by which they differ at least along a [`Front`]: less is noise, of times above all.
pub(super) const NOISE: f64 = 0.05;

impl Statistic {
    /// This number of some errors.
    pub fn of(self, errors: &Errors) -> f64 {
        match self {
            Self::Percentile99 => errors.percentile_99,
            Self::Mean => errors.mean,
        }
    }
}

impl fmt::Display for Statistic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Percentile99 => "the error that 99 of 100 do not exceed",
            Self::Mean => "the mean error",
        })
    }
}

impl Front {
    /// Of candidates by name, cost and error.
    pub fn new(
        name: impl Into<String>,
        by: Statistic,
        [cost_unit, error_unit]: [&'static str; 2],
        candidates: impl IntoIterator<Item = (String, f64, f64)>,
    ) -> Self {
        let candidate = |(name, cost, error)| Candidate { name, cost, error, is_on_front: false };
        let mut candidates: Vec<Candidate> = candidates.into_iter().map(candidate).collect();
        let points: Vec<(f64, f64)> = candidates.iter().map(|it| (it.cost, it.error)).collect();
        let front = without_noise(&points, pareto_front(&points));
        front.iter().for_each(|&index| candidates[index].is_on_front = true);
        let step = |pair: &[usize]| Step::between(&candidates[pair[0]], &candidates[pair[1]], cost_unit, error_unit);
        let steps = front.windows(2).map(step).collect();
        Self { name: name.into(), by, cost_unit, error_unit, candidates, steps }
    }

    /// The candidates that are worth choosing, by rising cost.
    pub fn best(&self) -> Vec<&Candidate> {
        let mut best: Vec<&Candidate> = self.candidates.iter().filter(|candidate| candidate.is_on_front).collect();
        best.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        best
    }

    /// In words: the cheapest, then what each step buys and costs.
    pub fn lines(&self) -> Vec<String> {
        let cheapest = self.best().first().map(|first| {
            let (cost, error) = (counted(first.cost, self.cost_unit), digits(first.error));
            format!("{} is the cheapest: {cost}, {error} {}", first.name, self.error_unit)
        });
        cheapest.into_iter().chain(self.steps.iter().map(|step| step.words.clone())).collect()
    }
}

/// The points of a front, by rising cost, without those that are no gain over the one before, nor those that cost as much
/// as a better one.
fn without_noise(points: &[(f64, f64)], front: Vec<usize>) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for index in front {
        let (cost, error) = points[index];
        if let Some(&last) = kept.last() {
            let (last_cost, last_error) = points[last];
            if error > (1.0 - NOISE) * last_error {
                continue;
            }
            if last_cost > (1.0 - NOISE) * cost {
                kept.pop();
            }
        }
        kept.push(index);
    }
    kept
}

impl Step {
    fn between(from: &Candidate, to: &Candidate, cost_unit: &str, error_unit: &str) -> Self {
        let extra_cost = to.cost - from.cost;
        let times_less_error = (to.error > 0.0).then(|| from.error / to.error);
        let gain = match times_less_error {
            Some(times) => format!("{} times less error", digits(times)),
            None => "the rest of the error".into(),
        };
        let words = format!(
            "from {} to {}: +{} buys {gain}, {} instead of {} {error_unit}",
            from.name,
            to.name,
            counted(extra_cost, cost_unit),
            digits(to.error),
            digits(from.error),
        );
        Self { from: from.name.clone(), to: to.name.clone(), extra_cost, times_less_error, words }
    }
}

/// `1 byte per texel`, `2 bytes per texel`.
fn counted(cost: f64, unit: &str) -> String {
    let one = match unit {
        "bytes per texel" => "byte per texel",
        "fetches per pixel" => "fetch per pixel",
        unit => unit,
    };
    format!("{} {}", digits(cost), if cost == 1.0 { one } else { unit })
}

/// A number with three digits that tell something, and all of those before the point: `1234`, `12.3`, `0.0123`, `1.2e-5`.
pub fn digits(number: f64) -> String {
    let magnitude = number.abs();
    if magnitude == 0.0 || !number.is_finite() {
        return number.to_string();
    }
    if !(1e-4..1e9).contains(&magnitude) {
        return format!("{number:.1e}").replace(".0e", "e");
    }
    let decimals = (2 - magnitude.log10().floor() as i32).max(0) as usize;
    let text = format!("{number:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn numbers_have_three_digits() {
        let numbers = [0.0, 1.0, 0.25, 1234.5, 12.345, 0.012_345, 0.000_012_3, -2.5, 9.999].map(digits);
        assert_eq!(numbers, ["0", "1", "0.25", "1234", "12.3", "0.0123", "1.2e-5", "-2.5", "10"]);
    }
}
