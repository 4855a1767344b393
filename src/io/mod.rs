//! Height maps in, normal maps out.

use crate::error::Result;
use crate::map::{HeightMap, NormalFormat, NormalMap, Size};
use crate::stream::{RowSink, RowSource};
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
    /// The most bytes that decoding one file may hold in memory at once, checked from its header.
    pub max_bytes: u64,
}

/// A channel of a colour file.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha.
    A,
    /// Rec. 709 luma of the codes.
    Luma,
    /// An EXR channel by its name.
    Named(String),
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

/// A file without a header: width, height and type, `1025x1025:u16le`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RawLayout {
    /// Width and height.
    pub size: Size,
    /// Type of a height.
    pub kind: RawKind,
}

/// Type and byte order of headerless heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RawKind {
    /// Bytes.
    U8,
    /// 16 bits, least significant byte first.
    U16Le,
    /// 16 bits, most significant byte first.
    U16Be,
    /// Floats, least significant byte first.
    F32Le,
    /// Floats, most significant byte first.
    F32Be,
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

/// Opens a height map file.
pub fn open_heights(_path: &Path, _options: &ReadOptions) -> Result<HeightFile> {
    todo!()
}

/// Creates a normal map file; nothing stands under `path` until its rows are complete.
pub fn create_normals(_path: &Path, _size: Size, _format: NormalFormat) -> Result<Box<dyn RowSink>> {
    todo!()
}

impl HeightMap {
    /// Reads a height map file.
    pub fn read(_path: impl AsRef<Path>) -> Result<Self> {
        todo!()
    }
}

impl NormalMap {
    /// Writes a normal map file.
    pub fn write(&self, _path: impl AsRef<Path>) -> Result<()> {
        todo!()
    }
}
