// Significands and rounding for soft_float.wgsl where a result below 2^-126 becomes zero.
//
// A kernel with it is written so that this cannot be told from the whole of IEEE: no subnormal is an operand.

fn exponent_of(a: u32) -> i32 {
    return i32((a >> 23u) & 0xffu);
}

// 24 bits with the leading one; of zero, zero.
fn significand_of(a: u32) -> u32 {
    return select((a & 0x7fffffu) | 0x800000u, 0u, (a & ~SIGN) == 0u);
}

// The float nearest to m 2^(exponent - 153), 0 < m < 2^28: a significand and three bits more.
fn rounded(sign: u32, exponent: i32, m: u32) -> u32 {
    let left = i32(countLeadingZeros(m)) - 5;
    let n = select(m << u32(max(left, 0)), (m >> 1u) | (m & 1u), left < 0);
    let e = exponent - left;
    // More than half of the last place rounds up, and so does half of an odd one. The leading one counts the exponent up,
    // and so does a carry out of the significand.
    let magnitude = (u32(e - 1) << 23u) + ((n + 3u + ((n >> 3u) & 1u)) >> 3u);
    return sign | select(magnitude, 0u, e < 1);
}
