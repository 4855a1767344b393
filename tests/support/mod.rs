//! What every topic needs: the bakers under test, the comparison of codes and of tangents, chance, maps of chosen
//! slopes, and meshes.

mod bakers;
mod bevy;
mod boundaries;
mod codes;
mod compare;
mod corners;
mod fetched;
#[cfg(feature = "gpu")]
mod gpus;
mod meshes;
mod mikktspace;
mod pairs;
mod random;
#[cfg(feature = "gpu")]
mod shaders;

pub use bakers::{
    Subject, assert_blends, assert_each, assert_every_baker, assert_every_blend, assert_every_parallax,
    assert_every_parallax_with_normals, bakers, every_baker,
};
pub use boundaries::{convergent, factor_and_centre, rounded_by_f64};
pub use codes::{dx, flat_map, landmarks, map_of_texels, normal_map, random_codes, xy};
pub use compare::{Format, Image, assert_same, differences};
pub use corners::{
    Corner, angle, assert_same_tangents, corner_tangents, corners, direction, result_differences, tangent_differences,
};
pub use fetched::fetched;
#[cfg(feature = "gpu")]
pub use gpus::{Gpu, extent, gpus};
pub use meshes::{
    changed, cube, cylinder, cylinder_with_a_jump, degenerate_triangles, every_mesh, flat_mesh, hills, mesh,
    mirrored_halves, plane, pole, soup, sphere, star, torus, uneven, without_normals,
};
pub use mikktspace::{bevy_tangents, meshopt_tangents};
pub use pairs::{every_difference_pair, greatest_sum, map_of_pairs};
pub use random::Random;
#[cfg(feature = "gpu")]
pub use shaders::{Call, ShaderFunction, Texels};

use texbake::{
    BlendInputs, BlendMethod, BlendOptions, Channels, Convention, Depth, Edge, Edges, Encoding, Filter, Grid,
    HeightMap, NormalFormat, NormalMap, NormalOptions, ParallaxFormat, ParallaxOptions, Rational, Scale,
};

pub const FILTERS: [Filter; 4] = [Filter::Central, Filter::Sobel, Filter::Scharr, Filter::Prewitt];
pub const EDGES: [Edge; 3] = [Edge::Wrap, Edge::Clamp, Edge::Mirror];

pub const UNORM8: NormalFormat = format(Encoding::Unorm, Depth::Bits8);
pub const UNORM16: NormalFormat = format(Encoding::Unorm, Depth::Bits16);
pub const SNORM8: NormalFormat = format(Encoding::Snorm, Depth::Bits8);
pub const SNORM16: NormalFormat = format(Encoding::Snorm, Depth::Bits16);
pub const BIASED8: NormalFormat = format(Encoding::Biased, Depth::Bits8);
pub const BIASED16: NormalFormat = format(Encoding::Biased, Depth::Bits16);
pub const FLOAT16: NormalFormat = format(Encoding::Float, Depth::Float16);
pub const FLOAT32: NormalFormat = format(Encoding::Float, Depth::Float32);

/// Every encoding at every depth that it goes with.
pub const FORMATS: [NormalFormat; 8] = [UNORM8, UNORM16, SNORM8, SNORM16, BIASED8, BIASED16, FLOAT16, FLOAT32];

/// The same for parallax maps.
pub fn parallax_formats() -> [ParallaxFormat; 8] {
    FORMATS.map(|NormalFormat { encoding, depth, .. }| ParallaxFormat { encoding, depth })
}

/// Every integer encoding.
pub const INTEGER_FORMATS: [NormalFormat; 6] = [UNORM8, UNORM16, SNORM8, SNORM16, BIASED8, BIASED16];

const fn format(encoding: Encoding, depth: Depth) -> NormalFormat {
    NormalFormat { encoding, depth, channels: Channels::Xyz, convention: Convention::Gl }
}

/// A scale in texels, as a user writes it.
pub fn scale(text: &str) -> Scale {
    Scale::Texels(text.parse().expect("a number"))
}

/// A number, as a user writes it.
pub fn number(text: &str) -> Rational {
    text.parse().expect("a number")
}

/// Slopes weighted, as a user writes the weights.
pub fn weighted(base: &str, detail: &str) -> BlendMethod {
    BlendMethod::Weighted { base: number(base), detail: number(detail) }
}

/// Two maps without a mask.
pub fn pair<'a>(base: &'a NormalMap, detail: &'a NormalMap) -> BlendInputs<&'a NormalMap, &'a HeightMap> {
    BlendInputs { base, detail, mask: None }
}

/// A method and the result's format.
pub fn blend_options(method: BlendMethod, format: NormalFormat) -> BlendOptions {
    BlendOptions { method, format, ..Default::default() }
}

/// Central differences, wrapped edges.
pub fn parallax_options(scale_text: &str, format: ParallaxFormat) -> ParallaxOptions {
    ParallaxOptions { scale: scale(scale_text), format, ..Default::default() }
}

/// Central differences, wrapped edges.
pub fn options(scale_text: &str, format: NormalFormat) -> NormalOptions {
    NormalOptions { scale: scale(scale_text), format, ..Default::default() }
}

/// All nine edges of two axes.
pub fn every_edges() -> impl Iterator<Item = Edges> {
    EDGES.into_iter().flat_map(|x| EDGES.into_iter().map(move |y| Edges { x, y }))
}

pub fn map_u8(width: usize, height: usize, value: impl FnMut(usize, usize) -> u8) -> HeightMap {
    Grid::from_fn(width, height, value).expect("a size").into()
}

pub fn map_u16(width: usize, height: usize, value: impl FnMut(usize, usize) -> u16) -> HeightMap {
    Grid::from_fn(width, height, value).expect("a size").into()
}

pub fn map_f32(width: usize, height: usize, value: impl FnMut(usize, usize) -> f32) -> HeightMap {
    Grid::from_fn(width, height, value).expect("a size").try_into().expect("finite heights")
}
