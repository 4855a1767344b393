//! Rows on their way to their places in a texture.
//!
//! Every row has a place that is known when the file is created, so rows of all levels may come at the same time.
//! Texels are written as they come; of blocks, a row waits for its four rows of texels, and the topmost one until row 0
//! is there.

use super::blocks::BlockRow;
use super::format::{BlockCompression, TextureFormat};
use super::levels::{Level, levels};
use super::texels::{little_endian, with_alpha};
use super::{dds, ktx2};
use crate::error::{Error, Result};
use crate::io::replace::{Output, Replacement};
use crate::io::sink::{ExpectedRows, FileSink, RowEncoder};
use crate::io::write::WriteOptions;
use crate::map::{Codes, CodesRef, Size, TexelFormat};
use crate::stream::LevelSink;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

/// Which file holds the levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Container {
    Ktx2,
    Dds,
}

/// Bytes of texels that are converted at a time, about.
const PIECE: usize = 1 << 20;

/// The file that all levels go to.
struct TextureFile {
    path: PathBuf,
    output: Mutex<Output>,
    codes: TexelFormat,
    format: TextureFormat,
}

/// One level, and the rows of blocks that wait for texels: at most the topmost one and the one that comes.
struct LevelRows {
    file: Arc<TextureFile>,
    level: Level,
    waiting: Vec<BlockRow>,
}

struct TextureEncoder {
    largest: LevelRows,
    /// Rows of the smaller levels that have not come.
    rows_left: Arc<AtomicUsize>,
    held_bytes: usize,
}

struct SmallerLevels {
    levels: Vec<(ExpectedRows, LevelRows)>,
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

    let rows = |level: &Level| LevelRows { file: file.clone(), level: *level, waiting: Vec::new() };
    let expected = |level: &Level| ExpectedRows::new(level.width, level.height, codes);
    let largest = rows(&levels[0]);
    let smaller = levels[1..].iter().map(|level| (expected(level), rows(level))).collect();
    let rows_left = Arc::new(AtomicUsize::new(levels[1..].iter().map(|level| level.height).sum()));
    let smaller = SmallerLevels { levels: smaller, rows_left: rows_left.clone() };
    let smaller = options.mips.then(|| Box::new(smaller) as Box<dyn LevelSink>);
    let held_bytes = held_bytes(&format, &levels);
    Ok((FileSink::boxed(TextureEncoder { largest, rows_left, held_bytes }, replacement, size, codes), smaller))
}

/// The most bytes that wait for others, or are being made: texels of the largest level and of one of the others at the
/// same time; of blocks, the topmost row of each level and the one that comes, and what two of them become.
fn held_bytes(format: &TextureFormat, levels: &[Level]) -> usize {
    let row_bytes = levels[0].row_bytes;
    match format.blocks {
        None => 2 * PIECE.max(row_bytes),
        Some(_) => 2 * (row_bytes + levels.iter().map(|level| BlockRow::texel_bytes(level.width)).sum::<usize>()),
    }
}

impl TextureFile {
    fn write_at(&self, offset: u64, bytes: &[u8]) -> Result<()> {
        let mut output = self.output.lock().unwrap_or_else(PoisonError::into_inner);
        let written = output.seek(SeekFrom::Start(offset)).and_then(|_| output.write_all(bytes));
        written.map_err(Error::io(&self.path))
    }
}

impl LevelRows {
    /// Writes whole rows from row `first` on.
    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        match rows {
            CodesRef::U8(codes) if self.file.format.blocks.is_some() => self.write_blocks(first, codes),
            _ => self.write_texels(first, rows),
        }
    }

    fn write_texels(&self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let Level { width, row_bytes, offset, .. } = self.level;
        let codes = self.file.codes;
        let row_codes = codes.row_codes(width);
        let piece_rows = (PIECE / row_bytes).max(1);
        let count = rows.len() / row_codes;
        (0..count).step_by(piece_rows).try_for_each(|row| {
            let piece = rows.slice(row * row_codes..(row + piece_rows).min(count) * row_codes);
            let texels = with_alpha(piece, codes);
            let bytes = little_endian(texels.as_ref().map_or(piece, Codes::as_ref));
            self.file.write_at(offset + (first + row) as u64 * row_bytes as u64, &bytes)
        })
    }

    fn write_blocks(&mut self, first: usize, codes: &[u8]) -> Result<()> {
        let Some(blocks) = self.file.format.blocks else { return Ok(()) };
        let Level { width, height, row_bytes, offset, .. } = self.level;
        for (row, codes) in (first..).zip(codes.chunks_exact(self.file.codes.row_codes(width))) {
            let place = self.waiting.iter().position(|waiting| waiting.holds(row));
            let mut into = match place {
                Some(place) => self.waiting.swap_remove(place),
                None => BlockRow::of(row, width, height),
            };
            match blocks.fill(&mut into, row, codes) {
                false => self.waiting.push(into),
                true => {
                    let place = offset + into.index() as u64 * row_bytes as u64;
                    self.file.write_at(place, &blocks.compress(into))?;
                }
            }
        }
        Ok(())
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
        self.largest.write(first, rows)
    }

    fn finish(self: Box<Self>) -> Result<()> {
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
        into.write(first, rows)?;
        expected.advance(first, rows_taken);
        self.rows_left.fetch_sub(rows_taken, Relaxed);
        Ok(())
    }
}
