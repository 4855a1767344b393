//! The angle whose cosine is a float.

/// The float nearest to acos(x), for x from -1 to 1.
#[inline(always)]
pub(crate) fn acos(x: f32) -> f32 {
    f64::from(x).acos() as f32
}
