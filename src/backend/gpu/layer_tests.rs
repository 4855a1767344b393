//! Operations on several maps: the limits that choose their arithmetic, and sabotage that must be caught.

use super::blend::s_bits;
use super::device::Device;
use super::kernel::Kernel;
use super::layers::{LayerOperation, accept, compare};
use super::operation::Operation;
use crate::exact::Rational;
use crate::map::{Channels, Convention, Depth, Encoding, HeightType, NormalFormat, ParallaxFormat, Size};
use crate::ops::Precision;
use crate::ops::blend::{BlendMethod, BlendOptions, BlendPlan, blend_integers};
use crate::ops::parallax::ParallaxPlan;

const UNORM8: NormalFormat = format(Encoding::Unorm, Depth::Bits8);
const SNORM8: NormalFormat = format(Encoding::Snorm, Depth::Bits8);
const UNORM16: NormalFormat = format(Encoding::Unorm, Depth::Bits16);
const FLOAT16: NormalFormat = format(Encoding::Float, Depth::Float16);
const FLOAT32: NormalFormat = format(Encoding::Float, Depth::Float32);

const fn format(encoding: Encoding, depth: Depth) -> NormalFormat {
    NormalFormat { encoding, depth, channels: Channels::Xyz, convention: Convention::Gl }
}

fn xy(format: NormalFormat) -> NormalFormat {
    NormalFormat { channels: Channels::Xy, ..format }
}

/// Base and detail, then the result.
fn blend(method: BlendMethod, [base, detail, format]: [NormalFormat; 3], mask: Option<HeightType>) -> BlendPlan {
    let options = BlendOptions { method, format, ..Default::default() };
    BlendPlan::new(&options, Size::new(5, 5).unwrap(), [base, detail], mask).unwrap()
}

fn masked(formats: [NormalFormat; 3], mask: HeightType) -> BlendPlan {
    blend(BlendMethod::Masked, formats, Some(mask))
}

fn weighted(base: i32, detail: i32) -> BlendMethod {
    BlendMethod::Weighted { base: base.into(), detail: detail.into() }
}

fn parallax(heights: HeightType, normals: NormalFormat, stored: NormalFormat) -> ParallaxPlan {
    let format = ParallaxFormat { encoding: stored.encoding, depth: stored.depth };
    ParallaxPlan::new(Size::new(5, 5).unwrap(), heights, normals, format, Precision::Exact).unwrap()
}

/// A kernel of every arithmetic of either operation.
pub(super) fn kernels() -> Vec<Kernel> {
    let add = |formats| blend(BlendMethod::add(), formats, None);
    let fast_blend = BlendPlan { precision: Precision::Fast, ..add([UNORM8; 3]) };
    let fast_parallax = ParallaxPlan { precision: Precision::Fast, ..parallax(HeightType::U8, UNORM8, UNORM8) };
    let blends = [add([UNORM8; 3]), masked([UNORM8, xy(FLOAT32), UNORM8], HeightType::U8), fast_blend];
    let parallaxes =
        [parallax(HeightType::U8, UNORM8, UNORM8), parallax(HeightType::F32, UNORM8, UNORM8), fast_parallax];
    blends.iter().map(Operation::kernel).chain(parallaxes.iter().map(Operation::kernel)).collect()
}

/// Every method, with the mask and the weights that it takes.
fn methods() -> Vec<(BlendMethod, Option<HeightType>)> {
    let mut methods: Vec<_> = [
        weighted(1, 1),
        weighted(65535, -65535),
        BlendMethod::Weighted { base: Rational::new(-7, 65535).unwrap(), detail: Rational::new(3, 5).unwrap() },
        BlendMethod::Linear,
        BlendMethod::Overlay,
        BlendMethod::Udn,
        BlendMethod::Whiteout,
        BlendMethod::Rnm,
    ]
    .map(|method| (method, None))
    .into();
    methods.extend([HeightType::U8, HeightType::U16].map(|mask| (BlendMethod::Masked, Some(mask))));
    methods
}

