//! Bands of a map that is read row by row, on a thread of its own.

use super::ahead::ReadAhead;
use super::band::{Band, HeightBand, HeightBands};
use super::channel::Filling;
use super::monitor::{Monitor, Stop};
use super::order::RowOrder;
use crate::error::Result;
use crate::map::{Edge, Grid, HeightMap, HeightType, HeightsMut, Size};

/// A height map that is read from the top.
pub trait RowSource: Send {
    /// Width and height.
    fn size(&self) -> Size;

    /// How a height is stored.
    fn height_type(&self) -> HeightType;

    /// Reads the next rows: as many as `rows` has room for, never more than are left.
    ///
    /// # Errors
    /// The reason that the file gives; [`crate::Error::NotFinite`] for a height that has no slope.
    fn read(&mut self, rows: HeightsMut<'_>) -> Result<()>;

    /// Goes past the next rows, never more than are left. A source that stands before another one hands this on.
    ///
    /// # Errors
    /// As [`RowSource::read`].
    fn skip(&mut self, rows: usize) -> Result<()> {
        let mut row = BandBuffer::new(self.size().width(), self.height_type(), 1);
        (0..rows).try_for_each(|_| self.read(row.rows_mut(0, 1)))
    }

    /// Goes back to the first row: a map that wraps needs its last row before anything else.
    ///
    /// # Errors
    /// As [`RowSource::read`].
    fn rewind(&mut self) -> Result<()>;

    /// Whether to skip to the last row costs about as much as reading a row: a seek, not a whole decoding. Where it costs
    /// more, a map of moderate size is held in memory instead, and one that is not is skipped piece by piece, so that it
    /// can be stopped.
    fn last_row_is_near(&self) -> bool {
        false
    }

    /// Bytes that the source holds at most while it is read, without the rows that it gives: what it decodes at once,
    /// and what it keeps to find its rows.
    fn held_bytes(&self) -> u64;
}

/// The bands of a [`RowSource`]; a thread reads ahead.
pub(crate) struct BandReader(ReadAhead<BandBuffer>);

impl BandReader {
    /// Reads `source` in bands of `band_rows` rows; `edge` says what lies above the first row and below the last.
    ///
    /// Row 0 comes last only of a map that wraps and has another row. Between bands a reader is ended by being dropped,
    /// and on its way to the last row, before the first band, by `stop`.
    ///
    /// # Errors
    /// [`crate::Error::Threads`].
    pub fn new(source: Box<dyn RowSource>, edge: Edge, order: RowOrder, band_rows: usize, stop: Stop) -> Result<Self> {
        assert!(band_rows > 0, "a band has rows");
        assert!(order == RowOrder::FromTop || edge == Edge::Wrap && source.size().height() > 1, "row 0 cannot be last");
        let read_all = move |mut filling: Filling<BandBuffer>| {
            let mut cutter = BandCutter::new(source, edge, order, &stop)?;
            while let Some(buffer) = filling.take() {
                let buffer = buffer.unwrap_or_else(|| cutter.buffer(band_rows));
                match cutter.next(buffer, band_rows)? {
                    Some(band) => filling.send(band),
                    None => break,
                }
            }
            Ok(())
        };
        ReadAhead::new(read_all).map(Self)
    }
}

impl HeightBands for BandReader {
    fn next(&mut self) -> Result<Option<HeightBand<'_>>> {
        Ok(self.0.next()?.map(BandBuffer::band))
    }
}

/// Cuts rows into bands; consecutive bands share two rows, which are read once.
struct BandCutter {
    source: Box<dyn RowSource>,
    edge: Edge,
    order: RowOrder,
    /// The first row of the next band; the height when only row 0 is left, or nothing.
    next_row: usize,
    /// Rows read so far.
    read: usize,
    /// The last rows read: those that the next band has in common with this one.
    carried: Vec<u8>,
    /// Rows 0 and 1 of a map that wraps, for its other end.
    first_rows: Vec<u8>,
    /// The last row of a map that wraps.
    last_row: Vec<u8>,
    done: bool,
}

