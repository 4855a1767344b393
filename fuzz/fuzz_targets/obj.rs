//! Models: OBJ, and the materials beside it.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| texbake_fuzz::models::assert_obj(data));
