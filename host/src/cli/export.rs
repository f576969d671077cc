//! `wmr export`: an arena as a grid map for other programs, ROS or Moving AI.

use super::args::ExportArgs;
use super::error::CliError;
use super::folder::write_named;
use super::input::{self, Input, Sight};
use super::output::Output;
use serde_json::json;
use std::path::PathBuf;
use wmr::map::CellMap;
use wmr::scene::Scene;

/// The side of a cell that ROS maps of rooms have, metres.
const ROS_RESOLUTION: f64 = 0.05;

/// The side of a cell of a Moving AI map, metres, where nobody says otherwise.
const MOVING_AI_RESOLUTION: f64 = 1.0;

/// A map with more cells is a mistake in units.
const CELL_LIMIT: f64 = 100e6;

/// `wmr export`.
pub(crate) fn run(args: &ExportArgs, output: Output) -> Result<(), CliError> {
    let map = cells(args, output)?;
    let ending = args.output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let files: Vec<PathBuf> = match ending {
        "yaml" | "yml" => {
            let picture = args.output.with_extension("pgm");
            let name = picture.file_name().unwrap_or_default().to_string_lossy();
            let ros = map.to_ros(&name);
            let is_head = |older: &[u8]| String::from_utf8_lossy(older).contains("resolution:");
            write_named(&args.output, ros.yaml.as_bytes(), "map", is_head)?;
            write_named(&picture, &ros.pgm, "map's picture", |older| older.starts_with(b"P5"))?;
            vec![args.output.clone(), picture]
        }
        "map" => {
            let is_map = |older: &[u8]| older.starts_with(b"type ");
            write_named(&args.output, map.to_movingai().as_bytes(), "map", is_map)?;
            vec![args.output.clone()]
        }
        _ => {
            let message = format!("{} says no format", args.output.display());
            return Err(CliError::usage(
                message,
                "write -o NAME.yaml for ROS, -o NAME.map for Moving AI",
            ));
        }
    };
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let document = json!({
        "files": names,
        "columns": map.columns,
        "rows": map.rows,
        "resolution": map.resolution,
    });
    let text = format!(
        "{} × {} cells of {} m: {}\n",
        map.columns,
        map.rows,
        map.resolution,
        names.join(", ")
    );
    output.result(&document, &text)
}

/// A map's own cells, or those that an arena's obstacles touch.
fn cells(args: &ExportArgs, output: Output) -> Result<CellMap, CliError> {
    let own = args.resolution.unwrap_or(MOVING_AI_RESOLUTION);
    if let Some(map) = input::read_cells(&args.input, own, output)? {
        return Ok(map);
    }
    let sight = Sight { radius: None, resolution: own, keep_steps: false, start: None };
    let scene = match input::read(&args.input, &args.vision, sight, output)? {
        Input::Photo(seen) => seen.scene(None),
        Input::Scene(scene) => scene,
        Input::Plan(file) => file.scene,
    };
    let resolution = args.resolution.unwrap_or(ROS_RESOLUTION);
    check_size(&scene, resolution)?;
    Ok(CellMap::from_scene(&scene, resolution))
}

fn check_size(scene: &Scene, resolution: f64) -> Result<(), CliError> {
    let count = scene.arena.width * scene.arena.height / (resolution * resolution);
    if resolution > 0.0 && count <= CELL_LIMIT {
        return Ok(());
    }
    let message = format!(
        "cells of {resolution} m make no map of {} × {} m",
        scene.arena.width, scene.arena.height
    );
    Err(CliError::usage(message, "give a --resolution such as 0.05"))
}
