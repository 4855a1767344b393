//! Files of every kind, and what must stand in them: names and numbers of formats written out from the specifications.

use crate::io::support::{Folder, Noise};
use block_compression::decode::decompress_blocks_as_rgba8;
use block_compression::{BC7Settings, CompressionVariant};
use std::path::PathBuf;
use texbake::io::{BlockCompression, WriteOptions, create_normals_with, create_parallax_with};
use texbake::stream::MapOut;
use texbake::{Channels, Codes, CodesRef, Depth, Encoding, NormalFormat, ParallaxFormat, Result, Size};

use BlockCompression::{Bc4, Bc5, Bc7};
use Depth::{Bits8, Bits16, Float16, Float32};
use Encoding::{Float, Snorm, Unorm};

/// A map's texels, and the formats that hold them.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    pub encoding: Encoding,
    pub depth: Depth,
    /// Codes of a texel of the map.
    pub channels: usize,
    pub blocks: Option<BlockCompression>,
    /// VkFormat (Vulkan, "VkFormat"), DXGI_FORMAT (dxgiformat.h).
    pub vulkan: u32,
    pub dxgi: u32,
    /// Bytes of a texel or block.
    pub bytes: usize,
}

const fn texels(encoding: Encoding, depth: Depth, channels: usize, vulkan: u32, dxgi: u32, bytes: usize) -> Kind {
    Kind { encoding, depth, channels, blocks: None, vulkan, dxgi, bytes }
}

const fn blocks(
    blocks: BlockCompression,
    encoding: Encoding,
    channels: usize,
    vulkan: u32,
    dxgi: u32,
    bytes: usize,
) -> Kind {
    Kind { encoding, depth: Bits8, channels, blocks: Some(blocks), vulkan, dxgi, bytes }
}

pub const KINDS: [Kind; 27] = [
    texels(Unorm, Bits8, 1, 9, 61, 1),
    texels(Unorm, Bits8, 2, 16, 49, 2),
    texels(Unorm, Bits8, 3, 37, 28, 4),
    texels(Snorm, Bits8, 1, 10, 63, 1),
    texels(Snorm, Bits8, 2, 17, 51, 2),
    texels(Snorm, Bits8, 3, 38, 31, 4),
    texels(Unorm, Bits16, 1, 70, 56, 2),
    texels(Unorm, Bits16, 2, 77, 35, 4),
    texels(Unorm, Bits16, 3, 91, 11, 8),
    texels(Snorm, Bits16, 1, 71, 58, 2),
    texels(Snorm, Bits16, 2, 78, 37, 4),
    texels(Snorm, Bits16, 3, 92, 13, 8),
    texels(Float, Float16, 1, 76, 54, 2),
    texels(Float, Float16, 2, 83, 34, 4),
    texels(Float, Float16, 3, 97, 10, 8),
    texels(Float, Float32, 1, 100, 41, 4),
    texels(Float, Float32, 2, 103, 16, 8),
    texels(Float, Float32, 3, 109, 2, 16),
    blocks(Bc4, Unorm, 1, 139, 80, 8),
    blocks(Bc4, Snorm, 1, 140, 81, 8),
    // One component has BC4 blocks whatever the normal map beside it has.
    blocks(Bc7, Snorm, 1, 140, 81, 8),
    blocks(Bc5, Unorm, 2, 141, 83, 16),
    blocks(Bc5, Unorm, 3, 141, 83, 16),
    blocks(Bc5, Snorm, 2, 142, 84, 16),
    blocks(Bc5, Snorm, 3, 142, 84, 16),
    blocks(Bc7, Unorm, 3, 145, 98, 16),
    blocks(Bc5, Unorm, 1, 139, 80, 8),
];

/// No multiples of 4, single texels, long and short sides.
pub const SIZES: [(usize, usize); 7] = [(1, 1), (5, 3), (17, 9), (64, 64), (3, 130), (8, 4), (300, 1)];

