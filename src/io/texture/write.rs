//! Rows on their way to their places in a texture.
//!
//! Every row has a place that is known when the file is created, so rows of all levels may come at the same time.
//! Texels are written as they come; of blocks, a row waits for its four rows of texels, and the topmost one until row 0
//! is there.

use super::block_writer::{BlockWriter, WaitingRows};
use super::blocks::BlockRow;
use super::file::TextureFile;
use super::format::{BlockCompression, TextureFormat};
use super::levels::{Level, levels};
use super::{dds, ktx2};
use crate::error::{Error, Result};
use crate::io::replace::Replacement;
use crate::io::sink::{ExpectedRows, FileSink, RowEncoder};
use crate::io::write::WriteOptions;
use crate::map::{CodesRef, Size, TexelFormat};
use crate::stream::LevelSink;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

/// Which file holds the levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Container {
    Ktx2,
    Dds,
}

/// One level, and its rows of blocks that wait for texels.
struct LevelRows {
    level: Level,
    waiting: WaitingRows,
}

/// What brings rows to their places.
enum RowWriter {
    Texels(Arc<TextureFile>),
    Blocks(BlockWriter),
}

struct TextureEncoder {
    largest: LevelRows,
    writer: RowWriter,
    /// Rows of the smaller levels that have not come.
    rows_left: Arc<AtomicUsize>,
    held_bytes: usize,
}

struct SmallerLevels {
    levels: Vec<(ExpectedRows, LevelRows)>,
    writer: RowWriter,
    rows_left: Arc<AtomicUsize>,
}

/// Fails if no GPU format holds `format`, or not in such blocks.
pub(in crate::io) fn check(path: &Path, format: TexelFormat, blocks: Option<BlockCompression>) -> Result<()> {
    TextureFormat::of(path, format, blocks).map(drop)
}

/// What takes the largest level, and what takes the others.
type FileAndLevels = (Box<FileSink>, Option<Box<dyn LevelSink>>);

/// Creates a KTX2 or DDS file of one level or of all.
pub(in crate::io) fn create(
    path: &Path,
    container: Container,
    size: Size,
    codes: TexelFormat,
    options: &WriteOptions,
) -> Result<FileAndLevels> {
    let format = TextureFormat::of(path, codes, options.blocks)?;
    let mut levels = levels(size, options.mips, &format);
    let header = match container {
        Container::Ktx2 => ktx2::lay_out(path, &format, &mut levels)?,
        Container::Dds => dds::lay_out(path, &format, &mut levels)?,
    };
    let replacement = Replacement::create(path)?;
    let output = Mutex::new(replacement.output()?);
    let file = Arc::new(TextureFile { path: path.into(), output, codes, format });
    file.write_at(0, &header)?;

    let writer = || match file.format.blocks {
        Some(blocks) => RowWriter::Blocks(BlockWriter::new(file.clone(), blocks)),
        None => RowWriter::Texels(file.clone()),
    };
    let rows = |level: &Level| LevelRows { level: *level, waiting: WaitingRows::new() };
    let expected = |level: &Level| ExpectedRows::new(level.width, level.height, codes);
    let largest = rows(&levels[0]);
    let smaller = levels[1..].iter().map(|level| (expected(level), rows(level))).collect();
    let rows_left = Arc::new(AtomicUsize::new(levels[1..].iter().map(|level| level.height).sum()));
    let smaller = SmallerLevels { levels: smaller, writer: writer(), rows_left: rows_left.clone() };
    let smaller = options.mips.then(|| Box::new(smaller) as Box<dyn LevelSink>);
    let held_bytes = held_bytes(&format, &levels);
    let encoder = TextureEncoder { largest, writer: writer(), rows_left, held_bytes };
    Ok((FileSink::boxed(encoder, replacement, size, codes), smaller))
}

/// The most bytes that wait for others, or are being made, of the largest level and of the others at the same time:
/// texels; of blocks, the topmost row of each level and the one that comes, and what is being compressed.
fn held_bytes(format: &TextureFormat, levels: &[Level]) -> usize {
    match format.blocks {
        None => 2 * TextureFile::PIECE.max(levels[0].row_bytes),
        Some(_) => {
            let rows: usize = levels.iter().map(|level| BlockRow::texel_bytes(level.width)).sum();
            2 * (rows + BlockWriter::held_bytes(levels[0].width))
        }
    }
}

impl RowWriter {
    /// Writes whole rows of a level from row `first` on.
    fn write(&mut self, into: &mut LevelRows, first: usize, rows: CodesRef<'_>) -> Result<()> {
        match (self, rows) {
            (Self::Texels(file), _) => file.write_texels(&into.level, first, rows),
            (Self::Blocks(writer), CodesRef::U8(codes)) => writer.write(&into.level, &mut into.waiting, first, codes),
            (Self::Blocks(_), _) => unreachable!("blocks are of 8-bit codes, by the format"),
        }
    }

    /// Waits until all is written.
    fn finish(&mut self) -> Result<()> {
        match self {
            Self::Texels(_) => Ok(()),
            Self::Blocks(writer) => writer.finish(),
        }
    }
}

impl RowEncoder for TextureEncoder {
    fn held_bytes(&self, _: usize) -> u64 {
        self.held_bytes as u64
    }

    fn takes_first_row_last(&self) -> bool {
        true
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        self.writer.write(&mut self.largest, first, rows)
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        self.writer.finish()?;
        match self.rows_left.load(Relaxed) {
            0 => Ok(()),
            rows => {
                Err(Error::parameter("mips", format_args!("without {rows} rows of the smaller levels"), "complete"))
            }
        }
    }
}

impl LevelSink for SmallerLevels {
    fn write(&mut self, level: usize, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let count = self.levels.len();
        let Some((expected, into)) = level.checked_sub(1).and_then(|place| self.levels.get_mut(place)) else {
            return Err(Error::parameter("level", level, format!("from 1 to {count}")));
        };
        let rows_taken = expected.check(first, rows, true)?;
        self.writer.write(into, first, rows)?;
        expected.advance(first, rows_taken);
        // The file is complete once none are left: then all are written.
        if self.rows_left.load(Relaxed) == rows_taken {
            self.writer.finish()?;
        }
        self.rows_left.fetch_sub(rows_taken, Relaxed);
        Ok(())
    }
}
