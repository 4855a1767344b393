//! From codes to normals: integers over the greatest code.

use texbake::{Channels, CodesRef, Convention, Encoding, NormalMap};

/// The normals of a map of integer codes, as integers over `greatest`.
pub struct Normals {
    pub vectors: Vec<[i64; 3]>,
    pub greatest: i64,
}

/// What the code of a map is taken for that unorm writes for zero, (L + 1)/2.
#[derive(Clone, Copy, PartialEq)]
pub enum UnormZero {
    /// Zero, as documented.
    Zero,
    /// 1/L, as 2c - L has it: for a test that shall fail.
    OneOverL,
}

/// The components of every texel as they are stored.
pub fn components(map: &NormalMap, zero: UnormZero) -> (Vec<i64>, i64) {
    let (codes, bits): (Vec<i64>, u32) = match map.codes() {
        CodesRef::U8(codes) => (codes.iter().map(|&code| code.into()).collect(), 8),
        CodesRef::U16(codes) => (codes.iter().map(|&code| code.into()).collect(), 16),
        CodesRef::F16(_) | CodesRef::F32(_) => panic!("floats have no integer components"),
    };
    let half = 1 << (bits - 1);
    let unorm = |code: i64| match (2 * code - (2 * half - 1), zero) {
        (1, UnormZero::Zero) => 0,
        (component, _) => component,
    };
    let signed = |code: i64| code.max(1 - half);
    match map.format().encoding {
        Encoding::Unorm => (codes.into_iter().map(unorm).collect(), 2 * half - 1),
        // Two's complement: the upper half of the codes is negative.
        Encoding::Snorm => {
            (codes.into_iter().map(|c| signed(if c < half { c } else { c - 2 * half })).collect(), half - 1)
        }
        Encoding::Biased => (codes.into_iter().map(|c| signed(c - half)).collect(), half - 1),
        Encoding::Float => unreachable!("integer codes"),
    }
}

/// The normals of a map, green as `convention` has it; z is at least 1, and rebuilt where it is not stored.
pub fn normals(map: &NormalMap, convention: Convention, zero: UnormZero) -> Normals {
    let (components, greatest) = components(map, zero);
    let green = if map.format().convention == convention { 1 } else { -1 };
    let vector = |texel: &[i64]| {
        let z = match map.format().channels {
            Channels::Xyz => texel[2],
            Channels::Xy => (greatest * greatest - texel[0] * texel[0] - texel[1] * texel[1]).max(0).isqrt(),
        };
        [texel[0], green * texel[1], z.max(1)]
    };
    let vectors = components.chunks(map.format().channels.count()).map(vector).collect();
    Normals { vectors, greatest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::{BIASED8, SNORM8, SNORM16, UNORM8, normal_map};
    use texbake::NormalFormat;

    fn read(format: NormalFormat, bits: &[u32]) -> Vec<[i64; 3]> {
        let width = bits.len() / format.channels.count();
        normals(&normal_map(width, 1, format, bits), Convention::Gl, UnormZero::Zero).vectors
    }

    #[test]
    fn known_codes_are_known_normals() {
        assert_eq!(read(UNORM8, &[0, 128, 255, 127, 129, 127]), [[-255, 0, 255], [-1, 3, 1]]);
        assert_eq!(read(SNORM8, &[0x80, 0x81, 0x7f, 0xff, 1, 0xff]), [[-127, -127, 127], [-1, 1, 1]]);
        assert_eq!(read(BIASED8, &[0, 1, 255, 127, 128, 0]), [[-127, -127, 127], [-1, 0, 1]]);
        let xy = |format| NormalFormat { channels: Channels::Xy, ..format };
        // 127^2 - 3^2 - 4^2 = 16104, between 126^2 and 127^2; 127^2 - 90^2 - 90^2 is below zero.
        assert_eq!(read(xy(SNORM8), &[3, 4, 90, 90]), [[3, 4, 126], [90, 90, 1]]);
        assert_eq!(read(xy(SNORM16), &[0, 0, 32767, 0]), [[0, 0, 32767], [32767, 0, 1]]);
        let dx = NormalFormat { convention: Convention::Dx, ..SNORM8 };
        assert_eq!(read(dx, &[5, 6, 7]), [[5, -6, 7]]);
    }
}
