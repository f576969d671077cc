//! `wmr export`: an arena as a grid map for other programs, ROS or Moving AI; a drive as a table.

use super::args::ExportArgs;
use super::error::CliError;
use super::folder::write_named;
use super::input::{self, Input, Sight};
use super::log;
use super::output::Output;
use std::path::PathBuf;
use wmr::document::{ExportDocument, TableDocument};
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
    let ending = args.output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if ending == "csv" {
        return run_table(args, output);
    }
    let map = cells(args, output)?;
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
                "write -o NAME.yaml for ROS, -o NAME.map for Moving AI, -o NAME.csv for a drive's table",
            ));
        }
    };
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let CellMap { columns, rows, resolution, .. } = map;
    let text = format!("{columns} × {rows} cells of {resolution} m: {}\n", names.join(", "));
    let document = ExportDocument { files: names, columns, rows, resolution };
    output.result(&document, &text)
}

/// A drive as a table.
fn run_table(args: &ExportArgs, output: Output) -> Result<(), CliError> {
    let path = if args.input.is_dir() { args.input.join(log::RUN) } else { args.input.clone() };
    let run = log::read_run(&path)?;
    let is_table = |older: &[u8]| older.starts_with(b"t_s,");
    write_named(&args.output, run.to_csv().as_bytes(), "table of a drive", is_table)?;
    let name = args.output.display().to_string();
    let text = format!("{} rows, {:.1} s: {name}\n", run.lines.len(), run.duration());
    output.result(
        &TableDocument { files: vec![name], rows: run.lines.len(), duration: run.duration() },
        &text,
    )
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