pub const CONTAINERS: [&str; 2] = ["ktx2", "dds"];

/// A file, and what was written into it.
pub struct Made {
    pub path: PathBuf,
    pub kind: Kind,
    pub levels: Vec<Level>,
}

/// Texels of a level as codes.
#[derive(Debug, Clone)]
pub struct Level {
    pub width: usize,
    pub height: usize,
    pub codes: Codes,
}

impl Kind {
    pub fn name(&self) -> String {
        let blocks = self.blocks.map_or("texels".into(), |blocks| blocks.to_string());
        format!("{}_{}_{}_{blocks}", self.encoding, self.depth, self.channels)
    }

    /// Creates a file of this kind.
    pub fn create(&self, path: &std::path::Path, (width, height): (usize, usize), mips: bool) -> Result<MapOut> {
        let options = WriteOptions { mips, blocks: self.blocks, ..WriteOptions::default() };
        let size = Size::new(width, height)?;
        match self.normal() {
            Some(format) => create_normals_with(path, size, format, &options),
            None => create_parallax_with(path, size, self.parallax(), &options),
        }
    }

    /// The normal map that it holds; `None`: it holds a parallax map.
    pub fn normal(&self) -> Option<NormalFormat> {
        let Self { encoding, depth, .. } = *self;
        let channels = [None, Some(Channels::Xy), Some(Channels::Xyz)][self.channels - 1]?;
        Some(NormalFormat { encoding, depth, channels, ..NormalFormat::default() })
    }

    /// The parallax map of its encoding and depth.
    pub fn parallax(&self) -> ParallaxFormat {
        ParallaxFormat { encoding: self.encoding, depth: self.depth }
    }

    /// Noise for all levels, which need not be means of each other to be told apart.
    pub fn levels(&self, (width, height): (usize, usize), mips: bool) -> Vec<Level> {
        let mut noise = Noise((self.vulkan as u64) << 20 | (width * 1000 + height) as u64);
        let mut levels = Vec::new();
        let (mut width, mut height) = (width, height);
        loop {
            levels.push(Level { width, height, codes: self.codes(width * height, &mut noise) });
            if !mips || (width, height) == (1, 1) {
                return levels;
            }
            (width, height) = ((width / 2).max(1), (height / 2).max(1));
        }
    }

    fn codes(&self, texels: usize, noise: &mut Noise) -> Codes {
        let mut codes = Codes::zeroed(self.depth, texels * self.channels);
        // Around a slow wave, so that blocks have ranges of all sizes; never snorm's -128, which is no code.
        let mut wave = |at: usize, steps: i64| {
            let spread = (at / 97) as i64 % (steps / 2) + 1;
            let centre = steps / 2 + ((at / 31) as i64 * steps / 50) % (steps / 2);
            (centre + noise.next() as i64 % (2 * spread) - spread).clamp(0, steps)
        };
        let signed = self.encoding == Snorm;
        match &mut codes {
            Codes::U8(codes) => codes.iter_mut().enumerate().for_each(|(at, code)| {
                *code = if signed { (wave(at, 254) - 127) as u8 } else { wave(at, 255) as u8 };
            }),
            Codes::U16(codes) => codes.iter_mut().enumerate().for_each(|(at, code)| {
                *code = if signed { (wave(at, 65534) - 32767) as u16 } else { wave(at, 65535) as u16 };
            }),
            Codes::F16(codes) => codes.iter_mut().enumerate().for_each(|(at, code)| {
                *code = half::f16::from_f32(wave(at, 65535) as f32 / 32768.0 - 1.0);
            }),
            Codes::F32(codes) => {
                codes.iter_mut().enumerate().for_each(|(at, code)| *code = wave(at, 1 << 23) as f32 / 4194304.0 - 1.0);
            }
        }
        codes
    }

