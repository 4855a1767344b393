//! Faults, really caused: each must end as an error that says what happened, and with the CPU to take over in the
//! right maps. None may leave a wrong row.

mod batch;
mod limits;
mod lost;
mod memory;
mod returned;
mod slow;

use super::device::Device;
use super::self_test::scrambled;
use super::tangents_self_test::noise;
use super::{Untested, adapters};
use crate::Baker;
use crate::error::Result;
use crate::map::{Depth, Encoding, Grid, HeightMap, HeightType, NormalFormat, NormalMap, ParallaxFormat};
use crate::mesh::Mesh;
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, NormalOptions};
use crate::ops::blend::{BlendInputs, BlendOptions};
use crate::ops::tangents::{TangentMethod, TangentOptions};
use std::sync::Arc;
use wgpu::{Adapter, Backends, DeviceDescriptor, Instance, InstanceDescriptor, Limits, MemoryBudgetThresholds};

/// Lavapipe; `None` where it is not installed.
fn lavapipe() -> Option<Device> {
    let Ok(adapter) = adapters::select(Some("vulkan:llvmpipe")) else { return none() };
    Some(Device::open(&adapter).unwrap())
}

/// Lavapipe with buffers and bindings of no more than so many bytes.
fn with_buffers_of(bytes: u64) -> Option<Device> {
    let adapter = adapters::select(Some("vulkan:llvmpipe")).ok().or_else(none)?;
    let required_limits =
        Limits { max_buffer_size: bytes, max_storage_buffer_binding_size: bytes, ..Limits::downlevel_defaults() };
    Some(opened(&adapter, &DeviceDescriptor { required_limits, ..Default::default() }).unwrap())
}

/// The adapter of lavapipe on which these thresholds hold.
fn lavapipe_below(memory_budget_thresholds: MemoryBudgetThresholds) -> Option<Adapter> {
    let descriptor = InstanceDescriptor {
        backends: Backends::VULKAN,
        memory_budget_thresholds,
        ..InstanceDescriptor::new_without_display_handle()
    };
    let adapters = pollster::block_on(Instance::new(descriptor).enumerate_adapters(Backends::VULKAN));
    adapters.into_iter().find(|adapter| adapter.get_info().name.contains("llvmpipe")).or_else(none)
}

/// A device as [`Device::open`] opens it, but by this descriptor.
fn opened(adapter: &Adapter, descriptor: &DeviceDescriptor<'_>) -> Result<Device, wgpu::RequestDeviceError> {
    let (device, queue) = pollster::block_on(adapter.request_device(descriptor))?;
    let device = Device::new(adapters::describe(&adapter.get_info()), device, queue);
    device.watch();
    Ok(device)
}

fn none<T>() -> Option<T> {
    assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none_or(|value| value != "1"), "no lavapipe");
    println!("not tested: no lavapipe");
    None
}

/// A device to strike, and two bakers on it: one that the CPU relieves, and one that fails with it.
fn bakers(device: Device) -> (Arc<Untested>, Baker, Baker) {
    let gpu = Arc::new(Untested { device });
    let [relieved, alone] = [true, false].map(|falls_back| Baker::prepared(gpu.clone(), falls_back));
    (gpu, relieved, alone)
}

/// What a baker does: it gives the bytes of all outputs.
type Run = dyn Fn(&Baker) -> Result<Vec<u8>>;

/// One operation on one set of inputs.
struct Job {
    name: String,
    entry_point: &'static str,
    run: Box<Run>,
}

impl Job {
    fn new(
        name: impl Into<String>,
        entry_point: &'static str,
        run: impl Fn(&Baker) -> Result<Vec<u8>> + 'static,
    ) -> Self {
        Self { name: name.into(), entry_point, run: Box::new(run) }
    }

    /// The bytes that no fault may change.
    fn expected(&self) -> Vec<u8> {
        (self.run)(&Baker::reference()).unwrap()
    }
}

