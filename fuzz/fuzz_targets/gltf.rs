//! Models: .gltf, JSON.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| texbake_fuzz::models::assert_gltf("gltf", data));
