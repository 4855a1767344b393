// What a texture unit gives of a normal map's texel, as a normal.
//
//   unorm    v = 2 s - 1                    s in [0, 1]: the sample of an unsigned channel (FGED2 section 7.6.1, Hegde)
//   snorm    v = max(s, -1)                 s in [-1, 1]: the sample of a signed channel
//   biased   v = s L'/L - (L + 1)/L         L = 127 or 32767, L' = 255 or 65535: Schueler's sign expansion, 255/127 and
//                                           128/127, by which the code 128 is exactly 0; never below -1
//   xy       z = sqrt(1 - x^2 - y^2)        eq. 7.44, listing 7.6; 0 where x and y are longer than 1
//
// Samples and results have no unit. Interpolated normals are no longer of length one: normalise what comes out. x and y
// are those of the map; green_turned makes of green up green down, and back.
//
// Their twins: src/shading/decode_normal.rs.

fn decode_unorm(s: vec3<f32>) -> vec3<f32> {
    return 2.0 * s - 1.0;
}

fn decode_snorm(s: vec3<f32>) -> vec3<f32> {
    return max(s, vec3<f32>(-1.0));
}

fn decode_biased_8_bit(s: vec3<f32>) -> vec3<f32> {
    return max((255.0 * s - 128.0) / 127.0, vec3<f32>(-1.0));
}

fn decode_biased_16_bit(s: vec3<f32>) -> vec3<f32> {
    return max((65535.0 * s - 32768.0) / 32767.0, vec3<f32>(-1.0));
}

fn rebuild_z(xy: vec2<f32>) -> vec3<f32> {
    return vec3<f32>(xy, sqrt(max(1.0 - dot(xy, xy), 0.0)));
}

fn green_turned(m: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(m.x, -m.y, m.z);
}