#[test]
fn no_sum_is_beyond_its_limit() {
    for (method, mask) in methods() {
        for formats in [[UNORM8; 3], [SNORM8, UNORM16, UNORM8], [UNORM16; 3]] {
            let plan = blend(method, formats, mask);
            let [l1, l2] = plan.integer_scales().unwrap();
            let [leaning, z] = plan.greatest_parts([l1, l2]);
            let extremes = |l: i32| {
                let components = move || [-l, -l / 2, 0, l];
                let xy = components().into_iter().flat_map(move |x| components().map(|y| [x, y]));
                xy.flat_map(move |[x, y]| [1, l].map(|z| [x, y, z])).collect::<Vec<_>>()
            };
            let weights = match plan.mask {
                Some(mask) => [0, 1, mask.greatest as i32].map(|t| [mask.greatest as i32 - t, t, mask.greatest as i32]),
                None => [[plan.weights.base, plan.weights.detail, plan.weights.q as i32]; 3],
            };
            let mut greatest = 0;
            for (v1, v2) in extremes(l1).into_iter().flat_map(|v1| extremes(l2).into_iter().map(move |v2| (v1, v2))) {
                for weights in weights {
                    let sum = blend_integers(method, weights, [l1, l2], v1, v2);
                    let sum = sum.map(|part| u128::from(part.unsigned_abs()));
                    assert!(sum[0].max(sum[1]) <= leaning && sum[2] <= z, "{method:?}, {v1:?} and {v2:?}: {sum:?}");
                    greatest = sum.into_iter().max().unwrap().max(greatest);
                }
            }
            assert!(2 * greatest >= leaning.max(z), "{method:?}: {greatest}, not {leaning} or {z}");
        }
    }
}

#[test]
fn each_blend_takes_as_few_bits_as_it_needs() {
    let rnm = |formats| blend(BlendMethod::Rnm, formats, None);
    for (bits, plan) in [
        (64, blend(BlendMethod::add(), [UNORM8; 3], None)),
        (64, masked([SNORM8; 3], HeightType::U8)),
        (96, masked([UNORM8; 3], HeightType::U8)),
        (96, rnm([UNORM8; 3])),
        (96, blend(BlendMethod::add(), [UNORM16; 3], None)),
        (96, masked([UNORM16; 3], HeightType::U8)),
        (128, rnm([UNORM16; 3])),
        (128, masked([UNORM16; 3], HeightType::U16)),
        (128, blend(weighted(65535, 1), [UNORM16; 3], None)),
        (128, blend(BlendMethod::add(), [UNORM8, UNORM8, FLOAT32], None)),
    ] {
        assert_eq!(s_bits(&plan), bits, "{:?} of {:?}", plan.method, plan.inputs);
    }
}

/// lavapipe twice: a device that keeps its kernels, and an adapter for those that do not.
fn lavapipe() -> Option<(Device, wgpu::Adapter)> {
    let Ok(adapter) = super::adapters::select(Some("vulkan:llvmpipe")) else {
        assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none(), "no lavapipe");
        eprintln!("skipped: no lavapipe");
        return None;
    };
    Some((Device::open(&adapter).unwrap(), adapter))
}

/// The kernel of a plan passes the test before its first job, and one with another line does not.
fn assert_noticed(honest: &Device, adapter: &wgpu::Adapter, plan: &impl LayerOperation, from: &str, to: &str) {
    let kernel = plan.kernel();
    let text = kernel.source.text();
    assert!(text.contains(from), "{}: no {from:?}", kernel.source.name);
    accept(honest, plan).unwrap();
    assert!(honest.is_tested(&kernel), "{from}");
    let device = Device::open(adapter).unwrap();
    device.substitute(kernel.source, &text.replacen(from, to, 1));
    let error = accept(&device, plan).expect_err(from).to_string();
    assert!(error.contains(&format!("fails the self-test: {}: wrong", kernel.source.entry_point)), "{from}: {error}");
    assert!(!device.is_tested(&kernel), "{from}");
}

