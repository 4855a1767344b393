//! What a user can choose.

use crate::exact::Scale;
use crate::map::{Edges, NormalFormat};
use crate::names::named;

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

/// Exact bytes, or speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Precision {
    /// The same bytes on every backend; for integer heights the correctly rounded ones.
    #[default]
    Exact,
    /// Native floats. Measured by `cargo bench --bench accuracy`, with directions off by 1e-5 degrees at most:
    ///
    /// - 8 bits: 2.5e-6 of the codes differ, each by one.
    /// - 16 bits: 1e-1 of the codes differ, each by one.
    /// - 16f: a code next to the exact one, where that lies close to the middle between two.
    /// - 32f: most codes differ, in their last four bits; two devices need not agree.
    Fast,
}

named! {
    Filter "filter" { Central = "central", Sobel = "sobel", Scharr = "scharr", Prewitt = "prewitt" }
    Precision "precision" { Exact = "exact", Fast = "fast" }
}
