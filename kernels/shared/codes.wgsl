// Codes: from components to words.

// 8, 16 or 32 bits of a code.
override CODE_BITS: u32 = 8u;
// Whether a code is a float.
override CODE_IS_FLOAT: bool = false;
// Codes stored for a texel: 2 (xy), 3 (xyz) or 4 (xyz and alpha, for textures, which have no three channels).
override CODES_PER_TEXEL: u32 = 3u;

// The bits that store a code.
fn stored_code(code: i32) -> u32 {
    return u32(code + params.code_offset) & params.code_mask;
}

// The codes of four texels, by component.
struct Texels {
    x: vec4<u32>,
    y: vec4<u32>,
    z: vec4<u32>,
}

// Words that four texels take.
fn words_per_invocation() -> u32 {
    return CODES_PER_TEXEL * (CODE_BITS / 8u);
}

// Stores the codes of four texels from word `at` on.
fn store_codes(at: u32, t: Texels) {
    if (CODES_PER_TEXEL == 2u) {
        store_two(at, t);
    } else if (CODES_PER_TEXEL == 3u) {
        store_three(at, t);
    } else {
        store_four(at, t, vec4(params.alpha));
    }
}

fn store_two(at: u32, t: Texels) {
    if (CODE_BITS == 8u) {
        codes[at] = bytes(t.x[0], t.y[0], t.x[1], t.y[1]);
        codes[at + 1u] = bytes(t.x[2], t.y[2], t.x[3], t.y[3]);
    } else if (CODE_BITS == 16u) {
        store_words(at, halves(t.x, t.y));
    } else {
        store_words(at, vec4(t.x[0], t.y[0], t.x[1], t.y[1]));
        store_words(at + 4u, vec4(t.x[2], t.y[2], t.x[3], t.y[3]));
    }
}

fn store_three(at: u32, t: Texels) {
    if (CODE_BITS == 8u) {
        codes[at] = bytes(t.x[0], t.y[0], t.z[0], t.x[1]);
        codes[at + 1u] = bytes(t.y[1], t.z[1], t.x[2], t.y[2]);
        codes[at + 2u] = bytes(t.z[2], t.x[3], t.y[3], t.z[3]);
    } else if (CODE_BITS == 16u) {
        let first = halves(vec4(t.x[0], t.z[0], t.y[1], t.x[2]), vec4(t.y[0], t.x[1], t.z[1], t.y[2]));
        store_words(at, first);
        codes[at + 4u] = t.z[2] | (t.x[3] << 16u);
        codes[at + 5u] = t.y[3] | (t.z[3] << 16u);
    } else {
        store_words(at, vec4(t.x[0], t.y[0], t.z[0], t.x[1]));
        store_words(at + 4u, vec4(t.y[1], t.z[1], t.x[2], t.y[2]));
        store_words(at + 8u, vec4(t.z[2], t.x[3], t.y[3], t.z[3]));
    }
}

fn store_four(at: u32, t: Texels, alpha: vec4<u32>) {
    if (CODE_BITS == 8u) {
        store_words(at, t.x | (t.y << vec4(8u)) | (t.z << vec4(16u)) | (alpha << vec4(24u)));
    } else if (CODE_BITS == 16u) {
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
    codes[at] = words[0];
    codes[at + 1u] = words[1];
    codes[at + 2u] = words[2];
    codes[at + 3u] = words[3];
}

// Four bytes as a word, the first lowest.
fn bytes(a: u32, b: u32, c: u32, d: u32) -> u32 {
    return a | (b << 8u) | (c << 16u) | (d << 24u);
}

// Words of two 16-bit halves each, the first lowest.
fn halves(a: vec4<u32>, b: vec4<u32>) -> vec4<u32> {
    return a | (b << vec4(16u));
}
