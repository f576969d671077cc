//! Any bytes on the wire.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| wmr_tests::fuzzing::decoder(data));
