//! EXR normal and parallax maps, written: scan lines in ZIP blocks, which is lossless.

use crate::error::{Error, Result};
use crate::io::in_order::InOrder;
use crate::io::replace::{Output, Replacement};
use crate::io::sink::{FileSink, RowEncoder, cannot_hold};
use crate::map::{CodesRef, Depth, Size, TexelFormat};
use exr::block::{BlockIndex, UncompressedBlock};
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, LineOrder, SampleType, Text};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, Headers};
use std::io::{Cursor, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The most bytes of a block of 16 lines. Wider maps have blocks of one, since several are on their way at a time.
const BLOCK_BYTES: usize = 2 << 20;

/// Gathers rows into blocks, which several threads compress.
struct ExrEncoder {
    path: PathBuf,
    output: Output,
    layout: Arc<BlockLayout>,
    /// The rows that do not fill a block yet, and the blocks on their way: what the file holds of each.
    lines: Lines,
    compressing: InOrder<Lines, exr::error::Result<Vec<u8>>>,
    /// Bytes that were written.
    position: u64,
    /// Where the table of block offsets stands, and the offsets so far.
    table: u64,
    offsets: Vec<u64>,
}

/// How rows of codes become blocks of the file.
struct BlockLayout {
    headers: Headers,
    width: usize,
    /// For each channel of the file, in its alphabetical order, its place in a texel of codes.
    order: &'static [usize],
    sample_bytes: usize,
    /// Rows of a block; the last one may have fewer.
    lines: usize,
}

/// Rows of a block, from row `top` on, as bytes of their codes.
#[derive(Default)]
struct Lines {
    top: usize,
    codes: Vec<u8>,
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
    let row_bytes = size.width() * format.channels * format.depth.bytes();
    let compression = if row_bytes > BLOCK_BYTES / 16 { Compression::ZIP1 } else { Compression::ZIP16 };
    let channels = names.iter().map(|name| ChannelDescription::new(*name, sample_type, true)).collect();
    let header = Header::new(Text::from(layer), (size.width(), size.height()), channels).with_encoding(
        compression,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    let headers: Headers = [header].into_iter().collect();

    let replacement = Replacement::create(path)?;
    let mut output = replacement.output()?;
    let first_bytes = header_bytes(path, &headers)?;
    output.write_all(&first_bytes).map_err(Error::io(path))?;
    let position = first_bytes.len() as u64;
    let table = position - 8 * headers[0].chunk_count as u64;
    let lines = compression.scan_lines_per_block();
    let layout = BlockLayout { headers, width: size.width(), order, sample_bytes: format.depth.bytes(), lines };
    let layout = Arc::new(layout);
    let blocks = layout.clone();
    let encoder = ExrEncoder {
        path: path.into(),
        output,
        lines: Lines::default(),
        compressing: InOrder::new(layout.block_bytes(), move |lines| blocks.compress(lines)),
        layout,
        position,
        table,
        offsets: Vec::new(),
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

impl BlockLayout {
    fn row_bytes(&self) -> usize {
        self.width * self.order.len() * self.sample_bytes
    }

    fn block_bytes(&self) -> usize {
        self.lines * self.row_bytes()
    }

    /// What the file holds of a block: line by line, channel after channel, deflated.
    fn compress(&self, lines: Lines) -> exr::error::Result<Vec<u8>> {
        let Lines { top, codes } = lines;
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
            pixel_size: Vec2(self.width, codes.len() / self.row_bytes()),
        };
        drop(codes);
        let mut chunk = Vec::new();
        UncompressedBlock { index, data }.compress_to_chunk(&self.headers)?.write(&mut chunk, 1)?;
        Ok(chunk)
    }
}

impl ExrEncoder {
    /// Lets some thread compress the rows of a block, and goes on with the next one.
    fn send_block(&mut self) -> Result<()> {
        let top = self.lines.top + self.lines.codes.len() / self.layout.row_bytes();
        let codes = Vec::with_capacity(self.layout.block_bytes());
        self.compressing.push(std::mem::replace(&mut self.lines, Lines { top, codes }));
        while let Some(chunk) = self.compressing.pop_surplus() {
            self.write_chunk(chunk)?;
        }
        Ok(())
    }

    fn write_chunk(&mut self, chunk: exr::error::Result<Vec<u8>>) -> Result<()> {
        let chunk = chunk.map_err(|error| failed(&self.path, error))?;
        self.output.write_all(&chunk).map_err(Error::io(&self.path))?;
        self.offsets.push(self.position);
        self.position += chunk.len() as u64;
        Ok(())
    }
}

impl RowEncoder for ExrEncoder {
    /// Blocks, the one that is gathered and those on their way: as they came, or channel by channel, in the order that
    /// is deflated, and deflated; and one that `exr` keeps on each thread.
    fn held_bytes(&self, _: usize) -> u64 {
        let blocks = 4 * (self.compressing.most() + 1) + 1 + rayon::current_num_threads();
        (blocks * self.layout.block_bytes()) as u64
    }

    /// Blocks of several rows are compressed one after the other.
    fn takes_first_row_last(&self) -> bool {
        false
    }

    fn write(&mut self, _: usize, rows: CodesRef<'_>) -> Result<()> {
        for row in rows.bytes().chunks_exact(self.layout.row_bytes()) {
            self.lines.codes.extend_from_slice(row);
            if self.lines.codes.len() == self.layout.block_bytes() {
                self.send_block()?;
            }
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        if !self.lines.codes.is_empty() {
            self.send_block()?;
        }
        while let Some(chunk) = self.compressing.pop() {
            self.write_chunk(chunk)?;
        }
        let table: Vec<u8> = self.offsets.iter().flat_map(|offset| offset.to_le_bytes()).collect();
        let seek = self.output.seek(SeekFrom::Start(self.table));
        seek.and_then(|_| self.output.write_all(&table)).map_err(Error::io(&self.path))
    }
}

/// The encoder's reason, with the file.
fn failed(path: &Path, error: exr::error::Error) -> Error {
    Error::file(path, error, "write another format")
}
