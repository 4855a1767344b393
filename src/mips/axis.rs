//! Which texels of one axis a texel of a smaller level covers, and how much of each.

use std::ops::Range;

/// `count` texels over `texels` finer ones: texel i covers from i n/c to (i + 1) n/c of the n finer ones.
///
/// Lengths are whole numbers of parts of a finer texel, so that the cut of a finer texel by a border is one too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Axis {
    /// Parts of a finer texel.
    parts: u64,
    /// Parts of a texel.
    pub length: u64,
    /// Texels.
    pub count: usize,
}

/// What a texel covers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Covered {
    /// The finer texels, the first and the last of them perhaps in part.
    pub finer: Range<usize>,
    /// Parts of the first one.
    pub left: u64,
    /// Parts of each between the first and the last one.
    pub inner: u64,
    /// Parts of the last one.
    pub right: u64,
}

impl Axis {
    /// `count` texels, at most `texels`, over `texels` finer ones.
    pub fn new(texels: usize, count: usize) -> Self {
        let common = gcd(texels, count);
        Self { parts: (count / common) as u64, length: (texels / common) as u64, count }
    }

    /// Whether each texel is exactly two finer ones.
    pub fn is_pairs(self) -> bool {
        (self.parts, self.length) == (1, 2)
    }

    /// Whether no finer texel is cut by a border.
    pub fn is_whole(self) -> bool {
        self.parts == 1
    }

    /// The finer texels that texel `i` covers, the first and the last of them perhaps in part.
    pub fn covered(self, i: usize) -> Range<usize> {
        let border = i as u64 * self.length;
        (border / self.parts) as usize..(border + self.length).div_ceil(self.parts) as usize
    }

    /// What the texels from texel `first` on cover, without a division for each.
    pub fn texels(self, first: usize) -> impl Iterator<Item = Covered> {
        let Self { parts, length, count } = self;
        let border = first as u64 * length;
        let (whole, rest) = ((length / parts) as usize, length % parts);
        let (mut finer, mut cut) = ((border / parts) as usize, border % parts);
        (first..count).map(move |_| {
            let (start, left) = (finer, parts - cut);
            (finer, cut) = (finer + whole, cut + rest);
            if cut >= parts {
                (finer, cut) = (finer + 1, cut - parts);
            }
            let (end, right) = if cut == 0 { (finer, parts) } else { (finer + 1, cut) };
            Covered { finer: start..end, left, inner: parts, right }
        })
    }

    /// The parts of the finer texel `x` that texel `i` covers.
    pub fn weight(self, i: usize, x: usize) -> u64 {
        let (border, finer) = (i as u64 * self.length, x as u64 * self.parts);
        (finer + self.parts).min(border + self.length) - finer.max(border)
    }

    /// The texels that the finer ones in `range` lie in.
    pub fn covering(self, range: &Range<usize>) -> Range<usize> {
        let [first, end] = [range.start, range.end].map(|x| x as u64 * self.parts);
        (first / self.length) as usize..end.div_ceil(self.length) as usize
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_every_finer_texel_is_in_one_texel() {
        for texels in 1..40 {
            for count in 1..=texels {
                let axis = Axis::new(texels, count);
                let mut parts = vec![0; texels];
                for i in 0..count {
                    let covered = axis.covered(i);
                    assert_eq!(covered.clone().map(|x| axis.weight(i, x)).sum::<u64>(), axis.length);
                    covered.for_each(|x| {
                        parts[x] += axis.weight(i, x);
                        assert!(axis.weight(i, x) > 0 && axis.covering(&(x..x + 1)).contains(&i));
                    });
                }
                assert_eq!(parts, vec![axis.parts; texels], "{count} of {texels}");
                for first in 0..count {
                    let one_by_one = (first..count).map(|i| {
                        let finer = axis.covered(i);
                        let [left, right] = [finer.start, finer.end - 1].map(|x| axis.weight(i, x));
                        Covered { finer, left, inner: axis.parts, right }
                    });
                    assert!(axis.texels(first).eq(one_by_one), "{count} of {texels} from {first}");
                }
            }
        }
    }

    #[test]
    fn two_texels_share_five() {
        let axis = Axis::new(5, 2);
        assert_eq!((axis.covered(0), axis.covered(1)), (0..3, 2..5));
        assert_eq!([0, 1, 2].map(|x| axis.weight(0, x)), [2, 2, 1]);
        assert_eq!([2, 3, 4].map(|x| axis.weight(1, x)), [1, 2, 2]);
        assert_eq!((axis.covering(&(0..2)), axis.covering(&(2..3)), axis.covering(&(3..5))), (0..1, 0..2, 1..2));
        assert!(Axis::new(6, 3).is_pairs() && !axis.is_pairs());
    }
}
