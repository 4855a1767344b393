//! PNG normal and parallax maps, written.
//!
//! The first row of a map that wraps can only be baked when the last one is known, and waiting for it would keep
//! decoding and encoding from overlapping. So the first row is stored, not deflated: its bytes have a known number,
//! room is left for them, and they are filled in whenever the row arrives. Row 1 is filtered without looking up. The
//! file is the same whenever row 0 comes, and hardly larger.

use super::zlib::{CHUNK_BYTES, IdatStream, first_idat, stored_bytes};
use crate::error::{Error, Result};
use crate::io::Compression;
use crate::io::replace::{Output, Replacement};
use crate::io::sink::{FileSink, RowEncoder, cannot_hold};
use crate::map::{CodesRef, Depth, Encoding, Size, TexelFormat};
use crate::stream::RowSink;
use png::chunk::IDAT;
use png::{BitDepth, ColorType, Encoder, EncodingError};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Where the first IDAT chunk begins: behind the signature and IHDR.
const FIRST_IDAT: u64 = 8 + 25;

/// The first byte of a filtered row (PNG specification, section 9).
const NONE: u8 = 0;
const SUB: u8 = 1;
const PAETH: u8 = 4;

/// Streams rows through deflate.
struct PngEncoder {
    path: PathBuf,
    stream: IdatStream,
    /// The same file, to fill the room that was left.
    file: Output,
    channels: usize,
    depth: Depth,
    /// Bytes of a row and of a texel in the file.
    row_bytes: usize,
    texel_bytes: usize,
    first_row: Vec<u8>,
    previous: Vec<u8>,
    current: Vec<u8>,
    filtered: Vec<u8>,
}

/// Creates a PNG with 8 or 16 bits: grey for one channel, else RGB; xy maps leave blue 0, since PNG's only two-channel
/// type means transparency.
pub(crate) fn create(path: &Path, size: Size, format: TexelFormat, _: Compression) -> Result<Box<dyn RowSink>> {
    let depth = bit_depth(path, format)?;
    let replacement = Replacement::create(path)?;
    let [width, height] = [size.width(), size.height()].map(|side| side as u32);
    let mut encoder = Encoder::new(replacement.output()?, width, height);
    let (colour, samples) = match format.channels {
        1 => (ColorType::Grayscale, 1),
        _ => (ColorType::Rgb, 3),
    };
    encoder.set_color(colour);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().map_err(reason(path))?;
    let texel_bytes = samples * format.depth.bytes();
    let row_bytes = size.width() * texel_bytes;
    writer.write_chunk(IDAT, &vec![0; 2 + stored_bytes(1 + row_bytes)]).map_err(reason(path))?;
    let encoder = PngEncoder {
        path: path.into(),
        stream: IdatStream::new(writer),
        file: replacement.output()?,
        channels: format.channels,
        depth: format.depth,
        row_bytes,
        texel_bytes,
        first_row: Vec::new(),
        previous: vec![0; row_bytes],
        current: vec![0; row_bytes],
        filtered: Vec::with_capacity(1 + row_bytes),
    };
    Ok(FileSink::boxed(encoder, replacement, size, format))
}

/// Fails if a PNG cannot hold `format`.
pub(crate) fn check(path: &Path, format: TexelFormat) -> Result<()> {
    bit_depth(path, format).map(drop)
}

fn bit_depth(path: &Path, format: TexelFormat) -> Result<BitDepth> {
    match (format.encoding, format.depth) {
        (Encoding::Unorm | Encoding::Biased, Depth::Bits8) => Ok(BitDepth::Eight),
        (Encoding::Unorm | Encoding::Biased, Depth::Bits16) => Ok(BitDepth::Sixteen),
        (Encoding::Snorm, _) => {
            let remedy = match format.channels {
                1 => "biased in PNG, which has no signed numbers; TIFF has them",
                _ => "unorm or biased in PNG, which has no signed numbers; TIFF has them",
            };
            Err(cannot_hold(path, format, remedy))
        }
        _ => {
            let remedy = "unorm or biased with 8 or 16 bits in PNG; EXR and TIFF hold floats";
            Err(cannot_hold(path, format, remedy))
        }
    }
}

impl RowEncoder for PngEncoder {
    /// Four rows, and what is deflated of a chunk.
    fn held_bytes(&self, _: usize) -> u64 {
        (4 * self.row_bytes + 2 * CHUNK_BYTES) as u64
    }

