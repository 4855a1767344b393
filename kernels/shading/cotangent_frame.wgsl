// Normal mapping without precomputed tangents: the cotangent frame of a pixel (Schueler, Followup: Normal Mapping Without
// Precomputed Tangents, 2013).
//
// n: the interpolated normal, of length one. dp1, dp2: differences of the position, or of the negated vector to the eye,
// along two directions; duv1, duv2: differences of the texture coordinates along the same: edges of a triangle, or the
// derivatives of a pixel's quad. A frame has the columns T, B, n. T and B are the gradients of u and v, covectors: what a
// normal's slopes are multiplied by. They are right for skewed and mirrored mappings, keep the ratio of their lengths, and
// the longer one is of length one: their scale does not matter. Where no direction is left both are zero.
//
// Schueler's T is the gradient times n . (dp1 x dp2), which is below zero where the differences turn the other way round:
// in WGSL dpdy goes down the framebuffer. Its sign is taken out here, so that any two directions give the same frame.
//
// without_perspective is his shortcut (dp1, dp2 in place of the vectors perpendicular to them): right where dp1 and dp2 are
// orthogonal and of one length, so not at a slant or in perspective. gradients is the inverse of the 3 x 3 matrix with the
// rows dp1, dp2 and dp1 x dp2, its adjugate over its determinant: what all of this replaces.
//
// perturbed_normal: m is the normal of the map; normalised.
//
// Their twins: src/shading/cotangent_frame.rs; pixel_cotangent_frame, for fragment shaders, is cotangent_frame.

fn cotangent_frame(n: vec3<f32>, dp1: vec3<f32>, dp2: vec3<f32>, duv1: vec2<f32>, duv2: vec2<f32>) -> mat3x3<f32> {
    let dp2perp = cross(dp2, n);
    let dp1perp = cross(n, dp1);
    let side = select(-1.0, 1.0, dot(dp1, dp2perp) >= 0.0);
    return scale_invariant(side * (dp2perp * duv1.x + dp1perp * duv2.x), side * (dp2perp * duv1.y + dp1perp * duv2.y), n);
}

fn pixel_cotangent_frame(n: vec3<f32>, p: vec3<f32>, uv: vec2<f32>) -> mat3x3<f32> {
    return cotangent_frame(n, dpdx(p), dpdy(p), dpdx(uv), dpdy(uv));
}

fn without_perspective(n: vec3<f32>, dp1: vec3<f32>, dp2: vec3<f32>, duv1: vec2<f32>, duv2: vec2<f32>) -> mat3x3<f32> {
    return scale_invariant(dp1 * duv1.x + dp2 * duv2.x, dp1 * duv1.y + dp2 * duv2.y, n);
}

fn gradients(dp1: vec3<f32>, dp2: vec3<f32>, duv1: vec2<f32>, duv2: vec2<f32>) -> mat2x3<f32> {
    let face = cross(dp1, dp2);
    let determinant = dot(face, face);
    let across1 = cross(dp2, face) / determinant;
    let across2 = cross(face, dp1) / determinant;
    return mat2x3<f32>(across1 * duv1.x + across2 * duv2.x, across1 * duv1.y + across2 * duv2.y);
}

fn perturbed_normal(frame: mat3x3<f32>, m: vec3<f32>) -> vec3<f32> {
    return normalize(m.x * frame[0] + m.y * frame[1] + m.z * frame[2]);
}

fn scale_invariant(t: vec3<f32>, b: vec3<f32>, n: vec3<f32>) -> mat3x3<f32> {
    let square = max(dot(t, t), dot(b, b));
    let inverse = select(0.0, inverseSqrt(square), square > 0.0);
    return mat3x3<f32>(t * inverse, b * inverse, n);
}
