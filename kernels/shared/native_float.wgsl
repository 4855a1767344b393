// The operations of soft_float.wgsl, gradual.wgsl and acos.wgsl in the device's own f32, for `fast` precision.
//
// Numbers stay bit patterns, so that a formula is one text for both. They may be off by a few units of their last
// place, and below 2^-126 they may be zero. No infinity and no NaN arises where none does in IEEE.

const SIGN: u32 = 0x80000000u;

const ONE: u32 = 0x3f800000u;

fn bits_of(a: f32) -> u32 {
    return bitcast<u32>(a);
}

fn float_of(a: u32) -> f32 {
    return bitcast<f32>(a);
}

// a, or zero if its magnitude is below `least`.
fn zero_below(least: u32, a: u32) -> u32 {
    return select(a, 0u, (a & ~SIGN) < least);
}

fn add(a: u32, b: u32) -> u32 {
    return bits_of(float_of(a) + float_of(b));
}

fn sub(a: u32, b: u32) -> u32 {
    return bits_of(float_of(a) - float_of(b));
}

fn mul(a: u32, b: u32) -> u32 {
    return bits_of(float_of(a) * float_of(b));
}

fn square_root(a: u32) -> u32 {
    return bits_of(sqrt(float_of(a)));
}

// 1 / a for a above zero. What has become zero instead has no inverse: that is zero.
fn inverse(a: u32) -> u32 {
    return select(bits_of(1.0 / float_of(a)), 0u, a < 0x00800000u);
}

// The angle with this cosine, from -1 to 1.
fn angle(cosine: u32) -> u32 {
    return bits_of(acos(float_of(cosine)));
}
