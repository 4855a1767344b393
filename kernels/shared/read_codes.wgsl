// Maps as inputs: from words to codes, and from codes to the integers that they stand for. A kernel gives the number of
// codes of a texel and their `bits` as constants, so that one branch of each choice is left.

// How one map lies in `inputs`, and how its integer codes are read (src/exact/read.rs).
struct Input {
    place: u32,          // word offset of the first row
    row_words: u32,      // words from one row to the next
    flip: u32,           // turns a stored code into an unsigned one c in the order of the components
    factor: i32,         // u = factor c - centre
    centre: i32,
    greatest: i32,       // the greatest component L; of heights and masks, the greatest code M
    over_greatest: u32,  // 1 / greatest: f32 bits
    green: i32,          // 1, or -1 to turn green around
}

// The codes of four texels, 4 `group` and on, of two or three channels; of two, z is zero.
fn four_texels(input: Input, row: u32, group: u32, codes_of_texel: u32, bits: u32) -> Texels {
    let at = input.place + row * input.row_words + group * (codes_of_texel * bits / 8u);
    if (codes_of_texel == 2u) {
        return four_twos(at, bits);
    }
    return four_threes(at, bits);
}

// The codes of four texels of one channel.
fn four_codes(input: Input, row: u32, group: u32, bits: u32) -> vec4<u32> {
    let at = input.place + row * input.row_words + group * (bits / 8u);
    if (bits == 8u) {
        return (vec4(inputs[at]) >> vec4(0u, 8u, 16u, 24u)) & vec4(0xffu);
    }
    if (bits == 16u) {
        let words = vec2(inputs[at], inputs[at + 1u]).xxyy;
        return (words >> vec4(0u, 16u, 0u, 16u)) & vec4(0xffffu);
    }
    return four_words(at);
}

fn four_twos(at: u32, bits: u32) -> Texels {
    if (bits == 8u) {
        let words = vec2(inputs[at], inputs[at + 1u]).xxyy >> vec4(0u, 16u, 0u, 16u);
        return Texels(words & vec4(0xffu), (words >> vec4(8u)) & vec4(0xffu), vec4(0u));
    }
    let a = four_words(at);
    if (bits == 16u) {
        return Texels(a & vec4(0xffffu), a >> vec4(16u), vec4(0u));
    }
    let b = four_words(at + 4u);
    return Texels(vec4(a.xz, b.xz), vec4(a.yw, b.yw), vec4(0u));
}

fn four_threes(at: u32, bits: u32) -> Texels {
    if (bits == 8u) {
        let w = vec3(inputs[at], inputs[at + 1u], inputs[at + 2u]);
        return Texels(
            vec4(w.x, w.x >> 24u, w.y >> 16u, w.z >> 8u) & vec4(0xffu),
            vec4(w.x >> 8u, w.y, w.y >> 24u, w.z >> 16u) & vec4(0xffu),
            vec4(w.x >> 16u, w.y >> 8u, w.z, w.z >> 24u) & vec4(0xffu),
        );
    }
    let a = four_words(at);
    if (bits == 16u) {
        let b = vec2(inputs[at + 4u], inputs[at + 5u]);
        return Texels(
            vec4(a.x, a.y >> 16u, a.w, b.x >> 16u) & vec4(0xffffu),
            vec4(a.x >> 16u, a.z, a.w >> 16u, b.y) & vec4(0xffffu),
            vec4(a.y, a.z >> 16u, b.x, b.y >> 16u) & vec4(0xffffu),
        );
    }
    let b = four_words(at + 4u);
    let c = four_words(at + 8u);
    return Texels(vec4(a.x, a.w, b.z, c.y), vec4(a.y, b.x, b.w, c.z), vec4(a.z, b.y, c.x, c.w));
}

fn four_words(at: u32) -> vec4<u32> {
    return vec4(inputs[at], inputs[at + 1u], inputs[at + 2u], inputs[at + 3u]);
}

// One of four texels.
fn texel_of(texels: Texels, i: u32) -> vec3<u32> {
    return vec3(texels.x[i], texels.y[i], texels.z[i]);
}

// The normals of four texels over L, by component.
struct Integers {
    x: vec4<i32>,
    y: vec4<i32>,
    z: vec4<i32>,
}

fn integers_of(normals: Integers, i: u32) -> vec3<i32> {
    return vec3(normals.x[i], normals.y[i], normals.z[i]);
}

// The normals of integer codes, each z above zero.
fn integer_normals(input: Input, codes_of_texel: u32, codes: Texels) -> Integers {
    let x = integer_components(input, codes.x);
    let y = integer_components(input, codes.y);
    let turned = select(y, -y, vec4(input.green < 0));
    if (codes_of_texel == 2u) {
        return Integers(x, turned, rebuilt_z(input.greatest, x, y));
    }
    return Integers(x, turned, max(integer_components(input, codes.z), vec4(1)));
}

// A shift: the factor is 1 or 2.
fn integer_components(input: Input, codes: vec4<u32>) -> vec4<i32> {
    let component = vec4<i32>((codes ^ vec4(input.flip)) << vec4(u32(input.factor - 1))) - input.centre;
    let u = max(component, vec4(-input.greatest));
    // The code that zero is written as reads as zero.
    return select(u, vec4(0), (u == vec4(1)) & vec4(input.factor == 2));
}

// floor(sqrt(L^2 - x^2 - y^2)), at least 1 (FGED2 eq. 7.44).
fn rebuilt_z(greatest: i32, x: vec4<i32>, y: vec4<i32>) -> vec4<i32> {
    let xx = vec4<u32>(x * x);
    let above = u32(greatest) * u32(greatest) - xx;
    let rest = max(above - min(vec4<u32>(y * y), above), vec4(1u));
    // The native root of a number below 2^32 is off by less than one.
    let root = vec4<u32>(sqrt(vec4<f32>(rest)));
    let over = select(vec4(0u), vec4(1u), root * root > rest);
    let under = select(vec4(0u), vec4(1u), rest - root * root > 2u * root);
    // Where the root is over, the difference wraps around, and more so does not mean that it is under.
    return vec4<i32>(root - over + under * (1u - over));
}
