// How long the parallax functions of kernels/shading take: each invocation adds up offsets of one pixel at changing texture
// coordinates, so that no compiler can leave them out. What comes of it says nothing.
//
// Its host: src/measure/gpu_time.rs. The functions follow this text.

struct Job {
    // 0 none, 1 Welsh, 2 limited, 3 plane, 4 steps, 5 relief.
    kind: u32,
    steps: u32,
    bisections: u32,
    // Offsets that each invocation computes.
    rounds: u32,
    // The height of h = 1 in texture coordinates.
    scale: vec2<f32>,
    limit: f32,
    pixels: u32,
}

@group(0) @binding(0) var<uniform> job: Job;
// u, v and the direction to the eye of each pixel.
@group(0) @binding(1) var<storage, read> views: array<f32>;
@group(0) @binding(2) var<storage, read_write> sums: array<f32>;
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
        sum += offset(start + f32(round) * vec2<f32>(0.618034, 0.414214), v);
    }
    sums[id.x] = sum.x + sum.y;
}

fn offset(uv: vec2<f32>, v: vec3<f32>) -> vec2<f32> {
    let bias = -0.5 * job.scale;
    switch job.kind {
        case 1u: { return welsh_offset(sampled(heights, uv), job.scale, bias, v); }
        case 2u: { return limited_offset(sampled(heights, uv), job.scale, bias, v); }
        case 3u: {
            let xy = vec2<f32>(sampled(normals_x, uv), sampled(normals_y, uv));
            let n = vec3<f32>(xy, sqrt(max(1.0 - dot(xy, xy), 0.0)));
            return plane_offset(n, sampled(heights, uv) - 0.5, v, job.limit) * job.scale;
        }
        case 4u: {
            let u = job.scale / (2.0 * f32(job.steps));
            return stepped_offset(parallax, linear, 0.0, vec2<f32>(1.0, 0.0), uv, v, u, job.steps);
        }
        case 5u: { return relief_offset(heights, linear, 0.0, uv, v, job.scale, job.steps, job.bisections); }
        default: { return uv; }
    }
}

fn sampled(map: texture_2d<f32>, uv: vec2<f32>) -> f32 {
    return textureSampleLevel(map, linear, uv, 0.0).r;
}
