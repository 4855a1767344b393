//! Large strips, row by row: numpy and many others write a whole map as one strip, which may be larger than memory.
//!
//! Rows of no compression stand in the file; those of deflate and LZW are unpacked one after the other (TIFF 6.0,
//! sections 13 and 14; Adobe's Technical Note 3 for floating-point differences).

use crate::error::{Error, Result};
use crate::io::damage::{damaged, io_reason, truncated};
use crate::io::samples::{Layout, SampleRows, len, part_mut};
use crate::io::{input, limits};
use crate::map::{HeightType, HeightsMut};
use flate2::bufread::ZlibDecoder;
use half::f16;
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Take};
use std::path::{Path, PathBuf};
use tiff::decoder::DecodingSampleType;
use tiff::tags::{ByteOrder, CompressionMethod, Predictor};
use weezl::{BitOrder, LzwStatus};

/// Bytes that are read from the file at once.
const READ_BYTES: usize = 256 << 10;

/// Unpacked bytes up to which the last row of a strip is near its beginning.
const NEAR_BYTES: usize = 64 << 20;

/// What a directory says of strips.
#[derive(Debug, Clone)]
pub(super) struct Strips {
    pub layout: Layout,
    pub sample_type: DecodingSampleType,
    pub byte_order: ByteOrder,
    pub compression: CompressionMethod,
    pub predictor: Predictor,
    pub rows_per_strip: usize,
    /// Strips for the same rows: one for each sample if samples stand in planes of their own.
    pub planes: usize,
    /// Where each strip stands and how long it is, plane after plane, each from the top.
    pub places: Vec<[u64; 2]>,
}

/// The rows of strips.
pub(super) struct StripRows {
    path: PathBuf,
    strips: Strips,
    /// The strip of each plane that is being read, behind its last row that was; empty before the first.
    open: Vec<Box<dyn Read + Send>>,
    /// A row of one plane, aligned for every type.
    row: Vec<u64>,
    next_row: usize,
}

impl Strips {
    /// Samples of a texel in a strip.
    fn per_texel(&self) -> usize {
        self.layout.per_texel() / self.planes
    }

    fn sample_bytes(&self) -> usize {
        use DecodingSampleType::{F16, F64, I8, I16, U8, U16};
        match self.sample_type {
            U8 | I8 => 1,
            U16 | I16 | F16 => 2,
            F64 => 8,
            _ => 4,
        }
    }

    /// Bytes of a row in a strip.
    fn row_bytes(&self) -> usize {
        self.layout.size.width() * self.per_texel() * self.sample_bytes()
    }

    fn strips_of_plane(&self) -> usize {
        self.layout.size.height().div_ceil(self.rows_per_strip)
    }

    fn are_packed(&self) -> bool {
        self.compression != CompressionMethod::None
    }

    /// Whether strips of this compression can be read row by row.
    pub fn stream(&self) -> bool {
        use CompressionMethod::{Deflate, LZW, None, OldDeflate};
        let predictor_fits = match self.predictor {
            Predictor::None | Predictor::Horizontal => true,
            Predictor::FloatingPoint => self.layout.depth == HeightType::F32,
            _ => false,
        };
        predictor_fits && matches!(self.compression, None | Deflate | OldDeflate | LZW)
    }

    /// Fails if the file cannot hold what the directory says, or a row does not fit the limit.
    fn check(&self, path: &Path, file_bytes: u64, max_bytes: u64) -> Result<()> {
        let Layout { size, .. } = self.layout;
        limits::check(path, size, 2 * self.row_bytes() as u128, max_bytes)?;
        match self.compression {
            CompressionMethod::None => {
                let is_there = |(index, [offset, length]): (usize, &[u64; 2])| {
                    let claimed = self.rows_of(index % self.strips_of_plane()) as u64 * self.row_bytes() as u64;
                    claimed <= *length && offset.checked_add(claimed).is_some_and(|end| end <= file_bytes)
                };
                if self.places.iter().enumerate().all(is_there) { Ok(()) } else { Err(truncated(path)) }
            }
            CompressionMethod::Deflate | CompressionMethod::OldDeflate => {
                let stored: u64 = self.places.iter().map(|[_, length]| *length).fold(0, u64::saturating_add);
                let claimed = self.row_bytes() as u128 * size.height() as u128 * self.planes as u128;
                limits::check_deflated(path, size, claimed, stored.min(file_bytes))
            }
            _ => Ok(()),
        }
    }

    /// Rows of the strip `index` of a plane; the last one may have fewer.
    fn rows_of(&self, index: usize) -> usize {
        self.rows_per_strip.min(self.layout.size.height() - index * self.rows_per_strip)
    }

