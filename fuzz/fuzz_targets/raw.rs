//! Headerless heights, by any layout.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| texbake_fuzz::maps::assert_raw(data));
