//! Tangents on every device: the specification's bytes, in parts or whole, and sabotage that must be caught.

use super::device::Device;
use super::kernel::{Kernel, KernelSource};
use super::tangents::{self, Limits};
use super::tangents_self_test::{accept, compare, noise};
use super::{Gpu, Untested, adapters};
use crate::backend::Backend;
use crate::error::Result;
use crate::mesh::{CornerAdjacency, Mesh};
use crate::ops::Precision;
use crate::ops::tangents::{Fans, Surface, TangentMethod, TangentPlan, tangents_of_fans};
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
pub(super) fn devices() -> Vec<Device> {
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
            for (vertices, seed) in [(1, 2), (3, 3), (5000, 4)] {
                let (mesh, normals) = noise(vertices, seed).unwrap();
                with_plan(&mesh, &normals, method, Precision::Exact, |plan| {
                    compare(&device, plan, Limits::of(&device)).unwrap();
                });
            }
        }
    }
}

/// The tangents of a plan on a device.
fn computed(device: &Device, plan: &TangentPlan<'_>) -> Result<Vec<[f32; 4]>> {
    let mut tangents = vec![[f32::NAN; 4]; plan.fans.count()];
    tangents::run(device, plan, Limits::of(device), &mut tangents)?;
    Ok(tangents)
}

#[test]
fn the_noise_has_tangents_and_places_without() {
    let (mesh, normals) = noise(5000, 4).unwrap();
    for method in METHODS {
        let mut tangents = vec![[f32::NAN; 4]; normals.len()];
        with_plan(&mesh, &normals, method, Precision::Exact, |plan| tangents_of_fans(plan, &mut tangents));
        let undirected = tangents.iter().filter(|t| t[..3] == [0.0; 3]).count();
        let negative = tangents.iter().filter(|t| t[3] < 0.0).count();
        assert!((1..2000).contains(&undirected) && (1000..4000).contains(&negative), "{undirected} {negative}");
    }
}

#[test]
fn parts_of_a_mesh_give_the_same_bytes() {
    let Some(device) = devices().into_iter().next() else { return };
    let (mesh, normals) = noise(700, 5).unwrap();
    for method in METHODS {
        with_plan(&mesh, &normals, method, Precision::Exact, |plan| {
            let row = 1 << 12;
            for (words, dispatch) in [(usize::MAX, 64), (usize::MAX, 100), (9000, 1 << 18), (2000, 65)] {
                compare(&device, plan, Limits { words, dispatch, row }).unwrap();
            }
            // Rows of five corners and more are left to the CPU.
            compare(&device, plan, Limits { row: 4, ..Limits::of(&device) }).unwrap();
            let error = compare(&device, plan, Limits { words: 30, dispatch: 64, row }).unwrap_err().to_string();
            assert!(error.contains("a tangent of too many triangles"), "{error}");
        });
    }
}

#[test]
fn fast_tangents_are_finite_and_near() {
    for device in devices() {
        let (rough, any_normals) = noise(5000, 6).unwrap();
        let (torus, normals) = torus(40, 30);
        for method in METHODS {
            let lengths = with_plan(&rough, &any_normals, method, Precision::Fast, |plan| computed(&device, plan));
            for tangent in lengths.unwrap() {
                let [x, y, z, w] = tangent;
                let square = x * x + y * y + z * z;
                assert!(w.abs() == 1.0 && (square == 0.0 || (square - 1.0).abs() < 1e-5), "{method:?}: {tangent:?}");
            }
            let fast = with_plan(&torus, &normals, method, Precision::Fast, |plan| computed(&device, plan)).unwrap();
            let mut exact = vec![[f32::NAN; 4]; fast.len()];
            with_plan(&torus, &normals, method, Precision::Exact, |plan| tangents_of_fans(plan, &mut exact));
            for (fast, exact) in fast.as_flattened().iter().zip(exact.as_flattened()) {
                assert!((fast - exact).abs() < 1e-4, "{method:?}: {fast} instead of {exact}");
            }
        }
    }
}

/// A torus of `around` by `across` squares, each cut in two, whose texture is not stretched evenly.
pub(super) fn torus(around: u32, across: u32) -> (Mesh, Vec<[f32; 3]>) {
    let turn = |part: u32, of: u32| (std::f32::consts::TAU * part as f32 / of as f32).sin_cos();
    let vertices = (0..=across).flat_map(|j| (0..=around).map(move |i| (i, j)));
    let at = |i, j| j * (around + 1) + i;
    let (mut positions, mut texcoords, mut normals) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j) in vertices {
        let ((s, c), (t, d)) = (turn(i, around), turn(j, across));
        positions.push([(3.0 + d) * c, (3.0 + d) * s, t]);
        normals.push([d * c, d * s, t]);
        texcoords.push([i as f32 / around as f32, (j as f32 / across as f32).powi(2)]);
    }
    let squares = (0..across).flat_map(|j| (0..around).map(move |i| (i, j)));
    let triangles = squares
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]);
    (Mesh::new(positions, texcoords, triangles.collect()).unwrap(), normals)
}

