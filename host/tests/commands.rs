//! What surrounds a drive: help, settings, replay, tables, flashing, the doctor.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

mod program;

use program::{ENDS, PAPER, assert_refused, document, floor, number, succeed, wmr, write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicBool, Ordering};

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The program in a folder, with nothing of this computer's settings but those given.
fn wmr_in(folder: &Path, arguments: &[&str], variables: &[(&str, &str)]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
    command.args(arguments).current_dir(folder);
    for name in ["WMR_PORT", "WMR_RADIUS", "WMR_CONFIG"] {
        command.env_remove(name);
    }
    command.env("XDG_CONFIG_HOME", folder.join("user"));
    command.envs(variables.iter().copied()).output().unwrap()
}

fn help(words: &[&str]) -> String {
    let output = wmr(&[words, &["--help"]].concat());
    assert!(output.status.success(), "{words:?}: {output:?}");
    text(&output.stdout)
}

/// All commands that do something, as their words.
fn commands() -> Vec<Vec<String>> {
    let page = help(&[]);
    let rows = page.lines().filter_map(|line| line.strip_prefix("  "));
    let names = rows.flat_map(|row| row.split("  ").next().unwrap().split(", "));
    let mut commands = Vec::new();
    for name in names {
        let page = help(&[name]);
        let Some((_, rest)) = page.split_once("Commands:\n") else {
            commands.push(vec![name.to_owned()]);
            continue;
        };
        let rows = rest.lines().take_while(|line| line.starts_with("  "));
        let below = rows.map(|row| row.split_whitespace().next().unwrap());
        commands.extend(
            below.filter(|word| *word != "help").map(|word| vec![name.to_owned(), word.to_owned()]),
        );
    }
    commands
}

#[test]
fn every_command_s_help_has_an_example_that_is_understood() {
    let commands = commands();
    assert!(commands.len() >= 20, "{commands:?}");
    for command in commands {
        let words: Vec<&str> = command.iter().map(String::as_str).collect();
        let page = help(&words);
        let example = page.split("Example: ").nth(1).unwrap_or_else(|| panic!("{words:?}"));
        let example = example.lines().next().unwrap().split(" > ").next().unwrap();
        let typed: Vec<&str> = example.split_whitespace().skip(1).collect();
        assert!(typed.starts_with(&words), "{example}");
        // In an empty folder nothing is driven or served: the words alone are looked at.
        let output = wmr(&[&typed[..], &["--no-such-option"]].concat());
        assert_eq!(output.status.code(), Some(2));
        let said = text(&output.stderr);
        assert!(said.contains("--no-such-option"), "{example}: {said}");
    }
}

#[test]
fn without_a_command_the_first_words_to_type_are_told() {
    let output = wmr(&[]);
    assert!(output.status.success());
    assert!(text(&output.stdout).contains("wmr demo"));
    program::assert_valid("welcome", &document(&wmr(&["--json"])));
}

#[test]
fn a_drive_that_was_kept_is_replayed_and_becomes_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let log = at("run");
    let driven = succeed(&["drive", PAPER, "--port", "sim", "--log", &log, "--json"]);
    let replayed = succeed(&["replay", &log, "--out", &at("again"), "--json"]);
    assert!((number(&replayed["duration"]) - number(&driven["duration"])).abs() < 0.5);
    let film = std::fs::read_to_string(folder.path().join("again/17_replay.svg")).unwrap();
    assert!(film.contains("<animateTransform"), "{film}");
    let seconds = film.split("dur=\"").nth(1).unwrap().split('s').next().unwrap();
    assert!((seconds.parse::<f64>().unwrap() - number(&replayed["duration"])).abs() < 0.15);
    let page = std::fs::read_to_string(folder.path().join("run/index.html")).unwrap();
    for shown in page.split("src=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(folder.path().join("run").join(shown).is_file(), "{shown} is shown but not there");
    }
    assert!(page.contains("17_replay.svg") && page.contains("14_path.svg"));
    let table = at("run.csv");
    let rows = number(&succeed(&["export", &log, "-o", &table, "--json"])["rows"]);
    let lines = std::fs::read_to_string(&table).unwrap();
    assert_eq!(lines.lines().count() as f64, rows + 1.0);
    assert!(lines.lines().all(|line| line.split(',').count() == 8));
    assert_refused(3, "log.none", &["replay", &at("nothing")]);
    let scene = write(&folder, "notes.txt", "hello\n");
    assert_refused(3, "log", &["export", &scene, "-o", &at("other.csv")]);
}

