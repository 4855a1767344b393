//! Height maps: one channel of integer codes or floats.

use super::{Codes, Grid, Size};
use crate::error::{Error, Result};
use std::fmt;

/// How a height map stores a height.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HeightType {
    /// A code H of 8 bits: h = H / 255.
    U8,
    /// A code H of 16 bits: h = H / 65535.
    U16,
    /// The height itself.
    F32,
}

impl HeightType {
    /// Bytes of one height.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::F32 => 4,
        }
    }

    /// The code that means h = 1, M = 2^B - 1; floats have none.
    pub fn greatest_code(self) -> Option<u32> {
        match self {
            Self::U8 => Some(255),
            Self::U16 => Some(65535),
            Self::F32 => None,
        }
    }
}

impl fmt::Display for HeightType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::U8 => "u8",
            Self::U16 => "u16",
            Self::F32 => "f32",
        })
    }
}

/// Heights in rows, borrowed.
#[derive(Debug, Clone, Copy)]
pub enum Heights<'a> {
    /// 8-bit codes.
    U8(&'a [u8]),
    /// 16-bit codes.
    U16(&'a [u16]),
    /// Floats.
    F32(&'a [f32]),
}

/// Room for heights in rows.
#[derive(Debug)]
pub enum HeightsMut<'a> {
    /// 8-bit codes.
    U8(&'a mut [u8]),
    /// 16-bit codes.
    U16(&'a mut [u16]),
    /// Floats.
    F32(&'a mut [f32]),
}

/// A height map: one height per texel, in rows from the top.
///
/// A code H of B bits means the height h = H / (2^B - 1) in [0, 1]; a float is the height itself.
///
/// ```
/// use texbake::{Grid, HeightMap};
///
/// let ramp = HeightMap::from(Grid::from_fn(256, 4, |x, _| x as u8)?);
/// assert_eq!(ramp.size().width(), 256);
///
/// let hole = Grid::new(2, 1, vec![0.5, f32::NAN])?;
/// let error = HeightMap::try_from(hole).unwrap_err();
/// assert!(error.to_string().contains("column 1, row 0 is NaN"));
/// # Ok::<(), texbake::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap(Texels);

#[derive(Debug, Clone, PartialEq)]
enum Texels {
    U8(Grid<u8>),
    U16(Grid<u16>),
    F32(Grid<f32>),
}

impl HeightMap {
    /// Width and height in texels.
    pub fn size(&self) -> Size {
        match &self.0 {
            Texels::U8(grid) => grid.size(),
            Texels::U16(grid) => grid.size(),
            Texels::F32(grid) => grid.size(),
        }
    }

    /// How a height is stored.
    pub fn height_type(&self) -> HeightType {
        self.heights().height_type()
    }

    /// All heights, row by row.
    pub fn heights(&self) -> Heights<'_> {
        match &self.0 {
            Texels::U8(grid) => Heights::U8(grid.texels()),
            Texels::U16(grid) => Heights::U16(grid.texels()),
            Texels::F32(grid) => Heights::F32(grid.texels()),
        }
    }

    /// The same as codes of any map.
    pub(crate) fn into_codes(self) -> Codes {
        match self.0 {
            Texels::U8(grid) => Codes::U8(grid.into_texels()),
            Texels::U16(grid) => Codes::U16(grid.into_texels()),
            Texels::F32(grid) => Codes::F32(grid.into_texels()),
        }
    }
}

impl From<Grid<u8>> for HeightMap {
    fn from(grid: Grid<u8>) -> Self {
        Self(Texels::U8(grid))
    }
}

impl From<Grid<u16>> for HeightMap {
    fn from(grid: Grid<u16>) -> Self {
        Self(Texels::U16(grid))
    }
}

impl TryFrom<Grid<f32>> for HeightMap {
    type Error = Error;

    /// # Errors
    /// [`Error::NotFinite`] names the first height, in reading order, that is NaN or infinite.
    fn try_from(grid: Grid<f32>) -> Result<Self> {
        Heights::F32(grid.texels()).check_finite(grid.size().width(), 0)?;
        Ok(Self(Texels::F32(grid)))
    }
}

impl Heights<'_> {
    /// How a height is stored.
    pub fn height_type(&self) -> HeightType {
        match self {
            Self::U8(_) => HeightType::U8,
            Self::U16(_) => HeightType::U16,
            Self::F32(_) => HeightType::F32,
        }
    }

    /// Fails on the first float that is NaN or infinite; the rows are `width` wide and begin with row `first_row`.
    pub(crate) fn check_finite(&self, width: usize, first_row: usize) -> Result<()> {
        let Self::F32(heights) = self else { return Ok(()) };
        match heights.iter().position(|height| !height.is_finite()) {
            None => Ok(()),
            Some(i) => Err(Error::NotFinite { x: i % width, y: first_row + i / width, value: heights[i] }),
        }
    }
}

impl HeightsMut<'_> {
    /// The same heights, to read.
    pub fn as_ref(&self) -> Heights<'_> {
        match self {
            Self::U8(heights) => Heights::U8(heights),
            Self::U16(heights) => Heights::U16(heights),
            Self::F32(heights) => Heights::F32(heights),
        }
    }
}
