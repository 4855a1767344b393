//! Height maps, normal maps and parallax maps in, normal maps and parallax maps out; models in and out ([`Model`]).
//!
//! A file's rows pass three steps, one module each: a decoder gives interleaved samples (`samples`), `channel`
//! picks the height of each texel or `normal` its components, and `srgb` undoes a wrong colour space of heights and
//! `shrink` reduces them where that was asked for. Decoders hold a row, a strip or a block at a time where the format
//! allows it.
//!
//! Nothing is lost: writers go through `replace`, so that a name stands for the old file or for the complete new one at
//! any moment, whatever ends the process; after a loss of power too, since bytes are on the disk before they get a name.
//! What a killed process leaves, `temporary` removes. Models of several files are replaced in an order of which every
//! state is a whole model (`gltf::write`). Readers go through `input`: a file that changes before its last row is read is
//! an error, and so are pipes and devices, which are not waited for. Not covered: that several maps of a texture, or a map
//! and its sidecar, get their names in the same instant; the order of names after a loss of power, where the file system
//! does not keep it; and folders that several machines write into at once over a network without common locks.

mod channel;
#[cfg(feature = "cli")]
mod crop;
mod damage;
mod exr;
pub(crate) mod file_state;
mod format;
mod gltf;
mod groups;
#[cfg(feature = "cli")]
mod halo;
#[cfg(feature = "cli")]
mod halo_rows;
mod in_order;
mod input;
mod limits;
mod normal;
mod obj;
mod parallax;
mod png;
mod raster;
mod raw;
pub(crate) mod replace;
mod samples;
#[cfg(feature = "cli")]
mod seam;
mod shrink;
mod sink;
mod srgb;
mod sync_ahead;
mod temporary;
mod texture;
mod tiff;
#[cfg(feature = "cli")]
mod tile_files;
#[cfg(feature = "cli")]
mod wide_rows;
mod write;

pub use channel::Channel;
#[cfg(feature = "cli")]
pub(crate) use crop::Cropped;
pub use format::{INPUT_EXTENSIONS, default_format, default_parallax_format};
pub use gltf::{LeftOut, Model, ModelFile, ModelFiles, ModelReadOptions, ModelReport, Placement, Primitive};
#[cfg(feature = "cli")]
pub(crate) use halo::{Halo, Reach, TileRow};
#[cfg(feature = "cli")]
pub(crate) use halo_rows::{HaloRows, SeamWarnings};
pub use parallax::ParallaxReadOptions;
pub use raw::{RawKind, RawLayout};
#[cfg(feature = "cli")]
pub(crate) use sink::Witness;
pub use texture::BlockCompression;
#[cfg(feature = "cli")]
pub(crate) use write::create_codes;
pub use write::{
    Compression, WriteOptions, check_normal_format, check_normals_with, check_parallax_format, check_parallax_with,
    check_roughness, create_normals, create_normals_with, create_parallax, create_parallax_with, create_roughness_with,
    is_compressed,
};

use crate::error::Result;
use crate::map::{Channels, Convention, Encoding, HeightMap, NormalMap, ParallaxMap};
use crate::stream::{NormalSource, RowSource, read_map, read_normals};
use channel::HeightRows;
use format::FileFormat;
use input::Watch;
use normal::NormalRows;
use samples::Opened;
use shrink::Shrunk;
use std::num::NonZeroU32;
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
    /// By which factor the map is reduced while it is read, from 1 to 64, a divisor of both its sides: each height is the
    /// mean of a square of the file's. The means of 8- and 16-bit codes are 16-bit codes, rounded half up; those of
    /// floats are summed in f64, row by row from the left, and rounded once.
    pub shrink: NonZeroU32,
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

/// How a file becomes a normal map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NormalReadOptions {
    /// What the codes mean; `None`: unorm for unsigned integers, snorm for signed ones, float for floats.
    pub encoding: Option<Encoding>,
    /// Which components there are; `None`: all three if the file has three channels. xy takes the first two.
    pub channels: Option<Channels>,
    /// Which way green points.
    pub convention: Convention,
    /// The most bytes that decoding one file may hold in memory at once, checked from its header and its length.
    pub max_bytes: u64,
}

/// An open normal map file, and what the user should know about it.
pub struct NormalFile {
    /// The rows.
    pub rows: Box<dyn NormalSource>,
    /// What looks wrong in the file, in words; [`NormalFile::srgb`] is apart.
    pub warnings: Vec<String>,
    /// The same if the file says that its codes are sRGB colours, which normals never are.
    pub srgb: Option<String>,
}

impl NormalFile {
    /// All that looks wrong in the file.
    pub fn all_warnings(&self) -> Vec<String> {
        self.srgb.iter().chain(&self.warnings).cloned().collect()
    }
}

/// The most bytes that decoding one file may hold, unless something else is asked for.
const MAX_BYTES: u64 = 4 << 30;

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            channel: None,
            color_space: ColorSpace::Linear,
            raw: None,
            shrink: NonZeroU32::MIN,
            max_bytes: MAX_BYTES,
        }
    }
}

