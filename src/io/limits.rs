//! Sizes that a header claims, checked before anything is allocated for them.

use crate::error::{Error, Result};
use crate::map::Size;
use std::path::Path;

/// The size that a header claims.
pub(super) fn size(path: &Path, width: u64, height: u64) -> Result<Size> {
    if width == 0 || height == 0 {
        let reason = format!("its header claims {width} x {height} texels: it is empty");
        return Err(Error::file(path, reason, "export the map again"));
    }
    let as_size = || Size::new(width.try_into().ok()?, height.try_into().ok()?).ok();
    as_size().ok_or_else(|| {
        let reason = format!("its header claims {width} x {height} texels, more than any map holds");
        Error::file(path, reason, "the file is damaged; export the map again")
    })
}

/// Fails if decoding needs more than `limit` bytes at once.
pub(super) fn check(path: &Path, size: Size, bytes: u128, limit: u64) -> Result<()> {
    if bytes <= limit.into() {
        return Ok(());
    }
    let bytes = bytes.try_into().unwrap_or(u64::MAX);
    let (width, height) = (size.width() as u64, size.height() as u64);
    Err(Error::TooLarge { path: path.into(), width, height, bytes, limit })
}

/// Fails if the `stored` bytes of a file, which its decoder holds, are above `limit`.
pub(super) fn check_stored(path: &Path, stored: u64, limit: u64) -> Result<()> {
    if stored <= limit {
        return Ok(());
    }
    let reason = format!("its decoder would hold its {stored} bytes, above the limit of {limit}");
    Err(Error::file(path, reason, "raise it with --max-bytes, or convert the file to PNG"))
}

/// Fails if the whole map does not fit the limit.
pub(super) fn check_map(path: &Path, size: Size, texel_bytes: usize, limit: u64) -> Result<()> {
    check(path, size, size.texels() as u128 * texel_bytes as u128, limit)
}

/// Fails if `claimed` bytes cannot come out of a file of `stored` bytes of deflate data.
///
/// Deflate's densest code is a match of 258 bytes in two bits (RFC 1951, 3.2.5): 1032 bytes for one.
pub(super) fn check_deflated(path: &Path, size: Size, claimed: u128, stored: u64) -> Result<()> {
    if claimed <= 1032 * u128::from(stored) {
        return Ok(());
    }
    let reason = format!("its header claims {size} texels, which cannot come out of {stored} bytes: it is truncated");
    Err(Error::file(path, reason, "copy or export it again"))
}

/// Fails if the `stored` bytes of a model, or of a file that belongs to it, are above `limit`.
pub(super) fn check_model(path: &Path, stored: u64, limit: u64) -> Result<()> {
    if stored <= limit {
        return Ok(());
    }
    let reason = format!("it has {stored} bytes, and {limit} of the limit are left");
    Err(Error::file(path, reason, "raise it with --max-bytes"))
}
