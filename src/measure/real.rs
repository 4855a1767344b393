//! Vectors of three doubles.

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The sum of vectors, each times its factor.
pub(super) fn sum<const N: usize>(parts: [(f64, [f64; 3]); N]) -> [f64; 3] {
    parts.into_iter().fold([0.0; 3], |sum, (factor, v)| [0, 1, 2].map(|axis| sum[axis] + factor * v[axis]))
}

pub(super) fn normalized(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|part| part / length)
}
