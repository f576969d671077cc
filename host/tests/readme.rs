//! Runs the commands of README.md as they stand there, and compares its sample output.
//!
//! `UPDATE_GOLDEN=1 cargo test -p wmr --test readme` rewrites it.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

mod told;

use std::path::{Path, PathBuf};
use told::{ROOT, clone, run, run_all};

/// What stands before the demo's output.
const OUTPUT: &str = "It prints:\n\n```text\n";

fn readme() -> String {
    told::read("README.md")
}

#[test]
fn every_command_does_what_the_readme_says() {
    let folder = clone();
    assert!(run_all(folder.path(), &readme()) >= 10);
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
