//! How the reference stores the components of a texel.

use crate::exact::{CodeRounding, nearest_f16, nearest_f32};
use crate::map::{CodesMut, TexelFormat};
use half::f16;

/// Stores `a / sqrt(s)` for the components `a` of texel `index`, correctly rounded.
pub(crate) fn store_fractions(format: TexelFormat, a: &[i64], s: u128, codes: &mut CodesMut<'_>, index: usize) {
    let rounding = || CodeRounding::new(format).expect("checked with the options");
    for (channel, &a) in a.iter().take(format.channels).enumerate() {
        let at = index * format.channels + channel;
        match codes {
            CodesMut::U8(codes) => codes[at] = rounding().code(a, s) as u8,
            CodesMut::U16(codes) => codes[at] = rounding().code(a, s) as u16,
            CodesMut::F16(codes) => codes[at] = nearest_f16(a, s),
            CodesMut::F32(codes) => codes[at] = nearest_f32(a, s),
        }
    }
}

/// Stores float components of texel `index`: rounded half up in f32 for integer codes, half to even for f16.
pub(crate) fn store_floats(format: TexelFormat, components: &[f32], codes: &mut CodesMut<'_>, index: usize) {
    let rounding = || CodeRounding::new(format).expect("checked with the options");
    for (channel, &component) in components.iter().take(format.channels).enumerate() {
        let at = index * format.channels + channel;
        match codes {
            CodesMut::U8(codes) => codes[at] = rounding().code_of_float(component) as u8,
            CodesMut::U16(codes) => codes[at] = rounding().code_of_float(component) as u16,
            CodesMut::F16(codes) => codes[at] = f16::from_f32(component),
            CodesMut::F32(codes) => codes[at] = component,
        }
    }
}
