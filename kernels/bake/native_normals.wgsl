// Normals of any heights in native f32, four at a time. The steps are those of float_heights.wgsl.

struct NativeNormals {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}

fn native_normals(north: Heights, middle: Heights, south: Heights) -> NativeNormals {
    let slope = slopes(north, middle, south);
    // Slopes of integer heights are below 2^44.
    let steep = (max(abs(slope.x), abs(slope.y)) >= vec4(0x1p-4f)) & vec4(HEIGHT_BITS == 32u);
    let factor = select(vec4(0x1p64f), vec4(0x1p-30f), steep);
    let x = slope.x * factor;
    let y = slope.y * factor;
    let z = select(vec4(1.0), vec4(0x1p-94f), steep);
    let scale = inverseSqrt(x * x + y * y + z * z);
    return NativeNormals(x * scale, y * scale, z * scale);
}

// 2h - 1.
fn height_above_middle(heights: vec4<u32>) -> vec4<f32> {
    if (HEIGHT_BITS < 32u) {
        return vec4<f32>(twice_above_middle(heights)) * select(1.0 / 255.0, 1.0 / 65535.0, HEIGHT_BITS == 16u);
    }
    return 2.0 * clamp(bitcast<vec4<f32>>(heights), vec4(0.0), vec4(1.0)) - 1.0;
}

struct Slopes {
    x: vec4<f32>,
    y: vec4<f32>,
}

// Over 2^64: kx Gx / 64 and ky Gy / 64.
fn slopes(north: Heights, middle: Heights, south: Heights) -> Slopes {
    let kx = bitcast<f32>(params.kx);
    let ky = bitcast<f32>(params.ky);
    if (HEIGHT_BITS < 32u) {
        let g = integer_sums(north, middle, south);
        return Slopes(vec4<f32>(g.x) * (kx * 0x1p-6f), vec4<f32>(g.y) * (ky * 0x1p-6f));
    }
    let n = native_over_64(north);
    let m = native_over_64(middle);
    let s = native_over_64(south);
    let centre = f32(CENTRE);
    let outer = f32(OUTER);
    return Slopes(
        kx * (outer * ((n.east - n.west) + (s.east - s.west)) + centre * (m.east - m.west)),
        ky * (outer * ((s.west - n.west) + (s.east - n.east)) + centre * (s.here - n.here)),
    );
}

struct FloatHeights {
    west: vec4<f32>,
    here: vec4<f32>,
    east: vec4<f32>,
}

fn native_over_64(heights: Heights) -> FloatHeights {
    return FloatHeights(
        bitcast<vec4<f32>>(heights.west) * 0x1p-6f,
        bitcast<vec4<f32>>(heights.here) * 0x1p-6f,
        bitcast<vec4<f32>>(heights.east) * 0x1p-6f,
    );
}
