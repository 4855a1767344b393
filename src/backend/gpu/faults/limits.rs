//! Devices whose buffers and dispatches are small: what is too much at once goes in parts, and what is too wide for
//! any part is refused.

use super::{Job, bakers, jobs, lavapipe, opened, with_buffers_of};
use crate::Baker;
use crate::backend::gpu::adapters;
use crate::backend::gpu::device::Device;
use crate::error::Result;
use crate::map::{Edge, Edges, Grid, HeightMap};
use crate::ops::bake::NormalOptions;
use wgpu::{DeviceDescriptor, Limits};

/// The normal map of heights of this size.
fn normal_map(width: usize, height: usize) -> Job {
    let heights: HeightMap = Grid::from_fn(width, height, |x, y| (x * x / 7 + 29 * y) as u8).unwrap().into();
    let options = NormalOptions { edges: Edges::both(Edge::Clamp), ..Default::default() };
    Job::new(format!("{width} x {height}"), "bake", move |baker: &Baker| -> Result<Vec<u8>> {
        Ok(baker.normal(&heights, &options)?.codes().bytes().to_vec())
    })
}

/// Fails unless a device does a job itself, with the right bytes.
fn assert_done(device: Device, job: &Job) {
    let (_gpu, _, alone) = bakers(device);
    assert!((job.run)(&alone).unwrap() == job.expected(), "{}", job.name);
}

/// Fails unless a device refuses a job for this reason, and the CPU takes it over.
fn assert_refused(device: Device, job: &Job, reason: &str) {
    let (gpu, relieved, alone) = bakers(device);
    let error = (job.run)(&alone).unwrap_err().to_string();
    assert!(error.starts_with("vulkan:llvmpipe") && error.ends_with(reason), "{error}");
    assert!((job.run)(&relieved).unwrap() == job.expected(), "{}", job.name);
    assert!(gpu.device.pace.submitted(job.entry_point).is_empty(), "nothing was tried");
}

#[test]
fn parts_of_maps_and_meshes_give_the_same_bytes() {
    for job in jobs() {
        for bytes in [2048, 2500, 16_384] {
            let Some(device) = with_buffers_of(bytes) else { return };
            let (gpu, _, alone) = bakers(device);
            assert!((job.run)(&alone).unwrap() == job.expected(), "{} in buffers of {bytes} bytes", job.name);
            let parts = gpu.device.pace.submitted(job.entry_point).len();
            assert!(parts > 1 || bytes > 2500, "{} in buffers of {bytes} bytes: {parts} part", job.name);
        }
    }
}

#[test]
fn rows_go_one_at_a_time_where_there_is_room_for_one() {
    // 340 texels: three rows of heights are 1020 bytes; a row of codes and its mark are 1024.
    let Some(device) = with_buffers_of(1024) else { return };
    let (gpu, _, alone) = bakers(device);
    let job = normal_map(340, 5);
    assert!((job.run)(&alone).unwrap() == job.expected());
    assert_eq!(gpu.device.pace.submitted("bake"), [340; 5]);
}

#[test]
fn an_image_one_texel_wider_than_a_buffer_is_refused() {
    let Some(device) = with_buffers_of(1024) else { return };
    let reason = "rows of 341 texels are too wide for it: 1036 bytes in a buffer of at most 1024";
    assert_refused(device, &normal_map(341, 5), reason);
}

/// Lavapipe with dispatches of no more than two workgroups in a dimension.
fn of_two_workgroups() -> Option<Device> {
    let adapter = lavapipe().and_then(|_| adapters::select(Some("vulkan:llvmpipe")).ok())?;
    let required_limits = Limits { max_compute_workgroups_per_dimension: 2, ..Limits::downlevel_defaults() };
    Some(opened(&adapter, &DeviceDescriptor { required_limits, ..Default::default() }).unwrap())
}

#[test]
fn an_image_one_texel_wider_than_a_dispatch_is_refused() {
    // 64 invocations of four texels are a workgroup.
    let Some(device) = of_two_workgroups() else { return };
    assert_done(device, &normal_map(512, 5));
    let Some(device) = of_two_workgroups() else { return };
    let reason = "rows of 513 texels are too wide for it: 3 workgroups where 2 are allowed";
    assert_refused(device, &normal_map(513, 5), reason);
}

#[test]
fn an_image_one_texel_wider_than_any_devices_dispatch_is_refused() {
    let Some(device) = lavapipe() else { return };
    assert_done(device, &normal_map(65_535 * 256, 1));
    let Some(device) = lavapipe() else { return };
    let reason = "rows of 16776961 texels are too wide for it: 65536 workgroups where 65535 are allowed";
    assert_refused(device, &normal_map(65_535 * 256 + 1, 1), reason);
}

#[test]
fn no_dispatch_has_more_rows_than_the_device_allows() {
    let Some(device) = of_two_workgroups() else { return };
    let (gpu, _, alone) = bakers(device);
    let job = normal_map(10, 5);
    assert!((job.run)(&alone).unwrap() == job.expected());
    assert_eq!(gpu.device.pace.submitted("bake"), [20, 20, 10]);
}
