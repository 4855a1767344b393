//! Rows of texels on their way to blocks in a texture.

use super::blocks::{BlockRow, Blocks};
use super::file::TextureFile;
use super::levels::Level;
use crate::error::Result;
use crate::io::in_order::InOrder;
use std::sync::Arc;

/// Compresses texels on all threads, and brings their blocks to their places.
pub struct BlockWriter {
    file: Arc<TextureFile>,
    blocks: Blocks,
    compressing: InOrder<Piece, Piece>,
}

/// What begins at this place of the file: blocks, or the texels of which they are made.
type Piece = (u64, Vec<u8>);

/// The rows of blocks of a level that wait for texels: at most the topmost one and the one that comes.
pub type WaitingRows = Vec<BlockRow>;

impl BlockWriter {
    pub fn new(file: Arc<TextureFile>, blocks: Blocks) -> Self {
        let compress = move |(place, texels): Piece| (place, blocks.compress(&texels));
        Self { file, blocks, compressing: InOrder::new(BlockRow::PIECE_BYTES, compress) }
    }

    /// Bytes that are held at most while rows of a level this wide are compressed: a row, and pieces with their blocks,
    /// which are no larger.
    pub fn held_bytes(width: usize) -> usize {
        BlockRow::texel_bytes(width) + 2 * (rayon::current_num_threads() + 1) * BlockRow::PIECE_BYTES
    }

    /// Takes rows of a level from row `first` on.
    pub fn write(&mut self, level: &Level, waiting: &mut WaitingRows, first: usize, codes: &[u8]) -> Result<()> {
        for (row, codes) in (first..).zip(codes.chunks_exact(self.file.codes.row_codes(level.width))) {
            let place = waiting.iter().position(|waiting| waiting.holds(row));
            let mut into = match place {
                Some(place) => waiting.swap_remove(place),
                None => BlockRow::of(row, level.width, level.height),
            };
            match self.blocks.fill(&mut into, row, codes) {
                false => waiting.push(into),
                true => self.compress(level, into)?,
            }
        }
        Ok(())
    }

    /// Waits for the last blocks.
    pub fn finish(&mut self) -> Result<()> {
        std::iter::from_fn(|| self.compressing.pop()).try_for_each(|(place, blocks)| self.file.write_at(place, &blocks))
    }

    fn compress(&mut self, level: &Level, row: BlockRow) -> Result<()> {
        let mut place = level.offset + row.index() as u64 * level.row_bytes as u64;
        for texels in row.pieces() {
            let bytes = self.blocks.bytes(texels.len());
            self.compressing.push((place, texels));
            place += bytes as u64;
            while let Some((place, blocks)) = self.compressing.pop_surplus() {
                self.file.write_at(place, &blocks)?;
            }
        }
        Ok(())
    }
}