impl Default for NormalReadOptions {
    fn default() -> Self {
        Self { encoding: None, channels: None, convention: Convention::Gl, max_bytes: MAX_BYTES }
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
/// allocated; [`crate::Error::File`] for what is wrong with the file or with its channels; [`crate::Error::Parameter`]
/// for a [`ReadOptions::shrink`] that does not fit the map; [`crate::Error::Io`]. Damage further down, channels that differ, [`crate::Error::NotFinite`] heights and a file that changed since are
/// reported by the row reader.
pub fn open_heights(path: &Path, options: &ReadOptions) -> Result<HeightFile> {
    let watch = Watch::at(path)?;
    let opened = match options.raw {
        Some(layout) => raw::open(path, layout),
        None => open_samples(path, exr::Wanted::Heights(options.channel.as_ref()), options.max_bytes),
    };
    let opened = watch.over(opened)?;
    let (rows, warnings) = HeightRows::new(path, opened, options)?;
    let rows: Box<dyn RowSource> = match options.shrink {
        NonZeroU32::MIN => Box::new(rows),
        by => Box::new(Shrunk::new(rows, by)?),
    };
    Ok(HeightFile { rows, warnings })
}

/// Opens a normal map file: PNG, TIFF, EXR, TGA, BMP, JPEG or WebP, found out and read as [`open_heights`] does.
///
/// Codes keep the file's depth: 8 or 16 bits, or 32-bit floats, which half floats become exactly and double floats
/// rounded. What they mean is in few files, so [`NormalReadOptions`] say it; without a word:
///
/// | the file holds | encoding | may be read as |
/// | --- | --- | --- |
/// | unsigned integers: PNG, TGA, BMP, JPEG, WebP, most TIFF | unorm | unorm, biased |
/// | signed integers: TIFF | snorm | snorm |
/// | floats: TIFF, EXR | float | float, unorm |
///
/// Floats v that are read as unorm lie between 0 and 1, as Blender's normals do, and mean the components 2v - 1,
/// computed in f32; the rows are components, and the format says float.
///
/// | channels | components | may be read as |
/// | --- | --- | --- |
/// | three or more, alpha aside | x, y, z: the first three | xyz, xy |
/// | two | x, y | xy |
/// | one and alpha | refused | xy |
/// | one | refused: a height map? | |
///
/// An EXR says by the names of its channels which they are: X, Y, Z or else R, G, B, in any case, or the first two of
/// them, in its first layer that has them; below a common prefix (`normal.X`) if it is the only one.
///
/// Floats are given as they are, NaN too: [`crate::Baker::blend`] refuses what is no direction.
///
/// # Errors
/// [`crate::Error::Parameter`] if the file's samples cannot have the encoding; [`crate::Error::File`] if its channels
/// are none of a normal map's; else as [`open_heights`].
pub fn open_normals(path: &Path, options: &NormalReadOptions) -> Result<NormalFile> {
    let watch = Watch::at(path)?;
    let opened = watch.over(open_samples(path, exr::Wanted::Normals(options.channels), options.max_bytes))?;
    let srgb = opened.says_srgb.then(|| normal::SRGB_WARNING.into());
    let (rows, warnings) = NormalRows::new(path, opened, options)?;
    Ok(NormalFile { rows: Box::new(rows), warnings, srgb })
}

/// Opens a file that says what it is.
fn open_samples(path: &Path, wanted: exr::Wanted<'_>, max_bytes: u64) -> Result<Opened> {
    match FileFormat::of_file(path)? {
        FileFormat::Png => png::open(path, max_bytes),
        FileFormat::Tiff => tiff::open(path, max_bytes),
        FileFormat::Exr => exr::open(path, wanted, max_bytes),
        FileFormat::Raster(format) => raster::open(path, format, max_bytes),
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
        limits::check_map(path, rows.size(), rows.height_type().bytes(), options.max_bytes)?;
        Ok((read_map(rows.as_mut())?, warnings))
    }
}

impl NormalMap {
    /// Reads a normal map file with the default [`NormalReadOptions`]; warnings are dropped.
    ///
    /// # Errors
    /// As [`NormalMap::read_with`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::read_with(path, &NormalReadOptions::default()).map(|(map, _)| map)
    }

    /// Reads a normal map file, and says in words what looks wrong in it.
    ///
    /// # Errors
    /// As [`open_normals`], and what its rows report; [`crate::Error::TooLarge`] if the whole map is larger than
    /// [`NormalReadOptions::max_bytes`].
    pub fn read_with(path: impl AsRef<Path>, options: &NormalReadOptions) -> Result<(Self, Vec<String>)> {
        let path = path.as_ref();
        let file = open_normals(path, options)?;
        let (warnings, mut rows) = (file.all_warnings(), file.rows);
        limits::check_map(path, rows.size(), rows.format().texel().bytes(), options.max_bytes)?;
        Ok((read_normals(rows.as_mut())?, warnings))
    }

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

impl ParallaxMap {
    /// Writes a parallax map file in the map's own format; the extension must be able to hold it.
    ///
    /// # Errors
    /// As [`create_parallax`], and what writing meets.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let mut sink = create_parallax(path.as_ref(), self.size(), self.format())?;
        sink.write(0, self.codes())?;
        sink.finish()
    }
}

crate::names::named! {
    ColorSpace "color-space" { Linear = "linear", Srgb = "srgb" }
}
