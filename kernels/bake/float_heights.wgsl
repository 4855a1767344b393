// Float heights in IEEE binary32, in the order of src/ops/bake/reference.rs.
//
// Numbers are bit patterns for soft_float.wgsl. What repeats is a loop, so that drivers compile each step once.

const SMALLEST_HEIGHT: u32 = 0x12800000u;  // 2^-90: heights below count as zero in slopes
const SMALLEST_SLOPE: u32 = 0x13000000u;   // 2^-89: slopes below 2^-25, over 2^64, count as zero
const STEEP: u32 = 0x3d800000u;            // 2^-4: slopes from 2^60 on, over 2^64

// Whether native floats estimate codes: all have 8 bits, and the stencil is one difference on each axis, so that nothing
// cancels. What IEEE's roundings and the device's add up to is 2.7e-4 of a normal's code, 3.2e-4 of a parallax map's:
// less than estimate.wgsl leaves.
override ESTIMATED: bool = false;

fn bake_four(north: Heights, middle: Heights, south: Heights) -> Four {
    var four: Four;
    var doubtful = vec4(true);
    if (ESTIMATED) {
        let estimate = estimated(north, middle, south);
        four = estimate.four;
        doubtful = estimate.doubtful;
    }
    if (any(doubtful)) {
        // A loop, not four calls: drivers compile the arithmetic once.
        for (var i = 0u; i < TEXELS; i++) {
            if (doubtful[i]) {
                let normal = float_normal(around(north, i), around(middle, i), around(south, i));
                if (NORMAL_CODES > 0u) {
                    let codes = float_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal);
                    four.normals.x[i] = codes.x;
                    four.normals.y[i] = codes.y;
                    four.normals.z[i] = codes.z;
                }
                if (PARALLAX_BITS > 0u) {
                    let parallax = float_parallax(normal.z, middle.here[i]);
                    four.parallaxes[i] = float_code(params.parallax, PARALLAX_IS_FLOAT, PARALLAX_BITS, parallax);
                }
            }
        }
    }
    return four;
}

struct Estimate {
    four: Four,
    doubtful: vec4<bool>,
}

fn estimated(north: Heights, middle: Heights, south: Heights) -> Estimate {
    let normal = native_normals(north, middle, south);
    var result: Estimate;
    if (NORMAL_CODES > 0u) {
        let x = byte_codes(params.normal, normal.x);
        let y = byte_codes(params.normal, normal.y);
        let z = byte_codes(params.normal, normal.z);
        result.four.normals = Texels(x.codes, y.codes, z.codes);
        result.doubtful = x.doubtful | y.doubtful | (z.doubtful & vec4(NORMAL_CODES > 2u));
    }
    if (PARALLAX_BITS > 0u) {
        let parallax = byte_codes(params.parallax, normal.z * height_above_middle(middle.here));
        result.four.parallaxes = parallax.codes;
        result.doubtful = result.doubtful | parallax.doubtful;
    }
    return result;
}

// West, here, east of one texel in one row.
fn around(heights: Heights, i: u32) -> vec3<u32> {
    return vec3(heights.west[i], heights.here[i], heights.east[i]);
}

fn float_normal(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> vec3<u32> {
    let n = vec3(over_64(north.x), over_64(north.y), over_64(north.z));
    let m = vec3(over_64(middle.x), 0u, over_64(middle.z));
    let s = vec3(over_64(south.x), over_64(south.y), over_64(south.z));
    var slope: vec2<u32>;
    for (var axis = 0u; axis < 2u; axis++) {
        let down = axis == 1u;
        let centre = sub(select(m.z, s.y, down), select(m.x, n.y, down));
        var sum = centre;
        if (OUTER != 0) {
            let outer = add(
                sub(select(n.z, s.x, down), n.x),
                sub(s.z, select(s.x, n.z, down)),
            );
            sum = add(mul(bits_of(f32(OUTER)), outer), mul(bits_of(f32(CENTRE)), centre));
        }
        slope[axis] = zero_below(SMALLEST_SLOPE, mul(sum, select(params.kx, params.ky, down)));
    }
    let steep = max(slope.x & ~SIGN, slope.y & ~SIGN) >= STEEP;
    let unit_exponent = select(64, -30, steep);
    // z: 1 or 2^-94.
    return unit(vec3(scaled(slope.x, unit_exponent), scaled(slope.y, unit_exponent), select(ONE, 0x10800000u, steep)));
}

fn over_64(height: u32) -> u32 {
    return scaled(zero_below(SMALLEST_HEIGHT, height), -6);
}
