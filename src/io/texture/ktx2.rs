//! What stands around the levels of a KTX2 file (KTX File Format Specification, version 2.0).

use super::format::TextureFormat;
use super::levels::Level;
use crate::error::{Error, Result};
use ktx2::dfd::{Basic, Block};
use ktx2::{Header, Index, LevelIndex};
use std::path::Path;

/// Keys in the order of their code points, values with the null that ends them (section 5): the first texel is the
/// upper left one, and who wrote the file.
const METADATA: [(&str, &str); 2] = [("KTXorientation", "rd\0"), ("KTXwriter", "texbake\0")];

/// Gives the levels their places, and writes all that stands before them: header, level index, data format descriptor,
/// and keys and values.
pub fn lay_out(path: &Path, format: &TextureFormat, levels: &mut [Level]) -> Result<Vec<u8>> {
    let (descriptor, type_size) = descriptor(path, format)?;
    let metadata = metadata();
    let dfd_at = Header::LENGTH + levels.len() * LevelIndex::LENGTH;
    let metadata_at = dfd_at + descriptor.len();

    // The smallest level comes first (section 3.9.7), each at a multiple of its texels or blocks and of 4.
    let alignment = format.bytes.max(4) as u64;
    let mut end = (metadata_at + metadata.len()) as u64;
    for level in levels.iter_mut().rev() {
        level.offset = end.next_multiple_of(alignment);
        end = level.offset + level.bytes;
    }

    let header = Header {
        format: Some(format.vulkan),
        type_size,
        pixel_width: levels[0].width as u32,
        pixel_height: levels[0].height as u32,
        pixel_depth: 0,
        layer_count: 0,
        face_count: 1,
        level_count: levels.len() as u32,
        supercompression_scheme: None,
        index: Index {
            dfd_byte_offset: dfd_at as u32,
            dfd_byte_length: descriptor.len() as u32,
            kvd_byte_offset: metadata_at as u32,
            kvd_byte_length: metadata.len() as u32,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
    };
    let index = levels.iter().flat_map(|level| {
        let (byte_offset, byte_length) = (level.offset, level.bytes);
        LevelIndex { byte_offset, byte_length, uncompressed_byte_length: byte_length }.as_bytes()
    });
    Ok(header.as_bytes().into_iter().chain(index).chain(descriptor).chain(metadata).collect())
}

/// The data format descriptor with its length, and the bytes that a reader of the other byte order swaps.
///
/// The transfer function is linear. Primaries are unspecified, since there is no colour: what glTF asks of textures
/// that are none (KHR_texture_basisu).
fn descriptor(path: &Path, format: &TextureFormat) -> Result<(Vec<u8>, u32)> {
    let unknown = |error| Error::file(path, error, "write another format");
    let (mut basic, type_size) = Basic::from_format(format.vulkan).map_err(unknown)?;
    basic.color_primaries = None;
    let block = Block::Basic(basic).to_vec();
    let total = 4 + block.len() as u32;
    Ok((total.to_le_bytes().into_iter().chain(block).collect(), type_size))
}

/// Keys and values, each with its length before it and up to 3 zeros behind it.
fn metadata() -> Vec<u8> {
    let mut bytes = Vec::new();
    for (key, value) in METADATA {
        bytes.extend(((key.len() + 1 + value.len()) as u32).to_le_bytes());
        bytes.extend([key.as_bytes(), b"\0", value.as_bytes()].concat());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::texture::levels::levels;
    use crate::map::{NormalFormat, Size};

    #[test]
    fn levels_stand_beyond_4_gib() {
        let path = Path::new("n.ktx2");
        let format = TextureFormat::of(path, NormalFormat::default().texel(), None).unwrap();
        let mut levels = levels(Size::new(65_536, 65_536).unwrap(), true, &format);
        let bytes = lay_out(path, &format, &mut levels).unwrap();
        // Behind the headers, 4^0 + ... + 4^15 = (4^16 - 1) / 3 texels stand before the largest level.
        let smaller = 4 * ((1u64 << 32) - 1) / 3;
        let first = levels[16].offset;
        assert_eq!((levels.len(), levels[0].offset - first, levels[0].bytes), (17, smaller, 1 << 34));
        let entry = LevelIndex::from_bytes(&bytes[Header::LENGTH..][..LevelIndex::LENGTH].try_into().unwrap());
        assert_eq!(entry.byte_offset, first + smaller);
    }
}
