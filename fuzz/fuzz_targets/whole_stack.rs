//! Host, faulty wires and robot, with faults injected.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| wmr_tests::fuzzing::whole_stack(data));
