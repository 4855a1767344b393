//! The smallest input that still fails.

/// Runs that one search may take: each compiles nothing, and takes as long as a small job does.
const MOST_RUNS: usize = 600;

/// Walks from a failing input to ever smaller ones that fail too, until none of the candidates does.
///
/// `smaller` gives candidates for an input and how it fails, the boldest first; each must be simpler than its origin,
/// so that the walk ends.
pub(crate) fn shrink<I, F>(
    (mut smallest, mut failure): (I, F),
    smaller: impl Fn(&I, &F) -> Vec<I>,
    fails: impl Fn(&I) -> Option<F>,
) -> (I, F) {
    let mut runs = 0;
    'walk: loop {
        for candidate in smaller(&smallest, &failure) {
            if runs == MOST_RUNS {
                return (smallest, failure);
            }
            runs += 1;
            if let Some(how) = fails(&candidate) {
                (smallest, failure) = (candidate, how);
                continue 'walk;
            }
        }
        return (smallest, failure);
    }
}

/// Simpler values for an integer: zero, then the bits above the lowest ones taken away.
pub(crate) fn simpler_integers(value: u32) -> impl Iterator<Item = u32> {
    let halves = (1..=8).map(move |shift| value >> (9 - shift));
    std::iter::once(0).chain(halves).chain([value.wrapping_sub(1)]).filter(move |&simpler| simpler < value)
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

    #[test]
    fn the_smallest_failing_list_is_found() {
        let smaller = |list: &Vec<u32>, _: &()| {
            let without = (0..list.len()).map(|index| {
                let mut shorter = list.clone();
                shorter.remove(index);
                shorter
            });
            let simpler = (0..list.len()).flat_map(|index| {
                simpler_integers(list[index]).map(move |value| {
                    let mut other = list.clone();
                    other[index] = value;
                    other
                })
            });
            without.chain(simpler).collect()
        };
        let fails = |list: &Vec<u32>| list.iter().any(|&value| value > 100).then_some(());
        assert_eq!(shrink((vec![3, 70_000, 12, 900], ()), smaller, fails).0, [101]);
    }

    #[test]
    fn a_failure_that_nothing_simplifies_stays() {
        assert_eq!(shrink((7, 'a'), |_, _| vec![], |_| Some('b')), (7, 'a'));
        assert_eq!(shrink((7, 'a'), |_, _| vec![1, 2], |_| None), (7, 'a'));
        assert_eq!(shrink((7, 'a'), |&i, _| vec![i - 1], |&i| (i > 3).then_some('b')), (4, 'b'));
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
