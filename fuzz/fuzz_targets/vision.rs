//! Broken files and random pictures.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| wmr_tests::fuzzing_vision::vision(data));
