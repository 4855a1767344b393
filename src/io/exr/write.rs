//! EXR normal and parallax maps, written: scan lines in ZIP blocks, which is lossless.

use crate::error::{Error, Result};
use crate::io::replace::{Output, Replacement};
use crate::io::sink::{FileSink, RowEncoder, cannot_hold};
use crate::map::{CodesRef, Depth, Size, TexelFormat};
use exr::block::chunk::Chunk;
use exr::block::{BlockIndex, UncompressedBlock};
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, LineOrder, SampleType, Text};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, Headers};
use rayon::prelude::*;
use std::io::{Cursor, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Blocks of 16 lines.
const COMPRESSION: Compression = Compression::ZIP16;

/// Gathers rows into blocks, which are compressed side by side.
struct ExrEncoder {
    path: PathBuf,
    output: Output,
    size: Size,
    headers: Headers,
    /// For each channel of the file, in its alphabetical order, its place in a texel of codes.
    order: &'static [usize],
    sample_bytes: usize,
    /// Codes of the rows that do not fill a block yet, as bytes.
    pending: Vec<u8>,
    /// Rows that were written.
    rows_done: usize,
    /// Bytes that were written.
    position: u64,
    /// Where the table of block offsets stands, and the offsets so far.
    table: u64,
    offsets: Vec<u64>,
}

/// Creates an EXR with the channels R, G and B, or R and G, or Y alone, of half or float samples.
pub(crate) fn create(path: &Path, size: Size, format: TexelFormat) -> Result<Box<FileSink>> {
    let sample_type = sample_type(path, format)?;
    // EXR sorts channels by name.
    let (layer, names, order): (_, &[&str], &'static [usize]) = match format.channels {
        1 => ("parallax", &["Y"], &[0]),
        2 => ("normals", &["G", "R"], &[1, 0]),
        _ => ("normals", &["B", "G", "R"], &[2, 1, 0]),
    };
    let channels = names.iter().map(|name| ChannelDescription::new(*name, sample_type, true)).collect();
    let header = Header::new(Text::from(layer), (size.width(), size.height()), channels).with_encoding(
        COMPRESSION,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    let headers: Headers = [header].into_iter().collect();

    let replacement = Replacement::create(path)?;
    let mut output = replacement.output()?;
    let first_bytes = header_bytes(path, &headers)?;
    output.write_all(&first_bytes).map_err(Error::io(path))?;
    let position = first_bytes.len() as u64;
    let encoder = ExrEncoder {
        path: path.into(),
        output,
        size,
        order,
        sample_bytes: format.depth.bytes(),
        pending: Vec::new(),
        rows_done: 0,
        position,
        table: position - 8 * headers[0].chunk_count as u64,
        offsets: Vec::new(),
        headers,
    };
    Ok(FileSink::boxed(encoder, replacement, size, format))
}

/// Fails if an EXR cannot hold `format`.
pub(crate) fn check(path: &Path, format: TexelFormat) -> Result<()> {
    sample_type(path, format).map(drop)
}

fn sample_type(path: &Path, format: TexelFormat) -> Result<SampleType> {
    match format.depth {
        Depth::Float16 => Ok(SampleType::F16),
        Depth::Float32 => Ok(SampleType::F32),
        Depth::Bits8 | Depth::Bits16 => {
            Err(cannot_hold(path, format, "float with 16f or 32f bits in EXR; PNG and TIFF hold integers"))
        }
    }
}

/// The bytes before the first block, with zeros for the table of offsets.
///
/// The crate writes all blocks within one call, which rows that come from outside cannot wait for. So that call ends
/// before its first block, and the blocks are written here.
fn header_bytes(path: &Path, headers: &Headers) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    let stop = |_, _: &mut exr::block::writer::ChunkWriter<_>| Err(exr::error::Error::Aborted);
    match exr::block::write(&mut bytes, headers.clone(), true, stop) {
        Ok(()) | Err(exr::error::Error::Aborted) => Ok(bytes.into_inner()),
        Err(error) => Err(failed(path, error)),
    }
}

impl ExrEncoder {
    fn row_bytes(&self) -> usize {
        self.size.width() * self.order.len() * self.sample_bytes
    }

    /// Compresses and writes the first `rows` pending rows: whole blocks, or the last rows of the map.
    fn write_blocks(&mut self, rows: usize) -> Result<()> {
        let (row_bytes, lines) = (self.row_bytes(), COMPRESSION.scan_lines_per_block());
        let (first, this) = (self.rows_done, &*self);
        let blocks = this.pending[..rows * row_bytes].par_chunks(lines * row_bytes).enumerate();
        let chunks: Result<Vec<Chunk>> =
            blocks.map(|(block, codes)| this.compress(first + block * lines, codes)).collect();
        let mut bytes = Vec::new();
        for chunk in chunks? {
            self.offsets.push(self.position + bytes.len() as u64);
            chunk.write(&mut bytes, 1).map_err(|error| failed(&self.path, error))?;
        }
        self.output.write_all(&bytes).map_err(Error::io(&self.path))?;
        self.position += bytes.len() as u64;
        self.pending.drain(..rows * row_bytes);
        self.rows_done += rows;
        Ok(())
    }

    /// A block of rows from `top`: line by line, channel after channel.
    fn compress(&self, top: usize, codes: &[u8]) -> Result<Chunk> {
        let (sample, texel) = (self.sample_bytes, self.sample_bytes * self.order.len());
        let mut data = Vec::with_capacity(codes.len());
        for row in codes.chunks_exact(self.row_bytes()) {
            for place in self.order {
                row.chunks_exact(texel).for_each(|codes| data.extend_from_slice(&codes[place * sample..][..sample]));
            }
        }
        let index = BlockIndex {
            layer: 0,
            level: Vec2(0, 0),
            pixel_position: Vec2(0, top),
            pixel_size: Vec2(self.size.width(), codes.len() / self.row_bytes()),
        };
        let block = UncompressedBlock { index, data };
        block.compress_to_chunk(&self.headers).map_err(|error| failed(&self.path, error))
    }
}

impl RowEncoder for ExrEncoder {
    /// Whole blocks of rows: as they came, channel by channel, deflated, and in the file's order.
    fn held_bytes(&self, rows: usize) -> u64 {
        (4 * (rows + COMPRESSION.scan_lines_per_block()) * self.row_bytes()) as u64
    }

    /// Blocks of several rows are compressed one after the other.
    fn takes_first_row_last(&self) -> bool {
        false
    }

    fn write(&mut self, _: usize, rows: CodesRef<'_>) -> Result<()> {
        self.pending.extend_from_slice(rows.bytes());
        let (rows, lines) = (self.pending.len() / self.row_bytes(), COMPRESSION.scan_lines_per_block());
        self.write_blocks(rows / lines * lines)
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        let rows = self.pending.len() / self.row_bytes();
        self.write_blocks(rows)?;
        let table: Vec<u8> = self.offsets.iter().flat_map(|offset| offset.to_le_bytes()).collect();
        let seek = self.output.seek(SeekFrom::Start(self.table));
        seek.and_then(|_| self.output.write_all(&table)).map_err(Error::io(&self.path))
    }
}

/// The encoder's reason, with the file.
fn failed(path: &Path, error: exr::error::Error) -> Error {
    Error::file(path, error, "write another format")
}
