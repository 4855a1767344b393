//! What the numbers of a picture may be: asked before anything is computed with them or allocated for them.

use crate::error::{Error, Result};
use crate::material::ParallaxMethod;
use std::fmt::Display;
use std::ops::RangeInclusive;

/// Pixels of a panel, along each side; fewer have no room for what stands on it.
pub(super) const PANEL: RangeInclusive<u32> = 16..=4096;
/// Samples of a shot, along each side.
pub(super) const SAMPLES: RangeInclusive<u32> = 1..=8192;
/// Pixels of a picture: 768 MiB.
const PIXELS: u128 = 1 << 28;

/// Fails if a value is outside its range, as NaN is outside every one.
pub(super) fn within<T: PartialOrd + Display>(
    parameter: &'static str,
    value: T,
    range: &RangeInclusive<T>,
) -> Result<()> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(Error::parameter(parameter, value, format!("from {} to {}", range.start(), range.end())))
}

/// Fails if a method looks at a map more often than it could be waited for.
pub(super) fn check_method(method: ParallaxMethod) -> Result<()> {
    // Material::truth takes as many at most.
    let steps = 1..=1 << 16;
    match method {
        ParallaxMethod::Steps { k } => within("iterations", k.get(), &steps),
        ParallaxMethod::Relief { steps: count, bisections } => {
            within("steps", count, &steps)?;
            within("bisections", bisections, &(0..=64))
        }
        ParallaxMethod::Plane { limit } => within("limit", limit, &(0.0..=1e6)),
        ParallaxMethod::None | ParallaxMethod::Welsh | ParallaxMethod::Limited => Ok(()),
    }
}

/// Fails if a picture has more pixels than a sheet may have.
pub(super) fn check_pixels([width, height]: [usize; 2]) -> Result<()> {
    if width as u128 * height as u128 <= PIXELS {
        return Ok(());
    }
    let range = format!("at most {PIXELS} pixels in all: take fewer panels, or smaller ones");
    Err(Error::parameter("picture", format!("{width}x{height} pixels"), range))
}
