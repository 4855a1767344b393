// The integer code nearest to A / sqrt(S): a float estimate and one comparison of integers (DESIGN 3.1).
//
// |A| <= sqrt(S). The functions differ in how many bits S may take: as few as possible make a kernel fast.
// CPU twin: src/exact/round.rs.

// The code of a / sqrt(s), or of its negative: m^2 s fits 64 bits. `scale` is nearly 1 / sqrt(s).
fn nearest_code64(output: Output, negative: bool, a: u32, s: vec2<u32>, scale: f32) -> u32 {
    let below = code_below(output, negative, f32(a) * scale);
    let t = 2 * below + 1 - output.code_c;
    let ma = u32(output.code_m) * a;
    let mmaa = product(ma, ma);
    let tt = u32(abs(t)) * u32(abs(t));
    let tts = product(tt, s.x) + vec2(0u, tt * s.y);
    let up = reaches(negative, t, at_least64(mmaa, tts), at_least64(tts, mmaa));
    return stored_code(output, below + i32(up));
}

// The code of sqrt(aa / s), or of its negative. `estimate` is nearly sqrt(aa / s).
fn nearest_code96(output: Output, negative: bool, estimate: f32, aa: vec3<u32>, s: vec3<u32>) -> u32 {
    let below = code_below(output, negative, estimate);
    let t = 2 * below + 1 - output.code_c;
    let mmaa = times96(aa, u32(output.code_m) * u32(output.code_m));
    let tts = times96(s, u32(abs(t)) * u32(abs(t)));
    let up = reaches(negative, t, at_least128(mmaa, tts), at_least128(tts, mmaa));
    return stored_code(output, below + i32(up));
}

// The same for s of up to 128 bits.
fn nearest_code128(output: Output, negative: bool, estimate: f32, aa: vec4<u32>, s: vec4<u32>) -> u32 {
    let below = code_below(output, negative, estimate);
    let t = 2 * below + 1 - output.code_c;
    let mmaa = times128(aa, u32(output.code_m) * u32(output.code_m));
    let tts = times128(s, u32(abs(t)) * u32(abs(t)));
    let up = reaches(negative, t, at_least160(mmaa, tts), at_least160(tts, mmaa));
    return stored_code(output, below + i32(up));
}

// The code or the one below it: the estimate is off by far less than half a code.
fn code_below(output: Output, negative: bool, estimate: f32) -> i32 {
    let component = select(estimate, -estimate, negative);
    let below = i32(floor((f32(output.code_m) * component + f32(output.code_c)) * 0.5));
    return clamp(below, output.code_least, output.code_greatest - 1);
}

// Whether m A >= t sqrt(S), from the signs of A and t and the order of m^2 A^2 and t^2 S.
fn reaches(negative: bool, t: i32, at_least: bool, at_most: bool) -> bool {
    return select(t < 0 || at_least, t <= 0 && at_most, negative);
}
