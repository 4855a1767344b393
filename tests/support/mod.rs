//! What every topic needs: the bakers under test, the comparison of codes, chance, and maps of chosen slopes.

mod bakers;
mod compare;
mod pairs;
mod random;

pub use bakers::{Subject, assert_every_baker, every_baker};
pub use compare::{Image, assert_same, differences};
pub use pairs::{every_difference_pair, greatest_sum, map_of_pairs};
pub use random::Random;

use texbake::{
    Channels, Convention, Depth, Edge, Edges, Encoding, Filter, Grid, HeightMap, NormalFormat, NormalOptions, Scale,
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

const fn format(encoding: Encoding, depth: Depth) -> NormalFormat {
    NormalFormat { encoding, depth, channels: Channels::Xyz, convention: Convention::Gl }
}

/// A scale in texels, as a user writes it.
pub fn scale(text: &str) -> Scale {
    Scale::Texels(text.parse().expect("a number"))
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
