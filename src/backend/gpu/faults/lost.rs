//! A device that is lost, and calls that wgpu refuses.

use super::{bakers, jobs, lavapipe, with_buffers_of};
use crate::backend::gpu::device::Device;
use crate::backend::gpu::operation::Doubt;
use crate::backend::gpu::{Hosted, bake as device_bake};
use crate::error::Result;
use crate::map::{Codes, Depth, Edge, Grid, HeightMap, TexelFormat};
use crate::ops::bake::{BakeOptions, BakePlan};
use crate::stream::{CodeSink, HeightBand, HeightBands, MapBands, MapSink};

/// Bands; before each, something is told which one it is.
pub(super) struct Told<'a, F> {
    pub bands: &'a mut dyn HeightBands,
    pub count: usize,
    pub before: F,
}

impl<F: FnMut(usize)> HeightBands for Told<'_, F> {
    fn next(&mut self) -> Result<Option<HeightBand<'_>>> {
        (self.before)(self.count);
        self.count += 1;
        self.bands.next()
    }
}

/// Bakes a map of 40 rows in bands of eight.
fn bake(device: &Device, before: impl FnMut(usize)) -> Result<()> {
    let map: HeightMap = Grid::from_fn(50, 40, |x, y| (x * y % 251) as u8).unwrap().into();
    let plan = BakePlan::new(&BakeOptions::default(), map.size(), map.height_type()).unwrap();
    let mut bands = Told { bands: &mut MapBands::new(&map, Edge::Wrap, 8), count: 0, before };
    let formats: Vec<TexelFormat> = plan.outputs().collect();
    let mut codes = Codes::zeroed(Depth::Bits8, map.size().texels() * formats[0].channels);
    let mut sink = MapSink::new(codes.as_mut(), formats[0].row_codes(map.size().width()));
    device_bake::run(device, &plan, Doubt::Near, &mut bands, &mut [&mut sink as &mut dyn CodeSink])
}

#[test]
fn a_device_lost_between_bands_is_an_error_then_and_later() {
    for lost_before in [0, 1, 3, 5] {
        let Some(device) = lavapipe() else { return };
        let error = bake(&device, |band| {
            if band == lost_before {
                device.device.destroy();
            }
        });
        let first = error.expect_err("a lost device").to_string();
        assert!(first.starts_with("vulkan:llvmpipe"), "{first}");
        let again = bake(&device, |_| ()).expect_err("still lost").to_string();
        assert!(first.contains("lost") && again.contains("lost"), "before band {lost_before}: {first}; {again}");
    }
}

#[test]
fn any_operation_on_a_lost_device_is_left_to_the_cpu() {
    for job in jobs() {
        let Some(device) = lavapipe() else { return };
        let (gpu, relieved, alone) = bakers(device);
        gpu.device.device.destroy();
        assert!((job.run)(&relieved).unwrap() == job.expected(), "{}", job.name);
        let error = (job.run)(&alone).unwrap_err().to_string();
        assert!(error.contains("the device was lost"), "{}: {error}", job.name);
    }
}

#[test]
fn a_lost_device_hosts_nothing() {
    let Some(device) = lavapipe() else { return };
    device.device.destroy();
    let error = Hosted::new(&device.device, &device.queue).err().expect("a lost device").to_string();
    assert!(error.starts_with("vulkan:llvmpipe"), "{error}");
}

#[test]
fn what_wgpu_refuses_is_an_error_of_the_call_that_caused_it() {
    let Some(device) = with_buffers_of(1 << 20) else { return };
    let too_large = wgpu::BufferDescriptor {
        label: None,
        size: 1 << 21,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    };
    let error = device.guarded(|| Ok(device.device.create_buffer(&too_large))).map(drop).unwrap_err().to_string();
    assert!(error.contains("greater than the maximum buffer size"), "{error}");
    assert!(bake(&device, |_| ()).is_ok(), "the next job does not suffer for it");
}
