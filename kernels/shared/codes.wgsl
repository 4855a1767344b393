// Codes: from components to words. A map's codes have 8, 16 or 32 bits; a kernel gives `bits` and the number of codes of
// a texel as constants, so that one branch of each choice is left.

// How one map lies in `outputs`, and how its integer codes are rounded: floor((m v + c + 1) / 2) (src/exact/round.rs).
struct Output {
    place: u32,          // word offset of the first row
    row_words: u32,      // words from one row to the next
    code_m: i32,         // unorm m = c = L; snorm m = 2L, c = 0
    code_c: i32,
    code_least: i32,
    code_greatest: i32,
    code_offset: i32,    // added to store a code
    code_mask: u32,      // keeps the stored bits
}

// The bits that store an integer code.
fn stored_code(output: Output, code: i32) -> u32 {
    return u32(code + output.code_offset) & output.code_mask;
}

// The words of four texels from column 4 `group` on begin here.
fn word_of_four(output: Output, row: u32, group: u32, codes_of_texel: u32, bits: u32) -> u32 {
    return output.place + row * output.row_words + group * (codes_of_texel * bits / 8u);
}

// The codes of four texels, by component.
struct Texels {
    x: vec4<u32>,
    y: vec4<u32>,
    z: vec4<u32>,
}

// Stores two (xy), three (xyz) or four (xyz and alpha) codes for each of four texels from word `at` on.
fn store_texels(at: u32, t: Texels, alpha: u32, codes_of_texel: u32, bits: u32) {
    if (codes_of_texel == 2u) {
        store_two(at, t, bits);
    } else if (codes_of_texel == 3u) {
        store_three(at, t, bits);
    } else {
        store_four(at, t, vec4(alpha), bits);
    }
}

// Stores one code for each of four texels.
fn store_one(at: u32, t: vec4<u32>, bits: u32) {
    if (bits == 8u) {
        outputs[at] = bytes(t[0], t[1], t[2], t[3]);
    } else if (bits == 16u) {
        outputs[at] = t[0] | (t[1] << 16u);
        outputs[at + 1u] = t[2] | (t[3] << 16u);
    } else {
        store_words(at, t);
    }
}

fn store_two(at: u32, t: Texels, bits: u32) {
    if (bits == 8u) {
        outputs[at] = bytes(t.x[0], t.y[0], t.x[1], t.y[1]);
        outputs[at + 1u] = bytes(t.x[2], t.y[2], t.x[3], t.y[3]);
    } else if (bits == 16u) {
        store_words(at, halves(t.x, t.y));
    } else {
        store_words(at, vec4(t.x[0], t.y[0], t.x[1], t.y[1]));
        store_words(at + 4u, vec4(t.x[2], t.y[2], t.x[3], t.y[3]));
    }
}

fn store_three(at: u32, t: Texels, bits: u32) {
    if (bits == 8u) {
        outputs[at] = bytes(t.x[0], t.y[0], t.z[0], t.x[1]);
        outputs[at + 1u] = bytes(t.y[1], t.z[1], t.x[2], t.y[2]);
        outputs[at + 2u] = bytes(t.z[2], t.x[3], t.y[3], t.z[3]);
    } else if (bits == 16u) {
        let first = halves(vec4(t.x[0], t.z[0], t.y[1], t.x[2]), vec4(t.y[0], t.x[1], t.z[1], t.y[2]));
        store_words(at, first);
        outputs[at + 4u] = t.z[2] | (t.x[3] << 16u);
        outputs[at + 5u] = t.y[3] | (t.z[3] << 16u);
    } else {
        store_words(at, vec4(t.x[0], t.y[0], t.z[0], t.x[1]));
        store_words(at + 4u, vec4(t.y[1], t.z[1], t.x[2], t.y[2]));
        store_words(at + 8u, vec4(t.z[2], t.x[3], t.y[3], t.z[3]));
    }
}

fn store_four(at: u32, t: Texels, alpha: vec4<u32>, bits: u32) {
    if (bits == 8u) {
        store_words(at, t.x | (t.y << vec4(8u)) | (t.z << vec4(16u)) | (alpha << vec4(24u)));
    } else if (bits == 16u) {
        let xy = halves(t.x, t.y);
        let za = halves(t.z, alpha);
        store_words(at, vec4(xy[0], za[0], xy[1], za[1]));
        store_words(at + 4u, vec4(xy[2], za[2], xy[3], za[3]));
    } else {
        store_words(at, vec4(t.x[0], t.y[0], t.z[0], alpha[0]));
        store_words(at + 4u, vec4(t.x[1], t.y[1], t.z[1], alpha[1]));
        store_words(at + 8u, vec4(t.x[2], t.y[2], t.z[2], alpha[2]));
        store_words(at + 12u, vec4(t.x[3], t.y[3], t.z[3], alpha[3]));
    }
}

fn store_words(at: u32, words: vec4<u32>) {
    outputs[at] = words[0];
    outputs[at + 1u] = words[1];
    outputs[at + 2u] = words[2];
    outputs[at + 3u] = words[3];
}

// Four bytes as a word, the first lowest.
fn bytes(a: u32, b: u32, c: u32, d: u32) -> u32 {
    return a | (b << 8u) | (c << 16u) | (d << 24u);
}

// Words of two 16-bit halves each, the first lowest.
fn halves(a: vec4<u32>, b: vec4<u32>) -> vec4<u32> {
    return a | (b << vec4(16u));
}
