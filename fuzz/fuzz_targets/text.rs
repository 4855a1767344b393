//! Numbers and names.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &str| texbake_fuzz::text::assert_reads(data));
