//! Normal maps with their format attached.

use super::{Codes, CodesRef, NormalFormat, Size};

/// A tangent-space normal map and what its codes mean.
///
/// Codes stand texel by texel, in rows from the top: x, y, z or x, y, as [`NormalFormat::channels`] says.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMap {
    size: Size,
    format: NormalFormat,
    codes: Codes,
}

impl NormalMap {
    /// Room for a map, for a backend to fill.
    pub(crate) fn zeroed(size: Size, format: NormalFormat) -> Self {
        let codes = Codes::zeroed(format.depth, size.texels() * format.channels.count());
        Self { size, format, codes }
    }

    /// Width and height in texels.
    pub fn size(&self) -> Size {
        self.size
    }

    /// What the codes mean.
    pub fn format(&self) -> NormalFormat {
        self.format
    }

    /// The codes, row by row.
    pub fn codes(&self) -> CodesRef<'_> {
        self.codes.as_ref()
    }

    /// The codes, to fill.
    pub(crate) fn codes_mut(&mut self) -> super::CodesMut<'_> {
        self.codes.as_mut()
    }
}
