//! Which fronts there are.

use super::blends::BlendFigure;
use super::front::{Front, Statistic};
use super::maps::{NormalFigure, ParallaxFigure, Stored};
use super::parallax::{OffsetFigure, OffsetTime};

/// What bytes buy: of maps by the first device, in its first precision.
pub(super) fn storage(normal_maps: &[NormalFigure], parallax_maps: &[ParallaxFigure]) -> Vec<Front> {
    let by = Statistic::Percentile99;
    let is_first =
        |stored: &Stored, first: &Stored| (&stored.device, &stored.precision) == (&first.device, &first.precision);
    let normals = normal_maps.iter().filter(|it| is_first(&it.stored, &normal_maps[0].stored)).map(|it| {
        let name = format!("{} {} {}", it.stored.encoding, it.stored.bits, it.channels);
        (name, it.stored.bytes_per_texel as f64, by.of(&it.error_degrees))
    });
    let parallax = parallax_maps.iter().filter(|it| is_first(&it.stored, &parallax_maps[0].stored)).map(|it| {
        let name = format!("{} {}", it.stored.encoding, it.stored.bits);
        (name, it.stored.bytes_per_texel as f64, by.of(&it.error))
    });
    vec![
        Front::new("storage of normal maps", by, ["bytes per texel", "degrees"], normals),
        Front::new("storage of parallax maps", by, ["bytes per texel", "units of n_z (2h - 1)"], parallax),
    ]
}

/// What time buys on every device: of bakes and of blends.
pub(super) fn times(
    normal_maps: &[NormalFigure],
    parallax_maps: &[ParallaxFigure],
    blends: &[BlendFigure],
) -> Vec<Front> {
    let by = Statistic::Percentile99;
    let on = |device: &str, name: String| format!("{}: {name}", short_name(device));
    let normals = normal_maps
        .iter()
        .map(|it| (on(&it.stored.device, it.name()), it.stored.nanoseconds_per_texel, by.of(&it.error_degrees)));
    let parallax = parallax_maps
        .iter()
        .map(|it| (on(&it.stored.device, it.stored.name()), it.stored.nanoseconds_per_texel, by.of(&it.error)));
    // Half of each stands for another sum.
    let blends = blends.iter().filter(|it| it.method != "weighted").map(|it| {
        let name = on(&it.device, format!("{}, {} {}", it.method, it.encoding, it.bits));
        (name, it.nanoseconds_per_texel, by.of(&it.error_degrees))
    });
    vec![
        Front::new("time of bakes", by, ["ns per texel", "degrees"], normals),
        Front::new("time of bakes of parallax maps", by, ["ns per texel", "units of n_z (2h - 1)"], parallax),
        Front::new("time of blends", by, ["ns per texel", "degrees"], blends),
    ]
}

/// Fetches and time of parallax, whose largest errors are where one bump hides another, by their mean too.
pub(super) fn parallax(offsets: &[OffsetFigure], offset_times: &[OffsetTime], elevation: f64) -> Vec<Front> {
    let mut fronts = Vec::new();
    for by in [Statistic::Percentile99, Statistic::Mean] {
        let seen = || offsets.iter().filter(|figure| figure.elevation_degrees == elevation);
        let fetches = seen().map(|it| (it.method.clone(), f64::from(it.fetches), by.of(&it.error_texels)));
        let times = seen().map(|it| (it.method.clone(), it.nanoseconds_per_pixel, by.of(&it.error_texels)));
        let from = |what: &str| format!("{what} of parallax, seen from {elevation} degrees");
        fronts.push(Front::new(from("fetches"), by, ["fetches per pixel", "texels"], fetches));
        fronts.push(Front::new(from("time"), by, ["ns per pixel", "texels"], times));
    }
    for times in offset_times.chunk_by(|a, b| a.device == b.device) {
        let by = Statistic::Mean;
        let error = |method: &str| {
            let figure = offsets.iter().find(|it| it.elevation_degrees == elevation && it.method == method)?;
            Some(by.of(&figure.error_texels))
        };
        let on_gpu =
            times.iter().filter_map(|it| Some((it.method.clone(), it.nanoseconds_per_pixel?, error(&it.method)?)));
        let name = format!("time of parallax on {}, seen from {elevation} degrees", times[0].device);
        fronts.push(Front::new(name, by, ["ns per pixel", "texels"], on_gpu));
    }
    fronts
}

/// A device's name up to its first comma or bracket: `cpu`, `gpu llvmpipe`.
fn short_name(device: &str) -> &str {
    device.split([',', '(']).next().unwrap_or(device).trim()
}
