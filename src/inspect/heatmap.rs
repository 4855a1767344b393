//! Where two maps differ, as a picture.

use super::diff::for_each_pair_of_rows;
use crate::error::{Error, Result};
use crate::map::CodesRef;
use crate::stream::{Monitor, NormalSource, RowsOut};
use std::f64::consts::PI;

/// The colour of a texel without an angle: none of the ramp's.
const NO_ANGLE: [u8; 3] = [255, 0, 255];

/// Paints the angle between two maps at each texel into a picture of 8-bit RGB, from black for none over blue, green
/// and red to white for `greatest` degrees and more; a texel without an angle is magenta.
///
/// The ramp is cubehelix, whose brightness rises evenly with the angle: D. A. Green, A colour scheme for the display of
/// astronomical intensity images, Bulletin of the Astronomical Society of India 39, 2011, with start 0.5, -1.5
/// rotations, hue 1 and gamma 1.
///
/// `picture` takes three 8-bit codes for each texel: a sink of [`crate::io::create_normals`] with the default format.
///
/// # Errors
/// [`Error::Parameter`] if `greatest` is not a number above 0, or the sizes differ; what the sources and the picture
/// report; [`Error::Cancelled`] if `monitor` says so.
pub fn heatmap(
    [a, b]: [Box<dyn NormalSource>; 2],
    greatest: f64,
    mut picture: RowsOut,
    monitor: &Monitor,
) -> Result<()> {
    if !(greatest > 0.0 && greatest.is_finite()) {
        return Err(Error::parameter("heatmap-max", greatest, "a number of degrees above 0"));
    }
    let ramp = ramp();
    let mut row = Vec::new();
    for_each_pair_of_rows([a, b], monitor, |y, _, angles| {
        row.clear();
        row.extend(angles.iter().flat_map(|angle| colour(&ramp, f64::from(*angle) / greatest)));
        picture.write(y, CodesRef::U8(&row))
    })?;
    picture.finish()
}

fn colour(ramp: &[[u8; 3]; 256], share: f64) -> [u8; 3] {
    if share.is_nan() { NO_ANGLE } else { ramp[(255.0 * share.min(1.0)).round() as usize] }
}

/// Colours for 0 to 255, of rising brightness.
fn ramp() -> [[u8; 3]; 256] {
    let mut ramp = [[0; 3]; 256];
    for (step, colour) in ramp.iter_mut().enumerate() {
        let brightness = step as f64 / 255.0;
        let angle = 2.0 * PI * (0.5 / 3.0 - 1.5 * brightness);
        let amplitude = brightness * (1.0 - brightness) / 2.0;
        let (sin, cos) = libm::sincos(angle);
        let channel = |of_cos: f64, of_sin: f64| {
            let value = brightness + amplitude * (of_cos * cos + of_sin * sin);
            (255.0 * value.clamp(0.0, 1.0)).round() as u8
        };
        *colour = [channel(-0.14861, 1.78277), channel(-0.29227, -0.90649), channel(1.97294, 0.0)];
    }
    ramp
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_rises_in_brightness_from_black_to_white() {
        let ramp = ramp();
        assert_eq!((ramp[0], ramp[255]), ([0; 3], [255; 3]));
        // NTSC luma, in which Green defines the ramp.
        let luma = |[r, g, b]: [u8; 3]| 0.30 * f64::from(r) + 0.59 * f64::from(g) + 0.11 * f64::from(b);
        assert!(ramp.windows(2).all(|pair| luma(pair[0]) < luma(pair[1]) + 0.5));
        assert_eq!((colour(&ramp, 7.0), colour(&ramp, f64::NAN)), ([255; 3], NO_ANGLE));
    }
}
