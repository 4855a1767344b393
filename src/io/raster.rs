//! TGA, BMP, JPEG and WebP: 8-bit formats that are decoded whole.

use super::damage::{damaged, io_reason, truncated};
use super::samples::{DecodedWhole, Layout, Opened, Samples};
use super::{input, limits, srgb};
use crate::error::{Error, Result};
use crate::map::HeightType;
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Take};
use std::path::Path;

/// Opens a file, which is decoded when its first row is asked for.
pub(super) fn open(path: &Path, format: ImageFormat, max_bytes: u64) -> Result<Opened> {
    let file = input::open(path)?;
    // The decoders of these two hold the stored bytes.
    let is_held = matches!(format, ImageFormat::Jpeg | ImageFormat::WebP);
    let held = if is_held { file.metadata().map_err(Error::io(path))?.len() } else { 0 };
    limits::check_stored(path, held, max_bytes)?;
    let mut file = BufReader::new(file);
    if format == ImageFormat::Jpeg && !jpeg_has_end(&mut file).map_err(Error::io(path))? {
        // The decoder would fill what is missing with grey.
        return Err(truncated(path));
    }
    let lossy = match format {
        ImageFormat::Jpeg => true,
        ImageFormat::WebP => webp_is_lossy(&mut file).map_err(Error::io(path))?,
        _ => false,
    };
    file.rewind().map_err(Error::io(path))?;
    let mut decoder = decoder(path, head(file, format).map_err(Error::io(path))?, format, max_bytes)?;

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
        DecodedWhole::new(layout, held, move || decode(&path, format, layout, max_bytes))
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

/// What a decoder needs to tell the size: of a JPEG, whose decoder reads to the end before it can be asked anything, the
/// segments up to the header of the first scan (ITU T.81, B.1.1.4 and B.2.1).
fn head(mut file: BufReader<File>, format: ImageFormat) -> io::Result<Take<BufReader<File>>> {
    let length = file.get_ref().metadata()?.len();
    // Behind the start-of-image marker.
    let mut end = 2;
    while format == ImageFormat::Jpeg {
        let mut segment = [0; 4];
        file.seek(SeekFrom::Start(end))?;
        match file.read_exact(&mut segment) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => segment.fill(0),
            read => read?,
        }
        match segment {
            [0xff, 0xff, ..] => end += 1,
            [0xff, marker, length @ ..] => {
                end += 2 + u64::from(u16::from_be_bytes(length));
                if marker == 0xda {
                    file.rewind()?;
                    return Ok(file.take(end));
                }
            }
            // The decoder says what is wrong.
            _ => break,
        }
    }
    file.rewind()?;
    Ok(file.take(length))
}

/// Whether an end-of-image marker follows the last start-of-scan marker; coded data holds neither (ITU T.81, B.1.1.5).
fn jpeg_has_end(file: &mut impl BufRead) -> io::Result<bool> {
    let (mut previous, mut has_scan, mut has_end) = (0, false, false);
    loop {
        let bytes = file.fill_buf()?;
        for byte in bytes {
            match [previous, *byte] {
                [0xff, 0xda] => (has_scan, has_end) = (true, false),
                [0xff, 0xd9] => has_end = has_scan,
                _ => (),
            }
            previous = *byte;
        }
        let count = bytes.len();
        if count == 0 {
            return Ok(has_end);
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
