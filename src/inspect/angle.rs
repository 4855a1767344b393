//! The angle between two directions.

/// The angle between two vectors of any length, in degrees: well conditioned for small angles too. Vectors without a
/// direction have none; what is returned for them means nothing.
pub(crate) fn degrees(a: [f64; 3], b: [f64; 3]) -> f64 {
    let dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [x, y, z] = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    libm::atan2((x * x + y * y + z * z).sqrt(), dot).to_degrees()
}
