//! Files on GPUs: every level of every kind is uploaded as it stands in the file, and each texel is loaded by a shader.
//!
//! What a device's float is off by: nothing for floats; for normalised codes c of at most 16 bits the [`ROUNDINGS`] of
//! c / L to f32. Of BC4 and BC5 blocks the precision of values between the ends is the device's own. SwiftShader cuts
//! them off to whole codes. Mesa's `lp_build_lerpdxta` adds floor(d w / 256) to the first end, d being the range and w
//! the sevenths k / 7 as floor(floor(64 * 255 / 7) k / 64) / 256: 36, 72, 109, 145, 182 and 218 256ths, which are too
//! small by at most 10/7 256ths. So a value is less than one code too far from the first end, or up to [`WEIGHTS`] of
//! the range too near to it. What BC7 blocks decode to is defined to the bit.

use super::blocks::Component;
use super::device::{devices, has, load};
use super::made::{KINDS, Kind, Level, Made, bc7};
use super::parsed::by_specification;
use crate::io::support::Folder;
use texbake::Codes;
use texbake::Encoding::{Float, Snorm};

/// Ten steps of 2^-24 would be 1/25 of a 16-bit code.
const ROUNDINGS: f64 = 1.0 / 20.0;

/// Of a block's range.
const WEIGHTS: f64 = 10.0 / 7.0 / 256.0;

/// A code as a number, and the code of 1.
fn number(kind: &Kind, codes: &Codes, at: usize) -> (f64, f64) {
    let signed = kind.encoding == Snorm;
    match codes {
        Codes::U8(codes) if signed => ((codes[at] as i8).into(), 127.0),
        Codes::U8(codes) => (codes[at].into(), 255.0),
        Codes::U16(codes) if signed => ((codes[at] as i16).into(), 32767.0),
        Codes::U16(codes) => (codes[at].into(), 65535.0),
        Codes::F16(codes) => (codes[at].to_f64(), 1.0),
        Codes::F32(codes) => (codes[at].into(), 1.0),
    }
}

/// What component `channel` of a texel is in the file, in codes, and by how much a device may be off.
fn expected(kind: &Kind, level: &Level, bytes: &[u8], (x, y): (usize, usize), channel: usize) -> (f64, f64) {
    if kind.blocks.is_none() {
        let (code, _) = number(kind, &level.codes, (y * level.width + x) * kind.channels + channel);
        return (code, if kind.encoding == Float { 0.0 } else { ROUNDINGS });
    }
    let block_at = y / 4 * level.width.div_ceil(4) + x / 4;
    let block = &bytes[block_at * kind.bytes + channel * 8..][..8];
    let (component, at) = (Component { block, signed: kind.encoding == Snorm }, y % 4 * 4 + x % 4);
    let [first, second] = component.ends();
    let between = (WEIGHTS * (first - second).abs()).max(1.0);
    (component.value(at), if component.index(at) < 2 { ROUNDINGS } else { ROUNDINGS + between })
}

/// The greatest error of the components that the file keeps, in codes, less what is allowed.
fn excess(kind: &Kind, level: &Level, bytes: &[u8], texels: &[[f32; 4]]) -> f64 {
    let kept = if kind.blocks.is_some() { kind.bytes / 8 } else { kind.channels };
    let one = number(kind, &level.codes, 0).1;
    let mut greatest = f64::MIN;
    for (at, texel) in texels.iter().enumerate() {
        for (channel, value) in texel.iter().enumerate().take(kept) {
            let (code, allowed) = expected(kind, level, bytes, (at % level.width, at / level.width), channel);
            let error = (f64::from(*value) * one - code).abs();
            // A texel that the shader did not reach is NaN.
            greatest = greatest.max(if error.is_nan() { f64::INFINITY } else { error - allowed });
        }
    }
    greatest
}

#[test]
fn every_device_samples_what_was_written() {
    let folder = Folder::new();
    let mut with_blocks = 0;
    for (name, gpu) in devices() {
        for kind in KINDS.iter().filter(|kind| has(&gpu, kind)) {
            // Their largest level has whole blocks, which WebGPU asks for; the smaller ones do not.
            for (size, container) in [((64, 64), "ktx2"), ((20, 12), "dds"), ((4, 36), "ktx2")] {
                let made = Made::new(&folder, *kind, size, true, container);
                let bytes = by_specification(&made.bytes(), &made).unwrap();
                let loaded = load(&gpu, kind, &made.levels, &bytes);
                for ((level, texels), bytes) in made.levels.iter().zip(&loaded).zip(&bytes) {
                    if kind.vulkan == 145 {
                        let codes: Vec<u8> = texels.iter().flatten().map(|v| (v * 255.0).round() as u8).collect();
                        assert!(codes == bc7(bytes, level), "{name}: {}", made.path.display());
                        continue;
                    }
                    let excess = excess(kind, level, bytes, texels);
                    assert!(excess <= 0.0, "{name}: {}: {excess} too much", made.path.display());
                }
                with_blocks += usize::from(kind.blocks.is_some());
                // The comparison is awake.
                for value in [loaded[0][7][0] + 0.5, f32::NAN] {
                    let mut other = loaded[0].clone();
                    other[7][0] = value;
                    assert!(kind.vulkan == 145 || excess(kind, &made.levels[0], &bytes[0], &other) > 0.0);
                }
            }
        }
        println!("{name}: {} kinds", KINDS.iter().filter(|kind| has(&gpu, kind)).count());
    }
    let required = std::env::var("TEXBAKE_REQUIRE_GPU").is_ok_and(|value| value == "1");
    assert!(!required || with_blocks > 0, "no device has blocks");
}
