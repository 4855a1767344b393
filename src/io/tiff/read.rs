//! TIFF height and normal maps, read.

use super::directory;
use super::strips::{StripRows, Strips};
use crate::error::{Error, Result};
use crate::io::damage::{damaged, io_reason};
use crate::io::groups::{GroupDecoder, GroupedRows};
use crate::io::samples::{Layout, NoData, Opened, Samples};
use crate::io::{input, limits, srgb};
use crate::map::HeightType;
use std::fs::File;
use std::io::{BufReader, Seek};
use std::path::{Path, PathBuf};
use tiff::decoder::{ChunkType, Decoder, DecodingResult, DecodingSampleType, Limits};
use tiff::tags::{CompressionMethod, PhotometricInterpretation, PlanarConfiguration, Predictor, Tag};
use tiff::{ColorType, TiffError, TiffUnsupportedError};

/// Strips up to this many bytes of samples are decoded at once.
const LARGE_STRIP_BYTES: u32 = 1 << 20;

/// A TIFF by strips or rows of tiles.
struct TiffChunks {
    path: PathBuf,
    decoder: Decoder<BufReader<File>>,
    layout: Layout,
    grid: Grid,
    /// Bytes of a strip or tile, in the file's own type.
    chunk_bytes: u64,
}

/// How a TIFF is cut into strips or tiles.
#[derive(Debug, Clone, Copy)]
struct Grid {
    /// Columns and rows of a strip or tile.
    chunk_width: usize,
    chunk_rows: usize,
    /// Chunks beside each other.
    across: usize,
    /// Chunks below each other.
    down: usize,
    /// Chunks for the same texels: one for each sample if samples stand in planes of their own.
    planes: usize,
}

impl Grid {
    /// Samples of a texel that stand in one chunk.
    fn samples_of_chunk(self, layout: Layout) -> usize {
        if self.planes > 1 { 1 } else { layout.per_texel() }
    }
}

/// Opens a TIFF: 8 and 16-bit integers, signed ones too, and floats of 16, 32 and 64 bits.
///
/// A signed sample v becomes v + 2^(b-1): of heights, the slopes are the same.
pub(crate) fn open(path: &Path, max_bytes: u64) -> Result<Opened> {
    let file = input::open(path)?;
    let file_bytes = file.metadata().map_err(Error::io(path))?.len();
    let buffer_bytes = max_bytes.try_into().unwrap_or(usize::MAX);
    let mut decoder_limits = Limits::default();
    decoder_limits.decoding_buffer_size = buffer_bytes;
    decoder_limits.intermediate_buffer_size = buffer_bytes;
    let mut file = BufReader::new(file);
    directory::check(path, &mut file, file_bytes, max_bytes)?;
    file.rewind().map_err(Error::io(path))?;
    let decoder = Decoder::new(file).map_err(reason(path))?;
    let mut decoder = decoder.with_limits(decoder_limits);

    let (width, height) = decoder.dimensions().map_err(reason(path))?;
    let size = limits::size(path, width.into(), height.into())?;
    let (colours, alpha) = colours(path, &mut decoder)?;
    let planar = tag(path, &mut decoder, Tag::PlanarConfiguration, PlanarConfiguration::Chunky.to_u16())?;
    let planes = if planar == PlanarConfiguration::Planar.to_u16() { colours + usize::from(alpha) } else { 1 };
    let (chunk_width, chunk_rows) = decoder.chunk_dimensions();
    let grid = match decoder.get_chunk_type() {
        ChunkType::Strip => {
            let chunk_rows = size.height().min(chunk_rows as usize);
            let down = size.height().div_ceil(chunk_rows);
            Grid { chunk_width: size.width(), chunk_rows, across: 1, down, planes }
        }
        ChunkType::Tile => {
            let (chunk_width, chunk_rows) = (chunk_width as usize, chunk_rows as usize);
            let (across, down) = (size.width().div_ceil(chunk_width), size.height().div_ceil(chunk_rows));
            Grid { chunk_width, chunk_rows, across, down, planes }
        }
    };
    let bits = decoder.colortype().map_err(reason(path))?.bit_depth();
    let sample_type = decoder.image_chunk_buffer_layout(0).map_err(reason(path))?.sample_type;
    let depth = depth(path, sample_type, bits)?;
    let layout = Layout { size, depth, colours, alpha };
    // The decoder's chunk in the file's own type, beside the group of chunks that rows are taken from.
    let chunk_samples = grid.chunk_width as u128 * grid.samples_of_chunk(layout) as u128;
    let chunk_bytes = chunk_samples * u128::from(bits.div_ceil(8)) * grid.chunk_rows as u128;
    let group_bytes = layout.row_bytes() as u128 * grid.chunk_rows.min(size.height()) as u128;
    let strips = match decoder.get_chunk_type() {
        ChunkType::Strip if group_bytes > LARGE_STRIP_BYTES.into() => {
            large_strips(path, &mut decoder, layout, grid, sample_type)?
        }
        _ => None,
    };
    if strips.is_none() {
        limits::check(path, size, chunk_bytes + group_bytes, max_bytes)?;
    }
    let no_data = no_data(path, &mut decoder, sample_type)?;
    let profile = decoder.find_tag(Tag::IccProfile).ok().flatten().and_then(|value| value.into_u8_vec().ok());
    let mut warnings = Vec::new();
    if sample_type == Some(DecodingSampleType::F64) {
        warnings.push("its 64-bit floats are rounded to 32 bits".into());
    }
    let signed = matches!(sample_type, Some(DecodingSampleType::I8 | DecodingSampleType::I16));
    let says_srgb = profile.is_some_and(|profile| srgb::is_named_by(&profile));
    let opened = match strips {
        Some(strips) => Opened::new(StripRows::new(path, strips, file_bytes, max_bytes)?),
        None => {
            let chunks = TiffChunks { path: path.into(), decoder, layout, grid, chunk_bytes: chunk_bytes as u64 };
            Opened::new(GroupedRows::new(chunks))
        }
    };
    Ok(Opened { signed, no_data, says_srgb, warnings, ..opened })
}

