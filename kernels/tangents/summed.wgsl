// The sum of a fan's frames, projected and normalised (FGED2 eq. 7.38 and 7.40).

const FRAME_WORDS: u32 = 7u;

const LEAST_SUM: u32 = 0x37800000u;     // 2^-16 of what the sum would be if nothing cancelled
const LEAST_SQUARE: u32 = 0x2f800000u;  // 2^-32: of the part at a right angle to the normal

fn tangent_of(normal: vec3<u32>, begin: u32, end: u32) -> Tangent {
    var sum: array<vec3<u32>, 3>;  // of t, of b; then the normal
    var magnitude = 0u;
    var computed = true;
    for (var i = begin; i < end; i++) {
        let at = params.frames + FRAME_WORDS * (inputs[params.corners + i] >> 2u);
        computed = computed && is_computed(outputs[at + 6u]);
        magnitude = add(magnitude, size_of(output_at(at)));
        for (var vector = 0u; vector < 2u; vector++) {
            sum[vector] = sum3(sum[vector], output_at(at + 3u * vector));
        }
    }
    let cancels = size_of(sum[0]) < mul(LEAST_SUM, magnitude);
    sum[2] = normal;
    for (var vector = 0u; vector < 3u; vector++) {
        sum[vector] = unit(sum[vector]);
    }
    let n = sum[2];
    let turned = sign_of(dot3(cross3(sum[0], sum[1]), n));
    let tangent = projected(n, sum[0]);
    if (cancels || dot3(tangent, tangent) < LEAST_SQUARE) {
        return Tangent(vec3(0u), turned, computed);
    }
    return Tangent(unit(tangent), turned, computed);
}

// |x| + |y| + |z|.
fn size_of(v: vec3<u32>) -> u32 {
    let parts = v & vec3(~SIGN);
    return add(add(parts.x, parts.y), parts.z);
}
