//! Whether a bake is exact or fast.

use super::decision::{Decision, Rejected, degrees, pixels, short};
use super::normals::{self, NormalChoice};
use super::parallax::{self, ParallaxChoice};
use super::subject::{Reduced, Subject};
use crate::error::Result;
use crate::measure::median_time;
use crate::ops::Precision;
use crate::ops::bake::BakeOptions;

/// What must be saved of the time of a bake, so that it is worth other bytes on other devices: milliseconds, and a share.
const LEAST_SAVING: (f64, f64) = (10.0, 0.25);

/// Runs of which a time is the median.
const RUNS: usize = 5;

/// What a bake is off by with a precision.
struct Measured {
    normal: f64,
    parallax: f64,
}

/// `fast` if it saves time and keeps within the tolerances, with what the choices are then off by.
pub(super) fn choose(
    subject: &Subject<'_>,
    reduced: &Reduced<'_>,
    normals: &mut NormalChoice,
    parallax: &mut ParallaxChoice,
) -> Result<(Precision, Decision)> {
    const TOPIC: &str = "precision";
    if normals.format.is_none() && parallax.format.is_none() {
        return Ok((Precision::Exact, Decision::new(TOPIC, Precision::Exact, "nothing is baked")));
    }
    let milliseconds = |precision| -> Result<f64> {
        let options = BakeOptions { normal: normals.format, parallax: parallax.format, precision, ..reduced.options };
        let mut baked = Ok(());
        let time = median_time(RUNS, || {
            let run = subject.baker.bake(&reduced.heights, &options);
            baked = std::mem::replace(&mut baked, Ok(())).and(run.map(drop));
        });
        baked.map(|()| time.as_secs_f64() * 1e3)
    };
    let (exact, fast) = (milliseconds(Precision::Exact)?, milliseconds(Precision::Fast)?);
    let times = format!("{} ms, fast {} ms, on {}", short(exact), short(fast), subject.baker.name());
    let (least, share) = LEAST_SAVING;
    if exact - fast < least || exact - fast < share * exact {
        let why = format!("it saves less than {} ms or {} %", short(least), short(100.0 * share));
        let rejected = vec![Rejected::new(Precision::Fast, why)];
        let reason = format!("the same bytes on every device: {times}");
        return Ok((Precision::Exact, Decision::new(TOPIC, Precision::Exact, reason).without(rejected)));
    }
    let Measured { normal, parallax: offset } = measure(subject, reduced, normals, parallax)?;
    let tolerance = subject.tolerance();
    let errors = format!("off by {} and {} at most", degrees(normal), pixels(offset));
    if normal > tolerance.normal || offset > tolerance.parallax {
        let rejected = vec![Rejected::new(Precision::Fast, errors)];
        return Ok((Precision::Exact, Decision::new(TOPIC, Precision::Exact, times).without(rejected)));
    }
    (normals.error, parallax.error) = (normal, offset);
    let rejected = vec![Rejected::new(Precision::Exact, format!("it takes {} ms more", short(exact - fast)))];
    let reason = format!("{times}; {errors}, within the tolerances");
    Ok((Precision::Fast, Decision::new(TOPIC, Precision::Fast, reason).without(rejected)))
}

/// What `fast` is off by, in degrees and in pixels.
fn measure(
    subject: &Subject<'_>,
    reduced: &Reduced<'_>,
    normals: &NormalChoice,
    parallax: &ParallaxChoice,
) -> Result<Measured> {
    let fast = Precision::Fast;
    let normal = match normals.format {
        Some(format) => normals::measure(subject.baker, reduced, format, fast)?.largest,
        None => normals.error,
    };
    let Some(format) = parallax.format else { return Ok(Measured { normal, parallax: parallax.error }) };
    let map = parallax::bake(subject.baker, reduced, format, fast)?;
    let shown = normals.format.unwrap_or_default();
    let shown = normals::bake(subject.baker, reduced, shown, fast)?;
    let material = parallax::material(&subject.heights, &shown, &map, &subject.facts().bake())?;
    let (views, truth) = parallax::views(&material, subject.seen.angle, subject.monitor)?;
    let errors = views.errors(&material, parallax.method, &truth, material.texels(), subject.monitor)?;
    let texels = subject.tolerance().parallax_of.errors(errors);
    Ok(Measured { normal, parallax: texels * subject.seen.pixels_per_texel })
}
