//! Codes as the texels of a GPU format.

use crate::map::{Codes, CodesRef, TexelFormat};
use half::f16;
use std::borrow::Cow;

/// Whole rows of codes, three components with a one behind them: an alpha that hides nothing.
///
/// `None` if the codes are the texels already.
pub fn with_alpha(codes: CodesRef<'_>, format: TexelFormat) -> Option<Codes> {
    if format.channels != 3 {
        return None;
    }
    // Unorm 255 or 65535, snorm 127 or 32767.
    let one = format.encoding.greatest_code(format.depth).unwrap_or(1);
    Some(match codes {
        CodesRef::U8(xyz) => Codes::U8(beside(xyz, one as u8)),
        CodesRef::U16(xyz) => Codes::U16(beside(xyz, one as u16)),
        CodesRef::F16(xyz) => Codes::F16(beside(xyz, f16::ONE)),
        CodesRef::F32(xyz) => Codes::F32(beside(xyz, 1.0)),
    })
}

fn beside<T: Copy>(xyz: &[T], one: T) -> Vec<T> {
    let texels: Vec<[T; 4]> = xyz.chunks_exact(3).map(|xyz| [xyz[0], xyz[1], xyz[2], one]).collect();
    texels.into_flattened()
}

/// Codes with their least significant byte first, as both formats store them.
pub fn little_endian(codes: CodesRef<'_>) -> Cow<'_, [u8]> {
    if cfg!(target_endian = "little") {
        return codes.bytes().into();
    }
    let mut bytes = codes.bytes().to_vec();
    bytes.chunks_exact_mut(codes.depth().bytes()).for_each(<[u8]>::reverse);
    bytes.into()
}
