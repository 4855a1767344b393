// How long the parallax functions of kernels/shading take: each invocation adds up the texture coordinates to which one pixel
// is moved from changing places, so that no compiler can leave them out.
//
// Its host: src/measure/gpu_time.rs.

struct Job {
    method: ParallaxMethod,
    // The height of h = 1 in texture coordinates, and what a step through the parallax map multiplies the eye by.
    scale: vec2<f32>,
    step: vec2<f32>,
    // Offsets that each invocation computes, and pixels that there are.
    rounds: u32,
    pixels: u32,
}

@group(0) @binding(0) var<uniform> job: Job;
// u, v and the direction to the eye of each pixel.
@group(0) @binding(1) var<storage, read> views: array<f32>;
@group(0) @binding(2) var<storage, read_write> sums: array<vec2<f32>>;
@group(0) @binding(3) var heights: texture_2d<f32>;
@group(0) @binding(4) var parallax: texture_2d<f32>;
@group(0) @binding(5) var normals_x: texture_2d<f32>;
@group(0) @binding(6) var normals_y: texture_2d<f32>;
@group(0) @binding(7) var linear: sampler;

@compute @workgroup_size(64)
fn time_offsets(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= arrayLength(&sums)) {
        return;
    }
    let first = 5u * (id.x % job.pixels);
    let start = vec2<f32>(views[first], views[first + 1u]);
    let v = vec3<f32>(views[first + 2u], views[first + 3u], views[first + 4u]);
    var sum = vec2<f32>();
    for (var round = 0u; round < job.rounds; round++) {
        let uv = start + f32(round) * vec2<f32>(0.618034, 0.414214);
        sum += uv + parallax_offset(job.method, uv, v, job.scale, job.step);
    }
    sums[id.x] = sum;
}

fn normal(uv: vec2<f32>) -> vec3<f32> {
    let x = textureSampleLevel(normals_x, linear, uv, 0.0).r;
    let y = textureSampleLevel(normals_y, linear, uv, 0.0).r;
    return vec3<f32>(x, y, sqrt(max(1.0 - x * x - y * y, 0.0)));
}
