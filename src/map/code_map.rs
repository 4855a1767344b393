//! Normal and parallax maps: codes with their format attached.

use super::{Codes, CodesMut, CodesRef, MapFormat, NormalFormat, ParallaxFormat, RoughnessFormat, Size};
use crate::error::Result;

/// A tangent-space normal map.
///
/// Codes stand texel by texel, in rows from the top: x, y, z or x, y, as [`NormalFormat::channels`] says.
pub type NormalMap = CodeMap<NormalFormat>;

/// A parallax map: n_z (2h - 1) for each texel, in rows from the top (FGED2 section 7.7).
///
/// A shader multiplies it by half the scale of the normal map.
pub type ParallaxMap = CodeMap<ParallaxFormat>;

/// A roughness map: the roughness of each texel from 0 to 1, in rows from the top; its square is GGX's and Beckmann's alpha.
pub type RoughnessMap = CodeMap<RoughnessFormat>;

/// A map of codes, and what they mean: [`NormalMap`], [`ParallaxMap`] or [`RoughnessMap`].
#[derive(Debug, Clone, PartialEq)]
pub struct CodeMap<F> {
    size: Size,
    format: F,
    codes: Codes,
}

impl<F: MapFormat> CodeMap<F> {
    /// A map of these codes, given texel by texel, row by row.
    ///
    /// ```
    /// use texbake::{Codes, NormalFormat, NormalMap, Size};
    ///
    /// let flat = NormalMap::new(Size::new(2, 1)?, NormalFormat::default(), Codes::U8(vec![128, 128, 255, 128, 128, 255]))?;
    /// # assert_eq!(flat.size().texels(), 2);
    /// # Ok::<(), texbake::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if the format's encoding and depth do not go together, or `codes` is not of its
    /// depth and `size`.
    pub fn new(size: Size, format: F, codes: Codes) -> Result<Self> {
        let texel = format.stored();
        texel.check()?;
        texel.check_codes(size, codes.as_ref().len(), codes.as_ref().depth())?;
        Ok(Self { size, format, codes })
    }

    /// Room for a map, for a backend to fill.
    pub(crate) fn zeroed(size: Size, format: F) -> Self {
        let texel = format.stored();
        let codes = Codes::zeroed(texel.depth, size.texels() * texel.channels);
        Self { size, format, codes }
    }

    /// Width and height in texels.
    pub fn size(&self) -> Size {
        self.size
    }

    /// How a texel is stored.
    pub(crate) fn texel_format(&self) -> crate::map::TexelFormat {
        self.format.stored()
    }

    /// What the codes mean.
    pub fn format(&self) -> F {
        self.format
    }

    /// The codes, row by row.
    pub fn codes(&self) -> CodesRef<'_> {
        self.codes.as_ref()
    }

    /// The codes, to fill.
    pub(crate) fn into_codes(self) -> Codes {
        self.codes
    }

    pub(crate) fn codes_mut(&mut self) -> CodesMut<'_> {
        self.codes.as_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Channels, Depth, Encoding};

    #[test]
    fn codes_must_be_what_the_format_says() {
        let xy = NormalFormat { encoding: Encoding::Snorm, channels: Channels::Xy, ..NormalFormat::default() };
        let map = |format, codes| NormalMap::new(Size::new(2, 1).unwrap(), format, codes);
        let made = map(xy, Codes::U8(vec![0, 127, 129, 0])).unwrap();
        assert_eq!((made.format(), made.codes()), (xy, CodesRef::U8(&[0, 127, 129, 0])));
        let refused = |format, codes| map(format, codes).unwrap_err().to_string();
        let short = refused(xy, Codes::U8(vec![0; 3]));
        assert_eq!(short, "codes is 3 codes of 8 bits: it must be 4 codes of 8 bits");
        let deep = refused(xy, Codes::U16(vec![0; 4]));
        assert_eq!(deep, "codes is 4 codes of 16 bits: it must be 4 codes of 8 bits");
        let mixed = NormalFormat { depth: Depth::Float32, ..xy };
        let mixed = refused(mixed, Codes::F32(vec![0.0; 4]));
        assert_eq!(mixed, "bits is 32f: it must be 8 or 16 for the encodings unorm, snorm and biased");
        let parallax = ParallaxMap::new(Size::new(2, 1).unwrap(), ParallaxFormat::default(), Codes::U8(vec![0, 127]));
        assert_eq!(parallax.unwrap().codes(), CodesRef::U8(&[0, 127]));
    }
}
