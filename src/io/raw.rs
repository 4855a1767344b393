//! Headerless files: rows of heights and nothing else.

use super::damage::io_reason;
use super::input;
use super::samples::{Layout, Opened, SampleRows, bytes_mut};
use crate::error::{Error, Result};
use crate::map::{HeightType, HeightsMut, Size};
use std::fmt;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A file without a header: width, height and type, `1025x1025:u16le`.
///
/// The types are `u8`, `u16le`, `u16be`, `f32le` and `f32be`. Rows stand from the top, without gaps.
///
/// ```
/// use texbake::io::{RawKind, RawLayout};
///
/// let layout: RawLayout = "1025x513:u16le".parse()?;
/// assert_eq!((layout.size.width(), layout.size.height(), layout.kind), (1025, 513, RawKind::U16Le));
/// assert_eq!(layout.to_string(), "1025x513:u16le");
/// # Ok::<(), texbake::Error>(())
/// ```
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

/// Every type with its name.
const KINDS: [(RawKind, &str); 5] = [
    (RawKind::U8, "u8"),
    (RawKind::U16Le, "u16le"),
    (RawKind::U16Be, "u16be"),
    (RawKind::F32Le, "f32le"),
    (RawKind::F32Be, "f32be"),
];

impl RawKind {
    fn depth(self) -> HeightType {
        match self {
            Self::U8 => HeightType::U8,
            Self::U16Le | Self::U16Be => HeightType::U16,
            Self::F32Le | Self::F32Be => HeightType::F32,
        }
    }
}

impl fmt::Display for RawKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        KINDS.iter().filter(|(kind, _)| kind == self).try_for_each(|(_, name)| f.write_str(name))
    }
}

impl fmt::Display for RawLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}:{}", self.size.width(), self.size.height(), self.kind)
    }
}

impl FromStr for RawLayout {
    type Err = Error;

    /// # Errors
    /// [`Error::Parameter`] if `text` is not a width, a height and a type, or they are no size of a map.
    fn from_str(text: &str) -> Result<Self> {
        let parts = || {
            let (size, kind) = text.split_once(':')?;
            let (kind, _) = *KINDS.iter().find(|(_, name)| *name == kind)?;
            let (width, height) = size.split_once('x')?;
            let is_number = |side: &str| !side.is_empty() && side.bytes().all(|byte| byte.is_ascii_digit());
            (is_number(width) && is_number(height)).then_some((width, height, kind))
        };
        let range = "WIDTHxHEIGHT:TYPE with a type of u8, u16le, u16be, f32le, f32be, such as 1025x1025:u16le";
        let (width, height, kind) = parts().ok_or_else(|| Error::parameter("raw", text, range))?;
        // A number that no integer holds is too large as well.
        let [width, height] = [width, height].map(|side| side.parse().unwrap_or(usize::MAX));
        let range = "at least 1x1 and at most 2147483647 texels on each side";
        let size = Size::new(width, height).map_err(|_| Error::parameter("raw", text, range))?;
        Ok(Self { size, kind })
    }
}

/// Heights that stand in a file as they are.
struct RawRows {
    path: PathBuf,
    file: File,
    layout: RawLayout,
}

/// Opens a headerless file, whose length must be what `layout` says.
pub(super) fn open(path: &Path, layout: RawLayout) -> Result<Opened> {
    let file = input::open(path)?;
    let found = file.metadata().map_err(Error::io(path))?.len();
    let expected = layout.size.texels() as u128 * layout.kind.depth().bytes() as u128;
    if u128::from(found) != expected {
        let reason = format!("it holds {found} bytes, and {layout} is {expected} bytes");
        return Err(Error::file(path, reason, "give the file's real size and type with --raw"));
    }
    Ok(Opened::new(RawRows { path: path.into(), file, layout }))
}

impl SampleRows for RawRows {
    fn layout(&self) -> Layout {
        Layout { size: self.layout.size, depth: self.layout.kind.depth(), colours: 1, alpha: false }
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        self.file.read_exact(bytes_mut(&mut rows)).map_err(|error| io_reason(&self.path, error))?;
        match (self.layout.kind, rows) {
            (RawKind::U16Le, HeightsMut::U16(heights)) => heights.iter_mut().for_each(|h| *h = u16::from_le(*h)),
            (RawKind::U16Be, HeightsMut::U16(heights)) => heights.iter_mut().for_each(|h| *h = u16::from_be(*h)),
            (RawKind::F32Le, HeightsMut::F32(heights)) => {
                heights.iter_mut().for_each(|h| *h = f32::from_bits(u32::from_le(h.to_bits())));
            }
            (RawKind::F32Be, HeightsMut::F32(heights)) => {
                heights.iter_mut().for_each(|h| *h = f32::from_bits(u32::from_be(h.to_bits())));
            }
            _ => (),
        }
        Ok(())
    }

    fn seek(&mut self, row: usize) -> Result<()> {
        let offset = (row * self.layout().row_bytes()) as u64;
        self.file.seek(SeekFrom::Start(offset)).map_err(Error::io(&self.path))?;
        Ok(())
    }

    fn last_row_is_near(&self) -> bool {
        true
    }

    /// Rows go from the file to their place.
    fn held_bytes(&self) -> u64 {
        0
    }
}
