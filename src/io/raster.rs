//! TGA, BMP, JPEG and WebP: 8-bit formats that are decoded whole.

use super::samples::{DecodedWhole, Layout, Opened, Samples};
use super::{ReadOptions, limits, srgb};
use crate::error::{Error, Result};
use crate::map::HeightType;
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use std::io::{Cursor, ErrorKind};
use std::path::Path;

/// Opens and decodes a file.
pub(super) fn open(path: &Path, format: ImageFormat, options: &ReadOptions) -> Result<Opened> {
    let stored = std::fs::read(path).map_err(Error::io(path))?;
    if format == ImageFormat::Jpeg && !jpeg_has_end(&stored) {
        // The decoder would fill what is missing with grey.
        return Err(Error::file(path, TRUNCATED, "copy or export it again"));
    }
    let mut reader = ImageReader::with_format(Cursor::new(stored), format);
    let mut decoder_limits = Limits::no_limits();
    decoder_limits.max_alloc = Some(options.max_bytes);
    reader.limits(decoder_limits);
    let mut decoder = reader.into_decoder().map_err(reason(path))?;

    let (width, height) = decoder.dimensions();
    let size = limits::size(path, width.into(), height.into())?;
    limits::check(path, size, decoder.total_bytes().into(), options.max_bytes)?;
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
    let mut samples = vec![0; layout.row_bytes() * size.height()];
    if decoder.total_bytes() != samples.len() as u64 {
        return Err(Error::file(path, "its rows do not have the length that its header says", DAMAGED));
    }
    decoder.read_image(&mut samples).map_err(reason(path))?;
    let whole = DecodedWhole::new(layout, Samples::U8(samples));
    Ok(Opened { says_srgb: srgb::is_named_by(&profile), ..Opened::new(whole) })
}

/// Whether an end-of-image marker follows the last start-of-scan marker; coded data holds neither (ITU T.81, B.1.1.5).
fn jpeg_has_end(stored: &[u8]) -> bool {
    let position = |marker: [u8; 2]| stored.windows(2).rposition(|pair| pair == marker);
    position([0xff, 0xda]).is_some_and(|scan| position([0xff, 0xd9]).is_some_and(|end| end > scan))
}

const TRUNCATED: &str = "the file ends before its last row: it is truncated";
const DAMAGED: &str = "it is damaged; copy or export it again";

/// The decoder's reason, with the file and the way out.
fn reason(path: &Path) -> impl FnOnce(ImageError) -> Error + '_ {
    move |error| match error {
        ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            Error::file(path, TRUNCATED, "copy or export it again")
        }
        ImageError::IoError(error) => Error::io(path)(error),
        ImageError::Limits(error) => Error::file(path, error, "raise the limit with --max-bytes"),
        ImageError::Unsupported(error) => Error::file(path, error, "convert it to PNG"),
        error => Error::file(path, error, DAMAGED),
    }
}