#[test]
fn a_blend_that_computes_wrong_bytes_is_refused_before_its_first_job() {
    let Some((honest, adapter)) = lavapipe() else { return };
    let add = |formats| blend(BlendMethod::add(), formats, None);
    let dx = NormalFormat { convention: Convention::Dx, ..FLOAT16 };
    for (plan, from, to) in [
        // How codes are read.
        (add([UNORM8, UNORM8, UNORM16]), "(u == vec4(1))", "(u == vec4(3))"),
        (add([SNORM8; 3]), "vec4(-input.greatest)", "vec4(-input.greatest - 1)"),
        (add([UNORM16; 3]), "a.z, a.w >> 16u", "a.w, a.w >> 16u"),
        (add([xy(UNORM16); 3]), "- xx;", "- 0u * xx;"),
        (add([xy(UNORM8), UNORM8, xy(UNORM16)]), "words >> vec4(8u)", "words >> vec4(16u)"),
        (add([dx, FLOAT32, UNORM8]), "let turned = y ^ select(0u, SIGN, input.green < 0)", "let turned = y"),
        (add([FLOAT16; 3]), "at_least(LEAST_Z, codes.z)", "codes.z"),
        (add([xy(FLOAT32); 3]), "at_least(LEAST_ZZ, zz)", "zz & ~SIGN"),
        (
            masked([SNORM8; 3], HeightType::U8),
            "greatest - vec4<i32>(transition)",
            "greatest - vec4<i32>(transition >> vec4(1u))",
        ),
        (masked([UNORM16; 3], HeightType::U16), "(words >> vec4(0u, 16u, 0u, 16u))", "words"),
        // The sum.
        (add([UNORM8; 3]), "+ by.r * by.g * v2", "- by.r * by.g * v2"),
        (add([UNORM16; 3]), "- select(0u, a.x, b < 0)", ""),
        (blend(weighted(-2, 3), [UNORM8; 3], None), "vec3(weights.yy, weights.z)", "weights.yyy"),
        (blend(BlendMethod::Overlay, [UNORM8; 3], None), "vec3(l1) - abs(v1)", "vec3(l1) - v1"),
        (blend(BlendMethod::Udn, [UNORM8; 3], None), "vec3(l1, l1, 0)", "vec3(l1)"),
        (blend(BlendMethod::Whiteout, [UNORM8; 3], None), "vec3(l2, l2, 0)", "vec3(l2)"),
        (blend(BlendMethod::Rnm, [UNORM16; 3], None), "negated(leaning)", "leaning"),
        (blend(BlendMethod::Overlay, [FLOAT32; 3], None), "sub(ONE, v1[axis] & ~SIGN)", "sub(ONE, v1[axis])"),
        (blend(BlendMethod::Rnm, [FLOAT32; 3], None), "sub(tu, v2.z)", "tu"),
        // The same in floats.
        (add([UNORM8; 3]), "p * v1.y + r * v2.y", "p * v1.y - r * v2.y"),
        (blend(BlendMethod::Rnm, [UNORM8; 3], None), "ltz * v2.x", "tz * v2.x"),
        (blend(BlendMethod::Overlay, [UNORM8; 3], None), "(l1 - abs(v1.y)) * v2.y", "(l1 - v1.y) * v2.y"),
        (add([UNORM8; 3]), "(output.code_offset - 128)", "(output.code_offset - 127)"),
        (add([UNORM8, UNORM8, UNORM16]), "excess >= vec4(0.0)", "excess < vec4(0.0)"),
        // The rounding.
        (add([UNORM8; 3]), "let ma = u32(output.code_m) * a", "let ma = u32(output.code_m + 1) * a"),
        (add([UNORM16; 3]), "times96(aa, u32(output.code_m)", "times96(aa, u32(output.code_m + 1)"),
        (
            masked([UNORM16; 3], HeightType::U16),
            "times128(aa, u32(output.code_m)",
            "times128(aa, u32(output.code_m + 1)",
        ),
        (add([UNORM16, UNORM16, FLOAT32]), "let inexact = u32(", "let inexact = 0u * u32("),
    ] {
        assert_noticed(&honest, &adapter, &plan, from, to);
    }
}

#[test]
fn a_parallax_map_of_wrong_bytes_is_refused_before_its_first_job() {
    let Some((honest, adapter)) = lavapipe() else { return };
    for (plan, from, to) in [
        (parallax(HeightType::U8, UNORM8, SNORM8), "normal.z * u32(abs(h))", "normal.z * u32(abs(h + 1))"),
        (
            parallax(HeightType::U16, UNORM16, UNORM16),
            "product(normal.z, u32(abs(h)))",
            "product(normal.z, u32(abs(h + 1)))",
        ),
        (
            parallax(HeightType::U16, xy(UNORM8), FLOAT16),
            "nearest_float(PARALLAX_BITS, h < 0",
            "nearest_float(PARALLAX_BITS, h > 0",
        ),
        (parallax(HeightType::F32, UNORM8, SNORM8), "min(height, ONE)", "height"),
        (
            parallax(HeightType::U8, FLOAT32, FLOAT32),
            "mul(bits_of(f32(height)), params.heights.over_greatest)",
            "bits_of(f32(height))",
        ),
        (parallax(HeightType::F32, FLOAT16, UNORM8), "unit(normal).z", "unit(normal).y"),
    ] {
        assert_noticed(&honest, &adapter, &plan, from, to);
    }
}

#[test]
fn any_size_in_any_bands_is_the_references() {
    let Some((device, _)) = lavapipe() else { return };
    let blend = masked([UNORM8, xy(UNORM16), SNORM8], HeightType::U8);
    let floats = masked([xy(FLOAT16), FLOAT32, xy(UNORM16)], HeightType::U16);
    let parallax = parallax(HeightType::U8, UNORM16, UNORM8);
    for (width, height) in [(1, 1), (2, 3), (3, 1), (4, 5), (5, 2), (255, 7), (256, 1), (257, 9), (1030, 2)] {
        let size = Size::new(width, height).unwrap();
        // More bands than are in flight, and one.
        for band_rows in [1, 2, height] {
            compare(&device, &blend, size, band_rows).unwrap();
            compare(&device, &floats, size, band_rows).unwrap();
            compare(&device, &parallax, size, band_rows).unwrap();
        }
    }
}
