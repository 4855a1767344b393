//! File formats: by their first bytes, and by their extension.

use super::input;
use super::texture::Container;
use crate::error::{Error, Result};
use crate::map::{Depth, Encoding, ParallaxFormat};
use image::ImageFormat;
use std::io::Read;
use std::path::Path;

/// A file format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FileFormat {
    Png,
    Tiff,
    Exr,
    /// Decoded whole by `image`.
    Raster(ImageFormat),
}

/// A file format that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OutputFormat {
    Png,
    Tiff,
    Exr,
    Texture(Container),
}

/// The usual extensions of the formats that are read, in lower case; the last three are those of headerless files.
pub const INPUT_EXTENSIONS: [&str; 12] =
    ["png", "tif", "tiff", "exr", "tga", "bmp", "jpg", "jpeg", "webp", "raw", "r16", "r32"];

const KNOWN_INPUTS: &str =
    "texbake reads PNG, TIFF, EXR, TGA, BMP, JPEG and WebP, and headerless height maps with --raw";
const FOR_MODELS: &str = "models are for texbake tangents; the other commands take maps";
const MODEL_EXTENSIONS: [&str; 3] = ["glb", "gltf", "obj"];
const KNOWN_OUTPUTS: &str = "texbake writes .png, .tif, .tiff, .exr, .ktx2 and .dds";

impl FileFormat {
    /// The format of an existing file, by its first bytes, then by its extension.
    pub fn of_file(path: &Path) -> Result<Self> {
        let mut first = Vec::new();
        let file = input::open(path)?;
        file.take(16).read_to_end(&mut first).map_err(Error::io(path))?;
        if first.is_empty() {
            return Err(Error::file(path, "the file is empty", "copy or export it again"));
        }
        let format = Self::of_bytes(&first).or_else(|| (extension(path) == "tga").then_some(TGA));
        format.ok_or_else(|| {
            if let Some(name) = of_written_only(&first) {
                return Error::file(path, format!("{name} is written, and not read"), KNOWN_INPUTS);
            }
            let is_model = first.starts_with(b"glTF") || MODEL_EXTENSIONS.contains(&extension(path).as_str());
            let remedy = if is_model { format!("{KNOWN_INPUTS}; {FOR_MODELS}") } else { KNOWN_INPUTS.to_owned() };
            Error::file(path, "this is no format that texbake knows", remedy)
        })
    }

    fn of_bytes(first: &[u8]) -> Option<Self> {
        match first {
            [0x89, b'P', b'N', b'G', ..] => Some(Self::Png),
            // TIFF and BigTIFF, least or most significant byte first.
            [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => Some(Self::Tiff),
            [0x76, 0x2f, 0x31, 0x01, ..] => Some(Self::Exr),
            [0xff, 0xd8, 0xff, ..] => Some(Self::Raster(ImageFormat::Jpeg)),
            [b'B', b'M', ..] => Some(Self::Raster(ImageFormat::Bmp)),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some(Self::Raster(ImageFormat::WebP)),
            _ => None,
        }
    }
}

/// The name of a format that is written only, by the first bytes of its files.
fn of_written_only(first: &[u8]) -> Option<&'static str> {
    match first {
        [b'D', b'D', b'S', b' ', ..] => Some("DDS"),
        [0xab, b'K', b'T', b'X', b' ', b'2', b'0', 0xbb, ..] => Some("KTX2"),
        _ => None,
    }
}

/// The one format that does not say what it is.
const TGA: FileFormat = FileFormat::Raster(ImageFormat::Tga);

impl OutputFormat {
    /// The format that the extension of an output asks for.
    pub fn of(path: &Path) -> Result<Self> {
        match extension(path).as_str() {
            "png" => Ok(Self::Png),
            "tif" | "tiff" => Ok(Self::Tiff),
            "exr" => Ok(Self::Exr),
            "ktx2" => Ok(Self::Texture(Container::Ktx2)),
            "dds" => Ok(Self::Texture(Container::Dds)),
            "" => Err(Error::file(path, "it has no extension, which picks the format", KNOWN_OUTPUTS)),
            other => Err(Error::file(path, format!("the extension .{other} is unknown"), KNOWN_OUTPUTS)),
        }
    }
}

/// The encoding and depth that the extension of an output suggests: 8-bit unorm for PNG, KTX2 and DDS, 16-bit unorm for
/// TIFF, 32-bit float for EXR.
///
/// # Errors
/// [`Error::File`] lists the known extensions if this is none of them.
pub fn default_format(path: &Path) -> Result<(Encoding, Depth)> {
    Ok(match OutputFormat::of(path)? {
        OutputFormat::Png | OutputFormat::Texture(_) => (Encoding::Unorm, Depth::Bits8),
        OutputFormat::Tiff => (Encoding::Unorm, Depth::Bits16),
        OutputFormat::Exr => (Encoding::Float, Depth::Float32),
    })
}

/// The format of a parallax map that the extension of an output suggests: 8-bit biased for PNG, which has no signed
/// numbers, 8-bit snorm for TIFF, KTX2 and DDS, 32-bit float for EXR.
///
/// # Errors
/// [`Error::File`] lists the known extensions if this is none of them.
pub fn default_parallax_format(path: &Path) -> Result<ParallaxFormat> {
    let (encoding, depth) = match OutputFormat::of(path)? {
        OutputFormat::Png => (Encoding::Biased, Depth::Bits8),
        OutputFormat::Tiff | OutputFormat::Texture(_) => (Encoding::Snorm, Depth::Bits8),
        OutputFormat::Exr => (Encoding::Float, Depth::Float32),
    };
    Ok(ParallaxFormat { encoding, depth })
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}
