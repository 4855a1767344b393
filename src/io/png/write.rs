//! PNG normal and parallax maps, written.
//!
//! The first row of a map that wraps can only be baked when the last one is known, and waiting for it would keep
//! decoding and encoding from overlapping. So the first row is stored, not deflated: its bytes have a known number,
//! room is left for them, and they are filled in whenever the row arrives. Row 1 is filtered without looking up. The
//! file is the same whenever row 0 comes, and hardly larger.
//!
//! The other rows are cut into stripes of a fixed height, which several threads filter and deflate. The bytes depend on
//! neither the threads nor the number of rows that come at once.

use super::stripe::Stripe;
use super::zlib::{self, adler_of_both};
use crate::error::{Error, Result};
use crate::io::Compression;
use crate::io::in_order::InOrder;
use crate::io::replace::{Output, Replacement};
use crate::io::sink::{FileSink, RowEncoder, cannot_hold};
use crate::map::{CodesRef, Depth, Encoding, Size, TexelFormat};
use png::chunk::IDAT;
use png::{BitDepth, ColorType, Encoder, EncodingError, Writer};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Where the first IDAT chunk begins: behind the signature and IHDR.
const FIRST_IDAT: u64 = 8 + 25;

/// The first byte of a row that is not filtered (PNG specification, section 9).
const NONE: u8 = 0;

/// Chunks are cut here: PNG's may have 2^31 - 1 bytes (PNG specification, section 5.3).
const CHUNK_MOST: usize = 1 << 30;

/// Filters and deflates rows on several threads.
struct PngEncoder {
    path: PathBuf,
    writer: Writer<Output>,
    /// The same file, to fill the room that was left.
    file: Output,
    layout: RowLayout,
    compression: Compression,
    /// Rows of a stripe; the last one may have fewer.
    stripe_rows: usize,
    first_row: Vec<u8>,
    /// The stripe that is being filled; those on their way; one that was written.
    stripe: Stripe,
    encoding: InOrder<Stripe, Stripe>,
    free: Option<Stripe>,
    /// Of all stripes written so far: the Adler-32 of what was deflated, and its bytes.
    checksum: u32,
    bytes: u64,
}

/// How a row of codes becomes a row of samples.
struct RowLayout {
    channels: usize,
    depth: Depth,
    /// Bytes of a row and of a texel in the file.
    row_bytes: usize,
    texel_bytes: usize,
}

