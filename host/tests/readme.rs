//! Runs the commands of README.md as they stand there, and compares its sample output.
//!
//! `UPDATE_GOLDEN=1 cargo test -p wmr --test readme` rewrites it.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
/// What stands before the demo's output.
const OUTPUT: &str = "It prints:\n\n```text\n";

/// Commands that a test cannot run as they stand, and why.
const NOT_RUN: [(&str, &str); 6] = [
    ("tests/run", "it runs this test"),
    ("wmr serve", "it serves until Ctrl-C; tests/page/run does so"),
    ("wmr demo --page", "the same"),
    ("firmware/build && ", "tests/run builds the firmware; figures take longer than a test should"),
    ("cargo run --release -p wmr-tests --example ", "figures take longer than a test should"),
    ("cargo run --release --manifest-path tests/planner_bench/", "it builds other planners"),
];

/// Commands that need something nobody has in a fresh clone: they must be understood, and fail only
/// for want of that, with this exit code and error: pictures by the reader's own camera, and a drive
/// that was cut short.
const LACKING: [(&str, i32, &str); 5] = [
    ("wmr calibrate camera ", 3, "error[file.read]"),
    ("wmr plan photo.jpg ", 3, "error[file.read]"),
    ("wmr detect photo3.jpg ", 3, "error[file.read]"),
    ("wmr detect a2.jpg ", 3, "error[file.read]"),
    (" --resume", 2, "error[resume.nothing]"),
];

/// Commands for a robot on USB: with these words another, the simulated robot does.
const ON_USB: [&str; 3] = ["--port auto", "wmr params ", "wmr calibrate base "];

fn readme() -> String {
    std::fs::read_to_string(Path::new(ROOT).join("README.md")).unwrap()
}

/// The commands of all console blocks, without their comments.
fn commands(text: &str) -> Vec<String> {
    let blocks = text.split("```console\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let lines = blocks.flat_map(str::lines).map(|line| line.split(" #").next().unwrap().trim());
    lines.filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

/// A folder in which the README's paths lead where they should, and nothing of the user's is changed.
fn clone() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("host/assets")).unwrap();
    for entry in std::fs::read_dir(Path::new(ROOT).join("host/assets")).unwrap() {
        let entry = entry.unwrap();
        let copy = folder.path().join("host/assets").join(entry.file_name());
        std::fs::copy(entry.path(), copy).unwrap();
    }
    folder
}

fn run(folder: &Path, command: &str) -> Output {
    let arguments: Vec<_> = command.split_whitespace().skip(1).collect();
    Command::new(env!("CARGO_BIN_EXE_wmr"))
        .args(&arguments)
        .current_dir(folder)
        .env_remove("WMR_PORT")
        .env("XDG_STATE_HOME", folder.join("state"))
        .output()
        .unwrap()
}

#[test]
fn every_command_does_what_the_readme_says() {
    let folder = clone();
    let mut run_count = 0;
    for command in commands(&readme()) {
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
        let output = run(folder.path(), &command);
        let code = lacking.map_or(0, |lacking| lacking.1);
        assert_eq!(output.status.code(), Some(code), "{command}\n{output:?}");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(lacking.map_or("", |lacking| lacking.2)), "{command}\n{said}");
        run_count += 1;
    }
    assert!(run_count >= 10, "only {run_count} commands were found");
}

#[test]
fn every_command_of_the_table_is_one_of_the_program() {
    let text = readme();
    let table = text.split("| command | what it does |\n").nth(1).unwrap();
    let rows = table.lines().skip(1).take_while(|line| line.starts_with('|'));
    let mut names = Vec::new();
    for row in rows {
        let cell = row.split('|').nth(1).unwrap();
        names.extend(cell.split('`').skip(1).step_by(2).map(str::to_owned));
    }
    assert!(names.len() >= 12, "{names:?}");
    for name in names {
        let output = run(Path::new(ROOT), &format!("wmr {name} --help"));
        assert!(output.status.success(), "wmr {name} --help: {output:?}");
    }
}

#[test]
fn every_figure_command_names_what_there_is() {
    let text = readme();
    let named = |before: &str| -> Vec<String> {
        let rest = text.split(before).skip(1);
        rest.map(|rest| rest.split([' ', '`']).next().unwrap().to_owned()).collect()
    };
    let examples = named("-p wmr-tests --example ");
    assert!(!examples.is_empty());
    for example in examples {
        let path = PathBuf::from(ROOT).join(format!("tests/examples/{example}.rs"));
        assert!(path.is_file(), "{}", path.display());
    }
}

#[test]
fn the_scene_written_by_hand_is_planned() {
    let text = readme();
    let scene = text.split("```json\n").nth(1).unwrap().split("```").next().unwrap();
    let folder = clone();
    std::fs::write(folder.path().join("scene.json"), scene).unwrap();
    let output = run(folder.path(), "wmr plan scene.json");
    assert!(output.status.success(), "{output:?}");
}

/// Times differ from run to run: `NUMBER ms` becomes `… ms`.
fn without_times(text: &str) -> String {
    let mut words: Vec<String> = text.split(' ').map(str::to_owned).collect();
    for index in 1..words.len() {
        let unit = words[index].starts_with("ms");
        if unit && words[index - 1].parse::<f64>().is_ok() {
            words[index - 1] = "…".into();
        }
    }
    words.join(" ")
}

#[test]
fn the_sample_output_is_the_demo_s() {
    let folder = clone();
    let output = run(folder.path(), "wmr demo");
    assert!(output.status.success(), "{output:?}");
    let said = [output.stderr, output.stdout].map(|bytes| String::from_utf8(bytes).unwrap());
    let said = without_times(&said.concat());
    let text = readme();
    let (before, rest) = text.split_once(OUTPUT).unwrap();
    let (sample, after) = rest.split_once("```").unwrap();
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        let updated = format!("{before}{OUTPUT}{said}```{after}");
        std::fs::write(Path::new(ROOT).join("README.md"), updated).unwrap();
        return;
    }
    assert_eq!(sample, said, "UPDATE_GOLDEN=1 cargo test -p wmr --test readme");
}
