//! EXR height and normal maps, read.

use super::choose::{Wanted, choose};
use crate::error::{Error, Result};
use crate::io::damage::{damaged, io_reason, truncated};
use crate::io::groups::{GroupDecoder, GroupedRows};
use crate::io::samples::{Layout, Opened, Samples};
use crate::io::{input, limits};
use crate::map::HeightType;
use exr::block::UncompressedBlock;
use exr::block::chunk::{Chunk, CompressedBlock};
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, SampleType};
use exr::meta::{BlockDescription, MetaData};
use half::f16;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// An EXR by blocks of scan lines or rows of tiles, found through the file's own table of block offsets.
struct ExrBlocks {
    path: PathBuf,
    file: BufReader<File>,
    file_bytes: u64,
    meta: MetaData,
    layer: usize,
    layout: Layout,
    /// Columns and rows of a block, and blocks beside each other.
    block_width: usize,
    block_rows: usize,
    across: usize,
    /// Where each block of the largest level stands, in rows from the top.
    offsets: Vec<u64>,
    channels: Vec<BlockChannel>,
    /// Bytes of a texel, all channels.
    texel_bytes: usize,
}

/// A wanted channel of a block.
#[derive(Debug, Clone, Copy)]
struct BlockChannel {
    /// Bytes of a texel in the channels before it.
    before: usize,
    half: bool,
}

/// Opens an EXR: half and float channels, of scan lines or tiles, of every compression that the decoder knows.
pub(crate) fn open(path: &Path, wanted: Wanted<'_>, max_bytes: u64) -> Result<Opened> {
    let file = input::open(path)?;
    let file_bytes = file.metadata().map_err(Error::io(path))?.len();
    let mut file = BufReader::new(file);
    let meta = MetaData::read_from_buffered(&mut file, false).map_err(reason(path))?;
    let tables = file.stream_position().map_err(Error::io(path))?;
    let (layer, wanted) = choose(path, &meta.headers, wanted)?;
    let header = &meta.headers[layer];

    // Everything that the header claims is checked before the decoder allocates for it, tile sizes too.
    let Vec2(width, height) = header.layer_size;
    let size = limits::size(path, width as u64, height as u64)?;
    let (block_width, block_rows) = match header.blocks {
        BlockDescription::ScanLines => (width, header.compression.scan_lines_per_block()),
        BlockDescription::Tiles(tiles) => (tiles.tile_size.0, tiles.tile_size.1),
    };
    if block_width == 0 || block_rows == 0 {
        return Err(damaged(path, "its tiles are empty"));
    }
    let texel_bytes = header.channels.bytes_per_pixel;
    let (across, down) = (width.div_ceil(block_width), height.div_ceil(block_rows));
    let rows_held = block_rows.min(height);
    let block_bytes = block_width as u128 * block_rows as u128 * texel_bytes as u128;
    let held_bytes = width as u128 * rows_held as u128 * wanted.len() as u128 * 4;
    limits::check(path, size, block_bytes + held_bytes, max_bytes)?;

    let skipped: u128 = meta.headers[..layer].iter().map(|header| header.chunk_count as u128 * 8).sum();
    let table_bytes = across as u128 * down as u128 * 8;
    if u128::from(tables) + skipped + table_bytes > file_bytes.into() {
        return Err(truncated(path));
    }
    MetaData::validate(&meta.headers, false).map_err(reason(path))?;
    if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(Error::file(path, "some of its channels are subsampled", "export every channel at full size"));
    }

    let mut table = vec![0; table_bytes as usize];
    file.seek(SeekFrom::Start(tables + skipped as u64)).map_err(Error::io(path))?;
    file.read_exact(&mut table).map_err(Error::io(path))?;
    let offsets = table.as_chunks::<8>().0.iter().map(|offset| u64::from_le_bytes(*offset)).collect();

    let layout = Layout { size, depth: HeightType::F32, colours: wanted.len(), alpha: false };
    let channels = wanted.iter().map(|index| block_channel(path, &header.channels.list, *index));
    let blocks = ExrBlocks {
        path: path.into(),
        file,
        file_bytes,
        layer,
        layout,
        block_width,
        block_rows,
        across,
        offsets,
        channels: channels.collect::<Result<_>>()?,
        texel_bytes,
        meta,
    };
    Ok(Opened { channel_found: true, ..Opened::new(GroupedRows::new(blocks)) })
}

/// Where a channel stands in a block.
fn block_channel(path: &Path, channels: &[ChannelDescription], index: usize) -> Result<BlockChannel> {
    let bytes = |channel: &ChannelDescription| channel.sample_type.bytes_per_sample();
    if channels[index].sample_type == SampleType::U32 {
        let reason = format!("its channel {} holds integers", channels[index].name);
        return Err(Error::file(path, reason, "export it as half or float"));
    }
    let before = channels[..index].iter().map(bytes).sum();
    Ok(BlockChannel { before, half: channels[index].sample_type == SampleType::F16 })
}

