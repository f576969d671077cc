//! The demo's mission on the flashed firmware, in the emulator: it arrives, and it does so twice alike.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use serde_json::Value;
use std::path::Path;
use std::process::Command;

const ELF: &str = concat!("elf:", env!("CARGO_MANIFEST_DIR"), "/../target/firmware/pico.elf");

fn demo(out: &Path) -> (Value, Vec<u8>) {
    let mut wmr = Command::new(env!("CARGO_BIN_EXE_wmr"));
    let output = wmr.args(["demo", "--port", ELF, "--json", "--out"]).arg(out).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let run = serde_json::from_slice(&output.stdout).unwrap();
    (run, std::fs::read(out.join("run.jsonl")).unwrap())
}

#[test]
fn the_flashed_firmware_drives_the_demo_to_its_goal_twice_alike() {
    let folder = tempfile::tempdir().unwrap();
    let (run, log) = demo(&folder.path().join("first"));
    assert!(run["error"]["position"].as_f64().unwrap() < 0.005, "{run}");
    assert!(run["error"]["heading"].as_f64().unwrap() < 0.0175, "{run}");
    assert_eq!((&run["collisions"], &run["link"]["lost"]), (&0.into(), &0.into()), "{run}");
    let (again, same_log) = demo(&folder.path().join("second"));
    assert_eq!(run, again);
    assert!(log == same_log, "the two logs differ");
}
