//! texbake bakes height maps into tangent-space normal maps and parallax maps, and blends normal maps, on a GPU through
//! WGSL compute kernels or on the CPU.
//!
//! In [`Precision::Exact`], the default, every backend writes the same bytes, and where all inputs hold 8- or 16-bit
//! codes each code is the one nearest to what the formula gives in real arithmetic.
//!
//! ```
//! use texbake::{Baker, Grid, HeightMap, NormalOptions, Scale};
//!
//! // Or HeightMap::read("height.png")?
//! let heights = HeightMap::from(Grid::from_fn(256, 256, |x, y| (x ^ y) as u8)?);
//! let options = NormalOptions { scale: Scale::texels(24), ..Default::default() };
//! let normals = Baker::auto().normal(&heights, &options)?;
//! # let folder = tempfile::tempdir().unwrap();
//! # let path = folder.path().join("normal.png");
//! normals.write(path)?;
//! # Ok::<(), texbake::Error>(())
//! ```
//!
//! - [`Baker`] is a backend, chosen once: [`Baker::auto`], [`Baker::cpu`], [`Baker::gpu`].
//! - [`HeightMap`], [`NormalMap`] and [`ParallaxMap`] are maps with what their numbers mean attached; [`io`] reads and
//!   writes them.
//! - [`Baker::bake`] makes normal and parallax map in one pass; [`Baker::blend`] makes one normal map of two.
//! - [`Baker::bake_rows`] and [`Baker::blend_rows`] work while rows are read and written, in memory that does not grow
//!   with the map; [`stream`] has the traits of their ends.
//! - [`inspect`] finds what is wrong with a normal map, mends it, and compares two.
#![cfg_attr(feature = "gpu", doc = "- [`gpu::Hosted`] bakes on the caller's own wgpu device, without a readback.")]
//!
//! # What is held in memory
//!
//! | | |
//! | --- | --- |
//! | [`Baker::normal`], [`Baker::bake`], [`Baker::blend`] | the maps that go in and those that come out |
//! | [`Baker::normal_rows`], folders | a few bands of rows of each file that is being baked |
//! | TIFF and EXR heights | besides, the strip, block or row of tiles that is being read, however large |
//! | interlaced PNG, TGA, BMP, JPEG, WebP heights | besides, the whole map, decoded |
//! | PNG heights that wrap, baked into EXR | besides, the whole map up to 64 MiB; larger ones are decoded twice |
//! | a detail map that tiles, in a blend | besides, the whole detail map |
//!
//! # What is computed
//!
//! A code H of B bits means the height h = H / (2^B - 1); a float is the height itself. With the scale s, the height
//! of h = 1 in widths of one texel, the slopes at column i, row j (rows count down) are
//!
//! ```text
//! dx = s/2 [h(i+1, j) - h(i-1, j)]      dy = s/2 [h(i, j+1) - h(i, j-1)]        (FGED2 eq. 7.41)
//! m = (-dx, -dy, 1) / sqrt(dx^2 + dy^2 + 1)                                      (eq. 7.43)
//! ```
//!
//! where FGED2 is Eric Lengyel, Foundations of Game Engine Development, volume 2: Rendering, 2019. Other stencils
//! ([`Filter`]) weigh three rows instead of one. With [`Convention::Gl`] y is negated before it is rounded.
//!
//! A parallax map holds m_z (2h - 1) (FGED2 section 7.7). A blend adds slopes, each with its weight, and is the normal
//! map of the height maps' weighted sum:
//!
//! ```text
//! (a x1/z1 + b x2/z2, a y1/z1 + b y2/z2, 1), normalised                          (FGED2 eq. 7.46; a = b = 1: 7.47)
//! ```
//!
//! On integer codes all of this is A / sqrt(S) with integers A and S, which is rounded by comparing integers.
//!
//! # Degenerate cases
//!
//! | case | result |
//! | --- | --- |
//! | one row or one column | that axis is its own neighbour: no slope |
//! | two rows or columns that wrap | both neighbours are the same texel: no slope |
//! | scale 0, or a flat map | (0, 0, 1) exactly, on every device |
//! | a float height that is NaN or infinite | [`Error::NotFinite`] names the first |
//! | float heights below 2^-90, slopes below 2^-25, components below 2^-100 in magnitude | count as zero |
//! | float slopes up to and beyond `f32::MAX` | no overflow: the direction is right |
//! | float heights below 0 or above 1 in a parallax map | count as 0 or 1 in (2h - 1), as they are in m_z |
//! | the unorm code 128 (32768), which zero is written as | reads as zero, so a flat map changes nothing in a blend |
//! | the snorm code -128 (-32768), and 0 of biased | reads as -1 |
//! | a normal with z at or below zero | z counts as the least above zero: one of L for integers, 2^-24 for floats |
//! | a normal of any length | slopes do not depend on it; parallax normalises it; other blends take it as it is |
//! | a blend of which nothing is left, (0, 0, 0) | (0, 0, 1) |
//! | a float normal with a component that is NaN, infinite or beyond 65536 | [`Error::NoDirection`] names the first |
//! | float components of normals below 2^-25 in magnitude | count as zero |

#[macro_use]
mod vectorised;

mod backend;
mod baker;
#[cfg(feature = "cli")]
pub mod batch;
mod devices;
mod error;
mod exact;
#[cfg(feature = "gpu")]
pub mod gpu {
    //! Bakes on a wgpu device of the caller's.

    pub use crate::backend::gpu::{CodeTarget, HeightSource, Hosted, NormalBake};
    /// The version that [`Hosted`] works with.
    pub use wgpu;
}
pub mod inspect;
pub mod io;
mod map;
mod mesh;
mod names;
mod ops;
pub mod stream;

pub use baker::{Baked, Baker, Blended, Ran};
pub use devices::{Device, devices};
pub use error::{Error, Result};
pub use exact::{AxisScale, Rational, Scale, Weights};
pub use map::{
    Channels, CodeMap, Codes, CodesMut, CodesRef, Convention, Depth, Edge, Edges, Encoding, Grid, HeightMap,
    HeightType, Heights, HeightsMut, MapFormat, Maps, NormalFormat, NormalMap, ParallaxFormat, ParallaxMap, Size,
};
pub use mesh::{CornerAdjacency, Mesh};
pub use ops::Precision;
pub use ops::bake::{BakeOptions, Filter, NormalOptions, ParallaxOptions};
pub use ops::blend::{BlendInputs, BlendMethod, BlendOptions};
pub use ops::tangents::{MissingNormals, TangentMethod, TangentOptions, TangentReport, Tangents};