/// Every operation, `exact`, in each of its arithmetics, on maps of [`SIZE`] and on a mesh.
fn jobs() -> Vec<Job> {
    let mut jobs = vec![
        bake(heights(HeightType::U8, 1), NormalFormat::default()),
        bake(heights(HeightType::U16, 2), NormalFormat { depth: Depth::Bits16, ..Default::default() }),
        bake(heights(HeightType::F32, 3), float()),
        blend(NormalFormat::default()),
        blend(float()),
        parallax(NormalFormat::default()),
        parallax(float()),
    ];
    jobs.extend([TangentMethod::Lengyel, TangentMethod::Hegde, TangentMethod::Mikktspace].map(tangents));
    jobs
}

/// Columns and rows of the maps.
const SIZE: [usize; 2] = [50, 40];

fn float() -> NormalFormat {
    NormalFormat { encoding: Encoding::Float, depth: Depth::Float32, ..Default::default() }
}

/// Heights without pattern.
fn heights(height_type: HeightType, seed: u32) -> HeightMap {
    let [width, height] = SIZE;
    let bits = |x: usize, y: usize| scrambled(seed * 10_000 + (y * width + x) as u32);
    match height_type {
        HeightType::U8 => Grid::from_fn(width, height, |x, y| bits(x, y) as u8).unwrap().into(),
        HeightType::U16 => Grid::from_fn(width, height, |x, y| bits(x, y) as u16).unwrap().into(),
        HeightType::F32 => {
            Grid::from_fn(width, height, |x, y| bits(x, y) as u16 as f32 / 65_535.0).unwrap().try_into().unwrap()
        }
    }
}

/// The normals of such heights.
fn normals(format: NormalFormat, seed: u32) -> NormalMap {
    let options = NormalOptions { format, ..Default::default() };
    Baker::reference().normal(&heights(HeightType::U16, seed), &options).unwrap()
}

fn bake(heights: HeightMap, format: NormalFormat) -> Job {
    let name = format!("bake of {} heights", heights.height_type());
    let options = BakeOptions { normal: Some(format), parallax: Some(ParallaxFormat::default()), ..Default::default() };
    Job::new(name, "bake", move |baker| {
        let maps = baker.bake(&heights, &options)?;
        let [normal, parallax] =
            [maps.normal.unwrap().codes().bytes().to_vec(), maps.parallax.unwrap().codes().bytes().to_vec()];
        Ok([normal, parallax].concat())
    })
}

fn blend(format: NormalFormat) -> Job {
    let [base, detail] = [4, 5].map(|seed| normals(format, seed));
    let options = BlendOptions { format, ..Default::default() };
    Job::new(format!("blend of {} maps", format.depth), "blend", move |baker| {
        let inputs = BlendInputs { base: &base, detail: &detail, mask: None };
        Ok(baker.blend(&inputs, &options)?.codes().bytes().to_vec())
    })
}

fn parallax(format: NormalFormat) -> Job {
    let (heights, normals) = (heights(HeightType::U8, 6), normals(format, 6));
    Job::new(format!("parallax map of {} normals", format.depth), "parallax", move |baker| {
        let map = baker.parallax_with_normals(&heights, &normals, ParallaxFormat::default(), Precision::Exact)?;
        Ok(map.codes().bytes().to_vec())
    })
}

fn tangents(method: TangentMethod) -> Job {
    let mesh = mesh();
    let options = TangentOptions { method, ..Default::default() };
    Job::new(format!("tangents by {method}"), "tangents", move |baker| {
        Ok(bytemuck::cast_slice(&baker.tangents(&mesh, &options)?.tangents).to_vec())
    })
}

/// A mesh of 100 vertices and 200 triangles without order.
fn mesh() -> Mesh {
    let (mesh, normals) = noise(100, 7).unwrap();
    mesh.with_normals(normals).unwrap()
}
