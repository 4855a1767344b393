//! The smallest input that still fails.

use std::ops::ControlFlow;

/// Runs that one search may take: each takes as long as a small job does.
const MOST_RUNS: usize = 600;

/// Takes a candidate, and breaks off when it needs no more.
pub(crate) type Try<'a, I> = &'a mut dyn FnMut(I) -> ControlFlow<()>;

/// Walks from a failing input to ever smaller ones that fail too, until none of the candidates does.
///
/// `smaller` hands on candidates for an input and how it fails, one after the other, the boldest first; each must be
/// simpler than its origin, so that the walk ends.
pub(crate) fn shrink<I, F>(
    (mut smallest, mut failure): (I, F),
    smaller: impl Fn(&I, &F, Try<'_, I>) -> ControlFlow<()>,
    mut fails: impl FnMut(&I) -> Option<F>,
) -> (I, F) {
    let mut left = MOST_RUNS;
    loop {
        let mut found = None;
        let _ = smaller(&smallest, &failure, &mut |candidate| {
            if left == 0 {
                return ControlFlow::Break(());
            }
            left -= 1;
            found = fails(&candidate).map(|how| (candidate, how));
            if found.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        match found {
            Some(simpler) => (smallest, failure) = simpler,
            None => return (smallest, failure),
        }
    }
}

/// Simpler values for an integer: zero, then less by a half, a quarter, and so on.
pub(crate) fn simpler_integers(value: u32) -> impl Iterator<Item = u32> {
    let less = (1..u32::BITS).map(move |shift| value - (value >> shift));
    std::iter::once(0).chain(less).filter(move |&simpler| simpler < value)
}

/// Simpler values for a float: zero, one, a whole number, fewer bits.
pub(crate) fn simpler_floats(value: f32) -> impl Iterator<Item = f32> {
    let bits = value.to_bits();
    let fewer = [23, 20, 16, 12, 8, 4, 1].into_iter().map(move |low| f32::from_bits(bits >> low << low));
    let candidates = [0.0, 1.0, value.trunc()].into_iter().chain(fewer).chain([value.abs()]);
    candidates.filter(move |simpler| weight(*simpler) < weight(value))
}

/// How complicated a float is: that of 0 is least; signs, bits of the mantissa and odd exponents count.
fn weight(value: f32) -> u32 {
    let bits = value.to_bits();
    let mantissa = bits & 0x7f_ffff;
    let length = if mantissa == 0 { 0 } else { 24 - mantissa.trailing_zeros() };
    let exponent = (bits >> 23 & 0xff).abs_diff(127);
    match value.to_bits() {
        0 => 0,
        _ => 1 + 1000 * length + 2 * exponent + (bits >> 31),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type List = Vec<u32>;

    /// A list without one of its numbers, or with one simpler number.
    fn smaller(list: &List, _: &(), mut try_: Try<'_, List>) -> ControlFlow<()> {
        (0..list.len()).map(|index| [&list[..index], &list[index + 1..]].concat()).try_for_each(&mut try_)?;
        (0..list.len())
            .flat_map(|index| simpler_integers(list[index]).map(move |value| (index, value)))
            .map(|(index, value)| [&list[..index], &[value], &list[index + 1..]].concat())
            .try_for_each(try_)
    }

    #[test]
    fn the_smallest_failing_list_is_found() {
        let fails = |list: &List| list.iter().any(|&value| value > 100).then_some(());
        assert_eq!(shrink((vec![3, 70_000, 12, 900], ()), smaller, fails).0, [101]);
    }

    #[test]
    fn a_failure_that_nothing_simplifies_stays() {
        assert_eq!(shrink((vec![7], ()), smaller, |_| None).0, [7]);
    }

    #[test]
    fn candidates_are_made_one_at_a_time_and_runs_are_bounded() {
        let mut runs = 0;
        let endless = |_: &u32, _: &(), try_: Try<'_, u32>| std::iter::repeat(1).try_for_each(try_);
        let found = shrink((7, ()), endless, |_| {
            runs += 1;
            None
        });
        assert_eq!((found.0, runs), (7, MOST_RUNS));
    }

    #[test]
    fn every_simpler_float_is_simpler() {
        for value in [1.0, -1.0, 0.3, -1.7e20, f32::MAX, 1e-42, 5.5] {
            assert!(simpler_floats(value).count() > 0, "{value}");
            for simpler in simpler_floats(value) {
                assert!(weight(simpler) < weight(value), "{simpler} for {value}");
            }
        }
        assert_eq!(simpler_floats(0.0).count(), 0);
    }
}