    /// Opens the strip with the row `row` of a plane, at that row.
    fn open(&self, path: &Path, plane: usize, row: usize) -> Result<Box<dyn Read + Send>> {
        let (index, skipped) = (row / self.rows_per_strip, row % self.rows_per_strip);
        let skipped_bytes = (skipped * self.row_bytes()) as u64;
        let [offset, length] = self.places[plane * self.strips_of_plane() + index];
        let mut file = BufReader::with_capacity(READ_BYTES, input::open(path)?);
        let mut begin = |offset| file.seek(SeekFrom::Start(offset)).map_err(Error::io(path));
        if !self.are_packed() {
            begin(offset.saturating_add(skipped_bytes))?;
            return Ok(Box::new(file.take(length.saturating_sub(skipped_bytes))));
        }
        begin(offset)?;
        let packed = file.take(length);
        let mut rows: Box<dyn Read + Send> = match self.compression {
            CompressionMethod::LZW => Box::new(Lzw::new(packed)),
            _ => Box::new(ZlibDecoder::new(packed)),
        };
        pass(path, &mut rows, skipped_bytes)?;
        Ok(rows)
    }

    /// Turns a row as it was stored into samples of this machine.
    fn unpack(&self, row: &mut [u8]) {
        let (bytes, stride) = (self.sample_bytes(), self.per_texel());
        if self.predictor == Predictor::FloatingPoint {
            // The differences of bytes, first the most significant ones of all samples, then the next ones.
            sum_up(row, stride, u8::wrapping_add);
            let planes = row.to_vec();
            let samples = row.len() / bytes;
            for (index, sample) in row.chunks_exact_mut(bytes).enumerate() {
                sample.iter_mut().enumerate().for_each(|(place, byte)| *byte = planes[place * samples + index]);
            }
        }
        let is_big = self.byte_order == ByteOrder::BigEndian || self.predictor == Predictor::FloatingPoint;
        if is_big != cfg!(target_endian = "big") && bytes > 1 {
            row.chunks_exact_mut(bytes).for_each(<[u8]>::reverse);
        }
        if self.predictor == Predictor::Horizontal {
            match bytes {
                1 => sum_up(row, stride, u8::wrapping_add),
                2 => sum_up(bytemuck::cast_slice_mut(row), stride, u16::wrapping_add),
                4 => sum_up(bytemuck::cast_slice_mut(row), stride, u32::wrapping_add),
                _ => sum_up(bytemuck::cast_slice_mut(row), stride, u64::wrapping_add),
            }
        }
    }

    /// Puts the samples of a plane's row among those of the map's.
    fn put(&self, row: &[u8], plane: usize, to: HeightsMut<'_>) -> bool {
        use DecodingSampleType::{F16, F32, F64, I8, I16, U8, U16};
        let stride = if self.planes > 1 { self.planes } else { 1 };
        match (self.sample_type, to) {
            (U8, HeightsMut::U8(to)) => put(row, &mut to[plane..], stride, |[v]| v),
            (I8, HeightsMut::U8(to)) => put(row, &mut to[plane..], stride, |[v]| v ^ 0x80),
            (U16, HeightsMut::U16(to)) => put(row, &mut to[plane..], stride, u16::from_ne_bytes),
            (I16, HeightsMut::U16(to)) => put(row, &mut to[plane..], stride, |v| u16::from_ne_bytes(v) ^ 0x8000),
            (F16, HeightsMut::F32(to)) => put(row, &mut to[plane..], stride, |v| f16::from_ne_bytes(v).to_f32()),
            (F32, HeightsMut::F32(to)) => put(row, &mut to[plane..], stride, f32::from_ne_bytes),
            (F64, HeightsMut::F32(to)) => put(row, &mut to[plane..], stride, |v| f64::from_ne_bytes(v) as f32),
            _ => return false,
        }
        true
    }
}

/// Goes past the next bytes of a strip.
fn pass(path: &Path, rows: &mut dyn Read, bytes: u64) -> Result<()> {
    match io::copy(&mut rows.take(bytes), &mut io::sink()).map_err(|error| io_reason(path, error))? {
        found if found < bytes => Err(truncated(path)),
        _ => Ok(()),
    }
}

/// Undoes differences: each value is added to the one of the same sample in the texel before it.
fn sum_up<T: Copy>(row: &mut [T], stride: usize, add: fn(T, T) -> T) {
    for index in stride..row.len() {
        row[index] = add(row[index], row[index - stride]);
    }
}

fn put<const N: usize, T>(from: &[u8], to: &mut [T], stride: usize, convert: impl Fn([u8; N]) -> T) {
    to.iter_mut().step_by(stride).zip(from.as_chunks::<N>().0).for_each(|(to, from)| *to = convert(*from));
}

