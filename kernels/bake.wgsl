// Height map to normal map, parallax map or both: the texels of one band of rows.
//
// In:  inputs, raw words: four u8 or two u16 codes to a word, the first lowest, or one f32; rows begin on words.
// Out: outputs, raw words: the codes of each texel, the first lowest, of each map; rows padded to four texels.
//      One word for each row, beyond the codes, says by which dispatch the row was computed.
// An invocation computes four neighbouring texels of one row; no texel is written twice, and nothing is atomic.
//
// CPU twin: src/ops/bake/reference.rs. Source: FGED2 eq. 7.41 to 7.43, listing 7.5, section 7.7.
// The arithmetic (fn bake_four) is one of kernels/bake/*.wgsl.

struct Params {
    width: u32,          // texels in a row
    rows: u32,           // rows of the band
    above: u32,          // word offset of the row above the first
    body: u32,           // word offset of the first row
    below: u32,          // word offset of the row below the last
    row_words: u32,      // words from one row of heights to the next
    west_of_first: u32,  // column left of column 0, as the edge mode says
    east_of_last: u32,   // column right of the last
    marks: u32,          // word offset of the rows' marks
    nonce: u32,          // what marks this dispatch
    px: i32,             // X = px Gx of integer heights
    py: i32,             // Y = py Gy
    z_low: u32,          // Z, 64 bits
    z_high: u32,
    z_over_m: u32,       // Z / M of integer heights up to M, for a parallax map
    kx: u32,             // slope over 2^64 from Gx / 64 of float heights: f32 bits
    ky: u32,
    doubt: u32,          // how near to a boundary integers decide, 1: f32 bits (kernels/shared/estimate.wgsl)
    reserved: u32,
    alpha: u32,          // the fourth code of a normal, if there is one
    normal: Output,
    parallax: Output,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> inputs: array<u32>;
@group(0) @binding(2) var<storage, read_write> outputs: array<u32>;

// Codes stored of a texel's normal: 0 (no normal map), 2 (xy), 3 (xyz) or 4 (xyz and alpha, for textures, which have no
// three channels), their bits (8, 16, 32), and whether they are floats.
override NORMAL_CODES: u32 = 3u;
override NORMAL_BITS: u32 = 8u;
override NORMAL_IS_FLOAT: bool = false;
// Bits of the parallax code: 0 (no parallax map), 8, 16 or 32.
override PARALLAX_BITS: u32 = 0u;
override PARALLAX_IS_FLOAT: bool = false;
// The stencil: weights of the middle row and of the two others.
override CENTRE: i32 = 1;
override OUTER: i32 = 0;
// Whether each row is marked as computed.
override MARKED: bool = true;

const TEXELS: u32 = 4u;  // texels of an invocation

// The codes of four texels.
struct Four {
    normals: Texels,
    parallaxes: vec4<u32>,
}

@compute @workgroup_size(64, 1, 1)
fn bake(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = id.x * TEXELS;
    let row = id.y;
    if (x >= params.width || row >= params.rows) {
        return;
    }
    let here = params.body + row * params.row_words;
    let north = heights_at(select(here - params.row_words, params.above, row == 0u), x);
    let middle = heights_at(here, x);
    let south = heights_at(select(here + params.row_words, params.below, row + 1u == params.rows), x);

    let four = bake_four(north, middle, south);
    if (NORMAL_CODES > 0u) {
        let at = word_of_four(params.normal, row, id.x, NORMAL_CODES, NORMAL_BITS);
        store_texels(at, four.normals, params.alpha, NORMAL_CODES, NORMAL_BITS);
    }
    if (PARALLAX_BITS > 0u) {
        store_one(word_of_four(params.parallax, row, id.x, 1u, PARALLAX_BITS), four.parallaxes, PARALLAX_BITS);
    }
    if (MARKED && x + TEXELS >= params.width) {
        outputs[params.marks + row] = params.nonce;
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

// Gx, Gy of four texels.
struct Sums {
    x: vec4<i32>,
    y: vec4<i32>,
}

// Of integer heights.
fn integer_sums(north: Heights, middle: Heights, south: Heights) -> Sums {
    let x = CENTRE * difference(middle.east, middle.west);
    let y = CENTRE * difference(south.here, north.here);
    if (OUTER == 0) {
        return Sums(x, y);
    }
    return Sums(
        OUTER * (difference(north.east, north.west) + difference(south.east, south.west)) + x,
        OUTER * (difference(south.west, north.west) + difference(south.east, north.east)) + y,
    );
}

fn difference(a: vec4<u32>, b: vec4<u32>) -> vec4<i32> {
    return vec4<i32>(a) - vec4<i32>(b);
}

// 2H - M of integer heights H up to M.
fn twice_above_middle(heights: vec4<u32>) -> vec4<i32> {
    return 2 * vec4<i32>(heights) - select(255, 65535, HEIGHT_BITS == 16u);
}
