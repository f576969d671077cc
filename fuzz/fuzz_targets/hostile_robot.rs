//! A robot that says whatever the bytes say, and the host that drives it.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| wmr_tests::fuzzing_host::hostile_robot(data));
