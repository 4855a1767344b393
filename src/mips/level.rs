//! The levels of a mip chain, and the coarsest level from whose sums those of a level are made.

use super::axis::Axis;
use crate::map::Size;

/// One level below the largest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Level {
    pub size: Size,
    /// The level that it is summed from: 0, or one whose texels it does not cut.
    pub source: usize,
    /// Its columns over those of the source.
    pub x: Axis,
    /// Its rows over those of the source.
    pub y: Axis,
    /// What the weights of the texels of level 0 under one of its texels add up to.
    pub weight: u64,
}

/// The levels of a map of `size` from level 1 on.
///
/// A sum over a texel weighs each texel of level 0 by the parts that are covered of it, in the largest parts that are
/// whole for this level. Where two or more texels of a finer level make exactly one, in the same parts, their sums add
/// up to its sum; that is so all the way down from a power of two. Elsewhere it comes from level 0.
pub(super) fn levels(size: Size) -> Vec<Level> {
    let sizes: Vec<Size> = size.levels().collect();
    let over_largest =
        |level: usize| [Axis::new(size.width(), sizes[level].width()), Axis::new(size.height(), sizes[level].height())];
    let made_of = |level: usize, source: usize| {
        let axes = [
            Axis::new(sizes[source].width(), sizes[level].width()),
            Axis::new(sizes[source].height(), sizes[level].height()),
        ];
        let whole = over_largest(level);
        let adds_up = (0..2).all(|axis| over_largest(source)[axis].length * axes[axis].length == whole[axis].length);
        let cuts_none = axes.iter().all(|axis| axis.is_whole());
        (cuts_none && adds_up).then_some((source, axes))
    };
    let level = |level: usize| {
        let whole = over_largest(level);
        let finer = (1..level).rev().find_map(|source| made_of(level, source));
        let (source, [x, y]) = finer.unwrap_or((0, whole));
        Level { size: sizes[level], source, x, y, weight: whole[0].length * whole[1].length }
    };
    (1..sizes.len()).map(level).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sources(width: usize, height: usize) -> Vec<usize> {
        levels(Size::new(width, height).unwrap()).iter().map(|level| level.source).collect()
    }

    #[test]
    fn levels_come_from_the_coarsest_that_they_do_not_cut() {
        assert_eq!(sources(256, 256), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(sources(256, 1), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(sources(16, 4), [0, 1, 2, 3]);
        // 50, 25, 12, 6, 3, 1: 12 cuts 25; 3 counts in hundredths of a texel, 25 and 1 in whole ones.
        assert_eq!(sources(100, 100), [0, 1, 0, 3, 4, 2]);
        assert!(sources(1, 1).is_empty());
    }

    #[test]
    fn weights_are_the_area_in_parts() {
        let weights = |width, height| -> Vec<u64> {
            levels(Size::new(width, height).unwrap()).iter().map(|level| level.weight).collect()
        };
        assert_eq!(weights(8, 4), [4, 16, 32]);
        assert_eq!(weights(5, 3), [5 * 3, 5 * 3]);
        assert_eq!(weights(6, 6), [4, 36]);
    }
}
