// By how much a parallax method moves the texture coordinates of a pixel.
//
// A kernel that takes this in has the textures heights and parallax, their sampler linear, the function normal(uv), of
// length one, and the functions of kernels/shading that are called here.
//
// Its host: ParallaxMethod::words in src/material/method.rs. Its twin: Material::offset in src/material/mod.rs.

struct ParallaxMethod {
    // METHOD_...; any other is none.
    kind: u32,
    steps: u32,
    bisections: u32,
    // The longest offset of a plane, in heights.
    limit: f32,
}

const METHOD_WELSH = 1u;
const METHOD_LIMITED = 2u;
const METHOD_PLANE = 3u;
const METHOD_STEPS = 4u;
const METHOD_RELIEF = 5u;

// v points to the eye; scale is the height of h = 1 in texture coordinates, and step what a step through the parallax map
// multiplies the eye by.
fn parallax_offset(
    method: ParallaxMethod,
    uv: vec2<f32>,
    v: vec3<f32>,
    scale: vec2<f32>,
    step: vec2<f32>,
) -> vec2<f32> {
    switch method.kind {
        case METHOD_WELSH: {
            return welsh_offset(height(uv), scale, -0.5 * scale, v);
        }
        case METHOD_LIMITED: {
            return limited_offset(height(uv), scale, -0.5 * scale, v);
        }
        case METHOD_PLANE: {
            return scale * plane_offset(normal(uv), height(uv) - 0.5, v, method.limit);
        }
        case METHOD_STEPS: {
            return stepped_offset(parallax, linear, 0.0, vec2<f32>(1.0, 0.0), uv, v, step, method.steps);
        }
        case METHOD_RELIEF: {
            return relief_offset(heights, linear, 0.0, uv, v, scale, method.steps, method.bisections);
        }
        default: {
            return vec2<f32>();
        }
    }
}

fn height(uv: vec2<f32>) -> f32 {
    return textureSampleLevel(heights, linear, uv, 0.0).r;
}
