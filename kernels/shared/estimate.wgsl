// The integer codes nearest to A / sqrt(S) by native floats, four at a time, and which of them are in doubt.
//
// |A| <= sqrt(S). WGSL lets a conversion, a sum and a product be off by a unit of the last place (2^-23 of the number),
// an inverse root by two, a quotient by 2.5; what is derived here holds however they are fused or reordered. A code is
// in doubt where more than twice the error that these add up to could change it: integers decide there. A test raises
// `params.doubt`, so that they decide everywhere.

struct Codes {
    codes: vec4<u32>,
    doubtful: vec4<bool>,
}

// What is known of four numbers A / sqrt(S).
struct Component {
    estimate: vec4<f32>,  // A times `scale`, off by at most 9 units
    a: vec4<i32>,         // A modulo 2^32
    scale: vec4<f32>,     // nearly the inverse root of S
    root: Root,
}

fn integer_codes(output: Output, bits: u32, component: Component) -> Codes {
    if (bits == 8u) {
        return byte_codes(output, component.estimate);
    }
    return short_codes(output, component.estimate, component.a, component.root);
}

// Of 8 bits: the component as a code is off by 9 2^-23 127.5, and by two roundings below 512, all in all 2.0e-4.
const BYTE_ERROR: f32 = 0x1p-11f;

fn byte_codes(output: Output, component: vec4<f32>) -> Codes {
    // 128 above: then cutting off is what floor does.
    let position = component * (f32(output.code_m) * 0.5) + ((f32(output.code_c) + 1.0) * 0.5 + 128.0);
    let codes = vec4<i32>(vec4<u32>(position)) + (output.code_offset - 128);
    let distance = 0.5 - abs(fract(position) - 0.5);
    // A component of zero has no error, and lies on a boundary of unorm.
    let doubtful = is_near(distance, vec4(BYTE_ERROR)) & (component != vec4(0.0));
    return Codes(vec4<u32>(codes) & vec4(output.code_mask), doubtful);
}

// sqrt(S) = whole + rest, S below 2^49.
struct Root {
    whole: vec4<i32>,
    rest: vec4<f32>,
}

// `low` is S modulo 2^32, `s` nearly S, and `scale` nearly its inverse root.
fn root_of(low: vec4<u32>, s: vec4<f32>, scale: vec4<f32>) -> Root {
    let root = s * scale;
    let whole = vec4<u32>(root);
    // The root is off by at most 7 units, so S - whole^2 fits 32 bits.
    let left = vec4<i32>(low - whole * whole);
    return Root(vec4<i32>(whole), vec4<f32>(left) / (vec4<f32>(whole) + root));
}

// Of 16 bits: one of two neighbours is nearest, as m A >= t sqrt(S) says. m A - t whole is an integer below 2^31, and
// t rest is off by 10 units, 1.2e-6 of it: the integer is as small or tells them apart.
const SHORT_ERROR: f32 = 0x1p-18f;

fn short_codes(output: Output, component: vec4<f32>, a: vec4<i32>, root: Root) -> Codes {
    let estimate = floor((f32(output.code_m) * component + f32(output.code_c)) * 0.5);
    let below = clamp(vec4<i32>(estimate), vec4(output.code_least), vec4(output.code_greatest - 1));
    let t = 2 * below + 1 - output.code_c;
    let rest = vec4<f32>(t) * root.rest;
    let excess = vec4<f32>(output.code_m * a - t * root.whole) - rest;
    let codes = below + select(vec4(0), vec4(1), excess >= vec4(0.0)) + output.code_offset;
    return Codes(vec4<u32>(codes) & vec4(output.code_mask), is_near(abs(excess), abs(rest) * SHORT_ERROR));
}

fn is_near(distance: vec4<f32>, error: vec4<f32>) -> vec4<bool> {
    return distance < error * bitcast<f32>(params.doubt);
}
