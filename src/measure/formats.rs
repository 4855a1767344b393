//! The formats that maps are measured in.

use crate::map::{Channels, Convention, Depth, Encoding, NormalFormat, ParallaxFormat};

/// Every encoding with every number of bits that it goes with.
const CODES: [(Encoding, Depth); 8] = [
    (Encoding::Unorm, Depth::Bits8),
    (Encoding::Snorm, Depth::Bits8),
    (Encoding::Biased, Depth::Bits8),
    (Encoding::Unorm, Depth::Bits16),
    (Encoding::Snorm, Depth::Bits16),
    (Encoding::Biased, Depth::Bits16),
    (Encoding::Float, Depth::Float16),
    (Encoding::Float, Depth::Float32),
];

/// Every format of a normal map with this convention: 8 codes, each with three channels and with two.
pub fn normal_formats(convention: Convention) -> Vec<NormalFormat> {
    let with = |channels| CODES.map(|(encoding, depth)| NormalFormat { encoding, depth, channels, convention });
    [Channels::Xyz, Channels::Xy].into_iter().flat_map(with).collect()
}

/// Every format of a parallax map.
pub fn parallax_formats() -> Vec<ParallaxFormat> {
    CODES.map(|(encoding, depth)| ParallaxFormat { encoding, depth }).to_vec()
}
