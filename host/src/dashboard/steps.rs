//! The paper's steps from the photo to the path, as pictures with a sentence each.

use crate::cli::input::SeenPhoto;
use crate::cli::way::PlannedWay;
use serde_json::{Value, json};
use wmr::picture;
use wmr::picture::vision::NamedPicture;

/// What a step does, by the name of its picture.
const STEPS: [(&str, &str, &str); 14] = [
    (
        "1_plan_view.png",
        "Seen from above",
        "The photo is straightened: the four corners of the floor become a rectangle to scale.",
    ),
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
        "Obstacles",
        "An area that is near white in the photo is floor; all else is an obstacle: black.",
    ),
    (
        "7_obstacles.svg",
        "Outlines",
        "Each obstacle gets an outline; the dashed line is as far out as its edges may lie.",
    ),
    (
        "8_enlarged.png",
        "Enlarged",
        "Every obstacle and the border grow by the robot's radius, so that the robot can be a point.",
    ),
    ("9_borders.svg", "Borders", "The borders of the grown obstacles are found again: pink."),
    (
        "10_border_lines.svg",
        "Lines",
        "The lines through all visible borders cut the arena into areas.",
    ),
    (
        "11_mini_matrix.svg",
        "Mini-matrix",
        "Each area is one number: 1 free, 0 closed, 2 start and goal.",
    ),
    (
        "12_traps_closed.svg",
        "Traps",
        "Areas that are almost surrounded by zeros lead nowhere and are closed.",
    ),
    (
        "13_tree.svg",
        "Tree",
        "From the start every free neighbour is a branch; the shortest one that reaches the goal wins.",
    ),
    ("14_path.svg", "Path", "Points that are not needed are dropped: what is left is driven."),
];

/// The pictures that a photo and its plan have.
pub(super) fn pictures(
    seen: Option<&SeenPhoto>,
    way: Option<&PlannedWay>,
    radius: f64,
) -> Vec<NamedPicture> {
    let mut pictures = seen.map(|seen| seen.pictures(radius)).unwrap_or_default();
    let Some((way, plan)) = way.and_then(|way| way.plan.as_ref().map(|plan| (way, plan))) else {
        return pictures;
    };
    let scene = &way.file.scene;
    let mut add =
        |name, text: String| pictures.push(NamedPicture { name, bytes: text.into_bytes() });
    if let Some(stages) = &plan.grid {
        add("10_border_lines.svg", picture::grid::border_lines(scene, stages));
        add("11_mini_matrix.svg", picture::grid::mini_matrix(scene, stages));
        add("12_traps_closed.svg", picture::grid::closed_traps(scene, stages));
        if let Some(tree) = &stages.tree {
            add("13_tree.svg", picture::plan::path_tree(tree, stages));
        }
    }
    add("14_path.svg", picture::plan::path(scene, plan, &way.options));
    pictures
}

/// What a page is told of them.
pub(super) fn document(pictures: &[NamedPicture]) -> Value {
    let known = |picture: &NamedPicture| STEPS.iter().find(|(name, _, _)| *name == picture.name);
    let step = |(name, title, text): &(&str, &str, &str)| json!({"name": name, "title": title, "text": text});
    json!({"steps": pictures.iter().filter_map(known).map(step).collect::<Vec<_>>()})
}

/// How a browser is told what a picture is.
pub(super) fn content_type(name: &str) -> &'static str {
    if name.ends_with(".svg") { "image/svg+xml" } else { "image/png" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_of_a_photo_and_plan_has_its_sentence() {
        let picture =
            |(name, _, _): &(&'static str, _, _)| NamedPicture { name, bytes: Vec::new() };
        let all: Vec<_> = STEPS.iter().map(picture).collect();
        let document = document(&all);
        let steps = document["steps"].as_array().unwrap();
        assert_eq!(steps.len(), STEPS.len());
        assert!(steps.iter().all(|step| step["text"].as_str().unwrap().ends_with('.')));
    }
}
