// z (2h - 1) in IEEE binary32, in the order of `float_parallax` (src/ops/bake/reference.rs).

// Heights beyond 0 and 1 count as 0 and 1.
fn float_parallax(z: u32, height: u32) -> u32 {
    let clamped = select(min(height, ONE), 0u, (height & SIGN) != 0u);
    return zero_below(SMALLEST_COMPONENT, mul(z, sub(scaled(clamped, 1), ONE)));
}
