// Significands and rounding for soft_float.wgsl with subnormals, operands and results: gradual underflow, as in IEEE.

// Of a subnormal, what it would be if exponents went on below 1; of zero, less than any.
fn exponent_of(a: u32) -> i32 {
    return max(i32((a >> 23u) & 0xffu), 1) - zeros_before(a);
}

// 24 bits with the leading one; of zero, zero.
fn significand_of(a: u32) -> u32 {
    let leading = select(0u, 0x800000u, (a & 0x7f800000u) != 0u);
    return ((a & 0x7fffffu) | leading) << u32(zeros_before(a));
}

// Places by which a subnormal's leading one stands below that of a normal number.
fn zeros_before(a: u32) -> i32 {
    return select(0, i32(countLeadingZeros(a & 0x7fffffu)) - 8, (a & 0x7f800000u) == 0u);
}

// The float nearest to m 2^(exponent - 153), 0 < m < 2^28: a significand and three bits more.
fn rounded(sign: u32, exponent: i32, m: u32) -> u32 {
    let left = i32(countLeadingZeros(m)) - 5;
    let normal = select(m << u32(max(left, 0)), (m >> 1u) | (m & 1u), left < 0);
    let e = exponent - left;
    let n = shifted_sticky(normal, max(1 - e, 0));
    // More than half of the last place rounds up, and so does half of an odd one. A leading one counts the exponent up,
    // and so does a carry out of the significand.
    return sign | ((u32(max(e, 1) - 1) << 23u) + ((n + 3u + ((n >> 3u) & 1u)) >> 3u));
}
