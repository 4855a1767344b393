// Heights, or a mask, in packed words: four u8 or two u16 codes to a word, the first lowest, or one f32.

// 8, 16 or 32 bits of a height.
override HEIGHT_BITS: u32 = 16u;

// The bits of the height in column x of the row that begins at word `row`.
fn height(row: u32, x: u32) -> u32 {
    if (HEIGHT_BITS == 8u) {
        return extractBits(inputs[row + (x >> 2u)], (x & 3u) * 8u, 8u);
    }
    if (HEIGHT_BITS == 16u) {
        return extractBits(inputs[row + (x >> 1u)], (x & 1u) * 16u, 16u);
    }
    return inputs[row + x];
}

// The bits of the four heights from column x on, a multiple of four. Columns beyond the row give any bits.
fn four_heights(row: u32, x: u32) -> vec4<u32> {
    if (HEIGHT_BITS == 8u) {
        let word = inputs[row + (x >> 2u)];
        return (vec4(word) >> vec4(0u, 8u, 16u, 24u)) & vec4(0xffu);
    }
    if (HEIGHT_BITS == 16u) {
        let at = row + (x >> 1u);
        let words = vec2(inputs[at], inputs[at + 1u]);
        return vec4(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu, words.y >> 16u);
    }
    let at = row + x;
    return vec4(inputs[at], inputs[at + 1u], inputs[at + 2u], inputs[at + 3u]);
}
