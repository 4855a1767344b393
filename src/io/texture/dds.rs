//! What stands before the levels of a DDS file (Microsoft's Programming Guide for DDS, with the DX10 extension).

use super::format::TextureFormat;
use super::levels::Level;
use crate::error::{Error, Result};
use ddsfile::{AlphaMode, D3D10ResourceDimension, Header, Header10, PixelFormatFlags};
use std::path::Path;

const MAGIC: &[u8; 4] = b"DDS ";
/// Magic number, header and DX10 header.
const HEADER_BYTES: u64 = 4 + 124 + 20;

/// Gives the levels their places, the largest first and without gaps, and writes the headers that stand before them.
///
/// # Errors
/// [`Error::File`] for more than readers count with: sizes in bytes and rows in bits of 32 bits.
pub fn lay_out(path: &Path, format: &TextureFormat, levels: &mut [Level]) -> Result<Vec<u8>> {
    let mut end = HEADER_BYTES;
    for level in levels.iter_mut() {
        level.offset = end;
        end += level.bytes;
    }
    let largest = levels[0];
    if end > u32::MAX.into() || largest.row_bytes > (u32::MAX / 8) as usize {
        let reason = format!(
            "{} x {} texels are {end} bytes, and readers of DDS files count to 4 GiB",
            largest.width, largest.height
        );
        return Err(Error::file(path, reason, "write .ktx2, whose sizes have 64 bits"));
    }

    let [width, height] = [largest.width, largest.height].map(|side| side as u32);
    let failed = |error| Error::file(path, error, "write another format");
    let mut header =
        Header::new_dxgi(height, width, None, format.dxgi, Some(levels.len() as u32), None, None).map_err(failed)?;
    // The crate also says RGB, for which some readers take the file before they look at its DX10 header.
    header.spf.flags = PixelFormatFlags::FOURCC;
    header.spf.rgb_bit_count = None;
    let header10 = Header10::new(format.dxgi, false, D3D10ResourceDimension::Texture2D, 1, AlphaMode::Opaque);
    let mut bytes = MAGIC.to_vec();
    header.write(&mut bytes).and_then(|()| header10.write(&mut bytes)).map_err(failed)?;
    Ok(bytes)
}
