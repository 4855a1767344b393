//! Vectors of three floats, with the order of operations written out.

#[inline(always)]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
pub(crate) fn add(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn times(factor: f32, v: [f32; 3]) -> [f32; 3] {
    [factor * v[0], factor * v[1], factor * v[2]]
}

/// v over its length, as a shader's `normalize`; zero stays zero. Its square must neither overflow nor vanish.
#[inline(always)]
pub(crate) fn normalized(v: [f32; 3]) -> [f32; 3] {
    let square = dot(v, v);
    if square > 0.0 { times(1.0 / square.sqrt(), v) } else { [0.0; 3] }
}