/// The strips of a TIFF, if they can be read row by row.
fn large_strips(
    path: &Path,
    decoder: &mut Decoder<BufReader<File>>,
    layout: Layout,
    grid: Grid,
    sample_type: Option<DecodingSampleType>,
) -> Result<Option<Strips>> {
    let black_is_zero = PhotometricInterpretation::BlackIsZero.to_u16();
    let white_is_zero = PhotometricInterpretation::WhiteIsZero.to_u16();
    let is_inverted = tag(path, decoder, Tag::PhotometricInterpretation, black_is_zero)? == white_is_zero;
    let samples: usize = tag(path, decoder, Tag::SamplesPerPixel, 1)?.into();
    let compression = tag(path, decoder, Tag::Compression, CompressionMethod::None.to_u16())?;
    let predictor = Predictor::from_u16(tag(path, decoder, Tag::Predictor, Predictor::None.to_u16())?);
    let (Some(sample_type), Some(predictor), false) = (sample_type, predictor, is_inverted) else { return Ok(None) };
    let mut numbers = |tag| decoder.get_tag_u64_vec(tag).map_err(reason(path));
    let (offsets, lengths) = (numbers(Tag::StripOffsets)?, numbers(Tag::StripByteCounts)?);
    let strips = Strips {
        layout,
        sample_type,
        byte_order: decoder.byte_order(),
        compression: CompressionMethod::from_u16_exhaustive(compression),
        predictor,
        rows_per_strip: grid.chunk_rows,
        planes: grid.planes,
        places: offsets.into_iter().zip(lengths).map(|(offset, length)| [offset, length]).collect(),
    };
    let is_whole = samples == layout.per_texel() && strips.places.len() == grid.down * grid.planes;
    Ok(Some(strips).filter(|strips| is_whole && strips.stream()))
}

/// Colours or bands of a texel, and whether alpha follows them.
fn colours(path: &Path, decoder: &mut Decoder<BufReader<File>>) -> Result<(usize, bool)> {
    // 1 and 2: the last sample is associated or unassociated alpha (TIFF 6.0, ExtraSamples).
    let extra = decoder.find_tag(Tag::ExtraSamples).map_err(reason(path))?;
    let extra = extra.and_then(|value| value.into_u16_vec().ok()).unwrap_or_default();
    let ends_with_alpha = matches!(extra.as_slice(), [1 | 2]);
    match decoder.colortype().map_err(reason(path))? {
        ColorType::Gray(_) => Ok((1, false)),
        ColorType::GrayA(_) => Ok((1, true)),
        ColorType::RGB(_) => Ok((3, false)),
        ColorType::RGBA(_) => Ok((3, true)),
        ColorType::Multiband { num_samples, .. } if ends_with_alpha => Ok((usize::from(num_samples) - 1, true)),
        ColorType::Multiband { num_samples, .. } => Ok((num_samples.into(), false)),
        other => {
            let reason = format!("its colours are {other:?}, not grey or RGB");
            Err(Error::file(path, reason, "convert it to grey or RGB"))
        }
    }
}

/// The type of a height for a type of samples.
fn depth(path: &Path, sample_type: Option<DecodingSampleType>, bits: u8) -> Result<HeightType> {
    use DecodingSampleType::{F16, F32, F64, I8, I16, U8, U16};
    match (sample_type, bits) {
        (Some(U8 | I8), 8) => Ok(HeightType::U8),
        (Some(U16 | I16), 16) => Ok(HeightType::U16),
        (Some(F16), 16) | (Some(F32), 32) | (Some(F64), 64) => Ok(HeightType::F32),
        _ => {
            let reason = format!("its samples are {bits}-bit integers, which texbake does not read from TIFF");
            Err(Error::file(path, reason, "convert it to 16-bit integers or 32-bit floats"))
        }
    }
}

