//! How maps are written.

use super::format::OutputFormat;
use super::{exr, png, tiff};
use crate::error::Result;
use crate::map::{NormalFormat, ParallaxFormat, Size, TexelFormat};
use crate::names::named;
use crate::stream::RowsOut;
use std::path::Path;

/// How a map becomes a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct WriteOptions {
    /// What a PNG's size is worth; the texels are the same.
    pub compression: Compression,
}

/// The trade of time for bytes in a file that is compressed without loss.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Compression {
    /// As fast as the disk.
    #[default]
    Fast,
    /// Smaller, at some cost.
    Balanced,
    /// As small as it gets, at any cost.
    Small,
}

named! {
    Compression "compression" { Fast = "fast", Balanced = "balanced", Small = "small" }
}

/// Creates a normal map file as [`create_normals_with`] does, with the default [`WriteOptions`].
///
/// # Errors
/// As [`create_normals_with`].
pub fn create_normals(path: &Path, size: Size, format: NormalFormat) -> Result<RowsOut> {
    create_normals_with(path, size, format, &WriteOptions::default())
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
pub fn create_normals_with(path: &Path, size: Size, format: NormalFormat, options: &WriteOptions) -> Result<RowsOut> {
    create_codes(path, size, format.texel(), options)
}

/// Creates a parallax map file as [`create_parallax_with`] does, with the default [`WriteOptions`].
///
/// # Errors
/// As [`create_normals_with`].
pub fn create_parallax(path: &Path, size: Size, format: ParallaxFormat) -> Result<RowsOut> {
    create_parallax_with(path, size, format, &WriteOptions::default())
}

/// Creates a parallax map file; nothing stands under `path` until its rows are complete.
///
/// The extension picks the format:
///
/// | extension | encoding and depth | as |
/// | --- | --- | --- |
/// | `png` | biased, unorm: 8, 16 | grey |
/// | `tif`, `tiff` | snorm, biased, unorm: 8, 16; float: 32f | one sample |
/// | `exr` | float: 16f, 32f | the channel Y |
///
/// # Errors
/// As [`create_normals_with`].
pub fn create_parallax_with(
    path: &Path,
    size: Size,
    format: ParallaxFormat,
    options: &WriteOptions,
) -> Result<RowsOut> {
    create_codes(path, size, format.texel(), options)
}

/// Fails if a normal map file called `path` cannot hold `format`; nothing is looked up or created.
///
/// # Errors
/// [`crate::Error::Parameter`], or [`crate::Error::File`] for an unknown extension, as [`create_normals_with`].
pub fn check_normal_format(path: &Path, format: NormalFormat) -> Result<()> {
    check_codes(path, format.texel()).map(drop)
}

/// Fails if a parallax map file called `path` cannot hold `format`; nothing is looked up or created.
///
/// # Errors
/// As [`check_normal_format`].
pub fn check_parallax_format(path: &Path, format: ParallaxFormat) -> Result<()> {
    check_codes(path, format.texel()).map(drop)
}

/// The format of the file `path`, which can hold `format`.
fn check_codes(path: &Path, format: TexelFormat) -> Result<OutputFormat> {
    format.check()?;
    let output = OutputFormat::of(path)?;
    match output {
        OutputFormat::Png => png::check(path, format)?,
        OutputFormat::Tiff => tiff::check(path, format)?,
        OutputFormat::Exr => exr::check(path, format)?,
    }
    Ok(output)
}

fn create_codes(path: &Path, size: Size, format: TexelFormat, options: &WriteOptions) -> Result<RowsOut> {
    match check_codes(path, format)? {
        OutputFormat::Png => png::create(path, size, format, options.compression),
        OutputFormat::Tiff => tiff::create(path, size, format),
        OutputFormat::Exr => exr::create(path, size, format),
    }
}
