// Tangents of a mesh: first a frame for each triangle, then a tangent for each fan of corners.
//
// In:  inputs, raw words: positions (x, y, z of each vertex, scaled), texture differences (x1, y1, x2, y2 of each
//      triangle, scaled), triangles (three vertices each), normals (x, y, z of each fan), offsets (where each fan's
//      corners begin, and where the last one's end), corners (4 triangle + number, ascending in each fan).
// Out: outputs, raw words: frames (FRAME_WORDS for each triangle), tangents (x, y, z of each fan).
//      Each of them ends with a word of proof: the nonce of this job, with a sign in its top bit.
// An invocation computes one triangle or one fan; no word is written twice, and nothing is atomic.
//
// CPU twin: src/ops/tangents/formula.rs and reference.rs. Source: FGED2 section 7.5; Hegde; MikkTSpace.
// The entry point is that of kernels/tangents/triangles.wgsl or fans.wgsl, the formula one of those beside them. Numbers
// are bit patterns for soft_float.wgsl or native_float.wgsl. What repeats is a loop, so that drivers compile it once.

struct Params {
    first: u32,      // the first triangle or fan of this dispatch
    end: u32,        // the one after its last
    nonce: u32,      // what proves a result to be of this job, below 2^31
    positions: u32,  // word offsets in inputs
    edges: u32,
    triangles: u32,
    normals: u32,
    offsets: u32,
    corners: u32,
    frames: u32,     // word offsets in outputs
    tangents: u32,
    longest_row: u32,  // corners of a fan; the host sums longer ones
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> inputs: array<u32>;
@group(0) @binding(2) var<storage, read_write> outputs: array<u32>;

// Three words of inputs.
fn vector_at(at: u32) -> vec3<u32> {
    return vec3(inputs[at], inputs[at + 1u], inputs[at + 2u]);
}

// Three words of outputs.
fn output_at(at: u32) -> vec3<u32> {
    return vec3(outputs[at], outputs[at + 1u], outputs[at + 2u]);
}

fn store(at: u32, v: vec3<u32>) {
    outputs[at] = v.x;
    outputs[at + 1u] = v.y;
    outputs[at + 2u] = v.z;
}

// The position of corner `number` (0, 1, 2) of a triangle.
fn position(triangle: u32, number: u32) -> vec3<u32> {
    return vector_at(params.positions + 3u * inputs[params.triangles + 3u * triangle + number]);
}