/// GDAL's no-data value as a height: decimal text in tag 42113.
fn no_data(
    path: &Path,
    decoder: &mut Decoder<BufReader<File>>,
    sample_type: Option<DecodingSampleType>,
) -> Result<Option<NoData>> {
    let Some(text) = decoder.find_tag(Tag::GdalNodata).map_err(reason(path))? else { return Ok(None) };
    let text = text.into_string().map_err(reason(path))?;
    let text = text.trim_matches(['\0', ' ']);
    let height = |value: f64| match sample_type {
        Some(DecodingSampleType::I8) => (value + 128.0) as f32,
        Some(DecodingSampleType::I16) => (value + 32768.0) as f32,
        _ => value as f32,
    };
    Ok(text.parse().ok().map(|value| NoData { height: height(value), text: text.into() }))
}

/// A tag with one small number.
fn tag(path: &Path, decoder: &mut Decoder<BufReader<File>>, tag: Tag, default: u16) -> Result<u16> {
    Ok(decoder.find_tag_unsigned(tag).map_err(reason(path))?.unwrap_or(default))
}

impl GroupDecoder for TiffChunks {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn group_rows(&self) -> usize {
        self.grid.chunk_rows
    }

    /// A chunk, the bytes that it comes from if they are read at once, and the table of chunks.
    fn held_bytes(&self) -> u64 {
        let Grid { across, down, planes, .. } = self.grid;
        2 * self.chunk_bytes + (across * down * planes) as u64 * directory::CHUNK_ENTRY_BYTES
    }

    fn decode(&mut self, index: usize, group: &mut Samples) -> Result<()> {
        let Grid { chunk_width, chunk_rows, across, down, planes } = self.grid;
        let per_texel = self.grid.samples_of_chunk(self.layout);
        let rows = chunk_rows.min(self.layout.size.height() - index * chunk_rows);
        for (plane, column) in (0..planes).flat_map(|plane| (0..across).map(move |column| (plane, column))) {
            let chunk = ((plane * down + index) * across + column) as u32;
            let samples = self.decoder.read_chunk(chunk).map_err(reason(&self.path))?;
            let left = column * chunk_width;
            let place = Place {
                width: chunk_width.min(self.layout.size.width() - left),
                rows,
                per_texel,
                first: left * self.layout.per_texel() + plane,
                texel_stride: self.layout.per_texel(),
                row_stride: self.layout.per_row(),
            };
            if !place.put_samples(&samples, group) {
                return Err(damaged(&self.path, "a strip or tile has the wrong size"));
            }
        }
        Ok(())
    }
}

/// Where a chunk's samples stand among those of its group.
struct Place {
    width: usize,
    rows: usize,
    /// Samples of a texel in the chunk.
    per_texel: usize,
    /// The first sample.
    first: usize,
    texel_stride: usize,
    row_stride: usize,
}

impl Place {
    /// Copies a decoded chunk to its place; false if it has another size or type than its header says.
    fn put_samples(&self, chunk: &DecodingResult, group: &mut Samples) -> bool {
        match (chunk, group) {
            (DecodingResult::U8(from), Samples::U8(to)) => self.put(from, to, |v| v),
            (DecodingResult::I8(from), Samples::U8(to)) => self.put(from, to, |v| (v as u8) ^ 0x80),
            (DecodingResult::U16(from), Samples::U16(to)) => self.put(from, to, |v| v),
            (DecodingResult::I16(from), Samples::U16(to)) => self.put(from, to, |v| (v as u16) ^ 0x8000),
            (DecodingResult::F16(from), Samples::F32(to)) => self.put(from, to, |v| v.to_f32()),
            (DecodingResult::F32(from), Samples::F32(to)) => self.put(from, to, |v| v),
            (DecodingResult::F64(from), Samples::F32(to)) => self.put(from, to, |v| v as f32),
            _ => false,
        }
    }

    fn put<S: Copy, T>(&self, from: &[S], to: &mut [T], convert: impl Fn(S) -> T) -> bool {
        let row_length = self.width * self.per_texel;
        if from.len() != row_length * self.rows {
            return false;
        }
        for (row, from) in from.chunks_exact(row_length).enumerate() {
            let to = &mut to[row * self.row_stride + self.first..];
            if self.per_texel == self.texel_stride {
                to.iter_mut().zip(from).for_each(|(to, from)| *to = convert(*from));
            } else {
                let to = to.iter_mut().step_by(self.texel_stride);
                to.zip(from).for_each(|(to, from)| *to = convert(*from));
            }
        }
        true
    }
}

/// The decoder's reason, with the file and the way out.
fn reason(path: &Path) -> impl FnOnce(TiffError) -> Error + '_ {
    move |error| match error {
        TiffError::IoError(error) => io_reason(path, error),
        TiffError::LimitsExceeded => {
            Error::file(path, "it needs more memory than the limit", "raise it with --max-bytes")
        }
        TiffError::UnsupportedError(
            error @ (TiffUnsupportedError::UnknownCompressionMethod
            | TiffUnsupportedError::UnsupportedCompressionMethod(_)),
        ) => Error::file(path, error, "write it with deflate or LZW, or uncompressed"),
        TiffError::UnsupportedError(error) => {
            Error::file(path, error, "convert it to 8 or 16-bit grey or RGB, or to 32-bit floats")
        }
        error => damaged(path, error),
    }
}