    /// Bytes of a level, and of a row of texels or blocks.
    pub fn sizes(&self, level: &Level) -> (usize, usize) {
        let side = if self.blocks.is_some() { 4 } else { 1 };
        let row = level.width.div_ceil(side) * self.bytes;
        (row * level.height.div_ceil(side), row)
    }

    /// What an uncompressed level is in a file: each texel with its alpha, the least significant byte first.
    pub fn texel_bytes(&self, level: &Level) -> Vec<u8> {
        let alpha: &[u8] = match (self.channels, self.encoding, self.depth) {
            (1 | 2, ..) => &[],
            (_, Unorm, Bits8) => &[0xff],
            (_, Snorm, Bits8) => &[0x7f],
            (_, Unorm, _) => &[0xff, 0xff],
            (_, Snorm, _) => &[0xff, 0x7f],
            (_, _, Float16) => &[0x00, 0x3c],
            _ => &[0x00, 0x00, 0x80, 0x3f],
        };
        let bytes: Vec<u8> = match &level.codes {
            Codes::U8(codes) => codes.clone(),
            Codes::U16(codes) => codes.iter().flat_map(|code| code.to_le_bytes()).collect(),
            Codes::F16(codes) => codes.iter().flat_map(|code| code.to_le_bytes()).collect(),
            Codes::F32(codes) => codes.iter().flat_map(|code| code.to_le_bytes()).collect(),
        };
        let texels = bytes.chunks_exact(bytes.len() / (level.width * level.height));
        texels.flat_map(|texel| [texel, alpha].concat()).collect()
    }
}

impl Made {
    /// Writes a file at once: its largest level, then the others.
    pub fn new(folder: &Folder, kind: Kind, size: (usize, usize), mips: bool, container: &str) -> Self {
        let name = format!("{}_{}x{}_{}.{container}", kind.name(), size.0, size.1, if mips { "mips" } else { "one" });
        let path = folder.path(&name);
        let levels = kind.levels(size, mips);
        let codes: Vec<CodesRef<'_>> = levels.iter().map(|level| level.codes.as_ref()).collect();
        write_at_once(kind.create(&path, size, mips).unwrap(), &codes);
        Self { path, kind, levels }
    }

    /// Every kind in every size, with mips and without, in both containers.
    pub fn all(folder: &Folder) -> Vec<Self> {
        let mut all = Vec::new();
        for kind in KINDS {
            for size in SIZES {
                for mips in [false, true] {
                    all.extend(CONTAINERS.map(|container| Self::new(folder, kind, size, mips, container)));
                }
            }
        }
        all
    }

    pub fn bytes(&self) -> Vec<u8> {
        std::fs::read(&self.path).unwrap()
    }

    pub fn is_ktx2(&self) -> bool {
        self.path.extension().unwrap() == "ktx2"
    }
}

/// Writes all rows of each level, the largest first.
pub fn write_at_once(file: MapOut, levels: &[CodesRef<'_>]) {
    let MapOut { mut rows, levels: smaller } = file;
    assert!(smaller.is_some() || levels.len() == 1);
    rows.write(0, levels[0]).unwrap();
    if let Some(mut smaller) = smaller {
        (1..levels.len()).for_each(|level| smaller.write(level, 0, levels[level]).unwrap());
    }
    rows.finish().unwrap();
}

/// BC7 blocks by the decoder of `block_compression`: the format leaves a decoder no freedom.
pub fn bc7(blocks: &[u8], level: &Level) -> Vec<u8> {
    let variant = CompressionVariant::BC7(BC7Settings::opaque_basic());
    let [width, height] = [level.width, level.height].map(|side| side.next_multiple_of(4));
    let mut rgba = vec![0; width * height * 4];
    decompress_blocks_as_rgba8(variant, width as u32, height as u32, blocks, &mut rgba);
    rgba.chunks_exact(width * 4).take(level.height).flat_map(|row| row[..level.width * 4].to_vec()).collect()
}
