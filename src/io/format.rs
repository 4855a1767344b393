//! File formats: by their first bytes, and by their extension.

use crate::error::{Error, Result};
use crate::map::{Depth, Encoding};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A file format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FileFormat {
    Png,
}

const KNOWN_INPUTS: &str = "texbake reads PNG, TIFF, EXR, TGA, BMP, JPEG and WebP, and headerless files with --raw";
const KNOWN_OUTPUTS: &str = "texbake writes .png, .tif, .tiff and .exr";

impl FileFormat {
    /// The format of an existing file, by its first bytes, then by its extension.
    pub fn of_file(path: &Path) -> Result<Self> {
        let mut first = Vec::new();
        let file = File::open(path).map_err(Error::io(path))?;
        file.take(16).read_to_end(&mut first).map_err(Error::io(path))?;
        if first.is_empty() {
            return Err(Error::file(path, "the file is empty", "copy or export it again"));
        }
        Self::of_bytes(&first).ok_or_else(|| Error::file(path, "this is no format that texbake knows", KNOWN_INPUTS))
    }

    fn of_bytes(first: &[u8]) -> Option<Self> {
        match first {
            [0x89, b'P', b'N', b'G', ..] => Some(Self::Png),
            _ => None,
        }
    }

    /// The format that the extension of an output asks for.
    pub fn of_output(path: &Path) -> Result<Self> {
        match extension(path).as_str() {
            "png" => Ok(Self::Png),
            "" => Err(Error::file(path, "it has no extension, which picks the format", KNOWN_OUTPUTS)),
            other => Err(Error::file(path, format!("the extension .{other} is unknown"), KNOWN_OUTPUTS)),
        }
    }
}

/// The encoding and depth that the extension of an output suggests: 8-bit unorm for PNG, 16-bit unorm for TIFF, float
/// for EXR.
///
/// # Errors
/// [`Error::File`] lists the known extensions if this is none of them.
pub fn default_format(path: &Path) -> Result<(Encoding, Depth)> {
    Ok(match FileFormat::of_output(path)? {
        FileFormat::Png => (Encoding::Unorm, Depth::Bits8),
    })
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}
