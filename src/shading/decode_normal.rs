//! What a texture unit gives of a normal map's texel, as a normal.

/// v = 2 s - 1 of each sample s in [0, 1] of an unsigned channel (FGED2 section 7.6.1).
///
/// No code of 8 or 16 bits is exactly 0: 128 becomes 1/255.
pub fn decode_unorm(s: [f32; 3]) -> [f32; 3] {
    s.map(|s| 2.0 * s - 1.0)
}

/// v = max(s, -1) of each sample s of a signed channel.
pub fn decode_snorm(s: [f32; 3]) -> [f32; 3] {
    s.map(|s| s.max(-1.0))
}

/// Schüler's sign expansion of 8 bits, v = 255/127 s - 128/127 and never below -1: the code 128 is exactly 0.
///
/// ```
/// use texbake::shading::decode_biased_8_bit;
///
/// assert_eq!(decode_biased_8_bit([128.0 / 255.0, 1.0 / 255.0, 1.0]), [0.0, -1.0, 1.0]);
/// ```
pub fn decode_biased_8_bit(s: [f32; 3]) -> [f32; 3] {
    s.map(|s| ((255.0 * s - 128.0) / 127.0).max(-1.0))
}

/// The same of 16 bits: v = 65535/32767 s - 32768/32767, and the code 32768 is exactly 0.
pub fn decode_biased_16_bit(s: [f32; 3]) -> [f32; 3] {
    s.map(|s| ((65_535.0 * s - 32_768.0) / 32_767.0).max(-1.0))
}

/// A normal of two channels: z = sqrt(1 - x^2 - y^2) (FGED2 eq. 7.44, listing 7.6), 0 where x and y are longer than 1.
pub fn rebuild_z([x, y]: [f32; 2]) -> [f32; 3] {
    [x, y, (1.0 - (x * x + y * y)).max(0.0).sqrt()]
}

/// Green up becomes green down, and the other way round.
pub fn green_turned([x, y, z]: [f32; 3]) -> [f32; 3] {
    [x, -y, z]
}