/// Lavapipe; `None` where it is not installed.
fn lavapipe() -> Option<Device> {
    devices().into_iter().find(|device| device.name.starts_with("vulkan:llvmpipe"))
}

/// Lavapipe with another line in a kernel.
fn sabotaged(source: KernelSource, from: &str, to: &str) -> Option<Device> {
    let text = source.text();
    assert!(text.contains(from), "{}: no {from:?}", source.name);
    let device = lavapipe()?;
    device.substitute(source, &text.replacen(from, to, 1));
    Some(device)
}

#[test]
fn a_kernel_that_computes_wrong_tangents_is_refused_before_its_first_job() {
    let [lengyel, hegde, mikktspace] = METHODS;
    let (mesh, normals) = noise(9, 1).unwrap();
    let mut unnoticed = Vec::new();
    for (method, kernel, from, to) in [
        (lengyel, 0, "inputs[at + 2u]);\n}", "inputs[at + 1u]);\n}"),
        (lengyel, 0, "zero_below(SMALLEST_DIFFERENCE, edges.y2)", "edges.y2"),
        (lengyel, 0, "^ (determinant & SIGN)", ""),
        (lengyel, 0, "shifted_sticky(normal, max(1 - e, 0))", "normal"),
        (lengyel, 1, "<< u32(zeros_before(a))", ""),
        (lengyel, 0, "(n + 3u +", "(n + 4u +"),
        (lengyel, 1, "LEAST_SUM: u32 = 0x37800000u", "LEAST_SUM: u32 = 0x00000000u"),
        (lengyel, 1, "LEAST_SQUARE: u32 = 0x2f800000u", "LEAST_SQUARE: u32 = 0x00000000u"),
        (lengyel, 1, "cross3(sum[0], sum[1])", "cross3(sum[1], sum[0])"),
        (hegde, 0, "^ vec3(turned)", ""),
        (hegde, 0, "if (is_zero(n))", "if (false)"),
        (hegde, 1, "max(max(magnitudes.x, magnitudes.y), magnitudes.z)", "max(magnitudes.x, magnitudes.y)"),
        (mikktspace, 0, "params.nonce | turned", "params.nonce"),
        (mikktspace, 0, "if ((area & ~SIGN) != 0u)", "if (true)"),
        (mikktspace, 1, "proof & SIGN, i == begin", "proof & SIGN, i + 1u == end"),
        (mikktspace, 1, "other - 3u, other > 2u", "other - 2u, other > 2u"),
        (mikktspace, 1, "min(cosine & ~SIGN, ONE)", "min(cosine & ~SIGN, HALF)"),
        (mikktspace, 1, "(cosine & ~SIGN) <= HALF", "true"),
        (mikktspace, 1, "vec2(0x00000000u, 0x80000000u),", "vec2(0x00000000u, 0x80000100u),"),
        (mikktspace, 1, "step < 2u", "step < 0u"),
        (mikktspace, 1, "k < LONG_TERMS; k++", "k < 8u; k++"),
    ] {
        with_plan(&mesh, &normals, method, Precision::Exact, |plan| {
            let source = tangents::kernels(plan)[kernel].source;
            let Some(device) = sabotaged(source, from, to) else { return };
            let gpu = Gpu { untested: Untested { device } };
            let refused = gpu.tangents(plan, &mut vec![[0.0; 4]; plan.fans.count()]);
            match refused {
                Ok(()) => unnoticed.push(from),
                Err(error) => assert!(error.to_string().contains("fails the self-test: tangents: "), "{from}: {error}"),
            }
        });
    }
    assert!(unnoticed.is_empty(), "{unnoticed:?}");
}

#[test]
fn what_was_not_computed_is_noticed() {
    let (mesh, normals) = noise(100, 7).unwrap();
    for method in METHODS {
        with_plan(&mesh, &normals, method, Precision::Fast, |plan| {
            let proof = if method == TangentMethod::Mikktspace { "params.nonce | turned" } else { "params.nonce;" };
            for (kernel, from, to) in [
                (0, "triangle >= params.end", "true"),
                (0, proof, "0u;//"),
                (1, "fan >= params.end", "true"),
                (1, "fan >= params.end", "fan >= params.end - 1u"),
                (1, "params.nonce | tangent.turned", "params.nonce + 2u"),
            ] {
                let Some(device) = sabotaged(tangents::kernels(plan)[kernel].source, from, to) else { return };
                let error = computed(&device, plan).expect_err(to).to_string();
                assert!(error.contains("came back without having been computed"), "{from}: {error}");
            }
        });
    }
}

#[test]
fn a_lost_device_is_an_error() {
    let Some(device) = lavapipe() else { return };
    let (mesh, normals) = noise(100, 8).unwrap();
    with_plan(&mesh, &normals, TangentMethod::Mikktspace, Precision::Exact, |plan| {
        accept(&device, plan).unwrap();
        assert!(tangents::kernels(plan).iter().all(|kernel| device.is_tested(kernel)));
        device.device.destroy();
        let [first, again] = [(); 2].map(|()| computed(&device, plan).unwrap_err().to_string());
        assert!(first.contains("lost") && again.contains("lost"), "{first}; {again}");
    });
}
