// Where the ray to the eye meets the relief: by steps from above, then by bisection. What the parallax offsets stand for.
//
// The surface is at the height h - 1/2 above the plane that is textured, in units of the scale: h = 1/2 is in the plane.
// The ray from the eye enters at the greatest height that the map can hold and goes down in equal steps until it is below the
// surface; bisection halves what is left of the step. Steps that are longer than a bump is wide may miss the bump.
//
// map: heights h in [0, 1]. level: the mip level that is sampled. uv: where the ray meets the plane. v: towards the eye, in
// tangent space, of any length, its x and y along growing u and v, v.z above zero. scale: the height of h = 1 in texture
// coordinates, for each axis; below zero heights are depths.
// Result: what to add to the texture coordinates.
//
// Its twin: src/shading/relief_offset.rs.

fn relief_offset(
    map: texture_2d<f32>, map_sampler: sampler, level: f32,
    uv: vec2<f32>, v: vec3<f32>, scale: vec2<f32>, steps: u32, bisections: u32,
) -> vec2<f32> {
    let side = select(1.0, -1.0, scale.x < 0.0);
    let slant = v.xy / v.z * (side * scale);
    var above = 0.5;
    var below = 0.5;
    for (var i = 1u; i <= steps; i++) {
        below = 0.5 - f32(i) / f32(steps);
        let h = textureSampleLevel(map, map_sampler, uv + slant * below, level).r;
        if (side * (h - 0.5) >= below) {
            break;
        }
        above = below;
    }
    for (var i = 0u; i < bisections; i++) {
        let middle = 0.5 * (above + below);
        let h = textureSampleLevel(map, map_sampler, uv + slant * middle, level).r;
        if (side * (h - 0.5) >= middle) {
            below = middle;
        } else {
            above = middle;
        }
    }
    return slant * (0.5 * (above + below));
}
