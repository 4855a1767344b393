//! Models: .glb, chunks.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| texbake_fuzz::models::assert_gltf("glb", data));