impl StripRows {
    /// The rows of `strips`, which [`Strips::stream`].
    ///
    /// # Errors
    /// [`Error::TooLarge`] if a row does not fit `max_bytes`; [`Error::File`] if the file is too short.
    pub fn new(path: &Path, strips: Strips, file_bytes: u64, max_bytes: u64) -> Result<Self> {
        strips.check(path, file_bytes, max_bytes)?;
        let row = vec![0; strips.row_bytes().div_ceil(8)];
        Ok(Self { path: path.into(), strips, open: Vec::new(), row, next_row: 0 })
    }

    /// Opens the strips of the next row.
    fn open(&mut self) -> Result<()> {
        self.open.clear();
        let open = (0..self.strips.planes).map(|plane| self.strips.open(&self.path, plane, self.next_row));
        self.open = open.collect::<Result<_>>()?;
        Ok(())
    }

    fn read_row(&mut self, mut samples: HeightsMut<'_>) -> Result<()> {
        if self.open.is_empty() || self.next_row.is_multiple_of(self.strips.rows_per_strip) {
            self.open()?;
        }
        let strips = &self.strips;
        for (plane, rows) in self.open.iter_mut().enumerate() {
            let row = &mut bytemuck::cast_slice_mut(&mut self.row)[..strips.row_bytes()];
            rows.read_exact(row).map_err(|error| io_reason(&self.path, error))?;
            strips.unpack(row);
            if !strips.put(row, plane, part_mut(&mut samples, 0..strips.layout.per_row())) {
                return Err(damaged(&self.path, "its samples are of another type than its directory says"));
            }
        }
        self.next_row += 1;
        Ok(())
    }
}

impl SampleRows for StripRows {
    fn layout(&self) -> Layout {
        self.strips.layout
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        let per_row = self.layout().per_row();
        let count = len(&rows) / per_row;
        (0..count).try_for_each(|row| self.read_row(part_mut(&mut rows, row * per_row..(row + 1) * per_row)))
    }

    /// Within a packed strip, to go on is to unpack, and to go back is to begin with its first row again.
    fn seek(&mut self, row: usize) -> Result<()> {
        let rows_per_strip = self.strips.rows_per_strip;
        let begun = self.strips.are_packed() && !self.open.is_empty() && !self.next_row.is_multiple_of(rows_per_strip);
        if begun && row >= self.next_row && row / rows_per_strip == self.next_row / rows_per_strip {
            let bytes = (row - self.next_row) as u64 * self.strips.row_bytes() as u64;
            self.open.iter_mut().try_for_each(|rows| pass(&self.path, rows, bytes))?;
            self.next_row = row;
            return Ok(());
        }
        self.open.clear();
        self.next_row = row;
        // What is skipped piece by piece is unpacked so too.
        if self.strips.are_packed() && !row.is_multiple_of(rows_per_strip) && row < self.layout().size.height() {
            self.open()?;
        }
        Ok(())
    }

    fn last_row_is_near(&self) -> bool {
        let last = self.strips.strips_of_plane() - 1;
        let is_short = self.strips.rows_of(last) * self.strips.row_bytes() <= NEAR_BYTES;
        !self.strips.are_packed() || (last > 0 && is_short)
    }

    /// A row twice, what is read at once for each plane, deflate's window, and the table of strips.
    fn held_bytes(&self) -> u64 {
        let Strips { planes, places, .. } = &self.strips;
        (2 * self.strips.row_bytes() + planes * (READ_BYTES + (64 << 10)) + size_of_val(places.as_slice())) as u64
    }
}

/// Unpacks LZW, most significant bit first.
struct Lzw {
    packed: Take<BufReader<File>>,
    decoder: weezl::decode::Decoder,
}

impl Lzw {
    fn new(packed: Take<BufReader<File>>) -> Self {
        let configuration = weezl::decode::Configuration::with_tiff_size_switch(BitOrder::Msb, 8);
        Self { packed, decoder: configuration.with_yield_on_full_buffer(true).build() }
    }
}

impl Read for Lzw {
    fn read(&mut self, unpacked: &mut [u8]) -> io::Result<usize> {
        loop {
            let step = self.decoder.decode_bytes(self.packed.fill_buf()?, unpacked);
            self.packed.consume(step.consumed_in);
            match step.status {
                Ok(LzwStatus::Ok) if step.consumed_out == 0 && !unpacked.is_empty() => continue,
                Ok(LzwStatus::NoProgress) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(_) => return Ok(step.consumed_out),
                Err(error) => return Err(io::Error::new(ErrorKind::InvalidData, error)),
            }
        }
    }
}
