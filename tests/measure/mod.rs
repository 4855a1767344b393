//! Measurements: errors where closed forms know them, every combination counted, fronts of points that are written out.

mod blends;
#[cfg(feature = "cli")]
mod command;
mod frames;
mod fronts;
mod normals;
mod offsets;
mod whole;

use texbake::measure::{Figures, MeasureOptions, Measured, measure};
use texbake::stream::Monitor;
use texbake::{BakeOptions, Baker, Edge, Edges, HeightMap};

/// A quick measurement on the CPU.
fn quick(heights: &HeightMap, detail: Option<&HeightMap>, options: &MeasureOptions) -> Figures {
    let measured = Measured { heights, detail, models: &[], devices: &[Baker::cpu()] };
    let options = MeasureOptions { quick: true, runs: 1, ..options.clone() };
    measure(&measured, &options, &Monitor::default(), &mut |_| {}).unwrap()
}

/// A scale, and edges that clamp.
fn clamped(scale: &str) -> MeasureOptions {
    let edges = Edges::both(Edge::Clamp);
    let bake = BakeOptions { scale: crate::support::scale(scale), edges, ..Default::default() };
    MeasureOptions { bake, ..Default::default() }
}

/// Fails unless `found` is within `tolerance` of `expected`.
#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found} is not within {tolerance} of {expected}");
}
