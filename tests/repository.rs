//! What the repository promises about itself: compiler, systems, and that tests compare.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use std::path::{Path, PathBuf};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn read(path: impl AsRef<Path>) -> String {
    let path = Path::new(ROOT).join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn the_readme_names_the_least_rust_that_cargo_accepts() {
    let least = read("Cargo.toml")
        .lines()
        .find_map(|line| {
            Some(line.strip_prefix("rust-version = \"")?.trim_end_matches('"').to_owned())
        })
        .unwrap();
    let named = format!("[Rust](https://rustup.rs) {least} or newer");
    assert!(read("README.md").contains(&named), "README.md lacks: {named}");
}

/// With `UPDATE_GOLDEN` a test rewrites what it should compare with, and passes.
#[test]
fn continuous_integration_never_rewrites_expected_output() {
    for script in ["tests/run", ".ci/run", "tests/dependencies", "firmware/build"] {
        for line in read(script).lines().filter(|line| line.contains("UPDATE_GOLDEN")) {
            assert_eq!(line, "unset UPDATE_GOLDEN", "{script}");
        }
    }
    assert!(read("tests/run").contains("\nunset UPDATE_GOLDEN\n"));
    assert!(read(".ci/run").contains("tests/run"));
}

/// Windows builds the same libraries: what only Unix has is in modules that `cfg(unix)` leaves out.
#[test]
fn calls_that_only_unix_has_are_in_modules_for_unix() {
    const UNIX_ONLY: [&str; 4] = ["os::unix", "os::fd", "rustix::", "libc::"];
    let mut files = Vec::new();
    for folder in ["protocol/src", "firmware/src", "hil_sim/src", "host/src"] {
        rust_files(&Path::new(ROOT).join(folder), &mut files);
    }
    let mut gated = 0;
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        if !UNIX_ONLY.iter().any(|call| text.contains(call)) {
            continue;
        }
        let module = file.file_stem().unwrap().to_str().unwrap();
        let parent = file.parent().unwrap();
        let faces = [parent.join("lib.rs"), parent.join("mod.rs"), parent.with_extension("rs")];
        let declared =
            faces.iter().filter_map(|face| std::fs::read_to_string(face).ok()).any(|face| {
                ["pub mod", "mod", "pub(crate) mod"]
                    .iter()
                    .any(|word| face.contains(&format!("#[cfg(unix)]\n{word} {module};")))
            });
        assert!(declared, "{} needs #[cfg(unix)] where it is declared", file.display());
        gated += 1;
    }
    assert!(gated > 0, "the pseudo-terminal at least is for Unix only");
}

/// A clock that people or the network set may jump; what drives counts from its own start.
#[test]
fn nothing_between_host_and_wheels_reads_a_clock_that_can_be_set() {
    let mut files = Vec::new();
    for folder in ["protocol/src", "firmware/src", "host/src/link"] {
        rust_files(&Path::new(ROOT).join(folder), &mut files);
    }
    assert!(files.len() > 50);
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(!text.contains("SystemTime"), "{}", file.display());
    }
}

/// With both cores awake the executor above all others has been seen to die within half a minute.
#[test]
fn the_second_core_of_the_chip_is_never_started() {
    let mut files = Vec::new();
    rust_files(&Path::new(ROOT).join("firmware/src"), &mut files);
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        for call in ["spawn_core1", "multicore", "CORE1"] {
            assert!(!text.contains(call), "{} has {call}", file.display());
        }
    }
}
