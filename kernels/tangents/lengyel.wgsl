// FGED2 eq. 7.37.

fn frame_of(edges: Edges, determinant: u32) -> Frame {
    let r = inverse(determinant & ~SIGN) ^ (determinant & SIGN);
    var frame: Frame;
    for (var vector = 0u; vector < 2u; vector++) {
        let is_t = vector == 0u;
        let a = select(edges.x1, edges.y2, is_t);
        let b = select(edges.x2, edges.y1, is_t);
        let of_a = select(edges.e2, edges.e1, is_t);
        let of_b = select(edges.e1, edges.e2, is_t);
        let sum = times3(r, by_axis(vec3(a), of_a, vec3(b), of_b));
        if (is_t) {
            frame.t = sum;
        } else {
            frame.b = sum;
        }
    }
    return frame;
}
