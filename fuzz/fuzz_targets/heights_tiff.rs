//! Height maps: TIFF.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| texbake_fuzz::maps::assert_heights("tif", data));