impl BandCutter {
    fn new(mut source: Box<dyn RowSource>, edge: Edge, order: RowOrder, stop: &Stop) -> Result<Self> {
        let mut last_row = Vec::new();
        if edge == Edge::Wrap && order == RowOrder::FromTop {
            let mut row = BandBuffer::new(source.size().width(), source.height_type(), 1);
            read_last_row(source.as_mut(), row.rows_mut(0, 1), stop)?;
            row.check_finite(0, 1, source.size().height() - 1)?;
            last_row = row.slot(0).to_vec();
        }
        let (next_row, read, done) = (order.row(0, source.size().height()), 0, false);
        Ok(Self { source, edge, order, next_row, read, carried: Vec::new(), first_rows: Vec::new(), last_row, done })
    }

    fn buffer(&self, band_rows: usize) -> BandBuffer {
        let size = self.source.size();
        BandBuffer::new(size.width(), self.source.height_type(), band_rows.min(size.height()) + 2)
    }

    /// Fills `buffer` with the next band.
    fn next(&mut self, mut buffer: BandBuffer, band_rows: usize) -> Result<Option<BandBuffer>> {
        if self.done {
            return Ok(None);
        }
        let (first, height) = (self.next_row, self.source.size().height());
        if first == height {
            self.fill_first_row(&mut buffer);
            self.done = true;
            return Ok(Some(buffer));
        }
        buffer.body_rows = band_rows.min(height - first);
        self.fill(&mut buffer, first)?;
        self.next_row = first + buffer.body_rows;
        self.done = self.next_row == height && self.order == RowOrder::FromTop;
        Ok(Some(buffer))
    }

    /// Reads the band from row `first` on; row r stands in slot r + 1 - `first`.
    fn fill(&mut self, buffer: &mut BandBuffer, first: usize) -> Result<()> {
        let (height, end) = (self.source.size().height(), first + buffer.body_rows);
        let row_bytes = buffer.row_bytes();
        let carried_slot = self.read + 1 - first - self.carried.len() / row_bytes;
        buffer.bytes_mut()[carried_slot * row_bytes..][..self.carried.len()].copy_from_slice(&self.carried);

        let to = (end + 1).min(height);
        if self.read < to {
            let (slot, count) = (self.read + 1 - first, to - self.read);
            self.source.read(buffer.rows_mut(slot, count))?;
            buffer.check_finite(slot, count, self.read)?;
        }
        if self.read == 0 {
            let slots = 1 - first..2 - first + usize::from(to > 1);
            self.first_rows = buffer.bytes()[slots.start * row_bytes..slots.end * row_bytes].to_vec();
        }
        self.read = to;

        if first == 0 {
            let above = match self.edge {
                Edge::Wrap => self.last_row.clone(),
                edge => buffer.slot(edge.resolve(-1, height) + 1).to_vec(),
            };
            buffer.slot_mut(0).copy_from_slice(&above);
        }
        if end == height {
            self.last_row = buffer.slot(buffer.body_rows).to_vec();
            let below = match self.edge {
                Edge::Wrap => self.first_rows[..row_bytes].to_vec(),
                edge => buffer.slot(edge.resolve(height as isize, height) + 1 - first).to_vec(),
            };
            buffer.slot_mut(buffer.body_rows + 1).copy_from_slice(&below);
        }
        let shared = buffer.body_rows * row_bytes..(to + 1 - first) * row_bytes;
        self.carried = buffer.bytes()[shared].to_vec();
        Ok(())
    }

    /// Row 0 as a band: the last row above it, row 1 below.
    fn fill_first_row(&self, buffer: &mut BandBuffer) {
        buffer.body_rows = 1;
        let band = [self.last_row.as_slice(), &self.first_rows].concat();
        buffer.bytes_mut()[..band.len()].copy_from_slice(&band);
    }
}

/// Rows of heights in one piece, aligned for every height type.
#[derive(Debug)]
struct BandBuffer {
    width: usize,
    height_type: HeightType,
    body_rows: usize,
    words: Vec<u32>,
}

impl BandBuffer {
    fn new(width: usize, height_type: HeightType, rows: usize) -> Self {
        let words = (rows * width * height_type.bytes()).div_ceil(4);
        Self { width, height_type, body_rows: rows, words: vec![0; words] }
    }

    fn row_bytes(&self) -> usize {
        self.width * self.height_type.bytes()
    }

    fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.words)
    }

    fn bytes_mut(&mut self) -> &mut [u8] {
        bytemuck::cast_slice_mut(&mut self.words)
    }

    fn slot(&self, index: usize) -> &[u8] {
        &self.bytes()[index * self.row_bytes()..][..self.row_bytes()]
    }

    fn slot_mut(&mut self, index: usize) -> &mut [u8] {
        let bytes = self.row_bytes();
        &mut self.bytes_mut()[index * bytes..][..bytes]
    }

    fn rows_mut(&mut self, first: usize, count: usize) -> HeightsMut<'_> {
        let (bytes, height_type) = (self.row_bytes(), self.height_type);
        let rows = &mut self.bytes_mut()[first * bytes..][..count * bytes];
        match height_type {
            HeightType::U8 => HeightsMut::U8(rows),
            HeightType::U16 => HeightsMut::U16(bytemuck::cast_slice_mut(rows)),
            HeightType::F32 => HeightsMut::F32(bytemuck::cast_slice_mut(rows)),
        }
    }

    /// Fails on a float that has no slope, whatever the source let pass; slot `first` holds row `row` of the map.
    fn check_finite(&mut self, first: usize, count: usize, row: usize) -> Result<()> {
        let width = self.width;
        self.rows_mut(first, count).as_ref().check_finite(width, row)
    }

    fn band(&self) -> HeightBand<'_> {
        fn cut<T: bytemuck::Pod>(buffer: &BandBuffer) -> Band<'_, T> {
            let bytes = &buffer.bytes()[..(buffer.body_rows + 2) * buffer.row_bytes()];
            let (above, rest) = bytemuck::cast_slice(bytes).split_at(buffer.width);
            let (body, below) = rest.split_at(buffer.body_rows * buffer.width);
            Band { width: buffer.width, above, body, below }
        }
        match self.height_type {
            HeightType::U8 => HeightBand::U8(cut(self)),
            HeightType::U16 => HeightBand::U16(cut(self)),
            HeightType::F32 => HeightBand::F32(cut(self)),
        }
    }
}

/// Reads the last row and goes back to the first.
fn read_last_row(source: &mut dyn RowSource, row: HeightsMut<'_>, stop: &Stop) -> Result<()> {
    let before = source.size().height() - 1;
    let piece_rows = if source.last_row_is_near() { before } else { piece_rows(source.size(), source.height_type()) };
    for first in (0..before).step_by(piece_rows.max(1)) {
        stop.check()?;
        source.skip(piece_rows.min(before - first))?;
    }
    source.read(row)?;
    source.rewind()
}

/// Reads a whole map.
///
/// # Errors
/// As [`RowSource::read`].
pub fn read_map(source: &mut dyn RowSource) -> Result<HeightMap> {
    read_map_watched(source, &Monitor::default())
}

/// Bytes of a map that are read between two looks at the monitor.
const PIECE_BYTES: usize = 1 << 20;

/// Rows of a map that are read, or skipped, between two looks at the monitor.
pub(crate) fn piece_rows(size: Size, height_type: HeightType) -> usize {
    (PIECE_BYTES / (size.width() * height_type.bytes())).max(1)
}

/// Reads a whole map, unless the monitor ends it.
///
/// # Errors
/// As [`RowSource::read`], and [`crate::Error::Cancelled`].
pub(crate) fn read_map_watched(source: &mut dyn RowSource, monitor: &Monitor) -> Result<HeightMap> {
    fn read<T: Copy + Default>(
        source: &mut dyn RowSource,
        monitor: &Monitor,
        rows: fn(&mut [T]) -> HeightsMut<'_>,
    ) -> Result<Grid<T>> {
        let size = source.size();
        let piece_rows = piece_rows(size, source.height_type());
        let mut heights = vec![T::default(); size.texels()];
        for piece in heights.chunks_mut(piece_rows * size.width()) {
            monitor.check()?;
            source.read(rows(piece))?;
        }
        Grid::new(size.width(), size.height(), heights)
    }
    match source.height_type() {
        HeightType::U8 => Ok(read(source, monitor, |rows| HeightsMut::U8(rows))?.into()),
        HeightType::U16 => Ok(read(source, monitor, |rows| HeightsMut::U16(rows))?.into()),
        HeightType::F32 => read(source, monitor, |rows| HeightsMut::F32(rows))?.try_into(),
    }
}
