// Height map to normal map: the normals of one band of rows.
//
// In:  heights, raw words: four u8 or two u16 codes to a word, the first lowest, or one f32; rows begin on words.
// Out: codes, raw words: CODES_PER_TEXEL codes of CODE_BITS for each texel, the first lowest; rows padded to four texels.
//      One word for each row, beyond the codes, says by which dispatch the row was computed.
// An invocation computes four neighbouring texels of one row; no texel is written twice, and nothing is atomic.
//
// CPU twin: src/ops/normal/reference.rs. Source: FGED2 eq. 7.41 to 7.43, listing 7.5.
// The arithmetic (fn normal_codes) is one of kernels/normal/*.wgsl.

struct Params {
    width: u32,            // texels in a row
    rows: u32,             // rows of the band
    above: u32,            // word offset of the row above the first
    body: u32,             // word offset of the first row
    below: u32,            // word offset of the row below the last
    row_words: u32,        // words from one row of heights to the next
    west_of_first: u32,    // column left of column 0, as the edge mode says
    east_of_last: u32,     // column right of the last
    codes: u32,            // word offset of the first row of codes
    codes_row_words: u32,  // words from one row of codes to the next
    marks: u32,            // word offset of the rows' marks
    nonce: u32,            // what marks this dispatch
    px: i32,               // X = px Gx of integer heights
    py: i32,               // Y = py Gy
    z_low: u32,            // Z, 64 bits
    z_high: u32,
    kx: u32,               // slope over 2^64 from Gx / 64 of float heights: f32 bits
    ky: u32,
    centre: i32,           // the stencil: weights of the middle row and of the two others
    outer: i32,
    alpha: u32,            // the fourth code of a texel, if there is one
    code_m: i32,           // the rounding of an integer encoding, floor((m v + c + 1) / 2) (src/exact/round.rs):
    code_c: i32,           // unorm m = c = L; snorm m = 2L, c = 0
    code_least: i32,
    code_greatest: i32,
    code_offset: i32,      // added to store a code
    code_mask: u32,        // keeps the stored bits
    reserved: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> heights: array<u32>;
@group(0) @binding(2) var<storage, read_write> codes: array<u32>;

// Whether each row is marked as computed.
override MARKED: bool = true;

const TEXELS: u32 = 4u;  // texels of an invocation

@compute @workgroup_size(64, 1, 1)
fn normal(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = id.x * TEXELS;
    let row = id.y;
    if (x >= params.width || row >= params.rows) {
        return;
    }
    let here = params.body + row * params.row_words;
    let north = heights_at(select(here - params.row_words, params.above, row == 0u), x);
    let middle = heights_at(here, x);
    let south = heights_at(select(here + params.row_words, params.below, row + 1u == params.rows), x);

    // A loop, not four calls: drivers compile the arithmetic once.
    var texels: Texels;
    for (var i = 0u; i < TEXELS; i++) {
        let code = normal_codes(texel(north, i), texel(middle, i), texel(south, i));
        texels.x[i] = code.x;
        texels.y[i] = code.y;
        texels.z[i] = code.z;
    }
    store_codes(params.codes + row * params.codes_row_words + id.x * words_per_invocation(), texels);
    if (MARKED && x + TEXELS >= params.width) {
        codes[params.marks + row] = params.nonce;
    }
}

// The heights of four texels of a row with their neighbours to the west and to the east, as raw bits.
struct Heights {
    west: vec4<u32>,
    here: vec4<u32>,
    east: vec4<u32>,
}

fn heights_at(row: u32, x: u32) -> Heights {
    let here = four_heights(row, x);
    let first = height(row, select(x - 1u, params.west_of_first, x == 0u));
    let next = height(row, min(x + TEXELS, params.width - 1u));
    var east = vec4(here.yzw, next);
    if (x + TEXELS >= params.width) {
        let columns = x + vec4(0u, 1u, 2u, 3u);
        east = select(east, vec4(height(row, params.east_of_last)), columns == vec4(params.width - 1u));
    }
    return Heights(vec4(first, here.xyz), here, east);
}

// West, here, east of one texel in one row.
fn texel(heights: Heights, i: u32) -> vec3<u32> {
    return vec3(heights.west[i], heights.here[i], heights.east[i]);
}

// Gx, Gy of integer heights, each row given as west, here, east.
fn integer_sums(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> vec2<i32> {
    let n = vec3<i32>(north);
    let m = vec3<i32>(middle);
    let s = vec3<i32>(south);
    return vec2(
        params.outer * ((n.z - n.x) + (s.z - s.x)) + params.centre * (m.z - m.x),
        params.outer * ((s.x - n.x) + (s.z - n.z)) + params.centre * (s.y - n.y),
    );
}
