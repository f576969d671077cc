//! The paper's steps from the photo to the path, as pictures with a sentence each.

use crate::cli::input::SeenPhoto;
use crate::cli::way::PlannedWay;
use serde_json::{Value, json};
use wmr::picture;
use wmr::picture::index::caption;
use wmr::picture::vision::NamedPicture;

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
    let step = |picture: &NamedPicture| {
        let (title, text) = caption(picture.name)?;
        Some(json!({"name": picture.name, "title": title, "text": text}))
    };
    json!({"steps": pictures.iter().filter_map(step).collect::<Vec<_>>()})
}

/// How a browser is told what a picture is.
pub(super) fn content_type(name: &str) -> &'static str {
    if name.ends_with(".svg") { "image/svg+xml" } else { "image/png" }
}
