//! Commands as texts for people tell them, and a folder in which they can be run.
#![allow(dead_code, reason = "each test uses a part of these")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub(crate) const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// Commands that a test cannot run as they stand, and why.
const NOT_RUN: [(&str, &str); 8] = [
    ("tests/run", "it runs this test"),
    ("wmr serve", "it serves until Ctrl-C; tests/page/run does so"),
    ("wmr sim ", "it serves until Ctrl-C; tests of hil_sim and tests/lockstep.rs do so"),
    ("wmr demo --page", "the same"),
    ("firmware/build", "tests/run builds the firmware; figures take longer than a test should"),
    ("cargo install ", "it builds the program that this test runs"),
    ("cargo run --release -p wmr-tests --example ", "figures take longer than a test should"),
    ("cargo run --release --manifest-path tests/planner_bench/", "it builds other planners"),
];

/// Commands that need something nobody has in a fresh clone: they must be understood, and fail only
/// for want of that, with this exit code and error: pictures by the reader's own camera, a firmware, a
/// person who looks at the wheels, and a drive that was cut short.
const LACKING: [(&str, i32, &str); 9] = [
    ("wmr calibrate camera photo.jpg photo2.jpg ", 3, "error[file.read]"),
    ("wmr calibrate camera a.jpg ", 3, "error[file.read]"),
    ("wmr plan photo.jpg --arena 1.6x1.2 --tags ", 3, "error[file.read]"),
    ("wmr detect photo3.jpg ", 3, "error[file.read]"),
    ("wmr detect a2.jpg ", 3, "error[file.read]"),
    ("wmr detect tagged.jpg ", 3, "error[file.read]"),
    ("wmr flash target/", 3, "error[file.read]"),
    ("wmr check base", 2, "error[usage]: the input ended"),
    (" --resume", 2, "error[resume.nothing]"),
];

/// Commands for a robot on USB: with these words another, the simulated robot does.
const ON_USB: [&str; 6] = [
    "--port auto",
    "wmr params ",
    "wmr calibrate base ",
    "wmr info",
    "wmr monitor",
    "wmr check base",
];

pub(crate) fn read(path: &str) -> String {
    std::fs::read_to_string(Path::new(ROOT).join(path)).unwrap()
}

/// The contents of all blocks that are marked so.
pub(crate) fn blocks<'a>(text: &'a str, mark: &str) -> Vec<&'a str> {
    let start = format!("```{mark}\n");
    text.split(&start).skip(1).map(|rest| rest.split("```").next().unwrap()).collect()
}

/// The commands of all console blocks, without their comments.
fn commands(text: &str) -> Vec<String> {
    let lines = blocks(text, "console").into_iter().flat_map(str::lines);
    let lines = lines.map(|line| line.split(" #").next().unwrap().trim());
    lines.filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

/// A folder in which the paths of texts lead where they should, and nothing of the user's is changed.
pub(crate) fn clone() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("host/assets")).unwrap();
    for entry in std::fs::read_dir(Path::new(ROOT).join("host/assets")).unwrap() {
        let entry = entry.unwrap();
        let copy = folder.path().join("host/assets").join(entry.file_name());
        std::fs::copy(entry.path(), copy).unwrap();
    }
    folder
}

pub(crate) fn run(folder: &Path, command: &str) -> Output {
    let arguments: Vec<_> = command.split_whitespace().skip(1).collect();
    Command::new(env!("CARGO_BIN_EXE_wmr"))
        .args(&arguments)
        .current_dir(folder)
        .env_remove("WMR_PORT")
        .env("WMR_CONFIG", "")
        .env("XDG_STATE_HOME", folder.join("state"))
        .output()
        .unwrap()
}

/// Runs all commands of a text, one after the other; how many there were.
pub(crate) fn run_all(folder: &Path, text: &str) -> usize {
    let mut count = 0;
    for command in commands(text) {
        if NOT_RUN.iter().any(|(start, _)| command.starts_with(start)) {
            continue;
        }
        let mut command = command.replace("cargo run --release -- ", "wmr ");
        assert!(command.starts_with("wmr "), "unknown to this test: {command}");
        if ON_USB.iter().any(|words| command.contains(words)) {
            command = command.replace("--port auto", "--port sim");
            if !command.contains("--port") {
                command.push_str(" --port sim");
            }
        }
        let lacking = LACKING.iter().find(|lacking| command.contains(lacking.0));
        let output = run(folder, &command);
        let code = lacking.map_or(0, |lacking| lacking.1);
        assert_eq!(output.status.code(), Some(code), "{command}\n{output:?}");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(lacking.map_or("", |lacking| lacking.2)), "{command}\n{said}");
        count += 1;
    }
    count
}

/// The pages of the guides, by their paths in the repository.
pub(crate) fn pages() -> Vec<PathBuf> {
    let folder = Path::new(ROOT).join("host/book/src");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut pages: Vec<PathBuf> =
        files.filter(|file| file.extension().is_some_and(|ending| ending == "md")).collect();
    pages.sort();
    pages
}
