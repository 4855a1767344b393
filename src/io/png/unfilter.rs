//! The inverse of the filters of PNG's rows (PNG specification, section 9).

/// Undoes the filter of a row of `texel`-byte texels, given the row above; `false` if there is no such filter.
pub(super) fn unfilter(filter: u8, filtered: &[u8], above: &[u8], texel: usize, row: &mut [u8]) -> bool {
    match filter {
        0 => row.copy_from_slice(filtered),
        2 => sum(filtered, above, row),
        1 | 3 | 4 => match texel {
            1 => by_texels::<1>(filter, filtered, above, row),
            2 => by_texels::<2>(filter, filtered, above, row),
            3 => by_texels::<3>(filter, filtered, above, row),
            4 => by_texels::<4>(filter, filtered, above, row),
            6 => by_texels::<6>(filter, filtered, above, row),
            _ => by_texels::<8>(filter, filtered, above, row),
        },
        _ => return false,
    }
    true
}

vectorised! {
    fn sum(filtered: &[u8], guess: &[u8], row: &mut [u8]) {
        for ((byte, filtered), guess) in row.iter_mut().zip(filtered).zip(guess) {
            *byte = filtered.wrapping_add(*guess);
        }
    }
}

/// The filters that look to the left: one texel after the other.
fn by_texels<const TEXEL: usize>(filter: u8, filtered: &[u8], above: &[u8], row: &mut [u8]) {
    match filter {
        1 => guessed::<TEXEL>(filtered, above, row, |left, _, _| left),
        3 => guessed::<TEXEL>(filtered, above, row, |left, up, _| (left + up) / 2),
        _ => guessed::<TEXEL>(filtered, above, row, nearest),
    }
}

#[inline(always)]
fn guessed<const TEXEL: usize>(
    filtered: &[u8],
    above: &[u8],
    row: &mut [u8],
    guess: impl Fn(i16, i16, i16) -> i16 + Copy,
) {
    let texels = row.as_chunks_mut::<TEXEL>().0.iter_mut();
    let given = filtered.as_chunks::<TEXEL>().0.iter().zip(above.as_chunks::<TEXEL>().0);
    // Left of the first texel there is 0.
    let (mut left, mut upper_left) = ([0; TEXEL], [0; TEXEL]);
    for (texel, (filtered, above)) in texels.zip(given) {
        for k in 0..TEXEL {
            let up = i16::from(above[k]);
            texel[k] = filtered[k].wrapping_add(guess(left[k], up, upper_left[k]) as u8);
            (left[k], upper_left[k]) = (i16::from(texel[k]), up);
        }
    }
}

/// The Paeth predictor with few steps between one texel and the next (as in stb_image, by F. Giesen).
#[inline(always)]
fn nearest(left: i16, up: i16, upper_left: i16) -> i16 {
    let threshold = 3 * upper_left - (left + up);
    let (low, high) = (left.min(up), left.max(up));
    let below = if high <= threshold { low } else { upper_left };
    if threshold <= low { high } else { below }
}

#[cfg(test)]
mod tests {
    use super::super::filter::{self, Filter};
    use super::*;

    /// The filters' predictor is held against the specification.
    #[test]
    fn the_nearest_is_the_filters() {
        for neighbours in 0..1u32 << 24 {
            let [a, b, c, _] = neighbours.to_le_bytes();
            assert_eq!(nearest(a.into(), b.into(), c.into()), i16::from(filter::nearest(a, b, c)), "{a} {b} {c}");
        }
    }

    #[test]
    fn what_was_filtered_comes_back() {
        let byte = |k: usize| (k * k * 7 + k * 31) as u8;
        for texel in [1, 2, 3, 4, 6, 8] {
            let (above, row): (Vec<u8>, Vec<u8>) = (0..24 * texel).map(|k| (byte(k), byte(k + 1000))).unzip();
            for filter in [Filter::Sub, Filter::Up, Filter::Average, Filter::Paeth] {
                let mut filtered = Vec::new();
                filter.apply(&row, &above, texel, &mut filtered);
                let mut back = vec![0xa5; row.len()];
                assert!(unfilter(filtered[0], &filtered[1..], &above, texel, &mut back));
                assert_eq!(back, row, "{filter:?} {texel}");
            }
            let mut back = vec![0xa5; row.len()];
            assert!(unfilter(0, &row, &above, texel, &mut back) && back == row);
            assert!(!unfilter(5, &row, &above, texel, &mut back));
        }
    }
}
