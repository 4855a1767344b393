//! Tangents on every device: the specification's bytes, in parts or whole, and sabotage that must be caught.

use super::device::Device;
use super::kernel::Kernel;
use super::tangents::{self, Limits};
use super::tangents_self_test::{accept, compare, noise};
use super::{Gpu, adapters};
use crate::backend::Backend;
use crate::mesh::{CornerAdjacency, Mesh};
use crate::ops::Precision;
use crate::ops::tangents::{Fans, Surface, TangentMethod, TangentPlan};
use std::borrow::Cow;

const METHODS: [TangentMethod; 3] = [TangentMethod::Lengyel, TangentMethod::Hegde, TangentMethod::Mikktspace];

/// Runs a test on a plan for a mesh, each vertex with one tangent.
fn with_plan<T>(
    mesh: &Mesh,
    normals: &[[f32; 3]],
    method: TangentMethod,
    precision: Precision,
    test: impl FnOnce(&TangentPlan<'_>) -> T,
) -> T {
    let surface = Surface::new(mesh, normals, true);
    let fans = Fans { corners: Cow::Owned(CornerAdjacency::of(mesh)), owners: None };
    test(&TangentPlan { method, precision, surface: &surface, fans: &fans })
}

/// Every kernel of every method and precision.
pub(super) fn kernels() -> Vec<Kernel> {
    let (mesh, normals) = noise(4, 1).unwrap();
    let of = |method, precision| with_plan(&mesh, &normals, method, precision, tangents::kernels);
    METHODS.iter().flat_map(|&method| [of(method, Precision::Exact), of(method, Precision::Fast)].concat()).collect()
}

/// The software devices that there are; those that are not fail the test where devices are required.
fn devices() -> Vec<Device> {
    let open = |selector| match adapters::select(Some(selector)) {
        Ok(adapter) => Some(Device::open(&adapter).unwrap()),
        Err(_) => {
            assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none_or(|value| value != "1"), "no {selector}");
            println!("not tested: no {selector}");
            None
        }
    };
    ["vulkan:llvmpipe", "vulkan:swiftshader", "gl:llvmpipe"].into_iter().filter_map(open).collect()
}

#[test]
fn every_device_computes_the_references_bytes() {
    for device in devices() {
        for method in METHODS {
            let start = std::time::Instant::now();
            for (vertices, seed) in [(1, 2), (3, 3), (5000, 4)] {
                let (mesh, normals) = noise(vertices, seed).unwrap();
                with_plan(&mesh, &normals, method, Precision::Exact, |plan| {
                    compare(&device, plan, Limits::of(&device)).unwrap();
                });
                eprintln!("{} {method:?} {vertices} {:?}", device.name, start.elapsed());
            }
        }
    }
}
