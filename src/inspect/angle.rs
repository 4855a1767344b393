//! The angle between two directions.

/// The angle between two vectors of any length, in degrees: well conditioned for small angles too. A vector without a
/// direction is as wrong as can be: 180 degrees from every other.
pub(crate) fn degrees(a: [f64; 3], b: [f64; 3]) -> f64 {
    if !has_direction(a) || !has_direction(b) {
        return 180.0;
    }
    let dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [x, y, z] = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    libm::atan2((x * x + y * y + z * z).sqrt(), dot).to_degrees()
}

/// Whether a vector is neither zero nor infinite nor NaN.
pub(crate) fn has_direction(v: [f64; 3]) -> bool {
    v.iter().all(|component| component.is_finite()) && v != [0.0; 3]
}

#[cfg(test)]
mod tests {
    use super::degrees;

    #[test]
    fn what_has_no_direction_is_wrong() {
        let up = [0.0, 0.0, 1.0];
        assert_eq!([degrees(up, [0.0, 0.0, 1e-30]), degrees(up, [0.0, 9.0, 0.0])], [0.0, 90.0]);
        for none in [[0.0; 3], [0.0, f64::NAN, 1.0], [f64::INFINITY, 0.0, 1.0]] {
            assert_eq!([degrees(up, none), degrees(none, up), degrees(none, none)], [180.0; 3], "{none:?}");
        }
    }
}
