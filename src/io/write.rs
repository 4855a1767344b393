//! How maps are written.

use super::format::OutputFormat;
use super::sink::Witness;
use super::texture::BlockCompression;
use super::{exr, png, texture, tiff};
use crate::error::{Error, Result};
use crate::map::{NormalFormat, ParallaxFormat, RoughnessFormat, Size, TexelFormat};
use crate::names::named;
use crate::stream::{MapOut, RowsOut};
use std::path::Path;

/// How a map becomes a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct WriteOptions {
    /// What a PNG's size is worth; the texels are the same.
    pub compression: Compression,
    /// Whether the file has all mip levels down to a single texel: KTX2 and DDS, whose smaller levels
    /// [`MapOut::levels`] takes.
    pub mips: bool,
    /// The blocks of a KTX2 or DDS file; `None`: texel by texel.
    pub blocks: Option<BlockCompression>,
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
    Ok(create_normals_with(path, size, format, &WriteOptions::default())?.rows)
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
/// | `ktx2`, `dds` | unorm, snorm: 8, 16; float: 16f, 32f | R and G |
/// | the same in BC5 blocks | unorm, snorm: 8 | R and G, of xyz too |
/// | the same in BC7 blocks | unorm: 8 | |
///
/// KTX2 and DDS are linear, and stand from the upper left; xyz is RGBA there, with an alpha of one.
///
/// # Errors
/// [`crate::Error::Parameter`] if the format cannot hold `format`, or not as `options` say; [`crate::Error::File`] for
/// an unknown extension, a name that cannot be replaced, or a DDS above 4 GiB; [`crate::Error::Io`].
pub fn create_normals_with(path: &Path, size: Size, format: NormalFormat, options: &WriteOptions) -> Result<MapOut> {
    create_codes(path, size, format.texel(), options, None)
}

/// Creates a parallax map file as [`create_parallax_with`] does, with the default [`WriteOptions`].
///
/// # Errors
/// As [`create_normals_with`].
pub fn create_parallax(path: &Path, size: Size, format: ParallaxFormat) -> Result<RowsOut> {
    Ok(create_parallax_with(path, size, format, &WriteOptions::default())?.rows)
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
/// | `ktx2`, `dds` | snorm, unorm: 8, 16; float: 16f, 32f | R |
/// | the same in blocks | snorm, unorm: 8 | BC4 |
///
/// # Errors
/// As [`create_normals_with`].
pub fn create_parallax_with(path: &Path, size: Size, format: ParallaxFormat, options: &WriteOptions) -> Result<MapOut> {
    create_codes(path, size, format.texel(), options, None)
}

/// Creates a roughness map file: one unorm component, as [`create_parallax_with`] has it, of one level or of all.
///
/// # Errors
/// As [`create_normals_with`].
pub fn create_roughness_with(
    path: &Path,
    size: Size,
    format: RoughnessFormat,
    options: &WriteOptions,
) -> Result<MapOut> {
    create_codes(path, size, format.texel(), options, None)
}

/// Fails if a file called `path` cannot hold a roughness map of mip levels; nothing is looked up or created.
///
/// # Errors
/// As [`check_normals_with`], and [`crate::Error::Parameter`] without levels, for which there is no roughness to tell.
pub fn check_roughness(path: &Path, format: RoughnessFormat, options: &WriteOptions) -> Result<()> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    if !matches!(OutputFormat::of(path)?, OutputFormat::Texture(_)) {
        let range = "a .ktx2 or .dds file, with mips: roughness is what mip levels lose";
        return Err(Error::parameter("roughness", name, range));
    }
    let held = check_codes(path, format.texel(), &WriteOptions { mips: true, ..*options });
    held.map_err(|error| match error {
        Error::Parameter { parameter: "bits", value, range } => {
            Error::Parameter { parameter: "roughness-bits", value, range }
        }
        other => other,
    })?;
    if options.mips {
        return Ok(());
    }
    Err(Error::parameter("mips", format_args!("off, for {name}"), "on: roughness is what mip levels lose"))
}

/// Fails if a normal map file called `path` cannot hold `format` with the default [`WriteOptions`]; nothing is looked
/// up or created.
///
/// # Errors
/// As [`check_normals_with`].
pub fn check_normal_format(path: &Path, format: NormalFormat) -> Result<()> {
    check_normals_with(path, format, &WriteOptions::default())
}

/// Fails if a normal map file called `path` cannot hold `format` as `options` say; nothing is looked up or created.
///
/// # Errors
/// [`crate::Error::Parameter`], or [`crate::Error::File`] for an unknown extension, as [`create_normals_with`].
pub fn check_normals_with(path: &Path, format: NormalFormat, options: &WriteOptions) -> Result<()> {
    check_codes(path, format.texel(), options).map(drop)
}

/// Fails if a parallax map file called `path` cannot hold `format` with the default [`WriteOptions`]; nothing is looked
/// up or created.
///
/// # Errors
/// As [`check_normals_with`].
pub fn check_parallax_format(path: &Path, format: ParallaxFormat) -> Result<()> {
    check_parallax_with(path, format, &WriteOptions::default())
}

/// Fails if a parallax map file called `path` cannot hold `format` as `options` say; nothing is looked up or created.
///
/// # Errors
/// As [`check_normals_with`].
pub fn check_parallax_with(path: &Path, format: ParallaxFormat, options: &WriteOptions) -> Result<()> {
    check_codes(path, format.texel(), options).map(drop)
}

/// Whether [`WriteOptions::compression`] decides over the bytes of a file called `path`.
pub fn is_compressed(path: &Path) -> bool {
    matches!(OutputFormat::of(path), Ok(OutputFormat::Png))
}

/// The format of the file `path`, which can hold `format`.
fn check_codes(path: &Path, format: TexelFormat, options: &WriteOptions) -> Result<OutputFormat> {
    format.check()?;
    let output = OutputFormat::of(path)?;
    match output {
        OutputFormat::Texture(_) => return texture::check(path, format, options.blocks).map(|()| output),
        OutputFormat::Png => png::check(path, format)?,
        OutputFormat::Tiff => tiff::check(path, format)?,
        OutputFormat::Exr => exr::check(path, format)?,
    }
    check_plain(path, options).map(|()| output)
}

/// Fails if `options` ask for what only GPU textures have.
fn check_plain(path: &Path, options: &WriteOptions) -> Result<()> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    if let Some(blocks) = options.blocks {
        let range = "for .ktx2 and .dds: other files have no blocks";
        return Err(Error::parameter("block-compression", format_args!("{blocks}, for {name}"), range));
    }
    if options.mips {
        let range = "for .ktx2 and .dds: other files have one level";
        return Err(Error::parameter("mips", format_args!("on, for {name}"), range));
    }
    Ok(())
}

/// Creates a file of codes; `witness` reads it before it has its name.
pub(crate) fn create_codes(
    path: &Path,
    size: Size,
    format: TexelFormat,
    options: &WriteOptions,
    witness: Option<Witness>,
) -> Result<MapOut> {
    let (mut rows, levels) = match check_codes(path, format, options)? {
        OutputFormat::Png => (png::create(path, size, format, options.compression)?, None),
        OutputFormat::Tiff => (tiff::create(path, size, format)?, None),
        OutputFormat::Exr => (exr::create(path, size, format)?, None),
        OutputFormat::Texture(container) => texture::create(path, container, size, format, options)?,
    };
    rows.witness = witness;
    Ok(MapOut { rows, levels })
}