impl ExrBlocks {
    /// Reads a block of `raw_bytes` bytes before compression.
    fn read_block(&mut self, offset: u64, raw_bytes: usize) -> Result<UncompressedBlock> {
        // An offset that was never written is zero: the file is incomplete.
        if offset == 0 || offset >= self.file_bytes {
            return Err(truncated(&self.path));
        }
        self.file.seek(SeekFrom::Start(offset)).map_err(Error::io(&self.path))?;
        let chunk = Chunk::read(&mut self.file, &self.meta).map_err(reason(&self.path))?;
        if !self.sections_are_credible(&chunk, raw_bytes) {
            return Err(damaged(&self.path, "a compressed block claims more than it can hold"));
        }
        UncompressedBlock::decompress_chunk(chunk, &self.meta, false).map_err(reason(&self.path))
    }

    /// Whether a DWA block's sections are no larger than its texels, in whole cells of 8 x 8, can need.
    ///
    /// The decoder allocates what the ten counters at the block's start claim, before it looks at the data.
    fn sections_are_credible(&self, chunk: &Chunk, raw_bytes: usize) -> bool {
        let compression = self.meta.headers.get(chunk.layer_index).map(|header| header.compression);
        let Some(Compression::DWAA(_) | Compression::DWAB(_)) = compression else { return true };
        let bytes = match &chunk.compressed_block {
            CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
            CompressedBlock::Tile(block) => &block.compressed_pixels_le,
            _ => return false,
        };
        if bytes.len() == raw_bytes {
            // Not compressed at all, since that would have made it larger.
            return true;
        }
        let bound = 2 * (self.block_width + 7) * (self.block_rows + 7) * self.texel_bytes + 4096;
        bytes.as_chunks::<8>().0.iter().take(10).all(|counter| u64::from_le_bytes(*counter) <= bound as u64)
    }

    /// Copies the wanted channels of a block to their place; a block holds, line by line, channel after channel.
    fn put(&self, data: &[u8], left: usize, columns: usize, rows: usize, group: &mut Samples) {
        let Samples::F32(group) = group else { unreachable!("EXR samples are read as floats") };
        let (per_texel, per_row) = (self.layout.per_texel(), self.layout.per_row());
        for row in 0..rows {
            let line = &data[row * columns * self.texel_bytes..][..columns * self.texel_bytes];
            for (sample, channel) in self.channels.iter().enumerate() {
                let from = &line[channel.before * columns..];
                let to = &mut group[row * per_row + left * per_texel + sample..];
                let to = to.iter_mut().step_by(per_texel).take(columns);
                if channel.half {
                    to.zip(from.as_chunks::<2>().0).for_each(|(to, from)| *to = f16::from_ne_bytes(*from).to_f32());
                } else {
                    to.zip(from.as_chunks::<4>().0).for_each(|(to, from)| *to = f32::from_ne_bytes(*from));
                }
            }
        }
    }
}

impl GroupDecoder for ExrBlocks {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn group_rows(&self) -> usize {
        self.block_rows
    }

    /// A block, the bytes that it comes from and what its compression needs between them, and the table of blocks.
    fn held_bytes(&self) -> u64 {
        let block = self.block_width as u64 * self.block_rows as u64 * self.texel_bytes as u64;
        3 * block + 8 * self.offsets.len() as u64
    }

    fn decode(&mut self, index: usize, group: &mut Samples) -> Result<()> {
        let (width, height) = (self.layout.size.width(), self.layout.size.height());
        for column in 0..self.across {
            let (left, top) = (column * self.block_width, index * self.block_rows);
            let (columns, rows) = (self.block_width.min(width - left), self.block_rows.min(height - top));
            let raw_bytes = columns * rows * self.texel_bytes;
            let block = self.read_block(self.offsets[index * self.across + column], raw_bytes)?;
            let expected = (self.layer, Vec2(0, 0), Vec2(left, top), Vec2(columns, rows));
            let found = (block.index.layer, block.index.level, block.index.pixel_position, block.index.pixel_size);
            if found != expected || block.data.len() != raw_bytes {
                return Err(damaged(&self.path, "a block is not where its table says"));
            }
            self.put(&block.data, left, columns, rows, group);
        }
        Ok(())
    }
}

/// The decoder's reason, with the file and the way out.
fn reason(path: &Path) -> impl FnOnce(exr::error::Error) -> Error + '_ {
    use exr::error::Error::{Io, NotSupported};
    move |error| match error {
        Io(error) => io_reason(path, error),
        NotSupported(what) => Error::file(path, what, "export it as a flat image with ZIP compression"),
        // What the decoder says when bytes are missing.
        error if error.to_string().contains("reference to missing bytes") => truncated(path),
        error => damaged(path, error),
    }
}
