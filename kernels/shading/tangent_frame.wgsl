// Tangent space from a vertex's normal and tangent (FGED2 section 7.6.2, listings 7.7 and 7.8).
//
// n: the normal; t: the tangent, in which u grows; w: the handedness, +1 or -1, constant over a triangle. A frame has
// the columns t, b, n; all vectors are in one space, object space or the world.
//
// vertex_frame is for vertex shaders (listing 7.7): the vectors as they come, which to_tangent turns the unnormalised
// vectors to eye and light by; what is interpolated is normalised per pixel. pixel_frame is for pixels (listing 7.8): it
// normalises n and makes t of length one and orthogonal to n first, and takes the cross product of those. (The listing's
// code takes it of the vectors as they were interpolated; b then leans, and is not of length one.) n must not be zero, and
// t not along n: of such vectors the frame is NaN here, and zero in the twin.
//
// to_tangent is the product with the transposed matrix (eq. 7.32), the inverse of an orthonormal frame; to_object is
// eq. 7.45, m_x t + m_y b + m_z n.
//
// Their twins: src/shading/tangent_frame.rs.

fn vertex_frame(n: vec3<f32>, t: vec3<f32>, w: f32) -> mat3x3<f32> {
    return mat3x3<f32>(t, w * cross(n, t), n);
}

fn pixel_frame(n: vec3<f32>, t: vec3<f32>, w: f32) -> mat3x3<f32> {
    let normal = normalize(n);
    let tangent = normalize(t - dot(t, normal) * normal);
    return mat3x3<f32>(tangent, w * cross(normal, tangent), normal);
}

fn to_tangent(frame: mat3x3<f32>, v: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(frame[0], v), dot(frame[1], v), dot(frame[2], v));
}

fn to_object(frame: mat3x3<f32>, m: vec3<f32>) -> vec3<f32> {
    return m.x * frame[0] + m.y * frame[1] + m.z * frame[2];
}
