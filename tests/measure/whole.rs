//! All figures together: none is missing, none is there twice, and errors repeat.

use super::{clamped, quick};
use crate::support::{every_baker, map_u8};
use std::collections::BTreeSet;
use texbake::measure::{Figures, MeasureOptions, Measured, Region, measure};
use texbake::stream::Monitor;
use texbake::{Baker, Error, HeightMap};

fn bumps() -> HeightMap {
    map_u8(24, 16, |x, y| crate::support::Random::new((x * 31 + y) as u64).below(256) as u8)
}

/// The figures without their times.
fn errors(figures: &Figures) -> String {
    let mut untimed = figures.clone();
    untimed.normal_maps.iter_mut().for_each(|it| it.stored.nanoseconds_per_texel = 0.0);
    untimed.parallax_maps.iter_mut().for_each(|it| it.stored.nanoseconds_per_texel = 0.0);
    untimed.blends.iter_mut().for_each(|it| it.nanoseconds_per_texel = 0.0);
    untimed.offsets.iter_mut().for_each(|it| it.nanoseconds_per_pixel = 0.0);
    untimed.frames.iter_mut().for_each(|it| it.nanoseconds_per_pixel = 0.0);
    untimed.fronts.retain(|front| !front.cost_unit.starts_with("ns"));
    format!("{untimed:?}")
}

#[test]
fn every_combination_is_there_once() {
    let figures = quick(&bumps(), None, &MeasureOptions::default());
    let normals: BTreeSet<String> = figures.normal_maps.iter().map(|it| it.name()).collect();
    // exact and fast; unorm, snorm and biased in 8 and 16 bits, 16f and 32f; xyz and xy.
    assert_eq!((normals.len(), figures.normal_maps.len()), (2 * 8 * 2, 2 * 8 * 2));
    let parallax: BTreeSet<String> = figures.parallax_maps.iter().map(|it| it.stored.name()).collect();
    assert_eq!((parallax.len(), figures.parallax_maps.len()), (2 * 8, 2 * 8));
    let blends: BTreeSet<_> = figures.blends.iter().map(|it| (it.method, &it.bits)).collect();
    assert_eq!((blends.len(), figures.blends.len()), (7 * 2, 7 * 2));
    let offsets: BTreeSet<_> = figures.offsets.iter().map(|it| (it.elevation_degrees as u32, &it.method)).collect();
    // none, Welsh, limited, two planes, 16 numbers of steps, four reliefs; 60 and 20 degrees, and the fronts' 30.
    assert_eq!((offsets.len(), figures.offsets.len()), (3 * 25, 3 * 25));
    let frames: BTreeSet<_> = figures.frames.iter().map(|it| (&it.mesh, it.frame)).collect();
    assert_eq!((frames.len(), figures.frames.len()), (4 * 4, 4 * 4));
    let fronts: Vec<_> = figures.fronts.iter().map(|front| front.candidates.len()).collect();
    assert_eq!(fronts, [16, 8, 32, 16, 12, 25, 25, 25, 25]);
    assert!(figures.fronts.iter().all(|front| front.steps.len() + 1 == front.best().len()));
}

#[test]
fn errors_repeat_and_follow_the_seed() {
    let options = clamped("7/3");
    let first = errors(&quick(&bumps(), None, &options));
    assert_eq!(first, errors(&quick(&bumps(), None, &options)));
    assert_ne!(first, errors(&quick(&bumps(), None, &MeasureOptions { seed: 2, ..options })));
}

#[test]
fn every_device_has_the_errors_of_exact() {
    let subjects = every_baker();
    let options = MeasureOptions { quick: true, runs: 1, ..clamped("7/3") };
    let of = |device: Baker| {
        let heights = bumps();
        let measured = Measured { heights: &heights, detail: None, models: &[], devices: &[device] };
        measure(&measured, &options, &Monitor::default(), &mut |_| {}).unwrap().normal_maps
    };
    let on_cpu = of(Baker::cpu());
    for subject in subjects.iter().filter(|subject| subject.name.contains(':')) {
        let device = Baker::gpu(Some(subject.name)).unwrap();
        let name = device.name();
        for (found, expected) in of(device).iter().zip(&on_cpu).filter(|(it, _)| it.stored.precision == "exact") {
            assert_eq!(found.stored.device, name);
            assert_eq!((found.name(), found.error_degrees), (expected.name(), expected.error_degrees));
        }
    }
}

#[test]
fn a_large_map_is_measured_in_its_middle() {
    let figures = quick(&map_u8(300, 20, |x, _| x as u8), None, &MeasureOptions::default());
    assert_eq!(figures.region, Region { x: 22, y: 0, width: 256, height: 20 });
}

#[test]
fn steps_are_counted_and_can_be_stopped() {
    let (heights, monitor) = (bumps(), Monitor::default());
    let measured = Measured { heights: &heights, detail: None, models: &[], devices: &[Baker::cpu()] };
    let options = MeasureOptions { quick: true, runs: 1, ..Default::default() };
    let mut steps = Vec::new();
    measure(&measured, &options, &monitor, &mut |it| steps.push((it.done, it.of))).unwrap();
    assert_eq!(steps, (0..32 + 16 + 14 + 3 + 4).map(|done| (done, 69)).collect::<Vec<_>>());

    let stop = &mut |it: texbake::measure::Progress<'_>| {
        if it.done == 9 {
            monitor.cancel()
        }
    };
    assert!(matches!(measure(&measured, &options, &monitor, stop), Err(Error::Cancelled)));
}

#[test]
fn options_out_of_range_are_refused() {
    let heights = bumps();
    let measured = Measured { heights: &heights, detail: None, models: &[], devices: &[] };
    let refused = |options| measure(&measured, &options, &Monitor::default(), &mut |_| {}).unwrap_err().to_string();
    for elevation in [0.0, 0.99, 90.0, -1.0, f64::NAN] {
        let error = refused(MeasureOptions { elevation, ..Default::default() });
        assert_eq!(error, format!("elevation is {elevation}: it must be 1 degree or more, and below 90"));
    }
    for runs in [0, 1001, usize::MAX] {
        let error = refused(MeasureOptions { runs, ..Default::default() });
        assert_eq!(error, format!("runs is {runs}: it must be from 1 to 1000"));
    }
    // A ray at 1 degree crosses cot 1 = 57.29 texels for each texel of the scale: 16 384 of 285.99.
    let high = refused(MeasureOptions { elevation: 1.0, ..clamped("286") });
    assert!(high.starts_with("scale is 286: it must be at most 285 texels to be seen from 1"), "{high}");
}
