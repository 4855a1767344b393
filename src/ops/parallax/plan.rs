//! The options resolved for a pair of maps.

use crate::error::Result;
use crate::map::{HeightType, NormalFormat, ParallaxFormat, Size};
use crate::ops::{LayerReading, Precision};

/// One bake from heights and normals, ready for a backend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ParallaxPlan {
    pub size: Size,
    pub height_type: HeightType,
    /// The format of the normal map.
    pub input: NormalFormat,
    /// How its texels are read.
    pub normals: LayerReading,
    pub format: ParallaxFormat,
    pub precision: Precision,
}

impl ParallaxPlan {
    /// Checks the formats.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if an encoding and a depth do not go together.
    pub fn new(
        size: Size,
        height_type: HeightType,
        input: NormalFormat,
        format: ParallaxFormat,
        precision: Precision,
    ) -> Result<Self> {
        input.texel().check()?;
        format.texel().check()?;
        let normals = LayerReading::new(input, input.convention);
        Ok(Self { size, height_type, input, normals, format, precision })
    }
}
