//! Holds the guides (`host/book`, `firmware/README.md`) to the program: commands, transcripts, pictures, links.
//!
//! `UPDATE_GOLDEN=1 cargo test -p wmr --test guides` draws the pictures again.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

mod told;

use std::path::Path;
use std::process::Output;
use told::{ROOT, blocks, clone, pages, read, run, run_all};

/// A folder with what the guides take for granted: a photo, one in the dark, one of a grey wall, and notes.
fn prepared() -> tempfile::TempDir {
    let folder = clone();
    let at = |name: &str| folder.path().join(name);
    std::fs::copy(at("host/assets/demo.png"), at("photo.jpg")).unwrap();
    for (name, grey) in [("dark.png", 10), ("grey.png", 120)] {
        image::GrayImage::from_pixel(640, 480, image::Luma([grey])).save(at(name)).unwrap();
    }
    std::fs::write(at("notes.txt"), "buy tape\n").unwrap();
    folder
}

#[test]
fn every_command_of_the_guides_does_what_they_say() {
    let mut count = 0;
    for page in pages() {
        count += run_all(prepared().path(), &std::fs::read_to_string(page).unwrap());
    }
    count += run_all(prepared().path(), &read("firmware/README.md"));
    assert!(count >= 25, "only {count} commands were found");
}

/// One command of a transcript, its exit code and what it says.
struct Step {
    command: String,
    code: i32,
    said: String,
}

fn transcripts(text: &str) -> Vec<Step> {
    let steps = blocks(text, "transcript").into_iter();
    let steps = steps.flat_map(|block| block.split("$ ").skip(1)).map(|step| {
        let (command, rest) = step.split_once("\n? ").unwrap();
        let (code, said) = rest.split_once('\n').unwrap();
        Step { command: command.into(), code: code.parse().unwrap(), said: said.into() }
    });
    steps.collect()
}

/// Whether `text` is `pattern`, in which `…` stands for anything within a line.
fn is_like(text: &str, pattern: &str) -> bool {
    let lines: Vec<&str> = text.trim_end().lines().collect();
    let patterns: Vec<&str> = pattern.trim_end().lines().collect();
    lines.len() == patterns.len()
        && lines.iter().zip(patterns).all(|(line, pattern)| {
            let mut parts = pattern.split('…');
            let first = parts.next().unwrap_or("");
            let Some(mut rest) = line.strip_prefix(first) else { return false };
            let parts: Vec<&str> = parts.collect();
            let Some((last, middle)) = parts.split_last() else { return rest.is_empty() };
            for part in middle {
                let Some(place) = rest.find(part) else { return false };
                rest = &rest[place + part.len()..];
            }
            rest.ends_with(last)
        })
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout)
}

/// What only a device can bring about; a test of the program's errors compares its words.
const NEEDS_A_DEVICE: &str = "wmr drive plan.json";

#[test]
fn mistakes_are_answered_as_the_guide_shows() {
    let folder = prepared();
    let robots = words(&run(folder.path(), "wmr ports"));
    let mut count = 0;
    for step in transcripts(&read("host/book/src/mistakes.md")) {
        let needs_none = step.command == "wmr info" && robots.contains("a wmr robot");
        if step.command == NEEDS_A_DEVICE || needs_none {
            continue;
        }
        let output = run(folder.path(), &step.command);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(step.code), "{}\n{said}", step.command);
        assert!(is_like(&said, &step.said), "{}\n{said}\nis not\n{}", step.command, step.said);
        count += 1;
    }
    assert!(count >= 20, "only {count} steps were found");
}

