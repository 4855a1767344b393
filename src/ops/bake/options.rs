//! What a user can choose.

use crate::exact::Scale;
use crate::map::{Edges, NormalFormat, ParallaxFormat};
use crate::mips::RoughnessOptions;
use crate::names::named;
use crate::ops::Precision;

/// How a height map becomes a normal map.
///
/// The default: one texel of height, central differences, edges that wrap, an 8-bit unorm map with green up, `exact`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct NormalOptions {
    /// How high h = 1 is.
    pub scale: Scale,
    /// The slope stencil.
    pub filter: Filter,
    /// What lies beyond the borders.
    pub edges: Edges,
    /// What the codes of the normal map shall mean.
    pub format: NormalFormat,
    /// Exact bytes, or speed.
    pub precision: Precision,
}

/// How a height map becomes a parallax map.
///
/// The default: one texel of height, central differences, edges that wrap, 8-bit snorm, `exact`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct ParallaxOptions {
    /// How high h = 1 is.
    pub scale: Scale,
    /// The slope stencil.
    pub filter: Filter,
    /// What lies beyond the borders.
    pub edges: Edges,
    /// What the codes of the parallax map shall mean.
    pub format: ParallaxFormat,
    /// Exact bytes, or speed.
    pub precision: Precision,
}

/// How a height map becomes its maps, in one pass.
///
/// The default asks for a normal map alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BakeOptions {
    /// How high h = 1 is.
    pub scale: Scale,
    /// The slope stencil.
    pub filter: Filter,
    /// What lies beyond the borders.
    pub edges: Edges,
    /// The normal map's format, if one is wanted.
    pub normal: Option<NormalFormat>,
    /// The parallax map's format, if one is wanted.
    pub parallax: Option<ParallaxFormat>,
    /// The roughness of the mip levels beside them, if it is wanted.
    pub roughness: Option<RoughnessOptions>,
    /// Exact bytes, or speed.
    pub precision: Precision,
}

impl Default for BakeOptions {
    fn default() -> Self {
        NormalOptions::default().into()
    }
}

impl From<NormalOptions> for BakeOptions {
    fn from(NormalOptions { scale, filter, edges, format, precision }: NormalOptions) -> Self {
        Self { scale, filter, edges, normal: Some(format), parallax: None, roughness: None, precision }
    }
}

impl From<ParallaxOptions> for BakeOptions {
    fn from(ParallaxOptions { scale, filter, edges, format, precision }: ParallaxOptions) -> Self {
        Self { scale, filter, edges, normal: None, parallax: Some(format), roughness: None, precision }
    }
}

/// The slope stencil: differences of the texels on either side, weighted over three rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Filter {
    /// Central differences, one row: sharpest (FGED2 eq. 7.41).
    #[default]
    Central,
    /// Weights 1, 2, 1.
    Sobel,
    /// Weights 3, 10, 3: the most even in all directions.
    Scharr,
    /// Weights 1, 1, 1: the smoothest.
    Prewitt,
}

named! {
    Filter "filter" { Central = "central", Sobel = "sobel", Scharr = "scharr", Prewitt = "prewitt" }
}
