//! A device that is slow: its dispatches become smaller. One that is silent is given up.

use super::{Job, bakers, lavapipe};
use crate::Baker;
use crate::backend::gpu::bake as device_bake;
use crate::backend::gpu::device::Device;
use crate::backend::gpu::kernel::{BAKE_INTEGERS, KernelSource};
use crate::backend::gpu::operation::Doubt;
use crate::backend::gpu::tangents::{Limits, run};
use crate::backend::gpu::tangents_self_test::noise;
use crate::map::{Grid, HeightMap, NormalFormat, NormalMap};
use crate::mesh::CornerAdjacency;
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, BakePlan, NormalOptions};
use crate::ops::tangents::{Fans, Surface, TangentMethod, TangentPlan, tangents_of_fans};
use crate::stream::{MapBands, MapSink};
use std::borrow::Cow;
use std::time::Duration;

/// Two million steps, of which no compiler makes fewer, for each invocation that has something to compute: tens of
/// milliseconds for a workgroup. llvmpipe leaves a loop after 65535 turns.
const LOOP: &str = "
    var spin = params.nonce + id.x;
    for (var turn = 0u; turn < 65000u; turn++) {
        SPIN
    }
    // The square of no number; a driver that compiles for the values of params cannot leave the loop out either.
    if (spin * spin == 5u) {
        return;
    }
";

/// Lavapipe, on which the kernel of a source is slow from a line on.
fn slow(source: KernelSource, line: &str) -> Option<Device> {
    let device = lavapipe()?;
    let text = source.text();
    assert!(text.contains(line), "{}: no {line:?}", source.name);
    let steps = "spin = spin * spin + 1013904223u;\n".repeat(32);
    device.substitute(source, &text.replacen(line, &[&LOOP.replace("SPIN", &steps), line].concat(), 1));
    Some(device)
}

/// Lavapipe, on which integer heights are baked slowly.
fn slow_bakes() -> Option<Device> {
    slow(BAKE_INTEGERS, "let here = params.body")
}

/// Texels of a row: one workgroup.
const WIDTH: usize = 256;

/// Bakes so many rows in bands of four, and compares the bytes.
fn bake(device: &Device, rows: usize) {
    let heights: HeightMap = Grid::from_fn(WIDTH, rows, |x, y| (x * x / 7 + 29 * y) as u8).unwrap().into();
    let plan = BakePlan::new(&BakeOptions::default(), heights.size(), heights.height_type()).unwrap();
    let mut map = NormalMap::zeroed(plan.size, NormalFormat::default());
    let mut bands = MapBands::new(&heights, plan.edges.y, 4);
    device_bake::run(device, &plan, Doubt::Near, &mut bands, &mut [&mut MapSink::new(map.codes_mut(), 3 * WIDTH)])
        .unwrap();
    assert!(map == Baker::reference().normal(&heights, &NormalOptions::default()).unwrap(), "{rows} rows");
}

/// Rows of the dispatches in which a device bakes so many rows, in their order.
fn rows_of_dispatches(device: Device, rows: usize) -> Vec<usize> {
    bake(&device, rows);
    rows_submitted(&device)
}

fn rows_submitted(device: &Device) -> Vec<usize> {
    device.pace.submitted("bake").into_iter().map(|texels| texels / WIDTH).collect()
}

#[test]
fn slow_dispatches_are_halved_down_to_a_row() {
    let Some(mut device) = slow_bakes() else { return };
    device.pace.longest = Duration::from_millis(1);
    let rows = rows_of_dispatches(device, 28);
    assert!(rows.starts_with(&[4; 4]) && rows.is_sorted_by(|a, b| a >= b) && rows.ends_with(&[1]), "{rows:?}");
}

#[test]
fn slow_dispatches_stay_as_they_are_where_they_may_take_long() {
    let Some(mut device) = slow_bakes() else { return };
    device.pace.longest = Duration::MAX;
    assert_eq!(rows_of_dispatches(device, 28), [4; 7]);
}

/// Lavapipe, on which every dispatch takes longer than it may.
fn impatient() -> Option<Device> {
    let mut device = lavapipe()?;
    device.pace.longest = Duration::ZERO;
    Some(device)
}

#[test]
fn each_dispatch_that_took_too_long_halves_those_after_it() {
    let Some(device) = impatient() else { return };
    // Three are in flight, and the first is not judged: when the fifth is sent, the second has been seen to be slow.
    assert_eq!(rows_of_dispatches(device, 28), [4, 4, 4, 4, 2, 2, 2, 1, 1, 1, 1, 1, 1]);
}

#[test]
fn dispatches_grow_again_once_they_are_short() {
    let Some(mut device) = impatient() else { return };
    bake(&device, 28);
    let before = rows_submitted(&device).len();
    device.pace.longest = Duration::MAX;
    bake(&device, 28);
    let rows = rows_submitted(&device).split_off(before);
    // One row was too much, so it begins with half of one; what is seen of a dispatch counts three dispatches later.
    assert_eq!(rows, [1, 1, 1, 1, 2, 2, 2, 2, 4, 4, 4, 4]);
}

#[test]
fn dispatches_of_tangents_are_halved_down_to_a_workgroup() {
    let Some(device) = impatient() else { return };
    let (mesh, normals) = noise(700, 9).unwrap();
    let surface = Surface::new(&mesh, &normals, false);
    let fans = Fans { corners: Cow::Owned(CornerAdjacency::of(&mesh)), owners: None };
    let (method, precision) = (TangentMethod::Lengyel, Precision::Exact);
    let plan = TangentPlan { method, precision, surface: &surface, fans: &fans };
    let limits = Limits { dispatch: 200, ..Limits::of(&device) };
    let mut got = vec![[f32::NAN; 4]; fans.count()];
    run(&device, &plan, limits, &mut got).unwrap();
    let mut expected = vec![[f32::INFINITY; 4]; fans.count()];
    tangents_of_fans(&plan, &mut expected);
    assert!(bytemuck::cast_slice::<_, u8>(&got) == bytemuck::cast_slice::<_, u8>(&expected));
    // 1405 triangles, 713 fans. Half of 100 is less than a workgroup. Each kernel has its own pace.
    assert_eq!(device.pace.submitted("frames"), [200, 200, 200, 200, 100, 100, 100, 64, 64, 64, 64, 49]);
    assert_eq!(device.pace.submitted("tangents"), [200, 200, 200, 113]);
}

#[test]
fn a_device_that_does_not_answer_is_given_up() {
    let heights: HeightMap = Grid::from_fn(WIDTH, 8, |x, y| (x * x / 7 + 29 * y) as u8).unwrap().into();
    let job = Job::new("slow", "bake", move |baker: &Baker| {
        Ok(baker.normal(&heights, &NormalOptions::default())?.codes().bytes().to_vec())
    });
    for falls_back in [true, false] {
        let Some(mut device) = slow_bakes() else { return };
        device.patience = Duration::ZERO;
        let (gpu, relieved, alone) = bakers(device);
        if falls_back {
            assert!((job.run)(&relieved).unwrap() == job.expected());
        } else {
            let error = (job.run)(&alone).unwrap_err().to_string();
            assert!(error.ends_with(": it has not answered for 0ns"), "{error}");
        }
        let tried = gpu.device.pace.submitted("bake").len();
        (job.run)(&relieved).unwrap();
        assert_eq!(gpu.device.pace.submitted("bake").len(), tried, "it is not asked again");
    }
}