/// The pictures of "How it works", and the folders that its two commands draw them into.
const DRAWN: [(&str, &[&str]); 2] = [
    (
        "steps",
        &["2_edges.png", "3_averaged.png", "4_threshold.png", "6_mask.png", "8_enlarged.png"],
    ),
    (
        "paper",
        &[
            "10_border_lines.svg",
            "11_mini_matrix.svg",
            "12_traps_closed.svg",
            "13_tree.svg",
            "14_path.svg",
            "15_motion.svg",
        ],
    ),
];
/// By how many grey levels a picture of pixels may differ, on average: the border may be found a hair
/// elsewhere.
const GREY_LEVELS: f64 = 4.0;

#[test]
fn the_pictures_are_those_that_the_commands_draw() {
    let folder = prepared();
    run_all(folder.path(), &read("host/book/src/how-it-works.md"));
    let shown = Path::new(ROOT).join("host/book/src/pictures");
    for (place, names) in DRAWN {
        for name in names {
            let (drawn, kept) = (folder.path().join(place).join(name), shown.join(name));
            if std::env::var_os("UPDATE_GOLDEN").is_some() {
                std::fs::copy(&drawn, &kept).unwrap();
            }
            assert!(is_same_picture(&drawn, &kept), "{name}: UPDATE_GOLDEN=1 draws it again");
        }
    }
}

fn is_same_picture(drawn: &Path, kept: &Path) -> bool {
    if drawn.extension().is_some_and(|ending| ending == "svg") {
        return std::fs::read(drawn).unwrap() == std::fs::read(kept).unwrap();
    }
    let [drawn, kept] = [drawn, kept].map(|path| image::open(path).unwrap().to_luma8());
    if drawn.dimensions() != kept.dimensions() {
        return false;
    }
    let differences = drawn.iter().zip(kept.iter()).map(|(a, b)| f64::from(a.abs_diff(*b)));
    differences.sum::<f64>() / kept.len() as f64 <= GREY_LEVELS
}

#[test]
fn every_link_leads_somewhere_and_every_page_is_in_the_summary() {
    let summary = read("host/book/src/SUMMARY.md");
    let texts = ["README.md", "firmware/README.md"].map(|path| Path::new(ROOT).join(path));
    for page in pages().into_iter().chain(texts) {
        let text = std::fs::read_to_string(&page).unwrap();
        let name = page.file_name().unwrap().to_str().unwrap();
        let is_chapter = !["SUMMARY.md", "README.md"].contains(&name);
        assert!(!is_chapter || summary.contains(&format!("({name})")), "{name} is in no summary");
        for link in text.split("](").skip(1).map(|rest| rest.split(')').next().unwrap()) {
            if link.starts_with("http") {
                continue;
            }
            let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target =
                if path.is_empty() { page.clone() } else { page.parent().unwrap().join(path) };
            assert!(target.exists(), "{name}: {link}");
            let is_text = target.extension().is_some_and(|ending| ending == "md");
            assert!(
                anchor.is_empty() || !is_text || has_heading(&target, anchor),
                "{name}: {link}"
            );
        }
    }
}

/// Whether a text has a heading that GitHub gives this anchor.
fn has_heading(path: &Path, anchor: &str) -> bool {
    let text = std::fs::read_to_string(path).unwrap();
    let anchor_of = |heading: &str| -> String {
        let kept = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = kept.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    text.lines().filter(|line| line.starts_with('#')).any(|line| anchor_of(line) == anchor)
}

#[test]
fn the_wiring_is_drawn_as_the_table_says() {
    let drawing = read("firmware/wiring.svg");
    let text = read("firmware/README.md");
    let table = text.split("| Pico pin | GPIO | goes to |\n").nth(1).unwrap();
    let rows = table.lines().skip(1).take_while(|line| line.starts_with('|'));
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let name =
            cells[2].parse::<u8>().map_or(cells[2].to_owned(), |number| format!("GP{number}"));
        assert!(drawing.contains(&format!(">{}</text>", cells[1])), "pin {}", cells[1]);
        assert!(drawing.contains(&format!(">{name}</text>")), "{name}");
        count += 1;
    }
    assert_eq!(count, 18);
}
