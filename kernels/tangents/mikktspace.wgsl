// MikkTSpace's first derivative by u, normalised: frames of one vector.

const FRAME_WORDS: u32 = 4u;

// The word of proof has the sign of the texture's area.
fn store_frame(triangle: u32, edges: Edges) {
    let area = sub(mul(edges.x1, edges.y2), mul(edges.y1, edges.x2));
    let turned = sign_of(area);
    var s: vec3<u32>;
    if ((area & ~SIGN) != 0u) {
        s = unit(by_axis(vec3(edges.y2), edges.e1, vec3(edges.y1), edges.e2)) ^ vec3(turned);
    }
    let at = params.frames + FRAME_WORDS * triangle;
    store(at, s);
    outputs[at + 3u] = params.nonce | turned;
}
