//! Height maps in, normal maps out.
//!
//! A file's rows pass three steps, one module each: a decoder gives interleaved samples (`samples`), `channel`
//! picks the height of each texel, and `srgb` undoes a wrong colour space where that was asked for. Decoders hold a
//! row, a strip or a block at a time where the format allows it. Writers go through `replace`, so that a name never
//! stands for half a file.

mod channel;
mod damage;
mod exr;
mod format;
mod groups;
mod limits;
mod png;
mod raster;
mod raw;
pub(crate) mod replace;
mod samples;
mod sink;
mod srgb;
mod tiff;

pub use channel::Channel;
pub use format::{INPUT_EXTENSIONS, default_format};
pub use raw::{RawKind, RawLayout};

use crate::error::Result;
use crate::map::{HeightMap, NormalFormat, NormalMap, Size, TexelFormat};
use crate::stream::{RowSink, RowSource, read_map};
use channel::HeightRows;
use format::{FileFormat, OutputFormat};
use std::path::Path;

/// How a file becomes a height map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadOptions {
    /// Which channel of a colour file holds the heights; `None`: its channels must be equal.
    pub channel: Option<Channel>,
    /// What the codes mean.
    pub color_space: ColorSpace,
    /// The layout of a file without a header.
    pub raw: Option<RawLayout>,
    /// The most bytes that decoding one file may hold in memory at once, checked from its header and its length.
    pub max_bytes: u64,
}

/// What integer height codes mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ColorSpace {
    /// Heights, whatever the file says: data is never converted.
    #[default]
    Linear,
    /// Heights that were saved as sRGB colours by mistake: decoded to 16-bit linear codes.
    Srgb,
}

/// An open height map file, and what the user should know about it.
pub struct HeightFile {
    /// The rows.
    pub rows: Box<dyn RowSource>,
    /// What looks wrong in the file, in words.
    pub warnings: Vec<String>,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { channel: None, color_space: ColorSpace::Linear, raw: None, max_bytes: 4 << 30 }
    }
}

/// Opens a height map file: PNG, TIFF, EXR, TGA, BMP, JPEG, WebP, or headerless rows of [`ReadOptions::raw`].
///
/// The first bytes say which format it is, whatever its extension; TGA has no such bytes and goes by its extension.
/// Heights keep the file's depth: 1, 2 and 4 bits become the 8-bit codes of the same heights, signed 16-bit integers
/// become v + 32768 (the same slopes), and half and double floats become floats. The height 1 of 16-bit integers is
/// 65535 units, so an elevation in metres has the depth 65535 m ([`crate::Scale::physical`]); that of floats is 1 unit.
///
/// PNG, TIFF by strips or tiles, EXR and headerless files are read as the rows are asked for. Interlaced PNG and the
/// other formats are decoded whole.
///
/// # Errors
/// [`crate::Error::TooLarge`] if decoding needs more than [`ReadOptions::max_bytes`] at once, before anything is
/// allocated; [`crate::Error::File`] for what is wrong with the file or with its channels; [`crate::Error::Io`].
/// Damage further down, channels that differ and [`crate::Error::NotFinite`] heights are reported by the row reader.
pub fn open_heights(path: &Path, options: &ReadOptions) -> Result<HeightFile> {
    let opened = match options.raw {
        Some(layout) => raw::open(path, layout)?,
        None => match FileFormat::of_file(path)? {
            FileFormat::Png => png::open(path, options)?,
            FileFormat::Tiff => tiff::open(path, options)?,
            FileFormat::Exr => exr::open(path, options)?,
            FileFormat::Raster(format) => raster::open(path, format, options)?,
        },
    };
    let (rows, warnings) = HeightRows::new(path, opened, options)?;
    Ok(HeightFile { rows: Box::new(rows), warnings })
}

/// Creates a normal map file; nothing stands under `path` until its rows are complete.
///
/// The extension picks the format:
///
/// | extension | encoding and depth | xy |
/// | --- | --- | --- |
/// | `png` | unorm, biased: 8, 16 | RGB with blue 0 |
/// | `tif`, `tiff` | unorm, biased, snorm: 8, 16; float: 32f | two samples |
/// | `exr` | float: 16f, 32f | channels R and G |
///
/// # Errors
/// [`crate::Error::Parameter`] if the format cannot hold `format`; [`crate::Error::File`] for an unknown extension or
/// a name that cannot be replaced; [`crate::Error::Io`].
pub fn create_normals(path: &Path, size: Size, format: NormalFormat) -> Result<Box<dyn RowSink>> {
    create_codes(path, size, format.texel())
}

fn create_codes(path: &Path, size: Size, format: TexelFormat) -> Result<Box<dyn RowSink>> {
    format.check()?;
    match OutputFormat::of(path)? {
        OutputFormat::Png => png::create(path, size, format),
        OutputFormat::Tiff => tiff::create(path, size, format),
        OutputFormat::Exr => exr::create(path, size, format),
    }
}

impl HeightMap {
    /// Reads a height map file with the default [`ReadOptions`]; warnings are dropped.
    ///
    /// # Errors
    /// As [`HeightMap::read_with`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::read_with(path, &ReadOptions::default()).map(|(map, _)| map)
    }

    /// Reads a height map file, and says in words what looks wrong in it.
    ///
    /// # Errors
    /// As [`open_heights`], and what its rows report; [`crate::Error::TooLarge`] if the whole map is larger than
    /// [`ReadOptions::max_bytes`].
    pub fn read_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<(Self, Vec<String>)> {
        let path = path.as_ref();
        let HeightFile { mut rows, warnings } = open_heights(path, options)?;
        limits::check_map(path, rows.size(), rows.height_type(), options.max_bytes)?;
        Ok((read_map(rows.as_mut())?, warnings))
    }
}

impl NormalMap {
    /// Writes a normal map file in the map's own format; the extension must be able to hold it.
    ///
    /// # Errors
    /// As [`create_normals`], and what writing meets.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let mut sink = create_normals(path.as_ref(), self.size(), self.format())?;
        sink.write(0, self.codes())?;
        sink.finish()
    }
}

crate::names::named! {
    ColorSpace "color-space" { Linear = "linear", Srgb = "srgb" }
}
