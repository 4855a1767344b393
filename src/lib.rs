//! texbake bakes height maps into tangent-space normal maps and parallax maps, blends normal maps, and computes the
//! tangents of the meshes that they are mapped on, on a GPU through WGSL compute kernels or on the CPU.
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
//! - [`Baker::bake_levels`] makes all mip levels of both, and what roughness stands for the detail that they lose.
//! - [`Baker::bake`] makes normal and parallax map in one pass; [`Baker::blend`] makes one normal map of two.
//! - [`Baker::bake_rows`] and [`Baker::blend_rows`] work while rows are read and written, in memory that does not grow
//!   with the map; [`stream`] has the traits of their ends.
//! - [`Baker::tangents`] computes the tangents of a [`Mesh`]; [`io::Model`] reads meshes from glTF and OBJ files, and
//!   writes them with tangents.
//! - [`inspect`] finds what is wrong with a normal map, mends it, and compares two.
#![cfg_attr(feature = "cli", doc = "- [`plan`] bakes no more than a scene needs.")]
//! - [`shading`] has the twins of what a shader does with the maps, [`material`] samples them as a scene does.
#![cfg_attr(feature = "gpu", doc = "- [`gpu::Hosted`] bakes on the caller's own wgpu device, without a readback.")]
//!
//! # What is held in memory
//!
//! | | |
//! | --- | --- |
//! | [`Baker::normal`], [`Baker::bake`], [`Baker::blend`] | the maps that go in and those that come out |
//! | [`Baker::normal_rows`], folders | a few bands of rows of each file that is being baked |
//! | TIFF and EXR heights | besides, the block or row of tiles that is being read, however large; strips above 1 MiB are unpacked row by row |
//! | interlaced PNG, TGA, BMP, JPEG, WebP heights | besides, the whole map, decoded |
//! | mip levels | besides, a few rows of sums for each level |
//! | folders with [`stream::Monitor::with_memory`] | no more than that, or a file that needs more by itself fails |
//! | PNG heights that wrap, baked into EXR | besides, the whole map up to 64 MiB; larger ones are decoded twice |
//! | a detail map that tiles, in a blend | besides, the whole detail map |
//! | [`Baker::tangents`] | the mesh, the corners at each of its vertices, and what comes out |
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
//! # Tangents
//!
//! A triangle with the edges e1, e2 from its first corner, in space, and (x1, y1), (x2, y2), in the texture, has the
//! directions t, in which u grows, and b, in which v grows. A vertex with the normal n gets a tangent t' from the
//! triangles around it, and the sign w that rebuilds the bitangent b':
//!
//! ```text
//! t = (e1 y2 - e2 y1) / (x1 y2 - x2 y1),  b = (e2 x1 - e1 x2) / (x1 y2 - x2 y1)  (FGED2 eq. 7.37)
//! t' = t - (t . n) n, normalised, t being the sum over the triangles             (eq. 7.38)
//! b' = w (n x t'),  w the sign of det(t, b, n)                                   (eq. 7.40)
//! ```
//!
//! | method | what a triangle adds at a corner |
//! | --- | --- |
//! | [`TangentMethod::Mikktspace`] | t projected on the tangent plane, of length one, times the angle at the corner |
//! | [`TangentMethod::Lengyel`] | t (listing 7.4) |
//! | [`TangentMethod::Hegde`] | its first edge along which u changes, of length one, towards growing u |
//!
//! Vertices are not shared across what a tangent cannot be shared across: with `Mikktspace` they are split as the
//! reference implementation groups triangles, else where triangles of both handednesses meet.
//!
//! Texture coordinates are glTF's: v grows **down** the image. Green up ([`Convention::Gl`], what glTF's normal maps
//! have) is against v, so there w is +1 where the texture is not mirrored: seen from outside, u to the right and green
//! up. [`Convention::Dx`] is the opposite sign. The same mesh with v growing up, as in OBJ files, has v turned first.
//!
//! `Mikktspace` on triangles gives the tangents, splits and signs of Mikkelsen's reference implementation to the bit,
//! but for:
//!
//! - where the reference leaves a zero vector or none, a tangent is made up, and counted: see below;
//! - positions and texture coordinates are first multiplied by powers of two, each by one of its own. That changes no
//!   bit of the result, but meshes of 1e20 and of 1e-20 have one, where the reference overflows or drops them;
//! - faces of four corners are triangles here, however they were split; the reference splits a square by itself;
//! - normals that are zero or longer or shorter than one by more than 1 % are repaired first; others are taken as they
//!   are, as the reference takes all;
//! - a group of more than 4096 triangles around one vertex stays whole where the reference would divide it: where two of
//!   its tangents are exactly opposite.
//!
//! Four components are what glTF and engines read. [`Tangents::with_sign_in_lowest_bit`] packs the sign into three, as
//! FGED2 suggests (for programs only: no file format has it), and [`Tangents::bitangents`] is eq. 7.40.
//!
//! The arithmetic of `exact` is IEEE f32 in a written order, as for float maps. What decides which triangles share a
//! tangent is found on the CPU, whatever runs the rest.
//!
//! # Degenerate cases
//!
//! [`extremes`] says what comes of flat maps and infinite heights, of scales and weights at their ends, of normals that
//! point nowhere and triangles without area, and of an eye in the plane.

#[macro_use]
mod vectorised;

mod backend;
mod baker;
#[cfg(feature = "cli")]
pub mod batch;
mod devices;
mod error;
mod exact;
pub mod extremes {
    #![doc = include_str!("../docs/extremes.md")]
}
#[cfg(feature = "gpu")]
pub mod gpu {
    //! Bakes on a wgpu device of the caller's, and the kernels as they are compiled.

    pub use crate::backend::gpu::{CodeTarget, HeightSource, Hosted, KernelVariant, NormalBake, kernels};
    /// The version that [`Hosted`] works with.
    pub use wgpu;
}
pub mod inspect;
pub mod io;
mod map;
pub mod material;
pub mod measure;
mod mesh;
mod mips;
mod names;
mod ops;
#[cfg(feature = "cli")]
pub mod plan;
#[cfg(feature = "cli")]
pub mod preview;
pub mod shading;
mod split_mix;
pub mod stream;
mod vector;
pub mod verify;

pub use baker::{Baked, BakedMaps, Baker, Blended, LevelMaps, Ran};
pub use devices::{Device, devices};
pub use error::{Error, Result};
pub use exact::{AxisScale, Rational, Scale, Weights};
pub use map::{
    Channels, CodeMap, Codes, CodesMut, CodesRef, Convention, Depth, Edge, Edges, Encoding, Grid, HeightMap,
    HeightType, Heights, HeightsMut, MapFormat, Maps, NormalFormat, NormalMap, ParallaxFormat, ParallaxMap,
    RoughnessFormat, RoughnessMap, Size,
};
pub use mesh::{CornerAdjacency, Mesh};
pub use mips::{RoughnessMethod, RoughnessOptions};
pub use ops::Precision;
pub use ops::bake::{BakeOptions, Filter, NormalOptions, ParallaxOptions};
pub use ops::blend::{BlendInputs, BlendMethod, BlendOptions};
pub use ops::tangents::{MissingNormals, TangentMethod, TangentOptions, TangentReport, Tangents};
