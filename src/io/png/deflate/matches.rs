//! Deflate with all its matches, by zlib-rs, which gives the same bytes on every machine.

use super::bits::BitWriter;
use flate2::{Compress, Compression, FlushCompress, Status};

/// Appends `data`, deflated at this level of zlib, up to a byte's border.
pub(super) fn deflate(data: &[u8], level: u32, out: &mut BitWriter) {
    let mut zlib = Compress::new(Compression::new(level), false);
    // What does not shrink is stored, in blocks of 16 KiB or more.
    let mut deflated = Vec::with_capacity(data.len() + data.len() / 64 + 1024);
    loop {
        let given = usize::try_from(zlib.total_in()).unwrap_or(data.len());
        let status = zlib.compress_vec(&data[given..], &mut deflated, FlushCompress::Full);
        // There is room left when all is written.
        if !matches!(status, Ok(Status::Ok)) || deflated.len() < deflated.capacity() {
            break;
        }
        deflated.reserve(1024);
    }
    // What was not taken would be missing from a file that looks whole.
    assert_eq!(zlib.total_in(), data.len() as u64, "zlib takes all that it is given");
    out.whole(&deflated);
}
