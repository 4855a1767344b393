//! TGA, BMP, JPEG and WebP: 8-bit formats that are decoded whole.

use super::damage::{damaged, io_reason, truncated};
use super::samples::{DecodedWhole, Layout, Opened, Samples};
use super::{input, limits, srgb};
use crate::error::{Error, Result};
use crate::map::HeightType;
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;

/// 16-bit coefficients of up to three components.
const COEFFICIENT_BYTES: usize = 3 * 2;

/// A texel as RGBA, or as brightness and colour, before it is a sample.
const WEBP_TEXEL_BYTES: usize = 4;

/// Opens a file, which is decoded when its first row is asked for.
pub(super) fn open(path: &Path, format: ImageFormat, max_bytes: u64) -> Result<Opened> {
    let file = input::open(path)?;
    // The decoders of these two hold the stored bytes.
    let is_held = matches!(format, ImageFormat::Jpeg | ImageFormat::WebP);
    let held = if is_held { file.metadata().map_err(Error::io(path))?.len() } else { 0 };
    limits::check_stored(path, held, max_bytes)?;
    let mut file = BufReader::new(file);
    // And bytes of each texel beside its samples.
    let (lossy, texel_bytes) = match format {
        ImageFormat::Jpeg => {
            let jpeg = jpeg_markers(&mut file).map_err(Error::io(path))?;
            if !jpeg.has_end {
                // The decoder would fill what is missing with grey.
                return Err(truncated(path));
            }
            (true, if jpeg.is_progressive { COEFFICIENT_BYTES } else { 0 })
        }
        ImageFormat::WebP => (webp_is_lossy(&mut file).map_err(Error::io(path))?, WEBP_TEXEL_BYTES),
        _ => (false, 0),
    };
    file.rewind().map_err(Error::io(path))?;
    let mut decoder = decoder(path, file, format, max_bytes)?;

    let (width, height) = decoder.dimensions();
    let size = limits::size(path, width.into(), height.into())?;
    limits::check(path, size, u128::from(held) + u128::from(decoder.total_bytes()), max_bytes)?;
    let (colours, alpha) = match decoder.color_type() {
        ColorType::L8 => (1, false),
        ColorType::La8 => (1, true),
        ColorType::Rgb8 => (3, false),
        ColorType::Rgba8 => (3, true),
        other => {
            let reason = format!("its colour type {other:?} is not one that texbake reads in this format");
            return Err(Error::file(path, reason, "convert it to PNG"));
        }
    };
    let layout = Layout { size, depth: HeightType::U8, colours, alpha };
    let profile = decoder.icc_profile().unwrap_or_default().unwrap_or_default();
    let whole = {
        let path = path.to_owned();
        let beside = held + (texel_bytes * size.texels()) as u64;
        DecodedWhole::new(layout, beside, move || decode(&path, format, layout, max_bytes))
    };
    Ok(Opened { says_srgb: srgb::is_named_by(&profile), lossy, ..Opened::new(whole) })
}

fn decoder<F: BufRead + Seek + 'static>(
    path: &Path,
    file: F,
    format: ImageFormat,
    max_bytes: u64,
) -> Result<impl ImageDecoder + use<F>> {
    let mut reader = ImageReader::with_format(file, format);
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(max_bytes);
    reader.limits(limits);
    reader.into_decoder().map_err(reason(path))
}

/// The samples of a file, which is opened anew: a decoder that waits would hold the stored bytes.
fn decode(path: &Path, format: ImageFormat, layout: Layout, max_bytes: u64) -> Result<Samples> {
    let decoder = decoder(path, BufReader::new(input::open(path)?), format, max_bytes)?;
    let mut samples = vec![0; layout.row_bytes() * layout.size.height()];
    if decoder.total_bytes() != samples.len() as u64 {
        return Err(damaged(path, "its rows do not have the length that its header says"));
    }
    decoder.read_image(&mut samples).map_err(reason(path))?;
    Ok(Samples::U8(samples))
}

/// What the markers of a JPEG say; coded data holds none of them (ITU T.81, B.1.1.5).
#[derive(Default)]
struct JpegMarkers {
    /// Whether an end-of-image marker follows the last start-of-scan marker.
    has_end: bool,
    /// Whether all coefficients are held until the last scan; said by a picture in the metadata too.
    is_progressive: bool,
}

fn jpeg_markers(file: &mut impl BufRead) -> io::Result<JpegMarkers> {
    let mut markers = JpegMarkers::default();
    let (mut previous, mut has_scan) = (0, false);
    loop {
        let bytes = file.fill_buf()?;
        for byte in bytes {
            match [previous, *byte] {
                [0xff, 0xda] => (has_scan, markers.has_end) = (true, false),
                [0xff, 0xd9] => markers.has_end = has_scan,
                [0xff, 0xc2] => markers.is_progressive = true,
                _ => (),
            }
            previous = *byte;
        }
        let count = bytes.len();
        if count == 0 {
            return Ok(markers);
        }
        file.consume(count);
    }
}

/// Whether the first coded picture of a WebP is in a `VP8 ` chunk; lossless ones are in `VP8L` (RFC 9649, section 2).
fn webp_is_lossy(file: &mut BufReader<File>) -> io::Result<bool> {
    // Behind "RIFF", the file's length and "WEBP": four letters, a length, as many bytes, and one more if it is odd.
    let mut header = [0; 8];
    file.seek(SeekFrom::Start(12))?;
    loop {
        match file.read_exact(&mut header) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(false),
            read => read?,
        }
        let [letters @ .., a, b, c, d] = header;
        match &letters {
            b"VP8 " => return Ok(true),
            b"VP8L" => return Ok(false),
            _ => {
                let length = i64::from(u32::from_le_bytes([a, b, c, d]));
                file.seek_relative(length + length % 2)?;
            }
        }
    }
}

/// The decoder's reason, with the file and the way out.
fn reason(path: &Path) -> impl FnOnce(ImageError) -> Error + '_ {
    move |error| match error {
        ImageError::IoError(error) => io_reason(path, error),
        ImageError::Limits(error) => Error::file(path, error, "raise the limit with --max-bytes"),
        ImageError::Unsupported(error) => Error::file(path, error, "convert it to PNG"),
        error => damaged(path, error),
    }
}
