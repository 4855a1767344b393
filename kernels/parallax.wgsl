// Heights and a normal map to a parallax map: the texels of one band of rows.
//
// In:  inputs, raw words: heights, one code for each texel, and a normal map. Rows begin on words and are padded to
//      four texels.
// Out: outputs, raw words: a code for each texel, the first lowest. Rows are padded to four texels.
//      One word for each row, beyond the codes, says by which dispatch the row was computed.
// An invocation computes four neighbouring texels of one row; no texel is written twice, and nothing is atomic.
//
// CPU twin: src/ops/parallax/reference.rs. Source: FGED2 section 7.7: n_z (2h - 1).
// The arithmetic (fn parallax_four) is one of kernels/parallax/*.wgsl.

struct Params {
    width: u32,          // texels in a row
    rows: u32,           // rows of the band
    marks: u32,          // word offset of the rows' marks
    nonce: u32,          // what marks this dispatch
    doubt: u32,          // how near to a boundary integers decide, 1: f32 bits (kernels/shared/estimate.wgsl)
    reserved_1: u32,
    reserved_2: u32,
    reserved_3: u32,
    heights: Input,
    normals: Input,
    parallax: Output,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> inputs: array<u32>;
@group(0) @binding(2) var<storage, read_write> outputs: array<u32>;

// Bits of a height: 8, 16 or, of a float, 32.
override HEIGHT_BITS: u32 = 16u;
// Codes of a texel of the normal map, 2 (xy) or 3 (xyz), and their bits: 8, 16 or, of floats, 32.
override NORMAL_CODES: u32 = 3u;
override NORMAL_BITS: u32 = 8u;
// Bits of a stored code (8, 16, 32), and whether it is a float.
override PARALLAX_BITS: u32 = 8u;
override PARALLAX_IS_FLOAT: bool = false;
// Whether each row is marked as computed.
override MARKED: bool = true;

const TEXELS: u32 = 4u;  // texels of an invocation

@compute @workgroup_size(64, 1, 1)
fn parallax(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = id.x * TEXELS;
    let row = id.y;
    if (x >= params.width || row >= params.rows) {
        return;
    }
    let heights = four_codes(params.heights, row, id.x, HEIGHT_BITS);
    let normals = four_texels(params.normals, row, id.x, NORMAL_CODES, NORMAL_BITS);

    let codes = parallax_four(heights, normals);
    store_one(word_of_four(params.parallax, row, id.x, 1u, PARALLAX_BITS), codes, PARALLAX_BITS);
    if (MARKED && x + TEXELS >= params.width) {
        outputs[params.marks + row] = params.nonce;
    }
}

// 2H - M of integer heights H up to M.
fn twice_above_middle(heights: vec4<u32>) -> vec4<i32> {
    return 2 * vec4<i32>(heights) - params.heights.greatest;
}
