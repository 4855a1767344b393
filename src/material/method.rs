//! The ways in which relief moves texture coordinates.

use std::fmt;
use std::num::NonZeroU32;

/// How a pixel finds the texture coordinates that its eye sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParallaxMethod {
    /// It does not: the normal map alone.
    None,
    /// [`crate::shading::welsh_offset`].
    Welsh,
    /// [`crate::shading::limited_offset`]: Welsh with offset limiting.
    Limited,
    /// [`crate::shading::plane_offset`], FGED2 eq. 7.50.
    Plane {
        /// The longest offset, in heights.
        limit: f32,
    },
    /// [`crate::shading::stepped_offset`], FGED2 listing 7.9; one step is eq. 7.51.
    Steps {
        /// Steps k.
        k: NonZeroU32,
    },
    /// [`crate::shading::relief_offset`].
    Relief {
        /// Equal steps down the ray.
        steps: u32,
        /// Halvings of the last one.
        bisections: u32,
    },
}

impl ParallaxMethod {
    /// The steps of FGED2 listing 7.9 with `k` above zero; 0 counts as 1.
    pub fn steps(k: u32) -> Self {
        Self::Steps { k: NonZeroU32::new(k).unwrap_or(NonZeroU32::MIN) }
    }

    /// Lookups of a map for each pixel, at most, without those of the colours and normals that are shown.
    pub fn fetches(&self) -> u32 {
        match *self {
            Self::None => 0,
            Self::Welsh | Self::Limited => 1,
            Self::Plane { .. } => 2,
            Self::Steps { k } => k.get(),
            Self::Relief { steps, bisections } => steps.saturating_add(bisections),
        }
    }

    /// As `kernels/shared/parallax_method.wgsl` has it: METHOD_..., steps, bisections, and the bits of the limit.
    #[cfg(feature = "gpu")]
    pub(crate) fn words(self) -> [u32; 4] {
        match self {
            Self::None => [0, 0, 0, 0],
            Self::Welsh => [1, 0, 0, 0],
            Self::Limited => [2, 0, 0, 0],
            Self::Plane { limit } => [3, 0, 0, limit.to_bits()],
            Self::Steps { k } => [4, k.get(), 0, 0],
            Self::Relief { steps, bisections } => [5, steps, bisections, 0],
        }
    }
}

impl fmt::Display for ParallaxMethod {
    /// `none`, `welsh`, `limited`, `plane, limit 1`, `steps 4`, `relief 64+8`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.pad("none"),
            Self::Welsh => f.pad("welsh"),
            Self::Limited => f.pad("limited"),
            Self::Plane { limit } => f.pad(&format!("plane, limit {limit}")),
            Self::Steps { k } => f.pad(&format!("steps {k}")),
            Self::Relief { steps, bisections } => f.pad(&format!("relief {steps}+{bisections}")),
        }
    }
}
