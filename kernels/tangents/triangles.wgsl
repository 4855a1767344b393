// The frame of each triangle.

struct Edges {
    e1: vec3<u32>,
    e2: vec3<u32>,
    x1: u32,
    y1: u32,
    x2: u32,
    y2: u32,
}

@compute @workgroup_size(64, 1, 1)
fn frames(@builtin(global_invocation_id) id: vec3<u32>) {
    let triangle = params.first + id.x;
    if (triangle >= params.end) {
        return;
    }
    let p0 = position(triangle, 0u);
    let e1 = difference3(position(triangle, 1u), p0);
    let e2 = difference3(position(triangle, 2u), p0);
    let at = params.edges + 4u * triangle;
    store_frame(triangle, Edges(e1, e2, inputs[at], inputs[at + 1u], inputs[at + 2u], inputs[at + 3u]));
}
