//! Hands the linker the memory map of the chip being built for; a desktop build needs none.

use std::path::PathBuf;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    for memory in ["memory-rp2040.x", "memory-rp235xa.x"] {
        println!("cargo::rerun-if-changed={memory}");
    }
    if variable("CARGO_CFG_TARGET_OS") != "none" {
        return Ok(());
    }
    // Only the RP2350's core has the hard-float calling convention.
    let rp2350 = variable("CARGO_CFG_TARGET_ABI") == "eabihf";
    let memory = if rp2350 { "memory-rp235xa.x" } else { "memory-rp2040.x" };
    let out = PathBuf::from(variable("OUT_DIR"));
    fs::copy(memory, out.join("memory.x"))?;
    println!("cargo::rustc-link-search={}", out.display());
    println!("cargo::rustc-link-arg-bins=--nmagic");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    if !rp2350 {
        println!("cargo::rustc-link-arg-bins=-Tlink-rp.x");
    }
    if !variable("CARGO_FEATURE_DEFMT").is_empty() {
        println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    }
    Ok(())
}

/// An environment variable set by cargo, empty where it sets none.
fn variable(name: &str) -> String {
    env::var(name).unwrap_or_default()
}
