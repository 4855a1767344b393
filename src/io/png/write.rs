//! PNG normal maps.

use crate::error::{Error, Result};
use crate::io::replace::{Output, Replacement};
use crate::io::sink::{FileSink, RowEncoder, cannot_hold};
use crate::map::{Channels, CodesRef, Depth, Encoding, NormalFormat, Size};
use crate::stream::RowSink;
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, StreamWriter};
use std::io::Write;
use std::path::{Path, PathBuf};

/// How hard deflate works: `Fast` filters the rows adaptively and uses a deflate made for PNG: several times the speed
/// of deflate's level 1 at about a tenth more bytes.
const COMPRESSION: Compression = Compression::Fast;

/// Compressed bytes that go to the file at once, as one IDAT chunk.
const CHUNK_BYTES: usize = 256 << 10;

/// Streams rows through deflate.
struct PngEncoder {
    path: PathBuf,
    rows: StreamWriter<'static, Output>,
    channels: Channels,
    /// Rows in the file's channels and byte order.
    bytes: Vec<u8>,
}

/// Creates a PNG with 8 or 16 bits, RGB; xy maps leave blue 0, since PNG's only two-channel type means transparency.
pub(crate) fn create(path: &Path, size: Size, format: NormalFormat) -> Result<Box<dyn RowSink>> {
    let depth = match (format.encoding, format.depth) {
        (Encoding::Unorm | Encoding::Biased, Depth::Bits8) => BitDepth::Eight,
        (Encoding::Unorm | Encoding::Biased, Depth::Bits16) => BitDepth::Sixteen,
        (Encoding::Snorm, _) => {
            return Err(cannot_hold(
                path,
                format,
                "unorm or biased in PNG, which has no signed numbers; TIFF has them",
            ));
        }
        _ => {
            return Err(cannot_hold(
                path,
                format,
                "unorm or biased with 8 or 16 bits in PNG; EXR and TIFF hold floats",
            ));
        }
    };
    let replacement = Replacement::create(path)?;
    let [width, height] = [size.width(), size.height()].map(|side| side as u32);
    let mut encoder = Encoder::new(replacement.output()?, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(depth);
    encoder.set_compression(COMPRESSION);
    let writer = encoder.write_header().map_err(reason(path))?;
    let rows = writer.into_stream_writer_with_size(CHUNK_BYTES).map_err(reason(path))?;
    let encoder = PngEncoder { path: path.into(), rows, channels: format.channels, bytes: Vec::new() };
    Ok(FileSink::boxed(encoder, replacement, size, format))
}

impl RowEncoder for PngEncoder {
    fn write(&mut self, rows: CodesRef<'_>) -> Result<()> {
        let bytes = match (rows, self.channels) {
            (CodesRef::U8(codes), Channels::Xyz) => codes,
            (CodesRef::U8(codes), Channels::Xy) => {
                self.bytes.clear();
                self.bytes.extend(codes.chunks_exact(2).flat_map(|xy| [xy[0], xy[1], 0]));
                &self.bytes
            }
            (CodesRef::U16(codes), Channels::Xyz) => {
                self.bytes.resize(codes.len() * 2, 0);
                let places = self.bytes.chunks_exact_mut(2);
                places.zip(codes).for_each(|(place, code)| place.copy_from_slice(&code.to_be_bytes()));
                &self.bytes
            }
            (CodesRef::U16(codes), Channels::Xy) => {
                self.bytes.clear();
                self.bytes.extend(codes.chunks_exact(2).flat_map(|xy| {
                    let ([a, b], [c, d]) = (xy[0].to_be_bytes(), xy[1].to_be_bytes());
                    [a, b, c, d, 0, 0]
                }));
                &self.bytes
            }
            (CodesRef::F16(_) | CodesRef::F32(_), _) => unreachable!("the depth was checked when the file was created"),
        };
        self.rows.write_all(bytes).map_err(Error::io(&self.path))
    }

    fn finish(self: Box<Self>) -> Result<()> {
        self.rows.finish().map_err(reason(&self.path))
    }
}

/// The encoder's reason, with the file.
fn reason(path: &Path) -> impl FnOnce(EncodingError) -> Error + '_ {
    move |error| Error::io(path)(error.into())
}
