//! One page that shows the pictures of a folder in the order of the flow, with a sentence each.

use std::fmt::Write;

/// What there may be: file name, title, and what is to be seen.
const STEPS: [(&str, &str, &str); 28] = [
    (
        "16_drive.svg",
        "The drive on the photo",
        "White is the planned way, blue the one that the robot reports; its disc is drawn as large as it is, at both ends.",
    ),
    (
        "17_replay.svg",
        "The drive, moving",
        "Grey is the planned way; the robot moves as fast as it did.",
    ),
    (
        "18_deviation.svg",
        "How far beside its way",
        "By how many millimetres the robot was beside the planned way, and how fast its wheels turned.",
    ),
    (
        "15_motion.svg",
        "Displacement and heading",
        "Planned against measured over time, as in the paper's figures.",
    ),
    ("photo", "The photo", "As it was given."),
    ("photo_a", "The first photo", "As it was given."),
    ("photo_b", "The second photo", "As it was given."),
    (
        "1_plan_view.png",
        "Plan view",
        "The floor as seen from straight above, to scale: the camera's tilt and lens are taken out.",
    ),
    (
        "1_plan_view_a.png",
        "Plan view of the first photo",
        "The floor as seen from straight above, to scale; what stands up leans outwards.",
    ),
    (
        "2_plan_view_b.png",
        "Plan view of the second photo",
        "The same for the other camera: what stands up leans another way.",
    ),
    (
        "3_both.png",
        "Both together",
        "Where both cameras see the floor they agree, whatever is printed on it.",
    ),
    (
        "4_disagreement.png",
        "Disagreement",
        "Bright is where they differ: there something stands up.",
    ),
    (
        "5_boxes_a.svg",
        "Boxes in the first photo",
        "Feet and tops of the boxes, drawn where this camera must see them.",
    ),
    ("6_boxes_b.svg", "Boxes in the second photo", "The same for the other camera."),
    (
        "2_edges.png",
        "Edges",
        "Sobel's filter finds where brightness changes, across and along; the two are added.",
    ),
    (
        "3_averaged.png",
        "Averaged",
        "Each point becomes the mean of its neighbours, so that single specks fade.",
    ),
    ("4_threshold.png", "Threshold", "What is above the mean of the histogram is an edge: white."),
    ("5_inverted.png", "Inverted", "Edges become black, and the areas between them white."),
    (
        "6_mask.png",
        "Obstacles, by the paper's steps",
        "An area that is near white in the photo is floor; all else is an obstacle: black.",
    ),
    (
        "7_obstacles.svg",
        "Obstacles",
        "Red: what was found, numbered as errors number it. Yellow: how much further out each edge may lie. Teal: the robot.",
    ),
    (
        "8_enlarged.png",
        "Enlarged",
        "Every obstacle and the border grow by the robot's radius, so that the robot can be a point.",
    ),
    ("9_borders.svg", "Borders", "The borders of the grown obstacles are found again: pink."),
    (
        "10_border_lines.svg",
        "Border lines",
        "Each visible border, drawn on until it meets something, cuts the floor into areas.",
    ),
    (
        "11_mini_matrix.svg",
        "Mini-matrix",
        "One number an area: 1 is available, 0 dead, 2 holds start or goal.",
    ),
    (
        "12_traps_closed.svg",
        "Traps closed",
        "Areas that lead nowhere are closed, so that no search ends in them.",
    ),
    (
        "13_tree.svg",
        "The tree of global paths",
        "From the start every free neighbour is a branch; the shortest one that reaches the goal wins.",
    ),
    (
        "13_membership.svg",
        "Fuzzy grid",
        "How surely each area is free, from dark to light, and the way that weighs length against risk.",
    ),
    (
        "14_path.svg",
        "The way",
        "From start to goal through points at which the robot turns; useless points are dropped.",
    ),
];

/// Files that are no pictures: name and what they hold.
const DATA: [(&str, &str); 4] = [
    ("scene.json", "the arena with its obstacles"),
    ("plan.json", "the plan: wmr drive drives it again"),
    ("run.jsonl", "what the robot said, a line a word"),
    ("report.json", "how it ended"),
];

const STYLE: &str = "\
body{margin:0 auto;max-width:60rem;padding:1.5rem;background:#faf9f6;color:#2b2f36;\
font:16px/1.5 'Segoe UI','DejaVu Sans',Helvetica,Arial,sans-serif}\
h1{font-size:1.5rem;margin:0 0 .3rem}h2{font-size:1.1rem;margin:0}\
figure{margin:1.6rem 0;padding:1rem;background:#fff;border:1px solid #dedbd3;border-radius:8px}\
figcaption{margin-bottom:.8rem}figcaption p{margin:.1rem 0 0;color:#5d6470}\
img{display:block;max-width:100%;max-height:80vh;margin:auto;image-rendering:auto}\
.small img{min-width:50%;image-rendering:pixelated}a{color:#1f6fd6}";

/// The title of the picture of that name, and what is to be seen on it.
///
/// ```
/// let (title, sentence) = wmr::picture::index::caption("11_mini_matrix.svg").unwrap();
/// assert!(title == "Mini-matrix" && sentence.ends_with('.'));
/// ```
pub fn caption(name: &str) -> Option<(&'static str, &'static str)> {
    STEPS.iter().find(|(file, ..)| *file == name).map(|(_, title, sentence)| (*title, *sentence))
}

/// How every such page begins.
pub const INDEX_HEAD: &str = "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\">\n<meta name=\"generator\" content=\"wmr\">\n";

/// The page for a folder that holds `files`; names that are no picture's of ours are passed over.
///
/// ```
/// let page = wmr::picture::index::index_html("Demo", &["14_path.svg", "plan.json", "notes.txt"]);
/// assert!(page.contains("<img src=\"14_path.svg\"") && page.contains("href=\"plan.json\""));
/// assert!(!page.contains("notes.txt"));
/// ```
pub fn index_html(title: &str, files: &[&str]) -> String {
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    let mut page = format!(
        "{INDEX_HEAD}\
         <meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>{title}</title>\n<style>{STYLE}</style>\n<h1>{title}</h1>\n"
    );
    let data: Vec<String> = DATA
        .iter()
        .filter(|(file, _)| files.contains(file))
        .map(|(file, holds)| format!("<a href=\"{file}\">{file}</a> ({holds})"))
        .collect();
    if !data.is_empty() {
        // Writing into a string cannot fail.
        let _ = writeln!(page, "<p>{}</p>", data.join(", "));
    }
    for (file, title, sentence) in STEPS.iter().filter(|(file, ..)| files.contains(file)) {
        let class = if file.ends_with(".png") { " class=\"small\"" } else { "" };
        let _ = writeln!(
            page,
            "<figure{class}><figcaption><h2>{title}</h2><p>{sentence}</p></figcaption>\
             <a href=\"{file}\"><img src=\"{file}\" alt=\"{title}\" loading=\"lazy\"></a></figure>"
        );
    }
    page + "</html>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drive_comes_first_and_then_the_steps_in_their_order() {
        let page = index_html("a < b", &["14_path.svg", "2_edges.png", "17_replay.svg"]);
        let at = |name: &str| page.find(&format!("src=\"{name}\"")).unwrap();
        assert!(at("17_replay.svg") < at("2_edges.png") && at("2_edges.png") < at("14_path.svg"));
        assert!(page.contains("<h1>a &lt; b</h1>"));
    }
}