/// Creates a PNG with 8 or 16 bits: grey for one channel, else RGB; xy maps leave blue 0, since PNG's only two-channel
/// type means transparency.
pub(crate) fn create(path: &Path, size: Size, format: TexelFormat, compression: Compression) -> Result<Box<FileSink>> {
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
    writer.write_chunk(IDAT, &vec![0; zlib::first_bytes(1 + row_bytes)]).map_err(reason(path))?;
    // A small map needs no more than its rows.
    let stripe_rows = compression.stripe_rows(row_bytes).min(size.height() - 1);
    let mut stripe = Stripe::default();
    stripe.begin(stripe_rows, row_bytes, texel_bytes, None);
    let encoder = PngEncoder {
        path: path.into(),
        writer,
        file: replacement.output()?,
        layout: RowLayout { channels: format.channels, depth: format.depth, row_bytes, texel_bytes },
        compression,
        stripe_rows,
        first_row: Vec::new(),
        stripe,
        encoding: InOrder::new(stripe_rows * (1 + row_bytes), move |stripe: Stripe| stripe.encoded(compression)),
        free: None,
        checksum: 1, // of no bytes
        bytes: 0,
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
    /// The first row, the one above a stripe, and stripes: the one that is filled and those on their way.
    fn held_bytes(&self, _: usize) -> u64 {
        let stripes = (self.encoding.most() + 1) * self.compression.buffers();
        (3 * self.layout.row_bytes + stripes * (self.stripe_rows + 1) * (1 + self.layout.row_bytes)) as u64
    }

    fn takes_first_row_last(&self) -> bool {
        true
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        for (row, codes) in (first..).zip(rows.bytes().chunks_exact(self.layout.code_bytes())) {
            if row == 0 {
                self.first_row = vec![NONE; 1 + self.layout.row_bytes];
                self.layout.fill(&mut self.first_row[1..], codes);
            } else {
                if self.stripe.count() == self.stripe_rows {
                    self.send_stripe()?;
                }
                self.layout.fill(self.stripe.next_row(), codes);
            }
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        // Meanwhile other threads have the stripes before it; a small map needs none.
        let last = std::mem::take(&mut self.stripe).encoded(self.compression);
        while let Some(stripe) = self.encoding.pop() {
            self.write_stripe(stripe)?;
        }
        self.write_stripe(last)?;
        let Self { path, mut writer, mut file, first_row, checksum, bytes, .. } = *self;
        let checksum = adler_of_both(simd_adler32::adler32(&first_row.as_slice()), checksum, bytes);
        let end = zlib::end(checksum);
        writer.write_chunk(IDAT, &end).and_then(|()| writer.finish()).map_err(reason(&path))?;
        let mut fill = || {
            file.seek(SeekFrom::Start(FIRST_IDAT))?;
            file.write_all(&zlib::first_idat(&first_row))
        };
        fill().map_err(Error::io(&path))
    }
}

impl PngEncoder {
    /// Lets some thread encode the stripe, and goes on with the next one.
    fn send_stripe(&mut self) -> Result<()> {
        let above = self.stripe.last_row().to_vec();
        self.encoding.push(std::mem::take(&mut self.stripe));
        while let Some(stripe) = self.encoding.pop_surplus() {
            self.write_stripe(stripe)?;
        }
        self.stripe = self.free.take().unwrap_or_default();
        self.stripe.begin(self.stripe_rows, self.layout.row_bytes, self.layout.texel_bytes, Some(&above));
        Ok(())
    }

    fn write_stripe(&mut self, stripe: Stripe) -> Result<()> {
        for chunk in stripe.deflated().chunks(CHUNK_MOST) {
            self.writer.write_chunk(IDAT, chunk).map_err(reason(&self.path))?;
        }
        let (checksum, bytes) = stripe.checksum();
        self.checksum = adler_of_both(self.checksum, checksum, bytes);
        self.bytes += bytes;
        self.free = Some(stripe);
        Ok(())
    }
}

impl RowLayout {
    /// Bytes of a row of codes.
    fn code_bytes(&self) -> usize {
        self.row_bytes / self.texel_bytes * self.channels * self.depth.bytes()
    }

    /// Brings a row of codes into the file's channels and byte order.
    fn fill(&self, row: &mut [u8], codes: &[u8]) {
        let texels = row.chunks_exact_mut(self.texel_bytes);
        match (self.depth, self.channels) {
            (Depth::Bits8, 2) => {
                texels.zip(codes.chunks_exact(2)).for_each(|(rgb, xy)| rgb.copy_from_slice(&[xy[0], xy[1], 0]));
            }
            (Depth::Bits8, _) => row.copy_from_slice(codes),
            (_, 2) => texels.zip(codes.chunks_exact(4)).for_each(|(rgb, xy)| {
                let (x, y) = (big_endian(&xy[..2]), big_endian(&xy[2..]));
                rgb.copy_from_slice(&[x[0], x[1], y[0], y[1], 0, 0]);
            }),
            _ => {
                let samples = row.chunks_exact_mut(2).zip(codes.chunks_exact(2));
                samples.for_each(|(sample, code)| sample.copy_from_slice(&big_endian(code)));
            }
        }
    }
}

/// A 16-bit code, most significant byte first, as PNG stores it.
fn big_endian(code: &[u8]) -> [u8; 2] {
    u16::from_ne_bytes([code[0], code[1]]).to_be_bytes()
}

/// The encoder's reason, with the file.
fn reason(path: &Path) -> impl FnOnce(EncodingError) -> Error + '_ {
    move |error| match error {
        // The crate's own conversion loses the kind, and with it the way out.
        EncodingError::IoError(error) => Error::io(path)(error),
        error => Error::io(path)(error.into()),
    }
}
