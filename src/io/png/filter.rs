//! The filters of PNG's rows (PNG specification, section 9): each byte less a guess from its neighbours.

/// How the bytes of a row are guessed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Filter {
    /// By the one a texel to the left.
    Sub = 1,
    /// By the one above.
    Up = 2,
    /// By the mean of both.
    Average = 3,
    /// By the one of left, up and upper left that is nearest to left + up - upper left.
    Paeth = 4,
}

/// How the filter of each row is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Choice {
    /// One filter for all rows.
    Fixed(Filter),
    /// The filter that leaves the least sum of differences (PNG specification, section 12.7).
    LeastSum,
}

impl Choice {
    /// Appends the filtered `row` as [`Filter::apply`] does, with the chosen filter.
    pub fn apply(self, row: &[u8], above: &[u8], texel: usize, filtered: &mut Vec<u8>) {
        let fixed = match self {
            Self::Fixed(filter) => return filter.apply(row, above, texel, filtered),
            Self::LeastSum => [Filter::Sub, Filter::Up, Filter::Average, Filter::Paeth],
        };
        let start = filtered.len();
        let mut sum_of = |filter: Filter| {
            filtered.truncate(start);
            filter.apply(row, above, texel, filtered);
            sum_of_differences(&filtered[start + 1..])
        };
        // The first of equals.
        if let Some(least) = fixed.into_iter().min_by_key(|filter| sum_of(*filter)) {
            filtered.truncate(start);
            least.apply(row, above, texel, filtered);
        }
    }
}

vectorised! {
    /// Of bytes that stand for -128 to 127.
    fn sum_of_differences(filtered: &[u8]) -> u64 {
        // A byte's sums fit 16 bits for 256 of them, and so they vectorise.
        let sum_of = |piece: &[u8]| piece.iter().map(|byte| u16::from((*byte as i8).unsigned_abs())).sum::<u16>();
        filtered.chunks(256).map(|piece| u64::from(sum_of(piece))).sum()
    }
}

impl Filter {
    /// Appends the filter's number and the filtered `row`, of `texel` bytes each, below the row `above`.
    pub fn apply(self, row: &[u8], above: &[u8], texel: usize, filtered: &mut Vec<u8>) {
        filtered.push(self as u8);
        let start = filtered.len();
        filtered.resize(start + row.len(), 0);
        let (first, rest) = filtered[start..].split_at_mut(texel);
        let (left, here) = (&row[..row.len() - texel], &row[texel..]);
        let (upper_left, up) = (&above[..above.len() - texel], &above[texel..]);
        // Left of the first texel there is 0.
        match self {
            Self::Sub => first.copy_from_slice(&row[..texel]),
            Self::Average => average(&row[..texel], &[0; 8][..texel], &above[..texel], first),
            Self::Up | Self::Paeth => less(&row[..texel], &above[..texel], first),
        }
        match self {
            Self::Sub => less(here, left, rest),
            Self::Up => less(here, up, rest),
            Self::Average => average(here, left, up, rest),
            Self::Paeth => paeth(here, left, up, upper_left, rest),
        }
    }
}

vectorised! {
    /// Each byte less its guess.
    fn less(row: &[u8], guess: &[u8], filtered: &mut [u8]) {
        for ((filtered, byte), guess) in filtered.iter_mut().zip(row).zip(guess) {
            *filtered = byte.wrapping_sub(*guess);
        }
    }
}

vectorised! {
    fn average(row: &[u8], left: &[u8], up: &[u8], filtered: &mut [u8]) {
        for (((filtered, byte), left), up) in filtered.iter_mut().zip(row).zip(left).zip(up) {
            // Half the sum, rounded down, without the ninth bit.
            *filtered = byte.wrapping_sub((left & up) + ((left ^ up) >> 1));
        }
    }
}

vectorised! {
    fn paeth(row: &[u8], left: &[u8], up: &[u8], upper_left: &[u8], filtered: &mut [u8]) {
        let around = left.iter().zip(up).zip(upper_left);
        for ((filtered, byte), ((left, up), upper_left)) in filtered.iter_mut().zip(row).zip(around) {
            *filtered = byte.wrapping_sub(nearest(*left, *up, *upper_left));
        }
    }
}

/// The Paeth predictor in bytes alone, which vectorises best (as in FPNGE, by L. Versari).
#[inline(always)]
pub(super) fn nearest(left: u8, up: u8, upper_left: u8) -> u8 {
    let from_left = up.max(upper_left) - up.min(upper_left);
    let from_up = left.max(upper_left) - left.min(upper_left);
    // The distance from the upper left is the sum of both, and no less than either, if left and up are on one side of it.
    let on_one_side = (left < upper_left) == (upper_left >= up);
    let difference = from_left.max(from_up) - from_left.min(from_up);
    let from_upper_left = if on_one_side { 255 } else { difference };
    let of_column = if from_up <= from_upper_left { up } else { upper_left };
    if from_left <= from_up && from_left <= from_upper_left { left } else { of_column }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The predictor in the words of the PNG specification, section 9.4.
    fn specified(a: u8, b: u8, c: u8) -> u8 {
        let p = i32::from(a) + i32::from(b) - i32::from(c);
        let [pa, pb, pc] = [a, b, c].map(|byte| (p - i32::from(byte)).abs());
        if pa <= pb && pa <= pc {
            a
        } else if pb <= pc {
            b
        } else {
            c
        }
    }

    #[test]
    fn the_nearest_is_the_specifications() {
        for neighbours in 0..1u32 << 24 {
            let [a, b, c, _] = neighbours.to_le_bytes();
            assert_eq!(nearest(a, b, c), specified(a, b, c), "{a} {b} {c}");
        }
    }

    #[test]
    fn rows_are_filtered_as_specified() {
        let byte = |k: usize| (k * k * 7 + k * 31) as u8;
        let (above, row): (Vec<u8>, Vec<u8>) = (0..600).map(|k| (byte(k), byte(k + 1000))).unzip();
        for texel in [1, 2, 3, 6] {
            let left = |row: &[u8], at: usize| if at < texel { 0 } else { row[at - texel] };
            let guess = |filter, at| match filter {
                Filter::Sub => left(&row, at),
                Filter::Up => above[at],
                Filter::Average => ((u32::from(left(&row, at)) + u32::from(above[at])) / 2) as u8,
                Filter::Paeth => specified(left(&row, at), above[at], left(&above, at)),
            };
            let sum =
                |filtered: &[u8]| filtered[1..].iter().map(|byte| (*byte as i8).unsigned_abs() as usize).sum::<usize>();
            let mut least = Vec::new();
            Choice::LeastSum.apply(&row, &above, texel, &mut least);
            for (number, filter) in [(1, Filter::Sub), (2, Filter::Up), (3, Filter::Average), (4, Filter::Paeth)] {
                let expected: Vec<u8> = (0..600).map(|at| row[at].wrapping_sub(guess(filter, at))).collect();
                let mut filtered = vec![9];
                filter.apply(&row, &above, texel, &mut filtered);
                assert_eq!(filtered, [&[9, number], &expected[..]].concat(), "{filter:?} {texel}");
                assert!(sum(&least) <= sum(&filtered[1..]), "{filter:?} {texel}");
            }
        }
    }
}
