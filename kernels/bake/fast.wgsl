// Any heights in native f32: a code may be its neighbour.

fn bake_four(north: Heights, middle: Heights, south: Heights) -> Four {
    let normal = native_normals(north, middle, south);
    var four: Four;
    if (NORMAL_CODES > 0u) {
        four.normals = Texels(
            fast_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal.x),
            fast_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal.y),
            fast_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal.z),
        );
    }
    if (PARALLAX_BITS > 0u) {
        let parallax = normal.z * height_above_middle(middle.here);
        four.parallaxes = fast_codes(params.parallax, PARALLAX_IS_FLOAT, PARALLAX_BITS, parallax);
    }
    return four;
}
