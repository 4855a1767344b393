//! Normal maps of chosen codes.

use super::Random;
use half::f16;
use texbake::{Channels, Codes, Convention, Depth, Encoding, NormalFormat, NormalMap, Size};

/// A map of these stored bits, texel by texel.
pub fn normal_map(width: usize, height: usize, format: NormalFormat, bits: &[u32]) -> NormalMap {
    let codes = match format.depth {
        Depth::Bits8 => Codes::U8(bits.iter().map(|&bits| bits as u8).collect()),
        Depth::Bits16 => Codes::U16(bits.iter().map(|&bits| bits as u16).collect()),
        Depth::Float16 => Codes::F16(bits.iter().map(|&bits| f16::from_bits(bits as u16)).collect()),
        Depth::Float32 => Codes::F32(bits.iter().map(|&bits| f32::from_bits(bits)).collect()),
    };
    NormalMap::new(Size::new(width, height).expect("a size"), format, codes).expect("codes of the format")
}

/// A map whose texel in column x, row y has the codes `texel(x, y)`; of two channels, the first two.
pub fn map_of_texels(
    width: usize,
    height: usize,
    format: NormalFormat,
    mut texel: impl FnMut(usize, usize) -> [u32; 3],
) -> NormalMap {
    let texels =
        (0..width * height).flat_map(|i| texel(i % width, i / width).into_iter().take(format.channels.count()));
    normal_map(width, height, format, &texels.collect::<Vec<_>>())
}

/// The stored bits of -1, 0 and 1.
pub fn landmarks(format: NormalFormat) -> [u32; 3] {
    let (half, all) = match format.depth {
        Depth::Bits8 => (0x80, 0xff),
        _ => (0x8000, 0xffff),
    };
    match (format.encoding, format.depth) {
        (Encoding::Float, Depth::Float16) => [0xbc00, 0, 0x3c00],
        (Encoding::Float, _) => [0xbf80_0000, 0, 0x3f80_0000],
        (Encoding::Unorm, _) => [0, half, all],
        (Encoding::Snorm, _) => [half + 1, 0, half - 1],
        (Encoding::Biased, _) => [1, half, all],
    }
}

/// A map of (0, 0, 1).
pub fn flat_map(width: usize, height: usize, format: NormalFormat) -> NormalMap {
    let [_, zero, one] = landmarks(format);
    map_of_texels(width, height, format, |_, _| [zero, zero, one])
}

/// Any integer codes, half of the texels with z above zero; a few have extremes in all channels.
pub fn random_codes(random: &mut Random, width: usize, height: usize, format: NormalFormat) -> NormalMap {
    let [least, zero, greatest] = landmarks(format);
    let extremes = [least, zero, greatest, least.wrapping_sub(1), zero.wrapping_sub(1), zero + 1, 0];
    map_of_texels(width, height, format, |_, _| {
        let [x, y, z] = [0; 3].map(|_| random.bits() as u32 & 0xffff);
        match random.below(8) {
            0 => [0; 3].map(|_| extremes[random.below(7) as usize] & 0xffff),
            1..=3 => [x, y, z],
            // z at least 1/2, and small slopes beside steep ones.
            _ => {
                let magnitude = (greatest.wrapping_sub(zero)) & 0xffff;
                let shift = random.below(u64::from(magnitude.ilog2())) as u32;
                let near_zero = |code: u32| zero.wrapping_add((code & magnitude) >> shift);
                [near_zero(x), near_zero(y).wrapping_sub(magnitude >> shift >> 1), greatest - (z & (magnitude >> 1))]
            }
        }
    })
}

/// The format with x and y alone.
pub const fn xy(format: NormalFormat) -> NormalFormat {
    NormalFormat { channels: Channels::Xy, ..format }
}

/// The format with green down.
pub const fn dx(format: NormalFormat) -> NormalFormat {
    NormalFormat { convention: Convention::Dx, ..format }
}
