//! A block: some texels in planar arrays that stay in the first cache.

/// Texels of a block.
pub(super) const BLOCK: usize = 512;

/// Passes may compute texels up to the next multiple of this, so that narrow blocks have no scalar remainder.
pub(super) const LANES: usize = 64;

/// One value of each texel of a block.
pub(super) type Plane<T> = [T; BLOCK];

/// How many texels a pass computes for `count` texels of a block.
pub(super) fn padded(count: usize) -> usize {
    count.next_multiple_of(LANES).min(BLOCK)
}

/// The values of one texel.
#[inline(always)]
pub(super) fn texel<T: Copy>([x, y, z]: &[Plane<T>; 3], at: usize) -> [T; 3] {
    [x[at], y[at], z[at]]
}
