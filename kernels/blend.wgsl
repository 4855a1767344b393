// Two normal maps to one: the normals of one band of rows.
//
// In:  inputs, raw words: two normal maps and, perhaps, a mask, a code of it for each texel. Rows begin on words and
//      are padded to four texels.
// Out: outputs, raw words: the codes of each texel, the first lowest. Rows are padded to four texels.
//      One word for each row, beyond the codes, says by which dispatch the row was computed.
// An invocation computes four neighbouring texels of one row; no texel is written twice, and nothing is atomic.
//
// CPU twin: src/ops/blend/reference.rs. Source: FGED2 eq. 7.46 and 7.47; Hill and Barré-Brisebois, Blending in Detail.
// The arithmetic (fn blended_four) is one of kernels/blend/*.wgsl.

struct Params {
    width: u32,          // texels in a row
    rows: u32,           // rows of the band
    marks: u32,          // word offset of the rows' marks
    nonce: u32,          // what marks this dispatch
    a: i32,              // the weights a/q and b/q where there is no mask
    b: i32,
    q: i32,
    doubt: u32,          // how near to a boundary integers decide, 1: f32 bits (kernels/shared/estimate.wgsl)
    base: Input,
    detail: Input,
    mask: Input,
    normal: Output,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> inputs: array<u32>;
@group(0) @binding(2) var<storage, read_write> outputs: array<u32>;

// The formula.
override METHOD: u32 = 0u;
const WEIGHTED: u32 = 0u;
const LINEAR: u32 = 1u;
const OVERLAY: u32 = 2u;
const UDN: u32 = 3u;
const WHITEOUT: u32 = 4u;
const RNM: u32 = 5u;

// Codes of a texel of each map, 2 (xy) or 3 (xyz), and their bits: 8, 16 or, of floats, 32.
override BASE_CODES: u32 = 3u;
override BASE_BITS: u32 = 8u;
override DETAIL_CODES: u32 = 3u;
override DETAIL_BITS: u32 = 8u;
// Bits of the mask's codes: 0 (no mask), 8 or 16.
override MASK_BITS: u32 = 0u;
// Codes stored of a texel, 2 or 3, their bits (8, 16, 32), and whether they are floats.
override NORMAL_CODES: u32 = 3u;
override NORMAL_BITS: u32 = 8u;
override NORMAL_IS_FLOAT: bool = false;
// Whether each row is marked as computed.
override MARKED: bool = true;

const TEXELS: u32 = 4u;  // texels of an invocation

@compute @workgroup_size(64, 1, 1)
fn blend(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = id.x * TEXELS;
    let row = id.y;
    if (x >= params.width || row >= params.rows) {
        return;
    }
    let base = four_texels(params.base, row, id.x, BASE_CODES, BASE_BITS);
    let detail = four_texels(params.detail, row, id.x, DETAIL_CODES, DETAIL_BITS);
    var mask: vec4<u32>;
    if (MASK_BITS > 0u) {
        mask = four_codes(params.mask, row, id.x, MASK_BITS);
    }

    let normals = blended_four(base, detail, weights(mask));
    let at = word_of_four(params.normal, row, id.x, NORMAL_CODES, NORMAL_BITS);
    store_texels(at, normals, 0u, NORMAL_CODES, NORMAL_BITS);
    if (MARKED && x + TEXELS >= params.width) {
        outputs[params.marks + row] = params.nonce;
    }
}

// The numerators a and b of both weights and their denominator q: M - H, H and M of a mask.
struct Weights {
    a: vec4<i32>,
    b: vec4<i32>,
    q: i32,
}

fn weights(transition: vec4<u32>) -> Weights {
    if (MASK_BITS > 0u) {
        let greatest = params.mask.greatest;
        return Weights(greatest - vec4<i32>(transition), vec4<i32>(transition), greatest);
    }
    return Weights(vec4(params.a), vec4(params.b), params.q);
}

// Of one of four texels: a, b, q.
fn weights_of(weights: Weights, i: u32) -> vec3<i32> {
    return vec3(weights.a[i], weights.b[i], weights.q);
}