#[test]
fn an_option_counts_before_a_variable_before_the_project_before_the_user() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write(&folder, "scene.json", &floor(ENDS));
    let radius = |arguments: &[&str], variables: &[(&str, &str)]| {
        let words = [&["plan", &scene, "--json"], arguments].concat();
        number(&document(&wmr_in(folder.path(), &words, variables))["scene"]["robot_radius"])
    };
    assert_eq!(radius(&[], &[]), 0.075);
    std::fs::create_dir_all(folder.path().join("user/wmr")).unwrap();
    write(&folder, "user/wmr/config.toml", "radius = 0.01\n");
    assert_eq!(radius(&[], &[]), 0.01);
    write(&folder, "wmr.toml", "radius = \"20mm\"\n");
    assert_eq!(radius(&[], &[]), 0.02);
    assert_eq!(radius(&[], &[("WMR_RADIUS", "30mm")]), 0.03);
    assert_eq!(radius(&["--radius", "40mm"], &[("WMR_RADIUS", "30mm")]), 0.04);
    assert_eq!(radius(&[], &[("WMR_CONFIG", "")]), 0.075);
    let doctor = document(&wmr_in(folder.path(), &["doctor", "--json"], &[("WMR_PORT", "sim")]));
    let settings = doctor["settings"].as_array().unwrap();
    let source = |name: &str| {
        let found = settings.iter().find(|setting| setting["name"] == name).unwrap();
        found["source"].as_str().unwrap().to_owned()
    };
    assert_eq!(source("port"), "variable WMR_PORT");
    assert!(source("radius").ends_with("wmr.toml"), "{settings:?}");
}

#[test]
fn a_wrong_setting_is_told_with_its_file_and_keeps_nobody_from_the_doctor() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write(&folder, "scene.json", &floor(ENDS));
    for wrong in ["radius = \"wide\"", "radios = 1", "radius = "] {
        write(&folder, "wmr.toml", wrong);
        let output = wmr_in(folder.path(), &["plan", &scene, "--json"], &[]);
        assert_eq!(output.status.code(), Some(3), "{wrong}: {output:?}");
        let error = &document(&output)["error"];
        assert_eq!(error["code"], "settings");
        assert!(error["message"].as_str().unwrap().contains("wmr.toml"), "{error}");
    }
    let doctor = document(&wmr_in(folder.path(), &["doctor", "--json"], &[]));
    program::assert_valid("doctor", &doctor);
    assert_eq!(doctor["to_fix"], 1, "{doctor}");
}

#[test]
fn shells_are_told_the_words() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = wmr(&["completions", shell]);
        assert!(output.status.success());
        assert!(text(&output.stdout).contains("calibrate"), "{shell}");
        succeed(&["completions", shell, "--json"]);
    }
}

/// A firmware of one block, for the Pico (RP2040).
fn firmware() -> Vec<u8> {
    let mut block = Vec::new();
    for word in [0x0a32_4655_u32, 0x9e5d_5157, 0x2000, 0x1000_0000, 256, 0, 1, 0xe48b_ff56] {
        block.extend(word.to_le_bytes());
    }
    block.resize(508, 0x5a);
    block.extend(0x0ab1_6f30_u32.to_le_bytes());
    block
}

/// The boot drive of a board, as a folder.
fn boot_drive(folder: &tempfile::TempDir, board: &str) -> PathBuf {
    let info = format!("UF2 Bootloader v3.0\nModel: Raspberry Pi\nBoard-ID: {board}\n");
    std::fs::create_dir_all(folder.path().join("drive")).unwrap();
    write(folder, "drive/INFO_UF2.TXT", &info);
    folder.path().join("drive")
}

#[test]
fn a_boot_drive_that_takes_its_firmware_goes_away() {
    let folder = tempfile::tempdir().unwrap();
    let drive = boot_drive(&folder, "RPI-RP2");
    let file = folder.path().join("pico.uf2");
    std::fs::write(&file, firmware()).unwrap();
    let (done, got) = (AtomicBool::new(false), drive.join("WMR.UF2"));
    let output = std::thread::scope(|scope| {
        // The board: once it has the whole file it leaves its boot loader.
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                if std::fs::read(&got).is_ok_and(|bytes| bytes == firmware()) {
                    std::fs::remove_file(drive.join("INFO_UF2.TXT")).unwrap();
                    return;
                }
                std::thread::yield_now();
            }
        });
        let words = ["flash", file.to_str().unwrap(), "--drive", drive.to_str().unwrap(), "--json"];
        let output = wmr(&words);
        done.store(true, Ordering::Relaxed);
        output
    });
    assert!(output.status.success(), "{output:?}");
    program::assert_valid("flash", &document(&output));
    assert_eq!(document(&output)["bytes"], 512);
    assert_eq!(std::fs::read(&got).unwrap(), firmware());
}

#[test]
fn no_firmware_goes_where_it_does_not_belong() {
    let folder = tempfile::tempdir().unwrap();
    let drive = boot_drive(&folder, "RP2350");
    let (file, cut) = (folder.path().join("pico.uf2"), folder.path().join("cut.uf2"));
    std::fs::write(&file, firmware()).unwrap();
    std::fs::write(&cut, &firmware()[..300]).unwrap();
    let (file, cut) = (file.to_str().unwrap(), cut.to_str().unwrap());
    let place = drive.to_str().unwrap();
    assert_refused(3, "flash.other_chip", &["flash", file, "--drive", place]);
    assert_refused(3, "flash.file", &["flash", cut, "--drive", place]);
    let elsewhere = folder.path().to_str().unwrap();
    assert_refused(5, "flash.no_drive", &["flash", file, "--drive", elsewhere]);
    assert_refused(5, "port.missing", &["flash", file, "--port", "/dev/no-such-port"]);
    boot_drive(&folder, "SAMD21");
    assert_refused(5, "flash.other_board", &["flash", file, "--drive", place]);
    assert!(!drive.join("WMR.UF2").exists());
}
