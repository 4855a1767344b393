//! Where two maps differ, as a picture.

use super::diff::for_each_pair_of_rows;
use super::ramp::Ramp;
use crate::error::{Error, Result};
use crate::map::CodesRef;
use crate::stream::{Monitor, NormalSource, RowsOut};

/// The colour of a texel without an angle: none of the ramp's.
const NO_ANGLE: [u8; 3] = [255, 0, 255];

/// Paints the angle between two maps at each texel into a picture of 8-bit RGB, from black for none over blue, green
/// and red to white for `greatest` degrees and more; a texel without an angle is magenta.
///
/// The ramp is cubehelix, whose brightness rises evenly with the angle.
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
    let ramp = Ramp::cubehelix();
    let mut row = Vec::new();
    for_each_pair_of_rows([a, b], monitor, |y, _, angles| {
        row.clear();
        row.extend(angles.iter().flat_map(|angle| colour(&ramp, f64::from(*angle) / greatest)));
        picture.write(y, CodesRef::U8(&row))
    })?;
    picture.finish()
}

fn colour(ramp: &Ramp, share: f64) -> [u8; 3] {
    if share.is_nan() { NO_ANGLE } else { ramp.colour(share) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_that_is_none_has_a_colour_of_its_own() {
        let ramp = Ramp::cubehelix();
        assert_eq!((colour(&ramp, 7.0), colour(&ramp, f64::NAN)), ([255; 3], NO_ANGLE));
    }
}
