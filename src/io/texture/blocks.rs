//! Blocks of 4 x 4 texels.
//!
//! The encoder is that of `block_compression` on the CPU: plain scalar f32 + - * / and square roots in the order of its
//! source, without fused operations, libraries of mathematics or threads of its own, so that the same texels become the
//! same bytes on every machine with IEEE f32.
//!
//! - BC4 and BC5: the ends of a block's range are its least and greatest code, and each texel gets the nearest of the
//!   eight steps between them. A decoded component is off by at most a fourteenth of the block's range, and its
//!   rounding. A block of one code is exact.
//! - BC7: the error that is made small is the plain sum of squares over x, y and z; the encoder has no perceptual
//!   weights, which would be wrong here. Its opaque settings leave alpha out of the error: mode 6 shares a bit between
//!   all four components, so that alpha may decode as 254. Of them the basic ones: the slow ones are several times
//!   slower for the same error, the fast ones are hardly faster (tests/containers/blocks.rs compares the errors).
//!
//! Signed blocks are the unsigned ones of the codes + 128: the order of codes and the steps between them are the same,
//! and the two ends move back.

use block_compression::encode::compress_rgba8;
use block_compression::{BC7Settings, CompressionVariant};

/// How blocks are made from texels of 8-bit codes.
#[derive(Debug, Clone, Copy)]
pub struct Blocks {
    variant: CompressionVariant,
    /// 0x80 for signed codes: what turns them into the unsigned ones in the same order, and back.
    flip: u8,
}

/// A row of blocks while its texels come.
#[derive(Debug)]
pub struct BlockRow {
    /// Its place among the rows of blocks.
    index: usize,
    /// RGBA, four rows of whole blocks.
    texels: Vec<u8>,
    /// Texels in a row of the map.
    width: usize,
    /// Rows that the map has here, and those that have not come.
    rows: usize,
    rows_left: usize,
}

const RGBA_BYTES: usize = 4;

/// Bytes of a row of texels that one thread compresses at a time: those of 256 blocks.
const PIECE: usize = 256 * Blocks::SIDE * RGBA_BYTES;

impl Blocks {
    /// Texels along each side of a block.
    pub const SIDE: usize = 4;
    /// One component.
    pub const BC4: Self = Self { variant: CompressionVariant::BC4, flip: 0 };
    /// Two components.
    pub const BC5: Self = Self { variant: CompressionVariant::BC5, flip: 0 };
    /// Three components and an alpha that nobody reads.
    pub const BC7: Self = Self { variant: CompressionVariant::BC7(BC7Settings::opaque_basic()), flip: 0 };

    /// The same of signed codes; not for BC7.
    pub const fn signed(self) -> Self {
        Self { flip: 0x80, ..self }
    }

    /// Bytes of the blocks of so many bytes of texels.
    pub fn bytes(self, texel_bytes: usize) -> usize {
        let width = texel_bytes / Self::SIDE / RGBA_BYTES;
        self.variant.blocks_byte_size(width as u32, Self::SIDE as u32)
    }

    /// The blocks of four rows of texels.
    pub fn compress(self, texels: &[u8]) -> Vec<u8> {
        let stride = texels.len() / Self::SIDE;
        let (width, height) = ((stride / RGBA_BYTES) as u32, Self::SIDE as u32);
        let mut bytes = vec![0; self.bytes(texels.len())];
        compress_rgba8(self.variant, texels, &mut bytes, width, height, stride as u32);
        // The two ends of each component's range.
        bytes.chunks_exact_mut(8).for_each(|component| component[..2].iter_mut().for_each(|end| *end ^= self.flip));
        bytes
    }

    /// Puts a row of the map's codes into its row of blocks; says whether that is all.
    pub fn fill(&self, into: &mut BlockRow, row: usize, codes: &[u8]) -> bool {
        let stride = into.texels.len() / Self::SIDE;
        let channels = codes.len() / into.width;
        let texels = &mut into.texels[row % Self::SIDE * stride..][..stride];
        for (texel, codes) in texels.chunks_exact_mut(RGBA_BYTES).zip(codes.chunks_exact(channels)) {
            texel.iter_mut().zip(codes).for_each(|(texel, code)| *texel = code ^ self.flip);
        }
        // Columns beyond the border repeat its last one.
        let last = RGBA_BYTES * (into.width - 1);
        let beyond = (last + RGBA_BYTES..stride).step_by(RGBA_BYTES);
        beyond.for_each(|beyond| texels.copy_within(last..last + RGBA_BYTES, beyond));
        into.rows_left -= 1;
        into.rows_left == 0
    }
}

impl BlockRow {
    /// Bytes of the texels that are compressed by themselves, at most: those of 256 blocks.
    pub const PIECE_BYTES: usize = Blocks::SIDE * PIECE;

    /// Bytes of the texels of a row of blocks, of a map of this width.
    pub fn texel_bytes(width: usize) -> usize {
        RGBA_BYTES * width.next_multiple_of(Blocks::SIDE) * Blocks::SIDE
    }

    /// Its place among the rows of blocks.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Its texels, which have come, in pieces that are compressed by themselves: four rows of each.
    pub fn pieces(self) -> impl Iterator<Item = Vec<u8>> {
        let Self { mut texels, rows, .. } = self;
        let stride = texels.len() / Blocks::SIDE;
        // Rows beyond the border repeat its last one.
        for beyond in rows..Blocks::SIDE {
            texels.copy_within((rows - 1) * stride..rows * stride, beyond * stride);
        }
        (0..stride).step_by(PIECE).map(move |first| {
            let piece = first..(first + PIECE).min(stride);
            let rows: Vec<&[u8]> = texels.chunks_exact(stride).map(|row| &row[piece.clone()]).collect();
            rows.concat()
        })
    }

    /// Whether row `row` of the map is in it.
    pub fn holds(&self, row: usize) -> bool {
        row / Blocks::SIDE == self.index
    }

    /// The row of blocks that holds row `row` of a map, without texels; what is no component is opaque black.
    pub fn of(row: usize, width: usize, height: usize) -> Self {
        let index = row / Blocks::SIDE;
        let rows = Blocks::SIDE.min(height - index * Blocks::SIDE);
        let texels = [0, 0, 0, u8::MAX].repeat(Self::texel_bytes(width) / RGBA_BYTES);
        Self { index, texels, width, rows, rows_left: rows }
    }
}
