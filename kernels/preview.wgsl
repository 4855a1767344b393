// What each sample of a picture sees of a plane that wears a material: its colour, and by how much its texture coordinates
// were moved. One invocation for each sample; the functions of kernels/shading do the rest.
//
// Lengths are in units of the map's width, with x along growing u, y along growing v, and z out of the plane. The maps are
// decoded: heights in [0, 1], n_z (2h - 1), and the components of the normal, y along growing v. Colours are linear.
//
// Written for each sample, row by row from first_row: red, green, blue, and the offset in texture coordinates.
//
// Its twin: Shot::sample in src/preview/shot.rs; Camera::rays and Rays::at in src/preview/camera.rs.

struct Params {
    // The eye, and the rays to the middle of the picture, from there to its right border, and to its lower one.
    eye: vec4<f32>,
    ahead: vec4<f32>,
    right: vec4<f32>,
    down: vec4<f32>,
    // Towards the light, of length one.
    light: vec4<f32>,
    // The colours of the heights 0 and 1.
    low: vec4<f32>,
    high: vec4<f32>,
    // The height of h = 1 in texture coordinates, and what a step through the parallax map multiplies the eye by.
    scale: vec2<f32>,
    step: vec2<f32>,
    // Samples across and down, the first row, and whether there is no normal map.
    count: vec2<u32>,
    first_row: u32,
    is_flat: u32,
    method: ParallaxMethod,
    ambient: f32,
    highlight: f32,
    shininess: f32,
    // The map's height.
    proportion: f32,
    // What a map is of its texture, along each axis: 1, but of an axis that mirrors, which is there forth and back. Scale
    // and step are of the texture.
    share: vec2<f32>,
    unused: vec2<f32>,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var heights: texture_2d<f32>;
@group(0) @binding(2) var parallax: texture_2d<f32>;
@group(0) @binding(3) var normals_x: texture_2d<f32>;
@group(0) @binding(4) var normals_y: texture_2d<f32>;
@group(0) @binding(5) var normals_z: texture_2d<f32>;
@group(0) @binding(6) var linear: sampler;
@group(0) @binding(7) var<storage, read_write> samples: array<f32>;

fn normal(uv: vec2<f32>) -> vec3<f32> {
    let x = textureSampleLevel(normals_x, linear, uv, 0.0).r;
    let y = textureSampleLevel(normals_y, linear, uv, 0.0).r;
    let z = textureSampleLevel(normals_z, linear, uv, 0.0).r;
    let m = vec3<f32>(x, y, z);
    let square = dot(m, m);
    return select(vec3<f32>(), m * inverseSqrt(square), square > 0.0);
}

@compute @workgroup_size(8, 8)
fn preview(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = vec2<u32>(id.x, id.y + params.first_row);
    let index = 5u * (id.y * params.count.x + id.x);
    if (at.x >= params.count.x || at.y >= params.count.y || index >= arrayLength(&samples)) {
        return;
    }
    let place = 2.0 * (vec2<f32>(at) + 0.5) / vec2<f32>(params.count) - 1.0;
    let ray = params.ahead.xyz + (place.x * params.right.xyz + place.y * params.down.xyz);
    let met = params.eye.xyz - params.eye.z / ray.z * ray;
    let uv = vec2<f32>(met.x, met.y / params.proportion) * params.share;
    let v = -normalize(ray);
    let moved = parallax_offset(params.method, uv, v, params.scale, params.step);

    let colour = mix(params.low.xyz, params.high.xyz, height(uv + moved));
    var m = vec3<f32>(0.0, 0.0, 1.0);
    if (params.is_flat == 0u) {
        m = normal(uv + moved);
    }
    let l = params.light.xyz;
    let matt = (params.ambient + (1.0 - params.ambient) * diffuse(m, l)) * colour;
    let lit = matt + params.highlight * blinn_phong(m, l, v, params.shininess);
    samples[index] = lit.x;
    samples[index + 1u] = lit.y;
    samples[index + 2u] = lit.z;
    samples[index + 3u] = moved.x / params.share.x;
    samples[index + 4u] = moved.y / params.share.y;
}
