// Hegde's unit vectors of a face.

fn frame_of(edges: Edges, determinant: u32) -> Frame {
    let u1 = unit(edges.e1);
    let u2 = unit(edges.e2);
    let n = cross3(u1, u2);
    if (is_zero(n)) {
        return Frame();
    }
    let along_first = (edges.x1 & ~SIGN) != 0u;
    let turned = sign_of(select(edges.x2, edges.x1, along_first));
    let t = select(u2, u1, along_first) ^ vec3(turned);
    let b = unit(cross3(n, t)) ^ vec3(sign_of(determinant));
    return Frame(t, b);
}
