//! Bakes from rows to rows, with sources and sinks of any behaviour.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: texbake_fuzz::streams::Behaviour| texbake_fuzz::streams::assert_streams(data));
