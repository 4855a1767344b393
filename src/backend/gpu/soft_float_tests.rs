//! The arithmetic of kernels/shared, operation by operation, against Rust's on every device.

use super::device::Device;
use super::kernel::{ARITHMETIC, FRAMES_LENGYEL, Kernel};
use super::self_test::scrambled;
use super::tangent_tests::devices;
use super::transfer::Mapping;
use crate::exact::nearest_acos;

/// Operands in pairs, and five results of each.
const KERNEL: &str = "
@group(0) @binding(0) var<uniform> pairs: vec4<u32>;
@group(0) @binding(1) var<storage, read> inputs: array<u32>;
@group(0) @binding(2) var<storage, read_write> outputs: array<u32>;

@compute @workgroup_size(64, 1, 1)
fn frames(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= pairs.x) {
        return;
    }
    let a = inputs[2u * id.x];
    let b = inputs[2u * id.x + 1u];
    let positive = max(a & ~SIGN, 1u);
    outputs[5u * id.x] = add(a, b);
    outputs[5u * id.x + 1u] = mul(a, b);
    outputs[5u * id.x + 2u] = square_root(positive);
    outputs[5u * id.x + 3u] = inverse(positive);
    outputs[5u * id.x + 4u] = angle(min(b & ~SIGN, ONE) | (b & SIGN));
}
";

/// The kernel's results for up to 2^20 pairs.
fn results(device: &Device, pairs: &[[u32; 2]]) -> Vec<[u32; 5]> {
    let slot = device.slot(8 * pairs.len() as u64, 20 * pairs.len() as u64).unwrap();
    let mut view = slot.upload.get_mapped_range_mut(..).unwrap();
    view.slice(..).copy_from_slice(bytemuck::cast_slice(pairs));
    drop(view);
    slot.upload.unmap();
    let params = device.uniform(bytemuck::cast_slice(&[pairs.len() as u32, 0, 0, 0]));
    let buffers = [&params, &slot.inputs, &slot.outputs].map(|buffer| buffer.as_entire_binding());
    let [params, inputs, outputs] = buffers;
    let bindings = device.bind(params, inputs, outputs);
    device.substitute(FRAMES_LENGYEL, &[KERNEL, &ARITHMETIC.join("\n")].join("\n"));
    let pipeline = device.pipeline(&Kernel { source: FRAMES_LENGYEL, constants: Vec::new() });
    let mut encoder = device.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(&slot.upload, 0, &slot.inputs, 0, slot.upload.size());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bindings, &[]);
    pass.dispatch_workgroups(pairs.len().div_ceil(64) as u32, 1, 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&slot.outputs, 0, &slot.download, 0, slot.download.size());
    let submission = device.submit(None, encoder.finish());
    Mapping::of(&slot, submission).wait(device).unwrap();
    let view = slot.download.get_mapped_range(..).unwrap();
    bytemuck::cast_slice(&view).to_vec()
}

/// Pairs of finite floats: of any exponents, of near ones (cancellation, ties), with products around the least normal
/// number, subnormal ones, and small integers.
fn pairs() -> Vec<[u32; 2]> {
    const FINITE: u32 = 0xff7f_ffff;
    let pair = |index: u32| {
        let [a, b] = [scrambled(2 * index), scrambled(2 * index + 1)];
        let exponent = |bits: u32, exponent: u32| (bits & 0x807f_ffff) | (exponent << 23);
        let of_a = (a >> 23) & 0xff;
        match index % 8 {
            0 | 1 => [a & FINITE, b & FINITE],
            2 => [a & FINITE, (a ^ (b & 0x8000_000f)) & FINITE],
            3 => [exponent(a, of_a.clamp(40, 200)), exponent(b, of_a.clamp(40, 200) - b % 29)],
            4 => [exponent(a, of_a.clamp(2, 100)), exponent(b, 128 - of_a.clamp(2, 100) - b % 26)],
            5 => [a & 0x807f_ffff, b & (FINITE >> (b % 30))],
            // Few bits, so that sums and products end half-way between two floats.
            6 => [exponent(a & 0x800f_f000, 150 - a % 60), exponent(b & 0x807f_c000, 150 - b % 60)],
            _ => [((a % 9) as f32 - 4.0).to_bits(), ((b % 17) as f32 / 8.0 - 1.0).to_bits()],
        }
    };
    (0..1 << 20).map(pair).collect()
}

#[test]
fn every_operation_rounds_as_ieee_says() {
    let pairs = pairs();
    for device in devices() {
        let mut compared = [0; 5];
        for (&[a, b], got) in pairs.iter().zip(results(&device, &pairs)) {
            let [x, y] = [a, b].map(f32::from_bits);
            let positive = f32::from_bits((a & 0x7fff_ffff).max(1));
            let wanted = [x + y, x * y, positive.sqrt(), 1.0 / positive, nearest_acos(y.clamp(-1.0, 1.0))];
            for (operation, (got, wanted)) in got.into_iter().zip(wanted).enumerate() {
                // The inverse of a subnormal is not asked for, and no result is infinite.
                if wanted.is_finite() && (operation != 3 || positive.is_normal()) {
                    let got = f32::from_bits(got);
                    let what = ["+", "*", "sqrt", "1/", "acos"][operation];
                    assert_eq!(got.to_bits(), wanted.to_bits(), "{}: {x:e} {what} {y:e}: {got:e}", device.name);
                    compared[operation] += 1;
                }
            }
        }
        assert!(compared.iter().all(|&count| count > 700_000), "{compared:?}");
    }
}

#[test]
fn every_exponents_angles_are_right() {
    // Ends, middles and neighbours of every exponent, both signs; then the floats whose angle is hardest to round.
    let near = |exponent: u32| {
        let offsets = [0, 1, 2, 3, 0x20_0000, 0x40_0000, 0x40_0001, 0x7f_fffd, 0x7f_fffe, 0x7f_ffff];
        offsets.into_iter().chain((0..2000).map(|index| scrambled(index) >> 9)).map(move |bits| (exponent << 23) + bits)
    };
    let hard = [2.486_864_7e-4f32, 1.589_325_5e-8, 1.174_469e-2, 1.0, 0.5, 0.0].map(f32::to_bits);
    let all = (0..127).flat_map(near).chain(hard);
    let pairs: Vec<[u32; 2]> = all.flat_map(|bits| [[0, bits], [0, bits | 1 << 31]]).collect();
    for device in devices() {
        for (&[_, x], got) in pairs.iter().zip(results(&device, &pairs)) {
            let x = f32::from_bits(x);
            assert_eq!(f32::from_bits(got[4]), nearest_acos(x), "{}: acos({x:e})", device.name);
        }
    }
}