    fn takes_first_row_last(&self) -> bool {
        true
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let row_codes = self.row_bytes / self.texel_bytes * self.channels;
        let bytes = rows.bytes().chunks_exact(row_codes * self.depth.bytes());
        for (row, codes) in (first..).zip(bytes) {
            self.samples(codes);
            match row {
                0 => self.first_row = [&[NONE], self.current.as_slice()].concat(),
                1 => self.deflate(SUB),
                _ => self.deflate(PAETH),
            }
            std::mem::swap(&mut self.previous, &mut self.current);
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        let Self { path, stream, mut file, first_row, .. } = *self;
        stream.finish(&first_row).map_err(reason(&path))?;
        let mut fill = || {
            file.seek(SeekFrom::Start(FIRST_IDAT))?;
            file.write_all(&first_idat(&first_row))
        };
        fill().map_err(Error::io(&path))
    }
}

impl PngEncoder {
    /// Brings a row of codes into the file's channels and byte order.
    fn samples(&mut self, codes: &[u8]) {
        let texels = self.current.chunks_exact_mut(self.texel_bytes);
        match (self.depth, self.channels) {
            (Depth::Bits8, 2) => {
                texels.zip(codes.chunks_exact(2)).for_each(|(rgb, xy)| rgb.copy_from_slice(&[xy[0], xy[1], 0]));
            }
            (Depth::Bits8, _) => self.current.copy_from_slice(codes),
            (_, 2) => texels.zip(codes.chunks_exact(4)).for_each(|(rgb, xy)| {
                let (x, y) = (big_endian(&xy[..2]), big_endian(&xy[2..]));
                rgb.copy_from_slice(&[x[0], x[1], y[0], y[1], 0, 0]);
            }),
            _ => {
                let samples = self.current.chunks_exact_mut(2).zip(codes.chunks_exact(2));
                samples.for_each(|(sample, code)| sample.copy_from_slice(&big_endian(code)));
            }
        }
    }

    /// Filters the current row and deflates it.
    fn deflate(&mut self, filter: u8) {
        self.filtered.clear();
        self.filtered.push(filter);
        match filter {
            SUB => sub(&self.current, self.texel_bytes, &mut self.filtered),
            _ => paeth(&self.current, &self.previous, self.texel_bytes, &mut self.filtered),
        }
        self.stream.write(&self.filtered);
    }
}

/// A 16-bit code, most significant byte first, as PNG stores it.
fn big_endian(code: &[u8]) -> [u8; 2] {
    u16::from_ne_bytes([code[0], code[1]]).to_be_bytes()
}

/// Each byte less the one a texel to its left.
fn sub(row: &[u8], texel: usize, filtered: &mut Vec<u8>) {
    filtered.extend_from_slice(&row[..texel]);
    filtered.extend(row[texel..].iter().zip(row).map(|(here, left)| here.wrapping_sub(*left)));
}

/// Each byte less the one of left, up and upper left that is nearest to left + up - upper left.
fn paeth(row: &[u8], above: &[u8], texel: usize, filtered: &mut Vec<u8>) {
    filtered.extend(row[..texel].iter().zip(above).map(|(here, up)| here.wrapping_sub(*up)));
    let around = row.iter().zip(&above[texel..]).zip(above);
    filtered.extend(
        row[texel..]
            .iter()
            .zip(around)
            .map(|(here, ((left, up), upper_left))| here.wrapping_sub(nearest(*left, *up, *upper_left))),
    );
}

/// The Paeth predictor, in an order that vectorises.
fn nearest(left: u8, up: u8, upper_left: u8) -> u8 {
    let [a, b, c] = [left, up, upper_left].map(i16::from);
    let [from_left, from_up, from_upper_left] = [(b - c).abs(), (a - c).abs(), (a + b - 2 * c).abs()];
    let of_columns = if from_up <= from_upper_left { up } else { upper_left };
    if from_left <= from_up && from_left <= from_upper_left { left } else { of_columns }
}

/// The encoder's reason, with the file.
fn reason(path: &Path) -> impl FnOnce(EncodingError) -> Error + '_ {
    move |error| match error {
        // The crate's own conversion loses the kind, and with it the way out.
        EncodingError::IoError(error) => Error::io(path)(error),
        error => Error::io(path)(error.into()),
    }
}
