//! Normal maps: EXR, by every option.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| texbake_fuzz::maps::assert_normals("exr", data));
