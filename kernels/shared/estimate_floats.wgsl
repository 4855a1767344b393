// The floats nearest to A / sqrt(S) as estimate.wgsl finds the nearest integers, S below 2^49.

fn nearest_codes(output: Output, is_float: bool, bits: u32, component: Component) -> Codes {
    if (is_float) {
        return float_codes(bits, component);
    }
    return integer_codes(output, bits, component);
}

// What is missing is off by 17 units of what it is the difference of.
const FLOAT_ERROR: f32 = 0x1p-17f;
const LEAST_ERROR: f32 = 0x1p-20f;

// The estimate is n 2^-k with an n of 24 bits; what it misses, in units of n, is (A 2^k - n sqrt(S)) / sqrt(S), and
// A 2^k - n whole is an integer below 2^31.
fn float_codes(bits: u32, component: Component) -> Codes {
    let estimate = bitcast<vec4<u32>>(abs(component.estimate));
    let exponent = estimate >> vec4(23u);
    let n = (estimate & vec4(0x7fffffu)) | vec4(0x800000u);
    let k = vec4(150u) - exponent;
    let above = select(vec4<u32>(abs(component.a)) << (k & vec4(31u)), vec4(0u), k >= vec4(32u));
    let left = vec4<f32>(vec4<i32>(above - n * vec4<u32>(component.root.whole)));
    let rest = vec4<f32>(n) * component.root.rest;
    let missing = (left - rest) * component.scale;
    let nearest = floor(missing + 0.5);
    let corrected = n + vec4<u32>(vec4<i32>(nearest));
    let distance = 0.5 - abs(missing - nearest);
    let error = (abs(left) + abs(rest)) * component.scale * FLOAT_ERROR + LEAST_ERROR;
    // Beyond a power of two the last place is another: below it, half of one.
    let below = (corrected == vec4(0x800000u)) & (missing - nearest < vec4(-0.125));
    let leaves = below | (corrected < vec4(0x800000u)) | (corrected > vec4(0x1000000u));
    let magnitude = estimate + vec4<u32>(vec4<i32>(nearest));
    let sign = bitcast<vec4<u32>>(component.estimate) & vec4(SIGN);
    let is_zero = component.estimate == vec4(0.0);
    let float = select(sign | magnitude, vec4(0u), is_zero);
    let doubtful = is_near(distance, error) | leaves;
    if (bits == 32u) {
        return Codes(float, doubtful & !is_zero);
    }
    // Rounded once more: the same, but in the middle between two halves, and where halves have fewer bits.
    let twice = ((magnitude & vec4(0x1fffu)) == vec4(0x1000u)) | (exponent < vec4(114u));
    let half = vec4(half_bits(float.x), half_bits(float.y), half_bits(float.z), half_bits(float.w));
    return Codes(half, (doubtful | twice) & !is_zero);
}
