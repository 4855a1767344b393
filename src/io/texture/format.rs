//! Which GPU format a map has in a file.

use super::blocks::Blocks;
use crate::error::{Error, Result};
use crate::io::sink::cannot_hold;
use crate::map::{Depth, Encoding, TexelFormat};
use crate::names::named;
use ddsfile::DxgiFormat;
use ktx2::Format;
use std::path::Path;

/// Blocks of 4 x 4 texels that a GPU reads as they are.
///
/// With any of them, a map of one component has BC4 blocks: a normal map and its parallax map are written alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BlockCompression {
    /// One component, 4 bits a texel; unorm or snorm.
    Bc4,
    /// Two components, 8 bits a texel; unorm or snorm. Of x, y and z, the first two.
    Bc5,
    /// Three components, 8 bits a texel; unorm. Its alpha is one, but for an error of up to a step of 1/255.
    Bc7,
}

named! {
    BlockCompression "block-compression" { Bc4 = "bc4", Bc5 = "bc5", Bc7 = "bc7" }
}

/// How the texels of a map stand in a file.
#[derive(Debug, Clone, Copy)]
pub struct TextureFormat {
    /// Its name in KTX2.
    pub vulkan: Format,
    /// Its name in DDS.
    pub dxgi: DxgiFormat,
    /// `None`: texel by texel.
    pub blocks: Option<Blocks>,
    /// Bytes of a texel, or of a block.
    pub bytes: usize,
}

impl TextureFormat {
    /// The format of the file `path` for a map of `format`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if no GPU format holds such codes, or no such block.
    pub fn of(path: &Path, format: TexelFormat, compression: Option<BlockCompression>) -> Result<Self> {
        match compression {
            Some(compression) => Self::of_blocks(path, format, compression),
            None => Self::of_texels(path, format),
        }
    }

    /// One format for each code of a texel; three have a fourth beside them, since no GPU samples three.
    fn of_texels(path: &Path, format: TexelFormat) -> Result<Self> {
        use {Depth::*, DxgiFormat as Dxgi, Encoding::*, Format as Vulkan};
        let [one, two, four] = match (format.encoding, format.depth) {
            (Unorm, Bits8) => [
                (Vulkan::R8_UNORM, Dxgi::R8_UNorm),
                (Vulkan::R8G8_UNORM, Dxgi::R8G8_UNorm),
                (Vulkan::R8G8B8A8_UNORM, Dxgi::R8G8B8A8_UNorm),
            ],
            (Snorm, Bits8) => [
                (Vulkan::R8_SNORM, Dxgi::R8_SNorm),
                (Vulkan::R8G8_SNORM, Dxgi::R8G8_SNorm),
                (Vulkan::R8G8B8A8_SNORM, Dxgi::R8G8B8A8_SNorm),
            ],
            (Unorm, Bits16) => [
                (Vulkan::R16_UNORM, Dxgi::R16_UNorm),
                (Vulkan::R16G16_UNORM, Dxgi::R16G16_UNorm),
                (Vulkan::R16G16B16A16_UNORM, Dxgi::R16G16B16A16_UNorm),
            ],
            (Snorm, Bits16) => [
                (Vulkan::R16_SNORM, Dxgi::R16_SNorm),
                (Vulkan::R16G16_SNORM, Dxgi::R16G16_SNorm),
                (Vulkan::R16G16B16A16_SNORM, Dxgi::R16G16B16A16_SNorm),
            ],
            (Float, Float16) => [
                (Vulkan::R16_SFLOAT, Dxgi::R16_Float),
                (Vulkan::R16G16_SFLOAT, Dxgi::R16G16_Float),
                (Vulkan::R16G16B16A16_SFLOAT, Dxgi::R16G16B16A16_Float),
            ],
            (Float, Float32) => [
                (Vulkan::R32_SFLOAT, Dxgi::R32_Float),
                (Vulkan::R32G32_SFLOAT, Dxgi::R32G32_Float),
                (Vulkan::R32G32B32A32_SFLOAT, Dxgi::R32G32B32A32_Float),
            ],
            _ => {
                let remedy = "unorm or snorm in KTX2 and DDS: a GPU has no biased formats; PNG and TIFF hold them";
                return Err(cannot_hold(path, format, remedy));
            }
        };
        let (codes, (vulkan, dxgi)) = match format.channels {
            1 => (1, one),
            2 => (2, two),
            _ => (4, four),
        };
        Ok(Self { vulkan, dxgi, blocks: None, bytes: codes * format.depth.bytes() })
    }

    fn of_blocks(path: &Path, format: TexelFormat, compression: BlockCompression) -> Result<Self> {
        use {BlockCompression::*, DxgiFormat as Dxgi, Format as Vulkan};
        if !matches!(format.encoding, Encoding::Unorm | Encoding::Snorm) {
            return Err(cannot_hold(path, format, "unorm or snorm with 8 bits in blocks"));
        }
        if format.depth != Depth::Bits8 {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            return Err(Error::parameter("bits", format_args!("{}, for {name}", format.depth), "8 in blocks"));
        }
        let signed = format.encoding == Encoding::Snorm;
        let (blocks, vulkan, dxgi, bytes) = match (format.channels, compression, signed) {
            (1, _, false) => (Blocks::BC4, Vulkan::BC4_UNORM_BLOCK, Dxgi::BC4_UNorm, 8),
            (1, _, true) => (Blocks::BC4.signed(), Vulkan::BC4_SNORM_BLOCK, Dxgi::BC4_SNorm, 8),
            (_, Bc5, false) => (Blocks::BC5, Vulkan::BC5_UNORM_BLOCK, Dxgi::BC5_UNorm, 16),
            (_, Bc5, true) => (Blocks::BC5.signed(), Vulkan::BC5_SNORM_BLOCK, Dxgi::BC5_SNorm, 16),
            (3, Bc7, false) => (Blocks::BC7, Vulkan::BC7_UNORM_BLOCK, Dxgi::BC7_UNorm, 16),
            (3, Bc7, true) => {
                let remedy = "unorm in bc7 blocks, which have no signed numbers; bc5 blocks have them";
                return Err(cannot_hold(path, format, remedy));
            }
            (channels, ..) => {
                let range = match channels {
                    2 => "bc5 for the channels xy",
                    _ => "bc5 (x and y) or bc7 (x, y and z) for a normal map; bc4 blocks hold one component",
                };
                return Err(Error::parameter("block-compression", compression, range));
            }
        };
        Ok(Self { vulkan, dxgi, blocks: Some(blocks), bytes })
    }

    /// Texels along each side of what [`TextureFormat::bytes`] are of.
    pub fn side(&self) -> usize {
        if self.blocks.is_some() { Blocks::SIDE } else { 1 }
    }
}
