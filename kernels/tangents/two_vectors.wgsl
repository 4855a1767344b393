// Frames of two vectors, t where u grows and b where v grows.

const FRAME_WORDS: u32 = 7u;

const SMALLEST_DIFFERENCE: u32 = 0x35800000u;  // 2^-20: differences of texture coordinates below count as zero

struct Frame {
    t: vec3<u32>,
    b: vec3<u32>,
}

fn store_frame(triangle: u32, edges: Edges) {
    let x1 = zero_below(SMALLEST_DIFFERENCE, edges.x1);
    let y1 = zero_below(SMALLEST_DIFFERENCE, edges.y1);
    let x2 = zero_below(SMALLEST_DIFFERENCE, edges.x2);
    let y2 = zero_below(SMALLEST_DIFFERENCE, edges.y2);
    let determinant = sub(mul(x1, y2), mul(x2, y1));
    var frame: Frame;
    if ((determinant & ~SIGN) != 0u) {
        frame = frame_of(Edges(edges.e1, edges.e2, x1, y1, x2, y2), determinant);
    }
    let at = params.frames + FRAME_WORDS * triangle;
    store(at, frame.t);
    store(at + 3u, frame.b);
    outputs[at + 6u] = params.nonce;
}
