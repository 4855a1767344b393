// MikkTSpace's sum of a fan's frames, each projected and weighted by its corner's angle in the tangent plane.

const FRAME_WORDS: u32 = 4u;

fn tangent_of(n: vec3<u32>, begin: u32, end: u32) -> Tangent {
    var sum: vec3<u32>;
    var turned = SIGN;
    var computed = true;
    for (var i = begin; i < end; i++) {
        let corner = inputs[params.corners + i];
        let triangle = corner >> 2u;
        let at = params.frames + FRAME_WORDS * triangle;
        let proof = outputs[at + 3u];
        computed = computed && is_computed(proof);
        turned = select(turned, proof & SIGN, i == begin);
        sum = sum3(sum, share(n, output_at(at), triangle, corner & 3u));
    }
    return Tangent(unit(sum), turned, computed);
}

// What a triangle with the frame s adds at its corner `number`.
fn share(n: vec3<u32>, s: vec3<u32>, triangle: u32, number: u32) -> vec3<u32> {
    let p = position(triangle, number);
    // Towards the next corner, towards the one before, and s: in the tangent plane.
    var directions: array<vec3<u32>, 3>;
    for (var i = 0u; i < 3u; i++) {
        var v = s;
        if (i < 2u) {
            let other = number + 1u + i;
            v = difference3(position(triangle, select(other, other - 3u, other > 2u)), p);
        }
        directions[i] = unit(projected(n, v));
    }
    let cosine = dot3(directions[0], directions[1]);
    // No more than 1 in magnitude.
    let clamped = min(cosine & ~SIGN, ONE) | (cosine & SIGN);
    return times3(angle(clamped), directions[2]);
}
