//! PNG height and normal maps, read.

use super::rows::PlainRows;
use crate::error::{Error, Result};
use crate::io::damage::{damaged, io_reason};
use crate::io::samples::{DecodedWhole, Layout, Opened, SampleRows, Samples, bytes_mut, len};
use crate::io::{input, limits, srgb};
use crate::map::{HeightType, HeightsMut};
use crate::stream::BUFFERS;
use png::{BitDepth, ColorType, Decoder, DecodingError, Info, Limits, Reader, Transformations};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Compressed bytes that are read from the file at once.
pub(super) const READ_BYTES: usize = 64 << 10;

/// Rows that are held at once where they are inflated ahead: one in each buffer at least, the last one and the next.
/// (Buffers for more rows have a fixed size and do not count.)
const ROWS_AHEAD: u128 = BUFFERS as u128 + 2;

/// Rows that `png` holds at once: four that it still keeps, the last one and the next.
const ROWS_KEPT: u128 = 6;

/// Room for what stands beside the rows, such as colour profiles.
const METADATA_BYTES: usize = 64 << 20;

/// The rows of a PNG that is not interlaced, expanded where that is needed.
struct PngRows {
    path: PathBuf,
    max_bytes: u64,
    reader: Reader<BufReader<File>>,
    layout: Layout,
    next_row: usize,
}

/// Opens a PNG: all colour types and bit depths.
///
/// Palettes become RGB, and 1, 2 and 4-bit grey becomes the 8-bit codes of the same heights, times 255 / (2^n - 1).
pub(crate) fn open(path: &Path, max_bytes: u64) -> Result<Opened> {
    let (mut reader, layout) = start(path, max_bytes)?;
    let info = reader.info();
    let profile_is_srgb = info.icc_profile.as_deref().is_some_and(srgb::is_named_by);
    let says_srgb = info.srgb.is_some() || profile_is_srgb;
    let opened = if info.interlaced {
        let path = path.to_owned();
        Opened::new(DecodedWhole::new(layout, 0, move || {
            let mut samples = Samples::zeroed(layout.depth, layout.per_row() * layout.size.height());
            let mut whole = samples.as_mut();
            reader.next_frame(bytes_mut(&mut whole)).map_err(reason(&path))?;
            reader.finish().map_err(reason(&path))?;
            to_native_order(whole);
            Ok(samples)
        }))
    } else if is_plain(info) {
        Opened::new(PlainRows::new(path.into(), layout))
    } else {
        Opened::new(PngRows { path: path.into(), max_bytes, reader, layout, next_row: 0 })
    };
    Ok(Opened { says_srgb, ..opened })
}

/// Whether rows hold the samples as they are.
fn is_plain(info: &Info<'_>) -> bool {
    let is_expanded = info.color_type == ColorType::Indexed || info.trns.is_some() || (info.bit_depth as u8) < 8;
    !is_expanded && info.animation_control.is_none()
}

/// Reads up to the first row; nothing is allocated before the header's claims are checked.
fn start(path: &Path, max_bytes: u64) -> Result<(Reader<BufReader<File>>, Layout)> {
    let file = input::open(path)?;
    let stored = file.metadata().map_err(Error::io(path))?.len();
    let mut decoder = Decoder::new(BufReader::with_capacity(READ_BYTES, file));
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);

    let header = decoder.read_header_info().map_err(reason(path))?;
    let size = limits::size(path, header.width.into(), header.height.into())?;
    let row_bits = size.width() as u128 * header.bits_per_pixel() as u128;
    let rows_at_once = if header.interlaced { size.height() as u128 } else { ROWS_AHEAD };
    limits::check(path, size, row_bits * rows_at_once / 8, max_bytes)?;
    limits::check_deflated(path, size, row_bits.div_ceil(8) * size.height() as u128, stored)?;
    decoder.set_limits(Limits { bytes: METADATA_BYTES + size.width() * 8 });

    let reader = decoder.read_info().map_err(reason(path))?;
    if reader.info().frame_control().is_some_and(|frame| (frame.width, frame.height) != reader.info().size()) {
        return Err(damaged(path, "its first frame has another size than its header says"));
    }
    let (colour, bits) = reader.output_color_type();
    let depth = if bits == BitDepth::Sixteen { HeightType::U16 } else { HeightType::U8 };
    let (colours, alpha) = match colour {
        ColorType::Grayscale => (1, false),
        ColorType::GrayscaleAlpha => (1, true),
        ColorType::Rgb => (3, false),
        ColorType::Rgba => (3, true),
        ColorType::Indexed => return Err(damaged(path, "its palette is missing")),
    };
    let rows_at_once = if reader.info().interlaced || is_plain(reader.info()) { rows_at_once } else { ROWS_KEPT };
    // Palettes, grey below 8 bits and transparent colours grow when they are decoded.
    let layout = Layout { size, depth, colours, alpha };
    limits::check(path, size, layout.row_bytes() as u128 * rows_at_once, max_bytes)?;
    Ok((reader, layout))
}

impl SampleRows for PngRows {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        let count = len(&rows) / self.layout.per_row();
        for row in bytes_mut(&mut rows).chunks_exact_mut(self.layout.row_bytes()) {
            let read = self.reader.read_row(row).map_err(reason(&self.path))?;
            read.ok_or_else(|| damaged(&self.path, "it holds too few rows"))?;
        }
        to_native_order(rows);
        self.next_row += count;
        if self.next_row == self.layout.size.height() {
            // The checksum of the last rows stands behind them.
            self.reader.finish().map_err(reason(&self.path))?;
        }
        Ok(())
    }

    /// Deflate has no entry points: to go back is to begin again, to go on is to decode.
    fn seek(&mut self, row: usize) -> Result<()> {
        if row < self.next_row {
            let (reader, layout) = start(&self.path, self.max_bytes)?;
            if layout != self.layout {
                return Err(damaged(&self.path, "it is another map than a moment ago"));
            }
            (self.reader, self.next_row) = (reader, 0);
        }
        let mut skipped = vec![0; self.layout.row_bytes()];
        while self.next_row < row {
            self.reader.read_row(&mut skipped).map_err(reason(&self.path))?;
            self.next_row += 1;
        }
        Ok(())
    }

    fn last_row_is_near(&self) -> bool {
        false
    }

    fn held_bytes(&self) -> u64 {
        ROWS_KEPT as u64 * self.layout.row_bytes() as u64 + 2 * READ_BYTES as u64
    }
}

/// PNG stores 16-bit samples with the most significant byte first.
pub(super) fn to_native_order(samples: HeightsMut<'_>) {
    if let HeightsMut::U16(samples) = samples {
        samples.iter_mut().for_each(|sample| *sample = u16::from_be(*sample));
    }
}

/// The decoder's reason, with the file and the way out.
pub(super) fn reason(path: &Path) -> impl FnOnce(DecodingError) -> Error + '_ {
    move |error| match error {
        DecodingError::IoError(error) => io_reason(path, error),
        DecodingError::LimitsExceeded => damaged(path, "it needs too much memory beside its rows"),
        error => damaged(path, error),
    }
}
