//! Whether a bake is exact or fast.

use super::decision::{Decision, Rejected, degrees, pixels};
use super::normals::{self, NormalChoice};
use super::parallax::{self, MapChoice, ParallaxChoice, Sides};
use super::scene::Tolerance;
use super::subject::{Reduced, Subject};
use crate::error::Result;
use crate::measure::{digits, timed};
use crate::ops::Precision;
use crate::ops::bake::BakeOptions;

/// What must be saved of the time of a bake, so that it is worth other bytes on other devices: milliseconds, and a share.
const LEAST_SAVING: (f64, f64) = (10.0, 0.25);

/// Runs of which a time is the median.
const RUNS: usize = 5;

const TOPIC: &str = "precision";

/// Milliseconds of a bake.
struct Times {
    exact: f64,
    fast: f64,
}

/// What a fast bake is off by.
#[derive(Clone, Copy)]
struct Measured {
    normal: f64,
    offset: f64,
    map: Option<MapChoice>,
}

/// `fast` if it saves time and keeps within the tolerances, with what the choices are then off by.
pub(super) fn choose(
    subject: &Subject<'_>,
    reduced: &Reduced<'_>,
    normals: &mut NormalChoice,
    parallax: &mut ParallaxChoice,
) -> Result<(Precision, Decision)> {
    if normals.format.is_none() && parallax.map.is_none() {
        return Ok((Precision::Exact, Decision::new(TOPIC, Precision::Exact, "nothing is baked")));
    }
    let milliseconds = |precision| -> Result<f64> {
        let (normal, offsets) = (normals.format, parallax.format());
        let options = BakeOptions { normal, parallax: offsets, precision, ..reduced.options };
        let time = timed(RUNS, || {
            subject.monitor.check()?;
            subject.baker.bake(&reduced.heights, &options)
        })?;
        Ok(time.as_secs_f64() * 1e3)
    };
    let times = Times { exact: milliseconds(Precision::Exact)?, fast: milliseconds(Precision::Fast)? };
    let measure = || measure(subject, reduced, normals, parallax);
    let (fast, decision) = decide(&times, &subject.baker.name(), subject.tolerance(), measure)?;
    let Some(Measured { normal, offset, map }) = fast else { return Ok((Precision::Exact, decision)) };
    (normals.error, parallax.error, parallax.map) = (normal, offset, map);
    Ok((Precision::Fast, decision))
}

/// What a fast bake is off by, if it is to be taken.
fn decide(
    &Times { exact, fast }: &Times,
    device: &str,
    tolerance: Tolerance,
    measure: impl FnOnce() -> Result<Measured>,
) -> Result<(Option<Measured>, Decision)> {
    let times = format!("{} ms, fast {} ms, on {device}", digits(exact), digits(fast));
    let (least, share) = LEAST_SAVING;
    if exact - fast < least || exact - fast < share * exact {
        let why = format!("it saves less than {} ms or {} %", digits(least), digits(100.0 * share));
        let rejected = vec![Rejected::new(Precision::Fast, why)];
        let decision = Decision::new(TOPIC, Precision::Exact, "the same bytes on every device");
        return Ok((None, decision.taking(times).without(rejected)));
    }
    let measured = measure()?;
    let Measured { normal, offset, .. } = measured;
    let errors = format!("normals are off by {} and offsets by {} at most", degrees(normal), pixels(offset));
    if !(normal <= tolerance.normal && offset <= tolerance.parallax) {
        let rejected = vec![Rejected::new(Precision::Fast, errors)];
        let decision = Decision::new(TOPIC, Precision::Exact, "fast is not right enough");
        return Ok((None, decision.taking(times).without(rejected)));
    }
    let rejected = vec![Rejected::new(Precision::Exact, format!("it takes {} ms more", digits(exact - fast)))];
    let reason = format!("{errors}, within the tolerances");
    Ok((Some(measured), Decision::new(TOPIC, Precision::Fast, reason).taking(times).without(rejected)))
}

/// What `fast` is off by.
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
    // A plane is of the normal map, which is fast too.
    let shown = normals::bake(subject.baker, reduced, normals.format.unwrap_or_default(), fast)?;
    let read = parallax::bake(subject.baker, reduced, parallax.format().unwrap_or_default(), fast)?;
    let options = subject.facts().bake();
    let material = parallax::material(&subject.heights, &shown, &read, &options)?;
    let sides = Sides::new(&subject.heights, &options, &material, subject.seen, subject.monitor)?;
    let of = subject.tolerance().parallax_of;
    let offset = of.errors(sides.errors(&material, parallax.method, of, subject.monitor)?);
    let map = match parallax.map {
        Some(map) => Some(MapChoice { error: reduced.parallax_error(&read)?, ..map }),
        None => None,
    };
    Ok(Measured { normal, offset, map })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::prediction::ErrorOf;

    #[test]
    fn fast_must_save_time_and_keep_within_the_tolerances() {
        let (bytes_per_texel, milliseconds) = (None, None);
        let tolerance =
            Tolerance { normal: 1.0, parallax: 2.0, parallax_of: ErrorOf::All, bytes_per_texel, milliseconds };
        let choice = |exact, fast, normal, offset| {
            let measured = || Ok(Measured { normal, offset, map: None });
            let (taken, decision) = decide(&Times { exact, fast }, "a GPU", tolerance, measured).unwrap();
            assert_eq!(decision.choice, if taken.is_some() { "fast" } else { "exact" });
            (decision.choice, decision.rejected[0].why.clone())
        };
        let expected = |choice: &str, why: &str| (choice.to_owned(), why.to_owned());
        assert_eq!(choice(40.0, 30.0, 1.0, 2.0), expected("fast", "it takes 10 ms more"));
        let little = expected("exact", "it saves less than 10 ms or 25 %");
        assert_eq!(choice(40.0, 30.5, 1.0, 2.0), little);
        assert_eq!(choice(41.0, 31.0, 1.0, 2.0), little);
        for (normal, offset) in [(1.01, 2.0), (1.0, 2.01), (f64::NAN, 2.0), (1.0, f64::NAN)] {
            assert_eq!(choice(400.0, 30.0, normal, offset).0, "exact", "{normal} {offset}");
        }
    }
}
