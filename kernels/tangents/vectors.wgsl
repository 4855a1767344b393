// Vectors of bit patterns, in the order of src/ops/tangents/formula.rs.

const MINUS_ZERO: u32 = SIGN;  // added to a number, it changes none, not even a zero

// The sign bit that `sign` has: of 1 above zero, else of -1.
fn sign_of(a: u32) -> u32 {
    return select(SIGN, 0u, a - 1u < 0x7fffffffu);
}

fn is_zero(v: vec3<u32>) -> bool {
    return all((v & vec3(~SIGN)) == vec3(0u));
}

fn dot3(a: vec3<u32>, b: vec3<u32>) -> u32 {
    var sum = MINUS_ZERO;
    for (var axis = 0u; axis < 3u; axis++) {
        sum = add(sum, mul(a[axis], b[axis]));
    }
    return sum;
}

fn cross3(a: vec3<u32>, b: vec3<u32>) -> vec3<u32> {
    return by_axis(a.yzx, b.zxy, a.zxy, b.yzx);
}

// a b - c d on each axis.
fn by_axis(a: vec3<u32>, b: vec3<u32>, c: vec3<u32>, d: vec3<u32>) -> vec3<u32> {
    var v: vec3<u32>;
    for (var axis = 0u; axis < 3u; axis++) {
        v[axis] = sub(mul(a[axis], b[axis]), mul(c[axis], d[axis]));
    }
    return v;
}

fn sum3(a: vec3<u32>, b: vec3<u32>) -> vec3<u32> {
    var v: vec3<u32>;
    for (var axis = 0u; axis < 3u; axis++) {
        v[axis] = add(a[axis], b[axis]);
    }
    return v;
}

fn difference3(a: vec3<u32>, b: vec3<u32>) -> vec3<u32> {
    return sum3(a, b ^ vec3(SIGN));
}

fn times3(factor: u32, v: vec3<u32>) -> vec3<u32> {
    var w: vec3<u32>;
    for (var axis = 0u; axis < 3u; axis++) {
        w[axis] = mul(factor, v[axis]);
    }
    return w;
}

// v without its part along n.
fn projected(n: vec3<u32>, v: vec3<u32>) -> vec3<u32> {
    return difference3(v, times3(dot3(n, v), n));
}

// v over its length; zero stays zero.
fn unit(v: vec3<u32>) -> vec3<u32> {
    let magnitudes = v & vec3(~SIGN);
    let greatest = max(max(magnitudes.x, magnitudes.y), magnitudes.z);
    if (greatest == 0u) {
        return vec3(0u);
    }
    // A power of two that brings the greatest component between 1 and 2; for one of 2^127 the least that is no subnormal.
    let factor = max(0x7f000000u - (greatest & 0x7f800000u), 0x00800000u);
    let near_one = times3(factor, v);
    return times3(inverse(square_root(dot3(near_one, near_one))), near_one);
}
