//! The fuzz targets' bodies, on the corpus and on seeded random bytes.
#![allow(clippy::unwrap_used, clippy::panic, reason = "what helps a test fails as a test does")]

use fastrand::Rng;
use std::fs;
use wmr_tests::fuzzing::{decoder, whole_stack};
use wmr_tests::fuzzing_host::hostile_robot;
use wmr_tests::fuzzing_vision::vision;

fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = format!("{}/../fuzz/corpus/{target}", env!("CARGO_MANIFEST_DIR"));
    let files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(!files.is_empty());
    files.iter().map(|file| fs::read(file).unwrap()).collect()
}

#[test]
fn the_decoder_keeps_its_promises() {
    corpus("decoder").iter().for_each(|bytes| decoder(bytes));
    let mut random = Rng::with_seed(1);
    for _ in 0..100_000 {
        let bytes: Vec<u8> = (0..random.usize(0..200)).map(|_| random.u8(..)).collect();
        decoder(&bytes);
    }
}

#[test]
fn the_whole_stack_keeps_its_promises() {
    corpus("whole_stack").iter().for_each(|bytes| whole_stack(bytes));
    for seed in 0..3_000 {
        let mut random = Rng::with_seed(seed);
        let bytes: Vec<u8> = (0..random.usize(0..120)).map(|_| random.u8(..)).collect();
        let result = std::panic::catch_unwind(|| whole_stack(&bytes));
        assert!(result.is_ok(), "seed {seed}: {bytes:?}");
    }
}

#[test]
fn the_host_keeps_its_promises_to_a_robot_that_keeps_none() {
    corpus("hostile_robot").iter().for_each(|bytes| hostile_robot(bytes));
    for seed in 0..5_000 {
        let mut random = Rng::with_seed(seed);
        let bytes: Vec<u8> = (0..random.usize(0..120)).map(|_| random.u8(..)).collect();
        let result = std::panic::catch_unwind(|| hostile_robot(&bytes));
        assert!(result.is_ok(), "seed {seed}: {bytes:?}");
    }
}

#[test]
fn vision_keeps_its_promises() {
    corpus("vision").iter().for_each(|bytes| vision(bytes));
    for seed in 0..40 {
        let mut random = Rng::with_seed(seed);
        let bytes: Vec<u8> = (0..random.usize(0..120)).map(|_| random.u8(..)).collect();
        let result = std::panic::catch_unwind(|| vision(&bytes));
        assert!(result.is_ok(), "seed {seed}: {bytes:?}");
    }
}
