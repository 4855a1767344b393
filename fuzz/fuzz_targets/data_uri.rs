//! Buffers in data URIs.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| texbake_fuzz::models::assert_data_uri(data));
